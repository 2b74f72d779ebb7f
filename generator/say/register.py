"""Statements about a register, about a field of a frame or register, and about the unit and range of a position."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import (
    BankSelect,
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Device,
    Digits,
    Field,
    Flag,
    LayoutRange,
    Measurement,
    Number,
    Parity,
    Register,
    RegisterMeaning,
    Text,
    Unused,
    Value,
    Verdict,
    assert_never,
    first_of,
)
from ..model.expressions import Expression
from .commands import remedied
from .errata import errata, erratum, needed_answers
from .names_and_places import Named, hexadecimal, own_names, printed, register_at, register_field
from .names_and_places import register as named
from .plain_text import formula
from .text import WORTH, Amount, Code, Hex, Level, Part, Ref, Statement, listed, parted, spec_text, statement

_ACCESS = {"read_only": "read only", "read_write": "read and write", "write_only": "write only"}
#: Phrases for registers and fields that only one party may use.
USERS = {"maker": "manufacturer"}
_ABOVE_MAX = {
    "default": "The encoder replaces a value above the limit with the default",
    "refused": "The encoder rejects a value above the limit",
}


def access(register: Register) -> str:
    return _ACCESS[register.access]


def head(device: Device, register: Register, name: Part) -> Statement:
    """Return the register's ``name``, address, access and interface."""
    interface = device.interface(register.interface).title
    return statement(name, f", {register_at(register)}, {access(register)}, over {interface}", source=register.source)


def register(device: Device, device_register: Register) -> Iterator[Statement]:
    """Yield all statements that follow the head in running text."""
    yield from spec_text(device_register.meaning)
    yield from facts(device, device_register)
    yield from spec_text(device_register.note)
    yield from map(erratum, errata(device, f"registers.{device_register.name}"))


def facts(device: Device, register: Register) -> Iterator[Statement]:
    """Yield its content and the rules for reading and writing it."""
    yield from _holds(register)
    yield from needed_answers(device, register.layout)
    yield from _rules(device, register)
    yield from (_meaning(device, meaning) for meaning in register.meanings)


def _holds(register: Register) -> Iterator[Statement]:
    if register.last_address > register.address:
        lowest = "low" if register.byte_order == "low_byte_first" else "high"
        yield statement(f"{lowest} byte first, at {hexadecimal(register.address)}", label="Byte order")
    data = register.default_bytes()
    if data is not None:
        yield statement(Code(data.hex(" ").upper()), label="Default")
    if not register.meanings and (register.min is not None or register.max is not None):
        field_text = () if register.limits_of == register.name else (" for ", Code(register.limits_of))
        yield statement(*limits(register.min, register.max), *field_text, label="Limits")


def limits(low: Expression | None, high: Expression | None) -> tuple[Part, ...]:
    """Return a range, or an empty tuple without limits."""
    if low is not None and high is not None:
        return low, " to ", high
    if low is not None:
        return "at least ", low
    return ("at most ", high) if high is not None else ()


def _rules(device: Device, register: Register) -> Iterator[Statement]:
    yield from _same_address(device, register)
    if register.bank is not None:
        facts = device.interface(register.interface).facts()
        bank_selects = (fact for fact in facts if isinstance(fact, BankSelect))
        select = first_of(bank_selects, f"register that selects the bank of '{register.name}'").register
        yield statement(f"First select bank {register.bank} with ", named(device, select))
    if register.reserved:
        yield reserved(register.reserved)
    if register.opened_by:
        yield _opening_condition(device, register)
    if register.wait_at_least_ms is not None:
        yield statement(f"Wait at least {register.wait_at_least_ms} ms between a write and the next command")
    if register.clears_itself:
        yield statement("Automatically returns to its default after a write")
    if register.volatile:
        yield statement("Save the parameters after a write, or the encoder loses the value at power-off")
    if register.above_max:
        yield statement(_ABOVE_MAX[register.above_max])
    if register.write_clears:
        yield statement("A write sets ", *listed([named(device, name) for name in register.write_clears]), " to zero")


def reserved(user: str) -> Statement:
    return statement(f"Reserved for the {USERS[user]}")


def _same_address(device: Device, register: Register) -> Iterator[Statement]:
    """Yield the other register at the same address, which differs only in the direction of access."""
    for other_register in device.registers:
        if other_register is not register and (other_register.address, other_register.bank) == (
            register.address,
            register.bank,
        ):
            action = "Writing to" if other_register.access == "write_only" else "Reading"
            yield statement(f"{action} the same address accesses ", named(device, other_register.name), " instead")


def _opening_condition(device: Device, register: Register) -> Statement:
    """Return the value that another register must hold before this one can be written."""
    opener = device.register(register.opened_by)
    path = ".".join(filter(None, (register.opened_by, register.opened_by_field)))
    field = opener.layout.field(register.opened_by_field) if register.opened_by_field else opener.layout.fields[0]
    value = field.value_named(register.opened_by_value).value
    value_text = f"{value}" if register.opened_by_field else hexadecimal(value, 2 * opener.length)
    field_reference = register_field(device, path)
    return statement(
        "Can be written only while ", field_reference, f" is {value_text} (", Code(register.opened_by_value), ")"
    )


