"""Compare facts that may depend on the order code: clocks, time-outs, clocks by cable length, and names of times."""

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
#: The time-out in descriptions of changes.
_TIMEOUT_MEMBER = ModelMember("timeout", rule="interface-rule", label="time-out")


def compare_clocks(family_pair: FamilyPair, subject: ChangeSubject, old: Clocked, new: Clocked) -> Iterator[Change]:
    """Yield changes of the limits of the clock, for each set of order codes with the same change.

    ``clock`` of an interface is None if the clock depends on the order code.
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
        # Without their order codes, so that timings with the same clocks share a change.
        clocks = replace(old_clock, only=""), replace(new_clock, only="")
        codes_by_clocks.setdefault(clocks, []).append(code)
    for (old_clock, new_clock), codes in codes_by_clocks.items():
        for change in compare_members(family_pair, subject, old_clock, new_clock):
            yield family_pair.limited_to_codes(change, codes)


def compare_timeouts(family_pair: FamilyPair, subject: ChangeSubject, old: Biss, new: Biss) -> Iterator[Change]:
    """Yield changes of the time-out, for each set of order codes with the same change."""
    if _is_common(old) and _is_common(new):
        yield from compare_member(family_pair, subject, _TIMEOUT_MEMBER, old.timeout, new.timeout)
        return
    if _is_common(old) is not _is_common(new):
        yield _by_code_change(family_pair, subject, "time-out", is_by_code=_is_common(old))
    codes_by_timeouts: dict[tuple[Timeout | None, Timeout | None], list[str]] = {}
    for code in family_pair.order_codes_over(new.name):
        timeouts = _for_any_code(old.timeout_of(family_pair.old_code(code))), _for_any_code(new.timeout_of(code))
        codes_by_timeouts.setdefault(timeouts, []).append(code)
    for (old_timeout, new_timeout), codes in codes_by_timeouts.items():
        for change in compare_member(family_pair, subject, _TIMEOUT_MEMBER, old_timeout, new_timeout):
            yield family_pair.limited_to_codes(change, codes)


def compare_cables(family_pair: FamilyPair, subject: ChangeSubject, old: Ssi, new: Ssi) -> Iterator[Change]:
    """Yield that the clock by cable length depends on the order code in only one version.

    Its rows are compared as one member.
    """
    has_only = any(row.only for row in new.cable_lengths)
    if has_only is not any(row.only for row in old.cable_lengths):
        yield _by_code_change(family_pair, subject, "clock by cable", is_by_code=has_only)


def _by_code_change(family_pair: FamilyPair, subject: ChangeSubject, noun: str, *, is_by_code: bool) -> Change:
    """Return the change that a fact depends on the order code in only one version.

    ``is_by_code`` is true if that is the new one.
    """
    extents = ("all order codes", "some order codes")
    old, new = extents if is_by_code else extents[::-1]
    return family_pair.change("facts-by-code", subject, description=f": {noun} of {old} → {new}", old=old, new=new)


def _is_common(interface: Biss) -> bool:
    """Return True if all order codes have the same time-out, or none."""
    return not interface.timeouts_by_code


def _for_any_code(timeout: Timeout | None) -> Timeout | None:
    return replace(timeout, only="") if timeout is not None else None


def with_distinct_names(facts: Sequence[_Named], shared_names: Container[str]) -> tuple[_Named, ...]:
    """Return the facts, with the order codes added to a name that several facts share: ``pause, X-24``."""
    return tuple(
        replace(fact, name=f"{fact.name}, {fact.only}") if fact.name in shared_names else fact for fact in facts
    )
