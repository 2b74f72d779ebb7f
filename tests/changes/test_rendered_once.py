"""``diff`` loads equal families once, and renders no family that is the same on both sides."""

from __future__ import annotations

import shutil
from collections import Counter
from pathlib import Path

import pytest
from codewheel.cache import NO_CACHE, Cache
from codewheel.commands.generate.files import changed_files, unchanged_families
from codewheel.commands.outputs import FamilyParts
from codewheel.loading import library
from codewheel.loading.configuration import BUILT_IN, FamilyFilter
from codewheel.loading.library import load_families
from codewheel.model import Device
from codewheel.render import Templates
from codewheel.targets import Library
from codewheel.targets.registry import load_target

ROOT = Path(__file__).parents[2]
HIGHEST_CLOCK = 'clock: {min_hz: 100000, max_hz: 3000000, source: "5.3"}'


@pytest.fixture
def sides(tmp_path: Path) -> tuple[Path, Path]:
    """The families am36 and asc85, before and after a change of the highest clock of am36."""
    old, new = tmp_path / "old", tmp_path / "new"
    for folder in (old, new):
        folder.mkdir()
        for name in ("manufacturer.yaml", "am36.yaml", "asc85.yaml"):
            shutil.copy(ROOT / "specs" / "lika" / name, folder / name)
    text = (new / "am36.yaml").read_text(encoding="utf-8")
    assert text.count(HIGHEST_CLOCK) == 1
    changed_text = text.replace(HIGHEST_CLOCK, HIGHEST_CLOCK.replace("3000000", "2900000"))
    (new / "am36.yaml").write_text(changed_text, encoding="utf-8")
    return old, new


def devices_of(sides: tuple[Path, Path]) -> tuple[list[Device], list[Device]]:
    old, _ = load_families([sides[0]], others=())
    new, _ = load_families([sides[1]], others=old)
    return [family.device for family in old], [family.device for family in new]


def test_only_changed_families_are_built_again(sides: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    built: Counter[str] = Counter()
    build = library.build_device

    def counted_build(data: dict[str, str], *arguments: object) -> Device | None:
        built[data["device"]] += 1
        return build(data, *arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(library, "build_device", counted_build)
    old, new = devices_of(sides)
    editions = {device.name: built[device.name] for device in old}
    assert new[1] is old[1]
    assert new[0] is not old[0]
    devices_of((sides[0], sides[0]))
    assert built["asc85"] == 2 * editions["asc85"]


@pytest.mark.slow
def test_families_with_equal_models_are_unchanged(sides: tuple[Path, Path]) -> None:
    asc85 = sides[1] / "asc85.yaml"
    asc85.write_text("# a comment\n" + asc85.read_text(encoding="utf-8"), encoding="utf-8")
    old, new = devices_of(sides)
    assert new[1] is not old[1]
    assert unchanged_families(old, new) == {"asc85"}
    assert unchanged_families(old[:1], new[1:]) == frozenset()


@pytest.mark.slow
def test_no_text_of_an_unchanged_family_is_rendered(sides: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    old, new = devices_of(sides)
    rendered: Counter[str] = Counter()
    render = Templates.render

    def counted_render(self: Templates, template: str, values: object, own_folder: Path | None) -> str:
        rendered[template] += 1
        return render(self, template, values, own_folder)  # type: ignore[arg-type]

    monkeypatch.setattr(Templates, "render", counted_render)
    found = changed_files(old, new, NO_CACHE)
    assert found is not None
    assert not [name for name in found.changed_paths if "asc85" in name]
    pages_of_a_family = ("hardware.md.jinja", "manual.md.jinja", "errata.md.jinja", "changes.md.jinja")
    assert {name: rendered[name] for name in pages_of_a_family} == dict.fromkeys(pages_of_a_family, 2)


@pytest.mark.slow
def test_changes_and_count_are_those_of_complete_files(sides: tuple[Path, Path]) -> None:
    old, new = devices_of(sides)

    def complete_files(devices: list[Device]) -> dict[str, str]:
        files: dict[str, str] = {}
        for target in map(load_target, BUILT_IN):
            files |= target.files(Library(tuple(devices)), target.defaults)
        return files

    before, after = complete_files(old), complete_files(new)
    found = changed_files(old, new, NO_CACHE)
    assert found is not None
    assert found.file_count == len(before | after)
    assert list(found.changed_paths) == [name for name in sorted(before | after) if before.get(name) != after.get(name)]


@pytest.mark.slow
def test_outputs_that_the_settings_leave_out_are_not_compared(sides: tuple[Path, Path]) -> None:
    old, new = devices_of(sides)
    changed_names = {device.name for device in new}
    filters = {"masters": FamilyFilter(families=("asc85",))}
    found = changed_files(old, new, NO_CACHE, filters)
    assert changed_names > {"asc85"}
    assert found is not None
    assert not [name for name in found.changed_paths if name.startswith("masters/")]


@pytest.mark.slow
def test_texts_that_are_left_out_are_not_stored(sides: tuple[Path, Path], tmp_path: Path) -> None:

    old, new = devices_of(sides)
    cache = Cache(tmp_path / "cache")
    assert changed_files(old, new, cache) is not None
    target = load_target("python")
    stored = FamilyParts(cache).files_of(target, Library(tuple(old)), target.defaults)
    assert stored == target.files(Library(tuple(old)), target.defaults)
