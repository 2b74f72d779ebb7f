"""Procedures in Python: functions that return the steps for an order code and arguments."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import chain, pairwise

from ...model import Argument, Field, Procedure, Register
from ...model.record import dataclass
from ...plan.limits import NotOneOf, TooWide
from ...plan.procedures import plan_procedure
from ...plan.steps import (
    ArgumentRefusal,
    AsMember,
    AsNumber,
    CheckedArgument,
    OutsideArgumentLimits,
    PlannedStep,
    PollRegister,
    Undecodable,
    VerifyWrite,
    WriteRegister,
)
from ...plan.values import DecimalDigits, UnsignedNumber, meaning_of
from . import docstrings
from .codec import LayoutClass
from .docstrings import Block
from .literals import Atom, PythonExpression, shift_left
from .names import PROCEDURE_NAMES, DeviceNames, encoder_name, interface_name, meaning_limits, python_name
from .values import digit_values, limit_expressions, limits_depend


@dataclass(frozen=True)
class Segment:
    """A sequence of steps, and the arguments that are checked before it.

    ``limiting_write`` is the last step if the value that it writes changes the limits of later steps, or else None.
    """

    arguments: Sequence[CheckedArgument]
    steps: Sequence[PlannedStep]
    limiting_write: WriteRegister | None


class ProcedureFunction:
    """The function that returns the steps of a procedure. ``layout_classes`` are the classes of registers, by name."""

    def __init__(
        self, device_names: DeviceNames, layout_classes: Mapping[str, LayoutClass], procedure: Procedure
    ) -> None:
        self.device_names = device_names
        self.layout_classes = layout_classes
        self.procedure = procedure
        self.procedure_plan = plan_procedure(device_names.device, procedure)
        self.name = device_names.function_name_by_procedure[procedure.name]
        self.interface, self.encoder = interface_name(procedure.interface), encoder_name(procedure.interface)
        self.translator = device_names.translator
        self.steps = self.procedure_plan.operations
        self.arguments = self.procedure_plan.arguments

    @cached_property
    def takes_variant(self) -> bool:
        """True if the steps, or the checks of their arguments, depend on the order code.

        Otherwise, the function only checks that the encoder belongs to the family.
        """
        for checked_argument in self.arguments:
            register_class = self.layout_classes.get(checked_argument.argument.of)
            if register_class is not None and register_class.takes_variant:
                return True
            if any(self._depends_on_order_code(refusal) for refusal in checked_argument.refusals):
                return True
        for step in self.steps:
            if isinstance(step, (WriteRegister, PollRegister)) and step.field is not None and not step.field.is_fixed:
                return True
        return any(segment.limiting_write for segment in self.segments)

    def _depends_on_order_code(self, refusal: ArgumentRefusal) -> bool:
        """Return whether the check that rejects an argument needs the order code."""
        match refusal:
            case OutsideArgumentLimits():
                return self._limits_differ(refusal)
            case TooWide(width=width):
                return not width.is_constant
            case NotOneOf() | Undecodable():
                return False

    @property
    def segments(self) -> Iterator[Segment]:
        """The steps, split after each step whose written value changes the limits of later steps.

        An argument belongs to the segment with the first step that writes it.
        """
        # The index after each such step.
        segment_ends = [index + 1 for index, step in enumerate(self.steps) if _limiting_write(step) is not None]
        for first_index, end_index in pairwise((0, *segment_ends, len(self.steps))):
            arguments = [
                checked_argument
                for checked_argument in self.arguments
                if first_index <= self._first_write(checked_argument) < end_index
            ]
            yield Segment(
                arguments=arguments,
                steps=self.steps[first_index:end_index],
                limiting_write=_limiting_write(self.steps[end_index - 1]),
            )

    def _first_write(self, checked_argument: CheckedArgument) -> int:
        """Return the index of the first step that writes an argument."""
        return self.steps.index(checked_argument.writes[0])

    # -- names

    @property
    def can_be_undecodable(self) -> bool:
        """True if an argument can be a number that the decoder of its register rejects."""
        refusals = chain.from_iterable(checked_argument.refusals for checked_argument in self.arguments)
        return any(isinstance(refusal, Undecodable) for refusal in refusals)

    @property
    def described_arguments(self) -> list[tuple[str, str]]:
        """The names of the arguments with their descriptions."""
        listed_arguments = []
        for checked_argument in self.arguments:
            description = docstrings.describe_argument(self.device_names.device, checked_argument.argument)
            listed_arguments.append((self.argument_name(checked_argument.argument), description))
        return listed_arguments

    @property
    def about(self) -> list[Block]:
        """The blocks of the docstring."""
        return docstrings.describe_procedure(self.device_names.device, self.procedure)

    @staticmethod
    def argument_name(argument: Argument) -> str:
        """Return the name of an argument in Python."""
        return python_name(argument.name, PROCEDURE_NAMES)

    def encoded_argument(self, argument: Argument) -> str:
        """Return the variable with the bytes of an argument, or "" unless they are decoded as a check."""
        is_decoded = any(
            isinstance(refusal, Undecodable)
            for checked_argument in self.arguments
            if checked_argument.argument is argument
            for refusal in checked_argument.refusals
        )
        if not is_decoded:
            return ""
        names_of_arguments = [other_argument.argument.name for other_argument in self.arguments]
        return python_name(f"{argument.name}_bytes", (*PROCEDURE_NAMES, *names_of_arguments))

    def argument_type(self, checked_argument: CheckedArgument) -> str:
        """Return the type of an argument. A register of several fields is passed as an object or as one number."""
        return (
            f"{self.device_names.class_name_by_register[checked_argument.argument.of]} | int"
            if self.is_object(checked_argument)
            else "int"
        )

    def is_object(self, checked_argument: CheckedArgument) -> bool:
        """Return whether an argument can be an object of the register's class as well as a number."""
        object_registers = {
            write.register.name for write in checked_argument.writes if isinstance(write.value, AsNumber)
        }
        return checked_argument.argument.of in object_registers

    def register_class_name(self, register: Register) -> str:
        """Return the name of the class of a register."""
        return self.device_names.class_name_by_register[register.name]

    # -- numbers

    def mask_of_field(self, field: Field) -> PythonExpression:
        """Return the mask of a field at its position in the register."""
        if field.is_fixed:
            return Atom(f"0x{field.mask_in_place:02X}")
        return shift_left(self.translator.mask_of_ones(field.width), self.translator.to_python(field.low))

    def verified_mask(self, verification: VerifyWrite) -> PythonExpression:
        """Return the mask of the bits of a register that a step reads back and compares.

        It is the mask of a field, or a number with two hexadecimal digits for each byte of the register.
        """
        if verification.field is not None:
            return self.mask_of_field(verification.field)
        register_mask = sum(bit_slice.mask << bit_slice.low_in_number for bit_slice in verification.bit_slices)
        digit_count = 2 * verification.register.length
        return Atom(f"0x{register_mask:0{digit_count}X}")

    def shifted_to_field(self, value: int | str, field: Field) -> PythonExpression:
        """Return a number or an argument, shifted to the position of the field."""
        if isinstance(value, int) and field.low.is_constant:
            return Atom(f"0x{value << field.low.constant:02X}")
        return shift_left(Atom(str(value)), self.translator.to_python(field.low))

    def members(self, member_value: AsMember, register: Register) -> list[tuple[str, PythonExpression]]:
        """Return the attributes of a register's class that an argument sets, each with its value.

        An argument sets several attributes only if they are the decimal digits of one number.
        """
        attribute_of = self.layout_classes[register.name].class_names.attribute_name
        argument = Atom(self.argument_name(member_value.argument))
        # Empty if the argument sets a number that several fields form (a join).
        fields_of_member = [field for field in register.layout.fields if field.name == member_value.member]
        # A join of several fields is a number.
        meaning = meaning_of(fields_of_member[0]) if fields_of_member else UnsignedNumber()
        match meaning:
            case DecimalDigits(runs):
                return [(attribute_of(run.name), value_of_run) for run, value_of_run in digit_values(argument, runs)]
            case _:
                return [(attribute_of(member_value.member), argument)]

    def is_join(self, member_value: AsMember, register: Register) -> bool:
        """Return whether an argument sets a number that several fields of the register form (a join)."""
        return any(join.name == member_value.member for join in register.layout.joins)

    def limits_code(self, refusal: OutsideArgumentLimits) -> str:
        """Return the limits of an argument in Python: a call such as ``Preset.limits(variant)``.

        If the register has no class, the limits are a tuple of two numbers.
        """
        if refusal.register.name not in self.layout_classes:
            lowest, highest = limit_expressions(self.translator, refusal.limits)
            return f"({lowest}, {highest})"
        function = "limits" if refusal.meaning is None else meaning_limits(refusal.meaning)
        argument = "variant" if self._limits_differ(refusal) else ""
        return f"{self.register_class_name(refusal.register)}.{function}({argument})"

    def _limits_differ(self, refusal: OutsideArgumentLimits) -> bool:
        """Return True if the limits depend on the order code, or if their function takes the order code in any case."""
        register_class = self.layout_classes.get(refusal.register.name)
        if register_class is not None and refusal.meaning is None:
            return register_class.takes_variant
        return limits_depend(refusal.limits)


def _limiting_write(step: PlannedStep) -> WriteRegister | None:
    """Return the step if it writes a value that changes the limits of later steps, or else None."""
    return step if isinstance(step, WriteRegister) and step.determines_limits else None
