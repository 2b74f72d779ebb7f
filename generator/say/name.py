"""What things are called in running text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from ..model import Device
from .text import Ref

_ACRONYMS = {"id": "ID", "ssi": "SSI", "biss": "BiSS", "crc": "CRC", "eeprom": "EEPROM", "led": "LED"}


class Titled(Protocol):
    """Something of the spec with a name of its own, and what the manual calls it."""

    @property
    def name(self) -> str: ...
    @property
    def printed_name(self) -> str: ...


class Named(Titled, Protocol):
    """The same, where other editions of the manual have names for it too."""

    @property
    def names(self) -> Mapping[str, str]: ...


def words(name: str) -> str:
    """A name as running text: ``encoder_id`` as ``encoder ID``."""
    return " ".join(_ACRONYMS.get(word, word) for word in name.split("_"))


def heading(name: str) -> str:
    """A name as a heading: ``Encoder ID``."""
    text = words(name)
    return text[0].upper() + text[1:]


def title(item: Titled) -> str:
    """What to call it: the manual's own name, else ours."""
    return item.printed_name or heading(item.name)


def printed(item: Named) -> str:
    """The manual's own name, in whatever language; empty where the manual has none."""
    return item.printed_name or ", ".join(item.names.values())


def own_names(item: Named) -> str:
    """The manual's own name and those of its other editions: ``Command, it: Comando``."""
    return ", ".join(filter(None, (item.printed_name, *(f"{key}: {name}" for key, name in item.names.items()))))


def full_title(item: Named) -> str:
    """What to call it, and in parentheses what other editions of the manual do: ``Command (it: Comando)``."""
    others = "; ".join(f"{key}: {name}" for key, name in item.names.items() if name != title(item))
    return title(item) + (f" ({others})" if others else "")


def register(device: Device, name: str) -> Ref:
    return Ref("register", name, title(device.register(name)))


def register_field(device: Device, path: str) -> Ref:
    """A field of a register, written as ``register.field``; without a field the register."""
    name, _, field = path.partition(".")
    if not field:
        return register(device, name)
    owner = device.register(name)
    return Ref("register", path, f"{title(owner.layout.field(field))} of {title(owner)}")
