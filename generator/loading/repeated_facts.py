"""Compare facts that one spec, or several specs of a manufacturer, state twice."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import count
from pathlib import PurePath

from ..language.document import Document, Path
from ..language.problems import DocumentReport, ProblemReport, quoted
from ..language.rules.code_meanings import MEANING_DIFFERS
from ..language.rules.parts import by_name, by_part_name, has_erratum_at
from ..language.written import LocatedPart
from ..language.written_codes import WrittenRegister
from ..language.written_layouts import WrittenField
from ..language.written_parts import WrittenSpec
from ..model import Biss, Crc, Device, Fault, PlacedField, Register, RegisterExample, Variant, number_to_bytes
from ..reference import codec
from .alike_facts import compare_connectors, compare_facts
from .from_mapping import Raw

#: Shared facts of registers and CRCs with one name, with the format of numbers in messages.
_SHARED_FACT_FORMS = {
    "registers": {"address": "{:#04x}", "length": "{}", "bank": "{}", "access": "{}", "byte_order": "{}"},
    "crcs": {"width": "{}", "poly": "{:#x}", "init": "{:#x}", "refin": "{}", "refout": "{}", "xorout": "{:#x}"},
}
#: Path to a fact in its register or CRC, and the fact as shown in messages: ``("address",), "0x48"``.
_Fact = tuple[Path, str]


def check_shared_facts(documents: Sequence[Document], report: ProblemReport) -> None:
    """Report differences between devices of a manufacturer in facts that its file lists under ``alike``."""
    device_documents = [document for document in documents if "device" in document.data and not report.faults(document)]
    for maker_document in documents:
        if "device" in maker_document.data or report.faults(maker_document):
            continue
        alike_names = maker_document.data.get("alike", {})
        maker = maker_document.data.get("manufacturer")
        documents_of_maker = [device for device in device_documents if device.data.get("manufacturer") == maker]
        for kind in _SHARED_FACT_FORMS:
            # ``name`` is the name of a register or CRC, such as ``{"registers": ["preset"]}``.
            for name in alike_names.get(kind, ()):
                specs_with_part = [device for device in documents_of_maker if name in _parts_by_name(kind, device)]
                _report_different_facts(kind, name, specs_with_part, report)
        compare_facts(alike_names.get("facts", ()), documents_of_maker, report)
        compare_connectors(maker_document, documents_of_maker, report)


def _parts_by_name(section: str, document: Document) -> Mapping[str, WrittenRegister | LocatedPart[Crc]]:
    """Return the registers or CRCs of a spec by name."""
    spec = WrittenSpec(document.data)
    return by_name(spec.registers) if section == "registers" else by_part_name(spec.crcs)


def _report_different_facts(
    section: str, part_name: str, documents_with_fact: Sequence[Document], report: ProblemReport
) -> None:
    """Report each device whose register or CRC differs from the most common one, fact by fact.

    ``section`` is a key of ``_SHARED_FACT_FORMS``. Among equally common facts, the one of the first file applies. A
    difference is not reported if an erratum of either device affects it.
    """
    facts_by_key: dict[tuple[str, ...], list[tuple[Document, _Fact]]] = {}
    for document in sorted(documents_with_fact, key=lambda document: document.file):
        for key, fact in _shared_facts(section, _parts_by_name(section, document)[part_name]):
            facts_by_key.setdefault(key, []).append((document, fact))
    for key, facts in facts_by_key.items():
        affected_place = (section, part_name, *key)
        texts = [text for _, (_, text) in facts]
        ((common_text, _),) = Counter(texts).most_common(1)
        # The first file with the most common text.
        common_document, (common_path, _) = facts[texts.index(common_text)]
        if has_erratum_at(common_document, *affected_place):
            continue
        for document, (path, text) in facts:
            if text == common_text or has_erratum_at(document, *affected_place):
                continue
            line, _ = common_document.position((section, part_name, *common_path))
            message = (
                f"this is {text}, but {common_text} in {PurePath(common_document.file).name}:{line}; according to the"
                f" manufacturer's file, {quoted(part_name)} is the same in all devices. If it is not, add an erratum"
                f" that affects {'.'.join(affected_place)}"
            )
            report.add("not-alike", document, (section, part_name, *path), message)


def _shared_facts(
    section: str, register_or_crc: WrittenRegister | LocatedPart[Crc]
) -> Iterator[tuple[tuple[str, ...], _Fact]]:
    """Yield the shared facts of a register or CRC, each with its place as an erratum gives it.

    The place contains the field's name, such as ``("warning", "at")``, and the path of the fact its index, such as
    ``("fields", 2, "at")``.
    """
    for key, form in _SHARED_FACT_FORMS[section].items():
        if key in register_or_crc.data:
            yield (key,), ((key,), _fact_text(form, register_or_crc.data[key]))
    if not isinstance(register_or_crc, WrittenRegister):
        return  # A CRC has no fields.
    for index, field in enumerate(register_or_crc.fields):
        if field.name:
            yield from _facts_of_field(field, ("fields", index))


def _facts_of_field(field: WrittenField, path: Path) -> Iterator[tuple[tuple[str, ...], _Fact]]:
    """Yield the shared facts of a field, its position, width and named values, as ``_shared_facts`` does."""
    for key, number_or_text in (("at", field.at), ("bits", field.bits)):
        if number_or_text is not None:
            yield (field.name, key), ((*path, key), str(number_or_text))
    for value_name, value in field.values.items():
        yield (field.name, value_name, "value"), ((*path, "values", value_name, "value"), str(value.value))


def _fact_text(number_format: str, fact: object) -> str:
    """Return a value as in messages: ``true`` or ``false``, or in the format ``number_format``."""
    return str(fact).lower() if isinstance(fact, bool) else number_format.format(fact)


#: A number of counts or revolutions in the meaning of a part of an order code, with or without commas.
_COUNT_IN_MEANING = re.compile(
    r"\b([1-9][0-9]{0,2}(?:,[0-9]{3})+|[1-9][0-9]*) (?:counts|steps|positions|revolutions|turns|cpr)\b"
)
#: A meaning that is only a number. It is a count, or a number of revolutions.
_MEANING_THAT_IS_A_NUMBER = re.compile(r"([1-9][0-9]{0,2}(?:,[0-9]{3})+|[1-9][0-9]*)")
_BIT_COUNT_IN_TEXT = re.compile(r"\b([1-9][0-9]?)[ -]bits?\b")
#: The addresses of the manufacturer ID over BiSS, each with the lowest bit of its byte in the ID.
_BISS_ID = {0x7E: 8, 0x7F: 0}
#: Smallest number in a text that is assumed to be a count.
_SMALLEST_COUNT = 256


def check_agreement(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Report contradictions in a spec that only the model shows."""
    for register in device.registers:
        _check_default(device, register, ("registers", register.name), report)
        _check_preset(device, register, ("registers", register.name), report)
    _check_biss_id(device, report)
    _check_meanings(raw_spec, device, report)
    _check_bits_named(raw_spec, device, report)
    _check_selectors(device, report)


