"""The command and the pages from a user's view."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from codewheel.commands.cli import main
from codewheel.masters.order_code_facts import facts_of_order_code
from codewheel.masters.sheet import SettingsSheet, shipped_masters
from codewheel.masters.text import sheet_text
from codewheel.model import Device
from codewheel.order_codes.labels import find_code
from codewheel.targets import Library
from codewheel.targets.docs import masters_page
from codewheel.targets.docs.files import generate

ROOT = Path(__file__).parents[2]
SheetOf = Callable[[str, str], SettingsSheet]
CODES = [
    "SMA21-SC1-0050",
    "SMA21-GG1-0010",
    "AMM5A23/65KSC1",
    "AMM5A21/65KBG1",
    "AM3616/4096-I7",
    "AM3619/4096-GG",
    "ASC8525/SC1 --choose zero_bit=as_printed",
    "ASC8520/BG1",
]


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(arguments)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.mark.slow
@pytest.mark.parametrize("code", CODES)
def test_it_fits_a_terminal(capsys: pytest.CaptureFixture[str], code: str) -> None:
    exit_code, out, err = run(capsys, "master", *code.split())
    assert (exit_code, err) == (0, "")
    assert [line for line in out.splitlines() if len(line) > 80] == []
    assert "Not yet tested on hardware." in " ".join(out.split())


@pytest.mark.parametrize(
    ("code", "padding"),
    [
        ("SMA21-SC1-0050", "4 zero bits before the position"),
        ("iC-MU-28-7", "7 zero bits after the position"),
        ("AMM5A21/65KSC1", "none"),
    ],
)
def test_only_padding_that_is_sent_is_listed(capsys: pytest.CaptureFixture[str], code: str, padding: str) -> None:
    _, out, _ = run(capsys, "master", code)
    assert re.search(rf"^ *Padding +{padding}$", out, re.MULTILINE)


def test_one_master(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "master", "SMA21-SC1-0050", "--master", "linuxcnc_hostmot2")
    assert code == 0
    # The value is on its own line, so that it can be copied without the mark.
    lines = [line.strip().removeprefix("biss_chan_0 ").strip() for line in out.splitlines()]
    assert "biss_chan_0=crc%6pnwarning%1bnerror%1bposition%20epadding%4p *" in lines
    assert "docs/src/man/man9/hostmot2.9.adoc" in out
    assert "AX8000" not in out


@pytest.mark.slow
def test_columns_end_where_most_settings_do(devices: Mapping[str, Device], sheet_of: SheetOf) -> None:
    """A long name or value moves what follows it in its own line, and no other line."""
    settings_sheet = sheet_of("linuxcnc_hostmot2", "SMA21-SC1-0050")
    setting = replace(settings_sheet.settings[0], at="place", note="", standing="documented", places=())
    long = [
        replace(setting, name="n" * 41, text="1"),
        replace(setting, name="m", text="v" * 19),
        replace(setting, name="m", text="1"),
    ]
    device = devices["sma21"]
    match = find_code(device, "SMA21-SC1-0050")
    narrow_sheet = replace(settings_sheet, settings=tuple(long), writing=(), notes=())
    lines = sheet_text(device, match, facts_of_order_code(device, match.variant), [narrow_sheet]).splitlines()
    begun = lines.index(next(line for line in lines if line.startswith("  nnn")))
    assert lines[begun : begun + 3] == [
        "  " + "n" * 41 + "  1" + " " * 17 + "  place",
        "  m" + " " * 39 + "  " + "v" * 19 + "  place",
        "  m" + " " * 39 + "  1" + " " * 17 + "  place",
    ]


def test_a_master_that_cannot(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "master", "ASC8525/SC1", "--master", "keb_f5", "--choose", "zero_bit=as_printed")
    assert code == 1
    assert "without other bits. This encoder has 1 zero bit after the position. [manual: 2.2.2]" in " ".join(
        out.split()
    )
    code, out, _ = run(capsys, "master", "ASC8525/SC1", "--master", "keb_f5", "--choose", "zero_bit=left_out")
    assert (code, "without other bits" in out) == (0, False)


def test_what_is_open_has_to_be_chosen(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, "master", "ASC8525/SC1")
    assert (code, out) == (2, "")
    assert err.startswith("codewheel: 'single_cycle_data' has no settings until you decide. Constant 0 bit between ")
    assert "add --choose zero_bit=as_printed (Sent, " in err
    assert " or --choose zero_bit=left_out (Not sent, " in err
    assert run(capsys, "master", "ASC8525/BG1", "--choose", "zero_bit=left_out")[0] == 2


@pytest.mark.parametrize(
    ("order_code", "fact"),
    [
        # The spec has neither times nor characteristics, only a note on the interface.
        ("iC-MR-12-L6T", "Timeout see the note on the interface in the spec: The timeout adapts to the clock Busy"),
        ("iC-MR-12-L6T", "Supply the spec does not say"),
        # The spec has characteristics, but no times.
        ("KCD-BC03B-1617", "Supply see the characteristics in the spec"),
        ("KCD-BC03B-1617", "Timeout the spec does not say Busy time the spec does not say, but BiSS C allows 40 µs"),
    ],
)
def test_a_fact_without_a_value_refers_to_a_part_that_the_spec_has(
    capsys: pytest.CaptureFixture[str], order_code: str, fact: str
) -> None:
    _, out, _ = run(capsys, "master", order_code, "--master", "ic_mb")
    assert fact in " ".join(out.split())


def test_registers(capsys: pytest.CaptureFixture[str]) -> None:
    """0Ch turns bits, 10h position bits: a frame of 28 + 2 + 6 = 36 bits."""
    code, out, _ = run(
        capsys,
        "master",
        "AM3616/4096-I7",
        "--master",
        "novanta",
        "--register",
        "0x57=0x0C",
        "--register",
        "0x56=0x10",
        "--json",
    )
    settings = {setting["name"]: setting["value"] for setting in json.loads(out)["masters"][0]["settings"]}
    assert (code, settings["Frame size"], settings["Position bits"], settings["Single-turn bits"]) == (0, 36, 28, 16)


@pytest.mark.parametrize(
    ("arguments", "exit_code", "message"),
    [
        (
            ["AMM5A23/65KJP1"],
            1,
            "AMM5A23/65KJP1 has the interface RS-485; there are masters for SSI and BiSS C-mode only",
        ),
        (
            ["AMM5A23/65KSC1", "--master", "synaptikon"],
            2,
            "there is no master 'synaptikon'; did you mean 'synapticon'?",
        ),
        (["AMM5A23"], 2, "is not an order code of AMM5"),
        (["AMM5A23/65KSC1", "--register", "0x56=0x10"], 2, "does not change how a frame is read"),
    ],
)
def test_what_is_wrong(capsys: pytest.CaptureFixture[str], arguments: list[str], exit_code: int, message: str) -> None:
    from codewheel.commands.cli import main as command

    assert command(["master", *arguments]) == exit_code
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_a_broken_master_of_ones_own(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(
        (
            "codewheel: 1\nmaster: mine\ntitle: Mine\ntakes: [biss]\ndocuments: {a: {title: A}}\n"
            "settings: [{name: B, value: bits, source: a, "
            "places: [{where: not_given, type: not_given, unit: none, default: not_given, source: a}]}]\n"
        ),
        encoding="utf-8",
    )
    code, out, err = run(capsys, "master", "AMM5A23/65KSC1", "--masters", str(path))
    assert (code, out) == (1, "")
    assert f"{path}:6:29: undefined-reference: the record has no number 'bits'" in err


def test_the_list(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "master")
    assert code == 0
    assert "ic_mb" in out
    assert "iC-Haus iC-MB3 and iC-MB4: BiSS C-mode" in out
    assert len(out.splitlines()) == len(list((ROOT / "specs" / "masters").glob("*.yaml")))
    code, out, _ = run(capsys, "master", "--json")
    listed_masters = {master["name"] for master in json.loads(out)["masters"]}
    assert listed_masters == {path.stem for path in (ROOT / "specs" / "masters").glob("*.yaml")}


@pytest.mark.slow
@pytest.mark.parametrize("code", CODES)
def test_json_has_its_shape(capsys: pytest.CaptureFixture[str], code: str) -> None:
    schema = json.loads(
        (resources.files("codewheel.language") / "master_settings.schema.json").read_text(encoding="utf-8")
    )
    jsonschema.Draft202012Validator.check_schema(schema)
    data = json.loads(run(capsys, "master", *code.split(), "--json")[1])
    assert [error.message for error in jsonschema.Draft202012Validator(schema).iter_errors(data)] == []
    assert data["record"]["crc_polynomial"] == (67 if data["record"]["interface"] == "biss" else 0)


def test_every_page_is_linked(pages: dict[str, str], library: Library) -> None:
    for device in library.devices:
        kinds = masters_page.interfaces_with_masters(device)
        assert kinds == [interface.name for interface in device.interfaces if interface.name != "rs485"]
        for kind in kinds:
            name = f"{device.name}-{kind}-masters.md"
            assert f"({name})" in pages["docs/README.md"]
            assert f"({name})" in pages[f"docs/{device.name}.md"]
            page = pages[f"docs/{name}"]
            assert f"({device.name}.md)" in page
            anchors = set(re.findall(r'<a id="([^"]+)">', page))
            assert set(re.findall(r"\]\(#([^)]+)\)", page)) <= anchors


def test_every_order_code_is_on_the_page(pages: dict[str, str], library: Library) -> None:
    for device in library.devices:
        for kind in masters_page.interfaces_with_masters(device):
            page = pages[f"docs/{device.name}-{kind}-masters.md"]
            for variant in device.variants:
                is_on_page = f"`{variant.code}`" in page
                assert is_on_page == (variant.interface == kind), variant.code


def test_the_page_says_what_the_command_says(pages: dict[str, str]) -> None:
    """It lists what differs between masters. The values belong to an order code, so they are not on the page."""
    page = pages["docs/sma21-biss-masters.md"]
    ic_mb = page.split("## iC-Haus")[1].split("## ")[0]
    assert re.search(r"`--master ic_mb` prints: .*SENSCRCPOLY", ic_mb)
    assert "0x21" not in ic_mb
    assert "Not supported" in page.split("## KEB Combivert F5")[1].split("## ")[0]
    ssi_page = pages["docs/sma21-ssi-masters.md"]
    assert "## Galil" in ssi_page
    assert "No SSI settings are known for: " in ssi_page


@pytest.mark.slow
def test_hostile_texts_stay_text(library: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    """Markdown and HTML in a master's text have no effect on the page."""
    from dataclasses import replace

    hostile = "a | b `c` <script>x</script> [d](e) *f* <!-- g --> ]]>"
    master = shipped_masters()[0]
    place_texts = {"symbol": hostile, "unit": hostile, "source": hostile}
    setting_texts = {"name": hostile, "at": hostile, "note": hostile, "source": hostile}
    settings: list[dict[str, Any]] = []
    for setting in master.settings:
        places = [{**place, **place_texts} for place in setting["places"]]
        settings.append({**setting, **setting_texts, "places": places})
    spoilt: Any = replace(
        master,
        title=hostile,
        documents=tuple(replace(document, title=hostile) for document in master.documents),
        settings=tuple(settings),
        notes=({"text": hostile},),
        limits=({"item": "data_bits", "at_most": 1, "reason": hostile, "source": hostile},),
    )
    monkeypatch.setattr("codewheel.targets.docs.files.shipped_masters", lambda: (spoilt, replace(spoilt, limits=())))
    page = generate(library)["docs/amm5-biss-masters.md"]
    assert "<script>" not in page
    assert "<!-- g" not in page
    assert "[d](e)" not in page
    for line in page.splitlines():
        if line.startswith("| "):
            assert len(re.findall(r"(?<!\\)\|", line)) <= 6


@pytest.mark.slow
def test_a_device_without_masters(library: Library) -> None:
    """A family with only RS-485 has no page."""
    device: Device = next(device for device in library.devices if device.name == "amm5")
    assert masters_page.interfaces_with_masters(device) == ["ssi", "biss"]
    from dataclasses import replace

    alone = replace(device, variants=tuple(variant for variant in device.variants if variant.interface == "rs485"))
    assert masters_page.interfaces_with_masters(alone) == []
    assert not any(path.endswith("-masters.md") for path in generate(Library((alone,))))


def test_a_note_on_the_page_names_its_order_codes(pages: dict[str, str]) -> None:
    """ASC85/SC2 needs 10 V, /SC1 5 V: only the former has the note that the supply of the terminal is not enough."""
    page = pages["docs/asc85-biss-masters.md"].partition('<a id="biss-beckhoff_el5042"></a>')[2].partition("<a id=")[0]
    note = next(line for line in page.splitlines() if "which is not enough for this encoder" in line)
    assert "This applies to `ASC8520/SC2`, `ASC8521/SC2`" in note
    assert "/SC1`" not in note
