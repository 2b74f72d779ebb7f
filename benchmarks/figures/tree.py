"""A checkout as files: modules, templates, their lines and characters; and an earlier commit as a folder of its own."""

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

#: The folders that people write in, and what they write there.
WRITTEN = ("generator", "templates", "tests", "benchmarks")
#: The longest line that the formatter leaves.
COLUMNS = 120


@dataclass(frozen=True)
class Source:
    """A file: its path from the checkout, and what stands in it."""

    path: str
    text: str

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text, self.path)

    @property
    def lines(self) -> int:
        return len(self.text.splitlines())

    def at(self, line: int) -> str:
        """A place in it, as an editor takes it."""
        return f"{self.path}:{line}"


@dataclass(frozen=True)
class Checkout:
    """The folder of a repository."""

    root: Path

    def files(self, folder: str, suffix: str) -> list[Source]:
        """The files of a folder that end in ``suffix``, in order of path; caches and hidden folders are passed over."""
        found = sorted((self.root / folder).rglob(f"*{suffix}"))
        names = [path.relative_to(self.root) for path in found if path.is_file()]
        return [
            Source(name.as_posix(), (self.root / name).read_text(encoding="utf-8"))
            for name in names
            if not any(part.startswith(".") or part == "__pycache__" for part in name.parts)
        ]

    @cached_property
    def modules(self) -> list[Source]:
        """The modules of the generator."""
        return self.files("generator", ".py")

    @cached_property
    def templates(self) -> list[Source]:
        return self.files("templates", ".jinja")

    def size(self) -> int:
        """The characters without blanks of the generator and its templates."""
        return sum(len("".join(item.text.split())) for item in (*self.modules, *self.templates))

    def flat_modules(self) -> list[str]:
        """The modules that lie in no room."""
        paths = [Path(item.path) for item in self.modules]
        return [path.stem for path in paths if len(path.parts) == 2 and not path.stem.startswith("__")]

    def lines_of_targets(self) -> Counter[str]:
        """The lines of each target, which has a folder or, earlier, modules with its name before an underscore."""
        lines: Counter[str] = Counter()
        for item in self.modules:
            parts = Path(item.path).parts
            if parts[1] == "targets":
                name = parts[2] if len(parts) > 3 else Path(parts[2]).stem.partition("_")[0]
                lines[name or "shared"] += item.lines
        return lines

    def lines_of_templates(self) -> Counter[str]:
        """The lines of the templates in each folder."""
        lines: Counter[str] = Counter()
        for item in self.templates:
            lines[Path(item.path).parts[1]] += item.lines
        return lines

    def wide_lines(self) -> Iterator[str]:
        """The lines of code and templates that have more than ``COLUMNS`` columns."""
        for folder in WRITTEN:
            for item in (*self.files(folder, ".py"), *self.files(folder, ".jinja")):
                for number, line in enumerate(item.text.splitlines(), 1):
                    if len(line) > COLUMNS:
                        yield item.at(number)


def unpack(repository: Path, commit: str, folder: Path) -> Checkout:
    """The files of a commit, put into ``folder``; the repository itself stays as it is.

    Raises:
        LookupError: The repository knows no such commit.
    """
    packed = subprocess.run(["git", "-C", str(repository), "archive", commit], capture_output=True, check=False)
    if packed.returncode:
        raise LookupError(packed.stderr.decode().strip())
    with tarfile.open(fileobj=BytesIO(packed.stdout)) as archive:
        archive.extractall(folder)
    return Checkout(folder)
