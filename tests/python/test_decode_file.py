"""Files of frames as columns: the output equals that of decode_many, and no file is left incomplete."""

from __future__ import annotations

import csv
import gc
import io
import os
import random
import resource
import signal
import struct
import subprocess
import sys
import time
import weakref
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy
import pyarrow
import pyarrow.parquet
import pytest
from codewheel_runtime.bulk.chunk import Chunk
from codewheel_runtime.bulk.shape import FrameLayout
from codewheel_runtime.commands.main import main
from codewheel_runtime.errors import ErrorKind, UsageError
from codewheel_runtime.files import inputs
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from python_path import python_path

CODE = "AMM5A21/65KSC1"
#: The frame of AMM5's manual page: 42 revolutions, 1821973 counts. Its last bits are the CRC.
GOOD = 0x55BCD15E2
POSITION = 89902357
REPLY = bytes.fromhex("02 00 15 CD 5B 81")
#: A frame whose error bit is active, with a correct CRC.
SPOILT = 0x55BCD1564


class Outcome(NamedTuple):
    code: int
    out: str
    err: str


Command = Callable[..., Outcome]


@pytest.fixture
def decode(
    generated_python: tuple[Path, ModuleType],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> Command:
    """Run the command in this process, in a folder of its own."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> Outcome:
        code = main("lika_encoders", ["decode", *arguments])
        return Outcome(code, *capsys.readouterr())

    return run


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def packed(words: Sequence[int], length: int = 6) -> bytes:
    return b"".join(word.to_bytes(length, "big") for word in words)


# Input


@pytest.mark.parametrize(
    ("name", "content", "options"),
    [
        ("it.bin", packed([GOOD, GOOD ^ 1, SPOILT]), []),
        ("it.bin", struct.pack("<3Q", GOOD, GOOD ^ 1, SPOILT), ["--words", "little"]),
        ("it.bin", struct.pack(">3Q", GOOD, GOOD ^ 1, SPOILT), ["--words", "big"]),
        ("it.csv", b"0x55bcd15e2\n0x55bcd15e3\n0x55bcd1564\n", []),
        ("it.csv", b"\xef\xbb\xbfword\r\n0x55bcd15e2\r\n\r\n# no frame\r\n0x55bcd15e3\r\n0x55BCD1564", []),
        ("it.csv", b"time;Frame\n1;0x55bcd15e2\n2;0x55bcd15e3\n3;0x55bcd1564\n", []),
        (
            "it.csv",
            b"time,it\n1,23015003618\n2,23015003619\n3,23015003492\n",
            ["--column", "it", "--digits", "decimal"],
        ),
        ("it.csv", b"1\t55bcd15e2\n2\t55bcd15e3\n3\t55bcd1564\n", ["--column", "2", "--digits", "hex"]),
        ("it.csv", b'"05 5B CD 15 E2"\n05 5B CD 15 E3\n0b010101011011110011010001010101100100\n', ["--digits", "hex"]),
        ("it.dat", b"0x55bcd15e2\n0x55bcd15e3\n0x55bcd1564\n", ["--read", "csv"]),
    ],
)
def test_every_way_in(decode: Command, tmp_path: Path, name: str, content: bytes, options: list[str]) -> None:
    (tmp_path / name).write_bytes(content)
    outcome = decode(CODE, name, "--max-errors", "34", *options)
    assert outcome.code == 0, outcome.err
    decoded_rows = rows(outcome.out)
    assert [row["fault"] for row in decoded_rows] == ["none", "crc", "none"]
    assert [row["verdict"] for row in decoded_rows] == ["usable", "not_usable", "not_usable"]
    assert [row["position"] for row in decoded_rows] == [str(POSITION), "", ""]
    assert (decoded_rows[0]["multiturn"], decoded_rows[0]["singleturn"], decoded_rows[0]["position"]) == (
        "42",
        "1821973",
        str(POSITION),
    )
    assert [row["error"] for row in decoded_rows] == ["false", "false", "true"]
    summary = "3 frames, 2 valid (1 not usable, 1 usable), 1 with a CRC error\n"
    assert outcome.err == summary


@pytest.mark.parametrize(
    "column",
    [
        pyarrow.array([GOOD, GOOD ^ 1, SPOILT], pyarrow.uint64()),
        pyarrow.array([GOOD, GOOD ^ 1, SPOILT], pyarrow.int64()),
        pyarrow.array([GOOD, GOOD ^ 1, SPOILT], pyarrow.int64()).dictionary_encode(),
        pyarrow.array([word.to_bytes(6, "big") for word in (GOOD, GOOD ^ 1, SPOILT)]),
        pyarrow.array([word.to_bytes(6, "big") for word in (GOOD, GOOD ^ 1, SPOILT)], pyarrow.large_binary()),
        pyarrow.array([word.to_bytes(6, "big") for word in (GOOD, GOOD ^ 1, SPOILT)], pyarrow.binary(6)),
        pyarrow.array([word.to_bytes(size, "big") for word, size in ((GOOD, 6), (GOOD ^ 1, 8), (SPOILT, 7))]),
        pyarrow.array([f"{word:#x}" for word in (GOOD, GOOD ^ 1, SPOILT)]),
    ],
    ids=lambda column: str(column.type),
)
def test_every_column_of_parquet(decode: Command, tmp_path: Path, column: pyarrow.Array) -> None:
    pyarrow.parquet.write_table(pyarrow.table({"time": [1, 2, 3], "word": column}), tmp_path / "it.parquet")
    outcome = decode(CODE, "it.parquet")
    assert [row["fault"] for row in rows(outcome.out)] == ["none", "crc", "none"], outcome.err
    assert rows(outcome.out)[0]["position"] == str(POSITION)


def test_a_cell_with_too_few_bytes_has_a_length_error(decode: Command, tmp_path: Path) -> None:
    """The word fits into 5 bytes, but the frame has 47 bits, so a byte is missing."""
    column = pyarrow.array([GOOD.to_bytes(6, "big"), GOOD.to_bytes(5, "big"), b""])
    pyarrow.parquet.write_table(pyarrow.table({"word": column}), tmp_path / "it.parquet")
    outcome = decode(CODE, "it.parquet", "--max-errors", "100")
    assert [row["fault"] for row in rows(outcome.out)] == ["none", "length", "length"], outcome.err


def test_rows_of_bytes(decode: Command, tmp_path: Path) -> None:
    (tmp_path / "it.bin").write_bytes(REPLY * 2 + REPLY[:-1] + b"x")
    (tmp_path / "it.csv").write_text("02 00 15 CD 5B 81\n020015cd5b81\n02 00 15 CD 5B 78\n02 00")
    for name, more in (("it.bin", []), ("it.csv", ["length"])):
        for layout in ("singleturn_reply", "SingleturnReply"):
            outcome = decode("AMM5A23/65KJP1", name, "--layout", layout)
            decoded_rows = rows(outcome.out)
            assert [row["fault"] for row in decoded_rows] == ["none", "none", "crc", *more], outcome.err
            assert decoded_rows[1]["singleturn"] == "6016277"


def test_frames_that_follow_a_register(
    decode: Command, tmp_path: Path, generated_python: tuple[Path, ModuleType]
) -> None:
    """The number of bits that AM36 sends depends on its registers: 44 by default, 40 with 16 for a revolution."""
    (tmp_path / "it.bin").write_bytes(packed([0x2ABCD15EF]))
    usual = rows(decode("AM3616/4096-I7", "it.bin").out)
    assert (usual[0]["multiturn"], usual[0]["singleturn"], usual[0]["fault"]) == ("42", "773397", "none")
    shorter = generated_python[1].lookup("AM3616/4096-I7").with_registers({0x56: 0x10})
    frame = generated_python[1].am36.SingleCycleData.from_position(shorter, 42 << 16 | 77)
    (tmp_path / "it.bin").write_bytes(packed([frame.encode()], 5))
    outcome = decode("AM3616/4096-I7", "it.bin", "--register", "0x56=0x10")
    assert (rows(outcome.out)[0]["multiturn"], rows(outcome.out)[0]["singleturn"]) == ("42", "77")
    assert "offset 0: 0 complete frames of 6 bytes" in decode("AM3616/4096-I7", "it.bin").err
    assert f"no register affects the frames of {CODE}" in decode(CODE, "it.bin", "--register", "0x56=1").err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((CODE, ""), "the frame is empty"),
        ((CODE, " ", ""), "the frame is empty"),
        (("AMM5A23/65KJP1", ""), "the frame is empty"),
        ((CODE, "10 01 11"), "'10 01 11' could be bits or hexadecimal digits. Prefix it with 0b or 0x"),
        ((CODE, "10", "01"), "'10 01' could be bits or hexadecimal digits. Prefix it with 0b or 0x"),
        (
            ("ASC8525/SC2", "0x123"),
            (
                "ASC8525/SC2: zero_bit must be ZeroBit.AS_PRINTED or ZeroBit.LEFT_OUT, got None: "
                "the manual leaves this open; add --choose zero_bit=as_printed or --choose zero_bit=left_out"
            ),
        ),
    ],
)
def test_a_frame_that_needs_another_argument(decode: Command, arguments: tuple[str, ...], message: str) -> None:
    """``codewheel decode`` also refuses an empty frame, and digits that can be bits or bytes."""
    outcome = decode(*arguments)
    assert (outcome.code, outcome.out, outcome.err) == (2, "", f"lika-encoders: {message}\n")


def test_what_the_manual_leaves_open(decode: Command, tmp_path: Path) -> None:
    """The address of AMM5's EEPROM, according to its erratum: EA 0A E0 or EA 05 EF for address 5."""
    (tmp_path / "it.bin").write_bytes(bytes.fromhex("EA 0A E0"))
    arguments = ("AMM5A23/65KJP1", "it.bin", "--layout", "eeprom_read_request")
    outcome = decode(*arguments)
    assert outcome.code == 2
    assert "choose as_printed or as_t_format" in outcome.err
    assert rows(decode(*arguments, "--choose", "adf_layout=as_printed").out)[0]["address"] == "5"
    assert rows(decode(*arguments, "--choose", "adf_layout=as_t_format").out)[0]["address"] == "10"
    assert "does not accept the answer 'other'" in decode(*arguments, "--choose", "other=x").err


def test_a_frame_whose_length_is_left_open(decode: Command, tmp_path: Path) -> None:
    """ASC85, position 1: 1, the 0 bit, 11 and the CRC 100010b, and the same without the 0 bit, CRC 110110b."""
    for answer, word in (("as_printed", 0b1011_100010), ("left_out", 0b111_110110)):
        (tmp_path / "it.bin").write_bytes(packed([word], 5))
        outcome = decode("ASC8525/SC1", "it.bin")
        assert outcome.code == 2
        assert "choose as_printed or left_out" in outcome.err
        wrong = decode("ASC8525/SC1", "0x5", "--choose", "zero_bit=printed")
        assert wrong.err.endswith("expected --choose zero_bit=as_printed or --choose zero_bit=left_out\n")
        (row,) = rows(decode("ASC8525/SC1", "it.bin", "--choose", f"zero_bit={answer}").out)
        assert (row["position"], row["fault"]) == ("1", "none")


# Output


def test_files_hold_the_same(decode: Command, tmp_path: Path) -> None:
    words = [GOOD ^ (1 << frame_index if frame_index % 3 else 0) for frame_index in range(45)]
    (tmp_path / "it.bin").write_bytes(packed(words))
    for name in ("it.parquet", "it.arrow", "it.csv"):
        outcome = decode(CODE, "it.bin", "-o", name, "--max-errors", "100")
        assert (outcome.code, outcome.err) == (0, "")
        assert outcome.out == "45 frames, 15 valid (15 usable), 30 with a CRC error\n"
    parquet = pyarrow.parquet.read_table(tmp_path / "it.parquet")
    assert pyarrow.ipc.open_file(tmp_path / "it.arrow").read_all().cast(parquet.schema) == parquet
    csv_rows = rows((tmp_path / "it.csv").read_text())
    for name in parquet.column_names:
        expected_cells = ["" if value is None else str(value).lower() for value in parquet[name].to_pylist()]
        assert expected_cells == [row[name] for row in csv_rows], name
    umask = os.umask(0)
    os.umask(umask)
    assert (tmp_path / "it.csv").stat().st_mode & 0o777 == 0o666 & ~umask


@pytest.mark.slow
def test_parts_make_the_whole(
    generated_python: tuple[Path, ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Frames at the borders of the blocks that are read at once."""
    lika = generated_python[1]
    source = random.Random(5)
    words = [GOOD ^ (source.getrandbits(45) if source.random() < 0.3 else 0) for _ in range(1000)]
    whole = lika.lookup(CODE).decode_many(words)
    (tmp_path / "it.bin").write_bytes(packed(words))
    (tmp_path / "it.csv").write_text("".join(f"{word:#x}\n" for word in words))
    pyarrow.parquet.write_table(pyarrow.table({"word": words}), tmp_path / "it.parquet", row_group_size=7)
    for size in (1, 7, 999, 1000, 1001):
        monkeypatch.setattr(inputs, "CHUNK", size)
        monkeypatch.setattr(inputs, "ROWS", size)
        for name in ("it.bin", "it.csv", "it.parquet") if size > 1 else ("it.bin",):
            for limit in (None, 0, 5, 7, 1000, 2000):
                out = tmp_path / "out.arrow"
                summary = lika.decode_file(CODE, tmp_path / name, out, limit=limit, force=True)
                written = pyarrow.ipc.open_file(out).read_all()
                count = min(limit if limit is not None else 1000, 1000)
                assert (summary.frames, written.num_rows) == (count, count)
                assert written["position"].to_pylist() == whole.usable_position[:count].tolist()
                faults = [ErrorKind[name_of_fault.upper()] for name_of_fault in written["fault"].to_pylist()]
                assert faults == whole.fault[:count].tolist()


def test_a_limit_that_is_no_number_of_frames(generated_python: tuple[Path, ModuleType], tmp_path: Path) -> None:
    """A negative limit would leave out frames at the end, as a slice of Python does."""
    (tmp_path / "it.bin").write_bytes(packed([GOOD, SPOILT]))
    for limit, error in ((-1, UsageError), (1.5, TypeError), (True, TypeError)):
        with pytest.raises(error, match="limit must be"):
            generated_python[1].decode_file(CODE, tmp_path / "it.bin", tmp_path / "out.csv", limit=limit)
        assert not (tmp_path / "out.csv").exists()


def test_columns_that_are_asked_for(decode: Command, tmp_path: Path) -> None:
    (tmp_path / "it.bin").write_bytes(packed([GOOD]))
    assert decode(CODE, "it.bin", "--columns", "fault, position").out == f"fault,position\nnone,{POSITION}\n"
    assert decode(CODE, "it.bin", "-o", "it.parquet", "--columns", "error").code == 0
    assert pyarrow.parquet.read_table(tmp_path / "it.parquet").to_pydict() == {"error": [False]}
    outcome = decode(CODE, "it.bin", "--columns", "speed")
    assert outcome.code == 2
    assert "no column 'speed'; the columns are singleturn, multiturn" in outcome.err


def test_nothing_in_nothing_out(decode: Command, tmp_path: Path) -> None:
    for name in ("it.bin", "it.csv"):
        (tmp_path / name).write_bytes(b"")
        for out in ("it.parquet", "it.arrow", "none.csv"):
            assert decode(CODE, name, "-o", out, "--force").out == "0 frames, 0 valid\n"
    assert pyarrow.parquet.read_table(tmp_path / "it.parquet").num_rows == 0
    assert pyarrow.ipc.open_file(tmp_path / "it.arrow").read_all().num_rows == 0


# Errors


@pytest.mark.parametrize(
    ("name", "content", "options", "code", "message"),
    [
        ("it.bin", bytes(13), [], 1, "it.bin, offset 12: 2 complete frames of 6 bytes end here, and 1 more byte"),
        ("it.bin", bytes(9), ["--words", "big"], 1, "offset 8: 1 complete frames of 8 bytes end here"),
        ("it.csv", "word\n0x1\n".encode("utf-16"), [], 1, "it.csv: the text is UTF-16: save the file as UTF-8"),
        ("it.csv", b"word\nxyz\n0x1\nzyx\n", [], 1, "it.csv, line 2: 'xyz' is not a hexadecimal number"),
        (
            "it.csv",
            b"word\n17\n",
            [],
            1,
            "it.csv, line 2: '17' can be decimal or hexadecimal: choose --digits decimal or",
        ),
        ("it.csv", b"word\n1f\n", [], 1, "'1f' is hexadecimal: choose --digits hex (in Python: digits='hex'), or put"),
        ("it.csv.gz", b"\x1f\x8b\x08" * 4, [], 1, "it.csv.gz: compressed files cannot be decoded: decompress the file"),
        ("it.xlsx", b"PK\3\4" * 3, [], 1, "it.xlsx: spreadsheets cannot be decoded: save the table as CSV"),
        ("it.csv", b"word\n1f\n", ["--digits", "decimal"], 1, "line 2: '1f' is not a decimal number"),
        ("it.csv", b"a,b\n1,0x2\n", [], 1, "choose the column with the frames; the columns are 'a', 'b'"),
        ("it.csv", b"a,b\n1,0x2\n", ["--column", "c"], 1, "line 1: no column 'c'; the columns are 'a', 'b'"),
        ("it.csv", b"a,b\n1,0x2\n", ["--column", "3"], 1, "line 1: no column '3'"),
        ("it.csv", b"x" * (1 << 21), [], 1, "a line has more than 1048576 characters: this is not a CSV file"),
        ("it.csv", b'word\n"' + b"0x1\n" * 100_000, [], 1, "field larger than field limit"),
        ("it.parquet", b"PAR1 no more", [], 1, "it.parquet: this is not a valid Parquet file"),
        ("it.parquet", b"", [], 1, "it.parquet: this is not a valid Parquet file"),
        ("it.bin", b"", ["--limit", "-1"], 2, "argument --limit: invalid count value: '-1'"),
        ("it.bin", b"", ["--register", "0x56"], 2, "invalid ADDRESS=BYTE value: '0x56'"),
        ("it.bin", b"", ["--choose", "x"], 2, "invalid NAME=ANSWER value: 'x'"),
        ("it.bin", b"", ["--interface", "rs485"], 2, "AMM5A21/65KSC1 has the interface BiSS, not RS-485"),
        ("it.bin", b"", ["--layout", "nothing"], 2, "AMM5A21/65KSC1 has no frame 'nothing': single_cycle_data"),
        ("it.bin", b"", ["--write", "parquet"], 2, "only CSV can be written to standard output"),
        ("it.bin", b"", ["-o", "it.bin", "--force"], 2, "it.bin is also the source; write to another file"),
        ("it.bin", b"", ["-o", "."], 2, ". is not a regular file, so it cannot be replaced"),
        ("it.bin", b"", ["-o", "no/where.csv"], 1, "lika-encoders: no/where.csv: No such file or directory"),
    ],
)
def test_what_is_told(
    decode: Command, tmp_path: Path, name: str, content: bytes, options: list[str], code: int, message: str
) -> None:
    (tmp_path / name).write_bytes(content)
    outcome = decode(CODE, name, *options)
    assert (outcome.code, message in outcome.err) == (code, True), outcome.err
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("name", ["pipe", "link to a pipe"])
def test_what_is_not_a_file_is_not_replaced(decode: Command, tmp_path: Path, name: str) -> None:
    (tmp_path / "it.bin").write_bytes(b"")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link to a pipe").symlink_to("pipe")
    outcome = decode(CODE, "it.bin", "-o", name, "--force")
    assert (outcome.code, f"{name} is not a regular file, so it cannot be replaced" in outcome.err) == (2, True), (
        outcome.err
    )
    assert (tmp_path / "pipe").is_fifo()
    assert (tmp_path / "link to a pipe").is_symlink()


def test_files_that_are_not_there_or_in_the_way(decode: Command, tmp_path: Path) -> None:
    assert decode(CODE, "nothing.bin").err == "lika-encoders: nothing.bin: No such file or directory\n"
    assert decode("AMM5A99/65KSC1", "nothing.bin").code == 2
    (tmp_path / "it.bin").write_bytes(packed([GOOD]))
    (tmp_path / "it.csv").write_text("mine")
    outcome = decode(CODE, "it.bin", "-o", "it.csv")
    assert (outcome.code, (tmp_path / "it.csv").read_text()) == (2, "mine")
    assert "it.csv already exists; replace it with --force, or force=True" in outcome.err
    (tmp_path / "link.csv").symlink_to("it.csv")
    assert decode(CODE, "it.bin", "-o", "link.csv", "--force").code == 0
    assert (tmp_path / "link.csv").is_symlink()
    assert str(POSITION) in (tmp_path / "it.csv").read_text()
    (tmp_path / "it.bin").write_bytes(packed([GOOD]) + b"x")
    assert decode(CODE, "it.bin", "-o", "it.csv", "--force").code == 1
    assert str(POSITION) in (tmp_path / "it.csv").read_text()
    assert decode(CODE, "it.bin", "-o", "it.csv", "--force", "--cut").out.startswith("1 frame, 1 valid (")
    assert decode(CODE, "it.bin", "-o", "none/it.csv").err == "lika-encoders: none/it.csv: No such file or directory\n"


def test_parquet_without_frames(decode: Command, tmp_path: Path) -> None:
    for table, message in (
        ({"word": [1.5]}, "column 'word': the frame at index 0 must be an integer, got 1.5"),
        ({"word": [True]}, "column 'word': expected numbers, bytes or text, got items of the type bool"),
        ({"word": ["0x1", "time", "date"]}, "row 2 of column 'word': 'time' is not a hexadecimal number"),
        ({"a": [1], "b": [2]}, "choose the column with the frames; the columns are 'a', 'b'"),
    ):
        pyarrow.parquet.write_table(pyarrow.table(table), tmp_path / "it.parquet")
        outcome = decode(CODE, "it.parquet")
        assert (outcome.code, message in outcome.err) == (1, True), outcome.err
    pyarrow.parquet.write_table(pyarrow.table({"word": [1]}), tmp_path / "it.parquet")
    outcome = decode("AMM5A23/65KJP1", "it.parquet", "--layout", "singleturn_reply")
    assert "expected rows of 6 bytes, got numbers" in outcome.err


def test_help_is_80_wide(decode: Command) -> None:
    outcome = decode("--help")
    assert outcome.code == 0
    assert max(map(len, outcome.out.splitlines())) <= 80
    assert "\nexit codes:\n  0    success\n" in outcome.out
    assert all(word in outcome.out for word in ("--columns", "--interface", "--force", "--limit"))


# Unusual input

ODD = st.one_of(st.binary(max_size=200), st.text(max_size=60).map(lambda text: text.encode("utf-8", "surrogatepass")))
OPTIONS = st.lists(
    st.one_of(
        st.sampled_from(
            "--words=little --words=big --read=csv --read=parquet --read=binary --digits=hex --digits=decimal --cut "
            "--column=1 --column=word --layout=singleturn_reply --layout=complete_reply --limit=1 --limit=0 "
            "--interface=biss --force --write=arrow --write=parquet --columns=fault --choose=adf_layout=as_printed "
            "--layout=eeprom_read_reply --register=0x56=0x10 --register=1=999 -ox.parquet -ox.arrow".split()
        ),
        st.builds(
            "--{}={}".format,
            st.sampled_from("column columns layout limit register choose digits words read".split()),
            st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=12),
        ),
    ),
    max_size=4,
)
CODES = st.sampled_from([CODE, "AMM5A23/65KJP1", "AM3616/4096-I7", "SMA21-JP1-0005", "ASC8525/GG1", "", "x", "é"])


@pytest.mark.slow
@example(code="ASC8525/GG1", options=["-ox.parquet"], content=b"\x02\0\0\0", name="in.bin")
@given(code=CODES, options=OPTIONS, content=ODD, name=st.sampled_from(["in.bin", "in.csv", "in.parquet"]))
@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_nothing_crashes_it(
    decode: Command, tmp_path: Path, code: str, options: list[str], content: bytes, name: str
) -> None:
    """Any option and any content results in an exit code, and an error in one line with the reason."""
    for path in tmp_path.iterdir():
        path.unlink()
    (tmp_path / name).write_bytes(content)
    outcome = decode(code, name, *options)
    assert outcome.code in (0, 1, 2)
    assert outcome.code == 0 or outcome.err.strip()
    files_written = {path.name for path in tmp_path.iterdir()} - {name}
    # The frames are also written if more of them than --max-errors have an error.
    has_written = outcome.code == 0 or "of the frames have an error" in outcome.err
    assert files_written <= ({"x.parquet", "x.arrow"} if has_written else set())


@pytest.mark.slow
@given(data=st.data())
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_no_damaged_parquet_crashes_it(decode: Command, tmp_path: Path, data: st.DataObject) -> None:
    sound = io.BytesIO()
    pyarrow.parquet.write_table(pyarrow.table({"word": [GOOD, GOOD ^ 1] * 50, "t": list(range(100))}), sound)
    damaged = bytearray(sound.getvalue())
    for _ in range(data.draw(st.integers(1, 3))):
        damaged[data.draw(st.integers(0, len(damaged) - 1))] = data.draw(st.integers(0, 255))
    (tmp_path / "in.parquet").write_bytes(damaged)
    assert decode(CODE, "in.parquet").code in (0, 1)


# In a process of its own


@pytest.fixture(scope="module")
def start(generated_python: tuple[Path, ModuleType]) -> Callable[..., subprocess.Popen[str]]:
    def run(*arguments: str, cwd: Path, **how: Any) -> subprocess.Popen[str]:
        environment = {**os.environ, "PYTHONPATH": python_path(generated_python[0]), "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, "-m", "lika_encoders", "decode", *arguments]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **how}
        # In the background, interrupts are ignored, and tests inherit this.
        pipes.setdefault("preexec_fn", partial(signal.signal, signal.SIGINT, signal.default_int_handler))
        return subprocess.Popen(command, cwd=cwd, env=environment, text=True, **pipes)

    return run


@pytest.mark.slow
@pytest.mark.parametrize("interruption", [signal.SIGINT, signal.SIGTERM])
def test_an_interruption_leaves_nothing(start: Any, tmp_path: Path, interruption: signal.Signals) -> None:
    (tmp_path / "out.parquet").write_text("mine")
    process = start(CODE, "-", "-o", "out.parquet", "--force", cwd=tmp_path, stdin=subprocess.PIPE)
    process.stdin.buffer.write(packed([GOOD]) * 600_000)
    process.stdin.flush()
    until = time.monotonic() + 60
    while len(list(tmp_path.iterdir())) == 1 and time.monotonic() < until:
        time.sleep(0.05)
    assert len(list(tmp_path.iterdir())) == 2
    process.send_signal(interruption)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (130, "")
    assert err == "lika-encoders: interrupted; no file was written\n"
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"out.parquet": "mine"}


@pytest.mark.slow
def test_a_full_disk_leaves_nothing(start: Any, tmp_path: Path) -> None:
    (tmp_path / "it.bin").write_bytes(packed(range(200_000)))

    def limit_file_size() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (2_000, 2_000))

    for name in ("out.parquet", "out.csv", "out.arrow"):
        process = start(CODE, "it.bin", "-o", name, cwd=tmp_path, preexec_fn=limit_file_size)
        _, err = process.communicate(timeout=60)
        assert (process.returncode, "File too large" in err, "Traceback" in err) == (1, True, False), err
        assert [path.name for path in tmp_path.iterdir()] == ["it.bin"]


@pytest.mark.slow
def test_a_reader_that_has_enough(start: Any, tmp_path: Path) -> None:
    (tmp_path / "it.bin").write_bytes(packed([GOOD]) * 300_000)
    process = start(CODE, "it.bin", cwd=tmp_path)
    assert process.stdout.readline().startswith("singleturn,")
    process.stdout.close()
    assert process.stderr.read() == ""
    assert process.wait(60) == 1


@pytest.mark.slow
def test_standard_input_and_a_package_that_is_missing(start: Any, tmp_path: Path) -> None:
    process = start(CODE, "-", "--read", "csv", cwd=tmp_path, stdin=subprocess.PIPE)
    out, _ = process.communicate("0x55bcd15e2\n", timeout=60)
    assert str(POSITION) in out
    (tmp_path / "pyarrow.py").write_text("raise ModuleNotFoundError(name='pyarrow')")
    (tmp_path / "it.bin").write_bytes(packed([GOOD]))
    process = start(CODE, "it.bin", "-o", "out.parquet", cwd=tmp_path)
    _, err = process.communicate(timeout=60)
    expected = "lika-encoders: this needs pyarrow: pip install pyarrow\n"
    assert (process.returncode, err) == (1, expected)
    assert not (tmp_path / "out.parquet").exists()


@pytest.mark.slow
def test_a_bar_on_a_terminal_alone(start: Any, tmp_path: Path) -> None:
    import pty

    (tmp_path / "it.bin").write_bytes(packed([GOOD]) * 600_000)
    reader, writer = pty.openpty()
    process = start(CODE, "it.bin", "-o", "out.parquet", cwd=tmp_path, stderr=writer)
    process.wait(60)
    os.close(writer)
    terminal_output = os.read(reader, 100_000).decode()
    assert "\r[" in terminal_output
    assert "%" in terminal_output
    assert terminal_output.endswith("\r")
    assert process.stdout.read().startswith("600000 frames, 600000 valid (600000 usable)")


# Partitions


def test_partitions(generated_python: tuple[Path, ModuleType]) -> None:
    pandas = pytest.importorskip("pandas", reason="pandas is not installed: its partitions are not tried")
    lika = generated_python[1]
    encoder = lika.lookup(CODE)
    words = [GOOD, GOOD ^ 1, SPOILT]
    table = pyarrow.table({"time": [1, 2, 3], "word": words})
    for part in (table, table.to_batches()[0], table.to_pandas()):
        decoded = lika.decode_partition(part, encoder, "word")
        assert type(decoded) is type(part)
        frame = decoded if isinstance(decoded, pandas.DataFrame) else decoded.to_pandas()
        assert [*frame] == ["time", "singleturn", "multiturn", "error", "warning", "position", "verdict", "fault"]
        assert frame["time"].tolist() == [1, 2, 3]
        assert frame["fault"].tolist() == ["none", "crc", "none"]
        assert frame["position"][0] == POSITION
    again = lika.decode_partition(table.to_pandas().set_index("time"), CODE)
    assert again.index.tolist() == [1, 2, 3]
    assert lika.decode_partition(table.schema.empty_table(), encoder).num_rows == 0
    texts = pandas.DataFrame({"frame": ["02 00 15 CD 5B 81", "02"]})
    replies = lika.decode_partition(texts, "AMM5A23/65KJP1", layout="singleturn_reply")
    assert replies["fault"].tolist() == ["none", "length"]
    for unusable_table, message in (
        (table.append_column("position", [[1, 2, 3]]), "already has a column 'position'"),
        (pyarrow.table({"word": ["x"]}), "'x' is not a hexadecimal number"),
        (pandas.DataFrame({"word": [1.5]}), "the frame at index 0 must be an integer, got 1.5"),
        (pandas.DataFrame({"word": [True]}), "the frame at index 0 must be an integer, got True"),
    ):
        with pytest.raises(ValueError, match=message):
            lika.decode_partition(unusable_table, encoder, "word")
    with pytest.raises(TypeError, match=r"got list$"):
        lika.decode_partition([1], encoder)


# Memory


@pytest.mark.slow
def test_memory_is_bounded(generated_python: tuple[Path, ModuleType], tmp_path: Path) -> None:
    """50 MB of input. ``benchmarks/stream.py`` does the same with any number of gigabytes."""
    from stream import measured

    outcome = measured(generated_python[0], tmp_path, 50_000_000, CODE)
    assert outcome.frames == 50_000_000 // 6
    assert outcome.peak_mb < 200, outcome
    assert numpy.isclose(outcome.damaged, outcome.frames / 1000, rtol=0.1)


@pytest.mark.parametrize("has_gray", [False, True])
def test_a_chunk_is_freed_without_the_garbage_collector(has_gray: bool) -> None:
    """Chunks that wait for the garbage collector fill the memory with arrays of decoded frames."""
    words = numpy.arange(8, dtype=numpy.uint64)
    chunk = Chunk([words], 45)
    if has_gray:
        chunk.convert_to_binary(FrameLayout(45, gray=(0, 12)))
    assert chunk.as_sent.words[0].tolist() == list(range(8))
    reference = weakref.ref(words)
    gc.disable()
    try:
        del chunk, words
        assert reference() is None
    finally:
        gc.enable()


@pytest.mark.slow
def test_memory_is_bounded_however_long_a_column_is(generated_python: tuple[Path, ModuleType], tmp_path: Path) -> None:
    """All rows of a Parquet file may be in one group."""
    from stream import run

    words = numpy.random.default_rng(1).integers(0, 1 << 45, 8_000_000, numpy.uint64)
    pyarrow.parquet.write_table(pyarrow.table({"word": words}), tmp_path / "it.parquet", row_group_size=len(words))
    out = str(tmp_path / "out.parquet")
    outcome = run(
        generated_python[0],
        CODE,
        str(tmp_path / "it.parquet"),
        "-o",
        out,
        "--columns",
        "position",
        "--max-errors",
        "100",
    )
    assert outcome.output.startswith("8000000 frames")
    assert outcome.peak_mb < 200, outcome


def test_bytes_that_are_left_over_are_told_before_anything_is_done(
    generated_python: tuple[Path, ModuleType],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    decode: Command,
) -> None:
    """The length of a pipe is unknown. An error there is reported at the end, and nothing is written either."""
    monkeypatch.setattr(inputs, "CHUNK", 1)
    (tmp_path / "it.bin").write_bytes(packed([GOOD] * 9) + b"x")
    steps: list[tuple[object, ...]] = []
    with pytest.raises(ValueError, match="offset 54: 9 complete frames of 6 bytes end here, and 1 more byte follows"):
        generated_python[1].decode_file(CODE, "it.bin", "out.csv", progress=lambda *step: steps.append(step))
    assert steps == []
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO((tmp_path / "it.bin").read_bytes())))
    outcome = decode(CODE, "-", "-o", "out.csv")
    assert (outcome.code, "standard input, offset 54" in outcome.err) == (1, True)
    assert not (tmp_path / "out.csv").exists()
