# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads the captures of logic analysers: sigrok sessions, CSV, Saleae's binary files, VCD and NumPy files.

Files are recognised by their contents and read in chunks, so memory use does not depend on their size.
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
from importlib import import_module
from typing import Any, BinaryIO, Final

from .inputs import InputError, UsageError, listed, short
from .signals import SAMPLES, Edges, Names, Signals, merged, of_samples, packed

np: Any = import_module("numpy")

#: Number of bytes of text that are read at once, which is also the limit for a line.
_BLOCK: Final = 1 << 20
#: Limit for the size of a header.
_HEADER: Final = 1 << 16
_SALEAE: Final = b"<SALEAE>"
_HINT: Final = "expected a sigrok session or CSV, a Saleae CSV or binary file, VCD, a table of 0 and 1, or a NumPy file"


@contextmanager
def opened_signals(paths: Sequence[str], names: Names, rate: float | None = None) -> Generator[Signals, None, None]:
    """Open a capture.

    Args:
        paths: The file. Saleae's binary files have one signal each: the clock, then the data line.
        names: The channels of the signals.
        rate: Sample rate in Hz, needed if the file does not specify it.

    Raises:
        InputError: The file is not a capture, or does not have these channels.
        UsageError: There are several files, but not one signal in each.
        OSError: A file cannot be read.
    """
    with ExitStack() as stack:
        files = [stack.enter_context(open(path, "rb")) for path in paths]
        heads = [file.read(_HEADER) for file in files]
        for file in files:
            file.seek(0)
        is_saleae = [head.startswith(_SALEAE) for head in heads]
        wanted = 1 if names.clock is None else 2
        if any(is_saleae):
            if not all(is_saleae) or len(files) != wanted:
                lines = (
                    "the file of the data line" if wanted == 1 else "two files, that of the clock and of the data line"
                )
                raise UsageError(f"each binary file of Saleae has one signal: give {lines}")
            found = _saleae(files, paths)
        elif len(files) != 1:
            raise UsageError("give one file: only binary files of Saleae have one signal each")
        else:
            found = _one(stack, files[0], paths[0], heads[0], names, rate)
        try:
            yield found
        finally:
            found.edges.close()


def _one(stack: ExitStack, file: BinaryIO, path: str, head: bytes, names: Names, rate: float | None) -> Signals:
    if head.startswith(b"PK"):
        return _session(stack, file, path, names, rate)
    if head.startswith(b"\x93NUMPY"):
        return _array(file, path, names, rate)
    if not head:
        raise InputError(path, "", "the file is empty")
    if b"\0" in head:
        raise InputError(path, "", f"this is not a capture: {_HINT}")
    if head.lstrip().startswith(b"$"):
        return _vcd(file, path, names)
    return _text(file, path, head, names, rate)


# sigrok sessions

#: Most bytes of samples in a session, when unpacked: three minutes at 24 MHz, which take a minute to read.
_MOST_UNPACKED: Final = 1 << 32
#: Errors that a damaged ZIP file causes.
_DAMAGED: Final = (zipfile.BadZipFile, zlib.error, struct.error, EOFError, OSError, OverflowError, RuntimeError)


def _session(stack: ExitStack, file: BinaryIO, path: str, names: Names, rate: float | None) -> Signals:
    """Return the signals of a session: a ZIP file with metadata, and samples in files of a few megabytes."""
    try:
        archive = stack.enter_context(zipfile.ZipFile(file))
        with archive.open("metadata") as entry:
            text = entry.read(_HEADER).decode("utf-8", "replace")
        config = ConfigParser(interpolation=None, strict=False)
        config.read_string(text)
        devices = [dict(config[name]) for name in config.sections() if "capturefile" in config[name]]
        device: dict[str, str] = devices[0] if devices else {}
        size, stem = _whole(device.get("unitsize", "1")), device.get("capturefile", "")
        probes = {_whole(key[5:]): value for key, value in device.items() if re.fullmatch(r"probe[0-9]{1,3}", key)}
    except (KeyError, ConfigError, ValueError, *_DAMAGED):
        raise InputError(path, "", "this is not a valid sigrok session") from None
    if not stem:
        raise InputError(path, "", "this sigrok session has no logic signals")
    if size not in (1, 2, 4, 8):
        raise InputError(path, "", f"samples of {size} bytes are not supported: expected 1, 2, 4 or 8")
    numbers = [number for number in sorted(probes) if 1 <= number <= 8 * size]
    channels = [probes[number] for number in numbers]
    # The number of a probe is also accepted, although only probes in use have names.
    own = Names(*(_numbered(name, probes, numbers, path) for name in names))
    masks = tuple(1 << numbers[place] - 1 for place in own.places(channels, path))
    entries = _entries(archive, stem)
    if not entries:
        raise InputError(path, "", "this sigrok session has no samples")
    given = rate or _rate_of(device.get("samplerate", ""))
    total = sum(entry.file_size for entry in entries)
    if total > _MOST_UNPACKED:
        sizes = f"{total / 1e9:.1f} GB unpacked, and at most {_MOST_UNPACKED / 1e9:.1f} GB are read"
        raise InputError(path, "", f"the samples have {sizes}: save a shorter session")
    parts = _unpacked(archive, entries, size, path)
    return Signals(of_samples(parts, masks), 1 / given if given else None, True, total)


