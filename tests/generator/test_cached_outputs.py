"""Outputs with the cache: the same files as without it, and only parts of changed families are rendered."""

from __future__ import annotations

import os
import random
import shutil
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from codewheel import cache as cache_module
from codewheel.cache import Cache, default_folder
from codewheel.commands.cli import main
from codewheel.commands.outputs import FamilyParts
from codewheel.commands.terminal import CommandError
from codewheel.loading.configuration import BUILT_IN
from codewheel.loading.library import Family, load_families
from codewheel.targets import Library
from codewheel.targets.registry import files_of, load_target
from exhaustive import mostly_exhaustive

TV62 = Path(__file__).resolve().parents[2] / "docs" / "example" / "tolvarn"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own, which is empty."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(cache_module, "default_folder", default_folder)
    return tmp_path / "cache" / "codewheel"


def said(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(arguments)
    return (code, *capsys.readouterr())


def entries(folder: Path) -> list[Path]:
    return sorted(folder.iterdir()) if folder.is_dir() else []


def tree_of(place: Path) -> dict[str, bytes]:
    return {str(path.relative_to(place)): path.read_bytes() for path in place.rglob("*") if path.is_file()}


@pytest.fixture
def two(tmp_path: Path) -> Path:
    """Specs of two small families."""
    place = tmp_path / "two"
    shutil.copytree(TV62, place)
    text = (place / "tv62.yaml").read_text(encoding="utf-8")
    renamed = text.replace("device: tv62", "device: tv63").replace("TV62", "TV63")
    (place / "tv63.yaml").write_text(renamed, encoding="utf-8")
    return place


@pytest.fixture
def rendered_parts(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The kinds of parts that were rendered so far."""
    kinds: list[str] = []
    put = Cache.put

    def put_noted(self: Cache, kind: str, content: Any, data: Any) -> None:
        if kind.startswith("part "):
            kinds.append(kind)
        put(self, kind, content, data)

    monkeypatch.setattr(Cache, "put", put_noted)
    return kinds


@pytest.mark.slow
def test_generate_writes_the_same_with_and_without_the_cache(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def generate(out: str, *options: str) -> tuple[int, str, str]:
        code, text, err = said(capsys, "generate", str(TV62), "-o", str(tmp_path / out), *options)
        return code, text.replace(out, "OUT"), err.replace(out, "OUT")

    def tree(out: str) -> dict[str, bytes]:
        return tree_of(tmp_path / out)

    without = generate("plain", "--no-cache")
    assert (entries(folder), generate("cold"), generate("warm")) == ([], without, without)
    assert tree("cold") == tree("warm") == tree("plain")
    for out in ("warm", "plain"):
        (tmp_path / out / "c" / "README.md").write_text("spoilt", encoding="utf-8")
        (tmp_path / out / "docs" / "tv62.md").unlink()
    assert generate("warm", "--check") == generate("plain", "--no-cache", "--check")
    assert generate("warm") == generate("plain", "--no-cache")
    assert generate("warm", "--target", "c", "--target", "biss") == generate(
        "plain", "--no-cache", "--target", "c", "--target", "biss"
    )
    option = ("--option", "biss.order-codes=each")
    assert generate("warm", *option) == generate("plain", *option, "--no-cache")
    assert tree("warm") == tree("plain")


@pytest.mark.slow
def test_parts_survive_the_cache(two: Path, folder: Path) -> None:
    families, report = load_families([two])
    assert not report, report.problems
    library = Library(tuple(family.device for family in families))
    for target in map(load_target, BUILT_IN):
        options = {option.name: option.default for option in target.options}
        fresh = files_of(target, library, options)
        assert FamilyParts(Cache(folder)).files_of(target, library, options) == fresh
        assert FamilyParts(Cache(folder)).files_of(target, library, options) == fresh


@pytest.mark.exhaustive
def test_only_parts_of_changed_families_are_rendered(
    folder: Path, two: Path, tmp_path: Path, rendered_parts: list[str]
) -> None:
    def rendered() -> int:
        rendered_parts.clear()
        assert main(["generate", str(two), "-o", str(tmp_path / "out")]) == 0
        return len(rendered_parts)

    assert (rendered(), rendered()) == (2 * len(BUILT_IN), 0)
    spec = two / "tv63.yaml"
    text = spec.read_text(encoding="utf-8")
    # A comment is not part of the model.
    spec.write_text("# changed\n" + text, encoding="utf-8")
    assert rendered() == 0
    spec.write_text(text.replace("max_hz: 1500000", "max_hz: 1400000"), encoding="utf-8")
    assert rendered() == len(BUILT_IN)
    spec.write_text(text, encoding="utf-8")
    assert rendered() == 0
    manufacturer = two / "manufacturer.yaml"
    manufacturer_text = manufacturer.read_text(encoding="utf-8")
    manufacturer.write_text(manufacturer_text.replace("are invented", "are fictional"), encoding="utf-8")
    assert rendered() == 2 * len(BUILT_IN)


@pytest.mark.slow
def test_specs_without_a_change_are_not_even_read(
    folder: Path, two: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    commands = [("generate", str(two), "-o", str(out)), ("generate", str(two), "-o", str(out), "--check")]
    commands += [("check", str(two)), ("list", str(two))]
    assert [said(capsys, *command)[0] for command in commands] == [0] * len(commands)
    unchanged = [said(capsys, *command) for command in commands]
    with monkeypatch.context() as patch:
        patch.setattr("codewheel.loading.library.load_families", None)
        assert [said(capsys, *command) for command in commands] == unchanged
    # The files on the disk count, not their expected content.
    (out / "biss" / "tolvarn-tv63.xml").write_text("spoilt", encoding="utf-8")
    assert said(capsys, *commands[1])[0] == 1
    code, text, _ = said(capsys, *commands[0])
    assert (code, "1 file changed" in text) == (0, True)
    assert [said(capsys, *command) for command in commands] == unchanged
    # A problem in the spec is reported, although an earlier version of it had none.
    spec = two / "tv63.yaml"
    spec.write_text(spec.read_text(encoding="utf-8") + "nonsense: 1\n", encoding="utf-8")
    assert [said(capsys, *command)[0] for command in commands] == [1] * len(commands)


@pytest.mark.parametrize("is_edited", [False, True])
def test_the_model_of_an_edited_document_is_not_stored(folder: Path, two: Path, is_edited: bool) -> None:
    families, report = load_families([two], Cache(folder), prepare=lambda document: is_edited)
    assert not report, report.problems
    assert len(entries(folder)) == (0 if is_edited else len(families))


@pytest.mark.exhaustive
def test_diff_renders_equal_models_once(
    folder: Path, two: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], rendered_parts: list[str]
) -> None:
    new = tmp_path / "new"
    shutil.copytree(two, new)
    text = (new / "tv63.yaml").read_text(encoding="utf-8")
    (new / "tv63.yaml").write_text(text.replace("max_hz: 1500000", "max_hz: 1400000"), encoding="utf-8")
    command = ("diff", str(two), str(new))
    without = said(capsys, *command, "--no-cache")
    assert (without[0], "tv63" in without[1], len(rendered_parts)) == (1, True, 2 * len(BUILT_IN))
    rendered_parts.clear()
    assert said(capsys, *command) == without
    assert len(rendered_parts) == 2 * len(BUILT_IN)
    assert said(capsys, *command) == without
    assert len(rendered_parts) == 2 * len(BUILT_IN)


@pytest.mark.slow
def test_only_changed_families_are_proved_again(folder: Path, two: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from codewheel.commands.check import specs

    shutil.copy(two / "tv62.second.yaml", two / "tv63.second.yaml")
    second = two / "tv63.second.yaml"
    text = second.read_text(encoding="utf-8").replace("device: tv62", "device: tv63").replace("TV62", "TV63")
    second.write_text(text, encoding="utf-8")
    cache, proved = Cache(folder), list[str]()
    real = specs.check_families

    def check_families(families: list[Family], *arguments: Any) -> object:
        proved.extend(family.device.name for family in families)
        return real(families, *arguments)

    monkeypatch.setattr(specs, "check_families", check_families)

    def refuse() -> list[str]:
        proved.clear()
        families, report = load_families([two], cache)
        assert not report, report.problems
        specs.refuse_unproved(families, "written", cache)
        return list(proved)

    assert (refuse(), refuse()) == (["tv62", "tv63"], [])
    second.write_text(text.replace("max_hz: 1500000", "max_hz: 1400000"), encoding="utf-8")
    with pytest.raises(CommandError, match="reports 1 problem;"):
        refuse()
    second.write_text(text, encoding="utf-8")
    assert refuse() == []


@pytest.mark.exhaustive
def test_generate_with_one_change_writes_the_same_with_and_without_the_cache(
    folder: Path, two: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def same() -> None:
        for out, options in (("warm", ()), ("plain", ("--no-cache",))):
            assert said(capsys, "generate", str(two), "-o", str(tmp_path / out), *options)[0] == 0
        assert tree_of(tmp_path / "warm") == tree_of(tmp_path / "plain")

    same()
    spec = two / "tv63.yaml"
    text = spec.read_text(encoding="utf-8")
    spec.write_text(text.replace("TV63", "TV64"), encoding="utf-8")
    same()
    shutil.rmtree(folder)
    folder.write_text("a file instead of a folder", encoding="utf-8")
    spec.write_text(text + "# again\n", encoding="utf-8")
    same()


def files_below(files: Mapping[str, bytes], folder: str) -> dict[str, bytes]:
    return {path: content for path, content in files.items() if path.startswith(f"{folder}/")}


@pytest.mark.slow
@pytest.mark.parametrize("kill_count", mostly_exhaustive([2, 10], 2))
def test_generate_may_be_killed_at_any_moment(kill_count: int, folder: Path, two: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder.parent)}
    spec, out, chance = two / "tv63.yaml", tmp_path / "out", random.Random(33)
    spec_text = spec.read_text(encoding="utf-8")

    def command(output_folder: Path, *options: str) -> list[str]:
        return [sys.executable, "-m", "codewheel", "generate", str(two), "-o", str(output_folder), *options]

    subprocess.run(command(out), env=environment, capture_output=True, check=True)
    before = tree_of(out)
    spec.write_text(spec_text.replace("TV63", "TV64"), encoding="utf-8")
    subprocess.run(command(tmp_path / "plain", "--no-cache"), capture_output=True, check=True)
    after = tree_of(tmp_path / "plain")
    for _ in range(kill_count):
        running = subprocess.Popen(command(out), env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(chance.uniform(0.2, 2.0))
        running.kill()
        running.wait()
        files_after_kill = tree_of(out)
        for target in BUILT_IN:
            # Each target has replaced all of its files, or none.
            actual_files = files_below(files_after_kill, target)
            assert actual_files in (files_below(before, target), files_below(after, target))
    last_run = subprocess.run(command(out), env=environment, capture_output=True, check=True)
    assert last_run.stderr == b""
    assert tree_of(out) == after
