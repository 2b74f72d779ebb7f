"""Statements about registers, and about fields of frames and registers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

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
    Number,
    Parity,
    Register,
    RegisterMeaning,
    Text,
    Unused,
    Value,
    Verdict,
    assert_never,
    first_or_raise,
)
from ..model.expressions import Expression
from . import formula
from .commands_and_alarms import describe_remedy
from .errata import describe_erratum, errata_affecting, needed_answers
from .names_and_evidence import (
    HasOtherNames,
    hexadecimal,
    own_names,
    printed_name_of,
    register_at,
    register_field,
    short_number,
)
from .names_and_evidence import register_reference as reference_to_register
from .text import (
    VERDICT_CLAUSES,
    CodeText,
    Hex,
    Level,
    Reference,
    Statement,
    TextPart,
    join_groups,
    list_parts,
    spec_text,
    statement,
)

_ACCESS_IN_WORDS = {"read_only": "read-only", "read_write": "read and write", "write_only": "write-only"}
#: Words for the only party that may use a reserved register or field.
USERS = {"maker": "manufacturer"}
_ABOVE_MAX = {
    "default": "The encoder replaces a value above the limit with the default",
    "refused": "The encoder rejects a value above the limit",
}


def describe_access(register: Register) -> str:
    """Return whether a register can be read, written or both, such as ``read-only``."""
    return _ACCESS_IN_WORDS[register.access]


def describe_head(device: Device, register: Register, name: TextPart) -> Statement:
    """Return the register's ``name``, address, access and interface: ``command, register 77h, write-only, over …``."""
    interface_title = device.interface(register.interface).title
    access = describe_access(register)
    return statement(name, f", {register_at(register)}, {access}, over {interface_title}", source=register.source)


def describe_register(device: Device, register: Register) -> Iterator[Statement]:
    """Yield all statements about a register except its name, address and access."""
    yield from spec_text(register.meaning)
    yield from describe_register_facts(device, register)
    yield from spec_text(register.note)
    yield from map(describe_erratum, errata_affecting(device, f"registers.{register.name}"))


def describe_register_facts(device: Device, register: Register) -> Iterator[Statement]:
    """Yield what a register contains, the rules for reading and writing it, and its meaning in each mode, if any."""
    yield from _content_facts(register)
    yield from needed_answers(device, register.layout)
    yield from _access_rules(device, register)
    yield from (_register_meaning(device, register_meaning) for register_meaning in register.meanings)


def _content_facts(register: Register) -> Iterator[Statement]:
    """Yield the byte order of a register that has several bytes, its default, and its limits, as far as known."""
    if register.last_address > register.address:
        byte_at_lowest_address = "low" if register.byte_order == "low_byte_first" else "high"
        order_text = f"{byte_at_lowest_address} byte first, at {hexadecimal(register.address)}"
        yield statement(order_text, label="Byte order")
    default = register.default_bytes()
    if default is not None:
        yield statement(CodeText(default.hex(" ").upper()), label="Default")
    has_limits = register.min is not None or register.max is not None
    # If a register has several meanings, each has limits of its own.
    if has_limits and not register.meanings:
        range_parts = describe_range(register.min, register.max)
        # The limits can apply to a single field.
        if register.limits_of != register.name:
            range_parts = (*range_parts, " for ", CodeText(register.limits_of))
        yield statement(*range_parts, label="Limits")


def describe_range(lowest: Expression | None, highest: Expression | None) -> tuple[TextPart, ...]:
    """Return a range as parts of a statement: ``(0, " to ", 7)`` or ``("at least ", 0)``. None means no limit."""
    if lowest is not None and highest is not None:
        return lowest, " to ", highest
    if lowest is not None:
        return "at least ", lowest
    if highest is not None:
        return "at most ", highest
    return ()


def _access_rules(device: Device, register: Register) -> Iterator[Statement]:
    """Yield the rules for reading and writing a register: what to do before and after, and what a write changes."""
    yield from _registers_at_same_address(device, register)
    if register.bank is not None:
        facts_of_interface = device.interface(register.interface).facts()
        bank_selects = (fact for fact in facts_of_interface if isinstance(fact, BankSelect))
        bank_select = first_or_raise(bank_selects, f"register that selects the bank of '{register.name}'")
        yield statement(f"First select bank {register.bank} with ", reference_to_register(device, bank_select.register))
    if register.reserved:
        yield describe_reserved_bits(register.reserved)
    if register.opened_by:
        yield _opening_condition(device, register)
    if register.wait_at_least_ms is not None:
        yield statement(f"Wait at least {register.wait_at_least_ms} ms between a write and the next command")
    if register.clears_itself:
        yield statement("After a write, the register returns to its default automatically")
    if register.volatile:
        yield statement("Save the parameters after a write, or the encoder loses the value at power-off")
    if register.above_max:
        yield statement(_ABOVE_MAX[register.above_max])
    if register.write_clears:
        cleared_registers = [reference_to_register(device, name) for name in register.write_clears]
        yield statement("A write sets ", *list_parts(cleared_registers), " to zero")


