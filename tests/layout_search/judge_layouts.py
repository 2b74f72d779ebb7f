"""Compare the lines of an answer with the line of the layout that sent the frames."""

from __future__ import annotations

from collections.abc import Sequence

from codewheel.layout_search.answers import PossibleLine
from codewheel.one_line.line import CrcField, EncoderLine, ParityField
from codewheel.one_line.parse import parse_line


def place_of(line: EncoderLine) -> tuple[int, int]:
    """Return the first bit of the position, and the end of its bits."""
    start = 0
    for field in line.fields:
        if field.name == "position":
            return start, start + field.bits
        start += field.bits
    raise AssertionError(line.text)


def crc_of(line: EncoderLine) -> tuple[int, int, int, bool] | None:
    last = line.fields[-1]
    return (last.bits, last.poly, last.init, last.is_inverted) if isinstance(last, CrcField) else None


def parity_of(line: EncoderLine) -> tuple[int, str] | None:
    start = 0
    for field in line.fields:
        if isinstance(field, ParityField):
            return start, field.kind
        start += field.bits
    return None


def is_right(answer: PossibleLine, wanted_text: str, frames: Sequence[str], *, only_first: bool = False) -> bool:
    """Return True if an answer has the width, code and CRC of a line, in it or in the lines that are equal.

    Bits in front of the position that are the same in all frames can belong to it or not. ``only_first`` demands the
    code of the first line.
    """
    wanted, first = parse_line(wanted_text), parse_line(answer.line)
    lines = [first, *(parse_line(equal.line) for equal in answer.equal_lines)]
    codes = {line.options.is_gray for line in (lines[:1] if only_first else lines)}
    start, end = place_of(first)
    wanted_start, wanted_end = place_of(wanted)
    between = range(min(start, wanted_start), max(start, wanted_start))
    is_constant_between = all(len({frame[place] for frame in frames}) == 1 for place in between)
    has_place = end == wanted_end and is_constant_between
    has_crc = crc_of(wanted) in [crc_of(line) for line in lines]
    has_parity = parity_of(wanted) == parity_of(first)
    return has_place and has_crc and has_parity and wanted.options.is_gray in codes
