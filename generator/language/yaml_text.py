"""The text of YAML: values of unquoted scalars, explanations of syntax errors, and typos that are fixed while reading.

PyYAML reports where its parser stopped. An open quote or bracket is higher up, often by many lines. Typos are fixed
because a comma in text would look like an unknown key, and a missing dash like an item full of duplicate keys.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import yaml

from .problems import quoted

_NULL_WORDS = frozenset(("", "~", "null", "Null", "NULL"))
_BOOLEAN_WORDS = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
INTEGER_TEXT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT_TEXT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_SPECIAL_FLOAT = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


def resolve_scalar(scalar_text: str) -> str | int | float | bool | None:
    """Return the value of an unquoted scalar: None, a boolean, a number or text, by the core schema of YAML 1.2."""
    if scalar_text in _NULL_WORDS:
        return None
    if scalar_text in _BOOLEAN_WORDS:
        return _BOOLEAN_WORDS[scalar_text]
    if INTEGER_TEXT.fullmatch(scalar_text):
        base = {"0x": 16, "0o": 8}.get(scalar_text[:2], 10)
        return int(scalar_text, base)
    if _FLOAT_TEXT.fullmatch(scalar_text):
        return float(scalar_text)
    # Python writes infinities and NaN without the point.
    return float(scalar_text.replace(".", "")) if _SPECIAL_FLOAT.fullmatch(scalar_text) else scalar_text


def _is_text(scalar: str) -> bool:
    """Return True if an unquoted scalar is text, not a number or the like."""
    return isinstance(resolve_scalar(scalar), str)


YAML_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
LINE_BREAK = re.compile(r"\r\n|\r|\n")
_NO_COMMA = "a comma or closing bracket is missing before this"
#: Spaces of word processors and PDF files, where YAML needs an ordinary one: in the indentation or after a colon.
_ODD_SPACE = re.compile(r"(?:^|(?<=[:, -]))[\u00a0\u2000-\u200b\u202f\u3000\ufeff]")
_COMMENT_START = re.compile(r"\s#")


class YamlMistake(NamedTuple):
    """The mistake that made a text invalid. Line and column count from 1."""

    line: int
    column: int
    message: str


def explain(error: yaml.MarkedYAMLError, yaml_text: str) -> YamlMistake:
    """Return the likely mistake behind an error of the parser.

    The parser's ``problem_mark`` is where it stopped, and its ``context_mark`` where the open value begins.
    """
    lines = LINE_BREAK.split(yaml_text)
    problem = error.problem or "not understood"
    context = error.context or ""
    opening_mark: Any = error.context_mark
    stop_mark: Any = error.problem_mark or opening_mark
    marked_lines = [mark.line for mark in (opening_mark, stop_mark) if mark is not None]
    odd_space_mistake = _find_odd_space(lines, marked_lines)
    if odd_space_mistake is not None:
        return odd_space_mistake
    # Here the parser stopped only at the end of its search for the colon.
    if opening_mark is not None and problem == "could not find expected ':'":
        return _mistake_at(opening_mark, _message_on_missing_colon(_character_at(lines, opening_mark)))
    if opening_mark is not None and "quoted scalar" in context and "end of stream" in problem:
        return _mistake_at(opening_mark, "the quote that opens here is never closed; close it on this line")
    # An earlier quote may have closed too late, so that the error is only a consequence.
    quoted_text = _find_last_quoted_text(yaml_text, stop_mark)
    if quoted_text is not None:
        return _mistake_at(quoted_text.start_mark, _message_on_quote(quoted_text))
    if opening_mark is not None and "flow" in context and "expected ','" in problem:
        is_on_one_line = stop_mark.line == opening_mark.line
        if is_on_one_line and not _COMMENT_START.search(lines[opening_mark.line], opening_mark.column):
            return _mistake_at(stop_mark, _NO_COMMA)
        return _mistake_at(opening_mark, _message_on_bracket(lines, opening_mark, stop_mark))
    character = _character_at(lines, stop_mark)
    line = 1 if stop_mark is None else stop_mark.line + 1
    is_at_end = line >= len(lines) and not character
    message = _describe_problem(problem, character, is_at_end)
    return YamlMistake(line=1, column=1, message=message) if stop_mark is None else _mistake_at(stop_mark, message)


def _find_odd_space(lines: list[str], line_indices: list[int]) -> YamlMistake | None:
    """Return the mistake of an unusual space in one of these lines, or in the line before. None if there is none.

    ``line_indices`` are the numbers of the lines, counted from 0.
    """
    for line_index in line_indices:
        for index in (line_index, line_index - 1):
            is_in_file = 0 <= index < len(lines)
            if not is_in_file:
                continue
            odd_space = _ODD_SPACE.search(lines[index])
            if odd_space is not None:
                character = f"U+{ord(odd_space[0]):04X}"
                message = (
                    f"the space {character} is not an ordinary space, so YAML reads it as text; replace it with one"
                )
                return YamlMistake(line=index + 1, column=odd_space.start() + 1, message=message)
    return None


def _mistake_at(mark: Any, message: str) -> YamlMistake:
    """Return a mistake at a mark of the parser, which counts lines and columns from 0."""
    return YamlMistake(line=mark.line + 1, column=mark.column + 1, message=message)


def _character_at(lines: list[str], mark: Any) -> str:
    """Return the character at a mark, or an empty string at the end of a line and of the file."""
    if mark is None or mark.line >= len(lines):
        return ""
    line: str = lines[mark.line]
    return line[mark.column : mark.column + 1]


def _message_on_missing_colon(character: str) -> str:
    """Return the message about a key without a colon. ``character`` is the first character of its value."""
    if character in ("'", '"'):
        return "the quote that opens here is not closed on this line; close it"
    return "a key has no colon, or the text of a value continues without indentation"


def _find_last_quoted_text(yaml_text: str, stop_mark: Any) -> Any:
    """Return the token of the last quoted text before an error if it may be the cause, otherwise None.

    ``stop_mark`` is the place where the parser stopped, or None. The text must end on the same line, and either span
    several lines or end exactly there.
    """
    last_quoted_text = None
    try:
        for token in yaml.scan(yaml_text, Loader=YAML_LOADER):
            token_start = (token.start_mark.line, token.start_mark.column)
            if stop_mark is None or token_start >= (stop_mark.line, stop_mark.column):
                break
            is_quoted = isinstance(token, yaml.ScalarToken) and token.style in ("'", '"')
            if is_quoted and token.end_mark.line == stop_mark.line:
                last_quoted_text = token
    except yaml.YAMLError:
        pass  # This is the error to explain. Everything before it has been scanned.
    if last_quoted_text is None:
        return None
    spans_lines = last_quoted_text.end_mark.line > last_quoted_text.start_mark.line
    ends_at_error = last_quoted_text.end_mark.column == stop_mark.column
    return last_quoted_text if spans_lines or ends_at_error else None


def _message_on_quote(token: Any) -> str:
    """Return the message about a quoted text that ends too late or too early."""
    if token.end_mark.line > token.start_mark.line:
        return f"the quote that opens here does not close until line {token.end_mark.line + 1}; close it on this line"
    if token.style == "'":
        return "an apostrophe inside '...' ends the text; put the text in double quotes"
    return 'a quote inside "..." ends the text; put the text in single quotes, or write \\" for the quote inside'


def _message_on_bracket(lines: list[str], opening_mark: Any, stop_mark: Any) -> str:
    """Return the message about a bracket that is not closed, or whose closing bracket is hidden by a comment.

    ``opening_mark`` is the place of the bracket, and ``stop_mark`` the place where the parser stopped.
    """
    bracket = _character_at(lines, opening_mark)
    closing_bracket = {"{": "}", "[": "]"}.get(bracket, "bracket")
    is_at_end = stop_mark.line >= len(lines) - 1 and not _character_at(lines, stop_mark)
    limit = "the end of the file" if is_at_end else f"line {stop_mark.line + 1}"
    problem = f"the '{bracket}' that opens here is not closed by {limit}"
    if _COMMENT_START.search(lines[opening_mark.line], opening_mark.column):
        return f"{problem}: a '#' after a space begins a comment; put the text in quotes"
    return f"{problem}; close it with '{closing_bracket}', or add the missing comma"


def _describe_problem(problem: str, character: str, at_end: bool) -> str:
    """Return the message for another problem of the parser, which stopped at ``character`` or at the file's end."""
    if character == "\t":
        return "tabs cannot be used for indentation; use spaces"
    is_reserved_character = (character and character in "@`") or (character == "%" and "token" in problem)
    if is_reserved_character:
        return f"an unquoted string cannot begin with '{character}'; put it in quotes"
    if "mapping values are not allowed" in problem:
        return "an unquoted string contains a colon and a space; put the string in quotes, or check the indentation"
    if "undefined alias" in problem:
        return "there is no anchor of this name before this alias"
    if "'-' indicator" in problem:
        return "each item of a list begins with '-'; put one before this, or check the indentation"
    if at_end or "end of stream" in problem:
        return f"the file ends unexpectedly ({problem}); a quote or bracket may not be closed"
    return f"{problem}; check the indentation, quotes and brackets here and just above"


