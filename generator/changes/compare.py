"""Compare two parts of one kind, member by member, using the table in ``members``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import Any

from ..model.expressions import Expression
from .change import Change, Thing
from .members import MEMBERS, ByValue, Limit, Plain, Skip, Treatment
from .shown import arrow, differing_items, plain, shown, without_words
from .sides import Sides
from .values import Differing

#: Rules whose changes are described by their place alone.
_IN_WORDS = ("words", "source")


def members(sides: Sides, thing: Thing, old: Any, new: Any, scope: str = "") -> Iterator[Change]:
    """Yield every changed member. ``scope`` is the frame or register in which to look up the names of fields."""
    table = MEMBERS.get(type(new).__name__, {})
    for item in fields(new):
        treatment = table.get(item.name, Plain("unforeseen", item.name))
        yield from _member(
            sides, thing, item.name, treatment, (getattr(old, item.name), getattr(new, item.name)), scope
        )


def _member(
    sides: Sides, thing: Thing, name: str, treatment: Treatment, both: tuple[Any, Any], scope: str
) -> Iterator[Change]:
    old, new = both
    place = thing.inside(name, thing.label)
    match treatment:
        case Skip():
            return
        case Plain(rule, label, form, refers_to):
            if refers_to:
                old = sides.to_new(refers_to, old, scope)
            if old == new:
                return
            rule = (
                rule if without_words(old) != without_words(new) else "source" if plain(old) == plain(new) else "words"
            )
            if rule in _IN_WORDS:
                yield sides.change(rule, place, f": {name.replace('_', ' ')}", old, new)
            else:
                yield sides.change(rule, place, f": {label} {arrow(*differing_items(old, new), form)}", old, new)
        case ByValue(rule, label):
            found = sides.differing(thing.interface, old, new)
            if found is not None:
                said = f": {label} {numbers(found, old, new)}"
                yield sides.change(rule, place, said, old, new, found.codes or None)
        case Limit():
            yield from _limit(sides, place, treatment, old, new)


def _limit(sides: Sides, place: Thing, limit: Limit, old: Any, new: Any) -> Iterator[Change]:
    before, after = (Expression(item) if isinstance(item, int) else item for item in (old, new))
    found = sides.differing(place.interface, before, after)
    if found is None:
        return
    less = any(_allows_less(limit, *pair) for pair in found.values) or (not found.values and new is not None)
    said = f": {limit.label} {numbers(found, before, after, limit.form)}"
    yield sides.change(limit.narrower if less else limit.wider, place, said, old, new, found.codes or None)


def _allows_less(limit: Limit, old: int | None, new: int | None) -> bool:
    if old is None or new is None:
        return new is not None
    return new < old if limit.upper else new > old


def numbers(found: Differing, old: Expression | None, new: Expression | None, form: str = "") -> str:
    """Return the differing values of two expressions: one pair of numbers, else the expressions, else some pairs."""
    if len(found.values) == 1 and found.everywhere:
        return arrow(*found.values[0], form)
    texts = shown(old, form), shown(new, form)
    if texts[0] != texts[1]:
        return " → ".join(texts)
    more = len(found.values) - 2
    listed = ", ".join(arrow(*pair, form) for pair in found.values[:2])
    return listed + (f" and {more} more" if more > 0 else "")
