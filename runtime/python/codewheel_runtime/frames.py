# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Base classes of frames and registers. They use descriptions in ``_shapes``, which are loaded on first use."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Generic, NoReturn, TypeVar, cast, get_type_hints

from .codec import (
    BitField,
    assert_never,
    check_bits,
    check_limits,
    check_power_of_two,
    check_signed,
    check_width,
    choice,
    decided,
    signed,
    text_number,
    to_gray,
    whole_number,
    zero_for,
)
from .encoder import Encoder, wrong_encoder
from .errors import FrameError, RangeError
from .reports import Report

if TYPE_CHECKING:
    from .bulk.shape import Check, Column, CrcOf, Shape, Unused
    from .bulk.table import Table

_Encoder = TypeVar("_Encoder", bound=Encoder)
_Decode = TypeVar("_Decode", bound=Callable[..., Any])

#: Function for an error of a frame. It receives the error, the frame and the encoder, and raises or returns the error.
Failed = Callable[[Exception, object, Any], NoReturn]

#: The tuple class, untyped: its methods are called on tuples of any items.
_TUPLE: Any = tuple


class Coded:
    """Frame or register. Another base of each class is the NamedTuple of its fields.

    Objects are equal only to those of the same class, unlike a plain NamedTuple.
    """

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        if self.__class__ is other.__class__:
            return cast(bool, _TUPLE.__eq__(self, other))
        return False if isinstance(other, tuple) else NotImplemented

    def __ne__(self, other: object) -> bool:
        if self.__class__ is other.__class__:
            return cast(bool, _TUPLE.__ne__(self, other))
        return True if isinstance(other, tuple) else NotImplemented

    def __hash__(self) -> int:
        return hash((self.__class__, _TUPLE.__hash__(self)))

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as plain values for JSON.

        Returns:
            The fields by name. A choice is its name in lower case. The encoder is its ``order_code``. A frame with a
            position also has ``position``, ``usable_position`` and ``verdict``, and one from an encoder ``reports``.
        """
        kind: Any = type(self)
        values: dict[str, Any] = {}
        for name in kind._fields:
            value = getattr(self, name)
            if isinstance(value, Encoder):
                values["order_code"] = value.code
            else:
                values[name] = value.name.lower() if isinstance(value, Enum) else value
        for name in ("position", "usable_position"):
            if hasattr(kind, name):
                values[name] = getattr(self, name)
        if isinstance(self, Sent):
            verdict = getattr(self, "verdict", None)
            if verdict is not None:
                values["verdict"] = verdict.value
            values["reports"] = [report.name for report in self.reports]
        return values

    @classmethod
    def _frame_name(cls, encoder: Encoder) -> str:
        """Return the name of the frame, if its range of positions differs from that of other frames."""
        return any_shape(cls, encoder).frame

    def _arguments(self) -> tuple[Any, ...]:
        """Return the encoder and the answers: the first fields."""
        kind, values = cast(Any, type(self)), cast("tuple[Any, ...]", self)
        return values[: len(_described(kind)[1])]

    def _number(self) -> tuple[Shape, int]:
        """Return the description, and the number that the fields form."""
        arguments = self._arguments()
        shape, fields = shape_of(type(self), *arguments), cast(Any, self)
        number = shape.fixed
        for column in shape.columns:
            number |= _bits(fields, column) << column.low
        for check in shape.checks:
            bits = number >> check.low & (1 << check.width) - 1
            if not check.is_within(bits):
                raise _limit_error(shape, check, bits)
        if shape.others is not None:
            number |= check_bits("unused", fields.unused, shape.others)
        elif shape.unused:
            number |= _unused_bits(fields.unused, shape.unused)
        if shape.limited is not None:
            check_limits(shape.limited[0], getattr(self, shape.limited[1]), fields.limits(*arguments))
        for check in shape.parities:
            number |= check.parity(number) << check.low
        if shape.gray is not None:
            number = to_gray(number, *shape.gray)
        if shape.crc is not None:
            number |= _crc(number, shape.crc) << shape.crc.low
        return shape, number


class InBits(Coded):
    """Frame that is sent as a string of bits."""

    __slots__ = ()

    def encode(self) -> int:
        """Return the word, with the first bit as the most significant one, including the CRC if it has one.

        Raises:
            RangeError: A value does not fit its field.
        """
        return self._number()[1]


class InBytes(Coded):
    """Frame or register that is made of bytes."""

    __slots__ = ()

    def encode(self) -> bytes:
        """Return the bytes, including the CRC if there is one.

        Raises:
            RangeError: A value does not fit its field.
        """
        shape, number = self._number()
        return number.to_bytes(shape.length, shape.order)


class Sent(Coded):
    """Frame that an encoder sends."""

    __slots__ = ()

    @property
    def reports(self) -> tuple[Report, ...]:
        """Reports of the encoder: active flags, unused bits that differ from the manual, and values with a verdict."""
        tells = shape_of(type(self), *self._arguments()).tells
        if not tells:
            return ()
        reports_by_name: Mapping[str, Report] = _module_of(type(self), "facts").REPORTS
        return tuple(condition.of(reports_by_name) for condition in tells if condition.is_active(self))


class Fixed(Coded):
    """Frame or register that is the same for every encoder."""

    __slots__ = ()

    @classmethod
    def bit_fields(cls) -> tuple[BitField, ...]:
        """Return the bit position of each field in the number that the frame or register forms."""
        return shape_of(cls).fields


class FixedFrame(Fixed):
    """Frame that is the same for every encoder."""

    __slots__ = ()

    @classmethod
    def decode_many(cls, frames: Any) -> Table:
        """Decode many frames into columns. Needs NumPy.

        Args:
            frames: The frames, as rows of bytes or, if they are strings of bits, as numbers.

        Returns:
            The columns. An error in a frame is not raised, but recorded in the column ``fault``.
        """
        return decode_many(frames, cls, None)

    @classmethod
    def encode_many(cls, columns: Mapping[str, Any]) -> Any:
        """Encode many frames. Needs NumPy.

        Args:
            columns: Columns by name, as ``decode_many`` returns them.

        Returns:
            The frames, as rows of bytes or, if they are strings of bits, as numbers of 64 bits.

        Raises:
            RangeError: A value does not fit its field. ``row`` is the first row with such a value.
            TypeError: A column is missing or unknown.
        """
        return encode_many(columns, cls)


class FixedBits(FixedFrame, InBits):
    """String of bits that is the same for every encoder."""

    __slots__ = ()

    @classmethod
    def frame_bits(cls) -> int:
        """Return the number of bits in the frame, including the CRC if it has one."""
        return shape_of(cls).bits


class FixedBytes(FixedFrame, InBytes):
    """Frame of bytes that is the same for every encoder."""

    __slots__ = ()


class FixedRegister(Fixed, InBytes):
    """Register that is the same for every encoder."""

    __slots__ = ()


if TYPE_CHECKING:

    class _Of(Coded, Generic[_Encoder]):
        """Base that type checkers see: it is generic in the class of the encoder."""

        __slots__ = ()

else:

    class _Of(Coded):
        """Base at run time. Classes derived from ``Generic`` take longer to import."""

        __slots__ = ()

        def __class_getitem__(cls, encoder: object) -> type:
            """Return the class itself."""
            return cls


class ByEncoder(_Of[_Encoder]):
    """Frame or register that depends on the encoder."""

    __slots__ = ()

    @classmethod
    def bit_fields(cls, variant: _Encoder) -> tuple[BitField, ...]:
        """Return the bit position of each field in the number that the frame or register forms.

        A field that the encoder does not have is 0 bits wide.
        """
        return shape_of(cls, variant).fields


class FrameOf(ByEncoder[_Encoder]):
    """Frame that depends on the encoder."""

    __slots__ = ()

    @classmethod
    def decode_many(cls, frames: Any, variant: _Encoder) -> Table:
        """Decode many frames into columns. Needs NumPy.

        Args:
            frames: The frames, as rows of bytes or, if they are strings of bits, as numbers.
            variant: The encoder.

        Returns:
            The columns. An error in a frame is not raised, but recorded in the column ``fault``.
        """
        return decode_many(frames, cls, variant, variant)

    @classmethod
    def encode_many(cls, columns: Mapping[str, Any], variant: _Encoder) -> Any:
        """Encode many frames. Needs NumPy.

        Args:
            columns: Columns by name, as ``decode_many`` returns them.
            variant: The encoder.

        Returns:
            The frames, as rows of bytes or, if they are strings of bits, as numbers of 64 bits.

        Raises:
            RangeError: A value does not fit its field. ``row`` is the first row with such a value.
            TypeError: A column is missing or unknown.
        """
        return encode_many(columns, cls, variant)


class BitsOf(FrameOf[_Encoder], InBits):
    """String of bits that depends on the encoder."""

    __slots__ = ()

    @classmethod
    def frame_bits(cls, variant: _Encoder) -> int:
        """Return the number of bits in the frame, including the CRC if it has one."""
        return shape_of(cls, variant).bits


class BytesOf(FrameOf[_Encoder], InBytes):
    """Frame of bytes that depends on the encoder."""

    __slots__ = ()


class RegisterOf(ByEncoder[_Encoder], InBytes):
    """Register that depends on the encoder."""

    __slots__ = ()


def _limit_error(shape: Shape, check: Check, bits: int) -> RangeError:
    """Return the error for a field whose bits are outside its limits."""
    column = next(candidate for candidate in shape.columns if candidate.low == check.low)
    field = column.field or column.name
    if column.kind == "signed":
        return RangeError(field, signed(bits, check.width), f"{check.lowest} to {check.limit}")
    return RangeError(field, bits, f"at most {check.limit}")


def _unused_bits(differing: Any, places: tuple[Unused, ...]) -> int:
    """Return the unused bits in a frame: as in the manual, inverted where ``differing`` is 1."""
    mask = sum((1 << unused.width) - 1 << unused.place for unused in places)
    differing_bits = check_bits("unused", differing, mask)
    number = 0
    for unused in places:
        bits = (differing_bits >> unused.place ^ unused.value) & (1 << unused.width) - 1
        number |= bits << unused.low
    return number


def _bits(fields: Any, column: Column) -> int:
    """Return the bits of a field. Raises RangeError if its value does not fit."""
    name, width = column.field or column.name, column.width
    if column.kind == "digits":
        number = 0
        for run, divisor, modulus in column.runs:
            number += check_limits(run, getattr(fields, run), (0, modulus - 1)) * divisor
        return number
    value = getattr(fields, column.name)
    match column.kind:
        case "flag" | "not_flag":
            return bool(value) == (column.kind == "flag")
        case "text":
            return text_number(name, value, width // 8)
        case "signed":
            return check_signed(name, value, width) & (1 << width) - 1
        case "number" | "choice":
            return _number_bits(name, value, column)
        case _:
            assert_never(column.kind)


def _number_bits(name: str, value: Any, column: Column) -> int:
    """Return the bits of an unsigned number, which may be limited to certain values."""
    width = column.width
    if isinstance(column.values, type):
        return choice(column.values, name, value)
    if column.values:
        number = whole_number(name, value)
        if number not in column.values:
            allowed = ", ".join(f"{allowed_value:X}h" for allowed_value in column.values)
            raise RangeError(name, number, allowed if len(column.values) == 1 else f"one of {allowed}")
        return number
    number = zero_for(name, value, column.zero_means, width) if column.zero_means else check_width(name, value, width)
    if column.power_of_two:
        check_power_of_two(name, value)
    return number


def _crc(number: int, crc: CrcOf) -> int:
    """Return the CRC of a number whose CRC bits are 0."""
    if not crc.steps:
        return crc.differs(number)
    for shift, mask, shift_back in crc.steps:
        high = number >> shift
        number = number & mask ^ high ^ (high << shift_back if shift_back else 0)
    return number ^ crc.xorout


# -- descriptions


def shape_of(kind: type, *arguments: object) -> Shape:
    """Return the description of a class for an encoder and for answers to questions that the manual leaves open."""
    make, needed = _described(kind)
    for wanted, value in zip(needed, arguments, strict=False):
        if not isinstance(value, wanted):
            if issubclass(wanted, Encoder):
                raise wrong_encoder(value, wanted.__base__ or Encoder, wanted.interface)
            decided(cast(Any, wanted), cast(Any, value))
    return make(*arguments)


def any_shape(kind: type, encoder: Encoder) -> Shape:
    """Return the description of a class for an encoder, with any answer to each open question."""
    make, needed = _described(kind)
    arguments: list[object] = []
    for argument_type in needed:
        is_encoder = issubclass(argument_type, Encoder)
        arguments.append(encoder if is_encoder else next(iter(cast(Any, argument_type))))
    return make(*arguments)


def kinds_of(encoder: Encoder) -> tuple[type, ...]:
    """Return the classes of the frames that an encoder sends."""
    package, _, family = type(encoder).__module__.rpartition(".")
    described = import_module(f"{package}._shapes.{family}")
    makers = described.FRAMES.get((encoder.interface.value, "encoder"), {}).values()
    return tuple(kind for kind, make in described.SHAPES.items() if make in makers)


@cache
def _described(kind: type) -> tuple[Callable[..., Shape], tuple[type, ...]]:
    """Return the function that creates the description of a class, and the types of its arguments."""
    shapes: Mapping[type, Callable[..., Shape]] = _module_of(kind, "_shapes").SHAPES
    make = next(shapes[base] for base in kind.__mro__ if base in shapes)
    hints = get_type_hints(make)
    return make, tuple(hint for name, hint in hints.items() if name != "return")


def _module_of(kind: type, folder: str) -> Any:
    """Return the module in ``folder`` that belongs to the family of a class."""
    fields = next(base for base in kind.__mro__ if "_fields" in vars(base))
    package, _, family = fields.__module__.rpartition(".")
    return import_module(f"{package}.{folder}.{family}")


# -- many frames


def decode_many(frames: object, kind: type, encoder: Encoder | None, *arguments: object) -> Table:
    """Decode many frames of one class. ``arguments`` are the encoder and the answers that the class needs."""
    shape = shape_of(kind, *arguments)
    from .bulk import decode as bulk_decode

    return bulk_decode.decode_many(frames, shape, encoder)


def encode_many(columns: Mapping[str, Any], kind: type, *arguments: object) -> Any:
    """Encode many frames of one class. ``arguments`` are the encoder and the answers that the class needs."""
    shape = shape_of(kind, *arguments)
    from .bulk import encode as bulk_encode

    return bulk_encode.encode_many(columns, shape)


def needed_by(kind: type, encoder: Encoder, **answers: object) -> tuple[object, ...]:
    """Return the encoder and the answers that a class of frames needs, in the order in which it takes them."""
    fields: tuple[str, ...] = cast(Any, kind)._fields
    needed_fields = fields[: len(_described(kind)[1])]
    return tuple(encoder if name == "variant" else answers[name] for name in needed_fields)


# -- decoders of one frame


def decoder(make: Callable[[Any, Failed], _Decode], encoder: Encoder | None, failed: Failed) -> _Decode:
    """Return the decoder of a class for an encoder. Each is made only once."""
    decoders: dict[object, _Decode] = _DECODERS if encoder is None else encoder.__dict__.setdefault("_decoders", {})
    decode = decoders.get((make, failed))
    if decode is None:
        decode = decoders[make, failed] = make(encoder, failed)
    return decode


_DECODERS: dict[object, Any] = {}


def bound(encoder: Encoder, name: str, make: Callable[[Any, Failed], _Decode], failed: Failed) -> _Decode:
    """Return the decoder of an encoder. From now on, it replaces the method ``name``."""
    encoder.__dict__[name] = decode = decoder(make, encoder, failed)
    return decode


def raised(error: Exception, _frame: object, _encoder: object) -> NoReturn:
    """Raise the error of a class."""
    raise error


def reported(error: Exception, frame: object, encoder: Encoder) -> NoReturn:
    """Raise the error of an encoder."""
    raise _of_encoder(error, frame, encoder)


def _returned(error: Exception, frame: object, encoder: Encoder) -> Exception:
    """Return the error of an encoder. Raises TypeError if the frame does not have the right type."""
    error = _of_encoder(error, frame, encoder)
    if isinstance(error, FrameError):
        return error
    raise error


returned: Failed = cast(Failed, _returned)


def _of_encoder(error: Exception, frame: object, encoder: Encoder) -> Exception:
    """Return the error with the frame and the encoder."""
    if isinstance(error, FrameError):
        error.add(frame, encoder)
        return error
    type_error = TypeError(f"{encoder.code}: {error}")
    type_error.__cause__ = error
    return type_error
