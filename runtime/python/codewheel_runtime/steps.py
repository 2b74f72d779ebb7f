# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Steps of a procedure: the actions of a master, as data."""

from __future__ import annotations

from typing import Literal, NamedTuple

from .codec import by_class, check_width


@by_class
class Write(NamedTuple):
    """Write one byte to a register address, or a whole register that has a single address.

    Attributes:
        address: Address of the byte or of the register.
        value: Number to write.
        register: Name of the register.
        meaning: Purpose of the step.
        closes: True if the step closes registers that an earlier step opened.
        length: Number of bytes in a single write, most significant first.
    """

    address: int
    value: int
    register: str
    meaning: str = ""
    closes: bool = False
    length: int = 1

    @property
    def data(self) -> bytes:
        """Bytes to write. Raises RangeError if the value does not fit into these bytes."""
        return check_width("value", self.value, 8 * self.length).to_bytes(self.length, "big")


@by_class
class Wait(NamedTuple):
    """Wait for at least ``microseconds``."""

    microseconds: int
    meaning: str = ""


@by_class
class Send(NamedTuple):
    """Send a request one or more times.

    Attributes:
        request: Bytes of the request.
        times: Number of requests.
        every_us: Minimum time from one request to the next, in microseconds.
        meaning: Purpose of the step.
        in_succession: True if no other request may be sent between the requests.
        reply_length: Number of bytes in the reply to each request, 0 if it is not known. The first byte of the reply
            equals the first byte of the request.
        reply_ends_in_xor: True if the last byte of the reply is the XOR of all other bytes.
    """

    request: bytes
    times: int = 1
    every_us: int = 0
    meaning: str = ""
    in_succession: bool = False
    reply_length: int = 0
    reply_ends_in_xor: bool = False


@by_class
class Read(NamedTuple):
    """Read ``length`` bytes, starting at a register address."""

    address: int
    length: int
    register: str
    meaning: str = ""


@by_class
class Verify(NamedTuple):
    """Read back the data that earlier steps wrote to a register, and stop if a bit in ``mask`` differs.

    Over BiSS, a corrupted write can look successful. This step is not in the manuals. It ensures that
    only the intended value is saved or activated. ``mask`` and ``order`` apply to the number that the bytes form.
    """

    address: int
    length: int
    register: str
    mask: int
    meaning: str = ""
    order: Literal["little", "big"] = "little"


@by_class
class Modify(NamedTuple):
    """Read a register, replace its bits in ``mask`` with the bits of ``value``, and write it.

    ``mask`` and ``value`` apply to the number that the bytes form. ``order`` is its byte order, as in
    ``int.from_bytes``. ``whole`` is true if the register has a single address for several bytes.
    """

    address: int
    length: int
    register: str
    mask: int
    value: int
    meaning: str = ""
    order: Literal["little", "big"] = "little"
    whole: bool = False


@by_class
class Poll(NamedTuple):
    """Read a register until its bits in ``mask`` equal ``value``.

    ``mask`` and ``value`` apply to the number that the bytes form. ``order`` is its byte order, as in
    ``int.from_bytes``.
    """

    address: int
    length: int
    register: str
    mask: int
    value: int
    meaning: str = ""
    order: Literal["little", "big"] = "little"


Step = Write | Wait | Send | Read | Modify | Poll | Verify


def write_bytes(
    register: str, address: int, data: bytes, meaning: str = "", *, closes: bool = False
) -> tuple[Write, ...]:
    """Return the steps that write ``data`` to ascending addresses, one for each byte."""
    return tuple(Write(address + index, byte, register, meaning, closes) for index, byte in enumerate(data))


def write_whole(register: str, address: int, data: bytes, meaning: str = "", *, closes: bool = False) -> tuple[Write]:
    """Return the step that writes ``data`` in a single write to a register that has only one address."""
    return (Write(address, int.from_bytes(data, "big"), register, meaning, closes, len(data)),)
