# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Functions that encode one frame: one for each class and encoder, created from the description of the frame.

The function handles values that fit their fields and have exactly the usual type, such as ``int`` but not a subclass.
``encode_number`` handles all other values, and raises the errors.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, NamedTuple, cast

from ..codec import exchange_bytes, make_crc_tables
from ..encoder import Encoder
from .descriptions import field_names, find_description, layout_of
from .encode import compute_crc, encode_number

if TYPE_CHECKING:
    from ..bulk.shape import Column, CrcOf, FrameLayout

#: Function that returns a frame as a number or as bytes.
Encode = Callable[[Any], Any]
#: Maximum CRC width for which the tables are small.
_TABLE_WIDTH: Final = 8


def find_class_encoder(frame: Any) -> Encode:
    """Return the function that encodes frames of the class of ``frame`` for its encoder.

    A frame begins with its encoder, if the class needs it, and the answers to open questions. The function compiles one
    encoding function for each combination of answers, when it first occurs in a frame.
    """
    frame_class = cast(type, frame.__class__)
    _, argument_types = find_description(frame_class)
    # The members of a frame are (encoder, answer, …, field, …). The encoder, if there is one, is the same in all frames
    # that the function encodes, so only the answers choose.
    # There is one encoder, or none if all encoders have the same frames.
    encoder_count = sum(issubclass(argument_type, Encoder) for argument_type in argument_types)
    argument_count = len(argument_types)
    first_arguments = frame[:argument_count]
    # Raises an error if a field is not an encoder or an answer.
    encode_like_first = make_encoder(frame_class, first_arguments)
    has_answers = argument_count > encoder_count
    if not has_answers:
        return encode_like_first
    first_answers = frame[encoder_count:argument_count]
    functions_by_answers: dict[tuple[Any, ...], Encode] = {first_answers: encode_like_first}

    def encode(next_frame: Any) -> Any:
        """Encode a frame of this class with the function for its answers."""
        answers = next_frame[encoder_count:argument_count]
        try:
            encode_frame = functions_by_answers[answers]
        except (KeyError, TypeError):
            # The answers are new, or not hashable. This raises an error if a field is not an answer.
            encode_frame = make_encoder(frame_class, next_frame[:argument_count])
            functions_by_answers[answers] = encode_frame
        return encode_frame(next_frame)

    return encode


def make_encoder(frame_class: type, arguments: tuple[Any, ...]) -> Encode:
    """Return a function that encodes frames of a class. ``arguments`` are the encoder and the answers that it needs.

    The function is compiled for this class. If a field has no fast path, or has limits that depend on the encoder,
    the function instead reads the frame description on each call.
    """
    layout = layout_of(frame_class, *arguments)

    def encode_any(frame: Any) -> int | bytes:
        """Encode a frame with any values, and raise an error if a value does not fit."""
        number = encode_number(frame, layout, arguments)
        if not layout.byte_count:
            return number
        return exchange_bytes(number.to_bytes(layout.byte_count, layout.order), layout.exchanged_bytes)

    has_slow_fields = any(_describe_usual_bits(column) is None for column in layout.columns)
    has_limits_by_encoder = layout.limited_value is not None
    if has_slow_fields or has_limits_by_encoder or layout.digit_codings:
        return encode_any
    function_text = _FunctionText(layout, field_names(frame_class))
    global_variables = function_text.names
    global_variables["encode_any"] = encode_any
    # Like the methods of a dataclass, the function is compiled from text, which contains only names from here.
    exec(function_text.text(), global_variables)
    return cast(Encode, global_variables["encode"])


class _Bits(NamedTuple):
    """Two pieces of code for a field, in which ``{0}`` is replaced with the variable that holds the field's value.

    ``condition`` is True if the value has the usual type and fits, and ``bits`` is an expression for its bits. For a
    20-bit number: ``"type({0}) is int and not {0} >> 20"`` and ``"{0}"``.
    """

    condition: str
    bits: str


def _describe_usual_bits(column: Column) -> _Bits | None:
    """Return the code for the condition and the bits of a field, or None if the field needs ``encode_number``.

    ``encode_number`` handles strings, decimal digits, numbers and choices with a list of values, powers of two, numbers
    whose value 0 has a different meaning, and signed numbers without bits.
    """
    width = column.width
    if column.zero_means or column.power_of_two:
        return None
    match column.value_kind:
        case "flag":
            return _Bits("type({0}) is bool", "{0}") if width else _Bits("{0} is False", "0")
        case "not_flag":
            return _Bits("type({0}) is bool", "(not {0})") if width else _Bits("{0} is False", "0")
        case "signed" if width:
            end = (1 << width) >> 1
            mask = (1 << width) - 1
            # The double braces leave {0} in the text.
            return _Bits(f"type({{0}}) is int and {-end} <= {{0}} < {end}", f"({{0}} & {mask:#x})")
        case "number" if not column.allowed_values:
            return _Bits(f"type({{0}}) is int and not {{0}} >> {width}", "{0}")
        case "choice" if isinstance(column.allowed_values, type):
            return _Bits("type({0}) is kind_of_{0}", "{0}")
        case _:
            return None


