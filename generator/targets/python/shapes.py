"""Descriptions of frames and registers as data in generated Python (shapes), for the decoding of many frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from enum import Enum
from types import MappingProxyType
from typing import Any

from ...model import Fault, Scale, Verdict
from ...model.expressions import Expression
from ...plan.description import Answered, Column, Name, describe
from ...plan.frame_checks import allowed_values
from ...plan.operations import FrameCrc
from ...plan.values import is_named, meaning_of, position_ranges
from ...plan.verdicts import CodeCondition, ReportsAndVerdict
from .bits import mask_without_field
from .codec import LayoutClass
from .literals import (
    CallLiteral,
    ConditionalItem,
    EnumMember,
    Hex,
    Literal,
    SourceText,
    join_operands,
    literal,
    literal_call,
    record_call,
)
from .names import byte_order
from .reports import condition_on_parameter

#: Number of members that are printed without their names, by class.
_POSITIONAL_COUNTS = {"BitField": 1, "Column": 1, "Join": 1, "VerdictCause": 1, "ReportCause": 1}
#: Names of classes and members in the runtime, if they differ from the plan.
_RUNTIME_NAMES: Mapping[str, str] = MappingProxyType(
    {
        "DescribedVerdictCause": "VerdictCause",
        "DescribedReportCause": "ReportCause",
        "answered": "chosen_verdict",
        "fault": "error_kind",
        "kind": "value_kind",
        "limit": "highest",
        "low": "lowest_bit",
        "place": "bit_in_column",
        "runs": "digit_groups",
        "values": "allowed_values",
        "when": "required_values",
    }
)
#: Members of a plan's description that are lists, except the columns.
_PLANNED_ROWS = ("digit_codings", "joins", "unused", "checks", "parities", "verdict_causes", "report_causes", "fields")
#: Members that state for which encoders a cause applies.
_CONDITION_MEMBERS = ("only", "chosen")


class ShapeLiteral:
    """The description of a frame or register (its shape), as the template prints it.

    ``reporting`` contains the reports and the verdict of a frame, or is None if it has neither.
    """

    #: Members whose items are on separate lines.
    rows = ("columns", *(_RUNTIME_NAMES.get(name, name) for name in _PLANNED_ROWS))

    def __init__(self, layout_class: LayoutClass, reporting: ReportsAndVerdict | None) -> None:
        self.layout_class = layout_class
        self.layout_plan = layout_class.layout_plan
        self._description = describe(layout_class.layout_plan, reporting)
        prefix = "register_" if layout_class.register is not None else ""
        self.name = f"layout_of_{prefix}{layout_class.layout.name}"

    @property
    def members(self) -> list[tuple[str, Literal]]:
        """Members that are not empty, by name, in the order in which they are printed."""
        return [(name, value) for name, value in self._all_members() if value not in (None, 0, "", ())]

    def _all_members(self) -> Iterator[tuple[str, Literal]]:
        """Yield all members of the shape by name, including empty members."""
        description = self._description
        layout_class = self.layout_class
        yield "bit_count", self._literal_of(description.bits)
        yield "byte_count", description.length
        yield "order", description.order
        yield "exchanged_bytes", description.exchanged_bytes
        yield "columns", self._value_columns()
        yield from self._members_with_rows()
        yield "crc", self._crc_of_encoder(description.crcs)
        yield from self._gray_members()
        yield "fixed", self._constant_bits()
        yield "position", layout_class.position_attribute
        if self.layout_plan.keeps_undefined_bits:
            kept_mask = mask_without_field(layout_class.device_names.translator, self.layout_plan)
            yield "kept_mask", SourceText(str(kept_mask))
        if layout_class.register is not None and layout_class.limited_attribute:
            yield "limited_value", (layout_class.register.limits_of, layout_class.limited_attribute)
        yield "default_verdict", self._default_verdict()
        yield "frame", self._name_of_frame_with_special_range()

    def _value_columns(self) -> tuple[CallLiteral, ...]:
        """Return the call that creates a column for each field with a value."""
        names_with_value = {decoded_field.field.name for decoded_field in self.layout_plan.decoded_fields}
        columns = (column for column in self._description.columns if column.name in names_with_value)
        return tuple(map(self._column_call, columns))

    def _members_with_rows(self) -> Iterator[tuple[str, Literal]]:
        """Yield the members with several items, except the columns, with their names in the runtime."""
        for name in _PLANNED_ROWS:
            # The class of a register checks its values.
            is_checked_by_class = name == "checks" and self.layout_class.register is not None
            if not is_checked_by_class:
                yield _RUNTIME_NAMES.get(name, name), self._literal_of(getattr(self._description, name))

    def _gray_members(self) -> Iterator[tuple[str, Literal]]:
        """Yield ``gray`` and ``excess``, if the encoder can send Gray code.

        ``gray`` is the lowest bit and the width of the bits in this code, such as ``(8, 22) if variant.gray else
        None``.
        """
        gray = self._description.gray
        if gray is None:
            return
        low_and_width = str(literal(self._literal_of((gray.low, gray.width))))
        # Only some order codes send Gray code.
        if self.layout_class.gray_when:
            low_and_width += f" if variant.{self.layout_class.gray_when} else None"
        yield "gray", SourceText(low_and_width)
        yield "excess", self._literal_of(gray.excess)

    def _constant_bits(self) -> SourceText | None:
        """Return the constants at their places, such as ``(0x3 << 4) | (0x1 << 20)``, or None without any."""
        constants = self._description.fixed
        terms = [
            f"{value:#x} << {self.layout_class.to_python(constant_bits.low)}" for constant_bits, value in constants
        ]
        if not terms:
            return None
        if len(terms) == 1:
            return SourceText(terms[0])
        return SourceText(" | ".join(f"({term})" for term in terms))

    def _default_verdict(self) -> Literal:
        """Return the verdict of a frame without active flags.

        If some order codes have no bits that say whether the position is usable, it is unknown for these codes, as in
        ``Verdict.USABLE if variant.has_flags else Verdict.UNKNOWN``.
        """
        verdict = self._literal_of(self._description.otherwise)
        # The number of these bits is only in the description if it depends on the order code.
        if self._description.judges_if_positive is None:
            return verdict
        judges_if_positive = self.layout_class.to_python(self._description.judges_if_positive)
        unknown = self._literal_of(Verdict.UNKNOWN)
        return SourceText(f"{literal(verdict)} if {judges_if_positive} else {literal(unknown)}")

    def _name_of_frame_with_special_range(self) -> str:
        """Return the name of the frame if its range of positions differs from that of other frames, or else "".

        A range in which the position never wraps around also counts as different.
        """
        layout_class = self.layout_class
        if layout_class.register is not None or not layout_class.position_attribute:
            return ""
        interface = layout_class.device_names.device.interface(layout_class.layout_interface)
        ranges = position_ranges(layout_class.device_names.device, interface)
        is_special = len(ranges) > 1 or any(position_range.never_wraps for position_range in ranges)
        return layout_class.layout.name if is_special else ""

    def _column_call(self, column: Column) -> CallLiteral:
        """Return the call that creates a column.

        It contains the name of the field in messages if the attribute has another name. It also contains the valid
        values of the field by which frames differ (the selector), or the Enum of a field with named values.
        """
        layout_class = self.layout_class
        field = layout_class.layout.field(column.name)
        name_in_messages = column.name if column.name != layout_class.class_names.attribute_name(column.name) else ""
        valid_values: Literal = None
        if layout_class.selects(field):
            valid_values = allowed_values(layout_class.layout, field)
        elif is_named(meaning_of(field)):
            valid_values = SourceText(layout_class.enum_name(field))
        arguments = dict(self._call_of(column).arguments)
        return record_call("Column", arguments, field=name_in_messages, allowed_values=valid_values)

    def _crc_of_encoder(self, crcs: Sequence[FrameCrc]) -> Literal:
        """Return the code for the CRC of a frame, or None if the frame has no CRC.

        If the CRC depends on the order code, the code selects the first CRC whose width is not 0 when the module runs:
        ``next(iter(…), None)``, with a tuple that contains only the CRCs of the encoder.
        """
        if not crcs:
            return None
        if not crcs[0].is_optional:
            # A CRC of all order codes is the only CRC.
            return self._crc_call(crcs[0])
        crcs_of_encoder = []
        for crc in crcs:
            width = str(self.layout_class.to_python(crc.field.width))
            crcs_of_encoder.append(ConditionalItem(self._crc_call(crc), width))
        iterator = literal_call("iter", tuple(crcs_of_encoder))
        return literal_call("next", iterator, SourceText("None"))

    def _crc_call(self, frame_crc: FrameCrc) -> CallLiteral:
        """Return the call that describes a CRC: the function that checks one frame, and the steps for many frames."""
        crc = frame_crc.crc
        layout_class = self.layout_class
        arguments: dict[str, Literal] = {"lowest_bit": self._literal_of(frame_crc.bits.low), "width": crc.width}
        if layout_class.layout.crc_covers_bytes:
            layout = layout_class.layout
            place_arguments = f'length={self.layout_plan.length}, width={crc.width // 8}, order="{byte_order(layout)}"'
            if layout.exchanged_bytes:
                place_arguments += f", exchanged_bytes={layout.exchanged_bytes}"
            arguments["find_difference"] = SourceText(
                f"compare_bytes({layout_class.crc_name(frame_crc)}, {place_arguments})"
            )
            if crc.is_xor:
                arguments |= {"xorout": crc.xorout, "is_xor": True}
        else:
            gap = f", gap={frame_crc.bits_between}" if frame_crc.bits_between else ""
            place_arguments = f"covered={layout_class.to_python(frame_crc.covered_width)}, width={crc.width}{gap}"
            arguments["find_difference"] = SourceText(
                f"compare_bits({layout_class.crc_name(frame_crc)}, {place_arguments})"
            )
            if frame_crc.steps:
                arguments |= {"xorout": crc.xorout, "steps": _fold_steps(frame_crc)}
        return CallLiteral("CrcOf", tuple(arguments.items()))

    # -- any value of the description

    def _literal_of(self, value: Any) -> Literal:
        """Return any value in the description of a frame as a literal. A part with members becomes a record."""
        match value:
            case Expression():
                return SourceText(str(self.layout_class.to_python(value)))
            case Name():
                return self.layout_class.class_names.attribute_name(value)
            case Enum():
                enumeration = "ErrorKind" if isinstance(value, Fault) else type(value).__name__
                return EnumMember(enumeration, value.name)
            case Scale(numerator, denominator, offset, unit):
                # Without the class, whose name a register may have.
                return (numerator, denominator, offset, unit)
            case tuple():
                return tuple(map(self._literal_of, value))
            case None | bool() | int() | str():
                return value
            case Answered(parameter, verdict):
                return SourceText(f"Verdict.{verdict.name} if {self._read_parameter(parameter)} else None")
        return self._record_of(value)

    def _record_of(self, description_part: Any) -> Literal:
        """Return a part of the description as a record.

        A part that applies only to some encoders becomes a conditional item of a tuple.
        """
        conditions = []
        for name in _CONDITION_MEMBERS:
            # Many parts do not have these members.
            code_condition: CodeCondition | None = getattr(description_part, name, None)
            if code_condition is not None:
                parameter = self._read_parameter(code_condition.parameter)
                conditions.append(condition_on_parameter(code_condition, parameter))
        call = self._call_of(description_part)
        return ConditionalItem(call, str(join_operands("and", conditions))) if conditions else call

    def _read_parameter(self, parameter: str) -> str:
        """Return the code that reads a parameter of the order code, such as ``variant.position_bits``."""
        return f"variant.{self.layout_class.device_names.attribute_by_parameter[parameter]}"

    def _call_of(self, description_part: Any) -> CallLiteral:
        """Return the call of the class in the runtime for a part of the description.

        Members that equal their defaults and conditions on the order code are left out. So is ``flag`` of a cause that
        consists of a mask or a combination of values.
        """
        planned_class_name = type(description_part).__name__
        class_name = _RUNTIME_NAMES.get(planned_class_name, planned_class_name)
        omitted = set(_CONDITION_MEMBERS)
        is_mask_or_combination = getattr(description_part, "mask", 0) or getattr(description_part, "when", ())
        if is_mask_or_combination:
            omitted.add("flag")
        arguments: list[tuple[str, Literal]] = []
        for member in fields(description_part):
            value = getattr(description_part, member.name)
            if member.name not in omitted and value != member.default:
                is_positional = len(arguments) < _POSITIONAL_COUNTS.get(class_name, 0)
                # An argument with an empty name is positional.
                # The public class BitField has the names of the plan.
                member_name = member.name if class_name == "BitField" else _RUNTIME_NAMES.get(member.name, member.name)
                name = "" if is_positional else member_name
                arguments.append((name, self._literal_of(value)))
        return CallLiteral(class_name, tuple(arguments))


def _fold_steps(frame_crc: FrameCrc) -> tuple[CallLiteral, ...]:
    """Return the steps that compute a CRC without a table, such as ``Fold(shift=8, mask=0x3F, back=2)``."""
    steps = frame_crc.steps
    return tuple(
        record_call("Fold", {"shift": step.shift, "mask": Hex(step.mask), "back": step.second_shift}) for step in steps
    )
