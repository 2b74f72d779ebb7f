"""What the tests of the C target share: headers written once, and a program over each of them that answers line by line."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from c_harness import FAMILIES, SPECS, Run, compile_c, devices_of, runner, source, write
from codewheel.model import Device

#: The families of the library, and specs that use what none of them does.
MADE_UP = ("bits22", "tv62", "words")


@pytest.fixture(scope="session")
def c_devices() -> tuple[Device, ...]:
    return devices_of()


@pytest.fixture(scope="session")
def include(c_devices: tuple[Device, ...], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("headers"), c_devices)


@pytest.fixture(scope="session")
def every_device(c_devices: tuple[Device, ...]) -> Mapping[str, Device]:
    here = Path(__file__).resolve().parent
    made_up = (SPECS / "bits22.yaml", here.parents[1] / "docs" / "example", here / "specs" / "words.yaml")
    return {device.name: device for device in (*c_devices, *(device for path in made_up for device in devices_of(path)))}


@pytest.fixture(scope="session")
def programs(every_device: Mapping[str, Device], tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, Run]:
    """The program over the header of each device, undefined behaviour watched."""
    command = ["gcc", "-std=c99", "-O1", "-fsanitize=undefined,address", "-fno-sanitize-recover=all"]
    folders = {name: tmp_path_factory.mktemp(name) for name in every_device}

    def made(name: str) -> Run:
        device = every_device[name]
        return runner(compile_c(command, source(device), folders[name], write(folders[name], (device,))))

    with ThreadPoolExecutor() as pool:
        return dict(zip(every_device, pool.map(made, every_device)))


@pytest.fixture(scope="session")
def amm5(every_device: Mapping[str, Device]) -> Device:
    return every_device["amm5"]


@pytest.fixture(scope="session")
def bits22(every_device: Mapping[str, Device]) -> Device:
    return every_device["bits22"]


@pytest.fixture(scope="session")
def words(every_device: Mapping[str, Device]) -> Device:
    return every_device["words"]


@pytest.fixture(scope="session")
def run(programs: Mapping[str, Run]) -> Run:
    return programs["amm5"]


@pytest.fixture(scope="session")
def run_bits22(programs: Mapping[str, Run]) -> Run:
    return programs["bits22"]


@pytest.fixture(scope="session")
def run_words(programs: Mapping[str, Run]) -> Run:
    return programs["words"]


@pytest.fixture(params=[*FAMILIES, *MADE_UP])
def machine(request: pytest.FixtureRequest, every_device: Mapping[str, Device], programs: Mapping[str, Run]) -> tuple[Device, Run]:
    """Each device with its program."""
    return every_device[request.param], programs[request.param]


@pytest.fixture(params=FAMILIES)
def family(request: pytest.FixtureRequest, every_device: Mapping[str, Device], programs: Mapping[str, Run]) -> tuple[Device, Run]:
    """Each family of the library with its program."""
    return every_device[request.param], programs[request.param]
