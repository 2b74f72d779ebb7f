"""Find fields and options that are valid individually but not together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ..loading.position_rules import is_probably_highest
from ..model.expressions import is_power_of_two
from .fields import WIDEST
from .line import (
    IN_TURN,
    POSITION,
    TURNS,
    CrcField,
    FillerField,
    LineField,
    LineOptions,
    LineProblem,
    NumberField,
    ParityField,
)

#: Maximum number of bits of an RS-485 frame.
_MOST_BITS_OF_BYTES = 1024


def problems_of_fields(fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield the problems of fields that are valid individually but not together, such as two with the same name."""
    names: set[str] = set()
    for field in fields:
        if not isinstance(field, FillerField) and field.name in names:
            yield LineProblem(field.column, f"a second field has the name '{field.name}'; rename one of them")
        names.add(field.name)
        if isinstance(field, CrcField) and field is not fields[-1]:
            yield LineProblem(field.column, "the CRC must be the last field; move it to the end")
        if isinstance(field, CrcField) and interface == "rs485" and field.bits % 8:
            yield LineProblem(field.column, f"the CRC has {field.bits} bits; over RS-485, write whole bytes")
        has_changing_field = any(_can_change(other_field) for other_field in fields)
        if isinstance(field, ParityField) and not has_changing_field:
            yield LineProblem(field.column, "a parity bit needs other fields that change; add them")
    yield from _problems_of_position(fields, interface)
    yield from _problems_of_length(fields, interface)


def _can_change(field: LineField) -> bool:
    """Return whether a field can differ between frames, not counting CRCs and parity bits."""
    is_constant_number = isinstance(field, NumberField) and field.value is not None
    is_constant = is_constant_number or field.name == "zero"
    is_check = isinstance(field, ParityField | CrcField)
    return not is_constant and not is_check


