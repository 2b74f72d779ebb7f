"""Expressions in C, as trees: operands, masks, shifts and casts, parameters of order codes, and functions of them."""

from __future__ import annotations

from collections.abc import Mapping
from math import prod

from ...model import BitSlice
from ...model.expressions import Expression, Factor, Term
from ...model.record import dataclass
from .names import c_name, c_number, signed_number, unsigned


class CExpression:
    """A C expression. Its text is its ``str``."""

    __slots__ = ()

    @property
    def as_operand(self) -> str:
        """The text to use as an operand or after a cast, in parentheses if it needs them there."""
        return str(self)


@dataclass(frozen=True, slots=True)
class CName(CExpression):
    """A name: a local, ``in->flag``, ``bytes[3]``."""

    text: str

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class CNumber(CExpression):
    """An unsigned constant, or with ``signed`` one with a sign."""

    value: int
    hexadecimal: bool = False
    signed: bool = False

    def __str__(self) -> str:
        return signed_number(self.value) if self.signed else c_number(self.value, self.hexadecimal)


@dataclass(frozen=True, slots=True)
class CCall(CExpression):
    """A call of a function."""

    function: str
    arguments: tuple[CExpression, ...]

    def __str__(self) -> str:
        return f"{self.function}({', '.join(map(str, self.arguments))})"


@dataclass(frozen=True, slots=True)
class CCast(CExpression):
    """A value cast to a type."""

    type: str
    value: CExpression

    def __str__(self) -> str:
        return f"({self.type}){self.value.as_operand}"


_SUM_OPERATORS = frozenset("+-")


@dataclass(frozen=True, slots=True)
class COperation(CExpression):
    """Two or more operands with one operator."""

    operator: str
    operands: tuple[CExpression, ...]

    def __str__(self) -> str:
        leftmost, *others = self.operands
        # A sum continues without parentheses, from the left: ``a + b - c``.
        continues_sum = isinstance(leftmost, COperation) and {leftmost.operator, self.operator} <= _SUM_OPERATORS
        operand_texts = [str(leftmost) if continues_sum else leftmost.as_operand]
        operand_texts += [operand.as_operand for operand in others]
        return f" {self.operator} ".join(operand_texts)

    @property
    def as_operand(self) -> str:
        return f"({self})"


@dataclass(frozen=True, slots=True)
class Conditional(CExpression):
    """One of two values, depending on a condition."""

    condition: CExpression
    value_if_true: CExpression
    value_if_false: CExpression

    def __str__(self) -> str:
        return f"{self.condition.as_operand} ? {self.value_if_true.as_operand} : {self.value_if_false.as_operand}"

    @property
    def as_operand(self) -> str:
        return f"({self})"


def shifted_right(value: CExpression, by: int) -> CExpression:
    """Return ``value`` shifted to the right, or unchanged for a shift of 0."""
    return COperation(">>", (value, CNumber(by))) if by else value


def shifted_left(value: CExpression, by: int | CExpression) -> CExpression:
    """Return ``value`` shifted to the left, unless by 0."""
    if not by:
        return value
    distance = CNumber(by) if isinstance(by, int) else by
    if _has_product(distance):
        # Checkers of MISRA C:2012 10.7 compare the types of both operands, although a shift does not convert them.
        distance = CCast("uint32_t", distance)
    return COperation("<<", (value, distance))


def _has_product(expression: CExpression) -> bool:
    """Return True if an expression contains a multiplication."""
    if not isinstance(expression, COperation):
        return False
    return expression.operator == "*" or any(map(_has_product, expression.operands))


def masked(value: CExpression, mask: int) -> CExpression:
    """Return the bits of ``value`` in a mask, such as ``word & 0x7FU``."""
    return COperation("&", (value, CNumber(mask, hexadecimal=True)))


def join_operands(operator: str, operands: tuple[CExpression, ...]) -> CExpression:
    """Return the operands joined by an operator, or the only operand."""
    return operands[0] if len(operands) == 1 else COperation(operator, operands)


@dataclass(frozen=True, slots=True)
class StructPassing:
    """How functions receive structs: by value, or by address for compilers that cannot pass structs by value."""

    by_address: bool = False

    def parameter(self, type_: str, name: str) -> str:
        """Return the declaration of a parameter that is a struct."""
        return f"const {type_} *{name}" if self.by_address else f"{type_} {name}"

    def argument(self, struct: str) -> str:
        """Return the argument that passes a struct."""
        return f"&{struct}" if self.by_address else struct

    def member(self, parameter: str, member: str) -> str:
        """Return a member of a parameter that is a struct, such as ``variant.position_bits``."""
        return f"{parameter}{'->' if self.by_address else '.'}{member}"


BY_VALUE = StructPassing()


BY_ADDRESS = StructPassing(by_address=True)


