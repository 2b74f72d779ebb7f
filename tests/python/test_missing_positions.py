"""Meaningless positions are null, other columns are kept, and a cell without a frame is a row with an error."""

from __future__ import annotations

import csv
import io
import struct
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy
import pyarrow
import pyarrow.parquet
import pytest
from codewheel_runtime.commands.main import main
from codewheel_runtime.errors import InputError
from codewheel_runtime.files import fast_csv

CODE = "AMM5A21/65KSC1"
#: The frame of AMM5's manual page, 42 revolutions and 1821973 counts, also with a wrong bit and with an error bit.
GOOD, POSITION = 0x55BCD15E2, 89902357
WRONG, SPOILT = GOOD ^ 1 << 40, 0x55BCD1564
PARTS = ("position", "singleturn", "multiturn")


@pytest.fixture
def lika(generated_python: tuple[Path, ModuleType]) -> Any:
    return generated_python[1]


@pytest.fixture
def decode(
    lika: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str, str]]:
    """Run the command in this process, in a folder of its own. Return exit code, standard output and standard error."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> tuple[int, str, str]:
        code = main("lika_encoders", ["decode", *arguments])
        return code, *capsys.readouterr()

    return run


def column(text: str, name: str) -> list[str]:
    return [row[name] for row in csv.DictReader(io.StringIO(text))]


# Positions without meaning


def test_a_table_masks_and_gives_null(lika: Any) -> None:
    table = lika.lookup(CODE).decode_many([GOOD, WRONG, SPOILT])
    assert table.usable_position.tolist() == [POSITION, None, None]
    assert table.usable_position.mean() == POSITION
    assert table.position.tolist()[2] == POSITION, "the raw array has the bits of every frame"
    degrees = table.in_units("degrees")
    assert numpy.isnan(degrees).tolist() == [False, True, True]
    assert not numpy.isnan(table.in_units("degrees", table.position)).any()
    arrow_table = table.to_arrow()
    assert [arrow_table[name].null_count for name in PARTS] == [2, 2, 2]
    assert arrow_table["error"].null_count == arrow_table["verdict"].null_count == 0
    assert table.to_arrow(raw=True)["position"].null_count == 0


def test_pandas_has_nullable_positions(lika: Any) -> None:
    pandas = pytest.importorskip("pandas", reason="pandas is not installed: its columns are not tried")
    table = lika.lookup(CODE).decode_many([GOOD, WRONG, SPOILT])
    frame = table.to_pandas()
    assert frame["position"].mean() == POSITION
    assert [frame[name].isna().tolist() for name in PARTS] == [[False, True, True]] * 3
    assert not table.to_pandas(raw=True)["position"].isna().any()
    words = pandas.DataFrame({"word": pandas.Series([GOOD, None, SPOILT], dtype="Int64")})
    part = lika.decode_partition(words, CODE)
    assert (part["fault"].tolist(), part["position"].isna().tolist()) == (
        ["none", "length", "none"],
        [False, True, True],
    )
    assert lika.decode_partition(words, CODE, raw=True)["position"].iloc[2] == POSITION
    floats = lika.decode_partition(pandas.DataFrame({"word": [float(GOOD), None]}), CODE)
    assert floats["fault"].tolist() == ["none", "length"]
    texts = lika.decode_partition(pandas.DataFrame({"word": [hex(GOOD), None, "0x"]}), CODE)
    assert texts["fault"].tolist() == ["none", "length", "length"]


def test_where_nothing_tells_the_position_stays(lika: Any) -> None:
    """An SSI word has no flag: its verdict is unknown, and it has a position."""
    table = lika.lookup("AMM5A23/65KBG1").decode_many([0x155BCD15, 1 << 39])
    assert table.to_arrow()["position"].to_pylist() == [0x155BCD15, None]


def test_a_reply_with_a_part_of_the_position(lika: Any) -> None:
    """The singleturn reply has no ``position``, but its fields of a position are also meaningless."""
    encoder = lika.lookup("AMM5A23/65KJP1")
    sound_reply = lika.amm5.SingleturnReply(encoder, lika.amm5.DataId.SINGLETURN, False, False, 5)
    spoilt = sound_reply._replace(status_st_error=True)
    table = encoder.decode_many([sound_reply.encode(), spoilt.encode(), None], lika.amm5.SingleturnReply)
    assert table.to_arrow()["singleturn"].to_pylist() == [5, None, None]


@pytest.mark.parametrize("name", ["out.csv", "out.parquet", "out.arrow"])
def test_a_file_has_no_position_of_a_wrong_frame(decode: Any, tmp_path: Path, name: str) -> None:
    (tmp_path / "it.bin").write_bytes(struct.pack("<3Q", GOOD, WRONG, SPOILT))
    for more, expected in (([], [POSITION, None, None]), (["--raw"], None)):
        decode(CODE, "it.bin", "--words", "little", "-o", name, "--force", *more)
        if name.endswith("csv"):
            text = (tmp_path / name).read_text()
            positions = [int(cell) if cell else None for cell in column(text, "position")]
        else:
            is_parquet = name.endswith("parquet")
            read = pyarrow.parquet.read_table if is_parquet else (lambda path: pyarrow.ipc.open_file(path).read_all())
            positions = read(tmp_path / name)["position"].to_pylist()
        assert positions == expected if expected else None not in positions


# Other columns


def test_other_columns_come_first_and_as_they_are(decode: Any, tmp_path: Path) -> None:
    (tmp_path / "it.csv").write_text(f"time,word,note\n0.10,{GOOD:#x},a b\n0.20,{GOOD:#x}\n0.30,{GOOD:#x},\n")
    _, out, _ = decode(CODE, "it.csv")
    assert out.splitlines()[:2] == [
        "time,note,singleturn,multiturn,error,warning,position,verdict,fault",
        f"0.10,a b,1821973,42,false,false,{POSITION},usable,none",
    ]
    assert (column(out, "time"), column(out, "note")) == (["0.10", "0.20", "0.30"], ["a b", "", ""])
    decode(CODE, "it.csv", "-o", "it.parquet")
    table = pyarrow.parquet.read_table(tmp_path / "it.parquet")
    assert table["time"].to_pylist() == [0.1, 0.2, 0.3]
    assert table["note"].to_pylist() == ["a b", None, None]
    assert table.column_names[:3] == ["time", "note", "singleturn"]
    assert decode(CODE, "it.csv", "--columns", "position,time")[1].splitlines()[:2] == [
        "position,time",
        f"{POSITION},0.10",
    ]


@pytest.mark.parametrize("source", ["it.csv", "it.parquet"])
def test_si_units_of_a_file_with_a_time(lika: Any, decode: Any, tmp_path: Path, source: str) -> None:
    """A quarter of a turn per second is pi / 2 rad/s."""
    encoder = lika.lookup(CODE)
    quarter = encoder.counts_per_turn // 4
    words = encoder.encode_many({"position": [0, quarter, 2 * quarter]}).tolist()
    if source == "it.csv":
        rows = zip(("0", "", "2"), words, strict=True)
        (tmp_path / source).write_text("time,word\n" + "".join(f"{time},{word:#x}\n" for time, word in rows))
    else:
        pyarrow.parquet.write_table(pyarrow.table({"time": [0.0, None, 2.0], "word": words}), tmp_path / source)
    code, out, err = decode(CODE, source, "--si")
    assert (code, column(out, "radians_per_second")) == (0, ["", "", ""]), err
    assert [float(cell) for cell in column(out, "radians")] == pytest.approx([0, numpy.pi / 2, numpy.pi])
    (tmp_path / "good.csv").write_text("time,word\n" + "".join(f"{at},{word:#x}\n" for at, word in enumerate(words)))
    names = "radians,radians_per_second"
    code, out, err = decode(CODE, "good.csv", "--si", "--columns", names)
    assert (code, out.splitlines()[0]) == (0, names), err
    speeds = column(out, "radians_per_second")
    assert speeds[0] == ""
    assert [float(cell) for cell in speeds[1:]] == pytest.approx([numpy.pi / 2] * 2)
    assert decode(CODE, "good.csv", "--si", "-o", "out.parquet")[0] == 0
    assert pyarrow.parquet.read_table(tmp_path / "out.parquet")["radians"].to_pylist()[1] == pytest.approx(numpy.pi / 2)


@pytest.mark.parametrize(
    ("content", "code", "message"),
    [
        ("word\n0x1\n", 2, "it.csv has no column 'time', which speeds in SI units need"),
        (
            f"time;word\n0.1;{GOOD:#x}\n0,2;{GOOD:#x}\n",
            1,
            "it.csv, column 'time': expected numbers in seconds with a decimal point, got '0,2'",
        ),
        (f"time,word,radians\n0,{GOOD:#x},1\n", 2, "it.csv already has a column 'radians'"),
    ],
)
def test_si_units_of_a_file_without_a_time(decode: Any, tmp_path: Path, content: str, code: int, message: str) -> None:
    (tmp_path / "it.csv").write_text(content)
    exit_code, _, err = decode(CODE, "it.csv", "--si", "-o", "out.csv")
    assert (exit_code, message in err, err.count("\n")) == (code, True, 1), err
    assert not (tmp_path / "out.csv").exists()


def test_columns_of_parquet_keep_their_types(decode: Any, tmp_path: Path) -> None:
    times = pyarrow.array([1, None], pyarrow.timestamp("us"))
    words = pyarrow.table({"time": times, "word": [GOOD, None], "raw": [b"\x01", None], "on": [True, False]})
    pyarrow.parquet.write_table(words, tmp_path / "it.parquet")
    decode(CODE, "it.parquet", "-o", "out.parquet")
    decoded = pyarrow.parquet.read_table(tmp_path / "out.parquet")
    for name in ("time", "raw", "on"):
        assert decoded[name].equals(words[name])
    assert decoded["fault"].to_pylist() == ["none", "length"]
    _, out, _ = decode(CODE, "it.parquet")
    assert [column(out, name) for name in ("time", "raw", "on")] == [
        ["1970-01-01 00:00:00.000001", ""],
        ["01", ""],
        ["true", "false"],
    ]
    pyarrow.parquet.write_table(words.slice(0, 0), tmp_path / "none.parquet")
    decode(CODE, "none.parquet", "-o", "empty.parquet")
    assert pyarrow.parquet.read_schema(tmp_path / "empty.parquet").equals(decoded.schema)


def test_columns_without_a_name(decode: Any, tmp_path: Path) -> None:
    (tmp_path / "it.csv").write_text(f"7,{GOOD:#x}\n8,\n")
    out = decode(CODE, "it.csv", "--column", "2")[1]
    assert (column(out, "column_1"), column(out, "fault")) == (["7", "8"], ["none", "length"])


def test_a_cell_that_is_no_number_is_counted(
    lika: Any, decode: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first block determines the type of a column. Later cells that do not fit are counted."""
    monkeypatch.setattr(fast_csv, "BLOCK", 50)
    (tmp_path / "it.csv").write_text("time,word\n" + "".join(f"{time},{GOOD:#x}\n" for time in (1, 2, 3, "x", "", 4.5)))
    code, out, _ = decode(CODE, "it.csv", "-o", "it.parquet")
    assert (code, "2 cells of other columns left empty" in out) == (0, True)
    assert pyarrow.parquet.read_table(tmp_path / "it.parquet")["time"].to_pylist() == [1, 2, 3, None, None, None]


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("position,word", "it.csv already has a column 'position', which the decoded frames also have: rename it"),
        ("time,word,time", "it.csv has two columns 'time'; rename one, or select the columns"),
    ],
)
def test_names_that_clash(decode: Any, tmp_path: Path, header: str, message: str) -> None:
    (tmp_path / "it.csv").write_text(f"{header}\n1,{GOOD:#x},2\n")
    code, _, err = decode(CODE, "it.csv", "-o", "out.csv")
    assert (code, message in err) == (2, True), err
    assert not (tmp_path / "out.csv").exists()
    code, out, _ = decode(CODE, "it.csv", "--columns", "singleturn,fault")
    assert (code, out) == (0, "singleturn,fault\n1821973,none\n")


