"""Measure how long the command line takes, as multiples of a Python program that only imports the dependencies.

    python benchmarks/tool_speed.py [--rounds N] [--families N] [--only TEXT]

All commands take turns, and the shortest time of each counts, because other programs only make it longer. "floors"
are wall time. The CPU time is the sum over all processes of a command, so it is longer if they run in parallel. A cold
run begins with an empty cache. The first run with many families generates them from nothing, which takes seconds for
each family. Peers that are not installed are left out with a message.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SPECS = ROOT / "specs" / "lika"
FLOOR = [sys.executable, "-c", "import argparse, dataclasses, json, pathlib, re"]
DBC = """VERSION ""
BO_ 496 Encoder: 8 Vector__XXX
 SG_ Position : 0|32@1+ (1,0) [0|0] "" Vector__XXX
 SG_ Error : 32|1@1+ (1,0) [0|0] "" Vector__XXX
"""
RDL = "addrmap demo { reg { field {} position[31:0]; } position; };\n"


@dataclass(frozen=True)
class Run:
    """A command to measure. ``before`` is called before each run, outside the measured time.

    ``cache`` is the folder in which it keeps results.
    """

    name: str
    command: Sequence[str]
    goal: float | None = None
    text: str = ""
    cache: str = "warm"
    before: Callable[[], object] = lambda: None


def codewheel(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "codewheel", *arguments]


def frames(count: int) -> str:
    """Return valid frames of an AMM5A21/65KSC1 with different positions, one a line: the data, nE, nW and a CRC-6."""
    lines = []
    for number in range(count):
        data, crc = number * 7919 << 2 | 3, 0
        for bit in f"{data:039b}":
            crc = crc << 1 & 0x3F ^ (0x03 if (crc >> 5 ^ int(bit)) & 1 else 0)
        lines.append(f"0x{data << 6 | crc ^ 0x3F:x}\n")
    return "".join(lines)


@dataclass(frozen=True)
class Figures:
    """Wall time and CPU time of a run in seconds, and its largest memory in KiB."""

    wall: float
    cpu: float
    memory: int

    def best(self, second: Figures) -> Figures:
        return Figures(min(self.wall, second.wall), min(self.cpu, second.cpu), self.memory)


def measured(run: Run, folder: Path) -> Figures:
    """Return the figures of one run."""
    run.before()
    # Like a package that pip installed, ours is compiled before, wherever it is and whatever the user's settings are.
    compiled = {"PYTHONPYCACHEPREFIX": str(folder / "compiled"), "PYTHONDONTWRITEBYTECODE": ""}
    environment = {**os.environ, **compiled, "XDG_CACHE_HOME": str(folder / run.cache)}
    with tempfile.TemporaryFile() as text:
        text.write(run.text.encode())
        text.seek(0)
        begun = time.perf_counter()
        process = subprocess.Popen(
            run.command, stdin=text, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=folder, env=environment
        )
        usage = os.wait4(process.pid, 0)[2]
        wall = time.perf_counter() - begun
    process.returncode = 0
    return Figures(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss)


def copies(place: Path, count: int) -> None:
    """Write a folder with a family of ours under several names."""
    place.mkdir()
    shutil.copy(SPECS / "manufacturer.yaml", place)
    text = (SPECS / "sma21.yaml").read_text(encoding="utf-8")
    for number in range(1000, 1000 + count):
        renamed = text.replace("device: sma21", f"device: sma{number}").replace("SMA21", f"SMA{number}")
        (place / f"sma{number}.yaml").write_text(renamed, encoding="utf-8")


def edit_comment(spec: Path) -> None:
    """Change a comment in the first line of a spec, or add it."""
    text = spec.read_text(encoding="utf-8")
    stamp = re.search(r"^# (\d+)\n", text)
    number = int(stamp[1]) + 1 if stamp else 1
    spec.write_text(f"# {number}\n{text[stamp.end() if stamp else 0 :]}", encoding="utf-8")


def edit_number(spec: Path) -> None:
    """Change the highest clock, which is in every output."""
    text = spec.read_text(encoding="utf-8")
    match = re.search(r"max_hz: (\d+)", text)
    assert match is not None
    spec.write_text(text.replace(match[0], f"max_hz: {int(match[1]) - 1000}", 1), encoding="utf-8")


def runs(work: Path, families: int) -> list[Run]:
    """Return all commands, in the order of the table."""
    shutil.copytree(SPECS, work / "specs")
    copies(work / "many", families)
    return [*reading_runs(work), *generating_runs(work), *runs_of_many(work / "many", families), *peers(work)]


def reading_runs(work: Path) -> list[Run]:
    """Return the commands that read specs once."""
    frame, specs = ("AMM5A21/65KSC1", "0xF4243D3"), ("--specs", str(SPECS))

    def empty() -> None:
        shutil.rmtree(work / "cold", ignore_errors=True)

    return [
        Run("decode", codewheel("decode", *frame, *specs), 4.5),
        Run("show", codewheel("show", frame[0], *specs), 4.5),
        Run("decode, cold", codewheel("decode", *frame, *specs), 10, cache="cold", before=empty),
        Run("list", codewheel("list", *specs), 3),
        Run("--version", codewheel("--version"), 1.5),
        Run("--help", codewheel("--help"), 1.5),
    ]


def generating_runs(work: Path) -> list[Run]:
    """Return the commands that check and generate, and those that decode many lines."""
    ours, spec = str(work / "specs"), work / "specs" / "asc85.yaml"
    generate = ("generate", ours, "-o", str(work / "out"))
    comment, number = partial(edit_comment, spec), partial(edit_number, spec)
    code, lines = "AMM5A21/65KSC1", frames(5000)
    return [
        Run("check, one spec changed", codewheel("check", ours), 20, before=comment),
        Run("check, nothing changed", codewheel("check", ours), 6),
        Run("generate, one comment changed", codewheel(*generate), 28, before=comment),
        Run("generate, one number changed", codewheel(*generate, "--unchecked"), 28, before=number),
        Run("generate, nothing changed", codewheel(*generate), 6),
        Run("generate --check, nothing changed", codewheel(*generate, "--check"), 6),
        Run("decode -, 5000 lines", codewheel("decode", code, "-"), text=lines),
        Run("decode - --json, 5000 lines", codewheel("decode", code, "-", "--json"), text=lines),
    ]


def runs_of_many(specs: Path, families: int) -> list[Run]:
    """Return the commands with many families."""
    last, out = f"SMA{999 + families}-SC4-0050", specs.with_name("many-out")
    generate = codewheel("generate", str(specs), "-o", str(out))
    return [
        Run(f"{families} families: decode", codewheel("decode", last, "0x1", "--specs", str(specs)), 5),
        Run(f"{families} families: list", codewheel("list", "--specs", str(specs))),
        Run(f"{families} families: generate, nothing changed", generate, 30),
    ]


def peers(work: Path) -> list[Run]:
    """Return comparable commands of other tools that are installed."""
    (work / "peer.dbc").write_text(DBC, encoding="utf-8")
    (work / "peer.rdl").write_text(RDL, encoding="utf-8")
    scripts = Path(sys.executable).parent
    arguments_by_peer = {
        "cantools": ("decode", str(work / "peer.dbc")),
        "peakrdl": ("dump", str(work / "peer.rdl")),
        "nnvg": ("--version",),
    }
    peer_runs = []
    for name, arguments in arguments_by_peer.items():
        if (scripts / name).exists():
            text = "vcan0 1F0 [8] 43 42 0F 00 00 00 00 00\n" if name == "cantools" else ""
            peer_runs.append(Run(f"{name} {arguments[0]}", [str(scripts / name), *arguments], text=text))
        else:
            print(f"{name} is not installed and is left out", file=sys.stderr)
    return peer_runs


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15, help="runs of each command")
    parser.add_argument("--families", type=int, default=50, help="copies of a family in a folder of their own")
    parser.add_argument("--only", default="", help="text in the names of the commands to measure")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        every = [Run("floor", FLOOR), *(run for run in runs(work, chosen.families) if chosen.only in run.name)]
        first: dict[str, Figures] = {}
        best: dict[str, Figures] = {}
        for _ in range(chosen.rounds):
            for run in every:
                figures = measured(run, work)
                first.setdefault(run.name, figures)
                best[run.name] = figures.best(best.get(run.name, figures))
    print("| command | ms | floors | goal | CPU ms | MB |\n| --- | ---: | ---: | ---: | ---: | ---: |")
    for run in every:
        figures, goal = best[run.name], "" if run.goal is None else f"{run.goal:g}"
        floors = figures.wall / best["floor"].wall
        cells = (f"{figures.wall * 1000:.0f}", f"{floors:.1f}", goal, f"{figures.cpu * 1000:.0f}")
        print(f"| {run.name} | {' | '.join(cells)} | {figures.memory / 1024:.0f} |")
    for run in every:
        if "families: generate" in run.name:
            figures = first[run.name]
            print(f"the first run of '{run.name}', from nothing: {figures.wall:.0f} s, {figures.memory / 1024:.0f} MB")
        if run.name.startswith("decode -"):
            alone = best["decode"].cpu if "decode" in best else 0
            print(f"{run.name}: {(best[run.name].cpu - alone) / run.text.count(chr(10)) * 1e6:.0f} µs a line")


if __name__ == "__main__":
    main()
