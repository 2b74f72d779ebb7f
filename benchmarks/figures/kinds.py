"""Find the strings that modules and templates compare to determine the kind of an object.

It counts ``thing.kind == "flag"``, also with ``!=``, ``in`` and ``not in``, and each ``case "flag"`` of a ``match
thing.kind``. These are comparisons of an attribute with one of the names in ``KINDS`` to a word in quotes, or to a
tuple, list or set of such words. It does not count variables with these names, YAML keys (``raw["kind"]``), and tables
whose key is a kind.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass

from jinja2 import Environment, nodes

from .tree import Checkout, Source

#: Attributes that hold the kind of a field, an interface, a step, a CRC or a carrier.
KINDS = frozenset({"carried_as", "do", "form", "interface", "kind", "style"})


@dataclass(frozen=True)
class Comparison:
    """A place where a string is compared, with the attribute to which it is compared."""

    place: str
    attribute: str


def comparisons(checkout: Checkout) -> list[Comparison]:
    """Return all such comparisons in the generator and its templates."""
    found = [item for module in checkout.modules for item in _in_module(module)]
    return found + [item for template in checkout.templates for item in _in_template(template)]


def _in_module(module: Source) -> Iterator[Comparison]:
    for node in sorted(ast.walk(module.tree), key=lambda node: getattr(node, "lineno", 0)):
        if isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            attribute = next(
                (item.attr for item in sides if isinstance(item, ast.Attribute) and item.attr in KINDS), ""
            )
            if attribute and any(_is_words(item) for item in sides):
                yield Comparison(module.at(node.lineno), attribute)
        elif isinstance(node, ast.Match) and isinstance(node.subject, ast.Attribute) and node.subject.attr in KINDS:
            for case in node.cases:
                if any(isinstance(item, ast.MatchValue) and _is_words(item.value) for item in ast.walk(case.pattern)):
                    yield Comparison(module.at(case.pattern.lineno), node.subject.attr)


def _is_words(node: ast.expr) -> bool:
    if isinstance(node, (ast.Tuple, ast.List, ast.Set)):
        return bool(node.elts) and all(map(_is_words, node.elts))
    return isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.isidentifier()


def _in_template(template: Source) -> Iterator[Comparison]:
    for node in Environment().parse(template.text).find_all(nodes.Compare):
        sides = [node.expr, *(item.expr for item in node.ops)]
        attribute = next((item.attr for item in sides if isinstance(item, nodes.Getattr) and item.attr in KINDS), "")
        if attribute and any(_is_words_there(item) for item in sides):
            yield Comparison(template.at(node.lineno), attribute)


def _is_words_there(node: nodes.Expr) -> bool:
    if isinstance(node, (nodes.Tuple, nodes.List)):
        return bool(node.items) and all(map(_is_words_there, node.items))
    return isinstance(node, nodes.Const) and isinstance(node.value, str) and node.value.isidentifier()
