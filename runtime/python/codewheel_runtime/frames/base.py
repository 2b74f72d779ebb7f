# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Base classes of frames and registers."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import TYPE_CHECKING, Any, Final, Generic, TypeVar, cast

from ..codec import BitField
from ..encoder import Encoder
from ..reports import Report
from .descriptions import decoding_arguments, find_any_layout, find_description, layout_of, module_of
from .encoders import Encode, find_class_encoder

if TYPE_CHECKING:
    from ..bulk.table import Table

_Encoder = TypeVar("_Encoder", bound=Encoder)

#: Functions that encode frames that do not depend on the encoder, by class.
_ENCODERS: Final[dict[type, Encode]] = {}
#: The tuple class, untyped: its methods are called on tuples of any items.
_TUPLE: Any = tuple


class Coded:
    """Frame or register. The other base of each class is the NamedTuple of its fields.

    Unlike plain NamedTuples, objects are equal only to objects of the same class.
    """

    __slots__ = ()

    def __init_subclass__(cls, **keywords: Any) -> None:
        """Give the constructor the public name of the class, because Python's messages about arguments contain it.

        The constructor of ``SingleCycleData`` is that of the NamedTuple ``_SingleCycleData``.
        """
        super().__init_subclass__(**keywords)
        for base in cls.__bases__:
            if base.__name__ == f"_{cls.__name__}":
                constructor: Any = base.__new__
                constructor.__qualname__ = f"{cls.__name__}.__new__"

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
            The fields by name. A choice becomes its name in lower case. The encoder is its ``order_code``. A frame with
            a position also contains ``position``, ``usable_position`` and ``verdict``, and a frame from an encoder also
            contains ``reports``.
        """
        frame_class: Any = type(self)
        values: dict[str, Any] = {}
        for name in frame_class._fields:
            value = getattr(self, name)
            if isinstance(value, Encoder):
                values["order_code"] = value.code
            else:
                values[name] = value.name.lower() if isinstance(value, Enum) else value
        for name in ("position", "usable_position"):
            if hasattr(frame_class, name):
                values[name] = getattr(self, name)
        if isinstance(self, Sent):
            verdict = getattr(self, "verdict", None)
            if verdict is not None:
                values["verdict"] = verdict.value
            values["reports"] = [report.name for report in self.reports]
        return values

    @classmethod
    def _frame_name(cls, encoder: Encoder) -> str:
        """Return the name of the frame if other frames have a different range of positions, otherwise empty."""
        return find_any_layout(cls, encoder).frame

    def _arguments(self) -> tuple[Any, ...]:
        """Return the first fields of the frame: the encoder and the answers that its description needs."""
        # mypy takes the method __hash__ of the class for one of the type, so that it would not be hashable.
        frame_class: Any = type(self)
        _, argument_types = find_description(frame_class)
        # Frames are NamedTuples, which type checkers do not see here.
        fields = cast("tuple[Any, ...]", self)
        return fields[: len(argument_types)]

    def _encoder(self) -> Encode:
        """Return the function that encodes frames of this class.

        The function is created on the first call for the class.
        """
        try:
            return _ENCODERS[self.__class__]
        except KeyError:
            encode = _ENCODERS[self.__class__] = find_class_encoder(self)
            return encode


class ForEncoder(Coded):
    """Frame or register whose bits depend on the encoder, which is its first field."""

    __slots__ = ()

    def _encoder(self) -> Encode:
        """Return the function that encodes frames of this class for the same encoder.

        The encoder keeps these functions in its attribute ``_encoders``, by the class of the frame.
        """
        # Frames are NamedTuples, which type checkers do not see here.
        fields: Any = self
        try:
            encode: Encode = fields[0].__dict__["_encoders"][self.__class__]
        except (AttributeError, KeyError):
            # This class has not been encoded yet. Raises an error if the first field is not an encoder.
            encode = find_class_encoder(self)
            fields[0].__dict__.setdefault("_encoders", {})[self.__class__] = encode
        return encode


class InBits(Coded):
    """Frame that is sent as a string of bits."""

    __slots__ = ()

    def encode(self) -> int:
        """Return the word, with the first bit as the most significant bit, including the CRC if it has one.

        Raises:
            RangeError: A value does not fit its field.
        """
        number: int = self._encoder()(self)
        return number


class InBytes(Coded):
    """Frame or register that consists of bytes."""

    __slots__ = ()

    def encode(self) -> bytes:
        """Return the bytes, including the CRC if there is one.

        Raises:
            RangeError: A value does not fit its field.
        """
        data: bytes = self._encoder()(self)
        return data


class Sent(Coded):
    """Frame that an encoder sends."""

    __slots__ = ()

    @property
    def reports(self) -> tuple[Report, ...]:
        """Encoder reports: active flags, unused bits that differ from the manual, and values with a verdict."""
        report_causes = layout_of(type(self), *self._arguments()).report_causes
        if not report_causes:
            return ()
        reports_by_name: Mapping[str, Report] = module_of(type(self), "facts").REPORTS
        return tuple(cause.of(reports_by_name) for cause in report_causes if cause.is_active(self))


class Fixed(Coded):
    """Frame or register that is the same for every encoder."""

    __slots__ = ()

    @classmethod
    def bit_fields(cls) -> tuple[BitField, ...]:
        """Return the bit position of each field in the number that the frame or register forms."""
        return layout_of(cls).fields


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

        Raises:
            TypeError, ValueError: ``frames`` are not in this form.
        """
        return decode_frames(frames, cls, variant=None)

    @classmethod
    def encode_many(cls, columns: Mapping[str, Any] | Table) -> Any:
        """Encode many frames. Needs NumPy.

        Args:
            columns: Columns by name, as ``decode_many`` returns them.

        Returns:
            The frames, as rows of bytes or, if they are strings of bits, as 64-bit numbers.

        Raises:
            RangeError: A value does not fit its field. ``row`` is the first row with such a value.
            TypeError: A column is missing or unknown, or its type does not fit the field.
            ValueError: The columns have different lengths.
        """
        return encode_columns(columns, cls, variant=None)


