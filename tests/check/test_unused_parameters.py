"""Parameters on which nothing depends, and facts with one mistake: each mistake is one problem."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from codewheel.language.schemas import load_schema
from codewheel.loading.library import load_library
from codewheel.loading.order_code_facts import EXPRESSION_KEYS

HERE = Path(__file__).parent
MINIMAL = (HERE / "ok" / "minimal.yaml").read_text(encoding="utf-8")
MAKER = (HERE / "broken_model" / "manufacturer.yaml").read_text(encoding="utf-8")
PARITY = (
    ("  position_bits: {", "  parity_bits: {meaning: Bits of the parity}\n  position_bits: {"),
    ("{position_bits: 12}", "{position_bits: 12, parity_bits: 0}"),
    ("{position_bits: 16}", "{position_bits: 16, parity_bits: 1}"),
)
CLOCK = '    clock: {min_hz: 200000, max_hz: 10000000, source: "6.2"}\n'
TWO_CLOCKS = """\
    clock:
      - {min_hz: 200000, max_hz: 10000000, only: MIN12..., source: "6.2"}
      - {min_hz: 200000, max_hz: 5000000, only: PATTERN, source: "6.2"}
"""


def problems(folder: Path, *changes: tuple[str, str]) -> list[tuple[str, str]]:
    """Return the rules and messages about the minimal spec with these changes."""
    text = MINIMAL
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (folder / "manufacturer.yaml").write_text(MAKER, encoding="utf-8")
    (folder / "minimal.yaml").write_text(text, encoding="utf-8")
    _, report = load_library([folder])
    return [(problem.rule, problem.message) for problem in report.problems]


def keys_with_expressions(shape: Any) -> Iterator[str]:
    """Yield the keys in a JSON Schema whose values are expressions."""
    if isinstance(shape, list):
        shape = dict(enumerate(shape))
    if not isinstance(shape, dict):
        return
    for key, member in shape.items():
        if isinstance(member, dict) and member.get("$ref") == "#/$defs/expression":
            yield str(key)
        yield from keys_with_expressions(member)


def test_a_lost_parity_is_reported(tmp_path: Path) -> None:
    ((rule, message),) = problems(tmp_path, *PARITY)
    assert rule == "unused-parameter"
    assert message.startswith("nothing depends on 'parity_bits', which order codes set to 0 or 1; ")


@pytest.mark.parametrize(
    "change",
    [
        ("{name: warning, active: low", "{name: warning, bits: parity_bits, active: low"),
        ("- {name: crc,", "- {name: parity, bits: parity_bits, parity_of: position}\n          - {name: crc,"),
        ("access: read_write,", "access: read_write, max: 6 + parity_bits,"),
    ],
)  # fmt: skip
def test_each_use_counts(tmp_path: Path, change: tuple[str, str]) -> None:
    assert problems(tmp_path, *PARITY, change) == []


def test_another_problem_hides_it(tmp_path: Path) -> None:
    """The part with the problem may use the parameter."""
    misspelt = ("{name: warning, active: low", "{name: warning, bitz: parity_bits, active: low")
    assert [rule for rule, _ in problems(tmp_path, *PARITY, misspelt)] == ["unknown-key"]


def test_every_key_with_an_expression_is_known() -> None:
    """A new key with an expression is a use of its parameters. ``equals`` of a field can be text instead."""
    assert {*keys_with_expressions(load_schema("device")), "equals", "when"} == EXPRESSION_KEYS


def test_a_wrong_pattern_is_one_problem(tmp_path: Path) -> None:
    change = (CLOCK, TWO_CLOCKS.replace("PATTERN", "MX"))
    ((rule, message),) = problems(tmp_path, change)
    assert rule == "only-codes"
    assert "matches 'MX'" in message


def test_a_missing_clock_is_reported(tmp_path: Path) -> None:
    assert [
        rule for rule, _ in problems(tmp_path, (CLOCK, TWO_CLOCKS.partition("      - {min_hz: 200000, max_hz: 5")[0]))
    ] == ["only-gap"]


def test_without_an_interface_the_known_ones_are_named(tmp_path: Path) -> None:
    ssi = """\
  ssi:
    source: "5"
    clock: {min_hz: 100000, max_hz: 1000000, source: "5.3"}
    alignment: msb_left
    layouts: [{name: word, from: encoder, source: "5.2", fields: [{name: position, bits: position_bits}]}]
"""
    changes = (("interfaces:\n", f"interfaces:\n{ssi}"), ("SC: {interface: biss}", "SC: {}"))
    ((_, message),) = problems(tmp_path, *changes)
    assert message.endswith(" selects none; write 'interface: ssi', or another one, in each value of one part")
