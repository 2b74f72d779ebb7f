# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Edges of the signals in a capture, in chunks of bounded size."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Sequence
from typing import Any, Final, NamedTuple

from ..bulk.words import list_names, quote
from ..errors import InputError, UsageError
from ..packages import load

np: Any = load("numpy")

#: Number of samples that are read at a time.
SAMPLES: Final = 1 << 21
#: Maximum unpacked size in bytes of the samples in a compressed file: three minutes at 24 MHz, which take a minute to
#: read.
MOST_UNPACKED: Final = 1 << 32


class Edges(NamedTuple):
    """Edges in one stretch of a capture.

    Attributes:
        levels: Level of each signal at the beginning of the stretch.
        times: Times at which each signal changes, in ascending order, as an array of float64 for each signal.
        begin: Beginning of the stretch. Minus infinity if it is not known.
        end: End of the stretch.
        amount_read: Amount of the file that has been read so far.
    """

    levels: tuple[int, ...]
    times: tuple[Any, ...]
    begin: float
    end: float
    amount_read: int = 0


class Signals(NamedTuple):
    """Signals of a capture.

    Attributes:
        edges: The edges, one stretch after another.
        seconds: Length of a unit of time in seconds. None if the sample rate is unknown, and times are sample numbers.
        is_sampled: True if times are sample numbers, so that an edge can be up to one sample earlier than its time.
        total: Size of the file in the unit of ``amount_read``, if known.
    """

    edges: Generator[Edges, None, None]
    seconds: float | None
    is_sampled: bool
    total: int | None = None

    @classmethod
    def at_rate(cls, edges: Generator[Edges, None, None], rate: float | None, total: int | None = None) -> Signals:
        """Return signals whose times are sample numbers, with this sample rate in Hz, or None if it is unknown."""
        return cls(edges, seconds=1 / rate if rate else None, is_sampled=True, total=total)


class SignalNames(NamedTuple):
    """Chosen channels: those of the clock and the data line, or just the data line if ``clock`` is None.

    A channel is chosen by its name, or by its number from 1. An empty name is replaced by a channel with a common name
    for the line. ``exchanged`` is True to exchange the clock and the data line.
    """

    clock: str | None = ""
    data: str = ""
    exchanged: bool = False

    def find_channels(self, channels: Sequence[str], file: str) -> tuple[int, ...]:
        """Return the index of each signal among the channels of a file: the clock, then the data line.

        Raises:
            InputError: There is no such channel, or it is not clear which one to use.
            UsageError: Both signals are on the same channel.
        """
        channel_indices = self._find_unexchanged_channels(channels, file)
        return channel_indices[::-1] if self.exchanged else channel_indices

    def _list_choices(self) -> list[_SignalChoice]:
        """Return the choice of a channel for the serial line, or for the clock and the data line."""
        if self.clock is None:
            return [_SignalChoice(self.data, usual_names=_NAMES_OF_SERIAL_LINES, option="--data")]
        return [
            _SignalChoice(self.clock, usual_names=_NAMES_OF_CLOCKS, option="--clock"),
            _SignalChoice(self.data, usual_names=_NAMES_OF_DATA, option="--data"),
        ]

    def _find_unexchanged_channels(self, channels: Sequence[str], file: str) -> tuple[int, ...]:
        """Return the index of each signal among the channels of a file, clock first, as if they were not exchanged.

        A signal without a chosen name uses the channel that has a usual name. If no names are chosen, one of the usual
        names is missing, and there are as many channels as signals, the channels are taken in order. If only one of two
        signals has a channel, the other one gets the remaining channel. Raises the errors of ``find_channels``.
        """
        choices = self._list_choices()
        if len(channels) < len(choices):
            raise InputError(file, f"expected channels of a clock and a data line, got {list_names(list(channels))}")
        channel_indices = [choice.find_channel(channels) for choice in choices]
        has_chosen_name = any(choice.name for choice in choices)
        if None in channel_indices and not has_chosen_name and len(channels) == len(choices):
            # Of two channels with other names, the first one is the clock.
            return tuple(range(len(choices)))
        if len(choices) == len(channels) == 2:
            channel_indices = _add_remaining_channel(choices, channel_indices)
        known_indices: list[int] = []
        for choice, channel_index in zip(choices, channel_indices, strict=True):
            if channel_index is None:
                advice = f"choose a channel with {choice.option}"
                problem = f"no channel {quote(choice.name)}" if choice.name else advice
                raise InputError(file, f"{problem}; the channels are {list_names(list(channels))}")
            known_indices.append(channel_index)
        if len({*known_indices}) < len(known_indices):
            raise UsageError("the clock and the data line are the same channel")
        return tuple(known_indices)


class _SignalChoice(NamedTuple):
    """Choice of the channel of one signal.

    Attributes:
        name: Name or number that the user chose, or empty.
        usual_names: Usual names of the signal, in lower case.
        option: Option of the command line that chooses the channel.
    """

    name: str
    usual_names: tuple[str, ...]
    option: str

    def find_channel(self, channels: Sequence[str]) -> int | None:
        """Return the index of the chosen channel, or of the one with a usual name. None if there is no such channel."""
        if self.name:
            return _find_channel_by_name_or_number(channels, self.name)
        return _find_channel_with_usual_name(channels, self.usual_names)


