"""Description of a frame or register as Python literals, for ``decode_many`` and ``encode_many``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from enum import Enum
from typing import Any

from ...model import Fault, Scale
from ...model.expressions import Expression
from ...plan.codec import allowed_values
from ...plan.description import Answered, Column, Name, describe
from ...plan.operations import FrameCrc
from ...plan.values import is_named, meaning_of, position_ranges
from ...plan.verdicts import Only, Reporting
from .bits import others
from .codec import Coder
from .context import byte_order
from .decode import holding
from .expr import joined
from .literals import Call, Code, ConditionalItem, Literal, Member, call, literal, record

#: Number of members that are printed without their names, by class.
_POSITIONAL = {"BitField": 3, "Column": 1, "Join": 2, "Speaks": 1, "Tells": 1}
#: Members that say for which encoders a cause applies.
_CONDITIONS = ("only", "chosen")


def column_names(coder: Coder) -> list[str]:
    """Return the names of the columns of a table of frames, as type checkers know them."""
    described = describe(coder.plan, None)
    data_fields = {part.field.name for part in coder.plan.parts}
    columns = [column for column in described.columns if column.name in data_fields]
    names: list[str] = []
    for column in columns:
        names += [coder.names.attribute(run) for run, _, _ in column.runs] or [coder.names.attribute(column.name)]
    names += [coder.names.attribute(join.name) for join in described.joins]
    for column in columns:
        if column.scale is not None:
            names.append(f"{coder.names.attribute(column.name)} ({column.scale.unit})")
    unused = ["unused"] if described.unused else []
    verdict = ["verdict"] if coder.reports is not None and coder.reports.otherwise else []
    return [*names, *unused, *verdict, "fault"]


class Shape:
    """Description of one frame, as used by its template."""

    def __init__(self, coder: Coder, reporting: Reporting | None) -> None:
        self.coder, self.plan = coder, coder.plan
        self._of = describe(coder.plan, reporting)
        self.name = f"shape_of_{'register_' if coder.register is not None else ''}{coder.layout.name}"

    #: Members whose items are on separate lines.
    rows = ("columns", "joins", "unused", "checks", "parities", "speaks", "tells", "fields")

    @property
    def members(self) -> list[tuple[str, Literal]]:
        """Members that are not empty, by name, in the order in which they are printed."""
        return [(name, value) for name, value in self._members() if value not in (None, 0, "", ())]

    def _members(self) -> Iterator[tuple[str, Literal]]:
        described, coder, register = self._of, self.coder, self.coder.register
        data = {part.field.name for part in self.plan.parts}
        yield from (("bits", self._shown(described.bits)), ("length", described.length), ("order", described.order))
        yield "columns", tuple(self._column(column) for column in described.columns if column.name in data)
        for name in self.rows[1:]:
            # The class of a register checks its values.
            yield name, self._shown(getattr(described, name)) if name != "checks" or register is None else ()
        yield "crc", self._crc(described.crc) if described.crc is not None else None
        if described.gray is not None:
            bits = literal(self._shown((described.gray.low, described.gray.width)))
            yield "gray", Code(f"{bits} if variant.{coder.gray_when} else None" if coder.gray_when else str(bits))
        terms = [f"{value:#x} << {coder.number(place.low)}" for place, value in described.fixed]
        if len(terms) > 1:
            terms = [f"({term})" for term in terms]
        yield "fixed", Code(" | ".join(terms)) if terms else None
        yield "position", coder.measured
        if self.plan.keeps_others:
            yield "others", Code(str(others(coder.context.scope, self.plan)))
        yield "limited", (register.limits_of, coder.limited) if register is not None and coder.limited else ()
        yield "otherwise", self._shown(described.otherwise)
        yield "frame", self._frame

    @property
    def _frame(self) -> str:
        """Name of the frame, if its positions have another range than those of other frames."""
        coder = self.coder
        if coder.register is not None or not coder.measured:
            return ""
        interface = coder.context.device.interface(coder.layout_interface)
        ranges = position_ranges(coder.context.device, interface)
        is_special = len(ranges) > 1 or any(position_range.never_wraps for position_range in ranges)
        return coder.layout.name if is_special else ""

    def _column(self, shape_column: Column) -> Call:
        """Return a column with its name in messages, if that differs, and the only values of its field."""
        field, name = self.coder.layout.field(shape_column.name), self.coder.names.attribute(shape_column.name)
        values: Literal = Code(self.coder.enum(field)) if is_named(meaning_of(field)) else None
        if self.coder.selects(field):
            values = allowed_values(self.coder.layout, field)
        column_call = self._record(shape_column)
        return record(
            "Column",
            dict(column_call.arguments),
            field=shape_column.name if shape_column.name != name else "",
            values=values,
        )

    def _crc(self, frame_crc: FrameCrc) -> Call:
        """Return the CRC with the function that compares it, and the means to compute it for many frames."""
        crc, coder = frame_crc.crc, self.coder
        members: dict[str, Literal] = {"low": self._shown(frame_crc.bits.low), "width": crc.width}
        if coder.layout.crc_covers_bytes:
            place = f'{self.plan.length}, {crc.width // 8}, "{byte_order(coder.layout)}"'
            members["differs"] = Code(f"of_bytes({coder.crc_name}, {place})")
            members |= {"xorout": crc.xorout, "is_xor": True} if crc.is_xor else {}
        else:
            gap = f", {frame_crc.gap}" if frame_crc.gap else ""
            members["differs"] = Code(f"of_bits({coder.crc_name}, {coder.number(frame_crc.covered)}, {crc.width}{gap})")
            folds = tuple(call("Fold", step.shift, Code(f"0x{step.mask:02X}"), step.back) for step in frame_crc.steps)
            members |= {"xorout": crc.xorout, "steps": folds} if folds else {}
        return Call("CrcOf", tuple(members.items()))

    def _shown(self, value: Any) -> Literal:
        """Return any part of the description as a literal."""
        match value:
            case Expression():
                return Code(str(self.coder.number(value)))
            case Name():
                return self.coder.names.attribute(value)
            case Enum():
                return Member("ErrorKind" if isinstance(value, Fault) else type(value).__name__, value.name)
            case Scale(numerator, denominator, offset, unit):
                # Without the class, whose name a register may have.
                return (numerator, denominator, offset, unit)
            case tuple():
                return tuple(map(self._shown, value))
            case None | bool() | int() | str():
                return value
            case Answered(parameter, verdict):
                return Code(f"Verdict.{verdict.name} if {self._member(parameter)} else None")
        conditions: list[Only | None] = [getattr(value, name, None) for name in _CONDITIONS]
        holds = [holding(only, self._member(only.parameter)) for only in conditions if only is not None]
        return ConditionalItem(self._record(value), str(joined("and", holds))) if holds else self._record(value)

    def _member(self, parameter: str) -> str:
        return f"variant.{self.coder.context.parameters[parameter]}"

    def _record(self, part: Any) -> Call:
        """Return the call of the class of the same name. A cause other than a flag has no name."""
        kind = type(part).__name__
        is_flag = not getattr(part, "mask", 0) and not getattr(part, "when", ())
        omitted = _CONDITIONS if is_flag else (*_CONDITIONS, "flag")
        members = [(member, getattr(part, member.name)) for member in fields(part) if member.name not in omitted]
        arguments = [(member.name, self._shown(value)) for member, value in members if value != member.default]
        count = _POSITIONAL.get(kind, 0)
        positional = [("", value) for _, value in arguments[:count]]
        return Call(kind, (*positional, *arguments[count:]))
