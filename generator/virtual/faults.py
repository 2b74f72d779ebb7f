"""Faults of a line or an encoder, by name, each with a rate."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterable
from math import isfinite
from typing import Protocol

#: The faults that a virtual encoder can have, with their effect.
FAULTS = {
    "lost": "there is no reply",
    "short": "the end of the reply is missing",
    "doubled": "the reply comes twice",
    "late": "the reply comes 5 to 40 ms late",
    "flip": "one bit of the reply is inverted",
    "echo": "the request comes back before the reply",
    "junk": "random bytes come before the reply",
    "low": "the line is low for 20 ms",
    "high": "the line is high for 20 ms",
    "busy": "the encoder is busy for 20 ms",
    "restart": "the supply is off for 20 ms",
    "brownout": "the supply fails within a reply, for 20 ms",
}


class Faults:
    """Faults to inject.

    Args:
        texts: Names, each with a rate per reply, such as ``flip:1e-3``. Without a rate, every reply has the fault.
        seed: Seed of the random sequence.

    Attributes:
        injected: Number of times that each fault was injected.

    Raises:
        ValueError: There is no such fault, or the rate is not 0 to 1.
    """

    def __init__(self, texts: Iterable[str] = (), seed: int = 0) -> None:
        self.random = random.Random(seed)
        self.injected: Counter[str] = Counter()
        self._rates = [_rate(text) for text in ([texts] if isinstance(texts, str) else texts)]

    def draw(self) -> str:
        """Return the fault of the next reply, or an empty string."""
        for name, rate in self._rates:
            if self.random.random() < rate:
                self.injected[name] += 1
                return name
        return ""

    def damaged(self, name: str, reply: bytes, request: bytes) -> bytes:
        """Return the bytes that this fault puts on the line in place of the reply."""
        chance = self.random
        if name == "lost":
            return b""
        if name in ("short", "brownout"):
            return reply[: chance.randrange(1, len(reply))]
        if name == "doubled":
            return reply + reply
        if name == "flip":
            place = chance.randrange(8 * len(reply))
            return bytes(byte ^ (1 << place % 8) * (at == place // 8) for at, byte in enumerate(reply))
        if name == "echo":
            return request + reply
        if name == "junk":
            return chance.randbytes(chance.randint(1, 8)) + reply
        return reply


class _Host(Protocol):
    """Encoder whose line has faults."""

    @property
    def faults(self) -> Faults: ...
    def is_off(self) -> bool: ...
    def restart(self) -> None: ...


def disturbed(encoder: _Host, word: int, bits: int) -> int:
    """Return a word as it arrives over a clocked line, with a fault that is drawn for it."""
    fault = encoder.faults.draw()
    if fault == "flip":
        return word ^ 1 << encoder.faults.random.randrange(bits)
    if fault == "restart":
        encoder.restart()
    if fault == "low":
        return 0
    return (1 << bits) - 1 if fault in ("high", "lost") or encoder.is_off() else word


def _rate(text: str) -> tuple[str, float]:
    name, _, rate = text.partition(":")
    try:
        value = float(rate or 1)
    except ValueError:
        value = -1.0
    if name not in FAULTS or not isfinite(value) or not 0 <= value <= 1:
        known = ", ".join(FAULTS)
        raise ValueError(f"'{text}' is not a fault; write a name and a rate from 0 to 1, such as flip:1e-3: {known}")
    return name, value
