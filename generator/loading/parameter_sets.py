"""The sets of parameters that order codes, registers and alternatives combine to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from types import MappingProxyType

from ..language.rules.walk import by_name, expanded, field_lists, interface_of
from ..model import Alternative, Variant
from ..model.expressions import Expression
from ..order_codes.run_time import State, corners, resolve_parameters
from .fields import Context
from .from_mapping import Raw
from .run_time_parameters import extreme_states

#: Largest number of sets of parameters, and of fields times sets. The largest manuals need 200 and 20,000.
MOST_SETS = 20_000
MOST_PLACES = 500_000


def parameter_sets(
    raw: Raw, definitions: Mapping[str, Expression], variants: Sequence[Variant], alternatives: Sequence[Alternative]
) -> Mapping[str, Sequence[Mapping[str, int]]]:
    """Return, by interface, every set of parameters that a layout must support.

    These are the sets of the order codes, the bounds of parameters held in registers, one by one and together, and each
    of these with each answer of an alternative.
    """
    kinds = (*raw["interfaces"], *map(interface_of, raw.get("registers", ())))
    if not variants:  # Parameters are unknown. Parts that do not use them can still be checked.
        return MappingProxyType({kind: ({},) for kind in kinds})
    sets_by_interface: dict[str, list[Mapping[str, int]]] = {kind: [] for kind in kinds}
    answers: list[Mapping[str, int]] = [{}]
    for alternative in alternatives:
        answers += [answer.sets for answer in alternative.answers[1:]]
    fields = extreme_states(raw)
    # One by one first, so that messages name as few parameters as possible.
    singles = (state for states in fields for state in states)
    register_states: list[State] = [{}, *singles, *(corners(fields) if len(fields) > 1 else ())]
    known_keys: set[tuple[str, tuple[int, ...]]] = set()
    bases = _without_definitions(definitions, variants)
    for (kind, base), state, answer in product(bases, register_states, answers):
        parameters = {**base, **state, **answer}
        key = (kind, tuple(parameters.values()))
        if key not in known_keys:
            known_keys.add(key)
            sets_by_interface.setdefault(kind, []).append(resolve_parameters(parameters, definitions))
        if len(known_keys) > MOST_SETS:
            break
    # An interface that no order code selects has been reported. Its layouts are checked with the parameters of the
    # others.
    all_sets = [parameters for sets in sets_by_interface.values() for parameters in sets]
    return MappingProxyType({kind: sets or all_sets for kind, sets in sets_by_interface.items()})


def _without_definitions(
    definitions: Mapping[str, Expression], variants: Sequence[Variant]
) -> Iterator[tuple[str, Mapping[str, int]]]:
    """Yield the interface and the parameters that order codes set, without those that follow from others, each once."""
    base_by_values: dict[tuple[str, tuple[int, ...]], Mapping[str, int]] = {}
    for variant in variants:
        base = {name: value for name, value in variant.parameters.items() if name not in definitions}
        base_by_values.setdefault((variant.interface, tuple(base.values())), base)
    yield from ((interface, base) for (interface, _), base in base_by_values.items())


def too_much_work(raw: Raw, context: Context) -> bool:
    """Report a spec for which each field would be placed too often, as it is for each set of parameters."""
    sets = sum(map(len, context.parameter_sets.values()))
    groups = by_name(raw, "field_groups")
    fields = sum(1 for owner in field_lists(dict(raw)) for _ in expanded(owner, groups))
    if sets <= MOST_SETS and sets * fields <= MOST_PLACES:
        return False
    number = f"more than {MOST_SETS}" if sets > MOST_SETS else str(sets)
    message = f"order codes, registers and alternatives combine to {number} sets of parameters"
    if sets <= MOST_SETS:
        message += f", and there are {fields} fields; the product must be at most {MOST_PLACES}"
    context.report.add("too-large", ("order_code", "parts"), f"{message}; split the family", at_key=True)
    return True
