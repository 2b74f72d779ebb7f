"""Commands with the cache: the same output as without it, and only changed families are loaded and rendered again."""

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
from codewheel.commands.terminal import Stop
from codewheel.family_parts import FamilyParts
from codewheel.language.check import check_document
from codewheel.language.document import Document
from codewheel.language.problems import Report
from codewheel.loading.library import Family, load_families
from codewheel.targets import Library
from codewheel.targets.registry import BUILT_IN, files_of, load_target

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


@pytest.mark.slow
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
@pytest.mark.parametrize("broken", ["amm5.yaml", "manufacturer.yaml"])
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
    assert check("--json") == check("--json", "--no-cache")
    assert check("--coverage") == check("--coverage", "--no-cache")
    second.write_text(text, encoding="utf-8")
    assert check() == check("--no-cache")
    # Families that are not built again are still compared with new ones.
    again = spec.read_text(encoding="utf-8").replace("device: asc85", "device: asc86")
    (specs / "asc86.yaml").write_text(again, encoding="utf-8")
    code, out, err = check()
    assert (code, out, err) == check("--no-cache")
    assert code == 1
    assert "asc86.yaml:117:12: order-code-ambiguous" in out


@pytest.mark.slow
def test_a_problem_makes_no_other_file_be_checked_again(
    folder: Path, specs: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    looked: list[str] = []

    def check_noted(document: Document, report: Report) -> Any:
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
    assert generate("warm") == generate("plain", "--no-cache")
    assert generate("warm", "--check") == generate("plain", "--no-cache", "--check")
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
    assert generate("warm", "--option", "biss.order-codes=none") == generate(
        "plain", "--no-cache", "--option", "biss.order-codes=none"
    )


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


@pytest.mark.slow
def test_diff_renders_equal_models_once(
    folder: Path, two: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], rendered_parts: list[str]
) -> None:
    new = tmp_path / "new"
    shutil.copytree(two, new)
    text = (new / "tv63.yaml").read_text(encoding="utf-8")
    (new / "tv63.yaml").write_text(text.replace("max_hz: 1500000", "max_hz: 1400000"), encoding="utf-8")
    command = ("diff", str(two), str(new))
    without = said(capsys, *command, "--no-cache")
    assert (without[0], "max_hz" in without[1], len(rendered_parts)) == (1, True, 3 * len(BUILT_IN))
    rendered_parts.clear()
    assert said(capsys, *command) == without
    assert len(rendered_parts) == 3 * len(BUILT_IN)
    assert said(capsys, *command) == without
    assert len(rendered_parts) == 3 * len(BUILT_IN)


@pytest.mark.slow
def test_only_changed_families_are_proved_again(folder: Path, two: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from codewheel.commands import coverage

    shutil.copy(two / "tv62.second.yaml", two / "tv63.second.yaml")
    second = two / "tv63.second.yaml"
    text = second.read_text(encoding="utf-8").replace("device: tv62", "device: tv63").replace("TV62", "TV63")
    second.write_text(text, encoding="utf-8")
    cache, proved = Cache(folder), list[str]()
    real = coverage.look_at

    def look_at(families: list[Family], *arguments: Any) -> object:
        proved.extend(family.device.name for family in families)
        return real(families, *arguments)

    monkeypatch.setattr(coverage, "look_at", look_at)

    def refuse() -> list[str]:
        proved.clear()
        families, report = load_families([two], cache)
        assert not report, report.problems
        coverage.refuse_unproved(families, "written", cache)
        return list(proved)

    assert (refuse(), refuse()) == (["tv62", "tv63"], [])
    second.write_text(text.replace("max_hz: 1500000", "max_hz: 1400000"), encoding="utf-8")
    with pytest.raises(Stop, match="reports 2 problems"):
        refuse()
    second.write_text(text, encoding="utf-8")
    assert refuse() == []


@pytest.mark.slow
def test_a_family_with_overlays_has_no_content(folder: Path, two: Path, tmp_path: Path) -> None:
    """An overlay that is elsewhere is not part of the key, so its result must not be kept."""
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_generate_may_be_killed_at_any_moment(folder: Path, two: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder.parent)}
    spec, out, chance = two / "tv63.yaml", tmp_path / "out", random.Random(33)
    text = spec.read_text(encoding="utf-8")

    def command(place: Path, *options: str) -> list[str]:
        return [sys.executable, "-m", "codewheel", "generate", str(two), "-o", str(place), *options]

    subprocess.run(command(out), env=environment, capture_output=True, check=True)
    before = tree_of(out)
    spec.write_text(text.replace("TV63", "TV64"), encoding="utf-8")
    subprocess.run(command(tmp_path / "plain", "--no-cache"), capture_output=True, check=True)
    after = tree_of(tmp_path / "plain")
    for _ in range(5):
        running = subprocess.Popen(command(out), env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(chance.uniform(0.2, 2.0))
        running.kill()
        running.wait()
        found = tree_of(out)
        for target in BUILT_IN:
            mine = {path: data for path, data in found.items() if path.startswith(f"{target}/")}
            assert mine in [{p: d for p, d in one.items() if p.startswith(f"{target}/")} for one in (before, after)]
    done = subprocess.run(command(out), env=environment, capture_output=True, check=True)
    assert done.stderr == b""
    assert tree_of(out) == after


@pytest.mark.slow
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
