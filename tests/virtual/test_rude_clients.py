"""A client that floods a virtual encoder, goes away or reads nothing does not keep the next client waiting."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from threading import Event, Thread

import pytest
from codewheel.virtual import serving
from codewheel.virtual.encoder import VirtualEncoder

pytestmark = pytest.mark.slow

FLOOD = b"\x02" * (2 << 20)


class Counting:
    """Line that answers each byte with eleven bytes, takes time for it, and counts the bytes that it has received."""

    def __init__(self, pause_s: float = 0) -> None:
        self.received, self._answers, self._pause_s = 0, b"", pause_s

    def receive(self, data: bytes) -> None:
        time.sleep(self._pause_s)
        self.received += len(data)
        self._answers += data * 11

    def send(self) -> bytes:
        data, self._answers = self._answers, b""
        return data

    def due(self) -> float | None:
        return None


@contextmanager
def served(port: serving._Port, line: serving.ByteLine) -> Iterator[None]:
    stop = Event()
    arguments = (VirtualEncoder("AMM5A23/65KJP1"), line, port, stop)
    thread = Thread(target=serving.serve, args=arguments, daemon=True)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join(timeout=10)
        assert not thread.is_alive()
        port.close()


def connected(port: serving._Port) -> socket.socket:
    host, number = port.name.removeprefix("socket://").split(":")
    return socket.create_connection((host, int(number)), timeout=20)


def test_requests_of_a_client_that_has_gone_are_not_answered() -> None:
    port, line = serving.listen_tcp(), Counting(pause_s=0.02)
    with served(port, line):
        with closing(connected(port)) as rude:
            rude.sendall(FLOOD)
        with closing(connected(port)) as client:
            client.sendall(b"\x01")
            answer = client.recv(4096)
        assert answer.strip(b"\x02").startswith(b"\x01")
    # The rest of the flood, of which the system keeps some 128 kB, is discarded.
    assert line.received < 10 * 4096


def test_a_client_that_never_reads_is_disconnected() -> None:
    port, line = serving.listen_tcp(), Counting()
    with served(port, line), closing(connected(port)) as rude:
        rude.settimeout(20)
        with pytest.raises(OSError):
            rude.sendall(20 * FLOOD)
        with closing(connected(port)) as client:
            client.sendall(b"\x01")
            assert client.recv(4096).strip(b"\x02").startswith(b"\x01")


def test_a_client_that_only_ends_its_requests_gets_all_replies() -> None:
    port, line = serving.listen_tcp(), Counting()
    with served(port, line), closing(connected(port)) as client:
        client.sendall(b"\x01" * 500)
        client.shutdown(socket.SHUT_WR)
        answer = b""
        while data := client.recv(4096):
            answer += data
    assert answer == b"\x01" * 5500


@pytest.mark.skipif(not serving.has_terminals(), reason="there are no pseudo-terminals")
def test_a_terminal_that_nobody_reads_can_be_stopped() -> None:
    port, line = serving.terminal(), Counting()
    device = os.open(port.name, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    with closing(os.fdopen(device, "wb", buffering=0, closefd=True)), served(port, line):
        for _ in range(200):
            with suppress(BlockingIOError):
                os.write(device, b"\x02" * 1000)
