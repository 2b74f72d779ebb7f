"""Check that the numbers of bits in texts agree with the fields of a frame and with the order codes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import chain

from ..language.problems import DocumentReport, join_words, quoted
from ..model import Biss, Device

_NUMBERS = r"\d+(?:, \d+)*(?: (?:or|and) \d+)?"
#: Lengths in a text: ``The frame has 32 bits at 50 µm and 33 bits at 1 µm``, or ``The word has 21, 23 or 26 bits``.
_LENGTH_IN_TEXT = re.compile(
    rf"\bThe (?:frame|word) has (?P<numbers>{_NUMBERS}) bits(?: at [^.,;]*? and (?P<others>\d+) bits)?(?= at\b|[.,;]|$)"
)
#: The lengths of a word that only contains the position: ``The word has as many bits as the position, 17 to 39``.
_LENGTH_RANGE_IN_TEXT = re.compile(
    r"\bThe (?:frame|word) has as many bits as the position, (?P<least>\d+) to (?P<most>\d+)\b"
)
#: Numbers of bits that a parameter can have, at the end of its meaning: ``Width of the field, 24 or 25 bits``.
_OF_PARAMETER = re.compile(r", (?P<numbers>\d+(?:, \d+)* or \d+) bits$")
_NUMBER = re.compile(r"\d+")


def check_stated_lengths(device: Device, report: DocumentReport) -> None:
    """Report a note on a layout, or an erratum about it, that states a length that its frames do not have.

    A list of lengths, such as ``21, 23 or 26``, must contain the lengths for all order codes. An erratum that counts
    the lengths is checked too.
    """
    if report.document.family or report.document.other_files:
        return
    _check_counted_lengths(device, report)
    for interface in device.interfaces:
        for layout in interface.layouts:
            variants = device.variants_over(interface.name)
            lengths = sorted({layout.place(variant.parameters).bits for variant in variants})
            if not lengths:
                continue
            note_path = ("interfaces", interface.name, "layouts", layout.name, "note")
            _check_text(note_path, layout.note, lengths, report)
            # In errata, paths do not contain the key ``layouts``.
            affected = f"interfaces.{interface.name}.{layout.name}"
            for erratum in device.errata:
                if affected in erratum.affects:
                    _check_text(("errata", erratum.name, "used"), erratum.used, lengths, report)


_NUMBER_WORDS = "two three four five six seven eight nine ten".split()
_COUNT_OF_LENGTHS = re.compile(rf"\bhave (?P<count>{'|'.join(_NUMBER_WORDS)}) different data lengths\b")


def check_stated_bits(device: Device, report: DocumentReport) -> None:
    """Report a parameter whose meaning ends with numbers of bits that differ from its values for the order codes."""
    if report.document.family or report.document.other_files:
        return
    for parameter in device.parameters:
        match = _OF_PARAMETER.search(parameter.meaning)
        variants_with_it = [variant for variant in device.variants if parameter.name in variant.parameters]
        numbers = {variant.parameters[parameter.name] for variant in variants_with_it}
        if match is None or not numbers or parameter.read_from:
            continue
        if {*_numbers(match)} != numbers:
            numbers_text = join_words(map(str, sorted(numbers)), "or")
            stated_text = match[0].removeprefix(", ")
            message = f"the text says {quoted(stated_text)}, but the order codes have {numbers_text}"
            message += "; correct one of the two"
            report.add("left-behind", ("parameters", parameter.name, "meaning"), message)


def _check_counted_lengths(device: Device, report: DocumentReport) -> None:
    """Report an erratum that counts the data lengths of the order codes over BiSS wrongly.

    The data are the frame without its flags and check, so the lengths of data differ as the lengths of frames do.
    """
    variants = device.variants_over(Biss.name)
    counts: set[int] = set()
    for interface in device.interfaces:
        if interface.name == Biss.name:
            for layout in interface.layouts:
                counts.add(len({layout.place(variant.parameters).bits for variant in variants}))
    if not counts:
        return
    for erratum in device.errata:
        match = _COUNT_OF_LENGTHS.search(erratum.why)
        if match is not None and 2 + _NUMBER_WORDS.index(match["count"]) not in counts:
            count_text = join_words(map(str, sorted(counts)), "or")
            message = f"the text says {quoted(match[0])}, but the order codes have {count_text}; correct one of the two"
            report.add("left-behind", ("errata", erratum.name, "why"), message)


def _check_text(path: tuple[str, ...], text: str, lengths: Sequence[int], report: DocumentReport) -> None:
    """Report the first statement in a text about the length of a frame that does not agree with its actual lengths."""
    shortest, longest = lengths[0], lengths[-1]
    for match in chain(_LENGTH_IN_TEXT.finditer(text), _LENGTH_RANGE_IN_TEXT.finditer(text)):
        # The text can be about a part of the frame: ``The frame has 2 bits, error and warning, after the position``.
        stated_numbers = _numbers(match)
        is_short = len(stated_numbers) == 1 and max(stated_numbers) < shortest
        may_be_part = is_short and text[match.end() :].startswith(",")
        if may_be_part:
            continue
        is_range = match.re is _LENGTH_RANGE_IN_TEXT
        fits = stated_numbers == (shortest, longest) if is_range else _fits(match, lengths)
        if not fits:
            lengths_text = join_words(map(str, lengths), "or")
            message = f"the text says {quoted(match[0])}, but the frame has {lengths_text} bits; correct one of the two"
            report.add("left-behind", path, message)
            return


def _numbers(match: re.Match[str]) -> tuple[int, ...]:
    """Return all numbers in the groups of a match."""
    numbers: list[int] = []
    for group in match.groups():
        if group:
            numbers += map(int, _NUMBER.findall(group))
    return tuple(numbers)


def _fits(match: re.Match[str], lengths: Sequence[int]) -> bool:
    """Return whether the lengths in a text are lengths of the frame. A list must contain all of them."""
    numbers = _numbers(match)
    is_list = len(_NUMBER.findall(match["numbers"])) > 1
    return {*numbers} == {*lengths} if is_list else {*numbers} <= {*lengths}
