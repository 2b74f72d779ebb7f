"""Choices of the user for a virtual encoder: its order code, its motion, and its faults, each fault by name."""

from __future__ import annotations

import math
import random
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Protocol

from ..language.problems import ProblemReport
from ..loading.history import revision_for
from ..loading.library import Family, families_without_problems, in_edition, load_families
from ..model import INTERFACES, Device
from ..one_line.parse import is_line
from ..one_line.spec import device_of_line
from ..order_codes.labels import LabelMatch, UnknownOrderCode, find_code

#: Faults that a virtual encoder can have, by name: the effect on each interface that can have the fault.
FAULTS: Mapping[str, Mapping[str, str]] = {
    "lost": {
        "rs485": "there is no reply",
        "biss": "the data line stays high",
        "ssi": "the data line stays high",
        "spi": "all bits are 1",
    },
    "short": {
        "rs485": "the reply is truncated",
        "biss": "the frame is truncated, then the line stays high",
        "ssi": "the word is truncated, then the line stays high",
        "spi": "the word is truncated, and the missing bits are read as 1",
    },
    "doubled": {"rs485": "the reply is sent twice"},
    "repeated": {"rs485": "the reply is sent again 0.1 to 1 ms later"},
    "second": {"rs485": "a second encoder at another position also replies within 1 ms"},
    "late": {
        "rs485": "the reply arrives 5 to 40 ms late",
        "biss": "the start bit arrives 1 to 8 clocks late",
    },
    "flip": {
        "rs485": "one bit of the reply is inverted",
        "biss": "one bit of CDS or of the data is inverted",
        "ssi": "one bit of the word is inverted",
        "spi": "one bit of the word is inverted",
    },
    "echo": {"rs485": "the request is echoed before the reply"},
    "junk": {"rs485": "random bytes precede the reply"},
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
        "rs485": "the encoder is busy for 20 ms, and reports this or does not reply",
        "biss": "the start bit is 9 to 40 clocks late, and registers wait for 20 ms",
        "ssi": "the encoder is busy for 20 ms, and reports it or holds the line low",
    },
    "restart": {
        "rs485": "the supply is off for 20 ms",
        "biss": "the supply is off for 20 ms",
        "ssi": "the supply is off for 20 ms",
        "spi": "the supply is off for 20 ms",
    },
    "brownout": {
        "rs485": "the supply fails for 20 ms during the reply",
        "biss": "the supply fails for 20 ms during the frame",
        "ssi": "the supply fails for 20 ms during the word",
        "spi": "the supply fails for 20 ms during the word",
    },
}
#: Seconds for which the fault ``busy`` keeps an encoder busy.
BUSY_S = 0.02
#: Shortest and longest time in seconds between a reply and an extra reply, as in the effects above.
_SHORTEST_AND_LONGEST_GAP_S = (0.0001, 0.001)
#: Maximum number of random bytes before a reply with the fault ``junk``.
_MOST_JUNK_BYTES = 8


class Faults:
    """Faults to inject.

    Args:
        interface: Interface of the encoder, such as ``rs485``.
        texts: Names, each with a rate per reply, such as ``flip:1e-3``. Without a rate, every reply has the fault.
        seed: Seed of the random sequence.

    Attributes:
        injected: Number of times that each fault was injected.

    Raises:
        ValueError: The fault does not exist, this interface cannot have it, or the rate is not 0 to 1.
    """

    def __init__(self, interface: str, texts: Iterable[str] = (), seed: int = 0) -> None:
        self.random = random.Random(seed)
        self.injected: Counter[str] = Counter()
        fault_texts = [texts] if isinstance(texts, str) else texts
        self._names_and_rates = [_parse_fault(interface, text) for text in fault_texts]

    def draw(self) -> str:
        """Draw the fault of the next reply at random, and return its name, or an empty string for no fault.

        Faults are tried in the given order, each with its rate, until one occurs. A reply has at most one fault.
        """
        for name, rate in self._names_and_rates:
            if self.random.random() < rate:
                self.injected[name] += 1
                return name
        return ""

    def damaged(self, name: str, reply: bytes, request: bytes) -> bytes:
        """Return the bytes that the encoder sends instead of the reply if it has this fault.

        Faults that do not change the bytes of the reply, such as ``late``, return it unchanged.
        """
        if name == "lost":
            return b""
        if name in ("short", "brownout"):
            # At least one byte is lost. If the reply has several bytes, at least one remains.
            shortest_length = min(1, len(reply) - 1)
            remaining_length = self.random.randrange(shortest_length, len(reply))
            return reply[:remaining_length]
        if name == "doubled":
            return reply + reply
        if name == "flip":
            byte_index, bit = divmod(self.random.randrange(8 * len(reply)), 8)
            reply_with_flip = bytearray(reply)
            reply_with_flip[byte_index] ^= 1 << bit
            return bytes(reply_with_flip)
        if name == "echo":
            return request + reply
        if name == "junk":
            junk_length = self.random.randint(1, _MOST_JUNK_BYTES)
            return self.random.randbytes(junk_length) + reply
        return reply

    def gap_s(self) -> float:
        """Return a random time in seconds between a reply and an extra reply."""
        return self.random.uniform(*_SHORTEST_AND_LONGEST_GAP_S)

    def cut(self, word: int, bits: int) -> int:
        """Return a word of ``bits`` bits as it is read if its end is lost: a random number of its last bits are 1.

        At least one of them was 0, so that the word changes, unless all of its bits are 1.
        """
        # Adding 1 changes the lowest 0 of the word to 1 and the ones below it to 0.
        mask_of_lowest_zero = ~word & (word + 1)
        bits_up_to_lowest_zero = mask_of_lowest_zero.bit_length()
        fewest_lost = min(bits_up_to_lowest_zero, bits)
        end_of_range = max(fewest_lost + 1, bits)
        lost_bits = self.random.randrange(fewest_lost, end_of_range)
        mask_of_lost_bits = (1 << lost_bits) - 1
        return word | mask_of_lost_bits


