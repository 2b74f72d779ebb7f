"""What a manufacturer has at the same place in every device: where two differ, one of them is a slip."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePath

from ..language.document import Document
from ..language.problems import Path, Report, quoted
from ..language.rules.walk import Spec, by_name, explained, items, mapping

#: What a register or a CRC of one name has in common, with the form in which a message shows a number.
_COMMON = {
    "registers": {"address": "{:#04x}", "length": "{}", "bank": "{}", "access": "{}", "byte_order": "{}"},
    "crcs": {"width": "{}", "poly": "{:#x}", "init": "{:#x}", "refin": "{}", "refout": "{}", "xorout": "{:#x}"},
}
#: A path to a fact, and the fact as a message shows it.
_Fact = tuple[Path, str]


def check_alike(documents: Sequence[Document], report: Report) -> None:
    """Reports what differs between two devices of a manufacturer whose file lists it under ``alike``."""
    devices = [item for item in documents if "device" in item.data and not report.faults(item)]
    for maker in documents:
        listed = mapping(maker.data, "alike") if "device" not in maker.data and not report.faults(maker) else {}
        of_maker = [item for item in devices if item.data.get("manufacturer") == maker.data.get("manufacturer")]
        for kind, names in listed.items():
            for name in names:
                _compare(kind, name, [item for item in of_maker if name in by_name(item.data, kind)], report)


def _compare(kind: str, name: str, having: Sequence[Document], report: Report) -> None:
    """Holds each device against the first that has the fact."""
    first: dict[tuple[str, ...], tuple[Document, _Fact]] = {}
    for document in sorted(having, key=lambda item: item.file):
        for key, fact in _facts(kind, by_name(document.data, kind)[name]):
            other, (place, shown) = first.setdefault(key, (document, fact))
            named = (kind, name, *key)
            if shown == fact[1] or explained(document.data, *named) or explained(other.data, *named):
                continue
            line = other.position((kind, name, *place))[0]
            wrong = (
                f"this is {fact[1]}, and {shown} in {PurePath(other.file).name}:{line}; by the manufacturer's file"
                f" {quoted(name)} is alike in all devices. Where it is not, an erratum that affects {'.'.join(named)}"
                " says why"
            )
            report.add("not-alike", document, (kind, name, *fact[0]), wrong)


def _facts(kind: str, item: Spec) -> Iterator[tuple[tuple[str, ...], _Fact]]:
    """What an item has in common with others of its name, by the path that an erratum would have."""
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
