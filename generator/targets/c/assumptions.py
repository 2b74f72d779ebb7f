"""The page of each manufacturer for safety reviews: assumptions of frames and code, and undetected errors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, TypedDict

from ...model import Crc, Device, Layout, Manufacturer, Spi, Ssi, Verdict, choices
from ...model.record import dataclass
from ...plan.crcs import Residual, residual
from ...plan.verdicts import reportings
from ...say.names_and_places import words
from .. import Library

TEMPLATE = "ASSUMPTIONS.md.jinja"


@dataclass(frozen=True)
class Frames:
    """Frames of one length with the same CRC, and the errors that the CRC misses in them."""

    crc: Crc
    names: tuple[str, ...]
    residual: Residual


class Assumptions(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    frames: Annotated[list[Frames], "the frames with a CRC, by CRC and length"]
    silent: Annotated[list[str], "the frames with a position whose verdict is always unknown"]
    unprotected: Annotated[list[str], "the SSI words with a position that have no CRC"]
    interfaces: Annotated[frozenset[str], "the interfaces of the encoders"]
    later: Annotated[bool, "whether an encoder over SPI answers with the next word"]
    parity: Annotated[list[str], "the frames with a position that have a parity bit and no CRC"]


def assumptions_files(
    library: Library, render: Callable[[str, Mapping[str, object]], str]
) -> Iterator[tuple[str, str]]:
    """Yield the page of each manufacturer, by its path in the C folder."""
    for maker, devices in library.by_manufacturer():
        interfaces = [interface for device in devices for interface in device.interfaces]
        values: Assumptions = {
            "maker": maker,
            "frames": list(_frames(devices)),
            "silent": list(_without_verdict(devices)),
            "unprotected": list(_unprotected(devices)),
            "interfaces": frozenset(interface.name for interface in interfaces),
            "later": any(isinstance(interface, Spi) and interface.reply == "next_word" for interface in interfaces),
            "parity": list(_with_parity(devices)),
        }
        yield f"ASSUMPTIONS-{maker.name}.md", render(TEMPLATE, values)


def _frames(devices: tuple[Device, ...]) -> Iterator[Frames]:
    names_by_crc: dict[tuple[int, int, int], tuple[Crc, list[str]]] = {}
    for device in devices:
        for interface, layout in device.layouts():
            crc = device.crc_of(layout)
            if crc is None:
                continue
            name = _frame_name(device, interface.title, layout)
            for bits in sorted(_lengths(device, interface.name, layout)):
                names = names_by_crc.setdefault((crc.width, crc.poly, bits), (crc, []))[1]
                if name not in names:
                    names.append(name)
    for (_, _, bits), (crc, names) in sorted(names_by_crc.items(), key=lambda key_and_names: key_and_names[0]):
        yield Frames(crc, tuple(names), residual(crc, bits))


def _lengths(device: Device, interface: str, layout: Layout) -> set[int]:
    """Return the possible lengths of frames of a layout: of each order code, and the longest that registers allow."""
    variants = device.variants_over(interface)
    decided = [sets for _, sets in choices(device.alternatives)]
    return {
        layout.widest,
        *(layout.bits.value({**variant.parameters, **sets}) for variant in variants for sets in decided),
    }


def _without_verdict(devices: tuple[Device, ...]) -> Iterator[str]:
    for device in devices:
        for reporting in reportings(device):
            judgement = reporting.judgement
            if judgement is not None and judgement.otherwise is Verdict.UNKNOWN and not judgement.worst_first:
                yield _frame_name(device, reporting.interface.title, reporting.codec.layout)


def _unprotected(devices: tuple[Device, ...]) -> Iterator[str]:
    for device in devices:
        for interface, layout in device.layouts():
            has_position = device.tells_position(interface.name, layout)
            if isinstance(interface, Ssi) and has_position and device.crc_of(layout) is None:
                yield _frame_name(device, interface.title, layout)


def _with_parity(devices: tuple[Device, ...]) -> Iterator[str]:
    for device in devices:
        for interface, layout in device.layouts():
            is_alone = layout.has_parity and device.crc_of(layout) is None
            if is_alone and device.tells_position(interface.name, layout):
                yield _frame_name(device, interface.title, layout)


def _frame_name(device: Device, interface: str, layout: Layout) -> str:
    return f"{device.name.upper()} {interface}: {words(layout.name)}"
