"""Check that a frame can be distinguished: from other frames, and from replies to other requests."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from ..language.problems import DocumentReport, Path
from ..model import Biss, Constant, Device, Field, Interface, Layout, Number, Rs485, Spi, Ssi
from .valid_parts import sound_so_far


def check_frame_kinds(device: Device, report: DocumentReport) -> None:
    """Report a number that is a constant in another frame, and so the kind of frame, or a constant in the request.

    Over RS-485, only the request tells the frames apart.
    """
    for interface in device.interfaces if sound_so_far(report).has_frames else ():
        _check_replies(interface, device.position_names(interface.name), report)
        if isinstance(interface, Rs485):
            continue
        _check_positions(device, interface, report)
        frames = [item for item in interface.layouts if item.sender == "encoder"]
        for layout in (item for item in frames if device.tells_position(interface.name, item)):
            numbers = {item.name for item in layout.fields if isinstance(item.kind, Number)}
            others = [item for item in frames if item.channel == layout.channel and _has_constant(item, numbers)]
            found = next(_kinds(device, interface, layout, others), None)
            if found is not None:
                field, other, value = found
                here: Path = ("interfaces", interface.name, "layouts", layout.name)
                owner = ("field_groups", field.group) if field.group else here
                wrong = f"'{field.name}' can be any number, but it is always {value:#x} in '{other.name}'"
                way = f"a frame '{other.name}' would decode as '{layout.name}'; give this field its 'constant'"
                report.add("frame-kind", (*owner, "fields", field.name), f"{wrong}, so {way}")


def _check_positions(device: Device, interface: Interface, report: DocumentReport) -> None:
    """Report two frames with the position that nothing distinguishes, unless a note says how a master knows them.

    No request selects a frame over SSI and BiSS, so decoders would take each frame as the first layout.
    """
    frames = [item for item in interface.layouts if device.tells_position(interface.name, item)]
    for first, other in combinations(frames if isinstance(interface, (Biss, Ssi)) else (), 2):
        if other.note or first.channel != other.channel or _differ(first, other):
            continue
        wrong = f"'{first.name}' and '{other.name}' both contain the position, and nothing distinguishes their frames"
        way = (
            "if order codes differ in their frames, describe them in one layout with widths that depend on the order"
            " code, or in two specs. If a master selects the frame, say how in a 'note' of the second layout"
        )
        here: Path = ("interfaces", interface.name, "layouts", other.name)
        report.add("frame-kind", here, f"{wrong}, so decoders use '{first.name}'; {way}")
        return


def _differ(layout: Layout, other: Layout) -> bool:
    """Return whether a selector or a constant of the same name distinguishes two frames."""
    known = {item.name: item.kind.value for item in layout.fields if isinstance(item.kind, Constant)}
    pairs = ((known.get(item.name), item.kind.value) for item in other.fields if isinstance(item.kind, Constant))
    return bool(layout.selector) or any(one not in (None, two) for one, two in pairs)


def _check_replies(interface: Interface, positions: frozenset[str], report: DocumentReport) -> None:
    """Report a number in a reply that is a constant in each of its requests, so that any other reply would decode.

    A request for a position may name its command like the position.
    """
    sent = interface.exchanges if isinstance(interface, (Rs485, Spi)) else ()
    layouts = {item.name: item for item in interface.layouts}
    for reply in interface.layouts:
        requests = [layouts[item.request] for item in sent if item.reply == reply.name and item.request in layouts]
        for field in reply.fields if requests else ():
            same = (item for request in requests for item in request.fields if item.name == field.name)
            constants = {item.kind.value if isinstance(item.kind, Constant) else None for item in same}
            value = constants.pop() if len(constants) == 1 else None
            if isinstance(field.kind, Number) and value is not None and field.name not in positions:
                here: Path = ("interfaces", interface.name, "layouts", reply.name)
                owner = ("field_groups", field.group) if field.group else here
                wrong = f"'{field.name}' can be any number, but it is always {value:#x} in '{requests[0].name}'"
                where = " in each layout, instead of in the group" if field.group else ""
                way = f"the reply to another request would decode; give this field the same 'constant'{where}"
                report.add("frame-kind", (*owner, "fields", field.name), f"{wrong}, so {way}")


def _has_constant(layout: Layout, names: set[str]) -> bool:
    return any(isinstance(item.kind, Constant) and item.name in names for item in layout.fields)


def _kinds(
    device: Device, interface: Interface, layout: Layout, others: list[Layout]
) -> Iterator[tuple[Field, Layout, int]]:
    """Yield the numbers that are a constant at the same place of a frame with the same length."""
    for variant in device.variants_over(interface.name):
        here = layout.place(variant.parameters)
        for other in others:
            there = other.place(variant.parameters)
            for mine in here.fields if here.bits == there.bits else ():
                its = there.field(mine.name)
                if its is None or (its.low, its.width) != (mine.low, mine.width):
                    continue
                if isinstance(mine.field.kind, Number) and isinstance(its.field.kind, Constant):
                    yield mine.field, other, its.field.kind.value
