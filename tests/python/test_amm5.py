"""The generated package against the manual's worked examples and published vectors."""

from __future__ import annotations

import doctest
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import codewheel_runtime
import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library

Generated = tuple[Path, ModuleType]


@pytest.fixture(scope="session")
def lika(generated_python: Generated) -> Any:
    return generated_python[1]


@pytest.fixture(scope="session")
def amm5(lika: Any) -> Any:
    return lika.amm5


# ------------------------------------------------------------------------------------------------ the manual's examples


@pytest.mark.slow
def test_preset_of_the_manual(amm5: Any, lika: Any) -> None:
    variant = amm5.lookup("AMM5A21/65KSC1")
    assert amm5.Preset.from_position(variant, 1000003).encode() == bytes.fromhex("00 30 24 F4 00 00 00")
    assert amm5.Preset.decode(bytes.fromhex("00 30 24 F4 00 00 00"), variant).position == 1000003
    steps = amm5.set_preset(variant, 1000003)
    kinds = [type(step).__name__ for step in steps]
    assert kinds == ["Write"] * 8 + ["Verify"] + ["Write"] * 2 + ["Wait", "Write", "Wait"]
    assert [step.microseconds for step in steps if isinstance(step, codewheel_runtime.Wait)] == [30_000, 30_000]
    assert {step.register for step in steps[1:8]} == {"preset"}


def test_serial_number_of_the_manual(amm5: Any) -> None:
    serial_number = amm5.SerialNumber.decode(bytes.fromhex("0A E8 69 EE"))
    assert (serial_number.year, serial_number.week, serial_number.number) == (18, 30, 3630)
    assert serial_number.serial == 183003630
    with pytest.raises(ValueError):
        amm5.SerialNumber.decode(b"\xff\xff\xff\xff")


def test_the_crc_example_is_a_crc_and_no_frame(amm5: Any, lika: Any) -> None:
    data = bytes.fromhex("32 10 01 28 B0 08 B3")
    assert amm5.crc_rs485_8(data[:-1]) == data[-1]
    for variant in amm5.VARIANTS.values():
        if variant.interface is lika.Interface.RS485:
            with pytest.raises(lika.LengthError):
                variant.decode(data)


def test_printed_timeouts(amm5: Any) -> None:
    timeout = amm5.BISS.timeout
    assert [timeout.nanoseconds(hertz) for hertz in (50_000, 200_000, 10_000_000)] == [30_000, 7_500, 150]


def test_counts_as_an_angle(amm5: Any) -> None:
    variant = amm5.lookup("AMM5A21/65KSC1")
    assert variant.turns(3 << 20) == 1.5
    assert variant.degrees(3 << 20) == 180.0
    frame = amm5.SingleCycleData(variant, multiturn=7, singleturn=1 << 19)
    assert (variant.turns(frame.position), variant.degrees(frame.position)) == (7.25, 90.0)


def test_cable_table(amm5: Any) -> None:
    assert [amm5.SSI.clock_below_hz(metres) for metres in (10, 50, 199.9, 399, 400)] == [
        400_000,
        300_000,
        200_000,
        100_000,
        None,
    ]


def test_resets_are_sent_ten_times(amm5: Any, lika: Any) -> None:
    for name, byte in (
        ("reset_errors", 0xBA),
        ("reset_singleturn_and_multiturn", 0xC2),
        ("reset_multiturn_and_errors", 0x62),
    ):
        send = getattr(amm5, name)()[0]
        # 7.4.2 p.45: ten times in succession, at intervals of 40 µs or more.
        # 7.2.1 p.41 and 7.4.2: each is answered by a reply of six bytes, of which the last is the XOR of the others.
        request = bytes([byte])
        intervals = {"times": 10, "every_us": 40, "in_succession": True}
        expected = codewheel_runtime.Send(request, **intervals, reply_length=6, reply_ends_in_xor=True)
        assert send == expected
        assert "Stop polling" in " ".join((getattr(amm5, name).__doc__ or "").split())


# ---------------------------------------------------------------------------------------------------- published vectors


