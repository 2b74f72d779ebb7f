"""Frames that carry several data channels: each channel decoded, and the verdict of all of them together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...model import Device, Fault, PlacedChannels, Variant, channel_frame
from ...reference import codec
from ...reference.channels import ChannelFindings, channel_findings, decode_channels
from ...reference.findings import Findings
from ...say import report as say_report
from ...say.plain_text import WIDTH, count_with_unit
from ...say.text import VERDICT_CLAUSES
from ...why.hypotheses import TypedFrame
from .field_table import wrapped
from .frames import frame_number, undecorated, why_text
from .text import described_frame, evidence_lines

if TYPE_CHECKING:
    from ...why.diagnosis import Diagnosis


@dataclass(frozen=True, slots=True)
class ChannelResult:
    """A frame decoded: its channels with their findings and explanations, or a problem with its length.

    ``readings`` are the readings of the whole frame with which all CRCs are correct.
    """

    channels: tuple[codec.DecodedFrame, ...]
    findings: ChannelFindings
    whys: tuple[Diagnosis | None, ...]
    problems: tuple[codec.FrameProblem, ...]
    readings: tuple[str, ...]

    @property
    def has_problem(self) -> bool:
        """True if the frame or one of its channels has an error."""
        return bool(self.problems) or any(decoded.problems for decoded in self.channels)

    @property
    def all_problems(self) -> Iterator[codec.FrameProblem]:
        """The problem with the length, or the channels' problems, each with the name of its channel in the message."""
        yield from self.problems
        for decoded in self.channels:
            assert decoded.layout is not None
            for problem in decoded.problems:
                yield replace(problem, message=f"{decoded.layout.name}: {problem.message}")

    @property
    def all_findings(self) -> Findings:
        """The reports and differences of all channels, with the verdict of the whole frame."""
        reports = tuple(report for channel in self.findings.channels for report in channel.reports)
        differences = tuple(difference for channel in self.findings.channels for difference in channel.differences)
        return Findings(reports=reports, verdict=self.findings.verdict, differences=differences)

    @property
    def findings_with_verdict(self) -> Iterator[Findings]:
        """The findings in each channel, with the verdict of the whole frame where the channel has one."""
        for channel in self.findings.channels:
            yield channel if channel.verdict is None else replace(channel, verdict=self.findings.verdict)


