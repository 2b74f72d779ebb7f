"""The generated package as built and installed: its licence is in the metadata, and the file is in the wheel."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Mapping
from email import message_from_bytes
from email.message import Message
from pathlib import Path

import pytest
from exhaustive import mostly_exhaustive


@pytest.fixture(scope="module")
def source(files: Mapping[str, str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("source")
    for path, text in files.items():
        place = folder / path
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, encoding="utf-8")
    return folder / "python"


@pytest.fixture(scope="module")
def release(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a source archive and a wheel of the package and of the runtime, as in a release."""
    folder = tmp_path_factory.mktemp("release")
    for project in (source, source / "runtime"):
        completed = run("build", "--quiet", "--no-isolation", "--outdir", folder, project)
        assert completed.returncode == 0, completed.stdout + completed.stderr
    return folder


def run(module: str, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", module, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def metadata_of(wheel: zipfile.ZipFile) -> Message:
    return message_from_bytes(next(wheel.read(name) for name in wheel.namelist() if name.endswith("/METADATA")))


@pytest.mark.slow
def test_the_runtime_is_all_that_is_needed(release: Path) -> None:
    """The package requires it by version. A release is for other machines, so it names no folder of this one."""
    needed = metadata_of(zipfile.ZipFile(next(release.glob("lika_encoders-*.whl")))).get_all("Requires-Dist", [])
    assert [requirement for requirement in needed if "extra ==" not in requirement] == ["codewheel-runtime<2,>=1.0"]
    assert not metadata_of(zipfile.ZipFile(next(release.glob("codewheel_runtime-*.whl")))).get_all("Requires-Dist", [])
    with tarfile.open(next(release.glob("lika_encoders-*.tar.gz"))) as archive:
        texts = {member.name: archive.extractfile(member) for member in archive.getmembers() if member.isfile()}
        assert not [name for name in texts if "codewheel_runtime" in name]
        assert not [name for name, text in texts.items() if text is not None and b"file:///" in text.read()]


@pytest.fixture(scope="module")
def handed_over(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folders with wheels and source archives as built by pip, after their source has moved to another place."""
    folder = tmp_path_factory.mktemp("handed over")
    shutil.copytree(source, folder / "source")
    shutil.copytree(source / "runtime", folder / "runtime")
    for old_build in ("source/build/lib/lika_encoders", "source/runtime/build/lib/codewheel_runtime"):
        (folder / old_build).mkdir(parents=True)
        (folder / old_build / "removed.py").touch()
    first, _ = colleague_commands((folder / "source" / "README.md").read_text(encoding="utf-8"))
    command = first.replace(" dist .", "").split()[1:]
    options = ["--no-index", "--no-build-isolation", "--quiet", "--disable-pip-version-check"]
    completed = run("pip", *command, folder / "wheels", folder / "source", *options)
    assert completed.returncode == 0, completed.stderr
    for project in ("source", "runtime"):
        build_options = ["--sdist", "--quiet", "--no-isolation", "--outdir", folder / "sdists"]
        completed = run("build", *build_options, folder / project)
        assert completed.returncode == 0, completed.stdout + completed.stderr
    (folder / "source").rename(folder / "moved source")
    (folder / "runtime").rename(folder / "moved runtime")
    return folder


def colleague_commands(readme: str) -> list[str]:
    match = re.search(r"To give the package to a colleague.*?```\n(.*?)```", readme, re.DOTALL)
    assert match is not None
    commands = match[1].splitlines()
    assert commands[0] == "pip wheel -w dist ."
    assert commands[1] == "pip install --force-reinstall --no-index --find-links dist lika-encoders"
    return commands


@pytest.mark.slow
@pytest.mark.parametrize("kind", mostly_exhaustive(["wheels", "sdists"], "wheels"))
def test_the_package_installs_where_its_source_is_not(handed_over: Path, tmp_path: Path, kind: str) -> None:
    """The two commands of the README, and the same with source archives."""
    options = ["--no-index", "--no-build-isolation", "--quiet", "--disable-pip-version-check", "--target", tmp_path]
    completed = run("pip", "install", *options, "--find-links", handed_over / kind, "lika-encoders")
    assert completed.returncode == 0, completed.stderr
    path = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); "
    program = path + "import lika_encoders; print(lika_encoders.lookup('AMM5A21/65KSC1').decode(0xF4243D3).position)"
    command = [sys.executable, "-I", "-S", "-c", program]
    completed = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert (completed.stdout, completed.stderr) == ("1000003\n", "")


@pytest.mark.slow
def test_no_metadata_names_a_folder_of_the_builder(handed_over: Path) -> None:
    wheels = sorted((handed_over / "wheels").iterdir())
    assert [wheel.name.partition("-")[0] for wheel in wheels] == ["codewheel_runtime", "lika_encoders"]
    for wheel in wheels:
        with zipfile.ZipFile(wheel) as archive:
            for name in archive.namelist():
                if ".dist-info/" in name:
                    text = archive.read(name)
                    assert b"file:" not in text
                    assert str(handed_over).encode() not in text


@pytest.mark.slow
def test_a_wheel_has_no_modules_of_earlier_builds(handed_over: Path) -> None:
    """The folder ``build`` keeps them if a package is generated again without one of its families."""
    for wheel in (handed_over / "wheels").iterdir():
        with zipfile.ZipFile(wheel) as archive:
            assert not [name for name in archive.namelist() if name.endswith("/removed.py")]


@pytest.mark.slow
@pytest.mark.parametrize("version", mostly_exhaustive(["1.0.0", "1.1.0", "0.9.0", "2.0.0"], "1.0.0", "2.0.0"))
def test_pip_refuses_a_runtime_that_does_not_fit(release: Path, tmp_path: Path, version: str) -> None:
    (name,) = (path.name for path in release.glob("codewheel_runtime-*.whl"))
    other_wheel = tmp_path / name.replace("1.0.0", version)
    with zipfile.ZipFile(release / name) as old, zipfile.ZipFile(other_wheel, "w") as new:
        for path in old.namelist():
            text = old.read(path).replace(b"Version: 1.0.0", f"Version: {version}".encode())
            new.writestr(path.replace("1.0.0", version), text)
    place = ["install", "--quiet", "--no-index", "--target", tmp_path / "there", "--disable-pip-version-check"]
    completed = run("pip", *place, next(release.glob("lika_encoders-*.whl")), other_wheel)
    assert (completed.returncode == 0) == version.startswith("1."), completed.stderr
    assert completed.returncode == 0 or "have conflicting dependencies" in completed.stderr


@pytest.mark.slow
def test_the_wheel_names_its_licence(source: Path, release: Path) -> None:
    wheel = zipfile.ZipFile(next(release.glob("lika_encoders-*.whl")))
    metadata = metadata_of(wheel)
    assert (metadata["License-Expression"], metadata["License-File"]) == ("0BSD", "LICENSE")
    assert any(name.endswith("/LICENSE") for name in wheel.namelist())
    assert metadata["Requires-Python"] == ">=3.10"
    assert set(metadata.get_all("Provides-Extra", [])) >= {"many", "arrow", "pandas", "parquet"}
    classifiers = metadata.get_all("Classifier", [])
    assert {"Typing :: Typed", "Programming Language :: Python :: 3", "Intended Audience :: Developers"} <= {
        *classifiers
    }
    # A licence classifier next to the expression is refused by the index.
    assert not [classifier for classifier in classifiers if classifier.startswith("License")]
    version = re.search(
        r'^__version__: Final = "(.+)"$', (source / "lika_encoders/__init__.py").read_text(), re.MULTILINE
    )
    assert version is not None
    assert metadata["Version"] == version[1]
    modules = {path.name for path in (source / "lika_encoders").iterdir() if path.is_file()}
    assert modules <= {Path(name).name for name in wheel.namelist()}
    assert "py.typed" in modules


def test_both_licences_are_spdx_words(source: Path) -> None:
    """Builds with a table fail from 2027 on. The expression needs setuptools 77."""
    root = Path(__file__).resolve().parents[2]
    for folder, licence in ((source, "0BSD"), (root, "MIT")):
        text = (folder / "pyproject.toml").read_text(encoding="utf-8")
        assert f'license = "{licence}"\nlicense-files = ["LICENSE"]\n' in text
        assert 'requires = ["setuptools>=77"]' in text
        assert (folder / "LICENSE").is_file()
