"""Overlays: changes applied to a spec, each with its reason and its source.

The result is a document like any other. Each value records the file that it comes from, so that later problems with
them are reported in the overlay. Changes that cannot be applied are reported here: places that do not exist, values
that are already there, and two changes to the same place.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path as File
from typing import Any

from .document import (
    Document,
    MissingPath,
    Path,
    from_file,
    label_of,
    mark_at,
    named_path,
    resolve,
    value_at,
    with_value,
    without_value,
)
from .keys_of_specs import WrittenSpec
from .problems import ProblemReport, quoted, suggest_word
from .rules.manual import check_source_format
from .rules.walk import ErratumTargets, as_affected, names_of_characteristics, without_removed_paths, without_steps

#: Suffix of overlays found next to their spec: ``FAMILY.overlay.yaml``, ``FAMILY.x.overlay.yaml``.
SUFFIX = ".overlay"
#: Kinds of changes. Each change has exactly one.
CHANGE_KINDS = ("set", "add", "remove", "unknown", "also")
_VALUE_KEY_BY_CHANGE_KIND = {"set": "to", "add": "value"}
#: Keys that no change may touch: they identify the family, or do not state a fact of the manual.
_UNCHANGEABLE_KEYS = frozenset("codewheel device manufacturer editions".split())
#: Longest value shown in a comment, in characters.
_LONGEST_SHOWN = 120


class LayerKind(Enum):
    """Origin of changes: an overlay of the user, or another edition of the manual."""

    OVERLAY = "overlay"
    EDITION = "edition"


@dataclass(frozen=True, slots=True)
class OverlayLayer:
    """A list of changes to a spec, with its place and the name used for it in outputs."""

    document: Document
    path: Path
    kind: LayerKind
    name: str

    @property
    def changes(self) -> Sequence[Mapping[str, Any]]:
        changes: Sequence[Mapping[str, Any]] = value_at(self.document.data, self.path)
        return changes


@dataclass(frozen=True, slots=True)
class AppliedChange:
    """A change that was applied: texts for the value before (``was``) and after it (``now``), and the affected paths.

    ``number`` is the index of the change in its layer. ``now`` is empty if there is no new value. Then ``is_known`` is
    False if the value is unknown rather than absent. A change of the kind ``also`` has only its text, in ``was``, and
    ``is_known`` is False.
    """

    layer: OverlayLayer
    number: int
    was: str
    now: str
    affects: tuple[str, ...]
    is_known: bool

    @property
    def raw(self) -> Mapping[str, Any]:
        return self.layer.changes[self.number]


@dataclass(frozen=True, slots=True)
class _Change:
    """A change of a layer, with its index there and its kind, one of ``CHANGE_KINDS``."""

    layer: OverlayLayer
    number: int
    kind: str

    @property
    def data(self) -> Mapping[str, Any]:
        """The change as it is in the file."""
        return self.layer.changes[self.number]

    @property
    def path(self) -> Path:
        """Path of the change in its file."""
        return (*self.layer.path, self.number)

    @property
    def key_of_value(self) -> str:
        """Key of the new value, or an empty string for a kind of change without a new value."""
        return _VALUE_KEY_BY_CHANGE_KIND.get(self.kind, "")

    @property
    def new_value(self) -> Any:
        """The value to set or to add. Only for changes with a ``key_of_value``."""
        return self.data[self.key_of_value]


@dataclass(frozen=True, slots=True)
class _Target:
    """A place of the spec that a change affects, as its text in the file, such as ``registers.status.default``.

    ``index`` is the index of the text in the list of places, or None if the change has a single place.
    """

    change: _Change
    place_text: str
    index: int | None

    @property
    def path_of_text(self) -> Path:
        """Path of the text in the file of the change."""
        path: Path = (*self.change.path, self.change.kind)
        return path if self.index is None else (*path, self.index)

    @property
    def short_place(self) -> str:
        """The place in texts about the change."""
        return self.place_text.removeprefix("registers.")


class LayeredSpec:
    """A spec to which layers are applied one after the other."""

    def __init__(self, base: Document, report: ProblemReport) -> None:
        self._base = base
        self._report = report
        self._data = base.data
        self._marks = base.marks
        self._other_files: dict[str, tuple[str, ...]] = dict(base.other_files)
        #: The change that affects each place.
        self._reserved_places: dict[Path, _Change] = {}
        self.applied: list[AppliedChange] = []

    def document(self, family: str = "") -> Document:
        """Return the spec in its current state, renamed to ``family`` if given.

        References of errata and of remedies to places that a change removed are left out.
        """
        data: Any = self._data
        if self.applied:
            data = without_removed_paths(data, self._base.data)
            removed_names = names_of_characteristics(self._base.data) - names_of_characteristics(data)
            if removed_names:
                data = without_steps(data, removed_names)
        if family:
            data = {**data, "device": family}
        return replace(
            self._base,
            data=data,
            marks=self._marks,
            other_files=self._other_files,
            family=family or self._base.family,
            kept_indices={},
        )

    def apply(self, layers: Sequence[OverlayLayer]) -> None:
        """Apply the changes of layers to the spec. Two changes must not affect the same place.

        A change that cannot be applied is reported and left out.
        """
        self._reserved_places = {}
        for layer in layers:
            if layer.document.file != self._base.file:  # The layer of an edition is in the spec itself.
                self._other_files[layer.document.file] = layer.document.lines
            self._add_documents(layer)
            for change_number in range(len(layer.changes)):
                change_kind = self._kind_of_change(layer, change_number)
                if change_kind is None:
                    continue
                change = _Change(layer, change_number, change_kind)
                if self._has_value(change):
                    self._apply_change(change)

    def _kind_of_change(self, layer: OverlayLayer, number: int) -> str | None:
        """Return the kind of a change. If it has no kind or several, report it and return None."""
        given_kinds = [kind for kind in CHANGE_KINDS if kind in layer.changes[number]]
        if len(given_kinds) == 1:
            return given_kinds[0]
        problem = f"has {' and '.join(map(quoted, given_kinds))}" if given_kinds else "does nothing"
        message = f"this change {problem}; use exactly one of 'set', 'add', 'remove', 'unknown' and 'also'"
        self._report.add("overlay-change", layer.document, (*layer.path, number), message)
        return None

    def _has_value(self, change: _Change) -> bool:
        """Return True if a change has the key for its new value, and no other key for one. Report it otherwise.

        ``set`` needs ``to``, and ``add`` needs ``value``. Other kinds of changes have no new value.
        """
        for key in _VALUE_KEY_BY_CHANGE_KIND.values():
            is_needed = key == change.key_of_value
            is_given = key in change.data
            if is_given != is_needed:
                verb = "needs" if is_needed else "cannot have"
                message = f"a change with {quoted(change.kind)} {verb} {quoted(key)}"
                self._report.add("overlay-change", change.layer.document, change.path, message)
                return False
        return True

    def _add_documents(self, layer: OverlayLayer) -> None:
        """Add the documents that an overlay cites to the spec, and check the sources of the overlay.

        A layer of an edition cites only documents of the spec, so nothing is done.
        """
        if layer.kind is not LayerKind.OVERLAY:
            return
        overlay = layer.document
        for key, cited_document in overlay.data.get("documents", {}).items():
            documents = self._data.get("documents")
            if not documents:
                # An empty map first, to which the document is added below.
                documents_mark = replace(mark_at(overlay.marks, ("documents",)), children={}, file=overlay.file)
                self._data, self._marks = with_value(self._data, self._marks, ("documents",), {}, documents_mark)
            elif key in documents and documents[key] != cited_document:
                message = f"{quoted(key)} is a different document in the spec; rename this one"
                self._report.add("overlay-conflict", overlay, ("documents", key), message, at_key=True)
                continue
            path = ("documents", key)
            mark = from_file(mark_at(overlay.marks, path), overlay.file)
            self._data, self._marks = with_value(self._data, self._marks, path, cited_document, mark)
        overlay_as_spec = WrittenSpec(overlay.data, with_invalid_parts=WrittenSpec(self._data))
        check_source_format(overlay_as_spec, self._report.for_document(overlay))

    def _apply_change(self, change: _Change) -> None:
        """Apply a change to each place of the spec that it lists. A change of the kind ``also`` only records a text."""
        place_or_places = change.data[change.kind]
        if change.kind == "also":
            self._record_change(change, was=place_or_places, now="", affects="", is_known=False)
            return
        is_list = isinstance(place_or_places, list)
        for index, place_text in enumerate(place_or_places if is_list else [place_or_places]):
            target = _Target(change, place_text, index if is_list else None)
            first_step, _, _ = place_text.partition(".")
            if first_step in _UNCHANGEABLE_KEYS:
                message = f"an overlay cannot change {quoted(place_text)}, only facts about the encoder"
                self._report_problem("overlay-change", target, message)
            elif change.kind == "add":
                self._add_value(target)
            else:
                self._set_or_remove(target)

    def _add_value(self, target: _Target) -> None:
        """Add the value of a change to the spec: under a new key, or at the end of a list without such an element."""
        try:
            path = resolve(self._data, target.place_text)
        except MissingPath as missing_path:
            self._add_key(target, missing_path)
            return
        current_value = value_at(self._data, path)
        label = label_of(target.change.new_value)
        place = quoted(target.place_text)
        if not isinstance(current_value, list):
            self._report_problem("overlay-unused", target, f"{place} already exists; change it with 'set'")
        elif label is not None and label in map(label_of, current_value):
            message = f"{place} already has {quoted(label)}; change it with 'set'"
            self._report_problem("overlay-unused", target, message)
        else:
            path_of_new_item = (*path, len(current_value))
            self._put_value(target, path_of_new_item, was=f"{target.short_place} without this item")

    def _add_key(self, target: _Target, missing_path: MissingPath) -> None:
        """Add the value of a change at a new key of an existing map. Only that key, the last step, may be missing."""
        _, _, last_step = target.place_text.rpartition(".")
        parent = value_at(self._data, missing_path.existing_path)
        if missing_path.step != last_step or not isinstance(parent, dict):
            self._report_missing_place(target, missing_path)
            return
        path = (*missing_path.existing_path, missing_path.step)
        if self._reserve_place(target, path):
            self._put_value(target, path, was=f"no {target.short_place}")

    def _set_or_remove(self, target: _Target) -> None:
        """Replace the value at an existing place with the value of a change, or remove it if the change says so."""
        try:
            path = resolve(self._data, target.place_text)
        except MissingPath as missing_path:
            self._report_missing_place(target, missing_path)
            return
        if not self._reserve_place(target, path):
            return
        if target.change.kind == "set":
            self._replace_value(target, path)
        else:
            self._remove_value(target, path)

    def _replace_value(self, target: _Target, path: Path) -> None:
        """Replace the value at ``path`` with the value of a change. Report the change if both are the same."""
        current_value = value_at(self._data, path)
        current_text = _shortened_value_text(current_value, self._line_from_value(path))
        if _is_equal(target.change.new_value, current_value):
            message = f"the spec already has {current_text} here; leave the change out"
            self._report_problem("overlay-unused", target, message)
        else:
            self._put_value(target, path, was=f"{target.short_place}: {current_text}")

    def _remove_value(self, target: _Target, path: Path) -> None:
        """Remove the value at ``path`` from the spec, and record the change.

        The recorded place is the value or, if nothing has its name afterwards, the part that contained it. A change of
        the kind ``unknown`` says that the value is unknown rather than absent.
        """
        affected = as_affected(self._data, path)
        affected_parent = as_affected(self._data, path[:-1])
        self._data, self._marks = without_value(self._data, self._marks, path)
        # Such as another field of this name.
        has_remaining_value = bool(ErratumTargets(self._data).values_at(affected))
        affects = affected if has_remaining_value else affected_parent
        is_known = target.change.kind != "unknown"
        self._record_change(target.change, was=target.short_place, now="", affects=affects, is_known=is_known)

    def _put_value(self, target: _Target, path: Path, *, was: str) -> None:
        """Put the value of a change at a path of the spec, and record the change with ``was``, the text before."""
        change = target.change
        overlay = change.layer.document
        mark = mark_at(overlay.marks, (*change.path, change.key_of_value))
        overlay_file = "" if overlay.file == self._base.file else overlay.file
        mark_with_file = from_file(mark, overlay_file)
        self._data, self._marks = with_value(self._data, self._marks, path, change.new_value, mark_with_file)
        text_from_value = overlay.line(mark.line)[mark.column - 1 :]
        now = _shortened_value_text(change.new_value, text_from_value)
        self._record_change(change, was=was, now=now, affects=as_affected(self._data, path), is_known=True)

    def _record_change(self, change: _Change, *, was: str, now: str, affects: str, is_known: bool) -> None:
        """Record a change with its texts before and after, and the affected path as in an erratum, or an empty one."""
        paths = (affects,) if affects else ()
        self.applied.append(
            AppliedChange(change.layer, change.number, was=was, now=now, affects=paths, is_known=is_known)
        )

    def _reserve_place(self, target: _Target, path: Path) -> bool:
        """Reserve a place of the spec for a change, and return True.

        If another change has reserved the place, a part of it, or a part that contains it, report the conflict and
        return False.
        """
        place = named_path(self._data, path)  # Indices change when an element of a list is removed.
        for reserved_path, first_change in self._reserved_places.items():
            is_in_reserved_place = place[: len(reserved_path)] == reserved_path
            contains_reserved_place = reserved_path[: len(place)] == place
            if is_in_reserved_place or contains_reserved_place:
                first_overlay = first_change.layer.document
                mark = mark_at(first_overlay.marks, first_change.path)
                first_place = f"{File(first_overlay.file).name}:{mark.line}"
                message = f"{first_place} changes the same location; keep one of the two"
                self._report_problem("overlay-conflict", target, message)
                return False
        self._reserved_places[place] = target.change
        return True

    def _line_from_value(self, path: Path) -> str:
        """Return the rest of the line in the file from the value at ``path`` on."""
        mark = mark_at(self._marks, path)
        lines = self._other_files[mark.file] if mark.file else self._base.lines
        return lines[mark.line - 1][mark.column - 1 :]

    def _report_missing_place(self, target: _Target, missing_path: MissingPath) -> None:
        """Report a change of a place that does not exist, with the steps that are possible where its path ends."""
        existing_name = self._base.name_path(missing_path.existing_path)
        parent_text = quoted(existing_name) if existing_name else "the spec"
        hint = suggest_word(missing_path.step, missing_path.known_steps, "known")
        missing_step = f"{quoted(missing_path.step)}{hint}"
        message = f"there is nothing at {quoted(target.place_text)}: {parent_text} has no {missing_step}"
        self._report_problem("overlay-unused", target, message)

    def _report_problem(self, rule: str, target: _Target, message: str) -> None:
        """Report a problem with a change at the text that names the place."""
        self._report.add(rule, target.change.layer.document, target.path_of_text, message)


def _is_equal(new_value: Any, current_value: Any) -> bool:
    """Return True if two values are equal and have the same type."""
    return type(new_value) is type(current_value) and bool(new_value == current_value)


def _shortened_value_text(changed_value: Any, text_from_value: str) -> str:
    """Return a value as text, shortened if it is long.

    ``text_from_value`` is the line of the file from the value on. A number that is hexadecimal there stays hexadecimal.
    """
    if isinstance(changed_value, int) and not isinstance(changed_value, bool):
        first_word, *_ = text_from_value.split(maxsplit=1) or [""]
        number_as_written = first_word.rstrip(",}]")
        return number_as_written if number_as_written.startswith("0x") else str(changed_value)
    text = _format_value(changed_value)
    return text if len(text) <= _LONGEST_SHOWN else text[: _LONGEST_SHOWN - 3] + "..."


def _format_value(changed_value: Any) -> str:
    """Return a value as text: ``{key: [1, 2]}``, ``true``, or the text itself."""
    if isinstance(changed_value, dict):
        keys_and_values = [f"{key}: {_format_value(inner)}" for key, inner in changed_value.items()]
        return f"{{{', '.join(keys_and_values)}}}"
    if isinstance(changed_value, list):
        return f"[{', '.join(map(_format_value, changed_value))}]"
    return str(changed_value).lower() if isinstance(changed_value, bool) else str(changed_value)
