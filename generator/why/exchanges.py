"""Bytes of RS-485 that are whole frames: an echo of the request, a reply after it, or several replies.

The script of the decode page follows the same rules.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..model import Device, PlacedLayout, Variant, number_from_bytes
from ..model.record import dataclass
from ..reference import codec
from .hypotheses import Hypothesis, check_constant_bits

#: More bytes than this are not searched for frames.
MOST_BYTES = 64
#: A frame with fewer known bits may be any bytes.
LEAST_EVIDENCE = 3
ECHO_TEXT = (
    "these bytes are only your own request {0}: the receiver is on while sending, wires A and B are swapped, or the "
    "encoder does not answer"
)
FRAMES_TEXT = "the bytes are whole frames: {0}"


@dataclass(frozen=True, slots=True)
class ExchangedFrame:
    """A valid frame among the bytes. ``evidence`` is the number of its bits that can only have one value."""

    placed_layout: PlacedLayout
    data: bytes
    evidence: int

    @property
    def is_request(self) -> bool:
        return self.placed_layout.layout.sender == "master"

    @property
    def title(self) -> str:
        kind = "request" if self.is_request else "reply"
        return f"{kind} {self.placed_layout.name}"


def exchange_hypotheses(device: Device, variant: Variant, data: bytes) -> Iterator[Hypothesis]:
    """Yield one hypothesis that the bytes are whole frames, unless they are only one reply or no whole frames.

    Its frame is the last reply, unless the manual leaves open what that means.
    """
    frames = _frames_in(device, variant, data)
    if frames is None or not frames:
        return
    is_one_reply = len(frames) == 1 and not frames[0].is_request
    if is_one_reply:
        return
    mistake_kind = _mistake_kind(frames)
    if mistake_kind == "echo":
        description = ECHO_TEXT.format(frames[0].placed_layout.name)
    else:
        titles = ", then ".join(frame.title for frame in frames)
        description = FRAMES_TEXT.format(titles)
    hypothesis = Hypothesis(
        kind=mistake_kind,
        description=description,
        crc=None,
        covered_data=int.from_bytes(data, "big"),
        covered_bits=8 * len(data),
        received_crc=0,
        received_crc_bits=0,
        determined_bits=sum(frame.evidence for frame in frames),
        recording_parts=tuple((frame.title, frame.data.hex(" ").upper()) for frame in frames),
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
    return "bytes_in_front" if frames[0].is_request else "bytes_behind"


def _frames_in(device: Device, variant: Variant, data: bytes) -> tuple[ExchangedFrame, ...] | None:
    """Return the fewest valid frames that the bytes consist of, in order, or None if other bytes remain.

    ``()`` is the result for no bytes. More than 64 bytes are not searched.
    """
    if len(data) > MOST_BYTES:
        return None
    byte_layouts = [layout for layout in device.interface(variant.interface).layouts if layout.in_bytes]
    placed_layouts = [layout.place(variant.parameters) for layout in byte_layouts]
    requests = [placed_layout for placed_layout in placed_layouts if placed_layout.layout.sender == "master"]
    replies = [placed_layout for placed_layout in placed_layouts if placed_layout.layout.sender != "master"]
    # The fewest frames from each byte to the end, by the index of the byte. It is filled from the end, so the frames
    # behind a byte are known.
    fewest_frames_from: dict[int, tuple[ExchangedFrame, ...]] = {len(data): ()}
    for start in reversed(range(len(data))):
        # A request is in front of its reply, even if both have the same form.
        likeliest_first = requests + replies if start == 0 else replies + requests
        for placed_layout in likeliest_first:
            end = start + placed_layout.bits // 8
            if end not in fewest_frames_from:
                continue
            following_frames = fewest_frames_from[end]
            has_fewer_frames = start not in fewest_frames_from or len(following_frames) + 1 < len(
                fewest_frames_from[start]
            )
            if not has_fewer_frames:
                continue
            frame = _valid_frame(device, placed_layout, data[start:end])
            if frame is not None:
                fewest_frames_from[start] = (frame, *following_frames)
    return fewest_frames_from.get(0)


def _valid_frame(device: Device, placed_layout: PlacedLayout, data: bytes) -> ExchangedFrame | None:
    """Return the bytes as a frame with this layout, or None if it is not valid, or has fewer than 3 known bits.

    Known bits are those of the CRC and the constants.
    """
    crc = device.crc_of(placed_layout)
    crc_bits = crc.width if crc is not None else 0
    constant_bits, _ = check_constant_bits(placed_layout, 0)
    evidence = constant_bits + crc_bits
    if evidence < LEAST_EVIDENCE or codec.decode_placed(device, placed_layout, data).problems:
        return None
    return ExchangedFrame(placed_layout=placed_layout, data=data, evidence=evidence)