def test_published_crc_6(amm5: Any, vectors: list[dict[str, Any]]) -> None:
    rows = [row for row in vectors if row["protocol"] == "BiSS-C CRC6 raw"]
    assert rows
    for row in rows:
        assert amm5.crc_biss_6(row["fields"]["data"], row["fields"]["data_bits"]) == row["fields"]["CRC6_inverted"]


def test_published_crc_4(amm5: Any, vectors: list[dict[str, Any]]) -> None:
    rows = [row for row in vectors if row["protocol"].startswith(("BiSS-C register read", "BiSS-C register write"))]
    assert len(rows) == 14
    for row in rows:
        fields = row["fields"]
        computed = amm5.crc_biss_4(fields["CTS"] << 10 | fields["ID"] << 7 | fields["ADR"], 11)
        if row["verified"]:
            assert computed == fields["CRC4_inverted"]
        else:
            assert computed == fields["CRC4_expected"] != fields["CRC4_printed"]
            assert amm5.crc_biss_4(fields["DATA"], 8) == fields["DATA_CRC4"]
    data = [row for row in vectors if row["protocol"] == "BiSS-C register data byte"]
    assert data
    assert all(amm5.crc_biss_4(row["fields"]["DATA"], 8) == row["fields"]["CRC4_inverted"] for row in data)


def test_published_control_fields(amm5: Any, lika: Any, vectors: list[dict[str, Any]]) -> None:
    rows = [row for row in vectors if row["protocol"] == "Tamagawa control field"]
    assert len(rows) == 9
    variant = amm5.lookup("AMM5A23/65KJP1")
    for row in rows:
        number, control = row["fields"]["data_id"], row["fields"]["CF"]
        facts = next(data_id for data_id in amm5.RS485.data_ids if data_id.id == number)
        assert facts.control == control
        if number in (6, 13):
            form = amm5.AdfLayout.AS_PRINTED
            request = amm5.EepromWriteRequest(form, 0, 0) if number == 6 else amm5.EepromReadRequest(form, 0)
        else:
            request = amm5.DataRequest(amm5.DataId(number))
        assert request.encode()[0] == control
        assert amm5.decode_request(request.encode(), variant, adf_layout=amm5.AdfLayout.AS_PRINTED) == request
    # Data IDs that this encoder does not have, from another device of the same protocol.
    for row in vectors:
        if row["protocol"] == "Panasonic control field" and row["fields"]["data_id"] not in (6, 13):
            with pytest.raises(lika.RangeError):
                amm5.decode_request(bytes([row["fields"]["CF"]]), variant)


def test_published_reply(amm5: Any, vectors: list[dict[str, Any]]) -> None:
    row = next(row for row in vectors if row["protocol"].startswith("Tamagawa T-format response"))
    reply = amm5.lookup("AMM5A23/65KJP1").decode(bytes.fromhex(row["frame_hex_or_bits"]))
    assert isinstance(reply, amm5.SingleturnReply)
    assert reply.singleturn == row["fields"]["ABS"]
    assert (reply.status_st_error, reply.status_other_error) == (False, True)


def test_the_adf_has_two_layouts(amm5: Any, lika: Any, vectors: list[dict[str, Any]]) -> None:
    """HPMicro's three frames have the plain address. The manual prints EA 0A E0 for address 5 (7.5 p.46)."""
    printed, plain = amm5.AdfLayout
    assert (printed.name, plain.name) == ("AS_PRINTED", "AS_T_FORMAT")
    encoder = amm5.lookup("AMM5A23/65KJP1")
    rows = [row for row in vectors if row["protocol"] == "Tamagawa T-format request"]
    frames = [bytes.fromhex(row["frame_hex_or_bits"]) for row in rows]
    assert frames == [bytes.fromhex(text) for text in ("32 7F 01 4C", "32 01 5A 69", "EA 01 EB")]
    for row, frame in zip(rows, frames, strict=True):
        request = amm5.decode_request(frame, encoder, adf_layout=plain)
        assert request.address == row["fields"]["ADF"]
        assert getattr(request, "data", None) == row["fields"].get("EDF")
        assert request.encode() == frame
        with pytest.raises(lika.ConstantError, match="mem_busy"):
            amm5.decode_request(frame, encoder, adf_layout=printed)
    assert amm5.EepromReadRequest(printed, 5).encode() == bytes.fromhex("EA 0A E0")
    assert amm5.EepromReadRequest(plain, 5).encode() == bytes.fromhex("EA 05 EF")
    busy = amm5.EepromReadReply(plain, 5, True, 0)
    assert busy.encode()[1] == 0x85
    assert encoder.decode(busy.encode(), adf_layout=plain) == busy
    assert [report.name for report in busy.reports] == ["eeprom_read_reply_mem_busy"]


