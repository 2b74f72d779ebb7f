"""``runner.h``: claims proved for any steps and any results of them."""

from __future__ import annotations

from pathlib import Path

import pytest
from c_harness import RUNTIME
from claims import claims_of, planted, verdict

HARNESS = Path(__file__).with_name("proof_runner.c")
#: Rounds of a loop over steps, plus one, and twice that for the steps that one call can advance.
ROUNDS = 4


@pytest.fixture(scope="module")
def include() -> Path:
    """Return the include folder of the runtime."""
    return RUNTIME


@pytest.mark.parametrize("claim", claims_of(HARNESS))
def test_whatever_becomes_of_it(claim: str, include: Path, tmp_path: Path) -> None:
    proved, words = verdict(HARNESS, claim, include, tmp_path, ROUNDS)
    assert proved, words


@pytest.mark.parametrize(
    ("claim", "sound", "instead"),
    [
        ("a_round", "cw_runner_advance(runner, runner->length);", "cw_runner_advance(runner, 1U);"),
        ("a_round", "(runner->steps[runner->step_index].kind == CW_STEP_MORE) ||\n        ", ""),
        ("a_round", "!cw_step_closes(", "cw_step_closes("),
        ("a_round", "runner->access = todo;", ""),
        (
            "a_round",
            "runner->next_byte = &runner->next_byte[runner->length];",
            "runner->next_byte = &runner->next_byte[2];",
        ),
        ("places_that_do_not_fit", "fits ? count : 0U,", "count,"),
        ("no_steps", "const bool fits = ", "const bool fits = (count == 0U) || "),
        ("bytes_of_nothing", "const bool fits = ", "const bool fits = (steps[0].kind == CW_STEP_MORE) || "),
        ("closing_again", "runner->step_index = 0U;", "runner->step_index = 1U;"),
        (
            "closing_again",
            "(runner->step_index >= runner->count) && runner->failure.left_open",
            "runner->failure.left_open",
        ),
        ("done_too_often", "if (finished == CW_TODO_END) {", "if (finished == CW_TODO_BUSY) {"),
    ],
)
def test_what_is_planted_is_found(claim: str, sound: str, instead: str, include: Path, tmp_path: Path) -> None:
    proved, words = verdict(HARNESS, claim, planted(include, "runner.h", sound, instead, tmp_path), tmp_path, ROUNDS)
    assert not proved
    assert "REFUTED" in words, words
