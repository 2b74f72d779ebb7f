"""Columns of quantities: exact decimals next to the numbers, which stay as they are."""

from __future__ import annotations

import csv
import importlib
import sys
from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy
import pyarrow
import pyarrow.parquet
import pytest
from codewheel.commands.cli import main
from codewheel_runtime.commands.main import main as command

# Generates the package of another manufacturer, which no wording and no rule of check touches.
pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
CODE, LAYOUT, COLUMN = "OrbisSerial-14", "temperature_reply", "temperature (°C)"
#: Temperatures in the tests of smilerobotics/orbis_encoder, with the values that they expect. The position is valid.
EXPECTED = {0x0000: "0.0", 0x0064: "10.0", 0x010D: "26.9", 0x3039: "1234.5", 0xFF9C: "-10.0", 0xF554: "-273.2"}
FRAMES = b"".join(bytes((0x74, 0x00, 0x03)) + number.to_bytes(2, "big") for number in EXPECTED)
NUMBERS = [0, 100, 269, 12345, -100, -2732]


@pytest.fixture(scope="module")
def rls(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModuleType]:
    """The package with the Orbis."""
    folder = tmp_path_factory.mktemp("quantities")
    specs = [str(ROOT / "specs" / "rls")]
    assert main(["generate", *specs, "--target", "python", "-o", str(folder)]) == 0
    place = str(folder / "python")
    sys.path.insert(0, place)
    try:
        yield importlib.import_module("rls_encoders")
    finally:
        sys.path.remove(place)


def reply(rls: ModuleType) -> Any:
    return importlib.import_module(f"{rls.__name__}.orbis_serial").TemperatureReply


def test_a_frame_keeps_the_number_and_its_facts_have_the_scale(rls: ModuleType) -> None:
    frame = reply(rls).decode(FRAMES[10:15])
    assert (frame.temperature, type(frame.temperature)) == (269, int)
    facts = importlib.import_module(f"{rls.__name__}.facts.orbis_serial").FRAMES[LAYOUT]
    (scale,) = (facts_of_field.scale for facts_of_field in facts if facts_of_field.scale is not None)
    assert (scale.numerator, scale.denominator, scale.offset, scale.unit) == (1, 10, 0, "°C")
    assert str(scale.decimal(frame.temperature)) == "26.9"
    assert scale.source.startswith("smile: temperature")


def test_many_frames(rls: ModuleType) -> None:
    table = reply(rls).decode_many(FRAMES)
    assert table["temperature"].tolist() == NUMBERS
    assert table["temperature"].dtype == numpy.int64
    assert [str(decimal) for decimal in table[COLUMN]] == [*EXPECTED.values()]
    assert [*table.names][-4:] == ["temperature", COLUMN, "verdict", "fault"]
    assert table[2][COLUMN] == Decimal("26.9")
    assert [str(decimal) for decimal in table[1:3][COLUMN]] == ["10.0", "26.9"]
    # The quantity is not encoded.
    assert reply(rls).encode_many(table).tobytes() == FRAMES
    assert [*reply(rls).decode_many(b"")[COLUMN]] == []


def test_arrow_and_pandas(rls: ModuleType) -> None:
    table = reply(rls).decode_many(FRAMES)
    column = table.to_arrow()[COLUMN]
    assert column.type == pyarrow.decimal128(38, 1)
    assert column.to_pylist() == [Decimal(text) for text in EXPECTED.values()]
    pytest.importorskip("pandas")
    assert [str(decimal) for decimal in table.to_pandas()[COLUMN]] == [*EXPECTED.values()]


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_files(rls: ModuleType, tmp_path: Path, ending: str) -> None:
    source, target = tmp_path / "frames.bin", tmp_path / f"out.{ending}"
    source.write_bytes(FRAMES)
    rls.decode_file(CODE, source, target, layout=LAYOUT)
    if ending == "csv":
        with target.open(encoding="utf-8", newline="") as file:
            written_rows = [(row["temperature"], row[COLUMN]) for row in csv.DictReader(file)]
        assert written_rows == [*zip(map(str, NUMBERS), EXPECTED.values(), strict=True)]
    else:
        written_rows = pyarrow.parquet.read_table(target)
        assert written_rows["temperature"].to_pylist() == NUMBERS
        assert written_rows[COLUMN].to_pylist() == [Decimal(text) for text in EXPECTED.values()]


def test_the_command_writes_chosen_columns(rls: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "frames.bin"
    source.write_bytes(FRAMES[:10])
    assert command(rls.__name__, ["decode", CODE, str(source), "--layout", LAYOUT, "--columns", COLUMN]) == 0
    assert capsys.readouterr().out == f"{COLUMN}\n0.0\n10.0\n"
