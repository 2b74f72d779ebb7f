"""Every register of every family is accessed by its name, byte by byte, with every call failing.

Also covered are cases that no frame or label of a family contains.
"""

from __future__ import annotations

import random
import subprocess
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

import pytest
from c_harness import FAMILIES, Run, compile_c
from codewheel.model import Device, Register, Rs485, Variant, number_from_bytes, number_to_bytes
from codewheel.reference import codec
from codewheel.reference.bits_and_values import compute_bytes
from codewheel.targets.c.device import views_of
from exhaustive import mostly_exhaustive
from test_c_codec import FAULTS, Table, check, valid_numbers
from test_c_families import identity_bytes
from transport_harness import OK, RANGE, READ, TRANSPORT, UNTOUCHED, WRITE, Encoder, Machine

pytestmark = pytest.mark.slow


def variant_of(device: Device, register: Register) -> Variant:
    return next(variant for variant in device.variants if variant.interface == register.interface)


def selecting(device: Device, register: Register) -> list[tuple[int, int]]:
    """Return the address and the value that select the bank of a register, or nothing for one outside banks."""
    name = device.bank_selector(register)
    return [(device.register(name).address, register.bank)] if name and register.bank is not None else []


def contents(register: Register) -> Iterable[bytes]:
    """Return values for a register: every value if it is one byte, otherwise few bits, all bits and its default."""
    if register.length == 1:
        yield from (bytes([value]) for value in range(256))
        return
    yield from (bytes(register.length), b"\xff" * register.length, register.default_bytes() or bytes(register.length))
    yield from ((1 << bit).to_bytes(register.length, "big") for bit in range(8 * register.length))


@pytest.mark.parametrize("family", mostly_exhaustive(FAMILIES, "amm5"))
def test_every_register_is_read_and_its_faults_are_told(family: str, machines: Callable[[str], Machine]) -> None:
    machine = machines(family)
    readable = [register for register in machine.device.registers if register.readable]
    assert readable
    for register in readable:
        variant = variant_of(machine.device, register)
        placed = register.layout.place(variant.parameters)
        for data in contents(register):
            encoder = Encoder()
            encoder.memory[register.address : register.address + register.length] = data
            answer = machine.read(register.name, variant.code, encoder)
            problems = codec.decode(machine.device, placed, number_from_bytes(register.layout, data)).problems
            assert (answer.result, answer.failure) == (
                FAULTS[problems[0].fault.value] if problems else OK,
                UNTOUCHED,
            ), (
                register.name,
                data,
            )
            banks = selecting(machine.device, register)
            assert answer.record == [
                *(f"w {address:02X} {bank:02X}" for address, bank in banks),
                f"r {register.address:02X} {register.length}",
            ]
        calls = [*((WRITE, address) for address, _ in banks), (READ, register.address)]
        for at, (kind, address) in enumerate(calls):
            failed = machine.read(register.name, variant.code, Encoder(fail_at=at, error=5))
            assert (failed.result, failed.failure, failed.data) == (TRANSPORT, (0, kind, kind, address, 5), b"")


@pytest.mark.parametrize("family", mostly_exhaustive(FAMILIES, "amm5"))
def test_every_register_is_written_within_its_limits(family: str, machines: Callable[[str], Machine]) -> None:
    machine = machines(family)
    writable = [register for register in machine.device.registers if register.writable and not register.reserved]
    for register in writable:
        variant = variant_of(machine.device, register)
        placed = register.layout.place(variant.parameters)
        # A register with one field is a number in C, which has no other bits.
        is_number, results = register.layout.gaps == "unspecified" and len(placed.fields) == 1, set()
        for data in contents(register):
            if is_number and number_from_bytes(register.layout, data) >> placed.fields[0].width:
                continue
            encoder = Encoder()
            answer = machine.write(register.name, variant.code, data, encoder)
            results.add(answer.result)
            written = [line for line in encoder.record if line.startswith("w ")]
            banks = selecting(machine.device, register)
            expected = [
                *(f"w {address:02X} {bank:02X}" for address, bank in banks),
                f"w {register.address:02X} {data.hex(' ').upper()}",
            ]
            assert written == (expected if answer.result == OK else []), (register.name, data)
            for at, address in enumerate([*(address for address, _ in banks), register.address]):
                if answer.result == OK:
                    failed = machine.write(register.name, variant.code, data, Encoder(fail_at=at, error=-5))
                    assert (failed.result, failed.failure) == (TRANSPORT, (0, WRITE, WRITE, address, -5))
        assert OK in results
        assert results <= {OK, RANGE, -1}


