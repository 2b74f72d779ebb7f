"""Check that facts for some order codes cover all order codes, and that no order code has two of a kind."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, compress
from typing import Protocol

from ..language.problems import DocumentReport, Path, quoted
from ..language.rules.parts import has_erratum_at
from ..model import Biss, Clocked, Interface, Ssi, Variant
from ..model.device import Device
from ..model.order_codes import Restricted, facts_for_code, fits
from ..model.record import dataclass
from ..say.plain_text import count_with_unit
from .from_mapping import Raw


@dataclass(frozen=True, slots=True)
class ExclusiveFacts:
    """Facts of which an order code has only one, each with its path in the spec.

    ``noun`` names the fact with an article, such as ``a clock``. ``codes`` are the codes of the interface, whose name
    in sentences is empty for facts of the device. If the fact ``is_needed``, each order code must have a fact. For
    facts with ``other_rules``, these rules report two facts for all order codes.
    """

    noun: str
    facts: Sequence[tuple[Path, Restricted]]
    codes: Sequence[str]
    interface: str = ""
    is_needed: bool = False
    other_rules: bool = False


def check_facts_by_code(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Report order codes without a clock or time-out, with two facts of a kind, and facts that no order code has."""
    if not device.variants:
        return
    for exclusive_facts in _all_exclusive_facts(raw_spec, device, report):
        has_only = any(fact.only for _, fact in exclusive_facts.facts)
        if has_only or not exclusive_facts.other_rules:
            _check_unused(exclusive_facts, report)
            _check_overlaps(exclusive_facts, report)
            _check_gaps(exclusive_facts, report)


def _all_exclusive_facts(raw_spec: Raw, device: Device, report: DocumentReport) -> Iterator[ExclusiveFacts]:
    """Yield the facts of the interfaces and of the device, grouped by kind and name."""
    all_codes = _codes_of(device.variants)
    for interface in device.interfaces:
        codes = _codes_of(device.variants_over(interface.name))
        yield from _facts_of_interface(raw_spec["interfaces"][interface.name], interface, codes, report)
    yield from _group_by_name(("timings",), "a timing", device.timings, all_codes)
    yield from _group_by_name(("characteristics",), "a characteristic", device.characteristics, all_codes)


def _codes_of(variants: Sequence[Variant]) -> list[str]:
    return [variant.code for variant in variants]


def _facts_of_interface(
    raw_interface: Raw, interface: Interface, codes: Sequence[str], report: DocumentReport
) -> Iterator[ExclusiveFacts]:
    """Yield the clocks, the time-outs, the clock limits by cable length, and the timings by name."""
    path = ("interfaces", interface.name)
    if isinstance(interface, Clocked):
        clocks = _with_paths(raw_interface, (*path, "clock"), interface.clocks)
        # If invalid entries were removed, an order code may only seem to lack a clock.
        is_whole = (*path, "clock") not in report.document.kept_indices
        yield ExclusiveFacts(noun="a clock", facts=clocks, codes=codes, interface=interface.short, is_needed=is_whole)
    if isinstance(interface, Biss):
        timeouts = _with_paths(raw_interface, (*path, "timeout"), interface.timeouts)
        is_needed = not has_erratum_at(report.document, *path, "timeout")
        is_whole = (*path, "timeout") not in report.document.kept_indices
        yield ExclusiveFacts(
            noun="a time-out", facts=timeouts, codes=codes, interface=interface.short, is_needed=is_needed and is_whole
        )
    if isinstance(interface, Ssi):
        rows = _with_paths(raw_interface, (*path, "cable_lengths"), interface.cable_lengths)
        for length in dict.fromkeys(row.shorter_than_m for row in interface.cable_lengths):
            are_of_length = [row.shorter_than_m == length for row in interface.cable_lengths]
            rows_of_length = list(compress(rows, are_of_length))
            noun = f"a clock for cables shorter than {length} m"
            yield ExclusiveFacts(
                noun=noun, facts=rows_of_length, codes=codes, interface=interface.short, other_rules=True
            )
    yield from _group_by_name((*path, "timings"), "a timing", interface.timings, codes)


