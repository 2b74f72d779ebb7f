"""Replies to requests: those over RS-485 by data ID, and the exchanges over any interface."""

from __future__ import annotations

from ..model import Constant, CrcValue, Device, Exchange, Interface, Layout, Rs485, Spi
from ..model.record import dataclass
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


@dataclass(frozen=True, slots=True)
class Exchanged:
    """A request with its reply, or None if the encoder does not answer.

    ``repeats_first`` is true if the reply begins with the first byte of the request.
    """

    item: Exchange
    request: Layout
    reply: Layout | None
    repeats_first: bool

    @property
    def defaults(self) -> dict[str, int]:
        """Factory defaults of fields in the request, by name."""
        return {item.name: item.default for item in self.request.fields if item.default is not None}


def exchanges(interface: Interface) -> tuple[Exchanged, ...]:
    """Return the requests of an interface with their replies. T-format requests have data IDs instead."""
    found = interface.exchanges if isinstance(interface, (Rs485, Spi)) else ()
    layouts = {item.name: item for item in interface.layouts}
    return tuple(_exchanged(item, layouts[item.request], layouts.get(item.reply)) for item in found)


def _exchanged(item: Exchange, request: Layout, reply: Layout | None) -> Exchanged:
    first = _first_byte(request)
    repeats = reply is not None and first is not None and first == _first_byte(reply)
    return Exchanged(item, request, reply, repeats)


def _first_byte(layout: Layout) -> list[tuple[int, int, int, int | str]] | None:
    """Return the bits of the first byte with their constants or fields, or None if others are among them."""
    found = []
    for field in layout.fields:
        known: int | str = field.kind.value if isinstance(field.kind, Constant) else field.name
        if field.carries_data or isinstance(field.kind, Constant):
            found += [(item.right, item.mask, item.left, known) for item in field.pieces if item.byte == 0]
    bits = sum(mask.bit_count() for _, mask, _, _ in found)
    return sorted(found, key=lambda item: item[0]) if bits == 8 else None
