# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Encoders of one frame: a function for each class and encoder, made from the description of the frame.

The function handles fields of the usual types that fit. ``encode_number`` handles all others, and raises the errors.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, NamedTuple, cast

from ..codec import make_crc_tables
from ..encoder import Encoder
from .descriptions import find_description, shape_of
from .encode import compute_crc, encode_number

if TYPE_CHECKING:
    from ..bulk.shape import Column, CrcOf, Shape

#: Function that returns a frame as a number or as bytes.
Encode = Callable[[Any], Any]
#: Number of bits of a CRC up to which tables are small.
_TABLE_WIDTH: Final = 8


def find_class_encoder(frame: Any) -> Encode:
    """Return the function that encodes frames of the same class for the same encoder and the same answers."""
    kind = cast(type, frame.__class__)
    needed = find_description(kind)[1]
    # The encoder is the same in all frames that the function encodes. The answers can differ.
    first, count = sum(issubclass(argument_type, Encoder) for argument_type in needed), len(needed)
    # Raises an error if a field is not an encoder or an answer.
    encode_first = make_encoder(kind, frame[:count])
    if count == first:
        return encode_first
    by_answers: dict[tuple[Any, ...], Encode] = {frame[first:count]: encode_first}

    def encode(frame: Any) -> Any:
        """Encode a frame with the function for its answers."""
        answers = frame[first:count]
        try:
            encode_frame = by_answers[answers]
        except (KeyError, TypeError):
            # Raises an error if a field is not an answer.
            encode_frame = make_encoder(kind, frame[:count])
            by_answers[answers] = encode_frame
        return encode_frame(frame)

    return encode


def make_encoder(kind: type, arguments: tuple[Any, ...]) -> Encode:
    """Return a function that encodes frames of a class. ``arguments`` are the encoder and the answers."""
    shape = shape_of(kind, *arguments)

    def encode_any(frame: Any) -> int | bytes:
        """Encode a frame with any values, and raise an error if one does not fit."""
        number = encode_number(frame, shape, arguments)
        return number.to_bytes(shape.length, shape.order) if shape.length else number

    fields = cast("tuple[str, ...]", cast(Any, kind)._fields)
    if shape.limited is not None or any(_describe_usual_bits(column) is None for column in shape.columns):
        return encode_any
    source = _FunctionText(shape, fields)
    source.names["encode_any"] = encode_any
    # Like the methods of a dataclass, the function is compiled from text, which contains only names from here.
    exec(source.text(), source.names)
    return cast(Encode, source.names["encode"])


class _Bits(NamedTuple):
    """Condition for a field whose value is usual and fits, and its bits as an expression. ``{0}`` is the value."""

    condition: str
    bits: str


def _describe_usual_bits(column: Column) -> _Bits | None:
    """Return the condition and the bits of a field, or None if ``encode_number`` must handle it.

    They are texts of code, in which ``{0}`` stands for the variable of the value.
    """
    width = column.width
    if column.zero_means or column.power_of_two:
        return None
    match column.kind:
        case "flag":
            return _Bits("type({0}) is bool", "{0}") if width else _Bits("{0} is False", "0")
        case "not_flag":
            return _Bits("type({0}) is bool", "(not {0})") if width else _Bits("{0} is False", "0")
        case "signed" if width:
            top = 1 << width >> 1
            return _Bits(f"type({{0}}) is int and {-top} <= {{0}} < {top}", f"({{0}} & {(1 << width) - 1:#x})")
        case "number" if not column.values:
            return _Bits(f"type({{0}}) is int and not {{0}} >> {width}", "{0}")
        case "choice" if isinstance(column.values, type):
            return _Bits("type({0}) is kind_of_{0}", "{0}")
        case _:
            return None


