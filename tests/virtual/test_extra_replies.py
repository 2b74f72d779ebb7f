"""Replies that arrive twice, and a second device that answers, in virtual time: no position of an earlier request.

The line is a model of its own. The line has the transmission times of 2.5 Mbaud and a turnaround, but no virtual
encoder.
"""

from __future__ import annotations

import itertools
import random
import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

Package = tuple[Path, ModuleType]
CODE = "AMM5A23/65KJP1"
#: Seconds that a byte takes at 2.5 Mbaud, with its start bit and stop bit, and from a request to its reply.
BYTE_S = 10 / 2_500_000
TURNAROUND_S = 10e-6
#: Replies by the first byte of their request: the number of bytes between that byte and the CRC.
LENGTHS = {0x02: 4, 0x8A: 4, 0x92: 2, 0x1A: 9}


def reply_to(control: int, position: int) -> bytes:
    """Return the reply of AMM5, section 7.2 of its manual: control, status, data, and the XOR of all bytes."""
    singleturn = position.to_bytes(3, "little")
    data = {
        0x02: bytes(1) + singleturn,
        0x8A: bytes(4),
        0x92: bytes([0, 0x23]),
        0x1A: bytes(1) + singleturn + bytes([0x23]) + bytes(4),
    }[control]
    assert len(data) == LENGTHS[control]
    reply = bytes([control]) + data
    crc = 0
    for byte in reply:
        crc ^= byte
    return reply + bytes([crc])


class Line:
    """Line with one encoder whose position is the number of the request.

    Args:
        extra: Function that returns, for each reply, the gap in seconds between it and a second copy, or None.
        second: Gap in seconds between a reply and that of a second device, or None if there is no such device.
        splits: Let some replies arrive in two parts.
        turnaround: Time in seconds from a request to the start of its reply.
    """

    def __init__(
        self,
        extra: Callable[[], float | None] = lambda: None,
        second: float | None = None,
        *,
        splits: bool = False,
        turnaround: float = TURNAROUND_S,
    ) -> None:
        self.now, self.requests, self.extras, self.last = 0.0, 0, 0, 0
        self.turnaround, self._busy_until = turnaround, 0.0
        self.extra, self.second, self.splits = extra, second, splits
        self.chance = random.Random(51)
        self._arrivals: list[tuple[float, int, bytes]] = []

    def clock(self) -> float:
        return self.now

    def write(self, data: bytes) -> None:
        self.requests += 1
        if data[0] == 0x1A:
            self.last = self.requests % (1 << 23)
        reply = reply_to(data[0], self.requests % (1 << 23))
        # The encoder answers one request after the other.
        end = max(self.now + BYTE_S + self.turnaround, self._busy_until) + BYTE_S * len(reply)
        self._busy_until = end
        self._put(end, reply)
        delay = self.extra()
        if delay is not None:
            self.extras += 1
            self._put(end + delay + BYTE_S * len(reply), reply)
        if self.second is not None:
            other_reply = reply_to(data[0], (1 << 22) + self.requests)
            self._put(end + self.second + BYTE_S * len(reply), other_reply)

    def read(self, wait_s: float) -> bytes:
        end = self.now + wait_s
        if not self._arrivals or self._arrivals[0][0] > end:
            self.now = end
            return b""
        self.now = max(self.now, self._arrivals[0][0])
        data = b""
        while self._arrivals and self._arrivals[0][0] <= self.now:
            data += self._arrivals.pop(0)[2]
        return data

    def do(self, work: Any) -> Any:
        """Carry out work of a session, and return its result."""
        try:
            ask = next(work)
            while True:
                if ask.send:
                    self.write(ask.send)
                ask = work.send(self.read(ask.wait_s))
        except StopIteration as done:
            return done.value

    def _put(self, at: float, data: bytes) -> None:
        cut = self.chance.randrange(1, len(data)) if self.splits and self.chance.random() < 0.2 else len(data)
        self._arrivals.append((at - BYTE_S * (len(data) - cut), len(self._arrivals), data[:cut]))
        if data[cut:]:
            self._arrivals.append((at, len(self._arrivals), data[cut:]))
        self._arrivals.sort(key=lambda arrival: arrival[0])


