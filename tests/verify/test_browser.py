"""The page in a real browser, with a hundred thousand frames of each layout, valid and disturbed.

Fields, error, verdict and reports equal the reference codec's, and the generated Python package's for each order code
with its defaults. A tenth as many contents of registers are read. ``CODEWHEEL_FRAMES`` lowers the number.
"""

from __future__ import annotations

import random
import zlib
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from browser_harness import Asker, Case, cases, disturbed_numbers
from codewheel.reference import codec
from codewheel.reference.findings import findings
from codewheel.targets import Library
from codewheel.targets.browser.files import generate
from tools import tool
from tree import generated_tree, library, number_from_environment, package_of

FRAMES = min(number_from_environment("CODEWHEEL_FRAMES", 100_000), 100_000)
KINDS = {"LengthError": "length", "CrcError": "crc", "ConstantError": "constant", "RangeError": "range"}


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return generated_tree(tmp_path_factory.mktemp("tree")) / "python"


def frames_of_case(case: Case, count: int, random_: random.Random, encoder: Any, kinds: Counter[str]) -> dict[str, Any]:
    """Return frames of a case with a CRC-32 of the reference's result for each. Python is compared on the way."""
    texts, expected = [], []
    for number, extra_bits in disturbed_numbers(case, count, random_):
        decoded = case.decoded(number, extra_bits)
        texts.append(case.text(number, extra_bits))
        expected.append(f"{zlib.crc32(case.result_text(decoded).encode()):08x}")
        kinds[decoded.problems[0].fault.value if decoded.problems else "sound"] += 1
        if encoder is not None:
            same_in_python(case, encoder, texts[-1], decoded)
    return {**case.data, "frames": texts, "expected": expected}


def same_in_python(case: Case, encoder: Any, text: str, decoded: codec.DecodedFrame) -> None:
    if decoded.layout is not None and case.device.alternatives_of(decoded.layout.layout):
        return  # Python requires an answer. Frames with one are compared with the reference elsewhere.
    try:
        package_frame = encoder.decode(frame_of_text(case, text))
    except ValueError as error:
        assert decoded.problems, text
        assert KINDS[type(error).__name__] == decoded.problems[0].fault.value, text
        return
    expected = findings(case.device, case.variant, decoded)
    assert not decoded.problems, text
    verdict = getattr(package_frame, "verdict", None)
    assert (verdict and verdict.value) == (expected.verdict and expected.verdict.value), text
    expected_meanings = sorted(report.meaning for report in expected.reports)
    assert sorted(report.meaning for report in package_frame.reports) == expected_meanings, text
    layout = decoded.layout.layout if decoded.layout is not None else case.layout
    names = {field.name for field in layout.fields if field.carries_data} | {join.name for join in layout.joins}
    for field in decoded.fields:
        if field.name in names and hasattr(package_frame, field.name):
            value = getattr(package_frame, field.name)
            assert field.value == (
                value.name.lower() if isinstance(field.value, str) and hasattr(value, "name") else value
            )


def frame_of_text(case: Case, text: str) -> bytes | int | str:
    """Return the result of Python for the text of a frame."""
    if case.layout.in_bytes:
        return bytes.fromhex(text)
    return text[2:] if text.startswith("0b") else int(text, 16)


@pytest.mark.parametrize("family", sorted(library()))
def test_frames_and_registers(family: str, packages: Path, tmp_path: Path) -> None:
    device = library()[family]
    package: Any = package_of(device, packages)
    program = tool("chromium")
    ask = Asker(tmp_path, generate(Library((device,)))["browser/decode.js"], program)
    random_, items, kinds = random.Random(family), [], Counter[str]()
    delivered = {variant.code: variant.parameters for variant in device.variants}
    for layout_cases in cases(device):
        count = FRAMES if layout_cases[0].register is None else FRAMES // 10
        for case in layout_cases:
            is_listed = delivered.get(case.variant.code) == case.variant.parameters
            in_python = is_listed and case.layout.sender == "encoder"
            encoder = package.lookup(case.variant.code) if in_python else None
            items.append(frames_of_case(case, count // len(layout_cases), random_, encoder, kinds))
    answers = ask("compared", items, timeout=1800)
    assert [difference for answer in answers for difference in answer][:5] == []
    assert kinds.keys() >= {"sound", "length"}
