"""A position of joined fields whose widths an answer sets. The expected bits are written as they are sent."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from codewheel.commands.cli import main

SPECS = Path(__file__).parents[1] / "python" / "specs"
SPEC = """
codewheel: 1
device: split
manufacturer: test
title: Encoder with a split position
movement: rotary
manual: {title: Made up, revision: "1", language: en}
parameters:
  size: {meaning: Width of the position}
  upper_bits: {meaning: Width of the upper part, alternative: form}
  lower_bits: {meaning: Width of the lower part, alternative: form}
alternatives:
  - name: form
    meaning: Where the position is split
    values:
      early: {meaning: After two bits, sets: {upper_bits: 2, lower_bits: 6}}
      late: {meaning: After five bits, sets: {upper_bits: 5, lower_bits: 3}}
    source: "1"
order_code:
  pattern: "S{size}"
  source: "1"
  parts:
    - {name: size, meaning: Bits, values: {A: {interface: ssi, sets: {size: 8}}}}
interfaces:
  ssi:
    source: "1"
    clock: {min_hz: 100000, max_hz: 1000000, source: "1"}
    alignment: lsb_right
    output_code: binary
    layouts:
      - name: word
        from: encoder
        source: "1"
        fields: [{name: upper, bits: upper_bits}, {name: lower, bits: lower_bits}, {name: end, bits: 1, constant: 1}]
        join: {position: [upper, lower]}
measurement: {of: position, counts_per_turn: 2^size, turns: 1, source: "1"}
evidence: {grade: manual, documents: {manual: all pages}}
"""
PROGRAM = """
from test_encoders import split
for answer, upper, lower in ((split.Form.EARLY, 0b10, 0b110101), (split.Form.LATE, 0b10110, 0b101)):
    for frame in (split.WordFrame.decode(0b10110101_1, answer), split.WordFrame.from_position(answer, 0b10110101)):
        assert (frame.upper, frame.lower) == (upper, lower), frame
        assert frame.position == frame.usable_position == 0b10110101, frame
        assert frame.encode() == 0b10110101_1, frame
try:
    split.WordFrame(None, 1, 1).position
except TypeError as error:
    assert str(error).startswith("form must be Form.EARLY or Form.LATE, got None"), error
else:
    raise AssertionError
"""


@pytest.mark.slow
def test_the_answer_sets_the_bits_of_the_position(tmp_path: Path) -> None:
    spec = tmp_path / "split.yaml"
    spec.write_text(SPEC, encoding="utf-8")
    specs = [str(spec), str(SPECS / "manufacturer.yaml")]
    assert main(["generate", *specs, "-o", str(tmp_path), "--target", "python", "--unchecked"]) == 0
    environment = {"PYTHONPATH": f"{tmp_path}/python:{tmp_path}/python/runtime"}
    command = [sys.executable, "-c", PROGRAM]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
