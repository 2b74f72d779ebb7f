"""One frame of each interface in C, compiled without optimisation: all that ``make quick`` tests of the headers.

BiSS: the word in the README, and the same position with the bits nE = 0 and nW = 1. The CRC is computed here: its
polynomial is x^6 + x + 1, and it is sent inverted (AMM5 6.2.1). SSI: position 100,003 in Gray code, which is the
number and the half of it under exclusive or (AM36 5.2). RS-485: request 02 of data ID 0 (AMM5 7.4.2), and a public
reply, whose bytes are little-endian, so 7,000,519 = 6AD1C7h. SPI: words of public drivers of the AS5047P (simplefoc,
AS5047.cpp).
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from c_harness import devices_of, write
from working_tools import require

ROOT = Path(__file__).resolve().parents[2]
AMS = ROOT / "specs" / "ams"
#: An encoder with SSI sends neither an error bit nor a CRC, so the verdict is unknown (AM36 5.2).
NOT_USABLE, UNKNOWN, USABLE = 0, 1, 3
WRONG_CRC, WRONG_CONSTANT = 2, 3
POSITION, GRAY_POSITION = 1_000_003, 100_003
#: Forms of the CRCs: folded, as the default, and bit by bit, with the start value in the loop.
FORMS = [[], ["-DLIKA_CRC_BITWISE"], ["-DLIKA_CRC_TABLE"]]


def biss_word(error: int, warning: int) -> int:
    """Return the word with these levels of nE and nW."""
    data = POSITION << 2 | error << 1 | warning
    remainder = 0
    for place in reversed(range(39)):
        feedback = (data >> place & 1) ^ remainder >> 5
        remainder = (remainder << 1 & 0x3F) ^ 0x03 * feedback
    return data << 6 | remainder ^ 0x3F


@pytest.fixture(scope="module")
def every_header(include: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Return the include folders of our families and of an encoder with SPI."""
    as5047p = devices_of(AMS / "as5047p.yaml", AMS / "manufacturer.yaml")
    return [include, write(tmp_path_factory.mktemp("spi"), as5047p)]


@pytest.mark.starts_process
@pytest.mark.parametrize("form", FORMS, ids=" ".join)
def test_one_frame_of_each_interface(form: list[str], every_header: list[Path], tmp_path: Path) -> None:
    program = tmp_path / "round_trip"
    folders = [f"-I{folder}" for folder in every_header]
    source = str(Path(__file__).with_name("round_trip.c"))
    command = [require(["gcc"]), "-std=c99", "-O0", "-Wall", "-Wextra", "-Werror", *form, *folders, source]
    subprocess.run([*command, "-o", str(program)], check=True)
    printed = subprocess.run([str(program)], capture_output=True, text=True, check=False).stdout
    assert (biss_word(1, 1), f"{biss_word(0, 1):X}") == (0xF4243D3, "F424355")
    assert (0x7FFC).bit_count() % 2 == (0x1234).bit_count() % 2 == 1, "so bit 15 is 1 in both words over SPI"
    assert printed.splitlines() == [
        f"biss {USABLE} {POSITION} {WRONG_CRC} F4243D3",
        f"biss {NOT_USABLE} 0 {WRONG_CRC} F424355",
        f"ssi {UNKNOWN} {GRAY_POSITION} {GRAY_POSITION >> 16} {GRAY_POSITION ^ GRAY_POSITION >> 1:X}",
        f"rs485 02 {WRONG_CRC} {NOT_USABLE} 7000519 0220C7D16A5E",
        f"spi FFFC FFFF {WRONG_CONSTANT} {0x1234} {USABLE} 9234 1 {0x80}",
    ]
