"""Facts of the SMA21 that a changed passage touches are among the first ten."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.reread.facts import facts_with_citations
from codewheel.reread.passages import Passage
from codewheel.reread.sections import Section
from codewheel.reread.touched_facts import TouchedFacts

SPEC = Path(__file__).parents[2] / "specs/lika/sma21.yaml"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("section", "before", "old", "new", "after", "facts"),
    [
        # A single digit occurs in many texts. The other end of the range identifies this one.
        (
            "4.1",
            "SMA21 SC4 + Vdc +",
            "5Vdc",
            "10Vdc",
            "+ 30Vdc 2 I segnali",
            ("order_code.parts.supply.values.4.meaning", "characteristics.supply_4.value"),
        ),
        # The entry of the contents has the name that changes, of which one word stays.
        (
            "6.4",
            "55 Tipo di dispositivo 58",
            "Risoluzione SENO COSENSO",
            "Periodo SENO COSENO",
            "59 Controllo posizione",
            ("manual.contents.6.4.entries.Risoluzione SENO-COSENSO", "registers.sine_cosine_resolution.names.it"),
        ),
    ],
)
def test_touched_facts_are_among_the_first_ten(
    section: str, before: str, old: str, new: str, after: str, facts: tuple[str, ...]
) -> None:
    document = read_document(SPEC, ProblemReport())
    assert document is not None
    words = (*before.split(), *old.split(), *after.split())
    passage = Passage(
        section=Section(section, section, words),
        old_words=tuple(old.split()),
        new_words=tuple(new.split()),
        words_in_row=(*words, *new.split()),
        words_in_paragraph=(*words, *new.split()),
        shown_texts=(f"{before} [ {old} ] {after}", f"{before} [ {new} ] {after}"),
    )
    touched_facts, _ = TouchedFacts(facts_with_citations(document)).touched_by(passage, {section})
    assert set(facts) <= {fact.path for fact in touched_facts[:10]}
