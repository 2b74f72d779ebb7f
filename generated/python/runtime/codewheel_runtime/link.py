# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Link to an encoder over RS-485: a session on a serial port, or on a line of your own."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Sequence
from importlib import import_module
from threading import RLock
from time import monotonic
from typing import Any, Protocol, TypeVar

from .encoder import Encoder, Frame, PositionFrame, SerialEncoder
from .errors import InterfaceError
from .link_errors import (
    BusyError,
    DisturbedError,
    LinkError,
    NoReplyError,
    NotUsableError,
    PortError,
    SecondDeviceError,
    WrongEncoderError,
)
from .reports import Interface
from .session import Session, Statistics, Work, load_rs485_facts
from .steps import Step

__all__ = [
    "BusyError",
    "DisturbedError",
    "Link",
    "LinkError",
    "NoReplyError",
    "NotUsableError",
    "PortError",
    "Ports",
    "SecondDeviceError",
    "SerialTransport",
    "Statistics",
    "Transport",
    "WrongEncoderError",
    "open_encoder",
    "serial_transport",
]

_Result = TypeVar("_Result")


class Transport(Protocol):
    """Line to an encoder. Write your own class with these two methods to use a link with other hardware."""

    def write(self, data: bytes, /) -> object:
        """Send bytes."""
        ...

    def read(self, timeout_s: float, /) -> bytes:
        """Return all bytes that have arrived.

        If no bytes have arrived, wait for the first byte for at most ``timeout_s``.
        """
        ...


class Link:
    """Link to an encoder. Close it, or use it in a ``with`` statement.

    Several threads can use one link: their requests are sent one after the other. It also serves as the line of
    ``codewheel_runtime.run``.

    Args:
        encoder: The encoder, with RS-485.
        transport: Line to the encoder.
        timeout_s: Time in seconds within which a reply must be complete.
        retries: Number of further attempts after a failure.
        settle_s: Time in seconds for which the line must be quiet after a reply. The default depends on the baud rate
            and the measured reply times. With 0, a request of another kind is sent before each request instead.

    Attributes:
        lock: Lock that is held during each request and each procedure. Hold it for requests that belong together.

    Raises:
        InterfaceError: The encoder has a different interface.
        TypeError, ValueError: A time or ``retries`` is out of range, or ``settle_s`` is 0 but the encoder has too few
            kinds of requests for it.
    """

    def __init__(
        self,
        encoder: Encoder,
        transport: Transport,
        *,
        timeout_s: float = 0.05,
        retries: int = 3,
        settle_s: float | None = None,
    ) -> None:
        self.encoder = encoder
        self.transport = transport
        self.lock = RLock()
        self.session = Session(encoder, timeout_s=timeout_s, retries=retries, settle_s=settle_s)

    @property
    def statistics(self) -> Statistics:
        """Counters for requests, replies and failures."""
        return self.session.statistics

    def position(self, request: Any = None) -> int:
        """Return the position in counts.

        Args:
            request: Request for the position, with the encoder's address. Default: the request with the factory
                defaults.

        Raises:
            NotUsableError: The encoder reports that its position is not usable.
            LinkError: There is no valid reply. The subclass indicates the reason.
        """
        return self._carry_out(self.session.position(request))

    def read(self, request: Any = None) -> PositionFrame:
        """Return a frame with the position. Check its ``verdict`` before you use the position.

        Args:
            request: Request for the position, with the encoder's address. Default: the request with the factory
                defaults.

        Raises:
            LinkError: There is no valid reply. The subclass indicates the reason.
        """
        return self._carry_out(self.session.read(request))

    def exchange(self, request: Any) -> Frame:
        """Send a request, and return the reply to it.

        Args:
            request: A request of the encoder's module, a member of its ``DataId``, or bytes.

        Returns:
            The reply.

        Raises:
            LinkError: There is no valid reply, or no such request. The subclass indicates the reason.
        """
        return self._carry_out(self.session.exchange(request))

    def run(self, steps: Sequence[Step]) -> None:
        """Carry out a procedure, such as a reset. If a request in a series fails, the series is restarted.

        Args:
            steps: Steps, as returned by a function for a procedure.

        Raises:
            StepError: A step failed. Its ``__cause__`` is the reason.
        """
        self._carry_out(self.session.run(steps))

    def drain(self) -> None:
        """Discard all bytes that were received but not read, until the line is quiet."""
        with self.lock:
            self._carry_out(self.session.drain())

    def send(self, request: bytes, /) -> None:
        """Send one request."""
        with self.lock:
            self.transport.write(request)

    def receive(self, length: int, /) -> bytes:
        """Return the bytes that arrive: at least ``length`` bytes, or fewer after a timeout.

        There are more if additional bytes arrived together with the last one.
        """
        data = b""
        deadline = monotonic() + self.session.timeout_s
        # After the timeout, ``read`` returns the bytes that have arrived, without a wait. If that is nothing, the loop
        # ends.
        with self.lock:
            while len(data) < length and (further_bytes := self.transport.read(max(0.0, deadline - monotonic()))):
                data += further_bytes
        return data

    def close(self) -> None:
        """Close the transport, if it can be closed."""
        close = getattr(self.transport, "close", None)
        if close is not None:
            close()

    def __enter__(self) -> Link:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _carry_out(self, work: Work[_Result]) -> _Result:
        """Carry out a task of the session: send its requests, and pass on the received bytes. Return its result.

        Raises:
            PortError: The transport failed.
            LinkError: The session raised this error.
        """
        with self.lock:
            try:
                ask = next(work)
                while True:
                    if ask.send:
                        self.transport.write(ask.send)
                    ask = work.send(self.transport.read(ask.wait_s))
            except StopIteration as done:
                # A generator returns its result in this exception.
                result: _Result = done.value
                return result
            except OSError as error:
                raise PortError(f"the line to {self.encoder.code} failed: {error.strerror or error}") from error
            finally:
                work.close()


