"""Packages of two manufacturers in one program share the runtime, and refuse a runtime that does not match."""

from __future__ import annotations

import dataclasses
import doctest
import importlib.metadata
import os
import re
import shutil
import subprocess
import sys
import venv
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import codewheel_runtime
import pytest
from codewheel.commands.cli import main
from codewheel.targets import Library
from codewheel.targets.python.files import RUNTIME, generate, runtime_version
from exhaustive import mostly_exhaustive
from test_public_names import RARE

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "python-two-manufacturers"
NAMES = ("lika_encoders", "tolvarn_encoders")
VERSION = '__version__: Final = "1.0.0"'
REFUSED = "needs codewheel-runtime 1.0 or a later 1.x, but {} is installed"


@pytest.fixture(scope="module")
def packages_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with the packages of both manufacturers and their runtime. Its path has a space."""
    folder = tmp_path_factory.mktemp("both") / "with a space"
    specs = [str(ROOT / "specs" / "lika"), str(ROOT / "docs" / "example" / "tolvarn")]
    assert main(["generate", *specs, "--target", "python", "-o", str(folder)]) == 0
    return folder / "python"


def run(*command: str | Path, folders: tuple[Path, ...] = (), cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run a command with the packages in these folders, in Python and for mypy."""
    path = os.pathsep.join(map(str, folders))
    environment = {**os.environ, "PYTHONPATH": path, "MYPYPATH": path}
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, env=environment, cwd=cwd)


def doctored(folder: Path, version: str) -> Path:
    """Make a copy of the runtime's distribution that has another version."""
    place = folder / version
    shutil.copytree(RUNTIME, place, ignore=shutil.ignore_patterns("__pycache__"))
    (place / "LICENSE").write_text("")
    text = (place / "codewheel_runtime" / "version.py").read_text(encoding="utf-8")
    assert VERSION in text
    (place / "codewheel_runtime" / "version.py").write_text(text.replace(VERSION, VERSION.replace("1.0.0", version)))
    return place


def test_the_names_are_those_of_the_runtime(generated_python: tuple[Path, ModuleType]) -> None:
    lika: Any = generated_python[1]
    shared = {*codewheel_runtime.__all__} - {"__version__"} - RARE
    assert shared < {*lika.__all__}
    assert {name for name in shared if getattr(lika, name) is not getattr(codewheel_runtime, name)} == set()
    assert lika.biss.Master is importlib.import_module("codewheel_runtime.biss").Master


@pytest.mark.slow
def test_there_is_one_runtime(packages_folder: Path) -> None:
    guides = {"live-line.md", "files-and-captures.md", "test-without-an-encoder.md"}
    beside = {"LICENSE", "README.md", "pyproject.toml", "setup.py", *guides}
    assert {path.name for path in packages_folder.iterdir()} == {*beside, *NAMES, "runtime", ".codewheel"}
    assert {path.name for path in (packages_folder / NAMES[1]).iterdir()} == {*beside, NAMES[1]}
    assert "pip install . ./tolvarn_encoders\n" in (packages_folder / "README.md").read_text()
    assert "pip install . ..\n" in (packages_folder / NAMES[1] / "README.md").read_text()


@pytest.mark.slow
def test_without_a_main_manufacturer_each_has_its_folder(library: Library) -> None:
    lika = library.by_manufacturer()[0][0]
    devices = []
    for device in library.devices:
        if device.name in ("icmu", "sma21"):
            manufacturer = dataclasses.replace(device.manufacturer, main=False)
            devices.append(dataclasses.replace(device, manufacturer=manufacturer))
    assert lika.main
    files = generate(Library(tuple(devices)))
    for name, other_package in (("lika_encoders", "ichaus_encoders"), ("ichaus_encoders", "lika_encoders")):
        assert f"python/{name}/pyproject.toml" in files
        assert f"python/{name}/{name}/__init__.py" in files
        assert f"pip install . ../{other_package}\n" in files[f"python/{name}/README.md"]
        assert "(../runtime/README.md)" in files[f"python/{name}/README.md"]
    assert "python/pyproject.toml" not in files


@pytest.mark.slow
def test_the_example(packages_folder: Path) -> None:
    readme = (EXAMPLE / "README.md").read_text(encoding="utf-8")
    program = EXAMPLE / "positions.py"
    commands, expected_output = re.findall(r"```(?:text)?\n(.*?)```", readme, re.DOTALL)
    assert commands.splitlines() == [
        "codewheel generate specs/lika docs/example/tolvarn --target python -o out",
        "pip install out/python out/python/tolvarn_encoders",
        f"python {program.relative_to(ROOT).as_posix()}",
    ]
    folders = (packages_folder, packages_folder / NAMES[1], packages_folder / "runtime")
    completed = run(sys.executable, program, folders=folders)
    assert (completed.stdout, completed.stderr) == (expected_output, "")
    completed = run(sys.executable, "-m", "mypy", "--strict", "--no-incremental", program, folders=folders)
    assert completed.returncode == 0, completed.stdout


