"""Labels as people write them: the script reads each one like the command line, and gives the same help."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from browser_harness import Asker
from codewheel.commands.cli import main
from codewheel.commands.find_encoder import find_among
from codewheel.commands.terminal import CommandError
from codewheel.loading.library import load_library
from codewheel.targets import Library
from exhaustive import mostly_exhaustive

LABELS = (
    "AMM5A21/65KSC1",
    " amm5a21 / 65ksc1 ",
    "\ufeffAMM5A21/65KSC1",
    "\x1cAMM5A21/\x8565KSC1\x1f",
    "AMM5A21/65KSC1-K",
    "AMM5B23/65KJP1/S123",
    "AMM5A21/65KSC1-XYZ/S42",
    "AM3616/4096-I7",
    "AM3616/4096SC1",
    "AMC3619/4096BG2",
    "AM3616/4096-SC",
    "AM3617/4096-I7",
    "AM3616/4096-17",
    "AM3617/4096-BG",
    "ASC8525/SC2-X",
    "ASC8520/BG7",
    "SMA21-JP1-0050",
    "SMA21-GG1-0001-M8",
    "AMM5A19/65KSC1",
    "AMM5A21/65K",
    "AMM5A21",
    "AMM5",
    "amm5",
    "sma21",
    "SMA21-JP1-0051",
    "SMA21-JP1",
    "ASC85",
    "ASC8529/SC1",
    "AMM5C21/65KSC1",
    "AMM5A21-65KSC1",
    "nothing/1",
    "FOO",
    "AMM5A21/65KSC1" + "-" + "X" * 100,
)
#: End of a message that only the command line prints.
COMMANDS = (" (codewheel show ", "; codewheel list shows")


def description_of(library: Library, text: str) -> Any:
    """Return the order code or the help of the command line for a label, without commands to run."""
    try:
        device, match = find_among(library.devices, text)
    except CommandError as stop:
        message = str(stop)
        for command in COMMANDS:
            message = message.partition(command)[0]
        return message
    description = match.variant.code, list(match.unlisted), match.tail, match.special, match.written_as_in
    return [device.name, *description]


@pytest.mark.slow
def test_labels_of_people(node: Asker, library: Library) -> None:
    answers = node("labels", [{"texts": LABELS}])[0]
    assert dict(zip(LABELS, answers, strict=True)) == {text: description_of(library, text) for text in LABELS}


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_exhaustive([60, 600], 60))
def test_labels_with_mistakes(count: int, node: Asker, library: Library) -> None:
    """One character of a listed code is omitted, changed, or written twice."""
    random_ = random.Random(5)
    codes = [variant.code for device in library.devices for variant in device.variants]
    mistaken_labels = []
    for _ in range(count):
        code = random_.choice(codes)
        position = random_.randrange(len(code))
        replacement = random_.choice(["", random_.choice("0123456789ABSKJPCG/-"), 2 * code[position]])
        mistaken_labels.append(code[:position] + replacement + code[position + 1 :])
    page_answers = node("labels", [{"texts": mistaken_labels}])[0]
    differing_answers = {}
    for label, page_answer in zip(mistaken_labels, page_answers, strict=True):
        model_answer = description_of(library, label)
        if page_answer != model_answer:
            differing_answers[label] = (page_answer, model_answer)
    assert differing_answers == {}


@pytest.mark.slow
def test_a_code_is_not_read_as_a_shorter_one_with_a_tail(ask: Callable[[Library, str], Asker], tmp_path: Path) -> None:
    """``A-SP`` of one family with the tail ``-X-SP`` is also a code of another one."""
    for name in ("a", "a_sp_x"):
        assert main(["new", name, "--like", "spi", "-o", str(tmp_path)]) == 0
    devices, report = load_library([tmp_path])
    assert not report
    library = Library(devices)
    answers = ask(library, "node")("labels", [{"texts": ["A-SP-X-SP", "A-SP-X", "A-SP"]}])[0]
    assert [answer[:2] for answer in answers] == [["a_sp_x", "A-SP-X-SP"], ["a", "A-SP"], ["a", "A-SP"]]
    assert answers == [description_of(library, text) for text in ("A-SP-X-SP", "A-SP-X", "A-SP")]
