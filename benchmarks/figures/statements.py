"""Find the origin of the statements in the generated C headers and Python modules: templates, Python strings, or both.

A statement counts once, no matter how many lines it takes. In C, it is the text in the body of a function up to a
``;``, a ``{`` or the ``:`` of a ``case``, such as ``if (…) {``, ``for (…) {``, ``return …;`` or a declaration. In
Python, it is a simple statement in the body of a function, or the head of a compound one, such as ``if …:`` or ``for
…:``. Not counted are comments, docstrings, preprocessor lines, signatures, single braces, and initialisers of tables,
which are ``… = {…};`` in C and everything outside functions in Python.

Letters, digits and operators determine the origin. Spaces, brackets, commas, periods, colons, semicolons and quotes do
not count. ``out->{{ name }} = {{ value }};`` mixes template and Python. So does ``{{ name }} = {{ value }};``, because
the ``=`` is in the template.
"""

from __future__ import annotations

import ast
import json
import os
import re
import subprocess
import sys
import tempfile
import tokenize
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

from .traced import PYTHON, TEMPLATE
from .tree import Checkout

#: Possible origins of a statement.
ORIGINS = ("template", "mixed", "Python")

_SILENT = frozenset(" \t\n\r.,:;()[]{}\"'`\\")


@dataclass(frozen=True)
class Printed:
    """A generated file: its text, and the origin of each character."""

    text: str
    origin: str


@dataclass(frozen=True)
class Statement:
    """A statement: its first line, its origin, and how many of its ``letters`` come from Python strings."""

    line: int
    origin: str
    letters: int
    from_python: int


def families_of(checkout: Checkout) -> re.Pattern[str]:
    """Return a pattern of the names of a family's files, such as ``amm5`` and ``amm5_biss_registers``."""
    names = {path.stem for path in (checkout.root / "specs").rglob("*.yaml")}
    return re.compile(f"({'|'.join(map(re.escape, sorted(names)))})(_.*)?")


