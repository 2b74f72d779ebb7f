"""One interface in C: its constants, the functions that distinguish its frames, and the codecs of its layouts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from ...model import (
    Biss,
    CableLength,
    Clock,
    Fact,
    Interface,
    Layout,
    Port,
    Rs485,
    Spi,
    Ssi,
    Timeout,
    WordFormat,
    first_or_raise,
)
from ...model.order_codes import repeated_names
from ...model.record import dataclass
from ...plan.frames import FrameDispatch, RequestAndReply, SelectedFrame, dispatches, exchanges, reply_to_data_id
from ...say.errata import describe_erratum, errata_affecting
from ...say.names_and_evidence import title_of
from ...say.order_code import (
    describe_control_field,
    describe_data_id,
    describe_exchange,
    describe_settings,
    describe_timing,
)
from ...say.order_code import describe_interface as say_interface
from ...say.text import Statement
from .about import about_layout
from .code_facts import (
    ClockLimitFunction,
    TimeoutFunction,
    clock_limits,
    function_names,
    has_cables_by_code,
    timeout_limits,
    timeout_product,
    timing_macros,
)
from .codec import StructCodec
from .comments import HEADER_STYLE, Paragraph
from .context import HeaderContext
from .expressions import CExpression, type_and_bits_in
from .names import CMacro, DeclaredName, c_name, c_number
from .reports import Reports
from .structs import LayoutStruct

_PARITY_CHARACTERS = {"none": "'N'", "even": "'E'", "odd": "'O'"}
#: Time allowed for an encoder to answer a request, in microseconds, in examples.
ANSWER_US = 10_000
_FRAME_KIND_BY_SENDER = {"encoder": "reply", "master": "request"}


class FrameSelector:
    """The functions that say which frame of a sender was received.

    ``function_of_bytes`` is the function that takes its bytes. ``function_of_value`` takes the value of the field by
    which frames differ.
    """

    def __init__(self, context: HeaderContext, prefix: str, dispatch: FrameDispatch) -> None:
        self.dispatch = dispatch
        self.function_of_bytes = f"{prefix}_{_FRAME_KIND_BY_SENDER[dispatch.sender]}_frame"
        self.function_of_value = f"{prefix}_{_FRAME_KIND_BY_SENDER[dispatch.sender]}_for"
        choice = context.enumeration_by_field.get((dispatch.branches[0].layout.name, dispatch.selector.name))
        self._names = choice.constant_by_value if choice is not None else {}

    @property
    def value(self) -> CExpression:
        """The field by which frames differ, extracted from the bytes, such as ``bytes[0] & 0x1FU``."""
        _, bits = type_and_bits_in(self.dispatch.bits.bit_slices)
        return bits

    def constants_of(self, branch: SelectedFrame) -> list[str]:
        """Return the values that a frame has in this field, as constants of an enumeration or as numbers."""
        return [self._names.get(value, c_number(value, hexadecimal=True)) for value in branch.values]


@dataclass(frozen=True, slots=True)
class ReplyRequest:
    """The request to which a frame is the reply.

    ``initial`` is the initializer of its struct, and ``take_function`` the function of the runtime that receives the
    reply. ``latest_reply_us`` is the time that both take on the line, plus ``ANSWER_US`` for the encoder.
    ``repeated_members`` are the numbers that the reply repeats, such as an address.
    """

    codec: StructCodec
    initializer: str
    take_function: str
    latest_reply_us: int
    repeated_members: tuple[str, ...]


class InterfaceCode:
    """The values that the templates print for an interface. ``codecs`` are its frames."""

    def __init__(self, context: HeaderContext, interface: Interface, reports: Reports) -> None:
        self.device = context.device
        self.interface = interface
        self.prefix = context.prefix
        self._macro_prefix = context.PREFIX
        #: Functions for all order codes, at most one of each kind.
        self.clock_limits = list(self._clock_limits())
        self.timeouts = list(self._yield_timeout_functions())
        macros_and_statements = list(self._macros_and_statements())
        requests_and_statements = list(self._requests_and_statements())
        self.macros = tuple(macro for macro, _ in macros_and_statements if macro is not None)
        self.control_data_macros = tuple(macro for macro, _ in requests_and_statements)
        #: Statements in the comments on macros and functions, which the comment on the interface does not repeat.
        all_statements = [statement for _, statement in (*macros_and_statements, *requests_and_statements)]
        self._stated_elsewhere = [statement for statement in all_statements if statement is not None]
        self.about = list(self._yield_comment())
        self.enumerations = context.enumerations.of("interfaces", interface.name)
        self.frame_selectors = tuple(
            FrameSelector(context, self.prefix, dispatch) for dispatch in dispatches(interface.layouts)
        )
        self.codecs = tuple(self._build_codec(context, layout, reports) for layout in interface.layouts)

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names at file scope, each with its path in the spec.

        The codecs yield the names of their layouts.
        """
        path = ("interfaces", self.interface.name)
        for macro in (*self.macros, *self.control_data_macros):
            yield macro.name, path
        for layout in self.frames:
            yield self.frame_name(layout), path
        if self.frames:
            yield f"{self.prefix}_frame", path
            yield f"{self.prefix}_frame_length", path
        for frame_selector in self.frame_selectors:
            yield frame_selector.function_of_bytes, path
            yield frame_selector.function_of_value, path
        for name in function_names(self.clock_limits, self.timeouts):
            yield name, path
        for codec in self.codecs:
            yield from codec.declared()

    def _clock_limits(self) -> Iterator[ClockLimitFunction]:
        """Yield the function for the clock limit, if there is one table for all order codes."""
        interface = self.interface
        if isinstance(interface, Ssi) and interface.cable_lengths and not has_cables_by_code(interface):
            yield ClockLimitFunction(f"{self.prefix}_clock_limit_hz", interface.cable_lengths)

    def _yield_timeout_functions(self) -> Iterator[TimeoutFunction]:
        """Yield the function for the timeout, if it depends on the clock and is the same for all order codes."""
        timeout = self.interface.timeout if isinstance(self.interface, Biss) else None
        product = timeout_product(timeout)
        if product:
            yield TimeoutFunction(f"{self.prefix}_timeout_ns", product)

    @property
    def frames(self) -> list[Layout]:
        """The frames that the value of a field distinguishes."""
        names: set[str] = set()
        for frame_selector in self.frame_selectors:
            dispatch = frame_selector.dispatch
            names.update(branch.layout.name for branch in dispatch.branches)
            if dispatch.fallback is not None:
                names.add(dispatch.fallback.name)
        return [layout for layout in self.interface.layouts if layout.name in names]

    def request_of(self, reply: Layout) -> str:
        """Return the macro of the first RS-485 data ID to which a frame is the reply, such as ``ACME_X_CONTROL_ID0``.

        The result is empty for a frame that is not the reply to a data ID.
        """
        interface = self.interface
        if not isinstance(interface, Rs485):
            return ""
        for request in interface.data_ids:
            if reply_to_data_id(interface, request.id) is reply:
                return f"{self._macro_prefix}_CONTROL_{request.name}".upper()
        return ""

    def request_for_reply(self, reply: Layout, values: Mapping[str, int] = MappingProxyType({})) -> ReplyRequest | None:
        """Return the request frame to which a frame in bytes is the reply, with ``values`` in its fields.

        ``values`` are numbers by the names of fields and joined numbers. The result is None if there is no such request
        frame, or if the interface is not a serial port.
        """
        exchanged = self._exchange_with_reply(reply)
        ports = [fact for fact in self.interface.facts() if isinstance(fact, Port)]
        if exchanged is None or not ports:
            return None
        candidates = (candidate for candidate in self.codecs if candidate.struct.layout is exchanged.request)
        codec = first_or_raise(candidates, f"codec for '{exchanged.request.name}'")
        variants = self.device.variants_over(self.interface.name)
        parameters = first_or_raise(variants, f"order code with the interface '{self.interface.name}'").parameters
        reply_names = set(_member_names(reply))
        common_names = [name for name in _member_names(exchanged.request) if name in reply_names]
        bytes_on_line = (exchanged.request.widest + reply.widest) // 8
        return ReplyRequest(
            codec=codec,
            initializer=codec.struct.initializer(parameters, values),
            take_function=_take_function(exchanged),
            latest_reply_us=ANSWER_US + _time_on_line_us(ports[0], bytes_on_line),
            # C does not compare texts by !=.
            repeated_members=tuple(c_name(name) for name in common_names if codec.struct.member_type(name) != "char"),
        )

    def _exchange_with_reply(self, reply: Layout) -> RequestAndReply | None:
        """Return the first exchange whose reply is this frame in bytes, or None."""
        for exchanged in exchanges(self.interface):
            if exchanged.reply is reply and reply.in_bytes:
                return exchanged
        return None

    def frame_name(self, layout: Layout) -> str:
        """Return the constant that stands for a frame."""
        return f"{self._macro_prefix}_FRAME_{layout.name}".upper()

    def _build_codec(self, context: HeaderContext, layout: Layout, reports: Reports) -> StructCodec:
        """Return the struct, decoder and encoder of a frame."""
        # The functions of the only frame of an interface need no further name.
        is_only_frame = len(self.interface.layouts) == 1 and not self.frame_selectors
        name = context.prefix if is_only_frame else f"{context.prefix}_{layout.name}"
        struct = LayoutStruct(context, layout, name=name, length_macro=context.length_macro(layout))
        about = about_layout(self.device, self.interface, struct)
        return StructCodec(struct, about=about, family_reports=reports)

    def _yield_comment(self) -> Iterator[Paragraph]:
        """Yield the comment on the interface, without statements and errata that are comments on macros and frames."""
        interface = self.interface
        statements = say_interface(self.device, interface)
        for statement in statements:
            if statement not in self._stated_elsewhere:
                yield HEADER_STYLE.sentence(statement)
        yield from self._explain_receiving()
        path = f"interfaces.{interface.name}"
        layout_paths = [f"{path}.{layout.name}" for layout in interface.layouts]
        group_paths: set[str] = set()
        for layout in interface.layouts:
            group_paths.update(f"field_groups.{field.group}" for field in layout.fields if field.group)
        errata_of_layouts = errata_affecting(self.device, *layout_paths)
        for correction in errata_affecting(self.device, path, *group_paths, without=layout_paths):
            if correction not in errata_of_layouts:
                yield HEADER_STYLE.sentence(describe_erratum(correction))

    def _explain_receiving(self) -> Iterator[Paragraph]:
        """Yield a paragraph on how to send a request and receive its reply, if the interface has replies in bytes."""
        requests_by_function: dict[str, list[str]] = {}
        for exchanged in exchanges(self.interface):
            if exchanged.reply is not None and exchanged.reply.in_bytes:
                requests_by_function.setdefault(_take_function(exchanged), []).append(exchanged.request.name)
        functions = []
        for function, request_names in requests_by_function.items():
            functions.append(f"{function} ({', '.join(request_names)})")
        if functions:
            yield (
                "Encode a request, call cw_rs485_ask in codewheel/receive.h with its first byte and the length of the"
                f" reply, and send the request. Then pass each byte received to {', or '.join(functions)}."
            )

    # -- constants

    def _define_macro(self, name: str, value: int, about: Statement | str, *, hexadecimal: bool = False) -> CMacro:
        """Return a macro of the interface, with a statement or a text as its comment."""
        note = about if isinstance(about, str) else HEADER_STYLE.sentence(about)
        return CMacro(f"{self._macro_prefix}_{name}".upper(), value=c_number(value, hexadecimal), note=note)

    def _macros_and_statements(self) -> Iterator[tuple[CMacro | None, Statement | None]]:
        """Yield the macros of the interface for clock, timeout, port, words and times.

        Each comes with the statement that is its comment, or None if its comment is another text. A statement without
        a macro is the comment on a function.
        """
        interface = self.interface
        for fact, statement in zip(interface.facts(), describe_settings(self.device, interface), strict=True):
            applies_to_some_codes = isinstance(fact, (Clock, Timeout)) and bool(fact.only)
            # Facts for some order codes have macros in ``CodeFacts``.
            if applies_to_some_codes:
                continue
            if isinstance(fact, CableLength) and self.clock_limits:
                yield None, statement
            for macro in self._macros_of_fact(fact, statement):
                yield macro, statement
        if isinstance(interface, Biss):
            yield from self._macros_of_control_data(interface)
        for time in interface.timings:
            if time.name not in repeated_names(interface.timings):
                for macro in timing_macros(time, self._macro_prefix):
                    yield macro, describe_timing(time)

    def _macros_of_fact(self, fact: Fact, statement: Statement) -> Iterator[CMacro]:
        """Yield the macros for a fact, such as the clock. The comment on the first one is the statement."""
        match fact:
            case Clock():
                yield from self._macros_of_clock(fact, statement)
            case Timeout():
                yield from self._macros_of_timeout(fact, statement)
            case Port():
                yield from self._macros_of_port(fact, statement)
            case WordFormat():
                yield from self._macros_of_words(fact, statement)
            case _:
                pass  # Code needs no number from it.

    def _macros_of_clock(self, clock: Clock, statement: Statement) -> Iterator[CMacro]:
        """Yield the limits of the clock, and the fastest clock in use. The first comment describes all of them."""
        for index, (name, clock_hz, note) in enumerate(clock_limits(clock)):
            yield self._define_macro(name, clock_hz, about=note if index else statement)

    def _macros_of_port(self, port: Port, statement: Statement) -> Iterator[CMacro]:
        """Yield the settings of a serial port. The first comment describes all of them."""
        yield self._define_macro("BAUD", port.baud, about=statement)
        yield self._define_macro("DATA_BITS", port.data_bits, about="number of data bits")
        yield CMacro(
            f"{self._macro_prefix}_PARITY", value=_PARITY_CHARACTERS[port.parity], note=f"parity: {port.parity}"
        )
        yield self._define_macro("STOP_BITS", port.stop_bits, about="number of stop bits")

    def _macros_of_words(self, words: WordFormat, statement: Statement) -> Iterator[CMacro]:
        """Yield the SPI mode, the length of a word if all have the same, and how many words later a reply comes."""
        yield self._define_macro("MODE", words.mode, about=statement)
        if len(words.lengths) == 1 and words.lengths[0].is_constant:
            yield self._define_macro("WORD_BITS", words.lengths[0].constant, about="number of bits of a word")
        # The reply comes with the word after the request, or with the same word.
        delay = 1 if words.reply == "next_word" else 0
        yield self._define_macro("REPLY_WORDS", delay, about="number of words from a request to its reply")

    def _macros_of_control_data(self, interface: Biss) -> Iterator[tuple[CMacro, Statement | None]]:
        """Yield the width of each field in the BiSS control data, with its statement, and its named values."""
        for field in interface.control_data:
            statement = describe_control_field(field)
            yield self._define_macro(f"CONTROL_{field.name}_BITS", field.bits, about=statement), statement
            for value in field.values:
                name = f"CONTROL_{field.name}_{value.name}"
                note = f"{title_of(field)}: {title_of(value)}"
                yield self._define_macro(name, value.value, about=note, hexadecimal=True), None

    def _macros_of_timeout(self, timeout: Timeout, statement: Statement) -> Iterator[CMacro]:
        """Yield the typical and the longest timeout. The first comment describes all of them.

        If the timeout is not a number of clock periods, the timeouts printed for each clock follow.
        """
        for index, (name, time_ns) in enumerate(timeout_limits(timeout)):
            yield self._define_macro(name, time_ns, about="see above" if index else statement)

    @property
    def position_request(self) -> str:
        """The macro of the first request for the position over SPI, or an empty string."""
        spi_exchanges = self.interface.exchanges if isinstance(self.interface, Spi) else ()
        for spi_exchange in spi_exchanges:
            if spi_exchange.purpose == "position":
                return f"{self._macro_prefix}_REQUEST_{spi_exchange.request}".upper()
        return ""

    def _requests_and_statements(self) -> Iterator[tuple[CMacro, Statement]]:
        """Yield the macros of requests, which are the control field over RS-485 and a number over SPI.

        Each comes with the statement that is its comment.
        """
        if isinstance(self.interface, Rs485):
            for data_id in self.interface.data_ids:
                statement = describe_data_id(data_id)
                name = f"CONTROL_{data_id.name}"
                yield self._define_macro(name, data_id.control, about=statement, hexadecimal=True), statement
        if isinstance(self.interface, Spi):
            # 0 means that there is no request.
            for request_number, spi_exchange in enumerate(self.interface.exchanges, 1):
                statement = describe_exchange(spi_exchange)
                yield self._define_macro(f"REQUEST_{spi_exchange.request}", request_number, about=statement), statement

    @property
    def controls_title(self) -> str:
        """Heading of the constants for requests."""
        if isinstance(self.interface, Rs485):
            return "requests: the first byte of each one and of its reply"
        return "requests, for codewheel/spi.h"


def _time_on_line_us(port: Port, number_of_bytes: int) -> int:
    """Return the time that these bytes take on a serial line, in microseconds, rounded up."""
    start_bit = 1
    parity_bits = 0 if port.parity == "none" else 1
    bits_per_byte = start_bit + port.data_bits + parity_bits + port.stop_bits
    bits = number_of_bytes * bits_per_byte
    # -(-a // b) rounds up.
    return -(-1_000_000 * bits // port.baud)


def _take_function(exchanged: RequestAndReply) -> str:
    """Return the function that receives a reply: one that begins like its request, or one with any first byte."""
    return "cw_rs485_take" if exchanged.repeats_first_byte else "cw_rs485_take_any"


def _member_names(layout: Layout) -> Iterator[str]:
    """Yield the names of the fields with data and of the joins."""
    yield from (field.name for field in layout.data_fields)
    yield from (join.name for join in layout.joins)
