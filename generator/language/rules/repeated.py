"""A rule on lists that are sets, where a repeated item is a mistake."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..problems import DocumentReport, Path, quoted
from .walk import Spec

#: Lists that are sets, at any place.
_SETS = frozenset(
    """
    interfaces sums_up explained_by write_clears cleared_by by_hand data_id memory_access printed also_written
    cable_lengths
    """.split()
)
#: Maps of lists that are sets.
_MAPS_OF_SETS = frozenset(("only_with", "open_only_with"))


def repeated_item(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no item of a list that is a set occurs twice."""
    for path, found in _sets((), spec):
        for index, item in enumerate(found):
            first = found.index(item)
            if first < index:
                what = quoted(item) if isinstance(item, (str, int)) else "this"
                wrong = f"{what} is already item {first + 1} of '{path[-1]}'; remove it, or write the intended one"
                report.add("repeated-item", (*path, index), wrong)


def _sets(path: Path, node: Any) -> Iterator[tuple[Path, list[Any]]]:
    if isinstance(node, list):
        if path[-1] in _SETS or (len(path) > 1 and path[-2] in _MAPS_OF_SETS):
            yield path, node
        for index, item in enumerate(node):
            yield from _sets((*path, index), item)
    elif isinstance(node, dict):
        for key, item in node.items():
            yield from _sets((*path, key), item)