@dataclass(frozen=True)
class ExpressionTranslator:
    """How C expresses the parameters of an order code, such as the number of position bits.

    A parameter that the order code sets is a member of the variant. ``largest`` contains its highest value. Other
    parameters are functions of the variant. If a parameter depends on a question that the manual leaves open, it is a
    function of the user's answer, and ``answers`` contains the name of that argument.
    """

    prefix: str
    largest: Mapping[str, int]
    answers: Mapping[str, str]
    passing: StructPassing = BY_VALUE

    def parameter_to_c(self, parameter: str) -> CExpression:
        """Return a parameter as C: a member of the variant, or the call of a function."""
        if parameter in self.answers:
            return CCall(f"{self.prefix}_{parameter}", (CName(self.answers[parameter]),))
        if parameter in self.largest:
            return self.member(parameter)
        return CCall(f"{self.prefix}_{parameter}", (CName("variant"),))

    def member(self, parameter: str) -> CExpression:
        """Return a parameter that order codes set: a member of the variant, such as ``variant.position_bits``."""
        return CName(self.passing.member("variant", c_name(parameter)))

    def uses_variant(self, expression: Expression) -> bool:
        """Return True if the expression depends on the order code, and not only on answers of the user."""
        return any(parameter not in self.answers for parameter in expression.parameters)

    def mask(self, width: Expression) -> CExpression:
        """Return a mask whose lowest ``width`` bits are 1."""
        if width.is_constant:
            return CNumber((1 << width.constant) - 1, hexadecimal=True)
        return CCall("cw_mask", (self.to_c(width),))

    def to_c(self, expression: Expression) -> CExpression:
        """Return an expression of the spec as C, unsigned, such as ``8U + variant.position_bits - 1U``.

        What is added comes first, so that no intermediate result is negative unless the result is.
        """
        match expression:
            case Expression(constant=-1, terms=(Term(multiple=1, factors=(Factor(parameter=exponent, power=True),)),)):
                # 2 to the power of the parameter, minus 1.
                return CCall("cw_mask", (self.parameter_to_c(exponent),))
        added = [self._express_term(term) for term in expression.terms if term.multiple > 0]
        subtracted = [self._express_term(term) for term in expression.terms if term.multiple < 0]
        if expression.constant < 0:
            subtracted.append(CNumber(-expression.constant))
        if expression.constant > 0 or not added:
            # Without terms to add, the subtraction begins with 0.
            added.insert(0, CNumber(max(expression.constant, 0)))
        has_several_operands = len(added) + len(subtracted) > 1
        if isinstance(added[0], CName) and has_several_operands:
            # The member can have 8 bits, which would be promoted to a signed type.
            added[0] = CCast("uint32_t", added[0])
        return join_operands("-", (join_operands("+", tuple(added)), *subtracted))

    def to_signed_c(self, expression: Expression) -> CExpression:
        """Return an expression of the spec as C, in 64 bits with a sign.

        A power of two is written as its mask plus one, since the power itself may not fit.
        """
        constant = expression.constant
        signs_and_products: list[tuple[str, CExpression]] = []
        for term in expression.terms:
            sign = "+" if term.multiple > 0 else "-"
            if term.is_power and not term.is_product and abs(term.multiple) == 1:
                # The power is one more than its mask.
                constant += term.multiple
                (exponent,) = term.factors
                product: CExpression = CCall("cw_mask", (self.parameter_to_c(exponent.parameter),))
            else:
                product = self._express_term(term)
            signs_and_products.append((sign, CCast("int64_t", product)))
        if not signs_and_products:
            return CNumber(constant, signed=True)
        (first_sign, first_product), *further = signs_and_products
        total = first_product
        if constant or first_sign == "-":
            total = COperation(first_sign, (CNumber(constant, signed=True), first_product))
        for sign, product in further:
            total = COperation(sign, (total, product))
        return total

    def _express_term(self, term: Term) -> CExpression:
        """Return the product of a term without its sign, such as ``(uint32_t)variant.turns * 4U``.

        It has 64 bits if 32 may be too few. A single parameter keeps its own type.
        """
        first_factor, *further_factors = (self._express_factor(factor) for factor in term.factors)
        if abs(term.multiple) != 1:
            further_factors.append(CNumber(abs(term.multiple)))
        if not further_factors:
            return first_factor
        if not term.factors[0].power:
            first_factor = CCast("uint64_t" if self._has_64_bits(term) else "uint32_t", first_factor)
        return COperation("*", (first_factor, *further_factors))

    def _has_64_bits(self, term: Term) -> bool:
        """Return True if a term is computed in 64 bits: a power of two, or a product that may need more than 32."""
        is_product = len(term.factors) > 1 or abs(term.multiple) != 1
        # A parameter that an order code does not set has up to 32 bits.
        largest_factors = (self.largest.get(factor.parameter, 1 << 32) for factor in term.factors)
        largest_product = abs(term.multiple) * prod(largest_factors)
        needs_more_than_32_bits = largest_product >> 32 != 0
        return term.is_power or (is_product and needs_more_than_32_bits)

    def has_64_bits(self, expression: Expression) -> bool:
        """Return True if the expression is computed in 64 bits, also if its result is small."""
        return any(map(self._has_64_bits, expression.terms))

    def _express_factor(self, factor: Factor) -> CExpression:
        """Return a factor: a parameter, or 2 to the power of a parameter."""
        parameter = self.parameter_to_c(factor.parameter)
        return COperation("<<", (CCast("uint64_t", CNumber(1)), parameter)) if factor.power else parameter


