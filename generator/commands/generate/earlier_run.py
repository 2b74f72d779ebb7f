"""The result of a run of ``generate``, which a later run with the same input repeats.

This module imports little, because a run that changes nothing needs no other.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import TypedDict

from ...say import count_with_unit
from ...write import digest_of, digest_on_disk
from ..terminal import CommandError

#: The files of each target, as texts by path.
Files = Mapping[str, Mapping[str, str]]
#: The families of each target, as ``owners`` returns them.
Families = Mapping[str, Sequence[str]]


class Generated(TypedDict):
    """Result of a run: the line about the specs, the targets, and the number and digest of their files."""

    read_line: str
    targets: list[str]
    count: int
    digest: str


def is_unchanged(arguments: argparse.Namespace, generated: Generated | None) -> bool:
    """Return True if the files on the disk come from an earlier run, and repeat its output.

    ``generated`` is the result of that run, or None if there is none with the same input.
    """
    if generated is None or digest_on_disk(arguments.output, generated["targets"]) != generated["digest"]:
        return False
    print(generated["read_line"])
    print_summary(arguments, generated["count"], changed=0)
    return True


def result_to_store(read_line: str, files: Files, families: Families) -> Generated:
    """Return the result of a run that rendered these files."""
    count = sum(map(len, files.values()))
    return Generated(read_line=read_line, targets=list(files), count=count, digest=digest_of(files, families))


def print_summary(arguments: argparse.Namespace, count: int, changed: int) -> None:
    """Print the number of files. With ``--check``, raise ``CommandError`` with code 1 if ``changed`` of them differ."""
    if arguments.check and changed:
        raise CommandError(f"{count_with_unit(changed, 'file')} out of date; run: {arguments.again}", 1)
    if arguments.check:
        print(f"{count_with_unit(count, 'file')} up to date")
    elif changed:
        print(f"{count_with_unit(changed, 'file')} changed, {count - changed} unchanged")
    else:
        print(f"all {count} files unchanged")
