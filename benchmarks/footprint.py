"""Measure size and speed of the generated C decoders, hand-written decoders, and decoders from other generators.

    python benchmarks/footprint.py            measures and prints
    python benchmarks/footprint.py --write    also writes the table of docs/trust/footprint.md
                                              and the figures that tests/verify/test_footprint.py checks

Bytes and counts are exact. Times are not, so only their ratios are in the files.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from boards import BOARDS, Board
from candidates import FRAMES, Candidate, Frame, candidates, entry, ours, write_headers, write_peers
from host import nanoseconds

HERE = Path(__file__).resolve().parent
RECORDED = HERE / "footprint.json"
PAGE = HERE.parent / "docs/trust/footprint.md"
BEGIN, END = "<!-- measured -->", "<!-- end of measured -->"

#: Bytes and executed instructions by the name of the board.
Figures = Mapping[str, tuple[int, int]]


def measure(frame: Frame, candidate: Candidate, board: Board, include: list[Path], folder: Path) -> tuple[int, int]:
    """Return the bytes of a candidate on a board, and the instructions of one call."""
    source, around = folder / "source.c", folder / "entry.c"
    source.write_text(candidate.source, encoding="utf-8")
    around.write_text(entry(frame, candidate), encoding="utf-8")
    return board.size([source], include, candidate.function, folder), board.executed([source, around], include, folder)


def measure_ours(board: Board, folder: Path) -> dict[str, dict[str, tuple[int, int]]]:
    """Return the figures of our decoders, by frame and candidate. A test checks them without the other generators."""
    include = [write_headers(folder)]
    figures: dict[str, dict[str, tuple[int, int]]] = {}
    for frame in FRAMES:
        for candidate in ours(frame):
            figures_of_frame = figures.setdefault(frame.name, {})
            figures_of_frame[candidate.name] = measure(frame, candidate, board, include, folder)
    return figures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write docs/trust/footprint.md and the recorded figures")
    write = parser.parse_args().write
    text: list[str] = []
    recorded: dict[str, dict[str, Any]] = {}
    for board in BOARDS:
        recorded[board.name] = {"compiler": board.version(), "figures": {frame.name: {} for frame in FRAMES}}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        include = [write_headers(folder), write_peers(folder / "peers")]
        for frame in FRAMES:
            chosen = list(candidates(frame, include[1]))
            rows = {}
            for candidate in chosen:
                by_board = {board.name: measure(frame, candidate, board, include, folder) for board in BOARDS}
                rows[candidate.name] = by_board
            times = nanoseconds(frame, chosen, include, folder)
            for candidate in ours(frame):
                for board in BOARDS:
                    recorded[board.name]["figures"][frame.name][candidate.name] = rows[candidate.name][board.name]
            text += [*table(frame, chosen, rows, times), ""]
            print("\n".join(text[-len(chosen) - 5 :]))
            print(
                "ns per frame on this machine: "
                + ", ".join(f"{key} {value:.1f}" for key, value in times.items())
                + "\n"
            )
    if write:
        versions = [f"Compilers: {', '.join(dict.fromkeys(board.version() for board in BOARDS))}.", ""]
        page = PAGE.read_text(encoding="utf-8")
        before, after = page[: page.index(BEGIN) + len(BEGIN)], page[page.index(END) :]
        PAGE.write_text(before + "\n\n" + "\n".join([*versions, *text]) + after, encoding="utf-8")
        RECORDED.write_text(json.dumps(recorded, indent=1) + "\n", encoding="utf-8")


def table(
    frame: Frame, chosen: Iterable[Candidate], rows: Mapping[str, Figures], times: Mapping[str, float]
) -> Iterable[str]:
    yield f"### {frame.title}"
    yield ""
    yield (
        "| | "
        + " | ".join(f"{board.name}: bytes / {board.unit}" for board in BOARDS)
        + " | host, hand-written = 1 | does |"
    )
    yield "|---" * (len(BOARDS) + 3) + "|"
    for candidate in chosen:
        pairs = [rows[candidate.name][board.name] for board in BOARDS]
        figures = " | ".join(f"{size} / {count}" for size, count in pairs)
        ratio = times[candidate.name] / times["hand-written"]
        yield f"| {candidate.name} | {figures} | {ratio:.1f} | {candidate.does} |"


if __name__ == "__main__":
    try:
        main()
    except (RuntimeError, FileNotFoundError) as problem:
        sys.exit(f"footprint: {problem}")
