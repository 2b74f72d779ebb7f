# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads the captures of logic analyzers: sigrok sessions, CSV, Saleae's binary files, VCD and NumPy files.

Files are recognized by their contents and read in chunks, so memory use does not depend on their size.
"""

from __future__ import annotations

import io
import re
import struct
import zipfile
import zlib
from collections.abc import Generator, Sequence
from configparser import ConfigParser
from configparser import Error as ConfigError
from contextlib import ExitStack, contextmanager
from typing import Any, BinaryIO, Final, NamedTuple

from ..bulk.words import listed, short
from ..errors import InputError, UsageError
from ..packages import load
from .signal_text import Voltages, measure_size, read_table_signals, read_vcd_signals
from .signals import SAMPLES, SignalNames, Signals, merge_edges, pack_bits, read_array, read_samples
from .table_forms import HEADER, HINT, parse_rate

np: Any = load("numpy")

_SALEAE_HEADER: Final = b"<SALEAE>"


@contextmanager
def open_signals(
    paths: Sequence[str], names: SignalNames, rate: float | None = None, threshold: float | None = None
) -> Generator[Signals, None, None]:
    """Open a capture.

    Args:
        paths: The file. Saleae's binary files have one signal each: the clock, then the data line.
        names: The channels of the signals.
        rate: Sample rate in Hz, needed if the file does not specify it.
        threshold: Voltage above which the level is 1, for a table of voltages.

    Raises:
        InputError: The file is not a capture, or does not have these channels.
        UsageError: The number of files differs from the number of signals in binary files of Saleae, or not 1 in other
            formats. Or both signals are on the same channel.
        OSError: A file cannot be read.
    """
    with ExitStack() as stack:
        files = [stack.enter_context(open(path, "rb")) for path in paths]
        heads = [file.read(HEADER) for file in files]
        for file in files:
            file.seek(0)
        is_saleae = [head.startswith(_SALEAE_HEADER) for head in heads]
        # A serial line has no clock, so it is the only signal.
        signal_count = 1 if names.clock is None else 2
        if any(is_saleae):
            if not all(is_saleae) or len(files) != signal_count:
                expected_files = "the file of the data line"
                if signal_count == 2:
                    expected_files = "two files, one for the clock and one for the data line"
                raise UsageError(f"each binary file of Saleae has one signal: give {expected_files}")
            if len({*paths}) < len(paths):
                raise UsageError("the clock and the data line are the same file: give one file for each")
            signals = _read_saleae(files[::-1], paths[::-1]) if names.exchanged else _read_saleae(files, paths)
        elif len(files) != 1:
            raise UsageError("give one file: only binary files of Saleae have one signal each")
        else:
            signals = _open_single_file(stack, files[0], paths[0], names, rate, threshold)
        try:
            yield signals
        finally:
            signals.edges.close()


def _open_single_file(
    stack: ExitStack, file: BinaryIO, path: str, names: SignalNames, rate: float | None, threshold: float | None
) -> Signals:
    """Return the signals of a capture in one file. Its first bytes show the format.

    The formats are a ZIP file (sigrok or NumPy), a NumPy file, a VCD file, and a table of text. ``stack`` closes an
    archive. ``names`` are the channels of the signals, ``rate`` is the chosen sample rate in Hz, and ``threshold`` the
    voltage above which the level is 1 in a table of voltages.
    """
    head = file.read(HEADER)
    file.seek(0)
    # Binary formats begin with a fixed mark. All other files are text, which contains no bytes of 0.
    if head.startswith(b"PK"):
        return _read_archive(stack, file, path, names, rate, threshold)
    if head.startswith(b"\x93NUMPY"):
        return _read_array_file(file, path, names, rate)
    if not head:
        raise InputError(path, "", "the file is empty")
    if b"\0" in head:
        raise InputError(path, "", f"this is not a capture: {HINT}")
    # A value change dump begins with a command such as $date or $timescale.
    if head.lstrip().startswith(b"$"):
        return read_vcd_signals(file, path, names)
    return read_table_signals(file, path, head, names, rate, threshold)


# sigrok sessions

#: Most bytes of samples in a session, when unpacked: three minutes at 24 MHz, which take a minute to read.
_MOST_UNPACKED: Final = 1 << 32
#: Errors that a damaged ZIP file causes.
_ERRORS_OF_DAMAGED_ZIP: Final = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    EOFError,
    OSError,
    OverflowError,
    RuntimeError,
)


def _read_archive(
    stack: ExitStack, file: BinaryIO, path: str, names: SignalNames, rate: float | None, threshold: float | None
) -> Signals:
    """Return the signals of a ZIP file, which can be a session of sigrok, or arrays of NumPy.

    ``stack`` closes the file.
    """
    try:
        archive = stack.enter_context(zipfile.ZipFile(file))
        file_names = archive.namelist()
    except _ERRORS_OF_DAMAGED_ZIP:
        raise InputError(path, "", "this is not a valid sigrok session") from None
    has_arrays = any(file_name.endswith(".npy") for file_name in file_names)
    if has_arrays and "metadata" not in file_names:
        return _read_array_archive(archive, path, names, rate, threshold)
    return _read_session(archive, path, names, rate)


def _read_session(archive: zipfile.ZipFile, path: str, names: SignalNames, rate: float | None) -> Signals:
    """Return the signals of a session: a ZIP file with metadata, and samples in files of a few megabytes."""
    try:
        with archive.open("metadata") as metadata:
            text = metadata.read(HEADER).decode("utf-8", "replace")
        config = ConfigParser(interpolation=None, strict=False)
        config.read_string(text)
        devices = [dict(config[name]) for name in config.sections() if "capturefile" in config[name]]
        device: dict[str, str] = devices[0] if devices else {}
        # Number of bytes of a sample, and the name of the files of samples without their numbers.
        size, stem = _parse_small_number(device.get("unitsize", "1")), device.get("capturefile", "")
        # The names of the channels are the values of the keys probe1, probe2 and so on.
        probe_keys = [key for key in device if re.fullmatch(r"probe[0-9]{1,3}", key)]
        probes = {_parse_small_number(key[5:]): device[key] for key in probe_keys}
    except (KeyError, ConfigError, ValueError, *_ERRORS_OF_DAMAGED_ZIP):
        raise InputError(path, "", "this is not a valid sigrok session") from None
    if not stem:
        raise InputError(path, "", "this sigrok session has no logic signals")
    if size not in (1, 2, 4, 8):
        raise InputError(path, "", f"samples of {size} bytes are not supported: expected 1, 2, 4 or 8")
    numbers = [number for number in sorted(probes) if 1 <= number <= 8 * size]
    channels = [probes[number] for number in numbers]
    # The number of a probe is also accepted, although only probes in use have names.
    numbered_names = names._replace(
        clock=_find_numbered_probe(names.clock, probes, numbers, path),
        data=_find_numbered_probe(names.data, probes, numbers, path),
    )
    # Places are indices in ``channels``. The lowest bit is probe 1.
    masks = tuple(1 << (numbers[place] - 1) for place in numbered_names.places(channels, path))
    entries = _list_sample_files(archive, stem, path)
    if not entries:
        raise InputError(path, "", "this sigrok session has no samples")
    sample_rate = rate or parse_rate(device.get("samplerate", ""))
    total = sum(info.file_size for info in entries)
    if total > _MOST_UNPACKED:
        sizes = f"{total / 1e9:.1f} GB unpacked, and at most {_MOST_UNPACKED / 1e9:.1f} GB are read"
        raise InputError(path, "", f"the samples have {sizes}: save a shorter session")
    parts = _unpack_samples(archive, entries, size, path)
    seconds = 1 / sample_rate if sample_rate else None
    return Signals(read_samples(parts, masks), seconds=seconds, is_sampled=True, total=total)


def _find_numbered_probe(name: Any, probes: dict[int, str], numbers: list[int], path: str) -> Any:
    """Return the choice of a channel in a session in the form that ``SignalNames`` expects.

    A number is the number of a probe, as in the session. It becomes the place among the probes in use, from 1: with the
    probes 2 and 5, ``"5"`` becomes ``"2"``. Any other name, or None, is returned unchanged. ``probes`` contains the
    names of the probes in use by number, and ``numbers`` these numbers in order.

    Raises:
        InputError: No probe in use has this number.
    """
    text = name or ""
    is_number = text.isascii() and text.isdigit() and len(text) < 4
    if not is_number or text in probes.values():
        return name
    if int(text) not in numbers:
        raise InputError(path, "", f"no channel {short(text)}; the channels are {listed([*probes.values()])}")
    return str(numbers.index(int(text)) + 1)


def _list_sample_files(archive: zipfile.ZipFile, stem: str, path: str) -> list[zipfile.ZipInfo]:
    """Return the files of samples in a session in order.

    They are called ``logic-1`` (the stem), or ``logic-1-1``, ``logic-1-2`` and so on. Raises InputError if a file
    between others is missing.
    """
    named = {info.filename: info for info in archive.infolist()}
    if stem in named:
        return [named[stem]]
    parts: list[zipfile.ZipInfo] = []
    while (name := f"{stem}-{len(parts) + 1}") in named:
        parts.append(named[name])
    numbered_names = [file_name for file_name in named if re.fullmatch(re.escape(stem) + "-[0-9]+", file_name)]
    if len(numbered_names) > len(parts):
        raise InputError(path, "", f"this sigrok session is damaged: its file {name} is missing")
    return parts


def _unpack_samples(
    archive: zipfile.ZipFile, entries: list[zipfile.ZipInfo], size: int, path: str
) -> Generator[tuple[Any, int, Any], None, None]:
    """Yield the samples of a session as numbers, the number of bytes read, and None, because samples have no times.

    A sample has ``size`` bytes, and can begin in one file and end in the next. An incomplete sample at the end of the
    session is ignored.
    """
    bytes_read = 0
    remainder = b""
    try:
        for info in entries:
            with archive.open(info) as file:
                while block := file.read(SAMPLES * size):
                    bytes_read += len(block)
                    data = remainder + block
                    sample_count = len(data) // size
                    remainder = data[sample_count * size :]
                    yield np.frombuffer(data, f"<u{size}", count=sample_count), bytes_read, None
    except _ERRORS_OF_DAMAGED_ZIP as error:
        raise InputError(
            path, f"offset {bytes_read}", f"the samples are damaged: {error or 'they end early'}"
        ) from None


def _parse_small_number(text: str) -> int:
    """Return a decimal number of less than 10 digits. Raises ValueError for other texts."""
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise ValueError(text)
    return int(text)


# NumPy files


class _ArrayForm(NamedTuple):
    """Form of an array of samples: its NumPy type, and the numbers of channels and samples.

    If ``channels`` is None, each number is a sample whose bits are the channels.
    """

    kind: Any
    channels: int | None
    sample_count: int


def _read_array_form(file: BinaryIO, path: str) -> _ArrayForm:
    """Return the form of the array in a NumPy file, and leave the file at its first sample.

    Raises InputError if the file does not have whole numbers, one row per sample.
    """
    numpy_format = np.lib.format
    try:
        version = numpy_format.read_magic(file)
        is_first_version = version == (1, 0)
        read_header = numpy_format.read_array_header_1_0 if is_first_version else numpy_format.read_array_header_2_0
        shape, is_fortran, dtype = read_header(file)
    except Exception:  # The parser of the header raises many types.
        raise InputError(path, "", "this is not a valid NumPy file") from None
    has_rows = len(shape) == 2
    are_integers = dtype.kind in "uib" and dtype.itemsize <= 8
    if is_fortran and has_rows:
        reason = "the samples of a channel follow each other: save numpy.ascontiguousarray(samples)"
        raise InputError(path, "", reason)
    if not are_integers or len(shape) not in (1, 2):
        raise InputError(path, "", f"expected whole numbers, one row per sample, got {dtype} {shape}")
    if has_rows and not 0 < shape[1] <= 1024:
        raise InputError(path, "", f"expected 1 to 1024 channels, got {shape[1]}")
    return _ArrayForm(dtype, shape[1] if has_rows else None, shape[0])


def _read_array_file(file: BinaryIO, path: str, names: SignalNames, rate: float | None) -> Signals:
    """Return the signals of a ``.npy`` file."""
    form = _read_array_form(file, path)
    channels = form.channels
    channel_count = 8 * form.kind.itemsize if channels is None else channels
    places = names.places([str(number) for number in range(1, channel_count + 1)], path)
    # Bits of the signals in a sample. The chosen columns of rows are packed, so their bits are numbered from 0.
    bits = places if channels is None else range(len(places))
    parts = _read_array_parts(file, path, form, places)
    edges = read_samples(parts, tuple(1 << bit for bit in bits))
    return Signals(edges, seconds=1 / rate if rate else None, is_sampled=True)


def _read_array_parts(
    file: BinaryIO, path: str, form: _ArrayForm, places: Sequence[int]
) -> Generator[tuple[Any, int, Any], None, None]:
    """Yield the samples of some rows as unsigned numbers, the number of bytes read so far, and None instead of times.

    ``places`` are the columns of the signals. If the array has no columns, each number is a sample, and all its bits
    are kept. Raises InputError at the end if samples are missing there.
    """
    dtype = form.kind
    channels = form.channels
    row_width = 1 if channels is None else channels
    row_bytes = row_width * dtype.itemsize
    bytes_read = 0
    while data := file.read(max(SAMPLES // row_width, 1) * row_bytes):
        bytes_read += len(data)
        row_count = len(data) // row_bytes
        samples = np.frombuffer(data, dtype, count=row_count * row_width)
        if channels is not None:
            yield pack_bits(samples.reshape(-1, row_width)[:, places]), bytes_read, None
            continue
        byte_order = dtype.byteorder if dtype.itemsize > 1 else ""
        # Signed numbers are read as unsigned ones of the same bits, and then in the byte order of this machine.
        samples = samples.view(f"{byte_order}u{dtype.itemsize}")
        yield samples.astype(f"u{dtype.itemsize}", copy=False), bytes_read, None
    if bytes_read < form.sample_count * row_bytes:
        reason = f"this NumPy file ends early: it has {bytes_read // row_bytes} of {form.sample_count} samples"
        raise InputError(path, "", reason)


class _Arrays(NamedTuple):
    """Arrays of an ``.npz`` file: the channels by name, and the times and the sample rate in Hz, if it has them."""

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
            raise InputError(path, "", f"expected numbers in {short(name)}, got {array.dtype}")
        if array.ndim == 1 and name.lower() in _NAMES_OF_TIMES:
            times = array.astype(np.float64)
        elif array.ndim:
            channels[name] = array
        elif name.lower() in _NAMES_OF_RATES:
            # An array without dimensions is a single number. If there are several rates, the first one counts.
            if not 0 < array < np.inf:
                raise InputError(path, "", f"expected a sample rate above 0 in {short(name)}, got {array}")
            rate = rate or float(array)
    return _Arrays(channels, times, rate)


def _read_array_archive(
    archive: zipfile.ZipFile, path: str, names: SignalNames, rate: float | None, threshold: float | None
) -> Signals:
    """Return the signals of an ``.npz`` file: one array of samples, or an array for each channel.

    The names of the arrays are the names of the channels. A channel has levels, 0 and 1, or voltages. A single number
    named ``rate`` or similar gives the sample rate in Hz, and an array named ``time`` or similar the times in seconds.
    """
    total = sum(info.file_size for info in archive.infolist())
    if total > _MOST_UNPACKED:
        raise InputError(path, "", f"the samples have {total / 1e9:.1f} GB unpacked: save a shorter capture")
    channels, times, rate_in_file = _load_arrays(archive, path)
    sample_rate = rate or rate_in_file
    arrays = list(channels.values())
    if len(arrays) == 1 and arrays[0].dtype.kind != "f" and times is None:
        try:
            return read_array(arrays[0], names, sample_rate)
        except TypeError as error:
            raise InputError(path, "", str(error)) from None
    columns = arrays if times is None else [times, *arrays]
    shapes = {column.shape for column in columns}
    if len(shapes) != 1 or any(column.ndim != 1 for column in columns):
        raise InputError(
            path, "", "expected one array of samples, or an array of 0 and 1 of the same length per channel"
        )
    places = names.places([*channels], path)
    cells = np.stack([arrays[place] for place in places], 1)
    samples = pack_bits(_convert_to_levels(cells, threshold, path))
    masks = tuple(1 << bit for bit in range(len(places)))
    edges = read_samples([(samples, len(samples), times)], masks)
    if times is None:
        return Signals(edges, seconds=1 / sample_rate if sample_rate else None, is_sampled=True, total=len(samples))
    if not (np.isfinite(times).all() and (np.diff(times) >= 0).all()):
        raise InputError(path, "", "the times are not finite numbers in ascending order")
    return Signals(edges, seconds=1.0, is_sampled=False, total=len(samples))


def _convert_to_levels(cells: Any, threshold: float | None, path: str) -> Any:
    """Return the levels of samples, with a column for each channel. ``cells`` are levels or voltages.

    All numbers are voltages if one of them is neither 0 nor 1, or if there is a ``threshold``. Raises InputError if a
    voltage is not finite.
    """
    if threshold is None and ((cells == 0) | (cells == 1)).all():
        return cells
    if not np.isfinite(cells).all():
        raise InputError(path, "", "expected finite voltages: remove the samples that are infinite or NaN")
    return Voltages(cells.min(axis=0), cells.max(axis=0), threshold).levels(cells)


def _read_array_in(archive: zipfile.ZipFile, name: str, path: str) -> Any:
    """Return an array from an archive."""
    try:
        return np.lib.format.read_array(io.BytesIO(archive.read(name)), allow_pickle=False)
    except Exception:  # The parser of the header raises many types.
        raise InputError(path, "", f"{short(name)} is not a valid NumPy array") from None


#: Names of a sample rate in Hz next to the arrays of a file.
_NAMES_OF_RATES: Final = ("rate", "samplerate", "sample_rate", "fs")
#: Names of an array of times in seconds.
_NAMES_OF_TIMES: Final = ("time", "times", "t", "seconds")


# Saleae's binary files


#: Number of edges that are read at once. Each takes eight bytes.
_EDGES_AT_ONCE: Final = SAMPLES // 8


class _Saleae:
    """Binary file of one digital channel, version 0 or 1. Version 1 has several chunks with gaps between them.

    ``chunks`` is their number. ``end`` is the latest end of the chunks read so far, in seconds. ``_start`` is the
    beginning of the last chunk. ``_ready`` contains the first level and the number of edges of the first chunk, whose
    header is read when the file is opened.
    """

    def __init__(self, file: BinaryIO, path: str) -> None:
        self._file = file
        self._path = path
        # Eight bytes of identification, then two numbers. Kind 0 is a digital channel.
        version, channel_kind = struct.unpack("<8xii", self._read_exactly(16))
        if channel_kind != 0:
            raise InputError(path, "", "this Saleae file has analog values: export the digital channels")
        if version not in (0, 1):
            raise InputError(path, "", f"Saleae's binary format {version} is not supported: export as CSV")
        self._has_rate = version == 1
        self.chunks = 1
        if self._has_rate:
            (self.chunks,) = struct.unpack("<Q", self._read_exactly(8))
        # The latest end of a chunk so far, in seconds. The first level and the number of edges of the first chunk.
        self.end = 0.0
        self._ready = (0, 0)
        if self.chunks:
            self._ready = self._read_chunk()

    def _read_exactly(self, size: int) -> bytes:
        """Return the next ``size`` bytes. Raises InputError if there are fewer bytes."""
        data = self._file.read(size)
        if len(data) != size:
            raise InputError(self._path, "", "this Saleae file ends early")
        return data

    def _read_chunk(self) -> tuple[int, int]:
        """Read the header of the next chunk. Return its first level and the number of its edges, which follow.

        Raises InputError if the header is damaged.
        """
        # First level, sample rate in version 1, begin, end and number of edges.
        header_format = "<IdddQ" if self._has_rate else "<IddQ"
        header = struct.Struct(header_format)
        # The sample rate is not used, because times are in seconds.
        level, *_, begin, end, count = header.unpack(self._read_exactly(header.size))
        if not (np.isfinite(begin) and np.isfinite(end)) or level > 1:
            raise InputError(self._path, "", "this Saleae file is damaged")
        self._start = begin
        self.end = max(self.end, end)
        return int(level), int(count)

    def edges(self) -> Generator[tuple[int, Any, int], None, None]:
        """Yield the level before some edges, their times, and the number of bytes read so far.

        The first part has no edges, but shows the level at the beginning.
        """
        last_time = -np.inf
        level, _ = self._ready
        yield level, np.zeros(0), self._file.tell()
        for chunk_index in range(self.chunks):
            first_level, count = self._ready if chunk_index == 0 else self._read_chunk()
            if self._start < last_time:
                raise InputError(self._path, "", "the parts of this Saleae file are not in ascending order")
            if first_level != level:
                # The signal changed in the gap before this chunk, which is reported as an edge at its start.
                level_before = level
                level = first_level
                last_time = self._start
                yield level_before, np.array([self._start]), self._file.tell()
            while count:
                read_count = min(count, _EDGES_AT_ONCE)
                edge_times = self._read_edge_times(read_count, last_time)
                yield level, edge_times, self._file.tell()
                count -= read_count
                last_time = float(edge_times[-1])
                # An odd number of edges inverts the level.
                level ^= read_count & 1
        if self._file.read(1):
            raise InputError(self._path, "", "this Saleae file is damaged: more bytes follow its last edge")

    def _read_edge_times(self, count: int, last_time: float) -> Any:
        """Return the next ``count`` edge times. Raises InputError unless they ascend from ``last_time``."""
        # The time of each edge is a number of eight bytes.
        edge_times = np.frombuffer(self._read_exactly(8 * count), "<f8")
        are_finite = np.isfinite(edge_times).all()
        if not are_finite or edge_times[0] < last_time or (np.diff(edge_times) < 0).any():
            raise InputError(self._path, "", "the times of this Saleae file are not in ascending order")
        return edge_times


def _read_saleae(files: Sequence[BinaryIO], paths: Sequence[str]) -> Signals:
    """Return the signals of Saleae's binary files, one per file."""
    readers = [_Saleae(file, path) for file, path in zip(files, paths, strict=True)]
    edge_streams = [reader.edges() for reader in readers]
    edges = merge_edges(edge_streams, end=lambda: max(reader.end for reader in readers))
    return Signals(edges, seconds=1.0, is_sampled=False, total=sum(map(measure_size, files)))
