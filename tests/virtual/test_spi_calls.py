"""Calls that carry out a list of steps: a register over SPI is one call, and other registers are not part of it."""

from __future__ import annotations

import importlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from python_path import new_packages
from working_tools import require

pytestmark = pytest.mark.slow

HERE = Path(__file__).parent
SPECS = HERE.parents[1] / "specs"
CHECKS = (
    "-std=c99 -Wall -Wextra -Wconversion -Werror -O1 -fsanitize=undefined,address -fno-sanitize-recover=all".split()
)
OK, LENGTH = "0", "1"
#: Two registers of one byte at neighbouring addresses, in the example of the MA732.
NEIGHBOURS = """\
procedures:
  - name: trimming
    title: Read the trimming of the bias current
    interface: spi
    steps:
      - {do: read, register: bct, meaning: read BCT}
      - {do: read, register: trimming, meaning: read ET}
    source: "mo: SetConfig; ml: set_et"
"""
#: Calls for each list of spi_calls.c. The words of the first program are in Figure 6-10 on page 72 of the TLE5012B
#: User's Manual.
CALLS = {
    "set zero": ["read 09: FE 70", "write 09: 76 00", "read 09: 76 00", "bytes 00: 76 00", OK],
    "neighbours": ["read 10: FE 70", "bytes 00: FE 70", OK],
    "neighbours on their own": ["read 10: FE", "read 11: FE", "bytes 00: FE FE", OK],
    "one of them on its own": ["read 10: FE", "read 11: FE", "read 12: FE", "bytes 00: FE FE FE", OK],
    "a longer neighbour": ["read 10: FE", "read 11: FE 70", "read 13: FE", "bytes 00: FE FE 70 FE", OK],
    "further bytes of nothing": ["bytes 00:", LENGTH],
    "further bytes of a wait": ["bytes 00:", LENGTH],
    "further bytes of a request": ["bytes 00:", LENGTH],
    "8 bytes": ["write 10: 00 01 02 03 04 05 06 07", "bytes 00:", OK],
    "9 bytes": ["bytes 00:", LENGTH],
    "no steps": ["bytes 00:", LENGTH],
}


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("calls")
    text = (SPECS / "mps" / "ma732.yaml").read_text(encoding="utf-8")
    (folder / "ma732.yaml").write_text(text + NEIGHBOURS, encoding="utf-8")
    specs = [str(SPECS / "mps" / "manufacturer.yaml"), str(folder / "ma732.yaml")]
    for name, specs_of_maker in (("infineon", [str(SPECS / "infineon")]), ("mps", specs)):
        command = ["generate", *specs_of_maker, "--target", "python", "--target", "c", "-o", str(folder / name)]
        assert main(command) == 0
    return folder


@pytest.fixture(scope="module")
def program(outputs: Path) -> Path:
    """Two files: only one of them includes the headers of an encoder."""
    program = outputs / "calls"
    sources = [str(HERE / name) for name in ("spi_calls.c", "spi_list.c")]
    include = str(outputs / "infineon" / "c" / "include")
    require(["gcc", *CHECKS])
    subprocess.run(["gcc", *CHECKS, "-I", include, *sources, "-o", str(program)], check=True)
    return program


@pytest.mark.parametrize("runner", [[], ["runner"]], ids=["run", "runner"])
@pytest.mark.parametrize("name", CALLS)
def test_each_list_makes_these_calls(name: str, runner: list[str], program: Path) -> None:
    completed = subprocess.run([program, name, *runner], capture_output=True, text=True, check=True)
    assert completed.stdout.splitlines() == CALLS[name]


def test_the_steps_of_a_spec_read_neighbours_on_their_own(outputs: Path, tmp_path: Path) -> None:
    source, program = tmp_path / "steps.c", tmp_path / "steps"
    source.write_text(
        '#include <stdio.h>\n#include "mps/ma732_spi_procedures.h"\n'
        "static int32_t read_register(void *context, uint16_t address, uint8_t *bytes, size_t length)\n"
        "{\n    (void)context;\n    bytes[0] = 0U;\n"
        '    printf("%u %u\\n", address, (unsigned)length);\n    return 0;\n}\n'
        "int main(void)\n{\n"
        "    const cw_transport transport = { NULL, read_register, NULL, NULL, NULL, 0U, 0U };\n"
        "    mps_ma732_spi_trimming_read held;\n"
        "    return (int)mps_ma732_spi_trimming(&transport, MPS_MA732_SPI_MA732, &held, NULL);\n}\n",
        encoding="ascii",
    )
    include = str(outputs / "mps" / "c" / "include")
    require(["gcc", *CHECKS])
    subprocess.run(["gcc", *CHECKS, "-I", include, str(source), "-o", str(program)], check=True)
    completed = subprocess.run([program], capture_output=True, text=True, check=True)
    assert completed.stdout == "2 1\n3 1\n"


@pytest.fixture(scope="module")
def package(outputs: Path) -> Iterator[Any]:
    sys.path.insert(0, str(outputs / "mps" / "python"))
    with new_packages():
        yield importlib.import_module("mps_encoders")
    sys.path.remove(str(outputs / "mps" / "python"))


def test_python_reads_neighbours_on_their_own(package: Any) -> None:
    calls: list[tuple[int, int]] = []

    class Bus:
        def read(self, address: int, length: int, /) -> bytes:
            calls.append((address, length))
            return bytes(length)

        def write(self, address: int, data: bytes, /) -> None:
            raise AssertionError(address, data)

    package.run(importlib.import_module("mps_encoders.ma732").trimming(), Bus())
    assert calls == [(2, 1), (3, 1)]
