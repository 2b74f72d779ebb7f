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

from .encoder import Encoder, Exchanged, Frame, PositionFrame
from .errors import CrcError, FrameError, InterfaceError
from .frames import any_shape, decoder, raised
from .reports import Interface
from .running import StepError
from .shape import holds
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
    tells_position: bool
    flags: tuple[str, ...]
    repeats_first: bool = True


class _Asked(NamedTuple):
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
        self.kinds = {} if self.exchanges else _kinds(encoder)
        captures = [item for item in self.kinds.values() if item.purpose == "capture"]
        self._marks = [item.control for item in captures]
        #: First byte of the last request, if it failed.
        self._failed = 0
        #: Number of replies in a row that look like those of another kind of encoder.
        self._odd_replies = 0
        self._position = next((item for item in captures if item.tells_position), None)

    def position(self, request: Any = None) -> Work[int]:
        """Request the position in counts, with ``request`` or with factory defaults."""
        frame = yield from self.read(request)
        value = frame.usable_position
        if value is None:
            found = (item.meaning for item in frame.reports if item.makes_position is frame.verdict)
            reasons = "; ".join(text.partition(". ")[0] for text in found) or frame.verdict.value
            raise NotUsableError(f"the position of {self.encoder.code} is not usable: {reasons}", frame)
        return value

    def read(self, request: Any = None) -> Work[PositionFrame]:
        """Request a frame with the position, with ``request`` or with factory defaults."""
        frame = yield from self.exchange(self._position_request() if request is None else request)
        return cast(PositionFrame, frame)

    def _position_request(self) -> Any:
        if self._position is not None:
            return bytes([self._position.control])
        for item in self.exchanges:
            if item.purpose == "position":
                open_ = [name for name in item.request._fields if name not in item.defaults]
                if open_:
                    given = ", ".join(f"{name}=..." for name in open_)
                    raise LinkError(f"{self.encoder.code} needs a request: {item.request.__name__}({given})")
                return item.request(**item.defaults)
        raise LinkError(f"no reply of {self.encoder.code} contains the whole position")

    def exchange(self, request: Any) -> Work[Frame]:
        """Send a request, and return the reply to it. A request to a busy memory is repeated."""
        asked = self._asked(request)
        kind = asked.kind
        end = self.clock() + _BUSY_S
        while True:
            reply = yield from self._repeated(asked)
            frame = cast(Frame, asked.decode(reply))
            busy = kind.purpose in ("read", "write") and any(getattr(frame, name) for name in kind.flags)
            if not busy:
                differs = self._difference(asked, frame)
                if differs:
                    raise DisturbedError(differs)
                return frame
            if self.clock() > end:
                raise BusyError(f"the memory of {self.encoder.code} stayed busy for {_BUSY_S:g} s", reply)
            yield from self.pause(_BUSY_PAUSE_S)

    def _difference(self, asked: _Asked, frame: Frame) -> str:
        """Return how a reply differs from the values of its request, such as an address, or an empty string."""
        fields = getattr(asked.request, "_fields", ())
        joins = any_shape(asked.request.__class__, self.encoder).joins if fields else ()
        for name in (*fields, *(item.name for item in joins)):
            found, sent = getattr(frame, name, None), getattr(asked.request, name)
            if name not in asked.answers and found is not None and found != sent:
                return f"the reply of {self.encoder.code} has {name} {found}, but {sent} was sent"
        return ""

    def run(self, steps: Sequence[Step]) -> Work[None]:
        """Carry out the steps of a procedure. If a request in a series fails, the series starts again."""
        for at, step in enumerate(steps):
            try:
                if isinstance(step, Wait):
                    yield from self.pause(step.microseconds / 1e6)
                elif isinstance(step, Send):
                    yield from self._succession(step)
                else:
                    raise LinkError(f"RS-485 has no registers for {type(step).__name__}")
            except LinkError as error:
                raise StepError(step, at, tuple(steps[:at]), (), str(error)) from error

    def pause(self, seconds: float) -> Work[None]:
        """Wait, and discard all bytes that arrive."""
        end = self.clock() + seconds
        while (left := end - self.clock()) > 0:
            yield Ask(b"", left)

    def _succession(self, step: Send) -> Work[None]:
        asked = self._asked(step.request)
        left = self.retries
        done = 0
        while done < step.times:
            try:
                yield from self._safely(asked)
                yield from self.pause(step.every_us / 1e6)
                done += 1
            except LinkError:
                if not left:
                    raise
                # The request of another kind that follows also ends the count of the encoder.
                left, done = left - 1, 0

    def _repeated(self, asked: _Asked) -> Work[bytes]:
        left = self.retries
        while True:
            try:
                return (yield from self._safely(asked))
            except LinkError:
                if not left:
                    raise
                left -= 1

    def _safely(self, asked: _Asked) -> Work[bytes]:
        """Send a request once, after resynchronisation if the previous one failed."""
        if self._failed:
            yield from self._resynchronise(self._failed)
        self._failed = asked.data[0]
        reply = yield from self._once(asked)
        self._failed = self._odd_replies = 0
        return reply

    def _resynchronise(self, control: int) -> Work[None]:
        """Get a reply to a request of another kind. All earlier replies come before it."""
        for mark in self._marks:
            if mark != control:
                try:
                    yield from self._once(self._asked(bytes([mark])))
                    return
                except LinkError:
                    continue
        # There are no other kinds. Wait for late replies.
        yield from self.pause(_LATE * self.timeout_s)

    def _once(self, asked: _Asked) -> Work[bytes]:
        """Send a request once, and return the valid reply."""
        for _ in range(_MOST_BYTES):
            if not (yield Ask(b"", 0.0)):
                break
        end = self.clock() + self.timeout_s
        received = yield Ask(asked.data, self.timeout_s)
        while True:
            reply = self._reply_in(received, asked)
            if reply:
                # After other bytes, or an echo, part of the reply could look like a reply by chance. So could other
                # bytes before a reply that begins with any byte.
                echo = asked.data + asked.data[: asked.kind.repeats_first]
                is_clean = asked.kind.repeats_first and received.startswith(reply) and not received.startswith(echo)
                more = yield Ask(b"", 0.0 if is_clean else _QUIET_S)
                if not more:
                    return reply
                received += more
                continue
            left = end - self.clock()
            more = b"" if left <= 0 or len(received) > _MOST_BYTES else (yield Ask(b"", left))
            if not more:
                raise self._failure(received, asked)
            received += more

    def _reply_in(self, received: bytes, asked: _Asked) -> bytes:
        """Return the reply found in the received bytes, or nothing. Only repetitions of the reply may follow it."""
        length = asked.kind.length
        if not asked.kind.repeats_first:
            # Nothing marks the start of the reply, so there must be no other bytes than an echo.
            found = (received, received.removeprefix(asked.data))
            return next((item for item in found if len(item) == length and self._error_in(item, asked) is None), b"")
        # The last one comes first, because an echo and a reply can look like a reply and one more byte.
        for start in range(len(received) - length, -1, -1):
            reply, rest = received[start : start + length], received[start + length :]
            is_last = reply * (len(rest) // length) == rest
            if is_last and reply[0] == asked.kind.control and self._error_in(reply, asked) is None:
                return reply
        return b""

    def _error_in(self, reply: bytes, asked: _Asked) -> FrameError | None:
        try:
            asked.decode(reply)
        except FrameError as error:
            return error
        except TypeError:  # Other fields need an answer. The CRC is an XOR.
            return CrcError(reply[-1], reply[-1] ^ _xor(reply)) if _xor(reply) else None
        return None

    def _failure(self, received: bytes, asked: _Asked) -> LinkError:
        """Return the error for bytes without a valid reply."""
        kind, what = asked.kind, f"the request {asked.data.hex(' ').upper()} to {self.encoder.code}"
        shown = received[:24].hex(" ").upper() + (" ..." if len(received) > 24 else "")
        if not received:
            text = f"no reply to {what} within {1000 * self.timeout_s:g} ms; check supply, wires A and B, and baud rate"
            return NoReplyError(text)
        if received == asked.data:
            text = f"only an echo of {what}; check the wires to the encoder, and its supply"
            return NoReplyError(text, received)
        if not any(received):
            text = f"the line is low after {what}: only 00 arrives; check whether A and B are swapped"
            return DisturbedError(text, received)
        if self.exchanges:
            return self._unanswered(received, asked, what, shown)
        odd = self._odd(received, asked)
        # 1 in 256 corrupted replies has a valid CRC, so one odd reply proves nothing.
        self._odd_replies = self._odd_replies + 1 if odd else 0
        if self._odd_replies > 1:
            text = f"the reply {shown} to {what} is from another kind of encoder: {odd}; check the order code"
            return WrongEncoderError(text, received)
        if received[0] in self.kinds and received[0] != kind.control:
            return NoReplyError(f"no reply to {what}, but a late one to another request: {shown}", received)
        if len(received) < kind.length:
            text = f"incomplete reply to {what}: {len(received)} of {kind.length} bytes, {shown}"
            return DisturbedError(text, received)
        return DisturbedError(f"no valid reply to {what} in {shown}", received)

    def _unanswered(self, received: bytes, asked: _Asked, what: str, shown: str) -> LinkError:
        """Return the error for bytes without a valid reply of an exchange."""
        if len(received) < asked.kind.length:
            text = f"incomplete reply to {what}: {len(received)} of {asked.kind.length} bytes, {shown}"
            return DisturbedError(text, received)
        reply = received[-asked.kind.length :]
        differs = self._difference(asked, asked.decode(reply)) if self._error_in(reply, asked) is None else ""
        return DisturbedError(differs or f"no valid reply to {what} in {shown}", received)

    def _odd(self, received: bytes, asked: _Asked) -> str:
        """Return why the bytes look like a reply from another kind of encoder, or an empty string."""
        if received[0] != asked.kind.control or len(received) < 3 or _xor(received):
            return ""
        if len(received) != asked.kind.length:
            return f"it has a valid CRC, but {len(received)} bytes instead of {asked.kind.length}"
        return str(self._error_in(received, asked))

    def _asked(self, given: Any) -> _Asked:
        """Return a request: bytes, an object of the encoder's module, or a member of its ``DataId``."""
        if self.exchanges:
            return self._asked_in_exchange(given)
        answers: dict[str, object] = {}
        if isinstance(given, IntEnum):
            data = bytes(item.control for item in self.kinds.values() if item.id == given)
        elif isinstance(given, (bytes, bytearray)):
            data = bytes(given)
        else:
            data = given.encode()
            values = {name: getattr(given, name) for name in given._fields}
            # Answers to open questions, which the reply needs too.
            answers = {
                name: item for name, item in values.items() if isinstance(item, Enum) and not isinstance(item, IntEnum)
            }
        kind = self.kinds.get(data[0]) if data else None
        if kind is None:
            known = ", ".join(f"{item.control:02X} ({item.name})" for item in self.kinds.values())
            raise LinkError(f"{self.encoder.code} has no request '{data.hex(' ').upper()}'; its requests are {known}")
        decode = cast(Callable[..., Frame], self.encoder.decode)
        return _Asked(given, data, kind, partial(decode, **answers), answers)

    def _asked_in_exchange(self, given: Any) -> _Asked:
        """Return a request: bytes, or an object of the encoder's module."""
        data = bytes(given) if isinstance(given, (bytes, bytearray)) else b""
        for item in self.exchanges:
            request: Any = _request_in(item, data) if data else given
            if type(request) is not item.request:
                continue
            name = item.request.__name__
            if item.reply is None:
                raise LinkError(f"{self.encoder.code} does not answer {name}: send its bytes with 'send'")
            shape, data = any_shape(item.reply, self.encoder), request.encode()
            tells = item.purpose == "position"
            kind = _Kind(name, data[0], 0, item.purpose, shape.length, tells, (), item.repeats_first)
            return _Asked(request, data, kind, decoder(item.reply._decoder, self.encoder, raised))
        known = ", ".join(item.request.__name__ for item in self.exchanges)
        told = data.hex(" ").upper() or f"{given!r}"
        raise LinkError(f"{self.encoder.code} has no request '{told}'; its requests are {known}")


def _request_in(item: Exchanged, data: bytes) -> Any:
    try:
        return item.request.decode(data)
    except FrameError:
        return None


def _kinds(encoder: Encoder) -> dict[int, _Kind]:
    """Return the requests of an encoder by their first byte."""
    module: Any = import_module(type(encoder).__module__)
    replies = [(kind, any_shape(kind, encoder)) for kind in get_args(module.Reply) or (module.Reply,)]
    found: dict[int, _Kind] = {}
    for item in rs485_facts(encoder).data_ids:
        for kind, shape in replies:
            # The first byte identifies a reply.
            checks = all(holds(item.control, one) for one in shape.checks if one.low + one.width <= 8)
            values = (tuple(one.values) for one in shape.columns if one.low < 8 and one.values)
            if checks and all(item.id in allowed for allowed in values):
                flags = tuple(one.name for one in shape.columns if one.kind == "flag")
                purpose = item.purpose.value
                is_position = bool(shape.position) and hasattr(kind, "usable_position")
                found[item.control] = _Kind(item.name, item.control, item.id, purpose, shape.length, is_position, flags)
                break
    return found


def rs485_facts(encoder: Encoder) -> Any:
    """Return the facts about the RS-485 interface of an encoder."""
    return import_module(type(encoder).__module__).RS485


def _xor(data: bytes) -> int:
    value = 0
    for byte in data:
        value ^= byte
    return value
