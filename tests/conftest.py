"""Fixtures that the tests share: the library of our specs, and the generated Python package."""

from __future__ import annotations

import fcntl
import functools
import gc
import importlib
import json
import os
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import deepcopy
from itertools import chain
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import working_tools
from codewheel import cache
from codewheel.commands import families_in_specs, outputs
from codewheel.commands.check import specs as checked_specs
from codewheel.language import files as spec_files_in_folders
from codewheel.language.problems import ProblemReport
from codewheel.loading import configuration_file
from codewheel.loading import library as loading
from codewheel.loading.overlays import Family
from codewheel.masters import sheet
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.docs.files import generate as generate_docs
from codewheel.virtual import simulation_options
from hostile_texts import spoilt
from hypothesis import HealthCheck, settings

# A slow machine is not an error, so no property test fails because of its time.
settings.register_profile("codewheel", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("codewheel")

ROOT = Path(__file__).resolve().parent.parent
MadeOnce = Callable[[str, Callable[[Path], object]], Path]
#: Grades of the encoders whose code and pages are in ``generated/``.
TRACKED_GRADES = ("manual", "quoted")
#: Folders of specs that no test changes.
_TESTS = ROOT / "tests"
_OURS = {ROOT / "specs", ROOT / "docs" / "example"}
_OURS |= {_TESTS / "specs", _TESTS / "c" / "specs", _TESTS / "python" / "specs", _TESTS / "browser" / "specs"}
#: Beginnings of the paths of the specs in these folders, and of the settings of this repository.
_OUR_FILES = (*(f"{folder}/" for folder in _OURS), f"{ROOT / 'pyproject.toml'}")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """A file with only slow tests is not imported if none of them is selected."""
    if config.option.markexpr != "not slow" or collection_path.suffix != ".py":
        return None
    return "\npytestmark = pytest.mark.slow\n" in collection_path.read_text(encoding="utf-8") or None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: Sequence[pytest.Item]) -> None:
    """A test that needs a shared artefact is slow, because one of these tests must build it.

    So are exhaustive tests.
    """
    cases_seen: Counter[tuple[Path, str, str]] = Counter()
    for test in items:
        for thinned in test.iter_markers("one_in"):
            count, mark = thinned.args
            if test.get_closest_marker(mark):
                continue
            cases = (test.path, getattr(test, "originalname", test.name), mark)
            if cases_seen[cases] % count:
                test.add_marker(mark)
            cases_seen[cases] += 1
        if ROOT / "tests" / "verify" in test.path.parents:
            test.add_marker(pytest.mark.exhaustive)
        if "made_once" in getattr(test, "fixturenames", ()) or test.get_closest_marker("exhaustive"):
            test.add_marker(pytest.mark.slow)


def pytest_configure() -> None:
    """Objects from the collection live until the end. Searching them for garbage takes a tenth of the whole time."""
    gc.disable()


def pytest_collection_finish() -> None:
    gc.freeze()
    gc.set_threshold(1_000_000)
    gc.enable()


def pytest_sessionfinish() -> None:
    """Remaining objects disappear with the process. pytest would search them twice."""
    gc.freeze()


_start_process = subprocess.Popen.__init__


def _refuse_to_start(self: Any, command: Any, *more: Any, **named: Any) -> None:
    raise AssertionError(f"this test runs {command}: mark it with pytest.mark.slow")


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Only tests that are marked as slow may start processes, apart from the few with a mark for this."""
    marks = {mark.name for mark in item.iter_markers()}
    may_start = not marks.isdisjoint({"slow", "starts_process"})
    subprocess.Popen.__init__ = _start_process if may_start else _refuse_to_start  # type: ignore[method-assign]


@pytest.fixture(scope="session", autouse=True)
def _specs_read_once() -> Iterator[None]:
    """Commands and tests of one process read the specs of this repository only once. Other specs are read each time."""
    families = _once(_building_once(loading.load_families), _spec_files)
    masters = _once(sheet.load_masters, _as_given)
    with pytest.MonkeyPatch.context() as patch:
        for module in (loading, outputs, checked_specs, simulation_options):
            patch.setattr(module, "load_families", families)
        patch.setattr(sheet, "load_masters", masters)
        # Commands look for an order code in the text of every packaged spec, and in the settings of this repository.
        for module, name in (
            (spec_files_in_folders, "top_keys"),
            (families_in_specs, "_read_spec_file"),
            (families_in_specs, "_read_beginnings"),
            (configuration_file, "read_configuration"),
        ):
            patch.setattr(module, name, _reading_unchanged_once(getattr(module, name)))
        yield


@pytest.fixture(scope="session", autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Processes keep results in a folder of their own, and tests, which patch the code, store none.

    pip keeps its downloads in their usual place.
    """
    with pytest.MonkeyPatch.context() as patch:
        if "PIP_CACHE_DIR" not in os.environ:
            patch.setenv("PIP_CACHE_DIR", str(Path(os.environ.get("XDG_CACHE_HOME", "~/.cache")).expanduser() / "pip"))
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        patch.setattr(cache, "default_folder", lambda: None)
        yield


