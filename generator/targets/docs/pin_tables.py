"""Pins, wires and supply on the page of an order code."""

from __future__ import annotations

from collections.abc import Sequence

from ...model import (
    Connector,
    Contact,
    Device,
    Variant,
)
from ...model.record import dataclass
from ...say.markdown import anchor, cited, code, text
from ...say.words import sentence, volts

Row = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Wiring:
    """Table of contacts and signals.

    ``about`` lists the connectors and cables of each column, and ``notes`` the sentences that apply to all of them.
    ``errata`` are the paths of the connectors in the spec.
    """

    head: tuple[str, ...]
    rows: tuple[Row, ...]
    about: tuple[str, ...]
    notes: tuple[str, ...]
    errata: tuple[str, ...]


def wiring(device: Device) -> Wiring:
    """Return one table with the contacts of every connector and cable for each signal."""
    columns = _columns(device.connectors)
    signals = dict.fromkeys(_signal(item) for connector in device.connectors for item in connector.contacts)
    kinds = ["Wire" if column[0].kind == "cable" else "Pin" for column in columns]
    names = _short_names([column[0].title for column in columns])
    head = [kind if kinds.count(kind) == 1 else name for kind, name in zip(kinds, names, strict=True)]
    rows = [(*(_contacts(column, signal) for column in columns), text(signal)) for signal in signals]
    about = [f"{name}: {', or '.join(map(_named, column))}" for name, column in zip(head, columns, strict=True)]
    sentences = [item.note.rstrip(".").split(". ") for item in device.connectors]
    notes = [text(sentence(one)) for one in (sentences or [[]])[0] if one and all(one in other for other in sentences)]
    errata = tuple(f"connectors.{item.name}" for item in device.connectors)
    return Wiring((*head, "Signal"), tuple(rows), tuple(about), tuple(notes), errata)


def _columns(connectors: Sequence[Connector]) -> list[list[Connector]]:
    """Group connectors of one kind that have the same contacts for most signals of the one with fewer."""
    columns: list[list[Connector]] = []
    for item in connectors:
        for column in columns:
            mine, other = _by_signal(item), _by_signal(column[0])
            alike = sum(mine.get(signal) == contacts for signal, contacts in other.items())
            if item.kind == column[0].kind and 2 * alike > min(len(mine), len(other)):
                column.append(item)
                break
        else:
            columns.append([item])
    return columns


def _by_signal(connector: Connector) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for item in connector.contacts:
        found.setdefault(_signal(item), []).append(item.contact)
    return found


def _signal(contact: Contact) -> str:
    """Return the signal of a contact, with the order codes that have it unless these are all."""
    return f"{contact.signal} (only {contact.only})" if contact.only else contact.signal


def _contacts(column: Sequence[Connector], signal: str) -> str:
    """Return the contacts of a signal, marked with the name of their connector if they differ."""
    found = [_in_short(_by_signal(item).get(signal, [])) for item in column]
    names = _short_names([item.title for item in column])
    marked = [f"{contacts} ({name})" for contacts, name in zip(found, names, strict=True) if contacts]
    return text(found[0] if len(set(found)) == 1 else ", ".join(marked))


def _short_names(titles: Sequence[str]) -> list[str]:
    """Return the first words by which titles differ, such as M12 and M23, or 8 pins and 12 pins."""
    for pieces in zip(*(title.split(", ") for title in titles), strict=False):
        for count in range(1, max(len(piece.split()) for piece in pieces) + 1):
            names = [" ".join(piece.split()[:count]) for piece in pieces]
            if len(set(names)) == len(names) and not any(name.isdecimal() for name in names):
                return names
    return [f"connector {index}" for index, _ in enumerate(titles, 1)]


def _in_short(contacts: Sequence[str]) -> str:
    """Return contacts as a list, with three or more consecutive numbers as a range."""
    numbers = [int(item) for item in contacts if item.isdecimal()]
    if len(numbers) == len(contacts) > 2 and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return f"{numbers[0]} to {numbers[-1]}"
    return ", ".join(contacts)


def _named(item: Connector) -> str:
    return f"{anchor(f'connector-{item.name}')}{text(item.title)}"


def supply(device: Device, variants: Sequence[Variant]) -> list[str]:
    """Return the supply of each order code, or of all if it is the same, with its source."""
    found: dict[str, list[str]] = {}
    for item in variants:
        needed = device.supply_of(item)
        if needed is not None:
            said_ = f"{volts(needed.min_mv)} to {volts(needed.max_mv)} ({cited(needed.source)})"
            found.setdefault(said_, []).append(item.code)
    if len(found) == 1:
        return list(found)
    return [f"{value} with {', '.join(map(code, codes))}" for value, codes in found.items()]
