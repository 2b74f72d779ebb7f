"""Convert models to plain data for the cache, and back.

An object is a list that begins with the position of its class in ``_CLASSES``. Objects that occur more than once are
stored once. Only objects of the model can be built, so no data can run other code.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from enum import Enum
from types import MappingProxyType, ModuleType
from typing import Any

from .. import model
from ..cache import Cache
from ..model import (
    device,
    expressions,
    facts,
    fields,
    interface_parts,
    interfaces,
    kinds,
    layout,
    manual,
    measurement,
    order_codes,
    registers,
)

#: Modules with the classes of the model.
_MODULES: tuple[ModuleType, ...] = (
    interface_parts,
    device,
    manual,
    expressions,
    facts,
    fields,
    interfaces,
    kinds,
    layout,
    measurement,
    order_codes,
    registers,
)


def _types_in(module: ModuleType) -> list[type]:
    """Return the classes that a module defines itself."""
    values = vars(module).values()
    return [value for value in values if isinstance(value, type) and value.__module__ == module.__name__]


def _member_names(part_class: type) -> tuple[str, ...]:
    return tuple(member.name for member in dataclasses.fields(part_class))


def _has_keywords(part_class: type) -> bool:
    """Return whether a class of the model must be called with keywords."""
    return any(member.kw_only for member in dataclasses.fields(part_class))


_TYPES = tuple(kind for module in _MODULES for kind in _types_in(module))
_CLASSES: tuple[type, ...] = tuple(kind for kind in _TYPES if dataclasses.is_dataclass(kind))
_STORED_ENUMS: tuple[type[Enum], ...] = tuple(kind for kind in _TYPES if issubclass(kind, Enum))
#: By position in ``_CLASSES``: the names of the members, and True if the class must be called with keywords.
_MEMBER_NAMES = tuple(map(_member_names, _CLASSES))
_BY_KEYWORD = tuple(map(_has_keywords, _CLASSES))
_CLASS_INDEX = {kind: index for index, kind in enumerate(_CLASSES)}
#: Keys that mark values which JSON cannot express.
_MAP_MARK, _READ_ONLY_MARK, _OBJECT_MARK, _ENUM_MARK, _BYTES_MARK = "m", "f", "o", "e", "b"
#: Kind of entry in the cache for the model of a family.
_MODEL_ENTRY = "family"


class NotStorable(Exception):
    """The data does not have the form of a model."""


def stored_device(cache: Cache, content: Sequence[bytes | str]) -> model.Device | None:
    """Return the device that was cached for files with this content, or None if there is none or it is not valid."""
    with suppress(NotStorable):
        rows = cache.get(_MODEL_ENTRY, content)
        return None if rows is None else from_data(rows)
    return None


def store_device(cache: Cache, content: Sequence[bytes | str], device: model.Device) -> None:
    """Store a device whose spec has no problems in the cache. ``content`` is the content of all files it depends on.

    If a device cannot be stored, this is not an error. The device is then built again each time.
    """
    if not cache:
        return
    with suppress(NotStorable):
        cache.put(_MODEL_ENTRY, content, as_data(device))


def digest_of(device: model.Device) -> str:
    """Return a hash of a whole model, from which the keys of results that only depend on the model are computed.

    Comments in the spec do not change it. The hash is "" if the model cannot be stored.
    """
    try:
        data = as_data(device)
    except NotStorable:
        return ""
    content = json.dumps(data, separators=(",", ":"))
    return hashlib.sha256(content.encode()).hexdigest()


def as_data(device: model.Device) -> list[Any]:
    """Return a device as data for JSON: a list with a row for each object, which ends with the device.

    A row begins with the index of the object's class, and continues with the values of its members. A member that is an
    object of the model is ``{"o": 3}``, with the index of its row. An enum is ``{"e": [index, name]}``, bytes are
    ``{"b": hex}``, and a map is ``{"m": [[key, value], …], "f": whether it is read-only}``.

    Raises:
        NotStorable: A member has a type that is not supported here.
    """
    rows: list[Any] = []
    row_by_id: dict[int, int] = {}

    def to_data(value: Any) -> Any:
        """Return a value as data, and add a row for each new object in it."""
        value_type = type(value)
        if value is None or value_type in (bool, int, float, str):
            return value
        if value_type is bytes:
            return {_BYTES_MARK: value.hex()}
        if value_type is tuple:
            return [to_data(part) for part in value]
        if value_type in _CLASS_INDEX:
            if id(value) not in row_by_id:
                class_index = _CLASS_INDEX[value_type]
                rows.append([class_index, *(to_data(getattr(value, name)) for name in _MEMBER_NAMES[class_index])])
                row_by_id[id(value)] = len(rows) - 1
            return {_OBJECT_MARK: row_by_id[id(value)]}
        if isinstance(value, Enum) and value_type in _STORED_ENUMS:
            return {_ENUM_MARK: [_STORED_ENUMS.index(value_type), value.name]}
        if isinstance(value, Mapping):
            return {
                _MAP_MARK: [[to_data(key), to_data(member)] for key, member in value.items()],
                _READ_ONLY_MARK: value_type is MappingProxyType,
            }
        raise NotStorable(value_type.__name__)

    # This adds all rows, and returns a reference to the last one, which is not needed.
    to_data(device)
    return rows


def from_data(rows: Any) -> model.Device:
    """Return a device from its data in the cache, a list with a row for each object. ``rows`` may be any data.

    Raises:
        NotStorable: The data does not describe a device.
    """
    built_objects: list[Any] = []
    try:
        for class_index, *raw_values in rows:
            part_class = _CLASSES[class_index]
            values = [_rebuild_value(raw_value, built_objects) for raw_value in raw_values]
            if _BY_KEYWORD[class_index]:
                built_objects.append(part_class(**dict(zip(_MEMBER_NAMES[class_index], values, strict=True))))
            else:
                built_objects.append(part_class(*values))
        # Objects come after the objects that they contain, so the device is the last one.
        device = built_objects[-1]
    except (LookupError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise NotStorable(str(error)) from None
    if not isinstance(device, model.Device):
        raise NotStorable(type(device).__name__)
    return device


def _rebuild_value(stored_value: Any, built_objects: Sequence[Any]) -> Any:
    """Return the value of a member of the model from its data in the cache.

    The value may refer, by their index, to objects of earlier rows, which are in ``built_objects``.
    """
    if isinstance(stored_value, list):
        return tuple([_rebuild_value(stored_member, built_objects) for stored_member in stored_value])
    if not isinstance(stored_value, dict):
        return stored_value
    if _OBJECT_MARK in stored_value:
        return built_objects[stored_value[_OBJECT_MARK]]
    if _ENUM_MARK in stored_value:
        enum_index, enum_member = stored_value[_ENUM_MARK]
        return _STORED_ENUMS[enum_index][enum_member]
    if _BYTES_MARK in stored_value:
        return bytes.fromhex(stored_value[_BYTES_MARK])
    rebuilt_map: dict[Any, Any] = {}
    for key, stored_member in stored_value[_MAP_MARK]:
        rebuilt_map[_rebuild_value(key, built_objects)] = _rebuild_value(stored_member, built_objects)
    is_read_only = stored_value[_READ_ONLY_MARK]
    return MappingProxyType(rebuilt_map) if is_read_only else rebuilt_map
