"""Rules for descriptions of masters: every name exists and has the right kind of value."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from graphlib import CycleError, TopologicalSorter
from pathlib import PurePath
from typing import NamedTuple

from ...model.expressions import Expression, ExpressionError
from ...model.part import Prose
from ...model.part import key as described_key
from ...say.text import count_with_unit
from ..keys_of_masters import (
    FILE_FORMATS,
    NUMBERS,
    WORDS,
    WrittenAnyClock,
    WrittenChoice,
    WrittenCondition,
    WrittenMaster,
    WrittenMasterFile,
    WrittenPlace,
    WrittenSetting,
    WrittenString,
    WrittenWriting,
)
from ..problems import DocumentReport, Path, join_words, quoted, suggest_word
from ..written import WrittenPart

#: Names of all items of a record, which describes an encoder for a master.
_ITEM_NAMES = (*WORDS, *NUMBERS)
#: Keys for the value of a setting, which has exactly one of them.
_VALUE_KEYS_OF_SETTINGS = ("value", "choice", "clocks", "any_clock", "text", "string", "unknown")
_KINDS_OF_WRITE_CONDITION = ("needs", "after", "then", "takes_effect")
_KEYS_OF_PLACES = ("index", "symbol", "register", "address", "where")
#: Keys of a place whose values can be lists, with one entry for each channel.
_KEYS_WITH_VALUE_PER_CHANNEL = ("index", "subindex", "symbol", "register", "address")
_CONDITION_KEYS_FOR_NUMBERS = ("one_of", "none_of", "at_least", "at_most")
#: A bit number, or the highest and the lowest bit of a range, such as 7:6.
_BIT_RANGE = re.compile(r"[0-9]{1,3}(:[0-9]{1,3})?")
#: An item that is replaced by its value, such as ``{bits}``.
_ITEM_IN_BRACES = re.compile(r"\{([^{}]*)\}")


class _CitedPart(WrittenPart):
    """A part of a master of any kind, with its source and its places, if any."""

    source: Prose = described_key("Source.", default="")
    places: tuple[WrittenPlace, ...] = described_key("Places.", default=())


def check_master(master_data: dict[str, object], report: DocumentReport) -> None:
    """Add every problem of a description of a master that follows the schema.

    Sources, conditions and places can occur at any depth, so every map is searched for them.
    """
    master = WrittenMaster(master_data)
    _check_name_of_master(master, report)
    for path, node in _yield_maps(master_data, ()):
        # The keys of a map decide what it is. Keys that it lacks have empty values.
        cited_part = _CitedPart(node, path)
        condition = WrittenCondition(node, path)
        if cited_part.source:
            _check_source(cited_part.source, cited_part.path_of("source"), master, report)
        is_condition_or_limit = bool(condition.item)
        if is_condition_or_limit:
            _check_condition(condition, report)
        for place in cited_part.places:
            _check_place_of_setting(place, master, report)
    for note in master.notes:
        _check_items_in_braces(note.text, known_names=_ITEM_NAMES, path=note.path_of("text"), report=report)
    for index, setting in enumerate(master.settings):
        _check_setting(setting, _read_setting_with_invalid_keys(index, report), report)
    _check_writing(master, report)
    _check_files(master, report)


def _check_files(master: WrittenMaster, report: DocumentReport) -> None:
    """Check that each file format is listed only once, and that each file has the keys that its format needs."""
    listed_formats: set[str] = set()
    for file in master.files:
        if file.format in listed_formats:
            report.add("duplicate-name", file.path_of("format"), f"{quoted(file.format)} is listed twice")
        listed_formats.add(file.format)
        _check_file(file, master, report)


def _read_setting_with_invalid_keys(valid_index: int, report: DocumentReport) -> WrittenSetting:
    """Return a setting of the file with all its keys, including keys that were removed because they are invalid.

    ``valid_index`` is its index in the list of valid settings.
    """
    file_indices = report.document.kept_indices.get(("settings",))
    index_in_file = valid_index if file_indices is None else file_indices[valid_index]
    all_settings = report.document.data["settings"]
    return WrittenSetting(all_settings[index_in_file])


def _check_name_of_master(master: WrittenMaster, report: DocumentReport) -> None:
    """Check that a master has the name of its file, without the suffix. An empty name is not checked."""
    stem = PurePath(report.document.file).stem
    if master.master not in ("", stem):
        message = f"the master is called '{master.master}', but the file is called '{stem}'; use the same name for both"
        report.add("device-name", ("master",), message)


def _yield_maps(node: object, path: Path) -> Iterator[tuple[Path, dict[str, object]]]:
    """Yield every map in a value, and the value itself if it is a map, each with its path."""
    if isinstance(node, dict):
        yield path, node
        for key, value in node.items():
            yield from _yield_maps(value, (*path, key))
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from _yield_maps(value, (*path, index))


def _check_source(source_text: str, path: Path, master: WrittenMaster, report: DocumentReport) -> None:
    """Check that the documents that a source cites, as in ``manual:6.4; errata``, are listed under ``documents``."""
    documents = master.documents
    for citation in source_text.split(";"):
        key_text, _, _ = citation.partition(":")
        key = key_text.strip()
        if key not in documents:
            message = f"{quoted(key)} is not in 'documents'{suggest_word(key, documents)}"
            report.add("undefined-reference", path, message)


def _check_item_name(name: str, path: Path, report: DocumentReport, *, only_numbers: bool = False) -> bool:
    """Return True if an item with this name exists in records, and report the name otherwise.

    A record describes an encoder for a master. Its items are words, such as the interface, and numbers, such as the
    resolution. With ``only_numbers``, the name of a word is reported too.
    """
    valid_names = tuple(NUMBERS) if only_numbers else _ITEM_NAMES
    if name in valid_names:
        return True
    if name in _ITEM_NAMES:
        message = f"{quoted(name)} of the record is a word; name an item that is a number"
    else:
        noun = "number" if only_numbers else "item"
        message = f"the record has no {noun} {quoted(name)}{suggest_word(name, valid_names)}"
    report.add("undefined-reference", path, message)
    return False


def _check_condition(condition: WrittenCondition, report: DocumentReport) -> None:
    """Check that a condition lists the words that an item can be, or for a number its bounds or possible numbers."""
    item_name = condition.item
    path = condition.path
    if not _check_item_name(item_name, condition.path_of("item"), report):
        return
    is_word = item_name in WORDS
    noun = "word" if is_word else "number"
    allowed_keys = ("is",) if is_word else _CONDITION_KEYS_FOR_NUMBERS
    used_keys = [key for key in ("is", *_CONDITION_KEYS_FOR_NUMBERS) if condition.has(key)]
    allowed_text = join_words(map(quoted, allowed_keys), "or")
    for key in used_keys:
        if key not in allowed_keys:
            message = f"'{item_name}' is a {noun}; use {allowed_text}"
            report.add("not-allowed", (*path, key), message, at_key=True)
    if not used_keys:
        report.add("missing-key", path, f"no condition for '{item_name}'; add {allowed_text}")
    if is_word:
        for index, word in enumerate(condition.is_ or ()):
            _check_word_of_item(word, item_name, (*path, "is", index), report)
    lowest = _Bound("at_least", condition.at_least)
    highest = _Bound("at_most", condition.at_most)
    _check_bounds(lowest, highest, path, report)


class _Bound(NamedTuple):
    """The lowest or the highest number under a key, or None if it is missing."""

    key: str
    number: int | None


def _check_bounds(lowest: _Bound, highest: _Bound, path: Path, report: DocumentReport) -> None:
    """Check that the highest number is at least the lowest one, or at least 0 if there is no lowest number."""
    lowest_number = lowest.number if lowest.number is not None else 0
    if highest.number is not None and highest.number < lowest_number:
        message = f"'{highest.key}' is less than '{lowest.key}', which is {lowest_number}"
        report.add("value-clash", (*path, highest.key), message)


def _check_word_of_item(word: int | str, item_name: str, path: Path, report: DocumentReport) -> bool:
    """Return True if this item of a record can be this word, and report the word otherwise."""
    possible_words = WORDS[item_name]
    if word in possible_words:
        return True
    hint = suggest_word(str(word), possible_words, otherwise="use one of")
    report.add("undefined-reference", path, f"'{item_name}' cannot be {quoted(word)}{hint}")
    return False


def _check_setting(setting: WrittenSetting, setting_with_invalid_keys: WrittenSetting, report: DocumentReport) -> None:
    """Check that a setting of a master has exactly one kind of value, and that the value is possible.

    ``setting_with_invalid_keys`` is the same setting with its invalid keys: an invalid value does not count as missing.
    """
    _check_items_in_braces(setting.name, known_names=_ITEM_NAMES, path=setting.path_of("name"), report=report)
    _check_items_in_braces(setting.at, known_names=_ITEM_NAMES, path=setting.path_of("at"), report=report)
    value_keys = [key for key in _VALUE_KEYS_OF_SETTINGS if setting_with_invalid_keys.has(key)]
    if len(value_keys) > 1:
        message = f"{quoted(setting.name)} has {join_words(map(quoted, value_keys))}; keep one of them"
        report.add("setting-shape", setting.path, message)
    elif not value_keys:
        possible_keys = ", ".join(map(quoted, _VALUE_KEYS_OF_SETTINGS))
        report.add("setting-shape", setting.path, f"{quoted(setting.name)} has no value; add one of {possible_keys}")
    else:
        _check_setting_value(setting, value_keys[0], report)


def _check_setting_value(setting: WrittenSetting, value_key: str, report: DocumentReport) -> None:
    """Check the value of a setting, and that ``as`` and ``bound`` are used only with the key ``value``.

    ``value_key`` is the key of the value, such as ``value`` or ``choice``.
    """
    for key, text in (("as", setting.as_), ("bound", setting.bound)):
        if text and value_key != "value":
            report.add("setting-shape", setting.path_of(key), f"'{key}' needs 'value'", at_key=True)
    if setting.as_ == "boolean" and setting.bound:
        report.add("setting-shape", setting.path_of("bound"), "a boolean cannot be a bound", at_key=True)
    if setting.value is not None:
        _check_expression(setting.value, setting.path_of("value"), report)
    if setting.choice is not None:
        _check_choice(setting.choice, report)
    _check_items_in_braces(setting.text, known_names=_ITEM_NAMES, path=setting.path_of("text"), report=report)
    if setting.string is not None:
        _check_text_of_fields(setting.string, report)
    if setting.any_clock is not None:
        _check_clocks(setting.any_clock, report)


def _check_clocks(clock_limits: WrittenAnyClock, report: DocumentReport) -> None:
    """Check that the highest clock is not below the lowest one."""
    lowest = _Bound("at_least_hz", clock_limits.at_least_hz)
    highest = _Bound("at_most_hz", clock_limits.at_most_hz)
    _check_bounds(lowest, highest, clock_limits.path, report)


def _check_place_of_setting(place: WrittenPlace, master: WrittenMaster, report: DocumentReport) -> None:
    """Check that a place of a setting in a master is given, such as an address, and that its devices exist.

    A place with ``where``, which says that no place is known, must have no other key for a place.
    """
    path = place.path
    place_keys = [key for key in _KEYS_OF_PLACES if place.has(key)]
    if not place_keys:
        possible_keys = join_words(map(quoted, _KEYS_OF_PLACES), "or")
        report.add("setting-shape", path, f"a place is missing; add {possible_keys}")
    if place.has("where") and len(place_keys) > 1:
        message = f"'where' says that no place is given, but {quoted(place_keys[0])} gives one; keep one of the two"
        report.add("setting-shape", (*path, "where"), message, at_key=True)
    _check_object_and_bits(place, report)
    _check_channels(place, master, report)
    symbols = place.symbol if isinstance(place.symbol, list) else [place.symbol]
    for symbol in symbols:
        _check_items_in_braces(str(symbol), known_names=_ITEM_NAMES, path=(*path, "symbol"), report=report)


def _check_object_and_bits(place: WrittenPlace, report: DocumentReport) -> None:
    """Check that ``index`` is used with ``subindex``, and the type ``bits`` with ``at``, and check the limits."""
    has_index = place.index is not None
    has_subindex = place.subindex is not None
    if has_index != has_subindex:
        report.add("setting-shape", place.path, "use 'index' and 'subindex' together or not at all")
    is_bits = place.type == "bits"
    has_bit_range = place.at is not None
    if is_bits != has_bit_range:
        report.add("setting-shape", place.path, "use the type 'bits' and the key 'at' together or not at all")
    if has_bit_range and not _BIT_RANGE.fullmatch(str(place.at)):
        report.add("setting-shape", place.path_of("at"), "'at' is a bit number, or a range such as 7:6")
    lowest = _Bound("min", place.min)
    highest = _Bound("max", place.max)
    _check_bounds(lowest, highest, place.path, report)


def _check_channels(place: WrittenPlace, master: WrittenMaster, report: DocumentReport) -> None:
    """Check that the devices of a place exist, and that a list in it has one element for each of their channels."""
    channel_count_by_device: dict[str, int] = {}  # By the name of the device.
    for device in master.devices:
        channel_count_by_device[device.name] = 1 if device.channels is None else len(device.channels)
    if not channel_count_by_device:  # A master without devices counts as a device.
        channel_count_by_device = {master.title: 1}
    _check_devices(place.on or (), place.path_of("on"), known_devices=list(channel_count_by_device), report=report)
    devices_of_place = [name for name in channel_count_by_device if place.on is None or name in place.on]
    for key in _KEYS_WITH_VALUE_PER_CHANNEL:
        values_by_channel = place.data.get(key)
        if not isinstance(values_by_channel, list):
            continue
        for device_name in devices_of_place:
            channel_count = channel_count_by_device[device_name]
            if len(values_by_channel) != channel_count:
                count_text = count_with_unit(channel_count, "channel")
                message = f"'{key}' needs one entry for each channel of {device_name}, which has {count_text}"
                report.add("setting-shape", place.path_of(key), message, at_key=True)


def _check_devices(names: Sequence[str], path: Path, known_devices: Sequence[str], report: DocumentReport) -> None:
    """Check that devices of these names exist."""
    for index, name in enumerate(names):
        if name not in known_devices:
            message = f"there is no device {quoted(name)}{suggest_word(name, known_devices)}"
            report.add("undefined-reference", (*path, index), message)


def _check_file(file: WrittenMasterFile, master: WrittenMaster, report: DocumentReport) -> None:
    """Check that a file names existing devices and settings, and that it has ``names`` if its format needs them."""
    known_devices = [device.name for device in master.devices] or [master.title]  # A master without devices is one.
    _check_devices(file.on, file.path_of("on"), known_devices=known_devices, report=report)
    for key, value_by_setting in (("names", file.names), ("words", file.words)):
        for setting_name in value_by_setting:
            _check_setting_name(setting_name, (*file.path, key, setting_name), master, report, at_key=True)
    needs_names = FILE_FORMATS[file.format].kind_of_place == "name"
    has_names = file.has("names")
    if needs_names and not has_names:
        report.add("setting-shape", file.path, f"the format {quoted(file.format)} needs 'names'")
    elif has_names and not needs_names:
        message = f"the format {quoted(file.format)} has no names of its own; remove 'names'"
        report.add("setting-shape", file.path, message)
    names_in_file = tuple(file.names.values())
    _check_items_in_braces(file.line, known_names=names_in_file, path=file.path_of("line"), report=report)


def _check_setting_name(
    setting_name: str, path: Path, master: WrittenMaster, report: DocumentReport, *, at_key: bool = False
) -> None:
    """Check that there is a setting of this name."""
    known_names = [setting.name for setting in master.settings]
    if setting_name not in known_names:
        message = f"there is no setting {quoted(setting_name)}{suggest_word(setting_name, known_names)}"
        report.add("undefined-reference", path, message, at_key=at_key)


def _check_writing(master: WrittenMaster, report: DocumentReport) -> None:
    """Check that write conditions have one kind, name existing settings, and define an order without cycles.

    The settings in ``after`` of a condition are written before the settings in ``of``.
    """
    earlier_settings_by_setting: dict[str, set[str]] = {}  # For each setting, the settings that are written before it.
    for condition in master.writing:
        _check_write_condition(condition, master, report)
        for later_setting in condition.of:
            earlier_settings_by_setting.setdefault(later_setting, set()).update(condition.after)
        try:
            # The order is not needed. The call raises an exception if there is a cycle.
            TopologicalSorter(earlier_settings_by_setting).prepare()
        except CycleError as error:
            # In the exception, each setting of the cycle is a predecessor of the next one.
            _, settings_of_cycle = error.args
            cycle_text = " after ".join(quoted(name) for name in reversed(settings_of_cycle))
            report.add("value-clash", condition.path_of("after"), f"circular order: {cycle_text}")
            earlier_settings_by_setting.clear()  # Otherwise the next conditions would report this cycle again.


def _check_write_condition(condition: WrittenWriting, master: WrittenMaster, report: DocumentReport) -> None:
    """Check that a write condition has one kind and names existing settings, and that ``after`` has its ``of``."""
    used_keys = [key for key in _KINDS_OF_WRITE_CONDITION if condition.has(key)]
    if not used_keys:
        possible_keys = join_words(map(quoted, _KINDS_OF_WRITE_CONDITION), "or")
        report.add("writing-shape", condition.path, f"a write condition is empty; add {possible_keys}")
    elif len(used_keys) > 1:
        message = f"a write condition has {join_words(map(quoted, used_keys))}; keep one of them"
        report.add("writing-shape", condition.path, message)
    later_settings = condition.of
    earlier_settings = condition.after
    for key, setting_names in (("of", later_settings), ("after", earlier_settings)):
        for index, setting_name in enumerate(setting_names):
            _check_setting_name(setting_name, (*condition.path, key, index), master, report)
    if earlier_settings and not later_settings:
        report.add("writing-shape", condition.path, "'after' also needs 'of', the settings to write later")


def _check_expression(expression_text: int | str, path: Path, report: DocumentReport) -> None:
    """Check that an expression is valid, and that its names are numbers of a record."""
    try:
        expression = Expression.parse(expression_text)
    except ExpressionError as error:
        report.add("bad-expression", path, str(error))
        return
    for name in expression.parameters:
        _check_item_name(name, path, report, only_numbers=True)


def _check_choice(choice: WrittenChoice, report: DocumentReport) -> None:
    """Check that a choice by an item of the record has only values that the item can have, and each only once."""
    item_name = choice.of
    if not _check_item_name(item_name, choice.path_of("of"), report):
        return
    earlier_values: set[int | str] = set()
    for case in choice.cases:
        case_value = case.is_
        is_possible = _check_case_value(item_name, case_value, case.path_of("is"), report)
        if is_possible and case_value in earlier_values:
            report.add("duplicate-name", case.path_of("is"), f"{quoted(case_value)} already has a case")
        earlier_values.add(case_value)


def _check_case_value(item_name: str, case_value: int | str, path: Path, report: DocumentReport) -> bool:
    """Return True if an item of a record can have this value, and report the value otherwise."""
    if item_name in WORDS:
        return _check_word_of_item(case_value, item_name, path, report)
    if not isinstance(case_value, int):
        report.add("wrong-type", path, f"'{item_name}' must be a number; {quoted(case_value)} is not one")
        return False
    return True


def _check_text_of_fields(string_rule: WrittenString, report: DocumentReport) -> None:
    """Check the rule for a text that describes the fields of a frame to a master.

    It must contain the position, as one field or as the fields multiturn and singleturn, and only known names in
    braces.
    """
    _check_items_in_braces(string_rule.start, known_names=_ITEM_NAMES, path=string_rule.path_of("start"), report=report)
    described_fields = {field.of for field in string_rule.fields}
    has_both_parts = {"multiturn", "singleturn"} <= described_fields
    if "position" not in described_fields and not has_both_parts:
        message = "there is no entry for the position; add one for position, or for multiturn and singleturn"
        report.add("missing-key", string_rule.path_of("fields"), message)
    names_of_fields = ("bits", "name", *_ITEM_NAMES)
    for field in string_rule.fields:
        _check_items_in_braces(field.text, known_names=names_of_fields, path=field.path_of("text"), report=report)


def _check_items_in_braces(
    text_with_items: str, known_names: tuple[str, ...], path: Path, report: DocumentReport
) -> None:
    """Report each name in braces in a text, such as ``{bits}``, that is not among the known names."""
    for name in _ITEM_IN_BRACES.findall(text_with_items):
        if name not in known_names:
            name_in_braces = f"{{{name}}}"
            message = f"there is no {name_in_braces}{suggest_word(name, known_names)}"
            report.add("undefined-reference", path, message)
