"""Behaviour of virtual encoders: values from the manuals' examples, and rules of registers, presets and resets."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.reference import codec
from codewheel.virtual.clocked_lines import BissLine, SsiLine
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.rs485_line import Rs485Line
from codewheel.virtual.simulation_options import motion

#: A made-up encoder with fields of every kind.
WORDS = Path(__file__).parents[1] / "c/specs/words.yaml"


#: A made-up encoder with an alarm whose flag has another name.
TWICE = Path(__file__).parents[1] / "readings/specs/twice.yaml"


class Clock:
    """Time that a test sets."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_a_frame_of_the_manual_over_biss() -> None:
    """1,000,003 with 21 bits and 16 of revolutions. CRC by hand: x^6 + x + 1 over position, nE and nW, inverted."""
    bits = f"{1_000_003:037b}11"
    remainder = 0
    for bit in bits:
        remainder = remainder << 1 & 0x3F ^ 3 * (remainder >> 5 ^ int(bit))
    line = BissLine(VirtualEncoder("AMM5A21/65KSC1", 1_000_003))
    assert line.frame() == int(f"{bits}{remainder ^ 0x3F:06b}", 2)
    assert line.bits == 45


def test_a_reset_clears_the_flag_of_an_alarm_with_another_name() -> None:
    """The alarm too_hot has the flag hot."""
    specs = TWICE.parent
    encoder = VirtualEncoder("T10R", specs=[TWICE, specs / "manufacturer.yaml"])
    encoder.set_flag("hot")
    encoder.reset("reset_all")
    assert "hot" not in encoder.flags


def test_a_reply_over_rs_485() -> None:
    """Layout of 7.4: CF SF ABS0 ABS1 ABS2 ENID ABM0 ABM1 ABM2 ALMC CRC, where the CRC is the XOR of all others."""
    line = Rs485Line(VirtualEncoder("AMM5A23/65KJP1", 5 << 23 | 0x123456))
    line.receive(b"\x1a")
    reply = bytes.fromhex("1A 00 56 34 12 23 05 00 00 00")
    xor = 0
    for byte in reply:
        xor ^= byte
    assert line.send() == reply + bytes([xor])
    assert line.send() == b""


@pytest.mark.parametrize("order_code", ["WASC", "WBSC", "WBJP"])
def test_every_frame_of_a_made_up_encoder_is_valid(order_code: str) -> None:
    """Its fields include numbers for which the value 0 does not exist."""
    encoder = VirtualEncoder(order_code, specs=[WORDS, WORDS.parent / "manufacturer.yaml"])
    for layout in encoder.layouts("encoder"):
        identity = {layout.selector: layout.selects[0]} if layout.selector else {}
        decoded = codec.decode(encoder.device, encoder.place(layout), encoder.frame(layout, identity))
        assert decoded.problems == ()


def test_words_over_ssi_and_zeros_after_them() -> None:
    line = SsiLine(VirtualEncoder("AMM5A17/1BG1", 0x1F00F))
    levels = [line.clock(level) for _ in range(20) for level in (0, 1)][1::2]
    assert "".join(map(str, levels)) == f"{0x1F00F:017b}000"
    assert line.timeout() == 1


def test_the_line_of_biss_clock_by_clock() -> None:
    """Acknowledge from the second rising edge on, start, CDS, data, stop, and high after the timeout."""
    encoder = VirtualEncoder("AMM5A21/65KSC1", 1_000_003)
    line, plain_line = BissLine(encoder, acknowledge=4), BissLine(encoder)
    levels = [line.clock(level) for _ in range(55) for level in (0, 1)][1::2]
    bits = "".join(map(str, levels))
    assert bits == "1" + "0000" + "1" + "0" + f"{plain_line.frame():045b}" + "0" * 3
    assert line.timeout() == 1


