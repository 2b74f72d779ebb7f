"""The English of all texts: phrases to avoid, and densities of patterns, by english_words.py."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from english_texts import Text, texts
from english_words import DENSITIES, NOT_OF_MESSAGES, phrases

ROOT = Path(__file__).parents[2]
#: Folders of docs/ with pages. The manual in docs/example imitates manuals of manufacturers.
FOLDERS = ("bench", "encoder", "extend", "firmware", "master", "site", "transcribe", "trust")
#: Texts of one kind, whose density is measured together.
PLACES = {
    "pages": [
        "*.md",
        *(f"docs/{folder}/*.md" for folder in FOLDERS),
        ".github/*.md",
        ".github/*/*.yml",
        "examples/**/*.md",
    ],
    "generated pages": ["generated/*/*.md", "generated/docs/*/*.md", "templates/docs/*", "templates/biss/*"],
    "C": ["generated/c/**/*.[ch]", "templates/c/*", "templates/browser/*", "runtime/browser/*"],
    "generated Python": ["generated/python/**/*.py", "templates/python/*", "runtime/python/**/*.py"],
    "generator": ["generator/**/*.py"],
    "scripts": ["docs/**/*.py", "benchmarks/**/*.py", "examples/**/*.py", ".ci/*.py", "Makefile", "pyproject.toml"],
    "specs": ["specs/**/*.yaml", "docs/example/**/*.yaml"],
    "schemas": ["generator/**/*.json"],
    "tests": ["tests/**/*.py"],
}
#: Marks of the places that take most of the time. Most texts of generated files are those of specs and of templates.
LAST = {
    "generated pages": "exhaustive",
    "C": "exhaustive",
    "generated Python": "exhaustive",
    "generator": "exhaustive",
    "scripts": "exhaustive",
    "specs": "slow",
    "tests": "exhaustive",
}
#: Files whose messages are of commands. The others are counted like any prose.
MESSAGES_IN = {"generator", "rules-a-to-c.md", "rules-d-to-m.md", "rules-n-to-r.md", "rules-s-to-z.md"}
#: With fewer words, a density means little.
ENOUGH_WORDS = 5_000


def files(root: Path, place: str) -> list[Path]:
    return sorted({path for pattern in PLACES[place] for path in root.glob(pattern) if path.is_file()})


def distinct_texts(paths: list[Path]) -> Iterator[tuple[Path, Text]]:
    """Yield the texts of the files, without repetitions."""
    yielded = set()
    for path in paths:
        for text in texts(path):
            if text.message and ROOT / "tests" in path.parents:
                continue  # Most strings of tests are samples.
            if text.words not in yielded:
                yielded.add(text.words)
                yield path, replace(text, message=text.message and not MESSAGES_IN.isdisjoint(path.parts))


def findings(root: Path, path: Path, text: Text) -> Iterator[str]:
    name = path.relative_to(root).as_posix()
    for offset, phrase, better in phrases(name, text.words):
        line = text.line + text.words.count("\n", 0, offset)
        yield f"{name}:{line}: '{phrase}': better {better}"


def statements(text: str) -> str:
    """Return a text without its questions."""
    return re.sub(r"[^.!?:|]*\?(?=\s|$)", "", text)


def densities(samples: list[Text]) -> tuple[int, dict[str, float]]:
    """Return the number of words and, for each pattern, its frequency per 1,000 words."""
    prose = [(statements(text.words).lower(), text.message) for text in samples if not text.heading]
    words = sum(len(re.findall(r"[a-z][a-z'-]*", text)) for text, _ in prose)
    per_thousand = {}
    for name, (pattern, _) in DENSITIES.items():
        leaves_out_messages = name in NOT_OF_MESSAGES
        counted = [text for text, is_message in prose if not (is_message and leaves_out_messages)]
        matches = sum(len(pattern.findall(text)) for text in counted)
        per_thousand[name] = 1000 * matches / max(words, 1)
    return words, per_thousand


@pytest.mark.parametrize(
    "place",
    [pytest.param(place, marks=[getattr(pytest.mark, LAST[place])]) if place in LAST else place for place in PLACES],
)
def test_texts_avoid_the_phrases_and_patterns(place: str) -> None:
    texts_of_place = list(distinct_texts(files(ROOT, place)))
    finding_lines = [line for path, text in texts_of_place for line in findings(ROOT, path, text)]
    word_count, density_by_pattern = densities([text for _, text in texts_of_place])
    if word_count >= ENOUGH_WORDS:
        for name, (_, limit) in DENSITIES.items():
            density = density_by_pattern[name]
            if density > limit:
                finding_lines.append(f"{place}: {density:.2f} times a {name} per 1,000 words, at most {limit}")
    assert not finding_lines, f"{len(finding_lines)} findings:\n" + "\n".join(finding_lines)


@pytest.mark.parametrize(
    ("name", "source", "line", "phrase"),
    [
        ("page.md", "# A page\n\nThe manual\nof the maker.\n", 4, "maker"),
        ("header.h", "int a;\n/* A position that\n * counts on. */\n", 2, "that counts on"),
        ("module.py", 'def f():\n    """Return it.\n\n    A sound frame.\n    """\n', 4, "sound frame"),
        ("command.py", 'def f():\n    print(f"the CRC of {f} has to be zero")\n', 2, "has to be"),
        ("spec.yaml", "meaning: >-\n  The bit is\n  low active.\n", 3, "low active"),
    ],
)
def test_a_planted_phrase_is_found(tmp_path: Path, name: str, source: str, line: int, phrase: str) -> None:
    planted = tmp_path / name
    planted.write_text(source, encoding="utf-8")
    found_phrases = [finding for text in texts(planted) for finding in findings(tmp_path, planted, text)]
    assert [finding.split(": better")[0] for finding in found_phrases] == [f"{name}:{line}: '{phrase}'"]


def test_what_a_manual_prints_is_a_quotation(tmp_path: Path) -> None:
    (tmp_path / "spec.yaml").write_text("printed: the bit is low active\nwhy: 'Printed \"is low active\" there.'\n")
    (tmp_path / "page.md").write_text('The manual has "low active", as in `low active`.\n')
    for path in tmp_path.iterdir():
        for text in texts(path):
            assert list(findings(tmp_path, path, text)) == []


def test_only_a_message_may_join_cause_and_remedy(tmp_path: Path) -> None:
    """Docstrings and help texts are prose."""
    (tmp_path / "check.py").write_text(
        'def f():\n    """Return it; it is here."""\n    add(x, help="list all of it; none")\n'
        '    report("it is even; write 0x43")\n'
    )
    (tmp_path / "docs" / "transcribe").mkdir(parents=True)
    (tmp_path / "docs/transcribe/rules-a-to-c.md").write_text(
        "# Rules\n\nA page; a list.\n\n## crc\n\nit is even; write 3\n\nIt; is.\n"
    )
    texts_of = {path.name: list(texts(path)) for path in tmp_path.rglob("*.*")}
    assert [text.words for text in texts_of["check.py"] if text.message] == ["it is even; write 0x43"]
    assert [text.words.strip() for text in texts_of["rules-a-to-c.md"] if text.message] == ["it is even; write 3"]
    words, measured = densities([text for text in texts_of["rules-a-to-c.md"] if not text.heading])
    assert (words, measured["semicolon"]) == (10, 200)


def test_densities_leave_out_headings_questions_and_code() -> None:
    samples = [Text(1, "# What it is", heading=True), Text(3, "What is it? It is ····. What it is; that is said.")]
    words, measured = densities(samples)
    assert words == 8
    assert measured == {"headless what/where/whether clause": 125, "told/said": 125, "stands": 0, "semicolon": 125}
