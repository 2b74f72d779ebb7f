"""Comments in C: text of a spec in ASCII, the style of sentences, and the breaking of long lines."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence

from ...say.plain_text import in_ascii, text_on_one_line
from ...say.text import TITLE_STYLE, Statement, Style
from .names import string

COLUMNS = 100
#: The smallest width of a text after its lead.
_NARROWEST_TEXT = 36

#: A paragraph of a comment. A pair is a lead and its text, whose other lines are indented by the width of the lead.
Paragraph = str | tuple[str, str]

#: Signs that comments spell in their own way.
_ASCII_SPELLINGS = {"±": "+/-", "°": " deg ", "Ω": "ohm"}


def ascii_text(text: object) -> str:
    """Return text in ASCII, with single spaces."""
    return re.sub(" +", " ", in_ascii(text_on_one_line(text).replace("N°", "No."), _ASCII_SPELLINGS)).strip()


def in_comment(text: object) -> str:
    """Make ``text`` safe for a comment: nothing in it ends or opens one, continues a line or is a trigraph."""
    safe = ascii_text(text).replace("\\", "|")
    # Of three question marks, one pass leaves two next to each other.
    while "??" in safe:
        safe = safe.replace("??", "? ?")
    return _separate_comment_marks(safe)


def _separate_comment_marks(text: str) -> str:
    """Put a space between every adjacent star and slash."""
    return re.sub(r"\*(?=/)|/(?=\*)", lambda match: match[0] + " ", text)


def comment(paragraphs: Sequence[Paragraph] | str, indent: int = 0) -> str:
    """Format paragraphs as a comment, on one line if it fits. In a sequence, empty paragraphs are omitted.

    ``indent`` is the number of spaces before each line. A long lead has its text on the lines below. An empty line
    separates the first lead with ``@``, of a parameter, from the text above it.
    """
    if isinstance(paragraphs, str):
        leads_and_texts = [("", paragraphs)]
    else:
        leads_and_texts = [(lead, text) for lead, text in map(_lead_and_text, paragraphs) if text]
    margin = " " * indent
    lines: list[str] = []
    for unsafe_lead, text in leads_and_texts:
        lead = in_comment_lead(unsafe_lead)
        if lead.startswith("@") and lines and not lines[-1].startswith(("@", " ")):
            # The parameters of a function come after an empty line.
            lines.append("")
        if len(lead) > COLUMNS - indent - _NARROWEST_TEXT:
            # The lead is too long: the text goes below.
            lines.append(_separate_comment_marks(lead.rstrip()))
            lead = "        "
        # 3 characters are " * ", and the 6 below are the marks of a comment on one line.
        width = COLUMNS - indent - 3 - len(lead)
        wrapped = textwrap.wrap(in_comment(text), width, break_long_words=False, break_on_hyphens=False)
        first_line, *further_lines = wrapped or [""]
        lines.append(_separate_comment_marks(lead + first_line))
        lines += [_separate_comment_marks(" " * len(lead) + line) for line in further_lines]
    if len(lines) == 1 and len(lines[0]) + indent + 6 <= COLUMNS:
        return f"{margin}/* {lines[0]} */"
    body = "\n".join(f"{margin} * {line}".rstrip() for line in lines)
    return f"{margin}/*\n{body}\n{margin} */"


def _lead_and_text(paragraph: Paragraph) -> tuple[str, str]:
    return ("", paragraph) if isinstance(paragraph, str) else paragraph


def comment_lines(paragraphs: Sequence[Paragraph] | str) -> str:
    """Format paragraphs as lines inside a comment that the template opens and closes, each with `` * ``."""
    comment_with_marks = comment(paragraphs)
    first_line, *further_lines = comment_with_marks.splitlines()
    if not further_lines:
        return f" * {first_line.removeprefix('/* ').removesuffix(' */')}"
    return "\n".join(further_lines[:-1])


def in_comment_lead(text: str) -> str:
    """Make the lead of a paragraph safe for a comment, with its spaces kept."""
    return re.sub("[^ ]+", lambda word: in_comment(word[0]), text)


class InHeader(Style):
    """A style that mentions an erratum briefly, where it matters, with the value used instead.

    It leaves out differences from other editions.
    """

    def sentence(self, statement: Statement) -> str:
        """Return the sentence of a statement, or its brief form if it has one."""
        if statement.brief is None:
            return super().sentence(statement)
        return self.text(statement.brief)


HEADER_STYLE = InHeader(text=TITLE_STYLE.text, code=TITLE_STYLE.code, ref=TITLE_STYLE.ref)


#: Places where a long line may be broken, the better ones first.
_BREAKS_IN_CONDITIONS = re.compile(r"(?<= &&) |(?<= \|\|) ")
_BREAKS_ANYWHERE = re.compile(r"(?<= &&) |(?<= \|\|) |(?<= \|) |(?<= \+) |(?<= -) |(?<=,) (?=[A-Za-z&(])")
_STRING_LITERAL = re.compile(r'"(?:\\.|[^"\\])*"')
#: A comment that begins a line, except titles of sections, or that follows a declaration or a macro.
_COMMENT_OPENING = re.compile(r"\s*/\*(?: (?!-- )|$)")
_AT_END = re.compile(r"^(\s*[A-Za-z#](?:(?!/\*).)*) /\* (?=[^*]*\*/$)")
#: The end of a line that the next one continues.
_CONTINUED_LINE = ("(", " =", " |")


def end_comment(note: object) -> str:
    """Return a comment for the end of a line. ``break_lines`` moves it above the line if the line gets too long."""
    safe_note = in_comment(note)
    return f" /* {safe_note} */" if safe_note else ""


def call_in_lines(parts: Sequence[str], indent: int) -> str:
    """Return a call with its arguments on one line, or each on its own line if that is too long.

    The parts are the start of the call, such as ``f(``, and the arguments with their commas.
    """
    margin = " " * indent
    on_one_line = margin + " ".join(parts)
    if len(on_one_line) <= COLUMNS:
        return on_one_line
    start_of_call, *arguments = parts
    return f"\n{margin}    ".join((margin + start_of_call, *arguments))


def literals(text: object, indent: int) -> str:
    """Return text as a string literal, or as several literals on separate lines if it is too long."""
    # 4 characters are the quotes, the space at the end of a literal, and the character after the last literal.
    lines = textwrap.wrap(ascii_text(text), COLUMNS - indent - 4, break_long_words=False, break_on_hyphens=False)
    *other_lines, last_line = lines or [""]
    literals_of_lines = [string(f"{line} ") for line in other_lines]
    literals_of_lines.append(string(last_line))
    return f"\n{' ' * indent}".join(literals_of_lines)


def mark_for_doxygen(text: str) -> str:
    """Mark the comments of a header for Doxygen: comments above a declaration, and comments after one.

    A comment that becomes too long for the end of its line moves above it.
    """
    lines: list[str] = []
    in_body = False
    for line in text.splitlines():
        # The braces of a function are at the start of a line.
        in_body = line == "{" or (in_body and line != "}")
        if in_body:
            lines.append(line)
        elif line == "/*" and not lines:
            # The first comment describes the file.
            lines.append("/** @file")
        else:
            lines += _mark_for_doxygen(line)
    return "".join(f"{line}\n" for line in lines)


def _mark_for_doxygen(line: str) -> Iterator[str]:
    """Yield a line with the mark of Doxygen in its comment, if it has one: ``/**`` before it, or ``/**<`` at its end.

    A comment that gets too long at the end goes above the line, as ``/**``.
    """
    if _COMMENT_OPENING.match(line):
        yield from _one_or_more(line.replace("/*", "/**", 1))
        return
    marked = _AT_END.sub(r"\1 /**< ", line)
    if marked == line or len(marked) <= COLUMNS:
        yield marked
        return
    code, _, note = line.rpartition(" /* ")
    margin = " " * (len(code) - len(code.lstrip()))
    yield from _one_or_more(f"{margin}/** {note}")
    yield code.rstrip()


def _one_or_more(line: str) -> Iterator[str]:
    """Yield a comment on one line, or as a block if the mark for Doxygen makes it too long."""
    if len(line) <= COLUMNS:
        yield line
        return
    margin = " " * (len(line) - len(line.lstrip()))
    yield f"{margin}/**"
    yield f"{margin} * {line.strip().removeprefix('/** ').removesuffix(' */')}"
    yield f"{margin} */"


def break_lines(text: str) -> str:
    """Break the long lines of a file, except comments, macros and initialisers, which stay unchanged."""
    lines: list[str] = []
    in_comment = False
    for line in text.splitlines():
        in_comment = in_comment or line.lstrip().startswith("/*")
        # Initialisers end in "};", and the lines of a macro in a backslash.
        if in_comment or len(line) <= COLUMNS or line.endswith(("};", "\\")):
            lines.append(line)
        else:
            continues_previous = bool(lines) and lines[-1].endswith(_CONTINUED_LINE)
            lines += _broken_lines(line, continues_previous=continues_previous)
        in_comment = in_comment and not line.endswith("*/")
    return "".join(f"{line}\n" for line in lines)


def _broken_lines(line: str, *, continues_previous: bool) -> Iterator[str]:
    """Yield a long line of code as several, with the comment at its end, as in ``x = y; /* why */``, above them.

    Lines that are only comments are not passed to this function. The parameters of a function's head are on the next
    line.
    """
    code, mark, note = line.rpartition(" /*") if line.endswith("*/") else (line, "", "")
    margin = " " * (len(code) - len(code.lstrip()))
    if mark:
        yield comment(note.removesuffix("*/"), len(margin))
    if len(code) <= COLUMNS or code.startswith("#"):
        yield code.rstrip()
    elif not margin and code.endswith(")"):
        function, _, parameters = code.partition("(")
        yield f"{function}("
        yield from _broken_lines(f"    {parameters}", continues_previous=True)
    else:
        further_margin = margin if continues_previous else f"{margin}    "
        yield from _broken_code(code.lstrip(), margin, further_margin)


def _broken_code(c_code: str, margin: str, further_margin: str) -> Sequence[str]:
    """Break code after a question mark or an assignment if that is enough, else between conditions or anywhere.

    ``further_margin`` begins all lines but the first. A question mark inside two or more brackets does not count. If
    parts are joined by ``|``, neither a question mark nor an assignment counts.
    """
    # It has the length of the code, so that places in it are places in the code.
    without_strings = _STRING_LITERAL.sub(lambda string: "x" * len(string[0]), c_code)
    left_side, mark, _ = without_strings.partition(" ? ")
    open_brackets = left_side.count("(") - left_side.count(")")
    is_inside_brackets = open_brackets > 1
    if not mark or is_inside_brackets:
        left_side, mark, _ = without_strings.partition(" = ")
    # The second line begins here. The space before it is left out.
    second_start = len(left_side) + len(mark)
    two_lines = [margin + c_code[: second_start - 1], further_margin + c_code[second_start:]]
    if mark and " | " not in without_strings and _all_fit(two_lines):
        return two_lines
    lines = _break_code(c_code, without_strings, margin, further_margin, _BREAKS_IN_CONDITIONS)
    return lines if _all_fit(lines) else _break_code(c_code, without_strings, margin, further_margin, _BREAKS_ANYWHERE)


def _all_fit(lines: Sequence[str]) -> bool:
    return max(map(len, lines)) <= COLUMNS


def _break_code(
    c_code: str, without_strings: str, margin: str, further_margin: str, breaks: re.Pattern[str]
) -> list[str]:
    """Break code as late as possible at the spaces that ``breaks`` finds in ``without_strings``, which is as long."""
    break_indices = [space.start() for space in breaks.finditer(without_strings)]
    lines: list[str] = []
    current_line = margin
    start = 0
    for end in (*break_indices, len(c_code)):
        segment = c_code[start:end]
        if start and len(current_line) + len(segment) > COLUMNS:
            lines.append(current_line)
            # The space at the break is left out.
            current_line = further_margin + segment[1:]
        else:
            current_line += segment
        start = end
    return [*lines, current_line]
