# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes many frames with several data channels into a table for each channel. Loaded only by ``decode_many``."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final, NamedTuple, cast

from .bulk.chunk import bit_mask, shift_left, shift_right
from .bulk.frame_rows import read_rows
from .bulk.table import Table
from .codec import whole_number
from .errors import ErrorKind
from .frames.base import decode_frames
from .packages import load
from .reports import Verdict

np: Any = load("numpy")
#: A layout is a ``ChannelLayout`` of ``channels.py``, which imports this module on first use.
_VERDICTS_BY_NUMBER: Final = [*Verdict]
_NOT_USABLE: Final = _VERDICTS_BY_NUMBER.index(Verdict.NOT_USABLE)
_UNKNOWN_NUMBER: Final = _VERDICTS_BY_NUMBER.index(Verdict.UNKNOWN)
_USABLE_NUMBER: Final = _VERDICTS_BY_NUMBER.index(Verdict.USABLE)


class ChannelTable:
    """Tables of the channels of many frames, and columns for the whole frames.

    Attributes:
        channels: Table of each channel, in the order in which they are sent.
        fault: Error of each frame: a length error, or the error of its first channel that has one.
        agree: True for each frame whose positions agree. None if nothing is compared.
        verdict: Verdict of all channels of each frame, as an index in ``Verdict``.
    """

    def __init__(self, layout: Any, channels: tuple[Table, ...], does_not_fit: Any) -> None:
        """Combine the tables of the channels. ``does_not_fit`` is True for each frame of the wrong length."""
        self._layout = layout
        self.channels = channels
        # A wrong length takes precedence. Then the first channel with an error counts.
        fault = np.where(does_not_fit, np.uint8(ErrorKind.LENGTH), np.uint8(0))
        for table in channels:
            has_no_error_yet = fault == 0
            fault = np.where(has_no_error_yet, table.fault, fault)
        self.fault: Any = fault
        self.agree: Any = _compare_fields(layout, channels) if layout.compared else None
        self.verdict: Any = self._find_worst_verdicts()

    def _find_worst_verdicts(self) -> Any:
        """Return the verdict of each frame, as an index in ``Verdict``: the worst verdict of its channels.

        A frame is not usable if it has an error or its positions do not agree.
        """
        worst = np.full(len(self.fault), _USABLE_NUMBER, np.uint8)
        for index, table in enumerate(self.channels):
            if "verdict" not in table:
                continue
            verdict = table.verdict
            if index != self._layout.position:
                # A channel without the position says nothing about the position if its verdict is unknown.
                verdict = np.where(verdict == _UNKNOWN_NUMBER, np.uint8(_USABLE_NUMBER), verdict)
            worst = np.minimum(worst, verdict)
        if self.agree is not None:
            worst = np.where(self.agree, worst, np.uint8(_NOT_USABLE))
        return np.where(self.fault == 0, worst, np.uint8(_NOT_USABLE))

    @property
    def position(self) -> Any:
        """Raw position of each frame in counts, including invalid frames.

        Prefer ``usable_position``, which masks these.
        """
        table: Any = self.channels[int(self._layout.position)]
        return table.position

    @property
    def usable_position(self) -> Any:
        """Position of each frame in counts, masked if the frame has an error or its position is not usable."""
        return np.ma.masked_array(self.position, self.verdict == _NOT_USABLE)

    def __len__(self) -> int:
        return len(self.fault)


def decode_channels(layout: Any, frames: object) -> ChannelTable:
    """Decode many frames with several data channels into a table for each channel.

    ``layout`` is a ``ChannelLayout``. ``frames`` are numbers, or rows of bytes with the last bit of the frame in the
    lowest bit of the last byte.
    """
    # The frames are rows of this many bytes, with leading zeros.
    frame_bytes = (layout.bits + 7) // 8
    rows, does_not_fit = _read_rows_of_frames(frames, layout.bits, frame_bytes)
    # The first channel forms the highest bits.
    lowest_bit = layout.bits
    tables: list[Table] = []
    for frame_class, channel_bits in zip(layout.kinds, layout.channel_bits, strict=True):
        lowest_bit -= channel_bits
        words = _extract_bits(rows, lowest_bit, channel_bits)
        tables.append(decode_frames(words, frame_class, variant=layout.encoder))
    return ChannelTable(layout, tuple(tables), does_not_fit)


