"""Find the edition of the manual that applies to an encoder from the contents of its registers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..model import Device, number_from_bytes
from ..order_codes.editions import edition_before, tests_of
from ..order_codes.labels import Match
from ..say.fault import of_older_edition
from .codec import Decoded
from .codec import decode as decode_word
from .findings import Difference


def strange_values(device: Device, decoded: Decoded) -> Iterator[Difference]:
    """Yield register values that are impossible in this edition, so that another edition must apply to the encoder."""
    if decoded.layout is None or decoded.layout.layout.sender:
        return
    register = decoded.layout.name
    for revision, test in tests_of(device, register):
        found = next((item.raw for item in decoded.fields if item.name == test.run), None)
        if found is not None and not test.min <= found <= test.max:
            bounds = f"{test.min} to {test.max}"
            before = edition_before(device, revision)
            message = of_older_edition(test.run, f"{found}", bounds, revision, register, before)
            yield Difference(test.run, found, bounds, message, True)


def told_by_registers(device: Device, match: Match, held: Mapping[int, int]) -> str:
    """Return the latest edition with which the registers of an encoder are compatible.

    Raises:
        ValueError: ``held`` has no complete register that identifies the edition.
    """
    given = False
    for edition in device.editions:
        for test in edition.tests:
            register = device.register(test.register)
            addresses = range(register.address, register.last_address + 1)
            if not all(address in held for address in addresses):
                continue
            given = True
            number = number_from_bytes(register.layout, bytes(held[address] for address in addresses))
            decoded = decode_word(device, register.layout.place(match.variant.parameters), number)
            found = next(item.raw for item in decoded.fields if item.name == test.run)
            if not test.min <= found <= test.max:
                return edition_before(device, edition.revision)
    if not given:
        raise ValueError(_needed(device))
    return device.manual.revision


def without_tests(device: Device, held: Mapping[int, int]) -> dict[int, int]:
    """Return the registers except those that identify the edition."""
    registers = [device.register(test.register) for item in device.editions for test in item.tests]
    telling = {address for item in registers for address in range(item.address, item.last_address + 1)}
    return {address: value for address, value in held.items() if address not in telling}


def _needed(device: Device) -> str:
    names = dict.fromkeys(test.register for item in device.editions for test in item.tests)
    if not names:
        return f"no register of {device.name} identifies the edition"
    asked = []
    for name in names:
        item = device.register(name)
        asked.append(" ".join(f"--register 0x{at:02X}=0x.." for at in range(item.address, item.last_address + 1)))
    return f"to infer the edition, give all of {' or '.join(names)}: {'; or '.join(asked)}"
