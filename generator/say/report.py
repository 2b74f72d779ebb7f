"""Texts for the report of a flag, used on a terminal, in a C table, and in Python objects."""

from __future__ import annotations

from collections.abc import Iterable

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
)
from .field import short
from .steps import with_steps
from .text import Code, Part, Statement, parted, statement
from .words import sentence


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
