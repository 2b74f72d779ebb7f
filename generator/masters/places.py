"""Locations to which programs write settings: index or symbol, data type, unit, range and factory default."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Any

from ..language.master_items import TYPES
from ..language.problems import listed
from ..model.record import dataclass
from ..say.words import counted

Raw = Mapping[str, Any]

NOT_GIVEN = "not_given"


@dataclass(frozen=True, slots=True)
class Device:
    """A device of a master, with the names of its channels. An empty name stands for the only channel."""

    name: str
    channels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Place:
    """A place to which a value is written, on one channel of one device.

    The place is an index with a subindex, a symbol, a register or an address. Numbers that no document gives are None,
    and texts are empty. ``type`` is the name in the document, ``kind`` and ``bits`` its meaning. ``unit`` is ``none``
    for a plain number or a code. ``is_default`` is true if the value equals the factory default.
    """

    device: str
    channel: str
    index: int | None
    subindex: int | None
    symbol: str
    register: str
    address: int | None
    high_bit: int | None
    low_bit: int | None
    type: str
    kind: str
    bits: int | None
    minimum: int | None
    maximum: int | None
    unit: str
    default: int | bool | str | None
    is_default: bool
    standing: str
    source: str

    @property
    def location(self) -> str:
        """The place in words, or an empty string if it is not given."""
        if self.index is not None:
            return f"0x{self.index:04X}:{self.subindex:02X}"
        words = self.symbol or self.register or (f"address {self.address}" if self.address is not None else "")
        if self.high_bit is None:
            return words
        bits = f"bits {self.high_bit}:{self.low_bit}" if self.high_bit != self.low_bit else f"bit {self.low_bit}"
        return f"{words}, {bits}"


def devices_of(data: Raw) -> tuple[Device, ...]:
    """Return the devices of a description, or the master itself as the only one."""
    listed = data.get("devices", ({"name": data["title"]},))
    return tuple(Device(item["name"], tuple(item.get("channels", ("",)))) for item in listed)


def places_of(
    item: Raw,
    value: int | bool | str | None,
    devices: Sequence[Device],
    standing: str,
    filled: Callable[[str], str],
) -> tuple[Place, ...]:
    """Return the places of a setting, one for each channel of each device."""
    named = any("{" in str(rule.get("symbol", "")) for rule in item["places"])
    if named:
        return _places_of(item, value, devices, standing, filled)
    key = (id(item), value, standing)
    found = _KNOWN.get(key)
    if found is None or found[0] is not item:
        found = _KNOWN[key] = (item, _places_of(item, value, devices, standing, filled))
    return found[1]


#: Places that are the same for all order codes with a value, with the item that they are for.
_KNOWN: dict[tuple[int, int | bool | str | None, str], tuple[Raw, tuple[Place, ...]]] = {}


def _places_of(
    item: Raw,
    value: int | bool | str | None,
    devices: Sequence[Device],
    standing: str,
    filled: Callable[[str], str],
) -> tuple[Place, ...]:
    return tuple(
        _place(rule, device, number, value, standing, filled)
        for rule in item["places"]
        for device in devices
        if device.name in rule.get("on", (device.name,))
        for number in range(len(device.channels) if _is_listed(rule) else 1)
    )


def _is_listed(rule: Raw) -> bool:
    return any(isinstance(rule.get(key), list) for key in ("index", "subindex", "symbol", "register", "address"))


def _place(
    rule: Raw,
    device: Device,
    number: int,
    value: int | bool | str | None,
    standing: str,
    filled: Callable[[str], str],
) -> Place:
    def here(key: str, otherwise: Any = None) -> Any:
        found = rule.get(key, otherwise)
        return found[number] if isinstance(found, list) else found

    kind, bits = TYPES.get(rule["type"], ("", None))
    high, low = _bits(str(rule.get("at", "")))
    default = None if rule["default"] == NOT_GIVEN else rule["default"]
    return Place(
        device.name,
        device.channels[number] if _is_listed(rule) else "",
        here("index"),
        here("subindex"),
        filled(here("symbol", "")),
        here("register", ""),
        here("address"),
        high,
        low,
        _given(rule["type"]),
        kind,
        bits if high is None or low is None else high - low + 1,
        rule.get("min"),
        rule.get("max"),
        _given(rule["unit"]),
        default,
        default is not None and default == value,
        rule.get("standing", standing),
        rule["source"],
    )


def _given(text: str) -> str:
    return "" if text == NOT_GIVEN else text


def _bits(text: str) -> tuple[int | None, int | None]:
    """Return the highest and the lowest bit of ``5:0`` or ``6``, or None for both."""
    if not text:
        return None, None
    high, _, low = text.partition(":")
    return int(high), int(low or high)


def misfit(name: str, value: int | bool | str | None, places: Sequence[Place]) -> str:
    """Return the reason that a location cannot hold a value, or an empty string."""
    if not isinstance(value, int):
        return ""
    for place in places:
        widest = (1 << place.bits) - 1 if place.kind == "unsigned" and place.bits is not None else value
        most, least = min(widest, value if place.maximum is None else place.maximum), place.minimum
        if value > most:
            return f"{name} would be {value}, but it is at most {most}"
        if least is not None and value < least:
            return f"{name} would be {value}, but it is at least {least}"
    return ""


@dataclass(frozen=True, slots=True)
class PlaceWords:
    """A place in words, for all devices and channels with the same data. Texts that no document gives are empty."""

    devices: str
    location: str
    type: str
    unit: str
    range: str
    default: str
    is_default: bool
    mark: str
    source: str


def place_words(places: Sequence[Place], value: str, devices: Sequence[Device]) -> Iterator[PlaceWords]:
    """Yield the places of a value in words, with factory defaults in its notation. No devices means all of them."""
    found: dict[PlaceWords, list[str]] = {}
    in_hex = value.startswith("0x")
    for device, run in groupby(places, key=lambda item: item.device):
        group = list(run)
        found.setdefault(_words(group, in_hex), []).append(device)
    for words, names in found.items():
        yield replace(words, devices=", ".join(names) if len(names) < len(devices) else "")


def place_lines(places: Sequence[Place], value: str, devices: Sequence[Device]) -> Iterator[str]:
    """Yield the places of a value as lines of text."""
    for found in place_words(places, value, devices):
        unit = f"unit {found.unit}" if found.unit not in ("", "none") else ""
        default = f"factory default {found.default}" if found.default else ""
        leave = "leave it" if found.is_default else ""
        facts = list(filter(None, (found.location, found.type, unit, found.range, default, leave)))
        names = {"place": found.location, "data type": found.type, "unit": found.unit, "factory default": found.default}
        missing = [name for name, given in names.items() if not given]
        facts += [f"{listed(missing)} not given"] if missing else []
        on = f"{found.devices}: " if found.devices else ""
        yield f"{on}{', '.join(facts)}{found.mark} [{found.source}]"


def _words(group: Sequence[Place], in_hex: bool) -> PlaceWords:
    """Return the words for the channels of one device, which differ only in their locations."""
    place = group[0]
    kind = counted(place.bits or 0, "bit") if place.type == "bits" else place.type.replace("signed_n", "signed n")
    default = "" if place.default is None else str(place.default)
    if isinstance(place.default, bool):
        default = default.upper()
    elif isinstance(place.default, int) and in_hex:
        default = f"0x{place.default:02X}"
    return PlaceWords(
        "",
        ", ".join(f"{item.location} ({item.channel})" if item.channel else item.location for item in group),
        kind,
        place.unit,
        "" if place.minimum is None and place.maximum is None else _range(place.minimum, place.maximum),
        default,
        place.is_default,
        " *" if place.standing == "inferred" else "",
        place.source.replace("; ", ", "),
    )


def _range(least: int | None, most: int | None) -> str:
    if least is None:
        return f"at most {most}"
    return f"at least {least}" if most is None else f"{least} to {most}"
