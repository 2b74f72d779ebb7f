"""Cached result of a command, which is used if no file that the command would read has changed.

Only results of runs without problems are stored, because messages depend on more than the content of the specs.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, TypedDict

from ..cache import Cache, content_of, key_of
from ..language.files import family_files, find_files, is_folder, packaged_masters, top_keys
from ..language.problems import ProblemReport

#: Keys that only overlays have. Overlays may refer to specs in other folders.
_OVERLAY_KEYS = frozenset(("overlay", "changes"))


class SpecsRead(TypedDict):
    """Names of families without problems, and the files that were read and skipped."""

    families: list[str]
    files: list[str]
    skipped: list[str]


@dataclass(frozen=True)
class CachedResult:
    """The result of a command for these specs and options.

    ``inputs`` is a hash of all files that the command reads. It is empty if no result can be stored.
    """

    cache: Cache
    command: str
    paths: Sequence[Path]
    options: Sequence[str]
    inputs: str

    def get(self) -> Any:
        """Return the cached result, or None if there is none."""
        return self.cache.get(self.command, [self.inputs]) if self.inputs else None

    def put(self, result: Any) -> None:
        """Store the result of a run without problems, unless a file has changed since the run began."""
        if self.inputs and _hash_of_inputs(self.paths, self.options) == self.inputs:
            self.cache.put(self.command, [self.inputs], result)


def cached_result(cache: Cache, command: str, paths: Sequence[Path], options: Sequence[str] = ()) -> CachedResult:
    """Return the place in the cache for the result of a command. ``get`` returns the result, if the cache has one.

    Args:
        cache: The cache.
        command: Name of the command.
        paths: The specs.
        options: All options on which the result depends.
    """
    inputs = _hash_of_inputs(paths, options) if cache else ""
    return CachedResult(cache=cache, command=command, paths=paths, options=options, inputs=inputs)


def specs_read(families: Sequence[str], report: ProblemReport) -> SpecsRead:
    """Return the result of reading specs without problems."""
    return SpecsRead(families=list(families), files=report.files, skipped=report.passed_over)


def report_of(specs: SpecsRead) -> ProblemReport:
    """Return the report of a run that read these specs."""
    report = ProblemReport()
    report.files += specs["files"]
    report.passed_over += specs["skipped"]
    return report


class _NotStorable(Exception):
    """The result depends on files that are not among the inputs."""


def _hash_of_inputs(paths: Sequence[Path], options: Sequence[str]) -> str:
    """Return a hash of the current folder, the options and all files that a run reads.

    The hash is "" if the files are not known, for example because one of the specs is an overlay.
    """
    try:
        # The empty text ends the options, so that none of them is mistaken for the name of a file.
        options_and_files = chain([os.getcwd(), *options, ""], _names_and_contents(paths))
        return key_of("inputs", options_and_files)
    except (OSError, ValueError, _NotStorable):
        return ""


def _names_and_contents(paths: Sequence[Path]) -> Iterator[bytes | str]:
    """Yield the names and the content of all files that a run with these paths reads, including packaged masters.

    Raises:
        OSError: A folder cannot be read.
        _NotStorable: A spec cannot be read, or is an overlay.
    """
    names_in_folder = functools.cache(os.listdir)
    for spec_or_folder in paths:
        specs: Sequence[Path] = (spec_or_folder,)
        skipped: Sequence[Path] = ()
        if is_folder(spec_or_folder):
            search_result = find_files(spec_or_folder)
            specs = search_result.specs
            skipped = search_result.passed_over
        # The words between the lists prevent equal hashes if a name moves from one list to the next.
        yield from (str(spec_or_folder), "specs", *map(str, specs), "skipped", *map(str, skipped), "content")
        for spec in specs:
            keys = top_keys(spec)
            if keys is None or not keys.isdisjoint(_OVERLAY_KEYS):
                raise _NotStorable
            yield from content_of(family_files(spec, names_in_folder))
    yield from content_of(sorted(packaged_masters().iterdir()))
