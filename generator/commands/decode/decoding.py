"""Decode one or many frames, print them as text or as JSON, and return their common exit code."""

from __future__ import annotations

import json
import sys
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from ...model import Device, Flag, PlacedLayout, Verdict
from ...order_codes.labels import LabelMatch
from ...order_codes.parameters import RegisterError
from ...reference import codec
from ...reference.findings import Findings, ValueDifference, findings
from ...reference.registers import values_of_older_edition
from ...why import LEAST_FAILED, MOST_FRAMES
from ..find_encoder import UndecidedError, refuse_undecided
from .channel_frames import ChannelDecoder, channel_decoder, described_channels
from .explanations import (
    OtherFrames,
    frame_of_other_code,
    is_frame_of_other_kind,
    other_frames_line,
    why_text,
    why_valid_text,
)
from .frames import FrameLine, FrameTextError, decode_register_text, text_decoder
from .plain_data import channel_data, decoded_data
from .several_frames import frame_sizes, separate_frames
from .text import explain, heading, label_lines, line_prefix, together_lines

if TYPE_CHECKING:
    from ...why.diagnosis import Diagnosis
    from ...why.hypotheses import TypedFrame
    from ...why.together import CommonMistake

DONE, FAULT, NO_FRAME, NOT_USABLE = 0, 1, 2, 3
#: Exit codes, most severe first. With several frames, the worst one decides the exit code.
_WORST_FIRST = (NO_FRAME, FAULT, NOT_USABLE)
#: Number of frames after which a message names the command for many frames.
MANY = 10_000
_SINGLE_LINE_JSON = json.JSONEncoder(ensure_ascii=False)


@dataclass(frozen=True, slots=True)
class DecodeRequest:
    """An encoder and the options for decoding a value of ``register``, or a frame if that is None."""

    device: Device
    match: LabelMatch
    sender: str
    layout: str | None
    register: str | None
    as_json: bool
    #: Values of ``--register`` that contradict the order code in registers that identify the encoder.
    register_differences: tuple[ValueDifference, ...]
    #: The user's answers to questions that the manual leaves open, by the names of the alternatives.
    answers: Mapping[str, str]


class _ExplainedFrame(NamedTuple):
    """Text of a frame, the decoded frame, and possible explanations of its error or of a dead line, or None."""

    text: str
    decoded: codec.DecodedFrame
    diagnosis: Diagnosis | None


