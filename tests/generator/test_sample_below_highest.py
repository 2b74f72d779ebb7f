"""A made-up frame for an encoder whose highest position is far below the highest number of its field."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.cli import main

MAKER = "codewheel: 1\nmanufacturer: acme\ntitle: ACME\nsource: test\n"
SPEC = """\
codewheel: 1
device: decimal
manufacturer: acme
title: 640000 counts in 21 bits
movement: rotary
evidence: {grade: uncorroborated, documents: {manual: test}}
manual: {title: Manual, revision: "1.0", language: en}
parameters: {}
order_code:
  pattern: "D-{output}"
  source: "1"
  parts: [{name: output, meaning: Interface, values: {S: {meaning: SSI, interface: ssi}}}]
measurement: {of: position, counts_per_turn: 640000, turns: 1, source: "1"}
interfaces:
  ssi:
    source: "1"
    clock: {max_hz: 1000000, source: "1"}
    alignment: msb_left
    layouts:
      - {name: word, from: encoder, source: "1", fields: [{name: position, bits: 21}]}
"""


@pytest.mark.slow
def test_each_interface_has_an_example_program(tmp_path: Path) -> None:
    (tmp_path / "manufacturer.yaml").write_text(MAKER, encoding="utf-8")
    (tmp_path / "decimal.yaml").write_text(SPEC, encoding="utf-8")
    assert main(["generate", str(tmp_path), "--target", "c", "-o", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out/c/examples/decimal_ssi.c").is_file()
