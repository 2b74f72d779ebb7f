"""Plans of two small specs, with every operation derived by hand from the spec and the definitions of the operations.

Generated code of real encoders shows that plans are useful. Here a wrong plan is seen without generating anything.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from codewheel.loading.library import load_library
from codewheel.model import BitSlice, Device, Fault, Rs485
from codewheel.one_line.spec import device_of_line
from codewheel.plan.codec import (
    LayoutPlan,
    ShiftedBits,
    _bits_at_end,
    group_reserved_bits_by_shift,
    layout_plan_of,
)
from codewheel.plan.frames import (
    Reply,
    dispatches,
    exchanges,
    held_parameters,
    received_sizes,
    reply_to,
    reply_to_data_id,
)
from codewheel.plan.limits import limits_check_of, limits_of, powers_of_two, refusals
from codewheel.plan.operations import (
    AlwaysIs,
    AtMost,
    ConstantNumber,
    IsOneOf,
    ParityIs,
    ParityOf,
    ReservedBits,
    ValueOfField,
)
from codewheel.plan.procedures import plan_procedure
from codewheel.plan.steps import (
    AsMember,
    FixedNumber,
    InField,
    MasterCall,
    PlannedStep,
    ProcedurePlan,
    VerifyWrite,
    WriteRegister,
    bits_by_byte,
)
from codewheel.plan.values import UnsignedNumber, count_factors, position_ranges

TESTS = Path(__file__).resolve().parents[1]


def load(folder: Path) -> Device:
    devices, report = load_library([folder])
    assert not report.problems
    return devices[0]


@pytest.fixture(scope="module")
def small() -> Device:
    return load(TESTS / "plan" / "specs")


@pytest.fixture(scope="module")
def by_hand() -> Device:
    return load(TESTS / "reference" / "specs")


def plan(device: Device, layout: str) -> LayoutPlan:
    return layout_plan_of(device, device.layout(layout))


def rs485_of(device: Device) -> Rs485:
    interface = device.interface("rs485")
    assert isinstance(interface, Rs485)
    return interface


# -- procedures


def summary(operation: PlannedStep) -> tuple[str, str, str, list[BitSlice]]:
    """Return the kind of an operation, its register, its field, and its bytes."""
    register, field = getattr(operation, "register", None), getattr(operation, "field", None)
    names = (register.name if register is not None else "", field.name if field is not None else "")
    return (type(operation).__name__, *names, list(getattr(operation, "bit_slices", ())))


ONE_BYTE = [BitSlice(0, 0, 0xFF, 0)]
#: The high byte is at the lower address.
TWO_BYTES = [BitSlice(0, 0, 0xFF, 8), BitSlice(1, 0, 0xFF, 0)]


@pytest.fixture(scope="module")
def run(small: Device) -> ProcedurePlan:
    return plan_procedure(small, small.procedure("set_preset"))


def test_operations_of_a_procedure(run: ProcedurePlan) -> None:
    """The command cannot be read, so everything written before is read back first. The key closes the preset."""
    bit_7, bit_2 = [BitSlice(0, 7, 1, 0)], [BitSlice(0, 2, 1, 0)]
    assert list(map(summary, run.operations)) == [
        ("WriteRegister", "key", "", ONE_BYTE),
        ("WriteRegister", "preset", "", TWO_BYTES),
        ("WriteRegister", "level", "speed", bit_7),
        ("VerifyWrite", "key", "", ONE_BYTE),
        ("VerifyWrite", "preset", "", TWO_BYTES),
        ("VerifyWrite", "level", "speed", bit_7),
        ("WriteRegister", "command", "", ONE_BYTE),
        ("PollRegister", "status", "busy", bit_2),
        ("WaitTime", "", "", []),
        ("ReadRegister", "preset", "", TWO_BYTES),
        ("WriteRegister", "key", "", ONE_BYTE),
    ]


def test_values_that_a_procedure_writes(run: ProcedurePlan) -> None:
    writes = [operation for operation in run.operations if isinstance(operation, WriteRegister)]
    values = [write.value for write in writes]
    position = run.procedure.arguments[0]
    assert values == [FixedNumber(0x5A), AsMember(position, "preset"), FixedNumber(1), FixedNumber(1), FixedNumber(0)]
    assert [write.locks_again for write in writes] == [False, False, False, False, True]
    verified = [operation.write for operation in run.operations if isinstance(operation, VerifyWrite)]
    assert verified == writes[:3]


def test_calls_of_a_procedure(run: ProcedurePlan) -> None:
    """Only a bit of a byte needs the other bits to be read."""
    writes = [operation for operation in run.operations if isinstance(operation, WriteRegister)]
    both = (MasterCall.READ, MasterCall.WRITE)
    assert [write.calls for write in writes] == [
        (MasterCall.WRITE,),
        (MasterCall.WRITE,),
        both,
        (MasterCall.WRITE,),
        (MasterCall.WRITE,),
    ]
    assert run.calls == (MasterCall.READ, MasterCall.WRITE, MasterCall.WAIT)
    assert [operation.register.name for operation in run.reads] == ["preset"]


def test_which_procedure_changes_frames(small: Device, run: ProcedurePlan) -> None:
    """The width of the zeros is in three bits of 'level'. The speed is another bit of it."""
    set_level = plan_procedure(small, small.procedure("set_level"))
    assert (run.changes_frames, set_level.changes_frames) == (False, True)
    (write,) = set_level.operations
    assert summary(write) == ("WriteRegister", "level", "zeros", [BitSlice(0, 1, 7, 0)])
    assert isinstance(write, WriteRegister)
    assert isinstance(write.value, InField)
    (argument,) = set_level.arguments
    assert argument.writes == (write,)
    assert [type(refusal).__name__ for refusal in argument.refusals] == ["TooWide"]


# -- registers


@pytest.mark.parametrize(
    ("register", "member", "signed", "binds", "stands_for", "reasons", "checked"),
    [
        # 2^12 - 1 is below 2^16 - 1 for one of the two order codes.
        ("preset", "preset", False, (False, True), 0, ["TooWide"], ["max"]),
        # 1 to 256 in a byte in which 0 represents 256: 0 is refused anyway, and nothing is above.
        ("steps", "steps", False, (True, False), 256, ["NotZeroFor"], []),
        # -128 is the lowest signed byte, and 127 the highest.
        ("offset", "offset", True, (False, True), 0, ["NotSigned"], ["max"]),
        ("trim", "trim", True, (True, False), 0, ["NotSigned"], ["min"]),
        ("alarm", "alarm", False, (False, False), 0, ["TooWide"], []),
        ("level", "", False, (False, False), 0, ["TooWide", "TooWide"], []),
    ],
)
def test_limits_of_registers(
    small: Device,
    register: str,
    member: str,
    signed: bool,
    binds: tuple[bool, bool],
    stands_for: int,
    reasons: list[str],
    checked: list[str],
) -> None:
    limits = limits_of(small, small.register(register))
    codec = layout_plan_of(small, small.register(register).layout)
    assert (limits.member, limits.signed, limits.number_for_zero) == (member, signed, stands_for)
    assert (limits.can_be_below, limits.can_be_above) == binds
    # The speed has a name for both values, so none is refused.
    assert [type(refusal).__name__ for refusal in refusals(codec)] == reasons
    check = limits_check_of(codec, limits)
    assert [side for side, _ in (check.bounds if check is not None else ())] == checked


def test_parameter_in_a_register(small: Device) -> None:
    """Three bits hold 0 to 7, of which the spec allows 1 to 5."""
    (register,) = held_parameters(small)
    (held,) = register.parameters
    assert (register.register.name, held.parameter.name, held.field.name) == ("level", "zero_bits", "zeros")
    assert (held.lowest_valid, held.highest_valid, held.highest_value, held.meaning) == (1, 5, 5, UnsignedNumber())


# -- frames


def test_sizes_of_received_frames(small: Device, by_hand: Device) -> None:
    """45 bits are around a BiSS frame, two around an SSI word. Zeros take up to 5 bits, and 5 by default."""
    sizes = [
        (size.variant.code, size.layout.name, size.frame_bits, size.buffer_bytes)
        for size in received_sizes(small, small.interfaces[0])
    ]
    assert sizes == [
        ("S12", "word", 12 + 2 + 6, 9),  # 65 bits
        ("S16", "word", 16 + 2 + 6, 9),  # 69 bits
        ("S12", "padded_word", 12 + 5 + 8, 10),
        ("S16", "padded_word", 16 + 5 + 8, 10),  # 74 bits
    ]
    moving = {size.layout.name: size.depends_on_registers for size in received_sizes(small, small.interfaces[0])}
    assert moving == {"word": False, "padded_word": True}
    words = {
        size.layout.name: (size.frame_bits, size.buffer_bytes)
        for size in received_sizes(by_hand, by_hand.interface("ssi"))
        if size.variant.code == "HABG"
    }
    assert words["digit_word"] == (14, 2)
    assert words["text_word"] == (16, 3)
    assert words["gray_word"] == (9, 2)
    assert not list(received_sizes(by_hand, by_hand.interface("rs485")))


def test_replies_by_their_first_byte(by_hand: Device) -> None:
    rs485 = rs485_of(by_hand)
    dispatch = next(dispatch for dispatch in dispatches(rs485.layouts) if dispatch.sender == "encoder")
    assert (dispatch.selector.name, dispatch.bytes_needed, dispatch.fallback) == ("id", 1, None)
    branches = [(branch.layout.name, branch.values) for branch in dispatch.branches]
    assert branches == [("low_reply", (1,)), ("high_reply", (3,)), ("modbus_reply", (2,))]
    names = [
        layout.name if layout is not None else "" for layout in (reply_to_data_id(rs485, value) for value in range(5))
    ]
    assert names == ["", "low_reply", "modbus_reply", "high_reply", ""]


def test_replies_to_requests(by_hand: Device) -> None:
    replies = [reply_to(by_hand, "rs485", name) for name in ("first", "second", "third")]
    assert replies == [Reply(4, True), Reply(4, True), Reply(4, False)]
    assert reply_to(by_hand, "ssi", "first") is None


def test_requests_with_their_replies(by_hand: Device) -> None:
    """The reply of the spare encoder begins with the byte 42h of its request. Over SPI, the first 16 bits are zero."""
    valid_specs = TESTS / "check" / "ok_model"
    spare, _ = load_library([valid_specs / "spare.yaml", valid_specs / "manufacturer.yaml"])
    low_first, _ = load_library([TESTS / "specs" / "lowfirst.yaml", TESTS / "specs" / "manufacturer.yaml"])
    (asked,) = exchanges(spare[0].interface("rs485"))
    assert asked.reply is not None
    assert (asked.request.name, asked.reply.name, asked.repeats_first_byte) == ("ask", "answer", True)
    assert asked.defaults == {}
    (over_spi,) = exchanges(low_first[0].interface("spi"))
    assert over_spi.reply is not None
    assert (over_spi.request.name, over_spi.reply.name, over_spi.repeats_first_byte) == ("ask", "position", False)
    assert exchanges(by_hand.interface("rs485")) == ()
    assert exchanges(by_hand.interface("ssi")) == ()


def test_unused_bits_of_bytes() -> None:
    """Bytes with unused bits are 3, 4 and 5 of the reply, so they are bytes 0 to 2 of the number."""
    valid_specs = TESTS / "check" / "ok_model"
    devices, _ = load_library([valid_specs / "spare.yaml", valid_specs / "manufacturer.yaml"])
    codec = plan(devices[0], "answer")
    assert [(op.field.name, op.lowest_bit_in_unused, op.mask) for op in codec.reserved] == [
        ("rest", 0, 0xFF),
        ("more", 8, 0xFF00),
        ("odd", 16, 0xF0000),
    ]
    assert group_reserved_bits_by_shift(codec) == (
        ShiftedBits(3, 0, 0xFF, 0),
        ShiftedBits(4, -8, 0xFF00, 0x1200),
        ShiftedBits(5, -16, 0xF0000, 0),
    )


# -- layouts


def test_crcs_of_frames(small: Device, by_hand: Device) -> None:
    whole, other = plan(small, "word").crc_of_all_order_codes, plan(small, "padded_word").crc_of_all_order_codes
    assert whole is not None
    assert other is not None
    assert whole.covered_width.value({"position_bits": 12}) == 12 + 2
    assert (whole.lowest_covered_bit, whole.covers_part_only) == (6, False)
    assert (whole.bits_between, whole.inverted_mask) == (0, 0x3F)
    # The start value 55h makes the remainder of a valid frame depend on its length.
    assert (whole.is_checked_by_division, other.is_checked_by_division) == (True, False)
    part = plan(by_hand, "part_word").crc_of_all_order_codes
    assert part is not None
    # Three bits are between the 8 covered bits and the CRC of 4 bits.
    assert (part.covered_width.constant, part.lowest_covered_bit, part.bits_between, part.covers_part_only) == (
        8,
        7,
        3,
        True,
    )
    assert (part.is_checked_by_division, part.steps) == (False, ())
    crc = plan(by_hand, "crc_word").crc_of_all_order_codes
    assert crc is not None
    assert (crc.covered_width.constant, crc.lowest_covered_bit, crc.bits_between) == (8, 4, 0)
    assert (crc.covers_part_only, crc.is_checked_by_division) == (False, False)
    assert plan(by_hand, "text_word").crc_of_all_order_codes is None


def test_checks_of_frames(by_hand: Device) -> None:
    constant, choice = plan(by_hand, "flag_word").checks
    assert isinstance(constant, AlwaysIs)
    assert (constant.field.name, constant.value) == ("mark", 9)
    assert isinstance(choice, IsOneOf)
    assert (choice.field.name, choice.values) == ("mode", (1, 2))
    assert plan(by_hand, "flag_word").faults() == (Fault.LENGTH, Fault.CONSTANT, Fault.RANGE)
    assert plan(by_hand, "flag_word").constants == {"mark": 9}
    (digits,) = plan(by_hand, "digit_word").checks
    assert isinstance(digits, AtMost)
    assert (digits.limit, digits.digits) == (9999, 4)
    even, odd = plan(by_hand, "parity_word").checks
    assert isinstance(even, ParityIs)
    assert isinstance(odd, ParityIs)
    assert [field.name for field in even.covered_fields] == ["a", "b"]
    assert [field.name for field in odd.covered_fields] == ["b"]
    assert (even.odd, even.mask, even.known_parity) == (False, 0, None)
    assert (odd.odd, odd.mask, odd.known_parity) == (True, 0, None)


def test_reasons_to_refuse_values(by_hand: Device) -> None:
    reasons = [(type(refusal).__name__, refusal) for refusal in refusals(plan(by_hand, "number_word"))]
    assert [name for name, _ in reasons] == ["NotSigned", "NotZeroFor", "TooWide", "NoPowerOfTwo"]
    assert getattr(reasons[1][1], "number_for_zero", 0) == 16
    assert powers_of_two(plan(by_hand, "number_word")) == {"power"}
    names = [type(refusal).__name__ for refusal in refusals(plan(by_hand, "digit_word"))]
    assert names == ["DigitTooHigh", "DigitTooHigh", "DigitsDisagree"]
    assert [type(refusal).__name__ for refusal in refusals(plan(by_hand, "gray_word"))][-1] == "JoinDisagrees"


def test_places_of_bits(by_hand: Device) -> None:
    codec = plan(by_hand, "number_word")
    bits_of_parts = [part.bits for part in codec.decoded_fields]
    places = [(bits.low.constant, bits.width.constant, bits.has_no_bits_above) for bits in bits_of_parts]
    assert places == [(8, 4, True), (4, 4, False), (0, 4, False)]
    assert (codec.by_word, codec.depends_on_order_code, codec.length) == (True, False, 1)
    reply = plan(by_hand, "low_reply")
    assert (reply.by_word, reply.length) == (False, 4)
    byte_indices = [list(plan(by_hand, name).bytes_from_low) for name in ("low_reply", "high_reply")]
    assert byte_indices == [[0, 1, 2, 3], [3, 2, 1, 0]]
    assert [part.bits.bit_slices for part in reply.decoded_fields] == [
        (BitSlice(1, 0, 0xFF, 0), BitSlice(2, 0, 0xFF, 8))
    ]
    assert [part.is_shared for part in plan(by_hand, "parity_word").decoded_fields] == [True, True]
    assert [part.is_shared for part in plan(by_hand, "gray_word").decoded_fields] == [True, True, False]


def test_reserved_bits(by_hand: Device) -> None:
    """The field sent last has the lowest bits of the number. The other reserved bit is at bit 6 of the word."""
    codec = plan(by_hand, "spare_word")
    reserved = [(op.field.name, op.value, op.lowest_bit_in_unused, op.mask) for op in codec.reserved]
    assert reserved == [("second_spare", 1, 0, 0b111), ("first_spare", 2, 3, 0b11_000)]
    assert group_reserved_bits_by_shift(codec) == (
        ShiftedBits(None, 0, 0b111, 1),
        ShiftedBits(None, 3, 0b11_000, 0b10_000),
    )


def test_numbers_of_several_fields(by_hand: Device) -> None:
    """5 turns and an angle of 10 in 5 bits are 5 x 32 + 10."""
    codec = plan(by_hand, "gray_word")
    (position,) = codec.joined_numbers
    parameters = dict(by_hand.variant("HABG").parameters)
    assert position.number_of({"turns": 5, "angle": 10}, parameters) == 5 * 32 + 10
    assert position.field_numbers(5 * 32 + 10, parameters) == {"turns": 5, "angle": 10}
    assert position.width.value(parameters) == 3 + 5
    assert position.depends_on_order_code
    assert position.bits is not None
    assert position.bits.low.constant == 1
    assert codec.gray is not None
    assert (codec.gray.low.constant, codec.gray.width.value(parameters), codec.gray.when) == (1, 8, "")
    assert codec.gray.depends_on_order_code
    assert codec.depends_on_order_code


def test_terms_of_an_encoder(by_hand: Device) -> None:
    def values(layout: str) -> list[object]:
        return [term.value for term in plan(by_hand, layout).encoded_fields]

    low, high, mode, mark = values("flag_word")
    assert [type(value) for value in (low, high, mode)] == [ValueOfField] * 3
    assert mark == ConstantNumber(9)
    first_spare, _, second_spare = values("spare_word")
    assert (first_spare, second_spare) == (ReservedBits(2, 3), ReservedBits(1, 0))
    a, b = by_hand.layout("parity_word").fields[:2]
    assert values("parity_word")[2:] == [ParityOf((a, b), False, 0), ParityOf((b,), True, 0)]
    # The first byte identifies the frame, and the CRC is not a term.
    identity, count = values("low_reply")
    assert identity == ConstantNumber(1)
    assert isinstance(count, ValueOfField)


def test_range_of_the_position(small: Device) -> None:
    (position_range,) = position_ranges(small, small.interfaces[0])
    assert [layout.name for layout in position_range.layouts] == ["word", "padded_word"]
    assert (position_range.has_difference, position_range.never_wraps) == (True, False)
    assert [factor.value({"position_bits": 12}) for factor in count_factors(position_range.measurement)] == [4096]


@pytest.mark.parametrize(
    ("layout_name", "byte_of_low_half", "byte_of_high_half", "low_bit"),
    [("low_reply", 2, 3, 16), ("high_reply", 3, 2, 0)],
)
def test_a_crc_of_two_bytes_at_the_end(
    layout_name: str, byte_of_low_half: int, byte_of_high_half: int, low_bit: int
) -> None:
    """The CRC is in the last two of four bytes, its low byte first or last."""
    device = load(TESTS / "reference" / "specs")
    crc_bits = _bits_at_end(device.layout(layout_name), 16)
    assert crc_bits.low.value({}) == low_bit
    assert crc_bits.bit_slices == (
        BitSlice(byte=byte_of_low_half, low_in_byte=0, mask=0xFF, low_in_number=0),
        BitSlice(byte=byte_of_high_half, low_in_byte=0, mask=0xFF, low_in_number=8),
    )


def test_the_only_reply_of_an_encoder_without_a_selector() -> None:
    device, _ = device_of_line("rs485,low_byte_first:position=24")
    reply = reply_to_data_id(device.interface("rs485"), 0x1A)
    assert reply is not None
    assert [field.name for field in reply.fields] == ["position"]


def test_bytes_outside_a_field_belong_to_it_only_over_spi(small: Device) -> None:
    """Over SPI, the register is read and written at once, so the other byte is there, with none of its bits."""
    level = replace(small.register("level"), length=2)
    speed = level.layout.field("speed")
    slice_of_speed = BitSlice(byte=0, low_in_byte=7, mask=1, low_in_number=0)
    other_byte = BitSlice(byte=1, low_in_byte=0, mask=0, low_in_number=0)
    assert bits_by_byte(level, speed) == (slice_of_speed,)
    assert bits_by_byte(replace(level, interface="spi"), speed) == (slice_of_speed, other_byte)
