"""``codewheel check``: report all problems in specs and second readings, and facts that targets cannot express."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..language.problems import Report
from ..loading.library import Family, load_families
from ..readings.second_readings import Readings, compare_readings, sound_specs
from ..say.words import counted
from ..targets import Target
from .editions import check_all
from .look_up import read_line
from .outputs import tell_unfit


@dataclass(frozen=True)
class Checked:
    """Families and second readings that were checked, with their problems."""

    families: Sequence[Family]
    readings: Sequence[Readings]
    report: Report


def run(paths: Sequence[Path], targets: Iterable[Target]) -> Checked:
    """Check the specs at ``paths`` and the second readings next to them.

    Raises:
        Stop: A target fails. The exit code is 1.
    """
    families, report = load_families(paths)
    check_all(families, report)
    return look_at(families, targets, report)


def look_at(families: Sequence[Family], targets: Iterable[Target], report: Report) -> Checked:
    """Check families against the targets and against the second readings next to their specs.

    Raises:
        Stop: A target fails. The exit code is 1.
    """
    sound = sound_specs(families, report)
    tell_unfit(families, targets, report)
    return Checked(families, compare_readings(families, sound, report), report)


def as_data(found: Checked) -> dict[str, Any]:
    """Return the problems in the form that ``--json`` prints."""
    report = found.report
    problems = [problem.to_json() for problem in report.problems]
    return {"files": report.files, "passed_over": report.passed_over, "problems": problems}


def as_text(found: Checked, paths: Sequence[Path]) -> str:
    """Return the problems as text, with the files read and a summary."""
    devices = [family.device for family in found.families]
    lines = [problem.format() for problem in found.report.problems]
    lines.append(read_line(paths, devices, found.report))
    if found.report:
        lines.append(counted(len(found.report), "problem"))
    elif devices:
        names = ", ".join(device.name for device in devices)
        lines.append(f"no problems in {len(devices)} {'family' if len(devices) == 1 else 'families'}: {names}")
    else:  # Some files define no family, such as those of masters.
        lines.append("no problems")
    return "\n".join(lines)
