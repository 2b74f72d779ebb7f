"""The evidence shares the harness of the C tests. What is proved is told at the end."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from proof import Told

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "c"))


_TOLD = pytest.StashKey[list[Told]]()


@pytest.fixture(scope="session")
def told(pytestconfig: pytest.Config) -> list[Told]:
    """Where a test of proofs adds what it has to say at the end."""
    return pytestconfig.stash.setdefault(_TOLD, [])


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    told = terminalreporter.config.stash.get(_TOLD, [])
    if told:
        terminalreporter.section("proofs")
        total = Told("all", *(sum(numbers) for numbers in zip(*(item[1:] for item in told))))
        for item in (*told, total):
            terminalreporter.write_line(str(item))
