"""Report of a campaign: a table by class of fact, and every mutant that passes, with the reason."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath

from codewheel.language.files import is_second

from .campaign import TriedMutant
from .effects import Effect
from .mistakes import code_span
from .places import MOST, MOST_IN_BOTH, STRICT, WITNESSES
from .reasons import explanation, reason
from .trial import Trial

#: Effects that leave every output correct.
_EQUIVALENT = frozenset((Effect.NOTHING.value, Effect.ORDER.value))
_HEADINGS = ("mutants", "refused", "same", "left out", "texts", "code", "wrong")


@dataclass
class Row:
    """Mutants of a class: their number and their results.

    Attributes:
        same: Mutants that change no output, or only an order that has no meaning.
        left_out: Mutants that pass and only omit something, so that no output is wrong.
        texts: Mutants that pass with a wrong value that is only in texts.
        code: Mutants that pass with a wrong value in code.
    """

    mutants: int = 0
    refused: int = 0
    same: int = 0
    left_out: int = 0
    texts: int = 0
    code: int = 0

    @property
    def wrong(self) -> float:
        """Return the share of wrong values that pass. Mutants that change nothing are not counted."""
        return (self.texts + self.code) / max(self.mutants - self.same, 1)

    def cells(self) -> tuple[str, ...]:
        numbers = (self.mutants, self.refused, self.same, self.left_out, self.texts, self.code)
        return (*map(str, numbers), f"{self.wrong:.1%}")


@dataclass(frozen=True)
class Passed:
    """A mutant that passes: its reason, place and effect."""

    reason: str
    place: str
    difference: str
    effect: str


class Outcome:
    """The outcome of a campaign.

    Attributes:
        rows: The table by class. ``second readings`` is a separate class.
        passed: Every mutant that passes and changes something, ordered by place.
        crashes: Crashes of the tool itself.
    """

    def __init__(self, trial: Trial, tried_mutants: Iterable[TriedMutant]) -> None:
        self.rows: dict[str, Row] = {}
        self.passed: list[Passed] = []
        self.crashes: list[str] = []
        for tried in tried_mutants:
            self._add(trial, tried)
        self.passed.sort(key=lambda passed: (passed.reason, passed.place, passed.difference))

    def _add(self, trial: Trial, tried: TriedMutant) -> None:
        mutant, word = tried.mutant, tried.verdict.word
        row = self.rows.setdefault("second readings" if is_second(mutant.file) else mutant.fact, Row())
        row.mutants += 1
        if word == "refused":
            row.refused += 1
        elif word in _EQUIVALENT:
            row.same += 1
        elif word == "crash":
            self.crashes.append(f"{trial.place(mutant)}: {mutant.difference}: {tried.verdict.crash}")
        else:
            self._add_passed(trial, tried, row)

    def _add_passed(self, trial: Trial, tried: TriedMutant, row: Row) -> None:
        mutant, effect = tried.mutant, tried.verdict.effect
        if mutant.is_left_out or effect is Effect.READING:
            row.left_out += 1
        elif effect is Effect.TEXTS:
            row.texts += 1
        else:
            row.code += 1
        name = reason(mutant)
        self.passed.append(Passed(name, trial.place(mutant), f"{mutant.mistake}: {mutant.difference}", effect.value))

    @property
    def gaps(self) -> list[Passed]:
        """Return the mutants that pass and have no reason."""
        return [passed for passed in self.passed if not passed.reason]

    def of(self, classes: Iterable[str]) -> Row:
        """Return the sum of several classes."""
        total = Row()
        for name in classes:
            for key, number in vars(self.rows.get(name, Row())).items():
                setattr(total, key, getattr(total, key) + number)
        return total

    def sums(self) -> Iterator[tuple[str, Row]]:
        """Yield the sums below the table."""
        yield "classes with *", self.of(self._classes & STRICT)
        yield "all classes", self.of(self._classes)

    @property
    def _classes(self) -> set[str]:
        return set(self.rows) - {"second readings"}


def table(outcome: Outcome) -> list[str]:
    """Return the table of a campaign as Markdown. An asterisk marks classes in which no mutant may pass."""
    rows = [("class", _HEADINGS), ("---", ("---:",) * len(_HEADINGS))]
    rows += [(f"{name}{' *' * (name in STRICT)}", outcome.rows[name].cells()) for name in _sorted_classes(outcome.rows)]
    rows += [(f"**{name}**", row.cells()) for name, row in outcome.sums()]
    width = max(len(name) for name, _ in rows)
    lines = []
    for name, cells in rows:
        padded_cells = [f"{cell:>8}" for cell in cells]
        lines.append(f"| {name:<{width}} | {' | '.join(padded_cells)} |")
    return lines


def _sorted_classes(names: Iterable[str]) -> list[str]:
    return sorted(names, key=lambda name: (name not in STRICT, name in WITNESSES, name.casefold()))


def exceeded(outcome: Outcome, most: Mapping[str, float] = MOST) -> list[str]:
    """Return one line for each class of which more wrong values pass than allowed."""
    rows = {**outcome.rows, **dict(outcome.sums())}
    shares = {name: rows[name].wrong for name in most if name in rows}
    excessive = {name: share for name, share in shares.items() if share > most[name]}
    return [f"{name}: {share:.1%} pass, at most {most[name]:.0%} may" for name, share in excessive.items()]


def _joined_words(words: Iterable[str]) -> str:
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def survivors(outcome: Outcome) -> Iterator[str]:
    """Yield every mutant that passes, grouped by reason, as Markdown."""
    counts = Counter(passed.reason for passed in outcome.passed)
    for name in sorted(counts):
        yield f"## {name or 'without a reason'}: {counts[name]}"
        yield ""
        if name:
            yield explanation(name)
            yield ""
        passed_mutants = (passed for passed in outcome.passed if passed.reason == name)
        yield from (f"- {code_span(passed.place)} {passed.difference} ({passed.effect})" for passed in passed_mutants)
        yield ""


def survivors_in_both(both: Outcome) -> Iterator[str]:
    """Yield every mutant that passes with the same mistake in both readings, as Markdown."""
    yield f"## in both readings: {len(both.passed)}"
    yield ""
    for passed in sorted(both.passed, key=lambda passed: (passed.place, passed.difference)):
        yield f"- {code_span(passed.place)} {passed.difference} ({passed.effect})"


def _introduction(command: str, files: Sequence[str], reversed_words: tuple[int, int]) -> str:
    """Return the beginning of the page. See ``page`` for the arguments."""
    words, words_with_gap = reversed_words
    return f"""\
