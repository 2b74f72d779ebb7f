"""Pages of the C and Python APIs: the declarations of headers and modules, with their comments."""

from __future__ import annotations

import ast
import re
import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from codewheel.say.text import code_span, escape

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


@dataclass(frozen=True)
class Entry:
    """Type, class or function with its comment.

    ``members`` are its functions or methods, as code with comments. ``subject`` is ``frames`` or ``registers`` for a
    class of one, and otherwise empty.
    """

    name: str
    declaration: str
    comment: str
    members: list[str] = field(default_factory=list)
    subject: str = ""


def api_pages(root: Path) -> Iterator[tuple[str, str]]:
    """Yield the path and text of each page."""
    headers = [path for path in sorted((root / HEADERS).glob("*/*.h")) if path.parent.name != "codewheel"]
    packages = [path.parent for path in (root / MODULES).rglob("*_encoders/__init__.py")]
    modules = [path for folder in sorted(packages) for path in sorted(folder.glob("[!_]*.py")) if path.stem != "biss"]
    runtime = [path for path in sorted((root / RUNTIME).rglob("*")) if path.stem in _RUNTIME_MODULES]
    yield "api/c.md", _index("c", "C headers", "generated/c", headers)
    yield "api/python.md", _index("python", "Python package", "generated/python", modules)
    yield "api/runtime.md", _index("runtime", "Python runtime", "generated/python/runtime", runtime)
    for path in headers:
        yield (
            f"api/c/{path.stem}.md",
            _page(f"{path.parent.name}/{path.name}", "c", c_entries(path.read_text(encoding="utf-8"))),
        )
    for path in runtime:
        entries = _package_entries(path) if path.is_dir() else python_entries(_parse(path))
        module = ".".join(path.relative_to((root / RUNTIME).parent).with_suffix("").parts)
        yield f"api/runtime/{path.stem}.md", _page(module, "python", entries)
    for path in modules:
        yield from _family_pages(path)


def _index(kind: str, title: str, folder: str, files: list[Path]) -> str:
    rows = "".join(f"- [{code_span(path.name)}]({kind}/{path.stem}.md)\n" for path in files)
    return (
        f"# {title}: reference\n\nEach file has a page with its declarations and their comments. "
        f"Start with the [README](../{folder}/README.md).\n"
        f"A frame without an error may still contain an unusable position. "
        f"Check its verdict before you use it.\n\n{rows}"
    )


def _family_pages(path: Path) -> Iterator[tuple[str, str]]:
    """Yield the page of a module with order codes and procedures, and the pages of its frames and its registers."""
    entries_by_subject: dict[str, list[Entry]] = {"": [], "frames": [], "registers": []}
    for entry in python_entries(_parse(path)):
        entries_by_subject[entry.subject].append(entry)
    module = f"{path.parent.name}.{path.stem}"
    subjects = [subject for subject, entries in entries_by_subject.items() if subject and entries]
    for subject in subjects:
        page = _page(f"{module}: {subject}", "python", entries_by_subject[subject])
        yield f"api/python/{path.stem}-{subject}.md", page
    links = " and ".join(f"[{subject}]({path.stem}-{subject}.md)" for subject in subjects)
    heading, _, sections = _page(module, "python", entries_by_subject[""]).partition("\n\n")
    yield f"api/python/{path.stem}.md", f"{heading}\n\nThe classes of {links} are on their own pages.\n\n{sections}"


def _page(title: str, language: str, entries: Iterable[Entry]) -> str:
    return f"# {escape(title)}\n\n" + "\n".join(_section(language, entry) for entry in entries)


def _section(language: str, entry: Entry) -> str:
    """Return the section about an entry: its declaration, its comment, and its folded members."""
    section = f"## {escape(entry.name)}\n\n"
    # The heading of a class without parameters says all that its declaration does.
    if entry.declaration != f"class {entry.name}":
        section += f"```{language}\n{entry.declaration}\n```\n\n"
    section += f"```text\n{entry.comment}\n```\n"
    if entry.members:
        members = "\n\n".join(entry.members)
        summary = "Methods and properties" if language == "python" else "Functions"
        section += f"\n<details>\n<summary>{summary}</summary>\n\n```{language}\n{members}\n```\n\n</details>\n"
    return section


