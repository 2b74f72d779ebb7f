"""Valid specs that a rule could wrongly refuse, or that were once built wrongly."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.outputs import load_for_targets, targets_named
from codewheel.model import Device, Unused, Verdict
from codewheel.order_codes.parameters import with_answers, with_registers
from codewheel.reference import codec

HERE = Path(__file__).parent
#: A spec without errors, to be changed in one place.
BASE = (HERE / "ok" / "minimal.yaml").read_text(encoding="utf-8")
MAKER = (HERE / "broken_model" / "manufacturer.yaml").read_text(encoding="utf-8")


def load_changed(folder: Path, *changes: tuple[str, str], more: str = "") -> tuple[Device | None, list[str]]:
    """Return the device of the base spec with these changes, and the problems in it."""
    text = BASE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (folder / "manufacturer.yaml").write_text(MAKER, encoding="utf-8")
    (folder / "minimal.yaml").write_text(text + more, encoding="utf-8")
    devices, report = load_for_targets([folder], targets_named())
    return (devices[0] if devices else None), [f"{problem.rule}: {problem.message}" for problem in report.problems]


def load_valid(folder: Path, *changes: tuple[str, str], more: str = "") -> Device:
    device, problems = load_changed(folder, *changes, more=more)
    assert problems == []
    assert device is not None
    return device


# -- layouts


def test_a_request_can_have_a_field_named_like_the_position(tmp_path: Path) -> None:
    serial = (HERE / "broken" / "exchange_without_measurement.yaml").read_text(encoding="utf-8").splitlines()[15:]
    request = "{name: position, bits: 8, constant: 1}"
    interface = "\n".join(serial).replace("{name: command, bits: 8, constant: 1}", request)
    measurement = '    measurement: {of: position, counts_per_turn: 2^16, turns: 1, source: "7"}'
    device = load_valid(
        tmp_path,
        ("        SC: {interface: biss}\n", "        SC: {interface: biss}\n        JP: {interface: rs485}\n"),
        ("registers:\n", f"{interface}\n{measurement}\nregisters:\n"),
    )
    assert {variant.interface for variant in device.variants} == {"biss", "rs485"}


# -- keywords of a field


@pytest.mark.parametrize(
    ("word", "bit_of_7", "bit_of_3"),
    [
        ("", 1, 0),
        (", parity: even", 1, 0),
        (", parity: odd", 0, 1),
        (", over: odd_bits", 1, 1),
        (", parity: odd, over: odd_bits", 0, 0),
        (", over: even_bits", 0, 1),
        (", parity: odd, over: even_bits", 1, 0),
    ],
)
def test_a_parity_bit_has_a_sense(tmp_path: Path, word: str, bit_of_7: int, bit_of_3: int) -> None:
    """Check 7, with ones in bits 0, 1 and 2, and 3, with ones in bits 0 and 1. Even is the default."""
    position = "          - {name: position, bits: position_bits}\n"
    parity = f"          - {{name: check, parity_of: position{word}}}\n"
    device = load_valid(tmp_path, (position, position + parity))
    placed = device.layout("single_cycle_data").place(device.variant("MIN12SC").parameters)
    for position_is, bit in ((7, bit_of_7), (3, bit_of_3)):
        frame = codec.encode(device, placed, {"position": position_is, "error": False, "warning": False})
        assert frame >> 8 == position_is << 1 | bit


# -- fields whose width is in a register

BITS = "  position_bits: {meaning: Bits of the position}\n"
HELD = (BITS, f"{BITS}  zero_bits: {{meaning: Zeros after it, read_from: setting.zero_bits, min: 0, max: 7}}\n")
ZEROS = (
    "{name: position, bits: position_bits}\n",
    "{name: position, bits: position_bits}\n          - {name: zeros, bits: zero_bits, constant: 0}\n",
)
SETTING = (
    '  - {name: setting, address: 0x48, length: 1, access: read_write, default: DEFAULT, source: "6.3",'
    " other_bits: unspecified, fields: [FIELD]}\n"
)


@pytest.mark.parametrize("field", ["{name: zero_bits, at: 3, bits: 5}", "{name: zero_bits, at: 7:3}"])
def test_a_field_by_its_low_bit_and_its_width(tmp_path: Path, field: str) -> None:
    """``at: 3`` with ``bits: 5`` is 7:3 for the parameter as well, not bit 3 alone."""
    device = load_valid(tmp_path, HELD, ZEROS, more=SETTING.replace("DEFAULT", "0x30").replace("FIELD", field))
    variant = device.variant("MIN12SC")
    assert variant.parameters["zero_bits"] == 6
    assert device.layout("single_cycle_data").place(variant.parameters).bits == 12 + 6 + 2 + 6


def test_a_parameter_held_in_a_whole_register(tmp_path: Path) -> None:
    held_parameter = (HELD[0], HELD[1].replace("setting.zero_bits", "setting.setting"))
    device = load_valid(
        tmp_path,
        held_parameter,
        ZEROS,
        more=SETTING.replace("DEFAULT", "5").replace(", other_bits: unspecified, fields: [FIELD]", ""),
    )
    assert device.variant("MIN12SC").parameters["zero_bits"] == 5


@pytest.mark.parametrize("other_bits", ["", "        other_bits: zero\n"])
def test_a_field_that_has_no_bits_by_default(tmp_path: Path, other_bits: str) -> None:
    """At width 0 it has the position of its neighbour, and both keep their positions.

    The longest frame is one without it.
    """
    held_parameter = (
        HELD[0],
        f"{HELD[1]}  more_bits: {{meaning: More of the position, read_from: setting.more_bits, min: 0, max: 7}}\n",
    )
    position = "{name: position, bits: position_bits + more_bits + more_bits}"
    fields = (
        f"        fields:\n          {ZEROS[0]}".replace("          {", "          - {"),
        f"{other_bits}        fields:\n          - {ZEROS[1]}".replace(
            "{name: position, bits: position_bits}", position
        ),
    )
    setting = "{name: zero_bits, at: 7:3}, {name: more_bits, at: 2:0}"
    device = load_valid(
        tmp_path, held_parameter, fields, more=SETTING.replace("DEFAULT", "0").replace("FIELD", setting)
    )
    layout, variant = device.layout("single_cycle_data"), device.variant("MIN16SC")
    assert [field.name for field in layout.fields] == ["position", "zeros", "error", "warning", "crc"]
    assert layout.place(variant.parameters).bits == 16 + 2 + 6
    later = layout.place(with_registers(device, variant, {0x48: 7 << 3}).parameters)
    assert [(placed_field.name, placed_field.lowest_bit, placed_field.width) for placed_field in later.fields][:2] == [
        ("position", 15, 16),
        ("zeros", 8, 7),
    ]


# -- ranges of positions

POSITION = "{name: position, bits: position_bits}"
FRAME_BITS = (BITS, f"{BITS}  frame_bits: {{meaning: Bits of the frame}}\n")
TWO_SETS = (
    '12: {sets: {position_bits: 12}}\n        "16": {sets: {position_bits: 16}}',
    '12: {sets: {position_bits: 12, frame_bits: 13}}\n        "16": {sets: {position_bits: 16, frame_bits: 25}}',
)
#: Without the parameter 'position_bits', on which nothing depends if the position has a fixed width.
NO_PARAMETER = (
    (f"parameters:\n{BITS}", "parameters: {}\n"),
    ("sets: {position_bits: 12}", "sets: {}"),
    ("sets: {position_bits: 16}", "sets: {}"),
)
INTERPOLATED = "{name: position, bits: position_bits + 8}"
PADDED = "{name: position, bits: position_bits, padded_to: 24}"
IN_TWO_FIELDS = "{name: turns, bits: 4}\n          - {name: angle, bits: position_bits}"


@pytest.mark.parametrize(
    ("changes", "measurement"),
    [
        ((), "counts_per_turn: 2^position_bits"),
        (((POSITION, "{name: position, bits: 12}"), *NO_PARAMETER), "counts_per_turn: 3600"),
        (((POSITION, "{name: position, bits: 24}"), *NO_PARAMETER), "counts_per_turn: 4096"),
        (
            ((POSITION, "{name: position, bits: 48, signed: true}"),),
            "counts_per_turn: 2^position_bits, turns: 16, highest: 32767",
        ),
        (((POSITION, PADDED),), "counts_per_turn: 2^position_bits, turns: 1"),
        ((FRAME_BITS, TWO_SETS, (POSITION, "{name: position, bits: frame_bits}")), "counts_per_turn: 2^position_bits"),
        (((POSITION, "{name: position, bits: position_bits + 4}"),), "counts_per_turn: 2^position_bits, turns: 10"),
        # A factor is a parameter, as the message about '2^position_bits * 256' says.
        (
            ((BITS, f"{BITS}  factor: {{meaning: Interpolation, equals: 256}}\n"), (POSITION, INTERPOLATED)),
            "counts_per_turn: 2^position_bits * factor",
        ),
        (
            ((POSITION, IN_TWO_FIELDS), ("crc: biss_6}\n", "crc: biss_6}\n        join: {position: [turns, angle]}\n")),
            "counts_per_turn: 2^position_bits, turns: 10",
        ),
    ],
)  # fmt: skip
def test_steps_and_turns_that_fit(tmp_path: Path, changes: tuple[tuple[str, str], ...], measurement: str) -> None:
    """The number of steps need not be a power of two, and a position may be wider than needed.

    It may have a fixed width, padding, or a parameter of its own.
    """
    load_valid(tmp_path, *changes, more=f'measurement: {{of: position, {measurement}, source: "6.1"}}\n')


def test_turns_that_a_register_holds(tmp_path: Path) -> None:
    """255 turns, the maximum of a byte, are not a typing mistake if a user may set any number."""
    held_parameter = (HELD[0], f"{HELD[0]}  turns: {{meaning: Turns, read_from: setting.setting, min: 1, max: 255}}\n")
    more = SETTING.replace("DEFAULT", "255").replace(", other_bits: unspecified, fields: [FIELD]", "")
    load_valid(
        tmp_path,
        held_parameter,
        (POSITION, "{name: position, bits: position_bits + 8}"),
        more=more + 'measurement: {of: position, counts_per_turn: 2^position_bits, turns: turns, source: "6.1"}\n',
    )


# -- arguments of procedures


def test_an_argument_below_zero_for_a_field_that_is_not_called_like_its_register(tmp_path: Path) -> None:
    more = """  - {name: lowest, address: 0x48, length: 1, access: read_write, min: -40, max: 20, source: "6.3",
     fields: [{name: degrees_below, bits: 8, signed: true}]}
