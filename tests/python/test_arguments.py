"""Numbers, bytes, encoders and labels that the generated package accepts, and those that it refuses."""

from __future__ import annotations

import array
import copy
import importlib
import inspect
import json
import os
import pickle
import re
import subprocess
import sys
import textwrap
import time
import unittest.mock
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Any

import codewheel_runtime
import numpy
import pytest
from codewheel.model import Device
from python_path import python_path

#: A published reply of an AMM5: control field, status, 7,000,519, CRC (tests/vectors.json).
REPLY, SINGLETURN = bytes.fromhex("02 20 C7 D1 6A 5E"), 7_000_519
#: The manual's reply of an SMA21.
LONG_REPLY, LONG_POSITION = bytes.fromhex("A2 00 10 32 54 00 D4"), 0x543210
#: A published BiSS frame of 22 bits, with two zeros of padding before it (tests/vectors.json).
BITS, POSITION = "00" + "000010111011111100101011011100", 192_458


@pytest.fixture(scope="session")
def lika(generated_python: tuple[Path, ModuleType]) -> Any:
    return generated_python[1]


@pytest.fixture(scope="session")
def rs485(lika: Any) -> Any:
    return lika.lookup("AMM5A23/65KJP1")


@pytest.fixture(scope="session")
def biss(lika: Any) -> Any:
    return lika.lookup("SMA21-SC1-0010")


def test_the_frames_are_the_published_ones(vectors: list[dict[str, Any]]) -> None:
    replies = [row for row in vectors if row["protocol"].startswith("Tamagawa T-format response")]
    assert [(bytes.fromhex(row["frame_hex_or_bits"]), row["fields"]["ABS"]) for row in replies] == [(REPLY, SINGLETURN)]
    assert any(row["frame_hex_or_bits"] == BITS[2:] and row["fields"]["position"] == POSITION for row in vectors)


# ------------------------------------------------------------ bytes


@pytest.mark.parametrize(
    "make_data",
    [
        bytearray,
        memoryview,
        lambda data: memoryview(b"x" + data + b"y")[1:-1],
        lambda data: memoryview(b"".join(bytes((byte, 0)) for byte in data))[::2],
        lambda data: array.array("B", data),
        lambda data: numpy.frombuffer(data, numpy.uint8),
        lambda data: numpy.frombuffer(data, numpy.int8),
        lambda data: numpy.frombuffer(data + data, numpy.uint8).reshape(2, -1)[1],
        lambda data: numpy.frombuffer(data, numpy.uint8).repeat(3)[::3],
    ],
)
def test_any_row_of_bytes_decodes(lika: Any, rs485: Any, make_data: Any) -> None:
    assert rs485.decode(make_data(REPLY)).singleturn == SINGLETURN
    assert lika.amm5.decode_reply(make_data(REPLY), rs485).singleturn == SINGLETURN
    assert lika.amm5.SingleturnReply.decode(make_data(REPLY), rs485).singleturn == SINGLETURN
    assert lika.lookup("SMA21-JP1-0005").decode(make_data(LONG_REPLY)).position == LONG_POSITION
    preset = make_data(bytes.fromhex("00 30 24 f4 00 00 00"))
    assert lika.amm5.Preset.decode(preset, lika.lookup("AMM5A21/65KSC1")).position == 1_000_003
    command = lika.amm5.Command.SAVE_PARAMETERS
    assert lika.amm5.Command.decode(make_data(command.encode())) is command
    assert lika.amm5.crc_rs485_8(make_data(REPLY[:-1])) == REPLY[-1]
    with pytest.raises(lika.CrcError) as caught:
        rs485.decode(make_data(REPLY[:-1] + b"\x00"))
    assert (caught.value.received, caught.value.computed) == (0, 0x5E)


@pytest.mark.parametrize(
    "not_bytes",
    [
        list(REPLY),
        tuple(REPLY),
        REPLY.hex(" "),
        REPLY.hex(),
        2,
        True,
        None,
        2.0,
        array.array("H", REPLY),
        array.array("H", list(REPLY)),
        numpy.frombuffer(REPLY, numpy.uint8).astype(numpy.uint16),
        numpy.frombuffer(REPLY, numpy.uint8).reshape(2, 3),
        numpy.uint8(2),
        numpy.frombuffer(REPLY, numpy.uint8).astype(bool),
        memoryview(REPLY).cast("H"),
        object(),
    ],
)
def test_what_is_no_row_of_bytes_is_refused(lika: Any, rs485: Any, not_bytes: Any) -> None:
    amm5 = lika.amm5
    takers = [rs485.decode, lambda data: amm5.decode_reply(data, rs485)]
    takers += [lambda data: amm5.EepromReadReply.decode(data, amm5.AdfLayout.AS_PRINTED)]
    for take in (*takers, amm5.Command.decode, amm5.crc_rs485_8):
        with pytest.raises(TypeError, match="pass bytes"):
            take(not_bytes)


