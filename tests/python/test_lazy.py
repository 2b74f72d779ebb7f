"""Modules are loaded on first use: one family, no facts, and nothing that a decoder does not need."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from python_path import python_path

FAMILIES = ("am36", "amm5", "asc85", "sma21")


def loaded(generated_python: tuple[Path, ModuleType], code: str) -> set[str]:
    """Return the modules that ``code`` loads."""
    script = f"import sys\nbefore = set(sys.modules)\n{code}\nprint(*sorted(set(sys.modules) - before))"
    environment = {**os.environ, "PYTHONPATH": python_path(generated_python[0])}
    completed = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, env=environment, check=True
    )
    return set(completed.stdout.split())


@pytest.mark.slow
def test_lookup_loads_one_family(generated_python: tuple[Path, ModuleType]) -> None:
    modules = loaded(
        generated_python,
        "import lika_encoders\nlika_encoders.lookup('SMA21-SC1-0050').decode(0xBCD15E0).verdict",
    )
    assert {name for name in FAMILIES if f"lika_encoders.{name}" in modules} == {"sma21"}
    heavy = {"lika_encoders.facts", "lika_encoders._codes", "dataclasses", "inspect", "numpy"}
    heavy |= {f"codewheel_runtime.{name}" for name in ("facts", "causes", "biss", "bulk", "captures", "files")}
    assert heavy.isdisjoint(modules)


@pytest.mark.slow
def test_facts_are_there_when_asked_for(generated_python: tuple[Path, ModuleType]) -> None:
    for code in ("from lika_encoders.amm5 import ERRATA", "from lika_encoders import amm5; amm5.ALARMS"):
        modules = loaded(generated_python, code)
        assert "lika_encoders.facts.amm5" in modules
        assert "lika_encoders.facts.sma21" not in modules


@pytest.mark.slow
def test_families_are_there_when_asked_for(generated_python: tuple[Path, ModuleType]) -> None:
    modules = loaded(generated_python, "import lika_encoders\nlika_encoders.asc85\nlika_encoders.FAMILIES")
    assert {f"lika_encoders.{name}" for name in FAMILIES} <= modules


@pytest.mark.parametrize("label", ["AM3616/4096-I7", "AMM5A21/65KSC1", "ASC8525/SC1", "SMA21-SC1-0050"])
def test_lookup_takes_no_longer_for_the_last_family(generated_python: tuple[Path, ModuleType], label: str) -> None:
    """The best of some runs, in CPU time, takes at most 50 µs. A tenth of that is usual."""
    lika: Any = generated_python[1]
    lika.lookup(label)
    best = float("inf")
    for _ in range(20):
        start = time.process_time_ns()
        for _ in range(100):
            lika.lookup(label)
        best = min(best, (time.process_time_ns() - start) / 100_000)
    assert best < 50


def test_every_beginning_leads_to_its_family(generated_python: tuple[Path, ModuleType]) -> None:
    lika: Any = generated_python[1]
    for family in lika.FAMILIES:
        for code in getattr(lika, family.name).VARIANTS:
            assert any(code.startswith(beginning) for beginning in lika._PACKAGE.beginnings[family.name]), code
