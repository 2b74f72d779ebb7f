"""Columns are encoded like single frames. Values that one frame refuses are refused with their row."""

from __future__ import annotations

import pickle
import random
from typing import Any

import numpy
import pytest
from test_agreement import CASES_OF_FAMILIES, Case, Family, arguments_of, families, family
from test_many import by_layout, decoded_one_by_one, numbers

__all__ = ["families", "family"]
pytestmark = pytest.mark.slow

FRAMES = 1_000


def sound_columns(case: Case, source: random.Random) -> tuple[list[Any], list[Any], dict[str, Any]]:
    """Return valid frames that can be encoded again: as they are sent, as objects, and as columns."""
    sent_frames = [case.carried(number) for number in numbers(case, max(40, FRAMES // 10), source)]
    decoded_frames, _ = decoded_one_by_one(case, sent_frames)
    table = case.view.decode_many(sent_frames, *arguments_of(case))
    sound_rows = [row for row, frame in enumerate(decoded_frames) if frame is not None and can_be_encoded(frame)]
    columns = {name: table[name][sound_rows] for name in table.names}
    return [sent_frames[row] for row in sound_rows], [decoded_frames[row] for row in sound_rows], columns


def can_be_encoded(frame: Any) -> bool:
    """Text that is not ASCII is decoded with a mark, which is refused. So are some invalid numbers that are decoded."""
    try:
        frame.encode()
    except ValueError:
        return False
    return True


def frames_as_list(frames: Any) -> list[Any]:
    """Encode the frames one by one."""
    return [bytes(row) for row in frames] if frames.ndim == 2 else frames.tolist()


@pytest.mark.parametrize("family", CASES_OF_FAMILIES, indirect=True)
def test_columns_make_the_frames_they_come_from(family: Family) -> None:
    source = random.Random(family.device.name)
    for name, layout_cases in by_layout(family).items():
        for case in layout_cases:
            wire, _, columns = sound_columns(case, source)
            assert wire
            encoded = case.view.encode_many(columns, *arguments_of(case))
            assert frames_as_list(encoded) == wire, (case.variant.code, name)
            assert encoded.dtype == (numpy.uint8 if case.layout.in_bytes else numpy.uint64)
            for join in case.layout.joins:
                less = {key: value for key, value in columns.items() if key not in join.fields}
                assert frames_as_list(case.view.encode_many(less, *arguments_of(case))) == wire, (name, join.name)


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.parametrize("family", CASES_OF_FAMILIES, indirect=True)
def test_what_one_frame_refuses_columns_refuse(family: Family) -> None:
    source = random.Random(f"refusals {family.device.name}")
    refused = 0
    for layout_cases in by_layout(family).values():
        for case in layout_cases[:6]:
            _, frames, columns = sound_columns(case, source)
            field_columns = {name: columns[name] for name in type(frames[0])._fields if name in columns}
            for name, column in field_columns.items():
                for value in values_around(column):
                    row = source.randrange(len(frames))
                    refused += refuses_alike(case, frames[row]._replace(**{name: value}), field_columns, name, row)
    assert refused > 3


def values_around(column: Any) -> list[Any]:
    """Return values at and beyond the bounds of a field."""
    if column.dtype.kind == "S":
        length = column.dtype.itemsize
        return ["\u00e9" * length, "\u0100" * length, "x" * (length + 1), "x" * length]
    if column.dtype.kind == "b":
        return [True, False]
    return [-1, 0, 1, 2, 3, *(base + step for base in map((1).__lshift__, range(2, 63, 3)) for step in (-1, 0, 1))]


def refuses_alike(case: Case, frame: Any, columns: dict[str, Any], name: str, row: int) -> bool:
    """Return True if a frame is refused. Columns with it in a row must be refused too, or lead to the same frame."""
    column = columns[name]
    if column.dtype.kind == "S":
        column = numpy.char.decode(column, "latin-1")
    value = getattr(frame, name)
    kind = numpy.asarray(value).dtype if isinstance(value, str) else numpy.int64
    changed = column.astype(numpy.result_type(column.dtype, kind)) if column.dtype.kind != "b" else column.copy()
    if column.dtype == numpy.uint64:
        if value < 0:
            return False
        changed = column.copy()
    changed[row] = value
    given_columns = {**columns, name: changed}
    try:
        expected = frame.encode()
    except ValueError as error:
        alone: Any = error
        with pytest.raises(ValueError) as caught:
            case.view.encode_many(given_columns, *arguments_of(case))
        column_error: Any = caught.value
        assert type(alone).__name__ in {error_class.__name__ for error_class in type(column_error).__mro__}
        assert (column_error.row, column_error.value) == (row, alone.value), case.layout.name
        # A keyword of Python has another name in columns and attributes.
        assert column_error.field in (alone.field, f"{alone.field}_")
        return True
    encoded = frames_as_list(case.view.encode_many(given_columns, *arguments_of(case)))
    assert encoded[row] == expected, (case.layout.name, name, value)
    return False


def test_what_is_left_out(families: dict[str, Family]) -> None:
    """Flags and unused bits are optional, a single value applies to all rows, and an unknown name is an error."""
    amm5 = families["amm5"].module
    encoder = amm5.lookup("AMM5A21/65KSC1")
    words = encoder.encode_many({"position": numpy.array([89902357, 5]), "warning": True})
    frames = [amm5.SingleCycleData.from_position(encoder, at, error=False, warning=True) for at in (89902357, 5)]
    assert words.tolist() == [frame.encode() for frame in frames]
    for columns, message in (
        (
            {"position": [1], "speed": [2]},
            "^unknown columns: speed; the columns are .*, position$",
        ),
        ({"singleturn": [1]}, "^missing columns: multiturn; the columns are "),
        ({"position": [1.5]}, "column position has the type float64"),
        ({"position": ["1"]}, "column position has the type <U1"),
    ):
        with pytest.raises(TypeError, match=message):
            encoder.encode_many(columns)
    with pytest.raises(ValueError, match="2 rows"):
        encoder.encode_many({"singleturn": [1, 2], "multiturn": [1]})
    for nothing in (numpy.zeros(0, int), [], ()):
        assert encoder.encode_many({"position": nothing}).tolist() == []
    # A frame with an error has no values, and contradictory values are refused.
    with pytest.raises(ValueError, match=r"row 1: fault must be 0 \(a frame with an error has no values\), got 2"):
        encoder.encode_many(encoder.decode_many([frames[0].encode(), frames[0].encode() ^ 1]))
    with pytest.raises(ValueError, match="row 1: position must be equal to its fields, got 7"):
        encoder.encode_many({"position": [1, 7], "singleturn": [1, 8], "multiturn": [0, 0]})
    serial = amm5.lookup("AMM5A23/65KJP1")
    rows = serial.encode_many({"singleturn": [6016277], "data_id": amm5.DataId.SINGLETURN}, amm5.SingleturnReply)
    assert rows.tobytes() == bytes.fromhex("02 00 15 CD 5B 81")


@pytest.mark.parametrize("row", [0, 32_767, 32_768, 40_000])
def test_the_first_wrong_row_is_named(families: dict[str, Family], row: int) -> None:
    encoder = families["amm5"].module.lookup("AMM5A21/65KSC1")
    position = numpy.zeros(70_000, numpy.int64)
    position[row] = position[60_000] = 1 << 37
    with pytest.raises(ValueError) as caught:
        encoder.encode_many({"position": position})
    column_error: Any = pickle.loads(pickle.dumps(caught.value))
    assert (column_error.row, column_error.field, column_error.value) == (row, "position", 1 << 37)
    assert str(column_error) == str(caught.value) == f"row {row}: position must be 0 to {(1 << 37) - 1}, got {1 << 37}"
