"""Rules for facts that a spec gives twice: in data and in a text, in two tables, or in the contents of the manual."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from ...model import Table
from ..hints import POLYNOMIAL, polynomial_powers
from ..problems import DocumentReport, Path, is_typo, quoted
from ..written_layouts import WrittenField
from ..written_parts import WrittenErratum, WrittenSpec
from .parts import FieldOwner, by_name, constant_width, field_lists, has_erratum_at, owner_of_alarm
from .walk import leaves, leaves_of

#: A hexadecimal number in a text.
_HEX_IN_TEXT = re.compile(r"\b(?:0x([0-9A-Fa-f]+)|([0-9][0-9A-F]*)h)\b")
#: Words before a number that is a place and not a value.
_WORDS_BEFORE_A_PLACE = re.compile(r"\b(?:register|address|at)\b", re.IGNORECASE)
_BIT = r"\d{1,3}(?::\d{1,3})?"
#: The place of a field: its highest and its lowest bit, or its only one.
_FIELD_BITS = re.compile(r"([0-9]{1,4})(?::([0-9]{1,4}))?")
#: Bits that a sentence calls unused without a condition.
_CALLED_UNUSED = re.compile(
    rf"(?:^|[.;] )bits? ({_BIT}(?:(?:,| and|, and) {_BIT})*) (?:is|are) (?:not used|unused)(?=[.;]|$)", re.IGNORECASE
)
#: An access in words. The group is ``read`` or ``write``.
_ACCESS_IN_WORDS = re.compile(r"\b(?:is|are) (read|write)[ -]only\b")
_NUMBER_WORDS = ("two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")
_COUNT_OF_REQUESTS = re.compile(rf"\b({'|'.join(_NUMBER_WORDS)}|[1-9]\d?) requests\b", re.IGNORECASE)
#: Cells of two tables that must agree before one that differs is a mistake.
_LEAST_EQUAL_CELLS = 8
#: Letters that a word needs so that one differing letter is likely a mistake, not another word.
_LEAST_LETTERS = 6
#: Longest contents and most tables that are compared. A manual has some 50 entries and 10 tables.
_MOST_ENTRIES, _MOST_TABLES = 200, 50
_DECIMAL_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
#: Printed names that are numbers: binary in quotes, hexadecimal as in 0x1F or 0Ah, binary as in 0b01. Plain digits may
#: be a name.
_IN_QUOTES = re.compile(r"\"([01]+)\"|'([01]+)'|“([01]+)”")
_WITH_PREFIX = re.compile(r"0[xX][0-9A-Fa-f]+|0b[01]+")
_WITH_SUFFIX = re.compile(r"((?:0[0-9A-F]*|[0-9A-F]*[A-F][0-9A-F]*))h")


class _Printed(Protocol):
    """A part with its names in manuals."""

    @property
    def printed_name(self) -> str: ...

    @property
    def names(self) -> Mapping[str, str]: ...


def check_misspelt_name(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no name in the manual differs by one letter from an entry of its contents, which would be a typo.

    The names of an alarm are also compared with the names of its flag.
    """
    _compare_with_contents(spec, report)
    for alarm in spec.alarms:
        group_or_register = owner_of_alarm(spec, alarm)
        if group_or_register is None:
            continue
        flag = by_name(group_or_register.fields).get(alarm.part.field)
        if flag is None:
            continue
        # The names by their keys, such as ("names", "it"), so that each is compared with the name in its language.
        flag_names = dict(_printed_names(flag))
        for name_path, name in _printed_names(alarm.part):
            flag_name = flag_names.get(name_path, "")
            if _misspells(name, flag_name):
                message = f"the flag of this alarm has {quoted(flag_name)}; correct one of the two"
                report.add("misspelt-name", (*alarm.path, *name_path), message)


