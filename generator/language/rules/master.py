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
from ..master_items import FILE_FORMATS, NUMBERS, WORDS
from ..problems import DocumentReport, Path, join_words, quoted, suggest_word
from ..written import WrittenPart
from ..written_masters import (
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

#: Names of all items of a record, which describes an encoder for a master.
_ITEM_NAMES = (*WORDS, *NUMBERS)
_KINDS_OF_SETTINGS = ("value", "choice", "clocks", "any_clock", "text", "string", "unknown")
_KEYS_OF_WRITING = ("needs", "after", "then", "takes_effect")
_KEYS_OF_PLACES = ("index", "symbol", "register", "address", "where")
#: Keys of a place whose values can be lists, with one entry for each channel.
_PER_CHANNEL = ("index", "subindex", "symbol", "register", "address")
_FOR_NUMBERS = ("one_of", "none_of", "at_least", "at_most")
#: A bit number, or the highest and the lowest bit of a range, such as 7:6.
_BIT_RANGE = re.compile(r"[0-9]{1,3}(:[0-9]{1,3})?")
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
    _check_name(master, report)
    for path, node in _yield_maps(master_data, ()):
        # What a map is follows from its keys. Each view of it has empty values for keys that the map lacks.
        cited_part = _CitedPart(node, path)
        condition = WrittenCondition(node, path)
        if cited_part.source:
            _check_source(cited_part.source, cited_part.place_of("source"), master, report)
        is_condition_or_limit = bool(condition.item)
        if is_condition_or_limit:
            _check_limit(condition, report)
        for place in cited_part.places:
            _check_place(place, master, report)
    for note in master.notes:
        _check_braces(note.text, _ITEM_NAMES, note.place_of("text"), report)
    for index, setting in enumerate(master.settings):
        _check_setting(setting, _written_setting(index, report), report)
    _check_writing(master, report)
    _check_files(master, report)


def _check_files(master: WrittenMaster, report: DocumentReport) -> None:
    """Check that each file format is listed once, and that each file has what its format needs."""
    listed_formats: set[str] = set()
    for file in master.files:
        if file.format in listed_formats:
            report.add("duplicate-name", file.place_of("format"), f"{quoted(file.format)} is listed twice")
        listed_formats.add(file.format)
        _check_file(file, master, report)


def _written_setting(index: int, report: DocumentReport) -> WrittenSetting:
    """Return a setting with all its keys, including keys whose values the schema check removed.

    ``index`` is the index in the checked data, from which invalid settings may be missing.
    """
    original_indices = report.document.kept_indices.get(("settings",))
    if original_indices is not None:
        index = original_indices[index]
    return WrittenSetting(report.document.data["settings"][index])


def _check_name(master: WrittenMaster, report: DocumentReport) -> None:
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
    """Check that the documents of a source, such as ``manual:6.4; errata``, are listed. The places are not checked."""
    documents = master.documents
    for piece in source_text.split(";"):
        key_text, _, _ = piece.partition(":")
        key = key_text.strip()
        if key not in documents:
            report.add(
                "undefined-reference", path, f"{quoted(key)} is not in 'documents'{suggest_word(key, documents)}"
            )


def _is_item(item_name: str, path: Path, report: DocumentReport, valid_items: tuple[str, ...] = _ITEM_NAMES) -> bool:
    """Return True if ``item_name`` is one of the valid items of a record, otherwise report it.

    A record describes an encoder for a master. Its items are words and numbers.
    """
    if item_name in valid_items:
        return True
    if item_name in _ITEM_NAMES:
        message = f"{quoted(item_name)} of the record is a word, not a number"
    else:
        noun = "number" if valid_items is not _ITEM_NAMES else "item"
        message = f"the record has no {noun} {quoted(item_name)}{suggest_word(item_name, valid_items)}"
    report.add("undefined-reference", path, message)
    return False


def _check_limit(condition: WrittenCondition, report: DocumentReport) -> None:
    """Check that a condition or limit lists words for a text, and bounds or numbers for a number."""
    name = condition.item
    path = condition.path
    if not _is_item(name, condition.place_of("item"), report):
        return
    is_word = name in WORDS
    kind, allowed_keys = ("word", ("is",)) if is_word else ("number", _FOR_NUMBERS)
    used_keys = [key for key in ("is", *_FOR_NUMBERS) if condition.has(key)]
    allowed_text = join_words(map(quoted, allowed_keys), "or")
    for key in used_keys:
        if key not in allowed_keys:
            report.add("not-allowed", (*path, key), f"'{name}' is a {kind}; use {allowed_text}", at_key=True)
    if not used_keys:
        report.add("missing-key", path, f"no condition for '{name}'; add {allowed_text}")
    if is_word:
        for index, word in enumerate(condition.is_ or ()):
            _check_word(word, name, (*path, "is", index), report)
    lowest, highest = _Bound("at_least", condition.at_least), _Bound("at_most", condition.at_most)
    _check_bounds(lowest, highest, path, report)


class _Bound(NamedTuple):
    """The lowest or the highest number under a key, or None if it is missing."""

    key: str
    number: int | None


def _check_bounds(lowest: _Bound, highest: _Bound, path: Path, report: DocumentReport) -> None:
    """Check that the highest number is not less than the lowest one. Without a lowest one, it is not less than 0."""
    low = lowest.number if lowest.number is not None else 0
    if highest.number is not None and highest.number < low:
        message = f"'{highest.key}' is less than '{lowest.key}', which is {low}"
        report.add("value-clash", (*path, highest.key), message)


def _check_word(word: int | str, setting_word: str, path: Path, report: DocumentReport) -> bool:
    """Return True if the item can be this word, otherwise report it."""
    words = WORDS[setting_word]
    if word not in words:
        message = f"'{setting_word}' cannot be {quoted(word)}{suggest_word(str(word), words, 'use one of')}"
        report.add("undefined-reference", path, message)
    return word in words


def _check_setting(setting: WrittenSetting, as_written: WrittenSetting, report: DocumentReport) -> None:
    """Check that a setting has one kind of value, and that the value is possible.

    The kinds are counted in the setting as written, so that an invalid value is not reported as missing.
    """
    _check_braces(setting.name, _ITEM_NAMES, setting.place_of("name"), report)
    _check_braces(setting.at, _ITEM_NAMES, setting.place_of("at"), report)
    kinds = [kind for kind in _KINDS_OF_SETTINGS if as_written.has(kind)]
    if len(kinds) > 1:
        message = f"{quoted(setting.name)} has {join_words(map(quoted, kinds))}; keep one of them"
        report.add("setting-shape", setting.path, message)
    elif not kinds:
        message = f"{quoted(setting.name)} has no value; add one of {', '.join(map(quoted, _KINDS_OF_SETTINGS))}"
        report.add("setting-shape", setting.path, message)
    else:
        _check_setting_value(setting, kinds[0], report)


def _check_setting_value(setting: WrittenSetting, value_type: str, report: DocumentReport) -> None:
    """Check the value of a setting, and that the keys ``as`` and ``bound`` are only next to a ``value``."""
    for key, text in (("as", setting.as_), ("bound", setting.bound)):
        if text and value_type != "value":
            report.add("setting-shape", setting.place_of(key), f"'{key}' needs 'value'", at_key=True)
    if setting.as_ == "boolean" and setting.bound:
        report.add("setting-shape", setting.place_of("bound"), "a boolean cannot be a bound", at_key=True)
    if setting.value is not None:
        _check_expression(setting.value, setting.place_of("value"), report)
    if setting.choice is not None:
        _check_choice(setting.choice, report)
    _check_braces(setting.text, _ITEM_NAMES, setting.place_of("text"), report)
    if setting.string is not None:
        _check_string(setting.string, report)
    if setting.any_clock is not None:
        _check_clocks(setting.any_clock, report)


def _check_clocks(clocks: WrittenAnyClock, report: DocumentReport) -> None:
    """Check that the highest clock is not below the lowest one."""
    lowest, highest = _Bound("at_least_hz", clocks.at_least_hz), _Bound("at_most_hz", clocks.at_most_hz)
    _check_bounds(lowest, highest, clocks.path, report)


def _check_place(place: WrittenPlace, master: WrittenMaster, report: DocumentReport) -> None:
    """Check that a place is given, or only ``where``, which says that none is known, and that its devices are known."""
    path = place.path
    place_keys = [key for key in _KEYS_OF_PLACES if place.has(key)]
    if not place_keys:
        report.add("setting-shape", path, f"a place is missing; add {join_words(map(quoted, _KEYS_OF_PLACES), 'or')}")
    if place.has("where") and len(place_keys) > 1:
        message = f"'where' says that no place is given, but {quoted(place_keys[0])} gives one; keep one of the two"
        report.add("setting-shape", (*path, "where"), message, at_key=True)
    _check_object_and_bits(place, report)
    _check_channels(place, master, report)
    symbols = place.symbol if isinstance(place.symbol, list) else [place.symbol]
    for symbol in symbols:
        _check_braces(str(symbol), _ITEM_NAMES, (*path, "symbol"), report)


def _check_object_and_bits(place: WrittenPlace, report: DocumentReport) -> None:
    """Check that an index has a subindex, that the type ``bits`` states its bits in ``at``, and the order of limits."""
    has_index, has_subindex = place.index is not None, place.subindex is not None
    if has_index != has_subindex:
        report.add("setting-shape", place.path, "use 'index' and 'subindex' together or not at all")
    is_bits = place.type == "bits"
    has_bit_range = place.at is not None
    if is_bits != has_bit_range:
        report.add("setting-shape", place.path, "use the type 'bits' and the key 'at' together or not at all")
    if has_bit_range and not _BIT_RANGE.fullmatch(str(place.at)):
        report.add("setting-shape", place.place_of("at"), "'at' is a bit number, or a range such as 7:6")
    _check_bounds(_Bound("min", place.min), _Bound("max", place.max), place.path, report)


def _check_channels(place: WrittenPlace, master: WrittenMaster, report: DocumentReport) -> None:
    """Check that a place is on known devices, and that a list has an entry for each channel of each device."""
    channel_counts: dict[str, int] = {}
    for device in master.devices:
        channel_counts[device.name] = 1 if device.channels is None else len(device.channels)
    if not channel_counts:  # Without devices, the master itself is one.
        channel_counts = {master.title: 1}
    _check_devices(place.on or (), place.place_of("on"), list(channel_counts), report)
    used_devices = [name for name in channel_counts if place.on is None or name in place.on]
    for key in _PER_CHANNEL:
        values_by_channel = place.data.get(key)
        if not isinstance(values_by_channel, list):
            continue
        for name in used_devices:
            count = channel_counts[name]
            if len(values_by_channel) != count:
                message = (
                    f"'{key}' needs one entry for each channel of {name}, which has {count_with_unit(count, 'channel')}"
                )
                report.add("setting-shape", place.place_of(key), message, at_key=True)


def _check_devices(names: Sequence[str], path: Path, devices: Sequence[str], report: DocumentReport) -> None:
    """Check that devices of these names exist."""
    for index, name in enumerate(names):
        if name not in devices:
            message = f"there is no device {quoted(name)}{suggest_word(name, devices)}"
            report.add("undefined-reference", (*path, index), message)


def _check_file(file: WrittenMasterFile, master: WrittenMaster, report: DocumentReport) -> None:
    """Check that a file names existing devices and settings, and states names if and only if its format needs them."""
    devices = [device.name for device in master.devices] or [master.title]  # Without devices, the master is one.
    _check_devices(file.on, file.place_of("on"), devices, report)
    for key, names in (("names", file.names), ("words", file.words)):
        for name in names:
            _check_setting_name(name, (*file.path, key, name), master, report, at_key=True)
    needs_names = FILE_FORMATS[file.format].needs == "name"
    has_names = file.has("names")
    if needs_names and not has_names:
        report.add("setting-shape", file.path, f"the format {quoted(file.format)} needs 'names'")
    elif has_names and not needs_names:
        message = f"the format {quoted(file.format)} has no names of its own; remove 'names'"
        report.add("setting-shape", file.path, message)
    _check_braces(file.line, tuple(file.names.values()), file.place_of("line"), report)


def _check_setting_name(
    setting_name: str, path: Path, master: WrittenMaster, report: DocumentReport, *, at_key: bool = False
) -> None:
    """Check that there is a setting of this name."""
    names = [setting.name for setting in master.settings]
    if setting_name not in names:
        message = f"there is no setting {quoted(setting_name)}{suggest_word(setting_name, names)}"
        report.add("undefined-reference", path, message, at_key=at_key)


def _check_writing(master: WrittenMaster, report: DocumentReport) -> None:
    """Check that write conditions have one kind, name existing settings, and define an order without cycles.

    A condition lists in ``after`` the settings that are written before the settings in ``of``.
    """
    earlier_settings: dict[str, set[str]] = {}  # For each setting, those that are written before it.
    for condition in master.writing:
        _check_write_condition(condition, master, report)
        for name in condition.of:
            earlier_settings.setdefault(name, set()).update(condition.after)
        try:
            # The order is not needed. The call raises an exception if there is a cycle.
            TopologicalSorter(earlier_settings).prepare()
        except CycleError as error:
            # In the exception, each setting of the cycle is a predecessor of the next one.
            circle = " after ".join(quoted(name) for name in reversed(error.args[1]))
            report.add("value-clash", condition.place_of("after"), f"circular order: {circle}")
            earlier_settings.clear()  # Otherwise the next conditions would report this circle again.


def _check_write_condition(condition: WrittenWriting, master: WrittenMaster, report: DocumentReport) -> None:
    """Check that a write condition has one kind and names existing settings, and that ``after`` has its ``of``."""
    kinds = [key for key in _KEYS_OF_WRITING if condition.has(key)]
    if not kinds:
        message = f"a write condition is empty; add {join_words(map(quoted, _KEYS_OF_WRITING), 'or')}"
        report.add("writing-shape", condition.path, message)
    elif len(kinds) > 1:
        message = f"a write condition has {join_words(map(quoted, kinds))}; keep one of them"
        report.add("writing-shape", condition.path, message)
    for key, names in (("of", condition.of), ("after", condition.after)):
        for index, name in enumerate(names):
            _check_setting_name(name, (*condition.path, key, index), master, report)
    if condition.after and not condition.of:
        report.add("writing-shape", condition.path, "'after' also needs 'of', the settings to write later")


def _check_expression(expression_text: int | str, path: Path, report: DocumentReport) -> None:
    """Check that an expression is valid, and that its names are numbers of a record."""
    try:
        expression = Expression.parse(expression_text)
    except ExpressionError as error:
        report.add("bad-expression", path, str(error))
        return
    for name in expression.parameters:
        _is_item(name, path, report, tuple(NUMBERS))


def _check_choice(choice: WrittenChoice, report: DocumentReport) -> None:
    """Check that a choice has at most one case for each value, and only values that its item can have."""
    name = choice.of
    if not _is_item(name, choice.place_of("of"), report):
        return
    earlier_values: set[int | str] = set()
    for case in choice.cases:
        is_valid = _check_case_value(name, case.is_, case.place_of("is"), report)
        if is_valid and case.is_ in earlier_values:
            report.add("duplicate-name", case.place_of("is"), f"{quoted(case.is_)} already has a case")
        earlier_values.add(case.is_)


def _check_case_value(name: str, case_value: int | str, path: Path, report: DocumentReport) -> bool:
    """Return True if an item can have this value, otherwise report it."""
    if name in WORDS:
        return _check_word(case_value, name, path, report)
    if not isinstance(case_value, int):
        report.add("wrong-type", path, f"'{name}' must be a number; {quoted(case_value)} is not one")
        return False
    return True


def _check_string(rule: WrittenString, report: DocumentReport) -> None:
    """Check that a text composed of the fields of a frame has the position and only known names in braces.

    The position is one field, or the two fields multiturn and singleturn.
    """
    _check_braces(rule.start, _ITEM_NAMES, rule.place_of("start"), report)
    field_kinds = {field.of for field in rule.fields}
    has_position = "position" in field_kinds or field_kinds >= {"multiturn", "singleturn"}
    if not has_position:
        message = "there is no entry for the position; add one for position, or for multiturn and singleturn"
        report.add("missing-key", rule.place_of("fields"), message)
    for field in rule.fields:
        _check_braces(field.text, ("bits", "name", *_ITEM_NAMES), field.place_of("text"), report)


def _check_braces(text_with_items: str, known_names: tuple[str, ...], path: Path, report: DocumentReport) -> None:
    """Report each name in braces, as in ``{bits}``, that is not a known one."""
    for name in _ITEM_IN_BRACES.findall(text_with_items):
        if name not in known_names:
            report.add("undefined-reference", path, f"there is no {{{name}}}{suggest_word(name, known_names)}")
