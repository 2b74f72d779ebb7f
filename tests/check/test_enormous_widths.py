"""A width of any size is a problem of the spec, never an exception."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.loading.library import load_library

SPEC = Path(__file__).resolve().parents[2] / "examples" / "encoders" / "mps"


@pytest.mark.parametrize("bits", [65, 10**6, 10**20])
def test_a_field_of_a_request_is_too_wide(bits: int, tmp_path: Path) -> None:
    for path in SPEC.glob("*.yaml"):
        text = path.read_text(encoding="utf-8")
        (tmp_path / path.name).write_text(
            text.replace("name: zero, bits: 16", f"name: zero, bits: {bits}"), encoding="utf-8"
        )
    _, report = load_library([tmp_path])
    assert report.problems
