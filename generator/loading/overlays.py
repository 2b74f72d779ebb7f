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
from ..language.overlay import SUFFIX, AppliedChange, LayeredSpec, LayerKind, OverlayLayer
from ..language.problems import Problem, ProblemReport, quoted, suggest_word
from ..model import LEFT_OUT, NOT_KNOWN, Device, Erratum, Overlay, layer_in_words
from ..order_codes.reduction import for_codes
from .change_titles import change_title
from .from_mapping import build_part

#: Largest number of places named in one sentence.
_MOST_NAMED = 8
#: Characters of a name that the name of an erratum cannot have.
_NOT_IN_NAMES = re.compile(r"[^a-z0-9]+")

#: Function that builds the family of a document and adds its problems to the report.
Build = Callable[[Document, ProblemReport], Device | None]


@dataclass(frozen=True, eq=False)
class Family:
    """A device with its spec, and the names of all files that it comes from, including its manufacturer's.

    ``plain`` is the same family without its overlays. ``content`` is the content of all files on which the device
    depends, for the key of a result. It is empty for a family with overlays, and if a file changed while it was read.
    """

    device: Device
    document: Document
    files: frozenset[str]
    plain: Family | None = None
    content: Sequence[bytes | str] = ()


def is_overlay(document: Document) -> bool:
    """Return True if the document has a key that only overlays have."""
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
    families: Sequence[Family], overlays: Sequence[Document], build: Build, report: ProblemReport
) -> list[Family]:
    """Return the families with their overlays applied, and those that overlays add, sorted by name.

    Valid overlays without ``applies_to`` are corrections. The corrected family replaces the plain one. The overlays for
    a special model add one family, to which the corrections apply too.

    Args:
        families: The families of the plain specs.
        overlays: The overlays, in the order of application.
        build: Builds the family of a document.
        report: Receives the problems of overlays and of their results.
    """
    # Overlays that are not valid are reported here, and not applied.
    valid_overlays = [overlay for overlay in overlays if check_overlay(overlay, report)]
    families_by_name = {family.device.name: family for family in families}
    for overlay in valid_overlays:
        if overlay.data["of"] not in families_by_name:
            hint = suggest_word(overlay.data["of"], families_by_name) or "; codewheel list shows the families"
            message = f"there is no family {quoted(overlay.data['of'])} among the specs that were read{hint}"
            report.add("undefined-reference", overlay, ("of",), message)
    _refuse_same_names(valid_overlays, report)
    resulting_families: list[Family] = []
    for name, family in families_by_name.items():
        # Together with the files of all its corrections, a family counts as faulty if one of them has a problem. So a
        # family with only some of its corrections, or none, is not mistaken for the corrected family.
        files_of_corrections = {overlay.file for overlay in overlays if _is_correction_of(name, overlay)}
        family_with_files = replace(family, files=family.files | files_of_corrections)
        overlays_of_family = [overlay for overlay in valid_overlays if overlay.data["of"] == name]
        corrections = [overlay for overlay in overlays_of_family if "applies_to" not in overlay.data]
        # None if there is no correction, or if the corrected family could not be built.
        corrected_family = _apply_overlays(family_with_files, corrections, "", build, report) if corrections else None
        resulting_families.append(corrected_family or family_with_files)
        for special_family in _special_families(family_with_files, overlays_of_family, corrections, build, report):
            special = special_family.device.name.removeprefix(f"{name}_")
            files = {overlay.file for overlay in overlays if _is_for_special_model(name, special, overlay)}
            resulting_families.append(replace(special_family, files=special_family.files | files))
    return sorted(resulting_families, key=lambda family: family.device.name)


def _is_correction_of(family_name: str, overlay: Document) -> bool:
    """Return True if an overlay, valid or not, is for the whole family of this name."""
    return "applies_to" not in overlay.data and overlay.data.get("of") == family_name


def _is_for_special_model(family_name: str, special: str, overlay: Document) -> bool:
    """Return True if an overlay, valid or not, is for the special model of the family of this name."""
    applies_to = overlay.data.get("applies_to")
    has_special = isinstance(applies_to, dict) and str(applies_to.get("special")).lower() == special
    return has_special and overlay.data.get("of") == family_name


