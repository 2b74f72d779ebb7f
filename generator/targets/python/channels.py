"""Frames with several data channels in Python."""

from __future__ import annotations

from ...model import Interface, channel_frame, first_of
from ...model.record import dataclass
from .literals import Expr, Scope
from .names import ClassNames, Context


@dataclass(frozen=True)
class ChannelCode:
    """Frame with several data channels: the classes of its channels, and the index of the channel with the position.

    ``compared`` contains the index of the channel, the attribute and the width of each compared field. The highest
    ``compared_bits`` bits of these fields must not differ by more than ``tolerance``.
    """

    kinds: tuple[str, ...]
    position: int
    compared: tuple[tuple[int, str, Expr], ...]
    compared_bits: Expr
    tolerance: int


def channel_code(context: Context, interface: Interface, scope: Scope) -> ChannelCode | None:
    """Return the code for the frame with all data channels of an interface, or None if it has no such frame.

    ``scope`` contains the expressions of the parameters, such as ``self.bits``, in which widths are written.
    """
    frame = channel_frame(interface)
    if frame is None:
        return None
    # Each layout is one channel of the frame.
    index_by_layout = {layout.name: index for index, layout in enumerate(frame.layouts)}
    position_layouts = (layout for layout in frame.layouts if context.device.sends_position(interface.name, layout))
    compared = []
    for field in frame.compared:
        # A channel is a frame layout, so no names are reserved for a register or for CRC functions.
        class_names = ClassNames(field.layout, register=None, crcs=())
        channel_index = index_by_layout[field.layout.name]
        compared.append((channel_index, class_names.attribute(field.name), scope.expression_of(field.width)))
    position_layout = first_of(position_layouts, "channel with the position")
    return ChannelCode(
        kinds=tuple(context.frames[layout.name] for layout in frame.layouts),
        position=index_by_layout[position_layout.name],
        compared=tuple(compared),
        compared_bits=scope.expression_of(frame.compared_bits),
        tolerance=frame.tolerance,
    )
