"""CRCs that an order code has or has not, in five engines, against a decoder that is written here.

The encoder is made up. Every combination of options gets random frames, most of them with a right CRC.
"""

from __future__ import annotations

import random
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.commands.outputs import targets_named
from codewheel.reference import codec
from codewheel.targets import Library
from codewheel.targets.biss.data_channels import master_settings
from codewheel.targets.biss.identity import data_lengths, only_crc, single_cycle_data
from codewheel.virtual.encoder import VirtualEncoder
from exhaustive import mostly_exhaustive
from five_engines import (
    ENGINES,
    NOT_USABLE,
    SPECS,
    UNKNOWN,
    USABLE,
    WARNING,
    Case,
    Import,
    MadeEncoder,
    joined,
    load_made,
    named,
    remainder,
    split,
)

pytestmark = pytest.mark.slow

#: An order code has 12 or 15 bits, an error bit or none, and one of four CRCs or none.
OPTIONS = ["".join(letters) for letters in product(("12", "15"), "EX", "NVABL")]
COUNTS = mostly_exhaustive([40, 4000], 40)


@dataclass(frozen=True)
class Check:
    """A CRC.

    ``is_turned`` reverses its bits, and ``has_turned_bytes`` also reverses the bits of each byte that it covers.
    """

    width: int
    poly: int
    start: int = 0
    inverted: int = 0
    is_turned: bool = False
    has_turned_bytes: bool = False

    def of_bits(self, data: int, count: int) -> int:
        """Return the CRC over ``count`` bits."""
        rest = remainder(data, count, self.poly, self.width, self.start)
        return (turned(rest, self.width) if self.is_turned else rest) ^ self.inverted

    def of_bytes(self, data: bytes) -> int:
        """Return the CRC over bytes."""
        sent = bytes(turned(byte, 8) for byte in data) if self.has_turned_bytes else data
        return self.of_bits(int.from_bytes(sent, "big"), 8 * len(sent))


def turned(number: int, bits: int) -> int:
    return int(f"{number:0{bits}b}"[::-1], 2)


#: CRCs by the last letter of the order code. Over RS-485, V has no CRC.
IN_WORDS = {
    "V": Check(6, 0x03),
    "A": Check(8, 0x1D, start=0xFF),
    "B": Check(8, 0x1D, inverted=0xFF),
    "L": Check(16, 0x1021, start=0xFFFF, is_turned=True),
}
IN_CYCLES = {
    "V": Check(6, 0x03, inverted=0x3F),
    "A": Check(8, 0x2F, inverted=0xFF),
    "B": Check(8, 0x2F, start=0x5A, inverted=0xFF),
    "L": Check(16, 0x90D9, inverted=0xFFFF),
}
IN_REPLIES = {
    "A": Check(8, 0x01),
    "B": Check(8, 0x07, start=0xFF, is_turned=True, has_turned_bytes=True),
    "L": Check(16, 0x1021, is_turned=True, has_turned_bytes=True),
}


def disturbed(check: Check | None, right_crc: int, random_: random.Random) -> int:
    """Return the CRC of a frame, which is mostly right."""
    return random_.getrandbits(check.width) if check is not None and random_.random() < 0.2 else right_crc


def verdict_of(has_error_bit: bool, is_wrong: bool, is_strange: bool = False) -> str:
    """Return the verdict. A right CRC alone does not judge the position."""
    if is_wrong:
        return NOT_USABLE
    if not has_error_bit:
        return UNKNOWN
    return WARNING if is_strange else USABLE


def word(letters: str, random_: random.Random) -> Case:
    position, error, check = int(letters[:2]), letters[2] == "E", IN_WORDS.get(letters[3])
    width = check.width if check is not None else 0
    parts = [("position", position), ("failed", int(error))]
    bits = position + error
    data = random_.getrandbits(bits)
    right_crc = check.of_bits(data, bits) if check is not None else 0
    crc = disturbed(check, right_crc, random_)
    common = (f"CRS{letters}", "word", bits + width, data << width | crc)
    if crc != right_crc:
        return Case(*common, "crc")
    values = split(data, parts)
    is_wrong = values["failed"] == 1
    sent_values = {"position": values["position"], "failed": is_wrong}
    return Case(*common, "", verdict_of(error, is_wrong), named(failed=is_wrong), sent_values)