def _check_default(device: Device, register: Register, path: Path, report: DocumentReport) -> None:
    """Check that the default of a register agrees with its fields: constants, ``equals`` and their own defaults.

    Report only the first contradiction of the first order code that has a contradiction.
    """
    default = register.default
    has_too_many_bits = default is not None and default >> (8 * register.length) != 0
    if default is None or has_too_many_bits:
        return  # Too many bits are reported with the limits.
    for variant in device.variants_over(register.interface):
        placed = register.layout.place(variant.parameters)
        decoded = codec.decode(device, placed, default)
        # Numbers without a name are reported with the limits. A command may reset itself to such a number.
        contradictions = [problem.message for problem in decoded.problems if problem.fault is Fault.CONSTANT]
        for placed_field in placed.fields:
            value = decoded.values.get(placed_field.name)
            contradictions.append(_describe_contradiction(placed_field, default, value, variant))
        problem = next(filter(None, contradictions), "")
        if problem:
            message = f"the default {default:#x} contradicts a field: {problem}"
            report.add("default-does-not-fit", (*path, "default"), message)
            return


def _check_preset(device: Device, register: Register, path: Path, report: DocumentReport) -> None:
    """Check that a preset cannot be above the highest position, which is one less than the number of positions.

    A preset is a register with that word in its name. Its maximum must not depend on a register.
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
        number_of_positions = counts_expression.value(variant.parameters)
        if measurement.turns is not None:
            number_of_positions *= measurement.turns.value(variant.parameters)
        highest = register.max.value(variant.parameters)
        if highest >= number_of_positions > 1:
            message = (
                f"'{register.name}' can be {highest}, but positions of {variant.code} end at {number_of_positions - 1}"
            )
            report.add("limit-does-not-fit", (*path, "max"), f"{message}; the highest is one less than their number")
            return


def _describe_contradiction(
    placed_field: PlacedField, default: int, documented_value: int | str | None, variant: Variant
) -> str:
    """Return how a field contradicts its number in the default of its register, or an empty string.

    ``default`` is the default of the register, and ``documented_value`` the decoded value of the field, such as the
    name of the number.
    """
    name = placed_field.name
    number = (default >> placed_field.low) & placed_field.mask
    expected = placed_field.field.documented(variant.parameters)
    if expected is not None and expected not in (number, documented_value):
        expected_text = expected if isinstance(expected, str) else hex(expected)
        return f"it sets '{name}' to {number:#x}, but '{name}' must equal {expected_text}"
    own_default = placed_field.field.default
    if own_default is not None and own_default not in (number, documented_value):
        return f"it sets '{name}' to {number:#x}, but the default of '{name}' is {own_default:#x}"
    return ""


def _check_biss_id(device: Device, report: DocumentReport) -> None:
    """Check that 7Eh and 7Fh in BiSS contain the ID from the manufacturer file, which names the idbiss file.

    Only bits that a register documents with ``equals`` are compared.
    """
    biss_id = device.manufacturer.biss_id
    if biss_id is None:
        return
    variants = device.variants_over(Biss.name)
    for register in device.registers_over(Biss.name):
        # The ID is not in a bank.
        if register.bank is not None or not variants:
            continue
        # The ID is the same for all order codes, so the first one is enough.
        number, mask = _documented_bits(register, variants[0])
        bytes_of_register = number_to_bytes(register.layout, number, 8 * register.length)
        masks_of_bytes = number_to_bytes(register.layout, mask, 8 * register.length)
        id_bytes: list[int] = []
        differs = False
        for address, byte, byte_mask in zip(count(register.address), bytes_of_register, masks_of_bytes, strict=False):
            if address in _BISS_ID:
                id_bytes.append(byte)
                # Only documented bits count.
                differs = differs or bool((byte ^ _byte_of_biss_id(biss_id, address)) & byte_mask)
        if differs:
            bytes_text = ", ".join(f"{byte:02X}" for byte in id_bytes)
            message = (
                f"'{register.name}' equals {bytes_text} at 7Eh and 7Fh, but 'biss_id' in the manufacturer file is"
                f" {biss_id:#06x}; one of the two is wrong"
            )
            report.add("biss-id-mismatch", ("registers", register.name), message)
    _check_read_biss_id(device, biss_id, report)


def _documented_bits(register: Register, variant: Variant) -> tuple[int, int]:
    """Return the documented values of a register as one number, and the mask of the bits that they give."""
    number = 0
    mask = 0
    for placed_field in register.layout.place(variant.parameters).fields:
        documented = placed_field.field.documented(variant.parameters)
        is_inside = placed_field.low + placed_field.width <= 8 * register.length
        if documented is not None and is_inside:
            value = codec.number_of_text(documented) if isinstance(documented, str) else documented
            number |= (value & placed_field.mask) << placed_field.low
            mask |= placed_field.mask << placed_field.low
    return number, mask


def _check_read_biss_id(device: Device, identity: int, report: DocumentReport) -> None:
    """Check that examples of 7Eh and 7Fh contain the ID.

    Skip brands of another manufacturer, which keep the examples.
    """
    if device.base:
        return
    for example in device.examples:
        if not isinstance(example, RegisterExample) or example.erratum:
            continue
        # Other rules report a register that is missing or wrong.
        register = next((candidate for candidate in device.registers if candidate.name == example.register), None)
        if register is None or register.interface != Biss.name or register.bank is not None:
            continue
        addressed_bytes = enumerate(example.bytes, register.address)
        id_bytes = {address: byte for address, byte in addressed_bytes if address in _BISS_ID}
        expected_bytes = {address: _byte_of_biss_id(identity, address) for address in id_bytes}
        if id_bytes != expected_bytes:
            bytes_text = ", ".join(f"{byte:02X}" for byte in id_bytes.values())
            message = (
                f"'{example.name}' has {bytes_text} at 7Eh and 7Fh, but 'biss_id' in the manufacturer file is"
                f" {identity:#06x}; one of the two is wrong"
            )
            report.add("biss-id-mismatch", ("examples", example.name), message)


def _byte_of_biss_id(biss_id: int, address: int) -> int:
    """Return the byte of the manufacturer ID at one of its addresses: of 0x4C41, 0x4C at 7Eh and 0x41 at 7Fh."""
    return (biss_id >> _BISS_ID[address]) & 0xFF


def _check_meanings(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Check that counts and revolutions in the meaning of a value match a quantity of its order codes.

    Report a value if none of the counts in its meaning is a quantity of any of its order codes. Numbers below 256 are
    ignored, and so are values without ``sets``.
    """
    interfaces = {interface.name for interface in device.interfaces}
    variants = [variant for variant in device.variants if variant.interface in interfaces]
    for index, part in enumerate(raw_spec["order_code"]["parts"]):
        for text_of_value, value in part["values"].items():
            # A value without keys is None.
            meaning = _compared_meaning(value or {})
            count_texts = (
                [meaning] if _MEANING_THAT_IS_A_NUMBER.fullmatch(meaning) else _COUNT_IN_MEANING.findall(meaning)
            )
            numbers = [int(count_text.replace(",", "")) for count_text in count_texts]
            named_counts = {number for number in numbers if number >= _SMALLEST_COUNT}
            if not named_counts or not (value or {}).get("sets"):
                continue
            variants_of_value = [variant for variant in variants if variant.parts.get(part["name"]) == text_of_value]
            numbers_of_codes: set[int] = set()
            for variant in variants_of_value:
                numbers_of_codes |= _numbers_of_code(device, variant)
            if variants_of_value and named_counts.isdisjoint(numbers_of_codes):
                settings = ", ".join(f"{name} = {number}" for name, number in value["sets"].items())
                first_count = next(number for number in numbers if number >= _SMALLEST_COUNT)
                message = (
                    f"the meaning of '{text_of_value}' contains {first_count:,}, but with {settings}, its order codes"
                    f" do not have this number{MEANING_DIFFERS}"
                )
                report.add(
                    "meaning-mismatch", ("order_code", "parts", index, "values", text_of_value, "meaning"), message
                )


