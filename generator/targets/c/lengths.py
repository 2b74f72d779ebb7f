"""The lengths of frames on a line of bits, as constants by order code, for array sizes and static asserts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy

from ...model import Biss, Device, Interface, Layout
from ...plan.frames import BISS_ACKNOWLEDGE, FrameSize, received
from ...say.order_code import initial
from ...say.text import hertz, nanoseconds, timeout_words
from .context import Context
from .macros import Macro
from .names import Declared
from .types import number
from .variants import CodeRow


class LengthCode:
    """The lengths of one interface, empty if a peripheral receives its frames by itself."""

    def __init__(self, context: Context, interface: Interface, rows: Sequence[CodeRow], sample_row: CodeRow) -> None:
        self.interface = interface
        received_frames = list(received(context.device, interface))
        #: Names of the frames whose lengths these are.
        self.layouts = tuple(dict.fromkeys(frame.layout.name for frame in received_frames))
        #: Names of the answers on which a length depends.
        self.answers = tuple(dict.fromkeys(answer.name for frame in received_frames for answer in frame.answers))
        #: Macro of the bytes in a frame that is carried as bytes, empty for words.
        self.length = next(
            (context.length_macro(frame.layout) for frame in received_frames if frame.layout.in_bytes), ""
        )
        #: Names of the headers that receive words, bytes, or both.
        names = {True: "receive_frame.h", False: "receive.h"}
        kinds = sorted({frame.layout.in_bytes for frame in received_frames})
        self.receivers = " and ".join(names[in_bytes] for in_bytes in kinds)
        self._context = context
        self.depends_on_registers = any(frame.depends_on_registers for frame in received_frames)
        #: Number of acknowledge bits that fit in a buffer, 0 if the interface has none.
        self.acknowledge = BISS_ACKNOWLEDGE if isinstance(interface, Biss) else 0
        self.register_access = "".join(_register_access(context.device, interface, received_frames))
        self._codes = {id(row.variant): row.code for row in rows}
        self._prefix = f"{context.PREFIX}_"
        self._shown = next((frame for frame in received_frames if frame.variant is sample_row.variant), None)
        self.macros = [macro for frame in received_frames for macro in self.macros_of(frame)]

    @property
    def receive(self) -> str:
        """The macro that receives with the lengths of an order code, empty if there are several frames."""
        return f"{self._prefix}RECEIVE" if len(self.layouts) == 1 else ""

    @property
    def named(self) -> str:
        """Explain how the macro names an order code."""
        code = self.code_of(self._shown) if self._shown is not None else ""
        return f"For example, code can be {code}, as in {self._prefix}{code}_BITS."

    def for_layout(self, layout: Layout) -> LengthCode:
        """Return the same for one frame. Of an interface, some frames may be words, and others bytes."""
        of_layout = copy(self)
        of_layout.length = self._context.length_macro(layout) if layout.in_bytes else ""
        return of_layout

    def holder(self, index: str = "") -> str:
        """Declare the variable that receives a frame, or an array of them."""
        return f"uint8_t bytes{index}[{self.length}]" if self.length else f"uint64_t word{index}"

    def receiver_argument(self, index: str = "") -> str:
        """Return the last argument of a receiver that fills this variable."""
        return f"bytes{index}" if self.length else f"&word{index}"

    def decoder_arguments(self, index: str = "") -> str:
        """Return the arguments of a decoder that takes this variable."""
        return f"bytes{index}, {self.length}" if self.length else f"word{index}"

    def code_of(self, frame: FrameSize) -> str:
        """Return the name of an order code in names of lengths, with the answers on which these depend."""
        names = [frame.layout.name] if len(self.layouts) > 1 else []
        return "_".join((self._codes[id(frame.variant)], *names, *(answer.name for answer in frame.answers))).upper()

    def declared(self) -> Iterator[Declared]:
        names = (*(macro.name for macro in self.macros), self.receive)
        yield from ((name, ("interfaces", self.interface.name)) for name in names if name)

    def macros_of(self, frame: FrameSize) -> Iterator[Macro]:
        """Yield the macros of the number of bits and of the bytes of a buffer."""
        stem = f"{self._prefix}{self.code_of(frame)}"
        yield Macro(f"{stem}_BITS", number(frame.bits), "number of bits in its frame")
        yield Macro(f"{stem}_RX_BYTES", number(frame.bytes), "number of bytes in its buffer")


def _register_access(device: Device, interface: Interface, frames: Sequence[FrameSize]) -> Iterator[str]:
    """Yield the deadlines for the control bit of a master, with the numbers of the family, if the interface is BiSS."""
    if not isinstance(interface, Biss) or not frames:
        return
    bits, clock = min(frame.bits for frame in frames), interface.clock
    after = f"{bits} clock periods after its CDS"
    depends_on_registers = any(frame.depends_on_registers for frame in frames)
    after = f"{after} with {initial(device)}" if depends_on_registers else f"at least {after}"
    limits = [hz for hz in (clock.max_hz, clock.min_hz) if hz is not None]
    clocks = limits or [clock.fastest_hz]
    times = " and ".join(f"{nanoseconds(bits * 1_000_000_000 // hz)} at {hertz(hz)}" for hz in clocks)
    yield "For register access with codewheel/biss.h: the bit of cw_biss_master_next must be on MA before the last "
    yield f"clock of the same frame. It comes {after}: {times}. The bit of "
    yield "cw_biss_master_next_late, for SPI and DMA, is needed before the next frame begins, since the SPI mode "
    yield "sends it. MA carries the inverse of the bit for the whole time-out"
    if interface.timeout is not None:
        yield f" ({timeout_words(interface.timeout)})"
    yield "."
