"""Locations in the devices of a master to which programs write settings, conditions for writing, and its order."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from itertools import groupby
from typing import Any, NamedTuple

from ..language.keys_of_masters import TYPES
from ..language.problems import join_words
from ..model.record import dataclass
from ..say import count_with_unit

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
    depends_on_encoder = any("{" in str(location_rule.get("symbol", "")) for location_rule in setting["places"])
    cache_key = (id(setting), value, standing)
    cached_setting, places = _SETTING_AND_PLACES.get(cache_key, (None, ()))
    # The id of a deleted object can be used again.
    is_cached = cached_setting is setting
    if is_cached:
        return places
    places = _compute_places(setting, value, devices=devices, standing=standing, fill_in=fill_in)
    if not depends_on_encoder:
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
    for location_rule in setting["places"]:
        for device in devices:
            # Without the key 'on', the location is in all devices.
            if device.name not in location_rule.get("on", (device.name,)):
                continue
            channel_count = len(device.channels) if _differs_by_channel(location_rule) else 1
            for channel_index in range(channel_count):
                place = _place_on_channel(
                    location_rule, device, channel_index, value=value, standing=standing, fill_in=fill_in
                )
                places.append(place)
    return tuple(places)


def _differs_by_channel(location_rule: YamlMapping) -> bool:
    """Return whether the rule for a location lists a different location for each channel of a device."""
    return any(
        isinstance(location_rule.get(key), list) for key in ("index", "subindex", "symbol", "register", "address")
    )


def _value_for_channel(location_rule: YamlMapping, channel_index: int, key: str, default: Any = None) -> Any:
    """Return the value of a key of a rule, which has either one value or a list with a value for each channel."""
    value_or_list = location_rule.get(key, default)
    return value_or_list[channel_index] if isinstance(value_or_list, list) else value_or_list


def _place_on_channel(
    location_rule: YamlMapping,
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
    value_for_channel = partial(_value_for_channel, location_rule, channel_index)
    kind_of_number, type_bits = TYPES.get(location_rule["type"], ("", None))
    # Without bits such as "5:0", the data type determines their number.
    high_bit, low_bit = _parse_bits(str(location_rule.get("at", "")))
    bit_count = type_bits if high_bit is None or low_bit is None else high_bit - low_bit + 1
    default = None if location_rule["default"] == NOT_GIVEN else location_rule["default"]
    return SettingPlace(
        device=device.name,
        channel=device.channels[channel_index] if _differs_by_channel(location_rule) else "",
        index=value_for_channel("index"),
        subindex=value_for_channel("subindex"),
        symbol=fill_in(value_for_channel("symbol", "")),
        register=value_for_channel("register", ""),
        address=value_for_channel("address"),
        high_bit=high_bit,
        low_bit=low_bit,
        type=_blank_if_not_given(location_rule["type"]),
        kind=kind_of_number,
        bits=bit_count,
        minimum=location_rule.get("min"),
        maximum=location_rule.get("max"),
        unit=_blank_if_not_given(location_rule["unit"]),
        default=default,
        is_default=default is not None and default == value,
        standing=location_rule.get("standing", standing),
        source=location_rule["source"],
    )


def _blank_if_not_given(text: str) -> str:
    """Return the text, or an empty string for ``not_given``, the word for facts that no document gives."""
    return "" if text == NOT_GIVEN else text


def _parse_bits(range_text: str) -> tuple[int | None, int | None]:
    """Parse a bit range such as ``5:0`` or ``6``, and return its highest and its lowest bit.

    Both are None if the text is empty.
    """
    if not range_text:
        return None, None
    highest_bit, _, lowest_bit = range_text.partition(":")
    return int(highest_bit), int(lowest_bit or highest_bit)  # A single bit is both.


def place_lines(places: Sequence[SettingPlace], value: str, devices: Sequence[MasterDevice]) -> Iterator[str]:
    """Yield the locations of a value as texts: ``0x8000:01, UINT16, unit kHz, factory default 500 [X:p. 3]``.

    Devices with the same text share a line, which begins with their names unless they are all devices. The factory
    default is in hexadecimal if ``value`` is.
    """
    device_names_by_text: dict[str, list[str]] = {}
    # Adjacent places of a device are its channels.
    for device_name, device_places in groupby(places, key=lambda place: place.device):
        text = _place_text(list(device_places), in_hex=value.startswith("0x"))
        device_names_by_text.setdefault(text, []).append(device_name)
    for text, device_names in device_names_by_text.items():
        are_all_devices = len(device_names) == len(devices)
        yield text if are_all_devices else f"{', '.join(device_names)}: {text}"


def _place_text(channel_places: Sequence[SettingPlace], *, in_hex: bool) -> str:
    """Return a location on all channels of one device as text. The channels differ only in their locations."""
    first_place = channel_places[0]
    location = ", ".join(map(_location_and_channel, channel_places))
    data_type = first_place.type.replace("signed_n", "signed n")
    if first_place.type == "bits":
        data_type = count_with_unit(first_place.bits or 0, "bit")
    default = _default_text(first_place.default, in_hex=in_hex)
    phrases = [
        location,
        data_type,
        f"unit {first_place.unit}" if first_place.unit not in ("", "none") else "",
        _range_in_words(first_place.minimum, first_place.maximum),
        f"factory default {default}" if default else "",
        "leave it" if first_place.is_default else "",
    ]
    fact_by_name = {"place": location, "data type": data_type, "unit": first_place.unit, "factory default": default}
    missing_facts = [name for name, fact in fact_by_name.items() if not fact]
    if missing_facts:
        phrases.append(f"{join_words(missing_facts)} not given")
    mark = " *" if first_place.standing == "inferred" else ""
    source = first_place.source.replace("; ", ", ")
    return f"{', '.join(filter(None, phrases))}{mark} [{source}]"


def _default_text(default: int | bool | str | None, *, in_hex: bool) -> str:
    """Return a factory default as text: ``TRUE``, ``500``, ``0x1F4``, or an empty string if no document gives it."""
    if default is None:
        return ""
    if isinstance(default, bool):
        return str(default).upper()
    return f"0x{default:02X}" if isinstance(default, int) and in_hex else str(default)


def _location_and_channel(place: SettingPlace) -> str:
    """Return a location in words, with the name of its channel in parentheses if it has one."""
    return f"{place.location} ({place.channel})" if place.channel else place.location


def _range_in_words(lowest: int | None, highest: int | None) -> str:
    """Return a range of values in words, or an empty string if no document gives a limit."""
    if lowest is None:
        return f"at most {highest}" if highest is not None else ""
    return f"at least {lowest}" if highest is None else f"{lowest} to {highest}"


@dataclass(frozen=True, slots=True)
class ObjectWrite:
    """A value to write to an object of the master. ``text`` is the value in decimal or hexadecimal."""

    object: str
    name: str
    value: int | str
    text: str
    places: tuple[SettingPlace, ...]

    @property
    def title(self) -> str:
        """The object with its name in parentheses, if it has one."""
        return f"{self.object} ({self.name})" if self.name else self.object


@dataclass(frozen=True, slots=True)
class WriteEffect:
    """Condition under which a written value takes effect. Exactly one member is not empty."""

    in_state: str = ""
    restart_of: str = ""
    by_call: str = ""
    at_once: bool = False


@dataclass(frozen=True, slots=True)
class WriteCondition:
    """A condition for writing settings.

    Exactly one of ``needs``, ``after``, ``then`` and ``takes_effect`` is not empty. ``of`` names the settings, and is
    empty if the condition applies to all. ``needs`` are values to write before these settings, ``after`` names settings
    to write before them, and ``then`` are values to write after them.
    """

    of: tuple[str, ...]
    needs: tuple[ObjectWrite, ...]
    after: tuple[str, ...]
    then: tuple[ObjectWrite, ...]
    takes_effect: WriteEffect | None
    standing: str
    source: str
    text: str


def writing_of(
    rules: Iterable[YamlMapping], setting_names: Collection[str], *, devices: Sequence[MasterDevice], standing: str
) -> tuple[WriteCondition, ...]:
    """Return the conditions for writing the settings with these names.

    A rule lists its settings under ``of``, or applies to all, and can list other settings to write first under
    ``after``. It is omitted if none of the settings in one of these lists is in ``setting_names``.
    """
    conditions: list[WriteCondition] = []
    for rule in rules:
        settings = _known_setting_names(rule, "of", setting_names)
        predecessors = _known_setting_names(rule, "after", setting_names)
        has_no_setting = "of" in rule and not settings
        has_no_predecessor = "after" in rule and not predecessors
        if has_no_setting or has_no_predecessor:
            continue
        condition = _write_condition(
            rule, settings=settings, predecessors=predecessors, devices=devices, standing=standing
        )
        conditions.append(condition)
    return tuple(conditions)


def _known_setting_names(rule: YamlMapping, key: str, setting_names: Collection[str]) -> tuple[str, ...]:
    """Return the names that a rule lists under ``key`` and that are also in ``setting_names``."""
    return tuple(name for name in rule.get(key, ()) if name in setting_names)


def _write_condition(
    rule: YamlMapping,
    *,
    settings: tuple[str, ...],
    predecessors: tuple[str, ...],
    devices: Sequence[MasterDevice],
    standing: str,
) -> WriteCondition:
    """Return a condition for writing, with its text.

    ``settings`` are the settings to which it applies, and ``predecessors`` are settings to write before them.
    """
    writes_before = tuple(_write_from_rule(write_rule, devices, standing) for write_rule in rule.get("needs", ()))
    writes_after = tuple(_write_from_rule(write_rule, devices, standing) for write_rule in rule.get("then", ()))
    condition = WriteCondition(
        of=settings,
        needs=writes_before,
        after=predecessors,
        then=writes_after,
        takes_effect=WriteEffect(**rule["takes_effect"]) if "takes_effect" in rule else None,
        standing=rule.get("standing", standing),
        source=rule["source"],
        text="",
    )
    return replace(condition, text=_condition_text(condition))


def _write_from_rule(rule: YamlMapping, devices: Sequence[MasterDevice], standing: str) -> ObjectWrite:
    """Return a value to write with its locations. Its text is hexadecimal if the rule has ``as: hex``."""
    value = rule["value"]
    return ObjectWrite(
        object=rule["object"],
        name=rule.get("name", ""),
        value=value,
        text=f"0x{value:X}" if rule.get("as") == "hex" else str(value),
        # Locations of such values contain no names in braces to fill in.
        places=places_of(rule, value, devices=devices, standing=standing, fill_in=str),
    )


def write_order(names: Sequence[str], rules: Iterable[WriteCondition]) -> tuple[str, ...]:
    """Return the names of settings in the order in which to write them.

    The original order is changed only if a rule requires that a setting is written after others.
    """
    orderings = tuple(_Ordering(settings=rule.of, after=rule.after) for rule in rules if rule.after)
    return _names_in_order(tuple(names), orderings)


class _Ordering(NamedTuple):
    """Rule that each of ``settings`` must be written after all settings in ``after``."""

    settings: tuple[str, ...]
    after: tuple[str, ...]


@lru_cache(maxsize=64)
def _names_in_order(names: tuple[str, ...], orderings: tuple[_Ordering, ...]) -> tuple[str, ...]:
    """Return the names in an order in which all predecessors of a name come before it.

    The next name is always the first one whose predecessors have all been written. Cycles are rejected when a
    description is loaded. Results are cached, since many order codes have the same rules.
    """
    predecessors_by_name = {name: set[str]() for name in names}
    for ordering in orderings:
        for name in ordering.settings:
            predecessors_by_name[name].update(ordering.after)
    written_names: list[str] = []
    while len(written_names) < len(names):
        unwritten_names = [name for name in names if name not in written_names]
        ready_names = [name for name in unwritten_names if predecessors_by_name[name].issubset(written_names)]
        written_names.append(ready_names[0])
    return tuple(written_names)


def _condition_text(condition: WriteCondition) -> str:
    """Return a condition for writing as one sentence.

    It is about values to write before or after the settings, about the order of settings, or about the time when they
    take effect.
    """
    # Empty if the condition applies to all settings.
    setting_names = join_words(condition.of)
    if condition.needs:
        needed_values = join_words(f"{write.title} must be {write.text}" for write in condition.needs)
        return f"Before writing {setting_names or 'any setting'}, {needed_values}."
    if condition.after:
        return f"Write {setting_names} after {join_words(condition.after)}."
    if condition.then:
        values_to_set = join_words(f"{write.title} to {write.text}" for write in condition.then)
        return f"After writing {setting_names or 'all settings'}, set {values_to_set}."
    assert condition.takes_effect is not None
    verb = "takes" if len(condition.of) == 1 else "take"
    return f"{setting_names or 'All settings'} {verb} effect {_when_effective(condition.takes_effect)}."


def _when_effective(effect: WriteEffect) -> str:
    """Return the words for the time when a written value takes effect, such as ``immediately``."""
    if effect.in_state:
        return f"only in the {effect.in_state} state"
    if effect.restart_of:
        return f"after a restart of {effect.restart_of}"
    if effect.by_call:
        return f"when {effect.by_call} is called"
    return "immediately"
