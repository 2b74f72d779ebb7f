"""Positions in several fields, fields and channels without bits for an order code, and the grade of the evidence.

The expected values are sums of the widths in the order codes of ``made/three_fields.yaml``: THREE-S-12x8x3 has 12, 8
and 3 bits, of which 11 are a revolution, and then two status bits.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.masters.encoder_facts import EncoderFacts
from codewheel.masters.order_code_facts import facts_of_order_code
from codewheel.masters.setting_values import fact_in_words
from codewheel.model import Biss, Device
from codewheel.order_codes.parameters import with_sent_layouts
from codewheel.order_codes.quantities import with_quantities
from test_conditions_of_masters import JOINED, write_spec

Capture = pytest.CaptureFixture[str]
MADE = Path(__file__).parent / "made"
EVIDENCE = "Evidence: uncorroborated (the facts have a single source, so do not rely on them)."
PLACEHOLDER = "1 value is still from the template, not from the manufacturer: interfaces.biss.clock."


@pytest.fixture(scope="module")
def made() -> dict[str, Device]:
    devices, report = load_library([MADE])
    assert not report
    return {device.name: device for device in devices}


def printed_by(capsys: Capture, *arguments: str) -> str:
    """Return what the command prints about the made-up specs, with single spaces."""
    main([*arguments, "--specs", str(MADE)])
    return " ".join(capsys.readouterr().out.split())


def master_data(capsys: Capture, order_code: str) -> dict[str, Any]:
    main(["master", order_code, "--specs", str(MADE), "--json"])
    data: dict[str, Any] = json.loads(capsys.readouterr().out)
    return data


def settings_by_master(capsys: Capture, order_code: str) -> dict[str, dict[str, Any]]:
    """Return the values of the settings of each master that can use the order code."""
    masters = [master for master in master_data(capsys, order_code)["masters"] if master["takes_it"]]
    return {master["name"]: {setting["name"]: setting["value"] for setting in master["settings"]} for master in masters}


def three(made: dict[str, Device], order_code: str) -> EncoderFacts:
    device = made["three_fields"]
    return facts_of_order_code(device, device.variant(order_code))


@pytest.mark.parametrize(
    ("widths", "parts"),
    [
        ("12x8x3", [("first", "multiturn", 12), ("second", "singleturn", 8), ("third", "singleturn", 3)]),
        ("24x8x3", [("first", "multiturn", 24), ("second", "singleturn", 8), ("third", "singleturn", 3)]),
        ("12x8x0", [("first", "multiturn", 12), ("second", "singleturn", 8)]),
        ("12x0x0", [("first", "multiturn", 12)]),
        ("14x0x9", [("first_turns", "multiturn", 12), ("first", "singleturn", 2), ("third", "singleturn", 9)]),
    ],
)
@pytest.mark.parametrize("output", ["S", "P", "B"])
def test_the_counts_decide_where_the_revolutions_end(
    made: dict[str, Device], output: str, widths: str, parts: list[tuple[str, str, int]]
) -> None:
    encoder_record = three(made, f"THREE-{output}-{widths}")
    status = [("error", "status", 1), ("warning", "status", 1)]
    last = {"S": [], "P": [("parity", "parity", 1)], "B": [("crc", "crc", 6)]}[output]
    assert [(part.name, part.role, part.bits) for part in encoder_record.frame_parts] == [*parts, *status, *last]
    assert encoder_record.obstacle == ""
    assert encoder_record.words["singleturn_codes"] == "all"
    assert encoder_record.words["parity"] == ("even" if output == "P" else "none")


def test_masters_on_a_position_in_three_fields(capsys: Capture) -> None:
    """OMRON counts from the first bit sent, Delta from the last bit, and both name the first bit of a number."""
    settings = settings_by_master(capsys, "THREE-S-12x8x3")
    terminal = settings["beckhoff_el5042"]
    assert [terminal[name] for name in ("Multiturn [Bit]", "Singleturn [Bit]", "Offset LSB Bit [Bit]")] == [12, 11, 2]
    delta = settings["delta_as02hc"]
    assert (delta["Multi-Turn Data Length (bits)"], delta["Single-Turn Data Length (bits)"]) == (12, 11)
    assert (delta["Multi-Turn Data Start Bit"], delta["Single-Turn Data Start Bit"]) == (24, 24 - 12)
    omron = settings["omron_nx"]
    assert (omron["Multi-turn Data Start Bit"], omron["Single-turn Data Start Bit"]) == (0, 12)
    assert (omron["Multi-turn Data Length"], omron["Single-turn Data Length"]) == (12, 11)
    assert settings["galil_ssi"]["si2"] == 11
    for name in ("keb_f6", "synapticon", "linuxcnc_hostmot2"):
        assert name in settings
    assert settings["linuxcnc_hostmot2"]["ssi_chan_0"] == "ssi_chan_0=nwarning%1bnerror%1bposition%23me"


def test_masters_of_biss_on_a_position_in_three_fields(capsys: Capture) -> None:
    settings = settings_by_master(capsys, "THREE-B-12x8x3")
    assert (settings["ti_c2000"]["positionMTBits"], settings["ti_c2000"]["positionSTBits"]) == (12, 11)
    assert settings["kollmorgen_akd2g"]["FB#.MULTITURNBITS"] == 12
    split_inside_a_field = settings_by_master(capsys, "THREE-B-14x0x9")
    assert split_inside_a_field == settings


@pytest.mark.parametrize(
    ("order_code", "position"),
    [("THREE-S-24x8x3", "positionlow%11lposition%24mh"), ("THREE-S-12x0x0", "position%12me")],
)
def test_a_position_is_two_numbers_at_most(capsys: Capture, order_code: str, position: str) -> None:
    """hostmot2(9): the parts of a position of more than 32 bits are l and h, the low and the high part."""
    settings = settings_by_master(capsys, order_code)["linuxcnc_hostmot2"]
    assert settings["ssi_chan_0"] == f"ssi_chan_0=nwarning%1bnerror%1b{position}"


def test_revolutions_that_end_inside_a_field(capsys: Capture) -> None:
    note = "'first' holds both parts of the position: the revolutions in its highest 12 bits and the rest below them."
    assert note in printed_by(capsys, "master", "THREE-B-14x0x9")
    assert "holds both parts" not in printed_by(capsys, "master", "THREE-B-12x8x3")


def test_fields_whose_counts_are_not_known(tmp_path: Path, capsys: Capture) -> None:
    """Without a measurement, no master gets a number of revolutions that is a guess."""
    write_spec(tmp_path, JOINED, counts=512, turns=16)
    path = tmp_path / "example_x.yaml"
    path.write_text(re.sub("measurement: .*\n", "", path.read_text(encoding="utf-8")), encoding="utf-8")
    assert main(["master", "EXAMPLE-X", "--specs", str(tmp_path), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)["record"]
    assert (facts["multiturn_bits"], facts["singleturn_bits"]) == (0, 4 + 9)
    (note,) = [note for note in facts["notes"] if "singleturn" in note]
    assert note.startswith("All bits of the position are listed as singleturn bits. Add the counts per revolution")


def test_a_channel_without_bits_is_absent(capsys: Capture) -> None:
    for command in ("master", "show"):
        assert "temperature_data" not in printed_by(capsys, command, "SECOND-B")
        assert "temperature_data" in printed_by(capsys, command, "SECOND-BT")
    assert "Data channels" not in printed_by(capsys, "show", "SECOND-B")
    assert "position_data and temperature_data in one frame" in printed_by(capsys, "show", "SECOND-BT")
    gaps = {code: [m["gaps"] for m in master_data(capsys, code)["masters"]] for code in ("SECOND-B", "SECOND-BT")}
    assert not any(gaps["SECOND-B"])
    assert any(gaps["SECOND-BT"])


def test_pages_and_data_lack_a_channel_without_bits(made: dict[str, Device], capsys: Capture) -> None:
    main(["show", "SECOND-B", "--specs", str(MADE), "--json"])
    interface = json.loads(capsys.readouterr().out)["interfaces"]["biss"]
    assert interface["layouts"] == ["position_data"]
    assert interface["channels"] is None
    device = made["second_channel"]
    names = {}
    for code in ("SECOND-B", "SECOND-BT"):
        page_device = with_quantities(device, device.variant(code))
        names[code] = [layout.name for layout in page_device.interface("biss").layouts]
    assert names == {"SECOND-B": ["position_data"], "SECOND-BT": ["position_data", "temperature_data"]}


def test_an_absent_channel_between_two_others(made: dict[str, Device]) -> None:
    device = made["second_channel"]
    biss = device.interface("biss")
    assert isinstance(biss, Biss)
    assert biss.channels is not None
    layouts = (*biss.layouts, replace(biss.layouts[0], name="third_data"))
    channels = replace(biss.channels, order=("position_data", "temperature_data", "third_data"))
    three_channels = replace(biss, layouts=layouts, channels=channels)
    sent = with_sent_layouts(three_channels, device.variant("SECOND-B").parameters)
    assert isinstance(sent, Biss)
    assert sent.channels is not None
    assert sent.channels.order == ("position_data", "third_data")
    assert with_sent_layouts(three_channels, device.variant("SECOND-BT").parameters) is three_channels


def test_grade_and_placeholders_next_to_settings(capsys: Capture) -> None:
    printed = printed_by(capsys, "master", "SECOND-B")
    assert f"{EVIDENCE[:-1]}. {PLACEHOLDER}" in printed
    assert EVIDENCE in printed_by(capsys, "master", "THREE-S-12x8x3")
    assert "still from the template" not in printed_by(capsys, "master", "THREE-S-12x8x3")
    data = master_data(capsys, "SECOND-B")
    assert (data["evidence"], data["placeholders"]) == ("uncorroborated", ["interfaces.biss.clock"])
    main(["master", "AMM5A21/65KSC1"])
    assert "Evidence" not in capsys.readouterr().out


@pytest.mark.parametrize(("master", "file_format"), [("beckhoff_el5042", "linuxcnc_ethercat"), ("moteus", "conf_set")])
def test_grade_and_placeholders_in_files(capsys: Capture, master: str, file_format: str) -> None:
    arguments = ("--master", master, "--format", file_format)
    printed = printed_by(capsys, "master", "SECOND-B", *arguments).replace("# ", "")
    assert f"{EVIDENCE} {PLACEHOLDER}" in printed
    main(["master", "AMM5A21/65KSC1", *arguments])
    assert "Evidence" not in capsys.readouterr().out


def test_grade_and_placeholders_on_pages_and_in_bulk_files(tmp_path: Path) -> None:
    assert main(["generate", str(MADE), "-o", str(tmp_path), "--target", "docs", "--target", "masters"]) == 0
    page = (tmp_path / "docs" / "second_channel-biss-masters.md").read_text(encoding="utf-8")
    assert f"{EVIDENCE} {PLACEHOLDER}" in page
    bulk = (tmp_path / "masters" / "moteus" / "conf_set" / "second_channel.cfg").read_text(encoding="utf-8")
    assert f"{EVIDENCE} {PLACEHOLDER}" in " ".join(bulk.replace("#", " ").split())
    index = (tmp_path / "masters" / "README.md").read_text(encoding="utf-8")
    assert "Second channel (uncorroborated)" in index


def test_words_of_a_manual(made: dict[str, Device]) -> None:
    encoder_record = three(made, "THREE-S-12x8x3")
    expected = {
        ("coding", "other"): "Gray code over other bits than the position",
        ("coding", "gray_with_status"): "Gray code over the position and the status bits",
        ("singleturn_codes", "some"): "2048 counts per revolution in 11 singleturn bits",
        ("status_active", "none"): "no status bits",
        ("parity", "odd"): "odd parity",
        ("movement", "linear"): "linear",
    }
    for (name, value), text in expected.items():
        changed = replace(encoder_record, words={**encoder_record.words, name: value})
        assert fact_in_words(name, changed) == text


def test_numbers_in_words(made: dict[str, Device]) -> None:
    """12 + 8 + 3 bits of position, 2 status bits and 6 bits of a CRC are 31 bits."""
    encoder_record = three(made, "THREE-B-12x8x3")
    expected = {
        "frame_bits": "31 bits in the frame",
        "bits_without_crc": "25 bits of data, status and others",
        "padding_left": "0 zero bits before the position",
        "crc_inverted": "an inverted CRC",
        "crc_start": "start value of the CRC: 0",
        "crc_polynomial": "CRC polynomial with its top bit: 0x43",
    }
    assert {name: fact_in_words(name, encoder_record) for name in expected} == expected