def _meaning(device: Device, meaning: RegisterMeaning) -> Statement:
    """Return one meaning of a register and the field value that selects it."""
    path, _, field = meaning.when.partition(".")
    bit = device.register(path).layout.field(field)
    value = bit.value_named(meaning.value).value
    field_reference = register_field(device, meaning.when)
    condition = ("While ", field_reference, f" is {value} (", Code(meaning.value), "), the register holds ")
    span = limits(meaning.min, meaning.max)
    meaning_text = f": {meaning.meaning}" if meaning.meaning else ""
    return statement(
        *condition, Code(meaning.name), *((", ", *span) if span else ()), meaning_text, source=meaning.source
    )


def field(device: Device, frame_field: Field) -> Iterator[Statement]:
    """Yield all statements about it in order, for running text."""
    yield from meaning(frame_field, frame_field.meaning)
    yield from rules(device, frame_field)
    yield from spec_text(frame_field.note)


def meaning(named_item: Named, text: str) -> Iterator[Statement]:
    """Yield the meaning, labelled with the name used in the manual."""
    yield from spec_text(text, label=printed(named_item)) if text else spec_text(printed(named_item))


def rules(device: Device, frame_field: Field) -> Iterator[Statement]:
    """Yield the interpretation of its bits and the rules for its use."""
    yield from spec_text(frame_field.unit, label="Unit")
    if frame_field.scale is not None:
        yield statement(
            formula(frame_field.scale), label=f"In {frame_field.scale.unit}", source=frame_field.scale.source
        )
    yield from _kind(device, frame_field)
    if frame_field.container:
        yield statement(f"Right-aligned in {frame_field.container} bits, with zeros above it")
    if not frame_field.implemented and "not implemented" not in frame_field.meaning.lower():
        yield statement("Not implemented in this encoder")
    if frame_field.reserved:
        yield reserved(frame_field.reserved)
    if frame_field.equals is not None:
        expected = _expected_value(frame_field.equals, frame_field.widest)
        yield statement("Holds ", expected, ", which identifies the encoder. The decoder also accepts other values")
    if frame_field.default is not None:
        yield statement(Expression(frame_field.default), label="Default")
    if frame_field.explained_by:
        yield statement(
            "For the reason, see ", *listed([register_field(device, path) for path in frame_field.explained_by])
        )
    yield from remedied(frame_field.remedy, frame_field.by_hand)


def _kind(device: Device, frame_field: Field) -> Iterator[Statement]:
    match frame_field.kind:
        case Number() as kind:
            yield from _number(kind)
        case Flag() as kind:
            yield from _flag(kind, frame_field.implemented)
        case Choice():
            pass  # Each value has its own statement.
        case Constant(value):
            yield from spec_text("" if "always" in frame_field.meaning.lower() else f"Always {short(value)}")
        case Unused() as unused:
            yield from _unused(device, frame_field, unused)
        case CrcValue(crc, covered_names):
            names = parted((Code(name),) for name in covered_names)
            yield statement(
                "CRC ", Ref("crc", crc, crc), " over ", *(names if covered_names else ("everything before it",))
            )
        case Parity() as parity:
            covered = parted((Code(name),) for name in parity.covers)
            bits = f"the {parity.over.replace('_', ' ')} of " if parity.over else ""
            yield statement("Odd" if parity.is_odd else "Even", f" parity of {bits}", *covered)
        case Decimal(runs):
            yield statement("Decimal digits, most significant first: ", *parted(map(_run, runs)))
        case Text():
            yield statement("ASCII text")
        case _ as kind:
            assert_never(kind)


def _unused(device: Device, frame_field: Field, unused: Unused) -> Iterator[Statement]:
    yield statement(f"Unused, documented as {short(unused.value)}")
    if _comes_with_position(device, frame_field):
        yield statement(
            "Frames with other values are still decoded, with the verdict ", Code(unused.makes_position.value)
        )
    else:
        yield statement("Other values are still decoded")


def _comes_with_position(device: Device, frame_field: Field) -> bool:
    """Return whether any frame contains both the field and the position."""
    frames = [(kind, layout) for kind, layout in device.layouts() if frame_field in layout.fields]
    return any(device.tells_position(kind.name, layout) for kind, layout in frames)


def _number(kind: Number) -> Iterator[Statement]:
    if kind.signed:
        yield statement("Signed, in two's complement")
    if kind.zero_means:
        yield statement("A value of 0 means ", Expression(kind.zero_means))
    if kind.power_of_two:
        yield statement("Only powers of two are allowed")


