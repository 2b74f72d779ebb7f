"""Rules for facts that a spec gives twice: in data and in a text, in two tables, or in the contents of the manual."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ..hints import POLYNOMIAL, polynomial_powers
from ..problems import DocumentReport, Path, is_typo, quoted
from .walk import Has, Spec, by_name, explained, field_lists, items, leaves, leaves_of, mapping

#: A hexadecimal number in a text.
_HEX = re.compile(r"\b(?:0x([0-9A-Fa-f]+)|([0-9][0-9A-F]*)h)\b")
#: Words before a number that is a place and not a value.
_PLACE = re.compile(r"\b(?:register|address|at)\b", re.IGNORECASE)
_BIT = r"\d{1,3}(?::\d{1,3})?"
#: Bits that a sentence calls unused without a condition.
_UNUSED = re.compile(
    rf"(?:^|[.;] )bits? ({_BIT}(?:(?:,| and|, and) {_BIT})*) (?:is|are) (?:not used|unused)(?=[.;]|$)", re.IGNORECASE
)
_ONLY = re.compile(r"\b(?:is|are) (read|write)[ -]only\b")
_NUMBERS = ("two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")
_REQUESTS = re.compile(rf"\b({'|'.join(_NUMBERS)}|[1-9]\d?) requests\b", re.IGNORECASE)
#: Cells of two tables that must agree before one that differs is a mistake.
_CELLS = 8
#: Letters of a word in which one is likely wrong, and that is not another short word.
_LONG = 6
#: Longest contents and most tables that are compared. A manual has some 50 entries and 10 tables.
_MOST_ENTRIES, _MOST_TABLES = 200, 50
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def misspelt_name(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a printed name does not differ by one letter from an entry of the contents, or from its flag."""
    _compare_with_contents(spec, raw, report)
    for path, alarm in items(spec, "alarms"):
        kind = "group" if "group" in alarm else "register"
        owner = by_name(spec, "field_groups" if kind == "group" else "registers").get(alarm.get(kind, ""), {})
        flag = by_name(owner, "fields").get(alarm.get("field", ""), {})
        for name_path, name in _names_of(alarm):
            flag_name = dict(_names_of(flag)).get(name_path, "")
            if _misspells(name, flag_name):
                message = f"the flag of this alarm has {quoted(flag_name)}; correct one of the two"
                report.add("misspelt-name", (*path, *name_path), message)


