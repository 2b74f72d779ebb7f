"""The decode page shows both words of a BiSS frame with two data channels, and whether their positions agree."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.targets import Library
from codewheel.targets.browser.files import generate
from test_browser_page import chromium as chromium
from test_browser_page import run_in_page

pytestmark = pytest.mark.slow

SPECS = Path(__file__).resolve().parents[1] / "specs"
#: Frames of RXH: the angle 123456h in the control word, and 1234h or 2234h in the safety word.
CONTROL = "00010010001101000101011011110101"
AGREE = "0b" + CONTROL + "0001001000110100110001010000110111011011"


@pytest.fixture
def folder_with_script(tmp_path: Path) -> Path:
    devices, report = load_library([SPECS / "channels.yaml", SPECS / "manufacturer.yaml"])
    assert not report
    (tmp_path / "decode.js").write_text(generate(Library(devices))["browser/decode.js"], encoding="utf-8")
    return tmp_path


def test_both_words_and_their_verdict(chromium: str, folder_with_script: Path) -> None:
    wrong = AGREE[:-1] + str(1 - int(AGREE[-1]))
    script = f"""
      const [box] = boxes, text = box.querySelector("textarea"), code = named(box, "Order code, as on the label");
      const results = {{}};
      type(text, {json.dumps(AGREE)});
      results.withoutCode = said(box);
      type(code, "RXH");
      results.whole = said(box);
      results.types = [...named(box, "Type").options].map((one) => one.text);
      type(text, {json.dumps(wrong)});
      results.wrong = said(box);
      type(text, {json.dumps(AGREE + "1")});
      results.long = said(box);
      type(text, {json.dumps("0b10" + AGREE[2:] + "0")});
      results.around = said(box);
      type(text, {json.dumps("0b" + AGREE[34:] + CONTROL)});
      results.exchanged = said(box);
      type(text, {json.dumps(AGREE + chr(10) + wrong)});
      results.many = said(box);
      type(text, {json.dumps("0b" + CONTROL)});
      results.alone = said(box);
      return results;
    """
    results = run_in_page(chromium, folder_with_script, script)
    assert "72 bits, with a correct CRC" in results["withoutCode"]
    assert results["types"][0] == "a whole frame, from the encoder"
    assert results["whole"].startswith("usable: ")
    assert "The highest 13 bits agree: singleturn of control_word 0x246" in results["whole"]
    assert "25.6" in results["whole"] or "25.59999" in results["whole"]
    assert "crc error: safety_word: expected CRC" in results["wrong"]
    message = "control_word (32 bits) and safety_word (40 bits) have 72 bits together, got 73: 1 bit is too many."
    assert message in results["long"]
    assert "All CRCs are correct with 2 extra bits before the frame and 1 after it." in results["around"]
    assert "All CRCs are correct with the channels in the order safety_word, control_word." in results["exchanged"]
    assert "All CRCs are correct" not in results["whole"] + results["wrong"]
    assert "Error in safety_word, so the frame has no position." in results["wrong"]
    assert "safety_word: expected CRC" in results["many"]
    assert "highest 13 bits" not in results["alone"]
    assert "usable" in results["alone"]


def test_a_channel_that_is_not_sent_is_left_out(
    chromium: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The order code has no temperature channel, on the page and in the command."""
    folder = SPECS.parents[1] / "specs" / "ichaus"
    devices, report = load_library([folder / "icmr.yaml", folder / "manufacturer.yaml"])
    assert not report
    (tmp_path / "decode.js").write_text(generate(Library(devices))["browser/decode.js"], encoding="utf-8")
    script = """
      const [box] = boxes, text = box.querySelector("textarea"), code = named(box, "Order code, as on the label");
      type(code, "iC-MR-12-N6S");
      type(text, "0x4D2D4");
      return said(box);
    """
    result = run_in_page(chromium, tmp_path, script)
    assert main(["decode", "iC-MR-12-N6S", "0x4D2D4", "--specs", str(folder)]) == 0
    for text in (result, capsys.readouterr().out):
        assert "1234" in text
        assert "TMP" not in text
