"""Reads from the sources which module imports which, and finds the circles.

Every import counts: inside of functions and under ``TYPE_CHECKING`` as well. ``from .layout import Field`` is an
arrow to ``layout`` alone, not to the package around it; ``from . import slots`` is one to ``slots`` where that is a
module, else to the package. Modules that are imported by a name in a string are not seen.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence, Set
from pathlib import Path

from .tree import Source

#: Modules, or rooms, and what each imports of the others.
Graph = Mapping[str, Set[str]]
PACKAGE = "codewheel"


def module_name(path: str) -> str:
    """The name of a module in the package: ``targets.c.files``; the package itself has its own name."""
    parts = Path(path).with_suffix("").parts[1:]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts) or PACKAGE


def graph(modules: Sequence[Source]) -> Graph:
    """The imports of each module."""
    names = {module_name(item.path) for item in modules}
    return {name: set(_imported(item, name, names)) - {name} for item in modules for name in [module_name(item.path)]}


def _imported(module: Source, name: str, names: Set[str]) -> Iterator[str]:
    package = [] if name == PACKAGE else name.split(".")
    if Path(module.path).name != "__init__.py":
        package = package[:-1]
    for node in ast.walk(module.tree):
        if isinstance(node, ast.Import):
            full = [item.name.split(".") for item in node.names]
            yield from {".".join(parts[1:]) for parts in full if parts[0] == PACKAGE} & names
        elif isinstance(node, ast.ImportFrom):
            yield from _imported_from(node, package, names)


def _imported_from(node: ast.ImportFrom, package: Sequence[str], names: Set[str]) -> Iterator[str]:
    parts = node.module.split(".") if node.module else []
    if node.level:
        parts = [*package[: len(package) + 1 - node.level], *parts]
    elif parts[0] == PACKAGE:
        parts = parts[1:]
    else:
        return
    for item in node.names:
        found = next(
            (name for name in (".".join([*parts, item.name]), ".".join(parts) or PACKAGE) if name in names), None
        )
        if found is not None:
            yield found


def rooms(modules: Graph) -> Graph:
    """The same by the first part of the names: a folder is a room, and so is a module that lies flat."""
    found: dict[str, set[str]] = {}
    for name, imported in modules.items():
        room = name.partition(".")[0]
        found.setdefault(room, set()).update({other.partition(".")[0] for other in imported} - {room})
    return found


def circles(arrows: Graph) -> list[list[str]]:
    """The circles, the largest first: names that all reach each other."""
    reached = {name: _reached(name, arrows) for name in arrows}
    found = {tuple(sorted(other for other in reached[name] if name in reached[other])) for name in arrows}
    return sorted((list(circle) for circle in found if circle), key=lambda circle: (-len(circle), circle))


def _reached(name: str, arrows: Graph) -> set[str]:
    """Everything that ``name`` imports, at once or by way of others."""
    found: set[str] = set()
    waiting = [name]
    while waiting:
        new = set(arrows[waiting.pop()]) - found
        found |= new
        waiting += new
    return found
