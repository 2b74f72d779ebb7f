"""A C and C++ text that uses each function, macro, enumerator and type of some headers, each in a function of its own.

It is generated from the text of the headers, so that nothing is forgotten, and has no other code that a compiler could
warn about.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

_FUNCTION = re.compile(r"^static inline ([\w \*]+?)(\w+)\(([^()]*)\)\s*\{", re.MULTILINE)
_CONSTANT = re.compile(r"^static CW_CONST (\w+) (\w+) = \{", re.MULTILINE)
_TABLE = re.compile(r"^static CW_CONST (\w+) (\w+)\[256\] = \{", re.MULTILINE)
_MACRO = re.compile(r"^#define (\w+)(\S*)(?: (.*))?$", re.MULTILINE)
_ENUM = re.compile(r"^typedef enum \w* ?\{(.*?)\} (\w+);", re.MULTILINE | re.DOTALL)
_STRUCT = re.compile(r"^typedef struct \w+ \{.*?^\} (\w+);", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Declared:
    """Return the names that the headers declare at file scope."""

    functions: tuple[tuple[str, str, str], ...]
    macros: Sequence[tuple[str, str]]
    enumerators: tuple[str, ...]
    #: Order codes: type and name of each.
    constants: tuple[tuple[str, str], ...]
    #: Tables of CRCs: type and name of each.
    tables: tuple[tuple[str, str], ...]
    types: tuple[str, ...]
    #: Lines that open the conditions under which a function exists.
    conditions: Mapping[str, tuple[str, ...]]

    @property
    def names(self) -> list[str]:
        return [
            *(name for _, name, _ in self.functions),
            *(name for name, _ in self.macros),
            *self.enumerators,
            *(name for _, name in (*self.constants, *self.tables)),
            *self.types,
        ]


_COMMENT_OR_STRING = re.compile(r'/\*.*?\*/|"(?:[^"\\\n]|\\.)*"', re.DOTALL)


def without_texts(text: str) -> str:
    """Return the code of a header: no comments, no texts in strings except file names, and continued lines joined."""
    code = _COMMENT_OR_STRING.sub(_emptied, text)
    return code.replace("\\\n", " ")


def _emptied(found: re.Match[str]) -> str:
    if found[0].startswith("/*"):
        return " "
    return found[0] if found[0].endswith('.h"') else '""'


def without_nodiscard(code: str) -> str:
    """Return the code without the mark for results that must not be ignored. Its spelling depends on the compiler."""
    word = r"^#ifndef (\w+_NODISCARD)\n.*?^#endif\n#endif\n|^(\w+_NODISCARD|CW_CONSTEXPR)\n"
    return re.sub(word, "", code, flags=re.MULTILINE | re.DOTALL)


#: Macros with arguments: a length at compile time, and a check that can be omitted.
_WITH_ARGUMENTS = ("_RECEIVE", "CW_ASSERT")
#: Macros that are keywords of the language.
_WORDS = ("CW_CONSTEXPR", "CW_CONST")


def declared(texts: Iterable[str]) -> Declared:
    """Everything that the headers with these texts declare."""
    code = "\n".join(map(without_nodiscard, map(without_texts, texts)))
    functions = tuple((kind.strip(), name, " ".join(given.split())) for kind, name, given in _FUNCTION.findall(code))
    # A name that the expressions above miss would be unused without notice.
    constants = tuple((kind, name) for kind, name in _CONSTANT.findall(code))
    tables = tuple((kind, name) for kind, name in _TABLE.findall(code))
    statics = len(re.findall(r"^static ", code, re.MULTILINE))
    assert len(functions) + len(constants) + len(tables) == statics, "a static that is none of them"
    macros = [
        (name, value.strip())
        for name, rest, value in _MACRO.findall(code)
        if name not in _WORDS and (not name.endswith("_H") or value.strip())
    ]
    with_arguments = {name for name, rest, _ in _MACRO.findall(code) if rest}
    assert all(name.endswith(_WITH_ARGUMENTS) for name in with_arguments), "a macro with arguments"
    enums = _ENUM.findall(code)
    assert len(enums) == len(re.findall(r"\benum\b", code)), "an enumeration that is no type"
    enumerators = tuple(item.split("=")[0].strip() for body, _ in enums for item in body.split(","))
    return Declared(
        functions,
        macros,
        enumerators,
        constants,
        tables,
        (*(name for _, name in enums), *_STRUCT.findall(code)),
        dict(_conditions(code)),
    )


def _conditions(code: str) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Return each function that only some settings have, with the lines that select them.

    Guards and the check for C++ are not settings.
    """
    opened: list[str] = []
    for line in code.splitlines():
        word = (line.split() or [""])[0]
        if word in ("#if", "#ifdef", "#ifndef"):
            opened.append(line)
        elif word == "#else":
            opened[-1] = f"{'#ifndef' if opened[-1].startswith('#ifdef') else '#ifdef'} {opened[-1].split()[1]}"
        elif word == "#endif":
            opened.pop()
        found = re.match(r"static (?:inline|CW_CONST) [\w \*]+?(\w+)[\[(]", line)
        settings = tuple(item for item in opened if not item.endswith("_H") and item != "#ifdef __cplusplus")
        if found and settings:
            yield found[1], settings


