"""Replies to requests: those over RS-485 by data ID, and the exchanges over any interface."""

from __future__ import annotations

from ..model import Constant, CrcValue, Device, Exchange, Interface, Layout, Rs485, Spi, member_named
from ..model.record import dataclass
from .frames import dispatches


@dataclass(frozen=True, slots=True)
class Reply:
    """A reply. ``length`` is in bytes. ``is_xor`` is true if its last byte is the XOR of all others."""

    length: int
    is_xor: bool


def reply_to(device: Device, interface: str, data_id: str) -> Reply | None:
    """Return the encoder's reply to a request, or None if the spec has none."""
    rs485 = device.interface(interface)
    if not isinstance(rs485, Rs485):
        return None
    layout = answer(rs485, member_named(rs485.data_ids, data_id, "data ID").id)
    if layout is None or not layout.bits.is_constant:
        return None
    kind = layout.crc_field.kind if layout.crc_field is not None else None
    is_xor = isinstance(kind, CrcValue) and any(crc.is_xor for crc in device.crcs if crc.name == kind.crc)
    return Reply(layout.bits.constant // 8, is_xor)


def answer(interface: Rs485, value: int) -> Layout | None:
    """Return the frame with which the encoder answers a data ID, or None if the spec has none."""
    for dispatch in dispatches(interface.layouts):
        if dispatch.sender == "encoder":
            return next((branch.layout for branch in dispatch.branches if value in branch.values), dispatch.fallback)
    replies = [layout for layout in interface.layouts if layout.sender == "encoder"]
    return replies[0] if len(replies) == 1 else None


@dataclass(frozen=True, slots=True)
class Exchanged:
    """A request with its reply, or None if the encoder does not answer.

    ``repeats_first`` is true if the reply begins with the first byte of the request.
    """

    exchange: Exchange
    request: Layout
    reply: Layout | None
    repeats_first: bool

    @property
    def defaults(self) -> dict[str, int]:
        """Factory defaults of fields in the request, by name."""
        return {field.name: field.default for field in self.request.fields if field.default is not None}


def exchanges(interface: Interface) -> tuple[Exchanged, ...]:
    """Return the requests of an interface with their replies. T-format requests have data IDs instead."""
    spec_exchanges = interface.exchanges if isinstance(interface, (Rs485, Spi)) else ()
    layouts = {layout.name: layout for layout in interface.layouts}
    return tuple(_with_reply(spec, layouts[spec.request], layouts.get(spec.reply)) for spec in spec_exchanges)


def _with_reply(exchange: Exchange, request: Layout, reply: Layout | None) -> Exchanged:
    first = _first_byte(request)
    repeats = reply is not None and first is not None and first == _first_byte(reply)
    return Exchanged(exchange, request, reply, repeats)


def _first_byte(layout: Layout) -> list[tuple[int, int, int, int | str]] | None:
    """Return the bits of the first byte with their constants or fields, or None if others are among them."""
    byte_bits = []
    for field in layout.fields:
        content: int | str = field.kind.value if isinstance(field.kind, Constant) else field.name
        if field.carries_data or isinstance(field.kind, Constant):
            byte_bits += [(piece.right, piece.mask, piece.left, content) for piece in field.pieces if piece.byte == 0]
    bits = sum(mask.bit_count() for _, mask, _, _ in byte_bits)
    return sorted(byte_bits, key=lambda bits_of_piece: bits_of_piece[0]) if bits == 8 else None