class ChannelDecoder:
    """Decoder of the frames of one order code that carry several data channels."""

    def __init__(self, device: Device, variant: Variant, frame: PlacedChannels) -> None:
        self._device = device
        self._variant = variant
        self.frame = frame

    def read(self, frame_text: str) -> TypedFrame | None:
        """Return the frame in a text, or None if it is a single channel.

        It is one if it has all digits of a channel, in hex digits or in bytes. Fewer digits may belong to a whole frame
        without its leading zeros. Exact bits are one if they are no more than the longest channel has.

        Raises:
            FrameTextError: The text cannot be read as a number.
        """
        typed_frame = frame_number(self.frame, undecorated(frame_text), exact=True)
        channel_bits = [channel.bits for channel in self.frame.channels]
        longest = max(channel_bits)
        written_bits = {unit * -(-bits // unit) for bits in channel_bits for unit in (4, 8)}
        has_all_digits = typed_frame.written in written_bits and typed_frame.number >> longest == 0
        has_bits_of_channel = typed_frame.exact and typed_frame.bits <= longest
        return None if has_all_digits or has_bits_of_channel else typed_frame

    def decode(self, typed_frame: TypedFrame) -> ChannelResult:
        """Return the frame decoded. Its bits are the bits of all channels, in the order sent."""
        device = self._device
        frame = self.frame
        number = typed_frame.number
        bits = typed_frame.bits if typed_frame.exact else max(frame.bits, typed_frame.bits)
        problems: tuple[codec.FrameProblem, ...] = ()
        decoded_channels: tuple[codec.DecodedFrame, ...] = ()
        findings = ChannelFindings(channels=(), agree=None, verdict=None)
        if bits == frame.bits:
            decoded_channels = decode_channels(device, frame, number)
            findings = channel_findings(device, self._variant, frame, decoded_channels)
        else:
            message = report_of_length(frame, bits)
            problems = (codec.FrameProblem(Fault.LENGTH, field="", message=message),)
        result = ChannelResult(
            channels=decoded_channels,
            findings=findings,
            whys=tuple(map(self._explain_channel, decoded_channels)),
            problems=problems,
            readings=(),
        )
        if not result.has_problem:
            return result
        return replace(result, readings=self._possible_readings(number, bits))

    def _explain_channel(self, decoded: codec.DecodedFrame) -> Diagnosis | None:
        """Return the explanations of a channel with an error, or None."""
        assert decoded.layout is not None
        text = f"0b{decoded.number:0{decoded.layout.bits}b}"
        return why_text(self._device, self._variant, "encoder", text, decoded) if decoded.problems else None

    def _possible_readings(self, number: int, bits: int) -> tuple[str, ...]:
        from ...why.channels import channel_readings

        return tuple(channel_readings(self._device, self.frame, number, bits))


def channel_decoder(device: Device, variant: Variant) -> ChannelDecoder | None:
    """Return the decoder of frames with several data channels, or None if the encoder sends none."""
    frame = channel_frame(device.interface(variant.interface))
    return ChannelDecoder(device, variant, frame.place(variant.parameters)) if frame is not None else None


def report_of_length(frame: PlacedChannels, bits: int) -> str:
    """Return the message about a frame of another length."""
    channels = " and ".join(f"{channel.name} ({channel.bits} bits)" for channel in frame.channels)
    bits_off = abs(frame.bits - bits)
    verb = "is" if bits_off == 1 else "are"
    difference = f"{count_with_unit(bits_off, 'bit')} {verb} {'missing' if bits < frame.bits else 'too many'}"
    return say_report.length_of_channels(channels, f"{frame.bits} bits", f"{bits}", difference)


def described_channels(device: Device, variant: Variant, frame: PlacedChannels, result: ChannelResult) -> Iterator[str]:
    """Yield the lines about each channel, and then about all of them together."""
    channels = zip(result.channels, result.findings_with_verdict, result.whys, strict=True)
    for decoded, findings, why in channels:
        is_sent = decoded.layout is not None and decoded.layout.bits > 0
        if not is_sent:  # Some order codes do not send every channel.
            continue
        yield from described_frame(device, variant, decoded, findings, why)
        yield ""
    yield from (wrapped(line, WIDTH, prefix="  ", first="") for line in _summary_lines(frame, result))
    yield from evidence_lines(device)


def _summary_lines(frame: PlacedChannels, result: ChannelResult) -> Iterator[str]:
    """Yield the errors of the whole frame, the comparison of its positions, and its verdict."""
    for problem in result.problems:
        yield f"{problem.fault.value} error: {problem.message}"
    wrong_channels = [decoded.layout.name for decoded in result.channels if decoded.problems and decoded.layout]
    if wrong_channels:
        yield say_report.no_position(" and ".join(wrong_channels))
    for reading in result.readings:
        yield say_report.all_crcs_correct(reading)
    if result.findings.agree is not None:
        yield comparison_sentence(frame, result.channels, agree=result.findings.agree)
    if result.findings.verdict is not None:
        yield f"all channels together: {VERDICT_CLAUSES[result.findings.verdict]}"


def comparison_sentence(frame: PlacedChannels, decoded_channels: Sequence[codec.DecodedFrame], *, agree: bool) -> str:
    """Return a sentence with the compared bits of each channel, and whether they agree."""
    numbers = frame.compared_numbers([decoded.values for decoded in decoded_channels])
    compared_channels = [channel for channel in frame.channels if channel.name in frame.compared]
    # ``compared`` contains the name of the compared field by the name of its channel.
    number_texts = [
        f"{frame.compared[channel.name]} of {channel.name} {number:#x}"
        for channel, number in zip(compared_channels, numbers, strict=True)
    ]
    return say_report.compared(f"{frame.compared_bits}", " and ".join(number_texts), agree=agree)
