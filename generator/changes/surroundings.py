"""Compare alarms, wiring, and facts without effect on code."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..model import Alarm, Connector, Contact, Device
from .change import Change, Thing
from .compare import members, things
from .counterparts import recognised
from .family_pair import FamilyPair
from .order_codes import supply
from .pairs import Pair, both_of, paired
from .value_text import arrow, shown

#: Sections without effect on code: the rule, the member of the family, and the word for one item.
_DISPLAYED = (
    ("erratum", "errata", "erratum"),
    ("example", "examples", "example"),
    ("told", "characteristics", "characteristic"),
    ("told", "tables", "table"),
    ("told", "leds", "light"),
    ("told", "documents", "document"),
    ("told", "lost_figures", "lost figure"),
)


def alarms(both: FamilyPair) -> Iterator[Change]:
    def interface(pair: Pair[Alarm]) -> str:
        return _interface_of(both.new if pair.new else both.old, pair.item)

    yield from things(both, "alarm", recognised(both, both.old.alarms, both.new.alarms), "alarms", "alarm", interface)


def _interface_of(device: Device, alarm: Alarm) -> str:
    """Return the only interface whose frames or registers show an error, or "" if there are several."""
    found = {item.interface for item in device.registers if item.name == alarm.register}
    for interface, layout in device.layouts():
        if alarm.group and any(field.group == alarm.group for field in layout.fields):
            found.add(interface.name)
    return found.pop() if len(found) == 1 else ""


def wiring(both: FamilyPair) -> Iterator[Change]:
    """Compare supply, connectors and inputs."""
    old, new = both.old, both.new
    yield from supply(both, Thing("", ""), old.supply, new.supply)
    yield from things(
        both,
        "connector",
        recognised(both, old.connectors, new.connectors),
        "connectors",
        lambda pair: pair.item.kind,
        lambda pair: pair.item.interfaces[0] if len(pair.item.interfaces) == 1 else "",
        _contacts,
    )
    yield from things(both, "input", recognised(both, old.inputs, new.inputs), "inputs", "input")


def _contacts(both: FamilyPair, thing: Thing, old: Connector, new: Connector) -> Iterator[Change]:
    before, after = ({item.contact: item for item in each.contacts} for each in (old, new))
    for contact in dict.fromkeys((*before, *after)):
        place = thing.inside(contact, f"{thing.label}: contact {contact}")
        yield from _contact(both, place, before.get(contact), after.get(contact))


def _contact(both: FamilyPair, place: Thing, old: Contact | None, new: Contact | None) -> Iterator[Change]:
    if old is not None and new is not None:
        yield from members(both, place, old, new)
        return
    was, now = (item.signal if item is not None else None for item in (old, new))
    yield both.change("contact", place, f": signal {arrow(was, now)}", was, now)


def displayed(both: FamilyPair) -> Iterator[Change]:
    """Compare errata, examples, and facts that no code depends on."""
    for rule, section, word in _DISPLAYED:
        olds, news = ({_key(item): item for item in getattr(device, section)} for device in (both.old, both.new))
        for key in dict.fromkeys((*olds, *news)):
            old, new = olds.get(key), news.get(key)
            if old != new:
                how = " is new" if old is None else " is gone" if new is None else _changed(old, new)
                yield both.change(rule, Thing(f"{section}.{key}", f"{word} {key}"), how, old, new)
    for before, after in both_of(paired(both.old.field_groups, both.new.field_groups)):
        yield from members(both, Thing(f"field_groups.{after.name}", f"group {after.name}"), before, after)


def _changed(old: Any, new: Any) -> str:
    """Return the old and new value of a characteristic with a short text, or only that the item has changed."""
    before, after = (shown(getattr(item, "value", None)) for item in (old, new))
    return f": {before} → {after}" if before != after else " has changed"


def _key(item: Any) -> str:
    return str(getattr(item, "name", "") or getattr(item, "key", "") or getattr(item, "content", ""))