def _compared_meaning(raw_value: Raw) -> str:
    """Return the meaning of a value, or an empty string if the spec explains why it differs from the settings."""
    return "" if "meaning_differs" in raw_value else raw_value.get("meaning", "")


def _check_bits_named(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Check that a number of bits in the meaning of a value is a number that the value sets, or a resulting width.

    It may also be the sum of the bits that the value sets, or the width of the frame or position of one of its order
    codes: manufacturers also call a format by the bits of its whole frame. Meanings with several numbers of bits are
    not checked.
    """
    units = {parameter.name: parameter.unit for parameter in device.parameters}
    built_interfaces = {interface.name for interface in device.interfaces}
    for index, part in enumerate(raw_spec["order_code"]["parts"]):
        for text_of_value, value in part["values"].items():
            numbers_in_meaning = [int(number) for number in _BIT_COUNT_IN_TEXT.findall(_compared_meaning(value or {}))]
            set_values = (value or {}).get("sets", {})
            bits_by_parameter = {name: set_values[name] for name in set_values if units.get(name) in ("bit", "bits")}
            if len(numbers_in_meaning) != 1 or not bits_by_parameter:
                continue
            (named_bits,) = numbers_in_meaning
            if named_bits in (*bits_by_parameter.values(), sum(bits_by_parameter.values())):
                continue
            variants = [variant for variant in device.variants if variant.parts.get(part["name"]) == text_of_value]
            # An interface with errors has no frames here, so that any number could be right.
            if not built_interfaces.issuperset(variant.interface for variant in variants):
                continue
            if any(named_bits in _frame_and_position_widths(device, variant) for variant in variants):
                continue
            name = next(iter(bits_by_parameter))
            message = (
                f"the meaning of '{text_of_value}' says {named_bits} bits, but '{name}' is"
                f" {bits_by_parameter[name]}{MEANING_DIFFERS}"
            )
            report.add(
                "meaning-mismatch", ("order_code", "parts", index, "values", text_of_value, "sets", name), message
            )


def _frame_and_position_widths(device: Device, variant: Variant) -> set[int]:
    """Return the widths of the frames that an encoder with this order code sends, and of the positions in them.

    A frame of 32 bits with 24 bits of position gives ``{32, 24}``.
    Frames without the position do not count. Without a measurement, there are no widths.
    """
    measurement = device.measurement_of(variant.interface)
    widths: set[int] = set()
    if measurement is None:
        return widths
    for interface, layout in device.layouts():
        if interface.name != variant.interface:
            continue
        placed = layout.place(variant.parameters)
        # The position is one field, or a join of several ones. There are none if this frame lacks it.
        position_names = layout.names_in(measurement.of)
        position_fields = placed.find_fields(position_names)
        if layout.sender == "encoder" and position_fields:
            widths |= {placed.bits, sum(field.width for field in position_fields)}
    return widths


def _numbers_of_code(device: Device, variant: Variant) -> set[int]:
    """Return the numbers of an order code: its parameters, their powers of two, and the numbers of its measurement."""
    numbers = set(variant.parameters.values())
    # A parameter up to 64 can be a number of bits.
    numbers |= {1 << number for number in variant.parameters.values() if 0 <= number <= 64}
    measurement = device.measurement_of(variant.interface)
    if measurement is None:
        return numbers
    for expression in (measurement.counts_per_turn, measurement.turns, measurement.modulus):
        if expression is not None:
            numbers.add(expression.value(variant.parameters))
    return numbers


def _check_selectors(device: Device, report: DocumentReport) -> None:
    """Check that frames of one sender are distinguished by the same bits, in the same place for every order code.

    Each layout with ``when`` is compared with the first one of its sender.
    """
    for interface in device.interfaces:
        first_by_sender: dict[str, tuple[str, object]] = {}
        for layout in interface.layouts:
            if not layout.selector:
                continue
            path: Path = ("interfaces", interface.name, "layouts", layout.name, "when")
            field = next((candidate for candidate in layout.fields if candidate.name == layout.selector), None)
            if field is None:
                continue  # Reported by the rule on references.
            # A field has pieces in bytes only at a fixed place.
            if not field.bit_slices:
                report.add(
                    "selector-place",
                    path,
                    f"the position of '{layout.selector}' depends on the order code; bits that identify a frame must"
                    " have a fixed position",
                )
                continue
            first_name, first_pieces = first_by_sender.setdefault(layout.sender, (layout.name, field.bit_slices))
            if first_pieces != field.bit_slices:
                message = (
                    f"'{layout.selector}' is not at the same position as in '{first_name}'; the same bits must"
                    " distinguish all frames of a sender"
                )
                report.add("selector-place", path, message)
