"""CRCs against the published check values (over the ASCII digits 1 to 9) and against long division."""

from __future__ import annotations

import random
from dataclasses import replace
from itertools import product

import pytest
from codewheel.model import Crc
from codewheel.plan.crcs import CoveredData, CrcMethod, can_be_folded, fold_plan, method_of
from codewheel.reference.bits_and_values import bits_in_crc_order, compute_bits, compute_bytes, init_for_result


def crc(width: int, poly: int, init: int = 0, refin: bool = False, refout: bool = False, xorout: int = 0) -> Crc:
    return Crc(
        name="crc",
        width=width,
        poly=poly,
        init=init,
        refin=refin,
        refout=refout,
        xorout=xorout,
        source=(),
    )


# Greg Cook, Catalogue of parametrised CRC algorithms, reveng.sourceforge.io/crc-catalogue: check values.
CATALOGUE = [
    (crc(5, 0x05, 0x1F, True, True, 0x1F), 0x19, "CRC-5/USB"),
    (crc(6, 0x03, 0, True, True, 0), 0x06, "CRC-6/G-704"),
    (crc(8, 0x07), 0xF4, "CRC-8/SMBUS"),
    (crc(8, 0x2F, 0xFF, False, False, 0xFF), 0xDF, "CRC-8/AUTOSAR"),
    (crc(16, 0x1021), 0x31C3, "CRC-16/XMODEM"),
    (crc(16, 0x1021, 0xFFFF), 0x29B1, "CRC-16/IBM-3740"),
    (crc(16, 0x8005, 0xFFFF, True, True), 0x4B37, "CRC-16/MODBUS"),
    (crc(32, 0x04C11DB7, 0xFFFFFFFF, True, True, 0xFFFFFFFF), 0xCBF43926, "CRC-32/ISO-HDLC"),
]


@pytest.mark.parametrize(("parameters", "check", "name"), CATALOGUE, ids=[row[2] for row in CATALOGUE])
def test_catalogue(parameters: Crc, check: int, name: str) -> None:
    assert compute_bytes(parameters, b"123456789") == check


@pytest.mark.parametrize(("parameters", "check", "name"), CATALOGUE, ids=[row[2] for row in CATALOGUE])
def test_the_start_value_follows_from_the_check_value(parameters: Crc, check: int, name: str) -> None:
    number, bits = bits_in_crc_order(parameters, b"123456789")
    assert init_for_result(replace(parameters, init=0), number, bits, check) == parameters.init


def test_xor_form_is_the_xor_of_the_bytes() -> None:
    xor = crc(8, 0x01, refin=True, refout=True)
    assert xor.is_xor
    # Lika AMM5 manual 7.6, SMA21 manual 7.3.4.
    assert compute_bytes(xor, bytes.fromhex("32100128B008")) == 0xB3
    assert compute_bytes(xor, bytes.fromhex("A20010325400")) == 0xD4
    assert compute_bytes(xor, bytes.fromhex("2A02DA0400432500")) == 0x90


@pytest.mark.parametrize(
    ("width", "poly"),
    [(6, 0x03), (4, 0x03), (3, 0x03), (5, 0x05), (7, 0x09), (9, 0x11), (8, 0x01), (1, 0x01), (16, 0x0001)],
)
@pytest.mark.parametrize("bits", [1, 7, 16, 46, 47, 63, 64])
def test_fold_plan_is_long_division(width: int, poly: int, bits: int) -> None:
    assert can_be_folded(crc(width, poly)) or crc(width, poly).is_xor
    plan = fold_plan(width, poly, bits)
    chooser = random.Random(bits * 1000 + width)
    for number in [0, 1, (1 << bits) - 1, 1 << (bits - 1), *(chooser.getrandbits(bits) for _ in range(200))]:
        remainder = number
        for bit in range(bits - 1, width - 1, -1):
            if remainder >> bit & 1:
                remainder ^= (poly | 1 << width) << (bit - width)
        value = number
        for step in plan:
            high = value >> step.shift
            value = value & step.mask ^ high ^ (high << step.second_shift if step.second_shift else 0)
        assert value == remainder


def test_the_plan_for_46_bits_has_four_steps() -> None:
    """Halving with care: 46 bits become 22 + 4 = 26, then 14 + 2 = 16, then 10 + 1 = 11, then 5 + 1 = 6.

    Always using the largest power would fold 26 bits at 24 again, which leaves 24 of them, and take six steps in all.
    """
    assert [(step.shift, step.second_shift) for step in fold_plan(6, 0x03, 46)] == [(24, 4), (12, 2), (6, 1), (6, 1)]


@pytest.mark.parametrize(("width", "poly"), [(6, 0x03), (4, 0x03), (5, 0x05), (8, 0x01), (9, 0x11)])
def test_no_plan_is_shorter(width: int, poly: int) -> None:
    """Compare with every list of steps, shortest lists first, by the remaining widths only."""
    middle = (poly & ~1).bit_length() - 1 if poly & ~1 else 0
    for bits in range(1, 65):
        widths, steps = {bits}, 0
        while min(widths) > width:
            shifts = [width << power for power in range(7)]
            folded_widths = set()
            for remaining_width, shift in product(widths, shifts):
                if shift < remaining_width:
                    folded_widths.add(max(shift, remaining_width - shift + middle * shift // width))
            widths = folded_widths
            steps += 1
        assert len(fold_plan(width, poly, bits)) == steps, bits


def test_form_follows_from_the_parameters() -> None:
    assert method_of(crc(6, 0x03), CoveredData.BITS) is CrcMethod.FOLD
    assert method_of(crc(6, 0x03, 1), CoveredData.BITS) is CrcMethod.TABLE
    assert method_of(crc(16, 0x90D9), CoveredData.BITS) is CrcMethod.TABLE
    assert method_of(crc(8, 0x01, 0, True, True), CoveredData.BYTES) is CrcMethod.XOR
    assert method_of(crc(8, 0x01, 0, True, False), CoveredData.BYTES) is CrcMethod.TABLE


def test_leading_zeros_do_not_change_a_crc_with_start_0() -> None:
    biss = crc(6, 0x03, xorout=0x3F)
    assert compute_bits(biss, 0x1234, 16) == compute_bits(biss, 0x1234, 40) == 7


def test_polynomial_text() -> None:
    assert crc(6, 0x03).polynomial == "x^6 + x + 1"
    assert crc(8, 0x01).polynomial == "x^8 + 1"
