"""Compare the specs of a manufacturer: facts and connectors that are alike, and documents that several specs cite."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any, NamedTuple

from ..language.document import Document, Path, label_of
from ..language.keys_of_fields import WrittenField, WrittenRegister
from ..language.keys_of_specs import WrittenSpec
from ..language.problems import ProblemReport, quoted
from ..language.rules.connectors import signal_names
from ..language.rules.manual import problems_of_other_manual
from ..language.rules.parts import as_affected_name, by_name, by_part_name, errata_at, is_explained_at
from ..language.rules.walk import leaves, mapping, maps_in_list, sources
from ..language.schemas import PROSE
from ..language.written import LocatedPart
from ..model import Crc

#: A number in the title or address of a document, but not in a name such as ABC21.
_NUMBER_IN_REFERENCE = re.compile(r"(?<![A-Za-z0-9])\d+")
_DIGITS = re.compile(r"\d+")
_MEMBERS = ("title", "url")


def compare_documents(specs: Sequence[Document], report: ProblemReport) -> None:
    """Report a document whose title or address differs from one under the same key in another spec, only in numbers.

    Several specs of a manufacturer cite the same document, such as a standard. Another document has other words. If the
    title or the address is the same, numbers in names are compared too.
    """
    # The keys are equal for texts that differ only in numbers: in both texts, in the address, or in the title.
    first_spec_by_key: dict[tuple[str, ...], Document] = {}
    for spec in sorted(specs, key=lambda spec: spec.file):
        for document_key in mapping(spec.data, "documents"):
            title, url = _texts_of_document(spec, document_key).values()
            without_numbers = (document_key, _NUMBER_IN_REFERENCE.sub("0", title), _NUMBER_IN_REFERENCE.sub("0", url))
            with_title_numbers = (document_key, title, _DIGITS.sub("0", url))
            with_address_numbers = (document_key, _DIGITS.sub("0", title), url or spec.file)
            keys = (without_numbers, with_title_numbers, with_address_numbers)
            specs_to_compare = [first_spec_by_key.setdefault(key, spec) for key in keys]
            _report_other_numbers(spec, document_key, specs_to_compare, report)


def _texts_of_document(spec: Document, key: str) -> dict[str, str]:
    """Return the title and the address of a document. The address is empty if it has none."""
    document = mapping(spec.data, "documents", key)
    return {member: str(document.get(member, "")) for member in _MEMBERS}


def _report_other_numbers(spec: Document, key: str, other_specs: Sequence[Document], report: ProblemReport) -> None:
    """Report the title and the address of a document that differ from those in one of the first specs with it."""
    for text_key, text in _texts_of_document(spec, key).items():
        for other_spec in other_specs:
            other_text = _texts_of_document(other_spec, key)[text_key]
            if text == other_text:
                continue
            line, _ = other_spec.position(("documents", key, text_key))
            message = (
                f"only a number differs from {quoted(other_text)} in {PurePath(other_spec.file).name}:{line};"
                f" correct one of the two, or give one of the documents another key"
            )
            report.add("not-alike", spec, ("documents", key, text_key), message)
            break


def check_cited_manuals(specs: Sequence[Document], report: ProblemReport) -> None:
    """Check the sections and pages that a spec cites in the manual of another spec of the same manufacturer.

    The key of this document is the name of the other device, and its title contains the title and the revision of the
    manual. A title that differs from the manual's only in numbers is reported.
    """
    spec_by_device = {str(spec.data["device"]): spec for spec in specs}
    for spec in specs:
        for document_key in mapping(spec.data, "documents"):
            other_spec = spec_by_device.get(document_key)
            if other_spec is None or other_spec is spec:
                continue
            manual = WrittenSpec(other_spec.data).manual
            title = _texts_of_document(spec, document_key)["title"]
            if manual.title not in title:
                _report_other_title(spec, document_key, title, other_spec, report)
            # The revision 1.2 is in "Manual 1.2", but not in "Manual 11.2" or "Manual 1.2.1".
            elif re.search(rf"(?<![\w.]){re.escape(manual.revision)}(?![\w.]*\w)", title) and manual.contents:
                for path_of_source, source in sources(leaves(spec.data)):
                    for problem in problems_of_other_manual(source, document_key, manual.contents):
                        report.add("cited-place", spec, path_of_source, f"{document_key}: {problem}")


def _report_other_title(spec: Document, key: str, title: str, other_spec: Document, report: ProblemReport) -> None:
    """Report a title of a document that differs from the title of the manual in another spec only in numbers."""
    manual_title = str(mapping(other_spec.data, "manual").get("title", ""))
    if _DIGITS.sub("0", manual_title) in _DIGITS.sub("0", title):
        line, _ = other_spec.position(("manual", "title"))
        message = (
            f"only a number differs from the manual's title {quoted(manual_title)} in"
            f" {PurePath(other_spec.file).name}:{line}; correct one of the two, or give the document another key"
        )
        report.add("not-alike", spec, ("documents", key, "title"), message)


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


def compare_facts(fact_paths: Sequence[str], specs: Sequence[Document], report: ProblemReport) -> None:
    """Report each device whose facts at a place such as ``interfaces.ssi.cable_lengths`` differ from most devices.

    All devices with the interface are compared, including devices without these facts. The facts that most devices have
    are correct. If several are equally common, the first device without an erratum about the place is correct. A
    difference is not reported if one of the two devices has an erratum about the place that the other does not have.
    """
    for fact_path in fact_paths:
        steps = fact_path.split(".")
        interface_steps = steps[:2]  # For interfaces.ssi.cable_lengths, this is interfaces.ssi.
        specs_with_interface = [spec for spec in specs if mapping(spec.data, *interface_steps)]
        specs_with_interface.sort(key=lambda spec: spec.file)
        facts_by_file = {spec.file: _facts_at(spec, steps) for spec in specs_with_interface}
        device_count_by_facts = Counter(frozenset(facts.items()) for facts in facts_by_file.values())
        all_have_same_facts = len(device_count_by_facts) < 2
        if all_have_same_facts:
            continue
        # Devices with the most common facts come first, and among them devices without an erratum.
        priority_by_file: dict[str, tuple[int, bool]] = {}
        for spec in specs_with_interface:
            devices_with_facts = device_count_by_facts[frozenset(facts_by_file[spec.file].items())]
            priority_by_file[spec.file] = devices_with_facts, not is_explained_at(spec, *steps)
        common_spec = max(specs_with_interface, key=lambda spec: priority_by_file[spec.file])
        for spec in specs_with_interface:
            # An erratum that both devices have is about a text that both manuals contain.
            if errata_at(spec, *steps) == errata_at(common_spec, *steps):
                _report_difference(spec, common_spec, facts_by_file, tuple(steps), report)


def _facts_at(spec: Document, steps: Sequence[str]) -> _Facts:
    """Return the facts of a spec below a place, by their paths relative to it, without texts from the manual.

    For example ``{(0, "below_hz"): 400000}``. If the place is a single value, its path is ``()``.
    """
    node: object = spec.data
    for step in steps:
        if isinstance(node, list):
            node = next((list_member for list_member in node if label_of(list_member) == step), None)
        else:
            node = node.get(step) if isinstance(node, dict) else None
    fact_by_path: dict[Path, object] = {}
    for path_of_value, spec_value in leaves(node):
        if spec_value is not None and _KEYS_NOT_COMPARED.isdisjoint(map(str, path_of_value)):
            fact_by_path[path_of_value] = spec_value
    return fact_by_path


def _report_difference(
    spec: Document, common_spec: Document, facts_by_file: Mapping[str, _Facts], facts_path: Path, report: ProblemReport
) -> None:
    """Report the first fact at a place in which a spec differs from ``common_spec``, the spec with the common facts."""
    fact_by_path, common_fact_by_path = facts_by_file[spec.file], facts_by_file[common_spec.file]
    all_paths = dict.fromkeys((*common_fact_by_path, *fact_by_path))  # Each once, in order.
    for path in all_paths:
        fact, common_fact = fact_by_path.get(path, _ABSENT_FACT), common_fact_by_path.get(path, _ABSENT_FACT)
        if fact == common_fact:
            continue
        line, _ = common_spec.position((*facts_path, *path))
        facts_path_text = ".".join(map(str, facts_path))
        message = (
            f"this is {fact}, but {common_fact} in {PurePath(common_spec.file).name}:{line}; according to the"
            f" manufacturer's file, {quoted(facts_path_text)} is the same in all devices. If it is not, add"
            f" an erratum that affects {as_affected_name(facts_path_text)}, or remove it from that file"
        )
        report.add("not-alike", spec, (*facts_path, *path), message)
        return


class _Contact(NamedTuple):
    """A contact that carries a line: its number or wire color, its connector, and its place in a spec."""

    name: str
    connector: str
    document: Document
    path: Path


#: An interface and the name of a line. For supply lines, the interface is "", because they belong to all interfaces.
_Line = tuple[str, str]


def compare_connectors(manufacturer_file: Document, specs: Sequence[Document], report: ProblemReport) -> None:
    """Report each line that is on different contacts in two connectors that should be alike.

    The manufacturer's file lists groups of connectors that are alike, as references such as ``m100.m12_connector``.
    Devices whose specs were not read are skipped. Supply lines are compared between all connectors of a group, and any
    other line between connectors for the same interface.
    """
    spec_by_device = {str(spec.data["device"]): spec for spec in specs}
    for group_index, references in enumerate(manufacturer_file.data.get("alike", {}).get("connectors", ())):
        contacts_by_line: dict[_Line, _Contact] = {}
        cables: list[_Cable] = []
        for reference_index, reference in enumerate(references):
            device_name, _, name = reference.partition(".")
            spec = spec_by_device.get(device_name)
            if spec is None:
                continue
            connectors = maps_in_list(spec.data, "connectors")
            connector_path = next((path for path, connector in connectors if connector.get("name") == name), None)
            if connector_path is not None:
                _compare_connector(contacts_by_line, spec, connector_path, report)
                cables += _cable_at(spec, connector_path)
                continue
            message = f"{quoted(device_name)} has no connector or cable {quoted(name)}"
            reference_path: Path = ("alike", "connectors", group_index, reference_index)
            report.add("undefined-reference", manufacturer_file, reference_path, message)
        _compare_wires(cables, report)


class _Cable(NamedTuple):
    """A cable: its place in a spec, its name, and the colors of its wires in lowercase."""

    document: Document
    path: Path
    name: str
    wires: frozenset[str]

    @property
    def has_erratum(self) -> bool:
        """Whether an erratum affects the contacts of the cable."""
        return is_explained_at(self.document, "connectors", self.name, "contacts")


def _cable_at(spec: Document, path: Path) -> Iterator[_Cable]:
    """Yield the cable at a place of a spec with its wires, or nothing if the place is a connector."""
    connector = spec.data["connectors"][path[-1]]
    if connector["kind"] == "cable":
        wires: set[str] = set()
        for _, contact in maps_in_list(connector, "contacts"):
            if _SHIELD_WORDS.isdisjoint(signal_names(str(contact["signal"]))):  # A shield is not a wire.
                wires.add(str(contact["contact"]).casefold())
        yield _Cable(spec, path, name=str(connector["name"]), wires=frozenset(wires))


def _compare_wires(cables: Sequence[_Cable], report: ProblemReport) -> None:
    """Report each cable whose wires differ from the wires of the first cable.

    A difference is not reported if an erratum affects the contacts of one of the two cables.
    """
    if not cables:
        return
    first_cable, *other_cables = cables
    for cable in other_cables:
        different_wires = sorted(cable.wires ^ first_cable.wires)  # Wires that only one of the two has.
        if different_wires and not first_cable.has_erratum and not cable.has_erratum:
            line_number, _ = first_cable.document.position(first_cable.path)
            message = (
                f"only one of this cable and the one in {PurePath(first_cable.document.file).name}:{line_number} has"
                f" {quoted(different_wires[0])}; according to the manufacturer's file, the two are alike. If they are"
                f" not, add an erratum that affects connectors.{cable.name}.contacts"
            )
            report.add("not-alike", cable.document, (*cable.path, "contacts"), message)


def _compare_connector(
    contacts_by_line: dict[_Line, _Contact], spec: Document, connector_path: Path, report: ProblemReport
) -> None:
    """Report the lines of a connector that are on a different contact in an earlier connector of the group.

    ``contacts_by_line`` contains the contact of each line that an earlier connector has. Lines that are new are added
    to it.
    """
    connector = spec.data["connectors"][connector_path[-1]]
    reported_paths: set[Path] = set()
    for line, contact in _contacts_by_line(connector, connector_path, spec).items():
        first_contact = contacts_by_line.setdefault(line, contact)
        if first_contact.name == contact.name or _has_erratum_at_contacts(contact, first_contact):
            continue
        # A contact with several lines is reported once.
        if contact.path not in reported_paths:
            reported_paths.add(contact.path)
            _report_contact(line, contact, first_contact, report)


def _has_erratum_at_contacts(*contacts: _Contact) -> bool:
    """Return whether an erratum affects the contacts of the connector to which one of these contacts belongs."""
    return any(is_explained_at(contact.document, "connectors", contact.connector, "contacts") for contact in contacts)


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


def _contacts_by_line(connector: Any, connector_path: Path, spec: Document) -> dict[_Line, _Contact]:
    """Return the contact of each line of a connector in a spec. Lines that are on several contacts are left out."""
    interfaces = connector.get("interfaces") or [""]  # A connector that lists no interface is for all of them.
    lines_and_contacts: list[tuple[_Line, _Contact]] = []
    for contact_path, raw_contact in maps_in_list(connector, "contacts"):
        located_contact = _Contact(
            name=str(raw_contact["contact"]),
            connector=str(connector["name"]),
            document=spec,
            path=(*connector_path, *contact_path),
        )
        lines = _lines_of_signal(str(raw_contact["signal"]), interfaces)
        lines_and_contacts += [(line, located_contact) for line in lines]
    contact_count_by_line = Counter(line for line, _ in lines_and_contacts)
    return {line: contact for line, contact in lines_and_contacts if contact_count_by_line[line] == 1}


def _lines_of_signal(signal: str, interfaces: Sequence[str]) -> Iterator[_Line]:
    """Yield the lines that a signal names, for each interface: ``("biss", "ma+")``, ``("", "0 V")``."""
    for signal_name in signal_names(signal):
        if signal_name in _SHIELD_WORDS:  # The shield is on the case of the connector, which manuals name differently.
            continue
        supply_match = _SUPPLY_LINE.fullmatch(signal_name)
        if supply_match is not None:
            yield "", "0 V" if supply_match["ground"] else "+V"
        elif _ANY_VOLTAGE.fullmatch(signal_name):
            yield "", signal_name
        else:
            yield from ((interface, signal_name) for interface in interfaces)


#: Facts that registers and CRCs with the same name share, with the format of numbers in messages.
_SHARED_FACT_FORMS = {
    "registers": {"address": "{:#04x}", "length": "{}", "bank": "{}", "access": "{}", "byte_order": "{}"},
    "crcs": {"width": "{}", "poly": "{:#x}", "init": "{:#x}", "refin": "{}", "refout": "{}", "xorout": "{:#x}"},
}


class _SharedFact(NamedTuple):
    """A fact of a register or CRC that devices share, with its text in messages, such as ``0x48``.

    ``affected`` is its place as errata write it, with names, such as ``("warning", "at")``. ``path`` is its path in the
    spec, with indices, such as ``("fields", 2, "at")``.
    """

    affected: tuple[str, ...]
    path: Path
    text: str


def check_shared_facts(documents: Sequence[Document], report: ProblemReport) -> None:
    """Report differences in facts that should be the same in all devices of a manufacturer.

    The key ``alike`` in the manufacturer's file lists these facts, such as ``{"registers": ["preset"]}``. Files with
    problems are not compared.
    """
    specs = [document for document in documents if "device" in document.data and not report.faults(document)]
    for manufacturer_file in documents:
        if "device" in manufacturer_file.data or report.faults(manufacturer_file):
            continue
        raw_alike = manufacturer_file.data.get("alike", {})
        manufacturer = manufacturer_file.data.get("manufacturer")
        specs_of_manufacturer = [spec for spec in specs if spec.data.get("manufacturer") == manufacturer]
        for section in _SHARED_FACT_FORMS:
            for part_name in raw_alike.get(section, ()):
                specs_with_part = [spec for spec in specs_of_manufacturer if part_name in _parts_by_name(section, spec)]
                _report_different_facts(section, part_name, specs_with_part, report)
        compare_facts(raw_alike.get("facts", ()), specs_of_manufacturer, report)
        compare_connectors(manufacturer_file, specs_of_manufacturer, report)
        compare_documents(specs_of_manufacturer, report)
        check_cited_manuals(specs_of_manufacturer, report)


def _parts_by_name(section: str, document: Document) -> Mapping[str, WrittenRegister | LocatedPart[Crc]]:
    """Return the parts in the section ``registers`` or ``crcs`` of a spec, by name."""
    spec = WrittenSpec(document.data)
    return by_name(spec.registers) if section == "registers" else by_part_name(spec.crcs)


def _report_different_facts(
    section: str, part_name: str, specs_with_part: Sequence[Document], report: ProblemReport
) -> None:
    """Report each device in which a fact of a register or CRC differs from most devices.

    ``section`` is ``registers`` or ``crcs``. If several facts are equally common, the fact in the first file is
    correct. A difference is not reported if an erratum in one of the two devices affects it.
    """
    facts_by_path: dict[tuple[str, ...], list[tuple[Document, _SharedFact]]] = {}
    for spec in sorted(specs_with_part, key=lambda spec: spec.file):
        for fact in _shared_facts(section, _parts_by_name(section, spec)[part_name]):
            facts_by_path.setdefault(fact.affected, []).append((spec, fact))
    for path_in_part, specs_and_facts in facts_by_path.items():
        affected_path = (section, part_name, *path_in_part)
        fact_texts = [fact.text for _, fact in specs_and_facts]
        ((common_text, _),) = Counter(fact_texts).most_common(1)
        common_spec, common_fact = specs_and_facts[fact_texts.index(common_text)]
        if is_explained_at(common_spec, *affected_path):
            continue
        for spec, fact in specs_and_facts:
            if fact.text == common_text or is_explained_at(spec, *affected_path):
                continue
            line, _ = common_spec.position((section, part_name, *common_fact.path))
            message = (
                f"this is {fact.text}, but {common_text} in {PurePath(common_spec.file).name}:{line}; according to"
                f" the manufacturer's file, {quoted(part_name)} is the same in all devices. If it is not, add an"
                f" erratum that affects {'.'.join(affected_path)}"
            )
            report.add("not-alike", spec, (section, part_name, *fact.path), message)


def _shared_facts(section: str, register_or_crc: WrittenRegister | LocatedPart[Crc]) -> Iterator[_SharedFact]:
    """Yield the facts of a register or CRC that devices share."""
    for fact_key, number_format in _SHARED_FACT_FORMS[section].items():
        if fact_key in register_or_crc.data:
            fact_text = _fact_text(number_format, register_or_crc.data[fact_key])
            yield _SharedFact(affected=(fact_key,), path=(fact_key,), text=fact_text)
    if not isinstance(register_or_crc, WrittenRegister):
        return  # A CRC has no fields.
    for field_index, field in enumerate(register_or_crc.fields):
        if field.name:
            yield from _facts_of_field(field, ("fields", field_index))


def _facts_of_field(field: WrittenField, field_path: Path) -> Iterator[_SharedFact]:
    """Yield the facts of a register field that devices share: its place, its width and its named values."""
    for fact_key, number_or_text in (("at", field.at), ("bits", field.bits)):
        if number_or_text is not None:
            yield _SharedFact(affected=(field.name, fact_key), path=(*field_path, fact_key), text=str(number_or_text))
    for value_name, named_value in field.values.items():
        value_path = (*field_path, "values", value_name, "value")
        yield _SharedFact(affected=(field.name, value_name, "value"), path=value_path, text=str(named_value.value))


def _fact_text(number_format: str, fact: object) -> str:
    """Return a fact as text for messages: ``true`` or ``false``, or in the format ``number_format``."""
    if isinstance(fact, bool):
        return str(fact).lower()
    return number_format.format(fact)
