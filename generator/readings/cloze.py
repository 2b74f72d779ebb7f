"""Clozes: sheets with the texts of a spec in which the words that turn a sentence round are gaps.

A reader fills the gaps from the manual alone. ``check`` compares the fillings with the words of the spec.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path as File
from typing import Any, NamedTuple

from ..language.document import Document, Path
from ..language.problems import ProblemReport, quoted
from ..language.read import read_document
from ..language.schema_check import FileKind, check_schema
from ..language.schema_files import word_sheet_path
from ..loading.overlays import Family
from ..say.plain_text import count_with_unit
from .texts import dotted_path, is_source, prose_texts

RULE = "words-disagree"
OUTDATED_RULE = "words-outdated"
#: Parts whose texts no reader can fill in from the manual, because they are about other documents.
_LEFT_OUT = frozenset("documents editions evidence lost_figures".split())
#: Kinds of words. Each line has the senses of a kind, separated by bars, and each sense has words, separated by commas.
#: Words of one sense can replace each other. A reader fills in the first word.
_REPLACEABLE_WORDS = """\
negation: not, no, never, none, nothing, neither, nor, without, non, no longer | always
modal: must, should, shall, has to, have to | may, can, could, might | must not, should not, may not | cannot, can not
order: before, prior to, previous, until | after, afterwards, following, next, since
place: above, over the limit | below, under, beneath
bound: at least, minimum, lowest, smallest, shortest, min | at most, maximum, highest, largest, longest, up to, max
amount: more, greater, larger, longer, higher, bigger, too high, too large, exceeds | \
less, fewer, smaller, shorter, lower, too low, too small
rotation: clockwise | counter-clockwise, counterclockwise, anticlockwise, anti-clockwise
level: high | low
switch: on | off
opening: open, opened, opens | closed, close, closes
report: error, errors, fault, faults | warning, warnings
change: increase, increases, increased, increasing, rises, rising, up | \
decrease, decreases, decreased, decreasing, falls, falling, down
side: left | right
connection: connected, connect, connects | disconnected, disconnect, disconnects, unconnected
inside: internal, inner, inside | external, outer, outside
sign: positive, plus | negative, minus
activity: active, activated, activate, activates, enabled, enable, enables | \
inactive, deactivated, deactivate, deactivates, disabled, disable, disables
colour: white | black | brown | green | yellow | grey | pink | blue | red | violet | orange | purple
"""
#: Kind of the signals of the connectors, which differ between families.
SIGNAL = "signal"
#: Words that are turning words only after one of these words. Elsewhere they are prepositions.
_ONLY_AFTER = {
    "on": "power- switch- power turn turned switch switched powered lit is are stays remains".split(),
    "up": ["count", "counts", "counting"],
    "down": ["count", "counts", "counting"],
}


class _SpecText(NamedTuple):
    """A text of a spec with gaps, and its place."""

    place: Path
    cloze: ClozeText


def clozes(spec: Document) -> dict[str, _SpecText]:
    """Return the texts of a spec that have gaps, by their paths: ``registers.mode.meaning``.

    A path that several texts share gets a number from the second one on: ``tables.limits.note 2``.
    """
    vocabulary = vocabulary_of(spec)
    spec_texts: dict[str, _SpecText] = {}
    for place, text in chain(prose_texts((), spec.data), _led_states(spec)):
        if place[0] in _LEFT_OUT or is_source(place[-1]):
            continue
        cloze = vocabulary.cloze(text)
        if cloze.gaps:
            path = dotted_path(place)
            repetition = 1
            while path in spec_texts:
                repetition += 1
                path = f"{dotted_path(place)} {repetition}"
            spec_texts[path] = _SpecText(place, cloze)
    return spec_texts


def _led_states(spec: Document) -> Iterator[tuple[Path, str]]:
    """Yield the words of each state of the LEDs, which a second reading repeats in the words of the spec."""
    for led in spec.data.get("leds", ()):
        for index, led_state in enumerate(led["states"]):
            yield ("leds", led["name"], "states", index, "state"), str(led_state["state"])


def vocabulary_of(spec: Document) -> Vocabulary:
    """Return the turning words of a family: the turning words of the language, and the signals of its contacts."""
    signals: list[str] = []
    for connector in spec.data.get("connectors", ()):
        signals += [str(contact["signal"]) for contact in connector["contacts"] if "signal" in contact]
    return Vocabulary(signals)


def sheet(spec: Document, old_entries: Mapping[str, Any]) -> dict[str, Any]:
    """Return the sheet for a spec: the choices of each kind, and each text with its filled words or question marks.

    Filled words of ``old_entries``, which are by path, are kept if the same path or any other has the same text.
    """
    sheet_entries: dict[str, Any] = {}
    kinds: set[str] = set()
    choices = vocabulary_of(spec).choices
    # A text can move with the name of its part.
    old_entry_by_text = {old_entry["text"]: old_entry for old_entry in old_entries.values()}
    for path, (_, cloze) in clozes(spec).items():
        kinds.update(gap.kind for gap in cloze.gaps)
        sheet_entry = old_entries.get(path, {})
        if sheet_entry.get("text") != cloze.text:
            unfilled_words = ["?"] * len(cloze.gaps)
            sheet_entry = old_entry_by_text.get(cloze.text, {"text": cloze.text, "words": unfilled_words})
        sheet_entries[path] = {**sheet_entry, "words": _valid_words(cloze, sheet_entry["words"], choices)}
    choices_of_kinds = {kind: list(words) for kind, words in choices.items() if kind in kinds}
    return {"choices": choices_of_kinds, "texts": sheet_entries}


def _valid_words(cloze: ClozeText, words: Sequence[str], choices: Mapping[str, Sequence[str]]) -> list[str]:
    """Return the word of each gap, with a question mark for one that is missing or no longer a choice.

    A renamed signal, for example, is no longer a choice.

    ``choices`` are the valid words by kind of gap.
    """
    enough_words = [*words, *["?"] * len(cloze.gaps)]
    return [word if word in choices[gap.kind] else "?" for gap, word in zip(cloze.gaps, enough_words, strict=False)]


def open_gaps(sheet_data: Mapping[str, Any]) -> int:
    """Return the number of gaps that are not filled."""
    return sum(text["words"].count("?") for text in sheet_data["texts"].values())


#: Function that reads the sheet of a family, if it has a sheet, and adds its problems to the report.
Reader = Callable[[Family, ProblemReport], Document | None]


def read_sheet(family: Family, report: ProblemReport) -> Document | None:
    """Return the sheet next to the spec of a family, or None if there is none or it has problems."""
    file = word_sheet_path(File(family.document.file))
    document = read_document(file, report) if file.is_file() else None
    if document is None:
        return None
    problem_count_before = len(report)
    checked_data = check_schema(document, report, FileKind.WORDS)
    has_new_problems = len(report) != problem_count_before
    return document if checked_data is not None and not has_new_problems else None


def check_sheets(
    families: Iterable[Family], sound: Collection[str], report: ProblemReport, read: Reader = read_sheet
) -> None:
    """Compare families with their sheets, and report the differences. A family without a sheet is skipped.

    A sheet is always checked, but only compared if its spec is among the ``sound`` files. A sheet is filled from the
    manual alone, so the family is compared without overlays, and a derived family has no sheet.
    """
    for loaded_family in families:
        family = loaded_family.plain or loaded_family
        is_derived = bool(family.device.base)
        sheet_document = read(family, report) if not is_derived else None
        if sheet_document is not None and family.document.file in sound:
            compare_words(family.document, sheet_document, report)


def compare_words(spec: Document, sheet_document: Document, report: ProblemReport) -> None:
    """Report each gap that the sheet fills with a word other than the spec's, and each outdated text of the sheet.

    A text is outdated if only the spec has it, or if it has changed. Texts that only the sheet has are not reported in
    addition, since the command that refills the sheet also removes them.
    """
    spec_texts = clozes(spec)
    sheet_texts = sheet_document.data["texts"]
    is_outdated = False
    sheet_name = File(sheet_document.file).name
    for path, (place, cloze) in spec_texts.items():
        filled_text = sheet_texts.get(path)
        if filled_text is None:
            word_count_text = count_with_unit(len(cloze.gaps), "turning word")
            message = f"{sheet_name} lacks this text, which has {word_count_text}; {_advice_to_refill(spec)}"
            report.add(OUTDATED_RULE, spec, place, message, cause=sheet_name)
            is_outdated = True
        elif filled_text["text"] != cloze.text or len(filled_text["words"]) != len(cloze.gaps):
            line, _ = sheet_document.position(("texts", path))
            message = f"this text has changed since {sheet_name}:{line} was filled; {_advice_to_refill(spec)}"
            report.add(OUTDATED_RULE, spec, place, message, cause=sheet_name)
            is_outdated = True
        else:
            _compare_gaps(spec, place, cloze, sheet_document, ("texts", path), report)
    if is_outdated:
        return
    for path in sheet_texts:
        if path not in spec_texts:
            message = f"the spec has no such text with turning words; {_advice_to_refill(spec)}"
            report.add(OUTDATED_RULE, sheet_document, ("texts", path), message, at_key=True, cause=sheet_name)


def _advice_to_refill(spec: Document) -> str:
    return f"run 'codewheel cloze {File(spec.file).stem}' and fill it again from the manual"


def _compare_gaps(
    spec: Document, place: Path, cloze: ClozeText, sheet_document: Document, sheet_place: Path, report: ProblemReport
) -> None:
    """Report each gap of a text that the sheet fills with another word than the first word of the sense in the spec.

    A word that is not among the choices, such as a question mark, makes the sheet outdated.
    """
    # ``sheet_place`` is ("texts", path).
    words: Sequence[str] = sheet_document.data["texts"][sheet_place[1]]["words"]
    choices = sheet_document.data["choices"]
    for number, (gap, word) in enumerate(zip(cloze.gaps, words, strict=True), 1):
        word_place = (*sheet_place, "words", number - 1)
        if word == gap.word:
            continue
        if word not in choices.get(gap.kind, ()):
            valid_words = ", ".join(choices.get(gap.kind, ()))
            message = f"gap {number} has {quoted(word)}; valid values for {gap.kind}: {valid_words}"
            report.add(OUTDATED_RULE, sheet_document, word_place, message, cause=str(word))
            continue
        line, _ = sheet_document.position(word_place)
        sheet_text = f"{quoted(word)} in {File(sheet_document.file).name}:{line}"
        context = _text_around_gap(cloze, number)
        message = f"{context}: {quoted(gap.word)} here, {sheet_text}; check the manual and correct one of them"
        # Two exchanged signals differ in many texts, so they are reported as one cause.
        cause = f"{gap.word} {word}" if gap.kind == SIGNAL else ""
        report.add(RULE, spec, place, message, cause=cause)


#: Number of characters of a text shown on each side of a gap.
_CONTEXT_CHARACTERS = 30
#: A gap in a text, such as ``{2 order}``.
_GAP_IN_TEXT = re.compile(r"\{(\d+) (\w+)\}")


def _text_around_gap(cloze: ClozeText, gap_number: int) -> str:
    """Return up to 30 characters on each side of a gap, in quotes: ``"the position [change] when turned clockwise"``.

    The gap is shown as its kind. Other gaps have their words.
    """

    def fill_gaps(text: str) -> str:
        return _GAP_IN_TEXT.sub(lambda gap: cloze.gaps[int(gap[1]) - 1].word, text)

    text_before, text_behind = re.split(rf"\{{{gap_number} \w+\}}", cloze.text, maxsplit=1)
    before = fill_gaps(text_before)[-_CONTEXT_CHARACTERS:]
    behind = fill_gaps(text_behind)[:_CONTEXT_CHARACTERS]
    kind = cloze.gaps[gap_number - 1].kind
    return quoted(f"{before}[{kind}]{behind}".strip())


def as_lines(sheet_data: Mapping[str, Any], spec_name: str) -> Iterator[str]:
    """Yield the lines of a sheet as a YAML file: choices by kind, and text and words by path."""
    yield f"# Turning words of {spec_name}. Fill each '?' from the manual alone, with one of the choices of its kind."
    yield "choices:"
    for kind, words in sheet_data["choices"].items():
        yield f"  {kind}: [{', '.join(map(_in_quotes, words))}]"
    yield "texts:"
    for path, sheet_entry in sheet_data["texts"].items():
        yield f"  {_in_quotes(path)}:"
        yield f"    text: {_in_quotes(sheet_entry['text'])}"
        yield f"    words: [{', '.join(map(_in_quotes, sheet_entry['words']))}]"
        if "not_read" in sheet_entry:
            yield f"    not_read: {_in_quotes(sheet_entry['not_read'])}"


def _in_quotes(text: str) -> str:
    """Return a text as a YAML scalar in double quotes."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


