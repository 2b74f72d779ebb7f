"""Changes that follow from another one: a field of a different size moves the fields after it and resizes the frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ..model import Field
from ..model.expressions import Expression
from ..say.plain_text import counted
from .counterparts import FamilyPair
from .pairs import Pair
from .rules import RULES, Change, Impact

_Impacts = tuple[Impact, Impact, Impact, Impact]
#: Rules of changes that give a field a different size.
_RESIZING = ("field-width", "field-new", "field-gone")


@dataclass(frozen=True)
class ComparedField:
    """A field of a frame or register in both versions, and its changes."""

    pair: Pair[Field]
    changes: Sequence[Change]

    @property
    def resizing(self) -> Change | None:
        """Change that gives it a different size, if there is one."""
        return next((change for change in self.changes if change.rule.name in _RESIZING), None)


@dataclass(frozen=True)
class _Resized:
    """A field with a different size: its new lowest bit, or the old one if it is gone, and the bits that it gains."""

    name: str
    low_bits: tuple[int, ...]
    gained_bits: tuple[int, ...]


def fold_moves(
    family_pair: FamilyPair, interface: str, frame: str, compared_fields: Sequence[ComparedField]
) -> Iterator[Change]:
    """Yield the changes of the fields of a layout. A field that moves because of another one counts for that one."""
    resized_fields = list(_resized_fields(family_pair, interface, compared_fields))
    moved_names: dict[str, list[str]] = {resized.name: [] for resized in resized_fields}
    unexplained_changes: list[tuple[str, Change]] = []
    for compared in compared_fields:
        cause = _cause_of_move(family_pair, interface, compared.pair, resized_fields)
        for change in compared.changes:
            if change.rule.name == "field-moved" and cause is not None:
                moved_names[cause.name].append(f"{frame}.{compared.pair.item.name}")
            else:
                unexplained_changes.append((compared.pair.item.name, change))
    for name, change in unexplained_changes:
        moved = tuple(moved_names.get(name, ()))
        yield replace(change, moved_fields=moved) if moved and change.rule.name in _RESIZING else change


def fold_length(
    family_pair: FamilyPair,
    interface: str,
    frame: str,
    lengths: tuple[Expression, Expression],
    compared_fields: Sequence[ComparedField],
) -> Sequence[ComparedField]:
    """Return the fields. If their sizes explain a different length of the frame, the last resized one has it."""
    old_bits = family_pair.numbers(lengths[0], interface, is_old=True)
    new_bits = family_pair.numbers(lengths[1], interface, is_old=False)
    gained_bits = tuple(new - old for old, new in zip(old_bits, new_bits, strict=True))
    resized_fields = list(_resized_fields(family_pair, interface, compared_fields))
    if not any(gained_bits) or _total(resized_fields, len(gained_bits)) != gained_bits:
        return compared_fields
    last_name = max(resized_fields, key=lambda resized: resized.low_bits).name
    resizing_frame = {frame: gained_bits[0] if len(set(gained_bits)) == 1 else 0}
    return [
        _with_resized_frame(compared, resizing_frame) if compared.pair.item.name == last_name else compared
        for compared in compared_fields
    ]


def _with_resized_frame(compared: ComparedField, resized_frames: dict[str, int]) -> ComparedField:
    changes = [
        replace(change, resized_frames=resized_frames) if change is compared.resizing else change
        for change in compared.changes
    ]
    return replace(compared, changes=changes)


def without_explained_lengths(changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes of frames without the lengths that follow from the size of a field."""
    explained_paths = {f"{frame}.bits" for change in changes for frame in change.resized_frames}
    yield from (
        change for change in changes if change.rule.name != "frame-length" or change.path not in explained_paths
    )


def _resized_fields(
    family_pair: FamilyPair, interface: str, compared_fields: Sequence[ComparedField]
) -> Iterator[_Resized]:
    for compared in compared_fields:
        if compared.resizing is None:
            continue
        old, new = compared.pair.old, compared.pair.new
        old_lows, old_sizes = _lows_and_sizes(family_pair, interface, old, is_old=True)
        new_lows, new_sizes = _lows_and_sizes(family_pair, interface, new, is_old=False)
        no_sizes = (0,) * max(len(old_sizes), len(new_sizes))
        both_sizes = zip(old_sizes or no_sizes, new_sizes or no_sizes, strict=True)
        gained_bits = tuple(new_size - old_size for old_size, new_size in both_sizes)
        yield _Resized(compared.pair.item.name, new_lows or old_lows, gained_bits)


