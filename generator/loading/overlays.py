"""Apply overlays to families, and give titles to the changes of overlays and editions.

The result of an overlay for the whole family replaces the family. An overlay for a special model, whose order code
ends in /Sxxx, results in an additional family.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path

from ..language.check import check_overlay
from ..language.document import Document
from ..language.overlay import SUFFIX, AppliedChange, LayeredSpec, LayerKind, OverlayLayer
from ..language.problems import Problem, ProblemReport, join_words, quoted, suggest_word
from ..model import LEFT_OUT, NOT_KNOWN, Biss, Device, Erratum, Overlay, Rs485, Spi, Ssi, layer_in_words
from ..order_codes.reduction import for_codes
from .spec_parts import build_part

#: Highest number of changed places in a title.
_MAX_PLACES = 3
#: A path in a spec, which a colon and the former value may follow.
_PATH_IN_TITLE = re.compile(r"([\w-]+(?:\[\d+\])?(?:\.[\w-]+(?:\[\d+\])?)*)(?:: .*)?", re.DOTALL)
_LIST_POSITION = re.compile(r"\[\d+\]")
#: Steps of a path that only lead to named items, and are left out of titles.
_STEPS_LEFT_OUT = {"parts", "values", "fields", "contacts", "timings"}
#: Keys that end a path, as phrases before the name of their owner.
_KEY_PHRASES = {
    "implemented": "implementation of {}",
    "interfaces": "{} interfaces",
    "meaning": "meaning of {}",
    "note": "note on {}",
    "when_active": "active state of {}",
}
#: Words in names that prose spells differently.
_SPELLINGS_IN_PROSE = {"crc": "CRC", "eeprom": "EEPROM", "id": "ID", "led": "LED"}
_SPELLINGS_IN_PROSE |= {interface.name: interface.short for interface in (Ssi, Biss, Rs485, Spi)}
#: Sections whose items are known by their own names.
_SECTIONS_OF_NAMED_ITEMS = {
    "alarms",
    "alternatives",
    "characteristics",
    "connectors",
    "crcs",
    "examples",
    "field_groups",
    "interfaces",
    "leds",
    "parameters",
    "procedures",
    "registers",
}


def change_title(layer_words: str, changed_places: Sequence[str]) -> str:
    """Return a title with the overlay or edition and the parts that it changes: ``Before edition 1.7: serial number``.

    ``changed_places`` are sentences, or paths in the spec, optionally with a colon and the former value. If there are
    more than three parts, the title names two and "others".
    """
    part_names = list(dict.fromkeys(map(_place_name, changed_places)))
    if len(part_names) > _MAX_PLACES:
        part_names = [*part_names[: _MAX_PLACES - 1], "others"]
    return f"{layer_words}: {join_words(part_names)}"


def _place_name(path_text: str) -> str:
    """Return the name of the part at a path in words, such as ``preset max`` for ``registers.preset.max: 15``.

    Steps of the path that only lead to named items are left out. The section is also left out if its items are known by
    their own names. A final key comes first: ``note on configuration``. A sentence is returned as it is.
    """
    path_match = _PATH_IN_TITLE.fullmatch(path_text)
    if path_match is None:
        return path_text
    steps = [_LIST_POSITION.sub("", step) for step in path_match[1].split(".") if step not in _STEPS_LEFT_OUT]
    section, *named_steps = steps  # For registers.preset.max, the section is registers.
    if section == "order_code" and named_steps:
        is_spelling = named_steps[0] == "also_written"
        part_name = "other spellings" if is_spelling else _steps_in_words(named_steps[0])
        return f"order code ({part_name})"
    if not named_steps or section not in _SECTIONS_OF_NAMED_ITEMS:
        named_steps = steps
    if section == "field_groups" and len(named_steps) > 1:
        named_steps = named_steps[1:]  # A field of a group is known without the name of the group.
    if len(named_steps) > 1 and named_steps[-1] in _KEY_PHRASES:
        *owner_names, last_step = named_steps
        return _KEY_PHRASES[last_step].format(_steps_in_words(*owner_names))
    if section == "connectors" and len(named_steps) > 1:
        connector, contact = named_steps[:2]
        return f"contact {contact} of the {_steps_in_words(connector)}"
    if section == "examples":
        return f"example {_steps_in_words(*named_steps)}"
    return _steps_in_words(*named_steps)


def _steps_in_words(*steps: str) -> str:
    """Return the steps of a path as words, with abbreviations in their usual spelling."""
    words = " ".join(steps).replace("_", " ").split()
    return " ".join(_SPELLINGS_IN_PROSE.get(word, word) for word in words)


#: Highest number of places that are named in one sentence.
_MAX_NAMES = 8
#: Characters that the name of an erratum cannot contain.
_NOT_IN_NAMES = re.compile(r"[^a-z0-9]+")

#: Function that builds the family of a document and adds its problems to the report.
Build = Callable[[Document, ProblemReport], Device | None]


@dataclass(frozen=True, eq=False)
class Family:
    """A device with its spec, and the names of all files that it comes from, including its manufacturer's file."""

    device: Device
    document: Document
    files: frozenset[str]
    #: The same family without its overlays, or None if it has none.
    without_overlays: Family | None = None
    #: Content of all files on which the device depends, from which the key of a cached result is computed. It is empty
    #: for a family with overlays, and if a file changed while it was read.
    content: Sequence[bytes | str] = ()


