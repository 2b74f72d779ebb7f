"""A session and a virtual encoder in virtual time: no port, no waiting, and one right value for each position."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from typing import Any

from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.rs485_line import Rs485Line

#: Seconds between two requests, and until a reply must be complete.
INTERVAL_S = 0.0002
TIMEOUT_S = 0.02


class Bench:
    """Carries out the work of a session on the line of a virtual encoder.

    The shaft turns through all positions once a second. Some replies arrive in two parts, 100 µs apart.
    """

    def __init__(self, package: Any, code: str, *faults: str, seed: int = 0, retries: int = 3, **more: Any) -> None:
        from codewheel_runtime.session import Session

        self.now, self.asked_at, self.sent = 0.0, 0.0, 0
        self.chance = random.Random(seed)
        self.virtual = VirtualEncoder(code, faults=faults, seed=seed, clock=lambda: self.now, **more)
        self.counts = self.virtual.counts
        self.virtual.position = self.shaft
        self.line = Rs485Line(self.virtual)
        encoder = package.lookup(code)
        self.session: Any = Session(encoder, timeout_s=TIMEOUT_S, retries=retries, clock=lambda: self.now)
        kind = self.session.requests.position_kind
        self.control = kind.control if kind is not None else self.session.requests.make_position_request().encode()[0]
        self.later = b""
        self.outcomes: Counter[str] = Counter()

    def shaft(self, now: float) -> float:
        return now * self.counts

    def do(self, work: Any) -> Any:
        """Carry out work, and return its result."""
        try:
            ask = next(work)
            while True:
                if ask.send:
                    self.sent += 1
                    self.line.receive(ask.send)
                    self.asked_at = self.now if ask.send[0] == self.control else self.asked_at
                ask = work.send(self._arrived(ask.wait_s))
        except StopIteration as done:
            return done.value

    def position(self) -> None:
        """Ask for the position, count the outcome, and require that a returned position is right."""
        self.now += INTERVAL_S
        begun = self.now
        try:
            value = self.do(self.session.position())
            true_position = int(self.shaft(self.asked_at)) % self.counts
            self.outcomes["right" if value == true_position else "wrong"] += 1
        except RuntimeError as error:
            assert "\n" not in str(error)
            self.outcomes[type(error).__name__] += 1
        # Each attempt and each request of another kind has its timeout, and each such request also has a pause.
        assert self.now - begun < 30 * TIMEOUT_S

    def _arrived(self, wait_s: float) -> bytes:
        end = self.now + wait_s
        if self.later:
            self.now = min(end, self.now + 0.0001)
            data, self.later = (self.later, b"") if self.now < end or wait_s >= 0.0001 else (b"", self.later)
            return data + self.line.send()
        data = self.line.send()
        if not data:
            due = self.line.due()
            self.now = due if due is not None and due <= end else end
            data = self.line.send()
        if len(data) > 1 and self.chance.random() < 0.2:
            cut = self.chance.randrange(1, len(data))
            data, self.later = data[:cut], data[cut:]
        return data


def codes_with(devices: Any, interface: str) -> list[str]:
    """Return all listed order codes with an interface."""
    return [variant.code for device in devices for variant in device.variants if variant.interface == interface]


def shares(total: int, codes: list[str]) -> Iterator[tuple[str, int]]:
    """Yield each order code with its share of the requests."""
    for at, code in enumerate(codes):
        yield code, (at + 1) * total // len(codes) - at * total // len(codes)
