"""The tests of the C target reach every line and branch of the headers: each condition was once true and once false.

Unreachable code is listed here with its reason.
"""

from __future__ import annotations

import re
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import pytest
from coverage import Coverage, read_coverage, run_tests
from tools import tool
from tree import generated_tree

ROOT = Path(__file__).resolve().parents[2]
FUNCTIONS = (
    "access",
    "biss_control",
    "biss_latency",
    "channels",
    "families",
    "motion",
    "read_position",
    "receive",
    "spi",
    "transport",
)
#: Tests that run programs over the headers, in both forms of the CRCs. The others only compile them,
#: or use headers of made-up devices.
TESTS = {
    "functions": [f"tests/c/test_c_{name}.py" for name in FUNCTIONS],
    "codecs": ["tests/c/test_c_codec.py", "tests/c/test_c_reports.py"],
}


@dataclass(frozen=True)
class Unreached:
    """Places that no call can reach: function and text, both as patterns, their number, and the reason."""

    function: str
    text: str
    count: int
    reason: str


#: Results of functions that can refuse only a length, and receive the length of an array of their own size. They are
#: still checked (MISRA C:2012 Dir 4.7). The same lines are needed for a spec whose values can be refused.
UNREACHED = (
    Unreached(
        r"lika_\w+_could_be",
        r"\(lika_\w+_reg_\w+_decode\(.*",
        11,
        "every value of the registers that identify an encoder decodes; what it says is looked at next",
    ),
    Unreached(
        r"lika_(am36|sma21)_biss_read_state",
        r"result != CW_OK|\{",
        8,
        "every configuration, and every number of steps and of revolutions, is one that an encoder can have",
    ),
    Unreached(
        r"lika_(am36|sma21)_biss_set_configuration",
        r"result != CW_OK|\{",
        4,
        "every byte is a configuration, and there is a place for each step",
    ),
    Unreached(
        r"lika_(am36|amm5|asc85)_ssi_position",
        r"verdict != CW_NOT_USABLE",
        3,
        "a word without a status bit always has the same verdict, unknown",
    ),
    Unreached(
        r"lika_(am36|amm5|asc85|sma21)_ssi_read_twice",
        r"again|\(again < verdict\)",
        8,
        "two usable words without a warning have the same verdict",
    ),
    Unreached(
        r"cw_(biss_master_next_late|runner_continue)",
        r"default",
        2,
        "every phase and every kind of step has a case of its own; MISRA C:2012 16.4 wants a default all the same",
    ),
    Unreached(
        r"cw_run_closing",
        r"\(failed < count\)",
        1,
        "running asks only about a step of the list; the proof asks about any",
    ),
    Unreached(
        r"cw_(runner_continue|runner_begin|run_step)",
        r"case CW_STEP_(WAIT|MORE):?",
        5,
        "a wait has no access, and further bytes belong to the step before them; the cases stand for readers",
    ),
    Unreached(
        r"lika_am36_biss_set_resolution_steps",
        r"result != CW_OK|\{",
        4,
        "a resolution that encodes is one that the encoder can have, from the bytes just written",
    ),
    Unreached(
        r"lika_sma21_biss_(write_preset_offset|set_preset_steps|set_offset_steps)",
        r"result != CW_OK|\{",
        6,
        "every value of 32 bits fits the register; limits are checked before",
    ),
)


@pytest.fixture(scope="module")
def headers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("headers")
    return {path.name: path for path in (generated_tree(folder) / "c" / "include").rglob("*.h")}


@pytest.fixture(scope="module")
def coverage(headers: dict[str, Path], tmp_path_factory: pytest.TempPathFactory) -> Coverage:
    folder = tmp_path_factory.mktemp("coverage")
    gcc, clang = tool("gcc"), tool("clang")
    with ThreadPoolExecutor(2) as pool:
        for status, output in pool.map(
            lambda name: run_tests(folder / name, [*TESTS[name], "-k", "not no_warning"], gcc, clang, ROOT), TESTS
        ):
            assert status == 0, output
    return read_coverage([folder / name for name in TESTS], headers.values(), tool("llvm-profdata"), tool("llvm-cov"))


def test_every_line_and_branch_is_reached(coverage: Coverage, headers: dict[str, Path]) -> None:
    with_functions = {name for name, path in headers.items() if "static inline" in path.read_text(encoding="ascii")}
    # The region in result.h belongs to CW_ASSERT, where it is used.
    assert {place[0] for place in coverage.regions} - {"result.h"} == with_functions
    assert len(coverage.regions) > 2_000
    assert len(coverage.true) > 500
    lines_by_header = {name: path.read_text(encoding="ascii").splitlines() for name, path in headers.items()}
    unexplained_places, reason_counts = [], Counter[Unreached]()
    for (name, line, column, last_line, last_column), function, missing_part in coverage.unreached():
        end = last_column - 1 if line == last_line else None
        source_text = lines_by_header[name][line - 1][column - 1 : end].strip()
        reasons_of_function = [reason for reason in UNREACHED if re.fullmatch(reason.function, function)]
        reason = next((reason for reason in reasons_of_function if re.fullmatch(reason.text, source_text)), None)
        if reason is None:
            unexplained_places.append(f"{name}:{line} {function}: {source_text[:80]} {missing_part}")
        else:
            reason_counts[reason] += 1
    assert not unexplained_places, f"{len(unexplained_places)} places\n" + "\n".join(unexplained_places)
    assert {reason: reason_counts[reason] for reason in UNREACHED} == {reason: reason.count for reason in UNREACHED}
