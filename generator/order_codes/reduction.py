"""Reduce a device to some of its order codes, without the facts that apply ``only`` to others."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache
from operator import is_
from typing import Any

from ..model import Device, Field, Flag, Quantity, Source
from ..model.expressions import Expression
from ..model.only import fits

#: Parts that hold for every order code. They make up most of a device, so the search leaves them out.
_ALWAYS = (str, int, Source, Expression, Quantity)
#: Parts of a device that have ``only``, or that refer to such parts.
_PARTS = ("interfaces", "registers", "alarms", "timings", "connectors", "leds", "characteristics", "errata")


def reduced_to_codes(device: Device, codes: Collection[str]) -> Device:
    """Return the device for these order codes.

    Facts that apply to none of these codes are omitted, and such flags are unexplained. Facts that apply to all of them
    lose their ``only``. Questions about unexplained flags are omitted.
    """
    manual_steps = {step.name for step in device.characteristics if not _applies_to_others(step, codes)}
    reduced = replace(device, **{name: _reduced_part(getattr(device, name), codes, manual_steps) for name in _PARTS})
    if not device.optional_alternatives:
        return reduced
    layouts = [layout for _, layout in reduced.layouts()]
    decisive = {alternative.name for layout in layouts for alternative in reduced.verdict_alternatives(layout)}
    decisive |= {alternative.name for alternative in reduced.alternatives if not alternative.default}
    remaining = tuple(alternative for alternative in reduced.alternatives if alternative.name in decisive)
    return replace(reduced, alternatives=remaining)


def _reduced_part(part: Any, codes: Collection[str], manual_steps: Collection[str]) -> Any:
    """Return the part without facts about other order codes, and without manual steps not in ``manual_steps``."""
    if isinstance(part, _ALWAYS):
        return part
    if isinstance(part, tuple):
        return _reduced_values(part, codes, manual_steps)
    if isinstance(part, Field) and isinstance(part.kind, Flag) and _applies_to_others(part.kind, codes):
        return part.unexplained
    if not names_of_members(part.__class__):
        return part
    changed: dict[str, Any] = {}
    for member_name, member in parts_of(part):
        reduced_member = _reduced_part(member, codes, manual_steps)
        if reduced_member is not member:
            changed[member_name] = reduced_member
    only = getattr(part, "only", "")
    if only and all(fits(only, code) for code in codes):
        changed["only"] = ""
    step_names = getattr(part, "by_hand", ())
    if any(step_name not in manual_steps for step_name in step_names):
        changed["by_hand"] = tuple(step_name for step_name in step_names if step_name in manual_steps)
    return replace(part, **changed) if changed else part


def _reduced_values(values: tuple[Any, ...], codes: Collection[str], manual_steps: Collection[str]) -> tuple[Any, ...]:
    """Return the values for these order codes. If nothing changes, the result is the same object."""
    if all(isinstance(value, _ALWAYS) for value in values):
        return values
    applying = [value for value in values if not _applies_to_others(value, codes)]
    reduced_values = tuple([_reduced_part(value, codes, manual_steps) for value in applying])
    is_unchanged = len(reduced_values) == len(values) and all(map(is_, reduced_values, values))
    return values if is_unchanged else reduced_values


def parts_of(part: Any) -> Iterator[tuple[str, Any]]:
    """Yield the members of an object of the model that are objects themselves, or tuples."""
    for name in names_of_members(part.__class__):
        value = getattr(part, name)
        if isinstance(value, tuple) or names_of_members(value.__class__):
            yield name, value


@cache
def names_of_members(kind: type) -> tuple[str, ...]:
    """Return the names of the members of a class of the model that can be replaced. Other classes have none."""
    if not is_dataclass(kind):
        return ()
    return tuple(field.name for field in fields(kind) if field.init)


def _applies_to_others(part: Any, codes: Collection[str]) -> bool:
    only = getattr(part, "only", "")
    return bool(only) and not any(fits(only, code) for code in codes)
