"""Statements about a device, which consist of parts without markup, how to write them as Markdown, and units."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from enum import Enum
from functools import lru_cache

from ..model import PrintedTimeout, Source, Sources, Timeout, Verdict, cite
from ..model.expressions import Expression
from ..model.record import dataclass
from . import count_with_unit as count_with_unit
from . import group_digits as group_digits
from . import one_line, text_on_one_line
from . import with_unit as with_unit

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
    for hz_per_unit, unit in ((1_000_000, "MHz"), (1_000, "kHz")):
        if value >= hz_per_unit:
            return f"{value / hz_per_unit:g} {unit}"
    return f"{value} Hz"


def volts(millivolts: int) -> str:
    """Return a voltage in volts, such as ``4.75 V``."""
    return f"{millivolts / 1000:g} V"


def time_text(microseconds: int) -> str:
    """Return a time in the largest unit that gives a whole number: 1500 is ``1500 µs``, and 2000 is ``2 ms``."""
    for microseconds_per_unit, unit in ((1_000_000, "s"), (1_000, "ms")):
        if microseconds >= microseconds_per_unit and microseconds % microseconds_per_unit == 0:
            return f"{microseconds // microseconds_per_unit} {unit}"
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


def language_name(language_code: str) -> str:
    """Return the English name of a language, or its code if the name is not listed: ``it`` becomes ``Italian``."""
    return _LANGUAGE_NAMES.get(language_code, language_code)


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

    A statement with other statements in ``statements_below`` is only a heading for them. Outputs put them on separate
    lines if they can.
    """

    parts: tuple[TextPart, ...]
    label: str = ""
    source: Sources = ()
    #: Short form, for outputs that print the full statement elsewhere. None if there is no short form.
    brief: str | None = None
    statements_below: tuple[Statement, ...] = ()


def statement(*parts: TextPart, label: str = "", source: Sources = ()) -> Statement:
    """Return a statement that consists of these parts."""
    return Statement(parts, label, source)


def spec_text(text: str, label: str = "", source: Sources = ()) -> Iterator[Statement]:
    """Yield a statement with text from a spec, or nothing if the text is empty."""
    if text:
        yield statement(text, label=label, source=source)


def list_parts(parts: Sequence[TextPart], last: str = " and ") -> Iterator[TextPart]:
    """Yield the items of a list with separators between them: ``a, b and c``. ``last`` is the last separator."""
    for index, part in enumerate(parts):
        is_last = index == len(parts) - 1
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
        if statement.statements_below:
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
        if not statement.statements_below:
            return [self.sentence(statement)]
        return [f"{self.head(statement)}:", *map(self.sentence, statement.statements_below)]

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


_MARKUP_ESCAPES = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;"} | {mark: f"\\{mark}" for mark in r"\`*[]|~$"})
_MARKUP_ENTITIES = {ord(mark): f"&#{ord(mark)};" for mark in r"\`*[]|~$"}
#: An underscore starts emphasis at the edge of a word, but not inside it.
_EDGE_UNDERSCORE = re.compile(r"(?<![A-Za-z0-9])_|_(?![A-Za-z0-9])")
#: Columns of a wrapped paragraph.
_PARAGRAPH_WIDTH = 132
_BLOCK_START = re.compile(r"^(\d+)([.)])(?=\s|$)|^([-+#=])")


def escape(value: object) -> str:
    """Return one line of text with all Markdown and HTML markup escaped."""
    return _escape_markdown(text_on_one_line(value))


@lru_cache(4096)
def _escape_markdown(value: str) -> str:
    """Return one line of text with its markup escaped, and spaces at its ends kept."""
    return _EDGE_UNDERSCORE.sub(r"\\_", value.translate(_MARKUP_ESCAPES))


def code_span(value: object) -> str:
    """Return a code span that is safe inside a table, where a vertical bar would end the cell."""
    return _code_span(text_on_one_line(value))


@lru_cache(4096)
def _code_span(code_text: str) -> str:
    """Return a code span for text on one line, or "" for an empty text."""
    if not code_text:
        return ""
    # The fence is longer than any run of backticks in the text.
    longest_backtick_run = max(map(len, re.findall("`+", code_text)), default=0)
    fence = "`" * (longest_backtick_run + 1)
    touches_fence = code_text.startswith("`") or code_text.endswith("`")
    # A space, which Markdown removes, separates backticks of the text from the fence.
    space = " " if touches_fence else ""
    return f"{fence}{space}{code_text}{space}{fence}".replace("|", "\\|")