# Frames in a form other than the stated one


@pytest.mark.parametrize(
    ("code", "form", "kind", "word"),
    [
        (CODE, "little", "<u8", GOOD),
        (CODE, "big", ">u8", GOOD),
        ("AM3619/4096-GG", "little32", "<u4", 0x1FA2B9F),
        ("AM3619/4096-GG", "big32", ">u4", 0x1FA2B9F),
        ("AM3619/4096-GG", "little", "<u8", 0x1FA2B9F),
    ],
)
def test_the_form_that_fits_is_named(decode: Any, tmp_path: Path, code: str, form: str, kind: str, word: int) -> None:
    (tmp_path / "it.bin").write_bytes(numpy.full(2001, word, kind).tobytes())
    exit_code, out, _ = decode(code, "it.bin", "--words", form)
    assert (exit_code, set(column(out, "fault"))) == (0, {"none"})
    # Four bytes are also the packed form of a frame of 25 to 32 bits.
    for other_form in {"packed", "little", "big"} - {form} - ({"packed"} if form == "big32" else set()):
        exit_code, _, err = decode(code, "it.bin", "--words", other_form, "-o", "out.csv")
        fitting = {form, "packed"} if form == "big32" else {form}
        assert exit_code == 1
        assert any(f"with --words {fitting_form}, 100% are valid" in err for fitting_form in fitting), err
        assert not (tmp_path / "out.csv").exists()


