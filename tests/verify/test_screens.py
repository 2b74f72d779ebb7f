"""Pages in a browser: their length in screens, and folds of order codes that open for links."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from building import build
from chromium import CHROMIUM, Browser
from working_tools import require

#: Families whose specs are from manuals.
FROM_MANUALS = ("am36", "amm5", "asc85", "sma21")
#: Width and height of the screens, and the maximum length of a page with its details folded, in screens.
SCREENS = [(1280, 800, 4.0), (375, 760, 8.0)]
#: The maximum length with all details open, for pages that were measured before, and for every other page.
OPEN = {
    "AMM5A21-65KSC1": {1280: 15.0, 375: 28.0},
    "AMM5A23-65KJP1": {1280: 23.0, 375: 42.0},
    "AM3616-4096-I7": {1280: 25.0, 375: 45.0},
}
REST = {1280: 25.0, 375: 45.0}
#: Pages on which facts are looked up, and their maximum length in screens of 1280 pixels with folds as they open.
REFERENCE = (
    "docs/transcribe/rules*.html",
    "docs/transcribe/spec-language*.html",
    "docs/*/how-to-*.html",
    "generated/docs/*/[a-z]*.html",
)
LONGEST_REFERENCE = 15.0
#: Share of the visible words that may be about errata.
ERRATA = 0.10
_WORDS = """(() => {
  const words = (text) => text.split(/\\s+/).filter(Boolean).length;
  const links = [...document.querySelectorAll('a[href*="#erratum-"]')].filter((item) => item.checkVisibility());
  return [links.map((item) => words(item.innerText)).reduce((sum, count) => sum + count, 0),
          words((document.querySelector("article") || document.body).innerText)];
})()"""


@pytest.fixture(scope="session")
def site(made_once: Callable[[str, Callable[[Path], object]], Path]) -> Path:
    pytest.importorskip("myst_parser", reason="the extra 'site' is not installed")
    return made_once("site", lambda folder: build(folder / "site")) / "site"


@pytest.fixture
def browser(tmp_path: Path) -> Iterator[Browser]:
    require([CHROMIUM])
    with Browser(tmp_path / "profile") as opened:
        yield opened


def order_codes(site: Path) -> list[Path]:
    """Return the pages of order codes, whose names have capital letters."""
    paths = [path for path in sorted(site.glob("generated/docs/*/*.html")) if path.stem != path.stem.lower()]
    assert len(paths) > 50
    return paths


def screens(browser: Browser, height: int) -> float:
    return float(browser.run("document.documentElement.scrollHeight")) / height


@pytest.mark.parametrize(("width", "height", "limit"), SCREENS)
def test_a_page_is_a_few_screens_long(site: Path, browser: Browser, width: int, height: int, limit: float) -> None:
    browser.look(width, height=height)
    folded, opened = {}, {}
    for page in order_codes(site):
        browser.open(page.as_uri())
        folded[page.stem] = screens(browser, height)
        browser.run('document.querySelectorAll("details").forEach((item) => { item.open = true; })')
        opened[page.stem] = screens(browser, height)
    assert {name: count for name, count in folded.items() if count > limit} == {}
    assert {name: count for name, count in opened.items() if count > OPEN.get(name, REST)[width]} == {}


def test_a_page_of_reference_is_split_by_what_is_looked_up(site: Path, browser: Browser) -> None:
    browser.look(1280, height=800)
    pages = {page for pattern in REFERENCE for page in site.glob(pattern)} - {*order_codes(site)}
    assert len(pages) > 100
    lengths = {}
    for page in pages:
        browser.open(page.as_uri())
        lengths[page.relative_to(site).as_posix()] = screens(browser, 800)
    assert {name: count for name, count in lengths.items() if count > LONGEST_REFERENCE} == {}


def test_errata_do_not_fill_what_is_in_sight(site: Path, browser: Browser) -> None:
    browser.look(1280, height=800)
    shares = {}
    for page in order_codes(site):
        browser.open(page.as_uri())
        errata, words = browser.run(_WORDS)
        shares[page.stem] = errata / words
    assert {name: share for name, share in shares.items() if share > ERRATA} == {}
    assert max(shares.values()) > 0


@pytest.mark.parametrize("anchor", ["register-preset", "procedure-set_preset", "erratum-ground_wire", "crc-biss_6"])
def test_a_link_opens_the_fold_into_which_it_leads(site: Path, browser: Browser, anchor: str) -> None:
    page = site / "generated/docs/amm5/AMM5A21-65KSC1.html"
    is_visible = f'document.getElementById("{anchor}").parentElement.checkVisibility()'
    browser.look(1280, height=800)
    browser.open(page.as_uri())
    assert browser.run(is_visible) is False
    browser.open("about:blank")
    browser.open(f"{page.as_uri()}#{anchor}")
    assert browser.run(is_visible) is True


def test_the_picture_of_a_frame_is_wide_on_a_wide_screen_only(site: Path, browser: Browser) -> None:
    page = site / "generated/docs/amm5/AMM5A21-65KSC1.html"
    for width, ending in [(1280, "-wide.svg"), (375, "data.svg")]:
        browser.look(width)
        browser.open(page.as_uri())
        assert str(browser.run('document.querySelector("picture img").currentSrc')).endswith(ending)


def test_the_answers_stand_in_their_order(site: Path, browser: Browser) -> None:
    browser.look(1280, height=800)
    for page in order_codes(site):
        browser.open(page.as_uri())
        heads = browser.run('[...document.querySelectorAll("h2")].map((item) => item.firstChild.textContent.trim())')
        speed = "Baud rate and times" if "Baud rate and times" in heads else "Clock and cable"
        # Specs that are not from a manual may have no clock, and do not say whether there are LEDs.
        order = ["Wiring", speed, "Frame", "What to send", "LEDs", "Details"]
        if page.parent.name not in FROM_MANUALS:
            order = [title for title in order if title not in {speed, "LEDs"} or title in heads]
        assert [title for title in heads if title in order] == order, page.stem
