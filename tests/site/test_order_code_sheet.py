"""The page of an order code: badges, chips, dots, buttons that copy, and its printed sheet."""

from __future__ import annotations

import base64
import re
from pathlib import Path

import pytest
from chromium import Browser

#: One order code of each interface.
SHEETS = [
    "amm5/AMM5A21-65KSC1",
    "amm5/AMM5A23-65KJP1",
    "amm5/AMM5A21-65KBG1",
    "sma21/SMA21-JP1-0050",
    "am36/AM3616-4096-I7",
    "icmu/iC-MU-38-7",
    "as5047p/AS5047P",
]
#: 8 pt in pixels of CSS, of which 96 are an inch of 72 pt.
LEAST_PRINTED = 8 * 96 / 72
_PRINTED_SIZES = """[...document.querySelectorAll("article *")]
  .filter((item) => item.checkVisibility() && [...item.childNodes].some((one) => one.nodeType === 3 && one.data.trim()))
  .map((item) => [item.localName, item.textContent.trim().slice(0, 30), parseFloat(getComputedStyle(item).fontSize)])
  .filter((found) => found[2] < %f - 0.01)"""
_COPIED = """(async () => {
  const copied = [];
  Object.defineProperty(navigator, "clipboard", { value: { writeText: async (text) => copied.push(text) } });
  for (const button of document.querySelectorAll("button.copy")) button.click();
  await new Promise((done) => setTimeout(done, 50));
  return copied;
})()"""
_FALLBACK = """(async () => {
  const selected = [];
  Object.defineProperty(navigator, "clipboard", { value: undefined });
  document.execCommand = (command) => selected.push([command, getSelection().toString()
    || document.activeElement.value]);
  document.querySelector("button.copy").click();
  await new Promise((done) => setTimeout(done, 50));
  return selected;
})()"""


def page_of(site: Path, name: str) -> Path:
    return site / "generated" / "docs" / f"{name}.html"


@pytest.mark.parametrize("name", SHEETS)
def test_an_order_code_prints_on_one_or_two_sheets(site: Path, browser: Browser, name: str) -> None:
    browser.look(1280)
    browser.open(page_of(site, name).as_uri())
    pdf = browser.call("Page.printToPDF", preferCSSPageSize=True, printBackground=True)["data"]
    pages = re.findall(rb"/Type\s*/Page\b(?!s)", base64.b64decode(pdf))
    assert len(pages) in (1, 2)


@pytest.mark.parametrize("name", SHEETS)
def test_printed_text_has_8_points(site: Path, browser: Browser, name: str) -> None:
    """An A4 sheet less margins of 12 mm is 186 mm wide, 703 pixels."""
    browser.look(703)
    browser.call("Emulation.setEmulatedMedia", media="print")
    browser.call("Emulation.setScrollbarsHidden", hidden=True)
    try:
        browser.open(page_of(site, name).as_uri())
        assert browser.run(_PRINTED_SIZES % LEAST_PRINTED) == []
        assert browser.run('document.querySelector("header.top").checkVisibility()') is False
        # The text of the picture has 11 of 720 pixels.
        width = browser.run('document.querySelector("picture img").getBoundingClientRect().width')
        assert width * 11 / 720 >= LEAST_PRINTED
    finally:
        browser.call("Emulation.setEmulatedMedia", media="")
        browser.call("Emulation.setScrollbarsHidden", hidden=False)


def test_each_verdict_in_the_table_is_a_badge(site: Path, browser: Browser) -> None:
    """The alarms of AMM5 over RS-485, and their bytes and bits, are in table 7.3.2 and 7.4.1 of the manual."""
    browser.look(1280)
    browser.open(page_of(site, "amm5/AMM5A23-65KJP1").as_uri())
    rows = browser.run(
        '[...document.querySelectorAll("#details tr:has(.verdict)")].map((row) => [row.cells[0].textContent.trim(), '
        'row.cells[1].querySelector("code")?.textContent ?? "", row.querySelector(".verdict")?.className ?? ""])'
    )
    assert ["byte 9, bit 7", "battery_alarm", "verdict usable_with_warning"] in rows
    assert ["byte 9, bit 2", "st_error", "verdict not_usable"] in rows
    assert rows[-1] == ["", "", "verdict usable"]
    assert all(verdict for _, _, verdict in rows)


def test_wires_have_chips_in_their_colours(site: Path, browser: Browser) -> None:
    browser.look(1280)
    browser.open(page_of(site, "amm5/AMM5A23-65KJP1").as_uri())
    chips = browser.run(
        '[...document.querySelectorAll("#wiring .wire")].map((wire) => [wire.innerText, '
        "...[...wire.querySelectorAll('.chip > span')].map((part) => part.className)])"
    )
    assert ["Pink", "wire-pink"] in chips
    assert ["Brown_Green", "wire-brown", "wire-green"] in chips
    # Of 14 pins, two have no wire.
    assert len(chips) == 12
    colours = browser.run(
        '[...document.querySelectorAll("#wiring .chip > span")].map((part) => getComputedStyle(part).backgroundColor)'
    )
    assert "rgba(0, 0, 0, 0)" not in colours


