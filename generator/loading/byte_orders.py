"""Byte orders of single fields, such as a CRC that is sent low byte first in a frame with the high byte first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..model import INTERFACES, Field, Layout
from .fields import LayoutSite


def with_byte_orders(fields: Sequence[Field], byte_order: str) -> list[Field]:
    """Return fields without a ``byte_order`` that is the same as that of their layout, ``byte_order``."""
    return [replace(field, byte_order="") if field.byte_order == byte_order else field for field in fields]


def check_byte_orders(layout: Layout, site: LayoutSite) -> None:
    """Report a field with a byte order of its own that does not consist of whole bytes in a frame of bytes."""
    for field in layout.fields:
        if field.byte_order:
            problem = _problem_of_byte_order(layout, field, site)
            if problem:
                site.report("byte-order", problem, "fields", field.name, "byte_order")


def _problem_of_byte_order(layout: Layout, field: Field, site: LayoutSite) -> str:
    """Return why a field cannot have a byte order that differs from that of its layout, with a fix, or ""."""
    name = f"'{field.name}'"
    if site.path[0] == "registers":
        return f"{name} is in a register, whose 'byte_order' applies to all fields; remove 'byte_order' here"
    if INTERFACES[site.interface].carried_as == "bits":
        title = INTERFACES[site.interface].title
        return f"{name} is sent over {title}, as bits; describe each byte as a field, and 'join' them"
    if field.name == layout.selector:
        return f"{name} distinguishes frames, so its bytes have the order of the layout; remove 'byte_order'"
    if not field.is_fixed:
        return f"the place or width of {name} depends on the order code; remove 'byte_order', or write constant widths"
    if field.container:
        return f"{name} has 'padded_to'; write its bits with the padding as 'bits', and remove 'padded_to'"
    width, low = field.width.constant, field.low.constant
    if width % 8 or low % 8 or width < 16:
        return f"{name} does not fill two or more whole bytes, so it has no byte order; remove 'byte_order'"
    return ""