def cycle(letters: str, random_: random.Random) -> Case:
    """Return a BiSS frame, whose position is in Gray code."""
    position, error, check = int(letters[:2]), letters[2] == "E", IN_CYCLES.get(letters[3])
    width = check.width if check is not None else 0
    bits = position + error
    data = random_.getrandbits(bits)
    right_crc = check.of_bits(data, bits) if check is not None else 0
    crc = disturbed(check, right_crc, random_)
    common = (f"CRB{letters}", "cycle", bits + width, data << width | crc)
    if crc != right_crc:
        return Case(*common, "crc")
    gray, number = data >> error, 0
    while gray:
        number, gray = number ^ gray, gray >> 1
    is_wrong = error and data & 1 == 0
    values = {"position": number, "error": is_wrong}
    return Case(*common, "", verdict_of(error, is_wrong), named(error=is_wrong), values)


def answer(letters: str, random_: random.Random) -> Case:
    """Return an SPI word of 40 bits. Bits that the order code does not use are reserved."""
    position, error, check = int(letters[:2]), letters[2] == "E", IN_WORDS.get(letters[3])
    width = check.width if check is not None else 0
    bits = 40 - width
    widths = [("failed", int(error)), ("rest", bits - position - error), ("position", position)]
    values = split(random_.getrandbits(bits), widths)
    values["rest"] *= random_.random() < 0.5
    data = joined(values, widths)
    right_crc = check.of_bits(data, bits) if check is not None else 0
    crc = disturbed(check, right_crc, random_)
    common = (f"CRP{letters}", "answer", 40, data << width | crc)
    if crc != right_crc:
        return Case(*common, "crc")
    is_wrong, is_strange = values["failed"] == 1, values["rest"] != 0
    reports = named(failed=is_wrong, rest=is_strange)
    sent_values = {"failed": is_wrong, "position": values["position"], "unused": values["rest"]}
    return Case(*common, "", verdict_of(error, is_wrong, is_strange), reports, sent_values)


def reply(letters: str, random_: random.Random) -> Case:
    """Return a reply of four bytes, lowest first, with the CRC in the last of them."""
    position, error, check = int(letters[:2]), letters[2] == "E", IN_REPLIES.get(letters[3])
    size = check.width // 8 if check is not None else 0
    bits = 32 - 8 * size
    widths = [("rest", bits - position - error), ("position", position), ("broken", int(error))]
    values = split(random_.getrandbits(bits), widths)
    values["rest"] *= random_.random() < 0.5
    data = joined(values, widths).to_bytes(4 - size, "little")
    right_crc = check.of_bytes(data) if check is not None else 0
    crc = disturbed(check, right_crc, random_)
    number = int.from_bytes(data + crc.to_bytes(size, "little"), "little")
    common = (f"CRR{letters}", "reply", 32, number)
    if crc != right_crc:
        return Case(*common, "crc")
    is_wrong, is_strange = error and values["broken"] == 0, values["rest"] != 0
    reports = named(broken=is_wrong, rest=is_strange)
    sent_values = {"broken": is_wrong, "position": values["position"], "unused": values["rest"]}
    return Case(*common, "", verdict_of(error, is_wrong, is_strange), reports, sent_values)


FRAMES = {"word": word, "cycle": cycle, "answer": answer, "reply": reply}


@cache
def cases_of(layout: str, count: int) -> tuple[Case, ...]:
    random_ = random.Random(f"{layout} {count}")
    return tuple(FRAMES[layout](letters, random_) for letters in OPTIONS for _ in range(count))


@cache
def made() -> MadeEncoder:
    members = {
        "word": ("position", "failed"),
        "cycle": ("position", "error"),
        "answer": ("failed", "position", "unused"),
        "reply": ("broken", "position", "unused"),
    }
    return MadeEncoder(load_made("crc_options"), members, {"answer": ("rest", 0), "reply": ("rest", 0)})


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("layout", FRAMES)
@pytest.mark.parametrize("count", COUNTS)
def test_every_engine_decides_as_the_decoder_here_does(
    count: int, layout: str, engine: str, import_generated: Import, tmp_path: Path
) -> None:
    cases = cases_of(layout, count)
    results = ENGINES[engine](made(), cases, import_generated, tmp_path)
    differing = [(case, result) for case, result in zip(cases, results, strict=True) if case != result]
    assert differing[:3] == []
    assert {case.fault for case in cases} == {"", "crc"}
    # The last letter of an order code selects the CRC. With N, and over RS-485 with V, there is no CRC.
    letters_without_crc = "NV" if layout == "reply" else "N"
    codes_with_crc = {case.code for case in cases if case.code[-1] not in letters_without_crc}
    assert {case.code for case in cases if case.fault} == codes_with_crc
    assert {case.verdict for case in cases} >= {NOT_USABLE, UNKNOWN, USABLE}


def _frame(letters: str, layout: str) -> Case:
    """Return a valid frame with these options."""
    is_valid = (case for case in cases_of(layout, 40) if case.code.endswith(letters) and not case.fault)
    return next(is_valid)


