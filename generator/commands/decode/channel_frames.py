"""Frames that carry several data channels: decode each channel, and judge all channels together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING

from ...model import Device, Fault, PlacedChannels, Variant, channel_frame
from ...reference import codec
from ...reference.codec import decode_channels
from ...reference.findings import ChannelFindings, Findings, channel_findings
from ...say import WIDTH, count_with_unit, frame_texts
from ...say.text import VERDICT_CLAUSES
from ...why.hypotheses import TypedFrame
from .explanations import why_text
from .field_table import wrapped
from .frames import frame_number, undecorated
from .text import described_frame, evidence_lines

if TYPE_CHECKING:
    from ...why.diagnosis import Diagnosis


@dataclass(frozen=True, slots=True)
class ChannelResult:
    """A decoded frame: its channels with their findings and explanations, or a problem with its length.

    ``readings`` are other ways to read the whole frame with which all CRCs are correct.
    """

    channels: tuple[codec.DecodedFrame, ...]
    findings: ChannelFindings
    whys: tuple[Diagnosis | None, ...]
    problems: tuple[codec.FrameProblem, ...]
    readings: tuple[str, ...]

    @property
    def has_problem(self) -> bool:
        """Whether the frame or one of its channels has an error."""
        return bool(self.problems) or any(decoded.problems for decoded in self.channels)

    @property
    def all_problems(self) -> Iterator[codec.FrameProblem]:
        """The problem with the length, or the problems of the channels, with the channel's name in each message."""
        yield from self.problems
        for decoded in self.channels:
            assert decoded.layout is not None
            for problem in decoded.problems:
                yield replace(problem, message=f"{decoded.layout.name}: {problem.message}")

    @property
    def all_findings(self) -> Findings:
        """The reports and differences of all channels, with the verdict of the whole frame."""
        channels = self.findings.channels
        reports = tuple(chain.from_iterable(channel.reports for channel in channels))
        differences = tuple(chain.from_iterable(channel.differences for channel in channels))
        return Findings(reports=reports, verdict=self.findings.verdict, differences=differences)

    @property
    def findings_with_verdict(self) -> Iterator[Findings]:
        """The findings in each channel. If a channel has a verdict, it is replaced by that of the whole frame."""
        for channel in self.findings.channels:
            has_verdict = channel.verdict is not None
            yield replace(channel, verdict=self.findings.verdict) if has_verdict else channel


class ChannelDecoder:
    """Decoder of the frames of one order code that carry several data channels."""

    def __init__(self, device: Device, variant: Variant, frame: PlacedChannels) -> None:
        self._device = device
        self._variant = variant
        self.frame = frame

    def read(self, frame_text: str) -> TypedFrame | None:
        """Return the frame with all data channels in a text, or None if the text is a single channel.

        A text is a single channel if it has exactly the digits of a channel, in hex digits or in bytes. Fewer digits
        may be a whole frame without its leading zeros. Binary digits are a single channel if there are not more of them
        than the longest channel has bits.

        Raises:
            FrameTextError: The text cannot be read as a number.
        """
        typed_frame = frame_number(self.frame, undecorated(frame_text), exact=True)
        channel_lengths = [channel.bits for channel in self.frame.channels]
        longest = max(channel_lengths)
        # The bits that a channel has when written in whole hex digits or in whole bytes.
        written_lengths: set[int] = set()
        for length in channel_lengths:
            number_of_hex_digits = (length + 3) // 4
            number_of_bytes = (length + 7) // 8
            written_lengths |= {4 * number_of_hex_digits, 8 * number_of_bytes}
        fits_into_channel = typed_frame.number < 1 << longest
        has_digits_of_channel = typed_frame.digit_bits in written_lengths and fits_into_channel
        has_bits_of_channel = typed_frame.is_length_known and typed_frame.bits <= longest
        return None if has_digits_of_channel or has_bits_of_channel else typed_frame

    def decode(self, typed_frame: TypedFrame) -> ChannelResult:
        """Decode a frame, which consists of the bits of all channels in transmission order."""
        device, frame, number = self._device, self.frame, typed_frame.number
        problems: tuple[codec.FrameProblem, ...] = ()
        decoded_channels: tuple[codec.DecodedFrame, ...] = ()
        findings = ChannelFindings(channels=(), agree=None, verdict=None)
        # Without an exact number of bits, leading zeros may be missing.
        length = typed_frame.bits if typed_frame.is_length_known else max(frame.bits, typed_frame.bits)
        if length == frame.bits:
            decoded_channels = decode_channels(device, frame, number)
            findings = channel_findings(device, self._variant, frame, decoded_channels)
        else:
            message = report_of_length(frame, length)
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
        return replace(result, readings=self._possible_readings(number, length))

    def _explain_channel(self, decoded: codec.DecodedFrame) -> Diagnosis | None:
        """Return the possible explanations of an error in a channel, or None if it has no error."""
        if not decoded.problems:
            return None
        assert decoded.layout is not None
        binary_text = f"0b{decoded.number:0{decoded.layout.bits}b}"
        return why_text(self._device, self._variant, sender="encoder", frame_text=binary_text, decoded=decoded)

    def _possible_readings(self, number: int, bits: int) -> tuple[str, ...]:
        """Return other ways to read the whole frame with which all CRCs are correct."""
        from ...why.explain import channel_readings

        return tuple(channel_readings(self._device, self.frame, number, bits))


