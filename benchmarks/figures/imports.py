"""Find the imports between modules in the sources, and the import cycles.

Every import counts, including those in functions and under ``TYPE_CHECKING``. ``from .layout import Field`` is an
import of ``layout`` only, not of its package. ``from . import slots`` is an import of ``slots`` if that is a module,
else of the package. Imports of modules whose name is in a string are not found.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence, Set
from pathlib import Path

from .tree import Source

#: Modules or packages, each with the others that it imports.
Graph = Mapping[str, Set[str]]
PACKAGE = "codewheel"


def module_name(path: str) -> str:
    """Return the name of a module in the package, such as ``targets.c.files``. The package itself has its own name."""
    parts = Path(path).with_suffix("").parts[1:]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts) or PACKAGE


def graph(modules: Sequence[Source]) -> Graph:
    """Return the imports of each module."""
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


def packages(modules: Graph) -> Graph:
    """Return the imports between packages. A folder is a package, and so is a module outside any folder."""
    found: dict[str, set[str]] = {}
    for name, imported in modules.items():
        package = name.partition(".")[0]
        found.setdefault(package, set()).update({other.partition(".")[0] for other in imported} - {package})
    return found


def cycles(arrows: Graph) -> list[list[str]]:
    """Return the cycles, largest first. The names in a cycle can all reach each other."""
    reached = {name: _reached(name, arrows) for name in arrows}
    found = {tuple(sorted(other for other in reached[name] if name in reached[other])) for name in arrows}
    return sorted((list(cycle) for cycle in found if cycle), key=lambda cycle: (-len(cycle), cycle))


def _reached(name: str, arrows: Graph) -> set[str]:
    """Return everything that ``name`` imports, directly or indirectly."""
    found: set[str] = set()
    waiting = [name]
    while waiting:
        new = set(arrows[waiting.pop()]) - found
        found |= new
        waiting += new
    return found
