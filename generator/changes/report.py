"""Reports on changes: as data, and the parts that are common to text and Markdown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from ..say.words import counted
from .change import Change
from .impact import OUTPUTS, TITLES, Impact
from .version import Package

#: Version of the data, in the shape of ``language/diff.schema.json``.
VERSION = 2


@dataclass(frozen=True)
class Files:
    """The generated files that differ, and the number of all."""

    changed: tuple[str, ...]
    count: int


@dataclass(frozen=True)
class DiffResult:
    """Everything that ``diff`` found. ``files`` is None if nothing could be generated."""

    changes: Sequence[Change]
    packages: Sequence[Package]
    files: Files | None = None
    notices: Sequence[str] = field(default=())

    @property
    def impact(self) -> Impact:
        return max((change.impact for change in self.changes), default=Impact.NONE)


def outputs(change: Change, code: str = "{}") -> str:
    """Return the outputs that a change affects, most affected first. ``code`` is the format of a name."""
    texts, impacts = [], dict(zip(OUTPUTS, change.rule.impacts, strict=True))
    for impact in sorted(set(impacts.values()), reverse=True):
        if impact is Impact.NONE or (impact is Impact.DOCUMENTATION and change.impact is not impact):
            continue
        names = [_output(change, name, code) for name, output_impact in impacts.items() if output_impact is impact]
        # Every change affects the pages. They are named only if no other output is.
        texts.append(", ".join(names) + ("" if impact is change.impact else f" ({impact.word})"))
    return "; ".join(texts)


def _output(change: Change, name: str, code: str) -> str:
    code_name = change.names.get(name, "")
    return f"{TITLES[name]} {code.format(code_name)}" if code_name else TITLES[name]


def about(change: Change, code: str = "{}") -> str:
    """Return the order codes and the outputs that a change affects."""
    return "; ".join(filter(None, (change.reach, outputs(change, code))))


def totals(changes: Sequence[Change]) -> str:
    """Return a summary such as ``5 changes: 2 breaking, 3 behaviour``."""
    counts = _counts(changes)
    texts = [f"{counts[impact]} {impact.word}" for impact in reversed(Impact) if counts[impact]]
    return f"{counted(len(changes), 'change')}: {', '.join(texts)}"


def _counts(changes: Sequence[Change]) -> Counter[Impact]:
    """Return the number of changes with each impact."""
    return Counter(change.impact for change in changes)


def versions(package: Package) -> str:
    """Return the old and the new version, and the stated version if it must be updated."""
    if package.old == package.new == package.stated:
        return f"{package.name} stays {package.old}"
    step = f"{package.name} {package.old} → {package.new}"
    if package.is_enough:
        return step
    return f"{step}, but the spec still says {package.stated}"


def as_data(findings: DiffResult) -> dict[str, Any]:
    """Return the output of ``codewheel diff --json``."""
    counts, files = _counts(findings.changes), findings.files
    return {
        "version": VERSION,
        "impact": findings.impact.word,
        "counts": {impact.word: counts[impact] for impact in Impact if impact},
        "changes": list(map(_change_data, findings.changes)),
        "generated": {"files": files.count, "changed": list(files.changed)} if files else None,
        "packages": list(map(_package_data, findings.packages)),
        "notices": list(findings.notices),
    }


def _package_data(package: Package) -> dict[str, str]:
    return {
        "name": package.name,
        "old": package.old,
        "stated": package.stated,
        "due": package.due,
        "new": package.new,
    }


def _change_data(change: Change) -> dict[str, Any]:
    return {
        "family": change.family,
        "rule": change.rule.name,
        "impact": change.impact.word,
        "outputs": {name: impact.word for name, impact in zip(OUTPUTS, change.rule.impacts, strict=True)},
        "path": change.path,
        "text": change.text,
        "old": change.old,
        "new": change.new,
        "order_codes": list(change.codes),
        "reach": change.reach,
        "names": dict(change.names),
    }
