"""The record of an order code for masters, compared with the manuals, and its refusals and unknown values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from codewheel.language.keys_of_masters import NUMBERS, WORDS
from codewheel.loading.library import load_library
from codewheel.masters.encoder_facts import EncoderFacts, Undecided
from codewheel.masters.frame_parts import NoMasterSettings
from codewheel.masters.order_code_facts import facts_of_order_code
from codewheel.masters.sheet import Master, sheet
from codewheel.model import Biss, Constant, Device, Field, Number
from codewheel.order_codes.labels import find_code
from codewheel.order_codes.parameters import with_registers
from codewheel.order_codes.reduction import for_interface

ROOT = Path(__file__).parents[2]
RecordOf = Callable[[str], EncoderFacts]
#: ASC85 with the 0 bit that its manual prints in the BiSS frame.
AS_PRINTED = {"zero_bit": "as_printed"}

#: SMA21-SC1-0050, from 6.2, 6.5 and the order code.
SMA21_WORDS = {
    "interface": "biss",
    "movement": "linear",
    "coding": "binary",
    "status_active": "low",
    "parity": "none",
    "singleturn_codes": "none",
}
SMA21_NUMBERS = {
    "multiturn_bits": 0,
    "singleturn_bits": 20,
    "position_bits": 20,
    "padding_left": 4,
    "padding_right": 0,
    "data_bits": 24,
    "status_bits": 2,
    "data_and_status_bits": 26,
    "crc_bits": 6,
    "other_bits_left": 0,
    "other_bits_right": 0,
    "other_bits_after_status": 0,
    "parity_bits": 0,
    "bits_without_crc": 26,
    "frame_bits": 32,
    "crc_polynomial": 67,
    "crc_polynomial_without_top_bit": 3,
    "crc_polynomial_without_last_1": 33,
    "crc_start": 0,
    "crc_inverted": 1,
    "clock_min_hz": 200_000,
    "clock_max_hz": 10_000_000,
    "timeout_us": 16,
    "busy_us": None,
    "pause_us": None,
    "counts_per_turn": None,
    "turns": None,
    "step_um": 50,
    "step_pm": 50_000_000,
    "supply_min_mv": 4750,
    "supply_max_mv": 5250,
}


def test_every_item(record_of: RecordOf) -> None:
    """SMA21-SC1-0050: 4 zero bits, 20 bits of 50 µm, nE, nW, CRC 6; clock and timeout of 6.5; 16 µs at most."""
    encoder_record = record_of("SMA21-SC1-0050")
    assert encoder_record.words == SMA21_WORDS
    assert encoder_record.numbers == SMA21_NUMBERS
    assert [(part.name, part.role, part.bits, part.active) for part in encoder_record.frame_parts] == [
        ("padding", "padding", 4, ""),
        ("position", "singleturn", 20, ""),
        ("error", "status", 1, "low"),
        ("warning", "status", 1, "low"),
        ("crc", "crc", 6, ""),
    ]
    assert set(encoder_record.words) == set(WORDS)
    assert tuple(encoder_record.numbers) == tuple(NUMBERS)


@pytest.mark.parametrize(
    ("code", "number_name", "value"),
    [
        ("AMM5A23/65KSC1", "timeout_us", 30),  # 1.5 periods of the slowest clock, 50 kHz
        ("AM3616/4096-I7", "timeout_us", 10),
        ("ASC8525/SC1 as_printed", "timeout_us", None),
        ("ASC8525/SC1 as_printed", "padding_right", 1),
        ("ASC8525/SC1 left_out", "padding_right", 0),  # as OnStepX reads it
        ("ASC8525/SC1 left_out", "frame_bits", 33),
        ("AMM5A17/1BG1", "pause_us", 20),
        ("AMM5A17/1BG1", "crc_polynomial", 0),
        ("SMA21-GG1-0010", "status_bits", 1),
        ("AM3616/4096-I7", "singleturn_bits", 20),
        ("AM3616/4096-BG", "singleturn_bits", 16),
        ("AM3616/4096-I7", "turns", 65536),
        ("AM3616/4096-I7", "supply_min_mv", 10_000),
        ("AM3616/4096-I7", "supply_max_mv", 30_000),
        ("SMA21-SC4-0050", "supply_min_mv", 5_000),
        ("ASC8525/SC2 left_out", "supply_min_mv", 10_000),
        ("ASC8525/BG1", "supply_max_mv", 5_250),
    ],
)
def test_items(record_of: RecordOf, code: str, number_name: str, value: int | None) -> None:
    assert record_of(code).numbers[number_name] == value


def test_status_bits_that_never_speak(record_of: RecordOf) -> None:
    """AM36 always sends error and warning as 1, which suits a master that expects active low status bits."""
    encoder_record = record_of("AM3616/4096-I7")
    assert [part.active for part in encoder_record.frame_parts if part.role == "status"] == ["", ""]
    assert encoder_record.words["status_active"] == "low"
    assert "error and warning: always 1, which a master treats as an inactive status bit." in encoder_record.notes


def holds_all(note: str, *phrases: str) -> bool:
    return all(phrase in note for phrase in phrases)


def test_registers_are_named(devices: Mapping[str, Device], record_of: RecordOf) -> None:
    notes = record_of("AM3616/4096-I7").notes
    assert any(holds_all(note, "(56h)", "(57h)", "widths", "factory defaults") for note in notes)
    assert any(holds_all(note, "(49h)", "code") for note in notes)
    whatever_cable = (
        "The clocks shown are the fastest that encoder and master support, regardless of cable length. "
        "Use --cable METRES to get the clocks for a cable length."
    )
    assert record_of("AMM5A23/65KSC1").notes == (whatever_cable,)
    device = devices["am36"]
    variant = find_code(device, "AM3616/4096-I7").variant
    # 0Ch = 12 bits of turns, 10h = 16 bits of position; bit 5 of the configuration cleared is Gray code.
    changed_record = facts_of_order_code(
        device, with_registers(device, variant, {0x57: 0x0C, 0x56: 0x10, 0x49: 0x00}), as_delivered=False
    )
    assert (
        changed_record.numbers["multiturn_bits"],
        changed_record.numbers["singleturn_bits"],
        changed_record.words["coding"],
    ) == (
        12,
        16,
        "gray",
    )
    assert not any("as delivered" in note for note in changed_record.notes)


@pytest.mark.parametrize(
    ("registers", "turns", "bits"),
    [
        ({0x57: 0x0D}, 8192, 13),  # 13 bits distinguish 2^13 revolutions, regardless of the default of 4E-4F
        ({0x57: 0x00}, 1, 0),
        ({0x57: 0x0A, 0x4E: 0x03, 0x4F: 0xE8}, 1000, 10),  # 3E8h = 1000 revolutions in 10 bits
    ],
)
def test_no_more_turns_than_bits(
    devices: Mapping[str, Device], masters: dict[str, Master], registers: dict[int, int], turns: int, bits: int
) -> None:
    """Drives that are set to the revolutions derive the width of the frame from them."""
    device = devices["am36"]
    encoder_record = facts_of_order_code(
        device, with_registers(device, find_code(device, "AM3616/4096-I7").variant, registers), as_delivered=False
    )
    assert (encoder_record.numbers["turns"], encoder_record.numbers["multiturn_bits"]) == (turns, bits)
    settings = {setting.name: setting.value for setting in sheet(masters["beckhoff_ax8000"], encoder_record).settings}
    assert settings["Number of distinguishable revolutions"] == turns


def test_any_number_of_turn_bits(devices: Mapping[str, Device], masters: dict[str, Master]) -> None:
    """FB1.ENCRES is 2 to the power of 32 less the multiturn bits: 2^(32 - 13) = 2^19 = 524288."""
    device = devices["am36"]
    encoder_record = facts_of_order_code(
        device, with_registers(device, find_code(device, "AM3616/4096-I7").variant, {0x57: 0x0D}), as_delivered=False
    )
    assert {setting.name: setting.value for setting in sheet(masters["kollmorgen_akd"], encoder_record).settings}[
        "FB1.ENCRES"
    ] == 524288


def test_gray_over_biss(devices: Mapping[str, Device], masters: dict[str, Master]) -> None:
    """Some masters can read it, others cannot, each for its own reason."""
    device = devices["am36"]
    gray = facts_of_order_code(
        device, with_registers(device, find_code(device, "AM3616/4096-I7").variant, {0x49: 0x00}), as_delivered=False
    )
    assert {setting.name: setting.value for setting in sheet(masters["beckhoff_el5042"], gray).settings}["Coding"] == 1
    assert (
        "Gray code over both parts cannot be specified. This encoder has Gray code."
        in sheet(masters["linuxcnc_hostmot2"], gray).refusals[0].reason
    )
    assert "This encoder has Gray code." in sheet(masters["ic_mb"], gray).refusals[0].reason


def test_rs485_has_no_master(record_of: RecordOf) -> None:
    with pytest.raises(NoMasterSettings, match="has the interface RS-485"):
        record_of("AMM5A23/65KJP1")


def test_what_is_open_is_not_decided(record_of: RecordOf) -> None:
    with pytest.raises(Undecided, match="'single_cycle_data' depends on zero_bit, which you must choose"):
        record_of("ASC8525/SC1")
    assert record_of("ASC8525/SC1 left_out").notes[0].startswith("With zero_bit=left_out: Not sent, as ")


def test_other_frames(devices: Mapping[str, Device]) -> None:
    """A field of another kind or at another place is other bits. Bits without a meaning are refused."""
    device = devices["asc85"]
    variant = find_code(device, "ASC8525/SC1").variant
    biss = device.interface("biss")
    layout = biss.layouts[0]

    def with_fields(*changed: Field) -> Device:
        changed_layout = replace(layout, fields=tuple(changed))
        interfaces = [interface for interface in device.interfaces if not isinstance(interface, Biss)]
        return replace(device, interfaces=(replace(biss, layouts=(changed_layout,)), *interfaces))

    position, zero, error, warning, crc = layout.fields
    for kind in (Number(), Constant()):
        changed_device = with_fields(position, zero, error, replace(warning, kind=kind), crc)
        roles = {
            part.name: part.role
            for part in facts_of_order_code(changed_device, variant, answers=AS_PRINTED).frame_parts
        }
        assert (roles["error"], roles["warning"], roles["crc"]) == ("status", "other", "crc")
    gap_record = facts_of_order_code(with_fields(position, error, warning, crc), variant, answers=AS_PRINTED)
    assert "the bits of 'single_cycle_data' above 'error' have no meaning" in gap_record.obstacle
    assert [part.name for part in gap_record.frame_parts] == ["position", "error", "warning", "crc"]
    bare = replace(with_fields(replace(position, name="angle"), zero, error, warning, crc), measurement=None)
    with pytest.raises(NoMasterSettings, match="no frame of BiSS C-mode carries 'position'"):
        facts_of_order_code(bare, variant, answers=AS_PRINTED)


def test_a_step_of_nanometres() -> None:
    """Expected widths: ecmcEL5042-Encoder-Renishaw_RL26BUT001B30V.cmd of ecmccfg. 5 nm is not a whole µm."""
    devices, report = load_library([Path(__file__).parents[2] / "specs" / "renishaw"])
    assert not report
    (device,) = (device for device in devices if device.name == "resolute_linear")
    numbers = facts_of_order_code(device, find_code(device, "RESOLUTE-LINEAR-26-005").variant).numbers
    widths = [numbers[name] for name in ("multiturn_bits", "singleturn_bits", "crc_polynomial", "step_um", "step_pm")]
    assert widths == [0, 26, 67, None, 5000]


def test_crc_of_another_form(devices: Mapping[str, Device]) -> None:
    device = devices["asc85"]
    variant = find_code(device, "ASC8525/SC1").variant
    for change in ({"refin": True, "refout": True}, {"xorout": 1}):
        crcs = tuple(replace(crc, **change) if crc.name == "biss_6" else crc for crc in device.crcs)
        changed_record = facts_of_order_code(replace(device, crcs=crcs), variant, answers=AS_PRINTED)
        assert changed_record.crc_obstacle.endswith("either plain or fully inverted.")
        assert changed_record.crc_obstacle in changed_record.notes
    straight = tuple(replace(crc, xorout=0) for crc in device.crcs)
    assert facts_of_order_code(replace(device, crcs=straight), variant, answers=AS_PRINTED).numbers["crc_inverted"] == 0


def test_a_register_of_another_interface_decides_the_code() -> None:
    """In words.yaml, bit gray of a BiSS register decides how SSI sends: its page has it by name, without an address."""
    (device,), report = load_library([ROOT / "tests" / "specs" / "words.yaml"])
    assert not report.problems
    ssi = next(variant for variant in device.variants if variant.interface == "ssi")
    notes = facts_of_order_code(for_interface(device, "ssi"), ssi).notes
    assert any(note.startswith("The code depends on registers: configuration.") for note in notes)
