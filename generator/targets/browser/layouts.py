"""Frames and registers as plain data for the script: their descriptions, and the texts about them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import fields
from enum import Enum
from typing import Any

from ...model import (
    Alarm,
    Device,
    Digits,
    Field,
    Interface,
    Layout,
    Register,
    RegisterMeaning,
    Scale,
    Value,
    channel_frame,
    cite,
)
from ...model.expressions import Expression, Factor, Term
from ...model.keys_and_members import LARGEST
from ...model.record import assert_never
from ...plan.codec import LayoutPlan, layout_plan_of
from ...plan.description import Check as DescribedCheck
from ...plan.description import DescribedReportCause, Description, Name, describe
from ...plan.limits import NumberLimits, limits_of
from ...plan.operations import (
    AlwaysIs,
    AtMost,
    Check,
    ConstantNumber,
    IsBetween,
    IsOneOf,
    JoinNotAbove,
    NotAbove,
    ParityIs,
    ParityOf,
    ReservedBits,
    ZerosAbove,
)
from ...plan.verdicts import ReportCause, ReportsAndVerdict, codes_with_explanation
from ...say.commands_and_alarms import alarm_of, alarm_source, flag_state_meanings, meaning, remedy
from ...say.layout import box_colour
from ...say.names_and_evidence import register_at, title_of
from ...say.register import describe_register_facts
from ...say.text import PLAIN_STYLE, spec_text
from ...why.exchanges import own_replies, usual_values_of
from ...why.other_order_codes import states_of_widths
from .messages import edition_tests

Data = dict[str, Any]
#: Characters that could end the surrounding script element, an HTML comment, or a line of the script.
_SCRIPT_ESCAPES = {ord(mark): f"\\u{ord(mark):04x}" for mark in "<>&\u2028\u2029"}


def without_empty(**members: Any) -> Data:
    """Return the members that are not None, 0, empty or False. A name such as ``is_`` loses its underscore."""
    return {name.rstrip("_"): value for name, value in members.items() if value not in (None, 0, "", (), [], {})}


def json_number(value: int) -> int | str:
    """Return a number, or a hexadecimal text if JavaScript would round it."""
    return value if abs(value) <= LARGEST else f"{value:#x}"


def expression_data(expression: Expression) -> Any:
    """Return an expression of the spec as data: a number, or a list of a number and terms.

    A term is a list of a multiple and factors, and ``^name`` is two to the power ``name``. For example, ``8 + 2 * turns
    - 2 ** bits`` becomes ``[8, [2, "turns"], [-1, "^bits"]]``.
    """
    if expression.is_constant:
        return json_number(expression.constant)
    return [json_number(expression.constant), *map(_term_data, expression.terms)]


def _term_data(term: Term) -> list[int | str]:
    """Return a term of an expression: its multiple and its factors, such as ``[2, "turns"]``."""
    return [json_number(term.multiple), *map(_factor_text, term.factors)]


def _factor_text(factor: Factor) -> str:
    """Return a factor: the name of a parameter, or for a power of two ``^`` and the name of its exponent."""
    return f"^{factor.parameter}" if factor.power else factor.parameter


def optional_expression_data(value: Expression | None) -> Any:
    """Return an expression of the spec as data, or None for None."""
    return None if value is None else expression_data(value)


def plain_data(value: Any) -> Any:
    """Return any part of the description of a frame as plain data that JSON can express.

    A dataclass becomes a dictionary by the names of its members. Members that are left out are those with their default
    value, those that are None, 0, empty or False, and those that ``==`` ignores. Tuples and scales become lists.
    """
    match value:
        case Expression():
            return expression_data(value)
        case Enum():
            return value.value
        case bool() | int():
            return json_number(int(value))
        case tuple():
            return [plain_data(element) for element in value]
        case None | str():
            return value
        case Scale(numerator, denominator, offset, unit):
            return [numerator, denominator, offset, unit, value.places]
    members: Data = {}
    for member in fields(value):
        member_value = getattr(value, member.name)
        if member.compare and member_value != member.default:
            members[member.name] = plain_data(member_value)
    return without_empty(**members)


def script_json(value: object, indent: int | None = None) -> str:
    """Return data as JSON that is also valid JavaScript and cannot end the markup around the script."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), indent=indent)
    return text.translate(_SCRIPT_ESCAPES)


