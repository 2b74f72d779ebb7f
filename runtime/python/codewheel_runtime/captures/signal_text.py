# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads captures in text files: tables of 0 and 1, such as CSV, and value change dumps (VCD)."""

from __future__ import annotations

import io
import re
from collections.abc import Generator, Sequence
from typing import Any, BinaryIO, Final, NamedTuple

from ..bulk.words import short
from ..errors import InputError
from ..packages import load
from .signals import Edges, Names, Signals, of_samples, packed

np: Any = load("numpy")

#: Number of bytes of text that are read at once, which is also the limit for a line.
_BLOCK: Final = 1 << 20
#: Limit for the size of a header.
HEADER: Final = 1 << 16
HINT: Final = "expected a sigrok session or CSV, a Saleae CSV or binary file, VCD, a table of 0 and 1, or a NumPy file"

_RATE: Final = re.compile(r"\s*([0-9]{1,12}(?:\.[0-9]{1,9})?)\s*([kKMG]?)(?:Hz|S/s|Sa/s)?\s*")
_PREFIXES: Final = {"": 1.0, "k": 1e3, "K": 1e3, "M": 1e6, "G": 1e9}


def rate_of(text: str) -> float | None:
    """Return a sample rate such as ``24 MHz`` in samples per second, or None if the text is not one."""
    match = _RATE.fullmatch(text)
    if match is None:
        return None
    return float(match[1]) * _PREFIXES[match[2]] or None


def size_of(file: BinaryIO) -> int:
    """Return the size of a file in bytes."""
    at = file.tell()
    size = file.seek(0, io.SEEK_END)
    file.seek(at)
    return size


# Tables


def _blocks(file: BinaryIO, path: str, kind: str) -> Generator[tuple[bytes, int], None, None]:
    """Yield blocks of whole lines, and the amount read."""
    remainder, done = b"", 0
    while data := file.read(_BLOCK):
        done += len(data)
        data = remainder + data
        end = data.rfind(b"\n") + 1
        if not end and len(data) > _BLOCK:
            raise InputError(path, f"offset {done - len(data)}", f"a line is too long: this is not a {kind} file")
        remainder = data[end:]
        if end:
            yield data[:end], done
    if remainder.strip():
        yield remainder + b"\n", done


_UNITS: Final = {
    "s": 1.0, "seconds": 1.0, "ms": 1e-3, "milliseconds": 1e-3, "us": 1e-6, "µs": 1e-6, "microseconds": 1e-6,
    "ns": 1e-9, "nanoseconds": 1e-9, "ps": 1e-12, "picoseconds": 1e-12, "fs": 1e-15, "femtoseconds": 1e-15,
}  # fmt: skip
_TIME: Final = re.compile(r"(?:time\s*)?[\[(]?(?P<unit>[a-zµ]*)[\])]?", re.IGNORECASE)


class _TableForm(NamedTuple):
    """Form of a table.

    ``unit`` is the unit of the time column in seconds. It is None if there is no such column, and 0 if its times are
    not used. ``skipped`` is the number of lines before the first row.
    """

    between: str | None
    channels: list[str]
    unit: float | None
    rate: float | None
    skipped: int


def table_signals(file: BinaryIO, path: str, head: bytes, names: Names, rate: float | None) -> Signals:
    """Return the signals of a table: columns of 0 and 1, with one row per sample or a time in the first column."""
    form = _table_form(path, head)
    places = names.places(form.channels, path)
    offset = int(form.unit is not None)
    parts = _table_parts(file, path, form, [offset + place for place in places])
    edges = of_samples(parts, tuple(1 << index for index in range(len(places))))
    total = size_of(file)
    if form.unit:
        return Signals(edges, seconds=form.unit, is_sampled=False, total=total)
    sample_rate = rate or form.rate
    return Signals(edges, seconds=1 / sample_rate if sample_rate else None, is_sampled=True, total=total)


