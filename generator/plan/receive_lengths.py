"""Number of bits to receive for a frame that is sent as bits. Code uses it as a constant for each order code."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from ..model import Answer, Biss, Device, Interface, Layout, Rs485, Spi, Ssi, Variant, assert_never, choices
from ..model.record import dataclass

#: Before the start bit of a BiSS frame come two idle clocks, the acknowledge and the line delay. No manual states how
#: long an encoder takes. This is an allowance in bits, equal to 4 us at 10 MHz.
BISS_REST, BISS_ACKNOWLEDGE = 2, 40
#: Start bit and CDS before the data, and stop bit after the data.
BISS_AROUND = 3
#: On SSI, the line is high until the first clock has latched the position. One more clock shifts out the 0 after it.
SSI_AROUND = 2


@dataclass(frozen=True, slots=True)
class FrameSize:
    """Size of a frame for one order code: its length in bits, and the bytes of a buffer for it and the bits around it.

    ``answers`` are the user's decisions on which the length depends. ``depends_on_registers`` is true if registers
    change the length at run time. The number of bits is then that of the factory default, and the buffer is large
    enough for any register value.
    """

    variant: Variant
    layout: Layout
    bits: int
    bytes: int
    depends_on_registers: bool
    answers: tuple[Answer, ...] = ()


def received(device: Device, interface: Interface) -> Iterator[FrameSize]:
    """Yield the frames that the encoder sends as bits on this interface, by order code.

    A frame whose length depends on a question that the manual leaves open is yielded once for each answer.
    """
    register_parameters = {parameter.name for parameter in device.set_parameters if parameter.register}
    around = _bits_around(interface)
    for layout in interface.layouts:
        needed_names = device.needed_parameters(layout.bits.parameters)
        if layout.sender != "encoder" or around is None:
            continue
        deciding = [choice for choice in device.alternatives if not needed_names.isdisjoint(choice.answers[0].sets)]
        moves = bool(needed_names & register_parameters)
        for variant, (answers, sets) in product(device.variants_over(interface.name), choices(deciding)):
            bits = layout.sent_bits.value({**variant.parameters, **sets})
            size = (around + (layout.widest if moves else bits) + 7) // 8
            yield FrameSize(
                variant=variant, layout=layout, bits=bits, bytes=size, depends_on_registers=moves, answers=answers
            )


def _bits_around(interface: Interface) -> int | None:
    """Return the number of bits around a frame, or None if a peripheral receives bytes or words by itself."""
    match interface:
        case Ssi():
            return SSI_AROUND
        case Biss():
            return BISS_REST + BISS_ACKNOWLEDGE + BISS_AROUND
        case Rs485() | Spi():
            return None
        case _:
            assert_never(interface)