def c_entries(header: str) -> Iterator[Entry]:
    """Yield each type with a comment, and the functions whose names begin with it. Other functions come alone."""
    last_type: Entry | None = None
    for match in _DECLARED.finditer(header):
        lines = (line.strip().removeprefix("*").removeprefix(" ") for line in match["comment"].splitlines())
        comment = "\n".join(lines).strip()
        declared = match["what"].strip()
        is_type = "typedef" in declared
        name = _NAME.findall(declared)[-1 if is_type else 0]
        if last_type is not None and not is_type and name.startswith(f"{last_type.name}_"):
            comment_lines = textwrap.indent(comment, " * ", lambda _line: True).replace(" * \n", " *\n")
            last_type.members.append(f"/*\n{comment_lines}\n */\n{declared}")
            continue
        if last_type is not None:
            yield last_type
        last_type = Entry(name, declared, comment) if is_type else None
        if not is_type:
            yield Entry(name, declared, comment)
    if last_type is not None:
        yield last_type


def _parse(path: Path) -> ast.Module:
    """Return the syntax tree of a Python file."""
    return ast.parse(path.read_text(encoding="utf-8"))


def _package_entries(folder: Path) -> Iterator[Entry]:
    """Yield the entries of the modules in a package that the package exports in ``__all__``."""
    statements = _parse(folder / "__init__.py").body
    assignments = [statement for statement in statements if isinstance(statement, ast.Assign)]
    (exported_names,) = [ast.literal_eval(assignment.value) for assignment in assignments]
    for path in sorted(folder.glob("[!_]*.py")):
        for entry in python_entries(_parse(path)):
            if entry.name in exported_names:
                yield entry


def python_entries(module: ast.Module) -> Iterator[Entry]:
    """Yield the public classes of a module with their methods, and its public functions."""
    for node in module.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            methods = list(_public_methods(node))
            stubs = [_stub(method) for method in methods]
            yield Entry(node.name, f"class {node.name}", _documented(node), stubs, _subject(node, methods))
        elif isinstance(node, ast.FunctionDef) and not node.name.startswith("_") and not node.decorator_list:
            yield Entry(node.name, _signature(node), _documented(node))


def _public_methods(class_node: ast.ClassDef) -> Iterator[ast.FunctionDef]:
    """Yield the documented methods of a class whose names have no leading underscore."""
    for node in class_node.body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_") and ast.get_docstring(node):
            yield node


def _subject(class_node: ast.ClassDef, methods: Iterable[ast.FunctionDef]) -> str:
    """Return the subject of a class with a method ``decode``. Enumerations with one are registers."""
    if class_node.name.endswith("Encoder") or all(method.name != "decode" for method in methods):
        return ""
    bases = [ast.unparse(base) for base in class_node.bases]
    is_register = any("Register" in base or base.endswith("Enum") for base in bases)
    return "registers" if is_register else "frames"


def _stub(method: ast.FunctionDef) -> str:
    """Return a method without its body, as in a stub file: decorators, signature and docstring."""
    decorators = [f"@{ast.unparse(decorator)}" for decorator in method.decorator_list]
    docstring = textwrap.indent(f'"""{_documented(method)}"""', " " * 4)
    return "\n".join([*decorators, f"{_signature(method)}:", docstring])


def _signature(function: ast.FunctionDef) -> str:
    result = f" -> {ast.unparse(function.returns)}" if function.returns else ""
    return "\n".join(textwrap.wrap(f"def {function.name}({ast.unparse(function.args)}){result}", 100))


def _documented(documented_node: ast.ClassDef | ast.FunctionDef) -> str:
    return ast.get_docstring(documented_node) or "Not described."
