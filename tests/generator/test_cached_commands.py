"""Commands with the cache: the same output as without it, and only changed families are loaded and checked again."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from codewheel import cache as cache_module
from codewheel.cache import Cache, default_folder
from codewheel.commands.cli import main
from codewheel.language.check import check_document
from codewheel.language.document import Document
from codewheel.language.problems import ProblemReport
from codewheel.loading.library import load_families
from exhaustive import mostly_exhaustive

SPECS = Path(__file__).resolve().parents[2] / "specs" / "lika"
COMMANDS = (
    ("decode", "AMM5A21/65KSC1", "0xF4243D3"),
    ("decode", "AMM5A21/65KSC1", "--as", "serial_number", "0A E8 69 EE", "--json"),
    ("show", "AM3616/4096-I7"),
    ("show", "asc85"),
    ("show", "SMA21-SC4-0050", "--json"),
    ("master", "AMM5A21/65KBG1"),
    ("list",),
    ("list", "--json"),
    ("check",),
    ("check", "--json"),
)
TV62 = Path(__file__).resolve().parents[2] / "docs" / "example" / "tolvarn"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own, which is empty."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(cache_module, "default_folder", default_folder)
    return tmp_path / "cache" / "codewheel"


@pytest.fixture
def specs(tmp_path: Path) -> Path:
    """A copy of our specs."""
    place = tmp_path / "specs"
    shutil.copytree(SPECS, place)
    return place


def said(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(arguments)
    return (code, *capsys.readouterr())


def entries(folder: Path) -> list[Path]:
    return sorted(folder.iterdir()) if folder.is_dir() else []


@pytest.mark.exhaustive
def test_commands_print_the_same_with_and_without_the_cache(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    without = [said(capsys, *command, "--no-cache") for command in COMMANDS]
    assert entries(folder) == []
    order = list(enumerate(COMMANDS)) * 2
    random.Random(33).shuffle(order)
    for index, command in order:
        assert said(capsys, *command) == without[index]
    assert entries(folder)


def test_a_folder_that_cannot_be_written_changes_nothing(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    without = said(capsys, *COMMANDS[0], "--no-cache")
    folder.parent.mkdir()
    folder.write_text("a file instead of a folder", encoding="utf-8")
    assert said(capsys, *COMMANDS[0]) == without
    folder.unlink()

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", full)
        assert said(capsys, *COMMANDS[0]) == without
    assert entries(folder) == []


@pytest.mark.slow
def test_a_changed_spec_is_read_again(folder: Path, specs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Not even the same size and time hide a change."""
    spec = specs / "amm5.yaml"
    command = ("show", "AMM5A21/65KBG1", "--specs", str(specs))
    before = said(capsys, *command)
    text, times = spec.read_text(encoding="utf-8"), spec.stat()
    changed = text.replace("title: AMM5A and AMM5B absolute kit", "title: AMM5A and AMM5B absolute kiT")
    assert len(changed) == len(text)
    assert changed != text
    spec.write_text(changed, encoding="utf-8")
    os.utime(spec, ns=(times.st_atime_ns, times.st_mtime_ns))
    after = said(capsys, *command)
    assert after[1] == before[1].replace("AMM5A and AMM5B absolute kit", "AMM5A and AMM5B absolute kiT")
    spec.write_text(text, encoding="utf-8")
    assert said(capsys, *command) == before


