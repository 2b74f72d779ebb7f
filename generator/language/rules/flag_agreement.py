"""Rules for flags, alarms and registers whose properties must agree with each other."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator

from ...model import Alarm, Biss
from ..problems import DocumentReport, quoted
from ..written import LocatedPart
from ..written_layouts import WrittenField, WrittenFieldGroup
from ..written_parts import WrittenSpec
from .parts import (
    FieldList,
    FieldOwner,
    by_name,
    field_lists,
    interface_name_of,
    is_second_reading,
    owner_of_alarm,
    position_names,
)

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
        levels = Counter(flag.active for flag in flags)
        if len(levels) != 2:
            continue  # All flags have the same level, or there are none.
        (usual_level, usual_count), (_, rarer_count) = levels.most_common()
        if rarer_count > 1 or usual_count < _LEAST_FLAGS_OF_A_LEVEL:
            continue
        for flag in flags:
            if flag.active != usual_level and not _states_level(flag):
                message = (
                    f"{quoted(flag.name)} is active {flag.active}, but the other {usual_count} flags of"
                    f" {quoted(field_list.name)} are active {usual_level}; correct it, or say in its 'meaning' that it"
                    f" is active {flag.active}"
                )
                report.add("level-differs", flag.place_of("active"), message)


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
    first_flags: dict[tuple[str, str], WrittenField] = {}
    for field_list in field_lists(spec):
        if field_list.interface == Biss.name:
            continue  # Another rule checks the flags of BiSS.
        if field_list.owner_kind not in (FieldOwner.GROUP, FieldOwner.LAYOUT):
            continue
        flags = [field for field in field_list.fields if field.active]
        for flag in flags:
            # Groups have an empty interface name.
            first_flag = first_flags.setdefault((field_list.interface, flag.name), flag)
            for key in _differing_keys(flag, first_flag):
                line, _ = report.document.position(first_flag.path)
                value, first_value = flag.data[key], first_flag.data[key]
                message = (
                    f"{quoted(flag.name)} has {quoted(key)} {value} here, but {first_value} on line {line}; correct one"
                    " of the two, or rename the flag if it is a different flag"
                )
                report.add("flag-differs", flag.place_of(key), message)


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
        flag = _find_flag(spec, alarm)
        if flag is not None and flag.implemented != alarm.part.implemented:
            flag_text = "is implemented" if flag.implemented else "is not implemented"
            message = (
                f"its flag {quoted(flag.name)} {flag_text}, unlike this alarm; write 'implemented: false' for both"
            )
            key = "implemented" if alarm.has("implemented") else "name"
            report.add("alarm-implemented", (*alarm.path, key), message)


def _find_flag(spec: WrittenSpec, alarm: LocatedPart[Alarm]) -> WrittenField | None:
    """Return the flag that an alarm names in its group or register, or None if the alarm names no existing flag."""
    group_or_register = owner_of_alarm(spec, alarm)
    if group_or_register is None or not alarm.part.field:
        return None
    for field in group_or_register.fields:
        if field.name == alarm.part.field:
            return field
    return None


def check_cleared_registers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a register that clears itself returns to 0, unless its note gives another number."""
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    for register in spec.registers:
        default = register.default
        if register.clears_itself and default and not _contains_number(register.note, default):
            message = (
                f"{quoted(register.name)} clears itself, but its default is {default:#04x}; correct one of the two, or"
                f" say in a 'note' that it returns to {default:02X}h"
            )
            report.add("default-mismatch", register.place_of("default"), message)


def _contains_number(text: str, number: int) -> bool:
    """Return True if a text contains a number, in decimal or in hexadecimal."""
    return re.search(rf"\b(?:{number}|{number:02X}h|0x{number:02x})\b", text, re.IGNORECASE) is not None