def wrap_markdown(value: str) -> str:
    """Return a paragraph of Markdown as wrapped lines. No line starts a list, a heading or a rule by accident."""
    lines = textwrap.wrap(value, _PARAGRAPH_WIDTH, break_long_words=False, break_on_hyphens=False)
    return "\n".join(_BLOCK_START.sub(_escaped_start, line) for line in lines)


def _escaped_start(match_of_start: re.Match[str]) -> str:
    """Return the first characters of a line with the sign that would start a list, heading or rule escaped.

    For example, ``1.`` becomes ``1\\.``, and ``-`` becomes ``\\-``.
    """
    item_number, sign_after_number, other_sign = match_of_start.groups()
    return f"{item_number}\\{sign_after_number}" if item_number else f"\\{other_sign}"


def citation(sources: Sources) -> str:
    """Return the sources as ``§6.4 p.35, it: §6.4 p.36``."""
    return escape(_cite_with_section_signs(sources))


def cited_html(sources: Sources) -> str:
    """Return the sources for an HTML element."""
    return escape_html(_cite_with_section_signs(sources))


def _cite_with_section_signs(sources: Sources) -> str:
    """Return the sources in one line, with § before each section number."""
    return cite(tuple(map(_with_section_sign, sources)))


def _with_section_sign(source: Source) -> Source:
    """Return a source with § before its section if that is a number. Other sections are titles."""
    has_section_number = _SECTION_NUMBER.match(source.section) is not None
    return replace(source, section=f"§{source.section}") if has_section_number else source


#: The number of a section, unlike the number of a register, such as 0x07.
_SECTION_NUMBER = re.compile(r"\d+(?![\dx])")


def escape_html(value: object) -> str:
    """Return one line of text for an HTML element or attribute, with Markdown characters escaped as entities."""
    from html import escape as escape_xml  # Only pages need it, and ``decode`` starts faster without it.

    return escape_xml(text_on_one_line(value)).translate(_MARKUP_ENTITIES)


def markdown_link(label: str, target: str) -> str:
    """Return a link whose ``label`` is already Markdown."""
    return f"[{label}]({target})"


def link_list(links: Iterable[str]) -> str:
    """Return links in one line. A dot separates them, because titles of errata contain commas."""
    return " · ".join(links)


def anchor_of(name: str) -> str:
    """Return the HTML anchor that links to ``name`` refer to."""
    return f'<a id="{name}"></a>'


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table, with the columns omitted that are empty in all rows, or "" if no column remains."""
    row_lists = [list(row) for row in rows]
    filled_columns = [column for column in range(len(headings)) if _has_text(row_lists, column)]
    if not filled_columns:
        return ""
    separator_row = ["---"] * len(headings)
    lines = []
    for row in (headings, separator_row, *row_lists):
        cells = [row[column] for column in filled_columns]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _has_text(rows: Sequence[Sequence[str]], column: int) -> bool:
    """Return whether any row has text in a column."""
    return any(row[column] for row in rows)


def join_filled(texts: Iterable[str], between: str = "<br>") -> str:
    """Join the parts that are not empty."""
    return between.join(text for text in texts if text)


def reference(ref: Reference) -> str:
    """Return a name with a link to its description on this page, or to a manual procedure on the hardware page."""
    if ref.kind == "by-hand":
        return markdown_link(escape(ref.title), f"hardware.md#{ref.anchor}")
    return markdown_link(code_span(ref.name), f"#{ref.anchor}")


#: Style for statements on a Markdown page.
MARKDOWN = Style(
    text=lambda part: _escape_markdown(one_line(part)),
    code=code_span,
    ref=reference,
    cited=lambda sources: f"({citation(sources)})" if sources else "",
)
