"""The grade of the evidence is in every output, and decides where a spec may be."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.commands.outputs import family_of
from codewheel.loading.configuration_file import read_configuration
from codewheel.loading.library import load_library
from codewheel.output_folder import families_in
from codewheel.targets import Library
from codewheel.targets.registry import files_of, load_target

ROOT = Path(__file__).parents[2]
ENCODERS = ROOT / "specs"
#: One frame of zeros with the CRC that an encoder over BiSS sends with it.
FRAME = "0b" + "0" * 33 + "11" + "000000"


@pytest.mark.slow
def test_the_grade_decides_whose_files_are_tracked() -> None:
    """Code and pages of the highest two grades are in the repository. The decode page decodes the frames of all."""
    settings = read_configuration(ROOT / "pyproject.toml")
    assert settings is not None
    devices, report = load_library([ROOT / "specs"])
    assert not report
    tracked = sorted(family_of(device) for device in devices if device.evidence.grade in ("manual", "quoted"))
    for target in ("c", "python", "biss", "docs"):
        assert settings.only[target].grades == ("manual", "quoted")
        assert {name.partition("/")[2] for name in families_in(ROOT / "generated" / target)} == {*tracked}
    every = {family_of(device) for device in devices}
    assert {name.partition("/")[2] for name in families_in(ROOT / "generated" / "browser")} == every
    assert families_in(ROOT / "generated" / "masters") == ["lika/amm5"]


@pytest.mark.slow
def test_the_index_lists_each_encoder_with_its_grade() -> None:
    page = (ROOT / "docs/encoder/encoders.md").read_text(encoding="utf-8")
    devices, report = load_library([ENCODERS])
    assert not report
    listed_grades = {name: grade for grade, name in re.findall(r"\| ([a-z, ]+) \| \[(\w+)\]\(", page)}
    assert listed_grades == {device.name: device.evidence.grade for device in devices}


def test_it_is_in_every_output() -> None:
    devices, report = load_library([ENCODERS / "posital"])
    assert not report
    library = Library(devices)
    texts = {}
    for name in ("c", "python", "docs", "biss"):
        for path, text in files_of(load_target(name), library, {}).items():
            texts[path] = " ".join(str(text).replace("*", " ").split())
    grade = "Evidence: uncorroborated (the facts have a single source, so do not rely on them)."
    assert grade in texts["c/include/posital/kcd_biss.h"]
    assert grade in texts["python/posital_encoders/kcd.py"]
    assert grade in texts["docs/kcd.md"]
    assert "| uncorroborated |" in texts["docs/README.md"]
    assert "| uncorroborated |" in texts["python/README.md"]
    assert 'evidence grade="uncorroborated"' in texts["biss/posital-kcd.xml"]
    assert "| Left out | Registers, alarms, timings" in texts["docs/kcd/manual.md"]


def test_decode_ends_with_it(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["decode", "KCD-BC03B-1617", FRAME, "--specs", str(ENCODERS)]
    main(arguments)
    assert capsys.readouterr().out.splitlines()[-1] == "evidence: uncorroborated"
    main([*arguments, "--json"])
    assert json.loads(capsys.readouterr().out)["evidence"] == "uncorroborated"
    main(["show", "KCD-BC03B-1617", "--json", "--specs", str(ENCODERS)])
    assert json.loads(capsys.readouterr().out)["evidence"]["implementations"] == ["cfg"]
