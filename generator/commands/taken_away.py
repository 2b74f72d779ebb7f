"""The ``editions`` entry for the facts that a new edition of a manual no longer has."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import yaml

from ..changes.change import Change
from ..language.document import label_of
from ..language.rules.bases import HEXADECIMAL
from ..loading.library import Family

#: Parts of a spec that editions do not describe.
_APART = frozenset("manual errata examples editions documents lost_figures printed_defaults".split())
#: Maps of named items.
_MAPS = frozenset(("interfaces", "parameters", "values"))
_WIDTH = 10_000


class _Hexadecimal(int):
    """A number that manuals print in hexadecimal."""


class _Dumper(yaml.SafeDumper):
    """A writer of YAML that spells such numbers with 0x."""


_Dumper.add_representer(_Hexadecimal, lambda made, item: made.represent_scalar("tag:yaml.org,2002:int", f"{item:#04x}"))


def offers(olds: Sequence[Family], news: Sequence[Family], changes: Sequence[Change]) -> Iterator[str]:
    """Yield, for each family with a new edition that lacks items of the old one, the entry that keeps them.

    Renamed items are still there.
    """
    renamed = {(item.family, item.old) for item in changes if item.rule.name.endswith("-renamed")}
    before = {family.device.name: family for family in olds}
    for family in news:
        old = before.get(family.device.name)
        revision = family.device.manual.revision
        if old is None or old.device.manual.revision == revision:
            continue
        found = _gone(old.document.data, family.document.data, "")
        name = family.device.name
        gone = [item for item in found if (name, label_of(item[1]) or item[0].rpartition(".")[2]) not in renamed]
        if gone:
            told = f"Edition {old.device.manual.revision} has it, edition {revision} does not"
            entries = [{"add": place, "value": item, "why": told, "source": "Document release"} for place, item in gone]
            lines = [
                f'  - revision: "{revision}"',
                "    before:",
                *(f"      - {_in_one_line(item)}" for item in entries),
            ]
            begin = (
                f"{family.device.name}: edition {revision} removed these items. To keep them for older encoders, add"
            )
            yield "\n".join([f"{begin} to its spec, with their source:", "", "editions:", *lines])


def _gone(old: Any, new: Any, place: str) -> Iterator[tuple[str, Any]]:
    """Yield the removed items: the place to add each to, and the item."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key, item in old.items():
            further = f"{place}.{key}".removeprefix(".")
            if key in new and key not in _APART:
                yield from _gone(item, new[key], further)
            elif key not in new and place.rpartition(".")[2] in _MAPS:
                yield further, item
    elif isinstance(old, list) and isinstance(new, list):
        kept = {label_of(item): item for item in new}
        for item in old:
            name = label_of(item)
            if name in kept:
                yield from _gone(item, kept[name], f"{place}.{name}")
            elif name is not None:
                yield place, item


def _in_one_line(item: Any) -> str:
    text: str = yaml.dump(
        _spelled(item), Dumper=_Dumper, default_flow_style=True, width=_WIDTH, sort_keys=False, allow_unicode=True
    )
    return text.strip()


def _spelled(item: Any, key: str = "") -> Any:
    if isinstance(item, dict):
        return {name: _spelled(value, name) for name, value in item.items()}
    if isinstance(item, list):
        return [_spelled(value) for value in item]
    return _Hexadecimal(item) if key in HEXADECIMAL and type(item) is int else item
