"""The live view of an encoder: the display on a terminal, and one line per reading elsewhere."""

from __future__ import annotations

import csv
import io
import itertools
import json
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from codewheel_runtime.commands import monitor
from codewheel_runtime.commands.record import open_recorder
from python_path import python_path

GOOD, SPOILT = 0x55BCD15E2, 0x55BCD1564


class NoReplyError(RuntimeError):
    """As a link raises it."""


class Readings:
    """A link that returns frames, or raises errors."""

    def __init__(self, *items: Any) -> None:
        self._items = iter(items)

    def read(self) -> Any:
        reading = next(self._items)
        if isinstance(reading, RuntimeError):
            raise reading
        return reading


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def encoder(generated_python: Any) -> Any:
    return generated_python[1].lookup("AMM5A21/65KSC1")


@pytest.fixture(autouse=True)
def clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock that advances by 0.25 s whenever it is read."""
    ticks = itertools.count()
    monkeypatch.setattr(monitor, "monotonic", lambda: next(ticks) / 4)


def test_a_terminal_shows_the_last_state(encoder: Any) -> None:
    out = Terminal()
    readings = Readings(encoder.decode(GOOD), NoReplyError("no reply within 50 ms"), encoder.decode(SPOILT))
    monitor.watch(readings, encoder, "COM3", count=3, out=out)
    last = out.getvalue().rpartition("\x1b[9A")[2].replace("\r\x1b[2K", "").splitlines()
    assert last[0] == "AMM5A21/65KSC1, BiSS, COM3    Ctrl-C ends"
    rows_shown = {line[:10].strip(): line[10:] for line in last[1:]}
    # The position of the last frame is not usable, so none is shown.
    assert rows_shown["position"] == "-"
    assert rows_shown["verdict"] == "not usable"
    assert rows_shown["alarms"] == "error"
    assert rows_shown["errors"] == "1 of 3 readings failed: 1 no reply"
    assert rows_shown[""] == "no reply within 50 ms"
    assert "89902357 counts" in out.getvalue()


def test_a_terminal_shows_angle_and_speed(encoder: Any) -> None:
    """A quarter of a revolution in 0.25 s."""
    out = Terminal()
    quarter = encoder.encode_many({"position": [0, 1 << 19]}).tolist()
    monitor.watch(Readings(*map(encoder.decode, quarter)), encoder, "a port", count=2, out=out)
    shown = out.getvalue()
    for text in ("524288 counts", "90.00000°", "60.000 rpm", "usable", "0 of 2 readings failed"):
        assert text in shown


def record(encoder: Any, target: Path, *readings: Any) -> monitor.Readings:
    with open_recorder(str(target), None, force=False) as recorder:
        return monitor.watch(
            Readings(*readings), encoder, "COM3", count=len(readings), out=io.StringIO(), recorder=recorder
        )


def test_each_reading_is_a_row(encoder: Any, tmp_path: Path) -> None:
    """89,902,357 is the position of a usable frame, and the flag of the second frame makes its position not usable."""
    readings = [encoder.decode(GOOD), NoReplyError("no reply within 50 ms"), encoder.decode(SPOILT)]
    for name in ("log.csv", "log.jsonl", "log.parquet"):
        assert record(encoder, tmp_path / name, *readings) == (3, 1)
    header, *rows = csv.reader((tmp_path / "log.csv").read_text("utf-8").splitlines())
    assert header == ["time", "position", "verdict", "reports", "error"]
    assert [row[1:] for row in rows] == [
        ["89902357", "usable", "", ""],
        ["", "", "", "no reply"],
        ["", "not_usable", "error", ""],
    ]
    times = [float(row[0]) for row in rows]
    assert times == sorted(times)
    objects = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text("utf-8").splitlines()]
    assert [reading["position"] for reading in objects] == [89902357, None, None]
    assert [reading["error"] for reading in objects] == ["", "no reply", ""]
    parquet = pytest.importorskip("pyarrow.parquet")
    assert parquet.read_table(tmp_path / "log.parquet").to_pylist() == objects


def test_readings_keep_their_interval(encoder: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every 10 ms, although a reading takes 4 ms.

    The third reading takes 25 ms: the next readings are counted from its end.
    """
    now = 0.0

    def advance(seconds: float) -> None:
        nonlocal now
        now += seconds

    class SlowReader:
        durations = iter((0.004, 0.004, 0.025, 0.004, 0.004))

        def read(self) -> Any:
            advance(next(self.durations))
            return encoder.decode(GOOD)

    monkeypatch.setattr(monitor, "monotonic", lambda: now)
    monkeypatch.setattr(monitor, "sleep", advance)
    with open_recorder(str(tmp_path / "log.jsonl"), None, force=False) as recorder:
        monitor.watch(SlowReader(), encoder, "COM3", count=5, interval_s=0.01, out=io.StringIO(), recorder=recorder)
    times = [json.loads(line)["time"] for line in (tmp_path / "log.jsonl").read_text("utf-8").splitlines()]
    # The third starts at 20 ms and ends at 45 ms, where the fourth starts, and the fifth follows 10 ms later.
    assert times == pytest.approx([0.004, 0.014, 0.045, 0.049, 0.059])
    assert now == pytest.approx(0.059), "there is no wait after the last reading"


def test_an_existing_file_is_kept(encoder: Any, tmp_path: Path) -> None:
    from codewheel_runtime.errors import UsageError

    (tmp_path / "log.csv").write_text("mine")
    with pytest.raises(UsageError, match="already exists"):
        record(encoder, tmp_path / "log.csv", encoder.decode(GOOD))
    assert (tmp_path / "log.csv").read_text() == "mine"


def test_more_rows_than_one_group(encoder: Any, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    record(encoder, tmp_path / "log.parquet", *[encoder.decode(GOOD)] * 5000)
    table = parquet.read_table(tmp_path / "log.parquet")
    assert table["position"].to_pylist() == [89902357] * 5000


def test_without_a_terminal_only_the_count_is_printed(encoder: Any) -> None:
    out = io.StringIO()
    readings = Readings(encoder.decode(GOOD), NoReplyError("no reply within 50 ms"))
    monitor.watch(readings, encoder, "a port", count=2, out=out)
    assert out.getvalue() == "1 of 2 readings failed: 1 no reply; the last error: no reply within 50 ms\n"


def test_an_encoder_that_never_answers_is_an_error(encoder: Any) -> None:
    readings = Readings(*[NoReplyError("no reply")] * 20)
    with pytest.raises(NoReplyError):
        monitor.watch(readings, encoder, "a port", out=io.StringIO())


@pytest.mark.slow
@pytest.mark.parametrize("options", [[], ["-o", "log.csv"]])
def test_the_command_needs_no_numpy(
    generated_python: tuple[Path, ModuleType], tmp_path: Path, options: list[str]
) -> None:
    (tmp_path / "numpy.py").write_text("raise ModuleNotFoundError(name='numpy')")
    command = [sys.executable, "-m", "lika_encoders", "monitor", "AMM5A23/65KJP1", "missing-port", *options]
    environment = {"PYTHONPATH": python_path(generated_python[0])}
    completed = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert completed.stderr.startswith("lika-encoders: cannot open missing-port: No such file or directory")
    assert completed.returncode == 1
