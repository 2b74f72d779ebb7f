"""The generated decoders stay as small and fast as recorded: bytes, instructions and cycles are exact.

``python benchmarks/footprint.py --write`` records them again. docs/trust/footprint.md shows the same figures next to
other generators.
"""

from __future__ import annotations

import importlib
import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tools import tool

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
RECORDED: dict[str, Any] = json.loads((BENCHMARKS / "footprint.json").read_text(encoding="utf-8"))
AROUND: dict[str, Any] = json.loads((BENCHMARKS / "around.json").read_text(encoding="utf-8"))


@pytest.fixture
def footprint(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The script that measures. It needs the emulator of the extra ``bench``."""
    if importlib.util.find_spec("unicorn") is None:
        words = (
            "no Python package unicorn here, so the instructions are not counted; "
            "pip install 'codewheel[bench]' or make bench"
        )
        if os.environ.get("CODEWHEEL_REQUIRE_TOOLS"):
            pytest.fail(words)
        pytest.skip(words)
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    yield importlib.import_module("footprint")
    for name in ("footprint", "around", "boards", "candidates", "host"):
        sys.modules.pop(name, None)


@pytest.mark.parametrize("name", RECORDED)
def test_no_byte_and_no_instruction_more_than_recorded(name: str, footprint: Any, tmp_path: Path) -> None:
    (board,) = (board for board in footprint.BOARDS if board.name == name)
    tool(board.compiler)
    if name == "avr":
        tool("simavr")
    recorded = RECORDED[name]
    if board.version() != recorded["compiler"]:
        pytest.skip(
            f"the figures were recorded with {recorded['compiler']}, here is {board.version()}; "
            "make bench BENCH=--write records them anew"
        )
    measured, figures = footprint.measure_ours(board, tmp_path), recorded["figures"]
    assert measured.keys() == figures.keys()
    more = []
    for frame, rows in measured.items():
        assert rows.keys() == figures[frame].keys()
        for key, pair in rows.items():
            figure = figures[frame][key]
            if pair[0] > figure[0] or pair[1] > figure[1]:
                more.append(f"{frame}, {key}: {list(pair)} where {figure} are recorded (bytes, {board.unit})")
    assert not more, "\n".join(more)


@pytest.fixture
def around(footprint: Any) -> Any:
    return importlib.import_module("around")


@pytest.mark.parametrize("name", AROUND)
def test_what_is_around_takes_no_more_than_recorded(name: str, around: Any, tmp_path: Path) -> None:
    (board,) = (board for board in around.BOARDS if board.name == name)
    tool(board.compiler)
    if name == "avr":
        tool("simavr")
    if board.version() != AROUND[name]["compiler"]:
        pytest.skip(f"the figures were recorded with {AROUND[name]['compiler']}, here is {board.version()}")
    measured, recorded = around.measure(board, around.write_headers(tmp_path), tmp_path), AROUND[name]["figures"]
    assert measured.keys() == recorded.keys()
    pairs = {key: (pair, recorded[key]) for key, pair in measured.items()}
    assert {key: pair for key, pair in pairs.items() if _is_more(*pair)} == {}


def _is_more(measured: Sequence[int | None], recorded: Sequence[int | None]) -> bool:
    return (measured[0] or 0) > (recorded[0] or 0) or (measured[1] or 0) > (recorded[1] or 0)


@pytest.mark.parametrize("name", ["cortex-m0plus", "cortex-m4"])
def test_what_is_around_is_within_its_bounds(name: str, around: Any) -> None:
    """Bytes of code, and instructions from a buffer to a position. The recorded values come from the test above."""
    recorded = AROUND[name]["figures"]
    assert {part.title: part.most for part in around.PARTS if 0 < part.most < recorded[part.title][0]} == {}
    bounds = {part.title: part.call.at_most[name] for part in around.PARTS if part.call and name in part.call.at_most}
    assert bounds
    assert {key: limit for key, limit in bounds.items() if recorded[key][1] > limit} == {}


@pytest.mark.parametrize("processor", ["", "__ARM_FEATURE_UNALIGNED __ARM_FEATURE_CLZ", "__AVR__"])
def test_code_written_by_hand_does_the_same(processor: str, around: Any, tmp_path: Path) -> None:
    """Its results, verdicts and values equal ours for a million frames, in its forms for each processor."""
    compiler = [tool("gcc"), "-std=c99", "-O1", "-fsanitize=undefined,address", "-fno-sanitize-recover=all"]
    macros = [f"-D{name}" for name in processor.split()]
    program = tmp_path / "compare"
    include = around.write_headers(tmp_path)
    source = BENCHMARKS / "c" / "compare.c"
    subprocess.run([*compiler, *macros, f"-I{include}", str(source), "-o", str(program)], check=True, timeout=300)
    completed = subprocess.run([str(program)], capture_output=True, text=True, timeout=300)
    assert (completed.returncode, completed.stdout, completed.stderr) == (0, "", "")


def test_a_wrong_position_is_no_figure(around: Any, tmp_path: Path) -> None:
    """The emulated call must return the position of the sample."""
    tool(around.BOARDS[0].compiler)
    part = next(part for part in around.PARTS if part.call)
    changed_part = replace(part, call=replace(part.call, good=part.call.good.replace("==", "!=")))
    with pytest.raises(RuntimeError, match="not decoded as it should be"):
        around.measured(changed_part, around.BOARDS[0], around.write_headers(tmp_path), tmp_path)


def test_a_wrongly_decoded_frame_is_no_figure(footprint: Any, tmp_path: Path) -> None:
    """The emulated call must return the right members. A decoder that is not reached would be the fastest of all."""
    board = footprint.BOARDS[0]
    tool(board.compiler)
    frame = footprint.FRAMES[0]
    first = next(iter(footprint.ours(frame)))
    include = [footprint.write_headers(tmp_path)]
    broken = type(first)(**{**vars(first), "good": "out.multiturn == 1U"})
    with pytest.raises(RuntimeError, match="not decoded as it should be"):
        footprint.measure(frame, broken, board, include, tmp_path)
