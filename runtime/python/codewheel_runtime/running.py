# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Runs procedures on any object that reads and writes registers, or that sends requests."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from time import monotonic, sleep
from typing import Any, NamedTuple, Protocol, cast, get_args

from .steps import Modify, Poll, Read, Send, Step, Verify, Wait, Write


class Bus(Protocol):
    """Object that reads and writes registers, such as ``biss.RegisterBus`` or your own master."""

    def read(self, address: int, length: int, /) -> bytes:
        """Return ``length`` bytes, starting at an address. Over SPI, they are the bytes of the register there."""
        ...

    def write(self, address: int, data: bytes, /) -> object:
        """Write bytes, starting at an address. Over SPI, they are the bytes of the register there."""
        ...


class Line(Protocol):
    """Connection that sends a request and receives the reply, such as a serial port.

    Each reply is read and checked before the next request, so it cannot be mistaken for a later one.
    """

    def drain(self) -> object:
        """Discard all bytes that were received but not read."""
        ...

    def send(self, request: bytes, /) -> object:
        """Send one request."""
        ...

    def receive(self, length: int, /) -> bytes:
        """Return ``length`` bytes, or fewer after a timeout. An echo of the request must be omitted."""
        ...


class Reading(NamedTuple):
    """Bytes that a step read.

    Attributes:
        step: The step.
        data: Bytes of the register, in ascending order of address.
    """

    step: Read
    data: bytes


class StepError(RuntimeError):
    """A step of a procedure failed. ``__cause__`` is the original error.

    Attributes:
        step: The step that failed.
        at: Index of the step.
        done: Steps that were carried out before it.
        left_open: Names of registers that could not be closed or restored.
        reason: Text of the original error.
    """

    def __init__(self, step: Step, at: int, done: tuple[Step, ...], left_open: tuple[str, ...], reason: str) -> None:
        super().__init__(step, at, done, left_open, reason)
        self.step = step
        self.at = at
        self.done = done
        self.left_open = left_open
        self.reason = reason

    def __str__(self) -> str:
        meaning = f" ({self.step.meaning})" if self.step.meaning else ""
        still = f"; still open: {', '.join(self.left_open)}" if self.left_open else ""
        return f"step {self.at + 1}, {type(self.step).__name__}{meaning}: {self.reason}{still}"


class VerifyError(ValueError):
    """A register does not hold the value that was written to it.

    Nothing was saved or activated, so the procedure can be repeated.

    Attributes:
        register: Name of the register.
        address: Address of its first byte.
        written: Bytes that were written.
        found: Bytes that were read.
        mask: Bits that were compared, in the number that the bytes form.
    """

    def __init__(self, register: str, address: int, written: bytes, found: bytes, mask: int) -> None:
        super().__init__(register, address, written, found, mask)
        self.register = register
        self.address = address
        self.written = written
        self.found = found
        self.mask = mask

    def __str__(self) -> str:
        found = self.found.hex(" ").upper()
        written = self.written.hex(" ").upper()
        return f"register {self.register} at {self.address:02X}h holds {found}, but {written} was written"