class _EncoderWithFaults(Protocol):
    """The members of an encoder that faults of its line need."""

    @property
    def faults(self) -> Faults: ...
    def is_off(self) -> bool: ...
    def restart(self) -> None: ...


def word_with_fault(encoder: _EncoderWithFaults, fault: str, word: int, bits: int) -> int:
    """Return a word of ``bits`` bits as the master reads it over SSI or SPI if the encoder has this fault.

    ``fault`` is empty for no fault. ``restart`` and ``brownout`` also restart the encoder. While the encoder is off,
    all bits are 1.
    """
    was_off = encoder.is_off()
    if fault in ("restart", "brownout"):
        encoder.restart()
    all_ones = (1 << bits) - 1
    if fault == "low":
        return 0
    if was_off or fault in ("high", "lost", "restart"):
        return all_ones
    if fault in ("short", "brownout"):
        return encoder.faults.cut(word, bits)
    if fault == "flip":
        inverted_bit = encoder.faults.random.randrange(bits)
        return word ^ (1 << inverted_bit)
    return word


def faults_of(interface: str) -> dict[str, str]:
    """Return the faults that an interface can have, with their effects."""
    return {name: effects[interface] for name, effects in FAULTS.items() if interface in effects}


def _parse_fault(interface: str, text: str) -> tuple[str, float]:
    """Parse a fault, and return its name and its rate: ``("flip", 0.001)`` for ``flip:1e-3``.

    Raises:
        ValueError: There is no such fault, the interface cannot have it, or the rate is not from 0 to 1.
    """
    name, _, rate_text = text.partition(":")
    possible_names = ", ".join(faults_of(interface))
    advice = f"write a name and a rate from 0 to 1, such as flip:1e-3: {possible_names}"
    not_a_fault = ValueError(f"'{text}' is not a fault; {advice}")
    try:
        rate = float(rate_text) if rate_text else 1.0  # Without a rate, every reply has the fault.
    except ValueError:
        raise not_a_fault from None
    is_valid_rate = 0 <= rate <= 1  # This is also false for "nan".
    if name not in FAULTS or not is_valid_rate:
        raise not_a_fault
    if interface not in FAULTS[name]:
        interface_name = INTERFACES[interface].short
        raise ValueError(f"{interface_name} cannot have the fault '{name}'; it can have: {possible_names}")
    return name, rate


#: Position in counts as a function of the time in seconds. A number is a constant position.
Position = int | Callable[[float], float]

_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
_RAMP_TEXT = re.compile(rf"ramp:(?P<speed>{_NUMBER})")
_SINE_TEXT = re.compile(rf"sine:(?P<frequency>{_NUMBER})(?:Hz)?(?::(?P<amplitude>{_NUMBER})(?P<degrees>deg)?)?")


