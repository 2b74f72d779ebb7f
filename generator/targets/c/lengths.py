"""The lengths of frames carried as bits, as constants by order code, for array sizes and static asserts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Biss, Interface
from ...plan.receive_lengths import BISS_ACKNOWLEDGE, Received, received
from ...say.words import hertz, nanoseconds, timeout_words
from .context import Context
from .macros import Macro
from .names import Declared
from .types import number
from .variants import CodeRow


class LengthCode:
    """The lengths of one interface, empty if none of its frames is carried as bits."""

    def __init__(self, context: Context, interface: Interface, rows: Sequence[CodeRow]) -> None:
        self.interface = interface
        found = list(received(context.device, interface))
        #: Names of the frames whose lengths these are.
        self.layouts = tuple(dict.fromkeys(item.layout.name for item in found))
        #: Names of the answers on which a length depends.
        self.answers = tuple(dict.fromkeys(answer.name for item in found for answer in item.answers))
        self.held = any(item.held for item in found)
        #: Number of acknowledge bits that fit in a buffer, 0 if the interface has none.
        self.acknowledge = BISS_ACKNOWLEDGE if isinstance(interface, Biss) else 0
        self.register_access = "".join(_register_access(interface, found))
        self._stems = {id(row.variant): row.macro for row in rows}
        self._prefix = f"{context.PREFIX}_"
        self.macros = [macro for item in found for macro in self.macros_of(item)]

    @property
    def receive(self) -> str:
        """The macro that receives with the lengths of an order code, empty if there are several frames."""
        return f"{self._prefix}RECEIVE" if len(self.layouts) == 1 else ""

    @property
    def named(self) -> str:
        """Say how the macro names an order code."""
        code = self.macros[0].name.removeprefix(self._prefix).removesuffix("_BITS")
        return f"For code, write {code} for example, as in {self.macros[0].name}."

    def declared(self) -> Iterator[Declared]:
        names = (*(item.name for item in self.macros), self.receive)
        yield from ((name, ("interfaces", self.interface.name)) for name in names if name)

    def macros_of(self, item: Received) -> Iterator[Macro]:
        """Yield the macros of the number of bits and of the bytes of a buffer."""
        names = [item.layout.name] if len(self.layouts) > 1 else []
        names += [answer.name for answer in item.answers]
        stem = "_".join((self._stems[id(item.variant)], *names))
        yield Macro(f"{stem}_BITS".upper(), number(item.bits), "bits of its frame")
        yield Macro(f"{stem}_RX_BYTES".upper(), number(item.bytes), "bytes of its buffer")


def _register_access(interface: Interface, found: Sequence[Received]) -> Iterator[str]:
    """Yield the deadlines for the control bit of a master, with the numbers of the family, if the interface is BiSS."""
    if not isinstance(interface, Biss) or not found:
        return
    bits, clock = min(item.bits for item in found), interface.clock
    least = "with factory defaults" if any(item.held for item in found) else "at least"
    times = " and ".join(
        f"{nanoseconds(bits * 1_000_000_000 // hz)} at {hertz(hz)}" for hz in (clock.max_hz, clock.min_hz)
    )
    yield "For register access with codewheel/biss.h: the bit of cw_biss_master_next must be on MA before the last "
    yield f"clock of the same frame, {least} {bits} clock periods after its CDS: {times}. The bit of "
    yield "cw_biss_master_next_late, for SPI and DMA, is needed before the next frame begins, since the SPI mode "
    yield "sends it. MA carries the inverse of the bit for the whole time-out"
    if interface.timeout is not None:
        yield f" ({timeout_words(interface.timeout)})"
    yield "."
