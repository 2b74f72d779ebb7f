# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Frames that carry several data channels, one directly after the other. Each channel has its own class and CRC."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar, cast

from .codec import Word, as_word, too_long_error
from .encoder import Encoder
from .errors import FrameError
from .reports import Report, Verdict

if TYPE_CHECKING:
    from .captures.capture import ChannelCapture
    from .channel_tables import ChannelTable

_Channel = TypeVar("_Channel")


class ChannelFrame:
    """Frame with several data channels. Immutable, like the frames of its channels.

    Attributes:
        channels: Frames of the channels, in the order in which they are sent.
        agree: True if the highest bits of their positions agree. None if nothing is compared.
    """

    def __init__(self, layout: ChannelLayout, channels: tuple[Any, ...]) -> None:
        self._layout = layout
        self.channels = channels
        self.agree = layout.compare(channels) if layout.compared else None

    def of(self, kind: type[_Channel]) -> _Channel:
        """Return the channel whose frame is of class ``kind``.

        Raises:
            LookupError: There is no such channel.
        """
        for channel in self.channels:
            if isinstance(channel, kind):
                return channel
        raise LookupError(f"the frame has no channel of the class {kind.__name__}")

    @property
    def verdict(self) -> Verdict:
        """Worst verdict of all channels. It is also *not usable* if the positions of the channels do not agree.

        The verdict *unknown* matters only in the channel with the position.
        """
        verdicts = [Verdict.NOT_USABLE] if self.agree is False else []
        for index, channel in enumerate(self.channels):
            verdict = getattr(channel, "verdict", None)
            has_position = index == self._layout.position
            # A channel without the position says nothing about the position if its verdict is unknown.
            counts = has_position or verdict is not Verdict.UNKNOWN
            if verdict is not None and counts:
                verdicts.append(verdict)
        worst_first = list(Verdict)
        return min(verdicts, key=worst_first.index)

    @property
    def position(self) -> int:
        """Raw position in counts. Check ``verdict`` before you use the position."""
        return cast(int, self.channels[self._layout.position].position)

    @property
    def usable_position(self) -> int | None:
        """Position in counts, or None if it is not usable."""
        return None if self.verdict is Verdict.NOT_USABLE else self.position

    @property
    def reports(self) -> tuple[tuple[Report, ...], ...]:
        """Encoder reports in each channel."""
        return tuple(channel.reports for channel in self.channels)

    def encode(self) -> int:
        """Return the frame as it is sent, with the CRC of each channel."""
        encoded_frame = 0
        for channel, bits in zip(self.channels, self._layout.channel_bits, strict=True):
            encoded_frame = (encoded_frame << bits) | channel.encode()
        return encoded_frame

    def to_dict(self) -> dict[str, Any]:
        """Return the frame as plain values for JSON: the channels, and their common verdict and position."""
        return {
            "channels": [channel.to_dict() for channel in self.channels],
            "agree": self.agree,
            "position": self.position,
            "usable_position": self.usable_position,
            "verdict": self.verdict.value,
        }

    def __eq__(self, other: object) -> bool:
        return self.channels == other.channels if isinstance(other, ChannelFrame) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.channels)

    def __repr__(self) -> str:
        return f"ChannelFrame{self.channels!r}"


class Compared(NamedTuple):
    """Field whose highest bits are compared: the index of its channel, its name, and its width."""

    channel: int
    field: str
    width: int


