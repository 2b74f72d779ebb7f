"""Rules for the repository that no linter holds. Rules for imports are in ``pyproject.toml``."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
ARCHITECTURE = (ROOT / "docs/extend/architecture.md").read_text(encoding="utf-8")
RECIPES = (ROOT / "docs/extend/how-to-change.md").read_text(encoding="utf-8")
#: Most words of the page that a contributor reads first.
MOST_WORDS = 1500
#: Widest line of a template. ruff has the same limit for Python.
COLUMNS = 120
#: Most lines of a module that users can read in one sitting.
MOST_LINES_OF_A_MODULE = 450
#: A place of this machine, in a text.
MACHINE_PLACE = re.compile(r"(?<![\w.}*)\\/])/(dev|etc|home|proc|root|run|sys|tmp|var)/\w")


def test_git_ignores_the_results_of_documented_commands() -> None:
    """``pip install`` of an example builds it in its folder, and its target writes to ``generated/``."""
    ignored = (ROOT / ".gitignore").read_text(encoding="utf-8").split()
    assert {"/build/", "/examples/*/build/", "*.egg-info/", "/generated/python/**/build/"} <= set(ignored)
    readmes = [path.read_text(encoding="utf-8") for path in (ROOT / "examples").glob("*/README.md")]
    default_outputs = re.findall(r"codewheel generate (?!.* -o ).*--target (\w+)$", "\n".join(readmes), re.MULTILINE)
    assert sorted(default_outputs) == ["opcua", "rust"]
    assert {f"/generated/{target}/" for target in default_outputs} <= set(ignored)


def test_the_map_names_each_package() -> None:
    named_packages = re.findall(r"`generator/(\w+)/` \|", ARCHITECTURE)
    packages = [path.parent.name for path in (ROOT / "generator").glob("*/__init__.py")]
    assert sorted(named_packages) == sorted(packages)


def test_files_that_the_recipes_name_exist() -> None:
    bases = (ROOT, ROOT / "generator")
    folders = {path.name for base in bases for path in base.iterdir() if path.is_dir()}
    texts = CONTRIBUTING + ARCHITECTURE + RECIPES
    named_paths = {path for path in re.findall(r"`([\w.-]+/[\w./-]*)`", texts) if path.split("/")[0] in folders}
    missing_paths = {path for path in named_paths if not (ROOT / path).exists()}
    missing_paths = {path for path in missing_paths if not (ROOT / "generator" / path).exists()}
    # Examples of any target.
    examples = {"generator/targets/NAME/files.py", "templates/NAME/"}
    assert missing_paths == examples


def test_the_first_page_for_contributors_begins_with_a_first_change_and_is_short() -> None:
    assert CONTRIBUTING.splitlines()[2] == "## A first change in three steps"
    steps = CONTRIBUTING.partition("\n## ")[2].partition("\n## ")[0]
    assert len(re.findall(r"^\d\. ", steps, re.MULTILINE)) == 3
    assert len(CONTRIBUTING.split()) <= MOST_WORDS


def test_no_line_of_a_template_is_too_wide_to_read() -> None:
    """In a template, ``{# -#}`` at the end of a line continues with the next line."""
    wide_lines = []
    for path in sorted((ROOT / "templates").rglob("*.jinja")):
        lines = enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        wide_lines += [f"{path.relative_to(ROOT)}:{number}" for number, line in lines if len(line) > COLUMNS]
    assert wide_lines == []


def test_no_module_of_the_python_runtime_is_too_long_to_read() -> None:
    line_counts = {
        path: path.read_text(encoding="utf-8").count("\n") for path in (ROOT / "runtime/python").rglob("*.py")
    }
    long_modules = {str(path): count for path, count in line_counts.items() if count > MOST_LINES_OF_A_MODULE}
    assert long_modules == {}


@pytest.mark.parametrize(("word", "limit"), [("zero_means", 3), ("active_low", 3), ("xorout", 6)])
def test_a_word_of_the_language_is_in_few_files_of_the_targets(word: str, limit: int) -> None:
    paths = [path for folder in ("generator/targets", "templates") for path in (ROOT / folder).rglob("*")]
    sources = [path.read_text(encoding="utf-8") for path in paths if path.suffix in (".py", ".jinja")]
    assert len([source for source in sources if re.search(rf"\b{word}\b", source)]) <= limit


@pytest.mark.slow
def test_no_test_names_a_place_of_the_machine() -> None:
    """Require tests and benchmarks to stay in temporary folders: no device, no fixed path, not even to be refused.

    If a guard in our code fails, a test run by root would replace the device or delete the file.
    """
    sources = [path for folder in ("tests", "benchmarks") for path in sorted((ROOT / folder).rglob("*.py"))]
    places = [place for path in sources if path != Path(__file__) for place in _machine_places(path)]
    assert places == []


def _machine_places(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        is_place = isinstance(node, ast.Constant) and isinstance(node.value, str) and MACHINE_PLACE.search(node.value)
        if is_place or (isinstance(node, ast.Attribute) and node.attr == "devnull"):
            yield f"{path.relative_to(ROOT)}:{node.lineno}"
