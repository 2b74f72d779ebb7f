"""A position that the encoder does not have is an error of the frame: 5,760 counts need 13 bits, which hold 8,192."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.plan.codec import codec_of
from codewheel.reference import codec

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
int main(void) {
    static const uint64_t words[] = {0xFAU, 0x167FF3U, 0x1680C7U, 0x1FFFD6U};
    test_ring_biss_frame frame;
    uint64_t made = 0;
    for (int place = 0; place < 4; ++place) {
        printf("%d ", test_ring_biss_decode(&TEST_RING_BISS_R5760, words[place], &frame) == CW_FAULT_RANGE);
    }
    printf("%d ", test_ring_biss_decode(&TEST_RING_BISS_R5760, words[1], &frame) == CW_OK);
    frame.position = 5760U;
    printf("%d", test_ring_biss_encode(&TEST_RING_BISS_R5760, &frame, &made) == CW_FAULT_RANGE);
    return 0;
}
"""


@pytest.fixture(scope="module")
def device() -> Device:
    (found,), report = load_library(SPECS)
    assert not report
    return found


@pytest.mark.parametrize("position", FRAMES)
def test_the_reference_rejects_a_position_above_the_highest(device: Device, position: int) -> None:
    frame, is_valid = FRAMES[position]
    placed = device.layout("word").place(device.variant("R5760").parameters)
    wrong = f"position is {position}, but the highest is 5759"
    assert [item.message for item in codec.decode(device, placed, frame).problems] == ([] if is_valid else [wrong])
    if not is_valid:
        with pytest.raises(codec.EncodeError, match=wrong):
            codec.encode(device, placed, {"position": position, "error": False, "warning": False})


def test_all_bits_of_4096_counts_are_used(device: Device) -> None:
    placed = device.layout("word").place(device.variant("R4096").parameters)
    frame = codec.encode(device, placed, {"position": 4095, "error": False, "warning": False})
    assert not codec.decode(device, placed, frame).problems


def test_parts_of_one_revolution_have_no_highest_value(tmp_path: Path) -> None:
    """The upper bits of 5,760 counts are not a number of revolutions, so 1 in them is valid."""
    split = "{name: upper, bits: position_bits - 5}\n          - {name: lower, bits: 5}"
    text = SPECS[1].read_text(encoding="utf-8").replace("{name: position, bits: position_bits}", split)
    text = text.replace("        fields:\n", "        join: {position: [upper, lower]}\n        fields:\n")
    (tmp_path / "ring.yaml").write_text(text, encoding="utf-8")
    (found,), report = load_library([SPECS[0], tmp_path / "ring.yaml"])
    assert not report
    placed = found.layout("word").place(found.variant("R5760").parameters)
    assert not codec.decode(found, placed, FRAMES[5759][0]).problems


def test_the_highest_position_of_equal_widths_depends_on_the_order_code(tmp_path: Path) -> None:
    text = SPECS[1].read_text(encoding="utf-8").replace("bits: position_bits}", "bits: 13}")
    text = text.replace('  position_bits: {meaning: Bits of the position, unit: bits, source: "2"}\n', "")
    text = text.replace("position_bits: 13, ", "").replace("position_bits: 12, ", "")
    (tmp_path / "ring.yaml").write_text(text, encoding="utf-8")
    (found,), report = load_library([SPECS[0], tmp_path / "ring.yaml"])
    assert not report
    assert codec_of(found, found.layout("word")).depends


def test_decode_gives_the_reason(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["decode", "R5760", "0x1680C7", *[item for path in SPECS for item in ("--specs", str(path))]]) == 1
    assert "range error: position is 5760, but the highest is 5759" in capsys.readouterr().out


@pytest.mark.slow
def test_python_columns_and_c_reject_it(tmp_path: Path) -> None:
    assert main(["generate", *map(str, SPECS), "-o", str(tmp_path), "--target", "c", "--target", "python"]) == 0
    packages = tmp_path / "python"
    paths = [str(packages), *map(str, packages.glob("*")), str(Path(__file__).parents[2] / "runtime" / "python")]
    subprocess.run([sys.executable, "-c", IN_PYTHON], env={"PYTHONPATH": ":".join(paths)}, check=True)
    (tmp_path / "main.c").write_text(IN_C, encoding="utf-8")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-pedantic", f"-I{tmp_path}/c/include"]
    subprocess.run(["gcc", *flags, str(tmp_path / "main.c"), "-o", str(tmp_path / "main")], check=True)
    found = subprocess.run([str(tmp_path / "main")], capture_output=True, text=True, check=True).stdout
    assert found == "0 0 1 1 1 1"
