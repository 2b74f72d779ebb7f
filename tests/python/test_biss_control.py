"""BiSS C's control frames in Python: published words, streams written by hand, a master and slaves bit by bit."""

from __future__ import annotations

import importlib
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from biss_line import Line, Memory, PythonMaster, PythonSlave, ssi_only
from codewheel.targets import Library
from codewheel.targets.python.files import generate
from hypothesis import given, settings
from hypothesis import strategies as st

#: The remainders of x^4 to x^14 by x^4 + x + 1, on paper: each is the one before it times x, with x^4 = x + 1.
REMAINDERS = {
    4: 0b0011,
    5: 0b0110,
    6: 0b1100,
    7: 0b1011,
    8: 0b0101,
    9: 0b1010,
    10: 0b0111,
    11: 0b1110,
    12: 0b1111,
    13: 0b1101,
    14: 0b1001,
}


def remainder(value: int, bits: int) -> int:
    """Return the CRC of up to 11 bits from that table."""
    crc = 0b1111
    for bit in range(bits):
        crc ^= REMAINDERS[bit + 4] if value >> bit & 1 else 0
    return crc


@pytest.fixture(scope="session")
def biss() -> Any:
    return importlib.import_module("codewheel_runtime.biss")


@pytest.fixture(scope="session")
def lika(generated_python: tuple[Any, ModuleType]) -> Any:
    return generated_python[1]


def line_of(
    biss: Any,
    registers: dict[int, int] | None = None,
    delay: int = 0,
    *,
    readable: Sequence[int] = range(128),
    writable: Sequence[int] = range(128),
) -> Line:
    """A master and one slave with these registers."""
    memory = Memory(dict.fromkeys(range(128), 0) | (registers or {}), delay)
    return Line(PythonMaster(biss), [PythonSlave(biss, readable, writable)], [memory])


# ---------------------------------------------------------------------------------------------------------------- words


def test_the_published_words(biss: Any, vectors: list[dict[str, Any]]) -> None:
    rows = [row for row in vectors if row["protocol"].startswith("BiSS-C register read")]
    assert len(rows) == 13
    for row in rows:
        word = int(row["frame_hex_or_bits"].split()[0], 16)
        assert biss.Request(row["fields"]["ID"], row["fields"]["ADR"]).encode() == word
        assert biss.Request.decode(word) == biss.Request(row["fields"]["ID"], row["fields"]["ADR"])


def test_the_published_word_that_is_wrong(biss: Any, lika: Any, vectors: list[dict[str, Any]]) -> None:
    (row,) = (row for row in vectors if row["protocol"].startswith("BiSS-C register write"))
    assert row["frame_hex_or_bits"] == "0x8C13C194 (printed); 0x8C16C194 (recomputed)"
    with pytest.raises(lika.CrcError) as caught:
        biss.Request.decode(0x8C13C194)
    assert (caught.value.received, caught.value.computed) == (0x9, 0xB)
    # With a corrected CRC, R W S is still 111.
    with pytest.raises(lika.ConstantError):
        biss.Request.decode(0x8C17C194)
    assert biss.Request(0, 0x60, 6).encode() == 0x8C16C194
    assert biss.Request.decode(0x8C16C194) == biss.Request(0, 0x60, 6)


def test_words_on_paper(biss: Any) -> None:
    # CTS alone is x^14 = 1001, inverted 0110: 1 000 0000000 0110 101 and 14 zeros.
    assert biss.Request(0, 0).encode() == 0b1_000_0000000_0110_101_00000000000000 == 0x800D4000
    # CTS, ID 5 and address 7Fh: x^14 + x^13 + x^11 + x^10 .. x^4 = 0000, inverted 1111; FFh: x^11 ..
    # x^4 = 0100, inverted 1011.
    assert biss.Request(5, 0x7F, 0xFF).encode() == 0b1_101_1111111_1111_011_11111111_1011_00 == 0xDFFEFFEC


