"""Ranges of the position by layout: SMA21 has replies with 24 bits, which wrap around, and with 48 bits, which do not.

All values are computed here. At 1 µm, 10,000,000 counts are 10 m of travel, of 16,339 mm that the manual allows.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.plan.values import position_ranges
from codewheel.virtual.encoder import VirtualEncoder

ROOT = Path(__file__).parents[2]
SPECS = [ROOT / "specs" / "lika" / name for name in ("manufacturer.yaml", "sma21.yaml")]
CODE = "SMA21-JP1-0001"
#: Two positions of the 48-bit reply, and the way from the second to the first: always their difference.
WIDE = [
    (10_000_000, 0, 10_000_000),
    (5_000_000, -5_000_000, 10_000_000),
    (-5_000_000, 5_000_000, -10_000_000),
    (-1, 0, -1),
    (2**47 - 1, -(2**47), 2**48 - 1),
    (-(2**47), 2**47 - 1, 1 - 2**48),
]
#: Two positions of a 24-bit reply, which wraps around after 16,777,216 counts, and the shorter way between them.
NARROW = [
    (10_000_000, 0, 10_000_000 - 16_777_216),
    (0, 16_777_215, 1),
    (16_777_215, 0, -1),
    (5, 16_777_210, 5 + 16_777_216 - 16_777_210),
    (8_388_607, 0, 8_388_607),
    (8_388_608, 0, -8_388_608),
]


@pytest.fixture(scope="module")
def sma21() -> Device:
    devices, _ = load_library(SPECS)
    return devices[0]


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sma21")
    wanted = ["--target", "c", "--target", "python", "--unchecked"]
    assert main(["generate", *map(str, SPECS), "-o", str(folder), *wanted]) == 0
    return folder


def test_each_reply_has_its_range(sma21: Device) -> None:
    interface = sma21.interface("rs485")
    ranges = {}
    for position_range in position_ranges(sma21, interface):
        for layout in position_range.layouts:
            ranges[layout.name] = (position_range.never_wraps, position_range.measurement.total)
    bits = sma21.variant(CODE).parameters
    assert {name: never for name, (never, _) in ranges.items()} == {
        "position_reply": False,
        "identification_reply": False,
        "wide_position_reply": True,
    }
    totals = {name: total.value(bits) if total is not None else None for name, (_, total) in ranges.items()}
    assert totals == {"position_reply": 2**24, "identification_reply": 2**24, "wide_position_reply": None}
    assert len(position_ranges(sma21, sma21.interface("ssi"))) == 1


IN_C = r"""
#include <stdio.h>
#include "lika/sma21_rs485.h"
static int failures = 0;
static void is(int64_t found, int64_t right, int line)
{
    if (found != right) {
        printf("line %d: %lld, not %lld\n", line, (long long)found, (long long)right);
        failures++;
    }
}
int main(void)
{
    const lika_sma21_rs485 encoder = LIKA_SMA21_RS485_JP1_0001;
    /* CALLS */
    is((int64_t)lika_sma21_rs485_position_reply_modulus(encoder), 16777216, __LINE__);
    is((int64_t)lika_sma21_rs485_identification_reply_modulus(encoder), 16777216, __LINE__);
    is(lika_sma21_rs485_micrometres(encoder, 10000000), 10000000, __LINE__);
    return failures != 0;
}
"""


@pytest.mark.slow
def test_c_has_a_distance_for_each_reply(generated: Path) -> None:
    calls = []
    for name, moves in (("wide_position", WIDE), ("position", NARROW), ("identification", NARROW)):
        for now, before, moved in moves:
            positions = f"INT64_C({now}), INT64_C({before})" if name == "wide_position" else f"{now}U, {before}U"
            call = f"lika_sma21_rs485_{name}_reply_position_difference(encoder, {positions})"
            calls.append(f"    is({call}, INT64_C({moved}), __LINE__);")
    program = IN_C.replace("/* CALLS */", "\n".join(calls))
    assert build(generated, program).returncode == 0
    done = subprocess.run([str(generated / "main")], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["modulus", "position_difference"])
def test_c_has_no_function_that_mixes_replies(generated: Path, name: str) -> None:
    arguments = "encoder" if name == "modulus" else "encoder, 10000000, 0"
    call = f"is((int64_t)lika_sma21_rs485_{name}({arguments}), 0, 0);"
    done = build(generated, IN_C.replace("/* CALLS */", call))
    assert done.returncode != 0
    assert f"lika_sma21_rs485_{name}" in done.stderr


def build(folder: Path, program: str) -> subprocess.CompletedProcess[str]:
    (folder / "main.c").write_text(program, encoding="utf-8")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Werror", "-pedantic"]
    command = ["gcc", *flags, f"-I{folder}/c/include", "main.c", "-o", "main"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


IN_PYTHON = """
import numpy
from codewheel_runtime import PositionRange
from lika_encoders import sma21
encoder = sma21.lookup("SMA21-JP1-0001")
wide, narrow = encoder.range_of(sma21.WidePositionReply), encoder.range_of(sma21.PositionReply)
assert wide == PositionRange(-2**47, 2**47 - 1, None)
assert narrow == encoder.range_of(sma21.IdentificationReply) == PositionRange(0, 2**24 - 1, 2**24)
def frames(kind, before, now):
    others = {name: [4 if name == "data_id" else 0] * 2 for name in encoded(kind)}
    return encoder.encode_many({"position": [before, now], **others}, kind)
