"""Bytes of RS-485 that are whole frames: an echo of the request, a reply after it, or several replies.

The script of the decode page follows the same rules.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..model import Device, PlacedLayout, Variant, number_from_bytes
from ..model.record import dataclass
from ..reference import codec
from .tries import Try, fixed_bits

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

    placed: PlacedLayout
    data: bytes
    evidence: int

    @property
    def is_request(self) -> bool:
        return self.placed.layout.sender == "master"

    @property
    def title(self) -> str:
        sort = "request" if self.is_request else "reply"
        return f"{sort} {self.placed.name}"


def exchange_tries(device: Device, variant: Variant, data: bytes) -> Iterator[Try]:
    """Yield the bytes as whole frames, if they are more than one frame of the encoder."""
    frames = _frames_in(device, variant, data)
    if frames is None or not frames:
        return
    is_one_reply = len(frames) == 1 and not frames[0].is_request
    if is_one_reply:
        return
    kind = _kind(frames)
    if kind == "echo":
        text = ECHO_TEXT.format(frames[0].placed.name)
    else:
        text = FRAMES_TEXT.format(", then ".join(frame.title for frame in frames))
    attempt = Try(
        kind=kind,
        text=text,
        crc=None,
        data=int.from_bytes(data, "big"),
        bits=8 * len(data),
        received=0,
        known_bits=0,
        demanded=sum(frame.evidence for frame in frames),
        parts=tuple((frame.title, frame.data.hex(" ").upper()) for frame in frames),
    )
    last = frames[-1]
    # The position is that of the last reply, unless the manual leaves open what the reply means.
    if not last.is_request and not device.alternatives_of(last.placed.layout):
        attempt = replace(attempt, number=number_from_bytes(last.placed.layout, last.data), placed=last.placed)
    yield attempt


def _kind(frames: Sequence[ExchangedFrame]) -> str:
    """Return the kind of mistake: only requests, a request before or after the reply, or several frames."""
    if all(frame.is_request for frame in frames):
        return "echo"
    replies = [frame for frame in frames if not frame.is_request]
    if len(replies) > 1:
        return "several_frames"
    return "bytes_in_front" if frames[0].is_request else "bytes_behind"


def _frames_in(device: Device, variant: Variant, data: bytes) -> tuple[ExchangedFrame, ...] | None:
    """Return the fewest valid frames that the bytes consist of, or None if there are other bytes."""
    if len(data) > MOST_BYTES:
        return None
    layouts = [layout for layout in device.interface(variant.interface).layouts if layout.in_bytes]
    candidates = [layout.place(variant.parameters) for layout in layouts]
    # The fewest frames from each byte to the end. The bytes are searched from the end, so those behind are known.
    fewest: dict[int, tuple[ExchangedFrame, ...]] = {len(data): ()}
    for start in range(len(data) - 1, -1, -1):
        # A request is in front of its reply, even if both have the same form.
        in_likely_order = sorted(candidates, key=lambda placed: (placed.layout.sender == "master") != (start == 0))
        for placed in in_likely_order:
            following = fewest.get(start + placed.bits // 8)
            if following is None:
                continue
            has_fewer_frames = start not in fewest or len(following) + 1 < len(fewest[start])
            if not has_fewer_frames:
                continue
            frame = _valid_frame(device, placed, data[start : start + placed.bits // 8])
            if frame is not None:
                fewest[start] = (frame, *following)
    return fewest.get(0)


def _valid_frame(device: Device, placed: PlacedLayout, data: bytes) -> ExchangedFrame | None:
    """Return the bytes as a frame with this layout, or None if they are not one or could be one by chance."""
    crc = device.crc_of(placed)
    crc_bits = crc.width if crc is not None else 0
    constant_bits, _ = fixed_bits(placed, 0)
    evidence = constant_bits + crc_bits
    if evidence < LEAST_EVIDENCE or codec.decode_placed(device, placed, data).problems:
        return None
    return ExchangedFrame(placed, data, evidence)