@pytest.mark.parametrize("not_a_form", [None, 0, "AS_PRINTED", (1, 0)])
def test_the_layout_of_the_adf_has_no_default(amm5: Any, not_a_form: Any) -> None:
    encoder, printed = amm5.lookup("AMM5A23/65KJP1"), amm5.AdfLayout.AS_PRINTED
    request, reply = amm5.EepromReadRequest(printed, 5), amm5.EepromReadReply(printed, 5, False, 7)
    for call in (
        lambda: amm5.EepromReadRequest(not_a_form, 5).encode(),
        lambda: amm5.EepromReadRequest.decode(request.encode(), not_a_form),
        lambda: amm5.EepromReadRequest.bit_fields(not_a_form),
        lambda: amm5.decode_request(request.encode(), encoder, adf_layout=not_a_form),
        lambda: amm5.decode_reply(reply.encode(), encoder, adf_layout=not_a_form),
        lambda: encoder.decode(reply.encode(), adf_layout=not_a_form),
    ):
        with pytest.raises(TypeError, match=r"adf_layout must be AdfLayout.AS_PRINTED or AdfLayout.AS_T_FORMAT, got"):
            call()
    # Neither do invalid frames, nor frames that do not depend on it.
    for damaged, error in ((reply.encode()[:-1], "LengthError"), (reply.encode()[:-1] + b"\x00", "CrcError")):
        with pytest.raises(ValueError) as caught:
            encoder.decode(damaged, adf_layout=not_a_form)
        assert type(caught.value).__name__ == error
    position = amm5.SingleturnReply(encoder, amm5.DataId.SINGLETURN, False, False, 5)
    assert encoder.decode(position.encode()) == position


def test_another_encoder_id_is_reported_and_the_frame_decoded(amm5: Any, lika: Any) -> None:
    """7.4 p.43 prints ENID 23h; HPMicro's T-format sample has 17h, ST A5A5h and MT 8888h. The bytes follow."""
    encoder = amm5.lookup("AMM5A23/65KJP1")
    data = bytes.fromhex("1A 00 A5 A5 00 17 88 88 00 00 0D")
    reply = encoder.decode(data)
    assert (reply.singleturn, reply.multiturn, reply.encoder_id) == (0xA5A5, 0x8888, 0x17)
    assert not reply.is_as_documented
    assert reply.encode() == data
    documented = reply._replace(encoder_id=0x23)
    assert documented.is_as_documented
    assert encoder.decode(documented.encode()) == documented
    alone = encoder.decode(bytes.fromhex("92 00 17 85"))
    assert (alone.encoder_id, alone.is_as_documented) == (0x17, False)
    # By default, a simulator sends the printed values.
    assert amm5.EncoderIdReply().encode() == bytes.fromhex("92 00 23 B1")
    assert amm5.CompleteReply.from_position(encoder, 5).encoder_id == 0x23
    # Sync code and data ID are still checked.
    for first_byte, error in ((0x1B, lika.ConstantError), (0x9A, lika.ConstantError), (0x12, lika.FrameError)):
        with pytest.raises(error):
            encoder.decode(bytes([first_byte]) + data[1:-1] + bytes([data[-1] ^ 0x1A ^ first_byte]))


def test_published_single_cycles(
    vectors: list[dict[str, Any]], import_generated: Callable[[Library, str], Generated]
) -> None:
    devices, report = load_library([Path(__file__).parent.parent / "specs"])
    assert not report, "\n".join(problem.format() for problem in report.problems)
    package: Any = import_generated(
        Library(tuple(device for device in devices if device.name == "bits22")), "test_encoders"
    )[1]
    rows = [row for row in vectors if row["protocol"] == "BiSS-C SCD"]
    assert len(rows) == 9
    variant = package.lookup("T22SC")
    for row in rows:
        fields, word = row["fields"], int(row["frame_hex_or_bits"], 2)
        frame = variant.decode(word)
        assert tuple(frame) == (variant, fields["position"], not fields["nE"], not fields["nW"])
        assert word & 0x3F == fields["CRC6_inverted"]
        assert frame.encode() == word
        with pytest.raises(package.CrcError):
            variant.decode(word ^ 0x100)


