"""The generated source: typed, reproducible, and safe against any text in a spec."""

from __future__ import annotations

import ast
import copy
import importlib
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.loading.library import load_library
from codewheel.model import Device, Flag
from codewheel.model.registers import has_steps
from codewheel.targets import Library
from codewheel.targets.python.files import generate
from codewheel.targets.python.readme import ReadmeExample
from python_path import python_path

SPECS = Path(__file__).resolve().parents[2] / "specs" / "lika"

#: Texts that would end a string, a docstring or a comment if they could.
HOSTILE = [
    '"""\nimport os\nBROKEN = 1\n"""',
    "'''\nBROKEN = 1\n'''",
    'ends with a quote"',
    "ends with a backslash\\",
    'both \\"',
    '""""""',
    "\\N{BULLET} \\x41 \\u0041 {{ 7 * 7 }} {% raw %}",
    "line\nBROKEN = 1\n# line",
    "a\tb `code` |table| <script>alert(1)</script>",
    "{braces} %s %(name)s $x",
]


@pytest.mark.slow
def test_types_are_strict(generated_python: tuple[Path, ModuleType]) -> None:
    folder, package = generated_python
    completed = subprocess.run(
        [
            sys.executable,
            "-m",
            "mypy",
            "--strict",
            "--python-version",
            "3.10",
            "--no-incremental",
            str(folder / package.__name__),
        ],
        capture_output=True,
        text=True,
        env={**os.environ, "MYPYPATH": str(folder / "runtime")},
    )
    assert completed.returncode == 0, completed.stdout + completed.stderr


@pytest.mark.slow
def test_two_families_in_one_package(library: Library, tmp_path: Path) -> None:
    from codewheel.model import OrderCode

    first = next(device for device in library.devices if device.name == "amm5")

    def renamed(text: str) -> str:
        return text.replace("AMM5", "OTHER")

    code: OrderCode = replace(first.order_code, pattern=renamed(first.order_code.pattern))
    variants = tuple(replace(variant, code=renamed(variant.code)) for variant in first.variants)
    second = replace(first, name="other", title="Other encoders", order_code=code, variants=variants, examples=())
    _write(generate(Library((first, second))), tmp_path)
    completed = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--no-incremental", str(tmp_path / "python" / "lika_encoders")],
        capture_output=True,
        text=True,
        env={**os.environ, "MYPYPATH": str(tmp_path / "python" / "runtime")},
    )
    assert completed.returncode == 0, completed.stdout + completed.stderr
    script = """
import lika_encoders as e

print(e.lookup('othera21/65ksc1'), e.lookup('AMM5B17/1JP1'), [item.name for item in e.FAMILIES])
try:
    e.lookup('OTHERB99/1JP1')
except e.OrderCodeError as error:
    print(error)
"""
    environment = {**os.environ, "PYTHONPATH": python_path(tmp_path / "python")}
    completed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=environment)
    assert completed.stdout.startswith(
        "<OTHERA21/65KSC1> <AMM5B17/1JP1> ['amm5', 'other']\n"
        "'OTHERB99/1JP1' has singleturn '99'; valid values: 17, 21, 23; similar order codes: "
    )


@pytest.mark.slow
def test_no_method_reads_an_item_by_its_number(files: Mapping[str, str]) -> None:
    """Items of a frame have names. ``data[0]`` is a byte, which has none."""
    modules = [text for path, text in files.items() if path.startswith("python/lika_encoders/")]
    assert len(modules) > 4
    assert re.findall(r"\bself\[\d+\]", "".join(modules)) == []


@pytest.mark.slow
def test_lines_are_of_a_length_to_read(files: Mapping[str, str]) -> None:
    for path, text in files.items():
        if path.endswith(".py"):
            too_long = [line for line in text.splitlines() if len(line) > 120 and "http" not in line]
            assert not too_long, (path, too_long[:3])


#: The assignment of a value in a decoder to the variable of its attribute, and the place of its bits in a word or byte.
COMMENT = re.compile(r"^ +(\w+) = .*  # bits? (\d+)(?::(\d+))?(, active low)?$", re.MULTILINE)


