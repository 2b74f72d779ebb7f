"""Locations in the devices of a master to which programs write settings."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby
from typing import Any

from ..language.problems import join_words
from ..language.written_masters import TYPES
from ..model.record import dataclass
from ..say.plain_text import count_with_unit

#: Mapping from the file that describes a master, such as a rule.
YamlMapping = Mapping[str, Any]

NOT_GIVEN = "not_given"


@dataclass(frozen=True, slots=True)
class MasterDevice:
    """A device of a master, with the names of its channels. An empty name stands for the only channel."""

    name: str
    channels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SettingPlace:
    """A location to which a value is written, on one channel of one device of a master.

    The location is an index with a subindex, a symbol, a register or an address. Numbers that no document gives are
    None, and texts are empty. ``type`` is the data type as named in the document, and ``kind`` and ``bits`` are its
    meaning. ``unit`` is ``none`` for a plain number or a code. ``is_default`` is true if the value equals the factory
    default.
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
        """The location in words, such as ``0x8000:01``, or an empty string if no document gives it."""
        if self.index is not None:
            return f"0x{self.index:04X}:{self.subindex:02X}"
        words = self.symbol or self.register
        if not words and self.address is not None:
            words = f"address {self.address}"
        if self.high_bit is None:
            return words
        if self.high_bit == self.low_bit:
            return f"{words}, bit {self.low_bit}"
        return f"{words}, bits {self.high_bit}:{self.low_bit}"


def devices_of(master_data: YamlMapping) -> tuple[MasterDevice, ...]:
    """Return the devices that the description of a master lists or, without a list, the master as its only device."""
    device_descriptions = master_data.get("devices", ({"name": master_data["title"]},))
    devices: list[MasterDevice] = []
    for description in device_descriptions:
        channels = tuple(description.get("channels", ("",)))
        devices.append(MasterDevice(name=description["name"], channels=channels))
    return tuple(devices)


def places_of(
    setting: YamlMapping,
    value: int | bool | str | None,
    *,
    devices: Sequence[MasterDevice],
    standing: str,
    fill_in: Callable[[str], str],
) -> tuple[SettingPlace, ...]:
    """Return the locations of a setting with this value in the devices of a master.

    ``standing`` says whether the description is documented, derived or tested. ``fill_in`` replaces names in braces by
    facts about the encoder. Locations without such names are cached for each value.
    """
    depends_on_record = any("{" in str(rule.get("symbol", "")) for rule in setting["places"])
    cache_key = (id(setting), value, standing)
    cached_setting, places = _SETTING_AND_PLACES.get(cache_key, (None, ()))
    # The id of a deleted object can be used again.
    is_cached = cached_setting is setting
    if is_cached:
        return places
    places = _compute_places(setting, value, devices=devices, standing=standing, fill_in=fill_in)
    if not depends_on_record:
        _SETTING_AND_PLACES[cache_key] = setting, places
    return places


#: Settings with their locations, by the id of the setting, its value and its standing.
_SETTING_AND_PLACES: dict[tuple[int, int | bool | str | None, str], tuple[YamlMapping, tuple[SettingPlace, ...]]] = {}


def _compute_places(
    setting: YamlMapping,
    value: int | bool | str | None,
    *,
    devices: Sequence[MasterDevice],
    standing: str,
    fill_in: Callable[[str], str],
) -> tuple[SettingPlace, ...]:
    """Return the locations of a setting on each device that has it, one for each channel if they differ by channel."""
    places: list[SettingPlace] = []
    for rule in setting["places"]:
        for device in devices:
            # Without the key 'on', the location is in all devices.
            if device.name not in rule.get("on", (device.name,)):
                continue
            channel_count = len(device.channels) if _differs_by_channel(rule) else 1
            for channel_index in range(channel_count):
                place = _place_on_channel(rule, device, channel_index, value=value, standing=standing, fill_in=fill_in)
                places.append(place)
    return tuple(places)


def _differs_by_channel(rule: YamlMapping) -> bool:
    """Return whether the rule for a location lists a different location for each channel of a device."""
    return any(isinstance(rule.get(key), list) for key in ("index", "subindex", "symbol", "register", "address"))


def _find_for_channel(rule: YamlMapping, channel_index: int, key: str, default: Any = None) -> Any:
    """Return the value of a key of a rule, which has either one value or a list with a value for each channel."""
    value_or_list = rule.get(key, default)
    return value_or_list[channel_index] if isinstance(value_or_list, list) else value_or_list


def _place_on_channel(
    rule: YamlMapping,
    device: MasterDevice,
    channel_index: int,
    *,
    value: int | bool | str | None,
    standing: str,
    fill_in: Callable[[str], str],
) -> SettingPlace:
    """Return the location of a value on one channel of a device.

    ``fill_in`` replaces names in braces by facts about the encoder.
    """
    find_for_channel = partial(_find_for_channel, rule, channel_index)
    kind, type_bits = TYPES.get(rule["type"], ("", None))
    # Without bits such as "5:0", the data type determines their number.
    high_bit, low_bit = _parse_bits(str(rule.get("at", "")))
    place_bits = type_bits if high_bit is None or low_bit is None else high_bit - low_bit + 1
    default = None if rule["default"] == NOT_GIVEN else rule["default"]
    return SettingPlace(
        device=device.name,
        channel=device.channels[channel_index] if _differs_by_channel(rule) else "",
        index=find_for_channel("index"),
        subindex=find_for_channel("subindex"),
        symbol=fill_in(find_for_channel("symbol", "")),
        register=find_for_channel("register", ""),
        address=find_for_channel("address"),
        high_bit=high_bit,
        low_bit=low_bit,
        type=_without_not_given(rule["type"]),
        kind=kind,
        bits=place_bits,
        minimum=rule.get("min"),
        maximum=rule.get("max"),
        unit=_without_not_given(rule["unit"]),
        default=default,
        is_default=default is not None and default == value,
        standing=rule.get("standing", standing),
        source=rule["source"],
    )


