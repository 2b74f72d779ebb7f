"""Fields that an order code has or has not, in five engines, against a decoder that is written here.

Every combination of options gets random frames, most of them with a right parity and CRC.
"""

from __future__ import annotations

import random
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path
from runpy import run_path
from typing import Any

import pytest
from c_harness import GCC, compile_programs, runner_over, write
from codewheel.commands.cli import main
from codewheel.commands.outputs import targets_named
from codewheel.dump.plain import device_dump
from codewheel.dump.xml import to_xml
from codewheel.model import Device
from codewheel.reference import codec
from codewheel.targets import Library
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
    by_code,
    joined,
    load_made,
    named,
    ones,
    remainder,
    split,
)

pytestmark = pytest.mark.slow

SCRIPT = SPECS.parents[1] / "docs" / "example" / "decode_from_xml.py"
#: An order code has 12 or 17 bits, and optional error, warning, parity, life counter and zero bits.
OPTIONS = ["".join(letters) for letters in product(("12", "17"), "EX", "WX", "PQX", "LX", "ZX")]
COUNTS = mostly_exhaustive([40, 4000], 40)


@dataclass(frozen=True)
class Options:
    """Widths that the letters of an order code select."""

    position: int
    error: int
    warning: int
    even: int
    odd: int
    life: int
    zeros: int

    @classmethod
    def of(cls, letters: str) -> Options:
        parity = letters[4]
        return cls(
            position=int(letters[:2]),
            error=int(letters[2] == "E"),
            warning=int(letters[3] == "W"),
            even=int(parity == "P"),
            odd=int(parity == "Q"),
            life=3 if letters[5] == "L" else 0,
            zeros=2 if letters[6] == "Z" else 0,
        )


def verdict_of(options: Options, is_wrong: bool, is_worn: bool, has_strange_bits: bool = False) -> str:
    """Return the verdict. Without an error and a warning bit, nothing of a frame judges the position."""
    if is_wrong:
        return NOT_USABLE
    if not options.error and not options.warning:
        return UNKNOWN
    return WARNING if is_worn or has_strange_bits else USABLE


def word(letters: str, random_: random.Random) -> Case:
    options = Options.of(letters)
    widths = [
        ("position", options.position),
        ("zeros", options.zeros),
        ("failed", options.error),
        ("worn", options.warning),
        ("life", options.life),
        ("spare", 1),
        ("even", options.even),
        ("odd", options.odd),
    ]
    bits = sum(width for _, width in widths)
    parts = split(random_.getrandbits(bits), widths)
    data = [parts[name] for name in ("position", "failed", "worn", "life", "spare")]
    if random_.random() < 0.8:
        parts["zeros"] = 0
        parts["even"] = ones(*data) % 2 & options.even
        parts["odd"] = (ones(*data) + 1) % 2 & options.odd
    has_right_parity = not options.even or ones(*data, parts["even"]) % 2 == 0
    has_right_parity &= not options.odd or ones(*data, parts["odd"]) % 2 == 1
    common = (f"OPS{letters}", "word", bits, joined(parts, widths))
    if parts["zeros"] or not has_right_parity:
        return Case(*common, "constant")
    is_wrong, is_worn = parts["failed"] == 1, options.warning == 1 and parts["worn"] == 0
    is_strange = parts["spare"] == 0
    values = {"position": parts["position"], "failed": is_wrong, "worn": is_worn, "life": parts["life"]}
    verdict = verdict_of(options, is_wrong, is_worn, is_strange)
    reports = named(failed=is_wrong, worn=is_worn, spare=is_strange)
    return Case(*common, "", verdict, reports, {**values, "unused": int(is_strange)})


