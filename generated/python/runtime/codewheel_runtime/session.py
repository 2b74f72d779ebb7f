# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Requests and replies over RS-485, without I/O: timeouts, resynchronization and retries.

The methods of a :class:`Session` are generators that yield each action as an :class:`Ask`, and receive the bytes that
arrived. ``link`` carries them out on any transport, such as a serial port, and ``link_async`` does the same for
asyncio.

Replies have no sequence number that matches them to requests, and their 8-bit CRC misses 1 in 256 corrupted frames.
Therefore, the session accepts a reply only if it is a valid frame that begins with the first byte of its request, and
no other reply to such a request arrives with it. After any failure, it resynchronizes: it sends a request of another
kind, and discards everything that precedes the reply. In this way, late replies are not mistaken for the reply to the
next request. If requests of other kinds also get no reply, it waits for four timeouts, so that only an even later reply
could be mistaken for another.

An extra reply, such as a second copy, must not be mistaken for the reply to the next request. Therefore, the line must
be quiet for the time ``settle_s`` before a reply is returned. If the extra reply arrives in this time, it is discarded.
If it arrives later, it comes shortly before or after the reply to the next request. If the two differ, neither is used,
and the request is repeated. For this, ``settle_s`` must be at least the time from a request to the end of its reply, as
seen by the program, including the latency of a serial adapter that collects bytes. Therefore, the default follows the
measured times.

The reply to a write can be identical to the request, and therefore to its echo. Read back what you write.

Not yet tested on hardware.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from math import inf
from time import monotonic
from typing import Any, NamedTuple, TypeVar, cast

from .codec import shorten, whole_number
from .encoder import Encoder, Frame, PositionFrame
from .errors import InterfaceError
from .link_errors import (
    BusyError,
    DisturbedError,
    LinkError,
    NoReplyError,
    NotUsableError,
    PortError,
    SecondDeviceError,
    WrongEncoderError,
)
from .quiet_times import QuietTimes
from .replies import FoundReply, PendingRequest, find_reply, split_replies
from .reply_counter import ReplyCounter, Statistics
from .reports import Interface
from .running import StepError, check_steps
from .session_failures import FailureExplainer
from .session_requests import SessionRequests, format_hex, load_rs485_facts
from .steps import Send, Step, Wait

__all__ = [
    "Ask",
    "BusyError",
    "DisturbedError",
    "LinkError",
    "NoReplyError",
    "NotUsableError",
    "PortError",
    "SecondDeviceError",
    "Session",
    "Statistics",
    "Work",
    "WrongEncoderError",
    "load_rs485_facts",
]

_Result = TypeVar("_Result")

#: Number of bytes after which a session stops looking for a reply.
_MOST_BYTES = 1024
#: Seconds that a memory may be busy, and seconds between two attempts.
_BUSY_S, _BUSY_PAUSE_S = 1.0, 0.001
#: Number of timeouts after which late replies are no longer expected.
_TIMEOUTS_OF_LATE_REPLIES = 4
#: Number of request kinds that ``settle_s=0`` requires.
_KINDS_OF_REQUESTS_NEEDED = 3


class Ask(NamedTuple):
    """Action of a session: send ``send``, then return the bytes that arrive.

    All bytes that have arrived are returned. If no bytes have arrived, wait for the first byte for at most ``wait_s``
    seconds.
    """

    send: bytes
    wait_s: float


#: Task of a session: it yields actions, receives the bytes that arrived, and returns a result.
Work = Generator[Ask, bytes, _Result]


