"""Lines of code that are too long are broken at their brackets, as Black would break them."""

from __future__ import annotations

import re
from collections.abc import Iterator

WIDTH = 120

_TOKEN = re.compile(r'"(?:\\.|[^"\\])*"|[][(){},]|[^][(){},"]+')
_TEXT = re.compile(r'(\s*)(\w+=|"(?:\\.|[^"\\])*": )?("(?:\\.|[^"\\])*"),')


def broken(text: str) -> str:
    """The same code; what stands in the first brackets of a line that is too long gets a line for each item."""
    return "\n".join(piece for line in text.split("\n") for piece in _broken(line))


def _broken(line: str) -> Iterator[str]:
    text = _TEXT.fullmatch(line) if len(line) > WIDTH else None
    start, items, end = _items(line) if len(line) > WIDTH and text is None else (line, [], "")
    if text is not None:
        yield f"{text[1]}{text[2] or ''}{_in_pieces(text[3], len(text[1]))},"
    elif not items:
        yield line
    else:
        indent = line[: len(line) - len(line.lstrip())]
        yield start
        for item in items:
            yield from _broken(f"{indent}    {item},")
        yield indent + end


def _items(line: str) -> tuple[str, list[str], str]:
    """The line up to its first bracket, what stands between its commas, and the rest from where it closes."""
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
    return start, [item.strip() for item in items if item.strip()], line[place:]


def _in_pieces(text: str, indent: int) -> str:
    """A quoted text that is too long, cut after spaces into pieces that stand side by side in parentheses."""
    pieces = [""]
    for word in text[1:-1].split(" "):
        if pieces[-1] and indent + 4 + len(f'"{pieces[-1]}{word}"') > WIDTH - 2:
            pieces.append("")
        pieces[-1] += word + " "
    pieces[-1] = pieces[-1][:-1]
    lines = [f'{" " * indent}    "{piece}"' for piece in pieces if piece]
    return "\n".join(["(", *lines, f"{' ' * indent})"]) if len(lines) > 1 or len(lines[0]) <= WIDTH else text
