"""Procedures over SPI: each step reads or writes a whole register in one access. Words are from public sources."""

from __future__ import annotations

import importlib
import re
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.spi_line import SpiLine
from python_path import new_packages
from working_tools import require

pytestmark = pytest.mark.slow

SPECS = Path(__file__).parents[2] / "specs"
PAGE = Path(__file__).parents[2] / "docs/firmware/spi.md"
#: "SSC data transfer to configure the zero position", TLE5012B User's Manual Rev. 1.2, Figure 6-10 on page 72. The
#: master sends the first two words of a write, and then releases the line. ANG_BASE is FE7h before and 760h after it.
BEFORE = bytes.fromhex("FE 70")
WRITTEN = bytes.fromhex("50 91 76 00 FF FF")
#: READ_INTMODE_3 and DUMMY in the manufacturer's driver.
READ = bytes.fromhex("80 91 FF FF FF FF")


def even(word: int) -> int:
    """The word with bit 15 such that the number of 1 bits is even."""
    return word | (word.bit_count() & 1) << 15


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("steps")
    for name in ("ams", "infineon"):
        command = ["generate", str(SPECS / name), "--target", "python", "--target", "c", "-o", str(folder / name)]
        assert main(command) == 0
    return folder


@pytest.fixture(scope="module")
def load(outputs: Path) -> Iterator[Callable[[str], Any]]:
    folders = [str(outputs / name / "python") for name in ("ams", "infineon")]
    # Other tests may have imported a package of this name with other encoders.
    with new_packages(), pytest.MonkeyPatch.context() as patch:
        for folder in folders:
            patch.syspath_prepend(folder)
        yield importlib.import_module


def recorded(line: SpiLine, words: list[int]) -> Callable[[int], int]:
    def exchange(word: int) -> int:
        words.append(word)
        return line.exchange(word)

    return exchange


def tle5012b() -> tuple[VirtualEncoder, SpiLine]:
    encoder = VirtualEncoder("TLE5012B", registers={"mod_3": BEFORE}, specs=[SPECS])
    return encoder, SpiLine(encoder)


def test_python_sends_the_words_of_the_manual(load: Callable[[str], Any]) -> None:
    package, module = load("infineon_encoders"), load("infineon_encoders.tle5012b")
    encoder, line = tle5012b()
    words: list[int] = []
    (program,) = re.findall(r"```text\n(run\(.*)\n```", PAGE.read_text(encoding="utf-8"))
    names = {"run": package.run, "tle5012b": module, "lookup": package.lookup, "exchange": recorded(line, words)}
    (reading,) = eval(program, names)
    assert [word.to_bytes(6, "big") for word in words] == [READ, WRITTEN, READ]
    assert reading.data == bytes.fromhex("76 00")
    assert encoder.memory.value("mod_3") == 0x7600


@pytest.mark.parametrize("runner", [[], ["runner"]])
def test_c_sends_the_words_of_the_manual(outputs: Path, runner: list[str], tmp_path: Path) -> None:
    program = tmp_path / "steps"
    checks = "-Wall -Wextra -Wconversion -Werror -O1 -fsanitize=undefined,address -fno-sanitize-recover=all".split()
    source = str(Path(__file__).with_name("spi_steps.c"))
    include = str(outputs / "infineon" / "c" / "include")
    require(["gcc", *checks])
    subprocess.run(["gcc", "-std=c99", *checks, "-I", include, source, "-o", str(program)], check=True)
    encoder, line = tle5012b()
    words = []
    with subprocess.Popen([program, *runner], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        while word := process.stdout.read(6):
            words.append(word)
            process.stdin.write(line.exchange(int.from_bytes(word, "big")).to_bytes(6, "big"))
            process.stdin.flush()
    assert process.returncode == 0
    assert words == [READ, WRITTEN, READ]
    assert encoder.memory.value("mod_3") == 0x7600


def test_bits_of_other_fields_are_kept_in_two_words(load: Callable[[str], Any]) -> None:
    """Bit 7 of ZPOSL stays 1. Addresses and parity: ziteh/as5047p-driver, as5047p_set_zero and as5047p_send_data."""
    package, module = load("ams_encoders"), load("ams_encoders.as5047p")
    encoder = VirtualEncoder("AS5047P", registers={"zposl": bytes.fromhex("00 80")}, specs=[SPECS])
    words: list[int] = []
    bus = package.lookup("AS5047P").pipeline().bus(recorded(SpiLine(encoder), words))
    package.run(module.set_zero(0x9A, 0x15), bus)
    upper, lower = even(0x4016), even(0x4017)
    assert words == [upper, upper, 0x0016 | 0x8000, even(0x009A), lower, lower, even(0x0017), even(0x0095)]
    assert (encoder.memory.value("zposm"), encoder.memory.value("zposl")) == (0x009A, 0x0095)


def test_registers_at_the_next_address_are_not_confused(load: Callable[[str], Any]) -> None:
    """The bytes of two registers of two bytes at 16h and 17h do not overlap, and a wrong byte is found."""
    package, steps = load("ams_encoders"), load("codewheel_runtime.steps")
    encoder = VirtualEncoder("AS5047P", specs=[SPECS])
    bus = package.lookup("AS5047P").pipeline().bus(SpiLine(encoder).exchange)
    written = (
        *steps.write_whole("zposm", 0x16, bytes.fromhex("00 12")),
        *steps.write_whole("zposl", 0x17, bytes.fromhex("00 34")),
    )
    verified = [steps.Verify(address, 2, name, 0xFFFF, order="big") for address, name in ((0x16, "a"), (0x17, "b"))]
    package.run((*written, *verified), bus)

    def disturbed(address: int, data: bytes) -> None:
        bus.write(address, data if address == 0x17 else bytes.fromhex("00 02"))

    class Disturbed:
        read, write = staticmethod(bus.read), staticmethod(disturbed)

    with pytest.raises(package.StepError, match="register a at 16h holds 00 02, but 00 12 was written"):
        package.run((*written, *verified), Disturbed())
