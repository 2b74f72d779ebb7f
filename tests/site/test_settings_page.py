"""The page with master settings: its script shows what the command prints, for every order code and master."""

from __future__ import annotations

import json
import random
import re
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
import settings_data
from chromium import Browser
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.masters.frame_parts import NoMasterSettings
from codewheel.masters.groups import facts_of_order_codes
from codewheel.masters.order_code_facts import facts_of_order_code
from codewheel.masters.sheet import sheet, shipped_masters
from codewheel.masters.text import sheet_text
from codewheel.model import Device
from codewheel.one_line.line import LineError
from codewheel.one_line.spec import device_of_line
from codewheel.order_codes.labels import LabelMatch, find_code
from codewheel.targets.masters.files import file_text
from exhaustive import mostly_exhaustive

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
STATIC = ROOT / "docs" / "site" / "static"
DECODER = ROOT / "generated" / "browser" / "decode.js"
SCRIPTS = [*(STATIC / f"master-{name}.js" for name in ("values", "record", "text")), STATIC / "settings.js"]
#: Loads the scripts and the data of the page, whose paths are the arguments.
LOAD = """
global.window = {};
const m = process.argv.slice(2).map((path) => require(path)).at(-1);
const data = window.codewheelSettings;
const taking = (record) => data.masters.filter(({takes}) => takes.includes(record.words.interface));
"""
#: Prints every text of the page by order code, choice and master, and the files of each.
SHOW_ALL = f"""{LOAD}
const shown = [];
for (const [code, [, choices]] of Object.entries(data.codes))
  for (const [choice] of choices) {{
    const encoder = m.describedEncoder(data, code, choice, null);
    for (const master of taking(encoder.record)) {{
      const files = (encoder.files[master.name] ?? []).map(
        ([format, device, number]) => [format, device, m.fileText(data, code, number)]);
      shown.push([code, choice, master.name, codewheelMaster.settingsText(encoder, master, data), files]);
    }}
  }}
console.log(JSON.stringify(shown));
"""
#: Prints the texts of each line or order code with its choice and cable length, or why there are none.
SHOW_SOME = f"""{LOAD}
const inputs = JSON.parse(require("fs").readFileSync(0));
console.log(JSON.stringify(inputs.map(([text, choice, cable]) => {{
  try {{
    const encoder = m.describedEncoder(data, text, choice, cable);
    const masters = encoder.record.obstacle ? data.masters.slice(0, 1) : taking(encoder.record);
    return masters.map((master) => codewheelMaster.settingsText(encoder, master, data));
  }} catch (error) {{
    if (error instanceof codewheelMaster.NoRecord) return error.message;
    throw error;
  }}
}})));
"""


def in_node(program: str, *arguments: str | Path, inputs: Any = None) -> Any:
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    command = [node, "-e", program, "x", *map(str, arguments)]
    run = subprocess.run(command, input=json.dumps(inputs), capture_output=True, text=True, check=True)
    return json.loads(run.stdout)


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
        for code, choice, master, text, files in in_node(SHOW_ALL, DECODER, data, *SCRIPTS)
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
                code_record = facts_of_order_code(device, match.variant, answers=answers_of(choice))
                for master in shipped_masters():
                    master_sheet = sheet(master, code_record)
                    if master_sheet.is_described:
                        files = {
                            (rule["format"], name): file_text(
                                device, [code], master_sheet, file_rule=rule, master_device=name
                            ).rstrip("\n")
                            for rule in (() if master_sheet.refusals else master.files)
                            for name in master_sheet.devices_with(rule)
                        }
                        text = sheet_text(device, match, code_record, [master_sheet])
                        yield (code, choice, master.name), (text, files)


@pytest.mark.parametrize("part", mostly_exhaustive(range(16), 0))
def test_the_page_shows_what_the_command_prints(
    part: int, library: tuple[Device, ...], shown: dict[tuple[str, str, str], tuple[str, dict[Any, str]]]
) -> None:
    choices: dict[str, set[str]] = {}
    for code, choice, _ in shown:
        choices.setdefault(code, set()).add(choice)
    listed = {variant.code for device in library for variant in device.variants if variant.interface in ("biss", "ssi")}
    assert set(choices) == listed
    compared_codes = sorted(choices)[part::16]
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
    scripts = "".join(f'<script src="{path.as_uri()}" defer></script>' for path in (DECODER, data, *SCRIPTS))
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
    assert browser.run('document.querySelector(".answer").hidden')
    begun = browser.run('document.querySelector("[role=status]").textContent')
    assert begun.startswith("Order codes that begin like this: AMM5A21/")
    browser.open(f"{page.as_uri()}?3#top")
    assert not browser.run('document.querySelector(".answer").hidden')
    assert list(browser.complaints) == []


def test_links_and_warnings_around_the_text(
    data: Path, shown: dict[tuple[str, str, str], tuple[str, dict[Any, str]]], browser: Browser
) -> None:
    """Each file has a line, each address is a link, and a supply that is not enough comes before the settings."""
    page = data.with_name("links.html")
    scripts = "".join(f'<script src="{path.as_uri()}" defer></script>' for path in (DECODER, data, *SCRIPTS))
    page.write_text(f'<meta charset="utf-8"><div class="codewheel-settings"></div>{scripts}', encoding="utf-8")
    browser.open(f"{page.as_uri()}#code=AM3616%2F4096-BG&master=beckhoff_el5042")
    text, files = shown["AM3616/4096-BG", "", "beckhoff_el5042"]
    assert browser.run('document.querySelector("pre").textContent') == text
    assert browser.run('document.querySelectorAll("li > a[download]").length') == len(files) > 1
    links = browser.run('[...document.querySelectorAll("pre a")].map((link) => link.textContent)')
    assert links == re.findall(r"https://[^\s,]+", text)
    warning = browser.run('document.querySelector(".warning").textContent')
    assert warning == (
        "The EL5042 and the EP7041-4032 supply 5 V or 9 V, which is not enough for this encoder. "
        "The encoder needs a separate supply."
    )
    browser.open(f"{page.as_uri()}?2#code=AMM5A21%2F65KSC1&master=moteus")
    assert browser.run('document.querySelector(".warning").hidden')


