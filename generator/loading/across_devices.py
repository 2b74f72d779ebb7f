"""Compare facts that all devices of a manufacturer share. If two differ, one of them is a mistake."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePath

from ..language.document import Document
from ..language.problems import Path, Report, quoted
from ..language.rules.walk import Spec, by_name, explained, items, mapping

#: Shared facts of registers and CRCs with one name, with the format of numbers in messages.
_COMMON = {
    "registers": {"address": "{:#04x}", "length": "{}", "bank": "{}", "access": "{}", "byte_order": "{}"},
    "crcs": {"width": "{}", "poly": "{:#x}", "init": "{:#x}", "refin": "{}", "refout": "{}", "xorout": "{:#x}"},
}
#: Path to a fact, and the fact as shown in messages.
_Fact = tuple[Path, str]


def check_shared_facts(documents: Sequence[Document], report: Report) -> None:
    """Report differences between devices of a manufacturer in facts that its file lists under ``alike``."""
    devices = [document for document in documents if "device" in document.data and not report.faults(document)]
    for maker in documents:
        alike_names = mapping(maker.data, "alike") if "device" not in maker.data and not report.faults(maker) else {}
        name = maker.data.get("manufacturer")
        of_maker = [device for device in devices if device.data.get("manufacturer") == name]
        for kind, names in alike_names.items():
            for name in names:
                _compare(
                    kind, name, [document for document in of_maker if name in by_name(document.data, kind)], report
                )


def _compare(kind: str, name: str, documents_with_fact: Sequence[Document], report: Report) -> None:
    """Compare each device with the first one that has the fact."""
    first: dict[tuple[str, ...], tuple[Document, _Fact]] = {}
    for document in sorted(documents_with_fact, key=lambda document: document.file):
        for key, fact in _facts(kind, by_name(document.data, kind)[name]):
            first_document, (first_path, first_text) = first.setdefault(key, (document, fact))
            affected = (kind, name, *key)
            if first_text == fact[1] or explained(document, *affected) or explained(first_document, *affected):
                continue
            line = first_document.position((kind, name, *first_path))[0]
            message = (
                f"this is {fact[1]}, but {first_text} in {PurePath(first_document.file).name}:{line}; according to the"
                f" manufacturer's file, {quoted(name)} is the same in all devices. If it is not, add an erratum that"
                f" affects {'.'.join(affected)}"
            )
            report.add("not-alike", document, (kind, name, *fact[0]), message)


def _facts(kind: str, definition: Spec) -> Iterator[tuple[tuple[str, ...], _Fact]]:
    """Yield the shared facts of an item, by the path that an erratum would have."""
    for key, form in _COMMON[kind].items():
        if key in definition:
            yield (key,), ((key,), _fact_text(form, definition[key]))
    for path, field in items(definition, "fields"):
        name = field.get("name")
        if isinstance(name, str):
            yield from (((name, key), ((*path, key), str(field[key]))) for key in ("at", "bits") if key in field)
            for value_name, value in mapping(field, "values").items():
                yield (name, value_name, "value"), ((*path, "values", value_name, "value"), str(value["value"]))


def _fact_text(form: str, value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else form.format(value)
