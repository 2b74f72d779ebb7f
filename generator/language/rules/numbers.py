"""Rules for numbers of fields, values and CRCs: their base, their range, and texts that repeat them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ...model import Crc
from ...say import count_with_unit
from ..document import Path
from ..hints import POLYNOMIAL, polynomial_powers
from ..keys_of_fields import WrittenField
from ..keys_of_specs import WrittenErratum, WrittenSpec
from ..problems import DocumentReport, quoted
from .parts import by_part_name, constant_width, field_lists, layouts_of_interfaces
from .walk import ErratumTargets, is_derived, leaves_of, texts_in_our_words

#: Bytes, as in ``41 42 in hexadecimal``.
_BYTES_IN_HEXADECIMAL = re.compile(r"\b((?:[0-9A-F]{2} )*[0-9A-F]{2}) in hexadecimal")
#: The number in ``always 1``, but not in ``always 1.5``.
_ALWAYS_A_NUMBER = re.compile(r"\balways (\d+)\b(?!\.\d)")
_NUMBER = r"\d{1,3}(?:,\d{3})+|\d+"
#: A number in two bases: ``16 is 10h``, with the decimal number first, and ``0x10 = 16``, with the hexadecimal one.
_DECIMAL_FIRST = re.compile(rf"(?<![\w.,+])({_NUMBER}) (?:is|=) (0x[0-9A-Fa-f]+|[0-9A-F]+h)\b")
_HEXADECIMAL_FIRST = re.compile(rf"\b(0x[0-9A-Fa-f]+|[0-9][0-9A-F]*h) (?:is|=) ({_NUMBER})(?![\w.,]*\d| bits?\b)")
_STATED_WIDTH_OF_BITS = re.compile(r"\bbits (\d+):(\d+), which are (\d+) bits")


def check_characters(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the bytes in the meaning of a text field are the characters that the field always contains."""
    for field_list in field_lists(spec):
        for field in field_list.fields:
            match = _BYTES_IN_HEXADECIMAL.search(field.meaning)
            fixed_text = field.equals if field.text else None
            if match is None or not isinstance(fixed_text, str) or not fixed_text.isascii():
                continue
            stated_bytes = match[1]
            expected_bytes = fixed_text.encode("ascii").hex(" ").upper()  # 4C 41 for LA.
            if stated_bytes != expected_bytes:
                message = (
                    f"the meaning says {stated_bytes}, but 'equals' is {quoted(fixed_text)}, which is"
                    f" {expected_bytes} in hexadecimal; one of the two is wrong"
                )
                report.add("printed-number", field.path_of("equals"), message)


def check_constant_bits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that fixed bits have the number that their meaning gives after the word "always"."""
    for field_list in field_lists(spec):
        for field in field_list.fields:
            stated_numbers = _ALWAYS_A_NUMBER.findall(field.meaning)
            if len(stated_numbers) != 1:
                continue
            stated_number = int(stated_numbers[0])
            for key, number in (("constant", field.constant), ("unused", field.unused)):
                if number is not None and number != stated_number:
                    problem = f"the meaning says always {stated_numbers[0]}, but {quoted(key)} is {number}"
                    report.add("printed-number", field.path_of(key), f"{problem}; one of the two is wrong")


def check_equal_numbers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that texts that give a number in decimal and in hexadecimal, as in ``16 is 10h``, give the same number.

    Also check that texts such as ``bits 7:4, which are 4 bits`` give the correct number of bits.
    """
    for path, text in texts_in_our_words(spec, report):
        number_pairs = _DECIMAL_FIRST.findall(text)
        number_pairs += [(decimal, hexadecimal) for hexadecimal, decimal in _HEXADECIMAL_FIRST.findall(text)]
        for decimal, hexadecimal in number_pairs:
            number = int(hexadecimal.removesuffix("h"), 16)
            if int(decimal.replace(",", "")) != number:
                message = f"{hexadecimal} is {number}, not {decimal}; correct one of the two"
                report.add("printed-number", path, message)
        for highest_bit, lowest_bit, stated_width in _STATED_WIDTH_OF_BITS.findall(text):
            width = int(highest_bit) - int(lowest_bit) + 1  # Both bits belong to the range.
            if width != int(stated_width):
                message = f"bits {highest_bit}:{lowest_bit} are {width} bits, not {stated_width}; correct one of them"
                report.add("printed-number", path, message)