@dataclass(frozen=True, slots=True)
class CFunction:
    """A function that returns one expression. ``uses_variant`` is True if the value depends on the order code."""

    name: str
    type: str
    value: CExpression
    about: str
    uses_variant: bool


def number_function(
    translator: ExpressionTranslator, name: str, expression: Expression, largest: int, about: str
) -> CFunction:
    """Return the function for an expression whose values are at most ``largest``.

    It has 32 bits if the values and all intermediate results fit, and otherwise 64. ``about`` is the comment on it.
    """
    # A product is computed before a negative constant is subtracted from it, so it is larger than the result.
    has_product = any(term.is_product for term in expression.terms)
    subtracted = min(expression.constant, 0) if has_product else 0
    largest_intermediate = largest - subtracted
    bits = max(largest_intermediate.bit_length(), 32)
    value = translator.to_c(expression)
    if bits == 32 and translator.has_64_bits(expression):
        value = CCast("uint32_t", value)
    return CFunction(name, type=unsigned(bits), value=value, about=about, uses_variant=not expression.is_constant)


def wide_number_function(translator: ExpressionTranslator, name: str, expression: Expression, about: str) -> CFunction:
    """Return the function for an expression, with a 64-bit result. ``about`` is the comment on it."""
    value = translator.to_c(expression)
    # A power of two is computed in 64 bits, and so is what follows it.
    begins_with_power = bool(expression.terms) and expression.terms[0].is_power
    is_wide_constant = expression.is_constant and expression.constant > 0xFFFFFFFF
    if not begins_with_power and not is_wide_constant:
        value = CCast("uint64_t", value)
    return CFunction(name, type="uint64_t", value=value, about=about, uses_variant=not expression.is_constant)


def type_and_bits_in(bit_slices: tuple[BitSlice, ...]) -> tuple[str, CExpression]:
    """Return the C type and the expression of the number that consists of these bits of the array ``bytes``.

    For one slice, this is ``uint8_t`` and ``(uint8_t)(bytes[1] >> 4)``. Without slices, which means that no order code
    has the field, the number is 0.
    """
    if not bit_slices:
        return unsigned(1), CNumber(0)
    # The mask of a slice begins at bit 0, so that its length is the number of bits.
    width = sum(bit_slice.mask.bit_length() for bit_slice in bit_slices)
    type_ = unsigned(width)
    if len(bit_slices) == 1:
        bits = _bits_of_slice(bit_slices[0])
        is_whole_byte = isinstance(bits, CName)
        return type_, bits if is_whole_byte else CCast("uint8_t", bits)
    # Bytes are shifted in a type that is not promoted to a signed one.
    work_type = "uint64_t" if width > 32 else "uint32_t"
    shifted_slices: list[CExpression] = []
    for bit_slice in bit_slices:
        wide_bits = CCast(work_type, _bits_of_slice(bit_slice))
        shifted_slices.append(shifted_left(wide_bits, bit_slice.low_in_number))
    number = join_operands("|", tuple(shifted_slices))
    return type_, number if type_ == work_type else CCast(type_, number)


def _bits_of_slice(bit_slice: BitSlice) -> CExpression:
    """Return the bits of a byte that belong to a field, shifted to bit 0, such as ``(bytes[2] >> 3) & 0x07U``."""
    shifted_byte = shifted_right(CName(f"bytes[{bit_slice.byte}]"), bit_slice.low_in_byte)
    # Without bits above the slice, no mask is needed.
    reaches_top = bit_slice.low_in_byte + bit_slice.mask.bit_length() == 8
    return shifted_byte if reaches_top else masked(shifted_byte, bit_slice.mask)


def masked_byte(bits: CExpression, mask: int) -> CExpression:
    """Return the bits of a number in ``mask``. For a whole byte, no mask is needed: a later cast drops higher bits."""
    return bits if mask == 0xFF else masked(bits, mask)


def with_inverted(bits: CExpression, inverted: CExpression | None) -> CExpression:
    """Return the bits, inverted where ``inverted`` has a 1. None means that no bit is inverted."""
    return COperation("^", (bits, inverted)) if inverted is not None else bits


def shift_bits(bits: CExpression, distance: int) -> CExpression:
    """Return ``bits`` shifted to the right, or to the left if ``distance`` is negative."""
    return shifted_left(bits, -distance) if distance < 0 else shifted_right(bits, distance)
