"""Reports and verdict of a frame: the conditions for each, as Python expressions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ...model import Field
from ...plan.codec import Codec, Part, Reserved
from ...plan.reports import Only, Reporting, Speaks
from .expr import Atom, Expr, Not, Operation, joined, mask
from .names import ClassNames


class FrameReports:
    """Reports and verdict of a frame, for its template. ``reporting`` is None if the frame has no reports."""

    def __init__(
        self, reporting: Reporting | None, codec: Codec, names: ClassNames, parameters: Mapping[str, str]
    ) -> None:
        self._told = reporting.told if reporting is not None else ()
        self._judgement = reporting.judgement if reporting is not None else None
        self._reserved, self._names, self._parameters = codec.reserved, names, parameters

    @property
    def told(self) -> list[tuple[str, Expr]]:
        """Name and condition of each report."""
        return [
            (item.report.name, joined("and", [*self._holds(item.only), self._active(item.by)])) for item in self._told
        ]

    @property
    def depends(self) -> bool:
        """True if any condition depends on the order code."""
        judged = self._judgement.worst_first if self._judgement is not None else ()
        conditions = [item.only for item in self._told] + [item.only for _, items in judged for item in items]
        return any(item is not None for item in conditions)

    def _holds(self, only: Only | None) -> list[Expr]:
        """Return the condition that applies to the order code, if there is one."""
        return [holding(only, f"self.variant.{self._parameters[only.parameter]}")] if only is not None else []

    @property
    def in_words(self) -> str:
        """Description of the reports."""
        parts = (
            ("active flags", any(isinstance(item.by, Part) for item in self._told)),
            ("unused bits that differ from the manual", bool(self._reserved)),
        )
        return " and ".join(text for text, holds in parts if holds) or "none in this frame"

    @property
    def worth(self) -> list[tuple[str, list[str]]]:
        """Verdicts that flags or bits of the frame lead to, worst first. Any of a verdict's conditions is enough."""
        if self._judgement is None:
            return []
        return [(verdict.name, self._conditions(items)) for verdict, items in self._judgement.worst_first]

    @property
    def otherwise(self) -> str:
        """Verdict if no condition applies. Empty if the frame has no position."""
        return self._judgement.otherwise.name if self._judgement is not None else ""

    def name_of(self, field: Field) -> str:
        """Return the name of a field's report."""
        return next(item.report.name for item in self._told if item.by.field.name == field.name)

    def _active(self, by: Part | Reserved) -> Expr:
        return self._differ([by]) if isinstance(by, Reserved) else self._flag(by)

    def _flag(self, part: Part) -> Expr:
        return Atom(f"self.{self._names.attribute(part.field.name)}")

    def _differ(self, reserved: Sequence[Reserved]) -> Expr:
        """Return the condition that any of these unused bits differs from the manual."""
        unused = Atom("self.unused")
        return unused if _ones(reserved) == _ones(self._reserved) else Operation(unused, "&", mask(_ones(reserved)))

    def _conditions(self, items: Sequence[Speaks]) -> list[str]:
        """Return a condition for each flag, and one for all unused bits."""
        flags = [
            self._speaks(item.by, [*map(self._flag, item.unless)], item.only)
            for item in items
            if isinstance(item.by, Part)
        ]
        reserved = [item.by for item in items if isinstance(item.by, Reserved)]
        return [*flags, *([str(self._differ(reserved))] if reserved else [])]

    def _speaks(self, flag: Part, unless: Sequence[Expr], only: Only | None) -> str:
        """Return the condition for a flag. It is ignored while certain others are active, and for other order codes."""
        others = [Not(joined("or", unless))] if unless else []
        # The flag comes first, because it is rarely active, and the other conditions are then not evaluated.
        conditions = [self._flag(flag), *self._holds(only), *others]
        return str(conditions[0]) if len(conditions) == 1 else f"({joined('and', conditions)})"


def _ones(reserved: Iterable[Reserved]) -> int:
    """Return a mask of unused bits."""
    return sum(((1 << item.bits.widest) - 1) << item.place for item in reserved)


def holding(only: Only, member: str) -> Expr:
    """Return the condition that ``member`` of the variant holds for an order code."""
    return Atom(member) if only.holds else Not(Atom(member))
