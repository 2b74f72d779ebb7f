"""A missing package disables only the target that needs it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

TV62 = Path(__file__).resolve().parents[2] / "docs" / "example" / "tolvarn"
#: Runs a command without access to lxml, which only the target 'biss' needs.
HIDDEN = """
import sys

class Hidden:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "lxml":
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Hidden())
from codewheel.commands.cli import main
sys.exit(main(sys.argv[1:]))
"""


def without_lxml(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", HIDDEN, *arguments], capture_output=True, text=True, check=False, timeout=300
    )


def test_check_needs_no_package_of_a_target_without_problems() -> None:
    done = without_lxml("check", str(TV62))
    assert (done.returncode, done.stdout.splitlines()[-1]) == (0, "no problems in 1 family: tv62")
    assert done.stderr == ""


def test_the_other_targets_are_generated(tmp_path: Path) -> None:
    done = without_lxml("generate", str(TV62), "-o", str(tmp_path / "out"))
    assert (done.returncode, done.stderr) == (
        0,
        "codewheel: the target 'biss' needs the Python package 'lxml', which is missing; this target is skipped\n",
    )
    folders = {path.name for path in (tmp_path / "out").iterdir() if path.is_dir()}
    assert folders == {"python", "c", "docs", "browser", "masters"}


def test_the_target_asked_for_is_an_error(tmp_path: Path) -> None:
    done = without_lxml("generate", str(TV62), "-o", str(tmp_path / "out"), "--target", "biss")
    message = "codewheel: the target 'biss' needs the Python package 'lxml', which is missing\n"
    assert (done.returncode, done.stderr) == (1, message)
    assert not (tmp_path / "out").exists()
