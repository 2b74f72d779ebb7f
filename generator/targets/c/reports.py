"""The reports of a family in C, its alarms, and the functions for the reports and the verdict of a frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...language.document import Path
from ...model import (
    Alarm,
    Device,
    Field,
    Layout,
    Verdict,
    cite,
    first_or_raise,
    member_named,
)
from ...plan.operations import FieldToDecode, Reserved
from ...plan.values import ActiveFlag
from ...plan.verdicts import (
    Cause,
    CodeCondition,
    MatchingValues,
    NumberedReport,
    ReportsAndVerdict,
    VerdictCause,
    reportings,
    reports_of,
)
from ...say.commands_and_alarms import alarm_of, alarm_source, remedy
from ...say.commands_and_alarms import meaning as report_meaning
from ...say.names_and_evidence import title_of
from ...say.text import statement
from .. import TargetError
from .about import about_alarm
from .comments import HEADER_STYLE
from .context import CEnumeration, EnumConstant, HeaderContext
from .expressions import (
    CCast,
    CExpression,
    CName,
    CNumber,
    Conditional,
    COperation,
    ExpressionTranslator,
    join_operands,
)
from .names import CMacro, DeclaredName, c_name, c_number, unsigned

_UNUSED_MEMBER = CName("frame->unused")


class FrameReports:
    """The functions of a frame that return its verdict, which says whether the position is usable, and its reports.

    ``verdict`` and ``reports`` are the names of the functions, empty if the frame does not have the function.
    ``enumeration_by_field`` contains the enumerations of named values by layout and field.
    """

    def __init__(
        self,
        family: Reports,
        reporting: ReportsAndVerdict,
        frame: str,
        type_: str,
        choices: Mapping[tuple[str, str], CEnumeration],
    ) -> None:
        self.family_reports = family
        self.reporting = reporting
        self.frame = frame
        self.type = type_
        self._enumeration_by_field = choices

        self.verdict_rules = reporting.verdict_rules
        self.verdict_function = f"{frame}_verdict" if reporting.verdict_rules is not None else ""
        self.reports_function = f"{frame}_reports" if reporting.causes else ""
        self._mask_of_all_unused = sum(reserved.mask for reserved in reporting.layout_plan.reserved)

    def names(self) -> Iterator[str]:
        """Yield the names of the functions and macros that the frame has."""
        yield from filter(None, (self.verdict_function, self.reports_function))
        yield from (mask.name for mask in self.unused_masks)

    @property
    def unused_masks(self) -> Iterator[EnumConstant]:
        """The bits of the member ``unused`` that belong to each reported field, unless it has all of them."""
        for cause in (report_cause.cause for report_cause in self.reporting.causes):
            if isinstance(cause, Reserved) and cause.mask != self._mask_of_all_unused:
                note = f"{cause.field.name} in the member unused"
                yield EnumConstant(name=self._name_of_mask(cause), value=cause.mask, note=note)

    def _name_of_mask(self, reserved: Reserved) -> str:
        """Return the macro for the bits of an unused field, such as ``ACME_X_UNUSED_STATUS``."""
        return f"{self.frame}_unused_{reserved.field.name}".upper()

    @property
    def mask_terms(self) -> Iterator[CExpression]:
        """The terms of the mask of active reports, such as ``frame->error ? ACME_X_REPORT_ERROR : 0U``."""
        for report_cause in self.reporting.causes:
            applies_to_code = self._express_code_conditions(report_cause.conditions)
            condition = join_operands("&&", (*applies_to_code, self._is_active(report_cause.cause)))
            yield Conditional(
                condition, value_if_true=self.family_reports.constant(report_cause.report), value_if_false=CNumber(0)
            )

    def _express_code_conditions(self, code_conditions: Sequence[CodeCondition]) -> list[CExpression]:
        """Return the conditions on the order code under which a flag exists or counts, as C. Often there are none."""
        return [_express_code_condition(self.family_reports.translator, condition) for condition in code_conditions]

    @property
    def verdict_depends_on_variant(self) -> bool:
        """True if the verdict depends on the order code or on an answer of the user."""
        if self.may_be_unknown:
            return True
        return any(cause.conditions for _, causes in self._causes_by_verdict for cause in causes)

    @property
    def may_be_unknown(self) -> bool:
        """True if some order codes have no bits in the frame that say whether the position is usable."""
        return self.verdict_rules is not None and self.verdict_rules.may_be_unknown

    @property
    def reports_depend_on_code(self) -> bool:
        """True if the reports depend on the order code."""
        return any(report_cause.code_condition for report_cause in self.reporting.causes)

    @property
    def _causes_by_verdict(self) -> tuple[tuple[Verdict, tuple[VerdictCause, ...]], ...]:
        """The verdicts, worst first, each with the flags and bits that cause it."""
        return self.verdict_rules.worst_first if self.verdict_rules is not None else ()

    def _is_active(self, cause: Cause) -> CExpression:
        """Return the condition that a flag or named value is active, or that an unused bit differs from the manual."""
        if isinstance(cause, Reserved):
            return self._differs_in([cause])
        return join_operands("&&", tuple(self._conditions_of(cause)))

    def _conditions_of(self, flag_or_match: FieldToDecode | MatchingValues) -> Iterator[CExpression]:
        """Yield the conditions under which a flag is active, or all given values of a match are present.

        Examples are ``frame->error`` for a flag, and ``!frame->ok`` and ``frame->mode == A`` for a match.
        """
        if isinstance(flag_or_match, FieldToDecode):
            yield CName(_struct_member(flag_or_match))
            return
        for decoded_field, value in flag_or_match.conditions:
            member = _struct_member(decoded_field)
            if isinstance(decoded_field.meaning, ActiveFlag):
                # The value of a flag is 1 while it is active.
                yield CName(member if value else f"!{member}")
            else:
                enumeration = self._enumeration_by_field[self.reporting.layout_plan.layout.name, decoded_field.name]
                yield COperation("==", (CName(member), CName(enumeration.constant_by_value[value])))

    @property
    def conditions_of_worse_verdicts(self) -> Iterator[tuple[CExpression, Verdict]]:
        """The conditions under which a frame has a verdict other than the normal one, each with the verdict.

        The worst verdict comes first. Flags with the same verdict have separate conditions, which compilers merge to
        one test of the bits of the frame. Conditions joined by ``||`` are slower, because compilers then load
        neighboring members as one number, and the decoder must store them first.
        """
        if self.verdict_rules is None:
            return
        causes_by_verdict = dict(self._causes_by_verdict)
        for verdict in Verdict:
            if verdict is Verdict.UNKNOWN and self.verdict_rules.may_be_unknown:
                judges_if_positive = self.family_reports.translator.to_c(self.verdict_rules.judges_if_positive)
                yield COperation("==", (judges_if_positive, CNumber(0))), verdict
            else:
                for condition in self._conditions_of_causes(causes_by_verdict.get(verdict, ())):
                    yield condition, verdict

    def _conditions_of_causes(self, causes: Sequence[VerdictCause]) -> Iterator[CExpression]:
        """Yield the condition of each cause of a verdict. All unused bits have one condition, the last one.

        A flag counts only for its order codes or answers, and only while its ``overriding_flags``, which it combines,
        are inactive.
        """
        unused_fields = []
        for cause in causes:
            if isinstance(cause.cause, Reserved):
                unused_fields.append(cause.cause)
            else:
                applies_to_code = self._express_code_conditions(cause.conditions)
                combining_flags_are_inactive = [CName(f"!{_struct_member(flag)}") for flag in cause.overriding_flags]
                conditions = (*applies_to_code, *self._conditions_of(cause.cause), *combining_flags_are_inactive)
                yield join_operands("&&", conditions)
        if unused_fields:
            yield self._differs_in(unused_fields)

    def _differs_in(self, reserved: Sequence[Reserved]) -> CExpression:
        """Return the condition that a bit of these unused fields differs from the manual.

        The member ``unused`` has a 1 in each bit that differs. If the fields are all unused fields of the frame, the
        condition is ``frame->unused != 0U``. Otherwise, the member is masked with the macros of the fields.
        """
        # The masks have no common bits.
        if sum(field.mask for field in reserved) == self._mask_of_all_unused:
            differing_bits: CExpression = _UNUSED_MEMBER
        else:
            mask = join_operands("|", tuple(CName(self._name_of_mask(field)) for field in reserved))
            differing_bits = COperation("&", (_UNUSED_MEMBER, mask))
        return COperation("!=", (differing_bits, CNumber(0)))


class Reports:
    """All reports of a family, such as alarms and unused bits that differ from the manual, each with a bit in a mask.

    ``mask`` is the C type of the mask.

    Raises:
        TargetError: There are more than 64 reports.
    """

    def __init__(
        self,
        device: Device,
        prefix: str,
        choices: Mapping[tuple[str, str], CEnumeration],
        translator: ExpressionTranslator,
    ) -> None:
        self.all_reports = reports_of(device)
        self._enumeration_by_field = choices
        self.translator = translator
        bits_in_mask = 64
        if len(self.all_reports) > bits_in_mask:
            problem = f"the frames have {len(self.all_reports)} flags, values and fields of unused bits to report"
            raise TargetError(f"{problem}; the C target supports at most {bits_in_mask}", ("interfaces",))
        self.mask_type = unsigned(max(len(self.all_reports), 32))
        self.text_function = f"{prefix}_report_text"
        self.texts_by_report = tuple(_text_members(device, report) for report in self.all_reports)
        type_ = f"{prefix}_report"
        constants: list[EnumConstant] = []
        for report in self.all_reports:
            name = f"{type_}_{report.name}".upper()
            constants.append(EnumConstant(name=name, value=1 << report.number, note=_describe_report(device, report)))
        self.enumeration = CEnumeration(
            type=type_,
            about="Reports of the encoder. The _reports() functions of the frames return a mask of these bits.",
            statements=(),
            constants=tuple(constants),
            hex_digits=(len(self.all_reports) + 3) // 4,
            path=(),
        )
        self._by_frame = reportings(device)

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names at file scope, each with the part of the spec that it comes from."""
        if self.all_reports and self.enumeration.is_enum:
            yield self.enumeration.type, ()
        if self.all_reports:
            yield self.text_function, ()
        for report, constant in zip(self.all_reports, self.enumeration.constants, strict=True):
            yield constant.name, self._find_path(report)

    def of(self, layout: Layout, name: str, type_: str) -> FrameReports | None:
        """Return the functions for the reports and the verdict of a frame, or None if it has no flags to report.

        ``name`` and ``type_`` are the name and type of its struct.
        """
        reporting = self._by_frame.get(layout.name)
        if reporting is None:
            return None
        return FrameReports(
            family=self, reporting=reporting, frame=name, type_=type_, choices=self._enumeration_by_field
        )

    def constant(self, report: NumberedReport) -> CExpression:
        """Return the bit of a report, as a number of the type of the mask."""
        constant = CName(self.enumeration.constants[report.number].name)
        return CCast(self.mask_type, constant) if self.enumeration.is_enum else constant

    def _find_path(self, report: NumberedReport) -> Path:
        """Return the path of the first frame with this report."""
        reportings_with_it = (reporting for reporting in self._by_frame.values() if _has_report(reporting, report))
        first_reporting = first_or_raise(reportings_with_it, f"frame with the report '{report.name}'")
        return ("interfaces", first_reporting.interface.name, "layouts", first_reporting.layout_plan.layout.name)


