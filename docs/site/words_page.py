"""The page of words: later words of the spec language, with their encoders and their cost.

``make words-page`` writes the page. It counts encoders in ``specs/`` and files in the history of the repository.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from codewheel.say.markdown import escape, table

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/trust/words.md"
SCHEMA = ROOT / "generator/language/device.schema.json"
CODE = ("generator/", "templates/", "runtime/")
#: Encoders that are named. If more use a word, the page has only their number.
_MOST_NAMED = 4

_INTRODUCTION = """\
<!-- Generated from the specs and the history of the repository by: make words-page -->

# Words of the spec language and their cost

Words that were added after the first encoders. The last column counts the files in `generator/`, `templates/` and
`runtime/`, without schemas, in the commits that added the word. Compare a new word with a similar one, and with the
number of encoders that would use it. A word without an encoder is shown only on test specs.
[How to add a word](../extend/how-to-change.md#add-a-word) lists the steps."""


@dataclass(frozen=True)
class Use:
    """A map in a spec that the schema names, such as a field or a clock."""

    kind: str
    data: dict[str, Any]


@dataclass(frozen=True)
class Word:
    """A word, the test that finds it in a spec, and the commits that added it."""

    name: str
    is_used: Callable[[Use], bool]
    commits: tuple[str, ...]


def _key(kind: str, key: str) -> Callable[[Use], bool]:
    return lambda use: use.kind == kind and key in use.data


def _has_optional_flag_or_parity(use: Use) -> bool:
    is_bit = "active" in use.data or "parity_of" in use.data
    return use.kind == "field" and is_bit and isinstance(use.data.get("bits"), str)


def _has_optional_crc(use: Use) -> bool:
    return use.kind == "field" and "crc" in use.data and isinstance(use.data.get("bits"), str)


def _has_facts_by_code(use: Use) -> bool:
    return any(isinstance(use.data.get(key), list) for key in ("clock", "timeout"))


def _has_verdict_by_value(use: Use) -> bool:
    values = use.data.get("values") if use.kind == "field" else None
    return isinstance(values, dict) and any("makes_position" in value for value in values.values())


WORDS = (
    Word("`over`: parity over every other bit", _key("field", "over"), ("6120ac30b",)),
    Word("`crc_of`: a CRC over a part of a frame", _key("field", "crc_of"), ("45d61611b",)),
    Word("`others: reserved`", _key("field", "others"), ("cf41ff4f3",)),
    Word("`scale`: a quantity with its unit", _key("field", "scale"), ("27b5fc87f",)),
    Word("`step_nm`, `per_counts`", _key("measurement", "step_nm"), ("819952881",)),
    Word("`by_code`: a width by a code in a register", _key("parameter", "by_code"), ("aebec4036",)),
    Word("`spi`: requests, replies and registers", _key("interfaces", "spi"), ("244d2f84f",)),
    Word("`exchanges` over RS-485", _key("rs485", "exchanges"), ("2ee0d9604", "a20e78e2a")),
    Word("`used_hz`: a clock in use, not a limit", _key("clock", "used_hz"), ("0d8d0d8d1",)),
    Word("`position_range` of a layout", _key("layout", "position_range"), ("b638ccfcf",)),
    Word("`makes_position` of a value", _has_verdict_by_value, ("9a0d32916",)),
    Word("`combinations` of fields", _key("layout", "combinations"), ("9a0d32916",)),
    Word("`makes_position_if`: a verdict by an answer", _key("field", "makes_position_if"), ("304c7d089",)),
    Word("a flag or parity bit by order code", _has_optional_flag_or_parity, ("4b647a9ac",)),
    Word("several CRCs by order code", _has_optional_crc, ("9ae9f004a", "20db94950")),
    Word("clock or time-out by order code", _has_facts_by_code, ("0b57bd23e", "fd701d2d7")),
    Word("`excess`: Gray excess", _key("gray", "excess"), ("080d1a243",)),
    Word(
        "`channels`: several in one BiSS frame",
        _key("biss", "channels"),
        ("34cc72793", "afe1c2fd4", "061b87834", "ad1dad26f"),
    ),
)


def encoders_by_word() -> dict[str, list[str]]:
    """Return the families of ``specs/`` that use each word."""
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    families: dict[str, list[str]] = {word.name: [] for word in WORDS}
    for path in sorted(ROOT.glob("specs/*/*.yaml")):
        spec = yaml.safe_load(path.read_text(encoding="utf-8"))
        # Second readings have the name of the family, too.
        if "device" not in spec or ".second" in path.name:
            continue
        uses = list(_uses(schema, spec, "device", schema["$defs"]))
        for word in WORDS:
            if any(word.is_used(use) for use in uses):
                families[word.name].append(spec["device"])
    return families


def _uses(schema: dict[str, Any], data: Any, kind: str, definitions: dict[str, Any]) -> Iterator[Use]:
    """Yield each map of a spec with its name in the schema, or with its key if the schema describes it in place."""
    if "$ref" in schema:
        kind = schema["$ref"].rsplit("/", 1)[-1]
        schema = definitions[kind]
    if isinstance(data, list):
        for entry in data:
            yield from _uses(schema.get("items", schema), entry, kind, definitions)
    elif isinstance(data, dict):
        yield Use(kind, data)
        for key, value in data.items():
            key_schema = schema.get("properties", {}).get(key) or schema.get("additionalProperties")
            if isinstance(key_schema, dict):
                yield from _uses(key_schema, value, key, definitions)


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
