"""Targets of others: whatever they do, it is one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from codewheel import targets
from codewheel.cli import main


class Entry:
    """Stands for an entry point."""

    def __init__(self, made: Callable[[], object]) -> None:
        self.load = made


def fails(*_: object) -> object:
    raise KeyError("a\nb")


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: fails, "the target 'mine' fails: KeyError: 'a\\nb' ("),
        (lambda: None, "the target 'mine' fails: TypeError: 'NoneType' object is not callable ("),
        (fails, "the target 'mine' cannot be loaded: KeyError: 'a\\nb' ("),
        (lambda: lambda _: None, "the target 'mine' has to give text by path; this is nothing"),
        (lambda: lambda _: b"x", "the target 'mine' has to give text by path; this is bytes"),
        (lambda: lambda _: ["mine/x"], "the target 'mine' has to give text by path; this is list"),
        (lambda: lambda _: {"mine/x": b"x"}, "the target 'mine' has to give text by path; 'mine/x' is bytes"),
        (lambda: lambda _: {1: "x"}, "the target 'mine' has to give text by path; 1 is no path"),
        (lambda: lambda _: {"mine/x": "\ud800"}, "the target 'mine' has to give text by path; 'mine/x' holds U+D800, which is no character"),
    ],
)
def test_its_faults_are_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], made: Callable[[], object], message: str
) -> None:
    monkeypatch.setattr(targets, "_registered", lambda: {"mine": Entry(made)})
    assert main(["generate", "-o", str(tmp_path / "out"), "--target", "mine"]) == 1
    err = capsys.readouterr().err
    assert err.startswith(f"codewheel: {message}") and err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_it_is_known_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(targets, "_registered", lambda: {"rust": Entry(lambda: lambda _: {"rust/x.rs": "x"})})
    assert main(["generate", "-o", str(tmp_path), "--target", "rust"]) == 0
    assert (tmp_path / "rust/x.rs").read_text() == "x"
    assert main(["generate", "-o", str(tmp_path), "--target", "ruts"]) == 2
    assert capsys.readouterr().err == "codewheel: there is no target 'ruts'; did you mean 'rust'?\n"
