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
    Check,
    FrameCrc,
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

    @property
    def reasons(self) -> dict[str, list[str]]:
        """Meaning of each flag or other cause that leads to a verdict, by the name of the verdict."""
        judged = self._judgement.worst_first if self._judgement is not None else ()
        return {verdict.name: list(dict.fromkeys(map(_reason, causes))) for verdict, causes in judged}

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


def _reason(cause: VerdictCause) -> str:
    """Return the meaning of a cause while it is active, for a comment."""
    if isinstance(cause.by, Reserved):
        return "unused: bits that the manual leaves unused differ from it."
    by_field = cause.by.field
    active = by_field.kind.when_active if isinstance(by_field.kind, Flag) else ""
    # Texts of the spec can have several lines.
    text = " ".join((active or by_field.meaning).split()) or "active"
    return f"{by_field.name}: {text.rstrip('.')}."


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
    preferred: dict[tuple[str, str], str] = field(default_factory=dict)
    comments: dict[str, str] = field(default_factory=dict)

    def of(self, value: Expression) -> Expr:
        return self._name("size", value, super().of(value))

    def ones(self, width: Expression) -> Expr:
        return self._name("ones", width, Scope(self.names).ones(width))

    def _name(self, kind: str, value: Expression, expression: Expr) -> Expr:
        if value.is_constant or not self.answered.isdisjoint(value.parameters):
            return expression
        text = str(expression)
        names_by_text = {named_text: name for name, named_text in self.named.items()}
        name = names_by_text.get(text) or self.preferred.get((kind, text), f"{kind}_{len(self.named)}")
        self.named[name] = text
        return Atom(name)

    def prefer(self, name: str, kind: str, value: Expression, comment: str = "") -> None:
        """Use ``name`` for a value, if it needs a name and has none. ``kind`` is ``size`` or ``ones``."""
        if value.is_constant:
            return
        scope = Scope(self.names)
        text = str(scope.of(value) if kind == "size" else scope.ones(value))
        self.preferred.setdefault((kind, text), name)
        if comment and self.preferred[kind, text] == name:
            self.comments[name] = comment


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
        #: Fields whose bits have a variable at this point of the function.
        self.assigned: set[str] = set()
        if isinstance(scope, NamedValues):
            self._prefer_names(scope)

    def _prefer_names(self, scope: NamedValues) -> None:
        """Name the positions, widths and masks that depend on the order code by their fields."""
        codec = self.codec
        runs = [run for member in codec.layout.fields for run in member.runs]
        taken = {self.local(member) for member in codec.layout.fields} | {self.local(run) for run in runs}

        def free(name: str) -> str:
            name = self.names.local(name)
            while name in taken:
                name += "_"
            taken.add(name)
            return name

        scope.prefer("frame_bits", "size", codec.layout.bits, sum_comment(codec, codec.layout.bits))
        for member in codec.layout.fields:
            scope.prefer(free(f"{member.name}_bits"), "size", member.width)
            scope.prefer(free(f"{member.name}_low"), "size", member.low, sum_comment(codec, member.low))
            scope.prefer(free(f"{member.name}_mask"), "ones", member.width)
        for check in codec.checks:
            if isinstance(check, (NotAbove, IsBetween)):
                scope.prefer(free(f"highest_{check.field.name}"), "size", check.highest)
            if isinstance(check, IsBetween):
                scope.prefer(free(f"lowest_{check.field.name}"), "size", check.lowest)
        if codec.gray is not None:
            scope.prefer(free("gray_low"), "size", codec.gray.low)
            scope.prefer(free("gray_bits"), "size", codec.gray.width)
            scope.prefer(free("gray_excess"), "size", codec.gray.excess)

    def number(self, value: Expression) -> Expr:
        return self.scope.of(value)

    @property
    def named(self) -> dict[str, str]:
        """Values that depend on the order code, by name. Complete once the decoder has been printed."""
        return self.scope.named if isinstance(self.scope, NamedValues) else {}

    @property
    def comments(self) -> dict[str, str]:
        """Comments on the named values, by name."""
        return self.scope.comments if isinstance(self.scope, NamedValues) else {}

    def local(self, field: Field | Digits) -> str:
        """Return the variable for the value of a field."""
        return self.names.local(field.name)

    # -- variables

    def start(self) -> str:
        """Forget all variables, at the beginning of a function."""
        self.assigned.clear()
        return ""

    def enter(self) -> frozenset[str]:
        """Return the fields that have a variable, for ``leave``."""
        return frozenset(self.assigned)

    def leave(self, before: frozenset[str]) -> str:
        """Forget the variables that have been assigned since ``enter``."""
        self.assigned = set(before)
        return ""

    def assign(self, field: Field, expression: Expr) -> str:
        """Return the statement that reads a field. Empty if it has a variable."""
        if field.name in self.assigned:
            return ""
        self.assigned.add(field.name)
        return f"{self.local(field)} = {expression}"

    def covered_field(self, check: ParityIs) -> Field | None:
        """Return the only field that a parity bit covers, if its bits are those that it is read from."""
        if len(check.of) != 1 or check.mask or self.codec.parity_covers_gray or self.is_padded(check.of[0]):
            return None
        is_read = any(part.field.name == check.of[0].name for part in self.codec.parts)
        is_read |= any(other.field.name == check.of[0].name for other in self.codec.checks)
        return check.of[0] if is_read else None

    # -- CRC

    def xor_before(self, crc: FrameCrc) -> str:
        """Return the XOR of all bytes before a CRC that is this XOR. Empty for any other CRC."""
        before = self.codec.length - crc.crc.width // 8
        if not crc.crc.is_xor or before > _UNPACKED:
            return ""
        inverted = [f"0x{crc.inverted:02X}"] if crc.inverted else []
        return " ^ ".join([*(self.byte.format(place) for place in range(before)), *inverted])

    @property
    def crc_covers(self) -> Expr | None:
        """Number of bits before the CRC of a word, for its tables. None if an answer or the order code decides it.

        With the start value 0, zeros before the word do not change the CRC, so the longest word has tables for all.
        """
        crc = self.codec.only_crc
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
    def padded_fields(self) -> list[tuple[Field, Expr]]:
        """Fields below zeros, each with the bits that include the zeros."""
        checks = (check for check in self.codec.checks if isinstance(check, ZerosAbove))
        return [(check.field, self.read.of_bytes(check.field.pieces)) for check in checks]

    @property
    def disagreement(self) -> list[str]:
        """Conditions under which a check fails, if the first byte decides most of them. Empty if it does not."""
        if not self.heads:
            return []
        other_checks = [check for check in self.codec.checks if not self._is_in_first_byte(check)]
        if not all(isinstance(check, (AlwaysIs, ZerosAbove)) for check in other_checks):
            return []
        heads = [f"0x{byte:02X}" for byte, _ in self.heads]
        among = "valid_first_bytes" if self.members else f"({', '.join(heads)})"
        head = f"b0 != {heads[0]}" if len(heads) == 1 and not self.members else f"b0 not in {among}"
        return [*map(self._failing_condition, other_checks), head]

    def _failing_condition(self, check: Check) -> str:
        if isinstance(check, ZerosAbove):
            return f"{self.local(check.field)} >> {self.number(check.bits.width).operand}"
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

    def bits(self, part: Part) -> Expr:
        """Return the bits of a field after all checks."""
        is_assigned = part.field.name in self.assigned
        return Atom(self.local(part.field)) if is_assigned else self.read.bits(part.bits)

    def values(self, part: Part) -> list[Expr]:
        """Return the values of a field: one, or one per run of digits."""
        field, bits = part.field, self.bits(part)
        if self.disagreement and self.selects(field):
            return [Atom("valid_first_bytes[b0]")]
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

    def result(self, encoder_and_answers: Sequence[tuple[str, str]]) -> DecodedValues:
        """Return the values of all attributes, in order, beginning with the encoder and the answers."""
        decoded = DecodedValues(values=[(name, "") for name, _ in encoder_and_answers])
        for part in self.codec.parts:
            self._add_values(part, decoded)
        if self.codec.reserved:
            decoded.values.append((str(self.read.unused()), "unused, 1 where a bit differs from the manual"))
        elif self.codec.keeps_others:
            decoded.values.append((str(self.read.others()), "unused, all other bits"))
        return decoded

    def _add_values(self, part: Part, decoded: DecodedValues) -> None:
        """Add the values of a field, and the statement for the number that several values are parts of."""
        runs = part.field.runs
        if len(runs) > 1 and part.field.name not in self.assigned:
            decoded.statements.append(self.assign(part.field, self.read.bits(part.bits)))
        members: Sequence[Field | Digits] = runs or (part.field,)
        for member, value in zip(members, map(str, self.values(part)), strict=True):
            is_variable = value == self.local(member)
            decoded.values.append((value, "" if is_variable else self._comment(part, member)))

    def _comment(self, part: Part, member: Field | Digits) -> str:
        """Return the name of an attribute, with the place of its bits if its expression reads them."""
        name, meaning = self.names.attribute(member.name), meaning_of(part.field)
        if part.field.name in self.assigned or isinstance(member, Digits):
            return name
        place = self.read.place(part.bits)
        is_low = isinstance(meaning, Active) and meaning.low
        return ", ".join(filter(None, [name, place, "active low" if is_low else ""]))


class DecodedValues:
    """Values of all attributes of a frame or register, each with a name that its expression does not show.

    ``statements`` come before the values.
    """

    def __init__(self, values: list[tuple[str, str]]) -> None:
        self.values = values
        self.statements: list[str] = []

    @property
    def named_values(self) -> list[tuple[str, str]]:
        """Values whose expression does not show the name of the attribute."""
        return [(value, name) for value, name in self.values if name]


def sum_comment(codec: Codec, value: Expression) -> str:
    """Return a comment on the number in a sum of widths: the fields of fixed width at the low end that it counts."""
    remaining = value.constant
    if remaining <= 0:
        return ""
    counted_fields: list[str] = []
    position = 0
    fixed_fields = {member.low.constant: member for member in codec.layout.fields if member.is_fixed}
    while position < remaining and position in fixed_fields and fixed_fields[position].widest:
        fixed_field = fixed_fields[position]
        counted_fields.append(f"{fixed_field.name} ({fixed_field.widest})")
        position += fixed_field.widest
    if position != remaining:
        return ""
    return f"{remaining} = {' + '.join(reversed(counted_fields))}" if len(counted_fields) > 1 else counted_fields[0]


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
            yield name(field.name), call("as_member", enum, f'"{field.name}"', bits)
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