class SharedParts:
    """The fields, checks and reports of frames and registers, each once, because many frames share them."""

    def __init__(self) -> None:
        self.parts: list[Data] = []
        self._indexes: dict[str, int] = {}

    def with_indexes(self, layout: Data) -> Data:
        """Return a layout with indexes in place of its fields, checks and reports, such as ``{"fields": [0, 4], …}``.

        Parts that are new are added to ``parts``.
        """
        names = [name for name in ("fields", "checks", "tells") if name in layout]
        return layout | {name: list(map(self._index_of_part, layout[name])) for name in names}

    def _index_of_part(self, part: Data) -> int:
        """Return the index of a part in ``parts``, and add the part unless ``parts`` contains an equal one."""
        next_index = len(self.parts)
        index = self._indexes.setdefault(script_json(part), next_index)
        is_new = index == next_index
        if is_new:
            self.parts.append(part)
        return index


def channel_data(device: Device, interface: Interface) -> Data:
    """Return the frame with all data channels of an interface, or an empty dict if frames have one channel.

    ``order`` contains the indexes of the channels among the frames of the interface. ``position`` is the index in
    ``order`` of the channel with the position. ``compared`` are fields that must agree, each as the index of its
    channel in ``order`` and its name.
    """
    frame = channel_frame(interface)
    if frame is None:
        return {}
    has_position = [device.sends_position(interface.name, layout) for layout in frame.layouts]
    index_of_position = has_position.index(True)
    return without_empty(
        order=[interface.layouts.index(layout) for layout in frame.layouts],
        compared=[[frame.layouts.index(field.layout), field.name] for field in frame.compared],
        compared_bits=optional_expression_data(frame.compared_bits if frame.compared else None),
        tolerance=frame.tolerance,
    ) | {"position": index_of_position}


def frame_data(device: Device, interface: str, layout: Layout, reporting: ReportsAndVerdict | None) -> Data:
    """Return a frame with its verdict and its reports (``tells``). ``reporting`` is None if it has neither.

    ``usual`` contains the values that fields usually have. They are evidence that bytes are this frame. ``reply`` names
    the reply to a request over RS-485, if the encoder has several.
    """
    replies = [other for other in device.interface(interface).layouts if other.sender == "encoder"]
    reply = own_replies(device.interface(interface)).get(layout.name, "") if len(replies) > 1 else ""
    usual_values = usual_values_of(device, interface, layout)
    layout_plan = layout_plan_of(device, layout)
    description = describe(layout_plan, reporting)
    causes = reporting.causes if reporting is not None else ()
    reports: list[Data] = []
    for described_cause, cause in zip(description.report_causes, causes, strict=True):
        reports.append(_report_data(device, described_cause, cause))
    # The reports have the order of the fields in the frame. Reports about several fields with a verdict come last.
    flags = (*layout.fields, *(sign.flag for sign in layout.signs))
    flag_names = [flag.name for flag in flags]
    return _layout_data(device, layout_plan, description) | without_empty(
        title=title_of(layout),
        source=cite(layout.source),
        sender=layout.sender,
        channel=layout.channel,
        selector=layout.selector,
        selects=[json_number(value) for value in layout.selects],
        usual=[[name, *map(json_number, values)] for name, values in usual_values.items()],
        reply=reply,
        tells=sorted(reports, key=lambda report: flag_names.index(report["flag"])),
    )


def register_data(device: Device, register: Register) -> Data:
    """Return a register with its alarms (``tells``), its limits and its default.

    ``strange`` are values of digits that show that an older edition of the manual applies to the encoder.
    """
    meanings: tuple[RegisterMeaning | None, ...] = register.meanings or (None,)
    default = register.default_bytes()
    statements = (*spec_text(register.meaning), *describe_register_facts(device, register), *spec_text(register.note))
    alarm_reports = []
    for field in register.layout.fields:
        alarm = alarm_of(device, field, register.name)
        if alarm is not None:
            alarm_reports.append(_alarm_report_data(field, alarm))
    layout_plan = layout_plan_of(device, register.layout)
    return _layout_data(device, layout_plan, describe(layout_plan)) | without_empty(
        title=title_of(register),
        source=cite(register.source),
        place=register_at(register),
        length=register.length,
        # The script states the limits in numbers of the order code.
        about=[PLAIN_STYLE.sentence(statement) for statement in statements if statement.label != "Limits"],
        writable=register.writable,
        default=default.hex(" ").upper() if default is not None else "",
        limits=[_limits_data(case, limits_of(device, register, case)) for case in meanings],
        tells=alarm_reports,
        strange=[*edition_tests(device, register)],
    )


