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
class Writing:
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
) -> tuple[Writing, ...]:
    """Return the conditions for writing the settings ``names`` of a sheet."""
    found = []
    for rule in rules:
        of, after = (tuple(item for item in rule.get(key, ()) if item in names) for key in ("of", "after"))
        if ("of" in rule and not of) or ("after" in rule and not after):
            continue
        found.append(_writing(rule, of, after, devices, standing))
    return tuple(found)


def _writing(
    rule: Raw, of: tuple[str, ...], after: tuple[str, ...], devices: Sequence[Device], standing: str
) -> Writing:
    needs, then = (tuple(_write(item, devices, standing) for item in rule.get(key, ())) for key in ("needs", "then"))
    effect = Effect(**rule["takes_effect"]) if "takes_effect" in rule else None
    text = _sentence(of, needs, after, then, effect)
    return Writing(of, needs, after, then, effect, rule.get("standing", standing), rule["source"], text)


def _write(item: Raw, devices: Sequence[Device], standing: str) -> Write:
    value = item["value"]
    text = f"0x{value:X}" if item.get("as") == "hex" else str(value)
    places = places_of(item, value, devices, standing, str)
    return Write(item["object"], item.get("name", ""), value, text, places)


def write_order(names: Sequence[str], rules: Iterable[Writing]) -> tuple[str, ...]:
    """Return the settings in an order that follows every ``after``, and otherwise their own order."""
    return _order(tuple(names), tuple((rule.of, rule.after) for rule in rules if rule.after))


@lru_cache(maxsize=64)
def _order(names: tuple[str, ...], rules: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...]) -> tuple[str, ...]:
    later = {name: set[str]() for name in names}
    for of, after in rules:
        for name in of:
            later[name].update(after)
    order: list[str] = []
    while len(order) < len(names):
        order.append(next(name for name in names if name not in order and later[name] <= set(order)))
    return tuple(order)


def _sentence(
    of: tuple[str, ...],
    needs: tuple[Write, ...],
    after: tuple[str, ...],
    then: tuple[Write, ...],
    effect: Effect | None,
) -> str:
    """Return a condition as one sentence."""
    if needs:
        return (
            f"Before writing {listed(of) or 'any setting'}, {listed(f'{it.title} must be {it.text}' for it in needs)}."
        )
    if after:
        return f"Write {listed(of)} after {listed(after)}."
    if then:
        return f"After writing {listed(of) or 'all settings'}, set {listed(f'{it.title} to {it.text}' for it in then)}."
    assert effect is not None
    return f"{listed(of) or 'All settings'} {'takes' if len(of) == 1 else 'take'} effect {_when(effect)}."


def _when(effect: Effect) -> str:
    if effect.in_state:
        return f"only in the {effect.in_state} state"
    if effect.restart_of:
        return f"after a restart of {effect.restart_of}"
    if effect.by_call:
        return f"when {effect.by_call} is called"
    return "immediately"
