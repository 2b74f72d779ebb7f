"""Infer the edition of the manual that applies to an encoder from its label or its registers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..model import Device, EditionTest
from ..say.fault import of_older_edition
from .codec import Decoded, number_from_bytes
from .codec import decode as decode_word
from .findings import Difference
from .order_codes import Match


def edition_before(device: Device, revision: str) -> str:
    """Return the revision before this one."""
    names = [item.revision for item in device.editions]
    return names[names.index(revision) - 1]


def told_by_label(device: Device, match: Match) -> str:
    """Return the edition in which labels are written like this one, or "" if that is unknown."""
    patterns = {item.pattern for item in device.order_code.also_written if item.where == match.written_as_in}
    found = (item.revision for item in device.editions if not patterns.isdisjoint(item.labels))
    return next(found, "")


def tests_of(device: Device, register: str) -> Iterator[tuple[str, EditionTest]]:
    """Yield the tests of a register, each with the first revision in which the register is read that way."""
    for edition in device.editions:
        for test in edition.tests:
            if test.register == register:
                yield edition.revision, test


def strange_values(device: Device, decoded: Decoded) -> Iterator[Difference]:
    """Yield values that a register cannot have in this edition, which means that the encoder belongs to another one."""
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
    """Return the latest edition that is compatible with the registers of an encoder.

    Raises:
        ValueError: None of the registers that identify the edition is given completely.
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
    """Return the registers without those that identify the edition."""
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
