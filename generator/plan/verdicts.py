"""Verdict on the position of a frame, and the reports of the encoder that decide it.

A valid frame may contain an unusable position, since an encoder with an error, or a busy one, also sends valid CRCs.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import field as dataclass_field
from dataclasses import replace

from ..model import Device, Field, Flag, Interface, Layout, Verdict
from ..model.expressions import Expression
from ..model.kinds import Choice, Constant, CrcValue, Decimal, Number, Parity, Text, Unused
from ..model.lookup import assert_never
from ..model.record import dataclass
from .codec import Codec, codec_of
from .operations import Part, Reserved


@dataclass(frozen=True, slots=True)
class Only:
    """Order codes selected by a parameter: those with a value other than 0 if ``holds`` is true, else those with 0.

    ``codes`` is the text in the spec for those with a value other than 0.
    """

    parameter: str
    holds: bool
    codes: str = dataclass_field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class Match:
    """Values of parts that decide a verdict together, like the active flag ``field``, which has no bits.

    The value of a flag is 1 while it is active.
    """

    field: Field
    conditions: tuple[tuple[Part, int], ...]


#: Cause of a verdict or a report: a flag, reserved bits, or values.
Cause = Part | Reserved | Match


@dataclass(frozen=True, slots=True)
class VerdictCause:
    """Cause of a verdict, unless one of the flags ``unless``, which it combines, is active.

    ``unless`` omits flags that lead to the same verdict or a worse one, since they make no difference. Without ``only``
    it applies to all order codes. If an answer of the user decides the verdict, ``chosen`` is the condition on the
    parameter that the answer sets.
    """

    by: Cause
    unless: tuple[Part, ...]
    only: Only | None = None
    chosen: Only | None = None

    @property
    def conditions(self) -> tuple[Only, ...]:
        """Conditions on parameters of the order code."""
        return tuple(condition for condition in (self.only, self.chosen) if condition is not None)


@dataclass(frozen=True, slots=True)
class Judgement:
    """Verdict on the position of a frame: that of the worst active cause, or ``otherwise`` if none is active.

    If ``otherwise`` is UNKNOWN, warnings have no effect, since UNKNOWN is worse than a warning. ``judging_bits`` is the
    number of bits that say whether the position is usable. For order codes where it is 0, UNKNOWN is also a verdict.
    """

    not_usable: tuple[VerdictCause, ...]
    with_warning: tuple[VerdictCause, ...]
    otherwise: Verdict
    judging_bits: Expression

    @property
    def may_be_unknown(self) -> bool:
        """True if the frames of some order codes have no bits that judge the position, and those of others have."""
        return not self.judging_bits.is_constant

    def for_parameters(self, parameters: Mapping[str, int]) -> Judgement:
        """Return the verdict for an order code with these parameters, without causes that its frames do not have."""
        not_usable = tuple(cause for cause in self.not_usable if _has_bits(cause.by, parameters))
        if self.judging_bits.value(parameters) == 0:
            return Judgement(not_usable, (), Verdict.UNKNOWN, Expression(0))
        with_warning = tuple(cause for cause in self.with_warning if _has_bits(cause.by, parameters))
        return Judgement(not_usable, with_warning, self.otherwise, Expression(1))

    @property
    def worst_first(self) -> tuple[tuple[Verdict, tuple[VerdictCause, ...]], ...]:
        """Return the verdicts with their causes, worst first."""
        levels = ((Verdict.NOT_USABLE, self.not_usable), (Verdict.USABLE_WITH_WARNING, self.with_warning))
        return tuple(level for level in levels if level[1])


def _has_bits(cause: Cause, parameters: Mapping[str, int]) -> bool:
    """Return whether the frames of an order code with these parameters have the bits of a cause."""
    places = [part.bits for part, _ in cause.conditions] if isinstance(cause, Match) else [cause.bits]
    return all(bits.width.value(parameters) > 0 for bits in places)


def judgement_of(codec: Codec) -> Judgement:
    """Return the verdict on the position of a frame, with everything that it depends on."""
    parts = {part.field.name: part for part in codec.parts}
    speaking: dict[Verdict, list[VerdictCause]] = {verdict: [] for verdict in Verdict}
    for cause in verdict_causes(codec):
        match cause.field.kind:
            case Flag():
                for flag, only in _by_worth(cause.field):
                    summed_parts = [parts[name] for name in flag.sums_up if name in parts]
                    for flag_verdict, chosen in _by_answer(flag):
                        unless = tuple(part for part in summed_parts if not _always_leads_to(part, flag_verdict, parts))
                        speaking[flag_verdict].append(VerdictCause(cause, unless, only, chosen))
            case Unused(makes_position=verdict):
                speaking[verdict].append(VerdictCause(cause, ()))
    tells = codec.layout.tells_validity
    warning = speaking[Verdict.USABLE_WITH_WARNING] if tells else ()
    otherwise = Verdict.USABLE if tells else Verdict.UNKNOWN
    return Judgement(tuple(speaking[Verdict.NOT_USABLE]), tuple(warning), otherwise, codec.layout.judging_bits)


def _by_worth(field: Field) -> Iterator[tuple[Flag, Only | None]]:
    """Yield the flag for each group of order codes that has a different verdict."""
    coded_flags = [(coded.kind, only) for coded, only in by_code(field) if isinstance(coded.kind, Flag)]
    alike = len({(kind.makes_position, kind.sums_up, kind.verdict_if_set) for kind, _ in coded_flags}) == 1
    yield from [(coded_flags[0][0], None)] if alike else coded_flags


def _by_answer(flag: Flag) -> Iterator[tuple[Verdict, Only | None]]:
    """Yield the verdicts of a flag, each with the condition on the answer that decides it."""
    if flag.makes_position is None:
        return
    if flag.verdict_if_set is None:
        yield flag.makes_position, None
        return
    yield flag.makes_position, Only(flag.verdict_parameter, False)
    yield flag.verdict_if_set, Only(flag.verdict_parameter, True)


def _always_leads_to(part: Part, verdict: Verdict, parts: Mapping[str, Part]) -> bool:
    """Return whether a flag always leads to ``verdict`` or a worse one."""
    match part.field.kind:
        case Flag(makes_position=flag_verdict, sums_up=names, only_while="", verdict_if_set=None) if (
            flag_verdict is not None
        ):
            worst_first = list(Verdict)
            return worst_first.index(flag_verdict) <= worst_first.index(verdict) and parts.keys().isdisjoint(names)
        case _:
            return False


def verdict_of(field: Field) -> Verdict | None:
    """Return the verdict on the position while a flag is active or unused bits differ, or None without a position."""
    match field.kind:
        case Flag(makes_position=verdict) | Unused(makes_position=verdict):
            return verdict
        case Number() | Choice() | Constant() | CrcValue() | Parity() | Decimal() | Text():
            return None
        case _:
            assert_never(field.kind)


def verdict_causes(codec: Codec) -> Iterator[Cause]:
    """Yield the flags, the reserved bits, and the values of a frame that can decide its verdict."""
    yield from (part for part in codec.parts if isinstance(part.field.kind, Flag))
    yield from codec.reserved
    parts = {part.field.name: part for part in codec.parts}
    for sign in codec.layout.signs:
        yield Match(sign.flag, tuple((parts[name], value) for name, value in sign.conditions))


def by_code(field: Field) -> Iterator[tuple[Field, Only | None]]:
    """Yield the field. If the manual explains it only for some order codes, yield a separate one for the others."""
    match field.kind:
        case Flag(only_while=parameter, only=codes) if parameter:
            yield field, Only(parameter, True, codes)
            yield unexplained(field), Only(parameter, False, codes)
        case _:
            yield field, None


def unexplained(field: Field) -> Field:
    """Return a flag as it is for order codes for which the manual does not explain it."""
    return replace(field.unexplained, name=f"{field.name}_unexplained")


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
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


@dataclasses.dataclass(frozen=True, slots=True)
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


@dataclasses.dataclass(frozen=True, slots=True)
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
