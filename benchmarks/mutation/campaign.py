"""A campaign: mutants are drawn evenly over files and classes of facts, and several processes try each of them."""

from __future__ import annotations

import multiprocessing
import random
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from .mistakes import Mutant
from .trial import Trial, Verdict

#: Number of mutants that are passed to a process at a time.
_AT_A_TIME = 20


@dataclass(frozen=True)
class TriedMutant:
    """A mutant and its result."""

    mutant: Mutant
    verdict: Verdict


def drawn(mutants: Iterable[Mutant], number: int, seed: int) -> list[Mutant]:
    """Draw this many mutants, evenly over files and classes of facts, and over the mistakes within each class."""
    draw = random.Random(seed)
    mistakes: dict[tuple[str, str], dict[str, list[Mutant]]] = defaultdict(lambda: defaultdict(list))
    for mutant in mutants:
        mistakes[mutant.file, mutant.fact][mutant.mistake].append(mutant)
    columns = []
    for kinds in mistakes.values():
        shuffled = [draw.sample(same_mistake, len(same_mistake)) for same_mistake in kinds.values()]
        columns.append(list(_in_turns(shuffled)))
    return [mutant for _, mutant in zip(range(number), _in_turns(columns), strict=False)]


def _in_turns(columns: Sequence[Sequence[Mutant]]) -> Iterator[Mutant]:
    """Yield the first item of each column, then the second of each column that has one, and so on."""
    for index in range(max(map(len, columns), default=0)):
        yield from (column[index] for column in columns if index < len(column))


def tried(trial: Trial, mutants: Sequence[Mutant], jobs: int) -> Iterator[TriedMutant]:
    """Yield the result of each mutant, in the order of the mutants."""
    if jobs < 2 or "fork" not in multiprocessing.get_all_start_methods():
        yield from (TriedMutant(mutant, trial.verdict(mutant)) for mutant in mutants)
        return
    # The child processes inherit trial and mutants from this one. Only numbers and verdicts are sent.
    _Shared.trial, _Shared.mutants = trial, mutants
    with multiprocessing.get_context("fork").Pool(jobs) as pool:
        verdicts = pool.imap(_verdict, range(len(mutants)), _AT_A_TIME)
        yield from (TriedMutant(mutant, verdict) for mutant, verdict in zip(mutants, verdicts, strict=True))


class _Shared:
    trial: Trial
    mutants: Sequence[Mutant]


def _verdict(index: int) -> Verdict:
    return _Shared.trial.verdict(_Shared.mutants[index])
