"""The values that the template of a device prints."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import chain
from typing import TypeVar

from ...model import Biss, Device
from ...plan.crcs import crc_functions
from ...plan.run_time_parameters import held_parameters
from ...say.erratum import errata, erratum
from ...say.origin import origin, other_editions, taken_away
from ...say.text import BY_TITLE
from .. import TargetError
from .about import about_input
from .access import state_registers
from .alternatives import AlternativeCode
from .comments import Paragraph
from .context import Context
from .crcs import crc_code
from .facts import AlarmCode
from .identity import identity_codes
from .interfaces import InterfaceCode
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

#: The parts of a spec, of those that errata can affect, that a header contains.
_IN_HEADER = (
    *("alarms", "alternatives", "crcs", "field_groups", "inputs", "interfaces", "measurement", "order_code"),
    *("parameters", "procedures", "registers", "timings"),
)
_Built = TypeVar("_Built")


@dataclass(frozen=True, slots=True)
class Usage:
    """The names needed to read a position: the order code macro, the frame, its verdict function and the member."""

    macro: str
    frame: str
    verdict: str
    member: str
    asked: tuple[AlternativeCode, ...] = ()


class DeviceView:
    """The parts of a device's header, each built from the previous ones."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self.context = context = Context(device)
        self.maker, self.prefix, self.PREFIX = context.maker, context.prefix, context.PREFIX
        self.reports, self.alternatives = context.reports, context.alternatives
        self.variants = VariantCode(context)
        self.crcs = [crc_code(context, item) for item in crc_functions(device)]
        self.interfaces = [
            _at(partial(InterfaceCode, context, item), "interfaces", item.name) for item in device.interfaces
        ]
        self.lengths = {item.name: LengthCode(context, item, self.variants.rows) for item in device.interfaces}
        self.positions = list(positions(context))
        # A register that selects banks comes first: the functions of the registers in its banks use its address.
        selecting = {device.bank_selector(item) for item in device.registers}
        self.registers = [
            _at(partial(RegisterCode, context, item), "registers", item.name)
            for item in sorted(device.registers, key=lambda item: item.name not in selecting)
        ]
        codes = {item.register.name: item for item in self.registers}
        self.takers = [Taker(context, item, codes[item.register.name].access) for item in held_parameters(device)]
        self.read_state = f"{self.prefix}_read_state" if state_registers(device) else ""
        self.identities = list(identity_codes(context, codes))
        self.procedures = [
            _at(partial(ProcedureCode, context, codes, self.read_state, item), "procedures", item.name)
            for item in device.procedures
        ]
        self.inputs = [about_input(device, item) for item in device.inputs]
        self.alarms = [AlarmCode(context, item) for item in device.alarms]
        self.timings = [macro for item in device.timings for macro in timing_macros(item, self.PREFIX)]

    @cached_property
    def names(self) -> Names:
        return Names(self._declared())

    def _declared(self) -> Iterator[Declared]:
        yield f"{self.PREFIX}_H", ()
        yield f"{self.PREFIX}_VERSION", ()
        if self.read_state:
            yield self.read_state, ()
        parts = chain(
            [self.variants],
            self.context.enumerations.all,
            self.crcs,
            [self.reports],
            self.alternatives,
            self.interfaces,
            self.lengths.values(),
            self.positions,
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
    def manual(self) -> str:
        manual = self.device.manual
        editions = ", ".join(f"{item.language} {item.revision}" for item in manual.editions)
        dated = f" of {manual.date}" if manual.date else ""
        beside = f"; compared with: {editions}" if editions else ""
        return f'"{manual.title}", revision {manual.revision}{dated} ({manual.language}{beside})'

    @property
    def origin(self) -> list[Paragraph]:
        """Statements about the family that are not in its manual. Most families have none."""
        return [
            S.sentence(item) for item in (*origin(self.device), *other_editions(self.device), *taken_away(self.device))
        ]

    @property
    def documents(self) -> list[Paragraph]:
        return [
            (f"  {item.key}: ", f"{item.title}{' - ' + item.url if item.url else ''}") for item in self.device.documents
        ]

    @property
    def usage(self) -> Usage | None:
        """The example at the top of the header, for the interface with the best frames, or None without any verdict."""
        for code in sorted(self.interfaces, key=lambda item: not isinstance(item.interface, Biss)):
            measurement = self.device.measurement_of(code.interface.name)
            row = next((row for row in self.variants.rows if row.variant.interface == code.interface.name), None)
            for item in code.codecs if measurement is not None and row is not None else ():
                names = {field.name for field in item.struct.layout.fields}
                names |= {join.name for join in item.struct.layout.joins}
                told = item.reports.verdict if item.reports is not None else ""
                if told and not item.plan.in_bytes and measurement and measurement.of in names:
                    return Usage(row.macro if row else "", item.name, told, c_name(measurement.of), item.asked)
        return None

    def errata(self, *paths: str) -> list[Paragraph]:
        return [S.sentence(erratum(item)) for item in errata(self.device, *paths)]

    @property
    def all_errata(self) -> list[Paragraph]:
        """Return what is used instead of each erratum of the header, and the changes of other editions in full."""
        made: list[Paragraph] = []
        for item in errata(self.device, *_IN_HEADER):
            head, *parts = BY_TITLE.lines(erratum(item, whole=True))
            if item.overlay or item.edition:
                made += [head, *(("  ", line) for line in parts)]
            else:
                made.append(f"{head} {next(line for line in parts if line.startswith('Used: '))}")
        return made


def _at(build: Callable[[], _Built], *path: str) -> _Built:
    """Return the result of ``build``. An error from it names this part of the spec."""
    try:
        return build()
    except TargetError as error:
        error.place = error.place or path
        raise
