"""The cache: damaged, foreign and unsafe entries are ignored, and its size has a limit."""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from codewheel import cache as cache_module
from codewheel.cache import Cache, content_of, default_folder, key_of


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own, which is empty."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(cache_module, "default_folder", default_folder)
    return tmp_path / "cache" / "codewheel"


def entries(folder: Path) -> list[Path]:
    return sorted(folder.iterdir()) if folder.is_dir() else []


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
    assert (bool(cache), bool(Cache(None))) == (True, False)


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


def test_another_version_has_other_entries(kept: tuple[Cache, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    cache, place = kept
    monkeypatch.setattr(cache_module, "_hash_of_tool", lambda: "another version")
    assert cache.get("number", ["a"]) is None
    cache.put("number", ["a"], "of the other")
    monkeypatch.undo()
    assert len(entries(place.parent)) == 2


def test_the_code_of_the_tool_is_part_of_the_key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "generator"
    package.mkdir()
    (package / "some.py").write_text("A = 1", encoding="utf-8")
    monkeypatch.setattr(cache_module, "__file__", str(package / "cache.py"))
    first = cache_module._hash_of_tool.__wrapped__()
    assert cache_module._hash_of_tool.__wrapped__() == first
    times = (package / "some.py").stat()
    (package / "some.py").write_text("A = 2", encoding="utf-8")
    os.utime(package / "some.py", ns=(times.st_atime_ns, times.st_mtime_ns))
    assert cache_module._hash_of_tool.__wrapped__() != first


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


def test_content_has_names_and_bytes(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"1")
    assert content_of([tmp_path / "a", tmp_path / "b"]) == ["a", b"1", "b", "missing"]
    assert key_of("k", ["a", "b"]) != key_of("k", ["ab"])
