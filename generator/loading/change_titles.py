"""Titles for the changes of overlays and editions, from the places that they change."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ..language.problems import join_words
from ..model import Biss, Rs485, Spi, Ssi

#: Highest number of changed places in a title.
_MAX_PLACES = 3
#: A path in a spec, which a colon and the former value may follow.
_PATH_IN_TITLE = re.compile(r"([\w-]+(?:\[\d+\])?(?:\.[\w-]+(?:\[\d+\])?)*)(?:: .*)?", re.DOTALL)
_LIST_POSITION = re.compile(r"\[\d+\]")
#: Steps of a path that only lead to named items, and are left out of titles.
_STEPS_LEFT_OUT = {"parts", "values", "fields", "contacts", "timings"}
#: Keys that end a path, as phrases before the name of their owner.
_KEY_PHRASES = {
    "implemented": "implementation of {}",
    "interfaces": "{} interfaces",
    "meaning": "meaning of {}",
    "note": "note on {}",
    "when_active": "active state of {}",
}
#: Words in names that prose spells differently.
_SPELLINGS_IN_PROSE = {"crc": "CRC", "eeprom": "EEPROM", "id": "ID", "led": "LED"}
_SPELLINGS_IN_PROSE |= {interface.name: interface.short for interface in (Ssi, Biss, Rs485, Spi)}
#: Sections whose items are known by their own names.
_SECTIONS_OF_NAMED_ITEMS = {
    "alarms",
    "alternatives",
    "characteristics",
    "connectors",
    "crcs",
    "examples",
    "field_groups",
    "interfaces",
    "leds",
    "parameters",
    "procedures",
    "registers",
}


def change_title(layer_words: str, changed_places: Sequence[str]) -> str:
    """Return a title with the overlay or edition and the parts that it changes: ``Before edition 1.7: serial number``.

    ``changed_places`` are sentences, or paths in the spec, optionally with a colon and the former value. If there are
    more than three parts, the title names two and "others".
    """
    part_names = list(dict.fromkeys(map(_place_name, changed_places)))
    if len(part_names) > _MAX_PLACES:
        part_names = [*part_names[: _MAX_PLACES - 1], "others"]
    return f"{layer_words}: {join_words(part_names)}"


def _place_name(place: str) -> str:
    """Return the name of the part at a path in words, such as ``preset max`` for ``registers.preset.max: 15``.

    Steps of the path that only lead to named items are left out. The section is also left out if its items are known by
    their own names. A final key comes first: ``note on configuration``. A sentence is returned as it is.
    """
    path = _PATH_IN_TITLE.fullmatch(place)
    if path is None:
        return place
    steps = [_LIST_POSITION.sub("", step) for step in path[1].split(".") if step not in _STEPS_LEFT_OUT]
    section, *names = steps  # For registers.preset.max, the section is registers.
    if section == "order_code" and names:
        is_spelling = names[0] == "also_written"
        part_name = "other spellings" if is_spelling else _steps_in_words(names[0])
        return f"order code ({part_name})"
    if not names or section not in _SECTIONS_OF_NAMED_ITEMS:
        names = steps
    if section == "field_groups" and len(names) > 1:
        names = names[1:]  # A field of a group is known without the name of the group.
    if len(names) > 1 and names[-1] in _KEY_PHRASES:
        *owner_names, key = names
        return _KEY_PHRASES[key].format(_steps_in_words(*owner_names))
    if section == "connectors" and len(names) > 1:
        connector, contact = names[:2]
        return f"contact {contact} of the {_steps_in_words(connector)}"
    if section == "examples":
        return f"example {_steps_in_words(*names)}"
    return _steps_in_words(*names)


def _steps_in_words(*steps: str) -> str:
    """Return the steps of a path as words, with abbreviations in their usual spelling."""
    words = " ".join(steps).replace("_", " ").split()
    return " ".join(_SPELLINGS_IN_PROSE.get(word, word) for word in words)
