"""Conditions for writing: values to set before or after a setting, and when a setting takes effect."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Any

from ..language.problems import listed
from ..model.record import dataclass
from .places import Device, Place, places_of

Raw = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Write:
    """A value that an object of the master must hold. ``text`` is the value as written."""

    object: str
    name: str
    value: int | str
    text: str
    places: tuple[Place, ...]

    @property
    def title(self) -> str:
        return f"{self.object} ({self.name})" if self.name else self.object


@dataclass(frozen=True, slots=True)
class Effect:
    """Condition on which a written value takes effect: exactly one member is not empty."""

    in_state: str = ""
    restart_of: str = ""
    by_call: str = ""
    at_once: bool = False


@dataclass(frozen=True, slots=True)
class WriteCondition:
    """One condition for writing. Exactly one of needs, after, then and takes_effect is not empty.

    ``of`` names its settings, and is empty if it applies to all. ``needs`` are values to write before these settings,
    ``after`` names settings to write before them, ``then`` are values to write after them.
    """

    of: tuple[str, ...]
    needs: tuple[Write, ...]
    after: tuple[str, ...]
    then: tuple[Write, ...]
    takes_effect: Effect | None
    standing: str
    source: str
    text: str


def writing_of(
    rules: Iterable[Raw], names: Collection[str], devices: Sequence[Device], standing: str
) -> tuple[WriteCondition, ...]:
    """Return the conditions for writing the settings ``names`` of a sheet."""
    conditions = []
    for rule in rules:
        settings, after = _known_names(rule, "of", names), _known_names(rule, "after", names)
        if ("of" in rule and not settings) or ("after" in rule and not after):
            continue
        conditions.append(_writing(rule, settings, after, devices, standing))
    return tuple(conditions)


def _known_names(rule: Raw, key: str, names: Collection[str]) -> tuple[str, ...]:
    """Return the names in a list of a rule that are settings of the sheet."""
    return tuple(name for name in rule.get(key, ()) if name in names)


def _writing(
    rule: Raw, settings: tuple[str, ...], after: tuple[str, ...], devices: Sequence[Device], standing: str
) -> WriteCondition:
    needs, then = _writes(rule, "needs", devices, standing), _writes(rule, "then", devices, standing)
    effect = Effect(**rule["takes_effect"]) if "takes_effect" in rule else None
    return WriteCondition(
        of=settings,
        needs=needs,
        after=after,
        then=then,
        takes_effect=effect,
        standing=rule.get("standing", standing),
        source=rule["source"],
        text=_condition_text(settings, needs, after, then, effect),
    )


def _writes(rule: Raw, key: str, devices: Sequence[Device], standing: str) -> tuple[Write, ...]:
    return tuple(_write(raw_write, devices, standing) for raw_write in rule.get(key, ()))


def _write(rule: Raw, devices: Sequence[Device], standing: str) -> Write:
    value = rule["value"]
    return Write(
        object=rule["object"],
        name=rule.get("name", ""),
        value=value,
        text=f"0x{value:X}" if rule.get("as") == "hex" else str(value),
        places=places_of(rule, value, devices, standing, str),
    )


def write_order(names: Sequence[str], rules: Iterable[WriteCondition]) -> tuple[str, ...]:
    """Return the settings in an order that follows every ``after``, and otherwise their own order."""
    return _names_in_order(tuple(names), tuple((rule.of, rule.after) for rule in rules if rule.after))


@lru_cache(maxsize=64)
def _names_in_order(
    names: tuple[str, ...], rules: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...]
) -> tuple[str, ...]:
    predecessors = {name: set[str]() for name in names}
    for settings, after in rules:
        for name in settings:
            predecessors[name].update(after)
    order: list[str] = []
    while len(order) < len(names):
        remaining_names = [name for name in names if name not in order]
        order.append(next(name for name in remaining_names if predecessors[name] <= set(order)))
    return tuple(order)


def _condition_text(
    settings: tuple[str, ...],
    needs: tuple[Write, ...],
    after: tuple[str, ...],
    then: tuple[Write, ...],
    effect: Effect | None,
) -> str:
    """Return a condition as one sentence."""
    if needs:
        values = listed(f"{write.title} must be {write.text}" for write in needs)
        return f"Before writing {listed(settings) or 'any setting'}, {values}."
    if after:
        return f"Write {listed(settings)} after {listed(after)}."
    if then:
        values = listed(f"{write.title} to {write.text}" for write in then)
        return f"After writing {listed(settings) or 'all settings'}, set {values}."
    assert effect is not None
    verb = "takes" if len(settings) == 1 else "take"
    return f"{listed(settings) or 'All settings'} {verb} effect {_when_effective(effect)}."


def _when_effective(effect: Effect) -> str:
    if effect.in_state:
        return f"only in the {effect.in_state} state"
    if effect.restart_of:
        return f"after a restart of {effect.restart_of}"
    if effect.by_call:
        return f"when {effect.by_call} is called"
    return "immediately"
