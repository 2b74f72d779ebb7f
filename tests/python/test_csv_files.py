"""CSV through pyarrow is the same as CSV row by row: cells in quotes, line ends in cells, and the columns written."""

from __future__ import annotations

import csv
import io
import random
from decimal import Decimal
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy
import pyarrow
import pytest
from codewheel_runtime.files import csv_text, fast_csv, sinks
from exhaustive import exhaustive_if

CODE = "AMM5A21/65KSC1"
#: Worked example of the manual: 0x55bcd15e2 has multi-turn 42 and single-turn 1821973.
GOOD = "0x55bcd15e2"


@pytest.fixture
def decoded(generated_python: tuple[Path, ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A function that returns the rows that ``decode_file`` writes, and whether pyarrow read and wrote them."""
    lika: Any = generated_python[1]

    def decode(content: bytes, fast: bool, target: str = "out.csv") -> str:
        (tmp_path / "in.csv").write_bytes(content)
        with monkeypatch.context() as patched:
            if not fast:
                patched.setattr(csv_text, "_make_fast_reader", lambda *_: None)
                patched.setattr(sinks.CsvSink, "_formatter", None)
            patched.setattr(sinks, "_FEW_ROWS", 0)
            lika.decode_file(CODE, tmp_path / "in.csv", tmp_path / target, column="word", force=True)
        return (tmp_path / target).read_text(encoding="utf-8") if target.endswith(".csv") else ""

    return decode


def test_quotes_are_read_at_once(decoded: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """As pyarrow writes text."""
    text = '"time","word","note"\n' + "".join(f'{row},"{GOOD}","a, ""b"""\n' for row in range(2000))
    expected = decoded(text.encode(), fast=False)
    assert expected.count('"a, ""b""",1821973,42,') == 2000

    def refuse(*_: object) -> None:
        raise AssertionError("rows were read one by one")

    monkeypatch.setattr(csv_text._SlowReader, "open", refuse)
    assert decoded(text.encode(), fast=True) == expected


@pytest.mark.parametrize(
    "rows",
    [
        '1,"0x55bcd15e2",plain\n',
        '1,"0x55bcd15e2","two\nlines"\n2,0x55bcd15e2,x\n',
        '1,"0x55bcd15e2","two\n',
        '1,0x55bcd15e2,a"b\n2,0x55bcd15e2,c"d\n',
        '1,0x55bcd15e2,"a"b"c"\n',
        '1,0x55bcd15e2, "a, b"\n',
        '"1","0x55bcd15e2",""\n\n"2","0x55bcd15e2","#"\n',
        '1,0x55bcd15e2,"a"\r\n2,0x55bcd15e2,"b"\r\n',
        '1,"","a"\n',
        '1,"0x55bcd15e2"\n',
        '1,"0x55bcd15e2","a","b"\n',
        '"1,0x55bcd15e2,a\n2,0x55bcd15e2,"b"\n',
    ],
)
def test_odd_quotes_are_read_as_row_by_row(decoded: Any, rows: str) -> None:
    content = f"time,word,note\n{rows}3,{GOOD},last\n".encode()
    assert decoded(content, fast=True) == decoded(content, fast=False)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("block", "count"),
    exhaustive_if(lambda _, count: count > 250, [(50, 250), (fast_csv.BLOCK, 1000), (50, 1000)]),
)
def test_random_text_is_read_as_row_by_row(
    decoded: Any, monkeypatch: pytest.MonkeyPatch, block: int, count: int
) -> None:
    source = random.Random(7)
    monkeypatch.setattr(fast_csv, "BLOCK", block)
    pieces = [GOOD, '"', '""', ",", ",", "\n", "\n", "a", " ", "\r\n", f'"{GOOD}"', f'1,"{GOOD}",x\n', "é"]
    for _ in range(count):
        text = "time,word,note\n" + f"0,{GOOD},first\n" * 3 + "".join(source.choices(pieces, k=source.randint(1, 12)))
        assert decoded(text.encode(), fast=True) == decoded(text.encode(), fast=False), text


def test_only_the_block_with_an_unusual_cell_is_read_row_by_row(decoded: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cell that is missing in the first block of ten."""
    rows = [f'{row},"{GOOD}","a"\n' for row in range(2000)]
    rows[100] = '100,,"a"\n'
    text = "time,word,note\n" + "".join(rows)
    monkeypatch.setattr(fast_csv, "BLOCK", len(text) // 10)
    opened: list[int] = []
    open_blocks = csv_text._SlowReader.open

    def count(table: Any, blocks: Any, *numbers: int) -> None:
        block_list = list(blocks)
        opened.append(len(block_list))
        open_blocks(table, block_list, *numbers)

    monkeypatch.setattr(csv_text._SlowReader, "open", count)
    fast = decoded(text.encode(), fast=True)
    assert opened == [1]
    assert fast == decoded(text.encode(), fast=False)


def test_both_writers_write_the_same(generated_python: tuple[Path, ModuleType], tmp_path: Path) -> None:
    """Numbers, flags, words, quantities, empty cells and other columns of every type."""
    from codewheel_runtime.files.inputs import Source
    from codewheel_runtime.files.stream import make_plan

    lika: Any = generated_python[1]
    encoder = lika.lookup(CODE)
    table = encoder.decode_many([0x55BCD15E2, 0x55BCD15E3, None, 0x55BCD1564] * 5)
    table = table.with_columns(degrees=table.in_units("degrees"), small=numpy.full(20, 1e-9), whole=numpy.full(20, 3.0))
    others = {
        "text": pyarrow.array(["a", None, "ü", ""] * 5),
        "plain": ["a", "b", "c", "d"] * 5,
        "bytes": pyarrow.array([b"ab", None, b"", b"c"] * 5),
        "money": pyarrow.array([Decimal("1.50"), None, Decimal("2.00"), Decimal("3.25")] * 5),
        "day": pyarrow.array([0, 1, None, 2] * 5, pyarrow.timestamp("ms")),
        "yes": pyarrow.array([True, False, None, True] * 5),
        "float": pyarrow.array([1.0, 1e22, None, 0.1] * 5),
    }
    texts: list[str] = []
    for few in (0, 1000):
        output = io.BytesIO()
        plan = make_plan(table, Source(iter(()), None, tuple(others), others), (), "in", False)  # type: ignore[arg-type]
        previous, sinks._FEW_ROWS = sinks._FEW_ROWS, few  # type: ignore[misc]
        try:
            with sinks.CsvSink(output, plan) as sink:
                sink.write(table, others)
        finally:
            sinks._FEW_ROWS = previous  # type: ignore[misc]
        texts.append(output.getvalue().decode())
    assert texts[0] == texts[1]
    first, second = list(csv.reader(texts[0].splitlines()))[1:3]
    assert first[:7] == ["a", "a", "6162", "1.50", "1970-01-01 00:00:00", "true", "1.0"]
    assert second[:7] == ["", "b", "", "", "1970-01-01 00:00:00.001000", "false", "1e+22"]
