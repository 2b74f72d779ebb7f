"""Mistakes in frames of bytes with a CRC of several bytes, such as MODBUS: the command and the page find the same."""

from __future__ import annotations

import io
import json
import random
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import reduce
from operator import xor
from pathlib import Path
from typing import Any

import pytest
from browser_harness import Asker, Case, cases, library_of
from codewheel.commands.cli import main
from codewheel.model import Constant, Crc, number_to_bytes
from codewheel.one_line.spec import device_of_line
from codewheel.reference.bits_and_values import compute_bytes, reflect
from codewheel.say.frame_texts import NOT_SEARCHED
from codewheel.targets import Library
from test_browser_codec import expected_explanations

Capture = pytest.CaptureFixture[str]
SPECS = Path(__file__).resolve().parents[1] / "specs"

#: A reply of MODBUS, with the CRC low byte first and the number high byte first.
MODBUS = "rs485,high_byte_first:address=8,constant=8:0x03,length=8,position=32,crc=16:0x8005:0xffff:reflected"
MODBUS += ":low_byte_first"
REPLY = bytes.fromhex("01 03 04 00 00 17 E8 F5 8D")
REQUEST = bytes.fromhex("01 03 00 00 00 02 C4 0B")
DATA = REPLY[:-2]
LINES = {
    "MODBUS": MODBUS,
    "low first": "rs485,low_byte_first:constant=8:0x1a,position=24,crc=16:0x1021",
    "inverted": "rs485,high_byte_first:position=32,status=8,crc=16:0x1021:0xffff:inverted",
    "32 bits": "rs485,high_byte_first:position=32,crc=32:0x4c11db7:0xffffffff:reflected:inverted:low_byte_first",
    "8 bits": "rs485,low_byte_first:status=8,position=24,crc=8:0x7",
    "8 bits and a constant": "rs485,high_byte_first:address=8,constant=8:0x42,position=32,crc=8:0x101",
}

MISTAKES = {
    "echo before the reply": (REQUEST + REPLY, "8 extra bytes before the frame, such as an echo of the request"),
    "two replies": (REPLY + REPLY, "the bytes are whole frames: reply, then reply"),
    "first byte missing": (REPLY[1:], "the first byte (01) is missing"),
    "one behind": (REPLY[1:] + b"\0", "the first byte (01) is missing, and an extra byte follows the frame"),
    "last byte missing": (REPLY[:-1], "the last byte, a part of the CRC, is missing"),
    "CRC reversed": (DATA + bytes.fromhex("B1 AF"), "the bits of the CRC are in reverse order"),
    "CRC swapped": (DATA + REPLY[:-3:-1], "the bytes of the CRC are swapped"),
    "inverted": (bytes(byte ^ 0xFF for byte in REPLY), "every bit is inverted"),
    "bits reversed": (bytes(reflect(byte, 8) for byte in REPLY), "the bits of each byte are in reverse order"),
    "bits reversed, CRC swapped": (
        bytes(reflect(byte, 8) for byte in DATA + REPLY[:-3:-1]),
        "the bits of each byte are in reverse order, and the bytes of the CRC are swapped",
    ),
    "start value": (DATA + bytes.fromhex("EE 8D"), "the start value of the CRC is 0x0"),
    "CCITT-FALSE": (DATA + bytes.fromhex("8B E8"), "the CRC is that of CCITT-FALSE"),
    "XMODEM swapped": (DATA + bytes.fromhex("19 45"), "the CRC is that of XMODEM, and its bytes are swapped"),
    "KERMIT": (DATA + bytes.fromhex("67 0D"), "the CRC is that of KERMIT"),
}


def explanations_of(capsys: Capture, line: str, received: bytes) -> list[dict[str, Any]]:
    main(["decode", line, received.hex(" "), "--json"])
    explanations: list[dict[str, Any]] = json.loads(capsys.readouterr().out)["why"]["explanations"]
    return explanations


#: Messages of MODBUS in its specification, section 6: a request for two registers, the error message 2, and a register.
OTHER_MESSAGES = {
    "request": REQUEST,
    "error": bytes.fromhex("01 83 02 C0 F1"),
    "reply": bytes.fromhex("01 03 02 00 01 79 84"),
}


