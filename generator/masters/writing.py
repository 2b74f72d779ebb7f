"""Conditions for writing the settings of a master, and the order in which to write them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

from ..language.problems import join_words
from ..model.record import dataclass
from .places import MasterDevice, SettingPlace, YamlMapping, places_of


@dataclass(frozen=True, slots=True)
class ObjectWrite:
    """A value to write to an object of the master. ``text`` is the value in decimal or hexadecimal."""

    object: str
    name: str
    value: int | str
    text: str
    places: tuple[SettingPlace, ...]

    @property
    def title(self) -> str:
        """The object with its name in parentheses, if it has one."""
        return f"{self.object} ({self.name})" if self.name else self.object


@dataclass(frozen=True, slots=True)
class WriteEffect:
    """Condition under which a written value takes effect. Exactly one member is not empty."""

    in_state: str = ""
    restart_of: str = ""
    by_call: str = ""
    at_once: bool = False


@dataclass(frozen=True, slots=True)
class WriteCondition:
    """A condition for writing settings.

    Exactly one of ``needs``, ``after``, ``then`` and ``takes_effect`` is not empty. ``of`` names the settings, and is
    empty if the condition applies to all. ``needs`` are values to write before these settings, ``after`` names settings
    to write before them, and ``then`` are values to write after them.
    """

    of: tuple[str, ...]
    needs: tuple[ObjectWrite, ...]
    after: tuple[str, ...]
    then: tuple[ObjectWrite, ...]
    takes_effect: WriteEffect | None
    standing: str
    source: str
    text: str


def writing_of(
    rules: Iterable[YamlMapping], names: Collection[str], *, devices: Sequence[MasterDevice], standing: str
) -> tuple[WriteCondition, ...]:
    """Return the conditions for writing the settings with these names.

    A rule lists its settings under ``of``, or applies to all, and can list other settings to write first under
    ``after``. It is omitted if none of the settings in one of these lists is in ``names``.
    """
    conditions: list[WriteCondition] = []
    for rule in rules:
        settings = _known_names(rule, "of", names)
        predecessors = _known_names(rule, "after", names)
        has_no_setting = "of" in rule and not settings
        has_no_predecessor = "after" in rule and not predecessors
        if has_no_setting or has_no_predecessor:
            continue
        condition = _write_condition(
            rule, settings=settings, predecessors=predecessors, devices=devices, standing=standing
        )
        conditions.append(condition)
    return tuple(conditions)


def _known_names(rule: YamlMapping, key: str, names: Collection[str]) -> tuple[str, ...]:
    """Return the names that a rule lists under ``key`` and that are also in ``names``."""
    return tuple(name for name in rule.get(key, ()) if name in names)


def _write_condition(
    rule: YamlMapping,
    *,
    settings: tuple[str, ...],
    predecessors: tuple[str, ...],
    devices: Sequence[MasterDevice],
    standing: str,
) -> WriteCondition:
    """Return a condition for writing, with its text.

    ``settings`` are the settings to which it applies, and ``predecessors`` are settings to write before them.
    """
    writes_before = tuple(_write_from_rule(write_rule, devices, standing) for write_rule in rule.get("needs", ()))
    writes_after = tuple(_write_from_rule(write_rule, devices, standing) for write_rule in rule.get("then", ()))
    condition = WriteCondition(
        of=settings,
        needs=writes_before,
        after=predecessors,
        then=writes_after,
        takes_effect=WriteEffect(**rule["takes_effect"]) if "takes_effect" in rule else None,
        standing=rule.get("standing", standing),
        source=rule["source"],
        text="",
    )
    return replace(condition, text=_condition_text(condition))


def _write_from_rule(rule: YamlMapping, devices: Sequence[MasterDevice], standing: str) -> ObjectWrite:
    """Return a value to write with its locations. Its text is hexadecimal if the rule has ``as: hex``."""
    value = rule["value"]
    return ObjectWrite(
        object=rule["object"],
        name=rule.get("name", ""),
        value=value,
        text=f"0x{value:X}" if rule.get("as") == "hex" else str(value),
        # Locations of such values contain no names in braces to fill in.
        places=places_of(rule, value, devices=devices, standing=standing, fill_in=str),
    )


def write_order(names: Sequence[str], rules: Iterable[WriteCondition]) -> tuple[str, ...]:
    """Return the names of settings in the order in which to write them.

    The original order is changed only if a rule requires that a setting is written after others.
    """
    orderings = tuple(_Ordering(settings=rule.of, after=rule.after) for rule in rules if rule.after)
    return _names_in_order(tuple(names), orderings)


class _Ordering(NamedTuple):
    """Rule that each of ``settings`` must be written after all settings in ``after``."""

    settings: tuple[str, ...]
    after: tuple[str, ...]


@lru_cache(maxsize=64)
def _names_in_order(names: tuple[str, ...], orderings: tuple[_Ordering, ...]) -> tuple[str, ...]:
    """Return the names in an order in which all predecessors of a name come before it.

    The next name is always the first one whose predecessors have all been written. Cycles are rejected when a
    description is loaded. Results are cached, since many order codes have the same rules.
    """
    predecessors = {name: set[str]() for name in names}
    for ordering in orderings:
        for name in ordering.settings:
            predecessors[name].update(ordering.after)
    written_names: list[str] = []
    while len(written_names) < len(names):
        unwritten_names = [name for name in names if name not in written_names]
        ready_names = [name for name in unwritten_names if predecessors[name].issubset(written_names)]
        written_names.append(ready_names[0])
    return tuple(written_names)


def _condition_text(condition: WriteCondition) -> str:
    """Return a condition for writing as one sentence.

    It is about values to write before or after the settings, about the order of settings, or about the time when they
    take effect.
    """
    # Empty if the condition applies to all settings.
    setting_names = join_words(condition.of)
    if condition.needs:
        needed_values = join_words(f"{write.title} must be {write.text}" for write in condition.needs)
        return f"Before writing {setting_names or 'any setting'}, {needed_values}."
    if condition.after:
        return f"Write {setting_names} after {join_words(condition.after)}."
    if condition.then:
        values_to_set = join_words(f"{write.title} to {write.text}" for write in condition.then)
        return f"After writing {setting_names or 'all settings'}, set {values_to_set}."
    assert condition.takes_effect is not None
    verb = "takes" if len(condition.of) == 1 else "take"
    return f"{setting_names or 'All settings'} {verb} effect {_when_effective(condition.takes_effect)}."


def _when_effective(effect: WriteEffect) -> str:
    """Return the words for the time when a written value takes effect, such as ``immediately``."""
    if effect.in_state:
        return f"only in the {effect.in_state} state"
    if effect.restart_of:
        return f"after a restart of {effect.restart_of}"
    if effect.by_call:
        return f"when {effect.by_call} is called"
    return "immediately"