def describe_reserved_bits(user: str) -> Statement:
    """Return who may use a reserved register or field. ``user`` is a key of ``USERS``."""
    return statement(f"Reserved for the {USERS[user]}")


def _registers_at_same_address(device: Device, register: Register) -> Iterator[Statement]:
    """Yield a statement for each other register that reading or writing the same address and bank accesses instead."""
    for other_register in device.registers:
        if other_register is register:
            continue
        if (other_register.address, other_register.bank) == (register.address, register.bank):
            action = "Writing to" if other_register.access == "write_only" else "Reading"
            other_reference = reference_to_register(device, other_register.name)
            yield statement(f"{action} the same address accesses ", other_reference, " instead")


def _opening_condition(device: Device, register: Register) -> Statement:
    """Return the condition for writing a register: the value that another register, or one of its fields, must hold."""
    opening_register = device.register(register.opened_by)
    value_name = register.opened_by_value
    if register.opened_by_field:
        opening_path = f"{register.opened_by}.{register.opened_by_field}"
        opening_field = opening_register.layout.field(register.opened_by_field)
        opening_value = opening_field.value_named(value_name).value
        value_text = f"{opening_value}"
    else:
        # Without a field, the value is the value of the whole register.
        opening_path = register.opened_by
        opening_field = opening_register.layout.fields[0]
        opening_value = opening_field.value_named(value_name).value
        value_text = hexadecimal(opening_value, digits=2 * opening_register.length)
    opening_reference = register_field(device, opening_path)
    condition_parts: list[TextPart] = [opening_reference, f" is {value_text} (", CodeText(value_name), ")"]
    return statement("The register can be written only while ", *condition_parts)


def _register_meaning(device: Device, meaning: RegisterMeaning) -> Statement:
    """Return one of several meanings of a register, the field value that selects this meaning, and its limits.

    ``meaning.when`` is the path of the selecting field, such as ``mode.output``, and ``meaning.value`` the name of its
    value.
    """
    register_name, _, field_name = meaning.when.partition(".")
    selecting_field = device.register(register_name).layout.field(field_name)
    selecting_value = selecting_field.value_named(meaning.value).value
    selecting_reference = register_field(device, meaning.when)
    meaning_parts: list[TextPart] = ["While ", selecting_reference, f" is {selecting_value} (", CodeText(meaning.value)]
    meaning_parts += ["), the register holds ", CodeText(meaning.name)]
    range_parts = describe_range(meaning.min, meaning.max)
    if range_parts:
        meaning_parts += [", ", *range_parts]
    if meaning.meaning:
        meaning_parts.append(f". {meaning.meaning}")
    return statement(*meaning_parts, source=meaning.source)


def describe_field(device: Device, field: Field) -> Iterator[Statement]:
    """Yield all statements about a field of a frame or register: its meaning, its rules and its note."""
    yield from describe_meaning(field, field.meaning)
    yield from describe_field_rules(device, field)
    yield from spec_text(field.note)


def describe_meaning(named_item: HasOtherNames, text: str) -> Iterator[Statement]:
    """Yield the meaning ``text`` with the manual's name of the item as its label, or only this name if it is empty."""
    manual_name = printed_name_of(named_item)
    if text:
        yield statement(text, label=manual_name)
    elif manual_name:
        yield statement(manual_name)


def describe_field_rules(device: Device, field: Field) -> Iterator[Statement]:
    """Yield how to interpret the bits of a field, its default, and the rules for its use."""
    yield from spec_text(field.unit, label="Unit")
    scale = field.scale
    if scale is not None:
        yield statement(formula(scale), label=f"In {scale.unit}", source=scale.source)
    yield from _rules_of_kind(device, field)
    yield from _code_rule(field)
    if field.byte_order:
        yield statement(f"Sent {field.byte_order.replace('_', ' ')}")
    if field.container:
        width_text = f"{field.width.constant} bits, right-aligned" if field.width.is_constant else "Right-aligned"
        yield statement(f"{width_text} in {field.container} bits, with leading zeros")
    if not field.implemented and "not implemented" not in field.meaning.lower():
        yield statement("Not implemented in this encoder")
    if field.reserved:
        yield describe_reserved_bits(field.reserved)
    if field.equals is not None:
        expected = _expected_value(field.equals, field.widest)
        yield statement("The value ", expected, " helps to identify the encoder. The decoder also accepts other values")
    if field.default is not None:
        yield statement(Expression(field.default), label="Default")
    if field.explained_by:
        explaining_fields = [register_field(device, field_path) for field_path in field.explained_by]
        yield statement("For the reason, see ", *list_parts(explaining_fields))
    yield from describe_remedy(field.remedy, field.by_hand)