class _Rows(NamedTuple):
    """Frames as rows of bytes, and an array that is True for each frame that does not fit.

    Zeros replace such frames.
    """

    rows: Any
    does_not_fit: Any


def _read_rows_of_frames(frames: Any, frame_bits: int, frame_bytes: int) -> _Rows:
    """Convert frames of ``frame_bits`` bits from numbers or bytes to rows of ``frame_bytes`` bytes.

    A frame does not fit if it has another number of bytes, or a 1 above its ``frame_bits`` bits.
    """
    # The kinds of numbers: unsigned, signed, and Python's integers, which can have more than 64 bits.
    is_array_of_numbers = isinstance(frames, np.ndarray) and frames.dtype.kind in "uiO" and frames.ndim == 1
    if is_array_of_numbers:
        frames = frames.tolist()
    if isinstance(frames, (list, tuple)):
        frame_list = list(cast(Iterable[Any], frames))
        if not any(isinstance(frame, bytes) for frame in frame_list):
            return _convert_numbers(frame_list, frame_bits, frame_bytes)
    rows, wrong_rows = read_rows(frames, frame_bytes)
    # The frame may not fill its first byte, which then begins with zeros.
    bits_of_first_byte = frame_bits - 8 * (frame_bytes - 1)
    does_not_fit = rows[:, 0] >= (1 << bits_of_first_byte)
    if len(wrong_rows):
        does_not_fit[wrong_rows] = True
    return _Rows(rows, does_not_fit)


def _convert_numbers(frames: list[Any], frame_bits: int, frame_bytes: int) -> _Rows:
    """Convert frames of ``frame_bits`` bits from numbers to rows of ``frame_bytes`` bytes."""
    data = bytearray()
    does_not_fit: list[bool] = []
    for frame in frames:
        number = whole_number("the frame", frame)
        fits = 0 <= number < (1 << frame_bits)
        data += (number if fits else 0).to_bytes(frame_bytes, "big")
        does_not_fit.append(not fits)
    return _Rows(np.frombuffer(data, np.uint8).reshape(-1, frame_bytes), np.array(does_not_fit, bool))


def _extract_bits(rows: Any, lowest_bit: int, width: int) -> Any:
    """Return the ``width`` bits of each row that start at bit ``lowest_bit``, as numbers.

    Bit 0 is the lowest bit of the last byte.
    """
    numbers = np.zeros(len(rows), np.uint64)
    last_column = rows.shape[1] - 1
    first_byte = lowest_bit // 8
    end_byte = (lowest_bit + width + 7) // 8
    for byte_index in range(first_byte, end_byte):
        byte = rows[:, last_column - byte_index].astype(np.uint64)
        # Place of the byte in the number. It is negative if the byte begins below the lowest bit.
        bit_in_number = 8 * byte_index - lowest_bit
        shifted_byte = shift_left(byte, bit_in_number) if bit_in_number >= 0 else shift_right(byte, -bit_in_number)
        numbers |= shifted_byte
    return numbers & bit_mask(width)


def _compare_fields(layout: Any, channels: tuple[Table, ...]) -> Any:
    """Return an array that is True for each frame whose compared fields agree, whether the frame is valid or not.

    Only the highest bits of each field are compared, because the fields can have different widths.
    """
    compared_values: list[Any] = []
    for field in layout.compared:
        table: Any = channels[int(field.channel)]
        values = table[field.field].astype(np.int64)
        bits_to_drop = field.width - layout.compared_bits
        compared_values.append(values >> bits_to_drop)
    first_values, *other_values = compared_values
    modulus = 1 << layout.compared_bits
    agrees = np.ones(len(first_values), bool)
    for values in other_values:
        # Positions wrap around, so the shorter way from one to the other counts.
        difference = (values - first_values) % modulus
        shorter_way = np.minimum(difference, modulus - difference)
        agrees &= shorter_way <= layout.tolerance
    return agrees
