"""Frames with two data channels in the script of the page: the results are those of the command line."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from browser_harness import Asker
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.targets import Library

ENCODERS = Path(__file__).resolve().parents[2] / "specs"
CODE = "iC-MR-12-L6T"


@pytest.fixture(scope="module")
def node(ask: Callable[[Library, str], Asker]) -> Asker:
    """Run the script for the iC-MR, whose frame has the channels pos with 50 bits and tmp with 21."""
    devices, report = load_library([ENCODERS / "ichaus"])
    assert not report
    return ask(Library(devices), "node")


@pytest.mark.starts_process
def test_a_number_without_leading_zeros_is_a_whole_frame(node: Asker) -> None:
    """Its bits would also fit into the position channel, which would then be decoded as usable."""
    has_whole_frame_by_text = {
        "0x63a2ba03b57": True,
        "00 00 00 06 3A 2B A0 3B 57": True,
        "0x000000031D15D": False,
        "00 00 00 00 31 D1 5D": False,
        f"0b{0x31D15D:050b}": False,
    }
    items = [{"code": CODE, "sender": "encoder", "text": text, "answers": {}} for text in has_whole_frame_by_text]
    answers = node("values", items)
    assert [(answer["verdict"], answer["reports"]) for answer in answers] == [("not_usable", ["error"])] * len(items)
    have_temperature = ["tmp.temperature" in answer["fields"] for answer in answers]
    assert have_temperature == list(has_whole_frame_by_text.values())


@pytest.mark.starts_process
def test_errors_and_reports_are_those_of_the_command(node: Asker, capsys: pytest.CaptureFixture[str]) -> None:
    """The last digit of tmp, and then of both channels, is changed. The others have another number of bits."""
    texts = [
        "0x63a2ba03b57",
        "0x63a2ba03b56",
        "0x63a2b803b56",
        "0F 42 43 00 00 00 00 00",
        "0b" + "01" * 36,
    ]
    answers = node("lines", [{"code": CODE, "text": text} for text in texts])
    for text, ((_, _, answer),) in zip(texts, answers, strict=True):
        main(["decode", CODE, text, "--json", "--specs", str(ENCODERS / "ichaus")])
        data: dict[str, Any] = json.loads(capsys.readouterr().out)
        rows = [row.split("\t") for row in answer.splitlines()]
        problems = [[problem["kind"], problem["field"] or "", problem["message"]] for problem in data["problems"]]
        assert [row[1:] for row in rows if row[0] == "problem"] == problems
        reports = [[report["field"], report["meaning"]] for report in data["reports"]]
        assert [row[1:3] for row in rows if row[0] == "report"] == reports
        assert (["verdict", data["verdict"] or ""]) in rows
        assert bool(problems or reports)
