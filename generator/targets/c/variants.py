"""Order codes in C: the variant with its parameters, the variant of each order code, and the open parts."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ...model import Parameter, Variant
from ...model.record import dataclass
from ...plan.measurement import also_measured
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
        self._named = [item for item in self._in_order_of_use() if item.name not in also_measured(self.device)]
        self.derived: Sequence[Function] = [self._derived(item) for item in self._named]
        self.rows = [self._row(item) for item in self.device.variants]
        known = set(unknown_parts(self.device))
        left_open = [part for part in self.device.order_code.parts if part.open and part.name not in known]
        self.unlisted = [
            Macro(self._unlisted(part.name), number(1 << index, hexadecimal=True), part.name)
            for index, part in enumerate(left_open)
        ]
        self.patterns = open_codes(self.device)
        self.about = about_order_codes(self.device)

    def declared(self) -> Iterator[Declared]:
        yield self.context.prefix, ()
        for name in ("order_code", "order_codes", "find_order_code"):
            yield f"{self.context.prefix}_{name}", ()
        for item in self._named:
            yield f"{self.context.prefix}_{item.name}", ("parameters", item.name)
        yield from ((row.macro, ("order_code",)) for row in self.rows)
        yield from ((item.name, ("order_code", "parts")) for item in self.unlisted)

    def about_parameter(self, item: Parameter) -> str:
        return about_parameter(self.device, self.context.prefix, item)

    @property
    def refuses(self) -> bool:
        """True if a pattern matches labels that are not an order code."""
        return any(item.code is None for item in self.patterns)

    def bits(self, item: OpenCode) -> str:
        """Return the parts that a pattern leaves open."""
        return " | ".join(map(self._unlisted, item.unlisted)) or "0U"

    def _unlisted(self, part: str) -> str:
        return f"{self.context.PREFIX}_UNLISTED_{part.upper()}"

    def _in_order_of_use(self) -> list[Parameter]:
        """Return the derived parameters, each after those that it needs."""
        left = {item.name: item for item in self.device.parameters if item.equals is not None}
        ordered: list[Parameter] = []
        while left:
            ready = (
                item
                for item in left.values()
                if item.equals is not None and left.keys().isdisjoint(item.equals.parameters)
            )
            item = next(ready)
            ordered.append(left.pop(item.name))
        return ordered

    def _derived(self, item: Parameter) -> Function:
        assert item.equals is not None
        name = f"{self.context.prefix}_{item.name}"
        return number_of(self.context.scope, name, item.equals, item.largest, self.about_parameter(item))

    def _row(self, variant: Variant) -> CodeRow:
        family, stem = self.device.name.upper(), variant.code.upper()
        if all(item.code.upper().startswith(family) for item in self.device.variants):
            stem = stem.removeprefix(family) or stem
        code = re.sub("[^A-Z0-9]+", "_", stem).strip("_")
        return CodeRow(
            variant, code, f"{self.context.PREFIX}_{code}", tuple(_value(item, variant) for item in self.parameters)
        )


def _value(item: Parameter, variant: Variant) -> str:
    """Return a parameter of an order code. A code (no unit, above one byte) is in hexadecimal, as in the manuals."""
    return number(variant.parameters.get(item.name, 0), hexadecimal=not item.unit and item.largest > 0xFF, digits=4)
