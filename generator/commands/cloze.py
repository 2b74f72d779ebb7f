"""``codewheel cloze``: sheets with the texts of a spec in which words that can reverse their meaning are blanks.

A reader fills the blanks from the manual alone. ``check`` compares the words with those in the spec. In the code and in
messages, a blank is a gap, and such a word is a turning word.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path as File
from typing import TYPE_CHECKING, Any, NamedTuple

from ..language.document import Document, Path
from ..language.files import word_sheet_path
from ..language.problems import ProblemReport, quoted
from ..language.read import read_document
from ..language.schema_check import FileKind, check_schema
from ..loading.overlays import Family
from ..readings.stated import dotted_path, is_source, prose_texts
from ..say import count_with_unit
from .cli import Parser, add_specs_option
from .terminal import CommandError, error_after_printing

if TYPE_CHECKING:
    import argparse

EXAMPLES = ("codewheel cloze my_encoder",)


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = (
        "Write FAMILY.words.yaml next to the spec: its texts with gaps in place of words such as 'not', 'before' and "
        "'high'. A reader fills in the gaps from the manual, and check compares the words with the spec. The words of "
        "unchanged texts are kept."
    )
    parser.add_argument("family", metavar="FAMILY", help="a family name as shown by list")
    add_specs_option(parser, "")


def run(arguments: argparse.Namespace) -> int:
    """Write the sheet of a family without overlays, and print the number of gaps to fill in.

    For unchanged texts, the words in an existing sheet are kept.

    Raises:
        CommandError: The family does not exist (exit code 2), it has problems, or its sheet cannot be read (exit code
            1).
    """
    from .facts import family_named
    from .read_specs import specs_to_judge

    paths = specs_to_judge(arguments.specs, "cloze FAMILY").paths
    loaded_family = family_named(arguments.family, paths)
    # ``plain`` is the family without its overlays, if it has any.
    family = loaded_family.without_overlays or loaded_family
    report = ProblemReport()
    filled_sheet = read_sheet(family, report)
    if report:
        raise error_after_printing(report)
    old_entries = filled_sheet.data["texts"] if filled_sheet is not None else {}
    sheet_data = sheet(family.document, old_entries)
    spec_path = File(family.document.file)
    sheet_path = word_sheet_path(spec_path)
    lines = [*as_lines(sheet_data, spec_path.name), ""]  # The empty line ends the last line with a newline.
    try:
        sheet_path.write_text("\n".join(lines), encoding="utf-8")
    except OSError as error:
        raise CommandError(f"cannot write {sheet_path}: {error.strerror or error}", 1) from None
    number_of_gaps = count_with_unit(count_open_gaps(sheet_data), "gap")
    number_of_texts = count_with_unit(len(sheet_data["texts"]), "text")
    print(f"written    {sheet_path.as_posix()}: {number_of_gaps} to fill, in {number_of_texts}")
    return 0


RULE = "words-disagree"
OUTDATED_RULE = "words-outdated"
#: Parts whose texts no reader can fill in from the manual, because they are about other documents.
_SECTIONS_WITHOUT_GAPS = frozenset("documents editions evidence lost_figures".split())
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
access: read, reads, reading | write, writes, written, writing
sequence: first | last
turns: singleturn, single-turn | multiturn, multi-turn
transfer: send, sends, sent, sending, transmit, transmits, transmitted | receive, receives, received, receiving
storage: save, saves, saved, saving, store, stores, stored, storing | load, loads, loaded, loading
setting: set, sets | reset, resets, clear, clears, cleared
extent: start, starts, begin, begins, beginning | end, ends, stop, stops
code: binary | Gray
validity: valid, correct | invalid, incorrect, wrong
sameness: same, equal, equals, identical | different, unequal, differs, differ
port: input, inputs | output, outputs
role: master | encoder
significance: most significant, MSB | least significant, LSB
permission: possible, allowed, permitted | impossible, forbidden, prohibited
loss: kept, keeps, keep | lost, loses, lose
presence: present, available | missing, absent, unavailable
speed: fast, faster | slow, slower
size: long, wide | short, narrow
strength: strong | weak
movement: linear | rotary
arithmetic: add, added, multiply, multiplied | subtract, subtracted, divide, divided
colour: white | black | brown | green | yellow | grey | pink | blue | red | violet | orange | purple
"""
#: Kind of the signals of the connectors, which differ between families.
SIGNAL = "signal"
#: Words that are turning words only after one of these words. Elsewhere they have no opposite, or another meaning.
_ONLY_AFTER = {
    "on": "power- switch- power turn turned switch switched powered lit is are stays remains".split(),
    "up": ["count", "counts", "counting"],
    "down": ["count", "counts", "counting"],
    "master": ["by the", "from the", "to the"],
    "encoder": ["by the", "from the", "to the"],
}


