"""Example programs for one interface: worked examples over a simulated bus, for any host, and receivers with DMA."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress

from ...model import (
    Answer,
    Biss,
    ModifyStep,
    Register,
    RegisterStep,
    Rs485,
    SendStep,
    Spi,
    Ssi,
    Verdict,
    WriteStep,
    cite,
    first_or_raise,
    number_to_bytes,
)
from ...plan.frames import SSI_EXTRA_BITS, FrameSize, received_sizes
from ...plan.steps import SendRequest
from ...plan.values import (
    TwosComplement,
    UnsignedNumber,
    meaning_of,
)
from ...say.names_and_evidence import name_in_words, title_of
from ...say.text import VERDICT_CLAUSES
from .codec import StructCodec
from .comments import ascii_text
from .context import AlternativeCode
from .device import DeviceView
from .interfaces import ReplyRequest
from .names import c_name
from .positions import Positions
from .procedures import StepRow
from .reports import FrameReports
from .structs import LayoutStruct
from .variants import CodeRow
from .worked_examples import (
    ChosenExamples,
    ExampleFrame,
    Memory,
    NoFrame,
    ReceivedBytes,
    Session,
    ShownProcedure,
    ShownRegister,
    printed_members,
    printed_number,
)

#: Names of the program and the README that a register must not take: the function show_frame, and variables.
_NAMES_OF_LOCALS = frozenset(("bus", "encoder", "failure", "frame", "result"))
#: Smallest size of the simulated registers in bytes: the addresses 0 to 127, which BiSS can access.
_FEWEST_REGISTER_BYTES = 128


class ExampleCode:
    """The values for the template of an example program, which shows a frame, registers and a procedure.

    ``shown_procedure`` is the procedure or None, ``shown_registers`` are the registers, and ``memory`` is the initial
    content of the simulated registers.

    Raises:
        NoFrame: There is no frame to show.
    """

    def __init__(self, view: DeviceView) -> None:
        self.view = view
        self.interface = view.context.interface
        #: Functions for the members that the program prints.
        self.printed_members = printed_members
        self.printed_number = printed_number
        self._chosen_examples = chosen = ChosenExamples(view.device, self.interface)
        self.name = view.stem
        self.code_row: CodeRow = view.variants.rows[view.device.variants.index(chosen.variant)]
        self.frame: ExampleFrame = chosen.frame
        self.shown_procedure = self._choose_procedure()
        self.shown_registers = [self._show_register(register) for register, _ in chosen.registers.values()]
        self.memory = list(self._yield_memory())

    # -- the frame

    @property
    def codec(self) -> StructCodec:
        """The functions of the frame."""
        codecs = (codec for codec in self.view.interface.codecs if codec.struct is self.struct)
        return first_or_raise(codecs, f"codec for '{self.struct.layout.name}'")

    @property
    def alternatives(self) -> tuple[AlternativeCode, ...]:
        """The questions that the user must answer to decode the frame. The program uses the first answers."""
        return self.codec.alternatives

    @property
    def length_encoder(self) -> str:
        """The first arguments of functions that need only the length of the frame: order code and answers."""
        return ", ".join(("ENCODER", *(question.constant for question in self.codec.length_alternatives)))

    @property
    def encoder(self) -> str:
        """The first arguments of the decoder: the order code, and the answers to questions left open by the manual."""
        return ", ".join(("ENCODER", *(question.constant for question in self.alternatives)))

    @property
    def received_sizes(self) -> list[FrameSize]:
        """The lengths of the frame as received, one for each order code, with the first answers of alternatives."""
        first_answers = [question.spec_question.answers[0] for question in self.alternatives]
        sizes = received_sizes(self.view.device, self.interface)
        sizes_of_frame = [size for size in sizes if size.layout is self.frame.layout]
        return [size for size in sizes_of_frame if _has_only_answers(size, first_answers)]

    @property
    def has_crc(self) -> bool:
        return self.frame.layout.always_has_crc

    @property
    def title(self) -> str:
        name = name_in_words(self.frame.layout.name)
        return name[0].upper() + name[1:]

    @property
    def struct(self) -> LayoutStruct:
        """The struct of the frame."""
        structs = (codec.struct for codec in self.view.interface.codecs)
        own_structs = (struct for struct in structs if struct.layout is self.frame.layout)
        return first_or_raise(own_structs, f"struct for '{self.frame.layout.name}'")

    @property
    def reports(self) -> FrameReports | None:
        """The functions for the reports and the verdict of the frame, or None if it has neither."""
        return self.view.reports.of(self.frame.layout, self.struct.name, self.struct.type)

    @property
    def verdict_words(self) -> tuple[str, ...]:
        """The verdicts in words, ordered by number."""
        return tuple(VERDICT_CLAUSES[verdict] for verdict in Verdict)

    @property
    def frame_bytes(self) -> bytes:
        """Bytes of the frame, none if it is a word."""
        layout = self.frame.layout
        if not layout.in_bytes:
            return b""
        frame_bits = layout.place(self._chosen_examples.variant.parameters).bits
        return number_to_bytes(layout, self.frame.sent_number, frame_bits)

    @property
    def bytes_over_ssi(self) -> ReceivedBytes | None:
        """The bytes that SPI receives from the data line of SSI, or None for another interface.

        The line is high until the first clock has stored the position. Then come the word and a 0.
        """
        sizes = [size for size in self.received_sizes if size.variant is self._chosen_examples.variant]
        if not sizes or not isinstance(self.interface, Ssi):
            return None
        size = sizes[0]
        bits_macro, bytes_macro = self.view.frame_lengths.macros_of(size)
        # A 1, the word, and a 0. In the buffer, the first bit received is the highest of the first byte.
        bits_on_line = ((1 << size.frame_bits) | self.frame.sent_number) << 1
        # SSI_EXTRA_BITS counts the 1 and the 0.
        unused_bits = 8 * size.buffer_bytes - size.frame_bits - SSI_EXTRA_BITS
        return ReceivedBytes(
            bits_macro=bits_macro.name,
            size_macro=bytes_macro.name,
            data=(bits_on_line << unused_bits).to_bytes(size.buffer_bytes, "big"),
        )

    @property
    def spi_request(self) -> Session | None:
        """The request for the position that the frame answers over SPI, or None."""
        request_name = self._request_over_spi()
        if not request_name:
            return None
        structs = (codec.struct for codec in self.view.interface.codecs)
        requests = (struct for struct in structs if struct.layout.name == request_name)
        request = first_or_raise(requests, f"struct for '{request_name}'")
        parameters = self._chosen_examples.variant.parameters
        reply_bits = self.frame.layout.place(parameters).bits
        return Session(
            request=request,
            initializer=request.initializer(parameters),
            macro=f"{self.view.PREFIX}_REQUEST_{request_name}".upper(),
            # Bits to bytes, rounded up.
            data=self.frame.sent_number.to_bytes((reply_bits + 7) // 8, "big"),
            size=(request.layout.widest + 7) // 8,
        )

    def _request_over_spi(self) -> str:
        """Return the request for the position that the frame answers over SPI, or an empty string."""
        exchanges = self.interface.exchanges if isinstance(self.interface, Spi) else ()
        for exchange in exchanges:
            if exchange.purpose == "position" and exchange.reply == self.frame.layout.name:
                return exchange.request
        return ""

    @property
    def request_for_reply(self) -> ReplyRequest | None:
        """The request frame over RS-485 to which the frame is the reply, or None if a control field requests it.

        Numbers that the reply repeats, such as an address, have the same values in it.
        """
        parameters = self._chosen_examples.variant.parameters
        numbers: dict[str, int] = {}
        for placed_field in self.frame.layout.place(parameters).fields:
            if isinstance(meaning_of(placed_field.field), UnsignedNumber):
                numbers[placed_field.name] = (self.frame.sent_number >> placed_field.lowest_bit) & placed_field.mask
        for joined_number in self.struct.layout_plan.joined_numbers:
            if all(field.name in numbers for field in joined_number.fields):
                numbers[joined_number.name] = joined_number.number_of(numbers, parameters)
        return self.view.interface.request_for_reply(self.frame.layout, numbers)

    @property
    def request_macro(self) -> str:
        """The macro of the control field to which the frame is the reply, or an empty string.

        The reply begins with the same byte.
        """
        data_ids = self.interface.data_ids if isinstance(self.interface, Rs485) else ()
        for data_id in data_ids:
            if self.frame_bytes.startswith(bytes([data_id.control])):
                return f"{self.view.PREFIX}_CONTROL_{data_id.name}".upper()
        return ""

    @property
    def longest_reply(self) -> int:
        """Bytes of the longest frame that the encoder sends on this interface."""
        frames = (layout for layout in self.interface.layouts if layout.sender == "encoder" and layout.in_bytes)
        return max((layout.widest // 8 for layout in frames), default=0)

    @property
    def can_poll(self) -> bool:
        """True if the program is a main loop that requests the frame and carries out the procedure.

        For this, the frame must have a request, and the procedure must have at least one request, a reply to each of
        its requests, and no arguments or values to read.
        """
        code = self.shown_procedure.procedure_code if self.shown_procedure is not None else None
        if code is None or code.arguments or code.read_members or not self.request_macro:
            return False
        operations = [row.operation for row in code.rows if isinstance(row, StepRow)]
        requests = [operation for operation in operations if isinstance(operation, SendRequest)]
        return bool(requests) and all(request.reply is not None for request in requests)

    @property
    def position(self) -> Positions | None:
        """The functions that convert the position in the frame, or None if the frame has no position."""
        return self.view.positions if self._chosen_examples.has_position(self.frame.layout) else None

    @property
    def modulus(self) -> str:
        """The counts after which the position wraps around, as C, for a tracker. ``0U`` without a position."""
        return self.view.modulus("ENCODER", self.frame.layout) if self.position is not None else "0U"

    @property
    def position_member(self) -> str:
        """The member with the position in counts, or an empty string."""
        measurement = self._chosen_examples.measurement
        return c_name(measurement.position_name) if measurement is not None else ""

    @property
    def reads_word_twice(self) -> bool:
        """True if the program reads the word twice and compares both, because no CRC protects it.

        This requires a position that is never negative.
        """
        return bool(self.position_member) and not self.is_signed(self.position_member) and not self.has_crc

    def is_signed(self, member: str) -> bool:
        """Return whether a member of the frame can be negative."""
        fields = (field for field in self.struct.layout_plan.decoded_fields if c_name(field.name) == member)
        return any(isinstance(field.meaning, TwosComplement) for field in fields)

    @property
    def headers(self) -> Iterator[str]:
        """The headers of the interface that the program includes."""
        part_names = set()
        if self.reports is not None and self.reports.reports_function:
            part_names.add("reports")
        if self.shown_registers:
            part_names.add("registers")
        if self.shown_procedure is not None:
            part_names.add("procedures")
        yield self.view.header
        yield from self.headers_of(part_names)

    def headers_of(self, names: Collection[str]) -> Iterator[str]:
        """Yield the include paths of further headers with these names, such as ``registers``."""
        yield from (f"{self.view.maker.name}/{part.file}" for part in self.view.parts if part.name in names)

    # -- registers and procedures

    @property
    def has_registers(self) -> bool:
        """True if the program reads registers, or carries out a procedure that accesses registers."""
        return bool(self.shown_registers) or any(isinstance(step, RegisterStep) for step in self._procedure_steps)

    @property
    def sends_request(self) -> bool:
        """True if the program carries out a procedure that sends a request."""
        return any(isinstance(step, SendStep) for step in self._procedure_steps)

    @property
    def simulated_bytes(self) -> int:
        """The size of the simulated registers in bytes."""
        sizes_needed = [register.last_address + 1 for register in self.view.device.registers]
        return max((_FEWEST_REGISTER_BYTES, *sizes_needed))

    @property
    def _procedure_steps(self) -> tuple[object, ...]:
        """The steps of the procedure, none without a procedure."""
        if self.shown_procedure is None:
            return ()
        return self.shown_procedure.procedure_code.procedure_plan.procedure.steps

    def _choose_procedure(self) -> ShownProcedure | None:
        """Return the procedure that the program carries out, with the arguments of its worked example.

        The result is None if there is no procedure to show.
        """
        if self._chosen_examples.procedure is None:
            return None
        procedure, example = self._chosen_examples.procedure
        procedure_codes = (code for code in self.view.procedures if code.procedure_plan.procedure is procedure)
        procedure_code = first_or_raise(procedure_codes, f"code for the procedure '{procedure.name}'")
        argument_values: dict[str, int] = {}
        if example is not None:
            argument_values = {argument.name: example.arguments[argument.name] for argument in procedure.arguments}
        heading = ascii_text(procedure.title)
        if argument_values:
            heading += ": " + ", ".join(f"{name} {value}" for name, value in argument_values.items())
        return ShownProcedure(
            title=heading,
            about=f"{procedure.title} [{cite(procedure.source)}]. It changes the contents of the encoder.",
            procedure_code=procedure_code,
            values=tuple(argument_values.values()),
        )

    def _show_register(self, register: Register) -> ShownRegister:
        """Return a register that the program reads, with the source of its worked example."""
        example = self._chosen_examples.registers[register.name].example
        register_codes = (code for code in self.view.registers if code.register is register)
        register_code = first_or_raise(register_codes, f"code for the register '{register.name}'")
        return ShownRegister(
            title=f"{ascii_text(title_of(register))} {register.address:02X}h",
            name=c_name(register.name, _NAMES_OF_LOCALS),
            about=f"a worked example [{cite(example.source)}]",
            access=register_code.access,
            struct=register_code.struct,
        )

    def _yield_memory(self) -> Iterator[Memory]:
        """Yield the initial contents of the simulated registers, by address: the bytes of their worked examples.

        Registers that the procedure writes have their factory default instead, or 0 if the manual gives none.
        """
        written_names = {step.register for step in self._procedure_steps if isinstance(step, (WriteStep, ModifyStep))}
        by_address = sorted(self._chosen_examples.registers.values(), key=lambda worked: worked.register.address)
        for register, example in by_address:
            title = title_of(register)
            content = example.bytes
            if register.name in written_names:
                title += ", factory default"
                content = register.default_bytes() or bytes(register.length)
            yield Memory(register.address, data=content, note=title)


def _has_only_answers(frame: FrameSize, answers: Sequence[Answer]) -> bool:
    """Return True if a frame has its length with these answers, or whatever the answers to open questions are."""
    return all(answer in answers for answer in frame.answers)


def example_codes(view: DeviceView) -> Iterator[ExampleCode]:
    """Yield the example program of an interface, or nothing if there is no frame to show."""
    if any(layout.sender == "encoder" for layout in view.context.interface.layouts):
        with suppress(NoFrame):
            yield ExampleCode(view)


class ReceiverCode:
    """The values for the template of a program that receives frames by DMA.

    The program is for the order code with the longest frame.
    """

    def __init__(self, example: ExampleCode) -> None:
        view = example.view
        self.view = view
        self.example = example
        self.name = f"{view.stem}_dma"
        self.sketch = f"{view.stem}_arduino"
        self.struct = example.struct
        self.verdict_function = example.reports.verdict_function if example.reports is not None else ""
        self.member = example.position_member
        self.is_signed = example.is_signed(example.position_member)
        #: The size of the longest frame. The program is for its order code.
        self.longest_frame = max(example.received_sizes, key=lambda frame: frame.frame_bits)
        variant = self.longest_frame.variant
        rows = (row for row in view.variants.rows if row.variant is variant)
        self.code_row: CodeRow = first_or_raise(rows, f"row for {variant.code}")
        #: The macros of the bits in a frame and of the bytes in its buffer.
        self.bits_macro, self.size_macro = (macro.name for macro in view.frame_lengths.macros_of(self.longest_frame))
        reading = view.position_reader
        #: The call that reads the position from the buffer.
        self.read_call = f"{reading.macro}({reading.arguments_of(self.code_row.name_in_macros)}, rx, &position)"
        self.position_type = reading.frame.struct.member_type(reading.frame.position_member) if reading.frame else ""
        self.modulus = view.modulus(self.code_row.macro, example.frame.layout)


def receiver_codes(examples: Iterable[ExampleCode]) -> Iterator[ReceiverCode]:
    """Yield a program that receives by DMA for each example over BiSS with one frame, whose position has a verdict."""
    for example in examples:
        has_verdict = example.reports is not None and bool(example.reports.verdict_function)
        has_position = bool(example.position_member) and example.position is not None
        has_one_frame = len(example.view.frame_lengths.layout_names) == 1
        if isinstance(example.interface, Biss) and has_verdict and has_position and has_one_frame:
            yield ReceiverCode(example)


def own_programs(
    view: DeviceView, render_later: Callable[[str, Mapping[str, object]], Callable[[], str]]
) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path in the C folder of each example program of an interface, and a function that returns its text.

    ``render_later`` takes a template and its values, and returns such a function.
    """
    maker = view.maker
    examples = list(example_codes(view))
    programs: list[ExampleCode | ReceiverCode] = [*examples, *receiver_codes(examples)]
    for program in programs:
        values = {"maker": maker, "PREFIX": maker.name.upper(), "d": view, "e": program}
        yield f"examples/{program.name}.c", render_later(_program_template(program), values)
        if isinstance(program, ReceiverCode):
            yield f"examples/{program.sketch}/{program.sketch}.ino", render_later("sketch.ino.jinja", values)


def _program_template(program: ExampleCode | ReceiverCode) -> str:
    """Return the template of a program: a receiver with DMA, a main loop that polls, or a list of worked examples."""
    if isinstance(program, ReceiverCode):
        return "receiver.c.jinja"
    return "poller.c.jinja" if program.can_poll else "example.c.jinja"
