"""Rules for descriptions of masters: every name exists and has the right kind of value."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import PurePath
from typing import Any

from ...model.expressions import Expression, ExpressionError
from ...say.text import counted
from ..master_items import FILE_FORMATS, NUMBERS, WORDS
from ..problems import DocumentReport, Path, listed, quoted, suggestion

Raw = Mapping[str, Any]

_ITEMS = (*WORDS, *NUMBERS)
_KINDS = ("value", "choice", "clocks", "any_clock", "text", "string", "unknown")
_WRITING = ("needs", "after", "then", "takes_effect")
_PLACES = ("index", "symbol", "register", "address", "where")
_FOR_NUMBERS = ("one_of", "none_of", "at_least", "at_most")
_BITS = re.compile(r"[0-9]{1,3}(:[0-9]{1,3})?")
_BRACES = re.compile(r"\{([^{}]*)\}")


def check_master(data: Raw, report: DocumentReport) -> None:
    """Add every problem of a description that follows the schema."""
    _check_name(data, report)
    for path, node in _nodes(data, ()):
        if isinstance(node.get("source"), str):
            _check_source(node["source"], (*path, "source"), data, report)
        if isinstance(node.get("item"), str):
            _check_limit(node, path, report)
        for index, place in enumerate(node.get("places", ())):
            _check_place(place, (*path, "places", index), data, report)
    for index, note in enumerate(data.get("notes", ())):
        _check_braces(note["text"], _ITEMS, ("notes", index, "text"), report)
    for index, setting in enumerate(data.get("settings", ())):
        _check_setting(setting, _written_setting(index, report), ("settings", index), report)
    _check_writing(data, report)
    _check_files(data, report)


def _check_files(data: Raw, report: DocumentReport) -> None:
    """Check that each format is listed once, with what it needs."""
    listed_formats: set[str] = set()
    for index, file in enumerate(data.get("files", ())):
        if file["format"] in listed_formats:
            report.add("duplicate-name", ("files", index, "format"), f"{quoted(file['format'])} is listed twice")
        listed_formats.add(file["format"])
        _check_file(file, ("files", index), data, report)


def _written_setting(index: int, report: DocumentReport) -> Raw:
    """Return a setting as written. The checked data no longer has values rejected by the schema."""
    original_indices = report.document.kept_indices.get(("settings",))
    if original_indices is not None:
        index = original_indices[index]
    written_setting: Raw = report.document.data["settings"][index]
    return written_setting


def _check_name(data: Raw, report: DocumentReport) -> None:
    """Check that a master and its file have the same name."""
    stem = PurePath(report.document.file).stem
    if "master" in data and data["master"] != stem:
        message = (
            f"the master is called '{data['master']}', but the file is called '{stem}'; use the same name for both"
        )
        report.add("device-name", ("master",), message)


def _nodes(node: Any, path: Path) -> Iterator[tuple[Path, Raw]]:
    """Yield every map at a place and below it, with its path."""
    if isinstance(node, Mapping):
        yield path, node
        for key, value in node.items():
            yield from _nodes(value, (*path, key))
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from _nodes(value, (*path, index))


def _check_source(text: str, path: Path, data: Raw, report: DocumentReport) -> None:
    """Check a source: documents separated by semicolons, each with an optional place after a colon."""
    documents = data.get("documents", {})
    for piece in text.split(";"):
        key = piece.partition(":")[0].strip()
        if key not in documents:
            report.add("undefined-reference", path, f"{quoted(key)} is not in 'documents'{suggestion(key, documents)}")


def _is_item(name: str, path: Path, report: DocumentReport, valid_items: tuple[str, ...] = _ITEMS) -> bool:
    """Return True if a record has an item of this name, otherwise report it."""
    if name in valid_items:
        return True
    hint = "; it is a word, not a number" if name in _ITEMS else suggestion(name, valid_items)
    noun = "number" if valid_items is not _ITEMS else "item"
    report.add("undefined-reference", path, f"the record has no {noun} {quoted(name)}{hint}")
    return False


def _check_limit(node: Raw, path: Path, report: DocumentReport) -> None:
    """Check that a condition or limit gives words for a word, and bounds for a number."""
    name = node["item"]
    if not _is_item(name, (*path, "item"), report):
        return
    is_word = name in WORDS
    kind, allowed_keys = ("word", ("is",)) if is_word else ("number", _FOR_NUMBERS)
    used_keys = [key for key in ("is", *_FOR_NUMBERS) if key in node]
    allowed_text = listed(map(quoted, allowed_keys), "or")
    for key in used_keys:
        if key not in allowed_keys:
            report.add("not-allowed", (*path, key), f"'{name}' is a {kind}; use {allowed_text}", at_key=True)
    if not used_keys:
        report.add("missing-key", path, f"no condition for '{name}'; add {allowed_text}")
    if is_word:
        for index, word in enumerate(node.get("is", ())):
            _check_word(word, name, (*path, "is", index), report)
    _check_bounds(node, "at_least", "at_most", path, report)


def _check_bounds(node: Raw, low_key: str, high_key: str, path: Path, report: DocumentReport) -> None:
    """Check that the highest number under two keys is not less than the lowest one. Either may be missing."""
    low, high = node.get(low_key, 0), node.get(high_key)
    if high is not None and high < low:
        report.add("value-clash", (*path, high_key), f"'{high_key}' is less than '{low_key}', which is {low}")


def _check_word(word: int | str, name: str, path: Path, report: DocumentReport) -> bool:
    """Return True if the item can be this word, otherwise report it."""
    words = WORDS[name]
    if word not in words:
        message = f"'{name}' cannot be {quoted(word)}{suggestion(str(word), words, 'use one of')}"
        report.add("undefined-reference", path, message)
    return word in words


def _check_setting(setting: Raw, written: Raw, path: Path, report: DocumentReport) -> None:
    """Check that a setting has one kind of value, and that the value is possible."""
    for key in ("name", "at"):
        _check_braces(setting.get(key, ""), _ITEMS, (*path, key), report)
    kinds = [kind for kind in _KINDS if kind in written]
    if len(kinds) > 1:
        message = f"{quoted(setting['name'])} has {listed(map(quoted, kinds))}; keep one of them"
        report.add("setting-shape", path, message)
    elif not kinds:
        message = f"{quoted(setting['name'])} has no value; add one of {', '.join(map(quoted, _KINDS))}"
        report.add("setting-shape", path, message)
    else:
        _check_setting_value(setting, written, path, report)


def _check_setting_value(setting: Raw, written: Raw, path: Path, report: DocumentReport) -> None:
    """Check the value of a setting, and the keys that belong to it."""
    for key in ("as", "bound"):
        if key in setting and "value" not in written:
            report.add("setting-shape", (*path, key), f"'{key}' needs 'value'", at_key=True)
    if setting.get("as") == "boolean" and "bound" in setting:
        report.add("setting-shape", (*path, "bound"), "a boolean cannot be a bound", at_key=True)
    if "value" in setting:
        _check_expression(setting["value"], (*path, "value"), report)
    if "choice" in setting:
        _check_choice(setting["choice"], (*path, "choice"), report)
    if "text" in setting:
        _check_braces(setting["text"], _ITEMS, (*path, "text"), report)
    if "string" in setting:
        _check_string(setting["string"], (*path, "string"), report)
    if "any_clock" in setting:
        _check_bounds(setting["any_clock"], "at_least_hz", "at_most_hz", (*path, "any_clock"), report)


def _check_place(place: Raw, path: Path, data: Raw, report: DocumentReport) -> None:
    """Check that a place is given once, on known devices, and with one entry for each of their channels."""
    place_keys = [key for key in _PLACES if key in place]
    if not place_keys:
        report.add("setting-shape", path, f"a place is missing; add {listed(map(quoted, _PLACES), 'or')}")
    if "where" in place_keys and len(place_keys) > 1:
        message = f"'where' says that no place is given, but {quoted(place_keys[0])} gives one; keep one of the two"
        report.add("setting-shape", (*path, "where"), message, at_key=True)
    _check_object_and_bits(place, path, report)
    _check_channels(place, path, data, report)
    symbol = place.get("symbol", [])
    symbol_of_each_channel = symbol if isinstance(symbol, list) else [symbol]
    for text in symbol_of_each_channel:
        _check_braces(text, _ITEMS, (*path, "symbol"), report)


def _check_object_and_bits(place: Raw, path: Path, report: DocumentReport) -> None:
    """Check that the index, the bits and the limits of a place are complete and possible."""
    has_index, has_subindex = "index" in place, "subindex" in place
    if has_index != has_subindex:
        report.add("setting-shape", path, "use 'index' and 'subindex' together or not at all")
    is_bits, has_bit_range = place.get("type") == "bits", "at" in place
    if is_bits != has_bit_range:
        report.add("setting-shape", path, "use the type 'bits' and the key 'at' together or not at all")
    if has_bit_range and not _BITS.fullmatch(str(place["at"])):
        report.add("setting-shape", (*path, "at"), "'at' is a bit number, or a range such as 7:6")
    _check_bounds(place, "min", "max", path, report)


def _check_channels(place: Raw, path: Path, data: Raw, report: DocumentReport) -> None:
    """Check that a place is on known devices, with one entry for each of their channels."""
    channel_counts: dict[str, int] = {}
    for device in data.get("devices", ()):
        channel_counts[device["name"]] = len(device["channels"]) if "channels" in device else 1
    if not channel_counts:  # Without devices, the master itself is one.
        channel_counts = {data.get("title", ""): 1}
    for index, name in enumerate(place.get("on", ())):
        if name not in channel_counts:
            message = f"there is no device {quoted(name)}{suggestion(name, channel_counts)}"
            report.add("undefined-reference", (*path, "on", index), message)
    used_devices = [name for name in channel_counts if name in place.get("on", channel_counts)]
    for key in ("index", "subindex", "symbol", "register", "address"):
        values = place.get(key)
        if not isinstance(values, list):
            continue
        for name in used_devices:
            count = channel_counts[name]
            if len(values) != count:
                message = f"'{key}' needs one entry for each channel of {name}, which has {counted(count, 'channel')}"
                report.add("setting-shape", (*path, key), message, at_key=True)


def _check_file(file: Raw, path: Path, data: Raw, report: DocumentReport) -> None:
    """Check that a file names existing devices and settings, and has the names that its format needs."""
    devices = [device["name"] for device in data.get("devices", ())]
    if not devices:  # Without devices, the master itself is one.
        devices = [data.get("title", "")]
    for index, name in enumerate(file.get("on", ())):
        if name not in devices:
            message = f"there is no device {quoted(name)}{suggestion(name, devices)}"
            report.add("undefined-reference", (*path, "on", index), message)
    for key in ("names", "words"):
        for name in file.get(key, ()):
            _check_setting_name(name, (*path, key, name), data, report, at_key=True)
    needs_names = FILE_FORMATS[file["format"]].needs == "name"
    if needs_names and "names" not in file:
        report.add("setting-shape", path, f"the format {quoted(file['format'])} needs 'names'")
    elif "names" in file and not needs_names:
        message = f"the format {quoted(file['format'])} has no names of its own; remove 'names'"
        report.add("setting-shape", path, message)
    names_in_file = tuple(file.get("names", {}).values())
    _check_braces(file.get("line", ""), names_in_file, (*path, "line"), report)


def _check_setting_name(name: str, path: Path, data: Raw, report: DocumentReport, *, at_key: bool = False) -> None:
    """Check that there is a setting of this name."""
    names = [setting["name"] for setting in data.get("settings", ())]
    if name not in names:
        message = f"there is no setting {quoted(name)}{suggestion(name, names)}"
        report.add("undefined-reference", path, message, at_key=at_key)


def _check_writing(data: Raw, report: DocumentReport) -> None:
    """Check that write conditions have one kind, name existing settings, and define an order without cycles."""
    earlier_settings: dict[str, set[str]] = {}
    for index, condition in enumerate(data.get("writing", ())):
        path: Path = ("writing", index)
        _check_write_condition(condition, path, data, report)
        for name in condition.get("of", ()):
            earlier_settings.setdefault(name, set()).update(condition.get("after", ()))
        try:
            TopologicalSorter(earlier_settings).prepare()
        except CycleError as error:
            circle = " after ".join(quoted(name) for name in reversed(error.args[1]))
            report.add("value-clash", (*path, "after"), f"circular order: {circle}")
            earlier_settings.clear()  # Each circle is reported once.


def _check_write_condition(condition: Raw, path: Path, data: Raw, report: DocumentReport) -> None:
    """Check that a write condition has one kind and names existing settings."""
    kinds = [key for key in _WRITING if key in condition]
    if not kinds:
        message = f"a write condition is empty; add {listed(map(quoted, _WRITING), 'or')}"
        report.add("writing-shape", path, message)
    elif len(kinds) > 1:
        message = f"a write condition has {listed(map(quoted, kinds))}; keep one of them"
        report.add("writing-shape", path, message)
    for key in ("of", "after"):
        for index, name in enumerate(condition.get(key, ())):
            _check_setting_name(name, (*path, key, index), data, report)
    if "after" in condition and "of" not in condition:
        report.add("writing-shape", path, "'after' also needs 'of', the settings to write later")


def _check_expression(value: int | str, path: Path, report: DocumentReport) -> None:
    try:
        expression = Expression.parse(value)
    except ExpressionError as error:
        report.add("bad-expression", path, str(error))
        return
    for name in expression.parameters:
        _is_item(name, path, report, tuple(NUMBERS))


def _check_choice(choice: Raw, path: Path, report: DocumentReport) -> None:
    """Check that a choice has one case for each value, and only values that its item can have."""
    name = choice["of"]
    if not _is_item(name, (*path, "of"), report):
        return
    earlier_values: set[int | str] = set()
    for index, case in enumerate(choice["cases"]):
        value_path = (*path, "cases", index, "is")
        value = case["is"]
        is_valid = _check_case_value(name, value, value_path, report)
        if is_valid and value in earlier_values:
            report.add("duplicate-name", value_path, f"{quoted(value)} already has a case")
        earlier_values.add(value)


def _check_case_value(name: str, value: int | str, path: Path, report: DocumentReport) -> bool:
    """Return True if an item can have this value, otherwise report it."""
    if name in WORDS:
        return _check_word(value, name, path, report)
    if not isinstance(value, int):
        report.add("wrong-type", path, f"'{name}' must be a number; {quoted(value)} is not one")
        return False
    return True


def _check_string(rule: Raw, path: Path, report: DocumentReport) -> None:
    """Check that a text composed of the fields of a frame has the position and only known names in braces."""
    _check_braces(rule.get("start", ""), _ITEMS, (*path, "start"), report)
    kinds = {field["of"] for field in rule["fields"]}
    has_position = "position" in kinds or ("multiturn" in kinds and "singleturn" in kinds)
    if not has_position:
        message = "there is no entry for the position; add one for position, or for multiturn and singleturn"
        report.add("missing-key", (*path, "fields"), message)
    for index, field in enumerate(rule["fields"]):
        _check_braces(field["text"], ("bits", "name", *_ITEMS), (*path, "fields", index, "text"), report)


def _check_braces(text: str, known_names: tuple[str, ...], path: Path, report: DocumentReport) -> None:
    for name in _BRACES.findall(text):
        if name not in known_names:
            report.add("undefined-reference", path, f"there is no {{{name}}}{suggestion(name, known_names)}")
