"""Notations for frames in programs and logs, which both ``codewheel decode`` and the decode page accept.

The patterns are valid in Python and in JavaScript.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

#: Patterns for text from programs and logs, with their replacements. In this order: a label such as ``RX: `` with a
#: letter that is not a hex digit, ``uint8_t rx[2] =`` in C, ``b'..'`` in Python, ``\x1F``, brackets and quotes,
#: ``1F-2A``, ``1Fh``, and ``0x1FUL`` in C.
PASTED: tuple[tuple[str, str], ...] = (
    (r"^\s*(?=[^:]*[G-Zg-z])[A-Za-z_][A-Za-z0-9_ ]{0,39}:\s+", ""),
    (r"^\s*[A-Za-z_][A-Za-z0-9_ ]{0,39}\[[0-9A-Z_a-z]{0,20}\]\s*=\s*(?=\{)", ""),
    (r"\bb(?=['\"])", ""),
    (r"\\x([0-9A-Fa-f]{2})", r" 0x\1 "),
    (r"[\[\](){}<>\"',;:]", " "),
    (r"(?<![0-9A-Za-z])([0-9A-Fa-f]{2})-(?=[0-9A-Fa-f]{2}(?![0-9A-Za-z]))", r"\1 "),
    (r"(?<![0-9A-Za-z])(?:0[xX])?([0-9A-Fa-f]+)[hH](?![0-9A-Za-z])", r"0x\1"),
    (r"(?<![0-9A-Za-z])(0[xXbB][0-9A-Fa-f_]+)[uUlL]+(?![0-9A-Za-z])", r"\1"),
)
#: White space that only Python or only JavaScript strips from a text: the separators of ASCII, the next-line character
#: of Latin-1, and the byte order mark at the beginning of a file.
ODD_BLANKS = r"[\x1c-\x1f\x85\ufeff]"
#: A time in front of a frame: with a decimal point, a unit, or hours, minutes and seconds. An arrow may follow, as in
#: the serial monitor of Arduino.
TIME = (
    r"\[?((?:[0-9]{4}-[0-9]{2}-[0-9]{2}[T ])?[0-9]{1,2}:[0-9]{2}:[0-9]{2}(?:[.,][0-9]+)?Z?"
    r"|[0-9]+[.][0-9]+(?: ?(?:s|ms|us|µs))?|[0-9]+ ?(?:s|ms|us|µs))\]?[ \t,;]+(?:->[ \t]*)?(?=[^ \t])"
)
#: Digits without a prefix, by their meaning. A decimal number has no leading zero. A long number is too large for the
#: frame, but may be a frame with extra bits.
DIGITS: Mapping[str, str] = MappingProxyType(
    {
        "decimal": r"0|[1-9][0-9]{0,39}",
        "hexadecimal": r"[0-9A-Fa-f]{1,40}",
        "bits": r"[01]{1,160}",
        "long_number": r"[1-9][0-9]{0,19}",
    }
)