def test_states_of_leds_have_dots(site: Path, browser: Browser) -> None:
    browser.look(1280)
    browser.open(page_of(site, "amm5/AMM5A21-65KSC1").as_uri())
    states = browser.run(
        '[...document.querySelectorAll("#leds td:first-child")].map((cell) => [cell.innerText, '
        "...[...cell.querySelectorAll('.dot')].map((dot) => dot.className)])"
    )
    dots = {text: classes for text, *classes in states}
    assert dots["blinks for a while after power-on and goes off by itself"] == ["dot blinking lit"]
    assert dots["on or blinking after power-on, without going off by itself"] == ["dot on lit", "dot blinking lit"]
    assert dots["off in operation"] == ["dot off lit"]
    assert dots["red in operation"] == ["dot on red"]
    assert dots["LED 1 (ERROR)"] == []


def test_buttons_copy_codes_bytes_and_crc(site: Path, browser: Browser) -> None:
    browser.look(1280)
    page = page_of(site, "amm5/AMM5A23-65KJP1").as_uri()
    browser.open(page)
    copied = browser.run(_COPIED)
    assert copied[0] == "AMM5A23/65KJP1"
    assert copied[1].startswith("poly 0x101 (x⁸ + 1), init 0,")
    # The requests of 7.2.1, 7.2.2 and 7.2.3.
    assert copied[2:] == ["02", "8A", "92", "1A", "32", "EA", "BA", "C2", "62"]
    names = browser.run('[...document.querySelectorAll("button.copy")].map((one) => one.ariaLabel)')
    assert all(names)
    browser.open(page)
    assert browser.run(_FALLBACK) == [["copy", "AMM5A23/65KJP1"]]


@pytest.mark.parametrize("width", [375, 1280])
@pytest.mark.parametrize("name", SHEETS)
def test_short_pieces_stay_in_one_line(site: Path, browser: Browser, name: str, width: int) -> None:
    """Bytes with their button and comma, a sign with its word, and a signal with its polarity."""
    browser.look(width)
    browser.open(page_of(site, name).as_uri())
    bytes_and_lines = browser.run(
        '[...document.querySelectorAll("#what-to-send .copied > code")].map((one) => [one.textContent, '
        "one.getBoundingClientRect().height / parseFloat(getComputedStyle(one).fontSize)])"
    )
    assert [text for text, lines in bytes_and_lines if lines > 2.4 and len(text) < 30] == []
    after = browser.run(
        '[...document.querySelectorAll("#what-to-send .copied")].map((one) => one.nextSibling?.data ?? "")'
    )
    assert [text for text in after if text.startswith((",", "."))] == []
    text = browser.run('document.querySelector("article").textContent')
    assert re.findall("[✓▲✕⚠] .{,20}", text) == []
    wiring = browser.run('document.querySelector("#wiring").textContent')
    assert re.findall(r"\w+ [+-]\s", wiring) == []


def test_a_fold_in_a_list_has_no_bullet(site: Path, browser: Browser) -> None:
    browser.look(1280)
    browser.open(page_of(site, "sma21/SMA21-JP1-0050").as_uri())
    style = "one.querySelector('details') ? 'fold' : 'text', getComputedStyle(one).listStyleType"
    styles = browser.run(f"[...document.querySelectorAll('#frame li')].map((one) => [{style}])")
    assert {tuple(one) for one in styles} == {("fold", "none"), ("text", "disc")}


@pytest.mark.parametrize("width", [375, 1280])
def test_rotated_names_fit_their_bits(site: Path, browser: Browser, width: int) -> None:
    browser.look(width)
    browser.open(page_of(site, "sma21/SMA21-JP1-0050").as_uri())
    names = browser.run(
        '[...document.querySelectorAll("#decode .codewheel-decode-narrow .codewheel-decode-name")].map((one) => '
        "[one.textContent, one.getBoundingClientRect().width / parseFloat(getComputedStyle(one).fontSize), "
        "one.getBoundingClientRect().bottom <= one.parentElement.getBoundingClientRect().bottom])"
    )
    assert "temperature_alarm" in [name for name, *_ in names]
    assert [name for name, lines, is_inside in names if lines > 2 or not is_inside] == []


@pytest.mark.parametrize(("is_dark", "name"), [(False, "light"), (True, "dark")])
def test_page_and_badges_have_the_colours_of_the_palette(
    site: Path, browser: Browser, is_dark: bool, name: str
) -> None:
    palette = (Path(__file__).resolve().parents[2] / "runtime" / "browser" / "palette.css").read_text(encoding="utf-8")
    light, _, dark = palette.partition("@media")
    defined = dict(re.findall(r"--codewheel-([a-z-]+): (#[0-9a-f]{6});", dark if is_dark else light))
    browser.look(1280, dark=is_dark)
    browser.open(page_of(site, "amm5/AMM5A23-65KJP1").as_uri())
    seen = browser.run(
        '[["body", "page"], [".verdict.not_usable", "not-usable-ground"], [".verdict.usable", "usable-ground"]]'
        ".map(([selector, name]) => [name, getComputedStyle(document.querySelector(selector)).backgroundColor])"
    )
    for colour, shown in seen:
        channels = [int(defined[colour][start : start + 2], 16) for start in (1, 3, 5)]
        assert shown == "rgb({}, {}, {})".format(*channels), (name, colour)
