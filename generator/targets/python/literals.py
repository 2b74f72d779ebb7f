"""Data as Python literals: strings, records and tables, the meaning of bits, and the breaking of long lines."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

from ...model.lookup import assert_never
from ...model.record import dataclass
from ...plan.values import Active, Characters, DigitRuns, Meaning, Named, Raw, TwosComplement, ZeroMeans
from .expr import grouped

WIDTH = 120

_TOKEN = re.compile(r'"(?:\\.|[^"\\])*"|[][(){},]|[^][(){},"]+')
_TEXT = re.compile(r'(\s*)(\w+=|"(?:\\.|[^"\\])*": )?("(?:\\.|[^"\\])*"),')


def broken(text: str) -> str:
    """Return the code with long lines broken into one line for each item in the first brackets."""
    return "\n".join(piece for line in text.split("\n") for piece in _broken_lines(line))


def _broken_lines(line: str) -> Iterator[str]:
    text = _TEXT.fullmatch(line) if len(line) > WIDTH else None
    start, items, end = _items(line) if len(line) > WIDTH and text is None else (line, [], "")
    if text is not None:
        yield f"{text[1]}{text[2] or ''}{_split_literal(text[3], len(text[1]))},"
    elif not items:
        yield line
    else:
        indent = line[: len(line) - len(line.lstrip())]
        yield start
        # A comma would make a tuple of one unpacked value in parentheses.
        comma = "" if start.endswith("*(") and len(items) == 1 else ","
        for element in items:
            yield from _broken_lines(f"{indent}    {element}{comma}")
        yield indent + end


def _items(line: str) -> tuple[str, list[str], str]:
    """Return the line up to its first bracket, the items in the brackets, and the rest with the closing bracket."""
    place, depth, start = 0, 0, ""
    items = [""]
    for token in _TOKEN.findall(line):
        depth += (token in "([{") - (token in ")]}")
        if start and not depth:
            break
        place += len(token)
        if not start:
            start = line[:place] if depth else ""
        elif token == "," and depth == 1:
            items.append("")
        else:
            items[-1] += token
    return start, [element.strip() for element in items if element.strip()], line[place:]


def _split_literal(text: str, indent: int) -> str:
    """Return a long quoted text as several literals in parentheses, split after spaces."""
    pieces = [""]
    for word in text[1:-1].split(" "):
        if pieces[-1] and indent + 4 + len(f'"{pieces[-1]}{word}"') > WIDTH - 2:
            pieces.append("")
        pieces[-1] += word + " "
    pieces[-1] = pieces[-1][:-1]
    lines = [f'{" " * indent}    "{piece}"' for piece in pieces if piece]
    return "\n".join(["(", *lines, f"{' ' * indent})"]) if len(lines) > 1 or len(lines[0]) <= WIDTH else text


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


def of_number(meaning: Meaning) -> dict[str, Literal]:
    """Return the members of a record for an unsigned number."""
    match meaning:
        case ZeroMeans(number):
            return {"zero_means": number}
        case Raw() | TwosComplement() | Active() | Named() | DigitRuns() | Characters():
            return {}
        case _:
            assert_never(meaning)


def of_facts(meaning: Meaning) -> dict[str, Literal]:
    """Return the members of ``FieldFacts``, with None for those that do not apply to the field."""
    without_members: dict[str, Literal] = {"active": None, "signed": None, "zero_means": None}
    match meaning:
        case Raw() | ZeroMeans() | Named() | DigitRuns() | Characters():
            return without_members | of_number(meaning)
        case TwosComplement():
            return without_members | {"signed": True}
        case Active(low):
            return without_members | {"active": "low" if low else "high"}
        case _:
            assert_never(meaning)
