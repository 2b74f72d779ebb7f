"""Frames that carry several data channels: their channels decoded, and the verdict of all of them together."""

from __future__ import annotations

from collections.abc import Sequence

from ..model import Device, PlacedChannels, Variant, Verdict
from ..model.record import dataclass
from . import codec
from .findings import Findings, findings


@dataclass(frozen=True, slots=True)
class ChannelFindings:
    """Findings in a frame with several data channels.

    ``agree`` is true if the fields that the manual compares between channels match. It is None if the manual compares
    none, or if a channel has an error. ``verdict`` is None if a channel has an error.
    """

    channels: tuple[Findings, ...]
    agree: bool | None
    verdict: Verdict | None


def decode_channels(device: Device, frame: PlacedChannels, number: int) -> tuple[codec.DecodedFrame, ...]:
    """Split the frame ``number`` into its data channels, decode each of them, and return the results.

    ``number`` must not have more bits than the frame.
    """
    decoded_channels = []
    for placed_layout, bits in zip(frame.channels, frame.split(number), strict=True):
        decoded_channels.append(codec.decode(device, placed_layout, bits))
    return tuple(decoded_channels)


def channel_findings(
    device: Device, variant: Variant, frame: PlacedChannels, decoded_channels: Sequence[codec.DecodedFrame]
) -> ChannelFindings:
    """Return the findings in each channel, and the verdict on the position in the whole frame.

    It is the worst verdict of all channels, or NOT_USABLE if fields that should match in all channels differ. A channel
    without the position counts only if its own verdict is known.
    """
    findings_by_channel = tuple(findings(device, variant, decoded) for decoded in decoded_channels)
    if any(decoded.problems for decoded in decoded_channels):
        return ChannelFindings(channels=findings_by_channel, agree=None, verdict=None)
    agree = None
    if frame.compared:
        agree = frame.agree([decoded.values for decoded in decoded_channels])
    verdicts = []
    if agree is False:  # None means that no fields are compared.
        verdicts.append(Verdict.NOT_USABLE)
    for placed_layout, channel in zip(frame.channels, findings_by_channel, strict=True):
        if channel.verdict is None:
            continue
        has_position = device.sends_position(variant.interface, placed_layout.layout)
        if has_position or channel.verdict is not Verdict.UNKNOWN:
            verdicts.append(channel.verdict)
    from_worst_to_best = list(Verdict)
    worst = min(verdicts, key=from_worst_to_best.index)
    return ChannelFindings(channels=findings_by_channel, agree=agree, verdict=worst)
