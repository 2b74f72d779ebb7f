"""Compare the facts of interfaces that the file of a manufacturer lists as the same in all devices."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath

from ..language.document import Document, Path, label_of
from ..language.problems import Report, quoted
from ..language.rules.parts import as_affected_name, has_erratum_at
from ..language.rules.walk import leaves, mapping
from ..language.schema_files import PROSE

#: Steps of the path to an interface, such as ``interfaces.ssi``.
_STEPS_OF_INTERFACE = 2
#: Keys whose values are printed, or belong to one device.
_NOT_COMPARED = PROSE | {"printed_name", "only", "erratum"}
#: Shown for a fact that a device lacks.
_ABSENT = "nothing"
#: Facts at a place, by their relative paths: ``{(0, "below_hz"): 400000}``.
_Facts = Mapping[Path, object]


def compare_facts(places: Sequence[str], documents: Sequence[Document], report: Report) -> None:
    """Report each device whose facts at a place such as ``interfaces.ssi.cable_lengths`` differ from most devices.

    All devices with the interface are compared, so one that lacks the facts is reported, too. Among equally common
    facts, those of the first device without an erratum about the place apply. An erratum that only one of two devices
    has about it explains a difference.
    """
    for place in places:
        steps = place.split(".")
        with_interface = [document for document in documents if mapping(document.data, *steps[:_STEPS_OF_INTERFACE])]
        with_interface.sort(key=lambda document: document.file)
        facts_by_file = {document.file: _facts_at(document, steps) for document in with_interface}
        counts = Counter(frozenset(facts.items()) for facts in facts_by_file.values())
        if len(counts) < 2:
            continue  # All devices have the same facts, or there are none.
        # If several devices have the most frequent facts, a device without an erratum is compared with the others.
        frequencies = {
            document.file: (
                counts[frozenset(facts_by_file[document.file].items())],
                not has_erratum_at(document, *steps),
            )
            for document in with_interface
        }
        common = max(with_interface, key=lambda document: frequencies[document.file])
        for document in with_interface:
            # Errata of both devices are about the text that their manuals have in common.
            if has_erratum_at(document, *steps) is has_erratum_at(common, *steps):
                _report_difference(document, common, facts_by_file, tuple(steps), report)


def _facts_at(document: Document, steps: Sequence[str]) -> _Facts:
    """Return the facts at a place without prose and printed names. The path of a single value is empty."""
    node: object = document.data
    for step in steps:
        if isinstance(node, list):
            node = next((part for part in node if label_of(part) == step), None)
        else:
            node = node.get(step) if isinstance(node, dict) else None
    return dict(_compared_leaves(node))


def _compared_leaves(node: object) -> Iterator[tuple[Path, object]]:
    for path, value in leaves(node):
        if value is not None and _NOT_COMPARED.isdisjoint(map(str, path)):
            yield path, value


def _report_difference(
    document: Document, common: Document, facts_by_file: Mapping[str, _Facts], place: Path, report: Report
) -> None:
    """Report the first fact in which two devices differ, or nothing if they agree."""
    facts, common_facts = facts_by_file[document.file], facts_by_file[common.file]
    all_paths = dict.fromkeys((*common_facts, *facts))  # Each once, in order.
    for path in all_paths:
        value, common_value = facts.get(path, _ABSENT), common_facts.get(path, _ABSENT)
        if value == common_value:
            continue
        line, _ = common.position((*place, *path))
        message = (
            f"this is {value}, but {common_value} in {PurePath(common.file).name}:{line}; according to the"
            f" manufacturer's file, {quoted('.'.join(map(str, place)))} is the same in all devices. If it is not, add"
            f" an erratum that affects {as_affected_name('.'.join(map(str, place)))}, or remove it from that file"
        )
        report.add("not-alike", document, (*place, *path), message)
        return
