"""One register in C: the places of its fields, its limits, and the functions that encode, decode and access it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

from ...model import Field, Register, RegisterMeaning, assert_never
from ...model.expressions import Expression
from ...model.record import dataclass
from ...order_codes.parameters import parameters_at_run_time
from ...plan.codec import Codec
from ...plan.limits import NoPowerOfTwo, limits_of, outside, refusals
from ...plan.values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans, meaning_of
from ...say.names_and_places import full_title, title, words
from .about import about_member, about_register, table
from .access import Access
from .codec import StructCodec
from .comments import Paragraph
from .context import Context
from .expr import Expr
from .expr import Number as NumberExpr
from .functions import Function, number_of
from .names import Declared
from .structs import Struct


@dataclass(frozen=True, slots=True)
class Bounds:
    """The limits that are the same for all order codes, as macros, and the others as functions."""

    macros: tuple[tuple[str, Expr], ...]
    functions: tuple[Function, ...]


@dataclass(frozen=True, slots=True)
class ExplainingBits:
    """The bits of a register that give the reason why a field of another one is set."""

    name: str
    bits: int
    register: str


class RegisterCode:
    """The values that the templates print for a register. ``codec`` is None if the byte itself is the value."""

    def __init__(self, context: Context, register: Register) -> None:
        self.context = context
        self.device = context.device
        self.scope = context.scope
        self.register = register
        self.layout = register.layout
        self.name = f"{context.prefix}_reg_{register.name}"
        self.stem = self.name.upper()
        self.struct = Struct(context, self.layout, self.name, f"{self.stem}_LENGTH", register)
        self.enumerations = context.enumerations.of("registers", register.name)
        refused = outside(self.struct.plan, limits_of(self.device, register))
        limits = (refused,) if refused is not None else ()
        self.codec = None if self.is_plain else StructCodec(self.struct, (), limits)
        self.access = Access(self.struct, self.codec is not None, limits)
        #: Its own limits, and those of each of its meanings.
        self.limits = tuple(self._limits(meaning) for meaning in (None, *register.meanings))
        self.explained = tuple(self._explained())

    def declared(self) -> Iterator[Declared]:
        yield from ((name, ("registers", self.register.name)) for name in self._names())
        if self.codec is not None:
            yield from self.codec.declared()

    def _names(self) -> Iterator[str]:
        register = self.register
        yield from (f"{self.stem}_{ending}" for ending in ("ADDRESS", "LENGTH", "ACCESS"))
        if register.default is not None:
            yield f"{self.stem}_DEFAULT"
        if self.expected is not None:
            yield f"{self.stem}_EXPECTED"
        if register.wait_at_least_ms is not None:
            yield f"{self.stem}_WAIT_AT_LEAST_MS"
        for field in self.masked:
            endings = ("SHIFT", "MASK") if self.has_shift(field) else ("MASK",)
            yield from (f"{self.name}_{field.name}_{ending}".upper() for ending in endings)
        for field in self.moving:
            yield from (f"{self.name}_{field.name}_{ending}" for ending in ("shift", "mask"))
        yield from (explanation.name for explanation in self.explained)
        yield from (scale.name for scale in self.struct.scales if self.codec is None)
        for bounds in self.limits:
            yield from (name for name, _ in bounds.macros)
            yield from (function.name for function in bounds.functions)
        yield from filter(None, (self.access.read, self.access.write))

    @property
    def is_plain(self) -> bool:
        """True if the byte itself is the value, so that it needs no struct."""
        return len(self.layout.fields) == self.register.length == 1 and _is_byte(self.struct.plan)

    @property
    def title(self) -> str:
        """Its name, and that in the manual."""
        return full_title(self.register)

    @property
    def expected(self) -> int | None:
        """The value of the byte that the manual states."""
        equals = self.layout.fields[0].equals if self.is_plain else None
        return equals if isinstance(equals, int) else None

    @property
    def about(self) -> list[Paragraph]:
        about = about_register(self.device, self.register)
        if self.is_plain:
            return [*about, about_member(self.struct, self.layout.fields[0])]
        return [*about, *table(self.struct)] if len(self.masked) < len(self.layout.fields) else about

    # -- places of its fields

    @cached_property
    def _with_masks(self) -> tuple[Field, ...]:
        """The fields that have masks. A register's only field is the register itself."""
        fields: Sequence[Field] = self.layout.fields
        is_whole = len(fields) == 1 and not isinstance(meaning_of(fields[0]), Named)
        if self.is_plain or self.register.length > 8 or is_whole:
            return ()
        constants = self.struct.plan.constants
        fields = [field for field in fields if field.name not in constants]
        return tuple(field for field in fields if not isinstance(meaning_of(field), Characters))

    @staticmethod
    def has_shift(field: Field) -> bool:
        """Return True if a mask is not enough to use a field in the register's number."""
        match meaning_of(field):
            case Active():
                return False
            case Raw() | TwosComplement() | ZeroMeans() | Named() | DigitRuns() | Characters():
                return True
            case never:
                assert_never(never)

    @property
    def masked(self) -> tuple[Field, ...]:
        """The fields at the same place for every order code."""
        return tuple(field for field in self._with_masks if field.is_fixed)

    @property
    def moving(self) -> tuple[Field, ...]:
        return tuple(field for field in self._with_masks if field not in self.masked)

    def _explained(self) -> Iterator[ExplainingBits]:
        for field in self.layout.fields:
            bits: dict[str, int] = {}
            for place in field.explained_by:
                name, _, bit = place.partition(".")
                explaining_field = self.device.register(name).layout.field(bit)
                bits[name] = bits.get(name, 0) | explaining_field.mask_in_place
            for name, mask in bits.items():
                yield ExplainingBits(
                    f"{self.stem}_{field.name}_IN_{name}".upper(), mask, title(self.device.register(name))
                )

    # -- limits

    def _limits(self, meaning: RegisterMeaning | None) -> Bounds:
        limits = limits_of(self.device, self.register, meaning)
        bounded = self.register.limits_of if meaning is None else words(meaning.name)
        stem = self.name if meaning is None else f"{self.name}_{meaning.name}"
        macros: list[tuple[str, Expr]] = []
        functions: list[Function] = []
        for side, word, limit in (("min", "lowest", limits.low), ("max", "highest", limits.high)):
            if limit is None:
                continue
            if limit.is_constant:
                macros.append((f"{stem}_{side}".upper(), NumberExpr(limit.constant, signed=limits.signed)))
            else:
                about = f"Return the {word} {bounded}: {limit.render()}."
                functions.append(self._function(f"{stem}_{side}", about, limit, limits.signed))
        return Bounds(tuple(macros), tuple(functions))

    def _function(self, name: str, about: str, limit: Expression, signed: bool) -> Function:
        if signed:
            return Function(name, "int64_t", self.scope.signed(limit), about, uses_variant=True)
        variants = self.device.variants_over(self.register.interface)
        states = (parameters for variant in variants for parameters in parameters_at_run_time(self.device, variant))
        largest = max(map(limit.value, states), default=0)
        return number_of(self.scope, name, limit, largest, about)


def _is_byte(plan: Codec) -> bool:
    """Return True if the only field is the whole number in a byte."""
    if not plan.parts or any(isinstance(op, NoPowerOfTwo) for op in refusals(plan)):
        return False
    match plan.parts[0].meaning:
        case Raw() | Named():
            return plan.parts[0].field.width == Expression(8)
        case TwosComplement() | ZeroMeans() | Active() | DigitRuns() | Characters():
            return False
        case never:
            assert_never(never)
