"""SPI words whose length depends on the order code: the RLS Orbis without and with the multiturn counter."""

from __future__ import annotations

import importlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.spi_line import SpiLine
from python_path import import_anew
from working_tools import require

pytestmark = pytest.mark.slow

SPECS = Path(__file__).parents[2] / "specs"
#: Table of moteus, fw/orbis.h at commit db1a762, for half a byte.
TABLE = bytes.fromhex("00 97 B9 2E E5 72 5C CB 5D CA E4 73 B8 2F 01 96")
POSITION = 0x1234


def with_crc(data: bytes) -> bytes:
    """The bytes with the CRC that moteus computes."""
    crc = 0
    for byte in data:
        for half in (byte >> 4, byte & 15):
            crc = TABLE[crc >> 4 ^ half] ^ (crc << 4 & 0xFF)
    return data + bytes([crc ^ 0xFF])


#: Position in the upper 14 bits, and error and warning inactive, as in the drivers. The counter comes first.
WORDS = {"Orbis-14": with_crc(bytes.fromhex("48 D3")), "Orbis-14M": with_crc(bytes.fromhex("00 00 48 D3"))}


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("lengths")
    specs = [str(SPECS / "rls" / name) for name in ("orbis.yaml", "manufacturer.yaml")]
    assert main(["generate", *specs, "--target", "python", "--target", "c", "-o", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def package(outputs: Path) -> Iterator[Any]:
    sys.path.insert(0, str(outputs / "python"))
    yield importlib.import_module("rls_encoders")
    sys.path.remove(str(outputs / "python"))


@pytest.mark.parametrize("code", WORDS)
def test_an_encoder_sends_words_of_its_length(code: str, package: Any) -> None:
    word = WORDS[code]
    encoder = VirtualEncoder(code, POSITION, specs=[SPECS])
    line = SpiLine(encoder)
    line.receive(bytes(2 * len(word)))
    assert line.send() == 2 * word
    frame = package.lookup(code).decode(int.from_bytes(word, "big"))
    assert (frame.usable_position, frame.multiturn) == (POSITION, 0)


def test_the_counter_of_a_longer_word_is_decoded(package: Any) -> None:
    word = int.from_bytes(with_crc(bytes.fromhex("12 34 48 D3")), "big")
    frame = package.lookup("Orbis-14M").decode(word)
    assert (frame.multiturn, frame.usable_position) == (0x1234, POSITION)
    with pytest.raises(package.LengthError):
        package.lookup("Orbis-14").decode(word)


def test_c_decodes_both_lengths(outputs: Path, tmp_path: Path) -> None:
    source, program = tmp_path / "orbis.c", tmp_path / "orbis"
    checks = ""
    for at, (code, word) in enumerate(WORDS.items(), 1):
        table = f"RLS_ORBIS_SPI_{code.removeprefix('Orbis-')}"
        checks += (
            f"    if ((rls_orbis_spi_decode({table}, cw_word_of(UINT64_C(0x{word.hex()}), {8 * len(word)}U),"
            f" &frame) != CW_OK) || (frame.position != 0x{POSITION:X}U)) return {at};\n"
        )
    source.write_text(
        f'#include "rls/orbis_spi.h"\nint main(void)\n{{\n    rls_orbis_spi_frame frame;\n{checks}    return 0;\n}}\n',
        encoding="ascii",
    )
    strict = "-std=c99 -Wall -Wextra -Wconversion -Werror -fsanitize=undefined,address".split()
    include = str(outputs / "c" / "include")
    require(["gcc", *strict])
    subprocess.run(["gcc", *strict, "-I", include, str(source), "-o", str(program)], check=True)
    subprocess.run([program], check=True)


SPEC = """\
codewheel: 1
device: long
manufacturer: acme
title: Words of 64 bits
movement: rotary
manual: {title: Manual, revision: "1.0", language: en}
parameters: {}
order_code:
  pattern: "{model}"
  source: "1"
  parts: [{name: model, meaning: Model, values: {LONG: {interface: spi}}}]
measurement: {of: position, counts_per_turn: 2^48, turns: 1, source: "2"}
crcs: [{name: crc_8, width: 8, poly: 0x2F, init: 0xFF, refin: false, refout: false, xorout: 0xFF, source: "3"}]
interfaces:
  spi:
    source: "6"
    mode: 1
    word_bits: 64
    reply: next_word
    clock: {max_hz: 10000000, source: "6.2"}
    exchanges: [{request: ask, reply: position, purpose: position}]
    layouts:
      - name: ask
        from: master
        source: "6"
        fields: [{name: command, bits: 56, constant: 0x13}, {name: crc, crc: crc_8}]
      - name: position
        from: encoder
        source: "6"
        fields: [{name: position, bits: 48}, {name: number, bits: 8}, {name: crc, crc: crc_8}]
evidence: {grade: manual, documents: {manual: all pages}}
"""
#: Words without their CRC.
ASK, REPLY = (bytes.fromhex(text) for text in ("00 00 00 00 00 00 13", "FE DC BA 98 76 54 00"))


def autosar(data: bytes) -> bytes:
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ (0x2F if crc & 0x80 else 0)) & 0xFF
    return data + bytes([crc ^ 0xFF])


def test_words_of_64_bits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The longest words of SPI fill a number of 64 bits. The CRC of 00 00 00 00 is 12h in AUTOSAR's table."""
    assert autosar(bytes(4))[-1] == 0x12
    (tmp_path / "long.yaml").write_text(SPEC, encoding="ascii")
    maker = "codewheel: 1\nmanufacturer: acme\ntitle: ACME\nsource: test\npython_package: long_encoders\n"
    (tmp_path / "manufacturer.yaml").write_text(maker, encoding="ascii")
    out = tmp_path / "out"
    assert main(["generate", str(tmp_path), "--target", "python", "--target", "c", "-o", str(out)]) == 0
    encoder = VirtualEncoder("LONG", 0xFEDCBA987654, specs=[tmp_path])
    line = SpiLine(encoder)
    line.receive(2 * autosar(ASK))
    assert line.send() == bytes(8) + autosar(REPLY)
    monkeypatch.syspath_prepend(str(out / "python"))
    package = import_anew("long_encoders", monkeypatch)
    pipeline = package.lookup("LONG").pipeline()
    assert pipeline.ask(package.long.Ask()).to_bytes(8, "big") == autosar(ASK)
    assert package.lookup("LONG").decode(int.from_bytes(autosar(REPLY), "big")).position == 0xFEDCBA987654
    source = tmp_path / "long.c"
    source.write_text(
        '#include "acme/long_spi.h"\nint main(void)\n{\n    acme_long_spi_position frame;\n'
        f"    return (acme_long_spi_position_decode(ACME_LONG_SPI_LONG, UINT64_C(0x{autosar(REPLY).hex()}), &frame)"
        " == CW_OK) && (frame.position == UINT64_C(0xFEDCBA987654)) ? 0 : 1;\n}\n",
        encoding="ascii",
    )
    strict = "-std=c99 -Wall -Wextra -Wconversion -Werror -fsanitize=undefined,address".split()
    require(["gcc", *strict])
    subprocess.run(
        ["gcc", *strict, "-I", str(out / "c" / "include"), str(source), "-o", str(tmp_path / "a")], check=True
    )
    subprocess.run([tmp_path / "a"], check=True)


#: A register of 40 bits, which fits into a word of 64 bits with its address.
LONG_REGISTER = """\
registers:
  - name: offset
    printed_name: OFFSET
    meaning: Offset
    interface: spi
    address: 0x20
    length: 5
    access: read_write
    source: "7"
procedures:
  - name: set_offset
    title: Write the offset
    interface: spi
    arguments: [{name: offset, of: offset, meaning: Offset}]
    steps: [{do: write, register: offset, value: offset, meaning: write the offset}]
    source: "7"
examples:
  - name: offset
    kind: procedure
    procedure: set_offset
    order_code: LONG
    arguments: {offset: 0xFEDCBA9876}
    writes: [{address: 0x20, value: 0xFEDCBA9876}]
    source: "7"
"""
ACCESSES = """\
      - name: read_request
        from: master
        source: "7"
        fields: [{name: command, bits: 8, constant: 1}, {name: address, bits: 16}, {name: zero, bits: 40, constant: 0}]
      - name: write_request
        from: master
        source: "7"
        fields: [{name: command, bits: 8, constant: 2}, {name: address, bits: 16}, {name: data, bits: 40}]
      - name: register_reply
        from: encoder
        source: "7"
        fields: [{name: data, bits: 40}, {name: zero, bits: 24, unused: 0}]
evidence:"""


def test_an_example_writes_a_register_of_more_than_32_bits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    more = "{request: read_request, reply: register_reply, purpose: read}, "
    more += "{request: write_request, reply: register_reply, purpose: write}, "
    text = SPEC.replace("device: long", "device: longer").replace("evidence:", ACCESSES)
    text = text.replace("exchanges: [", f"exchanges: [{more}")
    (tmp_path / "longer.yaml").write_text(text + LONG_REGISTER, encoding="ascii")
    maker = "codewheel: 1\nmanufacturer: acme\ntitle: ACME\nsource: test\npython_package: longer_encoders\n"
    (tmp_path / "manufacturer.yaml").write_text(maker, encoding="ascii")
    out = tmp_path / "out"
    assert main(["generate", str(tmp_path), "--target", "python", "--target", "c", "-o", str(out)]) == 0
    monkeypatch.syspath_prepend(str(out / "python"))
    package = importlib.import_module("longer_encoders")
    words: list[int] = []

    def exchange(word: int) -> int:
        words.append(word)
        return 0

    package.run(package.longer.set_offset(0xFEDCBA9876), package.lookup("LONG").pipeline().bus(exchange))
    assert words == [0x020020FEDCBA9876]
