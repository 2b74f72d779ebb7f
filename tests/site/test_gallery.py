"""The gallery of the start page, the words for search engines, and pages that the site leaves out."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from chromium import Browser

ROOT = Path(__file__).resolve().parents[2]
_SHOWN = '[...document.querySelectorAll(".gallery > .card")].filter((card) => card.checkVisibility())'
#: Set the filters, and return the addresses of the cards that remain.
_FILTER = """(([words, manufacturer, interface_]) => {
  const form = document.querySelector(".filters");
  form.elements.words.value = words;
  form.elements.manufacturer.value = manufacturer;
  form.elements.interface.value = interface_;
  form.dispatchEvent(new Event("input", { bubbles: true }));
  const cards = %s;
  return cards.map((card) => card.querySelector("h3 a").getAttribute("href").replace(/.*\\/|\\.html/g, ""));
})(%s)"""


@pytest.mark.slow
def test_there_is_a_card_with_a_picture_for_each_encoder(site: Path, browser: Browser) -> None:
    browser.look(1280)
    browser.open((site / "index.html").as_uri())
    specs = [path for path in (ROOT / "specs").glob("*/*.yaml") if "device:" in path.read_text(encoding="utf-8")]
    families = {path.stem for path in specs if not path.stem.endswith((".second", ".coverage"))}
    assert set(browser.run(_FILTER % (_SHOWN, ["", "", ""]))) == families
    pictures = browser.run(f'{_SHOWN}.map((card) => card.querySelectorAll(".bits").length)')
    assert pictures == [1] * len(families)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "manufacturer", "interface", "names"),
    [
        ("", "SICK", "", {"skm36", "dl100", "dl1000"}),
        ("", "Lika Electronic", "RS-485", {"amm5", "sma21"}),
        ("AMM5A21/65KSC1", "", "", {"amm5"}),
        ("linear renishaw", "", "", {"resolute_linear"}),
        ("gray", "Lika Electronic", "", {"am36", "asc85", "sma21"}),
        ("biss ichaus", "", "", {"icmhm", "icmn", "icmr", "icmu"}),
        ("IC HAUS biss-c", "", "", {"icmhm", "icmn", "icmr", "icmu"}),
        ("no such encoder", "", "", set()),
    ],
)
def test_it_is_filtered_while_one_types(
    site: Path, browser: Browser, words: str, manufacturer: str, interface: str, names: set[str]
) -> None:
    browser.open((site / "index.html").as_uri())
    assert set(browser.run(_FILTER % (_SHOWN, [words, manufacturer, interface]))) == names
    count = browser.run('document.querySelector(".filters output").textContent')
    assert count == f"{len(names)} famil{'y' if len(names) == 1 else 'ies'}"


@pytest.mark.slow
def test_filters_without_a_match_can_be_cleared(site: Path, browser: Browser) -> None:
    """The paragraph about the cards is hidden while there are none, and the labels of the filters stay in sight."""
    seen = '[".filters .none", ".gallery + p"].map((one) => document.querySelector(one).checkVisibility())'
    browser.look(1280)
    browser.open((site / "index.html").as_uri())
    assert browser.run(seen) == [False, True]
    browser.run('document.querySelector(".filters input").scrollIntoView()')
    assert browser.run(_FILTER % (_SHOWN, ["no such encoder", "SICK", "SSI"])) == []
    assert browser.run(seen) == [True, False]
    below_header = (
        'document.querySelector(".filters label").getBoundingClientRect().top >= '
        'document.querySelector("header.top").getBoundingClientRect().bottom'
    )
    assert browser.run(below_header)
    browser.run('document.querySelector(".filters .none button").click()')
    assert browser.run(seen) == [False, True]
    assert browser.run('[...new FormData(document.querySelector(".filters")).values()]') == ["", "", ""]
    browser.run('document.querySelector(".filters input").scrollIntoView()')
    assert browser.run(below_header)


@pytest.mark.slow
@pytest.mark.parametrize("width", [375, 1280])
def test_the_filters_have_one_height(site: Path, browser: Browser, width: int) -> None:
    browser.look(width)
    browser.open((site / "index.html").as_uri())
    boxes = browser.run(
        '[...document.querySelectorAll(".filters :is(input, select)")].map((one) => one.getBoundingClientRect())'
        ".map((box) => [box.height, box.bottom, box.width])"
    )
    heights, bottoms, widths = map(set, zip(*boxes, strict=True))
    assert len(heights) == 1
    assert len(bottoms if width == 1280 else widths) == 1


@pytest.mark.slow
def test_titles_and_descriptions_have_the_words_that_people_type(site: Path) -> None:
    page = (site / "generated/docs/amm5/AMM5A21-65KSC1.html").read_text(encoding="utf-8")
    assert "<title>AMM5A21/65KSC1: BiSS-C frame, CRC, pinout, preset · codewheel</title>" in page
    described = re.compile(r'<meta name="description" content="([^"]{20,160})">')
    without = [path for path in site.glob("generated/docs/*/*.html") if not described.search(path.read_text("utf-8"))]
    assert without == []


@pytest.mark.slow
def test_pages_for_nobody_are_left_out(site: Path) -> None:
    """Neither folders of the repository nor changes before the first release have a page."""
    assert list(site.rglob("index.html")) == [site / "index.html"]
    assert list(site.glob("generated/docs/*-changes.html")) == []


@pytest.mark.slow
def test_the_site_stays_small(site: Path) -> None:
    size = sum(path.stat().st_size for path in site.rglob("*") if path.is_file())
    # 41 families with 700 order codes. iC-PVL alone has 120 made-up ones.
    assert size < 60_000_000


@pytest.mark.exhaustive
def test_a_sitemap_is_written_for_an_address(tmp_path: Path) -> None:
    pytest.importorskip("myst_parser", reason="the extra 'site' is not installed")
    (tmp_path / "root").mkdir()
    (tmp_path / "root" / "README.md").write_text("# A page\n", encoding="utf-8")
    command = "import sys; from pathlib import Path; from build_site import build; build(*map(Path, sys.argv[1:]))"
    folders = [str(tmp_path / "site"), str(tmp_path / "root")]
    environment = {**os.environ, "SITE_BASE": "https://example.org/encoders/"}
    subprocess.run([sys.executable, "-c", command, *folders], cwd=ROOT / "docs" / "site", env=environment, check=True)
    tree = ElementTree.parse(tmp_path / "site" / "sitemap.xml")
    places = [place.text for place in tree.iter("{http://www.sitemaps.org/schemas/sitemap/0.9}loc")]
    pages = ["README", "api/c", "api/python", "api/runtime", "index"]
    assert places == [f"https://example.org/encoders/{page}.html" for page in pages]
    robots = (tmp_path / "site" / "robots.txt").read_text(encoding="utf-8")
    assert robots == "Sitemap: https://example.org/encoders/sitemap.xml\n"
