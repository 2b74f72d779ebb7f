"""Names that a transcriber can confuse: the names of all items to which a key can refer."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from codewheel.language.rules.walk import mapping, maps_in_list

from .places import Place

#: Keys that refer to an item of a top-level list, with that list.
_OF_LISTS = {
    "register": "registers",
    "of": "registers",
    "limits_of": "",
    "write_clears": "registers",
    "bank_select": "registers",
    "crc": "crcs",
    "use": "field_groups",
    "group": "field_groups",
    "procedure": "procedures",
    "cleared_by": "procedures",
    "erratum": "errata",
    "alternative": "alternatives",
}
#: Keys that hold the name of the item itself. All references must use that name.
_DEFINES = frozenset(("name", "device", "manufacturer"))


def other_names(place: Place, data: dict[str, Any]) -> Iterator[str]:
    """Yield names that could be in this place by mistake. No names are yielded if the place holds no reference."""
    key = next((step for step in reversed(place.path) if isinstance(step, str)), "")
    value = str(place.value)
    if "." in value and place.kind == "" and "pattern" in place.schema:
        yield from _dotted(value, data)
        return
    if place.kind != "name" or key in _DEFINES:
        return
    known_names = [named["name"] for _, named in maps_in_list(data, _OF_LISTS.get(key, "")) if "name" in named]
    known_names += _names_nearby(place, data)
    if not known_names:
        known_names = list(_texts_under(key, data))
    yield from (name for name in dict.fromkeys(known_names) if name != value and isinstance(name, str))


def _dotted(text: str, data: dict[str, Any]) -> Iterator[str]:
    """Yield other fields of the register in a reference such as ``register.field``."""
    name, _, field = text.partition(".")
    register = next((register for _, register in maps_in_list(data, "registers") if register.get("name") == name), {})
    field_names = [raw_field.get("name") for _, raw_field in maps_in_list(register, "fields")]
    yield from (f"{name}.{field_name}" for field_name in field_names if field_name not in (field, None))


def _names_nearby(place: Place, data: dict[str, Any]) -> list[str]:
    """Return names near the place: fields and joins of its layout, and values of the register that a step uses."""
    chain = [data]
    for step in place.path[:-1]:
        chain.append(chain[-1][step])
    owner = next((node for node in reversed(chain) if isinstance(node, dict)), {})
    register = next(
        (register for _, register in maps_in_list(data, "registers") if register.get("name") == owner.get("register")),
        {},
    )
    if register:
        fields = [field for _, field in maps_in_list(register, "fields")]
        if place.path[-1] == "field":
            return [field["name"] for field in fields if "name" in field]
        return [name for field in fields for name in mapping(field, "values")]
    holder = next((node for node in reversed(chain) if isinstance(node, dict) and "fields" in node), None)
    if holder is None or place.path[-1] in _OF_LISTS:
        return []
    return [field["name"] for _, field in maps_in_list(holder, "fields") if "name" in field] + list(
        mapping(holder, "join")
    )


def _texts_under(key: str, node: Any) -> Iterator[str]:
    """Yield all texts under a key, at any depth."""
    if isinstance(node, dict):
        for name, value in node.items():
            if name == key:
                yield from _texts(value)
            yield from _texts_under(key, value)
    elif isinstance(node, list):
        for value in node:
            yield from _texts_under(key, value)


def _texts(value: Any) -> Iterable[str]:
    if isinstance(value, str):
        return (value,)
    return [text for text in value if isinstance(text, str)] if isinstance(value, list) else ()