def test_data_ids_of_other_replies_are_refused(family: tuple[Device, Run]) -> None:
    """Return a valid frame of each layout with each of the 16 data IDs and the right CRC. Only its own are accepted."""
    device, run = family
    table = Table(device)
    pairs = []
    for interface, layout in device.layouts():
        if not layout.selector:
            continue
        variant = next(variant for variant in device.variants if variant.interface == interface.name)
        placed = layout.place(variant.parameters)
        sound = number_to_bytes(layout, next(valid_numbers(device, placed, random.Random(layout.name))), placed.bits)
        for data_id in range(16):
            control = 0x02 | data_id << 3 | (data_id.bit_count() & 1) << 7
            frame = bytes([control]) + sound[1:]
            crc = device.crc_of(placed)
            if crc is not None:
                frame = frame[:-1] + bytes([compute_bytes(crc, frame[:-1])])
            expected = table.expected_answer(layout.name, placed, number_from_bytes(layout, frame))
            assert expected.split(" ")[0] == ("0" if data_id in layout.selects else "4")
            pairs.append((f"{variant.code} decode {layout.name} {frame.hex()}", expected))
    check(run, pairs)
    assert {expected[0] for _, expected in pairs} == ({"0", "4"} if device.find_interface(Rs485) is not None else set())


def test_every_control_byte_selects_its_frame_or_none(family: tuple[Device, Run]) -> None:
    device, run = family
    pairs = []
    for interface in device.interfaces:
        frames = [layout for layout in interface.layouts if layout.selector]
        variant = next(variant for variant in device.variants if variant.interface == interface.name)
        for kind, sender in (("request", "master"), ("reply", "encoder")) if frames else ():
            of_sender = [(at, layout) for at, layout in enumerate(frames) if layout.sender == sender]
            for byte in range(256):
                index = next((at for at, layout in of_sender if byte >> 3 & 15 in layout.selects), None)
                pairs.append(
                    (
                        f"{variant.code} select {kind} {byte:02X}",
                        "4 0 0" if index is None else f"0 {index} {frames[index].widest // 8}",
                    )
                )
            pairs.append((f"{variant.code} select {kind}", "1 0 0"))
    check(run, pairs)


def test_each_byte_of_the_identity_counts(family: tuple[Device, Run]) -> None:
    device, run = family
    identities = [identity for view in views_of(device) for identity in view.identities]
    if device.evidence.grade != "manual":
        assert identities == []  # The registers are known, but not their contents.
        return
    (identity,) = identities
    registers = [part.register for part in identity.compared_registers]
    variant = variant_of(device, registers[0])
    read = [identity_bytes(register, variant) for register in registers]
    pairs = []
    for index, register in enumerate(registers):
        expected = {field.name for field in register.layout.fields if field.equals is not None}
        for field in register.layout.fields:
            for bit in range(field.widest) if field.name in expected else ():
                number = number_from_bytes(register.layout, read[index]) ^ 1 << field.low.constant + bit
                changed = [
                    *read[:index],
                    number_to_bytes(register.layout, number, 8 * register.length),
                    *read[index + 1 :],
                ]
                contents_in_hex = " ".join(content.hex() for content in changed)
                pairs.append((f"{variant.code} candidates of {contents_in_hex}", variant.code))
    answers = run(line for line, _ in pairs)
    assert pairs
    assert [line for (line, code), answer in zip(pairs, answers, strict=True) if code in answer.split()[1:]] == []


# -- refusals before anything is sent


