"""Compare the family itself, its order codes, and the quantities that they set."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import replace
from operator import attrgetter

from ..model import Alternative, CodePart, Parameter, Spelling, Supply, Variant
from ..say.numbers import first_of
from .affected_codes import pattern
from .change import Change, Thing
from .compare import members, section, things
from .counterparts import in_section
from .family_pair import FamilyPair
from .pairs import both_of, paired
from .value_text import arrow


def family(both: FamilyPair) -> Iterator[Change]:
    """Compare the family itself, its manufacturer and its manual."""
    old, new = both.old, both.new
    yield from both.presence("family", Thing("device", f"family {new.name}"), old, new)
    if old.title != new.title:
        yield both.change("words", Thing("title", new.name), ": title", old.title, new.title)
    if old.movement != new.movement:
        said = f": {arrow(old.movement, new.movement)}"
        yield both.change("movement", Thing("movement", new.name), said, old.movement, new.movement)
    manufacturer = Thing(f"manufacturers.{new.manufacturer.name}", f"manufacturer {new.manufacturer.name}")
    yield from members(both, manufacturer, old.manufacturer, new.manufacturer)
    evidence = Thing("evidence", "evidence")
    if old.evidence and new.evidence:
        yield from members(both, evidence, old.evidence, new.evidence)
    elif old.evidence or new.evidence:  # With --lenient, a spec in an older form of the language has none.
        said = " is new" if new.evidence else " is gone"
        yield both.change("evidence", evidence, said, old.evidence, new.evidence)
    if old.manual != new.manual:
        texts = [f"{item.revision}{f' of {item.date}' if item.date else ''}" for item in (old.manual, new.manual)]
        said = f" {arrow(*texts)}" if texts[0] != texts[1] else ": details"
        yield both.change("manual", Thing("manual", "manual"), said, old.manual, new.manual)


def order_codes(both: FamilyPair) -> Iterator[Change]:
    old, new = both.old, both.new
    yield from _codes(both, "gone", [item for item in old.variants if item.code not in both.shared])
    yield from _codes(both, "new", [item for item in new.variants if item.code not in both.kept])
    renamed = {before: after for before, after in both.shared.items() if before != after}
    if renamed:
        said = first_of([" → ".join(names) for names in renamed.items()], 1)
        label = f"order code{'s' * (len(renamed) > 1)} {said} (the same parts)"
        yield both.change("order-code-renamed", Thing("order_codes", label), "", list(renamed), list(renamed.values()))
    yield from _same_codes(both)
    before = replace(old.order_code, pattern=new.order_code.pattern) if renamed else old.order_code
    yield from members(both, Thing("order_code", "order codes"), before, new.order_code)
    yield from section(both, "part", _part)
    yield from _spellings(both)


def _codes(both: FamilyPair, word: str, found: list[Variant]) -> Iterator[Change]:
    if not found:
        return
    codes = [item.code for item in found]
    is_gone = word == "gone"
    said = pattern(both.old if is_gone else both.new, codes) or first_of(codes)
    label = f"order codes {said}: {len(codes)} {word}" if len(codes) > 1 else f"order code {said} is {word}"
    old, new = (codes, None) if is_gone else (None, codes)
    yield both.change(f"order-code-{word}", Thing("order_codes", label), "", old, new, codes)


def _same_codes(both: FamilyPair) -> Iterator[Change]:
    """Compare the interface and the numbers of order codes that both versions have."""
    after = {item.code: item for item in both.new.variants}
    pairs = [(item, after[both.shared[item.code]]) for item in both.old.variants if item.code in both.shared]
    moved: dict[tuple[str, str], list[str]] = {}
    for old, new in pairs:
        if old.interface != new.interface:
            moved.setdefault((old.interface, new.interface), []).append(new.code)
    for names, codes in moved.items():
        said = f": interface {arrow(*names)}"
        yield both.change("interface-of-code", Thing("order_codes.interface", "order codes"), said, *names, codes)
    for before, now in both_of(in_section(both, "parameters")):
        found: dict[tuple[int, int], list[str]] = {}
        for old, new in pairs if _is_of_code(before) and _is_of_code(now) else ():
            numbers = old.parameters[before.name], new.parameters[now.name]
            if numbers[0] != numbers[1]:
                found.setdefault(numbers, []).append(new.code)
        for numbers, codes in found.items():
            thing = Thing(f"order_codes.parameters.{now.name}", now.name)
            yield both.change("parameter-of-code", thing, f" {arrow(*numbers)}", *numbers, codes)


def _is_of_code(item: Parameter) -> bool:
    """Return whether order codes set it, rather than a formula, a register or a decision."""
    return item.equals is None and not item.read_from and not item.alternative


def _part(both: FamilyPair, thing: Thing, old: CodePart, new: CodePart) -> Iterator[Change]:
    """Compare the values that the part has in both versions. Other changes are visible in the order codes."""
    for before, after in both_of(paired(old.values, new.values, name=attrgetter("text"))):
        inner = thing.inside(after.text, f"{thing.label}: value {after.text}")
        yield from members(both, inner, before, after)
        codes = tuple(item.code for item in both.new.variants if item.parts.get(new.name) == after.text)
        yield from supply(both, inner, before.supply, after.supply, codes or both.codes(""))


def _spellings(both: FamilyPair) -> Iterator[Change]:
    def same(item: Spelling) -> Hashable:
        return replace(both.in_new(item), where="", source=())

    olds, news = both.old.order_code.also_written, both.new.order_code.also_written
    for pair in paired(olds, news, same, name=attrgetter("where")):
        thing = Thing("order_code.also_written", f"spelling by {pair.item.where}")
        if pair.old is None or pair.new is None:
            yield from both.presence("spelling", thing, pair.old, pair.new)
        elif pair.old.where != pair.new.where:
            said = f"spelling by {pair.old.where} → {pair.new.where} (the same texts)"
            yield both.change("spelling-renamed", Thing(thing.path, said), "", pair.old.where, pair.new.where)
        else:
            yield from members(both, thing, pair.old, pair.new)


def supply(
    both: FamilyPair, thing: Thing, old: Supply | None, new: Supply | None, codes: tuple[str, ...] | None = None
) -> Iterator[Change]:
    """Compare the supply of a family, or of an order code value that ``codes`` have."""
    place = thing.inside("supply", f"{thing.label} supply".strip())
    if old is not None and new is not None:
        for change in members(both, place, old, new):
            yield both.change(change.rule.name, Thing(change.path, change.text), "", change.old, change.new, codes)
    elif old is not new:
        rule = "supply-wider" if new is None else "supply-narrower"
        yield both.change(rule, place, f" {arrow(old, new)}", old, new, codes)


def quantities(both: FamilyPair) -> Iterator[Change]:
    """Compare parameters, decisions and the measurement."""
    yield from section(both, "parameter")
    yield from section(both, "decision", _answers)
    measured = [(Thing("measurement", "measurement"), both.old.measurement, both.new.measurement)]
    for old, new in both_of(paired(both.old.interfaces, both.new.interfaces)):
        thing = Thing(f"interfaces.{new.name}.measurement", f"{new.short} measurement", new.name)
        measured.append((thing, old.measurement, new.measurement))
    for thing, before, after in measured:
        if before is not None and after is not None:
            yield from members(both, thing, before, after)
        elif before is not after:
            yield from both.presence("measurement", thing, before, after)


def _answers(both: FamilyPair, thing: Thing, old: Alternative, new: Alternative) -> Iterator[Change]:
    yield from things(both, "answer", old.answers, new.answers, replace(thing, label=f"{thing.label}: answer"))
