"""Python source from data: names, strings, docstrings and literals that text from a spec cannot break out of."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Union

from ..expressions import Expression
from ..render import plain, wrapped

WIDTH = 120

#: A quotation mark at the end that no backslash takes the meaning from.
_OPEN_QUOTE = re.compile(r'(?<!\\)(?:\\\\)*"$')

#: Built-ins that the generated classes use in their bodies; a field of such a name would hide them there. Any method
#: that has the name ``super`` is bound to its class, which a NamedTuple does not allow.
_BUILT_IN = frozenset(
    ("bool", "bytes", "classmethod", "float", "int", "property", "staticmethod", "str", "super", "tuple")
)


def attribute(name: str, taken: Iterable[str] = ()) -> str:
    """The name of an attribute or argument; one that Python or the class needs itself gets a trailing underscore."""
    return f"{name}_" if keyword.iskeyword(name) or name in _BUILT_IN or name in taken else name


def camel(name: str) -> str:
    """``single_cycle_data`` as ``SingleCycleData``."""
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


class Names:
    """The names of a module, each given once."""

    def __init__(self, taken: Iterable[str]) -> None:
        self._taken = set(taken)

    def take(self, wanted: str, suffix: str) -> str:
        """``wanted`` where it is free, else with ``suffix``, else with a number as well."""
        base = wanted if wanted not in self._taken and not keyword.iskeyword(wanted) else f"{wanted}{suffix}"
        name, number = base, 2
        while name in self._taken:
            name, number = f"{base}{number}", number + 1
        self._taken.add(name)
        return name


def quoted(text: str | bytes) -> str:
    """A literal of one line in double quotes; every byte in hexadecimal."""
    if isinstance(text, bytes):
        return 'b"' + "".join(f"\\x{byte:02x}" for byte in text) + '"'
    shown = repr(text)
    return shown if shown[0] == '"' else '"' + shown[1:-1].replace("\\'", "'").replace('"', '\\"') + '"'


@dataclass(frozen=True)
class Code:
    """Source that stands as it is."""

    text: str


@dataclass(frozen=True)
class Hex:
    """A number in hexadecimal, in at least two digits."""

    number: int


@dataclass(frozen=True)
class Call:
    """A call; an argument without a name is positional, one without a value is left out."""

    function: str
    arguments: tuple[tuple[str, Literal], ...]


Literal = Union[None, bool, int, str, bytes, Code, Hex, Call, Sequence["Literal"], Mapping[str, str]]


def call(function: str, *positional: Literal, **optional: Literal) -> Call:
    """A call with positional arguments, and with those optional ones that differ from their default of nothing."""
    return Call(function, (*(("", value) for value in positional), *_given(optional)))


def record(function: str, needed: Mapping[str, Literal], **optional: Literal) -> Call:
    """A call with named arguments only."""
    return Call(function, (*needed.items(), *_given(optional)))


def _given(optional: Mapping[str, Literal]) -> tuple[tuple[str, Literal], ...]:
    return tuple((name, value) for name, value in optional.items() if value is not None and not (value in ("", ()) or (isinstance(value, Mapping) and not value)))


def literal(value: Literal, indent: int = 0, before: int = 0, after: int = 0) -> str:
    """``value`` as source: on one line where it fits, else broken as Black would.

    Args:
        value: What to write.
        indent: Columns that the statement is indented by.
        before: Columns that stand before the value on its first line, indentation included.
        after: Columns that follow it on its last line.
    """
    flat = _flat(value)
    if (before or indent) + len(flat) + after <= WIDTH:
        return flat
    pad, inner = " " * indent, " " * (indent + 4)
    if isinstance(value, str):
        pieces = _pieces(value, WIDTH - indent - 6)
        return "\n".join(["(", *(f"{inner}{quoted(piece)}" for piece in pieces), f"{pad})"]) if len(pieces) > 1 or indent + 4 + len(flat) <= WIDTH else flat
    if isinstance(value, Call):
        return "\n".join([f"{value.function}(", *(_item(item, name and f"{name}=", indent + 4) for name, item in value.arguments), f"{pad})"])
    if isinstance(value, Mapping):
        items = [_item(item, f"{quoted(key)}: ", indent + 8) for key, item in value.items()]
        return "\n".join(["ReadOnly(", f"{inner}{{", *items, f"{inner}}}", f"{pad})"])
    if isinstance(value, Sequence) and not isinstance(value, bytes):
        return "\n".join(["(", *(_item(item, "", indent + 4) for item in value), f"{pad})"])
    return flat


def _item(value: Literal, label: str, indent: int) -> str:
    return f"{' ' * indent}{label}{literal(value, indent, indent + len(label), 1)},"


def _flat(value: Literal) -> str:
    if isinstance(value, (str, bytes)):
        return quoted(value)
    if isinstance(value, Code):
        return value.text
    if isinstance(value, Hex):
        return f"0x{value.number:02X}"
    if isinstance(value, Call):
        return f"{value.function}({', '.join(f'{name}={_flat(item)}' if name else _flat(item) for name, item in value.arguments)})"
    if value is None or isinstance(value, bool):
        return str(value)
    if isinstance(value, int):
        return grouped(value)
    if isinstance(value, Mapping):
        return "ReadOnly({" + ", ".join(f"{quoted(key)}: {quoted(item)}" for key, item in value.items()) + "})"
    return f"({', '.join(map(_flat, value))}{',' if len(value) == 1 else ''})"


def _pieces(text: str, width: int) -> list[str]:
    """``text`` cut after spaces into pieces whose literals take at most ``width`` columns."""
    pieces = [""]
    for word in text.split(" "):
        longer = pieces[-1] + word
        if pieces[-1] and len(quoted(longer)) > width:
            pieces.append("")
        pieces[-1] += word + " "
    pieces[-1] = pieces[-1][:-1]
    return [piece for piece in pieces if piece]


def grouped(number: int) -> str:
    """A decimal number, its digits in groups of three from five digits on."""
    return f"{number:_}" if abs(number) >= 10_000 else str(number)


@dataclass(frozen=True)
class Lines:
    """Lines of a docstring that stay as they are, such as those of an example."""

    lines: tuple[str, ...]


Block = Union[str, Lines, tuple[str, Sequence[tuple[str, str]]]]


def docstring(summary: str, *blocks: Block, indent: int = 0) -> str:
    """A docstring with its quotes; a block is a paragraph, or a title with named entries. Empty blocks are left out."""
    pad = " " * indent
    lines = [wrapped(_in_docstring(summary), WIDTH - (3 if not any(blocks) else 0), pad, f'{pad}"""')]
    for block in blocks:
        if isinstance(block, str):
            lines += ["", wrapped(_in_docstring(block), WIDTH, pad)] if block else []
        elif isinstance(block, Lines):
            lines += ["", *(f"{pad}    {_in_docstring_line(line)}" for line in block.lines)] if block.lines else []
        elif block[1]:
            entries = (wrapped(_in_docstring(text), WIDTH, f"{pad}        ", f"{pad}    {name}: ") for name, text in block[1])
            lines += ["", f"{pad}{block[0]}:", *entries]
    text = "\n".join(lines)
    if "\n" in text:
        return f'{text}\n{pad}"""'
    open_quote = _OPEN_QUOTE.search(text)
    return (f'{text[:-1]}\\"' if open_quote else text) + '"""'


