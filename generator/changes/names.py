"""Names of generated files that go, or that keep their name with another value: C macros, Python names and files."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

_MACRO = re.compile(r"^[ \t]*#[ \t]*define[ \t]+(\w+)(\([^)\n]*\))?[ \t]*((?:\\\n|[^\n])*)$", re.MULTILINE)
_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
#: Macros that guard a header or contain its version, which no code depends on.
_OF_HEADER = re.compile(r"\w+_(?:H|HPP|VERSION|INCLUDED)")
_LONGEST_VALUE = 40


@dataclass(frozen=True, slots=True)
class NameChange:
    """A name of a family in an output. ``new`` is None if it is gone."""

    family: str
    kind: str
    name: str
    old: str
    new: str | None

    @property
    def text(self) -> str:
        if self.new is None:
            return f"{self.kind} {self.name} is gone"
        return f"{self.kind} {self.name}: {_shortened(self.old)} → {_shortened(self.new)}"


def _shortened(value: str) -> str:
    return value if len(value) <= _LONGEST_VALUE else f"{value[: _LONGEST_VALUE - 1]}…"


def name_changes(
    before: Mapping[str, str], after: Mapping[str, str], families: Iterable[str]
) -> tuple[NameChange, ...]:
    """Return the names of C headers and Python modules of families, and the files, that go or change their value."""
    changes: list[NameChange] = []
    names_by_length = sorted(families, key=len, reverse=True)
    for path, old_text in before.items():
        new_text = after.get(path)
        family = _family_of(path, names_by_length)
        if not family or new_text == old_text:
            continue
        if new_text is None:
            changes.append(NameChange(family, "file", path, "", None))
        changes += _in_file(family, path, old_text, new_text or "")
    # A macro is in the header of each interface.
    return tuple(dict.fromkeys(changes))


def _family_of(path: str, names_by_length: Sequence[str]) -> str:
    stem = PurePosixPath(path).name.partition(".")[0]
    return next((name for name in names_by_length if stem == name or stem.startswith(f"{name}_")), "")


def _is_private(path: str) -> bool:
    return any(part.startswith("_") or part == "facts" for part in PurePosixPath(path).parts)


def _in_file(family: str, path: str, old_text: str, new_text: str) -> Iterator[NameChange]:
    if path.endswith(".h"):
        kind, old_values, new_values = "C macro", _macros(old_text), _macros(new_text)
    elif path.endswith(".py") and not _is_private(path):
        kind, old_values, new_values = "Python name", _python_names(old_text), _python_names(new_text)
    else:
        return
    for name, old_value in old_values.items():
        new_value = new_values.get(name)
        if new_value != old_value:
            full_name = name if kind == "C macro" else f"{family}.{name}"
            yield NameChange(family, kind, full_name, old_value, new_value)


def _macros(text: str) -> dict[str, str]:
    """Return the macros of a header with their definitions, without those about the header itself."""
    macros: dict[str, str] = {}
    for name, parameters, definition in _MACRO.findall(_COMMENT.sub("", text)):
        if not _OF_HEADER.fullmatch(name):
            macros[name] = " ".join(f"{parameters} {definition}".replace("\\\n", " ").split())
    return macros


def _python_names(text: str) -> dict[str, str]:
    """Return the public names of a module and of its classes, with the values of constants."""
    statements = ast.parse(text).body
    classes = {statement.name: statement for statement in statements if isinstance(statement, ast.ClassDef)}
    return dict(_definitions(statements, classes))


def _definitions(
    body: Iterable[ast.stmt], classes: Mapping[str, ast.ClassDef], owner: str = ""
) -> Iterator[tuple[str, str]]:
    """Yield the public names that statements bind. A class also has the names of its private bases."""
    for statement in body:
        for name in _bound_names(statement):
            if name.startswith("_"):
                continue
            value = getattr(statement, "value", None)
            yield f"{owner}{name}", ast.unparse(value) if isinstance(value, ast.Constant) else ""
            if isinstance(statement, ast.ClassDef):
                yield from _definitions(statement.body, classes, f"{owner}{name}.")
                for base in _private_bases(statement, classes):
                    yield from _definitions(base.body, classes, f"{owner}{name}.")


def _private_bases(statement: ast.ClassDef, classes: Mapping[str, ast.ClassDef]) -> Iterator[ast.ClassDef]:
    names = [base.id for base in statement.bases if isinstance(base, ast.Name)]
    yield from (classes[name] for name in names if name.startswith("_") and name in classes)


def _bound_names(statement: ast.stmt) -> list[str]:
    match statement:
        case ast.ClassDef(name=name) | ast.FunctionDef(name=name):
            return [name]
        case ast.AnnAssign(target=ast.Name(id=name)):
            return [name]
        case ast.Assign(targets=targets):
            return [target.id for target in targets if isinstance(target, ast.Name)]
    return []