class Session:
    """Requests and replies of one encoder, without I/O.

    Args:
        encoder: The encoder, with RS-485.
        timeout_s: Time in seconds within which a reply must be complete. The manuals give no reply time. The default
            allows for the latency of USB adapters.
        retries: Number of further attempts after a failure.
        settle_s: Time in seconds for which the line must be quiet after a reply. The default is 0.25 ms plus the time
            that the request and the reply take at the baud rate, or the usual time of the last replies if that is
            longer. With 0, a request of another kind is sent before each request instead, so an extra reply can be
            mistaken for the reply to at most one other request, and a second device is not detected.
        clock: Function that returns the time in seconds.

    Attributes:
        requests: Requests of the encoder.

    Raises:
        InterfaceError: The encoder has a different interface.
        TypeError: A time is not a number, or ``retries`` is not an integer.
        ValueError: A time or ``retries`` is negative, or ``settle_s`` is 0 but the encoder has too few kinds of
            requests for it.
    """

    def __init__(
        self,
        encoder: Encoder,
        *,
        timeout_s: float = 0.05,
        retries: int = 3,
        settle_s: float | None = None,
        clock: Callable[[], float] = monotonic,
    ) -> None:
        if encoder.interface is not Interface.RS485:
            raise InterfaceError(encoder.code, encoder.interface, Interface.RS485)
        _check_seconds("timeout_s", timeout_s)
        _check_seconds("settle_s", 0.0 if settle_s is None else settle_s)
        if whole_number("retries", retries) < 0:
            raise ValueError(f"retries must be at least 0, got {retries}")
        self.timeout_s, self.retries, self.settle_s, self.clock = timeout_s, retries, settle_s, clock
        self.requests = SessionRequests(encoder)
        self._failures = FailureExplainer(self.requests)
        self._counter = ReplyCounter(self.requests, has_time_to_settle=settle_s != 0)
        self._capture_controls = [kind.control for kind in self.requests.captures]
        if settle_s == 0 and len(self._capture_controls) < _KINDS_OF_REQUESTS_NEEDED:
            raise ValueError(f"settle_s must be more than 0, because {encoder.code} has too few kinds of requests")
        self._quiet_times = QuietTimes(load_rs485_facts(encoder).port, settle_s)
        #: First byte of the last request (its control byte), if the request failed. Otherwise 0.
        self._failed_control = 0
        self._last_request: PendingRequest | None = None

    @property
    def encoder(self) -> Encoder:
        """The encoder."""
        return self.requests.encoder

    @property
    def statistics(self) -> Statistics:
        """Counters, for instance of extra replies."""
        return self._counter.statistics

    def position(self, request: Any = None) -> Work[int]:
        """Request a frame and return its position in counts.

        ``request`` is the request, or None for the request with factory defaults.

        Raises:
            NotUsableError: The encoder reports that its position is not usable.
            LinkError: There is no valid reply, or no such request.
        """
        frame = yield from self.read(request)
        value = frame.usable_position
        if value is None:
            # The reports that lead to the verdict explain it. The first sentence of each is enough.
            meanings = (report.meaning for report in frame.reports if report.makes_position is frame.verdict)
            first_sentences = (meaning.partition(". ")[0] for meaning in meanings)
            reasons = "; ".join(first_sentences) or frame.verdict.value
            raise NotUsableError(f"the position of {self.encoder.code} is not usable: {reasons}", frame)
        return value

    def read(self, request: Any = None) -> Work[PositionFrame]:
        """Request a frame with the position, and return it. ``request`` is None for the request with factory defaults.

        Raises:
            LinkError: There is no valid reply, the request has no defaults, or no reply contains the position.
        """
        position_request = self.requests.make_position_request() if request is None else request
        frame = yield from self.exchange(position_request)
        return cast(PositionFrame, frame)

    def exchange(self, request: Any) -> Work[Frame]:
        """Send a request, and return the reply to it. A request to a busy memory is repeated for one second.

        Raises:
            BusyError: The memory stayed busy.
            DisturbedError: A value in the reply, such as the address, differs from that in the request.
            LinkError: There is no valid reply, or no such request.
        """
        pending = self.requests.prepare(request)
        kind = pending.kind
        deadline = self.clock() + _BUSY_S
        while True:
            reply = yield from self._send_with_retries(pending)
            frame = cast(Frame, pending.decode(reply))
            # The flags in the reply of a memory show that it is busy.
            is_busy = kind.purpose in ("read", "write") and any(getattr(frame, name) for name in kind.flags)
            if not is_busy:
                difference = self.requests.find_difference(pending, frame)
                if difference:
                    raise DisturbedError(difference)
                return frame
            if self.clock() > deadline:
                raise BusyError(f"the memory of {self.encoder.code} stayed busy for {_BUSY_S:g} s", reply)
            yield from self.pause(_BUSY_PAUSE_S)

    def run(self, steps: Sequence[Step]) -> Work[None]:
        """Carry out the steps of a procedure. If a request in a series fails, the series is restarted.

        Raises:
            StepError: A step failed, or is neither a request nor a wait.
            TypeError: ``steps`` contains something else. Nothing was sent.
        """
        check_steps(steps)
        for index, step in enumerate(steps):
            try:
                if isinstance(step, Wait):
                    yield from self.pause(step.microseconds / 1e6)
                elif isinstance(step, Send):
                    yield from self._send_series(step)
                else:
                    raise LinkError(f"RS-485 has no registers for {type(step).__name__}")
            except LinkError as error:
                raise StepError(step, index, tuple(steps[:index]), (), str(error)) from error

    def pause(self, seconds: float) -> Work[None]:
        """Wait for this time, and discard all bytes that arrive.

        The last of these bytes are searched for extra replies. Raises SecondDeviceError if a second device seems to
        answer.
        """
        deadline = self.clock() + seconds
        discarded = b""
        while (remaining_s := deadline - self.clock()) > 0:
            further_bytes = yield Ask(b"", remaining_s)
            discarded = (discarded + further_bytes)[-_MOST_BYTES:]
        self._counter.count_discarded(discarded, self._last_request)

    def drain(self) -> Work[None]:
        """Discard all bytes that have arrived, until the line is quiet.

        Raises SecondDeviceError if a second device seems to answer.
        """
        yield from self._discard_arrived_bytes()

    def _send_series(self, step: Send) -> Work[None]:
        """Send a request several times in succession, and start again from the first one after a failure.

        The encoder acts after ``step.times`` equal requests in a row. After more than ``retries`` failures, the last
        error is raised.
        """
        pending = self.requests.prepare(step.request)
        attempts_left = self.retries
        sent_count = 0
        while sent_count < step.times:
            try:
                # Within the series, a request of another kind would end the count of the encoder.
                yield from self._send_in_step(pending, is_first=sent_count == 0)
                yield from self.pause(step.every_us / 1e6)
                sent_count += 1
            except LinkError:
                if not attempts_left:
                    raise
                # The request of another kind that follows also ends the count of the encoder.
                attempts_left -= 1
                sent_count = 0

    def _send_with_retries(self, pending: PendingRequest) -> Work[bytes]:
        """Send a request, repeat it after at most ``retries`` failures, and return the reply.

        Raises the error of the last attempt. SecondDeviceError is raised at once, because another attempt would not
        help.
        """
        attempts_left = self.retries
        while True:
            try:
                return (yield from self._send_in_step(pending))
            except SecondDeviceError:
                raise
            except LinkError:
                if not attempts_left:
                    raise
                attempts_left -= 1

    def _send_in_step(self, pending: PendingRequest, *, is_first: bool = True) -> Work[bytes]:
        """Send a request once, after the replies are in step with the requests, and return the reply.

        If the previous request failed, or if ``settle_s`` is 0, the session first resynchronizes. If ``settle_s`` is
        0, this is skipped for a request that continues a series (``is_first`` is False).
        """
        control = pending.data[0]
        if self._failed_control:
            yield from self._resynchronize(self._failed_control)
        elif self.settle_s == 0 and is_first:
            yield from self._resynchronize(control)
        # The request counts as failed until its reply has arrived.
        self._failed_control = control
        reply = yield from self._send_once(pending)
        self._failed_control = self._failures.suspicious_replies = 0
        return reply

    def _resynchronize(self, control: int) -> Work[None]:
        """Get a reply to a request of another kind than ``control``, and discard it.

        All earlier replies come before it.

        ``control`` is the first byte of a request. If there is no reply to any other kind, wait for four timeouts.
        """
        # The kinds take turns, so that a late reply to an earlier request of another kind is not taken for the reply to
        # this request.
        self._capture_controls = self._capture_controls[1:] + self._capture_controls[:1]
        for other_control in self._capture_controls:
            if other_control == control:
                continue
            try:
                yield from self._send_once(self.requests.prepare(bytes([other_control])))
            except SecondDeviceError:
                raise
            except LinkError:
                continue
            return
        # No other kind exists, or none was answered. Wait for late replies.
        yield from self.pause(_TIMEOUTS_OF_LATE_REPLIES * self.timeout_s)

    def _send_once(self, pending: PendingRequest) -> Work[bytes]:
        """Send a request once, return the valid reply, and count the result in the statistics."""
        yield from self._discard_arrived_bytes()
        self._last_request = pending
        self.statistics.requests += 1
        try:
            reply = yield from self._receive_reply(pending)
        except LinkError as error:
            self.statistics.failures += 1
            # A reply that has not arrived can still arrive.
            if isinstance(error, NoReplyError):
                self._counter.unanswered += 1
            raise
        except GeneratorExit:
            # The caller was cancelled or interrupted while the reply was on its way.
            self._counter.unanswered += 1
            raise
        self.statistics.replies += 1
        self._counter.recent_replies.append(reply)
        self._counter.unanswered = 0
        return reply

    def _receive_reply(self, pending: PendingRequest) -> Work[bytes]:
        """Send a request, and return the valid reply once the line has been quiet for a time.

        If bytes arrive after a reply, the search starts again, because they can belong to the reply or to another one.
        """
        begin = self.clock()
        deadline = begin + self.timeout_s
        is_time_recorded = False
        received = yield Ask(pending.data, self.timeout_s)
        while True:
            found_reply = find_reply(received, pending, self.requests.kinds)
            if found_reply is not None:
                if not is_time_recorded:
                    self._quiet_times.record_reply(self.clock() - begin)
                    is_time_recorded = True
                quiet_s = self._quiet_times.find_quiet_time(received, found_reply.reply, pending)
                further_bytes = yield Ask(b"", quiet_s)
                if not further_bytes:
                    return self._take_reply(found_reply, received, pending)
            else:
                remaining_s = deadline - self.clock()
                further_bytes = b"" if remaining_s <= 0 else (yield Ask(b"", remaining_s))
            received += further_bytes
            if not further_bytes or len(received) > _MOST_BYTES:
                unused_replies = split_replies(received[:_MOST_BYTES], pending, self.requests.kinds)
                self._counter.count_extra(len(unused_replies))
                raise self._failures.explain(received, pending, self.timeout_s)

    def _take_reply(self, found_reply: FoundReply, received: bytes, pending: PendingRequest) -> bytes:
        """Return the reply among the ``received`` bytes, and count the other replies that arrived with it.

        Raises:
            DisturbedError: Other replies to this kind of request differ from it.
            SecondDeviceError: A second device seems to answer.
        """
        if found_reply.other_replies:
            # Raises the SecondDeviceError.
            self._counter.count_others(found_reply, received)
        else:
            self._counter.requests_with_one_reply += 1
        if not found_reply.is_ambiguous:
            return found_reply.reply
        self.statistics.conflicts += 1
        request_text = f"the request {format_hex(pending.data)} to {self.encoder.code}"
        # Replies to the same kind of request, with other data.
        different_replies = [reply for reply in found_reply.same_request if reply != found_reply.reply]
        replies_text = f"{format_hex(different_replies[0])} and {format_hex(found_reply.reply)}"
        raise DisturbedError(f"two different replies to {request_text}, so neither is used: {replies_text}", received)

    def _discard_arrived_bytes(self) -> Work[None]:
        """Discard the bytes that have arrived since the last request.

        Raises SecondDeviceError if a second device answers.
        """
        # Bytes that have arrived are taken at once. If any have arrived, the line must then be quiet.
        discarded = b""
        quiet_s = 0.0
        for _ in range(_MOST_BYTES):
            further_bytes = yield Ask(b"", quiet_s)
            if not further_bytes:
                break
            discarded = (discarded + further_bytes)[-_MOST_BYTES:]
            # Before the first request, nothing can settle.
            if self._last_request is not None:
                quiet_s = self._quiet_times.find_settle_time(self._last_request)
        self._counter.count_discarded(discarded, self._last_request)


def _check_seconds(name: str, seconds: float) -> None:
    """Raise an error unless a time is a finite, nonnegative number. ``name`` is the name of the argument.

    Raises:
        TypeError: The time is not a number.
        ValueError: The time is negative, infinite or NaN.
    """
    if isinstance(seconds, bool) or not isinstance(seconds, (int, float)):
        raise TypeError(f"{name} must be a number of seconds, got {shorten(seconds)}")
    if not 0 <= seconds < inf:
        raise ValueError(f"{name} must be finite and at least 0, got {seconds}")
