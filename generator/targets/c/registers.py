"""Registers in C: the places of fields, limits, access by name, alarms, and the registers that identify an encoder."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

from ...model import (
    Alarm,
    Device,
    Field,
    Interface,
    Register,
    RegisterMeaning,
    assert_never,
    member_named,
    number_to_bytes,
)
from ...model.expressions import Expression
from ...model.record import dataclass
from ...order_codes.parameters import parameters_at_run_time
from ...plan.codec import Codec
from ...plan.frames import identities
from ...plan.limits import NoPowerOfTwo, OutsideLimits, depends, limits_of, outside, refusals
from ...plan.operations import IsOneOf
from ...plan.values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans, meaning_of
from ...say.names_and_places import full_title, title, words
from .. import TargetError
from .about import about_access, about_alarm, about_member, about_register, table
from .codec import StructCodec
from .comments import Paragraph
from .context import Context, Function, Macro, number_of
from .names import Declared, Expr, Name, number
from .names import Number as NumberExpr
from .structs import Struct


class Access:
    """The functions that read and write a register. A name is empty if the register does not allow that access.

    Registers reserved for the manufacturer are only read. ``struct`` is empty if the register is one plain byte.
    """

    def __init__(self, layout: Struct, has_struct: bool, outside: Sequence[OutsideLimits]) -> None:
        context, register = layout.context, layout.register
        assert register is not None
        self.register, self.outside = register, outside
        self.stem = layout.name.upper()
        self.struct = layout.name if has_struct else ""
        self._layout, self._field = layout, register.layout.fields[0]
        self.values = next((op.values for op in layout.plan.checks if isinstance(op, IsOneOf)), ())
        choice = layout.choice(self._field)
        self.type = self.struct or (choice.type if choice is not None else "uint8_t")
        is_written = register.writable and not register.reserved
        self.read = f"{context.prefix}_read_{register.name}" if register.readable else ""
        self.write = f"{context.prefix}_write_{register.name}" if is_written else ""
        read_state = f"{context.prefix}_read_state" if register.name in state_registers(context.device) else ""
        self.read_about: tuple[Paragraph, ...] = tuple(about_access(context.device, register, False, ""))
        self.write_about: tuple[Paragraph, ...] = tuple(about_access(context.device, register, True, read_state))
        self.bank_address, self.bank = "", 0
        selector = context.device.bank_selector(register)
        if selector:
            selecting = context.device.register(selector)
            if selecting.length > 1:
                raise TargetError(f"'{selector}' selects banks with {selecting.length} bytes; the C target writes one")
            self.bank_address = f"{context.PREFIX}_REG_{selector}_ADDRESS".upper()
            self.bank = number_to_bytes(selecting.layout, register.bank or 0, 8)[0]

    def is_unknown(self, name: str, is_raw: bool) -> Expr:
        """Return the condition that a byte differs from all named values."""
        return self._layout.is_none_of(self._field, Name(name), self.values, is_raw)

    @property
    def write_depends(self) -> bool:
        """True if the function that writes uses the variant."""
        return bool(self.struct) or any(map(depends, self.outside))


def state_registers(device: Device) -> list[str]:
    """Return the readable registers that hold a part of the variant, each once."""
    names = dict.fromkeys(parameter.register for parameter in device.run_time_parameters)
    return [name for name in names if device.register(name).readable]


class AlarmCode:
    def __init__(self, context: Context, alarm: Alarm) -> None:
        self.alarm = alarm
        self.about = about_alarm(context.device, alarm)
        self.macros = tuple(_macros(context.device, alarm, f"{context.PREFIX}_ALARM_{alarm.name.upper()}"))

    def declared(self) -> Iterator[Declared]:
        yield from ((macro.name, ("alarms", self.alarm.name)) for macro in self.macros)


def _macros(device: Device, alarm: Alarm, stem: str) -> Iterator[Macro]:
    bits, note = _mask(device, alarm)
    if bits:
        yield Macro(f"{stem}_MASK", number(bits, hexadecimal=True), note)
    if alarm.below_mv is not None:
        yield Macro(f"{stem}_BELOW_MV", number(alarm.below_mv), "raised below this, in millivolts")


def _mask(device: Device, alarm: Alarm) -> tuple[int, str]:
    """Return the bits of an alarm, or 0 if they have no place, and a note if they belong to one of several bytes."""
    fields = (field for _, layout in device.layouts() for field in layout.fields if field.group == alarm.group)
    candidates = (field for field in fields if field.name == alarm.field and field.pieces)
    frame_field = next(candidates, None)
    if alarm.group and frame_field is not None and len(frame_field.pieces) == 1:
        piece = frame_field.pieces[0]
        group = member_named(device.field_groups, alarm.group, "field group")
        note = "in its byte" if group.bits > 8 else ""
        return piece.mask << piece.right, note
    if not alarm.register:
        return 0, ""
    layout = device.register(alarm.register).layout
    register_field = layout.field(alarm.field) if alarm.field else layout.fields[0]
    # A flag that moves with the order code has no mask. The register's codec finds it.
    mask = register_field.mask_in_place if register_field.is_fixed else 0
    return mask, ""


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


@dataclass(frozen=True, slots=True)
class IdentityCode:
    """The identifying registers of one interface. One with a codec is decoded, one without is compared as a byte."""

    prefix: str
    interface: Interface
    compared: tuple[RegisterCode, ...]

    @property
    def uses_variant(self) -> bool:
        stated = (register.layout.fields[0].equals for register in self.compared if register.codec is None)
        varies = any(isinstance(equals, Expression) and not equals.is_constant for equals in stated)
        return varies or any(register.codec is not None for register in self.compared)

    def declared(self) -> Iterator[Declared]:
        names = ("identity", "could_be", "next_candidate", "read_identity")
        yield from ((f"{self.prefix}_{name}", ()) for name in names)


def identity_codes(context: Context, codes: Mapping[str, RegisterCode]) -> Iterator[IdentityCode]:
    for identity in identities(context.device):
        compared = tuple(codes[comparison.register.name] for comparison in identity.compared)
        yield IdentityCode(context.prefix, context.device.interface(identity.interface), compared)
