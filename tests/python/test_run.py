"""Procedures on a made-up memory, over the register access of BiSS, and with each step failing."""

from __future__ import annotations

import logging
import pickle
import re
from pathlib import Path
from types import ModuleType
from typing import Any

import codewheel_runtime
import pytest


class Memory:
    """Registers that keep written values. The access ``fails_at`` fails, and so do all after it if ``lost``."""

    def __init__(self, registers: dict[int, int] | None = None, fails_at: int = -1, lost: bool = False) -> None:
        self.registers = dict(registers or {})
        self.fails_at, self.lost, self.count = fails_at, lost, 0
        self.written: list[tuple[int, bytes]] = []

    def _count_access(self) -> None:
        self.count += 1
        if self.count - 1 == self.fails_at or (self.lost and self.fails_at >= 0 and self.count > self.fails_at):
            raise OSError("the line is cut")

    def read(self, address: int, length: int, /) -> bytes:
        self._count_access()
        return bytes(self.registers.get(address + place, 0) for place in range(length))

    def write(self, address: int, data: bytes, /) -> None:
        self._count_access()
        self.written.append((address, bytes(data)))
        self.registers.update(enumerate(data, address))


@pytest.fixture
def lika(generated_python: tuple[Path, ModuleType]) -> Any:
    return generated_python[1]


def test_a_preset_as_the_manual_has_it(lika: Any) -> None:
    """The worked example: 1,000,003 with 21 bits, opened by 01h at 40h and closed before it is saved."""
    memory, waited, progress_calls = Memory(), [], []
    steps = lika.amm5.set_preset(lika.lookup("AMM5A21/65KSC1"), 1_000_003)
    result = lika.run(
        steps,
        memory,
        wait=waited.append,
        progress=lambda at, step_count, step: progress_calls.append((at, step_count, step)),
    )
    assert result == ()
    assert bytes(data[0] for _, data in memory.written) == bytes.fromhex("01 00 30 24 f4 00 00 00 00 01 02")
    assert [address for address, _ in memory.written] == [0x40, *range(0x11, 0x18), 0x40, 0x77, 0x77]
    assert waited == [0.03, 0.03]
    assert progress_calls == [(at, len(steps), step) for at, step in enumerate(steps)]


@pytest.mark.parametrize("at", range(12))
def test_what_was_opened_is_closed_when_a_step_fails(lika: Any, at: int) -> None:
    memory = Memory(fails_at=at)
    steps = lika.amm5.set_preset(lika.lookup("AMM5A21/65KSC1"), 1_000_003)
    with pytest.raises(lika.StepError, match="the line is cut") as caught:
        lika.run(steps, memory, wait=lambda seconds: None)
    assert isinstance(caught.value.__cause__, OSError)
    assert caught.value.left_open == ()
    assert caught.value.done == steps[: caught.value.at]
    # It is closed in any case, and no command was sent too early.
    assert memory.registers.get(0x40, 0) == 0
    assert [data for address, data in memory.written if address == 0x77] == [b"\x01", b"\x02"][: max(0, at - 10)]
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_what_stays_open_is_told(lika: Any) -> None:
    memory = Memory(fails_at=3, lost=True)
    with pytest.raises(lika.StepError) as caught:
        lika.run(lika.amm5.set_preset(lika.lookup("AMM5A21/65KSC1"), 5), memory)
    assert caught.value.left_open == ("preset_setting_enable",)
    assert str(caught.value) == (
        "step 4, Write (write the seven Preset registers): the line is cut; still open: preset_setting_enable"
    )


def test_an_interrupted_run_closes_too(lika: Any) -> None:
    memory = Memory()

    def interrupt(at: int, step_count: int, step: object) -> None:
        if at == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        lika.run(lika.amm5.set_preset(lika.lookup("AMM5A21/65KSC1"), 5), memory, progress=interrupt)
    assert memory.registers[0x40] == 0


def test_bits_that_were_changed_are_put_back(lika: Any) -> None:
    """AM36 opens its preset with a bit of the configuration, whose other bits stay the same."""
    steps = lika.am36.set_preset(lika.lookup("AM3616/4096-I7"), 100_000)
    change = next(step for step in steps if isinstance(step, codewheel_runtime.Modify))
    before = 0xFF & ~change.mask
    sound, broken = Memory({change.address: before}), Memory({change.address: before}, fails_at=4)
    lika.run(steps, sound, wait=lambda seconds: None)
    assert sound.registers[change.address] == before | change.value
    with pytest.raises(lika.StepError):
        lika.run(steps, broken, wait=lambda seconds: None)
    assert broken.registers[change.address] == before


