"""Eleven tasks of a person with a label in hand: one search, at most one click, and the answer in sight.

The answers are typed from the manuals: AMM5 1.9 (4.1.1 to 4.1.3, 4.3.2, 6.2, 6.4, 7.1, 7.3, 7.6), AM36 1.0 (4, 6.2,
6.4), ASC85 1.0 (4, 5.3) and SMA21 1.2 (4.1, 4.2, 7.1, 7.3, 9). Durations are counted here: bits, start bit and CDS bit
at 1 MHz, or bytes of ten bits at 2.5 MBd. Clocks for cables of BiSS come from AN15 of iC-Haus.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from building import build
from chromium import CHROMIUM, Browser
from working_tools import require

#: Width and height of the screens, and the most of them between the place that a click leads to and the answer.
SCREENS = [(1280, 800, 1.5), (375, 760, 2.5)]
#: Typed with the label, in the order of TASKS.
QUERIES = {
    "pins and wires": "pinout",
    "cable, SSI": "ssi cable length",
    "cable, BiSS": "biss cable length",
    "CRC": "crc polynomial",
    "set zero": "how do I set zero",
    "preset bytes": "preset bytes",
    "blinking LED": "blinking LED",
    "error bit": "which bit says error",
    "frame at 1 MHz": "frame time",
    "save": "save to eeprom",
}
#: Answers of each order code: rows of a page, with the texts that each must contain. Answers with ", not " are on the
#: page of the search, without a click.
BISS_CABLE = ["10 m | 10 MHz", "25 m | 5 MHz", "60 m | 2 MHz", "100 m | 1 MHz", "200 m | 500 kHz"]
SSI_CABLE = ["50 m | 400 kHz", "100 m | 300 kHz", "200 m | 200 kHz", "400 m | 100 kHz"]
BISS_CRC = ["CRC | poly 0x43 (x⁶ + x + 1) | init 0 | inverted | 6 bits"]
XOR = ["CRC | poly 0x101 (x⁸ + 1) | init 0 | 8 bits | XOR of these bytes"]
NO_COMMANDS = ["SSI only reads the position. It has no preset, reset or save command."]
NO_PRESET = ["There is no preset other than the resets, and no save command."]
NO_CABLE = ["The manual does not state the reply time or the cable length."]
CABLE_ELSEWHERE = ["For the cable length, see times and characteristics."]
NO_LEDS = ["The manual describes no LEDs."]
ANSWERS: dict[str, dict[str, list[str]]] = {
    "AMM5A21/65KSC1": {
        "pins and wires": [
            "2 | Pink | Data OUT - / SLO -", "3 | Grey | Data OUT + / SLO +", "4 | Yellow | Clock IN - / MA -",
            "5 | Violet | Clock IN + / MA +", "10 | White | +Vb", "11 | Blue | 0Vb", "13 | Brown_Green | +5Vdc ±5%",
            "14 | White_Green | 0Vdc",
        ],
        "cable, SSI": ["AMM5A21/65KSC1 has BiSS C-mode, not SSI."],
        "cable, BiSS": BISS_CABLE,
        "CRC": BISS_CRC,
        "set zero": [
            "Set, save and activate a preset | 40h: 01, 11h to 17h: 00 00 00 00 00 00 00, 40h: 00, 77h: 01 | 77h: 02"
        ],
        "preset bytes": [
            "Set and save a preset without activating it | 40h: 01, 11h to 17h: 00 00 00 00 00 00 00, 40h: 00, 77h: 01",
            "write position × 2^12 as 7 bytes, low byte first, to registers 11h to 17h",
        ],
        "blinking LED": ["on or blinking after power-on | An error is active | depleted battery"],
        "error bit": ["Active at 0 | error (bit 7)"],
        "frame at 1 MHz": ["45 bits at 1 MHz: 47 µs"],
        "save": ["Save the parameters | 77h: 01"],
    },
    "AMM5A23/65KJP1": {
        "pins and wires": [
            "2 | Pink | B (RS-485)", "3 | Grey | A (RS-485)", "13 | Brown_Green | +5Vdc ±5%", "14 | White_Green | 0Vdc",
        ],
        "cable, SSI": NO_CABLE,
        "cable, BiSS": NO_CABLE,
        "CRC": XOR,
        "set zero": ["C2 → 6 bytes | Reset singleturn and multiturn data to 0 | 10 times | 40 µs apart"],
        "preset bytes": NO_PRESET,
        "blinking LED": ["on or blinking after power-on | An error is active | depleted battery"],
        "error bit": ["Active at 1 | status_st_error (byte 1, bit 4) | status_other_error (bit 5)"],
        "frame at 1 MHz": ["6 bytes 24 µs, 11 bytes 44 µs"],
        "save": NO_PRESET,
    },
    "SMA21-JP1-0050": {
        "pins and wires": ["5 | Grey | A (REQ+ / SD+)", "6 | Pink | B (REQ- / SD-)", "2 | Brown_Green | +5Vdc ±5%"],
        "cable, SSI": CABLE_ELSEWHERE,
        "cable, BiSS": CABLE_ELSEWHERE,
        "CRC": XOR,
        "set zero": ["7A → 7 bytes | Reset the position to 0 | 10 times | 40 µs apart"],
        "preset bytes": NO_PRESET,
        "blinking LED": ["off | The sensor is working properly", "red in operation | until it reads a new valid one"],
        "error bit": ["Active at 1 | status_error (bit 5)"],
        "frame at 1 MHz": ["7 bytes 28 µs, 9 bytes 36 µs"],
        "save": NO_PRESET,
    },
    "AM3616/4096-I7": {
        "pins and wires": [
            "1 | Black | 0VDC", "2 | Red | +10VDC +30VDC", "3 | Yellow | Clock IN +", "4 | Blue | Clock IN -",
            "5 | Green | Data OUT +", "6 | Orange | Data OUT -", "7 | White | Zero setting/Preset",
            "8 | Grey | Counting direction",
        ],
        "cable, SSI": ["AM3616/4096-I7 has BiSS C-mode, not SSI."],
        "cable, BiSS": BISS_CABLE,
        "CRC": BISS_CRC,
        "set zero": ["Set, save and activate a preset | 49h: bit 2 = 0, 50h to 54h: 00 00 00 00 00, 48h: 02"],
        "preset bytes": [
            "Set and save a preset without activating it | 49h: bit 2 = 0, 50h to 54h: 00 00 00 00 00, 48h: 01"
        ],
        "blinking LED": NO_LEDS,
        "error bit": ["Not used by this encoder | error (bit 7) | warning (bit 6)"],
        "frame at 1 MHz": ["44 bits at 1 MHz: 46 µs"],
        "save": ["Save the parameters | 48h: 01"],
    },
    "ASC8525/BG1": {
        "pins and wires": [
            "1 | 12 | Black | 0Vdc", "2 | 11 | Red | +Vdc", "3 | 2 | Yellow | CLOCK IN + / MA +",
            "4 | 1 | Blue | CLOCK IN - / MA -", "5 | 3 | Green | DATA OUT + / SLO +",
            "6 | 4 | Orange | DATA OUT - / SLO -",
        ],
        "cable, SSI": SSI_CABLE,
        "cable, BiSS": ["ASC8525/BG1 has SSI, not BiSS C-mode."],
        "CRC": ["CRC: none."],
        "set zero": NO_COMMANDS,
        "preset bytes": NO_COMMANDS,
        "blinking LED": NO_LEDS,
        "error bit": ["no bit of this frame confirms that the position is usable"],
        "frame at 1 MHz": ["25 bits at 1 MHz: 25 µs"],
        "save": NO_COMMANDS,
    },
}  # fmt: skip
#: The eleventh task: labels that are not in the list, and the words that the search answers with.
OTHER_LABELS = {
    "AMM5A19/65KSC1": "valid values: 17, 21, 23",
    "AMM5A23/65KJP1/S123": "An encoder whose order code ends in /Sxxx",
    "SMA21-JP1-0051": "valid values: 0050, 0010, 0005, 0002, 0001",
    "AM3616/4096SC1": "The label is written as in edition 1.1 of the manual",
    "ASC8526/BG1": "valid values: 20, 21, 22, 23, 24, 25",
}
_FIRST = 'document.querySelector("#search-results li a")'
#: The first visible element that contains all texts, without one inside it that also does: top and bottom in the
#: window, and the scroll position.
_PLACE = """((wanted) => {
  const plain = (text) => text.replace(/\\s+/g, " ");
  const holds = (item) => wanted.every((text) => plain(item.textContent).includes(text));
  const items = [...document.querySelectorAll("article :is(tr, li, p)")].filter((item) => holds(item));
  const found = items.find((item) => ![...item.querySelectorAll("tr, li, p")].some(holds)
    && (item.cells?.[0] ?? item).checkVisibility());
  if (!found) return null;
  const boxes = found.cells ? [...found.cells] : [found];
  const ends = boxes.map((item) => item.getBoundingClientRect());
  return [Math.min(...ends.map((one) => one.top)), Math.max(...ends.map((one) => one.bottom)), scrollY];
})(%s)"""


@dataclass(frozen=True)
class Seen:
    """The first hit, and in screens: the top of the answer on its page, and its end below the top of the window."""

    hit: str
    top: float
    below: float

    def row(self, code: str, task: str, query: str, width: int) -> str:
        return f"| {code} | {task} | {query} | {self.hit} | {width} | {self.top:.2f} | {self.below:.2f} |"


@pytest.fixture(scope="session")
def site(made_once: Callable[[str, Callable[[Path], object]], Path]) -> Path:
    pytest.importorskip("myst_parser", reason="the extra 'site' is not installed")
    return made_once("site", lambda folder: build(folder / "site")) / "site"


@pytest.fixture
def browser(tmp_path: Path) -> Iterator[Browser]:
    require([CHROMIUM])
    with Browser(tmp_path / "profile") as opened:
        yield opened


def search(site: Path, browser: Browser, query: str) -> None:
    """Type into the search of the start page, and press Enter."""
    browser.open((site / "index.html").as_uri())
    browser.run(f'document.querySelector("header input[type=search]").value = {json.dumps(query)}; 0')
    browser.run('document.querySelector("header form").submit()')
    browser.wait()


def find_answer(site: Path, browser: Browser, query: str, rows: list[str], height: int) -> Seen | str:
    """Search, click on the first hit, and return where the answer is, or the row that is not in sight."""
    search(site, browser, query)
    hit = browser.run(f'{_FIRST}?.getAttribute("href") ?? ""')
    if not hit:
        return "no hit"
    if ", not " not in rows[0]:
        browser.run(f"{_FIRST}.click()")
        browser.wait()
        browser.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    places: list[Any] = []
    for row in rows:
        place = browser.run(_PLACE % json.dumps([text.strip() for text in row.split(" | ")]))
        if place is None:
            return f"{hit}: not in sight: {row}"
        places.append(place)
    top = max(at + scroll for at, _, scroll in places) / height
    # An answer above the window is as far away as one has to scroll back.
    below = max(max(bottom, height - at) for at, bottom, _ in places) / height
    assert browser.complaints == []
    return Seen(hit.rpartition("/")[2], top, below)


@pytest.mark.parametrize(("width", "height", "limit"), SCREENS)
def test_a_label_and_a_word_lead_to_the_answer(
    site: Path, browser: Browser, width: int, height: int, limit: float
) -> None:
    browser.look(width, height=height)
    failures = []
    for code, answers in ANSWERS.items():
        assert answers.keys() == QUERIES.keys()
        for task, rows in answers.items():
            query = f"{code} {QUERIES[task]}"
            answer = find_answer(site, browser, query, rows, height)
            if isinstance(answer, str):
                failures.append(f"{query}: {answer}")
                continue
            print(answer.row(code, task, QUERIES[task], width))
            # At 1280 pixels, the answer is also in the first one and a half screens of its page.
            if answer.below > limit or (width > 1000 and answer.top > limit):
                failures.append(f"{query}: {answer}")
    assert failures == []


@pytest.mark.parametrize(("label", "words"), OTHER_LABELS.items())
def test_a_label_that_is_not_listed_is_answered_by_the_search(
    site: Path, browser: Browser, label: str, words: str
) -> None:
    browser.look(375, height=760)
    search(site, browser, label)
    assert words in browser.run('document.getElementById("search-results").innerText')


#: An order code, cable lengths in metres, and the text of the slider for each.
SLIDER = [
    ("amm5/AMM5A21-65KSC1", {"10": "10 m: up to 10 MHz, frame 4.7 µs", "30": "30 m: up to 2 MHz, frame 23.5 µs",
                             "60": "60 m: up to 2 MHz, frame 23.5 µs", "80": "80 m: up to 1 MHz, frame 47 µs"}),
    ("asc85/ASC8525-BG1", {"30": "30 m: below 400 kHz, frame longer than 62.5 µs",
                           "50": "50 m: below 300 kHz, frame longer than 83.3 µs"}),
    ("am36/AM3616-4096-I7", {"500": "500 m: up to 200 kHz, frame 230 µs"}),
]  # fmt: skip
_SLIDE = """(() => {
  const input = document.querySelector("#clock-and-cable input[type=range]");
  const said = [];
  for (let at = 0; at <= Number(input.max); at += 1) {
    input.value = at;
    input.dispatchEvent(new Event("input"));
    const chosen = document.querySelectorAll("#clock-and-cable tr.chosen").length;
    said.push([input.nextElementSibling.textContent, input.getAttribute("aria-valuetext"), chosen]);
  }
  return said;
})()"""


@pytest.mark.parametrize(("page", "expected"), SLIDER)
def test_the_slider_gives_the_clock_for_a_cable(
    site: Path, browser: Browser, page: str, expected: dict[str, str]
) -> None:
    browser.look(1280)
    browser.open((site / f"generated/docs/{page}.html").as_uri())
    slider_states = browser.run(_SLIDE)
    assert all(spoken == printed and chosen == 1 for printed, spoken, chosen in slider_states)
    printed_texts = {text.partition(" m:")[0]: text for text, _, _ in slider_states}
    assert {metres: printed_texts[metres] for metres in expected} == expected


#: An order code, typed numbers, and the bytes that the rows then have. The first is the example of the manual of AMM5.
PRESETS = [
    ("amm5/AMM5A21-65KSC1", "1000003", "00 30 24 F4 00 00 00"),
    ("amm5/AMM5A21-65KSC1", "1,000,003", "00 30 24 F4 00 00 00"),
    ("amm5/AMM5A21-65KSC1", "0xF4243", "00 30 24 F4 00 00 00"),
    ("amm5/AMM5A21-65KSC1", "137438953471", "00 F0 FF FF FF FF 01"),
    ("amm5/AMM5A23-1SC1", "1", "00 04 00 00 00 00 00"),
    ("am36/AM3616-4096-I7", "1000", "00 00 00 03 E8"),
    ("sma21/SMA21-SC1-0050", "1000", "00 00 03 E8"),
    ("amm5/AMM5A21-65KSC1", "0", "00 00 00 00 00 00 00"),
]
_PRESET = """((typed) => {
  const input = document.getElementById("preset-number");
  const first = input.value;
  input.value = typed;
  input.dispatchEvent(new Event("input"));
  const textsOf = (found) => [...document.querySelectorAll(found)].map((item) => item.textContent);
  return [first, input.nextElementSibling.textContent, textsOf("#what-to-send td code.chosen"),
          input.getAttribute("aria-invalid"), textsOf("#what-to-send td code"),
          document.getElementById("preset-of-rows").textContent];
})(%s)"""


@pytest.mark.parametrize(("page", "typed", "data"), PRESETS)
def test_the_bytes_follow_the_typed_preset(site: Path, browser: Browser, page: str, typed: str, data: str) -> None:
    browser.open((site / f"generated/docs/{page}.html").as_uri())
    first, printed, rows, invalid, _, about = browser.run(_PRESET % json.dumps(typed))
    assert (first, printed, invalid) == ("0", data, "false")
    assert len(rows) >= 1
    assert set(rows) == {data}
    assert about == f"The preset is {int(typed.replace(',', ''), 0):,} in these rows."


@pytest.mark.parametrize(
    ("page", "typed", "words"),
    [
        ("amm5/AMM5A21-65KSC1", "137438953472", "The highest preset is 137438953471."),
        ("am36/AM3616-4096-I7", "68719476736", "The highest preset is 68719476735."),
        ("amm5/AMM5A21-65KSC1", "abc", "Type a whole number, such as 1000 or 0x3E8."),
        ("amm5/AMM5A21-65KSC1", "-1", "Type a whole number, such as 1000 or 0x3E8."),
        ("amm5/AMM5A21-65KSC1", "", "Type a whole number, such as 1000 or 0x3E8."),
    ],
)
def test_a_preset_that_does_not_fit_leaves_no_bytes(
    site: Path, browser: Browser, page: str, typed: str, words: str
) -> None:
    """The position of AMM5A21/65KSC1 has 37 bits. No row keeps the bytes of an earlier preset."""
    browser.open((site / f"generated/docs/{page}.html").as_uri())
    _, _, earlier, _, before, _ = browser.run(_PRESET % json.dumps("1000"))
    _, message, chosen, invalid, rows, about = browser.run(_PRESET % json.dumps(typed))
    assert (message, chosen, invalid) == (words, [], "true")
    assert rows == ["…" if cell in earlier else cell for cell in before]
    assert "The preset is 1,000" not in about


#: A page with its frame, the field that is pointed at, and what is shown about it. The frame of AMM5 is the manual's
#: preset example, 1,000,003 counts, with both flags inactive. Its CRC is computed in ``test_browser_codec.py``.
DRAWN = [
    ("#code=AMM5A21/65KSC1&frame=0x0F4243D3", "error", "error: bit 7, no (1). No active error. Manual 6.2.1 p.32"),
    ("#code=AMM5A21/65KSC1&frame=0x0F4243D3", "singleturn",
     "singleturn: bits 28:8, 1000003 counts (0xf4243). Position within one revolution. Manual 6.2.1 p.32"),
]  # fmt: skip
_DRAWN = """((name, how) => {
  const cell = [...document.querySelectorAll(".codewheel-decode-cell")]
    .find((item) => item.getAttribute("aria-label").startsWith(`${name}:`));
  if (how === "focus") cell.focus();
  else cell.dispatchEvent(new Event(how));
  const lit = [...document.querySelectorAll("tr.codewheel-decode-lit th")].map((item) => item.firstChild.textContent);
  const bits = [...document.querySelectorAll(".codewheel-decode-bits")].map((item) => item.textContent).join("");
  return [document.querySelector(".codewheel-decode-about").textContent, cell.getAttribute("aria-label"), lit, bits];
})(%s, %s)"""


@pytest.mark.parametrize(("address", "name", "expected_text"), DRAWN)
@pytest.mark.parametrize("how", ["pointerenter", "focus"])
def test_a_field_of_the_drawn_frame_shows_value_and_source(
    site: Path, browser: Browser, address: str, name: str, expected_text: str, how: str
) -> None:
    browser.open("about:blank")
    browser.open((site / "decode.html").as_uri() + address)
    about, label, lit, bits = browser.run(_DRAWN % (json.dumps(name), json.dumps(how)))
    assert about.lower() == label.lower() == expected_text.lower()
    assert lit == [name]
    assert bits == f"{0x0F4243D3:045b}"


def test_the_sidebar_lists_the_folds_and_registers_lead_to_the_encoder(site: Path, browser: Browser) -> None:
    browser.look(1280, height=800)
    browser.open((site / "generated/docs/amm5/AMM5A21-65KSC1.html").as_uri())
    browser.run("document.querySelector('.sections a[href=\"#fold-registers\"]').click()")
    assert browser.run('document.getElementById("register-preset").checkVisibility()') is True
    browser.run('document.querySelector("#register-preset").parentElement.querySelector("small:last-child a").click()')
    browser.wait()
    assert "decode.html#code=AMM5A21%2F65KSC1&as=preset" in browser.run("location.href")
    assert "Preset, registers 11h to 17h" in browser.run('document.querySelector("select").selectedOptions[0].text')


def test_without_a_script_the_rows_remain(site: Path, browser: Browser) -> None:
    browser.call("Emulation.setScriptExecutionDisabled", value=True)
    browser.open((site / "generated/docs/amm5/AMM5A21-65KSC1.html").as_uri())
    text = browser.run('document.querySelector("article").textContent')
    assert "200 m" in text
    assert "11h to 17h: 00 00 00 00 00 00 00" in " ".join(text.split())
    assert browser.run('document.querySelectorAll("input[type=range], #preset-number").length') == 0
