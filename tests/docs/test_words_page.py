"""The page of words names the encoders that use each word today. The numbers of files come from the history."""

import re

from words_page import PAGE, WORDS, encoders_by_word, encoders_cell


def test_the_page_names_the_encoders_of_each_word() -> None:
    rows = re.findall(
        r"^\| (.+?) \| (.+?) \| (\d+) \|$", PAGE.read_text(encoding="utf-8").replace("\\", ""), re.MULTILINE
    )
    encoders = encoders_by_word()
    assert [(name, cell) for name, cell, _ in rows] == [
        (word.name, encoders_cell(encoders[word.name])) for word in WORDS
    ], "make words-page"
    assert all(int(files) > 0 for _, _, files in rows)
