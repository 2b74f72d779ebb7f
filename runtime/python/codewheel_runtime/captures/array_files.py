# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads captures in NumPy files: samples in ``.npy``, and named arrays in ``.npz``."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Generator, Sequence
from typing import Any, BinaryIO, Final, NamedTuple

from ..bulk.words import quote
from ..errors import InputError
from ..packages import load
from .signal_text import Voltages
from .signals import MOST_UNPACKED, SAMPLES, Samples, SignalNames, Signals, pack_bits, read_array, read_samples

np: Any = load("numpy")


class _ArrayForm(NamedTuple):
    """Form of an array of samples: its NumPy type (``dtype``), number of channels and number of samples.

    If ``channels`` is None, each number is a sample whose bits are the channels.
    """

    dtype: Any
    channels: int | None
    sample_count: int


def _read_array_form(file: BinaryIO, path: str) -> _ArrayForm:
    """Return the form of the array in a NumPy file, and leave the file position at the first sample.

    Raises InputError if the file does not have whole numbers, one row per sample.
    """
    numpy_format = np.lib.format
    try:
        version = numpy_format.read_magic(file)
        is_first_version = version == (1, 0)
        read_header = numpy_format.read_array_header_1_0 if is_first_version else numpy_format.read_array_header_2_0
        shape, is_fortran, dtype = read_header(file)
    except Exception:  # The parser of the header raises many types.
        raise InputError(path, "this is not a valid NumPy file") from None
    has_rows = len(shape) == 2
    are_integers = dtype.kind in "uib" and dtype.itemsize <= 8
    if is_fortran and has_rows:
        reason = "the samples of a channel follow each other: save numpy.ascontiguousarray(samples)"
        raise InputError(path, reason)
    if not are_integers or len(shape) not in (1, 2):
        raise InputError(path, f"expected whole numbers, one row per sample, got {dtype} {shape}")
    if has_rows and not 0 < shape[1] <= 1024:
        raise InputError(path, f"expected 1 to 1024 channels, got {shape[1]}")
    return _ArrayForm(dtype, shape[1] if has_rows else None, shape[0])


def read_array_file(file: BinaryIO, path: str, signal_names: SignalNames, rate: float | None) -> Signals:
    """Return the signals of a ``.npy`` file, which contains an array with a row per sample, or a number per sample.

    ``path`` is for errors, ``signal_names`` are the chosen channels, and ``rate`` is the sample rate in Hz, if known.
    """
    array_form = _read_array_form(file, path)
    if array_form.channels is not None:
        channel_count = array_form.channels
    else:
        # Each bit of a number is a channel.
        channel_count = 8 * array_form.dtype.itemsize
    # The channels of an array have no names, only numbers.
    channel_names = [str(number) for number in range(1, channel_count + 1)]
    channel_indices = signal_names.find_channels(channel_names, path)
    # In rows, the chosen columns are packed into one number per sample, so the signals are its bits 0 and 1.
    has_rows = array_form.channels is not None
    signal_bits = range(len(channel_indices)) if has_rows else channel_indices
    samples = _read_array_parts(file, path, array_form, channel_indices)
    edges = read_samples(samples, masks=tuple(1 << bit for bit in signal_bits))
    return Signals.at_rate(edges, rate)


