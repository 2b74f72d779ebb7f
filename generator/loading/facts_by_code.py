"""Check facts that only apply to some order codes: together, they must cover every order code exactly once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
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
    """Facts of one kind, such as clocks, of which each order code has at most one."""

    #: The kind of the facts with an article, such as ``a clock``.
    noun: str
    #: Each fact with its path in the spec.
    facts: Sequence[tuple[Path, Restricted]]
    #: The order codes of the interface or of the device.
    codes: Sequence[str]
    #: Short name of the interface, or "" for facts of the device.
    interface: str = ""
    #: Whether each order code must have one of the facts.
    is_needed: bool = False
    #: Whether other rules report two facts that both apply to all order codes.
    other_rules: bool = False


def check_facts_by_code(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Report order codes without a clock or timeout, order codes with two facts of a kind, and unused facts."""
    if not device.variants:
        return
    for exclusive_facts in _all_exclusive_facts(raw_spec, device, report):
        # ``only`` of a fact lists the order codes that it applies to. It is "" if the fact applies to all of them.
        depend_on_code = any(fact.only for _, fact in exclusive_facts.facts)
        if depend_on_code or not exclusive_facts.other_rules:
            _check_unused(exclusive_facts, report)
            _check_overlaps(exclusive_facts, report)
            _check_gaps(exclusive_facts, report)


def _all_exclusive_facts(raw_spec: Raw, device: Device, report: DocumentReport) -> Iterator[ExclusiveFacts]:
    """Yield the facts of the interfaces and of the device, grouped by kind and name."""
    all_codes = _codes_of(device.variants)
    for interface in device.interfaces:
        raw_interface = raw_spec["interfaces"][interface.name]
        codes = _codes_of(device.variants_over(interface.name))
        yield from _facts_of_interface(raw_interface, interface, codes, report)
    yield from _group_by_name(device.timings, noun="a timing", path=("timings",), codes=all_codes)
    yield from _group_by_name(
        device.characteristics, noun="a characteristic", path=("characteristics",), codes=all_codes
    )


def _codes_of(variants: Sequence[Variant]) -> list[str]:
    return [variant.code for variant in variants]


def _facts_of_interface(
    raw_interface: Raw, interface: Interface, codes: Sequence[str], report: DocumentReport
) -> Iterator[ExclusiveFacts]:
    """Yield the facts of an interface of which an order code has only one.

    These are clocks, timeouts, clock limits for the same cable length, and timings with the same name.
    """
    path = ("interfaces", interface.name)
    if isinstance(interface, Clocked):
        clocks = _with_paths(raw_interface, (*path, "clock"), interface.clocks)
        # If invalid entries were removed, an order code may only seem to have no clock.
        is_complete = (*path, "clock") not in report.document.kept_indices
        yield ExclusiveFacts(
            noun="a clock", facts=clocks, codes=codes, interface=interface.short, is_needed=is_complete
        )
    if isinstance(interface, Biss):
        timeouts = _with_paths(raw_interface, (*path, "timeout"), interface.timeouts)
        is_excused = has_erratum_at(report.document, *path, "timeout")
        is_complete = (*path, "timeout") not in report.document.kept_indices
        yield ExclusiveFacts(
            noun="a timeout",
            facts=timeouts,
            codes=codes,
            interface=interface.short,
            is_needed=is_complete and not is_excused,
        )
    if isinstance(interface, Ssi):
        rows = _with_paths(raw_interface, (*path, "cable_lengths"), interface.cable_lengths)
        # The rows of a cable length, each with its path. Usually there is one.
        rows_by_length: dict[int, list[tuple[Path, Restricted]]] = {}
        for path_and_row, row in zip(rows, interface.cable_lengths, strict=True):
            rows_by_length.setdefault(row.shorter_than_m, []).append(path_and_row)
        for length, rows_of_length in rows_by_length.items():
            noun = f"a clock for cables shorter than {length} m"
            yield ExclusiveFacts(
                noun=noun, facts=rows_of_length, codes=codes, interface=interface.short, other_rules=True
            )
    yield from _group_by_name(interface.timings, noun="a timing", path=(*path, "timings"), codes=codes)


