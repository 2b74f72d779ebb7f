"""Conditions of masters on the active level, Gray code, turns and length, with values from their documents."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.masters.sheet import sheet
from test_master_limits import record_with

RecordOf = Callable[[str], Any]

MANUFACTURER = """\
codewheel: 1
manufacturer: example
title: Name of the manufacturer
source: Cover
"""
SPEC = """\
codewheel: 1
device: example_x
manufacturer: example
title: Encoder
movement: rotary
evidence: {grade: manual, documents: {manual: all pages}}
manual: {title: Guide, revision: "1.0", language: en, history: [{revision: "1.0", changes: First issue.}]}
parameters: {}
order_code:
  pattern: "EXAMPLE-{output}"
  source: "1"
  parts:
    - name: output
      meaning: Interface
      values:
        X: {meaning: the interface, interface: ssi}
        Y: {meaning: the same interface, interface: ssi}
measurement: {of: position, counts_per_turn: COUNTS, turns: TURNS, source: "1"}
interfaces:
  ssi:
    source: "1"
    clock: {min_hz: 100000, max_hz: 1000000, source: "1"}
    alignment: msb_left
    output_code: CODE
    timings: [TIMINGS]
    cable_lengths: [{shorter_than_m: 100, below_hz: 300000, source: "1"}]
    layouts:
      - name: ssi_word
        from: encoder
        source: "1"
GRAY        fields:
FIELDS
"""
JOINED = """\
          - {name: multiturn, bits: 4, unit: revolutions}
          - {name: singleturn, bits: 9, unit: counts}
        join: {position: [multiturn, singleturn]}"""
PFB = "          - {name: pfb, active: LEVEL, makes_position: not_usable, when_active: supply too low}"
HIGH, LOW = PFB.replace("LEVEL", "high"), PFB.replace("LEVEL", "low")


def position(bits: int, *extra_fields: str) -> str:
    return "\n".join([f"          - {{name: position, bits: {bits}, unit: counts}}", *extra_fields])


def write_spec(
    folder: Path, fields: str, counts: int, turns: int = 1, code: str = "binary", timings: str = "", more: str = ""
) -> None:
    text = SPEC.replace("FIELDS", fields).replace("COUNTS", str(counts)).replace("TURNS", str(turns))
    gray = "        gray: {of: position}\n" if code == "gray" else ""
    text = text.replace("CODE", code).replace("GRAY", gray).replace("TIMINGS", timings)
    (folder / "example_x.yaml").write_text(text + more, encoding="utf-8")
    (folder / "manufacturer.yaml").write_text(MANUFACTURER, encoding="utf-8")


def settings_of(
    capsys: pytest.CaptureFixture[str], folder: Path, master: str, code: str = "EXAMPLE-X"
) -> dict[str, Any]:
    """Return the values of a master's settings by name, with its notes as ``notes`` and refusals as ``refusals``."""
    assert main(["master", code, "--specs", str(folder), "--master", master, "--json"]) in (0, 1)  # 1 if it refuses
    data = json.loads(capsys.readouterr().out)
    (sheet,) = data["masters"]
    settings = {setting["name"]: setting["value"] for setting in sheet["settings"]}
    return {
        **settings,
        "notes": " ".join(sheet["notes"]),
        "refusals": [refusal["reason"] for refusal in sheet["refusals"]],
    }


@pytest.mark.parametrize(
    ("flags", "number", "note"),
    [
        ((), 8, ""),
        ((HIGH,), 2 + 8, ""),
        ((LOW,), 8, "A Power Fail Bit is 0 in normal operation, but this bit is 1."),
        ((HIGH, HIGH.replace("pfb", "second")), 8, "It reads at most one Power Fail Bit."),
    ],
)
def test_power_fail_bit_of_keb(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], flags: tuple[str, ...], number: int, note: str
) -> None:
    """ec42, p. 247: PFB at the end is 2, serial right-justified is 8. The bit is 1 for an error and not among ec40."""
    write_spec(tmp_path, position(13, *flags), counts=1 << 13)
    settings = settings_of(capsys, tmp_path, "keb_f6")
    assert str(settings["SSI data format"]).split()[0] == str(number)
    assert settings["Singleturn resolution"] == 13
    assert ("PFB at end" in settings["SSI data format"]) == (number == 10)
    assert note in settings["notes"]
    assert "not read" not in settings["notes"] or note


