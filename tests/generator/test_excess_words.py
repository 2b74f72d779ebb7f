"""Gray excess: all words of 9, 10 and 11 bits in every engine, against a table that is written here.

Position p of an encoder with n counts in b bits is sent as the Gray code of p + (2^b - n) / 2. Other codes are refused.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from c_harness import GCC, compile_programs, runner_over, write
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.reference import codec
from codewheel.targets import Library
from codewheel.targets.browser.files import generate as generate_page
from codewheel.virtual.clocked_lines import SsiLine
from codewheel.virtual.encoder import VirtualEncoder

pytestmark = pytest.mark.slow

SPEC = Path(__file__).resolve().parents[1] / "specs" / "gray_excess.yaml"
SPECS = [SPEC, SPEC.parent / "manufacturer.yaml"]
#: Counts of each order code, bits of its word, and the number that is sent for position 0.
CODES = {"EX360G": (360, 9, 76), "EX512G": (512, 9, 0), "EX720G": (720, 10, 152), "EX1440G": (1440, 11, 304)}
#: Without Gray code, positions are sent as they are.
BINARY = {"EX360B": (360, 9), "EX720B": (720, 10)}
#: Result of a word that is refused because of its position.
RANGE = -1
Import = Callable[[Library, str], tuple[Path, ModuleType]]


def codes_of(order_code: str) -> list[int]:
    """Return the words of the positions, from 0 on."""
    if order_code in BINARY:
        return list(range(BINARY[order_code][0]))
    counts, _, excess = CODES[order_code]
    return [number ^ number // 2 for number in range(excess, excess + counts)]


def expected_positions(order_code: str) -> list[int]:
    """Return the position of every word, in ascending order."""
    bits = (BINARY.get(order_code) or CODES[order_code])[1]
    positions = {word: position for position, word in enumerate(codes_of(order_code))}
    return [positions.get(word, RANGE) for word in range(1 << bits)]


@pytest.fixture(scope="module")
def device() -> Device:
    (device,), report = load_library(SPECS)
    assert not report
    return device


@pytest.mark.parametrize("order_code", CODES)
def test_one_bit_changes_from_each_position_to_the_next(order_code: str) -> None:
    """This is what Gray excess is for: also from the last position to position 0."""
    words = codes_of(order_code)
    assert {(one ^ other).bit_count() for one, other in pairwise([*words, words[0]])} == {1}
    counts, bits, excess = CODES[order_code]
    assert (counts + 2 * excess, len(set(words))) == (1 << bits, counts)


def decode_by_reference(device: Device, code: str, words: Sequence[int], *_: object) -> list[int]:
    variant = next(variant for variant in device.variants if variant.code == code)
    placed = device.layout("word").place(variant.parameters)
    results = []
    for word in words:
        decoded = codec.decode(device, placed, word)
        faults = [problem.fault.value for problem in decoded.problems]
        assert faults in ([], ["range"])
        position = decoded.values["position"]
        assert isinstance(position, int)
        if not faults:
            assert codec.encode(device, placed, {"position": position}) == word
        results.append(RANGE if faults else position)
    return results


def decode_in_python(device: Device, code: str, words: Sequence[int], import_generated: Import, _: Path) -> list[int]:
    encoder: Any = import_generated(Library((device,)), "test_encoders")[1].lookup(code)
    results = []
    for word in words:
        try:
            frame = encoder.decode(word)
        except ValueError as error:
            assert type(error).__name__ == "RangeError"
            results.append(RANGE)
            continue
        assert frame.encode() == word
        results.append(frame.position)
    return results


def decode_in_columns(device: Device, code: str, words: Sequence[int], import_generated: Import, _: Path) -> list[int]:
    np: Any = pytest.importorskip("numpy")
    encoder: Any = import_generated(Library((device,)), "test_encoders")[1].lookup(code)
    sent = np.array(words, np.uint64)
    table = encoder.decode_many(sent)
    valid = table.ok
    assert set(table.fault[~valid].tolist()) <= {4}
    assert (encoder.encode_many({"position": table["position"][valid]}) == sent[valid]).all()
    return [int(position) if ok else RANGE for position, ok in zip(table["position"], valid, strict=True)]


def decode_in_c(device: Device, code: str, words: Sequence[int], _: Import, folder: Path) -> list[int]:
    compile_programs([*GCC, "-Wall", "-Wextra", "-Wconversion", "-Werror"], device, folder, write(folder, (device,)))
    run = runner_over(device, folder)
    decode_answers = [answer.split() for answer in run([f"{code} decode word {word:X}" for word in words])]
    results = [int(answer[1]) if answer[0] == "0" else RANGE for answer in decode_answers]
    assert {answer[0] for answer in decode_answers} <= {"0", "4"}
    encode_answers = run([f"{code} encode word {position}" for position in results if position != RANGE])
    valid_words = [word for word, position in zip(words, results, strict=True) if position != RANGE]
    assert [int(answer.split()[1], 16) for answer in encode_answers] == valid_words
    return results


_SCRIPT = """
const [code, words] = JSON.parse(require("fs").readFileSync("words.json", "utf8"));
require("vm").runInThisContext(require("fs").readFileSync("decode.js", "utf8"));
const wheel = globalThis.codewheelDecode;
const found = wheel.findCode(code);
const results = words.map((word) => {
  const decoded = wheel.decodeFrame(found, "encoder", word);
  const faults = decoded.problems.map((problem) => problem.fault);
  const { value } = decoded.fields.find((field) => field.name === "position");
  return [faults, `${value}`];
});
console.log(JSON.stringify(results));
"""


def decode_in_browser(device: Device, code: str, words: Sequence[int], _: Import, folder: Path) -> list[int]:
    node = shutil.which("node") or shutil.which("nodejs")
    if node is None:
        pytest.skip("needs node")
    (folder / "decode.js").write_text(generate_page(Library((device,)))["browser/decode.js"], encoding="utf-8")
    (folder / "words.json").write_text(json.dumps([code, [f"0x{word:X}" for word in words]]), encoding="utf-8")
    done = subprocess.run([node, "-e", _SCRIPT], cwd=folder, capture_output=True, text=True, check=True)
    results = []
    for faults, position in json.loads(done.stdout):
        assert faults in ([], ["range"])
        results.append(RANGE if faults else int(position))
    return results


ENGINES = {
    "reference": decode_by_reference,
    "python": decode_in_python,
    "columns": decode_in_columns,
    "c": decode_in_c,
    "browser": decode_in_browser,
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("order_code", [*CODES, *BINARY])
def test_every_word_in_every_engine(
    order_code: str, engine: str, device: Device, import_generated: Import, tmp_path: Path
) -> None:
    """Every word that is accepted is encoded again, too."""
    expected = expected_positions(order_code)
    results = ENGINES[engine](device, order_code, range(len(expected)), import_generated, tmp_path)
    assert [pair for pair in zip(results, expected, strict=True) if pair[0] != pair[1]][:5] == []
    counts = (BINARY.get(order_code) or CODES[order_code])[0]
    assert sorted(position for position in results if position != RANGE) == list(range(counts))


@pytest.mark.parametrize("order_code", [*CODES, *BINARY])
def test_every_position_of_a_virtual_encoder(order_code: str) -> None:
    words = codes_of(order_code)
    for position, word in ((0, words[0]), (len(words) - 1, words[-1])):
        encoder = VirtualEncoder(order_code, position, specs=SPECS)
        bits = encoder.place(encoder.device.layout("word")).bits
        line = SsiLine(encoder)
        levels = [line.clock(level) for _ in range(bits) for level in (0, 1)][1::2]
        assert "".join(map(str, levels)) == f"{word:0{bits}b}"


@pytest.mark.parametrize("code", ["EX360G", "EX720G"])
def test_encoders_refuse_positions_above_the_counts(code: str, device: Device, import_generated: Import) -> None:
    """The first refused position and its excess together still fit into the bits."""
    variant = next(variant for variant in device.variants if variant.code == code)
    placed = device.layout("word").place(variant.parameters)
    _, module = import_generated(Library((device,)), "test_encoders")
    encoder: Any = module.lookup(code)
    frame = encoder.decode(codes_of(code)[0])
    counts = CODES[code][0]
    with pytest.raises(codec.EncodeError, match="position"):
        codec.encode(device, placed, {"position": counts})
    with pytest.raises(ValueError, match="position"):
        type(frame)(encoder, counts).encode()
    with pytest.raises(ValueError, match="position"):
        encoder.encode_many({"position": [0, counts]})


def crc_6(data: int, count: int) -> int:
    """Return the CRC with the polynomial x^6 + x + 1 over ``count`` bits, inverted."""
    remainder = 0
    for place in reversed(range(count)):
        top = (remainder >> 5 ^ data >> place) & 1
        remainder = (remainder << 1 & 0x3F) ^ (0x03 if top else 0)
    return remainder ^ 0x3F


def test_the_crc_covers_the_bits_as_sent(device: Device, import_generated: Import) -> None:
    _, module = import_generated(Library((device,)), "test_encoders")
    encoder: Any = module.lookup("EX360S")
    for position, word in enumerate(codes_of("EX360G")):
        data = word << 2 | 3
        sent = data << 6 | crc_6(data, 11)
        frame = encoder.decode(sent)
        assert (frame.position, frame.encode()) == (position, sent)


class Count(int):
    """A number that is not exactly an int, for which the package has no fast path."""


def test_the_package_encodes_numbers_of_other_types(device: Device, import_generated: Import) -> None:
    encoder: Any = import_generated(Library((device,)), "test_encoders")[1].lookup("EX360G")
    words = codes_of("EX360G")
    kind = type(encoder.decode(words[0]))
    assert [kind(encoder, Count(position)).encode() for position in range(360)] == words


def test_a_position_that_looks_wrong(capsys: pytest.CaptureFixture[str]) -> None:
    """76 is sent as 76 ^ 38 = 106. A program that reads it as binary gets 106."""
    specs = [argument for path in SPECS for argument in ("--specs", str(path))]
    assert main(["decode", "EX360G", f"0b{76 ^ 38:09b}", *specs]) == 0
    assert "106 if it is not sent in Gray code" in " ".join(capsys.readouterr().out.split())
