"""Several pasted frames, some of which are valid as another layout or come from a dead line: page and command agree."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from browser_harness import Asker, Case, judged_by_command, library_of
from codewheel.commands.cli import main
from codewheel.targets import Library

pytestmark = pytest.mark.slow

Capture = pytest.CaptureFixture[str]

TEXTS = ["AB 61", "54 00 1D", "54 00 1D"]


def judged_by_page(ask: Callable[[Library, str], Asker], name: str, code: str, texts: list[str]) -> tuple[Any, Any]:
    """Return the judgement of the page and that of the command, for a user who does not name the layout."""
    library = library_of(name)
    (device,) = library.devices
    variant = next(variant for variant in device.variants if variant.code == code)
    layouts = device.interface(variant.interface).layouts
    layout = next(layout for layout in layouts if layout.sender == "encoder")
    case = Case(device, variant, layout.place(variant.parameters))
    item = {**case.data, "sender": "encoder", "frameType": f"encoder:{case.layout.name}", "frames": texts}
    (answer,) = ask(library, "node")("together", [item])
    return answer, judged_by_command(case, texts, any_layout=True)


def test_a_frame_of_another_kind_has_no_mistake(ask: Callable[[Library, str], Asker]) -> None:
    """AB 61 is a number of revolutions of an AMT212A. The other frames are requests with their replies."""
    answer, judgement = judged_by_page(ask, "../specs/cui/amt21", "AMT212A", TEXTS)
    assert answer == judgement
    mistakes, failed_count, _ = judgement
    assert failed_count == 2
    assert mistakes[0][1] == 2


def test_dead_frames_have_their_line_in_common(ask: Callable[[Library, str], Asker]) -> None:
    texts = ["0b" + "1" * 48, "0b" + "1" * 48, f"0b{4711:048b}"]
    answer, judgement = judged_by_page(ask, "../specs/magntek/mt6835", "MT6835", texts)
    assert answer == judgement
    assert [text.partition(":")[0] for text, *_ in judgement[0]] == ["every bit is 1"]


def test_the_command_counts_the_frames_that_fail(capsys: Capture) -> None:
    main(["decode", "AMT212A", "\n".join(TEXTS)])
    assert "2 of 2 frames with an error" in " ".join(capsys.readouterr().out.split())
