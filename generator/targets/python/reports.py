"""Reports and verdict of a frame in Python: conditions on its attributes, and comments."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...model import Field, Flag, Verdict, first_or_raise
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.codec import LayoutPlan
from ...plan.operations import FieldToDecode, Reserved
from ...plan.verdicts import CodeCondition, MatchingValues, ReportCause, ReportsAndVerdict, VerdictCause
from .literals import Atom, ExpressionTranslator, Not, PythonExpression, PythonOperation, coded, join_operands, mask
from .names import ClassNames


@dataclass(frozen=True)
class VerdictStep:
    """A verdict with its ``conditions``, each of which is sufficient, such as ``["self.error"]``.

    ``reasons`` are the comments that explain the conditions, such as ``["error: position data is invalid."]``.
    """

    verdict: str
    conditions: list[str]
    reasons: list[str]


class FrameReports:
    """The reports of a frame, and its verdict, which says whether the position is usable.

    ``reporting`` is None if the frame has no reports. For each parameter of the order code, ``attribute_by_parameter``
    contains the attribute of the variant, and ``meaning_by_parameter`` a sentence.
    """

    def __init__(
        self,
        reporting: ReportsAndVerdict | None,
        layout_plan: LayoutPlan,
        class_names: ClassNames,
        attribute_by_parameter: Mapping[str, str],
        meaning_by_parameter: Mapping[str, str],
    ) -> None:
        self._report_causes = reporting.causes if reporting is not None else ()
        self._verdict_rules = reporting.verdict_rules if reporting is not None else None
        self._unused_fields = layout_plan.reserved
        self._class_names = class_names
        self._attribute_by_parameter = attribute_by_parameter
        self._meaning_by_parameter = meaning_by_parameter

    @property
    def _causes_by_verdict(self) -> Sequence[tuple[Verdict, Sequence[VerdictCause]]]:
        """The verdicts with the flags and bits that cause them, worst first. Empty if the frame has no position."""
        return self._verdict_rules.worst_first if self._verdict_rules is not None else ()

    @property
    def depends_on_order_code(self) -> bool:
        """True if the order code decides whether a flag counts, or whether any bit makes the position usable."""
        if self._verdict_rules is not None and self._verdict_rules.may_be_unknown:
            return True
        causes: list[ReportCause | VerdictCause] = list(self._report_causes)
        for _, verdict_causes in self._causes_by_verdict:
            causes += verdict_causes
        return any(cause.conditions for cause in causes)

    # -- verdict

    @property
    def verdict_steps(self) -> list[VerdictStep]:
        """The verdicts that flags or bits cause, worst first, with conditions and reasons.

        The causes that depend only on the frame share a step. Every other cause has its own, because it needs more
        reasons.
        """
        if self._verdict_rules is None:
            return []
        verdict_steps: list[VerdictStep] = []
        explained_parameters: set[str] = set()
        for verdict, causes in self._causes_by_verdict:
            verdict_steps += self._steps_of_verdict(verdict, causes, explained_parameters)
        if self._verdict_rules.may_be_unknown:
            conditions = [self._never_judges(self._verdict_rules.judges_if_positive)]
            reason = "With this order code, all bits that judge the position are left out."
            verdict_steps.append(VerdictStep(Verdict.UNKNOWN.name, conditions, [reason]))
        worst_first = [verdict.name for verdict in Verdict]
        return sorted(verdict_steps, key=lambda verdict_step: worst_first.index(verdict_step.verdict))

    def _steps_of_verdict(
        self, verdict: Verdict, causes: Sequence[VerdictCause], explained_parameters: set[str]
    ) -> Iterator[VerdictStep]:
        """Yield a step for all causes that depend only on the frame, and one for each other cause.

        ``explained_parameters`` are the parameters whose meaning a comment has explained so far.
        """
        simple_causes = [cause for cause in causes if _depends_on_frame_only(cause)]
        if simple_causes:
            reasons = list(dict.fromkeys(map(_meaning_while_active, simple_causes)))
            yield VerdictStep(verdict.name, self._conditions_of_causes(simple_causes), reasons)
        for cause in causes:
            if not _depends_on_frame_only(cause):
                conditions = self._conditions_of_causes([cause], in_parentheses=False)
                reasons = [_meaning_while_active(cause), *self._reasons_for_conditions(cause, explained_parameters)]
                yield VerdictStep(verdict.name, conditions, reasons)

    def _reasons_for_conditions(self, cause: VerdictCause, explained_parameters: set[str]) -> Iterator[str]:
        """Yield comments on the other conditions of a cause: parameters, and flags that decide instead of it.

        A parameter is explained only once. ``explained_parameters`` is the record of these.
        """
        for parameter in dict.fromkeys(condition.parameter for condition in cause.conditions):
            meaning = self._meaning_by_parameter.get(parameter)
            if meaning and parameter not in explained_parameters:
                explained_parameters.add(parameter)
                yield f"{self._attribute_by_parameter[parameter]}: {meaning}"
        if cause.overriding_flags:
            flags = " or ".join(self._class_names.attribute_name(flag.field.name) for flag in cause.overriding_flags)
            yield f"It combines several flags. While {flags} is active, that flag decides instead."

    @property
    def not_usable_conditions(self) -> list[str]:
        """The conditions, each of which makes the position not usable."""
        for verdict, causes in self._causes_by_verdict:
            if verdict is Verdict.NOT_USABLE:
                return self._conditions_of_causes(causes)
        return []

    @property
    def default_verdict(self) -> str:
        """The verdict if no condition applies. Empty if the frame has no position."""
        return self._verdict_rules.default_verdict.name if self._verdict_rules is not None else ""

    def _never_judges(self, judges_if_positive: Expression) -> str:
        """Return the condition that the encoder's frames have no bits that say whether the position is usable.

        ``judges_if_positive`` is 0 without such bits. An example is ``self.variant.has_flags == 0``.
        """
        attributes = self._attribute_by_parameter.items()
        code_of_parameter = {parameter: f"self.variant.{attribute}" for parameter, attribute in attributes}
        return f"{ExpressionTranslator(code_of_parameter).to_python(judges_if_positive).operand} == 0"

    # -- reports

    def name_of(self, field: Field) -> str:
        """Return the name of a field's report."""
        causes = (cause for cause in self._report_causes if cause.cause.field.name == field.name)
        return first_or_raise(causes, f"report about '{field.name}'").report.name

    # -- conditions

    def _conditions_of_causes(self, causes: Sequence[VerdictCause], *, in_parentheses: bool = True) -> list[str]:
        """Return a condition for each flag and each match of values, and one for all unused bits.

        ``in_parentheses`` is True if a condition that consists of several is an operand of ``or``.

        An example is ``["self.error", "(self.mode == 3 and self.ready)", "self.unused & 0xC"]``.
        """
        conditions = []
        unused_fields = []
        for cause in causes:
            if isinstance(cause.cause, Reserved):
                unused_fields.append(cause.cause)
            else:
                condition = self._condition_of_cause(cause, cause.cause)
                is_joined = isinstance(condition, PythonOperation) and in_parentheses
                conditions.append(condition.operand if is_joined else str(condition))
        if unused_fields:
            conditions.append(str(self._differs_in(unused_fields)))
        return conditions

    def _condition_of_cause(
        self, cause: VerdictCause, flag_or_match: FieldToDecode | MatchingValues
    ) -> PythonExpression:
        """Return the condition under which a flag or a match of values causes a verdict.

        An example is ``self.error and not self.warning``. The flag is ignored while one of the flags in ``unless``,
        which combine it with others, is active, and for order codes that do not meet its conditions.
        """
        # The flag comes first, because it is rarely active. The other conditions are then skipped.
        if isinstance(flag_or_match, MatchingValues):
            conditions = self._has_values(flag_or_match)
        else:
            conditions = [self._read_attribute(flag_or_match)]
        for code_condition in cause.conditions:
            parameter_code = f"self.variant.{self._attribute_by_parameter[code_condition.parameter]}"
            conditions.append(condition_on_parameter(code_condition, parameter_code))
        if cause.overriding_flags:
            combined_flags = [self._read_attribute(flag) for flag in cause.overriding_flags]
            conditions.append(Not(join_operands("or", combined_flags)))
        return join_operands("and", conditions)

    def _has_values(self, matching_values: MatchingValues) -> list[PythonExpression]:
        """Return a condition for each value of a match, such as ``self.mode == 3``, or ``not self.ready`` for a flag.

        The value of a flag is 1 while it is active.
        """
        conditions: list[PythonExpression] = []
        for decoded_field, value in matching_values.conditions:
            attribute_code = self._read_attribute(decoded_field)
            if not isinstance(decoded_field.field.kind, Flag):
                conditions.append(Atom(f"{attribute_code} == {coded(value)}"))
            elif value:
                conditions.append(attribute_code)
            else:
                conditions.append(Not(attribute_code))
        return conditions

    def _differs_in(self, unused_fields: Sequence[Reserved]) -> PythonExpression:
        """Return the condition that a bit of these unused fields differs from the manual: ``self.unused & 0xC``.

        If they are all unused fields of the frame, the condition is ``self.unused``.
        """
        # The attribute is a mask of the differing bits: the decoder already compared them with the manual.
        differing_bits = Atom("self.unused")
        # No two masks have a bit in common, so that their sum has the bits of all.
        mask_of_all = sum(unused_field.mask for unused_field in self._unused_fields)
        mask_of_fields = sum(unused_field.mask for unused_field in unused_fields)
        are_all = mask_of_fields == mask_of_all
        return differing_bits if are_all else PythonOperation(differing_bits, "&", mask(mask_of_fields))

    def _read_attribute(self, decoded_field: FieldToDecode) -> PythonExpression:
        """Return the code that reads the attribute of a field, such as ``self.error``."""
        return Atom(f"self.{self._class_names.attribute_name(decoded_field.field.name)}")


