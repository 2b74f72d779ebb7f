"""Statements about a device, composed of parts without markup, and the wording of numbers with units."""

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
#: Verdicts on the position, as clauses.
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
    """Return a frequency in the largest unit of which it has at least one, such as ``2.5 MHz``."""
    for factor, unit in ((1_000_000, "MHz"), (1_000, "kHz")):
        if value >= factor:
            return f"{value / factor:g} {unit}"
    return f"{value} Hz"


def volts(millivolts: int) -> str:
    return f"{millivolts / 1000:g} V"


def time_text(value: int) -> str:
    """Return a time in the largest unit in which it is a whole number: 1500 is ``1500 µs``, and 2000 is ``2 ms``."""
    for factor, unit in ((1_000_000, "s"), (1_000, "ms")):
        if value >= factor and value % factor == 0:
            return f"{value // factor} {unit}"
    return f"{value} µs"


def nanoseconds(value: int) -> str:
    """Return a time in ns or, if it is at least 1 µs, in µs. Whole numbers of µs may also be in ms or s."""
    if value % 1000 == 0:
        return time_text(value // 1000)
    return f"{value / 1000:g} µs" if value > 1000 else f"{value} ns"


def printed_timeout_words(printed: PrintedTimeout) -> str:
    """Return a time-out that a manual prints, with its clock."""
    return f"{nanoseconds(printed.timeout_ns)} at {hertz(printed.clock_hz)}"


def timeout_words(timeout: Timeout) -> str:
    """Return the rule and limits of a time-out, such as ``1.5 clock periods, at most 20 µs``.

    Without a number of clock periods, the values in the manual follow.
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
        # Without a rule, only the values printed in the manual are known.
        rule_and_limits += [printed_timeout_words(printed) for printed in timeout.printed]
    return ", ".join(rule_and_limits)


def language_name(key: str) -> str:
    """Return the name of a language, or its code if there is no name for it."""
    return _LANGUAGE_NAMES.get(key, key)


def as_sentence(text: str) -> str:
    """Return the text with a full stop, unless it already ends with punctuation."""
    return text if not text or text.endswith((".", "!", "?", ":")) else f"{text}."


@dataclass(frozen=True, slots=True)
class CodeText:
    """Name or bytes as written in code or on a label."""

    text: str


@dataclass(frozen=True, slots=True)
class Reference:
    """Reference to another item of the device: a register, a CRC, a procedure or an erratum.

    ``name`` is the name in the spec, such as ``configuration.enable_preset`` for a field of a register. ``title`` is
    the name shown to people.
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
    """Number that manuals print in hexadecimal, with at least ``digits`` digits: ``3Fh``."""

    number: Expression
    digits: int = 2


@dataclass(frozen=True, slots=True)
class Amount:
    """Number and unit, which is in the plural unless the number is 1: ``1 revolution``, ``65,536 revolutions``."""

    number: Expression
    unit: str


class Level(Enum):
    """State of a flag, which some outputs write as a Boolean."""

    ACTIVE = "Active"
    INACTIVE = "Inactive"
    #: ``ACTIVE`` within a sentence.
    WHILE_ACTIVE = "active"


#: An expression with parameters is a separate part, because some outputs know the values of the parameters.
TextPart = str | CodeText | Reference | Expression | Amount | Hex | Level


@dataclass(frozen=True, slots=True)
class Statement:
    """Sentence without a full stop, or a labelled fact such as 100 kHz to 4 MHz with the label ``Clock``.

    A statement with ``below`` is a head followed by labelled statements. Outputs put these on separate lines if they
    can.
    """

    parts: tuple[TextPart, ...]
    label: str = ""
    source: Sources = ()
    #: Short form for an output that prints the full statement elsewhere. None if there is no short form.
    brief: str | None = None
    below: tuple[Statement, ...] = ()


def statement(*parts: TextPart, label: str = "", source: Sources = ()) -> Statement:
    """Return the statement formed by these parts."""
    return Statement(parts, label, source)


def spec_text(text: str, label: str = "", source: Sources = ()) -> Iterator[Statement]:
    """Yield text from the spec unless it is empty."""
    if text:
        yield statement(text, label=label, source=source)


def list_parts(items: Sequence[TextPart], last: str = " and ") -> Iterator[TextPart]:
    """Yield the items as the parts of a list: ``a, b and c``."""
    for index, part in enumerate(items):
        is_last = index == len(items) - 1
        if index > 0:
            separator = last if is_last else ", "
            yield separator
        yield part


def join_groups(groups: Iterable[Sequence[TextPart]], between: str = ", ") -> Iterator[TextPart]:
    """Yield the parts of all non-empty groups, with the separator ``between`` after each group except the last."""
    is_first = True
    for group in groups:
        if not group:
            continue
        if not is_first:
            yield between
        is_first = False
        yield from group


def _bracketed_sources(sources: Sources) -> str:
    return f"[{cite(sources)}]" if sources else ""


@dataclass(frozen=True)
class Style:
    """Functions that write each kind of part for an output, with the syntax of its language escaped."""

    text: Callable[[str], str]
    code: Callable[[str], str]
    ref: Callable[[Reference], str]
    cited: Callable[[Sources], str] = _bracketed_sources
    #: Function that fills known values into an expression, for an output about one order code.
    resolve: Callable[[Expression], Expression] = lambda expression: expression
    level: Callable[[Level], str] = lambda level: level.value

    def phrase(self, statement: Statement) -> str:
        """Return the parts without a label, a source and a full stop."""
        return "".join(map(self._write_part, statement.parts))

    def sentence(self, statement: Statement) -> str:
        """Return the statement as a sentence: ``Clock: 100 kHz to 4 MHz [5.3].``

        The full stop is at the very end. It is left out if the text in front of the source already ends with a full
        stop.
        """
        if statement.below:
            return " ".join(self.lines(statement))
        label = f"{self.text(statement.label)}: " if statement.label else ""
        phrase = self.phrase(statement)
        source = self.cited(statement.source)
        if not source:
            return f"{label}{as_sentence(phrase)}"
        # ``sentence`` adds a full stop only to a text without punctuation at its end.
        ends_with_punctuation = as_sentence(phrase) == phrase
        return f"{label}{phrase} {source}" if ends_with_punctuation else f"{label}{phrase} {source}."

    def head(self, statement: Statement) -> str:
        """Return the label and source of a statement with other statements below it: ``Erratum start (open) [5.3]``."""
        return f"{self.text(statement.label)} {self.cited(statement.source)}".strip(" ")

    def lines(self, statement: Statement) -> list[str]:
        """Return the statement as one line, or its head and a line for each statement below it."""
        if not statement.below:
            return [self.sentence(statement)]
        return [f"{self.head(statement)}:", *map(self.sentence, statement.below)]

    def paragraph(self, items: Iterable[Statement]) -> str:
        """Return several statements as one paragraph."""
        return " ".join(filter(None, map(self.sentence, items)))

    def number(self, expression: Expression) -> str:
        """Return a number, or as code an expression that still contains parameters after known values are filled in."""
        resolved = self.resolve(expression)
        if resolved.is_constant:
            return group_digits(resolved.constant)
        return self.code(resolved.render())

    def _write_part(self, part: TextPart) -> str:
        """Return a part of a statement in the syntax of the output."""
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


#: For readers who know the names used in the spec, such as on a terminal.
PLAIN_STYLE = Style(text=str, code=str, ref=lambda ref: ref.name)
#: For readers who know the names used in the manual, such as in a comment.
TITLE_STYLE = Style(text=str, code=str, ref=lambda ref: ref.title)
#: For docstrings, where names are code and a flag is a Boolean.
DOCSTRING_STYLE = Style(
    text=str,
    code=lambda text: f"``{text}``",
    ref=lambda ref: f"``{ref.name}``",
    level=lambda level: f"{level is not Level.INACTIVE}",
)
