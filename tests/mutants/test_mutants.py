"""Mutants of specs. None passes ``check`` if it moves a position or breaks an access."""

from __future__ import annotations

import pathlib
from collections import Counter
from dataclasses import replace

import pytest
from codewheel.language.document import Document
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from mutation.campaign import drawn, tried
from mutation.effects import Effect
from mutation.mistakes import Mutant, code_span, mutants, mutated
from mutation.places import MOST_IN_BOTH, STRICT, WORD, places
from mutation.report import Outcome, Row, exceeded
from mutation.trial import Trial

pytestmark = pytest.mark.slow

#: Number of mutants of each class in which none may pass, in each spec.
OF_EACH = 3
SPECS = ("am36", "amm5", "asc85", "icmu", "sma21")


@pytest.fixture(scope="module")
def trial() -> Trial:
    return Trial()


@pytest.mark.exhaustive
def test_no_wrong_value_passes_where_it_moves_a_position_or_breaks_an_access(trial: Trial) -> None:
    """Run a small campaign, the same each time, with mistakes of several kinds in each class."""
    strict = [mutant for mutant in trial.mutants(SPECS) if mutant.fact in STRICT and not mutant.is_left_out]
    chosen = drawn(strict, OF_EACH * len(SPECS) * len(STRICT), seed=12)
    outcome = Outcome(trial, tried(trial, chosen, jobs=1))
    assert set(outcome.rows) == STRICT
    assert min(row.mutants for row in outcome.rows.values()) >= OF_EACH
    assert [(mutant.place, mutant.difference) for mutant in outcome.passed] == []
    assert outcome.crashes == []


def test_mutants_of_second_readings_are_tried(trial: Trial) -> None:
    """Every spec that was read twice has its second reading in the trial."""
    assert len(trial.second_readings) == len(SPECS)
    for document in trial.second_readings:
        assert trial.verdict(next(iter(mutants(document)))).crash == ""


def test_a_fact_that_is_left_out_of_a_second_reading_is_missed(trial: Trial) -> None:
    """``check --coverage`` notices it by the counts next to each spec."""
    mutant = mutant_at(trial, "amm5.second", ("interfaces", "ssi", "clock"), "max_hz", "off by one")
    assert trial.verdict(mutant).rules == ("readings-disagree",)
    mutant = mutant_at(trial, "am36.second", ("supply",), "supply", "key omitted")
    assert trial.verdict(mutant).rules == ("read once",)


def test_the_same_mistake_can_be_in_both_readings(trial: Trial) -> None:
    """Wires that are exchanged in both files contradict the other specs. An access contradicts nothing."""
    in_both = trial.mutants_in_both(trial.mutants(["sma21"]))
    pins = [mutant for mutant in in_both if mutant.fact == "pin" and mutant.mistake == "swapped with the next"]
    assert trial.verdict(pins[0]).word == "refused"
    access = next(mutant for mutant in in_both if "position_check.access" in trial.place(mutant))
    in_one_file = replace(access, changes_in_second=())
    assert trial.verdict(in_one_file).rules == ("readings-disagree",)
    assert "readings-disagree" not in trial.verdict(access).rules
    assert all(mutant.fact != WORD for mutant in in_both)


def test_mistakes_in_both_readings_have_limits(trial: Trial) -> None:
    both = Outcome(trial, [])
    both.rows = {"clock": Row(mutants=10, refused=7, code=3), "pin": Row(mutants=10, refused=9, code=1)}
    assert exceeded(both, MOST_IN_BOTH) == ["pin: 10.0% pass, at most 0% may"]
    both.rows["clock"] = Row(mutants=10, refused=6, code=4)
    assert exceeded(both, MOST_IN_BOTH)[0] == "all classes: 25.0% pass, at most 20% may"


def mutant_at(trial: Trial, name: str, path: tuple[str | int, ...], key: str, mistake: str) -> Mutant:
    for mutant in trial.mutants([name]):
        keys = mutant.place.path
        if mutant.mistake == mistake and keys[: len(path)] == path and keys[-1] == key:
            return mutant
    raise AssertionError(f"{name} has no mistake '{mistake}' at {path} in '{key}'")


@pytest.mark.slow
def test_a_wrong_value_that_passes_is_classified_by_its_effect(trial: Trial) -> None:
    title = mutant_at(trial, "asc85", ("documents", "onstepx"), "title", "digit misread")
    assert trial.verdict(title).word == "code"  # The titles of documents are data of the Python package.
    why = mutant_at(trial, "am36", ("editions", 0, "then"), "why", "digit lost")
    assert trial.verdict(why).word == "texts"
    source = mutant_at(trial, "am36", ("crcs",), "source", "extra zero")
    assert trial.verdict(source).rules == ("cited-place",)  # A page that is not listed for the document.
    answer = ("alternatives", 0, "values", "left_out")
    meaning = mutant_at(trial, "asc85", answer, "meaning", "word turned round")
    assert trial.verdict(meaning).rules[0].startswith("words-")
    order = mutant_at(trial, "am36", ("interfaces", "biss", "timeout"), "timeout", "key omitted")
    assert trial.verdict(order).word == "refused"


SPEC = """\
codewheel: 1
device: made_up
movement: rotary
crcs:
  - {name: biss_6, width: 6, poly: 0x103, refin: false}
registers:
  - {name: one, address: 0x48, access: read_only}
  - {name: two, address: 0x49, access: read_write}
"""


