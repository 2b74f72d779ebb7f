# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Code for registers that change a frame, and for registers that identify an encoder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal, NamedTuple, Protocol, SupportsIndex

from .codec import Data, as_bytes, check_limits, check_width, shown, whole_number
from .encoder import Encoder
from .errors import FrameError, LengthError, RangeError
from .reports import Interface


class Encodable(Protocol):
    """Register object that can be encoded."""

    def encode(self) -> bytes:
        """Return the bytes of the register."""
        ...


def whole(
    register: str, kind: type[Encodable], value: Encodable | SupportsIndex, length: int, order: Literal["little", "big"]
) -> bytes:
    """Return the bytes of a register with several fields, given as an object of its class or as one number."""
    if isinstance(value, kind):
        return value.encode()
    if not isinstance(value, SupportsIndex):
        name = f"{kind.__module__}.{kind.__qualname__}"
        raise TypeError(f"{register} must be an integer or an object of {name}, got {shown(value)}")
    return check_width(register, value, 8 * length).to_bytes(length, order)


class Held(NamedTuple):
    """Parameter that a register holds at run time, in the ``width`` bits that start at ``low``.

    ``zero_means`` is the value that is stored as 0, if there is one. ``codes`` lists the codes with their values, if
    the register holds codes. ``by_order_code`` is true if the register has no default, so that the order code sets the
    parameter.
    """

    parameter: str
    interface: Interface
    address: int
    default: bytes
    order: Literal["little", "big"]
    low: int
    width: int
    min: int
    max: int
    zero_means: int = 0
    codes: tuple[tuple[int, int], ...] = ()
    by_order_code: bool = False

    def value_in(self, data: bytes) -> int:
        """Return the parameter for these bytes of the register.

        Raises:
            RangeError: The register holds a code that is not allowed.
        """
        held = int.from_bytes(data, self.order) >> self.low & ((1 << self.width) - 1)
        if not self.codes:
            return held or self.zero_means
        codes = dict(self.codes)
        if held not in codes:
            raise RangeError(f"code for {self.parameter}", held, ", ".join(map(str, codes)))
        return codes[held]

    def bytes_with(self, value: int) -> bytes:
        """Return the bytes of the register with this parameter and factory defaults for the rest."""
        mask = (1 << self.width) - 1
        number = int.from_bytes(self.default, self.order) & ~(mask << self.low)
        if self.codes:
            bits = next((code for code, stands_for in self.codes if stands_for == value), 0)
        else:
            bits = 0 if value == self.zero_means else value
        return (number | bits << self.low).to_bytes(len(self.default), self.order)


def held_parameters(items: tuple[Held, ...], held: Mapping[int, int], variant: Encoder) -> dict[str, int]:
    """Return the parameters for bytes keyed by address. Missing bytes are taken from ``variant``."""
    found: dict[str, int] = {}
    known: set[int] = set()
    here = [item for item in items if item.interface is variant.interface]
    for item in here:
        places = range(item.address, item.address + len(item.default))
        if not any(place in held for place in places):
            continue
        known.update(places)
        old = item.bytes_with(getattr(variant, item.parameter))
        data = bytes(
            check_width(f"register 0x{place:02X}", held[place], 8) if place in held else byte
            for place, byte in zip(places, old, strict=True)
        )
        found[item.parameter] = check_limits(item.parameter, item.value_in(data), (item.min, item.max))
    unknown = sorted(held.keys() - known)
    if unknown:
        listed = ", ".join(f"0x{address:02X}" for address in sorted({item.address for item in here})) or "none"
        raise ValueError(f"register 0x{unknown[0]:02X} does not affect decoding; registers that do: {listed}")
    return found


def held_text(items: tuple[Held, ...], variant: Encoder) -> str:
    """Return the parameters that differ from the factory default, as text. Without a default, they are always shown."""
    here = [item for item in items if item.interface is variant.interface]
    values = [(item, getattr(variant, item.parameter)) for item in here]
    shown = ((item, value) for item, value in values if item.by_order_code or value != item.value_in(item.default))
    return "".join(f" {item.parameter}={value}" for item, value in shown)


class Located(Protocol):
    """Object that has an address and a length, like a register."""

    @property
    def address(self) -> int:
        """Address of the first byte."""
        ...

    @property
    def length(self) -> int:
        """Number of bytes."""
        ...


def held_bytes(read: Mapping[int, int] | Mapping[str, Data], registers: Mapping[str, Located]) -> dict[int, int]:
    """Return ``read`` as bytes keyed by address. It may also contain whole registers keyed by name."""
    held: dict[int, int] = {}
    value: Any
    for key, value in read.items():
        if not isinstance(key, str):
            held[whole_number("an address", key)] = check_width(f"the byte at {key!r}", value, 8)
            continue
        register = registers.get(key)
        if register is None:
            raise ValueError(f"no register '{key}'; the registers are {', '.join(registers)}")
        data = as_bytes(value)
        if len(data) != register.length:
            raise LengthError(register.length, len(data))
        held.update(zip(range(register.address, register.address + register.length), data, strict=True))
    return held


def agrees(held: Mapping[int, int], address: int, length: int, expected: Callable[[bytes], bool]) -> bool:
    """Return whether a register has the expected value. True if it was not read completely."""
    found = [held[place] for place in range(address, address + length) if place in held]
    try:
        return len(found) < length or expected(bytes(found))
    except FrameError:
        return False
