"""The page with master settings: its script shows what the command prints, for every order code and master."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import settings_data
from chromium import Browser
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.masters.record import record
from codewheel.masters.sheet import sheet, shipped_masters
from codewheel.masters.text import sheet_text
from codewheel.model import Device
from codewheel.order_codes.labels import find_code
from codewheel.targets.masters.files import file_text
from exhaustive import mostly_exhaustive

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "docs" / "site" / "static" / "settings.js"
#: Prints every text of the page by order code, choice and master, and the files of each.
SHOW_ALL = """
const {settingsText} = require(process.argv[2]);
global.window = {};
require(process.argv[3]);
const data = window.codewheelSettings, shown = [];
for (const [code, choices] of Object.entries(data.codes))
  for (const [choice, byMaster] of choices)
    byMaster.forEach((entry, index) => {
      if (!entry.length) return;
      const files = entry[1].map(([format, device, number]) => [format, device, settingsText(data, code, number)]);
      shown.push([code, choice, data.masters[index][0], settingsText(data, code, entry[0]), files]);
    });
console.log(JSON.stringify(shown));
"""


def in_node(program: str, *arguments: str | Path) -> Any:
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    command = [node, "-e", program, "x", *map(str, arguments)]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


@pytest.fixture(scope="module")
def library() -> tuple[Device, ...]:
    devices, report = load_library([ROOT / "specs"])
    assert not report
    return devices


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("settings") / "settings-data.js"
    path.write_text(settings_data.script(ROOT), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def shown(data: Path) -> dict[tuple[str, str, str], tuple[str, dict[Any, str]]]:
    return {
        (code, choice, master): (text, {(file_format, device): content for file_format, device, content in files})
        for code, choice, master, text, files in in_node(SHOW_ALL, SCRIPT, data)
    }


def answers_of(choice: str) -> dict[str, str]:
    pairs = (part.partition("=") for part in choice.replace("--choose ", "").split())
    return {name: answer for name, _, answer in pairs}


def printed_texts(
    library: tuple[Device, ...], choices: dict[str, set[str]]
) -> Iterator[tuple[tuple[str, str, str], tuple[str, dict[Any, str]]]]:
    """Yield what the command prints for each order code on its own, without the groups of the page."""
    for device in library:
        for code in (variant.code for variant in device.variants if variant.code in choices):
            match = find_code(device, code)
            for choice in choices[code]:
                code_record = record(device, match.variant, answers=answers_of(choice))
                for master in shipped_masters():
                    master_sheet = sheet(master, code_record)
                    if master_sheet.is_described:
                        files = {
                            (rule["format"], name): file_text(
                                device, [code], master_sheet, rule=rule, master_device=name
                            ).rstrip("\n")
                            for rule in (() if master_sheet.refusals else master.files)
                            for name in master_sheet.devices_with(rule)
                        }
                        text = sheet_text(device, match, code_record, [master_sheet])
                        yield (code, choice, master.name), (text, files)


@pytest.mark.parametrize("part", mostly_exhaustive(range(8), 0))
def test_the_page_shows_what_the_command_prints(
    part: int, library: tuple[Device, ...], shown: dict[tuple[str, str, str], tuple[str, dict[Any, str]]]
) -> None:
    choices: dict[str, set[str]] = {}
    for code, choice, _ in shown:
        choices.setdefault(code, set()).add(choice)
    listed = {variant.code for device in library for variant in device.variants if variant.interface in ("biss", "ssi")}
    assert set(choices) == listed
    compared_codes = sorted(choices)[part::8]
    printed = dict(printed_texts(library, {code: choices[code] for code in compared_codes}))
    assert printed == {key: texts for key, texts in shown.items() if key[0] in compared_codes}


@pytest.mark.parametrize(
    ("code", "choice", "master", "file_format"),
    [
        ("AMM5A21/65KSC1", "", "moteus", "conf_set"),
        ("SMA21-GG1-0010", "", "galil_ssi", "dmc"),
        ("ASC8525/SC1", "--choose zero_bit=left_out", "beckhoff_ax5000", "soe_structure"),
        ("AM3616/4096-BG", "", "siemens_posinput", ""),
        ("MT6701", "", "omron_nx", ""),
    ],
)
def test_the_command_itself(
    shown: dict[tuple[str, str, str], tuple[str, dict[Any, str]]],
    capsys: pytest.CaptureFixture[str],
    code: str,
    choice: str,
    master: str,
    file_format: str,
) -> None:
    text, files = shown[code, choice, master]
    assert main(["master", code, "--master", master, *choice.split()]) == 0
    assert capsys.readouterr().out == f"{text}\n"
    if file_format:
        assert main(["master", code, "--master", master, "--format", file_format, *choice.split()]) == 0
        printed = capsys.readouterr().out
        assert printed == next(content for (name, _), content in files.items() if name == file_format) + "\n"


def test_the_page_in_a_browser(
    data: Path, shown: dict[tuple[str, str, str], tuple[str, dict[Any, str]]], browser: Browser
) -> None:
    """The address chooses order code, master and answer, from a file. A beginning leads to the order codes."""
    page = data.with_name("page.html")
    scripts = "".join(f'<script src="{path.as_uri()}" defer></script>' for path in (data, SCRIPT))
    page.write_text(f'<meta charset="utf-8"><div class="codewheel-settings"></div>{scripts}', encoding="utf-8")
    address = "code=asc8525%2Fsc1&master=moteus&choose=zero_bit%3Dleft_out"
    browser.open(f"{page.as_uri()}?1#{address}")
    text, files = shown["ASC8525/SC1", "--choose zero_bit=left_out", "moteus"]
    assert browser.run('document.querySelector("pre").textContent') == text
    assert browser.run('document.querySelectorAll("a[download]").length') == len(files) == 1
    command = "codewheel master ASC8525/SC1 --master moteus --choose zero_bit=left_out"
    assert browser.run('document.querySelector("[role=status]").textContent') == command
    assert browser.run("location.hash").lower() == f"#{address}".lower()
    browser.open(f"{page.as_uri()}?2#code=AMM5A2")
    assert browser.run('document.querySelector("pre").hidden')
    begun = browser.run('document.querySelector("[role=status]").textContent')
    assert begun.startswith("Order codes that begin like this: AMM5A21/")
    browser.open(f"{page.as_uri()}?3#top")
    assert not browser.run('document.querySelector("pre").hidden')
    assert list(browser.complaints) == []


def test_links_and_warnings_around_the_text(
    data: Path, shown: dict[tuple[str, str, str], tuple[str, dict[Any, str]]], browser: Browser
) -> None:
    """Each file has a line, each address is a link, and a supply that is not enough comes before the settings."""
    page = data.with_name("links.html")
    scripts = "".join(f'<script src="{path.as_uri()}" defer></script>' for path in (data, SCRIPT))
    page.write_text(f'<meta charset="utf-8"><div class="codewheel-settings"></div>{scripts}', encoding="utf-8")
    browser.open(f"{page.as_uri()}#code=AM3616%2F4096-BG&master=beckhoff_el5042")
    text, files = shown["AM3616/4096-BG", "", "beckhoff_el5042"]
    assert browser.run('document.querySelector("pre").textContent') == text
    assert browser.run('document.querySelectorAll("li > a[download]").length') == len(files) > 1
    links = browser.run('[...document.querySelectorAll("pre a")].map((link) => link.textContent)')
    assert links == re.findall(r"https://[^\s,]+", text)
    warning = browser.run('document.querySelector(".warning + pre").previousSibling.textContent')
    assert warning == (
        "The EL5042 and the EP7041-4032 supply 5 V or 9 V, which is not enough for this encoder. "
        "The encoder needs a separate supply."
    )
    command = "codewheel master AM3616/4096-BG --master beckhoff_el5042 --cable 30"
    assert browser.run('document.querySelector(".cable code").textContent') == command
    browser.open(f"{page.as_uri()}?2#code=AMM5A21%2F65KSC1&master=moteus")
    assert browser.run('document.querySelector(".warning").hidden')


def test_labels_on_the_page() -> None:
    """A label may be in lower case and have spaces. An order code that is not listed has no settings."""
    program = "const m = require(process.argv[2]), d = {codes: {'AB-1/C': []}};"
    program += "console.log(JSON.stringify(['ab-1 /c', 'AB-1', ''].map((label) => m.listedCode(d, label))))"
    assert in_node(program, SCRIPT) == ["AB-1/C", None, None]
    program = "const m = require(process.argv[2]);"
    program += (
        "console.log(JSON.stringify([m.settingsCommand('A', 'b', ''), m.settingsCommand('A', 'b', '--choose c=d')]))"
    )
    assert in_node(program, SCRIPT) == [
        "codewheel master A --master b",
        "codewheel master A --master b --choose c=d",
    ]
