"""Second readings: find them next to their specs, read, check and compare them."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from decimal import Decimal
from pathlib import Path as File

from ..cache import Cache
from ..language.check import check_second
from ..language.document import Document
from ..language.problems import Path, Report, quoted
from ..language.read import NOTHING_KEPT, read_document
from ..language.second_reading import second_reading_path
from ..loading.device import build_device
from ..loading.library import Family
from ..model import Manufacturer
from ..model.record import dataclass
from .collect import facts_of
from .compare import Comparison, Read, compare
from .coverage import Coverage
from .fact import NOTHING, Facts, Sort
from .reading import Reading

RULE = "readings-disagree"
#: A number, and a value with its unit.
_NUMBER = re.compile(r"(?<![\w.,])\d+(?:,\d{3})*(?:\.\d+)?(?![\d,.]*\d)")
_QUANTITY = re.compile(rf"({_NUMBER.pattern}) ([µmn]?s|[kM]?Hz|m?V)(?!\w)")
_MEND = "check the manual; if it prints both, add an erratum with both under 'readings'"


@dataclass(frozen=True)
class Second:
    """A second reading: its file and its facts, or no facts if it has problems."""

    document: Document
    facts: Facts | None


#: Function that reads the second reading of a family, if there is one, and adds its problems to the report.
Reader = Callable[[Family, Report], Second | None]


def read_beside(family: Family, report: Report, cache: Cache = NOTHING_KEPT) -> Second | None:
    """Read the second reading next to the spec of a family."""
    place = second_reading_path(File(family.document.file))
    document = read_document(place, report, cache=cache) if place.is_file() else None
    return second_of(document, family.device.manufacturer, report) if document is not None else None


def second_of(document: Document, manufacturer: Manufacturer, report: Report) -> Second:
    """Return the second reading in a document, and add its problems to ``report``."""
    before = len(report)
    data = check_second(document, report)
    device = build_device(data, manufacturer, report.for_document(document)) if data is not None else None
    sound = device is not None and len(report) == before
    return Second(document, facts_of(Reading(device, document)) if device is not None and sound else None)


def sound_specs(families: Iterable[Family], report: Report) -> frozenset[str]:
    """Return the files of the families without problems in their facts so far, which can be compared."""
    return frozenset(
        family.document.file for family in families if not report.faults((family.plain or family).document)
    )


def compare_readings(
    families: Iterable[Family], sound: Collection[str], report: Report, read: Reader = read_beside
) -> list[Coverage]:
    """Compare each family with its second reading, report the differences, and return the coverage.

    Families without a second reading are left out. So are those in which one of the two files has problems, but a
    second reading is checked even if its spec is not ``sound``.
    """
    found = []
    for made in families:
        # A reader reads only the manual, so the family is compared without overlays.
        family = made.plain or made
        second = read(family, report) if not family.device.base else None
        if second is None or second.facts is None or family.document.file not in sound:
            continue
        facts = facts_of(Reading(family.device, family.document))
        outcome = compare(facts, second.facts)
        explain(family.document, second.document, outcome, report)
        found.append(Coverage(family, outcome, facts.derived))
    return found


def explain(spec: Document, second: Document, outcome: Comparison, report: Report) -> None:
    """Count the disagreements explained by errata of the spec, and report the others at both places.

    An erratum that affects the place of a disagreement explains it by exactly its two values.
    """
    said, used = list(_explanations(spec)), set[Path]()
    for item in outcome.disagreements:
        place, values = item.place or item.near, (item.other, item.used)
        alike = (each for each in said if each[2:] == values)
        found = {at for at, affected, *_ in alike if any(touches(path, place) for path in affected)}
        used |= found
        if found:
            outcome.read[item.sort, item.place or ("second", *item.second)] = Read.EXPLAINED
            continue
        line, _ = second.position(item.second)
        here = f"{item.what}: {item.used} here, {item.other} in {File(second.file).name}:{line}; {_MEND}"
        report.add(RULE, spec, place, here)
        if item.sort is Sort.ORDER_CODE and NOTHING in (item.used, item.other):
            continue  # Order codes that one reading lacks are one problem.
        line, _ = spec.position(place)
        there = f"{item.what}: {item.other} here, {item.used} in {File(spec.file).name}:{line}; {_MEND}"
        report.add(RULE, second, item.second, there)
    for at, _, other, own in said:
        if at not in used:
            wrong = f"no fact affected by this erratum is {quoted(other)} in the second reading and {quoted(own)} here"
            report.add("readings-unused", spec, at, f"{wrong}; correct or remove it")
        elif _lacks(spec.data["errata"][at[1]]["printed"], other):
            wrong = f"the printed text has other values than {other}, which the second reading has; correct it"
            report.add("readings-unused", spec, (*at[:2], "printed"), wrong)


def _explanations(spec: Document) -> Iterator[tuple[Path, Sequence[str], str, str]]:
    """Yield the two values that each erratum of a spec explains, after their place and the affected paths."""
    for number, item in enumerate(spec.data.get("errata", ())):
        for index, pair in enumerate(item.get("readings", ())):
            yield ("errata", number, "readings", index), item.get("affects", ()), pair["second"], pair["used"]


def _lacks(text: str, value: str) -> bool:
    """Return True if a value has a unit, and a text has a value with this unit, but the number nowhere."""
    found = _QUANTITY.fullmatch(value)
    if found is None or found[2] not in {unit for _, unit in _QUANTITY.findall(text)}:
        return False
    return _number(found[1]) not in map(_number, _NUMBER.findall(text))


def _number(text: str) -> Decimal:
    return Decimal(text.replace(",", ""))


#: Keys of lists and maps that a path of an erratum omits.
_LEFT_OUT = frozenset("layouts fields values contacts timings parts steps arguments meanings data_ids".split())


def touches(affected: str, place: Path) -> bool:
    """Return True if an erratum that affects a path touches a place: the same one, a parent or a child."""
    wanted, steps = affected.split("."), list(place)
    while wanted and steps:
        step = steps.pop(0)
        if step == wanted[0]:
            wanted.pop(0)
        elif not isinstance(step, int) and step not in _LEFT_OUT:
            return False
    return True
