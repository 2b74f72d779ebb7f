"""The ``editions`` entry for the facts that a new edition of a manual no longer has."""

from __future__ import annotations

import re
from collections.abc import Container, Iterator, Mapping, Sequence
from typing import Any

import yaml

from ..changes.change import Change
from ..language.document import label_of
from ..language.places import resolve, steps_of, value_at
from ..language.rules.bases import HEXADECIMAL
from ..loading.library import Family
from ..model import Variant

#: Parts of a spec that editions do not describe.
_APART = frozenset("manual errata examples editions documents lost_figures printed_defaults".split())
#: Maps of named items.
_MAPS = frozenset(("interfaces", "parameters", "values"))
_OPTION = re.compile(r"order_code\.parts\.(?P<part>\w+)\.values\.(?P<label>[^.]+)")
#: Keys whose values name options or whole order codes.
_REFERENCES = frozenset(("only", "only_with", "open_only_with", "order_code"))
_WIDTH = 10_000


class _Hexadecimal(int):
    """A number that manuals print in hexadecimal."""


class _Dumper(yaml.SafeDumper):
    """A writer of YAML that spells such numbers with 0x."""


_Dumper.add_representer(
    _Hexadecimal, lambda dumper, number: dumper.represent_scalar("tag:yaml.org,2002:int", f"{number:#04x}")
)


def offers(olds: Sequence[Family], news: Sequence[Family], changes: Sequence[Change]) -> Iterator[str]:
    """Yield, for each family with a new edition that lacks items of the old one, the entry that keeps them.

    Renamed items are still there, except options of the order code: labels of older encoders have the old text.
    """
    renamed = {(change.family, change.old) for change in changes if change.rule.name.endswith("-renamed")}
    old_families = {family.device.name: family for family in olds}
    for family in news:
        old = old_families.get(family.device.name)
        if old is None or old.device.manual.revision == family.device.manual.revision:
            continue
        old_names = {old_name for name, old_name in renamed if name == family.device.name and isinstance(old_name, str)}
        if entries := list(_entries(old, family, old_names)):
            yield "\n".join(_offer(old, family, entries))


