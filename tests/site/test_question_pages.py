"""The pages of questions are the first hits for the words that people type, and begin with a filled box."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import quote

import pytest
import yaml
from chromium import Browser
from test_search import FIRST, rows

#: Typed words, and the page of the first hit.
ASKED = """
position jumps by a revolution at zero        | questions-jump-at-zero
encoder jumps a revolution at zero            | questions-jump-at-zero
position jumps                                | questions-jump-at-zero
runaway at roll-over                          | questions-jump-at-zero
wrong position after restart                  | questions-wrong-after-restart
position lost after power off                 | questions-wrong-after-restart
position wrong after power on                 | questions-wrong-after-restart
BiSS CRC always wrong                         | questions-crc-always-wrong
crc never matches                             | questions-crc-always-wrong
all ones                                      | questions-all-ones
open input reads as connected                 | questions-all-ones
all bits are 1                                | questions-all-ones
position off by a factor of two               | questions-factor-of-two
position is half                              | questions-factor-of-two
position twice                                | questions-factor-of-two
counts backwards                              | questions-counts-backwards
wrong counting direction                      | questions-counts-backwards
encoder runs the wrong way                    | questions-counts-backwards
what is the error bit                         | questions-error-bit
TM PosInput frame length                      | questions-master-settings
EL5042 offset LSB                             | questions-master-settings
my encoder is not in the list                 | one-line
unknown encoder                               | one-line
supported encoders                            | encoders
"""
#: Pages, and what the box shows for the example.
EXAMPLES = """
all-ones            | Every bit is 1
all-zeros           | Every bit is 0
counts-backwards    | 0.0343°
crc-always-wrong    | the CRC is not inverted
error-bit           | the position is not usable
factor-of-two       | 16000 counts
gray-or-binary      | 287.71692°
jump-at-zero        | position 2097151
master-settings     | usable: No error. The position is usable.
only-an-echo        | only your own request
ssi-extra-clocks    | the word comes first, and the other clocks read 0
wrong-after-restart | the position is not usable
wrong-turn          | 0.0000° of revolution 7
"""
#: Typed words with the pages that answer them, as people type them.
TYPED = yaml.safe_load((Path(__file__).parent / "asked.yaml").read_text(encoding="utf-8"))
#: Of each 30 of them, as many must have the right page first.
ENOUGH = 26


def first_hit(site: Path, browser: Browser, typed: str) -> str:
    browser.open(f"{(site / 'search.html').as_uri()}?q={quote(typed)}")
    _, target = browser.run(FIRST)
    assert browser.complaints == []
    return str(target)


@pytest.mark.slow
@pytest.mark.parametrize(("typed", "page"), rows(ASKED), ids=lambda cell: cell)
def test_the_answer_is_the_first_hit(site: Path, browser: Browser, typed: str, page: str) -> None:
    assert first_hit(site, browser, typed).partition("#")[0] == f"docs/encoder/{page}.html"


@pytest.mark.slow
@pytest.mark.parametrize("source", TYPED)
def test_what_people_type_has_the_right_page_first(site: Path, browser: Browser, source: str) -> None:
    assert len(TYPED[source]) == 30
    hits = {row["typed"]: first_hit(site, browser, row["typed"]) for row in TYPED[source]}
    missed = [row["typed"] for row in TYPED[source] if not hits[row["typed"]].startswith(tuple(row["pages"]))]
    assert 30 - len(missed) >= ENOUGH, missed


@pytest.mark.slow
@pytest.mark.parametrize(("page", "shown"), rows(EXAMPLES), ids=lambda cell: cell)
def test_it_begins_with_a_filled_box_and_has_two_screens(site: Path, browser: Browser, page: str, shown: str) -> None:
    browser.look(1280, height=800)
    browser.open((site / "docs" / "encoder" / f"questions-{page}.html").as_uri())
    text = browser.run('document.querySelector(".codewheel-decode").textContent')
    assert shown in text, text
    before = browser.run('[...document.querySelectorAll("article section > *")].map((item) => item.className)')
    assert before[:3] == ["", "try", "codewheel-decode example"]
    link = browser.run('document.querySelector(".codewheel-decode-link a").getAttribute("href")')
    assert link.startswith("../../decode.html#code=")
    assert browser.run("document.documentElement.scrollHeight") <= 2 * 800
    assert browser.complaints == []


def test_each_question_page_has_an_example() -> None:
    pages = (Path(__file__).parents[2] / "docs/encoder").glob("questions-*.md")
    assert {page for page, _ in rows(EXAMPLES)} == {path.stem.removeprefix("questions-") for path in pages}
