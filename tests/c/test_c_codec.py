"""C and the model's codec agree for every order code and layout: at bounds, and on random and disturbed frames."""

from __future__ import annotations

import random
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from c_harness import FAMILIES, Member, Run, codecs, compile_c, compile_programs, members, runner_over, short, write
from codewheel.model import (
    Choice,
    CrcValue,
    Device,
    Field,
    Flag,
    Layout,
    PlacedLayout,
    Register,
    Rs485,
    Text,
    Variant,
    number_to_bytes,
)
from codewheel.order_codes.parameters import with_answers, with_registers
from codewheel.plan.crcs import crc_functions
from codewheel.reference.bits_and_values import (
    binary_to_gray,
    compute,
    compute_bits,
    compute_bytes,
    join_value,
    to_binary,
    unused_bits,
)
from codewheel.reference.codec import UNUSED, decode, encode
from codewheel.targets.c.device import views_of
from codewheel.targets.c.names import c_name
from exhaustive import mostly_exhaustive

pytestmark = pytest.mark.slow

FAULTS = {"length": 1, "crc": 2, "constant": 3, "range": 4}
RANDOM_FRAMES = 40


class Table:
    """Return the layouts and registers of a device by the names in the harness, with the members of their structs."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self.members = {short(view, codec): members(codec) for view in views_of(device) for codec in codecs(view)}
        self.layouts = {layout.name: (interface.name, layout) for interface, layout in device.layouts()}
        self.layouts |= {f"reg_{register.name}": (register.interface, register.layout) for register in device.registers}

    def cases(self) -> Iterator[tuple[str, Variant, PlacedLayout]]:
        """Return every layout for every order code, and for some states of the registers at run time."""
        variants = [*self.device.variants, *run_time_variants(self.device)]
        for name in self.members:
            kind, layout = self.layouts[name]
            for variant in variants:
                if variant.interface == kind:
                    yield name, variant, layout.place(variant.parameters)

    def row(self, name: str, placed: PlacedLayout, number: int) -> str:
        """Return the expected output of the harness for a number without errors."""
        layout = placed.layout
        number = to_binary(placed, number)
        values: dict[str, int | str] = {}
        for field in layout.fields:
            placed_field = placed.find_field(field.name)
            raw = number >> placed_field.lowest_bit & placed_field.mask if placed_field is not None else 0
            if isinstance(field.kind, Text) and placed_field is not None:
                values[field.name] = raw.to_bytes(placed_field.width // 8, "big").hex().upper()
            else:
                values[field.name] = int(
                    value_of_raw(field, placed_field.width if placed_field is not None else 0, raw)
                )
            for run in field.runs:
                values[run.name] = raw // run.divisor % run.modulus
        values |= {join.name: join_value(placed, join, number) for join in layout.joins}
        values[UNUSED] = unused_bits(placed, number)
        by_member = {c_name(key): value for key, value in values.items()}
        return " ".join(str(by_member[member.name]) for member in self.members[name])

    def expected_answer(self, name: str, placed: PlacedLayout, number: int) -> str:
        problems = decode(self.device, placed, number).problems
        return str(FAULTS[problems[0].fault.value]) if problems else f"0 {self.row(name, placed, number)}"


def value_of_raw(field: Field, width: int, raw: int) -> int | bool:
    """Return the meaning of the bits of a field."""
    if isinstance(field.kind, Flag):
        return width > 0 and bool(raw) != field.kind.active_low
    if width and field.number.signed and raw >> (width - 1):
        return raw - (1 << width)
    return field.number.zero_means if field.number.zero_means and not raw else raw


def run_time_variants(device: Device) -> list[Variant]:
    """Return order codes with registers that differ from their defaults. Their code sets the state of the program."""
    random_ = random.Random("run time")
    variants = []
    held_by = {parameter.register for parameter in device.run_time_parameters}
    kinds = {device.register(name).interface for name in held_by}
    for variant in [variant for variant in device.variants if variant.interface in kinds][:4]:
        for _ in range(6):
            contents: dict[int, int] = {}
            code = variant.code
            for register in (device.register(name) for name in sorted(held_by)):
                data = register_bytes(device, register, random_)
                contents |= {register.address + index: byte for index, byte in enumerate(data)}
                code += f";{register.name}={data.hex()}"
            variants.append(replace(with_registers(device, variant, contents), code=code))
    return [*variants, *with_other_answers(device)]


def with_other_answers(device: Device) -> Iterator[Variant]:
    """Return some order codes with other answers to the open questions of the manual. Others have the first answers."""
    for alternative in device.alternatives:
        if alternative.default:
            kinds = {parameter.interface for parameter in device.parameters if parameter.name == alternative.parameter}
        else:
            layouts = device.layouts()
            kinds = {kind.name for kind, layout in layouts if alternative in device.alternatives_of(layout)}
        variants = [variant for variant in device.variants if variant.interface in kinds]
        for index, answer in enumerate(alternative.answers):
            state = f"{alternative.name}={index:02X}"
            for variant in variants[-2:]:
                chosen = with_answers(device, variant, {alternative.name: answer.name})
                yield replace(chosen, code=f"{variant.code};{state}")


def register_bytes(device: Device, register: Register, random_: random.Random) -> bytes:
    """Set the parameters of the register to a boundary or to a random value."""
    number = register.default or 0
    for parameter in device.run_time_parameters:
        if parameter.register == register.name:
            field = register.layout.field(parameter.field)
            low, high = parameter.min or 0, parameter.max if parameter.max is not None else (1 << field.widest) - 1
            value = random_.choice([low, high, random_.randint(low, high)])
            if parameter.by_code:
                value = random_.choice(parameter.by_code).code
            mask = (1 << field.widest) - 1
            number = (
                number & ~(mask << field.low.constant)
                | (0 if value == field.number.zero_means and not parameter.by_code else value) << field.low.constant
            )
    return number_to_bytes(register.layout, number, 8 * register.length)


def on_the_wire(placed: PlacedLayout, number: int) -> str:
    if placed.layout.carried_as == "bits":
        return f"{number:X}"
    return number_to_bytes(placed.layout, number, placed.bits).hex().upper()


def samples(field: Field, width: int, layout: Layout, random_: random.Random) -> list[int]:
    """Return raw values of a field: 0, 1, all ones, the top bit alone, and random ones. A choice has all its values."""
    if field.name == layout.selector:
        return list(layout.selects)
    if isinstance(field.kind, Choice):
        return [value.value for value in field.values]
    if field.runs:
        limit = field.kind.limit
        return [0, 1, limit - 1, 183003630 % limit, random_.randrange(limit)]
    ones = (1 << width) - 1
    if field.number.power_of_two:
        return [1 << bit for bit in range(width)]
    if isinstance(field.kind, Text):
        return [int.from_bytes(b"AMM5 Li!"[: width // 8].ljust(width // 8), "big"), random_.getrandbits(width)]
    return [0, 1, ones, 1 << (width - 1), *(random_.getrandbits(width) for _ in range(4))]


def valid_numbers(device: Device, placed: PlacedLayout, random_: random.Random) -> Iterator[int]:
    """Return numbers that decode without errors: samples of one field at a time with random others, then all random."""
    data = [field for field in placed.fields if field.field.carries_data]
    choices = {field.name: samples(field.field, field.width, placed.layout, random_) for field in data}
    for field in data:
        for value in choices[field.name]:
            yield encoded_sample(device, placed, choices, {field.name: value}, random_)
    for _ in range(RANDOM_FRAMES):
        yield encoded_sample(device, placed, choices, {}, random_)


def encoded_sample(
    device: Device, placed: PlacedLayout, choices: dict[str, list[int]], fixed: dict[str, int], random_: random.Random
) -> int:
    values: dict[str, int | str | bool] = {}
    for name, possible in choices.items():
        raw = fixed.get(name, random_.choice(possible))
        placed_field = placed.field(name)
        values[name] = value_of_raw(placed_field.field, placed_field.width, raw)
        code = placed_field.field.code_of_digits
        if code is not None:
            values[name] = min(int(values[name]), code.highest(placed_field.width))
        valid = device.range_in(placed.layout)
        if valid is not None and valid.name == name:
            lowest, highest = valid.lowest.value(placed.parameters), valid.highest.value(placed.parameters)
            values[name] = min(max(int(values[name]), lowest), highest)
    valid = device.range_in(placed.layout)
    if valid is not None and valid.field is None:
        parts = placed.find_fields([field.name for field in valid.fields])
        highest = valid.highest.value(placed.parameters)
        position = 0
        for part in parts:
            position = position << part.width | int(values.pop(part.name))
        values[valid.name] = min(position, highest)
    if placed.layout.unused:
        values[UNUSED] = random_.getrandbits(64) & unused_mask(placed) if random_.getrandbits(1) else 0
    return encode(device, placed, values)


def unused_mask(placed: PlacedLayout) -> int:
    """Return the bits that the number of the unused fields can have."""
    items = ((placed.find_field(field.name), place) for field, place in placed.layout.unused)
    return sum(unused_field.mask << place for unused_field, place in items if unused_field is not None)


def check(run: Run, pairs: Sequence[tuple[str, str]]) -> None:
    answers = run(line for line, _ in pairs)
    assert len(answers) == len(pairs)
    rows = [(line, expected, answer) for (line, expected), answer in zip(pairs, answers, strict=True)]
    differing = [row for row in rows if row[1] != row[2]]
    assert not differing, differing[:5]


def round_trips(table: Table) -> list[tuple[str, str]]:
    random_ = random.Random("round trips")
    pairs = []
    for name, variant, placed in table.cases():
        for number in valid_numbers(table.device, placed, random_):
            row = table.row(name, placed, number)
            wire = on_the_wire(placed, number)
            pairs.append((f"{variant.code} decode {name} {wire}", f"0 {row}"))
            if within_limits(table.device, name, variant, placed, number):
                pairs.append((f"{variant.code} encode {name} {row}", f"0 {wire}"))
    return pairs


def within_limits(device: Device, name: str, variant: Variant, placed: PlacedLayout, number: int) -> bool:
    """Return True if a value may be written to a register. Encoders refuse others."""
    register = next((register for register in device.registers if f"reg_{register.name}" == name), None)
    if register is None:
        return True
    join = next((join for join in placed.layout.joins if join.name == register.limits_of), None)
    limited_field = placed.find_field(register.limits_of) or (placed.fields[0] if len(placed.fields) == 1 else None)
    value = number
    if join is not None:
        value = join_value(placed, join, number)
    elif limited_field is not None:
        value = int(
            value_of_raw(
                limited_field.field, limited_field.width, number >> limited_field.lowest_bit & limited_field.mask
            )
        )
    low = register.min.value(variant.parameters) if register.min is not None else 0
    return low <= value <= (register.max.value(variant.parameters) if register.max is not None else value)


@pytest.mark.one_in(2, "exhaustive")
def test_decode_and_encode_are_inverse_for_every_order_code(machine: tuple[Device, Run]) -> None:
    device, run = machine
    pairs = round_trips(Table(device))
    assert (
        len({line.split()[0].partition(";")[0] for line, _ in pairs})
        == len(device.variants)
        == {
            "am36": 12,
            "amm5": 36,
            "asc85": 36,
            "icmu": 42,
            "sma21": 45,
            "banks": 1,
            "bits22": 1,
            "digits": 2,
            "gray": 1,
            "gray_excess": 12,
            "gray_parity": 6,
            "long": 2,
            "long_crc": 2,
            "ring_split": 5,
            "ring_turns": 8,
            "scale": 9,
            "signs": 3,
            "switched": 2,
            "wide": 2,
            "reserved": 4,
            "shapes": 4,
            "tv62": 10,
            "words": 6,
        }[device.name]
    )
    check(run, pairs)


@pytest.mark.slow
@pytest.mark.parametrize("family", mostly_exhaustive(FAMILIES, "amm5"))
def test_the_table_form_of_a_crc_gives_the_same(
    family: str, every_device: Mapping[str, Device], tmp_path: Path
) -> None:
    """Every frame of every order code again, with the macro that selects a table instead of folding."""
    device = every_device[family]
    maker = device.manufacturer.name
    command = ["gcc", "-std=c99", "-O1", f"-D{maker.upper()}_CRC_TABLE"]
    compile_programs(command, device, tmp_path, write(tmp_path, (device,)))
    check(runner_over(device, tmp_path), round_trips(Table(device)))


@pytest.mark.one_in(2, "exhaustive")
def test_disturbed_frames_have_the_same_fault_as_in_the_model(machine: tuple[Device, Run]) -> None:
    device, run = machine
    pairs, kinds = disturbed_frames(device)
    check(run, pairs)
    assert kinds >= {
        "banks": {"0", "2"},
        "bits22": {"0", "2"},
        "digits": {"0", "4"},
        "gray": {"0"},
        "gray_excess": {"0", "2", "4"},
        "long": {"0", "2", "3"},
        "long_crc": {"0", "2", "3"},
        "ring_split": {"0", "2", "4"},
        "ring_turns": {"0", "2", "4"},
        "scale": {"0", "2", "3", "4"},
        "signs": {"0", "2", "3", "4"},
        "switched": {"0", "2", "3"},
        "wide": {"0", "2"},
        "amm5": {"0", "2", "3", "4"},
        "words": {"0", "2", "3", "4"},
    }.get(device.name, {"0", "2", "3"})


def disturbed_frames(device: Device) -> tuple[list[tuple[str, str]], set[str]]:
    """Frames with flipped bits, the expected result of each, and the results that must occur."""
    random_ = random.Random("disturbed")
    table = Table(device)
    pairs, kinds = [], set()
    for name, variant, placed in table.cases():
        sound = list(valid_numbers(device, placed, random_))
        numbers = [random_.choice(sound) ^ 1 << bit for bit in range(placed.bits)]
        numbers += [random_.choice(sound) ^ random_.getrandbits(placed.bits) for _ in range(RANDOM_FRAMES)]
        numbers += [0, (1 << placed.bits) - 1]
        # Errors with a valid CRC: constants, parity, ranges.
        numbers += [with_crc(device, placed, number) for number in numbers]
        for number in numbers:
            expected = table.expected_answer(name, placed, number)
            kinds.add(expected[0])
            pairs.append((f"{variant.code} decode {name} {on_the_wire(placed, number)}", expected))
        if placed.layout.carried_as == "bits":
            pairs += [(f"{variant.code} decode {name} {sound[0] | 1 << bit:X}", "1") for bit in range(placed.bits, 64)]
        else:
            data = on_the_wire(placed, sound[0])
            wrong_lengths = (data[:-2], data + "00", data[:-2] + "0000")
            pairs += [(f"{variant.code} decode {name} {text}", "1") for text in wrong_lengths]
    return pairs, kinds


def with_crc(device: Device, placed: PlacedLayout, number: int) -> int:
    for field in placed.fields:
        if isinstance(field.field.kind, CrcValue):
            cleared = number & ~(field.mask << field.lowest_bit)
            return cleared | compute(device.crc(field.field.kind.crc), placed, cleared) << field.lowest_bit
    return number


#: Bits of a number without its sign.
_NUMBER_BITS = {
    "uint8_t": 8,
    "uint16_t": 16,
    "uint32_t": 32,
    "uint64_t": 64,
    "int8_t": 7,
    "int16_t": 15,
    "int32_t": 31,
    "int64_t": 63,
}


def _takes_every_value(placed: PlacedLayout, member: Member) -> bool:
    """Return True if no value of a member can be refused.

    Every other member is either narrower in the layout than its type, so that all ones do not fit, or repeated by
    another member that then disagrees.
    """
    if member.type == "bool" or member.characters:
        return True
    if member.name == UNUSED and unused_mask(placed) == (1 << _NUMBER_BITS[member.type]) - 1:
        return True
    placed_field = next((field for field in placed.fields if c_name(field.name) == member.name), None)
    repeated = {c_name(name) for join in placed.layout.joins for name in (join.name, *join.fields)}
    has_runs = any(field.runs for field in placed.layout.fields)
    if placed_field is None or member.name in repeated or has_runs:
        return False
    largest = (1 << _NUMBER_BITS.get(member.type, 31)) - 1
    mask = placed_field.mask
    return mask == largest or (placed_field.field.number.signed and mask >> 1 == largest)


def test_encoders_refuse_what_does_not_fit(machine: tuple[Device, Run]) -> None:
    device, run = machine
    random_ = random.Random("refused")
    table = Table(device)
    pairs = []
    for name, variant, placed in table.cases():
        number = next(valid_numbers(device, placed, random_))
        row = table.row(name, placed, number).split(" ")
        for index, member in enumerate(table.members[name]):
            if _takes_every_value(placed, member):
                continue
            largest = (1 << _NUMBER_BITS.get(member.type, 31)) - 1
            changed = [*row[:index], str(largest if row[index] != str(largest) else largest - 1), *row[index + 1 :]]
            pairs.append((f"{variant.code} encode {name} {' '.join(changed)}", "4"))
    assert pairs
    answers = run(line for line, _ in pairs)
    accepted = []
    for (line, _), answer in zip(pairs, answers, strict=True):
        result, wire = answer.split()[:2]
        if result != "4" or wire.strip("0"):
            accepted.append((line, answer))
    assert accepted == []


def test_a_position_and_its_parts_have_to_agree(run: Run) -> None:
    code = "AMM5A21/65KSC1"
    position = 5 << 21 | 7
    assert run([f"{code} encode single_cycle_data 5 7 0 0 {position}"])[0].startswith("0 ")
    assert run(
        [f"{code} encode single_cycle_data 5 7 0 0 {position + 1}", f"{code} encode single_cycle_data 0 0 0 0 1"]
    ) == ["4 0", "4 0"]


def test_absent_fields_are_zero_and_stay_so(run: Run) -> None:
    assert run(["AMM5A17/1BG1 decode ssi_word 1FFFF", "AMM5A17/1BG1 encode ssi_word 1 0 131072"]) == [
        "0 0 131071 131071",
        "4 0",
    ]


def test_an_absent_signed_field_takes_only_0(programs: Mapping[str, Run]) -> None:
    lines = [f"WBJP encode high_reply 0 0 462 {value}" for value in (0, -1, 1, -128)]
    assert programs["shapes"](lines) == ["0 020000000001CE000098", *[f"4 {0:020}"] * 3]


def test_the_preset_procedure_of_the_manual(run: Run) -> None:
    answer = run([f"AMM5A21/65KSC1 steps set_preset {1000003:X}"])[0].split(" ")
    steps = [tuple(map(int, step.split(","))) for step in answer[1:]]
    # Kind 6 is also a write, which closes a register that an earlier one opened.
    assert [(f"{row[1]:02X}", f"{row[3]:02X}") for row in steps if row[0] in (1, 6)] == [
        ("40", "01"),
        ("11", "00"),
        ("12", "30"),
        ("13", "24"),
        ("14", "F4"),
        ("15", "00"),
        ("16", "00"),
        ("17", "00"),
        ("40", "00"),
        ("77", "01"),
        ("77", "02"),
    ]
    assert [row[5] for row in steps if row[0] == 2] == [30000, 30000]


def test_a_preset_beyond_the_resolution_is_refused(run: Run) -> None:
    assert run([f"AMM5A21/1SC1 steps set_preset {1 << 21:X}", f"AMM5A21/65KSC1 steps set_preset {1 << 37:X}"]) == [
        "4",
        "4",
    ]


def test_manual_examples_by_hand(run: Run) -> None:
    lines = {
        "AMM5A21/65KSC1 decode reg_preset 003024F4000000": "0 0 1000003 1000003",
        "AMM5A21/65KSC1 encode reg_preset 0 1000003 1000003": "0 003024F4000000",
        "AMM5A21/65KSC1 decode reg_serial_number 0AE869EE": "0 183003630 18 30 3630",
        "AMM5A21/65KSC1 encode reg_serial_number 183003630 18 30 3630": "0 0AE869EE",
        # The printed CRC example is a correct CRC, but has the length of no reply.
        "AMM5A23/65KJP1 crc rs485_8 32100128B008": f"0 {0xB3}",
        "AMM5A23/65KJP1 decode eeprom_write_reply 32100128B008B3": "1",
        "AMM5A23/65KJP1 decode singleturn_reply 32100128B008B3": "1",
        # A reply from a public log: hpmicro and TI, see tests/specs and the spec's examples.
        "AMM5A23/65KJP1 decode singleturn_reply 0220C7D16A5E": "0 0 0 1 7000519 0",
        # EEPROM requests of public T-format sources have bit 0 set, which is MEM BUSY as the manual prints it.
        "AMM5A23/65KJP1 decode eeprom_write_request 327F014C": "3",
        "AMM5A23/65KJP1 decode eeprom_write_request 32015A69": "3",
        "AMM5A23/65KJP1 decode eeprom_read_request EA01EB": "3",
        # They belong to the other form: page 1, write 5Ah to address 1, read address 1.
        "AMM5A23/65KJP1;adf_layout=01 decode eeprom_write_request 327F014C": "0 127 1",
        "AMM5A23/65KJP1;adf_layout=01 encode eeprom_write_request 127 1": "0 327F014C",
        "AMM5A23/65KJP1;adf_layout=01 encode eeprom_write_request 1 90": "0 32015A69",
        "AMM5A23/65KJP1;adf_layout=01 encode eeprom_read_request 1": "0 EA01EB",
        "AMM5A23/65KJP1;adf_layout=00 encode eeprom_read_request 5": "0 EA0AE0",
        "AMM5A23/65KJP1;adf_layout=01 encode eeprom_read_request 5": "0 EA05EF",
    }
    check(run, list(lines.items()))


def test_public_crc_rows(vectors: list[dict[str, Any]], run: Run) -> None:
    """CRC 6 of moteus. The CRC 4 of register accesses belongs to the runtime, see test_c_biss_control.py."""
    rows = [row["fields"] for row in vectors if "CRC6_raw" in row["fields"]]
    lines = {f"AMM5A17/1SC1 crc biss_6 {row['data']:X}": f"0 {row['CRC6_inverted']}" for row in rows}
    assert lines
    check(run, list(lines.items()))


def test_public_control_fields(vectors: list[dict[str, Any]], run: Run) -> None:
    """The rows of TI and of Panasonic's relatives. IDs that AMM5 does not know have a range error."""
    rows = [row["fields"] for row in vectors if set(row["fields"]) == {"data_id", "CF"}]
    known_ids = {0, 1, 2, 3, 7, 8, 12}
    assert len(rows) == 13
    lines = [f"AMM5A17/1JP1 decode data_request {row['CF']:02X}" for row in rows]
    expected = [f"0 {row['data_id']}" if row["data_id"] in known_ids else "4" for row in rows]
    check(run, list(zip(lines, expected, strict=True)))


