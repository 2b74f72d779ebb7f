"""Crates for Rust and the model's own codec agree on a hundred thousand frames of each layout. Clippy finds nothing.

``CODEWHEEL_FRAMES`` lowers the number. Registers are read from a tenth as many contents.
"""

from __future__ import annotations

import re
import subprocess
import warnings
from pathlib import Path

import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library
from rust_frames import decoding
from rust_harness import CRATES, LIBRARY, ROOT, SPECS, Workshop, rust_tool, write
from tree import number_from_environment

FRAMES = min(number_from_environment("CODEWHEEL_FRAMES", 100_000), 100_000)
CONTENTS = FRAMES // 10
#: Versions of clippy whose findings are errors: the version of Debian 12, and a current version. Findings of others are
#: warnings.
STRICT = ("0.1.63", "0.1.95")


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    return Workshop(tmp_path_factory.mktemp("rust"), "-O")


def layouts() -> list[tuple[str, int]]:
    """Return the number of each layout of each family. Registers have none."""
    devices = ((spec, load_library([ROOT / spec])[0][0]) for spec in SPECS)
    return [(spec, index) for spec, device in devices for index, _ in enumerate(device.layouts())]


@pytest.mark.parametrize(("spec", "index"), layouts())
def test_frames(spec: str, index: int, workshop: Workshop) -> None:
    assert "ok" in decoding(workshop.program(spec), index, FRAMES)


@pytest.mark.parametrize("spec", SPECS)
def test_registers(spec: str, workshop: Workshop) -> None:
    program = workshop.program(spec)
    for index in range(len(program.family.frames), len(program.structs)):
        assert "ok" in decoding(program, index, CONTENTS)


@pytest.mark.parametrize("specs", CRATES)
def test_clippy_finds_nothing(specs: str, tmp_path: Path) -> None:
    devices, _ = load_library([ROOT / specs])
    clippy(write(devices, tmp_path), tmp_path)


def test_clippy_finds_nothing_in_hostile_texts(hostile: Library, tmp_path: Path) -> None:
    clippy(write(hostile.by_manufacturer()[0][1], tmp_path), tmp_path)


def clippy(main: Path, folder: Path) -> None:
    """Fail on findings of a strict version, and warn about findings of any other."""
    driver = rust_tool("clippy-driver")
    sysroot = _output_of(str(Path(driver).with_name("rustc")), "--print", "sysroot")[0].strip()
    options = ("--sysroot", sysroot, "--edition", "2021", "--emit", "metadata", "--out-dir", str(folder))
    _, messages = _output_of(driver, *LIBRARY, *options, str(main))
    version = re.search(r"\d+\.\d+\.\d+", _output_of(driver, "--version")[0])
    if version is not None and version[0] in STRICT:
        assert not messages, messages[:4000]
    elif messages:
        warnings.warn(f"clippy {version and version[0]} finds in {main}:\n{messages[:4000]}", stacklevel=2)


def _output_of(*command: str) -> tuple[str, str]:
    completed = subprocess.run(command, capture_output=True, text=True, check=False)
    return completed.stdout, completed.stderr
