"""Places of changes in the new specs, for review tools."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..changes.change import Change
from ..changes.impact import Impact
from ..changes.report import about
from ..language.document import Document, Path, label_of
from ..language.schema import value_at
from ..loading.library import Family
from .formats import Finding

_LEVELS = {Impact.BREAKING: "error", Impact.BEHAVIOUR: "warning"}
_STEPS = re.compile(r"[^.\[\]]+")


def findings(changes: Sequence[Change], families: Sequence[Family], names: Mapping[str, str]) -> list[Finding]:
    """Return the changes with their places. A removed item is at the nearest place that is left.

    ``names`` has the original names of files from a git revision.
    """
    documents = {family.device.name: family.document for family in families}
    placed_findings = []
    for change in changes:
        document = documents.get(change.family) or next(iter(documents.values()), None)
        if document is not None:
            path = _path(document, change.path) if change.family in documents else ()
            line, column = document.position(path)
            message = f"{change.text} ({change.impact.word}: {about(change)})"
            level = _LEVELS.get(change.impact, "notice")
            file = document.file_of(path) or document.file
            placed_findings.append(Finding(names.get(file, file), line, column, change.rule.name, message, level))
    return placed_findings


def _path(document: Document, text: str) -> Path:
    """Return the place of a path of keys and names, as far as it exists."""
    path: Path = ()
    for step in _STEPS.findall(text):
        next_path = next(_ways(value_at(document.data, path), step), None)
        if next_path is None:
            break
        path = (*path, *next_path)
    return path


def _ways(node: Any, step: str) -> Iterator[Path]:
    """Yield the ways to a key or name in a map or list, or in a list or map inside it."""
    if isinstance(node, dict):
        if step in node:
            yield (step,)
        for key, inner in node.items():
            yield from ((key, *inner_path) for inner_path in _direct(inner, step))
    yield from _direct(node, step) if isinstance(node, list) else ()


def _direct(node: Any, step: str) -> Iterator[Path]:
    if isinstance(node, list):
        yield from ((index,) for index, child in enumerate(node) if label_of(child) == step)
    elif isinstance(node, dict) and step in node:
        yield (step,)
