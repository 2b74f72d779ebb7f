"""The page in a real browser, and its source."""

from __future__ import annotations

import html
import itertools
import json
import re
import subprocess
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest
from browser_harness import browser, program
from chromium import Browser
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device, Flag
from codewheel.reference import codec
from codewheel.targets import Library
from codewheel.targets.browser.files import generate


def text_in(path: str, library: Library) -> str:
    return generate(library)[f"browser/{path}"]


# ------------------------------------------------------------ source


def test_the_script_is_a_classic_one_that_asks_for_nothing(library: Library) -> None:
    """It works from a file, under a strict policy of its own, and text of specs never becomes markup."""
    script = text_in("decode.js", library)
    words = r"\b(?:import|export|fetch|eval|innerHTML|outerHTML|insertAdjacentHTML|XMLHttpRequest|localStorage)\b"
    table = re.search(r"^  const TABLE = (.*);$", script, re.MULTILINE)
    assert table is not None
    assert re.findall(words, script.replace(table[1], "")) == []
    assert re.findall(r"https?:", script) == []
    assert json.loads(table[1])["families"]


def test_the_page_has_one_script_and_no_handlers(library: Library) -> None:
    page = text_in("decode.html", library)
    assert re.findall(r"<script[^>]*>", page) == ['<script src="decode.js">']
    assert re.findall(r"\son\w+=", page) == []
    assert "https:" not in page


def test_every_file_says_its_licence(library: Library) -> None:
    assert all("0BSD" in text for text in generate(library).values())


def test_all_order_codes_are_there(library: Library) -> None:
    script = text_in("decode.js", library)
    assert all(f'"{variant.code}"' in script for device in library.devices for variant in device.variants)


@pytest.mark.slow
def test_the_same_every_time(library: Library) -> None:
    assert generate(library) == generate(library)


@pytest.mark.slow
def test_no_text_of_a_spec_ends_the_script(hostile: Library) -> None:
    """The same holds for the page: texts with the special characters of all languages are unchanged in the table."""
    for device in hostile.devices:
        script = text_in("decode.js", Library((device,)))
        table = re.search(r"^  const TABLE = (.*);$", script, re.MULTILINE)
        assert table is not None
        assert not re.search(r"[<>&\u2028\u2029]", table[1])
        assert json.loads(table[1])["families"][0]["title"] == device.title
    outputs = generate(hostile)
    assert re.findall(r"<script[^>]*>", outputs["browser/decode.html"]) == ['<script src="decode.js">']
    assert not any("<script>alert" in text for text in outputs.values())


# ------------------------------------------------------------ use


@pytest.fixture(scope="session")
def chromium() -> str:
    return program("chromium")


def run_in_page(chromium: str, folder: Path, script: str, boxes: str = '<div class="codewheel-decode"></div>') -> Any:
    """Return the result of a script in a page with these boxes, once they exist. Errors of the page fail the test."""
    page = f"""<!DOCTYPE html><meta charset="utf-8"><body>{boxes}<script>
const errors = []; addEventListener("error", (event) => errors.push(event.message));</script>
<script src="decode.js"></script><script>
const fire = (input, name) => input.dispatchEvent(new Event(name, {{ bubbles: true }}));
const type = (input, text) => {{ input.value = text; fire(input, "input"); }};
const choose = (input, text) => {{ input.value = text; fire(input, "change"); }};
const said = (box) => box.querySelector(".codewheel-decode-result").innerText;
const named = (box, name) => [...box.querySelectorAll("label")].find((one) => one.innerText === name).control;
addEventListener("DOMContentLoaded", () => {{
  const boxes = [...document.querySelectorAll("div.codewheel-decode")];
  const answer = (() => {{ {script} }})();
  const shown = document.createElement("pre");
  shown.textContent = JSON.stringify({{ answer, errors }});
  document.body.replaceChildren(shown);
}});</script>"""
    (folder / "run.html").write_text(page, encoding="utf-8")
    command = [*browser(chromium, folder), "--dump-dom", (folder / "run.html").as_uri()]
    completed = subprocess.run(command, capture_output=True, text=True, timeout=200, check=False)
    answer_element = re.search(r"<pre>(.*)</pre>", completed.stdout, re.DOTALL)
    assert answer_element is not None, (completed.stdout[-1000:], completed.stderr[-1000:])
    result = json.loads(html.unescape(answer_element[1]))
    assert result["errors"] == []
    return result["answer"]