def test_a_byte_of_the_published_log(biss: Any, vectors: list[dict[str, Any]]) -> None:
    (row,) = (row for row in vectors if row["protocol"] == "BiSS-C register data byte")
    assert (
        biss.encode_byte(row["fields"]["DATA"]) == row["fields"]["DATA"] << 4 | row["fields"]["CRC4_inverted"] == 0x408
    )
    # On paper: 01h is x^4, 80h is x^11.
    assert (biss.encode_byte(0x00), biss.encode_byte(0x01), biss.encode_byte(0x80), biss.encode_byte(0xFF)) == (
        0x00F,
        0x01C,
        0x801,
        0xFFB,
    )


def test_the_crc_by_the_table(biss: Any) -> None:
    assert all(biss.crc(value, 11) == remainder(value, 11) for value in range(1 << 11))
    assert all(biss.crc(value, 8) == remainder(value, 8) for value in range(1 << 8))


def test_the_crc_is_that_of_the_manuals(library: Library, biss: Any) -> None:
    crcs = [crc for device in library.devices for crc in device.crcs if crc.name == "biss_4"]
    parameters = {(crc.width, crc.poly, crc.init, crc.refin, crc.refout, crc.xorout) for crc in crcs}
    assert parameters == {(4, 0x3, 0, False, False, 0xF)}
    # Start value 0 and XOR 15: the CRC of only zeros. Polynomial 3: the CRC of a single 1.
    assert biss.crc(0, 8) == 0xF
    assert biss.crc(1, 8) ^ 0xF == 0x3


@pytest.mark.slow
@given(slave_id=st.integers(0, 7), address=st.integers(0, 127), value=st.none() | st.integers(0, 255))
def test_requests_come_back(biss: Any, slave_id: int, address: int, value: int | None) -> None:
    request = biss.Request(slave_id, address, value)
    assert biss.Request.decode(request.encode()) == request


@pytest.mark.slow
@given(word=st.integers(0, (1 << 32) - 1))
def test_no_other_word_is_a_request(biss: Any, lika: Any, word: int) -> None:
    with suppress(lika.FrameError):
        assert biss.Request.decode(word).encode() == word


@pytest.mark.parametrize("request_of", [(0, 0x44, None), (7, 0x7F, None), (0, 0x60, 6), (3, 0x00, 0xFF)])
def test_every_flipped_bit_of_a_word_is_refused(biss: Any, lika: Any, request_of: tuple[int, int, int | None]) -> None:
    word = biss.Request(*request_of).encode()
    for bit in range(32):
        with pytest.raises(lika.FrameError) as caught:
            biss.Request.decode(word ^ 1 << bit)
        in_crc = bit >= 17 or (request_of[2] is not None and 2 <= bit < 14)
        assert type(caught.value) is (lika.CrcError if in_crc else lika.ConstantError), bit


def test_what_is_no_request(biss: Any, lika: Any) -> None:
    for values in ((8, 0), (0, 128), (0, 0, 256), (-1, 0), (0, -1), (0, 0, -1)):
        with pytest.raises(lika.RangeError):
            biss.Request(*values).encode()
    for number in (-1, 1 << 32):
        with pytest.raises(lika.LengthError):
            biss.Request.decode(number)
        with pytest.raises(lika.LengthError):
            biss.Answer.decode(biss.Request(0, 0), number)
    for bits in (-1, 1 << 12):
        with pytest.raises(lika.LengthError):
            biss.decode_byte(bits)
    # A command: CTS is 0, and its CRC is correct.
    with pytest.raises(lika.ConstantError):
        biss.Request.decode(0xF << 17 | 0b101 << 14)


READ_40 = "1000000000000000" + "10" + "1" + "01000000" + "1000" + "0"