def _add_remaining_channel(choices: Sequence[_SignalChoice], channel_indices: list[int | None]) -> list[int | None]:
    """Return the index of the channel of each of two signals, in a file with two channels.

    If only one of the indices is known, the other signal has the remaining channel. An unknown index is None. It stays
    None if the user chose a name that does not exist.
    """
    known_indices = [index for index in channel_indices if index is not None]
    has_wrong_name = any(choice.name and index is None for choice, index in zip(choices, channel_indices, strict=True))
    if len(known_indices) != 1 or has_wrong_name:
        return channel_indices
    # The two indices are 0 and 1.
    remaining_index = 1 - known_indices[0]
    return [remaining_index if index is None else index for index in channel_indices]


_NAMES_OF_CLOCKS: Final = ("ma", "clock", "clk", "sck", "sclk", "scl")
_NAMES_OF_DATA: Final = ("slo", "sl", "data", "dat", "miso", "sdo", "sda")
_NAMES_OF_SERIAL_LINES: Final = ("rx", "data", "rxd", "a", "d+", "tx", "txd", "dat")


def _find_channel_by_name_or_number(channels: Sequence[str], name: str) -> int | None:
    """Return the index of the only channel with this name, or of the channel with this number, from 1.

    Return None if there is none.
    """
    if channels.count(name) == 1:
        return channels.index(name)
    is_number = name.isascii() and name.isdigit() and len(name) < 4
    if is_number and 1 <= int(name) <= len(channels):
        return int(name) - 1
    return None


def _find_channel_with_usual_name(channels: Sequence[str], usual_names: Iterable[str]) -> int | None:
    """Return the index of the channel with a usual name, or None if no channel has such a name.

    The first usual name that belongs to exactly one channel is used. Case is ignored. If there is only one channel, it
    is taken whatever its name.
    """
    if len(channels) == 1:
        return 0
    lower_names = [channel.lower() for channel in channels]
    for name in usual_names:
        if lower_names.count(name) == 1:
            return lower_names.index(name)
    return None


# Samples


class Samples(NamedTuple):
    """Samples in one stretch of a capture.

    Attributes:
        values: One number per sample, whose bits are the levels of the channels.
        amount_read: Amount of the file that has been read so far.
        times: Time of each sample. If it is None, samples are numbered from 0.
    """

    values: Any
    amount_read: int
    times: Any = None


def read_samples(parts: Iterable[Samples], masks: tuple[int, ...]) -> Generator[Edges, None, None]:
    """Yield the edges of the signals in samples. ``masks`` contains the bit of each signal in a sample."""
    signals_mask = sum(masks)
    # The number of the first sample of a part, and the last sample of the previous part.
    first_number = 0
    last_sample = None
    for samples, amount_read, times in parts:
        if not len(samples):
            continue
        # The first sample of a capture is not an edge, so it also counts as the sample before it.
        sample_before = int(samples[0]) if last_sample is None else last_sample
        changed_indices, changed_bits = _find_changes(samples, sample_before, signals_mask)
        sample_type = samples.dtype.type
        # A signal has an edge at the samples in which its bit has changed.
        indices_by_signal = [changed_indices[(changed_bits & sample_type(mask)) != 0] for mask in masks]
        if times is None:
            edge_times = [(indices + first_number).astype(np.float64) for indices in indices_by_signal]
            begin = float(first_number)
            end = float(first_number + len(samples))
        else:
            edge_times = [times[indices] for indices in indices_by_signal]
            begin = float(times[0])
            end = float(times[-1])
        first_number += len(samples)
        last_sample = int(samples[-1])
        levels_before = tuple(int((sample_before & mask) != 0) for mask in masks)
        yield Edges(levels=levels_before, times=tuple(edge_times), begin=begin, end=end, amount_read=amount_read)


def _find_changes(samples: Any, sample_before: int, mask: int) -> tuple[Any, Any]:
    """Return the indices of the samples that differ from the previous sample, and the bits in which each one differs.

    Only the bits in ``mask`` are considered. ``sample_before`` is the sample before the first one.
    """
    sample_type = samples.dtype.type
    # Element n has the bits that change from sample n to sample n + 1.
    changes = np.bitwise_xor(samples[1:], samples[:-1])
    changes &= sample_type(mask)
    indices_before_change = np.flatnonzero(changes != 0)
    changed_bits = changes[indices_before_change]
    changed_indices = indices_before_change + 1
    change_of_first = (sample_before ^ int(samples[0])) & mask
    if change_of_first:
        changed_indices = np.insert(changed_indices, 0, 0)
        changed_bits = np.insert(changed_bits, 0, sample_type(change_of_first))
    return changed_indices, changed_bits


