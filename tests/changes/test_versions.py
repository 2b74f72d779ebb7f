"""Versions that follow from changes, their records, and headers that refuse a runtime of another version."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from shutil import copytree

import pytest
from codewheel.changes.rules import Impact, due_version
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.targets import Library
from codewheel.targets.c.files import TARGET
from codewheel.targets.docs.files import generate as generate_docs
from exhaustive import mostly_exhaustive
from pair import BASE

NONE, WORDS, NEW, OTHER, BROKEN = Impact


@pytest.mark.parametrize(
    ("version", "impact", "expected"),
    [
        ("1.4.2", NONE, "1.4.2"),
        ("1.4.2", WORDS, "1.4.3"),
        ("1.4.2", NEW, "1.5.0"),
        ("1.4.2", OTHER, "2.0.0"),
        ("1.4.2", BROKEN, "2.0.0"),
        ("0.4.2", NONE, "0.4.2"),
        ("0.4.2", WORDS, "0.4.3"),
        ("0.4.2", NEW, "0.4.3"),
        ("0.4.2", OTHER, "0.5.0"),
        ("0.4.2", BROKEN, "0.5.0"),
    ],
)
def test_the_version_that_is_due(version: str, impact: Impact, expected: str) -> None:
    assert due_version(version, impact) == expected


def write_specs(folder: Path, *edits: tuple[str, str]) -> Path:
    copytree(BASE, folder)
    for old, new in edits:
        for place in folder.glob("*.yaml"):
            text = place.read_text(encoding="utf-8")
            place.write_text(text.replace(old, new), encoding="utf-8")
    return folder


def headers(folder: Path, *edits: tuple[str, str]) -> dict[str, str]:
    devices, report = load_library([write_specs(folder, *edits)])
    assert not report.problems
    files = TARGET.files(Library(devices), {})
    return {name.removeprefix("c/include/"): text for name, text in files.items() if name.endswith(".h")}


def compile_source(folder: Path, texts: dict[str, str], source: str, compiler: str = "gcc") -> tuple[int, str]:
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    language = ["-std=c99", "-xc"] if compiler == "gcc" else ["-std=c++11", "-xc++"]
    command = [compiler, *language, "-Wall", "-Wextra", "-Wundef", "-Werror", "-fsyntax-only", f"-I{folder}", "-"]
    done = subprocess.run(command, input=source, capture_output=True, text=True)
    return done.returncode, done.stderr


NEXT = ('version: "1.4.2"', 'version: "2.0.0"')


def with_runtime(texts: dict[str, str], major: int, minor: int) -> dict[str, str]:
    """The same headers with a runtime of another version."""
    updated = dict(texts)
    for name in texts:
        if name.startswith("codewheel/"):
            text = texts[name].replace("RUNTIME_MAJOR 1", f"RUNTIME_MAJOR {major}")
            text = text.replace("RUNTIME_MINOR 0", f"RUNTIME_MINOR {minor}")
            updated[name] = text.replace("_MAJOR != 1)", f"_MAJOR != {major})").replace(
                "_MINOR != 0)", f"_MINOR != {minor})"
            )
    return updated


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "g++"])
def test_headers_and_runtimes_of_two_generations(
    compiler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The runtime has the same major version and at least the same minor version, or it is refused in one sentence."""
    old = headers(tmp_path / "old")
    monkeypatch.setattr("codewheel.targets.c.files.runtime_version", lambda: (1, 3))
    new = with_runtime(headers(tmp_path / "new", NEXT), 1, 3)
    for header, runtime, version in (
        (old, old, ""),
        (new, new, ""),
        (old, new, ""),
        (new, old, "1.3"),
        (new, with_runtime(old, 1, 2), "1.3"),
        (old, with_runtime(old, 2, 0), "1.0"),
        (old, with_runtime(old, 0, 9), "1.0"),
    ):
        texts = {**runtime, "maker/demo_ssi.h": header["maker/demo_ssi.h"]}
        exit_code, compiler_output = compile_source(tmp_path / "c", texts, '#include "maker/demo_ssi.h"\n', compiler)
        assert (exit_code == 0) == (version == ""), compiler_output
        errors = [line for line in compiler_output.splitlines() if "error" in line]
        wanted = (
            f'#error "maker/demo_ssi.h needs the codewheel runtime {version} or a newer 1.x: see codewheel/version.h"'
        )
        assert [line.endswith(wanted) for line in errors[:1]] == ([True] if version else [])


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "g++"])
def test_a_runtime_of_two_versions(compiler: str, tmp_path: Path) -> None:
    """Each header of the runtime names its version, for a folder that was assembled by hand."""
    old = {name: text for name, text in headers(tmp_path / "old").items() if name.startswith("codewheel/")}
    new = with_runtime(old, 1, 1)
    for name in sorted(set(old) - {"codewheel/version.h"}):
        source = f'#include "{name}"\n'
        assert compile_source(tmp_path / "c", old, source, compiler) == (0, "")
        exit_code, compiler_output = compile_source(tmp_path / "c", {**new, name: old[name]}, source, compiler)
        assert exit_code != 0
        first = next(line for line in compiler_output.splitlines() if "error" in line)
        assert first.endswith(f'#error "{name} 1.0 and version.h differ: take all of codewheel/ from one folder"')


