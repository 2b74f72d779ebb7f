"""Breaking of long lines at brackets, in the style of Black."""

from __future__ import annotations

import re
from collections.abc import Iterator

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
