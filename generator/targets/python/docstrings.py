"""Docstrings, and text that cannot break out of them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ...say.lines import plain, wrapped
from .lines import WIDTH

#: A quotation mark at the end that no backslash takes the meaning from.
_OPEN_QUOTE = re.compile(r'(?<!\\)(?:\\\\)*"$')


@dataclass(frozen=True)
class Lines:
    """Lines of a docstring that stay as they are, such as those of an example."""

    lines: tuple[str, ...]


Block = str | Lines | tuple[str, Sequence[tuple[str, str]]]


def docstring(summary: str, *blocks: Block, indent: int = 0) -> str:
    """A docstring with its quotes; a block is a paragraph, or a title with named entries. Empty blocks are left out."""
    pad = " " * indent
    lines = [wrapped(_in_docstring(summary), WIDTH - (3 if not any(blocks) else 0), pad, f'{pad}"""')]
    for block in blocks:
        if isinstance(block, str):
            lines += ["", wrapped(_in_docstring(block), WIDTH, pad)] if block else []
        elif isinstance(block, Lines):
            lines += ["", *(f"{pad}    {_in_docstring_line(line)}" for line in block.lines)] if block.lines else []
        elif block[1]:
            entries = (
                wrapped(_in_docstring(text), WIDTH, f"{pad}        ", f"{pad}    {name}: ") for name, text in block[1]
            )
            lines += ["", wrapped(_in_docstring(f"{block[0]}:"), WIDTH, pad), *entries]
    text = "\n".join(lines)
    if "\n" in text:
        return f'{text}\n{pad}"""'
    open_quote = _OPEN_QUOTE.search(text)
    return (f'{text[:-1]}\\"' if open_quote else text) + '"""'


def _in_docstring_line(line: str) -> str:
    """A line whose indentation stays."""
    return line[: len(line) - len(line.lstrip())] + _in_docstring(line)


def _in_docstring(text: str) -> str:
    return plain(text).replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
