"""Data as Python literals: strings, records and tables. Any text from a spec is safe."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

from ...model.lookup import assert_never
from ...model.record import dataclass
from .expr import grouped
from .lines import broken


def quoted(text: str | bytes) -> str:
    """Return a one-line literal in double quotes, with bytes in hexadecimal."""
    if isinstance(text, bytes):
        return 'b"' + "".join(f"\\x{byte:02x}" for byte in text) + '"'
    if text.isprintable() and '"' not in text and "\\" not in text:
        return f'"{text}"'
    escaped = repr(text)
    return escaped if escaped[0] == '"' else '"' + escaped[1:-1].replace("\\'", "'").replace('"', '\\"') + '"'


@dataclass(frozen=True)
class Code:
    """Source code that is printed unchanged."""

    text: str


@dataclass(frozen=True)
class Member:
    """Member of an enumeration, given by its value in the spec."""

    kind: str
    value: str


@dataclass(frozen=True)
class Hex:
    """Hexadecimal number with at least two digits."""

    number: int


@dataclass(frozen=True)
class Call:
    """Call. An argument without a name is positional."""

    function: str
    arguments: tuple[tuple[str, Literal], ...]

    @cached_property
    def flat(self) -> str:
        """Call on one line."""
        arguments = []
        for name, value in self.arguments:
            prefix = f"{name}=" if name else ""
            arguments.append(f"{prefix}{literal(value)}")
        return f"{self.function}({', '.join(arguments)})"


@dataclass(frozen=True)
class ConditionalItem:
    """Item of a tuple that is present if the expression ``condition`` is true."""

    call: Call
    condition: str


Literal = (
    None
    | bool
    | int
    | float
    | str
    | bytes
    | Code
    | Member
    | Hex
    | Call
    | ConditionalItem
    | Sequence["Literal"]
    | Mapping[str, str]
)


def call(function: str, *positional: Literal, **optional: Literal) -> Call:
    """Return a call with positional arguments, and with the optional ones that are not empty."""
    return Call(function, (*(("", value) for value in positional), *_named_arguments(optional)))


def record(function: str, needed: Mapping[str, Literal], **optional: Literal) -> Call:
    """Return a call with only named arguments."""
    return Call(function, (*needed.items(), *_named_arguments(optional)))


def _named_arguments(optional: Mapping[str, Literal]) -> tuple[tuple[str, Literal], ...]:
    return tuple((name, value) for name, value in optional.items() if not is_empty(value))


def is_empty(value: Literal) -> bool:
    """Return whether a value is None or without content. False and 0 are not empty."""
    return value in (None, "", ()) or (isinstance(value, Mapping) and not value)


def constant(name: str, value: Call) -> str:
    """Return the statement that assigns a value to ``name``."""
    return broken(f"{name}: Final = {value.flat}")


def table(name: str, kind: str, rows: Sequence[Call]) -> str:
    """Return the statement that assigns a tuple of records to ``name``, one per line."""
    lines = [f"    {row.flat}," for row in rows]
    return f"{name}: Final[tuple[{kind}, ...]] = " + ("\n".join(["(", *map(broken, lines), ")"]) if lines else "()")


def literal(value: Literal) -> str:
    """Return ``value`` as source code on one line."""
    match value:
        case str() | bytes():
            return quoted(value)
        case None | bool():
            return str(value)
        case int():
            return grouped(value)
        case float():
            return f"{value:g}"
        case Mapping():
            return "ReadOnly({" + ", ".join(f"{quoted(key)}: {quoted(text)}" for key, text in value.items()) + "})"
        case Code() | Hex() | Member() | Call() | ConditionalItem():
            return _code(value)
    return f"({', '.join(map(literal, value))}{',' if len(value) == 1 else ''})"


def _code(value: Code | Hex | Member | Call | ConditionalItem) -> str:
    match value:
        case Code():
            return value.text
        case Hex():
            return f"0x{value.number:02X}"
        case Member():
            return f"{value.kind}.{value.value.upper()}"
        case Call():
            return value.flat
        case ConditionalItem():
            return f"*([{value.call.flat}] if {value.condition} else [])"
        case _:
            assert_never(value)
