"""Values in a file for a master, in the order of writing, and the reasons for leaving out others."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import groupby
from typing import Any

from ...language.master_items import FILE_FORMATS, PLACE_KINDS, FileFormat
from ...masters.places import Place
from ...masters.sheet import Setting, Sheet
from ...masters.text import condition
from ...masters.writing import Write, write_order
from ...model.record import dataclass

Raw = Mapping[str, Any]
Value = int | bool | str


@dataclass(frozen=True, slots=True)
class Entry:
    """A value and its location on one channel. ``name`` is the name of the setting, and ``key`` its name in the file.

    ``word`` is the value in the notation of the file, and ``mark`` says whether the value is derived or a bound.
    """

    name: str
    key: str
    value: Value
    word: str
    mark: str
    place: Place

    @property
    def size(self) -> int:
        """Size of the data in bytes."""
        return -(-(self.place.bits or 0) // 8)

    @property
    def number(self) -> int:
        return int(self.value)

    @property
    def data(self) -> bytes:
        """The data, little-endian."""
        return self.number.to_bytes(self.size, "little", signed=self.place.kind == "signed")

    @property
    def symbol(self) -> tuple[str, str]:
        """Structure and member of a symbol that contains a dot."""
        structure, _, member = self.place.symbol.rpartition(".")
        return structure, member

    @property
    def mask(self) -> int:
        return ((1 << (self.place.bits or 0)) - 1) << (self.place.low_bit or 0)

    @property
    def shifted(self) -> int:
        return self.number << (self.place.low_bit or 0)

    @property
    def register(self) -> str:
        return self.place.register or f"ADDRESS_{self.place.address}"


@dataclass(frozen=True, slots=True)
class Channel:
    """The values for one channel of a device. The first channel also has the values that all channels share."""

    name: str
    entries: tuple[Entry, ...]

    @property
    def registers(self) -> list[tuple[str, list[Entry]]]:
        """The entries of each register, in the order of their first bits."""
        ordered = sorted(self.entries, key=lambda entry: (entry.register, entry.place.low_bit or 0))
        groups = groupby(ordered, key=lambda entry: entry.register)
        return [(name, list(register_entries)) for name, register_entries in groups]

    @property
    def structures(self) -> list[tuple[str, list[Entry]]]:
        """The entries of each structure."""
        ordered = sorted(self.entries, key=lambda entry: entry.symbol[0])
        groups = groupby(ordered, key=lambda entry: entry.symbol[0])
        return [(name, list(structure_entries)) for name, structure_entries in groups]


@dataclass(frozen=True, slots=True)
class Content:
    """The content of a file: the values of each channel, and the sentences about them."""

    channels: tuple[Channel, ...]
    left_out: tuple[str, ...]
    conditions: tuple[str, ...]

    @property
    def entries(self) -> tuple[Entry, ...]:
        """The values of the first channel."""
        return self.channels[0].entries if self.channels else ()


def content(sheet: Sheet, rule: Raw, device: str) -> Content:
    """Return the content of a file in this format for a device."""
    format_ = FILE_FORMATS[rule["format"]]
    entries: list[Entry] = []
    left_out: list[str] = []
    for setting, writes in _in_order(sheet):
        reason = _reason_to_leave_out(setting, sheet, format_)
        if reason:
            left_out.append(f"{setting.name}: {reason}.")
            continue
        written_values: tuple[Setting | Write, ...] = (*writes[0], setting, *writes[1])
        for written in written_values:
            _add_entries(written, rule, format_, device, entries, left_out)
    return Content(_channels(sheet, device, entries), tuple(left_out), tuple(map(condition, sheet.writing)))


def _in_order(sheet: Sheet) -> Iterator[tuple[Setting, tuple[tuple[Write, ...], tuple[Write, ...]]]]:
    """Yield the settings in the order of writing, each with the values to write before and after it."""
    settings = list(sheet.settings)
    order = write_order([setting.name for setting in settings], sheet.writing)
    settings.sort(key=lambda setting: order.index(setting.name))
    names = [setting.name for setting in settings]
    for number, setting in enumerate(settings):
        before: list[Write] = []
        after: list[Write] = []
        for rule in sheet.writing:
            concerned = [index for index, name in enumerate(names) if name in (rule.of or names)]
            before += rule.needs if concerned[0] == number else ()
            after += rule.then if concerned[-1] == number else ()
        yield setting, (tuple(before), tuple(after))


def _reason_to_leave_out(setting: Setting, sheet: Sheet, format_: FileFormat) -> str:
    """Return the reason that no file contains a setting, or an empty string."""
    if setting.value is None:
        return setting.text
    if setting.bound == "below":
        return f"it must be below {setting.text}, and you choose the value"
    is_optional = format_.needs != "name"  # a tool with names of its own needs all of them
    if is_optional and setting.is_default and any(writing_rule.needs for writing_rule in sheet.writing_of(setting)):
        return f"{setting.text} is the factory default. Write it only if the setting was changed"
    return ""


def _add_entries(
    written: Setting | Write, rule: Raw, format_: FileFormat, device: str, entries: list[Entry], left_out: list[str]
) -> None:
    name = written.name if isinstance(written, Setting) else written.title
    places = [place for place in written.places if place.device == device]
    value = written.value
    assert value is not None
    key = rule.get("names", {}).get(name, "")
    misfits = (_misfit(place, value, key, format_) for place in places)
    reasons = {misfit for misfit in misfits if misfit}
    if reasons:
        left_out.append(f"{name} = {written.text}: {reasons.pop()}.")
        return
    file_number = int(value) if isinstance(value, bool) else value
    word = str(rule.get("words", {}).get(name, {}).get(str(value), file_number))
    marks = ["derived"] if isinstance(written, Setting) and written.standing == "inferred" else []
    if isinstance(written, Setting) and written.bound:
        marks.append(written.bound.replace("_", " "))
    entries += [Entry(name, key, value, word, ", ".join(marks), place) for place in places]


def _misfit(place: Place, value: Value, key: str, format_: FileFormat) -> str:
    """Return the reason that a format cannot write a value to this location, or an empty string."""
    if format_.needs == "name":
        return "" if key else "the file has no name for it"
    has_bits = place.high_bit is not None and bool(place.register or place.address is not None)
    is_whole = place.kind in ("boolean", "unsigned", "signed") and place.bits is not None
    available = {"object": place.index is not None and is_whole, "symbol": bool(place.symbol), "bits": has_bits}
    if not available[format_.needs]:
        return f"not given: {PLACE_KINDS[format_.needs]}"
    if not isinstance(value, int) and place.kind not in ("text", "float"):
        return "no document gives its number"
    if isinstance(value, int) and format_.highest is not None and value > format_.highest:
        return f"the reader of this file takes at most {format_.highest}"
    return ""


def _channels(sheet: Sheet, device: str, entries: Sequence[Entry]) -> tuple[Channel, ...]:
    names = next(master_device.channels for master_device in sheet.master.devices if master_device.name == device)
    shared = tuple(entry for entry in entries if not entry.place.channel)
    if not entries:
        return ()
    if len(shared) == len(entries):
        return (Channel(names[0] if len(names) == 1 else "", shared),)
    # The first channel also has the shared values.
    channel_marks = {name: (name,) for name in names} | {names[0]: (names[0], "")}
    return tuple(Channel(name, _on_channel(entries, marks)) for name, marks in channel_marks.items())


def _on_channel(entries: Sequence[Entry], marks: Collection[str]) -> tuple[Entry, ...]:
    return tuple(entry for entry in entries if entry.place.channel in marks)
