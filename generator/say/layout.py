"""What is said of a frame: who sends it, what tells it from others, and which of its fields belong together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model import Alternative, Device, Interface, Join, Layout, Rs485, choices
from .alternative import names, needs
from .erratum import errata, erratum
from .text import Code, Part, Said, listed, said, told
from .words import counted


def head(interface: Interface, layout: Layout, name: Part, alternatives: Sequence[Alternative] = ()) -> Said:
    """Which frame it is, by the ``name`` that the reader knows it by.

    Where its length depends on nothing but ``alternatives``, each length has its answers.
    """
    channel = f", data channel {layout.channel}" if layout.channel is not None else ""
    sent = f", sent by the {layout.sender} over {interface.title}{channel}: "
    return said(name, sent, *size(layout, alternatives), source=layout.source)


def size(layout: Layout, alternatives: Sequence[Alternative] = ()) -> tuple[Part, ...]:
    """Its length, and in which order it is sent."""
    if not layout.in_bytes:
        return *_bits(layout, alternatives), " bits, most significant first"
    order = f", {layout.byte_order.replace('_', ' ')}" if layout.widest > 8 else ""
    return (counted(layout.widest // 8, "byte") + order,)


def _bits(layout: Layout, alternatives: Sequence[Alternative]) -> Iterator[Part]:
    needed = set(layout.bits.parameters)
    deciding = [item for item in alternatives if not needed.isdisjoint(item.answers[0].sets)]
    if not deciding or not needed.issubset(name for item in deciding for name in item.answers[0].sets):
        yield layout.bits
        return
    for index, (answers, sets) in enumerate(choices(deciding)):
        yield from (" or " if index else "", f"{layout.bits.value(sets)} (", *names(answers), ")")


def layout(device: Device, interface: Interface, item: Layout) -> Iterator[Said]:
    """All that running text says below the head, in order."""
    yield from told(item.printed_name, label="In the manual")
    yield from facts(interface, item)
    yield from needs(device, item)
    yield from told(item.note)
    yield from errata_of(device, interface, item)


def errata_of(device: Device, interface: Interface, item: Layout) -> Iterator[Said]:
    """The errata of the frame as a whole."""
    yield from map(erratum, errata(device, f"interfaces.{interface.name}.{item.name}"))


def facts(interface: Interface, layout: Layout) -> Iterator[Said]:
    """What tells it from others, its code, its gaps, and the numbers that several fields make."""
    yield from carries(interface, layout)
    if layout.gray_when:
        when = Code(layout.gray_when)
        yield said(Code(layout.gray_of), " is in Gray code while ", when, " is 1, and in binary while it is 0")
    elif layout.gray_of:
        yield said(Code(layout.gray_of), " is in Gray code")
    if layout.gaps:
        yield said(f"Bits without a field are {layout.gaps}")
    yield from joins(layout)


def carries(interface: Interface, layout: Layout) -> Iterator[Said]:
    """The values that tell it from other frames."""
    if layout.selects:
        names = {item.id: item.name for item in interface.data_ids} if isinstance(interface, Rs485) else {}
        values = [f"{value:X}" + (f" ({names[value]})" if value in names else "") for value in layout.selects]
        yield said("Carries ", Code(layout.selector), " ", *listed(values, " or "))


def joins(layout: Layout) -> Iterator[Said]:
    """The numbers that several fields make."""
    return (join(item) for item in layout.joins if item.fields != (item.name,))


def join(item: Join) -> Said:
    """Which fields make a number."""
    parts = listed([Code(name) for name in item.fields])
    return said(Code(item.name), " is made of ", *parts, ", most significant first")


def as_one_number(parts: str) -> str:
    """What the number is that these fields make."""
    return f"{parts} as one number"