def _has_report(reporting: ReportsAndVerdict, report: NumberedReport) -> bool:
    """Return True if a frame can have the report."""
    return any(report_cause.report.number == report.number for report_cause in reporting.causes)


def _text_members(device: Device, report: NumberedReport) -> tuple[str, ...]:
    """Return the texts that describe a report: its name, printed name, meaning, remedy and source."""
    field = report.field
    alarm = alarm_of(device, field)
    return (
        report.name,
        field.printed_name,
        report_meaning(field, alarm),
        remedy(field, alarm),
        cite(alarm_source(field, alarm)),
    )


def _describe_report(device: Device, report: NumberedReport) -> str:
    """Return the comment on a report: the title of its field, ``unused`` for unused bits, and the source."""
    field = report.field
    unused = ", unused" if report.is_unused else ""
    source = alarm_source(field, alarm_of(device, field))
    return HEADER_STYLE.sentence(statement(title_of(field), unused, source=source))


def _express_code_condition(translator: ExpressionTranslator, condition: CodeCondition) -> CExpression:
    """Return a condition on a parameter of the order code, such as ``variant.has_error != 0U``.

    The parameter must not be 0 if ``condition.holds`` is True, and must be 0 otherwise.
    """
    operator = "!=" if condition.holds else "=="
    return COperation(operator, (translator.member(condition.parameter), CNumber(0)))


