"""Verdict on the position of a frame: which flags and reserved bits decide it, for which order codes.

A valid frame may contain an unusable position, since an encoder with an error, or a busy one, also sends valid CRCs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field as dataclass_field
from dataclasses import replace

from ..model import Field, Flag, Verdict
from ..model.kinds import Choice, Constant, CrcValue, Decimal, Number, Parity, Text, Unused
from ..model.never import assert_never
from ..model.record import dataclass
from .codec import Codec, Part, Reserved


@dataclass(frozen=True, slots=True)
class Only:
    """Order codes selected by a parameter: those with a value other than 0 if ``holds`` is true, else those with 0.

    ``codes`` is the text in the spec for those with a value other than 0.
    """

    parameter: str
    holds: bool
    codes: str = dataclass_field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class Match:
    """Values of parts that decide a verdict together, like the active flag ``field``, which has no bits.

    The value of a flag is 1 while it is active.
    """

    field: Field
    conditions: tuple[tuple[Part, int], ...]


#: Cause of a verdict or a report: a flag, reserved bits, or values.
Cause = Part | Reserved | Match


@dataclass(frozen=True, slots=True)
class VerdictCause:
    """Cause of a verdict, unless one of the flags ``unless``, which it combines, is active.

    ``unless`` omits flags that lead to the same verdict or a worse one, since they make no difference. Without ``only``
    it applies to all order codes. If an answer of the user decides the verdict, ``chosen`` is the condition on the
    parameter that the answer sets.
    """

    by: Cause
    unless: tuple[Part, ...]
    only: Only | None = None
    chosen: Only | None = None

    @property
    def conditions(self) -> tuple[Only, ...]:
        """Conditions on parameters of the order code."""
        return tuple(condition for condition in (self.only, self.chosen) if condition is not None)


@dataclass(frozen=True, slots=True)
class Judgement:
    """Verdict on the position of a frame: that of the worst active cause, or ``otherwise`` if none is active.

    If ``otherwise`` is UNKNOWN, warnings have no effect, since UNKNOWN is worse than a warning.
    """

    not_usable: tuple[VerdictCause, ...]
    with_warning: tuple[VerdictCause, ...]
    otherwise: Verdict

    @property
    def worst_first(self) -> tuple[tuple[Verdict, tuple[VerdictCause, ...]], ...]:
        """Return the verdicts with their causes, worst first."""
        levels = ((Verdict.NOT_USABLE, self.not_usable), (Verdict.USABLE_WITH_WARNING, self.with_warning))
        return tuple(level for level in levels if level[1])


def judgement_of(codec: Codec) -> Judgement:
    """Return the verdict on the position of a frame, with everything that it depends on."""
    parts = {part.field.name: part for part in codec.parts}
    speaking: dict[Verdict, list[VerdictCause]] = {verdict: [] for verdict in Verdict}
    for cause in verdict_causes(codec):
        match cause.field.kind:
            case Flag():
                for flag, only in _by_worth(cause.field):
                    summed_parts = [parts[name] for name in flag.sums_up if name in parts]
                    for flag_verdict, chosen in _by_answer(flag):
                        unless = tuple(part for part in summed_parts if not _always_leads_to(part, flag_verdict, parts))
                        speaking[flag_verdict].append(VerdictCause(cause, unless, only, chosen))
            case Unused(makes_position=verdict):
                speaking[verdict].append(VerdictCause(cause, ()))
    tells = codec.layout.tells_validity
    warning = speaking[Verdict.USABLE_WITH_WARNING] if tells else ()
    otherwise = Verdict.USABLE if tells else Verdict.UNKNOWN
    return Judgement(tuple(speaking[Verdict.NOT_USABLE]), tuple(warning), otherwise)


def _by_worth(field: Field) -> Iterator[tuple[Flag, Only | None]]:
    """Yield the flag for each group of order codes that has a different verdict."""
    coded_flags = [(coded.kind, only) for coded, only in by_code(field) if isinstance(coded.kind, Flag)]
    alike = len({(kind.makes_position, kind.sums_up, kind.verdict_if_set) for kind, _ in coded_flags}) == 1
    yield from [(coded_flags[0][0], None)] if alike else coded_flags


def _by_answer(flag: Flag) -> Iterator[tuple[Verdict, Only | None]]:
    """Yield the verdicts of a flag, each with the condition on the answer that decides it."""
    if flag.makes_position is None:
        return
    if flag.verdict_if_set is None:
        yield flag.makes_position, None
        return
    yield flag.makes_position, Only(flag.verdict_parameter, False)
    yield flag.verdict_if_set, Only(flag.verdict_parameter, True)


def _always_leads_to(part: Part, verdict: Verdict, parts: Mapping[str, Part]) -> bool:
    """Return whether a flag always leads to ``verdict`` or a worse one."""
    match part.field.kind:
        case Flag(makes_position=flag_verdict, sums_up=names, only_while="", verdict_if_set=None) if (
            flag_verdict is not None
        ):
            worst_first = list(Verdict)
            return worst_first.index(flag_verdict) <= worst_first.index(verdict) and parts.keys().isdisjoint(names)
        case _:
            return False


def verdict_of(field: Field) -> Verdict | None:
    """Return the verdict on the position while a flag is active or unused bits differ, or None without a position."""
    match field.kind:
        case Flag(makes_position=verdict) | Unused(makes_position=verdict):
            return verdict
        case Number() | Choice() | Constant() | CrcValue() | Parity() | Decimal() | Text():
            return None
        case _:
            assert_never(field.kind)


def verdict_causes(codec: Codec) -> Iterator[Cause]:
    """Yield the flags, the reserved bits, and the values of a frame that can decide its verdict."""
    yield from (part for part in codec.parts if isinstance(part.field.kind, Flag))
    yield from codec.reserved
    parts = {part.field.name: part for part in codec.parts}
    for sign in codec.layout.signs:
        yield Match(sign.flag, tuple((parts[name], value) for name, value in sign.conditions))


def by_code(field: Field) -> Iterator[tuple[Field, Only | None]]:
    """Yield the field. If the manual explains it only for some order codes, yield a separate one for the others."""
    match field.kind:
        case Flag(only_while=parameter, only=codes) if parameter:
            yield field, Only(parameter, True, codes)
            yield unexplained(field), Only(parameter, False, codes)
        case _:
            yield field, None


def unexplained(field: Field) -> Field:
    """Return a flag as it is for order codes for which the manual does not explain it."""
    return replace(field.unexplained, name=f"{field.name}_unexplained")
