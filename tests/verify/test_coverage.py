"""The tests of the C target reach every line and every branch of the headers: each condition was true once and false once.

What cannot be reached is listed here with its reason.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from coverage import Coverage, measured, run_tests
from machines import crc_tables
from tools import tool
from tree import generated_tree

ROOT = Path(__file__).resolve().parents[2]
#: Those that run programs over the headers; the others only compile them.
TESTS = ["tests/c", "--ignore=tests/c/test_c_headers.py", "--ignore=tests/c/test_c_package.py", "-k", "not no_warning"]
#: Those that are run once more with the other form of the CRCs.
CODECS = ["tests/c/test_c_codec.py", "-k", "inverse or disturbed"]

#: Function, by a pattern, the text of the place and what is missing, also by patterns: and why no call can reach it.
UNREACHED: tuple[tuple[str, str, str, str], ...] = ()


@pytest.fixture(scope="module")
def headers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("headers")
    return {path.name: path for path in (generated_tree(folder) / "c" / "include").rglob("*.h")}


@pytest.fixture(scope="module")
def coverage(headers: dict[str, Path], tmp_path_factory: pytest.TempPathFactory) -> Coverage:
    folder = tmp_path_factory.mktemp("coverage")
    include = headers["encoder.h"].parents[1]
    for name, tests, options in (("folded", TESTS, []), ("table", CODECS, crc_tables(include))):
        status, said = run_tests(folder / name, tests, tool("gcc"), tool("clang"), ROOT, options)
        # A test that fails is told by ``make test``; it may have reached less.
        assert status in (0, 1), said
    return measured([folder / "folded", folder / "table"], headers.values(), tool("llvm-profdata"), tool("llvm-cov"))


def test_every_header_was_run(coverage: Coverage, headers: dict[str, Path]) -> None:
    assert {place[0] for place in coverage.regions} == set(headers)
    assert len(coverage.regions) > 2_000 and len(coverage.true) > 500


def test_every_line_and_branch_is_reached(coverage: Coverage, headers: dict[str, Path]) -> None:
    lines = {name: path.read_text(encoding="ascii").splitlines() for name, path in headers.items()}
    missing, used = [], set()
    for (name, line, column, end, last), function, what in coverage.unreached():
        text = lines[name][line - 1][column - 1 : last - 1 if line == end else None].strip()
        known = next((item for item in UNREACHED if all(re.fullmatch(pattern, given) for pattern, given in zip(item, (function, text, what)))), None)
        used.add(known)
        if known is None:
            missing.append(f"{name}:{line} {function}: {text[:80]} {what}")
    assert not missing, f"{len(missing)} places\n" + "\n".join(missing)
    assert [item for item in UNREACHED if item not in used] == [], "listed as unreachable, and reached"
