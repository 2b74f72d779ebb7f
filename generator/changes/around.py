"""Compare everything outside the frames: order codes, quantities, alarms, wiring, and facts without effect on code."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import replace
from typing import Any

from ..model import Alternative, Device, Parameter, Spelling, Supply, Variant
from . import known
from .change import Change, Thing
from .compare import members
from .pairs import pairs
from .reach import listed, pattern
from .shown import arrow
from .sides import Sides

#: Sections without effect on code: the rule, the member of the family, and the word for one item.
_TOLD = (
    ("erratum", "errata", "erratum"),
    ("example", "examples", "example"),
    ("told", "characteristics", "characteristic"),
    ("told", "tables", "table"),
    ("told", "leds", "light"),
    ("told", "documents", "document"),
    ("told", "lost_figures", "lost figure"),
)


def family(sides: Sides) -> Iterator[Change]:
    """Compare the family itself, its manufacturer and its manual."""
    old, new = sides.old, sides.new
    if old.name != new.name:
        thing = Thing("device", f"family {old.name} → {new.name} (the same order codes)")
        yield sides.change("family-renamed", thing, "", old.name, new.name)
    if old.title != new.title:
        yield sides.change("words", Thing("title", new.name), ": title", old.title, new.title)
    if old.movement != new.movement:
        said = f": {arrow(old.movement, new.movement)}"
        yield sides.change("movement", Thing("movement", new.name), said, old.movement, new.movement)
    manufacturer = Thing(f"manufacturers.{new.manufacturer.name}", f"manufacturer {new.manufacturer.name}")
    yield from members(sides, manufacturer, old.manufacturer, new.manufacturer)
    if old.manual != new.manual:
        texts = [f"{item.revision}{f' of {item.date}' if item.date else ''}" for item in (old.manual, new.manual)]
        said = f" {arrow(*texts)}" if texts[0] != texts[1] else ": details"
        yield sides.change("manual", Thing("manual", "manual"), said, old.manual, new.manual)


def order_codes(sides: Sides) -> Iterator[Change]:
    old, new = sides.old, sides.new
    gone = [item for item in old.variants if item.code not in sides.shared]
    kept = set(sides.shared.values())
    fresh = [item for item in new.variants if item.code not in kept]
    yield from _codes(sides, "order-code-gone", "gone", old, gone)
    yield from _codes(sides, "order-code-new", "new", new, fresh)
    renamed = {before: after for before, after in sides.shared.items() if before != after}
    if renamed:
        first = " → ".join(next(iter(renamed.items())))
        more = f" and {len(renamed) - 1} more" if len(renamed) > 1 else ""
        label = f"order code{'s' if more else ''} {first}{more} (the same parts)"
        yield sides.change("order-code-renamed", Thing("order_codes", label), "", list(renamed), list(renamed.values()))
    yield from _same_codes(sides)
    thing = Thing("order_code", "order codes")
    yield from members(sides, thing, replace(old.order_code, pattern=""), replace(new.order_code, pattern=""))
    if not renamed and in_new(sides, old.order_code.pattern) != new.order_code.pattern:
        said = f": pattern {arrow(old.order_code.pattern, new.order_code.pattern)}"
        inner = thing.inside("pattern", thing.label)
        yield sides.change("label", inner, said, old.order_code.pattern, new.order_code.pattern)
    yield from _parts(sides)
    yield from _spellings(sides)


def in_new(sides: Sides, pattern: str) -> str:
    """Return an old pattern with the new names of its parts."""
    for before, after in sides.names.get("part", {}).items():
        pattern = pattern.replace(f"{{{before}}}", f"{{{after}}}")
    return pattern


def _codes(sides: Sides, rule: str, word: str, device: Device, found: list[Variant]) -> Iterator[Change]:
    if not found:
        return
    codes = [item.code for item in found]
    said = pattern(device, codes) or listed(codes)
    label = f"order codes {said}: {len(codes)} {word}" if len(codes) > 1 else f"order code {said} is {word}"
    thing = Thing("order_codes", label)
    gone = rule.endswith("gone")
    yield sides.change(rule, thing, "", codes if gone else None, None if gone else codes, codes)


def _same_codes(sides: Sides) -> Iterator[Change]:
    """Compare the interface and the numbers of order codes that both sides have."""
    after = {item.code: item for item in sides.new.variants}
    both = [(item, after[sides.shared[item.code]]) for item in sides.old.variants if item.code in sides.shared]
    moved: dict[tuple[str, str], list[str]] = {}
    for old, new in both:
        if old.interface != new.interface:
            moved.setdefault((old.interface, new.interface), []).append(new.code)
    for pair, codes in moved.items():
        said = f": interface {arrow(*pair)}"
        yield sides.change("interface-of-code", Thing("order_codes.interface", "order codes"), said, *pair, codes)
    for item in sides.parameters():
        both_known = item.old is not None and item.new is not None
        if not both_known or not all(map(_is_of_code, (item.old, item.new))):
            continue
        assert item.old is not None
        assert item.new is not None
        found: dict[tuple[int, int], list[str]] = {}
        for old, new in both:
            numbers = old.parameters[item.old.name], new.parameters[item.new.name]
            if numbers[0] != numbers[1]:
                found.setdefault(numbers, []).append(new.code)
        for numbers, codes in found.items():
            thing = Thing(f"order_codes.parameters.{item.new.name}", item.new.name)
            yield sides.change("parameter-of-code", thing, f" {arrow(*numbers)}", *numbers, codes)


def _is_of_code(item: Parameter | None) -> bool:
    """Return whether order codes set it, rather than a formula, a register or a decision."""
    return item is not None and item.equals is None and not item.read_from and not item.alternative


def _parts(sides: Sides) -> Iterator[Change]:
    for pair in known.parts(sides.old, sides.new):
        item = pair.new or pair.old
        assert item is not None
        thing = Thing(f"order_code.parts.{item.name}", f"part {item.name}")
        yield from sides.presence("part", thing, pair.old, pair.new)
        if pair.old is None or pair.new is None:
            continue
        yield from members(sides, thing, pair.old, pair.new)
        after = {value.text: value for value in pair.new.values}
        for value in pair.old.values:
            if value.text in after:
                inner = thing.inside(value.text, f"{thing.label}: value {value.text}")
                yield from members(sides, inner, value, after[value.text])
                yield from supply(
                    sides, inner, value.supply, after[value.text].supply, _with(sides, item.name, value.text)
                )


def _with(sides: Sides, part: str, text: str) -> tuple[str, ...]:
    """Return the order codes with this text in this part, or all if the manual lists none."""
    found = tuple(item.code for item in sides.new.variants if item.parts.get(part) == text)
    return found or sides.codes("")


def _spellings(sides: Sides) -> Iterator[Change]:
    olds, news = sides.old.order_code.also_written, sides.new.order_code.also_written

    def same(item: Spelling) -> Hashable:
        return in_new(sides, item.pattern), item.values, item.then

    for pair in pairs(olds, news, lambda item: item.where, same, same):
        item = pair.new or pair.old
        assert item is not None
        thing = Thing("order_code.also_written", f"spelling by {item.where}")
        if pair.old is None or pair.new is None:
            yield from sides.presence("spelling", thing, pair.old, pair.new)
        elif pair.old.where != pair.new.where:
            said = f"spelling by {pair.old.where} → {pair.new.where} (the same texts)"
            yield sides.change("spelling-renamed", Thing(thing.path, said), "", pair.old.where, pair.new.where)
        else:
            before = replace(pair.old, pattern=in_new(sides, pair.old.pattern))
            yield from members(sides, thing, before, pair.new)


def supply(
    sides: Sides, thing: Thing, old: Supply | None, new: Supply | None, codes: tuple[str, ...] | None = None
) -> Iterator[Change]:
    """Compare the supply of a family, or of a value in its order code that ``codes`` have."""
    place = Thing(f"{thing.path}.supply".removeprefix("."), f"{thing.label} supply".strip())
    if old is not None and new is not None:
        for change in members(sides, place, old, new):
            yield sides.change(change.rule.name, Thing(change.path, change.text), "", change.old, change.new, codes)
    elif old is not new:
        rule = "supply-wider" if new is None else "supply-narrower"
        yield sides.change(rule, place, f" {arrow(old, new)}", old, new, codes)


def quantities(sides: Sides) -> Iterator[Change]:
    """Compare parameters, decisions and the measurement."""
    for pair in sides.parameters():
        item = pair.new or pair.old
        assert item is not None
        thing = Thing(f"parameters.{item.name}", f"parameter {item.name}", item.interface)
        yield from sides.presence("parameter", thing, pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            yield from members(sides, thing, pair.old, pair.new)
    for decision in known.alternatives(sides.old.alternatives, sides.new.alternatives):
        yield from _decision(sides, decision.old, decision.new)
    ways = [("", sides.old.measurement, sides.new.measurement)]
    kept = {item.name: item for item in sides.old.interfaces}
    ways += [
        (item.name, kept[item.name].measurement, item.measurement) for item in sides.new.interfaces if item.name in kept
    ]
    for interface, old, new in ways:
        thing = Thing("measurement", "measurement", interface)
        if interface:
            thing = Thing(
                f"interfaces.{interface}.measurement", f"{sides.new.interface(interface).short} measurement", interface
            )
        if old is not None and new is not None:
            yield from members(sides, thing, old, new)
        elif old is not new:
            yield from sides.presence("measurement", thing, old, new)


def _decision(sides: Sides, old: Alternative | None, new: Alternative | None) -> Iterator[Change]:
    item = new or old
    assert item is not None
    interfaces = {
        part.interface for part in (sides.new if new else sides.old).parameters if part.alternative == item.name
    }
    thing = Thing(
        f"alternatives.{item.name}", f"decision {item.name}", interfaces.pop() if len(interfaces) == 1 else ""
    )
    yield from sides.presence("decision", thing, old, new)
    if old is None or new is None:
        return
    yield from members(sides, thing, old, new)
    for pair in known.named(old.answers, new.answers, lambda part: tuple(sorted(part.sets.values()))):
        part = pair.new or pair.old
        assert part is not None
        inner = thing.inside(part.name, f"{thing.label}: answer {part.name}")
        yield from sides.presence("answer", inner, pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            yield from members(sides, inner, pair.old, pair.new)


def alarms(sides: Sides) -> Iterator[Change]:
    for pair in known.alarms(sides):
        item = pair.new or pair.old
        assert item is not None
        thing = Thing(
            f"alarms.{item.name}", f"alarm {item.name}", _interface_of(sides.new if pair.new else sides.old, item)
        )
        yield from sides.presence("alarm", thing, pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            yield from members(sides, thing, pair.old, pair.new)


def _interface_of(device: Device, alarm: Any) -> str:
    """Return the only interface whose frames or registers show an error, or "" if there are several."""
    found = {item.interface for item in device.registers if item.name == alarm.register}
    for interface, layout in device.layouts():
        if alarm.group and any(field.group == alarm.group for field in layout.fields):
            found.add(interface.name)
    return found.pop() if len(found) == 1 else ""


def wiring(sides: Sides) -> Iterator[Change]:
    """Compare supply, connectors and inputs."""
    yield from supply(sides, Thing("", ""), sides.old.supply, sides.new.supply)
    same = lambda item: tuple((part.contact, part.signal) for part in item.contacts)  # noqa: E731 (said once)
    for pair in known.named(sides.old.connectors, sides.new.connectors, same):
        item = pair.new or pair.old
        assert item is not None
        only = item.interfaces[0] if len(item.interfaces) == 1 else ""
        thing = Thing(f"connectors.{item.name}", f"{item.kind} {item.name}", only)
        yield from sides.presence("connector", thing, pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            yield from members(sides, thing, pair.old, pair.new)
            yield from _contacts(sides, thing, pair.old.contacts, pair.new.contacts)
    for pair_of_input in known.named(
        sides.old.inputs, sides.new.inputs, lambda part: (part.inverts, part.low, part.high)
    ):
        part = pair_of_input.new or pair_of_input.old
        assert part is not None
        thing = Thing(f"inputs.{part.name}", f"input {part.name}")
        yield from sides.presence("input", thing, pair_of_input.old, pair_of_input.new)
        if pair_of_input.old is not None and pair_of_input.new is not None:
            yield from members(sides, thing, pair_of_input.old, pair_of_input.new)


def _contacts(sides: Sides, thing: Thing, olds: Any, news: Any) -> Iterator[Change]:
    before, after = ({item.contact: item for item in each} for each in (olds, news))
    for contact in dict.fromkeys((*before, *after)):
        place = thing.inside(contact, f"{thing.label}: {contact}")
        old, new = before.get(contact), after.get(contact)
        if old is not None and new is not None:
            yield from members(sides, place, old, new)
        else:
            was, now = (item.signal if item is not None else None for item in (old, new))
            yield sides.change("contact", place, f": signal {arrow(was, now)}", was, now)


def told(sides: Sides) -> Iterator[Change]:
    """Compare errata, examples, and facts that no code depends on."""
    for rule, section, word in _TOLD:
        olds, news = ({_key(item): item for item in getattr(device, section)} for device in (sides.old, sides.new))
        for key in dict.fromkeys((*olds, *news)):
            old, new = olds.get(key), news.get(key)
            if old != new:
                how = " is new" if old is None else " is gone" if new is None else " has changed"
                yield sides.change(rule, Thing(f"{section}.{key}", f"{word} {key}"), how, old, new)
    for group in known.named(sides.old.field_groups, sides.new.field_groups, known.nothing):
        if group.old is not None and group.new is not None:
            place = Thing(f"field_groups.{group.new.name}", f"group {group.new.name}")
            yield from members(sides, place, group.old, group.new)


def _key(item: Any) -> str:
    return str(getattr(item, "name", "") or getattr(item, "key", "") or getattr(item, "content", ""))
