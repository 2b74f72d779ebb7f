"""Names, types and expressions in C: those that are reserved, those that a header declares, and trees of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import prod

from ...language.document import Path
from ...model.expressions import Expression, Factor, Term
from ...model.record import dataclass
from .. import TargetError

#: The keywords of C up to C23, of C++ up to C++26 and its technical specifications, and of common compilers,
#: as far as they can be names in a spec.
_KEYWORDS = """
    alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor bool break case
    catch char char16_t char32_t char8_t class co_await co_return co_yield compl concept const const_cast consteval
    constexpr constinit continue contract_assert decltype default delete do double dynamic_cast else enum explicit
    export extern false final float for fortran friend goto if import inline int long module mutable namespace new
    noexcept not not_eq nullptr operator or or_eq override private protected public reflexpr register
    reinterpret_cast requires restrict return short signed sizeof static static_assert static_cast struct switch
    synchronized template this thread_local throw true try typedef typeid typename typeof typeof_unqual union
    unsigned using virtual void volatile wchar_t while xor xor_eq
"""
#: Types and macros of the three headers that the generated ones include.
_SIZES = [f"{speed}{bits}" for speed in ("", "_least", "_fast") for bits in (8, 16, 32, 64)]
_SIZED_TYPES = " ".join(f"{sign}int{size}_t" for sign in ("", "u") for size in _SIZES)
_TYPES = (
    "intmax_t intptr_t max_align_t nullptr_t offsetof ptrdiff_t size_t uintmax_t uintptr_t unreachable " + _SIZED_TYPES
)
#: Object-like macros of compilers, and of headers of C, Windows, Qt, POSIX and small processors.
_MACROS = """
    assert bool cdecl complex emit environ errno far foreach forever fortran hpux huge hyper i386 i860 i960
    imaginary interface interrupt linux m68k math_errhandling max mc68000 min mips near noreturn pascal pdp11 pixel
    powerpc quad sgi signals signgam slots small sparc stdcall stderr stdin stdout sun timezone tzname ultrix unix
    vax vector vms
"""
#: Functions for double. avr-libc maps the names with an f at the end to them.
_DOUBLE_FUNCTIONS = """
    acos asin atan atan2 cbrt ceil copysign cos cosh exp fabs fdim floor fma fmax fmin fmod frexp hypot isfinite
    isinf isnan ldexp log log10 lrint lround pow round signbit sin sinh sqrt square strtod tan tanh trunc