_DIGITS = re.compile("[0-9]+")
_THREE_DIGITS = re.compile("[0-9]{3}")
#: Number of events to look ahead. A longer value is not a mistake.
_MOST_EVENTS_AHEAD = 2000

#: Called with an event, a rule and a message.
Complain = Callable[[Any, str, str], None]


@dataclass(slots=True)
class _Container:
    """An open map or list. ``node_count`` counts its keys and values so far."""

    is_map: bool
    is_flow: bool
    is_in_list: bool
    node_count: int = 0
    keys: dict[str, int] = field(default_factory=dict)

    @property
    def awaits_key(self) -> bool:
        return self.is_map and self.node_count % 2 == 0


class CorrectedEvents:
    """The events of a parser with mistakes fixed.

    Args:
        events: The events as they come.
        lines: The lines of the text.
        complain: Called for each mistake.
    """

    def __init__(self, events: Iterator[Any], lines: list[str], complain: Complain) -> None:
        self._events = events
        self._ahead: deque[Any] = deque()
        self._lines = lines
        self._complain = complain
        self._open_containers: list[_Container] = []

    def __iter__(self) -> Iterator[Any]:
        """Yield the events, with an item of a list split where its keys repeat, and texts after a comma skipped.

        Keys and values are counted in each open map, so that an event is known to be a key or a value.
        """
        while True:
            event = self._take_event()
            if event is None:
                return
            container = self._open_containers[-1] if self._open_containers else None
            if isinstance(event, yaml.CollectionEndEvent):
                self._open_containers.pop()
                self._count_value()
            elif isinstance(event, yaml.CollectionStartEvent):
                is_map = isinstance(event, yaml.MappingStartEvent)
                is_in_list = container is not None and not container.is_map
                self._open_containers.append(_Container(is_map, is_flow=bool(event.flow_style), is_in_list=is_in_list))
            elif isinstance(event, yaml.ScalarEvent) and container is not None and container.is_map:
                # Keys and values alternate, so the event is a key after an even number of them.
                if container.awaits_key:
                    yield from self._insert_item_end(event, container)
                    container.keys.setdefault(event.value, _line_of_event(event))
                elif container.is_flow:  # A value in {...}, where a comma ends a text without quotes.
                    self._skip_text_after_comma(event)
                container.node_count += 1
            elif isinstance(event, (yaml.ScalarEvent, yaml.AliasEvent)):
                self._count_value()
            yield event

    def _count_value(self) -> None:
        """Count a complete value in the innermost open map or list."""
        if self._open_containers:
            self._open_containers[-1].node_count += 1

    def _take_event(self) -> Any:
        """Return the next event, first those that were looked at ahead, or None after the last one."""
        return self._ahead.popleft() if self._ahead else next(self._events, None)

    def _peek_event(self, index: int) -> Any:
        """Return a later event without taking it, or None after the last one. Index 0 is the next event."""
        while len(self._ahead) <= index:
            self._ahead.append(next(self._events, None))
        return self._ahead[index]

    def _insert_item_end(self, key_event: Any, container: _Container) -> Iterator[Any]:
        """Yield the events for the end of an element of a list and the start of the next if a dash is missing.

        This is assumed if two keys in a row are repeated, beginning with the first key of the element. A single
        duplicate key is reported elsewhere.
        """
        if not container.is_in_list or container.is_flow or len(container.keys) < 2:
            return
        first_key = next(iter(container.keys))
        if key_event.value != first_key or self._key_after_next() not in container.keys:
            return
        first_line = container.keys[key_event.value]
        message = (
            f"this item has a key twice: {quoted(key_event.value)} is already on line {first_line}; "
            "put '-' before it if a new item begins here"
        )
        self._complain(key_event, "duplicate-key", message)
        container.keys.clear()
        yield yaml.MappingEndEvent(key_event.start_mark, key_event.start_mark)
        yield yaml.MappingStartEvent(None, None, True, key_event.start_mark, key_event.start_mark, flow_style=False)

    def _key_after_next(self) -> str | None:
        """Return the key after the next value, or None if the map ends there or the value is too long."""
        nesting_depth = 0  # The level of nesting in the value.
        for event_index in range(_MOST_EVENTS_AHEAD + 1):
            event = self._peek_event(event_index)
            if isinstance(event, yaml.CollectionStartEvent):
                nesting_depth += 1
            elif isinstance(event, yaml.CollectionEndEvent):
                nesting_depth -= 1
            is_end_of_map = nesting_depth < 0
            if event is None or is_end_of_map:
                return None
            is_end_of_value = nesting_depth == 0
            if is_end_of_value:
                key = self._peek_event(event_index + 1)
                return key.value if isinstance(key, yaml.ScalarEvent) else None
        return None

    def _skip_text_after_comma(self, value_event: Any) -> None:
        """Skip the text after a comma in an unquoted text or number in {...}, which would be a key without a value.

        ``{meaning: low, or off}`` becomes ``low``. Groups of three digits, as in ``1,000``, are appended to a number.
        """
        if value_event.style or value_event.tag or value_event.anchor:
            return
        first_skipped_event = None
        is_number = _DIGITS.fullmatch(value_event.value) is not None
        # The parser reads the text after the comma as a key, with an empty value.
        while self._is_key_without_colon(self._peek_event(0), self._peek_event(1)):
            event_after_comma = self._peek_event(0)
            if is_number and _THREE_DIGITS.fullmatch(event_after_comma.value):
                value_event.value += event_after_comma.value
            elif is_number or not _is_text(value_event.value):
                break  # As in {12: , 16}, where keys may come alone.
            if first_skipped_event is None:
                first_skipped_event = event_after_comma
            self._take_event()  # The key without a colon.
            self._take_event()  # Its empty value.
        if first_skipped_event is not None:
            number = value_event.value if is_number else None
            self._complain(first_skipped_event, "yaml-syntax", _message_on_comma(first_skipped_event, number))

    def _is_key_without_colon(self, key_event: Any, value_event: Any) -> bool:
        """Return True if two events are an unquoted key, after which there is no colon, and its empty value."""
        if not isinstance(key_event, yaml.ScalarEvent) or not isinstance(value_event, yaml.ScalarEvent):
            return False
        if key_event.style or value_event.style or value_event.value:
            return False
        key_end: Any = key_event.end_mark
        text_after = self._lines[key_end.line][key_end.column :]
        return key_event.value != "" and not text_after.lstrip().startswith(":")


def _line_of_event(event: Any) -> int:
    return int(event.start_mark.line) + 1


def _message_on_comma(skipped_event: Any, number: str | None) -> str:
    """Return the message about a comma in a number or, if ``number`` is None, in an unquoted text.

    ``number`` is the number without commas, and ``skipped_event`` the event of the text after the comma.
    """
    if number is not None:
        return f"numbers are written without commas; write {number}"
    rule = "A comma ends an unquoted string inside {...}: if this is part of the string, quote the whole string"
    return f"{quoted(skipped_event.value)} has no colon. {rule}"
