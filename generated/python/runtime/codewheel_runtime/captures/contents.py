# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Contents of a capture, and the counts of a summary."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from ..bulk.table import Table
from ..channel_tables import ChannelTable
from ..files.stream import (
    Summary,
    count_units,
)
from .accesses import Access, AccessFinder
from .captured_frames import CapturedFrames, Lost


class Capture(NamedTuple):
    """Contents of a capture.

    Attributes:
        table: Columns of the frames, with ``time`` in seconds, or ``sample`` if the sample rate is unknown. The time
            of a frame is the time of the first falling edge of the clock, or of the start bit of its first byte.
        lost: Cycles or bytes that contain no frame, with the reason.
        accesses: Accesses to registers over BiSS.
        others: Number of frames of other kinds, by name.
    """

    table: Table
    lost: tuple[Lost, ...]
    accesses: tuple[Access, ...]
    others: Mapping[str, int]


class ChannelCapture(NamedTuple):
    """Contents of a capture of BiSS frames with several data channels.

    Attributes:
        table: Table of each channel, and columns for the whole frames.
        times: Time of each frame in seconds, or in samples if the sample rate is unknown: the first falling edge of the
            clock.
        lost: Cycles that contain no frame, with the reason.
        accesses: Accesses to registers.
    """

    table: ChannelTable
    times: Any
    lost: tuple[Lost, ...]
    accesses: tuple[Access, ...]


class CaptureSummary(NamedTuple):
    """Counts of the frames, lost cycles and register accesses in a capture.

    Attributes:
        frames: Counts of the frames.
        lost: Number of lost cycles by reason. Reasons are grouped by their text before a colon.
        first_lost: The first lost cycles, at most 1000.
        accesses: The first accesses to registers, at most 1000.
        access_count: Number of accesses.
        others: Number of frames of other kinds, by name.
    """

    frames: Summary
    lost: Mapping[str, int]
    first_lost: tuple[Lost, ...]
    accesses: tuple[Access, ...]
    access_count: int
    others: Mapping[str, int]

    @property
    def error_rate(self) -> float:
        """Fraction of the cycles that contain no valid frame, from 0 to 1."""
        lost_count = sum(self.lost.values())
        frame_counts = self.frames
        cycle_count = frame_counts.frames + lost_count
        invalid_count = lost_count + sum(frame_counts.faults.values())
        return invalid_count / cycle_count if cycle_count else 0.0

    def to_dict(self) -> dict[str, Any]:
        """Return the counts as plain values for JSON."""
        accesses = [access._asdict() for access in self.accesses]
        first_lost = [cycle._asdict() for cycle in self.first_lost]
        lost_by_reason, frames_by_kind = dict(self.lost), dict(self.others)
        return self.frames.to_dict() | {
            "lost": lost_by_reason,
            "first_lost": first_lost,
            "accesses": accesses,
            "others": frames_by_kind,
        }

    def __str__(self) -> str:
        lost_count = sum(self.lost.values())
        phrases = [str(self.frames), f"{lost_count} lost"]
        if self.access_count:
            # ``count_units`` only adds an s.
            phrases.append(count_units(self.access_count, "register access").replace("accesss", "accesses"))
        phrases += [f"{count} {name}" for name, count in self.others.items()]
        return ", ".join(phrases)


class Log:
    """Log of the lost cycles, accesses and other frames found while a capture is decoded."""

    def __init__(self, limit: int | None) -> None:
        # Maximum number of lost cycles, and of accesses, that are kept. None means all of them.
        self._limit = limit
        self.lost_cycles: list[Lost] = []
        self.accesses: list[Access] = []
        #: These counts also include the cycles and accesses that are not kept.
        self.access_count = 0
        self.lost_by_reason: dict[str, int] = {}
        #: Number of frames of other kinds, by the name of the kind.
        self.other_frames: dict[str, int] = {}
        self._access_finder = AccessFinder()

    def add(self, part: CapturedFrames) -> None:
        """Count the lost cycles, accesses and frames of other kinds in a part of the capture."""
        for cycle in part.lost:
            # After the colon, a reason quotes the received bytes, which differ each time.
            reason, _, _ = cycle.reason.partition(":")
            self.lost_by_reason[reason] = self.lost_by_reason.get(reason, 0) + 1
        # Number of lost cycles that can still be kept, or None for all of them.
        free_places = None if self._limit is None else max(self._limit - len(self.lost_cycles), 0)
        self.lost_cycles += part.lost[:free_places]
        for name, count in part.other_counts.items():
            self.other_frames[name] = self.other_frames.get(name, 0) + count
        if part.control_bits is not None:
            self._add_accesses(self._access_finder.feed(part.control_bits))

    def finish(self) -> None:
        """Add the access that the end of the capture cuts off."""
        self._add_accesses(self._access_finder.finish())

    def _add_accesses(self, accesses: Any) -> None:
        """Count accesses, and store the first ones."""
        for access in accesses:
            self.access_count += 1
            if self._limit is None or len(self.accesses) < self._limit:
                self.accesses.append(access)
