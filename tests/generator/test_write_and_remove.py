"""Output is written completely or not at all, and never outside the folder."""

from __future__ import annotations

import ctypes
import errno
import os
import shutil
import subprocess
from contextlib import nullcontext
from pathlib import Path

import pytest
from codewheel import output_folder as stage_module
from codewheel.output_folder import LIST, LIST_HEAD, Stage, WriteError
from codewheel.write_and_remove import FileChange, digest_of, digest_on_disk, list_changes, write

FILES = {"python/a.py": "a\n", "python/pkg/b.py": "b\n"}


def tree(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): path.read_text()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".codewheel"
    }


def test_writes_then_leaves_unchanged_files_alone(tmp_path: Path) -> None:
    assert write(tmp_path, {"python": FILES}) == [
        FileChange("python/a.py", "written"),
        FileChange("python/pkg/b.py", "written"),
    ]
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.py")}
    assert {item.state for item in write(tmp_path, {"python": FILES})} == {"unchanged"}
    assert write(tmp_path, {"python": {**FILES, "python/a.py": "new\n"}}) == [
        FileChange("python/a.py", "written"),
        FileChange("python/pkg/b.py", "unchanged"),
    ]
    assert (tmp_path / "python/pkg/b.py").stat().st_mtime_ns == before[tmp_path / "python/pkg/b.py"]
    assert tree(tmp_path) == {"python/a.py": "new\n", "python/pkg/b.py": "b\n"}


def test_removes_what_it_no_longer_writes_and_nothing_else(tmp_path: Path) -> None:
    write(tmp_path, {"python": FILES})
    (tmp_path / "python/mine.txt").write_text("mine")
    (tmp_path / "python/pkg/mine.txt").write_text("mine too")
    (tmp_path / "other").mkdir()
    (tmp_path / "other/mine.txt").write_text("mine as well")
    assert FileChange("python/pkg/b.py", "removed") in write(tmp_path, {"python": {"python/a.py": "a\n"}})
    assert tree(tmp_path) == {
        "other/mine.txt": "mine as well",
        "python/a.py": "a\n",
        "python/mine.txt": "mine",
        "python/pkg/mine.txt": "mine too",
    }


def test_check_changes_nothing(tmp_path: Path) -> None:
    write(tmp_path, {"python": FILES})
    before = tree(tmp_path)
    assert list_changes(tmp_path, "python", {"python/a.py": "x"}) == [
        FileChange("python/a.py", "written"),
        FileChange("python/pkg/b.py", "removed"),
    ]
    assert tree(tmp_path) == before


@pytest.mark.parametrize("path", ["../x", "python/../../x", "{tmp_path}/x", "c/x", "python/a\nb", "python//x", "x"])
def test_refuses_paths_outside_the_target(tmp_path: Path, path: str) -> None:
    with pytest.raises(WriteError, match="is not inside its folder 'python/'"):
        write(tmp_path / "out", {"python": {path.format(tmp_path=tmp_path): "x"}})
    assert not list(tmp_path.iterdir())


def test_refuses_a_linked_target_folder(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "out").mkdir()
    (tmp_path / "out/python").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(WriteError, match="is a link"):
        write(tmp_path / "out", {"python": FILES})
    assert not list((tmp_path / "elsewhere").iterdir())


def test_a_list_cannot_name_files_outside(tmp_path: Path) -> None:
    victims = [tmp_path / "victim", tmp_path / "other"]
    for victim in victims:
        victim.write_text("precious")
    (tmp_path / "out/python").mkdir(parents=True)
    (tmp_path / "out/python/.codewheel").write_text(LIST_HEAD + f"../../victim\n{victims[1]}\n")
    write(tmp_path / "out", {"python": FILES})
    assert [victim.read_text() for victim in victims] == ["precious"] * 2


