"""Frames of the MA600, the iC-MR and the C58, against the library of a manufacturer and tables of manuals.

MA600: monolithicpower/MagAlpha-Arduino-Library at commit 53f20df, src/MagAlphaGen6.cpp. ``readAngleRaw`` counts the
ones of the angle and compares their number with the bit of the 17th clock, ``readTurn`` takes the second half of 32
bits in two's complement, and ``readRegister`` takes the low byte.

iC-MR: tables 52 to 57 of the data sheet, revision A1. C58: pages 100 to 103 of the manual of TR-Electronic. No
implementation is public, so the decoders are written from these pages, with arithmetic on whole numbers. Of the frames,
one in three has up to three bits changed.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library
from python_path import new_packages

pytestmark = pytest.mark.slow

SPECS = Path(__file__).resolve().parents[2] / "specs"
FRAMES = 100_000
Importer = Callable[[Library, str], tuple[Path, ModuleType]]


@pytest.fixture(autouse=True)
def _own_packages() -> Iterator[None]:
    """Other tests have packages of the same manufacturers, with other encoders."""
    with new_packages():
        yield


def package_of(import_generated: Importer, manufacturer: str, family: str) -> Any:
    devices, report = load_library(
        [SPECS / manufacturer / f"{family}.yaml", SPECS / manufacturer / "manufacturer.yaml"]
    )
    assert not report
    _, module = import_generated(Library(tuple(devices)), f"{manufacturer}_encoders")
    return module


def test_words_of_the_ma600(import_generated: Importer) -> None:
    package = package_of(import_generated, "mps", "ma600")
    from mps_encoders import ma600  # type: ignore[import-not-found]

    encoder = package.lookup("MA600")
    for angle in range(0, 1 << 16, 37):
        assert encoder.decode(angle, bits=16).position == angle
        for parity in (0, 1):
            word = angle << 1 | parity
            if angle.bit_count() % 2 == parity:
                assert ma600.PositionWithParity.decode(word, bits=17).position == angle
            else:
                with pytest.raises(package.ConstantError):
                    ma600.PositionWithParity.decode(word, bits=17)
        turns = (angle * 40_503) % (1 << 16)
        frame = ma600.PositionWithTurns.decode(angle << 16 | turns, bits=32)
        assert (frame.position, frame.turns) == (angle, turns - (1 << 16) if turns & 0x8000 else turns)
        assert ma600.RegisterReply.decode(angle, bits=16).data == angle & 0xFF


def test_requests_of_the_ma600(import_generated: Importer) -> None:
    """The library sends 0b11010010 and the address to read, and 0b1110101001010100 before address and value."""
    package_of(import_generated, "mps", "ma600")
    from mps_encoders import ma600

    assert int(ma600.ReadRequest(address=28).encode()) == 0b11010010 << 8 | 28
    assert int(ma600.WriteRequest().encode()) == 0b1110101001010100
    assert int(ma600.WriteData(address=28, data=0x80).encode()) == 28 << 8 | 0x80


def test_the_register_of_the_ma600_that_selects_turns_or_speed(import_generated: Importer) -> None:
    """The library writes 80h for the speed and 00h for the turns. It names functions of the other bits."""
    package_of(import_generated, "mps", "ma600")
    from mps_encoders import ma600

    assert ma600.Output(content=ma600.Content.SPEED).encode() == b"\x80"
    assert ma600.Output(content=ma600.Content.TURNS).encode() == b"\x00"
    for number in range(256):
        content = ma600.Output.decode(bytes([number])).content
        assert content is (ma600.Content.SPEED if number & 0x80 else ma600.Content.TURNS)


class Configuration(NamedTuple):
    """A configuration of the iC-MR, by its made-up order code."""

    turn_bits: int
    life_bits: int
    crc_bits: int
    has_temperature: bool

    @property
    def data_bits(self) -> int:
        """Return the number of bits of the position channel before its CRC."""
        return self.turn_bits + 24 + 2 + self.life_bits


def configuration_of(order_code: str) -> Configuration:
    turn_bits, options = order_code.removeprefix("iC-MR-").split("-")
    crc_bits = int(options[1:-1])
    return Configuration(int(turn_bits), 6 if options[0] == "L" else 0, crc_bits, options.endswith("T"))


#: 24 bits of revolutions with the extended CRC are left out, because they need more than 64 bits.
FORMATS = ("0-N6", "0-N16", "0-L6", "0-L16", "12-N6", "12-N16", "12-L6", "12-L16", "24-N6", "24-L6")
ORDER_CODES = [f"iC-MR-{form}{temperature}" for form in FORMATS for temperature in "ST"]
#: Polynomials as table 52 prints them, with their highest bit.
POLYNOMIALS = {5: 0x25, 6: 0x43, 16: 0x190D9}


def remainder(number: int, bits: int, crc_bits: int) -> int:
    """Return the CRC of the lowest bits of a number: the remainder of a division in binary, inverted."""
    number <<= crc_bits
    for place in reversed(range(bits)):
        if number >> (place + crc_bits) & 1:
            number ^= POLYNOMIALS[crc_bits] << place
    return number ^ ((1 << crc_bits) - 1)


class Expected(NamedTuple):
    position: int
    life: int
    verdict: str


def expected_position(configuration: Configuration, frame: int) -> Expected | None:
    """Return position, life counter and verdict of a position channel, or None if its CRC is wrong."""
    data, crc = frame >> configuration.crc_bits, frame % (1 << configuration.crc_bits)
    if remainder(data, configuration.data_bits, configuration.crc_bits) != crc:
        return None
    life = data % (1 << configuration.life_bits)
    flags = data >> configuration.life_bits & 3
    # Both are inverted: 0 is an error or a warning.
    verdict = "not_usable" if flags < 2 else "usable_with_warning" if flags == 2 else "usable"
    return Expected(data >> (configuration.life_bits + 2), life, verdict)


def frames_of(order_code: str, count: int) -> Iterator[int]:
    """Yield frames, every third one with one to three bits changed."""
    generator = random.Random(order_code)
    configuration = configuration_of(order_code)
    bits = configuration.data_bits + configuration.crc_bits + (21 if configuration.has_temperature else 0)
    for number in range(count):
        data = generator.getrandbits(configuration.data_bits)
        frame = data << configuration.crc_bits | remainder(data, configuration.data_bits, configuration.crc_bits)
        if configuration.has_temperature:
            temperature = generator.getrandbits(16)
            frame = frame << 21 | temperature << 5 | remainder(temperature, 16, 5)
        if number % 3 == 0:
            for place in generator.sample(range(bits), generator.randint(1, 3)):
                frame ^= 1 << place
        yield frame


def test_frames_of_the_icmr(import_generated: Importer) -> None:
    package = package_of(import_generated, "ichaus", "icmr")
    from ichaus_encoders import icmr  # type: ignore[import-not-found]

    rejected = 0
    for order_code in ORDER_CODES:
        configuration = configuration_of(order_code)
        encoder = package.lookup(order_code)
        for frame in frames_of(order_code, FRAMES // len(ORDER_CODES)):
            position_frame = frame >> 21 if configuration.has_temperature else frame
            expected = expected_position(configuration, position_frame)
            temperature_data, temperature_crc = frame >> 5 & 0xFFFF, frame & 0x1F
            is_temperature_valid = remainder(temperature_data, 16, 5) == temperature_crc
            if not configuration.has_temperature:
                decoder, is_valid = encoder.decode, expected is not None
            else:
                decoder, is_valid = encoder.channels().decode, expected is not None and is_temperature_valid
            if not is_valid:
                rejected += 1
                with pytest.raises(package.CrcError):
                    decoder(frame)
                continue
            assert expected is not None
            decoded = decoder(frame)
            assert decoded.verdict.value == expected.verdict
            pos = decoded.of(icmr.Pos) if configuration.has_temperature else decoded
            assert (pos.position, pos.life) == (expected.position, expected.life)
            if configuration.has_temperature:
                assert decoded.of(icmr.Tmp).temperature == temperature_data
    # A CRC detects up to two changed bits of these frames, and nearly all cases of three.
    assert 0.3 * FRAMES < rejected < 0.34 * FRAMES


def expected_c58(order_code: str, word: int) -> int | None:
    """Return the position of a word of the C58, or None if its parity or its zeros are wrong."""
    _, data, special = order_code.split("-")
    data_bits, code = int(data[:-1]), data[-1]
    if special.startswith("C"):
        # 28 data bits, filled up with zeros, and 15 bits of the check sum.
        number, zeros = divmod(word >> 15, 1 << (28 - data_bits))
        return None if zeros else number
    if special[-1] in "EO" and word.bit_count() % 2 != (special[-1] == "O"):
        return None
    number = word >> len(special.replace("N", ""))
    if code == "G":
        for shift in (16, 8, 4, 2, 1):
            number ^= number >> shift
    return number


def test_words_of_the_c58(import_generated: Importer) -> None:
    package = package_of(import_generated, "trelectronic", "c58")
    options = {"B": ("N", "E", "O", "T", "TE", "TO", "C{bits}"), "G": ("N", "E", "O", "T", "TE", "TO")}
    order_codes = [
        f"C58-{bits}{code}-{special.format(bits=bits)}"
        for bits in range(25, 29)
        for code in "BG"
        for special in options[code]
    ]
    rejected = 0
    for order_code in order_codes:
        encoder = package.lookup(order_code)
        generator = random.Random(order_code)
        for number in range(FRAMES // len(order_codes)):
            word = generator.getrandbits(encoder.frame_bits)
            if number % 3 and expected_c58(order_code, word) is None:
                word ^= 1
            expected = expected_c58(order_code, word)
            if expected is None:
                rejected += 1
                with pytest.raises(package.ConstantError):
                    encoder.decode(word)
                continue
            frame = encoder.decode(word)
            assert (frame.position, frame.verdict.value) == (expected, "unknown")
        with pytest.raises(package.LengthError):
            encoder.decode(0, bits=encoder.frame_bits + 1)
    assert rejected > FRAMES // 20