class Decoding:
    """Decoder of one frame after another. ``code`` is the exit code so far."""

    def __init__(self, request: DecodeRequest) -> None:
        """Prepare to decode frames or register values.

        If the user names neither a layout nor a register, a frame with an error is also decoded with other layouts.
        """
        self._request = request
        device = request.device
        variant = request.match.variant
        sender = request.sender
        self._decode_frame = text_decoder(device, variant, sender, request.layout)
        has_known_layout = request.layout is not None or request.register is not None
        self._other_frames = None if has_known_layout else OtherFrames(device, variant, sender)
        has_channels = sender == "encoder" and not has_known_layout
        self._channels = channel_decoder(device, variant) if has_channels else None
        self._frame_sizes = frame_sizes(device, variant, sender) if request.register is None else ()
        self._label = tuple(label_lines(device, request.match))
        #: The layouts whose questions are answered, and the answers that each layout needs, by name.
        self._decided_layouts: set[str] = set()
        self._needed_answers: dict[str, dict[str, str]] = {}
        self._codes = {FAULT} if request.register_differences else set()
        self._is_first = True
        #: The last frames with an error.
        self._failed_frames: deque[_ExplainedFrame] = deque(maxlen=MOST_FRAMES)
        #: The last frames, valid ones included.
        self._last_frames: deque[_ExplainedFrame] = deque(maxlen=MOST_FRAMES)

    @property
    def code(self) -> int:
        """The worst exit code of the frames so far."""
        for code in _WORST_FIRST:
            if code in self._codes:
                return code
        return DONE

    def _run_line(self, line: FrameLine) -> None:
        """Decode and print one frame, and keep it for the mistakes that several frames have in common.

        Raises:
            FrameTextError: The text is not a frame.
            RegisterError: The text is not the value of a register.
            UndecidedError: The frame depends on a question that the manual leaves open.
        """
        channel_frame = self._channels.read(line.text) if self._channels is not None else None
        if self._channels is not None and channel_frame is not None:
            self._print_channels(line, self._channels, channel_frame)
            return
        decoded, why = self._decode_text(line.text)
        frame_findings = self._findings_of_frame(decoded)
        self._codes.add(_exit_code(decoded, frame_findings))
        other_layouts = self._other_layouts(line.text, decoded)
        other_code = ""
        if is_frame_of_other_kind(decoded, other_layouts, why):
            # The frame is valid with the other layout, so there is no mistake to explain.
            other_code = frame_of_other_code(why)
            why = None
        frame = _ExplainedFrame(text=line.text, decoded=decoded, diagnosis=why)
        self._last_frames.append(frame)
        if why is not None and decoded.problems:
            self._failed_frames.append(frame)
        output = self._frame_output(line, decoded, frame_findings, why, other_layouts, other_code)
        # With many frames, the user should not have to wait for the last one.
        is_one_of_many = line.number is not None
        print(output, flush=is_one_of_many)

    def run(self, lines: Iterable[FrameLine]) -> None:
        """Decode and print each frame, and then print mistakes that explain several frames with an error.

        Text that cannot be decoded is reported on standard error, and does not prevent decoding the next line. After
        each line, ``code`` is the exit code so far.
        """
        for frames_before, line in enumerate(separate_frames(lines, self._frame_sizes)):
            if frames_before == MANY and self._request.register is None:
                self._suggest_package()
            try:
                self._run_line(line)
            except (FrameTextError, RegisterError, UndecidedError) as error:
                self._codes.add(NO_FRAME)
                place_of_error = f"line {line.number}: " if line.number is not None else ""
                print(f"codewheel: {place_of_error}{error}", file=sys.stderr)
        if not self._request.as_json:
            mistakes, failed_count, are_in_all_frames = self.judge_frames()
            together = together_lines(mistakes, failed_count, with_valid_frames=are_in_all_frames)
            print(*together, sep="\n", end="")

    def judge_frames(self) -> tuple[list[CommonMistake], int, bool]:
        """Return mistakes in the frames so far, likeliest first, the number of failed frames, and if they are in all.

        The mistakes explain most of the last frames that failed, or all of the last frames, valid ones too.
        """
        mistakes_in_all = self._mistakes_in_all_frames()
        mistakes = mistakes_in_all or self._common_mistakes()
        return mistakes, len(self._failed_frames), bool(mistakes_in_all)

    def _print_channels(self, line: FrameLine, decoder: ChannelDecoder, frame: TypedFrame) -> None:
        """Print a frame that carries all data channels, as text or as JSON."""
        request = self._request
        result = decoder.decode(frame)
        variant = request.match.variant
        if result.has_problem:
            self._codes.add(FAULT)
        else:
            is_not_usable = result.findings.verdict is Verdict.NOT_USABLE
            self._codes.add(NOT_USABLE if is_not_usable else DONE)
        is_one_of_many = line.number is not None
        if request.as_json:
            data = channel_data(request.device, variant, sender=request.sender, result=result, line=line)
            output = _json_text(data, is_one_of_many=is_one_of_many)
        else:
            title = heading(request.device, variant, request.sender, placed_layout=None)
            lines = [f"{line_prefix(line)}{title}", *self._label]
            lines += described_channels(request.device, variant, decoder.frame, result)
            output = self._blank_line() + "\n".join(lines)
        print(output, flush=is_one_of_many)

    def _blank_line(self) -> str:
        """Return the blank line in front of the text of each frame except the first."""
        blank_line = "" if self._is_first else "\n"
        self._is_first = False
        return blank_line

    def _suggest_package(self) -> None:
        """Print a notice that the Python package decodes a file with many frames faster."""
        command = f"{self._request.device.manufacturer.distribution} decode"
        notice = f"{MANY:,} frames; for files, the Python package is faster: {command}"
        print(f"codewheel: {notice}", file=sys.stderr)

    def _mistakes_in_all_frames(self) -> list[CommonMistake]:
        """Return mistakes that explain all of the last frames, the valid ones too, the likeliest first.

        The list is empty unless some frames are valid and the only check is a parity bit, which half of all shifted
        frames pass. If fewer than a quarter of the frames fail, noise is likelier.
        """
        frames = self._last_frames
        failed_count = sum(bool(frame.decoded.problems) for frame in frames)
        have_enough_failed = failed_count * LEAST_FAILED >= len(frames)
        if not have_enough_failed or failed_count == len(frames):
            return []
        from ...why.hypotheses import has_only_parity
        from ...why.together import judge_together

        request = self._request
        diagnoses: list[Diagnosis] = []
        for text, decoded, diagnosis in frames:
            if decoded.layout is None or decoded.layout.layout.in_bytes or not has_only_parity(decoded.layout):
                return []
            why = diagnosis
            if why is None and not decoded.problems:
                why = why_valid_text(request.device, request.match.variant, request.sender, text, decoded.layout)
            if why is not None:
                diagnoses.append(why)
        mistakes = judge_together(diagnoses)
        return mistakes if mistakes and mistakes[0].frames == len(frames) else []

    def _common_mistakes(self) -> list[CommonMistake]:
        """Return mistakes that explain most of the last frames with an error, the likeliest first.

        With only one such frame, the list is empty. If no single mistake explains all of them, or if the likeliest
        hides a shift by one bit, pairs of mistakes are tried too.
        """
        failed_frames = self._failed_frames
        if len(failed_frames) < 2:
            return []
        from ...why.together import judge_together

        diagnoses = [failed_frame.diagnosis for failed_frame in failed_frames]
        mistakes = judge_together([diagnosis for diagnosis in diagnoses if diagnosis is not None])
        if mistakes:
            # It explains the most frames.
            likeliest_mistake = mistakes[0]
            explains_all = likeliest_mistake.frames == len(failed_frames)
            if explains_all and not likeliest_mistake.hides_shift:
                return mistakes
        diagnoses_with_pairs = []
        for failed_frame in failed_frames:
            diagnosis = self._diagnose(failed_frame.text, failed_frame.decoded, with_pairs=True)
            if diagnosis is not None:
                diagnoses_with_pairs.append(diagnosis)
        return judge_together(diagnoses_with_pairs)

    def _diagnose(self, frame_text: str, decoded: codec.DecodedFrame, *, with_pairs: bool = False) -> Diagnosis | None:
        """Return possible explanations of a frame with an error, including pairs of mistakes if ``with_pairs``."""
        request = self._request
        return why_text(
            request.device, request.match.variant, request.sender, frame_text, decoded, with_pairs=with_pairs
        )

    def _decode_text(self, frame_text: str) -> tuple[codec.DecodedFrame, Diagnosis | None]:
        """Decode a frame or a register value, and explain its error.

        The explanations are None for a frame without an error and for a register value.

        Raises:
            FrameTextError: The text cannot be read as a frame.
            RegisterError: There is no such register, or it has a different length.
            UndecidedError: The layout of the frame depends on a question that the user has not answered.
        """
        device = self._request.device
        variant = self._request.match.variant
        if self._request.register is not None:
            decoded = decode_register_text(device, variant, self._request.register, frame_text)
            self._require_answers(decoded)
            return decoded, None
        decoded = self._decode_frame(frame_text)
        self._require_answers(decoded)
        return decoded, self._diagnose(frame_text, decoded)

    def _require_answers(self, decoded: codec.DecodedFrame) -> None:
        """Raise ``UndecidedError`` if the layout of a frame depends on a question that the user has not answered.

        Each layout is only checked once.
        """
        placed = decoded.layout
        if placed is None or placed.name in self._decided_layouts:
            return
        # Bytes of the wrong length have no fields, so answers do not matter. The length of a bit frame may itself
        # depend on the answers.
        if decoded.fields or not placed.layout.in_bytes:
            refuse_undecided(self._request.device, placed.layout, self._request.answers)
            self._decided_layouts.add(placed.name)

    def _findings_of_frame(self, decoded: codec.DecodedFrame) -> Findings:
        """Return the verdict on a decoded frame, the reports in it, and all values that differ from the manual.

        The values are, in this order: values of ``--register`` that contradict the order code, values in the frame that
        the manual does not allow, and register values that are impossible in this edition of the manual.
        """
        request = self._request
        frame_findings = findings(request.device, request.match.variant, decoded)
        edition_differences = tuple(values_of_older_edition(request.device, decoded))
        if not edition_differences and not request.register_differences:
            return frame_findings
        differences = (*request.register_differences, *frame_findings.differences, *edition_differences)
        return replace(frame_findings, differences=differences)

    def _other_layouts(self, frame_text: str, decoded: codec.DecodedFrame) -> Sequence[PlacedLayout]:
        """Return the other layouts with which the text is a valid frame, unless the user named the layout."""
        if self._other_frames is None:
            return ()
        return self._other_frames.layouts_of(frame_text, decoded)

    def _answers_used(self, decoded: codec.DecodedFrame) -> dict[str, str]:
        """Return the answers that the result for a frame depends on, as ``{question: answer}``.

        These are answers that determine the places of its fields, and answers or their defaults that decide its
        verdict.
        """
        if decoded.layout is None:
            return {}
        return self._answers_for(decoded.layout) | self._decisive_answers(decoded)

    def _answers_for(self, placed_layout: PlacedLayout) -> dict[str, str]:
        """Return the user's answers that the places of a layout's fields depend on, as ``{question: answer}``.

        They are the same for each frame of the layout, so they are only determined once.
        """
        if placed_layout.name not in self._needed_answers:
            needed_answers: dict[str, str] = {}
            for alternative in self._request.device.alternatives_of(placed_layout.layout):
                if alternative.name in self._request.answers:
                    needed_answers[alternative.name] = self._request.answers[alternative.name]
            self._needed_answers[placed_layout.name] = needed_answers
        return self._needed_answers[placed_layout.name]

    def _decisive_answers(self, decoded: codec.DecodedFrame) -> dict[str, str]:
        """Return the answers, or their defaults, that decide the verdict of an active flag of the frame.

        The result is empty for a frame with an error, which has no verdict.
        """
        if decoded.problems or decoded.layout is None:
            return {}
        verdict_parameters: set[str] = set()
        for placed_field in decoded.layout.fields:
            is_active = decoded.values.get(placed_field.name) is True
            if is_active and isinstance(placed_field.field.kind, Flag):
                verdict_parameters.add(placed_field.field.kind.verdict_parameter)
        decisive_answers: dict[str, str] = {}
        for alternative in self._request.device.optional_alternatives:
            if alternative.parameter in verdict_parameters:
                answer = self._request.answers.get(alternative.name, alternative.default)
                decisive_answers[alternative.name] = answer
        return decisive_answers

    def _frame_output(
        self,
        line: FrameLine,
        decoded: codec.DecodedFrame,
        frame_findings: Findings,
        diagnosis: Diagnosis | None,
        other_layouts: Sequence[PlacedLayout],
        other_code: str,
    ) -> str:
        """Return a decoded frame as text or as JSON.

        A blank line precedes the text of each frame except the first. With many frames, the JSON of each is one line.
        """
        request = self._request
        answers = self._answers_used(decoded)
        if request.as_json:
            data = decoded_data(
                request.device,
                request.match.variant,
                sender=request.sender,
                decoded=decoded,
                frame_findings=frame_findings,
                diagnosis=diagnosis,
                line=line,
                answers=answers,
                other_layouts=other_layouts,
            )
            return _json_text(data, is_one_of_many=line.number is not None)
        return self._blank_line() + explain(
            request.device,
            request.match,
            request.sender,
            decoded,
            findings=frame_findings,
            diagnosis=diagnosis,
            line=line,
            answers=answers,
            label=self._label,
            other_frames=other_frames_line(decoded, other_layouts, diagnosis, other_code),
        )


def _json_text(data: Mapping[str, Any], *, is_one_of_many: bool) -> str:
    """Return the data of a frame as JSON: on one line if it is one of many frames."""
    if is_one_of_many:
        return _SINGLE_LINE_JSON.encode(data)
    return json.dumps(data, indent=2, ensure_ascii=False)


def _exit_code(decoded: codec.DecodedFrame, frame_findings: Findings) -> int:
    """Return the exit code for one frame: 1 for an error, 3 if the position is not usable, and otherwise 0.

    A register value that contradicts the order code is an error.
    """
    if decoded.problems or any(difference.is_register for difference in frame_findings.differences):
        return FAULT
    return NOT_USABLE if frame_findings.verdict is Verdict.NOT_USABLE else DONE
