"""Own requests among the received bits: whole frames of RS-485, and words of SPI that equal a request.

The decode page follows the same rules.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from ..model import Constant, Device, Layout, Number, PlacedLayout, Rs485, Spi, Unused, Variant, number_from_bytes
from ..model.record import dataclass
from ..reference import codec
from ..reference.bits import unused_bits
from .hypotheses import Hypothesis, check_constant_bits

#: More bytes than this are not searched for frames.
MOST_BYTES = 64
#: Frames with fewer expected bits in all may be any bytes.
LEAST_EVIDENCE = 3
ECHO_TEXT = (
    "these bytes are only your own request{0}: the receiver is on while sending, wires A and B are swapped, or the "
    "encoder does not answer"
)
FRAMES_TEXT = "the bytes are whole frames: {0}"
#: A word of SPI with fewer expected bits may equal a request by coincidence.
LEAST_BITS_OF_ECHO = 12
WORD_ECHO_TEXT = (
    "this word is your own request{0}: MISO is connected to MOSI, or the encoder does not answer on a shared line"
)


@dataclass(frozen=True, slots=True)
class ExchangedFrame:
    """A valid frame among the bytes. ``evidence`` is the number of its bits that have the only expected value."""

    placed_layout: PlacedLayout
    data: bytes
    evidence: int

    @property
    def is_request(self) -> bool:
        return self.placed_layout.layout.sender == "master"

    @property
    def role(self) -> str:
        return "request" if self.is_request else "reply"

    @property
    def title(self) -> str:
        return f"{self.role} {self.placed_layout.name}"


def exchange_hypotheses(device: Device, variant: Variant, received_bytes: bytes) -> Iterator[Hypothesis]:
    """Yield one hypothesis that bytes over RS-485 are whole frames, unless they are a single reply or no whole frames.

    If the last of these frames is a reply whose meaning is known, the hypothesis contains it.
    """
    frames = _frames_in(device, variant, received_bytes) if variant.interface == Rs485.name else None
    if not frames:
        return
    is_one_reply = len(frames) == 1 and not frames[0].is_request
    if is_one_reply:
        return
    evidence = sum(frame.evidence for frame in frames)
    if evidence < LEAST_EVIDENCE:
        return
    mistake_kind = _mistake_kind(frames)
    if mistake_kind == "echo":
        description = ECHO_TEXT.format(f" {frames[0].placed_layout.name}")
        template = ECHO_TEXT.format("")
    else:
        description = FRAMES_TEXT.format(", then ".join(frame.title for frame in frames))
        template = FRAMES_TEXT.format(", then ".join(frame.role for frame in frames))
    hypothesis = Hypothesis(
        kind=mistake_kind,
        description=description,
        crc=None,
        covered_data=int.from_bytes(received_bytes, "big"),
        covered_bits=8 * len(received_bytes),
        received_crc=0,
        received_crc_bits=0,
        determined_bits=evidence,
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
    """Return the kind of mistake: "echo" for only requests, or "several_frames" for several replies.

    With one reply, other bytes are "bytes_in_front" of it if the first frame is a request, and else "bytes_behind" it.
    """
    replies = [frame for frame in frames if not frame.is_request]
    if not replies:
        return "echo"
    if len(replies) > 1:
        return "several_frames"
    begins_with_request = frames[0].is_request
    return "bytes_in_front" if begins_with_request else "bytes_behind"


def _frames_in(device: Device, variant: Variant, received_bytes: bytes) -> tuple[ExchangedFrame, ...] | None:
    """Return the fewest valid frames that the bytes consist of, in order, or None if other bytes remain.

    ``()`` is the result for no bytes. More than 64 bytes are not searched.
    """
    if len(received_bytes) > MOST_BYTES:
        return None
    byte_layouts = [layout for layout in device.interface(variant.interface).layouts if layout.in_bytes]
    placed_layouts = [layout.place(variant.parameters) for layout in byte_layouts]
    requests = [placed_layout for placed_layout in placed_layouts if placed_layout.layout.sender == "master"]
    replies = [placed_layout for placed_layout in placed_layouts if placed_layout.layout.sender != "master"]
    # The fewest frames from each byte to the end, by the index of the byte. It is filled from the end, so the frames
    # after a byte are known.
    fewest_frames_from: dict[int, tuple[ExchangedFrame, ...]] = {len(received_bytes): ()}
    for start in reversed(range(len(received_bytes))):
        # A request is before its reply, even if both have the same form.
        likeliest_first = requests + replies if start == 0 else replies + requests
        for placed_layout in likeliest_first:
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


def _valid_frame(
    device: Device, interface: str, placed_layout: PlacedLayout, received_bytes: bytes
) -> ExchangedFrame | None:
    """Return the bytes as a frame with this layout, or None if it is not valid, or has no expected bits."""
    frame_number = number_from_bytes(placed_layout.layout, received_bytes)
    usual_values = usual_values_of(device, interface, placed_layout.layout)
    evidence = _expected_bits(device, placed_layout, frame_number, usual_values)
    if not evidence or codec.decode_placed(device, placed_layout, received_bytes).problems:
        return None
    return ExchangedFrame(placed_layout=placed_layout, data=received_bytes, evidence=evidence)


def echo_hypotheses(device: Device, variant: Variant, placed_layout: PlacedLayout, frame: int) -> Iterator[Hypothesis]:
    """Yield the hypothesis that a word of SPI is the request that the master sent, if it equals one."""
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
    """Return the name of the request that a word of SPI from the encoder equals, or ""."""
    request_and_evidence = _echoed_request(device, variant, placed_layout, frame)
    if request_and_evidence is None:
        return ""
    request, _ = request_and_evidence
    return request.name


def _echoed_request(
    device: Device, variant: Variant, placed_layout: PlacedLayout, frame: int
) -> tuple[PlacedLayout, int] | None:
    """Return the request of SPI that a word equals, with the most expected bits and their number.

    The result is None if no request has the length of the word and at least 12 expected bits.
    """
    if variant.interface != Spi.name or placed_layout.layout.sender != "encoder" or frame >> placed_layout.bits:
        return None
    # Bits that also occur in a reply are not evidence of an echo, such as the command on a shared line.
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
    # A candidate is a request with its number of expected bits.
    sure_candidates = [candidate for candidate in candidates if candidate[1] >= LEAST_BITS_OF_ECHO]
    return max(sure_candidates, key=lambda candidate: candidate[1], default=None)


def usual_values_of(device: Device, interface: str, layout: Layout) -> dict[str, list[int]]:
    """Return the values that fields of a frame usually have: ``{"address": [0x15]}``.

    These are their defaults in any frame, since a reply repeats the address in the request. In a request over SPI, they
    are also the addresses of registers, and the documented content of unused fields.
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
    """Return the number of bits in a valid frame that have the expected value.

    These bits are the CRC, the constants, and fields with one of their usual values. A field that may have one of 4
    values has 2 free bits, which do not count.
    """
    crc = device.crc_of(placed_layout)
    constant_bits, _ = check_constant_bits(placed_layout, frame)
    usual_bits = 0
    for placed_field in placed_layout.fields:
        values = usual_values.get(placed_field.name, ())
        raw_value = (frame >> placed_field.low) & placed_field.mask
        if raw_value in values:
            # The bits that are needed to number the usual values: 2 for 3 or 4 values, 0 for a single value.
            free_bits = (len(values) - 1).bit_length()
            usual_bits += placed_field.width - free_bits
    crc_bits = crc.width if crc is not None else 0
    return constant_bits + usual_bits + crc_bits
