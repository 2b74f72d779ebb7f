"""The generated source as source: typed, the same every time, and closed against what stands in a spec."""

from __future__ import annotations

import ast
import copy
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml

from codewheel.load import load_library
from codewheel.problems import Report
from codewheel.read import read_document
from codewheel.targets import Library
from codewheel.targets.python import generate

SPECS = Path(__file__).resolve().parents[2] / "specs" / "lika"

#: Texts that would end a string, a docstring or a comment, if they could.
HOSTILE = [
    '"""\nimport os\nBROKEN = 1\n"""',
    "'''\nBROKEN = 1\n'''",
    'ends with a quote"',
    'ends with a backslash\\',
    'both \\"',
    '""""""',
    "\\N{BULLET} \\x41 \\u0041 {{ 7 * 7 }} {% raw %}",
    "line\nBROKEN = 1\n# line",
    "a\tb `code` |table| <script>alert(1)</script>",
    "{braces} %s %(name)s $x",
]


def test_types_are_strict(generated_python: tuple[Path, ModuleType]) -> None:
    folder, package = generated_python
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--python-version", "3.10", "--no-incremental", str(folder / package.__name__)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_two_families_in_one_package(library: Library, tmp_path: Path) -> None:
    from codewheel.model import OrderCode

    first = next(item for item in library.devices if item.name == "amm5")

    def renamed(text: str) -> str:
        return text.replace("AMM5", "OTHER")

    code: OrderCode = replace(first.order_code, pattern=renamed(first.order_code.pattern))
    variants = tuple(replace(item, code=renamed(item.code)) for item in first.variants)
    second = replace(first, name="other", title="Other encoders", order_code=code, variants=variants, examples=())
    _write(generate(Library((first, second))), tmp_path)
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--no-incremental", str(tmp_path / "python" / "lika_encoders")], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    script = (
        "import lika_encoders as e; print(e.lookup('othera21/65ksc1'), e.lookup('AMM5B17/1JP1'), [item.name for item in e.FAMILIES])\n"
        "try: e.lookup('OTHERB99/1JP1')\n"
        "except e.OrderCodeError as error: print(error)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=tmp_path / "python")
    assert done.stdout.startswith("<OTHERA21/65KSC1> <AMM5B17/1JP1> ['amm5', 'other']\n'OTHERB99/1JP1' has singleturn '99'; valid are 17, 21, 23")


def test_same_bytes_whatever_the_hash_seed(tmp_path: Path) -> None:
    script = (
        "import hashlib, json; from codewheel.load import load_library; from codewheel.targets import Library; from codewheel.targets.python import generate\n"
        "print(hashlib.sha256(json.dumps(generate(Library(load_library()[0]))).encode()).hexdigest())"
    )
    seen = set()
    for seed, folder in (("0", "a"), ("1", "b b"), ("4711", "c")):
        (tmp_path / folder).mkdir()
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=tmp_path / folder, env={**os.environ, "PYTHONHASHSEED": seed})
        assert done.returncode == 0, done.stderr
        seen.add(done.stdout)
    assert len(seen) == 1


def test_lines_are_of_a_length_to_read(library: Library) -> None:
    for path, text in generate(library).items():
        if path.endswith(".py"):
            too_long = [line for line in text.splitlines() if len(line) > 120 and "http" not in line]
            assert not too_long, (path, too_long[:3])


def test_no_trace_of_the_machine(library: Library) -> None:
    text = "".join(generate(library).values())
    assert str(Path.cwd()) not in text and "/home/" not in text


def test_imports_are_all_used(library: Library) -> None:
    source = generate(library)["python/lika_encoders/amm5.py"]
    tree = ast.parse(source)
    imported = {alias.name for node in tree.body if isinstance(node, ast.ImportFrom) and node.module != "__future__" for alias in node.names}
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    assert imported - names == set()


@pytest.mark.parametrize("text", HOSTILE)
def test_text_of_a_spec_stays_text(text: str, tmp_path: Path, import_generated: Callable[[Library, str], tuple[Path, ModuleType]]) -> None:
    data = _parsed("amm5.yaml")
    _poison(data, text)
    maker = _parsed("manufacturer.yaml") | {"title": text, "trademarks": [text], "python_package": "hostile_encoders"}
    (tmp_path / "amm5.yaml").write_text(yaml.safe_dump(data, allow_unicode=True, sort_keys=False), encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_text(yaml.safe_dump(maker, allow_unicode=True), encoding="utf-8")
    devices, report = load_library([tmp_path])
    assert not report, "\n".join(problem.format() for problem in report.problems)
    package: Any = import_generated(Library(devices), "hostile_encoders")[1]
    modules = [package, package.amm5, package._codec, package._facts, package._order_codes]
    assert not any(hasattr(module, "BROKEN") for module in modules)
    assert package.amm5.ERRATA[0].printed == text
    assert package.lookup("AMM5A21/65KSC1").position_bits == 37
    clean, _ = load_library([SPECS])
    assert _shape(generate(Library(devices))["python/hostile_encoders/amm5.py"]) == _shape(generate(Library(clean))["python/lika_encoders/amm5.py"])
    toml = generate(Library(devices))["python/pyproject.toml"]
    if sys.version_info >= (3, 11):
        import tomllib

        assert tomllib.loads(toml)["project"]["name"] == "hostile-encoders"


def _parsed(name: str) -> dict[str, Any]:
    """The data of one of our specs, to be changed."""
    document = read_document(SPECS / name, Report())
    assert document is not None
    return copy.deepcopy(document.data)


def _poison(data: Any, text: str) -> None:
    """Puts ``text`` wherever running text stands."""
    texts = {"title", "meaning", "note", "special", "printed_name", "changes", "publisher", "signals", "profile", "value", "printed", "used", "why",
             "content", "mating", "signal", "remedy", "unit", "detected", "precondition", "result", "when_active", "when_inactive", "only", "address", "data"}
    if isinstance(data, dict):
        for key, value in data.items():
            if key in texts and isinstance(value, str) and not (key == "value" and "register" in data):
                data[key] = text
            else:
                _poison(value, text)
    elif isinstance(data, list):
        for item in data:
            _poison(item, text)


def _shape(source: str) -> list[str]:
    """The program without its texts."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            node.value = ""
    return ast.dump(tree).split("ClassDef")


def _write(files: dict[str, str], folder: Path) -> None:
    for path, text in files.items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
