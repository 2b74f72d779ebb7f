"""The lengths of frames that come as bits, as constants by order code: array sizes and static asserts take them."""

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
    """What the template prints of one interface; nothing where none of its frames comes as bits."""

    def __init__(self, context: Context, interface: Interface, rows: Sequence[CodeRow]) -> None:
        self.interface = interface
        found = list(received(context.device, interface))
        #: The frames that the constants are about.
        self.layouts = tuple(dict.fromkeys(item.layout.name for item in found))
        #: The answers of the user on which a length depends.
        self.answers = tuple(dict.fromkeys(answer.name for item in found for answer in item.answers))
        self.held = any(item.held for item in found)
        #: How many bits of acknowledge a buffer has room for; 0 where there is none.
        self.acknowledge = BISS_ACKNOWLEDGE if isinstance(interface, Biss) else 0
        self.register_access = "".join(_register_access(context.maker.name, interface, found))
        self._stems = {id(row.variant): row.macro for row in rows}
        self.macros = [macro for item in found for macro in self.macros_of(item)]

    def declared(self) -> Iterator[Declared]:
        yield from ((item.name, ("interfaces", self.interface.name)) for item in self.macros)

    def macros_of(self, item: Received) -> Iterator[Macro]:
        """How many bits come, and how many bytes they fill."""
        names = [item.layout.name] if len(self.layouts) > 1 else []
        names += [answer.name for answer in item.answers]
        stem = "_".join((self._stems[id(item.variant)], self.interface.name, *names))
        yield Macro(f"{stem}_BITS".upper(), number(item.bits))
        yield Macro(f"{stem}_RX_BYTES".upper(), number(item.bytes))


def _register_access(maker: str, interface: Interface, found: Sequence[Received]) -> Iterator[str]:
    """By when a master has to know its control bit, in the family's own numbers; nothing over another interface."""
    if not isinstance(interface, Biss) or not found:
        return
    bits, clock = min(item.bits for item in found), interface.clock
    least = "as delivered" if any(item.held for item in found) else "or more"
    times = " and ".join(
        f"{nanoseconds(bits * 1_000_000_000 // hz)} at {hertz(hz)}" for hz in (clock.max_hz, clock.min_hz)
    )
    yield f"Registers, by {maker}/biss.h: the bit of {maker}_biss_master_next has to be on MA before the last clock of "
    yield f"the frame whose CDS it follows, {bits} clock periods after that {least}: {times}. The bit of "
    yield f"{maker}_biss_master_next_late, for SPI and DMA, is needed before the next frame begins, as the mode of the "
    yield "SPI sets it. MA shows the inverse of either for the whole time-out"
    if interface.timeout is not None:
        yield f" ({timeout_words(interface.timeout)})"
    yield "."