@pytest.mark.parametrize(
    ("family", "code", "procedure", "argument"),
    [
        # One more than 16 + 20 bits (AM36), 65,536 turns of 21 bits (AMM5),
        # 0FFFFFh at 50 um and 1FFFFFFh at 1 um (SMA21).
        ("am36", "AM3616/4096-I7", "set_preset", 1 << 36),
        ("am36", "AM3616/4096-I7", "store_preset", 1 << 36),
        ("amm5", "AMM5A21/65KSC1", "store_preset", 1 << 37),
        ("sma21", "SMA21-SC1-0050", "set_preset", 0x100000),
        ("sma21", "SMA21-SC1-0001", "set_preset", 0x2000000),
        ("sma21", "SMA21-SC1-0050", "set_offset", 0xF00001),
    ],
)
def test_a_position_that_does_not_fit_is_not_set(
    family: str, code: str, procedure: str, argument: int, machines: Callable[[str], Machine]
) -> None:
    answer = machines(family).run(procedure, code, (argument,))
    assert (answer.result, answer.failure, answer.record) == (RANGE, UNTOUCHED, [])


def test_a_state_that_no_encoder_has_is_not_taken_over(machines: Callable[[str], Machine]) -> None:
    """AM36 6.5: a revolution has at most 20 bits, and the revolutions have 16."""
    machine = machines("am36")
    for address, value, reads in ((0x56, 21, ["r 56 1"]), (0x57, 17, ["r 56 1", "r 57 1"])):
        encoder = Encoder()
        encoder.memory[0x56:0x58] = b"\x14\x10"
        before = machine.state("AM3616/4096-I7", Encoder(fail_at=0, error=1)).data
        encoder.memory[address] = value
        answer = machine.state("AM3616/4096-I7", encoder)
        assert (answer.result, answer.failure, answer.record, answer.data) == (RANGE, UNTOUCHED, reads, before)


def _members_changed_by_one(before: bytes, after: bytes) -> int:
    return [old ^ new for old, new in zip(before, after, strict=True)].count(1)


def test_the_code_of_a_measuring_system_is_taken_over(machines: Callable[[str], Machine]) -> None:
    """SMA21 6.4: bit 5 of 49h is the code, bit 1 selects an offset, and the bits next to them belong to others."""
    machine = machines("sma21")
    codes = []
    for content in (0x20, 0xDD, 0xFF):
        encoder = Encoder()
        encoder.memory[0x49] = content
        answer = machine.state("SMA21-SC1-0050", encoder)
        assert (answer.result, answer.record) == (OK, ["r 49 1"])
        codes.append(answer.data)
    gray, offset = (_members_changed_by_one(codes[0], code) for code in codes[1:])
    assert (gray, offset) == (1, 1)
    assert sum(codes[0]) == sum(codes[1]) + 1
    assert sum(codes[2]) == sum(codes[0]) + 1
    failed = machine.state("SMA21-SC1-0050", Encoder(fail_at=0, error=3))
    assert (failed.result, failed.failure, failed.data) == (
        TRANSPORT,
        (0, READ, READ, 0x49, 3),
        machine.state("SMA21-SC1-0050", Encoder(fail_at=0, error=4)).data,
    )


def test_the_identity_of_a_thru_bore_encoder_is_read(machines: Callable[[str], Machine]) -> None:
    """ASC85 6.4: profile ID, device ID and manufacturer ID."""
    machine = machines("asc85")
    answer = machine.identity(Encoder())
    assert (answer.result, answer.record, answer.data) == (
        OK,
        ["r 42 2", "r 78 6", "r 7E 2"],
        bytes([0x42, 0x43, *range(0x78, 0x80)]),
    )
    for index, address in enumerate((0x42, 0x78, 0x7E)):
        failed = machine.identity(Encoder(fail_at=index, error=-7))
        assert (failed.result, failed.failure, failed.data) == (TRANSPORT, (index, READ, READ, address, -7), b"")


# -- single functions

