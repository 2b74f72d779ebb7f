"""Verdicts that hang on values and on combinations, in five engines, against tables that are written here.

The engines are the reference codec, the generated Python package, its columns, the generated C, and the script of the
page. The expected results follow from the bits of each frame by arithmetic, and for the MT6701 from its sources.
"""

from __future__ import annotations

import json
import random
import shutil
import subprocess
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from runpy import run_path
from types import ModuleType
from typing import Any

import pytest
from c_harness import GCC, compile_programs, runner_over, write
from codewheel.dump.plain import device_dump
from codewheel.dump.xml import to_xml
from codewheel.loading.library import load_library
from codewheel.model import Device, Verdict, number_from_bytes
from codewheel.plan.verdicts import reports_of
from codewheel.reference import codec
from codewheel.reference.findings import findings
from codewheel.targets import Library
from codewheel.targets.browser.files import generate as generate_page
from test_c_reports import by_interface

pytestmark = pytest.mark.slow

TESTS = Path(__file__).resolve().parents[1]
MT6701 = TESTS.parent / "specs" / "magntek" / "mt6701.yaml"
SCRIPT = TESTS.parent / "docs" / "example" / "decode_from_xml.py"
SIGNS = TESTS / "specs" / "signs.yaml"
VERDICTS = [verdict.value for verdict in Verdict]
NOT_USABLE, WARNING, USABLE = "not_usable", "usable_with_warning", "usable"
#: A frame: a number, or bytes. A result: the verdict, and the names of the reports.
Frame = int | bytes
Result = tuple[str, frozenset[str]]
Import = Callable[[Library, str], tuple[Path, ModuleType]]


def crc_6(data: int, count: int, inverted: bool) -> int:
    """Return the CRC with the polynomial x^6 + x + 1 over ``count`` bits, bit by bit."""
    remainder = 0
    for place in reversed(range(count)):
        top = (remainder >> 5 ^ data >> place) & 1
        remainder = (remainder << 1 & 0x3F) ^ (0x03 if top else 0)
    return remainder ^ (0x3F if inverted else 0)


def crc_16(data: bytes) -> bytes:
    """Return the CRC of Modbus, low byte first."""
    remainder = 0xFFFF
    for byte in data:
        remainder ^= byte
        for _ in range(8):
            remainder = remainder >> 1 ^ (0xA001 if remainder & 1 else 0)
    return remainder.to_bytes(2, "little")


def mt6701_words() -> Iterator[tuple[Frame, Result]]:
    """Yield all 16 values of the status with 256 positions, 4,096 words in all.

    The status is track, button and two bits of the field. 1 and 2 are a field that is too strong or too weak "to
    measure the angle" (espp, MagneticFieldStrength), and the status of the field is a "validity flag" (MT6701.h). No
    source explains 3.
    """
    field_reports = {0: [], 1: ["field_too_strong"], 2: ["field_too_weak"], 3: ["field_not_stated"]}
    for position in range(5, 16384, 64):
        for status in range(16):
            data = position << 4 | status
            has_lost_track, field = bool(status & 8), status & 3
            verdict = WARNING if field == 3 else USABLE
            verdict = NOT_USABLE if has_lost_track or field in (1, 2) else verdict
            reports = [*field_reports[field], *(["track_lost"] if has_lost_track else [])]
            yield data << 6 | crc_6(data, 18, inverted=False), (verdict, frozenset(reports))


def as5145_words() -> Iterator[tuple[Frame, Result]]:
    """Yield all statuses of a word like that of the AS5145, with 128 positions.

    The position is valid if OCF is 1 and COF and LIN are 0. MagINC and MagDEC are both 1 if the field is out of range.
    """
    for position in range(0, 4096, 32):
        for status in range(32):
            ocf, cof, lin, increasing, decreasing = (bool(status >> place & 1) for place in (4, 3, 2, 1, 0))
            flags = {"not_ready": not ocf, "overflow": cof, "linearity": lin}
            flags["field_out_of_range"] = increasing and decreasing
            verdict = WARNING if increasing and decreasing else USABLE
            verdict = verdict if ocf and not cof and not lin else NOT_USABLE
            data = position << 5 | status
            reports = frozenset(name for name, is_active in flags.items() if is_active)
            yield data << 1 | data.bit_count() & 1, (verdict, reports)


def gray_words() -> Iterator[tuple[Frame, Result]]:
    """Yield 4,096 words whose position, quality and moving bit are one number in Gray code. ``cold`` is active low."""
    numbers = random.Random("gray")
    for _ in range(4096):
        whole, is_cold = numbers.randrange(1 << 15), bool(numbers.randrange(2))
        quality, is_moving = whole >> 1 & 3, bool(whole & 1)
        conditions = {
            "quality_none": quality == 3,
            "fair_while_moving": quality == 1 and is_moving and not is_cold,
            "quality_poor": quality == 2,
            "cold_standstill": not is_moving and is_cold,
        }
        reports = frozenset(name for name, is_active in conditions.items() if is_active)
        verdict = WARNING if reports else USABLE
        verdict = NOT_USABLE if reports & {"quality_none", "fair_while_moving"} else verdict
        data = (whole ^ whole >> 1) << 1 | (not is_cold)
        yield data << 6 | crc_6(data, 16, inverted=True), (verdict, reports)