def _with_paths(raw: Raw, path: tuple[str, ...], facts: Sequence[Restricted]) -> list[tuple[Path, Restricted]]:
    """Return facts with their paths in the spec. A single fact may be written without a list."""
    key = path[-1]
    is_single = isinstance(raw.get(key), Mapping)
    if is_single:
        return [(path, fact) for fact in facts]
    return [((*path, index), fact) for index, fact in enumerate(facts)]


class _Named(Restricted, Protocol):
    """A fact with a name."""

    @property
    def name(self) -> str: ...


def _group_by_name(facts: Sequence[_Named], *, noun: str, path: Path, codes: Sequence[str]) -> Iterator[ExclusiveFacts]:
    """Yield the facts that share a name, for each such name. An order code has at most one of them.

    ``path`` is the path of the list of facts, and ``noun`` is ``a timing`` or the like.
    """
    facts_by_name: dict[str, list[tuple[Path, Restricted]]] = {}
    for index, fact in enumerate(facts):
        path_and_fact = ((*path, index), fact)
        facts_by_name.setdefault(fact.name, []).append(path_and_fact)
    for name, facts_with_name in facts_by_name.items():
        if len(facts_with_name) > 1:
            named_noun = f"{noun} {quoted(name)}"
            yield ExclusiveFacts(noun=named_noun, facts=facts_with_name, codes=codes, other_rules=True)


def _check_unused(exclusive_facts: ExclusiveFacts, report: DocumentReport) -> None:
    """Report a fact that applies only to order codes of other interfaces."""
    # Other editions of the manual may have fewer order codes, so their facts are not checked.
    is_other_edition = bool(report.document.family)
    if is_other_edition or not exclusive_facts.interface:
        return
    for path, fact in exclusive_facts.facts:
        if _is_reported((*path, "only"), report):
            continue
        if fact.only and not any(fits(fact.only, code) for code in exclusive_facts.codes):
            message = f"no order code with {exclusive_facts.interface} matches {quoted(fact.only)}"
            report.add("only-codes", (*path, "only"), f"{message}; correct the pattern, or remove the entry")


def _is_reported(path: Path, report: DocumentReport) -> bool:
    """Return whether a problem at this place of the spec has been reported."""
    return report.document.path_in_file(path) in report.faults()


def _check_overlaps(exclusive_facts: ExclusiveFacts, report: DocumentReport) -> None:
    """Report pairs of facts of a kind that apply to the same order code."""
    for (first_path, first), (path, fact) in combinations(exclusive_facts.facts, 2):
        common_codes = [code for code in exclusive_facts.codes if fits(first.only, code) and fits(fact.only, code)]
        if common_codes:
            line, _ = report.document.position(first_path)
            have = "has" if len(common_codes) == 1 else "have"
            message = f"{_codes_text(common_codes)} already {have} {exclusive_facts.noun}, on line {line}"
            place = (*path, "only") if fact.only else path
            report.add("only-overlap", place, f"{message}; give each order code exactly one with 'only'")


def _check_gaps(exclusive_facts: ExclusiveFacts, report: DocumentReport) -> None:
    """Report the order codes that none of the facts applies to, if each order code needs one."""
    if not exclusive_facts.is_needed:
        return
    facts = [fact for _, fact in exclusive_facts.facts]
    # A wrong pattern has been reported. It was probably meant for the order codes without a fact.
    has_wrong_pattern = any(_is_reported((*path, "only"), report) for path, _ in exclusive_facts.facts)
    if not facts or has_wrong_pattern:
        return
    codes_without = [code for code in exclusive_facts.codes if not facts_for_code(facts, code)]
    if codes_without:
        last_path, _ = exclusive_facts.facts[-1]
        noun = exclusive_facts.noun.removeprefix("a ")
        message = f"{_codes_text(codes_without)} {_has_or_have(codes_without)} no {noun}"
        remedy = "extend 'only', or add an entry for other order codes"
        if noun == "timeout":
            remedy += ". If the manual gives none for them, add an erratum that affects interfaces.biss.timeout"
        report.add("only-gap", (*last_path, "only"), f"{message}; {remedy}")


def _codes_text(codes: Sequence[str]) -> str:
    """Return a text with the first order code and the number of the others: ``the order code 'X-24' and 2 others``."""
    first_code = f"the order code {quoted(codes[0])}"
    if len(codes) == 1:
        return first_code
    return f"{first_code} and {count_with_unit(len(codes) - 1, 'other')}"


def _has_or_have(codes: Sequence[str]) -> str:
    return "has" if len(codes) == 1 else "have"