def test_crc_over_bits_of_any_length(amm5: Device, run: Run) -> None:
    """The longest frame has 41 bits before its CRC."""
    name = "biss_6"
    random_ = random.Random(name)
    numbers = [random_.getrandbits(bits) for bits in range(1, 42) for _ in range(8)] + [0, 2**41 - 1]
    crc = amm5.crc(name)
    check(run, [(f"AMM5A17/1SC1 crc {name} {number:X}", f"0 {compute_bits(crc, number, 64)}") for number in numbers])


def test_crc_over_bytes(amm5: Device, run: Run) -> None:
    random_ = random.Random("bytes")
    texts = [random_.randbytes(length) for length in range(20)]
    check(
        run,
        [(f"AMM5A17/1JP1 crc rs485_8 {data.hex()}", f"0 {compute_bytes(amm5.crc('rs485_8'), data)}") for data in texts],
    )


def test_crcs_of_every_form(words: Device, run_words: Run) -> None:
    """With tables over bits and bytes, reflected or not, with start values. More than 16 bits are folded."""
    random_ = random.Random("forms")
    pairs = []
    word_crcs = [codec.word_crc for view in views_of(words) for codec in view.interface.codecs]
    longest = {function.crc.name: (function.word_bits - function.crc.width) // 8 for function in word_crcs if function}
    assert longest == {"dense_16": 4, "plain_20": 3}
    for crc in (crc for crc in words.crcs if crc.name != "twice_8"):  # in no frame, so that C has no function
        for length in (1, 2, 3, 5, 7, 8):
            data = random_.randbytes(min(length, longest.get(crc.name, 8)))
            bits = crc.name in ("dense_16", "started_5", "plain_20")
            expected = compute_bits(crc, int.from_bytes(data, "big"), 8 * length) if bits else compute_bytes(crc, data)
            pairs.append((f"{'WASC' if bits else 'WAJP'} crc {crc.name} {data.hex()}", f"0 {expected}"))
    check(run_words, pairs)
    assert {function.crc.name: function.method.value for function in crc_functions(words)} == {
        "dense_16": "table",
        "started_5": "table",
        "ccitt": "table",
        "modbus": "table",
        "plain_20": "fold",
        "twice_8": "xor",
    }


def test_control_bytes_tell_the_frame(amm5: Device, run: Run) -> None:
    """The control fields of the manual (7.3.1), also in TI's T-format driver.

    Without their layout, there are no such bytes.
    """
    interface = amm5.find_interface(Rs485)
    assert interface is not None
    frames = [layout for layout in interface.layouts if layout.selector]
    pairs = []
    for data_id in interface.data_ids:
        for sender, kind in (("master", "request"), ("encoder", "reply")):
            of_sender = [(at, layout) for at, layout in enumerate(frames) if layout.sender == sender]
            index, layout = next((at, layout) for at, layout in of_sender if data_id.id in layout.selects)
            pairs.append((f"AMM5A17/1JP1 select {kind} {data_id.control:02X}", f"0 {index} {layout.widest // 8}"))
    pairs += [("AMM5A17/1JP1 select reply 22", "4 0 0"), ("AMM5A17/1JP1 select reply", "1 0 0")]
    check(run, pairs)
    actions = [data_id for data_id in interface.data_ids if data_id.purpose in ("capture", "reset")]
    requests = [f"AMM5A17/1JP1 encode data_request {data_id.id}" for data_id in actions]
    expected = [f"0 {data_id.control:02X}" for data_id in actions]
    assert run(requests) == expected


def test_public_single_cycles_of_22_bits(bits22: Device, vectors: list[dict[str, Any]], run_bits22: Run) -> None:
    code = bits22.variants[0].code
    cycles = [row for row in vectors if row["fields"].get("position_bits") == 22]
    assert len(cycles) == 9
    for row in cycles:
        fields, word = row["fields"], int(row["frame_hex_or_bits"], 2)
        values = f"{fields['position']} {1 - fields['nE']} {1 - fields['nW']}"
        lines = [
            f"{code} decode single_cycle_data {word:X}",
            f"{code} encode single_cycle_data {values}",
            f"{code} decode single_cycle_data {word ^ 64:X}",
        ]
        assert run_bits22(lines) == [f"0 {values}", f"0 {word:X}", "2"]


def test_every_kind_of_step(words: Device, run_words: Run) -> None:
    """kind, address, mask, value, times, microseconds"""
    steps = [
        "4,32,255,0,1,0",
        "4,33,255,0,1,0",
        "1,32,255,1,1,0",
        "1,33,255,44,1,0",
        "1,34,255,99,1,0",
        "1,16,1,1,1,0",
        "5,16,2,0,1,0",
        "2,0,0,0,0,5000",
    ]
    assert run_words(
        [
            "WASC steps all_steps 12C 63",
            "WASC steps settle",
            "WASC steps all_steps 9 63",
            "WASC steps all_steps 200 63",
            "WASC steps all_steps A 64",
        ]
    ) == [
        " ".join(["0", *steps]),
        "0 5,16,240,48,1,0 4,16,255,0,1,0",
        "4",
        "4",
        "4",
    ]


@pytest.mark.slow
def test_gray_code_follows_its_parameter(words: Device, tmp_path: Path) -> None:
    """The variant contains the run-time state of registers. The initialiser has the register's default, here Gray."""
    code = """#include "test/words_biss.h"
#include "test/words_biss_simulate.h"
#include <stdio.h>
int main(void)
{
    test_words_biss variant = TEST_WORDS_BISS_WBSC;
    test_words_biss_gray_word word = { 1U, 5U, false, 0U };
    uint64_t sent = 0U;
    unsigned pass;
    for (pass = 0U; pass < 2U; pass++) {
        test_words_biss_gray_word back;
        if (test_words_biss_gray_word_set_position(variant, 0x1555U * 3U, &word) != CW_OK ||
            test_words_biss_gray_word_encode(variant, &word, &sent) != CW_OK) {
            return 1;
        }
        const cw_word received = cw_word_of(sent, test_words_biss_gray_word_bits(variant));
        if (test_words_biss_gray_word_decode(variant, received, &back) != CW_OK || back.position != word.position) {
            return 1;
        }
        printf("%llx ", (unsigned long long)(sent >> 17U));
        variant.gray = 0U;
    }
    return 0;
}
"""
    program = compile_c(["gcc", "-std=c99"], code, tmp_path, write(tmp_path, (words,)))
    printed = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout.split()
    number = 0x1555 * 3
    assert printed == [f"{binary_to_gray(number):x}", f"{number:x}"]