# ---------------------------------------------------------------------------------------------------------- order codes


@pytest.mark.parametrize(
    ("label", "part", "words"),
    [
        ("AMM5A19/65KSC1", "singleturn", "has singleturn '19'; valid values: 17, 21, 23"),
        ("AMM5C21/65KSC1", "mount", "has mount 'C'; valid values: A, B"),
        ("AMM5A21/65KSC2", "interface", "has interface 'SC2'; valid values: BG1, SC1, JP1"),
        ("AMM5A/65KSC1", "singleturn", "has no singleturn"),
        ("nonsense", "", "'NONSENSE' is not an order code of"),
    ],
)
def test_unknown_order_codes(lika: Any, label: str, part: str, words: str) -> None:
    with pytest.raises(lika.OrderCodeError) as caught:
        lika.lookup(label)
    assert words in str(caught.value)
    assert caught.value.part == part
    assert len(caught.value.nearest) == 3
    assert caught.value.nearest[0] in str(caught.value)


# --------------------------------------------------------------------------------------------------------- small things


def test_errors_can_be_pickled(lika: Any) -> None:
    for error in (
        lika.LengthError(3, 4),
        lika.CrcError(1, 2),
        lika.ConstantError("sync", 1, 2),
        lika.RangeError("data_id", 5, "1 to 3"),
        lika.OrderCodeError("X", "", "is none", ("Y",)),
    ):
        copy = pickle.loads(pickle.dumps(error))
        assert str(copy) == str(error)
        assert vars(copy) == vars(error)


def test_frames_of_the_wrong_kind(amm5: Any) -> None:
    with pytest.raises(TypeError):
        amm5.lookup("AMM5A21/65KSC1").decode(2.0)
    with pytest.raises(amm5.LengthError):
        amm5.lookup("AMM5A21/65KSC1").decode(b"\x02")
    with pytest.raises(TypeError):
        amm5.lookup("AMM5A21/65KJP1").decode(2)


def test_encoding_refuses_what_does_not_fit(amm5: Any, lika: Any) -> None:
    biss, rs485 = amm5.lookup("AMM5A17/1SC1"), amm5.lookup("AMM5A17/1JP1")
    refused_calls = [
        lambda: amm5.SingleCycleData(biss, 0, 1 << 17).encode(),
        lambda: amm5.SingleCycleData(biss, 1, 0).encode(),
        lambda: amm5.SingleCycleData(biss, 0, -1).encode(),
        lambda: amm5.SingleCycleData.from_position(biss, 1 << 17),
        lambda: amm5.Preset.from_position(biss, -1),
        lambda: amm5.set_preset(biss, 1 << 17),
        lambda: amm5.EepromReadRequest(amm5.AdfLayout.AS_PRINTED, 128).encode(),
        lambda: amm5.DataRequest(amm5.DataId.EEPROM_READ).encode(),
        lambda: amm5.SingleturnReply(rs485, amm5.DataId.MULTITURN, False, False, 0).encode(),
        lambda: amm5.SerialNumber(100, 1, 1).encode(),
        lambda: amm5.ManufacturerId("Lika").encode(),
        lambda: amm5.ManufacturerId("\u01001").encode(),
    ]
    for call in refused_calls:
        with pytest.raises(lika.RangeError):
            call()
    with pytest.raises(ValueError, match="has the interface RS-485, but this needs BiSS"):
        amm5.set_preset(rs485, 1)


def test_readme_examples(generated_python: Generated) -> None:
    folder, _ = generated_python
    blocks = re.findall(r"```python\n(.*?)```", (folder / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    assert blocks
    test = doctest.DocTestParser().get_doctest("\n".join(blocks), {}, "README.md", None, 0)
    import sys

    sys.path.insert(0, str(folder))
    try:
        assert doctest.DocTestRunner().run(test).failed == 0
    finally:
        sys.path.remove(str(folder))
