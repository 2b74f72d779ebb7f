"""The values that the templates of an interface of a family print."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property, partial
from itertools import chain
from typing import Protocol, TypeVar

from ...model import Device, Layout, Ssi
from ...model.record import dataclass
from ...order_codes.narrowing import for_codes
from ...plan.crcs import crc_functions
from ...plan.run_time_parameters import held_parameters
from ...plan.values import TwosComplement
from ...say.erratum import errata, erratum
from ...say.evidence import grade
from ...say.origin import origin, other_editions, taken_away
from ...say.parameter import initial
from .. import TargetError
from .access import state_registers
from .chosen import chosen_variant
from .codec import StructCodec
from .comments import Paragraph
from .context import Context
from .crcs import crc_code
from .facts import AlarmCode
from .identity import identity_codes
from .interfaces import Asking, InterfaceCode
from .lengths import LengthCode
from .macros import timing_macros
from .names import Declared, Names
from .positions import positions
from .procedures import ProcedureCode
from .registers import RegisterCode
from .reserved import c_name
from .run_time import Taker
from .style import S
from .variants import VariantCode

_Built = TypeVar("_Built")


class _Declaring(Protocol):
    def declared(self) -> Iterator[Declared]: ...


@dataclass(frozen=True, slots=True)
class Usage:
    """The names for reading a position: the frame, its verdict function, the member, and the request for the frame.

    The request is a macro, or a frame of its own, ``asking``. ``twice`` is true if no CRC protects the frame, so that
    two frames must agree.
    """

    frame: StructCodec
    verdict: str
    member: str
    request: str
    asking: Asking | None
    twice: bool


@dataclass(frozen=True, slots=True)
class Part:
    """A header that only some users of an interface need. ``includes`` lists the headers that it needs itself."""

    name: str
    file: str
    about: str
    includes: tuple[str, ...]


class DeviceView:
    """One interface of a family: the parts of its headers, each built from the ones before it.

    ``device`` has only this interface, and only its order codes.
    """

    def __init__(self, device: Device) -> None:
        self.device = device
        self.context = context = Context(device)
        self.maker, self.prefix, self.PREFIX, self.stem = context.maker, context.prefix, context.PREFIX, context.stem
        self.reports, self.alternatives = context.reports, context.alternatives
        self.variants = VariantCode(context)
        self.interface = _at(partial(InterfaceCode, context, context.interface), "interfaces", context.interface.name)
        #: The order code in all samples.
        self.row = self.variants.rows[device.variants.index(chosen_variant(device, context.interface))]
        self.lengths = LengthCode(context, context.interface, self.variants.rows, self.row)
        self.positions = positions(context)
        # A register that selects banks comes first: the functions of the registers in its banks use its address.
        selecting = {device.bank_selector(item) for item in device.registers}
        self.registers = [
            _at(partial(RegisterCode, context, item), "registers", item.name)
            for item in sorted(device.registers, key=lambda item: item.name not in selecting)
        ]
        framed = [*self.interface.codecs, *(item.codec for item in self.registers if item.codec is not None)]
        made = (crc_code(context, item, framed) for item in crc_functions(device))
        self.crcs = [item for item in made if item.is_called or item.table]
        codes = {item.register.name: item for item in self.registers}
        self.takers = [Taker(context, item, codes[item.register.name].access) for item in held_parameters(device)]
        self.initial = initial(device)
        self.read_state = f"{self.prefix}_read_state" if state_registers(device) else ""
        self.identities = list(identity_codes(context, codes))
        self.procedures = [
            _at(partial(ProcedureCode, context, codes, self.read_state, item), "procedures", item.name)
            for item in device.procedures
        ]
        self.alarms = [AlarmCode(context, item) for item in device.alarms]
        self.timings = [macro for item in device.timings for macro in timing_macros(item, self.PREFIX)]

    @property
    def header(self) -> str:
        """Include path of the header for reading positions."""
        return f"{self.maker.name}/{self.stem}.h"

    @property
    def parts(self) -> list[Part]:
        """The other headers. Each includes the first one, and what else it needs."""
        own, codes, steps = self.header, "codewheel/encoder.h", "codewheel/transport.h"
        texts = self.reports.all or self.alarms or self.timings
        labels = (f"{self.maker.name}/{self.stem}_labels.h",) if self.identities else ()
        registers = f"{self.maker.name}/{self.stem}_registers.h" if self.registers else own
        found = (
            ("labels", "find the order code that a label shows", True, (codes, own)),
            ("reports", "texts that describe reports, alarms and times", texts, (codes, own)),
            ("registers", "registers, and identification of encoders", self.registers, (codes, steps, own, *labels)),
            ("procedures", "procedures, step by step", self.procedures, (steps, registers)),
            ("simulate", "the encoder's side, for simulators and tests", True, (own,)),
        )
        return [Part(name, f"{self.stem}_{name}.h", about, used) for name, about, here, used in found if here]

    @property
    def headers(self) -> list[str]:
        """Include paths of all headers of the interface."""
        return [self.header, *(f"{self.maker.name}/{item.file}" for item in self.parts)]

    @property
    def cpp_header(self) -> str:
        """The header for C++17."""
        return f"{self.header}pp"

    @property
    def space(self) -> str:
        """The namespace of the functions for C++17."""
        return f"{c_name(self.maker.name)}::{c_name(self.stem)}"

    @cached_property
    def names(self) -> Names:
        return Names(self._declared())

    def _declared(self) -> Iterator[Declared]:
        yield from ((f"{self.PREFIX}_{ending}", ()) for ending in ("H", "HPP"))
        yield from ((f"{self.PREFIX}_{item.name}_H".upper(), ()) for item in self.parts)
        yield f"{self.PREFIX}_VERSION", ()
        if self.read_state:
            yield self.read_state, ()
        parts: Iterator[_Declaring] = chain(
            [self.variants],
            self.context.enumerations.all,
            self.crcs,
            [self.reports],
            self.alternatives,
            [self.interface, self.lengths],
            [self.positions] if self.positions is not None else (),
            self.registers,
            self.takers,
            self.identities,
            self.procedures,
            self.alarms,
        )
        for part in parts:
            yield from part.declared()
        for item in self.device.timings:
            yield from ((macro.name, ("timings", item.name)) for macro in timing_macros(item, self.PREFIX))

    @property
    def measured(self) -> str:
        """The field or join with the position, in the only frame of the interface. Empty if there is none."""
        codecs = self.interface.codecs
        return codecs[0].measured if len(codecs) == 1 else ""

    @property
    def manual(self) -> str:
        manual = self.device.manual
        editions = ", ".join(f"{item.language} {item.revision}" for item in manual.editions)
        dated = f" of {manual.date}" if manual.date else ""
        beside = f", compared with: {editions}" if editions else ""
        return f'"{manual.title}", revision {manual.revision}{dated} ({manual.language}{beside})'

    @property
    def evidence(self) -> list[Paragraph]:
        """Grade of the evidence."""
        return [S.sentence(grade(self.device))]

    @property
    def origin(self) -> list[Paragraph]:
        """Statements about the family that are not in its manual. Most families have none."""
        return [
            S.sentence(item) for item in (*origin(self.device), *other_editions(self.device), *taken_away(self.device))
        ]

    def documents(self, text: str) -> list[Paragraph]:
        """Return the other documents that ``text`` cites."""
        return [
            (f"  {item.key}: ", f"{item.title}{' - ' + item.url if item.url else ''}")
            for item in self.device.documents
            # The first test is much faster, and few documents pass it.
            if f"{item.key}:" in text and re.search(rf"\b{item.key}:", text)
        ]

    def modulus(self, encoder: str, layout: Layout | None = None) -> str:
        """Return the counts after which the position in a frame wraps around, as C, 0 if it does not or may not.

        Without a frame, it is that of the only one of the interface.
        """
        ranges = self.positions.ranges if self.positions is not None else ()
        name = layout.name if layout is not None else ""
        frames = [item for item in ranges if not name or name in {each.name for each in item.layouts}]
        wrapping = [item for item in frames if not item.never_wraps]
        return f"{self.prefix}_{wrapping[0].scope}modulus({encoder})" if wrapping else "0U"

    @property
    def usage(self) -> Usage | None:
        """The example at the top of the header, None if no frame has a verdict and a position."""
        measurement = self.device.measurement_of(self.context.interface.name)
        for item in self.interface.codecs if measurement is not None else ():
            layout = item.struct.layout
            told = item.reports.verdict if item.reports is not None else ""
            if told and measurement and measurement.of in layout.member_names and layout.sender == "encoder":
                twice = bool(item.measured) and isinstance(self.context.interface, Ssi) and not item.plan.crc
                of = [part.meaning for part in item.plan.parts if part.field.name == measurement.of]
                signed = any(isinstance(meaning, TwosComplement) for meaning in of)
                request, asking = self.interface.request_of(layout), self.interface.asking(layout)
                return Usage(item, told, c_name(measurement.of), request, asking, twice and not signed)
        return None

    def errata(self, *paths: str) -> list[Paragraph]:
        return [S.sentence(erratum(item)) for item in errata(self.device, *paths)]


def views_of(device: Device) -> Sequence[DeviceView]:
    """Return the interfaces of a family, in the order of the spec. The last families are remembered.

    Raises:
        TargetError: C cannot express an interface.
    """
    found = next((views for known, views in _LATEST if known is device), None)
    if found is None:
        found = tuple(_views_of(device))
        _LATEST.append((device, found))
    return found


#: Families are compared by identity, because comparing their members takes longer than making their views.
_LATEST: deque[tuple[Device, Sequence[DeviceView]]] = deque(maxlen=8)


def _views_of(device: Device) -> Iterator[DeviceView]:
    for interface in device.interfaces:
        here = for_codes(device, {item.code for item in device.variants_over(interface.name)})
        # A register that only another interface reaches cannot update a parameter.
        known = {"", *(item.name for item in here.registers)}
        parameters = (item if item.register in known else replace(item, read_from="") for item in here.parameters)
        yield DeviceView(replace(here, parameters=tuple(parameters)))


def _at(build: Callable[[], _Built], *path: str) -> _Built:
    """Return the result of ``build``. An error from it names this part of the spec."""
    try:
        return build()
    except TargetError as error:
        error.place = error.place or path
        raise
