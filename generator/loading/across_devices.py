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


def check_alike(documents: Sequence[Document], report: Report) -> None:
    """Report differences between devices of a manufacturer in facts that its file lists under ``alike``."""
    devices = [item for item in documents if "device" in item.data and not report.faults(item)]
    for maker in documents:
        listed = mapping(maker.data, "alike") if "device" not in maker.data and not report.faults(maker) else {}
        of_maker = [item for item in devices if item.data.get("manufacturer") == maker.data.get("manufacturer")]
        for kind, names in listed.items():
            for name in names:
                _compare(kind, name, [item for item in of_maker if name in by_name(item.data, kind)], report)


def _compare(kind: str, name: str, having: Sequence[Document], report: Report) -> None:
    """Compare each device with the first one that has the fact."""
    first: dict[tuple[str, ...], tuple[Document, _Fact]] = {}
    for document in sorted(having, key=lambda item: item.file):
        for key, fact in _facts(kind, by_name(document.data, kind)[name]):
            other, (place, shown) = first.setdefault(key, (document, fact))
            named = (kind, name, *key)
            if shown == fact[1] or explained(document, *named) or explained(other, *named):
                continue
            line = other.position((kind, name, *place))[0]
            wrong = (
                f"this is {fact[1]}, but {shown} in {PurePath(other.file).name}:{line}; according to the"
                f" manufacturer's file, {quoted(name)} is the same in all devices. If it is not, add an erratum that"
                f" affects {'.'.join(named)}"
            )
            report.add("not-alike", document, (kind, name, *fact[0]), wrong)


def _facts(kind: str, item: Spec) -> Iterator[tuple[tuple[str, ...], _Fact]]:
    """Yield the shared facts of an item, by the path that an erratum would have."""
    for key, form in _COMMON[kind].items():
        if key in item:
            yield (key,), ((key,), _shown(form, item[key]))
    for path, field in items(item, "fields"):
        name = field.get("name")
        if isinstance(name, str):
            yield from (((name, key), ((*path, key), str(field[key]))) for key in ("at", "bits") if key in field)
            for word, value in mapping(field, "values").items():
                yield (name, word, "value"), ((*path, "values", word, "value"), str(value["value"]))


def _shown(form: str, value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else form.format(value)