def _depends_on_frame_only(cause: VerdictCause) -> bool:
    """Return whether a cause leads to its verdict with every order code, and whatever other flags are active."""
    return isinstance(cause.cause, Reserved) or not (cause.conditions or cause.overriding_flags)


def _meaning_while_active(cause: VerdictCause) -> str:
    """Return a comment with the meaning of an active flag or differing bit: ``error: position data is invalid.``"""
    if isinstance(cause.cause, Reserved):
        return "unused: bits that the manual leaves unused differ from it."
    flag_field = cause.cause.field
    meaning = flag_field.meaning
    if isinstance(flag_field.kind, Flag) and flag_field.kind.when_active:
        meaning = flag_field.kind.when_active
    # Texts of the spec can have several lines.
    meaning_on_one_line = " ".join(meaning.split()) or "active"
    return f"{flag_field.name}: {meaning_on_one_line.rstrip('.')}."


def condition_on_parameter(code_condition: CodeCondition, parameter_code: str) -> PythonExpression:
    """Return a condition on the order code. ``parameter_code`` is the code that reads its parameter.

    The parameter must not be 0 if ``code_condition.holds`` is True. Otherwise, the condition is ``not parameter``.
    """
    return Atom(parameter_code) if code_condition.holds else Not(Atom(parameter_code))