def _numbered(name: Any, probes: dict[int, str], numbers: list[int], path: str) -> Any:
    """Return the place of a probe that is chosen by its number, or the name unchanged."""
    text = name or ""
    if not (text.isascii() and text.isdigit() and len(text) < 4) or text in probes.values():
        return name
    if int(text) not in numbers:
        raise InputError(path, "", f"no channel {short(text)}; the channels are {listed([*probes.values()])}")
    return str(numbers.index(int(text)) + 1)


def _entries(archive: zipfile.ZipFile, stem: str) -> list[zipfile.ZipInfo]:
    """Return the files of samples in order: ``logic-1`` or ``logic-1-1``, ``logic-1-2`` and so on."""
    named = {entry.filename: entry for entry in archive.infolist()}
    if stem in named:
        return [named[stem]]
    found: list[zipfile.ZipInfo] = []
    while (name := f"{stem}-{len(found) + 1}") in named:
        found.append(named[name])
    return found


def _unpacked(
    archive: zipfile.ZipFile, entries: list[zipfile.ZipInfo], size: int, path: str
) -> Generator[tuple[Any, int, Any], None, None]:
    done, rest = 0, b""
    try:
        for entry in entries:
            with archive.open(entry) as file:
                while data := file.read(SAMPLES * size):
                    done += len(data)
                    data = rest + data
                    whole = len(data) // size * size
                    rest = data[whole:]
                    yield np.frombuffer(data, f"<u{size}", whole // size), done, None
    except _DAMAGED as error:
        raise InputError(path, f"offset {done}", f"the samples are damaged: {error or 'they end early'}") from None


def _whole(text: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise ValueError(text)
    return int(text)


_RATE: Final = re.compile(r"\s*([0-9]{1,12}(?:\.[0-9]{1,9})?)\s*([kKMG]?)(?:Hz|S/s|Sa/s)?\s*")
_PREFIXES: Final = {"": 1.0, "k": 1e3, "K": 1e3, "M": 1e6, "G": 1e9}


def _rate_of(text: str) -> float | None:
    """Return a sample rate such as ``24 MHz`` in samples per second, or None if the text is not one."""
    found = _RATE.fullmatch(text)
    return float(found[1]) * _PREFIXES[found[2]] or None if found else None


# NumPy files


def _array(file: BinaryIO, path: str, names: Names, rate: float | None) -> Signals:
    form = np.lib.format
    try:
        version = form.read_magic(file)
        read = form.read_array_header_1_0 if version == (1, 0) else form.read_array_header_2_0
        shape, is_fortran, kind = read(file)
    except Exception:  # The parser of the header raises many types.
        raise InputError(path, "", "this is not a valid NumPy file") from None
    if kind.kind not in "uib" or kind.itemsize > 8 or len(shape) not in (1, 2) or (is_fortran and len(shape) == 2):
        raise InputError(path, "", f"expected whole numbers, one row per sample, got {kind} {shape}")
    width = shape[1] if len(shape) == 2 else 1
    if not 0 < width <= 1024:
        raise InputError(path, "", f"expected 1 to 1024 channels, got {width}")
    count = width if len(shape) == 2 else 8 * kind.itemsize
    places = names.places([str(place + 1) for place in range(count)], path)
    masks = tuple(1 << at for at in (range(len(places)) if len(shape) == 2 else places))

    def parts() -> Generator[tuple[Any, int, Any], None, None]:
        done, step = 0, width * kind.itemsize
        while data := file.read(max(SAMPLES // width, 1) * step):
            done += len(data)
            part = np.frombuffer(data, kind, len(data) // step * width)
            if len(shape) == 2:
                part = packed(part.reshape(-1, width)[:, places])
            else:
                part = part.view(f"{kind.byteorder if kind.itemsize > 1 else ''}u{kind.itemsize}")
                part = part.astype(f"u{kind.itemsize}", copy=False)
            yield part, done, None

    return Signals(of_samples(parts(), masks), 1 / rate if rate else None, True)


# Saleae's binary files


class _Saleae:
    """Binary file of one digital channel, version 0 or 1. Version 1 has several chunks with gaps between them."""

    def __init__(self, file: BinaryIO, path: str) -> None:
        self._file, self._path = file, path
        version, kind = struct.unpack("<8xii", self._take(16))
        if kind != 0:
            raise InputError(path, "", "this Saleae file has analog values: export the digital channels")
        if version not in (0, 1):
            raise InputError(path, "", f"Saleae's binary format {version} is not supported: export as CSV")
        self._has_rate = version == 1
        self.chunks = struct.unpack("<Q", self._take(8))[0] if version == 1 else 1
        self.end, self._ready = 0.0, (0, 0)
        if self.chunks:
            self._ready = self._chunk()

    def _take(self, size: int) -> bytes:
        data = self._file.read(size)
        if len(data) != size:
            raise InputError(self._path, "", "this Saleae file ends early")
        return data

    def _chunk(self) -> tuple[int, int]:
        """Return the first level and the number of edges of the next chunk."""
        level, *_, begin, end, count = struct.unpack(
            "<IdddQ" if self._has_rate else "<IddQ", self._take(36 if self._has_rate else 28)
        )
        if not (np.isfinite(begin) and np.isfinite(end)) or level > 1:
            raise InputError(self._path, "", "this Saleae file is damaged")
        self._start, self.end = begin, max(self.end, end)
        return int(level), int(count)

    def edges(self) -> Generator[tuple[int, Any, int], None, None]:
        """Yield the level before some edges, their times, and the amount read so far."""
        last, level = -np.inf, self._ready[0]
        yield level, np.zeros(0), self._file.tell()
        for place in range(self.chunks):
            first, count = self._ready if not place else self._chunk()
            if first != level:
                # The signal changed in the gap before this chunk.
                level, last = first, self._start
                yield level ^ 1, np.array([self._start]), self._file.tell()
            while count:
                part = np.frombuffer(self._take(8 * min(count, SAMPLES // 8)), "<f8")
                if not (np.isfinite(part).all() and last <= part[0] and (np.diff(part) >= 0).all()):
                    raise InputError(self._path, "", "the times of this Saleae file are not in ascending order")
                yield level, part, self._file.tell()
                count, last, level = count - len(part), float(part[-1]), level ^ (len(part) & 1)


def _saleae(files: Sequence[BinaryIO], paths: Sequence[str]) -> Signals:
    readers = [_Saleae(file, path) for file, path in zip(files, paths, strict=True)]
    edges = merged([reader.edges() for reader in readers], lambda: max(reader.end for reader in readers))
    return Signals(edges, 1.0, False, sum(map(_size, files)))


def _size(file: BinaryIO) -> int:
    at = file.tell()
    size = file.seek(0, io.SEEK_END)
    file.seek(at)
    return size


# Text


def _blocks(file: BinaryIO, path: str, kind: str) -> Generator[tuple[bytes, int], None, None]:
    """Yield blocks of whole lines, and the amount read."""
    rest, done = b"", 0
    while data := file.read(_BLOCK):
        done += len(data)
        data = rest + data
        end = data.rfind(b"\n") + 1
        if not end and len(data) > _BLOCK:
            raise InputError(path, f"offset {done - len(data)}", f"a line is too long: this is not a {kind} file")
        rest = data[end:]
        if end:
            yield data[:end], done
    if rest.strip():
        yield rest + b"\n", done


_UNITS: Final = {
    "s": 1.0, "seconds": 1.0, "ms": 1e-3, "milliseconds": 1e-3, "us": 1e-6, "µs": 1e-6, "microseconds": 1e-6,
    "ns": 1e-9, "nanoseconds": 1e-9, "ps": 1e-12, "picoseconds": 1e-12, "fs": 1e-15, "femtoseconds": 1e-15,
}  # fmt: skip
_TIME: Final = re.compile(r"(?:time\s*)?[\[(]?(?P<unit>[a-zµ]*)[\])]?", re.IGNORECASE)


def _text(file: BinaryIO, path: str, head: bytes, names: Names, rate: float | None) -> Signals:
    """Return the signals of a table: columns of 0 and 1, with one row per sample or a time in the first column."""
    if len(head) == _HEADER and b"\n" not in head:
        raise InputError(path, "", "a line is too long: this is not a capture")
    lines = head.decode("utf-8-sig", "replace").splitlines()
    comments = [line.lstrip("; #") for line in lines if line[:1] in (";", "#")]
    rows = [line for line in lines if line.strip() and line[:1] not in (";", "#")]
    if not rows:
        raise InputError(path, "", f"this is not a capture: {_HINT}")
    between = max(",;\t", key=rows[0].count) if re.search("[,;\t]", rows[0]) else None
    first = _cells(rows[0], between)
    has_header = not all(_is_number(cell) for cell in first)
    width = len(first)
    if has_header and len(rows) > 1 and not all(_is_number(cell) or cell == "X" for cell in _cells(rows[1], between)):
        raise InputError(path, "", f"this is not a capture: {_HINT}")
    cells = first if has_header else [str(place + 1) for place in range(width)]
    unit = _unit_of(cells[0]) if has_header else None
    told = next((line.partition(":")[2] for line in comments if line.startswith("Channels")), "")
    labels = [cell.strip() for cell in told.split(",") if cell.strip()]
    channels = cells[unit is not None :]
    if len(labels) == len(channels):
        channels = labels
    places = names.places(channels, path)
    given = rate or next((_rate_of(line.partition(":")[2]) for line in comments if line.startswith("Samplerate")), None)
    offset = int(unit is not None)
    columns = [offset + place for place in places]
    skipped = head.count(b"\n", 0, _start(head, has_header))

    def parts() -> Generator[tuple[Any, int, Any], None, None]:
        line, last = 1, -np.inf
        for data, done in _blocks(file, path, "CSV"):
            block = data
            if line == 1 and skipped:
                block = data.split(b"\n", skipped)[-1]
            if not block.strip():
                line += data.count(b"\n")
                continue
            at = line + skipped * (line == 1)
            times, levels = _columns(block, between, columns, bool(unit), path, at)
            if times is not None:
                if not (last <= times[0] and (np.diff(times) >= 0).all()):
                    raise InputError(path, f"from line {at}", "the times are not in ascending order")
                last = float(times[-1])
            line += data.count(b"\n")
            yield levels, done, times

    masks = tuple(1 << place for place in range(len(places)))
    total = _size(file)
    if unit:
        return Signals(of_samples(parts(), masks), unit, False, total)
    return Signals(of_samples(parts(), masks), 1 / given if given else None, True, total)


def _start(head: bytes, has_header: bool) -> int:
    """Return the offset after the comments and the header of a table."""
    at = 0
    for line in io.BytesIO(head):
        is_comment = not line.strip() or line.lstrip(b"\xef\xbb\xbf")[:1] in (b";", b"#")
        if not is_comment and not has_header:
            return at
        at += len(line)
        if not is_comment:
            return at
    return at


def _cells(line: str, between: str | None) -> list[str]:
    cells = [cell.strip().strip('"') for cell in line.split(between)]
    return cells[:-1] if cells and not cells[-1] else cells


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _unit_of(name: str) -> float | None:
    """Return the unit of a time column in seconds, or None if its name is not the name of one."""
    found = _TIME.fullmatch(name.strip())
    if found is None:
        return None
    if found["unit"] in _UNITS:
        return _UNITS[found["unit"]]
    # Without a unit, the sample rate gives the times.
    return 0.0 if name.strip().lower() == "time" else None


def _columns(
    block: bytes, between: str | None, columns: list[int], has_time: bool, path: str, line: int
) -> tuple[Any, Any]:
    """Return the times and the levels of some rows."""
    if not has_time and (levels := _regular(block, between, columns)) is not None:
        return None, levels
    wanted = [0, *columns] if has_time else columns
    try:
        found = np.loadtxt(io.BytesIO(block), delimiter=between, usecols=wanted, ndmin=2, comments=None)
    except (ValueError, IndexError) as error:
        said = str(error).splitlines()[0]
        if b"X" in block:
            said = "X means that a channel was off for some time: export a part in which all channels are on"
        raise InputError(path, f"from line {line}", said) from None
    levels = found[:, has_time:]
    if not ((levels == 0) | (levels == 1)).all():
        raise InputError(path, f"from line {line}", "expected columns of 0 and 1")
    if has_time and not np.isfinite(found[:, 0]).all():
        raise InputError(path, f"from line {line}", "expected times in the first column")
    return (np.ascontiguousarray(found[:, 0]) if has_time else None), packed(levels)


def _regular(block: bytes, between: str | None, columns: list[int]) -> Any:
    """Return the levels if all rows have the same form, or None."""
    first = block[: block.index(b"\n") + 1]
    if len(block) % len(first):
        return None
    sign = (between or " ").encode()
    cells = first.rstrip(b"\r\n").split(sign)
    if any(len(cells[place]) != 1 if place < len(cells) else True for place in columns):
        return None
    starts = np.cumsum([0, *(len(cell) + 1 for cell in cells)])
    rows = np.frombuffer(block, np.uint8).reshape(-1, len(first))
    fixed = [int(at) - 1 for at in starts[1:-1]] + [len(first) - 1]
    if not all((rows[:, at] == first[at]).all() for at in fixed):
        return None
    levels = rows[:, [int(starts[place]) for place in columns]] - np.uint8(ord("0"))
    return packed(levels) if (levels <= 1).all() else None


# VCD


_VAR: Final = re.compile(r"\$var\s+\S+\s+(\d+)\s+(\S+)\s+(.*?)\s*\$end", re.DOTALL)
_SCALE: Final = re.compile(r"\$timescale\s+(1|10|100)\s*(s|ms|us|ns|ps|fs)\s+\$end")


def _vcd(file: BinaryIO, path: str, names: Names) -> Signals:
    """Return the signals of a value change dump."""
    size = _size(file)
    head = file.read(_BLOCK)
    end = re.search(rb"\$enddefinitions\s+\$end", head)
    text = head[: end.start()].decode("ascii", "replace") if end else ""
    scale = _SCALE.search(text)
    if end is None or scale is None:
        raise InputError(path, "", "this is not a valid VCD file: the header has no time scale or no end")
    file.seek(end.end())
    found = [(item[2], item[3]) for item in _VAR.finditer(text) if item[1] == "1"]
    places = names.places([name for _, name in found], path)
    codes = [found[place][0].encode() for place in places]
    return Signals(_changes(file, path, codes), int(scale[1]) * _UNITS[scale[2]], False, size)


def _changes(file: BinaryIO, path: str, codes: Sequence[bytes]) -> Generator[Edges, None, None]:
    """Yield the edges of the signals with these codes."""
    known = {level + code: (place, int(level)) for place, code in enumerate(codes) for level in (b"0", b"1")}
    levels: list[int | None] = [None for _ in codes]
    now = begin = -1
    for block, done in _blocks(file, path, "VCD"):
        before = tuple(level or 0 for level in levels)
        times: list[list[int]] = [[] for _ in codes]
        is_code = False
        for token in block.split():
            if is_code:
                # The code of a vector or a real number, whose value came before.
                is_code = False
            elif token in known:
                place, level = known[token]
                if levels[place] is None:
                    before = (*before[:place], level, *before[place + 1 :])
                elif levels[place] != level:
                    times[place].append(now)
                levels[place] = level
            elif token[:1] in b"bBrR":
                is_code = True
            elif token[:1] == b"#":
                later = int(token[1:]) if token[1:].isdigit() and len(token) < 20 else -1
                if later < now:
                    raise InputError(path, "", f"the time {short(token.decode('ascii', 'replace'))} is out of order")
                begin, now = (later if begin < 0 else begin), later
        yield Edges(before, tuple(np.array(each, np.float64) for each in times), float(begin), float(now), done)
        begin = now
