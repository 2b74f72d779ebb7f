"""Verdict on the position of a frame, and the reports of the encoder that decide it.

A valid frame may contain an unusable position, since an encoder with an error, or a busy one, also sends valid CRCs.
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
    """Order codes selected by a parameter: its value is not 0 if ``holds`` is true, otherwise it is 0.

    ``codes`` is the text in the spec for the codes with a value other than 0.
    """

    parameter: str
    holds: bool
    codes: str = dataclass_field(default="", compare=False)

    def contains(self, parameters: Mapping[str, int]) -> bool:
        """Return whether an order code with these parameters is one of them."""
        return (parameters.get(self.parameter, 0) != 0) is self.holds


@dataclass(frozen=True, slots=True)
class MatchingValues:
    """Values of parts that decide a verdict together, like the active flag ``field``, which has no bits.

    The value of a flag is 1 while it is active.
    """

    field: Field
    conditions: tuple[tuple[FieldToDecode, int], ...]


#: Cause of a verdict or a report: a flag, reserved bits, or values.
Cause = FieldToDecode | Reserved | MatchingValues


@dataclass(frozen=True, slots=True)
class VerdictCause:
    """Cause of a verdict, unless one of the flags ``unless``, which it combines, is active.

    ``unless`` omits flags that lead to the same verdict or a worse one, since they make no difference. Without ``only``
    it applies to all order codes. If an answer of the user decides the verdict, ``chosen`` is the condition on the
    parameter that the answer sets.
    """

    by: Cause
    unless: tuple[FieldToDecode, ...]
    only: CodeCondition | None = None
    chosen: CodeCondition | None = None

    @property
    def conditions(self) -> tuple[CodeCondition, ...]:
        """Conditions on parameters of the order code."""
        return tuple(condition for condition in (self.only, self.chosen) if condition is not None)


@dataclass(frozen=True, slots=True)
class VerdictRules:
    """Verdict on the position of a frame: the verdict of the worst active cause, or ``otherwise`` if none is active.

    If ``otherwise`` is UNKNOWN, warnings have no effect, since UNKNOWN is worse than a warning. ``judging_bits`` is the
    number of bits that say whether the position is usable. For order codes for which this number is 0, UNKNOWN is also
    a verdict.
    """

    not_usable: tuple[VerdictCause, ...]
    with_warning: tuple[VerdictCause, ...]
    otherwise: Verdict
    judging_bits: Expression

    @property
    def may_be_unknown(self) -> bool:
        """True if only the frames of some order codes have bits that judge the position."""
        return not self.judging_bits.is_constant

    def for_parameters(self, parameters: Mapping[str, int]) -> VerdictRules:
        """Return the verdict for an order code with these parameters, without causes that its frames do not have.

        If no bit of its frames judges the position, ``otherwise`` is UNKNOWN. The causes of warnings are then omitted,
        since UNKNOWN is worse.
        """
        not_usable = tuple(cause for cause in self.not_usable if _has_bits(cause.by, parameters))
        if self.judging_bits.value(parameters) == 0:
            return VerdictRules(
                not_usable=not_usable, with_warning=(), otherwise=Verdict.UNKNOWN, judging_bits=Expression(0)
            )
        with_warning = tuple(cause for cause in self.with_warning if _has_bits(cause.by, parameters))
        return VerdictRules(
            not_usable=not_usable, with_warning=with_warning, otherwise=self.otherwise, judging_bits=Expression(1)
        )

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
    """Return whether the frames of an order code with these parameters contain all bits of a cause.

    The order code lacks a field if its width is 0.
    """
    if isinstance(cause, MatchingValues):
        bits_of_cause = [part.bits for part, _ in cause.conditions]
    else:
        bits_of_cause = [cause.bits]
    return all(bits.width.value(parameters) > 0 for bits in bits_of_cause)


def verdict_rules_of(layout_plan: LayoutPlan) -> VerdictRules:
    """Return the verdict on the position of a frame, with everything that it depends on.

    If no order code has bits that judge the position, the verdict without an active cause is UNKNOWN. Causes of
    warnings are then omitted, since UNKNOWN is worse.
    """
    causes_by_verdict: dict[Verdict, list[VerdictCause]] = {verdict: [] for verdict in Verdict}
    part_by_name = {part.field.name: part for part in layout_plan.parts}
    for cause in verdict_causes(layout_plan):
        match cause.field.kind:
            case Flag():
                for verdict, verdict_cause in _verdicts_of_flag(cause, part_by_name):
                    causes_by_verdict[verdict].append(verdict_cause)
            case Unused(makes_position=verdict):
                causes_by_verdict[verdict].append(VerdictCause(cause, unless=()))
    not_usable = tuple(causes_by_verdict[Verdict.NOT_USABLE])
    with_warning: tuple[VerdictCause, ...] = ()
    otherwise = Verdict.UNKNOWN
    if layout_plan.layout.judges_position:
        with_warning = tuple(causes_by_verdict[Verdict.USABLE_WITH_WARNING])
        otherwise = Verdict.USABLE
    return VerdictRules(
        not_usable=not_usable,
        with_warning=with_warning,
        otherwise=otherwise,
        judging_bits=layout_plan.layout.judging_bits,
    )


def _verdicts_of_flag(cause: Cause, parts: Mapping[str, FieldToDecode]) -> Iterator[tuple[Verdict, VerdictCause]]:
    """Yield the verdicts to which a flag leads, each with its conditions on the order code and the user's answer.

    A flag that combines others does not count while one of these is active (``unless``), because the active flag
    decides.
    """
    for flag, only in _flag_by_order_code(cause.field):
        summed_parts = [parts[name] for name in flag.sums_up if name in parts]
        for verdict, chosen in _verdict_by_answer(flag):
            # A summed flag that leads to the same verdict or a worse one makes no difference.
            unless = tuple(part for part in summed_parts if not _always_leads_to(part, verdict, parts))
            yield verdict, VerdictCause(by=cause, unless=unless, only=only, chosen=chosen)


def _flag_by_order_code(field: Field) -> Iterator[tuple[Flag, CodeCondition | None]]:
    """Yield a flag with the order codes for which it leads to its verdict, or with None for all of them.

    A flag that the manual explains only for some order codes is yielded twice, as explained and as unexplained, unless
    both have the same verdicts and combine the same flags.
    """
    kinds_by_codes = [(variant_field.kind, only) for variant_field, only in by_order_code(field)]
    # All of them are flags. The check is for the types.
    flags_by_codes = [(kind, only) for kind, only in kinds_by_codes if isinstance(kind, Flag)]
    verdict_properties = {(flag.makes_position, flag.sums_up, flag.verdict_if_set) for flag, _ in flags_by_codes}
    if len(verdict_properties) == 1:
        first_flag, _ = flags_by_codes[0]
        yield first_flag, None
    else:
        yield from flags_by_codes


def _verdict_by_answer(flag: Flag) -> Iterator[tuple[Verdict, CodeCondition | None]]:
    """Yield the verdicts of a flag, each with the condition on the user's answer, or with None if it always applies.

    A flag in a frame without the position has no verdict.
    """
    if flag.makes_position is None:
        return
    if flag.verdict_if_set is None:
        yield flag.makes_position, None
        return
    # The answer sets this parameter to 1 or 0.
    yield flag.makes_position, CodeCondition(flag.verdict_parameter, holds=False)
    yield flag.verdict_if_set, CodeCondition(flag.verdict_parameter, holds=True)


def _always_leads_to(part: FieldToDecode, verdict: Verdict, parts: Mapping[str, FieldToDecode]) -> bool:
    """Return whether a flag leads to ``verdict`` or a worse one, whatever the order code and the answers are.

    Return false if the flag combines others of the frame, since it then has no verdict while one of them is active.
    """
    flag = part.field.kind
    if not isinstance(flag, Flag) or flag.makes_position is None:
        return False
    has_conditions = bool(flag.only_while) or flag.verdict_if_set is not None
    has_summed_parts = not parts.keys().isdisjoint(flag.sums_up)
    worst_first = list(Verdict)  # The enumeration lists the verdicts from the worst to the best.
    is_as_bad = worst_first.index(flag.makes_position) <= worst_first.index(verdict)
    return is_as_bad and not has_conditions and not has_summed_parts


def verdict_of(field: Field) -> Verdict | None:
    """Return the verdict on the position while a flag is active or unused bits differ from the manual.

    Return None for all other fields, and for fields in a frame without the position.
    """
    return field.kind.makes_position


def verdict_causes(layout_plan: LayoutPlan) -> Iterator[Cause]:
    """Yield the flags and the reserved bits of a frame, and the values that decide its verdict like a flag.

    Flags without a verdict are included.
    """
    yield from (part for part in layout_plan.parts if isinstance(part.field.kind, Flag))
    yield from layout_plan.reserved
    part_by_name = {part.field.name: part for part in layout_plan.parts}
    for sign in layout_plan.layout.signs:
        yield MatchingValues(sign.flag, tuple((part_by_name[name], value) for name, value in sign.conditions))


def by_order_code(field: Field) -> Iterator[tuple[Field, CodeCondition | None]]:
    """Yield the field with the order codes for which it applies, or with None for all of them.

    If the manual explains a flag only for some order codes, yield it with these codes, and then the unexplained flag
    with the other codes: ``overheat`` and ``overheat_unexplained``.
    """
    match field.kind:
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
    """Report in a frame: an active flag, reserved bits that differ from the manual, or values with a verdict.

    Without ``only`` it applies to all order codes.
    """

    report: NumberedReport
    by: Cause
    only: CodeCondition | None = None

    @property
    def conditions(self) -> tuple[CodeCondition, ...]:
        """Conditions on parameters of the order code."""
        return (self.only,) if self.only is not None else ()

    @property
    def made_of(self) -> Field:
        """The field as it is for these order codes."""
        is_explained = self.only is None or self.only.holds
        return self.by.field if is_explained else unexplained_flag(self.by.field)


@dataclasses.dataclass(frozen=True, slots=True)
class ReportsAndVerdict:
    """Reports and verdict of one layout. ``verdict_rules`` is None if the layout does not contain the position."""

    interface: Interface
    codec: LayoutPlan
    causes: tuple[ReportCause, ...]
    verdict_rules: VerdictRules | None


def reports_of(device: Device) -> tuple[NumberedReport, ...]:
    """Return all reports in the frames of a family, in the same order as in the spec.

    Fields with the same name share a report if they also have the same kind, group and meaning. Otherwise the interface
    or the frame precedes the name.
    """
    return tuple(dict.fromkeys(_index_reports(device).values()))


def reportings(device: Device) -> dict[str, ReportsAndVerdict]:
    """Return the reports and the verdict of each frame of the encoder that has any, by the name of the frame."""
    reports = _index_reports(device)
    reporting_by_frame: dict[str, ReportsAndVerdict] = {}
    for interface, layout in _sent_layouts(device):
        codec = layout_plan_of(device, layout)
        causes: list[ReportCause] = []
        for cause in verdict_causes(codec):
            for field, only in by_order_code(cause.field):
                if _is_reported(field):
                    causes.append(ReportCause(reports[layout.name, field.name], by=cause, only=only))
        verdict_rules = verdict_rules_of(codec) if device.has_verdict(interface.name, layout) else None
        if causes or verdict_rules is not None:
            reporting_by_frame[layout.name] = ReportsAndVerdict(
                interface=interface, codec=codec, causes=tuple(causes), verdict_rules=verdict_rules
            )
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
    """Return the order codes for which the manual explains a flag, or None if it explains the flag for all."""
    # The first of them is the field as the manual explains it.
    _, explained_codes = next(by_order_code(field))
    return explained_codes


def combined_flag_names(field: Field) -> tuple[str, ...]:
    """Return the names of the flags that a flag combines."""
    return field.kind.sums_up if isinstance(field.kind, Flag) else ()


def _is_reported(field: Field) -> bool:
    """Return whether the field reports a problem: a flag or reserved bits, unless they leave the position usable.

    Fields in a frame without the position have no verdict, and are reported.
    """
    return isinstance(field.kind, (Flag, Unused)) and field.kind.makes_position is not Verdict.USABLE


def _fields_by_code(layout: Layout) -> Iterator[tuple[Field, CodeCondition | None]]:
    """Yield the fields and signs that report a problem, each with the order codes for which it does."""
    for field in (*layout.fields, *(sign.flag for sign in layout.signs)):
        for coded_field, only in by_order_code(field):
            if _is_reported(coded_field):
                yield coded_field, only


class _ReportedField(NamedTuple):
    """A field that reports a problem, with the names of its interface and frame."""

    interface: str
    frame: str
    field: Field

    @property
    def name_with_interface(self) -> str:
        return f"{self.interface}_{self.field.name}"


def _reported_fields(device: Device) -> list[_ReportedField]:
    """Return the fields that report problems. Unexplained flags are last, so that the others keep their numbers."""
    explained_fields: list[_ReportedField] = []
    unexplained_fields: list[_ReportedField] = []
    for interface, layout in _sent_layouts(device):
        for field, only in _fields_by_code(layout):
            reported_field = _ReportedField(interface=interface.name, frame=layout.name, field=field)
            # ``holds`` is true for the order codes for which the manual explains the flag.
            if only is None or only.holds:
                explained_fields.append(reported_field)
            else:
                unexplained_fields.append(reported_field)
    return explained_fields + unexplained_fields


def _index_reports(device: Device) -> Mapping[tuple[str, str], NumberedReport]:
    """Return the reports by the names of frame and field: ``{("status_frame", "overheat"): Report(...)}``.

    Fields share a report if their report names are equal. ``_report_name`` gives them the name of the field if all
    reported fields with this name have the same kind, group and meaning. Otherwise the name of the interface precedes
    it, or if that is still ambiguous, the name of the frame.
    """
    reported_fields = _reported_fields(device)
    # By both candidates for a report name: the name of the field, and the name with the interface.
    meanings_by_name: dict[str, set[object]] = {}
    for reported in reported_fields:
        for candidate_name in (reported.field.name, reported.name_with_interface):
            meaning = (reported.field.kind, reported.field.group, reported.field.meaning)
            meanings_by_name.setdefault(candidate_name, set()).add(meaning)
    reports_by_field: dict[tuple[str, str], NumberedReport] = {}
    reports_by_name: dict[str, NumberedReport] = {}
    for reported in reported_fields:
        report_name = _report_name(reported, meanings_by_name)
        if report_name not in reports_by_name:
            reports_by_name[report_name] = NumberedReport(
                report_name, number=len(reports_by_name), field=reported.field
            )
        reports_by_field[reported.frame, reported.field.name] = reports_by_name[report_name]
    return reports_by_field


def _report_name(reported: _ReportedField, meanings_by_name: Mapping[str, set[object]]) -> str:
    """Return the first of these names with a single meaning: ``overheat``, ``biss_overheat``, ``status_overheat``.

    The names are: the name of the field alone, with the interface's name, and with the frame's name.
    """
    for candidate_name in (reported.field.name, reported.name_with_interface):
        if len(meanings_by_name[candidate_name]) == 1:
            return candidate_name
    return f"{reported.frame}_{reported.field.name}"
