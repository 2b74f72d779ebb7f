"""Writing: whole or not at all, and nothing outside the folder."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from codewheel import write as module
from codewheel.write import Change, WriteError, changes, write

FILES = {"python/a.py": "a\n", "python/pkg/b.py": "b\n"}


def tree(folder: Path) -> dict[str, str]:
    return {path.relative_to(folder).as_posix(): path.read_text() for path in sorted(folder.rglob("*")) if path.is_file() and path.name != ".codewheel"}


def test_writes_then_leaves_unchanged_files_alone(tmp_path: Path) -> None:
    assert write(tmp_path, {"python": FILES}) == [Change("python/a.py", "written"), Change("python/pkg/b.py", "written")]
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.py")}
    assert {item.what for item in write(tmp_path, {"python": FILES})} == {"unchanged"}
    assert write(tmp_path, {"python": {**FILES, "python/a.py": "new\n"}}) == [Change("python/a.py", "written"), Change("python/pkg/b.py", "unchanged")]
    assert (tmp_path / "python/pkg/b.py").stat().st_mtime_ns == before[tmp_path / "python/pkg/b.py"]
    assert tree(tmp_path) == {"python/a.py": "new\n", "python/pkg/b.py": "b\n"}


def test_removes_what_it_no_longer_writes_and_nothing_else(tmp_path: Path) -> None:
    write(tmp_path, {"python": FILES})
    (tmp_path / "python/mine.txt").write_text("mine")
    (tmp_path / "python/pkg/mine.txt").write_text("mine too")
    (tmp_path / "other").mkdir()
    (tmp_path / "other/mine.txt").write_text("mine as well")
    assert Change("python/pkg/b.py", "removed") in write(tmp_path, {"python": {"python/a.py": "a\n"}})
    assert tree(tmp_path) == {"other/mine.txt": "mine as well", "python/a.py": "a\n", "python/mine.txt": "mine", "python/pkg/mine.txt": "mine too"}


def test_check_changes_nothing(tmp_path: Path) -> None:
    write(tmp_path, {"python": FILES})
    before = tree(tmp_path)
    assert changes(tmp_path, "python", {"python/a.py": "x"}) == [Change("python/a.py", "written"), Change("python/pkg/b.py", "removed")]
    assert tree(tmp_path) == before


@pytest.mark.parametrize("path", ["../x", "python/../../x", "/etc/x", "c/x", "python/a\nb", "python//x", "x"])
def test_refuses_paths_outside_the_target(tmp_path: Path, path: str) -> None:
    with pytest.raises(WriteError, match="is not one inside its folder 'python/'"):
        write(tmp_path / "out", {"python": {path: "x"}})
    assert not (tmp_path / "out").exists()


def test_refuses_a_linked_target_folder(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "out").mkdir()
    (tmp_path / "out/python").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(WriteError, match="is a link"):
        write(tmp_path / "out", {"python": FILES})
    assert not list((tmp_path / "elsewhere").iterdir())


def test_a_list_cannot_name_files_outside(tmp_path: Path) -> None:
    victim = tmp_path / "victim"
    victim.write_text("precious")
    (tmp_path / "out/python").mkdir(parents=True)
    (tmp_path / "out/python/.codewheel").write_text("../../victim\n/etc/passwd\n")
    write(tmp_path / "out", {"python": FILES})
    assert victim.read_text() == "precious"


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

    monkeypatch.setattr(module, "open", full, raising=False)
    with pytest.raises(WriteError, match="No space left on device"):
        write(tmp_path, {"python": {name: "new" for name in FILES}, "c": {"c/x.h": "new"}})
    assert tree(tmp_path) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c", "python"]


def test_what_a_killed_run_left_is_cleared(tmp_path: Path) -> None:
    write(tmp_path, {"python": FILES})
    (tmp_path / ".python-abcd1234").mkdir()
    write(tmp_path, {"python": {"python/a.py": "new\n"}})
    assert sorted(path.name for path in tmp_path.iterdir()) == ["python"]


def test_works_without_an_exchange_of_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object, **__: object) -> None:
        raise OSError

    monkeypatch.setattr(module.ctypes, "CDLL", none)
    write(tmp_path, {"python": FILES})
    write(tmp_path, {"python": {"python/a.py": "new\n"}})
    assert tree(tmp_path) == {"python/a.py": "new\n"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["python"]


def test_an_unwritable_place_is_one_clear_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(WriteError, match="cannot (write|read)"):
        write(tmp_path / "file" / "out", {"python": FILES})
