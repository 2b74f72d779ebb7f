"""Files of a checkout: modules, templates, and their lines and characters. An earlier commit gets its own folder."""

from __future__ import annotations

import ast
import subprocess
import tarfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from pathlib import Path

#: Folders with handwritten sources, and the extensions of their files.
WRITTEN = ("generator", "runtime", "templates", "tests", "benchmarks")
#: Longest line that the formatter allows.
COLUMNS = 120


@dataclass(frozen=True)
class Source:
    """A file, with its path in the checkout and its content."""

    path: str
    text: str

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text, self.path)

    @property
    def lines(self) -> int:
        return len(self.text.splitlines())

    def at(self, line: int) -> str:
        """Return a location in the file, in the form that editors expect."""
        return f"{self.path}:{line}"


@dataclass(frozen=True)
class Checkout:
    """Folder that holds a working copy of the repository."""

    root: Path

    def files(self, folder: str, suffix: str) -> list[Source]:
        """Return the files in a folder that end in ``suffix``, ordered by path, without caches and hidden folders."""
        found = sorted((self.root / folder).rglob(f"*{suffix}"))
        names = [path.relative_to(self.root) for path in found if path.is_file()]
        return [
            Source(name.as_posix(), (self.root / name).read_text(encoding="utf-8"))
            for name in names
            if not any(part.startswith(".") or part == "__pycache__" for part in name.parts)
        ]

    @cached_property
    def modules(self) -> list[Source]:
        """Return the modules of the generator."""
        return self.files("generator", ".py")

    @cached_property
    def templates(self) -> list[Source]:
        return self.files("templates", ".jinja")

    def size(self) -> int:
        """Return the number of characters in the generator and its templates, without whitespace."""
        return sum(len("".join(item.text.split())) for item in (*self.modules, *self.templates))

    def flat_modules(self) -> list[str]:
        """Return the modules that are not in a package."""
        paths = [Path(item.path) for item in self.modules]
        return [path.stem for path in paths if len(path.parts) == 2 and not path.stem.startswith("__")]

    def lines_of_targets(self) -> Counter[str]:
        """Count the lines of each target, which has a folder or, in earlier commits, modules named after it."""
        lines: Counter[str] = Counter()
        for item in self.modules:
            parts = Path(item.path).parts
            if parts[1] == "targets":
                name = parts[2] if len(parts) > 3 else Path(parts[2]).stem.partition("_")[0]
                lines[name or "shared"] += item.lines
        return lines

    def lines_of_templates(self) -> Counter[str]:
        """Count the lines of the templates in each folder."""
        lines: Counter[str] = Counter()
        for item in self.templates:
            lines[Path(item.path).parts[1]] += item.lines
        return lines

    def wide_lines(self) -> Iterator[str]:
        """Yield the lines of code and templates that have more than ``COLUMNS`` columns."""
        for folder in WRITTEN:
            for item in (*self.files(folder, ".py"), *self.files(folder, ".jinja")):
                for number, line in enumerate(item.text.splitlines(), 1):
                    if len(line) > COLUMNS:
                        yield item.at(number)


def unpack(repository: Path, commit: str, folder: Path) -> Checkout:
    """Copy the files of a commit into ``folder`` and leave the repository unchanged.

    Raises:
        LookupError: The repository has no such commit.
    """
    packed = subprocess.run(["git", "-C", str(repository), "archive", commit], capture_output=True, check=False)
    if packed.returncode:
        raise LookupError(packed.stderr.decode().strip())
    with tarfile.open(fileobj=BytesIO(packed.stdout)) as archive:
        archive.extractall(folder)
    return Checkout(folder)
