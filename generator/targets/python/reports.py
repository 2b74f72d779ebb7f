"""What the class of a frame says of the encoder: the conditions of its reports, and of what its position is worth."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ...model import Field
from ...plan.codec import Codec, Part, Reserved
from ...plan.reports import Only, Reporting, Speaks
from .expr import Atom, Expr, Not, Operation, joined, mask
from .names import ClassNames


class FrameReports:
    """What a frame of the encoder tells, as its template asks for it; ``reporting`` is None where it tells nothing."""

    def __init__(
        self, reporting: Reporting | None, codec: Codec, names: ClassNames, parameters: Mapping[str, str]
    ) -> None:
        self._told = reporting.told if reporting is not None else ()
        self._judgement = reporting.judgement if reporting is not None else None
        self._reserved, self._names, self._parameters = codec.reserved, names, parameters

    @property
    def told(self) -> list[tuple[str, Expr]]:
        """The name of each report, and what is true while the frame makes it."""
        return [
            (item.report.name, joined("and", [*self._holds(item.only), self._active(item.by)])) for item in self._told
        ]

    @property
    def depends(self) -> bool:
        """Whether what it tells differs with the order code."""
        judged = self._judgement.worst_first if self._judgement is not None else ()
        conditions = [item.only for item in self._told] + [item.only for _, items in judged for item in items]
        return any(item is not None for item in conditions)

    def _holds(self, only: Only | None) -> list[Expr]:
        """What has to hold of the order code, if anything."""
        return [holding(only, f"self.variant.{self._parameters[only.parameter]}")] if only is not None else []

    @property
    def in_words(self) -> str:
        """What may be reported."""
        parts = (
            ("the flags that are active", any(isinstance(item.by, Part) for item in self._told)),
            ("unused bits that are not as the manual has them", bool(self._reserved)),
        )
        return ", and ".join(text for text, holds in parts if holds) or "nothing, with this frame"

    @property
    def worth(self) -> list[tuple[str, list[str]]]:
        """The verdicts that something in the frame leads to, the worst first, and the conditions of which one holds."""
        if self._judgement is None:
            return []
        return [(verdict.name, self._conditions(items)) for verdict, items in self._judgement.worst_first]

    @property
    def otherwise(self) -> str:
        """The verdict if nothing speaks; empty where the frame has no position."""
        return self._judgement.otherwise.name if self._judgement is not None else ""

    def name_of(self, field: Field) -> str:
        """The report that a field makes."""
        return next(item.report.name for item in self._told if item.by.field.name == field.name)

    def _active(self, by: Part | Reserved) -> Expr:
        return self._differ([by]) if isinstance(by, Reserved) else self._flag(by)

    def _flag(self, part: Part) -> Expr:
        return Atom(f"self.{self._names.attribute(part.field.name)}")

    def _differ(self, reserved: Sequence[Reserved]) -> Expr:
        """What is true while any of these unused bits is not as the manual has it."""
        unused = Atom("self.unused")
        return unused if _ones(reserved) == _ones(self._reserved) else Operation(unused, "&", mask(_ones(reserved)))

    def _conditions(self, items: Sequence[Speaks]) -> list[str]:
        """Flag by flag; unused bits are looked at together."""
        flags = [
            self._speaks(item.by, [*map(self._flag, item.unless)], item.only)
            for item in items
            if isinstance(item.by, Part)
        ]
        reserved = [item.by for item in items if isinstance(item.by, Reserved)]
        return [*flags, *([str(self._differ(reserved))] if reserved else [])]

    def _speaks(self, flag: Part, unless: Sequence[Expr], only: Only | None) -> str:
        """A flag that says nothing while one of the others is active, nor for other order codes."""
        others = [Not(joined("or", unless))] if unless else []
        conditions = [*self._holds(only), self._flag(flag), *others]
        return str(conditions[0]) if len(conditions) == 1 else f"({joined('and', conditions)})"


def _ones(reserved: Iterable[Reserved]) -> int:
    """Ones for unused bits, at their places."""
    return sum(((1 << item.bits.widest) - 1) << item.place for item in reserved)


def holding(only: Only, member: str) -> Expr:
    """What has to hold of an order code, by the ``member`` of its variant that tells it."""
    return Atom(member) if only.holds else Not(Atom(member))
