"""Checks for frames: their CRCs, their data channels, and the requests that RS-485 encoders receive."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

from ..language.problems import DocumentReport, Path, join_words, quoted
from ..model import (
    INTERFACES,
    Biss,
    Constant,
    Crc,
    CrcValue,
    DataChannels,
    DataId,
    Device,
    Field,
    Layout,
    Number,
    Rs485,
    Unused,
    Variant,
    member_named,
    number_to_bytes,
)
from ..model.expressions import Expression
from ..reference.codec import EncodeError, encode
from .bit_coverage import condition_text
from .fields import SpecPlace
from .spec_parts import valid_parts_so_far


def check_one_crc(layout: Layout, spec_place: SpecPlace) -> None:
    """Report a layout that sends several CRCs for the same order code. A CRC with a width of 0 bits is not sent.

    ``spec_place`` is the place of the layout in the spec, with the parameters of each order code that has this layout.
    """
    for parameters in spec_place.parameter_sets:
        sent_fields = [field for field in layout.crc_fields if field.width.value(parameters)]
        if len(sent_fields) > 1:
            first, second, *_ = sent_fields
            condition = condition_text(parameters, first.width, second.width)
            problem = f"'{layout.name}' ends with '{first.name}' and '{second.name}'{condition}"
            remedy = "give each CRC a 'bits' that is 0 for order codes that send the other CRC"
            spec_place.report("several-crcs", f"{problem}; {remedy}", "fields", second.name)
            return


def check_settings_of_crcs(device: Device, report: DocumentReport) -> None:
    """Report a CRC whose width depends on a register that can hold any number between its limits.

    A CRC has either its full width or no bits, so a register that decides this must hold a code.
    """
    parameters_without_codes = {parameter.name for parameter in device.run_time_parameters if not parameter.by_code}
    for interface, layout in device.layouts():
        for field in layout.crc_fields:
            deciding_parameters = parameters_without_codes & device.needed_parameters(field.width.parameters)
            if deciding_parameters:
                problem = f"the CRC '{field.name}' depends on the register value '{min(deciding_parameters)}'"
                remedy = f"list its widths, 0 and {field.widest}, in 'by_code' of this parameter"
                field_path = ("interfaces", interface.name, "layouts", layout.name, "fields", field.name)
                report.add("width-mismatch", field_path, f"{problem}; {remedy}")


def check_crc(layout: Layout, field: Field, crc_value: CrcValue, spec_place: SpecPlace) -> None:
    """Check the width of a CRC, that it is the last field of the frame, and the fields that it covers.

    Only other CRCs may follow it, because each order code has at most one. A bit frame that is carried in bytes can
    begin with padding zeros. If the CRC or the bits before it are not whole bytes, these zeros must not change the CRC,
    and its bits must be in transmission order.
    """
    crc = spec_place.context.crc_by_name.get(crc_value.crc)
    if crc is None:
        return
    _check_width(field, crc, spec_place)
    index_of_crc = layout.fields.index(field)
    fields_after_crc = layout.fields[index_of_crc + 1 :]
    if any(not isinstance(later_field.kind, CrcValue) for later_field in fields_after_crc):
        problem = f"'{field.name}' covers everything sent before it, so it must be the last field of '{layout.name}'"
        if crc_value.of:
            problem = f"'{field.name}' must be the last field of '{layout.name}', even with 'crc_of'"
        spec_place.report("crc-not-last", problem)
    problem = _problem_of_covered_fields(layout, crc_value, spec_place) or _problem_of_fields_left_out(
        layout, field, crc_value
    )
    if problem:
        spec_place.report("crc-of", problem, "crc_of")
    is_bit_frame_high_byte_first = (
        INTERFACES[spec_place.interface].carried_as == "bits" and layout.byte_order == "high_byte_first"
    )
    begins_with_zeros = layout.bits != layout.sent_bits
    if layout.in_bytes and crc.width % 8 and not is_bit_frame_high_byte_first:
        spec_place.report("width-mismatch", f"a frame of whole bytes cannot end with a CRC of {crc.width} bits")
    elif layout.in_bytes and (not layout.crc_covers_bytes or begins_with_zeros) and not _is_unchanged_by_zeros(crc):
        problem = f"'{field.name}' or the bits before it are not whole bytes, so the CRC must start at 0"
        spec_place.report("width-mismatch", f"{problem}, without 'refin' and 'refout'")


def _check_width(field: Field, crc: Crc, spec_place: SpecPlace) -> None:
    """Check that the field of a CRC has the width of the CRC, or no bits for order codes without a CRC.

    In a register, the field must always have the full width.
    """
    if field.width.is_constant:
        if field.width != Expression(crc.width):
            message = f"'{field.name}' has {field.widest} bits, but the CRC '{crc.name}' has {crc.width}"
            spec_place.report("width-mismatch", message)
        return
    if spec_place.is_in_register:
        message = f"'{field.name}' is a CRC in a register, so its width is {crc.width} for all order codes"
        spec_place.report("width-mismatch", f"{message}, but 'bits' is {field.width.render()}; remove 'bits'")
        return
    for parameters in spec_place.parameter_sets:
        bit_count = field.width.value(parameters)
        if bit_count not in (0, crc.width):
            message = f"'{field.name}' has {bit_count} bits{condition_text(parameters, field.width)}"
            remedy = f"use a parameter that is 0 or {crc.width}"
            spec_place.report(
                "width-mismatch", f"{message}, but the CRC '{crc.name}' has {crc.width} or none; {remedy}"
            )
            return
    if field.widest == 0:
        message = f"'{field.name}' has no bits, because '{field.width.render()}' is 0 for all order codes"
        remedy = f"remove the field, or give the parameter {crc.width} where it is sent"
        spec_place.report("width-mismatch", f"{message}; {remedy}")


def _is_unchanged_by_zeros(crc: Crc) -> bool:
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
    left_out_text = join_words(name for name in data_names if name not in mentioned_names)
    if not left_out_text:
        return ""
    remedy = f"add the missing fields to 'crc_of', or add a 'note' that the manual excludes {left_out_text}"
    return f"'{crc.name}' does not cover {left_out_text}; {remedy}"


def _problem_of_covered_fields(layout: Layout, crc_value: CrcValue, spec_place: SpecPlace) -> str:
    """Return why a CRC cannot cover the fields that it lists in ``crc_of``, or "".

    They must be adjacent bits at a place that is the same for all order codes, in a frame that is not sent as bytes.
    """
    if crc_value.of and layout.in_bytes:
        interface = INTERFACES[spec_place.interface]
        is_always_bytes = interface.carried_as == "bytes"
        interface_text = f"over {interface.title}" if is_always_bytes else "with 'carried_as: bytes'"
        return f"{interface_text}, a CRC covers everything before it; remove 'crc_of'"
    field_by_name = {field.name: field for field in layout.fields}
    covered_fields = [field_by_name[name] for name in crc_value.of if name in field_by_name]
    for field in covered_fields:
        if not field.is_fixed:
            return f"'{field.name}' differs in place or width between order codes, so 'crc_of' cannot list it"
    for upper_field, lower_field in pairwise(covered_fields):
        if lower_field.low + lower_field.width != upper_field.low:
            names = f"'{upper_field.name}' and '{lower_field.name}'"
            return f"{names} are not adjacent; list adjacent fields, in the order sent"
    return ""


_CHANNELS_RULE = "data-channels"


class _Problem(NamedTuple):
    """A problem with data channels: the path of its key below ``channels``, such as ``("order", 0)``, and a message."""

    path: Path
    message: str


def check_channels(device: Device, report: DocumentReport) -> None:
    """Report the first contradiction in the description of a BiSS frame that carries several data channels.

    Decoders split such a frame by the lengths of the channels, decode each channel by itself, and then compare the
    positions.
    """
    biss = device.find_interface(Biss)
    if biss is None or biss.channels is None or not valid_parts_so_far(report).has_valid_layouts:
        return
    channels_path: Path = ("interfaces", biss.name, "channels")
    if (*channels_path, "compared_bits") in report.faults():
        return  # The number of compared bits is not a valid expression, which is already reported.
    layout_by_name = {layout.name: layout for layout in biss.layouts}
    listed_names = (*biss.channels.order, *biss.channels.compared)
    undefined_names = [name for name in listed_names if name not in layout_by_name]
    if undefined_names:
        # A layout with a problem was not built, so it would wrongly count as undefined.
        if not report.faults():
            known_names = join_words(map(quoted, layout_by_name))
            message = f"there is no layout {quoted(undefined_names[0])} over BiSS; it has: {known_names}"
            report.add("undefined-reference", (*channels_path, "order"), message)
        return
    ordered_layouts = [layout_by_name[name] for name in biss.channels.order]
    problems: tuple[_Problem, ...] = (
        *_order_problems(biss, ordered_layouts),
        *_question_problems(device, ordered_layouts),
        *_position_problems(device, ordered_layouts),
        *_comparison_problems(device, biss.channels, layout_by_name),
    )
    if problems:
        first_problem = problems[0]
        report.add(_CHANNELS_RULE, (*channels_path, *first_problem.path), first_problem.message)


def _order_problems(biss: Biss, layouts: Sequence[Layout]) -> Iterator[_Problem]:
    """Yield problems with the order of the data channels in a frame.

    A frame has at least two channels, and the first one must be the first layout of the interface. Each channel is
    listed once, has a number of its own, and is not carried as bytes.
    """
    if len(layouts) < 2:
        yield _Problem(
            ("order",), "a frame with several channels has at least two; list all of them, or remove 'channels'"
        )
    first_layout = biss.layouts[0]
    if layouts[0] is not first_layout:
        layout_text = quoted(layouts[0].name)
        first_layout_text = quoted(first_layout.name)
        message = f"{layout_text} is the first channel of the frame, but the first layout is {first_layout_text}"
        yield _Problem(("order", 0), f"{message}; correct one of them")
    name_by_channel_number: dict[int | None, str] = {}
    for channel_index, layout in enumerate(layouts):
        channel_path: Path = ("order", channel_index)
        layout_text = quoted(layout.name)
        other_name = name_by_channel_number.setdefault(layout.channel, layout.name)
        is_listed_before = layout in layouts[:channel_index]
        if is_listed_before:
            yield _Problem(channel_path, f"{layout_text} is listed twice; list each channel once")
        elif layout.channel is None:
            yield _Problem(channel_path, f"{layout_text} has no 'channel'; give each channel of the frame its number")
        elif other_name != layout.name:
            yield _Problem(
                channel_path,
                f"{quoted(other_name)} and {layout_text} have the same 'channel' {layout.channel}; correct one of them",
            )
        elif layout.in_bytes:
            yield _Problem(
                channel_path,
                f"{layout_text} is carried as bytes, but a channel of a frame is one word of at most 64 bits",
            )


def _question_problems(device: Device, layouts: Sequence[Layout]) -> Iterator[_Problem]:
    """Yield a problem for each channel whose bits depend on a question that the manual leaves open."""
    for index, layout in enumerate(layouts):
        for alternative in device.alternatives_of(layout):
            layout_text = quoted(layout.name)
            message = (
                f"{layout_text} depends on the question {quoted(alternative.name)}, which decoders of a whole frame"
            )
            yield _Problem(
                ("order", index), f"{message} do not ask; remove 'channels', and decode each channel separately"
            )


def _position_problems(device: Device, layouts: Sequence[Layout]) -> Iterator[_Problem]:
    """Yield a problem if none or several of the data channels contain the position."""
    layouts_with_position = [quoted(layout.name) for layout in layouts if device.sends_position(Biss.name, layout)]
    if not layouts_with_position:
        yield _Problem(("order",), "no channel of the frame contains the position; list the one that does")
    if len(layouts_with_position) > 1:
        remedy = "name its fields differently in all but one of them, and list the fields in 'compared'"
        yield _Problem(("order",), f"{join_words(layouts_with_position)} contain the position; {remedy}")


def _comparison_problems(
    device: Device, channels: DataChannels, layout_by_name: Mapping[str, Layout]
) -> Iterator[_Problem]:
    """Yield problems with the comparison of fields from different data channels.

    The highest bits of an unsigned number in each channel are compared. There cannot be more of these bits than the
    number has.
    """
    lists_fields = bool(channels.compared)
    states_bit_count = channels.compared_bits is not None
    if lists_fields != states_bit_count:
        yield _Problem((), "'compared' and 'compared_bits' need each other; give both or none")
    if len(channels.compared) == 1:
        yield _Problem(("compared",), "one field cannot be compared; list the field of each channel")
    for layout_name, field_name in channels.compared.items():
        field_path: Path = ("compared", layout_name)
        field = layout_by_name[layout_name].find_field(field_name)
        if layout_name not in channels.order:
            yield _Problem(field_path, f"{quoted(layout_name)} is not in 'order'; add it, or leave it out here")
        elif field is None:
            yield _Problem(field_path, f"{quoted(layout_name)} has no field {quoted(field_name)}")
        elif not _is_plain_number(field):
            yield _Problem(
                field_path, f"{quoted(field_name)} is not an unsigned number, so its highest bits cannot be compared"
            )
        else:
            yield from _width_problems(device, channels, layout_by_name[layout_name], field_name)


def _is_plain_number(field: Field) -> bool:
    """Return whether the bits of a field are an unsigned number. The bits 0 must represent 0."""
    kind = field.kind
    return isinstance(kind, Number) and not kind.signed and not kind.zero_means


def _width_problems(device: Device, channels: DataChannels, layout: Layout, field_name: str) -> Iterator[_Problem]:
    """Yield a problem for the first order code for which the numbers of two channels cannot be compared.

    Either the field has fewer bits than are compared, or the tolerance is so large that any two numbers agree.
    """
    if channels.compared_bits is None:
        return
    width = member_named(layout.fields, field_name, "field").width
    for variant in device.variants_over(Biss.name):
        compared_bit_count = channels.compared_bits.value(variant.parameters)
        condition = condition_text(variant.parameters, width, channels.compared_bits)
        field_bit_count = width.value(variant.parameters)
        if not 1 <= compared_bit_count <= field_bit_count:
            reason = f"{quoted(field_name)} has {field_bit_count}{condition}"
            yield _Problem(("compared_bits",), f"{compared_bit_count} bits cannot be compared, because {reason}")
            return
        # Numbers wrap around, so two numbers differ by at most half of their range.
        all_numbers_agree = 2 * channels.tolerance >= (1 << compared_bit_count) - 1
        if all_numbers_agree:
            problem = f"any two numbers of {compared_bit_count} bits agree{condition}"
            yield _Problem(("tolerance",), f"with a tolerance of {channels.tolerance}, {problem}")
            return


def check_control_bytes(device: Device, report: DocumentReport) -> None:
    """Check that the control byte that the manual gives for each data ID matches the fields of its request."""
    rs485 = device.find_interface(Rs485)
    if rs485 is None or not valid_parts_so_far(report).has_valid_layouts:
        return
    variants = device.variants_over(rs485.name)
    if not variants:
        return
    for data_id in rs485.data_ids:
        data_id_path: Path = ("interfaces", rs485.name, "data_ids", data_id.name)
        layouts = [layout for layout in rs485.layouts if data_id.id in layout.selects]
        if not layouts:
            problem = f"no layout has data ID {data_id.id:X} in its 'when'; add it to one"
            report.add("undefined-reference", data_id_path, problem)
            continue
        control_byte = _control_byte(device, layouts[0], data_id, variants[0])
        if control_byte is not None and control_byte != data_id.control:
            problem = f"according to its fields, the control field of data ID {data_id.id:X} is {control_byte:#04x}"
            message = f"{problem}, but it is {data_id.control:#04x} in the manual"
            report.add("control-mismatch", (*data_id_path, "control"), message)


def _control_byte(device: Device, layout: Layout, data_id: DataId, variant: Variant) -> int | None:
    """Return the first byte of a frame with a data ID and zeros, or None if such a frame cannot be encoded."""
    placed_layout = layout.place(variant.parameters)
    # All fields are 0, except the selector, which identifies the layout.
    value_by_field = {field.name: 0 for field in layout.data_fields} | {layout.selector: data_id.id}
    try:
        frame_number = encode(device, placed_layout, value_by_field)
    except EncodeError:
        return None  # Other rules report the reason.
    return number_to_bytes(layout, frame_number, placed_layout.bits)[0]


def check_requests(device: Device, report: DocumentReport) -> None:
    """Check that an RS-485 encoder can distinguish its requests: any two must differ in a constant."""
    rs485 = device.find_interface(Rs485)
    if rs485 is None or not rs485.exchanges or not valid_parts_so_far(report).has_valid_layouts:
        return
    layout_by_name = {layout.name: layout for layout in rs485.layouts}
    requests = [layout_by_name[exchange.request] for exchange in rs485.exchanges if exchange.request in layout_by_name]
    for index, request in enumerate(requests):
        ambiguous_requests = [
            earlier_request for earlier_request in requests[:index] if not _constants_differ(earlier_request, request)
        ]
        if ambiguous_requests:
            names_of_both = f"'{request.name}' from '{ambiguous_requests[0].name}'"
            problem = f"no constant distinguishes {names_of_both}; add the command as a 'constant' to both"
            report.add("rs485-exchange", ("interfaces", rs485.name, "layouts", request.name), problem)


def _constants_differ(layout: Layout, other_layout: Layout) -> bool:
    """Return whether two requests have different constants in the same bit of a byte."""
    constant_bits, other_constant_bits = _constant_bits(layout), _constant_bits(other_layout)
    common_places = constant_bits.keys() & other_constant_bits.keys()
    return any(constant_bits[place] != other_constant_bits[place] for place in common_places)


def _constant_bits(layout: Layout) -> dict[tuple[int, int], int]:
    """Return the constant bits of a layout, by the byte and the bit in it: ``{(0, 7): 1, (0, 6): 0}``."""
    constant_bits = {}
    for field in layout.fields:
        if not isinstance(field.kind, Constant):
            continue
        for bit_slice in field.bit_slices:
            bits_in_byte = field.kind.value >> bit_slice.low_in_number
            bit_count_in_byte = bit_slice.mask.bit_length()
            for bit_index in range(bit_count_in_byte):
                constant_bits[bit_slice.byte, bit_slice.low_in_byte + bit_index] = (bits_in_byte >> bit_index) & 1
    return constant_bits