@pytest.mark.parametrize(
    ("value", "cds", "expected"),
    [
        (None, READ_40, ("DONE", 1, 0x40)),
        (None, "1110000000000000" + "10" + "1" + "01000000" + "1000" + "1", ("DONE", 3, 0x40)),
        (None, "1111111110000000" + "10" + "1" + "01000000" + "1000" + "0", ("DONE", 9, 0x40)),
        (None, "1000000000000000" + "11" + "0" * 14, ("REFUSED", 1, None)),
        (None, "1000000000000000" + "00" + "0" * 14, ("NO_ANSWER", 1, None)),
        (None, "1000000000000000" + "01" + "0" * 14, ("BAD_ECHO", 1, None)),
        (None, "1000000000000000" + "10" + "0" * 14, ("BUSY", 1, None)),
        (None, "1000000000000000" + "10" + "1" + "01000000" + "1001" + "0", ("BAD_CRC", 1, None)),
        (None, "0" * 32, ("NO_ANSWER", 0, None)),
        (None, "1" * 32, ("NO_ANSWER", 9, None)),
        (0x40, "1000000000000000" + "01" + "1" + "01000000" + "1000" + "0", ("DONE", 1, None)),
        (0x40, "1000000000000000" + "00" + "0" * 14, ("REFUSED", 1, None)),
        (0x40, "1000000000000000" + "11" + "0" * 14, ("BAD_ECHO", 1, None)),
        (0x40, "1000000000000000" + "10" + "0" * 14, ("BAD_ECHO", 1, None)),
        (0x40, "1000000000000000" + "01" + "1" + "01000001" + "1011" + "0", ("BAD_ECHO", 1, None)),
    ],
)
def test_answers_to_whole_words(biss: Any, value: int | None, cds: str, expected: tuple[str, int, int | None]) -> None:
    answer = biss.Answer.decode(biss.Request(0, 0x44, value), int(cds, 2))
    assert (answer.outcome.name, answer.slaves, answer.value) == expected


# ----------------------------------------------------------------------------------------------------------- bit by bit


def bits_of(text: str) -> list[int]:
    return [int(bit) for bit in text.replace(" ", "")]


def test_a_read_written_out(biss: Any) -> None:
    line = line_of(biss, {0x44: 0x40})
    line.master.read(0x44, 1, 0, 0)
    assert line.run() == "DONE"
    assert line.master.data == b"\x40"
    assert line.master.slaves == 1
    #            14 zeros, S   CTS ID  ADR     CRC  R W S  12 zeros     P
    master_bits = "00000000000000 1   1 000 1000100 1101 1 0 1  000000000000 0"
    assert line.cdm[:46] == bits_of(master_bits)
    assert not any(line.cdm[46:])
    assert biss.Request(0, 0x44).bits() == (*line.cdm[:46], 0)
    # The frames of the zeros and of S. The answers follow a frame later: IDL, R W S, DATA, CRC, P
    answered = "00000000000000 0   1000000000000000 1 0 1 01000000 1000 0"
    assert line.cds[:47] == bits_of(answered)
    assert not any(line.cds[47:])
    # Answer reads the frames in which the word was sent.
    assert line.cds[15:47] == bits_of(READ_40)


def test_a_write_written_out(biss: Any) -> None:
    line = line_of(biss)
    line.master.write(0x60, b"\x06", 0, 0)
    assert line.run() == "DONE"
    assert line.memories[0].writes == [(0x60, 0x06)]
    master_bits = "00000000000000 1   1 000 1100000 1011 0 1 1  00000110 0101 0"
    assert line.cdm[:46] == bits_of(master_bits)
    assert not any(line.cdm[46:])
    answered = "00000000000000 0   1000000000000000 0 1 1 00000110 0101 0"
    assert line.cds[:47] == bits_of(answered)
    assert not any(line.cds[47:])


def test_a_sequence_written_out(biss: Any) -> None:
    line = line_of(biss, {0x78: 0x00, 0x79: 0x01, 0x7A: 0x80})
    line.master.read(0x78, 3, 0, 0)
    assert line.run() == "DONE"
    assert line.master.data == b"\x00\x01\x80"
    assert line.cdm[:74] == bits_of(
        "00000000000000 1   1 000 1111000 0101 1 0 1" + " 0000000000000 1" * 2 + " 0000000000000"
    )
    assert line.cds[15:75] == bits_of("1000000000000000 1 0  1 00000000 1111 0  1 00000001 1100 0  1 10000000 0001 0")


