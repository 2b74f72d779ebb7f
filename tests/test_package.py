"""The installed tool: every file is in the wheel, and the command works from any folder."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import venv
import zipfile
from collections.abc import Callable
from email import message_from_bytes
from pathlib import Path

import pytest
from codewheel.loading.configuration_file import read_configuration

ROOT = Path(__file__).parents[1]


def run(*command: str | Path, cwd: Path, **environment: str) -> str:
    completed = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **environment},
        timeout=300,
    )
    assert completed.returncode == 0, completed.stdout + completed.stderr
    return completed.stdout


@pytest.fixture(scope="session")
def wheel(made_once: Callable[[str, Callable[[Path], object]], Path]) -> Path:
    return next(made_once("wheel", built).glob("codewheel-*.whl"))


def built(folder: Path) -> None:
    """A wheel from a copy, so that the checkout is unchanged."""
    source = folder / "source"
    tracked = run("git", "ls-files", "--cached", "--others", "--exclude-standard", "-z", cwd=ROOT).split("\0")
    for name in filter(None, tracked):
        if not name.startswith(("tests/", "generated/")) and (ROOT / name).is_file():
            place = source / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes((ROOT / name).read_bytes())
    run(sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", folder, source, cwd=folder)


def test_the_wheel_has_metadata(wheel: Path) -> None:
    archive = zipfile.ZipFile(wheel)
    metadata = message_from_bytes(next(archive.read(name) for name in archive.namelist() if name.endswith("/METADATA")))
    assert (metadata["License-Expression"], metadata["Requires-Python"]) == ("MIT", ">=3.10")
    assert {"BiSS", "SSI"} <= set(metadata["Keywords"].split(","))
    classifiers = metadata.get_all("Classifier", [])
    assert "Typing :: Typed" in classifiers
    # A licence classifier beside the expression is refused by the index, and there is no address to give yet.
    assert not [classifier for classifier in classifiers if classifier.startswith("License")]
    assert not [key for key in ("Author-email", "Home-page", "Project-URL") if metadata[key]]


def test_the_wheel_holds_every_file_of_the_package(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    for folder, inside in (
        ("generator", "codewheel"),
        ("runtime", "codewheel/runtime"),
        ("templates", "codewheel/templates"),
        ("specs", "codewheel/specs"),
    ):
        for path in (ROOT / folder).rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts and ".egg-info" not in str(path):
                assert f"{inside}/{path.relative_to(ROOT / folder).as_posix()}" in names


def copy_family_filters(folder: Path) -> None:
    """Write settings with the conditions of this repository for the families of each output."""
    settings = read_configuration(ROOT / "pyproject.toml")
    assert settings is not None
    conditions = {}
    for target, condition in settings.only.items():
        texts = {"families": list(condition.families), "grades": list(condition.grades)}
        conditions[target] = {key: values for key, values in texts.items() if values}
    (folder / "codewheel.yaml").write_text(json.dumps({"only": conditions}), encoding="utf-8")


@pytest.mark.exhaustive
def test_the_installed_tool_works_in_an_empty_folder(wheel: Path, tmp_path: Path) -> None:
    """With only the wheel and its dependencies, and in a folder whose name has a space."""
    place = tmp_path / "an empty folder"
    place.mkdir()
    venv.create(place / "venv")
    python = str(place / "venv" / "bin" / "python")
    pip = [sys.executable, "-m", "pip", "--python", python, "--disable-pip-version-check"]
    run(*pip, "install", "--quiet", wheel, cwd=place)
    tool = place / "venv" / "bin" / "codewheel"
    copy_family_filters(place)
    makers = sorted(path.parent.name for path in (ROOT / "specs").glob("*/manufacturer.yaml"))
    packaged = [argument for maker in makers for argument in ("--packaged", maker)]
    out = run(tool, "generate", *packaged, cwd=place, PYTHONHASHSEED="1")
    assert "written    generated/biss/idbiss4C69.xml" in out
    out = run(tool, "list", cwd=place)
    assert "amm5" in out
    paths = {path.relative_to(place) for path in (place / "generated").rglob("*") if path.is_file()}
    for path in paths:
        assert (place / path).read_bytes() == (ROOT / path).read_bytes(), path
    tracked = run("git", "ls-files", "--cached", "--others", "--exclude-standard", "generated", cwd=ROOT)
    assert {Path(name) for name in tracked.splitlines()} == paths, "what is no output lies in generated/"


@pytest.mark.slow
def test_generated_is_what_the_specs_yield() -> None:
    completed = subprocess.run(
        [sys.executable, "-m", "codewheel", "generate", "--check"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert completed.returncode == 0, completed.stdout + completed.stderr + "\nrun: make generate"


@pytest.mark.slow
def test_a_clone_that_converts_line_ends_leaves_them(tmp_path: Path) -> None:
    """As git for Windows does by default. generate --check compares bytes."""
    run("git", "clone", "--quiet", "--shared", "--config", "core.autocrlf=true", ROOT, tmp_path / "clone", cwd=tmp_path)
    folders = [tmp_path / "clone" / name for name in ("generated", "runtime", "specs", "templates")]
    paths = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    assert len(paths) > 100
    assert [path for path in paths if b"\r\n" in path.read_bytes()] == []


@pytest.mark.exhaustive
def test_other_folder_and_hash_seed_same_bytes(tmp_path: Path) -> None:
    for seed in ("0", "12345"):
        run(
            sys.executable,
            "-m",
            "codewheel",
            "generate",
            ROOT / "specs" / "lika",
            "-o",
            tmp_path / seed,
            cwd=tmp_path,
            PYTHONHASHSEED=seed,
            LC_ALL="C",
            TZ=f"UTC+{len(seed)}",
        )
    files = [path.relative_to(tmp_path / "0") for path in (tmp_path / "0").rglob("*") if path.is_file()]
    assert files
    for name in files:
        assert (tmp_path / "0" / name).read_bytes() == (tmp_path / "12345" / name).read_bytes(), name


def test_no_family_is_named_in_the_generator_the_runtime_or_a_template() -> None:
    names = [path.stem for path in (ROOT / "specs").glob("*/*.yaml") if path.stem != "manufacturer"]
    assert "amm5" in names
    for folder in ("generator", "runtime", "templates"):
        for path in (ROOT / folder).rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                # A public test vector cites its source, which is the firmware of a master.
                text = path.read_text(encoding="utf-8", errors="replace").lower().replace("mjbots/moteus: fw/test", "")
                assert not [name for name in names if name in text], path


def test_every_folder_of_generated_files_has_the_licence() -> None:
    texts = {folder.name: (folder / "LICENSE").read_text(encoding="utf-8") for folder in (ROOT / "generated").iterdir()}
    assert set(texts) >= {"biss", "browser", "c", "docs", "python"}
    assert len(set(texts.values())) == 1
    assert texts["c"].startswith("Zero-Clause BSD (0BSD)\n")
