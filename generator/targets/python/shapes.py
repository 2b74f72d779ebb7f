"""Descriptions of frames for ``decode_many``: expressions and literals from the plan of columns."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from ...model import Field
from ...plan.codec import allowed_values
from ...plan.columns import Condition, Place, Worth, conditions, crc_place, fixed, parities, telling, worth
from ...plan.refusals import powers_of_two
from ...plan.reports import Only, Reporting
from ...plan.values import is_named, meaning_of
from .bits import others
from .codec import Coder
from .expr import Expr
from .literals import Call, Code, Literal, Member, Sometimes, record
from .meanings import of_column
from .reports import holding


class Shape:
    """Description of one frame, as used by its template."""

    def __init__(self, coder: Coder, reporting: Reporting | None) -> None:
        self.coder, self.plan, self._reporting = coder, coder.plan, reporting
        self._judgement = reporting.judgement if reporting is not None else None
        self.name = f"shape_of_{'register_' if coder.register is not None else ''}{coder.layout.name}"

    @cached_property
    def rows(self) -> list[tuple[str, list[Literal]]]:
        """Members that are tuples, by name."""
        return [*self._rows()]

    def _rows(self) -> Iterator[tuple[str, list[Literal]]]:
        yield "columns", [*self._columns()]
        yield "joins", [*self._joins()]
        yield "unused", [*self._unused()]
        is_frame = self.coder.register is None
        yield "checks", [self._check(item) for item in conditions(self.plan)] if is_frame else []
        yield "parities", [*self._parities()]
        judgement = self._judgement
        yield "speaks", [self._speaks(item) for item in worth(judgement)] if judgement is not None else []
        yield "tells", [*self._tells()]

    def _at(self, place: Place) -> dict[str, Literal]:
        return {"low": self._code(place.low), "width": self._code(place.width)}

    def _code(self, value: object) -> Code:
        return Code(str(value if isinstance(value, Expr) else self.coder.number(value)))  # type: ignore[arg-type]

    def _columns(self) -> Iterator[Call]:
        names, powers = self.coder.names, powers_of_two(self.plan)
        for part in self.plan.parts:
            field = part.field
            needed: dict[str, Literal] = {"": names.attribute(field.name), **self._at(Place(field.low, field.width))}
            meant = of_column(meaning_of(field), names)
            named = field.name if field.name != names.attribute(field.name) else ""
            values = self._values(field)
            yield record(
                "Column", needed, **meant, power_of_two=field.name in powers or None, field=named, values=values
            )

    def _values(self, field: Field) -> Literal:
        """Return the only values of a field: those of a selector, or the IntEnum of a choice."""
        if self.coder.selects(field):
            return allowed_values(self.coder.layout, field)
        return Code(self.coder.enum(field)) if is_named(meaning_of(field)) else None

    def _joins(self) -> Iterator[Call]:
        names = self.coder.names
        for whole in self.plan.wholes:
            fields = tuple((names.attribute(item.name), self._code(low)) for item, low in whole.from_low)
            yield Call("Join", (("", names.attribute(whole.join.name)), ("", fields)))

    def _unused(self) -> Iterator[Call]:
        for item in self.plan.reserved:
            yield record(
                "Unused",
                {**self._at(Place(item.field.low, item.field.width)), "value": item.value, "place": item.place},
            )

    def _check(self, item: Condition) -> Call:
        return record(
            "Check",
            {**self._at(item.place), "fault": Member("ErrorKind", item.check.fault.name)},
            values=item.values,
            limit=item.limit,
            parity_of=self._places(item.parity_of),
            odd=item.odd or None,
        )

    def _parities(self) -> Iterator[Call]:
        for place, of, odd in parities(self.plan):
            fault = Member("ErrorKind", "CONSTANT")
            yield record("Check", {**self._at(place), "fault": fault}, parity_of=self._places(of), odd=odd or None)

    def _places(self, places: tuple[Place, ...]) -> tuple[tuple[Code, Code], ...]:
        return tuple((self._code(of.low), self._code(of.width)) for of in places)

    def _speaks(self, item: Worth) -> Call | Sometimes:
        names = self.coder.names
        flag = names.attribute(item.flag.field.name) if item.flag is not None else ""
        unless = tuple(names.attribute(part.field.name) for part in item.unless)
        verdict = Member("Verdict", item.verdict.name)
        made = record("Speaks", {"": verdict}, flag=flag, unless=unless, mask=item.mask or None)
        return self._only(made, item.only)

    def _tells(self) -> Iterator[Call | Sometimes]:
        for item in telling(self._reporting) if self._reporting is not None else ():
            flag = self.coder.names.attribute(item.flag.field.name) if item.flag is not None else ""
            made = record("Tells", {"": item.report}, flag=flag, mask=item.mask or None)
            yield self._only(made, item.only)

    def _only(self, made: Call, only: Only | None) -> Call | Sometimes:
        """Return an item of a tuple, with a condition if only some order codes have it."""
        if only is None:
            return made
        member = holding(only, f"variant.{self.coder.context.parameters[only.parameter]}")
        return Sometimes(made, str(member))

    @property
    def otherwise(self) -> str:
        return self._judgement.otherwise.name if self._judgement is not None else ""

    @property
    def fixed(self) -> str:
        """Bits that are 1 in every such frame, as one number."""
        terms = [f"{value:#x} << {self._code(place.low).text}" for place, value in fixed(self.plan)]
        return " | ".join(f"({item})" if len(terms) > 1 else item for item in terms)

    @property
    def others(self) -> Expr:
        """Mask of the bits of a register that belong to no field."""
        return others(self.coder.context.scope, self.plan)

    @property
    def crc_low(self) -> int:
        """Lowest bit of the CRC."""
        crc = self.plan.crc
        return crc_place(self.coder.layout, crc.crc.width) if crc is not None else 0
