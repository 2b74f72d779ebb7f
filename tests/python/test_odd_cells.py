"""Times that are not finite numbers never become a speed, and an Arrow file is not a file of frames."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import numpy
import pyarrow
import pytest
from codewheel_runtime.bulk.table import Table
from codewheel_runtime.captures.any_biss import biss_layout
from codewheel_runtime.errors import InputError
from codewheel_runtime.files.inputs import read_seconds
from pyarrow import feather

LAYOUT = biss_layout("singleturn=17")


@pytest.mark.parametrize("cell", ["inf", "-inf", "1e999", "1_0", True, float("inf"), "x"])
def test_times_are_finite_numbers(cell: Any) -> None:
    with pytest.raises(InputError, match="column 'time': expected numbers in seconds"):
        read_seconds([1.0, cell], "file.csv")
    assert read_seconds(["1.5", "", None], "file.csv")[0] == 1.5


def frames() -> Table:
    return LAYOUT.decode_many([0, 10, 20])


@pytest.mark.parametrize("kind", ["u1", "u8", ">u4", "i2", "f4", object])
def test_times_of_any_number_type(kind: Any) -> None:
    """Where the clock is set back, there is no speed, although unsigned differences wrap around."""
    speeds = frames().velocity(numpy.array([5, 3, 4], kind))
    assert numpy.isnan(speeds[:2]).all()
    assert speeds[2] == 10


def test_no_speed_between_infinite_times() -> None:
    assert numpy.isnan(frames().velocity([0.0, numpy.inf, 1.0])).all()
    assert numpy.isnan(frames().velocity([-numpy.inf, 0.0, 1.0])[1])


@pytest.mark.parametrize(
    ("times", "message"),
    [
        (numpy.array([1, 2, 3], "M8[s]"), r"times must be numbers in seconds, got an array of datetime64\[s\]"),
        (["1", "2", "3"], "times must be numbers in seconds, got an array of"),
        ([object(), 1, 2], "times must be numbers in seconds"),
        ([True, False, True], "got an array of bool"),
        ("1", "times must be numbers in seconds"),
        (numpy.inf, "must be above 0 s, got inf"),
        (numpy.nan, "must be above 0 s, got nan"),
        ([[1, 2, 3]], r"expected one time per frame, got an array of the shape \(1, 3\)"),
    ],
)
def test_times_that_are_not_seconds(times: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        frames().velocity(times)


def test_an_arrow_file_is_not_a_file_of_frames(generated_python: tuple[Path, ModuleType], tmp_path: Path) -> None:
    _, package = generated_python
    path = tmp_path / "frames.arrow"
    feather.write_feather(pyarrow.table({"frame": [5]}), path, compression="uncompressed")
    with pytest.raises(InputError, match="Arrow files cannot be decoded: save the table as Parquet"):
        package.decode_file(package.lookup("AMM5A17/1BG1"), path, tmp_path / "out.csv", cut=True)
