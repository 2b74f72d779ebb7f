"""Frames with bits that the common frame lacks: every master lists the possible settings, and names missing ones.

The values are from the documents of the masters, which the docstrings name, or from sums of the widths here.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.masters.order_code_facts import facts_of_order_code
from codewheel.masters.sheet import Master, load_masters, sheet
from codewheel.model import Device
from codewheel.one_line.spec import device_of_line
from codewheel.order_codes.labels import find_code
from test_conditions_of_masters import CRC, HIGH, SIEMENS, position, write_spec

Capture = pytest.CaptureFixture[str]
EVEN = "          - {name: parity, parity_of: [FIELDS]}"
ODD = EVEN.replace("]}", "], parity: odd}")


def sheets_of(capsys: Capture, folder: Path, *options: str) -> dict[str, dict[str, Any]]:
    """Return the sheets that the command prints as JSON, by the names of the masters."""
    main(["master", "EXAMPLE-X", "--specs", str(folder), "--json", *options])
    return {master["name"]: master for master in json.loads(capsys.readouterr().out)["masters"]}


def values_of(master: dict[str, Any]) -> dict[str, Any]:
    assert master["refusals"] == []
    return {setting["name"]: setting["value"] for setting in master["settings"]}


@pytest.fixture(scope="module")
def masters() -> dict[str, Master]:
    loaded, report = load_masters()
    assert not report
    return {master.name: master for master in loaded}


def device_of(folder: Path) -> Device:
    (device,), report = load_library([folder])
    assert not report
    return device


def test_the_example_of_siemens_in_gray_code(tmp_path: Path, masters: dict[str, Master]) -> None:
    """Function manual 12/2017, p. 154: frame length 34, MSB 33, LSB 6, Gray code, six special bits, a parity bit."""
    write_spec(tmp_path, SIEMENS, counts=1 << 17, turns=1 << 11)
    device = device_of(tmp_path)
    ssi = device.interface("ssi")
    gray_layout = replace(ssi.layouts[0], gray_of="position")
    gray_device = replace(device, interfaces=(replace(ssi, layouts=(gray_layout,)),))
    gray_sheet = sheet(
        masters["siemens_posinput"], facts_of_order_code(gray_device, find_code(gray_device, "EXAMPLE-X").variant)
    )
    assert {setting.name: setting.value for setting in gray_sheet.settings[:5]} == {
        "Frame length": 34,
        "Code type": "Gray",
        "Bit number of LSB of the position value": 6,
        "Bit number of MSB of the position value": 33,
        "Parity": "even",
    }


def test_other_masters_on_the_example_of_siemens(tmp_path: Path, capsys: Capture) -> None:
    """11 and 17 bits of position, 6 special bits and a parity bit are 35 bits, of which 7 are after the position.

    Galil, note 2438: multi-turn bits are the total bits less single-turn and status bits. LinuxCNC, hostmot2(9): all
    bits have a field, the last bit first, p is padding, f a bit field. Synapticon, p. 836: even parity is 2.
    """
    write_spec(tmp_path, SIEMENS, counts=1 << 17, turns=1 << 11)
    sheets = sheets_of(capsys, tmp_path)
    galil = values_of(sheets["galil_ssi"])
    assert (galil["si1"], galil["si2"], galil["si3"]) == (35, 17, 7)
    assert galil["si1"] - galil["si2"] - galil["si3"] == 11
    assert values_of(sheets["linuxcnc_hostmot2"])["ssi_chan_0"] == "ssi_chan_0=parity%1pspecial%6fposition%28me"
    synapticon = values_of(sheets["synapticon"])
    assert (synapticon["Frame size"], synapticon["Parity type"]) == (35, 2)
    assert (synapticon["Singleturn first bit position"], synapticon["Singleturn bits"]) == (11, 17)
    keb = values_of(sheets["keb_f6"])
    assert (keb["Singleturn resolution"], keb["Multiturn resolution"]) == (17, 11)
    assert "Other bits after the position are not read" in " ".join(sheets["keb_f6"]["notes"])
    # 35 bits are too many for these two, whatever they are.
    for name in ("omron_nx", "delta_as02hc"):
        assert all("at most" in refusal["reason"] for refusal in sheets[name]["refusals"])


DELTA_STATUS = """\
          - {name: multiturn, bits: 12, unit: revolutions}
          - {name: singleturn, bits: 13, unit: counts}
          - {name: status, bits: 3}
        join: {position: [multiturn, singleturn]}"""


@pytest.mark.parametrize(
    ("fields", "counts", "turns", "expected"),
    [
        # Example 1 prints no start of multi-turn data, and the length of all data.
        (
            position(25),
            1 << 25,
            1,
            {
                "Data Length (bits)": 25,
                "Multi-Turn Data Length (bits)": 0,
                "Single-Turn Data Length (bits)": 25,
                "Single-Turn Data Start Bit": 24,
                "Status Data Length (bits)": 0,
                "Parity Check": "No check",
            },
        ),
        (
            DELTA_STATUS,
            1 << 13,
            1 << 12,
            {
                "Multi-Turn Data Length (bits)": 12,
                "Multi-Turn Data Start Bit": 27,
                "Single-Turn Data Length (bits)": 13,
                "Single-Turn Data Start Bit": 15,
                "Status Data Length (bits)": 3,
                "Status Data Start Bit": 2,
            },
        ),
        (
            position(17, EVEN.replace("FIELDS", "position")),
            1 << 17,
            1,
            {
                "Multi-Turn Data Length (bits)": 0,
                "Single-Turn Data Length (bits)": 17,
                "Single-Turn Data Start Bit": 17,
                "Status Data Length (bits)": 0,
                "Parity Check": "Even parity check",
                "Parity Check Bit": 0,
                "Parity Check Start Bit": 17,
                "Parity Check Length (bits)": 17,
            },
        ),
    ],
)
def test_the_examples_of_delta(
    tmp_path: Path, capsys: Capture, fields: str, counts: int, turns: int, expected: dict[str, int | str]
) -> None:
    """AS Series Module Manual, p. 14-14 and 14-15, examples 1 to 3."""
    write_spec(tmp_path, fields, counts=counts, turns=turns)
    values = values_of(sheets_of(capsys, tmp_path, "--master", "delta_as02hc")["delta_as02hc"])
    assert {name: values[name] for name in expected} == expected


@pytest.mark.parametrize(
    ("extra_fields", "number", "note"),
    [
        ([EVEN.replace("FIELDS", "position")], 4 + 8, "does not say which bits the even parity covers"),
        ([ODD.replace("FIELDS", "position")], 8, "checks only even parity"),
        ([HIGH, EVEN.replace("FIELDS", "position, pfb")], 2 + 4 + 8, "does not say which bits"),
        (["          - {name: spare, bits: 2}"], 8, "are not read"),
        ([HIGH, "          - {name: spare, bits: 2}"], 8, "are not read"),
        (
            ["          - {name: spare, bits: 2}", EVEN.replace("FIELDS", "position, spare")],
            8,
            "does not check the parity bit, because other bits are between",
        ),
    ],
)
def test_parity_of_keb(tmp_path: Path, capsys: Capture, extra_fields: list[str], number: int, note: str) -> None:
    """ec42, p. 247: PFB at the end is 2, even parity check 4, serial right-justified 8. There is no odd parity."""
    write_spec(tmp_path, position(13, *extra_fields), counts=1 << 13)
    keb = sheets_of(capsys, tmp_path, "--master", "keb_f6")["keb_f6"]
    formats = [setting["value"] for setting in keb["settings"] if setting["name"] == "SSI data format"]
    assert [text.split()[0] for text in formats] == [str(number)]
    assert note in " ".join(keb["notes"])


@pytest.mark.parametrize(("parity", "number"), [("", 0), (ODD, 1), (EVEN, 2)])
def test_parity_of_synapticon(tmp_path: Path, capsys: Capture, parity: str, number: int) -> None:
    """SOMANET Circulo, p. 836: no parity is 0, odd 1, even 2."""
    write_spec(tmp_path, position(13, *filter(None, [parity.replace("FIELDS", "position")])), counts=1 << 13)
    values = values_of(sheets_of(capsys, tmp_path, "--master", "synapticon")["synapticon"])
    assert (values["Parity type"], values["Frame size"]) == (number, 13 + bool(parity))


SPARE = "          - {name: spare, bits: 1}"
LIFE = "          - {name: life, bits: 4}"


@pytest.mark.parametrize(
    "extra_fields",
    [
        [HIGH],
        [LIFE],
        [SPARE],
        [EVEN.replace("FIELDS", "position")],
        [ODD.replace("FIELDS", "position")],
        ["          - {name: crc, crc: crc_8}"],
        [HIGH, LIFE, SPARE, EVEN.replace("FIELDS", "position, pfb, life, spare")],
    ],
)
def test_no_master_refuses_an_encoder_for_a_field_after_the_position(
    tmp_path: Path, capsys: Capture, extra_fields: list[str]
) -> None:
    """Each of the SSI masters reads the position before any field, and lists at least its width."""
    more = CRC if "crc_8" in str(extra_fields) else ""
    write_spec(tmp_path, position(13, *extra_fields), counts=1 << 13, more=more)
    sheets = sheets_of(capsys, tmp_path)
    described = {name: master for name, master in sheets.items() if "for BiSS" not in str(master["refusals"])}
    assert len(described) == 8
    for name, master in described.items():
        values = values_of(master)
        assert 13 in values.values() or name in ("siemens_posinput", "linuxcnc_hostmot2"), name
        assert master["gaps"] == []


BISS = """\
    layouts:
      - name: single_cycle_data
        from: encoder
        channel: 1
        source: "1"
        fields:
