"""The worked examples of the manual, which test every output, and frames that programs and pages show."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from .documents import Sources
from .part import (
    Hex,
    key,
    part,
)
from .record import dataclass

#: Value of a field, a join or a run of digits in an example.
Values = Mapping[str, int | str | bool]


@part("One write.", data="One register write.", kw_only=False)
class Write:
    """A byte written to a register, or the number in a register that is written at once."""

    address: Hex = key("Register address.", minimum=0, maximum=65535)
    value: Hex = key("Byte written. Over SPI, the number in the register.", minimum=0, maximum=18446744073709551615)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Example:
    name: str
    erratum: str
    note: str
    source: Sources


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameExample(_Example):
    """A frame, in ``bits`` or in ``bytes``, with its values or the error for which it is ``refused``.

    ``alternatives`` contains the answers that it needs, keyed by the name of the alternative.
    """

    kind: ClassVar[str] = "frame"
    order_code: str
    layout: str
    sender: str
    bytes: bytes
    bits: str
    values: Values
    refused: str
    alternatives: Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class RegisterExample(_Example):
    """The bytes of a register and their values."""

    kind: ClassVar[str] = "register"
    order_code: str
    register: str
    bytes: bytes
    values: Values


@dataclass(frozen=True, slots=True, kw_only=True)
class CrcExample(_Example):
    """Bytes and their CRC."""

    kind: ClassVar[str] = "crc"
    crc: str
    bytes: bytes
    check: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcedureExample(_Example):
    """The bytes that a procedure writes for these arguments."""

    kind: ClassVar[str] = "procedure"
    order_code: str
    procedure: str
    arguments: Mapping[str, int]
    writes: tuple[Write, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasureExample(_Example):
    """A position in counts and its length."""

    kind: ClassVar[str] = "measure"
    order_code: str
    counts: int
    micrometres: int


#: ``kind`` is the keyword in the spec language, used for printing only.
Example = FrameExample | RegisterExample | CrcExample | ProcedureExample | MeasureExample


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """A frame that an encoder with this order code could send, for programs and pages that show one.

    All values are made up, except the position if there is a ``source``. ``spoilt`` is the same frame with an active
    flag that makes its position unusable, or None if it has no such flag.
    """

    order_code: str
    layout: str
    frame: int
    values: Values
    spoilt: int | None
    source: Sources
