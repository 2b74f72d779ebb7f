"""Input and output of commands: characters that cannot be shown, closed streams, progress, errors and colours."""

from __future__ import annotations

import codecs
import io
import json
import os
import re
import sys
import unicodedata
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from ..say import STAND_INS, count_with_unit

if TYPE_CHECKING:
    from ..language.problems import ProblemReport

#: Time in seconds after which progress is shown, and time between updates.
_AFTER_S, _EVERY_S = 1.0, 0.25
_COLOUR_CODES = {"red": 31, "green": 32, "yellow": 33, "cyan": 36, "faint": 2, "bold": 1}
#: Colour of the first word of a line of ``diff``.
_BY_IMPACT = {
    "breaking": "red",
    "behaviour": "yellow",
    "compatible": "green",
    "renamed": "cyan",
    "documentation": "faint",
    "names": "bold",
}
_IMPACT_IN_LINE = re.compile(rf"^(  )({'|'.join(_BY_IMPACT)})(?= )", re.MULTILINE)


class CommandError(Exception):
    """End of the command, with a message and an exit code."""

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.code = code


def prepare_streams(as_json: bool = False) -> None:
    """Make the standard streams accept any text. JSON keeps every character, as an escape if necessary.

    If an output stream is closed, its text is discarded. If the input is closed, reading it is an error.
    """
    for stream_name in ("stdout", "stderr"):
        if getattr(sys, stream_name) is None:
            null_device = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 (open for as long as we run)
            setattr(sys, stream_name, null_device)
    if sys.stdin is None:
        # Reading it raises CommandError.
        sys.stdin = _ClosedInput()
    # A byte that is not valid text becomes an escape such as \\xff, which is rejected later because it is not a frame.
    _configure_stream(sys.stdin, errors="backslashreplace")
    _configure_stream(sys.stderr, errors="codewheel")
    if as_json:
        # In ASCII, every character that is not in it becomes an escape.
        encoding = None if _is_utf8(sys.stdout) else "ascii"
        _configure_stream(sys.stdout, errors="codewheel-json", encoding=encoding)
    else:
        _configure_stream(sys.stdout, errors="codewheel")


class Progress:
    """Show a line on standard error, if it is a terminal, while work takes longer than a second.

    ``text`` is the line. A timer shows it, so the work itself does not need to call anything.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self._shown = False
        self._end = ExitStack()

    def __enter__(self) -> Progress:
        """Start a timer that shows the line after a second and updates it, if standard error is a terminal."""
        if sys.stderr.isatty():
            import signal

            with suppress(AttributeError, ValueError):  # Windows has no timer, and other threads have no signals.
                before = signal.signal(signal.SIGALRM, self._show_progress)
                self._end.callback(signal.signal, signal.SIGALRM, before)
                signal.setitimer(signal.ITIMER_REAL, _AFTER_S, _EVERY_S)
                self._end.callback(signal.setitimer, signal.ITIMER_REAL, 0)
        return self

    def __exit__(self, *_: object) -> None:
        self._end.close()
        if self._shown:
            self._write_progress("\r\x1b[K")

    def _show_progress(self, *_: object) -> None:
        self._shown = True
        self._write_progress(f"\r\x1b[K{self.text}")

    def _write_progress(self, text: str) -> None:
        with suppress(OSError):  # The buffer of the stream may be in use at this moment.
            os.write(sys.stderr.fileno(), text.encode("ascii", "replace"))


def release_streams() -> None:
    """Flush the output streams, and redirect those that fail to the null device, so that Python can exit."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                null_device = os.open(os.devnull, os.O_WRONLY)
                os.dup2(null_device, stream.fileno())


def _configure_stream(stream: TextIO, *, errors: str, encoding: str | None = None) -> None:
    """Set the handler for encoding errors of a standard stream, and its encoding unless it is None."""
    if isinstance(stream, io.TextIOWrapper):
        stream.reconfigure(encoding=encoding, errors=errors)


def _is_utf8(stream: TextIO) -> bool:
    return codecs.lookup(stream.encoding or "ascii").name == "utf-8"


class _ClosedInput(io.StringIO):
    """Stand-in for a closed standard input."""

    def readline(self, *_: object) -> str:  # type: ignore[override]
        raise CommandError("cannot read frames: standard input is closed", 2)

    read = __next__ = readline  # type: ignore[assignment]


def _replace_in_text(error: UnicodeError) -> tuple[str | bytes, int]:
    """Handle an encoding error in text: return a replacement for one character, and the index at which to continue.

    The replacement is similar ASCII text, such as ``u`` for ``ü``, or else ``?``. A byte of a file name that is not
    valid text stays as it is.
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    character = error.object[error.start]
    # Python uses these characters for bytes of file names that are not valid text.
    if "\udc80" <= character <= "\udcff":
        byte = ord(character) - 0xDC00
        return bytes([byte]), error.start + 1
    base_letters = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return STAND_INS.get(character, base_letters or "?"), error.start + 1


def _replace_in_json(error: UnicodeError) -> tuple[str, int]:
    """Handle an encoding error in JSON: return an escape for one character, and the index at which to continue.

    An escape is valid for all such characters, because they are in strings.
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    character = error.object[error.start]
    hex_digits = character.encode("utf-16-be", "surrogatepass").hex()
    # An escape has four digits. A character beyond 16 bits becomes two escapes.
    escapes = [f"\\u{hex_digits[start : start + 4]}" for start in range(0, len(hex_digits), 4)]
    return "".join(escapes), error.start + 1


codecs.register_error("codewheel", _replace_in_text)
codecs.register_error("codewheel-json", _replace_in_json)


def refuse_missing(paths: Sequence[Path]) -> None:
    """Check that all paths exist.

    Raises:
        CommandError: A path does not exist. The exit code is 2.
    """
    missing = [str(path) for path in paths if not _path_exists(path)]
    if missing:
        raise CommandError(f"no such file or folder: {', '.join(missing)}", 2)


def _path_exists(path: Path) -> bool:
    try:
        return path.exists() or path.is_symlink()
    except (OSError, ValueError):
        return True  # It exists, and reading it will report the error.


def print_json(data: Any) -> None:
    """Print data as JSON, in indented lines."""
    print(json.dumps(data, indent=2, ensure_ascii=False))


def error_after_printing(report: ProblemReport) -> CommandError:
    """Print all problems to standard error, and return the ``CommandError`` to raise."""
    for problem in report.shown:
        print(problem.format(), file=sys.stderr)
    return CommandError(count_with_unit(len(report.by_cause), "problem"), 1)


def has_colours() -> bool:
    """Return whether standard output is a terminal with colours that the user has not switched off."""
    is_wanted = not os.environ.get("NO_COLOR") and os.environ.get("TERM", "") != "dumb"
    return is_wanted and sys.stdout.isatty()


def in_colour(text: str, colour: str) -> str:
    """Return a text in a colour of ``_COLOUR_CODES``."""
    return f"\x1b[{_COLOUR_CODES[colour]}m{text}\x1b[0m"


def with_coloured_impacts(text: str) -> str:
    """Return the text of ``diff`` with the impact of each change in its colour, if the terminal has colours."""
    if not has_colours():
        return text
    return _IMPACT_IN_LINE.sub(_in_colour_of_impact, text)


def _in_colour_of_impact(line_start: re.Match[str]) -> str:
    """Return the beginning of a line, such as ``  breaking``, with the impact in its colour."""
    indent, impact = line_start.groups()
    return f"{indent}{in_colour(impact, _BY_IMPACT[impact])}"
