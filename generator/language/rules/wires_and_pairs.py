"""Rules for the kinds of connectors, lines of interfaces, differential pairs, and the wires of cables."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ...model import Connector
from ..document import Path
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, quoted
from ..written import LocatedPart
from .connectors import partner_of, signal_names
from .parts import is_explained_at, is_second_reading
from .walk import KEYS_OF_EXPLANATIONS, texts_of

_COLOURS = "white|black|brown|green|yellow|grey|gray|pink|blue|red|violet|orange|purple"
#: A wire with one color or two: ``White``, ``Brown_Green``.
_WIRE_COLOURS = re.compile(rf"(?:{_COLOURS})(?:[-_/ ](?:{_COLOURS}))?", re.IGNORECASE)
_SHIELD_WORDS = re.compile(r"shield|screen|braid|drain", re.IGNORECASE)
#: Lines that only one interface has, by the names that its standard gives them.
_LINES_OF_INTERFACES = {"biss": frozenset(("ma+", "ma-", "slo+", "slo-")), "rs485": frozenset(("rs-485",))}
#: A connector and a cable for the same interface.
_Connection = tuple[LocatedPart[Connector], LocatedPart[Connector]]
#: Connectors and cables that are compared, and all with the same titles.
_MOST_CONNECTORS, _MOST_CONNECTIONS = 100, 10
#: The statement of a note that explains the order of a pair.
_PAIR_ORDER_NOTE = re.compile(
    r"(?P<lower>[\w/ ]+?(?: ?[+-])?) is on a lower(?:-numbered)? contact than (?P<higher>[\w/ ]+(?: ?[+-])?)"
)


class _Pair(NamedTuple):
    """The two lines of a differential pair on a connector, and the indexes of their contacts."""

    plain_line: str
    inverted_line: str
    plain_index: int
    inverted_index: int

    @property
    def is_plain_first(self) -> bool:
        return self.plain_index < self.inverted_index

    @property
    def is_apart(self) -> bool:
        return abs(self.plain_index - self.inverted_index) > 1

    @property
    def first_line(self) -> str:
        """The line on the contact that comes first in the list of contacts."""
        return self.plain_line if self.is_plain_first else self.inverted_line

    @property
    def second_line(self) -> str:
        return self.inverted_line if self.is_plain_first else self.plain_line


def check_kinds_of_contacts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that only wires of a cable have colors as names, and that a contact named as a shield carries no signal."""
    for connector in spec.connectors:
        for index, contact in enumerate(connector.part.contacts):
            name = contact.contact
            if connector.part.kind == "connector" and _WIRE_COLOURS.fullmatch(name):
                problem = f"{quoted(name)} is the color of a wire, but the kind is 'connector'"
                report.add("contact-kind", (*connector.path, "kind"), f"{problem}; write 'kind: cable'")
                break
            if _SHIELD_WORDS.fullmatch(name) and not _SHIELD_WORDS.search(contact.signal):
                message = f"the contact is a shield, but its signal is {quoted(contact.signal)}; correct one of the two"
                report.add("contact-kind", (*connector.path, "contacts", index, "signal"), message)