def _flag(kind: Flag, implemented: bool) -> Iterator[Statement]:
    active, inactive = (0, 1) if kind.active_low else (1, 0)
    if implemented or kind.when_active or kind.when_inactive:
        yield statement(Level.ACTIVE, f" when {active}", f": {kind.when_active}" if kind.when_active else "")
        if kind.when_inactive:
            yield statement(Level.INACTIVE, f" when {inactive}: {kind.when_inactive}")
    if kind.sums_up:
        yield statement("Combines ", *listed(list(map(Code, kind.sums_up))))
    if kind.makes_position is Verdict.USABLE and implemented:
        yield statement("It does not affect the position")
    elif kind.makes_position and implemented:
        exception = ". If a flag that it combines is active in the same frame, that flag decides instead"
        yield statement(
            "While it is ", Level.WHILE_ACTIVE, f", {WORTH[kind.makes_position]}{exception if kind.sums_up else ''}"
        )
    if kind.verdict_if_set is not None and implemented:
        yield statement("If you set ", Code(kind.verdict_parameter), f" to 1, {WORTH[kind.verdict_if_set]}")
    if kind.only:
        other_verdict = kind.unexplained.makes_position
        verdict_text = f", and {WORTH[other_verdict]}" if other_verdict is not None else ""
        remark = f". For other order codes the manual does not explain the flag{verdict_text}"
        yield statement("This applies only to ", Code(kind.only), remark)


def _run(run: Digits) -> tuple[Part, ...]:
    return Code(run.name), f" {run.digits}", f" ({run.meaning})" if run.meaning else ""


def _expected_value(value: Expression | int | str, bits: int) -> Part:
    if isinstance(value, str):
        return Code(value)
    return Hex(value if isinstance(value, Expression) else Expression(value), (bits + 3) // 4)


def choices(values: tuple[Value, ...]) -> Statement:
    """Return all named values in one statement."""
    return statement(
        *parted((f"{short(named_value.value)} ", Code(named_value.name)) for named_value in values), label="Values"
    )


def value(named_value: Value, bits: int) -> Statement:
    """Return a named value of a field of ``bits`` bits."""
    manual_names = f" ({own_names(named_value)})" if own_names(named_value) else ""
    meaning_text = f": {named_value.meaning}" if named_value.meaning else ""
    number = f"{hexadecimal(named_value.value, (bits + 3) // 4)} "
    return statement(
        number, Code(named_value.name), manual_names, meaning_text, effect(named_value), source=named_value.source
    )


def effect(named_value: Value) -> str:
    """Return the verdict of a named value on the position as the end of a statement, or an empty string."""
    return f" ({WORTH[named_value.makes_position]})" if named_value.makes_position is not None else ""


def short(number: int) -> str:
    """Return a number below 10 in decimal, and any other number in the hexadecimal notation of manuals."""
    return f"{number}" if number < 10 else f"{number:X}h"


def measurement(unit_and_range: Measurement) -> Statement:
    """Return the counts and revolutions, or the step, and the range."""
    members = (
        (unit_and_range.counts_per_turn, "counts", " per revolution"),
        (unit_and_range.turns, "revolutions", ""),
        (unit_and_range.step_um, "µm", " per count"),
        (unit_and_range.step_nm, "nm", " per count" if unit_and_range.per_counts is None else " per "),
        (unit_and_range.modulus, "counts", " in total"),
    )
    amounts: list[tuple[Part, ...]] = []
    for value, unit, words in members:
        if value is not None:
            amounts.append((Amount(value, unit), words, *_counts(unit_and_range, unit)))
    highest = [("maximum ", unit_and_range.highest)] if unit_and_range.highest is not None else []
    return statement(*parted([*amounts, *highest]), source=unit_and_range.source)


def _counts(unit_and_range: Measurement, unit: str) -> tuple[Amount, ...]:
    """Return the number of counts to which a length in this unit applies, if it is not one."""
    return (
        (Amount(unit_and_range.per_counts, "counts"),) if unit == "nm" and unit_and_range.per_counts is not None else ()
    )


def position_range(layout_range: LayoutRange) -> Statement:
    """Return the range of the position in one layout."""
    if not layout_range.wraps:
        return statement("never wraps around", source=layout_range.source)
    members = ((layout_range.turns, "revolutions", ""), (layout_range.modulus, "counts", " in total"))
    amounts: list[tuple[Part, ...]] = []
    for value, unit, words in members:
        if value is not None:
            amounts.append((Amount(value, unit), words))
    highest = [("maximum ", layout_range.highest)] if layout_range.highest is not None else []
    return statement(*parted([*amounts, *highest]), source=layout_range.source)


def own_ranges(device: Device, interface: str) -> Iterator[tuple[str, LayoutRange]]:
    """Yield the layouts of an interface in which the position has another range, with that range."""
    for layout in device.interface(interface).layouts:
        if layout.position_range is not None:
            yield layout.name, layout.position_range
