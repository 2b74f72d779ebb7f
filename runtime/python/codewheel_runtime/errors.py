# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Encoder and file errors. Each is a ``ValueError``, and a frame error is a ``FrameError``."""

from __future__ import annotations

from enum import IntEnum
from typing import Any, ClassVar, Protocol

from .reports import Family, Interface


class ErrorKind(IntEnum):
    """Frame errors, in the order in which ``decode`` checks for them."""

    NONE = 0
    LENGTH = 1
    CRC = 2
    CONSTANT = 3
    RANGE = 4


class Sender(Protocol):
    """Encoder that sent a frame, for the error of that frame. See ``codewheel_runtime.Encoder``.

    Attributes:
        family: Family of the encoder.
        interface: Interface of the encoder.
    """

    family: ClassVar[Family]
    interface: ClassVar[Interface]

    @property
    def code(self) -> str:
        """Order code, without any text that follows it on the label."""
        ...

    def decode(self, frame: Any) -> object:
        """Decode a frame that the encoder sent."""
        ...

    def _hint(self, frame: object) -> str: ...


class FrameError(ValueError):
    """A frame or register cannot be decoded, or values cannot be encoded.

    Attributes:
        frame: The frame that was passed to an encoder's ``decode``, otherwise None.
        encoder: The encoder whose ``decode`` raised the error, otherwise None.
        order_code: Order code of the encoder, otherwise empty.
        usable_position: Always None, as for a frame whose position is not usable.
        channel: Class of the data channel with the error, for a frame with several channels, otherwise empty.
    """

    frame: object = None
    channel: str = ""
    encoder: Sender | None = None
    order_code: str = ""
    usable_position: None = None

    def add(self, frame: object, encoder: Sender) -> None:
        """Record the frame and the encoder."""
        self.frame = frame
        self.encoder = encoder
        self.order_code = encoder.code

    def to_dict(self) -> dict[str, str]:
        """Return the error as plain values for JSON.

        Returns:
            ``fault``, such as ``crc``, the ``message``, the ``hint`` and the ``order_code``.
        """
        kind = type(self).__name__.removesuffix("Error").lower()
        return {"fault": kind, "message": str(self), "hint": self.hint, "order_code": self.order_code}

    @property
    def hint(self) -> str:
        """Common mistake that would explain the frame, as a sentence. Empty if there is none.

        Computed on access.
        """
        return "" if self.encoder is None else self.encoder._hint(self.frame)


class LengthError(FrameError):
    """A frame or register has too many or too few bits or bytes."""

    def __init__(self, expected: int, found: int, unit: str = "bytes") -> None:
        super().__init__(expected, found, unit)
        self.expected = expected
        self.found = found
        self.unit = unit

    @property
    def hint(self) -> str:
        """Common mistake that would explain the frame, as a sentence. Empty if there is none.

        Computed on access.
        """
        frame = self.frame
        lacks_bits = self.unit == "bits" and self.found < self.expected
        if self.encoder is not None and lacks_bits and isinstance(frame, int):
            # A number would be explained as if its missing bits were leading zeros.
            return self.encoder._hint(f"{frame:0{self.found}b}")
        return super().hint

    def __str__(self) -> str:
        unit = self.unit if self.expected != 1 else self.unit[:-1]
        return f"expected {self.expected} {unit}, got {self.found}"


class CrcError(FrameError):
    """The CRC of a frame does not match. Usually, bits were changed in transmission."""

    def __init__(self, received: int, computed: int) -> None:
        super().__init__(received, computed)
        self.received = received
        self.computed = computed

    def __str__(self) -> str:
        place = f" in {self.channel}" if self.channel else ""
        return f"expected CRC {self.computed:#04x}{place}, got {self.received:#04x}"


class ConstantError(FrameError):
    """Constant bits or a parity bit have the wrong value."""

    def __init__(self, field: str, found: int, expected: int) -> None:
        super().__init__(field, found, expected)
        self.field = field
        self.found = found
        self.expected = expected

    def __str__(self) -> str:
        return f"{self.field} must be {self.expected:#x}, got {self.found:#x}"


class RangeError(FrameError):
    """A value is undefined, too large or outside its limits."""

    def __init__(self, field: str, value: object, allowed: str) -> None:
        super().__init__(field, value, allowed)
        self.field = field
        self.value = value
        self.allowed = allowed

    def __str__(self) -> str:
        return f"{self.field} must be {self.allowed}, got {self.value!r}"


class FamilyError(ValueError):
    """The encoder belongs to a different family."""

    def __init__(self, code: str, found: str, expected: str) -> None:
        super().__init__(code, found, expected)
        self.code = code
        self.found = found
        self.expected = expected

    def __str__(self) -> str:
        return f"{self.code} belongs to the family {self.found}, not to {self.expected}"


class InterfaceError(ValueError):
    """The encoder does not have the required interface."""

    def __init__(self, code: str, found: Interface, expected: Interface, instead: str = "") -> None:
        super().__init__(code, found, expected, instead)
        self.code = code
        self.found = found
        self.expected = expected
        self.instead = instead

    def __str__(self) -> str:
        return f"{self.code} has the interface {self.found.title}, but this needs {self.expected.title}{self.instead}"


class InputError(ValueError):
    """A file does not contain the expected frames.

    Attributes:
        file: Name of the file.
        message: Description of the error.
        place: Offset, line, row or column. Empty if the error affects the whole file.
    """

    def __init__(self, file: str, message: str, place: str = "") -> None:
        super().__init__(file, message, place)
        self.file = file
        self.message = message
        self.place = place

    def __str__(self) -> str:
        return f"{self.file}{', ' if self.place else ''}{self.place}: {self.message}"


class UsageError(ValueError):
    """The arguments are wrong, whatever the file contains."""
