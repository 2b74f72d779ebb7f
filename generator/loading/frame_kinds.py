"""Check that a frame can be distinguished: from other frames, and from replies to other requests."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

from ..language.problems import DocumentReport, Path
from ..model import Biss, Constant, Device, Field, Interface, Layout, Number, Rs485, Spi, Ssi
from .valid_parts import valid_parts_so_far


def check_frame_kinds(device: Device, report: DocumentReport) -> None:
    """Report a number that is a constant in another frame, and so the kind of frame, or a constant in the request.

    Over RS-485, only the request tells the frames apart.
    """
    for interface in device.interfaces if valid_parts_so_far(report).has_frames else ():
        _check_replies(interface, device.position_names(interface.name), report)
        if not isinstance(interface, Rs485):
            _check_positions(device, interface, report)
            _check_numbers(device, interface, report)


def _check_numbers(device: Device, interface: Interface, report: DocumentReport) -> None:
    """Report a number in a frame with the position that is a constant in another frame."""
    frames = [layout for layout in interface.layouts if layout.sender == "encoder"]
    for layout in frames:
        if not device.tells_position(interface.name, layout):
            continue
        numbers = {field.name for field in layout.fields if isinstance(field.kind, Number)}
        same_channel = [frame for frame in frames if frame.channel == layout.channel]
        candidates = [frame for frame in same_channel if _has_constant(frame, numbers)]
        clash = next(_ambiguous_numbers(device, interface, layout, candidates), None)
        if clash is not None:
            field, other_layout, value = clash
            message = f"'{field.name}' can be any number, but it is always {value:#x} in '{other_layout.name}'"
            remedy = f"a frame '{other_layout.name}' would decode as '{layout.name}'; give this field its 'constant'"
            report.add("frame-kind", _field_path(interface, layout, field), f"{message}, so {remedy}")


def _field_path(interface: Interface, layout: Layout, field: Field) -> Path:
    """Return the path of a field in the spec, which may be in a group."""
    if field.group:
        return ("field_groups", field.group, "fields", field.name)
    return ("interfaces", interface.name, "layouts", layout.name, "fields", field.name)


def _check_positions(device: Device, interface: Interface, report: DocumentReport) -> None:
    """Report two frames with the position that nothing distinguishes, unless a note says how a master knows them.

    No request selects a frame over SSI and BiSS, so decoders would take each frame as the first layout.
    """
    frames = [layout for layout in interface.layouts if device.tells_position(interface.name, layout)]
    for first, second in combinations(frames if isinstance(interface, (Biss, Ssi)) else (), 2):
        if second.note or first.channel != second.channel or _are_distinguished(first, second):
            continue
        message = (
            f"'{first.name}' and '{second.name}' both contain the position, and nothing distinguishes their frames"
        )
        remedy = (
            "if order codes differ in their frames, describe them in one layout with widths that depend on the order"
            " code, or in two specs. If a master selects the frame, say how in a 'note' of the second layout"
        )
        layout_path: Path = ("interfaces", interface.name, "layouts", second.name)
        report.add("frame-kind", layout_path, f"{message}, so decoders use '{first.name}'; {remedy}")
        return


def _are_distinguished(layout: Layout, other_layout: Layout) -> bool:
    """Return whether a selector or a constant of the same name distinguishes two frames."""
    constants, other_constants = map(_constants, (layout, other_layout))
    common_names = constants.keys() & other_constants.keys()
    return bool(layout.selector) or any(constants[name] != other_constants[name] for name in common_names)


def _constants(layout: Layout) -> dict[str, int]:
    """Return the value of each constant of a layout, by its name."""
    return {field.name: field.kind.value for field in layout.fields if isinstance(field.kind, Constant)}


def _check_replies(interface: Interface, positions: frozenset[str], report: DocumentReport) -> None:
    """Report a number in a reply that is a constant in each of its requests, so that any other reply would decode.

    A request for a position may name its command like the position.
    """
    exchanges = interface.exchanges if isinstance(interface, (Rs485, Spi)) else ()
    layouts = {layout.name: layout for layout in interface.layouts}
    for reply in interface.layouts:
        request_names = [exchange.request for exchange in exchanges if exchange.reply == reply.name]
        requests = [layouts[name] for name in request_names if name in layouts]
        for field in reply.fields if requests else ():
            value = _common_constant(requests, field.name)
            if isinstance(field.kind, Number) and value is not None and field.name not in positions:
                message = f"'{field.name}' can be any number, but it is always {value:#x} in '{requests[0].name}'"
                where = " in each layout, instead of in the group" if field.group else ""
                remedy = f"the reply to another request would decode; give this field the same 'constant'{where}"
                report.add("frame-kind", _field_path(interface, reply, field), f"{message}, so {remedy}")


def _common_constant(requests: Sequence[Layout], name: str) -> int | None:
    """Return the value of a field that is the same constant in all requests with the field, or None."""
    kinds = [field.kind for request in requests for field in request.fields if field.name == name]
    constants = [kind for kind in kinds if isinstance(kind, Constant)]
    values = {constant.value for constant in constants}
    return values.pop() if len(constants) == len(kinds) and len(values) == 1 else None


def _has_constant(layout: Layout, names: set[str]) -> bool:
    return any(isinstance(field.kind, Constant) and field.name in names for field in layout.fields)


def _ambiguous_numbers(
    device: Device, interface: Interface, layout: Layout, other_layouts: list[Layout]
) -> Iterator[tuple[Field, Layout, int]]:
    """Yield the numbers that are a constant at the same place of a frame with the same length."""
    for variant in device.variants_over(interface.name):
        placed = layout.place(variant.parameters)
        for other_layout in other_layouts:
            other_placed = other_layout.place(variant.parameters)
            for placed_field in placed.fields if placed.bits == other_placed.bits else ():
                other_field = other_placed.find_field(placed_field.name)
                if other_field is None or (other_field.low, other_field.width) != (
                    placed_field.low,
                    placed_field.width,
                ):
                    continue
                if isinstance(placed_field.field.kind, Number) and isinstance(other_field.field.kind, Constant):
                    yield placed_field.field, other_layout, other_field.field.kind.value
