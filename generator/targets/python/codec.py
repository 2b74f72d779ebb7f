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
from .literals import Atom, ExpressionTranslator, PythonExpression, coded, quoted, value_in_words
from .names import ClassNames, DeviceNames, OpenQuestion, encoder_name, interface_name
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
        self, device_names: DeviceNames, interface: str, layout: Layout, register: Register | None = None
    ) -> None:
        self.device_names, self.device = device_names, device_names.device
        self.layout, self.register = layout, register
        self.layout_plan = layout_plan_of(device_names.device, layout)
        translator = device_names.translator
        if register is None:
            self.name = device_names.class_name_by_frame[layout.name]
            # The decoder of a frame computes values that depend on the order code only once.
            translator = NamedValues(translator.code_by_parameter, self.answered_parameters)
        else:
            self.name = device_names.class_name_by_register[register.name]
        self.layout_interface = interface
        self.interface, self.encoder = interface_name(interface), encoder_name(interface)
        self.class_names = ClassNames(layout, register, device_names.function_name_by_crc.values())
        self.bits_encoder = BitsEncoder(device_names.translator, self.layout_plan, self.class_names)
        self.decoder = Decoder(translator, self.layout_plan, self.class_names, self.enum_name)
        #: The open questions whose answers the decoder takes. If several decoders are tried for a frame, each takes the
        #: answers for all of them.
        self.passed_arguments = self.questions

    def to_python(self, expression: Expression) -> PythonExpression:
        """Return an expression of the spec in Python."""
        return self.device_names.translator.to_python(expression)

    # -- dependencies

    @cached_property
    def takes_variant(self) -> bool:
        """True if decoding, limits, reports or values in the manual depend on the order code."""
        if self.layout_plan.depends_on_order_code:
            return True
        if self.limits is not None and limits_depend(self.limits):
            return True
        if self.reports is not None and self.reports.depends_on_order_code:
            return True
        stated_values = [field.equals for field in self.fields_with_stated_value]
        expressions = [stated_value for stated_value in stated_values if isinstance(stated_value, Expression)]
        return not all(self.answered_parameters.issuperset(expression.parameters) for expression in expressions)

    @cached_property
    def questions(self) -> list[OpenQuestion]:
        """Questions that the manual leaves open and the caller must answer."""
        return self.device_names.questions_of(self.layout)

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
        names_and_types += [(question.name, question.enum_name) for question in self.questions]
        return names_and_types

    @property
    def about_encoder_and_answers(self) -> list[tuple[str, str]]:
        """The arguments in ``encoder_and_answers``, each with its description."""
        names_and_descriptions = [("variant", "The encoder.")] if self.takes_variant else []
        for question in self.questions:
            description = f"Answer to a question that the manual leaves open, as a member of ``{question.enum_name}``."
            names_and_descriptions.append((question.name, description))
        return names_and_descriptions

    @property
    def is_request(self) -> bool:
        """True for a frame that the master sends."""
        return self.register is None and self.layout.sender == "master"

    @property
    def can_raise_constant_error(self) -> bool:
        """True if ``decode`` can raise ConstantError."""
        return Fault.CONSTANT in self.layout_plan.faults()

    @property
    def can_raise_range_error(self) -> bool:
        """True if ``decode`` can raise RangeError, because a check can, or because a field has named values."""
        has_named_values = any(is_named(decoded_field.meaning) for decoded_field in self.layout_plan.decoded_fields)
        return has_named_values or Fault.RANGE in self.layout_plan.faults()

    @property
    def fields_with_named_values(self) -> list[FieldToDecode]:
        """The fields with named values, except the one by which frames differ (the selector).

        ``decode`` looks up the members of their enumerations after all checks.
        """
        named_fields = [decoded for decoded in self.layout_plan.decoded_fields if is_named(decoded.meaning)]
        return [decoded_field for decoded_field in named_fields if not self.selects(decoded_field.field)]

    @property
    def keeps_bytes(self) -> bool:
        """True if the register can hold values that may not be written, so that a decoded register keeps its bytes."""
        return self.register is not None and bool(self.limited_attribute or powers_of_two(self.layout_plan))

    @property
    def bases(self) -> str:
        """The base classes, except the NamedTuple of the fields, such as ``Sent, BitsOf["SsiEncoder"]``."""
        base_names = ["Sent"] if self.reports is not None else []
        if self.questions:
            if self.takes_variant:
                base_names.append("ForEncoder")
            base_names.append("InBytes" if self.layout_plan.in_bytes else "InBits")
            return ", ".join(base_names)
        if self.register is not None:
            base_name = "LimitedRegister" if self.keeps_bytes else "Register"
        else:
            base_name = "Bytes" if self.layout_plan.in_bytes else "Bits"
        base_names.append(f'{base_name}Of["{self.encoder}"]' if self.takes_variant else f"Fixed{base_name}")
        return ", ".join(base_names)

    # -- attributes

    @cached_property
    def attributes(self) -> list[Attribute]:
        """The attributes of all fields with a value, and of the unused bits."""
        return self._attributes_of(decoded_field.field for decoded_field in self.layout_plan.decoded_fields)

    @property
    def _unused_attributes(self) -> list[Attribute]:
        """The attribute ``unused`` in a list, or an empty list if all bits have a field and a use."""
        if self.layout_plan.keeps_undefined_bits:
            return [Attribute("unused", type="int", meaning=docstrings.ABOUT_OTHERS, default="0")]
        if self.layout_plan.reserved:
            return [Attribute("unused", type="int", meaning=docstrings.ABOUT_UNUSED, default="0")]
        return []

    def attributes_outside_join(self, joined_number: JoinedNumber) -> list[Attribute]:
        """Return the attributes that are not part of a joined number."""
        decoded_fields = [decoded_field.field for decoded_field in self.layout_plan.decoded_fields]
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
                yield self._field_attribute(field, self.enum_name(field))
            case DecimalDigits(runs):
                for run in runs:
                    attribute_name = self.class_names.attribute_name(run.name)
                    yield Attribute(attribute_name, type="int", meaning=self._about_run(field, run))
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
        variants = () if field.width.is_constant else self.device.variants
        # An order code without the field gives it a width of 0.
        may_be_missing = any(field.width.value(variant.parameters) == 0 for variant in variants)
        description = self.describe_field(field, may_be_missing=may_be_missing)
        attribute_name = self.class_names.attribute_name(field.name)
        return Attribute(name=attribute_name, type=type_, meaning=description, default=default)

    def _about_run(self, field: Field, digit_run: Digits) -> str:
        """Return the description of some decimal digits: that of the field if they have its name, or their own."""
        return self.describe_field(field) if digit_run.name == field.name else docstrings.describe_run(digit_run)

    def describe_field(self, field: Field, *, may_be_missing: bool = False) -> str:
        """Return the description of a field, which with ``may_be_missing`` says that not all encoders have it."""
        return docstrings.describe_field(self.device, field, may_be_missing=may_be_missing)

    def enum_name(self, field: Field) -> str:
        """Return the name of the IntEnum with the named values of a field."""
        return self.device_names.enum_name(field)

    def selects(self, field: Field) -> bool:
        """Return whether a field is the selector, whose value distinguishes this frame from other frames."""
        return field.name == self.layout.selector

    def crc_name(self, frame_crc: FrameCrc) -> str:
        """Return the name of the function for a CRC at the end of the frame."""
        return self.device_names.crc_name(frame_crc.crc, covered_data_of(self.layout))

    @property
    def gray_when(self) -> str:
        """Attribute of the variant that is true if the encoder sends Gray code. Empty if it always or never does."""
        gray = self.layout_plan.gray
        return self.device_names.attribute_by_parameter[gray.when] if gray is not None and gray.when else ""

    # -- joined numbers and values from the manual

    def attribute_assignments(self, field: Field, bits: PythonExpression) -> Iterator[tuple[str, PythonExpression]]:
        """Yield the attributes of a field of a joined number, with their values."""
        enum = self.enum_name(field) if is_named(meaning_of(field)) else ""
        return attribute_values(self.device_names.translator, self.class_names, enum, field, bits)

    def join_attributes(self, joined_number: JoinedNumber) -> PythonExpression:
        """Return a joined number as an expression of local variables named like the attributes."""
        return self.bits_encoder.join_numbers(joined_number, self.bits_encoder.translator, str)

    def join_takes_variant(self, joined_number: JoinedNumber) -> bool:
        """Return whether the expression of a joined number depends on the order code, not only on answers."""
        return not self.answered_parameters.issuperset(self.bits_encoder.parameters_of_join(joined_number))

    def questions_of_join(self, joined_number: JoinedNumber) -> list[OpenQuestion]:
        """Return the questions whose answers the expression of a joined number needs."""
        needed_parameters = self.bits_encoder.parameters_of_join(joined_number)
        return [
            question for question in self.questions if any(name in needed_parameters for name, _ in question.members)
        ]

    def width_of_join(self, joined_number: JoinedNumber) -> PythonExpression:
        """Return the number of bits in a joined number."""
        return self.to_python(sum((field.width for field in reversed(joined_number.fields)), Expression(0)))

    @property
    def fields_with_stated_value(self) -> list[Field]:
        """Fields whose value the manual states."""
        return [field for field in self.layout.fields if field.equals is not None]

    @property
    def digit_fields(self) -> list[Field]:
        """The fields of decimal digits whose own name is not that of an attribute with some of the digits."""
        decoded_fields = [decoded_field.field for decoded_field in self.layout_plan.decoded_fields]
        return [field for field in decoded_fields if field.runs and not _has_run_of_its_name(field)]

    @property
    def is_strict(self) -> bool:
        """True if a frame is undocumented when an unused bit differs. In registers, only values are compared."""
        return bool(self.layout_plan.reserved) and self.register is None

    @property
    def stated_values_in_words(self) -> str:
        """The values for which a frame is as documented, such as ``status = 0x1B, no unused bit differs``."""
        conditions = [f"{field.name} = {value_in_words(field.equals)}" for field in self.fields_with_stated_value]
        if self.is_strict:
            conditions.append("no unused bit differs")
        return ", ".join(conditions)

    def documented_value(self, field: Field) -> PythonExpression:
        """Return the value that the manual states for a field."""
        match field.equals:
            case Expression() as value:
                return self._translator_of_attributes().to_python(value)
            case str(characters):
                return Atom(quoted(characters))
            case value:
                return Atom(coded(value or 0))

    @property
    def position_attribute(self) -> str:
        """The attribute with the position. Empty if the frame has no position, or only a part of it."""
        measurement = self.device.measurement_of(self.layout_interface)
        # A measurement has the name of the field or joined number with the position.
        position_name = measurement.position_name if measurement is not None else "position"
        number_fields = [decoded for decoded in self.layout_plan.decoded_fields if is_number(decoded.meaning)]
        names_of_numbers = {decoded_field.field.name for decoded_field in number_fields}
        names_of_numbers.update(join.name for join in self.layout.joins)
        return self.class_names.attribute_name(position_name) if position_name in names_of_numbers else ""

    @property
    def usable_position(self) -> str:
        """Expression for the position: its attribute, or if several unsigned numbers form it, their bits joined."""
        translator = self._translator_of_attributes()
        for joined_number in self.layout_plan.joined_numbers:
            is_position = self.class_names.attribute_name(joined_number.join.name) == self.position_attribute
            if is_position and all(isinstance(meaning_of(field), UnsignedNumber) for field in joined_number.fields):
                return str(self.bits_encoder.join_numbers(joined_number, translator, _read_attribute))
        return _read_attribute(self.position_attribute)

    def _translator_of_attributes(self) -> ExpressionTranslator:
        """Return how parameters are written in a method of the class.

        A parameter is then an attribute of ``variant``, or of the answer to an open question.
        """
        code_of_parameter = dict(self.device_names.translator_for(_read_attribute("variant")).code_by_parameter)
        for question in self.questions:
            for parameter, member in question.members:
                code_of_parameter[parameter] = f"{_read_attribute(question.name)}.{member}"
        return ExpressionTranslator(code_of_parameter)

    @cached_property
    def reports(self) -> FrameReports | None:
        """The reports and the verdict of a frame that the encoder sends, or None for other frames and registers."""
        if self.register is not None or self.layout.sender != "encoder":
            return None
        reports_and_verdict = self.device_names.reports_by_frame.get(self.layout.name)
        meanings = {
            parameter.name: as_sentence(text_on_one_line(parameter.meaning)) for parameter in self.device.parameters
        }
        return FrameReports(
            reports_and_verdict, self.layout_plan, self.class_names, self.device_names.attribute_by_parameter, meanings
        )

    # -- limits of registers

    @cached_property
    def limits(self) -> NumberLimits | None:
        """The limits of the register, or None if the manual gives none."""
        register = self.register
        if register is None or (register.min is None and register.max is None):
            return None
        return limits_of(self.device, register)

    @property
    def limited_attribute(self) -> str:
        """Attribute to which the limits of the register apply. Empty for a number made up of several attributes."""
        member = self.limits.member if self.limits is not None else ""
        return self.class_names.attribute_name(member) if member else ""

    @property
    def limits_functions(self) -> Iterator[LimitsFunction]:
        """The function for the limits of the register, and one for each use of it (meaning) with limits of its own."""
        if self.register is not None:
            yield from limits_functions(self.device_names, self.register, takes_variant=self.takes_variant)

    @property
    def doc(self) -> str:
        """The docstring of the class."""
        device = self.device
        if self.register is not None:
            description, frame_or_register = docstrings.describe_register(device, self.register), "register"
        else:
            interface = device.interface_of(self.layout)
            description, frame_or_register = docstrings.describe_layout(device, interface, self.layout), "frame"
        attributes = [(question.name, as_sentence(question.alternative.meaning)) for question in self.questions]
        attributes += [(attribute.name, attribute.meaning) for attribute in self.attributes]
        unused_bits = []
        for unused_field in self.layout_plan.reserved:
            bits_in_unused = docstrings.describe_unused(unused_field.field, unused_field.lowest_bit_in_unused)
            unused_bits.append((bits_in_unused, self.describe_field(unused_field.field)))
        checked_fields = [(field.name, self.describe_field(field)) for field in self._checked_fields()]
        return docstrings.describe_class(
            description,
            frame_or_register if self.takes_variant else "",
            attributes,
            ("Bits of unused", unused_bits),
            ("Checked by decode()", checked_fields),
        )

    def _checked_fields(self) -> list[Field]:
        """Return the fields that ``decode`` checks and that are neither attributes nor unused, such as a CRC."""
        unused_names = {reserved.field.name for reserved in self.layout_plan.reserved}
        without_data = [field for field in self.layout.fields if not field.carries_data and not field.padding_of]
        return [field for field in without_data if field.name not in unused_names]


def _has_run_of_its_name(field: Field) -> bool:
    """Return whether some decimal digits of a field have the name of the field."""
    return any(run.name == field.name for run in field.runs)


def _with_trailing_defaults(attributes: Sequence[Attribute]) -> list[Attribute]:
    """Return the attributes. An attribute keeps its default only if all attributes after it also have a default."""
    indices_without_default = [index for index, attribute in enumerate(attributes) if not attribute.default]
    last_index = max(indices_without_default, default=0)
    # The attribute at this index has no default, or all attributes have one.
    attributes_without_default = [replace(attribute, default="") for attribute in attributes[:last_index]]
    return [*attributes_without_default, *attributes[last_index:]]


def _read_attribute(name: str) -> str:
    """Return the code that reads an attribute of a frame: ``self.error`` for ``error``."""
    return f"self.{name}"