class FixedBits(FixedFrame, InBits):
    """String of bits that is the same for every encoder."""

    __slots__ = ()

    @classmethod
    def frame_bits(cls) -> int:
        """Return the number of bits in the frame, including the CRC if it has one."""
        return layout_of(cls).bit_count


class FixedBytes(FixedFrame, InBytes):
    """Frame of bytes that is the same for every encoder."""

    __slots__ = ()


class FixedRegister(Fixed, InBytes):
    """Register that is the same for every encoder."""

    __slots__ = ()


if TYPE_CHECKING:

    class _Of(Coded, Generic[_Encoder]):
        """Base class for type checkers, generic over the class of the encoder."""

        __slots__ = ()

else:

    class _Of(Coded):
        """Base at run time. Classes derived from ``Generic`` take longer to import."""

        __slots__ = ()

        def __class_getitem__(cls, encoder: object) -> type:
            """Return the class itself."""
            return cls


class ByEncoder(ForEncoder, _Of[_Encoder]):
    """Frame or register that depends on the encoder, but not on any answer."""

    __slots__ = ()

    @classmethod
    def bit_fields(cls, variant: _Encoder) -> tuple[BitField, ...]:
        """Return the bit position of each field in the number that the frame or register forms.

        A field that does not exist in the encoder is 0 bits wide.
        """
        return layout_of(cls, variant).fields


