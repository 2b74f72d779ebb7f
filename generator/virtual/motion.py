"""Positions as functions of time, and their notation on the command line."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

#: Position in counts as a function of the time in seconds. A number is a constant position.
Position = int | Callable[[float], float]

_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"


def motion(text: str, counts: int, lowest: int = 0) -> Position:
    """Parse a position.

    Args:
        text: A number of counts, ``sine:0.5Hz`` (back and forth through all positions), or ``ramp:1000`` (counts per
            second).
        counts: Number of positions of the encoder.
        lowest: Lowest position of the encoder.

    Returns:
        The position.

    Raises:
        ValueError: The text has a different form.
    """
    try:
        return int(text, 0)
    except ValueError:
        pass
    match = re.fullmatch(rf"(sine|ramp):({_NUMBER})(Hz)?", text)
    value = float(match[2]) if match is not None else math.inf
    if match is None or not math.isfinite(value) or (match[3] and match[1] == "ramp"):
        raise ValueError(f"'{text}' is not a position; write 1000003, sine:0.5Hz or ramp:1000 (counts per second)")
    if match[1] == "ramp":
        return lambda now: value * now
    return lambda now: lowest + (counts - 1) / 2 * (1 + math.sin(2 * math.pi * value * now))
