"""The parts of a report on changes that text and Markdown share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ..say.words import counted
from .change import Change
from .impact import OUTPUTS, TITLES, Impact
from .version import Package


@dataclass(frozen=True)
class Files:
    """Which generated files are not the same, of how many."""

    changed: tuple[str, ...]
    count: int


@dataclass(frozen=True)
class Found:
    """All that ``diff`` found; ``files`` is None where nothing could be generated."""

    changes: Sequence[Change]
    packages: Sequence[Package]
    files: Files | None = None
    notices: Sequence[str] = field(default=())

    @property
    def impact(self) -> Impact:
        return max((change.impact for change in self.changes), default=Impact.NONE)


def outputs(change: Change, code: str = "{}") -> str:
    """The outputs that a change reaches, those first that it reaches most; ``code`` is how a name is set."""
    texts = []
    for impact in sorted(set(change.rule.impacts), reverse=True):
        if impact is Impact.NONE or (impact is Impact.DOCUMENTATION and change.impact is not impact):
            continue
        called = [_output(change, name, code) for name in OUTPUTS if name in change.reached(impact)]
        # The pages follow every change; they are named where nothing else is.
        texts.append(", ".join(called) + ("" if impact is change.impact else f" ({impact.word})"))
    return "; ".join(texts)


def _output(change: Change, name: str, code: str) -> str:
    called = change.names.get(name, "")
    return f"{TITLES[name]} {code.format(called)}" if called else TITLES[name]


def about(change: Change, code: str = "{}") -> str:
    """Whom a change reaches: order codes, then outputs."""
    return "; ".join(filter(None, (change.reach, outputs(change, code))))


def totals(changes: Sequence[Change]) -> str:
    """``5 changes: 2 breaking, 3 behaviour``."""
    counts = [(sum(change.impact is impact for change in changes), impact.word) for impact in reversed(Impact)]
    return f"{counted(len(changes), 'change')}: {', '.join(f'{count} {word}' for count, word in counts if count)}"


def versions(package: Package) -> str:
    """The step of a version, and what has to be written where it is not stated yet."""
    if package.old == package.new == package.stated:
        return f"{package.name} stays {package.old}"
    step = f"{package.name} {package.old} → {package.new}"
    if package.is_enough:
        return step
    return f"{step}, where the spec still says {package.stated}"
