# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Requests and replies over RS-485, without I/O: time-outs, resynchronisation and retries.

The methods of a :class:`Session` are generators that yield each action as an :class:`Ask`, and receive the bytes that
arrived. ``link`` carries them out with any transport, such as a serial port, and ``link_async`` does so for asyncio.

A reply carries no sequence number to match it to its request, and its 8-bit CRC misses 1 in 256 corrupted frames. So
the session accepts a reply only if it begins with the first byte of its request, is a valid frame, and is the last that
arrived. After any failure it resynchronises: it sends a request of another kind, and discards everything before the
reply to that. So late replies that follow a failure are not mistaken for the reply to the next request. If requests of
other kinds get no reply either, it waits four time-outs, so only an even later reply could be mistaken.

One reply too many is not a failure. If a second copy of a reply arrives after the session has taken the first, and the
next request follows at once, each reply is taken for the one to the request after its own, until a failure. A pause
between the requests that is longer than the delay of the copy avoids this.

The reply to a write can be identical to the request, and therefore to its echo. Read back what you write.

Not yet tested on hardware.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from enum import Enum, IntEnum
from functools import partial
from importlib import import_module
from time import monotonic
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar, cast, get_args

from .bulk.shape import holds
from .encoder import Encoder, Exchanged, Frame, PositionFrame
from .errors import CrcError, FrameError, InterfaceError
from .frames.decoders import decoder, raised
from .frames.descriptions import any_shape
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
    "Session",
    "Work",
    "WrongEncoderError",
    "rs485_facts",
]

_Result = TypeVar("_Result")

#: Number of bytes after which a session stops looking for a reply.
_MOST_BYTES = 1024
#: Seconds that a memory may be busy, and seconds between two attempts.
_BUSY_S, _BUSY_PAUSE_S = 1.0, 0.001
#: Number of time-outs after which no late reply is expected any more.
_LATE = 4
#: Seconds to wait for more bytes after a reply that follows other bytes.
_QUIET_S = 0.002


class LinkError(RuntimeError):
    """A link failed.

    Attributes:
        received: Bytes that arrived in the last attempt.
    """

    def __init__(self, message: str, received: bytes = b"") -> None:
        super().__init__(message, received)
        self.received = received

    def __str__(self) -> str:
        return str(self.args[0])


class PortError(LinkError):
    """The port does not exist, cannot be opened, or was closed."""


class NoReplyError(LinkError):
    """Nothing arrived in time, or only the echo of the request."""


class DisturbedError(LinkError):
    """Bytes arrived, but they are not a valid reply."""


class WrongEncoderError(LinkError):
    """The replies are from a different kind of encoder."""


class BusyError(LinkError):
    """The memory of the encoder stayed busy."""


class NotUsableError(LinkError):
    """The encoder reports that its position is not usable.

    Attributes:
        frame: The frame, with its ``reports``.
    """

    def __init__(self, message: str, frame: PositionFrame) -> None:
        super().__init__(message)
        self.frame = frame


class Ask(NamedTuple):
    """Action of a session: send ``send``, then return the bytes that arrive.

    All bytes that have arrived are returned. If there are none, wait for the first for at most ``wait_s`` seconds.
    """

    send: bytes
    wait_s: float


#: Work of a session: it yields actions, receives the bytes that arrived, and returns a result.
Work = Generator[Ask, bytes, _Result]


class _Kind(NamedTuple):
    """Request, by its first byte, and its reply. ``flags`` are the names of the flags in the reply."""

    name: str
    control: int
    id: int
    purpose: str
    length: int
    has_position: bool
    flags: tuple[str, ...]
    repeats_first: bool = True


class _PendingRequest(NamedTuple):
    """Request, its bytes on the line, the decoder of its reply, and the answers to open questions that it needs."""

    request: Any
    data: bytes
    kind: _Kind
    decode: Callable[[bytes], Any]
    answers: Mapping[str, object] = MappingProxyType({})


