"""Compare facts that may depend on the order code: clocks, timeouts, clocks by cable length, and names of times."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from dataclasses import replace
from typing import TypeVar

from ..model import Biss, Characteristic, Clock, Clocked, Ssi, Timeout, Timing
from ..model.members import ModelMember
from .compare import compare_member, compare_members
from .family_pair import FamilyPair
from .rules import Change, ChangeSubject

_Named = TypeVar("_Named", Characteristic, Timing)
#: The timeout in descriptions of changes.
_TIMEOUT_MEMBER = ModelMember("timeout", rule="interface-rule", label="timeout")


def compare_clocks(family_pair: FamilyPair, subject: ChangeSubject, old: Clocked, new: Clocked) -> Iterator[Change]:
    """Yield changes of the limits of the clock. Order codes with the same old and new clock share a change.

    ``clock`` of an interface is None if the clock depends on the order code. Each clock then lists in ``only`` the
    order codes that it applies to.
    """
    if old.clock is not None and new.clock is not None:
        yield from compare_members(family_pair, subject, old.clock, new.clock)
        return
    if old.clock is not new.clock:
        yield _by_code_change(family_pair, subject, "clock", is_by_code=new.clock is None)
    codes_by_clocks: dict[tuple[Clock, Clock], list[str]] = {}
    for code in family_pair.order_codes_over(new.name):
        old_clock = old.clock_of(family_pair.old_code(code))
        new_clock = new.clock_of(code)
        # The lists of order codes are removed, so that equal clocks compare as equal.
        clocks = replace(old_clock, only=""), replace(new_clock, only="")
        codes_by_clocks.setdefault(clocks, []).append(code)
    for (old_clock, new_clock), codes in codes_by_clocks.items():
        for change in compare_members(family_pair, subject, old_clock, new_clock):
            yield family_pair.limited_to_codes(change, codes)


def compare_timeouts(family_pair: FamilyPair, subject: ChangeSubject, old: Biss, new: Biss) -> Iterator[Change]:
    """Yield changes of the BiSS timeout. Order codes with the same old and new timeout share a change."""
    was_by_code, is_by_code = bool(old.timeouts_by_code), bool(new.timeouts_by_code)
    if not was_by_code and not is_by_code:
        yield from compare_member(family_pair, subject, _TIMEOUT_MEMBER, old.timeout, new.timeout)
        return
    if was_by_code != is_by_code:
        yield _by_code_change(family_pair, subject, "timeout", is_by_code=is_by_code)
    codes_by_timeouts: dict[tuple[Timeout | None, Timeout | None], list[str]] = {}
    for code in family_pair.order_codes_over(new.name):
        old_timeout = _without_order_codes(old.timeout_of(family_pair.old_code(code)))
        new_timeout = _without_order_codes(new.timeout_of(code))
        codes_by_timeouts.setdefault((old_timeout, new_timeout), []).append(code)
    for (old_timeout, new_timeout), codes in codes_by_timeouts.items():
        for change in compare_member(family_pair, subject, _TIMEOUT_MEMBER, old_timeout, new_timeout):
            yield family_pair.limited_to_codes(change, codes)


def compare_cables(family_pair: FamilyPair, subject: ChangeSubject, old: Ssi, new: Ssi) -> Iterator[Change]:
    """Yield a change if the table of clocks by cable length depends on the order code in only one version.

    It depends on the order code if a row of the table lists, in ``only``, the order codes that it applies to.
    """
    was_by_code = any(row.only for row in old.cable_lengths)
    is_by_code = any(row.only for row in new.cable_lengths)
    if was_by_code != is_by_code:
        yield _by_code_change(family_pair, subject, "clock by cable", is_by_code=is_by_code)


def _by_code_change(family_pair: FamilyPair, subject: ChangeSubject, noun: str, *, is_by_code: bool) -> Change:
    """Return the change that a fact depends on the order code in only one version.

    ``is_by_code`` is true if it depends on the order code in the new version. ``noun`` names the fact.
    """
    if is_by_code:
        old, new = "all order codes", "some order codes"
    else:
        old, new = "some order codes", "all order codes"
    return family_pair.change("facts-by-code", subject, description=f": {noun} of {old} → {new}", old=old, new=new)


def _without_order_codes(timeout: Timeout | None) -> Timeout | None:
    """Return a timeout without the list of order codes that it applies to, so that equal timeouts compare as equal."""
    return replace(timeout, only="") if timeout is not None else None


def with_distinct_names(facts: Sequence[_Named], shared_names: Container[str]) -> tuple[_Named, ...]:
    """Return the facts with distinct names: ``pause, X-24`` for a pause that applies to the order code X-24.

    Names in ``shared_names`` belong to several facts, each of which applies to other order codes, listed in ``only``.
    """
    facts_with_distinct_names: list[_Named] = []
    for fact in facts:
        name = f"{fact.name}, {fact.only}" if fact.name in shared_names else fact.name
        facts_with_distinct_names.append(replace(fact, name=name))
    return tuple(facts_with_distinct_names)
