"""The section "What to send": commands that only registers have, and errata next to the bytes that they change."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

import pytest
from codewheel.model import Procedure, WriteStep
from codewheel.say.commands_and_alarms import Commands


def sections(pages: Mapping[str, str], family: str, words: str) -> list[str]:
    """Return the section on each order code page of a family over an interface."""
    codes = [text for name, text in pages.items() if re.fullmatch(rf"docs/{family}/[^/]*[A-Z][^/]*\.md", name)]
    over_interface = [text for text in codes if f", {words}." in text]
    assert over_interface
    return [text.partition("## What to send\n")[2].partition("\n## ")[0] for text in over_interface]


@pytest.fixture(scope="module")
def icmu(pages: Mapping[str, str]) -> list[str]:
    return sections(pages, "icmu", "BiSS C-mode")


# iC-MU data sheet, p.57: the sixteen commands of the register 75h.
def test_the_page_names_the_command_register_and_its_commands(icmu: list[str]) -> None:
    commands = (
        "WRITE_ALL WRITE_OFF ABS_RESET NON_VER MT_RESET MT_VER SOFT_RESET SOFT_PRES SOFT_E2P_PRES I2C_COM EVENT_COUNT"
        " SWITCH CRC_VER CRC_CALC SET_MTC RES_MTC"
    ).split()
    for section in icmu:
        assert "Write a command to [75h CMD\\_MU](#register-command): " in section.replace("CMD_MU", "CMD\\_MU")
        assert re.findall(r"`([A-Z0-9_]+)`", section) == commands
        assert not re.search(r"\bno (?:preset|commands)\b", section)


# AM36 6.5 p.25: "set to 1 the bit 2" to enable the preset. The table and the default say 0.
def test_an_erratum_is_next_to_the_bytes_that_it_changes(pages: Mapping[str, str]) -> None:
    for section in sections(pages, "am36", "BiSS C-mode"):
        rows = [row for row in section.splitlines() if "49h: bit 2 = 0" in row]
        assert rows
        for row in rows:
            assert "One warning gives the Enable preset bit the opposite polarity" in row
            assert "#erratum-enable_preset_polarity" in row


def test_a_procedure_that_sends_no_request_may_be_a_preset() -> None:
    """Its title says so. The register has only a command whose name does not."""
    step = WriteStep(register="command", value_name="go", value=1)
    preset = Procedure(
        name="p1",
        title="Set the zero",
        interface="biss",
        arguments=(),
        precondition="",
        steps=(step,),
        result="",
        note="",
        source=(),
    )
    commands = Commands((preset,), registers=(), settings=(), requests=(), inputs=(), has_control_data=False)
    assert commands.may_preset
    assert not replace(commands, procedures=(replace(preset, title="Start"),)).may_preset


# AMM5 7.4.2 p.45: what data ID 8 resets is open.
def test_an_erratum_is_next_to_the_request_that_it_changes(pages: Mapping[str, str]) -> None:
    for section in sections(pages, "amm5", "RS-485"):
        row = next(row for row in section.splitlines() if row.startswith("| `C2`"))
        assert "⚠ open: [A table and a note disagree on what data ID 8 resets](#erratum-data_id_8_scope)" in row


def test_an_erratum_of_a_limit_is_not_next_to_the_bytes(pages: Mapping[str, str]) -> None:
    for section in sections(pages, "amm5", "BiSS C-mode"):
        names = set(re.findall(r"#erratum-(\w+)", section))
        assert names == {"preset_default_length"}


# AM36 4.4: the input sets the zero, so SSI pages do not say that there is no preset.
def test_an_input_contradicts_that_there_is_no_preset(pages: Mapping[str, str]) -> None:
    for section in sections(pages, "am36", "SSI"):
        assert "SSI only reads the position. Inputs: [Zero setting/Preset]" in section
        assert "no preset" not in section


# SMA21 has a section "Cable lengths", AMM5 has nothing about the length of an RS-485 cable.
@pytest.mark.parametrize(
    ("family", "line"),
    [
        ("amm5", "- The manual does not state the reply time or the cable length."),
        ("sma21", " For the cable length, see [times](#timings) and [characteristics](hardware.md#characteristics)."),
    ],
)
def test_a_text_about_the_cable_is_linked(pages: Mapping[str, str], family: str, line: str) -> None:
    codes = [text for name, text in pages.items() if name.startswith(f"docs/{family}/") and "RS-485" in text[:600]]
    page_count = sum("## Baud rate and times" in text for text in codes)
    assert sum(line in text for text in codes) == page_count > 0
