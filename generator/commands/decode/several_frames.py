"""Find the frames in arguments and pasted lines: one per line, words in one line, and numbers in columns.

The decode page follows the same rules, in several.js.
"""

from __future__ import annotations

import io
import itertools
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
from typing import TextIO

from ...model import INTERFACES, Device, Variant
from ...say.frame_texts import DIGITS
from .digits import are_decimal_numbers, lack_leading_zeros, words_of
from .frames import FrameLine, frame_lines

#: Number of lines that show whether numbers are decimal, and whether the first column counts the lines.
_SAMPLE = 20
#: Fewest lines that show a column that counts the lines.
_FEWEST_ROWS = 3
#: Number of characters of a line that are kept in memory.
_LONGEST_LINE = 1 << 16
#: Bits with their prefix that are too many for a byte.
_BITS_OF_A_FRAME = re.compile(r"0[bB]_*[01](?:_*[01]){8,}")
_DECIMAL = re.compile(DIGITS["decimal"])
_BITS = re.compile(r"1[01]*")
#: The number of a line, a separator of CSV, and a frame of at least 3 characters: ``12,40276`` or ``12;0x9D54``.
_NUMBERED_ROW = re.compile(r"(?P<number>0|[1-9][0-9]{0,8})[ ]*[,;\t][ ]*(?P<frame>[0-9A-Za-z]{3,})")
#: The names of two columns: ``time,raw``. At least one letter is not a hex digit.
_HEADER = re.compile(r"(?=.*[G-Wg-wYyZz])[A-Za-z_][A-Za-z0-9_ ]*[,;\t][ ]*[A-Za-z_][A-Za-z0-9_ ]*")


def argument_lines(arguments: Sequence[str]) -> Iterator[FrameLine]:
    """Yield the frames in the arguments, or, for ``-``, the frames on standard input, one per line.

    The arguments form one text, in which each line is a frame. Arguments of more than 8 bits with the prefix ``0b`` are
    frames of their own. A single frame has no line number. If the arguments contain no frame, their text is yielded as
    it is, and the decoder then rejects it.
    """
    if list(arguments) == ["-"]:
        if isinstance(sys.stdin, io.TextIOWrapper):
            sys.stdin.reconfigure(errors="replace")
        yield from frame_lines(_bounded_lines(sys.stdin))
        return
    are_frames_of_bits = all(map(_BITS_OF_A_FRAME.fullmatch, arguments))
    joined_arguments = ("\n" if are_frames_of_bits else " ").join(arguments)
    # As on standard input, only line feeds and carriage returns end a line.
    lines = list(frame_lines(io.StringIO(joined_arguments, newline=None)))
    if not lines:
        yield FrameLine(None, "", joined_arguments)
    elif len(lines) == 1:
        yield lines[0]._replace(number=None)
    else:
        yield from lines


def _bounded_lines(file: TextIO) -> Iterator[str]:
    """Yield the lines of a file. A line that is longer than any frame is cut."""
    while beginning := file.readline(_LONGEST_LINE):
        yield beginning
        # Skip the rest of a line that was cut.
        line_continues = len(beginning) == _LONGEST_LINE and not beginning.endswith("\n")
        while line_continues:
            piece = file.readline(_LONGEST_LINE)
            line_continues = len(piece) == _LONGEST_LINE and not piece.endswith("\n")


def frame_sizes(device: Device, variant: Variant, sender: str) -> tuple[int, ...]:
    """Return the numbers of bits of the sender's frames, without duplicates, or nothing if the line carries bytes."""
    if INTERFACES[variant.interface].carried_as == "bytes":
        return ()
    layouts = [layout for layout in device.interface(variant.interface).layouts if layout.sender == sender]
    return tuple(dict.fromkeys(layout.place(variant.parameters).bits for layout in layouts))


def separate_frames(lines: Iterable[FrameLine], sizes: Sequence[int]) -> Iterator[FrameLine]:
    """Yield a line for each frame, such as ``0x9D54``, in lines with several frames or with numbers in columns.

    ``sizes`` are the possible numbers of bits of a frame. If it is empty, the lines are yielded as they are. The first
    lines show whether numbers are decimal, whether bits lack leading zeros, and whether the first column counts the
    lines.
    """
    if not sizes:
        yield from lines
        return
    remaining_lines = iter(lines)
    sample = _first_lines(remaining_lines)
    has_header = len(sample) > 1 and _HEADER.fullmatch(sample[0].text) is not None
    rows = sample[1:] if has_header else sample
    has_numbered_rows = _have_line_numbers([row.text for row in rows])
    is_table = has_numbered_rows or (has_header and all(row.time for row in rows))
    if has_header and not is_table:
        rows = sample
    frame_texts = [_without_line_number(row.text) if has_numbered_rows else row.text for row in rows]
    are_decimal = are_decimal_numbers(frame_texts, sizes[0])
    lack_zeros = lack_leading_zeros(frame_texts, sizes[0])
    for line in itertools.chain(rows, remaining_lines):
        text = _without_line_number(line.text) if has_numbered_rows else line.text
        if are_decimal and _DECIMAL.fullmatch(text):
            text = f"0x{int(text):X}"
        elif lack_zeros and _BITS.fullmatch(text):
            text = f"0b{text.zfill(sizes[0])}"
        yield from _split_into_words(line._replace(text=text), sizes)


def _first_lines(lines: Iterator[FrameLine]) -> list[FrameLine]:
    """Take the first lines, which show how numbers are written, from ``lines``.

    Only one line is taken if it cannot be part of a table, so that a live recording is decoded without delay.
    """
    first_line = next(lines, None)
    if first_line is None:
        return []
    may_be_table = _DECIMAL.fullmatch(first_line.text) or re.search(r"[,;\t]", first_line.text)
    other_lines = itertools.islice(lines, _SAMPLE - 1) if may_be_table else ()
    return [first_line, *other_lines]


def _have_line_numbers(texts: Sequence[str]) -> bool:
    """Return whether each text is a row of CSV that begins with its number, such as ``12,40276``.

    The numbers increase by the same step from row to row. At least three rows are needed.
    """
    rows = [_NUMBERED_ROW.fullmatch(text) for text in texts]
    numbers = [int(row["number"]) for row in rows if row is not None]
    if len(numbers) < _FEWEST_ROWS or len(numbers) != len(texts):
        return False
    steps = {following - number for number, following in itertools.pairwise(numbers)}
    return len(steps) == 1 and min(steps) > 0


def _without_line_number(text: str) -> str:
    """Return the frame in a row such as ``12,40276``, or any other text as it is."""
    row = _NUMBERED_ROW.fullmatch(text)
    return row["frame"] if row is not None else text


def _split_into_words(line: FrameLine, sizes: Sequence[int]) -> list[FrameLine]:
    """Return a line for each word in a line with several, such as ``{0x7FFE, 0x3FFF}``, or the line itself.

    The words of a line without a number are numbered from 1.
    """
    words = words_of(line.text, sizes)
    if not words:
        return [line]
    return [line._replace(number=line.number or index, text=word) for index, word in enumerate(words, 1)]
