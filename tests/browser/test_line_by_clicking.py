"""The form of the decode page that builds the line of an encoder: by mouse, by keyboard and on a phone."""

from __future__ import annotations

import gzip
import random
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browser_harness import Asker, program
from chromium import Browser
from codewheel.commands.cli import main
from codewheel.one_line.line import LineError
from codewheel.one_line.spec import device_of_line
from codewheel.targets import Library
from codewheel.targets.browser.files import generate
from test_lines_of_page import random_line

pytestmark = pytest.mark.slow

#: Most bytes of the page with its script, compressed.
MOST_COMPRESSED_BYTES = 150_000
OPEN = "document.querySelector('details summary').click()"
CODE = "document.querySelector('.codewheel-decode input').value"
ANSWER = "document.querySelector('.codewheel-decode-result').innerText"
#: Functions that find a control by its label, inside the field with a title.
FIND = """
globalThis.field = (title) => [...document.querySelectorAll("li")]
  .find((row) => row.querySelector("legend").innerText.startsWith(title));
globalThis.control = (label, within = document) => [...within.querySelectorAll("label")]
  .find((one) => one.innerText.trim().startsWith(label)).control;
globalThis.pick = (label, words, within) => {
  const select = control(label, within);
  select.value = [...select.options].find((one) => one.text.startsWith(words)).value;
  select.dispatchEvent(new Event("change", { bubbles: true }));
};
globalThis.type = (label, text, within) => {
  const input = control(label, within);
  input.value = text;
  input.dispatchEvent(new Event("input", { bubbles: true }));
};
globalThis.press = (text, within = document) => [...within.querySelectorAll("button")]
  .find((one) => one.innerText.trim() === text).click();
"""


def is_valid(line: str) -> bool:
    try:
        device_of_line(line)
    except LineError:
        return False
    return True


def test_the_form_writes_any_line_again(node: Asker) -> None:
    """Build the form of 500 random lines. The line that it writes describes the same encoder."""
    random_numbers = random.Random(48)
    lines: list[str] = []
    while len(lines) < 500:
        line = random_line(random_numbers)
        if is_valid(line):
            lines.append(line)
    (written_lines,) = node("builtLines", [{"texts": lines}])
    (records,) = node("records", [{"texts": lines}])
    (written_records,) = node("records", [{"texts": written_lines}])
    for line, written, record, written_record in zip(lines, written_lines, records, written_records, strict=True):
        # Both records contain their own line as the order code.
        record["codes"] = written_record["codes"] = []
        assert written_record == record, (line, written)


def test_the_page_with_all_encoders_is_small() -> None:
    folder = Path(__file__).parents[2] / "generated/browser"
    names = ("decode.html", "decode.js")
    sizes = [len(gzip.compress((folder / name).read_bytes(), mtime=0)) for name in names]
    assert sum(sizes) <= MOST_COMPRESSED_BYTES


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, library: Library) -> Path:
    folder = tmp_path_factory.mktemp("builder")
    for path, text in generate(library).items():
        (folder / Path(path).name).write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def browser(folder: Path, tmp_path: Path) -> Iterator[Browser]:
    program("chromium")
    with Browser(tmp_path) as browser:
        browser.look(375)
        browser.open((folder / "decode.html").as_uri())
        browser.run(FIND)
        yield browser
        assert browser.complaints == []


def test_a_line_by_clicking(browser: Browser) -> None:
    """Describe the encoder of the capture in tests/vectors.json, with a position of 192458."""
    browser.run(OPEN)
    # Details report that they were opened in a later task.
    browser.run("new Promise((done) => setTimeout(done, 50))")
    assert browser.run(CODE) == "biss:position=32,error,warning,crc=6:0x43"
    browser.run('type("Bits", "22", field("Position"))')
    assert browser.run(CODE) == "biss:position=22,error,warning,crc=6:0x43"
    browser.run(
        "(() => { const text = document.querySelector('textarea'); text.value = '0b000010111011111100101011011100';"
        " text.dispatchEvent(new Event('input', { bubbles: true })); })()"
    )
    answer: str = browser.run(ANSWER)
    assert "192458" in answer
    assert "usable" in answer.lower()
    # The answer and the address change at once.
    browser.run('pick("Active", "at 1", field("Flag"))')
    assert browser.run(CODE) == "biss:position=22,error=high,warning,crc=6:0x43"
    assert "not_usable" in browser.run(ANSWER).lower()
    assert "error%3Dhigh" in browser.run("location.hash")
    browser.run('pick("CRC", "0x12f: BiSS", field("CRC"))')
    assert browser.run(CODE) == "biss:position=22,error=high,warning,crc=8:0x12f"
    browser.run('control("inverted", field("CRC")).click()')
    assert browser.run(CODE).endswith("crc=8:0x12f:plain")
    browser.run('press("+ Life counter")')
    assert browser.run(CODE) == "biss:position=22,error=high,warning,life_counter=6,crc=8:0x12f:plain"
    browser.run('press("↑", field("Number"))')
    assert browser.run(CODE) == "biss:position=22,error=high,life_counter=6,warning,crc=8:0x12f:plain"
    browser.run('press("✕", field("Flag"))')
    browser.run('press("+ Zero bits")')
    assert browser.run(CODE) == "biss:position=22,life_counter=6,warning,zero=1,crc=8:0x12f:plain"
    browser.run('pick("Code", "Gray")')
    assert browser.run(CODE) == "biss,gray:position=22,life_counter=6,warning,zero=1,crc=8:0x12f:plain"


