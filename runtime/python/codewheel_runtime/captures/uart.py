# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds the bytes on a serial line, and the replies of an RS-485 encoder among them."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from typing import Any, Final, NamedTuple

from ..bulk.decode import decode_many
from ..bulk.shape import FrameLayout
from ..errors import ErrorKind, InputError
from ..files.stream import count_units
from ..packages import load
from .captured_frames import CapturedFrames, Lost
from .serial_bytes import BITS_PER_BYTE, Bytes

np: Any = load("numpy")

#: Number of bytes that are kept until the next stretch of the capture arrives.
_BYTES_KEPT: Final = 64
#: Maximum number of bytes after the last reply that may be an incomplete reply and its request.
_LONGEST_INCOMPLETE: Final = 4 * _BYTES_KEPT
#: Longest pause within a message, in byte times.
_LONGEST_PAUSE: Final = 20
#: Maximum number of bytes printed in the reason why they do not belong to a reply.
_PRINTED_BYTES: Final = 12


class FrameKinds(NamedTuple):
    """Kinds of frames on a line: replies from the encoder and requests from the master, by name.

    ``wanted_kind`` is the kind of the replies that the user requests, or empty for the most frequent one with a
    position.
    """

    replies: Mapping[str, FrameLayout]
    requests: Mapping[str, FrameLayout]
    wanted_kind: str = ""


def find_replies(
    line: Generator[Bytes, None, None], file_name: str, baud: float, kinds: FrameKinds
) -> Generator[CapturedFrames, None, None]:
    """Yield the replies of one kind.

    The line may also carry requests and other kinds of replies. If no kind is requested, the most frequent kind with a
    position in the first stretch that has such replies is used. Nothing is yielded before that stretch has been read.

    Args:
        line: The bytes on the line.
        file_name: Name of the file, for errors.
        baud: Bits per second, or per sample if times are in samples.
        kinds: Kinds of frames.

    Raises:
        InputError: There is no byte on the line.
    """
    finder = _ReplyFinder(kinds, BITS_PER_BYTE / baud)
    # Frames wait here until their kind is known.
    waiting_frames: list[CapturedFrames] = []
    is_silent = True
    for bytes_on_line in line:
        is_silent = False
        waiting_frames.append(finder.feed(bytes_on_line))
        if finder.wanted_kind:
            yield from map(finder.with_kind, waiting_frames)
            waiting_frames.clear()
    if is_silent:
        raise InputError(file_name, "no byte was sent: choose another channel with --data")
    yield from map(finder.with_kind, [*waiting_frames, finder.finish()])


class _Places(NamedTuple):
    """Places of replies and other bytes on a line, as indices of their bytes.

    Attributes:
        starts: First byte of each reply, by the name of its kind.
        gaps: First byte, and the byte after its last byte, of each gap between replies. A request directly before its
            reply does not belong to a gap.
        end: End of the bytes that belong to a reply or a gap.
    """

    starts: dict[str, list[int]]
    gaps: list[tuple[int, int]]
    end: int