def included(header: str, include: Path) -> list[str]:
    """Return the header, given by its path below ``include``, after those that it includes."""
    text = (include / header).read_text(encoding="ascii")
    found = re.findall(r'^#include "((?:\w+/)?\w+\.h)"', text, re.MULTILINE)
    places = [name if "/" in name else f"codewheel/{name}" for name in found]
    return [*(item for name in places for item in included(name, include)), header]


def use_everything(headers: Sequence[str], include: Path) -> str:
    """Return a text that includes these headers, given by their paths below ``include``.

    It uses everything that they and the included headers of the runtime declare.
    """
    every = dict.fromkeys(item for header in headers for item in included(header, include))
    found = declared((include / header).read_text(encoding="ascii") for header in every)
    lines = [f'#include "{header}"' for header in headers]
    for kind, name, given in found.functions:
        arguments = "" if given == "void" else ", ".join(re.findall(r"(\w+)(?:\[\d*\])?(?:,|$)", given))
        made = _function(kind, name, given, f"{'' if kind == 'void' else 'return '}{name}({arguments});")
        settings = found.conditions.get(name, ())
        lines += [*settings, *made, *("#endif" for _ in settings)]
    for name, value in found.macros:
        if name.endswith(_WITH_ARGUMENTS):
            continue
        if value.startswith('"'):
            lines += _function("const char *", name, "void", f"return {name};")
        else:
            lines += _function("int", name, "void", f"return {name} != 0;")
    for kind, name in found.tables:
        settings = found.conditions.get(name, ())
        lines += [
            *settings,
            *_function(f"const {kind} *", name, "void", f"return {name};"),
            *("#endif" for _ in settings),
        ]
    for kind, name in found.constants:
        # Two functions use it, because MISRA 8.9 requires an object that only one function uses to be defined in it.
        for function in (name, f"{name}_again"):
            lines += _function(f"const {kind} *", function, "void", f"return &{name};")
    if "codewheel/bits.h" in every:
        lines += _function("int", "CW_CONST", "void", "CW_CONST int value = 1;", "return value;")
    for name in found.enumerators:
        lines += _function("int", name, "void", f"return {name} != 0;")
    for name in found.types:
        lines += _function(f"const {name} *", name, f"const {name} *value", "return value;")
    return "\n".join(lines) + "\n"


def _function(kind: str, name: str, given: str, *body: str) -> list[str]:
    """Return a function with its prototype, as strict warnings require."""
    head = f"{kind}{'' if kind.endswith('*') else ' '}use_{name}({given})"
    return [f"{head};", head, "{", *(f"    {line}" for line in body), "}"]
