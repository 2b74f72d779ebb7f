"""Alarms in C: their masks and limits."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Alarm, Device, member_named
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
        yield from ((macro.name, ("alarms", self.alarm.name)) for macro in self.macros)


def _macros(device: Device, alarm: Alarm, stem: str) -> Iterator[Macro]:
    bits, note = _mask(device, alarm)
    if bits:
        yield Macro(f"{stem}_MASK", number(bits, hexadecimal=True), note)
    if alarm.below_mv is not None:
        yield Macro(f"{stem}_BELOW_MV", number(alarm.below_mv), "raised below this, in millivolts")


def _mask(device: Device, alarm: Alarm) -> tuple[int, str]:
    """Return the bits of an alarm, or 0 if they have no place, and a note if they belong to one of several bytes."""
    fields = (field for _, layout in device.layouts() for field in layout.fields if field.group == alarm.group)
    candidates = (field for field in fields if field.name == alarm.field and field.pieces)
    frame_field = next(candidates, None)
    if alarm.group and frame_field is not None and len(frame_field.pieces) == 1:
        piece = frame_field.pieces[0]
        group = member_named(device.field_groups, alarm.group, "field group")
        note = "in its byte" if group.bits > 8 else ""
        return piece.mask << piece.right, note
    if not alarm.register:
        return 0, ""
    layout = device.register(alarm.register).layout
    register_field = layout.field(alarm.field) if alarm.field else layout.fields[0]
    # A flag that moves with the order code has no mask. The register's codec finds it.
    mask = register_field.mask_in_place if register_field.is_fixed else 0
    return mask, ""