# ------------------------------------------------------------ words


@pytest.mark.parametrize("make_number", [int, numpy.uint32, numpy.uint64, numpy.int64, numpy.array])
def test_any_whole_number_is_a_word(lika: Any, biss: Any, make_number: Any) -> None:
    assert biss.decode(make_number(int(BITS, 2))).position == POSITION
    assert lika.lookup("AMM5A23/65KBG1").decode(make_number(5)).singleturn == 5
    with pytest.raises(lika.CrcError):
        biss.decode(make_number(int(BITS, 2) ^ 1))


@pytest.mark.parametrize("not_a_number", [True, False, None, 3.0, numpy.float64(3), [1], numpy.array([1, 2]), object()])
def test_what_is_no_number_is_no_word(lika: Any, biss: Any, not_a_number: Any) -> None:
    for encoder in (biss, lika.lookup("AMM5A23/65KBG1")):
        message = rf"^{encoder.code}: the frame must be an integer, got "
        with pytest.raises(TypeError, match=message):
            encoder.decode(not_a_number)


@pytest.mark.parametrize("short_bytes", [b"\x01", bytearray(1), memoryview(b"\x01")])
def test_too_few_bytes_are_no_word(lika: Any, biss: Any, short_bytes: Any) -> None:
    size = (biss.frame_bits + 7) // 8
    with pytest.raises(lika.LengthError, match=f"^expected {size} bytes, got 1$"):
        biss.decode(short_bytes)


@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview])
def test_bytes_hold_a_word_with_zeros_in_front(lika: Any, kind: Any) -> None:
    encoder = lika.lookup("AMM5A21/65KSC1")
    # 45 bits in six bytes: the example of the manual page, 42 revolutions and 1821973 counts.
    frame = encoder.decode(kind(bytes.fromhex("00 05 5B CD 15 E2")))
    assert (frame.multiturn, frame.singleturn) == (42, 1821973)
    with pytest.raises(lika.LengthError, match=r"^expected 45 bits, got 48$"):
        encoder.decode(kind(bytes.fromhex("80 05 5B CD 15 E2")))


def test_a_negative_word_is_told_as_such(lika: Any, biss: Any) -> None:
    with pytest.raises(lika.RangeError, match="the frame must be 0 or more, got -5"):
        biss.decode(-5)


# ------------------------------------------------------------ length of a word


def test_text_of_bits_has_every_bit(lika: Any, biss: Any) -> None:
    for text in (BITS, f"0b{BITS}", f"{BITS[:16]}_{BITS[16:]}", f" {BITS[:8]} {BITS[8:]}\n"):
        assert biss.decode(text).position == POSITION
        assert biss.decode(text, bits=32).position == POSITION
    for text, length in ((BITS[1:], 31), (f"0{BITS}", 33), (f"{BITS}0", 33), ("", 0), ("0b", 0)):
        with pytest.raises(lika.LengthError) as caught:
            biss.decode(text)
        assert (caught.value.expected, caught.value.found, caught.value.unit) == (32, length, "bits")
    for text in (f"0x{int(BITS, 2):X}", "２" * 32, "１" * 32, BITS[:-1] + "2", "x" * 10**6):
        with pytest.raises(lika.RangeError, match="the frame must be a string of 0 and 1") as caught:
            biss.decode(text)
        assert len(str(caught.value)) < 200


