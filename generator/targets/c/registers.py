"""Registers in C: the places of fields, limits, access by name, and the registers that identify an encoder."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

from ...model import (
    Device,
    Field,
    Interface,
    Register,
    RegisterMeaning,
    number_to_bytes,
)
from ...model.expressions import Expression
from ...model.record import dataclass
from ...order_codes.parameters import parameters_at_run_time
from ...plan.codec import LayoutPlan
from ...plan.frames import identities
from ...plan.limits import NoPowerOfTwo, OutsideLimits, depends_on_order_code, limits_check_of, limits_of, refusals
from ...plan.operations import IsOneOf
from ...plan.values import ActiveFlag, Latin1Text, NamedChoice, UnsignedNumber, meaning_of
from ...say.names_and_evidence import full_title, name_in_words, title_of
from .. import TargetError
from .about import about_access, about_member, about_register, field_table
from .codec import StructCodec
from .comments import Paragraph
from .context import HeaderContext
from .expressions import CExpression, CFunction, CName, number_function
from .expressions import CNumber as NumberExpr
from .names import DeclaredName
from .structs import LayoutStruct


class RegisterFunctions:
    """The functions that read and write a register over the user's transport.

    ``read`` and ``write`` are their names, empty if the register does not allow that access. Registers reserved for the
    manufacturer are only read. ``struct`` is empty if the register is one plain byte. ``limit_checks`` check the limits
    of the register.
    """

    def __init__(self, layout: LayoutStruct, *, has_struct: bool, limit_checks: Sequence[OutsideLimits]) -> None:
        context = layout.context
        register = layout.register
        assert register is not None
        self.register = register
        self.limit_checks = limit_checks
        self.stem = layout.name.upper()
        self.struct = layout.name if has_struct else ""
        self._struct = layout
        #: The only field of a plain byte.
        self._byte_field = register.layout.fields[0]
        #: The named values of the byte, empty if it can have any value.
        self.valid_values: tuple[int, ...] = ()
        for check in layout.layout_plan.checks:
            if isinstance(check, IsOneOf):
                self.valid_values = check.values
                break
        self.type = self.struct or self._type_of_byte()
        is_written = register.writable and not register.reserved
        self.read_function = f"{context.prefix}_read_{register.name}" if register.readable else ""
        self.write_function = f"{context.prefix}_write_{register.name}" if is_written else ""
        self.read_about = self._build_comment(writes=False)
        self.write_about = self._build_comment(writes=True)
        #: The macro of the address that selects its bank, empty if it is in no bank, and the byte to write there.
        self.bank_address, self.bank_byte = "", 0
        selector_name = context.device.bank_selector(register)
        if selector_name:
            self._set_bank(context.device.register(selector_name))

    def _type_of_byte(self) -> str:
        """Return the type of a plain byte: the type of its named values, if it has any."""
        choice = self._struct.named_values(self._byte_field)
        return choice.type if choice is not None else "uint8_t"

    def _build_comment(self, *, writes: bool) -> tuple[Paragraph, ...]:
        """Return the comment on the function that reads, or on the function that writes.

        If frames depend on the register, the comment on writing asks users to update the variant afterwards.
        """
        context = self._struct.context
        changes_variant = writes and self.register.name in state_registers(context.device)
        read_state = f"{context.prefix}_read_state" if changes_variant else ""
        return tuple(about_access(context.device, self.register, writes=writes, read_state=read_state))

    def _set_bank(self, selector: Register) -> None:
        """Set the address and the byte that select the bank of the register."""
        if selector.length > 1:
            raise TargetError(f"'{selector.name}' selects banks with {selector.length} bytes; the C target writes one")
        self.bank_address = f"{self._struct.context.PREFIX}_REG_{selector.name}_ADDRESS".upper()
        # One byte, as checked above.
        (self.bank_byte,) = number_to_bytes(selector.layout, self.register.bank or 0, 8)

    def is_unknown(self, name: str, is_raw: bool) -> CExpression:
        """Return the condition that a byte has none of the named values, such as ``kind != 1U && kind != 2U``.

        ``is_raw`` is True if the variable ``name`` contains the byte as read, rather than a value of the enumeration.
        """
        return self._struct.is_none_of(self._byte_field, CName(name), self.valid_values, is_raw)

    @property
    def write_uses_variant(self) -> bool:
        """True if the function that writes uses the variant."""
        return bool(self.struct) or any(map(depends_on_order_code, self.limit_checks))


def state_registers(device: Device) -> list[str]:
    """Return the readable registers whose contents change what frames look like, each once.

    A variant, which is an order code with its parameters, must be updated from them.
    """
    names = dict.fromkeys(parameter.register for parameter in device.run_time_parameters)
    return [name for name in names if device.register(name).readable]


@dataclass(frozen=True, slots=True)
class RegisterBounds:
    """The lowest and the highest value of a register.

    ``macros`` are the limits that are the same for all order codes, with their values. ``functions`` are the others.
    """

    macros: tuple[tuple[str, CExpression], ...]
    functions: tuple[CFunction, ...]


@dataclass(frozen=True, slots=True)
class ExplainingBits:
    """The bits of ``register`` that give the reason why a flag in another register is set, as a mask in a macro."""

    name: str
    bits: int
    register: str


class RegisterCode:
    """The values that the templates print for a register.

    ``codec`` is its struct with the decoder and the encoder, or None if the register is one plain byte.
    """

    def __init__(self, context: HeaderContext, register: Register) -> None:
        self.context = context
        self.device = context.device
        self.translator = context.translator
        self.register = register
        self.layout = register.layout
        self.name = f"{context.prefix}_reg_{register.name}"
        self.stem = self.name.upper()
        length_macro = f"{self.stem}_LENGTH"
        self.struct = LayoutStruct(context, self.layout, name=self.name, length_macro=length_macro, register=register)
        self.enumerations = context.enumerations.of("registers", register.name)
        # None if no value is outside the limits, or if they do not apply to a single member.
        outside_limits = limits_check_of(self.struct.layout_plan, limits_of(self.device, register))
        limit_checks = (outside_limits,) if outside_limits is not None else ()
        self.codec = None if self.is_plain else StructCodec(self.struct, limit_checks=limit_checks)
        self.access = RegisterFunctions(self.struct, has_struct=self.codec is not None, limit_checks=limit_checks)
        #: Its own limits, and the limits of each of its meanings.
        self.limits = tuple(self._find_limits(meaning) for meaning in (None, *register.meanings))
        self.explaining_bits = tuple(self._yield_explaining_bits())

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names at file scope, each with its path in the spec."""
        for name in self._yield_names():
            yield name, ("registers", self.register.name)
        if self.codec is not None:
            yield from self.codec.declared()

    def _yield_names(self) -> Iterator[str]:
        """Yield the names of its macros and functions, except the names of its codec."""
        yield f"{self.stem}_ADDRESS"
        yield f"{self.stem}_LENGTH"
        yield f"{self.stem}_ACCESS"
        if self.register.default is not None:
            yield f"{self.stem}_DEFAULT"
        if self.expected is not None:
            yield f"{self.stem}_EXPECTED"
        if self.register.wait_at_least_ms is not None:
            yield f"{self.stem}_WAIT_AT_LEAST_MS"
        yield from self._names_of_places()
        yield from (bits.name for bits in self.explaining_bits)
        if self.codec is None:
            yield from (scale.name for scale in self.struct.scales)
        for bounds in self.limits:
            yield from (name for name, _ in bounds.macros)
            yield from (function.name for function in bounds.functions)
        if self.access.read_function:
            yield self.access.read_function
        if self.access.write_function:
            yield self.access.write_function

    def _names_of_places(self) -> Iterator[str]:
        """Yield the macros and the functions for the places of fields."""
        for field in self.masked_fields:
            if self.has_shift(field):
                yield f"{self.name}_{field.name}_SHIFT".upper()
            yield f"{self.name}_{field.name}_MASK".upper()
        for field in self.moving_fields:
            yield f"{self.name}_{field.name}_shift"
            yield f"{self.name}_{field.name}_mask"

    @property
    def is_plain(self) -> bool:
        """True if the byte itself is the value, so that it needs no struct."""
        has_one_byte = self.register.length == 1
        has_one_field = len(self.layout.fields) == 1
        return has_one_byte and has_one_field and _is_byte(self.struct.layout_plan)

    @property
    def title(self) -> str:
        """Its name, and its name in the manual."""
        return full_title(self.register)

    @property
    def expected(self) -> int | None:
        """The value of a plain byte that the manual states, or None."""
        equals = self.layout.fields[0].equals if self.is_plain else None
        return equals if isinstance(equals, int) else None

    @property
    def about(self) -> list[Paragraph]:
        """The comment on the register, with the facts about a plain byte.

        It contains a table of the fields if some of them have no macros.
        """
        paragraphs = about_register(self.device, self.register)
        if self.is_plain:
            paragraphs.append(about_member(self.struct, self.layout.fields[0]))
        elif len(self.masked_fields) < len(self.layout.fields):
            paragraphs += field_table(self.struct)
        return paragraphs

    # -- places of its fields

    @cached_property
    def _fields_with_masks(self) -> tuple[Field, ...]:
        """The fields for which the header has a mask: all fields except constants and texts.

        There are none in a register of one plain byte, of more than 8 bytes, or with a single field without named
        values, which is the register itself.
        """
        fields = self.layout.fields
        is_whole_register = len(fields) == 1 and not isinstance(meaning_of(fields[0]), NamedChoice)
        is_longer_than_a_number = self.register.length > 8
        if self.is_plain or is_longer_than_a_number or is_whole_register:
            return ()
        variable_fields = [field for field in fields if field.name not in self.struct.layout_plan.constants]
        return tuple(field for field in variable_fields if not isinstance(meaning_of(field), Latin1Text))

    @staticmethod
    def has_shift(field: Field) -> bool:
        """Return True if a field needs a shift and a mask. For a flag, the mask is enough."""
        return not isinstance(meaning_of(field), ActiveFlag)

    @property
    def masked_fields(self) -> tuple[Field, ...]:
        """The fields with masks that are at the same place for every order code."""
        return tuple(field for field in self._fields_with_masks if field.is_fixed)

    @property
    def moving_fields(self) -> tuple[Field, ...]:
        """The fields with masks whose place depends on the order code."""
        return tuple(field for field in self._fields_with_masks if field not in self.masked_fields)

    def _yield_explaining_bits(self) -> Iterator[ExplainingBits]:
        """Yield the bits of other registers that give the reason why a flag of this register is set.

        The spec lists them as ``explained_by``. For ``explained_by: [errors.crc, errors.parity]``, the result is one
        mask with both bits of the register ``errors``.
        """
        for field in self.layout.fields:
            mask_by_register: dict[str, int] = {}
            for register_and_field in field.explained_by:
                register_name, _, field_name = register_and_field.partition(".")
                explaining_field = self.device.register(register_name).layout.field(field_name)
                earlier_mask = mask_by_register.get(register_name, 0)
                mask_by_register[register_name] = earlier_mask | explaining_field.mask_in_place
            for register_name, mask in mask_by_register.items():
                yield ExplainingBits(
                    name=f"{self.stem}_{field.name}_IN_{register_name}".upper(),
                    bits=mask,
                    register=title_of(self.device.register(register_name)),
                )

    # -- limits

    def _find_limits(self, meaning: RegisterMeaning | None) -> RegisterBounds:
        """Return the limits of the register, or of one of its meanings, which are uses with limits of their own.

        The names of the limits end in ``min`` and ``max``. A limit that the manual does not give is left out.
        """
        limits = limits_of(self.device, self.register, meaning)
        name_of_limited = self.register.limits_of if meaning is None else name_in_words(meaning.name)
        stem = self.name if meaning is None else f"{self.name}_{meaning.name}"
        macros: list[tuple[str, CExpression]] = []
        functions: list[CFunction] = []
        for ending, adjective, limit in (("min", "lowest", limits.lowest), ("max", "highest", limits.highest)):
            if limit is None:
                continue
            name = f"{stem}_{ending}"
            if limit.is_constant:
                macros.append((name.upper(), NumberExpr(limit.constant, signed=limits.signed)))
            else:
                about = f"Return the {adjective} {name_of_limited}: {limit.render()}."
                functions.append(self._limit_function(name, about, limit, is_signed=limits.signed))
        return RegisterBounds(tuple(macros), tuple(functions))

    def _limit_function(self, name: str, about: str, limit: Expression, *, is_signed: bool) -> CFunction:
        """Return the function for a limit that depends on the order code.

        Its type is ``int64_t`` for a limit with a sign. Otherwise, it is ``uint32_t`` if the limits of all order codes
        fit, whatever the registers contain, or else ``uint64_t``.
        """
        if is_signed:
            value = self.translator.to_signed_c(limit)
            return CFunction(name, type="int64_t", value=value, about=about, uses_variant=True)
        unsigned_limits = [0]
        for variant in self.device.variants_over(self.register.interface):
            for parameters in parameters_at_run_time(self.device, variant):
                unsigned_limits.append(limit.value(parameters))
        return number_function(self.translator, name=name, expression=limit, largest=max(unsigned_limits), about=about)