def _struct_member(decoded_field: FieldToDecode) -> str:
    """Return the member of a flag or field in the struct of a frame."""
    return f"frame->{c_name(decoded_field.name)}"


class AlarmCode:
    """The values that the templates print for an alarm."""

    def __init__(self, context: HeaderContext, alarm: Alarm) -> None:
        self.alarm = alarm
        self.about = about_alarm(context.device, alarm)
        self.macros = tuple(_alarm_macros(context.device, alarm, f"{context.PREFIX}_ALARM_{alarm.name.upper()}"))

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names of the macros, each with the path of the alarm in the spec."""
        for macro in self.macros:
            yield macro.name, ("alarms", self.alarm.name)


def _alarm_macros(device: Device, alarm: Alarm, stem: str) -> Iterator[CMacro]:
    """Yield the macros of an alarm: the mask of its bits, and the supply voltage below which it is raised."""
    bits, note = _alarm_mask(device, alarm)
    if bits:
        yield CMacro(f"{stem}_MASK", value=c_number(bits, hexadecimal=True), note=note)
    if alarm.below_mv is not None:
        yield CMacro(f"{stem}_BELOW_MV", value=c_number(alarm.below_mv), note="raised below this, in millivolts")


def _alarm_mask(device: Device, alarm: Alarm) -> tuple[int, str]:
    """Return the mask of an alarm in its byte of a frame, or else in its register, and a note on the mask.

    The mask is 0 if the alarm has no bits at a fixed place. The note is empty unless the frame has several bytes of
    flags, in which the same mask can occur again.
    """
    frame_field = _frame_field_of(device, alarm)
    if frame_field is not None and len(frame_field.bit_slices) == 1:
        (bit_slice,) = frame_field.bit_slices
        group = member_named(device.field_groups, alarm.group, "field group")
        note = "in its byte" if group.bits > 8 else ""
        return bit_slice.mask << bit_slice.low_in_byte, note
    if not alarm.register:
        return 0, ""
    layout = device.register(alarm.register).layout
    register_field = layout.field(alarm.field) if alarm.field else layout.fields[0]
    # A flag whose place depends on the order code has no mask. The decoder of the register finds it.
    mask = register_field.mask_in_place if register_field.is_fixed else 0
    return mask, ""


def _frame_field_of(device: Device, alarm: Alarm) -> Field | None:
    """Return the field of a frame that reports the alarm, from the first frame that has it at a fixed place.

    The result is None if no frame has it, or if the alarm is in no group of flags.
    """
    if not alarm.group:
        return None
    for _, layout in device.layouts():
        for field in layout.fields:
            if field.group == alarm.group and field.name == alarm.field and field.bit_slices:
                return field
    return None