def test_gray_code_without_the_power_fail_bit_of_keb(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """P. 247: Gray code is 16. The drive does not support a position in Gray code with a bit outside the code."""
    write_spec(tmp_path, position(13, HIGH), counts=1 << 13, code="gray")
    settings = settings_of(capsys, tmp_path, "keb_f6")
    assert settings["SSI data format"] == "24 (serial right-justified, Gray, no PFB)"
    assert "the drive cannot read the bit" in settings["notes"]


def test_power_fail_bit_in_the_gray_code_of_keb(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], masters: Any, record_of: RecordOf
) -> None:
    """P. 247: if the data word is Gray coded, the PFB must be as well. PFB at end 2, format 8, Gray code 16."""
    write_spec(tmp_path, position(13, HIGH, "        join: {word: [position, pfb]}"), counts=1 << 13, code="gray")
    spec = tmp_path / "example_x.yaml"
    spec.write_text(spec.read_text(encoding="utf-8").replace("gray: {of: position}", "gray: {of: word}"), "utf-8")
    settings = settings_of(capsys, tmp_path, "keb_f6")
    assert settings["SSI data format"].split()[0] == str(2 + 8 + 16)
    for master in ("omron_nx", "siemens_posinput", "synapticon", "linuxcnc_hostmot2", "galil_ssi", "beckhoff_el5042"):
        assert settings_of(capsys, tmp_path, master)["refusals"], master
    low = record_with(record_of("AM3616/4096-GG"), coding="gray_with_status", status_active="low", status_bits=1)
    assert [refusal.reason for refusal in sheet(masters["keb_f6"], low).refusals] == [
        "A Power Fail Bit is 1 for an error. This encoder has status bits that are active low."
    ]


@pytest.mark.parametrize(
    ("fields", "counts", "turns", "code", "resolution"),
    [
        (position(9), 512, 1, "gray", 0),
        (position(9), 512, 1, "binary", 0),
        (position(9), 360, 1, "binary", 360),
        (JOINED, 512, 16, "binary", 0),
        (JOINED, 512, 16, "gray", 0),
    ],
)
def test_encoder_resolution_of_omron(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    fields: str,
    counts: int,
    turns: int,
    code: str,
    resolution: int,
) -> None:
    """W524: 0 is 2 to the power of the single-turn bits (p. 7-42). Turns are multiplied by it (p. 7-47)."""
    write_spec(tmp_path, fields, counts, turns, code)
    assert settings_of(capsys, tmp_path, "omron_nx")["Encoder Resolution"] == resolution


def test_remainder_gray_code_of_omron(masters: Any, record_of: RecordOf) -> None:
    """W524 p. 7-46: a singleturn encoder has its resolution, a multiturn encoder in Gray code must have 0."""
    encoder = record_of("AM3616/4096-GG")
    single = record_with(encoder, multiturn_bits=0, singleturn_bits=9, counts_per_turn=360, singleturn_codes="some")
    values = {setting.name: setting.value for setting in sheet(masters["omron_nx"], single).settings}
    assert values["Encoder Resolution"] == 360
    multi = record_with(encoder, singleturn_bits=9, counts_per_turn=360, singleturn_codes="some")
    (refusal,) = sheet(masters["omron_nx"], multi).refusals
    assert refusal.reason.startswith("For a multiturn encoder with Gray code, Encoder Resolution must be 0.")
    unknown = record_with(single, counts_per_turn=None, singleturn_codes="unknown")
    settings = sheet(masters["omron_nx"], unknown).settings
    (setting,) = [setting for setting in settings if setting.name == "Encoder Resolution"]
    assert (setting.value, setting.text) == (None, "unknown: not in the encoder's spec (counts per revolution)")


