"""Results of earlier runs on the same specs, for commands whose specs have not changed since.

Only runs without problems are kept, because messages depend on more than the content of the specs. A result is used
only if all files that the run would read have the same names and content.
"""

from __future__ import annotations

import functools
import hashlib
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypedDict

from ..cache import Cache, content_of
from ..known_files import KnownFiles
from ..language.files import FoundFiles, find_files, is_folder, is_spec, top_keys
from ..language.problems import Report
from ..loading.family_files import family_files
from ..loading.shipped import packaged_masters
from ..typed import fits

#: Keys of overlays, which may refer to specs in other folders.
_OVERLAY_KEYS = frozenset(("overlay", "changes"))


class SpecsRead(TypedDict):
    """Families without problems, and the files that describe them."""

    families: list[str]
    files: list[str]


class Hashes(TypedDict):
    """Hashes of generated files, by target and path, and the families that they were written from."""

    hashes: dict[str, dict[str, str]]
    owners: list[str]


class Generated(SpecsRead, Hashes):
    """Result of ``generate``."""


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

    def get(self, form: Any) -> Any:
        """Return the result of the earlier run, or None if there is none of this type."""
        return _of_form(self.cache.get(self.kind, self.content), form) if self.content else None

    def put(self, result: Any) -> None:
        """Keep the result of a run without problems, unless a file has changed since its content was read."""
        if self.content and _content(self.cache, self.paths, self.options) == (self.content, self.passed_over):
            self.cache.put(self.kind, self.content, result)

    def of_models(self, digests: Sequence[str]) -> Models:
        """Return the results for the same models and options, regardless of the rest of the specs."""
        content = [*self.options, "", *digests, *_masters()] if self.content and all(digests) else []
        return Models(self.cache, f"{self.kind} of models", content)

    def report(self, files: Iterable[str]) -> Report:
        """Return the report of a run without problems that read these files."""
        earlier_report = Report()
        earlier_report.files += files
        earlier_report.passed_over += self.passed_over
        return earlier_report


@dataclass(frozen=True)
class Models:
    """Earlier results that depend only on models. If ``content`` is empty, there are none."""

    cache: Cache
    kind: str
    content: Sequence[bytes | str]

    def get(self, form: Any) -> Any:
        """Return the result for the same models, or None if there is none of this type."""
        return _of_form(self.cache.get(self.kind, self.content), form) if self.content else None

    def put(self, result: Any) -> None:
        """Store the result for these models."""
        if self.content:
            self.cache.put(self.kind, self.content, result)


def _of_form(result: Any, form: Any) -> Any:
    return result if fits(result, form) else None


def earlier(cache: Cache, kind: str, paths: Sequence[Path], options: Sequence[str] = ()) -> Earlier:
    """Return the results of earlier runs.

    Args:
        cache: The cache.
        kind: The kind of result, which is the name of the command.
        paths: The specs.
        options: All options on which the result depends.
    """
    return Earlier(cache, kind, paths, options, *_content(cache, paths, options))


def _content(cache: Cache, paths: Sequence[Path], options: Sequence[str]) -> tuple[list[bytes | str], list[str]]:
    """Return all that a result depends on, and the skipped files. The first is empty if there can be no result."""
    content: list[bytes | str] = [*options, ""]
    passed_over: list[str] = []
    known_files = KnownFiles(cache, "hashes", list(map(str, paths)))

    def look(path: Path) -> Mapping[str, Any]:
        file_facts: Mapping[str, Any] = known_files.result(str(path), lambda: _look(path))
        return file_facts

    def is_known(path: Path) -> bool:
        return look(path)["is_spec"] is not False

    names_in = functools.cache(os.listdir)
    try:
        for spec_path in paths:
            search_result = find_files(spec_path, is_known) if is_folder(spec_path) else FoundFiles((spec_path,), ())
            passed_over += map(str, search_result.passed_over)
            content += [str(spec_path), *map(str, search_result.specs), "", *map(str, search_result.passed_over), ""]
            for spec in search_result.specs:
                if look(spec)["is_overlay"] is not False:
                    return [], []
                for path in family_files(spec, names_in):
                    content += [path.name, str(look(path)["hash"]) if path.is_file() else "missing"]
        known_files.keep()
        return content + _masters(), passed_over
    except (OSError, ValueError, TypeError, LookupError):
        return [], []


def _look(path: Path) -> dict[str, Any]:
    """Return the hash of a file, and whether it is a spec or an overlay, which can refer to specs in other folders.

    Raises:
        OSError: The file cannot be read.
    """
    keys = top_keys(path)
    if keys is None:
        raise OSError
    return {
        "hash": hashlib.sha256(path.read_bytes()).hexdigest(),
        "is_spec": is_spec(path),
        "is_overlay": not keys.isdisjoint(_OVERLAY_KEYS),
    }


def _masters() -> list[bytes | str]:
    return content_of(sorted(packaged_masters().iterdir()))