def session_on(lika: Any, line: Line, **more: Any) -> Any:
    from codewheel_runtime.session import Session

    return Session(lika.lookup(CODE), clock=line.clock, **more)


class CutReplies(Line):
    """Line on which half of each reply arrives after 30 ms, and then nothing."""

    def write(self, data: bytes) -> None:
        reply = reply_to(data[0], 1)
        self._put(self.now + 0.03, reply[: len(reply) // 2])


def count_stale(line: Line, session: Any, count: int) -> int:
    """Return how many of this many positions belong to an earlier request."""
    stale = 0
    for _ in range(count):
        position = line.do(session.position())
        stale += position != line.last
    return stale


def test_one_copy_does_not_shift_the_replies(generated_python: Package) -> None:
    """One reply is sent twice, 0.5 ms apart, and the next requests follow without a pause."""
    replies = iter(range(1, 1 << 30))
    line = Line(lambda: 0.0005 if next(replies) == 100 else None)
    assert count_stale(line, session_on(generated_python[1], line), 2000) == 0
    assert line.extras == 1


def copies(rate: float, longest_s: float, seed: int = 1) -> Callable[[], float | None]:
    """Return a function that gives this share of replies a copy after at most this time."""
    chance = random.Random(seed)
    return lambda: chance.uniform(0, longest_s) if chance.random() < rate else None


@pytest.mark.one_in(3, "slow")
@pytest.mark.parametrize("splits", [False, True])
@pytest.mark.parametrize("turnaround", [TURNAROUND_S, 0.001, 0.004])
def test_copies_at_any_time(generated_python: Package, turnaround: float, splits: bool) -> None:
    """One reply in fifty is sent twice, with a gap of 0 to 5 ms, and the encoder or an adapter can be slow."""
    line = Line(copies(0.02, 0.005), splits=splits, turnaround=turnaround)
    session = session_on(generated_python[1], line)
    assert count_stale(line, session, 3000) == 0
    assert line.extras > 40
    # A copy can still be on its way at the end, and a copy that arrives in two parts is not always recognised.
    assert line.extras - 1 - 10 * splits <= session.statistics.extra_replies <= line.extras


@pytest.mark.parametrize("splits", [False, True])
def test_each_copy_is_counted(generated_python: Package, splits: bool) -> None:
    """The copies of 11 bytes are complete while the line settles, 250 us and 4 us for each of 12 bytes."""
    line = Line(copies(0.05, 0.00025 + BYTE_S), splits=splits)
    session = session_on(generated_python[1], line)
    assert count_stale(line, session, 2000) == 0
    statistics = session.statistics
    assert statistics.extra_replies == line.extras > 70
    assert (statistics.requests, statistics.replies) == (line.requests, 2000)
    assert (statistics.failures, statistics.late_replies, statistics.conflicts) == (0, 0, 0)


def test_the_price(generated_python: Package) -> None:
    """At least 2,500 positions a second with the default, and nothing but the positions is requested."""
    line = Line()
    assert count_stale(line, session_on(generated_python[1], line), 2500) == 0
    assert line.now < 1
    assert line.requests == 2500


def test_many_copies_are_not_a_second_device(generated_python: Package) -> None:
    """One reply in ten is sent twice, 0.5 ms apart: each copy arrives with the reply to a later request."""
    chance = random.Random(2)
    line = Line(lambda: 0.0005 if chance.random() < 0.1 else None)
    assert count_stale(line, session_on(generated_python[1], line), 3000) == 0
    assert line.extras > 250


def test_cancelled_requests_are_not_a_second_device(generated_python: Package) -> None:
    """Five requests are cancelled before their replies arrive, as Ctrl-C and a timeout of asyncio do."""
    line = Line(turnaround=0.0002)
    session = session_on(generated_python[1], line)
    for _ in range(5):
        cancelled = session.position()
        ask = next(cancelled)
        while not ask.send:
            ask = cancelled.send(line.read(ask.wait_s))
        line.write(ask.send)
        cancelled.close()
        assert line.do(session.position()) == line.last
    assert (session.statistics.extra_replies, session.statistics.late_replies) == (0, 5)


@pytest.mark.one_in(3, "slow")
@pytest.mark.parametrize("longest_s", [0.00002, 0.0001, 0.001])
def test_without_a_time_to_settle(generated_python: Package, longest_s: float) -> None:
    """Requests of another kind between those for the position: at most one stale position for each copy."""
    line = Line(copies(0.05, longest_s))
    assert count_stale(line, session_on(generated_python[1], line, settle_s=0), 2000) <= line.extras
    assert line.extras > 70
    assert line.requests >= 4000


def test_requests_of_other_kinds_take_turns(generated_python: Package) -> None:
    """With the same kind each time, a shift by a whole cycle of two requests would stay."""
    line, sent = Line(), list[int]()
    write = line.write
    line.write = lambda data: (sent.append(data[0]), write(data))[1]  # type: ignore[method-assign]
    count_stale(line, session_on(generated_python[1], line, settle_s=0), 30)
    assert sent[1::2] == [0x1A] * 30
    others = sent[::2]
    assert set(others) == {0x02, 0x8A, 0x92}
    assert sum(other == following for other, following in itertools.pairwise(others)) <= len(others) // 3


def test_a_pause_that_the_user_chooses(generated_python: Package) -> None:
    """A copy that arrives during a pause between requests is counted before the next request."""
    line = Line(lambda: 0.002)
    session = session_on(generated_python[1], line, settle_s=0.001)
    for done in range(1, 10):
        assert line.do(session.position()) == line.last == done
        line.now += 0.01
    assert session.statistics.extra_replies == 8


@pytest.mark.parametrize("second", [0.0, 0.0001, 0.0003, 0.0005, 0.002])
@pytest.mark.parametrize("pause_s", [0.0, 0.01])
@pytest.mark.parametrize("retries", [0, 3])
def test_a_second_device_is_an_error(generated_python: Package, second: float, pause_s: float, retries: int) -> None:
    """Another encoder, at another position, answers each request too, and replies of other kinds are the same."""
    from codewheel_runtime.link import DisturbedError, SecondDeviceError

    line = Line(second=second)
    session = session_on(generated_python[1], line, retries=retries)
    error: Exception = RuntimeError()
    # If the other encoder is slow, a few requests are over when its first reply arrives.
    calls = 3 + int(second / 0.0003)
    while calls and not isinstance(error, SecondDeviceError):
        try:
            assert line.do(session.position()) == line.last
        except (DisturbedError, SecondDeviceError) as failure:
            error = failure
        line.now += pause_s
        calls -= 1
    assert isinstance(error, SecondDeviceError)
    text = r"^\d+ extra replies with other values came from the line to AMM5A23/65KJP1, the last one [0-9A-F ]+; "
    assert re.search(text + "check whether a second device on the line answers, too$", str(error))


@pytest.mark.parametrize("line", [Line(turnaround=10.0), CutReplies()], ids=["silent", "cut"])
def test_a_request_without_a_whole_reply_ends_after_its_timeout(generated_python: Package, line: Line) -> None:
    from codewheel_runtime.link_errors import LinkError

    session = session_on(generated_python[1], line, timeout_s=0.1, retries=0)
    with pytest.raises(LinkError):
        line.do(session.position())
    assert line.now == pytest.approx(0.1)


def test_values_of_the_parameter(generated_python: Package) -> None:
    line = Line()
    for name in ("settle_s", "timeout_s"):
        for wrong in (-1e-9, float("nan"), float("inf")):
            with pytest.raises(ValueError, match=f"{name} must be finite and at least 0, got "):
                session_on(generated_python[1], line, **{name: wrong})
        with pytest.raises(TypeError, match=f"{name} must be a number of seconds, got True"):
            session_on(generated_python[1], line, **{name: True})
    with pytest.raises(ValueError, match="retries must be at least 0, got -1"):
        session_on(generated_python[1], line, retries=-1)
    with pytest.raises(TypeError, match=r"retries must be an integer, got 1\.5"):
        session_on(generated_python[1], line, retries=1.5)
