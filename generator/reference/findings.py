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
from ..order_codes.editions import edition_before, tests_of
from ..order_codes.labels import LabelMatch
from ..say import frame_texts
from ..say.commands_and_alarms import alarm_of, alarm_source, meaning, remedy
from ..say.frame_texts import older_edition_message
from .bits import bits_of_field
from .codec import DecodedField, DecodedFrame, number_of_text
from .codec import decode as decode_word


@dataclass(frozen=True, slots=True)
class FrameReport:
    """An active flag, or unused bits that differ from the manual. ``makes_position`` is None without a position."""

    field: str
    printed_name: str
    meaning: str
    remedy: str
    makes_position: Verdict | None
    source: str


@dataclass(frozen=True, slots=True)
class ValueDifference:
    """A value that differs from the manual. ``is_register`` is true if it is in a register."""

    field: str
    actual: int | str
    documented: int | str
    message: str
    is_register: bool


@dataclass(frozen=True, slots=True)
class Findings:
    """Findings in a frame or register. ``verdict`` is None without a position or for an invalid frame."""

    reports: tuple[FrameReport, ...] = ()
    verdict: Verdict | None = None
    differences: tuple[ValueDifference, ...] = ()


def findings(device: Device, variant: Variant, decoded: DecodedFrame) -> Findings:
    """Return the findings in a decoded frame or register: reports, the verdict, and differences from the manual.

    They are empty for an invalid frame, since none of its bits can be trusted, and for a frame that the master sends.
    """
    if decoded.problems or decoded.layout is None:
        return Findings()
    layout = decoded.layout.layout
    if layout.sender == "master":
        return Findings()
    is_register = layout.sender != "encoder"
    decoded_fields = {field.name: field for field in decoded.fields}
    active_fields = _active_fields(decoded.layout, decoded_fields)
    if is_register:
        reports = _reports_of_register(device, variant, active_fields, layout.name)
    else:
        reports = _reports_of_frame(device, variant, active_fields)
    differences = _find_differences(variant, decoded, decoded_fields, is_register)
    verdict = None
    if device.has_verdict(variant.interface, layout):
        verdict = _find_worst_verdict(decoded.layout, active_fields)
    return Findings(reports=tuple(reports), verdict=verdict, differences=tuple(differences))


def _active_fields(placed_layout: PlacedLayout, decoded_fields: Mapping[str, DecodedField]) -> list[Field]:
    """Return the active flags, and the unused bits that differ from the manual.

    Some frames have signs: combinations of values that decide the verdict like a flag. If all values of a sign match,
    its flag, which has no bits, is active as well.
    """
    active_fields: list[Field] = []
    for placed_field in placed_layout.fields:
        if _is_active_field(placed_field, decoded_fields[placed_field.name]):
            active_fields.append(placed_field.field)
    if placed_layout.layout.sender == "encoder":
        layout = placed_layout.layout
        active_signs = [sign for sign in layout.signs if _is_active_sign(sign, layout, decoded_fields)]
        active_fields += [sign.flag for sign in active_signs]
    return active_fields


def _reports_of_frame(device: Device, variant: Variant, active_fields: Sequence[Field]) -> Iterator[FrameReport]:
    """Yield a report for each active flag or unused field, except those with which the position remains usable."""
    for field in active_fields:
        leaves_position_usable = field.kind.makes_position is Verdict.USABLE
        if not leaves_position_usable:
            yield _build_report(field, _alarm_for(device, variant, field, register=""))


def _reports_of_register(
    device: Device, variant: Variant, active_fields: Sequence[Field], register: str
) -> Iterator[FrameReport]:
    """Yield a report for each active flag that the manual describes as an alarm.

    Other flags of a register are not reported, because they may mean "ready", for example.
    """
    for field in active_fields:
        alarm = _alarm_for(device, variant, field, register)
        if alarm is not None:
            yield _build_report(field, alarm)