def _with_paths(raw: Raw, path: tuple[str, ...], facts: Sequence[Restricted]) -> list[tuple[Path, Restricted]]:
    """Return facts with their paths. A single one may be written without a list."""
    key = path[-1]
    is_single = isinstance(raw.get(key), Mapping)
    if is_single:
        return [(path, fact) for fact in facts]
    return [((*path, index), fact) for index, fact in enumerate(facts)]


class _Named(Restricted, Protocol):
    """A fact with a name."""

    @property
    def name(self) -> str: ...


def _group_by_name(path: Path, noun: str, facts: Sequence[_Named], codes: Sequence[str]) -> Iterator[ExclusiveFacts]:
    """Yield the facts of each name that occurs several times. An order code may have none of these facts."""
    facts_by_name: dict[str, list[tuple[Path, Restricted]]] = {}
    for index, fact in enumerate(facts):
        facts_by_name.setdefault(fact.name, []).append(((*path, index), fact))
    for name, named_facts in facts_by_name.items():
        if len(named_facts) > 1:
            yield ExclusiveFacts(f"{noun} {quoted(name)}", named_facts, codes, other_rules=True)


def _check_unused(exclusive_facts: ExclusiveFacts, report: DocumentReport) -> None:
    """Report a fact that applies only to order codes of other interfaces."""
    # Another edition has fewer order codes.
    if report.document.family or not exclusive_facts.interface:
        return
    for path, fact in exclusive_facts.facts:
        if _is_reported((*path, "only"), report):
            continue
        if fact.only and not any(fits(fact.only, code) for code in exclusive_facts.codes):
            message = f"no order code with {exclusive_facts.interface} matches {quoted(fact.only)}"
            report.add("only-codes", (*path, "only"), f"{message}; correct the pattern, or remove the entry")


def _is_reported(path: Path, report: DocumentReport) -> bool:
    """Return True if a problem at this place has been reported."""
    return report.document.original(path) in report.faults()


def _check_overlaps(exclusive_facts: ExclusiveFacts, report: DocumentReport) -> None:
    """Report a fact for an order code that already has a fact."""
    for (first_path, first), (path, fact) in combinations(exclusive_facts.facts, 2):
        common_codes = [code for code in exclusive_facts.codes if fits(first.only, code) and fits(fact.only, code)]
        if common_codes:
            line, _ = report.document.position(first_path)
            have = "has" if len(common_codes) == 1 else "have"
            message = f"{_codes_text(common_codes)} already {have} {exclusive_facts.noun}, on line {line}"
            place = (*path, "only") if fact.only else path
            report.add("only-overlap", place, f"{message}; give each order code exactly one with 'only'")


def _check_gaps(exclusive_facts: ExclusiveFacts, report: DocumentReport) -> None:
    """Report the order codes that have none of the facts, if each needs one."""
    if not exclusive_facts.is_needed:
        return
    facts = [fact for _, fact in exclusive_facts.facts]
    # A wrong pattern, which has been reported, was meant for some of the order codes without a fact.
    has_wrong_pattern = any(_is_reported((*path, "only"), report) for path, _ in exclusive_facts.facts)
    if not facts or has_wrong_pattern:
        return
    codes_without = [code for code in exclusive_facts.codes if not facts_for_code(facts, code)]
    if codes_without:
        last_path, _ = exclusive_facts.facts[-1]
        noun = exclusive_facts.noun.removeprefix("a ")
        message = f"{_codes_text(codes_without)} {_has_or_have(codes_without)} no {noun}"
        remedy = "extend 'only', or add an entry for other order codes"
        if noun == "time-out":
            remedy += ". If the manual gives none for them, add an erratum that affects interfaces.biss.timeout"
        report.add("only-gap", (*last_path, "only"), f"{message}; {remedy}")


def _codes_text(codes: Sequence[str]) -> str:
    """Return the first order code, and the number of other codes: ``the order code 'X-24' and 2 others``."""
    others = f" and {count_with_unit(len(codes) - 1, 'other')}" if len(codes) > 1 else ""
    return f"the order code {quoted(codes[0])}{others}"


def _has_or_have(codes: Sequence[str]) -> str:
    return "has" if len(codes) == 1 else "have"
