"""Reports of the encoder in frames: flags, reserved bits that differ from the manual, and values with a verdict."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ..model import Device, Field, Flag, Interface, Layout, Verdict
from ..model.kinds import Unused
from .codec import Codec, codec_of
from .verdicts import Cause, Judgement, Only, by_code, judgement_of, unexplained, verdict_causes


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """One report of a family. ``number`` is its bit in the set of all reports.

    ``field`` is the flag, the reserved bits or the flag of a sign, from the first frame that has them.
    """

    name: str
    number: int
    field: Field

    @property
    def is_unused(self) -> bool:
        """True if it reports reserved bits."""
        return isinstance(self.field.kind, Unused)


@dataclass(frozen=True, slots=True)
class ReportCause:
    """Report in a frame: an active flag, reserved bits that differ from the manual, or values with a verdict.

    Without ``only`` it applies to all order codes.
    """

    report: Report
    by: Cause
    only: Only | None = None

    @property
    def conditions(self) -> tuple[Only, ...]:
        """Conditions on parameters of the order code."""
        return (self.only,) if self.only is not None else ()

    @property
    def made_of(self) -> Field:
        """The field as it is for these order codes."""
        is_explained = self.only is None or self.only.holds
        return self.by.field if is_explained else unexplained(self.by.field)


@dataclass(frozen=True, slots=True)
class Reporting:
    """Reports and verdict of one layout. ``judgement`` is None if the layout does not contain the position."""

    interface: Interface
    codec: Codec
    causes: tuple[ReportCause, ...]
    judgement: Judgement | None


def reports_of(device: Device) -> tuple[Report, ...]:
    """Return all reports in the frames of a family, in the same order as in the spec.

    Flags with the same name and meaning are one report. Otherwise the interface or the frame precedes the name.
    """
    return tuple(dict.fromkeys(_reports(device).values()))


def reportings(device: Device) -> Iterator[Reporting]:
    """Yield the reports and the verdict of each frame of the encoder that has any."""
    reports = _reports(device)
    for interface, layout in _sent_layouts(device):
        codec = codec_of(device, layout)
        causes: list[ReportCause] = []
        for cause in verdict_causes(codec):
            reported = ((field, only) for field, only in by_code(cause.field) if _is_reported(field))
            causes += [ReportCause(reports[layout.name, field.name], cause, only) for field, only in reported]
        judgement = judgement_of(codec) if device.tells_position(interface.name, layout) else None
        if causes or judgement is not None:
            yield Reporting(interface, codec, tuple(causes), judgement)


def _sent_layouts(device: Device) -> Iterator[tuple[Interface, Layout]]:
    return ((interface, layout) for interface, layout in device.layouts() if layout.sender == "encoder")


def explained(field: Field) -> Only | None:
    """Return the order codes for which the manual explains a flag, or None if it does so for all."""
    return next(only for _, only in by_code(field))


def sums_up(field: Field) -> tuple[str, ...]:
    """Return the names of the flags that a flag combines."""
    return field.kind.sums_up if isinstance(field.kind, Flag) else ()


def _is_reported(field: Field) -> bool:
    """Return whether the field reports a problem. Those that leave the position usable do not."""
    return isinstance(field.kind, (Flag, Unused)) and field.kind.makes_position is not Verdict.USABLE


def _fields_by_code(layout: Layout) -> Iterator[tuple[Field, Only | None]]:
    """Yield the fields and signs that report a problem, each with the order codes for which it does."""
    for field in (*layout.fields, *(sign.flag for sign in layout.signs)):
        for coded_field, only in by_code(field):
            if _is_reported(coded_field):
                yield coded_field, only


def _reports(device: Device) -> Mapping[tuple[str, str], Report]:
    """Return the reports by frame and field."""
    explained_fields: list[tuple[str, str, Field]] = []
    unexplained_fields: list[tuple[str, str, Field]] = []
    for interface, layout in _sent_layouts(device):
        for field, only in _fields_by_code(layout):
            is_unexplained = only is not None and not only.holds
            (unexplained_fields if is_unexplained else explained_fields).append((interface.name, layout.name, field))
    # Unexplained flags are last, so that the others keep their numbers.
    fields = explained_fields + unexplained_fields
    properties_by_name: dict[str, set[object]] = {}
    for kind, _, field in fields:
        for name in (field.name, f"{kind}_{field.name}"):
            properties_by_name.setdefault(name, set()).add((field.kind, field.group, field.meaning))
    reports_by_field: dict[tuple[str, str], Report] = {}
    by_name: dict[str, Report] = {}
    for kind, frame, field in fields:
        names = (field.name, f"{kind}_{field.name}")
        name = next((name for name in names if len(properties_by_name[name]) == 1), f"{frame}_{field.name}")
        reports_by_field[frame, field.name] = by_name.setdefault(name, Report(name, len(by_name), field))
    return reports_by_field