def _alarm_for(device: Device, variant: Variant, field: Field, register: str) -> Alarm | None:
    """Return the alarm that the manual describes for a flag, or None if there is none for this order code.

    ``register`` is the name of the register with the flag, or empty for a flag in a frame.
    """
    alarm = alarm_of(device, field, register)
    if alarm is None:
        return None
    applies_to_order_code = fits(alarm.only, variant.code)
    return alarm if applies_to_order_code else None


def _is_active_field(placed_field: PlacedField, decoded_field: DecodedField) -> bool:
    """Return whether a flag is active, or unused bits differ from the manual. Return false for all other fields."""
    match placed_field.field.kind:
        case Flag():
            return bool(decoded_field.value)
        case Unused(value):
            # The documented value may have more bits than the field has in this order code.
            return decoded_field.raw != value & placed_field.mask
        case _:
            return False


def _is_active_sign(sign: Sign, layout: Layout, decoded_fields: Mapping[str, DecodedField]) -> bool:
    """Return whether all fields of a sign, a combination of values that decides the verdict, have these values."""
    for name, required_number in sign.conditions:
        if name not in decoded_fields:
            return False
        required_value = _decoded_value(layout.field(name), required_number)
        if decoded_fields[name].value != required_value:
            return False
    return True


def _decoded_value(field: Field, number: int) -> str | bool:
    """Return the decoded form of a number: true or false for a flag, or the name of a named value."""
    if isinstance(field.kind, Flag):
        return bool(number)
    return field.value_of(number).name


def _build_report(field: Field, alarm: Alarm | None) -> FrameReport:
    """Return the report of an active field, with the texts of its alarm, if any."""
    return FrameReport(
        field=field.name,
        printed_name=field.printed_name,
        meaning=meaning(field, alarm),
        remedy=remedy(field, alarm),
        makes_position=field.kind.makes_position,
        source=cite(alarm_source(field, alarm)),
    )


def _find_worst_verdict(placed_layout: PlacedLayout, active_fields: Sequence[Field]) -> Verdict:
    """Return the worst verdict to which the active flags and unused bits of a frame lead.

    If none of them leads to a verdict, the position is USABLE. It is UNKNOWN if the frame has no bits that say whether
    the position is usable.
    """
    active_names = {field.name for field in active_fields}
    verdicts = [Verdict.USABLE if placed_layout.judges_position else Verdict.UNKNOWN]
    for field in active_fields:
        # A flag that combines others, listed in ``sums_up``, adds no information while one of them is active.
        is_redundant = isinstance(field.kind, Flag) and not active_names.isdisjoint(field.kind.sums_up)
        verdict = field.kind.makes_position
        if verdict is not None and not is_redundant:
            verdicts.append(verdict)
    from_worst_to_best = list(Verdict)  # in the order of their definition
    return min(verdicts, key=from_worst_to_best.index)


def _find_differences(
    variant: Variant, decoded: DecodedFrame, decoded_fields: Mapping[str, DecodedField], is_register: bool
) -> Iterator[ValueDifference]:
    """Yield the fields whose value differs from the value that the manual gives for this order code.

    ``is_register`` is true if ``decoded`` is a register. Then the messages name the order code.
    """
    assert decoded.layout is not None
    for placed_field in decoded.layout.fields:
        documented = placed_field.field.documented(variant.parameters)
        if documented is None:
            continue
        decoded_field = decoded_fields[placed_field.name]
        # A documented string is a text or the name of a value. A number equals the number formed by the bits.
        actual = decoded_field.value if isinstance(documented, str) else decoded_field.raw
        if actual == documented:
            continue
        name = placed_field.field.printed_name or placed_field.name
        actual_text, documented_text = _quoted_or_hex(actual), _quoted_or_hex(documented)
        if is_register:
            message = frame_texts.undocumented_content_message(name, actual_text, variant.code, documented_text)
        else:
            message = frame_texts.undocumented_value_message(name, actual_text, documented_text)
        yield ValueDifference(
            field=placed_field.name,
            actual=actual,
            documented=documented,
            message=message,
            is_register=is_register,
        )