def _compare_with_contents(spec: WrittenSpec, report: DocumentReport) -> None:
    """Report each printed name that differs by one letter from an entry of the manual's table of contents.

    An erratum with this name explains it. Names in other languages are not compared, and very long contents are not
    searched.
    """
    manual = spec.with_invalid_parts.manual
    titles: dict[str, str] = {}  # Titles as printed, by their lower case.
    for section in manual.contents.values():
        titles |= {title.casefold(): title for title in section.names_in("entries")}
    if len(titles) > _MOST_ENTRIES:
        return
    texts_of_errata = "\n".join(erratum.used.casefold() for erratum in spec.errata)
    for path, name in leaves_of(spec.data, report):
        # A name in another language can differ by one letter too: temperature, temperatura.
        is_name = path[-1] == "printed_name" or path[-2:] == ("names", manual.language)
        if not is_name or not isinstance(name, str):
            continue
        similar_titles = [title for title in titles if _misspells(name, title)]
        is_known = name.casefold() in titles or name.casefold() in texts_of_errata
        if similar_titles and not is_known:
            message = (
                f"the table of contents has {quoted(titles[similar_titles[0]])}; correct one of the two, "
                "or add an erratum whose 'used' has this name"
            )
            report.add("misspelt-name", path, message)


def _misspells(printed_name: str, correct_name: str) -> bool:
    """Return True if two names differ in only one word, and by only one letter in it.

    Short words, which may be different words, and words that differ only in a plural s are not counted as misspelt.
    """
    if abs(len(printed_name) - len(correct_name)) > 1:
        return False
    words, correct_words = printed_name.casefold().split(), correct_name.casefold().split()
    if len(words) != len(correct_words):
        return False
    word_pairs = zip(words, correct_words, strict=True)
    different_pairs = [(word, correct_word) for word, correct_word in word_pairs if word != correct_word]
    if len(different_pairs) != 1:
        return False
    word, correct_word = different_pairs[0]
    differs_only_in_plural = word.rstrip("s") == correct_word.rstrip("s")
    return len(correct_word) >= _LEAST_LETTERS and not differs_only_in_plural and is_typo(word, correct_word)


def _printed_names(part: _Printed) -> Iterator[tuple[Path, str]]:
    """Yield the printed names of a part, each with its path below it."""
    yield ("printed_name",), part.printed_name
    for language, name in part.names.items():
        yield ("names", language), name


