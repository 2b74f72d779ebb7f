# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Requests and replies over RS-485, without I/O: timeouts, resynchronization and retries.

The methods of a :class:`Session` are generators that yield each action as an :class:`Ask`, and receive the bytes that
arrived. ``link`` carries them out with any transport, such as a serial port, and ``link_async`` does so for asyncio.

A reply carries no sequence number to match it to its request, and its 8-bit CRC misses 1 in 256 corrupted frames. So
the session accepts a reply only if it begins with the first byte of its request and is a valid frame, and if no other
reply to such a request arrives with it. After any failure it resynchronizes: it sends a request of another kind, and
discards everything before the reply to that. So late replies are not mistaken for the reply to the next request. If
requests of other kinds get no reply either, it waits four timeouts, so only an even later reply could be mistaken.

An extra reply, such as a second copy, must not be taken for the reply to the next request. So after each reply the line
must be quiet for a time, ``settle_s``, before the reply is returned. If the extra reply arrives in this time, it is
discarded. If it arrives later, it comes shortly before or after the reply to the next request. If the two differ,
neither is used, and the request is repeated. The condition is that ``settle_s`` is not shorter than the time from a
request to the end of its reply, as the program sees it: a serial adapter that collects bytes adds its latency. So the
default follows the measured times.

The reply to a write can be identical to the request, and therefore to its echo. Read back what you write.

Not yet tested on hardware.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum
from functools import partial
from importlib import import_module
from math import inf
from time import monotonic
from typing import Any, NamedTuple, TypeVar, cast, get_args

from .bulk.shape import Shape, holds
from .codec import shorten, whole_number
from .encoder import Encoder, Exchanged, Frame, PositionFrame
from .errors import FrameError, InterfaceError
from .frames.decoders import cached_decoder, raise_error
from .frames.descriptions import find_any_shape
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
from .replies import FoundReply, PendingRequest, ReplyKind, compute_xor, find_error, find_reply, split_replies
from .reports import Interface
from .running import StepError
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

#: Most received bytes that an error prints.
_PRINTED_BYTES = 24
#: Number of bytes after which a session stops looking for a reply.
_MOST_BYTES = 1024
#: Seconds that a memory may be busy, and seconds between two attempts.
_BUSY_S, _BUSY_PAUSE_S = 1.0, 0.001
#: Number of timeouts after which late replies are no longer expected.
_TIMEOUTS_OF_LATE_REPLIES = 4
#: Seconds to wait for more bytes after a reply that follows other bytes.
_QUIET_S = 0.002
#: Seconds within which an encoder begins to reply, for the default of ``settle_s``. The manuals state no reply time.
_TURNAROUND_S = 0.00025
#: Number of kinds of requests that ``settle_s=0`` needs.
_KINDS_OF_REQUESTS_NEEDED = 3
#: Number of replies with which extra replies are compared.
_RECENT_REPLIES = 32
#: Number of replies whose times are kept.
_REPLY_TIMES = 16
#: Number of extra replies with new values that show a second device. One or two can follow from other errors. If they
#: come so late that they are read before the next request, fewer are sufficient.
_FOREIGN_REPLIES, _LATE_FOREIGN_REPLIES = 3, 2
#: Number of consecutive requests that must each get exactly one reply before a second device is ruled out.
_ONE_REPLY_REQUESTS_NEEDED = 2


class Ask(NamedTuple):
    """Action of a session: send ``send``, then return the bytes that arrive.

    All bytes that have arrived are returned. If no bytes have arrived, wait for the first byte for at most ``wait_s``
    seconds.
    """

    send: bytes
    wait_s: float


#: Work of a session: it yields actions, receives the bytes that arrived, and returns a result.
Work = Generator[Ask, bytes, _Result]


