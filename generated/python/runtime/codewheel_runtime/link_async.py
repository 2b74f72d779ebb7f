# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Link to an encoder over RS-485 for asyncio."""

from __future__ import annotations

from asyncio import (
    CancelledError,
    Lock,
    StreamReader,
    StreamWriter,
    ensure_future,
    gather,
    shield,
    to_thread,
    wait_for,
)
from asyncio import TimeoutError as Late
from collections.abc import Callable, Sequence
from inspect import isawaitable
from typing import Any, Protocol, TypeVar

from .encoder import Encoder, Frame, PositionFrame, SerialEncoder
from .link import Transport, serial_transport
from .link_errors import PortError
from .session import Session, Statistics, Work
from .steps import Step

__all__ = ["AsyncLink", "AsyncPorts", "AsyncTransport", "StreamTransport", "ThreadTransport", "open_async"]

_Argument = TypeVar("_Argument")
_Result = TypeVar("_Result")


class AsyncTransport(Protocol):
    """Line to an encoder, for asyncio."""

    async def write(self, data: bytes, /) -> object:
        """Send bytes."""
        ...

    async def read(self, timeout_s: float, /) -> bytes:
        """Return all bytes that have arrived.

        If no bytes have arrived, wait for the first byte for at most ``timeout_s``.
        """
        ...


class StreamTransport:
    """Line over asyncio streams, for example from ``asyncio.open_connection``."""

    def __init__(self, reader: StreamReader, writer: StreamWriter) -> None:
        self._reader = reader
        self._writer = writer

    async def write(self, data: bytes, /) -> None:
        """Send bytes."""
        self._writer.write(data)
        await self._writer.drain()

    async def read(self, timeout_s: float, /) -> bytes:
        """Return the bytes that have arrived. If there are none, wait for the first byte for at most ``timeout_s``.

        At the end of the stream, the result is empty and is returned immediately.
        """
        try:
            return await wait_for(self._reader.read(4096), max(timeout_s, 0.0005))
        except (Late, TimeoutError):
            return b""

    def close(self) -> None:
        """Close the streams."""
        self._writer.close()


class ThreadTransport:
    """Any other transport, such as a serial port, which waits in a thread."""

    def __init__(self, transport: Transport) -> None:
        self._transport = transport

    async def write(self, data: bytes, /) -> None:
        """Send bytes."""
        await _finish_in_thread(self._transport.write, data)

    async def read(self, timeout_s: float, /) -> bytes:
        """Return all bytes that have arrived.

        If no bytes have arrived, wait for the first byte for at most ``timeout_s``.
        """
        return await _finish_in_thread(self._transport.read, timeout_s)

    def close(self) -> None:
        """Close the transport, if it can be closed."""
        close = getattr(self._transport, "close", None)
        if close is not None:
            close()


async def _finish_in_thread(function: Callable[[_Argument], _Result], argument: _Argument) -> _Result:
    """Call a function in a thread, and return its result.

    A cancelled task first waits for the thread, which cannot be stopped. Otherwise, its read would consume bytes of
    the reply to the next request.
    """
    call = ensure_future(to_thread(function, argument))
    try:
        return await shield(call)
    except CancelledError:
        await gather(call, return_exceptions=True)
        raise