@pytest.mark.parametrize("after", [0, 1, 2])
def test_a_full_disk_leaves_the_old_tree_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, after: int) -> None:
    write(tmp_path, {"python": FILES, "c": {"c/x.h": "x\n"}})
    before = tree(tmp_path)
    real_open = open
    opened = []

    def full(path: object, mode: str = "r", *rest: object, **named: object) -> object:
        if mode == "x":
            opened.append(path)
            if len(opened) > after:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        return real_open(path, mode, *rest, **named)  # type: ignore[call-overload]

    monkeypatch.setattr(stage_module, "open", full, raising=False)
    with pytest.raises(
        WriteError, match=r"cannot write .*/(python|c)/\w[\w./]*: No space left on device; nothing has changed"
    ):
        write(tmp_path, {"python": dict.fromkeys(FILES, "new"), "c": {"c/x.h": "new"}})
    assert tree(tmp_path) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c", "python"]


class Killed(BaseException):
    """Simulates a kill: the code after it does not run."""


@pytest.mark.parametrize("moment", ["_exchange", "_link_or_copy", "_save_from"])
def test_what_a_killed_run_left_is_cleared_by_the_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, moment: str
) -> None:
    write(tmp_path, {"python": FILES})
    (tmp_path / "python/mine.txt").write_text("mine")

    def killed(*_: object) -> None:
        raise Killed

    with monkeypatch.context() as patch:
        patch.setattr(stage_module, moment, killed)
        patch.setattr(Stage, "remove", killed)
        with pytest.raises(Killed):
            write(tmp_path, {"python": {**FILES, "python/a.py": "new\n"}})
    left = [path.name for path in tmp_path.iterdir()]
    assert len(left) == 2
    assert "python" in left
    files = {"python/a.py": (tmp_path / "python/a.py").read_text(), "python/pkg/b.py": "b\n"}
    assert {item.state for item in write(tmp_path, {"python": files})} == {"unchanged"}
    assert [path.name for path in tmp_path.iterdir()] == ["python"]
    assert tree(tmp_path) == {**files, "python/mine.txt": "mine"}


@pytest.mark.parametrize("after", [1, 2])
def test_a_kill_between_two_renames_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, after: int) -> None:
    write(tmp_path, {"python": FILES})
    (tmp_path / "python/mine.txt").write_text("mine")
    real = os.rename
    calls: list[object] = []

    def rename(old: Path, new: Path) -> None:
        calls.append(old)
        if len(calls) > after:
            raise Killed
        real(old, new)
        if len(calls) == 2:
            raise Killed

    def killed(*_: object) -> None:
        raise Killed

    with monkeypatch.context() as patch:
        patch.setattr(ctypes, "CDLL", no_exchange)
        patch.setattr(os, "rename", rename)
        patch.setattr(Stage, "remove", killed)
        with pytest.raises(Killed):
            write(tmp_path, {"python": {**FILES, "python/a.py": "new\n"}})
    assert (tmp_path / "python").exists() == (after == 2)
    write(tmp_path, {"python": FILES})
    assert tree(tmp_path) == {**FILES, "python/mine.txt": "mine"}
    assert [path.name for path in tmp_path.iterdir()] == ["python"]