def test_a_count_of_bits_that_is_wrong_is_refused(lika: Any) -> None:
    """A word of 39 bits, read with 40 clocks, or without the last 7. No CRC detects it."""
    encoder = lika.lookup("AMM5A23/65KBG1")
    word = 358_337_813
    assert encoder.frame_bits == 39
    assert encoder.decode(word, bits=39).position == word
    assert encoder.decode(word, bits=numpy.uint8(39)).position == word
    for read, bits in ((word << 1, 40), (word >> 7, 32)):
        with pytest.raises(lika.LengthError, match=f"expected 39 bits, got {bits}"):
            encoder.decode(read, bits=bits)
        with pytest.raises(lika.LengthError, match=f"expected 39 bits, got {bits}"):
            lika.amm5.SsiWord.decode(read, encoder, bits=bits)
        with pytest.raises(lika.LengthError):
            encoder.decode(f"{read:0{bits}b}")
    with pytest.raises(lika.LengthError):
        encoder.decode(f"{word:039b}", bits=40)
    for not_a_count in ("39", 39.0, True):
        with pytest.raises(TypeError, match="bits must be an integer, got "):
            encoder.decode(word, bits=not_a_count)
    with pytest.raises(TypeError, match="unexpected keyword argument 'bits'"):
        lika.lookup("AMM5A23/65KJP1").decode(REPLY, bits=48)


def test_every_encoder_knows_the_length_of_its_frame(lika: Any, devices: Mapping[str, Device]) -> None:
    for device in devices.values():
        for variant in device.variants:
            listed_encoder = lika.lookup(variant.code)
            layouts = device.interface(variant.interface).layouts
            layout = next(layout for layout in layouts if layout.sender == "encoder")
            if layout.carried_as == "bytes":
                assert not hasattr(listed_encoder, "frame_bits")
                continue
            if device.alternatives_of(layout):
                assert not hasattr(listed_encoder, "frame_bits")
                continue
            assert listed_encoder.frame_bits == layout.bits.value(variant.parameters)
    encoder = lika.lookup("AM3616/4096-I7")
    assert encoder.frame_bits - encoder.with_registers({0x56: 16}).frame_bits == 4
    amm5 = lika.lookup("AMM5A21/65KSC1")
    assert lika.amm5.SingleCycleData.frame_bits(amm5) == amm5.frame_bits == 37 + 8
    # ASC85 6.2.1 with the 0 bit, and as read by OnStepX.
    asc85, zero_bit = lika.lookup("ASC8525/SC1"), lika.asc85.ZeroBit
    assert lika.asc85.SingleCycleData.frame_bits(asc85, zero_bit.AS_PRINTED) == 34
    assert lika.asc85.SingleCycleData.frame_bits(asc85, zero_bit.LEFT_OUT) == 33


# ------------------------------------------------------------ numbers


def test_numbers_of_any_width_encode_rightly(lika: Any, rs485: Any) -> None:
    amm5 = lika.amm5
    biss = lika.lookup("AMM5A23/65KSC1")
    wanted = amm5.SingleCycleData(biss, 5, SINGLETURN)
    frame = amm5.SingleCycleData(biss, numpy.uint16(5), numpy.uint32(SINGLETURN), numpy.False_, numpy.False_)
    assert frame.encode() == wanted.encode()
    assert frame.position == wanted.position == 5 << 23 | SINGLETURN
    assert type(frame.encode()) is int
    assert type(frame.position) is int
    assert amm5.SingleCycleData.from_position(biss, numpy.uint64(wanted.position)) == wanted
    assert amm5.SsiWord(lika.lookup("AMM5A23/65KBG1"), numpy.uint8(5), numpy.uint32(7)).encode() == 5 << 23 | 7
    frame = amm5.SingleturnReply(rs485, numpy.uint8(0), numpy.False_, numpy.True_, numpy.uint32(SINGLETURN))
    assert frame.encode() == REPLY
    printed = amm5.AdfLayout.AS_PRINTED
    frame = amm5.EepromWriteRequest(printed, numpy.uint8(0x7F), numpy.uint8(0xFF))
    assert frame.encode() == amm5.EepromWriteRequest(printed, 0x7F, 0xFF).encode()
    assert amm5.DataRequest(numpy.uint8(12)).encode() == b"\x62"
    small = amm5.SerialNumber(*(numpy.uint8(value) for value in (20, 19, 1)))
    plain = amm5.SerialNumber(20, 19, 1)
    assert (small.encode(), small.serial) == (plain.encode(), plain.serial)
    assert lika.am36.NumberOfRevolutions(numpy.uint32(65536)).encode() == b"\x00\x00"
    assert lika.am36.InformationPerRevolution(numpy.uint16(4096)).encode() == b"\x00\x10\x00"
    assert amm5.crc_biss_6(numpy.uint16(0x1234), 16) == 0x07
    assert amm5.SingleCycleData.bit_fields(biss)[1].of(numpy.uint64(wanted.encode())) == SINGLETURN