class _FunctionText:
    """Text of the function that encodes a frame, and the names in it. Fields are named by their index.

    For a position of 20 bits and an active-low error bit, the text is::

        def encode(frame):
            field_0, field_1, = frame
            if type(field_0) is int and not field_0 >> 20 and type(field_1) is bool:
                number = field_0 << 1 | (not field_1)
                return number
            return encode_any(frame)
    """

    def __init__(self, shape: Shape, fields: tuple[str, ...]) -> None:
        self._fields = {name: f"field_{index}" for index, name in enumerate(fields)}
        self._conditions: list[str] = []
        self._terms: list[str] = [f"{shape.fixed:#x}"] if shape.fixed else []
        self._statements: list[str] = []
        self.names: dict[str, Any] = {}
        for column in shape.columns:
            self._add_column(column)
        self._add_unused(shape)
        self._add_limits(shape)
        if shape.gray is not None:
            low, width = shape.gray
            if shape.excess:
                self._statements.append(f"number += {shape.excess << low:#x}")
            self._statements.append(f"number ^= (number >> {low} & {(1 << width) - 1:#x}) >> 1 << {low}")
        self._add_parities(shape)
        self._add_result(shape)

    def _add_column(self, column: Column) -> None:
        """Add the condition on a field, and its bits, as code."""
        usual = _describe_usual_bits(column)
        if usual is None:
            return
        name = self._fields[column.name]
        self._conditions.append(usual.condition.format(name))
        bits = usual.bits.format(name)
        self._terms.append(f"{bits} << {column.low}" if column.low else bits)
        if column.kind == "choice":
            self.names[f"kind_of_{name}"] = column.values

    def _add_unused(self, shape: Shape) -> None:
        """Add the condition on unused bits, and their values in the manual, as code."""
        if shape.kept_mask is None and not shape.unused:
            return
        name = self._fields["unused"]
        if shape.kept_mask is not None:
            self._conditions.append(f"type({name}) is int and not {name} & ~{shape.kept_mask:#x}")
            self._terms.append(name)
            return
        self._conditions.append(f"type({name}) is int and {name} == 0")
        self._terms += [f"{unused.value << unused.low:#x}" for unused in shape.unused if unused.value]

    def _add_limits(self, shape: Shape) -> None:
        """Add the checks of the limits of fields, as code."""
        for index, check in enumerate(shape.checks):
            if check.limit is not None:
                self.names[f"is_within_{index}"] = check.is_within
                bits = f"number >> {check.low} & {(1 << check.width) - 1:#x}"
                self._statements.append(f"if not is_within_{index}({bits}): return encode_any(frame)")

    def _add_parities(self, shape: Shape) -> None:
        """Add the parity bits, which are those of the bits as they are sent."""
        for index, check in enumerate(shape.parities):
            self.names[f"parity_{index}"] = check.parity
            self._statements.append(f"number |= parity_{index}(number) << {check.low}")

    def _add_result(self, shape: Shape) -> None:
        """Add the CRC, by tables for 16 bits each if they are small, and the conversion to bytes."""
        crc = shape.crc
        if crc is None:
            result = "number"
        elif crc.low == 0 and crc.width <= _TABLE_WIDTH:
            tables = _make_tables(crc, shape.bits)
            self.names.update({f"table_{index}": table for index, table in enumerate(tables)})
            entries = [f"table_{index}[number >> {16 * index} & 0xFFFF]" for index in range(len(tables))]
            result = f"number ^ {' ^ '.join(entries)}"
        else:
            self.names.update(compute_crc=compute_crc, crc=crc)
            result = f"number | compute_crc(number, crc) << {crc.low}"
        if shape.length:
            result = f"({result}).to_bytes({shape.length}, {shape.order!r})"
        self._statements.append(f"return {result}")

    def text(self) -> str:
        """Return the function as text."""
        lines = ["def encode(frame):"]
        if self._fields:
            lines.append(f"    {', '.join(self._fields.values())}, = frame")
        lines += [
            f"    if {' and '.join(self._conditions) or 'True'}:",
            f"        number = {' | '.join(self._terms) or '0'}",
        ]
        lines += [f"        {statement}" for statement in self._statements]
        return "\n".join([*lines, "    return encode_any(frame)"])


def _make_tables(crc: CrcOf, bits: int) -> tuple[Any, ...]:
    """Return tables for 16 bits of a frame each. The XOR of their entries is the CRC."""

    def crc_of_number(covered: int, _: int) -> int:
        return compute_crc(covered << crc.width, crc)

    return make_crc_tables(crc_of_number, bits - crc.width, crc.width, (bits + 15) // 16)
