# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds the bytes on a serial line, and the replies of an RS-485 encoder among them."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from importlib import import_module
from typing import Any, Final, NamedTuple

from .bulk_decode import decode_many
from .clocked import Found, Lost
from .inputs import InputError
from .shape import Shape
from .signals import Signals
from .stream import counted
from .table import ErrorKind

np: Any = import_module("numpy")

#: A byte has a start bit, eight data bits, and a stop bit.
_BITS: Final = 10
#: Number of bytes that are kept until the next stretch of the capture arrives.
_KEPT: Final = 64
#: Longest pause within a message, in byte times.
_PAUSE: Final = 20


class _Bytes(NamedTuple):
    """Bytes of a stretch, the time of each start bit, and True for each byte with a stop bit."""

    values: Any
    times: Any
    good: Any
    done: int


def serial_bytes(signals: Signals, baud: float) -> Generator[_Bytes, None, None]:
    """Yield the bytes on a serial line: eight data bits, least significant bit first, without parity.

    Args:
        signals: The line, high at rest.
        baud: Bits per second, or per sample if the sample rate is unknown.
    """
    bit = 1 / baud / (signals.seconds or 1.0)
    early = 0.5 if signals.is_sampled else 0.0
    edges, level, free, end, done, is_new = np.zeros(0), 1, -np.inf, 0.0, 0, True
    for part in (*(), *_parts(signals)):
        if part is not None:
            level, is_new = (part.levels[0], False) if is_new else (level, False)
            edges, end, done = np.concatenate([edges, part.times[0]]), part.end, part.done
        # An edge with an even index starts from the first level.
        falls = edges[1 - level :: 2]
        whole = int(np.searchsorted(falls, end - _BITS * bit, "right")) if part is not None else len(falls)
        falls = falls[:whole]
        if not len(falls):
            continue
        # The stop bit lasts at least half a bit, and the next byte may follow at once.
        following = np.searchsorted(falls, falls + (_BITS - 0.5) * bit, "left").tolist()
        chosen: list[int] = []
        place = int(np.searchsorted(falls, free, "left"))
        while place < whole:
            chosen.append(place)
            place = following[place]
        if not chosen:
            continue
        starts = falls[chosen]
        free = float(starts[-1]) + (_BITS - 0.5) * bit
        times = starts[:, None] + (bit * (1.5 + np.arange(9)) - early)[None, :]
        levels = (np.searchsorted(edges, times.ravel(), "right").reshape(times.shape) & 1) ^ level
        values = (levels[:, :8] << np.arange(8)).sum(axis=1).astype(np.uint8)
        yield _Bytes(values, starts * (signals.seconds or 1.0), levels[:, 8] == 1, done)
        gone = int(np.searchsorted(edges, free, "left"))
        edges, level = edges[gone:], level ^ (gone & 1)


def _parts(signals: Signals) -> Iterator[Any]:
    """Yield the stretches of a capture, then None."""
    yield from signals.edges
    yield None


class Kinds(NamedTuple):
    """Kinds of frames on a line: those of the encoder and of the master, by name, and the requested one or none."""

    replies: Mapping[str, Shape]
    requests: Mapping[str, Shape]
    wanted: str = ""


def replies(signals: Signals, name: str, baud: float, kinds: Kinds) -> Generator[Found, None, None]:
    """Yield the replies of one kind.

    The line may also carry requests and other kinds of replies. If no kind is requested, the most frequent kind
    with a position is used.

    Args:
        signals: The line.
        name: Name of the file, for errors.
        baud: Bits per second.
        kinds: Kinds of frames.

    Raises:
        InputError: The line never changes.
    """
    finder = _Replies(kinds, _BITS / baud)
    first: list[Found] = []
    is_silent = True
    for part in serial_bytes(signals, baud):
        is_silent = False
        first.append(finder.feed(part))
        if finder.wanted:
            yield from map(finder.told, first)
            first.clear()
    if is_silent:
        raise InputError(name, "", "no byte was sent: choose another channel with --data")
    yield from map(finder.told, [*first, finder.finish()])


