"""The lengths of frames that come as bits, as constants by order code: array sizes and static asserts take them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Biss, Interface
from ...plan.received import BISS_ACKNOWLEDGE, Received, received
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
        self.held = any(item.held for item in found)
        #: How many bits of acknowledge a buffer has room for; 0 where there is none.
        self.acknowledge = BISS_ACKNOWLEDGE if isinstance(interface, Biss) else 0
        stems = {id(row.variant): row.macro for row in rows}
        self.macros = [macro for item in found for macro in self._macros(stems[id(item.variant)], item)]

    def declared(self) -> Iterator[Declared]:
        yield from ((item.name, ("interfaces", self.interface.name)) for item in self.macros)

    def _macros(self, code: str, item: Received) -> Iterator[Macro]:
        stem = f"{code}_{self.interface.name}" + (f"_{item.layout.name}" if len(self.layouts) > 1 else "")
        yield Macro(f"{stem}_BITS".upper(), number(item.bits))
        yield Macro(f"{stem}_RX_BYTES".upper(), number(item.bytes))