def test_a_busy_slave_is_waited_for(biss: Any) -> None:
    for delay in range(6):
        line = line_of(biss, {0x44: 0x40}, delay)
        line.master.read(0x44, 1, 0, 4)
        # A byte is requested one frame before S is answered, so that a delay of one frame costs one frame.
        if delay <= 4:
            assert line.run() == "DONE"
            assert line.master.data == b"\x40"
            assert line.cdm[32 : 34 + delay] == [1] * (1 + delay) + [0]
            assert line.cds[33 : 34 + delay] == [0] * delay + [1]
        else:
            assert line.run() == "BUSY"
            assert line.master.data == b""
            assert line.cdm[32:39] == [1] * 5 + [0] * 2
        # The next access works in any case.
        line.memories[0].delay = 0
        line.master.read(0x44, 1, 0, 4)
        assert line.run() == "DONE"


def test_a_slave_that_stores_slowly(biss: Any) -> None:
    line = line_of(biss, delay=5)
    line.master.write(0x10, bytes(range(8)), 0, 5)
    assert line.run() == "DONE"
    for _ in range(10):
        line.frame()
    assert line.memories[0].writes == [(0x10 + index, index) for index in range(8)]
    # A slave that has not finished storing makes the next access wait, and then returns the stored value.
    slow = line_of(biss, delay=60)
    slow.master.write(0x10, b"\x77", 0, 0)
    assert slow.run() == "DONE"
    assert slow.memories[0].writes == []
    slow.master.read(0x10, 1, 0, 200)
    assert slow.run() == "DONE"
    assert slow.master.data == b"\x77"


@pytest.mark.parametrize("write", [False, True])
def test_refusals(biss: Any, write: bool) -> None:
    allowed = range(0x40, 0x46)
    line = line_of(
        biss,
        {address: address for address in range(128)},
        readable=() if write else allowed,
        writable=allowed if write else (),
    )

    def access(address: int, count: int) -> str:
        if write:
            line.master.write(address, bytes(count), 0, 0)
        else:
            line.master.read(address, count, 0, 0)
        return line.run()

    assert access(0x3F, 1) == access(0x46, 1) == "REFUSED"
    assert line.master.done == 0
    # Read: R W come back as 11, write: as 00.
    last = len(line.cdm) - 1 - line.cdm[::-1].index(1)
    assert line.cds[last + (0 if write else 1)] == (0 if write else 1)
    # In a sequence, P reports it.
    assert access(0x44, 4) == "REFUSED"
    assert line.master.done == 2
    assert line.memories[0].writes == ([(0x44, 0), (0x45, 0)] if write else [])
    assert line.master.data == (b"" if write else b"\x44\x45")
    assert access(0x40, 6) == "DONE"


def test_the_slave_at_the_end_of_its_registers(biss: Any) -> None:
    """A foreign master that continues past 3Fh or 7Fh is refused by P."""
    for start in (0x3F, 0x7F):
        slave = PythonSlave(biss)
        stream = biss.Request(0, start).bits()[:46] + (1,) + (0,) * 20
        answers = []
        for bit in stream:
            answers.append(slave.next(bit))
            if slave.wants == "BYTE":
                slave.give(start)
        assert answers[45] == 1
        assert not any(answers[46:])
        assert slave.wants == "NOTHING"


@pytest.mark.parametrize(
    ("address", "count"), [(0, 0), (0, 65), (0x3F, 2), (0x40, 65), (0x7F, 2), (0x20, 33), (128, 1), (-1, 1), (0, 10**9)]
)
def test_sequences_past_the_end_are_refused_before_anything_is_sent(
    biss: Any, lika: Any, address: int, count: int
) -> None:
    line = line_of(biss)
    with pytest.raises(lika.RangeError):
        line.master.read(address, count, 0, 0)
    if count <= 65:
        with pytest.raises(lika.RangeError):
            line.master.write(address, bytes(count), 0, 0)
    for _ in range(40):
        line.frame()
    assert line.master.outcome == "IDLE"
    assert not any(line.cdm)


