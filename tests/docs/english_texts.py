"""Prose of a file: paragraphs of Markdown, comments, docstrings and messages of code, and strings of data.

Code and quotations in it are replaced by a dot for each character, so that places stay the same.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import yaml

#: Keys of a spec whose values are a manual's own words, or words of the language.
MANUALS_WORDS = {"printed", "printed_name", "printed_value", "names", "title", "source", "label", "quote"}


@dataclass(frozen=True)
class Text:
    """Prose that belongs together and the line on which it begins. Densities leave out a heading.

    A message of a command is one line. As in compilers, a semicolon joins its cause and its remedy.
    """

    line: int
    words: str
    heading: bool = False
    message: bool = False


def _blanked(match: re.Match[str]) -> str:
    return re.sub(r"[^\n]", "·", match[0])


_QUOTED = re.compile(
    r"``[^`]+``|`[^`]+`"  # code
    r"|\"[^\"]{1,300}\"|“[^”]{1,300}”|(?<!\w)'[^'\n]{1,80}'(?!\w)"  # quotations
    r"|\bPrinted:.*?(?=\bUsed:|\Z)|^\|\s*\**Printed\**\s*\|[^\n]*"  # errata
    r"|https?://\S+|&\w+;|:\w+:(?=·)",
    re.DOTALL | re.MULTILINE,
)


def prose(words: str) -> str:
    return _QUOTED.sub(_blanked, words)


_JINJA = re.compile(r"\{\{.*?\}\}|\{%.*?%\}", re.DOTALL)
_PYTHON_PROSE = re.compile(r'"""(.*?)"""|(?:^[ \t]*#:? [^\n]*\n)+', re.DOTALL | re.MULTILINE)
_JINJA_COMMENT = re.compile(r"\{#(.*?)#\}", re.DOTALL)
_MARKUP = re.compile(
    r"^>[^\n]*|"  # text of a manual
    r"^(`{3,}|~{3,}).*?^\1`*$|^---\n.*?^---$|<!--.*?-->|<[^<>\n]*>|\]\([^()\s]*(?:\([^()]*\)[^()\s]*)*\)|^\|[-| :]+\|$",
    re.DOTALL | re.MULTILINE,
)
_PARAGRAPH = re.compile(r"(?:^[^\n]*\S[^\n]*\n?)+", re.MULTILINE)


def of_markdown(source: str) -> Iterator[Text]:
    """Yield paragraphs, lists and tables, and separately headings."""
    without = _MARKUP.sub(_blanked, source)
    for paragraph in _PARAGRAPH.finditer(without):
        line = without.count("\n", 0, paragraph.start()) + 1
        yield Text(line, prose(paragraph[0]), heading=paragraph[0].startswith("#"))


def of_rules(source: str) -> Iterator[Text]:
    """Yield the texts of a page of rules. The paragraph below the heading of a rule is its message."""
    is_rule = False
    for text in of_markdown(source):
        yield replace(text, message=is_rule)
        is_rule = text.words.startswith("## ")


#: Arguments of ``argparse`` that are texts of several sentences.
HELP = {"help", "description", "epilog"}


def of_python(source: str) -> Iterator[Text]:
    """Yield docstrings, comments, and other strings that read like sentences. The latter are messages, unless helps."""
    yield from of_comments(source)
    nodes = list(ast.walk(ast.parse(source)))
    docstrings = {node.value for node in nodes if isinstance(node, ast.Expr)}
    parts = {part for node in nodes if isinstance(node, ast.JoinedStr) for part in node.values}
    help_arguments = [node.value for node in nodes if isinstance(node, ast.keyword) and node.arg in HELP]
    helps = {part for argument in help_arguments for part in ast.walk(argument)}
    named = {node.id for node in helps if isinstance(node, ast.Name)}
    helps |= {node.value for node in nodes if isinstance(node, ast.Assign) and _name(node.targets[0]) in named}
    for node in nodes:
        if isinstance(node, ast.JoinedStr):
            words = "".join(map(_words_of_part, node.values))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in parts:
            words = node.value
        else:
            continue
        if node in docstrings or _is_sentence(words):
            yield Text(node.lineno, prose(words), message=node not in docstrings | helps)


def _words_of_part(part: ast.expr) -> str:
    return str(part.value) if isinstance(part, ast.Constant) else "·"


def _name(target: ast.expr) -> str:
    return target.id if isinstance(target, ast.Name) else ""


def _is_sentence(words: str) -> bool:
    """Return whether a string has three words or more and is not a regular expression or code."""
    code = re.search(r"\(\?|\\[bdsw]|\$defs|==|\);|[{};]\s*(?:\n|\Z)|: #", words)
    return len(re.findall(r"\b[a-z]{2,}\b", words)) > 2 and not code


_HASHED = re.compile(r"(?:^[ \t]*#(?!!|\{)[^\n]*\n)+|(?<=[ \t])# [^\n]+", re.MULTILINE)
_FOR_TOOLS = re.compile(r"\b(?:noqa|type: ignore|pragma)\b[^\n]*")


def of_comments(source: str) -> Iterator[Text]:
    """Yield the comments that begin with a hash. Lines one below the other are one text."""
    for comment in _HASHED.finditer(source):
        line = source.count("\n", 0, comment.start()) + 1
        words = re.sub(r"^[ \t]*#:?", "", comment[0], flags=re.MULTILINE)
        yield Text(line, prose(_FOR_TOOLS.sub(_blanked, words)))


_C = re.compile(r'"(?:\\.|[^"\\\n])*"|/\*(.*?)\*/|//([^\n]*)', re.DOTALL)


def of_c(source: str) -> Iterator[Text]:
    """Yield the comments of C or JavaScript."""
    for comment in _C.finditer(source):
        words = comment[1] or comment[2]
        if words:
            line = source.count("\n", 0, comment.start()) + 1
            plain = re.sub(r"^[ \t]*\*(?!\*)", "", words, flags=re.MULTILINE)
            yield Text(line, prose(re.sub(r"[@\\](?:param|p|ref|c)\b(?:\[\w+\])? \w+", _blanked, plain)))


def of_yaml(source: str) -> Iterator[Text]:
    """Yield comments and strings, except those that a manual prints."""
    yield from of_comments(source)
    root = yaml.compose(source, Loader=yaml.CSafeLoader)
    nodes = [] if root is None else [root]
    while nodes:
        node = nodes.pop()
        if isinstance(node, yaml.MappingNode):
            nodes += [value for key, value in node.value if key.value not in MANUALS_WORDS]
        elif isinstance(node, yaml.SequenceNode):
            nodes += node.value
        elif _is_sentence(node.value):
            raw = source[node.start_mark.index : node.end_mark.index]
            quoted = node.style in ("'", '"')
            yield Text(node.start_mark.line + 1, prose(node.value if quoted else raw))


def of_json(source: str) -> Iterator[Text]:
    """Yield the descriptions of a schema."""
    for description in re.finditer(r'"description": "((?:\\.|[^"\\])*)"', source):
        yield Text(source.count("\n", 0, description.start()) + 1, prose(description[1].replace('\\"', '"')))


def of_template(source: str, name: str) -> Iterator[Text]:
    """Yield the comments of a template, and its output according to the type of the generated file."""
    for comment in _JINJA_COMMENT.finditer(source):
        yield Text(source.count("\n", 0, comment.start()) + 1, prose(comment[1]))
    printed = _JINJA.sub(_blanked, _JINJA_COMMENT.sub(_blanked, source))
    if name.endswith((".c", ".h", ".js")):
        yield from of_c(printed)
    elif name.endswith(".md"):
        yield from of_markdown(printed)
    elif name.endswith(".py"):
        for match in _PYTHON_PROSE.finditer(printed):
            words = match[1] or re.sub(r"^[ \t]*#:?", "", match[0], flags=re.MULTILINE)
            yield Text(printed.count("\n", 0, match.start()) + 1, prose(words))


_BY_SUFFIX: dict[str, Callable[[str], Iterator[Text]]] = {
    ".md": of_markdown,
    ".py": of_python,
    ".c": of_c,
    ".h": of_c,
    ".js": of_c,
    ".yaml": of_yaml,
    ".yml": of_yaml,
    ".json": of_json,
    ".toml": of_comments,
    ".sh": of_comments,
}


def texts(path: Path) -> Iterator[Text]:
    """Yield the prose of a file by its suffix."""
    source = path.read_text(encoding="utf-8")
    if path.suffix == ".jinja":
        yield from of_template(source, path.stem)
    elif path.name == "Makefile":
        yield from of_comments(source)
    elif path.match("docs/transcribe/rules-?-to-?.md"):
        yield from of_rules(source)
    elif path.suffix in _BY_SUFFIX:
        yield from _BY_SUFFIX[path.suffix](source)
