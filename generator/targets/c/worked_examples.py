"""What an example program shows: worked examples of the manual, or a made-up frame, and how members are printed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

from ...loading.examples import example_variant
from ...model import (
    CrcExample,
    Device,
    Example,
    FrameExample,
    Interface,
    Layout,
    MeasureExample,
    PollStep,
    Procedure,
    ProcedureExample,
    Register,
    RegisterExample,
    SendStep,
    Value,
    Values,
    Variant,
    assert_never,
    cite,
    number_from_bytes,
)
from ...model.record import dataclass
from ...plan.operations import FieldToDecode
from ...plan.values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    NamedChoice,
    TwosComplement,
)
from ...say.names_and_evidence import title_of, word_for_document
from .comments import ascii_text
from .names import c_name
from .procedures import ProcedureCode
from .registers import RegisterFunctions
from .structs import LayoutStruct


@dataclass(frozen=True, slots=True)
class ExampleFrame:
    """A frame as a number, its source, and the values of its fields, as far as they are known."""

    layout: Layout
    sent_number: int
    about: str
    values: Values


class NoFrame(Exception):
    """The manual shows no frame of an interface, and none could be made up."""


def choose_variant(device: Device, interface: Interface) -> Variant:
    """Return the order code of an interface that has the most worked examples in the manual.

    Examples with an erratum, whose printed bytes are not used, do not count. With equal numbers, the order code with
    the finest resolution is chosen, which has the largest parameters.
    """
    examples = (example for example in device.examples if _is_shown_over(device, interface, example))
    # An example without an order code applies to all of them, and counts for none.
    examples_by_code = Counter(getattr(example, "order_code", "") for example in examples if not example.erratum)
    variants = device.variants_over(interface.name) or device.variants

    def preference(variant: Variant) -> tuple[int, int]:
        return examples_by_code[variant.code], sum(variant.parameters.values())

    return max(variants, key=preference)


def _is_shown_over(device: Device, interface: Interface, example: Example) -> bool:
    """Return True if a program for this interface can show a worked example of the manual.

    It can show a register that can be read, a valid reply whose decoding needs no choice by the user, a procedure and a
    measurement.
    """
    if example_variant(device, example).interface != interface.name:
        return False
    match example:
        case RegisterExample():
            register = device.register(example.register)
            return register.interface == interface.name and register.readable
        case FrameExample():
            is_valid_reply = not example.refused and example.sender == "encoder" and bool(example.layout)
            return is_valid_reply and not device.alternatives_of(device.layout(example.layout))
        case ProcedureExample() | MeasureExample():
            return True
        case CrcExample():
            return False
        case _:
            assert_never(example)


class WorkedRegister(NamedTuple):
    """A register with its worked example."""

    register: Register
    example: RegisterExample


class ChosenExamples:
    """The worked examples of the manual for one order code of an interface, chosen by ``choose_variant``.

    Raises:
        NoFrame: There is no frame to show.
    """

    def __init__(self, device: Device, interface: Interface) -> None:
        self.device = device
        self.interface = interface
        self.measurement = device.measurement_of(interface.name)
        self.variant = choose_variant(device, interface)
        examples = (example for example in device.examples if _is_shown_over(device, interface, example))
        #: The examples for the chosen order code. An example without an order code applies to the first code of the
        #: family.
        self.examples = [example for example in examples if example_variant(device, example).code == self.variant.code]
        self.frame = self._choose_frame()

    @property
    def registers(self) -> Mapping[str, WorkedRegister]:
        """The registers that have a worked example, by name, each with the first of its examples.

        Registers in banks are left out, because the program cannot simulate them.
        """
        registers: dict[str, WorkedRegister] = {}
        for example in self.examples:
            if isinstance(example, RegisterExample):
                register = self.device.register(example.register)
                if register.bank is None:
                    registers.setdefault(register.name, WorkedRegister(register, example))
        return registers

    @property
    def procedure(self) -> tuple[Procedure, ProcedureExample | None] | None:
        """The procedure for the program, with its worked example.

        It is the worked procedure with the most writes. Procedures that poll are left out. Without one, it is the first
        procedure that clears an alarm by a request, with None as its example. The result is None if there is neither.
        """
        examples = (example for example in self.examples if isinstance(example, ProcedureExample))
        procedures_and_examples: list[tuple[Procedure, ProcedureExample]] = []
        for example in examples:
            procedure = self.device.procedure(example.procedure)
            # The simulated encoder is never done, so that a poll would not end.
            if not _has_poll(procedure):
                procedures_and_examples.append((procedure, example))
        if procedures_and_examples:
            return max(procedures_and_examples, key=_number_of_writes)
        clearing_procedure = next(self._clearing_procedures(), None)
        return (clearing_procedure, None) if clearing_procedure is not None else None

    def _clearing_procedures(self) -> Iterator[Procedure]:
        """Yield the procedures that clear an alarm by a request over this interface."""
        for alarm in self.device.alarms:
            for procedure in map(self.device.procedure, alarm.cleared_by):
                sends_request = any(isinstance(step, SendStep) for step in procedure.steps)
                if sends_request and procedure.interface == self.interface.name:
                    yield procedure

    # -- the frame

    def _choose_frame(self) -> ExampleFrame:
        """Return a frame from the worked examples, or a made-up frame if there is none.

        A frame without an erratum comes first, and then a frame from the manual before one from another source.

        Raises:
            NoFrame: There is neither.
        """
        worked_frames = [example for example in self.examples if isinstance(example, FrameExample)]
        if not worked_frames:
            return self._made_up_frame()
        example = min(worked_frames, key=_rate_unreliability)
        layout = self.device.layout(example.layout)
        return ExampleFrame(
            layout=layout,
            sent_number=int(example.bits, 2) if example.bits else number_from_bytes(layout, example.bytes),
            about=f"a worked example [{cite(example.source)}]",
            values=example.values,
        )

    def _made_up_frame(self) -> ExampleFrame:
        """Return a made-up frame, if possible one with the position.

        Raises:
            NoFrame: The device provides no sample of the frame.
        """
        layouts = [layout for layout in self.interface.layouts if layout.sender == "encoder"]

        def rank(layout: Layout) -> tuple[bool, bool]:
            # A frame with the position comes first, and then a frame that needs no choice by the user.
            lacks_position = not self.has_position(layout)
            needs_choice = bool(self.device.alternatives_of(layout))
            return lacks_position, needs_choice

        layout = min(layouts, key=rank)
        sample = self.device.sample_of(layout)
        if sample is None:
            raise NoFrame
        if sample.source:
            about = f"made up, with the position of a worked example [{cite(sample.source)}]"
        else:
            about = f"made up, since the {word_for_document(self.device)} has no example of it"
            frame_examples = (example for example in self.device.examples if isinstance(example, FrameExample))
            if any(example.layout == layout.name for example in frame_examples):
                about += " for this order code"
        return ExampleFrame(layout=layout, sent_number=sample.frame, about=about, values=sample.values)

    def has_position(self, layout: Layout) -> bool:
        """Return True if a layout has the field or join that contains the position."""
        return self.measurement is not None and self.measurement.position_name in layout.member_names


def _rate_unreliability(example: FrameExample) -> tuple[bool, bool]:
    """Return a key that is lowest for examples used as printed, and then for examples from the manual."""
    has_erratum = bool(example.erratum)
    # A source without a document is the manual.
    is_from_other_document = any(source.document for source in example.source)
    return has_erratum, is_from_other_document


def _number_of_writes(procedure_and_example: tuple[Procedure, ProcedureExample]) -> int:
    """Return the number of writes in the worked example of a procedure."""
    _, example = procedure_and_example
    return len(example.writes)


def _has_poll(procedure: Procedure) -> bool:
    return any(isinstance(step, PollStep) for step in procedure.steps)


#: Maximum number of characters of explanation after a number.
_LONGEST_EXPLANATION = 40


@dataclass(frozen=True, slots=True)
class PrintedMember:
    """A member as the program prints it: its name, the ``printf_format`` and arguments for ``printf``.

    ``value_names`` explains its named values, or is empty.
    """

    name: str
    printf_format: str
    arguments: str
    value_names: str = ""


def printed_members(decoded_field: FieldToDecode, variable: str) -> Iterator[PrintedMember]:
    """Yield the members that a field fills in the struct ``variable``, as ``printf`` prints them.

    A number whose decimal digits are members, too, fills several members.
    """
    name = decoded_field.name
    member = f"{variable}.{c_name(name)}"
    match decoded_field.meaning:
        case Latin1Text():
            yield PrintedMember(name, printf_format="%.*s", arguments=f"(int)sizeof({member}), {member}")
        case ActiveFlag():
            yield PrintedMember(name, printf_format="%s", arguments=f'{member} ? "yes" : "no"')
        case TwosComplement():
            yield PrintedMember(name, printf_format="%lld", arguments=f"(long long){member}")
        case NamedChoice(values):
            yield replace(printed_number(name, variable), value_names=_value_meanings(values))
        case DecimalDigits(digit_runs):
            yield printed_number(name, variable)
            for digit_run in digit_runs:
                yield printed_number(digit_run.name, variable)
        case _:
            yield printed_number(name, variable)


def printed_number(name: str, variable: str) -> PrintedMember:
    """Return an unsigned member of the struct ``variable``, as ``printf`` prints it."""
    return PrintedMember(name, printf_format="%llu", arguments=f"(unsigned long long){variable}.{c_name(name)}")


def _value_meanings(values: Iterable[Value]) -> str:
    """Return the meanings of the values, such as ``0 off, 1 on``, or an empty string if the line would be too long."""
    meanings = ", ".join(f"{value.value} {ascii_text(title_of(value))}" for value in values)
    return meanings if len(meanings) <= _LONGEST_EXPLANATION else ""


@dataclass(frozen=True, slots=True)
class ShownRegister:
    """A register that the program reads with its own function and prints."""

    title: str
    name: str
    about: str
    access: RegisterFunctions
    struct: LayoutStruct

    @property
    def members(self) -> int:
        """The number of members in its struct."""
        plan = self.struct.layout_plan
        fields = [decoded_field.field for decoded_field in plan.decoded_fields]
        return len(plan.joined_numbers) + sum(1 + len(field.runs) for field in fields)


@dataclass(frozen=True, slots=True)
class ShownProcedure:
    """A procedure that the program carries out, with its arguments."""

    title: str
    about: str
    procedure_code: ProcedureCode
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Memory:
    """Initial content of a simulated register."""

    address: int
    data: bytes
    note: str


@dataclass(frozen=True, slots=True)
class ReceivedBytes:
    """The bytes that SPI received for the frame, and the macros for its length in bits and bytes."""

    bits_macro: str
    size_macro: str
    data: bytes


@dataclass(frozen=True, slots=True)
class Session:
    """A request over SPI, and the bytes of the frame that is its reply.

    ``initial`` is the initializer of its struct, ``macro`` the constant of the request, and ``size`` the number of
    bytes of its longest word.
    """

    request: LayoutStruct
    initializer: str
    macro: str
    data: bytes
    size: int