@pytest.mark.slow
def test_the_version_of_the_runtime_costs_nothing(tmp_path: Path) -> None:
    """No object file contains it."""
    old = headers(tmp_path / "old")
    assemblies = []
    for name, texts in (("one", old), ("two", with_runtime(old, 1, 7))):
        assert compile_source(tmp_path / name, texts, '#include "maker/demo_ssi.h"\n') == (0, "")
        function = "uint32_t f(maker_demo_ssi v) { return maker_demo_ssi_bits(v); }"
        source = f'#include "maker/demo_ssi.h"\n{function}\n'
        command = ["gcc", "-std=c99", "-O2", "-S", f"-I{tmp_path / name}", "-xc", "-", "-o", "-"]
        assemblies.append(subprocess.run(command, input=source, capture_output=True, text=True, check=True).stdout)
    assert assemblies[0] == assemblies[1]


RECORDED = {
    "releases": [
        {
            "version": "2.0.0",
            "since": "1.4.2",
            "manual": "1.0",
            "changes": [
                {
                    "rule": "clock-narrower",
                    "impact": "behaviour",
                    "text": "BiSS: highest clock 10 MHz → 5 MHz",
                    "reach": "all 4 BiSS order codes",
                    "outputs": "C, Python, XML",
                }
            ],
            "names": ["C macro MAKER_DEMO_BISS_CLOCK_MAX_HZ: 10000000U → 5000000U"],
        }
    ]
}