#: Results of the shared helpers, by arithmetic on paper.
HELPERS: Mapping[str, int] = {
    "cw_difference(3U, 9U, 0U)": 0,
    "cw_difference(1U, 9U, 10U)": 2,
    "cw_difference(9U, 1U, 10U)": -2,
    "cw_difference(5U, 0U, 10U)": -5,
    "cw_from_gray(6U, 64U, 3U)": 6,
    "cw_from_gray(6U, 0U, 3U)": 4,
    "cw_to_gray(4U, 64U, 3U)": 4,
    "cw_to_gray(4U, 0U, 3U)": 6,
    "cw_mask(64U) == UINT64_MAX": 1,
    "cw_mask(0U)": 0,
    "cw_field(0xF0U, 64U, 4U)": 0,
    "cw_field(0xF0U, 4U, 2U)": 3,
    "cw_above(0xF0U, 64U)": 0,
    "cw_above(0xF0U, 4U)": 15,
    "cw_above(UINT64_MAX, 32U) == 0xFFFFFFFFU": 1,
    'cw_label_match("K7", "@#")': 2,
    'cw_label_match("k7", "%%")': 2,
    'cw_label_match("77", "@#")': 0,
    'cw_label_match("-7", "@#")': 0,
    'cw_label_match("K 7 -x", "@#")': 4,
    'cw_label_match("K7", "@ #")': 2,
    'cw_label_match(" K7 ", "K7")': 4,
    'cw_label_match("K 7x", "K7")': 0,
    'cw_label_match("-7", "%#")': 0,
    'cw_label_match("7/S1-", "#")': 0,
    'cw_label_match("7/S", "#")': 0,
    'cw_label_match("7/S1 ", "#")': 1,
    'cw_label_match("7 / s 1 2 ", "#")': 2,
    'cw_label_match("7/S ", "#")': 0,
    'cw_label_match("7/S1 -", "#")': 0,
    "cw_fits_signed(7, 4U)": 1,
    "cw_fits_signed(8, 4U)": 0,
    "cw_fits_signed(-8, 4U)": 1,
    "cw_fits_signed(-9, 4U)": 0,
    "cw_fits_signed(-1, 1U)": 1,
    "cw_fits_signed(1, 1U)": 0,
    "cw_fits_signed(0, 0U)": 1,
    "cw_fits_signed(-1, 0U)": 0,
    "cw_fits_signed(INT64_MIN, 64U)": 1,
    "cw_capital('z') == 'Z'": 1,
    "cw_capital('{') == '{'": 1,
    "cw_capital('`') == '`'": 1,
    "cw_is_letter_or_digit('_')": 0,
    "cw_is_letter_or_digit('@')": 0,
    "cw_step_send(0xDAU, 10U, 40U, 7U, 0xFFU).times": 10,
    "cw_step_poll(0x60U, 0x80U, 0x80U).mask": 0x80,
    "cw_step_wait(5U).microseconds": 5,
    # The parity of even bits in bit 0, of odd bits in bit 1.
    "cw_parity_64(UINT64_C(0x8000000000000000))": 1,
    "cw_parity_64(UINT64_C(0x8000000000000001))": 0,
    "cw_parities(0x00000001U)": 1,
    "cw_parities(0x80000000U)": 2,
    "cw_parities(0x00000021U)": 3,
    "cw_parities(0xC000000FU) ^ cw_parities(0x00000003U)": 0,
    "cw_step_more(0x60U, 0x80U, 0x80U).address": 0x60,
    "cw_step_read_one(0x60U).times": 0,
}


#: Cable lengths of the manuals (5.3 each) in metres, and the clock in hertz that must not be
#: reached. There is none from 400 m on.
CABLES = {
    0: 400_000,
    49: 400_000,
    50: 300_000,
    99: 300_000,
    100: 200_000,
    199: 200_000,
    200: 100_000,
    399: 100_000,
    400: 0,
}


def _clock_limits() -> Iterator[tuple[str, int]]:
    for family in ("am36", "amm5", "asc85", "sma21"):
        for metres, hertz in CABLES.items():
            yield f"lika_{family}_ssi_clock_limit_hz({metres}U)", hertz


