"""The evidence uses the harness of the C tests. The number of proofs is printed at the end."""

from __future__ import annotations

from pathlib import Path

import pytest
from c_harness import MADE_UP, devices_of, write
from codewheel.model import Device
from proof import ProofCount

_PROOF_COUNTS = pytest.StashKey[list[ProofCount]]()


@pytest.fixture(scope="session")
def proof_counts(pytestconfig: pytest.Config) -> list[ProofCount]:
    """List to which a test of proofs adds its summary for the end of the run."""
    return pytestconfig.stash.setdefault(_PROOF_COUNTS, [])


@pytest.fixture(scope="session")
def headers(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """All headers, of the families and of specs that use the other words of the language, with their includes."""
    groups: list[tuple[Device, ...]] = [devices_of(), *(devices_of(path) for path in MADE_UP.values())]
    folder = tmp_path_factory.mktemp("headers")
    include = write(folder, tuple(device for group in groups for device in group))
    return include, sorted(str(path.relative_to(include)) for path in include.rglob("*.h"))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    counts = terminalreporter.config.stash.get(_PROOF_COUNTS, [])
    if counts:
        terminalreporter.section("proofs")
        totals = map(sum, zip(*(count[1:] for count in counts), strict=True))
        total = ProofCount("all", *totals)
        for count in (*counts, total):
            terminalreporter.write_line(str(count))
