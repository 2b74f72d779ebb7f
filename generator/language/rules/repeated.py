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
    for path, found in _sets((), spec):
        for index, item in enumerate(found):
            first = found.index(item)
            if first < index:
                what = quoted(item) if isinstance(item, (str, int)) else "this"
                wrong = f"{what} is already item {first + 1} of '{path[-1]}'; remove it, or write the intended one"
                report.add("repeated-item", (*path, index), wrong)


def repeated_text(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that registers, fields of a frame, and values of a field do not have the text of a neighbour."""
    registers: dict[object, list[tuple[Path, Spec]]] = {}
    for path, register in items(spec, "registers"):
        registers.setdefault((interface_of(register), register.get("bank")), []).append((path, register))
    for found in registers.values():
        _compare(found, "printed_name", report)
    for fields in field_lists(spec):
        _compare(((path, item) for path, item in fields if not _NOT_DATA & {*item}), "printed_name", report)
        for path, field in fields:
            values = [((*path, "values", name), value) for name, value in mapping(field, "values").items()]
            _compare(values, "printed_name", report)
            # Several values can be "not used".
            _compare((item for item in values if item[1].get("meaning", "").count(" ") > 1), "meaning", report)


def _compare(found: Iterable[tuple[Path, Spec]], key: str, report: DocumentReport) -> None:
    """Report every text under a key that an earlier item has."""
    seen: dict[object, object] = {}
    for path, item in found:
        name = item.get("name", path[-1])
        if key in item and (first := seen.setdefault(item[key], name)) != name:
            wrong = f"{quoted(str(first))} already has this text as its {quoted(key)}; one of the two is wrong"
            report.add("repeated-text", (*path, key), wrong)


def _sets(path: Path, node: Any) -> Iterator[tuple[Path, list[Any]]]:
    if isinstance(node, list):
        if path[-1] in _SETS or (len(path) > 1 and path[-2] in _MAPS_OF_SETS):
            yield path, node
        for index, item in enumerate(node):
            yield from _sets((*path, index), item)
    elif isinstance(node, dict):
        for key, item in node.items():
            yield from _sets((*path, key), item)
