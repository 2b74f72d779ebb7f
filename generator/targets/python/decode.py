"""Decoding of a frame or register: expressions for its checks, its values, its reports and the verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from functools import cached_property

from ...model import Digits, Field, Flag, Piece, Verdict, first_of
from ...model.expressions import Expression
from ...model.lookup import assert_never
from ...model.record import dataclass
from ...plan.codec import Codec, parity
from ...plan.operations import (
    AlwaysIs,
    AtMost,
    Check,
    IsBetween,
    IsOneOf,
    NotAbove,
    ParityIs,
    Part,
    Reserved,
    ZerosAbove,
)
from ...plan.values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans, meaning_of
from ...plan.verdicts import Match, Only, ReportCause, Reporting, VerdictCause
from .bits import Reader
from .literals import Atom, Expr, Not, Operation, Scope, call, coded, grouped, joined, mask, number
from .names import ClassNames


class FrameReports:
    """Reports and verdict of a frame, for its template. ``reporting`` is None if the frame has no reports.

    ``attribute_of`` returns the expression of an attribute of the frame.
    """

    def __init__(
        self,
        reporting: Reporting | None,
        codec: Codec,
        names: ClassNames,
        parameters: Mapping[str, str],
        attribute_of: Callable[[str], str] = "self.{}".format,
    ) -> None:
        self._told = reporting.causes if reporting is not None else ()
        self._judgement = reporting.judgement if reporting is not None else None
        self._reserved, self._names, self._parameters, self._own = codec.reserved, names, parameters, attribute_of

    @property
    def depends(self) -> bool:
        """True if any condition depends on the order code."""
        judged = self._judgement.worst_first if self._judgement is not None else ()
        causes: list[ReportCause | VerdictCause] = [
            *self._told,
            *(cause for _, speakers in judged for cause in speakers),
        ]
        return self._may_be_unknown or any(cause.conditions for cause in causes)

    @property
    def _may_be_unknown(self) -> bool:
        return self._judgement is not None and self._judgement.may_be_unknown

    def _holds(self, only: Only) -> Expr:
        """Return the condition on a parameter of the encoder."""
        return holding(only, f"{self._own('variant')}.{self._parameters[only.parameter]}")

    @property
    def verdict_conditions(self) -> list[tuple[str, list[str]]]:
        """Verdicts that flags or bits of the frame lead to, worst first. Any of a verdict's conditions is enough."""
        if self._judgement is None:
            return []
        conditions = {verdict: self._conditions(items) for verdict, items in self._judgement.worst_first}
        if self._judgement.may_be_unknown:
            conditions[Verdict.UNKNOWN] = [self._has_no_judge(self._judgement.judging_bits)]
        return [(verdict.name, conditions[verdict]) for verdict in Verdict if verdict in conditions]

    def _has_no_judge(self, judging_bits: Expression) -> str:
        """Return the condition that the frames of the encoder have no bits that judge the position."""
        variant = self._own("variant")
        names = {parameter: f"{variant}.{attribute}" for parameter, attribute in self._parameters.items()}
        return f"{Scope(names).of(judging_bits).operand} == 0"

    @property
    def not_usable(self) -> list[str]:
        """Conditions under which the position is not usable."""
        judged = self._judgement.worst_first if self._judgement is not None else ()
        return next((self._conditions(items) for verdict, items in judged if verdict is Verdict.NOT_USABLE), [])

    @property
    def otherwise(self) -> str:
        """Verdict if no condition applies. Empty if the frame has no position."""
        return self._judgement.otherwise.name if self._judgement is not None else ""

    def name_of(self, field: Field) -> str:
        """Return the name of a field's report."""
        causes = (cause for cause in self._told if cause.by.field.name == field.name)
        return first_of(causes, f"report about '{field.name}'").report.name

    def _flag(self, part: Part) -> Expr:
        return Atom(self._own(self._names.attribute(part.field.name)))

    def _differ(self, reserved: Sequence[Reserved]) -> Expr:
        """Return the condition that any of these unused bits differs from the manual."""
        unused = Atom(self._own("unused"))
        all_bits = sum(bits.mask for bits in self._reserved)
        reserved_bits = sum(bits.mask for bits in reserved)
        return unused if reserved_bits == all_bits else Operation(unused, "&", mask(reserved_bits))

    def _conditions(self, causes: Sequence[VerdictCause]) -> list[str]:
        """Return a condition for each flag and each match of values, and one for all unused bits."""
        conditions, reserved = [], []
        for cause in causes:
            if isinstance(cause.by, Reserved):
                reserved.append(cause.by)
            else:
                conditions.append(self._speaks(cause.by, [*map(self._flag, cause.unless)], cause.conditions))
        if reserved:
            conditions.append(str(self._differ(reserved)))
        return conditions

    def _match(self, match: Match) -> list[Expr]:
        """Return a condition for each value of a match."""
        conditions: list[Expr] = []
        for part, value in match.conditions:
            attribute = self._flag(part)
            if isinstance(part.field.kind, Flag):
                conditions.append(attribute if value else Not(attribute))
            else:
                conditions.append(Atom(f"{attribute} == {coded(value)}"))
        return conditions

    def _speaks(self, by: Part | Match, unless: Sequence[Expr], only: Sequence[Only]) -> str:
        """Return the condition for a cause. It is ignored while certain flags are active, and for other order codes."""
        inactive = [Not(joined("or", unless))] if unless else []
        active = self._match(by) if isinstance(by, Match) else [self._flag(by)]
        # The flag comes first, because it is rarely active. The other conditions are then skipped.
        conditions = [*active, *map(self._holds, only), *inactive]
        return str(conditions[0]) if len(conditions) == 1 else f"({joined('and', conditions)})"


