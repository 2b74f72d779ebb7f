"""Paths to the parts of a spec that an edition or an overlay changes, in words."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ..model import INTERFACES
from .text import listed

#: Top-level parts of a spec that are not lists of named items.
_TOP = {
    "connectors": "the connectors",
    "inputs": "the hardware inputs",
    "supply": "the supply",
    "printed_defaults": "the printed table of defaults",
    "measurement": "the unit of the position",
    "movement": "the movement",
    "characteristics": "the characteristics",
    "leds": "the LEDs",
    "tables": "the tables",
    "alarms": "the alarms",
}
#: Keys inside a part, with the words that precede the part.
_KEYS = {
    "note": "the note on {}",
    "meaning": "the meaning of {}",
    "default": "the default of {}",
    "min": "the minimum of {}",
    "max": "the maximum of {}",
    "implemented": "whether {} is implemented",
    "interfaces": "the interfaces of {}",
    "when_active": "the meaning of an active {}",
    "when_inactive": "the meaning of an inactive {}",
    "wait_at_least_ms": "the wait in ms after a write to {}",
    "at_least_ms": "the minimum time in ms for {}",
    "open": "unlisted values of {}",
    "open_only_with": "the values that may accompany unlisted values of {}",
}
#: Lists of named items, with the word for one item.
_LISTS = {
    "registers": "register",
    "fields": "field",
    "layouts": "frame",
    "timings": "time",
    "procedures": "procedure",
    "parts": "part",
    "values": "value",
    "alarms": "alarm",
    "crcs": "CRC",
    "parameters": "parameter",
    "connectors": "connector",
    "field_groups": "group",
    "data_ids": "data ID",
    "steps": "step",
    "contacts": "contact",
    "characteristics": "characteristic",
    "leds": "LED",
    "tables": "table",
    "examples": "example",
    "alternatives": "alternative",
    "documents": "document",
}
_PATH = re.compile(r"[A-Za-z0-9_]+([.][A-Za-z0-9_+/ -]+)*")
#: Index of an item in a list without names, counted from 0.
_INDEX = re.compile(r"\[([0-9]+)\]")
_MORE = re.compile(r" and ([0-9]+ more)$")


def in_words(paths: str) -> str:
    """Return paths such as ``registers.bank.default, supply and 2 more`` in words."""
    count_text = _MORE.search(paths)
    texts = [_path_in_words(path.split(".")) for path in _MORE.sub("", paths).split(", ")]
    return "".join(map(str, listed([*texts, *([count_text[1]] if count_text is not None else [])])))


def change_in_words(printed: str) -> str:
    """Return a part and its value, such as ``bank.default: 50``, in words. Text without a path is unchanged."""
    paths, colon, value = printed.partition(": ")
    paths = _INDEX.sub(lambda index_match: f".{int(index_match[1]) + 1}", paths)
    if not all(map(_PATH.fullmatch, _MORE.sub("", paths).split(", "))):
        return printed
    return f"{in_words(paths)}{colon}{value}"


def _first_words(steps: Sequence[str]) -> tuple[str, int]:
    """Return the words for the first steps of a path that are described together, and their number."""
    match steps:
        case ["order_code", "parts", part, "values", value, *_]:
            return f"order codes with {part} {value}", 5
        case ["order_code", "parts", part, _, *_]:
            return f"order code part {part}", 3
        case ["order_code", "also_written", number, "values", part, *_]:
            return f"the values of {part} in spelling {number} on labels", 5
    if steps[0] not in (*_LISTS, *_TOP, "interfaces", "order_code"):
        return f"register {steps[0]}", 1
    return "", 0


def _path_in_words(steps: Sequence[str]) -> str:
    """Return one path in words, from the outermost step inwards. A step for which there are no words is kept."""
    if len(steps) == 1 and steps[0] in _TOP:
        return _TOP[steps[0]]
    words, index = _first_words(steps)
    while index < len(steps):
        step, following = steps[index], steps[index + 1] if index + 1 < len(steps) else ""
        if step == "interfaces" and following:
            words, index = (INTERFACES[following].title if following in INTERFACES else following), index + 2
        elif step == "order_code":
            words, index = "the order code", index + 1
        elif step in _LISTS and following:
            words, index = f"{_LISTS[step]} {following}" + (f" of {words}" if words else ""), index + 2
        elif step in _KEYS and not following:
            words, index = _KEYS[step].format(words), index + 1
        else:
            words, index = f"{step.replace('_', ' ')}" + (f" of {words}" if words else ""), index + 1
    return words
