"""What the tests of the C target share: the generated tree, compilers, and a program that runs the headers line by line."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterable
from pathlib import Path

import pytest
from c_harness import source
from codewheel.load import load_library
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c import generate

WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wcast-qual -Wshadow -Werror".split()
SPECS = Path(__file__).parents[1] / "specs"

#: Runs lines through the program and gives one answer for each.
Run = Callable[[Iterable[str]], list[str]]


def devices_of(*paths: Path) -> tuple[Device, ...]:
    devices, report = load_library(paths)
    assert not len(report)
    return devices


def write(folder: Path, devices: tuple[Device, ...]) -> Path:
    """Writes the C tree of these devices; gives the folder to include from."""
    for name, text in generate(Library(devices)).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder / "c" / "include"


def compile_c(command: list[str], code: str, folder: Path, include: Path, stem: str = "program", link: bool = True) -> Path:
    """Compiles a text with all warnings as errors, and links it."""
    text, program = folder / f"{stem}.c", folder / stem
    text.write_text(code, encoding="utf-8")
    options = ["-o", str(program)] if link else ["-c", "-o", f"{program}.o"]
    done = subprocess.run([*command, *WARNINGS, f"-I{include}", str(text), *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:4000]
    return program


def runner(program: Path) -> Run:
    def run(lines: Iterable[str]) -> list[str]:
        text = "".join(f"{line}\n" for line in lines)
        done = subprocess.run([str(program)], input=text, capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stderr
        return done.stdout.splitlines()

    return run


@pytest.fixture(scope="session")
def devices() -> tuple[Device, ...]:
    return devices_of()


@pytest.fixture(scope="session")
def include(devices: tuple[Device, ...], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("generated"), devices)


@pytest.fixture(scope="session")
def amm5(devices: tuple[Device, ...]) -> Device:
    return next(device for device in devices if device.name == "amm5")


@pytest.fixture(scope="session")
def run(amm5: Device, include: Path, tmp_path_factory: pytest.TempPathFactory) -> Run:
    """The program over AMM5's header."""
    command = ["gcc", "-std=c99", "-O2"]
    return runner(compile_c(command, source(amm5), tmp_path_factory.mktemp("harness"), include))


@pytest.fixture(scope="session")
def bits22() -> Device:
    return devices_of(SPECS / "bits22.yaml")[0]


@pytest.fixture(scope="session")
def run_bits22(bits22: Device, tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("bits22")
    return runner(compile_c(["gcc", "-std=c99", "-O2"], source(bits22), folder, write(folder, (bits22,))))
