"""Frames with several data channels in Python."""

from __future__ import annotations

from ...model import Interface, channel_frame, first_of
from ...model.record import dataclass
from .literals import Expr, Scope
from .names import ClassNames, Context


@dataclass(frozen=True)
class ChannelCode:
    """Frame with several data channels: the classes of its channels, and the index of the one with the position.

    ``compared`` has the index of the channel, the attribute and the width of each compared field.
    """

    kinds: tuple[str, ...]
    position: int
    compared: tuple[tuple[int, str, Expr], ...]
    compared_bits: Expr
    tolerance: int


def channel_code(context: Context, interface: Interface, scope: Scope) -> ChannelCode | None:
    """Return the frame with all data channels of an interface, or None if there is none."""
    frame = channel_frame(interface)
    if frame is None:
        return None
    indices = {layout.name: index for index, layout in enumerate(frame.layouts)}
    position_layouts = (layout for layout in frame.layouts if context.device.sends_position(interface.name, layout))
    compared = []
    for field in frame.compared:
        attribute_name = ClassNames(field.layout, None, ()).attribute(field.name)
        compared.append((indices[field.layout.name], attribute_name, scope.expression_of(field.width)))
    return ChannelCode(
        kinds=tuple(context.frames[layout.name] for layout in frame.layouts),
        position=indices[first_of(position_layouts, "channel with the position").name],
        compared=tuple(compared),
        compared_bits=scope.expression_of(frame.compared_bits),
        tolerance=frame.tolerance,
    )
