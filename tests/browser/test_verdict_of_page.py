"""The result of the page in Node, without a browser: what ``make quick`` sees of the script.

The frames belong to AMM5A21/65KSC1 at position 1,000,003. The first frame is in the README, and the second has nE = 0.
``test_c_round_trip.py`` computes its CRC from the polynomial of the manual (AMM5 6.2.1).
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from browser_harness import library_of, program
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.browser.files import generate

#: A document that only creates elements, and the functions that show a result.
DOCUMENT = """
class Element {
  constructor(tag) { Object.assign(this, { tag, children: [], class: "" }); }
  setAttribute(name, value) { this[name] = value; }
  append(...children) { this.children.push(...children); }
  get text() { return this.children.map((child) => child.text ?? child).join(""); }
}
globalThis.document = { createElement: (tag) => new Element(tag) };
"""
#: The end of the script would look for boxes in a page.
END = "  function start() {"
ASK = """
const wheel = globalThis.codewheelDecode;
const label = wheel.findCode("AMM5A21/65KSC1");
const shown = (text) => {
  const found = wheel.decodeFrame(label, "encoder", text, {}, {});
  const box = wheel.createHeadline(found);
  return [box.class, box.text, wheel.describeMeasurement(found, label.interface.measure)];
};
console.log(JSON.stringify(FRAMES.map(shown)));
"""
USABLE, WITH_ERROR, DAMAGED = "0xF4243D3", "0xF424355", "0xF4243D2"
COUNTS_PER_TURN = 1 << 21


@pytest.fixture(scope="module")
def results(amm5: Device, tmp_path_factory: pytest.TempPathFactory) -> list[list[str]]:
    """Return the class and the text of the coloured line, and the position in degrees, for each frame."""
    script = generate(Library((amm5,)))["browser/decode.js"]
    assert script.count(END) == 1
    script = script.replace(
        END, f"  Object.assign(codewheelDecode, {{ createHeadline, describeMeasurement }});\n  return;\n{END}"
    )
    file = tmp_path_factory.mktemp("page") / "page.js"
    frames = json.dumps([USABLE, WITH_ERROR, DAMAGED])
    file.write_text(DOCUMENT + script + ASK.replace("FRAMES", frames), encoding="utf-8")
    completed = subprocess.run([program("node"), str(file)], capture_output=True, text=True, check=False)
    assert completed.returncode == 0, completed.stderr[-2000:]
    answers: list[list[str]] = json.loads(completed.stdout)
    return answers


@pytest.mark.starts_process
def test_a_box_has_the_colour_of_its_verdict(results: list[list[str]]) -> None:
    usable, with_error, damaged = results
    assert usable[0] == "codewheel-decode-good"
    assert usable[1].startswith("usable: ")
    assert with_error[0] == "codewheel-decode-bad"
    assert with_error[1].startswith("not_usable: ")
    assert damaged[0] == "codewheel-decode-bad"
    assert damaged[1].startswith("crc error: ")


@pytest.mark.starts_process
def test_only_a_usable_position_is_shown_in_degrees(results: list[list[str]]) -> None:
    degrees = 1_000_003 % COUNTS_PER_TURN * 360 / COUNTS_PER_TURN
    assert [angle for _, _, angle in results] == [f"position: {degrees:.4f}° of revolution 0", "", ""]


@pytest.mark.starts_process
def test_an_echo_comes_before_the_verdict(tmp_path: Path) -> None:
    """A word of an AS5048A that is also the request, in which the error flag is set."""
    script = generate(library_of("../specs/ams/as5048a"))["browser/decode.js"]
    script = script.replace(END, f"  Object.assign(codewheelDecode, {{ createEchoNote }});\n  return;\n{END}")
    ask = """
    const wheel = globalThis.codewheelDecode;
    const found = wheel.decodeFrame(wheel.findCode("AS5048A"), "encoder", "0x7FFD", {}, {});
    console.log(wheel.createEchoNote(found)[0].text);
    """
    file = tmp_path / "page.js"
    file.write_text(DOCUMENT + script + ask, encoding="utf-8")
    completed = subprocess.run([program("node"), str(file)], capture_output=True, text=True, check=False)
    assert completed.stdout.startswith("This word is also your own request read_request"), completed.stderr[-2000:]
    assert script.index("...createEchoNote(decoded)") < script.index("createHeadline(decoded),")
