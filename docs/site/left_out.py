"""Leave out pages that are of no use to a visitor: changes before the first release, and folders of the repository."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

#: Words of a page of changes without any.
_NO_CHANGES = "No release is recorded yet."
_LINK_TO_CHANGES = re.compile(r",? \[changes[^\]]*\]\([^)\s]*-changes\.md\)")
_LINK = re.compile(r"\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s#:]+)\)")
#: Folders whose files visitors want, such as settings to load. Their files are linked one by one.
_WANTED = Path("generated")
_MOST = 8


def leave_out(root: Path, source: Path) -> None:
    """Delete pages of changes without changes from ``source``, and replace the links to folders that have no page."""
    for page in source.glob("generated/docs/*-changes.md"):
        if _NO_CHANGES in page.read_text(encoding="utf-8"):
            page.unlink()
            for family_page in _pages_of(source, page.stem.removesuffix("-changes")):
                _rewrite(family_page, partial(_LINK_TO_CHANGES.sub, ""))
    for page in source.rglob("*.md"):
        _rewrite(page, partial(_without_folders, root, source, page.parent.relative_to(source)))


def _pages_of(source: Path, family: str) -> list[Path]:
    return [*source.glob(f"generated/docs/{family}.md"), *source.glob(f"generated/docs/{family}/*.md")]


def _rewrite(page: Path, change: Callable[[str], str]) -> None:
    text = page.read_text(encoding="utf-8")
    changed = change(text)
    if changed != text:
        page.write_text(changed, encoding="utf-8")


def _without_folders(root: Path, source: Path, page_folder: Path, text: str) -> str:
    """Return the text of a page with the names of folders in place of links to them, and links to wanted files."""

    def replaced(match: re.Match[str]) -> str:
        folder = Path(os.path.normpath(page_folder / match[2]))
        has_page = any((source / folder / name).exists() for name in ("README.md", "index.md"))
        if has_page or not (root / folder).is_dir():
            return match[0]
        files = sorted(path.name for path in (root / folder).iterdir() if path.is_file())
        if _WANTED not in folder.parents or len(files) > _MOST:
            return match[1]
        links = ", ".join(f"[`{name}`]({match[2].rstrip('/')}/{name})" for name in files)
        return f"{match[1]}: {links}"

    return _LINK.sub(replaced, text)
