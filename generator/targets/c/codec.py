"""The struct of a frame or register, with its decoder, and the encoder with its statements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import chain

from ...model import Biss, Field, Piece, Spi, Ssi, assert_never
from ...model.expressions import Expression
from ...plan.codec import characters
from ...plan.limits import NoPowerOfTwo, OutsideLimits, Refusal, TooWide, depends, refusals
from ...plan.operations import (
    Fixed,
    FrameCrc,
    ParityIs,
    ParityOf,
    ReservedBits,
    Term,
    ValueOfField,
    Whole,
    ZerosAbove,
)
from ...plan.values import (
    Active,
    Characters,
    DigitRuns,
    Named,
    Raw,
    TwosComplement,
    ZeroMeans,
    meaning_of,
    widest_value,
)
from .about import about_bits_crc, about_member, about_unused, about_word_crc
from .comments import Paragraph
from .crc_functions import BitsCrc, WordCrc, folds
from .decode import Decoder
from .enumerations import AlternativeCode, alternatives_in
from .names import (
    Cast,
    Conditional,
    Declared,
    Expr,
    Name,
    Number,
    Operation,
    c_name,
    joined,
    masked,
    number,
    shifted_left,
    shifted_right,
    size_of,
    string,
    unsigned,
)
from .structs import Struct


class Encoder:
    """The operations of an encoder in order, and the expressions in them."""

    def __init__(self, struct: Struct, limits: Sequence[OutsideLimits]) -> None:
        self.struct = struct
        self.plan = struct.plan
        self.reader = struct.reader
        self.refusals = tuple(op for op in (*_powers_first(refusals(self.plan)), *limits) if not _never_applies(op))
        self._parities = frozenset(op.field.name for op in self.plan.checks if isinstance(op, ParityIs))
        self._padded = frozenset(op.field.name for op in self.plan.checks if isinstance(op, ZerosAbove))
        self._reserved = frozenset(op.field.name for op in self.plan.reserved)

    def member_of(self, field: Field) -> Expr:
        """Return the member of the struct that is encoded."""
        return Name(f"in->{c_name(field.name)}")

    # -- values that are refused

    def number(self, field: Field) -> Expr:
        """Return a member as a number, with a cast if it is a flag or of an enumeration."""
        match meaning_of(field):
            case Active():
                needs_cast = True
            case Named():
                needs_cast = self.struct.enumeration(field) is not None
            case Raw() | TwosComplement() | ZeroMeans() | DigitRuns() | Characters():
                needs_cast = False
            case never:
                assert_never(never)
        return Cast("uint32_t", self.member_of(field)) if needs_cast else self.member_of(field)

    def joined(self, whole: Whole) -> Expr:
        return self.reader.joined(whole, self._bits_in_whole)

    def total(self, field: Field) -> Expr:
        """Return the number that a field's runs of digits form."""
        work = unsigned(max(field.widest, 32))
        runs = ((Name(f"in->{c_name(run.name)}"), run.divisor) for run in field.runs)
        return joined("+", tuple(_run_product(work, run, divisor) for run, divisor in runs))

    # -- the word

    @property
    def word(self) -> tuple[Expr, ...]:
        terms = [term for term in self.plan.terms if not isinstance(term.value, ReservedBits)]
        if self.plan.parity_covers_gray:
            terms = [term for term in terms if not isinstance(term.value, ParityOf)]
        variable_terms = (term for term in terms if not self._is_always_zero(term))
        return (*map(self._term, variable_terms), *self.struct.unused.in_word)

    @property
    def parities_of_sent_bits(self) -> tuple[Expr, ...]:
        """Terms that are added to the word once its number in Gray code is converted."""
        if not self.plan.parity_covers_gray:
            return ()
        return tuple(self._term(term) for term in self.plan.terms if isinstance(term.value, ParityOf))

    def _term(self, op: Term) -> Expr:
        value = self._value(op)
        if op.field.low.is_constant and not op.field.low.constant:
            return Cast("uint64_t", value) if isinstance(value, Name) else value
        return shifted_left(Cast("uint64_t", value), self.struct.scope.of(op.field.low))

    def _value(self, op: Term) -> Expr:
        match op.value:
            case Fixed(number):
                return Number(number, hexadecimal=op.field.name not in self._parities)
            case ParityOf(covered_fields, odd, mask) if self.plan.parity_covers_gray:
                ones = self.reader.parity_as_sent(covered_fields, mask)
                return Operation("^", (ones, Number(1))) if odd else ones
            case ParityOf(covered_fields, odd, mask):
                parts = [(self._bits_of_member(field), field.widest) for field in covered_fields]
                if len(parts) == 1 and parts[0][1] <= 32:
                    parts = [(Cast("uint32_t", parts[0][0]), parts[0][1])]
                ones = self.reader.parity(parts, mask)
                bit = Operation("^", (ones, Number(1))) if odd else ones
                has_bit = op.field.width.is_constant
                return bit if has_bit else Operation("&", (bit, self.struct.scope.of(op.field.width)))
            case ValueOfField(field):
                return self._bits_of_member(field)
            case ReservedBits():
                return self.struct.unused.bits_of(op.field)

    def _is_always_zero(self, op: Term) -> bool:
        """Return True if none of its bits is ever set."""
        is_derived = op.field.name in self.plan.constants or op.field.name in self._parities
        return is_derived and op.value == Fixed(0)

    def _bits_in_whole(self, field: Field) -> Expr:
        """Return the bits of a member as an unsigned number. Some compilers give an enumeration a sign."""
        bits = self._bits_of_member(field)
        return Cast(unsigned(field.widest), bits) if isinstance(meaning_of(field), Named) else bits

    def _bits_of_member(self, field: Field) -> Expr:
        if field.name in self._reserved:
            return self.struct.unused.bits_of(field)
        name = self.member_of(field)
        match meaning_of(field):
            case Active(low):
                if low and not field.width.is_constant:
                    # An absent flag is not active, so both are 0.
                    active = Conditional(name, Number(1), Number(0))
                    return Operation(
                        "^", (Cast("uint64_t", active), Cast("uint64_t", self.struct.scope.of(field.width)))
                    )
                return Conditional(name, *((Number(0), Number(1)) if low else (Number(1), Number(0))))
            case TwosComplement():
                return Operation("&", (Cast("uint64_t", name), self.struct.scope.mask(field.width)))
            case ZeroMeans(number):
                return Conditional(Operation("==", (name, Number(number))), Number(0), name)
            case Raw() | Named() | DigitRuns() | Characters():
                return name
            case never:
                assert_never(never)

    # -- the bytes

    @property
    def bytes(self) -> Iterator[tuple[int, Expr]]:
        """The value of each byte, except those of the CRC."""
        members = self._member_bytes()
        crc_bytes = self._crc_bytes()
        for byte, constant_byte in self._constant_bytes().items():
            if byte in members:
                constant = [Number(constant_byte, hexadecimal=True)] if constant_byte else []
                yield byte, _as_byte(joined("|", (*constant, *members[byte])))
            elif byte not in crc_bytes:
                yield byte, Number(constant_byte, hexadecimal=True)

    def _crc_bytes(self) -> set[int]:
        """Return the bytes of a CRC that is computed over whole bytes."""
        crc = self.plan.only_crc
        if crc is None or not self.plan.layout.crc_covers_bytes:
            return set()
        return {piece.byte for piece in crc.bits.pieces}

    def _constant_bytes(self) -> dict[int, int]:
        """Return the constant bits of every byte."""
        constants = dict.fromkeys(range(self.plan.length), 0)
        for op in self.plan.terms:
            match op.value:
                case Fixed(value):
                    for piece in op.field.pieces:
                        constants[piece.byte] |= (value >> piece.left & piece.mask) << piece.right
        return constants

    def _member_bytes(self) -> dict[int, list[Expr]]:
        """Return what members and parity bits contribute to each byte."""
        contributions: dict[int, list[Expr]] = {}
        for byte, bits in chain(self.struct.unused.in_bytes, *map(self._term_bytes, self.plan.terms)):
            contributions.setdefault(byte, []).append(bits)
        return contributions

    def _term_bytes(self, op: Term) -> Iterator[tuple[int, Expr]]:
        """Yield the contributions of a term that is not constant."""
        match op.value:
            case ReservedBits() | Fixed():
                return
            case ValueOfField(field):
                yield from self._given_bytes(op, field)
            case ParityOf():
                for piece in op.field.pieces:
                    yield piece.byte, shifted_left(shifted_right(self._value(op), piece.left), piece.right)
            case _:
                assert_never(op.value)

    def _given_bytes(self, op: Term, field: Field) -> Iterator[tuple[int, Expr]]:
        """Yield the contributions of a member to its bytes."""
        name = self.member_of(field)
        match meaning_of(field):
            case Characters():
                for index, byte in characters(field):
                    yield byte, Cast("uint8_t", Name(f"{name}[{index}]"))
            case Active(low):
                for piece in field.pieces:
                    bit, zero = Number(piece.mask << piece.right, hexadecimal=True), Number(0, hexadecimal=True)
                    yield piece.byte, Conditional(name, zero, bit) if low else Conditional(name, bit, zero)
            case TwosComplement():
                # Copies of the sign must not reach the zeros above the field.
                bits = self._value(op) if field.name in self._padded else Cast("uint64_t", name)
                for piece in field.pieces:
                    yield piece.byte, self._placed_piece(field, piece, bits, may_be_wider=True)
            case Raw() | ZeroMeans() | Named() | DigitRuns():
                for piece in field.pieces:
                    if piece.left < size_of(widest_value(field)):
                        yield (
                            piece.byte,
                            self._placed_piece(field, piece, self._value(op), may_be_wider=len(field.pieces) > 1),
                        )
            case never:
                assert_never(never)

    def _placed_piece(self, field: Field, piece: Piece, bits: Expr, may_be_wider: bool) -> Expr:
        """Return one piece of the bits of a field, shifted to its place in its byte."""
        value = shifted_right(bits, piece.left)
        if may_be_wider and piece.mask != 0xFF:
            value = masked(value, piece.mask)
        if piece.right:
            return shifted_left(Cast("uint32_t", value), piece.right)
        is_wide = isinstance(value, Name) and self.struct.type_of(field) != unsigned(8)
        return Cast("uint32_t", value) if is_wide else value


