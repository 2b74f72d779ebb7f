"""Names in generated files that disappear or get a different value: C macros, Python names and files."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

_MACRO_DEFINITION = re.compile(r"^[ \t]*#[ \t]*define[ \t]+(\w+)(\([^)\n]*\))?[ \t]*((?:\\\n|[^\n])*)$", re.MULTILINE)
_C_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
#: Names of macros that guard a header or contain its version. No code depends on them.
_MACRO_ABOUT_HEADER = re.compile(r"\w+_(?:H|HPP|VERSION|INCLUDED)")
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
    def text(self) -> str:
        """The change in words, such as ``C macro X24_BITS: 24 → 26``."""
        if self.new is None:
            return f"{self.kind} {self.name} is gone"
        return f"{self.kind} {self.name}: {_shorten_value(self.old)} → {_shorten_value(self.new)}"


def _shorten_value(value: str) -> str:
    """Return a value of at most ``_LONGEST_VALUE`` characters, cut with an ellipsis."""
    if len(value) <= _LONGEST_VALUE:
        return value
    return f"{value[: _LONGEST_VALUE - 1]}…"


def name_changes(
    old_text_by_path: Mapping[str, str], new_text_by_path: Mapping[str, str], families: Iterable[str]
) -> tuple[NameChange, ...]:
    """Return the C macros, Python names and files of families that are gone, or have a different value.

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
    """Yield the macros of a C header, or the names in a Python module, that are gone or have a different value.

    New names are not listed. For other files and private modules, nothing is listed.
    """
    if path.endswith(".h"):
        kind = "C macro"
        old_value_by_name = _parse_macros(old_text)
        new_value_by_name = _parse_macros(new_text)
    elif path.endswith(".py") and not _is_private_module(path):
        kind = "Python name"
        old_value_by_name = _python_names(old_text)
        new_value_by_name = _python_names(new_text)
    else:
        return
    for name, old_value in old_value_by_name.items():
        new_value = new_value_by_name.get(name)
        if new_value != old_value:
            full_name = name if kind == "C macro" else f"{family}.{name}"
            yield NameChange(family=family, kind=kind, name=full_name, old=old_value, new=new_value)


def _parse_macros(header: str) -> dict[str, str]:
    """Return the macros of a header with their definitions on one line: ``{"X24_BITS": "24", "X24_MASK": "(n) …"}``.

    Include guards and version macros are left out.
    """
    macros: dict[str, str] = {}
    header_without_comments = _C_COMMENT.sub("", header)
    for name, parameters, definition in _MACRO_DEFINITION.findall(header_without_comments):
        if not _MACRO_ABOUT_HEADER.fullmatch(name):
            in_one_line = f"{parameters} {definition}".replace("\\\n", " ")
            macros[name] = " ".join(in_one_line.split())
    return macros


def _python_names(module: str) -> dict[str, str]:
    """Return the public names in the text of a module and in its classes, with the values of constants.

    A name that is not a constant has the value "": ``{"CRC_BITS": "6", "Frame": "", "Frame.decode": ""}``.
    """
    statements = ast.parse(module).body
    classes = {statement.name: statement for statement in statements if isinstance(statement, ast.ClassDef)}
    return dict(_named_values(statements, classes))


def _named_values(
    statements: Iterable[ast.stmt], classes: Mapping[str, ast.ClassDef], prefix: str = ""
) -> Iterator[tuple[str, str]]:
    """Yield the public names that statements bind, each with the text of its value if that is a constant, or else "".

    Names in a class begin with the name of the class: ``("Frame.decode", "")``. A class also has the names of its
    private base classes, which are looked up in ``classes``.
    """
    for statement in statements:
        public_names = [name for name in _bound_names(statement) if not name.startswith("_")]
        for name in public_names:
            bound_value = getattr(statement, "value", None)
            value_text = ast.unparse(bound_value) if isinstance(bound_value, ast.Constant) else ""
            yield f"{prefix}{name}", value_text
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
