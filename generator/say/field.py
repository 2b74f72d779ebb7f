"""Statements about a field of a frame or register."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import (
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Device,
    Digits,
    Field,
    Flag,
    Number,
    Parity,
    Text,
    Unused,
    Value,
    Verdict,
    assert_never,
)
from ..model.expressions import Expression
from .name import Named, own_names, printed, register_field
from .numbers import formula
from .place import hexadecimal
from .register import reserved
from .steps import remedied
from .text import Code, Hex, Level, Part, Ref, Said, listed, parted, said, told
from .words import WORTH


def field(device: Device, item: Field) -> Iterator[Said]:
    """Yield all statements about it in order, for running text."""
    yield from meaning(item, item.meaning)
    yield from rules(device, item)
    yield from told(item.note)


def meaning(item: Named, text: str) -> Iterator[Said]:
    """Yield the meaning, labelled with the name used in the manual."""
    yield from told(text, label=printed(item)) if text else told(printed(item))


def rules(device: Device, item: Field) -> Iterator[Said]:
    """Yield the interpretation of its bits and the rules for its use."""
    yield from told(item.unit, label="Unit")
    if item.scale is not None:
        yield said(formula(item.scale), label=f"In {item.scale.unit}", source=item.scale.source)
    yield from _kind(device, item)
    if item.container:
        yield said(f"Right-aligned in {item.container} bits, with zeros above it")
    if not item.implemented and "not implemented" not in item.meaning.lower():
        yield said("Not implemented in this encoder")
    if item.reserved:
        yield reserved(item.reserved)
    if item.equals is not None:
        known = _known(item.equals, item.widest)
        yield said("Holds ", known, ", which identifies the encoder. The decoder also accepts other values")
    if item.default is not None:
        yield said(Expression(item.default), label="Default")
    if item.explained_by:
        yield said("For the reason, see ", *listed([register_field(device, path) for path in item.explained_by]))
    yield from remedied(item.remedy, item.by_hand)


def _kind(device: Device, item: Field) -> Iterator[Said]:
    match item.kind:
        case Number() as kind:
            yield from _number(kind)
        case Flag() as kind:
            yield from _flag(kind, item.implemented)
        case Choice():
            pass  # Each value has its own statement.
        case Constant(value):
            if "always" not in item.meaning.lower():
                yield said(f"Always {short(value)}")
        case Unused(value, verdict):
            yield said(f"Unused, documented as {short(value)}")
            if _comes_with_position(device, item):
                yield said("Frames with other values are still decoded, with the verdict ", Code(verdict.value))
            else:
                yield said("Other values are still decoded")
        case CrcValue(crc, of):
            over = parted((Code(name),) for name in of) if of else ("everything before it",)
            yield said("CRC ", Ref("crc", crc, crc), " over ", *over)
        case Parity() as parity:
            covered = parted((Code(name),) for name in parity.covers)
            bits = f"{parity.over.replace('_', ' ')} of " if parity.over else ""
            yield said("Odd" if parity.is_odd else "Even", f" parity of {'the ' + bits if bits else ''}", *covered)
        case Decimal(runs):
            yield said("Decimal digits, most significant first: ", *parted(map(_run, runs)))
        case Text():
            yield said("ASCII text")
        case _ as kind:
            assert_never(kind)


def _comes_with_position(device: Device, item: Field) -> bool:
    """Return whether any frame contains both the field and the position."""
    return any(item in layout.fields and device.tells_position(kind.name, layout) for kind, layout in device.layouts())


def _number(kind: Number) -> Iterator[Said]:
    if kind.signed:
        yield said("Signed, in two's complement")
    if kind.zero_means:
        yield said("A value of 0 means ", Expression(kind.zero_means))
    if kind.power_of_two:
        yield said("Only powers of two are allowed")


def _flag(kind: Flag, implemented: bool) -> Iterator[Said]:
    active, other = (0, 1) if kind.active_low else (1, 0)
    if implemented or kind.when_active or kind.when_inactive:
        yield said(Level.ACTIVE, f" when {active}", f": {kind.when_active}" if kind.when_active else "")
        if kind.when_inactive:
            yield said(Level.INACTIVE, f" when {other}: {kind.when_inactive}")
    if kind.sums_up:
        yield said("Combines ", *listed(list(map(Code, kind.sums_up))))
    if kind.makes_position is Verdict.USABLE and implemented:
        yield said("It does not affect the position")
    elif kind.makes_position and implemented:
        instead = ". If a flag that it combines is active in the same frame, that flag decides instead"
        yield said(
            "While it is ", Level.WHILE_ACTIVE, f", {WORTH[kind.makes_position]}{instead if kind.sums_up else ''}"
        )
    if kind.verdict_if_set is not None and implemented:
        yield said("If you set ", Code(kind.verdict_parameter), f" to 1, {WORTH[kind.verdict_if_set]}")
    if kind.only:
        elsewhere = kind.unexplained.makes_position
        worth = f", and {WORTH[elsewhere]}" if elsewhere is not None else ""
        others = f". For other order codes the manual does not explain the flag{worth}"
        yield said("This applies only to ", Code(kind.only), others)


def _run(run: Digits) -> tuple[Part, ...]:
    return Code(run.name), f" {run.digits}", f" ({run.meaning})" if run.meaning else ""


def _known(value: Expression | int | str, bits: int) -> Part:
    if isinstance(value, str):
        return Code(value)
    return Hex(value if isinstance(value, Expression) else Expression(value), (bits + 3) // 4)


def choices(values: tuple[Value, ...]) -> Said:
    """Return all named values in one statement."""
    return said(*parted((f"{short(item.value)} ", Code(item.name)) for item in values), label="Values")


def value(item: Value, bits: int) -> Said:
    """Return a named value of a field of ``bits`` bits."""
    own = f" ({own_names(item)})" if own_names(item) else ""
    about = f": {item.meaning}" if item.meaning else ""
    number = f"{hexadecimal(item.value, (bits + 3) // 4)} "
    return said(number, Code(item.name), own, about, effect(item), source=item.source)


def effect(item: Value) -> str:
    """Return the verdict of a named value on the position as the end of a statement, or an empty string."""
    return f" ({WORTH[item.makes_position]})" if item.makes_position is not None else ""


def short(number: int) -> str:
    """Return a number below 10 in decimal, and any other number in the hexadecimal notation of manuals."""
    return f"{number}" if number < 10 else f"{number:X}h"
