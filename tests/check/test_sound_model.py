"""What a spec may well say: specs that a rule could wrongly refuse, or that were once built wrongly."""

from __future__ import annotations

from pathlib import Path

import pytest

from codewheel.load import load_library
from codewheel.model import Device
from codewheel.run_time import with_registers

HERE = Path(__file__).parent
#: A spec without a fault, to be changed in one place.
BASE = (HERE / "ok" / "minimal.yaml").read_text(encoding="utf-8")
MAKER = (HERE / "broken_model" / "manufacturer.yaml").read_text(encoding="utf-8")


def load(folder: Path, *changes: tuple[str, str], more: str = "") -> tuple[Device | None, list[str]]:
    """The device of the base spec with these changes, and the problems found in it."""
    text = BASE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (folder / "manufacturer.yaml").write_text(MAKER, encoding="utf-8")
    (folder / "minimal.yaml").write_text(text + more, encoding="utf-8")
    devices, report = load_library([folder])
    return (devices[0] if devices else None), [f"{item.rule}: {item.message}" for item in report.problems]


def sound(folder: Path, *changes: tuple[str, str], more: str = "") -> Device:
    device, problems = load(folder, *changes, more=more)
    assert problems == [] and device is not None
    return device


# -- fields of a width that a register holds

HELD = ("  position_bits: {meaning: Bits of the position}\n",
        "  position_bits: {meaning: Bits of the position}\n  zero_bits: {meaning: Zeros after it, read_from: setting.zero_bits, min: 0, max: 7}\n")  # fmt: skip
ZEROS = ("{name: position, bits: position_bits}\n", "{name: position, bits: position_bits}\n          - {name: zeros, bits: zero_bits, constant: 0}\n")
SETTING = '  - {name: setting, address: 0x48, length: 1, access: read_write, default: DEFAULT, source: "6.3", other_bits: unspecified, fields: [FIELD]}\n'


@pytest.mark.parametrize("field", ["{name: zero_bits, at: 3, bits: 5}", "{name: zero_bits, at: 7:3}"])
def test_a_field_by_its_low_bit_and_its_width(tmp_path: Path, field: str) -> None:
    """``at: 3`` with ``bits: 5`` is 7:3 for the parameter as well, not bit 3 alone."""
    device = sound(tmp_path, HELD, ZEROS, more=SETTING.replace("DEFAULT", "0x30").replace("FIELD", field))
    variant = device.variant("MIN12SC")
    assert variant.parameters["zero_bits"] == 6
    assert device.layout("single_cycle_data").place(variant.parameters).bits == 12 + 6 + 2 + 6


def test_a_parameter_held_in_a_whole_register(tmp_path: Path) -> None:
    held = (HELD[0], HELD[1].replace("setting.zero_bits", "setting.setting"))
    device = sound(tmp_path, held, ZEROS, more=SETTING.replace("DEFAULT", "5").replace(", other_bits: unspecified, fields: [FIELD]", ""))
    assert device.variant("MIN12SC").parameters["zero_bits"] == 5


@pytest.mark.parametrize("other_bits", ["", "        other_bits: zero\n"])
def test_a_field_that_has_no_bits_by_default(tmp_path: Path, other_bits: str) -> None:
    """At width 0 it lies where its neighbour does, which must not change places with it; the longest frame is one without it."""
    held = (HELD[0], f"{HELD[1]}  more_bits: {{meaning: More of the position, read_from: setting.more_bits, min: 0, max: 7}}\n")
    position = "{name: position, bits: position_bits + more_bits + more_bits}"
    fields = (f"        fields:\n          {ZEROS[0]}".replace("          {", "          - {"), f"{other_bits}        fields:\n          - {ZEROS[1]}".replace("{name: position, bits: position_bits}", position))
    setting = "{name: zero_bits, at: 7:3}, {name: more_bits, at: 2:0}"
    device = sound(tmp_path, held, fields, more=SETTING.replace("DEFAULT", "0").replace("FIELD", setting))
    layout, variant = device.layout("single_cycle_data"), device.variant("MIN16SC")
    assert [field.name for field in layout.fields] == ["position", "zeros", "error", "warning", "crc"]
    assert layout.place(variant.parameters).bits == 16 + 2 + 6
    later = layout.place(with_registers(device, variant, {0x48: 7 << 3}).parameters)
    assert [(item.name, item.low, item.width) for item in later.fields][:2] == [("position", 15, 16), ("zeros", 8, 7)]


