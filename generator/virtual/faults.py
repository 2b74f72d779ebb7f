"""Motion of a virtual encoder, and faults of the line or the encoder, each by name."""

from __future__ import annotations

import math
import random
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from math import isfinite
from typing import Protocol

from ..model import INTERFACES

#: Faults that a virtual encoder can have, by name: the effect on each interface that can have the fault.
FAULTS: Mapping[str, Mapping[str, str]] = {
    "lost": {
        "rs485": "there is no reply",
        "biss": "the data line stays high",
        "ssi": "the data line stays high",
        "spi": "all bits are 1",
    },
    "short": {
        "rs485": "the end of the reply is missing",
        "biss": "the end of the frame is missing, and the line is high",
        "ssi": "the end of the word is missing, and the line is high",
        "spi": "the end of the word is missing, and its bits are 1",
    },
    "doubled": {"rs485": "the reply comes twice"},
    "repeated": {"rs485": "the reply comes again, 0.1 to 1 ms later"},
    "second": {"rs485": "a second encoder at another position replies, too, up to 1 ms later"},
    "late": {
        "rs485": "the reply comes 5 to 40 ms late",
        "biss": "the start bit comes 1 to 8 clocks late",
    },
    "flip": {
        "rs485": "one bit of the reply is inverted",
        "biss": "one bit of CDS or the data is inverted",
        "ssi": "one bit of the word is inverted",
        "spi": "one bit of the word is inverted",
    },
    "echo": {"rs485": "the request comes back before the reply"},
    "junk": {"rs485": "random bytes come before the reply"},
    "low": {
        "rs485": "the line is low for 20 ms",
        "biss": "the data line is low for the whole frame",
        "ssi": "the data line is low for the whole word",
        "spi": "all bits are 0",
    },
    "high": {
        "rs485": "the line is high for 20 ms",
        "biss": "the data line is high for the whole frame",
        "ssi": "the data line is high for the whole word",
        "spi": "all bits are 1",
    },
    "busy": {
        "rs485": "the encoder is busy for 20 ms: it reports this, or does not reply",
        "biss": "the start bit comes 9 to 40 clocks late, registers wait for 20 ms",
        "ssi": "the encoder reports for 20 ms that it is busy, or the line is low",
    },
    "restart": {
        "rs485": "the supply is off for 20 ms",
        "biss": "the supply is off for 20 ms",
        "ssi": "the supply is off for 20 ms",
        "spi": "the supply is off for 20 ms",
    },
    "brownout": {
        "rs485": "the supply fails within the reply, for 20 ms",
        "biss": "the supply fails within the frame, for 20 ms",
        "ssi": "the supply fails within the word, for 20 ms",
        "spi": "the supply fails within the word, for 20 ms",
    },
}
#: Seconds for which the fault ``busy`` keeps an encoder busy.
BUSY_S = 0.02