def channel_decoder(device: Device, variant: Variant) -> ChannelDecoder | None:
    """Return the decoder for frames with several data channels, or None if the encoder does not send such frames."""
    frame = channel_frame(device.interface(variant.interface))
    if frame is None:
        return None
    return ChannelDecoder(device, variant, frame.place(variant.parameters))


def report_of_length(frame: PlacedChannels, bits: int) -> str:
    """Return the message about a frame of the wrong length, which has ``bits`` bits."""
    names_and_lengths = " and ".join(f"{channel.name} ({channel.bits} bits)" for channel in frame.channels)
    number_of_wrong_bits = abs(frame.bits - bits)
    verb = "is" if number_of_wrong_bits == 1 else "are"
    state = "missing" if bits < frame.bits else "too many"
    difference = f"{count_with_unit(number_of_wrong_bits, 'bit')} {verb} {state}"
    return frame_texts.wrong_length_of_channels_message(
        names_and_lengths, needed=f"{frame.bits} bits", actual=f"{bits}", difference=difference
    )


def described_channels(device: Device, variant: Variant, frame: PlacedChannels, result: ChannelResult) -> Iterator[str]:
    """Yield the lines about each channel of a frame, and then about all of them together."""
    channels = zip(result.channels, result.findings_with_verdict, result.whys, strict=True)
    for decoded, findings, diagnosis in channels:
        # An order code may not send every channel.
        is_sent = decoded.layout is not None and decoded.layout.bits > 0
        if is_sent:
            yield from described_frame(device, variant, decoded, findings=findings, diagnosis=diagnosis)
            yield ""
    yield from (wrapped(line, WIDTH, prefix="  ", first="") for line in _summary_lines(frame, result))
    yield from evidence_lines(device)


def _summary_lines(frame: PlacedChannels, result: ChannelResult) -> Iterator[str]:
    """Yield the errors of the whole frame, the comparison of its positions, and its verdict."""
    for problem in result.problems:
        yield f"{problem.fault.value} error: {problem.message}"
    wrong_channels = [decoded.layout.name for decoded in result.channels if decoded.problems and decoded.layout]
    if wrong_channels:
        yield frame_texts.no_position_note(" and ".join(wrong_channels))
    for reading in result.readings:
        yield frame_texts.all_crcs_correct(reading)
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
    return frame_texts.compared_bits_note(f"{frame.compared_bits}", " and ".join(number_texts), agree=agree)