@pytest.mark.slow
def test_what_is_recorded(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_specs(Path("old"))
    write_specs(Path("new"), ("max_hz: 10000000", "max_hz: 5000000"))
    expected = (
        "recorded in new/manufacturer.yaml\n"
        "recorded in new/demo.changes.json\n"
        "demo\n"
        "  behaviour      BiSS: highest clock 10 MHz → 5 MHz\n"
        "                 all 4 BiSS order codes; C, Python, XML [clock-narrower]\n"
        "  names          C macro MAKER_DEMO_BISS_CLOCK_MAX_HZ: 10000000U → 5000000U\n"
        "1 change: 1 behaviour\n"
    )
    assert main(["diff", "old", "new", "--record"]) == 1
    printed = capsys.readouterr().out
    assert printed.startswith(expected)
    assert printed.endswith("maker_encoders 1.4.2 → 2.0.0\n")
    assert 'version: "2.0.0"' in Path("new/manufacturer.yaml").read_text(encoding="utf-8")
    recorded = Path("new/demo.changes.json").read_text(encoding="utf-8")
    assert json.loads(recorded) == RECORDED
    # Recording again duplicates nothing, and the next version comes before the last.
    assert main(["diff", "old", "new", "--record"]) == 1
    assert Path("new/demo.changes.json").read_text(encoding="utf-8") == recorded
    write_specs(Path("next"), NEXT, ("max_hz: 10000000", "max_hz: 5000000"), ("meaning: Saves", "meaning: Keeps"))
    Path("next/demo.changes.json").write_text(recorded, encoding="utf-8")
    assert main(["diff", "new", "next", "--record"]) == 1
    releases = json.loads(Path("next/demo.changes.json").read_text(encoding="utf-8"))["releases"]
    assert [(release["version"], release["since"]) for release in releases] == [("2.0.1", "2.0.0"), ("2.0.0", "1.4.2")]


OVERLAY = """\
codewheel: 1
overlay: mine
of: demo
title: Measured here
changes:
  - {set: interfaces.biss.clock.min_hz, to: 90000, why: Measured., source: "1"}
"""


@pytest.mark.slow
@pytest.mark.parametrize("applies_to", mostly_exhaustive(["", "applies_to: {special: S007}\n"], ""))
def test_a_family_with_an_overlay_is_recorded(tmp_path: Path, applies_to: str) -> None:
    """The overlay has no version, and a special model has no history of its own."""
    old, new = write_specs(tmp_path / "old"), write_specs(tmp_path / "new", ("max_hz: 10000000", "max_hz: 5000000"))
    for folder in (old, new):
        (folder / "mine.yaml").write_text(OVERLAY.replace("changes:", f"{applies_to}changes:"), encoding="utf-8")
    earlier = {**RECORDED["releases"][0], "version": "1.4.2", "since": "1.4.1"}
    history = new / "demo.changes.json"
    history.write_text(json.dumps({"releases": [earlier]}), encoding="utf-8")
    assert main(["diff", str(old), str(new), "--record"]) == 1
    assert 'version: "2.0.0"' in (new / "manufacturer.yaml").read_text(encoding="utf-8")
    assert (new / "mine.yaml").read_text(encoding="utf-8").count("version") == 0
    devices, _ = load_library([new])
    assert [[release.version for release in device.releases] for device in devices] == len(devices) * [
        ["2.0.0", "1.4.2"]
    ]
    release, earlier_release = json.loads(history.read_text(encoding="utf-8"))["releases"]
    assert earlier_release == earlier
    assert release["changes"] == RECORDED["releases"][0]["changes"]
    names = (
        ["MAKER_DEMO_BISS_CLOCK_MAX_HZ", "MAKER_DEMO_S007_BISS_CLOCK_MAX_HZ"]
        if applies_to
        else ["MAKER_DEMO_BISS_CLOCK_MAX_HZ"]
    )
    assert release["names"] == [f"C macro {name}: 10000000U → 5000000U" for name in names]


@pytest.mark.slow
def test_the_page_of_changes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new = write_specs(tmp_path / "old"), write_specs(tmp_path / "new", ("max_hz: 10000000", "max_hz: 5000000"))
    main(["diff", str(old), str(new), "--record"])
    devices, _ = load_library([new])
    page = generate_docs(Library(devices))["docs/demo-changes.md"]
    assert page.endswith(
        "\n## 2.0.0\n\nChanges since 1.4.2, with revision 1.0 of the manual.\n\n**Behaviour**\n\n"
        "- BiSS: highest clock 10 MHz → 5 MHz (`clock-narrower`): all 4 BiSS order codes; C, Python, XML\n"
        "\n**Names in code**\n\n- C macro MAKER_DEMO_BISS_CLOCK_MAX_HZ: 10000000U → 5000000U\n"
    )


@pytest.mark.slow
def test_the_page_without_a_recorded_release(tmp_path: Path) -> None:
    devices, _ = load_library([write_specs(tmp_path / "specs")])
    page = generate_docs(Library(devices))["docs/demo-changes.md"]
    ending = "No release is recorded yet. Version 1.4.2 has no known changes to this family.\n"
    assert page.endswith(f"family are not listed.\n\n{ending}")
    assert "\n## " not in page


@pytest.mark.slow
@pytest.mark.parametrize("text", ["", "{}", "[]", '{"releases": [{"version": 2}]}', '{"releases": [1]}'])
def test_a_history_that_was_spoilt(tmp_path: Path, text: str) -> None:
    folder = write_specs(tmp_path / "specs")
    (folder / "demo.changes.json").write_text(text, encoding="utf-8")
    _, report = load_library([folder])
    message = "the file was edited; undo the edit, or remove it and write it again: codewheel diff --record"
    place = f"{folder}/demo.changes.json:1:1: changes-file"
    assert [problem.format() for problem in report.problems] == [f"{place}: {message}"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("edits", "message"),
    [
        ((), ""),
        ((("\nversion: ", "\n? version\n: "),), "nothing"),
    ],
)
def test_a_version_that_cannot_be_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], edits: tuple[tuple[str, str], ...], message: str
) -> None:
    old = write_specs(tmp_path / "old")
    new = write_specs(tmp_path / "new", ("max_hz: 10000000", "max_hz: 5000000"), *edits)
    exit_code = main(["diff", str(old), str(new), "--record"])
    err = capsys.readouterr().err
    assert exit_code == 1
    if message:
        assert err == (
            f'codewheel: {new}/manufacturer.yaml has no line like version: "1.4.2"; set it to 2.0.0 by hand\n'
        )
        assert not (new / "demo.changes.json").exists()


@pytest.mark.slow
def test_a_first_version_gets_a_line(tmp_path: Path) -> None:
    """``codewheel new`` writes a file of the manufacturer without a version."""
    no_version = ("\nversion: ", "\n# version: ")
    old = write_specs(tmp_path / "old", no_version)
    new = write_specs(tmp_path / "new", no_version, ("max_hz: 10000000", "max_hz: 5000000"))
    main(["diff", str(old), str(new), "--record"])
    assert (new / "manufacturer.yaml").read_text(encoding="utf-8").endswith('\nversion: "0.1.0"\n')


def test_a_folder_is_needed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old = write_specs(tmp_path / "old")
    assert main(["diff", str(old), str(old / "demo.yaml"), "--record"]) == 2
    assert capsys.readouterr().err == (
        "codewheel: --record needs a folder of specs: all families of a manufacturer share a version\n"
    )
