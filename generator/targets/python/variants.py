"""Order codes in a device module: the variants, parameters in registers, and units of positions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property

from ...model import Interface, Layout, Measurement, Spi, Variant, first_or_raise
from ...model.expressions import Expression
from ...model.record import dataclass
from ...order_codes.patterns import beginnings
from ...plan.frames import RequestAndReply, exchanges, held_parameters
from ...plan.values import (
    ByInterface,
    PositionRange,
    by_interface,
    count_factors,
    parameters_in_measurement,
    position_ranges,
)
from ...say.order_code import words_for_initial_values
from . import docstrings
from .codec import LayoutClass
from .facts import record_of_held_parameter
from .frame_kinds import ChannelCode, FrameKind, channel_code
from .literals import (
    Atom,
    CallLiteral,
    Literal,
    PythonExpression,
    PythonOperation,
    join_operands,
    number,
)
from .names import FUNCTIONS, ClassNames, DeviceNames, OpenQuestion, encoder_name, in_camel_case, python_name


@dataclass(frozen=True)
class ListedCodes:
    """The order codes in the manual's list for one interface.

    ``type_name`` is the name of their literal type, and ``encoder`` the class of the encoder.
    """

    type_name: str
    encoder: str
    codes: tuple[str, ...]


class VariantTable:
    """The order codes of one module, and the members of their class, as the template prints them."""

    def __init__(
        self, device_names: DeviceNames, frame_kinds: tuple[FrameKind, ...], layout_classes: tuple[LayoutClass, ...]
    ) -> None:
        self.device_names = device_names
        self.device = device_names.device
        self.frame_kinds = frame_kinds
        self.sent_frames = [layout_class for layout_class in layout_classes if layout_class.layout.sender == "encoder"]
        #: True if any frame has a verdict.
        self.has_verdict = any(
            layout_class.reports is not None and layout_class.reports.default_verdict for layout_class in layout_classes
        )
        self._translator = device_names.translator_for("self")
        self.rows = [self._build_row(variant) for variant in self.device.variants]

    def _build_row(self, variant: Variant) -> CallLiteral:
        """Return the call that creates the object of an order code: ``SsiEncoder("X-13", ("X", "13"), bits=13)``."""
        texts_of_parts = tuple(variant.parts[part.name] for part in self.device.order_code.parts)
        arguments: list[tuple[str, Literal]] = [("", variant.code), ("", texts_of_parts)]
        for parameter in self.device.set_parameters:
            attribute_name = self.device_names.attribute_by_parameter[parameter.name]
            arguments.append((attribute_name, variant.parameters[parameter.name]))
        return CallLiteral(encoder_name(variant.interface), tuple(arguments))

    # -- the class of the variants

    @property
    def parameter_attributes(self) -> list[str]:
        """The attributes of the parameters that order codes set, in the order of the arguments."""
        return [self.device_names.attribute_by_parameter[parameter.name] for parameter in self.device.set_parameters]

    @property
    def interfaces_with_requests(self) -> list[str]:
        """The names of the SPI interfaces with requests, whose replies follow in the pipeline of words."""
        spi_interfaces = (interface for interface in self.device.interfaces if isinstance(interface, Spi))
        return [interface.name for interface in spi_interfaces if interface.exchanges]

    def requests_and_replies(self, interface: Interface) -> tuple[RequestAndReply, ...]:
        """Return the requests over an interface with their replies, except those over SPI."""
        return () if interface.name in self.interfaces_with_requests else exchanges(interface)

    def default_attributes(self, exchange: RequestAndReply) -> list[tuple[str, int]]:
        """Return the attribute and the default of each field of a request that has one: ``[("address", 1)]``."""
        # The layout of a request is not the layout of a register, and names of CRC functions do not matter for
        # attributes.
        class_names = ClassNames(exchange.request, register=None, crcs=())
        return [(class_names.attribute_name(name), default) for name, default in exchange.defaults.items()]

    def channels(self, interface: Interface) -> ChannelCode | None:
        """Return the code for the frame with all data channels of an interface, or None if frames have one channel."""
        return channel_code(self.device_names, interface, self._translator)

    @property
    def beginnings(self) -> tuple[str, ...]:
        """The texts with which the order codes begin."""
        return beginnings(self.device.order_code)

    @cached_property
    def listed_by_interface(self) -> list[ListedCodes]:
        """The order codes in the manual's list by interface, for type checkers."""
        listed_codes = []
        for interface in self.device.interfaces:
            codes = tuple(variant.code for variant in self.device.variants_over(interface.name))
            type_name = f"{in_camel_case(self.device_names.module_name)}{interface.name.capitalize()}"
            if codes:
                listed_codes.append(ListedCodes(type_name, encoder_name(interface.name), codes))
        return listed_codes

    @property
    def doc(self) -> str:
        """The docstring of the class."""
        return docstrings.describe_variant(self.device, self.device_names.attribute_by_parameter)

    @property
    def derived_parameters(self) -> list[tuple[str, list[docstrings.Block], PythonExpression]]:
        """The attribute, the docstring and the value of each parameter that is computed from other parameters.

        Parameters that equal a quantity of the measurement, such as the counts per turn, are left out, since the class
        already has that quantity.
        """
        derived = []
        names_in_measurement = parameters_in_measurement(self.device)
        for parameter in self.device.parameters:
            if parameter.equals is not None and parameter.name not in names_in_measurement:
                attribute_name = self.device_names.attribute_by_parameter[parameter.name]
                paragraphs = docstrings.describe_derived_parameter(self.device, parameter)
                derived.append((attribute_name, paragraphs, self._translator.to_python(parameter.equals)))
        return derived

    # -- units of positions

    @cached_property
    def position_attribute(self) -> str:
        """The name of the position as an argument, or an empty string if the manual does not say what it measures."""
        for interface in self.device.interfaces:
            measurement = self._measurement_of(interface)
            if measurement is not None:
                return python_name(measurement.position_name, (*FUNCTIONS, "previous", "self", "unwrap"))
        return ""

    def _measurement_of(self, interface: Interface) -> Measurement | None:
        """Return what the position over an interface measures, or None if the spec does not say."""
        return self.device.measurement_of(interface.name)

    def _code_of(self, value: Expression | None) -> PythonExpression | None:
        """Return an expression of the spec in Python, such as ``1 << self.bits``, or None for None."""
        return self._translator.to_python(value) if value is not None else None

    def _cases_by_interface(
        self, quantity_of: Callable[[Measurement], PythonExpression | None]
    ) -> ByInterface[PythonExpression]:
        """Return a quantity of the measurement, such as the step, with the interfaces to which each value applies.

        ``quantity_of`` returns the quantity of a measurement, or None if the measurement does not have it.
        """

        def quantity_over(interface: Interface) -> PythonExpression | None:
            measurement = self._measurement_of(interface)
            return quantity_of(measurement) if measurement is not None else None

        return by_interface(self.device, quantity_over)

    @cached_property
    def counts_per_turn(self) -> ByInterface[PythonExpression]:
        """The number of counts in one revolution."""
        return self._cases_by_interface(lambda measurement: self._code_of(measurement.counts_per_turn))

    @cached_property
    def step_um(self) -> ByInterface[PythonExpression]:
        """The length of a count in micrometers."""
        return self._cases_by_interface(lambda measurement: self._code_of(measurement.step_um))

    @cached_property
    def step_nm(self) -> ByInterface[PythonExpression]:
        """The length of ``per_counts`` counts, in nanometers."""
        return self._cases_by_interface(lambda measurement: self._code_of(measurement.step_nm))

    @cached_property
    def per_counts(self) -> ByInterface[PythonExpression]:
        """Number of counts to which ``step_nm`` applies. There are no cases if it is 1 everywhere."""

        def count_expression(measurement: Measurement) -> PythonExpression | None:
            if measurement.step_nm is None:
                return None
            return self._code_of(measurement.per_counts or Expression(1))

        cases = self._cases_by_interface(count_expression)
        is_one_everywhere = all(count == number(1) for count, _ in cases.values_with_interfaces)
        return replace(cases, values_with_interfaces=()) if is_one_everywhere else cases

    @cached_property
    def modulus(self) -> ByInterface[PythonExpression]:
        """Number of counts after which the position wraps around."""
        return by_interface(self.device, self.modulus_of)

    def _modulus_expression(self, measurement: Measurement) -> PythonExpression | None:
        """Return the number of counts after which a position wraps around, or None if the spec does not give it."""
        factors = [*map(self._translator.to_python, count_factors(measurement))]
        return join_operands("*", factors) if factors else None

    def _only_range(self, interface: Interface) -> PositionRange | None:
        """Return the range of positions over an interface, or None if there is not exactly one that wraps around.

        There is none without a measurement, and several if frames differ in range.
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
        """The reasons why an interface has no modulus for all of its frames, or an empty string if all have one."""
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

        The result is None if the spec does not give it, or if it depends on the frame.
        """
        only_range = self._only_range(interface)
        return self._modulus_expression(only_range.measurement) if only_range is not None else None

    def ranges_over(self, interface: Interface) -> list[tuple[str, Sequence[PythonExpression | None]]]:
        """Return each frame with its lowest and highest position and its modulus, or nothing if frames agree.

        Frames in which the distance between two positions is unknown are left out.
        """
        if interface.name not in self.interfaces_with_frame_ranges:
            return []
        values_by_frame: list[tuple[str, Sequence[PythonExpression | None]]] = []
        for position_range in position_ranges(self.device, interface):
            if position_range.has_difference:
                layouts = position_range.layouts
                values_by_frame += [(layout.name, self._range_values(position_range, layout)) for layout in layouts]
        return values_by_frame

    def _range_values(self, position_range: PositionRange, layout: Layout) -> tuple[PythonExpression | None, ...]:
        """Return the lowest and the highest position in a frame, and the modulus, or None if it never wraps.

        A signed position with a highest value in the spec spans ``modulus`` counts. Without one, it can be any number
        that fits in its field, such as -2048 to 2047.
        """
        measurement = position_range.measurement
        modulus = self._modulus_expression(measurement)
        if position_range.signed_field is None:
            return number(0), self._highest_unsigned(measurement, layout), modulus
        highest = self._highest_signed(position_range)
        if measurement.highest is not None and modulus is not None:
            # From lowest to highest there are ``modulus`` positions.
            below_lowest = PythonOperation(highest, "-", modulus)
            lowest = PythonOperation(below_lowest, "+", number(1))
            return lowest, highest, modulus
        width = position_range.signed_field.width
        if width.is_constant:
            return number(-1 << (width.constant - 1)), highest, modulus
        # The lowest number in two's complement is -highest - 1.
        return PythonOperation(number(-1), "-", highest), highest, modulus

    def _highest_unsigned(self, measurement: Measurement, layout: Layout) -> PythonExpression:
        """Return the highest unsigned position in a frame.

        It is the value in the spec, or else ``modulus - 1``, or without a modulus the highest number that fits.
        """
        stated_highest = self._code_of(measurement.highest)
        if stated_highest is not None:
            return stated_highest
        modulus = self._modulus_expression(measurement)
        position_fields = [layout.field(name) for name in layout.field_names_of(measurement.position_name)]
        bit_count = sum((field.width for field in position_fields), Expression(0))
        value_count = modulus if modulus is not None else self._power_of_two(bit_count)
        return PythonOperation(value_count, "-", number(1))

    def _power_of_two(self, exponent: Expression) -> PythonExpression:
        """Return two to the power of ``exponent``."""
        if exponent.is_constant:
            return number(1 << exponent.constant)
        return PythonOperation(number(1), "<<", self._translator.to_python(exponent))

    def _highest_signed(self, position_range: PositionRange) -> PythonExpression:
        """Return the highest signed position: the value in the spec, or else the highest that fits in the field."""
        signed_field = position_range.signed_field
        assert signed_field is not None
        stated_highest = position_range.measurement.highest
        if stated_highest is not None:
            return self._translator.to_python(stated_highest)
        if signed_field.width.is_constant:
            return number((1 << (signed_field.widest - 1)) - 1)
        width_without_sign = signed_field.width - Expression(1)
        return PythonOperation(self._power_of_two(width_without_sign), "-", number(1))

    @cached_property
    def lowest(self) -> ByInterface[PythonExpression] | None:
        """The lowest position by interface, or None if it is 0 everywhere."""

        def lowest_of(position_range: PositionRange) -> PythonExpression | None:
            if position_range.signed_field is None:
                return None
            if position_range.measurement.highest is None:
                # Every number that fits in the field is valid.
                return Atom("-self.highest - 1")
            return Atom("self.highest - self.modulus + 1")

        return self._ends_by_interface(lowest_of, usual_end=number(0))

    @cached_property
    def highest(self) -> ByInterface[PythonExpression] | None:
        """The highest position by interface, or None if it is ``modulus - 1`` everywhere."""

        def highest_of(position_range: PositionRange) -> PythonExpression | None:
            if position_range.signed_field is not None:
                return self._highest_signed(position_range)
            return self._code_of(position_range.measurement.highest)

        default = PythonOperation(Atom("self.modulus"), "-", number(1))
        return self._ends_by_interface(highest_of, default)

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
        self, end_of_range: Callable[[PositionRange], PythonExpression | None], usual_end: PythonExpression
    ) -> ByInterface[PythonExpression] | None:
        """Return the lowest or the highest position by interface, or None if it is ``usual_end`` over all interfaces.

        ``usual_end`` is 0 for the lowest position, and ``self.modulus - 1`` for the highest. ``end_of_range`` returns
        the lowest or highest position of a range, or None if that is ``usual_end``. If the frames of an interface
        differ in range, the result is not None.
        """

        def end_over(interface: Interface) -> PythonExpression | None:
            only_range = self._only_range(interface)
            if only_range is None:
                return None
            return end_of_range(only_range) or usual_end

        ends = by_interface(self.device, end_over)
        are_all_usual = all(position == usual_end for position, _ in ends.values_with_interfaces)
        is_usual = not self.interfaces_with_frame_ranges and are_all_usual
        return None if is_usual else ends

    @property
    def bases(self) -> list[str]:
        """The base classes from the runtime that convert and unwrap positions, or only ``Encoder`` if none applies."""
        applies_by_class = {
            "Rotary": bool(self.counts_per_turn.values_with_interfaces),
            "Linear": bool(self.step_um.values_with_interfaces),
            "FineLinear": bool(self.step_nm.values_with_interfaces),
            "Wrapping": bool(self.modulus.values_with_interfaces or self.interfaces_with_frame_ranges),
        }
        return [name for name, applies in applies_by_class.items() if applies] or ["Encoder"]

    @cached_property
    def frame_bits(self) -> ByInterface[PythonExpression]:
        """The number of bits in a frame by interface, if frames are strings of bits of known length."""
        bits_by_interface: dict[str, Expression] = {}
        for frame_kind in self.frame_kinds:
            has_known_bits = not frame_kind.in_bytes and not frame_kind.has_open_length
            if has_known_bits:
                bits_by_interface[frame_kind.interface] = frame_kind.layout_class.layout.bits
        return by_interface(self.device, lambda interface: self._code_of(bits_by_interface.get(interface.name)))

    # -- answers with a default

    @property
    def answers(self) -> list[OpenQuestion]:
        """The open questions with a default answer, which applies unless the user chooses another."""
        optional = self.device.optional_alternatives
        return [self.device_names.question_by_name[alternative.name] for alternative in optional]

    @property
    def example_code(self) -> str:
        """The last order code with a frame whose verdict depends on an answer to one of the questions in ``answers``.

        Raises:
            LookupError: There is no such order code.
        """
        interface_names: set[str] = set()
        for interface, layout in self.device.layouts():
            if self.device.verdict_alternatives(layout):
                interface_names.add(interface.name)
        variants = (variant for variant in reversed(self.device.variants) if variant.interface in interface_names)
        return first_or_raise(variants, "order code with a frame whose verdict an answer decides").code

    def answered_parameters(self, question: OpenQuestion) -> list[tuple[str, str]]:
        """Return the attribute of each parameter that an answer sets, with its attribute in the Enum of answers."""
        return [(self.device_names.attribute_by_parameter[name], member) for name, member in question.members]

    # -- parameters in registers

    @cached_property
    def held_records(self) -> list[tuple[str, CallLiteral]]:
        """The parameters that are read from registers: the attribute of the variant, and the record of each."""
        names_and_records: list[tuple[str, CallLiteral]] = []
        for holding_register in held_parameters(self.device):
            for held_parameter in holding_register.parameters:
                attribute_name = self.device_names.attribute_by_parameter[held_parameter.parameter.name]
                record = record_of_held_parameter(self.device_names, holding_register.register, held_parameter)
                names_and_records.append((attribute_name, record))
        return names_and_records

    @property
    def initial_values(self) -> str:
        """The kind of values that these parameters have until they are read, such as ``factory defaults``."""
        return words_for_initial_values(self.device)

    @property
    def holding_registers(self) -> str:
        """The registers that contain these parameters, such as ``resolution at 5Ah, mode at 5Bh``."""
        registers = (holding_register.register for holding_register in held_parameters(self.device))
        return ", ".join(f"{register.name} at {register.address:02X}h" for register in registers)
