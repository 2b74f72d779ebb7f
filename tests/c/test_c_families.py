"""Every family in C against the model: examples, procedures, order codes, positions, identity, run-time state."""

from __future__ import annotations

import random
import shutil
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Literal

import pytest
from c_harness import SPECS, MadeOnce, Run, devices_of, functions, program_over
from codewheel.loading.examples import decode_example, example_variant
from codewheel.model import (
    CodePart,
    CrcExample,
    CrcValue,
    Device,
    Example,
    Field,
    FrameExample,
    Interface,
    MeasureExample,
    Measurement,
    ModifyStep,
    PollStep,
    Procedure,
    ProcedureExample,
    ReadStep,
    Register,
    RegisterExample,
    SendStep,
    Variant,
    WaitStep,
    Write,
    WriteStep,
    assert_never,
    number_from_bytes,
    number_to_bytes,
)
from codewheel.model.expressions import Expression
from codewheel.order_codes.labels import UnknownOrderCode, find_code
from codewheel.order_codes.parameters import RegisterError, with_registers
from codewheel.reference.bits_and_values import binary_to_gray
from codewheel.reference.codec import EncodeError, decode
from codewheel.reference.registers import register_writes
from codewheel.targets.c.device import DeviceView, views_of
from codewheel.targets.c.order_codes import patterns_of_expression
from test_c_codec import FAULTS, Table, check, register_bytes, run_time_variants

Family = tuple[Device, Run]


# -- worked examples


def test_every_worked_example(family: Family) -> None:
    device, run = family
    table = Table(device)
    pairs = [pair for example in device.examples for pair in example_lines(table, example)]
    check(run, pairs)
    crcs = [example.crc for example in device.examples if isinstance(example, CrcExample)]
    unused = [crc for crc in crcs if not [*crc_users(device, crc)]]
    assert len(pairs) >= len(device.examples) - len(unused)
    assert len(unused) <= 1, "the CRC of BiSS register accesses, which the runtime computes"


def example_lines(table: Table, example: Example) -> Iterable[tuple[str, str]]:
    device = table.device
    variant = example_variant(device, example)
    match example:
        case CrcExample():
            users = {interface.name: interface for interface in crc_users(device, example.crc)}
            for code in [variant.code for variant in device.variants if variant.interface in users][:1]:
                yield f"{code} crc {example.crc} {example.bytes.hex().upper()}", f"0 {example.check}"
        case MeasureExample():
            yield (
                f"{variant.code} measure micrometres {example.counts}",
                f"0 {example.micrometres}",
            )
        case ProcedureExample():
            procedure = device.procedure(example.procedure)
            values = [example.arguments[argument.name] for argument in procedure.arguments]
            yield (
                f"{variant.code} steps {procedure.name} {' '.join(f'{value:X}' for value in values)}",
                steps_text(device, procedure, variant, example.arguments),
            )
        case RegisterExample():
            yield from register_lines(table, variant, device.register(example.register), example.bytes)
        case FrameExample():
            yield frame_line(table, variant, example)
        case _:
            assert_never(example)


def crc_users(device: Device, crc: str) -> Iterable[Interface]:
    """Return the interfaces with a frame that ends in this CRC. If there are no users, C has no function for it."""
    for interface, layout in device.layouts():
        if any(isinstance(field.kind, CrcValue) and field.kind.crc == crc for field in layout.fields):
            yield interface


def register_lines(table: Table, variant: Variant, register: Register, data: bytes) -> Iterable[tuple[str, str]]:
    name = f"reg_{register.name}"
    if name not in table.members:
        # One byte with a single value has no struct. The byte itself is the decoded value.
        decoded = decode(table.device, register.layout.place(variant.parameters), data[0])
        assert not decoded.problems
        assert decoded.fields[0].raw == data[0]
        yield f"{variant.code} find", f"{variant.code} 0"
        return
    placed = register.layout.place(variant.parameters)
    row = table.row(name, placed, number_from_bytes(placed.layout, data))
    yield f"{variant.code} decode {name} {data.hex()}", f"0 {row}"
    if register.writable:
        yield f"{variant.code} encode {name} {row}", f"0 {data.hex().upper()}"