def test_all_registers_at_once(biss: Any) -> None:
    for start in (0x00, 0x40):
        line = line_of(biss, {address: 255 - address for address in range(128)})
        line.master.read(start, 64, 0, 0)
        assert line.run() == "DONE"
        assert line.master.data == bytes(255 - start - index for index in range(64))
        line.master.write(start, bytes(64), 0, 0)
        assert line.run() == "DONE"
        assert len(line.memories[0].writes) == 64


def test_given_up_at_every_bit(biss: Any) -> None:
    for frames in range(15, 80):
        line = line_of(biss, {0x44: 0x40})
        line.master.write(0x50, b"\x11\x22\x33", 0, 0)
        for _ in range(frames):
            line.frame()
        stored = list(line.memories[0].writes)
        assert stored == [(0x50, 0x11), (0x51, 0x22), (0x52, 0x33)][: len(stored)]
        given_up = line.master.outcome == "RUNNING"
        line.master.abort()
        assert line.master.outcome == ("ABORTED" if given_up else "DONE")
        line.master.read(0x44, 1, 0, 0)
        assert line.run() == "DONE"
        assert line.master.data == b"\x40"


def test_14_zeros_before_every_access_and_no_more(biss: Any) -> None:
    line = line_of(biss, {0x44: 0x40})
    for _ in range(3):
        line.frame()
    line.master.read(0x44, 1, 0, 0)
    while line.master.outcome == "RUNNING":
        line.frame()
    assert line.cdm.index(1) == 14
    line.master.read(0x44, 1, 0, 0)
    assert line.run() == "DONE"
    # The last 1 of the first access is its second S, in frame 32. 12 zeros, P and one more follow.
    assert line.cdm[33:48] == [0] * 14 + [1]


def test_13_zeros_begin_nothing(biss: Any) -> None:
    for zeros, answers in ((13, False), (14, True), (30, True)):
        slave = PythonSlave(biss)
        slave.next(1)
        answered = [slave.next(bit) for bit in (0,) * zeros + biss.Request(0, 0x44).bits()[14:]]
        assert any(answered) is answers


# -------------------------------------------------------------------------------------------------------------- ID lock


@pytest.mark.parametrize("count", range(1, 12))
def test_id_lock(biss: Any, count: int) -> None:
    memories = [Memory(dict.fromkeys(range(128), 16 + number)) for number in range(count)]
    line = Line(PythonMaster(biss), [PythonSlave(biss) for _ in range(count)], memories)
    for slave_id in range(8):
        line.master.read(0x44, 2, slave_id, 0)
        assert line.run() == ("DONE" if slave_id < count else "NO_ANSWER")
        assert line.master.slaves == min(count, 9)
        assert line.master.data == (bytes([0x10 + count - 1 - slave_id] * 2) if slave_id < count else b"")
        line.master.write(0x20, bytes([slave_id]), slave_id, 0)
        line.run()
    # The slave with SLI = 0, the last in the list, sees the first free bit first and has ID 0. Slaves beyond the first
    # 8 have no ID.
    assert [slave.slave_id for slave in reversed(line.slaves)] == [*range(min(count, 8)), *[None] * (count - 8)]
    for number, memory in enumerate(reversed(memories)):
        assert memory.writes == ([(0x20, number)] if number < 8 else [])


def test_id_lock_written_out(biss: Any) -> None:
    # Three slaves: the last takes IDL0, the next IDL1, and the slave at the master IDL2. The one in the middle answers.
    slaves = [PythonSlave(biss) for _ in range(3)]
    line = Line(PythonMaster(biss), slaves, [Memory({0x44: 0x40, 0x45: 0}) for _ in slaves])
    line.master.read(0x44, 1, 1, 0)
    assert line.run() == "DONE"
    assert line.cds[15:47] == bits_of("1110000000000000 1 0 1 01000000 1000 0")


