"""Data channels of BiSS other than the position channel, in the same frame or in their own frames."""

from __future__ import annotations

from collections.abc import Iterator

from ..language.problems import join_words
from ..model import Biss, Interface, PlacedLayout, channel_frame
from ..model.record import dataclass


@dataclass(frozen=True, slots=True)
class FrameChannels:
    """Names of the data channels before and after the position in its frame, in the order in which they are sent."""

    before: tuple[str, ...] = ()
    after: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        """Return whether the frame has other data channels than the one with the position."""
        return bool(self.before or self.after)

    def refusal(self, position_layout: str) -> str:
        """Return the reason why a master for a single data channel cannot read the position, or an empty string.

        Such a master reads only the first channel of a frame. ``position_layout`` is the channel with the position.
        """
        if not self.before:
            return ""
        first_name = self.before[0]
        order_text = f"'{first_name}' is the first in the frame, and '{position_layout}' with the position follows it"
        return f"The description of this master covers a single data channel, but {order_text}."

    @property
    def gap(self) -> str:
        """Sentence about the channels that a master for a single data channel does not read."""
        names = join_words(f"'{name}'" for name in self.after)
        return f"The description of this master covers a single data channel. Nothing reads {names} after it."


#: A frame with a single data channel.
NO_CHANNELS = FrameChannels()


def frame_channels(interface: Interface, position_layout: PlacedLayout) -> FrameChannels:
    """Return the names of the other data channels in the frame with the position, if the frame has several channels."""
    frame = channel_frame(interface)
    layouts = frame.layouts if frame is not None else ()
    names = [layout.name for layout in layouts if layout.is_sent(position_layout.parameters)]
    if position_layout.name not in names:
        return NO_CHANNELS
    index = names.index(position_layout.name)
    return FrameChannels(before=tuple(names[:index]), after=tuple(names[index + 1 :]))


def channel_notes(interface: Interface, position_layout: PlacedLayout) -> Iterator[str]:
    """Yield a sentence about BiSS data channels that the settings do not cover, because they lack the position."""
    channel = position_layout.layout.channel
    sent_layouts = [layout for layout in interface.layouts if layout.is_sent(position_layout.parameters)]
    other_layouts = [layout for layout in sent_layouts if layout.channel and layout.channel != channel]
    if isinstance(interface, Biss) and channel and other_layouts:
        other_channels = " and ".join(f"'{layout.name}' on channel {layout.channel}" for layout in other_layouts)
        yield f"The encoder also sends {other_channels}. These settings are for channel {channel} only."
