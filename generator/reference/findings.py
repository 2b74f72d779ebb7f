"""Findings in a frame or register: reports, the verdict, strange values, and the edition that applies.

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
    PlacedLayout,
    Register,
    Sign,
    Unused,
    Variant,
    Verdict,
    cite,
    member_named,
    number_from_bytes,
)
from ..model.order_codes import fits
from ..model.record import dataclass
from ..order_codes.labels import Match, edition_before, tests_of
from ..say import report
from ..say.report import alarm_of, meaning, of_older_edition, remedy, source
from .codec import Decoded, DecodedField, number_of_text
from .codec import decode as decode_word


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
    """A value that differs from the manual. ``is_register`` is true if it is in a register."""

    field: str
    actual: int | str
    documented: int | str
    message: str
    is_register: bool


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
    values = {field.name: field for field in decoded.fields}
    is_frame = layout.sender == "encoder"
    active_fields = []
    for placed_field in decoded.layout.fields:
        if _is_active_field(placed_field, values[placed_field.name]):
            active_fields.append(placed_field.field)
    if is_frame:
        active_fields += [sign.flag for sign in layout.signs if _is_active(sign, layout, values)]
    reports = []
    for field in active_fields:
        alarm = _alarm_for(device, variant, field, register="" if is_frame else layout.name)
        # In a register, a flag may mean anything, such as "ready": only the alarms of the manual are reported.
        is_reported = _verdict_of_kind(field.kind) is not Verdict.USABLE if is_frame else alarm is not None
        if is_reported:
            reports.append(_report(field, alarm))
    differences = _differences(variant, decoded, values, is_register=not is_frame)
    verdict = _verdict(decoded.layout, active_fields) if device.tells_position(variant.interface, layout) else None
    return Findings(tuple(reports), verdict, tuple(differences))


def _alarm_for(device: Device, variant: Variant, field: Field, register: str) -> Alarm | None:
    """Return the alarm of a flag if it applies to the order code."""
    alarm = alarm_of(device, field, register)
    return alarm if alarm is not None and fits(alarm.only, variant.code) else None


def _is_active_field(placed_field: PlacedField, decoded_field: DecodedField) -> bool:
    """Return whether a flag is active or unused bits differ from the manual."""
    match placed_field.field.kind:
        case Flag():
            return bool(decoded_field.value)
        case Unused(value):
            return decoded_field.raw != value & placed_field.mask
        case _:
            return False


def _is_active(sign: Sign, layout: Layout, values: Mapping[str, DecodedField]) -> bool:
    """Return whether all fields of a sign have their values."""
    for name, number in sign.conditions:
        if name not in values or values[name].value != _decoded(layout.field(name), number):
            return False
    return True


def _decoded(field: Field, number: int) -> str | bool:
    """Return the decoded value of a flag or of a field with named values."""
    if isinstance(field.kind, Flag):
        return bool(number)
    return field.value_of(number).name


def _verdict_of_kind(kind: Kind) -> Verdict | None:
    return kind.makes_position if isinstance(kind, (Flag, Unused)) else None


def _report(field: Field, alarm: Alarm | None) -> Report:
    return Report(
        field.name,
        field.printed_name,
        meaning(field, alarm),
        remedy(field, alarm),
        _verdict_of_kind(field.kind),
        cite(source(field, alarm)),
    )


def _verdict(placed: PlacedLayout, active: Sequence[Field]) -> Verdict:
    """Return the verdict on the position of a valid frame."""
    names = {field.name for field in active}
    # A flag that combines others adds no information if one of them is active.
    flags = {field.name: field.kind for field in active if isinstance(field.kind, Flag)}
    silent_names = {name for name, flag in flags.items() if not names.isdisjoint(flag.sums_up)}
    verdicts = [_verdict_of_kind(field.kind) for field in active if field.name not in silent_names]
    verdicts.append(Verdict.USABLE if placed.tells_validity else Verdict.UNKNOWN)
    return min(filter(None, verdicts), key=list(Verdict).index)


def _differences(
    variant: Variant, decoded: Decoded, values: Mapping[str, DecodedField], is_register: bool
) -> Iterator[Difference]:
    assert decoded.layout is not None
    for placed_field in decoded.layout.fields:
        documented = placed_field.field.documented(variant.parameters)
        if documented is None:
            continue
        actual = values[placed_field.name].value if isinstance(documented, str) else values[placed_field.name].raw
        if actual != documented:
            name = placed_field.field.printed_name or placed_field.name
            message = _message(name, variant, actual, documented, is_register)
            yield Difference(placed_field.name, actual, documented, message, is_register)


def _message(name: str, variant: Variant, actual: int | str, documented: int | str, is_register: bool) -> str:
    actual_text, documented_text = _value_text(actual), _value_text(documented)
    if is_register:
        return report.other_content(name, actual_text, variant.code, documented_text)
    return report.other_value(name, actual_text, documented_text)


def _value_text(value: int | str) -> str:
    return f'"{value}"' if isinstance(value, str) else f"{value:#04x}"


def _identity_registers(device: Device, variant: Variant) -> Iterator[Register]:
    """Yield the registers that identify this order code, except those in banks, whose addresses are not unique."""
    names = {register.name for register, _ in device.identity if register.bank is None}
    return (register for register in device.registers_over(variant.interface) if register.name in names)


def fixed_addresses(device: Device, variant: Variant) -> frozenset[int]:
    """Return the addresses of the registers that identify this order code."""
    addresses: set[int] = set()
    for register in _identity_registers(device, variant):
        addresses.update(range(register.address, register.last_address + 1))
    return frozenset(addresses)


def compare_held(device: Device, variant: Variant, bytes_by_address: Mapping[int, int]) -> tuple[Difference, ...]:
    """Return the registers whose contents contradict this order code. Other addresses are unknown."""
    differences: list[Difference] = []
    for register in _identity_registers(device, variant):
        differences += _compare_register(variant, register, bytes_by_address)
    return tuple(differences)


def _compare_register(
    variant: Variant, register: Register, bytes_by_address: Mapping[int, int]
) -> Iterator[Difference]:
    placed = register.layout.place(variant.parameters)
    addresses = range(register.address, register.last_address + 1)
    number = number_from_bytes(register.layout, bytes(bytes_by_address.get(address, 0) for address in addresses))
    read_bits = number_from_bytes(register.layout, bytes(0xFF * (address in bytes_by_address) for address in addresses))
    for placed_field in placed.fields:
        documented = placed_field.field.documented(variant.parameters)
        if documented is None:
            continue
        documented_bits = documented
        if isinstance(documented_bits, str):
            documented_bits = number_of_text(documented_bits)
        known_bits = read_bits >> placed_field.low & placed_field.mask
        actual_bits = number >> placed_field.low & known_bits
        if actual_bits != documented_bits & known_bits:
            place = f"{register.name}.{placed_field.name}" if len(placed.fields) > 1 else register.name
            actual_digits, documented_digits = (
                _digits(actual_bits, known_bits, placed_field),
                _digits(documented_bits, known_bits, placed_field),
            )
            message = f"{place}: the given part is {actual_digits}, {variant.code} has {documented_digits}"
            if known_bits == placed_field.mask:
                message = report.other_content(place, f"{actual_bits:#04x}", variant.code, f"{documented_bits:#04x}")
            yield Difference(place, actual_bits, documented_bits, message, True)


def _digits(value: int, known_bits: int, placed_field: PlacedField) -> str:
    """Return the hexadecimal digits of a field, with dots for unknown digits."""
    digits = ""
    for shift in range((placed_field.width - 1) // 4 * 4, -1, -4):
        is_known = known_bits >> shift & 15 != 0
        digits += f"{value >> shift & 15:X}" if is_known else "."
    return digits + "h"


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
