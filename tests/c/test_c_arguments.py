"""Arguments of procedures in every way that a step can write them, and other cases of the made-up encoder."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest
from c_harness import MadeOnce, Run, compile_programs, devices_of, program_over, write
from codewheel.model import Device, Procedure, Variant
from codewheel.reference.codec import EncodeError
from codewheel.reference.registers import register_writes
from exhaustive import mostly_exhaustive
from test_c_families import steps_text
from working_tools import require

SPEC = Path(__file__).parent / "specs" / "arguments.yaml"

#: Values around the limits of each argument. One argument changes at a time, and the others have the first value.
VALUES: Mapping[str, tuple[int, ...]] = {
    "control": (0, 60000, 60001, 0x1234),
    "kind": (1, 2, 0, 3, 255),
    "both": (0, 100000, 100001, 0x12345),
    "target": (3, 2, 500, 501),
    "goal": (0, 511, 512, 8191, 8192),
    "mode": (6, 1, 0, 2, 7, 15, 16),
    "speed": (0, 1023, 1024, 0x2A5),
    "span": (300, 1, 200, 201, 2000, 4000, 4001),
    "inside": (200, 0, 299, 300, 999, 1000),
    "level": (7, 6, 900, 901, 0xFFF, 0x1000),
}


@pytest.fixture(scope="module")
def arguments() -> Device:
    (device,) = devices_of(SPEC)
    return device


@pytest.fixture(scope="module")
def run_arguments(arguments: Device, made_once: MadeOnce) -> Run:
    return program_over(arguments, made_once, "arguments")


COMPILERS = [["clang", "-std=c99"], ["g++", "-x", "c++", "-std=c++11"]]


@pytest.mark.slow
@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS, COMPILERS[0]), ids=" ".join)
def test_no_warning(command: list[str], arguments: Device, tmp_path: Path) -> None:
    """There is none even if an encoder is identified by a byte called ``variant_id``."""
    require(command)
    compile_programs(command, arguments, tmp_path, write(tmp_path, (arguments,)), link=False)


@pytest.mark.parametrize("code", ["ZASC", "ZBSC"])
@pytest.mark.parametrize("name", ["whole", "parts", "teach", "look"])
def test_arguments_are_written_and_refused_as_by_the_model(
    name: str, code: str, arguments: Device, run_arguments: Run
) -> None:
    procedure, variant = arguments.procedure(name), arguments.variant(code)
    argument_names = [argument.name for argument in procedure.arguments]
    first_values = {name: VALUES[name][0] for name in argument_names}
    argument_sets = [first_values]
    for argument_name in argument_names:
        argument_sets += [{**first_values, argument_name: value} for value in VALUES[argument_name][1:]]
    program_input = [f"{code} steps {name}{_in_hex(values, argument_names)}" for values in argument_sets]
    expected_steps = [steps_text(arguments, procedure, variant, values) for values in argument_sets]
    assert run_arguments(program_input) == expected_steps
    if argument_names:
        result_codes = [line.split(" ")[0] for line in run_arguments(program_input)]
        assert "0" in result_codes
        assert "4" in result_codes


def _in_hex(values: Mapping[str, int], names: list[str]) -> str:
    return "".join(f" {values[name]:X}" for name in names)


def test_a_named_value_and_limits_hold_for_one_field_as_well(arguments: Device) -> None:
    procedure, variant = arguments.procedure("parts"), arguments.variant("ZASC")
    for outside in ({"mode": 2}, {"level": 6}, {"level": 901}):
        assert refused(arguments, procedure, variant, {"mode": 6, "speed": 0, "level": 7} | outside)
    assert not refused(arguments, procedure, variant, {"mode": 6, "speed": 0, "level": 7})


def refused(device: Device, procedure: Procedure, variant: Variant, values: Mapping[str, int]) -> bool:
    try:
        register_writes(device, procedure, variant, values)
    except EncodeError:
        return True
    return False


def test_a_frame_without_a_selector_is_what_no_other_frame_is(run_arguments: Run) -> None:
    assert run_arguments(f"ZAJP select reply {data}" for data in ("010203", "020304", "0102", "FF", "")) == [
        "0 0 3",
        "0 1 3",
        "0 0 3",
        "0 1 3",
        "1 0 0",
    ]
