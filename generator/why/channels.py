"""Explain a frame with several data channels of which a CRC is wrong, by other bits around it or by another order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations

from ..model import Device, PlacedChannels
from ..reference.channels import decode_channels
from ..say import report as say_report

#: CRCs of this many bits match one of 65,536 random frames. A reading of a frame needs at least as many.
LEAST_CRC_BITS = 16


def channel_readings(device: Device, frame: PlacedChannels, number: int, bits: int) -> Iterator[str]:
    """Yield readings of ``bits`` received bits with which the CRCs of all channels are correct.

    Nothing is yielded if the CRCs have so few bits together that random frames would match.
    """
    crc_bits = sum(channel.crc_field.width for channel in frame.channels if channel.crc_field is not None)
    if crc_bits < LEAST_CRC_BITS:
        return
    yield from _readings_with_bits_around(device, frame, number, bits)
    if bits == frame.bits:
        yield from _readings_in_other_order(device, frame, number)


def _readings_with_bits_around(device: Device, frame: PlacedChannels, number: int, bits: int) -> Iterator[str]:
    """Yield each number of bits before the frame with which its CRCs are correct."""
    bits_around = bits - frame.bits
    for bits_before in range(bits_around + 1 if bits_around > 0 else 0):
        bits_after = bits_around - bits_before
        frame_bits = (number >> bits_after) & ((1 << frame.bits) - 1)
        if _is_valid_frame(device, frame, frame_bits):
            yield say_report.bits_around(f"{bits_before}", f"{bits_after}")


def _readings_in_other_order(device: Device, frame: PlacedChannels, number: int) -> Iterator[str]:
    """Yield each other order of the channels with which their CRCs are correct."""
    for channels in permutations(frame.channels):
        other_frame = replace(frame, channels=channels)
        if channels != frame.channels and _is_valid_frame(device, other_frame, number):
            yield say_report.other_order(", ".join(channel.name for channel in channels))


def _is_valid_frame(device: Device, frame: PlacedChannels, number: int) -> bool:
    return not any(decoded.problems for decoded in decode_channels(device, frame, number))
