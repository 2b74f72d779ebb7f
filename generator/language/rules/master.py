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
    for index, note in enumerate(data.get("notes", ())):
        _check_braces(note["text"], _ITEMS, ("notes", index, "text"), report)
    for path, node in _nodes(data, ()):
        for index, place in enumerate(node.get("places", ())):
            _check_place(place, (*path, "places", index), data, report)
    for index, setting in enumerate(data.get("settings", ())):
        _check_setting(setting, _written_setting(index, report), ("settings", index), report)
    _check_writing(data, report)
    formats: set[str] = set()
    for index, file in enumerate(data.get("files", ())):
        if file["format"] in formats:
            report.add("duplicate-name", ("files", index, "format"), f"{quoted(file['format'])} is listed twice")
        formats.add(file["format"])
        _check_file(file, ("files", index), data, report)


def _written_setting(index: int, report: DocumentReport) -> Raw:
    """Return a setting as written. The checked data no longer has values rejected by the schema."""
    original_indices = report.document.kept_indices.get(("settings",))
    written_setting: Raw = report.document.data["settings"][
        index if original_indices is None else original_indices[index]
    ]
    return written_setting


def _check_name(data: Raw, report: DocumentReport) -> None:
    stem = PurePath(report.document.file).stem
    if "master" in data and data["master"] != stem:
        report.add(
            "device-name",
            ("master",),
            f"the master is called '{data['master']}', but the file is called '{stem}'; use the same name for both",
        )


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
    conditions = [key for key in ("is", *_FOR_NUMBERS) if key in node]
    allowed_conditions = ("is",) if name in WORDS else _FOR_NUMBERS
    allowed_text = listed(map(quoted, allowed_conditions), "or")
    for key in conditions:
        if key not in allowed_conditions:
            noun = "word" if name in WORDS else "number"
            report.add("not-allowed", (*path, key), f"'{name}' is a {noun}; use {allowed_text}", at_key=True)
    if not conditions:
        report.add("missing-key", path, f"no condition for '{name}'; add {allowed_text}")
    for index, word in enumerate(node.get("is", ()) if name in WORDS else ()):
        _check_word(word, name, (*path, "is", index), report)
    if node.get("at_least", 0) > node.get("at_most", node.get("at_least", 0)):
        report.add("value-clash", (*path, "at_most"), f"'at_most' is less than 'at_least', which is {node['at_least']}")


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
    clock = setting.get("any_clock", {})
    if clock.get("at_least_hz", 0) > clock.get("at_most_hz", clock.get("at_least_hz", 0)):
        report.add(
            "value-clash",
            (*path, "any_clock", "at_most_hz"),
            f"'at_most_hz' is less than 'at_least_hz', which is {clock['at_least_hz']}",
        )


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
    symbols = place.get("symbol", [])
    for text in symbols if isinstance(symbols, list) else [symbols]:
        _check_braces(text, _ITEMS, (*path, "symbol"), report)


def _check_object_and_bits(place: Raw, path: Path, report: DocumentReport) -> None:
    """Check that the index, the bits and the limits of a place are complete and possible."""
    if ("index" in place) != ("subindex" in place):
        report.add("setting-shape", path, "use 'index' and 'subindex' together or not at all")
    if (place.get("type") == "bits") != ("at" in place):
        report.add("setting-shape", path, "use the type 'bits' and the key 'at' together or not at all")
    if not _BITS.fullmatch(str(place.get("at", 0))):
        report.add("setting-shape", (*path, "at"), "'at' is a bit number, or a range such as 7:6")
    if place.get("min", 0) > place.get("max", place.get("min", 0)):
        report.add("value-clash", (*path, "max"), f"'max' is less than 'min', which is {place['min']}")


def _check_channels(place: Raw, path: Path, data: Raw, report: DocumentReport) -> None:
    """Check that a place is on known devices, with one entry for each of their channels."""
    channels = {device["name"]: len(device.get("channels", ("",))) for device in data.get("devices", ())}
    channels = channels or {data.get("title", ""): 1}
    for index, name in enumerate(place.get("on", ())):
        if name not in channels:
            message = f"there is no device {quoted(name)}{suggestion(name, channels)}"
            report.add("undefined-reference", (*path, "on", index), message)
    for key in ("index", "subindex", "symbol", "register", "address"):
        entries = place.get(key)
        for name, number in channels.items():
            if isinstance(entries, list) and name in place.get("on", channels) and len(entries) != number:
                message = f"'{key}' needs one entry for each channel of {name}, which has {counted(number, 'channel')}"
                report.add("setting-shape", (*path, key), message, at_key=True)


