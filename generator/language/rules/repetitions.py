"""Rules for what a spec has twice: items of a list, texts of neighbors, and facts about an encoder as a whole."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ...model import Biss
from ..document import Path
from ..problems import DocumentReport, quoted
from ..written_codes import WrittenRegister
from ..written_interfaces import WrittenRs485
from ..written_layouts import WrittenField
from ..written_parts import WrittenSpec
from .parts import by_name, field_lists, has_erratum_at, interface_name_of
from .walk import leaves_of

#: Lists that are sets, at any place.
_LISTS_THAT_ARE_SETS = frozenset(
    """
    interfaces sums_up explained_by write_clears cleared_by by_hand data_id memory_access printed also_written
    cable_lengths
    """.split()
)
#: Maps of lists that are sets.
_MAPS_OF_SETS = frozenset(("only_with", "open_only_with"))
#: Name of a device description file: idbiss and the manufacturer ID in hexadecimal.
_DESCRIPTION_FILE = re.compile(r"idbiss([0-9A-Fa-f]+)\.xml")
_ALIGNMENTS = {"left": "msb_left", "right": "lsb_right"}
#: A bit and the side to which it is aligned, as in ``MSB left-aligned`` and ``LSB aligned to the right``.
_ALIGNMENT_IN_TEXT = re.compile(r"\b[ML]SB (?:(?=\w+[ -]aligned)|aligned to the )(left|right)\b", re.IGNORECASE)
_NUMBER_WORDS = {"one": 1, "two": 2, "nine": 9, "ten": 10, "eleven": 11, "twelve": 12}
_STOP_BITS = re.compile(r"\b(one|two|[12]) stop bits?\b", re.IGNORECASE)
_CHARACTER_LENGTH = re.compile(r"\b(nine|ten|eleven|twelve|9|1[0-2]) bits\b", re.IGNORECASE)
_PARITY_IN_TEXT = re.compile(r"\b(no|even|odd) parity\b", re.IGNORECASE)


def check_repeated_items(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no element occurs twice in a list without repetitions, such as ``sums_up``."""
    for path, elements in _lists_without_repetitions(spec.data, ()):
        for index, element in enumerate(elements):
            first_index = elements.index(element)
            if first_index < index:
                element_text = quoted(element) if isinstance(element, (str, int)) else "this"
                message = (
                    f"{element_text} is already item {first_index + 1} of '{path[-1]}'; "
                    "remove it, or write the intended value"
                )
                report.add("repeated-item", (*path, index), message)


def _lists_without_repetitions(node: object, path: Path) -> Iterator[tuple[Path, list[object]]]:
    """Yield every list in a part of a spec, at ``path``, in which no element may occur twice, with its path.

    The key of the list decides, as for ``sums_up``, or the key of the map that contains it, as for ``only_with``.
    """
    if isinstance(node, list):
        key_of_map = path[-2] if len(path) > 1 else ""
        if path[-1] in _LISTS_THAT_ARE_SETS or key_of_map in _MAPS_OF_SETS:
            yield path, node
        for index, element in enumerate(node):
            yield from _lists_without_repetitions(element, (*path, index))
    elif isinstance(node, dict):
        for key, value in node.items():
            yield from _lists_without_repetitions(value, (*path, key))


class _NamedText(NamedTuple):
    """A text of a part, with the name of the part and the place of the text. A missing text is empty."""

    text: str
    name: str
    path: Path


