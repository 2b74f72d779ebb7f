"""A reading: a device with its file, and the cases for which its words are compared."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

from ..language.document import Document
from ..language.problems import Path
from ..model import INTERFACES, Device, Field, Layout, Register
from ..model.expressions import Expression
from ..model.record import dataclass
from ..order_codes.parameters import with_changed
from ..say.names_and_places import bits
from .fact import Case, Key

Parameters = Mapping[str, int]

_OR = " | "
_BREAKS = re.compile(r"[\W_]+")
#: Prefix of the names of fields that the build adds for zero bits.
_ZEROS = "zero"
#: Smallest number shown in hexadecimal.
_LONG = 10_000


@dataclass(frozen=True)
class Reading:
    """A device and its file."""

    device: Device
    document: Document

    def cases(self, interface: str) -> Mapping[Case, Parameters]:
        """Return the parameters of each order code of an interface.

        The cases are the factory defaults, both ends of the range of each parameter in a register, and each other
        answer of an alternative.
        """
        return self._cases.get(interface, {})

    @cached_property
    def _cases(self) -> Mapping[str, Mapping[Case, Parameters]]:
        interfaces = {variant.interface for variant in self.device.variants}
        changes = {name: list(self._changes(name)) for name in interfaces}
        cases_by_interface: dict[str, dict[Case, Parameters]] = {name: {} for name in changes}
        for variant in self.device.variants:
            cases = cases_by_interface[variant.interface]
            cases[variant.code, ""] = variant.parameters
            for state, changed in changes[variant.interface]:
                cases[variant.code, state] = with_changed(self.device, variant, changed)
        return cases_by_interface

    def _changes(self, interface: str) -> Iterator[tuple[str, Parameters]]:
        for parameter in self.device.run_time_parameters:
            if parameter.interface in ("", interface):
                for bound in (parameter.min, parameter.max):
                    if bound is not None:
                        yield f"{self.bits_at(parameter.read_from)} = {bound}", {parameter.name: bound}
        for number, alternative in enumerate(self.device.alternatives, 1):
            for index, answer in enumerate(alternative.answers[1:], 2):
                yield f"answer {index} of alternative {number}", answer.sets

    def bits_at(self, path: str) -> str:
        """Return the bits of a register given by ``register.field``, in words without names."""
        register, field = self._field_at(path)
        if register is None or field is None:
            return path
        return f"{register_text(register)} {self.bits_of(register.interface, field)}"

    def state(self, path: str, name: str) -> str:
        """Return the condition that ``register.field`` has the value ``name``, in words without names."""
        _, field = self._field_at(path)
        values = field.values if field is not None else ()
        number = next((in_hex(value.value) for value in values if value.name == name), name)
        return f"{self.bits_at(path)} is {number}"

    def _field_at(self, path: str) -> tuple[Register | None, Field | None]:
        name, _, inner = path.partition(".")
        register = self.register(name)
        fields = register.layout.fields if register is not None else ()
        return register, next((field for field in fields if field.name == inner), None)

    def bits_of(self, interface: str, field: Field) -> str:
        """Return text such as ``bits 7:4`` for a field of a register or frame, for the first order code."""
        parameters = self._first_of(interface)
        low, width = field.low.value(parameters), field.width.value(parameters)
        return bits(low + width - 1, low)

    def _first_of(self, interface: str) -> Parameters:
        """Return the parameters of the first order code of an interface by name, as readers list codes differently."""
        codes = (variant for variant in self.device.variants if variant.interface == interface)
        first_variant = min(codes, key=lambda variant: variant.code, default=None)
        return first_variant.parameters if first_variant is not None else {}

    def register(self, name: str) -> Register | None:
        return next((candidate for candidate in self.device.registers if candidate.name == name), None)

    def field_place(self, owner: Path, field: Field) -> Path:
        """Return the place of a field in the spec: in its group, in the layout, or at another key of the layout."""
        if field.group:
            owner = ("field_groups", field.group)
        own_place: Path = (*owner, "fields", field.padding_of or field.name)
        if field.name.startswith(_ZEROS) and not self.document.has(own_place):
            return (*owner, "other_bits")
        return self.first_existing(own_place, owner)

    def bits_in_frames(self, interface: str, layout: Layout, field: Field) -> Iterator[str]:
        """Yield a bit of each frame with a layout, in words without names, for the first order code."""
        frame = f"bit {field.low.value(self._first_of(interface))} of the {layout.sender}'s frame"
        yield from (f"{frame} with {in_hex(value)}" for value in layout.selects)
        if not layout.selects:
            yield frame

    def printed_names(self, part: Any) -> Mapping[str, str]:
        """Return the names of an item as printed, by language. Several in one language are alternatives."""
        texts_by_language = {language: [plain(text)] for language, text in getattr(part, "names", {}).items()}
        if name := getattr(part, "printed_name", ""):
            texts_by_language.setdefault(self.device.manual.language, []).append(plain(name))
        return {language: _OR.join(texts) for language, texts in texts_by_language.items()}

    def first_existing(self, *paths: Path) -> Path:
        """Return the first of these places that exists in the file, otherwise the last."""
        return next((path for path in paths if self.document.has(path)), paths[-1])

    def key_of(self, register: Register) -> Key:
        """Return the key of a register: interface, bank, address, and readability if several share the address."""
        bank = -1 if register.bank is None else register.bank
        key = ("register", register.interface, bank, register.address)
        addresses = [(peer.interface, peer.bank, peer.address) for peer in self.device.registers]
        if addresses.count((register.interface, register.bank, register.address)) < 2:
            return key
        return (*key, "read" if register.readable else "write")


def register_text(register: Register) -> str:
    """Return text such as ``register 0x49``, with its bank."""
    bank = f" of bank {register.bank}" if register.bank is not None else ""
    return f"register 0x{register.address:02X}{bank}"


def interface_label(interface: str) -> str:
    """Return the short name of an interface."""
    return INTERFACES[interface].short


def in_hex(value: int) -> str:
    """Return a number in the notation that specs use for bits."""
    return f"0x{value:02X}" if value > 9 else str(value)


def short(value: int) -> str:
    """Return a number in the notation for counts."""
    return str(value) if value < _LONG else f"0x{value:X}"


def as_delivered(register: Register) -> int | None:
    """Return the factory default of the register, as stated or from the documented values of all its fields."""
    if register.default is not None:
        return register.default
    default = 0
    for field in register.layout.fields:
        number = int.from_bytes(field.equals.encode("ascii"), "big") if isinstance(field.equals, str) else field.equals
        if isinstance(number, Expression):
            number = number.constant if number.is_constant else None
        if number is None or not field.carries_data or not field.low.is_constant:
            return None
        default |= number << field.low.constant
    return default


def same_name(texts: str, other_texts: str) -> bool:
    """Return True if two readers have a printed name in common. Alternatives are as from ``printed_names``."""
    return not set(texts.split(_OR)).isdisjoint(other_texts.split(_OR))


def plain(text: str) -> str:
    """Return text without the differences between readers: capitals and punctuation."""
    return _BREAKS.sub(" ", text).strip().casefold() or text