class _Replies:
    """Finder of replies in bytes. It keeps the last bytes until more arrive."""

    def __init__(self, kinds: Kinds, duration: float) -> None:
        self._kinds, self._pause = kinds, _PAUSE * duration
        self._values, self._times, self._good = np.zeros(0, np.uint8), np.zeros(0), np.zeros(0, bool)
        self.wanted, self._done = kinds.wanted, 0

    def feed(self, part: _Bytes) -> Found:
        """Return the replies that further bytes complete."""
        self._values = np.concatenate([self._values, part.values])
        self._times = np.concatenate([self._times, part.times])
        self._good = np.concatenate([self._good, part.good])
        self._done = part.done
        return self._found(max(len(self._values) - _KEPT, 0))

    def finish(self) -> Found:
        """Return the replies among the last bytes."""
        return self._found(len(self._values))

    def told(self, found: Found) -> Found:
        """Return the frames with the kind of the replies, which is not known at first."""
        if not self.wanted or len(found.frames):
            return found
        return found._replace(kind=self.wanted, frames=np.zeros((0, self._kinds.replies[self.wanted].length), np.uint8))

    def _valid(self, shape: Shape) -> Any:
        """Return whether a valid frame begins at each byte."""
        count, length = len(self._values), shape.length
        found = np.zeros(count + 1, bool)
        if count >= length:
            windows = np.lib.stride_tricks.sliding_window_view(self._values, length)
            found[: len(windows)] = decode_many(np.ascontiguousarray(windows), shape, None).fault == 0
            gaps = np.concatenate([[0], np.cumsum(np.diff(self._times) > self._pause)])
            found[: len(windows)] &= gaps[length - 1 :] == gaps[: len(windows)]
            bad = np.concatenate([[0], np.cumsum(~self._good)])
            found[: len(windows)] &= bad[length:] == bad[: len(windows)]
        return found

    def _found(self, until: int) -> Found:
        replies = {name: self._valid(shape) for name, shape in self._kinds.replies.items()}
        lengths = {name: shape.length for name, shape in self._kinds.replies.items()}
        order = [name for _, name in sorted((-length, name) for name, length in lengths.items())]
        count = len(self._values)
        # The kind of the reply at each byte, the longest one first, and the length of the request there.
        at = np.full(count + 1, -1)
        for place, name in reversed([*enumerate(order)]):
            at[replies[name]] = place
        asked = np.zeros(count + 1, np.int64)
        for shape in self._kinds.requests.values():
            asked = np.maximum(asked, shape.length * self._valid(shape))
        kind_at: list[int] = at.tolist()
        asked_at: list[int] = asked.tolist()
        following: int
        starts: dict[str, list[int]] = {name: [] for name in order}
        runs: list[tuple[int, int]] = []
        place = first = 0
        while place < until:
            length = asked_at[place]
            if length and place + length < count and kind_at[place + length] >= 0:
                following = place + length
            elif kind_at[place] >= 0:
                following = place
            else:
                place += 1
                continue
            if first < place:
                runs.append((first, place))
            sort: str = order[kind_at[following]]
            starts[sort].append(following)
            first = place = following + lengths[sort]
        end = min(max(place, first), count)
        if first < end:
            # The bytes may begin a reply that is not complete yet, unless these are the last ones.
            end = end if until == count or end - first > 4 * _KEPT else first
            if first < end:
                runs.append((first, end))
        if not self.wanted:
            found = [name for name in order if starts[name] and self._kinds.replies[name].otherwise is not None]
            if found:
                self.wanted = max((len(starts[name]), name) for name in found)[1]
        made = self._result(starts, runs, asked_at)
        keep = max(end, 0)
        self._values, self._times, self._good = self._values[keep:], self._times[keep:], self._good[keep:]
        return made

    def _result(self, starts: dict[str, list[int]], runs: Sequence[tuple[int, int]], asked: list[int]) -> Found:
        lost: list[Lost] = []
        wanted = self._kinds.replies.get(self.wanted)
        mine = starts.pop(self.wanted, [])
        for first, end in runs:
            at = first + asked[first] if asked[first] < end - first else first
            if wanted is not None and self._good[first:end].all() and end - at == wanted.length:
                kind = decode_many(self._values[at:end][None, :], wanted, None).fault[0]
                if kind == ErrorKind.CRC:
                    mine.append(at)
                    continue
            lost.append(Lost(float(self._times[first]), self._said(first, end, asked)))
        mine.sort()
        places = np.array(mine, np.int64)
        length = wanted.length if wanted is not None else 1
        rows = self._values[places[:, None] + np.arange(length)[None, :]] if len(mine) else np.zeros((0, length), "u1")
        others = {name: len(found) for name, found in starts.items() if found}
        return Found(rows, self._times[places], lost, self._done, None, self.wanted, others)

    def _said(self, first: int, end: int, asked: list[int]) -> str:
        data = self._values[first:end].tobytes()
        shown = data[:12].hex(" ").upper() + (" ..." if len(data) > 12 else "")
        if not self._good[first:end].all():
            return f"a byte without a stop bit: check the baud rate, and whether the line is inverted ({shown})"
        if asked[first] == end - first:
            return f"no reply to the request {shown}"
        return f"{counted(len(data), 'byte')} without a valid reply: {shown}"
