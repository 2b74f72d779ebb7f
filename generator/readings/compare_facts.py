"""Compare single facts of two readings, and the names that the readers give to items."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

from ..changes.pairs import match_by_key
from ..language.document import Path
from ..say import first_of
from .comparison import Comparison, Disagreement, HowOftenRead
from .names import mistaken_pairs
from .reading import (
    FACTORY_DEFAULTS,
    NOTHING,
    CodeAndState,
    ComparedFact,
    FactClass,
    FactKey,
    FactNames,
    FactValue,
    in_hex,
    same_name,
)

#: Kinds of items that each reader defines as needed. A different set of them in the other reading is not a mistake.
CHOSEN_BY_READER = frozenset(("parameter",))


def compare_facts(
    comparison: Comparison,
    spec_facts: Mapping[FactKey, ComparedFact],
    second_facts: Mapping[FactKey, ComparedFact],
    place_in_spec: Callable[[ComparedFact], Path | None],
) -> Iterator[Disagreement]:
    """Yield the disagreements between the facts of a spec and of its second reading, and count the facts of the spec.

    A fact that only the spec states counts as read once. A fact that only the second reading states is a disagreement,
    also if the spec implies it. ``place_in_spec`` returns the place where the spec should state such a fact, or None if
    it need not.
    """
    for key, second_fact, spec_fact in match_by_key(second_facts, spec_facts):
        if spec_fact is not None and not spec_fact.is_implied:
            if second_fact is not None:
                yield from _compare_values(comparison, spec_fact, second_fact)
            elif key[0] not in CHOSEN_BY_READER:
                comparison.count_fact(spec_fact.fact_class, spec_fact.place, HowOftenRead.ONCE)
        elif second_fact is not None and not second_fact.is_implied:
            # The spec may imply the fact, but must state it if the second reading does.
            nearest_place = spec_fact.place if spec_fact is not None else place_in_spec(second_fact)
            if nearest_place is not None:
                yield missing_in_spec(second_fact, nearest_place)


def missing_in_spec(second_fact: ComparedFact, nearest_place: Path) -> Disagreement:
    """Return the disagreement on a fact that only the second reading has.

    ``nearest_place`` is the place where the spec should state the fact.
    """
    return Disagreement(
        fact_class=second_fact.fact_class,
        description=second_fact.description,
        spec_value=NOTHING,
        second_value=value_text(second_fact.value),
        spec_place=(),
        second_place=second_fact.place,
        nearest_place=nearest_place,
    )


def _compare_values(
    comparison: Comparison, spec_fact: ComparedFact, second_fact: ComparedFact
) -> Iterator[Disagreement]:
    """Yield a disagreement if a fact has different values in the two readings, and count the fact if not.

    A value can differ between cases, which are order codes with states of their registers. If each reading has the same
    value in all cases, these two values are compared. Printed names are equal if they have an alternative in common.
    """
    spec_value, second_value = _common_value(spec_fact.value), _common_value(second_fact.value)
    has_one_common_value = isinstance(spec_value, str) is not isinstance(second_value, str)
    if has_one_common_value:
        # Only one of the readings has the same value in all cases, so the values are compared case by case.
        spec_value, second_value = spec_fact.value, second_fact.value
    if not isinstance(spec_value, str) and not isinstance(second_value, str):
        yield from _compare_cases(comparison, spec_fact, spec_value, second_fact, second_value)
        return
    spec_text, second_text = value_text(spec_value), value_text(second_value)
    is_same_name = spec_fact.fact_class is FactClass.PRINTED and same_name(spec_text, second_text)
    if spec_value == second_value or is_same_name:
        comparison.count_fact(spec_fact.fact_class, spec_fact.place, HowOftenRead.TWICE)
    else:
        yield _different_values(spec_fact, spec_text, second_fact, second_text)


def _common_value(value_or_cases: FactValue) -> FactValue:
    """Return the value of a fact if it is the same in all cases, or else the values by case."""
    if isinstance(value_or_cases, str):
        return value_or_cases
    distinct_values = set(value_or_cases.values())
    has_common_value = len(distinct_values) == 1
    return distinct_values.pop() if has_common_value else value_or_cases


def value_text(value_or_cases: FactValue) -> str:
    """Return the value of a fact as text, or its value in the first case if the value differs between cases."""
    if isinstance(value_or_cases, str):
        return value_or_cases
    return next(iter(value_or_cases.values()), NOTHING)


def _compare_cases(
    comparison: Comparison,
    spec_fact: ComparedFact,
    spec_values: Mapping[CodeAndState, str],
    second_fact: ComparedFact,
    second_values: Mapping[CodeAndState, str],
) -> Iterator[Disagreement]:
    """Yield a disagreement if a fact has different values in cases that both readings have, and count the fact.

    A case is an order code with a state of its registers. The fact counts as read once if the second reading does not
    have all cases of the spec. Cases in which the registers do not change the value are not needed.
    """
    common_cases = [case for case in spec_values if case in second_values]
    differing_cases = [case for case in common_cases if spec_values[case] != second_values[case]]
    if differing_cases:
        first_case = differing_cases[0]
        described_fact = replace(spec_fact, description=spec_fact.description + cases_text(differing_cases))
        disagreement = _different_values(
            described_fact, spec_values[first_case], second_fact, second_values[first_case]
        )
        yield replace(disagreement, order_codes=frozenset(case.code for case in differing_cases))
    missing_cases = [case for case in spec_values if case not in second_values]
    is_incomplete = any(not _has_default_value(spec_values, case) for case in missing_cases)
    how_often = HowOftenRead.ONCE if is_incomplete else HowOftenRead.TWICE
    comparison.count_fact(spec_fact.fact_class, spec_fact.place, how_often)


def _has_default_value(values: Mapping[CodeAndState, str], case: CodeAndState) -> bool:
    """Return whether a fact has the same value in this case as with the factory defaults of the registers."""
    return case.state != FACTORY_DEFAULTS and values[case] == values.get(case.by_default)


def _different_values(
    spec_fact: ComparedFact, spec_text: str, second_fact: ComparedFact, second_text: str
) -> Disagreement:
    """Return the disagreement on a fact with different values in the two readings.

    ``resized_frame`` of the result contains the words for a frame whose length differs, and is "" for any other fact.
    """
    is_length = spec_fact.key[-1] == "length"
    return Disagreement(
        fact_class=spec_fact.fact_class,
        description=spec_fact.description,
        spec_value=spec_text,
        second_value=second_text,
        spec_place=spec_fact.place,
        second_place=second_fact.place,
        is_name=spec_fact.fact_class is FactClass.PRINTED,
        resized_frame=_frame_text(spec_fact.key) if is_length else "",
    )


def _frame_text(frame_key: FactKey) -> str:
    """Return the words for a frame in descriptions of its bits: ``of the encoder's frame with 0x1A``, or "".

    ``frame_key`` is the key of the length. For a register, the text is "".
    """
    if frame_key[0] != "frame":
        return ""
    # ("frame", interface, sender, channel, selector value or other identity, "length")
    _, _, sender, _, selector_value, _ = frame_key
    frame_text = f"of the {sender}'s frame"
    # For a frame without a selector, this is a text or a negative number.
    if isinstance(selector_value, int) and selector_value >= 0:
        return f"{frame_text} with {in_hex(selector_value)}"
    return frame_text


def cases_text(cases: list[CodeAndState]) -> str:
    """Return the order codes of cases and the state of the first case: ``, for X-24 and 2 more while 0x49 = 3``."""
    order_codes = list(dict.fromkeys(case.code for case in cases))
    text = f", for {first_of(order_codes, 1)}"
    state = cases[0].state
    return text if state == FACTORY_DEFAULTS else f"{text} while {state}"


def compare_names(
    comparison: Comparison,
    spec_names_by_kind: Mapping[FactKey, FactNames],
    second_names_by_kind: Mapping[FactKey, FactNames],
) -> Iterator[Disagreement]:
    """Yield a disagreement for each item with different names in the two readings, if one of them must be a mistake.

    If the second reading uses the names of the spec, all names must be equal.
    """
    for kind, spec_names in spec_names_by_kind.items():
        second_names = second_names_by_kind.get(kind, {})
        for spec_name, second_name in mistaken_pairs(
            spec_names, second_names, must_be_equal=comparison.has_names_of_spec
        ):
            yield Disagreement(
                fact_class=spec_name.fact_class,
                description=spec_name.description,
                spec_value=f"'{spec_name.value}'",
                second_value=f"'{second_name.value}'",
                spec_place=spec_name.place,
                second_place=second_name.place,
                is_name=True,
            )