#: A hexadecimal number in a text.
_HEX_IN_TEXT = re.compile(r"\b(?:0x([0-9A-Fa-f]+)|([0-9][0-9A-F]*)h)\b")
#: Words before a number that is a place and not a value.
_WORDS_BEFORE_A_PLACE = re.compile(r"\b(?:register|address|at)\b", re.IGNORECASE)
#: Printed names that are numbers: binary in quotes, hexadecimal as in 0x1F or 0Ah, binary as in 0b01. Plain digits may
#: be a name.
_BINARY_IN_QUOTES = re.compile(r"\"([01]+)\"|'([01]+)'|“([01]+)”")
_NUMBER_WITH_PREFIX = re.compile(r"0[xX][0-9A-Fa-f]+|0b[01]+")
_HEXADECIMAL_WITH_SUFFIX = re.compile(r"((?:0[0-9A-F]*|[0-9A-F]*[A-F][0-9A-F]*))h")


def check_printed_number(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a named value has the number that is its name in the manual, if that is a number such as ``0Ah``."""
    for field_list in field_lists(spec):
        for field in field_list.fields:
            for name, value in field.values.items():
                printed_number = _parse_printed_number(value.printed_name, constant_width(field))
                if printed_number is not None and printed_number != value.value:
                    problem = f"{quoted(name)} is printed as {value.printed_name}, which is {printed_number}"
                    message = f"{problem}, but 'value' is {value.value}"
                    report.add("printed-number", value.path_of("value"), message)


def _parse_printed_number(printed_name: str, width: int | None) -> int | None:
    """Return the number if a printed name is a number as in ``0x1F``, ``0b01``, ``0Ah`` or ``"01"``, otherwise None.

    Zeros and ones in quotes are a binary number if they have as many digits as the field has bits.
    """
    if _BINARY_IN_QUOTES.fullmatch(printed_name):
        digits = printed_name[1:-1]  # without the quotes
        return int(digits, 2) if len(digits) == width else None
    if _NUMBER_WITH_PREFIX.fullmatch(printed_name):
        return int(printed_name, 0)
    with_suffix = _HEXADECIMAL_WITH_SUFFIX.fullmatch(printed_name)
    return int(with_suffix[1], 16) if with_suffix is not None else None


def check_number_in_meaning(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a hexadecimal number in the meaning of a field is the number that the field always has.

    Only fields with such a number and a single number in the meaning are checked. A meaning that names a register or an
    address is not checked, because its number may be an address.
    """
    for field_list in field_lists(spec):
        for field in field_list.fields:
            fixed_numbers = _fixed_numbers_with_keys(field)
            names_a_place = _WORDS_BEFORE_A_PLACE.search(field.meaning) is not None
            if not fixed_numbers or names_a_place:
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
                report.add("printed-number", field.path_of(key), message)


def _fixed_numbers_with_keys(field: WrittenField) -> list[tuple[str, int]]:
    """Return the numbers that a field always has according to its keys, each with its key: ``("constant", 5)``."""
    number_by_key = {"constant": field.constant, "equals": field.equals, "unused": field.unused}
    return [(key, number) for key, number in number_by_key.items() if isinstance(number, int)]


def check_polynomial_in_note(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the polynomial of a CRC is one of those in its note, if the note contains any.

    A note gives a polynomial with its top bit, which ``poly`` omits.
    """
    for located_crc in spec.crcs:
        crc = located_crc.part
        polynomial_by_text = _polynomials_in_note(crc.note, crc.width)
        top_bit = 1 << crc.width
        polynomial = crc.poly + top_bit
        if polynomial_by_text and polynomial not in polynomial_by_text.values():
            first_text, *_ = polynomial_by_text
            message = (
                f"the note has {first_text}, but 'poly' is {crc.poly:#x}, "
                f"or {polynomial:#x} with its top bit; one of the two is wrong"
            )
            report.add("printed-number", (*located_crc.path, "poly"), message)


def _polynomials_in_note(note: str, width: int) -> dict[str, int]:
    """Return the polynomials of a CRC of this width in a note, with their top bit, by their text: ``{"x^2 + 1": 0x5}``.

    An odd hexadecimal number with one bit more than the CRC counts as a polynomial, unless the note mentions a register
    or an address.
    """
    polynomial_by_text: dict[str, int] = {}
    top_bit = 1 << width
    if not _WORDS_BEFORE_A_PLACE.search(note):
        for match in _HEX_IN_TEXT.finditer(note):
            digits_after_0x, digits_before_h = match.groups()  # One of the two is None.
            number = int(digits_after_0x or digits_before_h, 16)
            is_odd = number & 1 == 1  # Every polynomial of a CRC ends in + 1.
            if is_odd and top_bit < number < 2 * top_bit:
                polynomial_by_text[match[0]] = number
    for match in POLYNOMIAL.finditer(note):
        powers = polynomial_powers(match[0])
        if max(powers) == width and 0 in powers:
            polynomial_by_text[match[0]] = sum(1 << power for power in powers)
    return polynomial_by_text


def check_crc_numbers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that polynomial, start value and final XOR of a CRC fit its width, and that the polynomial is odd."""
    for located_crc in spec.crcs:
        crc = located_crc.part
        path = located_crc.path
        bits_above_width = crc.poly >> crc.width
        is_even = crc.poly & 1 == 0
        if bits_above_width:
            # The polynomial may be written with its top bit, which is implied.
            has_only_top_bit = bits_above_width == 1
            poly_without_top_bit = crc.poly ^ (1 << crc.width)
            hint = f"; omit the top bit: {poly_without_top_bit:#x}" if has_only_top_bit else ""
            message = f"the polynomial {crc.poly:#x} does not fit into {crc.width} bits{hint}"
            report.add("crc-impossible", (*path, "poly"), message)
        elif is_even:
            message = f"the polynomial {crc.poly:#x} is even; every generator polynomial ends in + 1"
            report.add("crc-impossible", (*path, "poly"), message)
        for key, number in (("init", crc.init), ("xorout", crc.xorout)):
            is_too_wide = number >> crc.width > 0
            if is_too_wide:
                message = f"{quoted(key)} is {number:#x}, which does not fit into {crc.width} bits"
                report.add("crc-impossible", (*path, key), message)


def _numbers_of_field(field: WrittenField) -> Iterator[tuple[Path, str, int]]:
    """Yield each number that must fit in a field, with its path and the start of a message, such as ``'constant' is``.

    These are the numbers of its named values, and its fixed, default and expected numbers.
    """
    for name, value in field.values.items():
        yield value.path_of("value"), f"the value {quoted(name)} is", value.value
    numbers = {"constant": field.constant, "unused": field.unused, "default": field.default, "equals": field.equals}
    for key, number in numbers.items():
        if isinstance(number, int):
            yield field.path_of(key), f"{quoted(key)} is", number


def check_value_widths(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the numbers of a field are not negative and fit in the width of the field.

    A field whose width depends on the order code is not checked.
    """
    for field_list in field_lists(spec):
        for field in field_list.fields:
            width = constant_width(field)
            if width is None:
                continue
            for path, subject, number in _numbers_of_field(field):
                is_outside_width = number < 0 or number >> width > 0
                # The number for which a stored 0 stands is sent as 0. A constant is sent as it is.
                is_sent_as_zero = number == field.zero_means and path != field.path_of("constant")
                if is_outside_width and not is_sent_as_zero:
                    message = f"{subject} {number:#x}, which does not fit into {count_with_unit(width, 'bit')}"
                    report.add("value-too-wide", path, message)


#: Keys of numbers that manuals print in hexadecimal.
HEXADECIMAL = frozenset("address addresses poly init xorout check control constant unused biss_id".split())
#: Maps whose keys are names defined in the spec.
_MAPS_KEYED_BY_SPEC_NAMES = frozenset(("values", "arguments", "sets"))
_DECIMAL_DIGITS = re.compile("[0-9]{2,}")
_LEADING_ZERO = re.compile("[-+]?0[0-9]+")


def check_number_base(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that numbers printed in hexadecimal are written with 0x, and that no number has leading zeros.

    A JSON file may use decimal numbers, because JSON has no hexadecimal numbers. A single digit is the same in both
    bases.
    """
    is_json = report.document.line(1).startswith("{")
    for path, number in leaves_of(spec.data, report):
        if not isinstance(number, int) or isinstance(number, bool):
            continue
        spelling = report.document.spelling_at(path)
        # The same digits read as hexadecimal, without sign and leading zeros, with at least two digits.
        digits_without_zeros = spelling.lstrip("+-0")
        same_digits_in_hexadecimal = f"0x{digits_without_zeros:0>2}"
        must_be_hexadecimal = not is_json and _is_hexadecimal(path)
        if must_be_hexadecimal and _DECIMAL_DIGITS.fullmatch(spelling):
            decimal_hint = f", or {number:#04x} for decimal {number}" if number > 9 else ""
            message = (
                f"{quoted(path[-1])} is {spelling}, which is decimal, but manuals print it in hexadecimal; "
                f"write {same_digits_in_hexadecimal}{decimal_hint}"
            )
            report.add("number-base", path, message)
        elif _LEADING_ZERO.fullmatch(spelling):
            message = (
                f"{spelling} begins with a zero and is read as decimal {number}; "
                f"write {number}, or {same_digits_in_hexadecimal} if it is hexadecimal"
            )
            report.add("number-base", path, message)


def _is_hexadecimal(path: Path) -> bool:
    """Return True for the place of a number that manuals print in hexadecimal, such as an address.

    Names that the spec defines, which can be the same as such a key, do not count.
    """
    if path[-1] == "value":
        return "writes" in path
    is_name_in_spec = len(path) > 1 and path[-2] in _MAPS_KEYED_BY_SPEC_NAMES
    return path[-1] in HEXADECIMAL and not is_name_in_spec


_XOR_OF_BYTES = re.compile(r"\bXOR of (?:all |the )(?:\w+ )?bytes\b")
#: Width and polynomial of the CRC that is the XOR of all bytes: x^8 + 1.
_WIDTH_OF_XOR, _POLY_OF_XOR = 8, 1
_STATED_BIT = re.compile(r"(?P<name>[A-Z][^.,;:]*) is bit (?P<bit>\d+)\.")
_NUMBER_WORDS = "two three four five six seven eight".split()
_STATED_BYTE_COUNT = re.compile(rf"\bthese (?P<count>{'|'.join(_NUMBER_WORDS)}) bytes\b")
_BITS_IN_TEXT = re.compile(r"(?<!\w)[01]{8,}(?!\w)")


def check_xor_of_bytes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a CRC that a text calls the XOR of the bytes is computed so: with the polynomial x^8 + 1."""
    crc_by_name = by_part_name(spec.crcs)
    for path, text, crc in _texts_about_crcs(spec):
        is_xor = (crc.width, crc.poly) == (_WIDTH_OF_XOR, _POLY_OF_XOR)
        match = _XOR_OF_BYTES.search(text)
        if match is not None and not is_xor and crc.name in crc_by_name:
            message = f"the text says {quoted(match[0])}, but {quoted(crc.name)} has {crc.width} bits and 'poly'"
            report.add("left-behind", path, f"{message} {crc.poly:#x}; correct one of the two", cause=crc.name)


def _texts_about_crcs(spec: WrittenSpec) -> Iterator[tuple[Path, str, Crc]]:
    """Yield the path, the text and the CRC of each note of a CRC, and of each text of an erratum about one CRC."""
    crc_by_name = by_part_name(spec.crcs)
    for located_crc in spec.crcs:
        yield (*located_crc.path, "note"), located_crc.part.note, located_crc.part
    for erratum in spec.errata:
        affected_names: set[str] = set()
        for affected_path in erratum.affects:
            section, *names = affected_path.split(".")  # As in crcs.word.poly.
            if section == "crcs" and names:
                affected_names.add(names[0])
        affected_crcs = [crc_by_name[name].part for name in affected_names if name in crc_by_name]
        if len(affected_crcs) == 1:
            for key in ("used", "why"):
                yield erratum.path_of(key), str(erratum.data.get(key, "")), affected_crcs[0]


def check_bits_of_fields(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the bit in ``used`` of an erratum, such as "Counting direction is bit 6.", is that of the field.

    The key ``used`` is the text about what applies instead of the manual.
    """
    if is_derived(report.document):
        return
    erratum_targets = ErratumTargets(spec.data)
    for erratum in spec.errata:
        statement = _STATED_BIT.fullmatch(erratum.used)
        if statement is None:
            continue
        stated_name = statement.group("name").casefold()
        stated_bit = int(statement.group("bit"))
        for field in _affected_fields(erratum, erratum_targets):
            printed_name = str(field.get("printed_name", ""))
            name_in_words = str(field.get("name", "")).replace("_", " ")
            is_named = stated_name in (printed_name.casefold(), name_in_words.casefold())
            if is_named and field["at"] != stated_bit:
                problem = f"the text says bit {statement['bit']}, but 'at' of the field is {field['at']}"
                report.add("left-behind", erratum.path_of("used"), f"{problem}; correct one of the two")


def _affected_fields(erratum: WrittenErratum, targets: ErratumTargets) -> Iterator[dict[str, object]]:
    """Yield the fields of one bit that an erratum affects."""
    for affected_path in erratum.affects:
        for part in targets.values_at(affected_path):
            if isinstance(part, dict) and isinstance(part.get("at"), int):
                yield part


def check_bytes_in_notes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a field of a layout has the bytes that its note counts, as in "Some models omit these three bytes"."""
    for field_list in layouts_of_interfaces(spec):
        layout = field_list.owner
        bit_counts: set[int | str | None] = set()
        for field in field_list.fields:
            bit_counts |= {field.bits, field.padded_to}
        note = str(layout.data.get("note", ""))
        for match in _STATED_BYTE_COUNT.finditer(note):
            byte_count = _NUMBER_WORDS.index(match.group("count")) + 2  # The first word is "two".
            bit_count = 8 * byte_count
            if bit_count not in bit_counts:
                problem = f"the text says {quoted(match[0])}, but no field of the layout has {bit_count} bits"
                report.add("left-behind", layout.path_of("note"), f"{problem}; correct one of the two")


def check_bits_in_notes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the note of an example has the bits of its bytes, as in "The value is 01100000 in binary"."""
    for example in spec.examples:
        bits_of_bytes = [f"{int(byte_text, 16):08b}" for byte_text in example.bytes.split()]  # 01100000 for 60.
        bits_text = "".join(bits_of_bytes)
        for stated_bits in _BITS_IN_TEXT.findall(example.note):
            if len(stated_bits) == len(bits_text) and stated_bits != bits_text:
                problem = f"the text has {stated_bits}, but the bytes of the example are {bits_text} in binary"
                report.add("left-behind", example.path_of("note"), f"{problem}; correct one of the two")
