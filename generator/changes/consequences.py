"""Changes that follow from other changes: a resized field moves the fields after it and resizes the frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ..model import Field
from ..model.expressions import Expression
from ..say import count_with_unit
from .family_pair import FamilyPair, OldAndNew
from .rules import RULES, Change, Impact

_Impacts = tuple[Impact, Impact, Impact, Impact]
#: Rules of changes that give a field a different size.
_RESIZING_RULES = ("field-width", "field-new", "field-gone")


@dataclass(frozen=True)
class ComparedField:
    """A field of a frame or register in both versions, and its changes."""

    pair: OldAndNew[Field]
    changes: Sequence[Change]

    @property
    def name(self) -> str:
        """New name of the field, or its old one if it is gone."""
        return self.pair.new_or_old.name

    @property
    def resizing_change(self) -> Change | None:
        """Change that gives it a different size, if there is one."""
        resizing_changes = [change for change in self.changes if change.rule.name in _RESIZING_RULES]
        return resizing_changes[0] if resizing_changes else None


@dataclass(frozen=True)
class _ResizedField:
    """A field with a different size, with one number for each point: an order code with values of its parameters."""

    name: str
    #: Lowest bit of the field in the new version, or in the old version if the field is gone.
    low_bits: tuple[int, ...]
    #: Number of bits by which the new field is wider. It is negative if the field is narrower.
    gained_bits: tuple[int, ...]


def merge_moves_into_resizings(
    family_pair: FamilyPair, interface: str, frame: str, compared_fields: Sequence[ComparedField]
) -> Iterator[Change]:
    """Yield the changes of the fields of a frame, without the moves that a resized field explains.

    If a field only moved because a field below it was resized, its "field-moved" change is left out. The field is
    instead listed as ``frame.field`` in ``moved_fields`` of the change that resized the other field.
    """
    resized_fields = list(_resized_fields(family_pair, interface, compared_fields))
    # Paths of the moved fields by the name of the resized field that moves them.
    moved_by_cause: dict[str, list[str]] = {resized_field.name: [] for resized_field in resized_fields}
    other_changes: list[tuple[ComparedField, Change]] = []
    for compared_field in compared_fields:
        cause = _cause_of_move(family_pair, interface, compared_field.pair, resized_fields)
        for change in compared_field.changes:
            if change.rule.name == "field-moved" and cause is not None:
                moved_by_cause[cause.name].append(f"{frame}.{compared_field.name}")
            else:
                other_changes.append((compared_field, change))
    for compared_field, change in other_changes:
        moved_fields = tuple(moved_by_cause.get(compared_field.name, ()))
        if moved_fields and change.rule.name in _RESIZING_RULES:
            yield replace(change, moved_fields=moved_fields)
        else:
            yield change


def merge_length_into_resizing(
    family_pair: FamilyPair,
    interface: str,
    frame: str,
    old_length: Expression,
    new_length: Expression,
    compared_fields: Sequence[ComparedField],
) -> Sequence[ComparedField]:
    """Return the fields of a frame, with the different length of the frame as a consequence of a resized field.

    The resized field that begins at the highest bit gets the consequence. Its change then lists
    ``{frame: gained bits}``, or 0 bits if the gain depends on the order code. If the length of the frame is unchanged,
    or the resized fields do not explain the difference, the fields are returned as they are.
    """
    old_lengths = family_pair.values_at_points(old_length, interface, is_old=True)
    new_lengths = family_pair.values_at_points(new_length, interface, is_old=False)
    gained_bits = _subtract_each(old_lengths, new_lengths)
    resized_fields = list(_resized_fields(family_pair, interface, compared_fields))
    is_explained = _total_gained_bits(resized_fields, point_count=len(gained_bits)) == gained_bits
    if not any(gained_bits) or not is_explained:
        return compared_fields
    highest_field = max(resized_fields, key=lambda resized_field: resized_field.low_bits)
    has_same_gain_everywhere = len(set(gained_bits)) == 1
    resized_frames = {frame: gained_bits[0] if has_same_gain_everywhere else 0}
    field_names = [compared_field.name for compared_field in compared_fields]
    highest_index = field_names.index(highest_field.name)
    field_with_consequence = _with_resized_frames(compared_fields[highest_index], resized_frames)
    return [*compared_fields[:highest_index], field_with_consequence, *compared_fields[highest_index + 1 :]]


def _subtract_each(old_numbers: Sequence[int], new_numbers: Sequence[int]) -> tuple[int, ...]:
    """Return by how much each new number exceeds the old number: ``(2, 0)`` for ``(10, 8)`` and ``(12, 8)``."""
    return tuple(new - old for old, new in zip(old_numbers, new_numbers, strict=True))


def _with_resized_frames(compared_field: ComparedField, resized_frames: dict[str, int]) -> ComparedField:
    """Return a resized field whose resizing change also lists ``resized_frames``: gained bits by frame."""
    changes = list(compared_field.changes)
    resizing_change = compared_field.resizing_change
    assert resizing_change is not None
    changes[changes.index(resizing_change)] = replace(resizing_change, resized_frames=resized_frames)
    return replace(compared_field, changes=changes)


def without_explained_lengths(changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes of frames, except different lengths that another change has as its consequence.

    Such a change lists the frame in ``resized_frames``.
    """
    explained_paths = {f"{frame}.bits" for change in changes for frame in change.resized_frames}
    for change in changes:
        is_explained = change.rule.name == "frame-length" and change.path in explained_paths
        if not is_explained:
            yield change