def test_numbers_of_any_width_in_procedures(lika: Any) -> None:
    encoder = lika.lookup("AMM5A21/65KSC1")
    assert lika.amm5.set_preset(encoder, numpy.uint32(1_000_003)) == lika.amm5.set_preset(encoder, 1_000_003)
    am36 = lika.lookup("AM3616/4096-I7")
    assert lika.am36.set_preset(am36, numpy.int32(100_000)) == lika.am36.set_preset(am36, 100_000)
    for module in (lika.am36, lika.sma21):
        assert module.set_configuration(numpy.uint8(0x60)) == module.set_configuration(0x60)
    with pytest.raises(lika.RangeError):
        lika.amm5.set_preset(encoder, numpy.int64(-1))
    with pytest.raises(lika.RangeError):
        lika.am36.set_configuration(numpy.uint16(0x100))


def test_numbers_of_any_width_as_counts(lika: Any) -> None:
    encoder = lika.lookup("AMM5A23/65KJP1")
    position = 7_000_000
    assert encoder.degrees(numpy.int32(position)) == encoder.degrees(position) == position * 360 / (1 << 23)
    assert encoder.turns(numpy.uint32(position)) == encoder.turns(position)
    assert encoder.unwrap(numpy.int64(3), numpy.uint32(5)) == 5
    linear = lika.lookup("SMA21-SC1-0050")
    assert linear.micrometres(numpy.uint16(40_000)) == 2_000_000
    assert linear.millimetres(numpy.uint16(40_000)) == 2000.0
    for method in (encoder.degrees, encoder.turns, linear.micrometres, linear.millimetres):
        for not_a_count in (numpy.array([1, 2]), 1.5, "1"):
            with pytest.raises(TypeError):
                method(not_a_count)


def test_registers_held_and_read_take_any_whole_number(lika: Any) -> None:
    encoder = lika.lookup("AM3616/4096-I7")
    register_bytes = {0x4E: 0x07, 0x4F: 0xD0}
    narrow = {numpy.uint8(key): numpy.uint8(value) for key, value in register_bytes.items()}
    assert encoder.with_registers(narrow) == encoder.with_registers(register_bytes)
    for value, error in ((256, ValueError), (-1, ValueError), (True, TypeError), (1.0, TypeError), ("1", TypeError)):
        with pytest.raises(error, match="register 0x56"):
            encoder.with_registers({0x56: value})
    codes = lika.identify({"manufacturer_id": b"Li"})
    assert codes
    assert lika.identify({"manufacturer_id": numpy.frombuffer(b"Li", numpy.uint8)}) == codes
    assert lika.identify({numpy.uint8(0x7E): numpy.uint8(ord("L")), numpy.uint8(0x7F): numpy.uint8(ord("i"))}) == codes
    for read in ({"manufacturer_id": [76, 105]}, {0x7E: b"L"}, {0x7E: True}, {None: 1}):
        with pytest.raises(TypeError):
            lika.identify(read)


def test_half_of_a_register_leaves_the_other_half(lika: Any) -> None:
    encoder = lika.lookup("AM3616/4096-I7").with_registers({0x4E: 0x07, 0x4F: 0xD0})
    assert encoder.with_registers({0x4F: 0xD1}).used_revolutions == 2001


@pytest.mark.parametrize("not_a_number", [True, False, 5.0, "5", None])
def test_what_is_no_number_is_not_encoded(lika: Any, not_a_number: Any) -> None:
    amm5, encoder = lika.amm5, lika.lookup("AMM5A21/65KSC1")
    for call in (
        lambda: amm5.SingleCycleData(encoder, 0, not_a_number).encode(),
        lambda: amm5.SingleCycleData.from_position(encoder, not_a_number),
        lambda: amm5.EepromReadRequest(amm5.AdfLayout.AS_PRINTED, not_a_number).encode(),
        lambda: amm5.DataRequest(not_a_number).encode(),
        lambda: amm5.set_preset(encoder, not_a_number),
        lambda: lika.am36.set_configuration(not_a_number),
        lambda: lika.am36.NumberOfRevolutions(not_a_number).encode(),
        lambda: lika.am36.InformationPerRevolution(not_a_number).encode(),
        lambda: lika.biss.encode_byte(not_a_number),
        lambda: encoder.unwrap(0, not_a_number),
    ):
        with pytest.raises(TypeError, match=r"must be an integer( or an object of [\w.]+)?, got "):
            call()