STEPS = """
  const [box, other] = boxes, [code, what, text] = box.querySelectorAll("input, select, textarea");
  const seen = {};
  seen.other = other.querySelector("input").value;
  seen.otherEvidence = said(other);
  type(code, "AMM5A23/65KJP1-xyz"); type(text, "02 20 C7 D1 6A 5E"); seen.reports = said(box);
  type(text, "02 00 C7 D1 6A 7F"); seen.fault = said(box);
  type(code, ""); type(text, "zz"); seen.notation = said(box); type(text, "256000979"); seen.decimal = said(box);
  type(text, "02 00 C7 D1 6A 7E"); seen.inferred = said(box);
  box.querySelector(".codewheel-decode-codes button").click(); seen.picked = said(box); seen.code = code.value;
  type(code, "AMM5A21/65KSC1"); type(text, "0xF4243D2"); seen.why = said(box);
  type(text, "256000979");
  const spellings = [...box.querySelectorAll(".codewheel-decode-codes button")];
  seen.spellings = spellings.map((one) => one.innerText); spellings[0].click(); seen.spelled = [text.value, said(box)];
  type(text, "# times\\n 0.256000979 256000979 # as printed");
  box.querySelector(".codewheel-decode-codes button").click(); seen.afterTime = text.value;
  type(text, "0x0"); seen.low = said(box); type(text, "0b" + "1".repeat(45)); seen.high = said(box);
  type(code, "AMM5A23/65KBG1"); type(text, "0x0"); seen.ssi = said(box); type(code, "AMM5A21/65KSC1");
  choose(what, "=preset"); type(text, "00 30 24 f4 00 00 00"); seen.preset = said(box);
  seen.position = named(box, "position").value;
  type(named(box, "position"), "1000004"); seen.bytes = text.value;
  type(named(box, "position"), "137438953472"); seen.refused = box.querySelector("[role=alert]").innerText;
  seen.kept = text.value;
  choose(what, "=serial_number"); seen.readOnly = box.querySelectorAll("fieldset").length;
  type(code, "AMM5A23/65KJP1"); choose(what, "master"); type(text, "ea 01 eb"); seen.open = said(box);
  const [asPrinted, asTFormat] = box.querySelectorAll("input[type=radio]");
  seen.chosen = asPrinted.checked || asTFormat.checked;
  asTFormat.click(); seen.decided = said(box);
  type(code, "ASC8520/SC1"); type(text, "0b" + "1".repeat(31)); seen.openLength = said(box);
  type(code, "AM3619/4096-I7"); type(text, "0x0"); seen.delivered = said(box);
  type(box.querySelector("details input"), "12"); seen.held = said(box);
  type(code, "nothing/1"); seen.unknown = said(box);
  type(code, "AMM5A21/65KSC2"); type(text, "0xF4243D3");
  const near = box.querySelectorAll(".codewheel-decode-bad button");
  seen.near = [...near].map((one) => one.innerText); near[0].click(); seen.corrected = [code.value, said(box)];
  type(code, "AMM5A23/65KJP2"); type(text, "02 00 C7 D1 6A 7E");
  seen.guesses = [...box.querySelectorAll("li button")].map((one) => one.innerText);
  seen.nearest = [...box.querySelectorAll(".codewheel-decode-bad button")].map((one) => one.innerText);
  type(text, "02 00 C7 D1 6A 7F"); seen.noGuess = said(box);
  type(code, "ssi:position=13,error"); seen.wrongLine = said(box);
  type(code, "rs485,high_byte_first:address=8,function=8:3,position=32,crc=16:0x8005:0xffff:reflected:low_byte_first");
  type(text, "03 00 00 17 E9 8B B4"); seen.wideCrc = said(box);
  return seen;
"""