def pack_bits(columns: Any) -> Any:
    """Return rows of levels as one number per sample, with the first column as the lowest bit.

    Any number other than 0 is the level 1. There are at most 8 columns, because the results are bytes.
    """
    columns = np.asarray(columns)
    levels = np.zeros(len(columns), np.uint8)
    for column_index in range(columns.shape[1]):
        levels |= (columns[:, column_index] != 0).astype(np.uint8) << np.uint8(column_index)
    return levels


def read_array(samples: Any, signal_names: SignalNames, rate: float | None = None) -> Signals:
    """Return the signals in an array of samples.

    Args:
        samples: An array of whole numbers. In one dimension, each number is a sample, whose bits are the channels, the
            lowest bit first. In two dimensions, each row is a sample and each column a channel, 0 or 1.
        signal_names: The channels, by their numbers from 1.
        rate: Sample rate in Hz.

    Raises:
        TypeError: ``samples`` has a different type or number of dimensions.
        InputError: There is no such channel, or it is not clear which one to use.
        UsageError: Both signals are on the same channel.
    """
    array = np.asarray(samples)
    has_rows = array.ndim == 2
    are_integers = array.dtype.kind in "uib"
    has_no_channels = has_rows and not array.shape[1]
    if not are_integers or array.ndim not in (1, 2) or has_no_channels:
        raise TypeError(f"expected whole numbers in one or two dimensions, got {array.dtype} {array.shape}")
    channel_count = array.shape[1] if has_rows else 8 * array.dtype.itemsize
    # The channels of an array have no names, only numbers.
    channel_names = [str(number) for number in range(1, channel_count + 1)]
    channel_indices = signal_names.find_channels(channel_names, "the array")
    # In rows, the chosen columns are packed into one number per sample, so the signals are its bits 0 and 1.
    signal_bits = range(len(channel_indices)) if has_rows else channel_indices
    masks = tuple(1 << bit for bit in signal_bits)
    edges = read_samples(_split_array(array, channel_indices), masks)
    return Signals.at_rate(edges, rate, total=len(array))


def _split_array(array: Any, channel_indices: tuple[int, ...]) -> Generator[Samples, None, None]:
    """Yield the samples part by part. The amount read is the number of samples so far.

    ``channel_indices`` are the columns of the signals. If the array has rows, only these columns are kept, as bits of a
    number.
    """
    for start in range(0, len(array), SAMPLES):
        part = array[start : start + SAMPLES]
        if array.ndim == 2:
            part = pack_bits(part[:, channel_indices])
        elif part.dtype.kind != "u":
            part = part.astype(f"u{part.dtype.itemsize}")
        yield Samples(part, amount_read=start + len(part))


# Edges of signals that are stored separately


class SignalEdges(NamedTuple):
    """Some edges of a signal that is stored separately.

    Attributes:
        level: Level before the edges.
        times: Times of the edges.
        amount_read: Amount of the file that has been read so far.
    """

    level: int
    times: Any
    amount_read: int


def merge_edges(
    signals: Sequence[Generator[SignalEdges, None, None]], end: Callable[[], float]
) -> Generator[Edges, None, None]:
    """Yield the edges of signals that are stored separately, one stretch of the capture after another.

    Each generator yields at least one part, which has no edges but shows the first level. ``end`` returns the end of
    the capture once all of them are exhausted. Edges that were read are kept in ``pending_times`` until the other
    signals have been read up to the same time.
    """
    first_parts = [next(signal) for signal in signals]
    levels = [part.level for part in first_parts]
    pending_times = [part.times for part in first_parts]
    amounts_read = [part.amount_read for part in first_parts]
    unfinished = {*range(len(signals))}
    begin = -np.inf
    while unfinished:
        # Continue with the signal whose edges end first.
        last_times = {index: _find_last_time(pending_times[index]) for index in sorted(unfinished)}
        earliest_signal = min(last_times, key=last_times.__getitem__)
        part = next(signals[earliest_signal], None)
        if part is None:
            # All edges of this signal have been read.
            unfinished.remove(earliest_signal)
            del last_times[earliest_signal]
        else:
            amounts_read[earliest_signal] = part.amount_read
            pending_times[earliest_signal] = np.concatenate([pending_times[earliest_signal], part.times])
            last_times[earliest_signal] = _find_last_time(pending_times[earliest_signal])
        # The edges of all signals are known up to the earliest of their last edges.
        known_until = min(last_times.values()) if last_times else end()
        known_counts = [int(np.searchsorted(times, known_until, "right")) for times in pending_times]
        known_times = tuple(times[:count] for times, count in zip(pending_times, known_counts, strict=True))
        yield Edges(
            levels=tuple(levels), times=known_times, begin=begin, end=known_until, amount_read=sum(amounts_read)
        )
        begin = known_until
        for index, known_count in enumerate(known_counts):
            # An odd number of edges inverts the level.
            levels[index] ^= known_count & 1
            pending_times[index] = pending_times[index][known_count:]


def _find_last_time(times: Any) -> float:
    """Return the last time, or minus infinity if there is none."""
    return float(times[-1]) if len(times) else -np.inf
