"""A device module: all its parts, for its template."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import chain

from ...model import Device, Field, Interface, Register, Spi, Value
from ...model.record import dataclass
from ...plan.frames import FrameDispatch, dispatches, identities
from ...say import text_on_one_line
from ...say.names_and_evidence import name_in_words
from . import docstrings, facts
from .bits import from_slices
from .channel_examples import ChannelExample, channel_example
from .codec import LayoutClass
from .docstrings import Block, Lines, docstring
from .facts import record_from_model, records_from_model
from .frame_kinds import FrameKind
from .literals import CallLiteral, PythonExpression
from .names import (
    LOCAL_NAMES,
    DeviceNames,
    OpenQuestion,
    decoder_maker,
    encoder_name,
    in_camel_case,
    interface_name,
    is_one_choice,
    python_name,
)
from .procedures import ProcedureFunction
from .readme import Readme, ReadmeExample
from .shapes import ShapeLiteral
from .variants import VariantTable


@dataclass(frozen=True)
class Enumeration:
    """An enumeration of named values.

    If it is for a register that consists only of one named value, its class can also decode and encode the register.
    """

    name: str
    doc: str
    values: tuple[Value, ...]
    register: Register | None = None


@dataclass(frozen=True)
class FrameDispatcher:
    """The function that decodes any frame from one sender, such as ``decode_reply``.

    ``union_type`` is the type of its result. ``fallback`` is the class of the frame for all other values of the field
    by which frames differ, or None.
    """

    dispatch_plan: FrameDispatch
    name: str
    union_type: str
    interface: str
    encoder: str
    layout_classes: tuple[LayoutClass, ...]
    fallback: LayoutClass | None

    @property
    def frame_classes(self) -> tuple[LayoutClass, ...]:
        """The classes of all frames that it decodes."""
        return self.layout_classes if self.fallback is None else (*self.layout_classes, self.fallback)

    @property
    def local(self) -> str:
        """The variable for the field by which frames differ (the selector)."""
        return python_name(self.dispatch_plan.selector.name, LOCAL_NAMES)

    @property
    def maker(self) -> str:
        """The function that returns the decoder for an encoder."""
        return decoder_maker(self.name)

    @property
    def kind_of_frame(self) -> str:
        """The word for its frames: ``reply`` if the encoder sends them, and otherwise ``request``."""
        return "reply" if self.dispatch_plan.sender == "encoder" else "request"

    @property
    def value(self) -> PythonExpression:
        """The selector, extracted from the bytes."""
        return from_slices(self.dispatch_plan.bits.bit_slices)

    @property
    def allowed_values(self) -> list[int]:
        """All values that the selector has in a frame."""
        return sorted(chain.from_iterable(branch.values for branch in self.dispatch_plan.branches))

    @property
    def questions(self) -> list[OpenQuestion]:
        """The questions that the manual leaves open about any of the frames."""
        questions_by_name: dict[str, OpenQuestion] = {}
        for layout_class in self.frame_classes:
            questions_by_name |= {question.name: question for question in layout_class.questions}
        return list(questions_by_name.values())

    @property
    def described_answers(self) -> list[tuple[str, str]]:
        """The arguments for the answers, with their descriptions."""
        return [(question.name, question.about) for question in self.questions]

    @property
    def selector_title(self) -> str:
        """The name of the selector in the manual."""
        return text_on_one_line(
            self.dispatch_plan.selector.printed_name or name_in_words(self.dispatch_plan.selector.name)
        )


@dataclass(frozen=True)
class InterfaceSection:
    """An interface of a device: its facts, its frames, and the functions that decode any frame from one sender."""

    interface: Interface
    facts: CallLiteral
    errata_lines: Sequence[Sequence[str]]
    layout_classes: tuple[LayoutClass, ...]
    dispatchers: tuple[FrameDispatcher, ...]


def _group_by_interface(functions: Iterable[ProcedureFunction]) -> dict[str, list[str]]:
    """Return the names of the functions over each interface, in order."""
    names_by_interface: dict[str, list[str]] = {}
    for function in functions:
        names_by_interface.setdefault(function.interface, []).append(function.name)
    return names_by_interface


class Module:
    """All parts of the module of a family, such as its registers, procedures and order codes."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self.device_names = DeviceNames(device)
        self.name = self.device_names.module_name
        self.sections = [self._interface_section(interface) for interface in device.interfaces]
        self.registers = [self._register_class(register) for register in device.registers]
        self.class_by_register = {
            register_class.register.name: register_class
            for register_class in self.registers
            if isinstance(register_class, LayoutClass) and register_class.register
        }
        self.procedures = [
            ProcedureFunction(self.device_names, self.class_by_register, procedure) for procedure in device.procedures
        ]
        frames = tuple(layout_class for section in self.sections for layout_class in section.layout_classes)
        self.layout_classes = (*frames, *self.class_by_register.values())
        frame_kinds = tuple(self._frame_kinds())
        self.variant_table = VariantTable(self.device_names, frame_kinds, frames)
        self.procedures_by_interface = _group_by_interface(self.procedures)
        function_by_procedure = {function.procedure.name: function for function in self.procedures}
        self.readme = Readme(self.device_names, frame_kinds, self.class_by_register, function_by_procedure)
        self.identities = list(identities(device))
        self.family = facts.family_record(device)
        self.manual = record_from_model("Manual", device.manual)
        self.order_code = facts.order_code_record(device.order_code)
        self.crcs = records_from_model("Crc", device.crcs)

    # -- facts, which the files of the whole package do not need

    @cached_property
    def tables(self) -> list[facts.FactTable]:
        return facts.tables_at_end(self.device)

    @cached_property
    def reports(self) -> list[CallLiteral]:
        return facts.report_records(self.device)

    @cached_property
    def register_rows(self) -> dict[str, CallLiteral]:
        return facts.record_by_register(self.device)

    @cached_property
    def frame_rows(self) -> dict[str, tuple[CallLiteral, ...]]:
        return facts.field_records_by_frame(self.device)

    # -- docstring and contents

    @property
    def doc(self) -> str:
        return docstrings.describe_module(
            self.device, [(name, ", ".join(names)) for name, names in self.contents], self._decode_example()
        )

    @cached_property
    def contents(self) -> list[tuple[str, list[str]]]:
        """All public names of the module, in groups, for its docstring. Each name is in one group."""
        return [(name, names) for name, names in self._groups_of_public_names() if names]

    def _groups_of_public_names(self) -> Iterator[tuple[str, list[str]]]:
        """Yield the groups of public names, each with its title."""
        identification = ["identify"] if self.identities else []
        yield "Encoders", ["lookup", *identification, "Variant", *self._encoder_names(), "VARIANTS", "FAMILY"]
        for section in self.sections:
            frames = [layout_class.name for layout_class in section.layout_classes]
            for dispatcher in section.dispatchers:
                frames += (dispatcher.union_type, dispatcher.name)
            yield section.interface.title, frames
        yield "All interfaces", ["Frame"] if self.variant_table.sent_frames else []
        enumerations = [enumeration.name for enumeration in self.enums]
        yield "Values of fields", [*enumerations, *(question.enum_name for question, _ in self.alternatives)]
        addresses = ["Address"] if self.registers else []
        yield "Registers", [*(register.name for register in self.registers), *addresses]
        yield "Procedures", [function.name for function in self.procedures]
        yield "CRCs", [*self.device_names.crc_functions]
        yield "Facts", self.fact_names

    def _encoder_names(self) -> Iterator[str]:
        yield from (encoder_name(section.interface.name) for section in self.sections)

    @property
    def fact_names(self) -> list[str]:
        """Names of the tables of facts, in alphabetical order, without those that are empty."""
        names = ["MANUAL", "ORDER_CODE", *(table.name for table in self.tables)]
        names += [section.interface.name.upper() for section in self.sections]
        fact_tables = {
            "CRCS": self.crcs,
            "FRAMES": self.frame_rows,
            "REGISTERS": self.registers,
            "REPORTS": self.reports,
        }
        return sorted([*names, *(name for name, facts_of_kind in fact_tables.items() if facts_of_kind)])

    def _decode_example(self) -> Iterable[Block]:
        """Yield the example in the docstring of the module: the first frame of the README, decoded and checked.

        Nothing is yielded if the README has no frame.
        """
        for frame in self.readme.frame_examples[:1]:
            # The package's lookup() finds the family from which this one is derived, so its own module has another.
            lookup_name, call = (self.name, f"{self.name}.lookup") if self.device.base else ("lookup", "lookup")
            verdict_name = "Verdict" if frame.has_verdict else ""
            # The module is empty unless the call needs an answer.
            names = ", ".join(filter(None, (verdict_name, frame.module, lookup_name)))
            lookup_lines = (
                f"from {self.device.manufacturer.python_package} import {names}",
                f'encoder = {call}("{frame.code}")',
            )
            if frame.has_verdict:
                yield "A valid frame does not imply a usable position. Check the verdict before you use the position:"
            yield Lines((*lookup_lines, f"frame = encoder.decode({frame.argument}{frame.answers})", *frame.lines))

    @property
    def alternatives(self) -> list[tuple[OpenQuestion, str]]:
        """Questions that the manual leaves open, with their docstrings."""
        questions = self.device_names.question_by_name.values()
        return [
            (question, docstrings.describe_alternative(self.device, question.alternative)) for question in questions
        ]

    @property
    def spi_example(self) -> ReadmeExample | None:
        """The example of a position over SPI, whose ``frame_class`` is the class of the request.

        It is None if the first such frame depends on an open question, or if no request for a position can be built
        without the encoder and without values.
        """
        spi_examples = [
            example for example in self.readme.frame_examples if example.interface == "spi" and example.position
        ]
        interface = self.device.find_interface(Spi)
        if not spi_examples or interface is None:
            return None
        example = spi_examples[0]
        # An open question is then an argument of the decoder.
        if example.answers:
            return None
        request_names = [exchange.request for exchange in interface.exchanges if exchange.purpose == "position"]
        for layout_class in self.layout_classes:
            needs_no_values = not layout_class.takes_variant and not layout_class.attributes
            if layout_class.layout.name in request_names and needs_no_values:
                return replace(example, frame_class=layout_class.name, module=self.name)
        return None

    @property
    def channel_examples(self) -> list[ChannelExample]:
        """An example for each interface whose frames have several data channels."""
        examples = [
            channel_example(self.device_names, section.interface, section.layout_classes) for section in self.sections
        ]
        return [example for example in examples if example is not None]

    @property
    def identifying_classes(self) -> list[str]:
        """The classes of encoders that can be identified by their registers."""
        return [encoder_name(identity.interface) for identity in self.identities]

    @cached_property
    def shapes(self) -> list[ShapeLiteral]:
        """Descriptions of all frames, for ``decode_many``."""
        frames = (layout_class for section in self.sections for layout_class in section.layout_classes)
        reportings = self.device_names.reports_by_frame
        return [ShapeLiteral(layout_class, reportings.get(layout_class.layout.name)) for layout_class in frames]

    @property
    def register_shapes(self) -> list[ShapeLiteral]:
        """Descriptions of the registers that have a class."""
        return [ShapeLiteral(layout_class, None) for layout_class in self.class_by_register.values()]

    @property
    def shapes_by_sender(self) -> dict[tuple[str, str], list[ShapeLiteral]]:
        """The descriptions of frames by interface and sender, such as ``("rs485", "encoder")``."""
        shapes_by_sender: dict[tuple[str, str], list[ShapeLiteral]] = {}
        for shape in self.shapes:
            key = (shape.layout_class.layout_interface, shape.layout_class.layout.sender)
            shapes_by_sender.setdefault(key, []).append(shape)
        return shapes_by_sender

    # -- parts

    @cached_property
    def enums(self) -> list[Enumeration]:
        """The enumerations of the fields with named values."""
        fields = self.device_names.field_by_named_values.values()
        return [
            Enumeration(self.device_names.enum_name(field), _enumeration_doc(field), field.values) for field in fields
        ]

    def _interface_section(self, interface: Interface) -> InterfaceSection:
        """Return an interface with its frames, and the functions that decode any frame from one sender."""
        layout_classes = tuple(LayoutClass(self.device_names, interface.name, layout) for layout in interface.layouts)
        dispatchers = [
            self._sender_dispatcher(interface, dispatch, layout_classes) for dispatch in dispatches(interface.layouts)
        ]
        # Frames sent by the master come first.
        dispatchers.sort(key=lambda dispatcher: dispatcher.dispatch_plan.sender == "encoder")
        errata_lines = docstrings.errata_lines(self.device, interface)
        return InterfaceSection(
            interface=interface,
            facts=facts.interface_record(interface),
            errata_lines=errata_lines,
            layout_classes=layout_classes,
            dispatchers=tuple(dispatchers),
        )

    def _sender_dispatcher(
        self, interface: Interface, dispatch_plan: FrameDispatch, layout_classes: Sequence[LayoutClass]
    ) -> FrameDispatcher:
        """Return the function that decodes any frame from one sender, such as ``decode_reply``.

        If several interfaces have such functions, its name contains the interface, as in ``decode_spi_reply``.
        ``layout_classes`` are the classes of the frames over the interface.
        """
        # The frames with a selector need such a function.
        interfaces_with_dispatcher = {owner.name for owner, layout in self.device.layouts() if layout.selector}
        request_or_reply = "reply" if dispatch_plan.sender == "encoder" else "request"
        if len(interfaces_with_dispatcher) > 1:
            request_or_reply = f"{interface.name}_{request_or_reply}"
        class_by_frame = {layout_class.layout.name: layout_class for layout_class in layout_classes}
        dispatcher = FrameDispatcher(
            dispatch_plan=dispatch_plan,
            name=f"decode_{request_or_reply}",
            union_type=in_camel_case(request_or_reply),
            interface=interface_name(interface.name),
            encoder=encoder_name(interface.name),
            layout_classes=tuple(class_by_frame[branch.layout.name] for branch in dispatch_plan.branches),
            fallback=class_by_frame[dispatch_plan.fallback.name] if dispatch_plan.fallback is not None else None,
        )
        # Each decoder accepts the answers for all frames among which it is chosen.
        for layout_class in dispatcher.frame_classes:
            layout_class.passed_arguments = dispatcher.questions
        return dispatcher

    def _register_class(self, register: Register) -> LayoutClass | Enumeration:
        """Return the class of a register, or if it consists only of one named value, its enumeration."""
        if not is_one_choice(register):
            return LayoutClass(self.device_names, register.interface, register.layout, register)
        summary, blocks = docstrings.describe_register(self.device, register)
        name = self.device_names.class_name_by_register[register.name]
        doc = docstring(summary, *blocks, indent=4)
        return Enumeration(name, doc=doc, values=register.values, register=register)

    def _frame_kinds(self) -> Iterator[FrameKind]:
        """Yield the frames that the encoder sends over each interface, if it sends any."""
        for section in self.sections:
            replies = [
                layout_class for layout_class in section.layout_classes if layout_class.layout.sender == "encoder"
            ]
            if replies:
                yield self._frame_kind(section, replies)

    def _frame_kind(self, section: InterfaceSection, replies: Sequence[LayoutClass]) -> FrameKind:
        """Return the frames that the encoder sends over an interface. ``replies`` are their classes, at least one.

        If frames differ in the value of a field (the selector), a function such as ``decode_reply`` decodes any of
        them. Otherwise, every frame is decoded as the first one with the position, or without a position as the first.
        """
        interface = section.interface.name
        # A word does not show which frame it is. It is interpreted as the position.
        classes_with_position = [
            layout_class for layout_class in replies if self.device.sends_position(interface, layout_class.layout)
        ]
        layout_class = classes_with_position[0] if classes_with_position else replies[0]
        for dispatcher in section.dispatchers:
            # There is at most one dispatcher for each sender.
            if dispatcher.dispatch_plan.sender == "encoder":
                return FrameKind(
                    interface=interface,
                    layout_class=layout_class,
                    dispatch_function=dispatcher.name,
                    union_type=dispatcher.union_type,
                    questions=dispatcher.questions,
                    frame_classes=dispatcher.frame_classes,
                )
        return FrameKind(
            interface=interface,
            layout_class=layout_class,
            dispatch_function="",
            union_type="",
            questions=layout_class.questions,
            frame_classes=(layout_class,),
        )


def _enumeration_doc(field: Field) -> str:
    """Return the docstring of the enumeration of a field."""
    return docstring(docstrings.describe_value(field) or f"Values of {field.name}.", indent=4)
