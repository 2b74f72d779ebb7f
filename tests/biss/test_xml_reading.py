"""Everywhere in the project, XML is read without entities, document types and network access."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

# Reads all sources, which do not depend on wording or rules of check.
pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
#: Functions that read XML, in lxml and the standard library, and those whose defaults create a parser.
READS = {
    "fromstring",
    "parse",
    "XML",
    "HTML",
    "iterparse",
    "XMLSchema",
    "DTD",
    "RelaxNG",
    "XSLT",
    "fromstringlist",
    "XMLPullParser",
    "XMLID",
    "parseString",
    "make_parser",
    "feed",
}
MODULES = ("lxml", "xml", "defusedxml", "html5lib", "bs4", "xmltodict")

#: Every call, by file: the function and the arguments of its parser. A new call is one more line here.
EXPECTED = {
    # The document is our own, and requests of its document type are answered by the class above,
    # which knows only one file.
    "generator/targets/biss/files.py": [
        (
            "fromstring",
            {
                "resolve_entities": False,
                "no_network": True,
                "load_dtd": True,
                "dtd_validation": True,
                "huge_tree": False,
            },
        )
    ],
    "docs/example/decode_from_xml.py": [("parse", {"resolve_entities": False, "no_network": True})],
}


def sources() -> list[Path]:
    """Return all Python that is not a test: the tool, its output, examples and benchmarks."""
    folders = [ROOT / name for name in ("generator", "generated", "docs", "benchmarks", "templates")]
    return [path for folder in folders for path in sorted(folder.rglob("*.py"))]


def imports_xml(tree: ast.AST) -> bool:
    for node in ast.walk(tree):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [node.module or ""]
        if any(name.partition(".")[0] in MODULES for name in names):
            return True
    return False


def parser_of(call: ast.Call, tree: ast.AST) -> dict[str, bool]:
    """Return the arguments of the parser of a call, which is written inline or in a name that is assigned once."""
    assignments = [node for node in ast.walk(tree) if isinstance(node, ast.Assign)]
    targets = [(target, node.value) for node in assignments for target in node.targets]
    assigned = {target.id: value for target, value in targets if isinstance(target, ast.Name)}
    for argument in [*call.args, *(keyword.value for keyword in call.keywords)]:
        parser = assigned.get(argument.id) if isinstance(argument, ast.Name) else argument
        if isinstance(parser, ast.Call) and isinstance(parser.func, ast.Attribute) and parser.func.attr == "XMLParser":
            constants = [keyword for keyword in parser.keywords if isinstance(keyword.value, ast.Constant)]
            return {str(keyword.arg): bool(keyword.value.value) for keyword in constants}
    return {}


def reads(tree: ast.AST) -> Iterator[tuple[str, dict[str, bool]]]:
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Name("Expression"), attr="parse")):
                pass
            case ast.Call(func=ast.Attribute(attr=name) | ast.Name(id=name)) if name in READS:
                yield name, parser_of(node, tree)


def test_every_place_that_reads_xml_is_known() -> None:
    places_by_path = {}
    for path in sources():
        text = path.read_text(encoding="utf-8")
        if not any(name in text for name in MODULES):
            continue
        tree = ast.parse(text)
        if imports_xml(tree) and (places := list(reads(tree))):
            places_by_path[path.relative_to(ROOT).as_posix()] = places
    assert places_by_path == EXPECTED


@pytest.mark.parametrize(
    "line",
    [
        "etree.fromstring(data)",
        "etree.parse(path)",
        "etree.XMLSchema(file=path)",
        "etree.fromstring(data, etree.XMLParser(resolve_entities=True))",
    ],
)
def test_a_careless_place_would_be_seen(line: str) -> None:
    tree = ast.parse(f"from lxml import etree\nx = {line}\n")
    (place,) = reads(tree)
    assert imports_xml(tree)
    assert place not in [known_place for items in EXPECTED.values() for known_place in items]


def test_nothing_generated_reads_xml() -> None:
    for path in (ROOT / "generated").rglob("*.py"):
        assert not imports_xml(ast.parse(path.read_text(encoding="utf-8")))
