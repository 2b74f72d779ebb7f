"""Find the CRCs and parity bits that are correct in all frames.

A frame with its CRC is a polynomial over GF(2). The difference of two frames of one length is divisible by the
polynomial of the CRC, whatever its start value and inversion are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import log2

from ..model import Crc
from ..model.fields import KNOWN_CRCS
from ..reference.bits_and_values import compute_bytes
from .frames import MOST_COMPARED_FRAMES, RecordedFrames

#: Fewest bits that must match before a CRC is considered.
_LEAST_EVIDENCE = 4
#: Smallest and largest width of a CRC whose polynomial is not in the list of known ones.
_NARROWEST_CRC, _WIDEST_CRC = 3, 32
#: The CRC of MODBUS RTU, whose low byte is sent first.
_MODBUS = Crc(name="modbus", width=16, poly=0x8005, init=0xFFFF, refin=True, refout=True, xorout=0, source=())
#: Fewest bits of evidence for a polynomial that is not in the list.
_UNLISTED_EVIDENCE = 24


@dataclass(frozen=True, slots=True)
class StartAndInversion:
    """Start value and inversion of a CRC."""

    start: int
    is_inverted: bool


@dataclass(frozen=True, slots=True)
class FoundCrc:
    """A CRC in the last bits of all frames.

    ``parameter_choices`` are the start values and inversions with which it matches, the most usual first. Frames of one
    length cannot distinguish them. They are empty for CRC-16/MODBUS (``is_modbus``), because a line cannot describe it.
    ``cost`` is the number of bits that describe the CRC in all frames. ``evidence`` is the number of CRC bits that
    match and could have differed.
    """

    polynomial: int
    parameter_choices: tuple[StartAndInversion, ...]
    cost: float
    evidence: int
    is_known: bool = True
    is_modbus: bool = False

    @property
    def width(self) -> int:
        """Number of bits of the CRC."""
        return self.polynomial.bit_length() - 1


def find_crcs(recording: RecordedFrames) -> list[FoundCrc]:
    """Return the CRCs that are correct in all frames.

    These are the known CRCs for which there is enough evidence. If there are none, it is a CRC with an unknown
    polynomial. The list is empty if no CRC matches.
    """
    polynomials = dict.fromkeys(known.polynomial for known in KNOWN_CRCS)
    if recording.interface == "rs485":
        # Only 8-bit CRCs fill the last byte. Including the top bit, their polynomials have 9 bits.
        polynomials = {polynomial: None for polynomial in polynomials if polynomial.bit_length() == 9}
    dividing_polynomials = [polynomial for polynomial in polynomials if _divides_all(recording, polynomial)]
    known_crcs = [_crc_with_polynomial(recording, polynomial) for polynomial in dividing_polynomials]
    known_crcs += _modbus_crc(recording)
    proved_crcs = [crc for crc in known_crcs if crc.evidence >= _LEAST_EVIDENCE]
    return proved_crcs or list(_unlisted_crcs(recording))


def _modbus_crc(recording: RecordedFrames) -> Iterator[FoundCrc]:
    """Yield CRC-16/MODBUS if it is correct in all frames over RS-485: the last two bytes are its low and high byte."""
    byte_count = recording.bits // 8
    if recording.interface != "rs485" or byte_count < 3:
        return
    for frame in recording.frames:
        frame_bytes = frame.to_bytes(byte_count, "big")
        received_crc = int.from_bytes(frame_bytes[-2:], "little")
        if compute_bytes(_MODBUS, frame_bytes[:-2]) != received_crc:
            return
    evidence = _MODBUS.width * recording.independent_difference_count
    sample_count = min(len(recording.frames), MOST_COMPARED_FRAMES)
    unproved_bits = max(_MODBUS.width * sample_count - evidence, 0)
    cost = unproved_bits - _MODBUS.width + log2(len(KNOWN_CRCS))
    yield FoundCrc(_MODBUS.poly_with_top_bit, parameter_choices=(), cost=cost, evidence=evidence, is_modbus=True)


def _divides_all(recording: RecordedFrames, polynomial: int) -> bool:
    """Return whether all frames can end with a CRC with this polynomial.

    The polynomial must divide the differences of all frames, and the CRC must be shorter than the frame.
    """
    crc_bits = polynomial.bit_length() - 1
    if crc_bits >= recording.bits:
        return False
    return all(remainder(difference, polynomial) == 0 for difference in recording.differences)


def _crc_with_polynomial(recording: RecordedFrames, polynomial: int) -> FoundCrc:
    """Return the CRC with this polynomial both inverted and not inverted, because both match the frames.

    Each of them has the start value that it needs to match. The more usual one is the first.
    """
    width = polynomial.bit_length() - 1
    message_bits = recording.bits - width
    all_ones = (1 << width) - 1
    # The remainder is 0 for a CRC with the start value 0 that is not inverted.
    frame_remainder = remainder(recording.frames[0], polynomial)
    plain = StartAndInversion(_start_value(frame_remainder, message_bits, polynomial), is_inverted=False)
    inverted = StartAndInversion(_start_value(frame_remainder ^ all_ones, message_bits, polynomial), is_inverted=True)
    usual_starts = {known.init for known in KNOWN_CRCS if known.polynomial == polynomial} | {0}

    def parameter_cost(parameters: StartAndInversion) -> float:
        return _cost_of_parameters(parameters, usual_starts, width, recording.interface)

    cheapest_first = sorted((inverted, plain), key=parameter_cost)
    evidence = width * recording.independent_difference_count
    # CRC bits need no description if the frames prove them. Choosing a polynomial from the list costs log2 of its
    # length.
    sample_count = min(len(recording.frames), MOST_COMPARED_FRAMES)
    unproved_bits = max(width * sample_count - evidence, 0)
    cost = unproved_bits - width + parameter_cost(cheapest_first[0]) + log2(len(KNOWN_CRCS))
    return FoundCrc(polynomial, parameter_choices=tuple(cheapest_first), cost=cost, evidence=evidence)


def _cost_of_parameters(parameters: StartAndInversion, usual_starts: set[int], width: int, interface: str) -> float:
    """Return the number of bits that describe the start value and inversion of a CRC: more for unusual ones.

    CRCs are usually inverted over BiSS, and not inverted over other interfaces.
    """
    all_ones = (1 << width) - 1
    is_usual_inversion = parameters.is_inverted == (interface == "biss")
    inversion_cost = 1 if is_usual_inversion else 2
    if parameters.start in usual_starts:
        start_cost = 0
    elif parameters.start in (0, all_ones):
        start_cost = 2
    else:
        start_cost = width + 2  # The bits of the value, and 2 for being none of the usual ones.
    return inversion_cost + start_cost


def _start_value(crc_of_zeros: int, message_bits: int, polynomial: int) -> int:
    """Return the start value with which the CRC of ``message_bits`` zeros is ``crc_of_zeros``.

    This undoes the steps of the CRC. Each step divides by x, after adding the polynomial if the number is odd.
    """
    start = crc_of_zeros
    for _ in range(message_bits):
        is_odd = start & 1
        if is_odd:
            start ^= polynomial
        start >>= 1
    return start


def _unlisted_crcs(recording: RecordedFrames) -> Iterator[FoundCrc]:
    """Yield a CRC with an unknown polynomial, if the frames prove that there is one.

    Its polynomial is the greatest common divisor of the differences of all frames. Nothing is yielded over RS-485, or
    if the CRC has fewer than 3 or more than 32 bits.
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
    # Determining the polynomial uses up as many bits as ``width`` frames have in their CRCs.
    deciding_bits = width * width
    evidence = crc.evidence - deciding_bits
    if evidence >= _UNLISTED_EVIDENCE:
        yield FoundCrc(
            polynomial,
            parameter_choices=crc.parameter_choices,
            cost=crc.cost + deciding_bits,
            evidence=evidence,
            is_known=False,
        )


def remainder(dividend: int, polynomial: int) -> int:
    """Return the remainder of ``dividend`` divided by ``polynomial``, as polynomials over GF(2)."""
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
    """A parity bit over all bits before the CRC. ``bit_index`` is counted from 0 for the first bit sent."""

    bit_index: int
    is_odd: bool


def find_parities(recording: RecordedFrames, body_bits: int) -> list[FoundParity]:
    """Return the places at which all frames can have a parity bit: the first bit, and the last bit before the CRC.

    ``body_bits`` is the number of bits before the CRC. A bit that is the same in all frames is not a parity bit. The
    list is empty if the frames have different parities, and over RS-485.
    """
    crc_bits = recording.bits - body_bits
    parities = {(frame >> crc_bits).bit_count() % 2 for frame in recording.frames}
    if len(parities) > 1 or recording.interface == "rs485":
        return []
    is_odd = parities == {1}
    changing_bits = [bit_index for bit_index in (0, body_bits - 1) if recording.bit_changes[bit_index]]
    return [FoundParity(bit_index, is_odd) for bit_index in changing_bits]
