"""Names of items in text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from ..model import Device
from .text import Ref

_ACRONYMS = {
    "biss": "BiSS",
    "crc": "CRC",
    "eeprom": "EEPROM",
    "id": "ID",
    "led": "LED",
    "leds": "LEDs",
    "lsb": "LSB",
    "rs485": "RS-485",
    "scd": "SCD",
    "spi": "SPI",
    "ssi": "SSI",
    "um": "µm",
}


class Titled(Protocol):
    """Item of the spec, with our name and the name used in the manual."""

    @property
    def name(self) -> str: ...
    @property
    def printed_name(self) -> str: ...


class Named(Titled, Protocol):
    """Item that may also have other names in other editions of the manual."""

    @property
    def names(self) -> Mapping[str, str]: ...


def words(name: str) -> str:
    """Return a name as words in a sentence: ``encoder_id`` as ``encoder ID``."""
    return " ".join(_ACRONYMS.get(word, word) for word in name.split("_"))


def heading(name: str) -> str:
    """Return a name as a heading: ``Encoder ID``."""
    text = words(name)
    return text[0].upper() + text[1:]


def title(titled: Titled) -> str:
    """Return the name used in the manual, or our name if the manual has none."""
    return titled.printed_name or heading(titled.name)


def printed(named: Named) -> str:
    """Return the name used in any edition of the manual, or an empty string."""
    return named.printed_name or ", ".join(named.names.values())


def own_names(named: Named) -> str:
    """Return the names used in the manual and its other editions: ``Command, it: Comando``."""
    return ", ".join(filter(None, (named.printed_name, *(f"{key}: {name}" for key, name in named.names.items()))))


def full_title(named: Named) -> str:
    """Return the title, followed by the names used in other editions: ``Command (it: Comando)``."""
    other_names = "; ".join(f"{key}: {name}" for key, name in named.names.items() if name != title(named))
    return title(named) + (f" ({other_names})" if other_names else "")


def register(device: Device, name: str) -> Ref:
    return Ref("register", name, title(device.register(name)))


def register_field(device: Device, path: str) -> Ref:
    """Return a reference to ``register.field``, or to the register if no field is given."""
    name, _, field = path.partition(".")
    if not field:
        return register(device, name)
    owner = device.register(name)
    return Ref("register", path, f"{title(owner.layout.field(field))} in {title(owner)}")
