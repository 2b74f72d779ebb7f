"""The live view of an encoder: the display on a terminal, and one line per reading elsewhere."""

from __future__ import annotations

import io
import itertools
from typing import Any

import pytest
from codewheel_runtime.commands import monitor

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


def test_elsewhere_each_reading_is_a_line(encoder: Any) -> None:
    out = io.StringIO()
    quarter = encoder.encode_many({"position": [0, 1 << 19]}).tolist()
    readings = Readings(*map(encoder.decode, quarter))
    monitor.watch(readings, encoder, "a port", count=2, out=out)
    lines = out.getvalue().splitlines()
    assert lines[0].endswith(" 0 counts 0.00000° - usable")
    # A quarter of a revolution in 0.25 s.
    assert lines[1].endswith(" 524288 counts 90.00000° 60.000 rpm usable")
    assert lines[2] == "0 of 2 readings failed"


def test_an_encoder_that_never_answers_is_an_error(encoder: Any) -> None:
    readings = Readings(*[NoReplyError("no reply")] * 20)
    with pytest.raises(NoReplyError):
        monitor.watch(readings, encoder, "a port", out=io.StringIO())
