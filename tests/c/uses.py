"""A C and C++ text that uses each function, macro, enumerator and type of some headers, each in a function of its own.

It is generated from the text of the headers, so that nothing is forgotten, and has no other code that a compiler could
warn about.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
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
    #: The names of macros with arguments.
    function_macros: Set[str]
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


def _emptied(match: re.Match[str]) -> str:
    if match[0].startswith("/*"):
        return " "
    return match[0] if match[0].endswith('.h"') else '""'


def without_nodiscard(code: str) -> str:
    """Return the code without the marks whose spelling depends on the compiler.

    These are the mark for results that must not be ignored, and the mark for functions that are shorter than a call.
    """
    definitions = r"^#ifndef (\w+_NODISCARD)\n.*?^#endif\n#endif\n|^#ifdef __GNUC__\n#define CW_INLINE .*?^#endif\n"
    marks = rf"{definitions}|^(\w+_NODISCARD CW_CONSTEXPR|\w+_NODISCARD|CW_CONSTEXPR|CW_INLINE)\n"
    return re.sub(marks, "", code, flags=re.MULTILINE | re.DOTALL)


#: Macros with arguments: a length at compile time, and a check that can be omitted.
_WITH_ARGUMENTS = ("_RECEIVE", "_READ", "_READ_BYTES", "_READ_TWICE", "CW_ASSERT", "CW_SIZE_OF")
#: Macros that are keywords of the language.
_WORDS = ("CW_CONSTEXPR", "CW_CONST", "CW_INLINE")


def declared(texts: Iterable[str]) -> Declared:
    """Everything that the headers with these texts declare."""
    code = "\n".join(map(without_nodiscard, map(without_texts, texts)))
    heads = _FUNCTION.findall(code)
    functions = tuple((kind.strip(), name, " ".join(arguments.split())) for kind, name, arguments in heads)
    # A name that the expressions above miss would be unused without notice.
    constants = tuple((kind, name) for kind, name in _CONSTANT.findall(code))
    tables = tuple((kind, name) for kind, name in _TABLE.findall(code))
    statics = len(re.findall(r"^static ", code, re.MULTILINE))
    assert len(functions) + len(constants) + len(tables) == statics, "a static that is none of them"
    macros = []
    with_arguments = set[str]()
    for name, arguments, value in _MACRO.findall(code):
        if name not in _WORDS and (not name.endswith("_H") or value.strip()):
            macros.append((name, value.strip()))
        if arguments:
            with_arguments.add(name)
    assert all(name.endswith(_WITH_ARGUMENTS) for name in with_arguments), "a macro with arguments"
    enums = _ENUM.findall(code)
    assert len(enums) == len(re.findall(r"\benum\b", code)), "an enumeration that is no type"
    enumerators = tuple(enumerator.split("=")[0].strip() for body, _ in enums for enumerator in body.split(","))
    return Declared(
        functions=functions,
        macros=macros,
        function_macros=with_arguments,
        enumerators=enumerators,
        constants=constants,
        tables=tables,
        types=(*(name for _, name in enums), *_STRUCT.findall(code)),
        conditions=dict(_conditions(code)),
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
        match = re.match(r"static (?:inline|CW_CONST) [\w \*]+?(\w+)[\[(]", line)
        conditions = [condition for condition in opened if condition != "#ifdef __cplusplus"]
        settings = tuple(condition for condition in conditions if not condition.endswith("_H"))
        if match and settings:
            yield match[1], settings


def included(header: str, include: Path) -> list[str]:
    """Return the header, given by its path below ``include``, after those that it includes."""
    text = (include / header).read_text(encoding="ascii")
    names = re.findall(r'^#include "((?:\w+/)?\w+\.h)"', text, re.MULTILINE)
    places = [name if "/" in name else f"codewheel/{name}" for name in names]
    return [*(inner for name in places for inner in included(name, include)), header]


def use_everything(headers: Sequence[str], include: Path) -> str:
    """Return a text that includes these headers, given by their paths below ``include``.

    It uses everything that they and the included headers of the runtime declare.
    """
    paths = dict.fromkeys(path for header in headers for path in included(header, include))
    declarations = declared((include / header).read_text(encoding="ascii") for header in paths)
    lines = [f'#include "{header}"' for header in headers]
    for kind, name, parameters in declarations.functions:
        arguments = "" if parameters == "void" else ", ".join(re.findall(r"(\w+)(?:\[\d*\])?(?:,|$)", parameters))
        function_lines = _function(kind, name, parameters, f"{'' if kind == 'void' else 'return '}{name}({arguments});")
        settings = declarations.conditions.get(name, ())
        lines += [*settings, *function_lines, *("#endif" for _ in settings)]
    lines += _use_macros(macro for macro in declarations.macros if macro[0] not in declarations.function_macros)
    for kind, name in declarations.tables:
        settings = declarations.conditions.get(name, ())
        lines += [
            *settings,
            *_function(f"const {kind} *", name, "void", f"return {name};"),
            *("#endif" for _ in settings),
        ]
    for kind, name in declarations.constants:
        # Two functions use it, because MISRA 8.9 requires an object that only one function uses to be defined in it.
        for function in (name, f"{name}_again"):
            lines += _function(f"const {kind} *", function, "void", f"return &{name};")
    if "codewheel/bits.h" in paths:
        lines += _function("int", "CW_CONST", "void", "CW_CONST int value = 1;", "return value;")
        lines += _function("size_t", "CW_SIZE_OF", "void", "uint8_t rx[4] = { 0U };", "return CW_SIZE_OF(rx, 4U);")
    for name in declarations.enumerators:
        lines += _function("int", name, "void", f"return {name} != 0;")
    for name in declarations.types:
        lines += _function(f"const {name} *", name, f"const {name} *value", "return value;")
    return "\n".join(lines) + "\n"


def _use_macros(macros: Iterable[tuple[str, str]]) -> Iterator[str]:
    for name, value in macros:
        is_text = value.startswith('"')
        statement = f"return {name};" if is_text else f"return {name} != 0;"
        yield from _function("const char *" if is_text else "int", name, "void", statement)


def _function(kind: str, name: str, parameters: str, *body: str) -> list[str]:
    """Return a function with its prototype, as strict warnings require."""
    head = f"{kind}{'' if kind.endswith('*') else ' '}use_{name}({parameters})"
    return [f"{head};", head, "{", *(f"    {line}" for line in body), "}"]
