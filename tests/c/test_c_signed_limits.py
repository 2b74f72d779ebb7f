"""Limits of signed registers that follow from the order code, up to the ends of 64 bits."""

from __future__ import annotations

from pathlib import Path

import pytest
from c_harness import MadeOnce, Run, devices_of, program_over

pytestmark = pytest.mark.slow

SPEC = Path(__file__).parent / "specs" / "edges.yaml"
MAKER = SPEC.with_name("manufacturer.yaml")


@pytest.fixture(scope="module")
def edges(made_once: MadeOnce) -> Run:
    (device,) = devices_of(SPEC, MAKER)
    return program_over(device, made_once, "edges")


@pytest.mark.parametrize(("code", "bits"), [("EA", 0), ("EB", 7), ("EC", 63)])
def test_the_ends_are_taken_and_what_lies_beyond_is_not(edges: Run, code: str, bits: int) -> None:
    low, high = -(2**bits), 2**bits - 1
    values = [value for value in (low - 1, low, 0, high, high + 1) if -(2**63) <= value < 2**63]
    answers = edges(f"{code} encode reg_offset {value}" for value in values)
    assert answers == [f"0 {value % 2**64:016X}" if low <= value <= high else f"4 {0:016X}" for value in values]


@pytest.mark.parametrize(("code", "bits"), [("EA", 0), ("EB", 7), ("EC", 63)])
def test_limits_that_are_sums(edges: Run, code: str, bits: int) -> None:
    low, high = -2 * bits, bits + 5
    answers = edges(f"{code} encode reg_small {value}" for value in (low - 1, low, high, high + 1))
    assert list(answers) == ["4 0000", f"0 {low % 2**16:04X}", f"0 {high:04X}", "4 0000"]
