"""Frames that carry several data channels, one directly after the other, each with the bits that its CRC covers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from .data_channels import DataChannels
from .expressions import Expression
from .interfaces import Biss, Interface
from .layout import Layout, PlacedLayout
from .lookup import member_named
from .record import dataclass


@dataclass(frozen=True, slots=True)
class ComparedField:
    """A field whose highest bits must agree with those of the other compared fields."""

    layout: Layout
    name: str

    @property
    def width(self) -> Expression:
        return self.layout.field(self.name).width


@dataclass(frozen=True, slots=True)
class ChannelFrame:
    """A frame with several data channels. ``layouts`` are the layouts of the channels, in the order sent.

    The ``compared`` fields contain the same position. Their highest ``compared_bits`` bits must not differ from those
    of the first field by more than ``tolerance``, also where the position wraps around.
    """

    layouts: tuple[Layout, ...]
    compared: tuple[ComparedField, ...]
    compared_bits: Expression
    tolerance: int

    @property
    def bits(self) -> Expression:
        """Number of bits of all channels together."""
        return sum((layout.bits for layout in self.layouts), Expression(0))

    @property
    def sent_bits(self) -> Expression:
        """Number of bits on the line. No channel has bits that are not sent."""
        return self.bits

    def bits_before(self, layout: Layout) -> Expression:
        """Return the number of bits of the channels that are sent before ``layout``."""
        place = self.layouts.index(layout)
        return sum((earlier.bits for earlier in self.layouts[:place]), Expression(0))

    @property
    def widest(self) -> int:
        """Highest number of bits that it can have."""
        return sum(layout.widest for layout in self.layouts)

    def place(self, parameters: Mapping[str, int]) -> PlacedChannels:
        """Return the frame for one order code."""
        channels = tuple(layout.place(parameters) for layout in self.layouts)
        compared_fields = {compared.layout.name: compared.name for compared in self.compared}
        bits = self.compared_bits.value(parameters)
        return PlacedChannels(channels=channels, compared=compared_fields, compared_bits=bits, tolerance=self.tolerance)


@dataclass(frozen=True, slots=True)
class PlacedChannels:
    """A frame with several data channels for one order code.

    ``compared`` contains the compared field of each layout.
    """

    channels: tuple[PlacedLayout, ...]
    compared: Mapping[str, str]
    compared_bits: int
    tolerance: int

    @property
    def bits(self) -> int:
        """Number of bits of all channels together."""
        return sum(channel.bits for channel in self.channels)

    def split(self, frame: int) -> tuple[int, ...]:
        """Return the bits of each channel. The first channel has the highest bits of the frame.

        With channels of 4 and 8 bits, the frame 0xABC has the bits 0xA and 0xBC.
        """
        numbers = []
        low_bit = self.bits
        for channel in self.channels:
            low_bit -= channel.bits
            mask = (1 << channel.bits) - 1
            numbers.append((frame >> low_bit) & mask)
        return tuple(numbers)

    def join(self, numbers: Sequence[int]) -> int:
        """Return the frame with these bits of each channel."""
        frame = 0
        for channel, number in zip(self.channels, numbers, strict=True):
            frame = (frame << channel.bits) | number
        return frame

    def compared_numbers(self, values: Sequence[Mapping[str, object]]) -> Iterator[int]:
        """Yield the highest bits of each compared field. ``values`` contains the values of each channel, by field."""
        for channel, values_of_channel in zip(self.channels, values, strict=True):
            name = self.compared.get(channel.name)
            if name is not None:
                number = values_of_channel[name]
                assert isinstance(number, int)
                lower_bits = channel.field(name).width - self.compared_bits
                yield number >> lower_bits

    def agree(self, values: Sequence[Mapping[str, object]]) -> bool:
        """Return True if the positions in the compared fields of all channels agree with the first one.

        ``values`` contains the values of each channel, by field. At least one field must be compared.
        """
        first_number, *other_numbers = self.compared_numbers(values)
        return all(self._are_close(first_number, number) for number in other_numbers)

    def _are_close(self, position: int, other_position: int) -> bool:
        """Return True if two positions differ by at most the tolerance, also where the position wraps around."""
        modulus = 1 << self.compared_bits
        difference = (position - other_position) % modulus
        return min(difference, modulus - difference) <= self.tolerance


def channel_frame(interface: Interface) -> ChannelFrame | None:
    """Return the frame that carries several data channels over an interface, or None if there is none."""
    if not isinstance(interface, Biss) or interface.channels is None:
        return None
    return frame_of_channels(interface.channels, interface.layouts)


def frame_of_channels(channels: DataChannels, layouts: Sequence[Layout]) -> ChannelFrame:
    """Return the frame with these channels. All names in it must exist."""
    ordered_layouts = tuple(member_named(layouts, name, "layout") for name in channels.order)
    compared_fields: list[ComparedField] = []
    for layout in ordered_layouts:
        if layout.name in channels.compared:
            compared_fields.append(ComparedField(layout, channels.compared[layout.name]))
    return ChannelFrame(
        layouts=ordered_layouts,
        compared=tuple(compared_fields),
        compared_bits=channels.compared_bits or Expression(0),
        tolerance=channels.tolerance,
    )
