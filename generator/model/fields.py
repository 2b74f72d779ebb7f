"""Fields of a layout with their pieces, joined numbers and combinations, and CRCs.

Bit 0 is the least significant bit everywhere, and a number of several bytes is one integer whose byte order is in the
layout.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, replace
from types import MappingProxyType
from typing import NamedTuple

from .expressions import Expression
from .kinds import (
    DATA_ROLES,
    Choice,
    Constant,
    Decimal,
    DigitCode,
    Digits,
    Flag,
    Kind,
    Number,
    Scale,
    Unused,
    Value,
    Verdict,
    code_in_field,
)
from .manual import Sources
from .part import CrcNumber, Name, Prose, key, name_key, note_key, part, source_key
from .record import dataclass, first_or_raise, member_named


@part(
    "A cyclic redundancy check, defined by its standard parameters.",
    data="A CRC, defined by its standard parameters.",
    identity="width poly init refin refout xorout",
)
class Crc:
    """A CRC, defined by its standard parameters."""

    name: Name = name_key("Name that fields refer to.")
    width: int = key(
        "Number of CRC bits.",
        data="Number of bits.",
        minimum=1,
        maximum=64,
        rule="crc-changed",
        label="bits",
        read="crc",
        noun="width",
    )
    poly: CrcNumber = key(
        "Generator polynomial without its top bit: 0x03 for x^6 + x + 1.",
        data="Generator polynomial without its top bit.",
        rule="crc-changed",
        label="polynomial",
        read="crc",
        noun="poly",
    )
    init: CrcNumber = key(
        "Start value of the register.",
        data="Start value.",
        rule="crc-changed",
        label="start value",
        read="crc",
        noun="init",
    )
    refin: bool = key(
        "True if each input byte is processed least significant bit first.",
        writing="It has no effect on frames of bits.",
        rule="crc-changed",
        label="input reflected",
        read="crc",
        noun="refin",
    )
    refout: bool = key(
        "True if the bits of the result are reversed.",
        rule="crc-changed",
        label="output reflected",
        read="crc",
        noun="refout",
    )
    xorout: CrcNumber = key(
        "Value XORed with the result: all ones if the CRC is sent inverted.",
        data="Value XORed with the result.",
        rule="crc-changed",
        label="inverted with",
        read="crc",
        noun="xorout",
    )
    note: Prose = note_key("The manual's own text, with any necessary additions.", default="")
    source: Sources = source_key()

    @property
    def poly_with_top_bit(self) -> int:
        return self.poly | (1 << self.width)

    @property
    def mask(self) -> int:
        return (1 << self.width) - 1

    @property
    def is_xor(self) -> bool:
        """True if the CRC of whole bytes is their XOR, which is then XORed with ``xorout``."""
        return self.width == 8 and self.poly == 1 and self.init == 0 and self.refin == self.refout

    @property
    def polynomial(self) -> str:
        """Generator polynomial, such as ``x^6 + x + 1``."""
        powers = [power for power in range(self.width, -1, -1) if (self.poly_with_top_bit >> power) & 1]
        return " + ".join({0: "1", 1: "x"}.get(power, f"x^{power}") for power in powers)


@dataclass(frozen=True, slots=True)
class BitSlice:
    """Part of a field in one byte: ``((byte >> low_in_byte) & mask) << low_in_number``."""

    byte: int
    low_in_byte: int
    mask: int
    low_in_number: int


@dataclass(frozen=True, slots=True)
class Field:
    """A field at bits ``low`` to ``low + width - 1``, converted to a value according to ``kind``.

    If the field is padded, it fills ``container`` bits together with its padding, from its lowest bit. ``bit_slices``
    is empty unless the layout is transmitted as bytes and the container is at a fixed position. ``byte_order`` is the
    order of its bytes if it differs from that of the layout, otherwise empty.
    """

    name: str
    kind: Kind
    low: Expression
    width: Expression
    widest: int
    printed_name: str = ""
    names: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    group: str = ""
    container: int = 0
    bit_slices: tuple[BitSlice, ...] = ()
    byte_order: str = ""
    equals: Expression | int | str | None = None
    implemented: bool = True
    reserved: str = ""
    explained_by: tuple[str, ...] = ()
    unit: str = ""
    scale: Scale | None = None
    default: int | None = None
    meaning: str = ""
    note: str = ""
    source: Sources = ()
    remedy: str = ""
    by_hand: tuple[str, ...] = ()

    @property
    def unexplained(self) -> Field:
        """The same flag, without its texts, for order codes for which the manual does not explain it."""
        assert isinstance(self.kind, Flag)
        return replace(self, kind=self.kind.unexplained, meaning="", note="", remedy="", by_hand=())

    def for_parameters(self, parameters: Mapping[str, int]) -> Field:
        """Return the field as it is for an order code with these parameters. Only flags can differ.

        A flag that the manual explains only for other order codes is unexplained. An answer of the user can replace the
        verdict on the position while the flag is active.
        """
        flag = self.kind
        if not isinstance(flag, Flag):
            return self
        # The parameter ``only_while`` is 0 for order codes for which the flag is not explained.
        is_unexplained = bool(flag.only_while) and not parameters.get(flag.only_while)
        if is_unexplained:
            return self.unexplained
        has_other_verdict = bool(flag.verdict_parameter and parameters.get(flag.verdict_parameter))
        if has_other_verdict:
            return replace(self, kind=replace(flag, makes_position=flag.verdict_if_set))
        return self

    def place(self, parameters: Mapping[str, int]) -> PlacedField:
        """Return the field with numbers as its lowest bit and its width, for an order code with these parameters."""
        return PlacedField(
            field=self.for_parameters(parameters),
            lowest_bit=self.low.value(parameters),
            width=self.width.value(parameters),
        )

    @property
    def is_fixed(self) -> bool:
        """True if the field is at the same bits for every order code."""
        return self.low.is_constant and self.width.is_constant

    @property
    def mask_in_place(self) -> int:
        """Mask of the field in the layout, at its largest width. The position of its lowest bit must be fixed."""
        return ((1 << self.widest) - 1) << self.low.constant

    @property
    def carries_data(self) -> bool:
        """True if the field matters to users of a decoded frame: it is neither fixed nor derived from other fields."""
        return self.kind.role in DATA_ROLES

    def documented(self, parameters: Mapping[str, int]) -> int | str | None:
        """Return the value that the field always has for an order code with these parameters, or None without one."""
        return self.equals.value(parameters) if isinstance(self.equals, Expression) else self.equals

    @property
    def number(self) -> Number:
        """Kind of the field if it is a number. For other kinds, it is an unsigned number formed by the bits."""
        return self.kind if isinstance(self.kind, Number) else Number()

    @property
    def code_of_digits(self) -> DigitCode | None:
        """Code in which its digits are sent, or None if the bits form one binary number."""
        return code_in_field(self.kind.digit_code, self.widest)

    @property
    def values(self) -> tuple[Value, ...]:
        """Named values of a choice, or none."""
        return self.kind.values if isinstance(self.kind, Choice) else ()

    def value_named(self, name: str) -> Value:
        """Return the named value with this name, or raise a ``LookupError``."""
        return member_named(self.values, name, f"value of '{self.name}'")

    def value_of(self, number: int) -> Value:
        """Return the named value with this number, or raise a ``LookupError``."""
        matches = (value for value in self.values if value.value == number)
        return first_or_raise(matches, f"value {number} of '{self.name}'")

    @property
    def makes_position(self) -> Verdict | None:
        """Verdict on the position while a bit of the field differs from its normal value, or None."""
        return self.kind.makes_position

    @property
    def fixed_value(self) -> int | None:
        """Value of a constant, or the documented value of unused bits, or None for other fields."""
        return self.kind.value if isinstance(self.kind, (Constant, Unused)) else None

    @property
    def sums_up(self) -> tuple[str, ...]:
        """Names of the flags that a flag combines, or none."""
        return self.kind.sums_up if isinstance(self.kind, Flag) else ()

    @property
    def runs(self) -> tuple[Digits, ...]:
        """Runs of decimal digits of a decimal number, or none."""
        return self.kind.runs if isinstance(self.kind, Decimal) else ()

    @property
    def padding_of(self) -> str:
        """Name of the padded field, or an empty string if this field is not padding."""
        return self.kind.padding_of if isinstance(self.kind, Constant) else ""

    @property
    def fills_gap(self) -> bool:
        """True if the field consists of zeros that the spec does not list, between two fields or next to a field."""
        return isinstance(self.kind, Constant) and self.kind.fills_gap

    @property
    def fills_byte(self) -> bool:
        """True if the field consists of zeros before a frame of bits that fill its first byte. They are not sent."""
        return isinstance(self.kind, Constant) and self.kind.fills_byte


@dataclass(frozen=True, slots=True)
class Join:
    """A number formed by several fields, most significant first."""

    name: str
    fields: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Combination:
    """Values of several fields that together decide the verdict on the position.

    ``when`` lists them as ``field.value``. The value of a flag is ``active`` or ``inactive``.
    """

    name: str
    printed_name: str
    when: tuple[str, ...]
    makes_position: Verdict
    meaning: str
    remedy: str
    note: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Sign:
    """Values that decide the verdict on the position like an active flag: a named value, or a combination.

    ``flag`` has the name, the texts and the verdict, but no bits. ``conditions`` are the fields with their values: 1
    for an active flag, 0 for an inactive one, or the number of a named value.
    """

    flag: Field
    conditions: tuple[tuple[str, int], ...]


@dataclass(frozen=True, slots=True)
class PlacedField:
    """A field at fixed bits, as it is for one order code."""

    field: Field
    lowest_bit: int
    width: int

    @property
    def name(self) -> str:
        return self.field.name

    @property
    def highest_bit(self) -> int:
        return self.lowest_bit + self.width - 1

    @property
    def mask(self) -> int:
        return (1 << self.width) - 1


def signs_of_values(field: Field) -> list[Sign]:
    """Return the named values of a field that have a verdict on the position, each in the form of a flag.

    The flag has no bits in the frame. It is active while the field has the value.
    """
    signs: list[Sign] = []
    for named_value in field.values:
        if named_value.makes_position is None:
            continue
        flag = Flag(
            when_active=named_value.meaning or f"{field.name} is {named_value.name}",
            makes_position=named_value.makes_position,
        )
        flag_field = _field_without_bits(
            f"{field.name}_{named_value.name}",
            flag,
            named_value.printed_name,
            source=named_value.source or field.source,
        )
        signs.append(Sign(flag_field, conditions=((field.name, named_value.value),)))
    return signs


def sign_of_combination(combination: Combination, fields: Iterable[Field]) -> Sign:
    """Return a combination of values with a verdict on the position in the form of a flag.

    The flag has no bits in the frame. It is active while all conditions hold. ``fields`` are the fields of the frame.
    """
    flag = Flag(when_active=combination.meaning, makes_position=combination.makes_position)
    flag_field = _field_without_bits(
        combination.name,
        flag,
        combination.printed_name,
        note=combination.note,
        remedy=combination.remedy,
        source=combination.source,
    )
    field_by_name = {field.name: field for field in fields}
    conditions: list[tuple[str, int]] = []
    for condition in combination.when:
        # Such as ``error.active`` for a flag, and ``battery.low`` for a named value.
        name, _, value_name = condition.partition(".")
        field = field_by_name[name]
        is_flag = isinstance(field.kind, Flag)
        number = int(value_name == "active") if is_flag else field.value_named(value_name).value
        conditions.append((name, number))
    return Sign(flag_field, tuple(conditions))


def _field_without_bits(
    name: str, flag: Flag, printed_name: str, note: str = "", remedy: str = "", source: Sources = ()
) -> Field:
    """Return a field that contains a flag, but no bits of the frame."""
    return Field(
        name=name,
        kind=flag,
        low=Expression(0),
        width=Expression(0),
        widest=0,
        printed_name=printed_name,
        note=note,
        remedy=remedy,
        source=source,
    )


class KnownCrc(NamedTuple):
    """A CRC by its polynomial, including the top bit, and an example of its use.

    ``in_masters`` is true if BiSS masters offer the polynomial.
    """

    polynomial: int
    use: str
    init: int = 0
    in_masters: bool = False

    @property
    def width(self) -> int:
        return self.polynomial.bit_length() - 1


#: The polynomials of masters come from the Microchip dsPIC33A by length, and 0x97, which Beckhoff names next to 0x43.
#: The others come from the encoders in ``specs/``, and from the AS5047U, whose users publish frames.
KNOWN_CRCS: Sequence[KnownCrc] = (
    KnownCrc(0x190D9, "BiSS, 16 bits", in_masters=True),
    KnownCrc(0x12F, "BiSS, 8 bits", in_masters=True),
    KnownCrc(0x89, "BiSS, 7 bits", in_masters=True),
    KnownCrc(0x97, "BiSS, 7 bits, other polynomial", in_masters=True),
    KnownCrc(0x43, "BiSS, 6 bits", in_masters=True),
    KnownCrc(0x25, "BiSS, 5 bits", in_masters=True),
    KnownCrc(0x13, "BiSS, 4 bits", in_masters=True),
    KnownCrc(0xB, "BiSS, 3 bits", in_masters=True),
    KnownCrc(0x11021, "iC-MU, 16 bits", init=1),
    KnownCrc(0x197, "encoders of RLS over SPI, 8 bits"),
    KnownCrc(0x107, "CRC-8 of ITU-T I.432.1 without its final XOR, 8 bits"),
    KnownCrc(0x11D, "SAE J1850, 8 bits", init=0xFF),
    KnownCrc(0x11D, "AS5047U of ams, 8 bits", init=0xC4),
    KnownCrc(0x12F, "0x2F of AUTOSAR, 8 bits", init=0xFF),
    KnownCrc(0x101, "XOR of all bytes, 8 bits"),
)
