"""Every register of every family by its name, byte by byte, with every call failing; and what no frame or label of a family brings about."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path

import pytest
from c_harness import FAMILIES, Run, compile_c, devices_of
from codewheel import codec
from codewheel.crc import compute_bytes
from codewheel.model import Device, Register, Variant
from codewheel.targets.c_device import DeviceView
from test_c_codec import FAULTS, Table, check
from test_c_families import identity_bytes
from transport_harness import OK, RANGE, READ, TRANSPORT, UNTOUCHED, WRITE, Encoder, Machine, machine


@pytest.fixture(scope="module")
def machines(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Machine]:
    found = {device.name: device for device in devices_of()}
    return cache(lambda name: machine(found[name], tmp_path_factory.mktemp(name)))


def variant_of(device: Device, register: Register) -> Variant:
    return next(item for item in device.variants if item.interface == register.interface)


def contents(register: Register) -> Iterable[bytes]:
    """What a register may hold: every byte where it is one, else few bits, all bits and its default."""
    if register.length == 1:
        yield from (bytes([value]) for value in range(256))
        return
    yield from (bytes(register.length), b"\xff" * register.length, register.default_bytes() or bytes(register.length))
    yield from ((1 << bit).to_bytes(register.length, "big") for bit in range(8 * register.length))


@pytest.mark.parametrize("family", FAMILIES)
def test_every_register_is_read_and_its_faults_are_told(family: str, machines: Callable[[str], Machine]) -> None:
    made = machines(family)
    readable = [item for item in made.device.registers if item.readable and item.bank is None]
    assert readable
    for register in readable:
        variant = variant_of(made.device, register)
        placed = register.layout.place(variant.parameters)
        for data in contents(register):
            encoder = Encoder()
            encoder.memory[register.address : register.address + register.length] = data
            answer = made.read(register.name, variant.code, encoder)
            problems = codec.decode(made.device, placed, codec.number_from_bytes(register.layout, data)).problems
            assert (answer.result, answer.failure) == (FAULTS[problems[0].kind] if problems else OK, UNTOUCHED), (register.name, data)
            assert answer.record == [f"r {register.address:02X} {register.length}"]
        failed = made.read(register.name, variant.code, Encoder(fail_at=0, error=5))
        assert (failed.result, failed.failure, failed.data) == (TRANSPORT, (0, READ, READ, register.address, 5), b"")


@pytest.mark.parametrize("family", FAMILIES)
def test_every_register_is_written_within_its_limits(family: str, machines: Callable[[str], Machine]) -> None:
    made = machines(family)
    writable = [item for item in made.device.registers if item.writable and not item.reserved and item.bank is None]
    for register in writable:
        variant = variant_of(made.device, register)
        results = set()
        for data in contents(register):
            encoder = Encoder()
            answer = made.write(register.name, variant.code, data, encoder)
            results.add(answer.result)
            written = [line for line in encoder.record if line.startswith("w ")]
            assert written == ([f"w {register.address:02X} {data.hex(' ').upper()}"] if answer.result == OK else []), (register.name, data)
            if answer.result == OK:
                failed = made.write(register.name, variant.code, data, Encoder(fail_at=0, error=-5))
                assert (failed.result, failed.failure) == (TRANSPORT, (0, WRITE, WRITE, register.address, -5))
        assert OK in results and results <= {OK, RANGE, -1}


def test_data_ids_of_other_replies_are_refused(family: tuple[Device, Run]) -> None:
    """Behind a sound CRC and a sound parity: each of the 16 data IDs in each frame that has one."""
    device, run = family
    table = Table(device)
    pairs = []
    for interface, layout in device.layouts():
        if not layout.selector:
            continue
        variant = next(item for item in device.variants if item.interface == interface.kind)
        placed = layout.place(variant.parameters)
        for data_id in range(16):
            control = 0x02 | data_id << 3 | (data_id.bit_count() & 1) << 7
            frame = bytes([control]) + bytes(placed.bits // 8 - 1)
            crc = layout.crc_field
            if crc is not None:
                frame = frame[:-1] + bytes([compute_bytes(device.crc(crc.crc), frame[:-1])])
            expected = table.expected(layout.name, placed, codec.number_from_bytes(layout, frame))
            pairs.append((f"{variant.code} decode {layout.name} {frame.hex()}", expected))
    check(run, pairs)
    # Those of requests and replies of one byte more have constants that this frame lacks.
    assert {"0", "4"} <= {expected[0] for _, expected in pairs} or not any(item.kind == "rs485" for item in device.interfaces)


def test_every_control_byte_selects_its_frame_or_none(family: tuple[Device, Run]) -> None:
    device, run = family
    pairs = []
    for interface in device.interfaces:
        frames = [layout for layout in interface.layouts if layout.selector]
        variant = next(item for item in device.variants if item.interface == interface.kind)
        for kind, sender in (("request", "master"), ("reply", "encoder")) if frames else ():
            for byte in range(256):
                index = next((at for at, layout in enumerate(frames) if layout.sender == sender and byte >> 3 & 15 in layout.selects), None)
                pairs.append((f"{variant.code} select {kind} {byte:02X}", "4 0 0" if index is None else f"0 {index} {frames[index].widest // 8}"))
            pairs.append((f"{variant.code} select {kind}", "1 0 0"))
    check(run, pairs)


def test_each_byte_of_the_identity_counts(family: tuple[Device, Run]) -> None:
    device, run = family
    (identity,) = DeviceView(device).identities
    registers = [device.register(member.code.split(" ")[1].partition("[")[0]) for member in identity.members]
    variant = variant_of(device, registers[0])
    read = [identity_bytes(register, variant) for register in registers]
    pairs = []
    for index, register in enumerate(registers):
        expected = {field.name for field in register.layout.fields if field.equals is not None}
        for field in register.layout.fields:
            for bit in range(field.widest) if field.name in expected else ():
                number = codec.number_from_bytes(register.layout, read[index]) ^ 1 << field.low.constant + bit
                wrong = [*read[:index], codec.number_to_bytes(register.layout, number, 8 * register.length), *read[index + 1 :]]
                pairs.append((f"{variant.code} candidates of {' '.join(item.hex() for item in wrong)}", variant.code))
    answers = run(line for line, _ in pairs)
    assert pairs and [line for (line, code), answer in zip(pairs, answers) if code in answer.split()[1:]] == []


#: What the shared helpers give, by arithmetic on paper.
HELPERS: Mapping[str, int] = {
    "lika_difference(3U, 9U, 0U)": 0, "lika_difference(1U, 9U, 10U)": 2, "lika_difference(9U, 1U, 10U)": -2, "lika_difference(5U, 0U, 10U)": -5,
    "lika_from_gray(6U, 64U, 3U)": 6, "lika_from_gray(6U, 0U, 3U)": 4, "lika_to_gray(4U, 64U, 3U)": 4, "lika_to_gray(4U, 0U, 3U)": 6,
    "lika_mask(64U) == UINT64_MAX": 1, "lika_mask(0U)": 0, "lika_field(0xF0U, 64U, 4U)": 0, "lika_field(0xF0U, 4U, 2U)": 3,
    "lika_above(0xF0U, 64U)": 0, "lika_above(0xF0U, 4U)": 15, "lika_above(UINT64_MAX, 32U) == 0xFFFFFFFFU": 1,
    'lika_label_match("K7", "@#")': 2, 'lika_label_match("k7", "%%")': 2, 'lika_label_match("77", "@#")': 0, 'lika_label_match("-7", "@#")': 0,
    'lika_label_match("-7", "%#")': 0, 'lika_label_match("7/S1-", "#")': 0, 'lika_label_match("7/S", "#")': 0,
    "lika_step_send(0xDAU, 10U, 40U).times": 10, "lika_step_poll(0x60U, 0x80U, 0x80U).mask": 0x80, "lika_step_wait(5U).microseconds": 5,
}  # fmt: skip


def test_helpers_at_their_ends(include: Path, tmp_path: Path) -> None:
    body = "".join(f'    printf("%lld\\n", (long long)({call}));\n' for call in HELPERS)
    program = compile_c(["gcc", "-std=c99"], f'#include "lika/encoder.h"\n#include <stdio.h>\nint main(void)\n{{\n{body}    return 0;\n}}\n', tmp_path, include)
    printed = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout.split()
    assert dict(zip(HELPERS, map(int, printed))) == HELPERS
