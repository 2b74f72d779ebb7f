"""Rules for items of a list that occur twice, and for neighbours with the same text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ..document import Path
from ..problems import DocumentReport, quoted
from ..written_codes import WrittenRegister
from ..written_layouts import WrittenField
from ..written_parts import WrittenSpec
from .parts import field_lists, interface_of

#: Lists that are sets, at any place.
_SETS = frozenset(
    """
    interfaces sums_up explained_by write_clears cleared_by by_hand data_id memory_access printed also_written
    cable_lengths
    """.split()
)
#: Maps of lists that are sets.
_MAPS_OF_SETS = frozenset(("only_with", "open_only_with"))


def check_repeated_items(spec: WrittenSpec, as_read: WrittenSpec, report: DocumentReport) -> None:
    """Check that no item of a list that is a set, by its key, occurs twice."""
    for path, set_items in _unique_lists((), spec.data):
        for index, set_item in enumerate(set_items):
            first_index = set_items.index(set_item)
            if first_index < index:
                item_text = quoted(set_item) if isinstance(set_item, (str, int)) else "this"
                message = (
                    f"{item_text} is already item {first_index + 1} of '{path[-1]}'; "
                    "remove it, or write the intended value"
                )
                report.add("repeated-item", (*path, index), message)


def _unique_lists(path: Path, node: object) -> Iterator[tuple[Path, list[object]]]:
    """Yield every list that is a set, at a place and below it, with its path.

    The key of a list decides, or the key of the map in which it is: both ``sums_up`` and each list in ``only_with`` are
    sets.
    """
    if isinstance(node, list):
        is_in_map_of_sets = len(path) > 1 and path[-2] in _MAPS_OF_SETS
        if path[-1] in _SETS or is_in_map_of_sets:
            yield path, node
        for index, inner in enumerate(node):
            yield from _unique_lists((*path, index), inner)
    elif isinstance(node, dict):
        for key, inner in node.items():
            yield from _unique_lists((*path, key), inner)


class _NamedText(NamedTuple):
    """A text of a part, with the name of the part and the place of the text. A missing text is empty."""

    text: str
    name: str
    path: Path


def check_repeated_text(spec: WrittenSpec, as_read: WrittenSpec, report: DocumentReport) -> None:
    """Check that registers of a bank, fields of a frame, and values of a field do not have the text of a neighbour."""
    registers_by_bank: dict[object, list[WrittenRegister]] = {}
    for register in spec.registers:
        registers_by_bank.setdefault((interface_of(register), register.bank), []).append(register)
    for registers in registers_by_bank.values():
        _report_repeated("printed_name", map(_printed_name_of, registers), report)
    for field_list in field_lists(spec):
        data_fields = filter(_has_data, field_list.fields)
        _report_repeated("printed_name", map(_printed_name_of, data_fields), report)
        for field in field_list.fields:
            _check_values(field, report)


def _check_values(field: WrittenField, report: DocumentReport) -> None:
    """Check that the values of a field do not have the same printed name or the same meaning with several words."""
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
    """Return True for a field that is neither fixed nor a check.

    Each word of a frame can repeat the names of such fields.
    """
    is_fixed = field.constant is not None or field.unused is not None
    is_check = bool(field.crc or field.parity_of)
    return not is_fixed and not is_check


def _report_repeated(text_key: str, texts: Iterable[_NamedText], report: DocumentReport) -> None:
    """Report every text under a key that an earlier neighbour of another name has. Empty texts are missing texts."""
    first_names: dict[str, str] = {}
    for text, name, path in texts:
        if not text:
            continue
        first_name = first_names.setdefault(text, name)
        if first_name != name:
            message = f"{quoted(first_name)} already has this text as its {quoted(text_key)}; one of the two is wrong"
            report.add("repeated-text", path, message)
