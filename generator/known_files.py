"""Results that depend only on the content of a file, kept for as long as the file has the same size and times.

Any change of a file changes its ``st_ctime_ns``, which no program can set. Windows has no such time, so nothing is kept
there. A file that has just changed could change again without that, within the resolution of these times, so its result
is not kept yet.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from typing import Any

from .cache import Cache

#: Age of a change from which a result is kept. The coarsest file systems have a resolution of two seconds.
_SETTLED_NS = 3 * 10**9


class KnownFiles:
    """Results by file. ``place`` says which files these are, because their paths can be relative."""

    def __init__(self, cache: Cache, kind: str, place: Sequence[str]) -> None:
        self._cache, self._kind, self._place = cache, kind, [_here(), *place]
        stored = cache.get(kind, self._place)
        self._before: dict[str, Any] = stored if isinstance(stored, dict) else {}
        self._now: dict[str, Any] = {}
        self._latest = time.time_ns() - _SETTLED_NS

    def result(self, path: str, work: Callable[[], Any]) -> Any:
        """Return the result of ``work``, which JSON can express, for the file at ``path``.

        Raises:
            OSError: The file cannot be found.
        """
        status = os.stat(path)
        stamp = [status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns]
        stored_result: Any = self._before.get(path)
        is_known = isinstance(stored_result, list) and len(stored_result) == 2 and stored_result[0] == stamp
        result = stored_result[1] if is_known else work()
        if max(status.st_mtime_ns, status.st_ctime_ns) < self._latest and os.name != "nt":
            self._now[path] = [stamp, result]
        return result

    def keep(self) -> None:
        """Store the results of all files that were asked for."""
        if self._now != self._before:
            self._cache.put(self._kind, self._place, self._now)


def _here() -> str:
    """Return the working folder. If it has been removed, only absolute paths lead anywhere."""
    try:
        return os.getcwd()
    except OSError:
        return ""
