"""The class of a frame or register in Python: its names and attributes, and how they depend on the order code."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property

from ...model import Digits, Fault, Field, Layout, Register
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.codec import layout_plan_of
from ...plan.crcs import covered_data_of
from ...plan.limits import NumberLimits, limits_of, powers_of_two
from ...plan.operations import FieldToDecode, FrameCrc, JoinedNumber
from ...plan.values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    NamedChoice,
    UnsignedNumber,
    is_named,
    is_number,
    meaning_of,
)
from ...say import text_on_one_line
from ...say.text import as_sentence
from . import docstrings
from .bits import BitsEncoder
from .decode import Decoder
from .literals import Atom, ParameterExpressions, PythonExpression, coded, quoted, value_in_words
from .names import ClassNames, ModuleContext, OpenQuestion, encoder_name, interface_name
from .reports import FrameReports
from .values import LimitsFunction, NamedValues, attribute_values, limits_depend, limits_functions


@dataclass(frozen=True)
class Attribute:
    """Attribute of the class of a frame or register. ``default`` is its default value, empty if it has none."""

    name: str
    type: str
    meaning: str
    default: str = ""


class LayoutClass:
    """The class of a frame, or with ``register`` of a register, as its template prints it."""

    def __init__(
        self, context: ModuleContext, interface: str, layout: Layout, register: Register | None = None
    ) -> None:
        self.context, self.layout, self.register = context, layout, register
        self.plan = layout_plan_of(context.device, layout)
        self.name = context.frames[layout.name] if register is None else context.registers[register.name]
        self.layout_interface = interface
        self.interface, self.encoder = interface_name(interface), encoder_name(interface)
        self.names = ClassNames(layout, register, context.crcs.values())
        self.encoding = BitsEncoder(context.scope, self.plan, self.names)
        scope = NamedValues(context.scope.names, self.answered_parameters) if register is None else context.scope
        self.decoding = Decoder(scope, self.plan, self.names, self.enum)
        #: The open questions whose answers the decoder takes. If several decoders are tried for a frame, each takes the
        #: answers for all of them.
        self.passed_arguments = self.questions

    def number(self, expression: Expression) -> PythonExpression:
        """Return an expression of the spec in Python."""
        return self.context.scope.expression_of(expression)

    # -- dependencies

    @cached_property
    def takes_variant(self) -> bool:
        """True if decoding, limits, reports or values in the manual depend on the order code."""
        if self.plan.depends_on_order_code:
            return True
        if self.limits is not None and limits_depend(self.limits):
            return True
        if self.reports is not None and self.reports.depends_on_order_code:
            return True
        stated_values = [field.equals for field in self.expected if isinstance(field.equals, Expression)]
        return not all(self.answered_parameters.issuperset(stated_value.parameters) for stated_value in stated_values)

    @cached_property
    def questions(self) -> list[OpenQuestion]:
        """Questions that the manual leaves open and the caller must answer."""
        return self.context.questions_of(self.layout)

    @cached_property
    def answered_parameters(self) -> frozenset[str]:
        """Parameters that the answers set."""
        parameters: set[str] = set()
        for question in self.questions:
            parameters.update(parameter for parameter, _ in question.members)
        return frozenset(parameters)

    @property
    def encoder_and_answers(self) -> list[tuple[str, str]]:
        """Attributes other than fields: the encoder and answers, with their types."""
        names_and_types = [("variant", self.encoder)] if self.takes_variant else []
        names_and_types += [(question.name, question.kind) for question in self.questions]
        return names_and_types

    @property
    def about_encoder_and_answers(self) -> list[tuple[str, str]]:
        """The arguments in ``encoder_and_answers``, each with its description."""
        names_and_descriptions = [("variant", "The encoder.")] if self.takes_variant else []
        for question in self.questions:
            answer = f"Answer to a question that the manual leaves open, as a member of ``{question.kind}``."
            names_and_descriptions.append((question.name, answer))
        return names_and_descriptions

    @property
    def is_request(self) -> bool:
        """True for a frame that the master sends."""
        return self.register is None and self.layout.sender == "master"

    @property
    def can_raise_constant_error(self) -> bool:
        """True if ``decode`` can raise ConstantError."""
        return Fault.CONSTANT in self.plan.faults()

    @property
    def can_raise_range_error(self) -> bool:
        """True if ``decode`` can raise RangeError, because a check can, or because a field has named values."""
        has_named_values = any(is_named(part.meaning) for part in self.plan.decoded_fields)
        return has_named_values or Fault.RANGE in self.plan.faults()

    @property
    def named_value_parts(self) -> list[FieldToDecode]:
        """The fields with named values, except the one by which frames differ (the selector).

        ``decode`` looks up the members of their enumerations after all checks.
        """
        parts = self.plan.decoded_fields
        return [part for part in parts if is_named(part.meaning) and not self.selects(part.field)]

    @property
    def keeps_bytes(self) -> bool:
        """True if the register can hold values that may not be written, so that a decoded register keeps its bytes."""
        return self.register is not None and bool(self.limited_attribute or powers_of_two(self.plan))

    @property
    def bases(self) -> str:
        """The base classes, except the NamedTuple of the fields, such as ``Sent, BitsOf["SsiEncoder"]``."""
        bases = ["Sent"] if self.reports is not None else []
        if self.questions:
            if self.takes_variant:
                bases.append("ForEncoder")
            bases.append("InBytes" if self.plan.in_bytes else "InBits")
            return ", ".join(bases)
        if self.register is not None:
            kind_of_base = "LimitedRegister" if self.keeps_bytes else "Register"
        else:
            kind_of_base = "Bytes" if self.plan.in_bytes else "Bits"
        bases.append(f'{kind_of_base}Of["{self.encoder}"]' if self.takes_variant else f"Fixed{kind_of_base}")
        return ", ".join(bases)

    # -- attributes

    @cached_property
    def attributes(self) -> list[Attribute]:
        """The attributes of all fields with a value, and of the unused bits."""
        return self._attributes_of(part.field for part in self.plan.decoded_fields)

    @property
    def _unused_attributes(self) -> list[Attribute]:
        """The attribute ``unused`` in a list, or an empty list if all bits have a field and a use."""
        if self.plan.keeps_undefined_bits:
            return [Attribute("unused", type="int", meaning=docstrings.ABOUT_OTHERS, default="0")]
        if self.plan.reserved:
            return [Attribute("unused", type="int", meaning=docstrings.ABOUT_UNUSED, default="0")]
        return []

    def others(self, joined_number: JoinedNumber) -> list[Attribute]:
        """Return the attributes that are not part of a joined number."""
        decoded_fields = [part.field for part in self.plan.decoded_fields]
        return self._attributes_of(field for field in decoded_fields if field not in joined_number.fields)

    def _attributes_of(self, fields: Iterable[Field]) -> list[Attribute]:
        """Return the attributes of these fields and of the unused bits."""
        attributes: list[Attribute] = []
        for field in fields:
            attributes += self._field_attributes(field)
        return _with_trailing_defaults(attributes + self._unused_attributes)

    def _field_attributes(self, field: Field) -> Iterator[Attribute]:
        """Yield the attributes of a field: one, or for decimal digits one for each digit run.

        A number that the manual states for a frame is the default of the attribute. So is the default of a request.
        """
        match meaning_of(field):
            case UnsignedNumber():
                stated_number = self._stated_number(field)
                default = stated_number if stated_number is not None else self._request_default(field)
                yield self._number_attribute(field, default)
            case ActiveFlag():
                yield self._field_attribute(field, "bool", default=str(bool(self._request_default(field))))
            case NamedChoice():
                yield self._field_attribute(field, self.enum(field))
            case DecimalDigits(runs):
                for run in runs:
                    yield Attribute(self.names.attribute(run.name), type="int", meaning=self._about_run(field, run))
            case Latin1Text():
                yield self._field_attribute(field, "str")
            case _:  # Any other conversion of a number.
                yield self._number_attribute(field, self._request_default(field))

    def _stated_number(self, field: Field) -> int | None:
        """Return the number that the manual states for a field of a frame, or None if it states none.

        The field by which frames differ (the selector) counts as having none.
        """
        if self.register is not None or self.selects(field):
            return None
        return field.equals if isinstance(field.equals, int) else None

    def _request_default(self, field: Field) -> int | None:
        """Return the default of a number or flag in a request, or None if it has none or the frame is not a request."""
        return field.default if self.is_request else None

    def _number_attribute(self, field: Field, default: int | None) -> Attribute:
        """Return the attribute of a number, with its default unless that is None."""
        return self._field_attribute(field, "int", coded(default) if default is not None else "")

    def _field_attribute(self, field: Field, type_: str, default: str = "") -> Attribute:
        """Return the attribute of a field. Its description says if some order codes do not have the field."""
        variants = () if field.width.is_constant else self.context.device.variants
        # An order code without the field gives it a width of 0.
        may_be_missing = any(field.width.value(variant.parameters) == 0 for variant in variants)
        description = self.about(field, may_be_missing=may_be_missing)
        return Attribute(name=self.names.attribute(field.name), type=type_, meaning=description, default=default)

    def _about_run(self, field: Field, digit_run: Digits) -> str:
        """Return the description of some decimal digits: that of the field if they have its name, or their own."""
        return self.about(field) if digit_run.name == field.name else docstrings.describe_run(digit_run)

    def about(self, field: Field, *, may_be_missing: bool = False) -> str:
        """Return the description of a field, which with ``may_be_missing`` says that not all encoders have it."""
        return docstrings.describe_field(self.context.device, field, may_be_missing=may_be_missing)

    def enum(self, field: Field) -> str:
        """Return the name of the IntEnum with the named values of a field."""
        return self.context.enum(field)

    def selects(self, field: Field) -> bool:
        """Return whether a field is the selector, whose value distinguishes this frame from other frames."""
        return field.name == self.layout.selector

    def crc_name(self, frame_crc: FrameCrc) -> str:
        """Return the name of the function for a CRC at the end of the frame."""
        return self.context.crc_name(frame_crc.crc, covered_data_of(self.layout))

    @property
    def gray_when(self) -> str:
        """Attribute of the variant that is true if the encoder sends Gray code. Empty if it always or never does."""
        gray = self.plan.gray
        return self.context.parameters[gray.when] if gray is not None and gray.when else ""

    # -- joined numbers and values from the manual

    def assigned(self, field: Field, bits: PythonExpression) -> Iterator[tuple[str, PythonExpression]]:
        """Yield the attributes of a field of a joined number, with their values."""
        enum = self.enum(field) if is_named(meaning_of(field)) else ""
        return attribute_values(self.context.scope, self.names, enum, field, bits)

    def join_attributes(self, joined_number: JoinedNumber) -> PythonExpression:
        """Return a joined number as an expression of local variables named like the attributes."""
        return self.encoding.join_numbers(joined_number, self.encoding.scope, str)

    def join_takes_variant(self, joined_number: JoinedNumber) -> bool:
        """Return whether the expression of a joined number depends on the order code, not only on answers."""
        return not self.answered_parameters.issuperset(self.encoding.parameters_of_join(joined_number))

    def questions_of_join(self, joined_number: JoinedNumber) -> list[OpenQuestion]:
        """Return the questions whose answers the expression of a joined number needs."""
        needed = self.encoding.parameters_of_join(joined_number)
        return [question for question in self.questions if any(name in needed for name, _ in question.members)]

    def width_of_join(self, joined_number: JoinedNumber) -> PythonExpression:
        """Return the number of bits in a joined number."""
        return self.number(sum((field.width for field in reversed(joined_number.fields)), Expression(0)))

    @property
    def expected(self) -> list[Field]:
        """Fields whose value the manual states."""
        return [field for field in self.layout.fields if field.equals is not None]

    @property
    def digit_fields(self) -> list[Field]:
        """The fields of decimal digits whose own name is not that of an attribute with some of the digits."""
        decimal_fields = (part.field for part in self.plan.decoded_fields if part.field.runs)
        return [field for field in decimal_fields if not _has_run_of_its_name(field)]

    @property
    def is_strict(self) -> bool:
        """True if a frame is undocumented when an unused bit differs. In registers, only values are compared."""
        return bool(self.plan.reserved) and self.register is None

    @property
    def expected_in_words(self) -> str:
        """The values for which a frame is as documented, such as ``status = 0x1B, no unused bit differs``."""
        conditions = [f"{field.name} = {value_in_words(field.equals)}" for field in self.expected]
        if self.is_strict:
            conditions.append("no unused bit differs")
        return ", ".join(conditions)

    def documented_value(self, field: Field) -> PythonExpression:
        """Return the value that the manual states for a field."""
        match field.equals:
            case Expression() as value:
                return self._scope_of_attributes().expression_of(value)
            case str(characters):
                return Atom(quoted(characters))
            case value:
                return Atom(coded(value or 0))

    @property
    def position_attribute(self) -> str:
        """The attribute with the position. Empty if the frame has no position, or only a part of it."""
        measurement = self.context.device.measurement_of(self.layout_interface)
        position_name = measurement.of if measurement is not None else "position"
        number_names = {part.field.name for part in self.plan.decoded_fields if is_number(part.meaning)}
        number_names.update(join.name for join in self.layout.joins)
        return self.names.attribute(position_name) if position_name in number_names else ""

    @property
    def usable_position(self) -> str:
        """Expression for the position: its attribute, or if several unsigned numbers form it, their bits joined."""
        scope = self._scope_of_attributes()
        for joined_number in self.plan.joined_numbers:
            is_position = self.names.attribute(joined_number.join.name) == self.position_attribute
            if is_position and all(isinstance(meaning_of(field), UnsignedNumber) for field in joined_number.fields):
                return str(self.encoding.join_numbers(joined_number, scope, _read_attribute))
        return _read_attribute(self.position_attribute)

    def _scope_of_attributes(self) -> ParameterExpressions:
        """Return how parameters are written in a method of the class.

        A parameter is then an attribute of ``variant``, or of the answer to an open question.
        """
        code_of_parameter = dict(self.context.scope_of(_read_attribute("variant")).names)
        for question in self.questions:
            for parameter, member in question.members:
                code_of_parameter[parameter] = f"{_read_attribute(question.name)}.{member}"
        return ParameterExpressions(code_of_parameter)

    @cached_property
    def reports(self) -> FrameReports | None:
        """The reports and the verdict of a frame that the encoder sends, or None for other frames and registers."""
        if self.register is not None or self.layout.sender != "encoder":
            return None
        reporting = self.context.reportings.get(self.layout.name)
        meanings = {
            parameter.name: as_sentence(text_on_one_line(parameter.meaning))
            for parameter in self.context.device.parameters
        }
        return FrameReports(reporting, self.plan, self.names, self.context.parameters, meanings)

    # -- limits of registers

    @cached_property
    def limits(self) -> NumberLimits | None:
        """The limits of the register, or None if the manual gives none."""
        register = self.register
        if register is None or (register.min is None and register.max is None):
            return None
        return limits_of(self.context.device, register)

    @property
    def limited_attribute(self) -> str:
        """Attribute to which the limits of the register apply. Empty for a number made up of several attributes."""
        member = self.limits.member if self.limits is not None else ""
        return self.names.attribute(member) if member else ""

    @property
    def limits_functions(self) -> Iterator[LimitsFunction]:
        """The function for the limits of the register, and one for each use of it (meaning) with limits of its own."""
        if self.register is not None:
            yield from limits_functions(self.context, self.register, takes_variant=self.takes_variant)

    @property
    def doc(self) -> str:
        """The docstring of the class."""
        device = self.context.device
        if self.register is not None:
            description, kind = docstrings.describe_register(device, self.register), "register"
        else:
            interface = device.interface_of(self.layout)
            description, kind = docstrings.describe_layout(device, interface, self.layout), "frame"
        attributes = [(question.name, as_sentence(question.alternative.meaning)) for question in self.questions]
        attributes += [(attribute.name, attribute.meaning) for attribute in self.attributes]
        unused_bits = []
        for reserved in self.plan.reserved:
            place = docstrings.describe_unused(reserved.field, reserved.lowest_bit_in_unused)
            unused_bits.append((place, self.about(reserved.field)))
        checked_fields = [(field.name, self.about(field)) for field in self._checked_fields()]
        return docstrings.describe_class(
            description,
            kind if self.takes_variant else "",
            attributes,
            ("Bits of unused", unused_bits),
            ("Checked by decode()", checked_fields),
        )

    def _checked_fields(self) -> list[Field]:
        """Return the fields that ``decode`` checks and that are neither attributes nor unused, such as a CRC."""
        unused_names = {reserved.field.name for reserved in self.plan.reserved}
        without_data = [field for field in self.layout.fields if not field.carries_data and not field.padding_of]
        return [field for field in without_data if field.name not in unused_names]


def _has_run_of_its_name(field: Field) -> bool:
    """Return whether some decimal digits of a field have the name of the field."""
    return any(run.name == field.name for run in field.runs)


def _with_trailing_defaults(attributes: Sequence[Attribute]) -> list[Attribute]:
    """Return the attributes. An attribute keeps its default only if all attributes after it also have a default."""
    indices_without_default = [index for index, attribute in enumerate(attributes) if not attribute.default]
    last_required = max(indices_without_default, default=0)
    # The attribute at this index has no default, or all attributes have one.
    required = [replace(attribute, default="") for attribute in attributes[:last_required]]
    return [*required, *attributes[last_required:]]


def _read_attribute(name: str) -> str:
    """Return the code that reads an attribute of a frame: ``self.error`` for ``error``."""
    return f"self.{name}"