@pytest.mark.parametrize("name", OTHER_MESSAGES)
def test_another_message_of_modbus_is_recognised_by_its_crc(name: str, capsys: Capture) -> None:
    explanation, *_ = explanations_of(capsys, MODBUS, OTHER_MESSAGES[name])
    assert explanation["text"].startswith("the CRC at the end is correct, so this is a whole message of another length")
    assert explanation["one_in"] == 1 << 16


@pytest.mark.parametrize("name", MISTAKES)
def test_the_command_names_the_mistake_in_a_frame_of_modbus(name: str, capsys: Capture) -> None:
    received, text = MISTAKES[name]
    explanation, *_ = explanations_of(capsys, MODBUS, received)
    assert explanation["text"] == text
    assert explanation["reads"] in ({}, {"address": 1, "length": 4, "position": 6120})


def test_a_usual_crc_is_found_for_a_line_with_modbus_parameters(capsys: Capture) -> None:
    """XMODEM and CCITT-FALSE differ only in the start value, and MODBUS is known by its name."""
    line = "rs485,high_byte_first:address=8,function=8,length=8,position=32,crc=16:0x1021:low_byte_first"
    assert explanations_of(capsys, line, REPLY)[0]["text"] == "the CRC is that of MODBUS"


def test_many_places_do_not_make_a_match_certain(capsys: Capture) -> None:
    """A window of 45 bits in 64 bits has few places, each with a chance of 1 of 64."""
    main(["decode", "AMM5A21/65KSC1", "55 bc d1 5e 20 01 02 03", "--json"])
    why = json.loads(capsys.readouterr().out)["why"]
    assert why["explanations"] == []
    assert why["coincidence"] < 0.6


def test_a_lost_byte_that_was_searched_proves_a_byte_less(capsys: Capture) -> None:
    """256 values were tried, so 24 bits of CRC and constants prove only 16."""
    (explanation,) = explanations_of(capsys, MODBUS, REPLY[1:])
    assert explanation["one_in"] == 1 << 16


def test_a_first_byte_that_any_frame_could_have_is_not_searched(capsys: Capture) -> None:
    """With a CRC of 8 bits, a first byte makes every frame valid. Its constant bits do not prove that it is lost."""
    line = "rs485,high_byte_first:constant=4:0x5,address=4,position=24,crc=8:0x7"
    _, crc = device_and_crc(line)
    frame = with_crc(crc, bytes.fromhex("5A 01 02 03"))
    assert not any("first byte" in each["text"] for each in explanations_of(capsys, line, frame[1:]))


def test_another_address_of_a_frame_with_an_xor_is_found_by_the_constants(capsys: Capture) -> None:
    """SKM36: the XOR fits one address in any case, but the command shows that it is missing."""
    frame = bytes.fromhex("37 42 00 01 02 03")
    checksum = reduce(xor, frame)
    (explanation,) = explanations_of(capsys, "SKM36", frame[1:] + bytes([checksum]))
    assert explanation["text"] == "the first byte (37) is missing"
    assert explanation["one_in"] == 1 << 8


