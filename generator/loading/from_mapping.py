"""Build those parts of the model that have the same members and names as the spec."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from types import MappingProxyType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from ..model import Source, Sources

Raw = Mapping[str, Any]
T = TypeVar("T")

_SOURCE = re.compile(r"\s*(?:(?P<document>[a-z][a-z0-9_]*):\s*)?(?P<section>.*?)(?:\s*\bp\.(?P<page>[0-9]+))?\s*$")
_EMPTY: Mapping[Any, Any] = MappingProxyType({str: "", int: 0, bool: False, tuple: (), Mapping: MappingProxyType({})})


def parse_sources(text: str) -> Sources:
    """Parse sources such as ``6.4 p.35; it: 6.4 p.36``. A page range such as ``p.14-15`` belongs to the section."""
    found = []
    for piece in text.split(";"):
        match = _SOURCE.fullmatch(piece)
        if match is not None:
            page = int(match["page"]) if match["page"] else None
            found.append(Source(match["document"] or "", match["section"], page))
    return tuple(found)


def sources(raw: Raw, key: str = "source") -> Sources:
    return parse_sources(raw[key]) if key in raw else ()


def record(kind: Callable[..., T], raw: Raw, /, **made: Any) -> T:
    """Return a ``kind`` whose members have the values in ``made``, or those in ``raw`` under the same name.

    Other members have their default, otherwise an empty value: no text, 0, false, or None if the type allows it. Nested
    parts of the model, and lists of them, are filled in the same way.
    """
    for name, hint, has_default in _members(kind):
        if name in made:
            continue
        if hint == Sources:
            made[name] = sources(raw, name)
        elif name in raw:
            made[name] = _value(hint, raw[name])
        elif not has_default:
            made[name] = _EMPTY.get(get_origin(hint) or hint)
    return kind(**made)


def records(kind: Callable[..., T], raw: Raw, key: str) -> tuple[T, ...]:
    """Return the items that ``raw`` lists under ``key``."""
    return tuple(record(kind, item) for item in raw.get(key, ()))


@cache
def _members(kind: Any) -> tuple[tuple[str, Any, bool], ...]:
    # Names are resolved in the module, so that a member called 'bytes' does not hide the type.
    hints = get_type_hints(kind, localns={})
    return tuple(
        (item.name, hints[item.name], not (item.default is MISSING and item.default_factory is MISSING))
        for item in fields(kind)
    )


def _value(hint: Any, value: Any) -> Any:
    inside = next(iter(get_args(hint)), hint)
    if get_origin(hint) is tuple:
        return tuple(record(inside, item) if isinstance(item, Mapping) else item for item in value)
    if isinstance(inside, type) and is_dataclass(inside) and isinstance(value, Mapping):
        return record(inside, value)
    return value
