"""Imports of a generated module: those of the known names that its code uses."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence

#: Names by the module that has them.
Sources = Mapping[str, Sequence[str]]
Imports = list[list[tuple[str, list[str]]]]


def imports_of(text: str, *groups: Sources) -> Imports:
    """Return the modules from which the code of a module has to import, with the names, in groups."""
    used = {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}
    named = [{source: [name for name in names if name in used] for source, names in of.items()} for of in groups]
    return [[(source, names) for source, names in group.items() if names] for group in named]
