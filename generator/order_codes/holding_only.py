"""Reduce a device to some of its order codes, without the facts that apply ``only`` to others."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Any

from ..model import Device, Field, Flag, Quantity, Source
from ..model.expressions import Expression
from ..model.only import fits

#: Parts that hold for every order code. They make up most of a device, so the search leaves them out.
_ALWAYS = (str, int, Source, Expression, Quantity)
#: Parts of a device that have ``only``, or that refer to such parts.
_PARTS = ("interfaces", "registers", "alarms", "timings", "connectors", "leds", "characteristics", "errata")


def held_by(device: Device, codes: Collection[str]) -> Device:
    """Return the device for these order codes.

    Facts that apply to none of these codes are omitted, and such flags are unexplained. Facts that apply to all of them
    lose their ``only``. Questions about unexplained flags are omitted.
    """
    steps = {item.name for item in device.characteristics if not _is_of_others(item, codes)}
    here = replace(device, **{name: _held(getattr(device, name), codes, steps) for name in _PARTS})
    if not device.optional_alternatives:
        return here
    decisive = {item.name for _, layout in here.layouts() for item in here.verdict_alternatives(layout)}
    alternatives = tuple(item for item in here.alternatives if not item.default or item.name in decisive)
    return replace(here, alternatives=alternatives)


def _held(item: Any, codes: Collection[str], steps: Collection[str]) -> Any:
    """Return the item without parts of other order codes and without manual steps that are not among ``steps``."""
    if isinstance(item, _ALWAYS) or (isinstance(item, tuple) and all(isinstance(one, _ALWAYS) for one in item)):
        return item
    if isinstance(item, tuple):
        kept = tuple([_held(one, codes, steps) for one in item if not _is_of_others(one, codes)])
        is_same = len(kept) == len(item) and all(new is old for new, old in zip(kept, item, strict=True))
        return item if is_same else kept
    if isinstance(item, Field) and isinstance(item.kind, Flag) and _is_of_others(item.kind, codes):
        return item.unexplained
    if not names_of_members(item.__class__):
        return item
    changed = {name: new for name, old in parts_of(item) if (new := _held(old, codes, steps)) is not old}
    only = getattr(item, "only", "")
    if only and all(fits(only, code) for code in codes):
        changed["only"] = ""
    names = getattr(item, "by_hand", ())
    if any(name not in steps for name in names):
        changed["by_hand"] = tuple(name for name in names if name in steps)
    return replace(item, **changed) if changed else item


def parts_of(item: Any) -> Iterator[tuple[str, Any]]:
    """Yield the members of an object of the model that are objects themselves, or tuples."""
    for name in names_of_members(item.__class__):
        value = getattr(item, name)
        if isinstance(value, tuple) or names_of_members(value.__class__):
            yield name, value


@cache
def names_of_members(kind: type) -> tuple[str, ...]:
    """Return the names of the members of a class of the model that can be replaced. Other classes have none."""
    return tuple(item.name for item in fields(kind) if item.init) if is_dataclass(kind) else ()


def _is_of_others(item: Any, codes: Collection[str]) -> bool:
    only = getattr(item, "only", "")
    return bool(only) and not any(fits(only, code) for code in codes)
