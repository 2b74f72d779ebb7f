"""The page of words names the encoders whose specs contain each word. The numbers of files come from the history."""

from __future__ import annotations

import functools
import re

import pytest
from words_page import PAGE, ROOT, WORDS, encoders_cell

#: Text of a spec that shows that it uses the word of a row, after the start of the name of the row.
TEXTS = {
    "`over`": r"\bover: (even|odd)_bits",
    "`crc_of`": r"\bcrc_of:",
    "`others: reserved`": r"\bothers: reserved",
    "`scale`": r"\bscale:",
    "`step_nm`": r"\bstep_nm:",
    "`by_code`": r"\bby_code:",
    "`spi`": r"^  spi:",
    "`exchanges` over RS-485": r"^  rs485:\n(?:    .*\n)*    exchanges:",
    "`used_hz`": r"\bused_hz:",
    "`position_range`": r"\bposition_range:",
    # A name, its number and its verdict.
    "`makes_position` of a value": r"\{value: \w+,[^{}]*\bmakes_position:",
    "`combinations`": r"^ *combinations:",
    "`makes_position_if`": r"\bmakes_position_if:",
    # A number of bits that begins with a letter is that of a parameter.
    "a flag or parity bit": r"\{[^{}]*\bbits: [a-z][^{}]*\b(active|parity_of):",
    "a CRC selected": r"\{[^{}]*\bbits: [a-z][^{}]*\bcrc:",
    "a clock or timeout": r"^    (clock|timeout):(\n      #.*)*(\n      - |\s*\[).*\bonly:",
    "`excess`": r"\bexcess:",
    "`channels`": r"^    channels:",
}


def rows_of_page() -> dict[str, str]:
    """Return the cells with the encoders on the page, by the name of the word."""
    page = PAGE.read_text(encoding="utf-8").replace("\\", "")
    return dict(re.findall(r"^\| (.+?) \| (.+?) \| [1-9]\d* \|$", page, re.MULTILINE))


def test_the_page_has_a_row_for_each_word() -> None:
    assert [*rows_of_page()] == [word.name for word in WORDS], "make words-page"


@functools.cache
def spec_texts() -> dict[str, str]:
    """Return the texts of the specs without comments, by the name of the family."""
    texts = {}
    for path in sorted(ROOT.glob("specs/*/*.yaml")):
        text = re.sub(r"(^| )#.*", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
        device = re.search(r"^device: (\w+)", text, re.MULTILINE)
        if device is not None and ".second" not in path.name:
            texts[device[1]] = text
    return texts


@pytest.mark.parametrize("name", TEXTS)
def test_the_page_names_the_encoders_whose_specs_contain_the_text_of_a_word(name: str) -> None:
    families = [family for family, text in spec_texts().items() if re.search(TEXTS[name], text, re.MULTILINE)]
    (cell,) = [cell for word, cell in rows_of_page().items() if word.startswith(name)]
    assert cell == encoders_cell(families), "make words-page"