class _Procedure:
    """Procedure that is being carried out. It keeps the values to restore if a step fails."""

    def __init__(self, bus: object, poll_s: float, wait: Callable[[float], object]) -> None:
        self.bus = bus
        self.poll_s = poll_s
        self.wait = wait
        self.readings: list[Reading] = []
        #: Addresses to which steps have written.
        self._written_addresses: set[int] = set()
        #: Last value that was written to each byte, and to each register with a single address, by address.
        self._written_bytes: dict[int, int] = {}
        self._written_registers: dict[int, bytes] = {}
        #: Name and bytes of each modified register before its first change, by address.
        self._original_values: dict[int, tuple[str, bytes]] = {}

    def run_steps(self, steps: Sequence[Step], progress: Callable[[int, int, Step], object] | None) -> None:
        """Carry out steps in order. If a step fails, registers are closed and restored as far as possible.

        ``progress`` is called before each step with its index, the number of steps, and the step. A failure raises
        StepError. An interruption, such as Ctrl-C, is raised unchanged.
        """
        from logging import getLogger

        logger = getLogger("codewheel_runtime")
        step_count = len(steps)
        for index, step in enumerate(steps):
            logger.debug("step %d of %d: %r", index + 1, step_count, step)
            try:
                if progress is not None:
                    progress(index, step_count, step)
                self.run_step(step)
            except BaseException as error:
                # This includes interruptions, such as Ctrl-C.
                left_open = self.restore(steps[index:])
                open_text = left_open or "nothing"
                logger.warning("step %d of %d failed: %r; left open: %s", index + 1, step_count, error, open_text)
                if not isinstance(error, Exception):
                    raise
                done = tuple(steps[:index])
                # Some errors have no text.
                reason = str(error) or repr(error)
                raise StepError(step, index, done, left_open, reason) from error

    def run_step(self, step: Step) -> None:
        """Carry out one step, and remember what it changed."""
        bus = cast(Bus, self.bus)
        if isinstance(step, Write):
            self._written_addresses.add(step.address)
            self._remember_written(step.address, step.data, whole=step.length > 1)
            bus.write(step.address, step.data)
        elif isinstance(step, Wait):
            self.wait(step.microseconds / 1_000_000)
        elif isinstance(step, Send):
            self._send(step)
        elif isinstance(step, Read):
            self.readings.append(Reading(step, self._read(step)))
        elif isinstance(step, Modify):
            data = self._read(step)
            number = (int.from_bytes(data, step.order) & ~step.mask) | step.value
            # Only the first of several changes reads the original bytes.
            self._original_values.setdefault(step.address, (step.register, data))
            changed = number.to_bytes(step.length, step.order)
            self._remember_written(step.address, changed, whole=step.whole)
            bus.write(step.address, changed)
        elif isinstance(step, Verify):
            self._verify(step)
        else:
            self._poll(step)

    def _remember_written(self, address: int, data: bytes, *, whole: bool) -> None:
        """Remember the bytes that are written from an address on, to verify them later.

        ``whole`` is True if a single address holds all bytes of the register. Otherwise, each byte has its own address.
        """
        if whole:
            self._written_registers[address] = data
        else:
            self._written_bytes.update(enumerate(data, address))

    def _verify(self, step: Verify) -> None:
        """Compare a register with the bytes that earlier steps wrote to it.

        Raises:
            VerifyError: A bit in the mask of the step differs.
            ValueError: Not all bytes of the register were written.
        """
        written = self._written_registers.get(step.address)
        if written is None:
            addresses = range(step.address, step.address + step.length)
            written = bytes(self._written_bytes[address] for address in addresses if address in self._written_bytes)
        # A byte that no step has written is missing.
        if len(written) < step.length:
            raise ValueError(f"no earlier step wrote to {step.register}, so it cannot be verified")
        data = self._read(step)
        differing_bits = int.from_bytes(written, step.order) ^ int.from_bytes(data, step.order)
        if differing_bits & step.mask:
            raise VerifyError(step.register, step.address, written, data, step.mask)

    def _read(self, step: Read | Modify | Poll | Verify) -> bytes:
        """Return the bytes of the register of a step. Raises ValueError if the bus returns more or fewer bytes."""
        data = bytes(cast(Bus, self.bus).read(step.address, step.length))
        if len(data) != step.length:
            raise ValueError(f"expected {step.length} bytes, read {len(data)}")
        return data

    def _poll(self, step: Poll) -> None:
        """Read a register until its bits in the mask of the step have the expected value.

        Raises TimeoutError after ``poll_s`` seconds.
        """
        deadline = monotonic() + self.poll_s
        while True:
            number = int.from_bytes(self._read(step), step.order)
            if (number & step.mask) == step.value:
                return
            if monotonic() > deadline:
                raise TimeoutError(f"the register did not reach the expected value within {self.poll_s:g} s")

    def _send(self, step: Send) -> None:
        """Send the request of a step the required number of times, and check each reply if its length is known."""
        line = cast(Line, self.bus)
        for name in ("drain", "send", "receive"):
            if not callable(getattr(line, name, None)):
                raise TypeError(f"{type(line).__name__} has no '{name}': a line needs drain, send and receive")
        for _ in range(step.times):
            line.drain()
            line.send(step.request)
            if step.reply_length:
                _check_reply(step, bytes(line.receive(step.reply_length)))
            self.wait(step.every_us / 1_000_000)
        line.drain()

    def restore(self, remaining_steps: Sequence[Step]) -> tuple[str, ...]:
        """Close the registers that the remaining steps would have closed, and restore modified registers.

        Return the names of the registers for which this failed.
        """
        failed_registers: list[str] = []
        for step in remaining_steps:
            # A register that has not been written was not opened.
            if isinstance(step, Write) and step.closes and step.address in self._written_addresses:
                failed_registers += self._try_to_write(step.register, step.address, step.data)
        for address, (register, data) in reversed(self._original_values.items()):
            failed_registers += self._try_to_write(register, address, data)
        return tuple(failed_registers)

    def _try_to_write(self, register: str, address: int, data: bytes) -> list[str]:
        """Write to a register. Return a list with the register's name if this failed, otherwise an empty list."""
        try:
            cast(Bus, self.bus).write(address, data)
        except Exception:  # The original error is the one to report.
            return [register]
        return []


