"""Checks for CRCs in a layout: their place, width and covered fields, and that each order code has at most one."""

from __future__ import annotations

import re
from itertools import pairwise

from ..language.problems import DocumentReport, join_words
from ..model import INTERFACES, Constant, Crc, CrcValue, Device, Field, Layout, Unused
from ..model.expressions import Expression
from .fields import LayoutSite
from .gaps import values_text


def check_one_crc(layout: Layout, site: LayoutSite) -> None:
    """Report a layout that sends several CRCs for the same order code. A CRC with a width of 0 bits is not sent.

    ``site`` is the place of the layout in the spec. ``site.parameter_sets`` contains the parameters of each order code
    that has this layout.
    """
    for parameters in site.parameter_sets:
        sent_fields = [field for field in layout.crc_fields if field.width.value(parameters)]
        if len(sent_fields) > 1:
            first, second, *_ = sent_fields
            condition = values_text(parameters, first.width, second.width)
            problem = f"'{layout.name}' ends with '{first.name}' and '{second.name}'{condition}"
            remedy = "give each CRC a 'bits' that is 0 for order codes that send the other CRC"
            site.report("several-crcs", f"{problem}; {remedy}", "fields", second.name)
            return


def check_settings_of_crcs(device: Device, report: DocumentReport) -> None:
    """Report a CRC whose width depends on a register that can hold any number between its limits.

    A CRC has either its full width or no bits, so a register that decides this must hold a code.
    """
    names_without_codes = {parameter.name for parameter in device.run_time_parameters if not parameter.by_code}
    for interface, layout in device.layouts():
        for field in layout.crc_fields:
            parameters_without_codes = names_without_codes & device.needed_parameters(field.width.parameters)
            if parameters_without_codes:
                problem = f"the CRC '{field.name}' depends on the register value '{min(parameters_without_codes)}'"
                remedy = f"list its widths, 0 and {field.widest}, in 'by_code' of this parameter"
                path = ("interfaces", interface.name, "layouts", layout.name, "fields", field.name)
                report.add("width-mismatch", path, f"{problem}; {remedy}")


def check_crc(layout: Layout, field: Field, crc_value: CrcValue, site: LayoutSite) -> None:
    """Check the width of a CRC, that it is the last field of the frame, and the fields that it covers.

    Only other CRCs may follow it, because each order code has at most one. A bit frame that is carried in bytes can
    begin with padding zeros. If the CRC or the bits before it are not whole bytes, these zeros must not change the CRC,
    and its bits must be in transmission order.
    """
    crc = site.context.crcs.get(crc_value.crc)
    if crc is None:
        return
    _check_width(field, crc, site)
    index_of_crc = layout.fields.index(field)
    fields_after_crc = layout.fields[index_of_crc + 1 :]
    if any(not isinstance(later_field.kind, CrcValue) for later_field in fields_after_crc):
        problem = f"'{field.name}' covers everything sent before it, so it must be the last field of '{layout.name}'"
        if crc_value.of:
            problem = f"'{field.name}' must be the last field of '{layout.name}', even with 'crc_of'"
        site.report("crc-not-last", problem)
    problem = _problem_of_covered_fields(layout, crc_value, site) or _problem_of_fields_left_out(
        layout, field, crc_value
    )
    if problem:
        site.report("crc-of", problem, "crc_of")
    is_sent_as_bits = INTERFACES[site.interface].carried_as == "bits" and layout.byte_order == "high_byte_first"
    has_zeros_before = layout.bits != layout.sent_bits
    if layout.in_bytes and crc.width % 8 and not is_sent_as_bits:
        site.report("width-mismatch", f"a frame of whole bytes cannot end with a CRC of {crc.width} bits")
    elif layout.in_bytes and (not layout.crc_covers_bytes or has_zeros_before) and not _is_plain(crc):
        problem = f"'{field.name}' or the bits before it are not whole bytes, so the CRC must start at 0"
        site.report("width-mismatch", f"{problem}, without 'refin' and 'refout'")


def _check_width(field: Field, crc: Crc, site: LayoutSite) -> None:
    """Check that the field of a CRC has the width of the CRC, or no bits for order codes without a CRC.

    In a register, the field must always have the full width.
    """
    if field.width.is_constant:
        if field.width != Expression(crc.width):
            message = f"'{field.name}' has {field.widest} bits, but the CRC '{crc.name}' has {crc.width}"
            site.report("width-mismatch", message)
        return
    if site.path[0] == "registers":
        message = f"'{field.name}' is a CRC in a register, so its width is {crc.width} for all order codes"
        site.report("width-mismatch", f"{message}, but 'bits' is {field.width.render()}; remove 'bits'")
        return
    for parameters in site.parameter_sets:
        width = field.width.value(parameters)
        if width not in (0, crc.width):
            message = f"'{field.name}' has {width} bits{values_text(parameters, field.width)}"
            remedy = f"use a parameter that is 0 or {crc.width}"
            site.report("width-mismatch", f"{message}, but the CRC '{crc.name}' has {crc.width} or none; {remedy}")
            return
    if field.widest == 0:
        message = f"'{field.name}' has no bits, because '{field.width.render()}' is 0 for all order codes"
        remedy = f"remove the field, or give the parameter {crc.width} where it is sent"
        site.report("width-mismatch", f"{message}; {remedy}")


def _is_plain(crc: Crc) -> bool:
    """Return whether zeros before a frame do not change its CRC, and the bits of the CRC are in transmission order."""
    return not crc.init and not crc.refin and not crc.refout


def _problem_of_fields_left_out(layout: Layout, crc: Field, crc_value: CrcValue) -> str:
    """Return a message if a CRC lists the fields that it covers in ``crc_of``, but leaves out some, or "".

    A note of the layout or of the CRC can name the fields that the manual excludes. Constants and unused bits may be
    left out.
    """
    if not crc_value.of:
        return ""
    words_in_notes = re.findall(r"\w+", f"{layout.note} {crc.note}")
    mentioned_names = {crc.name, *crc_value.of, *words_in_notes}
    data_names = [field.name for field in layout.fields if not isinstance(field.kind, (Constant, Unused))]
    names_left_out = join_words(name for name in data_names if name not in mentioned_names)
    if not names_left_out:
        return ""
    remedy = f"add the missing fields to 'crc_of', or add a 'note' that the manual excludes {names_left_out}"
    return f"'{crc.name}' does not cover {names_left_out}; {remedy}"


def _problem_of_covered_fields(layout: Layout, crc_value: CrcValue, site: LayoutSite) -> str:
    """Return why a CRC cannot cover the fields that it lists in ``crc_of``, or "".

    They must be adjacent bits at a place that is the same for all order codes, in a frame that is not sent as bytes.
    """
    if crc_value.of and layout.in_bytes:
        interface = INTERFACES[site.interface]
        is_always_bytes = interface.carried_as == "bytes"
        interface_text = f"over {interface.title}" if is_always_bytes else "with 'carried_as: bytes'"
        return f"{interface_text}, a CRC covers everything before it; remove 'crc_of'"
    fields_by_name = {field.name: field for field in layout.fields}
    covered_fields = [fields_by_name[name] for name in crc_value.of if name in fields_by_name]
    for field in covered_fields:
        if not field.is_fixed:
            return f"'{field.name}' differs in place or width between order codes, so 'crc_of' cannot list it"
    for above, below in pairwise(covered_fields):
        if below.low + below.width != above.low:
            return f"'{above.name}' and '{below.name}' are not adjacent; list adjacent fields, in the order sent"
    return ""