class _SpecTextWithGaps(NamedTuple):
    """A text of a spec with gaps, and its path."""

    spec_path: Path
    cloze: ClozeText


def spec_text_by_path(spec: Document) -> dict[str, _SpecTextWithGaps]:
    """Return the texts of a spec that contain turning words, with gaps in place of these words, by their paths.

    A path is ``registers.mode.meaning``, for example. If several texts share a path, the second one gets a number:
    ``tables.limits.note 2``.
    """
    vocabulary = vocabulary_of(spec)
    text_by_path: dict[str, _SpecTextWithGaps] = {}
    for spec_path, text in chain(prose_texts((), spec.data), _led_states(spec)):
        if spec_path[0] in _SECTIONS_WITHOUT_GAPS or is_source(spec_path[-1]):
            continue
        cloze = vocabulary.cloze(text)
        if cloze.gaps:
            path = dotted_path(spec_path)
            repetition = 1
            while path in text_by_path:
                repetition += 1
                path = f"{dotted_path(spec_path)} {repetition}"
            text_by_path[path] = _SpecTextWithGaps(spec_path, cloze)
    return text_by_path


def _led_states(spec: Document) -> Iterator[tuple[Path, str]]:
    """Yield the text of each state of the LEDs. A second reading of the manual copies these texts from the spec."""
    for led in spec.data.get("leds", ()):
        for index, led_state in enumerate(led["states"]):
            yield ("leds", led["name"], "states", index, "state"), str(led_state["state"])


def vocabulary_of(spec: Document) -> Vocabulary:
    """Return the words of a family that become gaps: words such as not and before, and the signals of its contacts."""
    signals: list[str] = []
    for connector in spec.data.get("connectors", ()):
        signals += [str(contact["signal"]) for contact in connector["contacts"] if "signal" in contact]
    return Vocabulary(signals)


def sheet(spec: Document, old_entries: Mapping[str, Any]) -> dict[str, Any]:
    """Return the sheet for a spec: the choices for each kind of gap, and each text with the word of each gap.

    A gap that is not filled has a question mark. ``old_entries`` are the texts of the existing sheet by path. Their
    words are kept for texts that are unchanged, also if their path has changed.
    """
    sheet_entries: dict[str, Any] = {}
    used_kinds: set[str] = set()
    choices = vocabulary_of(spec).choices
    # The path of a text changes if its part is renamed.
    old_entry_by_text = {old_entry["text"]: old_entry for old_entry in old_entries.values()}
    for path, spec_text in spec_text_by_path(spec).items():
        cloze = spec_text.cloze
        used_kinds.update(gap.kind for gap in cloze.gaps)
        sheet_entry = old_entries.get(path, {})
        if sheet_entry.get("text") != cloze.text:
            unfilled_words = ["?"] * len(cloze.gaps)
            sheet_entry = old_entry_by_text.get(cloze.text, {"text": cloze.text, "words": unfilled_words})
        sheet_entries[path] = {**sheet_entry, "words": _valid_words(cloze, sheet_entry["words"], choices)}
    choices_of_used_kinds = {kind: list(words) for kind, words in choices.items() if kind in used_kinds}
    return {"choices": choices_of_used_kinds, "texts": sheet_entries}


