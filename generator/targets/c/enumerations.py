"""Enumerations in C: the named values of fields, the answers to open choices, and the reports of a family."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

from ...language.document import Path
from ...model import Alternative, Answer, Device, Field, Layout, Parameter, Value, Verdict, cite, first_or_raise
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.operations import FieldToDecode, Reserved
from ...plan.values import ActiveFlag, NamedChoice, meaning_of
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
from ...say.errata import describe_erratum, errata
from ...say.names_and_places import name_in_words, printed_name_of, title_of
from ...say.register import describe_meaning
from ...say.report import alarm_of, alarm_source, remedy
from ...say.report import meaning as report_meaning
from ...say.text import Statement, spec_text, statement
from .. import TargetError
from .comments import HEADER_STYLE, Paragraph
from .names import (
    CCast,
    CExpression,
    CName,
    CNumber,
    Conditional,
    COperation,
    DeclaredName,
    ParameterSpelling,
    c_name,
    join_operands,
    masked,
    unsigned,
)


@dataclass(frozen=True, slots=True)
class Entry:
    """A constant of an enumeration, with its comment."""

    name: str
    value: int
    note: str


@dataclass(frozen=True, slots=True)
class CEnumeration:
    """The named values of a field, each with ``digits`` hexadecimal digits. Values too large for an int become macros.

    ``statements`` contains the statements about the field that are in its comment.
    """

    type: str
    about: Sequence[Paragraph] | str
    statements: tuple[Statement, ...]
    entries: tuple[Entry, ...]
    digits: int
    path: Path

    @property
    def is_enum(self) -> bool:
        """True if all values fit in an int of 16 bits, the smallest one in C."""
        return max((constant.value for constant in self.entries), default=0) <= 0x7FFF

    @property
    def names(self) -> Mapping[int, str]:
        return {constant.value: constant.name for constant in self.entries}

    def declared(self) -> Iterator[DeclaredName]:
        yield self.type, self.path
        for constant in self.entries:
            yield constant.name, self.path


class Enumerations:
    """The enumerations of a family.

    Fields of one name and the same values share an enumeration, except a register's only field.

    ``choices`` contains them by owner and field. The owner is a layout, or ``reg_`` and a register.
    """

    def __init__(self, device: Device, prefix: str) -> None:
        self.prefix = prefix
        self.choices: dict[tuple[str, str], CEnumeration] = {}
        self.all: list[CEnumeration] = []
        #: By field name, the values and the enumeration of the first field with this name.
        self._shared: dict[str, tuple[Sequence[Value], CEnumeration]] = {}
        for interface, layout in device.layouts():
            path = ("interfaces", interface.name, "layouts", layout.name)
            for field in layout.fields:
                if isinstance(meaning_of(field), NamedChoice):
                    self._add_enumeration(layout.name, field, path)
        for register in device.registers:
            for field in register.layout.fields:
                if isinstance(meaning_of(field), NamedChoice):
                    # The title of a register whose only field it is.
                    sole = title_of(register) if len(register.layout.fields) == 1 else ""
                    self._add_enumeration(f"reg_{register.name}", field, ("registers", register.name), sole=sole)

    def of(self, *path: str) -> list[CEnumeration]:
        """Return those declared with this part of the spec, such as ``("registers", "status")``, or one inside it."""
        return [enumeration for enumeration in self.all if enumeration.path[: len(path)] == path]

    def _add_enumeration(self, owner: str, field: Field, path: Path, sole: str = "") -> None:
        """Add the enumeration of a field, or share an earlier one of a field with the same name and the same values.

        The first enumeration is ``PREFIX_FIELD``. With other values it is ``PREFIX_OWNER_FIELD``. ``sole`` is the title
        of a register whose only field it is, which has its own ``PREFIX_REGISTER``.
        """
        if sole:
            self._add_new(owner, field, path, type_=f"{self.prefix}_{path[-1]}", sole=sole)
            return
        if field.name not in self._shared:
            enumeration = self._add_new(owner, field, path, type_=f"{self.prefix}_{field.name}")
            self._shared[field.name] = (field.values, enumeration)
            return
        shared_values, shared_enumeration = self._shared[field.name]
        if shared_values == field.values:
            self.choices[owner, field.name] = shared_enumeration
        else:
            self._add_new(owner, field, path, type_=f"{self.prefix}_{path[-1]}_{field.name}")

    def _add_new(self, owner: str, field: Field, path: Path, type_: str, sole: str = "") -> CEnumeration:
        """Add and return a new enumeration with the values of a field."""
        statements = () if sole else tuple(describe_meaning(field, field.meaning))
        enumeration = CEnumeration(
            type=type_,
            about=HEADER_STYLE.paragraph(statements) or f"Values of {sole or title_of(field)}.",
            statements=statements,
            entries=tuple(
                Entry(f"{type_}_{value.name}".upper(), value.value, _describe_constant(value)) for value in field.values
            ),
            # A hexadecimal digit for each 4 bits, rounded up.
            digits=(field.widest + 3) // 4,
            path=path,
        )
        self.choices[owner, field.name] = enumeration
        self.all.append(enumeration)
        return enumeration


def _describe_constant(value: Value) -> str:
    """Return the comment on a constant: the meaning of the value with its source, or else its name in words."""
    # Omit a printed name of one word that the constant already has. Keep longer names, for readers who search for them.
    has_printed_name = printed_name_of(value).lower() == value.name
    statements = spec_text(value.meaning) if has_printed_name else describe_meaning(value, value.meaning)
    return HEADER_STYLE.paragraph(replace(statement, source=value.source) for statement in statements) or name_in_words(
        value.name
    )


#: Names of the other arguments and locals in the functions of a frame.
_NAMES_OF_LOCALS = frozenset(
    "bits bytes code crc flags frame in length out plain position received rx unused value variant verdict word".split()
)


@dataclass(frozen=True, slots=True)
class AnsweredBy:
    """A parameter that follows from the answer: the function that returns it, and its value."""

    name: str
    about: str
    value: CExpression


class AlternativeCode:
    """An alternative. ``argument`` is the name of the argument for the answer."""

    def __init__(self, device: Device, prefix: str, alternative: Alternative) -> None:
        self.alternative = alternative
        self.type = f"{prefix}_{alternative.name}"
        self.argument = c_name(alternative.name, _NAMES_OF_LOCALS)
        #: Name of the chosen answer in the programs.
        self.constant = f"my_{alternative.name}"
        about = [
            HEADER_STYLE.sentence(statement(alternative.meaning, source=alternative.source)),
            "Choose the answer for your encoder. No known source settles it, and there is no default.",
        ]
        for correction in errata(device, f"alternatives.{alternative.name}"):
            about.append(HEADER_STYLE.sentence(describe_erratum(correction)))
        self.enumeration = CEnumeration(
            type=self.type,
            about=about,
            statements=(),
            entries=tuple(self._build_constant(index, answer) for index, answer in enumerate(alternative.answers)),
            digits=1,
            path=("alternatives", alternative.name),
        )
        dependent = (parameter for parameter in device.parameters if parameter.alternative == alternative.name)
        self.functions = tuple(self._build_function(prefix, parameter) for parameter in dependent)

    def _build_constant(self, index: int, answer: Answer) -> Entry:
        note = HEADER_STYLE.sentence(statement(answer.meaning, source=answer.source))
        return Entry(f"{self.type}_{answer.name}".upper(), index, note)

    def _build_function(self, prefix: str, parameter: Parameter) -> AnsweredBy:
        about = HEADER_STYLE.sentence(statement(parameter.meaning, source=parameter.source))
        return AnsweredBy(f"{prefix}_{parameter.name}", about, self._express_parameter(parameter.name))

    def declared(self) -> Iterator[DeclaredName]:
        """Yield its declarations at file scope."""
        yield from self.enumeration.declared()
        yield from ((function.name, self.enumeration.path) for function in self.functions)

    def _express_parameter(self, parameter: str) -> CExpression:
        """Return the parameter as a function of the answer, such as ``code == CODE_GRAY ? 1U : 0U``.

        The last answer is the default branch.
        """
        *other_answers, last_answer = self.alternative.answers
        # The enumeration has a constant for each answer, in the same order.
        *other_constants, _ = self.enumeration.entries
        expression: CExpression = CNumber(last_answer.sets[parameter])
        for constant, answer in reversed(list(zip(other_constants, other_answers, strict=True))):
            is_answer = COperation("==", (CName(self.argument), CName(constant.name)))
            expression = Conditional(is_answer, CNumber(answer.sets[parameter]), expression)
        return expression


def alternatives_in(alternatives: tuple[AlternativeCode, ...], *expressions: Expression) -> tuple[AlternativeCode, ...]:
    """Return the alternatives on whose answers these expressions depend: those that set a parameter in them."""
    names = {name for expression in expressions for name in expression.parameters}
    # All answers set the same parameters.
    return tuple(
        alternative for alternative in alternatives if not names.isdisjoint(alternative.alternative.answers[0].sets)
    )


_UNUSED_MEMBER = CName("frame->unused")


class FrameReports:
    """The functions ``verdict`` and ``reports`` of a frame. The name of a missing function is empty.

    ``choices`` contains the constants of named values by layout and field.
    """

    def __init__(
        self,
        family: Reports,
        reporting: ReportsAndVerdict,
        frame: str,
        type_: str,
        choices: Mapping[tuple[str, str], CEnumeration],
    ) -> None:
        self.family = family
        self.reporting = reporting
        self.frame = frame
        self.type = type_
        self._choices = choices
        #: Returns the condition on a parameter of the order code.
        self._holds = partial(_express_condition, family.scope)
        self.verdict_rules = reporting.verdict_rules
        self.verdict = f"{frame}_verdict" if reporting.verdict_rules is not None else ""
        self.reports = f"{frame}_reports" if reporting.causes else ""
        self._mask_of_all_unused = sum(reserved.mask for reserved in reporting.codec.reserved)

    def names(self) -> Iterator[str]:
        """Return the names that it declares at file scope. A frame can lack either function."""
        return filter(None, (self.verdict, self.reports))

    @property
    def mask_terms(self) -> Iterator[CExpression]:
        """The terms of the mask of its reports, such as ``frame->error ? ACME_X_REPORT_ERROR : 0U``."""
        for report_cause in self.reporting.causes:
            is_for_encoder = [self._holds(only) for only in report_cause.conditions]
            condition = join_operands("&&", (*is_for_encoder, self._is_active(report_cause.by)))
            yield Conditional(condition, self.family.constant(report_cause.report), CNumber(0))

    @property
    def verdict_depends(self) -> bool:
        """True if the verdict depends on the order code or on an answer of the user."""
        if self.may_be_unknown:
            return True
        return any(cause.conditions for _, causes in self._causes_by_verdict for cause in causes)

    @property
    def may_be_unknown(self) -> bool:
        """True if the frames of some order codes, but not of all, have no bits that judge the position."""
        return self.verdict_rules is not None and self.verdict_rules.may_be_unknown

    @property
    def reports_depend(self) -> bool:
        """True if the reports depend on the order code."""
        return any(report_cause.only for report_cause in self.reporting.causes)

    @property
    def _causes_by_verdict(self) -> tuple[tuple[Verdict, tuple[VerdictCause, ...]], ...]:
        """Verdicts with their causes, worst first."""
        return self.verdict_rules.worst_first if self.verdict_rules is not None else ()

    def _is_active(self, cause: Cause) -> CExpression:
        """Return the condition that a cause is active."""
        if isinstance(cause, Reserved):
            return self._differs_in([cause])
        return join_operands("&&", tuple(self._conditions_of(cause)))

    def _conditions_of(self, flag_or_match: FieldToDecode | MatchingValues) -> Iterator[CExpression]:
        """Yield the condition of a flag, ``frame->error``, or of a match: ``!frame->ok``, ``frame->mode == A``."""
        if isinstance(flag_or_match, FieldToDecode):
            yield CName(_struct_member(flag_or_match))
            return
        for part, value in flag_or_match.conditions:
            member = _struct_member(part)
            if isinstance(part.meaning, ActiveFlag):
                # The value of a flag is 1 while it is active.
                yield CName(member if value else f"!{member}")
            else:
                enumeration = self._choices[self.reporting.codec.layout.name, part.field.name]
                yield COperation("==", (CName(member), CName(enumeration.names[value])))

    @property
    def conditions_of_worse_verdicts(self) -> Iterator[tuple[CExpression, Verdict]]:
        """The conditions of verdicts worse than ``otherwise``, worst first, several of the same verdict one by one.

        Separate conditions become one test of the bits of the frame. Flags joined by ``||`` are slower: compilers load
        neighbouring members as one number, so that the decoder must store them first.
        """
        if self.verdict_rules is None:
            return
        causes_by_verdict = dict(self._causes_by_verdict)
        for verdict in Verdict:
            if verdict is Verdict.UNKNOWN and self.verdict_rules.may_be_unknown:
                judging_bits = self.family.scope.expression_of(self.verdict_rules.judging_bits)
                yield COperation("==", (judging_bits, CNumber(0))), verdict
            else:
                for condition in self._conditions_of_causes(causes_by_verdict.get(verdict, ())):
                    yield condition, verdict

    def _conditions_of_causes(self, causes: Sequence[VerdictCause]) -> Iterator[CExpression]:
        """Yield the condition that each of these is active. Unused bits are checked together, last.

        A cause counts only for its order codes or answers, and only while all flags in its ``unless`` are inactive.
        """
        reserved_causes = []
        for cause in causes:
            if isinstance(cause.by, Reserved):
                reserved_causes.append(cause.by)
            else:
                is_for_encoder = [self._holds(only) for only in cause.conditions]
                combining_flags_are_inactive = [CName(f"!{_struct_member(flag)}") for flag in cause.unless]
                conditions = (*is_for_encoder, *self._conditions_of(cause.by), *combining_flags_are_inactive)
                yield join_operands("&&", conditions)
        if reserved_causes:
            yield self._differs_in(reserved_causes)

    def _differs_in(self, reserved: Sequence[Reserved]) -> CExpression:
        """Return the condition that some of these bits differ from the manual, ``frame->unused != 0U`` if it is all."""
        # The masks have no common bits. The member is the mask of the bits in which the decoder found a difference.
        mask = sum(bits.mask for bits in reserved)
        differing_bits = _UNUSED_MEMBER if mask == self._mask_of_all_unused else masked(_UNUSED_MEMBER, mask)
        return COperation("!=", (differing_bits, CNumber(0)))


class Reports:
    """All reports of a family, or a TargetError if there are more than 64. ``mask`` is the type with a bit for each."""

    def __init__(
        self, device: Device, prefix: str, choices: Mapping[tuple[str, str], CEnumeration], scope: ParameterSpelling
    ) -> None:
        self.all = reports_of(device)
        self._choices = choices
        self.scope = scope
        if len(self.all) > 64:
            problem = f"the frames have {len(self.all)} flags, values and fields of unused bits to report"
            raise TargetError(f"{problem}; the C target supports at most 64", ("interfaces",))
        self.mask = unsigned(max(len(self.all), 32))
        self.text = f"{prefix}_report_text"
        self.texts = tuple(_members_of_text(device, report) for report in self.all)
        type_ = f"{prefix}_report"
        constants = []
        for report in self.all:
            name = f"{type_}_{report.name}".upper()
            constants.append(Entry(name=name, value=1 << report.number, note=_report_note(device, report)))
        self.enumeration = CEnumeration(
            type=type_,
            about="Reports of the encoder. The _reports() functions of the frames return a mask of these bits.",
            statements=(),
            entries=tuple(constants),
            digits=(len(self.all) + 3) // 4,
            path=(),
        )
        self._by_frame = reportings(device)

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names that it declares at file scope."""
        if self.all and self.enumeration.is_enum:
            yield self.enumeration.type, ()
        if self.all:
            yield self.text, ()
        for report, constant in zip(self.all, self.enumeration.entries, strict=True):
            yield constant.name, self._find_path(report)

    def of(self, layout: Layout, name: str, type_: str) -> FrameReports | None:
        """Return the functions of a frame, or None. ``name`` and ``type_`` are the name and type of its struct."""
        reporting = self._by_frame.get(layout.name)
        if reporting is None:
            return None
        return FrameReports(family=self, reporting=reporting, frame=name, type_=type_, choices=self._choices)

    def constant(self, report: NumberedReport) -> CExpression:
        """Return the bit of a report, as a number of the type of the mask."""
        name = CName(self.enumeration.entries[report.number].name)
        return CCast(self.mask, name) if self.enumeration.is_enum else name

    def _find_path(self, report: NumberedReport) -> Path:
        """Return the path of the first frame with this report."""
        frames = (reporting for reporting in self._by_frame.values() if _has_report(reporting, report))
        first_frame = first_or_raise(frames, f"frame with the report '{report.name}'")
        return ("interfaces", first_frame.interface.name, "layouts", first_frame.codec.layout.name)