def cycle(letters: str, random_: random.Random) -> Case:
    """Return a BiSS frame. Position and moving bit, which codes with odd parity have, are one number in Gray code."""
    options = Options.of(letters)
    widths = [
        ("life", options.life),
        ("whole", options.position + options.odd),
        ("even", options.even),
        ("error", options.error),
        ("warning", options.warning),
        ("crc", 6),
    ]
    bits = sum(width for _, width in widths)
    parts = split(random_.getrandbits(bits), widths)
    if random_.random() < 0.8:
        parts["even"] = ones(parts["life"]) % 2 & options.even
    right_crc = remainder(joined(parts, widths) >> 6, bits - 6, 0x03, 6) ^ 0x3F
    if random_.random() < 0.9:
        parts["crc"] = right_crc
    common = (f"OPB{letters}", "cycle", bits, joined(parts, widths))
    if parts["crc"] != right_crc:
        return Case(*common, "crc")
    if options.even and ones(parts["life"], parts["even"]) % 2:
        return Case(*common, "constant")
    whole, gray = 0, parts["whole"]
    while gray:
        whole, gray = whole ^ gray, gray >> 1
    is_wrong = options.error == 1 and parts["error"] == 0
    is_worn = options.warning == 1 and parts["warning"] == 0
    values = {
        "life": parts["life"],
        "position": whole >> options.odd,
        "moving": bool(whole & options.odd),
        "error": is_wrong,
        "warning": is_worn,
        "whole": whole,
    }
    verdict = verdict_of(options, is_wrong, is_worn)
    return Case(*common, "", verdict, named(error=is_wrong, warning=is_worn), values)


def reply(letters: str, random_: random.Random) -> Case:
    """Return a reply of three bytes, lowest first, and a CRC. Bits that the order code does not use are reserved."""
    options = Options.of(letters)
    spare = 24 - options.position - options.error - options.warning - options.even
    widths = [
        ("rest", spare),
        ("even", options.even),
        ("aged", options.warning),
        ("position", options.position),
        ("broken", options.error),
    ]
    parts = split(random_.getrandbits(24), widths)
    if random_.random() < 0.5:
        parts["rest"] = 0
    data = [parts[name] for name in ("broken", "position", "aged")]
    if random_.random() < 0.8:
        parts["even"] = ones(*data) % 2 & options.even
    sent = joined(parts, widths).to_bytes(3, "little")
    right_crc = remainder(int.from_bytes(sent, "big"), 24, 0x07, 8)
    crc = right_crc if random_.random() < 0.9 else random_.getrandbits(8)
    common = (f"OPR{letters}", "reply", 32, int.from_bytes(bytes([*sent, crc]), "little"))
    if crc != right_crc:
        return Case(*common, "crc")
    if options.even and ones(*data, parts["even"]) % 2:
        return Case(*common, "constant")
    is_wrong, is_worn = options.error == 1 and parts["broken"] == 0, parts["aged"] == 1
    is_strange = parts["rest"] != 0
    values = {"broken": is_wrong, "position": parts["position"], "aged": is_worn, "unused": parts["rest"]}
    verdict = verdict_of(options, is_wrong, is_worn, is_strange)
    return Case(*common, "", verdict, named(broken=is_wrong, aged=is_worn, rest=is_strange), values)


FRAMES = {"word": word, "cycle": cycle, "reply": reply}


@cache
def cases_of(layout: str, count: int) -> tuple[Case, ...]:
    random_ = random.Random(f"{layout} {count}")
    return tuple(FRAMES[layout](letters, random_) for letters in OPTIONS for _ in range(count))


@cache
def device() -> Device:
    return load_made("options")


@cache
def made() -> MadeEncoder:
    members = {
        "word": ("position", "failed", "worn", "life", "unused"),
        "cycle": ("life", "position", "moving", "error", "warning", "whole"),
        "reply": ("broken", "position", "aged", "unused"),
    }
    return MadeEncoder(device(), members, {"word": ("spare", 1), "reply": ("rest", 0)})


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
    assert {case.verdict for case in cases} == {"", NOT_USABLE, UNKNOWN, WARNING, USABLE}


