"""The context that all parts of a header share: the prefix of its names, enumerations, and open questions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from ...language.document import Path
from ...model import Alternative, Answer, Crc, Device, Field, Layout, Parameter, Register, RegisterMeaning, Value
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.crcs import kinds_of_covered_data
from ...plan.frames import held_parameters
from ...plan.values import NamedChoice, meaning_of
from ...say.errata import describe_erratum, errata_affecting
from ...say.names_and_evidence import name_in_words, printed_name_of, title_of
from ...say.register import describe_meaning
from ...say.text import Statement, spec_text, statement
from .comments import HEADER_STYLE, Paragraph
from .expressions import (
    BY_VALUE,
    CExpression,
    CName,
    CNumber,
    Conditional,
    COperation,
    ExpressionTranslator,
    StructPassing,
)
from .names import DeclaredName, c_name, unsigned


@dataclass(frozen=True, slots=True)
class EnumConstant:
    """A constant of an enumeration, with its comment."""

    name: str
    value: int
    note: str


@dataclass(frozen=True, slots=True)
class CEnumeration:
    """The named values of a field, as an enumeration in C, or as macros if a value is too large for an int.

    ``hex_digits`` is the number of hexadecimal digits of each value. ``statements`` are the statements about the field
    that the comment on the enumeration contains. ``path`` is the part of the spec with the field.
    """

    type: str
    about: Sequence[Paragraph] | str
    statements: tuple[Statement, ...]
    constants: tuple[EnumConstant, ...]
    hex_digits: int
    path: Path

    @property
    def is_enum(self) -> bool:
        """True if all values fit in a 16-bit int, the smallest one in C."""
        return max((constant.value for constant in self.constants), default=0) <= 0x7FFF

    @property
    def constant_by_value(self) -> Mapping[int, str]:
        """The names of the constants, by their values."""
        return {constant.value: constant.name for constant in self.constants}

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names of the type and of the constants, each with its part of the spec."""
        yield self.type, self.path
        for constant in self.constants:
            yield constant.name, self.path


class Enumerations:
    """The enumerations of a family.

    Fields with the same name and the same values share an enumeration. The only field of a register has its own, named
    after the register.

    ``enumeration_by_field`` contains the enumerations by owner and field. The owner is the name of a frame, or ``reg_``
    and the name of a register.
    """

    def __init__(self, device: Device, prefix: str) -> None:
        self.prefix = prefix
        self.enumeration_by_field: dict[tuple[str, str], CEnumeration] = {}
        self.all_enumerations: list[CEnumeration] = []
        #: By field name, the values and the enumeration of the first field with this name.
        self._shared: dict[str, tuple[Sequence[Value], CEnumeration]] = {}
        for interface, layout in device.layouts():
            path = ("interfaces", interface.name, "layouts", layout.name)
            for field in layout.fields:
                if isinstance(meaning_of(field), NamedChoice):
                    self._add_enumeration(layout.name, field, path=path)
        for register in device.registers:
            for field in register.layout.fields:
                if isinstance(meaning_of(field), NamedChoice):
                    self._add_for_register(register, field)

    def of(self, *path: str) -> list[CEnumeration]:
        """Return the enumerations of fields in a part of the spec, such as ``("registers", "status")``."""
        return [enumeration for enumeration in self.all_enumerations if enumeration.path[: len(path)] == path]

    def _add_for_register(self, register: Register, field: Field) -> None:
        """Add the enumeration of a field in a register. If it is the only field, its type is ``PREFIX_REGISTER``."""
        owner = f"reg_{register.name}"
        path = ("registers", register.name)
        if len(register.layout.fields) > 1:
            self._add_enumeration(owner, field, path=path)
            return
        # The facts about the only field are in the comment on the register.
        about = f"Values of {title_of(register)}."
        self._add_new(owner, field, path=path, type_=f"{self.prefix}_{register.name}", about=about, statements=())

    def _add_enumeration(self, owner: str, field: Field, path: Path) -> None:
        """Add the enumeration of a field, or share the one of an earlier field with the same name and values.

        The type for the first field with a name is ``PREFIX_FIELD``. For fields of the same name with other values, it
        is ``PREFIX_OWNER_FIELD``.
        """
        statements = tuple(describe_meaning(field, field.meaning))
        about = HEADER_STYLE.paragraph(statements) or f"Values of {title_of(field)}."
        if field.name not in self._shared:
            type_ = f"{self.prefix}_{field.name}"
            enumeration = self._add_new(owner, field, path=path, type_=type_, about=about, statements=statements)
            self._shared[field.name] = (field.values, enumeration)
            return
        shared_values, shared_enumeration = self._shared[field.name]
        if shared_values == field.values:
            self.enumeration_by_field[owner, field.name] = shared_enumeration
        else:
            type_ = f"{self.prefix}_{path[-1]}_{field.name}"
            self._add_new(owner, field, path=path, type_=type_, about=about, statements=statements)

    def _add_new(
        self, owner: str, field: Field, path: Path, *, type_: str, about: str, statements: tuple[Statement, ...]
    ) -> CEnumeration:
        """Add and return a new enumeration with the values of a field.

        ``statements`` are the statements about the field in the comment ``about``.
        """
        constants: list[EnumConstant] = []
        for value in field.values:
            name = f"{type_}_{value.name}".upper()
            constants.append(EnumConstant(name=name, value=value.value, note=_describe_constant(value)))
        enumeration = CEnumeration(
            type=type_,
            about=about,
            statements=statements,
            constants=tuple(constants),
            # A hexadecimal digit for each 4 bits, rounded up.
            hex_digits=(field.widest + 3) // 4,
            path=path,
        )
        self.enumeration_by_field[owner, field.name] = enumeration
        self.all_enumerations.append(enumeration)
        return enumeration


