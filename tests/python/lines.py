"""Lines of encoders as samples, generated bit by bit and sample by sample, without the code that reads them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import ceil


def crc6(value: int, bits: int) -> int:
    """Return the inverted CRC x^6 + x + 1 of BiSS, by long division."""
    number = value << 6
    for place in range(bits - 1, -1, -1):
        if number >> place + 6 & 1:
            number ^= 0x43 << place
    return number ^ 0x3F


def biss_word(position: int, bits: int = 32, error: bool = False, warning: bool = False) -> int:
    """Return the bits of a frame: position, nE, nW, CRC."""
    body = (position << 2) | (not error) << 1 | (not warning)
    return body << 6 | crc6(body, bits + 2)


@dataclass
class Wave:
    """Edges of a clock and a data line in units of time, and the samples that an analyser takes of them."""

    clock: list[float] = field(default_factory=list)
    data: list[tuple[float, int]] = field(default_factory=list)
    now: float = 0.0

    def samples(self, rate: float, shift: float = 0.0) -> list[tuple[int, int]]:
        """Return the levels of both lines at the sample times. ``shift`` is the phase of the analyser, 0 to 1."""
        count = ceil(self.now * rate)
        lines = (_levels([(at, None) for at in self.clock], count, rate, shift), _levels(self.data, count, rate, shift))
        return list(zip(*lines, strict=True))


def _levels(edges: Sequence[tuple[float, int | None]], count: int, rate: float, shift: float) -> list[int]:
    levels: list[int] = []
    level = 1
    for at, value in edges:
        place = min(max(ceil(at * rate - shift), 0), count)
        levels += [level] * (place - len(levels))
        level = level ^ 1 if value is None else value
    return levels + [level] * (count - len(levels))


@dataclass
class Biss:
    """A BiSS line with a clock of period 1."""

    wave: Wave = field(default_factory=Wave)
    delay: float = 0.1
    acknowledge: int = 3
    idle_time: float = 30.0
    extra: int = 0

    def cycle(self, word: int, bits: int, cds: int = 0, cdm: int = 0, clocks: int | None = None) -> None:
        """Append one cycle. The last clock may be followed by ``extra`` clocks, or there are only ``clocks``."""
        wave, begin = self.wave, self.wave.now + self.idle_time
        bits_sent = [0] * self.acknowledge + [1, cds] + [word >> place & 1 for place in range(bits - 1, -1, -1)] + [0]
        wanted = len(bits_sent) + 1 + self.extra
        count = wanted if clocks is None else clocks
        rises: list[float] = []
        for clock in range(count):
            wave.clock.append(begin + clock)
            wave.clock.append(begin + clock + 0.5)
            rises.append(begin + clock + 0.5)
        # The encoder answers at the second rising edge.
        level = 1
        for place, bit in enumerate(bits_sent):
            if place + 1 < len(rises) and bit != level:
                wave.data.append((rises[place + 1] + self.delay, bit))
                level = bit
        end = rises[-1] + 12
        if cdm:
            # The clock is low during the timeout.
            wave.clock.append(rises[-1] + 0.5)
            wave.clock.append(end + 1)
        if not level:
            wave.data.append((max(end, wave.data[-1][0] + 1), 1))
        wave.now = end + 2

    def finish(self) -> Wave:
        self.wave.now += self.idle_time
        return self.wave


def ssi(
    words: Sequence[int], bits: int, delay: float = 0.1, idle_time: float = 30.0, clocks: int | None = None
) -> Wave:
    """An SSI line with a clock of period 1: the first falling edge, then a bit at each rising edge."""
    wave = Wave()
    for word in words:
        begin, level = wave.now + idle_time, 1
        bits_sent = [word >> place & 1 for place in range(bits - 1, -1, -1)] + [0]
        for clock in range(clocks or bits + 1):
            wave.clock += [begin + clock, begin + clock + 0.5]
            if clock < len(bits_sent) and bits_sent[clock] != level:
                level = bits_sent[clock]
                wave.data.append((begin + clock + 0.5 + delay, level))
        wave.now = wave.clock[-1] + 20
        if not level:
            wave.data.append((wave.now, 1))
    wave.now += idle_time
    return wave


def serial(messages: Sequence[tuple[float, bytes]], stop: Callable[[int], int] = lambda number: 1) -> Wave:
    """A serial line with bits of length 1: each message is sent after a pause. ``stop`` is the stop bit of a byte."""
    wave, level, number = Wave(), 1, 0
    for pause, data in messages:
        wave.now += pause
        for byte in data:
            for bit in (0, *(byte >> place & 1 for place in range(8)), stop(number)):
                if bit != level:
                    wave.data.append((wave.now, bit))
                    level = bit
                wave.now += 1
            number += 1
    if not level:
        wave.data.append((wave.now, 1))
    wave.now += 30
    return wave
