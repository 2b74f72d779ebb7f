"""Fixtures of the tests of the C target: headers written once, and a program for each, which answers line by line."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import pytest
from c_harness import (
    FAMILIES,
    MADE_UP,
    SPECS,
    MadeOnce,
    Run,
    devices_of,
    program_over,
    write,
)
from codewheel.model import Device
from exhaustive import mostly_exhaustive
from transport_harness import Machine, compile_machine, machine_of


@pytest.fixture(scope="session")
def c_devices() -> tuple[Device, ...]:
    return devices_of()


@pytest.fixture(scope="session")
def include(c_devices: tuple[Device, ...], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("headers"), c_devices)


@pytest.fixture(scope="session")
def every_device(c_devices: tuple[Device, ...]) -> Mapping[str, Device]:
    made_up = (device for path in MADE_UP.values() for device in devices_of(path))
    return {device.name: device for device in (*c_devices, *made_up)}


class Programs(dict[str, Run]):
    """The program for the header of each device, compiled when first used, with checks for undefined behaviour."""

    def __init__(self, devices: Mapping[str, Device], made_once: MadeOnce) -> None:
        super().__init__()
        self._devices, self._made_once = devices, made_once

    def __missing__(self, name: str) -> Run:
        self[name] = program_over(self._devices[name], self._made_once, f"program_{name}")
        return self[name]


@pytest.fixture(scope="session")
def programs(every_device: Mapping[str, Device], made_once: MadeOnce) -> Mapping[str, Run]:
    return Programs(every_device, made_once)


def _machines(every_device: Mapping[str, Device], made_once: MadeOnce, stepped: bool) -> Callable[[str], Machine]:
    (words,) = devices_of(SPECS / "words.yaml")

    @cache
    def machine_of_family(name: str) -> Machine:
        device = words if name == "words" else every_device[name]
        folder = made_once(
            f"{'stepped' if stepped else 'machine'}_{name}", lambda place: compile_machine(device, place, stepped)
        )
        return machine_of(device, folder, stepped)

    return machine_of_family


@pytest.fixture(scope="session")
def machines(every_device: Mapping[str, Device], made_once: MadeOnce) -> Callable[[str], Machine]:
    """The functions of a family that take a transport, by its name. ``words`` is the spec in ``tests/specs``."""
    return _machines(every_device, made_once, stepped=False)


@pytest.fixture(scope="session")
def stepped_machines(every_device: Mapping[str, Device], made_once: MadeOnce) -> Callable[[str], Machine]:
    """The same functions, with procedures carried out by the runner in a main loop."""
    return _machines(every_device, made_once, stepped=True)


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


@pytest.fixture(params=mostly_exhaustive([*FAMILIES, *MADE_UP], "amm5", "long_crc", "shapes", "words"))
def machine(
    request: pytest.FixtureRequest, every_device: Mapping[str, Device], programs: Mapping[str, Run]
) -> tuple[Device, Run]:
    """Each device with its program."""
    return every_device[request.param], programs[request.param]


@pytest.fixture(params=mostly_exhaustive(FAMILIES, "amm5"))
def family(
    request: pytest.FixtureRequest, every_device: Mapping[str, Device], programs: Mapping[str, Run]
) -> tuple[Device, Run]:
    """Each family of the library with its program."""
    return every_device[request.param], programs[request.param]
