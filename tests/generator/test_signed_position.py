"""Signed positions: as many consecutive numbers as the encoder has positions, ending at ``highest`` of the spec.

The scale has order codes with 16,384,000 positions from -383,999 to 16,000,000, and with all 2^25 of its 25 bits.
Frames and results are computed here. The codecs of all languages are also compared on random frames of the same spec.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.reference import codec
from codewheel.say.layout import crc_parameters
from codewheel.virtual.encoder import VirtualEncoder

ROOT = Path(__file__).parents[2]
SPECS = [ROOT / "tests" / "specs" / name for name in ("manufacturer.yaml", "scale.yaml")]
#: Lowest and highest position of each order code with BiSS.
RANGES = {"AB": (-383_999, 16_000_000), "BB": (-(1 << 24), (1 << 24) - 1), "DB": (-1200, 0)}
#: Two positions, the modulus, and the way from the second to the first: the shorter way, backwards at half a turn.
MOVES = [
    (-1, 1, -2),
    (1, -1, 2),
    (-383_999, 16_000_000, 1),
    (16_000_000, -383_999, -1),
    (-383_999, 15_999_998, 3),
    (8_000_000, -383_999, -8_000_001),
    (7_808_001, -383_999, -8_192_000),
    (7_808_000, -383_999, 8_191_999),
]


def frame_of(position: int) -> int:
    """Return the BiSS frame of a position in 25 bits without errors, with its CRC computed bit by bit."""
    remainder, word = 0, (position & 0x1FFFFFF) << 2 | 3
    for place in reversed(range(27)):
        remainder ^= (word >> place & 1) << 5
        remainder = (remainder << 1 ^ (0x43 if remainder & 0x20 else 0)) & 0x3F
    return word << 6 | remainder ^ 0x3F


def positions(code: str) -> list[int]:
    """Return positions in 25 bits: at the ends of the range, and one beyond them."""
    lowest, highest = RANGES[code]
    candidates = {lowest - 1, lowest, -2, -1, 0, 1, highest, highest + 1, -(1 << 24), (1 << 24) - 1}
    return sorted(position for position in candidates if -(1 << 24) <= position < 1 << 24)


def is_valid(code: str, position: int) -> bool:
    lowest, highest = RANGES[code]
    return lowest <= position <= highest


def test_the_frames_of_this_test() -> None:
    """The data bits of -5 are all ones except two, and its CRC was divided on paper."""
    assert frame_of(-5) >> 6 == 0x7FFFFEF
    assert frame_of(0) == 0xFA


@pytest.fixture(scope="module")
def device() -> Device:
    (scale,), report = load_library(SPECS)
    assert not report
    return scale


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scale")
    assert main(["generate", *map(str, SPECS), "-o", str(folder), "--target", "c", "--target", "python"]) == 0
    return folder


def run_python(folder: Path, program: str) -> None:
    paths = [folder / "python", *(folder / "python").glob("*"), ROOT / "runtime" / "python"]
    environment = {"PYTHONPATH": ":".join(map(str, paths))}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def run_c(folder: Path, program: str, *, run: bool = True) -> tuple[int, str]:
    """Compile a program without warnings, run it, and return its exit code and output."""
    (folder / "main.c").write_text(program, encoding="utf-8")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Werror", "-pedantic"]
    build = ["gcc", *flags, f"-I{folder}/c/include", "main.c", "-o", "main"]
    subprocess.run(build, check=True, cwd=folder)
    if not run:
        return 0, ""
    done = subprocess.run([str(folder / "main")], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


@pytest.mark.parametrize("code", RANGES)
def test_the_reference_rejects_other_positions(code: str, device: Device) -> None:
    placed = device.layout("word").place(device.variant(code).parameters)
    lowest, highest = RANGES[code]
    for position in positions(code):
        decoded = codec.decode(device, placed, frame_of(position))
        message = f"position {position} is outside {lowest} to {highest}"
        assert decoded.values["position"] == position
        assert [problem.message for problem in decoded.problems] == ([] if is_valid(code, position) else [message])
        values = {"position": position, "error": False, "warning": False}
        if is_valid(code, position):
            assert codec.encode(device, placed, values) == frame_of(position)
        else:
            with pytest.raises(codec.EncodeError, match=message):
                codec.encode(device, placed, values)


IN_PYTHON = """
import numpy
from test_encoders import RangeError, lookup
for code, (lowest, highest), frames in {cases}:
    scale = lookup(code)
    assert (scale.lowest, scale.highest, scale.modulus) == (lowest, highest, highest - lowest + 1)
    for position, frame in frames.items():
        found, is_valid = scale.try_decode(frame, bits=33), lowest <= position <= highest
        assert isinstance(found, RangeError) != is_valid
        if is_valid:
            assert found.position == position
            assert scale.unwrap(position, position) == position
            continue
        assert str(found) == f"position must be {{lowest}} to {{highest}}, got {{position}}", found
        for encode in (
            type(scale.decode(frames[0], bits=33))(scale, position, False, False).encode,
            lambda: scale.encode_many({{"position": [position], "error": [0], "warning": [0]}}),
            lambda: scale.unwrap(0, position),
        ):
            try:
                encode()
            except RangeError as error:
                assert f"{{position}}" in str(error) and f"{{lowest}} to {{highest}}" in str(error), error
            else:
                raise AssertionError(encode)
    table = scale.decode_many(numpy.array([*frames.values()], numpy.uint64))
    assert [*table.position] == [*frames]
    assert [bool(item) for item in table.fault] == [not lowest <= position <= highest for position in frames]