class SerialTransport:
    """Serial port, or another line that pyserial can open, such as ``socket://host:port``.

    The port is opened exclusively, because two programs on one port would each miss some of the bytes.

    Args:
        port: Name of the port, such as ``/dev/ttyUSB0`` or ``COM3``, or a pyserial URL.
        baud: Baud rate.
        rs485: Let the driver of the port switch the direction of the line. Few adapters need this.
        parity: Parity bit of a byte: ``none``, ``even`` or ``odd``.
        stop_bits: Number of stop bits.

    Raises:
        PortError: pyserial is not installed, or the port cannot be opened.
    """

    def __init__(self, port: str, baud: int, *, rs485: bool = False, parity: str = "none", stop_bits: int = 1) -> None:
        try:
            serial: Any = import_module("serial")
        except ImportError:
            raise PortError("a serial port needs pyserial: pip install pyserial") from None
        try:
            self._port = serial.serial_for_url(
                port,
                baudrate=baud,
                timeout=0,
                write_timeout=1,
                parity=parity[0].upper(),
                stopbits=stop_bits,
                exclusive=True,
            )
            if rs485:
                self._port.rs485_mode = import_module("serial.rs485").RS485Settings()
        except (serial.SerialException, OSError, ValueError, KeyError) as error:
            raise PortError(_cannot_open_error(port, error)) from None

    def write(self, data: bytes, /) -> None:
        """Send bytes."""
        self._port.write(data)

    def read(self, timeout_s: float, /) -> bytes:
        """Return all bytes that have arrived.

        If no bytes have arrived, wait for the first byte for at most ``timeout_s``.
        """
        try:
            handle = self._port.fileno()
        except (OSError, AttributeError):  # Windows offers no file number for waiting.
            self._port.timeout = timeout_s
            first_byte: bytes = self._port.read(1)
            return first_byte + bytes(self._port.read(self._port.in_waiting)) if first_byte else b""
        from select import select

        # ``select`` waits. The port itself does not (timeout=0), and returns at most this many bytes that have arrived.
        most_bytes = 4096
        readable, _, _ = select([handle], [], [], timeout_s)
        return bytes(self._port.read(most_bytes)) if readable else b""

    def close(self) -> None:
        """Close the port."""
        self._port.close()


