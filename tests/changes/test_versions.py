"""Versions that follow from changes, their records, and headers of two generations, which do not compile together."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from shutil import copytree

import pytest
from codewheel.changes.impact import Impact
from codewheel.changes.version import due
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.targets import Library
from codewheel.targets.c.files import TARGET
from codewheel.targets.c.generation import generation
from codewheel.targets.docs.files import generate as generate_docs
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
    assert due(version, impact) == expected


def specs(folder: Path, *edits: tuple[str, str]) -> Path:
    copytree(BASE, folder)
    for old, new in edits:
        for place in folder.glob("*.yaml"):
            text = place.read_text(encoding="utf-8")
            place.write_text(text.replace(old, new), encoding="utf-8")
    return folder


def headers(folder: Path, *edits: tuple[str, str]) -> dict[str, str]:
    devices, report = load_library([specs(folder, *edits)])
    assert not report.problems
    files = TARGET.files(Library(devices), {})
    return {name.removeprefix("c/include/"): text for name, text in files.items() if name.endswith(".h")}


def compiled(folder: Path, texts: dict[str, str], source: str, compiler: str = "gcc") -> tuple[int, str]:
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    language = ["-std=c99", "-xc"] if compiler == "gcc" else ["-std=c++11", "-xc++"]
    command = [compiler, *language, "-Wall", "-Wextra", "-Wundef", "-Werror", "-fsyntax-only", f"-I{folder}", "-"]
    done = subprocess.run(command, input=source, capture_output=True, text=True)
    return done.returncode, done.stderr


NEXT = ('version: "1.4.2"', 'version: "2.0.0"')


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "g++"])
@pytest.mark.parametrize("mixed", ["demo.h", "biss.h"])
def test_headers_of_two_generations(tmp_path: Path, compiler: str, mixed: str) -> None:
    old, new = headers(tmp_path / "old"), headers(tmp_path / "new", NEXT)
    source = f'#include "maker/{mixed}"\n'
    assert compiled(tmp_path / "c", old, source, compiler) == (0, "")
    assert compiled(tmp_path / "c", new, source, compiler) == (0, "")
    for one, other, version in ((old, new, "2.0.0"), (new, old, "1.4.2")):
        code, said = compiled(tmp_path / "c", {**one, f"maker/{mixed}": other[f"maker/{mixed}"]}, source, compiler)
        assert code != 0
        first = next(line for line in said.splitlines() if "error" in line)
        assert first.endswith(
            f'#error "maker/{mixed} {version} and maker/encoder.h differ in generation: take both from one folder"'
        )


@pytest.mark.slow
def test_the_generation_costs_nothing(tmp_path: Path) -> None:
    """No object file contains it."""
    old, new = headers(tmp_path / "old"), headers(tmp_path / "new", NEXT)
    made = []
    for name, texts in (("one", old), ("two", new)):
        assert compiled(tmp_path / name, texts, '#include "maker/demo.h"\n') == (0, "")
        function = "uint32_t f(const maker_demo_variant *v) { return maker_demo_ssi_word_bits(v); }"
        source = f'#include "maker/demo.h"\n{function}\n'
        command = ["gcc", "-std=c99", "-O2", "-S", f"-I{tmp_path / name}", "-xc", "-", "-o", "-"]
        made.append(subprocess.run(command, input=source, capture_output=True, text=True, check=True).stdout)
    assert made[0] == made[1]


def test_what_makes_a_generation(tmp_path: Path) -> None:
    """It depends on version, options and shared headers, but not on the words of a family."""
    devices, _ = load_library([specs(tmp_path / "specs")])
    maker = devices[0].manufacturer
    one = generation(maker, {"a": "b"}, ["text"])
    assert one == generation(maker, {"a": "b"}, ["text"])
    assert len({one, generation(maker, {"a": "c"}, ["text"]), generation(maker, {"a": "b"}, ["texts"])}) == 3
    plain = headers(tmp_path / "one")["maker/encoder.h"]
    assert plain == headers(tmp_path / "two", ("meaning: Saves", "meaning: Keeps"))["maker/encoder.h"]
    assert plain != headers(tmp_path / "three", NEXT)["maker/encoder.h"]


@pytest.mark.slow
def test_what_is_recorded(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    specs(Path("old"))
    specs(Path("new"), ("max_hz: 10000000", "max_hz: 5000000"))
    expected = (
        "recorded in new/manufacturer.yaml\n"
        "recorded in new/demo.changes.json\n"
        "demo\n"
        "  behaviour      BiSS: highest clock 10 MHz → 5 MHz\n"
        "                 all 4 BiSS order codes; C, Python, XML [clock-narrower]\n"
        "1 change: 1 behaviour\n"
    )
    assert main(["diff", "old", "new", "--record"]) == 1
    said = capsys.readouterr().out
    assert said.startswith(expected)
    assert said.endswith("maker_encoders 1.4.2 → 2.0.0\n")
    assert 'version: "2.0.0"' in Path("new/manufacturer.yaml").read_text(encoding="utf-8")
    kept = Path("new/demo.changes.json").read_text(encoding="utf-8")
    assert json.loads(kept) == {
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
            }
        ]
    }
    # Recording again duplicates nothing, and the next version comes before the last.
    assert main(["diff", "old", "new", "--record"]) == 1
    assert Path("new/demo.changes.json").read_text(encoding="utf-8") == kept
    specs(Path("next"), NEXT, ("max_hz: 10000000", "max_hz: 5000000"), ("meaning: Saves", "meaning: Keeps"))
    Path("next/demo.changes.json").write_text(kept, encoding="utf-8")
    assert main(["diff", "new", "next", "--record"]) == 1
    releases = json.loads(Path("next/demo.changes.json").read_text(encoding="utf-8"))["releases"]
    assert [(item["version"], item["since"]) for item in releases] == [("2.0.1", "2.0.0"), ("2.0.0", "1.4.2")]


def test_the_page_of_changes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new = specs(tmp_path / "old"), specs(tmp_path / "new", ("max_hz: 10000000", "max_hz: 5000000"))
    main(["diff", str(old), str(new), "--record"])
    devices, _ = load_library([new])
    page = generate_docs(Library(devices))["docs/demo-changes.md"]
    assert page.endswith(
        "\n## 2.0.0\n\nChanges since 1.4.2, with revision 1.0 of the manual.\n\n**Behaviour**\n\n"
        "- BiSS: highest clock 10 MHz → 5 MHz (`clock-narrower`): all 4 BiSS order codes; C, Python, XML\n"
    )


def test_the_page_without_a_recorded_release(tmp_path: Path) -> None:
    devices, _ = load_library([specs(tmp_path / "specs")])
    page = generate_docs(Library(devices))["docs/demo-changes.md"]
    told = "No release is recorded yet. Version 1.4.2 has no known changes to this family.\n"
    assert page.endswith(f"family are not listed.\n\n{told}")
    assert "\n## " not in page


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"releases": [{"version": 2}]}', '{"releases": [1]}'])
def test_a_history_that_was_spoilt(tmp_path: Path, text: str) -> None:
    folder = specs(tmp_path / "specs")
    (folder / "demo.changes.json").write_text(text, encoding="utf-8")
    _, report = load_library([folder])
    wrong = "the file is not as written; undo your edit, or remove it and write it again: codewheel diff --record"
    place = f"{folder}/demo.changes.json:1:1: changes-file"
    assert [problem.format() for problem in report.problems] == [f"{place}: {wrong}"]


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
    old = specs(tmp_path / "old")
    new = specs(tmp_path / "new", ("max_hz: 10000000", "max_hz: 5000000"), *edits)
    code = main(["diff", str(old), str(new), "--record"])
    err = capsys.readouterr().err
    assert code == 1
    if message:
        assert err == (
            f'codewheel: {new}/manufacturer.yaml has no line like version: "1.4.2"; set it to 2.0.0 by hand\n'
        )
        assert not (new / "demo.changes.json").exists()


def test_a_folder_is_needed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old = specs(tmp_path / "old")
    assert main(["diff", str(old), str(old / "demo.yaml"), "--record"]) == 2
    assert capsys.readouterr().err == (
        "codewheel: --record needs a folder of specs: all families of a manufacturer share a version\n"
    )
