"""The data channels of a frame are read twice: their order, and the bits of each that are compared."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from codewheel.commands.check.specs import check_specs

# Reads whole specs twice, which does not depend on wording or rules of check.
pytestmark = pytest.mark.slow

SPECS = Path(__file__).resolve().parents[1] / "specs"
#: Names that differ from the first reading. Names are not facts.
OTHER_NAMES = {"control_word": "first", "safety_word": "second", "safe_singleturn": "angle"}


def second_reading() -> str:
    """Return the spec as another reader writes it: without sources and texts, and with other names."""
    text = (SPECS / "channels.yaml").read_text(encoding="utf-8")
    kept = ("codewheel:", "device:", "movement:")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    lines = [line for line in lines if not line.startswith(("manufacturer:", "title:", "evidence:")) or line in kept]
    reading = "\n".join(line for line in lines if not line.strip().startswith(("source:", "printed_name:")))
    reading = re.sub(r", (source|meaning|when_active): (\"[^\"]*\"|[^,}]*)", "", reading)
    reading = re.sub(r"\{meaning: (\"[^\"]*\"|[^,}]*)(, )?", "{", reading)
    reading = re.sub(r"\n\s+meaning: .*", "", reading)
    for name, other_name in OTHER_NAMES.items():
        reading = reading.replace(name, other_name)
    return reading.replace('title: Made up, revision: "1"', 'revision: "1"')


def problems(folder: Path, reading: str) -> list[str]:
    shutil.copy(SPECS / "manufacturer.yaml", folder)
    shutil.copy(SPECS / "channels.yaml", folder)
    (folder / "channels.second.yaml").write_text(reading, encoding="utf-8")
    return [problem.message for problem in check_specs([folder], []).report.problems]


def test_readings_with_other_names_agree(tmp_path: Path) -> None:
    assert problems(tmp_path, second_reading()) == []


@pytest.mark.parametrize(
    ("old", "new", "fact"),
    [
        ("channel: 2", "channel: 3", "order of the data channels in a frame"),
        ("accurate_bits: 13", "accurate_bits: 12", "the parameter 'accurate_bits'"),
        ("tolerance: 1", "tolerance: 2", "tolerance"),
    ],
)
def test_a_difference_is_reported(tmp_path: Path, old: str, new: str, fact: str) -> None:
    reading = second_reading()
    assert old in reading
    messages = problems(tmp_path, reading.replace(old, new))
    assert any(message.startswith(fact) for message in messages), messages