def check_repeated_text(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no two registers of a bank, fields of a frame or values of a field have the same text.

    Printed names are compared, and meanings of several words for values.
    """
    registers_by_bank: dict[object, list[WrittenRegister]] = {}
    for register in spec.registers:
        bank = (interface_name_of(register), register.bank)
        registers_by_bank.setdefault(bank, []).append(register)
    for registers in registers_by_bank.values():
        _report_repeated("printed_name", map(_printed_name_of, registers), report)
    for field_list in field_lists(spec):
        data_fields = filter(_has_data, field_list.fields)
        _report_repeated("printed_name", map(_printed_name_of, data_fields), report)
        for field in field_list.fields:
            _check_values(field, report)


def _check_values(field: WrittenField, report: DocumentReport) -> None:
    """Check that no two named values of a field have the same printed name, or the same meaning of several words."""
    printed_names = []
    long_meanings = []
    for name, value in field.values.items():
        printed_name = _NamedText(value.printed_name, name, value.place_of("printed_name"))
        meaning = _NamedText(value.meaning, name, value.place_of("meaning"))
        printed_names.append(printed_name)
        has_three_words = meaning.text.count(" ") > 1  # Several values can be "not used".
        if has_three_words:
            long_meanings.append(meaning)
    _report_repeated("printed_name", printed_names, report)
    _report_repeated("meaning", long_meanings, report)


def _printed_name_of(register_or_field: WrittenRegister | WrittenField) -> _NamedText:
    """Return the printed name of a part, with its name or, without one, its index."""
    return _NamedText(
        text=register_or_field.printed_name,
        name=register_or_field.name or str(register_or_field.path[-1]),
        path=register_or_field.place_of("printed_name"),
    )


def _has_data(field: WrittenField) -> bool:
    """Return True for a field with data. Fixed bits and check bits have none, and can repeat a name in a frame."""
    is_fixed = field.constant is not None or field.unused is not None
    is_check = bool(field.crc or field.parity_of)
    return not is_fixed and not is_check


def _report_repeated(text_key: str, texts: Iterable[_NamedText], report: DocumentReport) -> None:
    """Report every text under ``text_key`` that an earlier part with another name also has, except empty texts."""
    first_names: dict[str, str] = {}
    for text, name, path in texts:
        if not text:
            continue
        first_name = first_names.setdefault(text, name)
        if first_name != name:
            message = f"{quoted(first_name)} already has this text as its {quoted(text_key)}; one of the two is wrong"
            report.add("repeated-text", path, message)


def check_description_file(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the file name of the BiSS device description contains the manufacturer ID that the register holds.

    The register holds two ASCII characters, and the file name contains their four hexadecimal digits.
    """
    biss = spec.interfaces.biss
    register = by_name(spec.registers).get("manufacturer_id")
    if biss is None or register is None or interface_name_of(register) != Biss.name:
        return
    file_name = _DESCRIPTION_FILE.fullmatch(biss.description_file)
    if file_name is None:
        return
    fixed_texts = [field.equals for field in register.fields if isinstance(field.equals, str)]
    ascii_texts = [text for text in fixed_texts if text.isascii()]
    id_of_register = "".join(ascii_texts).encode("ascii").hex()  # 4c41 for LA.
    id_in_file_name = file_name[1]
    is_complete = len(id_of_register) == 4
    if is_complete and id_of_register != id_in_file_name.casefold():
        message = (
            f"the file is for the manufacturer ID {id_in_file_name.upper()}h, but the register 'manufacturer_id' has"
            f" {id_of_register.upper()}h; correct one of the two"
        )
        report.add("description-file", biss.place_of("description_file"), message)


def check_alignment(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``alignment`` of SSI is the alignment that the table of contents and the order code name.

    Nothing is checked if they name none or both.
    """
    ssi = spec.interfaces.ssi
    texts = [section.title for section in spec.manual.contents.values()]
    for part in spec.order_code.parts:
        texts += [value.meaning for value in part.values.values()]
    named_alignments: set[str] = set()
    for text in texts:
        for side in _ALIGNMENT_IN_TEXT.findall(text):
            named_alignments.add(_ALIGNMENTS[side.casefold()])
    if ssi is None or not ssi.alignment or len(named_alignments) != 1:
        return
    if has_erratum_at(report.document, "interfaces", "ssi", "alignment"):
        return
    named_alignment = named_alignments.pop()
    if ssi.alignment != named_alignment:
        message = (
            f"the table of contents or the order code says {quoted(named_alignment)}, but 'alignment' is"
            f" {quoted(ssi.alignment)}; correct one of the two. If both are right, add an erratum that affects"
            " interfaces.ssi.alignment"
        )
        report.add("alignment-mismatch", ssi.place_of("alignment"), message)


def check_serial_port(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the stop bits, parity and bits per character in the note of an RS-485 interface match its ``port``."""
    rs485 = spec.interfaces.rs485
    if rs485 is None or not rs485.port.is_given:
        return
    port = rs485.port.part
    parity_bits = 0 if port.parity == "none" else 1
    settings = [
        _SettingInText("stop_bits", _STOP_BITS, str(port.stop_bits)),
        _SettingInText("parity", _PARITY_IN_TEXT, port.parity.replace("none", "no")),
    ]
    # If the note mentions the start bit, its number of bits is the number of the whole character.
    if "start bit" in rs485.note:
        bits_of_character = 1 + port.data_bits + parity_bits + port.stop_bits
        settings.append(_SettingInText("data_bits", _CHARACTER_LENGTH, str(bits_of_character)))
    _compare_with_port(rs485, settings, report)


class _SettingInText(NamedTuple):
    """A setting of a port, the pattern of texts about it, and the number or word that they must contain."""

    key: str
    pattern: re.Pattern[str]
    expected_word: str


def _compare_with_port(rs485: WrittenRs485, settings: Iterable[_SettingInText], report: DocumentReport) -> None:
    """Report the first words in the note of an RS-485 interface that contradict a setting of its port."""
    for setting in settings:
        for word in setting.pattern.findall(rs485.note):
            plain_word = word.casefold()
            number_or_word = str(_NUMBER_WORDS.get(plain_word, plain_word))  # "2" for "Two", "even" for "even".
            if number_or_word != setting.expected_word:
                line, _ = report.document.position((*rs485.port.path, setting.key))
                requirement = f"{quoted(setting.key)} of 'port' on line {line} requires {setting.expected_word}"
                message = f"the text says {quoted(word)}, but {requirement}; correct one of the two"
                report.add("port-mismatch", rs485.place_of("note"), message)
                return


def check_bounds(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the lower and the upper bound of a quantity are different."""
    for characteristic in spec.characteristics:
        for index, quantity in enumerate(characteristic.part.values):
            if quantity.min is not None and quantity.min == quantity.max:
                message = f"'min' and 'max' are both {quantity.min:g}; correct one of them, or write 'typical'"
                report.add("quantity-text", (*characteristic.path, "values", index, "min"), message)


def check_numbers_of_conditions(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the numbers in ``where``, the condition of a quantity, are in the text of the characteristic."""
    for characteristic in spec.characteristics:
        printed_text = characteristic.part.value
        printed_numbers = set(_NUMBER_IN_TEXT.findall(printed_text))
        for index, quantity in enumerate(characteristic.part.values):
            numbers_of_condition = _NUMBER_IN_TEXT.findall(quantity.where)
            missing_numbers = [number for number in numbers_of_condition if number not in printed_numbers]
            if missing_numbers:
                message = f"'where' has {missing_numbers[0]}, which the text does not have; correct one of the two"
                report.add("quantity-text", (*characteristic.path, "values", index, "where"), message)


_NUMBER_IN_TEXT = re.compile(r"(?<![\w.,])\d+(?:\.\d+)?(?![\w,]*\d)")
_HEX_CELL = re.compile(r"(?:0x)?([0-9A-F]+)h?")


def check_address_tables(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each row of a table with first and last addresses is a range: the first address is not the higher one.

    Both addresses must have the same number of digits. Rows with other text than hexadecimal numbers are skipped.
    """
    for table in spec.tables:
        address_columns: list[int] = []
        for index, heading in enumerate(table.part.columns):
            if heading.casefold() in ("first address", "last address"):
                address_columns.append(index)
        if len(address_columns) != 2:
            continue
        for row_index, row in enumerate(table.part.rows):
            cells = [row[column_index] for column_index in address_columns if column_index < len(row)]
            matches = [_HEX_CELL.fullmatch(cell) for cell in cells]
            digits_of_addresses = [match[1] for match in matches if match is not None]
            if len(digits_of_addresses) != 2:
                continue
            first_digits, last_digits = digits_of_addresses
            has_equal_length = len(first_digits) == len(last_digits)
            is_range = has_equal_length and int(first_digits, 16) <= int(last_digits, 16)
            if not is_range:
                path = (*table.path, "rows", row_index, address_columns[0])
                message = f"{cells[0]} to {cells[1]} is not a range of addresses; correct one of the two"
                report.add("table-shape", path, message)


_WORD_WITH_DIGITS = re.compile(r"\b[A-Za-z]+\d\w*")
#: Shortest start of an order code of which a word with the same letters in another order is a mistake.
_SHORTEST_START = 5


def check_swapped_letters(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no text contains the beginning of an order code with swapped characters, such as ABC12 for ABC21.

    The beginning is the text before the first part of the order code. It is not compared if it is short.
    """
    text_before_parts, _, _ = spec.order_code.pattern.partition("{")
    fixed_start = text_before_parts.strip("-/ ")
    if len(fixed_start) < _SHORTEST_START:
        return
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or path[-1] == "printed" or path[0] in ("documents", "evidence"):
            continue
        other_words = [word for word in _WORD_WITH_DIGITS.findall(text) if word != fixed_start]
        swapped_words = [word for word in other_words if sorted(word) == sorted(fixed_start)]
        if swapped_words:
            problem = (
                f"{quoted(swapped_words[0])} has the characters of {quoted(fixed_start)}, which begins order codes"
            )
            report.add("misspelt-name", path, f"{problem}; correct it")
