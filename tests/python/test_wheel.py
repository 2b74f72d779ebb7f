"""The generated package as it is built and installed: its licence is in the metadata, and the file is in the wheel."""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile
from collections.abc import Mapping
from email import message_from_bytes
from pathlib import Path

import pytest


@pytest.fixture(scope="module")
def source(files: Mapping[str, str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("source")
    for path, text in files.items():
        place = folder / path
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, encoding="utf-8")
    return folder / "python"


@pytest.mark.slow
def test_the_wheel_names_its_licence(source: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(tmp_path), str(source)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    wheel = zipfile.ZipFile(next(tmp_path.glob("lika_encoders-*.whl")))
    metadata = message_from_bytes(next(wheel.read(name) for name in wheel.namelist() if name.endswith("/METADATA")))
    assert (metadata["License-Expression"], metadata["License-File"]) == ("0BSD", "LICENSE")
    # Nothing is needed: what is listed is for those who ask for an extra.
    assert all("extra ==" in needed for needed in metadata.get_all("Requires-Dist", []))
    assert any(name.endswith("/LICENSE") for name in wheel.namelist())
    assert metadata["Requires-Python"] == ">=3.10"
    assert set(metadata.get_all("Provides-Extra", [])) >= {"many", "arrow", "pandas", "parquet"}
    classifiers = metadata.get_all("Classifier", [])
    assert {"Typing :: Typed", "Programming Language :: Python :: 3", "Intended Audience :: Developers"} <= {
        *classifiers
    }
    # One of a licence beside the expression is refused by the index.
    assert not [item for item in classifiers if item.startswith("License")]
    version = re.search(
        r'^__version__: Final = "(.+)"$', (source / "lika_encoders/__init__.py").read_text(), re.MULTILINE
    )
    assert version is not None
    assert metadata["Version"] == version[1]
    modules = {path.name for path in (source / "lika_encoders").iterdir() if path.is_file()}
    assert modules <= {Path(name).name for name in wheel.namelist()}
    assert "py.typed" in modules


def test_both_licences_are_spdx_words(source: Path) -> None:
    """A table stops to build in 2027; the word needs setuptools 77."""
    root = Path(__file__).resolve().parents[2]
    for folder, licence in ((source, "0BSD"), (root, "MIT")):
        text = (folder / "pyproject.toml").read_text(encoding="utf-8")
        assert f'license = "{licence}"\nlicense-files = ["LICENSE"]\n' in text
        assert 'requires = ["setuptools>=77"]' in text
        assert (folder / "LICENSE").is_file()
