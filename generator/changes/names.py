"""Names in generated files that disappear or get a different value: names in C and Python, and files."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

_MACRO_DEFINITION = re.compile(r"^[ \t]*#[ \t]*define[ \t]+(\w+)(\([^)\n]*\))?[ \t]*((?:\\\n|[^\n])*)$", re.MULTILINE)
_C_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
#: A function in a header, with its code: ``static inline bool x24_is_valid(…)``.
_C_FUNCTION = re.compile(r"^static inline [^;{]*?\b(\w+)\([^{;]*\)\n\{\n.*?^\}", re.MULTILINE | re.DOTALL)
#: A constant in a header, with its value: ``static CW_CONST x24_biss X24_BISS_A17 = { 17U };``.
_C_CONSTANT = re.compile(r"^static CW_CONST \w+ (\w+) = ([^;]*);", re.MULTILINE)
_C_ENUMERATION = re.compile(r"^typedef enum \w+ \{(.*?)^\} \w+;", re.MULTILINE | re.DOTALL)
_C_STRUCTURE = re.compile(r"^typedef struct \w+ \{(.*?)^\} (\w+);", re.MULTILINE | re.DOTALL)
#: Name at the end of the declaration of a member, such as ``bytes`` in ``uint8_t bytes[4]``.
_NAME_OF_MEMBER = re.compile(r"(\w+)(?:\[\w*\])*$")
#: Kinds of names whose value is code.
_KINDS_OF_FUNCTIONS = frozenset(("C function", "Python function"))
#: Names of macros that guard a header or contain its version. No code depends on them.
_MACRO_ABOUT_HEADER = re.compile(r"\w+_(?:H|HPP|VERSION|INCLUDED)")
#: Values by the kind and the name of what has them: ``{("C macro", "X24_BITS"): "24"}``.
_Values = dict[tuple[str, str], str]
#: Highest number of characters of a value that are shown.
_LONGEST_VALUE = 40


@dataclass(frozen=True, slots=True)
class NameChange:
    """A name of a family in an output that is gone or has a different value. ``new`` is None if it is gone."""

    family: str
    kind: str
    name: str
    old: str
    new: str | None

    @property
    def is_changed_function(self) -> bool:
        """Whether it is a function that still exists, with different code."""
        return self.kind in _KINDS_OF_FUNCTIONS and self.new is not None

    @property
    def text(self) -> str:
        """The change in words, such as ``C macro X24_BITS: 24 → 26``."""
        if self.new is None:
            return f"{self.kind} {self.name} is gone"
        if self.is_changed_function:
            return f"{self.kind} {self.name} has different code"
        return f"{self.kind} {self.name}: {_shorten_value(self.old)} → {_shorten_value(self.new)}"


def _shorten_value(value: str) -> str:
    """Return a value of at most ``_LONGEST_VALUE`` characters, cut with an ellipsis."""
    if len(value) <= _LONGEST_VALUE:
        return value
    return f"{value[: _LONGEST_VALUE - 1]}…"


def name_changes(
    old_text_by_path: Mapping[str, str], new_text_by_path: Mapping[str, str], families: Iterable[str]
) -> tuple[NameChange, ...]:
    """Return the names in C and Python and the files of families that are gone, or have a different value.

    The value of a function is its code.

    The arguments contain the texts of the generated files by path. Files whose names do not begin with the name of a
    family are left out.
    """
    changes: list[NameChange] = []
    # The name of a family can begin with the name of another family. A file belongs to the longest name that fits.
    longest_first = sorted(families, key=len, reverse=True)
    for path, old_text in old_text_by_path.items():
        new_text = new_text_by_path.get(path)
        family = _family_of_file(path, longest_first)
        if not family or new_text == old_text:
            continue
        if new_text is None:
            changes.append(NameChange(family=family, kind="file", name=path, old="", new=None))
        changes += _changes_in_file(family, path, old_text, new_text or "")
    # The headers of several interfaces define the same macro, whose change is listed once.
    return tuple(dict.fromkeys(changes))


def _family_of_file(path: str, families: Sequence[str]) -> str:
    """Return the first family whose name a file name begins with, such as ``tv62`` for ``c/tv62_biss.h``, or ""."""
    stem = PurePosixPath(path).name.partition(".")[0]
    for family in families:
        if stem == family or stem.startswith(f"{family}_"):
            return family
    return ""


def _is_private_module(path: str) -> bool:
    """Return whether users never import a Python module themselves.

    A part of the path of such a module begins with an underscore or is ``facts``.
    """
    return any(folder.startswith("_") or folder == "facts" for folder in PurePosixPath(path).parts)


def _changes_in_file(family: str, path: str, old_text: str, new_text: str) -> Iterator[NameChange]:
    """Yield the names in a C header or in a Python module that are gone or have a different value.

    New names are not listed. For other files and private modules, nothing is listed.
    """
    if path.endswith(".h"):
        old_values, new_values, prefix = _c_names(old_text), _c_names(new_text), ""
    elif path.endswith(".py") and not _is_private_module(path):
        old_values, new_values, prefix = _python_names(old_text), _python_names(new_text), f"{family}."
    else:
        return
    for (kind, name), old_value in old_values.items():
        new_value = new_values.get((kind, name))
        if new_value == old_value:
            continue
        shown_old, shown_new = old_value, new_value
        if kind in _KINDS_OF_FUNCTIONS:
            # The code of a function is too long to be shown. None still says that the function is gone.
            is_gone = new_value is None
            shown_old = ""
            shown_new = None if is_gone else ""
        yield NameChange(family=family, kind=kind, name=f"{prefix}{name}", old=shown_old, new=shown_new)


def _c_names(header: str) -> _Values:
    """Return the names in a C header: its macros, enumerators, constants, members of structures, and functions.

    The value of a member is its declaration, and that of a function is its code.
    """
    header_without_comments = _C_COMMENT.sub("", header)
    values = {("C macro", name): value for name, value in _parse_macros(header_without_comments).items()}
    for enumerators_text in _C_ENUMERATION.findall(header_without_comments):
        for enumerator in _split_and_strip(enumerators_text, ","):
            name, _, value = enumerator.partition(" = ")
            values["C enumerator", name] = value
    for name, value in _C_CONSTANT.findall(header_without_comments):
        values["C constant", name] = value
    for members_text, structure in _C_STRUCTURE.findall(header_without_comments):
        for declaration in _split_and_strip(members_text, ";"):
            member_match = _NAME_OF_MEMBER.search(declaration)
            if member_match is not None:
                member = member_match[1]
                values["C member", f"{structure}.{member}"] = " ".join(declaration.split())
    for function_match in _C_FUNCTION.finditer(header_without_comments):
        function_code, function_name = function_match[0], function_match[1]
        values["C function", function_name] = " ".join(function_code.split())
    return values


def _split_and_strip(text: str, separator: str) -> list[str]:
    """Return the pieces of a text between separators, without spaces around them and without empty pieces."""
    pieces = [piece.strip() for piece in text.split(separator)]
    return [piece for piece in pieces if piece]


def _parse_macros(header: str) -> dict[str, str]:
    """Return the macros of a header with their definitions on one line: ``{"X24_BITS": "24", "X24_MASK": "(n) …"}``.

    The header has no comments. Include guards and version macros are left out.
    """
    macros: dict[str, str] = {}
    for name, parameters, definition in _MACRO_DEFINITION.findall(header):
        if not _MACRO_ABOUT_HEADER.fullmatch(name):
            in_one_line = f"{parameters} {definition}".replace("\\\n", " ")
            macros[name] = " ".join(in_one_line.split())
    return macros


def _python_names(module: str) -> _Values:
    """Return the public names in the text of a module and in its classes, with the values of constants.

    The value of a function is its code. Another name that is not a constant has the value "".
    """
    statements = ast.parse(module).body
    classes = {statement.name: statement for statement in statements if isinstance(statement, ast.ClassDef)}
    return dict(_named_values(statements, classes))


def _code_of(function: ast.FunctionDef) -> str:
    """Return the text of a function without its docstring."""
    first_statement = function.body[0]
    has_docstring = isinstance(first_statement, ast.Expr) and isinstance(first_statement.value, ast.Constant)
    statements = function.body[1:] if has_docstring else function.body
    return "\n".join((ast.unparse(function.args), *map(ast.unparse, statements)))


def _named_values(
    statements: Iterable[ast.stmt], classes: Mapping[str, ast.ClassDef], prefix: str = ""
) -> Iterator[tuple[tuple[str, str], str]]:
    """Yield the kind and name of each public name that statements bind, with its value.

    The value of a constant is its text, that of a function its code, and otherwise "". Names in a class begin with the
    name of the class: ``(("Python name", "Frame.bits"), "24")``. A class also has the names of its private base
    classes, which are looked up in ``classes``.
    """
    for statement in statements:
        public_names = [name for name in _bound_names(statement) if not name.startswith("_")]
        for name in public_names:
            bound_value = getattr(statement, "value", None)
            value_text = ast.unparse(bound_value) if isinstance(bound_value, ast.Constant) else ""
            if isinstance(statement, ast.FunctionDef):
                yield ("Python function", f"{prefix}{name}"), _code_of(statement)
            else:
                yield ("Python name", f"{prefix}{name}"), value_text
            if isinstance(statement, ast.ClassDef):
                yield from _named_values(statement.body, classes, prefix=f"{prefix}{name}.")
                for base_class in _private_bases(statement, classes):
                    yield from _named_values(base_class.body, classes, prefix=f"{prefix}{name}.")


def _private_bases(class_definition: ast.ClassDef, classes: Mapping[str, ast.ClassDef]) -> Iterator[ast.ClassDef]:
    """Yield the base classes of a class that are private classes of the same module."""
    for base in class_definition.bases:
        if isinstance(base, ast.Name) and base.id.startswith("_") and base.id in classes:
            yield classes[base.id]


def _bound_names(statement: ast.stmt) -> list[str]:
    """Return the names that a class, a function or an assignment binds, or nothing for another statement."""
    match statement:
        case ast.ClassDef(name=name) | ast.FunctionDef(name=name):
            return [name]
        case ast.AnnAssign(target=ast.Name(id=name)):
            return [name]
        case ast.Assign(targets=targets):
            return [target.id for target in targets if isinstance(target, ast.Name)]
    return []