class Faults:
    """Faults to inject.

    Args:
        interface: Interface of the encoder, such as ``rs485``.
        texts: Names, each with a rate per reply, such as ``flip:1e-3``. Without a rate, every reply has the fault.
        seed: Seed of the random sequence.

    Attributes:
        injected: Number of times that each fault was injected.

    Raises:
        ValueError: There is no such fault, this interface cannot have it, or the rate is not 0 to 1.
    """

    def __init__(self, interface: str, texts: Iterable[str] = (), seed: int = 0) -> None:
        self.random = random.Random(seed)
        self.injected: Counter[str] = Counter()
        rate_texts = [texts] if isinstance(texts, str) else texts
        self._rates = [_rate(interface, text) for text in rate_texts]

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
            return reply[: chance.randrange(min(1, len(reply) - 1), len(reply))]
        if name == "doubled":
            return reply + reply
        if name == "flip":
            bit_index = chance.randrange(8 * len(reply))
            return bytes(byte ^ (1 << bit_index % 8) * (index == bit_index // 8) for index, byte in enumerate(reply))
        if name == "echo":
            return request + reply
        if name == "junk":
            return chance.randbytes(chance.randint(1, 8)) + reply
        return reply

    def gap_s(self) -> float:
        """Return the time in seconds after which an extra reply follows."""
        return self.random.uniform(0.0001, 0.001)

    def cut(self, word: int, bits: int) -> int:
        """Return a word whose last bits are all 1, at least one of which was 0, if there is one."""
        lowest_zero = (~word & (word + 1)).bit_length() - 1
        fewest = min(lowest_zero + 1, bits)
        missing_bits = self.random.randrange(fewest, max(fewest + 1, bits))
        return word | (1 << missing_bits) - 1


class _Host(Protocol):
    """Encoder whose line has faults."""

    @property
    def faults(self) -> Faults: ...
    def is_off(self) -> bool: ...
    def restart(self) -> None: ...


def disturbed(encoder: _Host, fault: str, word: int, bits: int) -> int:
    """Return a word as it arrives over a clocked line with this fault."""
    was_off = encoder.is_off()
    if fault in ("restart", "brownout"):
        encoder.restart()
    if fault == "low":
        return 0
    if was_off or fault in ("high", "lost", "restart"):
        return (1 << bits) - 1
    if fault in ("short", "brownout"):
        return encoder.faults.cut(word, bits)
    return word ^ 1 << encoder.faults.random.randrange(bits) if fault == "flip" else word


def faults_of(interface: str) -> dict[str, str]:
    """Return the faults that an interface can have, with their effects."""
    return {name: effects[interface] for name, effects in FAULTS.items() if interface in effects}


def _rate(interface: str, text: str) -> tuple[str, float]:
    name, _, rate = text.partition(":")
    try:
        value = float(rate or 1)
    except ValueError:
        value = -1.0
    possible = ", ".join(faults_of(interface))
    if name not in FAULTS or not isfinite(value) or not 0 <= value <= 1:
        raise ValueError(f"'{text}' is not a fault; write a name and a rate from 0 to 1, such as flip:1e-3: {possible}")
    if interface not in FAULTS[name]:
        raise ValueError(f"{INTERFACES[interface].short} cannot have the fault '{name}'; it can have: {possible}")
    return name, value


#: Position in counts as a function of the time in seconds. A number is a constant position.
Position = int | Callable[[float], float]

_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
_RAMP = re.compile(rf"ramp:(?P<speed>{_NUMBER})")
_SINE = re.compile(rf"sine:(?P<frequency>{_NUMBER})(?:Hz)?(?::(?P<amplitude>{_NUMBER})(?P<degrees>deg)?)?")


def motion(text: str, counts: int, lowest: int = 0, counts_per_turn: int = 0) -> Position:
    """Parse a position.

    Args:
        text: A number of counts, ``sine:0.5Hz:90deg`` (90 degrees to each side of the middle), ``sine:0.5Hz`` (through
            all positions), or ``ramp:1000`` (counts per second).
        counts: Number of positions of the encoder.
        lowest: Lowest position of the encoder.
        counts_per_turn: Number of positions in one turn, or 0 if the position is not an angle.

    Returns:
        The position.

    Raises:
        ValueError: The text has a different form.
    """
    try:
        return int(text, 0)
    except ValueError:
        pass
    ramp = _RAMP.fullmatch(text)
    if ramp is not None:
        speed = _finite(ramp["speed"], text)
        return lambda now: speed * now
    sine = _SINE.fullmatch(text)
    if sine is None:
        raise _bad_position(text)
    frequency = _finite(sine["frequency"], text)
    middle = lowest + (counts - 1) / 2
    amplitude = (counts - 1) / 2
    if sine["amplitude"]:
        typed_amplitude = _finite(sine["amplitude"], text)
        amplitude = _amplitude_in_counts(text, typed_amplitude, bool(sine["degrees"]), amplitude, counts_per_turn)
    return lambda now: middle + amplitude * math.sin(2 * math.pi * frequency * now)


def _finite(number: str, text: str) -> float:
    value = float(number)
    if not math.isfinite(value):
        raise _bad_position(text)
    return value


def _bad_position(text: str) -> ValueError:
    return ValueError(
        f"'{text}' is not a position; write 1000003, sine:0.5Hz, sine:0.5Hz:90deg, sine:0.5Hz:1000 (counts), "
        "or ramp:1000 (counts per second)"
    )


def _amplitude_in_counts(text: str, amplitude: float, is_angle: bool, highest: float, counts_per_turn: int) -> float:
    """Return the amplitude of a motion in counts.

    Raises:
        ValueError: The position is not an angle, or the encoder does not have that many positions.
    """
    if is_angle and not counts_per_turn:
        raise ValueError(f"'{text}' is an angle, but this encoder has no turns; write the amplitude in counts")
    radius = amplitude * counts_per_turn / 360 if is_angle else amplitude
    if not 0 <= radius <= highest:
        raise ValueError(f"'{text}' leaves the positions of this encoder; the largest amplitude is {highest:g} counts")
    return radius
