"""The declarations in the text of a C header: where each begins and ends, what it declares, and what it needs."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence, Set
from itertools import chain

from ...model.record import dataclass

_NAME = re.compile(r"[A-Za-z_]\w*")
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_DEFINED = re.compile(r"^#define (\w+)", re.MULTILINE)
#: The member of an enumeration, and its value.
_MEMBER = re.compile(r"^ +(\w+) = ", re.MULTILINE)
_CONDITION = re.compile(r"#(if|el|endif)")
_FUNCTION = re.compile(r"(\w+)\(")
#: What opens and closes the scope of C in a header.
_OPENS_C, _CLOSES_C = 'extern "C" {\n#endif\n', "#ifdef __cplusplus\n}\n#endif\n"


@dataclass(frozen=True, slots=True)
class Declaration:
    """A function, a type, a constant or a macro, or a comment or the title of a section, which declare nothing.

    ``comment`` is the comment above it.
    """

    comment: str
    code: str

    @property
    def text(self) -> str:
        return self.comment + self.code

    @property
    def is_title(self) -> bool:
        return self.comment.startswith("/* -- ")

    @property
    def plain_code(self) -> str:
        """The code without comments."""
        return _COMMENT.sub("", self.code)

    @property
    def names(self) -> tuple[str, ...]:
        """The names that it declares."""
        code = self.plain_code
        if code.startswith("#if"):
            inner_lines = [line for line in self.code.splitlines(keepends=True) if not _CONDITION.match(line)]
            return tuple(sorted(names_of(_declarations(inner_lines))))
        macros = tuple(_DEFINED.findall(code))
        if macros:
            return macros
        if code.startswith("typedef"):
            last_line = code.rstrip().splitlines()[-1]
            members = _MEMBER.findall(code) if code.startswith("typedef enum") else []
            return (*_NAME.findall(last_line)[-1:], *members)
        head = code.partition("{")[0].partition("=")[0]
        function = _FUNCTION.search(head)
        if function is not None and "static inline" in head:
            return (function[1],)
        constant = _NAME.findall(head.partition("[")[0])
        return tuple(constant[-1:])

    @property
    def used_names(self) -> frozenset[str]:
        """All names in its code."""
        return frozenset(_NAME.findall(self.plain_code))

    @property
    def is_function(self) -> bool:
        return self.code.rstrip().endswith("\n}")

    @property
    def has_macro(self) -> bool:
        return self.code.startswith("#define")


def declarations_in(header: str) -> list[Declaration]:
    """Return the declarations of a header in their order, without what surrounds the scope of C."""
    body = header.partition(_OPENS_C)[2].rpartition(_CLOSES_C)[0]
    return list(_declarations(body.splitlines(keepends=True)))


def _declarations(lines: Sequence[str]) -> Iterator[Declaration]:
    comment = ""
    index = 0
    while index < len(lines):
        line = lines[index]
        end = _end_of_comment(lines, index) if line.startswith("/*") else index
        if line.startswith("/*"):
            if comment:
                yield Declaration(comment, "")
            comment = "".join(lines[index:end])
        elif line.strip():
            end = _end_of_code(lines, index)
            yield Declaration(comment, "".join(lines[index:end]))
            comment = ""
        else:
            end = index + 1
            if comment:
                yield Declaration(comment, "")
            comment = ""
        index = end


def _end_of_comment(lines: Sequence[str], start: int) -> int:
    end = start
    while not lines[end].rstrip().endswith("*/"):
        end += 1
    return end + 1


def _end_of_code(lines: Sequence[str], start: int) -> int:
    """Return the index after the last line of a declaration."""
    if lines[start].startswith("#define"):
        return _end_of_macro(lines, start)
    if lines[start].startswith("#if"):
        return _end_of_condition(lines, start)
    end = start
    depth = 0
    while True:
        code = _COMMENT.sub("", lines[end]).rstrip()
        depth += code.count("{") - code.count("}")
        end += 1
        if depth == 0 and (code.endswith(";") or code == "}"):
            return end


def _end_of_macro(lines: Sequence[str], start: int) -> int:
    end = start
    while lines[end].endswith("\\\n"):
        end += 1
    return end + 1


def _end_of_condition(lines: Sequence[str], start: int) -> int:
    end = start
    depth = 0
    while True:
        depth += lines[end].startswith("#if") - lines[end].startswith("#endif")
        end += 1
        if depth == 0:
            return end


def without_settings(text: str, settings: Collection[str]) -> str:
    """Return a text in which no macro of ``settings`` is defined, so that its conditions on them are gone."""
    lines: list[str] = []
    #: For each open condition: True if it is one on a setting, and True if its lines are kept.
    conditions: list[tuple[bool, bool]] = []
    for line in text.splitlines(keepends=True):
        word, _, name = line.rstrip().partition(" ")
        if word.startswith("#if"):
            is_setting = name in settings
            conditions.append((is_setting, not is_setting or word == "#ifndef"))
        elif word == "#else" and conditions[-1][0]:
            conditions[-1] = (True, not conditions[-1][1])
        on_setting = bool(conditions) and conditions[-1][0] and word in {"#ifdef", "#ifndef", "#else", "#endif"}
        if not on_setting and all(is_kept for _, is_kept in conditions):
            lines.append(line)
        if word == "#endif":
            conditions.pop()
    return "".join(lines)


def needed_by(roots: Iterable[str], declarations: Sequence[Declaration]) -> list[Declaration]:
    """Return the declarations that ``roots`` name, those that they need, and the titles above them, in their order."""
    owners = {name: declaration for declaration in declarations for name in declaration.names}
    waiting = [name for name in roots if name in owners]
    needed_names: set[str] = set()
    while waiting:
        name = waiting.pop()
        if name not in needed_names:
            needed_names |= set(owners[name].names)
            waiting += (used for used in owners[name].used_names if used in owners)
    return list(_titled(declarations, needed_names))


def _titled(declarations: Iterable[Declaration], needed_names: Set[str]) -> Iterator[Declaration]:
    """Yield the needed declarations, and each title that has one of them below it."""
    title: Declaration | None = None
    for declaration in declarations:
        if declaration.is_title:
            title = declaration
        elif not needed_names.isdisjoint(declaration.names):
            if title is not None:
                yield title
            title = None
            yield declaration


def names_of(declarations: Iterable[Declaration]) -> set[str]:
    return set(chain.from_iterable(declaration.names for declaration in declarations))
