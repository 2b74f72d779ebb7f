"""Imports of a generated module: those of the known names that its code uses."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence

from .lines import WIDTH

#: Names by the module that has them.
Sources = Mapping[str, Sequence[str]]

#: Line of a template that stands for the imports.
_PLACE = "IMPORTS\n"


def with_imports(text: str, *groups: Sources) -> str:
    """Return the text of a module with its imports. Each group of sources is followed by a blank line."""
    used = {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}
    return text.replace(_PLACE, "".join(_group(group, used) for group in groups), 1)


def _group(sources: Sources, used: set[str]) -> str:
    found = "".join(_import(source, [name for name in names if name in used]) for source, names in sources.items())
    return f"{found}\n" if found else ""


def _import(source: str, names: Sequence[str]) -> str:
    line = f"from {source} import {', '.join(names)}"
    if not names:
        return ""
    return f"{line}\n" if len(line) <= WIDTH else "\n".join([f"from {source} import (", *_listed(names), ")\n"])


def _listed(names: Sequence[str]) -> Iterator[str]:
    return (f"    {name}," for name in names)
