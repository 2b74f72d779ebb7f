"""Types, numbers and expressions in Rust."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable

from codewheel.model import BitSlice, Device, Field, Parameter, assert_never
from codewheel.model.expressions import Expression, Factor, Term
from codewheel.plan import values
from codewheel.plan.codec import characters
from codewheel.say import text_on_one_line

from .names import snake


def unsigned(bits: int, smallest: int = 8) -> str:
    """Return the unsigned type for a number of bits."""
    return f"u{next(size for size in (8, 16, 32, 64, 128) if size >= max(bits, smallest))}"


def type_of(field: Field) -> str:
    """Return the type of a member. A choice has its own type."""
    match values.meaning_of(field):
        case values.TwosComplement():
            return unsigned(field.widest).replace("u", "i")
        case values.UnsignedNumber() | values.ZeroMeans() | values.NamedChoice() | values.DecimalDigits():
            return unsigned(values.widest_value(field))
        case values.ActiveFlag():
            return "bool"
        case values.Latin1Text():
            return f"[u8; {field.widest // 8}]"
        case unknown_meaning:
            assert_never(unknown_meaning)


def parameter_number(raw: str, meaning: values.UnsignedNumber | values.ZeroMeans) -> str:
    """Return the number that the bits of a parameter mean."""
    return (
        raw if isinstance(meaning, values.UnsignedNumber) else f"match {raw} {{ 0 => {meaning.number}, bits => bits }}"
    )


def type_of_parameter(parameter: Parameter) -> str:
    """Return the type of a parameter: ``u32``, which is used for places and widths, unless it is larger."""
    return unsigned(parameter.largest.bit_length(), 32)


def holds_all_of(field: Field, type_: str) -> bool:
    """Return whether every number of a type fits into a field."""
    return field.width == Expression(int(type_[1:]))


def hexadecimal(number: int) -> str:
    """Return a number in hexadecimal, if it has several digits."""
    return f"0x{number:X}" if number > 9 else f"{number}"


def pattern(numbers: Collection[int]) -> str:
    """Return a pattern that matches these numbers, with a range for three or more in a row."""
    low, high = min(numbers), max(numbers)
    return f"{low}..={high}" if 1 < high - low == len(numbers) - 1 else " | ".join(map(str, numbers))


def quoted(text: str) -> str:
    """Return a literal of text on one line."""
    return json.dumps(text_on_one_line(text), ensure_ascii=False)


def widened(value: str, type_: str) -> str:
    """Return a number of this type in 64 bits."""
    return value if type_[1:] == "64" else f"{type_[0]}64::from({value})"


def narrowed(value: str, type_: str) -> str:
    """Return a number of 64 bits in this type, which is large enough."""
    return value if type_[1:] == "64" else f"{value} as {type_}"


def byte_of(bit_slice: BitSlice) -> str:
    """Return the bits of a piece in its byte."""
    byte = (
        f"bytes[{bit_slice.byte}] >> {bit_slice.low_in_byte}" if bit_slice.low_in_byte else f"bytes[{bit_slice.byte}]"
    )
    masked = (
        f"({byte}) & {hexadecimal(bit_slice.mask)}"
        if bit_slice.low_in_byte
        else f"{byte} & {hexadecimal(bit_slice.mask)}"
    )
    return byte if bit_slice.mask == 0xFF >> bit_slice.low_in_byte else masked


def joined_pieces(bit_slices: Iterable[BitSlice]) -> str:
    """Return the bits of these pieces of ``bytes`` as one number."""
    parts = ((f"u64::from({byte_of(bit_slice)})", bit_slice.low_in_number) for bit_slice in bit_slices)
    return " | ".join(f"({part} << {shift})" if shift else part for part, shift in parts) or "0_u64"


def put_byte(bit_slice: BitSlice, raw: str) -> str:
    """Return the contribution of a piece of a number, which fits, to its byte."""
    part = f"({raw} >> {bit_slice.low_in_number}) as u8" if bit_slice.low_in_number else f"{raw} as u8"
    if bit_slice.mask != 0xFF >> bit_slice.low_in_byte:
        part = f"{part} & {hexadecimal(bit_slice.mask)}"
    return f"({part}) << {bit_slice.low_in_byte}" if bit_slice.low_in_byte else part


PIECES = (byte_of, put_byte, joined_pieces)
NUMBERS = (holds_all_of, parameter_number, hexadecimal, narrowed, pattern, quoted, type_of_parameter, unsigned, widened)


class Scope:
    """Spelling of expressions over the parameters of ``variant``."""

    def __init__(self, device: Device) -> None:
        self._parameters = {parameter.name: parameter for parameter in device.parameters}
        self._questions = {alternative.name for alternative in device.alternatives if not alternative.default}

    def is_open(self, name: str) -> bool:
        """Return True if the user must decide on a parameter, since its question has no default answer."""
        return self._parameters[name].alternative in self._questions

    def parameter(self, name: str) -> str:
        """Return a parameter. One that the user must decide on is asked for."""
        question = self._parameters[name].alternative if self.is_open(name) else ""
        call = "" if self._parameters[name].equals is None else "()"
        return f"variant.{snake(name)}{call}" + (f'.ok_or(Fault::Undecided("{question}"))?' if question else "")

    def expression(self, expression: Expression, type_: str = "u32") -> str:
        """Return an expression in a type that can hold it, with subtractions last."""
        alone = expression.constant == 0 and len(expression.terms) == 1 and not expression.terms[0].is_product
        plus = [self._term(term, type_, alone) for term in expression.terms if term.multiple > 0]
        minus = [self._term(term, type_, False) for term in expression.terms if term.multiple < 0]
        if expression.constant > 0 or not plus:
            plus.append(f"{max(expression.constant, 0)}")
        if expression.constant < 0:
            minus.append(f"{-expression.constant}")
        return " - ".join([" + ".join(plus), *minus])

    def converted(self, field: Field, type_: str) -> tuple[str, str]:
        """Return the value of a member from the bits in ``raw_`` and its name, and the bits from the member."""
        raw, member, width = f"raw_{field.name}", f"self.{snake(field.name)}", self.expression(field.width)
        wide = widened(member, type_)
        match values.meaning_of(field):
            case values.UnsignedNumber() | values.DecimalDigits():
                return narrowed(raw, type_), wide
            case values.TwosComplement():
                return narrowed(f"signed({raw}, {width})", type_), f"field({wide} as u64, 0, {width})"
            case values.ZeroMeans(number) as meaning:
                decoded = f"({parameter_number(raw, meaning)}) as {type_}"
                return decoded, f"if {member} == {number} {{ 0 }} else {{ {wide} }}"
            case values.ActiveFlag(low):
                comparison, negation = ("==", "!") if low else ("!=", "")
                return f"{raw} {comparison} 0", f"u64::from({negation}{member})"
            case values.NamedChoice():
                return f'{type_}::from_bits({raw}).ok_or(Fault::Range("{field.name}"))?', f"{member} as u64"
            case values.Latin1Text():
                copied = ", ".join(f"bytes[{byte}]" for _, byte in characters(field))
                return f"[{copied}]" if copied else f"bytes_of({raw}, false)", f"number({member}.iter())"
            case unknown_meaning:
                assert_never(unknown_meaning)

    def _term(self, term: Term, type_: str, alone: bool) -> str:
        multiple = [f"{abs(term.multiple)}"] if abs(term.multiple) != 1 else []
        factors = [self._factor(factor, type_, alone and not multiple) for factor in term.factors]
        return " * ".join([*multiple, *factors])

    def _factor(self, factor: Factor, type_: str, alone: bool) -> str:
        name = self.parameter(factor.parameter)
        own_type = type_of_parameter(self._parameters[factor.parameter])
        if factor.power:
            return f"1_{type_} << {name}" if alone else f"(1_{type_} << {name})"
        if own_type == type_:
            return name
        return f"{type_}::from({name})" if int(own_type[1:]) < int(type_[1:]) else f"{name} as {type_}"