def _quoted_or_hex(field_value: int | str) -> str:
    """Return a text in double quotes, or a number in hexadecimal, such as ``0x2a``."""
    return f'"{field_value}"' if isinstance(field_value, str) else f"{field_value:#04x}"


def _identity_registers(device: Device, variant: Variant) -> Iterator[Register]:
    """Yield the registers whose documented contents identify the encoder, such as the device ID.

    Registers in banks are omitted, because their addresses are not unique.
    """
    names = {register.name for register, _ in device.identity if register.bank is None}
    return (register for register in device.registers_over(variant.interface) if register.name in names)


def fixed_addresses(device: Device, variant: Variant) -> frozenset[int]:
    """Return the addresses of the registers whose documented contents identify an encoder with this order code."""
    addresses: set[int] = set()
    for register in _identity_registers(device, variant):
        addresses.update(_list_addresses(register))
    return frozenset(addresses)


def _list_addresses(register: Register) -> range:
    """Return the addresses of all bytes of a register."""
    return range(register.address, register.last_address + 1)


def compare_held(device: Device, variant: Variant, bytes_by_address: Mapping[int, int]) -> tuple[ValueDifference, ...]:
    """Return the fields of identifying registers whose contents show that the encoder has a different order code.

    Registers that ``bytes_by_address`` does not contain are unknown, and are not compared.
    """
    differences: list[ValueDifference] = []
    for register in _identity_registers(device, variant):
        differences += _compare_register(variant, register, bytes_by_address)
    return tuple(differences)


def _compare_register(
    variant: Variant, register: Register, bytes_by_address: Mapping[int, int]
) -> Iterator[ValueDifference]:
    """Yield the fields of a register whose known bits differ from the values that the manual gives for an order code.

    Bytes that ``bytes_by_address`` lacks are unknown. The message shows the field in hexadecimal, with a dot for each
    unknown digit.
    """
    placed_layout = register.layout.place(variant.parameters)
    addresses = _list_addresses(register)
    register_bytes = bytes(bytes_by_address.get(address, 0) for address in addresses)
    masks_of_bytes = bytearray()  # 0xFF for each byte that is known.
    for address in addresses:
        masks_of_bytes.append(0xFF if address in bytes_by_address else 0)
    content = number_from_bytes(register.layout, register_bytes)
    known_mask = number_from_bytes(register.layout, bytes(masks_of_bytes))
    for placed_field in placed_layout.fields:
        documented = placed_field.field.documented(variant.parameters)
        if documented is None:
            continue
        documented_bits = number_of_text(documented) if isinstance(documented, str) else documented
        known_bits = bits_of_field(placed_field, known_mask)
        actual_bits = bits_of_field(placed_field, content) & known_bits
        matches_documentation = actual_bits == documented_bits & known_bits
        if matches_documentation:
            continue
        path = f"{register.name}.{placed_field.name}" if len(placed_layout.fields) > 1 else register.name
        is_completely_known = known_bits == placed_field.mask
        if is_completely_known:
            message = frame_texts.undocumented_content_message(
                path, f"{actual_bits:#04x}", variant.code, f"{documented_bits:#04x}"
            )
        else:
            actual_digits = _known_digits(actual_bits, known_bits, placed_field.width)
            documented_digits = _known_digits(documented_bits, known_bits, placed_field.width)
            message = f"{path}: the given part is {actual_digits}, {variant.code} has {documented_digits}"
        yield ValueDifference(path, actual=actual_bits, documented=documented_bits, message=message, is_register=True)


def _known_digits(field_bits: int, known_bits: int, width: int) -> str:
    """Return the hexadecimal digits of a field with ``width`` bits, with dots for unknown digits, such as ``..A3h``.

    The bits of the field that are known are 1 in ``known_bits``. A digit is known if all of its bits are known.
    """
    text = ""
    all_bits = (1 << width) - 1
    highest_digit_shift = (width - 1) // 4 * 4  # A digit is 4 bits. The highest digit may have fewer.
    for shift in range(highest_digit_shift, -1, -4):
        bits_of_digit = (all_bits >> shift) & 0xF
        known_bits_of_digit = (known_bits >> shift) & bits_of_digit
        digit = (field_bits >> shift) & 0xF
        text += f"{digit:X}" if known_bits_of_digit == bits_of_digit else "."
    return text + "h"


