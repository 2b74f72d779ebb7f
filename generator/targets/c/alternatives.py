"""Choices that a manual leaves open, in C: an enumeration of the answers, which is an argument of functions."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Alternative, Device
from ...model.expressions import Expression
from ...model.record import dataclass
from ...say.erratum import errata, erratum
from ...say.text import said
from .enumerations import Entry, Enumeration
from .expr import Either, Expr, Name, Number, Operation
from .names import Declared
from .reserved import c_name
from .style import S

#: Names of the other arguments and locals in the functions of a frame.
_TAKEN = frozenset(("bytes", "crc", "flags", "in", "length", "out", "plain", "unused", "variant", "word"))


@dataclass(frozen=True, slots=True)
class AnsweredBy:
    """A parameter that follows from the answer: the function that gives it, and its value."""

    name: str
    about: str
    value: Expr


class AlternativeCode:
    """An alternative. ``argument`` is the name of the argument for the answer."""

    def __init__(self, device: Device, prefix: str, item: Alternative) -> None:
        self.item = item
        self.type = f"{prefix}_{item.name}"
        self.argument = c_name(item.name, _TAKEN)
        #: Name of the chosen answer in the programs.
        self.constant = f"my_{item.name}"
        entries = tuple(
            Entry(f"{self.type}_{answer.name}".upper(), index, S.sentence(said(answer.meaning, source=answer.source)))
            for index, answer in enumerate(item.answers)
        )
        about = [
            S.sentence(said(item.meaning, source=item.source)),
            "Choose the answer for your encoder. No known source settles it, and there is no default.",
            *(S.sentence(erratum(one)) for one in errata(device, f"alternatives.{item.name}")),
        ]
        self.enumeration = Enumeration(self.type, about, (), entries, 1, ("alternatives", item.name))
        self.functions = tuple(
            AnsweredBy(f"{prefix}_{one.name}", S.sentence(said(one.meaning, source=one.source)), self._value(one.name))
            for one in device.parameters
            if one.alternative == item.name
        )

    def declared(self) -> Iterator[Declared]:
        """Yield its declarations at file scope."""
        yield from self.enumeration.declared()
        yield from ((item.name, self.enumeration.path) for item in self.functions)

    def _value(self, parameter: str) -> Expr:
        """Return the parameter as a function of the answer. The last answer is the default branch."""
        *others, value = (Number(answer.sets[parameter]) for answer in self.item.answers)
        found: Expr = value
        for entry, other in reversed(list(zip(self.enumeration.entries, others, strict=False))):
            found = Either(Operation("==", (Name(self.argument), Name(entry.name))), other, found)
        return found


def asked(alternatives: tuple[AlternativeCode, ...], *expressions: Expression) -> tuple[AlternativeCode, ...]:
    """Return the alternatives on whose answers these expressions depend."""
    names = {name for item in expressions for name in item.parameters}
    return tuple(item for item in alternatives if not names.isdisjoint(item.item.answers[0].sets))