def _describe_constant(value: Value) -> str:
    """Return the comment on a constant: the name that the manual prints and the meaning of the value, with its source.

    A printed name that equals the name of the constant is left out. Without a text, the comment is the name in words.
    """
    is_named_as_printed = printed_name_of(value).lower() == value.name
    statements = spec_text(value.meaning) if is_named_as_printed else describe_meaning(value, value.meaning)
    description = HEADER_STYLE.paragraph(replace(statement, source=value.source) for statement in statements)
    return description or name_in_words(value.name)


#: Names of the other arguments and locals in the functions of a frame.
_NAMES_OF_LOCALS = frozenset(
    "bits bytes code crc flags frame in length out plain position received rx unused value variant verdict word".split()
)


@dataclass(frozen=True, slots=True)
class AnsweredBy:
    """The function ``name`` that returns a parameter which depends on the user's answer, and its value as C."""

    name: str
    about: str
    value: CExpression


class AlternativeCode:
    """A question that the manual leaves open (an alternative), as an enumeration of its answers.

    ``argument`` is the name of the function argument for the user's answer.
    """

    def __init__(self, device: Device, prefix: str, alternative: Alternative) -> None:
        self.spec_question = alternative
        self.type = f"{prefix}_{alternative.name}"
        self.argument = c_name(alternative.name, _NAMES_OF_LOCALS)
        #: Name of the constant for the answer in the example programs.
        self.constant = f"my_{alternative.name}"
        about = [
            HEADER_STYLE.sentence(statement(alternative.meaning, source=alternative.source)),
            "Choose the answer for your encoder. No known source settles it, and there is no default.",
        ]
        for correction in errata_affecting(device, f"alternatives.{alternative.name}"):
            about.append(HEADER_STYLE.sentence(describe_erratum(correction)))
        self.enumeration = CEnumeration(
            type=self.type,
            about=about,
            statements=(),
            constants=tuple(self._build_constant(index, answer) for index, answer in enumerate(alternative.answers)),
            hex_digits=1,
            path=("alternatives", alternative.name),
        )
        dependent = (parameter for parameter in device.parameters if parameter.alternative == alternative.name)
        self.functions = tuple(self._build_function(prefix, parameter) for parameter in dependent)

    def _build_constant(self, index: int, answer: Answer) -> EnumConstant:
        note = HEADER_STYLE.sentence(statement(answer.meaning, source=answer.source))
        return EnumConstant(name=f"{self.type}_{answer.name}".upper(), value=index, note=note)

    def _build_function(self, prefix: str, parameter: Parameter) -> AnsweredBy:
        about = HEADER_STYLE.sentence(statement(parameter.meaning, source=parameter.source))
        return AnsweredBy(name=f"{prefix}_{parameter.name}", about=about, value=self._express_parameter(parameter.name))

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names at file scope, each with its part of the spec."""
        yield from self.enumeration.declared()
        yield from ((function.name, self.enumeration.path) for function in self.functions)

    def _express_parameter(self, parameter: str) -> CExpression:
        """Return the value of a parameter by answer, as C, such as ``code == CODE_GRAY ? 1U : 0U``."""
        *other_answers, last_answer = self.spec_question.answers
        # The enumeration has a constant for each answer, in the same order.
        *other_constants, _ = self.enumeration.constants
        value: CExpression = CNumber(last_answer.sets[parameter])
        for constant, answer in reversed(list(zip(other_constants, other_answers, strict=True))):
            is_answer = COperation("==", (CName(self.argument), CName(constant.name)))
            value = Conditional(is_answer, value_if_true=CNumber(answer.sets[parameter]), value_if_false=value)
        return value


def alternatives_in(alternatives: tuple[AlternativeCode, ...], *expressions: Expression) -> tuple[AlternativeCode, ...]:
    """Return the open questions (alternatives) whose answers these expressions depend on."""
    used_parameters: set[str] = set()
    for expression in expressions:
        used_parameters.update(expression.parameters)
    needed_alternatives: list[AlternativeCode] = []
    for alternative in alternatives:
        # All answers set the same parameters.
        parameters_of_answers = alternative.spec_question.answers[0].sets
        if not used_parameters.isdisjoint(parameters_of_answers):
            needed_alternatives.append(alternative)
    return tuple(needed_alternatives)


class HeaderContext:
    """The values that all parts of the headers of one interface share, such as the prefix of the names.

    ``device`` must have only this interface. ``prefix`` begins every name, and is also the name of the type that holds
    an order code (the variant). The values never change.
    """

    def __init__(self, device: Device, passing: StructPassing = BY_VALUE) -> None:
        self.device = device
        self.passing = passing
        self.maker = device.manufacturer
        # The device was narrowed to one interface.
        (self.interface,) = device.interfaces
        self.stem = f"{device.name}_{self.interface.name}"
        self.prefix = f"{device.manufacturer.name}_{self.stem}"
        self.PREFIX = self.prefix.upper()
        #: The questions that the manual leaves open, which users must answer, since there is no default.
        open_questions = (alternative for alternative in device.alternatives if not alternative.default)
        self.alternatives = tuple(AlternativeCode(device, self.prefix, question) for question in open_questions)
        argument_by_parameter: dict[str, str] = {}
        for alternative in self.alternatives:
            # All answers of an alternative set the same parameters.
            argument_by_parameter |= dict.fromkeys(alternative.spec_question.answers[0].sets, alternative.argument)
        self.translator = ExpressionTranslator(
            prefix=self.prefix, largest=_largest_values(device), answers=argument_by_parameter, passing=passing
        )
        self.enumerations = Enumerations(device, self.prefix)
        self.enumeration_by_field = self.enumerations.enumeration_by_field

    def crc_name(self, crc: Crc, carried_as: str) -> str:
        """Return the name of the function that computes a CRC over ``bits`` or over ``bytes`` (``carried_as``).

        If frames need the CRC over both, there are two functions, and the one over bits ends in ``_bits``.
        """
        is_second_function = carried_as == "bits" and len(kinds_of_covered_data(self.device, crc)) > 1
        ending = "_bits" if is_second_function else ""
        return f"{self.prefix}_crc_{crc.name}{ending}"

    def length_macro(self, layout: Layout) -> str:
        """Return the macro for the number of bytes in a frame."""
        return f"{self.PREFIX}_{layout.name}_LENGTH".upper()

    def limit(
        self,
        register: Register,
        meaning: RegisterMeaning | None,
        side: str,
        limit: Expression,
        variant: str = "variant",
    ) -> str:
        """Return the C expression of a limit of a register: a macro if the limit is the same for all order codes.

        Otherwise it is a call such as ``acme_x_reg_preset_max(variant)``. ``side`` is ``min`` or ``max``. A ``meaning``
        is one of several uses of the register, with its own limits, and None stands for the register itself.
        """
        stem = f"{self.prefix}_reg_{register.name}"
        name = f"{stem}_{side}" if meaning is None else f"{stem}_{meaning.name}_{side}"
        return name.upper() if limit.is_constant else f"{name}({variant})"

    def member_type(self, parameter: Parameter) -> str:
        """Return the type of a parameter in the variant."""
        return unsigned(self.translator.largest[parameter.name].bit_length())


def _largest_values(device: Device) -> dict[str, int]:
    """Return the highest value of each parameter that order codes set.

    If a register of the encoder can change the parameter, the highest value that the register can have counts, too.
    """
    largest = {parameter.name: parameter.largest for parameter in device.set_parameters}
    for holding_register in held_parameters(device):
        for held_parameter in holding_register.parameters:
            name = held_parameter.parameter.name
            if name in largest:
                largest[name] = max(largest[name], held_parameter.highest_value)
    return largest
