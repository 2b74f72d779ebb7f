"""What the class of a frame says of the encoder: the conditions of its reports, and of what its position is worth."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ...model import Field
from ...plan.codec import Codec, Part, Reserved
from ...plan.reports import Reporting, Speaks
from .expr import Atom, Expr, Not, Operation, joined, mask
from .names import ClassNames


class FrameReports:
    """What a frame of the encoder tells, as its template asks for it; ``reporting`` is None where it tells nothing."""

    def __init__(self, reporting: Reporting | None, codec: Codec, names: ClassNames) -> None:
        self._told = reporting.told if reporting is not None else ()
        self._judgement = reporting.judgement if reporting is not None else None
        self._reserved, self._names = codec.reserved, names

    @property
    def told(self) -> list[tuple[str, Expr]]:
        """The name of each report, and what is true while the frame makes it."""
        return [(item.report.name, self._active(item.by)) for item in self._told]

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
        speaking = (("NOT_USABLE", self._judgement.not_usable), ("USABLE_WITH_WARNING", self._judgement.with_warning))
        return [(verdict, self._conditions(items)) for verdict, items in speaking if items]

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
        flags = [(self._flag(item.by), map(self._flag, item.unless)) for item in items if isinstance(item.by, Part)]
        reserved = [item.by for item in items if isinstance(item.by, Reserved)]
        return [*(_unless(*item) for item in flags), *([str(self._differ(reserved))] if reserved else [])]


def _ones(reserved: Iterable[Reserved]) -> int:
    """Ones for unused bits, at their places."""
    return sum(((1 << item.bits.widest) - 1) << item.place for item in reserved)


def _unless(flag: Expr, others: Iterable[Expr]) -> str:
    """A flag that says nothing while one of the others is active."""
    active = [*others]
    return f"({Operation(flag, 'and', Not(joined('or', active)))})" if active else str(flag)
