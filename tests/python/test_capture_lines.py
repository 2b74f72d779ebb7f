"""Captures of encoders: replies over RS-485, accesses to registers over BiSS, and the command."""

from __future__ import annotations

import csv
import io
import itertools
import json
import math
import random
from collections.abc import Callable, Generator, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy
import pytest
from codewheel_runtime import biss
from codewheel_runtime.captures import signals
from codewheel_runtime.captures.accesses import AccessFinder, ControlBits
from codewheel_runtime.captures.any_biss import biss_layout
from codewheel_runtime.captures.capture import Captures
from codewheel_runtime.captures.serial_bytes import read_serial_bytes
from codewheel_runtime.captures.signals import Edges, Signals
from codewheel_runtime.commands.main import main
from lines import Biss, Wave, biss_word, serial

SERIAL = "AMM5A23/65KJP1"
LAYOUT = biss_layout("position=32,error,warning,crc=6:0x43")


def reply(head: int, *data: int) -> bytes:
    """Return a reply over RS-485: its bytes, and their XOR."""
    checksum = 0
    for byte in (head, *data):
        checksum ^= byte
    return bytes([head, *data, checksum])


def singleturn(position: int) -> bytes:
    """Return the request 02 and its reply: control field, status, 23 bits of position, CRC."""
    return b"\x02" + reply(0x02, 0x00, *position.to_bytes(3, "little"))


def capture_of(lika: Any, wave: Wave, rate: float = 10, **options: Any) -> Any:
    samples = numpy.array(wave.samples(rate), numpy.uint8)
    # A bit lasts one unit of time, at 2.5 million bits per second.
    return lika.read_capture(SERIAL, samples, rate=rate * 2.5e6, data="2", **options)


@pytest.fixture
def lika(generated_python: tuple[Path, ModuleType]) -> Any:
    return generated_python[1]


# RS-485


@pytest.mark.slow
@pytest.mark.parametrize("rate", [4, 4.3, 5, 10, 25, 50])
def test_replies_between_requests(lika: Any, rate: float) -> None:
    positions = [7000519, 1, 0x7FFFFF, 0x2AAAAA]
    wave = serial([(30, singleturn(position)) for position in positions])
    capture = capture_of(lika, wave, rate)
    assert capture.table["singleturn"].tolist() == positions
    assert capture.lost == ()
    # The reply begins one byte after the request.
    assert capture.table["time"][0] == pytest.approx(40 / 2.5e6, abs=1 / rate / 2.5e6)


def test_replies_of_another_kind_are_counted(lika: Any) -> None:
    # Data ID 2 is the encoder ID 23h.
    encoder_id_reply = b"\x92" + reply(0x92, 0x00, 0x23)
    wave = serial([(20, singleturn(5)), (20, encoder_id_reply), (20, singleturn(6))])
    capture = capture_of(lika, wave)
    assert capture.table["singleturn"].tolist() == [5, 6]
    assert (capture.lost, dict(capture.others)) == ((), {"encoder_id_reply": 1})
    capture = capture_of(lika, wave, layout="encoder_id_reply")
    assert (capture.table.count, dict(capture.others)) == (1, {"singleturn_reply": 2})


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (b"\x02", "no reply to the request 02"),
        (singleturn(9)[:4], "4 bytes without a valid reply: 02 02 00 09"),
        (b"\xff\xff\xff", "3 bytes without a valid reply: FF FF FF"),
    ],
)
def test_each_fault_of_a_serial_line_has_one_message(lika: Any, message: bytes, reason: str) -> None:
    wave = serial([(40, singleturn(5)), (40, message), (40, singleturn(6)), (40, singleturn(7))])
    capture = capture_of(lika, wave)
    assert capture.table["singleturn"].tolist() == [5, 6, 7]
    assert [lost_cycle.reason for lost_cycle in capture.lost] == [reason]


def test_a_disturbed_reply_is_a_row_with_an_error(lika: Any) -> None:
    broken = bytearray(singleturn(9))
    broken[4] ^= 0x10
    capture = capture_of(lika, serial([(40, singleturn(5)), (40, bytes(broken)), (40, singleturn(6))]))
    assert capture.table["fault"].tolist() == [0, 2, 0]
    assert capture.table.usable.tolist() == [True, False, True]
    assert capture.lost == ()


