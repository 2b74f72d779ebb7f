"""A position that the encoder does not have is an error of the frame: 5,760 counts need 13 bits, which hold 8,192.

The codecs of C, Python, Rust and the browser are also compared with the reference on random frames of the same specs.
"""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.plan.codec import layout_plan_of
from codewheel.reference import codec
from codewheel.targets.python.readme import Readme

SPECS = [Path(__file__).parents[1] / "specs" / name for name in ("manufacturer.yaml", "ring.yaml")]
#: Positions with their frames, whose CRCs are computed by hand from the polynomial, and whether the encoder has them.
FRAMES = {0: (0xFA, True), 5759: (0x167FF3, True), 5760: (0x1680C7, False), 8191: (0x1FFFD6, False)}
IN_PYTHON = """
import numpy
from test_encoders import RangeError, lookup
ring, small = lookup("R5760"), lookup("R4096")
assert ring.decode(0x167FF3, bits=21).position == 5759
for frame in (0x1680C7, 0x1FFFD6):
    try:
        ring.decode(frame, bits=21)
    except RangeError as error:
        assert "at most 5759" in str(error), error
    else:
        raise AssertionError(frame)
table = ring.decode_many(numpy.array([0xFA, 0x167FF3, 0x1680C7, 0x1FFFD6], numpy.uint64))
assert [bool(item) for item in table.fault] == [False, False, True, True]
frame = type(ring.decode(0xFA, bits=21))
try:
    frame(ring, position=5760, error=False, warning=False).encode()
except RangeError:
    pass
else:
    raise AssertionError("encoded")
"""
IN_C = """
#include <stdio.h>
#include "test/ring_biss.h"
#include "test/ring_biss_simulate.h"
static cw_result decoded(uint64_t word, test_ring_biss_frame *frame) {
    const test_ring_biss ring = TEST_RING_BISS_R5760;
    return test_ring_biss_decode(ring, cw_word_of(word, test_ring_biss_bits(ring)), frame);
}
int main(void) {
    static const uint64_t words[] = {0xFAU, 0x167FF3U, 0x1680C7U, 0x1FFFD6U};
    test_ring_biss_frame frame;
    uint64_t made = 0;
    for (int place = 0; place < 4; ++place) {
        printf("%d ", decoded(words[place], &frame) == CW_FAULT_RANGE);
    }
    printf("%d ", decoded(words[1], &frame) == CW_OK);
    frame.position = 5760U;
    printf("%d", test_ring_biss_encode(TEST_RING_BISS_R5760, &frame, &made) == CW_FAULT_RANGE);
    return 0;
}
"""
RINGS_IN_PYTHON = """
import numpy
from test_encoders import FrameError, RangeError, lookup
for code, bits, frames in {cases}:
    ring = lookup(code)
    found = [ring.try_decode(frame, bits=bits) for frame in frames]
    assert [isinstance(item, RangeError) for item in found] == [not item for item in frames.values()]
    assert [isinstance(item, FrameError) for item in found] == [not item for item in frames.values()]
    table = ring.decode_many(numpy.array([*frames], numpy.uint64))
    assert [not item for item in table.fault] == [*frames.values()]
"""
RINGS_IN_C = """
#include <stdio.h>
#include "test/ring_turns_biss.h"
int main(void) {
    test_ring_turns_biss_frame frame;
    int ok = 1;
%s
    printf("%%d", ok);
    return 0;
}
"""


def run_python(folder: Path, program: str) -> None:
    packages = folder / "python"
    paths = [str(packages), *map(str, packages.glob("*")), str(Path(__file__).parents[2] / "runtime" / "python")]
    subprocess.run([sys.executable, "-c", program], env={"PYTHONPATH": ":".join(paths)}, check=True)


def run_c(folder: Path, program: str) -> str:
    (folder / "main.c").write_text(program, encoding="utf-8")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-pedantic", f"-I{folder}/c/include"]
    subprocess.run(["gcc", *flags, str(folder / "main.c"), "-o", str(folder / "main")], check=True)
    return subprocess.run([str(folder / "main")], capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="module")
def device() -> Device:
    (ring,), report = load_library(SPECS)
    assert not report
    return ring


@pytest.mark.parametrize("position", FRAMES)
def test_the_reference_rejects_a_position_above_the_highest(device: Device, position: int) -> None:
    frame, is_valid = FRAMES[position]
    placed = device.layout("word").place(device.variant("R5760").parameters)
    message = f"position is {position}, but the highest is 5759"
    assert [problem.message for problem in codec.decode(device, placed, frame).problems] == (
        [] if is_valid else [message]
    )
    if not is_valid:
        with pytest.raises(codec.EncodeError, match=message):
            codec.encode(device, placed, {"position": position, "error": False, "warning": False})


def test_all_bits_of_4096_counts_are_used(device: Device) -> None:
    placed = device.layout("word").place(device.variant("R4096").parameters)
    frame = codec.encode(device, placed, {"position": 4095, "error": False, "warning": False})
    assert not codec.decode(device, placed, frame).problems


