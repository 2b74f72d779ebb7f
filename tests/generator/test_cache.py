"""The cache: the same bytes with and without it, after kills, with damaged or foreign entries, and on a full disk."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import pkgutil
import random
import select
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from codewheel import cache as cache_module
from codewheel import model
from codewheel.cache import Cache, content_of, default_folder, key_of
from codewheel.commands.cli import main
from codewheel.commands.terminal import Stop
from codewheel.language import read
from codewheel.language.check import check_document
from codewheel.language.document import Document
from codewheel.language.problems import Report
from codewheel.language.read import read_document
from codewheel.loading import selected, stored
from codewheel.loading.library import Family, load_families, load_library
from codewheel.loading.selected import families_for
from codewheel.loading.stored import NotStorable, as_data, from_data
from codewheel.parts import Kept, Rendering
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


@pytest.mark.slow
def test_a_model_survives_the_cache(library: Library) -> None:
    for device in library.devices:
        rows = json.loads(json.dumps(as_data(device)))
        assert from_data(rows) == device
        assert repr(from_data(rows)) == repr(device)


def test_every_class_of_a_model_can_be_stored() -> None:
    """A family with another class would be checked and rendered again by every command."""
    packages = pkgutil.walk_packages(model.__path__, "codewheel.model.")
    classes = {
        item
        for module in (import_module(found.name) for found in packages if ".members" not in found.name)
        for item in vars(module).values()
        if dataclasses.is_dataclass(item) and item.__module__ == module.__name__
    }
    assert len(classes) > 50
    assert classes - set(stored._CLASSES) == set()


@pytest.mark.parametrize(
    "rows",
    [
        None,
        7,
        [],
        [[]],
        [[0]],
        [[9999, 1]],
        [["Device", 1]],
        [[0, {"o": 5}]],
        [[0, {"e": [99, "X"]}]],
        [[0, {"anything": 1}]],
        [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]],
    ],
)
def test_data_that_is_not_a_model_is_rejected(rows: object) -> None:
    with pytest.raises(NotStorable):
        from_data(rows)


@pytest.fixture
def kept(folder: Path) -> tuple[Cache, Path]:
    """A cache with one entry."""
    cache = Cache(folder)
    cache.put("number", ["a"], [1, "two", None])
    return cache, folder / key_of("number", ["a"])


def test_what_is_put_is_got(kept: tuple[Cache, Path]) -> None:
    cache, place = kept
    assert entries(place.parent) == [place]
    assert cache.get("number", ["a"]) == [1, "two", None]
    assert cache.get("other", ["a"]) is None
    assert cache.get("number", ["a", ""]) is None
    assert Cache(None).get("number", ["a"]) is None


def damaged(content: bytes) -> Iterator[bytes]:
    yield b""
    yield content[:-1]
    yield content + b" "
    yield content[:64]
    yield content[:70] + bytes([content[70] ^ 1]) + content[71:]
    for text in (b"", b"null", b"[]", b"{}", b"\xff", b'{"key": "other", "data": 5}', b"[" * 100_000):
        yield hashlib.sha256(text).hexdigest().encode() + text


def test_a_damaged_entry_is_ignored_and_replaced(kept: tuple[Cache, Path]) -> None:
    cache, place = kept
    for content in damaged(place.read_bytes()):
        place.write_bytes(content)
        assert cache.get("number", ["a"]) is None
        cache.put("number", ["a"], "again")
        assert cache.get("number", ["a"]) == "again"


OTHER_FORMS = (5, "text", [5], {}, {"families": 5, "files": 5, "hashes": 5}, [{"family": 5}], {"families": []})


@pytest.mark.slow
@pytest.mark.parametrize("wrong", OTHER_FORMS)
def test_an_entry_of_another_form_is_no_result(
    wrong: object, folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its hash and its key are right, so another program of the same user wrote it."""
    written = ("generate", str(TV62), "--target", "biss", "-o", str(tmp_path / "out"))
    commands = [*COMMANDS, written]
    for command in commands:
        said(capsys, *command)
    without = [said(capsys, *command) for command in commands]
    monkeypatch.setattr(Cache, "get", lambda *_: wrong)
    assert [said(capsys, *command) for command in commands] == without


def test_an_entry_of_another_key_is_ignored(kept: tuple[Cache, Path]) -> None:
    cache, place = kept
    shutil.copy(place, place.with_name(key_of("number", ["b"])))
    assert cache.get("number", ["b"]) is None