def test_comments_name_the_bits_of_the_spec(files: Mapping[str, str], devices: Mapping[str, Device]) -> None:
    compared = 0
    for device in devices.values():
        class_texts = files[f"python/lika_encoders/{device.name}.py"].split("\nclass ")
        layouts = [*(layout for _, layout in device.layouts()), *(register.layout for register in device.registers)]
        text_by_class = {class_text.partition("(")[0]: class_text for class_text in class_texts}
        for layout in layouts:
            class_text = text_by_class.get("".join(word.capitalize() for word in layout.name.split("_")), "")
            field_by_name = {field.name: field for field in layout.fields}
            for name, high, low, is_low in COMMENT.findall(class_text):
                field = field_by_name[name.rstrip("_")]
                lowest_bit = field.low.constant
                highest_bit = lowest_bit + field.width.constant - 1
                printed_bits = (int(high), int(low or high))
                bits_in_byte = (highest_bit % 8, lowest_bit % 8)
                assert printed_bits in ((highest_bit, lowest_bit), bits_in_byte), (device.name, layout.name, name)
                assert bool(is_low) == (isinstance(field.kind, Flag) and field.kind.active_low), (device.name, name)
                compared += 1
    assert compared > 60


#: An operand of a bit operator that is another operation without parentheses, as in ``a >> 3 & 0xF``.
BARE_OPERAND = re.compile(
    r"(?:<<|>>) [\w.]+(?:\[\d+\])? [&|^] |[&|^] [\w.]+(?:\[\d+\])? (?:<<|>>) |& [\w.]+(?:\[\d+\])? [|^] "
)


def test_what_a_reader_stumbled_over_is_gone(files: Mapping[str, str]) -> None:
    for path, text in files.items():
        if not path.endswith(".py") or "codewheel_runtime" in path:
            continue
        assert not BARE_OPERAND.findall(text), path
        # Citations are below the summary, and reasons above the condition of a verdict.
        for function in ast.walk(ast.parse(text)):
            if not isinstance(function, ast.FunctionDef):
                continue
            summary = (ast.get_docstring(function) or "").partition("\n")[0]
            assert not summary.endswith("]."), (path, function.name, summary)
            if function.name == "verdict":
                lines = text.splitlines()
                conditions = [statement for statement in function.body if isinstance(statement, ast.If)]
                assert all(lines[condition.lineno - 2].lstrip().startswith("# ") for condition in conditions), path


@pytest.mark.slow
def test_a_linter_finds_nothing(files: Mapping[str, str], tmp_path: Path) -> None:
    """Python's own style and pyflakes, with the default settings of users' tools."""
    shapes, _ = load_library([Path(__file__).parent / "specs"])
    for folder, package_files in (("ours", files), ("shapes", generate(Library(shapes)))):
        for path, text in package_files.items():
            place = tmp_path / folder / path
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(text, encoding="utf-8")
    rules = ["--isolated", "--preview", "--line-length=120", "--select=E,W,F", "--ignore=E501", "--no-cache"]
    command = [sys.executable, "-m", "ruff", "check", *rules, "--output-format=concise", str(tmp_path)]
    assert subprocess.run(command, capture_output=True, text=True).stdout == "All checks passed!\n"


def test_no_trace_of_the_machine(files: Mapping[str, str]) -> None:
    text = "".join(files.values())
    assert str(Path.cwd()) not in text
    assert "/home/" not in text


def _assigns_all(node: ast.stmt) -> bool:
    return isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"


@pytest.mark.slow
def test_imports_are_all_used(files: Mapping[str, str]) -> None:
    """This also holds if a field has the name of a function."""
    shapes, _ = load_library([Path(__file__).parent / "specs"])
    for path, source in {**files, **generate(Library(shapes))}.items():
        if not path.endswith(".py") or path.endswith(("__init__.py", "_encoders/biss.py")):
            continue
        tree = ast.parse(source)
        imports = [node for node in tree.body if isinstance(node, ast.ImportFrom) and node.module != "__future__"]
        imported = {alias.asname or alias.name for node in imports for alias in node.names}
        names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        exported = next((node.value for node in tree.body if _assigns_all(node)), None)
        names |= set(ast.literal_eval(exported)) if exported is not None else set()
        assert imported - names == set(), path