def test_a_register_of_another_class_is_refused(lika: Any) -> None:
    needed = r"configuration must be an integer or an object of lika_encoders.am36.Configuration, got Configuration\("
    with pytest.raises(TypeError, match=needed):
        lika.am36.set_configuration(lika.sma21.Configuration.decode(b"\x60"))


def test_control_frames_take_numbers_of_any_width(lika: Any, vectors: list[dict[str, Any]]) -> None:
    rows = [row for row in vectors if row["protocol"].startswith("BiSS-C register read")]
    assert len(rows) == 13
    for row in rows:
        request = lika.biss.Request(numpy.uint8(row["fields"]["ID"]), numpy.uint8(row["fields"]["ADR"]))
        assert f"0x{request.encode():X}" == row["frame_hex_or_bits"].split()[0]
    assert lika.biss.encode_byte(numpy.uint8(0x40)) == 0x408
    assert lika.biss.decode_byte(numpy.uint16(0x408)) == 0x40


@pytest.mark.parametrize("bit", [int, bool, numpy.uint8, numpy.bool_, numpy.int8])
def test_control_bits_of_any_kind(lika: Any, bit: Any) -> None:
    master, slave, cdm = lika.biss.Master(), lika.biss.Slave(), 0
    master.read(numpy.uint8(0x78), numpy.uint8(2), busy_limit=0)
    while master.outcome is lika.biss.Outcome.RUNNING:
        cds = slave.next(bit(cdm))
        if slave.wants is lika.biss.Wants.BYTE:
            slave.give(numpy.uint8(slave.address))
        cdm = master.next(bit(cds))
    assert (master.outcome, master.data) == (lika.biss.Outcome.DONE, b"xy")


def test_a_master_writes_bytes_only(lika: Any) -> None:
    for not_bytes in (array.array("H", [1, 2]), numpy.array([1, 2], numpy.uint16), "ab"):
        with pytest.raises(TypeError, match="pass bytes"):
            lika.biss.Master().write(0x10, not_bytes, busy_limit=0)
    lika.biss.Master().write(0x10, numpy.array([1, 2], numpy.uint8), busy_limit=0)


@pytest.mark.slow
def test_the_package_does_not_import_numpy(generated_python: tuple[Path, ModuleType]) -> None:
    script = "import sys, lika_encoders.biss; sys.exit('numpy' in sys.modules)"
    environment = {**os.environ, "PYTHONPATH": python_path(generated_python[0])}
    assert subprocess.run([sys.executable, "-c", script], env=environment, check=False).returncode == 0


# ------------------------------------------------------------ encoders


def functions(module: Any) -> list[tuple[str, Any]]:
    """Return everything public of a family module that takes an encoder, with a name."""
    named_functions = []
    for name in module.__all__:
        member = getattr(module, name)
        if inspect.isclass(member):
            members = [(f"{name}.{key}", getattr(member, key)) for key in vars(member) if not key.startswith("_")]
            named_functions += [(key, method) for key, method in members if inspect.isroutine(method)]
        elif inspect.isfunction(member):
            named_functions.append((name, member))
    return [(name, function) for name, function in named_functions if takes_variant(function)]


def takes_variant(function: Any) -> bool:
    return "variant" in inspect.signature(function).parameters


def test_an_encoder_of_another_family_or_interface_is_refused(lika: Any, devices: Mapping[str, Device]) -> None:
    """Every function of every module refuses the encoders of all others, before any other argument is checked."""
    for device in devices.values():
        module = getattr(lika, device.name)
        taking = functions(module)
        assert len(taking) > 12, device.name
        encoders = [next(iter(getattr(lika, name).VARIANTS.values())) for name in devices if name != device.name]
        for name, function in taking:
            for encoder in encoders:
                with pytest.raises(lika.FamilyError) as caught:
                    _call_with(function, encoder)
                wanted = f"{encoder.code} belongs to the family {encoder.family.name}, not to {device.name}"
                assert str(caught.value) == wanted, name
            kinds = {variant.interface: variant for variant in module.VARIANTS.values()}
            refused = 0
            for encoder in kinds.values():
                try:
                    _call_with(function, encoder)
                except lika.InterfaceError as error:
                    assert encoder.code in str(error)
                    assert error.found is encoder.interface
                    refused += 1
                except (ValueError, TypeError):
                    pass
            assert refused == len(kinds) - 1, name