def is_overlay(document: Document) -> bool:
    """Return whether a document is an overlay, which changes the spec of a family. Only overlays have these keys."""
    return "overlay" in document.data or "changes" in document.data


def overlays_beside(documents: Iterable[Document]) -> list[Path]:
    """Return the files next to specs that are overlays by their names, such as ``FAMILY.overlay.yaml``."""
    overlay_paths: list[Path] = []
    for document in documents:
        spec_path = Path(document.file)
        is_spec = "device" in document.data  # Otherwise it is the file of a manufacturer.
        if is_spec and spec_path.parent.is_dir():
            overlay_paths += sorted(path for path in spec_path.parent.iterdir() if _is_overlay_of(path, spec_path))
    return overlay_paths


def _is_overlay_of(path: Path, spec: Path) -> bool:
    """Return whether a file is an overlay of a spec by its name, such as ``FAMILY.overlay.yaml``."""
    return path.suffix == spec.suffix and path.stem.endswith(SUFFIX) and path.stem.startswith(f"{spec.stem}.")


def apply_overlays(
    families: Sequence[Family], overlays: Sequence[Document], build: Build, report: ProblemReport
) -> list[Family]:
    """Return the families with their overlays applied, and the families that overlays add, sorted by name.

    Overlays without ``applies_to`` are corrections for the whole family. The corrected family replaces the original.
    Overlays for a special model add a family, to which the corrections also apply.

    Args:
        families: The families without overlays.
        overlays: The overlays, in the order in which they are applied.
        build: Builds the family of a document.
        report: Receives the problems of overlays and of their results.
    """
    # Overlays that are not valid are reported, and not applied.
    valid_overlays = [overlay for overlay in overlays if check_overlay(overlay, report)]
    families_by_name = {family.device.name: family for family in families}
    _report_unknown_families(valid_overlays, families_by_name, report)
    _report_repeated_names(valid_overlays, report)
    resulting_families: list[Family] = []
    for family_name, family in families_by_name.items():
        # The files of a family include those of all its corrections. If one of them has a problem, the family counts as
        # faulty, so that a family without all of its corrections is not used.
        files_of_corrections = {overlay.file for overlay in overlays if _is_correction_of(family_name, overlay)}
        family_with_files = replace(family, files=family.files | files_of_corrections)
        overlays_of_family = [overlay for overlay in valid_overlays if overlay.data["of"] == family_name]
        corrections = [overlay for overlay in overlays_of_family if "applies_to" not in overlay.data]
        corrected_family = None
        if corrections:
            corrected_family = _apply_overlays(family_with_files, corrections, "", build, report)
        resulting_families.append(corrected_family or family_with_files)
        for special_family in _special_families(family_with_files, overlays_of_family, corrections, build, report):
            special_name = special_family.device.name.removeprefix(f"{family_name}_")
            files_of_special = {
                overlay.file for overlay in overlays if _is_for_special_model(family_name, special_name, overlay)
            }
            resulting_families.append(replace(special_family, files=special_family.files | files_of_special))
    return sorted(resulting_families, key=lambda family: family.device.name)


def _report_unknown_families(
    overlays: Iterable[Document], families_by_name: Mapping[str, Family], report: ProblemReport
) -> None:
    """Report each overlay for a family that is not among the families that were read."""
    for overlay in overlays:
        if overlay.data["of"] not in families_by_name:
            hint = suggest_word(overlay.data["of"], families_by_name) or "; codewheel list shows the families"
            message = f"there is no family {quoted(overlay.data['of'])} among the specs that were read{hint}"
            report.add("undefined-reference", overlay, ("of",), message)


def _is_correction_of(family_name: str, overlay: Document) -> bool:
    """Return whether an overlay, valid or not, corrects a whole family."""
    return "applies_to" not in overlay.data and overlay.data.get("of") == family_name


