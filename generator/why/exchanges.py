"""The user's own requests among the received bits: whole RS-485 frames, and SPI words that equal a request.

The decode page follows the same rules.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import prod
from operator import itemgetter

from ..model import (
    Constant,
    Device,
    Interface,
    Layout,
    Number,
    PlacedLayout,
    Rs485,
    Spi,
    Unused,
    Variant,
    number_from_bytes,
)
from ..model.record import dataclass
from ..reference import codec
from ..reference.bits_and_values import unused_bits
from .hypotheses import Hypothesis, check_constant_bits, likelihood

#: Maximum number of bytes that are searched for frames.
MOST_BYTES = 64
#: Fewest bits with the expected value that prove that bytes are frames.
LEAST_EVIDENCE = 3
ECHO_TEXT = (
    "these bytes are only your own request{0}: the receiver stays on during transmission, wires A and B are swapped, "
    "or the encoder does not answer"
)
FRAMES_TEXT = "the bytes are whole frames: {0}"
#: Fewest bits with the expected value that prove that an SPI word is a request. Fewer may match by chance.
LEAST_BITS_OF_ECHO = 12
WORD_ECHO_TEXT = (
    "this word is your own request{0}: MISO is connected to MOSI, or the encoder does not answer on a shared line"
)


@dataclass(frozen=True, slots=True)
class ExchangedFrame:
    """A valid frame among the received bytes. ``evidence`` is the number of its bits that have an expected value."""

    placed_layout: PlacedLayout
    data: bytes
    evidence: int

    @property
    def likelihood(self) -> float:
        """How likely the flags and reserved bits of the frame are, compared with random bits."""
        return likelihood(self.placed_layout, number_from_bytes(self.placed_layout.layout, self.data))

    @property
    def is_request(self) -> bool:
        """True if the master sends this frame."""
        return self.placed_layout.layout.sender == "master"

    @property
    def role(self) -> str:
        """The word ``request`` or ``reply``."""
        return "request" if self.is_request else "reply"

    @property
    def title(self) -> str:
        """The role and the name of the frame, such as ``reply position_frame``, or only ``reply`` for such a name."""
        name = self.placed_layout.name
        return self.role if name == self.role else f"{self.role} {name}"


def _describe_frames(frames: Sequence[ExchangedFrame], mistake_kind: str) -> tuple[str, str]:
    """Return the text on whole frames, with their names and without them."""
    if mistake_kind == "echo":
        return ECHO_TEXT.format(f" {frames[0].placed_layout.name}"), ECHO_TEXT.format("")
    titles = ", then ".join(frame.title for frame in frames)
    roles = ", then ".join(frame.role for frame in frames)
    return FRAMES_TEXT.format(titles), FRAMES_TEXT.format(roles)


def exchange_hypotheses(device: Device, variant: Variant, received_bytes: bytes) -> Iterator[Hypothesis]:
    """Yield the hypothesis that bytes received over RS-485 are several whole frames, or only the user's own request.

    Nothing is yielded if they are a single reply, or if other bytes remain. If the last frame is a reply that can be
    decoded without an answer to an open question, the hypothesis contains it.
    """
    if variant.interface != Rs485.name:
        return
    split_frames = _frames_in(device, variant, received_bytes)
    if not split_frames:
        return
    frames = _with_own_replies(device, variant, split_frames)
    is_one_reply = len(frames) == 1 and not frames[0].is_request
    if is_one_reply:
        return
    evidence = sum(frame.evidence for frame in frames)
    if evidence < LEAST_EVIDENCE:
        return
    mistake_kind = _mistake_kind(frames)
    description, template = _describe_frames(frames, mistake_kind)
    hypothesis = Hypothesis(
        kind=mistake_kind,
        description=description,
        crc=None,
        covered_data=int.from_bytes(received_bytes, "big"),
        covered_bits=8 * len(received_bytes),
        received_crc=0,
        received_crc_bits=0,
        determined_bits=evidence,
        likelihood=prod(frame.likelihood for frame in frames),
        recording_parts=tuple((frame.title, frame.data.hex(" ").upper()) for frame in frames),
        template=template,
    )
    last_frame = frames[-1]
    last_layout = last_frame.placed_layout
    if not last_frame.is_request and not device.alternatives_of(last_layout.layout):
        frame_number = number_from_bytes(last_layout.layout, last_frame.data)
        hypothesis = replace(hypothesis, frame=frame_number, frame_layout=last_layout)
    yield hypothesis


def _mistake_kind(frames: Sequence[ExchangedFrame]) -> str:
    """Return the kind of mistake with which these frames were received instead of a single reply.

    It is ``echo`` if all frames are requests, and ``several_frames`` for several replies. With one reply, it is
    ``bytes_in_front`` if the first frame is a request, and otherwise ``bytes_behind``.
    """
    replies = [frame for frame in frames if not frame.is_request]
    if not replies:
        return "echo"
    if len(replies) > 1:
        return "several_frames"
    begins_with_request = frames[0].is_request
    return "bytes_in_front" if begins_with_request else "bytes_behind"


def _frames_in(device: Device, variant: Variant, received_bytes: bytes) -> tuple[ExchangedFrame, ...] | None:
    """Split bytes into as few valid frames as possible, and return them in order, or None if other bytes remain.

    The tuple is empty if there are no bytes. More than 64 bytes are not searched, and the result is None.
    """
    if len(received_bytes) > MOST_BYTES:
        return None
    byte_layouts = [layout for layout in device.interface(variant.interface).layouts if layout.in_bytes]
    placed_layouts = [layout.place(variant.parameters) for layout in byte_layouts]
    requests = [placed_layout for placed_layout in placed_layouts if placed_layout.layout.sender == "master"]
    replies = [placed_layout for placed_layout in placed_layouts if placed_layout.layout.sender != "master"]
    # The fewest frames from each byte to the end, by the index of the byte. The map is filled from the end.
    fewest_frames_from: dict[int, tuple[ExchangedFrame, ...]] = {len(received_bytes): ()}
    for start in reversed(range(len(received_bytes))):
        # The first frame is likely to be a request, and later frames are likely to be replies.
        likeliest_layouts_first = requests + replies if start == 0 else replies + requests
        for placed_layout in likeliest_layouts_first:
            end = start + placed_layout.bits // 8
            if end not in fewest_frames_from:
                continue
            following_frames = fewest_frames_from[end]
            frame_count = 1 + len(following_frames)
            has_fewer_frames = start not in fewest_frames_from or frame_count < len(fewest_frames_from[start])
            if not has_fewer_frames:
                continue
            frame = _valid_frame(device, variant.interface, placed_layout, received_bytes[start:end])
            if frame is not None:
                fewest_frames_from[start] = (frame, *following_frames)
    return fewest_frames_from.get(0)


def own_replies(interface: Interface) -> dict[str, str]:
    """Return the name of the reply to each request over RS-485, by the name of the request."""
    if not isinstance(interface, Rs485):
        return {}
    return {exchange.request: exchange.reply for exchange in interface.exchanges if exchange.reply}


def _with_own_replies(device: Device, variant: Variant, frames: Sequence[ExchangedFrame]) -> tuple[ExchangedFrame, ...]:
    """Return the frames with each reply as the reply to the request before it, if its bytes are also valid as such."""
    interface = device.interface(variant.interface)
    reply_by_request = own_replies(interface)
    frames_with_replies = list(frames)
    for index, (request, reply) in enumerate(pairwise(frames)):
        reply_name = reply_by_request.get(request.placed_layout.name, "") if request.is_request else ""
        if reply.is_request or reply_name in ("", reply.placed_layout.name):
            continue
        layout = next(layout for layout in interface.layouts if layout.name == reply_name)
        placed_layout = layout.place(variant.parameters)
        if placed_layout.bits == 8 * len(reply.data):
            own_reply = _valid_frame(device, variant.interface, placed_layout, reply.data)
            frames_with_replies[index + 1] = own_reply or reply
    return tuple(frames_with_replies)


def _valid_frame(
    device: Device, interface: str, placed_layout: PlacedLayout, received_bytes: bytes
) -> ExchangedFrame | None:
    """Return the bytes as a frame with this layout, or None if they are not a valid frame.

    Return None also if no bit of the frame has an expected value, so that any bytes would be valid.
    """
    frame_number = number_from_bytes(placed_layout.layout, received_bytes)
    usual_values = usual_values_of(device, interface, placed_layout.layout)
    evidence = _expected_bits(device, placed_layout, frame_number, usual_values)
    if not evidence or codec.decode_placed(device, placed_layout, received_bytes).problems:
        return None
    return ExchangedFrame(placed_layout=placed_layout, data=received_bytes, evidence=evidence)


def echo_hypotheses(device: Device, variant: Variant, placed_layout: PlacedLayout, frame: int) -> Iterator[Hypothesis]:
    """Yield the hypothesis that an SPI word is the request that the master itself sent, if it equals a request."""
    request_and_evidence = _echoed_request(device, variant, placed_layout, frame)
    if request_and_evidence is None:
        return
    request, evidence = request_and_evidence
    yield Hypothesis(
        kind="echo",
        description=WORD_ECHO_TEXT.format(f" {request.name}"),
        template=WORD_ECHO_TEXT.format(""),
        crc=None,
        covered_data=frame,
        covered_bits=request.bits,
        received_crc=0,
        received_crc_bits=0,
        determined_bits=evidence,
    )


def own_request(device: Device, variant: Variant, placed_layout: PlacedLayout, frame: int) -> str:
    """Return the name of the request that a received SPI word equals, or an empty string."""
    request_and_evidence = _echoed_request(device, variant, placed_layout, frame)
    if request_and_evidence is None:
        return ""
    request, _ = request_and_evidence
    return request.name


def _echoed_request(
    device: Device, variant: Variant, placed_layout: PlacedLayout, frame: int
) -> tuple[PlacedLayout, int] | None:
    """Return the SPI request that a received word equals, and the number of bits that prove it.

    These are the bits that have an expected value in the request. At least 12 are needed. If several requests match, it
    is the one with the most of these bits. Return None if no request matches.
    """
    is_from_encoder = placed_layout.layout.sender == "encoder"
    has_too_many_bits = frame >> placed_layout.bits != 0
    if variant.interface != Spi.name or not is_from_encoder or has_too_many_bits:
        return None
    # Bits that every reply contains as well, such as a repeated command, do not prove an echo.
    repeated_bits = sum(
        field.width for field in placed_layout.fields if isinstance(field.field.kind, (Constant, Unused))
    )
    candidates: list[tuple[PlacedLayout, int]] = []
    for layout in device.interface(Spi.name).layouts:
        if layout.sender != "master" or layout.in_bytes:
            continue
        request = layout.place(variant.parameters)
        is_valid = request.bits == placed_layout.bits and not codec.decode(device, request, frame).problems
        has_documented_bits = unused_bits(request, frame) == 0
        if is_valid and has_documented_bits:
            usual_values = usual_values_of(device, Spi.name, layout)
            expected_bits = _expected_bits(device, request, frame, usual_values)
            candidates.append((request, expected_bits - repeated_bits))
    proven_candidates = [(request, evidence) for request, evidence in candidates if evidence >= LEAST_BITS_OF_ECHO]
    return max(proven_candidates, key=itemgetter(1), default=None)  # with the most evidence


def usual_values_of(device: Device, interface: str, layout: Layout) -> dict[str, list[int]]:
    """Return the values that fields of a frame usually have, by name, such as ``{"address": [0x15]}``.

    These are the factory defaults of fields with the same name in any frame of the interface, since a reply repeats the
    address in its request. In an SPI request, they are also the addresses of all registers, and the values of unused
    fields in the manual.
    """
    field_names = {field.name for field in layout.fields}
    values_by_field: dict[str, list[int]] = {}
    for any_layout in device.interface(interface).layouts:
        for field in any_layout.fields:
            if field.default is not None and field.name in field_names:
                values_by_field[field.name] = [field.default]
    if interface != Spi.name or layout.sender != "master":
        return values_by_field
    addresses = sorted({register.address for register in device.registers_over(interface)})
    for field in layout.fields:
        if field.name == "address" and isinstance(field.kind, Number) and addresses:
            values_by_field.setdefault(field.name, addresses)
        elif isinstance(field.kind, Unused) and field.width.is_constant:
            unused_mask = (1 << field.width.constant) - 1
            values_by_field[field.name] = [field.kind.value & unused_mask]
    return values_by_field


def _expected_bits(
    device: Device, placed_layout: PlacedLayout, frame: int, usual_values: Mapping[str, Sequence[int]]
) -> int:
    """Return the number of bits in a valid frame that have an expected value, which proves that the bits are a frame.

    These are the bits of the CRC, of constants, and of fields with one of their usual values. A field with 4 usual
    values has 2 free bits, which do not count.
    """
    crc = device.crc_of(placed_layout)
    constant_bits, _ = check_constant_bits(placed_layout, frame)
    usual_bits = 0
    for placed_field in placed_layout.fields:
        values = usual_values.get(placed_field.name, ())
        raw_value = (frame >> placed_field.lowest_bit) & placed_field.mask
        if raw_value in values:
            # Choosing one of 3 or 4 values takes 2 bits, and a single value takes 0 bits.
            free_bits = (len(values) - 1).bit_length()
            usual_bits += placed_field.width - free_bits
    crc_bits = crc.width if crc is not None else 0
    return constant_bits + usual_bits + crc_bits
