"""Types and constants of C."""

from __future__ import annotations

from .. import TargetError

_PLAIN = frozenset(letter for letter in map(chr, range(0x20, 0x7F)) if letter not in '"\\?')


def string(text: object) -> str:
    """Return ``text`` as a string literal."""
    return '"' + "".join(map(_character, str(text).encode("utf-8"))) + '"'


def _character(byte: int) -> str:
    """Return a byte as a character of a string literal."""
    return chr(byte) if chr(byte) in _PLAIN else f"\\{byte:03o}"


def number(value: int, hexadecimal: bool = False, digits: int = 2) -> str:
    """Return ``value`` as an unsigned constant."""
    text = f"0x{value:0{digits}X}" if hexadecimal else str(value)
    return f"UINT64_C({text})" if value > 0xFFFFFFFF or (hexadecimal and digits > 8) else f"{text}U"


def signed_number(value: int) -> str:
    text = f"INT64_C({abs(value)})" if abs(value) > 0x7FFF else str(abs(value))
    return f"(-{text})" if value < 0 else text


def mask(width: int) -> str:
    """Return a constant whose lowest ``width`` bits are 1."""
    return number((1 << width) - 1, hexadecimal=True)


def size_of(bits: int) -> int:
    """Return the width of the smallest unsigned type for ``bits`` bits."""
    for size in (8, 16, 32, 64):
        if bits <= size:
            return size
    raise TargetError(f"a number of {bits} bits; the C target holds numbers of at most 64 bits")


def signed(bits: int) -> str:
    return f"int{size_of(bits)}_t"


def unsigned(bits: int) -> str:
    """Return the smallest unsigned type for ``bits`` bits."""
    return f"uint{size_of(bits)}_t"
