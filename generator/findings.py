"""What a frame or register says of the encoder: what it reports, what its position is worth, what is not as documented.

A sound frame is not yet a usable position: an encoder with an error, or a busy one, sends frames with a right CRC too.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from .codec import Decoded, DecodedField, number_from_bytes
from .expressions import Expression
from .model import Alarm, Device, Field, PlacedField, Register, Variant
from .words import sentence

#: The words of the spec language for what a position is worth, the worst first.
_WORST_FIRST = ("not_usable", "usable_with_warning", "usable")


@dataclass(frozen=True, slots=True)
class Report:
    """An active flag; ``makes_position`` is the word of the spec, or empty where the flag comes with no position."""

    field: str
    printed_name: str
    meaning: str
    remedy: str
    makes_position: str


@dataclass(frozen=True, slots=True)
class Difference:
    """A value that is another one than the manual has; ``of_register`` says that it is a register's."""

    field: str
    found: int | str
    documented: int | str
    message: str
    of_register: bool


@dataclass(frozen=True, slots=True)
class Findings:
    """What a frame or register says.

    ``verdict`` is a word of the spec language or ``not_told``; empty where there is no position or no sound frame.
    """

    reports: tuple[Report, ...] = ()
    verdict: str = ""
    differences: tuple[Difference, ...] = ()


def findings(device: Device, variant: Variant, decoded: Decoded) -> Findings:
    """What ``decoded`` says of the encoder; nothing where it has a fault, since then no bit of it can be relied on."""
    if decoded.problems or decoded.layout is None:
        return Findings()
    values = {item.name: item for item in decoded.fields}
    if decoded.layout.layout.sender == "master":
        return Findings()
    is_frame = decoded.layout.layout.sender == "encoder"
    placed = [item for item in decoded.layout.fields if item.field.kind == "flag"]
    active = [item.field for item in placed if values[item.name].value is True]
    alarms = {item.name: _alarm(device, item, "" if is_frame else decoded.layout.name) for item in active}
    # A flag of a register may say anything, such as "ready"; only those that the manual lists as alarms are reported.
    told = [item for item in active if (item.makes_position != "usable" if is_frame else alarms[item.name] is not None)]
    differences = tuple(_differences(variant, decoded, values, not is_frame))
    verdict = _verdict(device, variant, decoded, [item.field for item in placed], active) if is_frame else ""
    return Findings(tuple(_report(item, alarms[item.name]) for item in told), verdict, differences)


def _alarm(device: Device, field: Field, register: str) -> Alarm | None:
    """What the manual says of the flag among its alarms."""
    for item in device.alarms:
        here = item.register == register if register else bool(item.group) and item.group == field.group
        if here and item.field == field.name:
            return item
    return None


def _report(field: Field, alarm: Alarm | None) -> Report:
    texts = [text for text in (field.when_active, field.meaning) if text]
    if not texts:
        texts = [alarm.meaning if alarm is not None and alarm.meaning else "active"]
    meaning = texts[0] if len(texts) == 1 else " ".join(map(sentence, texts))
    if not field.implemented:
        meaning = "active, although the manual says that this encoder does not have it"
    remedy = alarm.remedy if alarm is not None else ""
    return Report(field.name, field.printed_name, meaning, remedy, field.makes_position)


def _verdict(device: Device, variant: Variant, decoded: Decoded, flags: list[Field], active: list[Field]) -> str:
    """What the position of a sound frame is worth, or empty where it carries none."""
    assert decoded.layout is not None
    if all(decoded.layout.place_of(name)[1] == 0 for name in device.position_names(variant.interface)):
        return ""
    if not any(item.makes_position in _WORST_FIRST[:2] for item in flags):
        return "not_told"
    names = {item.name for item in active}
    # A flag that sums up others adds nothing where one of these is here to speak for itself.
    speaking = {item.makes_position for item in active if names.isdisjoint(item.sums_up)}
    return next((word for word in _WORST_FIRST if word in speaking), "usable")


def _differences(
    variant: Variant, decoded: Decoded, values: Mapping[str, DecodedField], of_register: bool
) -> Iterator[Difference]:
    assert decoded.layout is not None
    for item in decoded.layout.fields:
        documented = _documented(item.field, variant)
        if documented is None:
            continue
        found = values[item.name].value if isinstance(documented, str) else values[item.name].raw
        if found != documented:
            name = item.field.printed_name or item.name
            message = _message(name, variant, found, documented, of_register)
            yield Difference(item.name, found, documented, message, of_register)


def _message(name: str, variant: Variant, found: int | str, documented: int | str, of_register: bool) -> str:
    has, wanted = _shown(found), _shown(documented)
    if of_register:
        return f"{name}: the register holds {has}, {variant.code} has {wanted}"
    return f"{name} is {has}, the manual has {wanted}"


def _shown(value: int | str) -> str:
    return f'"{value}"' if isinstance(value, str) else f"{value:#04x}"


def _documented(field: Field, variant: Variant) -> int | str | None:
    return field.equals.value(variant.parameters) if isinstance(field.equals, Expression) else field.equals


def _fixed(device: Device, variant: Variant) -> Iterator[Register]:
    """The registers by which this order code is known, but for those of a bank: others have their addresses too."""
    names = {register.name for register, _ in device.identity if register.bank is None}
    return (item for item in device.registers if item.name in names and item.interface == variant.interface)


def fixed_addresses(device: Device, variant: Variant) -> frozenset[int]:
    """The addresses of the registers by which this order code is known."""
    registers = _fixed(device, variant)
    return frozenset(address for item in registers for address in range(item.address, item.last_address + 1))


def compare_held(device: Device, variant: Variant, held: Mapping[int, int]) -> tuple[Difference, ...]:
    """Where registers hold other bytes than this order code has; of addresses not in ``held`` nothing is known."""
    return tuple(item for register in _fixed(device, variant) for item in _compare_register(variant, register, held))


def _compare_register(variant: Variant, register: Register, held: Mapping[int, int]) -> Iterator[Difference]:
    placed = register.layout.place(variant.parameters)
    addresses = range(register.address, register.last_address + 1)
    number = number_from_bytes(register.layout, bytes(held.get(address, 0) for address in addresses))
    given = number_from_bytes(register.layout, bytes(0xFF * (address in held) for address in addresses))
    for item in placed.fields:
        documented = _documented(item.field, variant)
        if documented is None:
            continue
        wanted = documented
        if isinstance(wanted, str):
            wanted = int.from_bytes(wanted.encode("ascii", "replace"), "big")
        known = given >> item.low & item.mask
        found = number >> item.low & known
        if found != wanted & known:
            where = f"{register.name}.{item.name}" if len(placed.fields) > 1 else register.name
            given_digits, wanted_digits = _digits(found, known, item), _digits(wanted, known, item)
            wrong = f"{where}: what is given of it is {given_digits}, {variant.code} has {wanted_digits}"
            if known == item.mask:
                wrong = f"{where}: the register holds {found:#04x}, {variant.code} has {wanted:#04x}"
            yield Difference(where, found, wanted, wrong, True)


def _digits(value: int, known: int, item: PlacedField) -> str:
    """The hex digits of a field, with dots for those of which nothing is known."""
    shifts = range((item.width - 1) // 4 * 4, -1, -4)
    return "".join(f"{value >> shift & 15:X}" if known >> shift & 15 else "." for shift in shifts) + "h"
