"""Examples for the README of the package: made-up frames of each interface, and the worked examples of the manuals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .. import codec
from ..model import Field, Layout, Measurement, Variant
from .python_expressions import class_names
from .python_source import attribute, grouped
from .python_views import Codec, Shown

if TYPE_CHECKING:
    from .python_module import Module


#: How many registers and how many procedures are shown.
_REGISTERS, _PROCEDURES = 3, 2


def start(readmes: Sequence[Readme]) -> Shown:
    """The example to begin with: of a frame with flags to look at, and one in bits, where any family has such."""
    frames = [frame for readme in readmes for frame in readme.frames]
    no_frame = Shown(readmes[0].device.variants[0].code, "", "", "")
    return max(frames, key=lambda item: (bool(item.flags), bool(item.bits)), default=no_frame)


class Readme:
    """What the README shows of one module."""

    def __init__(self, module: Module) -> None:
        self.module = module
        self.device = module.device

    @property
    def frames(self) -> list[Shown]:
        """One frame of each interface, its values made up, its bits from the model."""
        found: list[Shown] = []
        for interface, section in zip(self.device.interfaces, self.module.sections):
            view = next((item for item in section.codecs if item.layout.sender == "encoder"), None)
            variant = self._example_variant(interface.kind)
            if view is None or variant is None:
                continue
            placed = view.layout.place(variant.parameters)
            values = {item.name: _made_up(item.field, item.width, view.layout) for item in placed.fields if item.field.carries_data}
            number = codec.encode(self.device, placed, values)
            joined = {join.name: codec.join_value(placed, join, codec.from_gray(placed, number)) for join in view.layout.joins}
            plain = [item.name for item in placed.fields if item.field.kind == "number" and item.name != view.layout.selector]
            shown = {name: values[name] for name in plain} | joined
            text, bits, digits = f"{number:#x}", placed.bits, f"{number:0{placed.bits}b}"
            if view.layout.carried_as == "bytes":
                bits, digits = 0, ""
                text = f'bytes.fromhex("{codec.number_to_bytes(view.layout, number, placed.bits).hex(" ").upper()}")'
            own = class_names(view.layout, None)
            printed = ", ".join(f"frame.{attribute(name, own)}" for name in shown)
            seen = tuple(f"frame.{attribute(item.name, own)}" for item in view.layout.spoiling_flags)
            found.append(Shown(variant.code, text, printed, " ".join(map(str, shown.values())), seen, bits, digits))
        # The first example is the one that is copied: it shows a look at the flags, where any frame has some.
        return sorted(found, key=lambda item: not item.flags)

    def _example_variant(self, kind: str) -> Variant | None:
        """An order code of this interface: that of an example of the manual, else the one with the most bits."""
        codes = [example.order_code for example in self.device.examples]
        candidates = [item for item in self.device.variants if item.interface == kind]
        return max(candidates, key=lambda item: (item.code in codes, sum(item.parameters[name.name] for name in self.device.set_parameters)), default=None)

    @property
    def registers(self) -> list[Shown]:
        """A worked example of each of the first registers that have one."""
        found: dict[str, Shown] = {}
        for example in self.device.examples:
            view = next((item for item in self.module.registers if example.kind == "register" and item.name == self.module.classes[f"register {example.register}"]), None)
            if isinstance(view, Codec) and example.values and view.name not in found and len(found) < _REGISTERS:
                variant = f', lookup("{example.order_code}")' if view.takes_variant else ""
                code = f'{view.name}.decode(bytes.fromhex("{example.bytes.hex(" ").upper()}"){variant})'
                types = {item.name: item.type for item in view.attributes}
                shown, values = [], []
                for name, value in example.values.items():
                    made = attribute(name, class_names(view.layout, self.device.register(example.register)))
                    named = isinstance(value, str) and types.get(made) != "str"
                    shown.append(f"register.{made}" + (".name" if named else ""))
                    values.append(repr(value.upper() if named and isinstance(value, str) else value))
                found[view.name] = Shown(code, "", _tuple(shown), _tuple(values))
        return list(found.values())

    @property
    def procedures(self) -> list[Shown]:
        """The worked examples of procedures."""
        found: list[Shown] = []
        for example in self.device.examples:
            if example.kind == "procedure" and len(found) < _PROCEDURES and not any(step.field for step in self.device.procedure(example.procedure).steps):
                view = next(item for item in self.module.procedures if item.name == self.module.functions_taken[example.procedure])
                encoder = f'lookup("{example.order_code}")'
                arguments = [*map(grouped, example.arguments.values())]
                if not view.optional or not arguments:
                    arguments.insert(0, encoder)
                else:
                    arguments.append(f"variant={encoder}")
                result = repr(bytes(item.value for item in example.writes).hex(" "))
                found.append(Shown(f"{view.name}({', '.join(arguments)})", "", "", result))
        return found

    @property
    def run_time(self) -> list[Shown]:
        """What a register does to an encoder whose frame follows it."""
        for item in self.device.run_time_parameters:
            register = self.device.register(item.register)
            field = register.layout.field(item.field)
            variant = self._example_variant(register.interface)
            if variant is None or register.length > 1 or field.low.constant or field.widest != 8:
                continue
            name = self.module.parameter_names[item.name]
            value = max(variant.parameters[item.name] - 4, item.min or 0)
            return [Shown(variant.code, f"0x{register.address:02X}: 0x{value:02X}", f"encoder.{name}", str(value))]
        return []

    @property
    def positions(self) -> list[Shown]:
        """What a position means, and how it goes on where the count starts again."""
        variant = self.device.variants[0]
        measurement = self.device.measurement_of(variant.interface)
        if measurement is None or not self.module.codes.modulus:
            return []
        size = _modulus(measurement, variant)
        if size < 8:
            return []
        shown = [Shown("", f"encoder.unwrap({size - 2}, 3)", "", str(size + 3))]
        if measurement.steps_per_turn is not None:
            quarter = measurement.steps_per_turn.value(variant.parameters) // 4
            shown.insert(0, Shown("", f"encoder.degrees({quarter})", "", "90.0"))
        elif measurement.step_um is not None:
            shown.insert(0, Shown("", "encoder.millimetres(1000)", "", repr(measurement.step_um.value(variant.parameters) * 1000 / 1000)))
        return [Shown(variant.code, item.text, "", item.result) for item in shown]

    @property
    def identified(self) -> list[Shown]:
        """The worked examples of registers by which an encoder is known."""
        known = {register.name for register, _ in self.device.identity}
        read = {}
        for example in self.device.examples:
            if example.kind == "register" and example.register in known and example.register not in read:
                read[example.register] = example
        if not read:
            return []
        first = next(iter(read.values()))
        same = {name: item.bytes for name, item in read.items() if item.order_code == first.order_code}
        text = ", ".join(f'"{name}": bytes.fromhex("{data.hex(" ").upper()}")' for name, data in same.items())
        code = self.device.variant(first.order_code).code if first.order_code in {item.code for item in self.device.variants} else ""
        return [Shown(code, text, "", "True")] if code else []


def _modulus(measurement: Measurement, variant: Variant) -> int:
    """The counts after which a position starts again."""
    if measurement.steps is not None:
        return measurement.steps.value(variant.parameters)
    if measurement.steps_per_turn is None or measurement.turns is None:
        return 0
    return measurement.steps_per_turn.value(variant.parameters) * measurement.turns.value(variant.parameters)


def _made_up(item: Field, width: int, layout: Layout) -> int | str | bool:
    """A value that shows something."""
    if item.name == layout.selector:
        return layout.selects[0]
    if item.kind == "flag":
        return False
    if item.kind == "choice":
        return item.values[0].value
    if item.kind == "text":
        return "A" * (width // 8)
    if item.kind == "digits":
        return 1
    if item.power_of_two:
        return 1 << width // 2
    bits = width - 1 if item.signed else width
    return max(123456789 % (1 << bits) if bits > 16 else min(42, (1 << bits) - 1), 1 if item.zero_means else 0)


def _tuple(items: Sequence[str]) -> str:
    return f"({', '.join(items)})" if len(items) != 1 else items[0]