def _valid_words(cloze: ClozeText, words: Sequence[str], choices: Mapping[str, Sequence[str]]) -> list[str]:
    """Return the word of each gap in a text, or a question mark if the word is missing or no longer a choice.

    ``choices`` are the valid words by the kind of the gap. After a signal is renamed, its old name is not a choice.
    """
    valid_words: list[str] = []
    for index, gap in enumerate(cloze.gaps):
        word = words[index] if index < len(words) else "?"
        valid_words.append(word if word in choices[gap.kind] else "?")
    return valid_words


def count_open_gaps(sheet_data: Mapping[str, Any]) -> int:
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
    families: Iterable[Family], valid_files: Collection[str], report: ProblemReport, read: Reader = read_sheet
) -> None:
    """Compare families with their sheets, and report the differences. A family without a sheet is skipped.

    A sheet is always read, but only compared if its spec is among ``valid_files``. It is filled from the manual alone,
    so the family is compared without its overlays. A derived family has no sheet.
    """
    for loaded_family in families:
        family = loaded_family.without_overlays or loaded_family
        is_derived = bool(family.device.base)
        sheet_document = read(family, report) if not is_derived else None
        if sheet_document is not None and family.document.file in valid_files:
            compare_words(family.document, sheet_document, report)


def compare_words(spec: Document, sheet_document: Document, report: ProblemReport) -> None:
    """Report each gap that the sheet fills with a different word than the spec, and each outdated text in the sheet.

    A text is outdated if it is new in the spec or has changed. If there is such a text, texts that are only in the
    sheet are not reported, because the command that refills the sheet also removes them.
    """
    spec_texts = spec_text_by_path(spec)
    sheet_texts = sheet_document.data["texts"]
    is_outdated = False
    sheet_name = File(sheet_document.file).name
    for path, (spec_path, cloze) in spec_texts.items():
        filled_text = sheet_texts.get(path)
        if filled_text is None:
            word_count_text = count_with_unit(len(cloze.gaps), "turning word")
            message = f"this text is not in {sheet_name}, and has {word_count_text}; {_advice_to_refill(spec)}"
            report.add(OUTDATED_RULE, spec, spec_path, message, cause=sheet_name)
            is_outdated = True
        elif filled_text["text"] != cloze.text or len(filled_text["words"]) != len(cloze.gaps):
            line, _ = sheet_document.position(("texts", path))
            message = f"this text has changed since {sheet_name}:{line} was filled; {_advice_to_refill(spec)}"
            report.add(OUTDATED_RULE, spec, spec_path, message, cause=sheet_name)
            is_outdated = True
        else:
            _compare_gaps(spec, spec_path, cloze, sheet_document, ("texts", path), report)
    if is_outdated:
        return
    for path in sheet_texts:
        if path not in spec_texts:
            message = f"the spec has no such text with turning words; {_advice_to_refill(spec)}"
            report.add(OUTDATED_RULE, sheet_document, ("texts", path), message, at_key=True, cause=sheet_name)


def _advice_to_refill(spec: Document) -> str:
    return f"run 'codewheel cloze {File(spec.file).stem}' and fill it again from the manual"


def _compare_gaps(
    spec: Document, spec_path: Path, cloze: ClozeText, sheet_document: Document, sheet_path: Path, report: ProblemReport
) -> None:
    """Report each gap of a text that the sheet fills with a word that has a different meaning than the spec's word.

    A word that is not among the choices, such as a question mark, is reported as outdated.
    """
    _, text_path = sheet_path  # The first step is "texts".
    words: Sequence[str] = sheet_document.data["texts"][text_path]["words"]
    choices = sheet_document.data["choices"]
    for number, (gap, word) in enumerate(zip(cloze.gaps, words, strict=True), 1):
        word_path = (*sheet_path, "words", number - 1)
        if word == gap.word:
            continue
        if word not in choices.get(gap.kind, ()):
            valid_words = ", ".join(choices.get(gap.kind, ()))
            message = f"gap {number} has {quoted(word)}; valid values for {gap.kind}: {valid_words}"
            report.add(OUTDATED_RULE, sheet_document, word_path, message, cause=str(word))
            continue
        line, _ = sheet_document.position(word_path)
        sheet_text = f"{quoted(word)} in {File(sheet_document.file).name}:{line}"
        context = _text_around_gap(cloze, number)
        message = f"{context}: {quoted(gap.word)} here, {sheet_text}; check the manual and correct one of them"
        # If two signals are exchanged, many texts differ for the same cause.
        cause = f"{gap.word} {word}" if gap.kind == SIGNAL else ""
        report.add(RULE, spec, spec_path, message, cause=cause)


