"""Parts of interfaces: clocks and timeouts, and frames that carry several data channels.

The channels of a frame directly follow each other, each with the bits that its CRC covers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Literal

from .expressions import Expression
from .layout import Layout, PlacedLayout
from .manual import Sources
from .part import NOTHING, ClocksInUse, Count, Name, Phrase, key, only_key, part, source_key
from .record import dataclass, member_named


@part(
    "Clock frequencies: the limits of the encoder, and clocks that are known to have been used. "
    "One of the two is required, unless the source is still TODO or the grade is uncorroborated. The "
    "outputs then say that the clock is not known.",
    data="Clock frequencies. A limit is null if it is not known.",
)
class Clock:
    """The master's clock: its limits, inclusive, each None if not known, and clocks with which encoders are read.

    ``used_hz`` contains the clocks of programs and masters in ascending order. They are not limits. A spec whose clock
    has not been stated yet has neither limits nor clocks in use.
    """

    min_hz: int | None = key(
        "Minimum clock frequency in Hz. Leave it out if it is not known.",
        data="Minimum frequency in Hz.",
        minimum=1,
        maximum=1000000000,
        default=None,
        rule="clock-narrower",
        label="lowest clock",
        read="clock",
    )
    max_hz: int | None = key(
        "Maximum clock frequency in Hz. Required, unless 'used_hz' is given or no clock is known.",
        data="Maximum frequency in Hz.",
        minimum=1,
        maximum=1000000000,
        default=None,
        rule="clock-narrower",
        label="highest clock",
        read="clock",
    )
    used_hz: ClocksInUse = key(
        "A clock in Hz at which a program or a master reads the encoder, or a list of them in "
        "ascending order. It is not a limit. Use it if no document of the manufacturer gives the "
        "limits.",
        data="Frequencies in Hz that programs or masters use, in ascending order. They are not limits.",
        default=(),
        rule="clock-used",
        label="clock in use",
        read="clock",
    )
    only: Phrase = only_key(default="")
    source: Sources = source_key()

    @property
    def fastest_hz(self) -> int | None:
        """Highest clock if it is known, otherwise the fastest that is in use. None if there is neither."""
        return self.max_hz if self.max_hz is not None else max(self.used_hz, default=None)

    @property
    def has_limits(self) -> bool:
        return self.min_hz is not None or self.max_hz is not None


@part("One value.", data="A value calculated in the manual.")
class PrintedTimeout:
    """Timeout given in the manual for one clock frequency."""

    clock_hz: int = key("Clock in Hz.", minimum=1)
    timeout_ns: Count = key("Timeout in nanoseconds.")


@part("Timeout after a frame.")
class Timeout:
    """Timeout after a frame. ``rule`` is ``follows_clock`` or ``fixed``."""

    rule: Literal["follows_clock", "fixed"] = key(
        "Rule of the timeout: it depends on the clock, or it is fixed.", read="time", data_type="name"
    )
    half_clock_periods: int | None = key(
        "Length in half clock periods: 3 is one and a half periods.",
        data="Length in half clock periods.",
        minimum=1,
        maximum=100,
        default=None,
        read="time",
    )
    at_most_ns: Count | None = key("Upper bound in nanoseconds.", default=None, read="time", noun="upper bound")
    typical_ns: Count | None = key("Typical value in nanoseconds.", default=None, read="time", noun="typical value")
    printed: tuple[PrintedTimeout, ...] = key(
        "Values calculated in the manual.", writing="'check' compares them with the rule.", least=0, default=()
    )
    only: Phrase = only_key(default="")
    source: Sources = source_key()


#: Keys of the clock limit in a row of the table of cable lengths.
CABLE_LIMITS = ("below_hz", "at_most_hz")


@part("One row of the table.", data="Highest clock frequency by cable length.")
class CableLength:
    """Clock limit in Hz for cables shorter than a length in metres: ``below_hz`` (exclusive) or ``at_most_hz``."""

    shorter_than_m: int = key("Cable length in metres, exclusive upper bound.", minimum=1)
    below_hz: int | None = key("Clock in Hz, exclusive upper bound.", minimum=1, default=None)
    at_most_hz: int | None = key(
        "Clock in Hz, inclusive upper bound.",
        writing="All rows of a table have either this key or below_hz.",
        minimum=1,
        default=None,
    )
    only: Phrase = only_key(default="")
    source: Sources = source_key(default=())

    @property
    def is_exclusive(self) -> bool:
        """True if the clock must be below the limit, not equal to it."""
        return self.at_most_hz is None

    @property
    def limit_key(self) -> str:
        """Key of the limit: ``at_most_hz`` or, by default, ``below_hz``."""
        return "below_hz" if self.is_exclusive else "at_most_hz"

    @property
    def limit_hz(self) -> int:
        """The limit as the manual prints it, or 0 if the row of a spec with problems has none."""
        return self.at_most_hz or self.below_hz or 0

    @property
    def limit_words(self) -> str:
        """Words in front of the limit: ``below`` or ``at most``."""
        return "below" if self.is_exclusive else "at most"


@part(
    "Data channels that the encoder sends in one frame, one directly after the other, such as the "
    "control and the safety position word of BiSS Safety. Each is a layout with its own CRC.",
    data="Data channels in one frame, one directly after the other.",
)
class DataChannels:
    """Data channels of one frame. ``compared`` contains the field of each layout whose highest bits must agree.

    These are ``compared_bits`` bits of each field, which may differ by ``tolerance``. The lowest and the highest number
    of these bits are adjacent.
    """

    order: tuple[Name, ...] = key(
        "Layouts of the channels, in the order in which they are sent.",
        data="Names of the layouts, in the order in which they are sent.",
        most=8,
        rule="channels-of-frame",
        label="order of the channels",
    )
    compared: Mapping[Name, Name] = key(
        "Fields with the same position, by layout, as in {cpw: singleturn, spw: safe_singleturn}. Their "
        "highest bits must agree, otherwise the position is not usable.",
        data="Fields whose highest bits must agree, by layout.",
        data_type="{string}",
        most=8,
        default=NOTHING,
        rule="channels-of-frame",
        label="compared fields",
    )
    compared_bits: Expression | None = key(
        "With compared: number of the highest bits of these fields that are compared.",
        data="Number of the highest bits that are compared. null if there are none.",
        default=None,
        rule="channels-of-frame",
        read="setting",
        noun="number of compared bits",
    )
    tolerance: Count = key(
        "Highest difference of the compared bits, in units of their lowest bit.",
        default=0,
        rule="channels-of-frame",
        read="setting",
    )
    source: Sources = source_key()


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
        channel_numbers = []
        low_bit = self.bits
        for channel in self.channels:
            low_bit -= channel.bits
            mask = (1 << channel.bits) - 1
            channel_numbers.append((frame >> low_bit) & mask)
        return tuple(channel_numbers)

    def join(self, numbers: Sequence[int]) -> int:
        """Return the frame with these bits of each channel."""
        frame = 0
        for channel, number in zip(self.channels, numbers, strict=True):
            frame = (frame << channel.bits) | number
        return frame

    def compared_numbers(self, values_of_channels: Sequence[Mapping[str, object]]) -> Iterator[int]:
        """Yield the highest bits of each compared field, from the values of each channel, by field."""
        for channel, values_of_channel in zip(self.channels, values_of_channels, strict=True):
            compared_field_name = self.compared.get(channel.name)
            if compared_field_name is not None:
                number = values_of_channel[compared_field_name]
                assert isinstance(number, int)
                lower_bits = channel.field(compared_field_name).width - self.compared_bits
                yield number >> lower_bits

    def agree(self, values_of_channels: Sequence[Mapping[str, object]]) -> bool:
        """Return True if the positions in the compared fields of all channels agree with the first one.

        ``values_of_channels`` contains the values of each channel, by field. At least one field must be compared.
        """
        first_number, *other_numbers = self.compared_numbers(values_of_channels)
        return all(self._are_close(first_number, number) for number in other_numbers)

    def _are_close(self, position: int, other_position: int) -> bool:
        """Return True if two positions differ by at most the tolerance, also where the position wraps around."""
        modulus = 1 << self.compared_bits
        difference = (position - other_position) % modulus
        return min(difference, modulus - difference) <= self.tolerance


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