def test_the_input_of_the_page() -> None:
    """A label may be in lower case and have spaces. An order code that is not listed has no settings."""
    program = LOAD.replace("window.codewheelSettings", "{codes: {'AB-1/C': []}}")
    program += """console.log(JSON.stringify([
      ["ab-1 /c", "AB-1", ""].map((label) => m.listedCode(data, label)),
      [["A", "b", ""], ["A", "b", "--choose c=d", 30], ["a:b,c d", "e"]].map((given) => m.settingsCommand(...given)),
      ["30", "29.2 m", ""].map(m.cableMetres),
      ["0", "-1", "1e9", "x", "100001", "0x10"].filter((text) => {
        try { m.cableMetres(text); } catch { return true; }
      }),
    ]));"""
    codes, commands, lengths, refused = in_node(program, DECODER, *SCRIPTS)
    assert codes == ["AB-1/C", None, None]
    assert commands == [
        "codewheel master A --master b",
        "codewheel master A --master b --choose c=d --cable 30",
        'codewheel master "a:b,c d" --master e',
    ]
    assert lengths == [30, 30, None]
    assert refused == ["0", "-1", "1e9", "x", "100001", "0x10"]


FIELDS = [
    *("position=24", "position=12:signed", "singleturn=13", "multiturn=12", "error", "warning", "error=high"),
    *("alarm=low:status", "zero=3", "unused=1", "sign=1:1", "mark=3:5", "temperature=8", "parity=even", "parity=odd"),
    *("crc=6:0x43", "crc=16:0x190D9:plain", "crc=5:0x25:3:inverted"),
]
OPTIONS = ["gray", "clock=250kHz", "clock=2MHz", "counts=4096", "counts=3600", "counts=16,turns=8", "right"]
CABLES = [None, None, None, None, None, None, None, 1, 10, 11, 60, 100, 1000, 1001]


def random_line(numbers: random.Random) -> str:
    options = numbers.sample(OPTIONS, numbers.choice([0, 0, 1]))
    position = numbers.choice([["position=24"], ["position=16"], ["multiturn=12", "singleturn=13"], []])
    # Most lines have the position before the other fields, as encoders send it.
    fields = list(dict.fromkeys([*position, *numbers.sample(FIELDS, numbers.choice([0, 1, 2, 3]))]))
    fields.sort(key=lambda field: field.startswith("crc"))
    return f"{','.join([numbers.choice(['biss', 'ssi', 'ssi', 'spi']), *options])}:{','.join(fields)}"


def printed_or_reason(device: Device, match: LabelMatch, cable: int | None, answers: dict[str, str]) -> list[str] | str:
    """Return what the command prints for each master of the interface, or why there are no settings."""
    try:
        facts = facts_of_order_code(device, match.variant, cable_m=cable, answers=answers)
    except NoMasterSettings as error:
        return str(error)
    if facts.obstacle:
        return [sheet_text(device, match, facts, [])]
    sheets = [sheet(master, facts) for master in shipped_masters()]
    return [sheet_text(device, match, facts, [shown]) for shown in sheets if shown.is_described]


def test_a_line_has_the_settings_that_the_command_prints(data: Path) -> None:
    numbers = random.Random(48)
    inputs: list[tuple[str, str, int | None]] = []
    wanted = []
    while len(inputs) < 300:
        line, cable = random_line(numbers), numbers.choice(CABLES)
        with suppress(LineError):
            wanted.append(printed_or_reason(*device_of_line(line), cable, {}))
            inputs.append((line, "", cable))
    for (line, _, cable), texts, shown in zip(
        inputs, wanted, in_node(SHOW_SOME, DECODER, data, *SCRIPTS, inputs=inputs), strict=True
    ):
        assert shown == texts, (line, cable)
    assert sum(isinstance(texts, list) for texts in wanted) > 100


def test_a_cable_has_the_settings_that_the_command_prints(library: tuple[Device, ...], data: Path) -> None:
    numbers = random.Random(30)
    inputs: list[tuple[str, str, int | None]] = []
    wanted = []
    for device in library:
        for interface in device.interfaces:
            records = list(facts_of_order_codes(device, interface))
            for facts in numbers.sample(records, min(2, len(records))):
                cable = numbers.choice([1, 10, 30, 50, 100, 300, 1001])
                choice = " ".join(f"--choose {name}={answer}" for name, answer in facts.answers.items())
                inputs.append((facts.code, choice, cable))
                wanted.append(printed_or_reason(device, find_code(device, facts.code), cable, dict(facts.answers)))
    for (code, _, cable), texts, shown in zip(
        inputs, wanted, in_node(SHOW_SOME, DECODER, data, *SCRIPTS, inputs=inputs), strict=True
    ):
        assert shown == texts, (code, cable)
