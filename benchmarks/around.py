"""Measure the size in bytes of the code around the decoders: receivers, tracker, angles, procedures, and a BiSS master.

    python benchmarks/around.py            measures and prints
    python benchmarks/around.py --write    also writes its table in docs/footprint.md and benchmarks/around.json,
                                           which tests/verify/test_footprint.py checks

Each part is a program with one function, linked as in footprint.py, with the parts of the compiler's library it needs.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from boards import BOARDS, Board
from candidates import write_headers

HERE = Path(__file__).resolve().parent
RECORDED = HERE / "around.json"
PAGE = HERE.parent / "docs" / "footprint.md"
BEGIN, END = "<!-- measured around -->", "<!-- end of measured around -->"


@dataclass(frozen=True)
class Part:
    """A function ``measured`` that calls ours. It may take up to ``most`` bytes on a Cortex-M. 0 means no limit."""

    title: str
    headers: tuple[str, ...]
    given: str
    body: str
    most: int = 0

    @property
    def source(self) -> str:
        folders = {"amm5_biss": "lika"}
        includes = "".join(f'#include "{folders.get(name, "codewheel")}/{name}.h"\n' for name in self.headers)
        head = f"uint32_t measured({self.given})"
        return f"{includes}{head};\n{head}\n{{\n    {self.body}\n}}\n"


_CODE = "LIKA_AMM5_BISS_A23_65KSC1"
PARTS = (
    Part(
        "receive: a BiSS frame of 47 bits",
        ("amm5_biss", "receive"),
        "const uint8_t *rx, uint64_t *word",
        f"return (uint32_t)cw_biss_receive(rx, {_CODE}_RX_BYTES, {_CODE}_BITS, word);",
        160,
    ),
    Part(
        "receive: an SSI word of 39 bits",
        ("amm5_biss", "receive"),
        "const uint8_t *rx, uint64_t *word",
        "return (uint32_t)cw_ssi_receive(rx, 6U, 39U, word);",
        160,
    ),
    Part(
        "receive: RS-485 byte by byte, also after a rejected reply",
        ("receive",),
        "cw_rs485_line *line, uint8_t byte, uint32_t now",
        "if (byte == 0U) { cw_rs485_resume(line); } return cw_rs485_take(line, byte) || cw_rs485_late(line, now);",
    ),
    Part(
        "tracker: a position",
        ("tracker",),
        "cw_tracker *axis, const uint64_t *position, uint32_t now",
        "return (uint32_t)cw_tracker_add(axis, *position, now);",
        240,
    ),
    Part("tracker: its speed", ("tracker",), "const cw_tracker *axis", "return (uint32_t)cw_tracker_speed(axis);"),
    Part(
        "angle: counts are a constant power of two",
        ("angle",),
        "const uint64_t *position",
        "return cw_angle(*position, 8388608U);",
    ),
    Part(
        "angle: any number of counts",
        ("angle",),
        "const uint64_t *position, const uint64_t *steps",
        "return cw_angle(*position, *steps);",
    ),
    Part(
        "angle: electrical, as Q31",
        ("angle",),
        "uint32_t angle, uint32_t offset",
        "return (uint32_t)cw_angle_q31(cw_angle_electrical(angle, 7U, offset));",
    ),
    Part("angle: thousandths of a degree", ("angle",), "uint32_t angle", "return cw_angle_millidegrees(angle);"),
    Part(
        "runner: start and end of a step",
        ("runner",),
        "cw_runner *runner, int32_t error, uint32_t now",
        "cw_runner_done(runner, error, now); return (uint32_t)cw_runner_next(runner, now);",
    ),
    Part(
        "BiSS master: control bit and answer in the same frame",
        ("biss",),
        "cw_biss_master *master, bool cds",
        "return cw_biss_master_next(master, cds) ? 1U : 0U;",
    ),
    Part(
        "BiSS master: answer one frame after the control bit",
        ("biss",),
        "cw_biss_master *master, bool cds",
        "return cw_biss_master_next_late(master, cds) ? 1U : 0U;",
    ),
)


def measure(board: Board, include: Path, folder: Path) -> dict[str, int]:
    """Return the bytes of each part on a board."""
    found = {}
    for part in PARTS:
        source = folder / "around.c"
        source.write_text(part.source, encoding="utf-8")
        found[part.title] = board.size([source], [include], "measured", folder)
    return found


def table(figures: Mapping[str, Mapping[str, int]]) -> str:
    names = [board.name for board in BOARDS]
    lines = ["| bytes | " + " | ".join(names) + " |", "|---" * (len(names) + 1) + "|"]
    lines += [
        f"| {part.title} | " + " | ".join(str(figures[name][part.title]) for name in names) + " |" for part in PARTS
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write docs/footprint.md and the recorded figures")
    write = parser.parse_args().write
    with tempfile.TemporaryDirectory() as name:
        include = write_headers(Path(name))
        figures = {board.name: measure(board, include, Path(name)) for board in BOARDS}
    print(table(figures))
    if write:
        page = PAGE.read_text(encoding="utf-8")
        before, after = page[: page.index(BEGIN) + len(BEGIN)], page[page.index(END) :]
        PAGE.write_text(f"{before}\n\n{table(figures)}\n{after}", encoding="utf-8")
        recorded = {board.name: {"compiler": board.version(), "bytes": figures[board.name]} for board in BOARDS}
        RECORDED.write_text(json.dumps(recorded, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    try:
        main()
    except (RuntimeError, FileNotFoundError) as problem:
        sys.exit(f"around: {problem}")
