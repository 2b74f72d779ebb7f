"""Find the places where the C and Python targets and their templates search in text, perhaps in their own output.

It finds them by the form of the code: methods of regular expressions, string methods that search, cut or replace, tests
for a string with ``in``, comparisons with a string that is not a lowercase word, such as ``== "return number"``, and
calls of functions that search in this way and return ``bool`` or a set of names. If searches are nested, only the
outermost counts. The form does not show if the text is code. ``ALLOWED`` lists searches in names, text from manuals and
comments, with the reason. All other searches count, and they are listed for people to judge.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, nodes

from .tree import Checkout, Source

LANGUAGES = ("c", "python")

_EXPRESSION_METHODS = {"sub", "subn", "match", "search", "fullmatch", "findall", "finditer"}
_TEXT_METHODS = {
    "startswith", "endswith", "removeprefix", "removesuffix", "find", "rfind", "replace", "partition", "rpartition",
    "split", "rsplit", "splitlines", "isalnum", "isdigit", "isidentifier",
}  # fmt: skip
_METHODS = _EXPRESSION_METHODS | _TEXT_METHODS
_WORD = re.compile(r"[a-z_]+")
_ANSWERS = re.compile(r"bool|(frozen)?set\[str\]")


@dataclass(frozen=True)
class Search:
    """A search in text: its place, function and expression. ``reason`` is set if the text is not code."""

    place: str
    function: str
    expression: str
    reason: str = ""


#: Searches in text other than code: function and expression, each as a regular expression, and the reason.
ALLOWED: Sequence[tuple[str, str, str]] = (
    (".*", r"[\w.]+\.replace\('[_-]', '[ _-]'\).*", "a name of the spec in words, or as a name of another sort"),
    (".*", r".*\bname \| replace\(\"_\", \" \"\).*", "the same in a template"),
    (".*", r"[\w.]*name\.split\('_'\)", "the words of a name of the spec"),
    (".*", r"[\w.\[\]]+\.partition\('\.'\)", "a place in a spec: register and field"),
    (".*", r"\w+\.startswith\((f'\{\w+\}\.'|\w+ \+ '\.')\)", "a place in a spec: one below another"),
    (".*", r".*\bmeaning\.lower\(\).*", "text of a manual"),
    (".*", r"'(send|write)' in does", "a set of what steps do"),
    (".*", r"name == 'H'", "one of five names that each header has"),
    ("", r".*\"\w+\" in interfaces.*", "a set of the names of interfaces"),
    ("", r"f?'.*'\.split\(\)", "a list of words"),
    ("about_access", r"does == 'Writes'", "the verb of a sentence"),
    ("about_access", r"name\.lower\(\)\.endswith\(.*", "a title of the spec, which may contain the word register"),
    ("all_errata|_short", ".*", "a sentence about an erratum"),
    ("c_name", r"name\.startswith\(PREFIX\)", "a name of the spec, which may begin as names of the runtime do"),
    ("runtime_version", ".*", "the version in the source of the runtime"),
    ("_row", r".*\b(family|stem)\)", "an order code as the manual prints it"),
    ("laid_out|_lines|_broken|_split", ".*", "a line of C, broken where the language allows it, whatever it says"),
    ("documented|_documented|_one_or_more|comment", ".*", "a comment of C, whatever it says"),
    ("broken|_broken|_items|_in_pieces", ".*", "a line of Python, broken at its brackets, whatever it says"),
    ("records|_classes", ".*", "the classes of the records, in the source of the runtime"),
    ("|_row|imports|_named", r"(names|needed|optional)\.split\(\)", "a list of words"),
    ("__str__", r"\{first\.operator, .*", "the operators of an expression"),
    ("package_files", r"path\.endswith\(.*", "the name of a file"),
    ("modulus", r"'modulus' in where\.names", "the functions that a family has, by their names"),
    ("documents", r"re\.search\(.*item\.key.*", "the documents that comments cite, by their keys in the spec"),
    ("_render", r"template\.endswith\(.*", "the name of a template"),
    ("_holds|span_text|plain_expression", ".*", "an expression of the spec in words"),
    ("shared_names", ".*", "a name of the shared headers, in capitals or not"),
    ("about_register", r"register\.byte_order\..*", "a word of the spec"),
    ("written_out|_repeated|_rows|_is_covered", ".*", "patterns of order codes, as the spec has them"),
    ("_short", ".*", "text of an erratum, of which a docstring has the first sentence"),
    ("_order", r"version\.split\('\.'\)", "the number of a version"),
    ("ascii_text|in_comment|in_comment_lead|_apart|comment_lines", ".*", "text of a spec on its way into a comment"),
    (".*", r".*ascii_text\(text\).*", "text of a spec on its way into a package's description"),
    ("in_pieces|docstring|_in_docstring", ".*", "text of a spec on its way into quotes or a docstring"),
    (
        "|quoted|_toml|_markdown",
        r".*(\bletter\b|\bshown\b|plain\(text\)|\bcharacter\b|not in text).*",
        "text of a spec on its way into quotes",
    ),
)


def searches(checkout: Checkout) -> list[Search]:
    """Return every search in text. Allowed ones have a reason."""
    modules = [item for item in checkout.modules if _language(item.path) in LANGUAGES]
    templates = [item for item in checkout.templates if Path(item.path).parts[1] in LANGUAGES]
    found = [search for item in modules for search in _in_module(item, frozenset())]
    helpers = {search.function for search in found if not search.reason} & _answering(modules)
    found = [search for item in modules for search in _in_module(item, helpers)]
    return found + [search for item in templates for search in _in_template(item)]


def _language(path: str) -> str:
    """Return the target of a module, from its folder or, in earlier commits, from its name up to an underscore."""
    parts = Path(path).parts
    if parts[1] != "targets":
        return ""
    return parts[2] if len(parts) > 3 else Path(parts[2]).stem.partition("_")[0]


def _search(place: str, function: str, expression: str) -> Search:
    reasons = (
        reason
        for where, how, reason in ALLOWED
        if re.fullmatch(where, function) and re.fullmatch(how, expression, re.DOTALL)
    )
    return Search(place, function, expression, next(reasons, ""))


def _in_module(module: Source, helpers: Set[str]) -> Iterator[Search]:
    """Yield the searches in a module, and its calls of ``helpers``."""
    for function, node in _outermost(module.tree, helpers):
        yield _search(module.at(node.lineno), function, ast.unparse(node))


def _outermost(tree: ast.AST, helpers: Set[str], function: str = "") -> Iterator[tuple[str, ast.expr]]:
    """Yield every outermost expression that searches in text, with the name of the function around it."""
    for child in ast.iter_child_nodes(tree):
        if isinstance(child, (ast.Call, ast.Compare)) and (_searches_in(child) or _is_call_of(child, helpers)):
            yield function, child
        else:
            inner = child.name if isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef)) else function
            yield from _outermost(child, helpers, inner)


def _is_call_of(node: ast.expr, helpers: Set[str]) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in helpers


def _searches_in(node: ast.Call | ast.Compare) -> bool:
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Attribute) and node.func.attr in _METHODS
    if isinstance(node.ops[0], (ast.In, ast.NotIn)) and _strings(node.left):
        return True
    return any(text and not _WORD.fullmatch(text) for side in (node.left, *node.comparators) for text in _strings(side))


def _strings(node: ast.expr) -> list[str]:
    """Return the strings in an expression that is a string, or a tuple, list or set of strings."""
    if isinstance(node, (ast.Tuple, ast.List, ast.Set)):
        return [text for item in node.elts for text in _strings(item)]
    return [node.value] if isinstance(node, ast.Constant) and isinstance(node.value, str) else []


def _answering(modules: Sequence[Source]) -> set[str]:
    """Return the functions that return ``bool`` or names."""
    return {
        node.name
        for item in modules
        for node in ast.walk(item.tree)
        if isinstance(node, ast.FunctionDef) and node.returns and _ANSWERS.fullmatch(ast.unparse(node.returns))
    }


def _in_template(template: Source) -> Iterator[Search]:
    lines = template.text.splitlines()
    tree = Environment().parse(template.text)
    found = [node.lineno for node in tree.find_all(nodes.Compare) if _template_searches_in(node)]
    methods = (node.node for node in tree.find_all(nodes.Call))
    found += [node.lineno for node in methods if isinstance(node, nodes.Getattr) and node.attr in _METHODS]
    found += [node.lineno for node in tree.find_all(nodes.Filter) if node.name == "replace"]
    for line in sorted(found):
        yield _search(template.at(line), "", lines[line - 1].strip())


def _template_searches_in(node: nodes.Compare) -> bool:
    if node.ops[0].op in ("in", "notin") and _strings_there(node.expr):
        return True
    sides = (node.expr, *(item.expr for item in node.ops))
    return any(text and not _WORD.fullmatch(text) for side in sides for text in _strings_there(side))


def _strings_there(node: nodes.Expr) -> list[str]:
    if isinstance(node, (nodes.Tuple, nodes.List)):
        return [text for item in node.items for text in _strings_there(item)]
    return [node.value] if isinstance(node, nodes.Const) and isinstance(node.value, str) else []
