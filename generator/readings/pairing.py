"""Pair the connectors and the table rows of two readings, so that an additional one does not shift all others."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import SequenceMatcher
from typing import Any

from .reading import ComparedFact, ComparedFacts, FactKey, FactValue

#: The cells with numbers in a row, each with its column.
_Row = tuple[tuple[int, FactValue], ...]
#: Steps of the key that identifies a connector: ``("connector", "ssi", "cable", 1)``.
_STEPS_TO_CONNECTOR = 4


def with_rows_of(spec: ComparedFacts, second: ComparedFacts) -> ComparedFacts:
    """Return the facts of a spec with the rows of its tables numbered as in the second reading.

    Only tables whose numbers of rows differ between the readings are renumbered. Rows that only the spec has get the
    last numbers.
    """
    new_keys: dict[FactKey, FactKey] = {}
    for table_key in [key for key in spec.facts if key[0] == "table" and len(key) == 2]:
        spec_rows, second_rows = _rows_of(spec, table_key), _rows_of(second, table_key)
        if len(spec_rows) == len(second_rows) or not second_rows:
            continue
        new_numbers = _paired_numbers(spec_rows, second_rows)
        for number, row in spec_rows.items():
            for column, _ in row:
                new_keys[_cell_key(table_key, number, column)] = _cell_key(table_key, new_numbers[number], column)
    if not new_keys:
        return spec
    facts = {}
    for key, fact in spec.facts.items():
        new_key = new_keys.get(key, key)
        facts[new_key] = replace(fact, key=new_key)
    return replace(spec, facts=facts)


def _cell_key(table_key: FactKey, row_number: int, column: int) -> FactKey:
    return (*table_key, f"{row_number} {column}")


def _rows_of(facts: ComparedFacts, table_key: FactKey) -> Mapping[int, _Row]:
    """Return the rows of a table that contain numbers, by the number of the row."""
    cells_by_row: dict[int, list[tuple[int, FactValue]]] = defaultdict(list)
    for key, fact in facts.facts.items():
        # The key of a cell is that of its table, and then its row and column: ("table", "limits", "3 0").
        *key_before, last_step = key
        is_cell = tuple(key_before) == table_key and " " in str(last_step)
        if is_cell:
            row_number, column = map(int, str(last_step).split())
            cells_by_row[row_number].append((column, fact.value))
    return {row_number: tuple(cells) for row_number, cells in cells_by_row.items()}


def _paired_numbers(spec_rows: Mapping[int, _Row], second_rows: Mapping[int, _Row]) -> Mapping[int, int]:
    """Return the number of each row in the second reading, by its number in the spec: ``{0: 0, 1: 2}``.

    A row that is not in the second reading gets a number after the last row.
    """
    spec_numbers, second_numbers = list(spec_rows), list(second_rows)
    new_numbers = {
        spec_numbers[spec_index]: second_numbers[second_index]
        for spec_index, second_index in _pairs(list(spec_rows.values()), list(second_rows.values()))
    }
    number_after_last = max(second_numbers) + 1
    for spec_number in spec_numbers:
        if spec_number not in new_numbers:
            new_numbers[spec_number] = number_after_last
            number_after_last += 1
    return new_numbers


def _pairs(spec_rows: Sequence[_Row], second_rows: Sequence[_Row]) -> Iterator[tuple[int, int]]:
    """Yield pairs of row indices: for equal rows, and for rows between these, as far as both readings have rows."""
    for _, spec_start, spec_end, second_start, second_end in SequenceMatcher(
        a=spec_rows, b=second_rows, autojunk=False
    ).get_opcodes():
        yield from zip(range(spec_start, spec_end), range(second_start, second_end), strict=False)


def with_order_of(spec: ComparedFacts, second: ComparedFacts) -> ComparedFacts:
    """Return the facts of a spec with its connectors numbered as in the second reading.

    Connectors that only the spec has get the last numbers. Connectors of an interface and kind are only renumbered if
    the second reading uses the names of the spec for all of them, because readers choose names freely.
    """
    new_keys: dict[FactKey, FactKey] = {}
    for (_, interface, kind), keys_by_name in _connector_keys(spec).items():
        second_keys_by_name = _connector_keys(second).get(("connector", interface, kind), {})
        are_names_of_spec = second_keys_by_name.keys() <= keys_by_name.keys()
        if not second_keys_by_name or not are_names_of_spec:
            continue
        numbered_names = list(second_keys_by_name)
        numbered_names += [name for name in keys_by_name if name not in second_keys_by_name]
        for number, name in enumerate(numbered_names, 1):
            new_keys[keys_by_name[name]] = ("connector", interface, kind, number)
    if all(key == new_key for key, new_key in new_keys.items()):
        return spec

    def renumbered(key: FactKey) -> FactKey:
        return (*new_keys.get(key[:_STEPS_TO_CONNECTOR], key[:_STEPS_TO_CONNECTOR]), *key[_STEPS_TO_CONNECTOR:])

    facts: dict[FactKey, ComparedFact] = {}
    for key, fact in spec.facts.items():
        facts[renumbered(key)] = replace(fact, key=renumbered(fact.key), depends_on=renumbered(fact.depends_on))
    names: dict[FactKey, dict[FactKey, ComparedFact]] = {}
    for kind, names_of_kind in spec.names.items():
        names[kind] = {}
        for key, name_fact in names_of_kind.items():
            names[kind][renumbered(key)] = replace(name_fact, key=renumbered(name_fact.key))
    return replace(spec, facts=facts, names=names)


def _connector_keys(facts: ComparedFacts) -> dict[tuple[Any, ...], dict[str, FactKey]]:
    """Return the keys of connectors by name, for each interface and kind, in the order of their numbers."""
    keys_by_kind: dict[tuple[Any, ...], dict[str, FactKey]] = defaultdict(dict)
    for kind, names in facts.names.items():
        if kind[0] != "connector":
            continue
        for key, name in names.items():
            interface_and_kind = key[: _STEPS_TO_CONNECTOR - 1]
            keys_by_kind[interface_and_kind].setdefault(str(name.value), key)
    return keys_by_kind
