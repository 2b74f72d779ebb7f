"""Requests that the example programs send, as printed in the sources of the specs."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from c_harness import WARNINGS
from codewheel.commands.cli import main

pytestmark = pytest.mark.slow

ENCODERS = Path(__file__).parents[2] / "specs"

#: GET1 for alpha of the MLX90363, whose timeout is FFFFh by default (Getting Started Guide, p.10).
GET1 = "00 00 FF FF 00 00 13 EA"
#: The request for the frame that each program shows.
#: AMT21: RS485_ENC0 of the manufacturer's sketch. SKM36: "Read Position" of NiLAB's page. Orbis: the command "t".
#: AMT22: two bytes 00 in the data sheet. AS5048A: FFFFh reads the angle. MT6835: A003h and zeros.
REQUESTS = {
    "cui/amt21_rs485": "54",
    "sick/skm36_rs485": "40 42 02",
    "rls/orbis_serial_rs485": "74",
    "cui/amt22_spi": "00 00",
    "ams/as5048a_spi": "FF FF",
    "magntek/mt6835_spi": "A0 03 00 00 00 00",
    "melexis/mlx90363_spi": GET1,
}
MAKER = "codewheel: 1\nmanufacturer: test\ntitle: Test\nsource: '1'\n"
#: The same request with a joined number, a flag and a named value.
MLX = """
codewheel: 1
device: mlx
manufacturer: test
title: Sensor with defaults in its request
movement: rotary
evidence: {grade: uncorroborated, documents: {manual: p.10}}
manual: {title: Getting Started Guide, revision: "002", language: en}
parameters: {}
order_code:
  pattern: "MLX{model}"
  source: "1"
  parts: [{name: model, meaning: Model, values: {"1": {meaning: The only one, interface: spi}}}]
crcs: [{name: crc_8, width: 8, poly: 0x2F, init: 0xFF, refin: false, refout: false, xorout: 0xFF, source: "1"}]
measurement: {of: position, counts_per_turn: 2^14, turns: 1, source: "1"}
interfaces:
  spi:
    source: "1"
    mode: 1
    word_bits: 64
    reply: next_word
    clock: {max_hz: 500000, source: "1"}
    exchanges: [{request: get1, reply: alpha, purpose: position, source: "1"}]
    layouts:
      - name: get1
        from: master
        source: "1"
        fields:
          - {name: zero, bits: 15, constant: 0}
          - {name: reset, active: high, when_active: the counter is set to 0}
          - {name: low, bits: 8, default: 0xFF, meaning: "Timeout, low byte"}
          - {name: high, bits: 8, default: 0xFF, meaning: "Timeout, high byte"}
          - {name: zero_4, bits: 16, unused: 0}
          - {name: opcode, bits: 8, values: {alpha: {value: 0x13}, beta: {value: 0x53}}}
          - {name: crc, crc: crc_8}
        join: {timeout: [low, high]}
      - name: alpha
        from: encoder
        source: "1"
        fields:
          - {name: zero, bits: 42, constant: 0}
          - {name: position, bits: 14, meaning: Angle}
          - {name: crc, crc: crc_8}
"""


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("requests")
    for name in {program.partition("/")[0] for program in REQUESTS}:
        assert main(["generate", str(ENCODERS / name), "--target", "c", "-o", str(folder / name)]) == 0
    return folder


def printed_requests(package: Path, program: str) -> list[str]:
    """Compile a program with warnings as errors, and return the requests that it prints."""
    executable = package / program
    source, include = package / "c" / "examples" / f"{program}.c", package / "c" / "include"
    command = ["gcc", "-std=c99", *WARNINGS, "-Werror", f"-I{include}", str(source), "-o", str(executable)]
    subprocess.run(command, check=True)
    completed = subprocess.run([executable], check=True, capture_output=True, text=True)
    return [line.removeprefix("send ") for line in completed.stdout.splitlines() if line.startswith("send ")]


@pytest.mark.parametrize("name", REQUESTS)
def test_a_program_sends_the_request_for_its_frame(name: str, packages: Path) -> None:
    folder, _, program = name.partition("/")
    assert {*printed_requests(packages / folder, program)} == {REQUESTS[name]}


def test_a_request_has_the_defaults_of_its_fields(tmp_path: Path) -> None:
    """The parts of a joined number agree with it, and a named value without a default is an existing one."""
    (tmp_path / "manufacturer.yaml").write_text(MAKER, encoding="utf-8")
    (tmp_path / "mlx.yaml").write_text(MLX, encoding="utf-8")
    assert main(["generate", str(tmp_path), "--target", "c", "-o", str(tmp_path)]) == 0
    assert printed_requests(tmp_path, "mlx_spi") == [GET1, GET1]
    program = (tmp_path / "c" / "examples" / "mlx_spi.c").read_text(encoding="ascii")
    assert "/* Set reset, opcode yourself, because there is no default. */" in program
    header = (tmp_path / "c" / "include" / "test" / "mlx_spi.h").read_text(encoding="ascii")
    assert "Set all members, because those that an initial value leaves out are 0." in header


def test_a_field_that_must_be_a_power_of_two_is_one(tmp_path: Path) -> None:
    (tmp_path / "manufacturer.yaml").write_text(MAKER, encoding="utf-8")
    spec = MLX.replace("{name: zero_4, bits: 16, unused: 0}", "{name: rate, bits: 16, power_of_two: true}")
    (tmp_path / "mlx.yaml").write_text(spec, encoding="utf-8")
    assert main(["generate", str(tmp_path), "--target", "c", "-o", str(tmp_path)]) == 0
    assert {request[:17] for request in printed_requests(tmp_path, "mlx_spi")} == {"00 00 FF FF 00 01"}


def test_a_reply_with_another_address_is_refused(packages: Path, tmp_path: Path) -> None:
    """The program shows the reply of the encoder with the address 40h."""
    include = packages / "sick" / "c" / "include"
    program = (packages / "sick" / "c" / "examples" / "skm36_rs485.c").read_text(encoding="ascii")
    assert program.count("asked = { 0x40U }") == 1
    (tmp_path / "program.c").write_text(program.replace("asked = { 0x40U }", "asked = { 0x41U }"), encoding="ascii")
    subprocess.run(
        ["gcc", "-std=c99", f"-I{include}", str(tmp_path / "program.c"), "-o", str(tmp_path / "made")], check=True
    )
    completed = subprocess.run([tmp_path / "made"], capture_output=True, text=True)
    assert (completed.returncode, completed.stdout.splitlines()[1:]) == (1, ["error 4"])
