"""Markdown in which text stays text."""

from __future__ import annotations

import pytest
from codewheel.loading.spec_parts import parse_sources
from codewheel.model import cite
from codewheel.say.text import citation, code_span, escape, table, wrap_markdown


@pytest.mark.parametrize(
    ("plain", "markdown"),
    [
        ("a | b", "a \\| b"),
        ("<script>&amp;", "&lt;script&gt;&amp;amp;"),
        ("`x` *y* [z](w)", "\\`x\\` \\*y\\* \\[z\\](w)"),
        ("position_bits and _this_", "position_bits and \\_this\\_"),
        ("line\nend\u2028and \u202emore", "line end and  more"),
        ("5 $ and 6 $", "5 \\$ and 6 \\$"),
        ("back\\slash", "back\\\\slash"),
    ],
)
def test_text(plain: str, markdown: str) -> None:
    assert escape(plain) == markdown


@pytest.mark.parametrize(
    ("plain", "markdown"), [("x", "`x`"), ("a`b", "``a`b``"), ("`", "`` ` ``"), ("a|b", "`a\\|b`"), ("", "")]
)
def test_code(plain: str, markdown: str) -> None:
    assert code_span(plain) == markdown


@pytest.mark.parametrize(
    ("plain", "markdown"),
    [("1. Stop", "1\\. Stop"), ("+Vb", "\\+Vb"), ("- x", "\\- x"), ("# x", "\\# x"), ("2021", "2021")],
)
def test_a_paragraph_begins_no_list(plain: str, markdown: str) -> None:
    assert wrap_markdown(plain) == markdown


def test_a_wrapped_line_begins_no_list_either() -> None:
    words = "word " * 40
    lines = wrap_markdown(words + "1. " * 40 + "- " * 40 + "# " * 40).split("\n")
    assert [line for line in lines if line.startswith(("1. ", "- ", "# "))] == []


def test_sources() -> None:
    assert (
        citation(parse_sources("6.4 p.35; it: 6.4 p.36; Cover; prot: p.7-8"))
        == "§6.4 p.35, Cover, it: §6.4 p.36, prot: p.7-8"
    )


def test_sources_as_plain_text() -> None:
    assert cite(parse_sources("8 p.49; it: 8 p.49; 4.6 p.26")) == "8 p.49, 4.6 p.26, it: 8 p.49"


def test_empty_columns_of_a_table_are_left_out() -> None:
    assert table(["A", "B", "C"], [["1", "", "2"], ["3", "", ""]]) == "| A | C |\n| --- | --- |\n| 1 | 2 |\n| 3 |  |"
