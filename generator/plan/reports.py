"""Reports of the encoder in frames, and the verdict on their position.

A valid frame may contain an unusable position, since an encoder with an error, or a busy one, also sends valid CRCs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from dataclasses import field as dataclass_field

from ..model import Device, Field, Flag, Interface, Layout, Verdict
from ..model.kinds import Choice, Constant, CrcValue, Decimal, Number, Parity, Text, Unused
from ..model.never import assert_never
from .codec import Codec, Part, Reserved, codec_of


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """One report of a family. ``number`` is its bit in the set of all reports.

    ``field`` is the flag or the reserved bits, from the first frame that has them.
    """

    name: str
    number: int
    field: Field

    @property
    def is_unused(self) -> bool:
        """True if it reports reserved bits."""
        return isinstance(self.field.kind, Unused)


@dataclass(frozen=True, slots=True)
class Only:
    """Order codes selected by a parameter: those with a value other than 0 if ``holds`` is true, else those with 0.

    ``codes`` is the text in the spec for those with a value other than 0.
    """

    parameter: str
    holds: bool
    codes: str = dataclass_field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class Told:
    """Report in a frame: an active flag, or reserved bits that differ from the manual.

    Without ``only`` it applies to all order codes.
    """

    report: Report
    by: Part | Reserved
    only: Only | None = None

    @property
    def made_of(self) -> Field:
        """The field as it is for these order codes."""
        is_explained = self.only is None or self.only.holds
        return self.by.field if is_explained else _unexplained(self.by.field)


@dataclass(frozen=True, slots=True)
class Speaks:
    """Cause of a verdict, unless one of the flags ``unless``, which it combines, is active.

    ``unless`` omits flags that lead to the same verdict or a worse one, since they make no difference. Without ``only``
    it applies to all order codes.
    """

    by: Part | Reserved
    unless: tuple[Part, ...]
    only: Only | None = None


@dataclass(frozen=True, slots=True)
class Judgement:
    """Verdict on the position of a frame: that of the worst active cause, or ``otherwise`` if none is active.

    If ``otherwise`` is UNKNOWN, warnings have no effect, since UNKNOWN is worse than a warning.
    """

    not_usable: tuple[Speaks, ...]
    with_warning: tuple[Speaks, ...]
    otherwise: Verdict

    @property
    def worst_first(self) -> tuple[tuple[Verdict, tuple[Speaks, ...]], ...]:
        """Return the verdicts with their causes, worst first."""
        levels = ((Verdict.NOT_USABLE, self.not_usable), (Verdict.USABLE_WITH_WARNING, self.with_warning))
        return tuple(item for item in levels if item[1])


@dataclass(frozen=True, slots=True)
class Reporting:
    """Reports and verdict of one layout. ``judgement`` is None if the layout does not contain the position."""

    interface: Interface
    codec: Codec
    told: tuple[Told, ...]
    judgement: Judgement | None


def reports_of(device: Device) -> tuple[Report, ...]:
    """Return all reports in the frames of a family, in the same order as in the spec.

    Flags with the same name and meaning are one report. Otherwise the interface or the frame precedes the name.
    """
    return tuple(dict.fromkeys(_reports(device).values()))


def reportings(device: Device) -> Iterator[Reporting]:
    """Yield the reports and the verdict of each frame of the encoder that has any."""
    reports = _reports(device)
    for interface, layout in _sent(device):
        codec = codec_of(device, layout)
        told = tuple(
            Told(reports[layout.name, item.name], by, only)
            for by in _telling(codec)
            for item, only in _by_code(by.field)
            if _is_told(item)
        )
        tells = device.tells_position(interface.name, layout)
        if told or tells:
            yield Reporting(interface, codec, told, _judgement(codec) if tells else None)


def _sent(device: Device) -> Iterator[tuple[Interface, Layout]]:
    return ((interface, layout) for interface, layout in device.layouts() if layout.sender == "encoder")


def _telling(codec: Codec) -> Iterator[Part | Reserved]:
    yield from (part for part in codec.parts if isinstance(part.field.kind, Flag))
    yield from codec.reserved


def explained(field: Field) -> Only | None:
    """Return the order codes for which the manual explains a flag, or None if it does so for all."""
    return next(only for _, only in _by_code(field))


def verdict_of(field: Field) -> Verdict | None:
    """Return the verdict on the position while a flag is active or unused bits differ, or None without a position."""
    match field.kind:
        case Flag(makes_position=verdict) | Unused(makes_position=verdict):
            return verdict
        case Number() | Choice() | Constant() | CrcValue() | Parity() | Decimal() | Text():
            return None
        case _:
            assert_never(field.kind)


def _by_code(field: Field) -> Iterator[tuple[Field, Only | None]]:
    """Yield the field. If the manual explains it only for some order codes, yield a separate one for the others."""
    match field.kind:
        case Flag(only_while=parameter, only=codes) if parameter:
            yield field, Only(parameter, True, codes)
            yield _unexplained(field), Only(parameter, False, codes)
        case _:
            yield field, None


def _unexplained(field: Field) -> Field:
    return replace(field.unexplained, name=f"{field.name}_unexplained")


def sums_up(field: Field) -> tuple[str, ...]:
    """Return the names of the flags that a flag combines."""
    return field.kind.sums_up if isinstance(field.kind, Flag) else ()


def _is_told(field: Field) -> bool:
    """Return whether the field reports a problem. Those that leave the position usable do not."""
    return isinstance(field.kind, (Flag, Unused)) and field.kind.makes_position is not Verdict.USABLE


def _reports(device: Device) -> Mapping[tuple[str, str], Report]:
    """Return the reports by frame and field."""
    found = [
        (interface.name, layout.name, item, only is not None and not only.holds)
        for interface, layout in _sent(device)
        for field in layout.fields
        for item, only in _by_code(field)
        if _is_told(item)
    ]
    # Unexplained flags are last, so that the others keep their numbers.
    fields = [item[:3] for item in sorted(found, key=lambda item: item[3])]
    said: dict[str, set[object]] = {}
    for kind, _, item in fields:
        for name in (item.name, f"{kind}_{item.name}"):
            said.setdefault(name, set()).add((item.kind, item.group, item.meaning))
    made: dict[tuple[str, str], Report] = {}
    by_name: dict[str, Report] = {}
    for kind, frame, item in fields:
        names = (item.name, f"{kind}_{item.name}")
        name = next((name for name in names if len(said[name]) == 1), f"{frame}_{item.name}")
        made[frame, item.name] = by_name.setdefault(name, Report(name, len(by_name), item))
    return made


def _judgement(codec: Codec) -> Judgement:
    parts = {part.field.name: part for part in codec.parts}
    speaking: dict[Verdict, list[Speaks]] = {verdict: [] for verdict in Verdict}
    for by in _telling(codec):
        match by.field.kind:
            case Flag():
                for flag, only in _by_worth(by.field):
                    others = [parts[name] for name in flag.sums_up if name in parts]
                    if flag.makes_position is not None:
                        unless = tuple(item for item in others if not _decides(item, flag.makes_position, parts))
                        speaking[flag.makes_position].append(Speaks(by, unless, only))
            case Unused(makes_position=verdict):
                speaking[verdict].append(Speaks(by, ()))
    flags = (part.field.kind for part in codec.parts if isinstance(part.field.kind, Flag))
    tells = any(flag.makes_position is not Verdict.USABLE and not flag.only_while for flag in flags)
    warning = speaking[Verdict.USABLE_WITH_WARNING] if tells else ()
    otherwise = Verdict.USABLE if tells else Verdict.UNKNOWN
    return Judgement(tuple(speaking[Verdict.NOT_USABLE]), tuple(warning), otherwise)


def _by_worth(field: Field) -> Iterator[tuple[Flag, Only | None]]:
    """Yield the flag for each group of order codes that has a different verdict."""
    found = [(item.kind, only) for item, only in _by_code(field) if isinstance(item.kind, Flag)]
    alike = len({(kind.makes_position, kind.sums_up) for kind, _ in found}) == 1
    yield from [(found[0][0], None)] if alike else found


def _decides(part: Part, verdict: Verdict, parts: Mapping[str, Part]) -> bool:
    """Return whether a flag always leads to ``verdict`` or a worse one."""
    match part.field.kind:
        case Flag(makes_position=own, sums_up=names, only_while="") if own is not None:
            worst_first = list(Verdict)
            return worst_first.index(own) <= worst_first.index(verdict) and parts.keys().isdisjoint(names)
        case _:
            return False
