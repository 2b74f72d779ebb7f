"""Iterators over the plain data and the texts of a spec, for rules about any text or number.

The data may have any structure, so every function here checks it. ``parts.py`` contains the iterators over typed parts.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from ..document import Document, child_at, label_of
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, Path
from ..schemas import PROSE
from .parts import KEYS_OMITTED_BY_ERRATA, PlacedPart

#: A part of a spec, in which any key can have any value.
Data = Mapping[str, object]


def mapping(root: object, *keys: str) -> Data:
    """Return the map that is reached by following ``keys`` from the map ``root``, or an empty map if there is none."""
    node = root
    for key in keys:
        node = node.get(key) if isinstance(node, dict) else None
    return node if isinstance(node, dict) else {}


def maps_in_list(root: object, *keys: str) -> Iterator[tuple[Path, Data]]:
    """Yield the maps in the list that is reached by following ``keys``, each with its path.

    For ``("manual", "editions")`` these have paths such as ``("manual", "editions", 0)``.
    """
    *outer_keys, key_of_list = keys
    list_value = mapping(root, *outer_keys).get(key_of_list)
    for index, list_item in enumerate(list_value if isinstance(list_value, list) else ()):
        if isinstance(list_item, dict):
            yield (*keys, index), list_item


def leaves_of(spec: Data, report: DocumentReport) -> Sequence[tuple[Path, object]]:
    """Return every value of a spec that is neither a map nor a list, with its path.

    The report keeps the result for the last spec, because one rule after another needs it.
    """
    spec_of_leaves, _ = report.leaves
    # Compared by identity, because comparing the contents would take as long as collecting them.
    if spec_of_leaves is not spec:
        report.leaves = (spec, leaves(spec))
    _, located_values = report.leaves
    return located_values


def leaves(root: object) -> list[tuple[Path, object]]:
    """Return every value that is neither a map nor a list, with its path."""
    located_values: list[tuple[Path, object]] = []
    _add_leaves(root, (), located_values)
    return located_values


def _add_leaves(node: object, path: Path, located_values: list[tuple[Path, object]]) -> None:
    """Add every value below a place that is neither a map nor a list, with its path."""
    if isinstance(node, dict):
        for key, child in node.items():
            _add_leaves(child, (*path, key), located_values)
    elif isinstance(node, list):
        for index, child in enumerate(node):
            _add_leaves(child, (*path, index), located_values)
    else:
        located_values.append((path, node))


def sources(located_values: Iterable[tuple[Path, object]]) -> Iterator[tuple[Path, str]]:
    """Yield every text among these values that is under a key for a source, with its path."""
    for path, value in located_values:
        if isinstance(value, str) and (path[-1] == "source" or str(path[-1]).endswith("_source")):
            yield path, value


def next_steps(node: object) -> Iterator[tuple[str, object]]:
    """Yield the possible next steps of a path from a map or list, each with the data to which it leads.

    From a map, these are its keys, the names of parts in its lists, and the names in ``values``: in
    ``interfaces.biss.word``, ``word`` is a part in the list ``layouts``. From a list, these are the names of its parts,
    and the keys of parts without names, such as clocks.
    """
    if isinstance(node, list):
        for element in node:
            if isinstance(element, dict) and "name" not in element:
                yield from element.items()
        yield from _named_parts(node)
    elif isinstance(node, dict):
        for key, value in node.items():
            if isinstance(value, list):
                yield from _named_parts(value)
            elif key == "values" and isinstance(value, dict):
                yield from value.items()
        yield from node.items()  # Last, so that a key takes precedence over a name.


def _named_parts(elements: list[object]) -> Iterator[tuple[str, object]]:
    """Yield each element of a list that is a map with a name, after its name."""
    for element in elements:
        if isinstance(element, dict) and "name" in element:
            yield str(element["name"]), element


_TODO_MARKER = re.compile(r"\bTODO\b")


def is_placeholder(value: object) -> bool:
    """Return True if a value is text with the word TODO, which marks a source that is still to be added."""
    return isinstance(value, str) and _TODO_MARKER.search(value) is not None


def placeholder_paths(root: object, path: Path = ()) -> Iterator[Path]:
    """Yield the path of each placeholder, a text with TODO, in the data of a spec, in its order."""
    if isinstance(root, dict):
        for key, value in root.items():
            yield from placeholder_paths(value, (*path, key))
    elif isinstance(root, list):
        for index, value in enumerate(root):
            yield from placeholder_paths(value, (*path, index))
    elif is_placeholder(root):
        yield path


def placeholder_names(spec_data: Data) -> list[str]:
    """Return the names of all parts of a spec that contain a placeholder, a text with TODO, each once."""
    names = (placeholder_name(spec_data, path) for path in placeholder_paths(spec_data))
    return list(dict.fromkeys(names))


def placeholder_name(spec_data: Data, path: Path) -> str:
    """Return the name of the placeholder at ``path``, a text with TODO.

    If it is a source, it is the name of the part with this source, such as ``registers.preset``.
    """
    path_of_part = path[:-1] if path[-1] == "source" and len(path) > 1 else path
    return as_affected(spec_data, path_of_part) or str(path[0])


#: Texts about the encoder of today.
KEYS_OF_TEXTS = (PROSE | {"used"}) - {"title", "why", "changes", "source"}
SECTIONS_NOT_ABOUT_ENCODER = frozenset(("documents", "manual", "editions", "evidence", "lost_figures"))


def is_derived(document: Document) -> bool:
    """Return True for an overlay or an older edition, which changes facts without changing every text about them."""
    return bool(document.family or document.other_files)


def texts_about_encoder(spec: WrittenSpec, keys: Collection[str], report: DocumentReport) -> Iterator[tuple[Path, str]]:
    """Yield each text under one of these keys with its path, except texts about other documents."""
    for path, text in leaves_of(spec.data, report):
        is_about_encoder = path[0] not in SECTIONS_NOT_ABOUT_ENCODER
        if isinstance(text, str) and is_about_encoder and path[-1] in keys:
            yield path, text


KEYS_OF_EXPLANATIONS = (
    "meaning",
    "note",
    "remedy",
    "detected",
    "precondition",
    "result",
    "when_active",
    "when_inactive",
)


def texts_of(placed_part: PlacedPart, keys: Sequence[str]) -> Iterator[tuple[Path, str]]:
    """Yield the texts of a part under these keys, with their paths."""
    for key in keys:
        text = placed_part.data.get(key)
        if isinstance(text, str):
            yield (*placed_part.path, key), text


#: Texts that quote the manual, or are about other documents.
SECTIONS_ON_OTHER_DOCUMENTS = frozenset(("documents", "editions", "evidence"))
_KEYS_THAT_QUOTE = frozenset(("printed", "title", "why"))


def texts_in_our_words(spec: WrittenSpec, report: DocumentReport) -> Iterator[tuple[Path, str]]:
    """Yield the texts of a spec that neither quote the manual nor describe other documents, with their paths."""
    for path, text in leaves_of(spec.data, report):
        section, key = path[0], path[-1]
        is_prose = key in PROSE or (section, key) == ("characteristics", "value")
        is_quotation = key in _KEYS_THAT_QUOTE
        is_about_other_document = section in SECTIONS_ON_OTHER_DOCUMENTS
        is_in_our_words = is_prose and not is_quotation and not is_about_other_document
        if isinstance(text, str) and is_in_our_words:
            yield path, text


_CHARACTER_NOT_IN_NAMES = re.compile(r"[^a-z0-9_]")


def as_affected(root: object, path: Path) -> str:
    """Return a path in the form used by errata: ``registers.preset`` or ``interfaces.biss.word.crc``.

    Elements of lists are given by their names, and keys such as ``layouts`` below the top level are omitted. The path
    ends before the first element without a name.
    """
    named_steps: list[str] = []
    node = root
    for depth, step in enumerate(path):
        node = child_at(node, step)
        is_list_item = isinstance(step, int)
        step_name = label_of(node) if is_list_item else str(step)
        if step_name is None or _CHARACTER_NOT_IN_NAMES.search(step_name):
            break
        is_omitted = step_name in KEYS_OMITTED_BY_ERRATA and not is_list_item and depth > 0
        if not is_omitted:
            named_steps.append(step_name)
    return ".".join(named_steps)


class ErratumTargets:
    """Finds the values to which the paths in ``affects`` of errata refer, in data that do not change."""

    def __init__(self, data: object) -> None:
        self._data = data
        #: Items by name, for each list that was searched. Its id is the key, because a list cannot be one.
        self._named_items_by_list_id: dict[int, dict[object, list[object]]] = {}

    def values_at(self, affected: str) -> list[object]:
        """Return every value in the data to which a path such as ``registers.preset`` refers."""
        nodes = [self._data]  # Everything to which the steps so far refer.
        for step in affected.split("."):
            nodes = [found_value for node in nodes for found_value in self._find_named(node, step)]
        return nodes

    def _find_named(self, node: object, step: str) -> list[object]:
        """Return the values to which one step of a path can lead from a map or list.

        The step can be a key of the map, or the name of an element of the list, or of a list in the map.
        """
        if isinstance(node, list):
            return self._items_by_name(node).get(step, [])
        if not isinstance(node, dict):
            return []
        found_values = [node[step]] if step in node else []
        # Paths of errata omit the lists of fields, layouts and steps, and the map of values.
        for key, child in node.items():
            if isinstance(child, list):
                found_values += self._items_by_name(child).get(step, [])
            elif key == "values" and isinstance(child, dict) and step in child:
                found_values.append(child[step])
        return found_values

    def _items_by_name(self, items: list[object]) -> dict[object, list[object]]:
        """Return the items of a list by their names, each with all items of this name."""
        if id(items) not in self._named_items_by_list_id:
            items_by_name: dict[object, list[object]] = {}
            for list_item in items:
                if isinstance(list_item, dict) and isinstance(list_item.get("name"), str):
                    items_by_name.setdefault(list_item["name"], []).append(list_item)
            self._named_items_by_list_id[id(items)] = items_by_name
        return self._named_items_by_list_id[id(items)]


def names_of_characteristics(spec_data: Mapping[str, object]) -> set[str]:
    """Return the names of the characteristics in the data of a spec, which may be invalid."""
    characteristics = spec_data.get("characteristics")
    if not isinstance(characteristics, list):
        return set()
    names = [characteristic.get("name") for characteristic in characteristics if isinstance(characteristic, dict)]
    return {name for name in names if isinstance(name, str)}


def without_steps(node: object, removed_names: Collection[str]) -> object:
    """Return the data of a spec without the names of removed characteristics in ``by_hand``.

    ``by_hand`` lists characteristics with steps for a person. The key is removed if no name remains.
    """
    if isinstance(node, list):
        return [without_steps(child, removed_names) for child in node]
    if not isinstance(node, dict):
        return node
    cleaned = {}
    for key, child in node.items():
        if key in ("join", "when"):  # Their keys are names of the spec, not keys of the language.
            cleaned[key] = child
        elif key == "by_hand" and isinstance(child, list):
            remaining_steps = [name for name in child if name not in removed_names]
            if remaining_steps:
                cleaned[key] = remaining_steps
        else:
            cleaned[key] = without_steps(child, removed_names)
    return cleaned


def without_removed_paths(spec_data: dict[str, object], original_data: dict[str, object]) -> dict[str, object]:
    """Return the data of a spec whose errata no longer affect places that a layer has removed.

    A path that does not exist in the original data either stays, because a rule reports it.
    """
    errata = spec_data.get("errata")
    if not isinstance(errata, list):
        return spec_data
    targets = ErratumTargets(spec_data)
    original_targets = ErratumTargets(original_data)
    remaining_errata = [_erratum_without_removed_paths(erratum, targets, original_targets) for erratum in errata]
    return {**spec_data, "errata": remaining_errata}


def _erratum_without_removed_paths(
    erratum: object, targets: ErratumTargets, original_targets: ErratumTargets
) -> object:
    """Return an erratum without the paths in ``affects`` that exist only in the original data."""
    if not isinstance(erratum, dict):
        return erratum
    affects = erratum.get("affects")
    if not isinstance(affects, list):
        return erratum
    removed_paths = {path for path in affects if original_targets.values_at(path) and not targets.values_at(path)}
    if not removed_paths:
        return erratum
    return {**erratum, "affects": [path for path in affects if path not in removed_paths]}
