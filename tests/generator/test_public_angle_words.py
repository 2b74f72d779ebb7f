"""All words of the AS5055A and the MA730, against the masks of public drivers and the words of data sheets.

AS5055A: Tasssadar/as5055_test at commit d7aa890, as5055_test.c (``set_ang``), masks EF with 2, shifts by 2, masks the
angle with (1 << 12) - 1 and the alarms with 1 << 12 and 1 << 13. Chr157i4n/AS5055A_Raspberry_Pi at commit d3eec77,
AS5055A_Encoder.py (``getAngle_bits``), takes a word only if its number of ones is even, masks EF with 1 << 1 and the
alarms with 1 << 15 and 1 << 14, and the angle with 0x3FFF before a shift by 2.

MA730: simplefoc/Arduino-FOC-drivers at commit f7a91fa, src/encoders/ma730/MA730.cpp (``readRawAngle``, 65536 counts),
and SKA-Robotics/DriverFirmware at commit c70e5c2, src/ma730_driver.c, take the word as it is. Its two bytes are sent
high byte first. DimashMuratbek/MA730_angular_sensor at commit e85813c shifts it right by 2 for 14 bits.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library

pytestmark = pytest.mark.slow

SPECS = Path(__file__).resolve().parents[2] / "specs"
Importer = Callable[[Library, str], tuple[Path, ModuleType]]


def encoder_of(import_generated: Importer, manufacturer: str, family: str, order_code: str) -> Any:
    devices, report = load_library(
        [SPECS / manufacturer / f"{family}.yaml", SPECS / manufacturer / "manufacturer.yaml"]
    )
    assert not report
    _, module = import_generated(Library(tuple(devices)), f"{manufacturer}_encoders")
    return module.lookup(order_code)


@pytest.mark.parametrize("order_code", ["AS5055", "AS5055A"])
def test_every_word_of_the_as5055a(import_generated: Importer, order_code: str) -> None:
    np: Any = pytest.importorskip("numpy")
    encoder = encoder_of(import_generated, "ams", "as5055a", order_code)
    words = np.arange(1 << 16, dtype=np.uint64)
    table = encoder.decode_many(words)
    ones = sum(words >> np.uint64(place) & np.uint64(1) for place in range(16))
    is_even = ones % np.uint64(2) == 0
    assert (table.ok == is_even).all()
    assert int(table.ok.sum()) == 32_768
    valid = words[is_even]
    columns = {name: table[name][is_even] for name in ("position", "alarm_high", "alarm_low", "error")}
    assert (columns["position"] == (valid >> np.uint64(2)) % np.uint64(1 << 12)).all()
    assert (columns["position"] == (valid & np.uint64(0x3FFF)) >> np.uint64(2)).all()
    is_high, is_low = valid & np.uint64(1 << 15) != 0, valid & np.uint64(1 << 14) != 0
    is_error = valid & np.uint64(2) != 0
    assert (columns["alarm_high"] == is_high).all()
    assert (columns["alarm_low"] == is_low).all()
    assert (columns["error"] == is_error).all()
    # AS5050 data sheet, 7.2.6: one alarm is a limit of the gain, and both together are an error.
    is_unusable = is_error | (is_high & is_low)
    has_warning = is_high | is_low
    expected = np.where(is_unusable, "not_usable", np.where(has_warning, "usable_with_warning", "usable"))
    step = 1021
    names = [encoder.decode(int(word)).verdict.value for word in valid[::step]]
    assert names == expected[::step].tolist()
    numbers = {name: set(table.verdict[is_even][expected == name].tolist()) for name in set(expected.tolist())}
    assert sorted(numbers) == ["not_usable", "usable", "usable_with_warning"]
    assert [len(found) for found in numbers.values()] == [1, 1, 1]
    assert len(set.union(*numbers.values())) == 3


def test_every_word_of_the_ma730(import_generated: Importer) -> None:
    np: Any = pytest.importorskip("numpy")
    encoder = encoder_of(import_generated, "mps", "ma730", "MA730")
    words = np.arange(1 << 16, dtype=np.uint64)
    table = encoder.decode_many(words)
    assert table.ok.all()
    high_byte, low_byte = words >> np.uint64(8), words % np.uint64(256)
    assert (table["position"] == high_byte * np.uint64(256) + low_byte).all()
    for word in (0, 1, 3, 4, 0x8000, 0xFFFF):
        frame = encoder.decode(word)
        assert frame.position >> 2 == word >> 2 & 0x3FFF
        assert frame.verdict.value == "unknown"


def test_requests_of_the_as5055a(import_generated: Importer) -> None:
    """The driver computes its commands as ((1 << 15) | (address << 1) | 1) ^ 1, or with 0 for the angle."""
    _ = encoder_of(import_generated, "ams", "as5055a", "AS5055A")
    from ams_encoders import as5055a  # type: ignore[import-not-found]

    commands = {0x3FF8: ((1 << 15) | (0x3FF8 << 1) | 1) ^ 1, 0x3380: ((1 << 15) | (0x3380 << 1) | 1) ^ 1}
    assert commands == {0x3FF8: 0xFFF0, 0x3380: 0xE700}
    for address, command in commands.items():
        assert int(as5055a.ReadRequest(address=address).encode()) == command
