"""CRCs in C in each of their forms: the one that the parameters give, with tables, and bit by bit."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from c_harness import Run, compile_c, devices_of, runner, source, write
from codewheel import codec
from codewheel.crc import compute_bits
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c import generate
from test_c_codec import Table, check, on_the_wire, round_trips

#: Check values of the catalogue, over the digits 1 to 9, of the CRCs over bytes.
CATALOGUE = {
    "kermit": 0x2189,
    "iso_hdlc": 0xCBF43926,
    "usb": 0x19,
    "g_704": 0x06,
    "ble": 0xC25A56,
    "autosar": 0xDF,
    "ibm_3740": 0x29B1,
    "gsm_40": 0xD4164FC646,
}
FORMS = {"as given": [], "tables": ["-DTEST_CRC_TABLE"], "bitwise": ["-DTEST_CRC_BITWISE"]}


@pytest.fixture(scope="module")
def crcs() -> Device:
    (device,) = devices_of(Path(__file__).resolve().parent / "specs" / "crcs.yaml")
    return device


@pytest.fixture(scope="module", params=FORMS)
def run_form(request: pytest.FixtureRequest, crcs: Device, tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("form")
    command = ["gcc", "-std=c99", "-O1", "-fsanitize=undefined,address", "-fno-sanitize-recover=all", *FORMS[request.param]]
    return runner(compile_c(command, source(crcs), folder, write(folder, (crcs,))))


def test_check_values_of_the_catalogue(run_form: Run) -> None:
    check(run_form, [(f"CAJP crc {name} {b'123456789'.hex()}", f"0 {value}") for name, value in CATALOGUE.items()])


def test_words_are_encoded_and_decoded(crcs: Device, run_form: Run) -> None:
    pairs = round_trips(Table(crcs))
    assert {line.split()[2] for line, _ in pairs if " decode word_" in line} == {layout.name for layout in crcs.interface("biss").layouts}
    check(run_form, pairs)


def test_every_flipped_bit_is_noticed(crcs: Device, run_form: Run) -> None:
    random_ = random.Random("flipped")
    pairs = []
    for name, variant, placed in Table(crcs).cases():
        if placed.layout.crc_field is None:
            continue
        for bit in range(placed.bits):
            values = {item.name: random_.getrandbits(item.width) for item in placed.fields if item.field.carries_data}
            number = codec.encode(crcs, placed, values) ^ 1 << bit
            pairs.append((f"{variant.code} decode {name} {on_the_wire(placed, number)}", "2"))
    check(run_form, pairs)


@pytest.mark.parametrize("name", ["biss_16", "smbus", "dense_32", "dense_12", "dense_3", "started_16"])
def test_any_number_of_bits(crcs: Device, run_form: Run, name: str) -> None:
    """The harness gives whole hexadecimal digits: 4 to 64 bits."""
    random_ = random.Random(name)
    pairs = []
    for digits in range(1, 17):
        for number in (0, (1 << 4 * digits) - 1, *(random_.getrandbits(4 * digits) for _ in range(4))):
            pairs.append((f"CASC crc {name} {number:0{digits}X}", f"0 {compute_bits(crcs.crc(name), number, 4 * digits)}"))
    check(run_form, pairs)


def test_what_a_table_brings(crcs: Device) -> None:
    """No table without need: the one of a CRC that folds only where it is asked for."""
    text = generate(Library((crcs,)))["c/include/test/crcs.h"]
    assert text.count("#ifndef TEST_CRC_BITWISE\n/* The table of CRC ") == 15
    assert text.count("#ifdef TEST_CRC_TABLE\n/* The table of CRC ") == 2
