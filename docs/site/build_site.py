"""Build a static site from the pages of this repository, for ``make site``.

    python docs/site/build_site.py [build/site]

Pages keep the paths that they have in the repository, so links in Markdown work as on a code host. Linked files that
are not pages are copied next to them. Folders without a README have no page.
"""

from __future__ import annotations

import gc
import logging
import os
import posixpath
import re
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from api_pages import api_pages
from encoder_pages import LISTS, encoder_pages, with_page_links
from front_cards import cards
from left_out import leave_out
from question_pages import PAGES as QUESTION_PAGES
from question_pages import with_example_box
from settings_data import script as settings_script
from sphinx.application import Sphinx
from sphinx.util.console import nocolor

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
#: Files that become pages.
PAGES = (
    "*.md",
    "docs/*/*.md",
    "docs/example/**/*.md",
    "generated/docs/**/*.md",
    "generated/*/*.md",
    "generated/python/*/*.md",
    "examples/*/README.md",
    "specs/README.md",
)
#: The script of the decode box, if it has been generated.
DECODER = Path("generated/browser/decode.js")
DECODER_PAGE = "decode"
#: The page with the settings of masters, and the script with its data.
SETTINGS_PAGE = "settings"
SETTINGS_DATA = "settings-data.js"
#: An entry of the contents: a page, or a title and the page.
NAMED = re.compile(r"^(?:[^<>`\n]* <)?([\w/-]+)>?$", re.MULTILINE)
#: Line of the start page that is replaced by a card for each family.
CARDS = "(cards)\n"
_OWN_LINK = re.compile(r"""(\]\(|\bhref=")([^)"\s#:]+)""")
_LINK = re.compile(r"""(?:\]\(|\bsrc(?:set)?=")([^)"\s#]+)""")


def build(target: Path, root: Path = ROOT) -> int:
    """Write the site into ``target``, which is emptied first, and return the number of warnings."""
    work = target.parent / f"{target.name}-work"
    for folder in (target, work):
        shutil.rmtree(folder, ignore_errors=True)
    source = work / "source"
    stage(root, source)
    # The run creates millions of small objects that all stay. Collecting garbage among them takes a third of the time.
    gc.disable()
    logging.getLogger("sphinx").setLevel(logging.WARNING)
    nocolor()
    os.environ["SOURCE_DATE_EPOCH"] = "0"
    application = Sphinx(str(source), str(HERE), str(target), str(work / "doctrees"), "html", status=None)
    # search.js replaces the search of Sphinx, which does not know order codes and synonyms.
    application.builder.search = False
    application.build(force_all=True)
    copy_linked(root, source, target)
    if (source / f"{SETTINGS_PAGE}.md").exists():
        _write(target / SETTINGS_DATA, settings_script(root))
    for leftover in (".buildinfo", "objects.inv"):
        (target / leftover).unlink(missing_ok=True)
    shutil.rmtree(work)
    return application._warncount


def stage(root: Path, source: Path) -> None:
    """Copy the pages and their pictures, and write the pages that exist only on the site."""
    pages_and_pictures = {path for pattern in PAGES for path in root.glob(pattern) if path.parent != HERE}
    pages_and_pictures |= set(root.glob("generated/docs/**/*.svg")) | set(root.glob("docs/**/*.svg"))
    for path in sorted(pages_and_pictures):
        _write(source / path.relative_to(root), path.read_text(encoding="utf-8"))
    for name, text in encoder_pages(root):
        _write(source / name, text)
    for path in (source / name for name in LISTS):
        if path.exists():
            _write(path, with_page_links(path.read_text(encoding="utf-8")))
    for path in source.glob(QUESTION_PAGES) if (root / DECODER).exists() else ():
        _write(path, with_example_box(path.read_text(encoding="utf-8")))
    if (root / DECODER).exists():
        name = f"{DECODER_PAGE}.md"
        _write(source / name, _own_page(name))
    if (root / "specs").is_dir():
        name = f"{SETTINGS_PAGE}.md"
        _write(source / name, _own_page(name))
    for name, text in api_pages(root):
        _write(source / name, text)
    leave_out(root, source)
    _write(source / "index.md", _start_page(source))


def _start_page(source: Path) -> str:
    """Return the start page, with contents that list the existing pages."""
    lines = _own_page("index.md").splitlines(keepends=True)
    place = lines.index(CARDS)
    lines[place : place + 1] = cards(source)
    named = [(line, NAMED.match(line)) for line in lines]
    return "".join(line for line, name in named if name is None or (source / f"{name[1]}.md").exists())


def _own_page(name: str) -> str:
    """Return a page next to this script with its links moved to the top of the site, where the page is."""
    folder = HERE.relative_to(ROOT).as_posix()

    def move_link(match: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(folder, match[2])).removeprefix(f"{folder}/")
        return match[1] + target

    return _OWN_LINK.sub(move_link, (HERE / name).read_text(encoding="utf-8"))


def linked(source: Path) -> Iterator[Path]:
    """Yield the targets of the Markdown links of the pages, by their path in the repository."""
    for page in sorted(source.rglob("*.md")):
        for target in _LINK.findall(page.read_text(encoding="utf-8")):
            if ":" not in target:
                yield Path(os.path.normpath(page.parent.relative_to(source) / target))


def copy_linked(root: Path, source: Path, target: Path) -> None:
    """Copy the linked files that are not pages, and the script that decodes frames."""
    for path in dict.fromkeys([DECODER, *linked(source)]):
        origin = next((base / path for base in (source, root) if (base / path).is_file()), None)
        if path.suffix != ".md" and origin is not None:
            (target / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(origin, target / path)


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def main(arguments: list[str]) -> int:
    target = Path(arguments[0] if arguments else ROOT / "build" / "site").resolve()
    warnings = build(target)
    print(f"wrote {target}; open {target / 'index.html'}")
    return 1 if warnings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
