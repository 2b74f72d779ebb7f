"""Tables of frames with time: rows, slices, units, and the stream of Arrow."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy
import pytest

GOOD, WRONG, SPOILT = 0x55BCD15E2, 0x55BCD15E3, 0x55BCD1564
#: 42 revolutions and 1821973 of 2^21 counts, from the manual's page.
POSITION = 42 * (1 << 21) + 1821973


@pytest.fixture
def lika(generated_python: Any) -> Any:
    return generated_python[1]


@pytest.fixture
def table(lika: Any) -> Any:
    plain_table = lika.lookup("AMM5A21/65KSC1").decode_many([GOOD, WRONG, SPOILT, GOOD])
    return plain_table.with_columns(time=numpy.array([0.0, 0.1, 0.2, 0.5]), note=["a", "b", "c", "d"])


def test_rows_and_slices(lika: Any, table: Any) -> None:
    assert [*table.names][:2] == ["time", "note"]
    rows = [*table.rows()]
    assert [row["position"] for row in rows] == [POSITION, None, None, POSITION]
    assert [row["fault"] for row in rows] == [lika.ErrorKind(number) for number in (0, 2, 0, 0)]
    assert [row["verdict"].value for row in rows] == ["usable", "not_usable", "not_usable", "usable"]
    assert all(isinstance(row["verdict"], lika.Verdict) for row in rows)
    assert table[-1] == rows[3]
    assert isinstance(table, lika.Table)
    part = table[1:3]
    assert (part.count, part["note"], part["time"].tolist()) == (2, ["b", "c"], [0.1, 0.2])
    assert [*part.rows()] == rows[1:3]
    with pytest.raises(IndexError):
        table[4]


def test_columns_of_another_length_or_name_are_refused(table: Any) -> None:
    with pytest.raises(ValueError, match=r"^expected 4 values in 'time', one per frame, got 1$"):
        table.with_columns(time=[1.0])
    with pytest.raises(ValueError, match=r"^the frames already have a column 'fault'$"):
        table.with_columns(fault=[0] * 4)
    with pytest.raises(TypeError, match=r"^'time' must have a value for every frame, got 1.5$"):
        table.with_columns(time=1.5)


def test_speeds_in_every_unit(lika: Any) -> None:
    encoder = lika.lookup("AMM5A21/65KSC1")
    turn = 1 << 21
    words = encoder.encode_many({"position": [0, turn // 4, turn // 2]})
    table = encoder.decode_many(words).with_columns(time=[0.0, 0.5, 1.5])
    assert table.velocity(unit="rpm")[1:].tolist() == pytest.approx([30, 15])
    assert table.velocity(unit="turns")[1:].tolist() == pytest.approx([0.5, 0.25])
    si = table.in_si()
    assert si["radians"].tolist() == pytest.approx([0, math.pi / 2, math.pi])
    assert si["radians_per_second"][1:].tolist() == pytest.approx([math.pi, math.pi / 2])
    linear = lika.lookup("SMA21-SC1-0050")
    si = linear.decode_many(linear.encode_many({"position": [0, 20]})).with_columns(time=[0.0, 0.5]).in_si()
    # 50 µm per count.
    assert si["metres"].tolist() == pytest.approx([0, 0.001])
    assert si["metres_per_second"][1] == pytest.approx(0.002)
    with pytest.raises(ValueError, match="'rpm' is not a unit of positions; it is a unit of speed"):
        table.in_units("rpm")
    with pytest.raises(ValueError, match="the table has no column 'time'"):
        encoder.decode_many(words).velocity()


def test_speeds_without_a_time_that_passes(lika: Any) -> None:
    """The clock of a log can stand still or be set back. A frame every 0 s is a mistake."""
    encoder = lika.lookup("AMM5A21/65KSC1")
    table = encoder.decode_many(encoder.encode_many({"position": [0, 100, 200, 300, 400]}))
    speeds = table.with_columns(time=[0.0, 0.0, 1.0, 0.5, 1.5]).velocity()
    assert speeds.tolist() == pytest.approx([math.nan, math.nan, 100, math.nan, 100], nan_ok=True)
    for seconds in (0, -0.1, math.nan):
        with pytest.raises(ValueError, match=r"^the time between two frames must be above 0 s, got "):
            table.velocity(seconds)


def test_other_libraries_read_the_stream(table: Any) -> None:
    pa = pytest.importorskip("pyarrow", reason="pyarrow is not installed: streams of Arrow are not tried")
    arrow_table = pa.table(table)
    assert arrow_table.column("position").to_pylist() == [POSITION, None, None, POSITION]
    assert arrow_table.column("note").to_pylist() == ["a", "b", "c", "d"]
    assert arrow_table.column("fault").to_pylist() == ["none", "crc", "none", "none"]
    assert pa.table(table.in_si()).column("radians").null_count == 2


def test_polars_reads_and_gives_the_stream(lika: Any, table: Any) -> None:
    pl = pytest.importorskip("polars", reason="polars is not installed: its frames are not tried")
    assert pl.DataFrame(table)["position"].to_list() == [POSITION, None, None, POSITION]
    encoder = lika.lookup("AMM5A21/65KSC1")
    assert encoder.decode_many(pl.Series([GOOD, WRONG, None])).fault.tolist() == [0, 2, 1]
    frame = pl.DataFrame({"time": [1, 2], "word": [GOOD, WRONG]})
    polars_frame = pl.DataFrame(lika.decode_partition(frame, encoder, "word"))
    assert polars_frame.select("time", "position").rows() == [(1, POSITION), (2, None)]
    texts = pl.DataFrame({"time": [1, 2], "word": [hex(GOOD), None]})
    polars_frame = pl.DataFrame(lika.decode_partition(texts, encoder, "word"))
    assert polars_frame.select("position", "fault").rows() == [(POSITION, "none"), (None, "length")]
    rows = pl.Series([bytes.fromhex("02 00 C7 D1 6A 7E")])
    amm5 = lika.amm5
    assert amm5.SingleturnReply.decode_many(rows, lika.lookup("AMM5A23/65KJP1"))["singleturn"].tolist() == [7000519]


@pytest.mark.slow
def test_duckdb_reads_and_gives_the_stream(lika: Any, table: Any) -> None:
    duckdb = pytest.importorskip("duckdb", reason="duckdb is not installed: its relations are not tried")
    connection = duckdb.connect()
    connection.register("frames", table.to_arrow())
    counted = connection.sql(
        "select fault, count(*), max(position) from frames group by fault order by fault"
    ).fetchall()
    assert counted == [("crc", 1, None), ("none", 3, POSITION)]
    relation = connection.sql(f"select 7 as time, {GOOD} as word")
    assert lika.decode_partition(relation, "AMM5A21/65KSC1", "word").column("position").to_pylist() == [POSITION]


# Encoders from a configuration file


def test_encoders_of_every_interface_have_the_same_members(lika: Any) -> None:
    for label in ("AMM5A21/65KSC1", "AMM5A23/65KBG1", "SMA21-SC1-0050"):
        encoder: Any = lika.lookup(label)
        frame = encoder.encode_many({"position": [7]}).tolist()[0]
        decoded = encoder.try_decode(frame)
        assert isinstance(decoded, lika.PositionFrame)
        assert encoder.unwrap(decoded.position, decoded.position) == decoded.position
        assert encoder.decode_many([frame]).position.tolist() == [decoded.position]
        assert encoder.frame_bits >= 20
    serial = lika.lookup("AMM5A23/65KJP1")
    assert not isinstance(serial.decode(bytes.fromhex("02 00 C7 D1 6A 7E")), lika.PositionFrame)
    assert not hasattr(serial, "frame_bits")


def test_frames_and_errors_as_json(lika: Any) -> None:
    encoder = lika.lookup("AMM5A21/65KSC1")
    as_json = json.loads(json.dumps(encoder.decode(SPOILT).to_dict()))
    assert as_json == {
        "order_code": "AMM5A21/65KSC1",
        "multiturn": 42,
        "singleturn": 1821973,
        "error": True,
        "warning": False,
        "position": POSITION,
        "usable_position": None,
        "verdict": "not_usable",
        "reports": ["error"],
    }
    error = encoder.try_decode(WRONG).to_dict()
    assert (error["fault"], error["message"]) == ("crc", "expected CRC 0x22, got 0x23")
    reply = lika.lookup("AMM5A23/65KJP1").decode(bytes.fromhex("02 00 C7 D1 6A 7E")).to_dict()
    assert (reply["data_id"], reply["singleturn"]) == ("singleturn", 7000519)