def _problems_of_position(fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield the problems of the fields that form the position.

    It is either one field, ``position``, or ``multiturn`` followed by ``singleturn``.
    """
    index_by_name = {field.name: index for index, field in enumerate(fields)}
    if POSITION in index_by_name and (TURNS in index_by_name or IN_TURN in index_by_name):
        message = "'position' is the whole position; write either it, or multiturn and singleturn"
        yield LineProblem(fields[index_by_name[POSITION]].column, message)
    if TURNS not in index_by_name:
        return
    column = fields[index_by_name[TURNS]].column
    if IN_TURN not in index_by_name:
        yield LineProblem(column, "'multiturn' needs 'singleturn'; add singleturn=BITS")
    elif index_by_name[TURNS] > index_by_name[IN_TURN] and interface != "rs485":
        yield LineProblem(column, "'multiturn' must be before 'singleturn'; swap the two, or write position=BITS")


def _problems_of_length(fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield a problem if the frame has more or fewer bits than the interface allows, or incomplete bytes."""
    if not fields:
        return
    bits = sum(field.bits for field in fields)
    fewest_bits = 8 if interface in ("spi", "rs485") else 1
    most_bits = _MOST_BITS_OF_BYTES if interface == "rs485" else WIDEST
    if not fewest_bits <= bits <= most_bits:
        yield LineProblem(fields[0].column, f"the fields have {bits} bits; write {fewest_bits} to {most_bits}")
    elif interface == "rs485" and bits % 8:
        yield LineProblem(fields[0].column, f"the fields have {bits} bits; over RS-485, write whole bytes")


def problems_of_options(
    options: LineOptions, columns: Mapping[str, int], fields: Sequence[LineField], interface: str
) -> Iterator[LineProblem]:
    """Yield the problems of options that contradict the fields. ``columns`` has the column of each option by name."""
    if options.is_gray:
        yield from _problems_of_gray(options, columns, fields)
    if options.counts or options.turns:
        yield from _problems_of_counts(options, columns, fields)
    yield from _problems_of_byte_order(options, fields, interface)


def _problems_of_gray(
    options: LineOptions, columns: Mapping[str, int], fields: Sequence[LineField]
) -> Iterator[LineProblem]:
    """Yield the problems of the option ``gray``.

    Gray code needs a position that is unsigned, has several bits, and is one number without other fields in between.
    """
    column = columns.get("gray", 1)
    positions = [field for field in fields if field.name in (POSITION, IN_TURN)]
    if not positions:
        yield LineProblem(column, "'gray' needs a position; add position=BITS, or remove gray")
    names = [field.name for field in fields]
    has_turns = TURNS in names
    # The wrong order of the two is reported separately.
    if has_turns and IN_TURN in names and names.index(IN_TURN) > names.index(TURNS) + 1:
        message = "with gray, 'singleturn' must follow 'multiturn' directly; move the fields between them"
        yield LineProblem(fields[names.index(IN_TURN)].column, message)
    for field in positions:
        if field.bits == 1 and not has_turns:
            yield LineProblem(field.column, f"'{field.name}' has one bit, which is the same in Gray code; remove gray")
        if isinstance(field, NumberField) and field.is_signed:
            yield LineProblem(field.column, f"'{field.name}' is signed, and Gray code is not; remove one of the two")
    if options.counts and not is_power_of_two(options.counts):
        message = f"Gray code with {options.counts} counts (Gray excess) is not supported; remove gray and counts"
        yield LineProblem(columns.get("counts", 1), f"{message}, and convert the number in your program")


def _problems_of_counts(
    options: LineOptions, columns: Mapping[str, int], fields: Sequence[LineField]
) -> Iterator[LineProblem]:
    """Yield the problems of the options ``counts`` (per revolution) and ``turns`` (number of revolutions)."""
    column = columns.get("counts", columns.get("turns", 1))
    positions = [field for field in fields if isinstance(field, NumberField) and field.name == POSITION]
    if not positions:
        message = "'counts' and 'turns' need a field 'position'; singleturn and multiturn already give them"
        yield LineProblem(column, message)
    if options.turns and not options.counts:
        yield LineProblem(columns.get("turns", 1), "'turns' needs the counts per revolution; add counts=NUMBER")
    for name, count in (("counts", options.counts), ("turns", options.turns)):
        if is_probably_highest(count):
            message = f"{count} is the highest value; including 0 there are {count + 1}, so write {name}={count + 1}"
            yield LineProblem(columns.get(name, 1), message)
    turns = options.turns or 1
    total_counts = options.counts * turns
    for field in positions:
        number_of_values = 1 << field.bits
        if total_counts > number_of_values:
            message = f"{options.counts} counts × {turns} turns do not fit into {field.bits} bits"
            yield LineProblem(column, f"{message}; write at most {number_of_values} counts in all")
        if field.is_signed:
            message = "a signed position has no counts in a line; remove counts, and add its range to the spec"
            yield LineProblem(column, message)


def _problems_of_byte_order(options: LineOptions, fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield the problems of numbers of more than one byte.

    Over RS-485, their byte order must be known. Over SPI, a number that is sent low byte first must be whole bytes.
    """
    is_low_byte_first_spi = interface == "spi" and options.byte_order == "low_byte_first"
    bits_before_field = 0
    for field in fields:
        has_several_bytes = field.bits > 8 and not isinstance(field, FillerField)
        has_own_order = isinstance(field, CrcField) and field.byte_order != ""
        if interface == "rs485" and has_several_bytes and not (options.byte_order or has_own_order):
            message = f"the byte order of '{field.name}' is not known; write rs485,low_byte_first: or high_byte_first"
            yield LineProblem(field.column, message)
        if is_low_byte_first_spi and has_several_bytes and isinstance(field, NumberField):
            yield from _problems_of_swapped_number(field, bits_before_field)
        bits_before_field += field.bits


def _problems_of_swapped_number(field: NumberField, bits_before: int) -> Iterator[LineProblem]:
    """Yield the problems of a number of several bytes that is sent low byte first over SPI.

    It must be an unsigned number of whole bytes that begins after ``bits_before`` bits, whole bytes as well.
    """
    is_whole_bytes = bits_before % 8 == 0 and field.bits % 8 == 0
    if not is_whole_bytes:
        message = f"'{field.name}' is not whole bytes, so low_byte_first cannot apply; add zero or unused bits"
        yield LineProblem(field.column, message)
    is_constant = field.value is not None
    if field.is_signed or is_constant:
        message = f"'{field.name}' is signed or a constant, and cannot be sent low byte first; write its bytes"
        yield LineProblem(field.column, message)