def _output(*arguments: str, capsys: pytest.CaptureFixture[str]) -> str:
    main([*arguments, "--specs", str(SPECS / "crc_options.yaml"), "--specs", str(SPECS / "manufacturer.yaml")])
    return " ".join(capsys.readouterr().out.split())


def test_a_frame_of_another_crc_is_that_of_another_order_code(capsys: pytest.CaptureFixture[str]) -> None:
    """The frame has the same length, so only its CRC distinguishes the order codes."""
    case = _frame("12EA", "word")
    shown = _output("decode", "CRS12EB", f"0b{case.number:0{case.bits}b}", capsys=capsys)
    assert "crc error" in shown
    assert f"{case.bits} bits, the frame of CRS12EA" in shown


def test_decode_says_that_an_order_code_has_no_crc(capsys: pytest.CaptureFixture[str]) -> None:
    case = _frame("12EN", "word")
    assert "this frame has no CRC" in _output("decode", case.code, f"0b{case.number:0{case.bits}b}", capsys=capsys)
    case = _frame("12EB", "word")
    assert "this frame has no CRC" not in _output("decode", case.code, f"0b{case.number:0{case.bits}b}", capsys=capsys)


@pytest.mark.parametrize(
    ("code", "line", "sections"),
    [
        ("CRS12EN", "- CRC: none.", set()),
        ("CRS12EB", "- CRC: poly `0x11D` (x⁸ + x⁴ + x³ + x² + 1), init 0, inverted, 8 bits,", {"word_8_inverted"}),
        ("CRB15XA", "- CRC: poly `0x12F` (x⁸ + x⁵ + x³ + x² + x + 1), init 0, inverted, 8 bits,", {"biss_8"}),
        ("CRP12XV", "- CRC: poly `0x43` (x⁶ + x + 1), init 0, not inverted, 6 bits,", {"word_6"}),
    ],
)
def test_the_page_of_an_order_code_has_its_crc_alone(code: str, line: str, sections: set[str]) -> None:
    page = _pages()[f"docs/crc_options/{code}.md"]
    assert line in page
    assert set(re.findall(r'<a id="crc-(\w+)">', page)) == sections


@cache
def _pages() -> Mapping[str, str]:
    (target,) = (target for target in targets_named() if target.name == "docs")
    return {path: text for path, text in target.files(Library((made().device,)), {}).items() if path.endswith(".md")}


def test_a_biss_master_gets_the_crc_of_each_order_code() -> None:
    """Only an order code of its own has a polynomial in the XML. The comment for a family lists all of them."""
    device = made().device
    layout = single_cycle_data(device)
    assert layout is not None
    lengths = data_lengths(device, layout)
    assert only_crc(device, layout, lengths) is None
    lines = master_settings(device, layout, crc=None, lengths=lengths, ids=(), one_encoder=False).splitlines()
    by_code = {line.split(":")[0].strip(): line for line in lines if line.startswith("  CRB")}
    assert by_code["CRB12EN"].endswith("12 bits, with status bits 13, with CRC 13, without a CRC")
    expected = "with CRC 21, CRC of 8 bits, x^8 + x^5 + x^3 + x^2 + x + 1, start value 0x5A, sent inverted"
    assert by_code["CRB12EB"].endswith(expected)
    of_one_code = [length for length in lengths if length.codes == ("CRB15XL",)]
    assert only_crc(device, layout, of_one_code) == device.crc("biss_16")


def test_c_says_which_words_no_crc_protects() -> None:
    (target,) = (target for target in targets_named() if target.name == "c")
    files = target.files(Library((made().device,)), {})
    header = " ".join(files["c/include/test/crc_options_ssi.h"].replace("\n *", "").split())
    assert "must agree, since some order codes have no CRC." in header
    assert "no CRC protects" not in header
    words = "These SSI words have no CRC: CRC_OPTIONS SSI: word (some order codes)."
    assert words.replace("_", r"\_") in files["c/ASSUMPTIONS-test.md"] or words in files["c/ASSUMPTIONS-test.md"]


@pytest.mark.parametrize("code", ["CRS12EN", "CRS12EL"])
def test_a_virtual_encoder_sends_its_crc(code: str) -> None:
    encoder = VirtualEncoder(code, specs=[SPECS / "crc_options.yaml", SPECS / "manufacturer.yaml"])
    encoder.set_flag("failed")
    _, layout = made().placed(code, "word")
    decoded = codec.decode(made().device, layout, encoder.frame(layout.layout, {}))
    assert not decoded.problems
    assert (decoded.crc is None) == code.endswith("N")
    assert decoded.values["failed"] is True
