# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Frames and lost cycles found in one stretch of a capture."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from .accesses import ControlBits


class Lost(NamedTuple):
    """Cycle or bytes in a capture without a frame.

    Attributes:
        time: Time of the beginning, in seconds or in samples.
        reason: Description of what was found instead of a frame.
    """

    time: float
    reason: str


class CapturedFrames(NamedTuple):
    """Frames in a stretch of a capture.

    Attributes:
        frames: The frames, in the form that ``decode_many`` expects. Over BiSS and SSI, frames of more than 64 bits
            are rows of bytes.
        times: Beginning of each frame: the first falling edge of the clock, or the start bit of the first byte. In
            seconds, or in samples if the sample rate is unknown.
        lost: Cycles without a frame.
        amount_read: Amount of the file that has been read.
        control_bits: Over BiSS, the bits of register accesses.
        kind: Over RS-485, the kind of the frames. Empty if none is requested, and no valid frame was found.
        other_counts: Number of frames of other kinds, by name.
    """

    frames: Any
    times: Any
    lost: list[Lost]
    amount_read: int = 0
    control_bits: ControlBits | None = None
    kind: str = ""
    other_counts: Mapping[str, int] = MappingProxyType({})
