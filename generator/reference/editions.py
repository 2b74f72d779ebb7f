"""Find the edition of the manual that applies to an encoder from the contents of its registers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..model import Device, member_named, number_from_bytes
from ..order_codes.labels import Match, edition_before, tests_of
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
        raw = next((field.raw for field in decoded.fields if field.name == test.run), None)
        if raw is not None and not test.min <= raw <= test.max:
            bounds = f"{test.min} to {test.max}"
            older_edition = edition_before(device, revision)
            message = of_older_edition(test.run, f"{raw}", bounds, revision, register, older_edition)
            yield Difference(test.run, raw, bounds, message, True)


def edition_by_registers(device: Device, match: Match, bytes_by_address: Mapping[int, int]) -> str:
    """Return the latest edition with which the registers of an encoder are compatible.

    Raises:
        ValueError: ``bytes_by_address`` has no complete register that identifies the edition.
    """
    has_register = False
    for edition in device.editions:
        for test in edition.tests:
            register = device.register(test.register)
            addresses = range(register.address, register.last_address + 1)
            if not all(address in bytes_by_address for address in addresses):
                continue
            has_register = True
            number = number_from_bytes(register.layout, bytes(bytes_by_address[address] for address in addresses))
            decoded = decode_word(device, register.layout.place(match.variant.parameters), number)
            raw = member_named(decoded.fields, test.run, f"field of '{register.name}'").raw
            if not test.min <= raw <= test.max:
                return edition_before(device, edition.revision)
    if not has_register:
        raise ValueError(_missing_registers_message(device))
    return device.manual.revision


def without_tests(device: Device, bytes_by_address: Mapping[int, int]) -> dict[int, int]:
    """Return the registers except those that identify the edition."""
    registers = [device.register(test.register) for edition in device.editions for test in edition.tests]
    identifying: set[int] = set()
    for register in registers:
        identifying.update(range(register.address, register.last_address + 1))
    return {address: value for address, value in bytes_by_address.items() if address not in identifying}


def _missing_registers_message(device: Device) -> str:
    names = dict.fromkeys(test.register for edition in device.editions for test in edition.tests)
    if not names:
        return f"no register of {device.name} identifies the edition"
    options = []
    for name in names:
        register = device.register(name)
        addresses = range(register.address, register.last_address + 1)
        options.append(" ".join(f"--register 0x{address:02X}=0x.." for address in addresses))
    return f"to infer the edition, give all of {' or '.join(names)}: {'; or '.join(options)}"
