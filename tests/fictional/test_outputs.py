"""All four outputs of the fictional encoder are complete and strict, and decode the examples of its manual.

Numbers are typed from the manual.
"""

from __future__ import annotations

import csv
import json
import math
import os
import shlex
import subprocess
import sys
from importlib import resources
from pathlib import Path
from types import ModuleType

import pytest
from codewheel.dump.plain import device_dump
from codewheel.model import Device
from lxml import etree
from xml_reader import from_xml

WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wcast-qual -Wshadow -Werror".split()
#: 010011010010 01111111110011000 1 1 100101 0100010110000111
POSITION = 0x9A4FF98E54587


@pytest.mark.slow
def test_all_four_targets(generated: Path) -> None:
    paths = {path.relative_to(generated).as_posix() for path in generated.rglob("*") if path.is_file()}
    assert {
        "python/tolvarn_encoders/tv62.py",
        "c/include/tolvarn/tv62_biss.h",
        "biss/idbiss5476.xml",
        "biss/tolvarn-tv62.xml",
        "docs/tv62.md",
    } <= paths


# --------------------------------------------------------------------------------------------------------------- Python


@pytest.mark.exhaustive
def test_python_is_strict(generated: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--strict",
        "--no-incremental",
        str(generated / "python" / "tolvarn_encoders"),
    ]
    environment = {**os.environ, "MYPYPATH": str(generated / "python" / "runtime")}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stdout


def test_python_decodes_the_manual(tv62: ModuleType) -> None:
    word = tv62.lookup("TV62-M13-S1").decode(0x01FFFC18)
    assert (word.position, word.alarm, word.encode()) == (-1000, False, 0x01FFFC18)
    word = tv62.lookup("TV62-S17-S1").decode(0x80001234)
    assert (word.position, word.alarm) == (4660, True)
    encoder = tv62.lookup("TV62-M17-B1")
    frame = encoder.decode(POSITION)
    assert (frame.multiturn, frame.singleturn, frame.error, frame.warning, frame.life_counter) == (
        1234,
        65432,
        False,
        False,
        37,
    )
    assert frame.encode() == POSITION
    assert encoder.turns(frame.position) == 1234 + 65432 / 131072
    assert tv62.TemperatureData.decode(0b000000001110101100101).temperature == 235
    assert tv62.TemperatureData.decode(0b111111110110101010001) == tv62.TemperatureData(-150)


#: Words of the positions -1000, printed in the manual, and -2^24 and 2^24 - 1, which are neighbours in 25 bits.
ACROSS = {-1000: 0x01FFFC18, -16_777_216: 0x01000000, 16_777_215: 0x00FFFFFF}


def test_python_unwraps_negative_positions(tv62: ModuleType) -> None:
    encoder = tv62.lookup("TV62-M13-S1")
    assert (encoder.lowest, encoder.highest, encoder.modulus) == (-(1 << 24), (1 << 24) - 1, 1 << 25)
    assert [encoder.decode(word).position for word in ACROSS.values()] == [*ACROSS]
    assert (encoder.unwrap(0, -1000), encoder.unwrap(-(1 << 25), -1000)) == (-1000, -1000 - (1 << 25))
    assert encoder.unwrap(16_777_215, -16_777_216) == 16_777_216
    with pytest.raises(ValueError, match="-16777217"):
        encoder.unwrap(0, -16_777_217)
    assert (encoder.turns(-1000), encoder.degrees(-1000)) == (-1000 / 8192, (8192 - 1000) * 360 / 8192)
    table = encoder.decode_many([*ACROSS.values()]).with_columns(time=[0.0, 1.0, 1.5])
    assert table.unwrapped().tolist() == [-1000, -16_777_216, -16_777_217]
    assert table.velocity().tolist()[1:] == [-16_776_216, -2]
    si = table.in_si()
    assert si["radians"].tolist() == pytest.approx([7192 / 8192 * math.tau, 0, 8191 / 8192 * math.tau])
    assert si["radians_per_second"].tolist()[1:] == pytest.approx([-16_776_216 / 8192 * math.tau, -2 / 8192 * math.tau])