@pytest.mark.slow
def test_the_readme_of_the_runtime(generated_python: tuple[Path, ModuleType], tmp_path: Path) -> None:
    program, *examples = re.findall(
        r"```python\n(.*?)```", (RUNTIME / "README.md").read_text(encoding="utf-8"), re.DOTALL
    )
    test = doctest.DocTestParser().get_doctest("\n".join(examples), {}, "README.md", None, 0)
    assert len(test.examples) > 4
    assert doctest.DocTestRunner().run(test).failed == 0
    names: dict[str, Any] = {}
    exec(program, names)
    encoder = generated_python[1].lookup("AMM5A21/65KSC1")
    assert [names["position"](encoder, word) for word in (0xF4243D3, 0xF424355, 0xF4243D2)] == [1000003, None, None]
    (tmp_path / "program.py").write_text(program, encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", "--no-incremental", tmp_path / "program.py"]
    completed = run(*command, folders=(RUNTIME,))
    assert completed.returncode == 0, completed.stdout


# The version of the runtime


@pytest.mark.slow
def test_the_version_stands_in_one_place(packages_folder: Path) -> None:
    major, minor = runtime_version().split(".")
    needed = re.search(r'^NEEDED, FITTING = "(.*)", "(.*)"$', (packages_folder / "setup.py").read_text(), re.MULTILINE)
    assert needed is not None
    assert needed.groups() == (f"{major}.{minor}", f"codewheel-runtime>={major}.{minor},<{int(major) + 1}")
    for folder, name in ((packages_folder, NAMES[0]), (packages_folder / NAMES[1], NAMES[1])):
        text = (folder / name / "__init__.py").read_text(encoding="utf-8")
        assert f'__runtime__: Final = require(__name__, "{major}.{minor}")\n' in text


@pytest.mark.parametrize("needed", ["1.0", "0.9", "2.0", "1.1"])
def test_only_the_same_major_version_fits(needed: str) -> None:
    from codewheel_runtime.version import require

    if needed == "1.0":
        assert require("some_encoders", needed) == "1.0.0"
        return
    with pytest.raises(ImportError) as caught:
        require("some_encoders", needed)
    wanted = f"{needed} or a later {needed[0]}.x"
    assert str(caught.value) == f"some_encoders needs codewheel-runtime {wanted}, but 1.0.0 is installed"


@pytest.mark.slow
@pytest.mark.parametrize("version", mostly_exhaustive(["0.9.0", "1.0.1", "1.1.0", "2.0.0"], "2.0.0"))
def test_a_runtime_that_does_not_fit_is_refused(packages_folder: Path, tmp_path: Path, version: str) -> None:
    """The import of the package checks it, and so does its build if the runtime is next to it."""
    place = doctored(tmp_path, version)
    completed = run(sys.executable, "-c", "import tolvarn_encoders.tv62", folders=(packages_folder / NAMES[1], place))
    shutil.copytree(packages_folder / NAMES[1], tmp_path / "tree" / "it")
    place.rename(tmp_path / "tree" / "runtime")
    built = run(sys.executable, "setup.py", "--quiet", "egg_info", cwd=tmp_path / "tree" / "it")
    if version.startswith("1."):
        assert (completed.returncode, completed.stderr) == (0, "")
        assert built.returncode == 0, built.stderr
        return
    assert completed.stderr.splitlines()[-1] == f"ImportError: tolvarn_encoders {REFUSED.format(version)}"
    assert built.stderr.splitlines()[-1] == f"ImportError: this package {REFUSED.format(version)}"


# Installed packages


@pytest.fixture(scope="module")
def pip(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., subprocess.CompletedProcess[str]]:
    """A command for a fresh environment that has setuptools and no index."""
    place = tmp_path_factory.mktemp("installed") / "venv"
    venv.create(place)
    (site,) = (place / "lib").glob("python*/site-packages")
    for file in importlib.metadata.files("setuptools") or ():
        if ".." not in file.parts and "__pycache__" not in file.parts:
            (site / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(str(file.locate()), site / file)

    def run_installed(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
        if arguments[0] == "python":
            return run(place / "bin" / "python", *arguments[1:], cwd=place)
        options = ["--no-index", "--no-build-isolation", "--quiet"] if arguments[0] == "install" else []
        common = ["-m", "pip", "--python", place / "bin" / "python", "--disable-pip-version-check"]
        return run(sys.executable, *common, arguments[0], *options, *arguments[1:])

    return run_installed


@pytest.mark.exhaustive
def test_one_command_installs_both_and_one_can_go(packages_folder: Path, pip: Any, tmp_path: Path) -> None:
    """Without an index, and in a path with a space."""
    shutil.copytree(packages_folder, tmp_path / "a copy")
    completed = pip("install", tmp_path / "a copy", tmp_path / "a copy" / NAMES[1])
    assert completed.returncode == 0, completed.stderr
    program = "import codewheel_runtime, {0}; print({0}.Verdict is codewheel_runtime.Verdict, {0}.__runtime__)"
    for name in NAMES:
        assert pip("python", "-c", program.format(name)).stdout == "True 1.0.0\n"
    assert pip("uninstall", "--yes", "--quiet", "lika-encoders").returncode == 0
    assert pip("python", "-c", program.format(NAMES[1])).stdout == "True 1.0.0\n"
    assert "No module named 'lika_encoders'" in pip("python", "-c", program.format(NAMES[0])).stderr
    assert pip("python", "-m", "tolvarn_encoders", "--version").stdout == "tolvarn-encoders 0.1.0\n"
