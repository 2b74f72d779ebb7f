"""Pins, wires and supply on the page of an order code."""

from __future__ import annotations

from collections.abc import Sequence

from ...model import (
    Connector,
    Contact,
    Device,
    Supply,
    Variant,
)
from ...model.order_codes import fits
from ...model.record import dataclass
from ...say.markdown import anchor, cited, code, text
from ...say.text import sentence, volts

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
    heads = _heads(columns)
    contacts = [contact for connector in device.connectors for contact in connector.contacts]
    signals = dict.fromkeys(_signal_cell(contact, order_codes) for contact in contacts)
    about = []
    for head, column in zip(heads, columns, strict=True):
        about.append(f"{head}: {', or '.join(map(_anchored_title, column))}")
    return Wiring(
        head=(*heads, "Signal"),
        rows=tuple(_row(columns, signal, order_codes) for signal in signals),
        about=tuple(about),
        notes=tuple(_common_sentences(device.connectors)),
        errata=tuple(f"connectors.{connector.name}" for connector in device.connectors),
    )


def _heads(columns: Sequence[Sequence[Connector]]) -> list[str]:
    """Return Pin or Wire for each column, or the short name of its connector if there are several of this kind."""
    words = [_word_for_contact(column[0]) for column in columns]
    heads = _short_names([column[0].title for column in columns])
    for index, word in enumerate(words):
        if words.count(word) == 1:
            heads[index] = word
    return heads


def _word_for_contact(connector: Connector) -> str:
    return "Wire" if connector.kind == "cable" else "Pin"


def _row(columns: Sequence[Sequence[Connector]], signal: str, order_codes: Sequence[str]) -> Row:
    return (*(_contacts_cell(column, signal, order_codes) for column in columns), signal)


def _common_sentences(connectors: Sequence[Connector]) -> list[str]:
    """Return the sentences that the notes of all connectors have."""
    notes = [connector.note.rstrip(".").split(". ") for connector in connectors]
    first_note = notes[0] if notes else []
    common = set(first_note).intersection(*notes)
    return [text(sentence(note_sentence)) for note_sentence in first_note if note_sentence and note_sentence in common]


def _columns(connectors: Sequence[Connector], order_codes: Sequence[str]) -> list[list[Connector]]:
    """Group connectors of one kind that have the same contacts for most signals of the one with fewer."""
    columns: list[list[Connector]] = []
    for connector in connectors:
        for column in columns:
            if _have_similar_contacts(connector, column[0], order_codes):
                column.append(connector)
                break
        else:
            columns.append([connector])
    return columns


def _have_similar_contacts(connector: Connector, other: Connector, order_codes: Sequence[str]) -> bool:
    """Return whether connectors of one kind have the same contacts for most signals of the one with fewer."""
    contacts, other_contacts = _contacts_by_signal(connector, order_codes), _contacts_by_signal(other, order_codes)
    matches = sum(contacts.get(signal) == other_contacts[signal] for signal in other_contacts)
    return connector.kind == other.kind and 2 * matches > min(len(contacts), len(other_contacts))


def _contacts_by_signal(connector: Connector, order_codes: Sequence[str]) -> dict[str, list[str]]:
    contacts_by_signal: dict[str, list[str]] = {}
    for contact in connector.contacts:
        contacts_by_signal.setdefault(_signal_cell(contact, order_codes), []).append(contact.contact)
    return contacts_by_signal


def _signal_cell(contact: Contact, order_codes: Sequence[str]) -> str:
    """Return the signal of a contact in Markdown, and which of these order codes have it unless all do."""
    if not contact.only:
        return text(contact.signal)
    patterns = []
    for pattern in contact.only.split(", "):
        if any(fits(pattern, order_code) for order_code in order_codes):
            patterns.append(pattern)
    return f"{text(contact.signal)} <small>(only {text(', '.join(patterns))})</small>"


def _contacts_cell(column: Sequence[Connector], signal: str, order_codes: Sequence[str]) -> str:
    """Return the contacts of a signal, marked with the name of their connector if they differ."""
    contacts_of_connectors = []
    for connector in column:
        contacts = _contacts_by_signal(connector, order_codes).get(signal, [])
        contacts_of_connectors.append(_contact_list(contacts))
    names = _short_names([connector.title for connector in column])
    marked = [f"{contacts} ({name})" for contacts, name in zip(contacts_of_connectors, names, strict=True) if contacts]
    are_alike = len(set(contacts_of_connectors)) == 1
    return text(contacts_of_connectors[0] if are_alike else ", ".join(marked))


def _short_names(titles: Sequence[str]) -> list[str]:
    """Return the first words by which titles differ, such as M12 and M23, or 8 pins and 12 pins."""
    titles_in_pieces = [title.split(", ") for title in titles]
    for pieces in zip(*titles_in_pieces, strict=False):
        words_of_pieces = [piece.split() for piece in pieces]
        for count in range(1, max(map(len, words_of_pieces)) + 1):
            names = [" ".join(words[:count]) for words in words_of_pieces]
            if len(set(names)) == len(names) and not any(name.isdecimal() for name in names):
                return names
    return [f"connector {index}" for index, _ in enumerate(titles, 1)]


def _contact_list(contacts: Sequence[str]) -> str:
    """Return contacts as a list, with three or more consecutive numbers as a range."""
    numbers = [int(contact) for contact in contacts if contact.isdecimal()]
    if len(numbers) == len(contacts) > 2 and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return f"{numbers[0]} to {numbers[-1]}"
    return ", ".join(contacts)


def _anchored_title(connector: Connector) -> str:
    return f"{anchor(f'connector-{connector.name}')}{text(connector.title)}"


def supply_lines(device: Device, variants: Sequence[Variant]) -> list[str]:
    """Return the supply of each order code, or of all if it is the same, with its source."""
    codes_by_supply: dict[str, list[str]] = {}
    for variant in variants:
        variant_supply = device.supply_of(variant)
        if variant_supply is not None:
            codes_by_supply.setdefault(_supply_text(variant_supply), []).append(variant.code)
    if len(codes_by_supply) == 1:
        return list(codes_by_supply)
    return [f"{supply} with {', '.join(map(code, codes))}" for supply, codes in codes_by_supply.items()]


def _supply_text(supply: Supply) -> str:
    return f"{volts(supply.min_mv)} to {volts(supply.max_mv)} ({cited(supply.source)})"