def printed(checkout: Checkout) -> dict[str, Printed]:
    """Return the headers and modules that a checkout generates from its own specs, without the runtime that it copies.

    Raises:
        RuntimeError: The checkout generates no files.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _lay_out(checkout, folder / "path" / "codewheel")
        result, output = folder / "result.json", folder / "output"
        arguments = ["generate", str(checkout.root / "specs"), "-o", str(output), "--target", "c", "--target", "python"]
        done = subprocess.run(
            [sys.executable, "-m", "figures.traced", str(result), str(output), *arguments],
            env=os.environ
            | {
                "PYTHONPATH": os.pathsep.join([str(folder / "path"), str(Path(__file__).parents[1])]),
                "XDG_CACHE_HOME": str(folder / "cache"),
            },
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            raise RuntimeError(f"{checkout.root} generates nothing:\n{done.stderr.strip()}")
        found = json.loads(result.read_text(encoding="utf-8"))
    runtime = {path.read_bytes() for path in (checkout.root / "runtime").rglob("*.*") if path.is_file()}
    return {path: Printed(text, origin) for path, (text, origin) in found.items() if text.encode() not in runtime}


def _lay_out(checkout: Checkout, package: Path) -> None:
    """Make ``package`` the package ``codewheel`` of a checkout, as if it were installed."""
    package.mkdir(parents=True)
    for item in (checkout.root / "generator").iterdir():
        if item.name != "__pycache__":
            (package / item.name).symlink_to(item)
    for name in ("templates", "runtime", "specs"):
        if (checkout.root / name).exists():
            (package / name).symlink_to(checkout.root / name)


def by_output(checkout: Checkout, files: Mapping[str, Printed]) -> dict[str, list[Statement]]:
    """Return the statements of each kind of file. The runtime is copied, so it is not counted."""
    families = families_of(checkout)
    copied = {item.text for suffix in (".h", ".py") for item in checkout.files("runtime", suffix)}
    found: dict[str, list[Statement]] = {
        f"{language}, {sort}": [] for language in ("C", "Python") for sort in ("families", "shared by all")
    }
    for path, file in files.items():
        language = "C" if path.endswith(".h") else "Python"
        sort = "families" if families.fullmatch(Path(path).stem) else "shared by all"
        if file.text not in copied:
            found[f"{language}, {sort}"] += statements(path, file)
    return found


def statements(path: str, file: Printed) -> list[Statement]:
    """Return the statements of a C header or a Python module, depending on the file extension."""
    masked, spans = _in_c(file.text) if path.endswith(".h") else _in_python(file.text)
    found = []
    for start, end in spans:
        counted = [index for index in range(start, end) if masked[index] not in _SILENT]
        if counted:
            line = file.text.count("\n", 0, counted[0]) + 1
            origins = [file.origin[index] for index in counted]
            found.append(Statement(line, _who(set(origins)), len(origins), origins.count(PYTHON)))
    return found


def _who(origins: set[str]) -> str:
    return {frozenset(TEMPLATE): "template", frozenset(PYTHON): "Python"}.get(frozenset(origins), "mixed")


Span = tuple[int, int]

_C_COMMENT = re.compile(r'(/\*.*?\*/|//[^\n]*)|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.DOTALL)
_C_PREPROCESSOR = re.compile(r"^[ \t]*#(?:\\\n|[^\n])*", re.MULTILINE)
_C_TEXT = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'')


def _blank(match: re.Match[str]) -> str:
    return re.sub(r"[^\n]", " ", match[0])


def _in_c(text: str) -> tuple[str, list[Span]]:
    """Return a header with comments and preprocessor lines blanked out, and its statements."""
    masked = _C_COMMENT.sub(lambda match: _blank(match) if match[1] else match[0], text)
    masked = _C_PREPROCESSOR.sub(_blank, masked)
    return masked, list(_CScanner(masked).statements())


class _CScanner:
    """One pass through a header. ``inside`` has the kind of content for each open brace."""

    def __init__(self, masked: str) -> None:
        self.code = _C_TEXT.sub(lambda match: "x" * len(match[0]), masked)
        self.inside: list[str] = []
        self.start = 0

    def statements(self) -> Iterator[Span]:
        parentheses = 0
        for index, letter in enumerate(self.code):
            parentheses += (letter == "(") - (letter == ")")
            if letter == "{":
                yield from self._opened(index)
            elif letter == "}" and self.inside:
                self.inside.pop()
                self.start = index + 1
            elif (letter == ";" and not parentheses) or (letter == ":" and self._is_label(index)):
                if self._in_code():
                    yield self.start, index
                self.start = index + 1

    def _opened(self, index: int) -> Iterator[Span]:
        """Handle an opening brace of a function, a block, an initialiser, a type or ``extern "C"``."""
        head = self.code[self.start : index].strip()
        if self._in_code() and not head.endswith("="):
            yield self.start, index
            self.inside.append("code")
        else:
            self.inside.append("code" if head.endswith(")") else "other")
        self.start = index + 1

    def _in_code(self) -> bool:
        return self.inside[-1:] == ["code"]

    def _is_label(self, index: int) -> bool:
        return self._in_code() and re.match(r"\s*(?:case\b|default\b)", self.code[self.start : index]) is not None


def _in_python(text: str) -> tuple[str, list[Span]]:
    """Return a module with comments blanked out, and its statements."""
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    masked = list(text)
    for token in tokenize.generate_tokens(StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            at = starts[token.start[0] - 1] + token.start[1]
            masked[at : at + len(token.string)] = " " * len(token.string)
    lines = text.splitlines()

    def place(line: int, column: int) -> int:
        return starts[line - 1] + len(lines[line - 1].encode()[:column].decode())

    functions = [
        node for node in ast.walk(ast.parse(text)) if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
    ]
    found = {}
    for function in functions:
        for node in _statements_below(function):
            end = _head_end(node)
            found[place(node.lineno, node.col_offset)] = place(*end)
    return "".join(masked), sorted(found.items())


def _statements_below(function: ast.AST) -> Iterator[ast.stmt]:
    """Yield the statements in the body of a function, at any depth, without docstrings."""
    for node in ast.iter_child_nodes(function):
        if isinstance(node, ast.stmt) and not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)):
            yield node
        yield from _statements_below(node)


def _head_end(node: ast.stmt) -> tuple[int, int]:
    """Return the end of a simple statement, or of the head of a compound one."""
    body: list[ast.stmt] = getattr(node, "body", [])
    if body:
        return body[0].lineno, body[0].col_offset
    return node.end_lineno or node.lineno, node.end_col_offset or 0
