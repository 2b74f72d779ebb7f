"""Explain a CRC error in a frame with several data channels: by extra bits around it, or by a different order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations

from ..model import Device, PlacedChannels
from ..reference.codec import decode_channels
from ..say import frame_texts

#: Fewest bits that the CRCs of all channels need together. Of 65,536 random frames, one has valid CRCs by chance.
LEAST_CRC_BITS = 16


def channel_readings(device: Device, frame: PlacedChannels, number: int, bits: int) -> Iterator[str]:
    """Yield a text for each way to read ``bits`` received bits so that the CRCs of all channels are correct.

    The frame may have extra bits around it, or its channels may be in a different order. Nothing is yielded if the CRCs
    are so short that they would often be correct by chance.
    """
    crc_bits = sum(channel.crc_field.width for channel in frame.channels if channel.crc_field is not None)
    if crc_bits < LEAST_CRC_BITS:
        return
    yield from _readings_with_bits_around(device, frame, number, bits)
    if bits == frame.bits:
        yield from _readings_in_other_order(device, frame, number)


def _readings_with_bits_around(device: Device, frame: PlacedChannels, number: int, bits: int) -> Iterator[str]:
    """Yield a text for each place among the received bits at which all CRCs of the frame are correct.

    Nothing is yielded if there are no extra bits.
    """
    extra_bits = bits - frame.bits
    if extra_bits <= 0:
        return
    for bits_before in range(extra_bits + 1):
        bits_after = extra_bits - bits_before
        frame_bits = (number >> bits_after) & ((1 << frame.bits) - 1)
        if _is_valid_frame(device, frame, frame_bits):
            yield frame_texts.bits_around(f"{bits_before}", f"{bits_after}")


def _readings_in_other_order(device: Device, frame: PlacedChannels, number: int) -> Iterator[str]:
    """Yield a text for each different order of the channels with which all CRCs are correct."""
    for channels in permutations(frame.channels):
        other_frame = replace(frame, channels=channels)
        if channels != frame.channels and _is_valid_frame(device, other_frame, number):
            yield frame_texts.other_order(", ".join(channel.name for channel in channels))


def _is_valid_frame(device: Device, frame: PlacedChannels, number: int) -> bool:
    """Return whether no channel of the frame ``number`` has an error."""
    return not any(decoded.problems for decoded in decode_channels(device, frame, number))
