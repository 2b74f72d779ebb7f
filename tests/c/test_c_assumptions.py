"""The page on assumptions of use lists each frame with a CRC, and the errors that the CRC misses."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c.files import generate

ENCODERS = Path(__file__).parents[2] / "specs"


def rows(page: str) -> list[list[str]]:
    table = [line for line in page.splitlines() if line.startswith("|")]
    rows_of_cells = [line.strip("|").split("|") for line in table[2:]]
    return [[*map(str.strip, cells)] for cells in rows_of_cells]


def page_of_ams(*names: str) -> str:
    devices, report = load_library([ENCODERS / "ams" / name for name in names])
    assert not report
    return generate(Library(devices))["c/ASSUMPTIONS-ams.md"]


@pytest.mark.slow
def test_each_length_of_each_frame(c_devices: tuple[Device, ...]) -> None:
    """AMM5 6.2.1: 47, 45, ... bits with 6 bits of CRC; 7.5: replies of 6 and 11 bytes with the XOR of the bytes."""
    page = generate(Library(c_devices))["c/ASSUMPTIONS-lika.md"]
    row_by_frame = {(row[0], int(row[1])): row for row in rows(page)}
    assert {bits for poly, bits in row_by_frame if poly == "x^6 + x + 1"} >= {25, 44, 45, 47}
    for bits in (25, 47):
        row = row_by_frame["x^6 + x + 1", bits]
        assert "AMM5 BiSS C-mode: single cycle data" in row[2]
        assert row[3] == "3"
    # Two wrong bits at the same position in two of eleven bytes.
    assert row_by_frame["x^8 + 1", 88][2:] == [
        "AMM5 RS-485: complete reply",
        "2",
        f"{8 * 11 * 10 // 2} of {88 * 87 // 2}",
    ]


@pytest.mark.slow
def test_frames_without_status(c_devices: tuple[Device, ...]) -> None:
    page = generate(Library(c_devices))["c/ASSUMPTIONS-lika.md"]
    (line,) = (line for line in page.splitlines() if "always `CW_UNKNOWN`" in line)
    assert "AM36 SSI: SSI word, AMM5 SSI: SSI word, ASC85 SSI: SSI word." in line


@pytest.mark.slow
def test_words_with_parity() -> None:
    """The AS5047P has a parity bit, no CRC and no SSI: jonas-merkle/AS5047P, SPI_ReadData_Frame_t."""
    page = page_of_ams("manufacturer.yaml", "as5047p.yaml")
    assert "No frame has a CRC." in page
    (line,) = (line for line in page.splitlines() if line.startswith("- A parity bit does not detect two wrong bits"))
    assert "AS5047P SPI: position" in line
    assert "SSI" not in page


@pytest.mark.slow
def test_words_with_parity_of_two_interfaces() -> None:
    """The AS5145 has a parity bit too, in a word over SSI."""
    page = page_of_ams("manufacturer.yaml", "as5047p.yaml", "as5145.yaml")
    (parity,) = (line for line in page.splitlines() if line.startswith("- A parity bit does not detect two wrong bits"))
    assert "AS5047P SPI: position, AS5145 SSI: SSI word." in parity
    (no_crc,) = (line for line in page.splitlines() if line.startswith("- These SSI words have no CRC"))
    assert "AS5145 SSI: SSI word." in no_crc


@pytest.mark.slow
def test_a_page_for_each_manufacturer(every_device: dict[str, Device]) -> None:
    files = generate(Library((every_device["amm5"], every_device["tv62"])))
    maker = every_device["tv62"].manufacturer.name
    assert {name for name in files if "ASSUMPTIONS" in name} == {
        "c/ASSUMPTIONS-lika.md",
        f"c/ASSUMPTIONS-{maker}.md",
    }
    assert "AMM5" not in files[f"c/ASSUMPTIONS-{maker}.md"]