def _without_not_given(text: str) -> str:
    """Return the text, or an empty string for ``not_given``, the word for facts that no document gives."""
    return "" if text == NOT_GIVEN else text


def _parse_bits(text: str) -> tuple[int | None, int | None]:
    """Parse a bit range such as ``5:0`` or ``6``, and return its highest and its lowest bit.

    Both are None if the text is empty.
    """
    if not text:
        return None, None
    high, _, low = text.partition(":")
    return int(high), int(low or high)  # A single bit is both.


def reason_for_misfit(name: str, value: int | bool | str | None, places: Sequence[SettingPlace]) -> str:
    """Return an error message if a number does not fit in one of its locations, or an empty string.

    The message is, for example, ``Bits would be 70, but it is at most 63``. Texts always fit.
    """
    if not isinstance(value, int):
        return ""
    for place in places:
        highest = _highest_value(place)
        if highest is not None and value > highest:
            return f"{name} would be {value}, but it is at most {highest}"
        if place.minimum is not None and value < place.minimum:
            return f"{name} would be {value}, but it is at least {place.minimum}"
    return ""


def _highest_value(place: SettingPlace) -> int | None:
    """Return the highest number that fits in the range and the bits of a location, or None if there is no limit."""
    limits = [] if place.maximum is None else [place.maximum]
    if place.kind == "unsigned" and place.bits is not None:
        all_ones = (1 << place.bits) - 1
        limits.append(all_ones)
    return min(limits, default=None)


@dataclass(frozen=True, slots=True)
class PlaceWords:
    """A location of a setting in words, for all devices and channels with the same data.

    Texts that no document gives are empty.
    """

    devices: str
    location: str
    type: str
    unit: str
    range: str
    default: str
    is_default: bool
    mark: str
    source: str


def place_words(places: Sequence[SettingPlace], value: str, devices: Sequence[MasterDevice]) -> Iterator[PlaceWords]:
    """Yield the locations of a value in words, once for all devices with the same words.

    The member ``devices`` is empty if these are all devices. The factory default is in hexadecimal if ``value`` is.
    """
    devices_by_words: dict[PlaceWords, list[str]] = {}
    # Adjacent places of a device are its channels.
    for device, device_places in groupby(places, key=lambda place: place.device):
        words = _words_for_device(list(device_places), in_hex=value.startswith("0x"))
        devices_by_words.setdefault(words, []).append(device)
    for words, device_names in devices_by_words.items():
        are_all_devices = len(device_names) == len(devices)
        yield words if are_all_devices else replace(words, devices=", ".join(device_names))


def place_lines(places: Sequence[SettingPlace], value: str, devices: Sequence[MasterDevice]) -> Iterator[str]:
    """Yield the locations of a value as texts: ``0x8000:01, UINT16, unit kHz, factory default 500 [X:p. 3]``."""
    for words in place_words(places, value, devices):
        unit = f"unit {words.unit}" if words.unit not in ("", "none") else ""
        default = f"factory default {words.default}" if words.default else ""
        advice = "leave it" if words.is_default else ""
        facts = [words.location, words.type, unit, words.range, default, advice]
        facts = [fact for fact in facts if fact]
        texts = {"place": words.location, "data type": words.type, "unit": words.unit, "factory default": words.default}
        missing_facts = [name for name, text in texts.items() if not text]
        if missing_facts:
            facts.append(f"{join_words(missing_facts)} not given")
        devices_prefix = f"{words.devices}: " if words.devices else ""
        yield f"{devices_prefix}{', '.join(facts)}{words.mark} [{words.source}]"


def _words_for_device(channel_places: Sequence[SettingPlace], *, in_hex: bool) -> PlaceWords:
    """Return a location on all channels of one device in words. The channels differ only in their locations."""
    place = channel_places[0]
    data_type = place.type.replace("signed_n", "signed n")
    if place.type == "bits":
        data_type = count_with_unit(place.bits or 0, "bit")
    default = "" if place.default is None else str(place.default)
    if isinstance(place.default, bool):
        default = default.upper()
    elif isinstance(place.default, int) and in_hex:
        default = f"0x{place.default:02X}"
    has_range = place.minimum is not None or place.maximum is not None
    return PlaceWords(
        devices="",
        location=", ".join(map(_location_and_channel, channel_places)),
        type=data_type,
        unit=place.unit,
        range=_range_in_words(place.minimum, place.maximum) if has_range else "",
        default=default,
        is_default=place.is_default,
        mark=" *" if place.standing == "inferred" else "",
        source=place.source.replace("; ", ", "),
    )


def _location_and_channel(place: SettingPlace) -> str:
    """Return a location in words, with the name of its channel in parentheses if it has one."""
    return f"{place.location} ({place.channel})" if place.channel else place.location


def _range_in_words(lowest: int | None, highest: int | None) -> str:
    """Return a range of values in words. At least one of the limits is not None."""
    if lowest is None:
        return f"at most {highest}"
    return f"at least {lowest}" if highest is None else f"{lowest} to {highest}"
