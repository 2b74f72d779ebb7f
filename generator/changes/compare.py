"""Compare two parts of one kind, member by member, by the rules in the table of members."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields
from typing import Any, TypeVar

from ..model.expressions import Expression
from ..model.members import PARTS_BY_CLASS, WIDER, Member
from ..say.numbers import first_of
from .change import Change, Thing
from .expressions import Differing
from .family_pair import FamilyPair
from .names_in_code import named_in_code
from .pairs import Pair, name_of
from .value_text import arrow, differing_items, plain, shown, without_words

_Item = TypeVar("_Item")
#: Rules whose changes are described only by their location.
_IN_WORDS = ("words", "source")
_SOURCE = Member("source", rule="source")


def members(both: FamilyPair, thing: Thing, old: Any, new: Any, scope: str = "") -> Iterator[Change]:
    """Yield every changed member. ``scope`` is the frame or register in which to look up the names of fields."""
    known = {"source": _SOURCE, **PARTS_BY_CLASS[type(new).__name__].by_attribute}
    for item in fields(new):
        member = known.get(item.name) or Member(item.name, rule="unforeseen")
        if member.rule:
            values = getattr(old, item.name), getattr(new, item.name)
            yield from _member(both, thing.inside(item.name, thing.label), member, *values, scope)


def _member(both: FamilyPair, place: Thing, member: Member, old: Any, new: Any, scope: str) -> Iterator[Change]:
    kinds = {type(old), type(new)}
    if member.is_limit or (Expression in kinds and str not in kinds):
        yield from _number(both, place, member, old, new)
        return
    if member.refers_to:
        old = both.to_new(member.refers_to, old, scope)
    if old == new:
        return
    rule = "source" if plain(old) == plain(new) else "words"
    rule = member.rule if without_words(old) != without_words(new) else rule
    if rule in _IN_WORDS:
        said = f": {member.attribute.replace('_', ' ')}"
    else:
        said = f": {member.words} {arrow(*differing_items(old, new), member.notation)}"
    yield both.change(rule, place, said, old, new)


def _number(both: FamilyPair, place: Thing, member: Member, old: Any, new: Any) -> Iterator[Change]:
    """Compare numbers and expressions by their values for each order code."""
    before, after = (Expression(item) if isinstance(item, int) else item for item in (old, new))
    found = both.differing(place.interface, before, after)
    if found is None:
        return
    less = any(_allows_less(member, *pair) for pair in found.values) or (not found.values and new is not None)
    rule = WIDER[member.rule] if member.is_limit and not less else member.rule
    said = f": {member.words} {numbers(found, before, after, member.notation)}"
    yield both.change(rule, place, said, old, new, found.codes or None)


def _allows_less(member: Member, old: int | None, new: int | None) -> bool:
    if old is None or new is None:
        return new is not None
    return new < old if member.is_upper else new > old


def numbers(found: Differing, old: Expression | None, new: Expression | None, form: str = "") -> str:
    """Return the differing values of two expressions: one pair of numbers, else the expressions, else some pairs."""
    if len(found.values) == 1 and found.everywhere:
        return arrow(*found.values[0], form)
    texts = shown(old, form), shown(new, form)
    if texts[0] != texts[1]:
        return " → ".join(texts)
    return first_of([arrow(*pair, form) for pair in found.values], 2)


def things(
    both: FamilyPair,
    kind: str,
    pairs: Iterable[Pair[_Item]],
    path: str,
    label: str | Callable[[Pair[_Item]], str],
    interface: str | Callable[[Pair[_Item]], str] = "",
    inside: Callable[[FamilyPair, Thing, _Item, _Item], Iterator[Change]] | None = None,
) -> Iterator[Change]:
    """Yield the changes of several things: new, gone and renamed ones, and the members of the others.

    Args:
        both: The two versions of the family.
        kind: Kind of the things, with which the names of their rules begin.
        pairs: The things with their counterparts.
        path: Path of the section that contains them.
        label: Words that precede the name of a thing, or a function that returns them.
        interface: Interface that a thing concerns, or a function that returns it.
        inside: Compare the content of a thing that the table of members does not compare.
    """
    for pair in pairs:
        words, over = (each if isinstance(each, str) else each(pair) for each in (label, interface))
        thing = named_in_code(both, pair, path, words, over)
        yield from both.presence(kind, thing, pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            yield from members(both, thing.unnamed, pair.old, pair.new, name_of(pair.new))
            if inside is not None:
                yield from inside(both, thing, pair.old, pair.new)
