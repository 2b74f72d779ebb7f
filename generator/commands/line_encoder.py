"""An encoder described in one line instead of an order code: its device, or all problems of the line."""

from __future__ import annotations

import shlex
import sys
from typing import TYPE_CHECKING

from ..one_line.line import EncoderLine, LineError
from ..one_line.parse import is_line as is_line
from ..one_line.parse import parse_line
from ..say import count_with_unit
from .terminal import CommandError

if TYPE_CHECKING:
    from ..model import Device
    from ..order_codes.labels import LabelMatch

#: Hint for an unknown order code.
WITHOUT_SPEC = "To describe an encoder without a spec, write it in one line, such as ssi:position=25,error=low"
#: End of the help of an order code.
OR_A_LINE = ", or the encoder in one line, such as biss:position=32,error,warning,crc=6:0x43"


def encoder_in_line(text: str) -> tuple[Device, LabelMatch]:
    """Return the device that a line describes, and the line as its order code.

    Raises:
        CommandError: The line has problems, which are printed. The exit code is 2.
    """
    from ..one_line.encoder import device_of_line

    try:
        return device_of_line(text)
    except LineError as error:
        raise line_problems(error) from None


def checked_line(text: str) -> EncoderLine:
    """Return a line whose spec has no problems.

    Raises:
        CommandError: The line has problems, which are printed. The exit code is 2.
    """
    # Called for its error only, because the parser does not find all problems.
    encoder_in_line(text)
    return parse_line(text)


def line_problems(error: LineError) -> CommandError:
    """Print all problems of a line to standard error, and return the ``CommandError`` to raise."""
    from ..language.excerpt import excerpt, visible

    for column, message in error.problems:
        print(f"column {column}: {visible(message)}", *excerpt(error.text, column), sep="\n", file=sys.stderr)
    return CommandError(f"{count_with_unit(len(error.problems), 'problem')} in the line", 2)


def refuse_line(text: str, action: str) -> None:
    """Check that a text is not an encoder in one line. ``action`` is why it must not be: ``has no editions``.

    Raises:
        CommandError: It is a line. The exit code is 2.
    """
    if is_line(text):
        raise CommandError(f"a line {action}; to write it as a spec: {command_for_spec(text)}", 2)


def command_for_spec(text: str) -> str:
    """Return the command that writes a line as a spec."""
    return f"codewheel new my_encoder --line {shlex.quote(text.strip())}"