@pytest.mark.parametrize("killed", [False, True], ids=["done", "killed"])
@pytest.mark.parametrize("one_step", [True, False], ids=["exchange", "two renames"])
def test_files_saved_while_a_run_writes_are_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, killed: bool, one_step: bool
) -> None:
    """The user's editor does not wait for the end of a run."""
    place = tmp_path / "a"
    write(tmp_path, {"a": {"a/x": "old", "a/gone": "old"}})
    (place / "edited").write_text("first")
    (place / "kept").write_text("kept")
    real = stage_module._exchange

    def saved_first(stage: Path, to: Path) -> None:
        (place / "sub").mkdir(exist_ok=True)
        (place / "sub/late").write_text("late")
        (place / "edited.tmp").write_text("second")
        (place / "edited.tmp").replace(place / "edited")
        real(stage, to)
        if killed:
            monkeypatch.setattr(Stage, "remove", lambda _: None)
            raise Killed

    monkeypatch.setattr(stage_module, "_exchange", saved_first)
    monkeypatch.setattr(Stage, "take_back", lambda _: True)
    if not one_step:
        monkeypatch.setattr(ctypes, "CDLL", no_exchange)
    with pytest.raises(Killed) if killed else nullcontext():
        write(tmp_path, {"a": {"a/x": "new"}})
    monkeypatch.undo()
    write(tmp_path, {"a": {"a/x": "new"}})
    assert tree(place) == {"x": "new", "edited": "second", "kept": "kept", "sub/late": "late"}
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_hidden_folders_of_the_user_are_left_alone(tmp_path: Path) -> None:
    """This includes folders whose name and content look like a stage."""
    names = [".python-virtualenv", ".python-packages", ".python-abcd1234", ".python-abcd1234-old", ".codewheel-python"]
    names += [".codewheel-python-drafts-2024", ".codewheel-python-abcd1234", ".codewheel-python-packages"]
    names += [".codewheel-c-abcd1234"]
    for name in names:
        (tmp_path / name / "new").mkdir(parents=True)
        (tmp_path / name / "new/x").write_text("precious")
        (tmp_path / name / "x").write_text("precious")
        (tmp_path / name / ".codewheel-stage").write_text("mine as well")
    (tmp_path / ".codewheel-python-abcd1234/.codewheel-stage").unlink()
    (tmp_path / ".codewheel-python-packages/.codewheel-stage").write_text("")
    (tmp_path / ".codewheel-python-abcdefgh").mkdir()
    (tmp_path / ".codewheel-python-abcdefgh/.codewheel-stage").write_text("only this")
    (tmp_path / ".codewheel-python-file1234").write_text("a file")
    (tmp_path / ".codewheel-python-link1234").symlink_to(tmp_path / ".codewheel-python-abcdefgh")
    before = {path.relative_to(tmp_path) for path in tmp_path.rglob("*")}
    for text in ("a", "b"):
        write(tmp_path, {"python": {"python/a.py": text}, "c": {"c/x.h": text}})
    left = {path.relative_to(tmp_path) for path in tmp_path.rglob("*")}
    made = {
        Path("python"),
        Path("python/a.py"),
        Path("python/.codewheel"),
        Path("c"),
        Path("c/x.h"),
        Path("c/.codewheel"),
    }
    assert left == before | made


@pytest.mark.parametrize("mark", [None, "", stage_module._MARK_TEXT[:20], stage_module._MARK_TEXT])
def test_a_stage_of_a_run_that_was_killed_at_its_mark_is_cleared(tmp_path: Path, mark: str | None) -> None:
    stage = tmp_path / ".codewheel-python-abcd1234"
    stage.mkdir()
    if mark is not None:
        (stage / ".codewheel-stage").write_text(mark)
    write(tmp_path, {"python": FILES})
    assert [path.name for path in tmp_path.iterdir()] == ["python"]


def test_check_removes_nothing_of_a_run_under_way(tmp_path: Path) -> None:
    (tmp_path / ".codewheel-python-abcd1234").mkdir()
    (tmp_path / ".codewheel-python-abcd1234/.codewheel-stage").write_text(stage_module._MARK_TEXT)
    list_changes(tmp_path, "python", FILES)
    assert (tmp_path / ".codewheel-python-abcd1234/.codewheel-stage").is_file()


def test_folders_keep_their_modes_and_empty_ones_stay(tmp_path: Path) -> None:
    write(tmp_path, {"python": FILES})
    (tmp_path / "python/empty/below").mkdir(parents=True)
    (tmp_path / "python/secret").mkdir()
    (tmp_path / "python/secret/x").write_text("x")
    modes = {"python": 0o2775, "python/secret": 0o500, "python/pkg": 0o770, "python/empty/below": 0o700}
    for name, mode in modes.items():
        (tmp_path / name).chmod(mode)
    write(tmp_path, {"python": {"python/a.py": "new\n", "python/pkg/c.py": "c\n"}})
    assert {name: (tmp_path / name).stat().st_mode & 0o7777 for name in modes} == modes
    assert [path.name for path in tmp_path.iterdir()] == ["python"]
    (tmp_path / "python/secret").chmod(0o700)


def test_a_folder_that_held_files_of_ours_alone_goes_with_them(tmp_path: Path) -> None:
    write(tmp_path, {"python": FILES})
    write(tmp_path, {"python": {"python/a.py": "a\n"}})
    assert not (tmp_path / "python/pkg").exists()


