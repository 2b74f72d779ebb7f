"""Checks of a layout whose fields have been placed: lengths, values that fit, a CRC at the end."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, pairwise

from ..language.problems import listed
from ..model import (
    INTERFACES,
    Choice,
    Constant,
    Crc,
    CrcValue,
    Decimal,
    Field,
    Flag,
    Layout,
    Number,
    Parity,
    Spi,
    Text,
    Unused,
    assert_never,
)
from ..model.expressions import Expression
from .fields import Site
from .joins import check_joined

#: Width of the numbers in the generated C.
LARGEST_NUMBER = 64
#: Width up to which frames of whole bytes are tested.
LARGEST_BYTES = 128


def check_layout(layout: Layout, site: Site, low_byte_first: bool) -> bool:
    """Return True if a layout is valid with the parameters of every order code, otherwise report why.

    ``low_byte_first`` is true if the spec says so, also for a layout that is carried as bits.
    """
    problems_before = len(site.context.report)
    on_line = INTERFACES[site.interface].carried_as == "bits" and site.path[0] == "interfaces"
    if layout.in_bytes and (not layout.bits.is_constant or layout.bits.constant % 8):
        message = f"'{layout.name}' has {layout.bits.render()} bits, not a whole number of bytes"
        if on_line and not layout.bits.is_constant:
            message = (
                f"'{layout.name}' has {layout.bits.render()} bits; a frame that is carried as bytes has one length"
            )
        site.report("width-mismatch", message)
    if not layout.in_bytes and layout.widest > LARGEST_NUMBER:
        message = f"'{layout.name}' has {layout.widest} bits; the maximum is {LARGEST_NUMBER}"
        can_be_bytes = layout.bits.is_constant and layout.widest <= LARGEST_BYTES and site.interface != Spi.name
        site.report("too-long", f"{message}, or {LARGEST_BYTES} with 'carried_as: bytes'" if can_be_bytes else message)
    if layout.in_bytes and on_line and layout.widest > LARGEST_BYTES:
        sent_bits = layout.sent_bits.constant
        site.report("too-long", f"'{layout.name}' has {sent_bits} bits; the maximum is {LARGEST_BYTES}")
    for field in layout.fields:
        _check_field(layout, field, replace(site, path=(*site.path, "fields", field.name)))
    selector = next((field for field in layout.fields if field.name == layout.selector), None)
    for selected in layout.selects:
        if selector is not None and selector.values and selected not in [value.value for value in selector.values]:
            site.report("undefined-reference", f"'{layout.selector}' has no value {selected}", "when")
    if layout.unused and "unused" in layout.member_names:
        message = "decoded frames use the name 'unused' for all unused bits; rename the field"
        site.report("duplicate-name", message, "fields", "unused")
    check_joined(layout, site, low_byte_first)
    return len(site.context.report) == problems_before


def _check_field(layout: Layout, field: Field, site: Site) -> None:
    kind, bits = field.kind, field.widest
    is_zeros = field.padding_of or field.fills_gap or field.fills_byte
    if bits > LARGEST_NUMBER and not isinstance(kind, Text) and not is_zeros:
        site.report("too-long", f"'{field.name}' has {bits} bits; the maximum is {LARGEST_NUMBER}")
    match kind:
        case Number():
            _check_number(field, kind, site)
        case Flag():
            _check_one_bit(field, "flag", site)
        case Parity():
            _check_one_bit(field, "parity bit", site)
        case Choice():
            _check_choice(field, kind, site)
        case Constant() | Unused():
            _check_fixed(field, kind, site)
        case Decimal():
            _check_decimal(field, kind, site)
        case Text():
            _check_text(field, site)
        case CrcValue():
            _check_crc(layout, field, kind, site)
        case _:
            assert_never(kind)


def _check_number(field: Field, kind: Number, site: Site) -> None:
    if kind.power_of_two:
        _check_absent(field, "0 is not a power of two; leave 'power_of_two' out", site)


def _check_decimal(field: Field, kind: Decimal, site: Site) -> None:
    if kind.limit > 1 << field.widest:
        site.report("value-too-wide", f"{kind.digits} decimal digits do not fit into {field.widest} bits")


def _check_text(field: Field, site: Site) -> None:
    fills_bits = not isinstance(field.equals, str) or 8 * len(field.equals) == field.widest
    if field.widest % 8 or not fills_bits:
        site.report("width-mismatch", f"the text of '{field.name}' does not fill its {field.widest} bits")


def _check_one_bit(field: Field, kind_text: str, site: Site) -> None:
    if field.width.is_constant and field.width != Expression(1):
        site.report("width-mismatch", f"'{field.name}' is a {kind_text}, so it must have one bit, not {field.widest}")
    elif not field.width.is_constant:
        message = (
            f"'{field.name}' is a {kind_text}, so it has one bit for all order codes, but 'bits' is"
            f" {field.width.render()}"
        )
        remedy = "leave 'bits' out, and describe the order codes that do not send it in a spec of their own"
        site.report("width-mismatch", f"{message}; {remedy}")


def _check_choice(field: Field, kind: Choice, site: Site) -> None:
    # If the width is constant, the rules on the text have already checked it.
    for value in kind.values if not field.width.is_constant else ():
        if value.value >> field.widest:
            message = f"the value '{value.name}' = {value.value:#x} does not fit into {field.widest} bits"
            site.report("value-too-wide", message)
    if all(value.value for value in kind.values):
        _check_absent(field, "none of its values is 0; add one", site)


def _check_fixed(field: Field, kind: Constant | Unused, site: Site) -> None:
    narrowest = min((field.width.value(parameters) for parameters in site.sets), default=0)
    if not field.width.is_constant and kind.value >> narrowest and narrowest:
        key = "unused" if isinstance(kind, Unused) else "constant"
        message = f"'{key}' is {kind.value:#x}, which does not fit into {narrowest} bit{'s' * (narrowest > 1)}"
        site.report("value-too-wide", message)
    if isinstance(kind, Constant) and kind.value:
        _check_absent(field, f"'constant' is {kind.value:#x}; use 0, or a constant width", site)


def _check_absent(field: Field, reason: str, site: Site) -> None:
    """Report a field without bits for some order code. It reads as 0, so its frames would all be rejected."""
    lacking = next((parameters for parameters in site.sets if not field.width.value(parameters)), None)
    if lacking is not None:
        values = ", ".join(f"{name} = {lacking[name]}" for name in field.width.parameters)
        message = f"'{field.name}' has no bits with {values} and reads as 0, but {reason}"
        site.report("value-too-wide", message)


def _check_crc(layout: Layout, field: Field, kind: CrcValue, site: Site) -> None:
    crc = site.context.crcs.get(kind.crc)
    if crc is None:
        return
    if field.width != Expression(crc.width):
        site.report(
            "width-mismatch", f"'{field.name}' has {field.widest} bits, but the CRC '{crc.name}' has {crc.width}"
        )
    if field is not layout.fields[-1]:
        problem = f"'{field.name}' covers everything sent before it, so it must be the last field of '{layout.name}'"
        if kind.of:
            problem = f"'{field.name}' must be the last field of '{layout.name}', even with 'crc_of'"
        site.report("crc-not-last", problem)
    problem = next(chain(_no_run(layout, kind, site), _left_out(layout, field, kind)), "")
    if problem:
        site.report("crc-of", problem, "crc_of")
    on_line = INTERFACES[site.interface].carried_as == "bits" and layout.byte_order == "high_byte_first"
    if layout.in_bytes and crc.width % 8 and not on_line:
        site.report("width-mismatch", f"a frame of whole bytes cannot end with a CRC of {crc.width} bits")
    elif layout.in_bytes and (crc.width % 8 or layout.bits != layout.sent_bits) and not _is_plain(crc):
        problem = f"'{field.name}' or the bits before it are not whole bytes, so the CRC must start at 0"
        site.report("width-mismatch", f"{problem}, without 'refin' and 'refout'")


def _is_plain(crc: Crc) -> bool:
    """Return True if zeros before a frame do not change its CRC, and its bits are in the order sent."""
    return not crc.init and not crc.refin and not crc.refout


def _left_out(layout: Layout, crc: Field, kind: CrcValue) -> Iterator[str]:
    """Yield the fields with data that a CRC with a list of fields leaves out, unless a note names them."""
    mentioned_names = {crc.name, *kind.of, *re.findall(r"\w+", f"{layout.note} {crc.note}")}
    data_fields = (field.name for field in layout.fields if not isinstance(field.kind, (Constant, Unused)))
    unmentioned_names = listed(name for name in data_fields if name not in mentioned_names)
    if kind.of and unmentioned_names:
        remedy = (
            f"add the fields that it covers to 'crc_of', or add a 'note' that the manual leaves out {unmentioned_names}"
        )
        yield f"'{crc.name}' leaves out {unmentioned_names}; {remedy}"


def _no_run(layout: Layout, kind: CrcValue, site: Site) -> Iterator[str]:
    """Yield the reasons why the fields of a CRC are not adjacent bits at a fixed place."""
    fields = {field.name: field for field in layout.fields}
    covered = [fields[name] for name in kind.of if name in fields]
    if kind.of and layout.in_bytes:
        interface = INTERFACES[site.interface]
        where = f"over {interface.title}" if interface.carried_as == "bytes" else "with 'carried_as: bytes'"
        yield f"{where}, a CRC covers everything before it; leave 'crc_of' out"
        return
    moving = next((field for field in covered if not field.is_fixed), None)
    if moving is not None:
        yield f"'{moving.name}' differs in place or width between order codes, so 'crc_of' cannot list it"
        return
    for above, below in pairwise(covered):
        if below.low + below.width != above.low:
            yield f"'{above.name}' and '{below.name}' are not adjacent; list adjacent fields, in the order sent"
            return
