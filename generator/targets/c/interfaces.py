"""One interface in C: its constants, the functions that distinguish its frames, and the codecs of its layouts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from ...model import Biss, CableLength, Clock, Interface, Layout, Port, Rs485, Spi, Timeout, WordFormat, cite, first_of
from ...model.record import dataclass
from ...plan.frames import Branch, Dispatch, Exchanged, answer, dispatches, exchanges
from ...say.errata import errata, erratum
from ...say.names_and_places import title
from ...say.order_code import control_field, data_id, exchange, settings, timing
from ...say.order_code import interface as said_of
from ...say.text import Statement
from .about import about_layout
from .bits import of_bytes
from .codec import StructCodec
from .comments import Paragraph, S
from .context import Context, Macro, timing_macros
from .names import Declared, Expr, c_name, number
from .structs import Struct

_PARITIES = {"none": "'N'", "even": "'E'", "odd": "'O'"}
#: Time allowed for an encoder to answer a request, in microseconds, in examples.
ANSWER_US = 10_000
_KINDS = {"encoder": "reply", "master": "request"}


class FrameTeller:
    """The functions that distinguish the frames of one sender, by bytes and by the value of the selecting field."""

    def __init__(self, context: Context, prefix: str, dispatch: Dispatch) -> None:
        self.dispatch = dispatch
        self.by_bytes = f"{prefix}_{_KINDS[dispatch.sender]}_frame"
        self.by_value = f"{prefix}_{_KINDS[dispatch.sender]}_for"
        choice = context.choices.get((dispatch.branches[0].layout.name, dispatch.selector.name))
        self._names = choice.names if choice is not None else {}

    @property
    def value(self) -> Expr:
        """The selecting field, extracted from the bytes."""
        return of_bytes(self.dispatch.bits.pieces)[1]

    def values(self, branch: Branch) -> list[str]:
        """Return the values that select a frame."""
        return [self._names.get(value, number(value, hexadecimal=True)) for value in branch.values]


@dataclass(frozen=True, slots=True)
class ReplyRequest:
    """Request for a reply: its initial value, the function that receives the reply, and a time-out.

    ``repeated`` are the numbers that the reply repeats, such as an address. The time-out is the time that both take on
    the line, plus ``ANSWER_US`` until the encoder answers.
    """

    codec: StructCodec
    initial: str
    take: str
    late_us: int
    repeated: tuple[str, ...]


class InterfaceCode:
    """The values that the templates print for an interface. ``frames`` are those selected by a field."""

    def __init__(self, context: Context, interface: Interface) -> None:
        self.device, self.interface = context.device, interface
        self.prefix = context.prefix
        self.upper = self.prefix.upper()
        self.cable = [fact for fact in interface.facts() if isinstance(fact, CableLength)]
        self.timeout = interface.timeout if isinstance(interface, Biss) else None
        #: Statements that are comments on macros.
        self._macro_statements: list[Statement] = []
        self.macros = tuple(self._macros())
        self.controls = tuple(self._controls())
        self.about = list(self._about())
        self.enumerations = context.enumerations.of("interfaces", interface.name)
        self.tellers = tuple(FrameTeller(context, self.prefix, dispatch) for dispatch in dispatches(interface.layouts))
        self.codecs = tuple(self._codec(context, layout) for layout in interface.layouts)

    def declared(self) -> Iterator[Declared]:
        path = ("interfaces", self.interface.name)
        yield from ((macro.name, path) for macro in (*self.macros, *self.controls))
        yield from ((self.frame_name(layout), path) for layout in self.frames)
        if self.frames:
            yield from ((f"{self.prefix}_{name}", path) for name in ("frame", "frame_length"))
        yield from ((name, path) for teller in self.tellers for name in (teller.by_bytes, teller.by_value))
        if self.cable:
            yield f"{self.prefix}_clock_limit_hz", path
        if self.timeout_product:
            yield f"{self.prefix}_timeout_ns", path
        for codec in self.codecs:
            yield from codec.declared()

    @property
    def cable_source(self) -> str:
        """The source of the clocks by cable length."""
        return cite(tuple(dict.fromkeys(source for cable in self.cable for source in cable.source)))

    @property
    def frames(self) -> list[Layout]:
        names = {branch.layout.name for teller in self.tellers for branch in teller.dispatch.branches}
        names |= {teller.dispatch.fallback.name for teller in self.tellers if teller.dispatch.fallback is not None}
        return [layout for layout in self.interface.layouts if layout.name in names]

    def request_of(self, reply: Layout) -> str:
        """Return the macro of the request that a frame answers, or an empty text."""
        interface = self.interface
        if not isinstance(interface, Rs485):
            return ""
        for request in interface.data_ids:
            if answer(interface, request.id) is reply:
                return f"{self.upper}_CONTROL_{request.name}".upper()
        return ""

    def asking(self, reply: Layout, values: Mapping[str, int] = MappingProxyType({})) -> ReplyRequest | None:
        """Return the request whose reply is a frame in bytes, with the given numbers in its fields, or None."""
        matching = (exchanged for exchanged in exchanges(self.interface) if exchanged.reply is reply and reply.in_bytes)
        exchanged = next(matching, None)
        port = next((fact for fact in self.interface.facts() if isinstance(fact, Port)), None)
        if exchanged is None or port is None:
            return None
        candidates = (candidate for candidate in self.codecs if candidate.struct.layout is exchanged.request)
        codec = first_of(candidates, f"codec for '{exchanged.request.name}'")
        bits = 1 + port.data_bits + (port.parity != "none") + port.stop_bits
        size = (exchanged.request.widest + reply.widest) // 8
        variants = self.device.variants_over(self.interface.name)
        parameters = first_of(variants, f"order code with the interface '{self.interface.name}'").parameters
        initial = codec.struct.initial(parameters, values)
        answered = set(_member_names(reply))
        names = [name for name in _member_names(exchanged.request) if name in answered]
        # C does not compare texts by !=.
        repeated = tuple(c_name(name) for name in names if codec.struct.member_type(name) != "char")
        line_us = -(-1_000_000 * size * bits // port.baud)
        return ReplyRequest(
            codec=codec,
            initial=initial,
            take=_take_function(exchanged),
            late_us=ANSWER_US + line_us,
            repeated=repeated,
        )

    def frame_name(self, layout: Layout) -> str:
        return f"{self.upper}_FRAME_{layout.name}".upper()

    def _codec(self, context: Context, layout: Layout) -> StructCodec:
        # The functions of the only frame of an interface need no further name.
        alone = len(self.interface.layouts) == 1 and not self.tellers
        name = context.prefix if alone else f"{context.prefix}_{layout.name}"
        struct = Struct(context, layout, name, context.length_macro(layout))
        return StructCodec(struct, about_layout(self.device, self.interface, struct))

    def _about(self) -> Iterator[Paragraph]:
        """Yield the comment on the interface, without the layouts, which have their own."""
        interface = self.interface
        statements = said_of(self.device, interface)
        yield from (S.sentence(statement) for statement in statements if statement not in self._macro_statements)
        if any(layout.sender == "master" and layout.data_fields for layout in interface.layouts):
            yield "Set all members of a request, because those that an initial value leaves out are 0."
        yield from self._receiving()
        path = f"interfaces.{interface.name}"
        layouts = [f"{path}.{layout.name}" for layout in interface.layouts]
        fields = (field for layout in interface.layouts for field in layout.fields)
        groups = {f"field_groups.{field.group}" for field in fields if field.group}
        below = errata(self.device, *layouts)
        corrections = errata(self.device, path, *groups, without=layouts)
        yield from (S.sentence(erratum(correction)) for correction in corrections if correction not in below)

    def _receiving(self) -> Iterator[Paragraph]:
        """Yield how to send a request and receive its reply over a serial port."""
        requests: dict[str, list[str]] = {}
        for exchanged in exchanges(self.interface):
            if exchanged.reply is not None and exchanged.reply.in_bytes:
                requests.setdefault(_take_function(exchanged), []).append(exchanged.request.name)
        if requests:
            takes = ", or ".join(f"{name} ({', '.join(names)})" for name, names in requests.items())
            yield (
                "Encode a request, call cw_rs485_ask in codewheel/receive.h with its first byte and the length of the"
                f" reply, and send the request. Then pass each byte received to {takes}."
            )

    # -- constants

    @property
    def timeout_product(self) -> int:
        """The time-out in nanoseconds times the clock in hertz, 0 if it does not depend on the clock."""
        timeout = self.timeout
        if timeout is None or timeout.rule != "follows_clock":
            return 0
        return 500_000_000 * (timeout.half_clock_periods or 0)

    def _macro(self, name: str, value: int, about: Statement | str = "", hexadecimal: bool = False) -> Macro:
        if isinstance(about, Statement):
            self._macro_statements.append(about)
        note = about if isinstance(about, str) else S.sentence(about)
        return Macro(f"{self.upper}_{name}".upper(), number(value, hexadecimal), note)

    def _macros(self) -> Iterator[Macro]:
        interface = self.interface
        for fact, about in zip(interface.facts(), settings(self.device, interface), strict=True):
            match fact:
                case Clock():
                    yield from self._clock(fact, about)
                case CableLength():
                    self._macro_statements.append(about)  # A function states it.
                case Timeout():
                    yield from self._timeout(fact, about)
                case Port():
                    yield from self._port(fact, about)
                case WordFormat():
                    yield self._macro("MODE", fact.mode, about)
                    if len(fact.lengths) == 1 and fact.lengths[0].is_constant:
                        yield self._macro("WORD_BITS", fact.lengths[0].constant, "number of bits of a word")
                    late = int(fact.reply == "next_word")
                    yield self._macro("REPLY_WORDS", late, "number of words from a request to its reply")
                case _:
                    pass  # Code needs no number from it.
        if isinstance(interface, Biss):
            yield from self._control_data(interface)
        for time in interface.timings:
            self._macro_statements.append(timing(time))
            yield from timing_macros(time, self.upper)

    def _clock(self, clock: Clock, about: Statement) -> Iterator[Macro]:
        """Yield the limits, and the fastest clock in use. The first macro has the comment on all of them."""
        numbers = (
            ("MIN", clock.min_hz, "lowest clock in Hz"),
            ("MAX", clock.max_hz, "highest clock in Hz"),
            ("USED", max(clock.used_hz, default=None), "a clock in use in Hz, not a limit"),
        )
        stated = [(name, hz, note) for name, hz, note in numbers if hz is not None]
        for index, (name, hz, note) in enumerate(stated):
            yield self._macro(f"CLOCK_{name}_HZ", hz, note if index else about)

    def _port(self, port: Port, about: Statement) -> Iterator[Macro]:
        yield self._macro("BAUD", port.baud, about)
        yield self._macro("DATA_BITS", port.data_bits, "number of data bits")
        yield Macro(f"{self.upper}_PARITY", _PARITIES[port.parity], f"parity: {port.parity}")
        yield self._macro("STOP_BITS", port.stop_bits, "number of stop bits")

    def _control_data(self, interface: Biss) -> Iterator[Macro]:
        for field in interface.control_data:
            yield self._macro(f"CONTROL_{field.name}_BITS", field.bits, control_field(field))
            for value in field.values:
                name = f"CONTROL_{field.name}_{value.name}"
                yield self._macro(name, value.value, f"{title(field)}: {title(value)}", hexadecimal=True)

    def _timeout(self, timeout: Timeout, about: Statement) -> Iterator[Macro]:
        numbers = [("TYPICAL", timeout.typical_ns), ("AT_MOST", timeout.at_most_ns)]
        if timeout.half_clock_periods is None:
            numbers += [(f"AT_{printed.clock_hz}_HZ", printed.timeout_ns) for printed in timeout.printed]
        for name, value in numbers:
            if value is not None:
                yield self._macro(
                    f"TIMEOUT_{name}_NS", value, about if about not in self._macro_statements else "see above"
                )

    @property
    def exchanged(self) -> str:
        """Macro of the request for the position over SPI, or an empty text."""
        exchanges = self.interface.exchanges if isinstance(self.interface, Spi) else ()
        requests = (exchange.request for exchange in exchanges if exchange.purpose == "position")
        request = next(requests, None)
        return f"{self.upper}_REQUEST_{request}".upper() if request is not None else ""

    def _controls(self) -> Iterator[Macro]:
        if isinstance(self.interface, Rs485):
            for rs485_id in self.interface.data_ids:
                yield self._macro(f"CONTROL_{rs485_id.name}", rs485_id.control, data_id(rs485_id), hexadecimal=True)
        if isinstance(self.interface, Spi):
            # 0 means that there is none.
            for request_number, spi_exchange in enumerate(self.interface.exchanges, 1):
                yield self._macro(f"REQUEST_{spi_exchange.request}", request_number, exchange(spi_exchange))

    @property
    def controls_title(self) -> str:
        """Heading of the constants for requests."""
        first = "requests: the first byte of each one and of its reply"
        return first if isinstance(self.interface, Rs485) else "requests, for codewheel/spi.h"


def _take_function(exchanged: Exchanged) -> str:
    """Return the function that receives a reply."""
    return "cw_rs485_take" if exchanged.repeats_first else "cw_rs485_take_any"


def _member_names(layout: Layout) -> Iterator[str]:
    """Yield the names of the fields with data and of the joins."""
    yield from (field.name for field in layout.data_fields)
    yield from (join.name for join in layout.joins)
