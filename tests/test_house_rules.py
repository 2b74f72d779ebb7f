"""The map of CONTRIBUTING names every package, and the packages import each other only as it says."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest
from figures.imports import Graph, cycles, graph, packages
from figures.reading import searches
from figures.tree import COLUMNS, Checkout

ROOT = Path(__file__).resolve().parents[1]


@cache
def checkout() -> Checkout:
    """Read the checkout once, but not at collection, when every worker would read all modules."""
    return Checkout(ROOT)


@cache
def arrows() -> Graph:
    """Return the imports of each module."""
    return graph(checkout().modules)


def reached(name: str) -> set[str]:
    """Return a module and all that it imports, directly or indirectly."""
    found, waiting = set[str](), [name]
    while waiting:
        module = waiting.pop()
        if module not in found:
            found.add(module)
            waiting += arrows()[module]
    return found


def test_the_map_names_each_package() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = re.findall(r"`generator/(\w+)/` \|", text)
    folders = [path.parent.name for path in (ROOT / "generator").glob("*/__init__.py")]
    assert sorted(named) == sorted(folders)


def test_files_that_the_recipes_name_exist() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    tops = {path.name for folder in (ROOT, ROOT / "generator") for path in folder.iterdir() if path.is_dir()}
    named = {path for path in re.findall(r"`([\w.-]+/[\w./-]*)`", text) if path.partition("/")[0] in tops}
    missing = {path for path in named if not any((folder / path).exists() for folder in (ROOT, ROOT / "generator"))}
    # The first one is from the recipe for an interface, and the others are examples of any target.
    assert missing == {"generator/model/interfaces/endat.py", "generator/targets/NAME/files.py", "templates/NAME/"}


@pytest.mark.slow
def test_no_target_reads_back_what_it_has_written() -> None:
    """``figures.reading`` allows searches in names and in text of manuals, each with a reason."""
    found = [f"{item.place} {item.function}: {item.expression}" for item in searches(checkout()) if not item.reason]
    assert found == []


def test_no_line_is_too_wide_to_read() -> None:
    """In a template, ``{# -#}`` at the end of a line goes on with the next one."""
    assert COLUMNS == 120
    assert list(checkout().wide_lines()) == []


@pytest.mark.parametrize(("word", "most"), [("zero_means", 3), ("active_low", 3), ("xorout", 6)])
def test_a_word_of_the_language_is_in_few_files_of_the_targets(word: str, most: int) -> None:
    files = [path for top in ("generator/targets", "templates") for path in (ROOT / top).rglob("*")]
    texts = {path: path.read_text(encoding="utf-8") for path in files if path.suffix in (".py", ".jinja")}
    assert len([path for path, text in texts.items() if re.search(rf"\b{word}\b", text)]) <= most


@pytest.mark.slow
def test_there_is_no_cycle() -> None:
    assert cycles(arrows()) == []


@pytest.mark.slow
def test_no_test_names_a_place_of_the_machine() -> None:
    """Require tests and benchmarks to stay in temporary folders: no device, no fixed path, not even to be refused.

    If a guard in our code fails, a test run by root would replace the device or delete the file.
    """
    place = re.compile(r"(?<![\w.}*)\\/])/(dev|etc|home|proc|root|run|sys|tmp|var)/\w")
    found = [
        source.at(node.lineno)
        for folder in ("tests", "benchmarks")
        for source in checkout().files(folder, ".py")
        for node in ast.walk(source.tree)
        if (isinstance(node, ast.Constant) and isinstance(node.value, str) and place.search(node.value))
        or (isinstance(node, ast.Attribute) and node.attr == "devnull")
    ]
    assert found == []


@pytest.mark.parametrize(
    ("package", "may"),
    [
        ("model", set()),
        ("say", {"model"}),
        ("order_codes", {"model"}),
        ("plan", {"model"}),
        ("reference", {"model", "order_codes", "say"}),
        ("write", {"lock"}),
        ("lock", set()),
    ],
)
def test_what_a_package_may_import(package: str, may: set[str]) -> None:
    """The plan knows no target and no wording. The reference codec tests it, so it does not know the plan."""
    assert packages(arrows())[package] <= may


@pytest.mark.parametrize("package", ["masters", "plan", "say", "targets"])
def test_outputs_do_not_use_the_codec_that_judges_them(package: str) -> None:
    assert "reference" not in packages(arrows())[package]


def test_only_commands_know_of_second_readings() -> None:
    """Outputs get the counts of second readings from the model."""
    users = {
        module.partition(".")[0] for module, others in arrows().items() for other in others if "readings." in other
    }
    assert users == {"readings", "commands"}


@pytest.mark.parametrize("name", ["decode", "decode_run", "diff", "look_up", "show", "show_parts"])
def test_commands_that_only_look_load_no_target(name: str) -> None:
    assert {module for module in reached(f"commands.{name}") if module.partition(".")[0] == "targets"} == set()
