"""A spec before and after a change: the base of this folder with texts replaced in one of the two."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypedDict

from codewheel.changes.families import compare
from codewheel.changes.report import DiffResult, as_text
from codewheel.loading.library import load_library
from codewheel.model import Device

BASE = Path(__file__).parent / "base"
Edits = Sequence[Sequence[str]]


class Case(TypedDict):
    """A pair: ``before`` applies to both sides, ``edits`` to the new side, or to the old side if ``backwards``."""

    rule: str
    before: Edits
    edits: Edits
    backwards: bool
    shown: str


def devices(edits: Edits) -> tuple[Device, ...]:
    """Return the families of the base with these texts replaced, each of which is in its files once."""
    return _devices(tuple((old, new) for old, new in edits))


@cache
def _devices(edits: tuple[tuple[str, str], ...]) -> tuple[Device, ...]:
    text_by_file = {path.name: path.read_text(encoding="utf-8") for path in BASE.glob("*.yaml")}
    for old, new in edits:
        files_with_text = [name for name, text in text_by_file.items() if text.count(old) == 1]
        assert len(files_with_text) == 1, (old, [text.count(old) for text in text_by_file.values()])
        text_by_file[files_with_text[0]] = text_by_file[files_with_text[0]].replace(old, new)
    device_line = next(line for line in text_by_file["demo.yaml"].splitlines() if line.startswith("device: "))
    text_by_file[f"{device_line.removeprefix('device: ')}.yaml"] = text_by_file.pop("demo.yaml")
    with TemporaryDirectory() as folder:
        for name, text in text_by_file.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        loaded, report = load_library([Path(folder)])
    assert not report.problems, "\n".join(problem.format() for problem in report.problems)
    return loaded


def sides(case: Case) -> tuple[tuple[Device, ...], tuple[Device, ...]]:
    """The families before and after."""
    plain = devices(case["before"])
    edited = devices([*case["before"], *case["edits"]])
    return (edited, plain) if case["backwards"] else (plain, edited)


def comparison(old: Sequence[Device], new: Sequence[Device]) -> DiffResult:
    return DiffResult(compare(old, new), ())


def diff_text(old: Sequence[Device], new: Sequence[Device]) -> str:
    """Return the output of diff for the two, without the line about generated files."""
    return as_text(comparison(old, new))
