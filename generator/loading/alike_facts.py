"""Compare the facts of interfaces and the connectors that the file of a manufacturer lists as alike."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any, NamedTuple

from ..language.document import Document, Path, label_of
from ..language.problems import ProblemReport, quoted
from ..language.rules.connectors import signal_names
from ..language.rules.parts import as_affected_name, has_erratum_at
from ..language.rules.walk import leaves, mapping, maps_in_list
from ..language.schema_files import PROSE

#: Steps of the path to an interface, such as ``interfaces.ssi``.
_STEPS_OF_INTERFACE = 2
#: Keys whose values are printed, or belong to one device.
_NOT_COMPARED = PROSE | {"printed_name", "only", "erratum"}
#: Shown for a fact that a device lacks.
_ABSENT_FACT = "nothing"
#: Facts at a place, by their relative paths: ``{(0, "below_hz"): 400000}``.
_Facts = Mapping[Path, object]
#: A supply or ground line, such as ``0vdc`` or ``+5vdc ±5%``, but not a battery line, ``+vb``.
_SUPPLY_LINE = re.compile(r"(?P<ground>0\s?v(?:dc)?)|\+\s?[\d.,]*\s?v(?!b).*")
_SHIELD_WORDS = frozenset(("shield", "screen"))
#: Any voltage, such as ``+vb``.
_ANY_VOLTAGE = re.compile(r"[+-]?\s?[\d.,]*\s?v\w*")


def compare_facts(places: Sequence[str], documents: Sequence[Document], report: ProblemReport) -> None:
    """Report each device whose facts at a place such as ``interfaces.ssi.cable_lengths`` differ from most devices.

    All devices with the interface are compared, so one that lacks the facts is reported, too. Among equally common
    facts, the facts of the first device without an erratum about the place apply. An erratum that only one of two
    devices has about it explains a difference.
    """
    for place in places:
        steps = place.split(".")
        with_interface = [document for document in documents if mapping(document.data, *steps[:_STEPS_OF_INTERFACE])]
        with_interface.sort(key=lambda document: document.file)
        facts_by_file = {document.file: _facts_at(document, steps) for document in with_interface}
        counts = Counter(frozenset(facts.items()) for facts in facts_by_file.values())
        if len(counts) < 2:
            continue  # All devices have the same facts, or there are none.
        # If several devices have the most frequent facts, a device without an erratum is compared with the others.
        frequencies = {
            document.file: (
                counts[frozenset(facts_by_file[document.file].items())],
                not has_erratum_at(document, *steps),
            )
            for document in with_interface
        }
        common = max(with_interface, key=lambda document: frequencies[document.file])
        for document in with_interface:
            # Errata of both devices are about the text that their manuals have in common.
            if has_erratum_at(document, *steps) is has_erratum_at(common, *steps):
                _report_difference(document, common, facts_by_file, tuple(steps), report)


def _facts_at(document: Document, steps: Sequence[str]) -> _Facts:
    """Return the facts at a place without prose and printed names. The path of a single value is empty."""
    node: object = document.data
    for step in steps:
        if isinstance(node, list):
            node = next((part for part in node if label_of(part) == step), None)
        else:
            node = node.get(step) if isinstance(node, dict) else None
    return dict(_compared_leaves(node))


def _compared_leaves(node: object) -> Iterator[tuple[Path, object]]:
    for path, value in leaves(node):
        if value is not None and _NOT_COMPARED.isdisjoint(map(str, path)):
            yield path, value


def _report_difference(
    document: Document, common: Document, facts_by_file: Mapping[str, _Facts], place: Path, report: ProblemReport
) -> None:
    """Report the first fact in which two devices differ, or nothing if they agree."""
    facts, common_facts = facts_by_file[document.file], facts_by_file[common.file]
    all_paths = dict.fromkeys((*common_facts, *facts))  # Each once, in order.
    for path in all_paths:
        value, common_value = facts.get(path, _ABSENT_FACT), common_facts.get(path, _ABSENT_FACT)
        if value == common_value:
            continue
        line, _ = common.position((*place, *path))
        message = (
            f"this is {value}, but {common_value} in {PurePath(common.file).name}:{line}; according to the"
            f" manufacturer's file, {quoted('.'.join(map(str, place)))} is the same in all devices. If it is not, add"
            f" an erratum that affects {as_affected_name('.'.join(map(str, place)))}, or remove it from that file"
        )
        report.add("not-alike", document, (*place, *path), message)
        return


class _Contact(NamedTuple):
    """A contact that carries a line: its number or colour, its connector, and its place in a spec."""

    name: str
    connector: str
    document: Document
    path: Path


#: An interface and the name of a line. The interface of supply lines is empty, because they belong to all.
_Line = tuple[str, str]


def compare_connectors(maker_document: Document, documents: Sequence[Document], report: ProblemReport) -> None:
    """Report each line that two connectors of a group have on different contacts.

    The file of the manufacturer lists groups of references such as ``m100.m12_connector``. A device whose spec was not
    read is skipped. Supply lines are compared between all connectors of a group, other lines for the same interface.
    """
    documents_by_device = {str(document.data["device"]): document for document in documents}
    for group_index, group in enumerate(maker_document.data.get("alike", {}).get("connectors", ())):
        contacts_by_line: dict[_Line, _Contact] = {}
        cables: list[_Cable] = []
        for index, reference in enumerate(group):
            device, _, name = reference.partition(".")
            document = documents_by_device.get(device)
            if document is None:
                continue
            connectors = maps_in_list(document.data, "connectors")
            place = next((path for path, connector in connectors if connector.get("name") == name), None)
            if place is not None:
                _compare_connector(contacts_by_line, document, place, report)
                cables += _cable_at(document, place)
                continue
            message = f"{quoted(device)} has no connector or cable {quoted(name)}"
            reference_path: Path = ("alike", "connectors", group_index, index)
            report.add("undefined-reference", maker_document, reference_path, message)
        _compare_wires(cables, report)


class _Cable(NamedTuple):
    """A cable: its place, and the colours of its wires in lower case."""

    document: Document
    path: Path
    wires: frozenset[str]


def _cable_at(document: Document, path: Path) -> Iterator[_Cable]:
    """Yield the cable at a place, or nothing for a connector. A shield is not a wire."""
    connector = document.data["connectors"][path[-1]]
    if connector["kind"] == "cable":
        wires: set[str] = set()
        for _, contact in maps_in_list(connector, "contacts"):
            is_shield = not _SHIELD_WORDS.isdisjoint(signal_names(str(contact["signal"])))
            if not is_shield:
                wires.add(str(contact["contact"]).casefold())
        yield _Cable(document, path, frozenset(wires))


def _compare_wires(cables: Sequence[_Cable], report: ProblemReport) -> None:
    """Report each cable with other wires than the first one of its group, unless an erratum affects its contacts."""
    if not cables:
        return
    first_cable, *other_cables = cables
    for cable in other_cables:
        different_wires = sorted(cable.wires ^ first_cable.wires)  # Wires that only one of the two has.
        if different_wires and not _has_erratum(first_cable) and not _has_erratum(cable):
            line_number, _ = first_cable.document.position(first_cable.path)
            message = (
                f"only one of this cable and that in {PurePath(first_cable.document.file).name}:{line_number} has"
                f" {quoted(different_wires[0])}; according to the manufacturer's file, the two are alike. If they are"
                f" not, add an erratum that affects connectors.{_name_of_cable(cable)}.contacts"
            )
            report.add("not-alike", cable.document, (*cable.path, "contacts"), message)


def _has_erratum(cable: _Cable) -> bool:
    """Return True if an erratum affects the contacts of a cable."""
    return has_erratum_at(cable.document, "connectors", _name_of_cable(cable), "contacts")


def _name_of_cable(cable: _Cable) -> str:
    return str(cable.document.data["connectors"][cable.path[-1]]["name"])


def _compare_connector(
    contacts_by_line: dict[_Line, _Contact], document: Document, path: Path, report: ProblemReport
) -> None:
    """Report the lines of a connector that have another contact in ``contacts_by_line``, and add the new ones."""
    connector = document.data["connectors"][path[-1]]
    reported_paths: set[Path] = set()
    for line, contact in _contacts_by_line(connector, path, document).items():
        first_contact = contacts_by_line.setdefault(line, contact)
        is_explained = any(
            has_erratum_at(either.document, "connectors", either.connector, "contacts", either.name)
            for either in (contact, first_contact)
        )
        # A contact with several lines is reported once.
        if first_contact.name != contact.name and contact.path not in reported_paths and not is_explained:
            reported_paths.add(contact.path)
            _report_contact(line, contact, first_contact, report)


def _report_contact(line: _Line, contact: _Contact, first_contact: _Contact, report: ProblemReport) -> None:
    """Report a line that is on another contact here than on the first connector of its group."""
    line_number, _ = first_contact.document.position(first_contact.path)
    _, line_name = line  # The first member is its interface.
    message = (
        f"{quoted(line_name)} is on contact {quoted(contact.name)} here, but on {quoted(first_contact.name)} in"
        f" {PurePath(first_contact.document.file).name}:{line_number}; according to the manufacturer's file, the two"
        f" connectors are alike. If they are not, add an erratum that affects"
        f" connectors.{contact.connector}.contacts.{contact.name}"
    )
    report.add("not-alike", contact.document, contact.path, message)


def _contacts_by_line(connector: Any, path: Path, document: Document) -> dict[_Line, _Contact]:
    """Return the contact of each line of a connector. Lines with several contacts are left out."""
    interfaces = connector.get("interfaces") or [""]  # Without a list, it is for all of them.
    contacts: list[tuple[_Line, _Contact]] = []
    for contact_path, contact in maps_in_list(connector, "contacts"):
        place = _Contact(str(contact["contact"]), str(connector["name"]), document, (*path, *contact_path))
        contacts += [(line, place) for line in _lines_of_signal(str(contact["signal"]), interfaces)]
    counts = Counter(line for line, _ in contacts)
    return {line: contact for line, contact in contacts if counts[line] == 1}


def _lines_of_signal(signal: str, interfaces: Sequence[str]) -> Iterator[_Line]:
    """Yield the lines that a signal names, for each interface: ``("biss", "ma+")``, ``("", "0 V")``."""
    for name in signal_names(signal):
        if name in _SHIELD_WORDS:  # It is on the case, whose name differs between manuals.
            continue
        supply = _SUPPLY_LINE.fullmatch(name)
        if supply is not None:
            yield "", "0 V" if supply["ground"] else "+V"
        elif _ANY_VOLTAGE.fullmatch(name):
            yield "", name
        else:
            yield from ((interface, name) for interface in interfaces)
