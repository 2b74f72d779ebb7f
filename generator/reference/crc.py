"""Compute cyclic redundancy checks bit by bit, following the definition.

Parameters have their usual names: width, poly (without its top bit), init, refin, refout, xorout.
"""

from __future__ import annotations

from ..model import Crc


def reflect(value: int, width: int) -> int:
    """Return ``value`` with its ``width`` bits in reverse order."""
    return int(f"{value:0{width}b}"[::-1], 2)


def compute_bits(crc: Crc, number: int, bits: int) -> int:
    """Compute the CRC over ``bits`` bits of ``number``, one by one and most significant first.

    ``refin`` has no meaning for a string of bits and is ignored.
    """
    register, mask, poly, top = crc.init, crc.mask, crc.poly, crc.width - 1
    for index in range(bits - 1, -1, -1):
        feedback = (register >> top ^ number >> index) & 1
        register = register << 1 & mask
        if feedback:
            register ^= poly
    if crc.refout:
        register = reflect(register, crc.width)
    return register ^ crc.xorout


def compute_bytes(crc: Crc, data: bytes) -> int:
    """Compute the CRC over whole bytes. With ``refin``, each byte is processed least significant bit first."""
    return compute_bits(crc, *in_order(crc, data))


def in_order(crc: Crc, data: bytes) -> tuple[int, int]:
    """Return the bits of whole bytes as a number, in the order in which the CRC processes them, and how many."""
    number = 0
    for byte in data:
        number = number << 8 | (reflect(byte, 8) if crc.refin else byte)
    return number, 8 * len(data)


def start_for(crc: Crc, number: int, bits: int, result: int) -> int:
    """Return the ``init`` with which the CRC over these bits is ``result``.

    There is exactly one if the lowest bit of ``poly`` is set, because each step can then be undone.
    """
    register = result ^ crc.xorout
    if crc.refout:
        register = reflect(register, crc.width)
    for index in range(bits):
        feedback = register & 1
        if feedback:
            register ^= crc.poly
        register = register >> 1 | (feedback ^ number >> index & 1) << crc.width - 1
    return register