def _read_array_parts(
    file: BinaryIO, path: str, array_form: _ArrayForm, channel_indices: Sequence[int]
) -> Generator[Samples, None, None]:
    """Yield the samples in some rows as unsigned numbers. The amount read is the number of bytes so far.

    ``channel_indices`` are the columns of the signals. If the array has no columns, each number is a sample, and all
    its bits are kept. Raises InputError at the end if samples are missing there.
    """
    dtype = array_form.dtype
    channels = array_form.channels
    row_width = 1 if channels is None else channels
    row_bytes = row_width * dtype.itemsize
    bytes_read = 0
    while data := file.read(max(SAMPLES // row_width, 1) * row_bytes):
        bytes_read += len(data)
        row_count = len(data) // row_bytes
        samples = np.frombuffer(data, dtype, count=row_count * row_width)
        if channels is not None:
            rows = samples.reshape(-1, row_width)
            yield Samples(pack_bits(rows[:, channel_indices]), amount_read=bytes_read)
            continue
        byte_order = dtype.byteorder if dtype.itemsize > 1 else ""
        # Signed numbers are read as unsigned ones of the same bits, and then in the byte order of this machine.
        samples = samples.view(f"{byte_order}u{dtype.itemsize}")
        yield Samples(samples.astype(f"u{dtype.itemsize}", copy=False), amount_read=bytes_read)
    if bytes_read < array_form.sample_count * row_bytes:
        reason = f"this NumPy file ends early: it has {bytes_read // row_bytes} of {array_form.sample_count} samples"
        raise InputError(path, reason)


class _Arrays(NamedTuple):
    """Arrays in an ``.npz`` file: the channels by name and, if available, the times and the sample rate in Hz."""

    channels: dict[str, Any]
    times: Any
    rate: float | None


def _load_arrays(archive: zipfile.ZipFile, path: str) -> _Arrays:
    """Return the arrays of an ``.npz`` file: channels, times and sample rate.

    Raises InputError if an array is damaged or does not contain numbers.
    """
    channels: dict[str, Any] = {}
    times: Any = None
    rate: float | None = None
    for file_name in archive.namelist():
        name = file_name.removesuffix(".npy")
        array = _read_array_in(archive, file_name, path)
        if array.dtype.kind not in "uibf":
            raise InputError(path, f"expected numbers in {quote(name)}, got {array.dtype}")
        if array.ndim == 1 and name.lower() in _NAMES_OF_TIMES:
            times = array.astype(np.float64)
        elif array.ndim:
            channels[name] = array
        elif name.lower() in _NAMES_OF_RATES:
            # An array without dimensions is a single number. If there are several rates, the first one counts.
            if not 0 < array < np.inf:
                raise InputError(path, f"expected a sample rate above 0 in {quote(name)}, got {array}")
            rate = rate or float(array)
    return _Arrays(channels, times, rate)


def read_array_archive(
    archive: zipfile.ZipFile, path: str, signal_names: SignalNames, rate: float | None, threshold: float | None
) -> Signals:
    """Return the signals of an ``.npz`` file: one array of samples, or an array for each channel.

    The names of the arrays are the names of the channels. A channel contains levels (0 and 1) or voltages. A single
    number named ``rate`` or similar gives the sample rate in Hz, and an array named ``time`` or similar gives the
    times in seconds.
    """
    unpacked_bytes = sum(info.file_size for info in archive.infolist())
    if unpacked_bytes > MOST_UNPACKED:
        raise InputError(path, f"the samples have {unpacked_bytes / 1e9:.1f} GB unpacked: save a shorter capture")
    channels, times, rate_in_file = _load_arrays(archive, path)
    sample_rate = rate or rate_in_file
    arrays = list(channels.values())
    # Floating-point numbers are voltages.
    is_array_of_samples = len(arrays) == 1 and times is None and arrays[0].dtype.kind != "f"
    if is_array_of_samples:
        try:
            return read_array(arrays[0], signal_names, sample_rate)
        except TypeError as error:
            raise InputError(path, str(error)) from None
    _check_columns(arrays if times is None else [times, *arrays], path)
    channel_indices = signal_names.find_channels([*channels], path)
    signal_arrays = [arrays[index] for index in channel_indices]
    levels = _convert_to_levels(np.stack(signal_arrays, axis=1), threshold, path)
    # Bit 0 of a packed sample is the level of the first signal.
    samples = pack_bits(levels)
    masks = tuple(1 << bit for bit in range(len(signal_arrays)))
    edges = read_samples([Samples(samples, amount_read=len(samples), times=times)], masks)
    if times is None:
        return Signals.at_rate(edges, sample_rate, total=len(samples))
    is_ascending = (np.diff(times) >= 0).all()
    if not (np.isfinite(times).all() and is_ascending):
        raise InputError(path, "the times are not finite numbers in ascending order")
    return Signals(edges, seconds=1.0, is_sampled=False, total=len(samples))


def _check_columns(columns: list[Any], path: str) -> None:
    """Raise InputError unless all columns have one dimension and the same length."""
    shapes = {column.shape for column in columns}
    if len(shapes) != 1 or any(column.ndim != 1 for column in columns):
        raise InputError(path, "expected one array of samples, or an array of 0 and 1 of the same length per channel")


def _convert_to_levels(cells: Any, threshold: float | None, path: str) -> Any:
    """Return the levels of samples, with a column for each channel. ``cells`` are levels or voltages.

    All numbers are voltages if one of them is neither 0 nor 1, or if there is a ``threshold``. Raises InputError if a
    voltage is not finite.
    """
    if threshold is None and ((cells == 0) | (cells == 1)).all():
        return cells
    if not np.isfinite(cells).all():
        raise InputError(path, "expected finite voltages: remove the samples that are infinite or NaN")
    return Voltages(cells.min(axis=0), cells.max(axis=0), threshold).levels(cells)


def _read_array_in(archive: zipfile.ZipFile, name: str, path: str) -> Any:
    """Return an array from an archive."""
    try:
        return np.lib.format.read_array(io.BytesIO(archive.read(name)), allow_pickle=False)
    except Exception:  # The parser of the header raises many types.
        raise InputError(path, f"{quote(name)} is not a valid NumPy array") from None


#: Names for a sample rate in Hz that a file contains next to its arrays.
_NAMES_OF_RATES: Final = ("rate", "samplerate", "sample_rate", "fs")


#: Names for an array of times in seconds.
_NAMES_OF_TIMES: Final = ("time", "times", "t", "seconds")
