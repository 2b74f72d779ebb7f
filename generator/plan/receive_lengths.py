"""How much a receiver takes in for a frame that comes as bits: by order code, so that code has it as constants."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product

from ..model import Answer, Device, Interface, Layout, Rs485, Ssi, Variant, choices

#: Before the start bit of a BiSS frame the line rests for two clocks, then come acknowledge and line delay. No manual
#: says how long an encoder takes; this is room for so many bits, 4 us at 10 MHz.
BISS_REST, BISS_ACKNOWLEDGE = 2, 40
#: Start and CDS before the data, and the stop bit after them.
BISS_AROUND = 3
#: Over SSI the line is high until the first clock has stored the position, and one more clock brings the 0 after it.
SSI_AROUND = 2


@dataclass(frozen=True, slots=True)
class Received:
    """What a frame of one order code takes: its bits, and the bytes of a buffer with room for what surrounds them.

    ``answers`` are those decisions of the user on which the length depends. ``held`` says that registers change
    the bits at run time: they are then those of the factory default, and the bytes are enough for any register value.
    """

    variant: Variant
    layout: Layout
    bits: int
    bytes: int
    held: bool
    answers: tuple[Answer, ...] = ()


def received(device: Device, interface: Interface) -> Iterator[Received]:
    """Yield the frames that this interface carries as bits from the encoder, by order code.

    A frame whose length depends on what the manual leaves open comes once for each way to decide.
    """
    held = {item.name for item in device.set_parameters if item.register}
    for layout in interface.layouts:
        needed = set(_set_parameters(device, layout.bits.parameters))
        if layout.in_bytes or layout.sender != "encoder":
            continue
        deciding = [item for item in device.alternatives if not needed.isdisjoint(item.answers[0].sets)]
        moves = bool(needed & held)
        variants = [item for item in device.variants if item.interface in ("", interface.name)]
        for variant, (answers, sets) in product(variants, choices(deciding)):
            bits = layout.bits.value({**variant.parameters, **sets})
            size = _bytes(interface, layout.widest if moves else bits)
            yield Received(variant, layout, bits, size, moves, answers)


def _bytes(interface: Interface, bits: int) -> int:
    around = SSI_AROUND if isinstance(interface, Ssi) else BISS_REST + BISS_ACKNOWLEDGE + BISS_AROUND
    return (around + bits + 7) // 8


def _set_parameters(device: Device, names: tuple[str, ...]) -> Iterator[str]:
    """The parameters that these come down to."""
    for name in names:
        item = next((item for item in device.parameters if item.name == name), None)
        if item is None or item.equals is None:
            yield name
        else:
            yield from _set_parameters(device, item.equals.parameters)


def longest_reply(devices: Iterable[Device]) -> int:
    """The bytes of the longest frame that one of these sends over RS-485; 0 where there is none."""
    ports = (item for device in devices for item in device.interfaces if isinstance(item, Rs485))
    frames = (frame for port in ports for frame in port.layouts if frame.sender == "encoder" and frame.in_bytes)
    return max((frame.widest // 8 for frame in frames), default=0)