def test_a_slave_behind_others_that_know_no_control_frames(biss: Any) -> None:
    """Upstream bits pass through a slave that is not addressed."""
    slave = PythonSlave(biss)
    for bit in biss.Request(2, 0x44).bits()[:32]:
        slave.next(bit, 0)
    assert slave.slave_id == 0
    assert [slave.next(0, bit) for bit in (1, 0, 1, 1)] == [1, 0, 1, 1]


@pytest.mark.parametrize("stuck", [0, 1])
def test_a_line_that_never_changes(biss: Any, stuck: int) -> None:
    for write in (False, True):
        line = Line(PythonMaster(biss), [], [], disturb_cds=lambda frame, bit: stuck)
        if write:
            line.master.write(0x44, b"\x00", 0, 10)
        else:
            line.master.read(0x44, 1, 0, 10)
        assert line.run() == "NO_ANSWER"


def test_commands_pass(biss: Any) -> None:
    """CTS = 0: the slave takes its ID and ignores the rest."""
    slave = PythonSlave(biss)
    header = 0b0_00000001_01
    stream = (
        [0] * 14 + [1] + [header >> place & 1 for place in range(10, -1, -1)] + bits_of("1111") + [1, 0, 1] + [0] * 12
    )
    answers = [slave.next(bit) for bit in stream]
    assert answers == [0] * 14 + [1] + [0] * 30
    assert slave.wants == "NOTHING"
    assert slave.slave_id == 0


# --------------------------------------------------------------------------------------------------------- disturbances

#: Effect of one flipped bit, by the number of the bit, S being 0: CTS 1, ID and ADR 2 to 11, CRC 12 to 15, R 16, W 17,
#: S 18, the byte 19 to 30, P 31.
HEAD, BYTE = range(1, 16), range(19, 31)


def run_with_flipped_bit(biss: Any, write: bool, bit: int, of_cds: bool, value: int = 0x40) -> tuple[str, Line]:
    line = line_of(biss, {0x44: 0xEE if write else value})
    frame = 14 + bit
    if of_cds:
        line.disturb_cds = lambda number, cds_bit: cds_bit ^ (number == frame + 1)
    else:
        line.disturb_cdm = lambda number, cdm_bit: cdm_bit ^ (number == frame)
    if write:
        line.master.write(0x44, bytes([value]), 0, 9)
    else:
        line.master.read(0x44, 1, 0, 9)
    return line.run(), line


@pytest.mark.parametrize("bit", range(-14, 32))
def test_a_flipped_bit_on_its_way_to_the_slave(biss: Any, bit: int) -> None:
    outcome, line = run_with_flipped_bit(biss, False, bit, False)
    # Read. Twelve zeros and P have no effect, 11 in place of 10 is sent back, and without S the slave is lost.
    expected = "DONE" if bit in BYTE or bit == 31 else {17: "REFUSED", 18: "BUSY"}.get(bit, "NO_ANSWER")
    assert outcome == expected
    assert line.master.data == (b"\x40" if expected == "DONE" else b"")
    outcome, line = run_with_flipped_bit(biss, True, bit, False)
    # Write. A header that no slave understands looks like a refusal, 00.
    if bit < 1:
        expected = "NO_ANSWER"
    elif bit in HEAD:
        expected = "REFUSED"
    else:
        expected = {16: "BAD_ECHO", 17: "REFUSED", 18: "BUSY", 31: "DONE"}.get(bit, "BAD_ECHO")
    assert outcome == expected
    assert line.memories[0].writes == ([(0x44, 0x40)] if expected == "DONE" else [])


@pytest.mark.parametrize("bit", [*range(18), *range(19, 32)])
def test_a_flipped_bit_on_its_way_to_the_master(biss: Any, bit: int) -> None:
    outcome, line = run_with_flipped_bit(biss, False, bit, True)
    # IDL bits of other slaves change only their apparent number.
    expected = (
        "DONE" if bit in HEAD or bit == 31 else {0: "NO_ANSWER", 16: "NO_ANSWER", 17: "REFUSED"}.get(bit, "BAD_CRC")
    )
    assert outcome == expected
    assert line.master.data == (b"\x40" if expected == "DONE" else b"")
    outcome, line = run_with_flipped_bit(biss, True, bit, True)
    expected = "DONE" if bit in HEAD or bit == 31 else {0: "NO_ANSWER", 17: "REFUSED"}.get(bit, "BAD_ECHO")
    assert outcome == expected
    # The master notices a wrong echo of the byte when the slave already has it.
    assert line.memories[0].writes == ([(0x44, 0x40)] if expected == "DONE" or bit in BYTE else [])


