"""Sentences that describe a frame: its sender, its selector, and the fields that form one number."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model import Alternative, Combination, Device, Interface, Join, Layout, Rs485, Sign, choices
from .alternative import names, needs
from .erratum import errata, erratum
from .report import conditions
from .text import Code, Part, Statement, listed, spec_text, statement
from .words import WORTH, counted, sentence


def head(interface: Interface, layout: Layout, name: Part, alternatives: Sequence[Alternative] = ()) -> Statement:
    """Return the frame's ``name``, sender, interface and length.

    If the length depends only on ``alternatives``, each possible length is followed by the answers that lead to it.
    """
    channel = f", data channel {layout.channel}" if layout.channel is not None else ""
    sender_text = f", sent by the {layout.sender} over {interface.title}{channel}: "
    return statement(name, sender_text, *size(layout, alternatives), source=layout.source)


def size(layout: Layout, alternatives: Sequence[Alternative] = ()) -> tuple[Part, ...]:
    """Return its length and transmission order."""
    if not layout.in_bytes:
        return *_bits(layout, alternatives), " bits, most significant first"
    order = f", {layout.byte_order.replace('_', ' ')}" if layout.widest > 8 else ""
    length = counted(layout.widest // 8, "byte") + order
    return (length,) if layout.sent_bits == layout.bits else (layout.sent_bits, f" bits in {length}")


def _bits(layout: Layout, alternatives: Sequence[Alternative]) -> Iterator[Part]:
    needed = set(layout.bits.parameters)
    deciding = [alternative for alternative in alternatives if not needed.isdisjoint(alternative.answers[0].sets)]
    if not deciding or not needed.issubset(name for alternative in deciding for name in alternative.answers[0].sets):
        yield layout.bits
        return
    for index, (answers, sets) in enumerate(choices(deciding)):
        yield from (" or " if index else "", f"{layout.bits.value(sets)} (", *names(answers), ")")


def layout(device: Device, interface: Interface, frame: Layout) -> Iterator[Statement]:
    """Yield all statements that follow the head in running text."""
    yield from spec_text(frame.printed_name, label="In the manual")
    yield from facts(interface, frame)
    yield from needs(device, frame)
    yield from spec_text(frame.note)
    yield from errata_of(device, interface, frame)


def errata_of(device: Device, interface: Interface, frame: Layout) -> Iterator[Statement]:
    """Yield the errata of the whole frame."""
    yield from map(erratum, errata(device, f"interfaces.{interface.name}.{frame.name}"))


def facts(interface: Interface, layout: Layout) -> Iterator[Statement]:
    """Yield its selector, its code, its gaps, its joined numbers and its combinations of values."""
    yield from carries(interface, layout)
    if layout.gray_when:
        parameter = Code(layout.gray_when)
        yield statement(
            Code(layout.gray_of), " is in Gray code while ", parameter, " is 1, and in binary while it is 0"
        )
    elif layout.gray_of:
        yield statement(Code(layout.gray_of), " is in Gray code")
    if layout.gaps:
        yield statement(f"Bits without a field are {layout.gaps}")
    yield from joins(layout)
    combinations = {value_combination.name: value_combination for value_combination in layout.combinations}
    for sign in layout.signs:
        if sign.flag.name in combinations:
            yield combination(layout, sign, combinations[sign.flag.name])


def combination(layout: Layout, sign: Sign, value_combination: Combination) -> Statement:
    """Return the values of a combination with their meaning and the verdict on the position."""
    values = conditions((layout.field(name), value) for name, value in sign.conditions).parts
    texts = (value_combination.meaning, value_combination.remedy, value_combination.note)
    description = " ".join(sentence(text) for text in texts if text).removesuffix(".")
    return statement(
        "While ",
        *values,
        f", {WORTH[value_combination.makes_position]}: ",
        description,
        label=value_combination.name,
        source=value_combination.source,
    )


def carries(interface: Interface, layout: Layout) -> Iterator[Statement]:
    """Yield the selector values that identify the frame."""
    if layout.selects:
        data_ids = interface.data_ids if isinstance(interface, Rs485) else ()
        names = {data_id.id: f" ({data_id.name})" for data_id in data_ids}
        values = [f"{value:X}{names.get(value, '')}" for value in layout.selects]
        yield statement("Its ", Code(layout.selector), " is ", *listed(values, " or "))


def joins(layout: Layout) -> Iterator[Statement]:
    """Yield the numbers that are joined from fields."""
    return (join(joined_number) for joined_number in layout.joins if joined_number.fields != (joined_number.name,))


def join(joined_number: Join) -> Statement:
    """Return the fields that form a number."""
    names = listed([Code(name) for name in joined_number.fields])
    return statement(Code(joined_number.name), " consists of ", *names, ", most significant first")


def as_one_number(parts: str) -> str:
    """Return the phrase for parts that form one number."""
    return f"{parts} as one number"
