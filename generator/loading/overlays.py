"""Apply overlays to families.

The result of an overlay for the whole family replaces the family. An overlay for a special model, whose order code
ends in /Sxxx, results in an additional family.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path

from ..language.check import check_overlay
from ..language.document import Document
from ..language.overlay import SUFFIX, AppliedChange, Layer, LayeredSpec, LayerKind
from ..language.problems import Problem, Report, quoted, suggestion
from ..model import LEFT_OUT, NOT_KNOWN, Device, Erratum, Overlay
from ..order_codes.narrowing import for_codes
from .from_mapping import record

#: Largest number of places named in one sentence.
_MOST_NAMED = 8
_WORD = re.compile(r"[^a-z0-9]+")

#: Function that builds the family of a document and adds its problems to the report.
Build = Callable[[Document, Report], Device | None]


@dataclass(frozen=True, eq=False)
class Family:
    """A device with its spec, and the names of all files that it comes from, including its manufacturer's.

    ``plain`` is the same family without its overlays. ``content`` is that of all files on which the device depends,
    for the key of a result. It is empty for a family with overlays, and if a file changed while it was read.
    ``digest`` is that of the device if it is known.
    """

    device: Device
    document: Document
    files: frozenset[str]
    plain: Family | None = None
    content: Sequence[bytes | str] = ()
    digest: str = ""


def is_overlay(document: Document) -> bool:
    return "overlay" in document.data or "changes" in document.data


def overlays_beside(documents: Iterable[Document]) -> list[Path]:
    """Return the files next to specs that are their overlays by name, such as ``FAMILY.overlay.yaml``."""
    found: list[Path] = []
    for document in documents:
        spec = Path(document.file)
        if "device" in document.data and spec.parent.is_dir():
            named = (path for path in spec.parent.iterdir() if path.suffix == spec.suffix)
            mine = (path for path in named if path.stem.endswith(SUFFIX) and path.stem.startswith(f"{spec.stem}."))
            found += sorted(mine)
    return found


def lay_over(families: Sequence[Family], overlays: Sequence[Document], build: Build, report: Report) -> list[Family]:
    """Return the families with their overlays applied, and those that overlays add, sorted by name.

    Args:
        families: The families of the plain specs.
        overlays: The overlays, in the order of application.
        build: Builds the family of a document.
        report: Receives the problems of overlays and of their results.
    """
    sound = [item for item in overlays if check_overlay(item, report)]
    by_name = {family.device.name: family for family in families}
    for item in sound:
        if item.data["of"] not in by_name:
            hint = suggestion(item.data["of"], by_name)
            wrong = f"there is no family {quoted(item.data['of'])} among the specs that were read{hint}"
            report.add("undefined-reference", item, ("of",), wrong)
    _refuse_same_names(sound, report)
    made: list[Family] = []
    for name, family in by_name.items():
        mine = [item for item in sound if item.data["of"] == name]
        for_all = [item for item in mine if "applies_to" not in item.data]
        changed = _laid(family, for_all, "", build, report) if for_all else None
        # If a correction fails, the family must not be mistaken for a corrected one.
        files = {item.file for item in overlays if item.data.get("of") == name and "applies_to" not in item.data}
        made.append(changed or replace(family, files=family.files | files))
        specials = dict.fromkeys(item.data["applies_to"]["special"] for item in mine if "applies_to" in item.data)
        for special in specials:
            of_it = [item for item in mine if item.data.get("applies_to", {}).get("special") == special]
            special_family = _laid(family, [*for_all, *of_it], special, build, report)
            made += [special_family] if special_family is not None else []
    return sorted(made, key=lambda family: family.device.name)


def _refuse_same_names(overlays: Sequence[Document], report: Report) -> None:
    first: dict[str, Document] = {}
    for item in overlays:
        other = first.setdefault(item.data["overlay"], item)
        if other is not item:
            wrong = f"{Path(other.file).name} is also called {quoted(item.data['overlay'])}"
            report.add("duplicate-name", item, ("overlay",), wrong)


def _laid(family: Family, overlays: Sequence[Document], special: str, build: Build, report: Report) -> Family | None:
    """Return the family that results from applying overlays to another."""
    laying = LayeredSpec(family.document, report)
    before = len(report)
    laying.apply([Layer(item, ("changes",), LayerKind.OVERLAY, item.data["overlay"]) for item in overlays])
    document = laying.document(f"{family.device.name}_{special.lower()}" if special else "")
    inside = Report()
    device = build(document, inside)
    if len(report) == before:  # Changes that failed would look like missing parts.
        _hand_on(inside, family.document, overlays[-1], report)
    if device is None:
        return None
    device = replace(
        device,
        errata=(*device.errata, *(item for item in family.device.errata if item.edition), *errata_of(laying.applied)),
        overlays=tuple(_overlay(item) for item in overlays),
        title=f"{device.title}, special models /{special}" if special else device.title,
        base=family.device.name if special else "",
        times_read=family.device.times_read,
    )
    if special:
        device = _of_codes(device, overlays, report)
    files = family.files | {item.file for item in overlays}
    return Family(device, document, files, plain=None if special else family)


def _overlay(document: Document) -> Overlay:
    special = document.data.get("applies_to", {}).get("special", "")
    return Overlay(document.data["overlay"], document.data["title"], special)


def errata_of(laid: Iterable[AppliedChange]) -> Iterator[Erratum]:
    """Yield the changes as errata: one by one, or for an edition one for all changes with the same reason."""
    numbers: Counter[str] = Counter()
    for (kind, name, _), found in groupby(laid, key=_one_story):
        items = list(found)
        numbers[name] += 1
        told = {"severity": "wrong_data", **items[0].raw}
        yield record(
            Erratum,
            {key: told[key] for key in ("severity", "why", "source") if key in told},  # The schema reports the rest.
            name=f"{_WORD.sub('_', f'{kind}_{name}'.removeprefix('overlay_'))}_{numbers[name]}",
            printed=few(without_examples([item.was for item in items])),
            used=(few([item.now for item in items if item.now]) or LEFT_OUT) if items[0].is_known else NOT_KNOWN,
            status="settled" if items[0].is_known else "open",
            affects=tuple(dict.fromkeys(path for item in items for path in item.affects)),
            **{kind: name},
        )


def _one_story(item: AppliedChange) -> tuple[str, str, object]:
    """Return the key of items that are reported together."""
    layer = item.layer
    return layer.kind.value, layer.name, (layer.path, item.number) if layer.kind is LayerKind.EDITION else item


def without_examples(names: Sequence[str]) -> Sequence[str]:
    """Return the names except those of examples, or all names if there are only examples."""
    return [name for name in names if not name.startswith("examples.")] or names


def few(names: Sequence[str]) -> str:
    """Return the names as text, shortened to the first ones and the number of the others."""
    listed = list(dict.fromkeys(names))
    more = len(listed) - _MOST_NAMED
    return ", ".join(listed if more < 2 else listed[:_MOST_NAMED]) + (f" and {more} more" if more >= 2 else "")


def _of_codes(device: Device, overlays: Sequence[Document], report: Report) -> Device:
    """Return the device with only the order codes that the overlays apply to."""
    known = {variant.code for variant in device.variants}
    wanted: set[str] = set()
    for item in overlays:
        codes = item.data.get("applies_to", {}).get("order_codes", ())
        for index, code in enumerate(codes):
            if code not in known:
                wrong = f"{quoted(code)} is not a listed order code of the family{suggestion(code, known)}"
                report.add("undefined-reference", item, ("applies_to", "order_codes", index), wrong)
        wanted |= set(codes)
    return for_codes(device, wanted & known) if wanted & known else device


def _hand_on(inside: Report, spec: Document, overlay: Document, report: Report) -> None:
    """Report the problems of the resulting family in the overlay, even if they are located in the spec."""
    known = set(report.problems)
    for item in inside.problems:
        if item.file == spec.file and item not in known:
            where = f"{Path(spec.file).name}:{item.line}, {item.path}" if item.path else Path(spec.file).name
            _tell(item, overlay, f"with this overlay, {where}: {item.message}", report)
        elif item not in known:
            report.add_at(item.file, item.line, item.column, item.rule, item.message, path=item.path, text=item.text)


def _tell(item: Problem, overlay: Document, message: str, report: Report) -> None:
    report.add(item.rule, overlay, ("overlay",), message)
