"""Numbers in BCD, in five engines, against a decoder that is written here: codes above 9 are refused by each."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from codewheel.model import Device
from codewheel.model.kinds import DigitCode
from codewheel.reference import codec
from codewheel.targets import Library
from five_engines import (
    ENGINES,
    NOT_USABLE,
    USABLE,
    Case,
    Import,
    MadeEncoder,
    joined,
    load_made,
    named,
    ones,
    remainder,
    split,
)

pytestmark = pytest.mark.slow

HIGHEST_POSITION = 359


def decimal_number(bits: int) -> int | None:
    """Return the number whose decimal digits are the hexadecimal digits of ``bits``, or None if it has a letter."""
    text = f"{bits:X}"
    return int(text) if text.isdecimal() else None


def with_values(common: tuple[str, str, int, int], parts: dict[str, int], fault: str) -> Case:
    position, temperature = decimal_number(parts["position"]), decimal_number(parts["temperature"])
    is_range_wrong = position is None or position > HIGHEST_POSITION or temperature is None
    if fault or is_range_wrong:
        return Case(*common, fault or "range")
    assert position is not None
    assert temperature is not None
    is_wrong = parts["error"] == 1
    values = {"position": position, "temperature": temperature, "error": is_wrong}
    return Case(*common, "", NOT_USABLE if is_wrong else USABLE, named(error=is_wrong), values)


def words() -> Iterator[Case]:
    """Yield all words of a valid temperature, all temperatures with a valid position, and random words."""
    widths = [("temperature", 8), ("position", 10), ("error", 1), ("even", 1)]
    random_ = random.Random(46)
    numbers = [0x25 << 12 | number for number in range(1 << 12)]
    numbers += [number << 12 | 0x359 << 2 for number in range(1 << 8)]
    numbers += [random_.getrandbits(20) for _ in range(2000)]
    for number in numbers:
        parts = split(number, widths)
        is_parity_wrong = ones(*parts.values()) % 2 == 1
        yield with_values(("BCDS", "word", 20, number), parts, "constant" if is_parity_wrong else "")


def replies() -> Iterator[Case]:
    """Yield random replies, most of them with a right CRC. Lower fields are sent first, and byte 0 is the lowest."""
    widths = [("crc", 8), ("temperature", 11), ("error", 1), ("position", 12)]
    random_ = random.Random(46)
    for _ in range(3000):
        parts = split(random_.getrandbits(32), widths)
        if random_.random() < 0.8:
            parts["position"] = int(str(random_.randrange(400)), 16)
            parts["temperature"] = int(str(random_.randrange(800)), 16)
        data = (joined(parts, widths) & 0xFFFFFF).to_bytes(3, "little")
        right_crc = remainder(int.from_bytes(data, "big"), 24, 0x07, 8)
        if random_.random() < 0.9:
            parts["crc"] = right_crc
        fault = "" if parts["crc"] == right_crc else "crc"
        yield with_values(("BCDR", "reply", 32, joined(parts, widths)), parts, fault)


@pytest.fixture(scope="module")
def made() -> MadeEncoder:
    members = {"word": ("temperature", "position", "error"), "reply": ("position", "error", "temperature")}
    return MadeEncoder(load_made("digits"), members)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("layout", [words, replies])
def test_every_engine_agrees(
    layout: Any, engine: str, made: MadeEncoder, import_generated: Import, tmp_path: Path
) -> None:
    """Every frame that is accepted is encoded again, too."""
    cases = list(layout())
    assert {case.fault for case in cases} >= {"", "range"}
    results = list(ENGINES[engine](made, cases, import_generated, tmp_path))
    assert [pair for pair in zip(results, cases, strict=True) if pair[0] != pair[1]][:3] == []


@pytest.fixture(scope="module")
def device(made: MadeEncoder) -> Device:
    return made.device


def test_encoders_refuse_numbers_without_digits(device: Device, import_generated: Import) -> None:
    """10 bits have three digits, and the first one has two bits. The highest position is lower."""
    placed = device.layout("word").place(device.variant("BCDS").parameters)
    encoder: Any = import_generated(Library((device,)), "test_encoders")[1].lookup("BCDS")
    frame = encoder.decode(codec.encode(device, placed, {"temperature": 99, "position": 359, "error": False}))
    kind = type(frame)
    assert (frame.temperature, frame.position) == (99, 359)
    for temperature, position in ((100, 0), (0, 360)):
        values = {"temperature": temperature, "position": position, "error": False}
        with pytest.raises(codec.EncodeError, match="is"):
            codec.encode(device, placed, values)
        with pytest.raises(ValueError, match="at most"):
            kind(*values.values()).encode()
        with pytest.raises(ValueError, match="at most"):
            encoder.encode_many({name: [value] for name, value in values.items()})


@pytest.mark.parametrize(("width", "highest"), [(1, 1), (3, 7), (4, 9), (5, 19), (8, 99), (10, 399), (64, 10**16 - 1)])
def test_highest_number_of_bits(width: int, highest: int) -> None:
    assert DigitCode("BCD", 4, tuple(range(10))).highest(width) == highest
