"""Statements about an error or a warning of an encoder."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Alarm, Device, member_named
from .erratum import errata, erratum
from .name import register_field, title
from .only import only
from .steps import remedied
from .text import Code, Ref, Statement, listed, spec_text, statement
from .words import volts


def alarm(device: Device, device_alarm: Alarm) -> Iterator[Statement]:
    """Yield all statements that follow its name in running text."""
    yield from spec_text(device_alarm.meaning, source=device_alarm.source)
    yield from facts(device, device_alarm)
    yield from map(erratum, errata(device, f"alarms.{device_alarm.name}"))


def facts(device: Device, device_alarm: Alarm) -> Iterator[Statement]:
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
