"""Find problems of fields and options that are valid individually but not together."""

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

#: Most bits of a frame over RS-485.
_MOST_BITS_OF_BYTES = 1024


def problems_of_fields(fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield the problems of fields that do not fit together."""
    names: set[str] = set()
    for field in fields:
        if not isinstance(field, FillerField) and field.name in names:
            yield LineProblem(field.column, f"a second field has the name '{field.name}'; rename one of them")
        names.add(field.name)
        if isinstance(field, CrcField) and field is not fields[-1]:
            yield LineProblem(field.column, "the CRC must be the last field; move it to the end")
        if isinstance(field, CrcField) and interface == "rs485" and field.bits % 8:
            yield LineProblem(field.column, f"the CRC has {field.bits} bits; over RS-485, write whole bytes")
        if isinstance(field, ParityField) and not any(map(_can_change, fields)):
            yield LineProblem(field.column, "a parity bit needs other fields that change; add them")
    yield from _problems_of_position(fields, interface)
    yield from _problems_of_length(fields, interface)


def _can_change(field: LineField) -> bool:
    """Return True if a field is not a check or a constant."""
    is_constant_number = isinstance(field, NumberField) and field.value is not None
    is_constant = is_constant_number or field.name == "zero"
    is_check = isinstance(field, ParityField | CrcField)
    return not is_constant and not is_check


def _problems_of_position(fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield the problems of the parts of the position: the whole one, or turns before the position within a turn."""
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
    """Yield the problem of a frame with another number of bits than the interface allows."""
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
    """Yield the problems of options that do not fit the fields. ``columns`` maps each option to its column."""
    if options.is_gray:
        yield from _problems_of_gray(options, columns, fields)
    if options.counts or options.turns:
        yield from _problems_of_counts(options, columns, fields)
    yield from _problems_of_byte_order(options, fields, interface)


def _problems_of_gray(
    options: LineOptions, columns: Mapping[str, int], fields: Sequence[LineField]
) -> Iterator[LineProblem]:
    """Yield the problems of Gray code, which needs an unsigned position that is one number of more than one bit."""
    column = columns.get("gray", 1)
    positions = [field for field in fields if field.name in (POSITION, IN_TURN)]
    if not positions:
        yield LineProblem(column, "'gray' needs a position; add position=BITS, or remove gray")
    for field in fields:
        if isinstance(field, ParityField):
            yield LineProblem(field.column, "a parity over Gray code is not supported; write its bit as unused=1")
    names = [field.name for field in fields]
    has_turns = TURNS in names
    # The other order of the two is a problem of its own.
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
    """Yield the problems of counts per revolution, and of numbers of revolutions."""
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
    for field in positions:
        number_of_values = 1 << field.bits
        if options.counts * turns > number_of_values:
            message = f"{options.counts} counts × {turns} turns do not fit into {field.bits} bits"
            yield LineProblem(column, f"{message}; write at most {number_of_values} counts in all")
        if field.is_signed:
            message = "a signed position has no counts in a line; remove counts, and add its range to the spec"
            yield LineProblem(column, message)


def _problems_of_byte_order(options: LineOptions, fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield the problems of numbers of several bytes.

    Over RS-485, their byte order must be known. Over SPI, a number that is sent low byte first must be whole bytes.
    """
    bits_before = 0  # Number of bits sent before the field.
    for field in fields:
        is_wide = field.bits > 8 and not isinstance(field, FillerField)
        if interface == "rs485" and is_wide and not options.byte_order:
            message = f"the byte order of '{field.name}' is not known; write rs485,low_byte_first: or high_byte_first"
            yield LineProblem(field.column, message)
        is_split = interface == "spi" and options.byte_order == "low_byte_first" and isinstance(field, NumberField)
        if is_split and is_wide:
            yield from _problems_of_split(field, bits_before)
        bits_before += field.bits


def _problems_of_split(field: LineField, bits_before: int) -> Iterator[LineProblem]:
    """Yield the problems of a number over SPI that is sent low byte first.

    ``bits_before`` is the number of bits sent before it.
    """
    is_whole_bytes = bits_before % 8 == 0 and field.bits % 8 == 0
    if not is_whole_bytes:
        message = f"'{field.name}' is not whole bytes, so low_byte_first cannot apply; add zero or unused bits"
        yield LineProblem(field.column, message)
    if isinstance(field, NumberField) and (field.is_signed or field.value is not None):
        message = f"'{field.name}' is signed or a constant, and cannot be sent low byte first; write its bytes"
        yield LineProblem(field.column, message)
