"""Reports in C: an enumeration and texts of all reports of a family, and the functions of each frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...language.problems import Path
from ...model import Device, Layout, Verdict, cite, first_of
from ...plan.operations import Part, Reserved
from ...plan.values import Active
from ...plan.verdicts import Cause, Match, Only, Report, Reporting, VerdictCause, reportings, reports_of
from ...say.names_and_places import title
from ...say.report import alarm_of, meaning, remedy, source
from ...say.text import statement
from .. import TargetError
from .comments import S
from .enumerations import Entry, Enumeration
from .expr import Cast, Conditional, Expr, Name, Number, Operation, joined, masked, unsigned
from .names import Declared, c_name

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
            says = joined("&&", (*map(_holds, report_cause.conditions), self._says(report_cause.by)))
            yield Conditional(says, self.family.constant(report_cause.report), Number(0))

    @property
    def verdict_depends(self) -> bool:
        """True if the verdict depends on the order code or on an answer of the user."""
        return any(cause.conditions for _, speaking in self._levels for cause in speaking)

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
        """The conditions of verdicts worse than ``otherwise``, worst first."""
        for verdict, speaking in self._levels:
            yield self._any(speaking), verdict

    def _any(self, speaking: Sequence[VerdictCause]) -> Expr:
        """Return the condition that one of these is active. Unused bits are checked together."""
        conditions, unused = [], []
        for cause in speaking:
            if isinstance(cause.by, Reserved):
                unused.append(cause.by)
                continue
            terms = (*map(_holds, cause.conditions), *self._active(cause.by), *map(_inactive, cause.unless))
            conditions.append(joined("&&", terms))
        if unused:
            conditions.append(self._differ(unused))
        return joined("||", tuple(conditions))

    def _differ(self, unused: Sequence[Reserved]) -> Expr:
        """Return the condition that some of these bits differ from the manual."""
        mask = sum(op.mask for op in unused)
        return Operation("!=", (_UNUSED if mask == self._every_unused else masked(_UNUSED, mask), Number(0)))


class Reports:
    """All reports of a family. ``mask`` is the type with a bit for each."""

    def __init__(self, device: Device, prefix: str, choices: Mapping[tuple[str, str], Enumeration]) -> None:
        self.all, self._choices = reports_of(device), choices
        if len(self.all) > 64:
            problem = f"the frames have {len(self.all)} flags, values and fields of unused bits to report"
            raise TargetError(f"{problem}; the C target supports at most 64", ("interfaces",))
        self.mask = unsigned(max(len(self.all), 32))
        self.text = f"{prefix}_report_text"
        self.texts = tuple(_texts(device, report) for report in self.all)
        stem = f"{prefix}_report".upper()
        names = {report.name: f"{stem}_{report.name.upper()}" for report in self.all}
        entries = (Entry(names[report.name], 1 << report.number, _note(device, report)) for report in self.all)
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
    return (report.name, field.printed_name, meaning(field, alarm), remedy(field, alarm), cite(source(field, alarm)))


def _note(device: Device, report: Report) -> str:
    """Return its name in the manual and the source of its meaning."""
    field = report.field
    unused = ", unused" if report.is_unused else ""
    return S.sentence(statement(title(field), unused, source=source(field, alarm_of(device, field))))


def _holds(only: Only) -> Expr:
    """Return the condition on a parameter of the order code."""
    return Operation("!=" if only.holds else "==", (Name(f"variant.{c_name(only.parameter)}"), Number(0)))


def _inactive(part: Part) -> Expr:
    return Name(f"!{_flag(part)}")


def _flag(part: Part) -> str:
    return f"frame->{c_name(part.field.name)}"