class Gap(NamedTuple):
    """A gap in a text. ``word`` is the word that fits, the first one of its sense."""

    kind: str
    word: str


class ClozeText(NamedTuple):
    """A text with numbered gaps, and its gaps."""

    text: str
    gaps: tuple[Gap, ...]


class Vocabulary:
    """The turning words of a family: the turning words of the language, and the signals on its connectors."""

    def __init__(self, signals: Iterable[str]) -> None:
        #: The kind of each word, and the first word of its sense.
        self._senses: dict[str, Gap] = {}
        #: First words of the senses, by kind: ``{"level": ["high", "low"]}``.
        self.choices: dict[str, Sequence[str]] = {}
        for line in _REPLACEABLE_WORDS.splitlines():
            kind, _, senses = line.partition(": ")
            self._add_kind(kind, [sense.split(", ") for sense in senses.split(" | ")])
        # Signals of one or two characters are left out. Each other word is a separate sense.
        self._add_kind(SIGNAL, [[signal] for signal in sorted(set(signals)) if len(signal) > 2])
        # The regular expression takes the first alternative that matches, so "no longer" must come before "no".
        spellings = sorted(self._senses, key=len, reverse=True)
        self._pattern_of_word = re.compile(
            rf"(?<![\w/])(?:{'|'.join(map(_pattern_of_word, spellings))})(?!\w)", re.IGNORECASE
        )

    def _add_kind(self, kind_of_turn: str, senses: Sequence[Sequence[str]]) -> None:
        """Add the words of each sense. A word of several kinds belongs to the first kind."""
        self.choices[kind_of_turn] = [words[0] for words in senses]
        for words in senses:
            for word in words:
                self._senses.setdefault(word.casefold(), Gap(kind_of_turn, words[0]))

    def cloze(self, text: str) -> ClozeText:
        """Return a text with numbered gaps instead of its turning words, and the gaps.

        For example ``if {1 level} {2 order} the start`` for ``if high before the start``.
        """
        gaps: list[Gap] = []

        def numbered_gap(match: re.Match[str]) -> str:
            gaps.append(self._senses[match[0].casefold()])
            return f"{{{len(gaps)} {gaps[-1].kind}}}"

        text_in_one_line = " ".join(text.split())
        # The substitution also fills the list of gaps.
        return ClozeText(self._pattern_of_word.sub(numbered_gap, text_in_one_line), tuple(gaps))


def _pattern_of_word(word: str) -> str:
    """Return the regular expression of a word.

    A word of ``_ONLY_AFTER`` matches only directly after one of its words: ``(?:(?<=count )|(?<=counts ))up``.
    """
    if word not in _ONLY_AFTER:
        return re.escape(word)
    words_before = (before if before.endswith("-") else f"{before} " for before in _ONLY_AFTER[word])
    return f"(?:{'|'.join(f'(?<={before})' for before in words_before)}){word}"