def test_a_missing_stop_bit(lika: Any) -> None:
    # The fourth byte of the second message.
    wave = serial(
        [(40, singleturn(5)), (40, singleturn(6)), (40, singleturn(7))], stop=lambda number: int(number != 10)
    )
    capture = capture_of(lika, wave)
    assert capture.table["singleturn"].tolist() == [5, 7]
    assert [lost_cycle.reason.partition(":")[0] for lost_cycle in capture.lost] == ["a byte without a stop bit"]


@pytest.mark.slow
def test_a_long_serial_capture_in_pieces(lika: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(signals, "SAMPLES", 3001)
    chosen = random.Random(3)
    positions = [chosen.getrandbits(23) for _ in range(200)]
    capture = capture_of(lika, serial([(chosen.choice((0, 3, 40)), singleturn(position)) for position in positions]))
    assert capture.table["singleturn"].tolist() == positions
    assert capture.lost == ()


# Accesses to registers


def line_with_accesses(accesses: Callable[[biss.Master], None], memory: dict[int, int], wait: int = 0) -> Biss:
    """Return a BiSS line on which a master reads and writes registers while positions are sent."""
    master, slave, line, cdm, waited = biss.Master(), biss.Slave(memory, memory), Biss(), 0, 0
    accesses(master)
    for cycle in range(90):
        cds = slave.next(cdm)
        if slave.wants is not biss.Wants.NOTHING and waited < wait:
            waited += 1
        elif slave.wants is biss.Wants.BYTE:
            slave.give(memory[slave.address])
            waited = 0
        elif slave.wants is biss.Wants.STORE:
            memory[slave.address] = slave.value
            slave.stored()
            waited = 0
        cdm = master.next(cds)
        line.cycle(biss_word(cycle), 40, cds, cdm)
    return line


def accesses_in(line: Biss, **options: Any) -> list[str]:
    samples = numpy.array(line.finish().samples(10), numpy.uint8)
    capture = Captures("none").read_capture(LAYOUT, samples, **options)
    assert capture.table["position"].tolist() == list(range(90))
    assert capture.lost == ()
    return [str(access) for access in capture.accesses]


@pytest.mark.slow
def test_reads_and_writes_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    memory = {0x78: 0x4C, 0x79: 0x69, 0x40: 0}
    line = line_with_accesses(lambda master: master.read(0x78, 2, busy_limit=0), memory)
    assert accesses_in(line) == ["read 78h -> 0x4c", "read 79h -> 0x69"]
    line = line_with_accesses(lambda master: master.write(0x40, b"\xa5", busy_limit=5), memory, wait=4)
    monkeypatch.setattr(signals, "SAMPLES", 999)
    assert accesses_in(line) == ["write 40h = 0xa5"]
    assert memory[0x40] == 0xA5


def test_refused_and_unanswered_accesses() -> None:
    line = line_with_accesses(lambda master: master.read(0x33, busy_limit=0), {0x40: 0})
    assert accesses_in(line) == [f"read 33h: {biss.Outcome.REFUSED.value}"]
    line = line_with_accesses(lambda master: master.read(0x40, slave_id=3, busy_limit=0), {0x40: 0})
    assert accesses_in(line) == [f"read 40h of slave 3: {biss.Outcome.NO_ANSWER.value}"]


def test_a_read_that_is_cut_off_after_a_write_is_not_a_write() -> None:
    """The capture ends between the address and R W, so the kind of the second access is not known."""
    memory = {0x40: 0, 0x78: 0x4C}
    master, slave = biss.Master(), biss.Slave(memory, memory)
    cds_bits, cdm_bits = [], [0]

    def follow(cycles: int) -> None:
        for _ in range(cycles):
            cds_bits.append(slave.next(cdm_bits[-1]))
            slave.stored()
            cdm_bits.append(master.next(cds_bits[-1]))

    master.write(0x40, b"\xa5", busy_limit=0)
    follow(46)
    assert master.outcome is biss.Outcome.DONE
    master.read(0x78, busy_limit=0)
    while not cdm_bits[-1]:
        follow(1)
    # After S, the bits from CTS to the CRC of the address.
    follow(15)
    finder = AccessFinder()
    times = numpy.arange(len(cds_bits), dtype=float)
    bits = ControlBits(times, cds=numpy.array(cds_bits), cdm=numpy.array(cdm_bits[1:]))
    written, cut_off = [*finder.feed(bits), *finder.finish()]
    assert (written.is_write, written.address, written.value, written.done) == (True, 0x40, 0xA5, True)
    assert (cut_off.is_write, cut_off.address, cut_off.value, cut_off.done) == (False, 0x78, None, False)


# The command


Command = Callable[..., tuple[int, str, str]]


@pytest.fixture
def command(lika: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Command:
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> tuple[int, str, str]:
        code = main("lika_encoders", arguments)
        return code, *capsys.readouterr()

    return run


FIELDS = ("--biss", "position=32,error,warning,crc=6:0x43")


def save(name: str, words: Sequence[int], cut: int | None = None) -> None:
    line = Biss()
    for place, word in enumerate(words):
        line.cycle(word, 40, clocks=20 if place == cut else None)
    numpy.save(name, numpy.array(line.finish().samples(10), numpy.uint8))


def test_capture_command(command: Command) -> None:
    words = [biss_word(position) for position in range(0, 4000, 100)]
    words[7] ^= 1 << 20
    save("it.npy", words, cut=3)
    code, out, err = command("capture", "it.npy", *FIELDS, "--rate", "10MHz")
    rows = out.splitlines()
    assert (code, len(rows)) == (0, 40)
    assert rows[0] == "time,position,error,warning,verdict,fault"
    assert rows[7].split(",")[1] == "", "the frame has a CRC error"
    assert rows[7].endswith(",crc")
    lines = err.splitlines()
    assert lines[0].endswith("the clock stops after 14 of 40 bits")
    assert lines[1] == "39 frames, 38 valid (38 usable), 1 with a CRC error, 1 lost"
    code, out, err = command(
        "capture", "it.npy", *FIELDS, "--rate", "10MHz", "-o", "it.csv", "--json", "--max-errors", "4"
    )
    assert code == 1
    assert json.loads(out)["lost"] == {"the clock stops after 14 of 40 bits": 1}
    message = "5% of the cycles have no valid frame; check the layout (--biss) and the channels (--max-errors is 4)"
    assert err == f"lika-encoders: {message}\n"


def test_capture_with_si_units(command: Command) -> None:
    line = Biss()
    for position in range(5):
        line.cycle(biss_word(position << 10), 40)
    samples = numpy.array(line.finish().samples(10), numpy.uint8)
    numpy.save("it.npy", samples)
    layout_options = "--biss", "multiturn=8,singleturn=24,error,warning,crc=6:0x43"
    code, printed, _ = command("capture", "it.npy", *layout_options, "--rate", "10MHz", "--si")
    rows = list(csv.DictReader(io.StringIO(printed)))
    assert (code, len(rows)) == (0, 5)
    radians_per_frame = 1024 / (1 << 24) * 2 * math.pi
    expected_angles = [radians_per_frame * position for position in range(5)]
    assert [float(row["radians"]) for row in rows] == pytest.approx(expected_angles)
    times = [float(row["time"]) for row in rows]
    speeds = [radians_per_frame / (after - before) for before, after in itertools.pairwise(times)]
    assert rows[0]["radians_per_second"] == ""
    assert [float(row["radians_per_second"]) for row in rows[1:]] == pytest.approx(speeds)


def test_one_turn_is_a_position_with_degrees(command: Command) -> None:
    layout = biss_layout("singleturn=32,error,warning,crc=6:0x43")
    table = layout.decode_many([biss_word(1 << 30), biss_word(3 << 30)])
    assert table["position"].tolist() == [1 << 30, 3 << 30]
    assert table.in_units("degrees").tolist() == [90.0, 270.0]
    assert (layout.modulus, layout.counts_per_turn) == (1 << 32, 1 << 32)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["capture", "nothing.sr", *FIELDS], 1, "nothing.sr: No such file or directory"),
        (["capture", "AMM5A21/65KSC1"], 2, "give the order code and the file of the capture, or --biss and the file"),
        (["capture", "AMM5A21", "it.npy"], 2, "AMM5A21"),
        (["capture", "it.npy"], 2, "it.npy is a file: give the order code in front of it, or --biss"),
        (["capture", "it.npy", "it.npy"], 2, "it.npy is a file: give the order code in front of it, or --biss"),
        (["capture", "it.npy", *FIELDS, "--rate", "10MHz", "--si"], 2, "use singleturn=32 instead of position=32"),
        (["decode", "AMM5A21/65KSC1", "0x55bcd15e2", "--si"], 2, "--si needs a file with a column 'time'"),
        (["capture", "it.npy", "--biss", "position"], 2, "'position' is not a field"),
        (["capture", "it.npy", *FIELDS, "--clock", "7"], 1, "it.npy: no channel '7'; the channels are '1', '2'"),
        (["capture", "it.npy", *FIELDS, "--clock", "2", "--data", "2"], 2, "the clock and the data line are the same"),
        (["capture", "it.npy", *FIELDS, "--si"], 2, "speeds need the sample rate: give it with --rate"),
        (
            ["capture", "AMM5A23/65KJP1", "it.npy", "--rate", "10MHz", "--data", "2"],
            1,
            "no valid reply of AMM5A23/65KJP1",
        ),
        (["capture", "ASC8525/SC1", "it.npy"], 2, "the manual leaves the zero_bit"),
        (
            ["monitor", "AMM5A21/65KSC1", "COM3"],
            2,
            "AMM5A21/65KSC1 has the interface BiSS, and a serial port cannot",
        ),
        (["decode", "AMM5A21/65KSC1", "no", "file"], 2, "expected one file or one frame, got 'no file'"),
        (["decode", "AMM5A21/65KSC1", "0x55bcd15e3"], 1, "expected CRC 0x22, got 0x23. The frame would be valid"),
        (["decode", "AMM5A23/65KJP1", "02 00"], 1, "expected"),
    ],
)
def test_wrong_use_gives_one_line(command: Command, arguments: list[str], code: int, message: str) -> None:
    save("it.npy", [biss_word(position) for position in range(20)])
    exit_code, out, err = command(*arguments)
    assert (exit_code, out) == (code, "")
    assert err.startswith("lika-encoders: ")
    assert message in err
    assert err.count("\n") == 1