@pytest.mark.slow
def test_the_python_command_writes_negative_positions_in_si_units(generated: Path, tmp_path: Path) -> None:
    rows = "".join(f"{place / 2},0x{word:08X}\n" for place, word in enumerate(ACROSS.values()))
    (tmp_path / "log.csv").write_text("time,word\n" + rows, encoding="utf-8")
    command = [sys.executable, "-m", "tolvarn_encoders", "decode", "TV62-M13-S1", "log.csv", "--column", "word", "--si"]
    folders = (generated / "python", generated / "python" / "runtime")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, folders))}
    run = [*command, "-o", "out.csv"]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False, env=environment)
    assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stderr
    with (tmp_path / "out.csv").open(encoding="utf-8", newline="") as file:
        written_rows = list(csv.DictReader(file))
    assert [int(row["position"]) for row in written_rows] == [*ACROSS]
    assert float(written_rows[2]["radians_per_second"]) == pytest.approx(-2 * 1 / 8192 * math.tau)


def test_python_refuses_what_is_wrong(tv62: ModuleType) -> None:
    encoder = tv62.lookup("TV62-M17-B1")
    with pytest.raises(ValueError, match="CRC"):
        encoder.decode(POSITION ^ 1)
    with pytest.raises(ValueError, match="CRC"):
        tv62.TemperatureData.decode(0b111111110110100110001)
    with pytest.raises(ValueError):  # A negative position is preceded by zeros, not by copies of its sign.
        tv62.lookup("TV62-M13-S1").decode(-1000 & 0x7FFFFFFF)
    with pytest.raises(ValueError, match="-400"):
        tv62.LowerLimit(-401).encode()


def test_python_registers_and_procedure(tv62: ModuleType) -> None:
    assert tv62.UpperLimit.decode(bytes.fromhex("B6 03")).upper_limit == 950
    assert tv62.LowerLimit.decode(bytes.fromhex("06 FF")).lower_limit == -250
    assert tv62.LowerLimit(-250).encode() == bytes.fromhex("06 FF")
    assert tv62.Correction.decode(b"\xff").correction == -1
    assert {(register.bank, int(register.address)) for register in tv62.REGISTERS.values()} >= {
        (1, 0),
        (2, 0),
        (1, 4),
        (2, 4),
        (None, 0x40),
    }
    steps = list(tv62.set_preset(tv62.lookup("TV62-M17-B1"), 1_000_000))
    writes = [(int(step.address), step.value) for step in steps if type(step).__name__ == "Write"]
    assert writes == [(0x40, 0x01), (0x00, 0x00), (0x01, 0x0F), (0x02, 0x42), (0x03, 0x40), (0x48, 0x01)]
    assert [step.microseconds for step in steps if type(step).__name__ == "Wait"] == [50_000]
    steps = list(tv62.set_temperature_limits(800, -300))
    writes = [(int(step.address), step.value) for step in steps if type(step).__name__ == "Write"]
    assert writes == [(0x40, 0x02), (0x00, 0x20), (0x01, 0x03), (0x02, 0xD4), (0x03, 0xFE), (0x48, 0x02)]
    with pytest.raises(ValueError, match="-400"):
        tv62.set_temperature_limits(800, -401)


# -------------------------------------------------------------------------------------------------------------------- C

