"""Breaking of long lines: the broken code means the same as the code on long lines."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from pathlib import Path

import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library
from codewheel.targets.python import line_breaks
from codewheel.targets.python.files import generate
from codewheel.targets.python.line_breaks import break_lines
from exhaustive import mostly_exhaustive

TESTS = Path(__file__).resolve().parents[1]
FAMILIES = [TESTS / "python/specs", TESTS / "specs"]

FIRST, SECOND, THIRD = (f"self.variant.{name * 16}" for name in ("one", "two", "ten"))


@pytest.mark.parametrize(
    "line",
    [
        f"is_unknown = ({FIRST} + {SECOND} + {THIRD}) == 0",
        f"is_unknown = ({FIRST} - {SECOND} + {THIRD}) == 0",
        f"is_active = ({FIRST} and not ({SECOND} or {THIRD}))",
        f"is_active = ({FIRST} == 3 and {SECOND} == 0x10 and not {THIRD})",
        f"number = ({FIRST} << {SECOND} | {THIRD})",
        f"number = ({FIRST} << ({SECOND} + {THIRD}))",
        f"number = ({FIRST} if {SECOND} and {THIRD} else 0)",
        f"number = ({FIRST}[{SECOND} + {THIRD}])",
        f"number = table[{FIRST} + {SECOND} + {THIRD}]",
        f"parts = table[{FIRST} + {SECOND} : {THIRD}]",
        f"value = call({FIRST} + {SECOND} + {THIRD})",
        f"values = ({FIRST} + {SECOND} + {THIRD},)",
        f"values = [{FIRST} + {SECOND} + {THIRD}]",
        f"values = [{FIRST} + number + {SECOND} for number in {THIRD}]",
        f"values = tuple({FIRST} + number + {SECOND} for number in {THIRD})",
        f"values = {{name: {FIRST} + number + {SECOND} for name, number in {THIRD}}}",
        f"values = (*([{FIRST} + {SECOND}] if {THIRD} else []), 1)",
        f"""values = ("{FIRST} or for {SECOND}, if not {THIRD}",)""",
        f"""values = ["{FIRST} or for {SECOND}, if not {THIRD}"]""",
        f"""is_named = ("a (b" == {FIRST} or "or {SECOND}" == {THIRD})""",
    ],
)
def test_a_broken_line_means_the_same(line: str) -> None:
    assert len(line) > line_breaks.WIDTH
    lines = break_lines(line).splitlines()
    assert len(lines) > 1
    assert ast.dump(ast.parse("\n".join(lines))) == ast.dump(ast.parse(line))


def test_an_expression_in_parentheses_has_one_operand_per_line() -> None:
    line = f"is_active = ({FIRST} + 1 and not ({SECOND} or {THIRD} or {FIRST}) and {SECOND})"
    assert break_lines(line).splitlines() == [
        "is_active = (",
        f"    {FIRST} + 1",
        "    and not (",
        f"        {SECOND}",
        f"        or {THIRD}",
        f"        or {FIRST}",
        "    )",
        f"    and {SECOND}",
        ")",
    ]


@pytest.fixture(scope="module")
def library() -> Library:
    devices, _ = load_library(FAMILIES)
    return Library(devices)


def modules(library: Library, width: int, monkeypatch: pytest.MonkeyPatch) -> Mapping[str, str]:
    """Return the generated modules with lines broken at ``width``."""
    monkeypatch.setattr(line_breaks, "WIDTH", width)
    files = generate(library).items()
    return {path: text for path, text in files if path.endswith(".py") and "/runtime/" not in path}


@pytest.mark.slow
@pytest.mark.parametrize("width", mostly_exhaustive([30, 120], 30))
def test_modules_mean_the_same_at_any_width(width: int, library: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    """At 30 columns, nearly every statement that can be broken is broken."""
    unbroken = modules(library, 1_000_000, monkeypatch)
    for path, text in modules(library, width, monkeypatch).items():
        assert ast.dump(ast.parse(text)) == ast.dump(ast.parse(unbroken[path])), path
