"""Values that a manual reserves get names of their own, so the position of their frame counts."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from codewheel.loading.library import load_library
from codewheel.model import Choice, Verdict
from codewheel.reference.bits_and_values import compute
from codewheel.reference.codec import decode
from codewheel.reference.findings import findings

SPECS = Path(__file__).parents[1] / "specs"


@pytest.mark.parametrize("is_reserved", [True, False])
def test_a_reserved_value_is_named_and_the_position_counts(tmp_path: Path, is_reserved: bool) -> None:
    for name in ("banks.yaml", "manufacturer.yaml"):
        shutil.copy(SPECS / name, tmp_path)
    file = tmp_path / "banks.yaml"
    text = file.read_text(encoding="utf-8")
    assert text.count(", others: reserved") == 1
    file.write_text(text if is_reserved else text.replace(", others: reserved", ""), encoding="utf-8")
    (device,), report = load_library([file, tmp_path / "manufacturer.yaml"])
    assert not report.problems
    variant = device.variants[0]
    placed = device.interfaces[0].layouts[0].place(variant.parameters)
    # Position 1000, no error, no warning, status 3. The CRC belongs to the bits before it.
    number = 0b00_0000_0011_1110_1000_11_11_000000
    number |= compute(device.crcs[0], placed, number)
    decoded = decode(device, placed, number)
    status = next(field for field in decoded.fields if field.name == "status")
    if is_reserved:
        assert not decoded.problems
        assert (status.value, status.meaning) == ("reserved_3", "Reserved: the manual does not say what it means")
        assert findings(device, variant, decoded).verdict is Verdict.USABLE
    else:
        assert [problem.message for problem in decoded.problems] == ["status has no value 0x3"]
    kind = next(placed_field.field.kind for placed_field in placed.fields if placed_field.name == "status")
    assert isinstance(kind, Choice)
    listed = ["normal", "weak", "reserved_1", "reserved_3"] if is_reserved else ["normal", "weak"]
    assert [value.name for value in kind.values] == listed