PROGRAM = r"""
#include "tolvarn/tv62_biss_procedures.h"
#include "tolvarn/tv62_biss_registers.h"
#include "tolvarn/tv62_biss_simulate.h"
#include "tolvarn/tv62_ssi_simulate.h"
#include <stdio.h>

#define CHECK(condition) \
    do { if (!(condition)) { printf("line %d: %s\n", __LINE__, #condition); failures++; } } while (0)

#define WORD(value) cw_word_of(value, tolvarn_tv62_biss_position_data_bits(TOLVARN_TV62_BISS_M17_B1))
int main(void)
{
    static const tolvarn_tv62_ssi m13 = TOLVARN_TV62_SSI_M13_S1;
    static const tolvarn_tv62_ssi s17 = TOLVARN_TV62_SSI_S17_S1;
    static const tolvarn_tv62_biss m17 = TOLVARN_TV62_BISS_M17_B1;
    static const uint8_t upper_bytes[2] = { 0xB6U, 0x03U };
    static const uint8_t lower_bytes[2] = { 0x06U, 0xFFU };
    static const uint8_t written[6][2] = {
        { 0x40U, 0x01U }, { 0x00U, 0x00U }, { 0x01U, 0x0FU }, { 0x02U, 0x42U }, { 0x03U, 0x40U }, { 0x48U, 0x01U }
    };
    static const uint8_t limits[6][2] = {
        { 0x40U, 0x02U }, { 0x00U, 0x20U }, { 0x01U, 0x03U }, { 0x02U, 0xD4U }, { 0x03U, 0xFEU }, { 0x48U, 0x02U }
    };
    static const uint8_t minus_one = 0xFFU;
    int failures = 0;
    tolvarn_tv62_ssi_frame word;
    tolvarn_tv62_biss_position_data position;
    tolvarn_tv62_biss_temperature_data temperature;
    tolvarn_tv62_biss_reg_upper_limit upper;
    tolvarn_tv62_biss_reg_lower_limit lower;
    cw_step steps[TOLVARN_TV62_BISS_SET_PRESET_STEPS_COUNT];
    cw_step more[TOLVARN_TV62_BISS_SET_TEMPERATURE_LIMITS_STEPS_COUNT];
    tolvarn_tv62_biss_reg_correction correction;
    uint8_t bytes[2];
    uint64_t raw = 0U;
    size_t count = 0U;
    size_t index;
    size_t writes = 0U;

    CHECK(tolvarn_tv62_ssi_decode(m13, 0x01FFFC18U, &word) == CW_OK);
    CHECK(word.position == -1000 && !word.alarm);
    CHECK(tolvarn_tv62_ssi_encode(m13, &word, &raw) == CW_OK && raw == 0x01FFFC18U);
    CHECK(tolvarn_tv62_ssi_decode(s17, 0x80001234U, &word) == CW_OK && word.position == 4660 && word.alarm);
    CHECK(tolvarn_tv62_ssi_decode(m13, 0x7FFFFC18U, &word) == CW_FAULT_CONSTANT);
    CHECK(tolvarn_tv62_biss_position_data_decode(m17, WORD(UINT64_C(0x9A4FF98E54587)), &position) == CW_OK);
    CHECK(position.multiturn == 1234U && position.singleturn == 65432U);
    CHECK(!position.error && !position.warning && position.life_counter == 37U);
    CHECK(tolvarn_tv62_biss_position_data_encode(m17, &position, &raw) == CW_OK && raw == UINT64_C(0x9A4FF98E54587));
    CHECK(tolvarn_tv62_biss_position_data_decode(m17, WORD(UINT64_C(0x9A4FF98E54586)), &position) == CW_FAULT_CRC);
    CHECK(tolvarn_tv62_biss_temperature_data_decode(m17, 0x1D65U, &temperature) == CW_OK);
    CHECK(temperature.temperature == 235);
    CHECK(tolvarn_tv62_biss_temperature_data_decode(m17, 0x1FED51U, &temperature) == CW_OK);
    CHECK(temperature.temperature == -150);
    CHECK(tolvarn_tv62_biss_temperature_data_decode(m17, 0x1FED31U, &temperature) == CW_FAULT_CRC);
    CHECK(tolvarn_tv62_biss_reg_upper_limit_decode(m17, upper_bytes, 2U, &upper) == CW_OK && upper.upper_limit == 950);
    CHECK(tolvarn_tv62_biss_reg_lower_limit_decode(m17, lower_bytes, 2U, &lower) == CW_OK);
    CHECK(lower.lower_limit == -250);
    CHECK(tolvarn_tv62_biss_reg_lower_limit_encode(m17, &lower, bytes, 2U) == CW_OK);
    CHECK(bytes[0] == 0x06U && bytes[1] == 0xFFU);
    lower.lower_limit = -400;
    CHECK(tolvarn_tv62_biss_reg_lower_limit_encode(m17, &lower, bytes, 2U) == CW_OK);
    lower.lower_limit = -401;
    CHECK(tolvarn_tv62_biss_reg_lower_limit_encode(m17, &lower, bytes, 2U) == CW_FAULT_RANGE);
    lower.lower_limit = 1201;
    CHECK(tolvarn_tv62_biss_reg_lower_limit_encode(m17, &lower, bytes, 2U) == CW_FAULT_RANGE);
    CHECK(tolvarn_tv62_biss_set_preset_steps(
        m17, 1000000U, steps, TOLVARN_TV62_BISS_SET_PRESET_STEPS_COUNT, &count) == CW_OK);
    for (index = 0U; index < count; index++) {
        if (steps[index].kind == CW_STEP_WRITE) {
            CHECK(writes < 6U && steps[index].address == written[writes][0] &&
                steps[index].value == written[writes][1]);
            writes++;
        }
    }
    CHECK(writes == 6U);
    CHECK(tolvarn_tv62_biss_set_temperature_limits_steps(m17, 800, -300, more,
        TOLVARN_TV62_BISS_SET_TEMPERATURE_LIMITS_STEPS_COUNT, &count) == CW_OK);
    for (index = 0U, writes = 0U; index < count; index++) {
        if (more[index].kind == CW_STEP_WRITE) {
            CHECK(writes < 6U && more[index].address == limits[writes][0] && more[index].value == limits[writes][1]);
            writes++;
        }
    }
    CHECK(writes == 6U);
    CHECK(tolvarn_tv62_biss_set_temperature_limits_steps(m17, 800, -401, more,
        TOLVARN_TV62_BISS_SET_TEMPERATURE_LIMITS_STEPS_COUNT, &count) == CW_FAULT_RANGE);
    CHECK(tolvarn_tv62_biss_reg_correction_decode(m17, &minus_one, 1U, &correction) == CW_OK);
    CHECK(correction.correction == -1);
    return failures == 0 ? 0 : 1;
}
"""


