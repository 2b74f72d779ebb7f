"""``codewheel decode`` for one or many frames: the text printed for each, and the common exit code."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TextIO

from ..model import Device, Flag, PlacedLayout, Verdict
from ..order_codes.labels import Match
from ..order_codes.run_time import RegisterError
from ..reference import codec
from ..reference.editions import strange_values
from ..reference.findings import Difference, Findings, findings
from .choose import UndecidedError, refuse_undecided
from .decode import decode_register_text, decoded_data, explain, label_lines, text_decoder, why_text
from .frame_text import FrameTextError, Line, frame_lines
from .other_frames import OtherFrames, is_another, other_frames_line

if TYPE_CHECKING:
    from ..why.mistakes import Why

DONE, FAULT, NO_FRAME, NOT_USABLE = 0, 1, 2, 3
#: Exit codes, most severe first. With several frames, the exit code is that of the worst one.
_WORST_FIRST = (NO_FRAME, FAULT, NOT_USABLE)
#: Number of frames after which a message names the command for many frames.
MANY = 10_000
#: Characters of a line that are kept in memory.
_LONGEST_LINE = 1 << 16
_ONE_LINE = json.JSONEncoder(ensure_ascii=False)


@dataclass(frozen=True, slots=True)
class Request:
    """Options for decoding the value of ``register`` if that is set, else a frame."""

    device: Device
    match: Match
    sender: str
    layout: str | None
    register: str | None
    as_json: bool
    #: Values of ``--register`` that contradict the order code in registers that identify the encoder.
    others: tuple[Difference, ...]
    #: The user's answers to questions that the manual leaves open, by the names of the alternatives.
    answers: Mapping[str, str]


def frames(arguments: Sequence[str]) -> Iterator[Line]:
    """Yield the frames in the arguments, or for ``-`` those on standard input, one per line."""
    if list(arguments) == ["-"]:
        if isinstance(sys.stdin, io.TextIOWrapper):
            sys.stdin.reconfigure(errors="replace")
        yield from frame_lines(_bounded(sys.stdin))
        return
    text = " ".join(arguments)
    parsed_lines = list(frame_lines(text.splitlines()))
    if len(parsed_lines) == 1:
        yield parsed_lines[0]._replace(number=None)
    yield from parsed_lines if len(parsed_lines) != 1 else ()
    if not parsed_lines:
        yield Line(None, "", text)


def _bounded(file: TextIO) -> Iterator[str]:
    """Yield the lines of a file. The rest of a line that is longer than any frame is skipped."""
    while line := file.readline(_LONGEST_LINE):
        yield line
        while len(line) == _LONGEST_LINE and not line.endswith("\n"):
            line = file.readline(_LONGEST_LINE)


class Decoding:
    """Decoder of one frame after another. ``code`` is the exit code so far."""

    def __init__(self, request: Request) -> None:
        self._request = query = request
        self._read = text_decoder(query.device, query.match.variant, query.sender, query.layout)
        is_known = query.layout is not None or query.register is not None
        self._others = None if is_known else OtherFrames(query.device, query.match.variant, query.sender)
        self._label = tuple(label_lines(query.device, query.match))
        #: The layouts whose questions are answered, and the answers that each layout needs, by name.
        self._decided: set[str] = set()
        self._answers: dict[str, dict[str, str]] = {}
        self._codes = {FAULT} if request.others else set()
        self._is_first = True

    @property
    def code(self) -> int:
        return next((code for code in _WORST_FIRST if code in self._codes), DONE)

    def run(self, lines: Iterable[Line]) -> None:
        """Print each frame decoded. Report text that is not a frame, and continue."""
        for count, line in enumerate(lines):
            if count == MANY and self._request.register is None:
                command = f"{self._request.device.manufacturer.distribution} decode"
                print(
                    f"codewheel: {MANY:,} frames; for files, the Python package is faster: {command}", file=sys.stderr
                )
            try:
                decoded, why = self._decode(line.text)
            except (FrameTextError, RegisterError, UndecidedError) as error:
                self._codes.add(NO_FRAME)
                where = f"line {line.number}: " if line.number is not None else ""
                print(f"codewheel: {where}{error}", file=sys.stderr)
                continue
            frame_findings = findings(self._request.device, self._request.match.variant, decoded)
            strange = tuple(strange_values(self._request.device, decoded))
            if strange or self._request.others:
                frame_findings = replace(
                    frame_findings, differences=(*self._request.others, *frame_findings.differences, *strange)
                )
            self._codes.add(_code(decoded, frame_findings))
            other_layouts = self._others.of(line.text, decoded) if self._others is not None else ()
            why = why if not is_another(decoded, other_layouts) else None
            # Someone who reads many frames should not have to wait for the end.
            print(self._text(line, decoded, frame_findings, why, other_layouts), flush=line.number is not None)

    def _decode(self, text: str) -> tuple[codec.Decoded, Why | None]:
        request = self._request
        variant = request.match.variant
        decoded = (
            self._read(text)
            if request.register is None
            else decode_register_text(request.device, variant, request.register, text)
        )
        # A word is only bits, and even its length depends on the answers.
        placed = decoded.layout
        needs_answers = placed is not None and bool(decoded.fields or not placed.layout.in_bytes)
        if placed is not None and needs_answers and placed.name not in self._decided:
            refuse_undecided(request.device, placed.layout, request.answers)
            self._decided.add(placed.name)
        return decoded, why_text(
            request.device, variant, request.sender, text, decoded
        ) if request.register is None else None

    def _taken(self, decoded: codec.Decoded) -> dict[str, str]:
        """Return the answers that were used to decode a frame, with the defaults of those that decide its verdict."""
        if decoded.layout is None:
            return {}
        return self._needed(decoded.layout) | self._decisive(decoded)

    def _needed(self, placed: PlacedLayout) -> dict[str, str]:
        """Return the answers that the places of the fields depend on."""
        if placed.name not in self._answers:
            open_alternatives = self._request.device.alternatives_of(placed.layout)
            answers = self._request.answers
            self._answers[placed.name] = {
                alternative.name: answers[alternative.name]
                for alternative in open_alternatives
                if alternative.name in answers
            }
        return self._answers[placed.name]

    def _decisive(self, decoded: codec.Decoded) -> dict[str, str]:
        """Return the answers, or their defaults, that decide the verdict of an active flag of the frame."""
        if decoded.problems or decoded.layout is None:
            return {}
        values = {field.name: field.value for field in decoded.fields}
        kinds = (field.field.kind for field in decoded.layout.fields if values.get(field.name) is True)
        parameters = {kind.verdict_parameter for kind in kinds if isinstance(kind, Flag)}
        deciding = (
            alternative
            for alternative in self._request.device.optional_alternatives
            if alternative.parameter in parameters
        )
        return {
            alternative.name: self._request.answers.get(alternative.name, alternative.default)
            for alternative in deciding
        }

    def _text(
        self,
        line: Line,
        decoded: codec.Decoded,
        frame_findings: Findings,
        why: Why | None,
        other_layouts: Sequence[PlacedLayout],
    ) -> str:
        request, answers = self._request, self._taken(decoded)
        if request.as_json:
            data = decoded_data(
                request.device,
                request.match.variant,
                request.sender,
                decoded,
                frame_findings,
                why,
                line,
                answers,
                other_layouts,
            )
            return json.dumps(data, indent=2, ensure_ascii=False) if line.number is None else _ONE_LINE.encode(data)
        separator = "" if self._is_first else "\n"
        self._is_first = False
        other_frames_text = other_frames_line(decoded, other_layouts)
        return separator + explain(
            request.device,
            request.match,
            request.sender,
            decoded,
            frame_findings,
            why,
            line,
            answers,
            self._label,
            other_frames_text,
        )


def _code(decoded: codec.Decoded, frame_findings: Findings) -> int:
    if decoded.problems or any(difference.of_register for difference in frame_findings.differences):
        return FAULT
    return NOT_USABLE if frame_findings.verdict is Verdict.NOT_USABLE else DONE
