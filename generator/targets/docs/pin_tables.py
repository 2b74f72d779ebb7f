"""Pins, wires and supply on the page of an order code."""

from __future__ import annotations

from collections.abc import Sequence

from ...model import (
    Connector,
    Contact,
    Device,
    Variant,
)
from ...model.only import fits
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


def wiring(device: Device, order_codes: Sequence[str]) -> Wiring:
    """Return one table with the contacts of every connector and cable for each signal."""
    columns = _columns(device.connectors, order_codes)
    signals = dict.fromkeys(
        _signal(contact, order_codes) for connector in device.connectors for contact in connector.contacts
    )
    kinds = ["Wire" if column[0].kind == "cable" else "Pin" for column in columns]
    names = _short_names([column[0].title for column in columns])
    head = [kind if kinds.count(kind) == 1 else name for kind, name in zip(kinds, names, strict=True)]
    rows = [(*(_contacts(column, signal, order_codes) for column in columns), signal) for signal in signals]
    about = [f"{name}: {', or '.join(map(_named, column))}" for name, column in zip(head, columns, strict=True)]
    sentences = [connector.note.rstrip(".").split(". ") for connector in device.connectors]
    notes = [
        text(sentence(sentence_of_note))
        for sentence_of_note in (sentences or [[]])[0]
        if sentence_of_note and all(sentence_of_note in connector_sentences for connector_sentences in sentences)
    ]
    errata = tuple(f"connectors.{connector.name}" for connector in device.connectors)
    return Wiring((*head, "Signal"), tuple(rows), tuple(about), tuple(notes), errata)


def _columns(connectors: Sequence[Connector], order_codes: Sequence[str]) -> list[list[Connector]]:
    """Group connectors of one kind that have the same contacts for most signals of the one with fewer."""
    columns: list[list[Connector]] = []
    for connector in connectors:
        for column in columns:
            own_contacts, column_contacts = _by_signal(connector, order_codes), _by_signal(column[0], order_codes)
            matches = sum(own_contacts.get(signal) == contacts for signal, contacts in column_contacts.items())
            if connector.kind == column[0].kind and 2 * matches > min(len(own_contacts), len(column_contacts)):
                column.append(connector)
                break
        else:
            columns.append([connector])
    return columns


def _by_signal(connector: Connector, order_codes: Sequence[str]) -> dict[str, list[str]]:
    contacts_by_signal: dict[str, list[str]] = {}
    for contact in connector.contacts:
        contacts_by_signal.setdefault(_signal(contact, order_codes), []).append(contact.contact)
    return contacts_by_signal


def _signal(contact: Contact, order_codes: Sequence[str]) -> str:
    """Return the signal of a contact in Markdown, and which of these order codes have it unless all do."""
    if not contact.only:
        return text(contact.signal)
    patterns = [
        pattern for pattern in contact.only.split(", ") if any(fits(pattern, order_code) for order_code in order_codes)
    ]
    return f"{text(contact.signal)} <small>(only {text(', '.join(patterns))})</small>"


def _contacts(column: Sequence[Connector], signal: str, order_codes: Sequence[str]) -> str:
    """Return the contacts of a signal, marked with the name of their connector if they differ."""
    signal_contacts = [_in_short(_by_signal(connector, order_codes).get(signal, [])) for connector in column]
    names = _short_names([connector.title for connector in column])
    marked = [f"{contacts} ({name})" for contacts, name in zip(signal_contacts, names, strict=True) if contacts]
    return text(signal_contacts[0] if len(set(signal_contacts)) == 1 else ", ".join(marked))


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
    numbers = [int(contact) for contact in contacts if contact.isdecimal()]
    if len(numbers) == len(contacts) > 2 and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return f"{numbers[0]} to {numbers[-1]}"
    return ", ".join(contacts)


def _named(connector: Connector) -> str:
    return f"{anchor(f'connector-{connector.name}')}{text(connector.title)}"


def supply(device: Device, variants: Sequence[Variant]) -> list[str]:
    """Return the supply of each order code, or of all if it is the same, with its source."""
    codes_by_supply: dict[str, list[str]] = {}
    for variant in variants:
        variant_supply = device.supply_of(variant)
        if variant_supply is not None:
            supply_text = (
                f"{volts(variant_supply.min_mv)} to {volts(variant_supply.max_mv)} ({cited(variant_supply.source)})"
            )
            codes_by_supply.setdefault(supply_text, []).append(variant.code)
    if len(codes_by_supply) == 1:
        return list(codes_by_supply)
    return [f"{value} with {', '.join(map(code, codes))}" for value, codes in codes_by_supply.items()]