def check_combined_flags(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each flag is combined by at most one other flag, and that flags of a group are combined together.

    A flag combines the flags in its ``sums_up``: it is active while one of them is.
    """
    groups = by_name(spec.field_groups)
    for field_list in field_lists(spec):
        first_combining_flags: dict[str, str] = {}  # For each combined flag, the first flag that combines it.
        for flag in field_list.fields:
            for index, combined_name in enumerate(flag.sums_up):
                first_name = first_combining_flags.setdefault(combined_name, flag.name)
                if flag.name != first_name:
                    message = f"{quoted(first_name)} also combines {quoted(combined_name)}"
                    path = (*flag.place_of("sums_up"), index)
                    report.add("summed-twice", path, f"{message}; remove it from one of the two")
        for group in groups.values():
            _report_flag_not_combined(group, first_combining_flags.keys(), field_list, report)


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
    if not _mentions_word(flag.meaning, "combine"):
        message = (
            f"{quoted(flag.name)} is not combined by any flag of {quoted(field_list.name)}, unlike the rest of"
            f" {quoted(group.name)}; add it to 'sums_up' of a flag, or say in its 'meaning' that no flag combines it"
        )
        report.add("not-summed", flag.place_of("name"), message)


def _mentions_word(text: str, word: str) -> bool:
    return word in text.casefold()


#: Verdicts on the position in ascending order of severity.
_MILDEST_FIRST = ("usable", "usable_with_warning", "not_usable")


def check_combined_verdicts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a flag that combines others has a verdict on the position that is at least as severe as theirs.

    A flag is checked only if it and all flags in its ``sums_up`` have a verdict.
    """
    single_flags: dict[str, WrittenField] = {}
    for field_list in field_lists(spec):
        single_flags |= {field.name: field for field in field_list.fields if field.active and not field.sums_up}
    for field_list in field_lists(spec):
        for flag in field_list.fields:
            combined_flags = [single_flags[name] for name in flag.sums_up if name in single_flags]
            verdicts = [combined_flag.makes_position for combined_flag in combined_flags]
            all_have_verdict = {flag.makes_position, *verdicts} <= set(_MILDEST_FIRST)
            if not verdicts or not all_have_verdict:
                continue
            most_severe = max(verdicts, key=_MILDEST_FIRST.index)
            is_milder = _MILDEST_FIRST.index(flag.makes_position) < _MILDEST_FIRST.index(most_severe)
            if is_milder:
                message = (
                    f"{quoted(flag.name)} makes the position {flag.makes_position}, but the most severe of the flags"
                    f" that it combines makes it {most_severe}; correct one of them"
                )
                report.add("summed-verdict", flag.place_of("makes_position"), message)


def check_explained_flags(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no diagnostic bit is listed in ``explained_by`` of two flags of a register, whose details it gives."""
    for register in spec.registers:
        explained_flags: dict[str, str] = {}  # For each diagnostic bit, the first flag that it explains.
        for flag in register.fields:
            for index, diagnostic_bit in enumerate(flag.explained_by):
                if diagnostic_bit in explained_flags:
                    problem = f"{quoted(diagnostic_bit)} already explains {quoted(explained_flags[diagnostic_bit])}"
                    path = (*flag.place_of("explained_by"), index)
                    report.add("explains-twice", path, f"{problem}; remove it from one of the two")
                explained_flags.setdefault(diagnostic_bit, flag.name)


def check_read_only_registers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a register with only flags of alarms, or with the position, is writable only with a reason.

    The reason is a named value, a procedure that writes it, a key that matters only for writing, or a text with "writ".
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    written_names: set[str] = set()
    for procedure in spec.procedures:
        written_names.update(step.register for step in procedure.steps if step.do == "write")
    registers_of_alarms = {alarm.part.register for alarm in spec.alarms} | set(_explaining_registers(spec))
    for register in spec.registers:
        if register.access != "read_write":
            continue
        has_values = any(field.values for field in register.fields)
        is_written = has_values or register.name in written_names or register.has(*_KEYS_OF_WRITABLE)
        is_explained = _mentions_word(register.meaning, "writ") or _mentions_word(register.note, "writ")
        if is_written or is_explained:
            continue
        has_explained_flag = any(field.explained_by for field in register.fields)
        has_flag_of_alarm = has_explained_flag or register.name in registers_of_alarms
        has_only_flags = has_flag_of_alarm and all(map(_is_flag_or_fixed, register.fields))
        has_position = register.name in position_names(spec, interface_name_of(register))
        if has_only_flags or has_position:
            content_text = "flags of alarms" if has_only_flags else "the position"
            message = (
                f"{quoted(register.name)} has {content_text}, and nothing says what to write there; write 'access:"
                " read_only', or say in a 'note' what can be written"
            )
            report.add("access-mismatch", register.place_of("access"), message)


def _is_flag_or_fixed(field: WrittenField) -> bool:
    return bool(field.active) or field.constant is not None or field.unused is not None


def _explaining_registers(spec: WrittenSpec) -> Iterator[str]:
    """Yield the name of the register of each bit, written as ``register.bit``, that gives details of a flag.

    Names may repeat.
    """
    for register in spec.registers:
        for field in register.fields:
            for bit_path in field.explained_by:
                register_name, _, _ = bit_path.partition(".")
                yield register_name


#: Keys of a register that matter only if it is written.
_KEYS_OF_WRITABLE = ("default", "min", "max", "meanings", "opened_by", "clears_itself", "write_clears")


#: A sentence such as "The register automatically returns to 0" or "It returns to 00h by itself".
_RETURNS_BY_ITSELF = re.compile(
    r"\bautomatically returns to 0|\breturns to 0+h? (?:automatically|by itself)", re.IGNORECASE
)


def check_returning_registers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a register whose note says that it returns to 0 by itself has ``clears_itself: true``."""
    for register in spec.registers:
        if _RETURNS_BY_ITSELF.search(register.note) and not register.clears_itself:
            message = "the note says that the register returns to 0; write 'clears_itself: true', or correct the note"
            key = "clears_itself" if register.has("clears_itself") else "name"
            report.add("words-contradict", register.place_of(key), message)


def check_equal_answers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the two answers to a question that the manual leaves open do not set the same numbers.

    Such answers would have the same effect. Questions with more answers are not checked.
    """
    for alternative in spec.alternatives:
        answers = list(alternative.values.items())
        if len(answers) != 2:
            continue
        (first_name, first_answer), (second_name, second_answer) = answers
        if first_answer.sets and first_answer.sets == second_answer.sets:
            names = f"{quoted(first_name)} and {quoted(second_name)}"
            message = f"{names} set the same numbers; correct one of the two answers"
            report.add("same-answers", second_answer.place_of("sets"), message)