@pytest.mark.parametrize(("value", "length", "allowed"), [(256, 1, 255), (-1, 1, 255), (1 << 16, 2, 65535)])
def test_a_value_that_does_not_fit_is_not_written(lika: Any, value: int, length: int, allowed: int) -> None:
    memory = Memory()
    with pytest.raises(lika.StepError, match=f"^step 1, Write: value must be 0 to {allowed}, got {value}$"):
        lika.run([codewheel_runtime.Write(5, value, "it", length=length)], memory)
    assert memory.written == []


def test_byte_order_of_a_step(lika: Any) -> None:
    for order, expected in (("little", b"\x01\x80"), ("big", b"\x80\x01")):
        memory = Memory({5: 1, 6: 0} if order == "little" else {5: 0, 6: 1})
        lika.run([codewheel_runtime.Modify(5, 2, "it", 0xFF00, 0x8000, order=order)], memory)
        assert memory.read(5, 2) == expected
        lika.run([codewheel_runtime.Poll(5, 2, "it", 0xFF00, 0x8000, order=order)], memory)
        with pytest.raises(lika.StepError, match=r"the register did not reach the expected value within 0\.01 s"):
            lika.run([codewheel_runtime.Poll(5, 2, "it", 0xFFFF, 1, order=order)], memory, poll_s=0.01)


def test_what_is_read_is_given(lika: Any) -> None:
    steps = lika.asc85.reset_errors(lika.lookup("ASC8525/SC1"))
    reads = lika.run(steps, Memory({0x69: 7}))
    expected = [(step.register, step.length) for step in steps if isinstance(step, codewheel_runtime.Read)]
    assert [(result.step.register, len(result.data)) for result in reads] == expected
    assert reads[0].data == b"\x07"


class Encoder485:
    """An encoder at the other end of a serial line. Its replies wait until they are read or discarded."""

    def __init__(self, *answers: bytes) -> None:
        self.answers, self.sent, self.waiting = list(answers), 0, b""

    def drain(self) -> None:
        self.waiting = b""

    def send(self, request: bytes, /) -> None:
        self.sent += 1
        self.waiting += self.answers.pop(0) if self.answers else request + bytes(4) + request

    def receive(self, length: int, /) -> bytes:
        reply, self.waiting = self.waiting[:length], self.waiting[length:]
        return reply


def test_a_request_owns_its_reply(lika: Any) -> None:
    """An old reply is not taken as the answer, and no reply is left behind."""
    line, waited = Encoder485(), []
    line.waiting = bytes.fromhex("02 00 01 02 03 02")
    steps = lika.amm5.reset_errors(lika.lookup("AMM5A23/65KJP1"))
    lika.run(steps, line, wait=waited.append)
    assert (line.sent, line.waiting) == (10, b"")
    assert waited == [*[0.00004] * 10, 0.002]


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        ("", "no reply to BA"),
        ("BA 00 00 00 00", "the reply to BA is BA 00 00 00 00: expected 6 bytes, got 5"),
        ("02 00 00 00 00 02", "it is the reply to another request"),
        ("BA 00 01 00 00 BA", "expected CRC 0xbb, got 0xba"),
        ("BA BA 00 01 00 00", "expected CRC 0x01, got 0x00. Is it an echo of the request?"),
    ],
)
def test_a_reply_to_another_request_is_refused(lika: Any, answer: str, message: str) -> None:
    steps = lika.amm5.reset_errors(lika.lookup("AMM5A23/65KJP1"))
    sound_reply = bytes.fromhex("BA 00 00 00 00 BA")
    with pytest.raises(lika.StepError, match=re.escape(message)):
        lika.run(steps, line := Encoder485(sound_reply, bytes.fromhex(answer)), wait=lambda seconds: None)
    assert line.sent == 2


