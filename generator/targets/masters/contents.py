"""Content of the files for masters: the values of settings in the order of writing.

A file leaves out values that it cannot express, with a reason.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from ...language.keys_of_masters import FILE_FORMATS, PLACE_KINDS, FileFormat
from ...masters.places_and_writing import ObjectWrite, SettingPlace, YamlMapping, write_order
from ...masters.sheet import Setting, SettingsSheet
from ...masters.text import condition_text
from ...model.record import dataclass, first_or_raise

Value = int | bool | str


@dataclass(frozen=True, slots=True)
class FileValue:
    """The value of a setting in a file, and its location on one channel of a device.

    ``name`` is the name of the setting, and ``key`` its name in the file. ``value_text`` is the value in the notation
    of the file. ``mark`` says whether the value is derived or only a bound.
    """

    name: str
    key: str
    value: Value
    value_text: str
    mark: str
    place: SettingPlace

    @property
    def size(self) -> int:
        """The size of the data in bytes, rounded up."""
        bits = self.place.bits or 0
        return (bits + 7) // 8

    @property
    def number(self) -> int:
        """The value as a number."""
        return int(self.value)

    @property
    def data(self) -> bytes:
        """The data, little-endian."""
        return self.number.to_bytes(self.size, "little", signed=self.place.kind == "signed")

    @property
    def symbol(self) -> tuple[str, str]:
        """The structure and the member that a symbol such as ``settings.clock`` consists of."""
        structure, _, member = self.place.symbol.rpartition(".")
        return structure, member

    @property
    def mask(self) -> int:
        """The mask of the bits in the register."""
        width = self.place.bits or 0
        low_bit = self.place.low_bit or 0
        return ((1 << width) - 1) << low_bit

    @property
    def shifted(self) -> int:
        """The value shifted to its bits in the register."""
        return self.number << (self.place.low_bit or 0)

    @property
    def register(self) -> str:
        """The name of the register, or a name made of its address."""
        return self.place.register or f"ADDRESS_{self.place.address}"


@dataclass(frozen=True, slots=True)
class Channel:
    """The values for one channel of a device. The first channel also contains the values that all channels share."""

    name: str
    file_values: tuple[FileValue, ...]

    @property
    def registers(self) -> list[tuple[str, list[FileValue]]]:
        """The registers in the order of their names, each with its values in the order of their first bits."""
        values_by_register: dict[str, list[FileValue]] = {}
        for file_value in sorted(self.file_values, key=_first_bit):
            values_by_register.setdefault(file_value.register, []).append(file_value)
        return sorted(values_by_register.items())

    @property
    def structures(self) -> list[tuple[str, list[FileValue]]]:
        """The structures in the order of their names, each with its values in the order of writing."""
        values_by_structure: dict[str, list[FileValue]] = {}
        for file_value in self.file_values:
            structure, _ = file_value.symbol
            values_by_structure.setdefault(structure, []).append(file_value)
        return sorted(values_by_structure.items())


def _first_bit(file_value: FileValue) -> int:
    """Return the lowest bit of a value in its register."""
    return file_value.place.low_bit or 0


@dataclass(frozen=True, slots=True)
class Content:
    """The content of a file: the values of each channel.

    ``left_out`` are sentences about settings that the file does not contain, and ``conditions`` are sentences about the
    order and the conditions of writing.
    """

    channels: tuple[Channel, ...]
    omissions: tuple[str, ...]
    conditions: tuple[str, ...]

    @property
    def file_values(self) -> tuple[FileValue, ...]:
        """The values of the first channel."""
        return self.channels[0].file_values if self.channels else ()


def content_of_file(sheet: SettingsSheet, file_rule: YamlMapping, device: str) -> Content:
    """Return the content of a file for a device of a master, whose description of the file is ``file_rule``.

    For each setting that the file leaves out, and for each value that the format cannot express, the content has a
    sentence with the reason.
    """
    file_format = FILE_FORMATS[file_rule["format"]]
    file_values: list[FileValue] = []
    omissions: list[str] = []
    for setting, writes_before, writes_after in _settings_in_write_order(sheet):
        reason_to_leave_out = _reason_to_leave_out(setting, sheet, file_format)
        if reason_to_leave_out:
            omissions.append(f"{setting.name}: {reason_to_leave_out}.")
            continue
        to_write: tuple[Setting | ObjectWrite, ...] = (*writes_before, setting, *writes_after)
        for setting_or_write in to_write:
            reason_not_expressible = _reason_not_expressible(setting_or_write, file_rule, file_format, device)
            if reason_not_expressible:
                name = _setting_name(setting_or_write)
                omissions.append(f"{name} = {setting_or_write.text}: {reason_not_expressible}.")
            else:
                file_values += _file_values(setting_or_write, file_rule, device)
    return Content(
        channels=_channels_of_device(sheet, device, file_values),
        omissions=tuple(omissions),
        conditions=tuple(map(condition_text, sheet.writing)),
    )


def _settings_in_write_order(sheet: SettingsSheet) -> Iterator[tuple[Setting, list[ObjectWrite], list[ObjectWrite]]]:
    """Yield the settings in the order of writing, each with the values to write before and after it.

    A rule for writing applies to the settings named in its ``of``, or without names to all. The values in its ``needs``
    are written before the first of these settings, and the values in its ``then`` after the last.
    """
    names_in_order = write_order([setting.name for setting in sheet.settings], sheet.writing)
    settings = sorted(sheet.settings, key=lambda setting: names_in_order.index(setting.name))
    setting_names = [setting.name for setting in settings]
    for setting in settings:
        writes_before: list[ObjectWrite] = []
        writes_after: list[ObjectWrite] = []
        for rule in sheet.writing:
            applies_to = rule.of or setting_names
            # In the order of writing. At least one setting of the sheet is among them.
            names_of_rule = [name for name in setting_names if name in applies_to]
            if setting.name == names_of_rule[0]:
                writes_before += rule.needs
            if setting.name == names_of_rule[-1]:
                writes_after += rule.then
        yield setting, writes_before, writes_after


def _reason_to_leave_out(setting: Setting, sheet: SettingsSheet, file_format: FileFormat) -> str:
    """Return the reason that files leave out a setting, or an empty string if they contain it.

    Files leave out a setting without a value or with only a bound that it must be below, and a factory default that
    can be written only after other values.
    """
    if setting.value is None:
        return setting.text
    if setting.bound == "below":
        return f"it must be below {setting.text}, and you choose the value"
    # A tool with names of its own needs all of them.
    is_optional = file_format.kind_of_place != "name"
    needs_other_values = any(condition.needs for condition in sheet.writing_of(setting))
    if is_optional and setting.is_default and needs_other_values:
        return f"{setting.text} is the factory default. Write it only if the setting was changed"
    return ""


def _setting_name(setting_or_write: Setting | ObjectWrite) -> str:
    """Return the name of a setting, or the title of another value to write."""
    return setting_or_write.name if isinstance(setting_or_write, Setting) else setting_or_write.title


def _reason_not_expressible(
    setting_or_write: Setting | ObjectWrite, file_rule: YamlMapping, file_format: FileFormat, device: str
) -> str:
    """Return the reason that a format cannot express a value for some location on a device, or an empty string."""
    value = _setting_value(setting_or_write)
    for place in setting_or_write.places:
        if place.device == device:
            if file_format.kind_of_place == "name":
                reason = "" if _key_in_file(setting_or_write, file_rule) else "the file has no name for it"
            else:
                reason = _reason_not_expressible_at(place, value, file_format)
            if reason:
                return reason
    return ""


def _file_values(setting_or_write: Setting | ObjectWrite, file_rule: YamlMapping, device: str) -> list[FileValue]:
    """Return a value of a file for each location that a setting has on a device."""
    marks = _setting_marks(setting_or_write) if isinstance(setting_or_write, Setting) else []
    file_values = []
    for place in setting_or_write.places:
        if place.device == device:
            file_value = FileValue(
                name=_setting_name(setting_or_write),
                key=_key_in_file(setting_or_write, file_rule),
                value=_setting_value(setting_or_write),
                value_text=_value_word(setting_or_write, file_rule),
                mark=", ".join(marks),
                place=place,
            )
            file_values.append(file_value)
    return file_values


def _value_word(setting_or_write: Setting | ObjectWrite, file_rule: YamlMapping) -> str:
    """Return a value in the notation of the file: the word for it in the master's description, or a number or text."""
    value = _setting_value(setting_or_write)
    words_by_value = file_rule.get("words", {}).get(_setting_name(setting_or_write), {})
    number_or_text = int(value) if isinstance(value, bool) else value
    return str(words_by_value.get(str(value), number_or_text))