def check_printed_number(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a named value has the number that is its name in the manual, if that is a number such as ``0Ah``."""
    for field_list in field_lists(spec):
        for field in field_list.fields:
            for name, value in field.values.items():
                printed_number = _printed_number(value.printed_name, constant_width(field))
                if printed_number is not None and printed_number != value.value:
                    problem = f"{quoted(name)} is printed as {value.printed_name}, which is {printed_number}"
                    message = f"{problem}, but 'value' is {value.value}"
                    report.add("printed-number", value.place_of("value"), message)


def _printed_number(printed_name: str, width: int | None) -> int | None:
    """Return the number if a printed name is a number as in ``0x1F``, ``0b01``, ``0Ah`` or ``"01"``, otherwise None.

    Zeros and ones in quotes are a binary number if they have as many digits as the field has bits.
    """
    if _IN_QUOTES.fullmatch(printed_name):
        digits = printed_name[1:-1]  # without the quotes
        return int(digits, 2) if len(digits) == width else None
    if _WITH_PREFIX.fullmatch(printed_name):
        return int(printed_name, 0)
    with_suffix = _WITH_SUFFIX.fullmatch(printed_name)
    return int(with_suffix[1], 16) if with_suffix is not None else None


def check_number_in_meaning(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a hexadecimal number in the meaning of a field is the number that the field always has.

    Only fields with such a number and a single number in the meaning are checked. A meaning that names a register or an
    address is not checked, because its number may be an address.
    """
    for field_list in field_lists(spec):
        for field in field_list.fields:
            fixed_numbers = _fixed_numbers(field)
            if not fixed_numbers or _WORDS_BEFORE_A_PLACE.search(field.meaning):
                continue
            key, fixed_number = fixed_numbers[0]
            printed_numbers = set()
            for digits_after_0x, digits_before_h in _HEX_IN_TEXT.findall(field.meaning):  # One of the two is empty.
                printed_numbers.add(int(digits_after_0x or digits_before_h, 16))
            if len(printed_numbers) == 1 and fixed_number not in printed_numbers:
                message = (
                    f"the meaning has {printed_numbers.pop():#x}, but {quoted(key)} is {fixed_number:#x}; "
                    "one of the two is wrong"
                )
                report.add("printed-number", field.place_of(key), message)


def _fixed_numbers(field: WrittenField) -> list[tuple[str, int]]:
    """Return the numbers that a field always has according to its keys, each with its key: ``("constant", 5)``."""
    numbers_by_key = {"constant": field.constant, "equals": field.equals, "unused": field.unused}
    return [(key, number) for key, number in numbers_by_key.items() if isinstance(number, int)]


def check_polynomial_in_note(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the polynomial of a CRC is one of those in its note, if the note contains any.

    A note gives a polynomial with its top bit, which ``poly`` omits.
    """
    for located_crc in spec.crcs:
        crc = located_crc.part
        printed_polynomials = _printed_polynomials(crc.note, crc.width)
        top_bit = 1 << crc.width
        polynomial = crc.poly + top_bit
        if printed_polynomials and polynomial not in printed_polynomials.values():
            first_text, *_ = printed_polynomials
            message = (
                f"the note has {first_text}, but 'poly' is {crc.poly:#x}, "
                f"or {polynomial:#x} with its top bit; one of the two is wrong"
            )
            report.add("printed-number", (*located_crc.path, "poly"), message)


def _printed_polynomials(note: str, width: int) -> dict[str, int]:
    """Return the polynomials of a CRC of this width in a note, with their top bit, by their text: ``{"x^2 + 1": 0x5}``.

    An odd hexadecimal number with one bit more than the CRC counts as a polynomial, unless the note mentions a register
    or an address.
    """
    polynomials: dict[str, int] = {}
    top_bit = 1 << width
    if not _WORDS_BEFORE_A_PLACE.search(note):
        for match in _HEX_IN_TEXT.finditer(note):
            digits_after_0x, digits_before_h = match.groups()  # One of the two is None.
            number = int(digits_after_0x or digits_before_h, 16)
            is_odd = number & 1 == 1  # Every polynomial of a CRC ends in + 1.
            if is_odd and top_bit < number < 2 * top_bit:
                polynomials[match[0]] = number
    for match in POLYNOMIAL.finditer(note):
        powers = polynomial_powers(match[0])
        if max(powers) == width and 0 in powers:
            polynomials[match[0]] = sum(1 << power for power in powers)
    return polynomials


def check_unused_bits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a register has no field at bits that its note calls unused.

    A constant, unused bits and a field that is always 0 carry no data, so they may be there.
    """
    for field_list in field_lists(spec):
        unused_bits = set(_unused_bits_in(field_list.owner.note))
        if field_list.owner_kind is not FieldOwner.REGISTER or not unused_bits:
            continue
        for field in field_list.fields:
            contradicting_bits = unused_bits.intersection(_bits_at(field.at))
            carries_data = field.constant is None and field.unused is None and field.equals != 0
            if contradicting_bits and carries_data:
                message = (
                    f"the note says that bit {min(contradicting_bits)} is not used, but {quoted(field.name)} uses it; "
                    "one of the two is wrong"
                )
                report.add("unused-bits", field.place_of("at"), message)


def _bits_at(place: int | str | None) -> range:
    """Return the bits of a place such as ``7:6`` or ``5``. Empty for None, and for text that is not a place."""
    match = _FIELD_BITS.fullmatch(str(place))
    if match is None:
        return range(0)
    highest_text, lowest_text = match.groups()
    highest_bit = int(highest_text)
    lowest_bit = int(lowest_text) if lowest_text else highest_bit
    return range(lowest_bit, highest_bit + 1)


def _unused_bits_in(note: str) -> Iterator[int]:
    """Yield the bits that a note calls unused, such as 6, 7 and 2 for ``bits 7:6 and 2 are not used``."""
    for match in _CALLED_UNUSED.finditer(note):
        listed_bits = match[1]  # ``7:6 and 2``
        for highest, lowest in re.findall(r"(\d{1,3})(?::(\d{1,3}))?", listed_bits):
            yield from range(int(lowest or highest), int(highest) + 1)


def check_repeated_access(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a register whose fields all have a fixed value (``equals``) is not writable.

    A note or an erratum can explain it. Also check that registers have the access that errata about them state.
    """
    for register in spec.registers:
        fixed_fields = [field for field in register.fields if field.equals is not None]
        has_only_fixed_fields = bool(fixed_fields) and len(fixed_fields) == len(register.fields)
        is_explained_by_note = bool(register.note)
        if not has_only_fixed_fields or register.access != "read_write" or is_explained_by_note:
            continue
        if not has_erratum_at(report.document, "registers", register.name, "access"):
            message = (
                f"all fields of {quoted(register.name)} have a fixed value ('equals'), so it should be read_only; "
                "if the manual says read_write, say so in a 'note'"
            )
            report.add("access-mismatch", register.place_of("access"), message)
    for erratum in spec.errata:
        _check_access_in_erratum(spec, erratum, report)


def _check_access_in_erratum(spec: WrittenSpec, erratum: WrittenErratum, report: DocumentReport) -> None:
    """Check that the registers that an erratum affects have the access that it states, ``read-only`` or ``write-only``.

    The key ``used`` of an erratum is its text about what applies instead of the manual. A text about bits or fields, or
    with both accesses, is not compared.
    """
    registers = by_name(spec.registers)
    is_about_bits = re.search(r"\b(?:bit|field)", erratum.used, re.IGNORECASE) is not None
    stated_accesses = set(_ACCESS_IN_WORDS.findall(erratum.used))
    if is_about_bits or len(stated_accesses) != 1:
        return
    stated_access = f"{stated_accesses.pop()}_only"
    for affected_path in erratum.affects:
        section, _, name = affected_path.partition(".")
        if section != "registers" or name not in registers:
            continue
        access = registers[name].access
        if access != stated_access:
            message = f"this says {stated_access}, but {quoted(name)} is {access}; one of the two is wrong"
            report.add("access-mismatch", erratum.place_of("used"), message)


def check_zero_within_limits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check ``zero_means``, the number for which a stored 0 stands, against the highest number of its register.

    It may be at most one higher: in 16 bits, 0 can stand for 65536. A highest number that depends on the order code is
    not compared.
    """
    for register in spec.registers:
        for field in register.fields:
            meaning_of_zero = field.zero_means
            highest = register.max
            is_limited = register.limits_of in ("", field.name)
            if not is_limited or not isinstance(meaning_of_zero, int) or not isinstance(highest, int):
                continue
            if meaning_of_zero > highest + 1:
                message = (
                    f"zero stands for {meaning_of_zero}, which is above 'max' ({highest}); one of the two is wrong"
                )
                report.add("limit-does-not-fit", register.place_of("max"), message)


def check_repeated_requests(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a text of a procedure with one step has the number of requests that the step sends."""
    for procedure in spec.procedures:
        times = procedure.steps[0].times if len(procedure.steps) == 1 else None
        if times is None:
            continue  # With several steps, it is not known about which of them a text speaks.
        for text_path, text in leaves(procedure.data):
            if not isinstance(text, str):
                continue
            for stated_count in _COUNT_OF_REQUESTS.findall(text):
                if _parse_count(stated_count) != times:
                    message = f"the text says {stated_count} requests, but 'times' is {times}; one of the two is wrong"
                    report.add("quantity-repeated", (*procedure.path, *text_path), message)


def _parse_count(count_text: str) -> int:
    """Return a count in digits, or in words from two to twelve."""
    if count_text.isdigit():
        return int(count_text)
    return _NUMBER_WORDS.index(count_text.casefold()) + 2  # The first word is "two".


def check_repeated_tables(spec: WrittenSpec, report: DocumentReport) -> None:
    """Report two tables with common columns whose numbers agree in all cells but one.

    Rows belong together if a column whose cells are all different in each table contains the same cell in both.
    """
    tables = spec.tables[:_MOST_TABLES]
    for index, located_table in enumerate(tables):
        table = located_table.part
        earlier_tables = [earlier.part for earlier in tables[:index]]
        for earlier_table in earlier_tables:
            pair = _only_difference(table, earlier_table)
            if pair is not None:
                message = (
                    f"{quoted(pair.column)} is {pair.cell} here, but {pair.earlier_cell} in the table "
                    f"{quoted(earlier_table.name)}; one of the two is wrong"
                )
                path = (*located_table.path, "rows", pair.row, table.columns.index(pair.column))
                report.add("quantity-repeated", path, message)


@dataclass(frozen=True, slots=True)
class _CellPair:
    """Cells of two tables that must agree, with the column and the row of the first cell."""

    row: int
    column: str
    cell: str
    earlier_cell: str

    @property
    def is_numeric(self) -> bool:
        """Return True if both cells are numbers, or texts with a number that have the same words: ``below 7``."""
        words = {_DECIMAL_NUMBER.sub("", cell) for cell in (self.cell, self.earlier_cell)}
        return len(words) == 1 and _DECIMAL_NUMBER.search(self.cell) is not None


def _only_difference(table: Table, earlier_table: Table) -> _CellPair | None:
    """Return the pair of cells that differs if two tables have the same numbers in all common cells but one.

    Rows belong together if they have the same cell in a column that identifies rows. A column in which most numbers
    differ is left out, because it is about something else. The result is None if no number or several numbers differ,
    or if too few are equal.
    """
    common_columns = [name for name in table.columns if name in earlier_table.columns]
    for key_column in common_columns:
        if not _identifies_rows(table, key_column) or not _identifies_rows(earlier_table, key_column):
            continue
        compared_pairs: list[_CellPair] = []
        for column in common_columns:
            if column == key_column:
                continue
            pairs = _number_pairs(table, earlier_table, key_column, column)
            are_mostly_equal = 2 * len(_differing_cells(pairs)) <= len(pairs)
            if are_mostly_equal:
                compared_pairs += pairs
        differing_pairs = _differing_cells(compared_pairs)
        if len(differing_pairs) == 1 and len(compared_pairs) > _LEAST_EQUAL_CELLS:
            return differing_pairs[0]
    return None


def _number_pairs(table: Table, earlier_table: Table, key_column: str, column: str) -> list[_CellPair]:
    """Return the pairs of cells with numbers in a column, from the rows with the same cell in ``key_column``."""
    earlier_cells: dict[str, str] = {}  # The cells in the column by the cells in the key column.
    for row in earlier_table.rows:
        key_cell = _text_of_cell(earlier_table, row, key_column)
        earlier_cells[key_cell] = _text_of_cell(earlier_table, row, column)
    cell_pairs = []
    for row_number, row in enumerate(table.rows):
        key_cell = _text_of_cell(table, row, key_column)
        if key_cell in earlier_cells:
            cell = _text_of_cell(table, row, column)
            cell_pairs.append(_CellPair(row_number, column, cell, earlier_cell=earlier_cells[key_cell]))
    return [pair for pair in cell_pairs if pair.is_numeric]


def _differing_cells(pairs: list[_CellPair]) -> list[_CellPair]:
    return [pair for pair in pairs if pair.cell != pair.earlier_cell]


def _text_of_cell(table: Table, row: Sequence[str], column: str) -> str:
    """Return the text in a column of a row, or an empty string if the row is too short."""
    index = table.columns.index(column)
    return row[index] if index < len(row) else ""


def _identifies_rows(table: Table, column: str) -> bool:
    """Return True if all cells of a column are different, so that each identifies its row."""
    cells = [_text_of_cell(table, row, column) for row in table.rows]
    return len(cells) == len(set(cells))
