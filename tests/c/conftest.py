"""What the tests of the C target share: headers written once, and a program over each of them that answers line by line."""

from __future__ import annotations

from pathlib import Path

import pytest
from c_harness import SPECS, Run, compile_c, devices_of, runner, source, write
from codewheel.model import Device


@pytest.fixture(scope="session")
def c_devices() -> tuple[Device, ...]:
    return devices_of()


@pytest.fixture(scope="session")
def include(c_devices: tuple[Device, ...], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("headers"), c_devices)


@pytest.fixture(scope="session")
def amm5(c_devices: tuple[Device, ...]) -> Device:
    return next(device for device in c_devices if device.name == "amm5")


@pytest.fixture(scope="session")
def bits22() -> Device:
    return devices_of(SPECS / "bits22.yaml")[0]


@pytest.fixture(scope="session")
def words() -> Device:
    return devices_of(Path(__file__).parent / "specs" / "words.yaml")[0]


def made(device: Device, factory: pytest.TempPathFactory) -> Run:
    """The program over the header of a device, undefined behaviour watched."""
    folder = factory.mktemp(device.name)
    command = ["gcc", "-std=c99", "-O1", "-fsanitize=undefined,address", "-fno-sanitize-recover=all"]
    return runner(compile_c(command, source(device), folder, write(folder, (device,))))


@pytest.fixture(scope="session")
def run(amm5: Device, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return made(amm5, tmp_path_factory)


@pytest.fixture(scope="session")
def run_bits22(bits22: Device, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return made(bits22, tmp_path_factory)


@pytest.fixture(scope="session")
def run_words(words: Device, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return made(words, tmp_path_factory)


@pytest.fixture(params=["amm5", "bits22", "words"])
def machine(request: pytest.FixtureRequest) -> tuple[Device, Run]:
    """Each device with its program."""
    name = request.param
    return request.getfixturevalue(name), request.getfixturevalue("run" if name == "amm5" else f"run_{name}")