def _lows_and_sizes(
    family_pair: FamilyPair, interface: str, field: Field | None, is_old: bool
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the lowest bit and the number of bits with padding of a field at every point of an interface."""
    if field is None:
        return (), ()
    lows = family_pair.numbers(field.low, interface, is_old)
    widths = family_pair.numbers(field.width, interface, is_old)
    return lows, tuple(field.container or width for width in widths)


def _cause_of_move(
    family_pair: FamilyPair, interface: str, pair: Pair[Field], resized_fields: Sequence[_Resized]
) -> _Resized | None:
    """Return the nearest resized field below one that moved, if the resized ones below it explain the distance."""
    if pair.old is None or pair.new is None:
        return None
    old_lows = family_pair.numbers(pair.old.low, interface, is_old=True)
    new_lows = family_pair.numbers(pair.new.low, interface, is_old=False)
    distance = tuple(new - old for old, new in zip(old_lows, new_lows, strict=True))
    causes = [
        resized
        for resized in resized_fields
        if resized.name != pair.item.name and (resized.low_bits < new_lows or resized.low_bits < old_lows)
    ]
    if not causes or not any(distance) or _total(causes, len(distance)) != distance:
        return None
    return max(causes, key=lambda resized: resized.low_bits)


def _total(resized_fields: Sequence[_Resized], count: int) -> tuple[int, ...]:
    """Return the sum of the gained bits at every point."""
    columns = zip(*(resized.gained_bits for resized in resized_fields), strict=True)
    return tuple(sum(column) for column in columns) or (0,) * count


def with_consequences(change: Change) -> Change:
    """Return a change with its consequences in its text, and with the impact that they have."""
    if not change.moved_fields and not change.resized_frames:
        return change
    texts = [change.text]
    impacts = change.rule.impacts
    if change.moved_fields:
        texts.append(f"moves {counted(len(change.moved_fields), 'field')}")
        impacts = _highest(impacts, RULES["field-moved"].impacts)
    if change.resized_frames:
        texts.append(_resized_frames_text(change.resized_frames))
        impacts = _highest(impacts, RULES["frame-length"].impacts)
    return replace(change, text=", ".join(texts), rule=replace(change.rule, impacts=impacts))


def fold_defaults(changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes. A default of a field that changes with the default of its register is part of that change."""
    registers = {_owner(change) for change in changes if change.rule.name == "register-default"}
    field_texts: dict[str, list[str]] = {register: [] for register in registers}
    for change in changes:
        register = _owner(change).rpartition(".")[0]
        if change.rule.name == "field-default" and register in registers:
            field_texts[register].append(change.text.partition(": field ")[2].replace(": default", ""))
    for change in changes:
        if change.rule.name == "register-default" and field_texts[_owner(change)]:
            yield replace(change, text=f"{change.text} ({', '.join(field_texts[_owner(change)])})")
        elif change.rule.name != "field-default" or _owner(change).rpartition(".")[0] not in registers:
            yield change


def _owner(change: Change) -> str:
    """Return the path of the thing whose member has changed."""
    return change.path.rpartition(".")[0]


def _highest(first: _Impacts, second: _Impacts) -> _Impacts:
    """Return the higher impact on each output."""
    c, python, xml, pages = map(max, first, second)
    return c, python, xml, pages


def _resized_frames_text(resized_frames: Mapping[str, int]) -> str:
    subject = "frame" if len(resized_frames) == 1 else counted(len(resized_frames), "frame")
    gained_bits = set(resized_frames.values())
    bits = gained_bits.pop() if len(gained_bits) == 1 else 0
    if not bits:
        return f"{subject} with a different length"
    return f"{subject} {counted(abs(bits), 'bit')} {'longer' if bits > 0 else 'shorter'}"


def fold_alike(changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes. The same pause in several procedures, or signal at several contacts, is one change."""
    groups: dict[object, list[Change]] = {}
    for change in changes:
        groups.setdefault(_likeness(change) or id(change), []).append(change)
    for alike_changes in groups.values():
        if len(alike_changes) == 1:
            yield alike_changes[0]
            continue
        first = alike_changes[0]
        subjects = [change.text.rpartition(": ")[0] for change in alike_changes]
        if first.rule.name == "procedure-steps":
            names = [subject.partition(": ")[0].removeprefix("procedure ") for subject in subjects]
            subjects = [f"procedures {', '.join(names)}"]
        yield replace(first, text=f"{', '.join(subjects)}: {first.text.rpartition(': ')[2]}")


def _likeness(change: Change) -> object:
    """Return the key shared by changes that are shown as one, or None if the change stands alone."""
    what_changed = change.text.rpartition(": ")[2]
    is_pause = change.rule.name == "procedure-steps" and what_changed.startswith("pause ")
    is_signal = change.rule.name == "contact" and what_changed.startswith("signal ")
    return (change.rule.name, what_changed, change.codes) if is_pause or is_signal else None


def fold_types(changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes. Another type in C of a field with another width is part of that change."""
    types = {_subject_text(change): change for change in changes if change.rule.name == "field-type"}
    widened = {_subject_text(change) for change in changes if change.rule.name == "field-width"}
    for change in changes:
        field_type = types.get(_subject_text(change))
        if field_type is not None and change.rule.name == "field-width":
            impacts = _highest(change.rule.impacts, field_type.rule.impacts)
            text = f"{change.text}, in C {field_type.text.rpartition(': ')[2]}"
            yield replace(change, text=text, rule=replace(change.rule, impacts=impacts))
        elif change.rule.name != "field-type" or _subject_text(change) not in widened:
            yield change


def _subject_text(change: Change) -> str:
    """Return the words of a change before the changed value."""
    return change.text.rpartition(": ")[0]