def test_one_frame(command: Command) -> None:
    code, out, err = command("decode", "AMM5A21/65KSC1", "0x55bcd15e2")
    values = dict(line.split() for line in out.splitlines())
    assert (code, err) == (0, "")
    assert (values["multiturn"], values["singleturn"], values["verdict"]) == ("42", "1821973", "usable")
    code, out, _ = command("decode", "AMM5A21/65KSC1", "55b cd1564", "--json")
    assert code == 3
    assert json.loads(out)["usable_position"] is None
    code, out, _ = command("decode", "AMM5A23/65KJP1", "02", "00", "C7", "D1", "6A", "7E", "--json")
    assert (code, json.loads(out)["singleturn"]) == (0, 7000519)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["png", "svg"])
def test_plot(command: Command, kind: str, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed: plot is not tried")
    words = [biss_word(position) for position in range(0, 40000, 1000)]
    words[7] ^= 1 << 20
    save("it.npy", words, cut=3)
    code, out, err = command("plot", "it.npy", *FIELDS, "--rate", "10MHz", "-o", f"it.{kind}")
    assert (code, out, err) == (0, f"it.{kind}: 39 frames, 1 lost\n", "")
    Path("it.csv").write_text("time,word\n0,0x55bcd15e2\n0.1,\n0.2,0x55bcd1564\n0.3,0x55bcd15e2\n")
    assert command("plot", "AMM5A21/65KSC1", "it.csv", "-o", f"it2.{kind}")[1] == f"it2.{kind}: 4 frames, 0 lost\n"
    Path("it3.csv").write_text(f"time,word\n0,{0x55BCD15E2}\n0.1,{0x55BCD15E2}\n")
    assert command("plot", "AMM5A21/65KSC1", "it3.csv", "-o", f"it3.{kind}", "--digits", "decimal")[0] == 0
    code, out, err = command("plot", "it.npy", *FIELDS, "-o", "it.jpg")
    assert (code, out, err) == (2, "", "lika-encoders: it.jpg: the name of a picture ends in .png, .svg or .pdf\n")
    picture = (tmp_path / f"it.{kind}").read_bytes()
    assert picture.startswith(b"\x89PNG" if kind == "png" else b"<?xml")
    if kind == "svg":
        assert b"CRC error (1)" in picture or picture.count(b"<text") == 0


def test_the_bytes_of_a_stretch_come_before_the_next_is_read() -> None:
    """Two stretches of 0x55 at 1 unit a bit: a start bit of 0, then 1 and 0 in turn, and a stop bit of 1."""
    read = []

    def stretches() -> Generator[Edges, None, None]:
        for begin in (0.0, 100.0):
            read.append(begin)
            edges = numpy.arange(begin + 10, begin + 20)
            yield Edges(levels=(1,), times=(edges,), begin=begin, end=begin + 100)

    pieces = read_serial_bytes(Signals(stretches(), seconds=1.0, is_sampled=False), baud=1.0)
    assert next(pieces).values.tolist() == [0x55]
    assert read == [0.0]
    assert next(pieces).values.tolist() == [0x55]
