"""Numbers in BCD, in five engines, against a decoder that is written here: codes above 9 are refused by each."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device, kinds
from codewheel.model.kinds import DigitCode, WholeCode
from codewheel.reference import codec
from codewheel.reference.bits_and_values import digits_of_number, number_of_digits
from codewheel.targets import Library
from five_engines import (
    ENGINES,
    NOT_USABLE,
    SPECS,
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


#: Code of each digit, from 0 up: two of five bits are 1.
TWO_OF_FIVE = (0b00110, 0b10001, 0b01001, 0b11000, 0b00101, 0b10100, 0b01100, 0b00011, 0b10010, 0b01010)
ONE_OF_FOUR = (0b0001, 0b0010, 0b0100, 0b1000)
EXCESS_3 = tuple(range(3, 13))


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    ("codes", "digit_bits"), [(TWO_OF_FIVE, 5), (ONE_OF_FOUR, 4), (EXCESS_3, 4)], ids=["2 of 5", "1 of 4", "excess 3"]
)
def test_a_code_of_digits_is_only_a_row_of_the_table(
    codes: tuple[int, ...],
    digit_bits: int,
    engine: str,
    import_generated: Import,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Every engine takes the codes of the digits from it, and refuses all others."""
    monkeypatch.setattr(kinds, "DIGIT_CODES", {"bcd": DigitCode("another code", digit_bits, codes)})
    made = load_ssi(tmp_path, temperature_bits=2 * digit_bits, position_bits=2 * digit_bits, counts=16)
    numbers = {upper << digit_bits | lower: (upper, lower) for upper in codes for lower in codes}
    cases = []
    for sent in range(1 << 2 * digit_bits):
        digits = numbers.get(sent)
        # The temperature is the number 1, and the position is what is tried.
        frame = (codes[0] << digit_bits | codes[1]) << 2 * digit_bits + 2 | sent << 2
        common = ("BCDS", "word", 4 * digit_bits + 2, frame | ones(frame) % 2)
        position = codes.index(digits[0]) * len(codes) + codes.index(digits[1]) if digits else 16
        if position > 15:
            cases.append(Case(*common, "range"))
        else:
            values = {"temperature": 1, "position": position, "error": False}
            cases.append(Case(*common, "", USABLE, frozenset(), values))
    assert sum(not case.fault for case in cases) == 16
    results = list(ENGINES[engine](made, cases, import_generated, tmp_path))
    assert [pair for pair in zip(results, cases, strict=True) if pair[0] != pair[1]][:3] == []


def one_hot(width: int) -> Iterator[int]:
    return (1 << number for number in range(width))


def johnson(width: int) -> Iterator[int]:
    """Yield the states of a counter that shifts in the inverse of its last bit: 000, 001, 011, 111, 110, …"""
    all_ones = (1 << width) - 1
    for number in range(2 * width):
        yield (1 << number) - 1 if number <= width else all_ones ^ (1 << number - width) - 1


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("codes_of", [one_hot, johnson])
def test_a_code_of_whole_fields_is_only_a_row_of_the_table(
    codes_of: Callable[[int], Iterator[int]],
    engine: str,
    import_generated: Import,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Fields of 3 and of 5 bits have different codes, of which every engine refuses all others."""
    monkeypatch.setattr(kinds, "DIGIT_CODES", {"bcd": WholeCode("another code", codes_of)})
    made = load_ssi(tmp_path, temperature_bits=3, position_bits=5, counts=4)
    temperatures, positions = list(codes_of(3)), list(codes_of(5))
    cases = []
    for sent in range(1 << 8):
        sent_temperature, sent_position = sent >> 5, sent & 0b11111
        common = ("BCDS", "word", 10, sent << 2 | ones(sent) % 2)
        if sent_temperature in temperatures and sent_position in positions[:4]:
            temperature, position = temperatures.index(sent_temperature), positions.index(sent_position)
            values = {"temperature": temperature, "position": position, "error": False}
            cases.append(Case(*common, "", USABLE, frozenset(), values))
        else:
            cases.append(Case(*common, "range"))
    assert sum(not case.fault for case in cases) == 4 * len(temperatures)
    results = list(ENGINES[engine](made, cases, import_generated, tmp_path))
    assert [pair for pair in zip(results, cases, strict=True) if pair[0] != pair[1]][:3] == []


@pytest.mark.parametrize(
    ("code", "bits", "problem"),
    [
        (DigitCode("excess-3", 4, EXCESS_3), 5, "has 5 bits, so its first digit has too few bits for excess-3"),
        (WholeCode("Johnson code", johnson), 6, "has 12 codes of 6 bits, more than decoders have room for"),
        (WholeCode("one of two", lambda _: (0, 1)), 9, "has 2 codes of 9 bits, more than decoders have room for"),
    ],
)
def test_codes_without_room_are_refused(
    code: DigitCode | WholeCode, bits: int, problem: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(kinds, "DIGIT_CODES", {"bcd": code})
    messages = write_ssi(tmp_path, temperature_bits=bits, position_bits=4, counts=2)[1]
    assert [message.partition(";")[0] for message in messages] == [f"'temperature' {problem}"]


def test_a_leading_digit_0_is_sent_in_its_code() -> None:
    """The bits of 0 are not 0 in excess-3."""
    assert digits_of_number(DigitCode("excess-3", 4, EXCESS_3), 5, 8) == 0x38
    assert number_of_digits(DigitCode("excess-3", 4, EXCESS_3), 0x38, 8) == 5


def write_ssi(
    folder: Path, *, temperature_bits: int, position_bits: int, counts: int
) -> tuple[tuple[Device, ...], list[str]]:
    """Load the spec with SSI only, and other widths and counts. Return its families and the messages of ``check``."""
    text = (SPECS / "digits.yaml").read_text(encoding="utf-8")
    crcs = text[text.index("crcs:") : text.index("interfaces:")]
    text = text[: text.index("  rs485:")].replace(crcs, "")
    text = text.replace("        R: {meaning: RS-485, interface: rs485}\n", "")
    text = text.replace("temperature, bits: 8,", f"temperature, bits: {temperature_bits},")
    text = text.replace("bits: 10,", f"bits: {position_bits},")
    text = text.replace("counts_per_turn: 360", f"counts_per_turn: {counts}")
    (folder / "digits.yaml").write_text(text, encoding="utf-8")
    devices, report = load_library([folder / "digits.yaml", SPECS / "manufacturer.yaml"])
    return devices, [problem.message for problem in report.problems]


def load_ssi(folder: Path, *, temperature_bits: int, position_bits: int, counts: int) -> MadeEncoder:
    devices, messages = write_ssi(folder, temperature_bits=temperature_bits, position_bits=position_bits, counts=counts)
    assert messages == []
    return MadeEncoder(devices[0], {"word": ("temperature", "position", "error")})


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


def test_no_other_position_is_proposed(capsys: pytest.CaptureFixture[str]) -> None:
    """Most other readings of a frame with digits have a digit that does not exist."""
    specs = [argument for name in ("digits", "manufacturer") for argument in ("--specs", str(SPECS / f"{name}.yaml"))]
    assert main(["decode", "BCDS", "0b00100101110101100101", *specs]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "position 0x359 359 counts" in text
    assert "look wrong" not in text


def test_a_frame_without_digits_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    specs = [argument for name in ("digits", "manufacturer") for argument in ("--specs", str(SPECS / f"{name}.yaml"))]
    assert main(["decode", "BCDS", "0b00100101110101101001", *specs]) == 1
    text = " ".join(capsys.readouterr().out.split())
    assert "position is sent as 0x35a, but it must be BCD of at most 359" in text
