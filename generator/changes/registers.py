"""Compare the content of registers and procedures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace

from ..model import Procedure, Register, Step
from ..model.members import PARTS_BY_CLASS
from ..say.register import access
from .change import Change, Thing
from .compare import members, things
from .counterparts import bare, step_in_new
from .family_pair import FamilyPair
from .fields import layout
from .value_text import arrow, plain

_CAN_READ, _CAN_WRITE = ("read_only", "read_write"), ("write_only", "read_write")


def register(both: FamilyPair, place: Thing, old: Register, new: Register) -> Iterator[Change]:
    unnamed = place.unnamed
    if old.access != new.access:
        is_lost = any(old.access in can and new.access not in can for can in (_CAN_READ, _CAN_WRITE))
        said = f": {access(old)} → {access(new)}"
        rule, thing = ("access-lost", place) if is_lost else ("access-gained", unnamed)
        yield both.change(rule, thing.inside("access", place.label), said, old.access, new.access)
    yield from things(both, "meaning", old.meanings, new.meanings, replace(place, label=f"{place.label}: meaning"))
    # Everything else in the layout of a register follows from the register, which is compared separately.
    own = {name: getattr(old.layout, name) for name in ("fields", "joins", "gaps")}
    before = replace(new.layout, **own)
    yield from members(both, unnamed, before, new.layout)
    yield from layout(both, unnamed, before, new.layout)


def procedure(both: FamilyPair, place: Thing, old: Procedure, new: Procedure) -> Iterator[Change]:
    was = [(item.name, item.of, item.meant_as) for item in map(both.in_new, old.arguments)]
    now = [(item.name, item.of, item.meant_as) for item in new.arguments]
    inner = place.inside("arguments", place.label)
    if was != now:
        texts = [[item.name for item in each.arguments] for each in (old, new)]
        if texts[0] == texts[1]:  # Then the register that takes an argument differs, or its meaning.
            texts = [[f"{name} for {of}{f' as {as_}' if as_ else ''}" for name, of, as_ in each] for each in (was, now)]
        said = f": arguments {arrow(texts[0], texts[1])}"
        yield both.change("procedure-arguments", inner, said, was, now)
    elif [item.meaning for item in old.arguments] != [item.meaning for item in new.arguments]:
        yield both.change("words", inner.unnamed, ": arguments", old.arguments, new.arguments)
    inner = place.unnamed.inside("steps", place.label)
    before = [step_in_new(both, step) for step in old.steps]
    after = [bare(step) for step in new.steps]
    if before != after:
        yield both.change("procedure-steps", inner, _steps(before, after), before, after)
    elif [step.meaning for step in old.steps] != [step.meaning for step in new.steps]:
        yield both.change("words", inner, ": steps", old.steps, new.steps)
    elif old.steps != new.steps and [step.source for step in old.steps] != [step.source for step in new.steps]:
        yield both.change("source", inner, ": steps", None, None)


def _steps(before: list[Step], after: list[Step]) -> str:
    if len(before) != len(after):
        return f": {len(before)} steps → {len(after)} steps"
    differing = [(at, *pair) for at, pair in enumerate(zip(before, after, strict=True), 1) if pair[0] != pair[1]]
    steps = f": step{'s' * (len(differing) > 1)} {', '.join(str(at) for at, _, _ in differing)}"
    details = {_step(old, new) for _, old, new in differing}
    return f"{steps}: {details.pop()}" if len(details) == 1 else f"{steps} differ"


def _step(old: Step, new: Step) -> str:
    """Describe the difference between two steps."""
    if type(old) is not type(new):
        return f"{old.do} → {new.do}"
    known, texts = PARTS_BY_CLASS[type(new).__name__].by_attribute, []
    for item in fields(new):
        before, after = getattr(old, item.name), getattr(new, item.name)
        if before != after:
            member = known[item.name]
            texts.append(f"{member.words} {arrow(plain(before), plain(after), member.notation)}")
    return ", ".join(texts)
