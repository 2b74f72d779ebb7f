"""Checks of joined numbers, parity bits and numbers in Gray code in a layout."""

from __future__ import annotations

from itertools import pairwise

from ..model import (
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Field,
    Flag,
    Kind,
    Layout,
    Number,
    Parity,
    Spi,
    Text,
    Unused,
    assert_never,
)
from .fields import Site


def check_joined(layout: Layout, site: Site, low_byte_first: bool) -> None:
    """Check the joined numbers, parity bits and Gray code of a layout. Each number is reported once.

    If a layout that is carried as bits sends the low byte first, joins put its bytes in order.
    """
    low_first = low_byte_first and not layout.in_bytes
    faulty = _check_joins(layout, site, low_first)
    if low_first:
        _check_bytes(layout, site)
    _check_parities(layout, site)
    if layout.gray_of and layout.gray_of not in faulty:
        _check_gray(layout, site)


def _check_joins(layout: Layout, site: Site, low_first: bool) -> set[str]:
    """Check that joined numbers contain plain bits, no field twice and, in a word, fields in sending order.

    With ``low_first``, that order is reversed.
    """
    fields = {field.name: field for field in layout.fields}
    faulty: set[str] = set()
    for join in layout.joins:
        before = len(site.context.report)
        for index, name in enumerate(join.fields):
            if name in join.fields[:index]:
                site.report("join-order", f"'{join.name}' contains '{name}' twice", "join", join.name, index)
            elif name in fields and (at_fault := _no_plain_bits(fields[name].kind)):
                way = f"{', or' if ';' in at_fault else ';'} leave '{name}' out of '{join.name}'"
                wrong = f"'{join.name}' contains '{name}', {at_fault}{way}"
                site.report("join-of", wrong, "join", join.name, index)
        pairs = [pair for pair in pairwise(join.fields) if pair[0] != pair[1] and {*pair} <= fields.keys()]
        for index, (above, below) in enumerate(pairs, 1):
            first, last = (above, below) if low_first else (below, above)
            if not layout.in_bytes and _is_above(fields[first], fields[last], site):
                wrong = f"'{join.name}' has '{above}' above '{below}', but '{layout.name}' sends '{first}' first"
                site.report("join-order", wrong + _remedy(low_first, site), "join", join.name, index)
        if len(site.context.report) > before:
            faulty.add(join.name)
    return faulty


def _remedy(low_first: bool, site: Site) -> str:
    if low_first:
        return ", and the low byte of each number comes first"
    if site.interface == Spi.name:
        return "; list the more significant part first, or write 'byte_order: low_byte_first' if it is sent last"
    return ", with the more significant bits"


def _check_bytes(layout: Layout, site: Site) -> None:
    """Check that no field contains two bytes of a number whose low byte comes first."""
    for field in layout.fields:
        is_number = not isinstance(field.kind, Unused) and not _is_zeros(field.kind)
        if is_number and field.widest > 8:
            wrong = f"'{field.name}' has {field.widest} bits, but the low byte of each number comes first"
            site.report("join-order", f"{wrong}; describe each byte as a field, and join them", "fields", field.name)


def _is_zeros(kind: Kind) -> bool:
    """Return whether a field always consists of zeros."""
    return isinstance(kind, Constant) and kind.value == 0


def _check_parities(layout: Layout, site: Site) -> None:
    """Check that parity bits cover data fields, each at most once."""
    for field in layout.fields:
        of = field.kind.covers if isinstance(field.kind, Parity) else ()
        for index, name in enumerate(of):
            kind = next((item.kind for item in layout.fields if item.name == name), None)
            wrong = ""
            if name in of[:index]:
                wrong = f"'{field.name}' covers '{name}' twice; list it once"
            elif isinstance(kind, (CrcValue, Parity)):
                wrong = f"the parity bit '{field.name}' cannot cover '{name}', which is computed itself; leave it out"
            if wrong:
                site.report("parity-of", wrong, "fields", field.name, "parity_of")
        covers_odd_bits = any(item.widest > 1 for item in layout.fields if item.name in of)
        if isinstance(field.kind, Parity) and field.kind.over == "odd_bits" and not covers_odd_bits:
            wrong = f"'{field.name}' covers no bit, since no covered field has a bit 1; write 'over: even_bits'"
            site.report("parity-of", wrong, "fields", field.name, "parity_of")


def _no_plain_bits(kind: Kind) -> str:
    """Return the reason that a joined number cannot contain a field of this kind, and the remedy. Empty if it can.

    A joined number consists of bits as sent. A part with a different value would contradict it.
    """
    match kind:
        case Number(signed=True):
            return "which is signed; leave 'signed' out"
        case Number(zero_means=0) | Flag(active_low=False) | Choice() | Decimal():
            return ""
        case Number():
            return "which has 'zero_means'; leave 'zero_means' out"
        case Flag():
            return "which is active low"
        case Constant() | Unused() | CrcValue() | Parity() | Text():
            return "which is not a number; define it with 'bits' and no kind"
        case _:
            assert_never(kind)


def _check_gray(layout: Layout, site: Site) -> None:
    """Check that a number in Gray code has several contiguous bits. They can include a flag."""
    parts = [field for name in layout.names_in(layout.gray_of) for field in layout.fields if field.name == name]
    other = next((field for field in parts if not isinstance(field.kind, (Number, Choice, Flag))), None)
    if other is not None or (len(parts) == 1 and parts[0].widest == 1):
        at_fault = other or parts[0]
        is_number_or_flag = isinstance(at_fault.kind, (Number, Choice, Flag))
        what = f"'{at_fault.name}' {'has one bit' if is_number_or_flag else 'is not a number'}"
        site.report("gray-of", f"{what}; only a number of several bits can be in Gray code", "gray", "of")
    codes = {values[layout.gray_when] for values in site.sets if layout.gray_when in values}
    if not codes <= {0, 1}:
        wrong = f"'{layout.gray_when}' can be {max(codes)}; it must be 1 for Gray code, or 0 for binary"
        site.report("gray-of", wrong, "gray", "when")
    pairs = ((item.name, of) for item in layout.fields if isinstance(item.kind, Parity) for of in item.kind.of)
    for name, of in pairs:
        if of in layout.names_in(layout.gray_of):
            wrong = (
                f"'{name}' covers '{of}', which is sent in Gray code, of which decoders cannot check the parity;"
                " write 'bits: 1' instead of 'parity_of', and compare the bit in your program"
            )
            site.report("gray-of", wrong, "fields", name, "parity_of")
    for above, below in pairwise(parts):
        if any(below.low.value(values) + below.width.value(values) != above.low.value(values) for values in site.sets):
            wrong = (
                f"'{above.name}' and '{below.name}' are not adjacent; a number in Gray code must be contiguous,"
                " most significant part first"
            )
            site.report("gray-of", wrong, "gray", "of")
            return


def _is_above(field: Field, other: Field, site: Site) -> bool:
    both = [values for values in site.sets if field.width.value(values) and other.width.value(values)]
    return any(field.low.value(values) > other.low.value(values) for values in both)
