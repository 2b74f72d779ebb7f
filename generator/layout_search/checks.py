"""Find the CRCs and parity bits that all frames satisfy.

A frame with its CRC is a polynomial over GF(2). The difference of two frames of one length is divisible by the
polynomial of the CRC, whatever its start value and inversion are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import log2

from ..model.known_crcs import KNOWN_CRCS
from .frames import MOST_FRAMES, RecordedFrames

#: Fewest bits that must match before a CRC is considered.
_LEAST_EVIDENCE = 4
#: Narrowest and widest CRC whose polynomial is not in the list.
_NARROWEST_CRC, _WIDEST_CRC = 3, 32
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


def crcs_of(recording: RecordedFrames) -> list[FoundCrc]:
    """Return the CRCs that all frames satisfy: all known ones with enough evidence, or else one of another polynomial.

    The list is empty if there are none.
    """
    polynomials = dict.fromkeys(known.polynomial for known in KNOWN_CRCS)
    if recording.interface == "rs485":
        # Only a CRC of 8 bits fills the last byte. Its polynomial has 9 bits with the top bit.
        polynomials = {polynomial: None for polynomial in polynomials if polynomial.bit_length() == 9}
    dividing_polynomials = [polynomial for polynomial in polynomials if _divides_all(recording, polynomial)]
    known_crcs = [_crc_with_polynomial(recording, polynomial) for polynomial in dividing_polynomials]
    proved_crcs = [crc for crc in known_crcs if crc.evidence >= _LEAST_EVIDENCE]
    return proved_crcs or list(_unlisted_crcs(recording))


def _divides_all(recording: RecordedFrames, polynomial: int) -> bool:
    """Return True if the polynomial divides the differences of all frames, and its CRC leaves bits in front."""
    # A polynomial has one bit more than its CRC.
    leaves_bits = polynomial.bit_length() <= recording.bits
    # The remainder of a difference is 0 if the polynomial divides it.
    return leaves_bits and not any(remainder(difference, polynomial) for difference in recording.differences)


def _crc_with_polynomial(recording: RecordedFrames, polynomial: int) -> FoundCrc:
    """Return the CRC with the two forms in which it matches the frames: plain and inverted, the most usual first.

    Each form has the start value that the first frame needs.
    """
    width = polynomial.bit_length() - 1
    message_bits = recording.bits - width
    all_ones = (1 << width) - 1
    # A CRC with start value 0 that is not inverted would leave the remainder 0.
    frame_remainder = remainder(recording.frames[0], polynomial)
    plain = CrcForm(_start_value(frame_remainder, message_bits, polynomial), is_inverted=False)
    inverted = CrcForm(_start_value(frame_remainder ^ all_ones, message_bits, polynomial), is_inverted=True)
    usual_starts = {known.init for known in KNOWN_CRCS if known.polynomial == polynomial} | {0}

    def form_cost(form: CrcForm) -> float:
        return _form_cost(form, usual_starts, width, recording.interface)

    forms = sorted((inverted, plain), key=form_cost)
    evidence = width * recording.independent
    # A CRC saves the description of its bits in each frame, except for those that the frames do not prove. A known
    # polynomial costs as many bits as its number in the list.
    sample_count = min(len(recording.frames), MOST_FRAMES)
    unproved_bits = max(width * sample_count - evidence, 0)
    cost = unproved_bits - width + form_cost(forms[0]) + log2(len(KNOWN_CRCS))
    return FoundCrc(polynomial, forms=tuple(forms), cost=cost, evidence=evidence)


def _form_cost(form: CrcForm, usual_starts: set[int], width: int, interface: str) -> float:
    """Return how unusual a form is, in bits. CRCs are usually inverted over BiSS, and plain over other interfaces."""
    all_ones = (1 << width) - 1
    is_usual_inversion = form.is_inverted == (interface == "biss")
    inversion_cost = 1 if is_usual_inversion else 2
    if form.start in usual_starts:
        start_cost = 0
    elif form.start in (0, all_ones):
        start_cost = 2
    else:
        start_cost = width + 2  # The bits of the value, and 2 for being none of the above.
    return inversion_cost + start_cost


def _start_value(constant: int, message_bits: int, polynomial: int) -> int:
    """Return the start value whose CRC of ``message_bits`` zeros is ``constant``: ``constant`` divided by x^n.

    n is ``message_bits``. Each step divides by x, after the polynomial has made the number divisible.
    """
    start = constant
    for _ in range(message_bits):
        if start & 1:
            start ^= polynomial
        start >>= 1
    return start


def _unlisted_crcs(recording: RecordedFrames) -> Iterator[FoundCrc]:
    """Yield the CRC whose polynomial is the greatest common divisor of all differences, if the frames prove it.

    Nothing is yielded over RS-485, or if the CRC has fewer than 3 or more than 32 bits.
    """
    polynomial = 0  # The divisor of 0 and any number is that number.
    for difference in recording.differences:
        polynomial = _common_divisor(polynomial, difference)
    # The polynomial of a CRC ends with + 1, so factors x are not part of it.
    while polynomial and not polynomial & 1:
        polynomial >>= 1
    width = polynomial.bit_length() - 1
    widest = min(_WIDEST_CRC, recording.bits - 1)
    if recording.interface == "rs485" or not _NARROWEST_CRC <= width <= widest:
        return
    crc = _crc_with_polynomial(recording, polynomial)
    # The frames decide the polynomial first, and prove it only with the rest.
    deciding_value = width * width
    evidence = crc.evidence - deciding_value
    if evidence >= _UNLISTED_EVIDENCE:
        yield FoundCrc(polynomial, forms=crc.forms, cost=crc.cost + deciding_value, evidence=evidence, is_known=False)


def remainder(dividend: int, polynomial: int) -> int:
    """Return the remainder of a division of polynomials over GF(2)."""
    excess_bits = dividend.bit_length() - polynomial.bit_length()
    while excess_bits >= 0:
        dividend ^= polynomial << excess_bits
        excess_bits = dividend.bit_length() - polynomial.bit_length()
    return dividend


def _common_divisor(dividend: int, divisor: int) -> int:
    """Return the greatest common divisor of two polynomials over GF(2), by Euclid's algorithm."""
    while divisor:
        dividend, divisor = divisor, remainder(dividend, divisor)
    return dividend


@dataclass(frozen=True, slots=True)
class FoundParity:
    """A parity bit over all bits of the body, which has ``body_bits`` bits. ``place`` counts from the first bit."""

    place: int
    is_odd: bool


def parities_of(recording: RecordedFrames, body_bits: int) -> list[FoundParity]:
    """Return the parity bits that all frames satisfy: the first bit, or the last bit before the CRC, if it changes."""
    crc_bits = recording.bits - body_bits
    parities = {(frame >> crc_bits).bit_count() % 2 for frame in recording.frames}
    if len(parities) > 1 or recording.interface == "rs485":
        return []
    is_odd = parities == {1}
    changing_places = [place for place in (0, body_bits - 1) if recording.changing[place]]
    return [FoundParity(place, is_odd) for place in changing_places]
