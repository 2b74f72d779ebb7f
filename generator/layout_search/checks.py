"""Find the CRCs and parity bits that all frames satisfy.

A frame with its CRC is a polynomial over GF(2). The difference of two frames of one length is divisible by the
polynomial of the CRC, whatever its start value and inversion are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import log2

from ..model.known_crcs import KNOWN_CRCS
from .frames import MOST_FRAMES, Recording

#: Fewest bits that must match before a CRC is considered.
_LEAST_EVIDENCE = 4
#: Narrowest and widest CRC whose polynomial is not in the list.
_NARROWEST, _WIDEST = 3, 32
#: Evidence for a polynomial that is not in the list, in bits.
_UNLISTED_EVIDENCE = 24


@dataclass(frozen=True, slots=True)
class CrcForm:
    """Start value and inversion of a CRC."""

    start: int
    is_inverted: bool


@dataclass(frozen=True, slots=True)
class FoundCrc:
    """A CRC in the last bits of all frames. ``forms`` are equal for frames of this length, the most usual first.

    ``cost`` is its share of the description length in bits, and ``evidence`` the number of bits that matched.
    """

    polynomial: int
    forms: tuple[CrcForm, ...]
    cost: float
    evidence: int
    is_known: bool = True

    @property
    def width(self) -> int:
        return self.polynomial.bit_length() - 1


def crcs_of(recording: Recording) -> list[FoundCrc]:
    """Return the CRCs that all frames satisfy: those of the known ones, or else any other polynomial."""
    polynomials = dict.fromkeys(known.polynomial for known in KNOWN_CRCS)
    if recording.interface == "rs485":
        polynomials = {polynomial: None for polynomial in polynomials if polynomial.bit_length() == 9}
    found = [_crc(recording, polynomial) for polynomial in polynomials if _divides_all(recording, polynomial)]
    fitting = [crc for crc in found if crc.evidence >= _LEAST_EVIDENCE]
    return fitting or list(_unlisted_crcs(recording))


def _divides_all(recording: Recording, polynomial: int) -> bool:
    """Return True if the differences of all frames are divisible by the polynomial, which leaves bits in front."""
    has_room = polynomial.bit_length() <= recording.bits
    return has_room and not any(remainder(difference, polynomial) for difference in recording.differences)


def _crc(recording: Recording, polynomial: int) -> FoundCrc:
    width = polynomial.bit_length() - 1
    message_bits = recording.bits - width
    ones = (1 << width) - 1
    constant = remainder(recording.frames[0], polynomial)
    plain = CrcForm(_start_value(constant, message_bits, polynomial), is_inverted=False)
    inverted = CrcForm(_start_value(constant ^ ones, message_bits, polynomial), is_inverted=True)
    usual_starts = {known.init for known in KNOWN_CRCS if known.polynomial == polynomial} | {0}
    forms = sorted((inverted, plain), key=lambda form: _form_cost(form, usual_starts, width, recording.interface))
    evidence = width * recording.independent
    # The bits that the frames do not prove cost as much as bits without a CRC.
    sample_count = min(len(recording.frames), MOST_FRAMES)
    unproved_bits = max(width * sample_count - evidence, 0)
    form_cost = _form_cost(forms[0], usual_starts, width, recording.interface)
    return FoundCrc(polynomial, tuple(forms), unproved_bits - width + form_cost + log2(len(KNOWN_CRCS)), evidence)


def _form_cost(form: CrcForm, usual_starts: set[int], width: int, interface: str) -> float:
    """Return how unusual a form is, in bits."""
    is_usual_inversion = form.is_inverted == (interface == "biss")
    inversion_cost = 1 if is_usual_inversion else 2
    if form.start in usual_starts:
        return inversion_cost
    return inversion_cost + (2 if form.start in (0, (1 << width) - 1) else width + 2)


def _start_value(constant: int, message_bits: int, polynomial: int) -> int:
    """Return the start value whose CRC of ``message_bits`` zeros is the constant: the constant divided by x^n."""
    start = constant
    for _ in range(message_bits):
        start = (start ^ polynomial) >> 1 if start & 1 else start >> 1
    return start


def _unlisted_crcs(recording: Recording) -> Iterator[FoundCrc]:
    """Yield the CRC whose polynomial is the greatest common divisor of all differences."""
    divisor = 0
    for difference in recording.differences:
        divisor = _common_divisor(divisor, difference)
    while divisor and not divisor & 1:
        divisor >>= 1
    width = divisor.bit_length() - 1
    if not _NARROWEST <= width <= min(_WIDEST, recording.bits - 1) or recording.interface == "rs485":
        return
    crc = _crc(recording, divisor)
    # The frames decide the polynomial first, and prove it only with the rest.
    evidence = crc.evidence - width * width
    if evidence >= _UNLISTED_EVIDENCE:
        yield FoundCrc(divisor, crc.forms, crc.cost + width * width, evidence, is_known=False)


def remainder(number: int, polynomial: int) -> int:
    """Return the remainder of a division of polynomials over GF(2)."""
    while number.bit_length() >= polynomial.bit_length():
        number ^= polynomial << (number.bit_length() - polynomial.bit_length())
    return number


def _common_divisor(one: int, other: int) -> int:
    while other:
        one, other = other, remainder(one, other)
    return one


@dataclass(frozen=True, slots=True)
class FoundParity:
    """A parity bit over all bits of the body, which has ``body_bits`` bits. ``place`` counts from the first bit."""

    place: int
    is_odd: bool


def parities_of(recording: Recording, body_bits: int) -> list[FoundParity]:
    """Return the parity bits that all frames satisfy, in the first or the last bit before the CRC."""
    bodies = [frame >> (recording.bits - body_bits) for frame in recording.frames]
    parities = {body.bit_count() % 2 for body in bodies}
    if len(parities) > 1 or recording.interface == "rs485":
        return []
    places = [place for place in (0, body_bits - 1) if recording.changing[place]]
    return [FoundParity(place, bodies[0].bit_count() % 2 == 1) for place in places]
