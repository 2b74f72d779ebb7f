"""Compare two readings of a manual fact by fact, including the numbers and citations of their texts.

Texts are compared by their places in the file, because two readers use different words for them. Connectors and table
rows are paired first, so that an additional one does not shift all others.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import SequenceMatcher
from functools import partial
from itertools import chain
from typing import Any

from ..language.document import Path
from .compare_facts import CHOSEN_BY_READER, compare_facts, compare_names, compare_word, missing_in_spec, value_text
from .disagreements import Comparison, Disagreement, HowOftenRead
from .reading import NOTHING, ComparedFact, ComparedFacts, FactClass, FactKey, FactNames, FactValue
from .stated import NUMBERS, dotted_path

#: Classes of facts in texts. A second reading can also give these facts by their paths.
_TEXT_CLASSES = frozenset((FactClass.TEXT, FactClass.SECTION))


def compare(spec_reading: ComparedFacts, second_reading: ComparedFacts) -> Comparison:
    """Compare the facts of a spec with a second, independent reading of the same manual.

    Facts with the same key are compared, and frames and registers are compared bit by bit. Facts that the second
    reading only gives by their path, and facts that no manual prints, are counted separately at the end.
    """
    spec_reading = with_row_numbers_of(with_connector_numbers_of(spec_reading, second_reading), second_reading)
    comparison = Comparison(has_names_of_spec=use_same_names(spec_reading, second_reading))
    find_path_in_spec = partial(_nearest_path, comparison, spec_reading, second_reading)
    # A fact that the second reading gives by its path gets the key of the fact in the spec.
    second_fact_by_key = second_reading.facts | dict(_facts_by_path(spec_reading, second_reading))
    disagreements = chain(
        compare_facts(comparison, spec_reading.facts, second_fact_by_key, find_path_in_spec),
        _compare_order_codes(spec_reading, second_reading),
        compare_names(comparison, spec_reading.names, second_reading.names),
    )
    for disagreement in disagreements:
        comparison.add_disagreement(disagreement)
    for key, spec_word in spec_reading.words.items():
        # If the byte orders differ, all bits differ too, so only the byte orders are reported.
        if not _have_different_byte_orders(key, spec_reading, second_reading):
            compare_word(comparison, spec_word, second_reading.words.get(key))
    _correct_read_counts(comparison, spec_reading, second_reading)
    return comparison


def _have_different_byte_orders(word_key: FactKey, spec_reading: ComparedFacts, second_reading: ComparedFacts) -> bool:
    """Return whether both readings state the byte order of a frame or register, and they differ."""
    order_key = (*word_key, "order")
    if order_key not in spec_reading.facts or order_key not in second_reading.facts:
        return False
    return str(spec_reading.facts[order_key].value) != str(second_reading.facts[order_key].value)


def _nearest_path(
    comparison: Comparison, spec_reading: ComparedFacts, second_reading: ComparedFacts, second_fact: ComparedFact
) -> Path | None:
    """Return the place where the spec should state a fact that only the second reading has, or None if it need not.

    If the fact depends on another fact, as a default depends on its register, this is the place of the other fact. If
    the spec does not contain the other fact either, the result is None, because only the other fact is reported. In all
    other cases, it is the only fact of the same kind that the second reading does not have, or else the list or map of
    such facts.
    """
    if second_fact.key[0] == "code":
        return None  # Missing order codes are reported together.
    is_needed_name = comparison.has_names_of_spec and second_fact.key[0] in CHOSEN_BY_READER
    if second_fact.may_be_missing and not is_needed_name:
        return None
    if second_fact.depends_on:
        subject_fact = spec_reading.facts.get(second_fact.depends_on)
        return subject_fact.path_in_file if subject_fact is not None else None
    unmatched_facts: list[ComparedFact] = []
    for spec_key, spec_fact in spec_reading.facts.items():
        is_of_same_kind = spec_key[:2] == second_fact.key[:2] and spec_fact.fact_class is second_fact.fact_class
        if is_of_same_kind and not spec_fact.depends_on and spec_fact.key not in second_reading.facts:
            unmatched_facts.append(spec_fact)
    if len(unmatched_facts) == 1:
        return unmatched_facts[0].path_in_file
    return _nearest_container(second_fact.path_in_file)


def _nearest_container(fact_path: Path) -> Path:
    """Return the nearest list or map around a place that exists in every spec.

    In general, this is the first step of the place, such as ``("registers",)``. In interfaces and the manual, it has
    three steps, such as ``("interfaces", "ssi", "layouts")``, or two if the place has no third step or it is an index.
    """
    if fact_path[0] not in ("interfaces", "manual"):
        return fact_path[:1]
    third_steps = fact_path[2:3]  # Empty if the place has only two steps.
    is_third_step_a_name = any(isinstance(step, str) for step in third_steps)
    return fact_path[:3] if is_third_step_a_name else fact_path[:2]


def _facts_by_path(
    spec_reading: ComparedFacts, second_reading: ComparedFacts
) -> Iterator[tuple[FactKey, ComparedFact]]:
    """Yield the facts that the second reading gives by their paths: numbers in texts, and sections in citations.

    Each is a copy of the fact in the spec, with the value and the place from the second reading. If the spec does not
    have the path, a separate fact is yielded.
    """
    text_facts = [fact for fact in spec_reading.facts.values() if fact.fact_class in _TEXT_CLASSES]
    spec_fact_by_path = {dotted_path(fact.path_in_file): fact for fact in text_facts}
    for path, printed_numbers in second_reading.printed_numbers.items():
        spec_fact = spec_fact_by_path.get(path)
        if spec_fact is None:
            spec_fact = ComparedFact(
                fact_class=FactClass.TEXT,
                key=(NUMBERS, path),
                value="",
                description=f"numbers in {path}",
                path_in_file=(),
            )
        yield spec_fact.key, replace(spec_fact, value=printed_numbers.text, path_in_file=printed_numbers.path_in_file)
    for key, spec_fact in spec_reading.facts.items():
        if (
            spec_fact.fact_class is FactClass.SECTION
            and dotted_path(spec_fact.path_in_file) not in second_reading.printed_numbers
        ):
            sections = _sections_at(spec_fact.path_in_file, second_reading)
            if sections:
                path_in_second = ("sections", sections[0])
                yield key, replace(spec_fact, value=", ".join(sorted(sections)), path_in_file=path_in_second)


def _sections_at(fact_path: Path, second_reading: ComparedFacts) -> Sequence[str]:
    """Return the sections that the second reading cites for a place, or else for the nearest place around it."""
    for length in range(len(fact_path), 0, -1):
        path = dotted_path(fact_path[:length])
        if path in second_reading.sections:
            return second_reading.sections[path]
    return ()


def _correct_read_counts(comparison: Comparison, spec_reading: ComparedFacts, second_reading: ComparedFacts) -> None:
    """Correct the counts of facts that so far count as read twice, although little was compared.

    A text or citation that the second reading only gives by its path counts as read once. So does a characteristic
    without numbers, of which only the name was compared. Facts that no manual prints count as decided by the reader.
    """
    for (fact_class, path_in_file), read in comparison.how_often_read_by_fact.items():
        if read is not HowOftenRead.TWICE:
            continue
        path = dotted_path(path_in_file)
        # This is the place of a characteristic itself, such as ("characteristics", "weight").
        is_characteristic = fact_class is FactClass.CHARACTERISTIC and len(path_in_file) == 2
        is_only_name = is_characteristic and (NUMBERS, *path_in_file, "value") not in spec_reading.facts
        is_from_path = fact_class in _TEXT_CLASSES and path in second_reading.printed_numbers
        if is_only_name or is_from_path:
            comparison.how_often_read_by_fact[fact_class, path_in_file] = HowOftenRead.ONCE
        elif fact_class not in _TEXT_CLASSES and _is_decided(fact_class, path, second_reading.decided):
            comparison.how_often_read_by_fact[fact_class, path_in_file] = HowOftenRead.DECIDED


def _is_decided(fact_class: FactClass, path: str, decided: Sequence[str]) -> bool:
    """Return whether the reader decided a fact, because the manual does not print it.

    ``decided`` contains the class of the fact, such as "time", its path, or a path above it.
    """
    if fact_class.value in decided:
        return True
    # With a dot at both ends, ``registers.mode`` is not above ``registers.mode_2``.
    return any(f"{path}.".startswith(f"{decided_path}.") for decided_path in decided)


def _compare_order_codes(spec_reading: ComparedFacts, second_reading: ComparedFacts) -> Iterator[Disagreement]:
    """Yield one disagreement for all order codes that only the spec has, and one for those only in the second reading.

    Each names the first code and the number of the others. If a reading has no order codes at all, nothing is yielded.
    """
    spec_codes, second_codes = _order_codes_of(spec_reading), _order_codes_of(second_reading)
    if not spec_codes or not second_codes:
        return
    only_in_spec = [fact for key, fact in spec_codes.items() if key not in second_codes]
    if only_in_spec:
        first_fact = only_in_spec[0]
        yield Disagreement(
            fact_class=first_fact.fact_class,
            description=_describe_with_count(only_in_spec),
            spec_value=value_text(first_fact.value),
            second_value=NOTHING,
            path_in_spec=first_fact.path_in_file,
            path_in_second=_first_path(second_codes),
        )
    only_in_second = [fact for key, fact in second_codes.items() if key not in spec_codes]
    if only_in_second:
        described_fact = replace(only_in_second[0], description=_describe_with_count(only_in_second))
        yield missing_in_spec(described_fact, _first_path(spec_codes))


def _order_codes_of(facts: ComparedFacts) -> dict[FactKey, ComparedFact]:
    return {key: fact for key, fact in facts.facts.items() if key[0] == "code"}


def _first_path(facts: dict[FactKey, ComparedFact]) -> Path:
    return next(iter(facts.values())).path_in_file


def _describe_with_count(facts: Sequence[ComparedFact]) -> str:
    """Return the description of the first of several facts, with the number of the others."""
    description = facts[0].description
    if len(facts) == 1:
        return description
    return f"{description} and of {len(facts) - 1} more"


# -- names that the readers chose

#: If at least this share of names is equal, the second reading is assumed to use the names of the spec.
_SHARE_OF_EQUAL_NAMES = 0.9


def use_same_names(spec_reading: ComparedFacts, second_reading: ComparedFacts) -> bool:
    """Return whether the second reading uses the names of the spec, so that any different name is a mistake.

    This is assumed if at least 90 % of the names of common items are equal.
    """
    compared_count, equal_count = 0, 0
    for spec_names, second_names in _name_maps_of_both(spec_reading, second_reading):
        for key in spec_names.keys() & second_names.keys():
            compared_count += 1
            if spec_names[key].value == second_names[key].value:
                equal_count += 1
    return equal_count >= _SHARE_OF_EQUAL_NAMES * compared_count


def _name_maps_of_both(
    spec_reading: ComparedFacts, second_reading: ComparedFacts
) -> Iterator[tuple[FactNames, FactNames]]:
    """Yield the names of each kind of item in both readings, by key.

    Names of fields are taken from the first case of a frame or register that both readings have.
    """
    yield from _names_by_kind(spec_reading.names, second_reading.names)
    for key in spec_reading.words.keys() & second_reading.words.keys():
        spec_cases, second_cases = spec_reading.words[key].cases, second_reading.words[key].cases
        common_cases = [case for case in spec_cases if case in second_cases]
        if common_cases:
            first_case = common_cases[0]
            yield from _names_by_kind(spec_cases[first_case].names, second_cases[first_case].names)


def _names_by_kind(
    spec_names_by_kind: Mapping[FactKey, FactNames], second_names_by_kind: Mapping[FactKey, FactNames]
) -> Iterator[tuple[FactNames, FactNames]]:
    for kind in spec_names_by_kind.keys() & second_names_by_kind.keys():
        yield spec_names_by_kind[kind], second_names_by_kind[kind]


# -- rows of tables and connectors, numbered as in the second reading

#: The cells with numbers in a row, each with its column.
_Row = tuple[tuple[int, FactValue], ...]
#: Steps of the key that identifies a connector: ``("connector", "ssi", "cable", 1)``.
_STEPS_TO_CONNECTOR = 4


def with_row_numbers_of(spec_reading: ComparedFacts, second_reading: ComparedFacts) -> ComparedFacts:
    """Return the facts of a spec with the rows of its tables numbered as in the second reading.

    Only tables whose numbers of rows differ between the readings are renumbered. Rows that only the spec has get the
    last numbers.
    """
    new_keys: dict[FactKey, FactKey] = {}
    # The key of a table is ("table", name), and the keys of the facts about it are longer.
    table_keys = [key for key in spec_reading.facts if key[0] == "table" and len(key) == 2]
    for table_key in table_keys:
        spec_rows, second_rows = _rows_of(spec_reading, table_key), _rows_of(second_reading, table_key)
        if len(spec_rows) == len(second_rows) or not second_rows:
            continue
        new_numbers = _paired_numbers(spec_rows, second_rows)
        for number, row in spec_rows.items():
            for column, _ in row:
                new_keys[_cell_key(table_key, number, column)] = _cell_key(table_key, new_numbers[number], column)
    if not new_keys:
        return spec_reading
    facts = {}
    for key, fact in spec_reading.facts.items():
        new_key = new_keys.get(key, key)
        facts[new_key] = replace(fact, key=new_key)
    return replace(spec_reading, facts=facts)


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
    new_numbers: dict[int, int] = {}
    for spec_index, second_index in _pairs_of_row_indices(list(spec_rows.values()), list(second_rows.values())):
        new_numbers[spec_numbers[spec_index]] = second_numbers[second_index]
    number_after_last = max(second_numbers) + 1
    for spec_number in spec_numbers:
        if spec_number not in new_numbers:
            new_numbers[spec_number] = number_after_last
            number_after_last += 1
    return new_numbers


def _pairs_of_row_indices(spec_rows: Sequence[_Row], second_rows: Sequence[_Row]) -> Iterator[tuple[int, int]]:
    """Yield pairs of row indices: for equal rows, and for rows between these, as far as both readings have rows."""
    matcher = SequenceMatcher(a=spec_rows, b=second_rows, autojunk=False)
    for _, spec_start, spec_end, second_start, second_end in matcher.get_opcodes():
        spec_indices, second_indices = range(spec_start, spec_end), range(second_start, second_end)
        yield from zip(spec_indices, second_indices, strict=False)


def with_connector_numbers_of(spec_reading: ComparedFacts, second_reading: ComparedFacts) -> ComparedFacts:
    """Return the facts of a spec with its connectors numbered as in the second reading.

    Connectors that only the spec has get the last numbers. Connectors of an interface and kind are only renumbered if
    the second reading uses the names of the spec for all of them, because readers choose names freely.
    """
    new_keys: dict[FactKey, FactKey] = {}
    for (_, interface, kind), keys_by_name in _connector_keys(spec_reading).items():
        second_keys_by_name = _connector_keys(second_reading).get(("connector", interface, kind), {})
        are_names_of_spec = second_keys_by_name.keys() <= keys_by_name.keys()
        if not second_keys_by_name or not are_names_of_spec:
            continue
        numbered_names = list(second_keys_by_name)
        numbered_names += [name for name in keys_by_name if name not in second_keys_by_name]
        for number, name in enumerate(numbered_names, 1):
            new_keys[keys_by_name[name]] = ("connector", interface, kind, number)
    if all(key == new_key for key, new_key in new_keys.items()):
        return spec_reading

    def renumbered(key: FactKey) -> FactKey:
        connector_key, steps_inside = key[:_STEPS_TO_CONNECTOR], key[_STEPS_TO_CONNECTOR:]
        return (*new_keys.get(connector_key, connector_key), *steps_inside)

    facts: dict[FactKey, ComparedFact] = {}
    for key, fact in spec_reading.facts.items():
        facts[renumbered(key)] = replace(fact, key=renumbered(fact.key), depends_on=renumbered(fact.depends_on))
    names: dict[FactKey, dict[FactKey, ComparedFact]] = {}
    for kind, names_of_kind in spec_reading.names.items():
        names[kind] = {}
        for key, name_fact in names_of_kind.items():
            names[kind][renumbered(key)] = replace(name_fact, key=renumbered(name_fact.key))
    return replace(spec_reading, facts=facts, names=names)


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