@pytest.mark.slow
def test_a_git_repository_in_a_target_folder_survives(tmp_path: Path) -> None:
    def git(*arguments: str) -> str:
        return subprocess.run(
            ["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments],
            cwd=place,
            capture_output=True,
            text=True,
            check=True,
        ).stdout

    write(tmp_path, {"python": FILES})
    place = tmp_path / "python"
    for command in (("init", "-q"), ("add", "-A"), ("commit", "-qm", "x"), ("gc", "-q")):
        git(*command)
    write(tmp_path, {"python": {**FILES, "python/a.py": "new\n"}})
    assert git("status", "--short") == " M a.py\n"


def test_files_of_the_users_in_the_way_are_named_and_nothing_is_written(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs/README.md").write_text("my own text")
    (tmp_path / "python").mkdir()
    (tmp_path / "python/pkg").write_text("my own file")
    (tmp_path / "python/.codewheel").write_text("my own list")
    (tmp_path / "c").mkdir()
    (tmp_path / "c/x.h").symlink_to(tmp_path / "docs/README.md")
    before = tree(tmp_path)
    targets = {"python": FILES, "c": {"c/x.h": "x"}, "docs": {"docs/README.md": "ours"}}
    with pytest.raises(WriteError) as caught:
        write(tmp_path, targets)
    assert str(caught.value) == (
        "in the way and not written by codewheel; nothing has changed; move it away, or overwrite files with --force:\n"
        f"  {tmp_path}/python/pkg, in place of a folder\n  {tmp_path}/python/.codewheel\n  {tmp_path}/c/x.h\n"
        f"  {tmp_path}/docs/README.md"
    )
    assert tree(tmp_path) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c", "docs", "python"]
    write(tmp_path, targets, force=True)
    assert tree(tmp_path) == {**FILES, "c/x.h": "x", "docs/README.md": "ours"}


def test_a_folder_in_the_way_is_named_and_never_overwritten(tmp_path: Path) -> None:
    (tmp_path / "python/a.py").mkdir(parents=True)
    for force in (False, True):
        with pytest.raises(WriteError) as caught:
            write(tmp_path, {"python": FILES}, force=force)
        assert str(caught.value).endswith(
            f"; nothing has changed; move it away:\n  {tmp_path}/python/a.py, a folder in place of a file"
        )
    assert [path.name for path in tmp_path.rglob("*")] == ["python", "a.py"]


def test_a_file_that_is_the_same_already_is_taken_over(tmp_path: Path) -> None:
    (tmp_path / "python").mkdir()
    (tmp_path / "python/a.py").write_text("a\n")
    assert FileChange("python/a.py", "unchanged") in write(tmp_path, {"python": FILES})
    write(tmp_path, {"python": {"python/a.py": "new\n"}})
    assert tree(tmp_path) == {"python/a.py": "new\n"}


@pytest.mark.parametrize("force", [False, True])
def test_a_file_with_the_name_of_a_target_is_kept(tmp_path: Path, force: bool) -> None:
    (tmp_path / "python").write_text("mine")
    with pytest.raises(WriteError, match="python is a file, but must be a folder; nothing has changed"):
        write(tmp_path, {"c": {"c/x.h": "x"}, "python": FILES}, force=force)
    assert [path.name for path in tmp_path.iterdir()] == ["python"]
    assert (tmp_path / "python").read_text() == "mine"


def no_exchange(*_: object, **__: object) -> None:
    """Simulates a system that cannot exchange two folders in one step."""
    raise OSError


@pytest.mark.parametrize("can_exchange", [True, False])
def test_a_failure_after_the_first_target_puts_it_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, can_exchange: bool
) -> None:
    write(tmp_path, {"python": FILES, "c": {"c/x.h": "x"}})
    (tmp_path / "python/mine.txt").write_text("mine")
    before = tree(tmp_path)
    real = stage_module._exchange

    def busy(stage: Path, place: Path) -> None:
        if place.name == "c":
            raise OSError(errno.EBUSY, os.strerror(errno.EBUSY), str(stage))
        real(stage, place)

    monkeypatch.setattr(stage_module, "_exchange", busy)
    if not can_exchange:
        monkeypatch.setattr(ctypes, "CDLL", no_exchange)
    new = {"docs": {"docs/x.md": "x"}, "python": dict.fromkeys(FILES, "new"), "c": {"c/x.h": "new"}}
    with pytest.raises(WriteError) as caught:
        write(tmp_path, new)
    assert str(caught.value) == f"cannot write {tmp_path}/c: Device or resource busy; nothing has changed"
    assert tree(tmp_path) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c", "python"]


def test_a_target_that_cannot_be_put_back_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, {"python": FILES})
    real = stage_module._exchange
    calls: list[str] = []

    def busy(stage: Path, place: Path) -> None:
        calls.append(place.name)
        if calls != ["python"]:
            raise OSError(errno.EBUSY, os.strerror(errno.EBUSY), str(stage))
        real(stage, place)

    monkeypatch.setattr(stage_module, "_exchange", busy)
    new = dict.fromkeys(FILES, "new")
    with pytest.raises(WriteError) as caught:
        write(tmp_path, {"python": new, "c": {"c/x.h": "x"}})
    assert (
        str(caught.value)
        == f"cannot write {tmp_path}/c: Device or resource busy; written before that: python; the rest is as it was"
    )
    assert tree(tmp_path) == new
    assert [path.name for path in tmp_path.iterdir()] == ["python"]