def frame_line(table: Table, variant: Variant, example: FrameExample) -> tuple[str, str]:
    decoded = decode_example(table.device, example, variant)
    name = decoded.layout.name if decoded.layout is not None else ""
    wire = f"{int(example.bits, 2):X}" if example.bits else example.bytes.hex().upper()
    state = [f";{question}={answer:02X}" for question, answer in answers(table.device, example)]
    label = "".join([variant.code, *state])
    if example.refused:
        return f"{label} decode {name} {wire}", str(FAULTS[example.refused])
    assert decoded.layout is not None
    return f"{label} decode {name} {wire}", f"0 {table.row(name, decoded.layout, decoded.number)}"


def answers(device: Device, example: FrameExample) -> Iterable[tuple[str, int]]:
    """Return the answers that an example takes, each as its index among those of its alternative."""
    for alternative in device.alternatives:
        if alternative.name in example.alternatives:
            names = [answer.name for answer in alternative.answers]
            yield alternative.name, names.index(example.alternatives[alternative.name])


def test_an_offset_takes_the_whole_position_field(family: Family) -> None:
    """F0 00 00h is the highest offset at 50 µm (6.4 p.32).

    The position 123 is then sent as F0 00 7Bh, in all 24 bits of the field.
    """
    device, run = family
    if device.name != "sma21":
        return
    frame = "F0007BE4"
    states = ("", ";configuration=20", ";configuration=22")
    lines = [f"SMA21-SC1-0050{state} decode single_cycle_data {frame}" for state in states]
    assert run(lines)[:2] == [str(FAULTS["constant"])] * 2
    assert run(lines)[2] == f"0 {0xF0007B} 0 0"


def test_an_encoder_id_is_held_against_the_one_that_the_manual_states(family: Family) -> None:
    """AMM5 7.4 p.43 prints ENID 23h. The second reply has 17h, as T-format encoders of 23 bits usually do.
    The last two have 23h, and one has an information bit that 7.3.2 p.42 calls not used."""
    device, run = family
    if device.name != "amm5":
        return
    replies = ("encoder_id_reply 920023B1", "encoder_id_reply 92001785", "complete_reply 1A00A5A50017888800000D")
    replies += (
        "encoder_id_reply 920123B0",
        "complete_reply 1A00A5A500238888000039",
        "complete_reply 1A01A5A500238888000038",
    )
    printed = list(run(f"AMM5A23/65KJP1 expected {reply}" for reply in replies))
    assert printed == ["0 1", "0 0", "0 0", "0 0", "0 1", "0 0"]


# -- procedures


def test_procedures_take_the_steps_of_the_model(family: Family) -> None:
    device, run = family
    pairs = []
    for procedure in device.procedures:
        for variant in device.variants:
            if variant.interface == procedure.interface:
                for values in arguments(device, procedure, variant):
                    numbers = " ".join(f"{values[argument.name]:X}" for argument in procedure.arguments)
                    pairs.append(
                        (
                            f"{variant.code} steps {procedure.name} {numbers}".rstrip(),
                            steps_text(device, procedure, variant, values),
                        )
                    )
    check(run, pairs)
    answers = {expected.split(" ")[0] for _, expected in pairs}
    possible = {"0", "4"} if any(procedure.arguments for procedure in device.procedures) else {"0"}
    assert answers == (possible if device.procedures else set())


