"""Order codes in C: the variant with its parameters, the variant of each order code, and the open parts."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence, Set

from ...model import Parameter, Variant, first_of
from ...model.record import dataclass
from ...plan.values import parameters_in_measurement
from .about import about_order_codes, about_parameter
from .context import Context
from .functions import Function, number_of
from .macros import Macro
from .names import Declared
from .order_codes import OpenCode, open_codes, unknown_parts
from .types import number


@dataclass(frozen=True, slots=True)
class CodeRow:
    """An order code, its name in C with and without the prefix, and its values."""

    variant: Variant
    code: str
    macro: str
    values: tuple[str, ...]


class VariantCode:
    def __init__(self, context: Context) -> None:
        self.context, self.device = context, context.device
        self.parameters = self.device.set_parameters
        #: Without those that the functions of positions return.
        measured = parameters_in_measurement(self.device)
        self._named = [parameter for parameter in self._in_order_of_use() if parameter.name not in measured]
        self.derived: Sequence[Function] = [self._derived(parameter) for parameter in self._named]
        self.rows = [self._row(variant) for variant in self.device.variants]
        unknown = set(unknown_parts(self.device))
        left_open = [part for part in self.device.order_code.parts if part.open and part.name not in unknown]
        masks = [number(1 << index, hexadecimal=True) for index, _ in enumerate(left_open)]
        names = [part.name for part in left_open]
        self.unlisted = [Macro(self._unlisted(name), mask, name) for name, mask in zip(names, masks, strict=True)]
        self.patterns = open_codes(self.device)
        self.about = about_order_codes(self.device)

    def declared(self) -> Iterator[Declared]:
        yield self.context.prefix, ()
        for name in ("order_code", "order_codes", "find_order_code"):
            yield f"{self.context.prefix}_{name}", ()
        for parameter in self._named:
            yield f"{self.context.prefix}_{parameter.name}", ("parameters", parameter.name)
        yield from ((row.macro, ("order_code",)) for row in self.rows)
        yield from ((macro.name, ("order_code", "parts")) for macro in self.unlisted)

    def about_parameter(self, parameter: Parameter) -> str:
        return about_parameter(self.device, self.context.prefix, parameter)

    @property
    def refuses(self) -> bool:
        """True if a pattern matches labels that are not an order code."""
        return any(pattern.code is None for pattern in self.patterns)

    def bits(self, pattern: OpenCode) -> str:
        """Return the parts that a pattern leaves open."""
        return " | ".join(map(self._unlisted, pattern.unlisted)) or "0U"

    def _unlisted(self, part: str) -> str:
        return f"{self.context.PREFIX}_UNLISTED_{part.upper()}"

    def _in_order_of_use(self) -> list[Parameter]:
        """Return the derived parameters, each after those that it needs."""
        waiting = {parameter.name: parameter for parameter in self.device.parameters if parameter.equals is not None}
        ordered: list[Parameter] = []
        while waiting:
            ready = (parameter for parameter in waiting.values() if _needs_none_of(parameter, waiting.keys()))
            parameter = first_of(ready, f"order in which to calculate {', '.join(waiting)}")
            ordered.append(waiting.pop(parameter.name))
        return ordered

    def _derived(self, parameter: Parameter) -> Function:
        assert parameter.equals is not None
        name = f"{self.context.prefix}_{parameter.name}"
        return number_of(self.context.scope, name, parameter.equals, parameter.largest, self.about_parameter(parameter))

    def _row(self, variant: Variant) -> CodeRow:
        family, stem = self.device.name.upper(), variant.code.upper()
        if all(variant.code.upper().startswith(family) for variant in self.device.variants):
            stem = stem.removeprefix(family) or stem
        code = re.sub("[^A-Z0-9]+", "_", stem).strip("_")
        return CodeRow(
            variant=variant,
            code=code,
            macro=f"{self.context.PREFIX}_{code}",
            values=tuple(_value(parameter, variant) for parameter in self.parameters),
        )


def _needs_none_of(parameter: Parameter, names: Set[str]) -> bool:
    """Return True if the expression of a derived parameter uses none of these."""
    return parameter.equals is not None and names.isdisjoint(parameter.equals.parameters)


def _value(parameter: Parameter, variant: Variant) -> str:
    """Return a parameter of an order code. A code (no unit, above one byte) is in hexadecimal, as in the manuals."""
    return number(
        variant.parameters.get(parameter.name, 0), hexadecimal=not parameter.unit and parameter.largest > 0xFF, digits=4
    )
