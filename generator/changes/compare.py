"""Compare two parts of one kind, member by member, by the rules in the table of members."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, replace
from types import MappingProxyType
from typing import Any, TypeVar

from ..model import Alarm, Alternative, Connector, Crc, Device
from ..model.expressions import Expression
from ..model.members import PARTS_BY_CLASS, WIDER, Member
from ..order_codes.narrowing import sent_crcs
from ..say.numbers import first_of
from ..say.place import register_at
from .change import Change, Thing
from .counterparts import in_section, recognised
from .expressions import Differing
from .family_pair import FamilyPair
from .pairs import Pair
from .value_text import arrow, differing_items, plain, shown, without_words

_Item = TypeVar("_Item")
#: Rules whose changes are described only by their location.
_IN_WORDS = ("words", "source")
_SOURCE = Member("source", rule="source")
#: Kinds of things with a section in the spec: the path of the section, and the words that precede the name of a thing.
_SECTIONS: Mapping[str, tuple[str, str | Callable[[Pair[Any]], str]]] = MappingProxyType(
    {
        "part": ("order_code.parts", "part"),
        "parameter": ("parameters", "parameter"),
        "decision": ("alternatives", "decision"),
        "crc": ("crcs", "CRC"),
        "register": ("registers", lambda pair: register_at(pair.first)),
        "alarm": ("alarms", "alarm"),
        "procedure": ("procedures", "procedure"),
        "connector": ("connectors", lambda pair: str(pair.item.kind)),
        "input": ("inputs", "input"),
    }
)
#: Kinds of things that concern the interface of the old thing even if the new one has another.
_OF_OLD = ("crc", "procedure")
#: Names of things in C and in Python, so that users can search their code for them: by section, with the manufacturer,
#: the family and the thing itself.
_NAMES: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "registers": ("{MANUFACTURER}_{FAMILY}_{INTERFACE}_REG_{NAME}_…", '{family}.REGISTERS["{name}"]'),
        "layouts": ("{manufacturer}_{family}_{interface}_{name}_…", "{family}.{Name}"),
        "procedures": ("{manufacturer}_{family}_{interface}_{name}_…", "{family}.{name}"),
        "crcs": ("{manufacturer}_{family}_{interface}_crc_{name}", "{family}.crc_{name}"),
        "data_ids": ("{MANUFACTURER}_{FAMILY}_{INTERFACE}_DATA_ID_{NAME}", "{family}.DataId"),
    }
)
#: Compare the content of two things.
Inside = Callable[[FamilyPair, Thing, Any, Any], Iterator[Change]]


def members(both: FamilyPair, thing: Thing, old: Any, new: Any) -> Iterator[Change]:
    """Yield every changed member."""
    old = both.in_new(old, thing.scope)
    known = {"source": _SOURCE, **PARTS_BY_CLASS[type(new).__name__].by_attribute}
    for item in fields(new):
        member = known.get(item.name) or Member(item.name, rule="unforeseen")
        if member.rule:
            values = getattr(old, item.name), getattr(new, item.name)
            yield from _member(both, thing.inside(item.name, thing.label), member, *values)


def _member(both: FamilyPair, place: Thing, member: Member, old: Any, new: Any) -> Iterator[Change]:
    kinds = {type(old), type(new)}
    if member.is_limit or (Expression in kinds and str not in kinds):
        yield from _number(both, place, member, old, new)
        return
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
    olds: Sequence[_Item],
    news: Sequence[_Item],
    place: Thing,
    inside: Inside | None = None,
) -> Iterator[Change]:
    """Yield the changes of several things: new, gone and renamed ones, and the members of the others.

    Args:
        both: The two versions of the family.
        kind: Kind of the things, with which the names of their rules begin.
        olds: The old things.
        news: The new things.
        place: The section that contains them. Its label has the words that precede the name of a thing.
        inside: Compare the content of a thing that the table of members does not compare.
    """
    for pair in recognised(both, olds, news, place.interface, place.scope):
        yield from compared(both, kind, _named_in_code(both, pair, place), pair, inside)


def compared(
    both: FamilyPair, kind: str, thing: Thing, pair: Pair[Any], inside: Inside | None = None
) -> Iterator[Change]:
    """Yield the changes of one thing, like ``things``."""
    has_default = isinstance(pair.item, Alternative) and bool(pair.item.default)
    yield from both.presence("choice" if has_default else kind, thing, pair.old, pair.new)
    if pair.old is not None and pair.new is not None:
        yield from members(both, thing.unnamed, pair.old, pair.new)
        if inside is not None:
            yield from inside(both, thing, pair.old, pair.new)


def section(both: FamilyPair, kind: str, inside: Inside | None = None) -> Iterator[Change]:
    """Yield the changes of all things in a section of the spec."""
    path, label = _SECTIONS[kind]
    for pair in in_section(both, path):
        words = label if isinstance(label, str) else label(pair)
        is_old = pair.new is None or (kind in _OF_OLD and pair.old is not None)
        interface = _interface_of(*((both.old, pair.old) if is_old else (both.new, pair.new)))
        thing = _named_in_code(both, pair, Thing(path, words, interface))
        yield from compared(both, kind, thing, pair, inside)


def _interface_of(device: Device, item: Any) -> str:
    """Return the only interface that a thing concerns, or "" if it concerns several or all."""
    match item:
        case Alternative(name):
            found = {each.interface for each in device.parameters if each.alternative == name}
        case Alarm():
            found = {each.interface for each in device.registers if each.name == item.register}
            layouts = (pair for pair in device.layouts() if item.group)
            found |= {each.name for each, layout in layouts if item.group in {field.group for field in layout.fields}}
        case Connector():
            found = set(item.interfaces)
        case Crc(name):
            found = {each.name for each in device.interfaces if name in sent_crcs((each,))}
        case _:
            found = {getattr(item, "interface", "")}
    return found.pop() if len(found) == 1 else ""


def _named_in_code(both: FamilyPair, pair: Pair[Any], place: Thing) -> Thing:
    """Return a thing in a section, with its names in code if users already know it by them."""
    kind, interface, name = place.path.rpartition(".")[2], place.interface, pair.item.name
    thing = Thing(f"{place.path}.{name}", f"{place.label} {name}", interface, scope=place.scope or name)
    # A new data ID is a new member of an enumeration that users already have.
    if kind not in _NAMES or (pair.old is None and kind != "data_ids"):
        return thing
    device = both.new if pair.old is None else both.old
    words = {"manufacturer": device.manufacturer.name, "family": device.name, "name": pair.first.name}
    # Of a faulty spec, there may be no interface.
    names = (interface, getattr(pair.first, "interface", ""), *(item.name for item in device.interfaces))
    words["interface"] = next(filter(None, names), "")
    words |= {key.upper(): text.upper() for key, text in words.items()}
    words["Name"] = "".join(part[:1].upper() + part[1:] for part in pair.first.name.split("_"))
    c, python = (text.format(**words) for text in _NAMES[kind])
    if kind == "layouts" and len(device.interface(words["interface"]).layouts) == 1:
        # The only frame of an interface needs no further name.
        c = c.replace(f"_{pair.first.name}_…", "_…")
    if kind == "crcs" and not interface:
        # C has no function for a CRC that no frame uses.
        c = "{manufacturer}_{family}_…".format(**words)
    return replace(thing, names={"c": c, "python": python})
