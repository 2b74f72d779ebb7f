"""Rules for flags and alarms: their levels, their effect on the position, and flags that combine others."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator

from ...model import INTERFACES, Alarm, Biss
from ..keys_of_fields import WrittenField, WrittenFieldGroup
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, quoted, suggest_word
from ..written import LocatedPart
from .parts import (
    FieldList,
    FieldOwner,
    by_name,
    field_lists,
    fields_by_name,
    is_second_reading,
    layouts_of_interfaces,
    owner_of_alarm,
    position_names,
)
from .walk import KEYS_OF_EXPLANATIONS, texts_of

#: A level in a text of a flag.
_LEVEL_IN_TEXT = re.compile(r"\b(?:[01]|low|high)\b", re.IGNORECASE)
#: Number of flags with the same level from which another one in the same register is suspicious.
_LEAST_FLAGS_OF_A_LEVEL = 4
#: Number of flags of a group from which one that no other flag combines is suspicious.
_LEAST_FLAGS_OF_GROUP = 4


def check_lone_levels(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no flag is the only one of its layout or register that is active low (or high) among four or more.

    A text of the flag that states its level explains it. Flags that only combine others (``sums_up``) do not count.
    """
    if is_second_reading(report.document):  # Second readings have no such texts.
        return
    for field_list in field_lists(spec):
        flags = [field for field in field_list.fields if field.active and not field.sums_up]
        flag_count_by_level = Counter(flag.active for flag in flags)
        if len(flag_count_by_level) != 2:
            continue  # All flags have the same level, or there are none.
        (usual_level, usual_count), (_, rarer_count) = flag_count_by_level.most_common()
        if rarer_count > 1 or usual_count < _LEAST_FLAGS_OF_A_LEVEL:
            continue
        for flag in flags:
            if flag.active != usual_level and not _states_level(flag):
                message = (
                    f"{quoted(flag.name)} is active {flag.active}, but the other {usual_count} flags of"
                    f" {quoted(field_list.name)} are active {usual_level}; correct it, or say in its 'meaning' that it"
                    f" is active {flag.active}"
                )
                report.add("level-differs", flag.path_of("active"), message)


def _states_level(flag: WrittenField) -> bool:
    """Return True if a text of a flag contains its level, such as "low" or "0", or its name begins with ``not_``."""
    if flag.name.startswith("not_"):
        return True
    texts = (flag.meaning, flag.note, flag.when_active, flag.when_inactive)
    return any(_LEVEL_IN_TEXT.search(text) for text in texts)


