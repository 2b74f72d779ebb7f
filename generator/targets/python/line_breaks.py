"""Breaking of long lines of Python."""

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
    """Return the code with long lines broken into one line for each item, or each operand, in the first brackets."""
    return "\n".join(bit_slice for line in text.split("\n") for bit_slice in _broken_lines(line))


def _broken_lines(line: str) -> Iterator[str]:
    """Yield a line, or one line for each item or operand in its first brackets if it is too long.

    A long text is split into several literals. Items are broken again. A line without brackets stays long.
    """
    if len(line) <= WIDTH:
        yield line
        return
    text_item = _TEXT_LINE.fullmatch(line)
    if text_item is not None:
        indent, name, quoted_text = text_item[1], text_item[2] or "", text_item[3]
        yield f"{indent}{name}{_split_literal(quoted_text, len(indent))},"
        return
    line_start, items, line_end = _split_bracket_items(line)
    if not items:
        yield line
        return
    indent = line[: len(line) - len(line.lstrip())]
    yield line_start
    for line_in_brackets in _lines_in_brackets(line_start, items):
        yield from _broken_lines(f"{indent}    {line_in_brackets}")
    yield indent + line_end


def _lines_in_brackets(line_start: str, items: Sequence[str]) -> list[str]:
    """Return a line for each item in brackets, or for each operand of an expression in parentheses.

    ``line_start`` ends with the bracket. An empty last item means that the items end with a comma. A comma after the
    only item would turn an expression in parentheses, or a subscript, into a tuple, so only calls and lists get it. A
    comprehension is not split and stays on one line.
    """
    content = ", ".join(items)
    if " for " in _outer_text(content):
        return [content]
    if len(items) > 1:
        return [f"{element}," for element in items if element]
    follows_value = re.search(r"[\w\])]\W$", line_start) is not None
    if line_start.endswith("(") and not follows_value:
        return _split_operands(content)
    is_subscript = line_start.endswith("[") and follows_value
    return [content] if is_subscript else [f"{content},"]


def _split_operands(expression: str) -> list[str]:
    """Return the operands of the loosest operators, each after its operator.

    ``a + f(b + c) - d`` is split into ``a``, ``+ f(b + c)`` and ``- d``. A conditional expression is one operand, and
    so is an expression without operators.
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
    """Return the text outside brackets and quoted texts."""
    return "".join(token for token, depth in _tokens_with_depth(expression) if _is_outside_brackets(token, depth))


def _is_outside_brackets(token: str, depth: int) -> bool:
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
    start = ""
    items = [""]
    position = 0
    for token, depth in _tokens_with_depth(line):
        is_closing_first_bracket = bool(start) and depth == 1 and token in ")]}"
        if is_closing_first_bracket:
            break
        # Position after the token.
        position += len(token)
        if not start:
            start = line[:position] if depth else ""
        elif token == "," and depth == 1:
            items.append("")
        else:
            items[-1] += token
    return start, [element.strip() for element in items] if any(items) else [], line[position:]


def _split_literal(quoted_text: str, indent: int) -> str:
    """Return a long quoted text as several literals in parentheses, split after spaces.

    ``indent`` is the number of spaces before the text. A text of a single word that is too long stays as it is.
    """
    margin = f"{' ' * indent}    "
    bit_slices = [""]
    for word in quoted_text[1:-1].split(" "):
        line_with_word = f'{margin}"{bit_slices[-1]}{word}"'
        # The line still lacks the space after the word, and the comma after the last literal.
        if bit_slices[-1] and len(line_with_word) > WIDTH - 2:
            bit_slices.append("")
        bit_slices[-1] += f"{word} "
    bit_slices[-1] = bit_slices[-1].removesuffix(" ")
    literal_lines = [f'{margin}"{bit_slice}"' for bit_slice in bit_slices if bit_slice]
    is_one_word_too_long = len(literal_lines) == 1 and len(literal_lines[0]) > WIDTH
    if is_one_word_too_long:
        return quoted_text
    return "\n".join(["(", *literal_lines, f"{' ' * indent})"])
