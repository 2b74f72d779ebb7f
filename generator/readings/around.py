"""Facts other than data: contacts, alarms, inputs, the manual's history."""

from __future__ import annotations

from collections.abc import Iterator

from ..language.problems import Path
from ..model import Alarm, Connector, Input
from .fact import Fact, Key, Sort
from .printed import plain, printed_names
from .procedures import programs
from .reading import Reading, at, over


def contacts(reading: Reading) -> Iterator[Fact]:
    """Yield every contact, by interface, number of its connector or cable, and pin or colour."""
    counts: dict[tuple[str, str], int] = {}
    for item in reading.device.connectors:
        for interface in item.interfaces or ("",):
            counts[interface, item.kind] = counts.get((interface, item.kind), 0) + 1
            yield from _contacts(item, interface, counts[interface, item.kind])


def _contacts(connector: Connector, interface: str, number: int) -> Iterator[Fact]:
    owner: Path = ("connectors", connector.name)
    key: Key = ("connector", interface, connector.kind, number)
    what = f"{connector.kind} {number}" + (f" for {over(interface)}" if interface else "")
    yield Fact(Sort.PIN, key, "present", what, owner, name=connector.name)
    for item in connector.contacts:
        place, pin = (*owner, "contacts", item.contact), (*key, plain(item.contact))
        named = f"contact {item.contact} of {what}"
        yield Fact(Sort.PIN, pin, signal(item.signal), named, (*place, "signal"), key)
        if item.only:
            yield Fact(Sort.PIN, (*pin, "only"), item.only, f"order codes with {named}", (*place, "only"), pin)


def signal(text: str) -> str:
    """Return a signal as used in comparisons: with its sign, without blanks."""
    return "".join(text.casefold().split())


def alarms(reading: Reading) -> Iterator[Fact]:
    """Yield every alarm, by the place of its bit."""
    for item in reading.device.alarms:
        owner: Path = ("alarms", item.name)
        for where in _bits_of(reading, item):
            yield from _of_alarm(reading, item, where, owner)


def _bits_of(reading: Reading, alarm: Alarm) -> Iterator[str]:
    """Yield the places of the bits of an alarm, in words without names."""
    register = reading.register(alarm.register) if alarm.register else None
    if register is not None:
        yield reading.bits_at(f"{alarm.register}.{alarm.field}") if alarm.field else at(register)
    for interface in reading.device.interfaces:
        for layout in interface.layouts:
            found = (item for item in layout.fields if item.group == alarm.group and alarm.group)
            for item in found:
                if item.name == alarm.field:
                    places = reading.bits_in_frames(interface.name, layout, item)
                    yield from (f"{place} over {interface.short}" for place in places)


def _of_alarm(reading: Reading, alarm: Alarm, where: str, owner: Path) -> Iterator[Fact]:
    key: Key = ("alarm", where)
    yield Fact(Sort.ALARM, key, "present", f"alarm at {where}", owner, name=alarm.name)
    told = {
        "below_mv": f"{alarm.below_mv} mV" if alarm.below_mv is not None else "",
        "latch": str(alarm.latch).lower() if alarm.latch is not None else "",
        "implemented": "" if alarm.implemented else "false",
        "cleared_by": programs(reading, alarm.cleared_by),
    }
    for name, value in told.items():
        if value:
            what = f"'{name}' of the alarm '{alarm.name}'"
            yield Fact(Sort.ALARM, (*key, name), value, what, (*owner, name), key)
    for language, text in printed_names(reading, alarm.printed_name, alarm.names):
        what = f"printed name of the alarm at {where}"
        place = reading.name_place(owner, language)
        yield Fact(Sort.PRINTED, (*key, "name", language), text, what, place, key, mild=True)


def inputs(reading: Reading) -> Iterator[Fact]:
    """Yield every hardware input, in the order of the manual."""
    for number, item in enumerate(reading.device.inputs, 1):
        yield from _of_input(reading, item, number)


def _of_input(reading: Reading, item: Input, number: int) -> Iterator[Fact]:
    key: Key = ("input", number)
    owner: Path = ("inputs", item.name)
    yield Fact(Sort.INPUT, key, "present", f"input {number}", owner, name=item.name)
    if item.pulse_at_least_us is not None:
        place, value = (*owner, "pulse_at_least_us"), f"{item.pulse_at_least_us} µs"
        yield Fact(Sort.TIME, (*key, "pulse"), value, f"pulse of input {number}", place, key)
    for name, path in (("inverts", item.inverts), ("needs", item.needs)):
        if path:
            what = f"'{name}' of input {number}"
            yield Fact(Sort.INPUT, (*key, name), reading.bits_at(path), what, (*owner, name), key)
    for language, text in printed_names(reading, item.printed_name, item.names):
        place = reading.name_place(owner, language)
        yield Fact(Sort.PRINTED, (*key, "name", language), text, f"name of input {number}", place, key, mild=True)


def history(reading: Reading) -> Iterator[Fact]:
    """Yield the edition that was read, and the manual's revisions."""
    manual = reading.device.manual
    editions: list[tuple[str, str, str, Path]] = [(manual.language, manual.revision, manual.date, ("manual",))]
    editions += [
        (item.language, item.revision, item.date, ("manual", "editions", item.revision)) for item in manual.editions
    ]
    for language, revision, date, owner in editions:
        key = ("edition", language)
        yield Fact(Sort.HISTORY, key, revision, f"revision of the edition '{language}'", (*owner, "revision"))
        if date:
            what = f"date of the edition '{language}'"
            yield Fact(Sort.HISTORY, (*key, "date"), date, what, (*owner, "date"), key)
    for item in manual.history:
        here, key = ("manual", "history", item.revision), ("revision", item.revision)
        yield Fact(Sort.HISTORY, key, "listed", f"revision {item.revision}", here)
        for name, value in {"date": item.date, "hardware": item.hardware, "software": item.software}.items():
            if value:
                what = f"{name} of revision {item.revision}"
                yield Fact(Sort.HISTORY, (*key, name), value, what, (*here, name), key)
