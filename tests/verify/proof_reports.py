"""What the position of a frame is worth and what is reported, written from the flags and unused bits of its layout."""

from __future__ import annotations

from collections.abc import Iterator

from codewheel.model import Field, Flag, Unused, Verdict
from codewheel.plan.reports import reportings
from proof_layout import Codec


def told_of(codec: Codec) -> Iterator[tuple[str, str, str]]:
    """The functions of a frame that tell of the encoder, what each has to give for the struct ``in``, and in words."""
    functions = codec.header.functions
    if f"{codec.name}_verdict" in functions:
        yield f"{codec.name}_verdict", _verdict(codec), "the worst that an active flag says of the position"
    if f"{codec.name}_reports" in functions:
        yield f"{codec.name}_reports", _reports(codec), "a bit for each active flag, and for unused bits that differ"


def _speaks(codec: Codec, field: Field) -> str:
    if isinstance(field.kind, Flag):
        return f"(in.{codec.member(field.name).name} != 0)"
    (place,) = (place for item, place in codec.layout.unused if item is field)
    return f"(((in.unused >> {place}) & {(1 << field.widest) - 1}ULL) != 0)"


def _speaking(codec: Codec) -> Iterator[tuple[Field, Verdict | None]]:
    for item in codec.layout.fields:
        if isinstance(item.kind, (Flag, Unused)):
            yield item, item.kind.makes_position


def _verdict(codec: Codec) -> str:
    by_name = {item.name: item for item, _ in _speaking(codec)}
    text = str(list(Verdict).index(Verdict.NOT_TOLD))
    if any(isinstance(item.kind, Flag) and worth is not Verdict.USABLE for item, worth in _speaking(codec)):
        text = str(list(Verdict).index(Verdict.USABLE))
    for verdict in (Verdict.USABLE_WITH_WARNING, Verdict.NOT_USABLE):
        saying = []
        for item, worth in _speaking(codec):
            names = item.kind.sums_up if isinstance(item.kind, Flag) else ()
            others = "".join(f" && !{_speaks(codec, by_name[name])}" for name in names if name in by_name)
            saying += [f"({_speaks(codec, item)}{others})"] if worth is verdict else []
        if saying:
            text = f"({' || '.join(saying)}) ? {list(Verdict).index(verdict)} : ({text})"
    return text


def _reports(codec: Codec) -> str:
    """The names of the bits are those that the plan gives out; which field makes which report is its field's name."""
    (frame,) = (item for item in reportings(codec.device) if item.codec.layout.name == codec.layout.name)
    names = {told.by.field.name: told.report.name for told in frame.told}
    told = [
        f"({_speaks(codec, item)} ? {f'{codec.prefix}_report_{names[item.name]}'.upper()} : 0)"
        for item, worth in _speaking(codec)
        if worth is not Verdict.USABLE
    ]
    return " | ".join(told)