def _report_data(device: Device, described_cause: DescribedReportCause, cause: ReportCause) -> Data:
    """Return a report of a frame, such as an error, with its texts."""
    data: Data = plain_data(described_cause)
    return data | _report_texts(cause.described_field, alarm_of(device, cause.described_field))


def _alarm_report_data(field: Field, alarm: Alarm) -> Data:
    """Return the report of an alarm in a register with its texts."""
    data: Data = plain_data(DescribedReportCause(report="", flag=Name(field.name), only=codes_with_explanation(field)))
    return data | _report_texts(field, alarm)


def _layout_data(device: Device, layout_plan: LayoutPlan, description: Description) -> Data:
    """Return the description of a frame or register with the texts about its parts.

    ``asks`` are the open questions that must be answered to decode it, and ``offers`` those whose answers only change
    the verdict.
    """
    described_members = {
        "bits": description.bits,
        "order": description.order,
        "exchanged": description.exchanged_bytes,
        "joins": description.joins,
        "speaks": description.verdict_causes,
        "digits": description.digit_codings,
        "gray": description.gray,
        "otherwise": description.otherwise,
        "judges_if_positive": description.judges_if_positive,
    }
    checks = zip(description.checks, layout_plan.checks, strict=True)
    crc = layout_plan.crc_of_all_order_codes
    optional_crcs = {
        frame_crc.field.name: frame_crc.crc.name for frame_crc in layout_plan.crcs if frame_crc.is_optional
    }
    return without_empty(
        name=layout_plan.layout.name,
        **{name: plain_data(member) for name, member in described_members.items()},
        fields=[*_field_data(layout_plan, description)],
        checks=[_check_data(check) | _check_message(layout_plan.layout, operation) for check, operation in checks],
        # A byte that the bits sent do not fill begins with these zeros.
        fill=(layout_plan.layout.bits - layout_plan.layout.sent_bits).constant,
        crc=crc.crc.name if crc is not None else "",
        # For each register field that decides the length, all values of its parameters.
        states=[[*map(dict, states)] for states in states_of_widths(device, layout_plan.layout)],
        crcs=optional_crcs,
        # If the CRC covers only a part of the frame: the lowest bit, and the number of bits.
        crc_of=[crc.lowest_covered_bit, crc.covered_width.constant] if crc is not None and crc.covers_part_only else [],
        asks=[alternative.name for alternative in layout_plan.alternatives],
        offers=[alternative.name for alternative in device.verdict_alternatives(layout_plan.layout)],
        held=_parameters_in_registers(device, layout_plan.layout, layout_plan),
    )


def _parameters_in_registers(device: Device, layout: Layout, layout_plan: LayoutPlan) -> list[str]:
    """Return the names of the parameters in registers that change the form of a frame.

    They change its length, the places and widths of its fields, or whether it has Gray code.
    """
    names_in_layout = set(layout.bits.parameters)
    for field in layout.fields:
        names_in_layout.update(field.low.parameters, field.width.parameters)
    if layout.gray_excess is not None:
        names_in_layout.update(layout.gray_excess.parameters)
    if layout_plan.gray is not None and layout_plan.gray.when:
        names_in_layout.add(layout_plan.gray.when)
    needed_names = device.needed_parameters(names_in_layout)
    return [parameter.name for parameter in device.run_time_parameters if parameter.name in needed_names]


def _field_data(layout_plan: LayoutPlan, description: Description) -> Iterator[Data]:
    """Yield the data of each field: its bits, the texts about it, and how it is encoded if users do not provide it.

    Users do not provide constants, parity bits and CRCs.
    """
    encoded_values = {encoded_field.name: encoded_field.value for encoded_field in layout_plan.encoded_fields}
    for column, field in zip(description.columns, layout_plan.layout.fields, strict=True):
        when_active, when_inactive = flag_state_meanings(field)
        # The condition on the order code under which the manual explains the field.
        code_condition = codes_with_explanation(field)
        texts = without_empty(
            printed=field.printed_name,
            meaning=field.meaning,
            on=when_active,
            off=when_inactive,
            only=code_condition.parameter if code_condition is not None else "",
            values=[_value_data(value) for value in field.values],
            runs=[_digits_data(run) for run in field.runs],
            unit=field.unit,
            equals=_documented_value(field),
            colour=box_colour(field),
        )
        yield plain_data(column) | texts | _encoding_data(encoded_values.get(field.name))


