"""Requests of the C target's tests to the harness's program, with its answers: recorded once, to be repeated elsewhere.

The tests compare the answers with the manuals' examples, public vectors and the model. A program with the same answers
also passes these tests.
"""

from __future__ import annotations

import importlib
import inspect
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from c_harness import FAMILIES, MADE_UP, Run, devices_of
from codewheel.model import Device
from tree import library

TESTS = Path(__file__).resolve().parents[1]


def every_device() -> dict[str, Device]:
    """The families, and the made-up devices of the C tests."""
    return {**library(), **{device.name: device for path in MADE_UP.values() for device in devices_of(path)}}


@dataclass
class Recording:
    """Passes lines to a program, and keeps them with their answers."""

    run: Run
    answers: dict[str, str] = field(default_factory=dict)

    def __call__(self, lines: Iterable[str]) -> list[str]:
        sent_lines = list(lines)
        replies = self.run(sent_lines)
        self.answers.update(zip(sent_lines, replies, strict=True))
        return replies


def run_tests(devices: Mapping[str, Device], programs: Mapping[str, Run]) -> list[str]:
    """Call every test of ``tests/c`` that needs only devices, programs and public vectors. Return their names."""
    vectors = json.loads((TESTS / "vectors.json").read_text(encoding="utf-8"))
    shared: dict[str, Any] = {
        "every_device": devices,
        "programs": programs,
        "vectors": vectors,
        "c_devices": tuple(devices[name] for name in FAMILIES),
    }
    shared |= {name: devices[name] for name in ("amm5", "bits22", "words")} | {"run": programs["amm5"]}
    shared |= {f"run_{name}": programs[name] for name in ("bits22", "words")}
    called = []
    for path in sorted((TESTS / "c").glob("test_c_*.py")):
        module = importlib.import_module(path.stem)
        # Tests with a program of their own do not use the harness.
        for function in _tests(module) if "run" not in vars(module) else []:
            for arguments in _arguments(function, shared, devices, programs):
                function(**arguments)
                called.append(function.__name__)
    return called


def _tests(module: ModuleType) -> list[Callable[..., None]]:
    named = [value for name, value in vars(module).items() if name.startswith("test_")]
    return [function for function in named if inspect.isfunction(function)]


def _arguments(
    function: Callable[..., None], shared: Mapping[str, Any], devices: Mapping[str, Device], programs: Mapping[str, Run]
) -> Iterable[dict[str, Any]]:
    """Return the arguments of a test: the fixtures of the C tests, and the rows of one ``parametrize``.

    If it needs more or has no program, return nothing.
    """
    names = list(inspect.signature(function).parameters)
    if not any(name in ("machine", "family", "run", "programs") or name.startswith("run_") for name in names):
        return
    rows: list[dict[str, Any]] = [{}]
    # Here, all cases of a test are called that make test runs in part.
    marks = [mark for mark in getattr(function, "pytestmark", ()) if mark.name != "one_in"]
    for mark in marks:
        rows = list(_rows(mark)) if mark.name == "parametrize" and len(rows) == 1 else []
    pairs = {"machine": tuple(devices), "family": FAMILIES}
    family_argument = next((name for name in names if name in pairs), "")
    for row in rows:
        for device in pairs.get(family_argument, ("",)):
            values = {**shared, **row, family_argument: (devices[device], programs[device]) if device else None}
            if all(name in values for name in names):
                yield {name: values[name] for name in names}


def _rows(mark: pytest.Mark) -> Iterable[dict[str, Any]]:
    names = [name.strip() for name in mark.args[0].split(",")] if isinstance(mark.args[0], str) else list(mark.args[0])
    for values in mark.args[1]:
        yield dict(zip(names, [values] if len(names) == 1 else values, strict=True))
