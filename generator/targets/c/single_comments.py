"""The comments of a single header for one order code, which are shortened from other headers and wrapped again."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Iterator

from .comments import COLUMNS

#: Width of a line of a comment after its `` * ``.
COMMENT_WIDTH = COLUMNS - 3
SENTENCE_END = re.compile(r"(?<=[.:])\s(?=[A-Z])")


def member_comment(text: str, margin: str) -> str:
    """Return the comment on a member of a struct, with ``/*`` and ``*/`` on the lines of the text."""
    single_line = f"{margin}/* {text} */\n"
    # Its line break counts too, which leaves room for Doxygen's mark, longer by one character.
    if len(single_line) <= COLUMNS:
        return single_line
    # A placeholder instead of a space keeps the mark at the end on the line of the last word.
    unbreakable_space = "\0"
    lines = wrap_text(f"{text}{unbreakable_space}*/", COLUMNS - 1, first_margin=f"{margin}/* ", margin=f"{margin} * ")
    return "".join(f"{line}\n" for line in lines).replace(unbreakable_space, " ")


def first_paragraph(comment: str) -> str:
    """Return the first sentence of a comment from the runtime, or if it has a picture, its text up to the picture.

    A picture follows ``:`` and a blank line. It is included unless it is an example that calls the runtime.
    """
    text_before_picture, _, picture_and_rest = "\n".join(comment_lines(comment)).partition(":\n\n")
    # An empty line ends a picture, and a paragraph.
    picture, _, _ = picture_and_rest.partition("\n\n")
    text_on_one_line = text_before_picture.replace("\n", " ")
    if picture_and_rest and "cw_" in picture:
        return as_comment(wrap_text(f"{text_on_one_line}."))
    if picture_and_rest:
        return as_comment([*wrap_text(f"{text_on_one_line}:"), "", *picture.splitlines()])
    first_paragraph, _, _ = text_before_picture.partition("\n\n")
    # The parameters of a function can follow on the next line.
    description, _, _ = first_paragraph.partition("\n@")
    first_sentence, *_ = SENTENCE_END.split(description.replace("\n", " "))
    return as_comment(wrap_text(first_sentence))


def without_example(comment: str) -> str:
    """Return a comment from the runtime without the example that follows its first sentence, if there is one."""
    first_sentence, example_begins, example_and_rest = "\n".join(comment_lines(comment)).partition(":\n\n")
    if not example_begins:
        return comment
    _, _, rest = example_and_rest.partition("\n\n")
    return as_comment([*wrap_text(first_sentence.replace("\n", " ") + "."), "", *rest.splitlines()])


def wrap_text(text: str, width: int = COMMENT_WIDTH, first_margin: str = "", margin: str = "") -> list[str]:
    """Return the lines of a text with whole words. ``first_margin`` begins the first line, ``margin`` the others."""
    wrapper = textwrap.TextWrapper(width, initial_indent=first_margin, subsequent_indent=margin)
    wrapper.break_long_words = wrapper.break_on_hyphens = False
    return wrapper.wrap(text)


def comment_lines(comment: str) -> list[str]:
    """Return the lines of a comment without ``/**``, ``*/`` and the ``*`` in front. Indentation is kept."""
    if not comment:
        return []
    lines = comment.rstrip().removeprefix("/**").removesuffix("*/").strip("\n").splitlines()
    return [line.strip().removeprefix("*").removeprefix(" ") for line in lines]


def split_paragraphs(lines: Iterable[str]) -> Iterator[list[str]]:
    """Yield the lines of each paragraph of a comment. A line that begins with a space or @ is a separate paragraph.

    A line is the last one of its paragraph if the first word of the next line would have fit on it.
    """
    paragraph: list[str] = []
    for line in lines:
        first_word = line.partition(" ")[0]
        # 1 is the space before the word.
        is_line_full = bool(paragraph) and len(paragraph[-1]) + 1 + len(first_word) > COMMENT_WIDTH
        goes_on = is_line_full and bool(first_word) and not line.startswith("@")
        if paragraph and not goes_on:
            yield paragraph
            paragraph = []
        paragraph.append(line)
        if line.startswith((" ", "@")) or not line:
            yield paragraph
            paragraph = []
    if paragraph:
        yield paragraph


def as_comment(lines: list[str]) -> str:
    """Return lines as a comment with the marks of Doxygen, or an empty string without lines."""
    text = "\n".join(lines).strip("\n")
    if not text:
        return ""
    # 7 characters are the marks of a comment on one line.
    if "\n" not in text and len(text) <= COLUMNS - 7:
        return f"/** {text.strip()} */\n"
    body = "\n".join(f" * {line}".rstrip() for line in text.splitlines())
    return f"/**\n{body}\n */\n"
