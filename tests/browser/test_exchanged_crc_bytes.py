"""A CRC with its bytes exchanged, as in MODBUS, which sends its numbers high byte first and its CRC low byte first."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from browser_harness import Asker
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.targets import Library

pytestmark = pytest.mark.slow

MANUFACTURER = {"manufacturer.yaml": "codewheel: 1\nmanufacturer: test\ntitle: Test\nsource: Cover\n"}
SPEC = """\
codewheel: 1
device: modbus
manufacturer: test
title: Encoder over MODBUS RTU
movement: rotary
evidence: {grade: uncorroborated, documents: {manual: p.3 and p.6}}
manual: {title: Manual, revision: "1", language: en}
parameters: {}
order_code:
  pattern: "M-{output}"
  source: p.3
  parts:
    - {name: output, meaning: Interface, values: {R: {meaning: MODBUS RTU, interface: rs485}}}
measurement: {of: position, counts_per_turn: 1024, turns: 24, source: p.3}
crcs:
  - {name: modbus, width: 16, poly: 0x8005, init: 0xFFFF, refin: true, refout: true, xorout: 0, source: "1.2.1"}
interfaces:
  rs485:
    source: "1.1"
    port: {baud: 9600, data_bits: 8, parity: none, stop_bits: 1, source: "1.1"}
    exchanges:
      - {request: request, reply: reply, purpose: position}
    layouts:
      - name: request
        from: master
        byte_order: high_byte_first
        source: "1.2.1"
        fields:
          - {name: address, bits: 8, default: 1}
          - {name: function, bits: 8, constant: 3}
          - {name: first, bits: 16, constant: 0}
          - {name: number, bits: 16, constant: 2}
          - {name: crc, crc: modbus}
      - name: reply
        from: encoder
        byte_order: high_byte_first
        source: "1.2.1"
        fields:
          - {name: address, bits: 8}
          - {name: function, bits: 8, constant: 3}
          - {name: length, bits: 8, constant: 4}
          - {name: position, bits: 32, unit: counts}
          - {name: crc, crc: modbus}
"""
EXAMPLE = """\
examples:
  - name: request
    kind: frame
    layout: request
    from: master
    order_code: M-R
    bytes: "01 03 00 00 00 02 C4 0B"
    values: {address: 1}
    source: "1.2.1"
"""
#: A reply with the position 6120, with the CRC as MODBUS sends it.
REPLY = "01 03 04 00 00 17 E8 F5 8D"
MESSAGE = "expected CRC 0x8df5, got 0xf58d, which is this CRC with its bytes exchanged"


def write(folder: Path, text: str) -> list[Path]:
    """Write the specs, and return their files."""
    files = []
    for name, content in (MANUFACTURER | {"modbus.yaml": text}).items():
        (folder / name).write_text(content, encoding="utf-8")
        files.append(folder / name)
    return files


def test_check_says_what_to_write(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = write(tmp_path, SPEC + EXAMPLE)
    assert main(["check", *map(str, files)]) == 1
    printed = capsys.readouterr().out
    assert "expected CRC 0xbc4, got 0xc40b, which is this CRC with its bytes exchanged" in " ".join(printed.split())
    assert "write 'byte_order: low_byte_first' in the field 'crc'" in printed
    text = (SPEC + EXAMPLE).replace("crc: modbus}", "crc: modbus, byte_order: low_byte_first}")
    assert main(["check", *map(str, write(tmp_path, text))]) == 0


def test_decode_says_that_they_are_exchanged(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path, SPEC)
    assert main(["decode", "M-R", REPLY, "--specs", str(tmp_path)]) == 1
    printed = " ".join(capsys.readouterr().out.split())
    assert MESSAGE in printed
    assert "No common mistake" not in printed


def test_the_page_says_the_same(tmp_path: Path, ask: Callable[[Library, str], Asker]) -> None:
    library = Library(load_library(write(tmp_path, SPEC))[0])
    ((answer,),) = ask(library, "node")("lines", [{"code": "M-R", "text": REPLY}])
    assert MESSAGE in answer[-1]
