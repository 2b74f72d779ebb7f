"""Rules for facts that a spec gives twice: in data and in a text, in two tables, or in the contents of the manual."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from ..hints import POLYNOMIAL, polynomial_powers
from ..problems import DocumentReport, Path, is_slip, quoted
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
    entries: dict[str, str] = {}
    for item in mapping(raw, "manual", "contents").values():
        entries |= {title.casefold(): title for title in mapping(item, "entries")}
    language = mapping(raw, "manual").get("language")
    explained_names = "\n".join(item.get("used", "") for _, item in items(spec, "errata")).casefold()
    for path, name in leaves_of(spec, report) if len(entries) <= _MOST_ENTRIES else ():
        # A name in another language can differ by one letter too: temperature, temperatura.
        if not isinstance(name, str) or (path[-2:] != ("names", language) and path[-1] != "printed_name"):
            continue
        right = next((title for title in entries if _misspells(name, title)), None)
        if right and name.casefold() not in entries and name.casefold() not in explained_names:
            wrong = f"the table of contents has {quoted(entries[right])}; correct one of the two"
            report.add("misspelt-name", path, f"{wrong}, or add an erratum whose 'used' has this name")
    for path, alarm in items(spec, "alarms"):
        kind = "group" if "group" in alarm else "register"
        owner = by_name(spec, "field_groups" if kind == "group" else "registers").get(alarm.get(kind, ""), {})
        flag = by_name(owner, "fields").get(alarm.get("field", ""), {})
        for below, name in _names(alarm):
            other = dict(_names(flag)).get(below, "")
            if _misspells(name, other):
                wrong = f"the flag of this alarm has {quoted(other)}; correct one of the two"
                report.add("misspelt-name", (*path, *below), wrong)


def _misspells(name: str, other: str) -> bool:
    """Return whether one letter in a word of a name is wrong. An entry of the contents can be in the plural."""
    if abs(len(name) - len(other)) > 1:
        return False
    one, two = name.casefold().split(), other.casefold().split()
    if len(one) != len(two):
        return False
    wrong = [pair for pair in zip(one, two, strict=True) if pair[0] != pair[1]]
    if len(wrong) != 1:
        return False
    word, right = wrong[0]
    return len(right) >= _LONG and word.rstrip("s") != right.rstrip("s") and is_slip(word, right)


def _names(item: Spec) -> Iterator[tuple[Path, str]]:
    for path, name in leaves({key: item[key] for key in ("printed_name", "names") if key in item}):
        if isinstance(name, str):
            yield path, name


def number_in_meaning(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a field with a fixed number does not have another hexadecimal number in its meaning."""
    for fields in field_lists(spec):
        for path, field in fields:
            key = next((key for key in ("constant", "equals", "unused") if isinstance(field.get(key), int)), None)
            meaning = field.get("meaning", "")
            printed = {int(with_prefix or with_h, 16) for with_prefix, with_h in _HEX.findall(meaning)}
            if _PLACE.search(meaning):
                continue
            if key is not None and len(printed) == 1 and field[key] not in printed:
                wrong = f"the meaning has {printed.pop():#x}, but {quoted(key)} is {field[key]:#x}"
                report.add("printed-number", (*path, key), f"{wrong}; one of the two is wrong")