class _FunctionText:
    """Text of the function that encodes a frame, and the names used in it. Fields are named by their index.

    For a 20-bit position and an active-low error bit, the text is::

        def encode(frame):
            field_0, field_1, = frame
            if type(field_0) is int and not field_0 >> 20 and type(field_1) is bool:
                number = field_0 << 1 | (not field_1)
                return number
            return encode_any(frame)

    ``_conditions`` and ``_terms`` contain the expressions that are joined with ``and`` and with ``|``. ``_statements``
    contains the lines that follow. ``names`` are the global variables of the function.
    """

    def __init__(self, layout: FrameLayout, fields: tuple[str, ...]) -> None:
        # The name of each field's variable. The bits of all terms are joined by |, starting with the constant bits.
        self._fields = {name: f"field_{index}" for index, name in enumerate(fields)}
        self._conditions: list[str] = []
        self._terms: list[str] = [f"{layout.fixed:#x}"] if layout.fixed else []
        self._statements: list[str] = []
        self.names: dict[str, Any] = {}
        for column in layout.columns:
            self._add_column(column)
        self._add_unused(layout)
        self._add_limits(layout)
        if layout.gray is not None:
            # The Gray code of n is n ^ n >> 1, within its bits of the frame.
            lowest_bit, width = layout.gray
            if layout.excess:
                self._statements.append(f"number += {layout.excess << lowest_bit:#x}")
            self._statements.append(f"number ^= (number >> {lowest_bit} & {(1 << width) - 1:#x}) >> 1 << {lowest_bit}")
        self._add_parities(layout)
        self._add_result(layout)

    def _add_column(self, column: Column) -> None:
        """Add code for the condition on a field, and for its bits at their place in the frame.

        The first field, a 20-bit number that starts at bit 1, adds ``type(field_0) is int and not field_0 >> 20`` to
        the conditions, and ``field_0 << 1`` to the terms.
        """
        usual = _describe_usual_bits(column)
        if usual is None:
            # For type checkers only: with such a field, no function is compiled.
            return
        name = self._fields[column.name]
        self._conditions.append(usual.condition.format(name))
        bits = usual.bits.format(name)
        self._terms.append(f"{bits} << {column.lowest_bit}" if column.lowest_bit else bits)
        if column.value_kind == "choice":
            # The condition of a choice compares the type of the value with this enumeration.
            self.names[f"kind_of_{name}"] = column.allowed_values

    def _add_unused(self, layout: FrameLayout) -> None:
        """Add code for the condition on the field ``unused``, and for the unused bits.

        In a register that keeps its other bits, ``unused`` holds these bits at their places. Otherwise a bit of
        ``unused`` is 1 where the sent bit differs from the manual, so 0 represents the values in the manual.
        """
        if layout.kept_mask is None and not layout.unused:
            return
        name = self._fields["unused"]
        if layout.kept_mask is not None:
            self._conditions.append(f"type({name}) is int and not {name} & ~{layout.kept_mask:#x}")
            self._terms.append(name)
            return
        self._conditions.append(f"type({name}) is int and {name} == 0")
        self._terms += [f"{unused.value << unused.lowest_bit:#x}" for unused in layout.unused if unused.value]

    def _add_limits(self, layout: FrameLayout) -> None:
        """Add code for the checks of fields with a highest value. If a check fails, ``encode_any`` raises the error.

        For a field of 12 bits at bit 8, the code is
        ``if not is_within_0(number >> 8 & 0xfff): return encode_any(frame)``.
        """
        for index, check in enumerate(layout.checks):
            if check.highest is None:
                continue
            self.names[f"is_within_{index}"] = check.is_within
            if check.joined:
                # Several groups of bits form the number that is checked.
                self.names[f"take_{index}"] = check.take
                bits = f"take_{index}(number)"
            else:
                bits = f"number >> {check.lowest_bit} & {(1 << check.width) - 1:#x}"
            self._statements.append(f"if not is_within_{index}({bits}): return encode_any(frame)")

    def _add_parities(self, layout: FrameLayout) -> None:
        """Add code for the parity bits. It comes after Gray code, because parity covers the bits as they are sent."""
        for index, check in enumerate(layout.parities):
            self.names[f"parity_{index}"] = check.parity
            self._statements.append(f"number |= parity_{index}(number) << {check.lowest_bit}")

    def _add_result(self, layout: FrameLayout) -> None:
        """Add code for the CRC and for the conversion to bytes.

        A CRC of at most 8 bits at the low end of the frame is the XOR of one table entry per 16 bits.
        """
        crc = layout.crc
        if crc is None:
            result = "number"
        elif crc.lowest_bit == 0 and crc.width <= _TABLE_WIDTH:
            tables = _make_tables(crc, layout.bit_count)
            self.names.update({f"table_{index}": table for index, table in enumerate(tables)})
            # The CRC bits of the number are still 0, so the XOR inserts the CRC.
            entries = [f"table_{index}[number >> {16 * index} & 0xFFFF]" for index in range(len(tables))]
            result = f"number ^ {' ^ '.join(entries)}"
        else:
            self.names.update(compute_crc=compute_crc, crc=crc)
            result = f"number | compute_crc(number, crc) << {crc.lowest_bit}"
        if layout.byte_count:
            result = f"({result}).to_bytes({layout.byte_count}, {layout.order!r})"
        if layout.exchanged_bytes:
            self.names["exchange_bytes"] = exchange_bytes
            result = f"exchange_bytes({result}, {layout.exchanged_bytes})"
        self._statements.append(f"return {result}")

    def text(self) -> str:
        """Return the complete function as text."""
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
    """Return one table per 16 bits of a frame of ``bits`` bits. The XOR of the entries for a frame is its CRC.

    The first table is for the lowest bits. The bits of the CRC in the frame must be 0.
    """

    def crc_of_covered_bits(covered_bits: int, _bit_count: int) -> int:
        """Return the CRC of the bits above it."""
        return compute_crc(covered_bits << crc.width, crc)

    # A table covers 16 bits, so the number of tables is rounded up.
    table_count = (bits + 15) // 16
    covered_count = bits - crc.width
    return make_crc_tables(crc_of_covered_bits, covered=covered_count, width=crc.width, count=table_count)
