"""Findings in a frame or register: reports of the encoder, the verdict on the position, and undocumented values.

A valid frame may contain an unusable position, since an encoder with an error, or a busy one, also sends valid CRCs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ..model import (
    Alarm,
    Device,
    Field,
    Flag,
    Kind,
    Layout,
    PlacedField,
    Register,
    Sign,
    Unused,
    Variant,
    Verdict,
    cite,
    number_from_bytes,
)
from ..model.only import fits
from ..model.record import dataclass
from ..say import fault
from ..say.report import alarm_of, meaning, remedy, source
from .codec import Decoded, DecodedField, number_of_text


@dataclass(frozen=True, slots=True)
class Report:
    """An active flag, or unused bits that differ from the manual. ``makes_position`` is None without a position."""

    field: str
    printed_name: str
    meaning: str
    remedy: str
    makes_position: Verdict | None
    source: str


@dataclass(frozen=True, slots=True)
class Difference:
    """A value that differs from the manual. ``of_register`` is true if it is in a register."""

    field: str
    found: int | str
    documented: int | str
    message: str
    of_register: bool


@dataclass(frozen=True, slots=True)
class Findings:
    """Findings in a frame or register. ``verdict`` is None without a position or for an invalid frame."""

    reports: tuple[Report, ...] = ()
    verdict: Verdict | None = None
    differences: tuple[Difference, ...] = ()


def findings(device: Device, variant: Variant, decoded: Decoded) -> Findings:
    """Return the findings in ``decoded``. An invalid frame has no findings, since none of its bits can be trusted."""
    if decoded.problems or decoded.layout is None or decoded.layout.layout.sender == "master":
        return Findings()
    layout = decoded.layout.layout
    values = {item.name: item for item in decoded.fields}
    active = [item.field for item in decoded.layout.fields if _speaks(item, values[item.name])]
    if layout.sender == "encoder":
        active += [sign.flag for sign in layout.signs if _is_active(sign, layout, values)]
    register = "" if layout.sender == "encoder" else decoded.layout.name
    found = {item.name: alarm_of(device, item, register) for item in active}
    alarms = {
        name: item if item is not None and fits(item.only, variant.code) else None for name, item in found.items()
    }
    # A flag in a register may mean anything, such as "ready". Only flags that the manual lists as alarms are reported.
    told = [
        item
        for item in active
        if (alarms[item.name] is not None if register else _worth(item.kind) is not Verdict.USABLE)
    ]
    differences = tuple(_differences(variant, decoded, values, bool(register)))
    verdict = _verdict(layout, active) if device.tells_position(variant.interface, layout) else None
    return Findings(tuple(_report(item, alarms[item.name]) for item in told), verdict, differences)


def _speaks(item: PlacedField, found: DecodedField) -> bool:
    """Return whether a flag is active or unused bits differ from the manual."""
    match item.field.kind:
        case Flag():
            return bool(found.value)
        case Unused(value):
            return found.raw != value & item.mask
        case _:
            return False


def _is_active(sign: Sign, layout: Layout, values: Mapping[str, DecodedField]) -> bool:
    """Return whether all fields of a sign have their values."""
    return all(
        name in values and values[name].value == _decoded(layout.field(name), number)
        for name, number in sign.conditions
    )


def _decoded(field: Field, number: int) -> str | bool:
    """Return the decoded value of a flag or of a field with named values."""
    if isinstance(field.kind, Flag):
        return bool(number)
    return next(item.name for item in field.values if item.value == number)


def _worth(kind: Kind) -> Verdict | None:
    return kind.makes_position if isinstance(kind, (Flag, Unused)) else None


def _report(field: Field, alarm: Alarm | None) -> Report:
    return Report(
        field.name,
        field.printed_name,
        meaning(field, alarm),
        remedy(field, alarm),
        _worth(field.kind),
        cite(source(field, alarm)),
    )


def _verdict(layout: Layout, active: Sequence[Field]) -> Verdict:
    """Return the verdict on the position of a valid frame."""
    names = {item.name for item in active}
    # A flag that combines others adds no information if one of them is active.
    silent = {item.name for item in active if isinstance(item.kind, Flag) and not names.isdisjoint(item.kind.sums_up)}
    speaking = [_worth(item.kind) for item in active if item.name not in silent]
    speaking.append(Verdict.USABLE if layout.tells_validity else Verdict.UNKNOWN)
    return next(verdict for verdict in Verdict if verdict in speaking)


def _differences(
    variant: Variant, decoded: Decoded, values: Mapping[str, DecodedField], of_register: bool
) -> Iterator[Difference]:
    assert decoded.layout is not None
    for item in decoded.layout.fields:
        documented = item.field.documented(variant.parameters)
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
        return fault.other_content(name, has, variant.code, wanted)
    return fault.other_value(name, has, wanted)


def _shown(value: int | str) -> str:
    return f'"{value}"' if isinstance(value, str) else f"{value:#04x}"


def _fixed(device: Device, variant: Variant) -> Iterator[Register]:
    """Yield the registers that identify this order code, except those in banks, whose addresses are not unique."""
    names = {register.name for register, _ in device.identity if register.bank is None}
    return (item for item in device.registers_over(variant.interface) if item.name in names)


def fixed_addresses(device: Device, variant: Variant) -> frozenset[int]:
    """Return the addresses of the registers that identify this order code."""
    registers = _fixed(device, variant)
    return frozenset(address for item in registers for address in range(item.address, item.last_address + 1))


def compare_held(device: Device, variant: Variant, held: Mapping[int, int]) -> tuple[Difference, ...]:
    """Return the registers whose contents contradict this order code. Addresses not in ``held`` are unknown."""
    return tuple(item for register in _fixed(device, variant) for item in _compare_register(variant, register, held))


def _compare_register(variant: Variant, register: Register, held: Mapping[int, int]) -> Iterator[Difference]:
    placed = register.layout.place(variant.parameters)
    addresses = range(register.address, register.last_address + 1)
    number = number_from_bytes(register.layout, bytes(held.get(address, 0) for address in addresses))
    given = number_from_bytes(register.layout, bytes(0xFF * (address in held) for address in addresses))
    for item in placed.fields:
        documented = item.field.documented(variant.parameters)
        if documented is None:
            continue
        wanted = documented
        if isinstance(wanted, str):
            wanted = number_of_text(wanted)
        known = given >> item.low & item.mask
        found = number >> item.low & known
        if found != wanted & known:
            where = f"{register.name}.{item.name}" if len(placed.fields) > 1 else register.name
            given_digits, wanted_digits = _digits(found, known, item), _digits(wanted, known, item)
            wrong = f"{where}: the given part is {given_digits}, {variant.code} has {wanted_digits}"
            if known == item.mask:
                wrong = fault.other_content(where, f"{found:#04x}", variant.code, f"{wanted:#04x}")
            yield Difference(where, found, wanted, wrong, True)


def _digits(value: int, known: int, item: PlacedField) -> str:
    """Return the hexadecimal digits of a field, with dots for unknown digits."""
    shifts = range((item.width - 1) // 4 * 4, -1, -4)
    return "".join(f"{value >> shift & 15:X}" if known >> shift & 15 else "." for shift in shifts) + "h"