def strange_values(device: Device, decoded: DecodedFrame) -> Iterator[ValueDifference]:
    """Yield values of a register that show that an older edition of the manual applies to the encoder.

    An edition has tests: a register field, ``run``, whose value must be from ``min`` to ``max`` in encoders of this
    edition. Frames have no such tests.
    """
    is_register = decoded.layout is not None and not decoded.layout.layout.sender
    if decoded.layout is None or not is_register:
        return
    register = decoded.layout.name
    number_by_field = {field.name: field.raw for field in decoded.fields}
    for revision, test in tests_of(device, register):
        number = number_by_field.get(test.run)
        if number is None or test.min <= number <= test.max:
            continue
        bounds = f"{test.min} to {test.max}"
        message = older_edition_message(
            run=test.run,
            actual=f"{number}",
            bounds=bounds,
            revision=revision,
            register=register,
            before=edition_before(device, revision),
        )
        yield ValueDifference(test.run, actual=number, documented=bounds, message=message, is_register=True)


def edition_by_registers(device: Device, match: LabelMatch, bytes_by_address: Mapping[int, int]) -> str:
    """Return the revision of the latest edition of the manual that is compatible with the registers of an encoder.

    An edition has tests: a register field, ``run``, whose value must be from ``min`` to ``max`` in encoders of this
    edition. The result is the revision before the first edition with a failed test, or the revision of the spec if no
    test fails.

    Raises:
        ValueError: ``bytes_by_address`` has no complete register that identifies the edition.
    """
    has_register = False
    for edition in device.editions:
        for test in edition.tests:
            register = device.register(test.register)
            addresses = _list_addresses(register)
            is_complete = bytes_by_address.keys() >= set(addresses)
            if not is_complete:
                continue
            has_register = True
            register_bytes = bytes(bytes_by_address[address] for address in addresses)
            content = number_from_bytes(register.layout, register_bytes)
            placed_layout = register.layout.place(match.variant.parameters)
            decoded_register = decode_word(device, placed_layout, content)
            tested_field = member_named(decoded_register.fields, test.run, f"field of '{register.name}'")
            if not test.min <= tested_field.raw <= test.max:
                return edition_before(device, edition.revision)
    if not has_register:
        raise ValueError(_missing_registers_message(device))
    return device.manual.revision


def without_tests(device: Device, bytes_by_address: Mapping[int, int]) -> dict[int, int]:
    """Return the register bytes by address, without the bytes of registers that identify the edition of the manual."""
    edition_addresses: set[int] = set()
    for name in _names_of_edition_registers(device):
        edition_addresses.update(_list_addresses(device.register(name)))
    return {address: value for address, value in bytes_by_address.items() if address not in edition_addresses}


def _names_of_edition_registers(device: Device) -> list[str]:
    """Return the names of the registers whose values identify the edition of the manual, without duplicates."""
    names = (test.register for edition in device.editions for test in edition.tests)
    return list(dict.fromkeys(names))


def _missing_registers_message(device: Device) -> str:
    """Return the message that lists the command-line options for the registers that identify the edition.

    The options for a register of two bytes are, for example, ``--register 0x10=0x.. --register 0x11=0x..``.
    """
    names = _names_of_edition_registers(device)
    if not names:
        return f"no register of {device.name} identifies the edition"
    options_by_register = []
    for name in names:
        addresses = _list_addresses(device.register(name))
        options = [f"--register 0x{address:02X}=0x.." for address in addresses]
        options_by_register.append(" ".join(options))
    names_text = " or ".join(names)
    options_text = "; or ".join(options_by_register)
    return f"to infer the edition, give all of {names_text}: {options_text}"