#: Results of functions of the families and of the control frames,
#: from the manuals, from BiSS C's protocol description, or by arithmetic.
FUNCTIONS: Mapping[str, int] = {
    # AMM5 6.5: 30 us at 50 kHz, 7.5 us at 200 kHz. 1.5 clocks, rounded up to a whole nanosecond.
    "lika_amm5_biss_timeout_ns(50000U)": 30_000,
    "lika_amm5_biss_timeout_ns(200000U)": 7_500,
    "lika_amm5_biss_timeout_ns(0U)": 0,
    "lika_amm5_biss_timeout_ns(7000000U)": 215,
    # AMM5 6.4: in 56 bits the revolutions end at bit 48 and the position within one at bit 32; 16 and 21 bits here.
    "lika_amm5_biss_reg_preset_multiturn_shift(amm5)": 33,
    "lika_amm5_biss_reg_preset_singleturn_shift(amm5)": 12,
    "lika_amm5_biss_reg_preset_multiturn_mask(amm5) == UINT64_C(0x1FFFE00000000)": 1,
    "lika_amm5_biss_reg_preset_singleturn_mask(amm5) == UINT64_C(0x1FFFFF000)": 1,
    # Something that is not a frame has no length.
    "lika_amm5_rs485_frame_length((lika_amm5_rs485_frame)99)": 0,
    "lika_sma21_rs485_frame_length((lika_sma21_rs485_frame)99)": 0,
    # AM36 6.5: 4Bh to 4Dh have 24 bits. There is at least one revolution.
    # The transport has no functions, so an attempt to call one would return UNSUPPORTED.
    "lika_am36_biss_reg_information_per_revolution_encode(am36, &steps, bytes, 3U)": RANGE,
    "lika_am36_biss_write_number_of_revolutions(&none, am36, &turns, NULL)": RANGE,
    "lika_am36_biss_write_preset(&none, am36, &beyond, NULL)": RANGE,
    "lika_amm5_biss_write_preset(&none, amm5, &disagreeing, NULL)": RANGE,
    # Bit 5 of 49h, the code, is 0 or 1 (AM36 6.5, SMA21 6.4).
    (
        "(coded.output_code = (lika_am36_biss_output_code)2, "
        "lika_am36_biss_write_configuration(&none, am36, &coded, NULL))"
    ): RANGE,
    (
        "(measured.output_code = (lika_sma21_biss_output_code)2, "
        "lika_sma21_biss_write_configuration(&none, sma21, &measured, NULL))"
    ): RANGE,
    # The widths of these fields in the iC-MU: BANKSEL 5 bits, OUT_ZERO 3, OUT_LSB 4. Codes of MODEA have 3 bits.
    "ichaus_icmu_biss_write_bank(&none, icmu, &bank, NULL)": RANGE,
    "ichaus_icmu_biss_write_output_length(&none, icmu, &zeros, NULL)": RANGE,
    "ichaus_icmu_biss_write_output_selection(&none, icmu, &lowest, NULL)": RANGE,
    "ichaus_icmu_biss_write_mode(&none, icmu, &mode, NULL)": RANGE,
    "cw_run_step(&none, &reading, 1U, NULL)": RANGE,
    # x^4 = x + 1, x^35 = x^5 = x^2 + x, all inverted. Of more than 32 bits, only the last 32 count.
    "cw_biss_crc(0U, 32U)": 15,
    "cw_biss_crc(1U, 32U)": 12,
    "cw_biss_crc(0x80000000U, 32U)": 9,
    "cw_biss_crc(0x80000000U, 99U)": 9,
    # A request to read register 0 of slave 0, and each of the 14 bits after S, which must be 0.
    "cw_biss_request_decode(0x800D4000U, &request)": OK,
    "cw_biss_request_decode(0x800D4001U, &request)": 3,
    "cw_biss_request_decode(0x800D6000U, &request)": 3,
    # CDS that never changes, and S that is not answered yet.
    "cw_biss_answer_decode(&request, 0xFFFFFFFFU, bytes, bytes)": 4,
    "cw_biss_answer_decode(&request, 0x80008000U, bytes, bytes)": 5,
    # No byte is requested or stored, and the phases do not exist.
    "(cw_biss_slave_give(&slave, 0x55U), cw_biss_slave_stored(&slave), slave.is_byte_ready)": 0,
    "slave.bits_to_send": 0,
    "(slave.phase = (cw_biss_phase)9, cw_biss_slave_next(&slave, false, true))": 1,
    "(slave.phase = (cw_biss_phase)9, cw_biss_slave_next(&slave, false, false))": 0,
    "(master.phase = (cw_biss_phase)9, cw_biss_master_next(&master, true))": 0,
    "master.phase": 0,
    **dict(_clock_limits()),
}

