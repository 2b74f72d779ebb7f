"""Rules for the requests of RS-485 that need the built device: their control bytes, and what distinguishes them."""

from __future__ import annotations

from ..language.problems import DocumentReport, Path
from ..model import Constant, DataId, Device, Layout, Rs485, Variant, number_to_bytes
from ..reference.codec import EncodeError, encode
from .valid_parts import valid_parts_so_far


def check_control_bytes(device: Device, report: DocumentReport) -> None:
    """Check that each printed control byte is the encoding of its data ID."""
    interface = device.find_interface(Rs485)
    if interface is None or not valid_parts_so_far(report).has_frames:
        return
    variants = device.variants_over(interface.name)
    if not variants:
        return
    for data_id in interface.data_ids:
        path: Path = ("interfaces", interface.name, "data_ids", data_id.name)
        layouts = [layout for layout in interface.layouts if data_id.id in layout.selects]
        if not layouts:
            problem = f"no layout has data ID {data_id.id:X} in its 'when'; add it to one"
            report.add("undefined-reference", path, problem)
            continue
        control_byte = _control_byte(device, layouts[0], data_id, variants[0])
        if control_byte is not None and control_byte != data_id.control:
            problem = f"according to its fields, the control field of data ID {data_id.id:X} is {control_byte:#04x}"
            message = f"{problem}, but it is {data_id.control:#04x} in the manual"
            report.add("control-mismatch", (*path, "control"), message)


def _control_byte(device: Device, layout: Layout, data_id: DataId, variant: Variant) -> int | None:
    """Return the first byte of a frame with a data ID, or None if the frame cannot be encoded with zeros."""
    placed = layout.place(variant.parameters)
    # All fields are 0, apart from the one that identifies the layout.
    values = {field.name: 0 for field in layout.data_fields} | {layout.selector: data_id.id}
    try:
        frame = encode(device, placed, values)
    except EncodeError:
        return None  # Found by other rules.
    return number_to_bytes(layout, frame, placed.bits)[0]


def check_requests(device: Device, report: DocumentReport) -> None:
    """Check that an encoder can distinguish its requests by constants in the bytes that two of them share."""
    interface = device.find_interface(Rs485)
    if interface is None or not interface.exchanges or not valid_parts_so_far(report).has_frames:
        return
    layouts = {layout.name: layout for layout in interface.layouts}
    requests = [layouts[exchange.request] for exchange in interface.exchanges if exchange.request in layouts]
    for index, request in enumerate(requests):
        ambiguous_requests = [earlier for earlier in requests[:index] if not _constants_differ(earlier, request)]
        if ambiguous_requests:
            pair = f"'{request.name}' from '{ambiguous_requests[0].name}'"
            problem = f"no constant distinguishes {pair}; add the command as a 'constant' to both"
            report.add("rs485-exchange", ("interfaces", interface.name, "layouts", request.name), problem)


def _constants_differ(layout: Layout, other_layout: Layout) -> bool:
    """Return whether two requests have different constants in the same bit of a byte."""
    constant_bits, other_constant_bits = _constant_bits(layout), _constant_bits(other_layout)
    common_places = constant_bits.keys() & other_constant_bits.keys()
    return any(constant_bits[place] != other_constant_bits[place] for place in common_places)


def _constant_bits(layout: Layout) -> dict[tuple[int, int], int]:
    """Return the constant bits of a layout, by byte and bit: ``{(0, 7): 1, (0, 6): 0}``."""
    constant_bits = {}
    for field in layout.fields:
        if not isinstance(field.kind, Constant):
            continue
        for bit_slice in field.bit_slices:
            value_in_byte = field.kind.value >> bit_slice.low_in_number
            width_in_byte = bit_slice.mask.bit_length()
            for bit in range(width_in_byte):
                constant_bits[bit_slice.byte, bit_slice.low_in_byte + bit] = (value_in_byte >> bit) & 1
    return constant_bits
