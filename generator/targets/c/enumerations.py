"""Enumerations in C: the named values of fields, and the answers to choices that a manual leaves open."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from ...language.document import Path
from ...model import Alternative, Answer, Device, Field, Parameter, Value
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.values import Named, meaning_of
from ...say.errata import errata, erratum
from ...say.names_and_places import printed, title, words
from ...say.register import meaning
from ...say.text import Statement, spec_text, statement
from .comments import Paragraph, S
from .expr import Conditional, Expr, Name, Number, Operation
from .names import Declared, c_name


@dataclass(frozen=True, slots=True)
class Entry:
    name: str
    value: int
    note: str


@dataclass(frozen=True, slots=True)
class Enumeration:
    """The named values of a field, each with ``digits`` hexadecimal digits. Values too large for an int become macros.

    ``statements`` contains the statements about the field that are in its comment.
    """

    type: str
    about: Sequence[Paragraph] | str
    statements: tuple[Statement, ...]
    entries: tuple[Entry, ...]
    digits: int
    path: Path

    @property
    def is_enum(self) -> bool:
        return max((constant.value for constant in self.entries), default=0) <= 0x7FFF

    @property
    def names(self) -> Mapping[int, str]:
        return {constant.value: constant.name for constant in self.entries}

    def declared(self) -> Iterator[Declared]:
        yield self.type, self.path
        yield from ((constant.name, self.path) for constant in self.entries)


class Enumerations:
    """The enumerations of a family. Fields of one name and the same values share one, except a register's only field.

    ``choices`` has them by owner and field. The owner is a layout, or ``reg_`` and a register.
    """

    def __init__(self, device: Device, prefix: str) -> None:
        self.prefix = prefix
        self.choices: dict[tuple[str, str], Enumeration] = {}
        self.all: list[Enumeration] = []
        self._shared: dict[str, tuple[Sequence[Value], Enumeration]] = {}
        for interface, layout in device.layouts():
            path = ("interfaces", interface.name, "layouts", layout.name)
            for field in layout.fields:
                if isinstance(meaning_of(field), Named):
                    self._add(layout.name, field, path)
        for register in device.registers:
            for field in register.layout.fields:
                if isinstance(meaning_of(field), Named):
                    sole = title(register) if len(register.layout.fields) == 1 else ""
                    self._add(f"reg_{register.name}", field, ("registers", register.name), sole)

    def of(self, *path: str) -> list[Enumeration]:
        """Return those declared with this part of the spec, or with one inside it."""
        return [enumeration for enumeration in self.all if enumeration.path[: len(path)] == path]

    def _add(self, owner: str, field: Field, path: Path, sole: str = "") -> None:
        shared = self._shared.get(field.name)
        if shared is not None and shared[0] == field.values and not sole:
            self.choices[owner, field.name] = shared[1]
            return
        if sole:
            name = f"{self.prefix}_{path[-1]}"
        else:
            name = f"{self.prefix}_{field.name}" if shared is None else f"{self.prefix}_{path[-1]}_{field.name}"
        entries = (Entry(f"{name}_{value.name}".upper(), value.value, _note(value)) for value in field.values)
        about = () if sole else tuple(meaning(field, field.meaning))
        text = S.paragraph(about) or f"Values of {sole or title(field)}."
        enumeration = Enumeration(name, text, about, tuple(entries), (field.widest + 3) // 4, path)
        if shared is None and not sole:
            self._shared[field.name] = (field.values, enumeration)
        self.choices[owner, field.name] = enumeration
        self.all.append(enumeration)


def _note(value: Value) -> str:
    # Omit a printed name of one word that the constant already has. Keep longer ones, for readers who search for them.
    about = spec_text(value.meaning) if printed(value).lower() == value.name else meaning(value, value.meaning)
    return S.paragraph(replace(statement, source=value.source) for statement in about) or words(value.name)


#: Names of the other arguments and locals in the functions of a frame.
_TAKEN = frozenset(
    "bits bytes code crc flags frame in length out plain position received rx unused value variant verdict word".split()
)


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