def check_repeated_flags(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that flags with the same name have the same active level and the same verdict on the position.

    Flags in layouts are compared within an interface, and flags in groups with other groups. Verdicts are compared only
    if both flags have one.
    """
    first_flag_by_interface_and_name: dict[tuple[str, str], WrittenField] = {}
    for field_list in field_lists(spec):
        if field_list.interface == Biss.name:
            continue  # Another rule checks the flags of BiSS.
        if field_list.owner_kind not in (FieldOwner.GROUP, FieldOwner.LAYOUT):
            continue
        flags = [field for field in field_list.fields if field.active]
        for flag in flags:
            # Groups have an empty interface name.
            first_flag = first_flag_by_interface_and_name.setdefault((field_list.interface, flag.name), flag)
            for key in _differing_keys(flag, first_flag):
                line, _ = report.document.position(first_flag.path)
                value, first_value = flag.data[key], first_flag.data[key]
                message = (
                    f"{quoted(flag.name)} has {quoted(key)} {value} here, but {first_value} on line {line}; correct one"
                    " of the two, or rename the flag if it is a different flag"
                )
                report.add("flag-differs", flag.path_of(key), message)


def _differing_keys(flag: WrittenField, first_flag: WrittenField) -> Iterator[str]:
    """Yield ``active`` if two flags have different levels, and ``makes_position`` if they have different verdicts."""
    if flag.active != first_flag.active:
        yield "active"
    have_verdicts = bool(flag.makes_position and first_flag.makes_position)
    if have_verdicts and flag.makes_position != first_flag.makes_position:
        yield "makes_position"


def check_cleared_alarms(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an alarm with ``latch: false``, which clears itself, lists no procedures that clear it."""
    for alarm in spec.alarms:
        if alarm.part.latch is False and alarm.part.cleared_by:
            message = (
                f"{quoted(alarm.part.cleared_by[0])} clears the alarm, but 'latch' is false, which means that the"
                " alarm clears itself; correct one of the two"
            )
            report.add("alarm-latch", (*alarm.path, "latch"), message)


def check_implemented_alarms(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an alarm and its flag are either both implemented by the encoder or both not implemented."""
    for alarm in spec.alarms:
        flag = _flag_of_alarm(spec, alarm)
        if flag is not None and flag.implemented != alarm.part.implemented:
            flag_text = "is implemented" if flag.implemented else "is not implemented"
            message = (
                f"its flag {quoted(flag.name)} {flag_text}, unlike this alarm; write 'implemented: false' for both"
            )
            key = "implemented" if alarm.has("implemented") else "name"
            report.add("alarm-implemented", (*alarm.path, key), message)


def _flag_of_alarm(spec: WrittenSpec, alarm: LocatedPart[Alarm]) -> WrittenField | None:
    """Return the flag that an alarm names in its group or register, or None if the alarm names no existing flag."""
    group_or_register = owner_of_alarm(spec, alarm)
    if group_or_register is None or not alarm.part.field:
        return None
    for field in group_or_register.fields:
        if field.name == alarm.part.field:
            return field
    return None


def check_combined_flags(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each flag is combined by at most one other flag, and that flags of a group are combined together.

    A flag combines the flags in its ``sums_up``: it is active while one of them is.
    """
    groups = by_name(spec.field_groups)
    for field_list in field_lists(spec):
        first_combiner_by_flag: dict[str, str] = {}  # For each combined flag, the first flag that combines it.
        for flag in field_list.fields:
            for index, combined_name in enumerate(flag.sums_up):
                first_combiner = first_combiner_by_flag.setdefault(combined_name, flag.name)
                if flag.name != first_combiner:
                    message = f"{quoted(first_combiner)} also combines {quoted(combined_name)}"
                    path = (*flag.path_of("sums_up"), index)
                    report.add("summed-twice", path, f"{message}; remove it from one of the two")
        for group in groups.values():
            _report_flag_not_combined(group, first_combiner_by_flag.keys(), field_list, report)


def _report_flag_not_combined(
    group: WrittenFieldGroup, combined_names: Collection[str], field_list: FieldList, report: DocumentReport
) -> None:
    """Report a flag of a group if it is the only one that is not combined, and the group has at least four flags.

    ``combined_names`` are the flags that the flags in ``field_list`` combine. A meaning with the word "combine"
    explains the omission.
    """
    flags = [field for field in group.fields if field.active]
    flags_not_combined = [flag for flag in flags if flag.name not in combined_names]
    if len(flags_not_combined) != 1 or len(flags) < _LEAST_FLAGS_OF_GROUP:
        return
    (flag,) = flags_not_combined
    if "combine" not in flag.meaning.casefold():
        message = (
            f"{quoted(flag.name)} is not combined by any flag of {quoted(field_list.name)}, unlike the rest of"
            f" {quoted(group.name)}; add it to 'sums_up' of a flag, or say in its 'meaning' that no flag combines it"
        )
        report.add("not-summed", flag.path_of("name"), message)


#: Verdicts on the position in ascending order of severity.
_VERDICTS_MILDEST_FIRST = ("usable", "usable_with_warning", "not_usable")


def check_combined_verdicts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a flag that combines others has a verdict on the position that is at least as severe as theirs.

    A flag is checked only if it and all flags in its ``sums_up`` have a verdict.
    """
    single_flag_by_name: dict[str, WrittenField] = {}
    for field_list in field_lists(spec):
        single_flag_by_name |= {field.name: field for field in field_list.fields if field.active and not field.sums_up}
    for field_list in field_lists(spec):
        for flag in field_list.fields:
            combined_flags = [single_flag_by_name[name] for name in flag.sums_up if name in single_flag_by_name]
            verdicts = [combined_flag.makes_position for combined_flag in combined_flags]
            all_have_verdict = {flag.makes_position, *verdicts} <= set(_VERDICTS_MILDEST_FIRST)
            if not verdicts or not all_have_verdict:
                continue
            most_severe = max(verdicts, key=_VERDICTS_MILDEST_FIRST.index)
            is_milder = _VERDICTS_MILDEST_FIRST.index(flag.makes_position) < _VERDICTS_MILDEST_FIRST.index(most_severe)
            if is_milder:
                message = (
                    f"{quoted(flag.name)} makes the position {flag.makes_position}, but the most severe of the flags"
                    f" that it combines makes it {most_severe}; correct one of them"
                )
                report.add("summed-verdict", flag.path_of("makes_position"), message)


def check_explained_flags(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no diagnostic bit is listed in ``explained_by`` of two flags of a register, whose details it gives."""
    for register in spec.registers:
        flag_name_by_bit: dict[str, str] = {}  # For each diagnostic bit, the first flag that it explains.
        for flag in register.fields:
            for index, diagnostic_bit in enumerate(flag.explained_by):
                if diagnostic_bit in flag_name_by_bit:
                    problem = f"{quoted(diagnostic_bit)} already explains {quoted(flag_name_by_bit[diagnostic_bit])}"
                    path = (*flag.path_of("explained_by"), index)
                    report.add("explains-twice", path, f"{problem}; remove it from one of the two")
                flag_name_by_bit.setdefault(diagnostic_bit, flag.name)


_VOLTAGE_LIMIT = re.compile(r"\b(above|over|exceeds|below|under) (\d+(?:\.\d+)?) ?(m?)V\b")
_WORDS_FOR_ABOVE = frozenset(("above", "over", "exceeds"))
#: A sentence that gives the level of an active bit: "0 means an error", "active if it is 1", "it is active at 0".
_ACTIVE_LEVEL_SENTENCE = re.compile(r"\bactive (?:at|if it is|when it is|while it is|=) ?([01])\b", re.IGNORECASE)
_CLEARS_ITSELF = re.compile(
    r"\b(?:clears (?:by )?itself|cleared automatically|returns to 0 by itself|not latched|is not stored)\b",
    re.IGNORECASE,
)
_STAYS_ACTIVE = re.compile(
    r"\b(?:is latched|remains active until it is reset|stays active until it is reset)\b", re.IGNORECASE
)


def check_threshold_words(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the texts of an alarm that is raised below a voltage do not say that it is raised above it."""
    for alarm in spec.alarms:
        threshold_mv = alarm.part.below_mv
        if threshold_mv is None:
            continue
        for path, text in texts_of(alarm, KEYS_OF_EXPLANATIONS):
            # ("above", "3.6", "") or ("below", "100", "m").
            for word, number_text, unit_prefix in _VOLTAGE_LIMIT.findall(text):
                voltage_mv = float(number_text) * (1 if unit_prefix == "m" else 1000)
                if word in _WORDS_FOR_ABOVE and voltage_mv == threshold_mv:
                    problem = f"the text says {quoted(word)}, but the alarm has 'below_mv: {threshold_mv}'"
                    message = f"{problem}; correct one of the two"
                    report.add("words-contradict", path, message)


def check_latch_words(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no text says that a latching alarm clears itself, or that any other alarm stays active."""
    for alarm in spec.alarms:
        is_latching = alarm.part.latch
        if is_latching is None:
            continue
        contradicting_words = _CLEARS_ITSELF if is_latching else _STAYS_ACTIVE
        for path, text in texts_of(alarm, KEYS_OF_EXPLANATIONS):
            match = contradicting_words.search(text)
            if match is not None:
                latch_text = "true" if is_latching else "false"
                message = f"the text says {quoted(match[0])}, but 'latch' is {latch_text}; correct one of the two"
                report.add("words-contradict", path, message)


def check_level_words(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that texts of a flag such as "active at 0" give the level at which the flag is active."""
    bit_by_level = {"low": "0", "high": "1"}
    for field_list in field_lists(spec):
        for field in field_list.fields:
            active_bit = bit_by_level.get(field.active)  # None for a field that is not a flag.
            if active_bit is None:
                continue
            for path, text in texts_of(field, KEYS_OF_EXPLANATIONS):
                stated_bits = _ACTIVE_LEVEL_SENTENCE.findall(text)
                wrong_bits = [bit for bit in stated_bits if bit != active_bit]
                if wrong_bits:
                    message = (
                        f"the text says that it is active at {wrong_bits[0]}, but 'active: {field.active}' means"
                        f" {active_bit}; correct one of the two"
                    )
                    report.add("words-contradict", path, message)


#: Words in the name of a flag that signals an error. BiSS calls it nE.
_ERROR_WORDS = re.compile(r"(?<![A-Za-z])(?:nE|n?Err|(?i:errors?|faults?|failures?))(?![A-Za-z])")
#: Words before such a word that say the opposite.
_DENIAL_OF_ERROR = re.compile(r"(?i:\b(?:no|not|without|free)\b)")


def check_missing_verdicts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each flag in a frame with a position has ``makes_position``: the verdict on it while active.

    That is, whether the position is usable. The verdicts of flags that the interface itself defines are known.
    """
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    for frame in layouts_of_interfaces(spec):
        names_of_position = position_names(spec, frame.interface)
        has_position = not names_of_position.isdisjoint(fields_by_name(frame, group_by_name))
        if not frame.is_from_encoder or not has_position:
            continue
        flags_with_known_verdict = INTERFACES[frame.interface].flags
        for field in _fields_with_groups(frame, spec):
            is_flag = bool(field.active)
            has_verdict = bool(field.makes_position) or field.name in flags_with_known_verdict
            if is_flag and field.name and not has_verdict:
                message = (
                    f"{quoted(field.name)} is in a frame that contains the position; set 'makes_position'"
                    " to the verdict on the position while this flag is active:"
                    " not_usable, usable_with_warning or usable"
                )
                report.add("makes-position-missing", field.path, message)


def check_usable_errors(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a flag or value called an error does not leave the position usable, unless a note explains it."""
    for field_list in field_lists(spec):
        for field in field_list.fields:
            _report_usable_values(field, report)
            is_flag = bool(field.active)
            is_error = is_flag and names_error(field.name, field.printed_name)
            if is_error and field.makes_position == "usable" and not field.note:
                message = (
                    f"{quoted(field.name)} leaves the position usable while it is active; "
                    "write 'makes_position: not_usable', or usable_with_warning. "
                    "If the position is usable, explain it in a 'note' of the flag"
                )
                report.add("error-usable", field.path_of("makes_position"), message)


def _report_usable_values(field: WrittenField, report: DocumentReport) -> None:
    """Report named values that are errors but leave the position usable, unless a note of the field explains it."""
    for name, value in field.values.items():
        is_usable = value.makes_position == "usable"
        if is_usable and names_error(name, value.printed_name) and not field.note:
            message = (
                f"the value {quoted(name)} leaves the position usable; write 'makes_position: not_usable', "
                "or usable_with_warning. If the position is usable, explain it in a 'note' of the field"
            )
            report.add("error-usable", value.path_of("makes_position"), message)


def names_error(name: str, printed_name: str) -> bool:
    """Return True if the name of a flag or value, or its name in the manual, has a word such as "error" or "fault".

    The result is False for a name that denies the error, such as "No error".
    """
    names = (name.replace("_", " "), printed_name)
    return any(_ERROR_WORDS.search(text) and not _DENIAL_OF_ERROR.search(text) for text in names)


def check_flag_sums(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the flags listed in ``sums_up``, which another flag combines, exist in some layout, register or group.

    The combining flag is active while one of them is.
    """
    flag_names: list[str] = []
    for field_list in field_lists(spec.with_invalid_parts):
        flag_names += [field.name for field in field_list.fields if field.is_flag and field.name]
    for field_list in field_lists(spec):
        for field in field_list.fields:
            other_flags = [name for name in dict.fromkeys(flag_names) if name != field.name]
            for index, name in enumerate(field.sums_up):
                if name not in other_flags:
                    problem = f"there is no other flag {quoted(name)}{suggest_word(name, other_flags)}"
                    report.add("undefined-reference", (*field.path_of("sums_up"), index), problem, cause=name)


def _fields_with_groups(field_list: FieldList, spec: WrittenSpec) -> Iterator[WrittenField]:
    """Yield the fields of a layout, with the fields of a group instead of the field that includes the group.

    The path of each field from a group is the path inside the group.
    """
    group_by_name = {group.name: group for group in spec.field_groups}
    for field in field_list.fields:
        if field.use in group_by_name:
            yield from group_by_name[field.use].fields
        else:
            yield field


_FLAG_NAME = re.compile(r"(?:n_?)?(?:e|w|err|error|fault|failure|warn|warning|alarm)(?:_(?:bit|flag))?")
_PARITY_NAME = re.compile(r"(?:(?:even|odd)_)?(?:par|parity)(?:_bit)?")
#: The only keys of a field that is just a number. Every other key says how the bit is used.
_KEYS_OF_PLAIN_NUMBER = frozenset(("name", "printed_name", "names", "bits", "at", "meaning", "source"))


def check_plain_bits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a bit of an encoder's frame called error or parity is described as a flag or as a parity bit.

    Without that, it would be a plain number, which decoders do not check. A note can explain a bit that is neither.
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    for field_list in field_lists(spec):
        if field_list.owner_kind is not FieldOwner.GROUP and not field_list.is_from_encoder:
            continue
        for field in field_list.fields:
            field_name = field.name
            is_plain_number = _KEYS_OF_PLAIN_NUMBER.issuperset(field.data)
            is_plain_bit = is_plain_number and _width_of_field(field) == 1
            if not is_plain_bit or _is_defined_by_interface(field_list, field_name):
                continue
            problem = f"{quoted(field_name)} is a plain number, so decoders ignore it"
            if _PARITY_NAME.fullmatch(field_name):
                remedy = "write 'parity_of: [FIELDS]' instead of 'bits: 1', or add a 'note' that it is not a parity bit"
                report.add("plain-bit", field.path, f"{problem}; {remedy}")
            elif _FLAG_NAME.fullmatch(field_name):
                remedy = (
                    "write 'active: high' or 'active: low' instead of 'bits: 1', or add a 'note' that it is not a flag"
                )
                report.add("plain-bit", field.path, f"{problem}; {remedy}")


def _is_defined_by_interface(field_list: FieldList, field_name: str) -> bool:
    """Return True for a flag that the interface itself defines, such as the error bit of BiSS."""
    return field_list.interface in INTERFACES and field_name in INTERFACES[field_list.interface].flags


def _width_of_field(field: WrittenField) -> int | str | None:
    """Return the number of bits of a field: its width, or 1 if it is placed at a single bit.

    The width is text if it depends on the order code. The result is None if the field has no width, or a range of bits.
    """
    # ``at`` is the number of a bit, or text such as 7:6.
    is_at_one_bit = isinstance(field.at, int)
    return 1 if is_at_one_bit else field.bits