"""
_MATH = " ".join(f"{name}f" for name in _DOUBLE_FUNCTIONS.split())
RESERVED = frozenset(f"{_KEYWORDS} {_TYPES} {_MACROS} {_MATH}".split())

#: Folder of the headers, and the folder in which they are installed.
FOLDER = "codewheel"
#: Prefix of all names in the headers. No name from a spec begins like this.
PREFIX = "cw_"
#: Names that no manufacturer can have, because the runtime uses them.
TAKEN = (FOLDER, PREFIX.rstrip("_"))


def errata_page_name(maker: str) -> str:
    """Return the file name of the page with the errata of a manufacturer."""
    return f"ERRATA-{maker}.md"


def c_name(name: str, taken_names: Iterable[str] = ()) -> str:
    """Return ``name`` as the name of a member or argument, with ``_`` at its end if it is reserved or taken."""
    is_reserved = name in RESERVED or name in taken_names or name.startswith(PREFIX)
    return f"{name}_" if is_reserved else name


#: A name at file scope, and the part of the spec that it comes from, empty for names that every header has.
#: Each part of a header lists its names in ``declared()``.
DeclaredName = tuple[str, Path]


_PLAIN_CHARACTERS = frozenset(letter for letter in map(chr, range(0x20, 0x7F)) if letter not in '"\\?')


def string(text: object) -> str:
    """Return ``text`` as a string literal."""
    return '"' + "".join(map(_escape_character, str(text).encode("utf-8"))) + '"'


def _escape_character(byte: int) -> str:
    """Return a byte as a character of a string literal, in octal unless it is printable and plain in C."""
    return chr(byte) if chr(byte) in _PLAIN_CHARACTERS else f"\\{byte:03o}"


def c_number(value: int, hexadecimal: bool = False, digits: int = 2) -> str:
    """Return ``value`` as an unsigned constant, such as ``24U``, ``0x1BU`` or ``UINT64_C(4294967296)``.

    ``digits`` is the minimum number of hexadecimal digits. With more than 8, the constant has 64 bits.
    """
    literal = f"0x{value:0{digits}X}" if hexadecimal else str(value)
    has_64_bits = value > 0xFFFFFFFF or (hexadecimal and digits > 8)
    return f"UINT64_C({literal})" if has_64_bits else f"{literal}U"


def signed_number(value: int) -> str:
    """Return ``value`` as a signed constant, such as ``24``, ``(-24)`` or ``INT64_C(40000)`` above 7FFFh."""
    # An int can have 16 bits.
    magnitude = f"INT64_C({abs(value)})" if abs(value) > 0x7FFF else str(abs(value))
    return f"(-{magnitude})" if value < 0 else magnitude


def mask_constant(width: int) -> str:
    """Return a constant whose lowest ``width`` bits are 1."""
    return c_number((1 << width) - 1, hexadecimal=True)


def size_of(bits: int) -> int:
    """Return the width of the smallest integer type for ``bits`` bits: 8, 16, 32 or 64.

    Raises:
        TargetError: There are more than 64 bits.
    """
    for size in (8, 16, 32, 64):
        if bits <= size:
            return size
    raise TargetError(f"a number of {bits} bits; the C target holds numbers of at most 64 bits")


def signed(bits: int) -> str:
    """Return the smallest signed type for ``bits`` bits."""
    return f"int{size_of(bits)}_t"


def unsigned(bits: int) -> str:
    """Return the smallest unsigned type for ``bits`` bits."""
    return f"uint{size_of(bits)}_t"


class CExpression:
    """A C expression. Its text is its ``str``."""

    __slots__ = ()

    @property
    def operand(self) -> str:
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
        return f"({self.type}){self.value.operand}"


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
        operand_texts = [str(leftmost) if continues_sum else leftmost.operand]
        operand_texts += [operand.operand for operand in others]
        return f" {self.operator} ".join(operand_texts)

    @property
    def operand(self) -> str:
        return f"({self})"


@dataclass(frozen=True, slots=True)
class Conditional(CExpression):
    """One of two values, depending on a condition."""

    condition: CExpression
    value_if_true: CExpression
    value_if_false: CExpression

    def __str__(self) -> str:
        return f"{self.condition.operand} ? {self.value_if_true.operand} : {self.value_if_false.operand}"

    @property
    def operand(self) -> str:
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
class ParameterSpelling:
    """How C expresses the parameters of an order code, such as the number of position bits.

    A parameter that the order code sets is a member of the variant. ``largest`` contains its highest value. Other
    parameters are functions of the variant. If a parameter depends on a question that the manual leaves open, it is a
    function of the user's answer, and ``answers`` contains the name of that argument.
    """

    prefix: str
    largest: Mapping[str, int]
    answers: Mapping[str, str]
    passing: StructPassing = BY_VALUE

    def express_parameter(self, parameter: str) -> CExpression:
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
        return CCall("cw_mask", (self.expression_of(width),))

    def expression_of(self, expression: Expression) -> CExpression:
        """Return an expression of the spec as C, unsigned, such as ``8U + variant.position_bits - 1U``.

        What is added comes first, so that no intermediate result is negative unless the result is.
        """
        match expression:
            case Expression(constant=-1, terms=(Term(multiple=1, factors=(Factor(parameter=exponent, power=True),)),)):
                # 2 to the power of the parameter, minus 1.
                return CCall("cw_mask", (self.express_parameter(exponent),))
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

    def signed(self, expression: Expression) -> CExpression:
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
                product: CExpression = CCall("cw_mask", (self.express_parameter(exponent.parameter),))
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
        parameter = self.express_parameter(factor.parameter)
        return COperation("<<", (CCast("uint64_t", CNumber(1)), parameter)) if factor.power else parameter
