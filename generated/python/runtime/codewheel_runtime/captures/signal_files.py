# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads the captures of logic analyzers: sigrok sessions, CSV, Saleae's binary files, VCD and NumPy files.

Files are recognized by their contents and read in chunks, so memory use does not depend on their size.
"""

from __future__ import annotations

import re
import struct
import zipfile
import zlib
from collections.abc import Generator, Sequence
from configparser import ConfigParser
from configparser import Error as ConfigError
from contextlib import ExitStack, contextmanager
from typing import Any, BinaryIO, Final, NamedTuple

from ..bulk.words import list_names, quote
from ..errors import InputError, UsageError
from ..packages import load
from .array_files import read_array_archive, read_array_file
from .saleae import SALEAE_HEADER, read_saleae
from .signal_text import read_table_signals, read_vcd_signals
from .signals import MOST_UNPACKED, SAMPLES, Samples, SignalNames, Signals, read_samples
from .table_forms import HEADER, HINT, parse_rate

np: Any = load("numpy")


@contextmanager
def open_signals(
    paths: Sequence[str], signal_names: SignalNames, rate: float | None = None, threshold: float | None = None
) -> Generator[Signals, None, None]:
    """Open a capture.

    Args:
        paths: The file. Saleae binary files contain one signal each: the clock, then the data line.
        signal_names: The channels of the signals.
        rate: Sample rate in Hz, needed if the file does not specify it.
        threshold: Voltage above which the level is 1, for a table of voltages.

    Raises:
        InputError: The file is not a capture, or does not have these channels.
        UsageError: The number of files differs from the number of signals for Saleae binary files, or from 1 for other
            formats. Or both signals are on the same channel.
        OSError: A file cannot be read.
    """
    with ExitStack() as stack:
        files = [stack.enter_context(open(path, "rb")) for path in paths]
        first_bytes_of_files = [file.read(HEADER) for file in files]
        for file in files:
            file.seek(0)
        are_saleae = [first_bytes.startswith(SALEAE_HEADER) for first_bytes in first_bytes_of_files]
        if any(are_saleae):
            # A serial line has no clock, so it is the only signal.
            signal_count = 1 if signal_names.clock is None else 2
            _check_saleae_files(paths, are_saleae, signal_count)
            signals = read_saleae(files[::-1], paths[::-1]) if signal_names.exchanged else read_saleae(files, paths)
        elif len(files) != 1:
            raise UsageError("give one file: only binary files of Saleae have one signal each")
        else:
            signals = _open_single_file(stack, files[0], paths[0], signal_names, rate, threshold)
        try:
            yield signals
        finally:
            signals.edges.close()


def _check_saleae_files(paths: Sequence[str], are_saleae: Sequence[bool], signal_count: int) -> None:
    """Raise UsageError unless there is one binary file of Saleae for each signal.

    ``are_saleae`` is True for each file that is a binary file of Saleae.
    """
    if not all(are_saleae) or len(paths) != signal_count:
        expected_files = "the file of the data line"
        if signal_count == 2:
            expected_files = "two files, one for the clock and one for the data line"
        raise UsageError(f"each binary file of Saleae has one signal: give {expected_files}")
    if len({*paths}) < len(paths):
        raise UsageError("the clock and the data line are the same file: give one file for each")


def _open_single_file(
    stack: ExitStack, file: BinaryIO, path: str, signal_names: SignalNames, rate: float | None, threshold: float | None
) -> Signals:
    """Return the signals of a capture in one file. Its first bytes show the format.

    The formats are a ZIP file (sigrok or NumPy), a NumPy file, a VCD file, and a table of text. ``stack`` closes an
    archive. ``signal_names`` are the channels of the signals, ``rate`` is the chosen sample rate in Hz, and
    ``threshold`` the voltage above which the level is 1 in a table of voltages.
    """
    first_bytes = file.read(HEADER)
    file.seek(0)
    # Binary formats begin with a fixed mark. All other files are text, which contains no bytes of 0.
    if first_bytes.startswith(b"PK"):
        return _read_archive(stack, file, path, signal_names, rate, threshold)
    if first_bytes.startswith(b"\x93NUMPY"):
        return read_array_file(file, path, signal_names, rate)
    if not first_bytes:
        raise InputError(path, "the file is empty")
    if b"\0" in first_bytes:
        raise InputError(path, f"this is not a capture: {HINT}")
    # A value change dump begins with a command such as $date or $timescale.
    if first_bytes.lstrip().startswith(b"$"):
        return read_vcd_signals(file, path, signal_names)
    return read_table_signals(file, path, first_bytes, signal_names, rate, threshold)


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
    stack: ExitStack, file: BinaryIO, path: str, signal_names: SignalNames, rate: float | None, threshold: float | None
) -> Signals:
    """Return the signals of a ZIP file, which contains a sigrok session or NumPy arrays.

    ``stack`` closes the file.
    """
    try:
        archive = stack.enter_context(zipfile.ZipFile(file))
        file_names = archive.namelist()
    except _ERRORS_OF_DAMAGED_ZIP:
        raise InputError(path, "this is not a valid sigrok session") from None
    has_arrays = any(file_name.endswith(".npy") for file_name in file_names)
    if has_arrays and "metadata" not in file_names:
        return read_array_archive(archive, path, signal_names, rate, threshold)
    return _read_session(archive, path, signal_names, rate)


class _SessionMetadata(NamedTuple):
    """Metadata of a sigrok session.

    Attributes:
        sample_bytes: Number of bytes in a sample.
        file_stem: Name of the files of samples, without their numbers. Empty if there are no logic signals.
        probes: Names of the probes in use, by number. The lowest bit of a sample is probe 1.
        rate: Sample rate in Hz, or None if it is not known.
    """

    sample_bytes: int
    file_stem: str
    probes: dict[int, str]
    rate: float | None


def _read_session_metadata(archive: zipfile.ZipFile, path: str) -> _SessionMetadata:
    """Return the metadata of a session, which is a file in INI format. Raises InputError if it is damaged."""
    try:
        with archive.open("metadata") as metadata:
            text = metadata.read(HEADER).decode("utf-8", "replace")
        config = ConfigParser(interpolation=None, strict=False)
        config.read_string(text)
        devices = [dict(config[name]) for name in config.sections() if "capturefile" in config[name]]
        device: dict[str, str] = devices[0] if devices else {}
        sample_bytes = _parse_small_number(device.get("unitsize", "1"))
        # The names of the channels are the values of the keys probe1, probe2 and so on.
        probe_keys = [key for key in device if re.fullmatch(r"probe[0-9]{1,3}", key)]
        probes = {_parse_small_number(key.removeprefix("probe")): device[key] for key in probe_keys}
    except (KeyError, ConfigError, ValueError, *_ERRORS_OF_DAMAGED_ZIP):
        raise InputError(path, "this is not a valid sigrok session") from None
    return _SessionMetadata(
        sample_bytes=sample_bytes,
        file_stem=device.get("capturefile", ""),
        probes=probes,
        rate=parse_rate(device.get("samplerate", "")),
    )


def _read_session(archive: zipfile.ZipFile, path: str, signal_names: SignalNames, rate: float | None) -> Signals:
    """Return the signals of a session: a ZIP file with metadata, and samples in files of a few megabytes."""
    metadata = _read_session_metadata(archive, path)
    sample_bytes, probes = metadata.sample_bytes, metadata.probes
    if not metadata.file_stem:
        raise InputError(path, "this sigrok session has no logic signals")
    if sample_bytes not in (1, 2, 4, 8):
        raise InputError(path, f"samples of {sample_bytes} bytes are not supported: expected 1, 2, 4 or 8")
    # A sample has a bit for each probe.
    bits_per_sample = 8 * sample_bytes
    probe_numbers = [number for number in sorted(probes) if 1 <= number <= bits_per_sample]
    channels = [probes[number] for number in probe_numbers]
    # The number of a probe is also accepted, although only probes in use have names.
    numbered_signal_names = signal_names._replace(
        clock=_find_numbered_probe(signal_names.clock, probes, probe_numbers, path),
        data=_find_numbered_probe(signal_names.data, probes, probe_numbers, path),
    )
    channel_indices = numbered_signal_names.find_channels(channels, path)
    chosen_probes = [probe_numbers[index] for index in channel_indices]
    # The lowest bit of a sample is probe 1.
    masks = tuple(1 << (number - 1) for number in chosen_probes)
    sample_files = _list_sample_files(archive, metadata.file_stem, path)
    total = _measure_unpacked(sample_files, path)
    samples = _unpack_samples(archive, sample_files, sample_bytes, path)
    edges = read_samples(samples, masks)
    return Signals.at_rate(edges, rate or metadata.rate, total)


def _find_numbered_probe(name: Any, probes: dict[int, str], probe_numbers: list[int], path: str) -> Any:
    """Return a channel chosen in a session, in the form that ``SignalNames`` expects.

    A number is the number of a probe, as in the session. It becomes the place among the probes in use, counted from 1:
    with the probes 2 and 5, ``"5"`` becomes ``"2"``. Any other name, or None, is returned unchanged. ``probes``
    contains the names of the probes in use by number, and ``probe_numbers`` these numbers in order.

    Raises:
        InputError: No probe in use has this number.
    """
    chosen_name = name or ""
    is_number = chosen_name.isascii() and chosen_name.isdigit() and len(chosen_name) < 4
    is_name_of_probe = chosen_name in probes.values()
    if not is_number or is_name_of_probe:
        return name
    probe_number = int(chosen_name)
    if probe_number not in probe_numbers:
        probe_names = [*probes.values()]
        raise InputError(path, f"no channel {quote(chosen_name)}; the channels are {list_names(probe_names)}")
    place_from_1 = probe_numbers.index(probe_number) + 1
    return str(place_from_1)


def _list_sample_files(archive: zipfile.ZipFile, file_stem: str, path: str) -> list[zipfile.ZipInfo]:
    """Return the files of samples in a session in order.

    They are called ``logic-1`` (the stem), or ``logic-1-1``, ``logic-1-2`` and so on. Raises InputError if a file
    in the sequence is missing.
    """
    files_by_name = {sample_file.filename: sample_file for sample_file in archive.infolist()}
    if file_stem in files_by_name:
        return [files_by_name[file_stem]]
    sample_files: list[zipfile.ZipInfo] = []
    while (next_name := f"{file_stem}-{len(sample_files) + 1}") in files_by_name:
        sample_files.append(files_by_name[next_name])
    numbered_signal_names = [name for name in files_by_name if re.fullmatch(re.escape(file_stem) + "-[0-9]+", name)]
    if len(numbered_signal_names) > len(sample_files):
        raise InputError(path, f"this sigrok session is damaged: its file {next_name} is missing")
    return sample_files


def _measure_unpacked(sample_files: list[zipfile.ZipInfo], path: str) -> int:
    """Return the total unpacked size of the sample files in bytes.

    Raises:
        InputError: There are no files, or they are too large.
    """
    if not sample_files:
        raise InputError(path, "this sigrok session has no samples")
    total = sum(sample_file.file_size for sample_file in sample_files)
    if total > MOST_UNPACKED:
        sizes = f"{total / 1e9:.1f} GB unpacked, and at most {MOST_UNPACKED / 1e9:.1f} GB are read"
        raise InputError(path, f"the samples have {sizes}: save a shorter session")
    return total


def _unpack_samples(
    archive: zipfile.ZipFile, sample_files: list[zipfile.ZipInfo], sample_bytes: int, path: str
) -> Generator[Samples, None, None]:
    """Yield the samples of a session as numbers. The amount read is the number of bytes so far.

    A sample has ``sample_bytes`` bytes, and may span two files. An incomplete sample at the end of the
    session is ignored.
    """
    bytes_read = 0
    remainder = b""
    try:
        for sample_file in sample_files:
            with archive.open(sample_file) as file:
                while block := file.read(SAMPLES * sample_bytes):
                    bytes_read += len(block)
                    data = remainder + block
                    sample_count = len(data) // sample_bytes
                    remainder = data[sample_count * sample_bytes :]
                    samples = np.frombuffer(data, f"<u{sample_bytes}", count=sample_count)
                    yield Samples(samples, amount_read=bytes_read)
    except _ERRORS_OF_DAMAGED_ZIP as error:
        # Some errors have no message.
        reason = str(error) or "they end early"
        raise InputError(path, f"the samples are damaged: {reason}", place=f"offset {bytes_read}") from None


def _parse_small_number(text: str) -> int:
    """Return a decimal number of less than 10 digits. Raises ValueError for other text."""
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise ValueError(text)
    return int(text)