def _call_with(function: Any, encoder: Any) -> object:
    """Call a function with the encoder by name, and with 0 for all other required arguments."""
    parameters = inspect.signature(function).parameters
    required = [key for key, parameter in parameters.items() if parameter.default is inspect.Parameter.empty]
    needed = [key for key in required if key != "variant"]
    return function(**dict.fromkeys(needed, 0), variant=encoder)


def test_what_was_accepted_before_is_refused(lika: Any) -> None:
    am36, biss, ssi = lika.lookup("AM3616/4096-I7"), lika.lookup("AMM5A21/65KSC1"), lika.lookup("AMM5A21/65KBG1")
    for call in (
        lambda: lika.amm5.set_preset(am36, 1),
        lambda: lika.amm5.SingleCycleData.decode(0xF4243D3, am36),
        lambda: lika.amm5.Preset.from_position(am36, 1),
        lambda: lika.amm5.set_preset(lika.lookup("ASC8525/SC1"), 1),
        lambda: lika.amm5.SingleCycleData(am36, 0, 5).encode(),
        lambda: lika.amm5.SingleCycleData(am36, 0, 5).position,
        lambda: lika.am36.set_preset(biss, 1),
        lambda: lika.am36.set_configuration(0x60, variant=biss),
    ):
        with pytest.raises(lika.FamilyError):
            call()
    # The message lists what exists over the interface of the encoder.
    with pytest.raises(lika.InterfaceError) as caught:
        lika.amm5.set_preset(lika.lookup("AMM5A23/65KJP1"), 1)
    begin = "AMM5A23/65KJP1 has the interface RS-485, but this needs BiSS. Procedures over RS-485: "
    assert str(caught.value).startswith(begin)
    assert "reset_singleturn_and_multiturn" in str(caught.value)
    with pytest.raises(lika.InterfaceError, match=r"AMM5A21/65KBG1 has the interface SSI, but this needs BiSS$"):
        lika.amm5.set_preset(ssi, 1)
    with pytest.raises(lika.InterfaceError, match=r"AMM5A21/65KBG1 has the interface SSI, but this needs BiSS$"):
        lika.amm5.SingleCycleData.decode(0xF4243D3, ssi)
    for not_an_encoder in ("AMM5A21/65KSC1", None, 5, lika.amm5.FAMILY):
        with pytest.raises(TypeError, match=r"expected an encoder, got .*; lookup\(\) returns one"):
            lika.amm5.set_preset(not_an_encoder, 1)
    assert not issubclass(lika.FamilyError, lika.FrameError)
    assert not issubclass(lika.InterfaceError, lika.FrameError)
    assert issubclass(lika.FamilyError, ValueError)
    assert issubclass(lika.InterfaceError, ValueError)


def test_every_procedure_takes_the_encoder(lika: Any, devices: Mapping[str, Device]) -> None:
    for device in devices.values():
        module = getattr(lika, device.name)
        for procedure in device.procedures:
            function = getattr(module, f"{procedure.name}_steps", None) or getattr(module, procedure.name)
            encoders = {encoder.interface.value: encoder for encoder in module.VARIANTS.values()}
            encoder = encoders[procedure.interface]
            if not procedure.arguments:
                assert function(encoder) == function(variant=encoder)
                if inspect.signature(function).parameters["variant"].default is None:
                    assert function() == function(encoder)


# ------------------------------------------------------------ labels


@pytest.mark.parametrize("endless_label", ["x" * 10**6, "AMM5A21/65KSC1-" + "A" * 10**6, "-" * 10**6, " " * 10**6])
def test_a_label_without_end_is_refused_at_once(lika: Any, endless_label: str) -> None:
    for find in (lika.lookup, lika.amm5.lookup, lika.am36.lookup):
        begin = time.monotonic()
        with pytest.raises(
            lika.OrderCodeError, match=r"is not an order code: it has \d+ characters, more than"
        ) as caught:
            find(endless_label)
        assert time.monotonic() - begin < 0.5
        assert len(str(caught.value)) < 200
        assert len(caught.value.label) < 50
        assert caught.value.nearest == ()


@pytest.mark.parametrize("not_a_label", [None, 5, True, b"AMM5A21/65KSC1", ["AMM5A21/65KSC1"]])
def test_what_is_no_text_is_no_label(lika: Any, not_a_label: Any) -> None:
    for find in (lika.lookup, lika.amm5.lookup):
        with pytest.raises(TypeError, match=r"the label must be a string such as the order code, got "):
            find(not_a_label)


# ------------------------------------------------------------ equality


