"""Frames with several data channels in C: their struct, their lengths by order code, and the compared members."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import ChannelFrame, channel_frame, first_or_raise
from .codec import StructCodec
from .context import HeaderContext
from .names import CExpression, DeclaredName, c_name


class ChannelCode:
    """The values that the template prints for a frame that consists of several data channels.

    ``compared`` contains the fields that must have the same value in their channels, such as two positions: the member
    of the struct, and the width of the field.
    """

    def __init__(self, context: HeaderContext, frame: ChannelFrame, codecs: Sequence[StructCodec]) -> None:
        self._context = context
        self._frame = frame
        self.type = f"{context.prefix}_channels"
        codec_by_layout = {codec.struct.layout.name: codec for codec in codecs}
        self.codecs = [codec_by_layout[layout.name] for layout in frame.layouts]
        self.compared: list[tuple[str, CExpression]] = []
        for channel_field in frame.compared:
            member = f"{c_name(channel_field.layout.name)}.{c_name(channel_field.name)}"
            self.compared.append((member, context.scope.expression_of(channel_field.width)))

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names of the struct, its functions and its macros."""
        path = ("interfaces", self._context.interface.name, "channels")
        functions = ["bits", "decode", "verdict", "receive"]
        if self.compared:
            functions.append("agree")
        yield self.type, path
        yield from ((f"{self.type}_{function}", path) for function in functions)

    @property
    def about(self) -> list[str]:
        """The comment on the struct, which names the channels in the order sent."""
        channel_names = " and ".join(layout.name for layout in self._frame.layouts)
        return [f"The data channels of one frame, one directly after the other: {channel_names}."]

    @property
    def about_comparison(self) -> list[str]:
        """The comment on the function that compares the members."""
        members = " and ".join(member for member, _ in self.compared)
        tolerance = f" by more than {self._frame.tolerance}" if self._frame.tolerance else ""
        bits = self._frame.compared_bits.render()
        return [f"Return true unless the highest {bits} bits of {members} differ{tolerance}."]

    @property
    def compared_bits(self) -> CExpression:
        return self._context.scope.expression_of(self._frame.compared_bits)

    @property
    def tolerance(self) -> int:
        """The largest difference at which the compared fields still agree."""
        return self._frame.tolerance

    @property
    def depends_on_variant(self) -> bool:
        """True if the compared bits depend on the order code."""
        widths = [self._frame.compared_bits, *(field.width for field in self._frame.compared)]
        return not all(width.is_constant for width in widths)

    @property
    def position_codec(self) -> StructCodec:
        """The decoder and encoder of the channel with the position."""
        interface = self._context.interface.name
        layouts = (layout for layout in self._frame.layouts if self._context.device.sends_position(interface, layout))
        layout = first_or_raise(layouts, "channel with the position")
        # The codecs are in the order of the layouts.
        return self.codecs[self._frame.layouts.index(layout)]

    @property
    def judging_codecs(self) -> list[StructCodec]:
        """The channels without the position whose flags decide whether the position is usable (its verdict)."""
        other_codecs = (codec for codec in self.codecs if codec is not self.position_codec)
        return [codec for codec in other_codecs if codec.reports is not None and codec.reports.verdict]


def channel_code(context: HeaderContext, codecs: Sequence[StructCodec]) -> ChannelCode | None:
    """Return the C code for the frame with all data channels of an interface, or None if frames have one channel."""
    frame = channel_frame(context.interface)
    return ChannelCode(context, frame, codecs) if frame is not None else None