def _check_file(file: Raw, path: Path, data: Raw, report: DocumentReport) -> None:
    """Check that a file names existing devices and settings, and has the names that its format needs."""
    devices = [device["name"] for device in data.get("devices", ())] or [data.get("title", "")]
    for index, name in enumerate(file.get("on", ())):
        if name not in devices:
            message = f"there is no device {quoted(name)}{suggestion(name, devices)}"
            report.add("undefined-reference", (*path, "on", index), message)
    names = tuple(dict.fromkeys(setting["name"] for setting in data.get("settings", ())))
    for key in ("names", "words"):
        for name in file.get(key, ()):
            if name not in names:
                message = f"there is no setting {quoted(name)}{suggestion(name, names)}"
                report.add("undefined-reference", (*path, key, name), message, at_key=True)
    needs_names = FILE_FORMATS[file["format"]].needs == "name"
    if needs_names != ("names" in file):
        fault = "needs 'names'" if needs_names else "has no names of its own; remove 'names'"
        report.add("setting-shape", path, f"the format {quoted(file['format'])} {fault}")
    _check_braces(file.get("line", ""), tuple(file.get("names", {}).values()), (*path, "line"), report)


def _check_writing(data: Raw, report: DocumentReport) -> None:
    """Check that write conditions have one kind, name existing settings, and define an order without cycles."""
    names = tuple(dict.fromkeys(setting["name"] for setting in data.get("settings", ())))
    order: dict[str, set[str]] = {}
    for index, rule in enumerate(data.get("writing", ())):
        path: Path = ("writing", index)
        kinds = [key for key in _WRITING if key in rule]
        if len(kinds) != 1:
            if kinds:
                fault = f"has {listed(map(quoted, kinds))}; keep one of them"
            else:
                fault = f"is empty; add {listed(map(quoted, _WRITING), 'or')}"
            report.add("writing-shape", path, f"a write condition {fault}")
        for key in ("of", "after"):
            for place, name in enumerate(rule.get(key, ())):
                if name not in names:
                    message = f"there is no setting {quoted(name)}{suggestion(name, names)}"
                    report.add("undefined-reference", (*path, key, place), message)
        if "after" in rule and "of" not in rule:
            report.add("writing-shape", path, "'after' also needs 'of', the settings to write later")
        for name in rule.get("of", ()):
            order.setdefault(name, set()).update(rule.get("after", ()))
        try:
            TopologicalSorter(order).prepare()
        except CycleError as error:
            circle = " after ".join(quoted(name) for name in reversed(error.args[1]))
            report.add("value-clash", (*path, "after"), f"circular order: {circle}")
            order.clear()


def _check_expression(value: int | str, path: Path, report: DocumentReport) -> None:
    try:
        expression = Expression.parse(value)
    except ExpressionError as error:
        report.add("bad-expression", path, str(error))
        return
    for name in expression.parameters:
        _is_item(name, path, report, tuple(NUMBERS))


def _check_choice(choice: Raw, path: Path, report: DocumentReport) -> None:
    name = choice["of"]
    if not _is_item(name, (*path, "of"), report):
        return
    earlier_values: set[int | str] = set()
    for index, case in enumerate(choice["cases"]):
        value_path = (*path, "cases", index, "is")
        value = case["is"]
        if name in WORDS and not _check_word(value, name, value_path, report):
            pass
        elif name in NUMBERS and not isinstance(value, int):
            report.add("wrong-type", value_path, f"'{name}' must be a number; {quoted(value)} is not one")
        elif value in earlier_values:
            report.add("duplicate-name", value_path, f"{quoted(value)} already has a case")
        earlier_values.add(value)


def _check_string(rule: Raw, path: Path, report: DocumentReport) -> None:
    _check_braces(rule.get("start", ""), _ITEMS, (*path, "start"), report)
    kinds = {field["of"] for field in rule["fields"]}
    if "position" not in kinds and not {"multiturn", "singleturn"} <= kinds:
        report.add(
            "missing-key",
            (*path, "fields"),
            "there is no entry for the position; add one for position, or for multiturn and singleturn",
        )
    for index, field in enumerate(rule["fields"]):
        _check_braces(field["text"], ("bits", "name", *_ITEMS), (*path, "fields", index, "text"), report)


def _check_braces(text: str, known_names: tuple[str, ...], path: Path, report: DocumentReport) -> None:
    for name in _BRACES.findall(text):
        if name not in known_names:
            report.add("undefined-reference", path, f"there is no {{{name}}}{suggestion(name, known_names)}")
