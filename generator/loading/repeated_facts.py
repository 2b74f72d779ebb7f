"""Compare facts that a spec states more than once, also the numbers of bits in its texts."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import chain, count

from ..language.document import Path
from ..language.problems import DocumentReport, join_words, quoted
from ..language.rules.code_meanings import MEANING_DIFFERS
from ..model import Biss, Device, Fault, PlacedField, Register, RegisterExample, Variant, number_to_bytes
from ..reference import codec
from .spec_parts import Raw
from .whole_frame_checks import check_selector_places

#: A number of counts or revolutions in the meaning of a part of an order code: ``65,536 counts``, or ``4096 turns``.
_COUNT_IN_MEANING = re.compile(
    r"\b([1-9][0-9]{0,2}(?:,[0-9]{3})+|[1-9][0-9]*) (?:counts|steps|positions|revolutions|turns|cpr)\b"
)
#: A meaning that is only a number. It is a count, or a number of revolutions.
_MEANING_THAT_IS_A_NUMBER = re.compile(r"([1-9][0-9]{0,2}(?:,[0-9]{3})+|[1-9][0-9]*)")
#: A number of bits in a text: ``17 bits``, or ``24-bit``.
_BIT_COUNT_IN_TEXT = re.compile(r"\b([1-9][0-9]?)[ -]bits?\b")
#: The addresses of the manufacturer ID over BiSS, each with the lowest bit of its byte in the ID.
_BISS_ID = {0x7E: 8, 0x7F: 0}
#: Smallest number in a text that is assumed to be a count.
_SMALLEST_COUNT = 256


def check_agreement(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Report facts of a spec that contradict each other, if the model is needed to compare them."""
    for register in device.registers:
        _check_default(device, register, ("registers", register.name), report)
        _check_preset(device, register, ("registers", register.name), report)
    _check_biss_id(device, report)
    _check_meanings(raw_spec, device, report)
    _check_bits_named(raw_spec, device, report)
    check_selector_places(device, report)


def _check_default(device: Device, register: Register, path: Path, report: DocumentReport) -> None:
    """Check that the default of a register agrees with its constants, and with documented values and field defaults.

    Only the first contradiction of the first order code that has one is reported.
    """
    default_number = register.default
    has_too_many_bits = default_number is not None and default_number >> (8 * register.length) != 0
    if default_number is None or has_too_many_bits:
        return  # The check of the limits reports too many bits.
    for variant in device.variants_over(register.interface):
        placed_layout = register.layout.place(variant.parameters)
        decoded = codec.decode(device, placed_layout, default_number)
        # Only constants are checked here. The check of the limits reports numbers without a name.
        contradictions = [
            first_contradiction.message
            for first_contradiction in decoded.problems
            if first_contradiction.fault is Fault.CONSTANT
        ]
        for placed_field in placed_layout.fields:
            decoded_value = decoded.values.get(placed_field.name)
            contradictions.append(_describe_contradiction(placed_field, default_number, decoded_value, variant))
        first_contradiction = next(filter(None, contradictions), "")
        if first_contradiction:
            message = f"the default {default_number:#x} contradicts a field: {first_contradiction}"
            report.add("default-does-not-fit", (*path, "default"), message)
            return


def _check_preset(device: Device, register: Register, path: Path, report: DocumentReport) -> None:
    """Check that the maximum of a preset is not above the highest position, the number of positions minus one.

    A preset is a register with that word in its name. A maximum that depends on another register is not checked.
    """
    if "preset" not in register.name.split("_") or register.max is None or register.meanings:
        return
    names_from_registers = {parameter.name for parameter in device.run_time_parameters}
    depends_on_register = not names_from_registers.isdisjoint(register.max.parameters)
    if depends_on_register:
        return
    for variant in device.variants_over(register.interface):
        measurement = device.measurement_of(variant.interface)
        if measurement is None:
            continue
        counts_expression = measurement.counts_per_turn or measurement.modulus
        if counts_expression is None:
            continue
        position_count = counts_expression.value(variant.parameters)
        if measurement.turns is not None:
            position_count *= measurement.turns.value(variant.parameters)
        highest_preset = register.max.value(variant.parameters)
        if highest_preset >= position_count > 1:
            problem = f"'{register.name}' can be {highest_preset}"
            message = f"{problem}, but positions of {variant.code} end at {position_count - 1}"
            report.add("limit-does-not-fit", (*path, "max"), f"{message}; the highest is one less than their number")
            return


