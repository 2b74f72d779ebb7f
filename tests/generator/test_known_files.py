"""Results by file: used as long as a file is the same, and never for a file that may have changed."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from codewheel import known_files
from codewheel.cache import Cache
from codewheel.known_files import KnownFiles
from codewheel.loading.selected import families_for
from codewheel.write import hashes, is_as_written, write


@pytest.fixture
def cache(tmp_path: Path) -> Cache:
    return Cache(tmp_path / "cache")


@pytest.fixture
def settled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Treat files as if they had not changed for a long time."""
    monkeypatch.setattr(known_files, "_SETTLED_NS", -(10**12))


def text_of(cache: Cache, path: Path, reads: list[str], place: str = "here") -> object:
    """Return the text of a file through the cache, and add it to ``reads`` if the file was read."""

    def read() -> str:
        reads.append(path.read_text(encoding="utf-8"))
        return reads[-1]

    known = KnownFiles(cache, "texts", [place])
    found = known.result(str(path), read)
    known.keep()
    return found


@pytest.mark.usefixtures("settled")
def test_a_file_is_read_once(cache: Cache, tmp_path: Path) -> None:
    path, reads = tmp_path / "file", list[str]()
    path.write_text("one", encoding="utf-8")
    assert [text_of(cache, path, reads) for _ in range(3)] == ["one"] * 3
    assert reads == ["one"]
    assert text_of(cache, path, reads, "elsewhere") == "one"
    assert reads == ["one", "one"]


@pytest.mark.usefixtures("settled")
@pytest.mark.skipif(os.name == "nt", reason="Windows has no time of the last change that programs cannot set")
def test_a_change_that_keeps_size_and_time_is_read(cache: Cache, tmp_path: Path) -> None:
    path, reads = tmp_path / "file", list[str]()
    path.write_text("one", encoding="utf-8")
    before = path.stat()
    assert text_of(cache, path, reads) == "one"
    path.write_text("two", encoding="utf-8")
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert path.stat().st_mtime_ns == before.st_mtime_ns
    assert text_of(cache, path, reads) == "two"


@pytest.mark.usefixtures("settled")
def test_another_file_of_the_same_name_is_read(cache: Cache, tmp_path: Path) -> None:
    path, other, reads = tmp_path / "file", tmp_path / "other", list[str]()
    path.write_text("one", encoding="utf-8")
    other.write_text("two", encoding="utf-8")
    assert text_of(cache, path, reads) == "one"
    os.replace(other, path)
    assert text_of(cache, path, reads) == "two"


def test_a_file_that_has_just_changed_is_read_again(cache: Cache, tmp_path: Path) -> None:
    path, reads = tmp_path / "file", list[str]()
    path.write_text("one", encoding="utf-8")
    os.utime(path, (0, 0))
    assert [text_of(cache, path, reads) for _ in range(2)] == ["one"] * 2
    assert reads == ["one", "one"]


@pytest.mark.usefixtures("settled")
@pytest.mark.parametrize("form", [None, [], {"": 1}, "path", {"path": 1}, {"path": []}, {"path": [[], "two"]}])
def test_an_entry_of_another_form_is_ignored(cache: Cache, tmp_path: Path, form: object) -> None:
    path = tmp_path / "file"
    path.write_text("one", encoding="utf-8")
    entry = {str(path): form["path"]} if isinstance(form, dict) and "path" in form else form
    cache.put("texts", [os.getcwd(), "here"], entry)
    assert text_of(cache, path, []) == "one"


@pytest.mark.usefixtures("settled")
@pytest.mark.parametrize("result", [None, [], {}, {"is_spec": 1}, {"shows": 1}, {"is_spec": True, "shows": [1, 2, 3]}])
def test_a_result_of_another_form_selects_no_family(cache: Cache, tmp_path: Path, result: object) -> None:
    path = tmp_path / "spec.yaml"
    path.write_text("codewheel: 1\ndevice: none\n", encoding="utf-8")
    known = KnownFiles(cache, "glances", [str(tmp_path)])
    known.result(str(path), lambda: result)
    known.keep()
    assert families_for([tmp_path], "none", cache) is None


@pytest.mark.usefixtures("settled")
def test_a_written_file_that_changes_is_found(cache: Cache, tmp_path: Path) -> None:
    files = {"c": {"c/a": "one", "c/b": "two"}}
    expected = {target: hashes(texts) for target, texts in files.items()}

    def is_same() -> bool:
        known = KnownFiles(cache, "written files", [])
        found = is_as_written(tmp_path / "out", expected, known.result)
        known.keep()
        return found

    write(tmp_path / "out", files)
    assert [is_same() for _ in range(2)] == [True, True]
    place = tmp_path / "out" / "c" / "b"
    place.write_text("owt", encoding="utf-8")
    assert not is_same()
    place.write_text("two", encoding="utf-8")
    assert is_same()
    place.rename(tmp_path / "b")
    place.symlink_to(tmp_path / "b")
    assert not is_same()