@pytest.fixture(scope="module")
def shape(files: Mapping[str, str]) -> list[str]:
    """The rest of the module of AMM5 without its texts."""
    return _shape(files["python/lika_encoders/amm5.py"])


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.slow
@pytest.mark.parametrize("text", HOSTILE)
def test_text_of_a_spec_stays_text(
    text: str, shape: list[str], tmp_path: Path, import_generated: Callable[[Library, str], tuple[Path, ModuleType]]
) -> None:
    data = _parsed_spec("amm5.yaml")
    _poison(data, text)
    # Quotation marks in the printed text of an erratum come in pairs, and its title is its own.
    printed = f'"{text}' if text.count('"') % 2 else text
    for number, erratum in enumerate(data["errata"], 1):
        erratum |= {"title": f"{number} {text}", "printed": printed}
    maker = _parsed_spec("manufacturer.yaml") | {
        "title": text,
        "trademarks": [text],
        "python_package": "hostile_encoders",
    }
    (tmp_path / "amm5.yaml").write_text(json.dumps(data, ensure_ascii=False, indent=1), encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_text(json.dumps(maker, ensure_ascii=False, indent=1), encoding="utf-8")
    devices, report = load_library([tmp_path])
    assert not report, "\n".join(problem.format() for problem in report.problems)
    package: Any = import_generated(Library(devices), "hostile_encoders")[1]
    modules = [package, package.amm5, importlib.import_module("hostile_encoders.facts.amm5")]
    assert not any(hasattr(module, "BROKEN") for module in modules)
    assert package.amm5.ERRATA[0].printed == printed
    assert package.lookup("AMM5A21/65KSC1").position_bits == 37
    files = generate(Library(devices))
    assert _shape(files["python/hostile_encoders/amm5.py"]) == shape
    toml = files["python/pyproject.toml"]
    if sys.version_info >= (3, 11):
        import tomllib

        assert tomllib.loads(toml)["project"]["name"] == "hostile-encoders"


def _parsed_spec(name: str) -> dict[str, Any]:
    """Return the data of one of our specs, to be changed."""
    document = read_document(SPECS / name, ProblemReport())
    assert document is not None
    return copy.deepcopy(document.data)


#: Keys whose values are running texts.
TEXTS = {
    *("title", "meaning", "note", "special", "printed_name", "changes", "publisher", "signals", "profile", "value"),
    *("printed", "used", "why", "content", "mating", "signal", "remedy", "unit", "detected", "precondition", "result"),
    *("when_active", "when_inactive", "address", "data"),
}


#: Texts that are kept: they differ between neighbours, or a note names a signal that is missing on a cable.
KEEP_THEIR_TEXT = {"meaning", "printed_name", "signal", "note"}
#: Signals that several contacts have, or that a cable lacks.
REPEATED_SIGNALS = {"not connected", "not to be connected", "not used", "reserved", "Ground"}


def _poison(data: Any, text: str) -> None:
    """Put ``text`` into every running text."""
    if isinstance(data, dict):
        if any(isinstance(value, dict) and "quantity" in value for value in data.get("values") or ()):
            del data["values"]  # The text must contain them.
        if data.get("signal") in REPEATED_SIGNALS:
            return
        for key, value in data.items():
            if key in TEXTS and isinstance(value, str) and not (key == "value" and "register" in data):
                # Numbers of steps stay, because remedies refer to them.
                poison = f"1. {text} 2. {text} 3. {text}" if has_steps(value) else text
                data[key] = f"{value} {poison}" if key in KEEP_THEIR_TEXT else poison
            else:
                _poison(value, text)
    elif isinstance(data, list):
        for member in data:
            _poison(member, text)


def _shape(source: str) -> list[str]:
    """Return the program without its texts."""
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


def test_no_text_of_a_spec_ends_a_block_of_the_readme() -> None:
    assert ReadmeExample("", "", "", "", printed_lines=("10", "a `flag`")).fence == "```"
    assert ReadmeExample("", "", "", "", printed_lines=("10", "```\n<img>")).fence == "````"