def _is_for_special_model(family_name: str, special: str, overlay: Document) -> bool:
    """Return whether an overlay, valid or not, is for a special model of a family."""
    applies_to = overlay.data.get("applies_to")
    has_special = isinstance(applies_to, dict) and str(applies_to.get("special")).lower() == special
    return has_special and overlay.data.get("of") == family_name


def _special_families(
    family: Family, overlays: Sequence[Document], corrections: Sequence[Document], build: Build, report: ProblemReport
) -> Iterator[Family]:
    """Yield a family for each special model that the overlays of a family name, if it can be built.

    ``corrections`` are the overlays for the whole family. They are applied first.
    """
    overlays_by_special_name: dict[str, list[Document]] = {}
    for overlay in overlays:
        if "applies_to" in overlay.data:
            overlays_by_special_name.setdefault(overlay.data["applies_to"]["special"], []).append(overlay)
    for special_name, special_overlays in overlays_by_special_name.items():
        special_family = _apply_overlays(family, [*corrections, *special_overlays], special_name, build, report)
        if special_family is not None:
            yield special_family


def _report_repeated_names(overlays: Sequence[Document], report: ProblemReport) -> None:
    """Report each overlay with the name of an earlier overlay."""
    first_overlay_by_name: dict[str, Document] = {}
    for overlay in overlays:
        overlay_name = overlay.data["overlay"]
        first_overlay = first_overlay_by_name.setdefault(overlay_name, overlay)
        if first_overlay is not overlay:
            message = f"{Path(first_overlay.file).name} is also called {quoted(overlay_name)}"
            report.add("duplicate-name", overlay, ("overlay",), message)


def _layer_of(overlay: Document) -> OverlayLayer:
    return OverlayLayer(document=overlay, path=("changes",), kind=LayerKind.OVERLAY, name=overlay.data["overlay"])


def _apply_overlays(
    family: Family, overlays: Sequence[Document], special_name: str, build: Build, report: ProblemReport
) -> Family | None:
    """Return the family that results from applying overlays to a family, or None if it cannot be built.

    ``special_name`` is the special model, such as ``S123``, or "" if the overlays correct the family itself. Each
    applied change is added to the errata of the family.
    """
    layered_spec = LayeredSpec(family.document, report)
    problem_count_before = len(report)
    layered_spec.apply([_layer_of(overlay) for overlay in overlays])
    name_of_special = f"{family.device.name}_{special_name.lower()}" if special_name else ""  # For example x_24_s123.
    document = layered_spec.document(name_of_special)
    report_of_result = ProblemReport()
    device = build(document, report_of_result)
    # If a change could not be applied, problems of the result may only follow from it.
    if len(report) == problem_count_before:
        _report_in_overlay(report_of_result, family.document, overlays[-1], report)
    if device is None:
        return None
    # ``build`` does not add the errata about other editions.
    errata_of_editions = [erratum for erratum in family.device.errata if erratum.edition]
    device = replace(
        device,
        errata=(*device.errata, *errata_of_editions, *errata_of(layered_spec.applied)),
        overlays=tuple(_build_overlay(overlay) for overlay in overlays),
        title=f"{device.title}, special models /{special_name}" if special_name else device.title,
        base=family.device.name if special_name else "",
        times_read=family.device.times_read,
        releases=family.device.releases,
    )
    if special_name:
        device = _reduce_to_listed_codes(device, overlays, report)
    files = family.files | {overlay.file for overlay in overlays}
    return Family(device=device, document=document, files=files, without_overlays=None if special_name else family)


def _build_overlay(document: Document) -> Overlay:
    """Return the name and the title of an overlay, and the special model that it applies to, if any."""
    special = document.data.get("applies_to", {}).get("special", "")
    return Overlay(document.data["overlay"], document.data["title"], special)


def errata_of(applied_changes: Iterable[AppliedChange]) -> Iterator[Erratum]:
    """Yield the changes of overlays and editions that were applied to a spec as errata, in the order of application.

    In an overlay, each change is one erratum. In an edition, a change can name several places, and all of them are one
    erratum.
    """
    erratum_count_by_layer: Counter[str] = Counter()
    for _, changes_of_erratum in groupby(applied_changes, key=_erratum_key):
        changes = list(changes_of_erratum)
        layer_name = changes[0].layer.name
        erratum_count_by_layer[layer_name] += 1
        yield _erratum_of_changes(changes, erratum_count_by_layer[layer_name])


