"""Measure the length and the complexity of functions.

The complexity of a function is one, and one more for each of: ``if``, ``elif``, conditional expression, loop, the
``else`` of a loop or of a ``try``, ``except``, further part of ``and`` and ``or``, loop and condition of a
comprehension, ``assert``, and ``case`` except ``case _``. radon counts in the same way. A function inside another one
is counted separately.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from .tree import Source

#: Maximum length of a function without a stated reason, in lines including its signature and docstring.
LONGEST = 40

_Definition = (ast.FunctionDef, ast.AsyncFunctionDef)


@dataclass(frozen=True)
class Function:
    """A function or method."""

    place: str
    name: str
    lines: int
    complexity: int
    has_docstring: bool


def functions(modules: Sequence[Source]) -> list[Function]:
    """Return every function of the modules."""
    return [
        Function(
            item.at(node.lineno),
            node.name,
            (node.end_lineno or node.lineno) - node.lineno + 1,
            complexity(node),
            ast.get_docstring(node) is not None,
        )
        for item in modules
        for node in ast.walk(item.tree)
        if isinstance(node, _Definition)
    ]


def complexity(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Return the number of paths through a function."""
    return 1 + sum(_branches(node) for node in _own_nodes(function))


def _own_nodes(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes below ``node``, without those of its functions and classes."""
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, (*_Definition, ast.ClassDef)):
            yield child
            yield from _own_nodes(child)


def _branches(node: ast.AST) -> int:
    match node:
        case ast.If() | ast.IfExp() | ast.Assert() | ast.ExceptHandler():
            return 1
        case ast.For() | ast.AsyncFor() | ast.While():
            return 1 + bool(node.orelse)
        case ast.Try():
            return int(bool(node.orelse))
        case ast.BoolOp():
            return len(node.values) - 1
        case ast.comprehension():
            return 1 + len(node.ifs)
        case ast.match_case():
            return int(not _takes_all(node))
        case _:
            return 0


def _takes_all(case: ast.match_case) -> bool:
    return case.guard is None and isinstance(case.pattern, ast.MatchAs) and case.pattern.pattern is None
