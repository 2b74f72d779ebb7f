"""Registers over SPI in words whose length depends on the order code, as with a chip that adds a CRC when set to."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.spi_line import SpiLine

pytestmark = pytest.mark.slow

MAKER = "codewheel: 1\nmanufacturer: acme\ntitle: ACME\nsource: test\npython_package: widths_encoders\n"
SPEC = """\
codewheel: 1
device: widths
manufacturer: acme
title: Words of two lengths
movement: rotary
evidence: {grade: uncorroborated, documents: {manual: test}}
manual: {title: Manual, revision: "1.0", language: en}
parameters:
  crc_bits: {meaning: Bits of the CRC, unit: bits, source: "1"}
order_code:
  pattern: "W-{output}"
  source: "1"
  parts:
    - name: output
      meaning: Words
      values:
        S: {meaning: Without CRC, interface: spi, sets: {crc_bits: 0}}
        L: {meaning: With CRC, interface: spi, sets: {crc_bits: 8}}
measurement: {of: position, counts_per_turn: 2^14, turns: 1, source: "1"}
crcs:
  - {name: spi_8, width: 8, poly: 0x1D, init: 0xFF, refin: false, refout: false, xorout: 0, source: "1"}
interfaces:
  spi:
    source: "1"
    mode: 1
    word_bits: 16 + crc_bits
    reply: next_word
    clock: {max_hz: 10000000, source: "1"}
    exchanges:
      - {request: position_request, reply: position_reply, purpose: position}
      - {request: read_request, reply: register_reply, purpose: read}
      - {request: write_request, reply: register_reply, purpose: write}
      - {request: write_data, reply: register_reply, purpose: write}
    layouts:
      - name: position_request
        from: master
        source: "1"
        fields: [{name: command, bits: 8, constant: 0x3F}, {name: rest, bits: 8 + crc_bits, constant: 0}]
      - name: read_request
        from: master
        source: "1"
        fields: [{name: r, bits: 8, constant: 0x40}, {name: address, bits: 8}, {name: z, bits: crc_bits, constant: 0}]
      - name: write_request
        from: master
        source: "1"
        fields: [{name: w, bits: 8, constant: 0x80}, {name: address, bits: 8}, {name: z, bits: crc_bits, constant: 0}]
      - name: write_data
        from: master
        source: "1"
        fields: [{name: zeros, bits: 8, constant: 0}, {name: data, bits: 8}, {name: z, bits: crc_bits, constant: 0}]
      - name: position_reply
        from: encoder
        source: "1"
        fields:
          - {name: warning, bits: 1, active: high, makes_position: usable_with_warning, when_active: a warning}
          - {name: error, bits: 1, active: high, makes_position: not_usable, when_active: an error}
          - {name: position, bits: 14}
          - {name: crc, bits: crc_bits, crc: spi_8}
      - name: register_reply
        from: encoder
        source: "1"
        fields: [{name: mark, bits: 8, constant: 0x5A}, {name: data, bits: 8}, {name: crc, bits: crc_bits, crc: spi_8}]
registers:
  - {name: zero, interface: spi, address: 0x09, length: 1, access: read_write, default: 0, source: "1"}
procedures:
  - name: set_zero
    title: Set the zero position
    interface: spi
    arguments: [{name: position, of: zero, meaning: Upper bits}]
    steps: [{do: write, register: zero, value: position, meaning: write}, {do: read, register: zero, meaning: check}]
    source: "1"
"""


@pytest.fixture(scope="module")
def specs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("specs")
    (folder / "manufacturer.yaml").write_text(MAKER, encoding="utf-8")
    (folder / "widths.yaml").write_text(SPEC, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def package(specs: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    out = tmp_path_factory.mktemp("out")
    assert main(["generate", str(specs), "--target", "python", "-o", str(out)]) == 0
    sys.path.insert(0, str(out / "python"))
    yield importlib.import_module("widths_encoders")
    sys.path.remove(str(out / "python"))


@pytest.mark.parametrize(("code", "bits"), [("W-S", 16), ("W-L", 24)])
def test_registers_are_read_and_written_in_words_of_each_length(
    code: str, bits: int, package: Any, specs: Path
) -> None:
    widths = importlib.import_module("widths_encoders.widths")
    virtual = SpiLine(VirtualEncoder(code, 777, specs=[specs]))
    encoder = package.lookup(code)
    line = encoder.pipeline()
    lengths = set()

    def exchange(word: int) -> int:
        lengths.add(line.bits)
        return virtual.exchange(word, line.bits)

    package.run(widths.set_zero(0x12), line.bus(exchange))
    line.take(exchange(line.read(widths.Zero)))
    assert line.take(exchange(line.ask(widths.PositionRequest(encoder)))).register.zero == 0x12
    assert lengths == {bits}


@pytest.mark.parametrize(("code", "bits"), [("W-S", 16), ("W-L", 24)])
def test_show_calculates_the_length_of_a_word(
    code: str, bits: int, specs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["show", code, "--specs", str(specs)]) == 0
    assert f"{bits} bits, SPI mode 1" in " ".join(capsys.readouterr().out.split())