def arguments(device: Device, procedure: Procedure, variant: Variant) -> Iterable[Mapping[str, int]]:
    """Yield values for a call: each argument at its limits and beyond them, with allowed values for the others."""
    allowed_values, refused_values = {}, {}
    for argument in procedure.arguments:
        register = device.register(argument.of)
        minimum, maximum = device.limits(register, argument.meant_as)
        lowest = minimum.value(variant.parameters) if minimum is not None else 0
        above_register = 1 << 8 * register.length
        highest = maximum.value(variant.parameters) if maximum is not None else above_register - 1
        if register.layout.fields[0].number.power_of_two:
            inside, outside = [lowest or 1, highest], [lowest - 1, highest + 1, 3]
        else:
            inside, outside = [lowest, lowest + 1, highest, highest // 3], [lowest - 1, highest + 1]
        allowed_values[argument.name] = [value for value in inside if value <= highest]
        refused_values[argument.name] = [value for value in outside if 0 <= value < above_register]
    first_allowed_values = {name: values[0] for name, values in allowed_values.items()}
    yield first_allowed_values
    for name, values in allowed_values.items():
        for value in (*values, *refused_values[name]):
            yield {**first_allowed_values, name: value}


#: Number of bytes of the reply to each request of a procedure: AMM5 7.3.2, SMA21 7.3.2.
REPLIES = {"amm5": 6, "sma21": 7}


def steps_text(device: Device, procedure: Procedure, variant: Variant, values: Mapping[str, int]) -> str:
    """Return kind, address, mask, value, times, microseconds of each step, or the error.

    Readable registers are read back before a write to a write-only register (a command, or a register that closes), and
    before the same register is written again as a whole.
    """
    try:
        writes = list(register_writes(device, procedure, variant, values))
    except EncodeError:
        return str(FAULTS["range"])
    rows: list[tuple[int, ...]] = []
    written: list[tuple[int, ...]] = []
    for step in procedure.steps:
        match step:
            case WaitStep():
                rows.append((2, 0, 0, 0, 0, step.microseconds))
            case SendStep():
                rows.append((3, REPLIES[device.name], 255, step.request[0], step.times, step.microseconds))
            case ReadStep():
                register = device.register(step.register)
                rows += [(4, register.address + index, 255, 0, 1, 0) for index in range(register.length)]
            case PollStep():
                register = device.register(step.register)
                value = step.value << register.layout.field(step.field).low.constant
                rows += byte_rows(5, register, register_mask(register, step.field), value)
            case WriteStep() | ModifyStep():
                register = device.register(step.register)
                mask = register_mask(register, step.field if isinstance(step, ModifyStep) else "")
                closes = (step.register, step.value) == ("preset_setting_enable", 0)
                step_rows = list(byte_rows(6 if closes else 1, register, mask, writes_number(writes, register)))
                again = isinstance(step, WriteStep) and bool(_addresses(step_rows) & _addresses(written))
                if register.access == "write_only" or again:
                    rows += [(7, *row[1:]) for row in written]
                    written = []
                if register.access != "write_only":
                    written += step_rows
                rows += step_rows
            case _:
                assert_never(step)
    return " ".join(["0", *(",".join(map(str, row)) for row in rows)])


def _addresses(rows: Iterable[tuple[int, ...]]) -> set[int]:
    return {row[1] for row in rows}


def byte_rows(kind: int, register: Register, mask: int, number: int) -> Iterable[tuple[int, ...]]:
    """Return the bytes of a register that a step touches."""
    data = zip(register.bytes_of(mask), register.bytes_of(number), strict=True)
    for address, (bits, value) in enumerate(data, register.address):
        if bits:
            yield kind, address, bits, value & bits, 1, 0


def order(register: Register) -> Literal["little", "big"]:
    return "little" if register.byte_order == "low_byte_first" else "big"


def register_mask(register: Register, name: str) -> int:
    if not name:
        return (1 << 8 * register.length) - 1
    field = register.layout.field(name)
    return ((1 << field.widest) - 1) << field.low.constant


def writes_number(writes: list[Write], register: Register) -> int:
    """Return the next bytes that the model writes, as the register's number."""
    next_writes = [writes.pop(0) for _ in range(register.length)]
    return int.from_bytes(bytes(write.value for write in next_writes), order(register))


# -- order codes


def labels(device: Device, random_: random.Random) -> Iterable[str]:
    """Every order code, correct and with one wrong part, with allowed and forbidden text after it."""
    for variant in device.variants:
        code = variant.code
        yield from (
            code,
            code.lower(),
            f"{code}-",
            f"{code}-X1/S123",
            f"{code}/S12b",
            f"{code}/S",
            f"{code}/S1-2",
            f"{code}/T1",
            f"{code}0",
            code[:-1],
        )
        for index in range(len(code)):
            yield code[:index] + random_.choice("0123456789ABCX/-") + code[index + 1 :]
    parts = device.order_code.parts
    for _ in range(400):
        chosen = {part.name: random_.choice(_texts(part, random_)) for part in parts}
        text = device.order_code.pattern
        for name, value in chosen.items():
            text = text.replace("{" + name + "}", value)
        yield text + random_.choice(["", "-abc", "/S7"])
    for spelling in device.order_code.also_written:
        for _ in range(200):
            text = spelling.pattern
            for part in parts:
                spelled = [value.text for value in spelling.values if value.part == part.name]
                text = text.replace("{" + part.name + "}", random_.choice(spelled or _texts(part, random_)))
            yield text + random_.choice(["", "1", "2", "12", "-abc", "3-abc", "X"])


def _texts(part: CodePart, random_: random.Random) -> list[str]:
    """Return the texts that a part of an order code can have."""
    return [*(value.text for value in part.values), *samples_of(part.open, random_)]


def samples_of(expression: str, random_: random.Random) -> list[str]:
    """Return texts that an expression describes: digits for ``#``, and one digit or none for ``~``."""
    choices = {"#": [*"0123456789"], "~": ["", *"0123456789"]}
    texts = []
    for pattern in patterns_of_expression(expression) if expression else ():
        letters = [choices.get(letter, [letter]) for letter in pattern]
        texts += ["".join(map(random_.choice, letters)) for _ in range(3)]
    return texts


def test_order_codes_are_found_as_in_the_model(family: Family) -> None:
    device, run = family
    open_parts = [part.name for part in device.order_code.parts if part.open]
    random_ = random.Random("labels")
    request_and_expected = []
    for label in dict.fromkeys(labels(device, random_)):
        try:
            match = find_code(device, label)
        except UnknownOrderCode:
            request_and_expected.append((f"{label} find", "-"))
            continue
        listed_parts = {name: text for name, text in match.variant.parts.items() if name not in match.unlisted}
        stands_for = next(variant for variant in device.variants if listed_parts.items() <= variant.parts.items())
        unlisted_mask = sum(1 << open_parts.index(name) for name in match.unlisted)
        request_and_expected.append((f"{label} find", f"{stands_for.code} {unlisted_mask}"))
        assert stands_for.parameters == match.variant.parameters
        assert stands_for.interface == match.variant.interface
    c_answers = run(request for request, _ in request_and_expected)
    differing = []
    for (request, expected), answer in zip(request_and_expected, c_answers, strict=True):
        if answer.removesuffix(" 0" if expected == "-" else "\0") != expected:
            differing.append((request, expected, answer))
    assert not differing, differing[:5]
    assert bool(open_parts) == any(not expected.endswith((" 0", "-")) for _, expected in request_and_expected)


def test_an_open_part_before_a_digit_is_found_as_in_the_model(made_once: MadeOnce, tmp_path: Path) -> None:
    """In GR57, the 7 is the interface, and 5 the number of bits."""
    text = (SPECS / "gray.yaml").read_text(encoding="utf-8").replace("GR{interface}", "GR{bits}{interface}")
    part = '{name: bits, meaning: Bits, open: "[0-9]{1,2}", values: {"13": {meaning: 13 bits}}}'
    text = text.replace("  parts:\n", f"  parts:\n    - {part}\n", 1).replace("        GG: {", '        "7": {', 1)
    text = text.replace("GRGG", "GR137")
    shutil.copy(SPECS / "manufacturer.yaml", tmp_path)
    (tmp_path / "gray.yaml").write_text(text, encoding="utf-8")
    (device,) = devices_of(tmp_path)
    run = program_over(device, made_once, "open_before_digit")
    labels = ("GR137", "GR57", "GR577", "GR7", "GR5777", "GR57-7")
    assert run(f"{label} find" for label in labels) == ["GR137 0", "GR137 1", "GR137 1", "- 0", "- 0", "GR137 1"]
    test_order_codes_are_found_as_in_the_model((device, run))


@pytest.mark.parametrize(
    ("expression", "patterns"),
    [
        ("[0-9]", ("#",)),
        ("[0-9]{2}", ("##",)),
        ("[0-9]{1,5}", ("#~~~~",)),
        ("17", ("17",)),
        ("A|[A-Z]{2}|B[0-9]?", ("@@", "B~", "A")),
        ("[0-9]{1,2}K", ("##K", "#K")),
        (r"\d[0-9A-Z]", ("#%",)),
        ("(a|b)", ()),
        ("[^0]", ()),
        ("[0-9]*", ()),
        (".", ()),
    ],
)
def test_open_parts_are_patterns_of_expression(expression: str, patterns: tuple[str, ...]) -> None:
    assert patterns_of_expression(expression) == patterns


# -- positions


def formula(measurement: Measurement) -> tuple[Expression | None, ...]:
    return measurement.counts_per_turn, measurement.turns, measurement.step_um, measurement.modulus


def test_positions_mean_what_the_model_says(family: Family) -> None:
    device, run = family
    random_ = random.Random("positions")
    pairs = []
    for variant in (*device.variants, *run_time_variants(device)):
        measurement = device.measurement_of(variant.interface)
        if measurement is None:  # Its spec does not state the size of a count.
            assert device.name == "icmu"
            continue
        start = f"{variant.code} measure "
        expressions = dict(zip(("per_turn", "turns", "um", "steps"), formula(measurement), strict=True))
        given_sizes = {name: size for name, size in expressions.items() if size is not None}
        parts = {name: size.value(variant.parameters) for name, size in given_sizes.items()}
        modulus = parts["steps"] if "steps" in parts else parts["per_turn"] * parts["turns"]
        # The replies of one family have different ranges.
        range_prefix = "position_reply_" if (device.name, variant.interface) == ("sma21", "rs485") else ""
        pairs.append((f"{start}{range_prefix}modulus", f"0 {modulus}"))
        for position in (0, 1, modulus - 1, modulus // 2, random_.randrange(modulus)):
            if "um" in parts:
                pairs.append((f"{start}micrometres {position}", f"0 {position * parts['um']}"))
                pairs.append((f"{start}millimetres {-position}", f"0 {-position * parts['um'] / 1000 + 0.0:.17g}"))
            else:
                pairs.append((f"{start}turns {position}", f"0 {position / parts['per_turn']:.17g}"))
                pairs.append(
                    (f"{start}degrees {position}", f"0 {position % parts['per_turn'] * 360 / parts['per_turn']:.17g}")
                )
            for before in (
                0,
                1,
                modulus - 1,
                modulus // 2,
                (position + modulus // 2) % modulus,
                random_.randrange(modulus),
            ):
                nearest = (position - before + modulus // 2) % modulus - modulus // 2
                pairs.append((f"{start}{range_prefix}position_difference {position} {before}", f"0 {nearest}"))
    check(run, pairs)


def test_each_reply_has_its_own_distance(programs: Mapping[str, Run]) -> None:
    """SMA21 7.3.3: 48 bits in two's complement never wrap around. The identification has the range of the position."""
    lines = [
        "SMA21-JP1-0001 measure wide_position_reply_position_difference 10000000 0",
        "SMA21-JP1-0001 measure wide_position_reply_position_difference 0 10000000",
        "SMA21-JP1-0001 measure identification_reply_modulus",
        "SMA21-JP1-0001 measure identification_reply_position_difference 1 16777215",
    ]
    assert programs["sma21"](lines) == ["0 10000000", "0 -10000000", f"0 {1 << 24}", "0 2"]


def test_a_turn_has_two_to_the_n_counts(programs: Mapping[str, Run]) -> None:
    lines = [
        "AMM5A17/1BG1 measure degrees 65536",
        "AMM5A17/1BG1 measure turns 131071",
        "AMM5A17/1BG1 measure position_difference 2 131070",
        "AMM5A17/1BG1 measure position_difference 131070 2",
    ]
    assert programs["amm5"](lines) == ["0 180", f"0 {131071 / 131072:.17g}", "0 4", "0 -4"]


def test_revolutions_that_are_no_power_of_two_roll_over_where_they_end(
    programs: Mapping[str, Run], every_device: Mapping[str, Device]
) -> None:
    ssi = next(variant.code for variant in every_device["am36"].variants if variant.interface == "ssi")
    state = "AM3616/4096-I7;number_of_revolutions=07d0;singleturn_bits_used=0d"
    lines = [
        f"{state} measure modulus",
        f"{state} measure position_difference 5 {2000 * 8192 - 1}",
        f"{ssi} measure modulus",
        "AM3616/4096-I7 measure modulus",
    ]
    assert programs["am36"](lines) == [f"0 {2000 * 8192}", "0 6", f"0 {1 << 28}", f"0 {1 << 36}"]


def test_small_functions_agree_with_their_expressions(family: Family) -> None:
    """Parameters that follow from others, and limits that depend on the order code or on the meaning of a register."""
    whole, run = family
    for view in views_of(whole):
        small_functions_agree(view, run)


def small_functions_agree(view: DeviceView, run: Run) -> None:
    device = view.device
    formulas = {parameter.name: parameter.equals for parameter in device.parameters}
    wanted: dict[str, Expression] = {name: formula for name, formula in formulas.items() if formula is not None}
    for register in device.registers:
        bounds = {f"reg_{register.name}_min": register.min, f"reg_{register.name}_max": register.max}
        for meaning in register.meanings:
            bounds |= {
                f"reg_{register.name}_{meaning.name}_min": meaning.min,
                f"reg_{register.name}_{meaning.name}_max": meaning.max,
            }
        wanted |= {name: bound for name, bound in bounds.items() if bound is not None and not bound.is_constant}
    assert set(wanted) <= {function.name.removeprefix(view.prefix + "_") for function in functions(view)}
    pairs: list[tuple[str, str]] = []
    for variant in (*device.variants, *run_time_variants(device)):
        parameters = variant.parameters
        pairs += [(f"{variant.code} measure {name}", f"0 {size.value(parameters)}") for name, size in wanted.items()]
    check(run, pairs)


# -- identification


def _read_identity(registers: Sequence[Register], variant: Variant) -> list[bytes]:
    return [identity_bytes(register, variant) for register in registers]


def test_candidates_are_the_order_codes_that_read_so(family: Family) -> None:
    device, run = family
    identities = [identity for view in views_of(device) for identity in view.identities]
    if device.name == "icmu":  # Its registers do not tell order codes apart.
        assert identities == []
        return
    (identity,) = identities
    registers = [part.register for part in identity.compared_registers]
    pairs = []
    variants = [variant for variant in device.variants if variant.interface == registers[0].interface]
    for variant in variants:
        read = _read_identity(registers, variant)
        same_identity = [listed.code for listed in variants if _read_identity(registers, listed) == read]
        assert variant.code in same_identity
        pairs.append(
            (f"{variant.code} candidates of {' '.join(data.hex() for data in read)}", " ".join(["0", *same_identity]))
        )
        for index in range(len(registers)):
            changed = [*read[:index], bytes([read[index][0] ^ 1, *read[index][1:]]), *read[index + 1 :]]
            pairs.append((f"{variant.code} candidates of {' '.join(data.hex() for data in changed)}", "0"))
    check(run, pairs)


def identity_bytes(register: Register, variant: Variant) -> bytes:
    number = 0
    for field in register.layout.fields:
        number |= expected_raw(field, variant) << field.low.constant
    return number_to_bytes(register.layout, number, 8 * register.length)


def expected_raw(field: Field, variant: Variant) -> int:
    if isinstance(field.equals, str):
        return int.from_bytes(field.equals.encode(), "big")
    if isinstance(field.equals, Expression):
        return field.equals.value(variant.parameters)
    return field.equals if field.equals is not None else int.from_bytes(b"7" * (field.widest // 8), "big")


def test_the_profile_id_tells_the_resolution(programs: Mapping[str, Run]) -> None:
    answer = programs["sma21"](["SMA21-SC1-0001 candidates of 2816 0A 08 00 534D32313031 4C69"])
    assert answer == ["0 SMA21-SC1-0010 SMA21-SC4-0010"]


# -- run-time state


def test_registers_are_taken_over_as_in_the_model(
    programs: Mapping[str, Run], every_device: Mapping[str, Device]
) -> None:
    for name in ("am36", "sma21", "words", "shapes"):
        device = every_device[name]
        random_ = random.Random(name)
        pairs = []
        held_by = {parameter.register for parameter in device.run_time_parameters}
        assert held_by
        interface = device.register(next(iter(held_by))).interface
        variant = next(variant for variant in device.variants if variant.interface == interface)
        for register in map(device.register, sorted(held_by)):
            texts = (
                [random_.randbytes(register.length) for _ in range(40)]
                + [register_bytes(device, register, random_) for _ in range(10)]
                + [bytes(register.length), b"\xff" * register.length]
            )
            for data in texts:
                try:
                    with_registers(device, variant, {register.address + index: byte for index, byte in enumerate(data)})
                    expected = "0 "
                except RegisterError:
                    expected = "4 "
                pairs.append((f"{variant.code};{register.name}={data.hex()} take", expected))
            pairs.append((f"{variant.code};{register.name}={'00' * (register.length + 1)} take", "1 "))
        check(programs[name], pairs)


def test_a_shorter_frame_after_a_new_resolution(programs: Mapping[str, Run]) -> None:
    """The BiSS frame of 13 + 4 bits, in Gray code and in binary."""
    run = programs["am36"]
    position = 5 << 13 | 77
    for configuration, sent_position in (("00", binary_to_gray(position)), ("20", position)):
        state = f"AM3616/4096-I7;configuration={configuration};singleturn_bits_used=0d;multiturn_bits_used=04"
        (encoded,) = run([f"{state} encode single_cycle_data 5 77 {position} 0"])
        word = int(encoded.split()[1], 16)
        assert word >> 8 == sent_position
        assert word >> 6 & 3 == 3
        assert run(
            [f"{state} decode single_cycle_data {word:X}", f"{state} decode single_cycle_data {word | 1 << 25:X}"]
        ) == [f"0 5 77 {position} 0", "1"]


# -- single keywords of the language


def test_only_powers_of_two_are_encoded(programs: Mapping[str, Run]) -> None:
    values = (0, 1, 3, 4096, 0x100000, 0x200000)
    lines = [f"AM3616/4096-I7 encode reg_information_per_revolution {value}" for value in values]
    assert [answer.split()[0] for answer in programs["am36"](lines)] == ["4", "0", "4", "0", "0", "4"]


def test_zero_stands_for_65536_revolutions(programs: Mapping[str, Run]) -> None:
    lines = [
        "AM3616/4096-I7 decode reg_number_of_revolutions 0000",
        "AM3616/4096-I7 encode reg_number_of_revolutions 65536",
        "AM3616/4096-I7 encode reg_number_of_revolutions 0",
    ]
    assert programs["am36"](lines) == ["0 65536", "0 0000", "4 0000"]


def test_preset_and_offset_have_limits_of_their_own(programs: Mapping[str, Run]) -> None:
    """0FFFFFh and F00000h at 50 um, 01FFFFFFh and 0 at 1 um."""
    attempts = (
        ("0050", "set_preset", 0xFFFFF),
        ("0050", "set_preset", 0x100000),
        ("0050", "set_offset", 0xF00000),
        ("0050", "set_offset", 0xF00001),
        ("0001", "set_preset", 0x1FFFFFF),
        ("0001", "set_preset", 0x2000000),
        ("0001", "set_offset", 0),
        ("0001", "set_offset", 1),
    )
    lines = [f"SMA21-SC1-{code} steps {name} {value:X}" for code, name, value in attempts]
    assert [answer[0] for answer in programs["sma21"](lines)] == ["0", "4", "0", "4", "0", "4", "0", "4"]
