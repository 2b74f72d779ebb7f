"""Results of earlier runs on the same specs, for commands whose specs have not changed since.

Only runs without problems are kept, because messages depend on more than the content of the specs. A result is used
only if all files that the run would read have the same names and content.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..cache import Cache, content_of
from ..language.files import Found, below, is_folder, top_keys
from ..language.problems import Report
from ..loading.family_files import family_files
from ..loading.shipped import packaged_families, packaged_masters

#: Keys of overlays, which may refer to specs in other folders.
_OVERLAY_KEYS = frozenset(("overlay", "changes"))


@dataclass(frozen=True)
class Earlier:
    """Earlier results of a command. ``content`` is all that they depend on. If it is empty, there are none."""

    cache: Cache
    kind: str
    paths: Sequence[Path]
    options: Sequence[str]
    content: Sequence[bytes | str] = ()
    #: Files that the run skips.
    passed_over: Sequence[str] = ()

    def get(self) -> Any:
        """Return the result of the earlier run, or None."""
        return self.cache.get(self.kind, self.content) if self.content else None

    def put(self, result: Any) -> None:
        """Keep the result of a run without problems, unless a file has changed since its content was read."""
        if self.content and _content(self.paths, self.options) == (self.content, self.passed_over):
            self.cache.put(self.kind, self.content, result)

    def of_models(self, digests: Sequence[str]) -> Models:
        """Return the results for the same models and options, regardless of the rest of the specs."""
        content = [*self.options, "", *digests, *_masters()] if self.content and all(digests) else []
        return Models(self.cache, f"{self.kind} of models", content)

    def report(self, files: Iterable[str]) -> Report:
        """Return the report of a run without problems that read these files."""
        found = Report()
        found.files += files
        found.passed_over += self.passed_over
        return found


@dataclass(frozen=True)
class Models:
    """Earlier results that depend only on models. If ``content`` is empty, there are none."""

    cache: Cache
    kind: str
    content: Sequence[bytes | str]

    def get(self) -> Any:
        """Return the result for the same models, or None."""
        return self.cache.get(self.kind, self.content) if self.content else None

    def put(self, result: Any) -> None:
        """Store the result for these models."""
        if self.content:
            self.cache.put(self.kind, self.content, result)


def earlier(cache: Cache, kind: str, paths: Sequence[Path], options: Sequence[str] = ()) -> Earlier:
    """Return the results of earlier runs.

    Args:
        cache: The cache.
        kind: The kind of result, which is the name of the command.
        paths: The specs. Default: those that ship with the tool.
        options: All options on which the result depends.
    """
    return Earlier(cache, kind, paths, options, *_content(paths, options))


def _content(paths: Sequence[Path], options: Sequence[str]) -> tuple[list[bytes | str], list[str]]:
    """Return all that a result depends on, and the skipped files. The first is empty if there can be no result."""
    content: list[bytes | str] = [*options, ""]
    passed_over: list[str] = []
    try:
        for given in paths or packaged_families():
            found = below(given) if is_folder(given) else Found((given,), ())
            passed_over += map(str, found.passed_over)
            content += [str(given), *map(str, found.specs), "", *map(str, found.passed_over), ""]
            for spec in found.specs:
                keys = top_keys(spec)
                if keys is None or not keys.isdisjoint(_OVERLAY_KEYS):
                    return [], []
                content += content_of(family_files(spec))
        return content + _masters(), passed_over
    except (OSError, ValueError):
        return [], []


def _masters() -> list[bytes | str]:
    return content_of(sorted(packaged_masters().iterdir()))
