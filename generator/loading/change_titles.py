"""Titles of the changes of overlays and editions, from the places that they change."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ..language.problems import join_words
from ..model import Biss, Rs485, Spi, Ssi

#: Largest number of changed places in a title.
_MOST_PLACES = 3
#: A path in a spec, which a colon and the former value may follow.
_PATH_IN_TITLE = re.compile(r"([\w-]+(?:\[\d+\])?(?:\.[\w-]+(?:\[\d+\])?)*)(?:: .*)?", re.DOTALL)
_LIST_POSITION = re.compile(r"\[\d+\]")
#: Steps of a path that only lead to named items.
_PASSED_STEPS = {"parts", "values", "fields", "contacts", "timings"}
#: Keys that end a path, as phrases before the name of their owner.
_KEY_PHRASES = {
    "implemented": "implementation of",
    "interfaces": "interfaces of",
    "meaning": "meaning of",
    "note": "note on",
    "when_active": "active state of",
}
#: Words of names that prose writes in another way.
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
    """Return the overlay or edition of a change, and the changed parts: ``Before edition 1.7: serial number``.

    ``changed_places`` are paths, which a colon and the former value may follow, or sentences. Of more than three parts,
    the title has two and "others".
    """
    part_names = list(dict.fromkeys(map(_place_name, changed_places)))
    if len(part_names) > _MOST_PLACES:
        part_names = [*part_names[: _MOST_PLACES - 1], "others"]
    return f"{layer_words}: {join_words(part_names)}"


def _place_name(place: str) -> str:
    """Return the name of the part at a path, in words: ``preset max`` for ``registers.preset.max: 15``.

    Steps that only lead to named items are left out, and so is the section if its items are known by their names. A key
    comes first: ``note on configuration``. A sentence is returned as it is.
    """
    path = _PATH_IN_TITLE.fullmatch(place)
    if path is None:
        return place
    steps = [_LIST_POSITION.sub("", step) for step in path[1].split(".") if step not in _PASSED_STEPS]
    section, *names = steps  # For registers.preset.max, the section is registers.
    if section == "order_code" and names:
        part_name = "other spellings" if names[0] == "also_written" else _in_words(names[0])
        return f"order code ({part_name})"
    named_steps = names if names and section in _SECTIONS_OF_NAMED_ITEMS else steps
    if section == "field_groups" and len(named_steps) > 1:
        named_steps = named_steps[1:]
    if len(named_steps) > 1 and named_steps[-1] in _KEY_PHRASES:
        return f"{_KEY_PHRASES[named_steps[-1]]} {_in_words(*named_steps[:-1])}"
    if section == "connectors" and len(named_steps) > 1:
        return f"contact {named_steps[1]} of {_in_words(named_steps[0])}"
    return f"example {_in_words(*named_steps)}" if section == "examples" else _in_words(*named_steps)


def _in_words(*steps: str) -> str:
    """Return the steps of a path as words, with abbreviations in their usual spelling."""
    words = " ".join(steps).replace("_", " ").split()
    return " ".join(_SPELLINGS_IN_PROSE.get(word, word) for word in words)
