"""Imports of a generated module: those of the known names that its code uses."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence, Set

#: Names by the module that has them.
Sources = Mapping[str, Sequence[str]]
Imports = list[list[tuple[str, list[str]]]]


def imports_of(text: str, *groups: Sources) -> Imports:
    """Return the modules from which the code of a module has to import, with the names, in groups."""
    used = {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}
    used_groups = (list(_used_imports(sources, used)) for sources in groups)
    return [imports for imports in used_groups if imports]


def _used_imports(sources: Sources, used: Set[str]) -> Iterator[tuple[str, list[str]]]:
    """Yield each module that has names in use, with these names."""
    for module, names in sources.items():
        used_names = [name for name in names if name in used]
        if used_names:
            yield module, used_names