def replies(reply_id: int) -> Iterator[tuple[Frame, Result]]:
    """Yield all 256 statuses with all modes, in the reply with the low byte first (1) or with the high byte first (2).

    The status has the light in bits 1:0, hot in 2, the supply in 3 (active low), the spare bits (always 1) in 5:4, worn
    in 6 and the sum of the alarms in 7, which decides only if worn is inactive.
    """
    for status in range(256):
        for mode in (0, 9, 15):
            light, is_hot, has_no_supply = status & 3, bool(status & 4), not status & 8
            is_worn, is_summed = bool(status & 64), bool(status & 128)
            conditions = {"light_weak": light == 1, "light_dark": light == 3, "worn": is_worn, "summed": is_summed}
            conditions["spare"] = status >> 4 & 3 != 1
            worst = {"light_dark"} | (set() if is_worn else {"summed"})
            if reply_id == 1:
                conditions["hot_in_test"] = is_hot and mode == 9
                conditions["weak_without_supply"] = light == 1 and has_no_supply and mode == 15
                conditions["reserved_and_hot"] = light == 2 and is_hot
                worst |= {"hot_in_test", "weak_without_supply"}
            else:
                conditions["mode_test"] = mode == 9
            reports = frozenset(name for name, is_active in conditions.items() if is_active)
            verdict = WARNING if reports - {"summed"} else USABLE
            verdict = NOT_USABLE if reports & worst else verdict
            low_first = bytes([reply_id, status, 0x34, mode << 4 | 0x2])
            high_first = bytes([reply_id, status, mode << 4 | 0x2, 0x34])
            data = low_first if reply_id == 1 else high_first
            crc = crc_16(data)
            yield data + (crc if reply_id == 1 else crc[::-1]), (verdict, reports)


FRAMES: dict[str, tuple[Path, str, str, list[tuple[Frame, Result]]]] = {
    "mt6701": (MT6701, "MT6701", "ssi_word", list(mt6701_words())),
    "as5145": (SIGNS, "SIG", "word", list(as5145_words())),
    "gray": (SIGNS, "SIC", "gray_word", list(gray_words())),
    "low": (SIGNS, "SIJ", "low_reply", list(replies(1))),
    "high": (SIGNS, "SIJ", "high_reply", list(replies(2))),
}


def device_of(path: Path) -> Device:
    devices, report = load_library([path, path.parent / "manufacturer.yaml"])
    assert not report
    (device,) = devices
    return device


def decode_by_reference(device: Device, code: str, layout: str, frames: Sequence[Frame], *_: object) -> list[Result]:
    variant = next(variant for variant in device.variants if variant.code == code)
    placed = device.layout(layout).place(variant.parameters)
    results = []
    for frame in frames:
        number = number_from_bytes(placed.layout, frame) if isinstance(frame, bytes) else frame
        frame_findings = findings(device, variant, codec.decode(device, placed, number))
        assert frame_findings.verdict is not None
        results.append((frame_findings.verdict.value, frozenset(report.field for report in frame_findings.reports)))
    return results


def decode_in_python(
    device: Device, code: str, layout: str, frames: Sequence[Frame], import_generated: Import, _: Path
) -> list[Result]:
    package = device.manufacturer.python_package
    encoder: Any = import_generated(Library((device,)), package)[1].lookup(code)
    decoded = map(encoder.decode, frames)
    results = []
    for frame in decoded:
        is_usable = frame.verdict.value != NOT_USABLE
        assert (frame.usable_position is not None) is is_usable
        results.append((frame.verdict.value, frozenset(report.name for report in frame.reports)))
    return results


def decode_in_columns(
    device: Device, code: str, layout: str, frames: Sequence[Frame], import_generated: Import, _: Path
) -> list[Result]:
    np: Any = pytest.importorskip("numpy")
    package = device.manufacturer.python_package
    encoder: Any = import_generated(Library((device,)), package)[1].lookup(code)
    if isinstance(frames[0], bytes):
        rows = np.array([list(frame) for frame in frames if isinstance(frame, bytes)], np.uint8)
        table = encoder.decode_many(rows, type(encoder.decode(frames[0])))
    else:
        table = encoder.decode_many(np.array(frames, np.uint64))
    assert table.ok.all()
    named = {name: column.tolist() for name, column in table.reports.items()}
    results = []
    for row, verdict in enumerate(table.verdict.tolist()):
        reports = frozenset(name for name, column in named.items() if column[row])
        results.append((VERDICTS[verdict], reports))
    return results