@pytest.fixture(scope="session", autouse=True)
def _tools_are_tried_once(pytestconfig: pytest.Config, tmp_path_factory: pytest.TempPathFactory) -> None:
    """The processes of a run share the results."""
    base_folder = tmp_path_factory.getbasetemp()
    working_tools.results = (base_folder.parent if hasattr(pytestconfig, "workerinput") else base_folder) / "tools"


def _as_given(paths: Sequence[Path] | None) -> tuple[Path, ...]:
    return tuple(paths or ())


def _spec_files(paths: Sequence[Path] | None) -> tuple[Path, ...]:
    """Return the files of folders, apart from masters, so that ``specs`` is the same as all folders in it."""
    all_paths = loading.packaged_families() if paths is None else paths
    return tuple(chain.from_iterable(_files_in(path.resolve()) for path in all_paths))


@functools.cache
def _files_in(path: Path) -> tuple[Path, ...]:
    if path.is_file():
        return (path,)
    return tuple(file for file in sorted(path.rglob("*.yaml")) if file.parent.name != "masters")


def _building_once(load_families: Callable[..., Any]) -> Callable[..., Any]:
    """Return ``load_families`` that does not check and build the families of this repository again.

    It reads their specs, also copies in other folders, and takes the device of a spec with the same content.
    """
    built_families: dict[tuple[bytes | str, ...], Family] = {}

    def load(*arguments: Any, **options: Any) -> tuple[list[Family], ProblemReport]:
        if options or len(arguments) > 1:
            result: tuple[list[Family], ProblemReport] = load_families(*arguments, **options)
            return result
        families, report = load_families(*arguments, others=list(built_families.values()))
        if all(_is_unchanged(path) for path in (arguments[0] if arguments else None) or ()):
            built_families.update({tuple(family.content): family for family in families if family.content})
        return families, report

    return load


def _reading_unchanged_once(read: Callable[[Path], Any]) -> Callable[[Path], Any]:
    """Return ``read`` that keeps its results for files that no test changes."""
    # Results contain the path as it was given, which may be relative to the current folder.
    result_by_paths: dict[tuple[str, str], Any] = {}

    def read_unchanged_once(path: Path) -> Any:
        paths = (os.path.abspath(path), str(path))
        if not paths[0].startswith(_OUR_FILES):
            return read(path)
        if paths not in result_by_paths:
            result_by_paths[paths] = read(path)
        return result_by_paths[paths]

    return read_unchanged_once


def _is_unchanged(path: Path) -> bool:
    """Return whether a spec or folder is in a folder that no test changes."""
    return not _OURS.isdisjoint({*path.resolve().parents, path.resolve()})


def _once(
    read: Callable[..., Any], files_of: Callable[[Sequence[Path] | None], tuple[Path, ...]]
) -> Callable[..., Any]:
    results: dict[Any, Any] = {}

    def once(*arguments: Any, **options: Any) -> Any:
        paths: Sequence[Path] | None = arguments[0] if arguments else None
        if not all(_is_unchanged(path) for path in paths or ()):
            return read(*arguments, **options)
        # Messages have relative paths as they were given.
        is_absolute = all(path.is_absolute() for path in paths or ())
        key = files_of(paths) if is_absolute else (*files_of(paths), Path.cwd(), *(paths or ()))
        if key not in results:
            results[key] = read(*arguments[:1])
        families, report = results[key]
        return families, deepcopy(report)

    return once


@pytest.fixture(scope="session")
def every_encoder() -> Library:
    """All encoders in ``specs/``."""
    devices, report = loading.load_library([ROOT / "specs"])
    assert not report, "\n".join(problem.format() for problem in report.problems)
    return Library(devices)


@pytest.fixture(scope="session")
def library() -> Library:
    """The encoders whose code and pages are in ``generated/``: the encoders of the highest two grades.

    The other specs are not built, because most tests need none of them.
    """
    grade_pattern = re.compile(rf"\bgrade: ({'|'.join(TRACKED_GRADES)})\b")
    spec_files = [path for path in _files_in(ROOT / "specs") if ".second." not in path.name]
    devices, report = loading.load_library(
        [path for path in spec_files if grade_pattern.search(path.read_text(encoding="utf-8"))]
    )
    assert not report, "\n".join(problem.format() for problem in report.problems)
    assert all(device.evidence.grade in TRACKED_GRADES for device in devices)
    return Library(devices)


@pytest.fixture(scope="session")
def devices(library: Library) -> Mapping[str, Device]:
    return {device.name: device for device in library.devices}