def _describe_contradiction(
    placed_field: PlacedField, default: int, decoded_value: int | str | None, variant: Variant
) -> str:
    """Return how the default of a register contradicts one of its fields, or "" if it does not.

    ``default`` is the default of the register, and ``decoded_value`` is the decoded value of the field in it, such
    as the name of a number.
    """
    field_name = placed_field.name
    number_in_default = (default >> placed_field.lowest_bit) & placed_field.mask
    documented = placed_field.field.documented(variant.parameters)
    default_text = f"it sets '{field_name}' to {number_in_default:#x}"
    if documented is not None and documented not in (number_in_default, decoded_value):
        documented_text = documented if isinstance(documented, str) else hex(documented)
        return f"{default_text}, but '{field_name}' must equal {documented_text}"
    default_of_field = placed_field.field.default
    if default_of_field is not None and default_of_field not in (number_in_default, decoded_value):
        return f"{default_text}, but the default of '{field_name}' is {default_of_field:#x}"
    return ""


def _check_biss_id(device: Device, report: DocumentReport) -> None:
    """Check that the BiSS registers 7Eh and 7Fh contain the ID from the manufacturer's file.

    The ID is in the name of the idbiss file. Only bits with a documented value (``equals``) are compared.
    """
    biss_id = device.manufacturer.biss_id
    if biss_id is None:
        return
    variants = device.variants_over(Biss.name)
    for register in device.registers_over(Biss.name):
        # Registers in a bank cannot contain the ID.
        if register.bank is not None or not variants:
            continue
        # All order codes have the same ID.
        documented_number, documented_mask = _documented_bits(register, variants[0])
        documented_bytes = number_to_bytes(register.layout, documented_number, 8 * register.length)
        documented_masks = number_to_bytes(register.layout, documented_mask, 8 * register.length)
        id_bytes: list[int] = []
        differs_from_id = False
        for address, byte, mask_of_byte in zip(
            count(register.address), documented_bytes, documented_masks, strict=False
        ):
            if address in _BISS_ID:
                id_bytes.append(byte)
                different_bits = byte ^ _byte_of_biss_id(biss_id, address)
                if different_bits & mask_of_byte:
                    differs_from_id = True
        if differs_from_id:
            bytes_text = ", ".join(f"{byte:02X}" for byte in id_bytes)
            message = (
                f"'{register.name}' equals {bytes_text} at 7Eh and 7Fh, but 'biss_id' in the manufacturer file is"
                f" {biss_id:#06x}; one of the two is wrong"
            )
            report.add("biss-id-mismatch", ("registers", register.name), message)
    _check_read_biss_id(device, biss_id, report)


def _documented_bits(register: Register, variant: Variant) -> tuple[int, int]:
    """Return the documented values of all fields of a register as one number, and a mask of the documented bits."""
    documented_number = 0
    documented_mask = 0
    for placed_field in register.layout.place(variant.parameters).fields:
        documented_value = placed_field.field.documented(variant.parameters)
        fits_in_register = placed_field.lowest_bit + placed_field.width <= 8 * register.length
        if documented_value is not None and fits_in_register:
            if isinstance(documented_value, str):
                documented_value = codec.number_of_text(documented_value)
            documented_number |= (documented_value & placed_field.mask) << placed_field.lowest_bit
            documented_mask |= placed_field.mask << placed_field.lowest_bit
    return documented_number, documented_mask


def _check_read_biss_id(device: Device, biss_id: int, report: DocumentReport) -> None:
    """Check that examples of reading the BiSS registers 7Eh and 7Fh contain the manufacturer's ID.

    Derived devices are not checked, because a brand of a different manufacturer keeps the examples.
    """
    if device.base:
        return
    for example in device.examples:
        if not isinstance(example, RegisterExample) or example.erratum:
            continue
        # Other rules report a register that does not exist or is not valid.
        register = next(
            (device_register for device_register in device.registers if device_register.name == example.register), None
        )
        if register is None or register.interface != Biss.name or register.bank is not None:
            continue
        addressed_bytes = enumerate(example.bytes, register.address)
        id_bytes = {address: byte for address, byte in addressed_bytes if address in _BISS_ID}
        expected_bytes = {address: _byte_of_biss_id(biss_id, address) for address in id_bytes}
        if id_bytes != expected_bytes:
            bytes_text = ", ".join(f"{byte:02X}" for byte in id_bytes.values())
            message = (
                f"'{example.name}' has {bytes_text} at 7Eh and 7Fh, but 'biss_id' in the manufacturer file is"
                f" {biss_id:#06x}; one of the two is wrong"
            )
            report.add("biss-id-mismatch", ("examples", example.name), message)


