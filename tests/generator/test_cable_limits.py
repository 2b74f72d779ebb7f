"""Clock limits by cable length that include the limit, in every output: 1 MHz below 3 m, 400 kHz, and 100 kHz."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from c_harness import GCC, write
from codewheel.commands.cli import main
from codewheel.dump.plain import device_dump
from codewheel.dump.xml import to_xml
from codewheel.targets import Library
from codewheel.targets.docs.files import generate as generate_pages
from five_engines import SPECS, load_made

pytestmark = pytest.mark.slow

SPEC_FILES = [str(SPECS / "cables.yaml"), str(SPECS / "manufacturer.yaml")]
PROGRAM = """
#include "test/cables_ssi.h"
#include <stdio.h>
int main(void) {
    printf("%u %u %u %u", test_cables_ssi_clock_limit_hz(2U), test_cables_ssi_clock_limit_hz(3U),
        test_cables_ssi_clock_limit_hz(399U), test_cables_ssi_clock_limit_hz(400U));
    return 0;
}
"""


def test_python_returns_the_limit_that_the_clock_must_be_below(
    import_generated: Callable[[Library, str], tuple[Path, ModuleType]],
) -> None:
    package: Any = import_generated(Library((load_made("cables"),)), "test_encoders")[1]
    facts = package.cables.SSI
    assert [(row.below_hz, row.at_most_hz) for row in facts.cable_lengths] == [
        (None, 1_000_000),
        (None, 400_000),
        (None, 100_000),
    ]
    assert [facts.clock_below_hz(metres) for metres in (2.9, 3, 399, 400)] == [1_000_001, 400_001, 100_001, None]


def test_c_returns_the_limit_and_says_that_it_is_allowed(tmp_path: Path) -> None:
    device = load_made("cables")
    include = write(tmp_path, (device,))
    header = (include / "test" / "cables_ssi.h").read_text(encoding="utf-8")
    assert "frequency in hertz up to which the clock may go with a cable" in " ".join(header.replace("*", "").split())
    (tmp_path / "limits.c").write_text(PROGRAM, encoding="utf-8")
    warnings = ("-Wall", "-Wextra", "-Werror")
    subprocess.run([*GCC, *warnings, f"-I{include}", "limits.c", "-o", "limits"], cwd=tmp_path, check=True)
    done = subprocess.run([tmp_path / "limits"], capture_output=True, text=True, check=True)
    assert done.stdout == "1000000 400000 100000 0"


def test_xml_json_and_pages_have_the_limit() -> None:
    device = load_made("cables")
    assert '<cable_length shorter_than_m="3" at_most_hz="1000000"/>' in to_xml(device_dump(device))
    pages = generate_pages(Library((device,)))
    page = " ".join(pages["docs/cables/CAB12.md"].split())
    assert "| Cable below | Clock up to | Frame |" in page
    assert "- Clock: at most 400 kHz with cables shorter than 50 m" in page


@pytest.mark.parametrize(("metres", "kilohertz"), [("2", 1000), ("3", 400), ("49", 400), ("60", 100)])
def test_a_master_may_use_the_limit(metres: str, kilohertz: int, capsys: pytest.CaptureFixture[str]) -> None:
    specs = [argument for file in SPEC_FILES for argument in ("--specs", file)]
    words = ["--master", "linuxcnc_hostmot2", "--json", "--cable", metres, *specs]
    assert main(["master", "CAB12", *words]) == 0
    (master,) = json.loads(capsys.readouterr().out)["masters"]
    clock = next(setting for setting in master["settings"] if setting["name"] == "frequency-khz")
    assert (clock["bound"], clock["value"]) == ("at_most", kilohertz)


def test_an_exclusive_limit_is_a_change_and_another_reading(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, key in (("old", "below_hz"), ("new", "at_most_hz")):
        folder = tmp_path / name
        folder.mkdir()
        for file in SPEC_FILES:
            text = Path(file).read_text(encoding="utf-8").replace("at_most_hz", key)
            (folder / Path(file).name).write_text(text, encoding="utf-8")
    assert main(["diff", str(tmp_path / "old"), str(tmp_path / "new")]) == 1
    assert "at_most_hz = 1000000" in " ".join(capsys.readouterr().out.split())
    other_text = (tmp_path / "old" / "cables.yaml").read_text(encoding="utf-8")
    evidence = next(line for line in other_text.splitlines() if line.startswith("evidence:"))
    (tmp_path / "new" / "cables.second.yaml").write_text(other_text.replace(f"{evidence}\n", ""), encoding="utf-8")
    assert main(["check", str(tmp_path / "new")]) == 1
    assert "at most 400000 Hz here, below 400000 Hz in cables.second.yaml" in " ".join(capsys.readouterr().out.split())
