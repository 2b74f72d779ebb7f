"""The page of words: later words of the spec language, with their encoders and their cost.

``make words-page`` writes the page. It counts encoders in ``specs/`` and files in the history of the repository.
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from itertools import chain
from typing import Any, NamedTuple

from codewheel.language.schemas import load_schema
from codewheel.say.text import escape, table
from spec_words import ROOT, nodes_of, read_specs

PAGE = ROOT / "docs/trust/words.md"
CODE = ("generator/", "templates/", "runtime/")
#: Encoders that are named. If more use a word, the page has only their number.
_MOST_NAMED = 4

_INTRODUCTION = """\
<!-- Generated from the specs and the history of the repository by: make words-page -->

# Words of the spec language and their cost

Words that were added after the first encoders. The last column counts the files in `generator/`, `templates/` and
`runtime/`, without schemas, in the commits that added the word. Compare a new word with a similar one, and with the
number of encoders that would use it. A word without an encoder is shown only on test specs.
["How to add a word"](../extend/how-to-change.md#add-a-word) lists the steps."""


class Uses(NamedTuple):
    """The words of the spec language in the spec of an encoder, and the fields of its frames and registers."""

    words: set[str]
    fields: list[dict[str, Any]]


class Word(NamedTuple):
    """A word, the test that finds it in a spec, and the commits that added it."""

    name: str
    is_used: Callable[[Uses], bool]
    commits: tuple[str, ...]


def _any_of(*words: str) -> Callable[[Uses], bool]:
    return lambda uses: not uses.words.isdisjoint(words)


def _has_optional_flag_or_parity(uses: Uses) -> bool:
    bits = [field.get("bits") for field in uses.fields if "active" in field or "parity_of" in field]
    return any(isinstance(width, str) for width in bits)


def _has_optional_crc(uses: Uses) -> bool:
    return any(isinstance(field.get("bits"), str) for field in uses.fields if "crc" in field)


WORDS = (
    Word("`over`: parity over alternate bits", _any_of("field.over"), ("6120ac30b",)),
    Word("`crc_of`: a CRC over a part of a frame", _any_of("field.crc_of"), ("45d61611b",)),
    Word("`others: reserved`", _any_of("field.others"), ("cf41ff4f3",)),
    Word("`scale`: a quantity with its unit", _any_of("field.scale"), ("27b5fc87f",)),
    Word("`step_nm`, `per_counts`", _any_of("measurement.step_nm"), ("819952881",)),
    Word("`by_code`: a width given by a code in a register", _any_of("parameter.by_code"), ("aebec4036",)),
    Word("`spi`: requests, replies and registers", _any_of("interfaces.spi"), ("244d2f84f",)),
    Word("`exchanges` over RS-485", _any_of("rs485.exchanges"), ("2ee0d9604", "a20e78e2a")),
    Word("`used_hz`: a clock in use, not a limit", _any_of("clock.used_hz"), ("0d8d0d8d1",)),
    Word("`position_range` of a layout", _any_of("layout.position_range"), ("b638ccfcf",)),
    Word("`makes_position` of a value", _any_of("values.makes_position"), ("9a0d32916",)),
    Word("`combinations` of fields", _any_of("layout.combinations"), ("9a0d32916",)),
    Word("`makes_position_if`: a verdict given by an answer", _any_of("field.makes_position_if"), ("304c7d089",)),
    Word("a flag or parity bit selected by order code", _has_optional_flag_or_parity, ("4b647a9ac",)),
    Word("a CRC selected by order code", _has_optional_crc, ("9ae9f004a", "20db94950")),
    Word(
        "a clock or timeout selected by order code",
        _any_of("clock.only", "timeout.only"),
        ("0b57bd23e", "fd701d2d7"),
    ),
    Word("`byte_order` of a field", _any_of("field.byte_order"), ("b7bb7ba52", "9f89605e4")),
    Word(
        "`at_most_hz`: an inclusive clock limit by cable length",
        _any_of("ssi.cable_lengths.at_most_hz"),
        ("85386d1b7", "56437877e"),
    ),
    Word("`excess`: Gray excess", _any_of("layout.gray.excess"), ("080d1a243",)),
    Word(
        "`channels`: several in one BiSS frame",
        _any_of("biss.channels"),
        ("34cc72793", "afe1c2fd4", "061b87834", "ad1dad26f"),
    ),
)


def encoders_by_word() -> dict[str, list[str]]:
    """Return the families of ``specs/`` that use each word."""
    schema = load_schema("device")
    families: dict[str, list[str]] = {word.name: [] for word in WORDS}
    for spec in chain.from_iterable(read_specs().values()):
        nodes = list(nodes_of(schema, [spec]))
        words = set(chain.from_iterable(node.words for node in nodes))
        fields = chain.from_iterable(node.maps for node in nodes if node.owner == "field")
        uses = Uses(words, list(fields))
        for word in WORDS:
            if word.is_used(uses):
                families[word.name].append(spec["device"])
    return families


def changed_files(commits: tuple[str, ...]) -> set[str]:
    """Return the files that commits changed, from the history of the repository."""
    command = ["git", "show", "--format=", "--name-only", *commits]
    return set(subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout.split())


def encoders_cell(families: list[str]) -> str:
    """Return the names of a few encoders, the number of many, or a dash."""
    return ", ".join(families) if 0 < len(families) <= _MOST_NAMED else str(len(families) or "–")


def words_page() -> str:
    families = encoders_by_word()
    rows = []
    for word in WORDS:
        files = changed_files(word.commits)
        code = [file for file in files if file.startswith(CODE) and not file.endswith(".json")]
        rows.append((word.name, escape(encoders_cell(families[word.name])), str(len(code))))
    return f"{_INTRODUCTION}\n\n{table(['Word', 'Encoders', 'Changed files'], rows)}\n"


if __name__ == "__main__":
    PAGE.write_text(words_page(), encoding="utf-8")
