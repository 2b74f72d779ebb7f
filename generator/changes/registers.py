"""Compare the content of registers and procedures."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields, replace

from ..model import Argument, Procedure, Register, Sources, Step
from ..model.members import PARTS_BY_CLASS
from ..say.register import access
from .change import Change, Subject
from .compare import compare_members, compare_parts
from .counterparts import step_in_new, without_words
from .family_pair import FamilyPair
from .fields import layout
from .value_text import arrow, plain

_CAN_READ, _CAN_WRITE = ("read_only", "read_write"), ("write_only", "read_write")


def register(family_pair: FamilyPair, subject: Subject, old: Register, new: Register) -> Iterator[Change]:
    unnamed = subject.unnamed
    if old.access != new.access:
        is_lost = any(old.access in accesses and new.access not in accesses for accesses in (_CAN_READ, _CAN_WRITE))
        description = f": {access(old)} → {access(new)}"
        rule, subject = ("access-lost", subject) if is_lost else ("access-gained", unnamed)
        yield family_pair.change(rule, subject.inside("access", subject.label), description, old.access, new.access)
    yield from compare_parts(
        family_pair, "meaning", old.meanings, new.meanings, replace(subject, label=f"{subject.label}: meaning")
    )
    # Everything else in the layout of a register follows from the register, which is compared separately.
    compared = {name: getattr(old.layout, name) for name in ("fields", "joins", "gaps")}
    old_layout = replace(new.layout, **compared)
    yield from compare_members(family_pair, unnamed, old_layout, new.layout)
    yield from layout(family_pair, unnamed, old_layout, new.layout)


def procedure(family_pair: FamilyPair, subject: Subject, old: Procedure, new: Procedure) -> Iterator[Change]:
    old_arguments, new_arguments = _signature(map(family_pair.in_new, old.arguments)), _signature(new.arguments)
    inner = subject.inside("arguments", subject.label)
    if old_arguments != new_arguments:
        old_texts, new_texts = map(_argument_names, (old, new))
        if old_texts == new_texts:  # Then the register that takes an argument differs, or its meaning.
            old_texts, new_texts = map(_argument_texts, (old_arguments, new_arguments))
        description = f": arguments {arrow(old_texts, new_texts)}"
        yield family_pair.change("procedure-arguments", inner, description, old_arguments, new_arguments)
    elif _meanings(old.arguments) != _meanings(new.arguments):
        yield family_pair.change("words", inner.unnamed, ": arguments", old.arguments, new.arguments)
    inner = subject.unnamed.inside("steps", subject.label)
    old_steps = [step_in_new(family_pair, step) for step in old.steps]
    new_steps = [without_words(step) for step in new.steps]
    if old_steps != new_steps:
        yield family_pair.change("procedure-steps", inner, _steps(old_steps, new_steps), old_steps, new_steps)
    elif _meanings(old.steps) != _meanings(new.steps):
        yield family_pair.change("words", inner, ": steps", old.steps, new.steps)
    elif old.steps != new.steps and _sources(old.steps) != _sources(new.steps):
        yield family_pair.change("source", inner, ": steps", None, None)


def _argument_names(procedure: Procedure) -> list[str]:
    return [argument.name for argument in procedure.arguments]


def _signature(arguments: Iterable[Argument]) -> list[tuple[str, str, str]]:
    """Return the name of each argument, the register or field that takes it, and how it is meant."""
    return [(argument.name, argument.of, argument.meant_as) for argument in arguments]


def _argument_texts(signature: list[tuple[str, str, str]]) -> list[str]:
    texts = []
    for name, owner, meaning in signature:
        as_meaning = f" as {meaning}" if meaning else ""
        texts.append(f"{name} for {owner}{as_meaning}")
    return texts


def _meanings(parts: Sequence[Argument | Step]) -> list[str]:
    return [part.meaning for part in parts]


def _sources(steps: Sequence[Step]) -> list[Sources]:
    return [step.source for step in steps]


def _steps(old_steps: list[Step], new_steps: list[Step]) -> str:
    if len(old_steps) != len(new_steps):
        return f": {len(old_steps)} steps → {len(new_steps)} steps"
    numbered = enumerate(zip(old_steps, new_steps, strict=True), 1)
    differing = {number: pair for number, pair in numbered if pair[0] != pair[1]}
    steps = f": step{'s' * (len(differing) > 1)} {', '.join(map(str, differing))}"
    details = {_step(old, new) for old, new in differing.values()}
    return f"{steps}: {details.pop()}" if len(details) == 1 else f"{steps} differ"


def _step(old: Step, new: Step) -> str:
    """Describe the difference between two steps."""
    if type(old) is not type(new):
        return f"{old.do} → {new.do}"
    part_members, texts = PARTS_BY_CLASS[type(new).__name__].by_attribute, []
    for attribute in fields(new):
        old_value, new_value = getattr(old, attribute.name), getattr(new, attribute.name)
        if old_value != new_value:
            member = part_members[attribute.name]
            texts.append(f"{member.words} {arrow(plain(old_value), plain(new_value), member.notation)}")
    return ", ".join(texts)
