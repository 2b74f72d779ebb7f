"""``codewheel decode`` on one frame or on many: what is printed for each, and the exit code of all."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ..model import Device, Verdict
from ..order_codes.labels import Match
from ..order_codes.run_time import RegisterError
from ..reference import codec
from ..reference.editions import strange_values
from ..reference.findings import Difference, Findings, findings
from ..why.mistakes import Why
from .choose import UndecidedError, refuse_undecided
from .decode import decode_register_text, decode_text, decoded_data, explain, why_text
from .frame_text import FrameTextError

DONE, FAULT, NO_FRAME, NOT_USABLE = 0, 1, 2, 3
#: Of several frames the worst decides.
_WORST_FIRST = (NO_FRAME, FAULT, NOT_USABLE)

#: A frame as text, with its line of standard input, or None where it was an argument.
Text = tuple[int | None, str]


@dataclass(frozen=True, slots=True)
class Request:
    """What is to be decoded, and how: the value of ``register`` if that is named, else a frame."""

    device: Device
    match: Match
    sender: str
    layout: str | None
    register: str | None
    as_json: bool
    #: What ``--register`` gives of registers by which the encoder is known, where it is not what this order code has.
    others: tuple[Difference, ...]
    #: What the user decides of what the manual leaves open, by the names of the alternatives.
    answers: Mapping[str, str]


def frames(arguments: Sequence[str]) -> Iterator[Text]:
    """The frame that the arguments make up, or for ``-`` those of standard input, without comments and empty lines."""
    if list(arguments) != ["-"]:
        yield None, " ".join(arguments)
        return
    if isinstance(sys.stdin, io.TextIOWrapper):
        sys.stdin.reconfigure(errors="replace")
    for number, line in enumerate(sys.stdin, 1):
        text = line.partition("#")[0].strip()
        if text:
            yield number, text


class Decoding:
    """The frames one after the other; ``code`` is the exit code of those that are done."""

    def __init__(self, request: Request) -> None:
        self._request = request
        self._codes = {FAULT} if request.others else set()
        self._is_first = True

    @property
    def code(self) -> int:
        return next((code for code in _WORST_FIRST if code in self._codes), DONE)

    def run(self, texts: Iterable[Text]) -> None:
        """Print what each text says; what is no frame is named, and the next one taken."""
        for number, text in texts:
            try:
                decoded, why = self._decode(text)
            except (FrameTextError, RegisterError, UndecidedError) as error:
                self._codes.add(NO_FRAME)
                where = f"line {number}: " if number is not None else ""
                print(f"codewheel: {where}{error}", file=sys.stderr)
                continue
            said = findings(self._request.device, self._request.match.variant, decoded)
            strange = strange_values(self._request.device, decoded)
            said = replace(said, differences=(*self._request.others, *said.differences, *strange))
            self._codes.add(_code(decoded, said))
            # A reader of many frames need not wait for the end.
            print(self._text(number, decoded, said, why), flush=number is not None)

    def _decode(self, text: str) -> tuple[codec.Decoded, Why | None]:
        asked = self._request
        variant = asked.match.variant
        decoded = (
            decode_text(asked.device, variant, asked.sender, text, asked.layout)
            if asked.register is None
            else decode_register_text(asked.device, variant, asked.register, text)
        )
        # A word is nothing but bits: even its length follows from the answers.
        if decoded.layout is not None and (decoded.fields or not decoded.layout.layout.in_bytes):
            refuse_undecided(asked.device, decoded.layout.layout, asked.answers)
        return decoded, why_text(asked.device, variant, asked.sender, text, decoded) if asked.register is None else None

    def _taken(self, decoded: codec.Decoded) -> dict[str, str]:
        """The answers by which a frame was read."""
        asked = self._request
        needed = asked.device.alternatives_of(decoded.layout.layout) if decoded.layout is not None else ()
        return {item.name: asked.answers[item.name] for item in needed if item.name in asked.answers}

    def _text(self, number: int | None, decoded: codec.Decoded, said: Findings, why: Why | None) -> str:
        asked, taken = self._request, self._taken(decoded)
        if asked.as_json:
            data = decoded_data(asked.match.variant, asked.sender, decoded, said, why, number, taken)
            return json.dumps(data, indent=2 if number is None else None, ensure_ascii=False)
        between = "" if self._is_first else "\n"
        self._is_first = False
        return between + explain(asked.device, asked.match, asked.sender, decoded, said, why, number, taken)


def _code(decoded: codec.Decoded, said: Findings) -> int:
    if decoded.problems or any(item.of_register for item in said.differences):
        return FAULT
    return NOT_USABLE if said.verdict is Verdict.NOT_USABLE else DONE
