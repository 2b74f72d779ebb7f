"""Reports and verdict of a frame: the conditions for each, as Python expressions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ...model import Field, Flag, Verdict, first_of
from ...plan.codec import Codec
from ...plan.operations import Part, Reserved
from ...plan.verdicts import Match, Only, ReportCause, Reporting, VerdictCause
from .expr import Atom, Expr, Not, Operation, coded, joined, mask
from .names import ClassNames


class FrameReports:
    """Reports and verdict of a frame, for its template. ``reporting`` is None if the frame has no reports.

    ``attribute_of`` returns the expression of an attribute of the frame.
    """

    def __init__(
        self,
        reporting: Reporting | None,
        codec: Codec,
        names: ClassNames,
        parameters: Mapping[str, str],
        attribute_of: Callable[[str], str] = "self.{}".format,
    ) -> None:
        self._told = reporting.causes if reporting is not None else ()
        self._judgement = reporting.judgement if reporting is not None else None
        self._reserved, self._names, self._parameters, self._own = codec.reserved, names, parameters, attribute_of

    @property
    def depends(self) -> bool:
        """True if any condition depends on the order code."""
        judged = self._judgement.worst_first if self._judgement is not None else ()
        causes: list[ReportCause | VerdictCause] = [
            *self._told,
            *(cause for _, speakers in judged for cause in speakers),
        ]
        return any(cause.conditions for cause in causes)

    def _holds(self, only: Only) -> Expr:
        """Return the condition on a parameter of the encoder."""
        return holding(only, f"{self._own('variant')}.{self._parameters[only.parameter]}")

    @property
    def verdict_conditions(self) -> list[tuple[str, list[str]]]:
        """Verdicts that flags or bits of the frame lead to, worst first. Any of a verdict's conditions is enough."""
        if self._judgement is None:
            return []
        return [(verdict.name, self._conditions(items)) for verdict, items in self._judgement.worst_first]

    @property
    def not_usable(self) -> list[str]:
        """Conditions under which the position is not usable."""
        judged = self._judgement.worst_first if self._judgement is not None else ()
        return next((self._conditions(items) for verdict, items in judged if verdict is Verdict.NOT_USABLE), [])

    @property
    def otherwise(self) -> str:
        """Verdict if no condition applies. Empty if the frame has no position."""
        return self._judgement.otherwise.name if self._judgement is not None else ""

    def name_of(self, field: Field) -> str:
        """Return the name of a field's report."""
        causes = (cause for cause in self._told if cause.by.field.name == field.name)
        return first_of(causes, f"report about '{field.name}'").report.name

    def _flag(self, part: Part) -> Expr:
        return Atom(self._own(self._names.attribute(part.field.name)))

    def _differ(self, reserved: Sequence[Reserved]) -> Expr:
        """Return the condition that any of these unused bits differs from the manual."""
        unused = Atom(self._own("unused"))
        all_bits = sum(bits.mask for bits in self._reserved)
        reserved_bits = sum(bits.mask for bits in reserved)
        return unused if reserved_bits == all_bits else Operation(unused, "&", mask(reserved_bits))

    def _conditions(self, causes: Sequence[VerdictCause]) -> list[str]:
        """Return a condition for each flag and each match of values, and one for all unused bits."""
        conditions, reserved = [], []
        for cause in causes:
            if isinstance(cause.by, Reserved):
                reserved.append(cause.by)
            else:
                conditions.append(self._speaks(cause.by, [*map(self._flag, cause.unless)], cause.conditions))
        if reserved:
            conditions.append(str(self._differ(reserved)))
        return conditions

    def _match(self, match: Match) -> list[Expr]:
        """Return a condition for each value of a match."""
        conditions: list[Expr] = []
        for part, value in match.conditions:
            attribute = self._flag(part)
            if isinstance(part.field.kind, Flag):
                conditions.append(attribute if value else Not(attribute))
            else:
                conditions.append(Atom(f"{attribute} == {coded(value)}"))
        return conditions

    def _speaks(self, by: Part | Match, unless: Sequence[Expr], only: Sequence[Only]) -> str:
        """Return the condition for a cause. It is ignored while certain flags are active, and for other order codes."""
        inactive = [Not(joined("or", unless))] if unless else []
        active = self._match(by) if isinstance(by, Match) else [self._flag(by)]
        # The flag comes first, because it is rarely active. The other conditions are then skipped.
        conditions = [*active, *map(self._holds, only), *inactive]
        return str(conditions[0]) if len(conditions) == 1 else f"({joined('and', conditions)})"


def holding(only: Only, member: str) -> Expr:
    """Return the condition that ``member`` of the variant holds for an order code."""
    return Atom(member) if only.holds else Not(Atom(member))
