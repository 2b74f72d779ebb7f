"""Serve the line of a virtual encoder on a pseudo-terminal or over TCP."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from select import select
from threading import Event, Thread
from time import monotonic
from typing import NamedTuple, Protocol

from .clocked_lines import BissLine, SsiLine
from .encoder import VirtualEncoder
from .rs485_line import Rs485Line
from .spi_line import SpiLine

#: Longest wait in seconds before the server checks whether it should stop.
_TICK_S = 0.2
#: Longest wait in seconds for a program to read its replies.
PATIENCE_S = 1.0
#: Maximum number of bytes to read from a connection at once.
_MOST_BYTES_READ = 4096


class ByteLine(Protocol):
    """Line of an encoder as bytes. ``due`` returns the time of its next reply, or None if no reply is pending."""

    def receive(self, data: bytes) -> None: ...
    def send(self) -> bytes: ...
    def due(self) -> float | None: ...


class _Port(NamedTuple):
    """Server end of a connection: the file descriptor to wait for, and functions to read, write and close.

    ``name`` is the device or URL that users open.
    """

    name: str
    handle: Callable[[], int]
    read: Callable[[], bytes]
    write: Callable[[bytes], object]
    close: Callable[[], object]


def line_of(encoder: VirtualEncoder) -> ByteLine:
    """Return a line with this encoder: RS-485, BiSS, SSI or SPI, according to its interface."""
    lines: dict[str, Callable[[VirtualEncoder], ByteLine]] = {
        "rs485": Rs485Line,
        "biss": BissLine,
        "ssi": SsiLine,
        "spi": SpiLine,
    }
    return lines[encoder.variant.interface](encoder)


def has_terminals() -> bool:
    """Return whether the system has pseudo-terminals."""
    return hasattr(os, "openpty")


def terminal() -> _Port:
    """Open a pseudo-terminal.

    Its name is the name of the device to open. Replies that are not read in time are lost.
    """
    import tty

    master, slave = os.openpty()
    tty.setraw(slave)
    os.set_blocking(master, False)

    def write(data: bytes) -> None:
        """Write as much as the terminal accepts within ``PATIENCE_S``, and discard the rest."""
        deadline = monotonic() + PATIENCE_S
        unwritten = data
        while unwritten:
            remaining_s = max(0.0, deadline - monotonic())
            _, writable, _ = select([], [master], [], remaining_s)
            if not writable:
                return
            try:
                written_count = os.write(master, unwritten)
            except BlockingIOError:
                continue
            unwritten = unwritten[written_count:]

    def close() -> None:
        os.close(master)
        os.close(slave)

    return _Port(
        name=os.ttyname(slave),
        handle=lambda: master,
        read=lambda: os.read(master, _MOST_BYTES_READ),
        write=write,
        close=close,
    )


def listen_tcp(port: int = 0) -> _Port:
    """Listen for TCP connections from this computer. The name is a URL that pyserial opens."""
    server = socket.create_server(("127.0.0.1", port))
    host, actual_port = server.getsockname()
    return listener(server, f"socket://{host}:{actual_port}")


class _Clients:
    """Clients of a listening socket, served one after another."""

    def __init__(self, server: socket.socket) -> None:
        self._server = server
        self._client: socket.socket | None = None

    def handle(self) -> int:
        return (self._client or self._server).fileno()

    def read(self) -> bytes:
        """Return data that the client has sent. Without a client, accept the next one and return no data.

        A client that has closed its connection is disconnected.
        """
        if self._client is None:
            self._accept_client()
            return b""
        try:
            data = self._client.recv(_MOST_BYTES_READ)
        except OSError:
            data = b""
        has_closed_connection = not data
        if has_closed_connection:
            self._disconnect_client()
        return data

    def write(self, data: bytes) -> None:
        if self._client is not None:
            try:
                self._client.sendall(data)
            except OSError:
                self._disconnect_client()

    def close(self) -> None:
        self._server.close()
        self._disconnect_client()

    def _accept_client(self) -> None:
        self._client, _ = self._server.accept()
        self._client.settimeout(PATIENCE_S)
        if self._server.family == socket.AF_INET:
            self._client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def _disconnect_client(self) -> None:
        if self._client is not None:
            self._client.close()
        self._client = None


def listener(server: socket.socket, name: str) -> _Port:
    """Return a port that serves one client after another on a listening socket.

    A client that closes its connection or does not read its replies in time is disconnected.
    """
    clients = _Clients(server)
    return _Port(name=name, handle=clients.handle, read=clients.read, write=clients.write, close=clients.close)


def serve(encoder: VirtualEncoder, line: ByteLine, port: _Port, stop: Event | None = None) -> None:
    """Pass requests from the port to the line and replies back, until ``stop`` is set, or forever without ``stop``.

    The function waits for requests, but never longer than until the next reply is due.
    """
    while stop is None or not stop.is_set():
        due = line.due()
        wait_s = _TICK_S
        if due is not None:
            seconds_until_reply = max(0.0, due - encoder.clock())
            wait_s = min(_TICK_S, seconds_until_reply)
        readable, _, _ = select([port.handle()], [], [], wait_s)
        if readable:
            line.receive(port.read())
        data = line.send()
        if data:
            port.write(data)


@contextmanager
def serving(encoder: VirtualEncoder, line: ByteLine | None = None, *, tcp: bool = False) -> Iterator[str]:
    """Serve an encoder in a thread during a ``with`` statement.

    Args:
        encoder: The encoder.
        line: Its line, by default that of its interface.
        tcp: Use TCP even if the system has pseudo-terminals.

    Yields:
        The name of the device or the URL to open.
    """
    port = listen_tcp() if tcp or not has_terminals() else terminal()
    served_line = line or line_of(encoder)
    stop = Event()
    thread = Thread(target=serve, args=(encoder, served_line, port, stop), daemon=True)
    thread.start()
    try:
        yield port.name
    finally:
        stop.set()
        thread.join(timeout=5)
        port.close()