def polynomial_in_note(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a CRC does not have another polynomial in its note.

    A hexadecimal number with one bit more than the CRC is a polynomial with its top bit.
    """
    for path, crc in items(spec, "crcs"):
        note, top = crc.get("note", ""), 1 << crc["width"]
        numbers = (
            {} if _PLACE.search(note) else {found[0]: int(found[1] or found[2], 16) for found in _HEX.finditer(note)}
        )
        printed = {text: number for text, number in numbers.items() if number & 1 and top < number < 2 * top}
        for found in POLYNOMIAL.finditer(note):
            powers = polynomial_powers(found[0])
            if max(powers) == crc["width"] and 0 in powers:
                printed[found[0]] = sum(1 << power for power in powers)
        whole = crc["poly"] + top
        if printed and whole not in printed.values():
            wrong = (
                f"the note has {next(iter(printed))}, but 'poly' is {crc['poly']:#x}, or {whole:#x} with its top bit"
            )
            report.add("printed-number", (*path, "poly"), f"{wrong}; one of the two is wrong")


def unused_bits(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a register has no field at bits that its note calls unused."""
    for fields in field_lists(spec):
        if fields.kind is not Has.REGISTER:
            continue
        unused = set(_bits(fields.owner.get("note", "")))
        for path, field in fields:
            high, _, low = str(field.get("at", "")).partition(":")
            clash = [bit for bit in unused if high.isdigit() and int(low or high) <= bit <= int(high)]
            if clash and not {"constant", "unused"} & {*field} and field.get("equals") != 0:
                wrong = (
                    f"the note says that bit {min(clash)} is not used, but {quoted(str(field.get('name', '')))} uses it"
                )
                report.add("unused-bits", (*path, "at"), f"{wrong}; one of the two is wrong")


def _bits(text: str) -> Iterator[int]:
    """Yield the bits that a text calls unused."""
    for found in _UNUSED.finditer(text):
        for high, low in re.findall(r"(\d{1,3})(?::(\d{1,3}))?", found[1]):
            yield from range(int(low or high), int(high) + 1)


def access_repeated(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a register with fixed contents is not writable, and has the access that its errata use."""
    registers = by_name(spec, "registers")
    for path, register in items(spec, "registers"):
        fields = [field for _, field in items(register, "fields")]
        fixed = bool(fields) and all("equals" in field for field in fields)
        is_explained = "note" in register or explained(report.document, "registers", register["name"], "access")
        if fixed and register["access"] == "read_write" and not is_explained:
            wrong = f"all fields of {quoted(register['name'])} have a fixed value ('equals'), so it should be read_only"
            right = "if the manual says read_write, say so in a 'note'"
            report.add("access-mismatch", (*path, "access"), f"{wrong}; {right}")
    for path, erratum in items(spec, "errata"):
        # A sentence about bits or fields is not about the register.
        used = erratum.get("used", "")
        said = set() if re.search(r"\b(?:bit|field)", used, re.IGNORECASE) else {*_ONLY.findall(used)}
        for text in erratum.get("affects", ()) if len(said) == 1 else ():
            kind, _, name = text.partition(".")
            access = f"{next(iter(said))}_only"
            if kind == "registers" and name in registers and registers[name]["access"] != access:
                wrong = f"this says {access}, but {quoted(name)} is {registers[name]['access']}"
                report.add("access-mismatch", (*path, "used"), f"{wrong}; one of the two is wrong")


def zero_within_limits(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the number for which zero stands is within the limits of its register."""
    for path, register in items(spec, "registers"):
        for _, field in items(register, "fields"):
            zero, highest = field.get("zero_means"), register.get("max")
            is_limited = register.get("limits_of") in (None, field.get("name"))
            # 0 can stand for the number after the highest one, such as 65536 in 16 bits.
            if isinstance(zero, int) and isinstance(highest, int) and is_limited and zero > highest + 1:
                wrong = f"zero stands for {zero}, which is above 'max' ({highest})"
                report.add("limit-does-not-fit", (*path, "max"), f"{wrong}; one of the two is wrong")


def requests_repeated(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the number of requests in a text of a procedure is the one that its step sends."""
    for path, procedure in items(spec, "procedures"):
        times = {step["times"] for _, step in items(procedure, "steps") if "times" in step}
        only = len(times) == 1 and len(procedure["steps"]) == 1
        for below, text in leaves(procedure) if only else ():
            for found in _REQUESTS.findall(text) if isinstance(text, str) else ():
                number = int(found) if found.isdigit() else _NUMBERS.index(found.casefold()) + 2
                if number not in times:
                    wrong = f"the text says {found} requests, but 'times' is {next(iter(times))}"
                    report.add("quantity-repeated", (*path, *below), f"{wrong}; one of the two is wrong")


def table_repeated(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that two tables with common columns agree in their numbers, if they do so in all cells but one.

    Rows belong together if a column whose cells are all different has the same cell in both.
    """
    tables = list(items(spec, "tables"))[:_MOST_TABLES]
    for index, (path, table) in enumerate(tables):
        for _, other in tables[:index]:
            common = [name for name in table["columns"] if name in other["columns"]]
            for key in (name for name in common if _is_key(table, name) and _is_key(other, name)):
                rows = {_cell(other, row, key): row for row in other["rows"]}
                pairs = [
                    (at, row, rows[of])
                    for at, row in enumerate(table["rows"])
                    if (of := _cell(table, row, key)) in rows
                ]
                cells = [
                    [(at, name, _cell(table, here, name), _cell(other, there, name)) for at, here, there in pairs]
                    for name in common
                    if name != key
                ]
                cells = [[item for item in column if all(map(_NUMBER.fullmatch, item[2:]))] for column in cells]
                wrong = [[item for item in column if item[2] != item[3]] for column in cells]
                # A column that mostly differs, such as one of texts, is about something else.
                alike = [(column, bad) for column, bad in zip(cells, wrong, strict=True) if 2 * len(bad) <= len(column)]
                if sum(len(bad) for _, bad in alike) == 1 and sum(len(column) for column, _ in alike) > _CELLS:
                    at, name, here, there = next(bad[0] for _, bad in alike if bad)
                    said = f"{quoted(name)} is {here} here, but {there} in the table {quoted(other['name'])}"
                    place = (*path, "rows", at, table["columns"].index(name))
                    report.add("quantity-repeated", place, f"{said}; one of the two is wrong")
                    break


def _cell(table: Spec, row: list[Any], column: str) -> str:
    at = table["columns"].index(column)
    return str(row[at]) if at < len(row) else ""


def _is_key(table: Spec, column: str) -> bool:
    found = [_cell(table, row, column) for row in table["rows"]]
    return len(found) == len(set(found))