@pytest.mark.parametrize("fault", ["late", "busy"])
def test_a_late_start_bit_moves_no_bit_of_the_data(fault: str) -> None:
    line, plain_line = (
        BissLine(VirtualEncoder("AMM5A21/65KSC1", 1_000_003, faults=faults)) for faults in ([fault], [])
    )
    assert [line.exchange(cdm) for cdm in (0, 1, 0)] == [plain_line.exchange(cdm) for cdm in (0, 1, 0)]
    assert line.encoder.faults.injected == {fault: 3}


def test_a_position_is_a_function_of_time(clock: Clock) -> None:
    line = BissLine(VirtualEncoder("AMM5A17/1SC1", lambda now: 1000 * now, clock=clock))
    clock.now = 2.5
    assert line.frame() >> 8 == 2500


def test_the_fields_of_a_frame_belong_to_one_moment() -> None:
    """The clock passes the end of BUSY between any two looks at it: position 0 and BUSY come together, or neither."""
    for look in range(8):
        times = iter([0.0] * (look + 3) + [1.0] * 100)
        encoder = VirtualEncoder("AMM5A23/65KJP1", 1234, clock=lambda times=times: next(times))
        encoder.be_busy(0.5)
        layout = next(layout for layout in encoder.layouts("encoder") if layout.name == "complete_reply")
        number = encoder.frame(layout, {"data_id": 3})
        assert (number >> 16 & 0xFFFFFF == 0) == (number >> 73 & 1 == 1)


@pytest.mark.parametrize(
    "text",
    [
        "12x",
        "sine:",
        "sine:nan",
        "ramp:1Hz",
        "sine:1e999Hz",
        "sine:1Hz:",
        "sine:1Hz:1e999",
        "sine:1Hz:1rad",
        "ramp:1:90deg",
        "",
    ],
)
def test_positions_that_are_none(text: str) -> None:
    with pytest.raises(ValueError, match="is not a position; write"):
        motion(text, 1000)


def test_notations_of_positions() -> None:
    sine, ramp = motion("sine:0.5Hz", 1001), motion("ramp:-1e3", 1001)
    assert motion("0x10", 1001) == 16
    assert callable(sine)
    assert callable(ramp)
    assert [round(sine(now)) for now in (0.0, 0.5, 1.5)] == [500, 1000, 0]
    assert ramp(2) == -2000


def test_a_sine_with_an_amplitude() -> None:
    """Around the middle, 8000 of 0 to 16000: 90 degrees are a quarter of the 4000 counts of a turn."""
    degrees, counts = motion("sine:0.5Hz:90deg", 16001, 0, 4000), motion("sine:0.5Hz:12.5", 1001, -500)
    assert callable(degrees)
    assert callable(counts)
    assert [round(degrees(now), 6) for now in (0.0, 0.5, 1.0, 1.5)] == [8000, 9000, 8000, 7000]
    assert [round(counts(now), 6) for now in (0.0, 0.5, 1.5)] == [0, 12.5, -12.5]
    with pytest.raises(ValueError, match=r"^'sine:1Hz:9deg' is an angle, but this encoder has no turns; "):
        motion("sine:1Hz:9deg", 1001)
    for text in ("sine:1Hz:501", "sine:1Hz:-1", "sine:1Hz:46deg"):
        with pytest.raises(ValueError, match=f"^'{text}' exceeds the range of this encoder; .* is 500 counts$"):
            motion(text, 1001, 0, 4000)


def test_ten_requests_reset_the_position_and_busy_follows(clock: Clock) -> None:
    """7.4.2: ten requests of data ID 8, 40 µs apart, then up to 18 ms in which all position data are 0."""
    encoder = VirtualEncoder("AMM5A23/65KJP1", 5 << 23 | 1234, clock=clock)
    line = Rs485Line(encoder)
    for at in range(10):
        clock.now += 40e-6
        line.receive(b"\xc2")
        # The tenth reply still has the old position.
        assert line.send()[2:5] == (1234).to_bytes(3, "little"), at
    line.receive(b"\x1a")
    assert line.send()[9] & 0x02
    clock.now += 0.0181
    line.receive(b"\x1a")
    assert line.send()[2:10] == bytes.fromhex("00 00 00 23 00 00 00 00")


