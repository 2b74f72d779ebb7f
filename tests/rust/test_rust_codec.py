"""Rust and the model's own codec agree on each value and each error, for every layout, register and order code."""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest
from codewheel.model import Choice, Decimal, Flag, PlacedField, Register, Text, Variant, Verdict, number_to_bytes
from codewheel.order_codes.parameters import RegisterError, with_registers
from codewheel.plan.crcs import CoveredData, CrcMethod
from codewheel.plan.frames import HoldingRegister
from codewheel.reference import codec
from codewheel.reference.bits_and_values import compute_bits, compute_bytes
from codewheel.reference.findings import findings
from codewheel_rust.names import pascal
from exhaustive import mostly_exhaustive
from rust_frames import Case, cases, check, decoding, first_fault, numbers
from rust_harness import SPECS, Program, Workshop, masks

pytestmark = pytest.mark.slow
#: Number of frames of a layout, over all of its order codes.
FRAMES = 1000
#: Order codes with one of several CRCs, or none.
BY_CODE = "tests/rust/specs/crc_by_code.yaml"


@pytest.fixture(
    scope="module", params=mostly_exhaustive(SPECS, "specs/lika/amm5.yaml", "tests/c/specs/shapes.yaml", BY_CODE)
)
def program(request: pytest.FixtureRequest, workshop: Workshop) -> Program:
    return workshop.program(request.param)


@pytest.mark.one_in(4, "exhaustive")
def test_frames_and_registers(program: Program) -> None:
    kinds = {kind for index in range(len(program.structs)) for kind in decoding(program, index, FRAMES)}
    assert kinds >= {"ok", "length"}
    assert "crc" in kinds or not any(struct.crcs for struct in program.structs)


def test_positions_are_read_from_buffers(program: Program) -> None:
    """Lines drawn bit by bit, with valid and disturbed frames."""
    random_ = random.Random("buffers")
    pairs = []
    for index, struct in enumerate(program.structs):
        for case in cases(program, index) if struct.position_member else ():
            pairs.append((case.set, ""))
            sent_bits = struct.layout.sent_bits.value(case.variant.parameters)
            for number in numbers(case, 60, random_):
                sent = number % (1 << sent_bits)
                pairs.append((f"x {index} x{line(case, sent).hex()}", reading(case, sent)))
            pairs += [(f"x {index} x{rx.hex()}", fault) for rx, fault in broken_lines(case, number)]
    check(program, pairs)


def line(case: Case, number: int) -> bytes:
    """Return what a receiver stores while the encoder sends a frame."""
    if case.struct.receiver not in LINES:
        return number_to_bytes(case.placed.layout, number, case.placed.bits)
    bits = case.placed.layout.sent_bits.value(case.variant.parameters)
    return packed(LINES[case.struct.receiver].format(word=f"{number:0{bits}b}"))


#: Levels of the data line with a word: idle, acknowledge, start bit and control data; or the clock that stores.
LINES = {"biss": "1110000010{word}0", "ssi": "1{word}0"}