def _in_docstring_line(line: str) -> str:
    """A line whose indentation stays."""
    return line[: len(line) - len(line.lstrip())] + _in_docstring(line)


def _in_docstring(text: str) -> str:
    return plain(text).replace("\\", "\\\\").replace('"""', '\\"\\"\\"')



def expression(value: Expression, names: Mapping[str, str], owner: str) -> str:
    """The expression with each parameter as an attribute of ``owner``."""
    renamed = value.renamed(names)
    if value.constant > 0 and all(term.sign < 0 for term in value.terms):
        parts = Expression(0, tuple(replace(term, sign=1) for term in renamed.terms)).render(prefix=f"{owner}.", power="(1 << {})")
        return f"{value.constant} - {parts.replace(' + ', ' - ')}"
    return renamed.render(prefix=f"{owner}.", power="(1 << {})")


def operand(text: str) -> str:
    """``text`` in parentheses where it is more than a name, a number or something in parentheses."""
    return text if text.replace(".", "_").replace("_", "a").isalnum() or _is_enclosed(text) else f"({text})"


def receiver(text: str) -> str:
    """``text`` in parentheses where a method called on it would else take only its end."""
    name = _WORD.match(text)
    return text if name is not None and _is_enclosed(text[name.end() :]) else operand(text)


def bare(text: str) -> str:
    """``text`` without parentheses around the whole of it."""
    return text[1:-1] if _is_enclosed(text) else text


def _is_enclosed(text: str) -> bool:
    """Whether the parenthesis that opens at the beginning closes at the end."""
    if not text.startswith("("):
        return False
    depth = 0
    for index, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if not depth:
            return index == len(text) - 1
    return False


def chain(start: str, terms: Sequence[str], indent: int) -> str:
    """A statement that ORs the terms together: on one line where that stays readable, else a term a line."""
    flat = f"{' ' * indent}{start}{' | '.join(terms) or '0'}"
    if len(terms) < 2 or len(flat) <= 100:
        return flat
    pad = " " * (indent + 4)
    return "\n".join([f"{' ' * indent}{start}(", *(f"{pad}{'| ' if index else ''}{term}" for index, term in enumerate(terms)), f"{' ' * indent})"])


_NOT_CODE = re.compile(r'"""(?:\\.|[^\\])*?"""|"(?:\\.|[^"\\\n])*"|#[^\n]*', re.DOTALL)
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def used_names(source: str) -> set[str]:
    """The words of ``source`` outside of texts and comments."""
    return set(_WORD.findall(_NOT_CODE.sub(" ", source)))
