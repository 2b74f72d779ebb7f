"""The order code and the frame in the link from the README to the page."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ...model import Device, number_to_bytes


class LinkedFrame(NamedTuple):
    """A valid frame as text, with its order code. The frame is empty if no encoder has a sample of a frame."""

    order_code: str
    frame: str


def linked_frame(devices: Iterable[Device]) -> LinkedFrame:
    """Return the first sample of a frame from an encoder, or the first order code without a frame if there is none."""
    families = list(devices)
    order_codes = [variant.code for device in families for variant in device.variants]
    first_code = order_codes[0] if order_codes else ""
    return next(_sample_frames(families), LinkedFrame(first_code, frame=""))


def _sample_frames(devices: Iterable[Device]) -> Iterator[LinkedFrame]:
    """Yield the samples of frames that encoders send, with all leading zeros, which data channels need."""
    for device in devices:
        for sample in device.samples:
            layout = device.layout(sample.layout)
            if layout.sender != "encoder":
                continue
            bits = layout.place(device.variant(sample.order_code).parameters).bits
            if layout.in_bytes:
                text = number_to_bytes(layout, sample.frame, bits).hex().upper()
            else:
                # A hexadecimal digit for each 4 bits, rounded up.
                digits = (bits + 3) // 4
                text = f"0x{sample.frame:0{digits}X}"
            yield LinkedFrame(sample.order_code, text)