def positions_in_readme(device: Device, counts_per_turn: int) -> list[tuple[str, str]]:
    """Return the calls in the README and their results, for a first order code with this number of counts."""
    variant = device.variants[0]
    small = replace(variant, parameters={**variant.parameters, "counts": counts_per_turn})
    context: Any = SimpleNamespace(device=replace(device, variants=(small,)))
    return [(example.argument, example.printed_text) for example in Readme(context, (), {}, {}).position_examples]


def test_the_readme_unwraps_only_where_the_way_forward_is_shorter(device: Device) -> None:
    """From 8 to 3 are 5 of 10 counts in either direction. Four does not divide 11 counts, so two are not 90 degrees."""
    assert positions_in_readme(device, 10) == []
    assert positions_in_readme(device, 11) == [("encoder.degrees(2)", str(720 / 11)), ("encoder.unwrap(9, 3)", "14")]
    assert positions_in_readme(device, 12)[0] == ("encoder.degrees(3)", "90.0")


def test_parts_of_one_revolution_are_checked_together(tmp_path: Path) -> None:
    """The upper bits of 5,760 counts are not a number of revolutions, so 1 in them is valid."""
    split = "{name: upper, bits: position_bits - 5}\n          - {name: lower, bits: 5}"
    text = SPECS[1].read_text(encoding="utf-8").replace("{name: position, bits: position_bits}", split)
    text = text.replace("        fields:\n", "        join: {position: [upper, lower]}\n        fields:\n")
    (tmp_path / "ring.yaml").write_text(text, encoding="utf-8")
    (ring,), report = load_library([SPECS[0], tmp_path / "ring.yaml"])
    assert not report
    placed = ring.layout("word").place(ring.variant("R5760").parameters)
    for position, (frame, is_valid) in FRAMES.items():
        message = f"position is {position}, but the highest is 5759"
        problems = [problem.message for problem in codec.decode(ring, placed, frame).problems]
        assert problems == ([] if is_valid else [message])
    with pytest.raises(codec.EncodeError, match="position is 5760, but the highest is 5759"):
        codec.encode(ring, placed, {"position": 5760, "error": False, "warning": False})


def test_the_highest_position_of_equal_widths_depends_on_the_order_code(tmp_path: Path) -> None:
    text = SPECS[1].read_text(encoding="utf-8").replace("bits: position_bits}", "bits: 13}")
    text = text.replace('  position_bits: {meaning: Bits of the position, unit: bits, source: "2"}\n', "")
    text = text.replace("position_bits: 13, ", "").replace("position_bits: 12, ", "")
    (tmp_path / "ring.yaml").write_text(text, encoding="utf-8")
    (ring,), report = load_library([SPECS[0], tmp_path / "ring.yaml"])
    assert not report
    assert layout_plan_of(ring, ring.layout("word")).depends_on_order_code


def test_the_lowest_position_depends_on_the_order_code_even_if_the_highest_does_not(tmp_path: Path) -> None:
    text = SPECS[1].read_text(encoding="utf-8").replace("bits: position_bits}", "bits: 14, signed: true}")
    text = text.replace("turns: 1,", "turns: 1, highest: 100,")
    text = text.replace('  position_bits: {meaning: Bits of the position, unit: bits, source: "2"}\n', "")
    text = text.replace("position_bits: 13, ", "").replace("position_bits: 12, ", "")
    (tmp_path / "ring.yaml").write_text(text, encoding="utf-8")
    (ring,), report = load_library([SPECS[0], tmp_path / "ring.yaml"])
    assert not report
    assert layout_plan_of(ring, ring.layout("word")).depends_on_order_code


@pytest.mark.parametrize(("bits", "accepted"), [(12, False), (13, True), (16, True)])
def test_a_position_of_fixed_width_may_begin_with_zeros(tmp_path: Path, bits: int, accepted: bool) -> None:
    """A position with the 5,760 counts in other bits than the lowest ones is rejected as soon as it exceeds them."""
    text = SPECS[1].read_text(encoding="utf-8").replace("bits: position_bits}", f"bits: {bits}}}")
    text = text.replace("counts_per_turn: counts,", "counts_per_turn: 5760,")
    text = re.sub(r"parameters:\n(  .*\n)+", "parameters: {}\n", re.sub(r"sets: \{.*?\}, ", "", text))
    (tmp_path / "ring.yaml").write_text(text, encoding="utf-8")
    devices, report = load_library([SPECS[0], tmp_path / "ring.yaml"])
    message = f"5760 counts do not fit, because 'position' in 'word' has {bits} bits for R5760"
    assert [problem.message for problem in report.problems] == ([] if accepted else [message])
    for ring in devices if accepted else ():
        placed = ring.layout("word").place(ring.variant("R5760").parameters)
        frames = {position: ring_frame(position) for position in (5759, 5760, (1 << bits) - 1)}
        valid = [position for position, frame in frames.items() if not codec.decode(ring, placed, frame).problems]
        assert valid == [5759]


