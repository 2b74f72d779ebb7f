"""``generate`` runs without processes, pipes and threads, as in a browser's Python."""

from __future__ import annotations

import os
import shutil
import subprocess
import threading
from pathlib import Path
from typing import Any, NoReturn

import pytest
from codewheel.commands.cli import main

SPEC = Path(__file__).parents[1] / "specs" / "words.yaml"


def refuse(*_: Any, **__: Any) -> NoReturn:
    raise OSError("not available here")


def generated(spec: Path, output: Path) -> dict[str, bytes]:
    assert main(["generate", str(spec), "-o", str(output), "--no-cache", "--unchecked"]) == 0
    return {path.relative_to(output).as_posix(): path.read_bytes() for path in output.rglob("*") if path.is_file()}


def test_the_outputs_are_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    specs = tmp_path / "specs"
    specs.mkdir()
    spec = specs / SPEC.name
    shutil.copy(SPEC.with_name("manufacturer.yaml"), specs)
    shutil.copy(SPEC, spec)
    generated(spec, tmp_path / "without")
    spec.write_text(SPEC.read_text(encoding="utf-8").replace("many words", "several words"), encoding="utf-8")
    expected = generated(spec, tmp_path / "with")
    for owner, name in ((os, "fork"), (os, "pipe"), (threading.Thread, "start"), (subprocess, "Popen")):
        monkeypatch.setattr(owner, name, refuse)
    # It replaces the outputs of the earlier spec.
    assert generated(spec, tmp_path / "without") == expected
    assert len(expected) > 50
