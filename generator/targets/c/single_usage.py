"""The facts at the top of a single header: what to send, what to receive, and what the macros leave out."""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain

from ...model import Spi
from ...plan.values import is_number, meaning_of
from ...say.names_and_evidence import Topic, mentions, word_for_document
from .codec import StructCodec
from .device import DeviceView
from .names import c_name


class SingleUsage:
    """How to read a position with a single header.

    ``named`` returns a text with the names of the single header in place of those in the normal header.
    """

    def __init__(self, view: DeviceView, named: Callable[[str], str]) -> None:
        self.view = view
        self._named = named

    @property
    def request(self) -> StructCodec | None:
        """The frame that requests the position, or None if there is no such frame.

        Over SPI, it is the frame that the macro of the request names.
        """
        usage = self.view.usage
        if usage is not None and usage.request_for_reply is not None:
            return usage.request_for_reply.codec
        exchanged = self.view.interface.position_request.removeprefix(f"{self.view.PREFIX}_REQUEST_").lower()
        requests = (codec for codec in self.view.interface.codecs if codec.struct.layout.name == exchanged)
        return next(requests, None)

    @property
    def reply_bytes(self) -> int:
        """Number of bytes in the reply with the position, 0 without such a reply."""
        usage = self.view.usage
        if usage is None:
            return 0
        parameters = self.view.device.variants[0].parameters
        bits = usage.frame.struct.layout.bits.value(parameters)
        # Bits to bytes, rounded up.
        return (bits + 7) // 8

    @property
    def replies_later(self) -> bool:
        """True if a reply over SPI comes with the word after its request."""
        interface = self.view.context.interface
        return isinstance(interface, Spi) and interface.reply == "next_word"

    @property
    def is_from_manual(self) -> bool:
        """True if the facts come from the manual of the encoder, and not from other documents or programs."""
        return word_for_document(self.view.device) == "manual"

    @property
    def request_bytes(self) -> str:
        """The bytes of a request that is always the same, such as ``FFh FFh``, or an empty string."""
        if self.request is None:
            return ""
        layout = self.request.struct.layout
        fields = layout.fields
        if not layout.sent_bits.is_constant:
            return ""
        number = 0
        for field in fields:
            if field.fixed_value is None:
                return ""
            number |= field.fixed_value << field.low.constant
        number_of_bytes = (layout.sent_bits.constant + 7) // 8
        return " ".join(f"{byte:02X}h" for byte in number.to_bytes(number_of_bytes, "big"))

    @property
    def pause_macro(self) -> str:
        """The macro for the shortest pause between two words over SSI, or an empty string if it is not known."""
        timings = self.view.context.interface.timings
        is_known = any(timing.name == "pause" and timing.at_least_us is not None for timing in timings)
        return self._named(f"{self.view.PREFIX}_PAUSE_AT_LEAST_US") if is_known else ""

    @property
    def lacks_pause(self) -> bool:
        """True if the spec has no times of the interface and says nothing about the pause between two words."""
        interface = self.view.context.interface
        return not interface.timings and not mentions(self.view.device, interface, Topic.PAUSE)

    @property
    def ignored_numbers(self) -> tuple[str, ...]:
        """Names of the numbers that affect neither the position nor the verdict, such as a life counter."""
        frame = self.view.reading.frame
        if frame is None:
            return ()
        position_name = self.view.device.position_name(self.view.context.interface.name)
        layouts = frame.whole_frame.layouts if frame.whole_frame is not None else (frame.struct.layout,)
        parts_of_position = {position_name}
        for layout in layouts:
            parts_of_position.update(*(join.fields for join in layout.joins if join.name == position_name))
        fields = chain.from_iterable(layout.data_fields for layout in layouts)
        numbers = (field for field in fields if is_number(meaning_of(field)) and field.equals is None)
        return tuple(c_name(field.name) for field in numbers if field.name not in parts_of_position)

    @property
    def function_for_all_fields(self) -> str:
        """The function that returns all fields of a frame: of a word, or of all data channels from the buffer."""
        frame = self.view.reading.frame
        assert frame is not None
        if frame.whole_frame is not None and self.view.channels is not None:
            return self._named(f"{self.view.channels.type}_receive")
        return self._named(f"{frame.name}_decode")
