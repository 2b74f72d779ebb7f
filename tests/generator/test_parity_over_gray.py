"""Parity bits over numbers in Gray code, in every engine, against words that are written here bit by bit.

Such bits are the parity of the bits as they are sent, so a receiver can check them before it converts the number.
"""

from __future__ import annotations

import json
import random
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from c_harness import GCC, compile_programs, runner_over, write
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.reference import codec
from codewheel.targets import Library
from codewheel.targets.browser.files import generate as generate_page
from codewheel.virtual.clocked_lines import SsiLine
from codewheel.virtual.encoder import VirtualEncoder

pytestmark = pytest.mark.slow

SPEC = Path(__file__).resolve().parents[1] / "specs" / "gray_parity.yaml"
SPECS = [SPEC, SPEC.parent / "manufacturer.yaml"]
#: Bits of the angle of each order code over SSI, and whether it sends Gray code.
CODES = {"GP9G": (9, True), "GP11G": (11, True), "GP9B": (9, False)}
#: A word over SSI, and its turns, angle and error, or None if a parity bit is wrong.
Sent = tuple[int, tuple[int, int, bool] | None]
Import = Callable[[Library, str], tuple[Path, ModuleType]]


def word_of(bits: int, is_gray: bool, turns: int, angle: int, error: bool) -> int:
    """Return the word: Gray code or binary, the error, and three parity bits over the bits before them."""
    position = turns << bits | angle
    sent = position ^ position >> 1 if is_gray else position
    sent_angle = sent & (1 << bits) - 1
    parity_of_all = (sent.bit_count() + error) % 2
    parity_of_angle = 1 - sent_angle.bit_count() % 2
    odd_bits = [sent_angle >> place & 1 for place in range(1, bits, 2)]
    return sent << 4 | error << 3 | parity_of_all << 2 | parity_of_angle << 1 | sum(odd_bits) % 2


def words(code: str) -> Iterator[Sent]:
    """Yield words with random numbers, each as it is and with one bit inverted, and all combinations of parity bits."""
    bits, is_gray = CODES[code]
    numbers = random.Random(code)
    for _ in range(2000):
        turns, angle, error = numbers.randrange(16), numbers.randrange(1 << bits), bool(numbers.randrange(2))
        word = word_of(bits, is_gray, turns, angle, error)
        yield word, (turns, angle, error)
        # Every bit is covered by a parity bit, or is a parity bit.
        yield word ^ 1 << numbers.randrange(bits + 8), None
    for parities in range(1, 8):
        yield word ^ parities, None


@pytest.fixture(scope="module")
def device() -> Device:
    (device,), report = load_library(SPECS)
    assert not report
    return device


def decode_by_reference(device: Device, code: str, sent: Sequence[int], *_: object) -> list[Any]:
    variant = next(variant for variant in device.variants if variant.code == code)
    placed = device.layout("word").place(variant.parameters)
    results: list[Any] = []
    for word in sent:
        decoded = codec.decode(device, placed, word)
        faults = {problem.fault.value for problem in decoded.problems}
        assert faults <= {"constant"}
        values = {name: decoded.values[name] for name in ("turns", "angle", "error")}
        assert faults or codec.encode(device, placed, values) == word
        results.append(None if faults else tuple(values.values()))
    return results


def decode_in_python(device: Device, code: str, sent: Sequence[int], import_generated: Import, _: Path) -> list[Any]:
    encoder: Any = import_generated(Library((device,)), "test_encoders")[1].lookup(code)
    results: list[Any] = []
    for word in sent:
        try:
            frame = encoder.decode(word)
        except ValueError as error:
            assert type(error).__name__ == "ConstantError"
            results.append(None)
            continue
        assert frame.encode() == word
        results.append((frame.turns, frame.angle, frame.error))
    return results


def decode_in_columns(device: Device, code: str, sent: Sequence[int], import_generated: Import, _: Path) -> list[Any]:
    np: Any = pytest.importorskip("numpy")
    encoder: Any = import_generated(Library((device,)), "test_encoders")[1].lookup(code)
    array = np.array(sent, np.uint64)
    table = encoder.decode_many(array)
    columns = {name: table[name] for name in ("turns", "angle", "error")}
    valid_columns = {name: column[table.ok] for name, column in columns.items()}
    assert (encoder.encode_many(valid_columns) == array[table.ok]).all()
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    return [row if is_valid else None for row, is_valid in zip(rows, table.ok, strict=True)]


def decode_in_c(device: Device, code: str, sent: Sequence[int], _: Import, folder: Path) -> list[Any]:
    compile_programs([*GCC, "-Wall", "-Wextra", "-Wconversion", "-Werror"], device, folder, write(folder, (device,)))
    run = runner_over(device, folder)
    results: list[Any] = []
    lines = []
    for answer in run([f"{code} decode word {word:X}" for word in sent]):
        result, *members = answer.split()
        assert result in ("0", "3")
        if result == "3":
            results.append(None)
            continue
        lines.append(f"{code} encode word {' '.join(members)}")
        turns, angle, error, position = map(int, members)
        assert position == turns << CODES[code][0] | angle
        results.append((turns, angle, bool(error)))
    encoded = [int(answer.split()[1], 16) for answer in run(lines)]
    assert encoded == [word for word, result in zip(sent, results, strict=True) if result is not None]
    return results