PROGRAM = """#include "ichaus/icmu_biss.h"
#include "ichaus/icmu_biss_registers.h"
#include "lika/am36_biss.h"
#include "lika/am36_ssi.h"
#include "lika/amm5_ssi.h"
#include "lika/sma21_ssi.h"
#include "lika/am36_biss_registers.h"
#include "lika/amm5_biss.h"
#include "lika/amm5_biss_registers.h"
#include "lika/amm5_rs485.h"
#include "lika/asc85_ssi.h"
#include "codewheel/biss_slave.h"
#include "lika/sma21_biss.h"
#include "lika/sma21_biss_registers.h"
#include "lika/sma21_rs485.h"
#include <stdio.h>
int main(void)
{
    const lika_am36_biss am36 = LIKA_AM36_BISS_AM3616_4096_I7;
    const lika_amm5_biss amm5 = LIKA_AMM5_BISS_A21_65KSC1;
    const lika_sma21_biss sma21 = LIKA_SMA21_BISS_SC1_0050;
    static const cw_transport none = { NULL, NULL, NULL, NULL, NULL, 0U, 0U };
    static const lika_am36_biss_reg_information_per_revolution steps = { 0x1000000U };
    static const lika_am36_biss_reg_number_of_revolutions turns = { 0U };
    static const lika_am36_biss_reg_preset beyond = { UINT64_C(0x1000000000) };
    static const lika_amm5_biss_reg_preset disagreeing = { 1U, 2U, 3U };
    const ichaus_icmu_biss icmu = ICHAUS_ICMU_BISS_IC_MU_16_0;
    static const ichaus_icmu_biss_reg_bank bank = { 32U };
    static const ichaus_icmu_biss_reg_output_length zeros = { 8U, 0U };
    static const ichaus_icmu_biss_reg_output_selection lowest
        = { false, false, ICHAUS_ICMU_BISS_MODE_ST_ABSOLUTE, 16U };
    static const ichaus_icmu_biss_reg_mode mode = { (ichaus_icmu_biss_mode)8 };
    const cw_step reading = cw_step_read(0x44U);
    lika_am36_biss_reg_configuration coded;
    lika_sma21_biss_reg_configuration measured;
    cw_biss_request request = { 0U, 0U, false, 0U };
    cw_biss_master master;
    cw_biss_slave slave;
    uint8_t bytes[8] = { 0U };
    if (lika_am36_biss_reg_configuration_decode(am36, bytes, 1U, &coded) != CW_OK
        || lika_sma21_biss_reg_configuration_decode(sma21, bytes, 1U, &measured) != CW_OK) {
        return 1;
    }
    cw_biss_master_init(&master);
    cw_biss_slave_init(&slave);
@body@    return 0;
}
"""


@pytest.mark.slow
@pytest.mark.parametrize("calls", [HELPERS, FUNCTIONS], ids=["helpers", "functions"])
def test_functions_at_their_ends(calls: Mapping[str, int], include: Path, tmp_path: Path) -> None:
    body = "".join(f'    printf("%lld\\n", (long long)({call}));\n' for call in calls)
    program = compile_c(
        ["gcc", "-std=c99", "-Wno-unused", "-fsanitize=undefined", "-fno-sanitize-recover=all"],
        PROGRAM.replace("@body@", body),
        tmp_path,
        include,
    )
    printed = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout.split()
    assert dict(zip(calls, map(int, printed), strict=True)) == calls
