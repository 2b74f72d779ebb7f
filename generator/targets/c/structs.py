"""A layout in C: the struct of a frame or of the bytes of a register, with the names and types of its members."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

from ...model import Field, Layout, Register, Spi
from ...plan.codec import LayoutPlan, characters, layout_plan_of
from ...plan.operations import FrameCrc
from ...plan.values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    NamedChoice,
    TwosComplement,
    ZeroMeans,
    meaning_of,
    widest_value,
)
from .. import TargetError
from .bits import BitReader, UnusedMember
from .context import CEnumeration, HeaderContext
from .expressions import CCast, CExpression, CName, CNumber, COperation, join_operands, masked, shifted_right
from .names import CMacro, c_name, c_number, signed, signed_number, size_of, unsigned


class LayoutStruct:
    """The struct of a frame or register, with the names and the C types of its members.

    A register of one plain byte also has this object, but its struct is not part of the header.
    """

    def __init__(
        self, context: HeaderContext, layout: Layout, name: str, length_macro: str, register: Register | None = None
    ) -> None:
        self.context = context
        self.device = context.device
        self.translator = context.translator
        self.layout = layout
        #: Stem of its functions, and name of its type.
        self.name = name
        self.type = f"{name}_frame" if name == context.prefix else name
        self.length_macro = length_macro
        self.register = register
        self.layout_plan: LayoutPlan = layout_plan_of(context.device, layout)
        self.reader = BitReader(self.layout_plan, context.translator, word_size(context, layout))
        #: The numbers of the scales of its fields.
        self.scales: tuple[CMacro, ...] = tuple(scale_macros(layout, name))
        self.unused = UnusedMember(self.reader)
        self._check_supported()

    def _check_supported(self) -> None:
        """Raise an error if the C target does not support the layout."""
        layout = self.layout
        name = f"'{self.layout.name}'"
        if self.layout_plan.by_word and layout.widest > 64:
            raise TargetError(
                f"{name} has {layout.widest} bits and fields whose place depends on the order code; the C target "
                "supports such fields only within 64 bits",
                self.path,
            )
        if self.layout_plan.alternatives and self.register is not None:
            raise TargetError(
                f"{name} depends on a question that the manual leaves open; the C target supports this only in frames",
                self.path,
            )
        if self.unused.width > 64:
            # Bits to bytes, rounded up.
            unused_bytes = (self.unused.width + 7) // 8
            raise TargetError(
                f"{name} has unused bits in {unused_bytes} bytes; the C target supports at most 8", self.path
            )
        for decoded_field in self.layout_plan.decoded_fields:
            field = decoded_field.field
            # Called for its error if the field has more than 64 bits.
            self.type_of(field)
            if isinstance(meaning_of(field), Latin1Text) and not characters(field):
                raise TargetError(
                    f"the text '{field.name}' does not begin at a byte boundary, which the C target does not support",
                    (*self.path, "fields", field.name),
                )

    @property
    def path(self) -> tuple[str, ...]:
        """The path of the layout in the spec, such as ``("registers", "status")``."""
        if self.register is not None:
            return ("registers", self.register.name)
        (interface_name,) = (interface.name for interface, layout in self.device.layouts() if layout is self.layout)
        return ("interfaces", interface_name, "layouts", self.layout.name)

    def crc_function(self, frame_crc: FrameCrc) -> str:
        """Return the name of the function that computes a CRC of the layout."""
        return self.context.crc_name(frame_crc.crc, self.layout.carried_as)

    @property
    def number_type(self) -> str:
        """The C type of the frame as one number."""
        return unsigned(self.reader.word_size)

    def covered_bits(self, frame_crc: FrameCrc) -> CExpression:
        """Return the bits of the word that a CRC covers, as they are sent. Bit 0 is the last one.

        An example is ``(uint32_t)(word >> 6)``.
        """
        lowest_bit = frame_crc.lowest_covered_bit
        # The bit above the covered bits.
        end_bit = self.reader.word_size
        if covers_32_bits(frame_crc):
            end_bit = lowest_bit + frame_crc.covered_width.constant
        bits = shifted_right(self.reader.before_conversion.word_or_lower_half(end_bit), lowest_bit)
        is_across_halves = covers_32_bits(frame_crc) and end_bit > 32
        return CCast("uint32_t", bits) if is_across_halves else bits

    def received_crc(self, frame_crc: FrameCrc) -> CExpression:
        """Return the CRC that a word contains in its lowest bits, as it is sent."""
        width = frame_crc.crc.width
        return masked(self.reader.before_conversion.word_or_lower_half(width), (1 << width) - 1)

    # -- members

    def named_values(self, field: Field) -> CEnumeration | None:
        """Return the named values of a field as an enumeration or as macros, or None if its values have no names."""
        # A register can have the same name as a frame.
        owner = self.layout.name if self.register is None else f"reg_{self.register.name}"
        return self.context.enumeration_by_field.get((owner, field.name))

    def enumeration(self, field: Field) -> CEnumeration | None:
        """Return the enumeration of a field, or None if its values have no names or are macros."""
        named_values = self.named_values(field)
        return named_values if named_values is not None and named_values.is_enum else None

    def type_of(self, field: Field) -> str:
        """Return the type of a member, or of each character of a string."""
        match meaning_of(field):
            case ActiveFlag():
                return "bool"
            case NamedChoice():
                enumeration = self.enumeration(field)
                return enumeration.type if enumeration is not None else unsigned(field.widest)
            case TwosComplement():
                return signed(field.widest)
            case Latin1Text():
                return "char"
            case _:
                return unsigned(widest_value(field))

    def member_declarator(self, field: Field) -> str:
        """Return the name of a member in its declaration, with the length of a string."""
        size = f"[{field.widest // 8}]" if isinstance(meaning_of(field), Latin1Text) else ""
        return f"{c_name(field.name)}{size}"

    def member_type(self, name: str) -> str:
        """Return the type of the member of a field or join, by its name in the spec."""
        joined_number = next(
            (candidate for candidate in self.layout_plan.joined_numbers if candidate.join.name == name), None
        )
        return unsigned(joined_number.widest) if joined_number is not None else self.type_of(self.layout.field(name))

    def initializer(self, parameters: Mapping[str, int], values: Mapping[str, int] = MappingProxyType({})) -> str:
        """Return the initializer of a struct without its braces, such as ``true, 0x1BU, 0U``.

        ``values`` are numbers by the names of fields and joined numbers. A joined number is the number that several
        fields form together, such as a position of turns and counts. Other fields get the default of the spec, or else
        a value that an encoder accepts, mostly 0. ``parameters`` are the parameters of an order code. The member
        ``unused`` is 0, which means that all unused bits are as documented.
        """
        fields = [decoded_field.field for decoded_field in self.layout_plan.decoded_fields]
        number_by_field = {field.name: values.get(field.name, _default_value(field)) for field in fields}
        for joined_number in self.layout_plan.joined_numbers:
            if joined_number.name in values:
                # The numbers of its fields.
                number_by_field |= joined_number.field_numbers(values[joined_number.name], parameters)
        # C sets all members after the first one to 0.
        if not any(number_by_field.values()):
            return "0U"
        initial_values: list[str] = []
        for field in fields:
            initial_values += self._initial_values(field, number_by_field[field.name])
        for joined_number in self.layout_plan.joined_numbers:
            number = joined_number.number_of(number_by_field, parameters)
            initial_values.append(c_number(number, hexadecimal=True))
        if self.unused:
            initial_values.append("0U")
        return ", ".join(initial_values)

    @property
    def without_default(self) -> tuple[str, ...]:
        """The members of a request whose values the spec does not give."""
        fields = [decoded_field.field for decoded_field in self.layout_plan.decoded_fields]
        return tuple(c_name(field.name) for field in fields if field.default is None)

    def _initial_values(self, field: Field, initial_number: int) -> Iterator[str]:
        """Yield the initial value of each member of a field: one, or with runs of digits also one for each run."""
        match meaning_of(field):
            case ActiveFlag():
                yield "true" if initial_number else "false"
            case NamedChoice():
                named_values = self.named_values(field)
                constant_by_value = named_values.constant_by_value if named_values is not None else {}
                yield constant_by_value.get(initial_number, c_number(initial_number, hexadecimal=True))
            case TwosComplement():
                yield signed_number(initial_number)
            case DecimalDigits(runs):
                yield c_number(initial_number)
                for run in runs:
                    yield c_number(initial_number // run.divisor % run.modulus)
            case Latin1Text():
                yield '""'
            case _:
                yield c_number(initial_number, hexadecimal=True)

    def is_none_of(self, field: Field, name: CExpression, values: Sequence[int], is_raw: bool = False) -> CExpression:
        """Return the condition that ``name`` has none of these values, such as ``kind != 0x01U && kind != 0x02U``.

        ``is_raw`` is True if ``name`` contains the bits as read, rather than a value of the enumeration. Constants of
        the enumeration are then cast to the type of the bits.
        """
        named_values = self.named_values(field)
        constant_by_value = named_values.constant_by_value if named_values is not None else {}
        needs_cast = is_raw and self.enumeration(field) is not None
        type_of_bits, _ = self.reader.type_and_bits(self.layout_plan.bits_of(field.name))
        conditions: list[CExpression] = []
        for value in values:
            if value in constant_by_value:
                constant = CName(constant_by_value[value])
                expected: CExpression = CCast(type_of_bits, constant) if needs_cast else constant
            else:
                expected = CNumber(value, hexadecimal=True)
            conditions.append(COperation("!=", (name, expected)))
        return join_operands("&&", tuple(conditions))


def covers_32_bits(crc: FrameCrc) -> bool:
    """Return True if a CRC covers at most 32 bits, with every order code."""
    return crc.covered_width.is_constant and crc.covered_width.constant <= 32


def word_size(context: HeaderContext, layout: Layout) -> int:
    """Return the number of bits in the type of a frame's word.

    A word over SPI has the smallest type for its bits, since a master exchanges it as a whole. Other words have 64
    bits.
    """
    is_spi_word = isinstance(context.interface, Spi) and not layout.in_bytes
    return size_of(layout.widest) if is_spi_word else 64


def _default_value(field: Field) -> int:
    """Return the default of a field in the spec, or else a value that the generated encoder accepts, mostly 0.

    The value is 1 for a power of two, and the lowest of named values. In some fields, the bits 0 stand for a number
    such as 256, and the value 0 is rejected. Such a field gets that number.
    """
    if field.default is not None:
        return field.default
    if field.number.power_of_two:
        return 1
    match meaning_of(field):
        case NamedChoice(values):
            return min(value.value for value in values)
        case ZeroMeans(number_for_zero):
            return number_for_zero
        case _:
            return 0


def scale_macros(layout: Layout, stem: str) -> Iterator[CMacro]:
    """Yield the macros that convert fields with a scale to their unit, such as a temperature to degrees.

    Their values have 64 bits, so that no product overflows.
    """
    for field in layout.fields:
        scale = field.scale
        name = f"{stem}_{field.name}".upper()
        if scale is not None:
            note = f"{field.name} in {scale.unit}: ({field.name} * NUMERATOR + OFFSET) / DENOMINATOR"
            yield CMacro(f"{name}_NUMERATOR", value=f"INT64_C({scale.numerator})", note=note)
            magnitude = f"INT64_C({abs(scale.offset)})"
            offset = f"(-{magnitude})" if scale.offset < 0 else magnitude
            yield CMacro(f"{name}_OFFSET", offset)
            yield CMacro(f"{name}_DENOMINATOR", f"INT64_C({scale.denominator})")
