"""One interface in C: its constants, the functions that distinguish its frames, and the codecs of its layouts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from ...model import Biss, CableLength, Clock, Interface, Layout, Port, Rs485, Spi, Timeout, WordFormat, cite
from ...model.record import dataclass
from ...plan.frames import Branch, Dispatch, dispatches
from ...plan.replies import Exchanged, answer, exchanges
from ...say.erratum import errata, erratum
from ...say.interface import control_field, data_id, exchange, settings
from ...say.interface import interface as said_of
from ...say.name import title
from ...say.text import Said
from ...say.timing import timing
from .about import about_layout
from .bits import of_bytes
from .codec import StructCodec
from .comments import Paragraph
from .context import Context
from .expr import Expr
from .macros import Macro, timing_macros
from .names import Declared
from .reserved import c_name
from .structs import Struct
from .style import S
from .types import number

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
class Asking:
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
        self.cable = [item for item in interface.facts() if isinstance(item, CableLength)]
        self.timeout = interface.timeout if isinstance(interface, Biss) else None
        #: Statements that are comments on macros.
        self._said: list[Said] = []
        self.macros = tuple(self._macros())
        self.controls = tuple(self._controls())
        self.about = list(self._about())
        self.enumerations = context.enumerations.of("interfaces", interface.name)
        self.tellers = tuple(FrameTeller(context, self.prefix, item) for item in dispatches(interface.layouts))
        self.codecs = tuple(self._codec(context, item) for item in interface.layouts)

    def declared(self) -> Iterator[Declared]:
        path = ("interfaces", self.interface.name)
        yield from ((item.name, path) for item in (*self.macros, *self.controls))
        yield from ((self.frame_name(item), path) for item in self.frames)
        if self.frames:
            yield from ((f"{self.prefix}_{name}", path) for name in ("frame", "frame_length"))
        yield from ((name, path) for item in self.tellers for name in (item.by_bytes, item.by_value))
        if self.cable:
            yield f"{self.prefix}_clock_limit_hz", path
        if self.timeout_product:
            yield f"{self.prefix}_timeout_ns", path
        for codec in self.codecs:
            yield from codec.declared()

    @property
    def cable_source(self) -> str:
        """The source of the clocks by cable length."""
        return cite(tuple(dict.fromkeys(source for item in self.cable for source in item.source)))

    @property
    def frames(self) -> list[Layout]:
        told = {branch.layout.name for item in self.tellers for branch in item.dispatch.branches}
        told |= {item.dispatch.fallback.name for item in self.tellers if item.dispatch.fallback is not None}
        return [item for item in self.interface.layouts if item.name in told]

    def request_of(self, reply: Layout) -> str:
        """Return the macro of the request that a frame answers, or an empty text."""
        of = self.interface
        if not isinstance(of, Rs485):
            return ""
        names = (f"{self.upper}_CONTROL_{item.name}" for item in of.data_ids if answer(of, item.id) is reply)
        return next(names, "").upper()

    def asking(self, reply: Layout, given: Mapping[str, int] = MappingProxyType({})) -> Asking | None:
        """Return the request whose reply is a frame in bytes, with the given numbers in its fields, or None."""
        found = (item for item in exchanges(self.interface) if item.reply is reply and reply.in_bytes)
        item = next(found, None)
        port = next((fact for fact in self.interface.facts() if isinstance(fact, Port)), None)
        if item is None or port is None:
            return None
        codec = next(one for one in self.codecs if one.struct.layout is item.request)
        bits = 1 + port.data_bits + (port.parity != "none") + port.stop_bits
        size = (item.request.widest + reply.widest) // 8
        parameters = next(one.parameters for one in self.device.variants_over(self.interface.name))
        initial = codec.struct.initial(parameters, given)
        answered = set(_members(reply))
        names = [name for name in _members(item.request) if name in answered]
        # C does not compare texts by !=.
        repeated = tuple(c_name(name) for name in names if codec.struct.member_type(name) != "char")
        return Asking(codec, initial, _take(item), ANSWER_US - -1_000_000 * size * bits // port.baud, repeated)

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
        yield from (S.sentence(item) for item in said_of(self.device, interface) if item not in self._said)
        if any(item.sender == "master" and item.data_fields for item in interface.layouts):
            yield "Set all members of a request, because those that an initial value leaves out are 0."
        yield from self._receiving()
        path = f"interfaces.{interface.name}"
        layouts = [f"{path}.{item.name}" for item in interface.layouts]
        groups = {f"field_groups.{field.group}" for item in interface.layouts for field in item.fields if field.group}
        below = errata(self.device, *layouts)
        found = errata(self.device, path, *groups, without=layouts)
        yield from (S.sentence(erratum(item)) for item in found if item not in below)

    def _receiving(self) -> Iterator[Paragraph]:
        """Yield how to send a request and receive its reply over a serial port."""
        found = [item for item in exchanges(self.interface) if item.reply is not None and item.reply.in_bytes]
        takes = {_take(item): [one.request.name for one in found if _take(one) == _take(item)] for item in found}
        if takes:
            yield (
                "Encode a request, call cw_rs485_ask in codewheel/receive.h with its first byte and the length of the"
                " reply, and send the request. Then pass each byte received to "
                + ", or ".join(f"{name} ({', '.join(requests)})" for name, requests in takes.items())
                + "."
            )

    # -- constants

    @property
    def timeout_product(self) -> int:
        """The time-out in nanoseconds times the clock in hertz, 0 if it does not depend on the clock."""
        timeout = self.timeout
        if timeout is None or timeout.rule != "follows_clock":
            return 0
        return 500_000_000 * (timeout.half_clock_periods or 0)

    def _macro(self, name: str, value: int, about: Said | str = "", hexadecimal: bool = False) -> Macro:
        if isinstance(about, Said):
            self._said.append(about)
        note = about if isinstance(about, str) else S.sentence(about)
        return Macro(f"{self.upper}_{name}".upper(), number(value, hexadecimal), note)

    def _macros(self) -> Iterator[Macro]:
        interface = self.interface
        for fact, about in zip(interface.facts(), settings(self.device, interface), strict=True):
            match fact:
                case Clock():
                    yield from self._clock(fact, about)
                case CableLength():
                    self._said.append(about)  # A function states it.
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
        for item in interface.timings:
            self._said.append(timing(item))
            yield from timing_macros(item, self.upper)

    def _clock(self, clock: Clock, about: Said) -> Iterator[Macro]:
        """Yield the limits, and the fastest clock in use. The first macro has the comment on all of them."""
        numbers = (
            ("MIN", clock.min_hz, "lowest clock in Hz"),
            ("MAX", clock.max_hz, "highest clock in Hz"),
            ("USED", max(clock.used_hz, default=None), "a clock in use in Hz, not a limit"),
        )
        known = [(name, hz, note) for name, hz, note in numbers if hz is not None]
        for index, (name, hz, note) in enumerate(known):
            yield self._macro(f"CLOCK_{name}_HZ", hz, note if index else about)

    def _port(self, port: Port, about: Said) -> Iterator[Macro]:
        yield self._macro("BAUD", port.baud, about)
        yield self._macro("DATA_BITS", port.data_bits, "number of data bits")
        yield Macro(f"{self.upper}_PARITY", _PARITIES[port.parity], f"parity: {port.parity}")
        yield self._macro("STOP_BITS", port.stop_bits, "number of stop bits")

    def _control_data(self, interface: Biss) -> Iterator[Macro]:
        for field in interface.control_data:
            yield self._macro(f"CONTROL_{field.name}_BITS", field.bits, control_field(field))
            for item in field.values:
                name = f"CONTROL_{field.name}_{item.name}"
                yield self._macro(name, item.value, f"{title(field)}: {title(item)}", hexadecimal=True)

    def _timeout(self, timeout: Timeout, about: Said) -> Iterator[Macro]:
        numbers = [("TYPICAL", timeout.typical_ns), ("AT_MOST", timeout.at_most_ns)]
        if timeout.half_clock_periods is None:
            numbers += [(f"AT_{item.clock_hz}_HZ", item.timeout_ns) for item in timeout.printed]
        for name, value in numbers:
            if value is not None:
                yield self._macro(f"TIMEOUT_{name}_NS", value, about if about not in self._said else "see above")

    @property
    def exchanged(self) -> str:
        """Macro of the request for the position over SPI, or an empty text."""
        found = self.interface.exchanges if isinstance(self.interface, Spi) else ()
        asked = (f"{self.upper}_REQUEST_{item.request}".upper() for item in found if item.purpose == "position")
        return next(asked, "")

    def _controls(self) -> Iterator[Macro]:
        for item in self.interface.data_ids if isinstance(self.interface, Rs485) else ():
            yield self._macro(f"CONTROL_{item.name}", item.control, data_id(item), hexadecimal=True)
        # 0 means that there is none.
        for number_, each in enumerate(self.interface.exchanges if isinstance(self.interface, Spi) else (), 1):
            yield self._macro(f"REQUEST_{each.request}", number_, exchange(each))

    @property
    def controls_title(self) -> str:
        """Heading of the constants for requests."""
        first = "requests: the first byte of each one and of its reply"
        return first if isinstance(self.interface, Rs485) else "requests, for codewheel/spi.h"


def _take(item: Exchanged) -> str:
    """Return the function that receives a reply."""
    return "cw_rs485_take" if item.repeats_first else "cw_rs485_take_any"


def _members(layout: Layout) -> Iterator[str]:
    """Yield the names of the fields with data and of the joins."""
    yield from (item.name for item in layout.data_fields)
    yield from (item.name for item in layout.joins)
