"""Compare facts and connectors that are the same in several devices according to the manufacturer's file."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any, NamedTuple

from ..language.document import Document, Path, label_of
from ..language.problems import ProblemReport, quoted
from ..language.rules.connectors import signal_names
from ..language.rules.parts import as_affected_name, errata_at, has_erratum_at
from ..language.rules.walk import leaves, mapping, maps_in_list
from ..language.schemas import PROSE

#: Number of steps in the path of an interface, such as ``interfaces.ssi``.
_STEPS_OF_INTERFACE = 2
#: Keys whose values are texts from the manual, or only concern one device.
_KEYS_NOT_COMPARED = PROSE | {"printed_name", "only", "erratum"}
#: Shown in place of a fact that a device does not have.
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

    All devices with the interface are compared, including devices without these facts. The facts that most devices have
    are correct. If several are equally common, the first device without an erratum about the place is correct. A
    difference is not reported if one of the two devices has an erratum about the place that the other does not have.
    """
    for place in places:
        steps = place.split(".")
        # For interfaces.ssi.cable_lengths, the interface is interfaces.ssi.
        steps_of_interface = steps[:_STEPS_OF_INTERFACE]
        with_interface = [document for document in documents if mapping(document.data, *steps_of_interface)]
        with_interface.sort(key=lambda document: document.file)
        facts_by_file = {document.file: _facts_at(document, steps) for document in with_interface}
        counts = Counter(frozenset(facts.items()) for facts in facts_by_file.values())
        all_have_same_facts = len(counts) < 2
        if all_have_same_facts:
            continue
        # Devices with the most common facts come first, and among them devices without an erratum.
        priorities: dict[str, tuple[int, bool]] = {}
        for document in with_interface:
            device_count = counts[frozenset(facts_by_file[document.file].items())]
            priorities[document.file] = device_count, not has_erratum_at(document, *steps)
        common = max(with_interface, key=lambda document: priorities[document.file])
        for document in with_interface:
            # An erratum that both devices have is about a text that both manuals contain.
            if errata_at(document, *steps) == errata_at(common, *steps):
                _report_difference(document, common, facts_by_file, tuple(steps), report)


def _facts_at(document: Document, steps: Sequence[str]) -> _Facts:
    """Return the facts of a spec below a place, by their paths relative to it, without texts from the manual.

    For example ``{(0, "below_hz"): 400000}``. If the place is a single value, its path is ``()``.
    """
    node: object = document.data
    for step in steps:
        if isinstance(node, list):
            node = next((part for part in node if label_of(part) == step), None)
        else:
            node = node.get(step) if isinstance(node, dict) else None
    return dict(_compared_leaves(node))


def _compared_leaves(node: object) -> Iterator[tuple[Path, object]]:
    """Yield the path and the value of each fact below a node of a spec, without texts from the manual."""
    for path, value in leaves(node):
        if value is not None and _KEYS_NOT_COMPARED.isdisjoint(map(str, path)):
            yield path, value


def _report_difference(
    document: Document, common: Document, facts_by_file: Mapping[str, _Facts], place: Path, report: ProblemReport
) -> None:
    """Report the first fact at a place in which a device differs from ``common``, the device with the common facts."""
    facts, common_facts = facts_by_file[document.file], facts_by_file[common.file]
    all_paths = dict.fromkeys((*common_facts, *facts))  # Each once, in order.
    for path in all_paths:
        value, common_value = facts.get(path, _ABSENT_FACT), common_facts.get(path, _ABSENT_FACT)
        if value == common_value:
            continue
        line, _ = common.position((*place, *path))
        place_text = ".".join(map(str, place))
        message = (
            f"this is {value}, but {common_value} in {PurePath(common.file).name}:{line}; according to the"
            f" manufacturer's file, {quoted(place_text)} is the same in all devices. If it is not, add"
            f" an erratum that affects {as_affected_name(place_text)}, or remove it from that file"
        )
        report.add("not-alike", document, (*place, *path), message)
        return


class _Contact(NamedTuple):
    """A contact that carries a line: its number or wire color, its connector, and its place in a spec."""

    name: str
    connector: str
    document: Document
    path: Path


#: An interface and the name of a line. For supply lines, the interface is "", because they belong to all interfaces.
_Line = tuple[str, str]