class FrameOf(ByEncoder[_Encoder]):
    """Frame whose layout depends on the encoder."""

    __slots__ = ()

    @classmethod
    def decode_many(cls, frames: Any, variant: _Encoder) -> Table:
        """Decode many frames into columns. Needs NumPy.

        Args:
            frames: The frames, as rows of bytes or, if they are strings of bits, as numbers.
            variant: The encoder.

        Returns:
            The columns. An error in a frame is not raised, but recorded in the column ``fault``.

        Raises:
            TypeError, ValueError: ``frames`` are not in this form.
            TypeError, FamilyError, InterfaceError: ``variant`` is not an encoder that sends frames of this class.
        """
        return decode_frames(frames, cls, variant=variant)

    @classmethod
    def encode_many(cls, columns: Mapping[str, Any] | Table, variant: _Encoder) -> Any:
        """Encode many frames. Needs NumPy.

        Args:
            columns: Columns by name, as ``decode_many`` returns them.
            variant: The encoder.

        Returns:
            The frames, as rows of bytes or, if they are strings of bits, as 64-bit numbers.

        Raises:
            RangeError: A value does not fit its field. ``row`` is the first row with such a value.
            TypeError: A column is missing or unknown, or its type does not fit the field.
            ValueError: The columns have different lengths.
            TypeError, FamilyError, InterfaceError: ``variant`` is not an encoder that sends frames of this class.
        """
        return encode_columns(columns, cls, variant=variant)


class BitsOf(FrameOf[_Encoder], InBits):
    """String of bits that depends on the encoder."""

    __slots__ = ()

    @classmethod
    def frame_bits(cls, variant: _Encoder) -> int:
        """Return the number of bits in the frame, including the CRC if it has one."""
        return layout_of(cls, variant).bit_count


class BytesOf(FrameOf[_Encoder], InBytes):
    """Frame of bytes that depends on the encoder."""

    __slots__ = ()


class RegisterOf(ByEncoder[_Encoder], InBytes):
    """Register that depends on the encoder."""

    __slots__ = ()


class Limited(InBytes):
    """Register with limits for the values that may be written. The limits apply to objects that a program creates.

    A decoded register keeps its bytes, because their content can be outside these limits.
    """

    def encode(self) -> bytes:
        """Return the bytes. A decoded register returns the bytes that were decoded.

        Raises:
            RangeError: A value does not fit its field, or may not be written.
        """
        # Only ``keep_bytes`` sets these attributes, for a decoded register.
        data: bytes | None = self.__dict__.get("_bytes")
        return super().encode() if data is None else data


class FixedLimitedRegister(Limited, FixedRegister):
    """Register with limits that is the same for every encoder."""


class LimitedRegisterOf(Limited, RegisterOf[_Encoder]):
    """Register with limits that depends on the encoder."""


_Limited = TypeVar("_Limited", bound=Limited)


def keep_bytes(register: _Limited, data: bytes) -> _Limited:
    """Return a decoded register that keeps the bytes from which it was decoded, so that they are encoded unchanged."""
    register.__dict__["_bytes"] = data
    return register


def decode_frames(frames: object, frame_class: type, /, *, variant: Encoder | None, **answers: object) -> Table:
    """Return the columns of many frames of one class.

    ``variant`` is the encoder, or None for frames that are the same for every encoder.

    ``answers`` are the answers to open questions by name. Answers that the class does not need are ignored.
    """
    layout = layout_of(frame_class, *decoding_arguments(frame_class, variant=variant, **answers))
    from ..bulk import decode as bulk_decode

    return bulk_decode.decode_many(frames, layout, variant)


def encode_columns(
    columns: Mapping[str, Any] | Table, frame_class: type, /, *, variant: Encoder | None, **answers: object
) -> Any:
    """Return many frames of one class from columns of values by name.

    ``variant`` is the encoder, or None for frames that are the same for every encoder.

    ``answers`` are the answers to open questions by name. Answers that the class does not need are ignored.
    """
    layout = layout_of(frame_class, *decoding_arguments(frame_class, variant=variant, **answers))
    from ..bulk import encode as bulk_encode

    return bulk_encode.encode_many(columns, layout)
