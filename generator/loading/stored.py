"""Models as plain data for the cache, and back.

An object is a list that begins with the position of its class in ``_CLASSES``. Objects that occur more than once are
kept once. Only objects of the model can be built, so no data can run other code. Each member must have the type of its
annotation, so no command meets a value that ``loading`` cannot produce.
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
    by_hand,
    device,
    examples,
    expressions,
    facts,
    kinds,
    layout,
    limits,
    measurement,
    only,
    scale,
    steps,
)
from ..model.interfaces import biss, common, rs485, spi, ssi
from ..typed import members_fit

_MODULES: tuple[ModuleType, ...] = (
    *(by_hand, device, examples, expressions, facts, kinds, layout, limits, measurement, only, scale, steps),
    *(biss, common, rs485, spi, ssi),
)
_CLASSES: tuple[type, ...] = tuple(
    item
    for module in _MODULES
    for item in vars(module).values()
    if isinstance(item, type) and item.__module__ == module.__name__ and dataclasses.is_dataclass(item)
)
_ENUMS: tuple[type[Enum], ...] = tuple(
    item
    for module in _MODULES
    for item in vars(module).values()
    if isinstance(item, type) and item.__module__ == module.__name__ and issubclass(item, Enum)
)
_NAMES = tuple(tuple(item.name for item in dataclasses.fields(kind)) for kind in _CLASSES)
_BY_KEYWORD = tuple(any(item.kw_only for item in dataclasses.fields(kind)) for kind in _CLASSES)
_INDEX = {kind: index for index, kind in enumerate(_CLASSES)}
_MAP, _OBJECT, _ENUM, _BYTES = "m", "o", "e", "b"


class NotStorable(Exception):
    """The data does not have the form of a model."""


def kept(cache: Cache, content: Sequence[bytes | str]) -> tuple[model.Device, str] | None:
    """Return the device that ``keep`` stored for files with this content, and its digest, or None."""
    with suppress(NotStorable):
        found = cache.get("family", content)
        if isinstance(found, list) and len(found) == 2 and isinstance(found[0], str):
            return from_data(found[1]), found[0]
    return None


def keep(cache: Cache, content: Sequence[bytes | str], device: model.Device) -> str:
    """Store a device whose spec has no problems, and return its digest.

    ``content`` is that of all files on which it depends.
    """
    with suppress(NotStorable):
        rows = as_data(device)
        cache.put("family", content, [_digest(rows), rows])
        return _digest(rows)
    return ""


def digest_of(device: model.Device) -> str:
    """Return a hash of everything in a model, for the keys of results that depend only on the model.

    Models from the same spec with other comments have the same digest. It is empty if the model cannot be stored.
    """
    with suppress(NotStorable):
        return _digest(as_data(device))
    return ""


def _digest(rows: list[Any]) -> str:
    return hashlib.sha256(json.dumps(rows, separators=(",", ":")).encode()).hexdigest()


def as_data(item: model.Device) -> list[Any]:
    """Return a device as data that JSON can express.

    Raises:
        NotStorable: A member has a type that models did not have so far.
    """
    rows: list[Any] = []
    known: dict[int, int] = {}

    def put(value: Any) -> Any:
        kind = type(value)
        if value is None or kind in (bool, int, float, str):
            return value
        if kind is bytes:
            return {_BYTES: value.hex()}
        if kind is tuple:
            return [put(part) for part in value]
        if kind in _INDEX:
            if id(value) not in known:
                index = _INDEX[kind]
                rows.append([index, *(put(getattr(value, name)) for name in _NAMES[index])])
                known[id(value)] = len(rows) - 1
            return {_OBJECT: known[id(value)]}
        if isinstance(value, Enum) and kind in _ENUMS:
            return {_ENUM: [_ENUMS.index(kind), value.name]}
        if isinstance(value, Mapping):
            return {_MAP: [[put(key), put(part)] for key, part in value.items()], "f": kind is MappingProxyType}
        raise NotStorable(kind.__name__)

    put(item)
    return rows


def from_data(rows: Any) -> model.Device:
    """Return the device that ``as_data`` converted.

    Raises:
        NotStorable: The data does not describe a device.
    """
    built: list[Any] = []

    def get(value: Any) -> Any:
        if isinstance(value, list):
            return tuple([get(part) for part in value])
        if not isinstance(value, dict):
            return value
        if _OBJECT in value:
            return built[value[_OBJECT]]
        if _ENUM in value:
            index, name = value[_ENUM]
            return _ENUMS[index][name]
        if _BYTES in value:
            return bytes.fromhex(value[_BYTES])
        found = {get(key): get(part) for key, part in value[_MAP]}
        return MappingProxyType(found) if value["f"] else found

    try:
        for row in rows:
            index, *parts = row
            kind, values = _CLASSES[index], [get(part) for part in parts]
            members = dict(zip(_NAMES[index], values, strict=True))
            if not members_fit(kind, values):
                raise NotStorable(f"members of {kind.__name__}")
            built.append(kind(**members) if _BY_KEYWORD[index] else kind(*values))
        found = built[-1]
    except (LookupError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise NotStorable(str(error)) from None
    if not isinstance(found, model.Device):
        raise NotStorable(type(found).__name__)
    return found