def test_a_line_that_cannot_receive_is_refused(lika: Any) -> None:
    requests: list[bytes] = []

    class Port:
        def send(self, request: bytes, /) -> None:
            requests.append(request)

    with pytest.raises(lika.StepError, match="Port has no 'drain': a line needs drain, send and receive"):
        lika.run(lika.amm5.reset_errors(), Port())
    assert requests == []


def test_over_the_registers_of_biss(lika: Any) -> None:
    """Exchange the bits of each frame between a master and a slave of the package."""
    from importlib import import_module

    biss = import_module("lika_encoders.biss")
    registers = {0x40: 0, 0x78: 0x4C, 0x79: 0x69}
    slave = biss.Slave(readable=[*range(0x11, 0x18), *range(0x40, 0x80)], writable=[0x40, *range(0x11, 0x18), 0x77])

    def exchange(cdm: int) -> int:
        cds = slave.next(cdm)
        if slave.wants is biss.Wants.BYTE:
            slave.give(registers.get(slave.address, 0))
        elif slave.wants is biss.Wants.STORE:
            registers[slave.address] = slave.value
            slave.stored()
        return int(cds)

    bus = biss.RegisterBus(exchange, busy_limit=3)
    assert bus.read(0x78, 2) == b"Li"
    lika.run(lika.amm5.set_preset(lika.lookup("AMM5A21/65KSC1"), 1_000_003), bus, wait=lambda seconds: None)
    assert bytes(registers[place] for place in range(0x11, 0x18)) == bytes.fromhex("00 30 24 f4 00 00 00")
    assert (registers[0x40], registers[0x77]) == (0, 2)
    message = "access to registers from 78h failed: the register is protected or not implemented"
    with pytest.raises(biss.AccessError, match=message):
        bus.write(0x78, b"x")


@pytest.mark.parametrize("register", range(0x11, 0x18))
@pytest.mark.parametrize("bit", range(8))
def test_a_disturbed_preset_is_never_saved(lika: Any, register: int, bit: int) -> None:
    """AMM5 6.4: a bit of one of the seven registers is stored wrong. The preset is closed, and no command is sent."""

    class Disturbed(Memory):
        def write(self, address: int, data: bytes, /) -> None:
            super().write(address, data)
            if address == register:
                self.registers[address] ^= 1 << bit

    memory, preset_bytes = Disturbed(), bytes.fromhex("00 30 24 f4 00 00 00")
    with pytest.raises(lika.StepError) as caught:
        lika.run(lika.amm5.set_preset(lika.lookup("AMM5A21/65KSC1"), 1_000_003), memory, wait=lambda seconds: None)
    assert 0x77 not in memory.registers
    assert (memory.registers[0x40], caught.value.left_open) == (0, ())
    error, stored_bytes = caught.value.__cause__, bytearray(preset_bytes)
    stored_bytes[register - 0x11] ^= 1 << bit
    assert isinstance(error, lika.VerifyError)
    assert (error.register, error.address, error.written, error.found) == (
        "preset",
        0x11,
        preset_bytes,
        bytes(stored_bytes),
    )
    stored = stored_bytes.hex(" ").upper()
    assert str(caught.value) == (
        f"step 9, Verify: register preset at 11h holds {stored}, but 00 30 24 F4 00 00 00 was written"
    )
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


def test_bits_that_do_not_count_may_differ(lika: Any) -> None:
    """The mask covers the whole number. A field of a register that was changed is verified, too."""
    for order, mask in (("little", 0x00FF), ("big", 0xFF00)):
        writes = [codewheel_runtime.Write(5, 1, "it"), codewheel_runtime.Write(6, 2, "it")]
        steps = [*writes, codewheel_runtime.Verify(5, 2, "it", mask, order=order)]
        memory = Memory()
        lika.run([*steps[:2]], memory)
        memory.write = lambda address, data: None  # type: ignore[method-assign]
        memory.registers[6] = 7
        assert lika.run(steps, memory) == ()
        memory.registers[5] = 7
        with pytest.raises(lika.StepError, match="register it at 05h holds 07 07, but 01 02 was written"):
            lika.run(steps, memory)
    with pytest.raises(lika.StepError, match="no earlier step wrote to it, so it cannot be verified"):
        lika.run([codewheel_runtime.Verify(5, 1, "it", 0xFF)], Memory())
    with pytest.raises(lika.StepError, match="no earlier step wrote to it, so it cannot be verified"):
        lika.run([codewheel_runtime.Write(5, 1, "it"), codewheel_runtime.Verify(5, 2, "it", 0xFFFF)], Memory())
    changed = [codewheel_runtime.Modify(5, 1, "it", 0x0F, 0x05), codewheel_runtime.Verify(5, 1, "it", 0x0F)]
    assert lika.run(changed, Memory({5: 0xF0})) == ()


