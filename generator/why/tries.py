"""One mistake tried on one frame: what the CRC would then be over, and how likely it is that it fits by coincidence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from ..model import (
    Choice,
    Constant,
    Crc,
    CrcValue,
    Decimal,
    Flag,
    Number,
    Parity,
    PlacedField,
    PlacedLayout,
    Text,
    Unused,
    assert_never,
)
from ..reference.codec import parity_bit
from ..reference.crc import compute_bits, compute_bytes

NOT_INVERTED = "crc_not_inverted"

#: How often each kind of mistake is made, beside the others, and why that is thought; it holds for every single try.
#: Nobody has counted; only the ratios matter.
MISTAKES: Mapping[str, float] = MappingProxyType(
    {
        "line_stuck": 8,  # no supply, no encoder, or a wire that is off
        NOT_INVERTED: 8,  # a switch of its own in every master, and drivers differ
        "other_order_code": 8,  # the widths are typed in by a person, and the label is worn
        "other_widths": 2,  # registers hold the widths, and somebody wrote to them once
        "first_bit_missing": 4,  # sampled one clock late, such as after an uncompensated line delay
        "bits_in_front": 4,  # where a master's data begin, at the start bit, CDS or after it, is told in few manuals
        "bits_behind": 4,  # the stop bit, read as one more bit of data
        "last_bits_missing": 4,  # one clock too few, or a frame cut to fit an integer
        "status_left_out": 4,  # nE and nW look like an appendix; a driver takes the CRC over the position
        "status_not_sent": 4,  # a master's switch for status bits takes them out of the data
        "other_answer": 8,  # tried only where the manual leaves the form of the frame open
        "status_turned": 2,  # drivers hand error and warning on as active high
        "other_code": 2,  # a master that turns Gray into binary before anybody checks the CRC
        "start_bits_in_crc": 2,  # other protocols have their start bit in the CRC
        "other_polynomial": 2,  # masters know polynomials of many lengths, and their defaults differ
        "bytes_reversed": 2,  # a buffer of bytes copied into an integer of the other byte order
        "bytes_in_front": 8,  # on two wires the sender hears its own request
        "bytes_behind": 4,  # the next frame has begun
        "first_byte_lost": 4,  # the receiver was switched on too late after the request
        "first_byte_left_out": 2,  # the control field is compared, then forgotten for the CRC
        "all_inverted": 2,  # the two wires of a differential pair have changed places
        "start_value": 1,  # other protocols start with all ones
        "polynomial_reversed": 1,  # a polynomial may be written from either end
        "bits_reversed": 1,  # a serial port that takes the least significant bit first
        "crc_reversed": 0.5,  # a CRC computed least significant bit first
    }
)

#: How much likelier a flag that tells nothing, or an unused bit as the manual has it, makes a reading than a random bit
#: does, and one that tells of a fault: faults are taken to be rare.
_IDLE, _ACTIVE = 1.8, 0.2


@dataclass(frozen=True, slots=True)
class Try:
    """One mistake, tried.

    ``data`` is what the CRC by the parameters ``crc`` would be over, ``bits`` long. ``received`` are the first
    ``known`` bits of the CRC that is held against it. ``demanded`` is how many other bits the mistake says the value
    of, and ``holds`` whether they have it. ``fixed`` is how many bits of the frame have the value that they always
    have, which tells nothing by itself but makes one reading likelier than another, as do flags that are not set
    (``usual``). ``number`` is the frame by ``placed`` as it would be without the mistake, where that is another one
    than given. ``codes`` are the order codes that would send it.
    """

    kind: str
    text: str
    crc: Crc
    data: int
    bits: int
    received: int
    known: int
    by_bytes: bool = False
    demanded: int = 0
    holds: bool = True
    fixed: int = 0
    usual: float = 1.0
    number: int = 0
    placed: PlacedLayout | None = None
    codes: tuple[str, ...] = ()

    @property
    def fits(self) -> bool:
        if not self.holds:
            return False
        computed = (
            compute_bytes(self.crc, self.data.to_bytes(self.bits // 8, "big"))
            if self.by_bytes
            else compute_bits(self.crc, self.data, self.bits)
        )
        return computed >> (self.crc.width - self.known) == self.received

    @property
    def one_in(self) -> int:
        """Of how many frames of random bits one fits."""
        return 1 << (self.known + self.demanded)

    @property
    def score(self) -> float:
        """How likely the mistake is once it fits: how often it is made, times what was improbable without it."""
        return MISTAKES[self.kind] * self.usual * 2.0 ** (self.known + max(self.demanded, self.fixed))

    @property
    def question(self) -> tuple[object, ...]:
        """What is asked of the frame.

        Two tries with the same question have the same answer. With start value 0, zeros in front make no difference.
        """
        return self.crc, self.data, self.bits if self.crc.init else 0, self.received, self.known


def fixed_bits(placed: PlacedLayout, number: int) -> tuple[int, bool]:
    """How many bits of a frame have to have a certain value, and whether they have it.

    These are constants, parity, and the field that tells the layout.
    """
    bits, holds = 0, True
    for item in placed.fields:
        raw, expected = number >> item.low & item.mask, _fixed_value(placed, item, number)
        if expected is not None:
            bits, holds = bits + item.width, holds and raw == expected
        elif item.name == placed.layout.selector:
            bits += item.width - (len(placed.layout.selects) - 1).bit_length()
            holds = holds and raw in placed.layout.selects
    return bits, holds


def _fixed_value(placed: PlacedLayout, item: PlacedField, number: int) -> int | None:
    """What a constant or parity has to be in ``number``; None for other fields."""
    match item.field.kind:
        case Constant(value):
            return value
        case Parity() as parity:
            return parity_bit(placed, parity, number)
        case Number() | Flag() | Choice() | Unused() | CrcValue() | Decimal() | Text():
            return None
        case _ as kind:
            assert_never(kind)


def usual(placed: PlacedLayout, number: int) -> float:
    """How much likelier than a random frame its flags and unused bits make it."""
    made = 1.0
    for item in placed.fields:
        raw = number >> item.low & item.mask
        match item.field.kind:
            case Flag(active_low=low):
                made *= _ACTIVE if bool(raw) != low else _IDLE
            case Unused(value):
                made *= _IDLE**item.width if raw == value & item.mask else _ACTIVE
    return made
