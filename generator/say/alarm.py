"""Statements about an error or a warning of an encoder."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Alarm, Device
from .erratum import errata, erratum
from .name import register_field, title
from .only import only
from .steps import remedied
from .text import Code, Ref, Said, listed, said, told
from .words import volts


def alarm(device: Device, item: Alarm) -> Iterator[Said]:
    """Yield all statements that follow its name in running text."""
    yield from told(item.meaning, source=item.source)
    yield from facts(device, item)
    yield from map(erratum, errata(device, f"alarms.{item.name}"))


def facts(device: Device, item: Alarm) -> Iterator[Said]:
    """Yield the flag that shows it, its cause, and the procedures that clear it."""
    if item.group:
        group = next(one for one in device.field_groups if one.name == item.group)
        yield said(Code(item.field), " in ", Ref("group", group.name, title(group)), label="Flag")
    elif item.register:
        yield said(register_field(device, f"{item.register}.{item.field}".rstrip(".")), label="Flag")
    if not item.implemented and "not implemented" not in item.meaning.lower():
        yield said("Not implemented in this encoder")
    yield from told(item.detected, label="Detected")
    if item.below_mv is not None:
        yield said(f"Raised below {volts(item.below_mv)}")
    if item.latch is not None:
        yield said("Stays active until it is reset" if item.latch else "Clears itself when its cause is gone")
    yield from remedied(item.remedy, item.by_hand)
    yield from only(item.only)
    if item.cleared_by:
        procedures = [Ref("procedure", name, name) for name in item.cleared_by]
        yield said(*listed(procedures, " or "), label="Cleared by")
