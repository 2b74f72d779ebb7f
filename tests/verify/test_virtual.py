"""Virtual encoders against the generated package: frames of each layout, and links with each fault, in virtual time.

The link gets 100,000 requests for each fault, and 10,000 requests for each encoder with its own requests.
``CODEWHEEL_FRAMES`` lowers all of these numbers.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from bench import codes_with
from codewheel.model import Flag, Layout, Unused, number_to_bytes
from codewheel.targets import Library
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.simulation_options import FAULTS
from tree import library as by_name
from tree import number_from_environment

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "virtual"))

import test_exchanges as exchanges
import test_link_faults as shorter
from test_exchanges import modules, outputs  # noqa: F401

Package = tuple[Path, ModuleType]
FRAMES = number_from_environment("CODEWHEEL_FRAMES", 1_000_000)
REQUESTS = min(FRAMES, 100_000)


def layouts_of_encoders() -> Iterator[tuple[str, str, str]]:
    """Yield family, interface and name of each layout that an encoder sends."""
    for device in by_name().values():
        for interface, layout in device.layouts():
            if layout.sender == "encoder" and not device.base:
                yield device.name, interface.name, layout.name


@pytest.mark.parametrize("fault", FAULTS)
def test_no_fault_makes_a_position_wrong(generated_python: Package, library: Library, fault: str) -> None:
    """Half of the requests without retries and many faults, half with retries and few."""
    codes = codes_with(library.devices, "rs485")
    outcomes, injected = shorter.count_outcomes(generated_python[1], codes, fault, 0.2, REQUESTS // 2, 0)
    more, injected_too = shorter.count_outcomes(generated_python[1], codes, fault, 0.02, REQUESTS // 2, 3)
    assert outcomes["wrong"] == more["wrong"] == 0
    assert sum(outcomes.values()) + sum(more.values()) == REQUESTS
    assert set(outcomes) - {"right", "wrong"} <= set(shorter.ERRORS[fault])
    assert injected[fault] + injected_too[fault] > REQUESTS / 50
    # Four faults in a row, so that no retry is left, occur once in six million requests.
    assert more["right"] >= REQUESTS // 2 - 2 or fault in ("busy", "restart", "brownout", "second")


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("code", exchanges.ASK)
def test_exchanges_with_faults(modules: dict[str, Any], code: str, fault: str) -> None:  # noqa: F811
    exchanges.check_positions(modules[code], code, fault, REQUESTS // 10)


@pytest.mark.parametrize(("family", "interface", "name"), list(layouts_of_encoders()))
def test_the_package_decodes_what_a_virtual_encoder_sends(
    packages: Mapping[str, Any], library: Library, family: str, interface: str, name: str
) -> None:
    """Random positions, flags and order codes: every column has the value that was sent."""
    numpy = pytest.importorskip("numpy")
    package = packages[family]
    device = next(device for device in library.devices if device.name == family)
    codes = [variant.code for variant in device.variants if variant.interface == interface]
    module, chance = getattr(package, family), random.Random(name)
    for at, code in enumerate(codes):
        count = (at + 1) * FRAMES // len(codes) - at * FRAMES // len(codes)
        answers = {alternative.name: chance.choice(alternative.answers).name for alternative in device.alternatives}
        virtual = VirtualEncoder(code, choose=answers)
        layout = next(layout for layout in virtual.layouts("encoder") if layout.name == name)
        columns, frames = _random_frames(virtual, layout, count, chance)
        rows: Any = frames
        if layout.in_bytes:
            rows = numpy.frombuffer(b"".join(frames), dtype=numpy.uint8).reshape(count, -1)
        encoder = package.lookup(code)
        chosen = {name: getattr(getattr(module, _class_name(name)), value.upper()) for name, value in answers.items()}
        needed = {alternative.name: chosen[alternative.name] for alternative in device.alternatives_of(layout)}
        if layout.in_bytes:
            kind = getattr(module, _class_name(name))
            table = encoder.decode_many(rows, kind, **needed)
        else:
            table = encoder.decode_many(numpy.array(rows, dtype=numpy.uint64), **needed)
        assert not numpy.any(table["fault"])
        for key, values in columns.items():
            assert numpy.array_equal(table[key], numpy.array(values)), (code, key)


def _class_name(name: str) -> str:
    return "".join(part.title() for part in name.split("_"))


def _random_frames(
    virtual: VirtualEncoder, layout: Layout, count: int, chance: random.Random
) -> tuple[dict[str, list[int | bool]], list[Any]]:
    """Return the values that were sent, by column, and the frames."""
    placed = virtual.place(layout)
    flags = [field.name for field in placed.fields if isinstance(field.field.kind, Flag)]
    names = [field.name for field in placed.fields if field.name in virtual.position_names()]
    joined = [join.name for join in layout.joins]
    columns: dict[str, list[int | bool]] = {name: [] for name in (*names, *joined)}
    values: dict[str, int | str | bool] = {}
    data = [field for field in placed.fields if not isinstance(field.field.kind, (Flag, Unused))]
    of_request = [field for field in data if field.name in ("address", "data")]
    frames: list[Any] = []
    position, width = 0, placed.bits
    virtual.position = lambda _: position
    for _ in range(count):
        position = chance.getrandbits(63) % virtual.counts
        if layout.selector:
            values[layout.selector] = chance.choice(layout.selects)
        values |= {field.name: chance.getrandbits(field.width) for field in of_request}
        active = {flag for flag in flags if chance.random() < 0.1}
        values |= {flag: flag in active for flag in flags}
        number = virtual.frame(layout, values)
        frames.append(number_to_bytes(layout, number, width) if layout.in_bytes else number)
        for flag in flags:
            columns.setdefault(flag, []).append(flag in active)
        for field in of_request:
            columns.setdefault(field.name, []).append(int(values[field.name]))
        parts = virtual.parts_now()
        for name in names:
            columns[name].append(parts[name] & placed.field(name).mask)
        for name in joined:
            columns[name].append(position)
    return columns, frames