_SCRIPT = """
const [code, words] = JSON.parse(require("fs").readFileSync("words.json", "utf8"));
require("vm").runInThisContext(require("fs").readFileSync("decode.js", "utf8"));
const wheel = globalThis.codewheelDecode;
const found = wheel.findCode(code);
const results = words.map((word) => {
  const decoded = wheel.decodeFrame(found, "encoder", word);
  const value = (name) => decoded.fields.find((field) => field.name === name).value;
  return [decoded.problems.map((item) => item.fault), `${value("turns")}`, `${value("angle")}`, value("error")];
});
console.log(JSON.stringify(results));
"""


def decode_in_browser(device: Device, code: str, sent: Sequence[int], _: Import, folder: Path) -> list[Any]:
    node = shutil.which("node") or shutil.which("nodejs")
    if node is None:
        pytest.skip("needs node")
    (folder / "decode.js").write_text(generate_page(Library((device,)))["browser/decode.js"], encoding="utf-8")
    (folder / "words.json").write_text(json.dumps([code, [f"0x{word:X}" for word in sent]]), encoding="utf-8")
    done = subprocess.run([node, "-e", _SCRIPT], cwd=folder, capture_output=True, text=True, check=True)
    results: list[Any] = []
    for faults, turns, angle, error in json.loads(done.stdout):
        assert set(faults) <= {"constant"}
        results.append(None if faults else (int(turns), int(angle), error))
    return results


ENGINES = {
    "reference": decode_by_reference,
    "python": decode_in_python,
    "columns": decode_in_columns,
    "c": decode_in_c,
    "browser": decode_in_browser,
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("code", CODES)
def test_every_engine(code: str, engine: str, device: Device, import_generated: Import, tmp_path: Path) -> None:
    """Valid words are encoded again, too."""
    pairs = list(words(code))
    results = ENGINES[engine](device, code, [word for word, _ in pairs], import_generated, tmp_path)
    different = [
        (hex(word), values, result) for (word, values), result in zip(pairs, results, strict=True) if values != result
    ]
    assert not different[:5]


#: Changes of the spec after which the order codes with 11 bits lack the bit ``parity_of_angle``.
_WITHOUT_A_BIT = {
    "  in_gray: {meaning: 1 for Gray": "  has_parity: {meaning: 1 with the bit}\n  in_gray: {meaning: 1 for Gray",
    "sets: {angle_bits: 9}": "sets: {angle_bits: 9, has_parity: 1}",
    "sets: {angle_bits: 11}": "sets: {angle_bits: 11, has_parity: 0}",
    "{name: parity_of_angle, parity: odd, parity_of: angle}": (
        "{name: parity_of_angle, bits: has_parity, parity: odd, parity_of: [turns, angle, error]}"
    ),
}


@pytest.mark.parametrize("engine", ENGINES)
def test_an_order_code_without_one_of_the_parity_bits(engine: str, import_generated: Import, tmp_path: Path) -> None:
    """The bit that the order code lacks is not sent: no other bit of the word takes its parity."""
    spec_text = SPEC.read_text(encoding="utf-8")
    for old, new in _WITHOUT_A_BIT.items():
        assert spec_text.count(old) == 1
        spec_text = spec_text.replace(old, new)
    spec = tmp_path / SPEC.name
    spec.write_text(spec_text, encoding="utf-8")
    (changed_device,), report = load_library([spec, *SPECS[1:]])
    assert not report
    expected: list[tuple[int, int, bool]] = []
    sent: list[int] = []
    for turns, angle, error in ((0, 0, False), (5, 300, True), (6, 301, False), (15, 2047, True), (1, 2, False)):
        word = word_of(11, True, turns, angle, error)
        # The bit would be bit 1, above the parity of the odd bits.
        sent.append(word >> 2 << 1 | word & 1)
        expected.append((turns, angle, error))
    assert ENGINES[engine](changed_device, "GP11G", sent, import_generated, tmp_path) == expected


@pytest.mark.parametrize("code", CODES)
def test_a_virtual_encoder(code: str) -> None:
    bits, is_gray = CODES[code]
    for turns, angle in ((0, 0), (5, 300), (15, (1 << bits) - 1)):
        encoder = VirtualEncoder(code, turns << bits | angle, specs=SPECS)
        line = SsiLine(encoder)
        levels = [line.clock(level) for _ in range(bits + 8) for level in (0, 1)][1::2]
        assert int("".join(map(str, levels)), 2) == word_of(bits, is_gray, turns, angle, error=False)


def crc_6(data: int, count: int) -> int:
    """Return the CRC with the polynomial x^6 + x + 1 over ``count`` bits, inverted."""
    remainder = 0
    for place in reversed(range(count)):
        top = (remainder >> 5 ^ data >> place) & 1
        remainder = (remainder << 1 & 0x3F) ^ (0x03 if top else 0)
    return remainder ^ 0x3F


def test_with_an_excess_and_a_crc(device: Device, import_generated: Import) -> None:
    """360 counts: position p is sent as the Gray code of p + 76, then its parity, two ones and the CRC of all."""
    encoder: Any = import_generated(Library((device,)), "test_encoders")[1].lookup("GP9X")
    for position in range(360):
        sent = position + 76 ^ (position + 76) // 2
        for parity in (0, 1):
            data = (sent << 1 | parity) << 2 | 3
            frame_bytes = (data << 6 | crc_6(data, 12)).to_bytes(3, "big")
            if parity == sent.bit_count() % 2:
                frame = encoder.decode(frame_bytes)
                assert (frame.angle, frame.encode()) == (position, frame_bytes)
                continue
            with pytest.raises(ValueError, match="angle_parity"):
                encoder.decode(frame_bytes)