def _table_form(path: str, head: bytes) -> _TableForm:
    """Return the form of a table according to its first lines."""
    if len(head) == HEADER and b"\n" not in head:
        raise InputError(path, "", "a line is too long: this is not a capture")
    lines = head.decode("utf-8-sig", "replace").splitlines()
    comments = [line.lstrip("; #") for line in lines if line[:1] in (";", "#")]
    rows = [line for line in lines if line.strip() and line[:1] not in (";", "#")]
    if not rows:
        raise InputError(path, "", f"this is not a capture: {HINT}")
    between = max(",;\t", key=rows[0].count) if re.search("[,;\t]", rows[0]) else None
    cells = _cells(rows[0], between)
    has_header = not all(_is_number(cell) for cell in cells)
    if has_header and len(rows) > 1 and not all(_is_number(cell) or cell == "X" for cell in _cells(rows[1], between)):
        raise InputError(path, "", f"this is not a capture: {HINT}")
    unit = _unit_of(cells[0]) if has_header else None
    if not has_header:
        cells = [str(number) for number in range(1, len(cells) + 1)]
    channels = cells[unit is not None :]
    labels = [label.strip() for label in _comment(comments, "Channels").split(",") if label.strip()]
    return _TableForm(
        between=between,
        channels=labels if len(labels) == len(channels) else channels,
        unit=unit,
        rate=rate_of(_comment(comments, "Samplerate")),
        skipped=head.count(b"\n", 0, _start(head, has_header)),
    )


def _comment(comments: list[str], name: str) -> str:
    """Return the text after the colon of a comment, or an empty string."""
    return next((comment.partition(":")[2] for comment in comments if comment.startswith(name)), "")


def _table_parts(
    file: BinaryIO, path: str, form: _TableForm, columns: list[int]
) -> Generator[tuple[Any, int, Any], None, None]:
    """Yield the levels of some rows, the amount read, and their times or None."""
    line, last_time = 1, -np.inf
    for data, done in _blocks(file, path, "CSV"):
        block, first_line = data, line
        if line == 1 and form.skipped:
            block = data.split(b"\n", form.skipped)[-1]
            first_line += form.skipped
        line += data.count(b"\n")
        if not block.strip():
            continue
        times, levels = _columns(block, form.between, columns, bool(form.unit), path, first_line)
        if times is not None:
            if not (last_time <= times[0] and (np.diff(times) >= 0).all()):
                raise InputError(path, f"from line {first_line}", "the times are not in ascending order")
            last_time = float(times[-1])
        yield levels, done, times


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
    match = _TIME.fullmatch(name.strip())
    if match is None:
        return None
    if match["unit"] in _UNITS:
        return _UNITS[match["unit"]]
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
        table = np.loadtxt(io.BytesIO(block), delimiter=between, usecols=wanted, ndmin=2, comments=None)
    except (ValueError, IndexError) as error:
        reason = str(error).splitlines()[0]
        if b"X" in block:
            reason = "X means that a channel was off for some time: export a part in which all channels are on"
        raise InputError(path, f"from line {line}", reason) from None
    levels = table[:, has_time:]
    if not ((levels == 0) | (levels == 1)).all():
        raise InputError(path, f"from line {line}", "expected columns of 0 and 1")
    if has_time and not np.isfinite(table[:, 0]).all():
        raise InputError(path, f"from line {line}", "expected times in the first column")
    return (np.ascontiguousarray(table[:, 0]) if has_time else None), packed(levels)


def _regular(block: bytes, between: str | None, columns: list[int]) -> Any:
    """Return the levels if all rows have the same form, or None."""
    first = block[: block.index(b"\n") + 1]
    if len(block) % len(first):
        return None
    sign = (between or " ").encode()
    cells = first.rstrip(b"\r\n").split(sign)
    if any(place >= len(cells) or len(cells[place]) != 1 for place in columns):
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


def vcd_signals(file: BinaryIO, path: str, names: Names) -> Signals:
    """Return the signals of a value change dump."""
    size = size_of(file)
    head = file.read(_BLOCK)
    end = re.search(rb"\$enddefinitions\s+\$end", head)
    text = head[: end.start()].decode("ascii", "replace") if end else ""
    scale = _SCALE.search(text)
    if end is None or scale is None:
        raise InputError(path, "", "this is not a valid VCD file: the header has no time scale or no end")
    file.seek(end.end())
    variables = [(variable[2], variable[3]) for variable in _VAR.finditer(text) if variable[1] == "1"]
    places = names.places([name for _, name in variables], path)
    codes = [variables[place][0].encode() for place in places]
    return Signals(_changes(file, path, codes), int(scale[1]) * _UNITS[scale[2]], False, size)


def _changes(file: BinaryIO, path: str, codes: Sequence[bytes]) -> Generator[Edges, None, None]:
    """Yield the edges of the signals with these codes."""
    tokens = {level + code: (place, int(level)) for place, code in enumerate(codes) for level in (b"0", b"1")}
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
            elif token in tokens:
                place, level = tokens[token]
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
        yield Edges(
            before, tuple(np.array(signal_times, np.float64) for signal_times in times), float(begin), float(now), done
        )
        begin = now
