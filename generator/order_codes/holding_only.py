"""Reduce a device to some of its order codes, without the facts that apply ``only`` to others."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Any

from ..model import Device, Field, Flag
from ..model.only import fits

#: Parts of a device that have ``only``, or that refer to such parts.
_PARTS = ("interfaces", "registers", "alarms", "timings", "connectors", "leds", "characteristics", "errata")


def held_by(device: Device, codes: Collection[str]) -> Device:
    """Return the device for these order codes.

    Facts that apply to none of these codes are omitted, and such flags are unexplained. Facts that apply to all of them
    lose their ``only``.
    """
    made = replace(device, **{name: _held(getattr(device, name), codes) for name in _PARTS})
    steps = {item.name for item in made.characteristics}
    return replace(made, **{name: _with_steps(getattr(made, name), steps) for name in _PARTS})


def _held(item: Any, codes: Collection[str]) -> Any:
    if isinstance(item, tuple):
        kept = tuple(_held(one, codes) for one in item if not _is_of_others(one, codes))
        is_same = len(kept) == len(item) and all(new is old for new, old in zip(kept, item, strict=True))
        return item if is_same else kept
    if isinstance(item, Field) and isinstance(item.kind, Flag) and _is_of_others(item.kind, codes):
        return item.unexplained
    changed = {name: new for name, old in _parts(item) if (new := _held(old, codes)) is not old}
    only = getattr(item, "only", "")
    if only and all(fits(only, code) for code in codes):
        changed["only"] = ""
    return replace(item, **changed) if changed else item


def _parts(item: Any) -> Iterator[tuple[str, Any]]:
    """Yield the members that can contain an ``only`` or steps: tuples and objects of the model."""
    for name in _names(item.__class__):
        value = getattr(item, name)
        if isinstance(value, tuple) or _names(value.__class__):
            yield name, value


@cache
def _names(kind: type) -> tuple[str, ...]:
    return tuple(item.name for item in fields(kind)) if is_dataclass(kind) else ()


def _is_of_others(item: Any, codes: Collection[str]) -> bool:
    only = getattr(item, "only", "")
    return bool(only) and not any(fits(only, code) for code in codes)


def _with_steps(item: Any, known: Collection[str]) -> Any:
    """Return the item without manual steps that do not apply to the order codes."""
    if isinstance(item, tuple):
        kept = tuple(_with_steps(one, known) for one in item)
        return item if all(new is old for new, old in zip(kept, item, strict=True)) else kept
    changed = {name: new for name, old in _parts(item) if (new := _with_steps(old, known)) is not old}
    names = getattr(item, "by_hand", ())
    if not set(names) <= set(known):
        changed["by_hand"] = tuple(name for name in names if name in known)
    return replace(item, **changed) if changed else item
