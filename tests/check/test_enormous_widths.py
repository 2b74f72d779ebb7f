"""A width of any size is a problem of the spec, never an exception."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.loading.library import load_library

#: Specs of one manufacturer, without problems.
SPECS = Path(__file__).resolve().parents[2] / "specs" / "mps"


@pytest.mark.parametrize("bits", [65, 10**6, 10**20])
def test_a_field_of_a_request_is_too_wide(bits: int, tmp_path: Path) -> None:
    """A word over SPI has at most 64 bits."""
    for path in SPECS.glob("*.yaml"):
        text = path.read_text(encoding="utf-8")
        widened_text = text.replace("{name: zero, bits: 16,", f"{{name: zero, bits: {bits},")
        (tmp_path / path.name).write_text(widened_text, encoding="utf-8")
    _, report = load_library([tmp_path])
    assert {problem.rule for problem in report.problems} == {"too-long"}
    assert all(f" {bits} bits" in problem.message for problem in report.problems)
