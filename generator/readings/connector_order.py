"""Pair the connectors of two readings by their names, so that a new connector does not move the other connectors."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import Any

from .reading import Fact, Facts, Key

#: Steps of the key that identifies a connector: ``("connector", "ssi", "cable", 1)``.
_STEPS = 4


def with_order_of(spec: Facts, second: Facts) -> Facts:
    """Return the facts of a spec with its connectors numbered as in a second reading that has the same names.

    Connectors that only the spec has come last. The order of a spec stays where a name of the second reading is not in
    the spec, because each reader chooses names freely.
    """
    new_keys: dict[Key, Key] = {}
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

    def renumbered(key: Key) -> Key:
        return (*new_keys.get(key[:_STEPS], key[:_STEPS]), *key[_STEPS:])

    facts: dict[Key, Fact] = {}
    for key, fact in spec.facts.items():
        facts[renumbered(key)] = replace(fact, key=renumbered(fact.key), depends_on=renumbered(fact.depends_on))
    names: dict[Key, dict[Key, Fact]] = {}
    for kind, names_of_kind in spec.names.items():
        names[kind] = {}
        for key, name_fact in names_of_kind.items():
            names[kind][renumbered(key)] = replace(name_fact, key=renumbered(name_fact.key))
    return replace(spec, facts=facts, names=names)


def _connector_keys(facts: Facts) -> dict[tuple[Any, ...], dict[str, Key]]:
    """Return the key of each connector by its name, by interface and kind, in the order of their numbers."""
    keys_by_kind: dict[tuple[Any, ...], dict[str, Key]] = defaultdict(dict)
    for kind, names in facts.names.items():
        for key, name in names.items() if kind[0] == "connector" else ():
            keys_by_kind[key[: _STEPS - 1]].setdefault(str(name.value), key)
    return keys_by_kind