@pytest.mark.slow
def test_a_start_bit_of_the_slave_that_is_lost(biss: Any) -> None:
    """No CRC covers S: master and slave continue one bit apart. No value survives, but half of the writes seem to."""
    for value in range(256):
        byte_and_crc = value << 4 | remainder(value, 8)
        # Read: the first 1 of the byte is taken as S, the bits after it as the byte, and zeros fill it up.
        follows = byte_and_crc << 13 - byte_and_crc.bit_length() & 0xFFF
        assert remainder(follows >> 4, 8) != follows & 0xF
        outcome, line = run_with_flipped_bit(biss, False, 18, True, value)
        assert outcome == "BAD_CRC"
        assert line.master.data == b""
        # Write: the S that the master sends again is taken as DATA7.
        # The slave then has left when the last bit of the CRC comes.
        shifted = 1 << 11 | byte_and_crc >> 1
        assert remainder(shifted >> 4, 8) != shifted & 0xF
        outcome, line = run_with_flipped_bit(biss, True, 18, True, value)
        assert line.memories[0].writes == [], value
        assert outcome == ("BAD_ECHO" if byte_and_crc & 1 else "DONE"), value


# ---------------------------------------------------------------------------------------------------------- round trips


@settings(max_examples=60, deadline=None)
@pytest.mark.slow
@given(data=st.data())
def test_whatever_is_written_is_read_again(biss: Any, data: st.DataObject) -> None:
    count = data.draw(st.integers(1, 8), "slaves")
    memories = []
    for _ in range(count):
        random_bytes = {address: data.draw(st.integers(0, 255)) for address in range(0, 128, 16)}
        memories.append(Memory(dict(enumerate(range(128))) | random_bytes))
    line = Line(PythonMaster(biss), [PythonSlave(biss) for _ in range(count)], memories)
    registers = [dict(memory.registers) for memory in memories]
    for _ in range(data.draw(st.integers(1, 6), "accesses")):
        place, address = data.draw(st.integers(0, count - 1)), data.draw(st.integers(0, 127))
        slave_id = count - 1 - place
        memories[place].delay = data.draw(st.integers(0, 5))
        length = data.draw(st.integers(1, min(5, 64 - address % 64)))
        if data.draw(st.booleans(), "write"):
            content = data.draw(st.binary(min_size=length, max_size=length))
            line.master.write(address, content, slave_id, 6)
            registers[place] |= {address + index: byte for index, byte in enumerate(content)}
        else:
            line.master.read(address, length, slave_id, 6)
        assert line.run() == "DONE"
        assert line.master.done == length
        assert line.master.slaves == count
        assert [memory.registers for memory in memories] == registers
        if line.master.data:
            assert line.master.data == bytes(registers[place][address + index] for index in range(length))


# ---------------------------------------------------------------------------------------------------------- the package


@pytest.mark.slow
def test_only_where_a_family_speaks_biss(library: Library, tmp_path: Path) -> None:
    files = generate(Library((ssi_only(tmp_path),)))
    assert not any(path.endswith("_encoders/biss.py") for path in files)
    texts = [text for path, text in files.items() if not path.startswith("python/runtime/")]
    assert not any(re.search(r"import biss\b", text) for text in texts)
    assert "python/lika_encoders/biss.py" in generate(library)


@pytest.mark.slow
def test_a_family_called_biss_keeps_out_of_its_way(library: Library) -> None:
    files = generate(Library((replace(library.devices[0], name="biss"),)))
    assert "from codewheel_runtime.biss import *" in files["python/lika_encoders/biss.py"]
    assert "python/lika_encoders/biss_.py" in files