def _value_data(value: Value) -> list[Any]:
    """Return a named value: its number, its name, and its meaning if it has one."""
    return _without_empty_end(json_number(value.value), value.name, value.meaning)


def _digits_data(digit_run: Digits) -> list[Any]:
    """Return some decimal digits of a field: their name, divisor, modulus, and their meaning if they have one."""
    return _without_empty_end(
        digit_run.name, json_number(digit_run.divisor), json_number(digit_run.modulus), digit_run.meaning
    )


def _without_empty_end(*row: Any) -> list[Any]:
    """Return a row without its last value if that is empty."""
    *beginning, last_value = row
    return [*row] if last_value else beginning


def _documented_value(field: Field) -> Any:
    """Return the value that the manual states for a field, or None if it states none.

    The value is a text, or a number or expression in a list such as ``[27]``. A plain 0 would be left out as empty,
    unlike ``[0]``.
    """
    value = field.equals
    if value is None or isinstance(value, str):
        return value
    expression = value if isinstance(value, Expression) else Expression(value)
    return [expression_data(expression)]


def _encoding_data(value: object) -> Data:
    """Return how a field is encoded that users do not provide, or an empty dict for a field that they provide.

    ``value`` is the planned value of the field, or None for a CRC.
    """
    match value:
        case ConstantNumber(constant):
            return {"fixed": json_number(constant)}
        case ParityOf(covered_fields, odd, mask):
            parity: Data = {"parity": [field.name for field in covered_fields], "odd": int(odd)}
            return parity | without_empty(mask=json_number(mask))
        case ReservedBits(documented, place):
            return {"unused": json_number(documented), "place": place}
        case None:
            return {"crc": 1}
    return {}


def _check_data(check: DescribedCheck) -> Data:
    """Return a check without its message. Its limit is included even if it is 0."""
    data: Data = plain_data(check)
    return data | {"limit": expression_data(check.limit)} if check.limit is not None else data


def _check_message(layout: Layout, check: Check) -> Data:
    """Return the message for a check that fails. ``says`` is the key of the message, and other members are filled in.

    ``always`` is 1 if the bits have only one valid value in this frame, so that they distinguish it from other frames.
    """
    field_name = check.field.name
    always = False
    highest_digit = 0
    covered_names: list[str] = []
    code = ""
    match check:
        case AlwaysIs():
            message = "constant"
            always = True
        case ZerosAbove(padding=padding):
            message = "constant"
            always = True
            field_name = padding.name
        case ParityIs():
            message = "parity"
            always = True
            covered_names = [field.name for field in check.covered_fields]
        case IsOneOf(field=field):
            always = field.name == layout.selector
            message = "of_other_frame" if always else "no_value"
        case AtMost():
            message = "digits"
            highest_digit = check.digits
        case NotAbove(code=code):
            message = "not_in_code" if code else "too_high"
        case IsBetween():
            message = "outside"
        case JoinNotAbove(joined_number=whole):
            message = "too_high"
            field_name = whole.join.name
        case _:
            assert_never(check)
    return without_empty(
        field=field_name, says=message, always=int(always), most=highest_digit, of_names=covered_names, code=code
    )


def _report_texts(field: Field, alarm: Alarm | None) -> Data:
    """Return the meaning, remedy and source of a report, shown while the field is active or differs from the manual."""
    source_text = cite(alarm_source(field, alarm))
    return without_empty(meaning=meaning(field, alarm), remedy=remedy(field, alarm), source=source_text)


def _limits_data(register_meaning: RegisterMeaning | None, limits: NumberLimits) -> Data:
    """Return the limits of a register, or of one of its meanings, which are uses with limits of their own.

    ``low`` and ``high`` are None if the manual does not give the limit.
    """
    data = without_empty(
        name=register_meaning.name if register_meaning is not None else "",
        meaning=register_meaning.meaning if register_meaning is not None else "",
        of=limits.member,
    )
    data["low"] = optional_expression_data(limits.lowest)
    data["high"] = optional_expression_data(limits.highest)
    return data