def decode_in_c(
    device: Device, code: str, layout: str, frames: Sequence[Frame], _: Import, folder: Path
) -> list[Result]:
    compile_programs([*GCC, "-Wall", "-Wextra", "-Werror"], device, folder, write(folder, (device,)))
    variant = next(variant for variant in device.variants if variant.code == code)
    view = next(view for view in by_interface(device) if view.interfaces[0].name == variant.interface)
    report_name_by_bit = {1 << report.number: report.name for report in reports_of(view)}
    frame_texts = [frame.hex().upper() if isinstance(frame, bytes) else f"{frame:X}" for frame in frames]
    program_answers = runner_over(device, folder)([f"{code} tells {layout} {text}" for text in frame_texts])
    results = []
    for answer in program_answers:
        fault, verdict, report_mask = answer.split()
        assert fault == "0"
        reports = frozenset(name for bit, name in report_name_by_bit.items() if int(report_mask, 16) & bit)
        results.append((VERDICTS[int(verdict)], reports))
    return results


#: Decodes frames with the script of the page. Bytes are lists of numbers, and words are hexadecimal texts.
_SCRIPT = """
const [code, layout, frames] = JSON.parse(require("fs").readFileSync("frames.json", "utf8"));
require("vm").runInThisContext(require("fs").readFileSync("decode.js", "utf8"));
const wheel = globalThis.codewheelDecode;
const [family] = wheel.table.families;
const at = family.interfaces.find((one) => one.frames.some((frame) => frame.name === layout));
const frame = at.frames.find((one) => one.name === layout);
const placed = wheel.placedFor({ code, family, interface: at, parameters: {} }, frame);
const word = (text) => wheel.decodeBits(placed, wheel.numberIn(text, placed.bits));
const decode = (one) => (Array.isArray(one) ? wheel.decodeBytes(placed, one) : word(one));
const names = (found) => found.reports.map((one) => one.report);
const results = frames.map(decode).map((found) => [found.problems.length, found.verdict, names(found)]);
console.log(JSON.stringify(results));
"""


def decode_in_browser(
    device: Device, code: str, layout: str, frames: Sequence[Frame], _: Import, folder: Path
) -> list[Result]:
    node = shutil.which("node") or shutil.which("nodejs")
    if node is None:
        pytest.skip("needs node")
    (folder / "decode.js").write_text(generate_page(Library((device,)))["browser/decode.js"], encoding="utf-8")
    frame_data = [list(frame) if isinstance(frame, bytes) else f"0x{frame:X}" for frame in frames]
    (folder / "frames.json").write_text(json.dumps([code, layout, frame_data]), encoding="utf-8")
    done = subprocess.run([node, "-e", _SCRIPT], cwd=folder, capture_output=True, text=True, check=True)
    decoded: Iterable[tuple[int, str, list[str]]] = json.loads(done.stdout)
    results = []
    for problems, verdict, reports in decoded:
        assert not problems
        results.append((verdict, frozenset(reports)))
    return results


ENGINES = {
    "reference": decode_by_reference,
    "python": decode_in_python,
    "columns": decode_in_columns,
    "c": decode_in_c,
    "browser": decode_in_browser,
}


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", FRAMES)
def test_every_engine_decides_as_the_table_does(
    name: str, engine: str, import_generated: Import, tmp_path: Path
) -> None:
    path, code, layout, pairs = FRAMES[name]
    frames = [frame for frame, _ in pairs]
    results = ENGINES[engine](device_of(path), code, layout, frames, import_generated, tmp_path)
    differing = []
    for (frame, wanted), result in zip(pairs, results, strict=True):
        if wanted != result:
            differing.append((frame, wanted, result))
    assert differing == []
    assert {verdict for _, (verdict, _) in pairs} == {NOT_USABLE, WARNING, USABLE}


@pytest.mark.parametrize("name", ["mt6701", "as5145", "low", "high"])
def test_the_xml_and_its_example_script_decide_as_the_table_does(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path, code, layout, pairs = FRAMES[name]
    xml = tmp_path / "device.xml"
    xml.write_text(to_xml(device_dump(device_of(path))), encoding="utf-8")
    for frame, (verdict, _) in pairs[::7]:
        text = frame.hex() if isinstance(frame, bytes) else hex(frame)
        monkeypatch.setattr("sys.argv", [str(SCRIPT), str(xml), code, layout, text])
        run_path(str(SCRIPT))
        assert capsys.readouterr().out.splitlines()[-1] == f"verdict: {verdict}", text


def test_the_tables_are_large_enough() -> None:
    assert {name: len(pairs) for name, (_, _, _, pairs) in FRAMES.items()} == {
        "mt6701": 4096,
        "as5145": 4096,
        "gray": 4096,
        "low": 768,
        "high": 768,
    }
