"""Pages of every encoder. The repository tracks those of the highest grades only."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from codewheel.loading.library import load_library
from codewheel.targets import Library
from codewheel.targets.docs.files import generate

#: Pages that list all encoders.
LISTS = ("README.md", "docs/encoders.md")
_SPEC_LINK = re.compile(r"\]\(((?:\.\./)?)specs/\w+/(\w+)\.yaml\)(?: \(pages on the site only\))?")


def encoder_pages(root: Path) -> Iterator[tuple[str, str]]:
    """Yield the path and text of each page and picture for the specs in ``root``, if there are any.

    Raises:
        ValueError: There are problems in the specs.
    """
    if not (root / "specs").is_dir():
        return
    devices, report = load_library([root / "specs"])
    if report.problems:
        raise ValueError(report.problems[0].format())
    for path, text in generate(Library(devices)).items():
        yield f"generated/{path}", text


def with_page_links(text: str) -> str:
    """Return a list of encoders with links to pages in place of those to specs, whose pages are not tracked."""
    return _SPEC_LINK.sub(r"](\1generated/docs/\2.md)", text)
