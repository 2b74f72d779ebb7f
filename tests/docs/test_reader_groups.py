"""The pages of docs/ are grouped by reader: the same groups are folders and parts of the site's contents."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
#: Folders of docs/ with the captions of their groups on the site.
GROUPS = {
    "encoder": "With an encoder",
    "firmware": "Firmware",
    "master": "BiSS or SSI master, PLC",
    "bench": "Bench",
    "transcribe": "Transcribe a manual",
    "extend": "Extend codewheel",
    "trust": "Trust",
}
#: Folders that hold examples or the site.
OTHERS = {"example", "example-overlay", "site"}
_CONTENTS = re.compile(r"^```\{toctree\}\n:hidden:\n:caption: ([^\n]*)\n\n(.*?)^```", re.MULTILINE | re.DOTALL)
_MOST_ENTRIES = 8
#: Most words of all pages that are written by hand. References are not counted, and blocks of code neither.
_MOST_WORDS = 28_000
_REFERENCES = re.compile(r"rules|spec-language|mutants|words")
_NOT_WORDS = re.compile(r"^(`{3,}|~{3,}).*?^\1`*\s*$|\A---\n.*?^---$|<!--.*?-->", re.MULTILINE | re.DOTALL)


def entries_by_caption() -> dict[str, list[str]]:
    """Return the entries of each group in the contents of the site."""
    contents = _CONTENTS.findall((DOCS / "site" / "index.md").read_text(encoding="utf-8"))
    return {caption: re.findall(r"^(?:.* <)?([\w/-]+)>?$", lines, re.MULTILINE) for caption, lines in contents}


def test_the_folders_are_the_groups_in_their_order() -> None:
    assert list(entries_by_caption()) == list(GROUPS.values())
    assert {path.name for path in DOCS.iterdir() if path.is_dir() and path.name != "__pycache__"} == {*GROUPS, *OTHERS}
    assert sorted(DOCS.glob("*.md")) == []


def test_a_group_has_at_most_eight_entries() -> None:
    assert {caption for caption, entries in entries_by_caption().items() if len(entries) > _MOST_ENTRIES} == set()


def test_each_page_is_listed_in_the_group_of_its_folder() -> None:
    """The questions are one entry. The site places each question below it, and so the parts of a reference."""
    for folder, caption in GROUPS.items():
        pages = {f"docs/{folder}/{page.stem}" for page in (DOCS / folder).glob("[!_]*.md")}
        pages -= {page for page in pages if any(page.startswith(f"{other}-") for other in pages)}
        listed = {entry for entry in entries_by_caption()[caption] if entry.startswith("docs/")}
        assert listed == pages, folder


def test_what_is_written_by_hand_stays_short() -> None:
    pages = [page for page in DOCS.rglob("*.md") if not _REFERENCES.match(page.stem)]
    texts = [_NOT_WORDS.sub("", page.read_text(encoding="utf-8")) for page in pages]
    word_count = sum(bool(re.search(r"\w", word)) for text in texts for word in text.split())
    assert 10_000 < word_count <= _MOST_WORDS
