"""Statements about a device, which consist of parts without markup, and text for numbers with units."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from enum import Enum

from ..model import PrintedTimeout, Sources, Timeout, Verdict, cite
from ..model.expressions import Expression
from ..model.record import dataclass
from .plain_text import count_with_unit as count_with_unit
from .plain_text import group_digits as group_digits
from .plain_text import with_unit as with_unit

_TIMEOUT_RULE_IN_WORDS = {"follows_clock": "varies with the clock", "fixed": "fixed"}
#: Verdicts on the position as clauses.
VERDICT_CLAUSES = {
    Verdict.NOT_USABLE: "the position is not usable",
    Verdict.USABLE_WITH_WARNING: "the position is usable with a warning",
    Verdict.USABLE: "the position is usable",
    Verdict.UNKNOWN: "no bit of this frame confirms that the position is usable",
}
_LANGUAGE_NAMES = {
    "de": "German",
    "en": "English",
    "es": "Spanish",
    "fr": "French",
    "it": "Italian",
    "ja": "Japanese",
    "zh": "Chinese",
}


def hertz(value: int) -> str:
    """Return a frequency in the largest unit that gives at least 1, such as ``2.5 MHz``."""
    for factor, unit in ((1_000_000, "MHz"), (1_000, "kHz")):
        if value >= factor:
            return f"{value / factor:g} {unit}"
    return f"{value} Hz"


def volts(millivolts: int) -> str:
    """Return a voltage in volts, such as ``4.75 V``."""
    return f"{millivolts / 1000:g} V"


def time_text(microseconds: int) -> str:
    """Return a time in the largest unit that gives a whole number: 1500 is ``1500 µs``, and 2000 is ``2 ms``."""
    for factor, unit in ((1_000_000, "s"), (1_000, "ms")):
        if microseconds >= factor and microseconds % factor == 0:
            return f"{microseconds // factor} {unit}"
    return f"{microseconds} µs"


def nanoseconds(value_ns: int) -> str:
    """Return a time in ns or, from 1 µs, in µs. A whole number of µs can also be returned in ms or s."""
    if value_ns % 1000 == 0:
        return time_text(value_ns // 1000)
    return f"{value_ns / 1000:g} µs" if value_ns > 1000 else f"{value_ns} ns"


def printed_timeout_words(printed: PrintedTimeout) -> str:
    """Return an example of a timeout from a manual, with its clock: ``7.5 µs at 200 kHz``."""
    return f"{nanoseconds(printed.timeout_ns)} at {hertz(printed.clock_hz)}"


def timeout_words(timeout: Timeout) -> str:
    """Return the rule and limits of a timeout, such as ``1.5 clock periods, at most 20 µs``.

    If the manual does not give a number of clock periods, its examples follow: ``fixed, 7.5 µs at 200 kHz``.
    """
    if timeout.half_clock_periods is None:
        rule_and_limits = [_TIMEOUT_RULE_IN_WORDS.get(timeout.rule, timeout.rule)]
    else:
        rule_and_limits = [f"{timeout.half_clock_periods / 2:g} clock periods"]
    if timeout.typical_ns is not None:
        rule_and_limits.append(f"typically {nanoseconds(timeout.typical_ns)}")
    if timeout.at_most_ns is not None:
        rule_and_limits.append(f"at most {nanoseconds(timeout.at_most_ns)}")
    if timeout.half_clock_periods is None:
        # Without a number of clock periods, these are the only values known.
        rule_and_limits += [printed_timeout_words(printed) for printed in timeout.printed]
    return ", ".join(rule_and_limits)


def language_name(key: str) -> str:
    """Return the English name of a language, or its code if the name is not listed: ``it`` becomes ``Italian``."""
    return _LANGUAGE_NAMES.get(key, key)


def as_sentence(text: str) -> str:
    """Return the text with a period at its end, unless it is empty or already ends with punctuation."""
    return text if not text or text.endswith((".", "!", "?", ":")) else f"{text}."


@dataclass(frozen=True, slots=True)
class CodeText:
    """Text that is shown as code, such as a name, bytes, or an order code."""

    text: str


@dataclass(frozen=True, slots=True)
class Reference:
    """Reference to an item of a device, such as a register, a CRC or a procedure, which is its ``kind``.

    ``name`` is its name in the spec, such as ``configuration.enable_preset`` for a field of a register. ``title`` is
    the name for readers of the manual.
    """

    kind: str
    name: str
    title: str

    @property
    def anchor(self) -> str:
        """Anchor of the item's description on a page."""
        return f"{self.kind}-{self.name.partition('.')[0]}"


@dataclass(frozen=True, slots=True)
class Hex:
    """Number that is shown in hexadecimal, with at least ``digits`` digits: ``3Fh``."""

    number: Expression
    digits: int = 2


@dataclass(frozen=True, slots=True)
class Amount:
    """Number with its unit in the plural, which becomes singular if the number is 1: ``1 revolution``."""

    number: Expression
    unit: str


class Level(Enum):
    """Level of a flag in a statement. Docstrings write it as ``True`` or ``False``."""

    ACTIVE = "Active"
    INACTIVE = "Inactive"
    #: ``ACTIVE`` within a sentence.
    WHILE_ACTIVE = "active"


#: An expression with parameters is a separate part, because some outputs know the values of the parameters.
TextPart = str | CodeText | Reference | Expression | Amount | Hex | Level