def holding(only: Only, member: str) -> Expr:
    """Return the condition that ``member`` of the variant holds for an order code."""
    return Atom(member) if only.holds else Not(Atom(member))


#: Number of bits per CRC table.
TABLE_BITS = 16
#: Maximum length of a frame, in bytes, whose bytes have a name each.
_UNPACKED = 16


@dataclass(frozen=True)
class NamedValues(Scope):
    """Scope that assigns a name to each value that depends on the order code, and records its expression.

    Values that depend on the parameters ``answered`` are not assigned once, since a caller can give other answers.
    """

    answered: frozenset[str] = frozenset()
    named: dict[str, str] = field(default_factory=dict)

    def of(self, value: Expression) -> Expr:
        return self._name("size", value, super().of(value))

    def ones(self, width: Expression) -> Expr:
        return self._name("ones", width, Scope(self.names).ones(width))

    def _name(self, kind: str, value: Expression, expression: Expr) -> Expr:
        if value.is_constant or not self.answered.isdisjoint(value.parameters):
            return expression
        names_by_text = {text: name for name, text in self.named.items()}
        name = names_by_text.get(str(expression), f"{kind}_{len(self.named)}")
        self.named[name] = str(expression)
        return Atom(name)


class Decoder:
    """Expressions in the decoder of a frame or register. ``enum`` returns the name of a field's IntEnum.

    A frame has one decoder for each encoder, in which the values of a Once are computed only once.
    """

    def __init__(self, scope: Scope, codec: Codec, names: ClassNames, enum: Callable[[Field], str]) -> None:
        self.scope, self.codec, self.names, self.enum = scope, codec, names, enum
        self.is_unpacked = (
            isinstance(scope, NamedValues) and codec.in_bytes and not codec.by_word and 1 < codec.length <= _UNPACKED
        )
        self.byte = "b{}" if self.is_unpacked else "data[{}]"
        self.read = Reader(scope, codec, self.byte)

    def number(self, value: Expression) -> Expr:
        return self.scope.of(value)

    @property
    def named(self) -> dict[str, str]:
        """Values that depend on the order code, by name. Complete once the decoder has been printed."""
        return self.scope.named if isinstance(self.scope, NamedValues) else {}

    def local(self, field: Field) -> str:
        """Return the variable for the bits of a field."""
        return f"of_{field.name}" if isinstance(self.scope, NamedValues) else self.names.local(field.name)

    # -- CRC

    @property
    def xor(self) -> str:
        """XOR of all bytes before a CRC that is this XOR. Empty for any other CRC."""
        crc = self.codec.crc
        before = self.codec.length - crc.crc.width // 8 if crc is not None else 0
        if crc is None or not crc.crc.is_xor or before > _UNPACKED:
            return ""
        inverted = [f"0x{crc.inverted:02X}"] if crc.inverted else []
        return " ^ ".join([*(self.byte.format(place) for place in range(before)), *inverted])

    @property
    def crc_covers(self) -> Expr | None:
        """Number of bits before the CRC of a word, for its tables. None if an answer decides it.

        With the start value 0, zeros before the word do not change the CRC, so the longest word has tables for all.
        """
        crc = self.codec.crc
        if crc is None or self.codec.in_bytes:
            return None
        if not crc.crc.init and not crc.is_part:
            return number(self.codec.layout.widest - crc.crc.width)
        answered = self.scope.answered if isinstance(self.scope, NamedValues) else frozenset()
        return Scope(self.scope.names).of(crc.covered) if answered.isdisjoint(crc.covered.parameters) else None

    @property
    def tables(self) -> int:
        """Number of tables for the CRC of a word. 0 if it has none."""
        return -(-self.codec.layout.widest // TABLE_BITS) if self.crc_covers is not None else 0

    @property
    def lookups(self) -> str:
        """XOR of the tables. The word is halved first, because operations on short numbers are faster."""
        shifts = [TABLE_BITS * place for place in range(self.tables - 1)]
        shifted_high = ["high", *(f"high >> {shift}" for shift in shifts[1:])]
        ones = mask((1 << TABLE_BITS) - 1)
        masked_high = [f"{shifted} & {ones}" for shifted in shifted_high[:-1]]
        indices = ["low", *masked_high, *shifted_high[-1:]][: self.tables]
        return " ^ ".join(f"table_{place}[{index}]" for place, index in enumerate(indices))

    @staticmethod
    def listed(name: str, count: int) -> str:
        """Return ``count`` numbered names for a tuple assignment."""
        names = ", ".join(f"{name}{place}" for place in range(count))
        return names + ("," if count == 1 else "")

    # -- first byte of a frame of bytes

    @cached_property
    def heads(self) -> list[tuple[int, int]]:
        """Valid first bytes of a frame whose selector is in the first byte, each with its selector."""
        checks = [check for check in self.codec.checks if self._is_in_first_byte(check)]
        selector = next((check for check in checks if isinstance(check, IsOneOf) and self.selects(check.field)), None)
        if selector is None:
            return []
        valid_bytes = (byte for byte in range(256) if self._passes(checks, byte))
        return [(byte, _bits_in_byte(selector.bits.pieces, byte)) for byte in valid_bytes]

    @property
    def members(self) -> list[tuple[int, str]]:
        """Value of the selector for each valid first byte. Empty if the selector is not an attribute of the frame."""
        selector_part = next((part for part in self.codec.parts if self.selects(part.field)), None)
        if selector_part is None:
            return []
        match meaning_of(selector_part.field):
            case Named(values):
                names = {choice.value: f"{self.enum(selector_part.field)}.{choice.name.upper()}" for choice in values}
                return [(byte, names.get(value, coded(value))) for byte, value in self.heads]
            case Raw() | TwosComplement() | ZeroMeans() | Active() | DigitRuns() | Characters():
                return [(byte, coded(value)) for byte, value in self.heads]
            case meaning:
                assert_never(meaning)

    @property
    def disagreement(self) -> list[str]:
        """Conditions under which a check fails, if the first byte decides most of them. Empty if it does not."""
        if not self.heads:
            return []
        other_checks = [check for check in self.codec.checks if not self._is_in_first_byte(check)]
        if not all(isinstance(check, (AlwaysIs, ZerosAbove)) for check in other_checks):
            return []
        heads = [f"0x{byte:02X}" for byte, _ in self.heads]
        among = "heads" if self.members else f"({', '.join(heads)})"
        head = f"b0 != {heads[0]}" if len(heads) == 1 and not self.members else f"b0 not in {among}"
        # Bits that get a name come first, so that each has one if no condition holds.
        other_checks.sort(key=lambda check: not isinstance(check, ZerosAbove))
        return [*map(self._failing_condition, other_checks), head]

    def _failing_condition(self, check: Check) -> str:
        if isinstance(check, ZerosAbove):
            bits = self.read.of_bytes(check.field.pieces)
            return f"({self.local(check.field)} := {bits}) >> {self.number(check.bits.width).operand}"
        bits = self.read.bits(check.bits)
        return f"{bits.operand} != {mask(check.value)}" if isinstance(check, AlwaysIs) and check.value else str(bits)

    def _is_in_first_byte(self, check: Check) -> bool:
        """Return whether a check depends only on the first byte."""
        if not self.is_unpacked or not isinstance(check, (AlwaysIs, ParityIs, IsOneOf)):
            return False
        covered_bits = check.of_bits if isinstance(check, ParityIs) else ()
        pieces = [*check.bits.pieces, *(piece for bits in covered_bits for piece in bits.pieces)]
        return bool(pieces) and all(piece.byte == 0 for piece in pieces)

    def _passes(self, checks: Sequence[Check], byte: int) -> bool:
        """Return whether a first byte passes all these checks."""
        return all(self._passes_check(check, byte) for check in checks)

    @staticmethod
    def _passes_check(check: Check, byte: int) -> bool:
        bits_in_byte = _bits_in_byte(check.bits.pieces, byte)
        match check:
            case AlwaysIs(value=value):
                return bits_in_byte == value
            case ParityIs(of_bits=covered, odd=odd, mask=counted):
                parts = (_bits_in_byte(bits.pieces, byte) & (counted or -1) for bits in covered)
                return bits_in_byte == sum(parity(part, False) for part in parts) & 1 ^ odd
            case IsOneOf(values=values):
                return bits_in_byte in values
            case _:
                return True

    # -- values

    def selects(self, field: Field) -> bool:
        return field.name == self.codec.layout.selector

    def is_padded(self, field: Field) -> bool:
        """Return whether the bits above the field have already been checked."""
        return any(isinstance(check, ZerosAbove) and check.field is field for check in self.codec.checks)

    def has_name(self, field: Field) -> bool:
        """Return whether the bits of a field have a local name after the checks."""
        checks = [check for check in self.codec.checks if check.field.name == field.name]
        choice_checks = [check for check in checks if isinstance(check, IsOneOf) and len(check.values) > 1]
        is_looked_up = bool(choice_checks) and self.selects(field) and not self.disagreement
        return is_looked_up or any(isinstance(check, (ZerosAbove, AtMost, NotAbove, IsBetween)) for check in checks)

    def bits(self, part: Part) -> Expr:
        """Return the bits of a field after all checks."""
        return Atom(self.local(part.field)) if self.has_name(part.field) else self.read.bits(part.bits)

    def values(self, part: Part) -> list[Expr]:
        """Return the values of a field: one, or one per run of digits."""
        field, bits = part.field, self.bits(part)
        if self.disagreement and self.selects(field):
            return [Atom("heads[b0]")]
        match meaning_of(field):
            case Raw():
                return [bits]
            case TwosComplement():
                return [call("signed", bits, self.number(field.width))]
            case ZeroMeans(stands_for):
                return [_or_if_zero(bits, stands_for)]
            case Active(low):
                return [self._is_active(part, low)]
            case Named() if self.selects(field):
                return [call(self.enum(field), bits)]
            case Named():
                return [Atom(self.local(field))]
            case DigitRuns(runs):
                return [value for _, value in digits(bits, runs)]
            case Characters():
                adjacent = self.read.characters(part.bits)
                return [Atom(f'{adjacent}.decode("latin-1")') if adjacent else _text(field, bits)]
            case meaning:
                assert_never(meaning)

    def _is_active(self, part: Part, low: bool) -> Expr:
        """Return the condition that a flag is active. A flag that the order code does not have is inactive."""
        width = part.field.width
        if not width.is_constant:
            inactive = self.number(width) if low else number(0)
            return Atom(f"{self.bits(part).operand} != {inactive.operand}")
        # A shorter number also contains the lowest bits.
        at = part.bits.low
        is_low = self.tables and not self.codec.gray and at.is_constant and at.constant < TABLE_BITS
        return _bit_test(self.read.bit(part.bits, "low" if is_low else ""), low)

    def all_values(self, encoder_and_answers: Sequence[tuple[str, str]]) -> list[str]:
        """Return the values of all attributes, in order, after the encoder and the answers."""
        values = [str(value) for part in self.codec.parts for value in self.values(part)]
        if self.codec.reserved:
            values.append(str(self.read.unused()))
        elif self.codec.keeps_others:
            values.append(str(self.read.others()))
        return [*(name for name, _ in encoder_and_answers), *values]


def assigned(scope: Scope, names: ClassNames, enum: str, field: Field, bits: Expr) -> Iterator[tuple[str, Expr]]:
    """Yield the attributes of a field of a joined number, with their values. ``enum`` is the name of its IntEnum."""
    name = names.attribute
    match meaning_of(field):
        case Raw():
            yield name(field.name), bits
        case TwosComplement():
            yield name(field.name), call("signed", bits, scope.of(field.width))
        case ZeroMeans(stands_for):
            yield name(field.name), _or_if_zero(bits, stands_for)
        case Active(low):
            yield name(field.name), _bit_test(bits, low)
        case Named():
            yield name(field.name), call("choice", enum, f'"{field.name}"', bits)
        case DigitRuns(runs):
            yield from ((name(run.name), value) for run, value in digits(bits, runs))
        case Characters():
            yield name(field.name), _text(field, bits)
        case meaning:
            assert_never(meaning)


def _bits_in_byte(pieces: Iterable[Piece], byte: int) -> int:
    """Return the number that the pieces of one byte form."""
    return sum((byte >> piece.right & piece.mask) << piece.left for piece in pieces)


def digits(value: Expr, runs: Sequence[Digits]) -> Iterator[tuple[Digits, Expr]]:
    """Yield the runs of decimal digits in a number, each with its value."""
    for run in runs:
        quotient = value if run.divisor == 1 else Operation(value, "//", number(run.divisor))
        yield run, quotient if run is runs[0] else Operation(quotient, "%", number(run.modulus))


def _or_if_zero(bits: Expr, stands_for: int) -> Expr:
    return Atom(f"{bits.operand} or {grouped(stands_for)}")


def _bit_test(bits: Expr, low: bool) -> Expr:
    return Atom(f"not {bits}" if low else f"{bits.operand} != 0")


def _text(field: Field, bits: Expr) -> Expr:
    return Atom(f'{bits.operand}.to_bytes({field.width.constant // 8}, "big").decode("latin-1")')
