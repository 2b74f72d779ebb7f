"""Rules for what a spec has twice: names and numbers that must be unique, items of a list, and texts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from operator import attrgetter
from typing import NamedTuple

from ..document import Path
from ..files import family_of
from ..keys_of_fields import WrittenField, WrittenRegister
from ..keys_of_order_codes import WrittenRs485
from ..keys_of_specs import WrittenSpec
from ..problems import MISSING_PROSE, DocumentReport, quoted
from .parts import (
    PlacedPart,
    by_name,
    field_lists,
    interface_name_of,
    interfaces,
    last_address,
    layouts_of_interfaces,
    with_groups_expanded,
)

#: Lists that are sets, at any place.
_LISTS_THAT_ARE_SETS = frozenset(
    """
    interfaces sums_up explained_by write_clears cleared_by by_hand data_id memory_access printed also_written
    cable_lengths
    """.split()
)
#: Maps of lists that are sets.
_MAPS_OF_SETS = frozenset(("only_with", "open_only_with"))


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
            _check_texts_of_values(field, report)


def _check_texts_of_values(field: WrittenField, report: DocumentReport) -> None:
    """Check that no two named values of a field have the same printed name, or the same meaning of several words."""
    printed_names = []
    long_meanings = []
    for name, value in field.values.items():
        printed_name = _NamedText(value.printed_name, name, value.path_of("printed_name"))
        meaning = _NamedText(value.meaning, name, value.path_of("meaning"))
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
        path=register_or_field.path_of("printed_name"),
    )


def _has_data(field: WrittenField) -> bool:
    """Return True for a field with data. Fixed bits and check bits have none, and can repeat a name in a frame."""
    is_fixed = field.constant is not None or field.unused is not None
    is_check = bool(field.crc or field.parity_of)
    return not is_fixed and not is_check


def _report_repeated(text_key: str, texts: Iterable[_NamedText], report: DocumentReport) -> None:
    """Report every text under ``text_key`` that an earlier part with another name also has, except empty texts."""
    first_name_by_text: dict[str, str] = {}
    for text, name, path in texts:
        if not text:
            continue
        first_name = first_name_by_text.setdefault(text, name)
        if first_name != name:
            message = f"{quoted(first_name)} already has this text as its {quoted(text_key)}; one of the two is wrong"
            report.add("repeated-text", path, message)


#: Keys of a data ID that must be unique, each with its description in a message.
_UNIQUE_KEYS_OF_DATA_IDS = (
    ("name", "a data ID"),
    ("id", "a data ID with the number"),
    ("control", "a data ID with the control field"),
)

#: Family names reserved by an output, with the reason.
RESERVED_FAMILY_NAMES = {
    "encoder": "the C header that all families share",
    "biss": "the BiSS part of the Python package",
    **dict.fromkeys(
        ("decode_file", "decode_partition", "identify", "lookup", "run", "why"), "a function of the Python package"
    ),
    "nearest": "a function of the Python package",
    "annotations": "a Python attribute",
    # Windows reserves these file names, whatever their suffix.
    **dict.fromkeys(
        ("con", "prn", "aux", "nul", *(f"{port}{number}" for port in ("com", "lpt") for number in range(1, 10))),
        "a Windows device",
    ),
}

#: A value that must be unique, such as a name, with its path.
LocatedValue = tuple[Path, object]


def check_device_name(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a family and its file have the same name, and that no output reserves it."""
    family_of_file = report.document.family or family_of(report.document.file)
    device_name = spec.device
    if device_name and device_name != family_of_file:
        message = f"the device is called {quoted(device_name)}, but the file is called {quoted(family_of_file)}"
        report.add("device-name", ("device",), f"{message}; use the same name for both")
    if device_name in RESERVED_FAMILY_NAMES:
        report.add(
            "device-name",
            ("device",),
            f"{quoted(device_name)} is the name of {RESERVED_FAMILY_NAMES[device_name]}; rename the family",
        )


