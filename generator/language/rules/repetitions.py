"""Rules for what a spec has twice: items of a list, texts of neighbors, and facts about an encoder as a whole."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
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
    for path, elements in _lists_without_repetitions((), spec.data):
        for index, element in enumerate(elements):
            first_index = elements.index(element)
            if first_index < index:
                element_text = quoted(element) if isinstance(element, (str, int)) else "this"
                message = (
                    f"{element_text} is already item {first_index + 1} of '{path[-1]}'; "
                    "remove it, or write the intended value"
                )
                report.add("repeated-item", (*path, index), message)


def _lists_without_repetitions(path: Path, node: object) -> Iterator[tuple[Path, list[object]]]:
    """Yield every list in a part of a spec, at ``path``, in which no element may occur twice, with its path.

    The key of the list decides, as for ``sums_up``, or the key of the map that contains it, as for ``only_with``.
    """
    if isinstance(node, list):
        is_in_map_of_sets = len(path) > 1 and path[-2] in _MAPS_OF_SETS
        if path[-1] in _LISTS_THAT_ARE_SETS or is_in_map_of_sets:
            yield path, node
        for index, inner in enumerate(node):
            yield from _lists_without_repetitions((*path, index), inner)
    elif isinstance(node, dict):
        for key, inner in node.items():
            yield from _lists_without_repetitions((*path, key), inner)


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
        registers_by_bank.setdefault((interface_name_of(register), register.bank), []).append(register)
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
    meanings = []
    for name, value in field.values.items():
        printed_names.append(_NamedText(value.printed_name, name, value.place_of("printed_name")))
        is_long = value.meaning.count(" ") > 1  # Several values can be "not used".
        if is_long:
            meanings.append(_NamedText(value.meaning, name, value.place_of("meaning")))
    _report_repeated("printed_name", printed_names, report)
    _report_repeated("meaning", meanings, report)


def _printed_name_of(register_or_field: WrittenRegister | WrittenField) -> _NamedText:
    """Return the printed name of a part, with its name or, without one, its index."""
    return _NamedText(
        register_or_field.printed_name,
        register_or_field.name or str(register_or_field.path[-1]),
        register_or_field.place_of("printed_name"),
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
    file_name = _DESCRIPTION_FILE.fullmatch(biss.description_file) if biss is not None else None
    register = by_name(spec.registers).get("manufacturer_id")
    if biss is None or file_name is None or register is None or interface_name_of(register) != Biss.name:
        return
    id_texts = [field.equals for field in register.fields if isinstance(field.equals, str) and field.equals.isascii()]
    manufacturer_id = "".join(id_texts).encode("ascii").hex()  # 4c41 for LA.
    id_of_file = file_name[1]
    if len(manufacturer_id) == 4 and manufacturer_id != id_of_file.casefold():
        message = (
            f"the file is for the manufacturer ID {id_of_file.upper()}h, but the register 'manufacturer_id' has"
            f" {manufacturer_id.upper()}h; correct one of the two"
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
        named_alignments.update(_ALIGNMENTS[side.casefold()] for side in _ALIGNMENT_IN_TEXT.findall(text))
    if ssi is None or len(named_alignments) != 1 or has_erratum_at(report.document, "interfaces", "ssi", "alignment"):
        return
    named_alignment = named_alignments.pop()
    if ssi.alignment and ssi.alignment != named_alignment:
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
    # For each key, the pattern of texts about it, and the number or word that they must contain.
    expected_words = {
        "stop_bits": (_STOP_BITS, str(port.stop_bits)),
        "parity": (_PARITY_IN_TEXT, port.parity.replace("none", "no")),
    }
    # If the note mentions the start bit, its number of bits is the number of the whole character.
    if "start bit" in rs485.note:
        bits_of_character = 1 + port.data_bits + parity_bits + port.stop_bits
        expected_words["data_bits"] = (_CHARACTER_LENGTH, str(bits_of_character))
    _compare_with_port(rs485, expected_words, report)


def _compare_with_port(
    rs485: WrittenRs485, expected_words: Mapping[str, tuple[re.Pattern[str], str]], report: DocumentReport
) -> None:
    """Report the first words in the note of an RS-485 interface that contradict a setting of its port.

    ``expected_words`` contains, for each setting, the pattern of texts about it, and the number or word that they must
    contain, such as ``"1"`` or ``"even"``.
    """
    for key, (pattern, expected) in expected_words.items():
        for word in pattern.findall(rs485.note):
            plain_word = word.casefold()
            number_or_word = str(_NUMBER_WORDS.get(plain_word, plain_word))  # "2" for "Two", "even" for "even".
            if number_or_word != expected:
                line, _ = report.document.position((*rs485.port.path, key))
                message = (
                    f"the text says {quoted(word)}, but {quoted(key)} of 'port' on line {line} requires {expected}"
                )
                report.add("port-mismatch", rs485.place_of("note"), f"{message}; correct one of the two")
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
        printed_numbers = set(_NUMBER_IN_TEXT.findall(characteristic.part.value))
        for index, quantity in enumerate(characteristic.part.values):
            missing_numbers = [
                number for number in _NUMBER_IN_TEXT.findall(quantity.where) if number not in printed_numbers
            ]
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
            hex_digits = [match[1] for match in map(_HEX_CELL.fullmatch, cells) if match is not None]
            if len(hex_digits) != 2:
                continue
            first_digits, last_digits = hex_digits
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
    start = text_before_parts.strip("-/ ")
    if len(start) < _SHORTEST_START:
        return
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or path[-1] == "printed" or path[0] in ("documents", "evidence"):
            continue
        words = [word for word in _WORD_WITH_DIGITS.findall(text) if word != start]
        swapped_words = [word for word in words if sorted(word) == sorted(start)]
        if swapped_words:
            problem = f"{quoted(swapped_words[0])} has the characters of {quoted(start)}, which begins order codes"
            message = f"{problem}; correct it"
            report.add("misspelt-name", path, message)
