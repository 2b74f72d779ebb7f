# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Opens output files that appear only when they are complete."""

from __future__ import annotations

import os
from collections.abc import Generator, Iterable
from contextlib import contextmanager, suppress
from typing import Any

from ..errors import UsageError


@contextmanager
def open_for_writing(target: str, sources: Iterable[str | os.PathLike[str]], force: bool) -> Generator[Any, None, None]:
    """Open a temporary file. The file is renamed to ``target`` when complete, and removed after an error.

    The context yields the file, or None for standard output (``-``).

    Raises:
        UsageError: ``target`` exists and must not be replaced, is a source, or is not a regular file.
    """
    if target == "-":
        yield None
        return
    real_path = os.path.realpath(target)
    if os.path.lexists(real_path):
        if not os.path.isfile(real_path):
            raise UsageError(f"{target} is not a regular file, so it cannot be replaced")
        if any(os.fspath(source) != "-" and os.path.samefile(real_path, source) for source in sources):
            raise UsageError(f"{target} is also the source; write to another file")
        if not force:
            raise UsageError(f"{target} already exists; replace it with --force, or force=True")
    folder, name = os.path.split(real_path)
    # The name is shortened, because file systems limit its length.
    temporary_path = os.path.join(folder, f".{name[:100]}.{os.getpid()}.part")
    try:
        file = open(temporary_path, "xb")  # noqa: SIM115 (closed below)
    except OSError as error:
        # The user knows the name of the target, not the name of the temporary file.
        error.filename = target
        raise
    try:
        with file:
            yield file
        os.replace(temporary_path, real_path)
    except BaseException:
        # Writing the rest of the buffer may fail on a full disk.
        with suppress(OSError):
            file.close()
        os.unlink(temporary_path)
        raise