def test_works_without_an_exchange_of_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ctypes, "CDLL", no_exchange)
    write(tmp_path, {"python": FILES})
    write(tmp_path, {"python": {"python/a.py": "new\n"}})
    assert tree(tmp_path) == {"python/a.py": "new\n"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["python"]


def test_an_unwritable_place_is_one_clear_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(WriteError, match=r"cannot (write|read)"):
        write(tmp_path / "file" / "out", {"python": FILES})


def test_the_digest_is_that_of_the_disk_only_if_a_run_would_change_nothing(tmp_path: Path) -> None:
    files = {"c": {"c/empty": "", "c/inner/b": "text"}, "docs": {"docs/d": "µ"}}
    families = {"c": ["lika/amm5"], "docs": ["lika/amm5", "lika/sma21"]}
    expected = digest_of(files, families)
    assert expected != digest_of(files, {})
    assert digest_on_disk(tmp_path / "none", files) == ""

    def is_unchanged() -> bool:
        return digest_on_disk(tmp_path, files) == expected

    write(tmp_path, files, families=families)
    assert is_unchanged()
    assert digest_on_disk(tmp_path, ["docs"]) == digest_of({"docs": files["docs"]}, families)
    (tmp_path / "c" / "foreign").write_text("kept", encoding="utf-8")
    assert is_unchanged()
    inner = tmp_path / "c" / "inner" / "b"
    for spoil in (
        (tmp_path / "c" / "empty").unlink,
        lambda: inner.write_text("texT", encoding="utf-8"),
        lambda: inner.rename(tmp_path / "moved") and inner.symlink_to(tmp_path / "moved"),
        (tmp_path / "docs" / LIST).unlink,
        (tmp_path / ".codewheel-c-abcdefgh").mkdir,
        lambda: write(tmp_path, {"c": {**files["c"], "c/more": ""}}, families=families),
        lambda: write(tmp_path, files, families={**families, "docs": ["lika/amm5"]}),
    ):
        spoil()
        assert not is_unchanged()
        write(tmp_path, files, force=True, families=families)
        shutil.rmtree(tmp_path / ".codewheel-c-abcdefgh", ignore_errors=True)
        assert is_unchanged()


def test_a_target_that_is_a_link_has_no_digest(tmp_path: Path) -> None:
    files = {"c": {"c/a": "text"}}
    write(tmp_path, files)
    assert digest_on_disk(tmp_path, files) == digest_of(files, {})
    (tmp_path / "c").rename(tmp_path / "moved")
    (tmp_path / "c").symlink_to(tmp_path / "moved")
    assert digest_on_disk(tmp_path, files) == ""
