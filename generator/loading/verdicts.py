"""Verdicts that follow from a whole frame: those of reserved bits, and those that errata state in words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

from ..language.problems import DocumentReport, listed, quoted
from ..model import Device, Erratum, Field, Flag, Layout, Unused, Verdict
from .fields import Site
from .from_mapping import Raw

#: Verdicts as errata write them. A longer one comes before the one that it contains.
_IN_WORDS = (
    (Verdict.NOT_USABLE, r"not usable|unusable|not_usable"),
    (Verdict.USABLE_WITH_WARNING, r"usable,? with a warning|usable_with_warning"),
    (Verdict.UNKNOWN, r"(?:position|verdict|it) (?:is|becomes|stays) (?:then )?unknown"),
    (Verdict.USABLE, r"\busable\b"),
)


def with_verdicts_of_reserved_bits(layout: Layout, raw_fields: Iterable[Raw], site: Site) -> Layout:
    """Return the layout with UNKNOWN as the verdict of reserved bits, if no flag says whether the position is usable.

    A warning does not improve on an unknown position, so ``raw_fields`` must not state that verdict.
    """
    if layout.tells_validity:
        return layout
    for index, field in enumerate(raw_fields):
        if "unused" in field and field.get("makes_position") == Verdict.USABLE_WITH_WARNING.value:
            problem = f"no flag of '{layout.name}' says whether the position is usable, so the verdict stays unknown"
            site.report("reserved-verdict", f"{problem}; leave 'makes_position' out", "fields", index, "makes_position")
    return replace(layout, fields=tuple(map(_of_unknown, layout.fields)))


def _of_unknown(field: Field) -> Field:
    match field.kind:
        case Unused(makes_position=Verdict.USABLE_WITH_WARNING):
            return replace(field, kind=replace(field.kind, makes_position=Verdict.UNKNOWN))
        case _:
            return field


def check_errata(device: Device, report: DocumentReport) -> None:
    """Check that errata about flags state only verdicts that decoders give."""
    for erratum in device.errata if not device.base else ():
        following = set(_following(device, erratum))
        if not following:
            continue
        wrong_verdicts = [verdict for verdict in _stated(erratum.used) if verdict not in following]
        for verdict in wrong_verdicts[:1]:
            decoder_verdicts = listed(
                (quoted(following_verdict.value) for following_verdict in Verdict if following_verdict in following),
                "or",
            )
            text = (
                f"{quoted('used')} states the verdict {quoted(verdict.value)}, but for the affected bits, decoders give"
            )
            report.add(
                "erratum-verdict",
                ("errata", erratum.name, "used"),
                f"{text} {decoder_verdicts}; correct one of the two",
            )


def _stated(text: str) -> Iterator[Verdict]:
    """Yield the verdicts that a text names."""
    remaining_text = " ".join(text.split())
    for verdict, pattern in _IN_WORDS:
        remaining_text, count = re.subn(pattern, "", remaining_text)
        if count:
            yield verdict


def _following(device: Device, erratum: Erratum) -> Iterator[Verdict]:
    """Yield the verdicts on frames with the bits that an erratum affects, each active and all inactive."""
    for interface in device.interfaces:
        for layout in interface.layouts:
            place = f"interfaces.{interface.name}.{layout.name}"
            affected_fields = [field for field in layout.fields if _is_affected(field, place, erratum)]
            verdicts = [verdict for field in affected_fields for verdict in _verdicts(field)]
            if verdicts:
                yield from verdicts if layout.tells_validity else map(_at_best_unknown, verdicts)
                yield Verdict.USABLE if layout.tells_validity else Verdict.UNKNOWN


def _is_affected(field: Field, place: str, erratum: Erratum) -> bool:
    owners = (place, f"field_groups.{field.group}") if field.group else (place,)
    field_paths = {f"{owner}.{field.name}" for owner in owners}
    return any(path in field_paths or path in owners for path in erratum.affects)


def _verdicts(field: Field) -> Iterator[Verdict]:
    """Yield the verdict while a bit is active, and that for order codes for which the manual does not explain it."""
    kind = field.kind
    if isinstance(kind, (Flag, Unused)) and kind.makes_position is not None:
        yield kind.makes_position
    if isinstance(kind, Flag) and kind.verdict_if_set is not None:
        yield kind.verdict_if_set
    if isinstance(kind, Flag) and kind.only_while:
        unexplained = field.unexplained.kind
        if isinstance(unexplained, Flag) and unexplained.makes_position is not None:
            yield unexplained.makes_position


def _at_best_unknown(verdict: Verdict) -> Verdict:
    return verdict if verdict is Verdict.NOT_USABLE else Verdict.UNKNOWN