def encoded(kind):
    return [name for name in encoder.decode_many([], kind).names if name not in ("position", "verdict", "fault")]
for kind, moves in ((sma21.WidePositionReply, WIDE), (sma21.PositionReply, NARROW)):
    span = encoder.range_of(kind)
    for now, before, moved in moves:
        assert span.unwrap(before, now) == before + moved, (now, before)
        table = encoder.decode_many(frames(kind, before, now), kind)
        assert [*table.unwrapped()] == [before, before + moved], (now, before)
        assert [*table.unwrapped(before)] == [before, before + moved]
        assert [*table[1:].unwrapped(before)] == [before + moved]
        assert table.velocity(0.5)[1] == 2 * moved
        found = table.with_columns(time=[0.0, 0.5]).in_si()
        assert found["metres_per_second"][1] == moved * 1 / 1_000_000 / 0.5
for wrong in (lambda: encoder.unwrap(0, 10_000_000), lambda: encoder.modulus, lambda: encoder.highest,
              lambda: encoder.lowest):
    try:
        wrong()
    except ValueError as error:
        assert "it depends on the frame, see range_of()" in str(error), error
    else:
        raise AssertionError(wrong)
for position in (2**24, -1):
    try:
        narrow.unwrap(0, position)
    except ValueError as error:
        assert "0 to 16777215" in str(error), error
    else:
        raise AssertionError(position)
try:
    encoder.range_of(sma21.DataRequest)
except TypeError as error:
    assert str(error) == "frames of the class DataRequest have no position"
other = sma21.lookup("SMA21-BG1-0001")
assert other.range_of(sma21.SsiWord) == PositionRange(0, 2**25 - 1, 2**25)
assert other.unwrap(2**25 - 2, 3) == 2**25 + 3
"""


@pytest.mark.slow
def test_python_unwraps_by_reply(generated: Path) -> None:
    paths = [generated / "python", *(generated / "python").glob("*"), ROOT / "runtime" / "python"]
    program = f"WIDE, NARROW = {WIDE}, {NARROW}\n{IN_PYTHON}"
    environment = {"PYTHONPATH": ":".join(map(str, paths))}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_virtual_encoder_sends_each_position_in_its_range(sma21: Device) -> None:
    """10 m before zero, the 24-bit replies are 16,777,216 counts higher."""
    encoder = VirtualEncoder(CODE, -10_000_000, specs=SPECS)
    layouts = {layout.name: layout for layout in encoder.layouts("encoder")}
    positions = {name: encoder.parts_now(layout)["position"] for name, layout in layouts.items()}
    assert positions == {
        "position_reply": 16_777_216 - 10_000_000,
        "identification_reply": 16_777_216 - 10_000_000,
        "wide_position_reply": 2**48 - 10_000_000,
    }
    encoder.reset("reset_errors")
    assert encoder.parts_now(layouts["wide_position_reply"])["position"] == 2**48 - 10_000_000
    encoder.reset("reset_position")
    assert encoder.parts_now(layouts["wide_position_reply"])["position"] == 0


def test_show_states_the_range_of_the_reply(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", CODE, "--specs", str(SPECS[1])]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "in wide_position_reply never wraps around [7.2 p.37, 7.3.3 p.39]" in printed
    assert "16,777,216 counts in total" in printed


def _in_folder(folder: Path, *changes: tuple[str, str]) -> Path:
    folder.mkdir()
    text = SPECS[1].read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / "sma21.yaml").write_text(text, encoding="utf-8")
    (folder / "manufacturer.yaml").write_bytes(SPECS[0].read_bytes())
    return folder


@pytest.mark.slow
def test_diff_reports_another_range(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    no_wrap = "position_range: {wraps: false}"
    before = _in_folder(tmp_path / "before", (no_wrap, "position_range: {modulus: 2^48}"))
    main(["diff", str(before), str(_in_folder(tmp_path / "after"))])
    printed = " ".join(capsys.readouterr().out.split())
    assert f"frame wide_position_reply: position range: modulus {2**48} → none" in printed
    assert "frame wide_position_reply: position range: wraps yes → no" in printed


@pytest.mark.slow
def test_diff_reports_a_new_range(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The functions of C for the interface are replaced by functions for each reply, so the change is breaking."""
    layout = "        when: {data_id: [4, 11, 15]}\n"
    position_range = "        position_range: {modulus: 2^rs485_position_bits}\n"
    before = _in_folder(tmp_path / "before")
    after = _in_folder(tmp_path / "after", (layout, layout + position_range))
    main(["diff", str(before), str(after)])
    printed = " ".join(capsys.readouterr().out.split())
    assert "breaking frame position_reply: position range is new" in printed
