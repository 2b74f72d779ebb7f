"""Every page of the site at both widths, light and dark, with axe-core, and the same bytes when it is built again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from building import build
from chromium import CHROMIUM, Browser
from looks import axe_finds, elements_of, faults, faults_here, tables_of
from working_tools import require

ROOT = Path(__file__).resolve().parents[2]

#: Axe checks one in this many similar pages.
SOME = 16
AXE = ROOT / "build" / "axe" / "axe_playwright_python" / "axe.min.js"


@pytest.fixture(scope="session")
def site(made_once: Callable[[str, Callable[[Path], object]], Path]) -> Path:
    pytest.importorskip("myst_parser", reason="the extra 'site' is not installed")
    return made_once("site", lambda folder: build(folder / "site")) / "site"


def pages(site: Path) -> list[Path]:
    paths = sorted(site.rglob("*.html"))
    assert len(paths) > 50
    return paths


@pytest.fixture
def browser(tmp_path: Path) -> Browser:
    require([CHROMIUM])
    return Browser(tmp_path / "profile")


@pytest.mark.parametrize(("width", "dark_last", "limit"), [(375, True, 0.05), (1280, False, 0.0)])
def test_every_page(site: Path, browser: Browser, width: int, dark_last: bool, limit: float) -> None:
    """Nothing is cut off, and axe finds nothing serious on pages with elements that no page before them has.

    It takes longer than everything else together, so it checks only some of the similar pages. No table scrolls in its
    box at 1280 pixels, and fewer than one in twenty scroll at 375.
    """
    script = AXE.read_text(encoding="utf-8") if AXE.exists() else ""
    count, wide, faults_by_page = 0, dict[str, list[str]](), dict[str, list[str]]()
    seen_elements = set[str]()
    with browser:
        for index, page in enumerate(pages(site)):
            name = str(page.relative_to(site))
            browser.look(width, not dark_last)
            first = list(faults(browser, page, width))
            browser.look(width, dark_last)
            faults_by_page[name] = [*first, *faults_here(browser, width)]
            elements = elements_of(browser)
            if script and (elements - seen_elements or index % SOME == 0):
                faults_by_page[name] += axe_finds(browser, script)
            seen_elements |= elements
            tables, wide[name] = tables_of(browser)
            count += tables
    assert {page: page_faults for page, page_faults in faults_by_page.items() if page_faults} == {}
    assert count > 1000
    scrolling = {page: tables for page, tables in wide.items() if tables}
    assert sum(map(len, scrolling.values())) <= limit * count, scrolling
    if not script:
        pytest.skip("axe-core is not there; make axe fetches it")


def test_built_again_it_is_the_same(site: Path, tmp_path: Path) -> None:
    build(tmp_path / "again")
    first, second = _contents(site), _contents(tmp_path / "again")
    assert first.keys() == second.keys()
    assert [path for path, data in first.items() if second[path] != data] == []


def _contents(folder: Path) -> dict[Path, bytes]:
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
