"""Registers over SPI in Python: the words that are sent, and the bytes of the value. ``make quick`` runs this.

The words come from public drivers of the AS5047P (simplefoc, AS5047.cpp). Bit 15 makes the number of 1 bits even, and a
reply comes with the next word. DIAAGC has the gain in bits 7:0 and LF in bit 8. SETTINGS1 has 8 bits.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library

AMS = Path(__file__).resolve().parents[2] / "specs" / "ams"


def even(word: int) -> int:
    """Return the word with bit 15 such that the number of 1 bits is even."""
    return word | (word.bit_count() & 1) << 15


@pytest.fixture(scope="module")
def as5047p(import_generated: Callable[[Library, str], tuple[Path, ModuleType]]) -> tuple[Any, Any]:
    """Return an encoder, and the module of its family."""
    devices, report = load_library([AMS / "as5047p.yaml", AMS / "manufacturer.yaml"])
    assert not report
    _, package = import_generated(Library(devices), "ams_encoders")
    return package.lookup("AS5047P"), package.as5047p


def test_a_register_of_two_bytes_is_read(as5047p: tuple[Any, Any]) -> None:
    encoder, module = as5047p
    line = encoder.pipeline()
    assert line.read(module.Diaagc) == 0xFFFC
    assert line.take(0) is None
    assert line.read(module.Diaagc) == 0xFFFC
    register = line.take(even(0x0180)).register
    assert (register.agc, register.offset_loop, register.mag_low) == (0x80, True, False)


def test_a_bus_reads_and_writes_the_most_significant_byte_first(as5047p: tuple[Any, Any]) -> None:
    encoder, _ = as5047p
    words: list[int] = []

    def exchange(word: int) -> int:
        words.append(word)
        return even(0x0180)

    bus = encoder.pipeline().bus(exchange)
    assert bus.read(0x3FFC, 2) == bytes.fromhex("01 80")
    bus.write(0x0018, bytes.fromhex("00 81"))
    assert words == [0xFFFC, 0xFFFC, 0x0018, even(0x0081)]