def _erratum_of_changes(changes: Sequence[AppliedChange], erratum_number: int) -> Erratum:
    """Return changes that one entry in a spec or overlay makes as an erratum with this number."""
    first_change = changes[0]
    layer_kind = first_change.layer.kind.value
    layer_name = first_change.layer.name
    raw_change = {"severity": "wrong_data", **first_change.raw}
    # The schema reports keys that are missing.
    stated_facts: dict[str, object] = {}
    for key in ("severity", "why", "source"):
        if key in raw_change:
            stated_facts[key] = raw_change[key]
    new_values = join_shortened([change.now for change in changes if change.now]) or LEFT_OUT
    former_texts = without_examples([change.was for change in changes])
    affected_paths: list[str] = []
    for change in changes:
        affected_paths += change.affects
    name_prefix = _NOT_IN_NAMES.sub("_", f"{layer_kind}_{layer_name}".removeprefix("overlay_"))
    return build_part(
        Erratum,
        stated_facts,
        name=f"{name_prefix}_{erratum_number}",
        title=change_title(_layer_words(layer_kind, layer_name), former_texts),
        printed=join_shortened(former_texts),
        used=new_values if first_change.is_known else NOT_KNOWN,
        status="settled" if first_change.is_known else "open",
        affects=tuple(dict.fromkeys(affected_paths)),
        **{layer_kind: layer_name},
    )


def _layer_words(layer_kind: str, layer_name: str) -> str:
    """Return an overlay or an edition of the manual in words, for the title of an erratum."""
    is_overlay = layer_kind == LayerKind.OVERLAY.value
    return layer_in_words(layer_name, "") if is_overlay else layer_in_words("", layer_name)


def _erratum_key(change: AppliedChange) -> tuple[str, str, object]:
    """Return a key that is equal for changes that are reported as one erratum.

    In an edition, these are the changes of one entry in its list. In an overlay, each change is an erratum.
    """
    layer = change.layer
    if layer.kind is LayerKind.EDITION:
        return layer.kind.value, layer.name, (layer.path, change.number)
    return layer.kind.value, layer.name, change


def without_examples(names: Sequence[str]) -> Sequence[str]:
    """Return the names of changed places except examples, or all names if there are only examples."""
    return [name for name in names if not name.startswith("examples.")] or names


def join_shortened(names: Sequence[str]) -> str:
    """Return the names as text, each once, such as ``a, b``.

    If there are more than nine names, the text lists the first eight and the number of the others: ``and 3 more``.
    """
    unique_names = list(dict.fromkeys(names))
    remaining_count = len(unique_names) - _MAX_NAMES
    if remaining_count < 2:  # "and 1 more" is as long as a name.
        return ", ".join(unique_names)
    return f"{', '.join(unique_names[:_MAX_NAMES])} and {remaining_count} more"


def _reduce_to_listed_codes(device: Device, overlays: Sequence[Document], report: ProblemReport) -> Device:
    """Return the device with only the order codes that the overlays list under ``applies_to``.

    Report unknown order codes. If no known code is listed, the device keeps all of its codes.
    """
    known_codes = {variant.code for variant in device.variants}
    selected_codes: set[str] = set()
    for overlay in overlays:
        for code_index, order_code in enumerate(overlay.data.get("applies_to", {}).get("order_codes", ())):
            if order_code in known_codes:
                selected_codes.add(order_code)
                continue
            message = (
                f"{quoted(order_code)} is not a listed order code of the family{suggest_word(order_code, known_codes)}"
            )
            report.add("undefined-reference", overlay, ("applies_to", "order_codes", code_index), message)
    return for_codes(device, selected_codes) if selected_codes else device


def _report_in_overlay(
    report_of_result: ProblemReport, spec: Document, overlay: Document, report: ProblemReport
) -> None:
    """Report the problems that only occur after applying an overlay to a spec.

    Problems in the spec are reported at the name of the overlay, with their place in the spec as part of the message.
    Other problems are reported at their own places.
    """
    reported_before = set(report.problems)
    for problem in report_of_result.problems:
        if problem.file == spec.file and problem not in reported_before:
            spec_name = Path(spec.file).name
            location = f"{spec_name}:{problem.line}, {problem.path}" if problem.path else spec_name
            _report_problem(problem, overlay, f"with this overlay, {location}: {problem.message}", report)
        elif problem not in reported_before:
            report.add_problem(replace(problem, cause=""))


def _report_problem(problem: Problem, overlay: Document, message: str, report: ProblemReport) -> None:
    """Report a problem at the name of an overlay, under the same rule."""
    report.add(problem.rule, overlay, ("overlay",), message)