def test_digits_that_fit_are_named(decode: Any, tmp_path: Path) -> None:
    (tmp_path / "it.csv").write_text(f"{GOOD}\n" * 5)
    code, _, err = decode(CODE, "it.csv", "--digits", "hex")
    assert (code, "with --digits decimal, 100% are valid" in err) == (1, True), err


def test_many_errors_end_with_1(decode: Any, tmp_path: Path) -> None:
    words = [GOOD] * 8 + [WRONG] * 2
    (tmp_path / "it.bin").write_bytes(struct.pack("<10Q", *words))
    arguments = (CODE, "it.bin", "--words", "little", "-o", "out.csv", "--force")
    code, _, err = decode(*arguments)
    assert (code, "20% of the frames have an error; --max-errors is 10" in err) == (1, True)
    assert len((tmp_path / "out.csv").read_text().splitlines()) == 11, "the file is written"
    assert decode(*arguments, "--max-errors", "20")[0] == 0
    assert decode(*arguments, "--max-errors", "101")[0] == 2


# Cells without a frame


def test_missing_frames_are_rows(lika: Any) -> None:
    encoder, serial = lika.lookup(CODE), lika.lookup("AMM5A23/65KJP1")
    masked = numpy.ma.masked_array(numpy.array([GOOD, 0, GOOD], numpy.uint64), [False, True, False])
    for frames in ([GOOD, None, GOOD], [GOOD, float("nan"), GOOD], numpy.array([GOOD, numpy.nan, GOOD]), masked):
        assert encoder.decode_many(frames).fault.tolist() == [0, 1, 0]
    assert encoder.decode_many(numpy.array([GOOD, None], object)).fault.tolist() == [0, 1]
    reply = bytes.fromhex("02 00 15 CD 5B 81")
    assert serial.decode_many([reply, None], lika.amm5.SingleturnReply).fault.tolist() == [0, 1]
    for unusable_words, message in (
        ([1.5], "must be an integer"),
        (numpy.array([1.0], numpy.float32), "cannot represent every frame"),
    ):
        with pytest.raises(TypeError, match=message):
            encoder.decode_many(numpy.array(unusable_words))
    decoded = lika.decode_partition(pyarrow.table({"word": [GOOD, None]}), encoder)
    assert (decoded["fault"].to_pylist(), decoded["position"].to_pylist()) == (["none", "length"], [POSITION, None])
    assert [decoded[name].to_pylist() for name in ("error", "warning")] == [[False, None]] * 2
    assert encoder.decode_many([GOOD, None])[1]["error"] is None


