"""Plant transcription mistakes in the specs, and count those that pass ``check`` by class of fact.

    python benchmarks/mutants.py                     tries some thousand, drawn evenly over files and classes
    python benchmarks/mutants.py --number 500        tries fewer
    python benchmarks/mutants.py --all               tries every mutant
    python benchmarks/mutants.py --files amm5        tries only the specs or second readings of these names
    python benchmarks/mutants.py --write             also writes docs/trust/mutants.md

Then the same mistakes are planted in a spec and in its second reading at once. The exit code is 1 if a wrong value in
one file passes in a class where none may, if one passes without a reason, or if too many pass in a class. The
docstrings of the modules in benchmarks/mutation/ explain mutants and how they are tried.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from mutation.campaign import drawn, tried
from mutation.places import MOST_IN_BOTH
from mutation.report import Outcome, exceeded, file_name, page, survivors, survivors_in_both, table
from mutation.trial import Trial

PAGE = Path(__file__).resolve().parents[1] / "docs/trust/mutants.md"
NUMBER = 4000


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--number", type=int, default=NUMBER, help="number of mutants to try (%(default)s)")
    parser.add_argument("--all", action="store_true", help="try every mutant")
    parser.add_argument("--seed", type=int, default=1, help="seed of the draw (%(default)s)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes (%(default)s)")
    parser.add_argument("--files", nargs="+", default=(), metavar="NAME", help="files by their names without .yaml")
    parser.add_argument("--write", action="store_true", help=f"write {PAGE.parent.name}/{PAGE.name}")
    options = parser.parse_args(arguments)
    started, trial = time.monotonic(), Trial()
    all_mutants = trial.mutants(options.files)
    chosen = all_mutants if options.all else drawn(all_mutants, options.number, options.seed)
    outcome = Outcome(trial, tried(trial, chosen, options.jobs))
    all_in_both = trial.mutants_in_both(all_mutants)
    chosen_in_both = all_in_both if options.all else drawn(all_in_both, options.number // 4, options.seed)
    both = Outcome(trial, tried(trial, chosen_in_both, options.jobs))
    if options.write:
        files = sorted({file_name(mutant.file) for mutant in all_mutants})
        reversed_words = trial.reversed_words(all_mutants)
        PAGE.write_text(page(outcome, both, "make mutants", files, reversed_words), encoding="utf-8")
    print("\n".join(["", *table(outcome), ""] + ([] if options.write else list(survivors(outcome)))))
    print("\n".join(["in both files", *table(both), ""] + ([] if options.write else list(survivors_in_both(both)))))
    print(f"{len(chosen)} of {len(all_mutants)} mutants in {time.monotonic() - started:.0f} seconds")
    return max(_print_violations(outcome), _print_violations_in_both(both))


def _print_violations_in_both(both: Outcome) -> int:
    """Print each violated limit of mistakes in both files, and return the exit code."""
    violations = [f"crash in both files: {crash}" for crash in both.crashes]
    violations += [f"in both files, {line}" for line in exceeded(both, MOST_IN_BOTH)]
    print("\n".join(violations), file=sys.stderr)
    return 1 if violations else 0


def _print_violations(outcome: Outcome) -> int:
    """Print each violated limit, and return the exit code."""
    sums = dict(outcome.sums())
    violations = [f"crash: {crash}" for crash in outcome.crashes]
    strict = sums["classes with *"]
    if strict.texts + strict.code:
        violations.append(f"{strict.texts + strict.code} wrong values pass in classes where none is allowed")
    violations += exceeded(outcome)
    violations += [f"no reason: {passed.place} {passed.difference} ({passed.effect})" for passed in outcome.gaps]
    print("\n".join(violations), file=sys.stderr)
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