def _has_report(reporting: ReportsAndVerdict, report: NumberedReport) -> bool:
    return any(report_cause.report.number == report.number for report_cause in reporting.causes)


def _members_of_text(device: Device, report: NumberedReport) -> tuple[str, ...]:
    """Return the members of the text of a report: name, printed name, meaning, remedy and source."""
    field = report.field
    alarm = alarm_of(device, field)
    return (
        report.name,
        field.printed_name,
        report_meaning(field, alarm),
        remedy(field, alarm),
        cite(alarm_source(field, alarm)),
    )


def _report_note(device: Device, report: NumberedReport) -> str:
    """Return the comment on a report: the title of its field, ``unused`` if it has no use, and the source."""
    field = report.field
    unused = ", unused" if report.is_unused else ""
    return HEADER_STYLE.sentence(
        statement(title_of(field), unused, source=alarm_source(field, alarm_of(device, field)))
    )


def _express_condition(scope: ParameterSpelling, parameter_condition: CodeCondition) -> CExpression:
    """Return the condition on a parameter of the order code: ``variant.has_x != 0U``, or ``== 0U`` if not ``holds``."""
    operator = "!=" if parameter_condition.holds else "=="
    return COperation(operator, (scope.member(parameter_condition.parameter), CNumber(0)))


def _struct_member(part: FieldToDecode) -> str:
    """Return the member of a flag or field in the struct of a frame."""
    return f"frame->{c_name(part.field.name)}"