@pytest.fixture(scope="session")
def steps(chromium: str, page: Path) -> dict[str, Any]:
    """Return everything that a user sees at each step, for one start of the browser."""
    box_of_code = '<div class="codewheel-decode" data-code="SMA21-SC4-0050" data-evidence-above></div>'
    boxes = f'<div class="codewheel-decode"></div>{box_of_code}'
    result: dict[str, Any] = run_in_page(chromium, page, STEPS, boxes)
    return result


FRAME_WITHOUT_BITS = """
  const [box] = boxes, [code, , text] = box.querySelectorAll("input, select, textarea");
  const picture = document.querySelector("#frame .codewheel-decode-picture");
  const isPrintedShown = () => getComputedStyle(document.querySelector("#frame picture")).display !== "none";
  const cells = (part) => [...part.querySelectorAll("button")].map((cell) => cell.innerText.replace(/\\s+/g, " "));
  const seen = { empty: cells(picture), inBox: cells(box.querySelector(".codewheel-decode-result")) };
  seen.isPrintedShown = isPrintedShown();
  picture.querySelectorAll("button")[2].focus(); seen.about = picture.querySelector("p").innerText;
  type(text, "0xF4243D3"); seen.filled = cells(picture);
  type(code, "ASC8520/SC1"); type(text, ""); seen.open = [cells(picture), isPrintedShown()];
  return seen;
"""


@pytest.mark.slow
def test_the_picture_of_a_frame_is_a_drawing_that_a_pasted_frame_fills(chromium: str, page: Path) -> None:
    """Places and active levels of the AMM5 manual, 6.2.1 p.32. Bits of a frame with a question stay as printed."""
    box = '<div class="codewheel-decode" data-code="AMM5A21/65KSC1" data-picture="frame"></div>'
    section = '<section id="frame"><picture><img alt="45 bits"></picture></section>'
    seen = run_in_page(chromium, page, FRAME_WITHOUT_BITS, f"{section}{box}")
    assert seen["empty"] == ["44:29 multiturn", "28:8 singleturn", "7 error", "6 warning", "5:0 crc"]
    assert seen["inBox"] == []
    assert not seen["isPrintedShown"]
    assert seen["about"].startswith("error: bit 7, 0 = active. ")
    assert seen["about"].endswith("Manual 6.2.1 p.32")
    bits = ["0000000000000000 multiturn", "011110100001001000011 singleturn", "1 error", "1 warning", "010011 crc"]
    assert seen["filled"] == bits
    assert seen["open"] == [[], True]


@pytest.mark.slow
def test_a_box_has_the_order_code_of_its_element(steps: dict[str, Any]) -> None:
    assert steps["other"] == "SMA21-SC4-0050"


@pytest.mark.slow
def test_the_evidence_is_not_repeated_below_a_box_on_a_page_that_states_it(steps: dict[str, Any]) -> None:
    assert "Evidence:" not in steps["otherEvidence"]
    assert "Evidence: manual" in steps["reports"]


@pytest.mark.slow
def test_fields_reports_and_verdict(steps: dict[str, Any]) -> None:
    """The published reply of an AMM5, and the manual's remedy."""
    assert "not_usable: the position is not usable." in steps["reports"]
    assert "status_other_error: BUSY flag, PS error, battery alarm or MT error" in steps["reports"]
    assert "7000519 counts" in steps["reports"]
    assert "The label continues with -XYZ." in steps["reports"]
    assert "°" not in steps["reports"]


