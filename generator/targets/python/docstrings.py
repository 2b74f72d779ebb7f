"""Docstrings. Their text is escaped so that it cannot end them."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ...model.record import dataclass
from ...say.plain_text import plain, wrapped
from .lines import WIDTH

#: A quotation mark at the end that is not escaped.
_OPEN_QUOTE = re.compile(r'(?<!\\)(?:\\\\)*"$')


@dataclass(frozen=True)
class Lines:
    """Lines of a docstring that are not wrapped, such as those of an example."""

    lines: tuple[str, ...]


Block = str | Lines | tuple[str, Sequence[tuple[str, str]]]


def docstring(summary: str, *blocks: Block, indent: int = 0) -> str:
    """Return a docstring with its quotes. A block is a paragraph, or a title with entries. Empty blocks are omitted.

    An entry without a name, such as that of ``Returns``, is plain text.
    """
    pad = " " * indent
    pad = " " * indent
    summary_width = WIDTH if any(blocks) else WIDTH - len('"""')
    lines = [wrapped(_in_docstring(summary), summary_width, pad, f'{pad}"""')]
    for block in blocks:
        block_lines = _block_lines(block, pad)
        if block_lines:
            lines += ["", *block_lines]
    text = "\n".join(lines)
    if "\n" in text:
        return f'{text}\n{pad}"""'
    open_quote = _OPEN_QUOTE.search(text)
    return (f'{text[:-1]}\\"' if open_quote else text) + '"""'


def _block_lines(block: Block, pad: str) -> list[str]:
    """Return the lines of a block, none if it is empty."""
    if isinstance(block, str):
        return [wrapped(_in_docstring(block), WIDTH, pad)] if block else []
    if isinstance(block, Lines):
        return [f"{pad}    {_in_docstring_line(line)}" for line in block.lines]
    title, entries = block
    if not entries:
        return []
    return [wrapped(_in_docstring(f"{title}:"), WIDTH, pad), *(_entry(name, text, pad) for name, text in entries)]


def _entry(name: str, text: str, pad: str) -> str:
    """Return an entry of a block. Further lines of a named entry are indented."""
    start = f"{pad}    {name}: " if name else f"{pad}    "
    return wrapped(_in_docstring(text), WIDTH, f"{pad}        " if name else start, start)


def _in_docstring_line(line: str) -> str:
    """Return a line with its indentation."""
    return line[: len(line) - len(line.lstrip())] + _in_docstring(line)


def _in_docstring(text: str) -> str:
    return plain(text).replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
