"""Descriptions of masters as they are written, as far as rules read them. See ``written.py``.

``master.schema.json`` describes the keys. A test compares them with these classes.
"""

from __future__ import annotations

from collections.abc import Mapping

from ..model.part import NOTHING, Anything, Formula, Name, NumberOrText, Phrase, Prose, key
from .written import WrittenPart, written


@written("A device of a master with several.")
class WrittenMasterDevice(WrittenPart):
    name: Phrase = key("Name.")
    channels: tuple[Phrase, ...] | None = key("Names of the device's channels, if it has several.", default=None)


@written("A condition on an item of the record, or a limit of it.")
class WrittenCondition(WrittenPart):
    item: Name = key("Item.")
    is_: tuple[NumberOrText, ...] | None = key("Possible words.", default=None)
    at_least: int | None = key("Lowest number.", default=None)
    at_most: int | None = key("Highest number.", default=None)


@written("A place of a setting. Each channel can have its own number or text.")
class WrittenPlace(WrittenPart):
    on: tuple[Phrase, ...] | None = key("Devices.", default=None)
    index: Anything | None = key("Index of the object.", default=None)
    subindex: Anything | None = key("Subindex of the object.", default=None)
    symbol: Anything | None = key("Symbol.", default=None)
    at: NumberOrText | None = key("Bits in the object.", default=None)
    type: Phrase = key("Type of data.")
    min: int | None = key("Lowest number.", default=None)
    max: int | None = key("Highest number.", default=None)


@written("A case of a choice.")
class WrittenCase(WrittenPart):
    is_: NumberOrText = key("Value of the item.")


@written("A number for each value of an item.")
class WrittenChoice(WrittenPart):
    of: Name = key("Item.")
    cases: tuple[WrittenCase, ...] = key("Cases.")


@written("A clock in hertz.")
class WrittenAnyClock(WrittenPart):
    at_least_hz: int | None = key("Lowest clock.", default=None)
    at_most_hz: int | None = key("Highest clock.", default=None)


@written("A field of a text.")
class WrittenMasterField(WrittenPart):
    of: Name = key("Kind of field.")
    text: Phrase = key("Text.")


@written("A text composed of the fields of a frame.")
class WrittenString(WrittenPart):
    start: Phrase = key("Start of the text.", default="")
    fields: tuple[WrittenMasterField, ...] = key("Fields.")


@written("A setting.")
class WrittenSetting(WrittenPart):
    name: Phrase = key("Name.")
    at: Phrase = key("Place in words.", default="")
    value: Formula | None = key("Number.", default=None)
    as_: Phrase = key("Type of the value.", default="")
    bound: Phrase = key("Kind of limit.", default="")
    choice: WrittenChoice | None = key("", default=None)
    any_clock: WrittenAnyClock | None = key("", default=None)
    text: Prose = key("Text.", default="")
    string: WrittenString | None = key("", default=None)


@written("A condition of writing settings.")
class WrittenWriting(WrittenPart):
    of: tuple[Phrase, ...] = key("Settings that are written later.", default=())
    after: tuple[Phrase, ...] = key("Settings that are written first.", default=())


@written("A file that the tool of the master loads.")
class WrittenMasterFile(WrittenPart):
    format: Name = key("Format.")
    on: tuple[Phrase, ...] = key("Devices.", default=())
    names: Mapping[Phrase, Phrase] = key("Names of settings in the file.", default=NOTHING)
    words: Mapping[Phrase, Anything] = key("Words for the values of settings.", default=NOTHING)
    line: Phrase = key("Form of a line.", default="")


@written("A note.")
class WrittenMasterNote(WrittenPart):
    text: Prose = key("Text.")


@written("A master.")
class WrittenMaster(WrittenPart):
    master: Name = key("Name, the same as that of the file.")
    title: Phrase = key("Title.")
    documents: Mapping[Name, Anything] = key("Documents by their key.")
    devices: tuple[WrittenMasterDevice, ...] = key("Devices, if there are several.", default=())
    settings: tuple[WrittenSetting, ...] = key("Settings.", default=())
    writing: tuple[WrittenWriting, ...] = key("Conditions of writing settings.", default=())
    notes: tuple[WrittenMasterNote, ...] = key("Notes.", default=())
    files: tuple[WrittenMasterFile, ...] = key("Files that the master's tool loads.", default=())
