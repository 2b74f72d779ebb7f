"""All forms of CRCs in C compute the same result: the form chosen by the parameters, with tables, and bit by bit."""

from __future__ import annotations

import random
from collections.abc import Mapping
from pathlib import Path

import pytest
from c_harness import MadeOnce, Run, devices_of, program_over
from codewheel.model import Device
from codewheel.reference import codec
from codewheel.reference.bits_and_values import compute_bits
from codewheel.targets import Library
from codewheel.targets.c.device import views_of
from codewheel.targets.c.files import generate
from codewheel.targets.python.files import generate as python_files
from test_c_codec import Table, check, on_the_wire, round_trips

#: Check values of the catalogue for CRCs over bytes, for the digits 1 to 9.
CATALOGUE = {
    "kermit": 0x2189,
    "iso_hdlc": 0xCBF43926,
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
def run_form(request: pytest.FixtureRequest, crcs: Device, made_once: MadeOnce) -> Run:
    return program_over(crcs, made_once, f"crcs {request.param}", *FORMS[request.param])


def test_check_values_of_the_catalogue(run_form: Run) -> None:
    check(run_form, [(f"CAJP crc {name} {b'123456789'.hex()}", f"0 {value}") for name, value in CATALOGUE.items()])


def test_words_are_encoded_and_decoded(crcs: Device, run_form: Run) -> None:
    pairs = round_trips(Table(crcs))
    names = {layout.name for layout in crcs.interface("biss").layouts}
    assert {line.split()[2] for line, _ in pairs if " decode word_" in line} == names
    check(run_form, pairs)


def test_every_flipped_bit_is_noticed(crcs: Device, run_form: Run) -> None:
    random_ = random.Random("flipped")
    pairs = []
    for name, variant, placed in Table(crcs).cases():
        if placed.crc_field is None:
            continue
        for bit in range(placed.bits):
            data = [field for field in placed.fields if field.field.carries_data]
            values = {field.name: random_.getrandbits(field.width) for field in data}
            number = codec.encode(crcs, placed, values) ^ 1 << bit
            pairs.append((f"{variant.code} decode {name} {on_the_wire(placed, number)}", "2"))
    check(run_form, pairs)


@pytest.mark.parametrize("name", ["biss_16", "smbus", "dense_32", "dense_12", "dense_3", "started_16"])
def test_any_number_of_bits(crcs: Device, run_form: Run, name: str) -> None:
    """The harness uses whole hexadecimal digits: 4 to 64 bits, or the bits before the CRC of the longest frame."""
    random_ = random.Random(name)
    pairs = []
    (view,) = (view for view in views_of(crcs) if view.context.interface.name == "biss")
    word = next(
        (codec.word_crc for codec in view.interface.codecs if codec.word_crc and codec.word_crc.crc.name == name), None
    )
    longest = 64 if word is None else word.word_bits - word.crc.width
    assert longest >= 31
    for digits in range(1, longest // 4 + 1):
        bits = 4 * digits
        numbers = [0, (1 << bits) - 1, *(random_.getrandbits(bits) for _ in range(4))]
        for number in numbers:
            expected = compute_bits(crcs.crc(name), number, bits)
            pairs.append((f"CASC crc {name} {number:0{digits}X}", f"0 {expected}"))
    check(run_form, pairs)


@pytest.mark.slow
def test_what_a_table_brings(crcs: Device) -> None:
    """There is a table only if needed. A CRC that can be folded has a table only on request."""
    files = generate(Library((crcs,)))
    text = files["c/include/test/crcs_biss.h"] + files["c/include/test/crcs_rs485.h"]
    assert text.count("#ifndef TEST_CRC_BITWISE\n/** Remainder of each byte for CRC ") == 13
    assert text.count("#ifdef TEST_CRC_TABLE\n/** Remainder of each byte for CRC ") == 2


@pytest.mark.slow
def test_a_crc_without_a_frame_has_no_function(every_device: Mapping[str, Device]) -> None:
    """No function would call it. Python has it, so that its users can check the examples of the manual."""
    device = every_device["shapes"]
    files = python_files(Library((device,)))
    module = next(text for name, text in files.items() if name.endswith("/shapes.py"))
    headers = "".join(generate(Library((device,))).values())
    for name in ("unused_5", "unused_8", "unused_reflected_4"):
        assert device.crc(name)
        assert f"def crc_{name}(" in module
        assert f"crc_{name}" not in headers
