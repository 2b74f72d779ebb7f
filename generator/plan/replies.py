"""Checks of a reply that a master can make before it has identified the encoder: length, and XOR of the bytes."""

from __future__ import annotations

from dataclasses import dataclass

from ..model import CrcValue, Device, Layout, Rs485
from .frames import dispatches


@dataclass(frozen=True, slots=True)
class Reply:
    """A reply. ``length`` is in bytes. ``is_xor`` is true if its last byte is the XOR of all others."""

    length: int
    is_xor: bool


def reply_to(device: Device, interface: str, data_id: str) -> Reply | None:
    """Return the encoder's reply to a request, or None if the spec has none."""
    of = device.interface(interface)
    if not isinstance(of, Rs485):
        return None
    layout = answer(of, next(item.id for item in of.data_ids if item.name == data_id))
    if layout is None or not layout.bits.is_constant:
        return None
    kind = layout.crc_field.kind if layout.crc_field is not None else None
    is_xor = isinstance(kind, CrcValue) and any(crc.is_xor for crc in device.crcs if crc.name == kind.crc)
    return Reply(layout.bits.constant // 8, is_xor)


def answer(interface: Rs485, value: int) -> Layout | None:
    """Return the frame with which the encoder answers a data ID, or None if the spec has none."""
    for told in dispatches(interface.layouts):
        if told.sender == "encoder":
            return next((item.layout for item in told.branches if value in item.values), told.fallback)
    sent = [item for item in interface.layouts if item.sender == "encoder"]
    return sent[0] if len(sent) == 1 else None
