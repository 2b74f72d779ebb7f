"""Each rule that looks at the model has a spec that breaks it, and the exact message in its first lines."""

from __future__ import annotations

from pathlib import Path

import pytest

from codewheel.load import load_library
from codewheel.order_codes import find
from codewheel.targets import BUILT_IN, Library, target

FOLDER = Path(__file__).parent / "broken_model"


@pytest.mark.parametrize("name", sorted(path.name for path in FOLDER.glob("*.yaml") if path.name != "manufacturer.yaml"))
def test_broken(name: str) -> None:
    path = FOLDER / name
    expected = [line.removeprefix("# expect: ") for line in path.read_text().splitlines() if line.startswith("# expect: ")]
    _, report = load_library([path])
    assert [f"{item.line}:{item.column}: {item.rule}: {item.message}" for item in report.problems] == expected
    assert expected
    assert all("Traceback" not in item.format() and max(map(len, item.format().splitlines()[1:])) <= 80 for item in report.problems)


SOUND = Path(__file__).parent / "ok_model"


def test_sound_specs_have_no_problem_and_yield_every_output() -> None:
    devices, report = load_library([SOUND])
    assert report.problems == ()
    assert {device.name for device in devices} == {path.stem for path in SOUND.glob("*.yaml")} - {"manufacturer"}
    for name in BUILT_IN:
        assert target(name)(Library(devices))


@pytest.mark.parametrize(
    ("label", "code", "bits"),
    [("B34/60/SC", "B34/60/SC", 12), ("b34/sc/S123", "B34/SC", 13), ("B34/6/S2-0010", "B34/6/S2", 14), ("B34/S2", "B34/S2", 13)],
)
def test_a_value_of_an_order_code_may_have_a_slash(label: str, code: str, bits: int) -> None:
    devices, _ = load_library([SOUND / "slashed.yaml"])
    found = find(devices[0], label)
    assert (found.variant.code, found.variant.parameters["position_bits"]) == (code, bits)
