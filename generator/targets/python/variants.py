"""Order codes in a device module: the variants, parameters in registers, and units of positions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property

from ...model import Interface, Layout, Measurement, Register, Spi, Variant, first_or_raise
from ...model.expressions import Expression
from ...model.record import dataclass
from ...order_codes.labels import beginnings
from ...plan.frames import HeldParameter, RequestAndReply, exchanges, held_parameters
from ...plan.values import (
    ByInterface,
    PositionRange,
    by_interface,
    count_factors,
    meaning_of,
    parameters_in_measurement,
    position_ranges,
)
from ...say.order_code import initial
from . import docstrings
from .codec import LayoutClass
from .frame_kinds import ChannelCode, FrameKind, channel_code
from .literals import (
    Atom,
    CallLiteral,
    Literal,
    PythonExpression,
    PythonOperation,
    SourceText,
    join_operands,
    number,
    of_number,
    record,
)
from .names import FUNCTIONS, ClassNames, ModuleContext, OpenQuestion, attribute, byte_order, camel, encoder_name


@dataclass(frozen=True)
class ListedCodes:
    """Listed order codes of one interface: the name of their type, the class of the encoder, and the codes."""

    literal: str
    encoder: str
    codes: tuple[str, ...]


class VariantTable:
    """Order codes of one module, as used by the template."""

    def __init__(
        self, context: ModuleContext, frame_kinds: tuple[FrameKind, ...], layout_classes: tuple[LayoutClass, ...]
    ) -> None:
        self.context = context
        self.device = context.device
        self.frame_kinds = frame_kinds
        self.sent_frames = [layout_class for layout_class in layout_classes if layout_class.layout.sender == "encoder"]
        #: True if any frame has a verdict.
        self.has_verdict = any(
            layout_class.reports is not None and layout_class.reports.default_verdict for layout_class in layout_classes
        )
        self._scope = context.scope_of("self")
        self.rows = [self._build_row(variant) for variant in self.device.variants]

    def _build_row(self, variant: Variant) -> CallLiteral:
        """Return the object of an order code, such as ``SsiEncoder("X-13", ("X", "13"), bits=13)``."""
        texts_of_parts = tuple(variant.parts[part.name] for part in self.device.order_code.parts)
        arguments: list[tuple[str, Literal]] = [("", variant.code), ("", texts_of_parts)]
        for parameter in self.device.set_parameters:
            arguments.append((self.context.parameters[parameter.name], variant.parameters[parameter.name]))
        return CallLiteral(encoder_name(variant.interface), tuple(arguments))

    # -- the class of the variants

    @property
    def names(self) -> list[str]:
        """Names of the independent parameters, which are the arguments of an order code after its parts."""
        return [self.context.parameters[parameter.name] for parameter in self.device.set_parameters]

    @property
    def interfaces_with_requests(self) -> list[str]:
        """Names of the interfaces over which requests and replies form a pipeline of words."""
        spi_interfaces = (interface for interface in self.device.interfaces if isinstance(interface, Spi))
        return [interface.name for interface in spi_interfaces if interface.exchanges]

    def exchanged(self, interface: Interface) -> tuple[RequestAndReply, ...]:
        """Return the requests over an interface with their replies.

        There are none if requests and replies form a pipeline of words, which ``interfaces_with_requests`` lists.
        """
        return () if interface.name in self.interfaces_with_requests else exchanges(interface)

    def default_attributes(self, exchange: RequestAndReply) -> list[tuple[str, int]]:
        """Return attribute and factory default of each field in a request that has one: ``[("address", 1)]``."""
        # The layout of a request is not the layout of a register, and names of CRC functions do not matter for
        # attributes.
        class_names = ClassNames(exchange.request, register=None, crcs=())
        return [(class_names.attribute(name), default) for name, default in exchange.defaults.items()]

    def channels(self, interface: Interface) -> ChannelCode | None:
        """Return the frame with all data channels of an interface, or None if there is none."""
        return channel_code(self.context, interface, self._scope)

    @property
    def beginnings(self) -> tuple[str, ...]:
        return beginnings(self.device.order_code)

    @cached_property
    def listed_by_interface(self) -> list[ListedCodes]:
        """Listed order codes of each interface that has any, for type checkers."""
        listed_codes = []
        for interface in self.device.interfaces:
            codes = tuple(variant.code for variant in self.device.variants_over(interface.name))
            type_name = f"{camel(self.context.module)}{interface.name.capitalize()}"
            if codes:
                listed_codes.append(ListedCodes(type_name, encoder_name(interface.name), codes))
        return listed_codes

    @property
    def doc(self) -> str:
        return docstrings.of_variant(self.device, self.context.parameters)

    @property
    def derived_parameters(self) -> list[tuple[str, str, PythonExpression]]:
        """Name, meaning and value of each parameter that is derived from other parameters.

        Parameters that always equal a quantity of the measurement are left out, since the class already has that
        quantity.
        """
        derived = []
        names_in_measurement = parameters_in_measurement(self.device)
        for parameter in self.device.parameters:
            if parameter.equals is not None and parameter.name not in names_in_measurement:
                attribute_name = self.context.parameters[parameter.name]
                meaning = docstrings.of_parameter(self.device, parameter)
                derived.append((attribute_name, meaning, self._scope.expression_of(parameter.equals)))
        return derived

    # -- units of positions

    @cached_property
    def position_attribute(self) -> str:
        """Name of the position attribute that is converted to turns or lengths, or "" without a measurement."""
        for interface in self.device.interfaces:
            measurement = self._measurement_of(interface)
            if measurement is not None:
                return attribute(measurement.of, (*FUNCTIONS, "previous", "self", "unwrap"))
        return ""

    def _measurement_of(self, interface: Interface) -> Measurement | None:
        return self.device.measurement_of(interface.name)

    def _code_of(self, value: Expression | None) -> PythonExpression | None:
        """Return a number of the encoder in Python, such as ``1 << self.bits``, or None if it is not in the spec."""
        return self._scope.expression_of(value) if value is not None else None

    def _cases_by_interface(
        self, quantity_of: Callable[[Measurement], PythonExpression | None]
    ) -> ByInterface[PythonExpression]:
        """Return a quantity of the measurement, such as ``1 << self.bits``, with the interfaces to which it applies.

        ``quantity_of`` returns it for a measurement, or None if the measurement lacks it.
        """

        def quantity_over(interface: Interface) -> PythonExpression | None:
            measurement = self._measurement_of(interface)
            return quantity_of(measurement) if measurement is not None else None

        return by_interface(self.device, quantity_over)

    @cached_property
    def counts_per_turn(self) -> ByInterface[PythonExpression]:
        return self._cases_by_interface(lambda measurement: self._code_of(measurement.counts_per_turn))

    @cached_property
    def step_um(self) -> ByInterface[PythonExpression]:
        return self._cases_by_interface(lambda measurement: self._code_of(measurement.step_um))

    @cached_property
    def step_nm(self) -> ByInterface[PythonExpression]:
        return self._cases_by_interface(lambda measurement: self._code_of(measurement.step_nm))

    @cached_property
    def per_counts(self) -> ByInterface[PythonExpression]:
        """Number of counts to which ``step_nm`` applies. There are no cases if it is 1 everywhere."""

        def counts_of(measurement: Measurement) -> PythonExpression | None:
            if measurement.step_nm is None:
                return None
            return self._code_of(measurement.per_counts or Expression(1))

        cases = self._cases_by_interface(counts_of)
        is_one_everywhere = all(number_of_counts == number(1) for number_of_counts, _ in cases.cases)
        return replace(cases, cases=()) if is_one_everywhere else cases

    @cached_property
    def modulus(self) -> ByInterface[PythonExpression]:
        """Number of counts after which the position wraps around."""
        return by_interface(self.device, self.modulus_of)

    def _modulus_expression(self, measurement: Measurement) -> PythonExpression | None:
        """Return the number of counts after which a position wraps around, or None if the spec does not give it."""
        factors = [*map(self._scope.expression_of, count_factors(measurement))]
        return join_operands("*", factors) if factors else None

    def _only_range(self, interface: Interface) -> PositionRange | None:
        """Return the range of the position that applies to all frames of an interface.

        Return None if frames have different ranges, if the position never wraps around, or without a measurement.
        """
        ranges = position_ranges(self.device, interface)
        return ranges[0] if len(ranges) == 1 and not ranges[0].never_wraps else None

    @cached_property
    def interfaces_with_frame_ranges(self) -> list[str]:
        """Names of the interfaces over which frames have different ranges, or positions that never wrap around."""
        interface_names: list[str] = []
        for interface in self.device.interfaces:
            # Without a measurement there are no ranges at all.
            has_range = bool(position_ranges(self.device, interface))
            if self._only_range(interface) is None and has_range:
                interface_names.append(interface.name)
        return interface_names

    @property
    def reasons_without_range(self) -> str:
        """Reasons why an interface has no modulus that applies to all of its frames, or "" if all have a modulus."""
        interfaces = self.device.interfaces
        without_modulus = {interface.name for interface in interfaces if self.modulus_of(interface) is None}
        reasons: list[str] = []
        # Over these interfaces, the frames do not differ.
        if without_modulus.difference(self.interfaces_with_frame_ranges):
            reasons.append("the manual does not give it")
        if self.interfaces_with_frame_ranges:
            reasons.append("it depends on the frame, see range_of()")
        return ", or ".join(reasons)

    def modulus_of(self, interface: Interface) -> PythonExpression | None:
        """Return the number of counts after which all positions over an interface wrap around.

        Return None if the spec does not state it or if it depends on the frame.
        """
        only_range = self._only_range(interface)
        return self._modulus_expression(only_range.measurement) if only_range is not None else None

    def ranges_over(self, interface: Interface) -> list[tuple[str, Sequence[PythonExpression | None]]]:
        """Return each frame with its lowest and highest position and modulus, if the frames differ.

        Frames in which the distance between two positions is unknown are left out.
        """
        if interface.name not in self.interfaces_with_frame_ranges:
            return []
        ranges: list[tuple[str, Sequence[PythonExpression | None]]] = []
        for position_range in position_ranges(self.device, interface):
            if position_range.has_difference:
                layouts = position_range.layouts
                ranges += [(layout.name, self._range_values(position_range, layout)) for layout in layouts]
        return ranges

    def _range_values(self, position_range: PositionRange, layout: Layout) -> tuple[PythonExpression | None, ...]:
        """Return the lowest and the highest position in a frame, and the modulus, or None if there is none.

        An unsigned position without a highest value in the spec ends at ``modulus - 1``, or without a modulus at the
        highest number that its fields can hold. A signed position with a highest value in the spec spans ``modulus``
        counts. Without one, it can be any number that fits in its field, such as -2048 to 2047.
        """
        measurement = position_range.measurement
        modulus = self._modulus_expression(measurement)
        if position_range.signed_field is None:
            highest = self._code_of(measurement.highest)
            if highest is None:
                position_fields = [layout.field(name) for name in layout.names_in(measurement.of)]
                width = sum((field.width for field in position_fields), Expression(0))
                number_of_values = modulus if modulus is not None else self._power_of_two(width)
                highest = PythonOperation(number_of_values, "-", number(1))
            return number(0), highest, modulus
        highest = self._highest_signed(position_range)
        if measurement.highest is not None and modulus is not None:
            # From lowest to highest there are ``modulus`` positions.
            lowest = PythonOperation(PythonOperation(highest, "-", modulus), "+", number(1))
            return lowest, highest, modulus
        width = position_range.signed_field.width
        if width.is_constant:
            return number(-1 << (width.constant - 1)), highest, modulus
        # The lowest number in two's complement is -highest - 1.
        return PythonOperation(number(-1), "-", highest), highest, modulus

    def _power_of_two(self, exponent: Expression) -> PythonExpression:
        """Return two to the power of ``exponent``."""
        if exponent.is_constant:
            return number(1 << exponent.constant)
        return PythonOperation(number(1), "<<", self._scope.expression_of(exponent))

    def _highest_signed(self, position_range: PositionRange) -> PythonExpression:
        """Return the highest signed position: the spec's position, or else the highest that fits in the field."""
        field = position_range.signed_field
        assert field is not None
        stated_highest = position_range.measurement.highest
        if stated_highest is not None:
            return self._scope.expression_of(stated_highest)
        if field.width.is_constant:
            return number((1 << (field.widest - 1)) - 1)
        return PythonOperation(self._power_of_two(field.width - Expression(1)), "-", number(1))

    @cached_property
    def lowest(self) -> ByInterface[PythonExpression] | None:
        """Lowest position by interface, or None if it is 0 everywhere."""

        def lowest_of(position_range: PositionRange) -> PythonExpression | None:
            if position_range.signed_field is None:
                return None
            if position_range.measurement.highest is None:
                # Every number that fits in the field is valid.
                return Atom("-self.highest - 1")
            return Atom("self.highest - self.modulus + 1")

        return self._ends_by_interface(lowest_of, number(0))

    @cached_property
    def highest(self) -> ByInterface[PythonExpression] | None:
        """Highest position by interface, or None if it is ``modulus - 1`` everywhere."""

        def highest_of(position_range: PositionRange) -> PythonExpression | None:
            if position_range.signed_field is not None:
                return self._highest_signed(position_range)
            return self._code_of(position_range.measurement.highest)

        return self._ends_by_interface(highest_of, PythonOperation(Atom("self.modulus"), "-", number(1)))

    @property
    def is_shifted(self) -> bool:
        """True if an offset can shift the positions of an interface above ``modulus``.

        An unsigned position whose highest value is in the spec can be shifted.
        """
        for interface in self.device.interfaces:
            only_range = self._only_range(interface)
            is_unsigned = only_range is not None and only_range.signed_field is None
            if only_range is not None and is_unsigned and only_range.measurement.highest is not None:
                return True
        return False

    def _ends_by_interface(
        self, end_of: Callable[[PositionRange], PythonExpression | None], usual: PythonExpression
    ) -> ByInterface[PythonExpression] | None:
        """Return the lowest or the highest position by interface.

        ``end_of`` returns it for a range, or None where it is ``usual``: 0 for the lowest position, and
        ``self.modulus - 1`` for the highest. The result is None if the position is ``usual`` over all interfaces, and
        the frames of no interface differ.
        """

        def end_over(interface: Interface) -> PythonExpression | None:
            only_range = self._only_range(interface)
            if only_range is None:
                return None
            return end_of(only_range) or usual

        ends = by_interface(self.device, end_over)
        is_usual = not self.interfaces_with_frame_ranges and all(position == usual for position, _ in ends.cases)
        return None if is_usual else ends

    @property
    def bases(self) -> list[str]:
        """Classes of the runtime that convert and unwrap positions, or only ``Encoder`` if none applies."""
        applies_by_class = {
            "Rotary": bool(self.counts_per_turn.cases),
            "Linear": bool(self.step_um.cases),
            "FineLinear": bool(self.step_nm.cases),
            "Wrapping": bool(self.modulus.cases or self.interfaces_with_frame_ranges),
        }
        return [name for name, applies in applies_by_class.items() if applies] or ["Encoder"]

    @cached_property
    def frame_bits(self) -> ByInterface[PythonExpression]:
        """Number of bits in the encoder's frame by interface, if it is a string of bits of known length."""
        bits_by_interface: dict[str, Expression] = {}
        for kind in self.frame_kinds:
            has_known_bits = not kind.in_bytes and not kind.has_open_length
            if has_known_bits:
                bits_by_interface[kind.interface] = kind.layout_class.layout.bits
        return by_interface(self.device, lambda interface: self._code_of(bits_by_interface.get(interface.name)))

    # -- answers with a default

    @property
    def answers(self) -> list[OpenQuestion]:
        """Questions whose default answer applies unless the user chooses another answer."""
        optional = self.device.optional_alternatives
        return [self.context.questions[alternative.name] for alternative in optional]

    @property
    def example_code(self) -> str:
        """Last order code over an interface with a frame whose verdict depends on an answer of ``answers``.

        Raises an error if there is none.
        """
        interface_names: set[str] = set()
        for interface, layout in self.device.layouts():
            if self.device.verdict_alternatives(layout):
                interface_names.add(interface.name)
        variants = (variant for variant in reversed(self.device.variants) if variant.interface in interface_names)
        return first_or_raise(variants, "order code with a frame whose verdict an answer decides").code

    def answered_parameters(self, question: OpenQuestion) -> list[tuple[str, str]]:
        """Return the parameters that an answer sets, each with its attribute in the Enum of the answers."""
        return [(self.context.parameters[name], member) for name, member in question.members]

    # -- parameters in registers

    @cached_property
    def held_records(self) -> list[tuple[str, CallLiteral]]:
        """Parameters that registers hold at run time: the attribute of the variant, and its record."""
        records: list[tuple[str, CallLiteral]] = []
        # A group consists of a register and the parameters that it holds.
        for group in held_parameters(self.device):
            for held_parameter in group.parameters:
                attribute_name = self.context.parameters[held_parameter.parameter.name]
                records.append((attribute_name, self._held_record(group.register, held_parameter)))
        return records

    @property
    def initial_values(self) -> str:
        """Kind of the values that these parameters have until they are read, such as ``factory defaults``."""
        return initial(self.device)

    @property
    def holding_registers(self) -> str:
        """Registers that hold these parameters, such as ``resolution at 5Ah, mode at 5Bh``."""
        registers = (group.register for group in held_parameters(self.device))
        return ", ".join(f"{register.name} at {register.address:02X}h" for register in registers)

    def _held_record(self, register: Register, held_parameter: HeldParameter) -> CallLiteral:
        """Return the record of a parameter in a register: its place, its default, its limits or its codes.

        A register without a default contains zeros, and ``by_order_code`` marks it.
        """
        parameter = held_parameter.parameter
        record_members: dict[str, Literal] = {
            "parameter": self.context.parameters[parameter.name],
            "interface": SourceText(f"Interface.{register.interface.upper()}"),
            "address": SourceText(f"Address.{register.name.upper()}"),
            "default": register.default_bytes() or bytes(register.length),
            "order": byte_order(register),
            "low": held_parameter.field.low.constant,
            "width": held_parameter.field.widest,
            "min": parameter.min or 0,
            "max": parameter.max if parameter.max is not None else held_parameter.highest_value,
        }
        if parameter.by_code:
            record_members["codes"] = tuple((by_code.code, by_code.value) for by_code in parameter.by_code)
        if register.default is None:
            record_members["by_order_code"] = True
        if not parameter.by_code:
            record_members |= of_number(meaning_of(held_parameter.field))
        return record("RegisterParameter", record_members)