def _setting_marks(setting: Setting) -> list[str]:
    """Return the marks of a setting: ``derived`` if no document states it, and its bound, such as ``at most``."""
    marks = ["derived"] if setting.standing == "inferred" else []
    if setting.bound:
        marks.append(setting.bound.replace("_", " "))
    return marks


def _key_in_file(setting_or_write: Setting | ObjectWrite, file_rule: YamlMapping) -> str:
    """Return the name of a setting in the file, or an empty string if the master's description gives none."""
    key: str = file_rule.get("names", {}).get(_setting_name(setting_or_write), "")
    return key


def _setting_value(setting_or_write: Setting | ObjectWrite) -> Value:
    """Return the value of a setting that is known to have one."""
    assert setting_or_write.value is not None
    return setting_or_write.value


def _reason_not_expressible_at(place: SettingPlace, value: Value, file_format: FileFormat) -> str:
    """Return the reason that a format cannot express a value for this location, or an empty string if it can.

    The format can write one kind of place: an object with an index, a symbol, or bits of a register.
    """
    has_register = bool(place.register) or place.address is not None
    is_integer = place.kind in ("boolean", "unsigned", "signed") and place.bits is not None
    has_place = {
        "object": place.index is not None and is_integer,
        "symbol": bool(place.symbol),
        "bits": place.high_bit is not None and has_register,
    }
    if not has_place[file_format.kind_of_place]:
        return f"not given: {PLACE_KINDS[file_format.kind_of_place]}"
    is_named_value = not isinstance(value, int) and place.kind not in ("text", "float")
    if is_named_value:
        return "no document gives its number"
    highest_number = file_format.highest_number
    if isinstance(value, int) and highest_number is not None and value > highest_number:
        return f"the reader of this file takes at most {highest_number}"
    return ""


