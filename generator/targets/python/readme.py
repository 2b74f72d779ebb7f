"""Examples in the README of the package: frames for each interface, and worked examples from the manuals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from math import prod

from ...model import (
    CrcExample,
    ModifyStep,
    PlacedLayout,
    PollStep,
    ProcedureExample,
    RegisterExample,
    Variant,
    number_to_bytes,
)
from ...model.only import applying
from ...model.record import dataclass
from ...plan.measurement import counts
from ...plan.values import (
    is_number,
    meaning_of,
)
from ...say.report import alarm_of, meaning
from .codec import Coder
from .context import Context
from .expr import grouped
from .procedures import Steps
from .variants import FrameKind

#: Number of registers and number of procedures that are shown.
_REGISTERS, _PROCEDURES = 3, 2


@dataclass(frozen=True)
class Shown:
    """Example in the README: a call and its result.

    ``judged`` is True for a frame with a verdict. ``spoilt`` is the same frame with a position that is not usable,
    ``reported`` its report, and ``tried`` the printed lines for both and for an invalid one. ``kind`` is the class
    of the frame if the encoder sends several. ``bits`` and ``digits`` describe a frame that is a string of bits.
    ``looked_up`` is True if the call needs the encoder. ``answers`` are the arguments for questions that the manual
    leaves open, ``module`` is the module of their classes.
    """

    code: str
    text: str
    shown: str
    result: str
    judged: bool = False
    spoilt: str = ""
    reported: str = ""
    tried: tuple[str, ...] = ()
    kind: str = ""
    bits: int = 0
    digits: str = ""
    looked_up: bool = False
    answers: str = ""
    module: str = ""

    @property
    def fence(self) -> str:
        """Fence of the block with ``tried``, longer than any in these texts, which come from the spec."""
        fence = "```"
        while any(fence in line for line in self.tried):
            fence += "`"
        return fence

    @property
    def lines(self) -> tuple[str, ...]:
        """Lines that print the values of a frame, after a check of the verdict if there is one."""
        if not self.judged:
            return (f"print({self.shown})",)
        return "if frame.verdict is not Verdict.NOT_USABLE:", f"    print({self.shown})"


def start(readmes: Sequence[Readme]) -> Shown:
    """Return the first example, preferably one with a frame of bits that can report an error."""
    frames = [frame for readme in readmes for frame in readme.frames]
    no_frame = Shown(readmes[0].device.variants[0].code, "", "", "")
    return max(frames, key=lambda item: (not item.answers, bool(item.spoilt), bool(item.bits)), default=no_frame)


class Readme:
    """Examples of one module in the README."""

    def __init__(
        self,
        context: Context,
        kinds: Sequence[FrameKind],
        coders: Mapping[str, Coder],
        procedures: Mapping[str, Steps],
    ) -> None:
        self.context, self.device = context, context.device
        self._kinds, self._coders, self._procedures = kinds, coders, procedures

    @cached_property
    def frames(self) -> list[Shown]:
        """One frame for each interface, with invented values and with bits computed by the model."""
        made = ((kind, self._frame(kind.coder)) for kind in self._kinds)
        found = [
            replace(item, kind=kind.coder.name if kind.dispatch else "") if item is not None else None
            for kind, item in made
        ]
        # Users copy the first example, so it shows a frame that can report an error, if there is one.
        return sorted((item for item in found if item is not None), key=lambda item: not item.spoilt)

    def _frame(self, coder: Coder) -> Shown | None:
        layout = coder.layout
        sample = self.device.sample_of(layout)
        variant = next((item for item in self.device.variants if sample and item.code == sample.order_code), None)
        if sample is None or variant is None:
            return None
        placed, number = layout.place(variant.parameters), sample.frame
        joins = {join.name for join in layout.joins}
        shown = {
            name: value
            for name, value in sample.values.items()
            if name in joins or (is_number(meaning_of(field := layout.field(name))) and not coder.selects(field))
        }
        made = Shown(
            variant.code,
            _text(placed, number),
            ", ".join(f"frame.{coder.names.attribute(name)}" for name in shown),
            " ".join(map(str, shown.values())),
            judged=coder.reports is not None and bool(coder.reports.otherwise),
            bits=0 if layout.in_bytes else placed.bits,
            digits="" if layout.in_bytes else f"{number:0{placed.bits}b}",
            answers="".join(
                f", {item.name}={self.device.name}.{item.kind}.{item.alternative.answers[0].name.upper()}"
                for item in coder.asked
            ),
            module=self.device.name if coder.asked else "",
        )
        if not made.judged or coder.reports is None or sample.spoilt is None:
            return made
        flag = layout.spoiling_flags[0]
        made = replace(made, spoilt=_text(placed, sample.spoilt), reported=coder.reports.name_of(flag))
        end = layout.crc_field
        if end is None or layout.in_bytes or coder.measured not in shown:
            return made
        received = (number ^ 1) & ((1 << end.widest) - 1)
        damaged = f"expected CRC {received ^ 1:#04x}, got {received:#04x}"
        told = meaning(flag, alarm_of(self.device, flag))
        tried = (str(shown[coder.measured]), told, f"invalid frame of {variant.code}: {damaged}")
        return replace(made, tried=tried)

    def _example_variant(self, kind: str) -> Variant | None:
        """Return an order code with this interface: that of an example in the manual, or the one with the most bits."""
        codes = [item.order_code for item in self.device.examples if not isinstance(item, CrcExample)]
        names = [item.name for item in self.device.set_parameters]
        candidates = self.device.variants_over(kind)
        return max(
            candidates,
            key=lambda item: (item.code in codes, sum(item.parameters[name] for name in names)),
            default=None,
        )

    @property
    def registers(self) -> list[Shown]:
        """Worked examples of the first registers that have one."""
        found: dict[str, Shown] = {}
        for example in self.device.examples:
            if isinstance(example, RegisterExample) and example.values and example.register in self._coders:
                coder = self._coders[example.register]
                found.setdefault(coder.name, _register(example, coder))
        return list(found.values())[:_REGISTERS]

    @property
    def procedures(self) -> list[Shown]:
        found: list[Shown] = []
        for example in self.device.examples:
            if not isinstance(example, ProcedureExample) or len(found) == _PROCEDURES:
                continue
            steps = self._procedures[example.procedure]
            if any(isinstance(item, (ModifyStep, PollStep)) for item in steps.procedure.steps):
                continue
            if any(self.device.register(name).is_accessed_whole for name in steps.procedure.registers):
                continue
            encoder = f'lookup("{example.order_code}")'
            arguments = [*map(grouped, example.arguments.values())]
            if steps.takes_variant or not arguments:
                arguments.insert(0, encoder)
            else:
                arguments.append(f"variant={encoder}")
            result = repr(bytes(item.value for item in example.writes).hex(" "))
            found.append(Shown(f"{steps.name}({', '.join(arguments)})", "", "", result))
        return found

    @property
    def live(self) -> Shown | None:
        """Order code with RS-485, with the name of a procedure that clears most alarms, if there is one."""
        variant = self._example_variant("rs485")
        if variant is None:
            return None
        cleared = [name for alarm in applying(self.device.alarms, variant.code) for name in alarm.cleared_by]
        over = [item for item in self._procedures.values() if item.procedure.interface == variant.interface]
        resets = [item for item in over if item.procedure.name in cleared and not item.arguments]
        best = max(resets, key=lambda item: cleared.count(item.procedure.name), default=None)
        return Shown(variant.code, "", best.name if best else "", "", module=self.context.module)

    @property
    def run_time(self) -> list[Shown]:
        """Example of a register that changes the form of frames."""
        for item in self.device.run_time_parameters:
            register = self.device.register(item.register)
            field = register.layout.field(item.field)
            variant = self._example_variant(register.interface)
            if variant is None or item.by_code or register.length > 1 or field.low.constant or field.widest != 8:
                continue
            name = self.context.parameters[item.name]
            value = max(variant.parameters[item.name] - 4, item.min or 0)
            return [Shown(variant.code, f"0x{register.address:02X}: 0x{value:02X}", f"encoder.{name}", str(value))]
        return []

    @property
    def positions(self) -> list[Shown]:
        """Conversion of a position, and its count after a wrap-around."""
        variant = self.device.variants[0]
        measurement = self.device.measurement_of(variant.interface)
        factors = [item.value(variant.parameters) for item in counts(measurement)] if measurement is not None else []
        size = prod(factors) if factors else 0
        if measurement is None or size < 8:
            return []
        shown = [Shown(variant.code, f"encoder.unwrap({size - 2}, 3)", "", str(size + 3))]
        if measurement.counts_per_turn is not None:
            quarter = measurement.counts_per_turn.value(variant.parameters) // 4
            shown.insert(0, Shown(variant.code, f"encoder.degrees({quarter})", "", "90.0"))
        elif (step := measurement.micrometres(variant.parameters)) is not None:
            shown.insert(0, Shown(variant.code, "encoder.millimetres(1000)", "", repr(float(step))))
        return shown

    @property
    def identified(self) -> list[Shown]:
        """Worked examples of registers that identify an encoder."""
        known = {register.name for register, _ in self.device.identity}
        read: dict[str, RegisterExample] = {}
        for example in self.device.examples:
            if isinstance(example, RegisterExample) and example.register in known:
                read.setdefault(example.register, example)
        code = next((item.order_code for item in read.values()), "")
        if code not in {item.code for item in self.device.variants}:
            return []
        same = {name: item.bytes for name, item in read.items() if item.order_code == code}
        return [Shown(code, ", ".join(f'"{name}": {_bytes(data)}' for name, data in same.items()), "", "True")]


def _text(placed: PlacedLayout, number: int) -> str:
    """Return a frame as a Python literal."""
    if placed.layout.in_bytes:
        return _bytes(number_to_bytes(placed.layout, number, placed.bits))
    return f"{number:#x}"


def _bytes(data: bytes) -> str:
    return f'bytes.fromhex("{data.hex(" ").upper()}")'


def _register(example: RegisterExample, coder: Coder) -> Shown:
    variant = f', lookup("{example.order_code}")' if coder.takes_variant else ""
    types = {item.name: item.type for item in coder.attributes}
    shown, values = [], []
    for name, value in example.values.items():
        made = coder.names.attribute(name)
        named = isinstance(value, str) and types.get(made) != "str"
        shown.append(f"register.{made}" + (".name" if named else ""))
        values.append(repr(value.upper() if named and isinstance(value, str) else value))
    code = f"{coder.name}.decode({_bytes(example.bytes)}{variant})"
    return Shown(code, "", _tuple(shown), _tuple(values), looked_up=coder.takes_variant)


def _tuple(items: Sequence[str]) -> str:
    return f"({', '.join(items)})" if len(items) != 1 else items[0]
