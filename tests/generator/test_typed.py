"""Data from the cache is used only if it has the types of our annotations."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypedDict

import pytest
from codewheel.cache import Cache
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.loading.stored import NotStorable, as_data, from_data
from codewheel.masters import sheet
from codewheel.model import Flag, Number
from codewheel.model.expressions import Expression
from codewheel.typed import fits

ROOT = Path(__file__).parents[2]
TV62 = ROOT / "docs" / "example" / "tolvarn"
JUNK: tuple[Any, ...] = (None, True, 7, 1.5, "x", [], ["x"], {"m": [], "f": False}, {"o": 0}, {"b": "00"})


class Pair(TypedDict):
    name: str
    count: int | None


@pytest.mark.parametrize(
    ("kind", "right", "wrong"),
    [
        (str, ["", "x"], [None, 1, b"x"]),
        (int, [0, 2**70], [True, 1.0, "1", None]),
        (float, [1, 1.5], [True, "1"]),
        (bytes, [b""], [""]),
        (int | None, [None, 1], [False, "1"]),
        (float | None, [None, 1], [True]),
        (tuple[str, ...], [(), ("a", "b")], [("a", 1), ["a"], "a"]),
        (tuple[str, int], [("a", 1)], [("a",), ("a", 1, 1), (1, "a")]),
        (tuple[Number | Flag, ...], [(Number(), Flag(False))], [(Number, 1)]),
        (list[list[str]], [[], [["a"]]], [["a"], [[1]], ({},)]),
        (Mapping[str, int], [{}, {"a": 1}, MappingProxyType({"a": 1})], [{"a": "1"}, {1: 1}, [("a", 1)]]),
        (dict[str, dict[str, str]], [{"a": {"b": "c"}}], [{"a": "b"}, {"a": {"b": 1}}]),
        (Pair, [{"name": "a", "count": None}], [{"name": "a"}, {"name": "a", "count": "1"}, {"name": "a", "n": 1}, 1]),
        (Any, [None, object()], []),
        (Expression, [Expression(1)], [1]),
    ],
)
def test_types(kind: Any, right: list[Any], wrong: list[Any]) -> None:
    assert [value for value in right if not fits(value, kind)] == []
    assert [value for value in wrong if fits(value, kind)] == []


def replaced(rows: list[Any], row: int, member: int, value: Any) -> list[Any]:
    changed = [*rows[row][:member], value, *rows[row][member + 1 :]]
    return [*rows[:row], changed, *rows[row + 1 :]]


def test_a_member_of_another_type_is_no_model() -> None:
    """Each member of each class once, with each value that does not have the type of the original."""
    devices, _ = load_library([TV62])
    rows = json.loads(json.dumps(as_data(devices[0])))
    assert from_data(rows) == devices[0]
    first = {row[0]: index for index, row in reversed(list(enumerate(rows)))}
    refused = 0
    for index in first.values():
        for member in range(1, len(rows[index])):
            for value in JUNK:
                try:
                    from_data(replaced(rows, index, member, value))
                except NotStorable:
                    refused += 1
    # A member accepts one or two of ten values.
    assert refused > 8 * sum(len(rows[index]) - 1 for index in first.values())


@pytest.mark.parametrize("value", [None, 7, "x", []])
def test_a_forged_model_is_built_again(
    value: object, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(TV62)
    monkeypatch.setattr(Cache, "put", lambda *_: None)
    rows = json.loads(json.dumps(as_data(load_library([TV62])[0][0])))
    first = {row[0]: index for index, row in reversed(list(enumerate(rows)))}
    asked: list[str] = []

    def shown(forged: object) -> tuple[int, str, str]:
        def get(self: Cache, kind: str, content: object) -> object:
            asked.append(kind)
            return ["digest", forged] if kind == "family" else None

        monkeypatch.setattr(Cache, "get", get)
        return (main(["show", "TV62-M17-B1", "--specs", "."]), *capsys.readouterr())

    without = shown(None)
    assert without == shown(rows)
    for index in [index for index in first.values() if len(rows[index]) > 1][::5]:
        member = 1 + index % (len(rows[index]) - 1)
        if type(value) is not type(rows[index][member]):
            assert shown(replaced(rows, index, member, value))[0] == 0
    assert "family" in asked


@pytest.mark.parametrize(
    ("command", "wrong"),
    [
        ("list", [{"family": True}]),
        ("list", [{**dict.fromkeys(("family", "title", "manufacturer", "pattern"), "x"), "order_codes": True}]),
        ("check", {"families": ["tv62"], "files": [["x"]]}),
        ("check", {"families": ["tv62"], "files": "x"}),
    ],
)
def test_a_forged_result_is_computed_again(
    command: str, wrong: object, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(TV62)
    monkeypatch.setattr(Cache, "put", lambda *_: None)
    monkeypatch.setattr(Cache, "get", lambda *_: None)
    assert main([command]) == 0
    without = capsys.readouterr()
    monkeypatch.setattr(Cache, "get", lambda self, kind, content: wrong if kind == command else None)
    assert main([command]) == 0
    assert capsys.readouterr() == without


def paths_in(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    for key, item in data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ():
        yield (*path, key)
        yield from paths_in(item, (*path, key))


def changed(data: Any, path: tuple[Any, ...], value: Any) -> Any:
    if not path:
        return value
    made = data.copy()
    made[path[0]] = changed(data[path[0]], path[1:], value)
    return made


def test_a_forged_master_is_read_again() -> None:
    masters = sheet.shipped_masters()
    data = json.loads(json.dumps([asdict(item) for item in masters]))
    assert tuple(map(sheet._master_from_cache, data)) == masters
    for path in paths_in(data[0]):
        for value in (1.5, [{"x": 1.5}]):
            with pytest.raises((KeyError, TypeError)):
                sheet._master_from_cache(changed(data[0], path, value))
