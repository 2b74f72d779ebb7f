"""The site as a whole: every link and anchor, some of its pages in a browser, and the box that decodes frames."""

from __future__ import annotations

import posixpath
import re
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest
from chromium import Browser
from exhaustive import mostly_exhaustive
from looks import LOOKS, faults

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
#: One of each kind of page.
SAMPLE = (
    "index.html",
    "README.html",
    "CONTRIBUTING.html",
    "docs/firmware/start-firmware.html",
    "docs/transcribe/spec-language.html",
    "generated/docs/README.html",
    "generated/docs/amm5.html",
    "generated/docs/amm5-biss-masters.html",
    "generated/docs/registers-by-address.html",
    "generated/docs/amm5/AMM5A21-65KSC1.html",
    "generated/docs/sma21/SMA21-JP1-0050.html",
    "search.html",
)


class Page(HTMLParser):
    """Return the anchors of a page, its links, and the files that it loads."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        named = dict(attributes)
        self.anchors.add(named.get("id") or "")
        if tag == "a" and named.get("href"):
            self.links.append(named["href"] or "")
        self.loads += [value for name in ("src", "href") if tag != "a" and (value := named.get(name))]


def unresolved(site: Path) -> Iterator[str]:
    pages = {path.relative_to(site).as_posix(): Page(path) for path in site.rglob("*.html")}
    for name, page in pages.items():
        for link in [*page.links, *page.loads]:
            path, _, anchor = link.partition("?")[0].partition("#")
            if re.match(r"[a-z]+:", link):
                if link in page.loads:
                    yield f"{name} loads {link}"
                continue
            target = posixpath.normpath(posixpath.join(posixpath.dirname(name), unquote(path))) if path else name
            if target not in pages and not (site / target).is_file():
                yield f"{name}: {link}"
            # What follows the page of settings is the input of its form.
            elif anchor and "=" not in anchor and target in pages and unquote(anchor) not in pages[target].anchors:
                yield f"{name}: {link} (no such anchor)"


@pytest.mark.slow
def test_every_link_and_anchor(site: Path) -> None:
    assert list(unresolved(site)) == []


@pytest.mark.slow
def test_the_page_of_an_order_code_has_its_header_for_c(site: Path) -> None:
    folder = site / "generated" / "docs" / "amm5"
    assert 'href="lika_amm5a21_65ksc1.h"' in (folder / "AMM5A21-65KSC1.html").read_text(encoding="utf-8")
    header = (folder / "lika_amm5a21_65ksc1.h").read_text(encoding="ascii")
    assert "#define LIKA_AMM5A21_65KSC1_READ(rx, position)" in header


@pytest.mark.slow
def test_the_page_of_an_order_code_leads_to_its_settings(site: Path) -> None:
    folder = site / "generated" / "docs" / "amm5"
    biss = (folder / "AMM5A21-65KSC1.html").read_text(encoding="utf-8")
    assert 'href="../../../settings.html#code=AMM5A21%2F65KSC1">Settings for your master</a>' in biss
    assert "settings.html#" not in (folder / "AMM5A23-65KJP1.html").read_text(encoding="utf-8")


def test_every_page_leads_back_and_has_the_search(site: Path) -> None:
    for path in site.rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        assert text.count('<input type="search" name="q"') == 1, path
        assert path == site / "index.html" or '<nav class="crumbs"' in text, path


@pytest.mark.slow
def test_a_table_without_headings_has_no_row_for_them(site: Path) -> None:
    empty = re.compile(r"<thead>(?:\s|</?(?:tr|th|p)\b[^>]*>)*</thead>")
    assert [path.name for path in site.rglob("*.html") if empty.search(path.read_text(encoding="utf-8"))] == []


@pytest.mark.slow
def test_the_header_is_one_line_on_a_tablet(site: Path, browser: Browser) -> None:
    browser.look(768)
    browser.open((site / "README.html").as_uri())
    tops = '[...document.querySelectorAll("header.top > *")].map((item) => item.getBoundingClientRect())'
    assert browser.run(f"{tops}.every((box, _, all) => box.top < all[0].bottom)") is True


@pytest.mark.slow
def test_the_wiring_fits_into_its_column(site: Path, browser: Browser) -> None:
    browser.look(1280)
    box = 'document.querySelector("#wiring .table-wrapper")'
    for page in ("sma21/SMA21-SC1-0050", "sma21/SMA21-BG1-0050", "asc85/ASC8525-SC1", "amm5/AMM5A21-65KSC1"):
        browser.open((site / f"generated/docs/{page}.html").as_uri())
        assert browser.run(f"{box}.scrollWidth <= {box}.clientWidth"), page


@pytest.mark.slow
def test_a_card_does_not_answer_an_open_question(site: Path) -> None:
    """The frame of ASC85 has 33 or 34 bits. The manual and a public driver differ."""
    start = (site / "index.html").read_text(encoding="utf-8")
    question = '<a href="generated/docs/asc85/biss.html#alternative-zero_bit">open question</a>'
    assert f"Frame of ASC8525/SC1 over BiSS C-mode: 34 or 33 bits ({question}), drawn with 34." in start
    assert "Frame of AMM5A23/65KSC1 over BiSS C-mode: 47 bits." in start


@pytest.mark.slow
@pytest.mark.parametrize(("width", "dark"), [LOOKS[1], LOOKS[2]])
def test_a_sample_in_the_browser(site: Path, browser: Browser, width: int, dark: bool) -> None:
    browser.look(width, dark)
    for name in SAMPLE:
        assert list(faults(browser, site / name, width)) == [], name
    assert browser.run("getComputedStyle(document.body).backgroundColor") == (
        "rgb(20, 24, 29)" if dark else "rgb(255, 255, 255)"
    )


@pytest.mark.slow
@pytest.mark.parametrize("has_script", mostly_exhaustive([True, False], True))
def test_the_box_that_decodes_is_there_where_its_script_is(tmp_path: Path, has_script: bool) -> None:
    pytest.importorskip("myst_parser", reason="the extra 'site' is not installed")
    root, code = tmp_path / "root", "generated/docs/amm5/AMM5A21-65KSC1"
    for name in ["README.md", f"{code}.md", *(["generated/browser/decode.js"] if has_script else [])]:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text("# A page\n", encoding="utf-8")
    command = "import sys; from pathlib import Path; from build_site import build; build(*map(Path, sys.argv[1:]))"
    folder = ROOT / "docs" / "site"
    subprocess.run([sys.executable, "-c", command, str(tmp_path / "site"), str(root)], cwd=folder, capture_output=True)
    page = (tmp_path / "site" / f"{code}.html").read_text(encoding="utf-8")
    assert (tmp_path / "site" / "decode.html").exists() == has_script
    assert ('class="codewheel-decode" data-code="AMM5A21/65KSC1"' in page) == has_script
    assert ("../../browser/decode.js" in page) == has_script
    assert (tmp_path / "site" / "generated" / "browser" / "decode.js").exists() == has_script
