"""The worked examples of the manual that a program shows, and a made-up frame if the manual has none."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
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
    Values,
    Variant,
    assert_never,
    cite,
    number_from_bytes,
)
from ...model.record import dataclass
from ...say.names_and_evidence import word_for_document


@dataclass(frozen=True, slots=True)
class ExampleFrame:
    """A frame as a number, its source, and the values of its fields, as far as they are known."""

    layout: Layout
    wire: int
    about: str
    values: Values


class NoFrame(Exception):
    """The manual shows no frame of an interface, and none could be made up."""


def chosen_variant(device: Device, interface: Interface) -> Variant:
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


class Chosen:
    """The worked examples of the manual for one order code of an interface, chosen by ``chosen_variant``.

    Raises:
        NoFrame: There is no frame to show.
    """

    def __init__(self, device: Device, interface: Interface) -> None:
        self.device = device
        self.interface = interface
        self.measurement = device.measurement_of(interface.name)
        self.variant = chosen_variant(device, interface)
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
            wire=int(example.bits, 2) if example.bits else number_from_bytes(layout, example.bytes),
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
        return ExampleFrame(layout=layout, wire=sample.frame, about=about, values=sample.values)

    def has_position(self, layout: Layout) -> bool:
        """Return True if a layout has the field or join that contains the position."""
        return self.measurement is not None and self.measurement.of in layout.member_names


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
