"""Syntax errors of YAML, explained for someone who transcribes a manual, with the position to correct.

PyYAML reports where its parser stopped. An open quote or bracket is higher up, often by many lines.
"""

from __future__ import annotations

import re
from typing import Any

import yaml

_RULE = "yaml-syntax"
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_LINE_BREAK = re.compile(r"\r\n|\r|\n")
_NO_COMMA = "a comma or closing bracket is missing before this"
#: Spaces of word processors and PDF files, where YAML needs an ordinary one: in the indentation or after a colon.
_ODD_SPACE = re.compile(r"(?:^|(?<=[:, -]))[\u00a0\u2000-\u200b\u202f\u3000\ufeff]")
_COMMENT = re.compile(r"\s#")


def explain(error: yaml.MarkedYAMLError, text: str) -> tuple[int, int, str, str]:
    """Return line, column, rule and message for an error of the parser."""
    lines = _LINE_BREAK.split(text)
    mark: Any = error.problem_mark or error.context_mark
    problem, context = error.problem or "not understood", error.context or ""
    opened: Any = error.context_mark
    odd_space = _odd_space(lines, [position.line for position in (opened, mark) if position is not None])
    if odd_space is not None:
        return odd_space
    # The mark of this problem is where the search for the colon ended.
    if opened is not None and problem == "could not find expected ':'":
        return *_place(opened), _RULE, _missing_colon(_character(lines, opened))
    if opened is not None and "quoted scalar" in context and "end of stream" in problem:
        return *_place(opened), _RULE, "the quote that opens here is never closed; close it on this line"
    quote = _last_quoted(text, mark)
    if quote is not None:
        return *_place(quote.start_mark), _RULE, _about_quote(quote)
    if opened is not None and "flow" in context and "expected ','" in problem:
        if mark.line == opened.line and not _COMMENT.search(lines[opened.line], opened.column):
            return *_place(mark), _RULE, _NO_COMMA
        return *_place(opened), _RULE, _about_bracket(lines, opened, mark)
    line, column = (1, 1) if mark is None else _place(mark)
    character = _character(lines, mark)
    return line, column, _RULE, _message(problem, character, line >= len(lines) and not character)


def _odd_space(lines: list[str], positions: list[int]) -> tuple[int, int, str, str] | None:
    """Return the error for an unusual space in one of these lines, counted from 0, or in the line before."""
    for position in positions:
        for line in (position, position - 1):
            match = _ODD_SPACE.search(lines[line]) if 0 <= line < len(lines) else None
            if match is not None:
                character = f"U+{ord(match[0]):04X}"
                message = (
                    f"the space {character} is not an ordinary space, so YAML reads it as text; replace it with one"
                )
                return line + 1, match.start() + 1, _RULE, message
    return None


def _place(mark: Any) -> tuple[int, int]:
    return mark.line + 1, mark.column + 1


def _character(lines: list[str], mark: Any) -> str:
    return lines[mark.line][mark.column : mark.column + 1] if mark is not None and mark.line < len(lines) else ""


def _missing_colon(character: str) -> str:
    if character in ("'", '"'):
        return "the quote that opens here is not closed on this line; close it"
    return "a key has no colon, or the text of a value continues without indentation"


def _last_quoted(text: str, mark: Any) -> Any:
    """Return the quoted text before the error if it may be the cause: it spans several lines, or ends there."""
    last = None
    try:
        for token in yaml.scan(text, Loader=_LOADER):
            if mark is None or (token.start_mark.line, token.start_mark.column) >= (mark.line, mark.column):
                break
            if isinstance(token, yaml.ScalarToken) and token.style in ("'", '"') and token.end_mark.line == mark.line:
                last = token
    except yaml.YAMLError:
        pass  # This is the error to explain. Everything before it has been scanned.
    if last is None or last.end_mark.line > last.start_mark.line:
        return last
    return last if last.end_mark.column == mark.column else None


def _about_quote(token: Any) -> str:
    if token.end_mark.line > token.start_mark.line:
        return f"the quote that opens here does not close until line {token.end_mark.line + 1}; close it on this line"
    if token.style == "'":
        return "an apostrophe inside '...' ends the text; put the text in double quotes"
    return 'a quote inside "..." ends the text; put the text in single quotes, or write \\" for the quote inside'


def _about_bracket(lines: list[str], opened: Any, mark: Any) -> str:
    bracket = _character(lines, opened)
    closing = {"{": "}", "[": "]"}.get(bracket, "bracket")
    at_end = mark.line >= len(lines) - 1 and not _character(lines, mark)
    problem = (
        f"the '{bracket}' that opens here is not closed by "
        f"{'the end of the file' if at_end else f'line {mark.line + 1}'}"
    )
    if _COMMENT.search(lines[opened.line], opened.column):
        return f"{problem}: a '#' after a space begins a comment; put the text in quotes"
    return f"{problem}; close it with '{closing}', or add the missing comma"


def _message(problem: str, character: str, at_end: bool) -> str:
    if character == "\t":
        return "tabs cannot be used for indentation; use spaces"
    if (character and character in "@`") or (character == "%" and "token" in problem):
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
