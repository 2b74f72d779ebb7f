"""Arrays and columns of unusual types are read as what they are, or refused with one of our errors."""

from __future__ import annotations

from typing import Any

import numpy
import pyarrow
import pytest
from codewheel_runtime.bulk.decode import decode_many
from codewheel_runtime.bulk.encode import encode_many
from codewheel_runtime.bulk.shape import Column, FrameLayout
from codewheel_runtime.captures.any_biss import biss_layout

#: A frame of 64 bits has no bit left that could show a wrong number.
LAYOUT = biss_layout("position=64")
ROWS = FrameLayout(16, byte_count=2, columns=(Column("position", 0, 16, value_kind="number"),), position="position")
LENGTH = 1


def decoded(frames: Any) -> tuple[list[int], list[int]]:
    table = LAYOUT.decode_many(frames)
    return table.fault.tolist(), table.position.tolist()


@pytest.mark.parametrize(
    "frames",
    [
        [5, -1],
        numpy.array([5, -1]),
        numpy.array([5, -1], numpy.int8),
        numpy.array([5, -1], ">i4"),
        numpy.array([5, -1], object),
        numpy.ma.masked_array([5, 7], [False, True]),
        numpy.ma.masked_array(numpy.array([5, 7], object), [False, True]),
        pyarrow.array([5, -1]),
    ],
)
def test_a_negative_or_masked_number_is_not_a_frame(frames: Any) -> None:
    assert decoded(frames) == ([0, LENGTH], [5, 0])


def test_a_masked_float_is_not_a_frame() -> None:
    frames = numpy.ma.masked_array([5.0, 7.0, 7.5], [False, True, True])
    assert biss_layout("position=32").decode_many(frames).fault.tolist() == [0, LENGTH, LENGTH]


def test_a_row_with_masked_bytes_is_not_a_frame() -> None:
    rows = numpy.array([[1, 0], [2, 0], [3, 0]], numpy.uint8)
    masked_rows = numpy.ma.masked_array(rows, [[False, False], [True, True], [False, True]])
    table = decode_many(masked_rows, ROWS, None)
    assert table.fault.tolist() == [0, LENGTH, LENGTH]
    assert table["position"][0] == 1


def test_views_of_memory_are_arrays_of_their_items() -> None:
    numbers: Any = numpy.arange(16, dtype=numpy.int32)
    assert decoded(memoryview(numbers))[1] == [*range(16)]
    assert decoded(memoryview(numbers)[::3])[1] == [0, 3, 6, 9, 12, 15]
    assert decoded(memoryview(numbers.astype("<u8").tobytes()))[1] == [*range(16)]
    repeated_bytes: Any = numpy.repeat(numpy.array([5, 7], "<u8").view(numpy.uint8), 2)
    every_other_byte = memoryview(repeated_bytes)[::2]
    assert decoded(every_other_byte)[1] == [5, 7]
    assert decode_many(every_other_byte, ROWS, None)["position"].tolist() == [5, 0, 0, 0, 7, 0, 0, 0]
    with pytest.raises(TypeError, match="rows of 2 bytes"):
        decode_many(memoryview(numbers), ROWS, None)


def test_columns_of_polars() -> None:
    polars = pytest.importorskip("polars", reason="polars is not installed: its columns are not tried")
    assert decoded(polars.Series([5, -1])) == ([0, LENGTH], [5, 0])
    categories = polars.Series(["0x5", None, "0x7"], dtype=polars.Categorical)
    assert decoded(categories) == ([0, LENGTH, 0], [5, 0, 7])
    with pytest.raises(TypeError, match="convert it to 64-bit integers, bytes or text"):
        decoded(polars.Series([5], dtype=polars.Int128))


def test_an_array_without_dimensions_is_not_a_row_of_frames() -> None:
    with pytest.raises(TypeError, match="frames must be numbers or packed bytes, got int"):
        decoded(numpy.array(5, object))


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"position": numpy.ma.masked_array([5, 6], [False, True])}, "position has masked values"),
        ({"position": [[1], [1, 2]]}, "position is not a row of values: its cells have different shapes"),
        ({"position": [5], 5: [5], "x": [5]}, "unknown columns: 5, x; the columns are position"),
        ({"position": [5.0]}, "float64, which does not fit the field: convert it to integers"),
        ({"position": [1.0, numpy.nan]}, "position has missing values, which no frame can contain"),
        ({"position": numpy.array([1, None])}, "position has missing values, which no frame can contain"),
        ({"position": numpy.array([5], object)}, "object, which does not fit the field: convert it to integers"),
    ],
)
def test_columns_that_cannot_be_encoded(columns: Any, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        encode_many(columns, LAYOUT.layout)


def test_encode_rejects_columns_of_two_dimensions() -> None:
    with pytest.raises(ValueError, match="expected one value per row"):
        encode_many({"position": [[1, 2]]}, LAYOUT.layout)


def test_masked_columns_without_masked_values_are_encoded() -> None:
    position = LAYOUT.decode_many([5, 7]).usable_position
    assert encode_many({"position": position}, LAYOUT.layout).tolist() == [5, 7]