def _as_byte(value: Expr) -> Expr:
    """Cast a value to a byte. A one-byte member needs no cast."""
    if isinstance(value, Name):
        return value
    return Cast("uint8_t", value.value if isinstance(value, Cast) and isinstance(value.value, Name) else value)


def _run_product(type_: str, run: Expr, divisor: int) -> Expr:
    return Operation("*", (Cast(type_, run), Number(divisor))) if divisor > 1 else run


def _powers_first(ops: Iterable[Refusal]) -> list[Refusal]:
    """Move checks for a power of two before checks of the width. Both give the same error."""
    ordered: list[Refusal] = []
    for op in ops:
        ordered.insert(len(ordered) - isinstance(op, NoPowerOfTwo), op)
    return ordered


def _never_applies(op: Refusal) -> bool:
    """Return True if no value of the member's type would be refused."""
    return isinstance(op, TooWide) and op.width.is_constant and size_of(op.field.widest) == op.field.widest


class StructCodec:
    """The values that the templates print for a layout. ``about`` describes a frame and is empty for a register."""

    def __init__(self, struct: Struct, about: Sequence[Paragraph] = (), outside: Sequence[OutsideLimits] = ()) -> None:
        self.struct = struct
        self.plan = struct.plan
        self.scope = struct.scope
        self.name, self.type = struct.name, struct.type
        self.length_macro = struct.length_macro
        self.about = tuple(about)
        self.decoder = Decoder(struct)
        self.encoder = Encoder(struct, outside)
        questions = struct.context.alternatives
        self.alternatives = tuple(question for question in questions if question.item in self.plan.alternatives)
        #: Whether a program that talks to an encoder decodes it, and encodes it. A simulator does the rest.
        self.decodes = struct.register is not None or struct.layout.sender == "encoder"
        self.encodes = struct.register is not None or not self.decodes
        #: The reports of a frame, None for a register.
        self.reports = (
            struct.context.reports.of(struct.layout, self.name, self.type) if struct.register is None else None
        )

    def declared(self) -> Iterator[Declared]:
        yield from ((name, self.struct.path) for name in self._names())

    def _names(self) -> Iterator[str]:
        yield self.type
        yield from (f"{self.name}_{ending}" for ending in ("decode", "encode"))
        if not self.plan.in_bytes:
            yield f"{self.name}_bits"
        elif self.about:
            yield self.length_macro
        yield from (scale.name for scale in self.struct.scales)
        yield from (f"{self.name}_set_{name}" for name in self.set_names)
        yield from self.reports.names() if self.reports is not None else ()
        if self.word_crc is not None:
            yield self.word_crc.name
        yield from (bits_crc.name for bits_crc in self.bits_crcs.values())
        if self.measured:
            yield f"{self.name}_position"
        if self.is_received:
            yield f"{self.name}_receive"
        if self.is_read:
            yield f"{self.name}_read"
        if self.tells_difference:
            yield f"{self.name}_is_expected"
            yield from (self.expected_macro(field) for field in self.expected if self.has_one_value(field))

    @property
    def measured(self) -> str:
        """The field or join with the position that a function returns, or an empty text if there is no such function.

        A frame has it if its verdict is known.
        """
        context, layout = self.struct.context, self.struct.layout
        measurement = context.device.measurement_of(context.interface.name)
        has_verdict = self.reports is not None and bool(self.reports.verdict)
        if measurement is None or layout.sender != "encoder" or not has_verdict:
            return ""
        return measurement.of if measurement.of in layout.member_names else ""

    @property
    def receiver(self) -> str:
        """The function of the runtime that extracts the frame from a buffer, empty if a port receives its bytes."""
        if self.struct.register is not None or not self.decodes:
            return ""
        match self.struct.context.interface:
            case Biss() | Ssi() as interface:
                return f"cw_{interface.name}_receive" + ("_frame" if self.plan.in_bytes else "")
            case Spi() if not self.plan.in_bytes:
                return "cw_spi_load"
            case _:
                return ""

    @property
    def is_received(self) -> bool:
        """True if a function extracts the word of the frame from a buffer."""
        return bool(self.receiver) and not self.plan.in_bytes

    @property
    def is_read(self) -> bool:
        """True if a function returns the position from a buffer."""
        return bool(self.measured and self.receiver)

    @property
    def length_alternatives(self) -> tuple[AlternativeCode, ...]:
        """The alternatives on whose answers the length of the frame depends."""
        return self.alternatives_for(self.plan.layout.bits)

    @property
    def word_has_length(self) -> bool:
        """True if the decoder takes a word with its length, because not all words of the frame have the same length."""
        return self.is_received and not self.plan.layout.bits.is_constant

    @property
    def word_type(self) -> str:
        """The type of the word that the decoder takes."""
        return "cw_word" if self.word_has_length else "uint64_t"

    @property
    def word_parameter(self) -> str:
        """The word as a parameter of functions that pass it on to the decoder."""
        return self.struct.context.passing.parameter("cw_word", "word") if self.word_has_length else "uint64_t word"

    @property
    def order_of_bytes(self) -> str:
        """The order of several bytes, for the comments on the decoder and the encoder."""
        if self.plan.length < 2:
            return ""
        if not self.about:
            return ", lowest address first"
        order = self.struct.layout.byte_order.replace("_", " ")
        return f" in the order sent, {order}"

    @property
    def about_unused(self) -> str:
        return about_unused(self.struct)

    def about_member(self, field: Field) -> str:
        return about_member(self.struct, field)

    @property
    def set_names(self) -> tuple[str, ...]:
        """The members that other members repeat."""
        decimal = (part.field.name for part in self.plan.parts if part.field.runs)
        return (*(whole.join.name for whole in self.plan.wholes), *decimal)

    @cached_property
    def word_crc(self) -> WordCrc | None:
        """The function that computes the CRC of a whole word."""
        crc, bits = self.plan.only_crc, self.plan.layout.widest
        # Its register has 32 bits.
        if crc is None or not crc.divides or crc.crc.width > 32:
            return None
        steps = tuple(folds(crc.steps, bits, "word")) if crc.steps else ()
        about = tuple(about_word_crc(self.struct.device, crc.crc, bool(steps)))
        return WordCrc(f"{self.name}_crc", self.struct.crc_function(crc), crc.crc, bits, steps, about)

    @property
    def bits_crcs(self) -> dict[str, BitsCrc]:
        """The functions that compute the CRCs of a frame of bits in bytes, by the name of the field."""
        if not self.plan.in_bytes or self.plan.layout.crc_covers_bytes:
            return {}
        return {crc.field.name: self._bits_crc(crc) for crc in self.plan.crcs}

    def _bits_crc(self, crc: FrameCrc) -> BitsCrc:
        name = f"{self.name}_{crc.field.name}_crc" if crc.is_optional else f"{self.name}_crc"
        about = tuple(about_bits_crc(self.struct.device, crc.crc))
        return BitsCrc(name, crc.crc, crc.covered.constant, unsigned(crc.crc.width), about)

    def alternatives_for(self, *expressions: Expression) -> tuple[AlternativeCode, ...]:
        """Return the alternatives whose answers these expressions need."""
        return alternatives_in(self.alternatives, *expressions)

    @property
    def decoder_depends(self) -> bool:
        """True if the decoder uses the variant."""
        return self.plan.depends or not self.plan.in_bytes

    @property
    def encoder_depends(self) -> bool:
        """True if the encoder uses the variant."""
        plan = self.plan
        if self.alternatives and not plan.depends:
            return False
        return (
            (plan.gray is not None and plan.gray.depends)
            or any(op.depends for op in plan.terms)
            or self.struct.unused.depends
            or any(depends(op) for op in self.encoder.refusals)
            or any(map(self._crc_depends, plan.crcs))
        )

    def _crc_depends(self, crc: FrameCrc) -> bool:
        """Return whether the variant decides if the frame has the CRC, or how many bits the encoder passes to it."""
        covers_other_bits = not self.plan.in_bytes and self.word_crc is None and not crc.covered.is_constant
        return crc.is_optional or covers_other_bits

    # -- values of fields that the manual states

    @property
    def expected(self) -> tuple[Field, ...]:
        return tuple(part.field for part in self.plan.parts if part.field.equals is not None)

    @property
    def tells_difference(self) -> bool:
        """True if a valid frame can differ from the manual."""
        return bool(self.expected or self.struct.unused)

    @staticmethod
    def has_one_value(field: Field) -> bool:
        """Return True if the manual states one value for all order codes."""
        return not isinstance(field.equals, Expression) or field.equals.is_constant

    @property
    def expected_depends(self) -> bool:
        return not all(map(self.has_one_value, self.expected))

    def expected_value(self, field: Field) -> str:
        match field.equals:
            case str(text):
                return string(text)
            case Expression(constant):
                return number(constant)
            case _:
                return number(field.equals or 0, hexadecimal=True)

    def expected_macro(self, field: Field) -> str:
        return f"{self.name}_{field.name}_EXPECTED".upper()

    @property
    def is_expected(self) -> Expr:
        """Condition that a struct has the values of the manual."""
        unused = [Operation("==", (Name("in->unused"), Number(0)))] if self.struct.unused else []
        return joined(
            "&&", (*(condition for field in self.expected for condition in self._is_expected(field)), *unused)
        )

    def _is_expected(self, field: Field) -> Iterator[Expr]:
        name, macro = f"in->{c_name(field.name)}", self.expected_macro(field)
        match field.equals:
            case str(text):
                for index in range(len(text.encode("ascii", "replace"))):
                    yield Operation("==", (Name(f"{name}[{index}]"), Name(f"{macro}[{index}]")))
            case Expression() as equals if not equals.is_constant:
                yield Operation("==", (Name(name), self.scope.of(equals)))
            case _:
                yield Operation("==", (Name(name), Name(macro)))
