"""Words whose only check is a parity bit, all read one clock early or late: half of them pass the check."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from browser_harness import Asker, cases, library_of
from codewheel.commands.cli import main
from codewheel.targets import Library

Capture = pytest.CaptureFixture[str]

#: Words of an AS5047P, read one clock late. The second one fails the parity check.
SHIFTED = ("0x255E", "0xA91A", "0x6FFF", "0xA3BB")
EARLY = "started one clock early, as with the other clock edge: an extra bit is in front, and the last bit is missing"
LATE = "started one clock late, as with the other clock edge: the first bit is missing, and an extra bit follows"


def printed(capsys: Capture, *frames: str) -> str:
    main(["decode", "AS5047P", "\n".join(frames)])
    return " ".join(capsys.readouterr().out.split())


def test_a_failing_word_names_the_shift_before_noise(capsys: Capture) -> None:
    text = printed(capsys, "0xA91A")
    assert "no change is needed" not in text
    assert text.index("A shift by one clock passes") < text.index("one bit may have been corrupted")
    assert "most likely first. Each of them is uncertain: - started one clock" in text


def test_all_words_together_name_the_shift(capsys: Capture) -> None:
    text = printed(capsys, *SHIFTED)
    together = "Together, all 4 frames, also the valid ones, have this explanation, most likely first: "
    assert f"{together}- {LATE} - {EARLY}" in text


def test_a_few_failing_words_are_noise(capsys: Capture) -> None:
    """One word of five fails."""
    assert "Together" not in printed(capsys, *SHIFTED, "0xA3BB")


@pytest.mark.starts_process
def test_the_page_names_the_same_mistakes(ask: Callable[[Library, str], Asker]) -> None:
    library = library_of("../specs/ams/as5047p")
    case = next(case for (case, *_) in cases(library.devices[0]) if case.layout.name == "position")
    frame_groups = [SHIFTED, (*SHIFTED, "0xA3BB"), ("0x255E", "0xA3BB")]
    page_answers = ask(library, "node")("together", [{**case.data, "frames": [*group]} for group in frame_groups])
    mistakes_of_all_frames = []
    for mistakes, _, are_in_all in page_answers:
        mistakes_of_all_frames.append([text for text, *_ in mistakes] if are_in_all else [])
    assert mistakes_of_all_frames == [[LATE, EARLY], [], []]