def _rules_of_kind(device: Device, field: Field) -> Iterator[Statement]:
    """Yield how to interpret the bits of a field, depending on its kind: a number, a flag, a constant and so on."""
    match field.kind:
        case Number() as number:
            yield from _number_rules(number)
        case Flag() as flag:
            yield from _flag_rules(device, flag, is_implemented=field.implemented)
        case Choice():
            pass  # Each value has its own statement.
        case Constant(value):
            yield from _constant_rule(field, value)
        case Unused() as unused:
            yield from _unused_rules(device, field, unused)
        case CrcValue() as crc:
            yield _covered_by_crc(crc)
        case Parity() as parity:
            yield _covered_by_parity(parity)
        case Decimal(runs):
            runs_of_digits = [_run_of_digits(run) for run in runs]
            yield statement("Decimal digits, most significant digit first: ", *join_groups(runs_of_digits))
        case Text():
            yield statement("ASCII text")
        case _ as kind:
            assert_never(kind)


def _constant_rule(field: Field, value: int) -> Iterator[Statement]:
    """Yield the value of a constant, unless the meaning of the field already says what it always is."""
    if "always" not in field.meaning.lower():
        yield statement(f"Always {short_number(value)}")


def _covered_by_crc(crc_value: CrcValue) -> Statement:
    """Return the CRC of a field, and the fields that it covers: ``CRC x24 over mode, position``."""
    covered_fields: list[TextPart] = _names_as_code(crc_value.of) if crc_value.of else ["everything before it"]
    crc_reference = Reference(kind="crc", name=crc_value.crc, title=crc_value.crc)
    return statement("CRC ", crc_reference, " over ", *covered_fields)


def covered_by_parity_bit(field: Field) -> Statement | None:
    """Return the fields that a parity bit covers, or None if the field is not a parity bit."""
    return _covered_by_parity(field.kind) if isinstance(field.kind, Parity) else None


def _covered_by_parity(parity: Parity) -> Statement:
    """Return the fields that a parity bit covers, such as ``Even parity of error, position``.

    If only some of their bits count, the statement says which: ``Odd parity of the even bits of position``.
    """
    polarity = "Odd" if parity.is_odd else "Even"
    counted_bits = f"the {parity.over.replace('_', ' ')} of " if parity.over else ""
    return statement(polarity, f" parity of {counted_bits}", *_names_as_code(parity.covers))


def _names_as_code(names: Iterable[str]) -> list[TextPart]:
    """Return the parts of a list of names, separated by commas."""
    return list(join_groups([CodeText(name)] for name in names))


def _unused_rules(device: Device, field: Field, unused: Unused) -> Iterator[Statement]:
    """Yield the documented value of unused bits, and what other values do to the verdict on the position."""
    yield statement(f"Unused, documented as {short_number(unused.value)}")
    if _is_in_frame_with_position(device, field):
        verdict = CodeText(unused.makes_position.value)
        yield statement("Frames with other values are still decoded, with the verdict ", verdict)
    else:
        yield statement("Other values are still decoded")


def _is_in_frame_with_position(device: Device, field: Field) -> bool:
    """Return whether a frame contains both this field and the position."""
    for interface, layout in device.layouts():
        if field in layout.fields and device.sends_position(interface.name, layout):
            return True
    return False


def _number_rules(number: Number) -> Iterator[Statement]:
    """Yield the properties of a number: its sign, the meaning of 0, a limitation to powers of two."""
    if number.signed:
        yield statement("Signed, in two's complement")
    if number.zero_means:
        yield statement("A value of 0 means ", Expression(number.zero_means))
    if number.power_of_two:
        yield statement("Only powers of two are allowed")


def _code_rule(field: Field) -> Iterator[Statement]:
    """Yield the code in which the digits of a field are sent, such as BCD, unless it is a binary number."""
    digit_code = field.code_of_digits
    if digit_code is None:
        return
    is_one_digit = digit_code.bits == field.widest
    size_text = "" if is_one_digit else f", {digit_code.bits} bits for each digit"
    yield statement(f"Sent in {digit_code.name}{size_text}")