def test_flags_of_missing_frames_are_null_in_pandas(lika: Any) -> None:
    pytest.importorskip("pandas", reason="pandas is not installed: its columns are not tried")
    for frames, missing in (([SPOILT, None], [False, True]), ([SPOILT, GOOD], [False, False])):
        errors = lika.lookup(CODE).decode_many(frames).to_pandas()["error"]
        assert (str(errors.dtype), errors.isna().tolist(), errors[0]) == ("boolean", missing, True)


def test_a_column_that_is_not_frames_names_the_row(lika: Any) -> None:
    encoder = lika.lookup(CODE)
    for frames in (numpy.array([1.0, 0.5]), [1, 0.5], pyarrow.array([1.0, 0.5])):
        with pytest.raises(TypeError, match="the frame at index 1 "):
            encoder.decode_many(frames)
    with pytest.raises(InputError, match="row 1: frames as text need 0x in front: convert the column to integers"):
        encoder.decode_many(pyarrow.array([str(GOOD)]))


def test_unknown_units_of_speed_list_rpm(lika: Any) -> None:
    with pytest.raises(ValueError, match=r"'knots' is not a unit of speeds: use counts, .*, metres, rpm"):
        lika.lookup(CODE).decode_many([GOOD]).velocity(1.0, "knots")


@pytest.mark.parametrize(
    ("end", "faults"),
    [
        ("1,\n2,{0}\n", ["length", "none"]),
        ("1,nan\n2,{0}\n", ["length", "none"]),
        ("1,0x\n2,{0}\n", ["length", "none"]),
        ("1,0x12x\n2,{0}\n", ["length", "none"]),
        ("1\n2,{0}\n", ["length", "none"]),
        ("1,0x", ["length"]),
        ("1", ["length"]),
        ("1,{1}", ["length"]),
        ("1,{0}", ["none"]),
    ],
)
def test_a_cell_without_a_frame_does_not_end_the_run(decode: Any, tmp_path: Path, end: str, faults: list[str]) -> None:
    """A last line without an end that is shorter than the one before may be cut, so its number is not used."""
    sound_cell = f"{GOOD:#x}"
    (tmp_path / "it.csv").write_text(f"time,word\n0,{sound_cell}\n" + end.format(sound_cell, sound_cell[:-1]))
    _, out, _ = decode(CODE, "it.csv")
    assert column(out, "fault") == ["none", *faults]
    assert column(out, "position")[0] == str(POSITION)