def _special_families(
    family: Family, overlays: Sequence[Document], corrections: Sequence[Document], build: Build, report: ProblemReport
) -> Iterator[Family]:
    """Yield a family for each special model that the overlays of a family name, if it can be built.

    ``corrections`` are the overlays for the whole family. They are applied first.
    """
    overlays_by_special: dict[str, list[Document]] = {}
    for overlay in overlays:
        if "applies_to" in overlay.data:
            overlays_by_special.setdefault(overlay.data["applies_to"]["special"], []).append(overlay)
    for special, special_overlays in overlays_by_special.items():
        special_family = _apply_overlays(family, [*corrections, *special_overlays], special, build, report)
        if special_family is not None:
            yield special_family


def _refuse_same_names(overlays: Sequence[Document], report: ProblemReport) -> None:
    """Report each overlay with the name of an earlier overlay."""
    first_overlays: dict[str, Document] = {}
    for overlay in overlays:
        name = overlay.data["overlay"]
        first_overlay = first_overlays.setdefault(name, overlay)
        if first_overlay is not overlay:
            message = f"{Path(first_overlay.file).name} is also called {quoted(name)}"
            report.add("duplicate-name", overlay, ("overlay",), message)


def _layer_of(overlay: Document) -> OverlayLayer:
    return OverlayLayer(document=overlay, path=("changes",), kind=LayerKind.OVERLAY, name=overlay.data["overlay"])


def _apply_overlays(
    family: Family, overlays: Sequence[Document], special: str, build: Build, report: ProblemReport
) -> Family | None:
    """Return the family that results from applying overlays to another, or None if it cannot be built.

    ``special`` is the special model, such as ``S123``, or empty if the overlays replace the family itself. The errata
    of the result are the errata of the spec, of its editions, and of the applied changes. The counts of readings and
    the releases come from the family.
    """
    layered_spec = LayeredSpec(family.document, report)
    problems_before = len(report)
    layered_spec.apply([_layer_of(overlay) for overlay in overlays])
    name_of_special = f"{family.device.name}_{special.lower()}" if special else ""  # Such as x_24_s123.
    document = layered_spec.document(name_of_special)
    inner_report = ProblemReport()
    device = build(document, inner_report)
    # After a change that failed, problems of the result would only follow from it.
    if len(report) == problems_before:
        _report_in_overlay(inner_report, family.document, overlays[-1], report)
    if device is None:
        return None
    # ``build`` does not add the errata about other editions.
    errata_of_editions = [erratum for erratum in family.device.errata if erratum.edition]
    device = replace(
        device,
        errata=(*device.errata, *errata_of_editions, *errata_of(layered_spec.applied)),
        overlays=tuple(_build_overlay(overlay) for overlay in overlays),
        title=f"{device.title}, special models /{special}" if special else device.title,
        base=family.device.name if special else "",
        times_read=family.device.times_read,
        releases=family.device.releases,
    )
    if special:
        device = _reduce_to_listed_codes(device, overlays, report)
    files = family.files | {overlay.file for overlay in overlays}
    return Family(device, document, files, plain=None if special else family)


def _build_overlay(document: Document) -> Overlay:
    """Return the name and the title of an overlay, and the special model that it applies to, if any."""
    special = document.data.get("applies_to", {}).get("special", "")
    return Overlay(document.data["overlay"], document.data["title"], special)