def check_numbered_cables(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a cable with a shield or case has wires without numbers as names, unless its note mentions numbers.

    Numbers are the names of the contacts of a connector. Another rule checks cables without a shield or case.
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    for cable in spec.connectors:
        if cable.part.kind != "cable":
            continue
        contact_names = [contact.contact for contact in cable.part.contacts]
        wire_names = [name for name in contact_names if not _is_shield_or_case(name)]
        is_numbered = bool(wire_names) and all(name.isdecimal() for name in wire_names)
        has_shield_or_case = len(wire_names) < len(contact_names)
        is_explained = "number" in cable.part.note
        if is_numbered and has_shield_or_case and not is_explained:
            message = "the wires have numbers, as the contacts of a connector; write 'kind: connector'"
            report.add("contact-kind", (*cable.path, "kind"), message)


def _is_shield_or_case(contact_name: str) -> bool:
    is_shield = _SHIELD_WORDS.fullmatch(contact_name) is not None
    return is_shield or contact_name.casefold() in ("case", "housing", "shell")


def check_interfaces_of_lines(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a connector with a line of only one interface, such as ``MA +`` of BiSS, lists this interface."""
    for connector in spec.connectors:
        lines_on_connector: set[str] = set()
        for contact in connector.part.contacts:
            lines_on_connector.update(signal_names(contact.signal))
        for interface, lines_of_interface in _LINES_OF_INTERFACES.items():
            has_interface = getattr(spec.interfaces, interface) is not None
            # A connector that lists no interfaces is for all of them.
            is_missing = bool(connector.part.interfaces) and interface not in connector.part.interfaces
            common_lines = lines_on_connector & lines_of_interface
            if has_interface and is_missing and common_lines:
                message = f"{quoted(min(common_lines))} is a line of {interface}; add it, or correct the signals"
                report.add("contact-interface", (*connector.path, "interfaces"), message)


def check_wires_of_contacts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the contacts of a connector and the wires of its cable are assigned consistently for all interfaces.

    A contact and a wire with the same signal are one line. A connector and a cable with the same titles can be listed
    once for each interface. There, the same contact and wire must have a common signal, too.
    """
    # A connector and a cable with the same titles occur once for each interface.
    for connections in _connections_by_titles(spec).values():
        for connector, cable in connections[:_MOST_CONNECTIONS]:
            wire_by_contact = _wires_by_contact(connector.part, cable.part)
            for other_connector, other_cable in connections[:_MOST_CONNECTIONS]:
                if other_connector is not connector:
                    _compare_signals(wire_by_contact, other_connector, other_cable, report)


def _connections_by_titles(spec: WrittenSpec) -> dict[tuple[str, str], list[_Connection]]:
    """Return the pairs of a connector and a cable with an interface in common, by the titles of the two."""
    connections_by_titles: dict[tuple[str, str], list[_Connection]] = {}
    connectors_and_cables = spec.connectors[:_MOST_CONNECTORS]
    connectors = [candidate for candidate in connectors_and_cables if candidate.part.kind == "connector"]
    cables = [candidate for candidate in connectors_and_cables if candidate.part.kind == "cable"]
    for connector in connectors:
        for cable in cables:
            has_common_interface = not set(connector.part.interfaces).isdisjoint(cable.part.interfaces)
            if has_common_interface:
                titles = connector.part.title, cable.part.title
                connections_by_titles.setdefault(titles, []).append((connector, cable))
    return connections_by_titles


def _wires_by_contact(connector: Connector, cable: Connector) -> dict[str, str]:
    """Return the wire for each contact with the same signal: ``{"2": "Pink"}``.

    Only signals that occur exactly once in the connector and once in the cable are used.
    """
    contact_count_by_signal = Counter(_plain_signal(contact.signal) for contact in connector.contacts)
    wire_count_by_signal = Counter(_plain_signal(wire.signal) for wire in cable.contacts)
    wire_by_signal = {_plain_signal(wire.signal): wire.contact for wire in cable.contacts}
    wire_by_contact: dict[str, str] = {}
    for contact in connector.contacts:
        signal = _plain_signal(contact.signal)
        is_unique = contact_count_by_signal[signal] == 1 and wire_count_by_signal[signal] == 1
        if is_unique:
            wire_by_contact[contact.contact] = wire_by_signal[signal]
    return wire_by_contact


def _plain_signal(signal: str) -> str:
    return re.sub(r"\s+", "", signal).casefold()


def _compare_signals(
    wire_by_contact: Mapping[str, str],
    connector: LocatedPart[Connector],
    cable: LocatedPart[Connector],
    report: DocumentReport,
) -> None:
    """Report each contact that has another signal than its wire, unless an erratum explains it.

    ``wire_by_contact`` is the assignment that follows from the connector and cable for another interface. Two exchanged
    wires are the cause of all problems of their contacts.
    """
    signal_by_wire = {wire.contact: wire.signal for wire in cable.part.contacts}
    wire_by_signal = {_plain_signal(signal): wire for wire, signal in signal_by_wire.items()}
    for index, contact in enumerate(connector.part.contacts):
        wire = wire_by_contact.get(contact.contact, "")
        signal_of_wire = signal_by_wire.get(wire)
        if signal_of_wire is None or _plain_signal(signal_of_wire) == _plain_signal(contact.signal):
            continue
        has_erratum_at_connector = is_explained_at(report.document, "connectors", connector.part.name, "contacts")
        has_erratum_at_cable = is_explained_at(report.document, "connectors", cable.part.name, "contacts")
        if has_erratum_at_connector or has_erratum_at_cable:
            return
        message = (
            f"contact {quoted(contact.contact)} and wire {quoted(wire)} carry the same signal on another"
            f" interface, but {quoted(contact.signal)} and {quoted(signal_of_wire)} here; correct one of the tables"
        )
        wire_with_signal_of_contact = wire_by_signal.get(_plain_signal(contact.signal), "")
        exchanged_wires = " and ".join(sorted((wire, wire_with_signal_of_contact)))
        path = (*connector.path, "contacts", index, "signal")
        report.add("contact-wire", path, message, cause=exchanged_wires)


def check_order_of_pairs(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the two lines of each differential pair are on adjacent contacts, in the same order for all pairs.

    The first pair decides the order. If all of three or more pairs are apart, or the only pair is, adjacency is not
    required. A note such as "MA - is on a lower-numbered contact than MA +" explains an unusual pair. The note must be
    true.
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    for connector in spec.connectors:
        index_by_line = _contact_index_by_line(connector.part)
        explained_pairs = _checked_pairs_of_note(connector, index_by_line, report)
        pairs = list(_differential_pairs(index_by_line))
        for pair in pairs:
            problem = _describe_unusual_order(pair, pairs)
            contact_indices = {pair.plain_index, pair.inverted_index}
            if problem and contact_indices not in explained_pairs:
                statement = f"{pair.first_line} is on a lower-numbered contact than {pair.second_line}"
                message = f"{problem}; correct it, or say in a 'note' that {statement}"
                path = (*connector.path, "contacts", min(contact_indices), "signal")
                report.add("pair-order", path, message)


def _describe_unusual_order(pair: _Pair, all_pairs: Sequence[_Pair]) -> str:
    """Return the problem of a pair whose lines are not adjacent, or not in the order of the first pair.

    ``all_pairs`` are all pairs of the connector. The result is empty if there is no problem.
    """
    usual_pair = all_pairs[0]
    are_all_apart = all(other_pair.is_apart for other_pair in all_pairs)
    # If both of two pairs are apart, that is unusual as well.
    is_apart_unusual = not are_all_apart or len(all_pairs) == 2
    lower_line, higher_line = quoted(pair.first_line), quoted(pair.second_line)
    if pair.is_apart and is_apart_unusual:
        return f"{lower_line} and {higher_line} are not next to each other"
    if pair.is_plain_first != usual_pair.is_plain_first:
        usual_order = f"{quoted(usual_pair.first_line)} before {quoted(usual_pair.second_line)}"
        return f"{lower_line} is before {higher_line}, but {usual_order}"
    return ""


def _contact_index_by_line(connector: Connector) -> dict[str, int]:
    """Return the index of the contact of each line. Lines on several contacts are left out."""
    lines_and_indices: list[tuple[str, int]] = []
    for index, contact in enumerate(connector.contacts):
        lines_and_indices += [(line, index) for line in signal_names(contact.signal)]
    contact_count_by_line = Counter(line for line, _ in lines_and_indices)
    return {line: index for line, index in lines_and_indices if contact_count_by_line[line] == 1}


def _differential_pairs(index_by_line: Mapping[str, int]) -> Iterator[_Pair]:
    """Yield the differential pairs among lines, in the order of their contacts.

    Two contacts are yielded once, even if their lines have several names.
    """
    has_inverted = any(line.startswith("/") for line in index_by_line)
    contact_pairs: set[tuple[int, int]] = set()
    for line in index_by_line:
        partner = partner_of(line, has_inverted)
        if partner not in index_by_line:
            continue
        is_inverted = line.endswith("-") or line.startswith("/")
        plain_line, inverted_line = (partner, line) if is_inverted else (line, partner)
        plain_index, inverted_index = index_by_line[plain_line], index_by_line[inverted_line]
        if (plain_index, inverted_index) not in contact_pairs:
            contact_pairs.add((plain_index, inverted_index))
            yield _Pair(plain_line, inverted_line, plain_index=plain_index, inverted_index=inverted_index)


def _checked_pairs_of_note(
    connector: LocatedPart[Connector], index_by_line: Mapping[str, int], report: DocumentReport
) -> list[set[int]]:
    """Return the pairs of contacts whose order the note of a connector states, and report each false statement.

    For "MA - is on a lower-numbered contact than MA +", the pair consists of the indices of both contacts, such as
    ``{2, 3}``.
    """
    stated_pairs: list[set[int]] = []
    for match in _PAIR_ORDER_NOTE.finditer(connector.part.note):
        lower_text, higher_text = match.groups()
        lower_line = _line_in_text(lower_text, index_by_line)
        higher_line = _line_in_text(higher_text, index_by_line)
        if not lower_line or not higher_line:
            continue
        lower_index, higher_index = index_by_line[lower_line], index_by_line[higher_line]
        if lower_index > higher_index:
            problem = f"the note says that {lower_line} is on a lower-numbered contact than {higher_line}"
            message = f"{problem}, but it is on a higher-numbered one; correct one of the two"
            report.add("pair-order", (*connector.path, "note"), message)
        stated_pairs.append({lower_index, higher_index})
    return stated_pairs


def _line_in_text(line_text: str, known_lines: Iterable[str]) -> str:
    """Return the line that a text names, perhaps after "but" or "and". Empty if it names none of the lines."""
    plain_text = re.sub(r"\s+(?=[+-])", "", line_text.strip()).casefold()  # ``ma+`` for ``MA +``
    for line in known_lines:
        if plain_text in (line, f"but {line}", f"and {line}"):
            return line
    return ""


#: Two wires named together, as in "white and blue wires".
_TWO_WIRES = re.compile(r"\b([A-Za-z]+(?:[-/_][A-Za-z]+)?) and ([A-Za-z]+(?:[-/_][A-Za-z]+)?) wires\b")
#: A supply line, such as ``+5 V`` or ``0V``.
_SUPPLY_LINE = re.compile(r"(?<![A-Za-z])[+-]?\d*(?:[.,]\d+)? ?V", re.IGNORECASE)


def check_named_wires(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that two wires that a text names together, by their colors, are a supply or a differential pair.

    The signals of the wires are those in the tables of cables. Wires that no cable has are not checked.
    """
    signals_by_color = _signals_by_wire(spec)
    if not signals_by_color:
        return
    for path, text in _texts_that_name_wires(spec):
        for first_wire, second_wire in _TWO_WIRES.findall(text):
            first_signals = signals_by_color.get(first_wire.casefold())
            second_signals = signals_by_color.get(second_wire.casefold())
            if first_signals is None or second_signals is None:
                continue
            signal_pairs = itertools.product(first_signals, second_signals)
            are_a_pair = any(_belong_together(signal, other_signal) for signal, other_signal in signal_pairs)
            if not are_a_pair:
                first_signal, second_signal = min(first_signals), min(second_signals)
                message = (
                    f"the text names the {first_wire} and {second_wire} wires together, but they carry"
                    f" {quoted(first_signal)} and {quoted(second_signal)}; correct one of the two"
                )
                report.add("words-contradict", path, message)


def _signals_by_wire(spec: WrittenSpec) -> dict[str, set[str]]:
    """Return the signals that a wire of each color has in some cable: ``{"white": {"MA+"}}``."""
    signals_by_color: dict[str, set[str]] = {}
    for connector in spec.connectors:
        if connector.part.kind != "cable":
            continue
        for wire in connector.part.contacts:
            color = wire.contact.casefold()
            signals_by_color.setdefault(color, set()).add(wire.signal)
    return signals_by_color


def _belong_together(signal: str, other_signal: str) -> bool:
    """Return True if two signals are both supply lines, or have the same letters and digits.

    The latter is true for the lines of a differential pair, such as ``MA+`` and ``MA-``.
    """
    if _SUPPLY_LINE.search(signal) and _SUPPLY_LINE.search(other_signal):
        return True
    letters_and_digits = re.sub(r"[^a-z0-9]", "", signal.casefold())
    other_letters_and_digits = re.sub(r"[^a-z0-9]", "", other_signal.casefold())
    return letters_and_digits == other_letters_and_digits


def _texts_that_name_wires(spec: WrittenSpec) -> Iterator[tuple[Path, str]]:
    """Yield the texts of procedures, characteristics and alarms, each with its path."""
    for procedure in spec.procedures:
        yield from texts_of(procedure, KEYS_OF_EXPLANATIONS)
    for characteristic in spec.characteristics:
        yield from texts_of(characteristic, ("value", "note"))
    for alarm in spec.alarms:
        yield from texts_of(alarm, KEYS_OF_EXPLANATIONS)
