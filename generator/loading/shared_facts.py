"""Check that parts of the same name have the same facts in all specs of a manufacturer."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath

from ..language.document import Document, Path
from ..language.problems import ProblemReport, quoted
from ..language.rules.parts import by_name, by_part_name, has_erratum_at
from ..language.written import LocatedPart
from ..language.written_fields import WrittenField, WrittenRegister
from ..language.written_parts import WrittenSpec
from ..model import Crc
from .alike_facts import compare_connectors, compare_facts
from .cited_documents import check_cited_manuals, compare_documents

#: Facts that registers and CRCs with the same name share, with the format of numbers in messages.
_SHARED_FACT_FORMS = {
    "registers": {"address": "{:#04x}", "length": "{}", "bank": "{}", "access": "{}", "byte_order": "{}"},
    "crcs": {"width": "{}", "poly": "{:#x}", "init": "{:#x}", "refin": "{}", "refout": "{}", "xorout": "{:#x}"},
}
#: Path to a fact in its register or CRC, and the fact as text in messages: ``("address",), "0x48"``.
_Fact = tuple[Path, str]


def check_shared_facts(documents: Sequence[Document], report: ProblemReport) -> None:
    """Report differences in facts that should be the same in all devices of a manufacturer.

    The key ``alike`` in the manufacturer's file lists these facts, such as ``{"registers": ["preset"]}``. Files with
    problems are not compared.
    """
    specs = [document for document in documents if "device" in document.data and not report.faults(document)]
    for manufacturer_file in documents:
        if "device" in manufacturer_file.data or report.faults(manufacturer_file):
            continue
        alike_names = manufacturer_file.data.get("alike", {})
        manufacturer = manufacturer_file.data.get("manufacturer")
        specs_of_manufacturer = [spec for spec in specs if spec.data.get("manufacturer") == manufacturer]
        for section in _SHARED_FACT_FORMS:
            for part_name in alike_names.get(section, ()):
                specs_with_part = [spec for spec in specs_of_manufacturer if part_name in _parts_by_name(section, spec)]
                _report_different_facts(section, part_name, specs_with_part, report)
        compare_facts(alike_names.get("facts", ()), specs_of_manufacturer, report)
        compare_connectors(manufacturer_file, specs_of_manufacturer, report)
        compare_documents(specs_of_manufacturer, report)
        check_cited_manuals(specs_of_manufacturer, report)


def _parts_by_name(section: str, document: Document) -> Mapping[str, WrittenRegister | LocatedPart[Crc]]:
    """Return the parts in the section ``registers`` or ``crcs`` of a spec, by name."""
    spec = WrittenSpec(document.data)
    return by_name(spec.registers) if section == "registers" else by_part_name(spec.crcs)


def _report_different_facts(
    section: str, part_name: str, documents_with_fact: Sequence[Document], report: ProblemReport
) -> None:
    """Report each device in which a fact of a register or CRC differs from most devices.

    ``section`` is ``registers`` or ``crcs``. If several facts are equally common, the fact in the first file is
    correct. A difference is not reported if an erratum in one of the two devices affects it.
    """
    facts_by_key: dict[tuple[str, ...], list[tuple[Document, _Fact]]] = {}
    for document in sorted(documents_with_fact, key=lambda document: document.file):
        for key, fact in _shared_facts(section, _parts_by_name(section, document)[part_name]):
            facts_by_key.setdefault(key, []).append((document, fact))
    for key, facts in facts_by_key.items():
        affected_place = (section, part_name, *key)
        texts = [text for _, (_, text) in facts]
        ((common_text, _),) = Counter(texts).most_common(1)
        common_document, (common_path, _) = facts[texts.index(common_text)]
        if has_erratum_at(common_document, *affected_place):
            continue
        for document, (path, text) in facts:
            if text == common_text or has_erratum_at(document, *affected_place):
                continue
            line, _ = common_document.position((section, part_name, *common_path))
            message = (
                f"this is {text}, but {common_text} in {PurePath(common_document.file).name}:{line}; according to the"
                f" manufacturer's file, {quoted(part_name)} is the same in all devices. If it is not, add an erratum"
                f" that affects {'.'.join(affected_place)}"
            )
            report.add("not-alike", document, (section, part_name, *path), message)


def _shared_facts(
    section: str, register_or_crc: WrittenRegister | LocatedPart[Crc]
) -> Iterator[tuple[tuple[str, ...], _Fact]]:
    """Yield the facts of a register or CRC that devices share, each with its place in the notation of errata.

    That notation contains the names of fields, such as ``("warning", "at")``. The path of a fact in the spec contains
    their indices, such as ``("fields", 2, "at")``.
    """
    for key, form in _SHARED_FACT_FORMS[section].items():
        if key in register_or_crc.data:
            yield (key,), ((key,), _fact_text(form, register_or_crc.data[key]))
    if not isinstance(register_or_crc, WrittenRegister):
        return  # A CRC has no fields.
    for index, field in enumerate(register_or_crc.fields):
        if field.name:
            yield from _facts_of_field(field, ("fields", index))


def _facts_of_field(field: WrittenField, path: Path) -> Iterator[tuple[tuple[str, ...], _Fact]]:
    """Yield the facts of a field that devices share: its place, its width and its named values.

    Each comes with its place in the notation of errata, such as ``("warning", "at")``.
    """
    for key, number_or_text in (("at", field.at), ("bits", field.bits)):
        if number_or_text is not None:
            yield (field.name, key), ((*path, key), str(number_or_text))
    for value_name, value in field.values.items():
        yield (field.name, value_name, "value"), ((*path, "values", value_name, "value"), str(value.value))


def _fact_text(number_format: str, fact: object) -> str:
    """Return a fact as text for messages: ``true`` or ``false``, or in the format ``number_format``."""
    if isinstance(fact, bool):
        return str(fact).lower()
    return number_format.format(fact)
