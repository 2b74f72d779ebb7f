"""Code of the property ``usable_position``, which reads the items of a frame's NamedTuple."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from ...model.record import dataclass

#: Fewest items that are read faster as local variables than as attributes.
_FEWEST_VARIABLES = 3
#: Returns the code that reads an attribute of a frame: ``error`` or ``self.error`` for ``error``.
AttributeReader = Callable[[str], str]


@dataclass(frozen=True)
class UsablePosition:
    """Code that returns the position if it is usable, and None otherwise.

    ``unpacking`` assigns items of the frame to local variables first: ``variant, singleturn, error, _ = self``. It is
    empty if too few items are read. Each of the ``not_usable_conditions`` makes the position not usable.
    """

    unpacking: str
    not_usable_conditions: Sequence[str]
    position: str


def write_usable_position(
    item_names: Sequence[str],
    conditions_with: Callable[[AttributeReader], Sequence[str]],
    position_with: Callable[[AttributeReader], str],
) -> UsablePosition:
    """Return the code for a frame whose NamedTuple has items with these names.

    ``conditions_with`` and ``position_with`` return the conditions and the code of the position, in which attributes
    are read by the given code. Several items become local variables, which are faster than attributes.
    """

    def read_variable(name: str) -> str:
        return name if name in item_names else f"self.{name}"

    def read_attribute(name: str) -> str:
        return f"self.{name}"

    conditions, position = conditions_with(read_variable), position_with(read_variable)
    # A name after a period is an attribute of the variable before it, as in ``variant.multiturn_bits``.
    names_in_code = set(re.findall(r"(?<![\w.])[A-Za-z_]\w*", " ".join([*conditions, position])))
    names_read = names_in_code.intersection(item_names)
    if len(names_read) < _FEWEST_VARIABLES:
        return UsablePosition("", conditions_with(read_attribute), position_with(read_attribute))
    variables = ", ".join(name if name in names_read else "_" for name in item_names)
    unpacking = f"{variables} = self"
    # A list of variables in parentheses can be broken.
    return UsablePosition(f"({variables}) = self" if len(unpacking) > 100 else unpacking, conditions, position)
