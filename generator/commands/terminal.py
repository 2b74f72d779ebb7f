"""The terminal, or what stands in its place: streams that lack characters, are full, or are closed."""

from __future__ import annotations

import codecs
import io
import os
import sys
import unicodedata
from contextlib import suppress
from typing import TextIO


class Stop(Exception):
    """The command ends here with this message and exit code."""

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.code = code


#: What stands for a character that the terminal lacks, where its decomposition would not do.
_STAND_INS = {
    "→": "->",
    "←": "<-",
    "↔": "<->",
    "−": "-",
    "–": "-",
    "—": "-",
    "‑": "-",
    "“": '"',
    "”": '"',
    "„": '"',
    "‘": "'",
    "’": "'",
    "×": "x",
    "·": ".",
    "±": "+-",
    "≤": "<=",
    "≥": ">=",
    "≠": "!=",
    "≈": "~",
    "²": "^2",
    "³": "^3",
    "°": "deg",
    "µ": "u",
    "μ": "u",
    "Ω": "Ohm",
    "Ø": "dia. ",
    "ß": "ss",
    "§": "section ",
    "®": "(R)",
    "©": "(C)",
    "™": "(TM)",
}


def prepare(as_json: bool = False) -> None:
    """Make the standard streams take any text; JSON keeps every character, as an escape where it has to.

    A stream that is closed takes everything as well, and nothing can be read from it.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115 (open for as long as we run)
    if sys.stdin is None:
        sys.stdin = _ClosedInput()
    # What the system writes for a byte that is no text of its encoding is no frame either: it is shown and refused.
    _configure(sys.stdin, None, "backslashreplace")
    _configure(sys.stderr, None, "codewheel")
    if as_json:
        _configure(sys.stdout, None if _is_utf8(sys.stdout) else "ascii", "codewheel-json")
    else:
        _configure(sys.stdout, None, "codewheel")


def release() -> None:
    """Give the interpreter nothing more to write to streams that take nothing."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _configure(stream: TextIO, encoding: str | None, errors: str) -> None:
    if isinstance(stream, io.TextIOWrapper):
        stream.reconfigure(encoding=encoding, errors=errors)


def _is_utf8(stream: TextIO) -> bool:
    return codecs.lookup(stream.encoding or "ascii").name == "utf-8"


class _ClosedInput(io.StringIO):
    """Standard input where there is none."""

    def readline(self, *_: object) -> str:  # type: ignore[override]
        raise Stop("standard input is closed, so there is no frame to read", 2)

    read = __next__ = readline  # type: ignore[assignment]


def _in_words(error: UnicodeError) -> tuple[str | bytes, int]:
    """The error handler for text: a stand-in in ASCII; bytes of a file's name are written as they came."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    character = error.object[error.start]
    if "\udc80" <= character <= "\udcff":
        return bytes([ord(character) - 0xDC00]), error.start + 1
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return _STAND_INS.get(character, plain or "?"), error.start + 1


def _in_json(error: UnicodeError) -> tuple[str, int]:
    """The error handler for JSON, in which all such characters stand in strings."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    units = error.object[error.start].encode("utf-16-be", "surrogatepass").hex()
    return "".join(f"\\u{units[start : start + 4]}" for start in range(0, len(units), 4)), error.start + 1


codecs.register_error("codewheel", _in_words)
codecs.register_error("codewheel-json", _in_json)