def test_decode_gives_the_reason(capsys: pytest.CaptureFixture[str]) -> None:
    assert (
        main(["decode", "R5760", "0x1680C7", *[argument for path in SPECS for argument in ("--specs", str(path))]]) == 1
    )
    assert "range error: position is 5760, but the highest is 5759" in capsys.readouterr().out


#: Counts, turns and bits of the position of each order code of ``ring_turns.yaml`` with BiSS.
RINGS = {
    "5760x1000B": (5760, 1000, 23),
    "5760x16B": (5760, 16, 17),
    "4096x1000B": (4096, 1000, 22),
    "4096x16B": (4096, 16, 16),
}
#: Counts and turns in the spec, with their order codes.
FORMULAS = {
    "both from the order code": ("counts", "turns", tuple(RINGS)),
    "fixed counts": ("5760", "2^turns_bits", ("5760x16B",)),
    "fixed turns": ("2^counts_bits", "1000", ("4096x1000B",)),
}
#: A value of an order code in this spec.
VALUE = re.compile(r" +(5760|4096|1000|16):.*\n")


def ring_frame(position: int) -> int:
    """Return the frame of a position, with its CRC computed bit by bit."""
    remainder, word = 0, position << 2 | 3
    for place in reversed(range(word.bit_length())):
        remainder ^= (word >> place & 1) << 5
        remainder = (remainder << 1 ^ (0x43 if remainder & 0x20 else 0)) & 0x3F
    return word << 6 | remainder ^ 0x3F


def ring_frames(code: str) -> dict[int, bool]:
    """Return frames around the highest position of an order code, and whether the encoder can have their positions."""
    counts, turns, bits = RINGS[code]
    highest = counts * turns - 1
    positions = {0, 1, highest // 2, highest, min(highest + 1, (1 << bits) - 1), (1 << bits) - 1}
    return {ring_frame(position): position <= highest for position in sorted(positions)}


def test_frames_of_rings_have_the_right_crc() -> None:
    assert {ring_frame(position): is_valid for position, (_, is_valid) in FRAMES.items()} == dict(FRAMES.values())


@pytest.mark.slow
@pytest.mark.parametrize("formula", FORMULAS)
def test_a_product_that_depends_on_the_order_code(formula: str, tmp_path: Path) -> None:
    """As many positions as counts times turns are valid in the reference, Python, its columns, and C."""
    counts, turns, codes = FORMULAS[formula]
    spec_text = SPECS[1].with_name("ring_turns.yaml").read_text(encoding="utf-8")
    measured = "counts_per_turn: counts, turns: turns,"
    spec_text = spec_text.replace(measured, f"counts_per_turn: {counts}, turns: {turns},")
    listed_values = {value for code in codes for value in code[:-1].split("x")}
    spec_text = VALUE.sub(lambda line: line[0] if line[1] in listed_values else "", spec_text)
    if turns != "turns":  # Nothing depends on the parameter any more. SSI has the counts alone.
        spec_text = re.sub(r"^  turns: .*\n|, turns: \d+(?=\}\})", "", spec_text, flags=re.MULTILINE)
    spec_path = tmp_path / "ring_turns.yaml"
    spec_path.write_text(spec_text, encoding="utf-8")
    (ring,), report = load_library([SPECS[0], spec_path])
    assert not report
    for code in codes:
        placed = ring.layout("word").place(ring.variant(code).parameters)
        is_valid_by_frame = {frame: not codec.decode(ring, placed, frame).problems for frame in ring_frames(code)}
        assert is_valid_by_frame == ring_frames(code)
    targets = ("--target", "c", "--target", "python")
    assert main(["generate", str(SPECS[0]), str(spec_path), "-o", str(tmp_path), *targets]) == 0
    frames_by_code = [(code, RINGS[code][2] + 8, ring_frames(code)) for code in codes]
    run_python(tmp_path, RINGS_IN_PYTHON.format(cases=frames_by_code))
    c_statements = []
    for code, _, frames in frames_by_code:
        for frame, is_valid in frames.items():
            variant = f"TEST_RING_TURNS_BISS_{code.upper()}"
            word = f"cw_word_of({frame}U, test_ring_turns_biss_bits({variant}))"
            call = f"test_ring_turns_biss_decode({variant}, {word}, &frame)"
            c_statements.append(f"    ok &= ({call} == {'CW_OK' if is_valid else 'CW_FAULT_RANGE'});")
    assert run_c(tmp_path, RINGS_IN_C % "\n".join(c_statements)) == "1"


@pytest.mark.slow
def test_python_columns_and_c_reject_it(tmp_path: Path) -> None:
    assert main(["generate", *map(str, SPECS), "-o", str(tmp_path), "--target", "c", "--target", "python"]) == 0
    run_python(tmp_path, IN_PYTHON)
    printed = run_c(tmp_path, IN_C)
    assert printed == "0 0 1 1 1 1"