def _resized_fields(
    family_pair: FamilyPair, interface: str, compared_fields: Sequence[ComparedField]
) -> Iterator[_ResizedField]:
    """Yield fields that are resized, new or gone, with the bits that they gain."""
    for compared_field in compared_fields:
        if compared_field.resizing_change is None:
            continue
        old_field, new_field = compared_field.pair.old, compared_field.pair.new
        old_low_bits, old_sizes = _low_bits_and_sizes(family_pair, interface, old_field, is_old=True)
        new_low_bits, new_sizes = _low_bits_and_sizes(family_pair, interface, new_field, is_old=False)
        # A field that is new or gone has no bits on the other side.
        no_bits = (0,) * max(len(old_sizes), len(new_sizes))
        yield _ResizedField(
            name=compared_field.name,
            low_bits=new_low_bits or old_low_bits,
            gained_bits=_subtract_each(old_sizes or no_bits, new_sizes or no_bits),
        )


def _low_bits_and_sizes(
    family_pair: FamilyPair, interface: str, field: Field | None, *, is_old: bool
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the lowest bits and the sizes of a field, as two tuples with a number for each point.

    A point is an order code with values of its parameters. The size of a field in a container, such as 24 bits for 19,
    is the size of the container. Both tuples are empty if there is no field.
    """
    if field is None:
        return (), ()
    low_bits = family_pair.values_at_points(field.low, interface, is_old=is_old)
    widths = family_pair.values_at_points(field.width, interface, is_old=is_old)
    sizes = tuple(field.container or width for width in widths)
    return low_bits, sizes


def _cause_of_move(
    family_pair: FamilyPair, interface: str, pair: OldAndNew[Field], resized_fields: Sequence[_ResizedField]
) -> _ResizedField | None:
    """Return the resized field that explains why a field of a frame moved, or None if none explains it.

    The bits that all resized fields below the moved field gain must add up to the distance of its move, for every order
    code. The highest of these resized fields is then the cause.
    """
    if pair.old is None or pair.new is None:
        return None
    old_low_bits = family_pair.values_at_points(pair.old.low, interface, is_old=True)
    new_low_bits = family_pair.values_at_points(pair.new.low, interface, is_old=False)
    distances = _subtract_each(old_low_bits, new_low_bits)
    fields_below: list[_ResizedField] = []
    for resized_field in resized_fields:
        # The tuples contain a low bit for each point. The first point at which they differ decides.
        is_below = resized_field.low_bits < new_low_bits or resized_field.low_bits < old_low_bits
        if is_below and resized_field.name != pair.new.name:
            fields_below.append(resized_field)
    if not fields_below or not any(distances):
        return None
    if _total_gained_bits(fields_below, point_count=len(distances)) != distances:
        return None
    return max(fields_below, key=lambda resized_field: resized_field.low_bits)


def _total_gained_bits(resized_fields: Sequence[_ResizedField], point_count: int) -> tuple[int, ...]:
    """Return the bits that all fields together gain at each point: ``(3, 3)`` for ``(1, 1)`` and ``(2, 2)``.

    A point is an order code with values of its parameters.
    """
    if not resized_fields:
        return (0,) * point_count
    gained_bits_by_point = zip(*(resized_field.gained_bits for resized_field in resized_fields), strict=True)
    return tuple(map(sum, gained_bits_by_point))


def with_consequences(change: Change) -> Change:
    """Return a change with its consequences in its text, and with their impacts if these are higher.

    Consequences are moved fields and frames of a different length. The text then ends with ``, moves 3 fields`` or
    ``, frame 2 bits longer``.
    """
    if not change.moved_fields and not change.resized_frames:
        return change
    text_and_consequences = [change.text]
    impacts = change.rule.impacts
    if change.moved_fields:
        text_and_consequences.append(f"moves {count_with_unit(len(change.moved_fields), 'field')}")
        impacts = _combine_impacts(impacts, RULES["field-moved"].impacts)
    if change.resized_frames:
        text_and_consequences.append(_resized_frames_text(change.resized_frames))
        impacts = _combine_impacts(impacts, RULES["frame-length"].impacts)
    return replace(change, text=", ".join(text_and_consequences), rule=replace(change.rule, impacts=impacts))


def merge_field_defaults(changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes, with a field's changed default merged into the change of its register's default.

    The text about the register's change then ends with ``(speed 1 → 2)``. If there is no such change, the default of a
    field remains a separate change.
    """
    register_paths = {_owner_path(change) for change in changes if change.rule.name == "register-default"}
    field_changes = [change for change in changes if change.rule.name == "field-default"]
    field_texts_by_register: dict[str, list[str]] = {register_path: [] for register_path in register_paths}
    for change in field_changes:
        register_path = _register_path(change)
        if register_path in register_paths:
            # The text is ``mode: field speed: default 1 → 2``.
            _, _, changed_default = change.text.partition(": field ")
            field_texts_by_register[register_path].append(changed_default.replace(": default", ""))
    for change in changes:
        if change.rule.name == "register-default" and field_texts_by_register[_owner_path(change)]:
            texts_of_fields = ", ".join(field_texts_by_register[_owner_path(change)])
            yield replace(change, text=f"{change.text} ({texts_of_fields})")
        elif change.rule.name != "field-default" or _register_path(change) not in register_paths:
            yield change


def _owner_path(change: Change) -> str:
    """Return the path of the thing whose member has changed: ``registers.mode`` for ``registers.mode.default``."""
    return change.path.rpartition(".")[0]


def _register_path(field_change: Change) -> str:
    """Return the path of the register of a field: ``registers.mode`` for ``registers.mode.speed.default``."""
    return _owner_path(field_change).rpartition(".")[0]


def _combine_impacts(first: _Impacts, second: _Impacts) -> _Impacts:
    """Return the higher of two impacts for each output, in the order C, Python, XML and pages."""
    c, python, xml, pages = map(max, first, second)
    return c, python, xml, pages


def _resized_frames_text(resized_frames: Mapping[str, int]) -> str:
    """Return a text such as ``frame 2 bits longer`` or ``3 frames with a different length``.

    If frames gain different numbers of bits, or a gain depends on the order code (0), the text only says that their
    length differs.
    """
    frames_text = "frame" if len(resized_frames) == 1 else count_with_unit(len(resized_frames), "frame")
    different_gains = set(resized_frames.values())
    have_same_gain = len(different_gains) == 1
    gained_bits = different_gains.pop() if have_same_gain else 0
    if gained_bits > 0:
        return f"{frames_text} {count_with_unit(gained_bits, 'bit')} longer"
    if gained_bits < 0:
        return f"{frames_text} {count_with_unit(-gained_bits, 'bit')} shorter"
    return f"{frames_text} with a different length"


def merge_similar_changes(changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes, with similar changes merged into one.

    Changes are similar if they change a pause of several procedures to the same duration, or a signal of several
    contacts to the same signal, for the same order codes.
    """
    similar_changes_by_key: dict[object, list[Change]] = {}
    for change in changes:
        # A change that is not merged gets a unique key.
        similarity_key = _similarity_key(change) or id(change)
        similar_changes_by_key.setdefault(similarity_key, []).append(change)
    for similar_changes in similar_changes_by_key.values():
        if len(similar_changes) == 1:
            yield similar_changes[0]
        else:
            yield _merge_into_first(similar_changes)


def _merge_into_first(similar_changes: Sequence[Change]) -> Change:
    """Return the first of several similar changes, with the subjects of all changes in its text.

    Contacts give ``M12 A: contact 1, M12 A: contact 2: signal SL → SLO``, and procedures
    ``procedures preset, reset: pause 5 ms → 10 ms``.
    """
    first_change = similar_changes[0]
    subjects = [_subject_text(change) for change in similar_changes]
    if first_change.rule.name == "procedure-steps":
        procedures = [subject.partition(": ")[0].removeprefix("procedure ") for subject in subjects]
        subjects = [f"procedures {', '.join(procedures)}"]
    return replace(first_change, text=f"{', '.join(subjects)}: {_value_text(first_change)}")


def _similarity_key(change: Change) -> object:
    """Return the key that similar changes of a pause or a signal share, or None for any other change.

    The key consists of the rule, the old and new value, and the order codes.
    """
    value_text = _value_text(change)
    is_pause = change.rule.name == "procedure-steps" and value_text.startswith("pause ")
    is_signal = change.rule.name == "contact" and value_text.startswith("signal ")
    if is_pause or is_signal:
        return change.rule.name, value_text, change.codes
    return None


_RULES_OF_WAITS = ("wait-longer", "wait-shorter", "procedure-steps")
_WAIT_OF_REGISTER = "delay after a write "


def merge_equal_waits(changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes, with equal changes of times and of pauses merged into that of the wait after a write.

    This wait is how long a master must wait after it writes a register. The text then ends with ``30 ms → 50 ms, and so
    BiSS time storing, procedures preset, reset``. The order codes of the changes must be the same.
    """
    wait_after_write_by_key: dict[object, Change] = {}
    for change in changes:
        if _value_text(change).startswith(_WAIT_OF_REGISTER):
            wait_after_write_by_key.setdefault(_wait_key(change), change)
    # The changes to merge by the ``id`` of the change that they are merged into, because a change cannot be a key.
    merged_changes_by_id: dict[int, list[Change]] = {}
    ids_of_merged: set[int] = set()
    for change in changes:
        wait_after_write = wait_after_write_by_key.get(_wait_key(change))
        is_other_change = wait_after_write is not None and change is not wait_after_write
        if is_other_change and change.rule.name in _RULES_OF_WAITS:
            merged_changes_by_id.setdefault(id(wait_after_write), []).append(change)
            ids_of_merged.add(id(change))
    for change in changes:
        if id(change) in merged_changes_by_id:
            yield _with_equal_waits(change, merged_changes_by_id[id(change)])
        elif id(change) not in ids_of_merged:
            yield change


def _with_equal_waits(wait_after_write: Change, equal_changes: Sequence[Change]) -> Change:
    """Return the change of a wait, whose text and impacts also cover equal changes of other waits."""
    subjects = ", ".join(map(_subject_text, equal_changes))
    impacts = wait_after_write.rule.impacts
    for equal_change in equal_changes:
        impacts = _combine_impacts(impacts, equal_change.rule.impacts)
    return replace(
        wait_after_write,
        text=f"{wait_after_write.text}, and so {subjects}",
        rule=replace(wait_after_write.rule, impacts=impacts),
    )


def _wait_key(change: Change) -> object:
    """Return what equal changes of waits share: the old and the new time, and the order codes.

    The times are at the end of the text, such as ``30 ms → 50 ms`` in ``pause 30 ms → 50 ms``.
    """
    old_text, arrow, new_time = _value_text(change).partition(" → ")
    old_time = " ".join(old_text.split()[-2:])
    return (old_time, new_time, change.codes) if arrow else None


def merge_type_changes(changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes, with the change of a field's type in C merged into the change of the field's width.

    The text of the width's change then ends with ``, in C uint16_t → uint32_t``. If only the type of a field changes,
    the change remains separate.
    """
    type_change_by_subject = {_subject_text(change): change for change in changes if change.rule.name == "field-type"}
    resized_subjects = {_subject_text(change) for change in changes if change.rule.name == "field-width"}
    for change in changes:
        subject_text = _subject_text(change)
        type_change = type_change_by_subject.get(subject_text)
        if type_change is not None and change.rule.name == "field-width":
            impacts = _combine_impacts(change.rule.impacts, type_change.rule.impacts)
            text_with_type = f"{change.text}, in C {_value_text(type_change)}"
            yield replace(change, text=text_with_type, rule=replace(change.rule, impacts=impacts))
        elif change.rule.name != "field-type" or subject_text not in resized_subjects:
            yield change


def _subject_text(change: Change) -> str:
    """Return the words of a change before the changed value: ``mode: field speed`` for ``…: default 1 → 2``."""
    return change.text.rpartition(": ")[0]


def _value_text(change: Change) -> str:
    """Return the words of a change about the changed value, such as ``pause 5 ms → 10 ms``."""
    return change.text.rpartition(": ")[2]