class _ReplyFinder:
    """Finder for replies among bytes. It keeps the last bytes until more arrive.

    ``duration`` is the time that a byte takes on the line, with start and stop bit, in the unit of the times.
    """

    def __init__(self, kinds: FrameKinds, duration: float) -> None:
        self._kinds = kinds
        #: Longest time between the start bits of two bytes of a message.
        self._pause = _LONGEST_PAUSE * duration
        #: Three arrays of equal length: the bytes that are kept, the time of each byte, and True for each byte with a
        #: stop bit.
        self._values = np.zeros(0, np.uint8)
        self._times = np.zeros(0)
        self._has_stop_bits = np.zeros(0, bool)
        #: Name of the kind of replies to return. It is empty until it is known.
        self.wanted_kind = kinds.wanted_kind
        #: Amount of the file that has been read.
        self._amount_read = 0

    def feed(self, part: Bytes) -> CapturedFrames:
        """Return the replies that are complete with these further bytes."""
        self._values = np.concatenate([self._values, part.values])
        self._times = np.concatenate([self._times, part.times])
        self._has_stop_bits = np.concatenate([self._has_stop_bits, part.has_stop_bits])
        self._amount_read = part.amount_read
        # A reply that begins in the last bytes may not be complete.
        return self._take_replies(max(len(self._values) - _BYTES_KEPT, 0))

    def finish(self) -> CapturedFrames:
        """Return the replies among the last bytes."""
        return self._take_replies(len(self._values))

    def with_kind(self, part: CapturedFrames) -> CapturedFrames:
        """Return a part of the capture with the name of the kind of replies, which may not have been known before.

        A part with frames already has the name. In other parts, the empty array gets the length of this kind.
        """
        if not self.wanted_kind or len(part.frames):
            return part
        length = self._kinds.replies[self.wanted_kind].byte_count
        return part._replace(kind=self.wanted_kind, frames=np.zeros((0, length), np.uint8))

    def _find_valid_starts(self, layout: FrameLayout) -> Any:
        """Return an array that is True for each byte at which a valid frame begins.

        Its last item represents the end and is False.

        A valid frame has no error and no pause between its bytes, and each byte has its stop bit.
        """
        byte_count = len(self._values)
        frame_bytes = layout.byte_count
        is_valid = np.zeros(byte_count + 1, bool)
        if byte_count < frame_bytes:
            return is_valid
        # A row for each place at which a frame can begin, with the bytes from there on.
        windows = np.lib.stride_tricks.sliding_window_view(self._values, frame_bytes)
        start_count = len(windows)
        has_no_error = decode_many(np.ascontiguousarray(windows), layout, encoder=None).fault == 0
        # A frame has no pause if the number of pauses is the same before its first and before its last byte. It has all
        # stop bits if the number of damaged bytes is the same before its first byte and after its last one.
        pauses_before = _count_true_before(np.diff(self._times) > self._pause)
        has_no_pause = pauses_before[frame_bytes - 1 :] == pauses_before[:start_count]
        damaged_before = _count_true_before(~self._has_stop_bits)
        has_all_stop_bits = damaged_before[frame_bytes:] == damaged_before[:start_count]
        is_valid[:start_count] = has_no_error & has_no_pause & has_all_stop_bits
        return is_valid

    def _take_replies(self, until: int) -> CapturedFrames:
        """Return the replies that begin before the byte ``until``, and forget the bytes up to their end.

        If the kind of the replies is not known yet, these replies determine it.
        """
        layouts = self._kinds.replies
        # If several kinds of reply begin at a byte, the longest one counts.
        names = sorted(layouts, key=lambda name: (-layouts[name].byte_count, name))
        request_lengths = self._find_request_lengths()
        places = self._place_replies(until, names, self._find_reply_kinds(names), request_lengths)
        if not self.wanted_kind:
            self.wanted_kind = self._choose_kind(places.starts)
        frames = self._collect_frames(places, request_lengths)
        self._values = self._values[places.end :]
        self._times = self._times[places.end :]
        self._has_stop_bits = self._has_stop_bits[places.end :]
        return frames

    def _choose_kind(self, starts: Mapping[str, Sequence[int]]) -> str:
        """Return the name of the most frequent kind of reply with a position, or an empty string if there is none."""
        counts: list[tuple[int, str]] = []
        for name, reply_starts in starts.items():
            has_position = self._kinds.replies[name].default_verdict is not None
            if reply_starts and has_position:
                counts.append((len(reply_starts), name))
        # Of kinds that are equally frequent, the last one in alphabetical order is chosen.
        _, most_frequent = max(counts, default=(0, ""))
        return most_frequent

    def _find_reply_kinds(self, names: Sequence[str]) -> list[int]:
        """Return the index in ``names`` of the reply that begins at each byte, or -1 if none begins there.

        ``names`` begins with the longest reply. The list also contains an item for the end of the bytes, which is -1.
        """
        kinds = np.full(len(self._values) + 1, -1)
        # The first names are set last, so they take precedence.
        for index, name in reversed([*enumerate(names)]):
            kinds[self._find_valid_starts(self._kinds.replies[name])] = index
        reply_kinds: list[int] = kinds.tolist()
        return reply_kinds

    def _find_request_lengths(self) -> list[int]:
        """Return the length of the longest valid request that begins at each byte, or 0 if none begins there.

        The list also contains an item for the end of the bytes, which is 0.
        """
        longest_lengths = np.zeros(len(self._values) + 1, np.int64)
        for layout in self._kinds.requests.values():
            # True counts as 1, so this is the length where a request begins, and 0 elsewhere.
            lengths_of_kind = layout.byte_count * self._find_valid_starts(layout)
            longest_lengths = np.maximum(longest_lengths, lengths_of_kind)
        lengths: list[int] = longest_lengths.tolist()
        return lengths

    def _place_replies(
        self, until: int, names: Sequence[str], reply_kinds: list[int], request_lengths: list[int]
    ) -> _Places:
        """Return the places of the replies that begin before the byte ``until``, and of the gaps between them.

        ``reply_kinds`` contains the index in ``names`` of the reply that begins at each byte, or -1.
        ``request_lengths`` contains the length of the request that begins at each byte, or 0.
        """
        byte_count = len(self._values)
        starts: dict[str, list[int]] = {name: [] for name in names}
        gaps: list[tuple[int, int]] = []
        index = 0
        gap_start = 0
        while index < until:
            # A reply after a request takes precedence over one that seems to begin at the request, such as its echo.
            after_request = index + request_lengths[index]
            has_reply_after = index < after_request < byte_count and reply_kinds[after_request] >= 0
            reply_start = after_request if has_reply_after else index
            if reply_kinds[reply_start] < 0:
                index += 1
                continue
            if gap_start < index:
                gaps.append((gap_start, index))
            name = names[reply_kinds[reply_start]]
            starts[name].append(reply_start)
            index = reply_start + self._kinds.replies[name].byte_count
            gap_start = index
        end = min(index, byte_count)
        # The last bytes may begin a reply that is not complete yet, unless the capture ends.
        is_short_gap = gap_start < end <= gap_start + _LONGEST_INCOMPLETE
        if is_short_gap and until != byte_count:
            end = gap_start
        if gap_start < end:
            gaps.append((gap_start, end))
        return _Places(starts=starts, gaps=gaps, end=end)

    def _collect_frames(self, places: _Places, request_lengths: list[int]) -> CapturedFrames:
        """Return the replies of the wanted kind as frames, and the gaps between replies as lost bytes.

        A gap that contains exactly one reply with a CRC error, with or without a preceding request, is a frame
        with an error instead. ``request_lengths`` contains the length of the request that begins at each byte, or 0.
        """
        lost_bytes: list[Lost] = []
        reply_starts = [*places.starts.get(self.wanted_kind, [])]
        for gap_start, gap_end in places.gaps:
            after_request = gap_start + request_lengths[gap_start]
            # A gap can be a request alone.
            reply_start = after_request if after_request < gap_end else gap_start
            if self._is_damaged_reply(gap_start=gap_start, reply_start=reply_start, gap_end=gap_end):
                reply_starts.append(reply_start)
            else:
                lost_bytes.append(
                    Lost(float(self._times[gap_start]), self._explain_loss(gap_start, gap_end, request_lengths))
                )
        first_bytes = np.array(sorted(reply_starts), np.int64)
        other_counts = {
            name: len(starts) for name, starts in places.starts.items() if starts and name != self.wanted_kind
        }
        return CapturedFrames(
            frames=self._copy_replies(first_bytes),
            times=self._times[first_bytes],
            lost=lost_bytes,
            amount_read=self._amount_read,
            kind=self.wanted_kind,
            other_counts=other_counts,
        )

    def _copy_replies(self, first_bytes: Any) -> Any:
        """Return the bytes of the replies of the wanted kind, a row for each. Each begins at an index in the array."""
        layout = self._kinds.replies.get(self.wanted_kind)
        # While the kind is not known, there are no replies, and any length fits.
        length = layout.byte_count if layout is not None else 1
        if not len(first_bytes):
            return np.zeros((0, length), "u1")
        byte_indices = first_bytes[:, None] + np.arange(length)[None, :]
        return self._values[byte_indices]

    def _is_damaged_reply(self, gap_start: int, reply_start: int, gap_end: int) -> bool:
        """Return whether the bytes from ``reply_start`` to ``gap_end`` are a reply of the wanted kind with a CRC error.

        A request can precede the reply. All bytes from ``gap_start`` on, where it begins, must have their stop bits.
        """
        # While the kind of the replies is not known, there is no layout.
        layout = self._kinds.replies.get(self.wanted_kind)
        has_length_of_reply = layout is not None and gap_end - reply_start == layout.byte_count
        if layout is None or not has_length_of_reply:
            return False
        has_all_stop_bits = self._has_stop_bits[gap_start:gap_end].all()
        if not has_all_stop_bits:
            return False
        reply = self._values[reply_start:gap_end]
        table = decode_many(reply.reshape(1, -1), layout, encoder=None)
        return bool(table.fault[0] == ErrorKind.CRC)

    def _explain_loss(self, gap_start: int, gap_end: int, request_lengths: list[int]) -> str:
        """Return why the bytes of a gap do not belong to a reply, with the first bytes as text."""
        lost_bytes = self._values[gap_start:gap_end].tobytes()
        ellipsis = " ..." if len(lost_bytes) > _PRINTED_BYTES else ""
        bytes_text = lost_bytes[:_PRINTED_BYTES].hex(" ").upper() + ellipsis
        if not self._has_stop_bits[gap_start:gap_end].all():
            return f"a byte without a stop bit: check the baud rate, and whether the line is inverted ({bytes_text})"
        if request_lengths[gap_start] == gap_end - gap_start:
            return f"no reply to the request {bytes_text}"
        return f"{count_units(len(lost_bytes), 'byte')} without a valid reply: {bytes_text}"


def _count_true_before(conditions: Any) -> Any:
    """Return the number of True conditions before each index: 0 for the first index, and the total for the end."""
    return np.concatenate([[0], np.cumsum(conditions)])