@pytest.fixture(scope="session")
def amm5(devices: Mapping[str, Device]) -> Device:
    return devices["amm5"]


@pytest.fixture(scope="session")
def pages(library: Library, filled_once: MadeOnce) -> dict[str, str]:
    """The documentation of the library, by path, which the workers of a run share."""

    def fill(folder: Path) -> None:
        (folder / "pages.json").write_text(json.dumps(generate_docs(library)), encoding="utf-8")

    texts: dict[str, str] = json.loads((filled_once("pages", fill) / "pages.json").read_text(encoding="utf-8"))
    return texts


@pytest.fixture(scope="session")
def hostile(library: Library) -> Library:
    """Replace every running text of every device by one with the special characters of all output languages."""
    text = "a -- b --> c ]]> d | e <script>alert(1)</script> &amp; \"f\" 'g' `h` [i](j) ${k} *l* é − <!-- m -"
    return Library(tuple(spoilt(device, text) for device in library.devices))


@pytest.fixture(scope="session")
def made_once(filled_once: MadeOnce) -> MadeOnce:
    """Fill a folder once for all workers of a run, with something that takes long to build.

    Tests that use this are slow.
    """
    return filled_once


@pytest.fixture(scope="session")
def filled_once(pytestconfig: pytest.Config, tmp_path_factory: pytest.TempPathFactory) -> MadeOnce:
    """Fill a folder once for all workers of a run. The first one does the work, and the others wait for it."""
    base_folder = tmp_path_factory.getbasetemp()
    shared = base_folder.parent if hasattr(pytestconfig, "workerinput") else base_folder

    def filled_folder(name: str, fill: Callable[[Path], object]) -> Path:
        folder = shared / "once" / name
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / ".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not (folder / ".done").exists():
                fill(folder)
                (folder / ".done").touch()
        return folder

    return filled_folder


@pytest.fixture(scope="session")
def vectors() -> list[dict[str, Any]]:
    """Frames and CRCs that others have published, each with its source."""
    rows: list[dict[str, Any]] = json.loads((ROOT / "tests" / "vectors.json").read_text(encoding="utf-8"))
    return rows


@pytest.fixture(scope="session")
def import_generated(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Library, str], tuple[Path, ModuleType]]:
    """Write the Python package of a library to a folder of its own, import it, and return folder and package."""
    from codewheel.targets.python.files import generate

    def import_package(library: Library, package: str) -> tuple[Path, ModuleType]:
        return _write_and_import(generate(library), tmp_path_factory.mktemp("generated"), package)

    return import_package


def _write_and_import(files: Mapping[str, str], folder: Path, package: str) -> tuple[Path, ModuleType]:
    for path, text in files.items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
    return folder / "python", _import_from(folder / "python", package)


#: Folders from which tests of this process have imported each package, the last one first.
_FOLDERS_OF_PACKAGES: dict[str, list[Path]] = {}


def _import_from(folder: Path, package: str) -> ModuleType:
    """Import a package from a folder, also if other tests have imported packages of this name.

    Frames find the descriptions of their families by name, some of them on first use, so the modules of the older
    packages are still found.
    """
    older_modules = {name: module for name, module in sys.modules.items() if name.partition(".")[0] == package}
    for name in older_modules:
        del sys.modules[name]
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    try:
        imported = importlib.import_module(package)
    finally:
        sys.path.remove(str(folder))
    for name, module in older_modules.items():
        path = folder / name.replace(".", "/")
        if not path.is_dir() and not path.with_suffix(".py").exists():
            sys.modules.setdefault(name, module)
    inner = {name: importlib.import_module(f"{package}.{name}") for name in ("facts", "_shapes")}
    for older in _FOLDERS_OF_PACKAGES.setdefault(package, []):
        imported.__path__.append(str(older))
        for name, module in inner.items():
            module.__path__.append(str(older / name))
    _FOLDERS_OF_PACKAGES[package].insert(0, folder / package)
    return imported


@pytest.fixture(scope="session")
def python_files(library: Library) -> Mapping[str, str]:
    """The text of each file of the generated Python packages, by its path."""
    from codewheel.targets.python.files import generate

    return generate(library)


@pytest.fixture(scope="session")
def generated_python(
    python_files: Mapping[str, str], tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, ModuleType]:
    """The folder of the generated package, and the package."""
    return _write_and_import(python_files, tmp_path_factory.mktemp("generated"), "lika_encoders")


@pytest.fixture(scope="session")
def packages(generated_python: tuple[Path, ModuleType], library: Library) -> Mapping[str, ModuleType]:
    """The generated package of each family."""
    folder, main = generated_python
    makers = {device.manufacturer for device in library.devices if not device.manufacturer.main}
    imported = {
        maker.python_package: _import_from(folder / maker.python_package, maker.python_package) for maker in makers
    }
    return {device.name: imported.get(device.manufacturer.python_package, main) for device in library.devices}
