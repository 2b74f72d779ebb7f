"""What an encoder reports of itself with a flag: the texts for a terminal, a table in C, and objects in Python."""

from __future__ import annotations

from ..model import Alarm, Device, Field, Flag, Sources, Unused
from .field import short
from .steps import with_steps
from .words import sentence


def alarm_of(device: Device, field: Field, register: str = "") -> Alarm | None:
    """What the manual says of a flag of a frame, or of a register, among its alarms."""
    for item in device.alarms:
        here = item.register == register if register else bool(item.group) and item.group == field.group
        if here and item.field == field.name:
            return item
    return None


def meaning(field: Field, alarm: Alarm | None) -> str:
    """What it means that the flag is active, or that unused bits are not as the manual has them."""
    if isinstance(field.kind, Unused):
        wrong = f"differs from the manual, which has {short(field.kind.value)} in these unused bits"
        return f"{wrong}. {sentence(field.meaning)}" if field.meaning else wrong
    active = field.kind.when_active if isinstance(field.kind, Flag) else ""
    if not field.implemented:
        return active or "active, although the manual says that this encoder does not have it"
    texts = [text for text in (active, field.meaning) if text]
    if not texts:
        return alarm.meaning if alarm is not None and alarm.meaning else "active"
    return texts[0] if len(texts) == 1 else " ".join(map(sentence, texts))


def remedy(field: Field, alarm: Alarm | None) -> str:
    """What the manual advises, with the title of the steps by hand; empty where it does not advise anything."""
    return with_steps(advice(field, alarm), by_hand(field, alarm))


def advice(field: Field, alarm: Alarm | None) -> str:
    """What the manual advises, without the steps by hand."""
    return field.remedy or (alarm.remedy if alarm is not None else "")


def by_hand(field: Field, alarm: Alarm | None) -> tuple[str, ...]:
    """The names of the steps by hand that the manual advises."""
    return field.by_hand or (alarm.by_hand if alarm is not None else ())


def source(field: Field, alarm: Alarm | None) -> Sources:
    """Where the manual says so: beside the alarm, or else beside the flag."""
    return alarm.source if alarm is not None and alarm.source else field.source