# -- what a position can hold

POSITION = "{name: position, bits: position_bits}"
FRAME_BITS = (HELD[0], "  position_bits: {meaning: Bits of the position}\n  frame_bits: {meaning: Bits of the frame}\n")
TWO_SETS = ("12: {sets: {position_bits: 12}}\n        \"16\": {sets: {position_bits: 16}}",
            "12: {sets: {position_bits: 12, frame_bits: 13}}\n        \"16\": {sets: {position_bits: 16, frame_bits: 25}}")  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "measurement"),
    [
        ((), "steps_per_turn: 2^position_bits"),
        (((POSITION, "{name: position, bits: 12}"),), "steps_per_turn: 3600"),
        (((POSITION, "{name: position, bits: 24}"),), "steps_per_turn: 4096"),
        (((POSITION, "{name: position, bits: 48, signed: true}"),), "steps_per_turn: 2^position_bits, turns: 16"),
        (((POSITION, "{name: position, bits: position_bits, padded_to: 24}"),), "steps_per_turn: 2^position_bits, turns: 1"),
        ((FRAME_BITS, TWO_SETS, (POSITION, "{name: position, bits: frame_bits}")), "steps_per_turn: 2^position_bits"),
        (((POSITION, "{name: position, bits: position_bits + 4}"),), "steps_per_turn: 2^position_bits, turns: 10"),
        (((POSITION, "{name: turns, bits: 4}\n          - {name: angle, bits: position_bits}"), ("crc: biss_6}\n", "crc: biss_6}\n        join: {position: [turns, angle]}\n")),
         "steps_per_turn: 2^position_bits, turns: 10"),
    ],
)  # fmt: skip
def test_steps_and_turns_that_fit(tmp_path: Path, changes: tuple[tuple[str, str], ...], measurement: str) -> None:
    """Steps need be no power of two, and a position may be wider than it needs: by a fixed width, by padding, by a parameter of its own."""
    sound(tmp_path, *changes, more=f'measurement: {{of: position, {measurement}, source: "6.1"}}\n')


def test_turns_that_a_register_holds(tmp_path: Path) -> None:
    """255 turns are the highest count of a byte and no slip, where a user may set any number."""
    held = (HELD[0], f"{HELD[0]}  turns: {{meaning: Turns, read_from: setting.setting, min: 1, max: 255}}\n")
    more = SETTING.replace("DEFAULT", "255").replace(", other_bits: unspecified, fields: [FIELD]", "")
    sound(tmp_path, held, (POSITION, "{name: position, bits: position_bits + 8}"), more=more + 'measurement: {of: position, steps_per_turn: 2^position_bits, turns: turns, source: "6.1"}\n')


# -- arguments of procedures


def test_an_argument_below_zero_for_a_field_that_is_not_called_like_its_register(tmp_path: Path) -> None:
    more = """  - {name: lowest, address: 0x48, length: 1, access: read_write, min: -40, max: 20, source: "6.3", fields: [{name: degrees_below, bits: 8, signed: true}]}
procedures:
  - {name: set_lowest, title: Set, interface: biss, source: "6.3", arguments: [{name: value, of: lowest}], steps: [{do: write, register: lowest, value: value}]}
examples:
  - {name: thirty_below, kind: procedure, procedure: set_lowest, order_code: MIN12SC, arguments: {value: -30}, writes: [{address: 0x48, value: 0xE2}], source: "6.3"}
"""
    sound(tmp_path, more=more)