@pytest.mark.slow
@pytest.mark.parametrize(("compiler", "standard"), [("CC", "c99"), ("CC", "c11"), ("CXX", "c++11"), ("CXX", "c++17")])
def test_c_decodes_the_manual(generated: Path, tmp_path: Path, compiler: str, standard: str) -> None:
    command = shlex.split(os.environ.get(compiler) or {"CC": "cc", "CXX": "c++"}[compiler])
    source, program = tmp_path / ("main.c" if compiler == "CC" else "main.cpp"), tmp_path / "main"
    source.write_text(PROGRAM, encoding="utf-8")
    done = subprocess.run(
        [*command, f"-std={standard}", *WARNINGS, f"-I{generated / 'c' / 'include'}", str(source), "-o", str(program)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[:4000]
    ran = subprocess.run([str(program)], capture_output=True, text=True, check=False, timeout=20)
    assert ran.returncode == 0, ran.stdout


def test_c_names_the_banks(generated: Path) -> None:
    header = (generated / "c" / "include" / "tolvarn" / "tv62_biss_registers.h").read_text(encoding="utf-8")
    upper = header[header.index("TOLVARN_TV62_BISS_REG_UPPER_LIMIT_ADDRESS") :][:1200]
    assert "bank 2" in upper.lower() or "_UPPER_LIMIT_BANK 2" in upper


# ------------------------------------------------------------------------------------------------------------------ XML


def test_the_description_is_valid_and_whole(generated: Path, device: Device) -> None:
    biss = generated / "biss"
    checker = etree.XMLSchema(etree.parse(str(biss / "device-description.xsd")))
    data = (biss / "tolvarn-tv62.xml").read_bytes()
    assert checker.validate(etree.fromstring(data)), checker.error_log
    assert from_xml(data) == json.loads(json.dumps(device_dump(device)))
    channels = {layout["name"]: layout["channel"] for layout in from_xml(data)["layouts"]}
    assert channels == {"ssi_word": None, "position_data": 1, "temperature_data": 2}


def test_idbiss_is_valid(generated: Path) -> None:
    with (resources.files("codewheel.language") / "idbiss.reconstructed.dtd").open("rb") as file:
        checker = etree.DTD(file)
    data = (generated / "biss" / "idbiss5476.xml").read_bytes()
    root = etree.fromstring(data, etree.XMLParser(load_dtd=False, no_network=True))
    assert checker.validate(root), checker.error_log
    assert root.findtext(".//SCDS/CrcPoly") == "0x190D9"
    assert b"data channel 2" in data
    assert b"temperature_data" in data


# ----------------------------------------------------------------------------------------------------------------- docs


def test_the_page_tells_channels_banks_and_errata(generated: Path) -> None:
    folder = generated / "docs" / "tv62"
    names = ("biss", "biss-registers", "biss-procedures", "hardware", "errata")
    page = "".join((folder / f"{name}.md").read_text(encoding="utf-8") for name in names)
    flat = " ".join(page.lower().split())
    assert "data channel 1" in flat
    assert "data channel 2" in flat
    assert flat.count("- first select bank 1 with [`bank`](#register-bank).") == 2
    assert flat.count("- first select bank 2 with [`bank`](#register-bank).") == 3
    assert 'id="erratum-negative_temperature"' in page
    assert 'id="erratum-wait_after_bank"' in page
    assert "two's complement" in flat
    assert "±5 %" in page
    for name in ("ssi_word", "position_data", "temperature_data"):
        etree.parse(str(generated / "docs" / "tv62" / f"{name}.svg"))