def errata_of(applied_changes: Iterable[AppliedChange]) -> Iterator[Erratum]:
    """Yield the applied changes as errata, in the order of application.

    In an overlay, each change is one erratum. In an edition, the changes of all places that one entry of its list names
    are one erratum.
    """
    errata_counts: Counter[str] = Counter()
    for _, changes_together in groupby(applied_changes, key=_reported_together):
        changes = list(changes_together)
        first_change = changes[0]
        kind = first_change.layer.kind.value
        name = first_change.layer.name
        errata_counts[name] += 1
        # The entry in the spec or overlay, which all these changes have in common.
        definition = {"severity": "wrong_data", **first_change.raw}
        stated_facts: dict[str, object] = {
            key: definition[key] for key in ("severity", "why", "source") if key in definition
        }
        new_values = join_shortened([change.now for change in changes if change.now]) or LEFT_OUT
        former_texts = without_examples([change.was for change in changes])
        affected_paths: list[str] = []
        for change in changes:
            affected_paths += change.affects
        yield build_part(
            Erratum,
            stated_facts,  # The schema reports the rest.
            name=f"{_NOT_IN_NAMES.sub('_', f'{kind}_{name}'.removeprefix('overlay_'))}_{errata_counts[name]}",
            title=change_title(_layer_words(kind, name), former_texts),
            printed=join_shortened(former_texts),
            used=new_values if first_change.is_known else NOT_KNOWN,
            status="settled" if first_change.is_known else "open",
            affects=tuple(dict.fromkeys(affected_paths)),
            **{kind: name},
        )


def _layer_words(layer_kind: str, layer_name: str) -> str:
    """Return the overlay or the edition with the change in words. ``layer_kind`` is the value of its ``LayerKind``."""
    is_overlay = layer_kind == LayerKind.OVERLAY.value
    return layer_in_words(layer_name, "") if is_overlay else layer_in_words("", layer_name)


def _reported_together(change: AppliedChange) -> tuple[str, str, object]:
    """Return the key under which changes are reported as one erratum.

    In an edition, it is the entry in the list of changes. In an overlay, this is the change itself.
    """
    layer = change.layer
    if layer.kind is LayerKind.EDITION:
        return layer.kind.value, layer.name, (layer.path, change.number)
    return layer.kind.value, layer.name, change


def without_examples(names: Sequence[str]) -> Sequence[str]:
    """Return the names except names of examples, or all names if there are only examples."""
    return [name for name in names if not name.startswith("examples.")] or names


def join_shortened(names: Sequence[str]) -> str:
    """Return the names as text, each once, such as ``a, b`` for two names.

    Of more than nine names, only the first eight are listed, followed by the number of remaining names: ``and 3 more``.
    """
    unique_names = list(dict.fromkeys(names))
    omitted = len(unique_names) - _MOST_NAMED
    if omitted < 2:  # "and 1 more" is as long as the name.
        return ", ".join(unique_names)
    return f"{', '.join(unique_names[:_MOST_NAMED])} and {omitted} more"


def _reduce_to_listed_codes(device: Device, overlays: Sequence[Document], report: ProblemReport) -> Device:
    """Return the device with only the order codes that the overlays list under ``applies_to``.

    Report unknown order codes. If no known code is listed, the device keeps all of its codes.
    """
    known_codes = {variant.code for variant in device.variants}
    selected_codes: set[str] = set()
    for overlay in overlays:
        for index, code in enumerate(overlay.data.get("applies_to", {}).get("order_codes", ())):
            if code in known_codes:
                selected_codes.add(code)
                continue
            message = f"{quoted(code)} is not a listed order code of the family{suggest_word(code, known_codes)}"
            report.add("undefined-reference", overlay, ("applies_to", "order_codes", index), message)
    return for_codes(device, selected_codes) if selected_codes else device


def _report_in_overlay(inner_report: ProblemReport, spec: Document, overlay: Document, report: ProblemReport) -> None:
    """Report the problems of the resulting family that the spec itself does not have.

    Those in the spec are reported at the name of the overlay, with their place in the spec as part of the message.
    Others are reported where they are.
    """
    reported = set(report.problems)
    for problem in inner_report.problems:
        if problem.file == spec.file and problem not in reported:
            spec_name = Path(spec.file).name
            location = f"{spec_name}:{problem.line}, {problem.path}" if problem.path else spec_name
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


def _report_problem(problem: Problem, overlay: Document, message: str, report: ProblemReport) -> None:
    """Report a problem at the name of an overlay, under the same rule."""
    report.add(problem.rule, overlay, ("overlay",), message)
