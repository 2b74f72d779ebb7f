"""``codewheel check``: every problem of the specs, of their second readings, and of what targets cannot express."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..language.problems import Report
from ..loading.library import Family, load_families
from ..readings.second import Readings, compare_readings, sound_specs
from ..say.words import counted
from ..targets import Target
from .editions import check_all
from .look_up import read_line
from .outputs import tell_unfit


@dataclass(frozen=True)
class Checked:
    """What was checked, and what is wrong with it."""

    families: Sequence[Family]
    readings: Sequence[Readings]
    report: Report


def run(paths: Sequence[Path], targets: Iterable[Target]) -> Checked:
    """Check the specs at ``paths`` and the second readings beside them.

    Raises:
        Stop: A target fails; exit code 1.
    """
    families, report = load_families(paths)
    check_all(families, report)
    return look_at(families, targets, report)


def look_at(families: Sequence[Family], targets: Iterable[Target], report: Report) -> Checked:
    """Check families beyond what each spec says: by the targets, and by the second readings beside the specs.

    Raises:
        Stop: A target fails; exit code 1.
    """
    sound = sound_specs(families, report)
    tell_unfit(families, targets, report)
    return Checked(families, compare_readings(families, sound, report), report)


def as_data(found: Checked) -> dict[str, Any]:
    """The problems as ``--json`` prints them."""
    report = found.report
    problems = [problem.to_json() for problem in report.problems]
    return {"files": report.files, "passed_over": report.passed_over, "problems": problems}


def as_text(found: Checked, paths: Sequence[Path]) -> str:
    """The problems for a person, what was read, and how it stands."""
    devices = [family.device for family in found.families]
    lines = [problem.format() for problem in found.report.problems]
    lines.append(read_line(paths, devices, found.report))
    if found.report:
        lines.append(counted(len(found.report), "problem"))
    elif devices:
        names = ", ".join(device.name for device in devices)
        lines.append(f"no problems in {len(devices)} {'family' if len(devices) == 1 else 'families'}: {names}")
    else:  # A file may be checked that makes no family by itself, such as a master.
        lines.append("no problems")
    return "\n".join(lines)
