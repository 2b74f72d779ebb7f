"""Names, types and expressions in C: those that are reserved, those that a header declares, and trees of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from math import prod

from ...language.document import Path
from ...model import Device, Layout
from ...model.expressions import Expression, Factor, Term
from ...model.record import dataclass
from .. import TargetError
from .reserved_words import RESERVED

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


_SECTION_IN_WORDS = {
    "alarms": "the alarm",
    "alternatives": "the alternative",
    "crcs": "the CRC",
    "device": "the family",
    "layouts": "the layout",
    "order_code": "the order code",
    "parameters": "the parameter",
    "parts": "the part of the order code",
    "procedures": "the procedure",
    "registers": "the register",
    "timings": "the timing",
}


#: A name at file scope, and the part of the spec that it comes from, empty for names that every header has.
#: Each part of a header lists its names in ``declared()``.
DeclaredName = tuple[str, Path]


@dataclass(frozen=True)
class NameClash:
    """Two parts of a spec with the same name in C. ``other`` is empty for names that every header has."""

    name: str
    path: Path
    other: Path

    def message(self, where: str = "") -> str:
        """Return the problem and its fix. ``where`` gives the place of the other part, as in `` on line 5``."""
        if not self.other:
            return f"its C name {self.name} is already used by the headers; rename it"
        return f"its C name {self.name} is also that of {describe_path(self.other)}{where}; rename one of the two"


def describe_path(path: Path) -> str:
    """Describe a part of the spec in words: ``the register 'status'`` for ``("registers", "status")``.

    Its kind is the last step of the path that has a word here, or else the first step.
    """
    kind = next((step for step in reversed(path) if step in _SECTION_IN_WORDS), path[0])
    kind_in_words = _SECTION_IN_WORDS.get(str(kind), str(kind))
    name = path[-1]
    # A path such as ("order_code",) has no name.
    return f"{kind_in_words} '{name}'" if name != kind else kind_in_words


class HeaderNames:
    """The names of one header. A name belongs to the first part that declares it. Any other part is a clash."""

    def __init__(self, declared: Iterable[DeclaredName]) -> None:
        self.paths: dict[str, Path] = {}
        self.clashes: list[NameClash] = []
        for name, path in declared:
            if name not in self.paths:
                self.paths[name] = path
            elif path:
                self.clashes.append(NameClash(name, path, self.paths[name]))
            else:
                # Every header declares this name, so the earlier part is the one to rename.
                self.clashes.append(NameClash(name, self.paths[name], ()))


def inner_names(device: Device) -> Iterator[tuple[str, Path]]:
    """Yield the C names of members, arguments and locals, and the part of the spec that each comes from.

    The same name can come several times, because each has a scope of its own.
    """
    for parameter in device.parameters:
        yield c_name(parameter.name), ("parameters", parameter.name)
    paths_and_layouts: list[tuple[Path, Layout]] = []
    for interface, layout in device.layouts():
        paths_and_layouts.append((("interfaces", interface.name, "layouts", layout.name), layout))
    paths_and_layouts += [(("registers", register.name), register.layout) for register in device.registers]
    for path, layout in paths_and_layouts:
        yield from ((c_name(field.name), path) for field in layout.fields)
        for field in layout.fields:
            yield from ((c_name(run.name), path) for run in field.runs)
        yield from ((c_name(join.name), path) for join in layout.joins)
    for register in device.registers:
        yield c_name(register.name), ("registers", register.name)
    for procedure in device.procedures:
        yield from ((c_name(argument.name), ("procedures", procedure.name)) for argument in procedure.arguments)


def clashes(headers: Iterable[tuple[Device, HeaderNames]]) -> Iterator[tuple[Device, NameClash]]:
    """Yield every clash within these headers, and between families, with the device in whose spec it is.

    An inner name clashes with a name that an earlier header or its own declares at file scope. The name of a
    manufacturer clashes if it is one of ``TAKEN``.
    """
    declared_paths: dict[str, Path] = {}
    for device, names in headers:
        if device.manufacturer.name in TAKEN:
            yield device, NameClash(device.manufacturer.name, ("manufacturer",), ())
        for clash in names.clashes:
            yield device, clash
        for name, path in names.paths.items():
            if name in declared_paths:
                yield device, NameClash(name, path or ("device",), declared_paths[name])
            # For the families that follow, a name belongs to the family rather than to a part of it.
            declared_paths[name] = ("device", device.name)
        for name, path in inner_names(device):
            if name in declared_paths:
                yield device, NameClash(name, path, ())


_PLAIN_CHARACTERS = frozenset(letter for letter in map(chr, range(0x20, 0x7F)) if letter not in '"\\?')


def string(text: object) -> str:
    """Return ``text`` as a string literal."""
    return '"' + "".join(map(_escape_character, str(text).encode("utf-8"))) + '"'


def _escape_character(byte: int) -> str:
    """Return a byte as a character of a string literal, in octal if it has another meaning in C or in a trigraph."""
    return chr(byte) if chr(byte) in _PLAIN_CHARACTERS else f"\\{byte:03o}"


def c_number(value: int, hexadecimal: bool = False, digits: int = 2) -> str:
    """Return ``value`` as an unsigned constant, such as ``24U``, ``0x1BU`` or ``UINT64_C(4294967296)``.

    ``digits`` is the least number of hexadecimal digits. More than 8 digits also make it a constant of 64 bits.
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
    return f"int{size_of(bits)}_t"


