"""Five engines that decode frames of a made-up encoder, for comparison with a decoder that a test contains.

The engines are the reference codec, the generated Python package, its columns, the generated C, and the script of the
page.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from c_harness import GCC, Run, compile_programs, runner_over, write
from codewheel.loading.library import load_library
from codewheel.model import Device, PlacedLayout, Variant, Verdict
from codewheel.plan.verdicts import reports_of
from codewheel.reference import codec
from codewheel.reference.findings import findings
from codewheel.targets import Library
from codewheel.targets.browser.files import generate as generate_page
from codewheel_runtime.frames.base import ForEncoder
from test_c_reports import by_interface

SPECS = Path(__file__).resolve().parents[1] / "specs"
VERDICTS = [verdict.value for verdict in Verdict]
NOT_USABLE, UNKNOWN, WARNING, USABLE = VERDICTS
FAULTS = {"0": "", "1": "length", "2": "crc", "3": "constant", "4": "range"}
Import = Callable[[Library, str], tuple[Path, ModuleType]]
#: Values by name. A flag that the order code does not have is False, and a number 0.
Values = Mapping[str, int | bool]


@dataclass(frozen=True)
class Case:
    """A frame with the result that every engine must give. ``values`` is None for a frame with an error."""

    code: str
    layout: str
    bits: int
    number: int
    fault: str
    verdict: str = ""
    reports: frozenset[str] = frozenset()
    values: Values | None = None


@dataclass(frozen=True)
class MadeEncoder:
    """A made-up encoder, with the members of each layout's struct in C.

    ``reserved`` are the reserved fields, with the bits that the spec documents, by layout. Layouts called ``reply``
    have bytes, and their case has the number with the first byte lowest. All others are words.
    """

    device: Device
    members: Mapping[str, tuple[str, ...]]
    reserved: Mapping[str, tuple[str, int]] = field(default_factory=dict)

    def placed(self, code: str, layout: str) -> tuple[Variant, PlacedLayout]:
        variant = self.device.variant(code)
        return variant, self.device.layout(layout).place(variant.parameters)


def load_made(name: str) -> Device:
    """Return the family of a spec in ``tests/specs``."""
    devices, report = load_library([SPECS / f"{name}.yaml", SPECS / "manufacturer.yaml"])
    assert not report
    (device,) = devices
    return device


def split(number: int, widths: Sequence[tuple[str, int]]) -> dict[str, int]:
    """Return the bits of each field. The last field has the lowest bits. A field of 0 bits is 0."""
    value_by_field = {}
    remaining_bits = number
    for field_name, width in reversed(widths):
        value_by_field[field_name] = remaining_bits & (1 << width) - 1
        remaining_bits >>= width
    assert remaining_bits == 0
    return value_by_field


def joined(value_by_field: Mapping[str, int], widths: Sequence[tuple[str, int]]) -> int:
    """Return the number with the bits of these fields. The last field has the lowest bits."""
    number = 0
    for field_name, width in widths:
        number = number << width | value_by_field[field_name]
    return number


def ones(*numbers: int) -> int:
    return sum(number.bit_count() for number in numbers)


def remainder(data: int, count: int, poly: int, width: int, start: int = 0) -> int:
    """Return the CRC over ``count`` bits, bit by bit."""
    register = start
    register_mask = (1 << width) - 1
    for place in reversed(range(count)):
        data_bit = data >> place & 1
        highest_bit = register >> width - 1
        register = register << 1 & register_mask
        if highest_bit != data_bit:
            register ^= poly
    return register


def named(**conditions: bool) -> frozenset[str]:
    return frozenset(name for name, is_active in conditions.items() if is_active)


def by_code(cases: Sequence[Case]) -> Iterator[tuple[str, list[Case]]]:
    """Yield the cases of each order code, which are adjacent."""
    codes = dict.fromkeys(case.code for case in cases)
    grouped: dict[str, list[Case]] = {code: [] for code in codes}
    for case in cases:
        grouped[case.code].append(case)
    yield from grouped.items()


def frame_of(case: Case) -> int | bytes:
    return case.number.to_bytes(case.bits // 8, "little") if case.layout == "reply" else case.number


def with_result(
    case: Case, fault: str, verdict: str = "", reports: frozenset[str] = frozenset(), values: Values | None = None
) -> Case:
    return Case(case.code, case.layout, case.bits, case.number, fault, verdict, reports, values)


def decode_by_reference(encoder: MadeEncoder, cases: Sequence[Case], *_: object) -> Iterator[Case]:
    names = {case.layout: tuple(case.values) for case in cases if case.values is not None}
    for case in cases:
        variant, layout = encoder.placed(case.code, case.layout)
        frame = frame_of(case)
        if isinstance(frame, bytes):
            decoded = codec.decode_placed(encoder.device, layout, frame)
        else:
            decoded = codec.decode(encoder.device, layout, frame)
        if decoded.problems:
            yield with_result(case, decoded.problems[0].fault.value)
            continue
        judgement = findings(encoder.device, variant, decoded)
        assert judgement.verdict is not None
        values = {name: decoded.values.get(name, 0) for name in names[case.layout]}
        numbers = {name: value for name, value in values.items() if not isinstance(value, str)}
        reports = frozenset(report.field for report in judgement.reports)
        yield with_result(case, "", judgement.verdict.value, reports, numbers)


def decode_in_python(made: MadeEncoder, cases: Sequence[Case], import_generated: Import, _: Path) -> Iterator[Case]:
    package = import_generated(Library((made.device,)), made.device.manufacturer.python_package)[1]
    fault_of = {"CrcError": "crc", "ConstantError": "constant", "RangeError": "range", "LengthError": "length"}
    for code, group in by_code(cases):
        encoder: Any = package.lookup(code)
        for case in group:
            try:
                frame = encoder.decode(frame_of(case))
            except ValueError as error:
                yield with_result(case, fault_of[type(error).__name__])
                continue
            values = {name: getattr(frame, name) for name in case.values or ()}
            reports = frozenset(report.name for report in frame.reports)
            assert (frame.usable_position is None) is (frame.verdict.value == NOT_USABLE)
            assert frame.encode() == frame_of(case)
            yield with_result(case, "", frame.verdict.value, reports, values)


def decode_in_columns(made: MadeEncoder, cases: Sequence[Case], import_generated: Import, _: Path) -> Iterator[Case]:
    numpy: Any = pytest.importorskip("numpy")
    package = import_generated(Library((made.device,)), made.device.manufacturer.python_package)[1]
    field_names = next(tuple(case.values) for case in cases if case.values is not None)
    for order_code, cases_of_code in by_code(cases):
        encoder: Any = package.lookup(order_code)
        frames = _frame_array(cases_of_code, numpy)
        table = encoder.decode_many(frames)
        faults = [FAULTS[str(fault)] for fault in table.fault.tolist()]
        verdicts = [VERDICTS[verdict] for verdict in table.verdict.tolist()]
        value_columns = {name: table[name].tolist() for name in field_names}
        report_columns = {name: column.tolist() for name, column in table.reports.items()}
        for row, case in enumerate(cases_of_code):
            if faults[row]:
                yield with_result(case, faults[row])
                continue
            values = {name: column[row] for name, column in value_columns.items()}
            reports = frozenset(name for name, column in report_columns.items() if column[row])
            yield with_result(case, "", verdicts[row], reports, values)
        is_valid = [not fault for fault in faults]
        valid_case = next(case for case in cases_of_code if not case.fault)
        frame_class: Any = type(encoder.decode(frame_of(valid_case)))
        # A class whose frames are the same for all order codes takes no encoder.
        encoders = (encoder,) if issubclass(frame_class, ForEncoder) else ()
        encoded_frames = frame_class.encode_many(encoder.decode_many(frames[is_valid]), *encoders)
        assert (encoded_frames == frames[is_valid]).all()


def _frame_array(cases: Sequence[Case], numpy: Any) -> Any:
    """Return an array with a row of bytes for each reply, or with a number for each word."""
    if cases[0].layout == "reply":
        return numpy.array([list(frame_of(case)) for case in cases], numpy.uint8)  # type: ignore[arg-type]
    return numpy.array([case.number for case in cases], numpy.uint64)


def decode_in_c(made: MadeEncoder, cases: Sequence[Case], _: Import, folder: Path) -> Iterator[Case]:
    compile_programs([*GCC, "-Wall", "-Wextra", "-Werror"], made.device, folder, write(folder, (made.device,)))
    run = runner_over(made.device, folder)
    variant, _placed_layout = made.placed(cases[0].code, cases[0].layout)
    views = {view.interfaces[0].name: view for view in by_interface(made.device)}
    report_by_bit = {1 << report.number: report.name for report in reports_of(views[variant.interface])}
    field_names = made.members[cases[0].layout]
    frame_texts = [_hex_text(frame_of(case)) for case in cases]
    value_lines = _ask(run, "decode", cases, frame_texts)
    _check_encoding(run, cases, frame_texts, value_lines)
    verdict_lines = _ask(run, "tells", cases, frame_texts)
    for case, value_line, verdict_line in zip(cases, value_lines, verdict_lines, strict=True):
        # A line such as "0 17 5" has the number of the fault, 0 for none, and the value of each field.
        fault, *numbers = value_line.split()
        if fault != "0":
            yield with_result(case, FAULTS[fault])
            continue
        _status, verdict, report_mask = verdict_line.split()
        reports = frozenset(name for bit, name in report_by_bit.items() if int(report_mask, 16) & bit)
        values = dict(zip(field_names, map(int, numbers), strict=True))
        yield with_result(case, "", VERDICTS[int(verdict)], reports, values)


def _hex_text(frame: int | bytes) -> str:
    return frame.hex() if isinstance(frame, bytes) else f"{frame:X}"


def _ask(run: Run, command: str, cases: Sequence[Case], arguments: Sequence[str]) -> list[str]:
    """Return the answer of the compiled program to a command with one argument for each case."""
    case_arguments = zip(cases, arguments, strict=True)
    return run([f"{case.code} {command} {case.layout} {argument}" for case, argument in case_arguments])


def _check_encoding(run: Run, cases: Sequence[Case], frame_texts: Sequence[str], value_lines: Sequence[str]) -> None:
    """Check that C encodes the values of each valid frame to the same frame."""
    valid_rows = [row for row, value_line in enumerate(value_lines) if value_line[0] == "0"]
    valid_cases = [cases[row] for row in valid_rows]
    values = [value_lines[row].removeprefix("0 ") for row in valid_rows]
    expected_answers = [f"0 {frame_texts[row].upper()}" for row in valid_rows]
    assert _ask(run, "encode", valid_cases, values) == expected_answers


#: Decodes frames with the script of the page: words as hexadecimal texts.
_SCRIPT = """
const groups = JSON.parse(require("fs").readFileSync("frames.json", "utf8"));
require("vm").runInThisContext(require("fs").readFileSync("decode.js", "utf8"));
const wheel = globalThis.codewheelDecode;
const [family] = wheel.table.families;
const shown = (value) => (typeof value === "bigint" ? Number(value) : value);
const results = groups.map(([code, layout, frames, parameters]) => {
  const given = Object.fromEntries(Object.entries(parameters).map(([name, one]) => [name, BigInt(one)]));
  const at = family.interfaces.find((one) => one.frames.some((frame) => frame.name === layout));
  const placed = wheel.placedFor({ code, family, interface: at, parameters: given },
    at.frames.find((one) => one.name === layout));
  const word = (text) => wheel.decodeBits(placed, wheel.numberIn(text, placed.bits));
  return frames.map((one) => (Array.isArray(one) ? wheel.decodeBytes(placed, one) : word(one))).map((found) => [
    found.problems.length ? found.problems[0].fault : "", found.verdict,
    found.reports.map((one) => one.report), Object.fromEntries(found.fields.map((one) => [one.name, shown(one.value)])),
  ]);
});
console.log(JSON.stringify(results));
"""


def decode_in_browser(made: MadeEncoder, cases: Sequence[Case], _: Import, folder: Path) -> Iterator[Case]:
    node = shutil.which("node") or shutil.which("nodejs")
    if node is None:
        pytest.skip("needs node")
    (folder / "decode.js").write_text(generate_page(Library((made.device,)))["browser/decode.js"], encoding="utf-8")
    groups = [group for _, group in by_code(cases)]
    data = [_group_for_script(made, group) for group in groups]
    (folder / "frames.json").write_text(json.dumps(data), encoding="utf-8")
    done = subprocess.run([node, "-e", _SCRIPT], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    names = next(tuple(case.values) for case in cases if case.values is not None)
    for group, results in zip(groups, json.loads(done.stdout), strict=True):
        for case, (fault, verdict, reports, fields) in zip(group, results, strict=True):
            if fault:
                yield with_result(case, fault)
                continue
            fields["unused"] = _unused(made, case.layout, fields)
            values = {name: fields.get(name, 0) for name in names}
            yield with_result(case, "", verdict, frozenset(reports), values)


def _unused(made: MadeEncoder, layout: str, fields: Mapping[str, int]) -> int:
    """Return the reserved bits that differ. The page shows the bits as sent."""
    name, documented = made.reserved.get(layout, ("", 0))
    return fields[name] ^ documented if name in fields else 0


def _group_for_script(made: MadeEncoder, group: Sequence[Case]) -> list[object]:
    code, layout = group[0].code, group[0].layout
    variant, _ = made.placed(code, layout)
    return [code, layout, [_frame_for_script(case) for case in group], dict(variant.parameters)]


def _frame_for_script(case: Case) -> object:
    frame = frame_of(case)
    return list(frame) if isinstance(frame, bytes) else f"0x{frame:X}"


ENGINES = {
    "reference": decode_by_reference,
    "python": decode_in_python,
    "columns": decode_in_columns,
    "c": decode_in_c,
    "browser": decode_in_browser,
}