@pytest.mark.parametrize("disturbance", ["other", "soon"])
def test_a_reset_needs_ten_requests_in_succession(clock: Clock, disturbance: str) -> None:
    encoder = VirtualEncoder("AMM5A23/65KJP1", 1234, clock=clock)
    line = Rs485Line(encoder)
    for at in range(10):
        clock.now += 10e-6 if at == 5 and disturbance == "soon" else 50e-6
        if at == 5 and disturbance == "other":
            line.receive(b"\x02")
        line.receive(b"\xc2")
    clock.now += 1
    assert encoder.position_now() == 1234


def test_a_reset_of_multiturn_and_errors_keeps_singleturn(clock: Clock) -> None:
    encoder = VirtualEncoder("AMM5A23/65KJP1", 5 << 23 | 1234, clock=clock)
    encoder.set_flag("battery_alarm", "mt_error")
    line = Rs485Line(encoder)
    line.receive(b"\x1a")
    assert line.send()[9] == 0xC0
    for _ in range(10):
        clock.now += 50e-6
        line.receive(b"\x62")
    clock.now += 0.003
    line.send()
    line.receive(b"\x1a")
    assert line.send()[1:10] == bytes.fromhex("00 D2 04 00 23 00 00 00 00")


def test_the_eeprom_is_busy_after_a_write(clock: Clock) -> None:
    """Frames of the T-format as in the examples: 32 01 5A and EA 01, each with its XOR."""
    answers = {"adf_layout": "as_t_format"}
    line = Rs485Line(VirtualEncoder("AMM5A23/65KJP1", choose=answers, clock=clock))
    line.receive(bytes.fromhex("32 01 5A 69"))
    assert line.send() == bytes.fromhex("32 01 5A 69")
    line.receive(bytes.fromhex("EA 01 EB"))
    assert line.send() == bytes.fromhex("EA 81 00 6B")
    clock.now = 0.1
    line.receive(bytes.fromhex("EA 01 EB"))
    assert line.send() == bytes.fromhex("EA 01 5A B1")


def test_damaged_requests_and_those_that_need_an_answer_get_no_reply() -> None:
    line = Rs485Line(VirtualEncoder("AMM5A23/65KJP1", choose={"adf_layout": "as_t_format"}))
    line.receive(bytes.fromhex("EA 01 EA 00 FF"))
    assert line.send() == b""
    line = Rs485Line(VirtualEncoder("AMM5A23/65KJP1"))
    line.receive(bytes.fromhex("EA 01 EB"))
    assert line.send() == b""


def test_rules_of_registers(clock: Clock) -> None:
    """6.4: the preset is opened by 01 at 40h, command and opening cannot be read, 78h cannot be written."""
    memory = VirtualEncoder("AMM5A21/65KSC1", clock=clock).memory
    assert not memory.write(0x11, 1)
    assert memory.write(0x40, 1)
    assert memory.write(0x12, 0x30)
    assert memory.read(0x12) == 0x30
    assert memory.read(0x40) is None
    assert memory.read(0x77) is None
    assert memory.read(0x10) is None
    assert not memory.write(0x78, 0)
    assert bytes(memory.read(at) or 0 for at in range(0x7E, 0x80)) == b"Li"


def test_a_preset_that_was_not_saved_is_lost_without_supply(clock: Clock) -> None:
    encoder = VirtualEncoder("AMM5A21/65KSC1", 500, clock=clock)
    for address, value in ((0x40, 1), (0x13, 0x01)):
        assert encoder.memory.write(address, value)
    encoder.restart()
    assert encoder.memory.read(0x13) == 0
    clock.now = 1
    for address, value in ((0x40, 1), (0x13, 0x01), (0x40, 0), (0x77, 1)):
        encoder.memory.write(address, value)
    encoder.restart()
    assert encoder.memory.read(0x13) == 1


