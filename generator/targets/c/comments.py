"""Comments in C: text of a spec in ASCII, the style of sentences, and the breaking of long lines."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ...say import in_ascii, text_on_one_line
from ...say.text import TITLE_STYLE, Statement, Style
from .names import string

COLUMNS = 100
#: The smallest width of a text after its lead.
_NARROWEST_TEXT = 36

#: A paragraph of a comment. A pair is a lead, such as ``@param out ``, and its text. The lines after the first are
#: indented by the width of the lead.
Paragraph = str | tuple[str, str]

#: Signs that comments spell in their own way.
_ASCII_SPELLINGS = {"±": "+/-", "°": " deg ", "Ω": "ohm"}


def ascii_text(text: object) -> str:
    """Return text in ASCII, with single spaces."""
    return re.sub(" +", " ", in_ascii(text_on_one_line(text).replace("N°", "No."), _ASCII_SPELLINGS)).strip()


def in_comment(text: object) -> str:
    """Return ``text`` in a form that is safe in a comment.

    Nothing in it begins or ends a comment, continues a line with a backslash, or is a trigraph.
    """
    safe = ascii_text(text).replace("\\", "|")
    # One pass leaves two adjacent question marks if there were three.
    while "??" in safe:
        safe = safe.replace("??", "? ?")
    return _separate_comment_marks(safe)


def _separate_comment_marks(text: str) -> str:
    """Return a text with a space between every adjacent star and slash, so that no comment begins or ends there."""
    return re.sub(r"\*(?=/)|/(?=\*)", lambda match: match[0] + " ", text)


def comment(paragraphs: Sequence[Paragraph] | str, indent: int = 0) -> str:
    """Format paragraphs as a C comment, on one line if it fits.

    ``indent`` is the number of spaces before each line. In a sequence, empty paragraphs are omitted. An empty line
    separates the first ``@param`` from the text above it.
    """
    if isinstance(paragraphs, str):
        leads_and_texts = [("", paragraphs)]
    else:
        leads_and_texts = [(lead, text) for lead, text in map(_lead_and_text, paragraphs) if text]
    margin = " " * indent
    lines: list[str] = []
    for lead, text in leads_and_texts:
        is_first_parameter = lead.startswith("@") and bool(lines) and not lines[-1].startswith(("@", " "))
        if is_first_parameter:
            lines.append("")
        # 3 characters are " * ".
        lines += _wrap_paragraph(lead, text, COLUMNS - indent - 3)
    # 6 characters are the marks of a comment on one line.
    if len(lines) == 1 and len(lines[0]) + indent + 6 <= COLUMNS:
        return f"{margin}/* {lines[0]} */"
    body = "\n".join(f"{margin} * {line}".rstrip() for line in lines)
    return f"{margin}/*\n{body}\n{margin} */"


def _wrap_paragraph(lead: str, text: str, width: int) -> Iterator[str]:
    """Yield the lines of a paragraph of a comment, at most ``width`` characters long if its words allow.

    The text begins after its lead, or below it if the lead is too long.
    """
    safe_lead = in_comment_lead(lead)
    # 3 characters are " * ", which ``width`` leaves out.
    if len(safe_lead) > width + 3 - _NARROWEST_TEXT:
        yield _separate_comment_marks(safe_lead.rstrip())
        safe_lead = "        "
    wrapped = textwrap.wrap(in_comment(text), width - len(safe_lead), break_long_words=False, break_on_hyphens=False)
    first_line, *further_lines = wrapped or [""]
    yield _separate_comment_marks(safe_lead + first_line)
    for line in further_lines:
        yield _separate_comment_marks(" " * len(safe_lead) + line)


def _lead_and_text(paragraph: Paragraph) -> tuple[str, str]:
    """Return a paragraph as its lead, which is empty for a plain text, and its text."""
    return ("", paragraph) if isinstance(paragraph, str) else paragraph


def comment_lines(paragraphs: Sequence[Paragraph] | str) -> str:
    """Format paragraphs as lines inside a comment that the template opens and closes, each with `` * ``."""
    comment_with_marks = comment(paragraphs)
    first_line, *further_lines = comment_with_marks.splitlines()
    if not further_lines:
        return f" * {first_line.removeprefix('/* ').removesuffix(' */')}"
    # The first and the last line of a longer comment are only its marks.
    lines_without_marks = further_lines[:-1]
    return "\n".join(lines_without_marks)


def in_comment_lead(text: str) -> str:
    """Return the lead of a paragraph in a form that is safe in a comment, with all its spaces."""
    return re.sub("[^ ]+", lambda word: in_comment(word[0]), text)


class InHeader(Style):
    """The style of sentences in headers, which mentions an erratum only briefly, with the value used instead.

    Differences from other editions of the manual are left out.
    """

    def sentence(self, statement: Statement) -> str:
        """Return the sentence of a statement, or its brief form if it has one."""
        if statement.brief is None:
            return super().sentence(statement)
        return self.text(statement.brief)


HEADER_STYLE = InHeader(text=TITLE_STYLE.text, code=TITLE_STYLE.code, ref=TITLE_STYLE.ref)


#: Places where a long line may be broken, the better ones first.
_BREAKS_IN_CONDITIONS = re.compile(r"(?<= &&) |(?<= \|\|) ")
_BREAKS_ANYWHERE = re.compile(r"(?<= &&) |(?<= \|\|) |(?<= \|) |(?<= \^) |(?<= \+) |(?<= -) |(?<=,) (?=[A-Za-z&(])")
_STRING_LITERAL = re.compile(r'"(?:\\.|[^"\\])*"')
#: A comment that begins a line, except titles of sections, and one that follows a declaration or a macro.
_COMMENT_OPENING = re.compile(r"\s*/\*(?: (?!-- )|$)")
_AT_END = re.compile(r"^(\s*[A-Za-z#](?:(?!/\*).)*) /\* (?=[^*]*\*/$)")
#: The end of a line that the next one continues.
_CONTINUED_LINE = ("(", " =", " |")


def end_comment(note: object) -> str:
    """Return a comment for the end of a line. ``break_lines`` moves it above the line if the line gets too long."""
    safe_note = in_comment(note)
    return f" /* {safe_note} */" if safe_note else ""


def call_in_lines(parts: Sequence[str], indent: int) -> str:
    """Return a function call on one line, or with each argument on its own line if that is too long.

    ``parts`` are the start of the call, such as ``f(``, and the arguments with their commas.
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
    *first_lines, last_line = lines or [""]
    string_literals = [string(f"{line} ") for line in first_lines]
    string_literals.append(string(last_line))
    return f"\n{' ' * indent}".join(string_literals)


def mark_for_doxygen(text: str) -> str:
    """Return a header in which the comments above and after declarations have the marks of Doxygen.

    A comment that becomes too long for the end of its line moves above the line.
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
            lines += _mark_line_for_doxygen(line)
    return "".join(f"{line}\n" for line in lines)


def _mark_line_for_doxygen(line: str) -> Iterator[str]:
    """Yield a line whose comment has the mark of Doxygen: ``/**`` if it begins the line, ``/**<`` if it ends it.

    A comment that gets too long at the end goes above the line, as ``/**``.
    """
    if _COMMENT_OPENING.match(line):
        yield from _fit_doxygen_comment(line.replace("/*", "/**", 1))
        return
    marked = _AT_END.sub(r"\1 /**< ", line)
    if marked == line or len(marked) <= COLUMNS:
        yield marked
        return
    code, _, note = line.rpartition(" /* ")
    margin = " " * (len(code) - len(code.lstrip()))
    yield from _fit_doxygen_comment(f"{margin}/** {note}")
    yield code.rstrip()


def _fit_doxygen_comment(line: str) -> Iterator[str]:
    """Yield a Doxygen comment on one line, or as three lines if one is too long."""
    if len(line) <= COLUMNS:
        yield line
        return
    margin = " " * (len(line) - len(line.lstrip()))
    yield f"{margin}/**"
    yield f"{margin} * {line.strip().removeprefix('/** ').removesuffix(' */')}"
    yield f"{margin} */"


def break_lines(text: str) -> str:
    """Return a C file with its long lines broken, except comments, initializers and macros.

    Comments and initializers stay unchanged. Of a macro, only its last line is broken, with a backslash at each break.
    """
    lines: list[str] = []
    is_in_comment = False
    is_in_macro = False
    for line in text.splitlines():
        is_in_comment = is_in_comment or line.lstrip().startswith("/*")
        # Initializers end in "};", and the lines of a macro in a backslash.
        if is_in_comment or len(line) <= COLUMNS or line.endswith(("};", "\\")):
            lines.append(line)
        else:
            continues_previous = bool(lines) and lines[-1].endswith(_CONTINUED_LINE)
            separator = " \\\n" if is_in_macro else "\n"
            lines.append(separator.join(_broken_lines(line, continues_previous=continues_previous)))
        is_in_comment = is_in_comment and not line.endswith("*/")
        is_in_macro = line.endswith("\\")
    return "".join(f"{line}\n" for line in lines)


def _broken_lines(line: str, *, continues_previous: bool) -> Iterator[str]:
    """Yield a long line of code as several lines. A comment at its end, as in ``x = y; /* why */``, goes above them.

    The parameters in the head of a function go to the next line. ``continues_previous`` is True if the line already
    continues another one, so that its further lines need no more indentation.
    """
    code, comment_start, note = line.rpartition(" /*") if line.endswith("*/") else (line, "", "")
    margin = " " * (len(code) - len(code.lstrip()))
    if comment_start:
        yield comment(note.removesuffix("*/"), len(margin))
    if len(code) <= COLUMNS or code.startswith("#"):
        yield code.rstrip()
    elif not margin and code.endswith(")"):
        function, _, parameters = code.partition("(")
        yield f"{function}("
        yield from _broken_lines(f"    {parameters}", continues_previous=True)
    else:
        further_margin = margin if continues_previous else f"{margin}    "
        c_code = code.lstrip()
        # The replacement has the same length, so that indexes in it are indexes in the code.
        without_strings = _STRING_LITERAL.sub(lambda string: "x" * len(string[0]), c_code)
        yield from _broken_code(_LongCode(c_code, without_strings, margin=margin, further_margin=further_margin))


def _broken_code(code: _LongCode) -> list[str]:
    """Return a long statement as several lines: broken after an operator, between conditions, or at any space.

    The first of these that makes all lines short enough is used.
    """
    two_lines = _break_after_operator(code)
    if two_lines and _all_fit(two_lines):
        return two_lines
    lines_by_condition = _break_at(_BREAKS_IN_CONDITIONS, code)
    return lines_by_condition if _all_fit(lines_by_condition) else _break_at(_BREAKS_ANYWHERE, code)


def _break_after_operator(code: _LongCode) -> list[str]:
    """Return code as two lines, broken after its first question mark, or else after its first assignment.

    A question mark inside two or more brackets does not count. The list is empty without such an operator, and for code
    with ``|``.
    """
    if " | " in code.without_strings:
        return []
    for operator in (" ? ", " = "):
        left_side, operator_or_empty, _ = code.without_strings.partition(operator)
        open_brackets = left_side.count("(") - left_side.count(")")
        is_inside_brackets = operator == " ? " and open_brackets > 1
        if operator_or_empty and not is_inside_brackets:
            end_of_first_line = len(left_side + operator.rstrip())
            # The space at the break is left out.
            second_line = code.c_code[end_of_first_line + 1 :]
            return [code.margin + code.c_code[:end_of_first_line], code.further_margin + second_line]
    return []


def _all_fit(lines: Sequence[str]) -> bool:
    return max(map(len, lines)) <= COLUMNS


class _LongCode(NamedTuple):
    """A statement that is longer than a line.

    ``without_strings`` is the same code with other characters in its string literals. ``margin`` is the space before
    the first line, and ``further_margin`` the space before the others.
    """

    c_code: str
    without_strings: str
    margin: str
    further_margin: str


def _break_at(breaks: re.Pattern[str], code: _LongCode) -> list[str]:
    """Return code as lines, broken as late as possible at spaces outside strings that ``breaks`` finds."""
    c_code, further_margin = code.c_code, code.further_margin
    break_indices = [space.start() for space in breaks.finditer(code.without_strings)]
    lines: list[str] = []
    current_line = code.margin
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


def without_special_characters(text: str) -> str:
    """Return ``text`` with single spaces in place of all characters special to CMake, Kconfig or pkg-config."""
    plain_text = re.sub(r"[^A-Za-z0-9 .,:/+&-]+", " ", ascii_text(text))
    return " ".join(plain_text.split())
