"""Compare interfaces with their settings, times, data IDs and frames."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model import Biss, ControlField, Interface, Layout, LayoutRange, Rs485, Timing
from .change import Change, Subject
from .compare import compare_members, compare_pair, compare_parts
from .family_pair import FamilyPair
from .fields import layout
from .pairs import paired


def interfaces(family_pair: FamilyPair) -> Iterator[Change]:
    for pair in paired(family_pair.old.interfaces, family_pair.new.interfaces):
        subject = Subject(f"interfaces.{pair.item.name}", pair.item.short, pair.item.name)
        yield from compare_pair(family_pair, "interface", subject, pair, _compare_interface)


def _compare_interface(family_pair: FamilyPair, subject: Subject, old: Interface, new: Interface) -> Iterator[Change]:
    if isinstance(new, Rs485) and isinstance(old, Rs485):
        yield from compare_members(family_pair, subject.inside("port", subject.label), old.port, new.port)
        yield from compare_parts(
            family_pair, "data-id", old.data_ids, new.data_ids, subject.inside("data_ids", "data ID")
        )
    elif not isinstance(new, Rs485) and not isinstance(old, Rs485):
        yield from compare_members(family_pair, subject.inside("clock", subject.label), old.clock, new.clock)
    if isinstance(old, Biss) and isinstance(new, Biss):
        control_subject = subject.inside("control_data", "control frame: field")
        yield from compare_parts(
            family_pair, "control-field", old.control_data, new.control_data, control_subject, _compare_control_values
        )
    yield from timings(family_pair, subject, old.timings, new.timings)
    yield from compare_parts(
        family_pair, "frame", old.layouts, new.layouts, subject.inside("layouts", "frame"), _compare_frame
    )


def _compare_frame(family_pair: FamilyPair, subject: Subject, old: Layout, new: Layout) -> Iterator[Change]:
    unnamed = subject.unnamed
    yield from layout(family_pair, unnamed, old, new)
    yield from _compare_position_range(family_pair, unnamed, old.position_range, new.position_range)
    old_decisions = {family_pair.to_new("decision", decision.name) for decision in family_pair.old.alternatives_of(old)}
    new_decisions = {decision.name for decision in family_pair.new.alternatives_of(new)}
    inner = unnamed.inside("alternatives", unnamed.label)
    for name in sorted(old_decisions - new_decisions):
        yield family_pair.change("frame-decision", inner, f": no longer needs the decision {name}", name, None)
    for name in sorted(new_decisions - old_decisions):
        yield family_pair.change("frame-decision", inner, f": needs the decision {name}", None, name)


def _compare_position_range(
    family_pair: FamilyPair, subject: Subject, old: LayoutRange | None, new: LayoutRange | None
) -> Iterator[Change]:
    """Compare the ranges of a position in one frame. Without its own range, a frame has that of the interface."""
    range_subject = subject.inside("position_range", f"{subject.label}: position range")
    if old is not None and new is not None:
        yield from compare_members(family_pair, range_subject, old, new)
    elif old is not new:
        yield from family_pair.presence("measurement", range_subject, old, new)


def _compare_control_values(
    family_pair: FamilyPair, subject: Subject, old: ControlField, new: ControlField
) -> Iterator[Change]:
    value_subject = replace(subject, label=f"control frame: {new.name}: value")
    yield from compare_parts(family_pair, "value", old.values, new.values, value_subject)


def timings(
    family_pair: FamilyPair, subject: Subject, old_parts: tuple[Timing, ...], new_parts: tuple[Timing, ...]
) -> Iterator[Change]:
    """Compare times of an interface or of the device."""
    yield from compare_parts(
        family_pair, "timing", old_parts, new_parts, subject.inside("timings", f"{subject.label} time".strip())
    )
