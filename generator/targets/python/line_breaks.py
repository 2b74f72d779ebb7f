"""Breaks long lines of generated Python code."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

WIDTH = 120

# A quoted text, a bracket or a comma, or any text up to the next of the three.
_LINE_TOKEN = re.compile(r'"(?:\\.|[^"\\])*"|[][(){},]|[^][(){},"]+')
# The space before each binary operator, the loosest operators first.
_LOOSEST_FIRST = tuple(re.compile(rf" (?=(?:{words}) )") for words in (r"or", r"and", r"\||\^|&", r"<<|>>", r"\+|-"))
# A line with only a quoted text and a comma, perhaps after its argument name or key.
_TEXT_LINE = re.compile(r'(\s*)(\w+=|"(?:\\.|[^"\\])*": )?("(?:\\.|[^"\\])*"),')


def break_lines(text: str) -> str:
    """Return code in which each long line is broken at the items, or the operands, in its first brackets."""
    broken_lines: list[str] = []
    for line in text.split("\n"):
        broken_lines += _break_line(line)
    return "\n".join(broken_lines)


def _break_line(line: str) -> Iterator[str]:
    """Yield a line, or if it is too long, a line for each item or operand in its first brackets.

    Items that are still too long are broken again, and a long text is split into several literals. A line without
    brackets stays long.
    """
    if len(line) <= WIDTH:
        yield line
        return
    text_item = _TEXT_LINE.fullmatch(line)
    if text_item is not None:
        indent, name_or_key, quoted_text = text_item[1], text_item[2] or "", text_item[3]
        yield f"{indent}{name_or_key}{_split_literal(quoted_text, len(indent))},"
        return
    line_start, items, line_end = _split_bracket_items(line)
    if not items:
        yield line
        return
    indent = line[: len(line) - len(line.lstrip())]
    yield line_start
    for line_in_brackets in _lines_in_brackets(line_start, items):
        yield from _break_line(f"{indent}    {line_in_brackets}")
    yield indent + line_end


def _lines_in_brackets(line_start: str, items: Sequence[str]) -> list[str]:
    """Return a line for each item in brackets, or for each operand of an expression in parentheses.

    ``line_start`` ends with the opening bracket. An empty last item means that the items end with a comma. The
    only item of a call or list gets a comma. An expression in parentheses and a subscript do not, since a comma
    would turn them into a tuple. A comprehension is not split.
    """
    text_in_brackets = ", ".join(items)
    if " for " in _outer_text(text_in_brackets):
        return [text_in_brackets]
    if len(items) > 1:
        return [f"{item}," for item in items if item]
    follows_value = re.search(r"[\w\])]\W$", line_start) is not None
    if line_start.endswith("(") and not follows_value:
        return _split_operands(text_in_brackets)
    is_subscript = line_start.endswith("[") and follows_value
    return [text_in_brackets] if is_subscript else [f"{text_in_brackets},"]


def _split_operands(expression: str) -> list[str]:
    """Return the operands of the loosest operators of an expression, each after its operator.

    ``a + f(b + c) - d`` is split into ``a``, ``+ f(b + c)`` and ``- d``. A conditional expression and an expression
    without operators are returned as one operand.
    """
    if " if " in _outer_text(expression):
        return [expression]
    for space_before_operator in _LOOSEST_FIRST:
        operands = [""]
        for token, depth in _tokens_with_depth(expression):
            # The token ``a + f`` continues the operand so far with ``a``, and begins the operand ``+ f``.
            token_parts = space_before_operator.split(token) if _is_outside_brackets(token, depth) else [token]
            continuation, *new_operands = token_parts
            operands[-1] += continuation
            operands += new_operands
        if len(operands) > 1:
            return operands
    return [expression]


def _outer_text(expression: str) -> str:
    """Return the parts of an expression that are outside brackets and quoted texts."""
    return "".join(token for token, depth in _tokens_with_depth(expression) if _is_outside_brackets(token, depth))


def _is_outside_brackets(token: str, depth: int) -> bool:
    """Return whether a token with this number of open brackets is outside brackets, and not a quoted text."""
    return depth == 0 and not token.startswith('"')


def _tokens_with_depth(line: str) -> Iterator[tuple[str, int]]:
    """Yield each token with the number of brackets that are open after it, or before a closing bracket.

    ``f(a)`` is split into ``("f", 0)``, ``("(", 1)``, ``("a", 1)`` and ``(")", 1)``.
    """
    depth = 0
    for token in _LINE_TOKEN.findall(line):
        if token in "([{":
            depth += 1
        yield token, depth
        if token in ")]}":
            depth -= 1


def _split_bracket_items(line: str) -> tuple[str, list[str], str]:
    """Return the line up to its first bracket, the items in the brackets, and the rest with the closing bracket.

    The line ``call(a, [b, c]),`` is split into ``call(``, the items ``a`` and ``[b, c]``, and ``),``. The last of
    several items is empty if they end with a comma.
    """
    # The line up to its first bracket. It is empty until the loop has passed that bracket.
    line_start = ""
    items = [""]
    end_of_token = 0
    for token, depth in _tokens_with_depth(line):
        is_closing_first_bracket = bool(line_start) and depth == 1 and token in ")]}"
        if is_closing_first_bracket:
            break
        # Position after the token.
        end_of_token += len(token)
        if not line_start:
            line_start = line[:end_of_token] if depth else ""
        elif token == "," and depth == 1:
            items.append("")
        else:
            items[-1] += token
    stripped_items = [item.strip() for item in items] if any(items) else []
    return line_start, stripped_items, line[end_of_token:]


def _split_literal(quoted_text: str, indent: int) -> str:
    """Return a long quoted text as several literals in parentheses, split after spaces.

    ``indent`` is the number of spaces before the text. A text of a single word that is too long stays as it is.
    """
    margin = f"{' ' * indent}    "
    literal_texts = [""]
    for word in quoted_text[1:-1].split(" "):
        line_with_word = f'{margin}"{literal_texts[-1]}{word}"'
        # The space after the word, and the comma after the last literal, need 2 more characters.
        if literal_texts[-1] and len(line_with_word) > WIDTH - 2:
            literal_texts.append("")
        literal_texts[-1] += f"{word} "
    literal_texts[-1] = literal_texts[-1].removesuffix(" ")
    literal_lines = [f'{margin}"{literal_text}"' for literal_text in literal_texts if literal_text]
    is_one_word_too_long = len(literal_lines) == 1 and len(literal_lines[0]) > WIDTH
    if is_one_word_too_long:
        return quoted_text
    return "\n".join(["(", *literal_lines, f"{' ' * indent})"])