procedures:
  - {name: set_lowest, title: Set, interface: biss, source: "6.3",
     arguments: [{name: value, of: lowest}], steps: [{do: write, register: lowest, value: value}]}
examples:
  - {name: thirty_below, kind: procedure, procedure: set_lowest, order_code: MIN12SC,
     arguments: {value: -30}, writes: [{address: 0x48, value: 0xE2}], source: "6.3"}
"""
    load_valid(tmp_path, more=more)


# -- unused bits, and open questions of the manual

WHOLE_LINE = "          - {name: position, bits: position_bits}\n"


def test_unused_bits_say_what_they_make_of_the_position(tmp_path: Path) -> None:
    spare = '          - {name: spare, bits: 2, unused: 2, makes_position: not_usable, meaning: "Reserved"}\n'
    more = "          - {name: rest, bits: 3, unused: 0}\n"
    device = load_valid(tmp_path, (WHOLE_LINE, WHOLE_LINE + spare + more))
    layout = device.layout("single_cycle_data")
    assert layout.field("spare").kind == Unused(2, Verdict.NOT_USABLE)
    assert layout.field("rest").kind == Unused(0, Verdict.USABLE_WITH_WARNING)
    # The last one sent is the lowest in the number of unused bits.
    assert [(field.name, place) for field, place in layout.unused] == [("rest", 0), ("spare", 3)]


def test_an_alternative_moves_fields(tmp_path: Path) -> None:
    open_ = "".join(f"  {name}: {{meaning: Lowest bit, alternative: place}}\n" for name in ("address_low", "busy_low"))
    more = (
        "  - {name: access, address: 0x48, length: 1, access: read_write, source: '6.3', fields: ["
        "{name: address, low_bit: address_low, bits: 7}, {name: busy, low_bit: busy_low, active: high}]}\n"
        "alternatives:\n"
        "  - name: place\n    meaning: Where the address stands\n    source: '7'\n    values:\n"
        "      above: {meaning: In bits 7:1, sets: {address_low: 1, busy_low: 0}}\n"
        "      below: {meaning: In bits 6:0, sets: {address_low: 0, busy_low: 7}}\n"
    )
    device, problems = load_changed(tmp_path, (BITS, BITS + open_), more=more)
    assert [problem.partition(":")[0] for problem in problems] == ["c-target"]  # C takes answers for frames only.
    assert device is not None
    variant = device.variant("MIN12SC")
    layout = device.register("access").layout
    assert [alternative.name for alternative in device.alternatives_of(layout)] == ["place"]
    for answer, number in (("above", 0x0B), ("below", 0x85)):
        placed = layout.place(with_answers(device, variant, {"place": answer}).parameters)
        values = {field.name: field.value for field in codec.decode(device, placed, number).fields}
        assert values == {"address": 5, "busy": True}