#: Name of the channel of values that all channels share.
_ALL_CHANNELS = ""


def _channels_of_device(sheet: SettingsSheet, device: str, file_values: Sequence[FileValue]) -> tuple[Channel, ...]:
    """Return the channels of a device with their values, or nothing without values.

    If all channels share all values, the result is one channel. It has a name only if the device has a single channel.
    """
    if not file_values:
        return ()
    devices = (master_device for master_device in sheet.master.devices if master_device.name == device)
    first_name, *further_names = first_or_raise(devices, f"device '{device}' of the master").channels
    are_all_shared = not any(file_value.place.channel for file_value in file_values)
    if are_all_shared:
        name_of_single_channel = "" if further_names else first_name
        return (Channel(name_of_single_channel, tuple(file_values)),)
    # The first channel also contains the values for all channels.
    channels = [Channel(first_name, _values_of_channels(file_values, (first_name, _ALL_CHANNELS)))]
    channels += [Channel(name, _values_of_channels(file_values, (name,))) for name in further_names]
    return tuple(channels)


def _values_of_channels(file_values: Sequence[FileValue], names: Collection[str]) -> tuple[FileValue, ...]:
    """Return the values whose channel is among ``names``."""
    return tuple(file_value for file_value in file_values if file_value.place.channel in names)
