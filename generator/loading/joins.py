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
        problems_before = len(site.context.report)
        for index, name in enumerate(join.fields):
            if name in join.fields[:index]:
                site.report("join-order", f"'{join.name}' contains '{name}' twice", "join", join.name, index)
            elif name in fields and (at_fault := _no_plain_bits(fields[name].kind)):
                remedy = f"{', or' if ';' in at_fault else ';'} leave '{name}' out of '{join.name}'"
                message = f"'{join.name}' contains '{name}', {at_fault}{remedy}"
                site.report("join-of", message, "join", join.name, index)
        pairs = [pair for pair in pairwise(join.fields) if pair[0] != pair[1] and {*pair} <= fields.keys()]
        for index, (above, below) in enumerate(pairs, 1):
            first, last = (above, below) if low_first else (below, above)
            if not layout.in_bytes and _is_above(fields[first], fields[last], site):
                message = f"'{join.name}' has '{above}' above '{below}', but '{layout.name}' sends '{first}' first"
                site.report("join-order", message + _remedy(low_first, site), "join", join.name, index)
        if len(site.context.report) > problems_before:
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
            message = f"'{field.name}' has {field.widest} bits, but the low byte of each number comes first"
            site.report("join-order", f"{message}; describe each byte as a field, and join them", "fields", field.name)


def _is_zeros(kind: Kind) -> bool:
    """Return whether a field always consists of zeros."""
    return isinstance(kind, Constant) and kind.value == 0


def _check_parities(layout: Layout, site: Site) -> None:
    """Check that parity bits cover data fields, each at most once."""
    for field in layout.fields:
        covered_names = field.kind.covers if isinstance(field.kind, Parity) else ()
        for index, name in enumerate(covered_names):
            kind = next((candidate.kind for candidate in layout.fields if candidate.name == name), None)
            problem = ""
            if name in covered_names[:index]:
                problem = f"'{field.name}' covers '{name}' twice; list it once"
            elif isinstance(kind, (CrcValue, Parity)):
                problem = f"the parity bit '{field.name}' cannot cover '{name}', which is computed itself; leave it out"
            if problem:
                site.report("parity-of", problem, "fields", field.name, "parity_of")
        covers_odd_bits = any(covered.widest > 1 for covered in layout.fields if covered.name in covered_names)
        if isinstance(field.kind, Parity) and field.kind.over == "odd_bits" and not covers_odd_bits:
            problem = f"'{field.name}' covers no bit, since no covered field has a bit 1; write 'over: even_bits'"
            site.report("parity-of", problem, "fields", field.name, "parity_of")


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
    members = [field for name in layout.names_in(layout.gray_of) for field in layout.fields if field.name == name]
    not_a_number = next((field for field in members if not isinstance(field.kind, (Number, Choice, Flag))), None)
    if not_a_number is not None or (len(members) == 1 and members[0].widest == 1):
        at_fault = not_a_number or members[0]
        is_number_or_flag = isinstance(at_fault.kind, (Number, Choice, Flag))
        problem = f"'{at_fault.name}' {'has one bit' if is_number_or_flag else 'is not a number'}"
        site.report("gray-of", f"{problem}; only a number of several bits can be in Gray code", "gray", "of")
    codes = {values[layout.gray_when] for values in site.sets if layout.gray_when in values}
    if not codes <= {0, 1}:
        message = f"'{layout.gray_when}' can be {max(codes)}; it must be 1 for Gray code, or 0 for binary"
        site.report("gray-of", message, "gray", "when")
    _check_parity_of_gray(layout, site)
    for above, below in pairwise(members):
        if any(below.low.value(values) + below.width.value(values) != above.low.value(values) for values in site.sets):
            message = (
                f"'{above.name}' and '{below.name}' are not adjacent; a number in Gray code must be contiguous,"
                " most significant part first"
            )
            site.report("gray-of", message, "gray", "of")
            return


def _check_parity_of_gray(layout: Layout, site: Site) -> None:
    """Check that no parity bit covers a number in Gray code."""
    for field in layout.fields:
        for covered_name in field.kind.of if isinstance(field.kind, Parity) else ():
            if covered_name in layout.names_in(layout.gray_of):
                message = (
                    f"'{field.name}' covers '{covered_name}', which is sent in Gray code, of which decoders cannot"
                    " check the parity; write 'bits: 1' instead of 'parity_of', and compare the bit in your program"
                )
                site.report("gray-of", message, "fields", field.name, "parity_of")


def _is_above(upper: Field, lower: Field, site: Site) -> bool:
    sets = [values for values in site.sets if upper.width.value(values) and lower.width.value(values)]
    return any(upper.low.value(values) > lower.low.value(values) for values in sets)