def test_there_are_frames_of_all_kinds() -> None:
    assert len(OPTIONS) == 96
    for layout, faults in {
        "word": {"", "constant"},
        "cycle": {"", "crc", "constant"},
        "reply": {"", "crc", "constant"},
    }.items():
        cases = cases_of(layout, 40)
        assert {case.fault for case in cases} == faults
        assert len({case.code for case in cases if not case.fault}) == 96
        unknown = {case.code[5:7] for case in cases if case.verdict == UNKNOWN}
        assert unknown == {"XX"}


#: Values of a frame without its absent flags, and flags that the order codes of a layout may lack.
ABSENT = {
    "word": ({"position": 5, "life": 0}, ("failed", "worn")),
    "cycle": ({"position": 5, "life": 0}, ("error", "warning", "moving")),
    "reply": ({"position": 5}, ("broken", "aged")),
}
CODES = {"word": "OPS12XXXXX", "cycle": "OPB12XXXXX", "reply": "OPR12XXXXX"}


@pytest.mark.parametrize("layout", FRAMES)
def test_an_active_flag_that_the_order_code_lacks_is_refused(
    layout: str, import_generated: Import, tmp_path: Path
) -> None:
    np: Any = pytest.importorskip("numpy")
    (numbers, flags), code = ABSENT[layout], CODES[layout]
    _, placed_layout = made().placed(code, layout)
    package = import_generated(Library((device(),)), device().manufacturer.python_package)[1]
    encoder: Any = package.lookup(code)
    inactive: dict[str, Any] = {**numbers, **dict.fromkeys(flags, False)}
    number = codec.encode(device(), placed_layout, inactive)
    kind: Any = type(encoder.decode(number.to_bytes(4, "little") if layout == "reply" else number))
    assert kind(encoder, **inactive).encode() == kind(encoder, **inactive).encode()
    compile_programs([*GCC, "-Wall", "-Wextra", "-Werror"], device(), tmp_path, write(tmp_path, (device(),)))
    run = runner_over(device(), tmp_path)
    rows = {"word": "5 {} {} 0 0", "cycle": "0 5 {2} {0} {1} 5", "reply": "{} 5 {} 0"}
    assert run([f"{code} encode {layout} {rows[layout].format(0, 0, 0)}"])[0].startswith("0 ")
    for index, flag in enumerate(flags):
        active = {**inactive, flag: True}
        with pytest.raises(codec.EncodeError, match=flag):
            codec.encode(device(), placed_layout, active)
        with pytest.raises(ValueError, match=f"{flag} must be False, since this encoder has no such flag, got True"):
            kind(encoder, **active).encode()
        columns = {name: np.array([value, value]) for name, value in active.items()}
        with pytest.raises(ValueError, match=f"{flag} must be False"):
            kind.encode_many(columns, encoder)
        bits = [int(index == place) for place in range(3)]
        assert run([f"{code} encode {layout} {rows[layout].format(*bits)}"])[0].startswith("4 "), flag
    # The whole number has one bit for the moving bit only with order codes that have it.
    if layout == "cycle":
        with pytest.raises(ValueError, match="moving"):
            _ = kind(encoder, **{**inactive, "moving": True}).whole


