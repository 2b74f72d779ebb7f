"""Rules on repetitions that are mistakes: in lists that are sets, and in the texts of neighbouring items."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from ..problems import DocumentReport, Path, quoted
from .walk import Spec, field_lists, interface_of, items, mapping

#: Lists that are sets, at any place.
_SETS = frozenset(
    """
    interfaces sums_up explained_by write_clears cleared_by by_hand data_id memory_access printed also_written
    cable_lengths
    """.split()
)
#: Maps of lists that are sets.
_MAPS_OF_SETS = frozenset(("only_with", "open_only_with"))
#: Keys of fields without data. Each word of a frame can have its own check bits with the same names.
_NOT_DATA = frozenset(("constant", "unused", "crc", "parity_of"))


def repeated_item(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no item of a list that is a set occurs twice."""
    for path, set_items in _unique_lists((), spec):
        for index, set_item in enumerate(set_items):
            first_index = set_items.index(set_item)
            if first_index < index:
                item_text = quoted(set_item) if isinstance(set_item, (str, int)) else "this"
                message = (
                    f"{item_text} is already item {first_index + 1} of '{path[-1]}'; "
                    "remove it, or write the intended one"
                )
                report.add("repeated-item", (*path, index), message)


def repeated_text(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that registers, fields of a frame, and values of a field do not have the text of a neighbour."""
    registers: dict[object, list[tuple[Path, Spec]]] = {}
    for path, register in items(spec, "registers"):
        registers.setdefault((interface_of(register), register.get("bank")), []).append((path, register))
    for neighbours in registers.values():
        _report_repeated(neighbours, "printed_name", report)
    for fields in field_lists(spec):
        data_fields = [(path, field) for path, field in fields if _NOT_DATA.isdisjoint(field)]
        _report_repeated(data_fields, "printed_name", report)
        for path, field in fields:
            values = [((*path, "values", name), value) for name, value in mapping(field, "values").items()]
            _report_repeated(values, "printed_name", report)
            # Several values can be "not used".
            explained = [(path, value) for path, value in values if value.get("meaning", "").count(" ") > 1]
            _report_repeated(explained, "meaning", report)


def _report_repeated(neighbours: Iterable[tuple[Path, Spec]], key: str, report: DocumentReport) -> None:
    """Report every text under a key that an earlier item has."""
    first_names: dict[object, object] = {}
    for path, neighbour in neighbours:
        name = neighbour.get("name", path[-1])
        if key in neighbour and (first_name := first_names.setdefault(neighbour[key], name)) != name:
            message = f"{quoted(str(first_name))} already has this text as its {quoted(key)}; one of the two is wrong"
            report.add("repeated-text", (*path, key), message)


def _unique_lists(path: Path, node: Any) -> Iterator[tuple[Path, list[Any]]]:
    if isinstance(node, list):
        if path[-1] in _SETS or (len(path) > 1 and path[-2] in _MAPS_OF_SETS):
            yield path, node
        for index, inner in enumerate(node):
            yield from _unique_lists((*path, index), inner)
    elif isinstance(node, dict):
        for key, inner in node.items():
            yield from _unique_lists((*path, key), inner)
