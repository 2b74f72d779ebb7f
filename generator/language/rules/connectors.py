"""Rules for the signals of connectors and cables, and for the numbers of contacts."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from ...model import Connector
from ..document import Path
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, join_words, quoted
from ..written import LocatedPart
from .parts import is_second_reading
from .references import NameResolver

#: Texts for a contact without a signal, such as ``not connected``, ``NC`` and ``-``.
_UNCONNECTED_SIGNAL = re.compile(
    r"(?:not (?:to be )?(?:connected|used)|unused|reserved|n\.? ?c\.?|do not connect|free|[-–—])", re.IGNORECASE
)
#: Signals that several contacts may have, such as ``5 V``, ``GND`` and ``Shield``: supplies, grounds and shields.
_SHAREABLE_SIGNAL = re.compile(
    r"(?<![A-Za-z])"
    r"(?:\d*(?:[.,]\d+)? ?V(?:dc|b|cc|dd|in|s)?|ground|gnd|earth|pe|shield|screen|braid|case|housing|supply)"
    r"(?![A-Za-z])",
    re.IGNORECASE,
)
_IN_PARENTHESES = re.compile(r"\(([^()]*)\)")
_OPPOSITE_SIGN = {"+": "-", "-": "+"}
#: Index in the list of contacts, and number of each contact that has a number.
NumberedContacts = Sequence[tuple[int, int]]


@dataclass(frozen=True)
class _Contact:
    """A contact with a signal."""

    path: Path
    contact_name: str
    signal: str
    order_codes: str

    @property
    def main_signal_names(self) -> set[str]:
        """Names of the signal, without names in parentheses."""
        return set(_names_in_signal(_IN_PARENTHESES.sub("", self.signal)))

    @property
    def all_signal_names(self) -> list[str]:
        """All names of the signal: ``A``, ``REQ+`` and ``SD+`` of ``A (REQ+ / SD+)``."""
        names = list(_names_in_signal(_IN_PARENTHESES.sub("", self.signal)))
        for text_in_parentheses in _IN_PARENTHESES.findall(self.signal):
            names += _names_in_signal(text_in_parentheses)
        return names

    @property
    def may_be_on_several_contacts(self) -> bool:
        """True for a supply, a ground or a shield."""
        return _SHAREABLE_SIGNAL.search(self.signal) is not None


@dataclass(frozen=True)
class _Connector:
    """A connector or cable with its contacts that have a signal."""

    located_part: LocatedPart[Connector]
    contacts: tuple[_Contact, ...]

    @property
    def part(self) -> Connector:
        return self.located_part.part

    @property
    def quoted_name(self) -> str:
        return quoted(self.part.name)

    def note_mentions(self, signal: str) -> bool:
        """Return True if the note names a signal, which explains that it is missing."""
        note = _normalise_signal(self.part.note)
        signal_pattern = re.escape(_normalise_signal(signal))
        # Neither ``clock`` nor ``a+`` counts as the signal A.
        return re.search(rf"(?<![\w/]){signal_pattern}(?![\w+-])", note) is not None

    def shares_interface(self, other_connector: _Connector) -> bool:
        """Return True if two connectors or cables have an interface in common.

        A connector without interfaces is for all of them.
        """
        if not self.part.interfaces or not other_connector.part.interfaces:
            return True
        return not {*self.part.interfaces}.isdisjoint(other_connector.part.interfaces)


def check_repeated_signals(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no two contacts of a connector have the same signal for the same order codes.

    Supplies, grounds and shields may be on several contacts.
    """
    for connector in _collect_connectors(spec):
        earlier_contacts: list[_Contact] = []
        for contact in connector.contacts:
            if contact.may_be_on_several_contacts:
                continue
            contacts_with_signal = [earlier for earlier in earlier_contacts if _share_signal(contact, earlier)]
            earlier_contacts.append(contact)
            if contacts_with_signal:
                earlier_name = quoted(contacts_with_signal[0].contact_name)
                message = (
                    f"contact {earlier_name} has this signal too; correct one of the two, or"
                    " give each its order codes with 'only'"
                )
                report.add("signal-twice", (*contact.path, "signal"), message)