# Mutants

This page shows which transcription mistakes `check` detects. `{command}` plants mistakes, one at a time, in
{_joined_words(map(code_span, files))}, and runs `check` on each. The command writes this page, so do not edit it.

A mistake is a lost, swapped or misread digit, an extra zero, a number that is off by one, a flipped bit or boolean, a
different word from a list, a different name, a lost letter in a name, an omitted item or key, two items in the wrong
order, a value swapped with that of the next item, or a reversed word in a text (*before* for *after*, or a dropped
*not*). Mutants in the column *same* change no output, or only an order that has no meaning. Mutants in *left out* pass,
but no output is wrong. *Texts* counts wrong values that pass and reach only documents, *code* those that reach code.
*Wrong* is their percentage of all mutants except *same*. In classes with *, a wrong value moves a position, breaks a
check or an access, or comes at the wrong time. No such mutant may pass.

The last row includes every class. A *characteristic, hazard* has a quantity that can damage hardware: supply, battery,
torque, current, clearance, clock or temperature. A *cited page* is a page in a section for which the table of contents
gives pages. A *page without contents* is compared with the nearest pages that the contents give. A *place in another
document* is compared with the contents of its spec, or with the pages that the spec lists for the document.

In the first table, each mistake is in one file. [The second table](#the-same-mistake-in-both-readings) has mistakes in
both readings. Sheets do not contain words without an opposite, such as *speed* for *position*. Such words are checked
by reading the spec.

A sheet repeats each text of the spec, so `check` reports a word that is reversed after the sheet was written even if
the word has no gap. If the word was reversed before, only its gap shows the mistake. Of all {words:,} words that can be
reversed in a text of these specs, {words_with_gap:,} have a gap ({words_with_gap / words:.0%}). The others are a lost
*not*, and words that have no opposite in the sheets.
"""


#: Introduction of the table with mistakes in both readings.
_IN_BOTH = f"""\
## The same mistake in both readings

If the same mistake is in the spec and in its second reading, only facts that are repeated elsewhere reveal it: in an
example, in the order code, in another table, or in the specs of the same manufacturer. The mistakes are those of the
first table, at places with the same value in both files, except words. Sheets of turning words are not compared here,
because they repeat the texts of the spec. At most {MOST_IN_BOTH["all classes"]:.0%} of the wrong values may pass, and
none of a *pin*.

No rule can find a word that is reversed both in a text and in its sheet, or two flags that are swapped in both
readings.
"""


def page(outcome: Outcome, both: Outcome, command: str, files: Sequence[str], reversed_words: tuple[int, int]) -> str:
    """Return the page of a campaign with mistakes in one file, and of one with the same mistakes in both readings.

    ``reversed_words`` are the number of all words that can be reversed, and the number of those with a gap in a sheet.
    """
    introduction = _introduction(command, files, reversed_words)
    of_one = [introduction, *table(outcome), "", _IN_BOTH, *table(both), "", *survivors(outcome)]
    return "\n".join([*of_one, *survivors_in_both(both)]).rstrip() + "\n"


def file_name(path: str) -> str:
    """Return the name of a file on the page."""
    return PurePath(path).name
