"""Compare two readings of a manual fact by fact, including the numbers and citations of their texts.

Texts are compared by their places in the file, because two readers use different words for them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain

from ..language.document import Path
from .compare_facts import CHOSEN_BY_READER, compare_facts, compare_names, missing_in_spec, value_text
from .compare_words import compare_word
from .comparison import Comparison, Disagreement, HowOftenRead
from .names import use_same_names
from .pairing import with_order_of, with_rows_of
from .reading import NOTHING, ComparedFact, ComparedFacts, FactClass, FactKey
from .texts import NUMBERS, dotted_path

#: Classes of facts in texts. A second reading can also give these facts by their paths.
_TEXT_CLASSES = frozenset((FactClass.TEXT, FactClass.SECTION))


def compare(spec: ComparedFacts, second: ComparedFacts) -> Comparison:
    """Compare the facts of a spec with a second, independent reading of the same manual.

    Facts with the same key are compared, and frames and registers are compared bit by bit. Facts that the second
    reading only gives by their path, and facts that no manual prints, are counted separately at the end.
    """
    spec = with_rows_of(with_order_of(spec, second), second)
    comparison = Comparison(has_names_of_spec=use_same_names(spec, second))
    place_in_spec = partial(_nearest_place, comparison, spec, second)
    # A fact that the second reading gives by its path gets the key of the fact in the spec.
    second_facts = second.facts | dict(_facts_by_path(spec, second))
    disagreements = chain(
        compare_facts(comparison, spec.facts, second_facts, place_in_spec),
        _compare_order_codes(spec, second),
        compare_names(comparison, spec.names, second.names),
    )
    for disagreement in disagreements:
        comparison.add_disagreement(disagreement)
    for key, spec_word in spec.words.items():
        # If the byte orders differ, all bits differ too, so only the byte orders are reported.
        if not _have_different_byte_orders(key, spec, second):
            compare_word(comparison, spec_word, second.words.get(key))
    _count_undecided(comparison, spec, second)
    return comparison


def _have_different_byte_orders(word_key: FactKey, spec: ComparedFacts, second: ComparedFacts) -> bool:
    """Return whether both readings state the byte order of a frame or register, and they differ."""
    order_key = (*word_key, "order")
    if order_key not in spec.facts or order_key not in second.facts:
        return False
    return str(spec.facts[order_key].value) != str(second.facts[order_key].value)


def _nearest_place(
    comparison: Comparison, spec: ComparedFacts, second: ComparedFacts, second_fact: ComparedFact
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
        subject_fact = spec.facts.get(second_fact.depends_on)
        return subject_fact.place if subject_fact is not None else None
    unmatched_facts: list[ComparedFact] = []
    for spec_key, spec_fact in spec.facts.items():
        is_of_same_kind = spec_key[:2] == second_fact.key[:2] and spec_fact.fact_class is second_fact.fact_class
        if is_of_same_kind and not spec_fact.depends_on and spec_fact.key not in second.facts:
            unmatched_facts.append(spec_fact)
    if len(unmatched_facts) == 1:
        return unmatched_facts[0].place
    return _nearest_container(second_fact.place)


def _nearest_container(fact_place: Path) -> Path:
    """Return the nearest list or map around a place that exists in every spec.

    In general, this is the first step of the place, such as ``("registers",)``. In interfaces and the manual, it has
    three steps, such as ``("interfaces", "ssi", "layouts")``, or two if the place has no third step or it is an index.
    """
    if fact_place[0] not in ("interfaces", "manual"):
        return fact_place[:1]
    third_steps = fact_place[2:3]  # Empty if the place has only two steps.
    is_third_step_a_name = any(isinstance(step, str) for step in third_steps)
    return fact_place[:3] if is_third_step_a_name else fact_place[:2]


def _facts_by_path(spec: ComparedFacts, second: ComparedFacts) -> Iterator[tuple[FactKey, ComparedFact]]:
    """Yield the facts that the second reading gives by their paths: numbers in texts, and sections in citations.

    Each is a copy of the fact in the spec, with the value and the place from the second reading. If the spec does not
    have the path, a separate fact is yielded.
    """
    text_facts = [fact for fact in spec.facts.values() if fact.fact_class in _TEXT_CLASSES]
    spec_fact_by_path = {dotted_path(fact.place): fact for fact in text_facts}
    for path, printed_numbers in second.printed_numbers.items():
        spec_fact = spec_fact_by_path.get(path)
        if spec_fact is None:
            spec_fact = ComparedFact(
                fact_class=FactClass.TEXT, key=(NUMBERS, path), value="", description=f"numbers in {path}", place=()
            )
        yield spec_fact.key, replace(spec_fact, value=printed_numbers.text, place=printed_numbers.place)
    for key, spec_fact in spec.facts.items():
        if spec_fact.fact_class is FactClass.SECTION and dotted_path(spec_fact.place) not in second.printed_numbers:
            sections = _sections_at(spec_fact.place, second)
            if sections:
                second_place = ("sections", sections[0])
                yield key, replace(spec_fact, value=", ".join(sorted(sections)), place=second_place)


def _sections_at(fact_place: Path, second: ComparedFacts) -> Sequence[str]:
    """Return the sections that the second reading cites for a place, or else for the nearest place around it."""
    for length in range(len(fact_place), 0, -1):
        path = dotted_path(fact_place[:length])
        if path in second.sections:
            return second.sections[path]
    return ()


def _count_undecided(comparison: Comparison, spec: ComparedFacts, second: ComparedFacts) -> None:
    """Correct the counts of facts that so far count as read twice, although little was compared.

    A text or citation that the second reading only gives by its path counts as read once. So does a characteristic
    without numbers, of which only the name was compared. Facts that no manual prints count as decided by the reader.
    """
    for (fact_class, place), read in comparison.read_by_place.items():
        if read is not HowOftenRead.TWICE:
            continue
        path = dotted_path(place)
        # This is the place of a characteristic itself, such as ("characteristics", "weight").
        is_characteristic = fact_class is FactClass.CHARACTERISTIC and len(place) == 2
        is_only_name = is_characteristic and (NUMBERS, *place, "value") not in spec.facts
        is_from_path = fact_class in _TEXT_CLASSES and path in second.printed_numbers
        if is_only_name or is_from_path:
            comparison.read_by_place[fact_class, place] = HowOftenRead.ONCE
        elif fact_class not in _TEXT_CLASSES and _is_decided(fact_class, path, second.decided):
            comparison.read_by_place[fact_class, place] = HowOftenRead.DECIDED


def _is_decided(fact_class: FactClass, path: str, decided: Sequence[str]) -> bool:
    """Return whether the reader decided a fact, because the manual does not print it.

    ``decided`` contains the class of the fact, such as "time", its path, or a path above it.
    """
    if fact_class.value in decided:
        return True
    # With a dot at both ends, ``registers.mode`` is not above ``registers.mode_2``.
    return any(f"{path}.".startswith(f"{decided_path}.") for decided_path in decided)


def _compare_order_codes(spec: ComparedFacts, second: ComparedFacts) -> Iterator[Disagreement]:
    """Yield one disagreement for all order codes that only the spec has, and one for those only in the second reading.

    Each names the first code and the number of the others. If a reading has no order codes at all, nothing is yielded.
    """
    spec_codes, second_codes = _order_codes_of(spec), _order_codes_of(second)
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
            spec_place=first_fact.place,
            second_place=_first_place(second_codes),
        )
    only_in_second = [fact for key, fact in second_codes.items() if key not in spec_codes]
    if only_in_second:
        described_fact = replace(only_in_second[0], description=_describe_with_count(only_in_second))
        yield missing_in_spec(described_fact, _first_place(spec_codes))


def _order_codes_of(facts: ComparedFacts) -> dict[FactKey, ComparedFact]:
    return {key: fact for key, fact in facts.facts.items() if key[0] == "code"}


def _first_place(facts: dict[FactKey, ComparedFact]) -> Path:
    return next(iter(facts.values())).place


def _describe_with_count(facts: Sequence[ComparedFact]) -> str:
    """Return the description of the first of several facts, with the number of the others."""
    description = facts[0].description
    if len(facts) == 1:
        return description
    return f"{description} and of {len(facts) - 1} more"
