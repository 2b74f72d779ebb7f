"""Each rule about the model has a spec that breaks it, which begins with the exact message."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.outputs import load_for_targets, targets_named
from codewheel.language.files import packaged_specs
from codewheel.order_codes.labels import find_code
from codewheel.targets import Library

FOLDER = Path(__file__).parent / "broken_model"


#: Specs of several hundred parts, which take as long as a hundred others.
LONG_SPECS = ("too_many_places.yaml", "too_many_sets.yaml")
NAMES = sorted(path.name for path in FOLDER.glob("*.yaml") if path.name != "manufacturer.yaml")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in LONG_SPECS else name for name in NAMES]
)
def test_broken(name: str) -> None:
    path = FOLDER / name
    lines = path.read_text().splitlines()
    expected = [line.removeprefix("# expect: ") for line in lines if line.startswith("# expect: ")]
    _, report = load_for_targets([path], targets_named())
    reported = [f"{problem.line}:{problem.column}: {problem.rule}: {problem.message}" for problem in report.problems]
    assert reported == expected
    assert expected
    for problem in report.problems:
        text = problem.format()
        assert "Traceback" not in text
        assert max(map(len, text.splitlines()[1:])) <= 80


@pytest.mark.slow
def test_a_wrong_start_value_is_named_if_every_example_fits_another(tmp_path: Path) -> None:
    """The examples are from the manual of the AMM5 and from public sources. All of them need the start value 0."""
    spec = packaged_specs() / "lika" / "amm5.yaml"
    text = spec.read_text(encoding="utf-8")
    crc = text[text.index("name: rs485_8") :]
    (tmp_path / "amm5.yaml").write_text(text.replace(crc, crc.replace("init: 0", "init: 0x15", 1)), encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_bytes(spec.with_name("manufacturer.yaml").read_bytes())
    _, report = load_for_targets([tmp_path], targets_named())
    messages = [problem.message for problem in report.problems if problem.rule == "example-contradicts"]
    assert len(messages) > 5
    hint = "; with 'init: 0x0' in the CRC 'rs485_8', every example matches"
    assert all(message.endswith(hint) for message in messages)
    combined_problems = [problem for problem in report.by_cause if problem.rule == "example-contradicts"]
    assert len(combined_problems) == 1


@pytest.mark.slow
def test_a_procedure_may_write_a_register_that_has_problems(tmp_path: Path) -> None:
    """A register with a single meaning is refused. The limits in the procedures that write it are then unknown."""
    spec = packaged_specs() / "lika" / "sma21.yaml"
    text = spec.read_text(encoding="utf-8")
    start = text.index("      - name: offset\n        when: configuration")
    end = text.index("        source: 6.4 p.32\n", start) + len("        source: 6.4 p.32\n")
    (tmp_path / "sma21.yaml").write_text(text[:start] + text[end:], encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_bytes(spec.with_name("manufacturer.yaml").read_bytes())
    _, report = load_for_targets([tmp_path], targets_named())
    assert any("meanings" in problem.path for problem in report.problems)


SOUND = Path(__file__).parent / "ok_model"


@pytest.mark.slow
def test_sound_specs_have_no_problem_and_yield_every_output() -> None:
    devices, report = load_for_targets([SOUND], targets_named())
    assert report.problems == ()
    assert {device.name for device in devices} == {path.stem for path in SOUND.glob("*.yaml")} - {"manufacturer"}
    for target in targets_named():
        assert target.files(Library(devices), {})


@pytest.mark.parametrize(
    ("label", "code", "bits"),
    [
        ("B34/60/SC", "B34/60/SC", 12),
        ("b34/sc/S123", "B34/SC", 13),
        ("B34/6/S2-0010", "B34/6/S2", 14),
        ("B34/S2", "B34/S2", 13),
    ],
)
def test_a_value_of_an_order_code_may_have_a_slash(label: str, code: str, bits: int) -> None:
    devices, _ = load_for_targets([SOUND / "slashed.yaml"], targets_named())
    match = find_code(devices[0], label)
    assert (match.variant.code, match.variant.parameters["position_bits"]) == (code, bits)


def test_a_limit_that_is_a_product_at_run_time_has_a_type_that_holds_it() -> None:
    """By default, it is 256 * 16 - 1. With both registers at their maximum, the product takes 33 bits."""
    devices, _ = load_for_targets([SOUND], targets_named())
    (device,) = (device for device in devices if device.name == "product_limit")
    (c_target,) = (target for target in targets_named() if target.name == "c")
    text = c_target.files(Library((device,)), {})["c/include/acme/product_limit_biss_registers.h"]
    assert "static inline uint64_t acme_product_limit_biss_reg_preset_max(" in text
