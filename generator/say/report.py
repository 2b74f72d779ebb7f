"""Statements about the reports of an encoder: flags, errors, warnings and their remedies."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..model import (
    Alarm,
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Device,
    Field,
    Flag,
    Number,
    Parity,
    Sources,
    Text,
    Unused,
    assert_never,
    member_named,
)
from .commands import remedied, with_steps
from .errata import errata, erratum
from .names_and_places import only, register_field, title
from .register import short
from .text import Code, Part, Ref, Statement, listed, parted, sentence, spec_text, statement, volts


def alarm(device: Device, device_alarm: Alarm) -> Iterator[Statement]:
    """Yield all statements that follow its name in running text."""
    yield from spec_text(device_alarm.meaning, source=device_alarm.source)
    yield from alarm_facts(device, device_alarm)
    yield from map(erratum, errata(device, f"alarms.{device_alarm.name}"))


def alarm_facts(device: Device, device_alarm: Alarm) -> Iterator[Statement]:
    """Yield the flag that shows it, its cause, and the procedures that clear it."""
    if device_alarm.group:
        group = member_named(device.field_groups, device_alarm.group, "field group")
        yield statement(Code(device_alarm.field), " in ", Ref("group", group.name, title(group)), label="Flag")
    elif device_alarm.register:
        yield statement(
            register_field(device, f"{device_alarm.register}.{device_alarm.field}".rstrip(".")), label="Flag"
        )
    if not device_alarm.implemented and "not implemented" not in device_alarm.meaning.lower():
        yield statement("Not implemented in this encoder")
    yield from spec_text(device_alarm.detected, label="Detected")
    if device_alarm.below_mv is not None:
        yield statement(f"Raised below {volts(device_alarm.below_mv)}")
    if device_alarm.latch is not None:
        yield statement(
            "Stays active until it is reset" if device_alarm.latch else "Clears itself when its cause is gone"
        )
    yield from remedied(device_alarm.remedy, device_alarm.by_hand)
    yield from only(device_alarm.only)
    if device_alarm.cleared_by:
        procedures = [Ref("procedure", name, name) for name in device_alarm.cleared_by]
        yield statement(*listed(procedures, " or "), label="Cleared by")


def alarm_of(device: Device, field: Field, register: str = "") -> Alarm | None:
    """Return the alarm of a flag in a frame or register, if the manual has one."""
    for alarm in device.alarms:
        is_same_owner = alarm.register == register if register else bool(alarm.group) and alarm.group == field.group
        if is_same_owner and alarm.field == field.name:
            return alarm
    return None


def states(field: Field) -> tuple[str, str]:
    """Return the meanings of the active and the inactive flag, or two empty texts for any other field."""
    return (field.kind.when_active, field.kind.when_inactive) if isinstance(field.kind, Flag) else ("", "")


def meaning(field: Field, alarm: Alarm | None) -> str:
    """Return the meaning of an active flag, or of unused bits that differ from the manual."""
    if isinstance(field.kind, Unused):
        problem = f"unused bits differ from the documented value {short(field.kind.value)}"
        return f"{problem}. {sentence(field.meaning)}" if field.meaning else problem
    active, _ = states(field)
    if not field.implemented:
        return active or "active, although the manual says that this encoder does not have it"
    texts = [text for text in (active, field.meaning) if text]
    if not texts:
        return alarm.meaning if alarm is not None and alarm.meaning else "active"
    return texts[0] if len(texts) == 1 else " ".join(map(sentence, texts))


def deciding(field: Field) -> str:
    """Return the bits of a flag or an unused field that lead to its verdict, or an empty string for any other field."""
    match field.kind:
        case Flag(active_low=low):
            return "0" if low else "1"
        case Unused(value=value):
            return f"{1 - value}" if field.widest == 1 else f"not {short(value)}"
        case Number() | Choice() | Constant() | CrcValue() | Parity() | Decimal() | Text():
            return ""
        case _:
            assert_never(field.kind)


def conditions(values: Iterable[tuple[Field, int]]) -> Statement:
    """Return the values that lead to a verdict together, with the bits of each field. 1 stands for an active flag."""
    return statement(*parted((_condition(field, value) for field, value in values), " and "))


def _condition(field: Field, value: int) -> tuple[Part, ...]:
    if isinstance(field.kind, Flag):
        return Code(field.name), f" is {int(bool(value) != field.kind.active_low)}"
    return Code(field.name), f" is {short(value)} (", Code(field.value_of(value).name), ")"


def remedy(field: Field, alarm: Alarm | None) -> str:
    """Return the remedy with the titles of its manual steps, or an empty string."""
    return with_steps(remedy_text(field, alarm), by_hand(field, alarm))


def remedy_text(field: Field, alarm: Alarm | None) -> str:
    """Return the remedy without its manual steps."""
    return field.remedy or (alarm.remedy if alarm is not None else "")


def by_hand(field: Field, alarm: Alarm | None) -> tuple[str, ...]:
    """Return the names of the recommended manual steps."""
    return field.by_hand or (alarm.by_hand if alarm is not None else ())


def source(field: Field, alarm: Alarm | None) -> Sources:
    """Return the source of the alarm if it has one, otherwise the source of the flag."""
    return alarm.source if alarm is not None and alarm.source else field.source