#: Number of characters of a text shown on each side of a gap.
_CONTEXT_CHARACTERS = 30
#: A gap in a text, such as ``{2 order}``.
_GAP_IN_TEXT = re.compile(r"\{(\d+) (\w+)\}")


def _text_around_gap(cloze: ClozeText, gap_number: int) -> str:
    """Return a gap with up to 30 characters before and after it, such as ``"the position [change] when turned"``.

    The gap is shown as its kind. Other gaps are filled with their words.
    """

    def fill_gaps(text: str) -> str:
        return _GAP_IN_TEXT.sub(lambda gap: cloze.gaps[int(gap[1]) - 1].word, text)

    text_before, text_after = re.split(rf"\{{{gap_number} \w+\}}", cloze.text, maxsplit=1)
    before = fill_gaps(text_before)[-_CONTEXT_CHARACTERS:]
    after = fill_gaps(text_after)[:_CONTEXT_CHARACTERS]
    kind = cloze.gaps[gap_number - 1].kind
    return quoted(f"{before}[{kind}]{after}".strip())


def as_lines(sheet_data: Mapping[str, Any], spec_name: str) -> Iterator[str]:
    """Yield the lines of a sheet in YAML: the choices by kind of gap, then each text and its words by path."""
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
    """A gap in a text. ``word`` is the correct word, or the first of the words with the same sense."""

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
        self._gap_by_word: dict[str, Gap] = {}
        #: First words of the senses, by kind: ``{"level": ["high", "low"]}``.
        self.choices: dict[str, Sequence[str]] = {}
        for line in _REPLACEABLE_WORDS.splitlines():
            kind, _, senses = line.partition(": ")
            self._add_kind(kind, [sense.split(", ") for sense in senses.split(" | ")])
        # Signals of one or two characters are left out. Each other word is a separate sense.
        self._add_kind(SIGNAL, [[signal] for signal in sorted(set(signals)) if len(signal) > 2])
        # A regular expression matches the first alternative that fits, so "no longer" must come before "no".
        spellings = sorted(self._gap_by_word, key=len, reverse=True)
        self._pattern_of_word = re.compile(
            rf"(?<![\w/])(?:{'|'.join(map(_pattern_of_word, spellings))})(?!\w)", re.IGNORECASE
        )

    def _add_kind(self, kind: str, senses: Sequence[Sequence[str]]) -> None:
        """Add a kind of gap with the words of each sense. A word of several kinds belongs to the first kind."""
        self.choices[kind] = [words[0] for words in senses]
        for words in senses:
            for word in words:
                self._gap_by_word.setdefault(word.casefold(), Gap(kind=kind, word=words[0]))

    def cloze(self, text: str) -> ClozeText:
        """Return a text with numbered gaps in place of its turning words, and the list of gaps.

        For example, ``if high before the start`` becomes ``if {1 level} {2 order} the start``.
        """
        gaps: list[Gap] = []

        def numbered_gap(match: re.Match[str]) -> str:
            gaps.append(self._gap_by_word[match[0].casefold()])
            return f"{{{len(gaps)} {gaps[-1].kind}}}"

        text_on_one_line = " ".join(text.split())
        # The substitution also fills the list ``gaps``.
        text_with_gaps = self._pattern_of_word.sub(numbered_gap, text_on_one_line)
        return ClozeText(text=text_with_gaps, gaps=tuple(gaps))


def _pattern_of_word(word: str) -> str:
    """Return the regular expression for a turning word.

    Some words are only matched directly after certain words: ``(?:(?<=count )|(?<=counts ))up``.
    """
    if word not in _ONLY_AFTER:
        return re.escape(word)
    lookbehinds: list[str] = []
    for word_before in _ONLY_AFTER[word]:
        separator = "" if word_before.endswith("-") else " "
        lookbehinds.append(f"(?<={word_before}{separator})")
    return f"(?:{'|'.join(lookbehinds)}){word}"