def compare_connectors(maker_document: Document, documents: Sequence[Document], report: ProblemReport) -> None:
    """Report each line that is on different contacts in two connectors that should be alike.

    The manufacturer's file lists groups of connectors that are alike, as references such as ``m100.m12_connector``.
    Devices whose specs were not read are skipped. Supply lines are compared between all connectors of a group, and any
    other line between connectors for the same interface.
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
    """A cable: its place in a spec, and the colors of its wires in lowercase."""

    document: Document
    path: Path
    wires: frozenset[str]


def _cable_at(document: Document, path: Path) -> Iterator[_Cable]:
    """Yield the cable at a place of a spec with its wires, or nothing if the place is a connector.

    A shield does not count as a wire.
    """
    connector = document.data["connectors"][path[-1]]
    if connector["kind"] == "cable":
        wires: set[str] = set()
        for _, contact in maps_in_list(connector, "contacts"):
            is_shield = not _SHIELD_WORDS.isdisjoint(signal_names(str(contact["signal"])))
            if not is_shield:
                wires.add(str(contact["contact"]).casefold())
        yield _Cable(document, path, frozenset(wires))


def _compare_wires(cables: Sequence[_Cable], report: ProblemReport) -> None:
    """Report each cable whose wires differ from the wires of the first cable.

    A difference is not reported if an erratum affects the contacts of one of the two cables.
    """
    if not cables:
        return
    first_cable, *other_cables = cables
    for cable in other_cables:
        different_wires = sorted(cable.wires ^ first_cable.wires)  # Wires that only one of the two has.
        if different_wires and not _has_erratum(first_cable) and not _has_erratum(cable):
            line_number, _ = first_cable.document.position(first_cable.path)
            message = (
                f"only one of this cable and the one in {PurePath(first_cable.document.file).name}:{line_number} has"
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
    """Report the lines of a connector that are on a different contact in an earlier connector of the group.

    ``contacts_by_line`` contains the contact of each line that an earlier connector has. Lines that are new are added
    to it.
    """
    connector = document.data["connectors"][path[-1]]
    reported_paths: set[Path] = set()
    for line, contact in _contacts_by_line(connector, path, document).items():
        first_contact = contacts_by_line.setdefault(line, contact)
        if first_contact.name == contact.name or _has_erratum_at_contacts(contact, first_contact):
            continue
        # A contact with several lines is reported once.
        if contact.path not in reported_paths:
            reported_paths.add(contact.path)
            _report_contact(line, contact, first_contact, report)


def _has_erratum_at_contacts(*contacts: _Contact) -> bool:
    """Return whether an erratum affects the contacts of the connector to which one of these contacts belongs."""
    return any(has_erratum_at(contact.document, "connectors", contact.connector, "contacts") for contact in contacts)


def _report_contact(line: _Line, contact: _Contact, first_contact: _Contact, report: ProblemReport) -> None:
    """Report a line that is on a different contact than in the first connector of the group."""
    line_number, _ = first_contact.document.position(first_contact.path)
    _, line_name = line
    message = (
        f"{quoted(line_name)} is on contact {quoted(contact.name)} here, but on {quoted(first_contact.name)} in"
        f" {PurePath(first_contact.document.file).name}:{line_number}; according to the manufacturer's file, the two"
        f" connectors are alike. If they are not, add an erratum that affects"
        f" connectors.{contact.connector}.contacts"
    )
    # Two exchanged wires are one problem.
    cause = f"{contact.connector} {first_contact.document.file} {first_contact.connector}"
    report.add("not-alike", contact.document, contact.path, message, cause=cause)


def _contacts_by_line(connector: Any, path: Path, document: Document) -> dict[_Line, _Contact]:
    """Return the contact of each line of a connector in a spec. Lines that are on several contacts are left out."""
    interfaces = connector.get("interfaces") or [""]  # A connector that lists no interface is for all of them.
    contacts: list[tuple[_Line, _Contact]] = []
    for contact_path, contact in maps_in_list(connector, "contacts"):
        place = _Contact(
            name=str(contact["contact"]),
            connector=str(connector["name"]),
            document=document,
            path=(*path, *contact_path),
        )
        lines = _lines_of_signal(str(contact["signal"]), interfaces)
        contacts += [(line, place) for line in lines]
    counts = Counter(line for line, _ in contacts)
    return {line: contact for line, contact in contacts if counts[line] == 1}


def _lines_of_signal(signal: str, interfaces: Sequence[str]) -> Iterator[_Line]:
    """Yield the lines that a signal names, for each interface: ``("biss", "ma+")``, ``("", "0 V")``."""
    for name in signal_names(signal):
        if name in _SHIELD_WORDS:  # The shield is on the case of the connector, which manuals name differently.
            continue
        supply = _SUPPLY_LINE.fullmatch(name)
        if supply is not None:
            yield "", "0 V" if supply["ground"] else "+V"
        elif _ANY_VOLTAGE.fullmatch(name):
            yield "", name
        else:
            yield from ((interface, name) for interface in interfaces)
