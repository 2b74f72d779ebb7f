"""Only the families that a label or a name can belong to are loaded, from the cache if they are in it."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from codewheel.cache import Cache
from codewheel.commands import families_in_specs
from codewheel.commands.families_in_specs import families_for
from codewheel.loading import library as library_module
from codewheel.loading.library import load_library

SPECS = Path(__file__).resolve().parents[2] / "specs" / "lika"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An empty cache."""
    return tmp_path / "cache"


@pytest.fixture
def specs(tmp_path: Path) -> Path:
    """A copy of our specs."""
    place = tmp_path / "specs"
    shutil.copytree(SPECS, place)
    return place


@pytest.mark.slow
def test_only_the_family_of_the_order_code_is_loaded(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def names(text: str) -> list[str]:
        return [device.name for device in families_for([SPECS], text, Cache(folder)) or ()]

    assert names("sma21") == ["sma21"]
    assert names(" AMM5 ") == ["amm5"]
    # The pattern of AM36 begins with a part, whose values are read once, without the rest of the spec.
    assert names("AMM5A21/65KSC1-K") == ["amm5"]
    monkeypatch.setattr(families_in_specs, "_read_beginnings", None)
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
    assert families_in_specs._read_beginnings(spec) == found


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
def test_a_file_that_changes_while_it_is_read_is_not_kept(
    folder: Path, specs: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def changing(paths: list[Path]) -> object:
        found = load_library(paths)
        with open(specs / "sma21.yaml", "a", encoding="utf-8") as file:
            file.write("# changed\n")
        return found

    monkeypatch.setattr(library_module, "load_library", changing)
    assert families_for([specs], "sma21", Cache(folder))
    assert not folder.exists()
