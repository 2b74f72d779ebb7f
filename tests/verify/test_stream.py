"""More frames than fit into a table: two gigabytes by a command, and the README's Dask, DuckDB and polars."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from python_path import python_path
from stream import LIMIT, measured

#: The frame at the beginning of the README: 42 revolutions and 1821973 counts, and a frame with another CRC.
GOOD, DAMAGED, POSITION = 0x55BCD15E2, 0x55BCD15E3, 89902357
FILES, ROWS = 3, 500
#: Rows for the programs of the README at full size, in files of a million.
MANY_FILES, MANY_ROWS = 10, 1_000_000
ENGINES = ("dask", "duckdb", "polars")
#: The files that their programs in the README write. DuckDB prints its result.
WRITTEN = {"dask": "positions", "polars": "positions.parquet"}


def missing(name: str) -> None:
    """Skip the test without the engine. With ``CODEWHEEL_REQUIRE_TOOLS=1``, fail it."""
    words = f"no {name} here, so this is not shown; pip install '.[engines]'"
    if os.environ.get("CODEWHEEL_REQUIRE_TOOLS"):
        pytest.fail(words)
    pytest.skip(words)


@pytest.fixture
def captures(tmp_path: Path) -> Path:
    """A folder of captures, each with a damaged frame."""
    write_captures(tmp_path, FILES, ROWS, row_group_size=77)
    return tmp_path


def write_captures(folder: Path, files: int, rows: int, row_group_size: int) -> None:
    """Write Parquet files whose first frame is damaged."""
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    (folder / "captures").mkdir()
    for number in range(files):
        words = pyarrow.array([DAMAGED, *[GOOD] * (rows - 1)], pyarrow.uint64())
        table = pyarrow.table({"time": range(number * rows, (number + 1) * rows), "word": words})
        parquet.write_table(table, folder / "captures" / f"{number}.parquet", row_group_size=row_group_size)


def program(folder: Path, engine: str) -> str:
    """Return the code for an engine in the README of the package."""
    text = (folder / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    engine_blocks = [block for block in blocks if re.search(rf"^import {engine}\b", block, re.MULTILINE)]
    assert len(engine_blocks) == 1
    return engine_blocks[0]


@pytest.mark.parametrize("engine", ENGINES)
def test_the_readme_of_an_engine(generated_python: tuple[Path, ModuleType], captures: Path, engine: str) -> None:
    printed = output_of(engine, generated_python[0], captures)
    if engine == "duckdb":
        counts = re.findall(r"(\w+)\s+│\s+(\d+)", printed)
        assert counts == [("crc", str(FILES)), ("none", str(FILES * (ROWS - 1)))]
        return
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(captures / WRITTEN[engine])
    assert sorted(table["time"].to_pylist()) == [n for n in range(FILES * ROWS) if n % ROWS]
    assert set(table["position"].to_pylist()) == {POSITION}


def output_of(engine: str, folder: Path, captures: Path) -> str:
    """Run the README's program for an engine with two workers in the folder of the captures, and return its output."""
    try:
        __import__(engine)
    except ImportError:
        missing(engine)
    # Processes that an engine starts run this program again.
    (captures / "program.py").write_text(program(folder, engine), encoding="utf-8")
    workers = {"DASK_NUM_WORKERS": "2", "POLARS_MAX_THREADS": "2"}
    environment = {**os.environ, **workers, "PYTHONPATH": python_path(folder)}
    command = [sys.executable, "program.py"]
    completed = subprocess.run(command, cwd=captures, env=environment, capture_output=True, text=True)
    assert completed.returncode == 0, completed.stderr
    return completed.stdout


@pytest.mark.exhaustive
@pytest.mark.parametrize("engine", ENGINES)
def test_ten_million_rows(generated_python: tuple[Path, ModuleType], tmp_path: Path, engine: str) -> None:
    write_captures(tmp_path, MANY_FILES, MANY_ROWS, row_group_size=100_000)
    printed = output_of(engine, generated_python[0], tmp_path)
    valid_rows = MANY_FILES * (MANY_ROWS - 1)
    if engine == "duckdb":
        assert re.findall(r"(\w+)\s+│\s+(\d+)", printed) == [("crc", str(MANY_FILES)), ("none", str(valid_rows))]
        return
    import pyarrow.compute
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(tmp_path / WRITTEN[engine], columns=["position"])
    assert table.num_rows == valid_rows
    assert pyarrow.compute.unique(table["position"]).to_pylist() == [POSITION]


def test_partitions_in_other_processes(generated_python: tuple[Path, ModuleType], captures: Path) -> None:
    """The arguments of a partition reach another process, and errors come back."""
    try:
        __import__("dask")
    except ImportError:
        missing("dask")
    text = """
import dask.dataframe as dd
from lika_encoders import decode_partition, lookup

if __name__ == "__main__":
    captures = dd.read_parquet("captures/*.parquet")
    decoded = captures.map_partitions(decode_partition, lookup("AM3616/4096-I7").with_registers({0x56: 0x10}), "word")
    found = decoded.compute(scheduler="processes")
    print(found.fault.tolist().count("none"), *set(found.multiturn[found.fault == "none"]))
    texts = captures.assign(word="text")[["word"]]
    wrong = texts.map_partitions(decode_partition, "AMM5A21/65KSC1", meta=decoded._meta)
    try:
        wrong.compute(scheduler="processes")
    except ValueError as error:
        print(type(error).__name__, error)
"""
    (captures / "program.py").write_text(text, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": python_path(generated_python[0])}
    command = [sys.executable, "program.py"]
    completed = subprocess.run(command, cwd=captures, env=environment, capture_output=True, text=True)
    assert completed.returncode == 0, completed.stderr
    # With 16 bits for a revolution, the bits of the position above them are revolutions.
    sound, error, *_ = completed.stdout.splitlines()
    assert sound == f"{FILES * (ROWS - 1)} {POSITION >> 16}"
    assert error == "InputError the partition, column 'word': row 1: 'text' is not a hexadecimal number"


def test_two_gigabytes_in_two_hundred_megabytes(generated_python: tuple[Path, ModuleType], tmp_path: Path) -> None:
    done = measured(generated_python[0], tmp_path, 2_000_000_000, "AMM5A21/65KSC1")
    print(done)
    assert done.frames == 2_000_000_000 // 6
    assert done.peak_mb <= LIMIT, done
