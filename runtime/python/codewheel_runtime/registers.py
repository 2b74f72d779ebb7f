# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Code for registers that change a frame, and for registers that identify an encoder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal, NamedTuple, Protocol, SupportsIndex

from .codec import Data, as_bytes, check_limits, check_width, shorten, whole_number
from .encoder import Encoder
from .errors import FrameError, LengthError, RangeError
from .reports import Interface


class Encodable(Protocol):
    """Register object that can be encoded."""

    def encode(self) -> bytes:
        """Return the bytes of the register."""
        ...


def encode_register(
    register: str, kind: type[Encodable], value: Encodable | SupportsIndex, length: int, order: Literal["little", "big"]
) -> bytes:
    """Return the bytes of a register with several fields, given as an object of its class or as one number.

    Raises:
        TypeError: ``value`` is neither.
        RangeError: The number does not fit into ``length`` bytes.
    """
    if isinstance(value, kind):
        return value.encode()
    if not isinstance(value, SupportsIndex):
        name = f"{kind.__module__}.{kind.__qualname__}"
        raise TypeError(f"{register} must be an integer or an object of {name}, got {shorten(value)}")
    return check_width(register, value, 8 * length).to_bytes(length, order)


class RegisterParameter(NamedTuple):
    """Parameter that a register holds at run time, in the ``width`` bits that start at ``low``.

    ``min`` and ``max`` are the lowest and the highest allowed value. ``zero_means`` is the value that is stored as 0,
    if there is such a value, otherwise 0. ``codes`` lists the codes with their values, if the register holds codes.
    ``by_order_code`` is True if the register has no default, so that the order code sets the parameter.
    """

    name: str
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
        bits = (int.from_bytes(data, self.order) >> self.low) & ((1 << self.width) - 1)
        # Bits of 0 represent ``zero_means``, which is 0 itself if 0 has no other meaning.
        if not self.codes:
            return self.zero_means if bits == 0 else bits
        codes = dict(self.codes)
        if bits not in codes:
            raise RangeError(f"code for {self.name}", bits, ", ".join(map(str, codes)))
        return codes[bits]

    def bytes_with(self, value: int) -> bytes:
        """Return the bytes of the register with this value of the parameter, and factory defaults for the rest."""
        mask = (1 << self.width) - 1
        default_number = int.from_bytes(self.default, self.order)
        number_without_parameter = default_number & ~(mask << self.low)
        if self.codes:
            # A value without a code is stored as 0.
            code_by_value = {coded_value: code for code, coded_value in reversed(self.codes)}
            bits = code_by_value.get(value, 0)
        else:
            bits = 0 if value == self.zero_means else value
        number = number_without_parameter | (bits << self.low)
        return number.to_bytes(len(self.default), self.order)


def read_parameters(
    parameters: tuple[RegisterParameter, ...], register_bytes: Mapping[int, int], encoder: Encoder
) -> dict[str, int]:
    """Return the parameters that registers contain, by name. ``register_bytes`` are bytes of registers by address.

    If only some bytes of a parameter's register are given, the others come from the present parameter of
    ``encoder``. Parameters of registers that are not given are omitted.

    Raises:
        ValueError: A byte belongs to no parameter.
        RangeError: A byte, a code or a parameter is not allowed.
        TypeError: The contents are not a mapping, or an address is not an integer.
    """
    _check_contents(register_bytes)
    for address in register_bytes:
        whole_number("the address of a register", address)
    values: dict[str, int] = {}
    known_addresses: set[int] = set()
    encoder_parameters = _select_parameters(parameters, encoder)
    for parameter in encoder_parameters:
        name = parameter.name
        addresses = range(parameter.address, parameter.address + len(parameter.default))
        is_given = any(address in register_bytes for address in addresses)
        if not is_given:
            continue
        known_addresses.update(addresses)
        present_bytes = parameter.bytes_with(getattr(encoder, name))
        data = _replace_bytes(present_bytes, parameter.address, register_bytes)
        value = parameter.value_in(data)
        values[name] = check_limits(name, value, (parameter.min, parameter.max))
    unknown_addresses = sorted(register_bytes.keys() - known_addresses)
    if unknown_addresses:
        register = f"register 0x{unknown_addresses[0]:02X}"
        known_registers = sorted({parameter.address for parameter in encoder_parameters})
        listed = ", ".join(f"0x{address:02X}" for address in known_registers) or "none"
        raise ValueError(f"{register} does not affect decoding; registers that do: {listed}")
    return values


