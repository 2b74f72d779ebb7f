"""An SPI word of 20 bits in three bytes, of which it fills the first 20 bits instead of the last ones."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from browser_harness import Asker, cases
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.targets import Library

pytestmark = pytest.mark.slow

LINE = "spi:zero=2,position=18"


def test_a_valid_word_may_be_left_aligned(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["decode", LINE, "02 00 10"]) == 0
    assert "8193 if it is left-aligned in its bytes" in " ".join(capsys.readouterr().out.split())
    assert main(["decode", LINE, "0x20010"]) == 0
    assert "left-aligned" not in capsys.readouterr().out


def test_wrong_constants_are_explained(capsys: pytest.CaptureFixture[str]) -> None:
    """Of the last 20 bits, the first one is 1. The first 20 bits begin with the two zeros."""
    assert main(["decode", LINE, "08 00 10", "--json"]) == 1
    explanations = json.loads(capsys.readouterr().out)["why"]["explanations"]
    assert ("zeros_behind", {"position": 0x8001}) in [(each["kind"], each["reads"]) for each in explanations]


def test_the_page_lists_the_same_reading(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ask: Callable[[Library, str], Asker]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", "my_encoder", "--line", LINE]) == 0
    library = Library(load_library([tmp_path])[0])
    ((case,),) = cases(library.devices[0])
    ((aligned, cut),) = ask(library, "node")("doubts", [{**case.data, "frames": ["02 00 10", "0x200"]}])
    assert ["if it is left-aligned in its bytes", "8193"] in aligned[0]
    assert ["if its last bits are missing, and are 0", str(0x20000)] in cut[0]
