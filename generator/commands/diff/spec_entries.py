"""Texts that ``diff`` writes about a new version: the ``editions`` entry of a spec, and the files of a release.

The entry describes the facts that a new edition of a manual no longer contains.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from ...changes.report import DiffResult, describe_outputs, name_change_texts
from ...changes.rules import Change, PackageVersions
from ...language.document import label_of, resolve, steps_of, value_at
from ...language.files import top_keys
from ...language.rules.numbers import HEXADECIMAL
from ...loading.history import history_beside, history_text, with_release
from ...loading.library import Family
from ...model import Release, ReleasedChange, Variant

#: Parts of a spec that editions do not describe.
_NOT_IN_EDITIONS = frozenset("manual errata examples editions documents lost_figures printed_defaults".split())
#: Keys whose value is a map with names as keys. If such a map loses a key, an item was removed.
_NAMED_MAPS = frozenset(("interfaces", "parameters", "values"))
#: Keys of a spec that the paths of changes do not contain.
_NOT_IN_CHANGES = frozenset(("combinations", "fields", "meanings", "values"))
_OPTION_PATH = re.compile(r"order_code\.parts\.(?P<part>\w+)\.values\.(?P<label>[^.]+)")
#: Keys whose values name options or whole order codes.
_KEYS_OF_REFERENCES = frozenset(("only", "only_with", "open_only_with", "order_code"))
#: Longest line of YAML, in characters. It is so long that each change is on one line.
_YAML_WIDTH = 10_000


class _Hexadecimal(int):
    """A number that manuals print in hexadecimal."""


class _Dumper(yaml.SafeDumper):
    """A writer of YAML that spells ``_Hexadecimal`` numbers with 0x."""


def _represent_hexadecimal(dumper: _Dumper, number: _Hexadecimal) -> yaml.ScalarNode:
    return dumper.represent_scalar("tag:yaml.org,2002:int", f"{number:#04x}")


_Dumper.add_representer(_Hexadecimal, _represent_hexadecimal)


def edition_entries(
    old_families: Sequence[Family], new_families: Sequence[Family], changes: Sequence[Change]
) -> Iterator[str]:
    """Yield an ``editions`` entry for each family whose manual has a new edition that no longer contains some items.

    The entry keeps these items for older encoders. Families are matched by name. Renamed items were not removed, except
    options of the order code, because the labels of older encoders have the old text.
    """
    renamings = [change for change in changes if change.rule.is_renaming and isinstance(change.old, str)]
    old_family_by_name = {family.device.name: family for family in old_families}
    for new in new_families:
        old = old_family_by_name.get(new.device.name)
        if old is None or old.device.manual.revision == new.device.manual.revision:
            continue
        renamed_paths = {_old_path(change) for change in renamings if change.family == new.device.name}
        edition_changes = list(_edition_changes(old, new, renamed_paths))
        if edition_changes:
            lines = [*_lines_of_missing_history(old, new), *_lines_of_entry(new, edition_changes)]
            yield "\n".join(lines)


def _old_path(renaming: Change) -> str:
    """Return the path of a renamed item in the old spec: ``registers.mode`` if ``registers.state`` was called mode."""
    place_of_owner, _, _ = renaming.path.rpartition(".")
    return f"{place_of_owner}.{renaming.old}"


def _path_in_changes(dotted_path: str, removed_node: Any) -> str:
    """Return the path of a removed item in the notation of changes, without some keys: ``registers.mode.busy``.

    For an item of a list, ``dotted_path`` is the list, and the item itself contains its name. For a value of a map, the
    path includes its name.
    """
    *owner_steps, last_step = map(str, steps_of(dotted_path))
    name_in_list = label_of(removed_node)
    if name_in_list is not None:
        owner_steps.append(last_step)
    owners = [step for step in owner_steps if step not in _NOT_IN_CHANGES]
    return ".".join((*owners, name_in_list or last_step))


def _lines_of_missing_history(old_family: Family, new_family: Family) -> Iterator[str]:
    """Yield the rows to add to the history of the new manual: one for each of the two revisions that is not listed.

    An introduction precedes them. If the new revision is listed after an older one, nothing is missing.
    """
    name = new_family.device.name
    revision = new_family.device.manual.revision
    listed_revisions = [listed.revision for listed in new_family.device.manual.history]
    # An edition describes encoders before a revision, so an older revision must be listed before it.
    if revision in listed_revisions[1:]:
        return
    key_of_rows = "history" if listed_revisions else "manual"
    yield f"{name}: give the revisions in the history of the manual, under '{key_of_rows}':"
    yield ""
    if not listed_revisions:
        yield "  history:"
    for manual in (old_family.device.manual, new_family.device.manual):
        if manual.revision in listed_revisions:
            continue
        history_row = {"revision": manual.revision}
        if manual.date:
            history_row["date"] = manual.date
        history_row["changes"] = "Not listed"
        yield f"    - {_as_yaml_line(history_row)}"
    yield ""


def _lines_of_entry(new_family: Family, edition_changes: Iterable[Mapping[str, Any]]) -> Iterator[str]:
    """Yield an introduction and the lines of the entry: the new revision, and the changes that apply before it.

    If the spec has no editions yet, the key ``editions`` comes first.
    """
    name = new_family.device.name
    revision = new_family.device.manual.revision
    has_editions = "editions" in new_family.document.data
    where_to_add = ", under its editions" if has_editions else ""
    removal = f"{name}: edition {revision} removed these items."
    yield f"{removal} To keep them for older encoders, add to its spec{where_to_add}, with their source:"
    yield ""
    if not has_editions:
        yield "editions:"
    # YAML writes a single text such as '1.0' with a mark for the end of the document, but not a list with this text.
    revision_in_list = _as_yaml_line([revision])
    yield f"  - revision: {revision_in_list.removeprefix('[').removesuffix(']')}"
    yield "    before:"
    for edition_change in edition_changes:
        yield f"      - {_as_yaml_line(edition_change)}"


def _edition_changes(
    old_family: Family, new_family: Family, renamed_paths: Container[str]
) -> Iterator[Mapping[str, Any]]:
    """Yield the changes that lead from the new edition back to the old one, in the form of an overlay's changes.

    Each removed item is added again: ``{"add": path, "value": item, "why": reason, "source": source}``. If options of
    the order code are among them, the changes that follow from them come last.
    """
    old_data, new_data = old_family.document.data, new_family.document.data
    old_revision, new_revision = old_family.device.manual.revision, new_family.device.manual.revision
    reason = f"Edition {old_revision} has it, edition {new_revision} does not"
    first_option_source = ""
    removed_options: list[tuple[str, Any]] = []
    for dotted_path, removed_node in _removed_nodes(old_data, new_data, dotted_path=""):
        if _path_in_changes(dotted_path, removed_node) in renamed_paths:
            continue
        source = _source_of_removed(old_data, dotted_path, removed_node)
        yield {"add": dotted_path, "value": removed_node, "why": reason, "source": source}
        if _OPTION_PATH.fullmatch(dotted_path):
            first_option_source = first_option_source or source
            removed_options.append((dotted_path, removed_node))
    if removed_options:
        yield from _order_code_changes(old_family, new_family, removed_options, first_option_source)


def _order_code_changes(
    old_family: Family, new_family: Family, removed_options: Iterable[tuple[str, Any]], source: str
) -> Iterator[Mapping[str, Any]]:
    """Yield the changes that follow from options of the order code that the new edition removed.

    The new labels of these options are removed, as are new examples with these labels. References to order codes get
    their old values. ``source`` is the citation of each change.
    """
    old_data, new_data = old_family.document.data, new_family.document.data
    old_revision, new_revision = old_family.device.manual.revision, new_family.device.manual.revision
    new_labels: list[str] = []
    for dotted_path, removed_option in removed_options:
        new_labels += _new_labels(dotted_path, removed_option, old_data, new_data)
    for dotted_path in new_labels:
        yield {"remove": dotted_path, "why": f"Edition {new_revision} has this label for it", "source": source}
    new_codes = {variant.code for variant in new_family.device.variants if _has_any_option(variant, new_labels)}
    old_examples = {example["name"] for example in old_data.get("examples", ())}
    for example in new_data.get("examples", ()):
        if example["name"] not in old_examples and example.get("order_code") in new_codes:
            reason = f"Edition {old_revision} does not have its order code"
            yield {"remove": f"examples.{example['name']}", "why": reason, "source": source}
    for dotted_path, old_reference in _changed_references(old_data, new_data, dotted_path=""):
        yield {
            "set": dotted_path,
            "to": old_reference,
            "why": f"Order codes of edition {old_revision}",
            "source": source,
        }


def _source_of_removed(data: Any, dotted_path: str, removed_node: Any) -> str:
    """Return the citation of a removed item if it names a document (``doc: 2.1``), or ``Document release``.

    A section of the old edition is not in the new one, but its table of releases says what changed.
    """
    nodes_on_path = []
    node = data
    for step in steps_of(dotted_path):
        if isinstance(node, list):
            node = {label_of(child): child for child in node}
        node = node.get(step, {}) if isinstance(node, dict) else {}
        nodes_on_path.append(node)
    # A node without a citation has the citation of the nearest node around it.
    source = ""
    for enclosing_node in (*nodes_on_path, removed_node):
        if isinstance(enclosing_node, dict):
            source = enclosing_node.get("source", source)
    cites_other_document = ":" in source
    return source if cites_other_document else "Document release"


def _new_labels(dotted_path: str, removed_option: Any, old_data: Any, new_data: Any) -> Iterator[str]:
    """Yield the place of the first new option of the order code that is a removed option with a different label.

    Both select the same interface, parameters and supply. If there is no such option, nothing is yielded.
    """
    options_path, _, _ = dotted_path.rpartition(".")
    old_options = value_at(old_data, resolve(old_data, options_path))
    new_options = value_at(new_data, resolve(new_data, options_path))
    # With ``--lenient``, a faulty spec can contain anything in place of a map.
    if not isinstance(new_options, dict):
        return
    for label, new_option in new_options.items():
        if label not in old_options and _selection_of_option(new_option) == _selection_of_option(removed_option):
            yield f"{options_path}.{label}"
            return


def _selection_of_option(option: Any) -> Mapping[str, Any]:
    """Return the interface, parameters and supply that an option selects, or its meaning if it selects none of them.

    With ``--lenient``, a faulty spec can contain anything in place of an option, which then selects nothing.
    """
    if not isinstance(option, dict):
        return {}
    selects = {key: option[key] for key in ("interface", "sets", "supply") if key in option}
    return selects or {"meaning": option.get("meaning")}


def _has_any_option(variant: Variant, option_paths: Iterable[str]) -> bool:
    """Return whether an order code has one of these options, such as ``order_code.parts.output.values.B``."""
    for option_path in option_paths:
        option_match = _OPTION_PATH.fullmatch(option_path)
        if option_match is not None and variant.parts.get(option_match["part"]) == option_match["label"]:
            return True
    return False


def _changed_references(old_node: Any, new_node: Any, dotted_path: str) -> Iterator[tuple[str, Any]]:
    """Yield the places at which two specs refer to different order codes, with the value in the old spec.

    ``old_node`` and ``new_node`` are the nodes of the specs at ``dotted_path``, which is "" for the whole specs.
    """
    if isinstance(old_node, dict) and isinstance(new_node, dict):
        common_keys = [key for key in old_node if key in new_node]
        for key in common_keys:
            child_path = f"{dotted_path}.{key}".removeprefix(".")
            old_child, new_child = old_node[key], new_node[key]
            # Of the sections that editions do not describe, only the examples name order codes.
            is_section_without_references = not dotted_path and key in _NOT_IN_EDITIONS - {"examples"}
            if not _is_reference(dotted_path, key):
                if not is_section_without_references:
                    yield from _changed_references(old_child, new_child, child_path)
            elif old_child != new_child:
                yield child_path, old_child
    elif isinstance(old_node, list) and isinstance(new_node, list):
        old_children = {label_of(child): child for child in old_node}
        for index, new_child in enumerate(new_node):
            name = label_of(new_child)
            if name is not None:
                yield from _changed_references(old_children.get(name), new_child, f"{dotted_path}.{name}")
            elif index < len(old_node):
                # Items without names are compared by their order.
                yield from _changed_references(old_node[index], new_child, f"{dotted_path}[{index + 1}]")


def _is_reference(dotted_path: str, key: str) -> bool:
    """Return whether the value of a key at a place names order codes or their options.

    ``only`` at ``registers.bank`` does, for example. Top-level keys, whose place is empty, name none.
    """
    is_top_level = not dotted_path
    is_spelling = key == "values" and "also_written" in dotted_path
    return not is_top_level and (key in _KEYS_OF_REFERENCES or is_spelling)


def _removed_nodes(old_node: Any, new_node: Any, dotted_path: str) -> Iterator[tuple[str, Any]]:
    """Yield the named items of a spec that are not in the new spec, each with the place to add it to.

    For an item of a list, this is the list: ``registers``. For a value in a map whose keys are names, it includes the
    key: ``parameters.bits``. Any other key that is missing may have been left out deliberately, so it does not count.
    ``dotted_path`` is the place of both nodes, and is "" for the whole specs.
    """
    if isinstance(old_node, dict) and isinstance(new_node, dict):
        _, _, key_of_map = dotted_path.rpartition(".")
        has_names_as_keys = key_of_map in _NAMED_MAPS
        for key, old_child in old_node.items():
            child_path = f"{dotted_path}.{key}".removeprefix(".")
            if key in new_node and key not in _NOT_IN_EDITIONS:
                yield from _removed_nodes(old_child, new_node[key], child_path)
            elif key not in new_node and has_names_as_keys:
                yield child_path, old_child
    elif isinstance(old_node, list) and isinstance(new_node, list):
        new_children = {label_of(child): child for child in new_node}
        for old_child in old_node:
            name = label_of(old_child)
            if name in new_children:
                yield from _removed_nodes(old_child, new_children[name], f"{dotted_path}.{name}")
            elif name is not None:
                yield dotted_path, old_child


def _as_yaml_line(node: Any) -> str:
    """Return a node of a spec as YAML on one line, such as ``{revision: '1.0', changes: Not listed}``."""
    yaml_text: str = yaml.dump(
        _with_hexadecimal(node),
        Dumper=_Dumper,
        default_flow_style=True,
        width=_YAML_WIDTH,
        sort_keys=False,
        allow_unicode=True,
    )
    return yaml_text.strip()


def _with_hexadecimal(node: Any, key: str = "") -> Any:
    """Mark the numbers in a node of a spec that manuals print in hexadecimal. ``key`` is the key of the node."""
    if isinstance(node, dict):
        return {name: _with_hexadecimal(child, name) for name, child in node.items()}
    if isinstance(node, list):
        return [_with_hexadecimal(child) for child in node]
    is_hexadecimal = key in HEXADECIMAL and type(node) is int
    return _Hexadecimal(node) if is_hexadecimal else node


#: The version of a package if the manufacturer's file states none.
_NO_VERSION = "0.0.0"


#: The line with the package version in a manufacturer's file. The first group precedes the number.
_VERSION_LINE = re.compile(r"^(version:[ \t]*)(['\"]?)[0-9.]+\2", re.MULTILINE)


class NotRecorded(ValueError):
    """A file cannot be updated for a release. The message names the file."""


def files_of_release(result: DiffResult, families: Sequence[Family]) -> Iterator[tuple[Path, str]]:
    """Yield the files to write for a release, with their new texts.

    These are the histories of changed families, and the manufacturer's file if its package gets a new version.
    Manufacturers without changed families are left out. Special models have no history of their own, so their changes
    are in the history of their family.

    Raises:
        NotRecorded: A manufacturer's file has no version to replace.
    """
    changed_names = {change.family for change in result.changes}
    for package in result.packages:
        families_of_package = [family for family in families if family.device.manufacturer.name == package.manufacturer]
        changed_families = [family for family in families_of_package if family.device.name in changed_names]
        if not changed_families:
            continue
        if package.new != package.stated:
            yield from _files_with_new_version(package, _files_of_manufacturer(families_of_package))
        families_by_spec: dict[str, list[Family]] = {}
        for family in changed_families:
            families_by_spec.setdefault(family.document.file, []).append(family)
        for file, families_of_spec in families_by_spec.items():
            release = _release_of(families_of_spec, package, result)
            earlier_releases = families_of_spec[0].device.releases
            yield history_beside(Path(file)), history_text(with_release(earlier_releases, release))


def _files_of_manufacturer(families: Iterable[Family]) -> set[str]:
    """Return the files that describe the manufacturer of these families: all files except their specs and overlays."""
    files: set[str] = set()
    for family in families:
        files |= family.files - {family.document.file}
    return {file for file in files if "overlay" not in (top_keys(Path(file)) or ())}


def _files_with_new_version(package: PackageVersions, files: set[str]) -> Iterator[tuple[Path, str]]:
    """Yield each file with its text, in which the version of the package is replaced by the new one.

    A file without a version, such as one that ``codewheel new`` wrote, gets a line at its end.

    Raises:
        NotRecorded: The version of a file is not on a line of its own, or several lines contain it.
    """
    for path in map(Path, sorted(files)):
        old_text = path.read_text(encoding="utf-8")
        new_text, replacement_count = _VERSION_LINE.subn(rf'\g<1>"{package.new}"', old_text)
        if replacement_count == 0 and package.stated == _NO_VERSION:
            new_text = f'{old_text.rstrip()}\nversion: "{package.new}"\n'
        elif replacement_count != 1:
            raise NotRecorded(f'{path} has no line like version: "{package.stated}"; set it to {package.new} by hand')
        yield path, new_text


def _release_of(families: Sequence[Family], package: PackageVersions, result: DiffResult) -> Release:
    """Return a release for the history of a spec, with the edition of the manual, all changes and the changed names.

    ``families`` are the family of this spec and its special models, if they have changed. A change that concerns
    several of them is listed once.
    """
    manual = families[0].device.manual
    manual_text = f"{manual.revision} of {manual.date}" if manual.date else manual.revision
    changes: list[ReleasedChange] = []
    names: list[str] = []
    for family in families:
        name = family.device.name
        changes += [_released_change(change) for change in result.changes if change.family == name]
        names += name_change_texts(result, name)
    return Release(
        version=package.new,
        since=package.old,
        manual=manual_text,
        changes=tuple(dict.fromkeys(changes)),
        names=tuple(dict.fromkeys(names)),
    )


def _released_change(change: Change) -> ReleasedChange:
    """Return a change as the history of releases records it."""
    return ReleasedChange(
        rule=change.rule.name,
        impact=change.impact.word,
        text=change.text,
        reach=change.affected_codes_text,
        outputs=describe_outputs(change),
    )
