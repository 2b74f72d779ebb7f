"""Labels that no family knows: the page answers like the command line, also for families whose codes are one part."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from browser_harness import Asker
from codewheel.loading.library import load_library
from codewheel.targets import Library
from test_browser_labels import description_of

ENCODERS = Path(__file__).parents[2] / "specs"
CHIPS = (
    "iC-MR",
    "iC-MU",
    "icmhm",
    "iC-MR-24-L16S",
    "iC-MR-13-L6T",
    "iC-MU-28",
    "iC-MX",
    "iC",
    "ic mr",
    "iC-MHM-X",
    "-/-",
)
LABELS = ("EQN1325", "EQN1325-X", "AS5047", "AS5047P", "AS5047P-X", "as5048a/S1", "", "-", "AS5047P1")


@pytest.mark.starts_process
def test_labels_that_begin_like_a_family(ask: Callable[[Library, str], Asker]) -> None:
    devices, report = load_library([ENCODERS / "ichaus"])
    assert not report
    library = Library(devices)
    answers = ask(library, "node")("labels", [{"texts": CHIPS}])[0]
    assert dict(zip(CHIPS, answers, strict=True)) == {text: description_of(library, text) for text in CHIPS}
    assert answers[0] == "'iC-MR' is a family; give an order code, such as iC-MR-0-N6S"


@pytest.mark.slow
def test_a_label_that_begins_with_a_name(ask: Callable[[Library, str], Asker]) -> None:
    """mjbots/moteus, pull request 91: the label AMT222B-V, on which codewheel's order code AMT22-14 is not printed."""
    devices, report = load_library([ENCODERS / "cui"])
    assert not report
    library = Library(devices)
    labels = ("AMT222B-V", "AMT22", "AMT213X-V", "AMT2")
    answers = ask(library, "node")("labels", [{"texts": labels}])[0]
    assert answers == [description_of(library, text) for text in labels]
    assert "AMT22-14" in answers[0]


@pytest.mark.slow
def test_labels_of_families_of_one_part(ask: Callable[[Library, str], Asker]) -> None:
    devices, report = load_library([ENCODERS / "ams"])
    assert not report
    library = Library(devices)
    assert any(device.order_code.pattern == "{model}" for device in devices)
    answers = ask(library, "node")("labels", [{"texts": LABELS}])[0]
    assert dict(zip(LABELS, answers, strict=True)) == {text: description_of(library, text) for text in LABELS}