def _share_signal(contact: _Contact, earlier_contact: _Contact) -> bool:
    """Return True if two contacts have a signal in common, as a whole or by one of its names outside parentheses.

    The result is False if each contact is restricted to different order codes (``only`` in a spec).
    """
    if contact.order_codes and earlier_contact.order_codes and contact.order_codes != earlier_contact.order_codes:
        return False
    compared_names = set(map(_normalise_signal, (*contact.main_signal_names, contact.signal)))
    earlier_compared_names = set(map(_normalise_signal, (*earlier_contact.main_signal_names, earlier_contact.signal)))
    return not compared_names.isdisjoint(earlier_compared_names)


def check_incomplete_pair(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that both lines of a differential pair are on a connector: ``MA +`` and ``MA -``, ``A`` and ``/A``.

    A note of the connector that names the missing line explains it.
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    for connector in _collect_connectors(spec):
        known_names: set[str] = set()
        for contact in connector.contacts:
            known_names.update(name.casefold() for name in contact.all_signal_names)
        has_inverted = any(name.startswith("/") for name in known_names)
        for contact in connector.contacts:
            for name in contact.all_signal_names:
                partner_name = partner_of(name, has_inverted)
                is_missing = bool(partner_name) and partner_name.casefold() not in known_names
                if is_missing and not connector.note_mentions(partner_name):
                    message = (
                        f"{quoted(name)} is here, but {quoted(partner_name)} is not on {connector.quoted_name};"
                        f" add it, or say in the 'note' of {connector.quoted_name} why {partner_name} is missing"
                    )
                    report.add("incomplete-pair", (*contact.path, "signal"), message)


def check_connector_and_cable(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a connector and a cable for the same interface have the same signals.

    A note that names the missing signals explains a difference.
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    connectors_and_cables = _collect_connectors(spec)
    connectors = [candidate for candidate in connectors_and_cables if candidate.part.kind == "connector"]
    cables = [candidate for candidate in connectors_and_cables if candidate.part.kind == "cable"]
    for cable in cables:
        for connector in connectors:
            if cable.shares_interface(connector):
                _report_missing_signals(cable, connector, report)
                _report_missing_signals(connector, cable, report)


def _report_missing_signals(incomplete: _Connector, complete: _Connector, report: DocumentReport) -> None:
    """Report the signals of ``complete``, a connector or cable, that ``incomplete`` neither has nor names in its note.

    A signal with several names, such as ``CLOCK IN + / MA +``, is present if one of its names is.
    """
    known_names: set[str] = set()
    for contact in incomplete.contacts:
        known_names |= _normalised_names(contact)
    missing_signals: list[str] = []
    for contact in complete.contacts:
        is_missing = known_names.isdisjoint(_normalised_names(contact))
        if is_missing and not incomplete.note_mentions(contact.signal):
            missing_signals.append(contact.signal)
    if missing_signals:
        missing_text = join_words(map(quoted, dict.fromkeys(missing_signals)))
        problem = f"{incomplete.quoted_name} lacks {missing_text}, which {complete.quoted_name} has"
        message = (
            f"{problem}; correct one of the two, or name the missing signal in the 'note' of {incomplete.quoted_name}"
        )
        report.add("missing-signal", (*incomplete.located_part.path, "contacts"), message, at_key=True)


def _collect_connectors(spec: WrittenSpec) -> list[_Connector]:
    """Return the connectors and cables, without the contacts that have no signal."""
    connectors = []
    for located_connector in spec.connectors:
        contacts: list[_Contact] = []
        for index, contact in enumerate(located_connector.part.contacts):
            if not _UNCONNECTED_SIGNAL.fullmatch(contact.signal.strip()):
                path = (*located_connector.path, "contacts", index)
                contacts.append(_Contact(path, contact.contact, contact.signal, order_codes=contact.only))
        connectors.append(_Connector(located_connector, tuple(contacts)))
    return connectors


def _normalised_names(contact: _Contact) -> set[str]:
    """Return the signal of a contact, and each of its names, in the form in which signals are compared."""
    return set(map(_normalise_signal, (contact.signal, *contact.all_signal_names)))


def _normalise_signal(signal: str) -> str:
    """Return a signal in the form for comparison: lower case, with plain minus signs and no spaces before signs."""
    return _without_spaces_before_signs(signal).casefold()


def _without_spaces_before_signs(signal: str) -> str:
    """Return a signal with plain minus signs, and without spaces before signs: ``MA-`` for ``MA −``."""
    signal_in_ascii = " ".join(signal.replace("−", "-").split())
    return re.sub(r"\s+(?=[+-])", "", signal_in_ascii)


def _names_in_signal(signal_text: str) -> Iterator[str]:
    """Yield the names that a text lists, such as ``MA+`` and ``Clock IN+``."""
    for name in re.split(r"\s/\s", _without_spaces_before_signs(signal_text)):
        if name.strip():
            yield name.strip()


def partner_of(signal_name: str, has_inverted: bool) -> str:
    """Return the name of the other line of a differential pair: ``MA-`` for ``MA+``, and ``A`` for ``/A``.

    If a connector has an inverted line (``has_inverted``), such as ``/A``, any single letter is the plain line of a
    pair. The result is empty for a line that does not belong to a pair.
    """
    sign = signal_name[-1:]
    if len(signal_name) > 1 and sign in _OPPOSITE_SIGN:
        return signal_name[:-1] + _OPPOSITE_SIGN[sign]
    if signal_name.startswith("/"):
        return signal_name[1:]
    is_single_letter = re.fullmatch("[A-Za-z]", signal_name) is not None
    return f"/{signal_name}" if has_inverted and is_single_letter else ""


def signal_names(signal: str) -> list[str]:
    """Return the names of a signal in lower case: ``a``, ``req+`` and ``sd+`` for ``A (REQ+ / SD+)``.

    The list is empty for a contact that is not connected.
    """
    if _UNCONNECTED_SIGNAL.fullmatch(signal.strip()):
        return []
    # Only the names are needed, so the contact has no place, name or order codes.
    contact = _Contact(path=(), contact_name="", signal=signal, order_codes="")
    return [name.casefold() for name in contact.all_signal_names]


def check_connector_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the interfaces that a connector is wired for exist."""
    resolver = NameResolver(spec, report)
    for connector in spec.connectors:
        resolver.check_each_name((*connector.path, "interfaces"), "interface", connector.part.interfaces)


def check_contact_numbers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that contacts are numbered consecutively from 1, unless a note explains a gap.

    A cable whose wires all have numbers is also reported, because it is probably a connector, unless its note says that
    the wires are numbered.
    """
    if is_second_reading(report.document) or report.document.family:  # The note belongs to the newest edition.
        return
    for located_connector in spec.connectors:
        connector = located_connector.part
        contact_names = [contact.contact for contact in connector.contacts]
        # With their index, because contacts such as the case have names.
        numbered_contacts = [(index, int(name)) for index, name in enumerate(contact_names) if name.isdecimal()]
        if not numbered_contacts:
            continue
        are_all_numbered = len(numbered_contacts) == len(contact_names)
        is_explained = "number" in connector.note
        if connector.kind == "cable" and are_all_numbered and not is_explained:
            message = (
                f"all wires of {quoted(connector.name)} have numbers, as the contacts of a connector; write 'kind:"
                " connector', or say in a 'note' that the wires are numbered"
            )
            report.add("contact-numbers", (*located_connector.path, "kind"), message)
        _check_order_of_contacts(located_connector, numbered_contacts, report)


def _check_order_of_contacts(
    connector: LocatedPart[Connector], numbered_contacts: NumberedContacts, report: DocumentReport
) -> None:
    """Report the first contact that has a leading zero, or a number that does not follow the number before it.

    A number may repeat, because a contact can have several signals, for different order codes. A note that contains the
    expected number explains a gap.
    """
    imaginary_contact = (-1, 0)  # With the number 0, so that the first real contact must have the number 1.
    for (_, earlier_number), (index, number) in pairwise([imaginary_contact, *numbered_contacts]):
        contact_text = connector.part.contacts[index].contact
        expected_number = earlier_number + 1
        is_explained = re.search(rf"\b{expected_number}\b", connector.part.note) is not None
        is_repeated = number == earlier_number > 0
        is_accepted = number == expected_number or is_repeated or is_explained
        has_leading_zero = contact_text != str(number)
        if has_leading_zero or not is_accepted:
            message = (
                f"contact {quoted(contact_text)} is where {quoted(str(expected_number))}"
                " should be; list all contacts in order, including unconnected contacts, or say in a 'note' of"
                f" {quoted(connector.part.name)} that there is no contact {expected_number}"
            )
            report.add("contact-numbers", (*connector.path, "contacts", index, "contact"), message)
            return
