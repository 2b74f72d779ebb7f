"""Every page of the site at both widths, light and dark; axe-core; and the same bytes when it is built again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from building import build
from chromium import CHROMIUM, Browser
from looks import LOOKS, axe_finds, faults, tables

ROOT = Path(__file__).resolve().parents[2]

AXE = ROOT / "build" / "axe" / "axe_playwright_python" / "axe.min.js"


@pytest.fixture(scope="session")
def site(made_once: Callable[[str, Callable[[Path], object]], Path]) -> Path:
    pytest.importorskip("myst_parser", reason="the extra 'site' is not installed")
    return made_once("site", lambda folder: build(folder / "site")) / "site"


def pages(site: Path) -> list[Path]:
    found = sorted(site.rglob("*.html"))
    assert len(found) > 50
    return found


@pytest.fixture
def browser(tmp_path: Path) -> Browser:
    if CHROMIUM is None:
        pytest.skip("chromium is not installed")
    return Browser(tmp_path / "profile")


@pytest.mark.parametrize(("width", "dark"), LOOKS)
def test_every_page(site: Path, browser: Browser, width: int, dark: bool) -> None:
    with browser:
        browser.look(width, dark)
        found = {str(page.relative_to(site)): list(faults(browser, page, width)) for page in pages(site)}
    assert {page: said for page, said in found.items() if said} == {}


@pytest.mark.parametrize(("width", "most"), [(1280, 0.0), (375, 0.05)])
def test_tables_fit(site: Path, browser: Browser, width: int, most: float) -> None:
    """No table scrolls inside its box at 1280 pixels, and fewer than one of twenty at 375."""
    with browser:
        browser.look(width)
        found = {str(page.relative_to(site)): tables(browser, page) for page in pages(site)}
    count = sum(all_ for all_, _ in found.values())
    wide = {page: items for page, (_, items) in found.items() if items}
    assert count > 1000
    assert sum(map(len, wide.values())) <= most * count, wide


@pytest.mark.parametrize(("width", "dark"), [LOOKS[1], LOOKS[2]])
def test_axe_finds_nothing_serious(site: Path, browser: Browser, width: int, dark: bool) -> None:
    if not AXE.exists():
        pytest.skip("axe-core is not there; make axe fetches it")
    with browser:
        browser.look(width, dark)
        script = AXE.read_text(encoding="utf-8")
        found = {str(page.relative_to(site)): axe_finds(browser, page, script) for page in pages(site)}
    assert {page: said for page, said in found.items() if said} == {}


def test_built_again_it_is_the_same(site: Path, tmp_path: Path) -> None:
    build(tmp_path / "again")
    first, second = (
        {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        for folder in (site, tmp_path / "again")
    )
    assert first.keys() == second.keys()
    assert [path for path, data in first.items() if second[path] != data] == []