def test_revolutions_without_bits(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A position of 16 * 360 = 5760 counts in 13 bits is not 4 bits of revolutions and 9 bits of an angle."""
    write_spec(tmp_path, position(13), counts=360, turns=16)
    assert main(["master", "EXAMPLE-X", "--specs", str(tmp_path)]) == 1
    printed = " ".join(capsys.readouterr().out.split())
    assert "'position' has 360 counts per revolution, so no bits of it are the revolutions." in printed


@pytest.mark.parametrize("master", ["keb_f6", "synapticon", "linuxcnc_hostmot2"])
def test_resolution_in_bits(tmp_path: Path, capsys: pytest.CaptureFixture[str], master: str) -> None:
    """With 9 bits, these masters compute with 2^9 = 512 counts per revolution, which is wrong for 360."""
    write_spec(tmp_path, position(9), counts=360)
    (reason,) = settings_of(capsys, tmp_path, master)["refusals"]
    assert reason.endswith("This encoder has 360 counts per revolution in 9 singleturn bits.")
    write_spec(tmp_path, position(9), counts=512)
    assert settings_of(capsys, tmp_path, master)["refusals"] == []


@pytest.mark.parametrize(("bits", "msb_bit"), [(31, 30), (32, None)])
def test_longest_position_of_siemens(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], bits: int, msb_bit: int | None
) -> None:
    """P. 143: the bit numbers of MSB and LSB differ by less than 31, so that 31 bits are 30 to 0."""
    write_spec(tmp_path, position(bits), counts=1 << bits)
    settings = settings_of(capsys, tmp_path, "siemens_posinput")
    assert settings.get("Bit number of MSB of the position value") == msb_bit
    assert bool(settings["refusals"]) == (msb_bit is None)


@pytest.mark.parametrize(("code", "multiturn"), [("SMA21-SC1-0050", 16), ("AMM5A17/1SC1", 0)])
def test_linear_encoder_on_the_ax5000(values_of: Any, code: str, multiturn: int) -> None:
    """Parameter channel of the BiSS C description: 16 for a linear encoder, the multiturn bits of a rotary encoder."""
    assert values_of("beckhoff_ax5000", code)["Bit resolution multiturn position"] == multiturn


def test_level_of_the_status_bits_of_the_el5042(sheet_of: Any) -> None:
    notes = " ".join(sheet_of("beckhoff_el5042", "AMM5A17/1SC1").notes)
    assert "says that they come directly from the encoder and also that they are active high" in notes


ERRATUM = """\
errata:
  - name: cable
    title: Two clocks are printed for one cable
    source: "1"
    printed: 200 kHz
    used: Below 300 kHz up to 100 m
    why: The table says so
    status: settled
    severity: wrong_limit
    only: EXAMPLE-Y
    affects: [interfaces.ssi.cable_lengths]
"""


def test_facts_of_other_order_codes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A pause of 20 µs and an erratum that apply to one order code each are not used for the other code."""
    pause = "{name: pause, symbol: Tp, meaning: Pause, at_least_us: 20, only: EXAMPLE-X, source: '1'}"
    write_spec(tmp_path, position(13), counts=1 << 13, timings=pause, more=ERRATUM)
    records = {}
    for code in ("EXAMPLE-X", "EXAMPLE-Y"):
        assert main(["master", code, "--specs", str(tmp_path), "--json"]) == 0
        records[code] = json.loads(capsys.readouterr().out)["record"]
    assert {code: record["pause_us"] for code, record in records.items()} == {"EXAMPLE-X": 20, "EXAMPLE-Y": None}
    assert {code: record["cable_errata"] for code, record in records.items()} == {
        "EXAMPLE-X": [],
        "EXAMPLE-Y": ["cable"],
    }


def test_pages_name_the_order_codes_of_a_fact(tmp_path: Path) -> None:
    """Codes that are identical for software share a page, which says to which of them a time, state or pin applies."""
    specs, output = tmp_path / "specs", tmp_path / "made"
    specs.mkdir()
    timings = (
        "{name: pause_x, symbol: Tp, meaning: Pause, at_least_us: 20, only: EXAMPLE-X, source: '1'}, "
        "{name: pause_y, symbol: Tp, meaning: Pause, at_least_us: 90, only: EXAMPLE-Y, source: '1'}"
    )
    more = """\
connectors:
  - name: plug
    kind: connector
    title: M12
    contacts: [{contact: "1", signal: Vdc}, {contact: "2", signal: Spare, only: EXAMPLE-Y}]
    source: "1"
leds:
  - name: led
    title: LED
    states: [{state: red, meaning: Error, only: EXAMPLE-Y}, {state: off, meaning: Good}]
    source: "1"
"""
    write_spec(specs, position(13), counts=1 << 13, timings=timings, more=more)
    assert main(["generate", str(specs), "-o", str(output), "--target", "docs"]) == 0
    pages = {path.stem: path.read_text(encoding="utf-8") for path in output.rglob("*.md")}
    page = next(text for stem, text in pages.items() if stem == "EXAMPLE-X")
    for phrase in (
        "Pause between two words: at least 20 µs (only with EXAMPLE-X)",
        "Pause between two words: at least 90 µs (only with EXAMPLE-Y)",
        "| 2 | Spare <small>(only EXAMPLE-Y)</small> |",
        "| at least 90 µs (only with EXAMPLE-Y) |",
        "| red | Error. This applies only to `EXAMPLE-Y`. |",
    ):
        assert phrase in page, phrase
    assert "| at least 90 µs (only with EXAMPLE-Y) |" in pages["ssi"]
    picture = next(text for text in map(Path.read_text, output.rglob("*timing*.svg")))
    assert "Tp, at least 20 µs (only with EXAMPLE-X), at least 90 µs (only with EXAMPLE-Y)" in picture


SIEMENS = """\
          - {name: multiturn, bits: 11, unit: revolutions}
          - {name: singleturn, bits: 17, unit: counts}
          - {name: special, bits: 6}
          - {name: parity, parity_of: [multiturn, singleturn, special]}
        join: {position: [multiturn, singleturn]}"""


def test_special_bits_and_parity_of_siemens(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The example on p. 154: 34 bits with the position in 33 to 6, six special bits, then an even parity bit.

    The position of the example is in Gray code, over which a spec has no parity. The numbers are the same in binary.
    """
    write_spec(tmp_path, SIEMENS, counts=1 << 17, turns=1 << 11)
    settings = settings_of(capsys, tmp_path, "siemens_posinput")
    assert {name: settings[name] for name in list(settings)[:5]} == {
        "Frame length": 34,
        "Code type": "Dual",
        "Bit number of LSB of the position value": 6,
        "Bit number of MSB of the position value": 33,
        "Parity": "even",
    }
    assert "special bits, which the module ignores" in settings["notes"]
    assert settings_of(capsys, tmp_path, "beckhoff_el5042")["Offset LSB Bit [Bit]"] == 6 + 1


DELTA = """\
          - {name: multiturn, bits: 12, unit: revolutions}
          - {name: singleturn, bits: 13, unit: counts}
          - {name: status, bits: 3}
        join: {position: [multiturn, singleturn]}"""


def test_status_data_of_delta(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Example 2 of the AS02HC, p. 14-15: 12 + 13 bits down to b3, then 3 bits of status data. Bit 0 is sent last."""
    write_spec(tmp_path, DELTA, counts=1 << 13, turns=1 << 12)
    omron = settings_of(capsys, tmp_path, "omron_nx")
    status = (omron["Valid Data Length"], omron["Status Data Start Bit"], omron["Status Data Length"])
    assert status == (28, 12 + 13, 3)
    siemens = settings_of(capsys, tmp_path, "siemens_posinput")
    assert (siemens["Frame length"], siemens["Bit number of LSB of the position value"]) == (28, 3)


def test_parity_of_delta(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Example 3 of the AS02HC: 17 bits of position and an even parity bit over these 17."""
    write_spec(tmp_path, position(17, "          - {name: parity, parity_of: [position]}"), counts=1 << 17)
    settings = settings_of(capsys, tmp_path, "siemens_posinput")
    assert (settings["Frame length"], settings["Bit number of MSB of the position value"]) == (17, 16)
    assert settings["Parity"] == "even"
    omron = settings_of(capsys, tmp_path, "omron_nx")
    assert (omron["Single-turn Data Length"], omron["Valid Data Length"], omron["Parity Check"]) == (17, None, None)


@pytest.mark.parametrize(
    "parity",
    [
        "{name: parity, parity_of: [position], over: odd_bits}",
        "{name: parity, parity_of: [singleturn], note: It leaves multiturn out}",
    ],
)
def test_parity_over_a_part_of_the_frame(tmp_path: Path, capsys: pytest.CaptureFixture[str], parity: str) -> None:
    """The modules check the parity of the whole frame, so that a parity over a part of its bits is a special bit."""
    joined = JOINED.replace("        join:", f"          - {parity}\n        join:")
    fields = joined if "singleturn" in parity else position(13, f"          - {parity}")
    counts, turns = (512, 16) if fields == joined else (1 << 13, 1)
    write_spec(tmp_path, fields, counts=counts, turns=turns)
    settings = settings_of(capsys, tmp_path, "siemens_posinput")
    assert (settings["Frame length"], settings["Bit number of LSB of the position value"], settings["Parity"]) == (
        14,
        1,
        "none",
    )


@pytest.mark.parametrize(
    ("before", "after", "bits_left", "bits_right", "padding"),
    [
        (["{name: life, bits: 4}"], [], 4, 0, 0),
        ([HIGH.strip()[2:]], ["{name: zero, bits: 2, unused: 0}"], 1, 0, 2),
        ([], ["{name: life, bits: 4}", "{name: zero, bits: 2, unused: 0}"], 0, 4 + 2, 0),
    ],
)
def test_other_bits(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    before: list[str],
    after: list[str],
    bits_left: int,
    bits_right: int,
    padding: int,
) -> None:
    """The record of a frame with bits that the common frame lacks is shown, and its bits are counted by side."""
    fields = [*before, "{name: position, bits: 13, unit: counts}", *after]
    write_spec(tmp_path, "\n".join(f"          - {field}" for field in fields), counts=1 << 13)
    assert main(["master", "EXAMPLE-X", "--specs", str(tmp_path), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)["record"]
    counted = (record["other_bits_left"], record["other_bits_right"], record["padding_right"], record["frame_bits"])
    assert counted == (bits_left, bits_right, padding, 13 + bits_left + bits_right + padding)


CRC = """\
crcs:
  - {name: crc_8, width: 8, poly: 0x07, init: 0, refin: false, refout: false, xorout: 0, source: "1"}
"""


def test_crc_over_ssi(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Bits of a CRC after the position are below it, so that they are not part of the position."""
    write_spec(tmp_path, position(13, "          - {name: crc, crc: crc_8}"), counts=1 << 13, more=CRC)
    siemens = settings_of(capsys, tmp_path, "siemens_posinput")
    assert (siemens["Frame length"], siemens["Bit number of LSB of the position value"]) == (13 + 8, 8)
    assert siemens["Bit number of MSB of the position value"] == 20
    assert settings_of(capsys, tmp_path, "beckhoff_el5042")["Offset LSB Bit [Bit]"] == 8
    galil = settings_of(capsys, tmp_path, "galil_ssi")
    assert (galil["si1"], galil["si2"], galil["si3"]) == (13 + 8, 13, 8)