def open_encoder(
    port: str,
    encoder: Encoder,
    *,
    timeout_s: float = 0.05,
    retries: int = 3,
    settle_s: float | None = None,
    rs485: bool = False,
) -> Link:
    """Open a serial port with the settings of an encoder.

    Args:
        port: Name of the port, such as ``/dev/ttyUSB0`` or ``COM3``, or a pyserial URL.
        encoder: The encoder, with RS-485.
        timeout_s: Time in seconds within which a reply must be complete.
        retries: Number of further attempts after a failure.
        settle_s: Time in seconds for which the line must be quiet after a reply. The default depends on the baud rate
            and the measured reply times. With 0, a request of another kind is sent before each request instead.
        rs485: Let the driver of the port switch the direction of the line. Few adapters need this.

    Returns:
        The link, for a ``with`` statement.

    Raises:
        InterfaceError: The encoder has a different interface.
        PortError: The port cannot be opened, or pyserial is not installed.
    """
    if encoder.interface is not Interface.RS485:
        raise InterfaceError(
            encoder.code, encoder.interface, Interface.RS485, ", because a serial port cannot send its clock"
        )
    return Link(
        encoder,
        serial_transport(port, encoder, rs485=rs485),
        timeout_s=timeout_s,
        retries=retries,
        settle_s=settle_s,
    )


def serial_transport(port: str, encoder: Encoder, *, rs485: bool = False) -> SerialTransport:
    """Open a serial port with the settings of an encoder, without a link.

    Args:
        port: Name of the port, such as ``/dev/ttyUSB0`` or ``COM3``, or a pyserial URL.
        encoder: The encoder, with RS-485.
        rs485: Let the driver of the port switch the direction of the line. Few adapters need this.

    Raises:
        PortError: The port cannot be opened, or pyserial is not installed.
    """
    port_facts = load_rs485_facts(encoder).port
    return SerialTransport(port, port_facts.baud, rs485=rs485, parity=port_facts.parity, stop_bits=port_facts.stop_bits)


class Ports:
    """Functions of a manufacturer's package that open ports.

    Args:
        lookup: Function that returns the encoder for a label.
    """

    def __init__(self, lookup: Callable[[str], Encoder]) -> None:
        self._lookup = lookup

    def open_encoder(
        self,
        port: str,
        label: str | SerialEncoder,
        *,
        timeout_s: float = 0.05,
        retries: int = 3,
        settle_s: float | None = None,
        rs485: bool = False,
    ) -> Link:
        """Open the serial port to an encoder with RS-485.

        Not yet tested on hardware.

        Args:
            port: Name of the port, such as ``/dev/ttyUSB0`` or ``COM3``, or a pyserial URL.
            label: Order code on the label, or an encoder whose class shows that it has RS-485.
            timeout_s: Time in seconds within which a reply must be complete.
            retries: Number of further attempts after a failure.
            settle_s: Time in seconds for which the line must be quiet after a reply. The default depends on the baud
                rate and the measured reply times. With 0, a request of another kind is sent before each request
                instead.
            rs485: Let the driver of the port switch the direction of the line. Few adapters need this.

        Returns:
            The link, for a ``with`` statement.

        Raises:
            OrderCodeError: There is no such order code.
            InterfaceError: The encoder has a different interface.
            PortError: The port cannot be opened, or pyserial is not installed.
        """
        encoder = label if isinstance(label, Encoder) else self._lookup(label)
        return open_encoder(port, encoder, timeout_s=timeout_s, retries=retries, settle_s=settle_s, rs485=rs485)


def _cannot_open_error(port: str, error: Exception) -> str:
    """Return the message for a port that cannot be opened. It lists the ports of this computer."""
    error_number = getattr(error, "errno", None)
    if error_number in (errno.EAGAIN, errno.EBUSY):
        return f"cannot open {port}: another program, or another link of this program, has it open"
    reason = os.strerror(error_number) if error_number else str(error)
    if isinstance(error, KeyError):  # Of this error, pyserial says only the options that it knows, or their values.
        reason = "pyserial does not know an option after the ?, or its value"
    try:
        comports: Any = import_module("serial.tools.list_ports").comports()
        ports = ", ".join(comport.device for comport in comports)
    except (ImportError, OSError):
        ports = ""
    return f"cannot open {port}: {reason}; ports here: {ports or 'none'}"
