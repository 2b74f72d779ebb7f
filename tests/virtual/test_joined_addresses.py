"""Addresses that a request or its reply sends in two parts: the link and the C program compare them as one number."""

from __future__ import annotations

import importlib
import subprocess
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main

pytestmark = pytest.mark.slow

SPEC = """
codewheel: 1
device: {name}
manufacturer: parts
title: Encoder with an address in parts
movement: rotary
evidence: {{grade: uncorroborated, documents: {{manual: all pages}}}}
manual: {{title: Manual, revision: "1.0", language: en}}
parameters: {{}}
order_code:
  pattern: "{code}{{model}}"
  source: "1"
  parts: [{{name: model, meaning: Model, values: {{"1": {{meaning: The only one, interface: rs485}}}}}}]
measurement: {{of: position, counts_per_turn: 65536, turns: 1, source: "1"}}
crcs: [{{name: crc_8, width: 8, poly: 0x2F, init: 0xFF, refin: false, refout: false, xorout: 0xFF, source: "1"}}]
interfaces:
  rs485:
    source: "1"
    port: {{baud: 9600, data_bits: 8, parity: even, stop_bits: 1, flow_control: none, source: "1"}}
    exchanges: [{{request: ask, reply: answer, purpose: position, source: "1"}}]
    layouts:
      - name: ask
        from: master
        byte_order: high_byte_first
        source: "1"
        fields:
          - {{name: command, bits: 8, constant: 0x42}}
{request}
      - name: answer
        from: encoder
        byte_order: high_byte_first
        source: "1"
        fields:
          - {{name: command, bits: 8, constant: 0x42}}
          - {{name: position, bits: 16, meaning: Angle}}
{reply}
"""
ONE = """
          - {name: address, bits: 16, meaning: Address}
          - {name: crc, crc: crc_8}"""
PARTS = """
          - {name: low, bits: 8, meaning: Lower part of the address}
          - {name: high, bits: 8, meaning: Upper part of the address}
          - {name: crc, crc: crc_8}
        join: {address: [high, low]}"""
OTHER_PARTS = PARTS.replace("low", "first").replace("high", "second")
#: The fields of the request and of the reply.
FIELDS = {"joined_in_request": (PARTS, ONE), "joined_in_reply": (ONE, PARTS), "joined_in_both": (PARTS, OTHER_PARTS)}


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("parts")
    maker = "codewheel: 1\nmanufacturer: parts\ntitle: Test\nsource: '1'\n"
    (folder / "manufacturer.yaml").write_text(maker, encoding="utf-8")
    for number, (name, (request, reply)) in enumerate(FIELDS.items()):
        spec = SPEC.format(name=name, code="XYZ"[number], request=request, reply=reply)
        (folder / f"{name}.yaml").write_text(spec, encoding="utf-8")
    assert main(["generate", str(folder), "--target", "python", "--target", "c", "-o", str(folder)]) == 0
    return folder


class Answering:
    """Line that answers each request with the same bytes."""

    def __init__(self, reply: bytes) -> None:
        self.reply, self.waiting = reply, b""

    def write(self, data: bytes) -> None:
        self.waiting = self.reply

    def read(self, timeout_s: float) -> bytes:
        received, self.waiting = self.waiting, b""
        return received


def frame_with_address(kind: Any, address: int, **fields: int) -> Any:
    """Return a frame with an address."""
    from_address = getattr(kind, "from_address", None)
    return from_address(address, **fields) if from_address else kind(address=address, **fields)


@pytest.mark.parametrize("name", FIELDS)
def test_the_link_compares_addresses(name: str, outputs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from codewheel_runtime.link import DisturbedError, Link

    monkeypatch.syspath_prepend(str(outputs / "python"))
    module: Any = importlib.import_module(f"parts_encoders.{name}")
    (encoder,) = module.VARIANTS.values()
    link = Link(
        encoder, Answering(frame_with_address(module.Answer, 0x105, position=7).encode()), timeout_s=0.01, retries=0
    )
    assert link.position(frame_with_address(module.Ask, 0x105)) == 7
    for address in (0x106, 0x205):
        with pytest.raises(DisturbedError, match=f"has address 261, but {address} was sent$"):
            link.position(frame_with_address(module.Ask, address))


@pytest.mark.parametrize("name", FIELDS)
def test_a_program_in_c_compares_addresses(name: str, outputs: Path, tmp_path: Path) -> None:
    """The program asks for the address in the frame that it shows, and refuses the reply to another request."""
    program = (outputs / "c" / "examples" / f"{name}_rs485.c").read_text(encoding="ascii")
    (address_line,) = (line for line in program.splitlines() if " asked = { " in line)
    changed_address = "0x1U, 0x1U, 0x101U" if FIELDS[name][0] is PARTS else "0x101U"
    changed = program.replace(address_line, f"{address_line[: address_line.index('{')]}{{ {changed_address} }};")
    addresses = {PARTS: "low, high", ONE: "address"}[FIELDS[name][0]]
    assert f"    /* Set {addresses} yourself, because there is no default. */\n{address_line}" in program
    for text, code in ((program, 0), (changed, 1)):
        (tmp_path / "main.c").write_text(text, encoding="ascii")
        flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", f"-I{outputs / 'c' / 'include'}"]
        subprocess.run(["gcc", *flags, str(tmp_path / "main.c"), "-o", str(tmp_path / "main")], check=True)
        assert subprocess.run([tmp_path / "main"], capture_output=True).returncode == code
