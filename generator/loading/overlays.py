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
from ..model import LEFT_OUT, NOT_KNOWN, Device, Erratum, Overlay, layer_in_words
from ..order_codes.reduction import for_codes
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
    """

    device: Device
    document: Document
    files: frozenset[str]
    plain: Family | None = None
    content: Sequence[bytes | str] = ()


def is_overlay(document: Document) -> bool:
    return "overlay" in document.data or "changes" in document.data


def overlays_beside(documents: Iterable[Document]) -> list[Path]:
    """Return the files next to specs that are their overlays by name, such as ``FAMILY.overlay.yaml``."""
    overlays: list[Path] = []
    for document in documents:
        spec = Path(document.file)
        if "device" in document.data and spec.parent.is_dir():
            overlays += sorted(path for path in spec.parent.iterdir() if _is_overlay_of(path, spec))
    return overlays


def _is_overlay_of(path: Path, spec: Path) -> bool:
    """Return True if a file is an overlay of a spec by its name."""
    return path.suffix == spec.suffix and path.stem.endswith(SUFFIX) and path.stem.startswith(f"{spec.stem}.")


def apply_overlays(
    families: Sequence[Family], overlays: Sequence[Document], build: Build, report: Report
) -> list[Family]:
    """Return the families with their overlays applied, and those that overlays add, sorted by name.

    Args:
        families: The families of the plain specs.
        overlays: The overlays, in the order of application.
        build: Builds the family of a document.
        report: Receives the problems of overlays and of their results.
    """
    valid_overlays = [overlay for overlay in overlays if check_overlay(overlay, report)]
    by_name = {family.device.name: family for family in families}
    for overlay in valid_overlays:
        if overlay.data["of"] not in by_name:
            hint = suggestion(overlay.data["of"], by_name) or "; codewheel list shows the families"
            message = f"there is no family {quoted(overlay.data['of'])} among the specs that were read{hint}"
            report.add("undefined-reference", overlay, ("of",), message)
    _refuse_same_names(valid_overlays, report)
    results: list[Family] = []
    for name, family in by_name.items():
        own_overlays = [overlay for overlay in valid_overlays if overlay.data["of"] == name]
        for_all = [overlay for overlay in own_overlays if "applies_to" not in overlay.data]
        changed = _with_overlays(family, for_all, "", build, report) if for_all else None
        # If a correction fails, the family must not be mistaken for a corrected one.
        corrections = [overlay for overlay in overlays if "applies_to" not in overlay.data]
        files = {overlay.file for overlay in corrections if overlay.data.get("of") == name}
        results.append(changed or replace(family, files=family.files | files))
        for_specials: dict[str, list[Document]] = {}
        for overlay in own_overlays:
            if "applies_to" in overlay.data:
                for_specials.setdefault(overlay.data["applies_to"]["special"], []).append(overlay)
        for special, for_special in for_specials.items():
            special_family = _with_overlays(family, [*for_all, *for_special], special, build, report)
            results += [special_family] if special_family is not None else []
    return sorted(results, key=lambda family: family.device.name)


def _refuse_same_names(overlays: Sequence[Document], report: Report) -> None:
    first: dict[str, Document] = {}
    for overlay in overlays:
        first_overlay = first.setdefault(overlay.data["overlay"], overlay)
        if first_overlay is not overlay:
            message = f"{Path(first_overlay.file).name} is also called {quoted(overlay.data['overlay'])}"
            report.add("duplicate-name", overlay, ("overlay",), message)


def _with_overlays(
    family: Family, overlays: Sequence[Document], special: str, build: Build, report: Report
) -> Family | None:
    """Return the family that results from applying overlays to another."""
    laying = LayeredSpec(family.document, report)
    problems_before = len(report)
    laying.apply([Layer(overlay, ("changes",), LayerKind.OVERLAY, overlay.data["overlay"]) for overlay in overlays])
    document = laying.document(f"{family.device.name}_{special.lower()}" if special else "")
    inner_report = Report()
    device = build(document, inner_report)
    if len(report) == problems_before:  # Changes that failed would look like missing parts.
        _report_in_overlay(inner_report, family.document, overlays[-1], report)
    if device is None:
        return None
    device = replace(
        device,
        errata=(
            *device.errata,
            *(erratum for erratum in family.device.errata if erratum.edition),
            *errata_of(laying.applied),
        ),
        overlays=tuple(_overlay(overlay) for overlay in overlays),
        title=f"{device.title}, special models /{special}" if special else device.title,
        base=family.device.name if special else "",
        times_read=family.device.times_read,
    )
    if special:
        device = _of_codes(device, overlays, report)
    files = family.files | {overlay.file for overlay in overlays}
    return Family(device, document, files, plain=None if special else family)


def _overlay(document: Document) -> Overlay:
    special = document.data.get("applies_to", {}).get("special", "")
    return Overlay(document.data["overlay"], document.data["title"], special)


def errata_of(laid: Iterable[AppliedChange]) -> Iterator[Erratum]:
    """Yield the changes as errata: one by one, or for an edition one for all changes with the same reason."""
    numbers: Counter[str] = Counter()
    for (kind, name, _), same_reason in groupby(laid, key=_reported_together):
        changes = list(same_reason)
        numbers[name] += 1
        definition = {"severity": "wrong_data", **changes[0].raw}
        prose: dict[str, object] = {key: definition[key] for key in ("severity", "why", "source") if key in definition}
        is_known = changes[0].is_known
        new_values = shortened([change.now for change in changes if change.now]) or LEFT_OUT
        yield record(
            Erratum,
            prose,  # The schema reports the rest.
            name=f"{_WORD.sub('_', f'{kind}_{name}'.removeprefix('overlay_'))}_{numbers[name]}",
            title=_title(kind, name, numbers[name]),
            printed=shortened(without_examples([change.was for change in changes])),
            used=new_values if is_known else NOT_KNOWN,
            status="settled" if is_known else "open",
            affects=tuple(dict.fromkeys(path for change in changes for path in change.affects)),
            **{kind: name},
        )


def _title(kind: str, layer_name: str, number: int) -> str:
    """Return the title of a change: ``Overlay tv62.s042, change 1``."""
    if kind == LayerKind.OVERLAY.value:
        return f"{layer_in_words(layer_name, '')}, change {number}"
    return f"{layer_in_words('', layer_name)}, difference {number}"


def _reported_together(change: AppliedChange) -> tuple[str, str, object]:
    """Return the key of items that are reported together."""
    layer = change.layer
    return layer.kind.value, layer.name, (layer.path, change.number) if layer.kind is LayerKind.EDITION else change


def without_examples(names: Sequence[str]) -> Sequence[str]:
    """Return the names except those of examples, or all names if there are only examples."""
    return [name for name in names if not name.startswith("examples.")] or names


def shortened(names: Sequence[str]) -> str:
    """Return the names as text, shortened to the first ones and the number of the others."""
    unique_names = list(dict.fromkeys(names))
    omitted = len(unique_names) - _MOST_NAMED
    return ", ".join(unique_names if omitted < 2 else unique_names[:_MOST_NAMED]) + (
        f" and {omitted} more" if omitted >= 2 else ""
    )


def _of_codes(device: Device, overlays: Sequence[Document], report: Report) -> Device:
    """Return the device with only the order codes that the overlays apply to."""
    known_codes = {variant.code for variant in device.variants}
    wanted: set[str] = set()
    for overlay in overlays:
        codes = overlay.data.get("applies_to", {}).get("order_codes", ())
        for index, code in enumerate(codes):
            if code not in known_codes:
                message = f"{quoted(code)} is not a listed order code of the family{suggestion(code, known_codes)}"
                report.add("undefined-reference", overlay, ("applies_to", "order_codes", index), message)
        wanted |= set(codes)
    return for_codes(device, wanted & known_codes) if wanted & known_codes else device


def _report_in_overlay(inner_report: Report, spec: Document, overlay: Document, report: Report) -> None:
    """Report the problems of the resulting family in the overlay, even if they are located in the spec."""
    reported = set(report.problems)
    for problem in inner_report.problems:
        if problem.file == spec.file and problem not in reported:
            location = (
                f"{Path(spec.file).name}:{problem.line}, {problem.path}" if problem.path else Path(spec.file).name
            )
            _report_problem(problem, overlay, f"with this overlay, {location}: {problem.message}", report)
        elif problem not in reported:
            report.add_at(
                problem.file,
                problem.line,
                problem.column,
                problem.rule,
                problem.message,
                path=problem.path,
                text=problem.text,
            )


def _report_problem(problem: Problem, overlay: Document, message: str, report: Report) -> None:
    report.add(problem.rule, overlay, ("overlay",), message)
