"""Alarms in C: their masks and limits."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Alarm, Device
from .about import about_alarm
from .context import Context
from .macros import Macro
from .names import Declared
from .types import number


class AlarmCode:
    def __init__(self, context: Context, alarm: Alarm) -> None:
        self.alarm = alarm
        self.about = about_alarm(context.device, alarm)
        self.macros = tuple(_macros(context.device, alarm, f"{context.PREFIX}_ALARM_{alarm.name.upper()}"))

    def declared(self) -> Iterator[Declared]:
        yield from ((item.name, ("alarms", self.alarm.name)) for item in self.macros)


def _macros(device: Device, alarm: Alarm, stem: str) -> Iterator[Macro]:
    bits, note = _mask(device, alarm)
    if bits:
        yield Macro(f"{stem}_MASK", number(bits, hexadecimal=True), note)
    if alarm.below_mv is not None:
        yield Macro(f"{stem}_BELOW_MV", number(alarm.below_mv), "raised below this, in millivolts")


def _mask(device: Device, alarm: Alarm) -> tuple[int, str]:
    """Return the bits of an alarm, or 0 if they have no place, and a note if they belong to one of several bytes."""
    fields = (field for _, layout in device.layouts() for field in layout.fields if field.group == alarm.group)
    field = next((item for item in fields if item.name == alarm.field and item.pieces), None)
    if alarm.group and field is not None and len(field.pieces) == 1:
        piece = field.pieces[0]
        group = next(item for item in device.field_groups if item.name == alarm.group)
        return piece.mask << piece.right, "in its byte" if group.bits > 8 else ""
    if not alarm.register:
        return 0, ""
    register = device.register(alarm.register)
    item = register.layout.field(alarm.field) if alarm.field else register.layout.fields[0]
    # A flag that moves with the order code has no mask. The register's codec finds it.
    return item.mask_in_place if item.is_fixed else 0, ""