def test_each_byte_is_compared_with_its_last_value(lika: Any) -> None:
    """Later steps change the second byte of a register, and then both bytes."""
    both_bytes, second = codewheel_runtime.Modify(5, 2, "it", 0xFFFF, 0x0201), codewheel_runtime.Write(6, 7, "other")
    verified = codewheel_runtime.Verify(5, 2, "it", 0xFFFF)
    memory = Memory({5: 0, 6: 0})
    assert lika.run([both_bytes, second, verified], memory) == ()
    assert (memory.registers[5], memory.registers[6]) == (1, 7)
    assert lika.run([second, both_bytes, verified, codewheel_runtime.Verify(6, 1, "other", 0xFF)], memory) == ()
    assert (memory.registers[5], memory.registers[6]) == (1, 2)
    memory.write = lambda address, data: None  # type: ignore[method-assign]
    with pytest.raises(lika.StepError, match="register it at 05h holds 01 02, but 01 07 was written"):
        lika.run([both_bytes, second, verified], memory)


@pytest.mark.parametrize("disturbed_place", range(7))
def test_a_disturbed_preset_is_never_saved_over_biss(lika: Any, disturbed_place: int) -> None:
    """The slave of the package stores a wrong value, because half of all values can come back like this (biss.py)."""
    from importlib import import_module

    biss = import_module("lika_encoders.biss")
    registers: dict[int, int] = {}
    slave = biss.Slave(readable=range(0x11, 0x18), writable=[0x40, *range(0x11, 0x18), 0x77])

    def exchange(cdm: int) -> int:
        cds = slave.next(cdm)
        if slave.wants is biss.Wants.BYTE:
            slave.give(registers.get(slave.address, 0))
        elif slave.wants is biss.Wants.STORE:
            registers[slave.address] = slave.value ^ (0x10 if slave.address == 0x11 + disturbed_place else 0)
            slave.stored()
        return int(cds)

    bus = biss.RegisterBus(exchange, busy_limit=3)
    with pytest.raises(lika.StepError) as caught:
        lika.run(lika.amm5.set_preset(lika.lookup("AMM5A21/65KSC1"), 1_000_003), bus, wait=lambda seconds: None)
    assert isinstance(caught.value.__cause__, lika.VerifyError)
    assert (registers[0x40], 0x77 in registers) == (0, False)


def test_steps_are_logged(lika: Any, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG, logger="codewheel_runtime"):
        lika.run([codewheel_runtime.Write(5, 6, "it")], Memory())
        with pytest.raises(lika.StepError):
            lika.run([codewheel_runtime.Write(5, 6, "it")], Memory(fails_at=0))
    assert [record.levelname for record in caplog.records] == ["DEBUG", "DEBUG", "WARNING"]
    assert caplog.records[0].getMessage().startswith("step 1 of 1: Write(address=5, value=6")


@pytest.mark.parametrize("wrong_steps", [None, b"x", [None], [b"x"], "single step"])
def test_what_is_not_steps_is_refused_before_anything_is_sent(lika: ModuleType, wrong_steps: Any) -> None:
    amm5 = lika.amm5
    sent: list[Any] = []
    steps = amm5.set_preset(amm5.lookup("AMM5A21/65KSC1"), 0)[0] if wrong_steps == "single step" else wrong_steps
    with pytest.raises(TypeError, match="expected the steps of a procedure"):
        lika.run(steps, sent)
    assert sent == []


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        ("x", "must be a mapping"),
        ([1], "must be a mapping"),
        ({"a": 1}, "address of a register must be an integer"),
    ],
)
def test_contents_that_are_no_mapping_by_address_are_refused(lika: ModuleType, contents: Any, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        lika.lookup("SMA21-BG1-0050").with_registers(contents)
    if not isinstance(contents, dict):
        with pytest.raises(TypeError, match=message):
            lika.amm5.identify(contents)
