"""Enumerations in C: the named values of fields, the answers to open choices, and the reports of a family."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

from ...language.document import Path
from ...model import Alternative, Answer, Device, Field, Layout, Parameter, Value, Verdict, cite, first_of
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.operations import Part, Reserved
from ...plan.values import Active, Named, meaning_of
from ...plan.verdicts import Cause, Match, Only, Report, Reporting, VerdictCause, reportings, reports_of
from ...say.errata import errata, erratum
from ...say.names_and_places import printed, title, words
from ...say.register import meaning
from ...say.report import alarm_of, remedy, source
from ...say.report import meaning as report_meaning
from ...say.text import Statement, spec_text, statement
from .. import TargetError
from .comments import Paragraph, S
from .names import Cast, Conditional, Declared, Expr, Name, Number, Operation, Scope, c_name, joined, masked, unsigned


@dataclass(frozen=True, slots=True)
class Entry:
    name: str
    value: int
    note: str


@dataclass(frozen=True, slots=True)
class Enumeration:
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
        return max((constant.value for constant in self.entries), default=0) <= 0x7FFF

    @property
    def names(self) -> Mapping[int, str]:
        return {constant.value: constant.name for constant in self.entries}

    def declared(self) -> Iterator[Declared]:
        yield self.type, self.path
        yield from ((constant.name, self.path) for constant in self.entries)


class Enumerations:
    """The enumerations of a family. Fields of one name and the same values share one, except a register's only field.

    ``choices`` has them by owner and field. The owner is a layout, or ``reg_`` and a register.
    """

    def __init__(self, device: Device, prefix: str) -> None:
        self.prefix = prefix
        self.choices: dict[tuple[str, str], Enumeration] = {}
        self.all: list[Enumeration] = []
        self._shared: dict[str, tuple[Sequence[Value], Enumeration]] = {}
        for interface, layout in device.layouts():
            path = ("interfaces", interface.name, "layouts", layout.name)
            for field in layout.fields:
                if isinstance(meaning_of(field), Named):
                    self._add(layout.name, field, path)
        for register in device.registers:
            for field in register.layout.fields:
                if isinstance(meaning_of(field), Named):
                    sole = title(register) if len(register.layout.fields) == 1 else ""
                    self._add(f"reg_{register.name}", field, ("registers", register.name), sole)

    def of(self, *path: str) -> list[Enumeration]:
        """Return those declared with this part of the spec, or with one inside it."""
        return [enumeration for enumeration in self.all if enumeration.path[: len(path)] == path]

    def _add(self, owner: str, field: Field, path: Path, sole: str = "") -> None:
        shared = self._shared.get(field.name)
        if shared is not None and shared[0] == field.values and not sole:
            self.choices[owner, field.name] = shared[1]
            return
        if sole:
            name = f"{self.prefix}_{path[-1]}"
        else:
            name = f"{self.prefix}_{field.name}" if shared is None else f"{self.prefix}_{path[-1]}_{field.name}"
        entries = (Entry(f"{name}_{value.name}".upper(), value.value, _note(value)) for value in field.values)
        about = () if sole else tuple(meaning(field, field.meaning))
        text = S.paragraph(about) or f"Values of {sole or title(field)}."
        enumeration = Enumeration(name, text, about, tuple(entries), (field.widest + 3) // 4, path)
        if shared is None and not sole:
            self._shared[field.name] = (field.values, enumeration)
        self.choices[owner, field.name] = enumeration
        self.all.append(enumeration)


def _note(value: Value) -> str:
    # Omit a printed name of one word that the constant already has. Keep longer ones, for readers who search for them.
    about = spec_text(value.meaning) if printed(value).lower() == value.name else meaning(value, value.meaning)
    return S.paragraph(replace(statement, source=value.source) for statement in about) or words(value.name)


#: Names of the other arguments and locals in the functions of a frame.
_TAKEN = frozenset(
    "bits bytes code crc flags frame in length out plain position received rx unused value variant verdict word".split()
)


@dataclass(frozen=True, slots=True)
class AnsweredBy:
    """A parameter that follows from the answer: the function that gives it, and its value."""

    name: str
    about: str
    value: Expr


class AlternativeCode:
    """An alternative. ``argument`` is the name of the argument for the answer."""

    def __init__(self, device: Device, prefix: str, alternative: Alternative) -> None:
        self.item = alternative
        self.type = f"{prefix}_{alternative.name}"
        self.argument = c_name(alternative.name, _TAKEN)
        #: Name of the chosen answer in the programs.
        self.constant = f"my_{alternative.name}"
        entries = tuple(self._entry(index, answer) for index, answer in enumerate(alternative.answers))
        about = [
            S.sentence(statement(alternative.meaning, source=alternative.source)),
            "Choose the answer for your encoder. No known source settles it, and there is no default.",
            *(S.sentence(erratum(correction)) for correction in errata(device, f"alternatives.{alternative.name}")),
        ]
        self.enumeration = Enumeration(self.type, about, (), entries, 1, ("alternatives", alternative.name))
        dependent = (parameter for parameter in device.parameters if parameter.alternative == alternative.name)
        self.functions = tuple(self._function(prefix, parameter) for parameter in dependent)

    def _entry(self, index: int, answer: Answer) -> Entry:
        note = S.sentence(statement(answer.meaning, source=answer.source))
        return Entry(f"{self.type}_{answer.name}".upper(), index, note)

    def _function(self, prefix: str, parameter: Parameter) -> AnsweredBy:
        about = S.sentence(statement(parameter.meaning, source=parameter.source))
        return AnsweredBy(f"{prefix}_{parameter.name}", about, self._value(parameter.name))

    def declared(self) -> Iterator[Declared]:
        """Yield its declarations at file scope."""
        yield from self.enumeration.declared()
        yield from ((function.name, self.enumeration.path) for function in self.functions)

    def _value(self, parameter: str) -> Expr:
        """Return the parameter as a function of the answer. The last answer is the default branch."""
        *other_values, last_value = (Number(answer.sets[parameter]) for answer in self.item.answers)
        expression: Expr = last_value
        for constant, value in reversed(list(zip(self.enumeration.entries, other_values, strict=False))):
            expression = Conditional(Operation("==", (Name(self.argument), Name(constant.name))), value, expression)
        return expression


def alternatives_in(alternatives: tuple[AlternativeCode, ...], *expressions: Expression) -> tuple[AlternativeCode, ...]:
    """Return the alternatives on whose answers these expressions depend."""
    names = {name for expression in expressions for name in expression.parameters}
    return tuple(alternative for alternative in alternatives if not names.isdisjoint(alternative.item.answers[0].sets))


_UNUSED = Name("frame->unused")


class FrameReports:
    """The functions ``verdict`` and ``reports`` of a frame. The name of a missing function is empty.

    ``choices`` has the constants of named values by layout and field.
    """

    def __init__(
        self,
        family: Reports,
        reporting: Reporting,
        frame: str,
        type_: str,
        choices: Mapping[tuple[str, str], Enumeration],
    ) -> None:
        self.family, self.reporting, self.frame, self.type = family, reporting, frame, type_
        self._choices = choices
        self._holds = partial(_holds, family.scope)
        self.judgement = reporting.judgement
        self.verdict = f"{frame}_verdict" if reporting.judgement is not None else ""
        self.reports = f"{frame}_reports" if reporting.causes else ""
        self._every_unused = sum(op.mask for op in reporting.codec.reserved)

    def names(self) -> Iterator[str]:
        """Return the names that it declares at file scope."""
        return filter(None, (self.verdict, self.reports))

    @property
    def mask_terms(self) -> Iterator[Expr]:
        """The terms of the mask of its reports."""
        for report_cause in self.reporting.causes:
            says = joined("&&", (*map(self._holds, report_cause.conditions), self._says(report_cause.by)))
            yield Conditional(says, self.family.constant(report_cause.report), Number(0))

    @property
    def verdict_depends(self) -> bool:
        """True if the verdict depends on the order code or on an answer of the user."""
        if self.may_be_unknown:
            return True
        return any(cause.conditions for _, speaking in self._levels for cause in speaking)

    @property
    def may_be_unknown(self) -> bool:
        """True if the frames of some order codes, but not of all, have no bits that judge the position."""
        return self.judgement is not None and self.judgement.may_be_unknown

    @property
    def reports_depend(self) -> bool:
        """True if the reports depend on the order code."""
        return any(report_cause.only for report_cause in self.reporting.causes)

    @property
    def _levels(self) -> tuple[tuple[Verdict, tuple[VerdictCause, ...]], ...]:
        return self.judgement.worst_first if self.judgement is not None else ()

    def _says(self, by: Cause) -> Expr:
        return self._differ([by]) if isinstance(by, Reserved) else joined("&&", tuple(self._active(by)))

    def _active(self, by: Part | Match) -> Iterator[Expr]:
        """Yield the conditions that a flag is active, or that fields have their values."""
        if isinstance(by, Part):
            yield Name(_flag(by))
            return
        for part, value in by.conditions:
            name = _flag(part)
            if isinstance(part.meaning, Active):
                yield Name(name if value else f"!{name}")
            else:
                constant = self._choices[self.reporting.codec.layout.name, part.field.name].names[value]
                yield Operation("==", (Name(name), Name(constant)))

    @property
    def worse(self) -> Iterator[tuple[Expr, Verdict]]:
        """The conditions of verdicts worse than ``otherwise``, worst first, several of the same verdict one by one.

        Compilers that see flags joined by ``||`` load neighbouring members as one number, so that the decoder must
        store them first. Apart, they become one test of the bits of the frame.
        """
        if self.judgement is None:
            return
        levels = dict(self._levels)
        for verdict in Verdict:
            if verdict is Verdict.UNKNOWN and self.judgement.may_be_unknown:
                yield Operation("==", (self.family.scope.of(self.judgement.judging_bits), Number(0))), verdict
            else:
                yield from ((condition, verdict) for condition in self._conditions(levels.get(verdict, ())))

    def _conditions(self, causes: Sequence[VerdictCause]) -> Iterator[Expr]:
        """Yield the condition that each of these is active. Unused bits are checked together."""
        unused = []
        for cause in causes:
            if isinstance(cause.by, Reserved):
                unused.append(cause.by)
                continue
            terms = (*map(self._holds, cause.conditions), *self._active(cause.by), *map(_inactive, cause.unless))
            yield joined("&&", terms)
        if unused:
            yield self._differ(unused)

    def _differ(self, unused: Sequence[Reserved]) -> Expr:
        """Return the condition that some of these bits differ from the manual."""
        mask = sum(op.mask for op in unused)
        return Operation("!=", (_UNUSED if mask == self._every_unused else masked(_UNUSED, mask), Number(0)))


class Reports:
    """All reports of a family. ``mask`` is the type with a bit for each."""

    def __init__(
        self, device: Device, prefix: str, choices: Mapping[tuple[str, str], Enumeration], scope: Scope
    ) -> None:
        self.all, self._choices, self.scope = reports_of(device), choices, scope
        if len(self.all) > 64:
            problem = f"the frames have {len(self.all)} flags, values and fields of unused bits to report"
            raise TargetError(f"{problem}; the C target supports at most 64", ("interfaces",))
        self.mask = unsigned(max(len(self.all), 32))
        self.text = f"{prefix}_report_text"
        self.texts = tuple(_texts(device, report) for report in self.all)
        stem = f"{prefix}_report".upper()
        names = {report.name: f"{stem}_{report.name.upper()}" for report in self.all}
        entries = (Entry(names[report.name], 1 << report.number, _report_note(device, report)) for report in self.all)
        about = "Reports of the encoder. The _reports() functions of the frames return a mask of these bits."
        digits = (len(self.all) + 3) // 4
        self.enumeration = Enumeration(f"{prefix}_report", about, (), tuple(entries), digits, ())
        self._by_frame = {reporting.codec.layout.name: reporting for reporting in reportings(device)}

    def declared(self) -> Iterator[Declared]:
        """Yield the names that it declares at file scope."""
        if self.all and self.enumeration.is_enum:
            yield self.enumeration.type, ()
        if self.all:
            yield self.text, ()
        for report, constant in zip(self.all, self.enumeration.entries, strict=True):
            yield constant.name, self._path(report)

    def of(self, layout: Layout, name: str, type_: str) -> FrameReports | None:
        """Return the functions of a frame, if it has any."""
        reporting = self._by_frame.get(layout.name)
        return FrameReports(self, reporting, name, type_, self._choices) if reporting is not None else None

    def constant(self, report: Report) -> Expr:
        """Return the bit of a report."""
        name = Name(self.enumeration.entries[report.number].name)
        return Cast(self.mask, name) if self.enumeration.is_enum else name

    def _path(self, report: Report) -> Path:
        """Return the path of the first frame with this report."""
        frames = (reporting for reporting in self._by_frame.values() if _has_report(reporting, report))
        first = first_of(frames, f"frame with the report '{report.name}'")
        return ("interfaces", first.interface.name, "layouts", first.codec.layout.name)


def _has_report(reporting: Reporting, report: Report) -> bool:
    return any(report_cause.report.number == report.number for report_cause in reporting.causes)


def _texts(device: Device, report: Report) -> tuple[str, ...]:
    """Return the members of its text."""
    field = report.field
    alarm = alarm_of(device, field)
    return (
        report.name,
        field.printed_name,
        report_meaning(field, alarm),
        remedy(field, alarm),
        cite(source(field, alarm)),
    )


def _report_note(device: Device, report: Report) -> str:
    """Return its name in the manual and the source of its meaning."""
    field = report.field
    unused = ", unused" if report.is_unused else ""
    return S.sentence(statement(title(field), unused, source=source(field, alarm_of(device, field))))


def _holds(scope: Scope, only: Only) -> Expr:
    """Return the condition on a parameter of the order code."""
    return Operation("!=" if only.holds else "==", (scope.member(only.parameter), Number(0)))


def _inactive(part: Part) -> Expr:
    return Name(f"!{_flag(part)}")


def _flag(part: Part) -> str:
    return f"frame->{c_name(part.field.name)}"