"""


@pytest.mark.slow
def test_python_rejects_them(generated: Path) -> None:
    cases = []
    for code, ends in RANGES.items():
        frames = {position: frame_of(position) for position in positions(code)}
        cases.append((code, ends, frames))
    run_python(generated, IN_PYTHON.format(cases=cases))


UNWRAPPED = """
import numpy
from test_encoders import lookup
scale = lookup("AB")
for now, before, moved in {moves}:
    assert scale.unwrap(before, now) == before + moved, (now, before)
    table = scale.decode_many(scale.encode_many({{"position": [before, now], "error": [0, 0], "warning": [0, 0]}}))
    assert [*table.unwrapped()] == [before, before + moved]
    assert [*table.unwrapped(before - 16_384_000)] == [before - 16_384_000, before - 16_384_000 + moved]
    assert table.velocity(0.5)[1] == 2 * moved
    found = table.with_columns(time=[0.0, 0.5]).in_si()
    assert [*found["metres"]] == [before * 1 / 1_000_000, now * 1 / 1_000_000]
    assert found["metres_per_second"][1] == moved * 1 / 1_000_000 / 0.5
"""


@pytest.mark.slow
def test_python_continues_across_the_wrap(generated: Path) -> None:
    run_python(generated, UNWRAPPED.format(moves=MOVES))


IN_C = r"""
#include <stdio.h>
#include "codewheel/tracker.h"
#include "test/scale_biss.h"
#include "test/scale_biss_simulate.h"
#include "test/scale_rs485_simulate.h"
static int failures = 0;
static void is(int64_t found, int64_t right, int line)
{
    if (found != right) {
        printf("line %d: %lld, not %lld\n", line, (long long)found, (long long)right);
        failures++;
    }
}
static void moved(int64_t now, int64_t before, int64_t right)
{
    const cw_tracker_config config = { 16384000U, UINT32_MAX, 0U, 0U, 0U };
    cw_tracker axis;
    is(test_scale_biss_position_difference(TEST_SCALE_BISS_AB, now, before), right, __LINE__);
    cw_tracker_start(&axis, &config, 0U);
    is((int64_t)cw_tracker_add(&axis, (uint64_t)before, 0U), (int64_t)CW_OK, __LINE__);
    is((int64_t)cw_tracker_add(&axis, (uint64_t)now, 524288U), (int64_t)CW_OK, __LINE__);
    is(axis.position, before + right, __LINE__);
}
int main(void)
{
    static const uint8_t minus_two[] = { 7U, 0xFEU, 0xFFU, 0xFFU, 0x01U };
    test_scale_rs485_sent sent = { 7U, -2 };
    test_scale_biss_frame frame = { 0, false, false };
    uint8_t bytes[5];
    uint64_t word = 0U;
    int index;
    /* CALLS */
    is((int64_t)test_scale_rs485_sent_encode(TEST_SCALE_RS485_AR, &sent, bytes, 5U), (int64_t)CW_OK, __LINE__);
    for (index = 0; index < 5; index++) {
        is(bytes[index], minus_two[index], __LINE__);
    }
    return failures != 0;
}
"""


@pytest.mark.slow
def test_c_rejects_them_and_continues_across_the_wrap(generated: Path) -> None:
    lines = [f"    moved({now}, {before}, {distance});" for now, before, distance in MOVES]
    for code in RANGES:
        for position in positions(code):
            encoder, result = f"TEST_SCALE_BISS_{code}", "CW_OK" if is_valid(code, position) else "CW_FAULT_RANGE"
            calls = f"test_scale_biss_decode({encoder}, {frame_of(position)}U, &frame)"
            lines.append(f"    is((int64_t){calls}, (int64_t){result}, __LINE__);")
            lines.append(f"    frame.position = {position};")
            calls = f"test_scale_biss_encode({encoder}, &frame, &word)"
            lines.append(f"    is((int64_t){calls}, (int64_t){result}, __LINE__);")
    assert run_c(generated, IN_C.replace("/* CALLS */", "\n".join(lines))) == (0, "")


README = r"""
#include <stdio.h>
#include <string.h>
EXAMPLES
int main(void)
{
    static const uint8_t received[] = { RECEIVED };
    int32_t position = 0;
    int64_t result = 0;
    memcpy(biss_rx, received, sizeof(biss_rx));
    const bool is_read = read_encoder(&position);
    const bool is_decoded = decode_frame(FRAMEU, &result);
    printf("%d %ld, %d %lld", is_read, (long)position, is_decoded, (long long)result);
    return 0;
}
"""


@pytest.mark.slow
def test_the_c_readme_and_examples_handle_negative_positions(generated: Path) -> None:
    blocks = re.findall(r"```c\n(.*?)```", (generated / "c" / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    examples = [block for block in blocks if "bool read_encoder" in block or "bool decode_frame" in block]
    declared = re.sub(r"(bool \w+\(.*\))\n\{", r"\1;\n\1\n{", "\n".join(examples))
    frame = frame_of(-5)
    received = f"110000010{frame:033b}0".ljust(80, "1")
    received_bytes = ", ".join(str(int(received[first : first + 8], 2)) for first in range(0, len(received), 8))
    program = README.replace("EXAMPLES", declared).replace("FRAME", str(frame)).replace("RECEIVED", received_bytes)
    assert run_c(generated, program) == (0, "1 -5, 1 -5")
    programs = sorted((generated / "c" / "examples").glob("*.c"))
    assert "scale_biss_dma.c" in {path.name for path in programs}
    for path in programs:
        assert run_c(generated, path.read_text(encoding="utf-8"), run=False) == (0, "")


@pytest.mark.slow
def test_the_pages_say_that_the_position_is_signed(tmp_path: Path) -> None:
    assert main(["generate", *map(str, SPECS), "-o", str(tmp_path), "--target", "docs"]) == 0
    pages = [tmp_path / "docs" / f"scale-{interface}-masters.md" for interface in ("biss", "ssi")]
    masters = " ".join(" ".join(page.read_text(encoding="utf-8") for page in pages).split())
    ends = "-383999 to 16000000. A master that reads it as unsigned shows -1 as 33554431."
    assert f"The position is signed, in two's complement: {ends}" in masters
    assert "The position is signed, in two's complement: -500 to 499." in masters
    page = (tmp_path / "docs" / "scale" / "AB.md").read_text(encoding="utf-8")
    assert "- Signed: `position`, in two's complement, -383,999 to 16,000,000.\n" in page


@pytest.mark.parametrize(("refin", "refout", "words"), [(True, True, ", output reflected"), (True, False, "")])
def test_the_input_of_a_crc_over_bits_is_not_called_reflected(
    refin: bool, refout: bool, words: str, tmp_path: Path
) -> None:
    """The frame has 27 data bits. These are not bytes whose bits could be reversed, so ``refin`` has no effect."""
    text = SPECS[1].read_text(encoding="utf-8")
    reflection = f"refin: {str(refin).lower()}, refout: {str(refout).lower()}"
    keys = ", ".join(f"crcs.biss_6.{key}" for key, value in (("refin", refin), ("refout", refout)) if value)
    erratum = (
        'errata:\n  - {name: reflected, title: The CRC is reflected, source: "1", printed: Reflected, used: The same,'
        f" why: No encoder does this., status: settled, severity: wording, affects: [{keys}]}}\n"
    )
    (tmp_path / "scale.yaml").write_text(
        text.replace("refin: false, refout: false", reflection) + erratum, encoding="utf-8"
    )
    (scale,), report = load_library([SPECS[0], tmp_path / "scale.yaml"])
    assert not report, report.problems
    assert crc_parameters(scale, scale.crcs[0]) == f"x^6 + x + 1, start value 0{words}, sent inverted"
    placed = scale.layout("word").place(scale.variant("AB").parameters)
    frame = codec.encode(scale, placed, {"position": -5, "error": False, "warning": False})
    crc = frame_of(-5) & 0x3F
    assert frame & 0x3F == (int(f"{crc:06b}"[::-1], 2) if refout else crc)


@pytest.mark.parametrize("code", RANGES)
@pytest.mark.parametrize("position", [0, -5, 5, 16_000_000, 16_000_001, -383_999, -384_000, -(10**7) - 7])
def test_the_simulated_encoder_sends_twos_complement(code: str, position: int) -> None:
    lowest, highest = RANGES[code]
    encoder = VirtualEncoder(code, position, specs=SPECS)
    expected = position
    while expected > highest or expected < lowest:
        expected += (highest - lowest + 1) * (-1 if expected > highest else 1)
    assert encoder.frame(encoder.layouts("encoder")[0]) == frame_of(expected)
