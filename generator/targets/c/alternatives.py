"""Choices that a manual leaves open, in C: an enumeration of the answers, which is an argument of functions."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Alternative, Answer, Device, Parameter
from ...model.expressions import Expression
from ...model.record import dataclass
from ...say.errata import errata, erratum
from ...say.text import statement
from .enumerations import Entry, Enumeration
from .expr import Conditional, Expr, Name, Number, Operation
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

    def __init__(self, device: Device, prefix: str, alternative: Alternative) -> None:
        self.item = alternative
        self.type = f"{prefix}_{alternative.name}"
        self.argument = c_name(alternative.name, _TAKEN)
        #: Name of the chosen answer in the programs.
        self.constant = f"my_{alternative.name}"
        entries = tuple(self._entry(index, answer) for index, answer in enumerate(alternative.answers))
        about = [
            S.sentence(statement(alternative.meaning, source=alternative.source)),
            "Choose the answer for your encoder. No known source settles it, and there is no default.",
            *(S.sentence(erratum(correction)) for correction in errata(device, f"alternatives.{alternative.name}")),
        ]
        self.enumeration = Enumeration(self.type, about, (), entries, 1, ("alternatives", alternative.name))
        dependent = (parameter for parameter in device.parameters if parameter.alternative == alternative.name)
        self.functions = tuple(self._function(prefix, parameter) for parameter in dependent)

    def _entry(self, index: int, answer: Answer) -> Entry:
        note = S.sentence(statement(answer.meaning, source=answer.source))
        return Entry(f"{self.type}_{answer.name}".upper(), index, note)

    def _function(self, prefix: str, parameter: Parameter) -> AnsweredBy:
        about = S.sentence(statement(parameter.meaning, source=parameter.source))
        return AnsweredBy(f"{prefix}_{parameter.name}", about, self._value(parameter.name))

    def declared(self) -> Iterator[Declared]:
        """Yield its declarations at file scope."""
        yield from self.enumeration.declared()
        yield from ((function.name, self.enumeration.path) for function in self.functions)

    def _value(self, parameter: str) -> Expr:
        """Return the parameter as a function of the answer. The last answer is the default branch."""
        *other_values, last_value = (Number(answer.sets[parameter]) for answer in self.item.answers)
        expression: Expr = last_value
        for constant, value in reversed(list(zip(self.enumeration.entries, other_values, strict=False))):
            expression = Conditional(Operation("==", (Name(self.argument), Name(constant.name))), value, expression)
        return expression


def alternatives_in(alternatives: tuple[AlternativeCode, ...], *expressions: Expression) -> tuple[AlternativeCode, ...]:
    """Return the alternatives on whose answers these expressions depend."""
    names = {name for expression in expressions for name in expression.parameters}
    return tuple(alternative for alternative in alternatives if not names.isdisjoint(alternative.item.answers[0].sets))
