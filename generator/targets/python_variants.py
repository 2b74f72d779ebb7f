"""Order codes in Python source: the table of parts, the class of the variants, and what their positions measure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..expressions import Expression
from ..model import Interface, Measurement, Parameter, Sources, Variant, cite
from ..words import sentence
from .python_expressions import BITS, interface_name
from .python_facts import constant
from .python_source import Block, Call, Code, Literal, attribute, bare, call, docstring, expression, grouped, literal, operand, quoted, record
from .python_views import Codec, FrameKind, Measure, Section

if TYPE_CHECKING:
    from .python_module import Module


def _only(allowed: Mapping[str, tuple[str, ...]]) -> Code | None:
    """Which values of other parts go with one, as a literal."""
    if not allowed:
        return None
    items = ", ".join(f"{quoted(name)}: ({', '.join(map(quoted, texts))},)" for name, texts in allowed.items())
    return Code(f"ReadOnly({{{items}}})")


#: The arguments of ``Variant.decode``, by whether frames are made of bytes.
_DECODE = {False: "self, frame: Word, *, bits: int | None = None", True: "self, frame: Data"}


def _first_sent(section: Section) -> Codec | None:
    """The first frame that the encoder sends over an interface."""
    return next((item for item in section.codecs if item.layout.sender == "encoder"), None)


class Variants:
    """What the template prints of the order codes of one module."""

    def __init__(self, module: Module) -> None:
        self.module = module
        self.device = module.device
        self.names = module.parameter_names

    @property
    def order_code(self) -> str:
        code = self.device.order_code
        parts = tuple(
            record(
                "Part",
                {"name": part.name, "meaning": part.meaning,
                 "values": tuple(record("PartValue", {"text": value.text}, meaning=value.meaning, source=cite(value.source)) for value in part.values)},
                open=part.open, open_only_with=_only(part.open_only_with), source=cite(part.source),
            )
            for part in code.parts
        )
        spellings = tuple(
            record(
                "Spelling", {"pattern": item.pattern, "where": item.where},
                values=tuple(call("SpelledValue", value.part, value.text, value.value) for value in item.values),
                then=item.then, source=cite(item.source),
            )
            for item in code.also_written
        )
        made = record(
            "OrderCode", {"pattern": code.pattern, "parts": parts}, special=code.special, note=code.note,
            source=cite(code.source), also_written=spellings,
        )
        return constant("ORDER_CODE", made)

    @property
    def variant_doc(self) -> str:
        set_here = []
        for item in self.device.set_parameters:
            text = self._parameter_text(item.meaning, item.unit, item.source)
            if item.interface and len(self.device.interfaces) > 1:
                text += f" Over {self.device.interface(item.interface).title} only."
            if item.read_from:
                text += f" The default of {item.read_from}, unless with_registers() gives another."
            set_here.append((self.names[item.name], text))
        parts = ", ".join(part.name for part in self.device.order_code.parts)
        return docstring(
            "An encoder as its order code describes it.",
            ("Attributes", [
                ("family", "The encoder's family."),
                ("code", "Order code, without what may follow it on the label."),
                ("interface", "How the encoder is connected."),
                ("parts", f"The parts of the order code: {parts}."),
                *set_here,
                ("unlisted", "Parts of the order code that the manual leaves open."),
                ("tail", "What followed the order code on the label."),
                ("special_code", f"What the label ends in as /Sxxx. {sentence(self.device.order_code.special)}".strip()),
                ("written_as_in", "Where codes are written like the label, if that is not as the order codes are listed."),
            ]),
            indent=4,
        )

    @staticmethod
    def _parameter_text(meaning: str, unit: str, source: Sources) -> str:
        more = ", ".join(item for item in (unit, cite(source)) if item)
        return sentence(f"{meaning.rstrip('.')} ({more})" if more else meaning)

    @property
    def set_parameters(self) -> list[str]:
        return [self.names[item.name] for item in self.device.set_parameters]

    @property
    def derived_parameters(self) -> list[tuple[str, str, str]]:
        """Parameters that follow from others: name, docstring, expression."""
        return [
            (
                self.names[item.name],
                docstring(self._parameter_text(item.meaning, item.unit, item.source), indent=8),
                bare(expression(item.equals, self.names, "self")),
            )
            for item in self.device.parameters
            if item.equals is not None
        ]

    @property
    def measured(self) -> str:
        """What the position is called whose counts are turned into turns or lengths."""
        found = next((item for item in map(self._measurement, self.device.interfaces) if item is not None), None)
        return attribute(found.of, ("previous", "self", "unwrap")) if found is not None else ""

    @property
    def measures(self) -> list[Measure]:
        """Methods that turn counts into something else."""
        counts = self.measured
        kinds = (
            ("turns", "float", f"``{counts}``, in counts, as revolutions.", "steps_per_turn", f"index({counts}) / {{}}"),
            ("degrees", "float", f"``{counts}``, in counts, as degrees within one revolution.", "steps_per_turn", f"index({counts}) % {{0}} * 360 / {{0}}"),
            ("micrometres", "int", f"``{counts}``, in counts, as micrometres.", "step_um", f"index({counts}) * {{}}"),
            ("millimetres", "float", f"``{counts}``, in counts, as millimetres.", "step_um", f"index({counts}) * {{}} / 1000"),
        )
        found = []
        for name, kind, doc, part, text in kinds:
            values = {item.kind: getattr(self._measurement(item), part, None) for item in self.device.interfaces}
            branches = [(interface, text.format(operand(self._of_self(value)))) for interface, value in values.items() if value is not None]
            if branches:
                found.append(self._measure(name, kind, doc, branches, f"{counts}: int"))
        return found

    @property
    def modulus(self) -> Measure | None:
        """The count at which the position starts again."""
        counts = self.measured
        branches = []
        for interface in self.device.interfaces:
            measurement = self._measurement(interface)
            if measurement is not None and measurement.steps is not None:
                branches.append((interface.kind, bare(self._of_self(measurement.steps))))
            elif measurement is not None and measurement.steps_per_turn is not None and measurement.turns is not None:
                factors = [item for item in (measurement.steps_per_turn, measurement.turns) if item != Expression(1)]
                whole = " * ".join(operand(self._of_self(item)) for item in factors) or "1"
                branches.append((interface.kind, bare(whole) if len(factors) == 1 else whole))
        doc = f"Counts after which ``{counts}`` starts again: the highest one is 1 less."
        return self._measure("modulus", "int", doc, branches) if branches else None

    @property
    def highest(self) -> Measure | None:
        """The highest number sent, where an offset can move the positions above ``modulus``."""
        known = [(interface.kind, self._measurement(interface)) for interface in self.device.interfaces]
        if not any(measurement is not None and measurement.highest is not None for _, measurement in known):
            return None
        branches = []
        for interface, measurement in known:
            if measurement is not None:
                own = self._of_self(measurement.highest) if measurement.highest is not None else "self.modulus - 1"
                branches.append((interface, own))
        doc = f"The highest ``{self.measured}``: where an offset moves all of them up, it is not below ``modulus``."
        return self._measure("highest", "int", doc, branches)

    def _measure(
        self,
        name: str,
        kind: str,
        doc: str,
        branches: list[tuple[str, str]],
        arguments: str = "",
        otherwise: str = "the manual does not say",
    ) -> Measure:
        """A method; where not every interface has a value, or not all the same one, it tells them apart."""
        everywhere = len(branches) == len(self.device.interfaces)
        kinds: dict[str, list[str]] = {}
        for interface, value in branches:
            kinds.setdefault(value, []).append(interface_name(interface))
        # The value that most interfaces share comes last, where it needs no condition.
        made = tuple(
            (f"is {names[0]}" if len(names) == 1 else f"in ({', '.join(names)})", value) for value, names in sorted(kinds.items(), key=lambda item: len(item[1]))
        )
        raises: Block = "" if everywhere else ("Raises", [("ValueError", sentence(f"Over this interface {otherwise}"))])
        error = "" if everywhere else f"no {name.replace('_', ' ')} over {{self.interface.name}}: {otherwise}"
        return Measure(name, arguments, kind, docstring(doc, raises, indent=8), made, error)

    def _measurement(self, interface: Interface) -> Measurement | None:
        return self.device.measurement_of(interface.kind)

    def _of_self(self, value: Expression) -> str:
        return grouped(value.constant) if value.is_constant else expression(value, self.names, "self")

    @property
    def frame_bits(self) -> Measure | None:
        """How long the encoder's frame is, where that is a string of bits."""
        branches = [
            (interface.kind, bare(self._of_self(first.layout.bits)))
            for interface, section in zip(self.device.interfaces, self.module.sections)
            if (first := _first_sent(section)) is not None and not first.layout.carried_as == "bytes"
        ]
        doc = "How many bits a frame has, from the first data bit to the last, the CRC included where it ends in one."
        if not branches:
            return None
        return self._measure("frame_bits", "int", doc, branches, otherwise="frames are made of bytes")

    @property
    def held(self) -> list[str]:
        """The parameters that registers hold at run time, as records."""
        return [literal(self._held(item), 4, 4, 1) for item in self.device.run_time_parameters]

    def _held(self, item: Parameter) -> Call:
        register = self.device.register(item.register)
        field = register.layout.field(item.field)
        order = "little" if register.byte_order == "low_byte_first" else "big"
        largest = item.max if item.max is not None else field.zero_means or (1 << field.widest) - 1
        return record(
            "Held",
            {"parameter": self.names[item.name], "interface": Code(f"Interface.{register.interface.upper()}"), "address": Code(f"Address.{register.name.upper()}"),
             "default": register.default_bytes() or bytes(register.length), "order": order, "low": field.low.constant, "width": field.widest,
             "min": item.min or 0, "max": largest},
            zero_means=field.zero_means or None,
        )

    @property
    def held_names(self) -> list[str]:
        return [self.names[item.name] for item in self.device.run_time_parameters]

    @property
    def held_doc(self) -> str:
        """The docstring of ``with_registers``."""
        registers = {item.register: self.device.register(item.register) for item in self.device.run_time_parameters}
        listed = ", ".join(f"{item.name} at {item.address:02X}h" for item in registers.values())
        return docstring(
            "The encoder as it is when its registers hold these bytes, by address.",
            f"These change how a frame is read: {listed}. Registers that are left out stay as they are here, as delivered at first.",
            ("Raises", [("RangeError", "A register holds a value that cannot be."), ("ValueError", "A register changes nothing for this encoder.")]),
            indent=8,
        )

    @property
    def identity(self) -> list[tuple[str, str]]:
        """The registers by which an encoder is known: the interface, and the condition that one holds what is documented."""
        found = []
        for register in dict.fromkeys(register.name for register, _ in self.device.identity):
            item = self.device.register(register)
            view = self.module.classes[f"register {register}"]
            codec = next(entry for entry in self.module.registers if entry.name == view)
            more = ", variant" if isinstance(codec, Codec) and codec.takes_variant else ""
            check = Code(f"lambda data: {view}.decode(data{more}).is_as_documented")
            condition = call("agrees", Code("held"), Code(f"Address.{item.name.upper()}"), item.length, check)
            found.append((item.interface.upper(), literal(condition, 8, 12)))
        return found

    @property
    def identity_interfaces(self) -> str:
        """The condition that an encoder has registers to be known by."""
        kinds = list(dict.fromkeys(kind for kind, _ in self.identity))
        if len(kinds) == 1:
            return f"variant.interface is Interface.{kinds[0]}"
        return f"variant.interface in ({', '.join(f'Interface.{kind}' for kind in kinds)})"

    @property
    def variants(self) -> list[str]:
        return [self._variant(item) for item in self.device.variants]

    def _variant(self, variant: Variant) -> str:
        parts = tuple(variant.parts[part.name] for part in self.device.order_code.parts)
        named = {self.names[item.name]: variant.parameters[item.name] for item in self.device.set_parameters}
        positional: tuple[tuple[str, Literal], ...] = (("", variant.code), ("", Code(f"Interface.{variant.interface.upper()}")), ("", parts))
        arguments = (*positional, *named.items())
        return literal(Call("Variant", arguments), 12, 12, 1)

    @property
    def frame_kinds(self) -> list[FrameKind]:
        """By interface what ``Variant.decode`` calls."""
        found = []
        for interface, section in zip(self.device.interfaces, self.module.sections):
            reply = next((item.name for item in section.dispatches if item.name.endswith("reply")), "")
            first = _first_sent(section)
            if reply:
                found.append(FrameKind(interface_name(interface.kind), f"{reply}(frame, self)", True))
            elif first is not None:
                in_bytes = first.layout.carried_as == "bytes"
                more = (", self" if first.takes_variant else "") + ("" if in_bytes else ", bits=bits")
                found.append(FrameKind(interface_name(interface.kind), f"{first.name}.decode(frame{more})", in_bytes))
        return found

    @property
    def overloads(self) -> list[str]:
        """The arguments of ``Variant.decode`` for each kind of frame, where the family has both."""
        kinds = {item.refuses_bits for item in self.frame_kinds}
        return [_DECODE[in_bytes] for in_bytes in (False, True)] if len(kinds) > 1 else []

    @property
    def decode_arguments(self) -> str:
        if self.overloads:
            return "self, frame: Any, *, bits: int | None = None"
        return _DECODE[self.frame_kinds[0].refuses_bits]

    @property
    def decode_doc(self) -> str:
        """The docstring of ``Variant.decode``."""
        kinds = {item.refuses_bits for item in self.frame_kinds}
        words = "a number whose most significant bit was sent first, or text of 0 and 1"
        given = {False: f"What the encoder sent: {words}.", True: "What the encoder sent, as bytes."}
        both = f"What the encoder sent: bytes, or where the line carries bits {words}."
        return docstring(
            both if len(kinds) > 1 else given[True in kinds],
            ("Args", [BITS] if False in kinds else []),
            ("Raises", [
                ("FrameError", "The frame is damaged, or none of this encoder; the subclass says in what way."),
                ("TypeError", "``frame`` is of another type than the frames of this encoder."),
            ]),
            indent=8,
        )

    @property
    def frame_union(self) -> list[str]:
        """The classes of everything that the encoder sends."""
        return [item.name for section in self.module.sections for item in section.codecs if item.layout.sender == "encoder"]
