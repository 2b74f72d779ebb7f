"""Claims in a C file of functions without arguments, each proved by CBMC over the headers, or refuted."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

from tools import tool

#: Undefined behaviour of every kind that the checker knows.
UNDEFINED = (
    "--bounds-check --pointer-check --pointer-overflow-check --pointer-primitive-check"
    " --signed-overflow-check --undefined-shift-check --div-by-zero-check --unwinding-assertions"
).split()
OURS = str(Path(__file__).resolve().parents[2] / ".cbmc")


def claims_of(harness: Path) -> list[str]:
    return re.findall(r"^void (\w+)\(void\)$", harness.read_text(encoding="utf-8"), re.MULTILINE)


def verdict(harness: Path, claim: str, include: Path, folder: Path, rounds: int) -> str:
    """What fails, or nothing; ``rounds`` bounds each loop."""
    (header,) = include.glob("*/encoder.h")
    maker = header.parent.name
    text = harness.read_text(encoding="utf-8").replace("@maker@", maker).replace("@MAKER@", maker.upper())
    (folder / "harness.c").write_text(text, encoding="utf-8")
    command = [tool("cbmc", (OURS,)), str(folder / "harness.c"), f"-I{include}", "--function", claim]
    done = subprocess.run([*command, *UNDEFINED, "--unwind", str(rounds)], capture_output=True, text=True, timeout=400)
    # A function without a body may give anything: that is what the harness is for.
    failed = [line for line in done.stdout.splitlines() if line.endswith(": FAILURE") and ".no-body." not in line]
    assert failed or "0 of " in done.stdout, done.stdout[-2000:] + done.stderr[-2000:]
    return "\n".join(failed)


def planted(include: Path, header: str, sound: str, instead: str, folder: Path) -> Path:
    """A copy of the headers, one of them with a fault."""
    shutil.copytree(include, folder / "include")
    (path,) = (folder / "include").glob(f"*/{header}")
    text = path.read_text(encoding="ascii")
    assert text.count(sound) == 1, f"{sound} is gone: choose another place for this fault"
    path.write_text(text.replace(sound, instead), encoding="ascii")
    return folder / "include"
