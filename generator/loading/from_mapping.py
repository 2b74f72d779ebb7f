"""Build those parts of the model that have the same members and names as the spec."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
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
    parsed = []
    for piece in text.split(";"):
        match = _SOURCE.fullmatch(piece)
        if match is not None:
            page = int(match["page"]) if match["page"] else None
            parsed.append(Source(match["document"] or "", match["section"], page))
    return tuple(parsed)


def sources(raw: Raw, key: str = "source") -> Sources:
    return parse_sources(raw[key]) if key in raw else ()


def record(kind: Callable[..., T], raw: Raw, /, **values: Any) -> T:
    """Return a ``kind`` whose members have the values in ``values``, or those in ``raw`` under the same name.

    Other members have their default, otherwise an empty value: no text, 0, false, or None if the type allows it. Nested
    parts of the model, and lists of them, are filled in the same way.
    """
    for name, hint, has_default in _members(kind):
        if name in values:
            continue
        if hint == Sources:
            values[name] = sources(raw, name)
        elif name in raw:
            values[name] = _value(hint, raw[name])
        elif not has_default:
            values[name] = _EMPTY.get(get_origin(hint) or hint)
    return kind(**values)


def records(kind: Callable[..., T], raw: Raw, key: str) -> tuple[T, ...]:
    """Return the items that ``raw`` lists under ``key``."""
    return tuple(record(kind, definition) for definition in raw.get(key, ()))


@cache
def _members(kind: Any) -> list[tuple[str, Any, bool]]:
    # Names are resolved in the module, so that a member called 'bytes' does not hide the type.
    hints = get_type_hints(kind, localns={})
    return [(member.name, hints[member.name], _has_default(member)) for member in fields(kind)]


def _has_default(member: Field[Any]) -> bool:
    return member.default is not MISSING or member.default_factory is not MISSING


def _value(hint: Any, value: Any) -> Any:
    inner_type = next(iter(get_args(hint)), hint)
    if get_origin(hint) is tuple:
        return tuple(_member(inner_type, member) for member in value)
    if isinstance(inner_type, type) and is_dataclass(inner_type):
        return _member(inner_type, value)
    return value


def _member(kind: Any, value: Any) -> Any:
    return record(kind, value) if isinstance(value, Mapping) else value