def _byte_of_biss_id(biss_id: int, address: int) -> int:
    """Return the byte of the manufacturer's BiSS ID at an address: for 0x4C41, 0x4C at 7Eh and 0x41 at 7Fh."""
    return (biss_id >> _BISS_ID[address]) & 0xFF


def _check_meanings(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Check that the counts in the meaning of an order code value match the numbers of its order codes.

    A value is reported if its meaning names counts or revolutions, but none of them is a number of its order codes.
    Numbers below 256 and values that set no parameter are not checked.
    """
    built_interfaces = {interface.name for interface in device.interfaces}
    variants = [variant for variant in device.variants if variant.interface in built_interfaces]
    for part_index, raw_part in enumerate(raw_spec["order_code"]["parts"]):
        for text_of_value, raw_value_or_none in raw_part["values"].items():
            # In the spec, a value without properties is empty.
            raw_value = raw_value_or_none or {}
            named_counts = _counts_in_meaning(_compared_meaning(raw_value))
            if not named_counts or not raw_value.get("sets"):
                continue
            variants_of_value = [
                variant for variant in variants if variant.parts.get(raw_part["name"]) == text_of_value
            ]
            numbers_of_order_codes: set[int] = set()
            for variant in variants_of_value:
                numbers_of_order_codes |= _numbers_of_code(device, variant)
            if variants_of_value and numbers_of_order_codes.isdisjoint(named_counts):
                settings_text = ", ".join(f"{name} = {number}" for name, number in raw_value["sets"].items())
                message = (
                    f"the meaning of '{text_of_value}' contains {named_counts[0]:,}, but with {settings_text}, its"
                    f" order codes do not have this number{MEANING_DIFFERS}"
                )
                report.add(
                    "meaning-mismatch", ("order_code", "parts", part_index, "values", text_of_value, "meaning"), message
                )


def _counts_in_meaning(meaning: str) -> list[int]:
    """Return the numbers of counts or revolutions in a text. A text that is only a number is one too.

    Numbers below 256 are left out.
    """
    if _MEANING_THAT_IS_A_NUMBER.fullmatch(meaning):
        count_texts = [meaning]
    else:
        count_texts = _COUNT_IN_MEANING.findall(meaning)
    counts = [int(count_text.replace(",", "")) for count_text in count_texts]
    return [count for count in counts if count >= _SMALLEST_COUNT]


def _compared_meaning(raw_value: Raw) -> str:
    """Return the meaning of an order code value, or "" if the spec explains why it differs from the settings."""
    return "" if "meaning_differs" in raw_value else raw_value.get("meaning", "")


def _check_bits_named(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Check that the number of bits in the meaning of an order code value matches the parameters that it sets.

    The number can be one of these parameters, the sum of them, or the width of the frame or of the position. Meanings
    with several numbers of bits are not checked.
    """
    unit_by_parameter = {parameter.name: parameter.unit for parameter in device.parameters}
    built_interfaces = {interface.name for interface in device.interfaces}
    for part_index, raw_part in enumerate(raw_spec["order_code"]["parts"]):
        for text_of_value, raw_value_or_none in raw_part["values"].items():
            # In the spec, a value without properties is empty.
            raw_value = raw_value_or_none or {}
            bit_counts_in_meaning = _BIT_COUNT_IN_TEXT.findall(_compared_meaning(raw_value))
            bit_count_by_parameter: dict[str, int] = {}
            for parameter_name, number in raw_value.get("sets", {}).items():
                if unit_by_parameter.get(parameter_name) in ("bit", "bits"):
                    bit_count_by_parameter[parameter_name] = number
            if len(bit_counts_in_meaning) != 1 or not bit_count_by_parameter:
                continue
            named_bit_count = int(bit_counts_in_meaning[0])
            if named_bit_count in (*bit_count_by_parameter.values(), sum(bit_count_by_parameter.values())):
                continue
            variants = [variant for variant in device.variants if variant.parts.get(raw_part["name"]) == text_of_value]
            # An interface with errors was not built, so its frames cannot be compared.
            if not built_interfaces.issuperset(variant.interface for variant in variants):
                continue
            if any(named_bit_count in _frame_and_position_widths(device, variant) for variant in variants):
                continue
            first_parameter = next(iter(bit_count_by_parameter))
            message = (
                f"the meaning of '{text_of_value}' says {named_bit_count} bits, but '{first_parameter}' is"
                f" {bit_count_by_parameter[first_parameter]}{MEANING_DIFFERS}"
            )
            report.add(
                "meaning-mismatch",
                ("order_code", "parts", part_index, "values", text_of_value, "sets", first_parameter),
                message,
            )


def _frame_and_position_widths(device: Device, variant: Variant) -> set[int]:
    """Return the widths of the frames that an encoder with this order code sends, and of the positions in them.

    For a 32-bit frame with a 24-bit position, this is ``{32, 24}``. Frames without a position are left out.
    """
    measurement = device.measurement_of(variant.interface)
    bit_counts: set[int] = set()
    if measurement is None:
        return bit_counts
    for interface, layout in device.layouts():
        if interface.name != variant.interface:
            continue
        placed_layout = layout.place(variant.parameters)
        # The position consists of one or several fields, or of none if the frame does not contain it.
        position_field_names = layout.field_names_of(measurement.position_name)
        position_fields = placed_layout.find_fields(position_field_names)
        if layout.sender == "encoder" and position_fields:
            bit_counts |= {placed_layout.bits, sum(field.width for field in position_fields)}
    return bit_counts


def _numbers_of_code(device: Device, variant: Variant) -> set[int]:
    """Return the numbers of an order code: its parameters, powers of two with them, and its counts and turns."""
    numbers = set(variant.parameters.values())
    # A parameter up to 64 can be a number of bits, so 2 to its power can be a number of counts.
    numbers |= {1 << number for number in variant.parameters.values() if 0 <= number <= 64}
    measurement = device.measurement_of(variant.interface)
    if measurement is None:
        return numbers
    for expression in (measurement.counts_per_turn, measurement.turns, measurement.modulus):
        if expression is not None:
            numbers.add(expression.value(variant.parameters))
    return numbers


#: Several numbers in a list: ``21, 23 or 26``.
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
_BITS_OF_PARAMETER = re.compile(r", (?P<numbers>\d+(?:, \d+)* or \d+) bits$")
_NUMBER = re.compile(r"\d+")


def check_stated_lengths(device: Device, report: DocumentReport) -> None:
    """Report a note on a layout, or an erratum about it, that states a length that its frames do not have.

    A list of lengths, such as ``21, 23 or 26``, must contain the lengths for all order codes. An erratum that counts
    the lengths is checked too.
    """
    if report.document.family or report.document.other_files:  # Editions and overlays keep texts of the family.
        return
    _check_counted_lengths(device, report)
    for interface in device.interfaces:
        for layout in interface.layouts:
            variants = device.variants_over(interface.name)
            frame_lengths = sorted({layout.place(variant.parameters).bits for variant in variants})
            if not frame_lengths:
                continue
            note_path = ("interfaces", interface.name, "layouts", layout.name, "note")
            _check_text(note_path, layout.note, frame_lengths, report)
            # In errata, paths do not contain the key ``layouts``.
            path_in_errata = f"interfaces.{interface.name}.{layout.name}"
            for erratum in device.errata:
                if path_in_errata in erratum.affects:
                    _check_text(("errata", erratum.name, "used"), erratum.used, frame_lengths, report)


_NUMBER_WORDS = "two three four five six seven eight nine ten".split()
_COUNT_OF_LENGTHS = re.compile(rf"\bhave (?P<count>{'|'.join(_NUMBER_WORDS)}) different data lengths\b")


def check_stated_bits(device: Device, report: DocumentReport) -> None:
    """Report a parameter whose meaning ends with numbers of bits that differ from its values for the order codes."""
    if report.document.family or report.document.other_files:  # Editions and overlays keep texts of the family.
        return
    for parameter in device.parameters:
        statement_match = _BITS_OF_PARAMETER.search(parameter.meaning)
        parameter_sets = [variant.parameters for variant in device.variants if parameter.name in variant.parameters]
        actual_numbers = {parameters[parameter.name] for parameters in parameter_sets}
        if statement_match is None or not actual_numbers or parameter.read_from:
            continue
        if {*_numbers_in(statement_match)} != actual_numbers:
            numbers_text = join_words(map(str, sorted(actual_numbers)), "or")
            stated_text = statement_match[0].removeprefix(", ")
            message = f"the text says {quoted(stated_text)}, but the order codes have {numbers_text}"
            message += "; correct one of the two"
            report.add("left-behind", ("parameters", parameter.name, "meaning"), message)


def _check_counted_lengths(device: Device, report: DocumentReport) -> None:
    """Report an erratum that counts the data lengths of the order codes over BiSS wrongly.

    The data are the frame without its flags and check, so the lengths of data differ as the lengths of frames do.
    """
    variants = device.variants_over(Biss.name)
    # The number of different lengths that each BiSS layout has.
    counts_of_lengths: set[int] = set()
    for interface, layout in device.layouts():
        if interface.name == Biss.name:
            frame_lengths = {layout.place(variant.parameters).bits for variant in variants}
            counts_of_lengths.add(len(frame_lengths))
    if not counts_of_lengths:
        return
    for erratum in device.errata:
        statement_match = _COUNT_OF_LENGTHS.search(erratum.why)
        if statement_match is None:
            continue
        stated_count = 2 + _NUMBER_WORDS.index(statement_match["count"])  # The first word is "two".
        if stated_count not in counts_of_lengths:
            counts_text = join_words(map(str, sorted(counts_of_lengths)), "or")
            problem = f"the text says {quoted(statement_match[0])}, but the order codes have {counts_text}"
            report.add("left-behind", ("errata", erratum.name, "why"), f"{problem}; correct one of the two")


def _check_text(path: tuple[str, ...], text: str, frame_lengths: Sequence[int], report: DocumentReport) -> None:
    """Report the first statement in a text about the length of a frame that does not agree with its actual lengths."""
    shortest, longest = frame_lengths[0], frame_lengths[-1]
    for statement_match in chain(_LENGTH_IN_TEXT.finditer(text), _LENGTH_RANGE_IN_TEXT.finditer(text)):
        # The text can be about a part of the frame: ``The frame has 2 bits, error and warning, after the position``.
        stated_numbers = _numbers_in(statement_match)
        is_shorter_number = len(stated_numbers) == 1 and max(stated_numbers) < shortest
        is_about_part = is_shorter_number and text[statement_match.end() :].startswith(",")
        if is_about_part:
            continue
        if statement_match.re is _LENGTH_RANGE_IN_TEXT:
            agrees_with_frames = stated_numbers == (shortest, longest)
        else:
            agrees_with_frames = _agrees_with_lengths(statement_match, frame_lengths)
        if not agrees_with_frames:
            lengths_text = join_words(map(str, frame_lengths), "or")
            problem = f"the text says {quoted(statement_match[0])}, but the frame has {lengths_text} bits"
            report.add("left-behind", path, f"{problem}; correct one of the two")
            return


def _numbers_in(statement_match: re.Match[str]) -> tuple[int, ...]:
    """Return all numbers in the groups of a match: (21, 23, 26) for ``The word has 21, 23 or 26 bits``."""
    numbers: list[int] = []
    for group_text in statement_match.groups():
        if group_text:
            numbers += map(int, _NUMBER.findall(group_text))
    return tuple(numbers)


def _agrees_with_lengths(statement: re.Match[str], lengths: Sequence[int]) -> bool:
    """Return whether the lengths in a text are lengths of the frame. A list must contain all of them."""
    stated_lengths, actual_lengths = set(_numbers_in(statement)), set(lengths)
    is_list = len(_NUMBER.findall(statement["numbers"])) > 1
    return stated_lengths == actual_lengths if is_list else stated_lengths <= actual_lengths