def test_frames_of_different_classes_are_never_equal(lika: Any, rs485: Any) -> None:
    amm5, biss, ssi = lika.amm5, lika.lookup("AMM5A21/65KSC1"), lika.lookup("AMM5A21/65KBG1")
    printed, plain_form = amm5.AdfLayout
    pairs = [
        (amm5.EepromWriteReply(printed, 1, False, 2), amm5.EepromReadReply(printed, 1, False, 2)),
        (amm5.EepromReadReply(printed, 1, False, 2), amm5.EepromReadReply(plain_form, 1, False, 2)),
        (amm5.SsiWord(ssi, 0, 5), amm5.Preset(ssi, 0, 5)),
        (amm5.DataRequest(amm5.DataId.SINGLETURN), amm5.EepromReadRequest(printed, 0)),
        (lika.am36.SsiWord(biss, 0, 5), amm5.SsiWord(biss, 0, 5)),
        (codewheel_runtime.Modify(1, 1, "a", 1, 1), codewheel_runtime.Poll(1, 1, "a", 1, 1)),
        (amm5.SsiWord(ssi, 0, 5), (ssi, 0, 5)),
    ]
    for first, plain_form in pairs:
        assert first != plain_form
        assert plain_form != first
        assert not first == plain_form  # noqa: SIM201
        assert not plain_form == first  # noqa: SIM201
        assert len({first, plain_form}) == 2
        assert hash(first) != hash(plain_form)
        copied = type(first)(*first)
        assert first == copied
        assert not first != copied  # noqa: SIM202
        assert hash(first) == hash(copied)
        assert len({first, copied}) == 1
        assert pickle.loads(pickle.dumps(first)) == first == copy.deepcopy(first)
    assert amm5.SsiWord(ssi, 0, 5) == unittest.mock.ANY
    assert amm5.SsiWord(ssi, 0, 5) != amm5.SsiWord(ssi, 0, 6)


def test_every_frame_and_register_is_equal_by_class(lika: Any, devices: Mapping[str, Device]) -> None:
    for device in devices.values():
        module = getattr(lika, device.name)
        public = [getattr(module, name) for name in module.__all__]
        classes = [member for member in public if inspect.isclass(member) and hasattr(member, "_fields")]
        assert len(classes) > 4
        for frame_class in classes:
            assert frame_class.__eq__ is not tuple.__eq__
            assert frame_class.__hash__ is not tuple.__hash__


def test_registers_and_special_labels_show_and_count(lika: Any) -> None:
    encoder = lika.lookup("AM3616/4096-I7")
    smaller = encoder.with_registers({0x56: 16, 0x49: 0x00})
    assert repr(encoder) == "<AM3616/4096-I7>"
    assert encoder.with_registers({0x56: 20}) == encoder
    assert repr(smaller).startswith("<AM3616/4096-I7 ")
    assert "used_singleturn_bits=16" in repr(smaller)
    assert smaller != encoder
    assert hash(smaller) != hash(encoder)
    plain, special, renamed = (lika.lookup(f"AMM5A21/65KSC1{tail}") for tail in ("", "/S901", "-ABC/s902"))
    representations = [repr(encoder) for encoder in (plain, special, renamed)]
    assert representations == ["<AMM5A21/65KSC1>", "<AMM5A21/65KSC1/S901>", "<AMM5A21/65KSC1/S902>"]
    assert len({plain, special, renamed}) == 3
    assert plain != special != renamed
    assert [encoder.special for encoder in (plain, special, renamed)] == [False, True, True]
    assert lika.lookup("AMM5A21/65KSC1-ABC") == plain
    assert special == lika.lookup("amm5a21/65ksc1/s901")


def test_as_delivered_nothing_shows(lika: Any, devices: Mapping[str, Device]) -> None:
    for device in devices.values():
        for code in getattr(lika, device.name).VARIANTS:
            assert repr(lika.lookup(code)) == f"<{code}>"


# ------------------------------------------------------------ facts


def test_no_fact_can_be_changed(lika: Any) -> None:
    facts = importlib.import_module("codewheel_runtime.facts")
    for facts_object in (facts.FieldFacts("x"), facts.Alarm("x", "y"), lika.amm5.REGISTERS["preset"]):
        with pytest.raises(TypeError):
            facts_object.names["it"] = "changed"
        assert not hasattr(facts_object.names, "update")
        assert not hasattr(facts_object.names, "clear")
    assert facts.FieldFacts("y").names == {}
    assert "changed" not in lika.amm5.REGISTERS["preset"].names.values()
    for part in lika.sma21.ORDER_CODE.parts:
        with pytest.raises(TypeError):
            part.open_only_with["x"] = ()
    named = next(register for register in lika.sma21.REGISTERS.values() if register.names)
    assert pickle.loads(pickle.dumps(named)) == named == copy.deepcopy(named)
    assert json.dumps(dict(named.names))


