"""An order code of one family can equal an order code of another family with a tail. The longer code is meant."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from codewheel.commands.cli import main

#: Labels with the family and the order code that they mean. ``-X`` and ``-X-SP-Z`` are tails.
LABELS = {
    "A-SP": ("a", "A-SP"),
    "A-SP-X": ("a", "A-SP"),
    "A-SP-X-SP": ("a_sp_x", "A-SP-X-SP"),
    "A-SP-X-SP-Z": ("a_sp_x", "A-SP-X-SP"),
}


@pytest.fixture(scope="module")
def specs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("specs")
    for name in ("a", "a_sp_x"):
        assert main(["new", name, "--like", "spi", "-o", str(folder)]) == 0
    return folder


@pytest.mark.parametrize("label", LABELS)
def test_commands_find_the_longer_code(specs: Path, label: str, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    assert main(["decode", label, "0x03E8", "--specs", str(specs)]) == 0
    assert capsys.readouterr().out.startswith(f"{LABELS[label][1]}, SPI")


@pytest.mark.slow
def test_the_package_finds_the_longer_code(specs: Path, tmp_path: Path) -> None:
    assert main(["generate", str(specs), "-o", str(tmp_path), "--target", "python"]) == 0
    code = f"from example_encoders import lookup\nfor label in {list(LABELS)}: print(lookup(label).code)"
    completed = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path / "python",
        env={"PYTHONPATH": "runtime"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert completed.stdout.split() == [code for _, code in LABELS.values()]
