"""Lock on an output folder, so that only one process at a time writes to it.

The system releases the lock when the process ends for any reason. The lock is on the folder itself, so no file is left
behind. If the file system cannot lock folders, as on some network drives, there is no lock.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

#: A run writes for a few seconds. One that takes longer has been suspended or has a very slow disk.
PATIENCE_S = 60.0
_PAUSE_S = 0.1


class Busy(Exception):
    """Another process held the lock for the whole wait."""


if sys.platform == "win32":
    import hashlib
    import msvcrt
    import tempfile

    def _open(folder: Path) -> int:
        """Open a file in the user's temporary folder that stands for ``folder``, since Windows cannot lock folders."""
        name = hashlib.sha256(os.path.normcase(os.path.realpath(folder)).encode()).hexdigest()[:16]
        return os.open(os.path.join(tempfile.gettempdir(), f"codewheel-{name}.lock"), os.O_RDWR | os.O_CREAT)

    def _take(handle: int, folder: Path) -> bool:
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except PermissionError:
            return False
        return True

else:
    import fcntl

    def _open(folder: Path) -> int:
        return os.open(folder, os.O_RDONLY)

    def _take(handle: int, folder: Path) -> bool:
        """Lock the open folder. Return False if another process holds the lock, or if ``folder`` has been replaced."""
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        except OSError:
            return True  # this file system cannot lock folders
        try:
            return os.path.samestat(os.fstat(handle), os.stat(folder))
        except FileNotFoundError:
            return False


@contextmanager
def locked(folder: Path, waiting: Callable[[], None]) -> Iterator[None]:
    """Hold the lock on a folder, and create the folder if it does not exist.

    Args:
        folder: The folder. Links to the folder share its lock.
        waiting: Called once if another process has the lock.

    Raises:
        Busy: Another process has held the lock for ``PATIENCE_S``.
        OSError: The folder cannot be created or opened.
    """
    end = time.monotonic() + PATIENCE_S
    handle = _attempt(folder)
    if handle is None:
        waiting()
    while handle is None:
        if time.monotonic() > end:
            raise Busy
        time.sleep(_PAUSE_S)
        handle = _attempt(folder)
    try:
        yield
    finally:
        os.close(handle)


def _attempt(folder: Path) -> int | None:
    """Return the descriptor of the lock, or None if another process has it."""
    folder.mkdir(parents=True, exist_ok=True)
    handle = _open(folder)
    if _take(handle, folder):
        return handle
    os.close(handle)
    return None
