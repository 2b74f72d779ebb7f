"""Checks for a layout with placed fields: lengths, values that cannot occur, joined numbers and parity bits."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import pairwise

from ..model import (
    INTERFACES,
    Biss,
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Field,
    Flag,
    Join,
    Kind,
    Layout,
    Number,
    Parity,
    Spi,
    Text,
    Unused,
    assert_never,
)
from ..model.expressions import Expression
from .bit_coverage import condition_text
from .fields import SpecPlace, check_byte_orders
from .frame_rules import check_crc, check_one_crc


def check_joined(layout: Layout, spec_place: SpecPlace, low_byte_first: bool) -> None:
    """Check the joined numbers, parity bits and Gray code of a layout.

    A joined number consists of several fields. In a bit frame with the low byte first, joined numbers are the only way
    to put the bytes of a number in order.
    """
    sends_low_byte_first = low_byte_first and not layout.in_bytes
    joins_with_problems = _check_joins(layout, spec_place, sends_low_byte_first)
    if sends_low_byte_first:
        _check_bytes(layout, spec_place)
    _check_parities(layout, spec_place)
    if layout.gray_of and layout.gray_of not in joins_with_problems:
        _check_gray(layout, spec_place)


def _check_joins(layout: Layout, spec_place: SpecPlace, sends_low_byte_first: bool) -> set[str]:
    """Check all joined numbers of a layout, and return the names of those with a problem.

    A joined number consists of plain bits, and contains each field once. In a bit frame, its fields are listed in
    transmission order, or in reverse order if ``sends_low_byte_first`` is true.
    """
    field_by_name = {field.name: field for field in layout.fields}
    joins_with_problems: set[str] = set()
    for join in layout.joins:
        problem_count_before = len(spec_place.context.report)
        _check_parts_of_join(join, field_by_name, spec_place)
        # Bytes may be sent in any order, but the bits of a word are sent from the highest to the lowest.
        if not layout.in_bytes:
            _check_order_of_join(join, field_by_name, layout, spec_place, sends_low_byte_first)
        if len(spec_place.context.report) > problem_count_before:
            joins_with_problems.add(join.name)
    return joins_with_problems


def _check_parts_of_join(join: Join, field_by_name: Mapping[str, Field], spec_place: SpecPlace) -> None:
    """Check that a joined number consists of plain bits, and contains each field once."""
    for index, name in enumerate(join.fields):
        if name in join.fields[:index]:
            spec_place.report("join-order", f"'{join.name}' contains '{name}' twice", "join", join.name, index)
            continue
        reason = _obstacle_to_join(field_by_name[name].kind) if name in field_by_name else ""
        if reason:
            # A reason may already end with a remedy after a semicolon.
            separator = ", or" if ";" in reason else ";"
            remedy = f"{separator} remove '{name}' from '{join.name}'"
            spec_place.report("join-of", f"'{join.name}' contains '{name}', {reason}{remedy}", "join", join.name, index)


def _check_order_of_join(
    join: Join, field_by_name: Mapping[str, Field], layout: Layout, spec_place: SpecPlace, sends_low_byte_first: bool
) -> None:
    """Check that each field of a joined number is sent before the next one, or after it with the low byte first.

    A field that is sent earlier has higher bits in the layout.
    """
    different_neighbors = []
    for upper, lower in pairwise(join.fields):
        if upper != lower and upper in field_by_name and lower in field_by_name:
            different_neighbors.append((upper, lower))
    for pair_number, (upper, lower) in enumerate(different_neighbors, 1):
        lower_if_correct, upper_if_correct = (upper, lower) if sends_low_byte_first else (lower, upper)
        if _is_above(field_by_name[lower_if_correct], field_by_name[upper_if_correct], spec_place):
            problem = f"'{join.name}' has '{upper}' above '{lower}'"
            remedy = _remedy_for_order(sends_low_byte_first, spec_place)
            message = f"{problem}, but '{layout.name}' sends '{lower_if_correct}' first{remedy}"
            spec_place.report("join-order", message, "join", join.name, pair_number)


def _remedy_for_order(sends_low_byte_first: bool, spec_place: SpecPlace) -> str:
    """Return the end of the message about joined fields in the wrong order."""
    if sends_low_byte_first:
        return ", and the low byte of each number comes first"
    if spec_place.interface == Spi.name:
        return "; list the more significant part first, or write 'byte_order: low_byte_first' if it is sent last"
    return ", as the more significant bits"


def _check_bytes(layout: Layout, spec_place: SpecPlace) -> None:
    """Check that no field of a word that is sent with the low byte first has more than 8 bits.

    A wider number must be described as several fields, one for each byte.
    """
    for field in layout.fields:
        # Byte order has no effect on unused bits and zeros.
        has_byte_order = not isinstance(field.kind, Unused) and not _is_zeros(field.kind)
        if has_byte_order and field.widest > 8:
            message = f"'{field.name}' has {field.widest} bits, but the low byte of each number comes first"
            spec_place.report(
                "join-order", f"{message}; describe each byte as a field, and join them", "fields", field.name
            )


def _is_zeros(kind: Kind) -> bool:
    """Return whether a field of this kind always consists of zeros."""
    return isinstance(kind, Constant) and kind.value == 0


def _check_parities(layout: Layout, spec_place: SpecPlace) -> None:
    """Check that parity bits cover each field at most once, and no computed field: a CRC or another parity bit."""
    field_by_name = {field.name: field for field in layout.fields}
    for field in layout.fields:
        if not isinstance(field.kind, Parity):
            continue
        covered_names = field.kind.covers
        for index, name in enumerate(covered_names):
            is_computed = name in field_by_name and field_by_name[name].kind.role == "check"
            if name in covered_names[:index]:
                problem = f"'{field.name}' covers '{name}' twice; list it once"
                spec_place.report("parity-of", problem, "fields", field.name, "parity_of")
            elif is_computed:
                problem = f"the parity bit '{field.name}' cannot cover '{name}', which is computed itself"
                spec_place.report("parity-of", f"{problem}; leave it out", "fields", field.name, "parity_of")
        # The bits of a field count from 0, so only a field with at least two bits has a bit with an odd number.
        covers_odd_bits = any(field_by_name[name].widest > 1 for name in covered_names if name in field_by_name)
        if field.kind.over == "odd_bits" and not covers_odd_bits:
            problem = f"'{field.name}' covers no bit, because no covered field has a bit 1; write 'over: even_bits'"
            spec_place.report("parity-of", problem, "fields", field.name, "parity_of")


def _obstacle_to_join(kind: Kind) -> str:
    """Return the reason a joined number cannot contain a field of this kind, or "" if it can.

    A joined number consists of bits as they are sent, so a field that converts its bits would contradict it. A remedy
    may follow the reason after a semicolon: ``which is signed; remove 'signed'``.
    """
    if kind.is_joinable:
        return ""
    if isinstance(kind, Flag):
        return "which is active low"
    if not isinstance(kind, Number):
        return "which is not a number; define it with 'bits' and no kind"
    # A number differs from its bits for only three reasons.
    if kind.digit_code:
        return "whose digits are sent separately; remove 'digit_code'"
    if kind.signed:
        return "which is signed; remove 'signed'"
    return "which has 'zero_means'; remove 'zero_means'"


def _check_gray(layout: Layout, spec_place: SpecPlace) -> None:
    """Check that a number in Gray code consists of several adjacent bits.

    The bits can include a flag. Also check that the parameter ``gray_when``, which turns Gray code on, is 0 or 1 for
    all order codes.
    """
    coded_names = layout.field_names_of(layout.gray_of)
    field_by_name = {field.name: field for field in layout.fields}
    coded_fields = [field_by_name[name] for name in coded_names if name in field_by_name]
    fields_without_number = [field for field in coded_fields if not isinstance(field.kind, (Number, Choice, Flag))]
    problem = ""
    if fields_without_number:
        problem = f"'{fields_without_number[0].name}' is not a number"
    elif len(coded_fields) == 1 and coded_fields[0].widest == 1:
        problem = f"'{coded_fields[0].name}' has one bit"
    if problem:
        spec_place.report("gray-of", f"{problem}; only a multi-bit number can be in Gray code", "gray", "of")
    parameter_sets = spec_place.parameter_sets
    switch_values = {parameters[layout.gray_when] for parameters in parameter_sets if layout.gray_when in parameters}
    if not switch_values <= {0, 1}:
        message = f"'{layout.gray_when}' can be {max(switch_values)}; it must be 1 for Gray code, or 0 for binary"
        spec_place.report("gray-of", message, "gray", "when")
    # Without such a parameter, the number is always in Gray code.
    sets_with_gray_code = [parameters for parameters in parameter_sets if parameters.get(layout.gray_when, 1)]
    for upper_field, lower_field in pairwise(coded_fields):
        if not _are_adjacent(upper_field, lower_field, sets_with_gray_code):
            message = (
                f"'{upper_field.name}' and '{lower_field.name}' are not adjacent; a number in Gray code must be"
                " contiguous, most significant part first"
            )
            spec_place.report("gray-of", message, "gray", "of")
            return


def _are_adjacent(above: Field, below: Field, parameter_sets: Iterable[Mapping[str, int]]) -> bool:
    """Return whether the field above begins where the field below ends, with the parameters of each order code."""
    end_below = below.low + below.width
    return all(end_below.value(parameters) == above.low.value(parameters) for parameters in parameter_sets)


def _is_above(upper: Field, lower: Field, spec_place: SpecPlace) -> bool:
    """Return whether ``upper`` is above ``lower`` for an order code that has both fields."""
    for parameters in spec_place.parameter_sets:
        has_both = upper.width.value(parameters) and lower.width.value(parameters)
        if has_both and upper.low.value(parameters) > lower.low.value(parameters):
            return True
    return False


#: Width of the numbers in the generated C.
LARGEST_NUMBER = 64
#: Maximum number of bits of a digit that is sent separately, such as 4 in BCD.
WIDEST_DIGIT = 8
#: Width up to which frames of whole bytes are tested.
LARGEST_BYTES = 128


def check_layout(layout: Layout, spec_place: SpecPlace, low_byte_first: bool) -> bool:
    """Return whether a layout is valid with the parameters of every order code, and report why if it is not.

    ``spec_place`` is the place of the layout in the spec. ``low_byte_first`` is true if the spec says so there.
    """
    problem_count_before = len(spec_place.context.report)
    _check_length(layout, spec_place)
    for field in layout.fields:
        _check_field(layout, field, replace(spec_place, path=(*spec_place.path, "fields", field.name)))
    check_byte_orders(layout, spec_place)
    check_one_crc(layout, spec_place)
    _check_selected_values(layout, spec_place)
    if layout.unused and "unused" in layout.member_names:
        message = "decoded frames use the name 'unused' for all unused bits; rename the field"
        spec_place.report("duplicate-name", message, "fields", "unused")
    check_joined(layout, spec_place, low_byte_first)
    return len(spec_place.context.report) == problem_count_before


def _check_length(layout: Layout, spec_place: SpecPlace) -> None:
    """Check the number of bits in a layout: whole bytes if it is carried as bytes, and not more than the maximum."""
    # A register is not sent by itself, so the limits for frames do not apply to it.
    is_sent_as_bits = INTERFACES[spec_place.interface].carried_as == "bits" and spec_place.path[0] == "interfaces"
    if layout.in_bytes and (not layout.bits.is_constant or layout.bits.constant % 8):
        message = f"'{layout.name}' has {layout.bits.render()} bits, not a whole number of bytes"
        if is_sent_as_bits and not layout.bits.is_constant:
            message = (
                f"'{layout.name}' has {layout.bits.render()} bits; a frame that is carried as bytes has one length"
            )
        spec_place.report("width-mismatch", message)
    if not layout.in_bytes and layout.widest > LARGEST_NUMBER:
        message = f"'{layout.name}' has {layout.widest} bits; the maximum is {LARGEST_NUMBER}"
        if layout.widest <= LARGEST_BYTES and spec_place.interface != Spi.name:
            message += _remedy_for_long_frames(layout)
        spec_place.report("too-long", message)
    if layout.in_bytes and is_sent_as_bits and layout.widest > LARGEST_BYTES:
        sent_bits = layout.sent_bits.constant
        spec_place.report("too-long", f"'{layout.name}' has {sent_bits} bits; the maximum is {LARGEST_BYTES}")


def _check_selected_values(layout: Layout, spec_place: SpecPlace) -> None:
    """Check that the values that select a layout exist in its selector, the field that distinguishes frames."""
    selector = next((field for field in layout.fields if field.name == layout.selector), None)
    named_numbers = [value.value for value in selector.values] if selector is not None else []
    for selecting_value in layout.selects:
        # A selector without named values can have any number.
        if named_numbers and selecting_value not in named_numbers:
            spec_place.report("undefined-reference", f"'{layout.selector}' has no value {selecting_value}", "when")


def _remedy_for_long_frames(layout: Layout) -> str:
    """Return the end of the message about a bit frame that is too long.

    A longer frame can be carried as bytes instead of one number if its length is the same for all order codes.
    """
    if layout.bits.is_constant:
        return f", or {LARGEST_BYTES} with 'carried_as: bytes'"
    condition = "if the frame has the same length for all order codes"
    remedy = "write the order codes of each length in a separate spec"
    return f", or {LARGEST_BYTES} with 'carried_as: bytes' {condition}; {remedy}"


def _check_field(layout: Layout, field: Field, spec_place: SpecPlace) -> None:
    """Check the width, the kind and the code of a field. Only texts and filling zeros can have more than 64 bits."""
    kind = field.kind
    bit_count = field.widest
    is_filled_with_zeros = field.padding_of or field.fills_gap or field.fills_byte
    if bit_count > LARGEST_NUMBER and not isinstance(kind, Text) and not is_filled_with_zeros:
        spec_place.report("too-long", f"'{field.name}' has {bit_count} bits; the maximum is {LARGEST_NUMBER}")
    _check_kind(layout, field, spec_place)
    if kind.digit_code:
        _check_digits(layout, field, spec_place)


def _check_kind(layout: Layout, field: Field, spec_place: SpecPlace) -> None:
    """Check a field by its kind, regardless of its code and its maximum width."""
    kind = field.kind
    match kind:
        case Number():
            _check_number(field, kind, spec_place)
        case Flag():
            _check_one_bit(field, "flag", spec_place)
        case Parity():
            _check_one_bit(field, "parity bit", spec_place)
        case Choice():
            _check_choice(field, kind, spec_place)
        case Constant() | Unused():
            _check_fixed(field, kind, spec_place)
        case Decimal():
            _check_decimal(field, kind, spec_place)
        case Text():
            _check_text(field, spec_place)
        case CrcValue():
            check_crc(layout, field, kind, spec_place)
        case _:
            assert_never(kind)


def _check_number(field: Field, number: Number, spec_place: SpecPlace) -> None:
    """Check that a power of two has bits for every order code, because a number without bits is 0."""
    if number.power_of_two:
        _check_absent(field, "0 is not a power of two; remove 'power_of_two'", spec_place)


def _check_digits(layout: Layout, field: Field, spec_place: SpecPlace) -> None:
    """Check that a field whose digits are sent separately is in a frame that can have them."""
    problem = _problem_of_digits(layout, field, spec_place)
    if problem:
        spec_place.report("digit-code", f"'{field.name}' {problem}", "digit_code")


def _problem_of_digits(layout: Layout, field: Field, spec_place: SpecPlace) -> str:
    """Return the reason the decimal digits of a field cannot be sent separately, with a fix, or "" if they can."""
    fix = "leave 'digit_code' out, and convert the number in your program"
    if spec_place.is_in_register or spec_place.interface == Biss.name:
        return f"is in a register or over BiSS, where numbers are binary; {fix}"
    if field.name in layout.field_names_of(layout.gray_of):
        return "has 'digit_code' and is also covered by 'gray'; remove one of them"
    if field.name == layout.selector:
        return f"distinguishes frames by its bits; {fix}"
    if not field.width.is_constant:
        return f"consists of digits, so 'bits' must be a number, not {field.width.render()}"
    if layout.widest > LARGEST_NUMBER:
        return f"is in a frame of {layout.widest} bits, and the maximum for digits is {LARGEST_NUMBER}; {fix}"
    digit_code = field.code_of_digits
    assert digit_code is not None
    bit_count_of_codes = digit_code.bits * len(digit_code.codes)
    # Generated C has all codes in one number, and NumPy code looks up one byte for each digit.
    if digit_code.bits > WIDEST_DIGIT or bit_count_of_codes > LARGEST_NUMBER:
        return f"has {len(digit_code.codes)} codes of {digit_code.bits} bits, more than decoders have room for; {fix}"
    if digit_code.highest(field.widest) < 0:
        return f"has {field.widest} bits, so its first digit has too few bits for {digit_code.name}; change 'bits'"
    return ""


def _check_decimal(field: Field, decimal: Decimal, spec_place: SpecPlace) -> None:
    """Check that every decimal number with these digits fits into the bits of the field."""
    if decimal.limit > 1 << field.widest:
        spec_place.report("value-too-wide", f"{decimal.digits} decimal digits do not fit into {field.widest} bits")


def _check_text(field: Field, spec_place: SpecPlace) -> None:
    """Check that a text field has whole bytes, and as many as its documented text ``equals`` has characters."""
    fills_bits = not isinstance(field.equals, str) or 8 * len(field.equals) == field.widest
    if field.widest % 8 or not fills_bits:
        spec_place.report("width-mismatch", f"the text of '{field.name}' does not fill its {field.widest} bits")


def _check_one_bit(field: Field, kind_text: str, spec_place: SpecPlace) -> None:
    """Check that a flag or parity bit has exactly one bit, or, in a frame, no bit for some order codes."""
    subject = f"'{field.name}' is a {kind_text}"
    if field.width.is_constant:
        if field.width != Expression(1):
            spec_place.report("width-mismatch", f"{subject}, so it must have one bit, not {field.widest}")
        return
    if spec_place.is_in_register:
        message = (
            f"{subject} in a register, so it has one bit for all order codes, but 'bits' is {field.width.render()}"
        )
        spec_place.report("width-mismatch", f"{message}; remove 'bits'")
        return
    for parameters in spec_place.parameter_sets:
        bit_count = field.width.value(parameters)
        if bit_count > 1:
            message = (
                f"{subject}, so it has one bit or none, but it has {bit_count}{condition_text(parameters, field.width)}"
            )
            spec_place.report("width-mismatch", f"{message}; use a parameter that is 0 or 1")
            return
    if field.widest == 0:
        message = f"'{field.name}' has no bits, because '{field.width.render()}' is 0 for all order codes"
        remedy = "remove the field, or give the parameter 1 where it is sent, or 'max: 1' if it is read from a register"
        spec_place.report("width-mismatch", f"{message}; {remedy}")


def _check_choice(field: Field, choice: Choice, spec_place: SpecPlace) -> None:
    """Check that all named values fit into the field. If an order code lacks the field, one of them must be 0."""
    # If the width is constant, the rules on the text have already checked it.
    if not field.width.is_constant:
        for named_value in choice.values:
            has_too_many_bits = named_value.value >> field.widest != 0
            if has_too_many_bits:
                message = (
                    f"the value '{named_value.name}' = {named_value.value:#x} does not fit into {field.widest} bits"
                )
                spec_place.report("value-too-wide", message)
    has_zero = any(named_value.value == 0 for named_value in choice.values)
    if not has_zero:
        _check_absent(field, "none of its values is 0; add one", spec_place)


def _check_fixed(field: Field, fixed: Constant | Unused, spec_place: SpecPlace) -> None:
    """Check that a constant, or the value of unused bits, fits into the field for all order codes that have it.

    If an order code lacks the field, a constant must be 0.
    """
    widths = [field.width.value(parameters) for parameters in spec_place.parameter_sets]
    # An order code with a width of 0 does not have the field.
    narrowest_width = min((width for width in widths if width), default=field.widest)
    if not field.width.is_constant and fixed.value >> narrowest_width:
        key = "unused" if isinstance(fixed, Unused) else "constant"
        noun = "bits" if narrowest_width > 1 else "bit"
        message = f"'{key}' is {fixed.value:#x}, which does not fit into {narrowest_width} {noun}"
        spec_place.report("value-too-wide", message)
    if isinstance(fixed, Constant) and fixed.value:
        _check_absent(field, f"'constant' is {fixed.value:#x}; use 0, or a constant width", spec_place)


def _check_absent(field: Field, reason: str, spec_place: SpecPlace) -> None:
    """Report a field that has no bits for an order code, although its kind does not allow 0.

    A field without bits reads as 0, so all frames of this order code would be rejected. ``reason`` says why 0 is not
    allowed.
    """
    for parameters in spec_place.parameter_sets:
        if field.width.value(parameters) == 0:
            parameter_texts = ", ".join(f"{name} = {parameters[name]}" for name in field.width.parameters)
            message = f"'{field.name}' has no bits with {parameter_texts} and reads as 0, but {reason}"
            spec_place.report("value-too-wide", message)
            return
