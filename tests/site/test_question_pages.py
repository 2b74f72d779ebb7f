"""The pages of questions are the first hits for the words that people type."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import quote

import pytest
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
"""


@pytest.mark.slow
@pytest.mark.parametrize(("typed", "page"), rows(ASKED), ids=lambda cell: cell)
def test_the_answer_is_the_first_hit(site: Path, browser: Browser, typed: str, page: str) -> None:
    browser.open(f"{(site / 'search.html').as_uri()}?q={quote(typed)}")
    _, target = browser.run(FIRST)
    assert target.partition("#")[0] == f"docs/{page}.html"
    assert browser.complaints == []