def _is_byte(plan: LayoutPlan) -> bool:
    """Return True if the first field of a register is a whole byte, as a number or as a named value.

    The result is False for a number that must be a power of two, since an encoder must check it.
    """
    if not plan.decoded_fields or any(isinstance(refusal, NoPowerOfTwo) for refusal in refusals(plan)):
        return False
    only_part = plan.decoded_fields[0]
    return isinstance(only_part.meaning, (UnsignedNumber, NamedChoice)) and only_part.field.width == Expression(8)


@dataclass(frozen=True, slots=True)
class IdentityCode:
    """The registers that identify an encoder over one interface, such as a device ID.

    A register with a codec is decoded and compared with the manual. One without is compared as a byte.
    """

    prefix: str
    interface: Interface
    compared_registers: tuple[RegisterCode, ...]

    @property
    def uses_variant(self) -> bool:
        """True if a comparison decodes a register, or if the byte to compare with depends on the order code."""
        for register in self.compared_registers:
            if register.codec is not None:
                return True
            expected_byte = register.layout.fields[0].equals
            if isinstance(expected_byte, Expression) and not expected_byte.is_constant:
                return True
        return False

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names of the struct and of the functions."""
        for ending in ("identity", "could_be", "next_candidate", "read_identity"):
            yield f"{self.prefix}_{ending}", ()


def identity_codes(context: HeaderContext, codes: Mapping[str, RegisterCode]) -> Iterator[IdentityCode]:
    """Yield the identifying registers of each interface that has any. ``codes`` are all registers by name."""
    for identity in identities(context.device):
        compared = tuple(codes[comparison.register.name] for comparison in identity.compared_registers)
        yield IdentityCode(context.prefix, context.device.interface(identity.interface), compared)


@dataclass(frozen=True, slots=True)
class FilledRegister:
    """A register whose struct the function fills with an argument of the procedure.

    ``struct_local`` and ``bytes_local`` are the local variables for the struct and for the bytes that it encodes to.
    """

    code: RegisterCode
    argument: str
    member: str
    struct_local: str
    bytes_local: str

    @property
    def needs_setter(self) -> bool:
        """True if other members repeat the value, so that a ``_set_`` function must set all of them."""
        return self.code.codec is not None and self.member in self.code.codec.set_names


@dataclass(frozen=True, slots=True)
class WholeRegister:
    """A register that an argument of the procedure sets as one number.

    ``values`` are its bytes as C expressions. ``bytes_local`` and ``struct_local`` are the local variables for the
    bytes and for the struct that they decode to.
    """

    code: RegisterCode
    struct_local: str
    bytes_local: str
    values: tuple[CExpression, ...]
