"""Pages of the C and Python APIs: the declarations of headers and modules, with their comments."""

from __future__ import annotations

import ast
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path

from codewheel.say.markdown import code, text

HEADERS = "generated/c/include"
MODULES = "generated/python"
RUNTIME = "generated/python/runtime/codewheel_runtime"
#: Modules of the runtime that programs use directly, or through the package of a manufacturer.
_RUNTIME_MODULES = "biss encoder errors facts layouts order_codes reports running steps stream table".split()
#: A documentation comment with the declaration below it: a whole type, or a function without its body.
_DECLARED = re.compile(
    r"/\*\*(?! @file)(?P<comment>(?:(?!\*/).)*)\*/\n"
    r"(?P<what>(?:[A-Z_]+\n)*(?:typedef [^{;]*\{.*?\n\} \w+;|static inline [^{;]*))",
    re.DOTALL,
)
_NAME = re.compile(r"(\w+)(?:\(|;$)")


def api_pages(root: Path) -> Iterator[tuple[str, str]]:
    """Yield the path and text of each page."""
    headers = [path for path in sorted((root / HEADERS).glob("*/*.h")) if path.parent.name != "codewheel"]
    packages = [path.parent for path in (root / MODULES).rglob("*_encoders/__init__.py")]
    modules = [path for folder in sorted(packages) for path in sorted(folder.glob("[!_]*.py")) if path.stem != "biss"]
    runtime = [path for path in sorted((root / RUNTIME).rglob("*.py")) if path.stem in _RUNTIME_MODULES]
    yield "api/c.md", _index("c", "C headers", "generated/c", headers)
    yield "api/python.md", _index("python", "Python package", "generated/python", modules)
    yield "api/runtime.md", _index("runtime", "Python runtime", "generated/python/runtime", runtime)
    for path in headers:
        yield (
            f"api/c/{path.stem}.md",
            _page(f"{path.parent.name}/{path.name}", "c", c_entries(path.read_text(encoding="utf-8"))),
        )
    for path in (*modules, *runtime):
        entries = python_entries(ast.parse(path.read_text(encoding="utf-8")))
        kind, folder = ("runtime", (root / RUNTIME).parent) if path in runtime else ("python", path.parent.parent)
        module = ".".join(path.relative_to(folder).with_suffix("").parts)
        yield f"api/{kind}/{path.stem}.md", _page(module, "python", entries)


def _index(kind: str, title: str, folder: str, files: list[Path]) -> str:
    rows = "".join(f"- [{code(path.name)}]({kind}/{path.stem}.md)\n" for path in files)
    return (
        f"# {title}: reference\n\nEach file has a page with its declarations and their comments. "
        f"Start with the [README](../{folder}/README.md).\n"
        f"A frame without an error may still contain an unusable position. "
        f"Check its verdict before you use it.\n\n{rows}"
    )


def _page(title: str, language: str, entries: Iterator[tuple[str, str, str]]) -> str:
    parts = [_section(language, *entry) for entry in entries]
    return f"# {text(title)}\n\n" + "\n".join(parts)


def _section(language: str, name: str, declaration: str, comment: str) -> str:
    return f"## {text(name)}\n\n```{language}\n{declaration}\n```\n\n```text\n{comment}\n```\n"


def c_entries(header: str) -> Iterator[tuple[str, str, str]]:
    """Yield the name, declaration and comment of each function and type that has a comment."""
    for match in _DECLARED.finditer(header):
        lines = (line.strip().removeprefix("*").removeprefix(" ") for line in match["comment"].splitlines())
        declared = match["what"].strip()
        yield _NAME.findall(declared)[-1 if "typedef" in declared else 0], declared, "\n".join(lines).strip()


def python_entries(module: ast.Module) -> Iterator[tuple[str, str, str]]:
    """Yield the same for the public classes and functions of a module, and for the methods of its classes."""
    for node in module.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield node.name, f"class {node.name}", _documented(node)
            for method in node.body:
                if (
                    isinstance(method, ast.FunctionDef)
                    and not method.name.startswith("_")
                    and ast.get_docstring(method)
                ):
                    yield f"{node.name}.{method.name}", _signature(method), _documented(method)
        elif isinstance(node, ast.FunctionDef) and not node.name.startswith("_") and not node.decorator_list:
            yield node.name, _signature(node), _documented(node)


def _signature(function: ast.FunctionDef) -> str:
    result = f" -> {ast.unparse(function.returns)}" if function.returns else ""
    return "\n".join(textwrap.wrap(f"def {function.name}({ast.unparse(function.args)}){result}", 100))


def _documented(documented_node: ast.ClassDef | ast.FunctionDef) -> str:
    return ast.get_docstring(documented_node) or "Not described."
