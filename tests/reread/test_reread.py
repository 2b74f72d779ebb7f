"""A new edition of a manual leads to the facts that it touches, and another layout of the same text to none."""

from __future__ import annotations

import json
import re
import shutil
import textwrap
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.reread import sections

ROOT = Path(__file__).parents[2]
SPECS = ROOT / "docs/example/tolvarn"
MANUAL = (ROOT / "docs/example/manual.md").read_text(encoding="utf-8")


def passages(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], new: str, old: str = MANUAL
) -> list[dict[str, object]]:
    (tmp_path / "old.txt").write_text(old, encoding="utf-8")
    (tmp_path / "new.txt").write_text(new, encoding="utf-8")
    files = [str(tmp_path / "old.txt"), str(tmp_path / "new.txt")]
    exit_code = main(["reread", *files, "--specs", str(SPECS), "--json"])
    listed = json.loads(capsys.readouterr().out)["passages"]
    assert exit_code == bool(listed)
    assert isinstance(listed, list)
    return listed


EDITS = {
    "clock": ("80 kHz to 10 MHz", "100 kHz to 10 MHz", "3", "interfaces.biss.clock.min_hz"),
    "timeout": ("40 µs at most", "30 µs at most", "3", "interfaces.biss.timeout.at_most_ns"),
    "wait": ("least 50 ms", "least 80 ms", "4.5", "procedures.set_preset.steps[2].at_least_ms"),
    "polynomial": ("| 190D9h |", "| 11021h |", "3.3", "crcs.position_16.poly"),
    "start value": ("is 5A3Ch", "is FFFFh", "3.3", "crcs.position_16.init"),
    "width": ("| LC | 6 |", "| LC | 8 |", "3.1", "interfaces.biss.layouts.position_data.fields.life_counter.bits"),
    "address": ("| 48h | wo |", "| 49h | wo |", "4.4", "registers.command.address"),
    "access": ("| 44h to 47h | ro |", "| 44h to 47h | rw |", "4.4", "registers.serial_number.access"),
    "default": ("95.0 °C | Upper", "90.0 °C | Upper", "4.3", "registers.upper_limit.default"),
    "meaning": ("2 = long", "2 = slow", "4.2", "registers.control.fields.filter.values.long.value"),
    "pin": ("| 3 | Clock + / MA + |", "| 3 | Clock / MA + |", "5", "connectors.m12_8.contacts.3.signal"),
    "unit without a space": ("80 kHz to 10 MHz", "80kHz to 20MHz", "3", "interfaces.biss.clock.max_hz"),
    "renamed bit": ("Bit 1: direction", "Bit 1: sense", "4.2", "registers.control.fields.direction.at"),
    "shaft": ("shaft of 12 mm", "shaft of 14 mm", "1", "characteristics.shaft.value"),
}


@pytest.mark.slow
@pytest.mark.parametrize(("old", "new", "section", "fact"), EDITS.values(), ids=EDITS)
def test_a_fact_that_changes_is_among_the_first_five(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, section: str, fact: str
) -> None:
    assert MANUAL.count(old) == 1
    (passage,) = passages(tmp_path, capsys, MANUAL.replace(old, new))
    assert passage["section"] == section
    assert isinstance(passage["facts"], list)
    assert fact in [listed_fact["path"] for listed_fact in passage["facts"][:5]]


