"""Clock by cable length: section 5.3 of the manuals for SSI, AN15 of iC-Haus (revision A3, table 1) for BiSS."""

from __future__ import annotations

import json
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.masters.text import cited


def data_with_settings(capsys: pytest.CaptureFixture[str], code: str, master: str, *more: str) -> dict[str, Any]:
    assert main(["master", code, "--master", master, "--json", *more]) == 0
    data: dict[str, Any] = json.loads(capsys.readouterr().out)
    return data | {"settings": {setting["name"]: setting for setting in data["masters"][0]["settings"]}}


@pytest.mark.parametrize(
    ("code", "metres", "below"),
    # 5.3: below 50 m less than 400 kHz, 100 m 300 kHz, 200 m 200 kHz. A cable of exactly 50 m is not below 50 m.
    [
        ("AMM5A21/65KBG1", "1", 400),
        ("AMM5A21/65KBG1", "49", 400),
        ("AMM5A21/65KBG1", "50", 300),
        ("AM3619/4096-GG", "99.5", 200),
        ("SMA21-GG1-0010", "120", 200),
    ],
)
def test_ssi(capsys: pytest.CaptureFixture[str], code: str, metres: str, below: int) -> None:
    clock = data_with_settings(capsys, code, "linuxcnc_hostmot2", "--cable", metres)["settings"]["frequency-khz"]
    assert (clock["bound"], clock["value"]) == ("below", below)


@pytest.mark.parametrize(
    ("code", "metres", "kilohertz"),
    # 10 MHz to 10 m, 5 MHz to 25 m, 2 MHz to 60 m, 200 kHz to 500 m;
    # AM36 allows at most 2 MHz (6.1), with any cable.
    [
        ("AMM5A21/65KSC1", "10", 10_000),
        ("AMM5A21/65KSC1", "10.1", 5_000),
        ("AMM5A21/65KSC1", "60", 2_000),
        ("SMA21-SC1-0002", "500", 200),
    ],
)
def test_biss(capsys: pytest.CaptureFixture[str], code: str, metres: str, kilohertz: int) -> None:
    clock = data_with_settings(capsys, code, "linuxcnc_hostmot2", "--cable", metres)["settings"]["frequency-khz"]
    assert (clock["bound"], clock["value"]) == ("at_most", kilohertz)


def test_a_list_of_clocks(capsys: pytest.CaptureFixture[str]) -> None:
    """Below 400 kHz the terminal has only 19, 250 kHz. The other master has 300 kHz, which is 2."""
    settings = data_with_settings(capsys, "AM3619/4096-GG", "beckhoff_el5042", "--cable", "30")["settings"]
    assert (
        settings["Clock Frequency, EL5042 and EP7041-4032"]["value"],
        settings["Clock Frequency, EJ5042"]["value"],
    ) == (19, 19)
    assert (
        data_with_settings(capsys, "AM3619/4096-GG", "omron_nx", "--cable", "30")["settings"]["Baud Rate"]["value"] == 2
    )


def test_without_a_cable_the_clock_says_what_it_is_for(capsys: pytest.CaptureFixture[str]) -> None:
    ssi = data_with_settings(capsys, "AMM5A21/65KBG1", "beckhoff_el5042")
    assert ssi["record"]["cable_lengths"][0] == {"metres": 50, "hz": 400_000, "is_below": True, "is_shorter": True}
    assert ssi["record"]["cable_errata"] == ["ssi_cable_400_m", "ssi_cable_50_m"]
    note = ssi["settings"]["Clock Frequency, EL5042 and EP7041-4032"]["note"]
    assert (
        "No row of the table in the encoder's manual allows this clock: its highest clock is below 400 kHz, for a "
        "cable shorter than 50 m." in note
    )
    biss = data_with_settings(capsys, "AMM5A21/65KSC1", "beckhoff_el5042")
    assert (
        biss["settings"]["Clock Frequency, EL5042 and EP7041-4032"]["note"]
        == "This clock frequency is suitable for a cable up to 10 m, according to the table in iC-Haus AN15, "
        "revision A3, for RS-422."
    )
    assert len(biss["record"]["cable_lengths"]) == 7
    assert biss["record"]["cable_errata"] == []


@pytest.mark.parametrize(
    ("arguments", "exit_code", "message"),
    [
        (
            ["AM3619/4096-GG", "--cable", "300"],
            1,
            "has shorter than 400 m: below 100 kHz, but the encoder needs at least 100 kHz",
        ),
        (["AM3619/4096-GG", "--cable", "400"], 1, "cable of 400 m: the table in the encoder's manual ends at 400 m"),
        (["AMM5A21/65KSC1", "--cable", "1001"], 1, "iC-Haus AN15, revision A3, for RS-422 ends at 1000 m"),
        (["AMM5A21/65KSC1", "--cable", "long"], 2, "'long' is not a length in metres, such as 30"),
        (["AMM5A21/65KSC1", "--cable", "0"], 2, "'0' is not a length in metres"),
        (["AMM5A21/65KSC1", "--cable", "nan"], 2, "'nan' is not a length in metres"),
        (["AMM5A21/65KSC1", "--cable", "inf"], 2, "'inf' is not a length in metres"),
    ],
)
def test_what_cannot_be_said(
    capsys: pytest.CaptureFixture[str], arguments: list[str], exit_code: int, message: str
) -> None:
    try:
        code = main(["master", *arguments])
    except SystemExit as stopped:
        code = int(stopped.code or 0)
    assert (code, message in " ".join(capsys.readouterr().err.split())) == (exit_code, True)


@pytest.mark.slow
def test_the_page_leads_to_the_erratum(pages: dict[str, str]) -> None:
    page = pages["docs/amm5-ssi-masters.md"]
    assert (
        "Errata about the clock for each cable length: "
        "[The clock limit for cables under 400 m is below the clock range]"
        "(amm5/errata.md#erratum-ssi_cable_400_m) · [The cable length table allows no cable from 400 kHz to 4 MHz]"
        "(amm5/errata.md#erratum-ssi_cable_50_m)"
    ) in page
    assert "| Clock by cable | shorter than 50 m: below 400 kHz, shorter than 100 m: below 300 kHz," in page
    biss_page = pages["docs/amm5-biss-masters.md"]
    assert "| Clock by cable | up to 10 m: 10 MHz, up to 25 m: 5 MHz, up to 60 m: 2 MHz," in biss_page


def test_sources_with_a_place_come_last() -> None:
    """The comma in a place cannot be taken for the one between two sources."""
    assert cited("man: h, l and g; driver") == "driver, man: h, l and g"
    assert cited("objects; supply; ep7041_x05") == "objects, supply, ep7041_x05"