def motion(text: str, counts: int, lowest: int = 0, counts_per_turn: int = 0) -> Position:
    """Parse a constant position or a motion, and return it as a number or as a function of the time in seconds.

    Args:
        text: A number of counts, ``sine:0.5Hz:90deg`` (90 degrees to each side of the middle), ``sine:0.5Hz:1000``
            (1000 counts to each side), ``sine:0.5Hz`` (through all positions), or ``ramp:1000`` (counts per second).
        counts: Number of positions of the encoder.
        lowest: Lowest position of the encoder.
        counts_per_turn: Number of positions in one turn, or 0 if the position is not an angle.

    Returns:
        The position.

    Raises:
        ValueError: The text has a different form, a number in it is too large, or the encoder has no turns for degrees.
    """
    try:
        return int(text, 0)
    except ValueError:
        pass
    ramp_match = _RAMP_TEXT.fullmatch(text)
    if ramp_match is not None:
        speed = _parse_finite(ramp_match["speed"], text)
        return lambda seconds: speed * seconds
    sine_match = _SINE_TEXT.fullmatch(text)
    if sine_match is None:
        raise _not_a_position(text)
    frequency = _parse_finite(sine_match["frequency"], text)
    largest_amplitude = (counts - 1) / 2  # from lowest to lowest + counts - 1
    middle = lowest + largest_amplitude
    amplitude = largest_amplitude
    if sine_match["amplitude"]:
        amplitude = _amplitude_in_counts(
            text,
            amplitude=_parse_finite(sine_match["amplitude"], text),
            is_angle=bool(sine_match["degrees"]),
            largest_amplitude=largest_amplitude,
            counts_per_turn=counts_per_turn,
        )
    return lambda seconds: middle + amplitude * math.sin(2 * math.pi * frequency * seconds)


def _parse_finite(number_text: str, text: str) -> float:
    """Parse a number that is part of ``text``, the text of a position.

    Raises:
        ValueError: The number is too large for a float.
    """
    number = float(number_text)
    if not math.isfinite(number):
        raise _not_a_position(text)
    return number


def _not_a_position(text: str) -> ValueError:
    """Return the error for a text that is not a position, with examples of positions."""
    return ValueError(
        f"'{text}' is not a position; write 1000003, sine:0.5Hz, sine:0.5Hz:90deg, sine:0.5Hz:1000 (counts), "
        "or ramp:1000 (counts per second)"
    )


def _amplitude_in_counts(
    text: str, amplitude: float, *, is_angle: bool, largest_amplitude: float, counts_per_turn: int
) -> float:
    """Convert the amplitude of a motion to counts. It is in degrees if ``is_angle`` is true, and otherwise in counts.

    ``text`` is the whole motion, such as ``sine:0.5Hz:90deg``, for the messages.

    Raises:
        ValueError: The amplitude is an angle, but the encoder has no turns, or it is negative or too large.
    """
    if is_angle and not counts_per_turn:
        raise ValueError(f"'{text}' is an angle, but this encoder has no turns; write the amplitude in counts")
    amplitude_in_counts = amplitude * counts_per_turn / 360 if is_angle else amplitude
    if not 0 <= amplitude_in_counts <= largest_amplitude:
        limit_text = f"the largest amplitude is {largest_amplitude:g} counts"
        raise ValueError(f"'{text}' exceeds the range of this encoder; {limit_text}")
    return amplitude_in_counts


@cache
def _load_families(specs: tuple[Path, ...]) -> tuple[Family, ...]:
    """Load specs, and return the families without problems. An empty tuple stands for the specs of the package.

    Raises:
        ValueError: No family is valid. The message lists the problems in the specs.
    """
    families, report = load_families(specs or None)
    valid_families = tuple(families_without_problems(families, report))
    if not valid_families:
        problems_text = "\n".join(problem.format() for problem in report.shown)
        raise ValueError(problems_text or "there are no specs")
    return valid_families


def _has_special_code(device: Device, text: str) -> bool:
    """Return whether an order code contains the code of a special model, which an overlay of the family describes."""
    return any(overlay.special and overlay.special in text for overlay in device.overlays)


def find_order_code(text: str, specs: tuple[Path, ...], edition: str) -> tuple[Device, LabelMatch]:
    """Return the family and the variant of an order code, or of an encoder that is described in one line.

    Families with a special model that is named in the text are tried first. Families derived from a ``base`` have the
    same order codes as their base and are not tried.

    Raises:
        ValueError: There is no such order code or edition, no spec is valid, or the line has a problem. For an unknown
            order code, the message names the most similar codes of the last family that has any.
    """
    if is_line(text):
        if edition:
            raise ValueError("an encoder in one line has no editions; leave the edition out")
        return device_of_line(text)
    error_message = ""
    families = _load_families(specs)
    special_families = [family for family in families if _has_special_code(family.device, text)]
    ordinary_families = [family for family in families if not family.device.base]
    for family in (*special_families, *ordinary_families):
        try:
            match = find_code(family.device, text)
        except UnknownOrderCode as error:
            # An error with similar order codes is more helpful.
            if error.names_mistake or not error_message:
                error_message = str(error)
            continue
        if not edition:
            return family.device, match
        report = ProblemReport()
        revision = revision_for(family.device, edition)
        family_in_edition = in_edition(family, revision, report)
        if family_in_edition is None or report:
            raise ValueError("\n".join(problem.format() for problem in report.shown))
        return family_in_edition.device, find_code(family_in_edition.device, text)
    raise ValueError(error_message)
