"""Sizes of sources: statements of Python, lines without docstrings, and templates that are real ones."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable
from typing import TypeGuard

import jinja2
from jinja2 import meta

from .tree import Source

#: Share of the lines of a real template that have an expression or a statement.
_LEAST = 0.03
_TAG = re.compile(r"\{\{|\{%")
#: Variables that are the same in every file of a manufacturer.
_SAME = {"PREFIX", "generation", "header", "maker", "prefix"}


class _Any(dict[str, Callable[..., object]]):
    """Filters or tests of every name."""

    def get(self, *_: object) -> Callable[..., object]:
        return str


_JINJA = jinja2.Environment()
_JINJA.filters, _JINJA.tests = _Any(), _Any()


def statements_of(source: Source) -> int:
    """Count the statements of a module, at any depth. Docstrings and other lone constants do not count."""
    return sum(isinstance(node, ast.stmt) and not _is_text(node) for node in ast.walk(source.tree))


def lines_without_docstrings(source: Source) -> int:
    """Count the lines of a module that are not part of a docstring, blank lines included."""
    texts = (node for node in ast.walk(source.tree) if _is_text(node))
    return source.lines - len({line for node in texts for line in range(node.lineno, (node.end_lineno or 0) + 1)})


def _is_text(node: ast.AST) -> TypeGuard[ast.Expr]:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def is_real(template: Source) -> bool:
    """Return whether enough lines of a template have tags, and some of them differ within a manufacturer's files."""
    used = meta.find_undeclared_variables(_JINJA.parse(template.text))
    differs = not used <= _SAME or re.search(r"\{%-? macro", template.text) is not None
    return differs and sum(map(bool, map(_TAG.search, template.text.splitlines()))) >= _LEAST * template.lines
