"""A table is a sequence of frames with columns by name, and its errors name a way out. Decoders are bound at once."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
import threading
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from python_path import python_path

CODE = "AMM5A21/65KSC1"
GOOD, SPOILT, POSITION = 0x55BCD15E2, 0x55BCD1564, 89902357
COLUMNS = ["singleturn", "multiturn", "error", "warning", "position", "verdict", "fault"]


@pytest.fixture
def lika(generated_python: tuple[Path, ModuleType]) -> Any:
    return generated_python[1]


def test_rows_and_columns(lika: Any) -> None:
    table = lika.lookup(CODE).decode_many([GOOD, GOOD ^ 1, SPOILT])
    assert len(table) == table.count == 3
    assert [row["position"] for row in table] == [POSITION, None, None]
    assert [table[index] for index in range(len(table))] == [*table] == [*table.rows()]
    assert table[-1] == table[2]
    for index in (3, -4):
        with pytest.raises(IndexError, match=f"no row {index}; the table has 3"):
            table[index]
    for not_a_row in (True, 1.0, [0, 1], table.ok):
        with pytest.raises(TypeError, match="the row must be an integer, got "):
            table[not_a_row]
    assert len(table[1:]) == 2
    assert [*table.columns] == [*table.names] == COLUMNS
    assert all((table.columns[name] == table[name]).all() for name in COLUMNS)
    assert "verdict" in table
    assert "time" not in table
    assert [*table.with_columns(time=[1, 2, 3]).columns] == ["time", *COLUMNS]
    assert not len(table[:0])


def test_frames_are_found_by_their_values(lika: Any) -> None:
    table = lika.lookup(CODE).decode_many([GOOD, GOOD ^ 1, SPOILT])
    for index, row in enumerate(table):
        assert row in table
        assert table.index(row) == index
        assert row not in table[index + 1 :]
    for other in ({**table[0], "position": 5}, {}, {"position": POSITION}, POSITION, None):
        assert other not in table
    with pytest.raises(ValueError, match=r"^the table has no frame with these values$"):
        table.index({**table[0], "position": 5})
    with pytest.raises(TypeError, match="expected a dictionary with the values of a frame, got int"):
        table.index(3)
    # The first speed is NaN, which differs from itself.
    with_speeds = table.with_columns(time=[1, 2, 3]).in_si()
    assert [with_speeds.index(row) for row in with_speeds] == [0, 1, 2]


def test_slices_have_any_step(lika: Any) -> None:
    table = lika.lookup(CODE).decode_many([GOOD, GOOD ^ 1, SPOILT]).with_columns(time=[1, 2, 3])
    rows = [*table]
    assert [*reversed(table)] == rows[::-1]
    for rows_taken in (slice(None, None, -1), slice(2, 0, -1), slice(None, None, 2), slice(-1, None), slice(5, 9)):
        assert [*table[rows_taken]] == rows[rows_taken]
    assert table[::-1].in_units("degrees")[2] == table.in_units("degrees")[0]
    with pytest.raises(ValueError, match="slice step cannot be zero"):
        table[::0]


def test_tables_with_the_same_frames_are_equal(lika: Any) -> None:
    encoder = lika.lookup(CODE)
    words = [GOOD, GOOD ^ 1, SPOILT]
    table = encoder.decode_many(words)
    assert table == encoder.decode_many(words) == table[::-1][::-1] == pickle.loads(pickle.dumps(table))
    timed_table = table.with_columns(time=[1, 2, 3]).in_si()
    assert timed_table == table.with_columns(time=[1, 2, 3]).in_si()
    # The bits of an invalid frame count, although its position is None in both tables.
    other_bits = encoder.decode_many([GOOD, GOOD ^ 1 << 30 ^ 1, SPOILT])
    others = (other_bits, table[::-1], table[:2], timed_table, timed_table[::-1], [*table], None, CODE)
    assert not [other for other in others if table == other]
    assert table != lika.lookup("AMM5B21/65KSC1").decode_many(words)
    layout = lika.biss_layout("multiturn=16,singleturn=21,error,warning,crc=6:0x43")
    assert layout == lika.biss_layout(layout.text) == copy.deepcopy(layout)
    assert {layout: 1}[copy.copy(layout)] == 1
    assert layout.decode_many(words) == copy.deepcopy(layout.decode_many(words))


def test_a_table_can_be_sent_to_another_process(lika: Any) -> None:
    """Also a table with other columns, and a table of a layout without a package."""
    layout = lika.biss_layout("multiturn=16,singleturn=21,error,warning,crc=6:0x43")
    for encoder in (lika.lookup(CODE), layout):
        decoded = encoder.decode_many([GOOD, SPOILT])
        for table in (decoded, decoded.with_columns(time=[1, 2])):
            for copied in (pickle.loads(pickle.dumps(table)), copy.deepcopy(table)):
                assert [*copied] == [*table]
                # The position is 42 revolutions and 1821973 of 2^21 counts.
                assert copied.in_units("degrees")[0] == 1821973 * 360 / 2**21


def test_a_table_encodes(lika: Any) -> None:
    encoder = lika.lookup(CODE)
    table = encoder.decode_many([GOOD, SPOILT]).with_columns(time=[1, 2])
    assert encoder.encode_many(table).tolist() == [GOOD, SPOILT]
    assert encoder.encode_many(encoder.decode_many([GOOD]).columns).tolist() == [GOOD]


def test_columns_for_polars(lika: Any) -> None:
    polars = pytest.importorskip("polars")
    table = lika.lookup(CODE).decode_many([GOOD, GOOD ^ 1])
    assert polars.DataFrame(table.columns)["multiturn"].to_list() == [42, 42]
    assert polars.DataFrame(table)["position"].to_list() == [POSITION, None]


def test_errors_name_a_way_out(lika: Any) -> None:
    rotary, linear = lika.lookup(CODE), lika.lookup("SMA21-SC1-0050")
    with pytest.raises(KeyError) as caught:
        rotary.decode_many([GOOD])["positon"]
    assert caught.value.args == (
        f"no column 'positon'; the columns are {', '.join(COLUMNS)}; did you mean 'position'?",
    )
    message = r" measures angles, not lengths: use counts, turns, degrees, radians instead of millimetres$"
    with pytest.raises(ValueError, match=message):
        rotary.decode_many([GOOD]).in_units("millimetres")
    message = r" measures lengths, not angles: use counts, micrometres, millimetres, metres instead of degrees$"
    with pytest.raises(ValueError, match=message):
        linear.decode_many([]).in_units("degrees")


@pytest.mark.slow
@pytest.mark.parametrize("call", ["e.decode_many([5])", "e.encode_many({})", "lika_encoders.read_capture(e, 'x')"])
def test_numpy_is_named_if_it_is_missing(generated_python: tuple[Path, ModuleType], tmp_path: Path, call: str) -> None:
    (tmp_path / "numpy.py").write_text("raise ModuleNotFoundError(name='numpy')")
    program = f"import lika_encoders\ne = lika_encoders.lookup('{CODE}')\nprint(e.decode({GOOD}).position)\n{call}\n"
    (tmp_path / "program.py").write_text(program)
    command = [sys.executable, "program.py"]
    environment = {"PYTHONPATH": python_path(generated_python[0])}
    completed = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert completed.stdout == f"{POSITION}\n"
    assert completed.stderr.splitlines()[-1] == "ModuleNotFoundError: this needs numpy: pip install numpy"


def test_decoders_are_bound_however_they_are_reached(lika: Any) -> None:
    """In a variable that is set before the first call, in map, and in another thread."""
    for name in ("decode", "try_decode"):
        fresh = lika.lookup(f"{CODE}-{name}")
        before = getattr(fresh, name)
        assert [frame.position for frame in map(before, [GOOD, GOOD])] == [POSITION, POSITION]
        reached: list[Any] = []
        thread = threading.Thread(target=lambda: reached.append(getattr(fresh, name)))  # noqa: B023
        thread.start()
        thread.join()
        assert reached == [before] == [getattr(fresh, name)]
        assert before.__doc__ == getattr(type(fresh), name).__doc__