class AsyncLink:
    """Link to an encoder, for asyncio. Requests from several tasks are sent one at a time.

    ``position``, ``read``, ``exchange``, ``run`` and ``close`` are coroutines that do the same as the methods of
    :class:`codewheel_runtime.link.Link`.

    Args:
        encoder: The encoder, with RS-485.
        transport: Line to the encoder.
        timeout_s: Time in seconds within which a reply must be complete.
        retries: Number of further attempts after a failure.
        settle_s: Time in seconds for which the line must be quiet after a reply. The default depends on the baud rate
            and the measured reply times. With 0, a request of another kind is sent before each request instead.

    Raises:
        InterfaceError: The encoder has a different interface.
        TypeError, ValueError: A time or ``retries`` is out of range, or ``settle_s`` is 0 but the encoder has too few
            kinds of requests for it.
    """

    def __init__(
        self,
        encoder: Encoder,
        transport: AsyncTransport,
        *,
        timeout_s: float = 0.05,
        retries: int = 3,
        settle_s: float | None = None,
    ) -> None:
        self.encoder = encoder
        self.transport = transport
        self.session = Session(encoder, timeout_s=timeout_s, retries=retries, settle_s=settle_s)
        self._lock = Lock()

    @property
    def statistics(self) -> Statistics:
        """Counters for requests, replies and failures."""
        return self.session.statistics

    async def position(self, request: Any = None) -> int:
        """Return the position in counts, from the reply to ``request`` or to the request with factory defaults."""
        return await self._carry_out(self.session.position(request))

    async def read(self, request: Any = None) -> PositionFrame:
        """Return a frame with the position: the reply to ``request``, or to the request with factory defaults."""
        return await self._carry_out(self.session.read(request))

    async def exchange(self, request: Any) -> Frame:
        """Send a request, and return the reply to it."""
        return await self._carry_out(self.session.exchange(request))

    async def run(self, steps: Sequence[Step]) -> None:
        """Carry out a procedure, such as a reset. Raises StepError if a step fails."""
        await self._carry_out(self.session.run(steps))

    async def close(self) -> None:
        """Close the transport, if it can be closed."""
        # A transport can have a function or a coroutine ``close``, or neither.
        done = getattr(self.transport, "close", lambda: None)()
        if isawaitable(done):
            await done

    async def __aenter__(self) -> AsyncLink:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def _carry_out(self, work: Work[_Result]) -> _Result:
        """Carry out a task of the session: send its requests, and pass on the received bytes. Return its result.

        Raises:
            PortError: The transport failed.
            LinkError: The session raised this error.
        """
        async with self._lock:
            try:
                ask = next(work)
                while True:
                    if ask.send:
                        await self.transport.write(ask.send)
                    ask = work.send(await self.transport.read(ask.wait_s))
            except StopIteration as done:
                # A generator returns its result in this exception.
                result: _Result = done.value
                return result
            except OSError as error:
                raise PortError(f"the line to {self.encoder.code} failed: {error.strerror or error}") from error
            finally:
                work.close()


def open_async(
    port: str, encoder: Encoder, *, timeout_s: float = 0.05, retries: int = 3, settle_s: float | None = None
) -> AsyncLink:
    """Open a serial port with the settings of an encoder, for ``async with``.

    Args:
        port: Name of the port, such as ``/dev/ttyUSB0`` or ``COM3``, or a pyserial URL.
        encoder: The encoder, with RS-485.
        timeout_s: Time in seconds within which a reply must be complete.
        retries: Number of further attempts after a failure.
        settle_s: Time in seconds for which the line must be quiet after a reply, as for :class:`AsyncLink`.

    Returns:
        The link.

    Raises:
        InterfaceError: The encoder has a different interface.
        PortError: The port cannot be opened, or pyserial is not installed.
    """
    # The result is not used. It raises InterfaceError before a port is opened.
    Session(encoder)
    line = ThreadTransport(serial_transport(port, encoder))
    return AsyncLink(encoder, line, timeout_s=timeout_s, retries=retries, settle_s=settle_s)


class AsyncPorts:
    """Functions of a manufacturer's package that open ports for asyncio.

    Args:
        lookup: Function that returns the encoder for a label.
    """

    def __init__(self, lookup: Callable[[str], Encoder]) -> None:
        self._lookup = lookup

    def open_async(
        self,
        port: str,
        label: str | SerialEncoder,
        *,
        timeout_s: float = 0.05,
        retries: int = 3,
        settle_s: float | None = None,
    ) -> AsyncLink:
        """Open the serial port to an encoder with RS-485, for asyncio.

        Not yet tested on hardware.

        Args:
            port: Name of the port, such as ``/dev/ttyUSB0`` or ``COM3``, or a pyserial URL.
            label: Order code on the label, or an encoder whose class shows that it has RS-485.
            timeout_s: Time in seconds within which a reply must be complete.
            retries: Number of further attempts after a failure.
            settle_s: Time in seconds for which the line must be quiet after a reply. The default depends on the baud
                rate and the measured reply times. With 0, a request of another kind is sent before each request
                instead.

        Returns:
            The link, for an ``async with`` statement.

        Raises:
            OrderCodeError: There is no such order code.
            InterfaceError: The encoder has a different interface.
            PortError: The port cannot be opened, or pyserial is not installed.
        """
        encoder = label if isinstance(label, Encoder) else self._lookup(label)
        return open_async(port, encoder, timeout_s=timeout_s, retries=retries, settle_s=settle_s)