def test_a_command_needs_its_wait(clock: Clock) -> None:
    """30 ms of EEPROM writing time: a command within it is not executed."""
    encoder = VirtualEncoder("AMM5A21/65KSC1", 500, clock=clock)
    encoder.memory.write(0x77, 1)
    clock.now = 0.029
    encoder.memory.write(0x77, 2)
    assert (encoder.position_now(), encoder.memory.too_early) == (500, 1)
    clock.now = 0.031
    encoder.memory.write(0x77, 2)
    assert (encoder.position_now(), encoder.memory.too_early) == (0, 1)


def test_a_run_time_register_changes_the_code_of_the_frame() -> None:
    """Configuration register 49h: output code Gray instead of binary."""
    plain = BissLine(VirtualEncoder("AM3616/4096-I7", 1000)).frame() >> 8
    encoder = VirtualEncoder("AM3616/4096-I7", 1000)
    encoder.memory.hold(0x49, 0)
    assert BissLine(encoder).frame() >> 8 == plain ^ plain >> 1


def test_errors_in_registers_set_the_error_flag_and_are_cleared_by_reading(clock: Clock) -> None:
    encoder = VirtualEncoder("ASC8522/SC1", choose={"zero_bit": "as_printed"}, clock=clock)
    line = BissLine(encoder)
    assert line.frame() >> 6 & 0b11 == 0b11
    encoder.set_flag("signal_error")
    assert line.frame() >> 6 & 0b11 == 0b01
    assert encoder.memory.read(0x69)
    for address in (0x69, 0x5A, *range(0x61, 0x65), 0x69):
        encoder.memory.read(address)
    assert encoder.flags == set()
    assert line.frame() >> 6 & 0b11 == 0b11


def test_editions() -> None:
    assert VirtualEncoder("AMM5A21/65KSC1", edition="1.5").device.edition == "1.5"


@pytest.mark.parametrize(
    ("code", "more", "message"),
    [
        ("AMM5A22/65KSC1", {}, "singleturn '22'"),
        ("nothing", {}, "not"),
        ("AMM5A21/65KSC1", {"faults": ["flop"]}, "'flop' is not a fault; write a name and a rate"),
        ("AMM5A21/65KSC1", {"faults": ["flip:2"]}, "'flip:2' is not a fault"),
        (
            "AMM5A21/65KSC1",
            {"registers": {"preset": b"1"}},
            "no register 'preset' of 1 bytes; the registers are: preset",
        ),
        ("AMM5A21/65KSC1", {"choose": {"a": "b"}}, "'a=b' answers no question"),
        ("ASC8522/SC1", {}, "choose zero_bit=as_printed or zero_bit=left_out"),
        ("AMM5A21/65KSC1", {"edition": "0.1"}, "0.1"),
    ],
)
def test_wrong_arguments(code: str, more: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message.replace("(", r"\(")):
        VirtualEncoder(code, **more)  # type: ignore[arg-type]


def test_wrong_flags_and_lines() -> None:
    encoder = VirtualEncoder("AMM5A21/65KSC1")
    with pytest.raises(ValueError, match="has no flag 'on'; it has: error, warning"):
        encoder.set_flag("on")
    with pytest.raises(ValueError, match="has the interface BiSS, not RS-485"):
        Rs485Line(encoder)
    with pytest.raises(ValueError, match="has no SSI"):
        SsiLine(encoder)
    with pytest.raises(ValueError, match="has no BiSS"):
        BissLine(VirtualEncoder("AMM5A17/1BG1"))


def test_specs_of_a_user(tmp_path: Path) -> None:
    from codewheel.commands.new import write_spec

    write_spec("my_encoder", tmp_path / "my_encoder.yaml")
    for specs in ([tmp_path], [str(tmp_path)]):
        assert BissLine(VirtualEncoder("MY-ENCODER-13-SC", 77, specs=specs)).frame() >> 8 == 77