@dataclass(slots=True)
class Statistics:
    """Counters of a session.

    Attributes:
        requests: Requests that were sent, including repeated requests and requests of other kinds.
        replies: Requests that got a valid reply.
        failures: Requests that did not.
        late_replies: Replies that arrived after their request had failed.
        extra_replies: Replies that no request asked for, such as second copies.
        conflicts: Requests that got two different replies. They are among the failures.
    """

    requests: int = 0
    replies: int = 0
    failures: int = 0
    late_replies: int = 0
    extra_replies: int = 0
    conflicts: int = 0


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
            taken for the reply to at most one other request, and a second device is not detected.
        clock: Function that returns the time in seconds.

    Attributes:
        statistics: Counters, for instance of extra replies.

    Raises:
        InterfaceError: The encoder has a different interface.
        TypeError: A time is not a number, or ``retries`` is not an integer.
        ValueError: A time or ``retries`` is negative, or ``settle_s`` is 0 although the encoder has too few kinds of
            requests.
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
        self.encoder, self.timeout_s, self.retries, self.clock = encoder, timeout_s, retries, clock
        self.settle_s, self.statistics = settle_s, Statistics()
        self.exchanges = encoder.exchanges()
        self.kinds = {} if self.exchanges else _find_request_kinds(encoder)
        captures = [kind for kind in self.kinds.values() if kind.purpose == "capture"]
        self._capture_controls = [kind.control for kind in captures]
        if settle_s == 0 and len(self._capture_controls) < _KINDS_OF_REQUESTS_NEEDED:
            raise ValueError(f"settle_s must be more than 0, because {encoder.code} has too few kinds of requests")
        port = load_rs485_facts(encoder).port
        # A byte has one start bit.
        bits_per_byte = 1 + port.data_bits + (port.parity != "none") + port.stop_bits
        self._byte_s = bits_per_byte / port.baud
        #: First byte of the last request (its control byte), if the request failed. Otherwise 0.
        self._failed_control = 0
        #: Number of replies in a row that look like replies from another kind of encoder.
        self._suspicious_replies = 0
        #: Last request, and the replies to the last requests. Extra replies are compared with them.
        self._last_request: PendingRequest | None = None
        self._recent_replies: deque[bytes] = deque(maxlen=_RECENT_REPLIES)
        #: Number of extra replies with other values, and of requests in a row that got exactly one reply since then.
        self._foreign_replies = self._requests_with_one_reply = 0
        #: Times in seconds that the last replies took.
        self._reply_times: deque[float] = deque(maxlen=_REPLY_TIMES)
        #: Number of requests whose reply can still arrive.
        self._unanswered = 0
        #: First kind of request whose reply has the position, if there is such a request.
        self._position_kind = next((kind for kind in captures if kind.has_position), None)

    def position(self, request: Any = None) -> Work[int]:
        """Request a frame and return its position in counts.

        ``request`` is the request, None for the one with factory defaults.

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
        position_request = self._make_position_request() if request is None else request
        frame = yield from self.exchange(position_request)
        return cast(PositionFrame, frame)

    def _make_position_request(self) -> Any:
        """Return the request for the position with factory defaults: its byte, or an object of its class.

        Raises:
            LinkError: A value of the request has no default, or no reply contains the position.
        """
        if self._position_kind is not None:
            return bytes([self._position_kind.control])
        for exchange in self.exchanges:
            if exchange.purpose == "position":
                without_default = [name for name in exchange.request._fields if name not in exchange.defaults]
                if without_default:
                    arguments = ", ".join(f"{name}=..." for name in without_default)
                    raise LinkError(f"{self.encoder.code} needs a request: {exchange.request.__name__}({arguments})")
                return exchange.request(**exchange.defaults)
        raise LinkError(f"no reply of {self.encoder.code} contains the whole position")

    def exchange(self, request: Any) -> Work[Frame]:
        """Send a request, and return the reply to it. A request to a busy memory is repeated for one second.

        Raises:
            BusyError: The memory stayed busy.
            DisturbedError: The reply has another value than the request, such as another address.
            LinkError: There is no valid reply, or no such request.
        """
        pending = self._prepare_request(request)
        kind = pending.kind
        deadline = self.clock() + _BUSY_S
        while True:
            reply = yield from self._send_with_retries(pending)
            frame = cast(Frame, pending.decode(reply))
            # The flags in the reply of a memory show that it is busy.
            is_busy = kind.purpose in ("read", "write") and any(getattr(frame, name) for name in kind.flags)
            if not is_busy:
                difference = self._find_difference(pending, frame)
                if difference:
                    raise DisturbedError(difference)
                return frame
            if self.clock() > deadline:
                raise BusyError(f"the memory of {self.encoder.code} stayed busy for {_BUSY_S:g} s", reply)
            yield from self.pause(_BUSY_PAUSE_S)

    def _find_difference(self, pending: PendingRequest, frame: Frame) -> str:
        """Return as text how a reply differs from the values of its request, or an empty string if it does not differ.

        Fields and joined numbers that both have are compared, such as an address. Answers to open questions are
        ignored.
        """
        fields = getattr(pending.request, "_fields", ())
        joins = find_any_shape(pending.request.__class__, self.encoder).joins if fields else ()
        for name in (*fields, *(join.name for join in joins)):
            if name in pending.answers:
                continue
            reply_value = getattr(frame, name, None)
            sent_value = getattr(pending.request, name)
            if reply_value is not None and reply_value != sent_value:
                return f"the reply of {self.encoder.code} has {name} {reply_value}, but {sent_value} was sent"
        return ""

    def run(self, steps: Sequence[Step]) -> Work[None]:
        """Carry out the steps of a procedure. If a request in a series fails, the series starts again.

        Raises:
            StepError: A step failed, or is neither a request nor a wait.
        """
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
        self._count_discarded(discarded)

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
        pending = self._prepare_request(step.request)
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
        """Send a request, again after each of at most ``retries`` failures, and return the reply.

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
        """Send a request once when the replies are in step with the requests, and return the reply.

        If the previous request failed, or if ``settle_s`` is 0, the session first resynchronizes. With ``settle_s`` of
        0, a request that continues a series (``is_first`` is False) is sent without this.
        """
        control = pending.data[0]
        if self._failed_control:
            yield from self._resynchronize(self._failed_control)
        elif self.settle_s == 0 and is_first:
            yield from self._resynchronize(control)
        # The request counts as failed until its reply has arrived.
        self._failed_control = control
        reply = yield from self._send_once(pending)
        self._failed_control = self._suspicious_replies = 0
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
                yield from self._send_once(self._prepare_request(bytes([other_control])))
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
                self._unanswered += 1
            raise
        except GeneratorExit:
            # The caller was cancelled or interrupted while the reply was on its way.
            self._unanswered += 1
            raise
        self.statistics.replies += 1
        self._recent_replies.append(reply)
        self._unanswered = 0
        return reply

    def _receive_reply(self, pending: PendingRequest) -> Work[bytes]:
        """Send a request, and return the valid reply once the line has been quiet for a time.

        Bytes that arrive after a reply start the search again, because they can belong to it or be another reply.
        """
        begin = self.clock()
        deadline = begin + self.timeout_s
        is_time_recorded = False
        received = yield Ask(pending.data, self.timeout_s)
        while True:
            found_reply = find_reply(received, pending, self.kinds)
            if found_reply is not None:
                if not is_time_recorded:
                    self._reply_times.append(self.clock() - begin)
                    is_time_recorded = True
                further_bytes = yield Ask(b"", self._find_quiet_time(received, found_reply.reply, pending))
                if not further_bytes:
                    return self._take_reply(found_reply, received, pending)
            else:
                remaining_s = deadline - self.clock()
                further_bytes = b"" if remaining_s <= 0 else (yield Ask(b"", remaining_s))
            received += further_bytes
            if not further_bytes or len(received) > _MOST_BYTES:
                self._count_extra(len(split_replies(received[:_MOST_BYTES], pending, self.kinds)))
                raise self._failure_error(received, pending)

    def _find_quiet_time(self, received: bytes, reply: bytes, pending: PendingRequest) -> float:
        """Return the time in seconds for which the line must be quiet after a reply.

        This is the time to settle. It is at least 2 ms, unless the reply comes first and cannot be part of an echo.
        """
        # In this time, the reply to this request would follow if the reply were an extra one to an earlier request.
        settle_s = self._find_settle_time(pending)
        # A reply begins with the first byte of its request.
        echo_and_reply = pending.data + pending.data[:1]
        is_first = received.startswith(reply)
        may_be_echo = received.startswith(echo_and_reply)
        # After other bytes or an echo, part of a reply could look like a reply by chance. If the reply can begin with
        # any byte, so could other bytes before it.
        is_certain = pending.kind.repeats_first and is_first and not may_be_echo
        return settle_s if is_certain else max(settle_s, _QUIET_S)

    def _find_settle_time(self, pending: PendingRequest) -> float:
        """Return the time in seconds after which no other reply to an earlier request follows.

        This is the time that the user has chosen. By default, it is the time that the request and the reply take at the
        baud rate, or the usual time of the last replies if that is longer.
        """
        if self.settle_s is not None:
            return self.settle_s
        sent_bytes = len(pending.data) + pending.kind.length
        reply_s: float = _TURNAROUND_S + self._byte_s * sent_bytes
        if not self._reply_times:
            return reply_s
        # Few replies that were much slower than the others do not count. Three in four replies took this long or less.
        times = sorted(self._reply_times)
        third_quartile = times[3 * len(times) // 4]
        return max(reply_s, third_quartile)

    def _take_reply(self, found_reply: FoundReply, received: bytes, pending: PendingRequest) -> bytes:
        """Return the reply among the ``received`` bytes, and count the other replies that arrived with it.

        Raises:
            DisturbedError: Other replies to such a request differ from it.
            SecondDeviceError: A second device seems to answer.
        """
        if found_reply.same_kind or found_reply.other_kinds:
            self._count_other_replies(found_reply, received)
        else:
            self._requests_with_one_reply += 1
        if not found_reply.is_ambiguous:
            return found_reply.reply
        self.statistics.conflicts += 1
        request_text = f"the request {_format_hex(pending.data)} to {self.encoder.code}"
        different_replies = [reply for reply in found_reply.same_kind if reply != found_reply.reply]
        replies_text = f"{_format_hex(different_replies[0])} and {_format_hex(found_reply.reply)}"
        raise DisturbedError(f"two different replies to {request_text}, so neither is used: {replies_text}", received)

    def _count_other_replies(self, found_reply: FoundReply, received: bytes) -> None:
        """Count the replies that arrived together with a reply.

        Raises SecondDeviceError if a second device seems to answer.
        """
        self._requests_with_one_reply = 0
        extra_count = self._count_extra(len(found_reply.same_kind) + len(found_reply.other_kinds))
        # One of the unknown replies of this kind is the reply to this request, so all but one are foreign.
        unknown_replies = {*found_reply.same_kind, found_reply.reply}.difference(self._recent_replies)
        foreign_replies = [*self._list_foreign(found_reply.other_kinds), *sorted(unknown_replies)[1:]]
        # Late replies to failed requests are not extra replies.
        self._count_foreign(foreign_replies[:extra_count], received, _FOREIGN_REPLIES)

    def _list_foreign(self, replies: Sequence[bytes]) -> list[bytes]:
        """Return the replies that equal none of the last replies to requests. They may come from a second device."""
        return [reply for reply in replies if reply not in self._recent_replies]

    def _count_foreign(self, replies: Sequence[bytes], received: bytes, limit: int) -> None:
        """Count replies that may come from a second device. Raise SecondDeviceError if there are ``limit`` of them.

        ``received`` are all bytes that arrived, for the error. If ``settle_s`` is 0, no error is raised.
        """
        self._foreign_replies += len(replies)
        # Without a time to settle, one copy can cause several of them.
        if replies and self._foreign_replies >= limit and self.settle_s != 0:
            count = self._foreign_replies
            code = self.encoder.code
            text = f"{count} extra replies with other values came from the line to {code}, the last one"
            advice = "check whether a second device on the line answers, too"
            raise SecondDeviceError(f"{text} {_format_hex(replies[-1])}; {advice}", received)

    def _discard_arrived_bytes(self) -> Work[None]:
        """Discard the bytes that have arrived since the last request.

        Raises SecondDeviceError if a second device answers.
        """
        # Bytes that have arrived are taken at once. If any have arrived, the line must then be quiet.
        waiting = b""
        quiet_s = 0.0
        for _ in range(_MOST_BYTES):
            more = yield Ask(b"", quiet_s)
            if not more:
                break
            waiting = (waiting + more)[-_MOST_BYTES:]
            # Before the first request, nothing can settle.
            quiet_s = self._find_settle_time(self._last_request) if self._last_request is not None else 0.0
        self._count_discarded(waiting)

    def _count_discarded(self, data: bytes) -> None:
        """Count the replies in discarded bytes, which arrived without a request.

        Raises SecondDeviceError if a second device seems to answer. Two requests in a row that got exactly one reply
        show that there is no such device, so the count of its replies starts again.
        """
        last_request = self._last_request
        replies = split_replies(data, last_request, self.kinds) if last_request is not None else []
        if replies:
            self._requests_with_one_reply = 0
        # The reply of a second device to one request can arrive after the reply to the next one.
        if self._requests_with_one_reply >= _ONE_REPLY_REQUESTS_NEEDED:
            self._foreign_replies = 0
        extra_count = self._count_extra(len(replies))
        foreign_replies = self._list_foreign(replies)[:extra_count]
        self._count_foreign(foreign_replies, data, _LATE_FOREIGN_REPLIES)

    def _count_extra(self, count: int) -> int:
        """Count replies that are not used, and return how many of them are extra replies.

        The first replies, up to the number of unanswered requests, are late replies to these requests. The rest are
        extra.
        """
        late_count = min(count, self._unanswered)
        extra_count = count - late_count
        self._unanswered -= late_count
        self.statistics.late_replies += late_count
        self.statistics.extra_replies += extra_count
        return extra_count

    def _failure_error(self, received: bytes, pending: PendingRequest) -> LinkError:
        """Return the error for received bytes that contain no valid reply. Its class indicates the most likely cause.

        NoReplyError means that nothing, only the echo or only another reply has arrived. WrongEncoderError means that
        two replies in a row look like replies from another kind of encoder. All other causes are a DisturbedError.
        """
        kind = pending.kind
        request_text = f"the request {_format_hex(pending.data)} to {self.encoder.code}"
        ellipsis = " ..." if len(received) > _PRINTED_BYTES else ""
        bytes_text = _format_hex(received[:_PRINTED_BYTES]) + ellipsis
        if not received:
            milliseconds = f"{1000 * self.timeout_s:g} ms"
            text = f"no reply to {request_text} within {milliseconds}; check supply, wires A and B, and baud rate"
            return NoReplyError(text)
        if received == pending.data:
            text = f"only an echo of {request_text}; check the wires to the encoder, and its supply"
            return NoReplyError(text, received)
        if not any(received):
            text = f"the line is low after {request_text}: only 00 arrives; check whether A and B are swapped"
            return DisturbedError(text, received)
        if self.exchanges:
            return self._exchange_error(received, pending, request_text, bytes_text)
        # Why the bytes seem to be from another kind of encoder. Empty if they do not.
        suspicion = self._explain_other_encoder(received, pending)
        # 1 in 256 corrupted replies has a valid CRC, so one odd reply proves nothing.
        self._suspicious_replies = self._suspicious_replies + 1 if suspicion else 0
        if self._suspicious_replies > 1:
            text = (
                f"the reply {bytes_text} to {request_text} is from another kind of encoder: {suspicion}; "
                "check the order code"
            )
            return WrongEncoderError(text, received)
        if received[0] in self.kinds and received[0] != kind.control:
            return NoReplyError(
                f"no reply to {request_text}, but a late one to another request: {bytes_text}", received
            )
        if len(received) < kind.length:
            text = f"incomplete reply to {request_text}: {len(received)} of {kind.length} bytes, {bytes_text}"
            return DisturbedError(text, received)
        return DisturbedError(f"no valid reply to {request_text} in {bytes_text}", received)

    def _exchange_error(
        self, received: bytes, pending: PendingRequest, request_text: str, bytes_text: str
    ) -> LinkError:
        """Return the error for received bytes without a valid reply from an encoder whose requests have no data IDs.

        Its text says that the reply is incomplete, has another value than the request, or is invalid. ``request_text``
        names the request, and ``bytes_text`` contains the received bytes.
        """
        if len(received) < pending.kind.length:
            text = f"incomplete reply to {request_text}: {len(received)} of {pending.kind.length} bytes, {bytes_text}"
            return DisturbedError(text, received)
        last_bytes = received[-pending.kind.length :]
        is_valid_frame = find_error(last_bytes, pending) is None
        difference = self._find_difference(pending, pending.decode(last_bytes)) if is_valid_frame else ""
        return DisturbedError(difference or f"no valid reply to {request_text} in {bytes_text}", received)

    def _explain_other_encoder(self, received: bytes, pending: PendingRequest) -> str:
        """Return why the bytes look like a reply from another kind of encoder, or an empty string if they do not.

        Such bytes begin like a reply and have a valid CRC, but they have another length, or values that this encoder
        does not send.
        """
        begins_like_reply = received[0] == pending.kind.control and len(received) >= 3
        # The CRC is the XOR of the other bytes, so the XOR of all bytes is 0.
        has_valid_crc = compute_xor(received) == 0
        if not begins_like_reply or not has_valid_crc:
            return ""
        if len(received) != pending.kind.length:
            return f"it has a valid CRC, but {len(received)} bytes instead of {pending.kind.length}"
        return str(find_error(received, pending))

    def _prepare_request(self, request: Any) -> PendingRequest:
        """Return a request with its bytes, and with what is needed to find and decode its reply.

        ``request`` is bytes, an object of the encoder's module, or a member of its ``DataId``. Raises LinkError if the
        encoder does not have the request.
        """
        if self.exchanges:
            return self._prepare_exchange(request)
        answers: dict[str, object] = {}
        if isinstance(request, IntEnum):
            # A data ID: the request is its control byte. An unknown data ID has none.
            data = bytes(kind.control for kind in self.kinds.values() if kind.id == request)
        elif isinstance(request, (bytes, bytearray)):
            data = bytes(request)
        elif not hasattr(request, "_fields"):
            # Neither a request nor its bytes.
            data = b""
        else:
            data = request.encode()
            for name in request._fields:
                value = getattr(request, name)
                # Answers to open questions, which the reply needs too.
                if isinstance(value, Enum) and not isinstance(value, IntEnum):
                    answers[name] = value
        request_kind = self.kinds.get(data[0]) if data else None
        if request_kind is None:
            requests = ", ".join(f"{kind.control:02X} ({kind.name})" for kind in self.kinds.values())
            request_text = _format_hex(data) or repr(request)
            raise LinkError(f"{self.encoder.code} has no request '{request_text}'; its requests are {requests}")
        decode = cast(Callable[..., Frame], self.encoder.decode)
        return PendingRequest(request, data, request_kind, partial(decode, **answers), answers)

    def _prepare_exchange(self, object_or_bytes: Any) -> PendingRequest:
        """Return a request of an encoder without data IDs, with what is needed to find and decode its reply.

        ``object_or_bytes`` is an object of the class of a request, or the bytes of a request. The bytes are decoded as
        each kind of request in turn, until one fits. Raises LinkError if they fit no request, or if the encoder does
        not answer it.
        """
        # Empty if the request is an object. Empty bytes fit no kind of request either.
        request_bytes = bytes(object_or_bytes) if isinstance(object_or_bytes, (bytes, bytearray)) else b""
        for exchange in self.exchanges:
            # The request as an object, or None if the bytes are not a request of this kind.
            request: Any = _decode_request(exchange, request_bytes) if request_bytes else object_or_bytes
            if type(request) is not exchange.request:
                continue
            name = exchange.request.__name__
            if exchange.reply is None:
                raise LinkError(f"{self.encoder.code} does not answer {name}: send its bytes with 'send'")
            shape = find_any_shape(exchange.reply, self.encoder)
            sent_bytes = request.encode()
            kind = ReplyKind(
                name=name,
                control=sent_bytes[0],
                id=0,
                purpose=exchange.purpose,
                length=shape.length,
                has_position=exchange.purpose == "position",
                flags=(),
                repeats_first=exchange.repeats_first,
            )
            decode = cached_decoder(exchange.reply._make_decoder, self.encoder, raise_error)
            return PendingRequest(request, sent_bytes, kind, decode)
        requests = ", ".join(exchange.request.__name__ for exchange in self.exchanges)
        request_text = _format_hex(request_bytes) or f"{object_or_bytes!r}"
        raise LinkError(f"{self.encoder.code} has no request '{request_text}'; its requests are {requests}")


def _check_seconds(name: str, seconds: float) -> None:
    """Raise an error unless a time is a finite number that is not negative. ``name`` is the name of the argument.

    Raises:
        TypeError: The time is not a number.
        ValueError: The time is negative, infinite or NaN.
    """
    if isinstance(seconds, bool) or not isinstance(seconds, (int, float)):
        raise TypeError(f"{name} must be a number of seconds, got {shorten(seconds)}")
    if not 0 <= seconds < inf:
        raise ValueError(f"{name} must be finite and at least 0, got {seconds}")


def _decode_request(exchange: Exchanged, data: bytes) -> Any:
    """Return the request that these bytes are, as an object, or None if they are not a request of this kind."""
    try:
        return exchange.request.decode(data)
    except FrameError:
        return None


def _find_request_kinds(encoder: Encoder) -> dict[int, ReplyKind]:
    """Return the requests of an encoder with data IDs, by their first byte.

    This is the control byte of their data ID.
    """
    module: Any = import_module(type(encoder).__module__)
    reply_classes = get_args(module.Reply) or (module.Reply,)
    replies = [(reply_class, find_any_shape(reply_class, encoder)) for reply_class in reply_classes]
    kinds: dict[int, ReplyKind] = {}
    for data_id in load_rs485_facts(encoder).data_ids:
        # Of several classes of replies, the first one that may begin with this byte is the reply.
        fitting_replies = [(reply_class, shape) for reply_class, shape in replies if _may_begin(shape, data_id)]
        if not fitting_replies:
            continue
        reply_class, shape = fitting_replies[0]
        kinds[data_id.control] = ReplyKind(
            name=data_id.name,
            control=data_id.control,
            id=data_id.id,
            purpose=data_id.purpose.value,
            length=shape.length,
            has_position=bool(shape.position) and hasattr(reply_class, "usable_position"),
            flags=tuple(column.name for column in shape.columns if column.kind == "flag"),
        )
    return kinds


def _may_begin(shape: Shape, data_id: Any) -> bool:
    """Return whether a reply with this shape may begin with the control byte of a data ID.

    The constants in its first byte must match the control byte, and a field of data IDs must allow this data ID.
    """
    for check in shape.checks:
        is_in_first_byte = check.low + check.width <= 8
        if is_in_first_byte and not holds(data_id.control, check):
            return False
    for column in shape.columns:
        begins_in_first_byte = column.low < 8
        allowed_values = column.values
        if begins_in_first_byte and allowed_values and data_id.id not in allowed_values:
            return False
    return True


def load_rs485_facts(encoder: Encoder) -> Any:
    """Return the facts about the RS-485 interface of an encoder."""
    return import_module(type(encoder).__module__).RS485


def _format_hex(data: bytes) -> str:
    """Return bytes as text, such as ``1A 2B``."""
    return data.hex(" ").upper()
