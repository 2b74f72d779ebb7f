"""The verdict on the position of a frame and its reports, written from flags, unused bits and values of its layout."""

from __future__ import annotations

from collections.abc import Iterator

from codewheel.model import Field, Flag, Unused, Verdict
from codewheel.plan.reports import reportings
from proof_layout import Codec


def told_of(codec: Codec) -> Iterator[tuple[str, str, str]]:
    """Yield the functions of a frame about the encoder, the expected result for ``in``, and a description."""
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


def _signs(codec: Codec) -> Iterator[tuple[str, str, Verdict]]:
    """Yield each named value with a verdict and each combination: its name, its condition in C, and the verdict."""
    for item in codec.layout.fields:
        for value in item.values:
            if value.makes_position is not None:
                yield f"{item.name}_{value.name}", _has_value(codec, item, value.name), value.makes_position
    for combination in codec.layout.combinations:
        pairs = [text.split(".") for text in combination.when]
        conditions = [_has_value(codec, codec.layout.field(name), word) for name, word in pairs]
        yield combination.name, f"({' && '.join(conditions)})", combination.makes_position


def _has_value(codec: Codec, field: Field, word: str) -> str:
    if isinstance(field.kind, Flag):
        return _speaks(codec, field) if word == "active" else f"!{_speaks(codec, field)}"
    (number,) = (value.value for value in field.values if value.name == word)
    return f"((unsigned long long)in.{codec.member(field.name).name} == {number}ULL)"


def _verdict(codec: Codec) -> str:
    by_name = {item.name: item for item, _ in _speaking(codec)}
    text = str(list(Verdict).index(Verdict.UNKNOWN))
    flags = [item.kind for item in codec.layout.fields if isinstance(item.kind, Flag)]
    signs = list(_signs(codec))
    tells = any(kind.makes_position is not Verdict.USABLE and not kind.only for kind in flags)
    tells = tells or any(worth is not Verdict.USABLE for _, _, worth in signs)
    if tells:
        text = str(list(Verdict).index(Verdict.USABLE))
    for verdict in (Verdict.USABLE_WITH_WARNING, Verdict.NOT_USABLE):
        saying = [condition for _, condition, worth in signs if worth is verdict]
        for item, worth in _speaking(codec):
            names = item.kind.sums_up if isinstance(item.kind, Flag) else ()
            others = "".join(f" && !{_speaks(codec, by_name[name])}" for name in names if name in by_name)
            saying += [
                f"({_explained(item)}{answered}{_speaks(codec, item)}{others})"
                for answered, answered_worth in _by_answer(item, worth)
                if answered_worth is verdict
            ]
            if _explained(item) and verdict is Verdict.USABLE_WITH_WARNING:
                saying.append(f"(!({_explained(item)}1) && {_speaks(codec, item)})")
        if saying and (tells or verdict is Verdict.NOT_USABLE):
            text = f"({' || '.join(saying)}) ? {list(Verdict).index(verdict)} : ({text})"
    return text


def _reports(codec: Codec) -> str:
    """Return the mask of reports. The plan defines the names of the bits, and each report has the name of its field."""
    (frame,) = (item for item in reportings(codec.device) if item.codec.layout.name == codec.layout.name)
    names = {(told.by.field.name, told.report.name.endswith("_unexplained")): told.report.name for told in frame.causes}
    told = [
        f"({explained}{_speaks(codec, item)} ? {f'{codec.prefix}_report_{names[item.name, is_other]}'.upper()} : 0)"
        for item, worth in _speaking(codec)
        for is_other, explained in _by_code(item)
        if is_other or worth is not Verdict.USABLE
    ]
    told += [
        f"({condition} ? {f'{codec.prefix}_report_{names[name, False]}'.upper()} : 0)"
        for name, condition, worth in _signs(codec)
        if worth is not Verdict.USABLE
    ]
    return " | ".join(told)


def _explained(field: Field) -> str:
    """Return the condition on the order code under which the manual explains the flag."""
    limited = isinstance(field.kind, Flag) and field.kind.only_while
    return f"variant.{field.kind.only_while} != 0 && " if limited else ""  # type: ignore[union-attr]


def _by_answer(field: Field, verdict: Verdict | None) -> Iterator[tuple[str, Verdict | None]]:
    """Yield each verdict of an active flag with the condition on the user's answer under which it holds."""
    if isinstance(field.kind, Flag) and field.kind.verdict_parameter:
        yield f"variant.{field.kind.verdict_parameter} == 0 && ", verdict
        yield f"variant.{field.kind.verdict_parameter} != 0 && ", field.kind.verdict_if_set
    else:
        yield "", verdict


def _by_code(field: Field) -> Iterator[tuple[bool, str]]:
    """Yield whether order codes are those without an explanation, and the condition for it."""
    yield False, _explained(field)
    if _explained(field):
        yield True, f"!({_explained(field)}1) && "