FIELDS
        join: {position: [multiturn, singleturn]}
crcs:
  - {name: crc_6, width: 6, poly: 0x03, init: 0, refin: false, refout: false, xorout: 0x3f, source: "1"}
"""
TURNS = (
    "          - {name: multiturn, bits: 12, unit: revolutions}\n          - {name: singleturn, bits: 17, unit: counts}"
)
STATUS = (
    "          - {name: error, active: low, makes_position: not_usable, when_active: an error}\n"
    "          - {name: warning, active: low, makes_position: usable_with_warning, when_active: a warning}"
)
CRC_6 = "          - {name: crc, crc: crc_6}"


def write_biss_spec(folder: Path, *fields: str) -> None:
    write_spec(folder, position(13), counts=1 << 17, turns=1 << 12)
    path = folder / "example_x.yaml"
    text = path.read_text(encoding="utf-8").replace("interface: ssi", "interface: biss")
    head = text.partition("interfaces:\n")[0]
    clock = '    clock: {min_hz: 100000, max_hz: 10000000, source: "1"}\n'
    timeout = '    timeout: {rule: fixed, at_most_ns: 20000, source: "1"}\n'
    biss = f'interfaces:\n  biss:\n    source: "1"\n{clock}{timeout}' + BISS.replace("FIELDS", "\n".join(fields))
    path.write_text(head + biss, encoding="utf-8")


def test_a_life_counter_before_the_status_bits(tmp_path: Path, capsys: Capture) -> None:
    """12 + 17 + 6 + 2 bits without the CRC of 6. iC-MB3 and dsPIC33A get their number minus 1.

    EL5042: the offset skips bits between position and error. Synapticon, p. 833: any data can be in the payload.
    """
    write_biss_spec(tmp_path, TURNS, LIFE.replace("4", "6"), STATUS, CRC_6)
    sheets = sheets_of(capsys, tmp_path)
    assert values_of(sheets["ic_mb"])["SDLEN"] == 12 + 17 + 6 + 2 - 1
    assert values_of(sheets["microchip_dspic33a"])["SCDLENx"] == 12 + 17 + 6 + 2 - 1
    terminal = values_of(sheets["beckhoff_el5042"])
    assert [terminal[name] for name in ("Multiturn [Bit]", "Singleturn [Bit]", "Offset LSB Bit [Bit]")] == [12, 17, 6]
    assert values_of(sheets["synapticon"])["Frame size"] == 12 + 17 + 6
    text = "biss_chan_0=crc%6pnwarning%1bnerror%1blife%6fposition%29me"
    assert values_of(sheets["linuxcnc_hostmot2"])["biss_chan_0"] == text
    assert values_of(sheets["beckhoff_ax5000"])["Sensor mode: Number of additional data bits"] is None
    # The manual of the F5 and the F6 shows the whole data word, which has no room for it.
    for name in ("keb_f5", "keb_f6"):
        (refusal,) = sheets[name]["refusals"]
        assert refusal["reason"].endswith("without other bits. This encoder has 6 other bits after the position.")


def test_a_life_counter_after_the_status_bits(tmp_path: Path, capsys: Capture) -> None:
    """The EL5042 and the Synapticon expect error and warning directly before the CRC. An iC-MB3 reads any bits."""
    write_biss_spec(tmp_path, TURNS, STATUS, LIFE.replace("4", "6"), CRC_6)
    sheets = sheets_of(capsys, tmp_path)
    for name in ("beckhoff_el5042", "synapticon"):
        (refusal,) = sheets[name]["refusals"]
        assert refusal["reason"].endswith("This encoder has 6 other bits after the first status bit.")
    assert values_of(sheets["ic_mb"])["SDLEN"] == 12 + 17 + 2 + 6 - 1


def test_a_master_whose_description_does_not_mention_a_field(tmp_path: Path, capsys: Capture) -> None:
    """The moteus reads position and status, so the number of data bits is unknown. Its clock is not."""
    write_biss_spec(tmp_path, TURNS, LIFE, STATUS, CRC_6)
    moteus = sheets_of(capsys, tmp_path, "--master", "moteus")["moteus"]
    values = values_of(moteus)
    assert values["aux[12].bissc.data_bits"] is None
    assert (values["aux[12].bissc.crc_bits"], values["aux[12].bissc.rate_hz"]) == (6, 1_000_000)
    texts = {setting["name"]: setting["text"] for setting in moteus["settings"]}
    assert texts["aux[12].bissc.data_bits"] == "unknown: it depends on how the master handles 'life'"
    (gap,) = moteus["gaps"]
    assert gap["reason"] == "The description of this master does not say how it handles 'life' in the frame."
    assert main(["master", "EXAMPLE-X", "--specs", str(tmp_path), "--master", "moteus"]) == 0
    assert "does not say how it handles 'life' in the frame. *" in " ".join(capsys.readouterr().out.split())
    assert main(["master", "EXAMPLE-X", "--specs", str(tmp_path), "--master", "moteus", "--format", "conf_set"]) == 0
    printed = " ".join(capsys.readouterr().out.replace("#", " ").split())
    assert "Not in this file: aux[12].bissc.data_bits: unknown: it depends on how the master handles 'life'." in printed
    assert "conf set aux1.bissc.data_bits" not in printed


def test_a_field_between_the_parts_of_the_position(tmp_path: Path, capsys: Capture) -> None:
    """No master can read it, but the general block describes the frame.

    The exit code says that there are no settings.
    """
    fields = TURNS.replace("\n", f"\n{LIFE}\n", 1)
    write_biss_spec(tmp_path, fields, STATUS, CRC_6)
    assert main(["master", "EXAMPLE-X", "--specs", str(tmp_path)]) == 1
    printed = " ".join(capsys.readouterr().out.split())
    assert "Order multiturn 12, life 4, singleturn 17, error 1, warning 1, crc 6, most significant bit first" in printed
    reason = (
        "No master described here can read the position: the position is not in one piece: 'life' is sent within it."
    )
    assert printed.endswith(reason)
    assert sheets_of(capsys, tmp_path, "--master", "moteus")["moteus"]["refusals"][0]["reason"] == reason


def test_gray_code_over_more_than_the_position(tmp_path: Path, capsys: Capture) -> None:
    """Only a master that converts exactly these bits can read them."""
    extra = "        join: {sent: [multiturn, singleturn, life], position: [multiturn, singleturn]}"
    write_spec(tmp_path, f"{TURNS}\n{LIFE}\n{extra}", counts=1 << 17, turns=1 << 12)
    path = tmp_path / "example_x.yaml"
    text = path.read_text(encoding="utf-8").replace("        fields:\n", "        gray: {of: sent}\n        fields:\n")
    path.write_text(text.replace("output_code: binary", "output_code: gray"), encoding="utf-8")
    assert main(["master", "EXAMPLE-X", "--specs", str(tmp_path)]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "Code Gray, over other bits than the position" in printed
    sheets = sheets_of(capsys, tmp_path)
    for name in ("siemens_posinput", "galil_ssi", "keb_f6", "linuxcnc_hostmot2", "omron_nx", "delta_as02hc"):
        assert any(
            "Gray code over other bits than the position" in refusal["reason"] for refusal in sheets[name]["refusals"]
        ), name


def test_a_crc_that_is_sent_reflected(tmp_path: Path, capsys: Capture, masters: dict[str, Master]) -> None:
    """Masters that check the CRC cannot read it. Over SSI, the others read the position in front of it."""
    reflected = CRC.replace("refin: false, refout: false", "refin: true, refout: true")
    write_spec(tmp_path, position(13, "          - {name: crc, crc: crc_8}"), counts=1 << 13, more=reflected)
    sheets = sheets_of(capsys, tmp_path)
    assert values_of(sheets["siemens_posinput"])["Bit number of LSB of the position value"] == 8
    assert main(["master", "EXAMPLE-X", "--specs", str(tmp_path)]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "start value 0, in a form that masters cannot check, see below" in printed
    reason = "No master described here can check the CRC: 'crc_8' is not sent most significant bit first"
    assert reason in printed
    write_biss_spec(tmp_path, TURNS, STATUS, CRC_6)
    device = device_of(tmp_path)
    device = replace(device, crcs=tuple(replace(crc, refin=True, refout=True) for crc in device.crcs))
    (refusal,) = sheet(masters["moteus"], facts_of_order_code(device, find_code(device, "EXAMPLE-X").variant)).refusals
    assert refusal.reason.startswith(reason.replace("crc_8", "crc_6"))


def test_a_second_channel(tmp_path: Path, capsys: Capture) -> None:
    """Settings are for the channel with the position. The general block names the other."""
    write_biss_spec(tmp_path, TURNS, STATUS, CRC_6)
    assert main(["master", "EXAMPLE-X", "--specs", str(tmp_path)]) == 0
    assert "on channel" not in capsys.readouterr().out
    path = tmp_path / "example_x.yaml"
    text = path.read_text(encoding="utf-8")
    second = '      - {name: temperature, from: encoder, channel: 2, source: "1", fields: [FIELD, CRC]}\n'
    second = second.replace("FIELD", "{name: celsius, bits: 8}").replace("CRC", "{name: crc, crc: crc_6}")
    path.write_text(text.replace("crcs:\n", f"{second}crcs:\n"), encoding="utf-8")
    assert main(["master", "EXAMPLE-X", "--specs", str(tmp_path)]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "The encoder also sends 'temperature' on channel 2. These settings are for channel 1 only." in printed
    assert values_of(sheets_of(capsys, tmp_path, "--master", "moteus")["moteus"])["aux[12].bissc.data_bits"] == 29


def test_a_parity_bit_counts_constants() -> None:
    """The parity that a master checks is that of all bits, also of constants that are 1."""
    device, match = device_of_line("ssi:position=12,sign=1:1,parity=odd")
    assert facts_of_order_code(device, match.variant).words["parity"] == "odd"


@pytest.mark.parametrize(
    ("line", "note"),
    [
        ("ssi:unused=2,position=13", "Masters take 'unused_bits' as zero bits."),
        ("ssi:zero=2,position=13", ""),
        ("biss:position=32,warning,error,crc=6:0x43", "A warning bit is sent before the error bit."),
        ("biss:position=32,error,warning,crc=6:0x43", ""),
    ],
)
def test_bits_that_a_master_takes_for_others(line: str, note: str) -> None:
    device, match = device_of_line(line)
    notes = " ".join(facts_of_order_code(device, match.variant).notes)
    assert note in notes
    assert ("Masters take" in notes or "before the error bit" in notes) == bool(note)