def test_three_frames_are_judged_together(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    _, crc = device_and_crc(MODBUS)
    frames = [with_crc(crc, bytes.fromhex(f"01 03 04 00 00 {data}")) for data in ("17 E8", "20 01", "2A BC")]
    text = "\n".join(frame[1:].hex(" ") for frame in frames)
    monkeypatch.setattr("sys.stdin", io.StringIO(text))
    main(["decode", MODBUS, "-"])
    assert "the first byte (01) is missing" in " ".join(capsys.readouterr().out.split())


def device_and_crc(line: str) -> tuple[Case, Crc]:
    """Return the reply of the encoder in a line, and its CRC. Its order code is the one in the generated spec."""
    device, match = device_of_line(line)
    variant = replace(match.variant, code="ONE-LINE-RS485")
    device = replace(device, variants=(variant,))
    reply = next(layout for layout in device.interface("rs485").layouts if layout.sender == "encoder")
    placed = reply.place(variant.parameters)
    crc = device.crc_of(placed)
    assert crc is not None
    return Case(device, variant, placed), crc


def with_crc(crc: Crc, data: bytes) -> bytes:
    """Return the bytes with their CRC low byte first."""
    return data + compute_bytes(crc, data).to_bytes(crc.width // 8, "little")


def data_with_constants(case: Case, numbers: random.Random) -> bytes:
    """Return random bytes with the constants of a frame."""
    number = numbers.getrandbits(case.placed.bits)
    for field in case.placed.fields:
        if isinstance(field.field.kind, Constant):
            number = number & ~(field.mask << field.lowest_bit) | field.field.kind.value << field.lowest_bit
    return number_to_bytes(case.layout, number, case.placed.bits)


def planted_frames(line: str, numbers: random.Random) -> Iterator[bytes]:
    """Yield valid frames of a line with mistakes."""
    case, crc = device_and_crc(line)
    crc_length = crc.width // 8
    for _ in range(2):
        data = data_with_constants(case, numbers)[:-crc_length]
        inverted = replace(crc, xorout=crc.xorout ^ crc.mask)
        in_other_order = replace(crc, refin=not crc.refin, refout=not crc.refout)
        for other_crc in (crc, inverted, in_other_order):
            computed = compute_bytes(other_crc, data)
            for order in ("little", "big"):
                frame = data + computed.to_bytes(crc_length, order)
                yield from (frame[1:], frame[:-1], frame[1:] + b"\x55", frame + frame, b"\x1a" + frame, frame + b"\0")
                yield from (numbers.randbytes(8) + frame, bytes(byte ^ 0xFF for byte in frame))
                yield from (bytes(reflect(byte, 8) for byte in frame), frame)
                yield with_crc(other_crc, numbers.randbytes(numbers.randrange(1, 12)))
                place = numbers.randrange(len(frame))
                yield frame[:place] + bytes([frame[place] ^ 4]) + frame[place + 1 :]


@pytest.mark.starts_process
@pytest.mark.parametrize("name", LINES)
def test_the_page_finds_the_same(name: str, ask: Callable[[Library, str], Asker]) -> None:
    case, _ = device_and_crc(LINES[name])
    frames = [frame.hex(" ") for frame in planted_frames(LINES[name], random.Random(16))]
    expected = [expected_explanations(case, frame) for frame in frames]
    (answers,) = ask(Library((case.device,)), "node")("reasons", [{**case.data, "frames": frames}])
    # The command counts corrupted bits in the bytes as received, and the page in the number of the frame.
    difference_by_frame = {
        frame: (answer, explained)
        for frame, answer, explained in zip(frames, answers, expected, strict=True)
        if [*answer[:-1], len(answer[-1])] != [*explained[:-1], len(explained[-1])]
    }
    assert difference_by_frame == {}
    assert sum(bool(explained[0]) for explained in expected) >= 20


@pytest.mark.starts_process
def test_a_crc_that_is_not_whole_bytes_is_not_searched(capsys: Capture, ask: Callable[[Library, str], Asker]) -> None:
    """The CRC of 12 bits belongs to bits that are stored in bytes."""
    text = "00 01 02 03 04 05 06 07 00 01"
    main(["decode", "CS", text, "--specs", str(SPECS)])
    assert f"{NOT_SEARCHED}." in " ".join(capsys.readouterr().out.split())
    (case,) = [case for (case, *_) in cases(library_of("specs/long_crc").devices[0]) if case.variant.code == "CS"]
    ((answer,),) = ask(library_of("specs/long_crc"), "node")("reasons", [{**case.data, "frames": [text]}])
    assert answer[0] == []


#: AMT21 without a CRC: both replies have two parity bits, so each is also valid as the other one.
TURNS_AFTER_REQUEST = "55 E4 B2"


def test_a_reply_is_the_one_to_the_request_in_front_of_it(capsys: Capture) -> None:
    (explanation,) = explanations_of(capsys, "AMT212A", bytes.fromhex(TURNS_AFTER_REQUEST))
    assert explanation["text"] == "the bytes are whole frames: request turns_request, then reply turns_reply"
    assert explanation["reads"] == {"turns": -3356}


@pytest.mark.starts_process
def test_the_page_names_the_same_reply(ask: Callable[[Library, str], Asker]) -> None:
    library = library_of("../specs/cui/amt21")
    device = library.devices[0]
    variant = device.variant("AMT212A")
    reply = next(layout for layout in device.interface("rs485").layouts if layout.sender == "encoder")
    case = Case(device, variant, reply.place(variant.parameters))
    expected = expected_explanations(case, TURNS_AFTER_REQUEST)
    ((answer,),) = ask(library, "node")("reasons", [{**case.data, "frames": [TURNS_AFTER_REQUEST]}])
    assert answer == expected
    assert "turns -3356" in str(answer)
