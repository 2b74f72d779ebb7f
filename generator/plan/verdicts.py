"""Verdict on the position of a frame, and the reports of the encoder that decide it.

A valid frame may contain an unusable position, since an encoder with an error, or a busy one, also sends valid CRCs.
The verdict of each flag, value and reserved bit comes from the model: ``loading/fields`` and ``model/interfaces`` set
it, ``model/layout`` finds the fields that judge the position, and ``reference/findings`` decides independently.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import field as dataclass_field
from dataclasses import replace
from typing import NamedTuple

from ..model import Device, Field, Flag, Interface, Layout, Verdict
from ..model.expressions import Expression
from ..model.kinds import Unused
from ..model.record import dataclass
from .codec import LayoutPlan, layout_plan_of
from .operations import FieldToDecode, Reserved


@dataclass(frozen=True, slots=True)
class CodeCondition:
    """A condition on a parameter of the order code: its value is not 0 if ``holds`` is true, otherwise it is 0.

    ``codes`` is the text in the spec that selects the order codes with a value other than 0.
    """

    parameter: str
    holds: bool
    codes: str = dataclass_field(default="", compare=False)

    def contains(self, parameters: Mapping[str, int]) -> bool:
        """Return whether an order code with these parameters meets the condition. A missing parameter is 0."""
        is_nonzero = parameters.get(self.parameter, 0) != 0
        return is_nonzero is self.holds


@dataclass(frozen=True, slots=True)
class MatchingValues:
    """A combination of values that decides the verdict like an active flag.

    ``field`` is this flag, which has a name and a meaning but no bits. ``conditions`` are the fields of the frame, each
    with its value in this combination. The value of an active flag is 1.
    """

    field: Field
    conditions: tuple[tuple[FieldToDecode, int], ...]


#: Cause of a verdict or a report: a flag, reserved bits, or values.
Cause = FieldToDecode | Reserved | MatchingValues


@dataclass(frozen=True, slots=True)
class VerdictCause:
    """Cause of a verdict: ``cause`` a flag, reserved bits, or a combination of values.

    A flag that combines several others has no effect while one of the ``overriding_flags`` is active. They omit
    flags that lead to the same verdict or a worse one, since they make no difference. ``code_condition`` selects the
    order codes to which the cause applies, or is None for all of them. If an answer of the user to an open question
    decides the verdict, ``answer_condition`` is the condition on the parameter that the answer sets.
    """

    cause: Cause
    overriding_flags: tuple[FieldToDecode, ...]
    code_condition: CodeCondition | None = None
    answer_condition: CodeCondition | None = None

    @property
    def conditions(self) -> tuple[CodeCondition, ...]:
        """Conditions on parameters, all of which must be met for the cause to apply."""
        return tuple(condition for condition in (self.code_condition, self.answer_condition) if condition is not None)


@dataclass(frozen=True, slots=True)
class VerdictRules:
    """Verdict on a position: the verdict of the worst active cause, or ``default_verdict`` if none is active.

    If ``default_verdict`` is UNKNOWN, warnings have no effect, since UNKNOWN is worse than a warning.
    ``judges_if_positive`` is positive for order codes whose frames say whether the position is usable. For other order
    codes, UNKNOWN is also a verdict.
    """

    not_usable: tuple[VerdictCause, ...]
    with_warning: tuple[VerdictCause, ...]
    default_verdict: Verdict
    judges_if_positive: Expression

    @property
    def may_be_unknown(self) -> bool:
        """True if only the frames of some order codes have bits that judge the position."""
        return not self.judges_if_positive.is_constant

    def for_parameters(self, parameters: Mapping[str, int]) -> VerdictRules:
        """Return the rules for an order code with these parameters, without causes whose bits its frames lack.

        If no bit of its frames says whether the position is usable, ``default_verdict`` is UNKNOWN. The causes of
        warnings are then omitted, since UNKNOWN is worse than a warning.
        """
        not_usable = tuple(cause for cause in self.not_usable if _has_bits(cause.cause, parameters))
        judges_position = self.judges_if_positive.value(parameters) > 0
        if not judges_position:
            return VerdictRules(not_usable, (), default_verdict=Verdict.UNKNOWN, judges_if_positive=Expression(0))
        with_warning = tuple(cause for cause in self.with_warning if _has_bits(cause.cause, parameters))
        return VerdictRules(not_usable, with_warning, self.default_verdict, judges_if_positive=Expression(1))

    @property
    def worst_first(self) -> tuple[tuple[Verdict, tuple[VerdictCause, ...]], ...]:
        """Verdicts with causes, worst first, each with its causes."""
        verdicts_with_causes = []
        if self.not_usable:
            verdicts_with_causes.append((Verdict.NOT_USABLE, self.not_usable))
        if self.with_warning:
            verdicts_with_causes.append((Verdict.USABLE_WITH_WARNING, self.with_warning))
        return tuple(verdicts_with_causes)


def _has_bits(cause: Cause, parameters: Mapping[str, int]) -> bool:
    """Return whether the frames of an order code with these parameters contain all fields of a cause.

    A field whose width is 0 for the order code is not in its frames.
    """
    if isinstance(cause, MatchingValues):
        bits_of_cause = [decoded_field.bits for decoded_field, _ in cause.conditions]
    else:
        bits_of_cause = [cause.bits]
    return all(bits.width.value(parameters) > 0 for bits in bits_of_cause)


def verdict_rules_of(layout_plan: LayoutPlan) -> VerdictRules:
    """Return the rules by which the bits of a frame determine whether its position is usable.

    If the frame has no bits for this purpose with any order code, the verdict without an active cause is UNKNOWN.
    Causes of warnings are then omitted, since UNKNOWN is worse than a warning.
    """
    causes_by_verdict: dict[Verdict, list[VerdictCause]] = {verdict: [] for verdict in Verdict}
    for cause in verdict_causes(layout_plan):
        match cause.field.kind:
            case Flag():
                for verdict, verdict_cause in _verdicts_of_flag(cause, _decoded_fields(layout_plan)):
                    causes_by_verdict[verdict].append(verdict_cause)
            case Unused(makes_position=verdict):
                causes_by_verdict[verdict].append(VerdictCause(cause, overriding_flags=()))
    not_usable = tuple(causes_by_verdict[Verdict.NOT_USABLE])
    with_warning: tuple[VerdictCause, ...] = ()
    default_verdict = Verdict.UNKNOWN
    if layout_plan.layout.judges_position:
        with_warning = tuple(causes_by_verdict[Verdict.USABLE_WITH_WARNING])
        default_verdict = Verdict.USABLE
    return VerdictRules(not_usable, with_warning, default_verdict, layout_plan.layout.judges_if_positive)


def _decoded_fields(layout_plan: LayoutPlan) -> dict[str, FieldToDecode]:
    """Return the fields of a frame that carry data, by name."""
    return {decoded_field.name: decoded_field for decoded_field in layout_plan.decoded_fields}


def _verdicts_of_flag(cause: Cause, fields: Mapping[str, FieldToDecode]) -> Iterator[tuple[Verdict, VerdictCause]]:
    """Yield the verdicts to which a flag can lead, each with its conditions on the order code and the user's answer.

    A flag that combines others (``sums_up``) has no effect while one of these is active, because the specific flag
    decides the verdict. ``overriding_flags`` are these flags. ``fields`` are the fields of the frame by name.
    """
    for flag, code_condition in _flag_by_order_code(cause.field):
        combined_flags = [fields[name] for name in flag.sums_up if name in fields]
        for verdict, answer_condition in _verdict_by_answer(flag):
            # A combined flag that leads to the same verdict or a worse one makes no difference.
            milder_flags = [combined for combined in combined_flags if not _always_leads_to(combined, verdict, fields)]
            yield verdict, VerdictCause(cause, tuple(milder_flags), code_condition, answer_condition)


def _flag_by_order_code(field: Field) -> Iterator[tuple[Flag, CodeCondition | None]]:
    """Yield a flag with the condition on the order codes to which it applies, or with None for all order codes.

    A flag that the manual explains only for some order codes is yielded twice: as explained, and as unexplained for the
    other order codes. It is yielded only once if this makes no difference to the verdict.
    """
    flags_with_conditions: list[tuple[Flag, CodeCondition | None]] = []
    for field_for_codes, code_condition in by_order_code(field):
        assert isinstance(field_for_codes.kind, Flag)
        flags_with_conditions.append((field_for_codes.kind, code_condition))
    # ``makes_position`` is the verdict, and ``sums_up`` lists the flags that a flag combines.
    effects_on_verdict = {(flag.makes_position, flag.sums_up, flag.verdict_if_set) for flag, _ in flags_with_conditions}
    if len(effects_on_verdict) == 1:
        first_flag, _ = flags_with_conditions[0]
        yield first_flag, None
    else:
        yield from flags_with_conditions


def _verdict_by_answer(flag: Flag) -> Iterator[tuple[Verdict, CodeCondition | None]]:
    """Yield the verdicts to which an active flag can lead, each with the condition under which it does.

    Most flags lead to one verdict, ``makes_position``, without a condition (None). If the manual is ambiguous, the
    user's answer to a question sets the parameter ``verdict_parameter`` to 0 or 1. With 1, the flag leads to
    ``verdict_if_set`` instead. A flag in a frame without the position leads to no verdict.
    """
    usual_verdict = flag.makes_position
    other_verdict = flag.verdict_if_set
    if usual_verdict is None:
        return
    if other_verdict is None:
        yield usual_verdict, None
    else:
        yield usual_verdict, CodeCondition(flag.verdict_parameter, holds=False)
        yield other_verdict, CodeCondition(flag.verdict_parameter, holds=True)


def _always_leads_to(decoded_flag: FieldToDecode, verdict: Verdict, fields: Mapping[str, FieldToDecode]) -> bool:
    """Return whether a flag leads to ``verdict`` or a worse one, for every order code and every answer of the user.

    Return false if the flag combines others of the frame, since it then has no effect while one of them is active.
    ``fields`` are the fields of the frame by name.
    """
    flag = decoded_flag.field.kind
    if not isinstance(flag, Flag) or flag.makes_position is None:
        return False
    depends_on_order_code = bool(flag.only_while)
    depends_on_answer = flag.verdict_if_set is not None
    combines_others = not fields.keys().isdisjoint(flag.sums_up)
    if depends_on_order_code or depends_on_answer or combines_others:
        return False
    worst_first = list(Verdict)  # The enumeration lists the verdicts from the worst to the best.
    return worst_first.index(flag.makes_position) <= worst_first.index(verdict)


def verdict_causes(layout_plan: LayoutPlan) -> Iterator[Cause]:
    """Yield everything in a frame that can cause a verdict: flags, reserved bits, and combinations of values.

    Flags that lead to no verdict are included. A sign of the layout is a combination of values: fields that decide the
    verdict together if each of them has a certain value.
    """
    fields_of_frame = _decoded_fields(layout_plan)
    for decoded_field in fields_of_frame.values():
        if isinstance(decoded_field.field.kind, Flag):
            yield decoded_field
    yield from layout_plan.reserved
    for sign in layout_plan.layout.signs:
        conditions = [(fields_of_frame[name], value) for name, value in sign.conditions]
        yield MatchingValues(sign.flag, tuple(conditions))


def by_order_code(field: Field) -> Iterator[tuple[Field, CodeCondition | None]]:
    """Yield a field with the condition on the order codes to which it applies, or with None for all order codes.

    A flag that the manual explains only for some order codes is yielded twice: ``overheat`` with the condition for
    these codes, and ``overheat_unexplained`` with the condition for all others.
    """
    match field.kind:
        # The manual explains the flag only for order codes for which this parameter is not 0.
        case Flag(only_while=parameter, only=codes) if parameter:
            yield field, CodeCondition(parameter, holds=True, codes=codes)
            yield unexplained_flag(field), CodeCondition(parameter, holds=False, codes=codes)
        case _:
            yield field, None


def unexplained_flag(field: Field) -> Field:
    """Return a flag such as ``overheat``, named ``overheat_unexplained``, for order codes without an explanation."""
    return replace(field.unexplained, name=f"{field.name}_unexplained")


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class NumberedReport:
    """One report of a family. ``number`` is its bit in the set of all reports.

    ``field`` is the flag, the reserved bits or the flag of a sign, from the first frame that contains them.
    """

    name: str
    number: int
    field: Field

    @property
    def is_unused(self) -> bool:
        """True if it reports reserved bits."""
        return isinstance(self.field.kind, Unused)


@dataclasses.dataclass(frozen=True, slots=True)
class ReportCause:
    """Cause of a report: an active flag, reserved bits that differ from the manual, or a combination of values.

    ``code_condition`` selects the order codes to which the report applies, or is None for all of them.
    """

    report: NumberedReport
    cause: Cause
    code_condition: CodeCondition | None = None

    @property
    def conditions(self) -> tuple[CodeCondition, ...]:
        """The condition on the order code as a tuple, which is empty if the report applies to all order codes."""
        return (self.code_condition,) if self.code_condition is not None else ()

    @property
    def described_field(self) -> Field:
        """The field of the cause, as the manual describes it for these order codes: explained or not."""
        is_explained = self.code_condition is None or self.code_condition.holds
        return self.cause.field if is_explained else unexplained_flag(self.cause.field)


@dataclasses.dataclass(frozen=True, slots=True)
class ReportsAndVerdict:
    """Reports and verdict of one layout. ``verdict_rules`` is None if the layout does not contain the position."""

    interface: Interface
    layout_plan: LayoutPlan
    causes: tuple[ReportCause, ...]
    verdict_rules: VerdictRules | None


def reports_of(device: Device) -> tuple[NumberedReport, ...]:
    """Return all reports in the frames of a family, in the same order as in the spec.

    Fields with the same name share a report if they also have the same kind, group and meaning. If they differ, the
    name of each report begins with the name of its interface or frame.
    """
    return tuple(dict.fromkeys(_index_reports(device).values()))


def reportings(device: Device) -> dict[str, ReportsAndVerdict]:
    """Return the reports and the verdict rules of each frame that the encoder sends, by the name of the frame.

    Frames with neither of them are omitted.
    """
    reports_by_frame_and_field = _index_reports(device)
    reporting_by_frame: dict[str, ReportsAndVerdict] = {}
    for interface, layout in _sent_layouts(device):
        layout_plan = layout_plan_of(device, layout)
        causes: list[ReportCause] = []
        for cause in verdict_causes(layout_plan):
            for field, code_condition in by_order_code(cause.field):
                if _is_reported(field):
                    report = reports_by_frame_and_field[layout.name, field.name]
                    causes.append(ReportCause(report, cause=cause, code_condition=code_condition))
        verdict_rules = verdict_rules_of(layout_plan) if device.has_verdict(interface.name, layout) else None
        if causes or verdict_rules is not None:
            reporting_by_frame[layout.name] = ReportsAndVerdict(interface, layout_plan, tuple(causes), verdict_rules)
    return reporting_by_frame


def verdict_rules_in_family(device: Device, layout: Layout) -> VerdictRules | None:
    """Return how the verdict on a frame follows from its bits, or None for a frame without a position.

    ``device`` is the family with all its order codes.
    """
    reporting = reportings(device).get(layout.name)
    return reporting.verdict_rules if reporting is not None else None


def _sent_layouts(device: Device) -> Iterator[tuple[Interface, Layout]]:
    """Yield the layouts of the frames that the encoder sends, each with its interface."""
    return ((interface, layout) for interface, layout in device.layouts() if layout.sender == "encoder")


def codes_with_explanation(field: Field) -> CodeCondition | None:
    """Return the condition on the order codes for which the manual explains a flag, or None if it covers all codes."""
    # The explained flag is yielded before the unexplained one.
    _, condition_of_explained_flag = next(by_order_code(field))
    return condition_of_explained_flag


def _is_reported(field: Field) -> bool:
    """Return whether a decoder reports the field: a flag or reserved bits, unless they leave the position usable.

    Flags and reserved bits in a frame without the position have no verdict, and are reported.
    """
    leaves_position_usable = field.kind.makes_position is Verdict.USABLE
    return isinstance(field.kind, (Flag, Unused)) and not leaves_position_usable


def _fields_by_code(layout: Layout) -> Iterator[tuple[Field, CodeCondition | None]]:
    """Yield the fields that a decoder reports, each with the condition on the order codes to which it applies.

    Combinations of values that decide the verdict are included as flags without bits.
    """
    flags_without_bits = [sign.flag for sign in layout.signs]
    for field in (*layout.fields, *flags_without_bits):
        for field_for_codes, code_condition in by_order_code(field):
            if _is_reported(field_for_codes):
                yield field_for_codes, code_condition


class _ReportedField(NamedTuple):
    """A field that reports a problem, with the names of its interface and frame."""

    interface: str
    frame: str
    field: Field

    @property
    def name_with_interface(self) -> str:
        return f"{self.interface}_{self.field.name}"


def _reported_fields(device: Device) -> list[_ReportedField]:
    """Return the fields that decoders report, in all frames of a family.

    Flags that the manual does not explain for some order codes are last, so that the others keep their numbers.
    """
    explained_fields: list[_ReportedField] = []
    unexplained_fields: list[_ReportedField] = []
    for interface, layout in _sent_layouts(device):
        for field, code_condition in _fields_by_code(layout):
            reported_field = _ReportedField(interface=interface.name, frame=layout.name, field=field)
            is_explained = code_condition is None or code_condition.holds
            if is_explained:
                explained_fields.append(reported_field)
            else:
                unexplained_fields.append(reported_field)
    return explained_fields + unexplained_fields


def _index_reports(device: Device) -> Mapping[tuple[str, str], NumberedReport]:
    """Return the reports by the names of frame and field: ``{("status_frame", "overheat"): NumberedReport(...)}``.

    Fields share a report if their report names are equal. ``_report_name`` gives them the name of the field if all
    reported fields with this name have the same kind, group and meaning. Otherwise the name of the interface precedes
    it, or if that is still ambiguous, the name of the frame.
    """
    reported_fields = _reported_fields(device)
    # By both candidates for a report name: the name of the field, and the name with the interface.
    meanings_by_name: dict[str, set[object]] = {}
    for reported in reported_fields:
        meaning = (reported.field.kind, reported.field.group, reported.field.meaning)
        for candidate_name in (reported.field.name, reported.name_with_interface):
            meanings_by_name.setdefault(candidate_name, set()).add(meaning)
    report_by_field: dict[tuple[str, str], NumberedReport] = {}
    report_by_name: dict[str, NumberedReport] = {}
    for reported in reported_fields:
        name = _report_name(reported, meanings_by_name)
        new_report = NumberedReport(name, number=len(report_by_name), field=reported.field)
        report = report_by_name.setdefault(name, new_report)
        report_by_field[reported.frame, reported.field.name] = report
    return report_by_field


def _report_name(reported: _ReportedField, meanings_by_name: Mapping[str, set[object]]) -> str:
    """Return the first of these names with a single meaning: ``overheat``, ``biss_overheat``, ``status_overheat``.

    The names are: the name of the field alone, with the interface's name, and with the frame's name.
    """
    for candidate_name in (reported.field.name, reported.name_with_interface):
        if len(meanings_by_name[candidate_name]) == 1:
            return candidate_name
    return f"{reported.frame}_{reported.field.name}"