def packed(levels: str) -> bytes:
    filled = levels.ljust(-(-len(levels) // 8) * 8, "1")
    return int(filled, 2).to_bytes(len(filled) // 8, "big")


def broken_lines(case: Case, number: int) -> Iterator[tuple[bytes, str]]:
    """Yield buffers without a frame, and the cause of each."""
    if case.struct.receiver not in LINES:
        rx = line(case, number)
        yield from ((rx[:-1], "length"), (rx + b"\0", "length"))
        return
    size = len(line(case, number)) + 1
    yield bytes([255] * size), "LineHigh"
    yield bytes(size), "LineLow"
    yield line(case, number)[:1], "length" if case.struct.receiver == "ssi" else "NoStart"
    bits = case.placed.layout.sent_bits.value(case.variant.parameters)
    levels = LINES[case.struct.receiver].format(word="0" * bits)
    name = "bit after the word" if case.struct.receiver == "ssi" else "stop bit"
    yield packed(f"{levels[:-1]}1"), f"constant {name}"


def reading(case: Case, number: int) -> str:
    """Return the expected position and verdict, or the reason why there is none."""
    decoded = codec.decode(case.device, case.placed, number)
    if decoded.problems:
        return first_fault(decoded.problems)
    verdict = findings(case.device, case.variant, decoded).verdict
    assert verdict is not None
    if verdict is Verdict.NOT_USABLE:
        return "NotUsable"
    return f"{decoded.values[case.struct.position_member]} {pascal(verdict.value)}"


def test_places_of_fields(program: Program) -> None:
    """Fields that an order code lacks are omitted."""
    pairs = []
    for index, _ in enumerate(program.structs):
        for case in cases(program, index):
            placed = ",".join(f"{field.name} {field.lowest_bit} {field.width}" for field in case.placed.fields)
            pairs += [(case.set, ""), (f"p {index}", placed)]
    check(program, pairs)


def test_what_does_not_fit_is_refused(program: Program) -> None:
    """Each member in turn has the limits of its type and random values, and the others are valid."""
    random_ = random.Random("refused")
    pairs = []
    for index, struct in enumerate(program.structs):
        for case in cases(program, index):
            pairs.append((case.set, ""))
            sound = next(numbers(case, 1, random_))
            for part in struct.codec.decoded_fields:
                placed_field = case.placed.find_field(part.field.name)
                if placed_field is not None and not isinstance(part.field.kind, (Flag, Text)):
                    for value in _values(placed_field, struct.type_of(part.field), random_):
                        row, expected = case.encoding(sound, placed_field.name, value)
                        pairs.append((f"e {index} {row}", expected))
            for bit in range(max(struct.layout.unused_width + 7, 8) // 8 * 8 if struct.codec.reserved else 0):
                row, expected = case.encoding(sound, codec.UNUSED, 1 << bit)
                pairs.append((f"e {index} {row}", expected))
    check(program, pairs)


def _values(placed: PlacedField, type_: str, random_: random.Random) -> list[int]:
    if isinstance(placed.field.kind, Choice):
        return [value.value for value in placed.field.values]
    bit_count = int(type_[1:])
    if type_[0] == "i":
        lowest, highest = -(1 << bit_count - 1), (1 << bit_count - 1) - 1
    else:
        lowest, highest = 0, (1 << bit_count) - 1
    candidates = [lowest, highest, 0, 1, placed.mask, placed.mask + 1, placed.mask >> 1, -(placed.mask >> 1) - 2]
    if isinstance(placed.field.kind, Decimal):
        candidates += [placed.field.kind.limit - 1, placed.field.kind.limit]
    return [value for value in (*candidates, random_.randint(lowest, highest)) if lowest <= value <= highest]


def test_what_the_manual_leaves_open_is_asked_for(program: Program) -> None:
    """Order codes have no answer, so frames that depend on one are not decoded or encoded before it is given."""
    undecided_frames = 0
    for index, struct in enumerate(program.structs):
        for case in cases(program, index)[: len(struct.codec.alternatives)]:
            number = next(numbers(case, 1, random.Random("asked")))
            row, _ = case.encoding(number, "", 0)
            answers = program.run([f"d {index} {case.wire(number)}", f"e {index} {row}", case.set, f"e {index} {row}"])
            expected = f"undecided {struct.codec.alternatives[0].name}"
            assert answers[:2] == [expected, expected]
            assert answers[3] == case.wire(number).removeprefix("x")
            undecided_frames += 1
    assert undecided_frames or not program.device.alternatives


def test_frames_are_told_apart(program: Program) -> None:
    """Frames of every kind, with other values of the selecting field and with bytes missing."""
    random_ = random.Random("senders")
    pairs = []
    for place, (interface, dispatch) in enumerate(program.family.dispatches):
        variant = next(variant for variant in program.device.variants if variant.interface == interface.name)
        for index, (owner, struct) in enumerate(program.family.frames):
            if owner is interface and struct.layout.sender == dispatch.sender:
                case = next(case for case in cases(program, index) if case.variant.interface == interface.name)
                wires = [case.wire(number) for number in numbers(case, 300, random_)]
                wires += [wire[: 2 * random_.randrange(8) + 1] for wire in wires[:50]] + ["x"]
                pairs += [
                    (case.set, ""),
                    *((f"s {place} {wire}", expected_layout(program, case, wire)) for wire in wires),
                ]
        assert variant is not None
    check(program, pairs)


def expected_layout(program: Program, case: Case, wire: str) -> str:
    decoded = codec.decode_bytes(program.device, case.variant, case.struct.layout.sender, bytes.fromhex(wire[1:]))
    if decoded.problems:
        return first_fault(decoded.problems)
    assert decoded.layout is not None
    return decoded.layout.name


def test_crcs(program: Program) -> None:
    random_ = random.Random("crcs")
    pairs = []
    for index, function in enumerate(program.family.crcs):
        for length in range(33):
            if function.covered_data is CoveredData.BYTES:
                data = random_.randbytes(length)
                pairs.append((f"c {index} x{data.hex()}", f"{compute_bytes(function.crc, data):X}"))
            else:
                bits = min(2 * length, 64)
                number = random_.getrandbits(bits)
                expected = compute_bits(function.crc, number, 64 if function.method is CrcMethod.FOLD else bits)
                pairs.append((f"c {index} {number:X} {bits}", f"{expected:X}"))
    check(program, pairs)


def test_registers_change_the_variant(program: Program) -> None:
    random_ = random.Random("held")
    device, pairs = program.device, []
    for index, effect in enumerate(program.family.held):
        contents = list(_contents(effect, random_))
        for variant in [variant for variant in device.variants if variant.interface == effect.register.interface][:4]:
            case = Case(device, program.structs[0], variant, program.structs[0].layout.place(variant.parameters))
            for data in contents:
                pairs += [
                    (case.set, ""),
                    (f"h {index} x{data.hex()}", expected_parameters(program, variant, effect.register, data)),
                ]
    check(program, pairs)


def _contents(effect: HoldingRegister, random_: random.Random) -> Iterator[bytes]:
    """A register with each parameter at its limits and beyond, with any content, and with a wrong length."""
    length = effect.register.length
    yield from (random_.randbytes(length) for _ in range(20))
    yield from (bytes(length - 1), bytes(length), bytes(length + 1))
    for derived in effect.parameters:
        low, high = derived.parameter.min or 0, derived.parameter.max or 0
        codes = (code.code for code in derived.parameter.by_code)
        for value in (low - 1, low, high, high + 1, *codes):
            if 0 <= value < 1 << derived.field.widest:
                number = value << derived.field.low.constant
                yield number_to_bytes(effect.register.layout, number, 8 * length)


def expected_parameters(program: Program, variant: Variant, register: Register, data: bytes) -> str:
    if len(data) != register.length:
        return "length"
    try:
        contents = {register.address + index: byte for index, byte in enumerate(data)}
        changed_variant = with_registers(program.device, variant, contents)
    except RegisterError:
        return "range"
    return " ".join(str(changed_variant.parameters[parameter.name]) for parameter in program.device.parameters)


def test_order_codes(program: Program) -> None:
    device = program.device
    parameter_names = [parameter.name for parameter in device.parameters]
    open_questions = {alternative.name for alternative in device.alternatives if not alternative.default}
    undecided = [parameter.name for parameter in device.parameters if parameter.alternative in open_questions]
    text_of_undecided = dict.fromkeys(undecided, "none")
    interfaces = [interface.name for interface in device.interfaces]
    expected_rows = []
    for variant in sorted(device.variants, key=lambda variant: interfaces.index(variant.interface)):
        parameter_texts = [text_of_undecided.get(name, str(variant.parameters[name])) for name in parameter_names]
        expected_rows.append(" ".join([variant.code, variant.interface.capitalize(), *parameter_texts]))
    code, interface = device.variants[-1].code, device.variants[-1].interface
    answers = program.run(["o", f"f {code}", f"f {code}X"])
    assert [row.rstrip() for row in answers[0].split(";")] == expected_rows
    interface_texts = [name.capitalize() if name == interface else "-" for name in interfaces]
    assert answers[1:] == [" ".join(interface_texts), " ".join("-" for _ in interfaces)]


def test_constants_of_registers(program: Program) -> None:
    rows = []
    for struct in program.family.registers:
        register = struct.register
        assert register is not None
        data = register.default_bytes()
        constants = [register.address, register.length, str(register.readable).lower(), str(register.writable).lower()]
        constants += ["-" if data is None else data.hex().upper(), *masks(struct).values()]
        rows.append(" ".join(map(str, constants)))
    assert program.run(["r"])[0] == ";".join(rows)