def _check_contents(contents: object) -> None:
    """Raise TypeError if the contents of registers are not given by address or by name."""
    if not isinstance(contents, Mapping):
        raise TypeError(f"register contents must be a mapping, such as {{0x44: 7}}, not {type(contents).__name__}")


def _replace_bytes(data: bytes, first_address: int, register_bytes: Mapping[int, int]) -> bytes:
    """Return the bytes of a register, with those that are in ``register_bytes`` by address replaced.

    Raises RangeError if a replacement is not a byte.
    """
    changed_data = bytearray(data)
    for index in range(len(data)):
        address = first_address + index
        if address in register_bytes:
            changed_data[index] = check_width(f"register 0x{address:02X}", register_bytes[address], 8)
    return bytes(changed_data)


def _select_parameters(parameters: tuple[RegisterParameter, ...], encoder: Encoder) -> list[RegisterParameter]:
    """Return the parameters that apply to the interface of an encoder."""
    return [parameter for parameter in parameters if parameter.interface is encoder.interface]


def format_parameters(parameters: tuple[RegisterParameter, ...], encoder: Encoder) -> str:
    """Return the parameters of an encoder that differ from the factory default, as text.

    The text of each parameter begins with a space, such as `` singleturn_bits=17``. A parameter without a factory
    default is always included.
    """
    texts: list[str] = []
    for parameter in _select_parameters(parameters, encoder):
        value = getattr(encoder, parameter.name)
        default_value = parameter.value_in(parameter.default)
        if parameter.by_order_code or value != default_value:
            texts.append(f" {parameter.name}={value}")
    return "".join(texts)


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


def bytes_by_address(read: Mapping[int, int] | Mapping[str, Data], registers: Mapping[str, Located]) -> dict[int, int]:
    """Return the bytes of registers by address. ``read`` contains bytes by address, or whole registers by name.

    ``{0x44: 7, "SERIAL": b"AB"}`` becomes ``{0x44: 7, 0x50: 65, 0x51: 66}`` if the register is at 0x50. ``registers``
    contains the address and the length of each register by name.

    Raises:
        ValueError: There is no register of this name.
        LengthError: A register has a different number of bytes.
        RangeError: A byte is not 0 to 255.
        TypeError: The contents are not a mapping, an address or a byte is not an integer, or a register is not bytes.
    """
    _check_contents(read)
    bytes_read: dict[int, int] = {}
    value: Any
    for key, value in read.items():
        if not isinstance(key, str):
            address = whole_number("the address of a register", key)
            bytes_read[address] = check_width(f"the byte at 0x{address:02X}", value, 8)
            continue
        register = registers.get(key)
        if register is None:
            raise ValueError(f"no register '{key}'; the registers are {', '.join(registers)}")
        try:
            data = as_bytes(value)
        except TypeError:
            raise TypeError(f"register '{key}' must be bytes, got {shorten(value)}") from None
        if len(data) != register.length:
            raise LengthError(register.length, len(data))
        bytes_read.update(enumerate(data, register.address))
    return bytes_read


def is_consistent(
    register_bytes: Mapping[int, int], address: int, length: int, is_expected: Callable[[bytes], bool]
) -> bool:
    """Return whether a register has the expected value, or True if not all of its bytes were read.

    ``register_bytes`` are the bytes that were read, by address. ``is_expected`` returns whether the register
    contains the expected bytes. Bytes that cannot be decoded count as not expected.
    """
    addresses = range(address, address + length)
    data = [register_bytes[byte_address] for byte_address in addresses if byte_address in register_bytes]
    is_complete = len(data) == length
    if not is_complete:
        return True
    try:
        return is_expected(bytes(data))
    except FrameError:
        return False