class ChannelLayout:
    """Frames of one encoder that carry several data channels. Create it with ``channels()`` of an encoder.

    Args:
        encoder: The encoder.
        kinds: Classes of the frames of the channels, in the order in which they are sent.
        position: Index of the channel with the position.
        compared: Fields whose highest bits must agree.
        compared_bits: Number of these bits.
        tolerance: Maximum difference of these bits.
    """

    def __init__(
        self,
        encoder: Encoder,
        kinds: Sequence[Any],
        *,
        position: int,
        compared: Sequence[Compared] = (),
        compared_bits: int = 0,
        tolerance: int = 0,
    ) -> None:
        self.encoder = encoder
        #: Classes of the frames, one for each channel.
        self.kinds = tuple(kinds)
        #: Index of the channel with the position.
        self.position = position
        #: Channel fields whose highest bits must agree, the number of these bits, and their maximum difference.
        self.compared = tuple(compared)
        self.compared_bits = compared_bits
        self.tolerance = tolerance
        #: Method arguments for each class: the encoder, or none.
        self._arguments = [_list_arguments(frame_class, encoder) for frame_class in self.kinds]
        self.channel_bits: tuple[int, ...] = tuple(
            frame_class.frame_bits(*arguments)
            for frame_class, arguments in zip(self.kinds, self._arguments, strict=True)
        )

    @property
    def bits(self) -> int:
        """Number of bits of all channels together."""
        return sum(self.channel_bits)

    def decode(self, frame: Word, *, bits: int | None = None) -> ChannelFrame:
        """Decode a frame with all channels.

        Args:
            frame: Frame as a number whose most significant bit was sent first, as a string of 0 and 1, or as the bytes
                of the number, most significant first.
            bits: Number of bits received, if known. The number itself does not show whether bits are missing.

        Returns:
            The frame. Check its ``verdict`` before you use the position.

        Raises:
            FrameError: The frame or one of its channels is damaged. ``channel`` is the class of the channel.
            TypeError: ``frame`` is of a different type.
        """
        number = as_word(frame, self.bits, bits)
        if number >> self.bits:
            raise too_long_error(number, self.bits)
        channels: list[Any] = []
        lowest_bit = self.bits
        for frame_class, arguments, channel_bits in zip(self.kinds, self._arguments, self.channel_bits, strict=True):
            lowest_bit -= channel_bits
            channel_mask = (1 << channel_bits) - 1
            channel_number = (number >> lowest_bit) & channel_mask
            try:
                channels.append(frame_class.decode(channel_number, *arguments))
            except FrameError as error:
                error.channel = frame_class.__name__
                raise
        return ChannelFrame(self, tuple(channels))

    def try_decode(self, frame: Word, *, bits: int | None = None) -> ChannelFrame | FrameError:
        """Decode a frame like ``decode``, but return a frame error instead of raising it."""
        try:
            return self.decode(frame, bits=bits)
        except FrameError as error:
            return error

    def decode_many(self, frames: object) -> ChannelTable:
        """Decode many frames into columns for each channel. Needs NumPy.

        Args:
            frames: The frames, as numbers, or as rows of bytes with the last bit of the frame in the lowest bit of the
                last byte.

        Returns:
            The columns. An error in a frame is not raised, but recorded in the column ``fault``.
        """
        from .channel_tables import decode_channels

        return decode_channels(self, frames)

    def read_capture(
        self,
        source: Any,
        *,
        clock: str | int = "",
        data: str | int = "",
        rate: float | None = None,
        rest: float | None = None,
        threshold: float | None = None,
    ) -> ChannelCapture:
        """Decode a logic analyzer capture, with all channels of each frame. Needs NumPy.

        Args:
            source: The capture, in a format of the package's ``read_capture``.
            clock, data, rate, rest, threshold: See the package's ``read_capture``.

        Returns:
            The channel columns, frame times, lost cycles, and register accesses.

        Raises:
            InputError: The source is not a capture, or does not contain such signals. The message says what to do.
            UsageError: The arguments are wrong or incompatible with each other.
            OSError: A file cannot be read.
        """
        from .captures.capture import Probes, read_channel_capture

        probes = Probes(clock=clock, data=data, rate=rate, shortest_pause=rest, threshold=threshold)
        return read_channel_capture(self, source, probes)

    def compare(self, channels: Sequence[Any]) -> bool:
        """Return whether the compared fields of all channels agree with the first one, within ``tolerance``.

        Only the highest bits of each field are compared, because the fields can have different widths.
        """
        highest_bits: list[int] = []
        for field in self.compared:
            number = getattr(channels[field.channel], field.field)
            bits_to_drop = field.width - self.compared_bits
            highest_bits.append(number >> bits_to_drop)
        modulus = 1 << self.compared_bits
        first_bits = highest_bits[0]
        for bits in highest_bits:
            difference = (bits - first_bits) % modulus
            # The lowest and the highest number are adjacent, so the shorter way around counts.
            if min(difference, modulus - difference) > self.tolerance:
                return False
        return True


def _list_arguments(frame_class: Any, encoder: Encoder) -> tuple[Encoder, ...]:
    """Return the arguments that the methods of a frame class need: the encoder, or none if it does not matter."""
    from .frames.base import Fixed

    return () if issubclass(frame_class, Fixed) else (encoder,)