def unsigned(bits: int) -> str:
    """Return the smallest unsigned type for ``bits`` bits."""
    return f"uint{size_of(bits)}_t"


class CExpression:
    """C expression, whose text is its ``str``."""

    __slots__ = ()

    @property
    def operand(self) -> str:
        """The text to use inside an operation, or after a cast."""
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
    function: str
    arguments: tuple[CExpression, ...]

    def __str__(self) -> str:
        return f"{self.function}({', '.join(map(str, self.arguments))})"


@dataclass(frozen=True, slots=True)
class CCast(CExpression):
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
    """One of two values: the first if the condition holds."""

    condition: CExpression
    then: CExpression
    otherwise: CExpression

    def __str__(self) -> str:
        return f"{self.condition.operand} ? {self.then.operand} : {self.otherwise.operand}"

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
    if not isinstance(expression, COperation):
        return False
    return expression.operator == "*" or any(map(_has_product, expression.operands))


def masked(value: CExpression, mask: int) -> CExpression:
    return COperation("&", (value, CNumber(mask, hexadecimal=True)))


def join_operands(operator: str, operands: tuple[CExpression, ...]) -> CExpression:
    """Return the operands joined by an operator, or the only operand."""
    return operands[0] if len(operands) == 1 else COperation(operator, operands)


@dataclass(frozen=True, slots=True)
class StructPassing:
    """The spelling of structures that functions receive: by value, or by address for compilers that cannot do this."""

    by_address: bool = False

    def parameter(self, type_: str, name: str) -> str:
        return f"const {type_} *{name}" if self.by_address else f"{type_} {name}"

    def argument(self, structure: str) -> str:
        return f"&{structure}" if self.by_address else structure

    def member(self, parameter: str, member: str) -> str:
        return f"{parameter}{'->' if self.by_address else '.'}{member}"


BY_VALUE = StructPassing()
BY_ADDRESS = StructPassing(by_address=True)


@dataclass(frozen=True)
class ParameterSpelling:
    """The spelling of parameters: set parameters are members of the variant, others are functions of it.

    ``largest`` contains the highest values of the parameters that an order code sets. A parameter that depends on an
    alternative of the manual is a function of the argument that ``answers`` names.
    """

    prefix: str
    largest: Mapping[str, int]
    answers: Mapping[str, str]
    passing: StructPassing = BY_VALUE

    def express_parameter(self, parameter: str) -> CExpression:
        """Return a parameter: a function of an answer, a member of the variant, or a function of the variant."""
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
        """Return a mask of ``width`` 1 bits."""
        if width.is_constant:
            return CNumber((1 << width.constant) - 1, hexadecimal=True)
        return CCall("cw_mask", (self.expression_of(width),))

    def expression_of(self, expression: Expression) -> CExpression:
        """Return the expression in C, unsigned, such as ``8U + variant.position_bits - 1U``.

        No intermediate result is negative unless the result is.
        """
        match expression:
            case Expression(-1, (Term(1, (Factor(exponent, True),)),)):
                # 2 to the power of the parameter, minus 1.
                return CCall("cw_mask", (self.express_parameter(exponent),))
        # Terms with positive multiples come first, so that no intermediate result is negative.
        added = [self._express_term(term) for term in expression.terms if term.multiple > 0]
        subtracted = [self._express_term(term) for term in expression.terms if term.multiple < 0]
        is_single_operand = len(expression.terms) == 1 and expression.constant >= 0
        if expression.constant > 0 or not added:
            # Without terms to add, the subtraction begins with 0.
            added.insert(0, CNumber(max(expression.constant, 0)))
        elif isinstance(added[0], CName) and not is_single_operand:
            # The member can have 8 bits, which would be promoted to a signed type.
            added[0] = CCast("uint32_t", added[0])
        if expression.constant < 0:
            subtracted.append(CNumber(-expression.constant))
        return join_operands("-", (join_operands("+", tuple(added)), *subtracted))

    def signed(self, expression: Expression) -> CExpression:
        """Return the expression in 64 bits with a sign.

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
        """Return the product of a term without its sign, in 64 bits if 32 may be too few.

        A single parameter keeps its own type. A power of two has 64 bits already.
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
        name = self.express_parameter(factor.parameter)
        return COperation("<<", (CCast("uint64_t", CNumber(1)), name)) if factor.power else name