@pytest.mark.parametrize("layout", FRAMES)
def test_the_example_script_for_the_xml_decides_as_the_decoder_here_does(
    layout: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    xml = tmp_path / "device.xml"
    xml.write_text(to_xml(device_dump(device())), encoding="utf-8")
    for _, group in list(by_code(cases_of(layout, 40)))[::7]:
        case = next(case for case in group if not case.fault)
        text = case.number.to_bytes(4, "little").hex() if layout == "reply" else hex(case.number)
        monkeypatch.setattr("sys.argv", [str(SCRIPT), str(xml), case.code, layout, text])
        run_path(str(SCRIPT))
        assert capsys.readouterr().out.splitlines()[-1] == f"verdict: {case.verdict}", (case.code, text)


@pytest.mark.parametrize(
    ("code", "line"),
    [
        ("OPS12XXXXX", "Position: no bit of this frame confirms that the position is usable."),
        ("OPS12XWXXX", "Position: ▲ usable with a warning if `worn` or `spare` is 0; otherwise ✓ usable."),
        (
            "OPS12EXXXX",
            "✕ **not usable** if `failed` is 1; ▲ usable with a warning if `spare` is 0; otherwise ✓ usable.",
        ),
        ("OPB12XXPXX", "Position: no bit of this frame confirms that the position is usable."),
        ("OPB17EXXXX", "✕ **not usable** if `error` is 0; otherwise, if the CRC is correct, ✓ usable."),
    ],
)
def test_the_page_of_an_order_code_has_the_verdicts_of_its_bits(code: str, line: str) -> None:
    assert line in _pages()[f"docs/options/{code}.md"]


@pytest.mark.parametrize(
    ("code", "rows"),
    [
        ("OPS12XWXXX", ["worn | 0 | ▲ usable with a warning", "spare | 0 | ▲ usable with a warning"]),
        ("OPS12EXXXX", ["failed | 1 | ✕ **not usable**", "spare | 0 | ▲ usable with a warning"]),
        ("OPB17EXXXX", ["error | 0 | ✕ **not usable**"]),
    ],
)
def test_the_table_of_an_order_code_has_its_bits_alone(code: str, rows: list[str]) -> None:
    page = _pages()[f"docs/options/{code}.md"]
    fold = page[page.index("<b>Errors and warnings</b>") :]
    table = fold[: fold.index("</details>")]
    assert [line for line in _short_lines(table) if "| 0 |" in line or "| 1 |" in line] == rows


def _short_lines(section: str) -> list[str]:
    """Return lines with the identifier of a flag in place of its names, without its bit."""
    lines = []
    for line in section.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        names = [re.sub(r".*<small>.*`(\w+)`</small>.*", r"\1", cell) for cell in cells if cell]
        lines.append(" | ".join(name for name in names if name != "Bit" and not re.fullmatch(r"bit \d+", name)))
    return lines


def test_the_page_of_verdicts_says_which_order_codes_have_none() -> None:
    page = _pages()["docs/options-verdicts.md"]
    assert "| order codes that lack `failed` and `worn` |  | ? unknown |" in page
    assert page.count("| order codes that lack") == 3


@cache
def _pages() -> Mapping[str, str]:
    (target,) = (target for target in targets_named() if target.name == "docs")
    return {path: text for path, text in target.files(Library((device(),)), {}).items() if path.endswith(".md")}


@pytest.mark.parametrize("code", ["OPS12XXXXX", "OPS17EXPLZ", "OPS12XWQXX"])
def test_a_virtual_encoder_sends_and_accepts_only_the_flags_that_it_has(code: str) -> None:
    options = Options.of(code[3:])
    encoder = VirtualEncoder(code, specs=[SPECS / "options.yaml", SPECS / "manufacturer.yaml"])
    for flag, width in (("failed", options.error), ("worn", options.warning)):
        if not width:
            with pytest.raises(ValueError, match=flag):
                encoder.set_flag(flag)
            continue
        encoder.set_flag(flag)
        _, layout = made().placed(code, "word")
        decoded = codec.decode(device(), layout, encoder.frame(layout.layout, {}))
        assert not decoded.problems
        assert decoded.values[flag] is True


@pytest.mark.parametrize(
    ("code", "text"), [("OPS12EXPXX", "has no CRC, only parity;"), ("OPS12EXXXX", "has no CRC; the position")]
)
def test_decode_mentions_parity_only_for_order_codes_that_have_it(
    code: str, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    case = next(case for case in cases_of("word", 40) if case.code == code and case.verdict == USABLE)
    specs = ["--specs", str(SPECS / "options.yaml"), "--specs", str(SPECS / "manufacturer.yaml")]
    main(["decode", code, f"0b{case.number:0{case.bits}b}", *specs])
    assert text in " ".join(capsys.readouterr().out.split())
