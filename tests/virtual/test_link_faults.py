"""Faults by name, each at a rate, without I/O and in virtual time: every one has its error, none a wrong position."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from types import ModuleType
from zlib import crc32

import pytest
from bench import Bench, codes_with, shares
from codewheel.targets import Library
from codewheel.virtual import FAULTS

pytestmark = pytest.mark.slow

Package = tuple[Path, ModuleType]
#: Errors that a fault can have. No other error may occur, and at least the first one must.
ERRORS = {
    "lost": ("NoReplyError",),
    "short": ("DisturbedError", "NoReplyError"),
    "doubled": (),
    "late": ("NoReplyError",),
    "flip": ("DisturbedError",),
    "echo": (),
    "junk": (),
    "low": ("DisturbedError",),
    "high": ("NoReplyError",),
    "busy": ("NotUsableError", "NoReplyError"),
    "restart": ("NoReplyError", "NotUsableError"),
    "brownout": ("DisturbedError", "NotUsableError", "NoReplyError"),
}


def counted(
    package: ModuleType, codes: list[str], fault: str, rate: float, total: int, retries: int
) -> tuple[Counter[str], Counter[str]]:
    """Return the outcomes and the injected faults of this many requests, spread over all order codes."""
    outcomes, injected = Counter[str](), Counter[str]()
    for code, count in shares(total, codes):
        bench = Bench(package, code, f"{fault}:{rate}", seed=crc32(f"{code} {fault}".encode()), retries=retries)
        for _ in range(count):
            bench.position()
        outcomes += bench.outcomes
        injected += bench.virtual.faults.injected
    return outcomes, injected


def test_each_fault_has_errors_here() -> None:
    assert sorted(ERRORS) == sorted(FAULTS)


@pytest.mark.parametrize("fault", FAULTS)
def test_each_fault_has_its_error(generated_python: Package, library: Library, fault: str) -> None:
    """One reply in five has the fault, and nothing is retried."""
    codes = codes_with(library.devices, "rs485")
    outcomes, injected = counted(generated_python[1], codes, fault, 0.2, 2500, 0)
    assert outcomes["wrong"] == 0
    assert set(outcomes) - {"right", "wrong"} <= set(ERRORS[fault])
    assert all(outcomes[name] for name in ERRORS[fault][:1])
    assert outcomes["right"] > 100
    assert injected[fault] > 100


@pytest.mark.parametrize("fault", FAULTS)
def test_retries_make_up_for_a_fault(generated_python: Package, library: Library, fault: str) -> None:
    """One reply in fifty has the fault. Only an encoder that is busy or without supply makes the link give up."""
    codes = codes_with(library.devices, "rs485")
    outcomes, injected = counted(generated_python[1], codes, fault, 0.02, 2500, 3)
    assert outcomes["wrong"] == 0
    lasting = sum(outcomes.values()) - outcomes["right"]
    assert lasting == 0 or fault in ("busy", "restart", "brownout")
    assert injected[fault] > 10