@pytest.fixture
def invented_spec(tmp_path: pathlib.Path) -> Document:
    path = tmp_path / "made_up.yaml"
    path.write_text(SPEC, encoding="utf-8")
    document = read_document(path, ProblemReport())
    assert document is not None
    return document


def mutants_at(document: Document, *path: str | int) -> dict[str, Mutant]:
    """Return the mutants of a place by their mistake."""
    return {mutant.mistake: mutant for mutant in mutants(document) if mutant.place.path == path}


def mistakes_of(document: Document, *path: str | int) -> dict[str, list[object]]:
    """Return the values that mistakes leave at a place, by mistake. It is the first change of each."""
    values_by_mistake: dict[str, list[object]] = {}
    for mutant in mutants(document):
        if mutant.place.path == path:
            values_by_mistake.setdefault(mutant.mistake, []).append(mutant.changes[0][1])
    return values_by_mistake


def test_mistakes_of_a_number_follow_how_it_is_written(invented_spec: Document) -> None:
    values = mistakes_of(invented_spec, "crcs", 0, "poly")
    assert values["digit lost"] == [0x03, 0x13, 0x10]
    assert values["digits swapped"] == [0x013, 0x130]
    assert values["digit misread"] == [0x703, 0x183, 0x163, 0x108]
    assert values["off by one"] == [0x102, 0x104]
    assert len(values["bit flipped"]) == 9


def test_mistakes_of_words_booleans_and_items(invented_spec: Document) -> None:
    assert mistakes_of(invented_spec, "crcs", 0, "refin")["boolean flipped"] == [True]
    assert mistakes_of(invented_spec, "registers", 0, "access")["different word"] == ["read_write", "write_only"]
    exchanged = mutants_at(invented_spec, "registers", 0, "address")["swapped with the next"]
    assert [register["address"] for register in mutated(invented_spec, exchanged.changes)["registers"]] == [0x49, 0x48]
    lost = mutants_at(invented_spec, "registers", 0)["item omitted"]
    assert [register["name"] for register in mutated(invented_spec, lost.changes)["registers"]] == ["two"]
    assert [register["name"] for register in invented_spec.data["registers"]] == ["one", "two"]


def test_every_value_has_a_class(trial: Trial) -> None:
    """``alike`` and ``main`` have no class: the parts that devices share, and locations of packages, are not facts."""
    unclassed = {place.keys for document in trial.documents for place in places(document) if place.fact == "other"}
    assert unclassed == {
        "alike",
        "alike.connectors",
        "alike.crcs",
        "alike.facts",
        "alike.registers",
        "main",
    }


def test_a_draw_is_even_and_repeats(trial: Trial) -> None:
    all_mutants = trial.mutants(["am36"])
    sample = drawn(all_mutants, 200, seed=1)
    assert sample == drawn(all_mutants, 200, seed=1)
    assert sample != drawn(all_mutants, 200, seed=2)
    facts_of_all = Counter(mutant.fact for mutant in all_mutants)
    facts_drawn = Counter(mutant.fact for mutant in sample)
    highest_count = max(facts_drawn.values())
    assert all(count in (highest_count, highest_count - 1, facts_of_all[name]) for name, count in facts_drawn.items())
    assert set(facts_drawn) == set(facts_of_all)


def test_the_table_counts_wrong_values_alone() -> None:
    row = Row(mutants=12, refused=5, same=2, left_out=2, texts=2, code=1)
    assert row.cells() == ("12", "5", "2", "2", "2", "1", "30.0%")


def test_each_class_has_its_own_limit(trial: Trial) -> None:
    outcome = Outcome(trial, [])
    outcome.rows = {
        "clock": Row(mutants=20, refused=20),
        "table": Row(mutants=12, refused=8, same=2, left_out=1, texts=1),
        "number in a text": Row(mutants=12, refused=10, texts=2),
        "second readings": Row(mutants=50, refused=40, code=10),
    }
    assert dict(outcome.sums())["all classes"].wrong == pytest.approx(3 / 42)
    assert exceeded(outcome) == ["table: 10.0% pass, at most 3% may"]


@pytest.mark.parametrize(
    ("text", "span"),
    [
        ("5.3 mm; 5.6 mm", "`5.3 mm; 5.6 mm`"),
        ("a `b` c", "``a `b` c``"),
        ("``b`", "``` ``b` ```"),
        ("", '`""`'),
    ],
)
def test_values_are_code_spans(text: str, span: str) -> None:
    assert code_span(text) == span


def test_an_omitted_value_is_not_a_code_span(invented_spec: Document) -> None:
    omitted = mutants_at(invented_spec, "registers", 0)["item omitted"]
    assert omitted.difference == "`{'name': 'one', 'address': 72, 'access': 'read_only'}` -> nothing"
    assert mutants_at(invented_spec, "movement")["different word"].difference == "`rotary` -> `linear`"


def test_the_worst_effect_is_last() -> None:
    assert [effect.value for effect in Effect] == ["nothing", "order", "second reading", "texts", "code"]


@pytest.mark.exhaustive
def test_no_name_in_a_measurement_stops_the_tool(trial: Trial) -> None:
    """Two to the power of a large parameter is reported as a problem and does not crash the tool."""
    place = ("interfaces", "biss", "measurement", "highest")
    verdicts = [trial.verdict(mutant) for mutant in trial.mutants(["sma21"]) if mutant.place.path == place]
    assert len(verdicts) > 5
    assert {verdict.word for verdict in verdicts} == {"refused"}