def test_only_their_own_names_are_offered(lika: Any, devices: Mapping[str, Device]) -> None:
    """Return every class, function and constant of a module, except imported ones."""
    for device in devices.values():
        module = getattr(lika, device.name)
        public = {name: value for name, value in vars(module).items() if not name.startswith("_")}
        defined = {name for name, value in public.items() if getattr(value, "__module__", "") == module.__name__}
        constants = {name for name in [*public, *module.__all__] if name.isupper()} - {"TYPE_CHECKING"}
        assert sorted(set(module.__all__)) == module.__all__
        assert defined | constants <= set(module.__all__)
        unions = set(module.__all__) - defined - constants
        assert all(name.endswith(("Frame", "Reply", "Request")) for name in unions)
        assert not {"agrees", "check_width", "NamedTuple", "FieldFacts", "dataclasses"} & set(module.__all__)


def test_the_version_is_known(lika: Any, library: Any) -> None:
    assert lika.__version__ == library.devices[0].manufacturer.version


def test_a_step_tells_its_byte_order(lika: Any) -> None:
    steps = lika.am36.set_preset(lika.lookup("AM3616/4096-I7"), 100_000)
    step = next(candidate for candidate in steps if isinstance(candidate, codewheel_runtime.Modify))
    assert step.length == 1
    assert step.order == "little"
    assert codewheel_runtime.Poll(0, 2, "x", 1, 1, order="big").order == "big"


def test_a_reply_does_not_ask(lika: Any) -> None:
    for reply in (lika.amm5.SingleturnReply, lika.amm5.CompleteReply.data_id, lika.amm5.DataId):
        assert "What is asked for" not in (reply.__doc__ or "")


# ------------------------------------------------------------ copies


def test_the_examples_look_at_the_verdict_first(
    lika: Any, generated_python: tuple[Path, ModuleType], devices: Mapping[str, Device]
) -> None:
    readme = (generated_python[0] / "README.md").read_text(encoding="utf-8")
    look = "if frame.verdict is not Verdict.NOT_USABLE:"
    blocks = [block.partition("```")[0] for block in readme.split("```python")[1:]]
    line_pairs = [pair for block in blocks for pair in pairwise(block.splitlines())]
    positions = [(before, line) for before, line in line_pairs if "print(frame." in line]
    assert len(positions) >= 3
    assert all(before == f">>> {look}" and line.startswith("...     ") for before, line in positions)
    for device in devices.values():
        lines = [line.strip() for line in (getattr(lika, device.name).__doc__ or "").splitlines()]
        assert lines[lines.index(look) + 1].startswith("print(frame."), device.name


def test_the_first_example_prints_no_position_of_a_frame_with_an_error(
    generated_python: tuple[Path, ModuleType], capsys: pytest.CaptureFixture[str]
) -> None:
    readme = (generated_python[0] / "README.md").read_text(encoding="utf-8")
    assert readme.index("pip install") < readme.index("```python") < readme.index("| `frame.verdict` |")
    assert "**Not yet tested on hardware.**" in readme[: readme.index("pip install")]
    block = readme.split("```python\n")[1].partition("```")[0]
    code = "\n".join(line[4:] for line in block.splitlines() if line.startswith((">>> ", "... ")))
    exec(code, {})
    assert capsys.readouterr().out == "42 1821973 89902357\n"
    # The same frame with the error bit of BiSS active, which is then 0, and with the matching CRC.
    assert "0x55bcd15e2" in code
    exec(code.replace("0x55bcd15e2", "0x55bcd1564"), {})
    assert capsys.readouterr().out == ""


def test_the_examples_of_the_docstrings_run(
    lika: Any, devices: Mapping[str, Device], capsys: pytest.CaptureFixture[str]
) -> None:
    for device in devices.values():
        text = getattr(lika, device.name).__doc__ or ""
        code = text[text.index("    from lika_encoders") : text.index("\n\n", text.index("    print(frame."))]
        exec(textwrap.dedent(code), {})
        assert re.fullmatch(r"\d+( \d+)*\n", capsys.readouterr().out), device.name