class Session:
    """Requests and replies of one encoder, without I/O.

    Args:
        encoder: The encoder, with RS-485.
        timeout_s: Time in seconds in which a reply must be complete. The manuals give no reply time. The default allows
            for the latency of USB adapters.
        retries: Number of further attempts after a failure.
        clock: Function that returns the time in seconds.

    Raises:
        InterfaceError: The encoder has a different interface.
    """

    def __init__(
        self, encoder: Encoder, *, timeout_s: float = 0.05, retries: int = 3, clock: Callable[[], float] = monotonic
    ) -> None:
        if encoder.interface is not Interface.RS485:
            raise InterfaceError(encoder.code, encoder.interface, Interface.RS485)
        self.encoder, self.timeout_s, self.retries, self.clock = encoder, timeout_s, retries, clock
        self.exchanges = encoder.exchanges()
        self.kinds = {} if self.exchanges else _request_kinds(encoder)
        captures = [kind for kind in self.kinds.values() if kind.purpose == "capture"]
        self._marks = [kind.control for kind in captures]
        #: First byte of the last request, if it failed.
        self._failed = 0
        #: Number of replies in a row that look like those of another kind of encoder.
        self._odd_replies = 0
        self._position = next((kind for kind in captures if kind.has_position), None)

    def position(self, request: Any = None) -> Work[int]:
        """Request the position in counts, with ``request`` or with factory defaults."""
        frame = yield from self.read(request)
        value = frame.usable_position
        if value is None:
            meanings = (report.meaning for report in frame.reports if report.makes_position is frame.verdict)
            reasons = "; ".join(text.partition(". ")[0] for text in meanings) or frame.verdict.value
            raise NotUsableError(f"the position of {self.encoder.code} is not usable: {reasons}", frame)
        return value

    def read(self, request: Any = None) -> Work[PositionFrame]:
        """Request a frame with the position, with ``request`` or with factory defaults."""
        frame = yield from self.exchange(self._position_request() if request is None else request)
        return cast(PositionFrame, frame)

    def _position_request(self) -> Any:
        if self._position is not None:
            return bytes([self._position.control])
        for exchange in self.exchanges:
            if exchange.purpose == "position":
                without_default = [name for name in exchange.request._fields if name not in exchange.defaults]
                if without_default:
                    arguments = ", ".join(f"{name}=..." for name in without_default)
                    raise LinkError(f"{self.encoder.code} needs a request: {exchange.request.__name__}({arguments})")
                return exchange.request(**exchange.defaults)
        raise LinkError(f"no reply of {self.encoder.code} contains the whole position")

    def exchange(self, request: Any) -> Work[Frame]:
        """Send a request, and return the reply to it. A request to a busy memory is repeated."""
        pending = self._pending(request)
        kind = pending.kind
        end = self.clock() + _BUSY_S
        while True:
            reply = yield from self._send_with_retries(pending)
            frame = cast(Frame, pending.decode(reply))
            busy = kind.purpose in ("read", "write") and any(getattr(frame, name) for name in kind.flags)
            if not busy:
                differs = self._difference(pending, frame)
                if differs:
                    raise DisturbedError(differs)
                return frame
            if self.clock() > end:
                raise BusyError(f"the memory of {self.encoder.code} stayed busy for {_BUSY_S:g} s", reply)
            yield from self.pause(_BUSY_PAUSE_S)

    def _difference(self, pending: _PendingRequest, frame: Frame) -> str:
        """Return how a reply differs from the values of its request, such as an address, or an empty string."""
        fields = getattr(pending.request, "_fields", ())
        joins = any_shape(pending.request.__class__, self.encoder).joins if fields else ()
        for name in (*fields, *(join.name for join in joins)):
            reply_value, sent_value = getattr(frame, name, None), getattr(pending.request, name)
            if name not in pending.answers and reply_value is not None and reply_value != sent_value:
                return f"the reply of {self.encoder.code} has {name} {reply_value}, but {sent_value} was sent"
        return ""

    def run(self, steps: Sequence[Step]) -> Work[None]:
        """Carry out the steps of a procedure. If a request in a series fails, the series starts again."""
        for at, step in enumerate(steps):
            try:
                if isinstance(step, Wait):
                    yield from self.pause(step.microseconds / 1e6)
                elif isinstance(step, Send):
                    yield from self._send_series(step)
                else:
                    raise LinkError(f"RS-485 has no registers for {type(step).__name__}")
            except LinkError as error:
                raise StepError(step, at, tuple(steps[:at]), (), str(error)) from error

    def pause(self, seconds: float) -> Work[None]:
        """Wait, and discard all bytes that arrive."""
        end = self.clock() + seconds
        while (remaining_s := end - self.clock()) > 0:
            yield Ask(b"", remaining_s)

    def _send_series(self, step: Send) -> Work[None]:
        pending = self._pending(step.request)
        attempts_left = self.retries
        done = 0
        while done < step.times:
            try:
                yield from self._send_in_step(pending)
                yield from self.pause(step.every_us / 1e6)
                done += 1
            except LinkError:
                if not attempts_left:
                    raise
                # The request of another kind that follows also ends the count of the encoder.
                attempts_left, done = attempts_left - 1, 0

    def _send_with_retries(self, pending: _PendingRequest) -> Work[bytes]:
        attempts_left = self.retries
        while True:
            try:
                return (yield from self._send_in_step(pending))
            except LinkError:
                if not attempts_left:
                    raise
                attempts_left -= 1

    def _send_in_step(self, pending: _PendingRequest) -> Work[bytes]:
        """Send a request once, after resynchronisation if the previous one failed."""
        if self._failed:
            yield from self._resynchronise(self._failed)
        self._failed = pending.data[0]
        reply = yield from self._send_once(pending)
        self._failed = self._odd_replies = 0
        return reply

    def _resynchronise(self, control: int) -> Work[None]:
        """Get a reply to a request of another kind. All earlier replies come before it."""
        for mark in self._marks:
            if mark != control:
                try:
                    yield from self._send_once(self._pending(bytes([mark])))
                    return
                except LinkError:
                    continue
        # There are no other kinds. Wait for late replies.
        yield from self.pause(_LATE * self.timeout_s)

    def _send_once(self, pending: _PendingRequest) -> Work[bytes]:
        """Send a request once, and return the valid reply."""
        for _ in range(_MOST_BYTES):
            if not (yield Ask(b"", 0.0)):
                break
        end = self.clock() + self.timeout_s
        received = yield Ask(pending.data, self.timeout_s)
        while True:
            reply = self._reply_in(received, pending)
            if reply:
                # After other bytes, or an echo, part of the reply could look like a reply by chance. So could other
                # bytes before a reply that begins with any byte.
                echo = pending.data + pending.data[: pending.kind.repeats_first]
                is_clean = pending.kind.repeats_first and received.startswith(reply) and not received.startswith(echo)
                more = yield Ask(b"", 0.0 if is_clean else _QUIET_S)
                if not more:
                    return reply
                received += more
                continue
            remaining_s = end - self.clock()
            more = b"" if remaining_s <= 0 or len(received) > _MOST_BYTES else (yield Ask(b"", remaining_s))
            if not more:
                raise self._failure(received, pending)
            received += more

    def _reply_in(self, received: bytes, pending: _PendingRequest) -> bytes:
        """Return the reply found in the received bytes, or nothing. Only repetitions of the reply may follow it."""
        length = pending.kind.length
        if not pending.kind.repeats_first:
            # Nothing marks the start of the reply, so there must be no other bytes than an echo.
            candidates = (received, received.removeprefix(pending.data))
            for candidate in candidates:
                if len(candidate) == length and self._error_in(candidate, pending) is None:
                    return candidate
            return b""
        # The last one comes first, because an echo and a reply can look like a reply and one more byte.
        for start in range(len(received) - length, -1, -1):
            reply, following = received[start : start + length], received[start + length :]
            is_last = reply * (len(following) // length) == following
            if is_last and reply[0] == pending.kind.control and self._error_in(reply, pending) is None:
                return reply
        return b""

    def _error_in(self, reply: bytes, pending: _PendingRequest) -> FrameError | None:
        try:
            pending.decode(reply)
        except FrameError as error:
            return error
        except TypeError:  # Other fields need an answer. The CRC is an XOR.
            return CrcError(reply[-1], reply[-1] ^ _xor(reply)) if _xor(reply) else None
        return None

    def _failure(self, received: bytes, pending: _PendingRequest) -> LinkError:
        """Return the error for bytes without a valid reply."""
        kind, request_text = pending.kind, f"the request {_hex(pending.data)} to {self.encoder.code}"
        bytes_text = _hex(received[:24]) + (" ..." if len(received) > 24 else "")
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
            return self._exchange_failure(received, pending, request_text, bytes_text)
        odd = self._sign_of_other_encoder(received, pending)
        # 1 in 256 corrupted replies has a valid CRC, so one odd reply proves nothing.
        self._odd_replies = self._odd_replies + 1 if odd else 0
        if self._odd_replies > 1:
            text = (
                f"the reply {bytes_text} to {request_text} is from another kind of encoder: {odd}; check the order code"
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

    def _exchange_failure(
        self, received: bytes, pending: _PendingRequest, request_text: str, bytes_text: str
    ) -> LinkError:
        """Return the error for bytes without a valid reply of an exchange."""
        if len(received) < pending.kind.length:
            text = f"incomplete reply to {request_text}: {len(received)} of {pending.kind.length} bytes, {bytes_text}"
            return DisturbedError(text, received)
        reply = received[-pending.kind.length :]
        differs = self._difference(pending, pending.decode(reply)) if self._error_in(reply, pending) is None else ""
        return DisturbedError(differs or f"no valid reply to {request_text} in {bytes_text}", received)

    def _sign_of_other_encoder(self, received: bytes, pending: _PendingRequest) -> str:
        """Return why the bytes look like a reply from another kind of encoder, or an empty string."""
        if received[0] != pending.kind.control or len(received) < 3 or _xor(received):
            return ""
        if len(received) != pending.kind.length:
            return f"it has a valid CRC, but {len(received)} bytes instead of {pending.kind.length}"
        return str(self._error_in(received, pending))

    def _pending(self, request: Any) -> _PendingRequest:
        """Return a request: bytes, an object of the encoder's module, or a member of its ``DataId``."""
        if self.exchanges:
            return self._pending_exchange(request)
        answers: dict[str, object] = {}
        if isinstance(request, IntEnum):
            data = bytes(kind.control for kind in self.kinds.values() if kind.id == request)
        elif isinstance(request, (bytes, bytearray)):
            data = bytes(request)
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
            raise LinkError(f"{self.encoder.code} has no request '{_hex(data)}'; its requests are {requests}")
        decode = cast(Callable[..., Frame], self.encoder.decode)
        return _PendingRequest(request, data, request_kind, partial(decode, **answers), answers)

    def _pending_exchange(self, object_or_bytes: Any) -> _PendingRequest:
        """Return a request: bytes, or an object of the encoder's module."""
        data = bytes(object_or_bytes) if isinstance(object_or_bytes, (bytes, bytearray)) else b""
        for exchange in self.exchanges:
            request: Any = _request_in(exchange, data) if data else object_or_bytes
            if type(request) is not exchange.request:
                continue
            name = exchange.request.__name__
            if exchange.reply is None:
                raise LinkError(f"{self.encoder.code} does not answer {name}: send its bytes with 'send'")
            shape, data = any_shape(exchange.reply, self.encoder), request.encode()
            kind = _Kind(
                name=name,
                control=data[0],
                id=0,
                purpose=exchange.purpose,
                length=shape.length,
                has_position=exchange.purpose == "position",
                flags=(),
                repeats_first=exchange.repeats_first,
            )
            return _PendingRequest(request, data, kind, decoder(exchange.reply._decoder, self.encoder, raised))
        requests = ", ".join(exchange.request.__name__ for exchange in self.exchanges)
        request_text = _hex(data) or f"{object_or_bytes!r}"
        raise LinkError(f"{self.encoder.code} has no request '{request_text}'; its requests are {requests}")


def _request_in(exchange: Exchanged, data: bytes) -> Any:
    try:
        return exchange.request.decode(data)
    except FrameError:
        return None


def _request_kinds(encoder: Encoder) -> dict[int, _Kind]:
    """Return the requests of an encoder by their first byte."""
    module: Any = import_module(type(encoder).__module__)
    replies = [(kind, any_shape(kind, encoder)) for kind in get_args(module.Reply) or (module.Reply,)]
    kinds: dict[int, _Kind] = {}
    for data_id in rs485_facts(encoder).data_ids:
        for kind, shape in replies:
            # The first byte identifies a reply.
            first_checks = (check for check in shape.checks if check.low + check.width <= 8)
            allowed_ids = (tuple(column.values) for column in shape.columns if column.low < 8 and column.values)
            is_valid = all(holds(data_id.control, check) for check in first_checks)
            if is_valid and all(data_id.id in allowed for allowed in allowed_ids):
                kinds[data_id.control] = _Kind(
                    name=data_id.name,
                    control=data_id.control,
                    id=data_id.id,
                    purpose=data_id.purpose.value,
                    length=shape.length,
                    has_position=bool(shape.position) and hasattr(kind, "usable_position"),
                    flags=tuple(column.name for column in shape.columns if column.kind == "flag"),
                )
                break
    return kinds


def rs485_facts(encoder: Encoder) -> Any:
    """Return the facts about the RS-485 interface of an encoder."""
    return import_module(type(encoder).__module__).RS485


def _hex(data: bytes) -> str:
    return data.hex(" ").upper()


def _xor(data: bytes) -> int:
    value = 0
    for byte in data:
        value ^= byte
    return value
