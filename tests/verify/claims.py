"""Claims in a C file of functions without arguments, each proved or refuted by CBMC with the headers."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterable
from pathlib import Path

from proof import UNDEFINED, Checker, Proof
from tools import tool

OURS = str(Path(__file__).resolve().parents[2] / ".cbmc")


def claims_of(harness: Path) -> list[str]:
    """Return the functions of the file that are claims: those that are not static."""
    return re.findall(r"^void (\w+)\(void\)(?=$| \{)", harness.read_text(encoding="utf-8"), re.MULTILINE)


def verdict(
    harness: Path, claim: str, include: Path, folder: Path, rounds: int, more: Iterable[str] = ()
) -> tuple[bool, str]:
    """Return True if the claim is proved, and a text: REFUTED, or that there was no result.

    ``rounds`` bounds each loop, and ``more`` are further checks.
    """
    text = harness.read_text(encoding="utf-8")
    checker = Checker(tool("cbmc", (OURS,)), tool("cryptominisat5"))
    proof = Proof(claim, harness=text, function=claim, unwind=rounds, options=(*UNDEFINED, *more))
    result = checker.prove(proof, include, folder)
    return result.proved, result.words


def planted(include: Path, header: str, sound: str, instead: str, folder: Path) -> Path:
    """Return a copy of the headers with an error in one header of the runtime."""
    shutil.copytree(include, folder / "include")
    path = folder / "include" / "codewheel" / header
    text = path.read_text(encoding="ascii")
    assert text.count(sound) == 1, f"{sound} is gone: choose another place for this fault"
    path.write_text(text.replace(sound, instead), encoding="ascii")
    return folder / "include"
