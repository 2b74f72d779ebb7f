"""The verdict on the position of a frame and its reports, written from flags, unused bits and values of its layout."""

from __future__ import annotations

from collections.abc import Iterator

from codewheel.model import Field, Flag, Unused, Verdict
from codewheel.plan.verdicts import reportings
from proof_layout import Codec


def report_functions(codec: Codec) -> Iterator[tuple[str, str, str]]:
    """Yield the functions of a frame about the encoder, the expected result for ``in``, and a description."""
    functions = codec.header.functions
    if f"{codec.name}_verdict" in functions:
        yield f"{codec.name}_verdict", _verdict(codec), "the worst that an active flag says of the position"
    if f"{codec.name}_reports" in functions:
        yield f"{codec.name}_reports", _reports(codec), "a bit for each active flag, and for unused bits that differ"


def _speaks(codec: Codec, field: Field) -> str:
    if isinstance(field.kind, Flag):
        return f"(in.{codec.member(field.name).name} != 0)"
    (place,) = (place for unused_field, place in codec.layout.unused if unused_field is field)
    return f"(((in.unused >> {place}) & {(1 << field.widest) - 1}ULL) != 0)"


def _speaking(codec: Codec) -> Iterator[tuple[Field, Verdict | None]]:
    for field in codec.layout.fields:
        if isinstance(field.kind, (Flag, Unused)):
            yield field, field.kind.makes_position


def _signs(codec: Codec) -> Iterator[tuple[str, str, Verdict]]:
    """Yield each named value with a verdict and each combination: its name, its condition in C, and the verdict."""
    for field in codec.layout.fields:
        for value in field.values:
            if value.makes_position is not None:
                yield f"{field.name}_{value.name}", _has_value(codec, field, value.name), value.makes_position
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
    by_name = {field.name: field for field, _ in _speaking(codec)}
    text = str(list(Verdict).index(Verdict.UNKNOWN))
    flags = [field.kind for field in codec.layout.fields if isinstance(field.kind, Flag)]
    signs = list(_signs(codec))
    tells = any(kind.makes_position is not Verdict.USABLE and not kind.only for kind in flags)
    tells = tells or any(effect is not Verdict.USABLE for _, _, effect in signs)
    if tells:
        text = str(list(Verdict).index(Verdict.USABLE))
    for verdict in (Verdict.USABLE_WITH_WARNING, Verdict.NOT_USABLE):
        saying = [condition for _, condition, effect in signs if effect is verdict]
        for field, effect in _speaking(codec):
            names = field.kind.sums_up if isinstance(field.kind, Flag) else ()
            no_part = "".join(f" && !{_speaks(codec, by_name[name])}" for name in names if name in by_name)
            answers = [answer for answer, answer_effect in _by_answer(field, effect) if answer_effect is verdict]
            saying += [f"({_explained(field)}{answer}{_speaks(codec, field)}{no_part})" for answer in answers]
            if _explained(field) and verdict is Verdict.USABLE_WITH_WARNING:
                saying.append(f"(!({_explained(field)}1) && {_speaks(codec, field)})")
        if saying and (tells or verdict is Verdict.NOT_USABLE):
            text = f"({' || '.join(saying)}) ? {list(Verdict).index(verdict)} : ({text})"
    return text


def _reports(codec: Codec) -> str:
    """Return the mask of reports. The plan defines the names of the bits, and each report has the name of its field."""
    frame = reportings(codec.device)[codec.layout.name]
    names = {}
    for cause in frame.causes:
        is_unexplained = cause.report.name.endswith("_unexplained")
        names[cause.cause.field.name, is_unexplained] = f"{codec.prefix}_report_{cause.report.name}".upper()
    terms = []
    for field, effect in _speaking(codec):
        cases = [case for case in _by_code(field) if case[0] or effect is not Verdict.USABLE]
        active = _speaks(codec, field)
        terms += [f"({explained}{active} ? {names[field.name, is_other]} : 0)" for is_other, explained in cases]
    signs = [(name, condition) for name, condition, effect in _signs(codec) if effect is not Verdict.USABLE]
    terms += [f"({condition} ? {names[name, False]} : 0)" for name, condition in signs]
    return " | ".join(terms)


def _explained(field: Field) -> str:
    """Return the condition on the order code under which the manual explains the flag."""
    limited = isinstance(field.kind, Flag) and field.kind.only_while
    return f"variant.{field.kind.only_while} != 0 && " if limited else ""  # type: ignore[union-attr]


def _by_answer(field: Field, verdict: Verdict | None) -> Iterator[tuple[str, Verdict | None]]:
    """Yield each verdict of an active flag with the condition on the user's answer for it."""
    if isinstance(field.kind, Flag) and field.kind.verdict_parameter:
        yield f"variant.{field.kind.verdict_parameter} == 0 && ", verdict
        yield f"variant.{field.kind.verdict_parameter} != 0 && ", field.kind.verdict_if_set
    else:
        yield "", verdict


def _by_code(field: Field) -> Iterator[tuple[bool, str]]:
    """Yield whether order codes have no explanation, and the condition for it."""
    yield False, _explained(field)
    if _explained(field):
        yield True, f"!({_explained(field)}1) && "
