"""Statements about a device as parts, in no markup; each output has a style that writes the parts in its own way."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum

from ..model import Sources, cite
from ..model.expressions import Expression
from .words import number, sentence


@dataclass(frozen=True, slots=True)
class Code:
    """A name or bytes, as they stand in code or on a label."""

    text: str


@dataclass(frozen=True, slots=True)
class Ref:
    """Another thing of the device: a register, CRC, procedure, erratum.

    ``name`` is what the spec calls it, such as ``configuration.enable_preset`` for a field of a register; ``title`` is
    what a person calls it.
    """

    kind: str
    name: str
    title: str

    @property
    def anchor(self) -> str:
        """What a page calls the place where the thing is described."""
        return f"{self.kind}-{self.name.partition('.')[0]}"


@dataclass(frozen=True, slots=True)
class Hex:
    """A number that manuals print in hexadecimal, in at least so many digits: ``3Fh``."""

    number: Expression
    digits: int = 2


class Level(Enum):
    """What a flag is; an output that gives it as a truth value says so."""

    ACTIVE = "Active"
    INACTIVE = "Inactive"
    #: The first within a sentence.
    WHILE_ACTIVE = "active"


#: An expression over parameters is a part: some outputs know what the parameters are.
Part = str | Code | Ref | Expression | Hex | Level


@dataclass(frozen=True, slots=True)
class Said:
    """A sentence without its full stop; with a label, the value of a fact: ``Clock``, 100 kHz to 4 MHz."""

    parts: tuple[Part, ...]
    label: str = ""
    source: Sources = ()
    #: What of it stays here where an output tells the whole elsewhere; None for what is told where it is.
    brief: str | None = None


def said(*parts: Part, label: str = "", source: Sources = ()) -> Said:
    """The statement that these parts make."""
    return Said(parts, label, source)


def told(text: str, label: str = "", source: Sources = ()) -> Iterator[Said]:
    """What the spec itself says in words, if it does."""
    if text:
        yield said(text, label=label, source=source)


def listed(items: Sequence[Part], last: str = " and ") -> Iterator[Part]:
    """The items as parts: ``a, b and c``."""
    for index, item in enumerate(items):
        if index:
            yield last if index == len(items) - 1 else ", "
        yield item


def parted(groups: Iterable[Sequence[Part]], between: str = ", ") -> Iterator[Part]:
    """The groups of parts one after the other, the empty ones left out."""
    for index, group in enumerate([group for group in groups if group]):
        if index:
            yield between
        yield from group


def _bracketed(sources: Sources) -> str:
    return f"[{cite(sources)}]" if sources else ""


@dataclass(frozen=True)
class Style:
    """How an output writes each kind of part; a style escapes what its language would take for its own."""

    text: Callable[[str], str]
    code: Callable[[str], str]
    ref: Callable[[Ref], str]
    cited: Callable[[Sources], str] = _bracketed
    #: What an expression comes to, in an output about one order code.
    resolve: Callable[[Expression], Expression] = lambda expression: expression
    level: Callable[[Level], str] = lambda level: level.value

    def phrase(self, item: Said) -> str:
        """The parts alone, without label, source and full stop."""
        return "".join(map(self._part, item.parts))

    def sentence(self, item: Said) -> str:
        """The statement in running text: ``Clock: 100 kHz to 4 MHz [5.3].``"""
        label = f"{self.text(item.label)}: " if item.label else ""
        phrase, source = self.phrase(item), self.cited(item.source)
        if not source:
            return label + sentence(phrase)
        return f"{label}{phrase} {source}" if sentence(phrase) == phrase else f"{label}{phrase} {source}."

    def paragraph(self, items: Iterable[Said]) -> str:
        """Several statements one after the other."""
        return " ".join(filter(None, map(self.sentence, items)))

    def number(self, expression: Expression) -> str:
        """A number, or an expression as code."""
        found = self.resolve(expression)
        return number(found.constant) if found.is_constant else self.code(found.render())

    def _part(self, part: Part) -> str:
        match part:
            case str():
                return self.text(part)
            case Code(text):
                return self.code(text)
            case Ref():
                return self.ref(part)
            case Expression():
                return self.number(part)
            case Hex(expression, digits):
                found = self.resolve(expression)
                return f"{found.constant:0{digits}X}h" if found.is_constant else self.code(found.render())
            case Level():
                return self.level(part)


#: For a reader who knows things by their names in the spec, such as on a terminal.
BY_NAME = Style(text=str, code=str, ref=lambda ref: ref.name)
#: For a reader who knows things by what the manual calls them, such as in a comment.
BY_TITLE = Style(text=str, code=str, ref=lambda ref: ref.title)
#: For docstrings, where names stand as code, and where a flag is a truth value.
AS_LITERAL = Style(
    text=str,
    code=lambda text: f"``{text}``",
    ref=lambda ref: f"``{ref.name}``",
    level=lambda level: f"{level is not Level.INACTIVE}",
)