@pytest.mark.slow
@pytest.mark.parametrize("broken", mostly_exhaustive(["amm5.yaml", "manufacturer.yaml"], "amm5.yaml"))
def test_problems_are_reported_as_without_a_selection(
    folder: Path, specs: Path, broken: str, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ("show", "AMM5A21/65KSC1", "--specs", str(specs))
    assert said(capsys, *command)[0] == 0
    spec = specs / broken
    spec.write_text(spec.read_text(encoding="utf-8") + "nonsense: 1\n", encoding="utf-8")
    code, out, err = said(capsys, *command)
    assert (code, out) == (1, "")
    assert f"{broken}:" in err
    assert "unknown-key: unknown key 'nonsense'" in err


@pytest.mark.slow
def test_a_change_to_any_file_is_checked(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    specs = tmp_path / "tolvarn"
    shutil.copytree(TV62, specs)
    clean = said(capsys, "check", str(specs))
    assert clean[0] == 0
    assert said(capsys, "check", str(specs)) == clean
    for name, text in (
        ("tv62.yaml", "nonsense: 1\n"),
        ("tv62.second.yaml", "nonsense: 1\n"),
        ("manufacturer.yaml", "nonsense: 1\n"),
        ("tv62.coverage.json", "{}"),
        ("tv62.changes.json", "{}"),
        ("tv62.x.overlay.yaml", "overlay: x\n"),
        ("new.yaml", "device: new\n"),
    ):
        path = specs / name
        before = path.read_text(encoding="utf-8") if path.exists() else None
        path.write_text((before or "") + text, encoding="utf-8")
        assert said(capsys, "check", str(specs))[0] == 1
        if before is None:
            path.unlink()
        else:
            path.write_text(before, encoding="utf-8")
        assert said(capsys, "check", str(specs)) == clean


@pytest.mark.slow
def test_a_manufacturer_file_of_another_name_is_read_again(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    specs, out = tmp_path / "tolvarn", tmp_path / "out"
    shutil.copytree(TV62, specs)
    (specs / "manufacturer.yaml").rename(specs / "maker.yaml")
    command = ("generate", str(specs), "-o", str(out), "--target", "python")
    assert [said(capsys, *command)[0] for _ in range(2)] == [0, 0]
    text = (specs / "maker.yaml").read_text(encoding="utf-8")
    (specs / "maker.yaml").write_text(text.replace("tolvarn_encoders", "other_encoders"), encoding="utf-8")
    assert said(capsys, *command, "--check")[0] == 1
    assert said(capsys, *command)[0] == 0
    assert (out / "python" / "other_encoders").is_dir()


@pytest.mark.exhaustive
@pytest.mark.slow
def test_only_changed_families_are_checked_again(folder: Path, specs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def check(*options: str) -> tuple[int, str, str]:
        return said(capsys, "check", str(specs), *options)

    assert check() == check("--no-cache")
    spec, second = specs / "asc85.yaml", specs / "sma21.second.yaml"
    spec.write_text("# changed\n" + spec.read_text(encoding="utf-8"), encoding="utf-8")
    assert check() == check("--no-cache")
    text = second.read_text(encoding="utf-8")
    second.write_text(text.replace("revision: ", "revision: 9", 1).replace('9"', '"9', 1), encoding="utf-8")
    code, out, err = check()
    assert (code, out, err) == check("--no-cache")
    assert code == 1
    assert "sma21.second.yaml" in out
    assert check("--coverage") == check("--coverage", "--no-cache")
    second.write_text(text, encoding="utf-8")
    assert check() == check("--no-cache")
    # Families that are not built again are still compared with new ones.
    again = spec.read_text(encoding="utf-8").replace("device: asc85", "device: asc86")
    (specs / "asc86.yaml").write_text(again, encoding="utf-8")
    code, out, err = check()
    assert (code, out, err) == check("--no-cache")
    assert code == 1
    line = 1 + again.splitlines().index(next(line for line in again.splitlines() if line.startswith("  pattern:")))
    assert f"asc86.yaml:{line}:12: order-code-ambiguous" in out


@pytest.mark.slow
def test_a_problem_makes_no_other_file_be_checked_again(
    folder: Path, specs: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    looked: list[str] = []

    def check_noted(document: Document, report: ProblemReport) -> Any:
        looked.append(Path(document.file).name)
        return check_document(document, report)

    spec, others = specs / "asc85.yaml", {"am36.yaml", "amm5.yaml", "sma21.yaml"}
    spec.write_text(spec.read_text(encoding="utf-8") + "nonsense: 1\n", encoding="utf-8")
    monkeypatch.setattr("codewheel.loading.library.check_document", check_noted)
    command = ("check", str(specs))
    first = said(capsys, *command)
    assert first[0] == 1
    assert others < set(looked)
    looked.clear()
    assert said(capsys, *command) == first
    assert "asc85.yaml" in looked
    assert others.isdisjoint(looked)


@pytest.fixture
def two(tmp_path: Path) -> Path:
    """Specs of two small families."""
    place = tmp_path / "two"
    shutil.copytree(TV62, place)
    text = (place / "tv62.yaml").read_text(encoding="utf-8")
    renamed = text.replace("device: tv62", "device: tv63").replace("TV62", "TV63")
    (place / "tv63.yaml").write_text(renamed, encoding="utf-8")
    return place


@pytest.mark.slow
def test_a_family_with_overlays_has_no_content(folder: Path, two: Path, tmp_path: Path) -> None:
    """An overlay in another folder is not part of the key, so its result must not be stored."""
    overlay = tmp_path / "other" / "x.overlay.yaml"
    overlay.parent.mkdir()
    overlay.write_text(
        "codewheel: 1\noverlay: x\nof: tv62\ntitle: Ours\ndocuments:\n  ti: {title: Info}\nchanges:\n"
        '  - {set: title, to: Other, why: It is another., severity: wording, source: "ti: 1"}\n',
        encoding="utf-8",
    )
    cache = Cache(folder)
    families, report = load_families([two, overlay], cache)
    assert not report, report.problems
    assert [bool(family.content) for family in families if family.device.name == "tv62"] == [False]
    plain, _ = load_families([two])
    again, _ = load_families([two], cache)
    assert [family.device for family in again] == [family.device for family in plain]


@pytest.mark.exhaustive
def test_processes_share_the_cache_and_may_be_killed(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    without = said(capsys, *COMMANDS[0], "--no-cache")
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder.parent)}
    command = [sys.executable, "-m", "codewheel", *COMMANDS[0]]
    chance = random.Random(33)
    for _ in range(6):
        shutil.rmtree(folder, ignore_errors=True)
        running = [subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL) for _ in range(3)]
        time.sleep(chance.uniform(0.1, 1.0))
        for process in running:
            process.send_signal(signal.SIGKILL)
            process.wait()
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout, done.stderr) == without
        assert all(path.name.startswith(".new-") or len(path.name) == 64 for path in entries(folder))
    finished = [
        subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(4)
    ]
    for process in finished:
        out, err = process.communicate()
        assert (process.returncode, out, err) == without
