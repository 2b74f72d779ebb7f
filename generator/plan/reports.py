"""What frames report of the encoder, and what the position in them is worth.

A sound frame is not yet a usable position: an encoder with an error, or a busy one, sends frames with a right CRC too.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ..model import Device, Field, Flag, Interface, Layout, Unused, Verdict
from .codec import Codec, Part, Reserved, codec_of


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """One thing that a family can report: the bit ``number`` of its reports.

    ``field`` is the flag, or the unused bits, as the first frame has it that carries it.
    """

    name: str
    number: int
    field: Field


@dataclass(frozen=True, slots=True)
class Told:
    """A frame makes a report: by a flag while it is active, or by unused bits that are not as the manual has them."""

    report: Report
    by: Part | Reserved


@dataclass(frozen=True, slots=True)
class Speaks:
    """What decides about the position, unless one of the flags ``unless`` is active, which it only sums up.

    Those of them that decide by themselves, and no better, are left out: with them the position is worth no more.
    """

    by: Part | Reserved
    unless: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class Judgement:
    """What the position of a frame is worth: the worst that speaks decides, and ``otherwise`` if nothing speaks."""

    not_usable: tuple[Speaks, ...]
    with_warning: tuple[Speaks, ...]
    otherwise: Verdict


@dataclass(frozen=True, slots=True)
class Reporting:
    """What the frames of one layout tell. ``judgement`` is None where they do not carry the position."""

    interface: Interface
    codec: Codec
    told: tuple[Told, ...]
    judgement: Judgement | None


def reports_of(device: Device) -> tuple[Report, ...]:
    """All that the frames of a family can report, in the order in which the spec lists it.

    Flags of one name are one report where they say the same; else the interface or the frame is put before the name.
    """
    return tuple(dict.fromkeys(_reports(device).values()))


def reportings(device: Device) -> Iterator[Reporting]:
    """What each frame of the encoder tells, of those that tell anything."""
    reports = _reports(device)
    for interface, layout in _sent(device):
        codec = codec_of(device, layout)
        told = tuple(Told(reports[layout.name, by.field.name], by) for by in _telling(codec) if _is_told(by.field))
        tells = device.tells_position(interface.name, layout)
        if told or tells:
            yield Reporting(interface, codec, told, _judgement(codec) if tells else None)


def _sent(device: Device) -> Iterator[tuple[Interface, Layout]]:
    return ((interface, layout) for interface, layout in device.layouts() if layout.sender == "encoder")


def _telling(codec: Codec) -> Iterator[Part | Reserved]:
    yield from (part for part in codec.parts if isinstance(part.field.kind, Flag))
    yield from codec.reserved


def _is_told(field: Field) -> bool:
    """Whether it says something of the encoder's state; a flag during which the position is usable need not."""
    return isinstance(field.kind, (Flag, Unused)) and field.kind.makes_position is not Verdict.USABLE


def _reports(device: Device) -> Mapping[tuple[str, str], Report]:
    """By frame and field."""
    fields = [
        (interface.name, layout.name, item)
        for interface, layout in _sent(device)
        for item in layout.fields
        if _is_told(item)
    ]
    said: dict[str, set[object]] = {}
    for kind, _, item in fields:
        for name in (item.name, f"{kind}_{item.name}"):
            said.setdefault(name, set()).add((item.kind, item.group, item.meaning))
    found: dict[tuple[str, str], Report] = {}
    by_name: dict[str, Report] = {}
    for kind, frame, item in fields:
        names = (item.name, f"{kind}_{item.name}")
        name = next((name for name in names if len(said[name]) == 1), f"{frame}_{item.name}")
        found[frame, item.name] = by_name.setdefault(name, Report(name, len(by_name), item))
    return found


def _judgement(codec: Codec) -> Judgement:
    parts = {part.field.name: part for part in codec.parts}
    speaking: dict[Verdict, list[Speaks]] = {verdict: [] for verdict in Verdict}
    for by in _telling(codec):
        match by.field.kind:
            case Flag(makes_position=verdict, sums_up=names) if verdict is not None:
                others = (parts[name] for name in names if name in parts)
                unless = tuple(item for item in others if not _decides(item, verdict, parts))
                speaking[verdict].append(Speaks(by, unless))
            case Unused(makes_position=verdict):
                speaking[verdict].append(Speaks(by, ()))
    flags = (part.field.kind for part in codec.parts if isinstance(part.field.kind, Flag))
    tells = any(flag.makes_position is not Verdict.USABLE for flag in flags)
    return Judgement(
        tuple(speaking[Verdict.NOT_USABLE]),
        tuple(speaking[Verdict.USABLE_WITH_WARNING]),
        Verdict.USABLE if tells else Verdict.NOT_TOLD,
    )


def _decides(part: Part, verdict: Verdict, parts: Mapping[str, Part]) -> bool:
    """Whether a flag makes the position worth no more than ``verdict``, whatever else is active."""
    match part.field.kind:
        case Flag(makes_position=own, sums_up=names) if own is not None:
            worst_first = list(Verdict)
            return worst_first.index(own) <= worst_first.index(verdict) and parts.keys().isdisjoint(names)
        case _:
            return False
