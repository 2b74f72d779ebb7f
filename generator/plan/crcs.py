"""CRCs: the functions of a family and their form, tables, undetected errors, and public test vectors.

The self-test of the C headers contains the vectors. Tests compare them with ``tests/vectors.json``, which has the
sources.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from enum import Enum
from functools import cache
from itertools import combinations
from math import comb
from typing import NamedTuple

from ..model import (
    Crc,
    Device,
    Layout,
    answer_combinations,
)
from ..model.kinds import CrcValue
from ..model.record import dataclass


@dataclass(frozen=True, slots=True)
class UndetectedErrors:
    """Errors that a CRC misses in a frame of ``bits`` bits. It detects every error of fewer than ``distance`` bits.

    Of ``patterns`` errors of exactly ``distance`` bits, it misses ``missed``. Errors of more than four bits are not
    counted, so ``missed`` is 0 if ``distance`` is 5.
    """

    frame_bits: int
    distance: int
    missed: int

    @property
    def patterns(self) -> int:
        return comb(self.frame_bits, self.distance)


def undetected_errors_of(crc: Crc, bits: int) -> UndetectedErrors:
    """Return how many wrong bits ``crc`` always detects in a frame of ``bits`` bits, and how many errors it misses.

    ``bits`` includes the bits of the CRC. Start value, final XOR and bit order do not matter, because they are the same
    in the sent and in the received frame.
    """
    # The remainder of an error in each single bit, lowest bit first.
    remainders = []
    bit_remainder = 1
    for _ in range(bits):
        remainders.append(bit_remainder)
        # The next bit's remainder is twice this remainder, reduced by the polynomial if it has too many bits.
        bit_remainder <<= 1
        if bit_remainder >> crc.width:
            bit_remainder ^= crc.poly_with_top_bit
    # The CRC misses an error of several bits if the XOR of their remainders is 0. This counts the pairs by their XOR.
    pair_counts = Counter(remainder ^ other_remainder for remainder, other_remainder in combinations(remainders, 2))
    missed_2_bit_errors = pair_counts[0]
    # A missed error of three bits is counted three times: once for each pair with the remainder of the third bit.
    missed_3_bit_errors = sum(pair_counts[third_remainder] for third_remainder in remainders) // 3
    # A missed error of four bits consists of two pairs with the same remainder, in three ways. If two such pairs have a
    # common bit, the CRC also misses two-bit errors, and this number is not used.
    missed_4_bit_errors = sum(comb(pair_count, 2) for pair_count in pair_counts.values()) // 3
    for distance, missed in ((2, missed_2_bit_errors), (3, missed_3_bit_errors), (4, missed_4_bit_errors)):
        if missed:
            return UndetectedErrors(frame_bits=bits, distance=distance, missed=missed)
    return UndetectedErrors(frame_bits=bits, distance=5, missed=0)


@dataclass(frozen=True, slots=True)
class FoldStep:
    """One step of a table-free CRC: ``v = (v & mask) ^ (v >> shift) ^ (v >> shift << second_shift)``.

    If ``second_shift`` is 0, the last term is absent.
    """

    shift: int
    mask: int
    second_shift: int


def reflect(value: int, width: int) -> int:
    """Return ``value`` with its ``width`` bits in reverse order."""
    binary_digits = f"{value:0{width}b}"
    return int(binary_digits[::-1], 2)


def byte_table(width: int, poly: int, reflected: bool = False) -> tuple[int, ...]:
    """Return the remainder of each byte from 0 to 255, shifted left by the width of the CRC.

    With ``reflected``, the bits of the CRC register are in reverse order, as needed for reflected input.
    """
    poly_with_top_bit = poly | (1 << width)
    remainders: list[int] = []
    for byte in range(256):
        if reflected:
            remainder_of_byte = remainder(reflect(byte, 8) << width, poly_with_top_bit)
            remainders.append(reflect(remainder_of_byte, width))
        else:
            remainders.append(remainder(byte << width, poly_with_top_bit))
    return tuple(remainders)


def word_table(width: int, poly: int) -> tuple[int, ...]:
    """Return the remainder of each byte above the lowest ``max(width, 8)`` bits, used to reduce a word byte by byte."""
    poly_with_top_bit = poly | (1 << width)
    bits_below = max(width, 8)
    return tuple(remainder(byte << bits_below, poly_with_top_bit) for byte in range(256))


def remainder(number: int, polynomial: int) -> int:
    """Return the remainder of long division by ``polynomial``, which includes its top bit."""
    excess_bits = number.bit_length() - polynomial.bit_length()
    while excess_bits >= 0:
        number ^= polynomial << excess_bits
        excess_bits = number.bit_length() - polynomial.bit_length()
    return number


class _ReductionPlan(NamedTuple):
    """Steps that reduce a number to its CRC. The smallest plan, compared member by member, is the cheapest.

    ``wide_step_count`` is the number of steps whose result has more than 32 bits. ``k_of_steps`` is the k of each step.
    """

    step_count: int
    wide_step_count: int
    sum_of_k: int
    k_of_steps: tuple[int, ...]


def fold_plan(width: int, poly: int, bits: int) -> tuple[FoldStep, ...]:
    """Return the fewest steps that reduce a word of ``bits`` bits to its remainder modulo x^n + x^m + 1 or x^n + 1.

    Squaring the polynomial k times gives x^(n*2^k) = x^(m*2^k) + 1, so the part of the word from bit n*2^k up can be
    added to the lower part twice, once shifted to bit 0 and once to bit m*2^k. For x^n + 1, it is added only once. The
    largest power is not always the best, since a smaller power may leave a word that needs fewer further steps. Among
    plans with the same number of steps, the function chooses the plan that reaches 32 bits soonest, and then the plan
    with the smallest powers, since a short mask is a cheaper constant.
    """
    # The m of x^m, or 0 for x^n + 1. ``poly`` contains the terms below x^n.
    terms_above_one = poly & ~1
    middle_exponent = terms_above_one.bit_length() - 1 if terms_above_one else 0

    @cache
    def cheapest_plan(bits_left: int) -> _ReductionPlan:
        """Return the cheapest plan that reduces a number of ``bits_left`` bits to the width of the CRC."""
        if bits_left <= width:
            return _ReductionPlan(step_count=0, wide_step_count=0, sum_of_k=0, k_of_steps=())
        plans: list[_ReductionPlan] = []
        for k in range((bits_left - 1).bit_length()):
            # n*2^k and m*2^k.
            shift = width << k
            second_shift = middle_exponent << k
            if shift < bits_left:
                next_bits = max(shift, bits_left - shift + second_shift)
                later_plan = cheapest_plan(next_bits)
                plan = _ReductionPlan(
                    step_count=later_plan.step_count + 1,
                    wide_step_count=later_plan.wide_step_count + int(next_bits > 32),
                    sum_of_k=later_plan.sum_of_k + k,
                    k_of_steps=(k, *later_plan.k_of_steps),
                )
                plans.append(plan)
        return min(plans)

    fold_steps_of_plan = []
    for k in cheapest_plan(bits).k_of_steps:
        shift = width << k
        fold_steps_of_plan.append(FoldStep(shift=shift, mask=(1 << shift) - 1, second_shift=middle_exponent << k))
    return tuple(fold_steps_of_plan)


#: Width in bits of the longest word, and of the widest CRC that is folded in such a word.
_LONGEST_WORD_BITS, _WIDEST_FOLD = 64, 32


class CrcMethod(Enum):
    """Method by which code computes a CRC.

    FOLD is for x^n + x^m + 1 and x^n + 1 with start value 0, most significant bit first. XOR is for x^8 + 1 over whole
    bytes, where the CRC is the XOR of the bytes. TABLE is for all other CRCs.
    """

    FOLD = "fold"
    XOR = "xor"
    TABLE = "table"


class CoveredData(Enum):
    """Kind of data that a CRC covers."""

    BITS = "bits"
    BYTES = "bytes"


@dataclass(frozen=True, slots=True)
class CrcFunction:
    """Function that computes ``crc``.

    ``is_only_function`` is true if the CRC needs no second function, over another kind of data. ``ends_words`` is true
    if the CRC ends frames that are words: received as one number rather than as bytes.
    """

    crc: Crc
    covered_data: CoveredData
    method: CrcMethod
    is_only_function: bool
    ends_words: bool

    @property
    def steps(self) -> tuple[FoldStep, ...]:
        """Steps that reduce any 64-bit word to its remainder. Empty if the CRC cannot be folded."""
        return fold_plan(self.crc.width, self.crc.poly, _LONGEST_WORD_BITS) if self.method is CrcMethod.FOLD else ()


def kinds_of_covered_data(device: Device, crc: Crc) -> tuple[CoveredData, ...]:
    """Return the kinds of data, BYTES or BITS or both, that a CRC covers in the frames and registers of a family.

    If no frame or register has this CRC, its parameters decide: reflected input is defined only for bytes, and a CRC
    with a width of whole bytes is likely to cover bytes.
    """
    layouts = [layout for _, layout in device.layouts()]
    layouts += (register.layout for register in device.registers)
    used_kinds = [covered_data_of(layout) for layout in layouts if _has_crc(layout, crc)]
    if used_kinds:
        return tuple(kind for kind in (CoveredData.BYTES, CoveredData.BITS) if kind in used_kinds)
    suggests_bytes = crc.refin or crc.width % 8 == 0
    return (CoveredData.BYTES,) if suggests_bytes else (CoveredData.BITS,)


def covered_data_of(layout: Layout) -> CoveredData:
    """Return the kind of data, BYTES or BITS, that the CRC at the end of a layout covers."""
    return CoveredData.BYTES if layout.crc_covers_bytes else CoveredData.BITS


def crc_functions(device: Device) -> Iterator[CrcFunction]:
    """Yield the CRC functions that the generated code for a family needs, in the order of its CRCs.

    A CRC that covers bytes in one frame and bits in another has two functions: first over bytes, then over bits. If
    frames with this CRC are words, which are numbers of up to 64 bits, the code may also need a table for words.
    """
    for crc in device.crcs:
        ends_words = any(not layout.in_bytes and _has_crc(layout, crc) for _, layout in device.layouts())
        kinds = kinds_of_covered_data(device, crc)
        is_only_function = len(kinds) == 1
        for covered_data in kinds:
            method = method_of(crc, covered_data)
            # Folding needs a frame in which the CRC covers all other bits.
            if covered_data is CoveredData.BITS and not checks_whole_words(device, crc):
                method = CrcMethod.TABLE
            yield CrcFunction(
                crc=crc,
                covered_data=covered_data,
                method=method,
                is_only_function=is_only_function,
                ends_words=ends_words,
            )


def function_of(device: Device, layout: Layout, crc: Crc) -> CrcFunction:
    """Return the function that computes ``crc``, a CRC of the family, at the end of a layout."""
    covered_data = covered_data_of(layout)
    for function in crc_functions(device):
        if function.covered_data is covered_data and function.crc == crc:
            return function
    raise AssertionError(f"'{crc.name}' is not a CRC of '{layout.name}'")


def can_be_folded(crc: Crc) -> bool:
    """Return whether a word with this CRC can be reduced to its remainder without a table."""
    # The polynomial is x^n + x^m + 1 or x^n + 1. ``poly`` lacks the x^n.
    has_two_or_three_terms = bool(crc.poly & 1) and crc.poly.bit_count() <= 2
    is_plain = crc.init == 0 and not crc.refin and not crc.refout
    return has_two_or_three_terms and is_plain and not crc.is_xor


def fold_steps(crc: Crc, bits: int) -> tuple[FoldStep, ...]:
    """Return the steps that reduce a frame of at most ``bits`` bits to its remainder without a table.

    The tuple is empty if the polynomial has too many terms for this method, or if the frame is longer than a word.
    """
    fits_in_word = bits <= _LONGEST_WORD_BITS
    return fold_plan(crc.width, crc.poly, bits) if can_be_folded(crc) and fits_in_word else ()


def is_checked_by_division(crc: Crc, layout: Layout) -> bool:
    """Return whether generated code checks a word by dividing it by the polynomial, after undoing the final XOR.

    The remainder of a valid word is then 0. This requires that the CRC is the plain remainder of the word, and that it
    can be folded or has 8 to 32 bits.
    """
    is_remainder_of_word = not layout.in_bytes and crc.init == 0 and not crc.refout
    return is_remainder_of_word and (can_be_folded(crc) or 8 <= crc.width <= 32)


def method_of(crc: Crc, covered_data: CoveredData) -> CrcMethod:
    """Return the method by which generated code computes a CRC over bits or bytes. A wide CRC is not folded."""
    if covered_data is CoveredData.BYTES:
        return CrcMethod.XOR if crc.is_xor else CrcMethod.TABLE
    is_narrow = crc.width <= _WIDEST_FOLD
    return CrcMethod.FOLD if can_be_folded(crc) and is_narrow else CrcMethod.TABLE


def _has_crc(layout: Layout, crc: Crc) -> bool:
    """Return whether a field of the layout contains this CRC."""
    return any(isinstance(field.kind, CrcValue) and field.kind.crc == crc.name for field in layout.fields)


def checks_whole_words(device: Device, crc: Crc) -> bool:
    """Return whether every frame with this CRC has it for all order codes, and the CRC covers all bits before it."""
    for _, layout in device.layouts():
        for field in layout.crc_fields:
            assert isinstance(field.kind, CrcValue)
            if field.kind.crc != crc.name:
                continue
            covers_named_fields_only = bool(field.kind.of)
            is_in_all_order_codes = field.width.is_constant
            if covers_named_fields_only or not is_in_all_order_codes:
                return False
    return True


_BRIDGE = "timonburkard/BiSS_Bridge: 2_hdl/tb/tb_data_checker.vhd"
_EXTRACT = "mjbots/moteus: fw/test/bissc_extract_test.cc"
_TI = "TexasInstruments/motor-control-sdk: bissc_hex_control_commands.png"


@dataclass(frozen=True, slots=True)
class PublicVector:
    """A word and its CRC. The word begins with its first 1 bit."""

    title: str
    data: int
    crc: int
    source: str


def _single_cycle(title: str, position: int, flags: int, crc: int) -> PublicVector:
    """Return the vector for a position of 22 bits and two flags, error and warning."""
    return PublicVector(title, (position << 2) | flags, crc, _BRIDGE)


_CRC_6 = (
    _single_cycle("22 bits, all zeros", 0, 3, 58),
    _single_cycle("22 bits, all ones", 4194303, 3, 47),
    _single_cycle("22 bits, pattern 1", 1193046, 3, 53),
    _single_cycle("22 bits, pattern 2", 2870767, 3, 16),
    _single_cycle("22 bits, pattern 3", 1393441, 3, 54),
    _single_cycle("22 bits, pattern 4", 4119738, 3, 24),
    _single_cycle("22 bits, captured", 192458, 3, 28),
    _single_cycle("22 bits, error active", 74565, 1, 11),
    _single_cycle("22 bits, warning active", 74565, 2, 14),
    PublicVector("16 bits", 0x1234, 7, _EXTRACT),
)
_CRC_4 = (PublicVector("data byte 40h", 0x40, 8, _TI), PublicVector("data byte 06h", 0x06, 5, _TI))

#: The first byte of a T-format request, by data ID.
CONTROL_FIELDS = {0: 0x02, 1: 0x8A, 2: 0x92, 3: 0x1A, 6: 0x32, 7: 0xBA, 8: 0xC2, 12: 0x62, 13: 0xEA, 5: 0x2A, 10: 0x52}


def public_vectors_of(crc: Crc) -> tuple[PublicVector, ...]:
    """Return the published words with their CRC if ``crc`` is one of the two BiSS CRCs: 6 or 4 bits, sent inverted.

    The tuple is empty for any other CRC.
    """
    if crc.init or crc.xorout != crc.mask or crc.refin or crc.refout:
        return ()
    vectors_by_width_and_poly = {(6, 0x03): _CRC_6, (4, 0x03): _CRC_4}
    return vectors_by_width_and_poly.get((crc.width, crc.poly), ())


def crcs_and_lengths(device: Device, interface: str, layout: Layout) -> Iterator[tuple[Crc, int]]:
    """Yield each CRC of a frame with each length in bits that the frame can have. A pair can come several times.

    The lengths are those for each order code and each answer to an open question. If all frames have the CRC, the
    longest frame that registers of the encoder can select is included.
    """
    if layout.always_has_crc:
        for crc in device.crcs_of(layout):
            yield crc, layout.widest
    for variant in device.variants_over(interface):
        for _, parameters_of_answers in answer_combinations(device.alternatives):
            placed = layout.place({**variant.parameters, **parameters_of_answers})
            placed_crc = device.crc_of(placed)
            if placed_crc is not None:
                yield placed_crc, placed.bits