def test_every_new_field_and_interface_has_a_valid_line(browser: Browser) -> None:
    """Press each button once, and choose each interface. The box then lists no problem of the line."""
    browser.run(OPEN)
    browser.run("new Promise((done) => setTimeout(done, 50))")
    lines: list[str] = []
    for interface in ("SSI", "SPI", "RS-485", "BiSS"):
        browser.run(f'pick("Interface", "{interface}")')
        lines.append(browser.run(CODE))
    browser.run('press("✕", field("Flag"))')
    for words in (
        "Error bit",
        "Status bit",
        "Life counter",
        "Other number",
        "Constant bits",
        "Unused bits",
        "Parity bit",
    ):
        browser.run(f'press("+ {words}")')
        lines.append(browser.run(CODE))
        assert browser.run("document.activeElement.tagName") in ("INPUT", "SELECT")
    browser.run('press("+ Status bit")')
    lines.append(browser.run(CODE))
    for line in lines:
        assert is_valid(line), line
    assert "status_2=high" in lines[-1]


def test_the_form_follows_the_box(browser: Browser) -> None:
    browser.run(OPEN)
    browser.run("new Promise((done) => setTimeout(done, 50))")
    browser.run(
        "(() => { const code = document.querySelector('.codewheel-decode input');"
        " code.value = 'ssi,right,clock=250kHz:multiturn=12,singleturn=13,power_fail=high:error';"
        " code.dispatchEvent(new Event('input', { bubbles: true })); })()"
    )
    state: dict[str, Any] = browser.run(
        '({ bits: control("Bits", field("Number of rev")).value, clock: control("Clock").value,'
        ' means: control("Means").selectedOptions[0].text, alignment: control("Alignment").selectedOptions[0].text })'
    )
    assert state == {"bits": "12", "clock": "250kHz", "means": "an error", "alignment": "right"}
    browser.run('type("Bits", "17", field("Position within"))')
    assert browser.run(CODE) == "ssi,right,clock=250kHz:multiturn=12,singleturn=17,power_fail=high:error"


def key(browser: Browser, name: str, text: str = "") -> None:
    """Press a key as a user does."""
    code = {"Tab": 9, "Enter": 13}.get(name, ord(text.upper()) if text else 0)
    for kind in ("keyDown", "keyUp"):
        given = {"text": "\r" if name == "Enter" else text} if kind == "keyDown" and (text or name == "Enter") else {}
        browser.call("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=code, **given)


def focus_with_tab(browser: Browser, condition: str) -> None:
    """Press Tab until the condition about ``focused`` holds."""
    for _ in range(80):
        if browser.run(f"((focused) => {condition})(document.activeElement)"):
            return
        key(browser, "Tab")
    raise AssertionError(condition)


def test_by_keyboard_on_a_phone(browser: Browser) -> None:
    """Reach every control with Tab. Nothing is wider than the screen, and buttons are large enough for a finger."""
    focus_with_tab(browser, "focused.tagName === 'SUMMARY'")
    key(browser, "Enter")
    browser.run("new Promise((done) => setTimeout(done, 50))")
    focus_with_tab(browser, "focused.innerText?.trim() === '+ Zero bits'")
    key(browser, "Enter")
    assert browser.run(CODE) == "biss:position=32,error,warning,zero=1,crc=6:0x43"
    # The width of the new field has the focus.
    browser.run("document.activeElement.select()")
    key(browser, "3", "3")
    assert browser.run(CODE) == "biss:position=32,error,warning,zero=3,crc=6:0x43"
    focus_with_tab(browser, "focused.getAttribute('aria-label') === 'Move up field 4, Zero bits'")
    key(browser, "Enter")
    key(browser, "Enter")
    assert browser.run(CODE) == "biss:position=32,zero=3,error,warning,crc=6:0x43"
    assert browser.run("document.activeElement.getAttribute('aria-label')") == "Move up field 2, Zero bits"
    assert browser.run("document.documentElement.scrollWidth") <= 375
    small = (
        "[...document.querySelectorAll('.codewheel-decode-builder :is(button, input, select)')]"
        ".filter((one) => one.type !== 'checkbox').map((one) => one.getBoundingClientRect())"
        ".filter(({ width, height, right }) => width < 24 || height < 24 || right > 375).length"
    )
    assert browser.run(small) == 0
    unnamed = (
        "[...document.querySelectorAll('.codewheel-decode-builder :is(input, select)')]"
        ".filter((one) => !one.labels[0]?.innerText.trim()).length"
    )
    assert browser.run(unnamed) == 0


def test_the_note_of_the_page_writes_a_spec(
    browser: Browser, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Run the command that the page names for a line by clicking. ``check`` accepts the spec, with its gaps named."""
    browser.run(OPEN)
    browser.run("new Promise((done) => setTimeout(done, 50))")
    browser.run('press("+ Life counter")')
    note = "[...document.querySelectorAll('.codewheel-decode-note')].map((one) => one.innerText)[0]"
    words = shlex.split(browser.run(note).partition(": ")[2])
    assert words[:4] == ["codewheel", "new", "my_encoder", "--line"]
    assert words[4:] == [browser.run(CODE)]
    folder = tmp_path / "specs"
    folder.mkdir()
    assert main([*words[1:], "-o", str(folder)]) == 0
    capsys.readouterr()
    assert main(["check", str(folder)]) == 0
    assert "no problems" in capsys.readouterr().out
    spec = (folder / "my_encoder.yaml").read_text(encoding="utf-8")
    assert "grade: uncorroborated" in spec
    assert '- "The clock."' in spec
    assert '- "The counts per revolution."' in spec
