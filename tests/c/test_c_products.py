"""A product of parameters, one of which follows from others, has the type of its function."""

from __future__ import annotations

from pathlib import Path

from codewheel.loading.library import load_library
from codewheel.targets import Library
from codewheel.targets.c.files import generate

MANUFACTURER = Path(__file__).resolve().parents[1] / "specs" / "manufacturer.yaml"
SPEC = """\
codewheel: 1
device: filled
manufacturer: test
title: Filled word
movement: rotary
evidence: {grade: manual, documents: {manual: all pages}}
manual: {title: Made up, revision: "1", language: en}
parameters:
  position_bits: {meaning: Bits of the position}
  is_filled: {meaning: 1 with zeros}
  missing_bits: {meaning: Bits that are missing, equals: 28 - position_bits}
  zero_bits: {meaning: Zeros, equals: missing_bits * is_filled}
order_code:
  pattern: "F{bits}{filled}"
  source: "1"
  parts:
    - {name: bits, meaning: Bits, values: {"25": {interface: ssi, sets: {position_bits: 25}}, "28": {interface: ssi, sets: {position_bits: 28}}}}
    - {name: filled, meaning: Zeros, values: {N: {sets: {is_filled: 0}}, Z: {sets: {is_filled: 1}}}}
measurement: {of: position, counts_per_turn: 2^position_bits, turns: 1, source: "1"}
interfaces:
  ssi:
    source: "1"
    clock: {max_hz: 1000000, source: "1"}
    alignment: msb_left
    output_code: binary
    layouts:
      - {name: word, from: encoder, source: "1", fields: [{name: position, bits: position_bits, unit: counts}, {name: zeros, bits: zero_bits, constant: 0}]}
"""  # noqa: E501


def test_a_small_product_in_64_bits_is_cast(tmp_path: Path) -> None:
    path = tmp_path / "filled.yaml"
    path.write_text(SPEC, encoding="utf-8")
    devices, report = load_library([path, MANUFACTURER])
    assert not report
    header = generate(Library(tuple(devices)), {})["c/include/test/filled_ssi.h"]
    [product] = [line.strip() for line in header.splitlines() if "* variant.is_filled" in line]
    assert product.startswith("return (uint32_t)((uint64_t)"), product