def _offer(old: Family, new: Family, entries: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    name, revision = new.device.name, new.device.manual.revision
    introduction = f"{name}: edition {revision} removed these items. To keep them for older encoders, add to its spec"
    history = [history_row["revision"] for history_row in new.document.data["manual"].get("history", ())]
    if revision not in history[1:]:
        yield f"{name}: give the revisions in the history of the manual, under '{'history' if history else 'manual'}':"
        yield ""
        if not history:
            yield "  history:"
        for listed_manual in (
            manual for manual in (old.device.manual, new.device.manual) if manual.revision not in history
        ):
            row = {
                "revision": listed_manual.revision,
                **({"date": listed_manual.date} if listed_manual.date else {}),
                "changes": "Not listed",
            }
            yield f"    - {_in_one_line(row)}"
        yield ""
    has_editions = "editions" in new.document.data
    yield f"{introduction}{', under its editions' * has_editions}, with their source:"
    yield ""
    if not has_editions:
        yield "editions:"
    yield f"  - revision: {_in_one_line([revision])[1:-1]}"
    yield "    before:"
    yield from (f"      - {_in_one_line(edition_change)}" for edition_change in entries)


def _entries(old: Family, new: Family, renamed: Container[str]) -> Iterator[Mapping[str, Any]]:
    """Yield the changes that lead from the new edition to the old one."""
    old_data, new_data = old.document.data, new.document.data
    old_revision, new_revision = old.device.manual.revision, new.device.manual.revision
    removed_parts = [
        (place, spec_part)
        for place, spec_part in _gone(old_data, new_data, "")
        if (label_of(spec_part) or place.rpartition(".")[2]) not in renamed
    ]
    removed = f"Edition {old_revision} has it, edition {new_revision} does not"
    sources = {place: _source(old_data, place, spec_part) for place, spec_part in removed_parts}
    yield from (
        {"add": place, "value": spec_part, "why": removed, "source": sources[place]}
        for place, spec_part in removed_parts
    )
    options = [(place, spec_part) for place, spec_part in removed_parts if _OPTION.fullmatch(place)]
    if not options:
        return
    source = sources[options[0][0]]
    labels = [label for place, spec_part in options for label in _other_labels(place, spec_part, old_data, new_data)]
    for place in labels:
        yield {"remove": place, "why": f"Edition {new_revision} has this label for it", "source": source}
    examples = {example["name"] for example in old_data.get("examples", ())}
    codes = {variant.code for variant in new.device.variants if any(_selects(variant, place) for place in labels)}
    for example in new_data.get("examples", ()):
        if example["name"] not in examples and example.get("order_code") in codes:
            yield {
                "remove": f"examples.{example['name']}",
                "why": f"Edition {old_revision} lacks its order code",
                "source": source,
            }
    for place, value in _references(old_data, new_data, ""):
        yield {"set": place, "to": value, "why": f"Order codes of edition {old_revision}", "source": source}


def _source(data: Any, place: str, spec_part: Any) -> str:
    """Return the source of an item if that is a document other than the manual, else the table of revisions."""
    source, node = "", data
    for step in steps_of(place):
        children = {label_of(child): child for child in node} if isinstance(node, list) else node
        node = children.get(step, {}) if isinstance(children, dict) else {}
        source = node.get("source", source) if isinstance(node, dict) else source
    source = spec_part.get("source", source) if isinstance(spec_part, dict) else source
    return source if ":" in source else "Document release"


def _other_labels(place: str, old: Any, old_data: Any, new_data: Any) -> Iterator[str]:
    """Yield the option that only the new edition has, if it differs from a removed one only in its label."""
    holder, _, _ = place.rpartition(".")
    olds, news = (value_at(data, resolve(data, holder)) for data in (old_data, new_data))
    for label, new in news.items():
        if label not in olds and _meant(new) == _meant(old):
            yield f"{holder}.{label}"
            return


def _meant(option: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return what an option selects, or its meaning if it selects nothing."""
    selects = {key: option[key] for key in ("interface", "sets", "supply") if key in option}
    return selects or {"meaning": option.get("meaning")}


def _selects(variant: Variant, place: str) -> bool:
    option = _OPTION.fullmatch(place)
    return option is not None and variant.parts.get(option["part"]) == option["label"]


def _references(old: Any, new: Any, place: str) -> Iterator[tuple[str, Any]]:
    """Yield the places in both editions that refer to different order codes, and the value in the old one."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [key for key in old if key in new]:
            child_place = f"{place}.{key}".removeprefix(".")
            if place and (key in _REFERENCES or (key == "values" and "also_written" in place)):
                yield from [(child_place, old[key])] if old[key] != new[key] else []
            elif place or key not in _APART - {"examples"}:
                yield from _references(old[key], new[key], child_place)
    elif isinstance(old, list) and isinstance(new, list):
        children_by_label = {label_of(child): child for child in old}
        for index, child in enumerate(new):
            label = label_of(child)
            step = f"[{index + 1}]" if label is None else f".{label}"
            old_child = children_by_label.get(label) if label is not None else old[index] if index < len(old) else None
            yield from _references(old_child, child, f"{place}{step}")


def _gone(old: Any, new: Any, place: str) -> Iterator[tuple[str, Any]]:
    """Yield the removed items: the place to add each to, and the item."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key, child in old.items():
            child_place = f"{place}.{key}".removeprefix(".")
            if key in new and key not in _APART:
                yield from _gone(child, new[key], child_place)
            elif key not in new and place.rpartition(".")[2] in _MAPS:
                yield child_place, child
    elif isinstance(old, list) and isinstance(new, list):
        new_children = {label_of(child): child for child in new}
        for child in old:
            name = label_of(child)
            if name in new_children:
                yield from _gone(child, new_children[name], f"{place}.{name}")
            elif name is not None:
                yield place, child


def _in_one_line(node: Any) -> str:
    text: str = yaml.dump(
        _spelled(node), Dumper=_Dumper, default_flow_style=True, width=_WIDTH, sort_keys=False, allow_unicode=True
    )
    return text.strip()


def _spelled(node: Any, key: str = "") -> Any:
    if isinstance(node, dict):
        return {name: _spelled(value, name) for name, value in node.items()}
    if isinstance(node, list):
        return [_spelled(value) for value in node]
    return _Hexadecimal(node) if key in HEXADECIMAL and type(node) is int else node