def _check_reply(step: Send, reply: bytes) -> None:
    """Raise an error unless ``reply`` is a complete reply to the request of a step.

    A complete reply has the length given in the step, and begins with the first byte of the request. If the step
    requires it, the last byte is the XOR of all other bytes.
    """
    reply_text = f"the reply to {step.request.hex(' ').upper()} is {reply.hex(' ').upper()}"
    if not reply:
        raise TimeoutError(f"no reply to {step.request.hex(' ').upper()}")
    if len(reply) != step.reply_length:
        raise ValueError(f"{reply_text}: expected {step.reply_length} bytes, got {len(reply)}")
    if reply[0] != step.request[0]:
        raise ValueError(f"{reply_text}: it is the reply to another request")
    crc = 0
    for byte in reply[:-1]:
        crc ^= byte
    if step.reply_ends_in_xor and crc != reply[-1]:
        # After an echo, the reply repeats the first byte of the request. A request of one byte therefore comes twice.
        echo = ". Is it an echo of the request?" if reply.startswith(step.request * 2) else ""
        raise ValueError(f"{reply_text}: expected CRC {crc:#04x}, got {reply[-1]:#04x}{echo}")


def run(
    steps: Sequence[Step],
    bus: Bus | Line,
    *,
    progress: Callable[[int, int, Step], object] | None = None,
    poll_s: float = 1.0,
    wait: Callable[[float], object] = sleep,
) -> tuple[Reading, ...]:
    """Carry out the steps of a procedure in order.

    If a step fails or is interrupted, opened registers are closed and modified registers are restored, but commands are
    not undone. Omit the ``Verify`` steps for an encoder that does not return the values that it stored. On a line,
    unread bytes are discarded before each request, and each reply of known length is checked.

    Not yet tested on hardware.

    Args:
        steps: Steps, as returned by a function for a procedure.
        bus: Object that reads and writes registers. For RS-485 requests, a line that sends them and receives replies.
            The ``lock`` of a link is held until the last step.
        progress: Called before each step with its index, the number of steps, and the step.
        poll_s: Maximum time to poll a register, in seconds.
        wait: Function that waits for a number of seconds.

    Returns:
        The registers that were read, in order.

    Raises:
        StepError: A step failed. Its ``__cause__`` is the reason: a ``VerifyError`` if a register does not hold the
            value that was written.
        TypeError: ``steps`` contains something else. Nothing was sent.
    """
    check_steps(steps)
    procedure = _Procedure(bus, poll_s, wait)
    # Another thread must not send requests between the requests of a procedure.
    lock: Any = getattr(bus, "lock", None)
    with lock if hasattr(lock, "__enter__") else nullcontext():
        procedure.run_steps(steps, progress)
    return tuple(procedure.readings)


def check_steps(steps: object) -> None:
    """Raise TypeError if ``steps`` is not a sequence of steps, for example a single step."""
    is_single_step = isinstance(steps, get_args(Step))
    if is_single_step or not isinstance(steps, Sequence):
        raise TypeError(
            f"expected the steps of a procedure, got {type(steps).__name__}: run((step,), bus) runs one step"
        )
    for step in cast("Sequence[object]", steps):
        if not isinstance(step, get_args(Step)):
            raise TypeError(f"expected the steps of a procedure, which contain no {type(step).__name__}")