@dataclass(frozen=True, slots=True)
class Statement:
    """Sentence without its period, or a fact with a label, such as ``100 kHz to 4 MHz`` with the label ``Clock``.

    A statement with other statements in ``below`` is only a heading for them. Outputs put them on separate lines if
    they can.
    """

    parts: tuple[TextPart, ...]
    label: str = ""
    source: Sources = ()
    #: Short form, for outputs that print the full statement elsewhere. None if there is no short form.
    brief: str | None = None
    below: tuple[Statement, ...] = ()


def statement(*parts: TextPart, label: str = "", source: Sources = ()) -> Statement:
    """Return a statement that consists of these parts."""
    return Statement(parts, label, source)


def spec_text(text: str, label: str = "", source: Sources = ()) -> Iterator[Statement]:
    """Yield a statement with text from a spec, or nothing if the text is empty."""
    if text:
        yield statement(text, label=label, source=source)


def list_parts(items: Sequence[TextPart], last: str = " and ") -> Iterator[TextPart]:
    """Yield the items of a list with separators between them: ``a, b and c``. ``last`` is the last separator."""
    for index, part in enumerate(items):
        is_last = index == len(items) - 1
        if index > 0:
            separator = last if is_last else ", "
            yield separator
        yield part


def join_groups(groups: Iterable[Sequence[TextPart]], between: str = ", ") -> Iterator[TextPart]:
    """Yield the parts of all groups, with the separator ``between`` between two groups. Empty groups are skipped."""
    is_first = True
    for group in groups:
        if not group:
            continue
        if not is_first:
            yield between
        is_first = False
        yield from group


def _bracketed_sources(sources: Sources) -> str:
    """Return the sources in brackets, such as ``[5.3 p.22]``, or "" if there are none."""
    return f"[{cite(sources)}]" if sources else ""


@dataclass(frozen=True)
class Style:
    """Functions that write each kind of part in the syntax of an output.

    ``text`` also escapes the characters that have a meaning in this syntax.
    """

    text: Callable[[str], str]
    code: Callable[[str], str]
    ref: Callable[[Reference], str]
    cited: Callable[[Sources], str] = _bracketed_sources
    #: Function that replaces parameters of an expression with their values, for an output about one order code.
    resolve: Callable[[Expression], Expression] = lambda expression: expression
    level: Callable[[Level], str] = lambda level: level.value

    def phrase(self, statement: Statement) -> str:
        """Return the parts of a statement as text, without its label, its source and a period."""
        return "".join(map(self._write_part, statement.parts))

    def sentence(self, statement: Statement) -> str:
        """Return the statement as a sentence: ``Clock: 100 kHz to 4 MHz [5.3].``

        The period follows the source. It is omitted if the text in front of the source already ends with punctuation.
        """
        if statement.below:
            return " ".join(self.lines(statement))
        label = f"{self.text(statement.label)}: " if statement.label else ""
        phrase = self.phrase(statement)
        source = self.cited(statement.source)
        if not source:
            return f"{label}{as_sentence(phrase)}"
        # as_sentence() changes only a text without punctuation at its end.
        ends_with_punctuation = as_sentence(phrase) == phrase
        return f"{label}{phrase} {source}" if ends_with_punctuation else f"{label}{phrase} {source}."

    def head(self, statement: Statement) -> str:
        """Return the heading of a statement with others below it: its label and source, ``Erratum: … (open) [5.3]``."""
        return f"{self.text(statement.label)} {self.cited(statement.source)}".strip(" ")

    def lines(self, statement: Statement) -> list[str]:
        """Return the statement as a single line, or as its heading with one more line for each statement below it."""
        if not statement.below:
            return [self.sentence(statement)]
        return [f"{self.head(statement)}:", *map(self.sentence, statement.below)]

    def paragraph(self, statements: Iterable[Statement]) -> str:
        """Return several statements as one paragraph."""
        return " ".join(filter(None, map(self.sentence, statements)))

    def number(self, expression: Expression) -> str:
        """Return an expression as a number if all its parameters have known values, or else as code."""
        resolved = self.resolve(expression)
        if resolved.is_constant:
            return group_digits(resolved.constant)
        return self.code(resolved.render())

    def _write_part(self, part: TextPart) -> str:
        """Return one part of a statement in the syntax of the output."""
        match part:
            case str():
                return self.text(part)
            case CodeText(text):
                return self.code(text)
            case Reference():
                return self.ref(part)
            case Expression():
                return self.number(part)
            case Amount(expression, unit):
                return with_unit(self.number(expression), self.text(unit))
            case Hex(expression, digits):
                resolved = self.resolve(expression)
                if resolved.is_constant:
                    return f"{resolved.constant:0{digits}X}h"
                return self.code(resolved.render())
            case Level():
                return self.level(part)


#: Style for readers who know the names in the spec, such as on a terminal.
PLAIN_STYLE = Style(text=str, code=str, ref=lambda ref: ref.name)
#: Style for readers who know the names in the manual, such as in a C comment.
TITLE_STYLE = Style(text=str, code=str, ref=lambda ref: ref.title)
#: Style for docstrings, where names are code and a flag is a Boolean.
DOCSTRING_STYLE = Style(
    text=str,
    code=lambda text: f"``{text}``",
    ref=lambda ref: f"``{ref.name}``",
    level=lambda level: f"{level is not Level.INACTIVE}",
)
