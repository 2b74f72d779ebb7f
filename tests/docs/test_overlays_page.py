"""The page on overlays: its file, its commands and their output are correct."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from python_path import python_path

ROOT = Path(__file__).resolve().parents[2]
CHAPTER = (ROOT / "docs/transcribe/how-to-revise.md").read_text(encoding="utf-8")
#: The part of the chapter on overlays.
PAGE = CHAPTER.partition("\n## Overlays")[2]
TOLVARN = ROOT / "docs" / "example" / "tolvarn"
OVERLAY = ROOT / "docs" / "example-overlay" / "tv62.s042.overlay.yaml"


def fences(word: str) -> list[str]:
    blocks = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    return [text for kind, text in blocks if kind == word]


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("out")
    assert main(["generate", str(TOLVARN), str(OVERLAY), "-o", str(out)]) == 0
    return out


def test_the_file_is_the_one_that_is_shown() -> None:
    (example,) = fences("yaml")
    assert OVERLAY.read_text(encoding="utf-8").endswith(example)


@pytest.mark.slow
def test_commands_print_what_is_shown(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    examples = fences("")
    assert len(examples) == 2
    for text in examples:
        command, _, printed = text.removeprefix("$ ").partition("\n")
        assert main(shlex.split(command)[1:]) == 0
        assert capsys.readouterr().out == printed


@pytest.mark.slow
def test_the_comment_is_that_of_the_header(generated: Path) -> None:
    (example,) = fences("c")
    assert example in _c(generated, "tv62_s042")


def test_the_wait_that_is_forgotten_is_told(tmp_path: Path) -> None:
    text = OVERLAY.read_text(encoding="utf-8")
    path = tmp_path / OVERLAY.name
    lines_without_wait = [line for line in text.splitlines(keepends=True) if "- procedures." not in line]
    path.write_text("".join(lines_without_wait), encoding="utf-8")
    _, report = load_library([TOLVARN, path])
    (message,) = fences("text")
    messages = [problem.format().splitlines()[0].removeprefix(f"{tmp_path}/") for problem in report.problems]
    assert messages[0] == message.strip()
    assert len(messages) == 2


def _c(generated: Path, family: str) -> str:
    """All headers of a family."""
    headers = (generated / "c" / "include" / "tolvarn").glob(f"{family}_*.h")
    other_prefixes = () if family == "tv62_s042" else ("tv62_s042_",)
    paths = [path for path in sorted(headers) if not path.name.startswith(other_prefixes)]
    return "\n".join(path.read_text(encoding="utf-8") for path in paths)


@pytest.mark.slow
def test_every_output_has_the_change_with_reason_and_source(generated: Path) -> None:
    """Return the numbers of the Technical Info as a user of each output gets them."""
    header, standard = _c(generated, "tv62_s042"), _c(generated, "tv62")
    assert "#define TOLVARN_TV62_S042_BISS_REG_BANK_WAIT_AT_LEAST_MS 80U" in header
    assert "#define TOLVARN_TV62_BISS_REG_BANK_WAIT_AT_LEAST_MS 50U" in standard
    assert "verlay" not in standard
    texts: Mapping[str, str] = {
        "C": header,
        "Python": (generated / "python" / "tolvarn_encoders" / "facts" / "tv62_s042.py").read_text(encoding="utf-8"),
        "page": (generated / "docs" / "tv62_s042" / "biss-registers.md").read_text(encoding="utf-8"),
        "XML": (generated / "biss" / "tolvarn-tv62_s042.xml").read_text(encoding="utf-8"),
    }
    for name, text in texts.items():
        flat = " ".join(text.replace("\n *", "\n").split())
        assert "The slower memory of these models takes longer to change the bank." in flat, name
        assert "Technical Info 042" in flat, name
        assert re.search(r"ti: (§)?2|document=\"ti\"", flat), name
    identity = (generated / "biss" / "idbiss5476.xml").read_text(encoding="utf-8")
    assert "S042" not in identity


@pytest.mark.slow
def test_the_generated_python_has_it(generated: Path) -> None:
    program = """
from codewheel_runtime import Wait
from tolvarn_encoders import lookup, tv62, tv62_s042
special, standard = lookup("TV62-M17-B1-5M/S042"), lookup("TV62-M17-B1-5M")
assert isinstance(special, tv62_s042.Variant) and isinstance(standard, tv62.Variant)
waits = [step.microseconds for step in tv62_s042.set_preset(special, 1) if isinstance(step, Wait)]
assert waits[0] == 80_000, waits
waits = [step.microseconds for step in tv62.set_preset(standard, 1) if isinstance(step, Wait)]
assert waits[0] == 50_000, waits
assert tv62_s042.UpperLimit(1500).encode() == (1500).to_bytes(2, "little")
try:
    tv62.UpperLimit(1500).encode()
except ValueError:
    pass
else:
    raise AssertionError("1500 is above what the standard models take")
"""
    environment = {**os.environ, "PYTHONPATH": python_path(generated / "python")}
    subprocess.run([sys.executable, "-c", program], env=environment, check=True)


@pytest.mark.slow
def test_the_generated_c_compiles_beside_that_of_the_standard_models(generated: Path, tmp_path: Path) -> None:
    program = tmp_path / "both.c"
    program.write_text(
        """#include "tolvarn/tv62_biss_registers.h"
#include "tolvarn/tv62_s042_biss_registers.h"
int main(void) {
    return (TOLVARN_TV62_S042_BISS_REG_BANK_WAIT_AT_LEAST_MS == 80U)
        && (TOLVARN_TV62_BISS_REG_BANK_WAIT_AT_LEAST_MS == 50U) ? 0 : 1;
}
""",
        encoding="utf-8",
    )
    executable = tmp_path / "both"
    include = generated / "c" / "include"
    subprocess.run(
        ["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", f"-I{include}", program, "-o", executable], check=True
    )
    subprocess.run([executable], check=True)
