"""Where and how a program writes a setting: index or symbol, data type, unit, range and factory default."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from ..language.master_items import TYPES

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
        """The place in words, or an empty text if it is not given."""
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
    high, low = _bits(rule.get("bits", ""))
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
    """Return the highest and the lowest bit of ``5:0`` or ``6``, or twice None."""
    if not text:
        return None, None
    high, _, low = text.partition(":")
    return int(high), int(low or high)


def misfit(name: str, value: int | bool | str | None, places: Sequence[Place]) -> str:
    """Return why a place cannot hold a value, or an empty text."""
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


def place_lines(places: Sequence[Place], shown: Callable[[int | bool | str], str]) -> Iterator[str]:
    """Yield the places in words, those with the same data on several devices or channels as one line."""

    def rest(place: Place) -> str:
        type_ = place.type.replace("_", " ") or "data type not given"
        if place.type == "bits":
            type_ = f"{place.bits} bits" if place.bits != 1 else "1 bit"
        unit = {"": "unit not given", "none": ""}.get(place.unit, f"unit {place.unit}")
        bounds = [] if place.minimum is None else [f"at least {place.minimum}"]
        bounds += [] if place.maximum is None else [f"at most {place.maximum}"]
        if len(bounds) == 2:
            bounds = [f"{place.minimum} to {place.maximum}"]
        default = "factory default not given"
        if place.default is not None:
            default = f"factory default {shown(place.default)}{', leave it' if place.is_default else ''}"
        mark = " *" if place.standing == "inferred" else ""
        return f"{', '.join(filter(None, [type_, unit, *bounds, default]))}{mark} [{place.source.replace('; ', ', ')}]"

    by_device = [
        (device, locations, rest(group[0]))
        for device, run in groupby(places, key=lambda item: item.device)
        for group in [list(run)]
        for locations in [_locations(group)]
    ]
    several = len({place.device for place in places}) > 1 or len(by_device) > 1
    lines: dict[tuple[str, str], list[str]] = {}
    for device, locations, text in by_device:
        lines.setdefault((locations, text), []).append(device)
    for (locations, text), names in lines.items():
        on = f"{', '.join(names)}: " if several else ""
        yield f"{on}{locations or 'place not given'}, {text}"


def _locations(group: Sequence[Place]) -> str:
    return ", ".join(
        f"{place.location} ({place.channel})" if place.channel else place.location for place in group if place.location
    )
