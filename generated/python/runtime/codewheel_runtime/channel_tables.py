# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes many frames with several data channels into a table for each channel. Loaded only by ``decode_many``."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final, cast

from .bulk.decode import read_rows
from .bulk.table import Table
from .codec import whole_number
from .errors import ErrorKind
from .frames.base import decode_many
from .packages import load
from .reports import Verdict

np: Any = load("numpy")
#: A layout is a ``ChannelLayout`` of ``channels.py``, which imports this module on first use.
_VERDICTS: Final = [*Verdict]
_NOT_USABLE: Final = _VERDICTS.index(Verdict.NOT_USABLE)
_UNKNOWN: Final = _VERDICTS.index(Verdict.UNKNOWN)
_USABLE: Final = _VERDICTS.index(Verdict.USABLE)


class ChannelTable:
    """Tables of the channels of many frames, and columns for the whole frames.

    Attributes:
        channels: Table of each channel, in the order in which they are sent.
        fault: Error of each frame: of its length, or of its first channel with an error.
        agree: True for each frame whose positions agree. None if nothing is compared.
        verdict: Verdict of all channels of each frame, as an index in ``Verdict``.
    """

    def __init__(self, layout: Any, channels: tuple[Table, ...], is_wrong_length: Any) -> None:
        self._layout = layout
        self.channels = channels
        fault = np.where(is_wrong_length, np.uint8(ErrorKind.LENGTH), np.uint8(0))
        for table in channels:
            fault = np.where(fault == 0, table.fault, fault)
        self.fault: Any = fault
        self.agree: Any = _agree(layout, channels) if layout.compared else None
        self.verdict: Any = self._worst_verdict()

    def _worst_verdict(self) -> Any:
        """Return the verdict of each frame. The verdict with the lowest index is the worst."""
        worst = np.full(len(self.fault), _USABLE, np.uint8)
        for index, table in enumerate(self.channels):
            if "verdict" not in table:
                continue
            verdict = table.verdict
            if index != self._layout.position:
                # A channel without the position can only make the verdict worse.
                verdict = np.where(verdict == _UNKNOWN, np.uint8(_USABLE), verdict)
            worst = np.minimum(worst, verdict)
        if self.agree is not None:
            worst = np.where(self.agree, worst, np.uint8(_NOT_USABLE))
        return np.where(self.fault == 0, worst, np.uint8(_NOT_USABLE))

    @property
    def position(self) -> Any:
        """Raw position of each frame in counts, including invalid frames. See ``usable_position``."""
        table: Any = self.channels[int(self._layout.position)]
        return table.position

    @property
    def usable_position(self) -> Any:
        """Position of each frame in counts, masked if the frame has an error or its position is not usable."""
        return np.ma.masked_array(self.position, self.verdict == _NOT_USABLE)

    def __len__(self) -> int:
        return len(self.fault)


def decode_channels(layout: Any, frames: object) -> ChannelTable:
    """Decode many frames. For the arguments, see ``decode_many`` of their layout."""
    length = (layout.bits + 7) // 8
    rows, is_wrong_length = _read(frames, layout.bits, length)
    low_bit = layout.bits
    tables: list[Table] = []
    for frame_class, bits in zip(layout.kinds, layout.channel_bits, strict=True):
        low_bit -= bits
        words = _words_in(rows, low_bit, bits)
        tables.append(decode_many(words, frame_class, variant=layout.encoder))
    return ChannelTable(layout, tuple(tables), is_wrong_length)


def _read(frames: Any, bits: int, length: int) -> tuple[Any, Any]:
    """Return frames as rows of bytes, and True for each that is too long. Zeros replace these.

    A row of bytes may have zeros before the frame, which fill its first byte.
    """
    if isinstance(frames, np.ndarray) and frames.dtype.kind in "uiO" and frames.ndim == 1:
        frames = frames.tolist()
    listed = cast(Iterable[Any], frames) if isinstance(frames, (list, tuple)) else ()
    if isinstance(frames, (list, tuple)) and not any(isinstance(frame, bytes) for frame in listed):
        numbers = [whole_number("the frame", frame) for frame in listed]
        is_wrong = np.array([not 0 <= number < 1 << bits for number in numbers], bool)
        data = b"".join(
            (0 if wrong else number).to_bytes(length, "big") for number, wrong in zip(numbers, is_wrong, strict=True)
        )
        return np.frombuffer(data, np.uint8).reshape(-1, length), is_wrong
    rows, wrong_rows = read_rows(frames, length)
    bits_of_first_byte = bits - 8 * (length - 1)
    is_wrong = rows[:, 0] >= 1 << bits_of_first_byte
    if len(wrong_rows):
        is_wrong[wrong_rows] = True
    return rows, is_wrong


def _words_in(rows: Any, low_bit: int, bits: int) -> Any:
    """Return bits of each row as numbers. Bit 0 is the lowest bit of the last byte."""
    words = np.zeros(len(rows), np.uint64)
    for index in range(low_bit // 8, (low_bit + bits + 7) // 8):
        byte = rows[:, rows.shape[1] - 1 - index].astype(np.uint64)
        shift = 8 * index - low_bit
        words |= byte << np.uint64(shift) if shift >= 0 else byte >> np.uint64(-shift)
    return words & np.uint64((1 << bits) - 1)


def _agree(layout: Any, channels: tuple[Table, ...]) -> Any:
    """Return True for each frame whose compared fields agree, whether it is valid or not."""
    highest: list[Any] = []
    for field in layout.compared:
        table: Any = channels[int(field.channel)]
        column = table[field.field].astype(np.int64)
        highest.append(column >> (field.width - layout.compared_bits))
    modulus = 1 << layout.compared_bits
    agree = np.ones(len(highest[0]), bool)
    for numbers in highest[1:]:
        difference = (numbers - highest[0]) % modulus
        agree &= np.minimum(difference, modulus - difference) <= layout.tolerance
    return agree
