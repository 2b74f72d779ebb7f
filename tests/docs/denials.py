"""Finds every text of the outputs that denies something: in the strings of Python modules, in templates, in scripts."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Words that deny something. Denials in code, such as ``not`` in an expression, are outside strings and comments.
_DENIES = re.compile(
    r"(?i)\b(?:no|not|never|none|nothing|without|only|cannot|nor|neither|nobody|lacks?|missing|unknown|unlisted|absent"
    r"|(?:is|are|do|does|did|was|were|can|has|have|should|would)n't)\b"
)
_MODULES = ("generator/say", "generator/targets", "generator/masters")
#: Files without sentences: build scripts and styles.
_WITHOUT_SENTENCES = re.compile(r"cmake|CMakeLists|\.toml\.|style\.js$")
_SENTENCE_ENDS = re.compile(r"(?<=[.!?:])\s+|\n\s*\n|\n\s*[-*] |\|")
_C_TEXTS = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', re.DOTALL)
_PYTHON_TEXTS = re.compile(r'"""(?:.*?)"""|#[^\n]*|"(?:\\.|[^"\\\n])*"', re.DOTALL)
_SCRIPT_TEXTS = re.compile(r'"(?:\\.|[^"\\\n])*"|`(?:\\.|[^`\\])*`|//[^\n]*|/\*.*?\*/', re.DOTALL)
_FENCE = re.compile(r"^ *```(\w*)\n(.*?)^ *```", re.DOTALL | re.MULTILINE)


def denials() -> Iterator[tuple[str, str]]:
    """Yield the file and the text of every denial, each once per file. Values in texts are written as ``{}``."""
    for folder in _MODULES:
        for path in sorted((ROOT / folder).rglob("*.py")):
            yield from _denials_in(path, _texts_of_module(path.read_text("utf-8")))
    for path in sorted((ROOT / "templates").rglob("*.jinja")):
        yield from _denials_in(path, _texts_of_template(path))
    for path in sorted((ROOT / "runtime" / "browser").glob("*.js")):
        yield from _denials_in(path, _texts_of_script(path.read_text("utf-8")))


def denies(text: str) -> bool:
    """Return whether a text has a word that denies something, and is prose: more than one word, or ``read-only``."""
    return (" " in text or text.endswith("-only")) and _DENIES.search(text) is not None


def _denials_in(path: Path, texts: Iterator[str]) -> Iterator[tuple[str, str]]:
    name = path.relative_to(ROOT).as_posix()
    if _WITHOUT_SENTENCES.search(name) is None:
        yield from ((name, text) for text in dict.fromkeys(texts) if denies(text))


# -- Python


def _texts_of_module(source: str) -> Iterator[str]:
    """Yield the sentences of the strings of a module, except docstrings, annotations and patterns."""
    tree = ast.parse(source)
    skipped = {id(node) for part in _not_printed(tree) for node in ast.walk(part)}
    for node in ast.walk(tree):
        if id(node) in skipped:
            continue
        if isinstance(node, ast.JoinedStr):
            skipped.update(id(part) for part in node.values if isinstance(part, ast.Constant))
            yield from _sentences("".join(map(_text_of_part, node.values)))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield from _sentences(node.value)


def _not_printed(tree: ast.AST) -> Iterator[ast.AST]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            yield node
        elif isinstance(node, ast.AnnAssign):
            yield node.annotation
        elif isinstance(node, ast.Call) and ast.unparse(node.func).startswith("re."):
            yield node


def _text_of_part(node: ast.expr) -> str:
    return str(node.value) if isinstance(node, ast.Constant) else "{}"


def _sentences(text: str) -> Iterator[str]:
    for sentence in _SENTENCE_ENDS.split(text):
        yield " ".join(sentence.split())


# -- templates and scripts


def _texts_of_template(path: Path) -> Iterator[str]:
    source = re.sub(r"{#.*?#}", "", path.read_text("utf-8"), flags=re.DOTALL)
    kind = path.name.removesuffix(".jinja").rpartition(".")[2]
    for expression in re.findall(r"{{.*?}}|{%.*?%}", source, re.DOTALL):
        for text in re.findall(r'"(?:\\.|[^"\\])*"', expression):
            yield from _sentences(text.strip('"'))
    source = re.sub(r"{{.*?}}", "{}", source, flags=re.DOTALL)
    source = re.sub(r"{%.*?%}", " ", source, flags=re.DOTALL)
    if kind in ("c", "h", "hpp", "ino", "c_struct", "js"):
        yield from _sentences_of_matches(_C_TEXTS, source)
    elif kind == "py":
        yield from _sentences_of_matches(_PYTHON_TEXTS, source)
    else:
        for language, code in _FENCE.findall(source):
            yield from _sentences_of_matches(_PYTHON_TEXTS if language == "python" else _C_TEXTS, code)
        yield from _sentences(re.sub(r"<!--|-->|<[^>]*>", "\n\n", _FENCE.sub("\n\n", source)))


def _texts_of_script(source: str) -> Iterator[str]:
    for text in re.findall(_SCRIPT_TEXTS, source):
        if not text.startswith(("/",)):
            yield from _sentences(re.sub(r"\$\{[^}]*\}", "{}", text.strip('"`')))


def _sentences_of_matches(texts: re.Pattern[str], source: str) -> Iterator[str]:
    for text in texts.findall(source):
        bare = re.sub(r"^\s*(?:/\*+|\*+/|\*|//+|#+)|\*/", " ", text, flags=re.MULTILINE).strip('"')
        yield from _sentences(bare)