@pytest.mark.slow
def test_a_fault_in_the_words_of_the_command(steps: dict[str, Any]) -> None:
    assert "crc error: expected CRC 0x7e, got 0x7f" in steps["fault"]
    assert "codewheel decode" not in steps["fault"]
    early = steps["why"].index("started one clock early: an extra bit such as CDS is in front")
    bit = "one bit may have been corrupted on the line: the CRC matches with bit 0 inverted"
    assert 0 < steps["why"].index(bit) < early
    # On a phone, the table of fields is several screens long.
    assert early < steps["why"].index("Point at a field")
    assert "Every bit is 0: the line never changes." in steps["low"]
    assert "Every bit is 1: the line never changes." in steps["high"]
    assert "Every bit is 0. A dead line looks the same" in steps["ssi"]


@pytest.mark.slow
def test_an_order_code_that_is_left_out(steps: dict[str, Any]) -> None:
    assert steps["notation"].startswith(
        "'zz' is not a frame. Write 0b and all bits in the order sent, 0x and hex digits"
    )
    assert "Write 0xF4243D3 if it is decimal, 0x256000979 if it is hex." in steps["decimal"]
    assert "AMM5A23/65KJP1" in steps["inferred"]
    assert "with a correct CRC" in steps["inferred"]
    assert steps["code"] == "AMM5A23/1JP1"
    assert "usable: no error. the position is usable." in steps["picked"].lower()
    assert "NOTHING/1" in steps["unknown"].upper()


@pytest.mark.slow
def test_the_meanings_of_digits_are_buttons(steps: dict[str, Any]) -> None:
    assert steps["spellings"] == ["0xF4243D3", "0x256000979"]
    assert steps["spelled"][0] == "0xF4243D3"
    assert "1000003 counts" in steps["spelled"][1]
    assert steps["afterTime"] == "# times\n 0.256000979 0xF4243D3 # as printed"


@pytest.mark.slow
def test_a_wrong_order_code_has_the_nearest_ones_as_buttons(steps: dict[str, Any]) -> None:
    assert steps["near"] == ["AMM5A21/65KSC1", "AMM5A17/65KSC1", "AMM5A23/65KSC1"]
    assert steps["corrected"][0] == "AMM5A21/65KSC1"
    assert "1000003 counts" in steps["corrected"][1]


@pytest.mark.slow
def test_beside_a_wrong_order_code_only_the_nearest_ones_are_guessed(steps: dict[str, Any]) -> None:
    """A frame that is wrong for them too is not called wrong for all order codes, since a mistake may explain it."""
    assert steps["guesses"]
    assert set(steps["guesses"]) <= set(steps["nearest"])
    assert "not valid for any order code" not in steps["noGuess"]
    assert "'error' has no active level" in steps["wrongLine"]
    assert "not valid for any order code" not in steps["wrongLine"]