def test_another_layout_of_the_same_text_is_no_difference(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Other line ends, hyphens, ligatures, page numbers and running heads, and no marks of headings."""
    lines: list[str] = []
    for paragraph in re.sub(r"^#+ |\*\*", "", MANUAL, flags=re.MULTILINE).replace("fi", "ﬁ").splitlines():
        is_prose = len(paragraph) > 75 and not paragraph.startswith(("|", ">", " "))
        lines += textwrap.wrap(paragraph, 58) if is_prose else [paragraph]
    pages = [lines[at : at + 25] for at in range(0, len(lines), 25)]
    printed_lines: list[str] = []
    for number, page in enumerate(pages, 1):
        printed_lines += ["TV62 interface manual", *page, f"Tolvarn Instruments  page {number} of 9", f"{number}"]
    text = "\n".join(printed_lines).replace("counterclockwise", "counter-\nclockwise")
    assert "ﬁrst" in text
    assert passages(tmp_path, capsys, text) == []


def test_contents_in_columns_and_long_headings_are_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A page number can follow spaces instead of a tab. A narrow page breaks headings and entries of the contents."""
    new = re.sub(r"^\| (\d.*) \| (\d+) \|$", r"\1    \2", MANUAL, flags=re.MULTILINE)
    assert "4.6 Setting the limits of the temperature    3\n" in new
    assert passages(tmp_path, capsys, new) == []
    new = new.replace("the limits of the temperature    3", "the limits\nof the temperature    3")
    assert passages(tmp_path, capsys, new) == []
    new = new.replace(
        "### 4.6 Setting the limits of the temperature", "### 4.6 Setting the\nlimits of\nthe temperature"
    )
    assert passages(tmp_path, capsys, new) == []


def test_a_decimal_comma_is_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old = re.sub(r"(?<=\d)\.(?=\d °C)", ",", MANUAL)
    (passage,) = passages(tmp_path, capsys, old.replace("95,0 °C | Upper", "90,0 °C | Upper"), old)
    assert isinstance(passage["facts"], list)
    assert passage["facts"][0]["path"] == "registers.upper_limit.default"


def test_a_section_without_a_number_has_its_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Its title depends on the language of the edition."""
    specs = tmp_path / "tolvarn"
    shutil.copytree(SPECS, specs)
    rows = re.findall(r"^\| ([1-5][.\d]*) ([A-Z].*) \| ([1-3]) \|$", MANUAL, flags=re.MULTILINE)
    contents = "".join(f'    "{number}": {{title: "{title}", page: {page}}}\n' for number, title, page in rows)
    spec = (specs / "tv62.yaml").read_text(encoding="utf-8")
    spec = spec.replace("\nmanual:\n", f"\nmanual:\n  contents:\n    Introduction: {{page: 1}}\n{contents}")
    spec = spec.replace("Hollow shaft of 12 mm, source: 1 p.1", "Hollow shaft of 12 mm, source: Introduction p.1")
    (specs / "tv62.yaml").write_text(spec, encoding="utf-8")
    old = MANUAL.replace("| 1 Order code | 1 |", "| Vorwort | 1 |\n| 1 Order code | 1 |")
    old = old.replace("## 1 Order code", "Vorwort\n\nThe shaft has 12 mm.\n\n## 1 Order code")
    (tmp_path / "old.txt").write_text(old, encoding="utf-8")
    (tmp_path / "new.txt").write_text(old.replace("has 12 mm", "has 14 mm"), encoding="utf-8")
    main(["reread", str(tmp_path / "old.txt"), str(tmp_path / "new.txt"), "--specs", str(specs), "--json"])
    (passage,) = json.loads(capsys.readouterr().out)["passages"]
    assert passage["section"] == "Vorwort"
    assert passage["facts"][0]["path"].startswith("characteristics.shaft.")
    main(["reread", str(tmp_path / "old.txt"), str(tmp_path / "new.txt"), "--specs", str(specs)])
    out = capsys.readouterr().out
    assert f"\n1 passage in 1 section, cited by {passage['facts_of_section']} of " in out


def _as_pages(lines: list[str], length: int = 22) -> str:
    """Return lines as pages of a handbook. Odd and even pages have different heads, one of them without a number."""
    pages = [lines[at : at + length] for at in range(0, len(lines), length)]
    odd, even = "{body}\nTolvarn · tv62.example · {page} / 9", "{page}   Encoder handbook\n{body}\nTolvarn Instruments"
    heads = (even, "New design\n" + odd)
    return "\f".join(heads[page % 2].format(page=page, body="\n".join(body)) for page, body in enumerate(pages, 1))


@pytest.mark.slow
def test_form_feeds_show_where_running_heads_are(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A line that also occurs elsewhere, or a number in a text, is not a running head even at the edge of a page."""
    warning = "WARNING\n\nSwitch off first, see Figure\n"
    old = re.sub(
        r"^(## [2-5])", lambda heading: f"{warning}7.\n{warning}8.\n\n{heading[1]}", MANUAL, flags=re.MULTILINE
    )
    lines = [line for line in re.sub(r"^#+ |\*\*", "", old, flags=re.MULTILINE).splitlines() if line]
    for length in range(7, 23):
        assert passages(tmp_path, capsys, _as_pages(lines, length), old) == [], length


def test_regular_lines_are_running_heads_without_form_feeds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = [line for line in re.sub(r"^#+ |\*\*", "", MANUAL, flags=re.MULTILINE).splitlines() if line]
    text = _as_pages(lines, 13).replace("\f", "\n")
    assert passages(tmp_path, capsys, text) == []


@pytest.mark.slow
def test_a_page_end_with_two_numbers_counts_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A word that occurs in every section is not a running head because some of its places are near page ends."""
    old = re.sub(r"^(## [1-5].*)$", r"\1\n\nWARNING\n\nSwitch off first.", MANUAL, flags=re.MULTILINE)
    lines = [line for line in re.sub(r"^#+ |\*\*", "", old, flags=re.MULTILINE).splitlines() if line]
    for length in range(16, 30):
        pages = [lines[at : at + length] for at in range(0, len(lines), length)]
        printed_lines: list[str] = []
        for number, page in enumerate(pages, 1):
            printed_lines += ["Handbook", *page, f"Tolvarn  page {number} of {len(pages)}", f"{number}"]
        assert passages(tmp_path, capsys, "\n".join(printed_lines), old) == [], length


def test_a_link_that_continues_on_the_next_line_is_its_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old = MANUAL.replace("The code is binary.", "The code is binary, see [the page](https://tolvarn.example/codes).")
    assert passages(tmp_path, capsys, old.replace("[the page](https", "[the\npage](https"), old) == []


def test_rows_of_a_table_are_no_page_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = "\n".join(f"{bit} | Not used" for bit in (0, 1, 3, 4, 7))
    old = MANUAL.replace("All three are two's", f"{rows}\n\nAll three are two's")
    (passage,) = passages(tmp_path, capsys, old.replace("3 | Not used", "3 | Filter"), old)
    assert (passage["section"], passage["old"], passage["new"]) == ("4.3", "Not used", "Filter")


def test_numbers_in_references_are_no_difference(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Pages move with the layout. A section that moved has the same title under its new number."""
    old = MANUAL + '\nSee the section "4.6 Setting the limits of the temperature" on page 3 and Figure 8.\n'
    new = MANUAL.replace("4.6 Setting the limits", "4.7 Setting the limits")
    new += '\nSee the section "4.7 Setting the limits of the temperature" on page\n11 and Figure 8.\n'
    assert passages(tmp_path, capsys, new, old) == []
    (passage,) = passages(tmp_path, capsys, new.replace("Figure 8.", "Figure 9."), old)
    assert (passage["old"], passage["new"]) == ("8", "9")


def test_sections_that_change_places_are_no_difference(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    start, middle, end = (MANUAL.index(heading) for heading in ("### 4.2 Bank", "### 4.3 Bank", "### 4.4"))
    bank, temperature = MANUAL[start:middle], MANUAL[middle:end]
    swapped = temperature.replace("4.3 Bank", "4.2 Bank") + bank.replace("4.2 Bank", "4.3 Bank")
    contents = ("4.2 Bank 2, temperature | 3 |", "4.3 Bank 1, position | 3 |")
    new = MANUAL.replace(bank + temperature, swapped)
    new = new.replace("4.2 Bank 1, position | 3 |", contents[0]).replace("4.3 Bank 2, temperature | 3 |", contents[1])
    assert contents[0] in new
    assert passages(tmp_path, capsys, new) == []


def test_a_section_that_the_contents_skip_has_its_own_facts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old = MANUAL.replace("| 4.5 Setting the preset | 3 |\n", "")
    (passage,) = passages(tmp_path, capsys, old.replace("least 50 ms", "least 80 ms"), old)
    assert passage["section"] == "4.5"


def test_a_section_that_moved_is_no_difference(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    new = MANUAL.replace("4.6 Setting the limits", "4.7 Setting the limits")
    assert passages(tmp_path, capsys, new) == []


def test_a_change_that_no_fact_cites_is_listed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    added = "## 6 Storage\n\nStore the encoder between −20 °C and 60 °C, dry and without vibration.\n"
    contents = "| 5 Connector | 3 |\n| 6 Storage | 4 |\n"
    new = MANUAL.replace("| 5 Connector | 3 |\n", contents) + added
    (passage,) = passages(tmp_path, capsys, new)
    assert (passage["section"], passage["facts_of_section"]) == ("6", 0)
    files = [str(tmp_path / "old.txt"), str(tmp_path / "new.txt")]
    main(["reread", *files, "--specs", str(SPECS)])
    assert "no fact in the spec cites this place" in capsys.readouterr().out


def test_two_languages_are_compared_by_their_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Words are spelled backwards here. The decimal sign also depends on the language."""
    foreign = re.sub(
        r"(?<!\w)[A-Za-z]{4,}(?!\w)", lambda word: word[0][::-1], MANUAL.replace("95.0 °C | Upper", "91.0 °C | Upper")
    )
    foreign = re.sub(r"(?<=\d)\.(?=\d °C)", ",", foreign)
    (passage,) = passages(tmp_path, capsys, foreign)
    assert (passage["section"], passage["old"], passage["new"]) == ("4.3", "95.0", "91.0")


def test_an_option_renamed_in_headings_leads_to_its_facts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old = MANUAL.replace("5 Connector", "5 Connector (S1 order codes)")
    assert old.count("S1 order codes") == 2
    (passage,) = passages(tmp_path, capsys, old.replace("S1 order codes", "S2 order codes"), old)
    assert (passage["section"], passage["old"], passage["new"]) == ("5", "S1", "S2")
    assert isinstance(passage["facts"], list)
    paths = [listed_fact["path"] for listed_fact in passage["facts"][:5]]
    assert "order_code.parts.output.values.S1.interface" in paths


def test_a_removed_row_of_an_order_code_leads_to_its_option(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old = MANUAL.replace("### 3.2", "Model TVS20 has a frame of its own.\n\n### 3.2", 1)
    (passage,) = passages(tmp_path, capsys, MANUAL, old)
    assert isinstance(passage["facts"], list)
    paths = [listed_fact["path"] for listed_fact in passage["facts"][:5]]
    assert "order_code.parts.resolution.values.20.sets.singleturn_bits" in paths


def test_a_running_head_that_is_the_title_of_the_cover_is_no_difference(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    title, *lines = [line for line in MANUAL.split("\n") if line]
    head = title.lstrip("# ")
    pages = [lines[at : at + 20] for at in range(0, len(lines), 20)]
    assert len(pages) > 4
    text = "\f".join("\n".join([head, *page, str(number)]) for number, page in enumerate(pages, 1))
    assert passages(tmp_path, capsys, text) == []


@pytest.mark.parametrize(
    ("data", "error_text"),
    [
        (None, "cannot read {path}: No such file or directory"),
        (b"\xff\xfe\x00", "{path} is not UTF-8 text; convert it, or give the PDF"),
        (b" \n\n", "{path} has no text; run text recognition (OCR) on a scanned manual first"),
        (b"%PDF-1.4\nno more", "{path} is a PDF, which needs the package pypdf: pip install 'codewheel[pdf]'"),
    ],
)
def test_a_file_that_is_no_manual_is_named(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    data: bytes | None,
    error_text: str,
) -> None:
    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(sections, "import_module", missing)
    path = tmp_path / "new"
    if data is not None:
        path.write_bytes(data)
    (tmp_path / "old").write_text(MANUAL, encoding="utf-8")
    assert main(["reread", str(tmp_path / "old"), str(path), "--specs", str(SPECS)]) == 2
    assert capsys.readouterr().err == f"codewheel: {error_text.format(path=path)}\n"


def test_a_manual_of_no_family_asks_for_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "manual.txt"
    path.write_text("Another encoder\n\n1 - Clock\n\n100 kHz\n", encoding="utf-8")
    assert main(["reread", str(path), str(path), "--specs", str(SPECS)]) == 2
    message = "cannot tell which family this manual describes: its first page names none of the families; "
    message += "add --family NAME, one of tv62"
    assert capsys.readouterr().err == f"codewheel: {message}\n"
    assert main(["reread", str(path), str(path), "--family", "TV62", "--specs", str(SPECS)]) == 0
    assert main(["reread", str(path), str(path), "--family", "tv63", "--specs", str(SPECS)]) == 2


def test_facts_of_a_place(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["facts", "tv62", "--section", "4.1", "--specs", str(SPECS)]) == 0
    printed = capsys.readouterr().out
    assert ": registers.bank.address: 0x40\n" in printed
    assert main(["facts", "tv62", "--page", "1", "--section", "5", "--specs", str(SPECS)]) == 1
    assert capsys.readouterr().out == "0 facts from section 5 page 1\n"
    assert main(["facts", "tv62", "--specs", str(SPECS)]) == 2