def _compare_with_contents(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Report the printed names that differ by one letter from an entry of the contents."""
    entries: dict[str, str] = {}
    for contents in mapping(raw, "manual", "contents").values():
        entries |= {title.casefold(): title for title in mapping(contents, "entries")}
    language = mapping(raw, "manual").get("language")
    explained_names = "\n".join(erratum.get("used", "") for _, erratum in items(spec, "errata")).casefold()
    if len(entries) > _MOST_ENTRIES:
        return
    for path, name in leaves_of(spec, report):
        # A name in another language can differ by one letter too: temperature, temperatura.
        if not isinstance(name, str) or (path[-2:] != ("names", language) and path[-1] != "printed_name"):
            continue
        title = next((title for title in entries if _misspells(name, title)), None)
        if title and name.casefold() not in entries and name.casefold() not in explained_names:
            message = (
                f"the table of contents has {quoted(entries[title])}; correct one of the two, "
                "or add an erratum whose 'used' has this name"
            )
            report.add("misspelt-name", path, message)


def _misspells(name: str, correct_name: str) -> bool:
    """Return whether one letter in a word of a name is wrong. An entry of the contents can be in the plural."""
    if abs(len(name) - len(correct_name)) > 1:
        return False
    words, correct_words = name.casefold().split(), correct_name.casefold().split()
    if len(words) != len(correct_words):
        return False
    different_words = [pair for pair in zip(words, correct_words, strict=True) if pair[0] != pair[1]]
    if len(different_words) != 1:
        return False
    word, correct_word = different_words[0]
    return len(correct_word) >= _LONG and word.rstrip("s") != correct_word.rstrip("s") and is_typo(word, correct_word)


def _names_of(owner: Spec) -> Iterator[tuple[Path, str]]:
    for path, name in leaves({key: owner[key] for key in ("printed_name", "names") if key in owner}):
        if isinstance(name, str):
            yield path, name


def number_in_meaning(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a field with a fixed number does not have another hexadecimal number in its meaning."""
    for fields in field_lists(spec):
        for path, field in fields:
            key = next((key for key in ("constant", "equals", "unused") if isinstance(field.get(key), int)), None)
            meaning = field.get("meaning", "")
            printed_numbers = {int(with_prefix or with_h, 16) for with_prefix, with_h in _HEX.findall(meaning)}
            if _PLACE.search(meaning):
                continue
            if key is not None and len(printed_numbers) == 1 and field[key] not in printed_numbers:
                message = (
                    f"the meaning has {printed_numbers.pop():#x}, but {quoted(key)} is {field[key]:#x}; "
                    "one of the two is wrong"
                )
                report.add("printed-number", (*path, key), message)


def polynomial_in_note(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a CRC does not have another polynomial in its note.

    A hexadecimal number with one bit more than the CRC is a polynomial with its top bit.
    """
    for path, crc in items(spec, "crcs"):
        printed_polynomials = _printed_polynomials(crc.get("note", ""), crc["width"])
        polynomial = crc["poly"] + (1 << crc["width"])
        if printed_polynomials and polynomial not in printed_polynomials.values():
            message = (
                f"the note has {next(iter(printed_polynomials))}, but 'poly' is {crc['poly']:#x}, "
                f"or {polynomial:#x} with its top bit; one of the two is wrong"
            )
            report.add("printed-number", (*path, "poly"), message)


def _printed_polynomials(note: str, width: int) -> dict[str, int]:
    """Return the polynomials of this width in a note, with their top bit, by their text."""
    polynomials: dict[str, int] = {}
    top_bit = 1 << width
    for match in _HEX.finditer(note) if not _PLACE.search(note) else ():
        number = int(match[1] or match[2], 16)
        if number & 1 and top_bit < number < 2 * top_bit:
            polynomials[match[0]] = number
    for match in POLYNOMIAL.finditer(note):
        powers = polynomial_powers(match[0])
        if max(powers) == width and 0 in powers:
            polynomials[match[0]] = sum(1 << power for power in powers)
    return polynomials


def unused_bits(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a register has no field at bits that its note calls unused."""
    for fields in field_lists(spec):
        if fields.kind is not Has.REGISTER:
            continue
        bits_in_note = set(_unused_bits_in(fields.owner.get("note", "")))
        for path, field in fields:
            high, _, low = str(field.get("at", "")).partition(":")
            used_bits = [bit for bit in bits_in_note if high.isdigit() and int(low or high) <= bit <= int(high)]
            if used_bits and not {"constant", "unused"} & {*field} and field.get("equals") != 0:
                field_name = quoted(str(field.get("name", "")))
                message = (
                    f"the note says that bit {min(used_bits)} is not used, but {field_name} uses it; "
                    "one of the two is wrong"
                )
                report.add("unused-bits", (*path, "at"), message)


def _unused_bits_in(text: str) -> Iterator[int]:
    """Yield the bits that a text calls unused."""
    for match in _UNUSED.finditer(text):
        for high, low in re.findall(r"(\d{1,3})(?::(\d{1,3}))?", match[1]):
            yield from range(int(low or high), int(high) + 1)


def access_repeated(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a register with fixed contents is not writable, and has the access that its errata use."""
    registers = by_name(spec, "registers")
    for path, register in items(spec, "registers"):
        fields = [field for _, field in items(register, "fields")]
        is_fixed = bool(fields) and all("equals" in field for field in fields)
        is_explained = "note" in register or explained(report.document, "registers", register["name"], "access")
        if is_fixed and register["access"] == "read_write" and not is_explained:
            message = (
                f"all fields of {quoted(register['name'])} have a fixed value ('equals'), so it should be read_only; "
                "if the manual says read_write, say so in a 'note'"
            )
            report.add("access-mismatch", (*path, "access"), message)
    for path, erratum in items(spec, "errata"):
        # A sentence about bits or fields is not about the register.
        used = erratum.get("used", "")
        stated_accesses = set() if re.search(r"\b(?:bit|field)", used, re.IGNORECASE) else {*_ONLY.findall(used)}
        for text in erratum.get("affects", ()) if len(stated_accesses) == 1 else ():
            kind, _, name = text.partition(".")
            access = f"{next(iter(stated_accesses))}_only"
            if kind == "registers" and name in registers and registers[name]["access"] != access:
                message = (
                    f"this says {access}, but {quoted(name)} is {registers[name]['access']}; one of the two is wrong"
                )
                report.add("access-mismatch", (*path, "used"), message)


def zero_within_limits(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the number for which zero stands is within the limits of its register."""
    for path, register in items(spec, "registers"):
        for _, field in items(register, "fields"):
            zero, highest = field.get("zero_means"), register.get("max")
            is_limited = register.get("limits_of") in (None, field.get("name"))
            # 0 can stand for the number after the highest one, such as 65536 in 16 bits.
            if isinstance(zero, int) and isinstance(highest, int) and is_limited and zero > highest + 1:
                message = f"zero stands for {zero}, which is above 'max' ({highest}); one of the two is wrong"
                report.add("limit-does-not-fit", (*path, "max"), message)


def requests_repeated(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the number of requests in a text of a procedure is the one that its step sends."""
    for path, procedure in items(spec, "procedures"):
        times = {step["times"] for _, step in items(procedure, "steps") if "times" in step}
        is_single_step = len(times) == 1 and len(procedure["steps"]) == 1
        for text_path, text in leaves(procedure) if is_single_step else ():
            for printed_number in _REQUESTS.findall(text) if isinstance(text, str) else ():
                if _number_of(printed_number) not in times:
                    message = (
                        f"the text says {printed_number} requests, but 'times' is {next(iter(times))}; "
                        "one of the two is wrong"
                    )
                    report.add("quantity-repeated", (*path, *text_path), message)


def _number_of(text: str) -> int:
    """Return a number in digits, or in words from two to twelve."""
    return int(text) if text.isdigit() else _NUMBERS.index(text.casefold()) + 2


def table_repeated(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that two tables with common columns agree in their numbers, if they do so in all cells but one.

    Rows belong together if a column whose cells are all different has the same cell in both.
    """
    tables = list(items(spec, "tables"))[:_MOST_TABLES]
    for index, (path, table) in enumerate(tables):
        for _, earlier_table in tables[:index]:
            pair = _only_difference(table, earlier_table)
            if pair is not None:
                message = (
                    f"{quoted(pair.column)} is {pair.cell} here, but {pair.earlier_cell} in the table "
                    f"{quoted(earlier_table['name'])}; one of the two is wrong"
                )
                place = (*path, "rows", pair.row, table["columns"].index(pair.column))
                report.add("quantity-repeated", place, message)


@dataclass(frozen=True, slots=True)
class _CellPair:
    """Cells of two tables that must agree, with the column and the row of the first one."""

    row: int
    column: str
    cell: str
    earlier_cell: str

    @property
    def is_numeric(self) -> bool:
        return all(map(_NUMBER.fullmatch, (self.cell, self.earlier_cell)))


def _only_difference(table: Spec, earlier_table: Spec) -> _CellPair | None:
    """Return the pair of cells that differs if the tables agree in all others."""
    common_columns = [name for name in table["columns"] if name in earlier_table["columns"]]
    for key in common_columns:
        if not _is_key(table, key) or not _is_key(earlier_table, key):
            continue
        compared: list[_CellPair] = []
        for column in common_columns:
            pairs = _number_pairs(table, earlier_table, key, column) if column != key else []
            # A column that mostly differs, such as one of texts, is about something else.
            if 2 * len(_differing_cells(pairs)) <= len(pairs):
                compared += pairs
        differing = _differing_cells(compared)
        if len(differing) == 1 and len(compared) > _CELLS:
            return differing[0]
    return None


def _number_pairs(table: Spec, earlier_table: Spec, key: str, column: str) -> list[_CellPair]:
    """Return the pairs of numbers in a column, from the rows that have the same cell in the column ``key``."""
    earlier_cells = {_cell(earlier_table, row, key): _cell(earlier_table, row, column) for row in earlier_table["rows"]}
    pairs = []
    for index, row in enumerate(table["rows"]):
        key_cell = _cell(table, row, key)
        if key_cell in earlier_cells:
            pairs.append(_CellPair(index, column, _cell(table, row, column), earlier_cells[key_cell]))
    return [pair for pair in pairs if pair.is_numeric]


def _differing_cells(pairs: list[_CellPair]) -> list[_CellPair]:
    return [pair for pair in pairs if pair.cell != pair.earlier_cell]


def _cell(table: Spec, row: list[Any], column: str) -> str:
    at = table["columns"].index(column)
    return str(row[at]) if at < len(row) else ""


def _is_key(table: Spec, column: str) -> bool:
    cells = [_cell(table, row, column) for row in table["rows"]]
    return len(cells) == len(set(cells))