@pytest.mark.slow
def test_with_a_wide_crc_over_bytes_a_lost_byte_is_found(
    steps: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    """MODBUS: the CRC of 16 bits shows which address is missing."""
    line = "rs485,high_byte_first:address=8,function=8:3,position=32,crc=16:0x8005:0xffff:reflected:low_byte_first"
    assert main(["decode", line, "03 00 00 17 E9 8B B4"]) == 1
    for text in (steps["wideCrc"], " ".join(capsys.readouterr().out.split())):
        assert "the first byte (01) is missing" in text
        assert "did not look for mistakes" not in text


@pytest.mark.slow
def test_registers_both_ways(steps: dict[str, Any]) -> None:
    """1,000,003 in the preset: low byte first, and the singleturn position ends at bit 32."""
    assert "1000003" in steps["preset"]
    assert steps["position"] == "1000003"
    assert steps["bytes"] == "00 40 24 F4 00 00 00"
    assert steps["refused"]
    assert steps["kept"] == steps["bytes"]
    assert steps["readOnly"] == 0


@pytest.mark.slow
def test_what_the_manual_leaves_open_is_asked_for(steps: dict[str, Any]) -> None:
    assert "The manual is ambiguous here" in steps["open"]
    assert "address" not in steps["open"]
    assert steps["chosen"] is False
    assert "address" in steps["decided"]
    # Whether its zero bit is sent decides the length of this frame.
    assert "The manual is ambiguous here" in steps["openLength"]
    assert "length error" not in steps["openLength"]


@pytest.mark.slow
def test_registers_that_change_a_frame(steps: dict[str, Any]) -> None:
    """By default, singleturn has 20 bits and multiturn 16. Then singleturn has 12."""
    assert "44 bits" in steps["delivered"]
    assert "36 bits" in steps["held"]


OTHERS = """
  const [code, what, text] = boxes[0].querySelectorAll("input, select, textarea");
  const seen = {};
  type(code, "AMT212B"); type(text, "AB 61"); seen.also = said(boxes[0]);
  seen.types = [...what.options].map((one) => one.innerText);
  choose(what, "encoder:turns_reply"); seen.turns = said(boxes[0]);
  seen.link = boxes[0].querySelector("p.codewheel-decode-link a").getAttribute("href");
  type(code, "AMT212A"); choose(what, "encoder:position_reply"); type(text, "AB 61"); seen.otherCode = said(boxes[0]);
  type(code, "SKM36"); type(text, "40 52 00 00 00 00 12"); seen.instead = said(boxes[0]);
  type(code, "AMT22-14"); type(text, "61 AB C0 00"); seen.byLength = said(boxes[0]);
  seen.chosen = what.selectedOptions[0].innerText;
  return seen;
"""


@pytest.mark.slow
def test_other_frames_that_it_can_be(chromium: str, tmp_path: Path) -> None:
    """The replies of the AMT21 have the same form, and those of the SKM36 the same length."""
    folder = Path(__file__).parents[2] / "specs"
    devices, report = load_library([folder / "cui", folder / "sick"])
    assert not report
    (tmp_path / "decode.js").write_text(text_in("decode.js", Library(devices)), encoding="utf-8")
    result = run_in_page(chromium, tmp_path, OTHERS)
    assert "This can also be another frame: turns reply. Choose it above." in result["also"]
    requests = [f"{name} request, from the master" for name in ("position", "turns", "zero", "reset")]
    assert result["types"] == [*requests, "position reply, from the encoder", "turns reply, from the encoder"]
    assert "Turns reply, 2 bytes" in result["turns"]
    assert "This can also be another frame: position reply. Choose it above." in result["turns"]
    assert result["link"] == "#code=AMT212B&frame=AB+61&from=encoder%3Aturns_reply"
    valid_turns = "This is a valid turns reply. Choose it above."
    assert f"{valid_turns} Another reading: 16 bits, the frame of AMT212B and 3 more." in result["otherCode"]
    assert "This is a valid type label reply. Choose it above." in result["instead"]
    assert "possible explanations" not in result["instead"].lower()
    assert result["chosen"] == "a frame of any length, from the encoder"
    assert "turns" in result["byLength"]
    assert "length error" not in result["byLength"]


COLOURS = r"""
  const [code, what, text] = boxes[0].querySelectorAll("input, select, textarea");
  return FRAMES.map(([label, frame]) => {
    type(code, label); type(text, frame);
    const box = boxes[0].querySelector(".codewheel-decode-result > div");
    const line = getComputedStyle(box).borderInlineStartColor.match(/\d+/g).map(Number);
    return [said(boxes[0]), line];
  });
"""


def colour(red: int, green: int, blue: int) -> str:
    if red > 2 * green:
        return "red"
    if green > max(red, blue):
        return "green"
    return "amber" if green > blue else "grey"


def with_flags(devices: Iterable[Device]) -> Iterator[tuple[str, str]]:
    """Yield an order code of each family over BiSS and a frame, for each combination of its flags."""
    for device in devices:
        variant = next(variant for variant in device.variants if variant.interface == "biss")
        layout = next(layout for _, layout in device.layouts() if layout.name == "single_cycle_data")
        placed = layout.place(variant.parameters)
        names = [field.name for field in placed.fields if field.field.carries_data]
        flags = [field.name for field in placed.fields if isinstance(field.field.kind, Flag)]
        for states in itertools.product((False, True), repeat=len(flags)):
            values = {**dict.fromkeys(names, 0), **dict(zip(flags, states, strict=True))}
            yield variant.code, f"0x{codec.encode(device, placed, values):x}"


@pytest.mark.slow
def test_the_colour_of_the_box_is_that_of_the_verdict(chromium: str, page: Path, library: Library) -> None:
    with_crc_error = ("AMM5A23/65KJP1", "02 00 C7 D1 6A 7F")
    frames = json.dumps([with_crc_error, *with_flags(library.devices)])
    colours = {"usable": "green", "usable_with_warning": "amber", "not_usable": "red", "crc error": "red"}
    verdicts = set()
    for message, line in run_in_page(chromium, page, COLOURS.replace("FRAMES", frames)):
        # A note about the order code is not the answer.
        verdict = re.sub(r"^Made-up order code: .*\n+", "", message).partition(":")[0]
        verdicts.add(verdict)
        # A question to the reader has the colour of a warning, since nothing is decoded until it is answered.
        is_question = message.startswith("The manual is ambiguous here")
        assert colour(*line) == ("amber" if is_question else colours.get(verdict, "grey")), message
    assert verdicts > set(colours)


LINKED = '<div class="codewheel-decode" data-link></div>'
LINK = """
  location.hash = "#code=AMM5A21/65KSC1&as=preset&frame=00+30+24+f4+00+00+00";
  dispatchEvent(new Event("hashchange"));
  const [code, what, text] = boxes[0].querySelectorAll("input, select, textarea");
  const linked = [code.value, what.value, text.value, said(boxes[0]), boxes[0].querySelector("a").getAttribute("href")];
  history.replaceState = () => { throw new DOMException("Too many calls", "SecurityError"); };
  type(text, "00 40 24 f4 00 00 00");
  return [...linked, said(boxes[0])];
"""


@pytest.mark.slow
def test_a_link_fills_the_page_in(chromium: str, page: Path) -> None:
    code, frame_choice, text, result, link, later_result = run_in_page(chromium, page, LINK, LINKED)
    assert (code, frame_choice, text) == ("AMM5A21/65KSC1", "=preset", "00 30 24 f4 00 00 00")
    assert "1000003" in result
    assert link == "#code=AMM5A21%2F65KSC1&frame=00+30+24+f4+00+00+00&as=preset"
    # The browser rejected a change of the address, as it does while someone types fast.
    assert "1000004" in later_result


DAMAGED = """
  const seen = [];
  for (const answer of ["", "=", "=no_answer", "=as_t_format"]) {
    const answers = `choose=adf_layout${answer}&choose=no_question=1`;
    location.hash = `#code=AMM5A23%2F65KJP1&frame=ea+01+eb&from=master&${answers}`;
    dispatchEvent(new Event("hashchange"));
    seen.push(said(boxes[0]));
  }
  return seen;
"""


@pytest.mark.slow
def test_a_link_with_an_unknown_answer_leaves_the_question_open(chromium: str, page: Path) -> None:
    *damaged, whole = run_in_page(chromium, page, DAMAGED, LINKED)
    assert ["The manual is ambiguous here" in text for text in damaged] == [True] * 3
    assert "ambiguous" not in whole
    assert "address" in whole


OTHER_FAMILY = """
  const [code, what, text] = boxes[0].querySelectorAll("input, select, textarea");
  const seen = {};
  type(text, "0x7F");
  type(code, "MA732"); seen.alone = [what.value, said(boxes[0])];
  type(code, "AS5047P"); choose(what, "encoder:position");
  seen.wanted = [...what.options].map((option) => option.value).find((value) => value.startsWith("master:"));
  type(code, "MA732"); seen.after = [what.value, said(boxes[0])];
  location.hash = `#code=AS5047P&frame=0x7F&from=${seen.wanted}`;
  dispatchEvent(new Event("hashchange")); seen.linked = what.value;
  return seen;
"""


@pytest.mark.slow
def test_the_code_of_another_family_begins_with_its_own_type(chromium: str, tmp_path: Path) -> None:
    """Both families have a frame named position, one of several lengths of the second."""
    folder = Path(__file__).parents[2] / "specs"
    devices, report = load_library([folder / "ams", folder / "mps"])
    assert not report
    (tmp_path / "decode.js").write_text(text_in("decode.js", Library(devices)), encoding="utf-8")
    result = run_in_page(chromium, tmp_path, OTHER_FAMILY, LINKED)
    assert result["after"] == result["alone"]
    assert result["linked"] == result["wanted"]


MANY = r"""
  const [code, what, text] = boxes[0].querySelectorAll("input, select, textarea");
  const result = boxes[0].querySelector(".codewheel-decode-result");
  type(code, "AMM5A19/65KSC1");
  const help = said(boxes[0]);
  type(code, "AMM5A21/65KSC1");
  type(text, "# bench\n\n0.001 0xF4243D3\n0.002, [0x00, 0x00, 0x0F, 0x42, 0x43, 0xD2]\n3 ms zz\n");
  const texts = (row) => [...row.cells].map((cell) => cell.innerText.trim());
  const rows = [...result.querySelectorAll("tbody tr")].map(texts);
  const address = new URLSearchParams(location.hash.slice(1)).get("frame");
  let csv = "";
  navigator.clipboard.writeText = (given) => { csv = given; return Promise.resolve(); };
  result.querySelector(".codewheel-decode-exports button").click();
  result.querySelectorAll("tbody button")[1].click();
  return { help, rows, address, csv, full: result.querySelector(".codewheel-decode-full").innerText };
"""


@pytest.mark.slow
def test_many_frames_give_a_table(chromium: str, page: Path) -> None:
    result = run_in_page(chromium, page, MANY, LINKED)
    assert "'AMM5A19/65KSC1' has singleturn '19'; valid values: 17, 21, 23." in result["help"]
    assert [[row[0], row[1], row[3]] for row in result["rows"]] == [
        ["3", "0.001", "usable"],
        ["4", "0.002", "CRC error"],
        ["5", "3 ms", "not a frame"],
    ]
    assert "position 1000003" in result["rows"][0][4]
    assert "171.6619° of revolution 0" in result["rows"][0][4]
    assert result["rows"][1][5] == "expected CRC 0x13, got 0x12"
    assert "'zz' is not a frame of 45 bits. Write 0b and all 45 bits" in result["rows"][2][5]
    assert result["address"].splitlines()[2] == "0.001 0xF4243D3"
    head, first, second, *_ = result["csv"].splitlines()
    assert head == "line,time,frame,layout,verdict,remark,multiturn,singleturn,error,warning,crc,position"
    assert first == "3,0.001,0xF4243D3,single_cycle_data,usable,,0,1000003,no,no,19,1000003"
    assert second.startswith(
        '4,0.002,"[0x00, 0x00, 0x0F, 0x42, 0x43, 0xD2]",single_cycle_data,,"expected CRC 0x13, got 0x12",'
    )
    assert result["full"].startswith("Line 4")
    assert "one bit may have been corrupted on the line" in result["full"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("line", "frames", "values"),
    [
        ("ssi:status=4,position=24", "0x5000001\\n0x5000002", ["position 1 counts", "position 2 counts"]),
        ("ssi:multiturn=4,singleturn=12", "0x1002\\n0x2003", ["position 4098", "position 8195"]),
        ("ssi:status=8,count=8", "0x0102\\n0x0203", ["status 1", "status 2"]),
    ],
)
def test_the_value_of_many_frames_is_the_position(
    chromium: str, page: Path, line: str, frames: str, values: list[str]
) -> None:
    script = f"""
  const [code, , text] = boxes[0].querySelectorAll("input, select, textarea");
  type(code, "{line}");
  type(text, "{frames}");
  const cells = boxes[0].querySelectorAll("tbody .codewheel-decode-value");
  return [...cells].map((cell) => cell.firstChild.textContent);"""
    assert run_in_page(chromium, page, script) == values


@pytest.mark.slow
def test_a_table_with_times_scrolls_by_itself_on_a_phone(page: Path, tmp_path: Path) -> None:
    """The page around it is as wide as the screen."""
    program("chromium")
    frames = "12:00:00.5+0xF4243D3%0A12:00:01.5+0xF4243D2"
    with Browser(tmp_path) as browser:
        browser.look(375)
        browser.open((page / "decode.html").as_uri() + f"#code=AMM5A21/65KSC1&frame={frames}")
        widths = "[document.querySelector('table').scrollWidth, document.documentElement.scrollWidth]"
        table_width, page_width = browser.run(widths)
        assert table_width > page_width
        assert page_width <= 375
        assert browser.complaints == []


@pytest.mark.slow
def test_the_policy_of_the_page_allows_its_own_script_and_style_only(chromium: str, page: Path, tmp_path: Path) -> None:
    """Open the page as a file, then with parts that an attacker would add."""
    text = (page / "decode.html").read_text(encoding="utf-8")
    added = '<style>h1 { color: red }</style><script>document.title = "added"</script><img src="decode.js">'
    (page / "attacked.html").write_text(text.replace("</main>", f"{added}</main>"), encoding="utf-8")
    page_state = "[document.title, document.body.innerText, getComputedStyle(document.querySelector('h1')).color]"
    with Browser(tmp_path) as browser:
        browser.open((page / "decode.html").as_uri() + "#code=AMM5A23/65KJP1&frame=02+20+C7+D1+6A+5E")
        title, body_text, colour = browser.run(page_state)
        assert title == "Decode a frame: Lika Electronic and iC-Haus"
        assert "not_usable: the position is not usable." in body_text
        assert browser.run("getComputedStyle(document.body).maxWidth") == "960px"
        assert browser.complaints == []
        browser.open((page / "attacked.html").as_uri())
        assert browser.run(page_state)[::2] == [title, colour]
        refused = [complaint for complaint in browser.complaints if "Content Security Policy" in complaint]
        assert len(refused) == 3, browser.complaints


HOSTILE = """
  const [code, what, text] = boxes[0].querySelectorAll("input, select, textarea");
  const fixed = document.querySelectorAll("script").length;
  for (const family of codewheelDecode.table.families) {
    for (const over of family.interfaces) {
      const row = family.codes.find((one) => family.interfaces[one[1]] === over);
      type(code, row[0]);
      type(text, "0x00"); type(text, "00 00 00 00");
      for (const option of what.options) { choose(what, option.value); type(text, "00 01"); }
    }
  }
  return [document.querySelectorAll("script").length - fixed, boxes[0].querySelectorAll("script, img, iframe").length];
"""


@pytest.mark.slow
def test_hostile_texts_stay_texts(chromium: str, hostile: Library, tmp_path: Path) -> None:
    (tmp_path / "decode.js").write_text(text_in("decode.js", hostile), encoding="utf-8")
    assert run_in_page(chromium, tmp_path, HOSTILE) == [0, 0]


@pytest.mark.slow
def test_frames_of_bits_that_nothing_tells_apart_are_chosen(chromium: str, tmp_path: Path) -> None:
    """A reply over SPI does not show which request it answers. 0180h is the value of DIAAGC, or a position of 384."""
    ams = Library(load_library(sorted((Path(__file__).parents[2] / "specs/ams").glob("*.yaml")))[0])
    for path, text in generate(ams).items():
        (tmp_path / Path(path).name).write_text(text, encoding="utf-8")
    script = """
      const [code, what, text] = boxes[0].querySelectorAll("input, select, textarea");
      type(code, "AS5047P"); type(text, "0x0180");
      const seen = [[...what.options].slice(0, 6).map((one) => one.value), said(boxes[0])];
      choose(what, "encoder:register_reply");
      return [...seen, said(boxes[0])];
    """
    options, position, reply = run_in_page(chromium, tmp_path, script)
    requests = ("position_request", "read_request", "write_request", "write_data")
    assert options == [*(f"master:{name}" for name in requests), "encoder:position", "encoder:register_reply"]
    assert "384 counts" in position
    assert "data" in reply
    assert "counts" not in reply