def check_duplicate_name(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that parts of one kind, such as registers or the arguments of a procedure, have different names."""
    for noun, parts in _named_parts(spec).items():
        _check_unique_key(parts, key="name", noun=noun, report=report)
    _check_unique(_names_for_all_order_codes(spec.timings), "a timing", report)
    _check_unique(_names_for_all_order_codes(spec.characteristics), "a characteristic", report)
    for _, interface in interfaces(spec):
        _check_unique(_names_for_all_order_codes(interface.timings), "a timing", report)
        data_ids = interface.data_ids if isinstance(interface, WrittenRs485) else ()
        for key, noun in _UNIQUE_KEYS_OF_DATA_IDS:
            _check_unique_key(data_ids, key=key, noun=noun, report=report)
    _check_unique_key(spec.manual.editions, key="language", noun="a language", report=report)
    _check_unique_key(spec.manual.history, key="revision", noun="a revision", report=report)
    for register in spec.registers:
        _check_unique_key(register.meanings, key="name", noun="a meaning", report=report)
    for procedure in spec.procedures:
        _check_unique_key(procedure.arguments, key="name", noun="an argument", report=report)
    for connector in spec.connectors:
        contact_names = [contact.contact for contact in connector.part.contacts]
        _check_unique(_located_in_list(contact_names, (*connector.path, "contacts"), "contact"), "a contact", report)
    for led in spec.leds:
        state_names = [led_state.state for led_state in led.part.states]
        _check_unique(_located_in_list(state_names, (*led.path, "states"), "state"), "a state", report)


def _located_in_list(names: Iterable[str], list_path: Path, key: str) -> Iterator[LocatedValue]:
    """Yield each name with its path. The names are under ``key`` in the elements of the list at ``list_path``."""
    for index, name in enumerate(names):
        yield (*list_path, index, key), name


def _named_parts(spec: WrittenSpec) -> dict[str, Sequence[PlacedPart]]:
    """Return the lists of parts whose names must be unique, each under the noun for such a part."""
    return {
        "a CRC": spec.crcs,
        "a field group": spec.field_groups,
        "a register": spec.registers,
        "an alarm": spec.alarms,
        "a procedure": spec.procedures,
        "an input": spec.inputs,
        "a table": spec.tables,
        "a connector": spec.connectors,
        "an LED": spec.leds,
        "an example": spec.examples,
        "an erratum": spec.errata,
        "a layout": [frame.owner for frame in layouts_of_interfaces(spec)],
        "a part": spec.order_code.parts,
    }


def check_duplicate_title(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no two errata have the same title, because readers see only the title."""
    first_path_by_title: dict[str, Path] = {}
    for erratum in spec.errata:
        if erratum.title == MISSING_PROSE:
            continue
        first_path = first_path_by_title.setdefault(erratum.title, erratum.path)
        if first_path != erratum.path:
            line, _ = report.document.position((*first_path, "title"))
            message = f"the erratum on line {line} has the same title; say what differs in this one"
            report.add("duplicate-name", erratum.path_of("title"), message)


def check_duplicate_field(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the fields, joined numbers and groups of digits of a layout or register have different names.

    A decoder returns all of them by name.
    """
    group_by_name = by_name(spec.field_groups)
    for field_list in field_lists(spec):
        located_names: list[LocatedValue] = []
        paths_of_included_groups = {field.path for field in field_list.fields if field.use}
        for path, field in with_groups_expanded(field_list, group_by_name):
            # A name in a group is reported at its use, because that is what makes it occur twice.
            name_path = path if path in paths_of_included_groups else (*path, "name")
            located_names.append((name_path, field.name or None))  # _check_unique ignores None.
            for index, digit_group in enumerate(field.digits):
                located_names.append(((*path, "digits", index, "name"), digit_group.part.name))
        for joined_number in field_list.joins:
            located_names.append(((*field_list.owner.path, "join", joined_number), joined_number))
        _check_unique(located_names, "a field", report)


def check_duplicate_selection(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no value of the field that identifies frames belongs to two frames of one sender over an interface."""
    first_frame_by_selection: dict[tuple[str, str, int], str] = {}  # By the interface, the sender and the value.
    for frame in layouts_of_interfaces(spec):
        sender = frame.layout.from_ if frame.layout is not None else ""
        for selector, selecting_values in frame.selectors.items():
            for index, selecting_value in enumerate(selecting_values):
                first_frame = first_frame_by_selection.setdefault(
                    (frame.interface, sender, selecting_value), frame.name
                )
                if first_frame != frame.name:
                    earlier_use = f"used by {quoted(first_frame)}"
                elif selecting_value in selecting_values[:index]:
                    earlier_use = "listed"
                else:
                    continue
                message = (
                    f"{quoted(selector)} {selecting_value} is already {earlier_use}; "
                    f"use each value for only one frame of the {sender}"
                )
                report.add("duplicate-name", (*frame.owner.path, "when", selector, index), message)


#: Number of registers with lower addresses that are compared with a register.
_MOST_COMPARED_REGISTERS = 128


def check_duplicate_address(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no two registers of an interface and bank share a byte.

    A read-only and a write-only register may begin at the same address.
    """
    registers_by_address = sorted(spec.registers, key=attrgetter("address"))
    for index, register in enumerate(registers_by_address):
        # Registers are short, so only the nearest ones can overlap. The limit bounds the time for long lists.
        first_compared = max(0, index - _MOST_COMPARED_REGISTERS)
        nearest_lower_registers = registers_by_address[first_compared:index]
        for lower_register in reversed(nearest_lower_registers):
            if not _share_a_byte(lower_register, register):
                continue
            if register.path < lower_register.path:
                earlier_in_file, later_in_file = register, lower_register
            else:
                earlier_in_file, later_in_file = lower_register, register
            _report_overlap(later_in_file, earlier_in_file, report)
            break


def _share_a_byte(lower_register: WrittenRegister, register: WrittenRegister) -> bool:
    """Return True if two registers of one interface and bank have an address in common.

    ``lower_register`` begins at the same address or below. The result is False for a read-only and a write-only
    register that begin at the same address.
    """
    if _address_space(lower_register) != _address_space(register):
        return False
    if last_address(lower_register) < register.address:
        return False
    accesses = {register.access, lower_register.access}
    is_read_write_pair = accesses == {"read_only", "write_only"}
    return not (is_read_write_pair and register.address == lower_register.address)


def _report_overlap(register: WrittenRegister, earlier_register: WrittenRegister, report: DocumentReport) -> None:
    """Report a register that overlaps one that comes earlier in the file."""
    line, _ = report.document.position(earlier_register.path)
    has_one_address = register.address == last_address(register)
    verb = "overlaps" if has_one_address else "overlap"
    message = (
        f"{_address_range(register)} {verb} {quoted(earlier_register.name)} on line {line}, "
        f"which has {_address_range(earlier_register)}"
    )
    report.add("duplicate-address", register.path_of("address"), message)


def check_value_clash(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no two named values of a field have the same number, because a decoder could not choose."""
    for field_list in field_lists(spec):
        for field in field_list.fields:
            first_name_by_number: dict[int, str] = {}
            for name, value in field.values.items():
                first_name = first_name_by_number.setdefault(value.value, name)
                if first_name != name:
                    message = f"{value.value:#x} is already {quoted(first_name)}; a number can have only one name"
                    report.add("value-clash", value.path_of("value"), message)


def _names_for_all_order_codes(parts: Sequence[PlacedPart]) -> Iterator[LocatedValue]:
    """Yield the names of the parts that apply to all order codes: those without the key ``only``.

    Parts for only some order codes may have the same name. Another rule compares them.
    """
    for part in parts:
        if not part.has("only"):
            yield (*part.path, "name"), part.data["name"]


def _check_unique_key(parts: Sequence[PlacedPart], key: str, noun: str, report: DocumentReport) -> None:
    """Report every part whose value under a key, such as its name, is equal to that of an earlier part."""
    located_values = [((*part.path, key), part.data[key]) for part in parts]
    _check_unique(located_values, noun, report)


def _check_unique(located_values: Iterable[LocatedValue], noun: str, report: DocumentReport) -> None:
    """Report every value that is equal to an earlier one, except None.

    ``noun`` describes a part with such a value in the message, such as "a register".
    """
    first_path_by_value: dict[object, Path] = {}
    for path, value in located_values:
        if value is None:
            continue
        first_path = first_path_by_value.setdefault(value, path)
        if first_path == path:
            continue
        value_text = f"{value:#04x}" if isinstance(value, int) else quoted(value)
        line, _ = report.document.position(first_path)
        message = f"there is already {noun} {value_text} on line {line}; rename one of them"
        is_key_of_join = path[-2] == "join"  # The name of a join is a key, not a value.
        report.add("duplicate-name", path, message, at_key=is_key_of_join)


def _address_space(register: WrittenRegister) -> tuple[str, int | None]:
    """Return the interface and the bank of a register, in which addresses are unique. The bank can be None."""
    return interface_name_of(register), register.bank


def _address_range(register: WrittenRegister) -> str:
    """Return the addresses of a register as text, such as ``addresses 0x10 to 0x13``."""
    lowest = register.address
    highest = last_address(register)
    return f"address {lowest:#04x}" if lowest == highest else f"addresses {lowest:#04x} to {highest:#04x}"
