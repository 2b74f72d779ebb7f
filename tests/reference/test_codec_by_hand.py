"""Frames of the reference codec, computed by hand from the definition of each kind of field.

All generated codecs are compared with the reference, which only these frames and the manuals' frames check.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import pytest
from codewheel.loading.library import load_library
from codewheel.model import Device, Fault, PlacedLayout
from codewheel.reference import codec

Values = dict[str, "int | str | bool"]

#: Layout, order code, values in the order of the decoder, and the frame. The last column computes it.
FRAMES: list[tuple[str, str, Values, int]] = [
    # Two's complement of 4 bits. 16 is sent as 0.
    ("number_word", "HABG", {"sign": -8, "level": 16, "power": 1}, 0b1000_0000_0001),
    ("number_word", "HABG", {"sign": 7, "level": 15, "power": 8}, 0b0111_1111_1000),
    ("number_word", "HABG", {"sign": -1, "level": 1, "power": 4}, 0b1111_0001_0100),
    # An active flag is 0 if it is active low.
    ("flag_word", "HABG", {"low": True, "high": True, "mode": "fast", "mark": 9}, 0b0_1_10_1001),
    ("flag_word", "HABG", {"low": False, "high": False, "mode": "slow", "mark": 9}, 0b1_0_01_1001),
    # Unused bits have the values in the manual. 1 in 'unused' is a bit that differs. The last field has its lowest
    # bits.
    ("spare_word", "HABG", {"first_spare": 2, "value": 5, "second_spare": 1, "unused": 0}, 0b10_101_001),
    ("spare_word", "HABG", {"first_spare": 1, "value": 5, "second_spare": 5, "unused": 0b11_100}, 0b01_101_101),
    ("digit_word", "HABG", {"lot": 2307, "year": 23, "batch": 7}, 2307),
    ("digit_word", "HABG", {"lot": 9999, "year": 99, "batch": 99}, 9999),
    # Four bits for each decimal digit, of which the first one has only two.
    ("bcd_word", "HABG", {"decimal_number": 312}, 0b11_0001_0010),
    ("bcd_word", "HABG", {"decimal_number": 390}, 0b11_1001_0000),
    ("text_word", "HABG", {"label": "Az"}, 0x41 << 8 | 0x7A),
    # 101 and 0111 have five 1 bits, 0111 has three. 011 and 0101 have four, 0101 has two.
    ("parity_word", "HABG", {"a": 5, "b": 7, "even": 1, "odd": 0}, 0b101_0111_1_0),
    ("parity_word", "HABG", {"a": 3, "b": 5, "even": 0, "odd": 1}, 0b011_0101_0_1),
    # CRCs of control frames on a screenshot in TexasInstruments/motor-control-sdk, bissc_hex_control_commands.png.
    ("crc_word", "HABG", {"value": 0x40, "crc": 8}, 0x408),
    ("crc_word", "HABG", {"value": 0x06, "crc": 5}, 0x065),
    ("part_word", "HABG", {"before": 3, "value": 0x40, "after": 5, "crc": 8}, 0b11_01000000_101_1000),
    ("part_word", "HABG", {"before": 0, "value": 0x06, "after": 2, "crc": 5}, 0b00_00000110_010_0101),
    # The Gray code of n is n ^ n >> 1: 170 ^ 85 is 255, and 100 ^ 50 is 86.
    # With 5 bits of angle, 170 is 5 turns and 10, and 100 is 3 turns and 4.
    ("gray_word", "HABG", {"turns": 5, "angle": 10, "fault": False, "position": 170}, 255 << 1),
    ("gray_word", "HABG", {"turns": 3, "angle": 4, "fault": True, "position": 100}, 86 << 1 | 1),
    # 9 ^ 4 is 13. The bits above and below are not in Gray code.
    ("inner_gray_word", "HABG", {"marker": 2, "position": 9, "below": 3}, 0b10_1101_11),
    ("gray_word", "HBBG", {"angle": 170, "fault": False, "position": 170}, 255 << 1),
    ("gray_word", "HBBG", {"angle": 100, "fault": True, "position": 100}, 86 << 1 | 1),
]
#: Values that are in a frame, but are computed and not passed to the encoder.
COMPUTED = {"mark", "marker", "first_spare", "second_spare", "even", "odd", "crc"}
#: Layout, frame, and the errors: kind, field and message, the most important first.
BROKEN_FRAMES: list[tuple[str, int, list[tuple[Fault, str, str]]]] = [
    ("flag_word", 0b0_1_10_1000, [(Fault.CONSTANT, "mark", "mark is 0x8, but it must be 0x9")]),
    ("flag_word", 0b0_1_11_1001, [(Fault.RANGE, "mode", "mode has no value 0x3")]),
    ("flag_word", 0b0_1_00_1001, [(Fault.RANGE, "mode", "mode has no value 0x0")]),
    (
        "flag_word",
        0b0_1_00_0000,
        [
            (Fault.CONSTANT, "mark", "mark is 0x0, but it must be 0x9"),
            (Fault.RANGE, "mode", "mode has no value 0x0"),
        ],
    ),
    ("digit_word", 10000, [(Fault.RANGE, "lot", "lot is 10000, but it has at most 4 digits")]),
    ("parity_word", 0b101_0111_1_1, [(Fault.CONSTANT, "odd", "odd is 1, but it must be 0 as the parity of b")]),
    ("parity_word", 0b101_0111_0_0, [(Fault.CONSTANT, "even", "even is 0, but it must be 1 as the parity of a, b")]),
    ("crc_word", 0x409, [(Fault.CRC, "crc", "expected CRC 0x08, got 0x09")]),
    ("crc_word", 0x418, [(Fault.CRC, "crc", "expected CRC 0x0b, got 0x08")]),
    ("part_word", 0b11_01000000_101_1100, [(Fault.CRC, "crc", "expected CRC 0x08, got 0x0c")]),
    ("crc_word", 0x1408, [(Fault.LENGTH, "", "'crc_word' has 12 bits, got 13")]),
]
#: Layout, order code, values, and the reason why they cannot be encoded.
REFUSED: list[tuple[str, str, Values, str]] = [
    ("number_word", "HABG", {"sign": 8, "level": 1, "power": 1}, "sign 8 does not fit into 4 bits"),
    ("number_word", "HABG", {"sign": -9, "level": 1, "power": 1}, "sign -9 does not fit into 4 bits"),
    ("number_word", "HABG", {"sign": 0, "level": 0, "power": 1}, "level 0 does not fit into 4 bits"),
    ("number_word", "HABG", {"sign": 0, "level": 17, "power": 1}, "level 17 does not fit into 4 bits"),
    ("number_word", "HABG", {"sign": 0, "level": 1, "power": 3}, "power 3 is not a power of two"),
    ("number_word", "HABG", {"sign": 0, "level": 1, "power": 0}, "power 0 is not a power of two"),
    ("number_word", "HABG", {"sign": 0, "level": 1, "power": 16}, "power 16 does not fit into 4 bits"),
    ("number_word", "HABG", {"sign": "low", "level": 1, "power": 1}, "'low' is not a number"),
    ("flag_word", "HABG", {"low": False, "high": False, "mode": "medium"}, "mode has no value 'medium'"),
    ("flag_word", "HABG", {"low": False, "high": False, "mode": 4}, "mode 4 does not fit into 2 bits"),
    ("flag_word", "HABG", {"low": False, "high": False}, "'mode' is missing"),
    ("crc_word", "HABG", {"value": 1, "speed": 2}, "there is no field 'speed' in crc_word"),
    ("crc_word", "HABG", {"value": 256}, "value 256 does not fit into 8 bits"),
    ("crc_word", "HABG", {"value": -1}, "value -1 does not fit into 8 bits"),
    ("spare_word", "HABG", {"value": 5, "unused": 0x20}, "'unused' has the bits 0x20, which are not unused bits"),
    ("crc_word", "HABG", {"value": 5, "unused": 0}, "there is no field 'unused' in crc_word"),
    ("digit_word", "HABG", {"year": 100, "batch": 0}, "year 100 has more than 2 digits"),
    ("digit_word", "HABG", {"year": 0, "batch": -1}, "batch -1 has more than 2 digits"),
    ("gray_word", "HABG", {"position": 256, "fault": False}, "position 256 does not fit"),
    ("gray_word", "HABG", {"position": -1, "fault": False}, "position -1 does not fit"),
    ("gray_word", "HABG", {"position": 170, "turns": 4, "fault": False}, "position and its fields disagree"),
    ("gray_word", "HBBG", {"angle": 1, "turns": 1, "fault": False}, "turns 1 does not fit: this order code has no"),
]


@pytest.fixture(scope="module")
def device() -> Device:
    devices, report = load_library([Path(__file__).parent / "specs"])
    assert not report.problems
    return devices[0]


def place(device: Device, layout: str, code: str = "HABG") -> PlacedLayout:
    return device.layout(layout).place(device.variant(code).parameters)


@pytest.mark.parametrize(("layout", "code", "values", "frame"), FRAMES)
def test_a_frame_is_encoded_and_decoded(device: Device, layout: str, code: str, values: Values, frame: int) -> None:
    placed = place(device, layout, code)
    decoded = codec.decode(device, placed, frame)
    assert decoded.problems == ()
    assert decoded.values == values
    assert {name: type(value) for name, value in decoded.values.items()} == {
        name: type(value) for name, value in values.items()
    }
    assert codec.encode(device, placed, {name: values[name] for name in values if name not in COMPUTED}) == frame


@pytest.mark.parametrize(("layout", "frame", "problems"), BROKEN_FRAMES)
def test_a_broken_frame_has_its_errors(
    device: Device, layout: str, frame: int, problems: list[tuple[Fault, str, str]]
) -> None:
    decoded = codec.decode(device, place(device, layout), frame)
    assert [(problem.fault, problem.field, problem.message) for problem in decoded.problems] == problems


@pytest.mark.parametrize(("layout", "code", "values", "message"), REFUSED)
def test_values_that_do_not_fit_are_refused(
    device: Device, layout: str, code: str, values: Values, message: str
) -> None:
    with pytest.raises(codec.EncodeError) as refusal:
        codec.encode(device, place(device, layout, code), values)
    assert str(refusal.value).startswith(message)


def test_parts_of_a_join_alone_are_enough(device: Device) -> None:
    placed = place(device, "gray_word")
    by_fields = codec.encode(device, placed, {"turns": 5, "angle": 10, "fault": False})
    with_both = codec.encode(device, placed, {"position": 170, "turns": 5, "angle": 10, "fault": False})
    assert by_fields == with_both == 255 << 1


def test_a_field_without_bits_may_be_0(device: Device) -> None:
    assert codec.encode(device, place(device, "gray_word", "HBBG"), {"angle": 0, "turns": 0, "fault": False}) == 0


def test_raw_numbers_are_those_on_the_wire(device: Device) -> None:
    """All 8 bits of the position are 1, so each field of it is, too. The fault is sent in binary."""
    decoded = codec.decode(device, place(device, "gray_word"), 255 << 1)
    raw = {field.name: field.raw for field in decoded.fields}
    assert raw == {"turns": 7, "angle": 31, "fault": 0, "position": 255}
    places = {field.name: (field.high, field.low) for field in decoded.fields}
    # The position is computed from two fields, and has no place of its own.
    assert places == {"turns": (8, 6), "angle": (5, 1), "fault": (0, 0), "position": (-1, -1)}


def test_received_and_computed_crc(device: Device) -> None:
    valid = codec.decode(device, place(device, "crc_word"), 0x408).crc
    broken = codec.decode(device, place(device, "crc_word"), 0x409).crc
    assert valid is not None
    assert broken is not None
    assert (valid.name, valid.received, valid.computed, valid.ok) == ("crc_4", 8, 8, True)
    assert (broken.received, broken.computed, broken.ok) == (9, 8, False)
    assert codec.decode(device, place(device, "text_word"), 0x417A).crc is None


@pytest.mark.parametrize(
    ("bits", "messages"),
    [
        (11, ["'crc_word' has 12 bits, got 11"]),
        (12, []),
        (13, ["'crc_word' has 12 bits, got 13"]),
    ],
)
def test_the_number_of_bits_is_checked(device: Device, bits: int, messages: list[str]) -> None:
    decoded = codec.decode_bits(device, place(device, "crc_word"), 0x408, bits)
    assert [problem.message for problem in decoded.problems] == messages


#: Replies as bytes, with their layout and count. The exclusive or of 01, 34 and 12 is 27, the exclusive or of 03, 12
#: and 34 is 25. "MODBUS over Serial Line V1.02", appendix B: the CRC of 02 07 is 1241h, and its low byte 41 is sent
#: first.
REPLIES = [
    ("01341227", "low_reply", 0x1234),
    ("03123425", "high_reply", 0x1234),
    ("02074112", "modbus_reply", 7),
]


@pytest.mark.parametrize(("data", "layout", "count"), REPLIES)
def test_the_first_byte_identifies_a_reply(device: Device, data: str, layout: str, count: int) -> None:
    decoded = codec.decode_bytes(device, device.variant("HAJP"), "encoder", bytes.fromhex(data))
    assert decoded.problems == ()
    assert decoded.layout is not None
    assert (decoded.layout.name, decoded.values["count"]) == (layout, count)
    frame = codec.encode(device, decoded.layout, {"count": count})
    order: Literal["big", "little"] = "big" if layout == "high_reply" else "little"
    assert frame.to_bytes(len(data) // 2, order) == bytes.fromhex(data)


@pytest.mark.parametrize(
    ("sender", "data", "problem"),
    [
        ("encoder", "", (Fault.LENGTH, "", "0 bytes: too short to identify the frame")),
        ("encoder", "09341227", (Fault.RANGE, "id", "id is 9, but it must be 1, 2, 3")),
        ("encoder", "013412", (Fault.LENGTH, "", "'low_reply' has 4 bytes, got 3")),
        ("encoder", "0134122700", (Fault.LENGTH, "", "'low_reply' has 4 bytes, got 5")),
        ("encoder", "01", (Fault.LENGTH, "", "'low_reply' has 4 bytes, got 1")),
        ("encoder", "03", (Fault.LENGTH, "", "'high_reply' has 4 bytes, got 1")),
        ("encoder", "01341226", (Fault.CRC, "crc", "expected CRC 0x27, got 0x26")),
        ("encoder", "02074113", (Fault.CRC, "crc", "expected CRC 0x1241, got 0x1341")),
        ("drive", "01", (Fault.RANGE, "", "the drive sends no frames on this interface")),
        ("master", "04", (Fault.RANGE, "id", "id is 4, but it must be 1, 2, 3")),
    ],
)
def test_bytes_that_are_no_reply(device: Device, sender: str, data: str, problem: tuple[Fault, str, str]) -> None:
    decoded = codec.decode_bytes(device, device.variant("HAJP"), sender, bytes.fromhex(data))
    assert [(error.fault, error.field, error.message) for error in decoded.problems] == [problem]


def test_a_frame_of_another_layout(device: Device) -> None:
    """The frame is valid, but its first byte belongs to the other reply."""
    placed = place(device, "high_reply", "HAJP")
    decoded = codec.decode_placed(device, placed, bytes.fromhex("01123427"))
    assert [problem.message for problem in decoded.problems] == ["id 1 does not belong to this frame"]


def test_a_request_that_several_values_select_needs_one(device: Device) -> None:
    placed = place(device, "request", "HAJP")
    assert codec.encode(device, placed, {"id": 3}) == 3
    with pytest.raises(codec.EncodeError, match=r"^'id' is missing$"):
        codec.encode(device, placed, {})