def test_an_entry_that_others_can_write_is_ignored(kept: tuple[Cache, Path]) -> None:
    cache, place = kept
    for mode in (0o620, 0o602):
        place.chmod(mode)
        assert cache.get("number", ["a"]) is None
    place.chmod(0o600)
    place.parent.chmod(0o777)
    assert cache.get("number", ["a"]) is None
    place.unlink()
    cache.put("number", ["a"], 1)
    assert entries(place.parent) == []


def test_an_entry_of_another_user_is_ignored(kept: tuple[Cache, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    cache, _ = kept
    monkeypatch.setattr(os, "getuid", lambda: 12345)
    assert cache.get("number", ["a"]) is None


def test_an_entry_that_is_no_file_is_ignored(kept: tuple[Cache, Path], tmp_path: Path) -> None:
    cache, place = kept
    place.rename(tmp_path / "elsewhere")
    place.symlink_to(tmp_path / "elsewhere")
    assert cache.get("number", ["a"]) is None
    place.unlink()
    os.mkfifo(place)
    assert cache.get("number", ["a"]) is None
    place.unlink()
    place.mkdir()
    assert cache.get("number", ["a"]) is None
    cache.put("number", ["a"], 1)


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


def test_another_version_has_other_entries(kept: tuple[Cache, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    cache, place = kept
    monkeypatch.setattr(cache_module, "_tool", lambda: "another version")
    assert cache.get("number", ["a"]) is None
    cache.put("number", ["a"], "of the other")
    monkeypatch.undo()
    assert len(entries(place.parent)) == 2


def test_the_code_of_the_tool_is_part_of_the_key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "generator"
    package.mkdir()
    (package / "some.py").write_text("A = 1", encoding="utf-8")
    monkeypatch.setattr(cache_module, "__file__", str(package / "cache.py"))
    first = cache_module._tool.__wrapped__()
    assert cache_module._tool.__wrapped__() == first
    times = (package / "some.py").stat()
    (package / "some.py").write_text("A = 2", encoding="utf-8")
    os.utime(package / "some.py", ns=(times.st_atime_ns, times.st_mtime_ns))
    assert cache_module._tool.__wrapped__() != first


def test_the_cache_has_a_limit(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache_module, "MAX_ENTRIES", 8)
    cache = Cache(folder)
    for number in range(40):
        cache.put("number", [str(number)], number)
        assert len(entries(folder)) <= 8
    assert cache.get("number", ["39"]) == 39
    monkeypatch.setattr(cache_module, "MAX_SIZE", 2000)
    cache.put("text", [], "x" * 1500)
    cache.put("text", ["a"], "y" * 1500)
    assert sum(path.stat().st_size for path in entries(folder)) <= 2000
    monkeypatch.setattr(cache_module, "MAX_ENTRY", 100)
    cache.put("long", [], "z" * 100)
    assert cache.get("long", []) is None


def test_the_remains_of_killed_processes_are_removed(kept: tuple[Cache, Path]) -> None:
    _, place = kept
    old, new = place.with_name(".new-1-old"), place.with_name(".new-1-new")
    for path in (old, new):
        path.write_bytes(b"half")
    os.utime(old, (0, 0))
    Cache(place.parent).put("number", ["b"], 2)
    assert (old.exists(), new.exists()) == (False, True)


def test_the_folder_is_that_of_the_user(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    assert default_folder() == tmp_path / ".cache" / "codewheel"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "own"))
    assert default_folder() == tmp_path / "own" / "codewheel"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert default_folder() is None


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
@pytest.mark.parametrize("spec", sorted(SPECS.glob("*.yaml")), ids=lambda path: path.name)
def test_a_document_survives_the_cache(kept: tuple[Cache, Path], spec: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = read_document(spec, Report(), cache=kept[0])

    def parse(*_: object) -> object:
        raise AssertionError("parsed again")

    monkeypatch.setattr(read, "parse", parse)
    assert repr(read_document(spec, Report(), cache=kept[0])) == repr(first)


@pytest.mark.parametrize(
    "entry",
    [
        None,
        [],
        [{"device": "x"}],
        [{"device": "x"}, []],
        [{"device": "x"}, [1, 1, 1, 1]],
        [{"device": "x"}, [1, 1, 1, 1, 1, 9, 1, 1, 1]],
        [{"device": "x"}, [1, 1, 1, 1, 1, 9, 1, 1, 1, 9, 1, 1]],
        [{"device": "x"}, [1, 1, 1, 1, 1, "9", 1, 1]],
        [["device"], [1, 1, 1, 1, 1, 9, 1, 1]],
        [{"device": "x"}, 8],
    ],
)
def test_an_entry_that_does_not_fit_a_document_is_ignored(
    kept: tuple[Cache, Path], tmp_path: Path, entry: object
) -> None:
    spec = tmp_path / "spec.yaml"
    spec.write_text("device: y\n")
    kept[0].put("parsed", [spec.read_text()], entry)
    document = read_document(spec, Report(), cache=kept[0])
    assert document is not None
    assert (document.data, document.position(("device",))) == ({"device": "y"}, (1, 9))


def test_a_file_with_problems_is_always_parsed(kept: tuple[Cache, Path], tmp_path: Path) -> None:
    spec = tmp_path / "spec.yaml"
    spec.write_text("device: y\ndevice: z\nname: !odd x\n")
    for _ in range(2):
        report = Report()
        read_document(spec, report, cache=kept[0])
        assert [item.rule for item in report.problems] == ["duplicate-key", "tag"]


@pytest.mark.slow
def test_only_the_family_of_the_order_code_is_loaded(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def names(text: str) -> list[str]:
        return [device.name for device in families_for([SPECS], text, Cache(folder)) or ()]

    assert names("sma21") == ["sma21"]
    assert names(" AMM5 ") == ["amm5"]
    # The pattern of AM36 begins with a part, whose values are read once, without the rest of the spec.
    assert names("AMM5A21/65KSC1-K") == ["amm5"]
    monkeypatch.setattr(selected, "_beginnings_of_parts", None)
    assert names("AMM5A21/65KSC1-K") == ["amm5"]
    assert names("asc8525/BG1") == ["asc85"]
    assert names("am36 16/4096-I7") == ["am36"]
    assert names("AMC3616/4096-I7") == ["am36"]
    assert names("nothing") == []


PART = """order_code:
  pattern: "{kind}-{size}"
  source: "1"
  parts:
    - {name: kind, meaning: Kind, source: "1", values: {A: {meaning: One}, b c: {meaning: Two}}}
    - {name: size, meaning: Size, source: "1", values: {"1": {meaning: One}}}
"""


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ("", "", ("A", "BC")),
        ("kind, meaning", 'kind, open: "[0-9]", meaning', ("",)),
        ("{A: ", "{<<: *other, A: ", ("",)),
        ("values: {A", "values: *other, more: {A", ("",)),
        ("values: {A", "values: {A: {}, A", ("",)),
        ("name: kind", "name: other", ("",)),
        ("parts:", "pieces:", ("",)),
        ("order_code:", "order_code: *other", ("",)),
        ("  pattern", "pattern", ("",)),
        ("{kind}-{size}", "{kind", ("",)),
    ],
)
def test_the_beginnings_of_order_codes_are_read_alone(tmp_path: Path, old: str, new: str, found: object) -> None:
    """If anything is unusual, the family may have any order code, so its whole spec is read."""
    spec = tmp_path / "x.yaml"
    spec.write_text(f"codewheel: 1\ndevice: x\n{PART.replace(old, new)}title: X\n", encoding="utf-8")
    assert selected._beginnings_of_parts(spec) == found


@pytest.mark.slow
def test_all_specs_are_read_if_one_may_change_another(folder: Path, specs: Path) -> None:
    cache = Cache(folder)
    assert families_for([specs], "sma21", cache)
    overlay = specs / "x.overlay.yaml"
    overlay.write_text("codewheel: 1\noverlay: x\nof: sma21\n", encoding="utf-8")
    assert families_for([specs], "sma21", cache) is None
    overlay.unlink()
    (specs / "sma21.mine.overlay.yaml").write_text("nonsense", encoding="utf-8")
    assert families_for([specs / "sma21.yaml"], "sma21", cache) is None
    (specs / "sma21.mine.overlay.yaml").unlink()
    (specs / "again.yaml").write_bytes((specs / "sma21.yaml").read_bytes())
    assert families_for([specs], "sma21", cache) is None
    (specs / "again.yaml").unlink()
    (specs / "manufacturer.yaml").rename(specs / "other.yaml")
    assert families_for([specs], "sma21", cache) is None


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

    master = specs / "moteus.yaml"
    shutil.copy(SPECS.parent / "masters" / "moteus.yaml", master)
    spec, others = specs / "asc85.yaml", {"am36.yaml", "amm5.yaml", "sma21.yaml", "moteus.yaml"}
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
    master.write_text(master.read_text(encoding="utf-8") + "nonsense: 1\n", encoding="utf-8")
    code, out, _ = said(capsys, *command)
    assert code == 1
    assert "moteus.yaml" in out
    assert said(capsys, *command) == (code, out, "") == said(capsys, *command, "--no-cache")


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


def library_of(specs: Path, cache: Cache) -> tuple[Library, dict[str, str]]:
    families, report = load_families([specs], cache)
    assert not report, report.problems
    digests = {family.device.name: family.digest for family in families}
    return Library(tuple(family.device for family in families)), digests


#: Tasks for each family. One process generates the files for masters and the page about them.
TASKS = len(BUILT_IN) - 1


def begun(specs: Path, cache: Cache) -> int:
    """Return the number of tasks for parts that are not in the cache, after rendering all of them."""
    library, digests = library_of(specs, cache)
    found = [0]
    kept = Kept(cache, digests, lambda _, all_of_them: found.append(all_of_them))
    with Rendering(library.devices, BUILT_IN, kept) as rendering:
        rendering.finished()
    return found[-1]


@pytest.mark.slow
def test_parts_survive_the_cache(two: Path) -> None:
    library, _ = library_of(two, Cache(None))
    for target in map(load_target, BUILT_IN):
        assert target.family is not None
        options = {item.name: item.default for item in target.options}
        parts = {item.name: target.family(item, library, options) for item in library.devices}
        again = json.loads(json.dumps(parts))
        assert files_of(target, library, options, again) == files_of(target, library, options)


@pytest.mark.slow
def test_only_parts_of_changed_families_are_rendered(folder: Path, two: Path) -> None:
    cache = Cache(folder)
    assert begun(two, cache) == 2 * TASKS
    assert begun(two, cache) == 0
    spec = two / "tv63.yaml"
    text = spec.read_text(encoding="utf-8")
    # A comment is not part of the model.
    spec.write_text("# changed\n" + text, encoding="utf-8")
    assert begun(two, cache) == 0
    spec.write_text(text.replace("max_hz: 1500000", "max_hz: 1400000"), encoding="utf-8")
    assert begun(two, cache) == TASKS
    spec.write_text(text, encoding="utf-8")
    assert begun(two, cache) == 0
    maker = (two / "manufacturer.yaml").read_text(encoding="utf-8")
    (two / "manufacturer.yaml").write_text(maker.replace("are invented", "are fictional"), encoding="utf-8")
    assert begun(two, cache) == 2 * TASKS


@pytest.mark.slow
def test_a_comment_renders_nothing(
    folder: Path, two: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    command = ("generate", str(two), "--target", "biss", "-o", str(tmp_path / "out"))
    said(capsys, *command)
    unchanged = said(capsys, *command)
    spec = two / "tv63.yaml"
    spec.write_text("# changed\n" + spec.read_text(encoding="utf-8"), encoding="utf-8")
    with monkeypatch.context() as patch:
        patch.setattr("codewheel.commands.outputs.rendered", None)
        assert said(capsys, *command) == unchanged
    # The files on the disk count, not their expected content.
    (tmp_path / "out" / "biss" / "tolvarn-tv63.xml").write_text("spoilt", encoding="utf-8")
    spec.write_text("# again\n" + spec.read_text(encoding="utf-8"), encoding="utf-8")
    code, out, _ = said(capsys, *command)
    assert (code, "1 file changed" in out) == (0, True)
    assert said(capsys, *command) == unchanged
    # A problem in the spec is reported, although an earlier version of it had none.
    spec.write_text(spec.read_text(encoding="utf-8") + "nonsense: 1\n", encoding="utf-8")
    assert said(capsys, *command)[0] == 1


@pytest.mark.slow
def test_only_changed_families_are_proved_again(folder: Path, two: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from codewheel.commands.check import coverage

    shutil.copy(two / "tv62.second.yaml", two / "tv63.second.yaml")
    second = two / "tv63.second.yaml"
    text = second.read_text(encoding="utf-8").replace("device: tv62", "device: tv63").replace("TV62", "TV63")
    second.write_text(text, encoding="utf-8")
    cache, proved = Cache(folder), list[str]()
    real = coverage.check_families

    def check_families(families: list[Family], *arguments: Any) -> object:
        proved.extend(family.device.name for family in families)
        return real(families, *arguments)

    monkeypatch.setattr(coverage, "check_families", check_families)

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
    # Parts that are not what targets made, although size, hash and key are right.
    monster = {"data": {"part": {"c/../../x": "y", "files": 5}}}
    for place in entries(folder):
        data = json.loads(place.read_bytes()[64:])["data"]
        if not isinstance(data, dict) or "families" in data:
            continue
        found = json.dumps(monster | {"key": place.name}).encode()
        place.write_bytes(hashlib.sha256(found).hexdigest().encode() + found)
    spec.write_text(text, encoding="utf-8")
    same()
    shutil.rmtree(folder)
    folder.write_text("a file instead of a folder", encoding="utf-8")
    spec.write_text(text + "# again\n", encoding="utf-8")
    same()


DIES = """
import os, sys
from codewheel import parts
from codewheel.commands.cli import main
from codewheel.commands.terminal import Stop
mine, start = os.getpid(), parts._child
def dies(*arguments):
    HOW
def child(*arguments):
    started = start(*arguments)
    os.waitid(os.P_PID, started[0], os.WEXITED | os.WNOWAIT)
    return started
class Pool(parts._Pool):
    def _work(self, *arguments):
        if os.getpid() != mine:
            self._make = dies
        return super()._work(*arguments)
parts._processes, parts._child, parts._Pool = lambda tasks: 3, child, Pool
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("how", "end"),
    [("os.kill(os.getpid(), 9)", "was ended by signal 9"), ("os._exit(3)", "ended with exit code 3")],
)
def test_a_process_that_dies_ends_the_run(folder: Path, two: Path, tmp_path: Path, how: str, end: str) -> None:
    out = tmp_path / "out"
    command = ["generate", str(two), "-o", str(out), "--no-cache"]
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder.parent)}

    def run(code: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-c", code, *command], env=environment, capture_output=True, text=True, check=False
        )

    done = run(DIES.replace("HOW", how))
    assert (done.returncode, done.stderr) == (
        1,
        f"codewheel: a process that renders files {end}; nothing has changed; run the command again\n",
    )
    assert not out.exists()


ORPHAN = """
import os, signal
from codewheel.parts import _child
first = _child(lambda: iter([(0, "x" * 2**20)]), [])
second = _child(lambda: iter([(0, "x" * 2**20)]), [first[1]])
print(first[0], second[0], flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="this system has no file descriptors of processes")
def test_no_process_stays_behind_if_its_parent_is_killed(tmp_path: Path) -> None:
    """Both have more to return than a pipe holds, so they wait to be read from."""
    with open(tmp_path / "numbers", "w") as file:  # A pipe would stay open as long as they run.
        subprocess.run([sys.executable, "-c", ORPHAN], stdout=file, check=False)
    numbers = [int(number) for number in (tmp_path / "numbers").read_text().split()]
    assert len(numbers) == 2
    left = [number for number in numbers if not has_ended(number, 20)]
    for number in left:
        os.kill(number, signal.SIGKILL)
    assert left == []


def has_ended(process: int, within_s: float) -> bool:
    try:
        handle = os.pidfd_open(process)
    except ProcessLookupError:
        return True
    try:
        return bool(select.select([handle], [], [], within_s)[0])
    finally:
        os.close(handle)


@pytest.mark.slow
def test_the_number_of_processes_changes_nothing(folder: Path, two: Path, tmp_path: Path) -> None:
    trees = []
    for count in (1, 2, 5):
        code = "import sys; from codewheel import parts; from codewheel.commands.cli import main; "
        code += f"parts._processes = lambda tasks: {count}; sys.exit(main(sys.argv[1:]))"
        out = tmp_path / f"out{count}"
        command = [sys.executable, "-c", code, "generate", str(two), "-o", str(out), "--no-cache"]
        subprocess.run(command, capture_output=True, check=True)
        trees.append(tree_of(out))
    assert trees[0] == trees[1] == trees[2]


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
def test_a_file_that_changes_while_it_is_read_is_not_kept(
    folder: Path, specs: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from codewheel.loading import library as module

    def changing(paths: list[Path]) -> object:
        found = load_library(paths)
        with open(specs / "sma21.yaml", "a", encoding="utf-8") as file:
            file.write("# changed\n")
        return found

    monkeypatch.setattr(module, "load_library", changing)
    assert families_for([specs], "sma21", Cache(folder))
    assert entries(folder) == []


def test_content_has_names_and_bytes(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"1")
    assert content_of([tmp_path / "a", tmp_path / "b"]) == ["a", b"1", "b", "missing"]
    assert key_of("k", ["a", "b"]) != key_of("k", ["ab"])


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