def _flag_rules(device: Device, flag: Flag, *, is_implemented: bool) -> Iterator[Statement]:
    """Yield the levels of a flag, the other flags that it combines, and its verdict on the position.

    If the manual explains the flag only for some order codes, a statement on the other order codes follows.
    """
    yield from _flag_levels(flag, is_implemented=is_implemented)
    if flag.sums_up:
        yield statement("This flag combines ", *list_parts([CodeText(name) for name in flag.sums_up]))
    if is_implemented:
        yield from _flag_verdict(device, flag)
    if flag.only:
        remark_on_other_codes = ". For other order codes, the manual does not explain the flag"
        verdict_for_other_codes = flag.unexplained.makes_position
        if verdict_for_other_codes is not None:
            remark_on_other_codes += f". If it is active there, {VERDICT_CLAUSES[verdict_for_other_codes]}"
        yield statement("This applies only to ", CodeText(flag.only), remark_on_other_codes)


def _combines_other_verdicts(device: Device, flag: Flag) -> bool:
    """Return True if a flag that ``flag`` combines has a different verdict, so that it matters which one decides."""
    own_verdicts = {flag.makes_position, flag.verdict_if_set}
    all_fields = [field for _, layout in device.layouts() for field in layout.fields]
    for field in all_fields:
        if field.name in flag.sums_up and isinstance(field.kind, Flag):
            verdicts = {*own_verdicts, field.kind.makes_position}
            if len(verdicts - {None}) > 1:
                return True
    return False


def _flag_verdict(device: Device, flag: Flag) -> Iterator[Statement]:
    """Yield the verdict on the position while a flag is active, and the verdict if the user sets a parameter to 1."""
    if flag.makes_position is Verdict.USABLE:
        yield statement("It does not affect the position")
    elif flag.makes_position:
        verdict_text = f", {VERDICT_CLAUSES[flag.makes_position]}"
        if _combines_other_verdicts(device, flag):
            verdict_text += ". If a flag that it combines is active in the same frame, that flag decides instead"
        yield statement("While it is ", Level.WHILE_ACTIVE, verdict_text)
    if flag.verdict_if_set is not None:
        parameter = CodeText(flag.verdict_parameter)
        yield statement("If you set ", parameter, f" to 1, {VERDICT_CLAUSES[flag.verdict_if_set]}")


def _flag_levels(flag: Flag, *, is_implemented: bool) -> Iterator[Statement]:
    """Yield the meaning of each level of a flag, or nothing for a flag that is neither implemented nor explained."""
    has_meaning = bool(flag.when_active or flag.when_inactive)
    if not is_implemented and not has_meaning:
        return
    active_level, inactive_level = (0, 1) if flag.active_low else (1, 0)
    meaning_text = f": {flag.when_active}" if flag.when_active else ""
    yield statement(Level.ACTIVE, f" when {active_level}", meaning_text)
    if flag.when_inactive:
        yield statement(Level.INACTIVE, f" when {inactive_level}: {flag.when_inactive}")


def _run_of_digits(digit_run: Digits) -> tuple[TextPart, ...]:
    """Return the name of consecutive digits, their number, and their meaning: ``year 2 (year of manufacture)``."""
    meaning_text = f" ({digit_run.meaning})" if digit_run.meaning else ""
    return CodeText(digit_run.name), f" {digit_run.digits}", meaning_text


def _hex_digits_for(bit_count: int) -> int:
    """Return the number of hexadecimal digits for this many bits: one for each 4 bits, rounded up."""
    return (bit_count + 3) // 4


def _expected_value(stated_value: Expression | int | str, bit_count: int) -> TextPart:
    """Return the value that identifies an encoder in a field of ``bit_count`` bits, as text or in hexadecimal."""
    if isinstance(stated_value, str):
        return CodeText(stated_value)
    number = stated_value if isinstance(stated_value, Expression) else Expression(stated_value)
    return Hex(number, _hex_digits_for(bit_count))


def describe_choices(values: tuple[Value, ...]) -> Statement:
    """Return all named values in one statement, such as ``0 off, 1 on, 1Fh test``."""
    numbers_and_names = [(f"{short_number(named_value.value)} ", CodeText(named_value.name)) for named_value in values]
    return statement(*join_groups(numbers_and_names), label="Values")


def describe_value(named_value: Value, bit_count: int) -> Statement:
    """Return a named value of a field of ``bit_count`` bits: its number, names, meaning, verdict, ``1Fh test: …``."""
    manual_names = own_names(named_value)
    names_text = f" ({manual_names})" if manual_names else ""
    meaning_text = f": {named_value.meaning}" if named_value.meaning else ""
    number_text = hexadecimal(named_value.value, _hex_digits_for(bit_count))
    name_as_code = CodeText(named_value.name)
    return statement(
        f"{number_text} ",
        name_as_code,
        names_text,
        meaning_text,
        _verdict_in_parentheses(named_value),
        source=named_value.source,
    )


def _verdict_in_parentheses(named_value: Value) -> str:
    """Return the verdict on the position for a named value, in parentheses, or "" if the value has none."""
    return f" ({VERDICT_CLAUSES[named_value.makes_position]})" if named_value.makes_position is not None else ""
