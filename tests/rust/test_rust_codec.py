"""Rust and the model's own codec agree on each value and each error, for every layout, register and order code."""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest
from codewheel.model import Choice, Decimal, Flag, PlacedField, Register, Text, Variant, number_to_bytes
from codewheel.order_codes.run_time import RegisterError, with_registers
from codewheel.plan.crcs import Carrier, Form
from codewheel.plan.run_time_parameters import HoldingRegister
from codewheel.reference import codec
from codewheel.reference.crc import compute_bits, compute_bytes
from rust_frames import Case, cases, check, decoding, first_fault, numbers
from rust_harness import SPECS, Program, Workshop, masks

pytestmark = pytest.mark.slow
#: Number of frames of a layout, over all of its order codes.
FRAMES = 1000


@pytest.fixture(scope="module", params=SPECS)
def program(request: pytest.FixtureRequest, workshop: Workshop) -> Program:
    return workshop.program(request.param)


def test_frames_and_registers(program: Program) -> None:
    kinds = {kind for index in range(len(program.structs)) for kind in decoding(program, index, FRAMES)}
    assert kinds >= {"ok", "length"}
    assert "crc" in kinds or not any(struct.crc for struct in program.structs)


def test_places_of_fields(program: Program) -> None:
    """Fields that an order code lacks are omitted."""
    pairs = []
    for index, _ in enumerate(program.structs):
        for case in cases(program, index):
            placed = ",".join(f"{item.name} {item.low} {item.width}" for item in case.placed.fields)
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
            for part in struct.codec.parts:
                item = case.placed.find_field(part.field.name)
                if item is not None and not isinstance(part.field.kind, (Flag, Text)):
                    for value in _values(item, struct.type_of(part.field), random_):
                        row, expected = case.encoding(sound, item.name, value)
                        pairs.append((f"e {index} {row}", expected))
            for bit in range(max(struct.layout.unused_width + 7, 8) // 8 * 8 if struct.codec.reserved else 0):
                row, expected = case.encoding(sound, codec.UNUSED, 1 << bit)
                pairs.append((f"e {index} {row}", expected))
    check(program, pairs)


def _values(item: PlacedField, type_: str, random_: random.Random) -> list[int]:
    if isinstance(item.field.kind, Choice):
        return [value.value for value in item.field.values]
    bits = int(type_[1:])
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if type_[0] == "i" else (0, (1 << bits) - 1)
    edges = [low, high, 0, 1, item.mask, item.mask + 1, item.mask >> 1, -(item.mask >> 1) - 2]
    if isinstance(item.field.kind, Decimal):
        edges += [item.field.kind.limit - 1, item.field.kind.limit]
    return [value for value in (*edges, random_.randint(low, high)) if low <= value <= high]


def test_what_the_manual_leaves_open_is_asked_for(program: Program) -> None:
    """Order codes have no answer, so frames that depend on one are not decoded or encoded before it is given."""
    asked = 0
    for index, struct in enumerate(program.structs):
        for case in cases(program, index)[: len(struct.codec.alternatives)]:
            number = next(numbers(case, 1, random.Random("asked")))
            row, _ = case.encoding(number, "", 0)
            answers = program.run([f"d {index} {case.wire(number)}", f"e {index} {row}", case.set, f"e {index} {row}"])
            wanted = f"undecided {struct.codec.alternatives[0].name}"
            assert answers[:2] == [wanted, wanted]
            assert answers[3] == case.wire(number).removeprefix("x")
            asked += 1
    assert asked or not program.device.alternatives


def test_frames_are_told_apart(program: Program) -> None:
    """Frames of every kind, with other values of the selecting field and with bytes missing."""
    random_ = random.Random("senders")
    pairs = []
    for place, (interface, told) in enumerate(program.family.dispatches):
        variant = next(item for item in program.device.variants if item.interface == interface.name)
        for index, (owner, struct) in enumerate(program.family.frames):
            if owner is interface and struct.layout.sender == told.sender:
                case = next(item for item in cases(program, index) if item.variant.interface == interface.name)
                wires = [case.wire(number) for number in numbers(case, 300, random_)]
                wires += [wire[: 2 * random_.randrange(8) + 1] for wire in wires[:50]] + ["x"]
                pairs += [(case.set, ""), *((f"s {place} {wire}", _told(program, case, wire)) for wire in wires)]
        assert variant is not None
    check(program, pairs)


def _told(program: Program, case: Case, wire: str) -> str:
    found = codec.decode_bytes(program.device, case.variant, case.struct.layout.sender, bytes.fromhex(wire[1:]))
    if found.problems:
        return first_fault(found.problems)
    assert found.layout is not None
    return found.layout.name


def test_crcs(program: Program) -> None:
    random_ = random.Random("crcs")
    pairs = []
    for index, item in enumerate(program.family.crcs):
        for length in range(33):
            if item.carrier is Carrier.BYTES:
                data = random_.randbytes(length)
                pairs.append((f"c {index} x{data.hex()}", f"{compute_bytes(item.crc, data):X}"))
            else:
                bits = min(2 * length, 64)
                number = random_.getrandbits(bits)
                expected = compute_bits(item.crc, number, 64 if item.form is Form.FOLD else bits)
                pairs.append((f"c {index} {number:X} {bits}", f"{expected:X}"))
    check(program, pairs)


def test_registers_change_the_variant(program: Program) -> None:
    random_ = random.Random("held")
    device, pairs = program.device, []
    for index, item in enumerate(program.family.held):
        contents = list(_contents(item, random_))
        for variant in [one for one in device.variants if one.interface == item.register.interface][:4]:
            case = Case(device, program.structs[0], variant, program.structs[0].layout.place(variant.parameters))
            for data in contents:
                pairs += [(case.set, ""), (f"h {index} x{data.hex()}", _held(program, variant, item.register, data))]
    check(program, pairs)


def _contents(item: HoldingRegister, random_: random.Random) -> Iterator[bytes]:
    """A register with each parameter at its limits and beyond, with any content, and with a wrong length."""
    length = item.register.length
    yield from (random_.randbytes(length) for _ in range(20))
    yield from (bytes(length - 1), bytes(length), bytes(length + 1))
    for held in item.parameters:
        low, high = held.parameter.min or 0, held.parameter.max or 0
        codes = (code.code for code in held.parameter.by_code)
        for value in (low - 1, low, high, high + 1, *codes):
            if 0 <= value < 1 << held.field.widest:
                number = value << held.field.low.constant
                yield number_to_bytes(item.register.layout, number, 8 * length)


def _held(program: Program, variant: Variant, register: Register, data: bytes) -> str:
    if len(data) != register.length:
        return "length"
    try:
        held = {register.address + index: byte for index, byte in enumerate(data)}
        found = with_registers(program.device, variant, held)
    except RegisterError:
        return "range"
    return " ".join(str(found.parameters[item.name]) for item in program.device.parameters)


def test_order_codes(program: Program) -> None:
    device = program.device
    names = [item.name for item in device.parameters]
    asked = {item.name: "none" for item in device.parameters if item.alternative}
    rows = [
        " ".join(
            [item.code, item.interface.capitalize(), *(asked.get(name, str(item.parameters[name])) for name in names)]
        )
        for item in device.variants
    ]
    code = device.variants[-1].code
    answers = program.run(["o", f"f {code}", f"f {code}X"])
    assert [row.rstrip() for row in answers[0].split(";")] == rows
    assert answers[1:] == [f'Some("{code}")', "None"]


def test_constants_of_registers(program: Program) -> None:
    rows = []
    for struct in program.family.registers:
        item = struct.register
        assert item is not None
        data = item.default_bytes()
        shown = [item.address, item.length, str(item.readable).lower(), str(item.writable).lower()]
        shown += ["-" if data is None else data.hex().upper(), *masks(struct).values()]
        rows.append(" ".join(map(str, shown)))
    assert program.run(["r"])[0] == ";".join(rows)
