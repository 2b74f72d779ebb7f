"""A hundred thousand frames of each layout, sound and disturbed: crates for Rust and the model's own codec agree."""

from __future__ import annotations

import pytest
from codewheel.build.load import load_library
from rust_frames import decoding
from rust_harness import ROOT, SPECS, Workshop

FRAMES, CONTENTS = 100_000, 10_000


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    return Workshop(tmp_path_factory.mktemp("rust"), "-O")


def layouts() -> list[tuple[str, int]]:
    """The number of each layout of each family; registers have none."""
    found = ((spec, load_library([ROOT / spec])[0][0]) for spec in SPECS)
    return [(spec, index) for spec, device in found for index, _ in enumerate(device.layouts())]


@pytest.mark.parametrize(("spec", "index"), layouts())
def test_frames(spec: str, index: int, workshop: Workshop) -> None:
    assert "ok" in decoding(workshop.program(spec), index, FRAMES)


@pytest.mark.parametrize("spec", SPECS)
def test_registers(spec: str, workshop: Workshop) -> None:
    program = workshop.program(spec)
    for index in range(len(program.family.frames), len(program.structs)):
        assert "ok" in decoding(program, index, CONTENTS)
