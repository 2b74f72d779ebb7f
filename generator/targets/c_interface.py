"""One interface in C: its constants, what tells its frames apart, and the codecs of its layouts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from ..model import Erratum, Interface, Layout, Port, cite
from ..words import sentence
from . import TargetError
from .c_codec import codec
from .c_layout import LayoutSource
from .c_source import Paragraph, c_name, described, errata_at, errata_text, number, plain_expression, printed, words
from .c_views import CodecView, InterfaceView, Line, Selector

if TYPE_CHECKING:
    from .c_device import DeviceView


class InterfaceSource:
    def __init__(self, view: DeviceView, interface: Interface) -> None:
        self.view = view
        self.device = view.device
        self.interface = interface
        self.path = f"interfaces.{interface.kind}"
        self.prefix = f"{view.prefix}_{interface.kind}"
        self.upper = self.prefix.upper()
        self.frames = [layout for layout in interface.layouts if layout.selector]

    def build(self) -> InterfaceView:
        macros = [*self._macros(), *(line for timing in self.interface.timings for line in self.view.timing(timing, self.upper))]
        frame_names = {layout.name: self.view.unique(f"{self.upper}_FRAME_{layout.name.upper()}") for layout in self.frames}
        factor = self._timeout_factor()
        return InterfaceView(
            title=self.interface.title,
            about=tuple(item for item in self._about() if (item if isinstance(item, str) else item[1])),
            macros=tuple(macros),
            choices=self.view.choices_of_interface(self.interface),
            controls=tuple(self._controls()),
            frames=tuple(self._frame_lines(frame_names)),
            frame_type=self._frame_type(),
            frame_lengths=tuple((frame_names[layout.name], self._length_macro(layout)) for layout in self.frames),
            selectors=tuple(self._selector(sender, layouts, frame_names) for sender, layouts in self._by_sender()),
            cable=tuple((number(item.shorter_than_m), number(item.below_hz)) for item in sorted(self.interface.cable_lengths, key=lambda item: item.shorter_than_m)),
            cable_function=self.view.unique(f"{self.prefix}_clock_limit_hz") if self.interface.cable_lengths else "",
            cable_about=self._cable_about(),
            timeout_function=self.view.unique(f"{self.prefix}_timeout_ns") if factor else "",
            timeout_about=self._timeout_about(),
            timeout_numerator=number(factor) if factor <= 0xFFFFFFFF else f"UINT64_C({factor})",
            timeout_type="uint32_t" if factor <= 0xFFFFFFFF else "uint64_t",
            codecs=tuple(self._layout_codec(layout) for layout in self.interface.layouts),
        )

    # -- what is said

    def _errata(self) -> list[Erratum]:
        """The errata of the interface, but not those of its layouts, which stand there."""
        layouts = [f"{self.path}.{layout.name}" for layout in self.interface.layouts]
        below = [item for path in layouts for item in errata_at(self.device, path)]
        errata = [item for item in errata_at(self.device, self.path, layouts) if item not in below]
        groups = dict.fromkeys(field.group for layout in self.interface.layouts for field in layout.fields if field.group)
        errata += [item for group in groups for item in errata_at(self.device, f"field_groups.{group}")]
        return [item for index, item in enumerate(errata) if item not in errata[:index]]

    def _about(self) -> Iterable[Paragraph]:
        interface = self.interface
        yield sentence(interface.note)
        if interface.signals:
            yield sentence(f"Signals: {interface.signals}")
        if interface.alignment:
            aligned = {"msb_left": "to the left: the most significant bit comes with the first clock", "lsb_right": "to the right: zeros come before it"}
            yield f"The word is aligned {aligned[interface.alignment]} [{cite(interface.alignment_source)}]."
        if interface.output_code:
            yield f"Output code: {interface.output_code.replace('_', ' ')} [{cite(interface.output_code_source)}]."
        if interface.profile:
            yield sentence(f"Profile: {interface.profile}")
        if interface.network is not None:
            allowed = "several slaves may share the line" if interface.network.multiple_slaves else "never more than one slave"
            yield f"Network: {interface.network.topology.replace('_', ' ')}, {allowed} [{cite(interface.network.source)}]."
        if interface.memory_access:
            yield "Access to the memory, by the busy flag of the reply:"
            for row in interface.memory_access:
                yield (f"  {row.access}, busy {row.busy}: ", f"{sentence(row.meaning)} Address: {row.address}; data: {row.data} [{cite(row.source)}].")
        yield ("Control data: ", sentence(interface.control_data_note))
        yield from (errata_text(item) for item in self._errata())

    def _cable_about(self) -> tuple[Paragraph, ...]:
        lengths = self.interface.cable_lengths
        if not lengths:
            return ()
        where = cite(tuple(dict.fromkeys(source for item in lengths for source in item.source)))
        return (f"The frequency in hertz that the clock has to stay below with a cable of so many metres; 0 where the manual has none for so long a cable [{where}].",)

    def _timeout_factor(self) -> int:
        """The time-out in nanoseconds times the clock in hertz; 0 where it does not follow the clock."""
        timeout = self.interface.timeout
        return 500_000_000 * (timeout.half_clock_periods or 0) if timeout is not None and timeout.rule == "follows_clock" else 0

    def _timeout_about(self) -> tuple[Paragraph, ...]:
        timeout = self.interface.timeout
        if timeout is None or timeout.half_clock_periods is None:
            return ()
        printed = "; ".join(f"{item.timeout_ns} ns at {item.clock_hz} Hz" for item in timeout.printed)
        return (
            f"Time-out after a frame in nanoseconds, rounded up: {timeout.half_clock_periods} halves of a clock period [{cite(timeout.source)}]; 0 without a clock.",
            f"The manual's own values: {printed}." if printed else "",
        )

    # -- constants

    def _macros(self) -> Iterable[Line]:
        macro, interface = self.view.macro, self.interface
        if interface.clock_min_hz is not None and interface.clock_max_hz is not None:
            where = f"[{cite(interface.clock_source)}]"
            yield macro(f"{self.upper}_CLOCK_MIN_HZ", number(interface.clock_min_hz), f"lowest clock {where}")
            yield macro(f"{self.upper}_CLOCK_MAX_HZ", number(interface.clock_max_hz), f"highest clock {where}")
        timeout = interface.timeout
        if timeout is not None:
            for name, value in (("TYPICAL", timeout.typical_ns), ("AT_MOST", timeout.at_most_ns)):
                if value is not None:
                    yield macro(f"{self.upper}_TIMEOUT_{name}_NS", number(value), f"time-out after a frame [{cite(timeout.source)}]")
            if timeout.half_clock_periods is None:
                for item in timeout.printed:
                    name = f"{self.upper}_TIMEOUT_AT_{item.clock_hz}_HZ_NS"
                    yield macro(name, number(item.timeout_ns), f"time-out after a frame at that clock [{cite(timeout.source)}]")
        if interface.port is not None:
            yield from self._port(interface.port)
        yield from self._control_data()

    def _port(self, port: Port) -> Iterable[Line]:
        yield self.view.macro(f"{self.upper}_BAUD", number(port.baud), f"baud rate in bits per second [{cite(port.source)}]")
        yield self.view.macro(f"{self.upper}_DATA_BITS", number(port.data_bits), "data bits of a byte")
        letter = {"none": "'N'", "even": "'E'", "odd": "'O'"}[port.parity]
        yield self.view.macro(f"{self.upper}_PARITY", letter, f"parity: {port.parity}; flow control: {port.flow_control}")
        yield self.view.macro(f"{self.upper}_STOP_BITS", number(port.stop_bits), "stop bits")

    def _control_data(self) -> Iterable[Line]:
        for field in self.interface.control_data:
            stem = f"{self.upper}_CONTROL_{field.name.upper()}"
            about = described(printed(field), field.meaning)
            yield self.view.macro(f"{stem}_BITS", number(field.bits), f"{about} [{cite(field.source)}]" if field.source else about)
            for item in field.values:
                yield self.view.macro(f"{stem}_{item.name.upper()}", number(item.value, True), described(printed(item), item.meaning))

    def _controls(self) -> Iterable[Line]:
        for item in self.interface.data_ids:
            yield self.view.macro(f"{self.upper}_CONTROL_{item.name.upper()}", number(item.control, True), f"data ID {item.id:X}, {item.purpose} [{cite(item.source)}]")

    # -- frames

    def _frame_type(self) -> str:
        """The enumeration of the frames; a function that gives their length goes with it."""
        if not self.frames:
            return ""
        self.view.unique(f"{self.prefix}_frame_length")
        return self.view.unique(f"{self.prefix}_frame")

    def _frame_lines(self, names: Mapping[str, str]) -> Iterable[Line]:
        for index, layout in enumerate(self.frames):
            yield Line(f"{names[layout.name]} = {index}" + ("," if index < len(self.frames) - 1 else ""), layout.printed_name)

    def _by_sender(self) -> list[tuple[str, list[Layout]]]:
        senders = list(dict.fromkeys(layout.sender for layout in self.frames))
        return [(sender, [layout for layout in self.frames if layout.sender == sender]) for sender in senders]

    def _selector(self, sender: str, layouts: Sequence[Layout], names: Mapping[str, str]) -> Selector:
        kind = {"encoder": "reply", "master": "request"}[sender]
        field = layouts[0].field(layouts[0].selector)
        if any(layout.field(layout.selector).pieces != field.pieces for layout in layouts) or not field.pieces:
            raise TargetError(f"the {kind}s do not have '{field.name}' in one place; the C target cannot tell them apart")
        _, expression = LayoutSource(self.view, layouts[0], "", "").raw(field)
        choice = self.view.choices.get((layouts[0].name, field.name))
        known = choice.names if choice is not None else {}
        cases = tuple((tuple(known.get(value, number(value, True)) for value in layout.selects), names[layout.name]) for layout in layouts)
        needs = max(piece.byte for piece in field.pieces) + 1
        function, by_value = self.view.unique(f"{self.prefix}_{kind}_frame"), self.view.unique(f"{self.prefix}_{kind}_for")
        return Selector(function, by_value, c_name(field.name, ("frame",)), words(field.name), sender, cases, needs, expression)

    def _length_macro(self, layout: Layout) -> str:
        return f"{self.view.PREFIX}_{layout.name.upper()}_LENGTH"

    def _layout_codec(self, layout: Layout) -> CodecView:
        source = LayoutSource(self.view, layout, f"{self.view.prefix}_{layout.name}", self._length_macro(layout))
        by = {"encoder": "sent by the encoder", "master": "sent by the master"}[layout.sender]
        size = f"{plain_expression(layout.bits)} bits" if layout.carried_as == "bits" else f"{layout.widest // 8} byte{'s' if layout.widest > 8 else ''}"
        if layout.selects:
            size += f"; {words(layout.selector)} " + ", ".join(f"{value:X}" for value in layout.selects)
        name = words(layout.name)
        if layout.channel is not None:
            by += f" over data channel {layout.channel}"
        about: list[Paragraph] = [f"{name[0].upper() + name[1:]}, {by}: {size} [{cite(layout.source)}].", ("In the manual: ", sentence(layout.printed_name)), sentence(layout.note)]
        about += source.table()
        about += [errata_text(item) for item in errata_at(self.device, f"{self.path}.{layout.name}")]
        return codec(source, about)
