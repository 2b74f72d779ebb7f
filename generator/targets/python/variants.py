"""Order codes in a device module: the variants, parameters in registers, and units of positions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property

from ...model import Interface, Layout, Measurement, Register, Spi, Variant, first_of
from ...model.expressions import Expression
from ...model.record import dataclass
from ...order_codes.labels import beginnings
from ...plan.description import describe
from ...plan.frames import Exchanged, HeldParameter, exchanges, held_parameters
from ...plan.values import (
    Cases,
    PositionRange,
    by_interface,
    counts,
    meaning_of,
    parameters_in_measurement,
    position_ranges,
)
from ...say.order_code import initial
from . import docstrings
from .codec import Coder
from .literals import Atom, Call, Code, Expr, Literal, Operation, joined, number, of_number, record
from .names import (
    FUNCTIONS,
    ClassNames,
    Context,
    OpenQuestion,
    attribute,
    byte_order,
    camel,
    decoder_maker,
    encoder_name,
)


def _column_names(coder: Coder) -> list[str]:
    """Return the names of the columns of a table of frames, as type checkers know them."""
    described = describe(coder.plan, None)
    data_fields = {part.field.name for part in coder.plan.parts}
    columns = [column for column in described.columns if column.name in data_fields]
    names: list[str] = []
    for column in columns:
        names += [coder.names.attribute(run) for run, _, _ in column.runs] or [coder.names.attribute(column.name)]
    names += [coder.names.attribute(join.name) for join in described.joins]
    for column in columns:
        if column.scale is not None:
            names.append(f"{coder.names.attribute(column.name)} ({column.scale.unit})")
    unused = ["unused"] if described.unused else []
    verdict = ["verdict"] if coder.reports is not None and coder.reports.otherwise else []
    return [*names, *unused, *verdict, "fault"]


@dataclass(frozen=True)
class FrameKind:
    """Frames that the encoder sends over an interface. If there are several kinds, ``dispatch`` decodes them."""

    interface: str
    coder: Coder
    dispatch: str
    union: str
    questions: Sequence[OpenQuestion] = ()
    members: tuple[Coder, ...] = ()

    @property
    def decoder(self) -> str:
        """Function that makes the decoder for an encoder."""
        return decoder_maker(self.dispatch) if self.dispatch else f"{self.coder.name}._make_decoder"

    @property
    def column_type(self) -> str:
        """Type of the names of the columns in a table of these frames."""
        return "Any" if self.dispatch else f"_{self.coder.name}Column"

    @property
    def column_names(self) -> str:
        """Names of the columns in a table of these frames, as literals."""
        return ", ".join(f'"{name}"' for name in _column_names(self.coder))

    @property
    def in_bytes(self) -> bool:
        return self.coder.plan.in_bytes

    @property
    def has_open_length(self) -> bool:
        """True if the length of the frame depends on a question that the manual leaves open."""
        answered = {name for question in self.questions for name, _ in question.members}
        return not answered.isdisjoint(self.coder.layout.bits.parameters)

    @property
    def listed(self) -> list[tuple[str, str]]:
        """Arguments for questions that the manual leaves open, with their descriptions."""
        return [(question.name, question.about) for question in self.questions]

    @property
    def arguments(self) -> list[tuple[str, str]]:
        """Arguments of ``decode``, with their descriptions."""
        if self.in_bytes:
            return [("frame", "Bytes of the frame, in the order of transmission."), *self.listed]
        frame = "Frame as a number whose most significant bit was sent first, or as a string of 0 and 1."
        bits = "Number of bits received, if known. The number itself does not show whether bits are missing."
        return [("frame", frame), ("bits", bits), *self.listed]

    @property
    def returned(self) -> str:
        """Description of the value that ``decode`` returns."""
        return "The frame. Check its ``verdict`` before you use the position." if self.has_verdict else "The frame."

    @property
    def has_verdict(self) -> bool:
        """True if any of the frames has a verdict."""
        return self.coder.reports is not None and bool(self.coder.reports.otherwise)


@dataclass(frozen=True)
class ListedCodes:
    """Listed order codes of one interface: the name of their type, the class of the encoder, and the codes."""

    literal: str
    encoder: str
    codes: tuple[str, ...]


class Variants:
    """Order codes of one module, as used by the template."""

    def __init__(self, context: Context, frame_kinds: tuple[FrameKind, ...], coders: tuple[Coder, ...]) -> None:
        self.context, self.device = context, context.device
        self.frame_kinds = frame_kinds
        self.sent = [coder for coder in coders if coder.layout.sender == "encoder"]
        #: True if any frame has a verdict.
        self.has_verdict = any(coder.reports is not None and coder.reports.otherwise for coder in coders)
        self._scope = context.scope_of("self")
        self.rows = [self._row(variant) for variant in self.device.variants]

    def _row(self, variant: Variant) -> Call:
        parts = tuple(variant.parts[part.name] for part in self.device.order_code.parts)
        positional: tuple[Literal, ...] = (variant.code, parts)
        names, values = self.context.parameters, variant.parameters
        keywords = [(names[parameter.name], values[parameter.name]) for parameter in self.device.set_parameters]
        return Call(encoder_name(variant.interface), (*(("", argument) for argument in positional), *keywords))

    # -- the class of the variants

    @property
    def names(self) -> list[str]:
        """Parameters whose values depend on the encoder."""
        return [self.context.parameters[parameter.name] for parameter in self.device.set_parameters]

    @property
    def with_requests(self) -> list[str]:
        """Names of the interfaces over which requests and replies form a pipeline of words."""
        spi_interfaces = (interface for interface in self.device.interfaces if isinstance(interface, Spi))
        return [interface.name for interface in spi_interfaces if interface.exchanges]

    def exchanged(self, interface: Interface) -> tuple[Exchanged, ...]:
        """Return the requests over an interface with their replies, unless they form a pipeline of words."""
        return () if interface.name in self.with_requests else exchanges(interface)

    def defaults(self, exchange: Exchanged) -> list[tuple[str, int]]:
        """Return the factory defaults in a request, with the names of its attributes."""
        names = ClassNames(exchange.request, None, ())
        return [(names.attribute(name), value) for name, value in exchange.defaults.items()]

    @property
    def beginnings(self) -> tuple[str, ...]:
        return beginnings(self.device.order_code)

    @cached_property
    def listed_by_interface(self) -> list[ListedCodes]:
        """Listed order codes of each interface, for type checkers."""
        listed_codes = []
        for interface in self.device.interfaces:
            codes = tuple(variant.code for variant in self.device.variants_over(interface.name))
            literal = f"{camel(self.context.module)}{interface.name.capitalize()}"
            if codes:
                listed_codes.append(ListedCodes(literal, encoder_name(interface.name), codes))
        return listed_codes

    @property
    def doc(self) -> str:
        return docstrings.of_variant(self.device, self.context.parameters)

    @property
    def derived(self) -> list[tuple[str, str, Expr]]:
        """Name, meaning and value of the parameters that are derived from others, except those for measurements."""
        derived, measured = [], parameters_in_measurement(self.device)
        for parameter in self.device.parameters:
            if parameter.equals is not None and parameter.name not in measured:
                meaning = docstrings.of_parameter(self.device, parameter)
                derived.append((self.context.parameters[parameter.name], meaning, self._scope.of(parameter.equals)))
        return derived

    # -- units of positions

    @cached_property
    def measured(self) -> str:
        """Name of the position attribute that is converted to turns or lengths."""
        measurement_used = next(
            (measurement for measurement in map(self._measurement, self.device.interfaces) if measurement is not None),
            None,
        )
        return (
            attribute(measurement_used.of, (*FUNCTIONS, "previous", "self", "unwrap"))
            if measurement_used is not None
            else ""
        )

    def _measurement(self, interface: Interface) -> Measurement | None:
        return self.device.measurement_of(interface.name)

    def _of(self, value: Expression | None) -> Expr | None:
        return self._scope.of(value) if value is not None else None

    def _cases(self, value: Callable[[Measurement], Expr | None]) -> Cases[Expr]:
        def of(interface: Interface) -> Expr | None:
            measurement = self._measurement(interface)
            return value(measurement) if measurement is not None else None

        return by_interface(self.device, of)

    @cached_property
    def counts_per_turn(self) -> Cases[Expr]:
        return self._cases(lambda measurement: self._of(measurement.counts_per_turn))

    @cached_property
    def step_um(self) -> Cases[Expr]:
        return self._cases(lambda measurement: self._of(measurement.step_um))

    @cached_property
    def step_nm(self) -> Cases[Expr]:
        return self._cases(lambda measurement: self._of(measurement.step_nm))

    @cached_property
    def per_counts(self) -> Cases[Expr]:
        """Number of counts to which ``step_nm`` applies, if it is not one everywhere."""
        cases = self._cases(
            lambda measurement: self._of(measurement.per_counts or Expression(1)) if measurement.step_nm else None
        )
        is_one_everywhere = all(value == number(1) for value, _ in cases.cases)
        return replace(cases, cases=()) if is_one_everywhere else cases

    @cached_property
    def modulus(self) -> Cases[Expr]:
        """Number of counts after which the position wraps around."""

        def whole(interface: Interface) -> Expr | None:
            only = self._only_range(interface)
            return self._modulus(only.measurement) if only is not None else None

        return by_interface(self.device, whole)

    def _modulus(self, measurement: Measurement) -> Expr | None:
        factors = [*map(self._scope.of, counts(measurement))]
        return joined("*", factors) if factors else None

    def _only_range(self, interface: Interface) -> PositionRange | None:
        """Return the range of the position, unless it depends on the frame or there is no measurement."""
        ranges = position_ranges(self.device, interface)
        return ranges[0] if len(ranges) == 1 and not ranges[0].never_wraps else None

    @cached_property
    def by_frame(self) -> list[str]:
        """Names of the interfaces over which frames have different ranges, or positions that never wrap around."""
        several = (interface for interface in self.device.interfaces if self._only_range(interface) is None)
        return [interface.name for interface in several if position_ranges(self.device, interface)]

    @property
    def no_range(self) -> str:
        """Reason why an interface has no range that applies to all of its frames."""
        unlimited = {interface.name for interface in self.device.interfaces if not self.modulus_of(interface)}
        reasons = ["the manual does not give it"] if unlimited.difference(self.by_frame) else []
        reasons += ["it depends on the frame, see range_of()"] if self.by_frame else []
        return ", or ".join(reasons)

    def modulus_of(self, interface: Interface) -> Expr | None:
        """Return the number of counts after which all positions over an interface wrap around, if it is known."""
        only = self._only_range(interface)
        return self._modulus(only.measurement) if only is not None else None

    def ranges_over(self, interface: Interface) -> list[tuple[str, Sequence[Expr | None]]]:
        """Return each frame with its lowest and highest position and modulus, if the frames differ."""
        if interface.name not in self.by_frame:
            return []
        ranges: list[tuple[str, Sequence[Expr | None]]] = []
        for position_range in position_ranges(self.device, interface):
            if position_range.has_difference:
                layouts = position_range.layouts
                ranges += [(layout.name, self._range_values(position_range, layout)) for layout in layouts]
        return ranges

    def _range_values(self, position_range: PositionRange, layout: Layout) -> tuple[Expr | None, ...]:
        modulus, measurement = self._modulus(position_range.measurement), position_range.measurement
        if position_range.signed_field is None:
            width = sum((layout.field(name).width for name in layout.names_in(measurement.of)), Expression(0))
            whole = modulus if modulus is not None else self._power(width)
            return number(0), self._of(measurement.highest) or Operation(whole, "-", number(1)), modulus
        highest = self._highest_signed(position_range)
        if measurement.highest is None or modulus is None:
            width = position_range.signed_field.width
            lowest = number(-1 << width.constant - 1) if width.is_constant else Operation(number(-1), "-", highest)
            return lowest, highest, modulus
        return Operation(Operation(highest, "-", modulus), "+", number(1)), highest, modulus

    def _power(self, exponent: Expression) -> Expr:
        if exponent.is_constant:
            return number(1 << exponent.constant)
        return Operation(number(1), "<<", self._scope.of(exponent))

    def _highest_signed(self, position_range: PositionRange) -> Expr:
        """Return the highest signed position. Without one in the spec, every number that fits in the field is valid."""
        field, highest = position_range.signed_field, position_range.measurement.highest
        assert field is not None
        if highest is not None:
            return self._scope.of(highest)
        if field.width.is_constant:
            return number((1 << field.widest - 1) - 1)
        return Operation(self._power(field.width - Expression(1)), "-", number(1))

    @cached_property
    def lowest(self) -> Cases[Expr] | None:
        """Lowest position, if positions are signed."""

        def of(position_range: PositionRange) -> Expr | None:
            if position_range.signed_field is None:
                return None
            # Without a highest position in the spec, every number that fits in the field is valid.
            is_whole = position_range.measurement.highest is None
            return Atom("-self.highest - 1" if is_whole else "self.highest - self.modulus + 1")

        return self._ends(of, number(0))

    @cached_property
    def highest(self) -> Cases[Expr] | None:
        """Highest position, if positions are signed or an offset can shift them above ``modulus``."""

        def of(range_: PositionRange) -> Expr | None:
            return (
                self._highest_signed(range_)
                if range_.signed_field is not None
                else self._of(range_.measurement.highest)
            )

        return self._ends(of, Operation(Atom("self.modulus"), "-", number(1)))

    @property
    def is_shifted(self) -> bool:
        """True if an offset can shift the positions of an interface above ``modulus``."""
        ranges = filter(None, map(self._only_range, self.device.interfaces))
        return any(range_.measurement.highest is not None and range_.signed_field is None for range_ in ranges)

    def _ends(self, value: Callable[[PositionRange], Expr | None], usual: Expr) -> Cases[Expr] | None:
        """Return the ends of the range of positions on one side, or None if they are as usual."""

        def of(interface: Interface) -> Expr | None:
            only = self._only_range(interface)
            return (value(only) or usual) if only is not None else None

        ends = by_interface(self.device, of)
        is_usual = not self.by_frame and all(end == usual for end, _ in ends.cases)
        return None if is_usual else ends

    @property
    def bases(self) -> list[str]:
        """Classes of the runtime that convert and unwrap its positions, or that of any encoder."""
        measured = {
            "Rotary": bool(self.counts_per_turn.cases),
            "Linear": bool(self.step_um.cases),
            "FineLinear": bool(self.step_nm.cases),
            "Wrapping": bool(self.modulus.cases or self.by_frame),
        }
        return [name for name, applies in measured.items() if applies] or ["Encoder"]

    @cached_property
    def frame_bits(self) -> Cases[Expr]:
        """Number of bits in the encoder's frame, if it is a string of bits."""
        kinds = (kind for kind in self.frame_kinds if not kind.in_bytes and not kind.has_open_length)
        first = {kind.interface: kind.coder.layout.bits for kind in kinds}
        return by_interface(self.device, lambda interface: self._of(first.get(interface.name)))

    # -- answers with a default

    @property
    def answers(self) -> list[OpenQuestion]:
        """Questions whose default applies unless the user chooses another answer."""
        optional = self.device.optional_alternatives
        return [self.context.questions[alternative.name] for alternative in optional]

    @property
    def some_code(self) -> str:
        """Last order code with a frame whose verdict such an answer decides."""
        layouts = self.device.layouts()
        interfaces = {interface.name for interface, layout in layouts if self.device.verdict_alternatives(layout)}
        variants = (variant for variant in reversed(self.device.variants) if variant.interface in interfaces)
        return first_of(variants, "order code with a frame whose verdict an answer decides").code

    def answered(self, question: OpenQuestion) -> list[tuple[str, str]]:
        """Return the parameters that an answer sets, with the names of their values in its Enum."""
        return [(self.context.parameters[name], member) for name, member in question.members]

    # -- parameters in registers

    @cached_property
    def held_records(self) -> list[tuple[str, Call]]:
        """Parameters that registers hold at run time: name and record."""
        names = self.context.parameters
        records: list[tuple[str, Call]] = []
        for group in held_parameters(self.device):
            members = group.parameters
            records += [(names[member.parameter.name], self._held_record(group.register, member)) for member in members]
        return records

    @property
    def initial(self) -> str:
        """Kind of the values that they have until they are read."""
        return initial(self.device)

    @property
    def holding(self) -> str:
        """Registers that hold them."""
        registers = (group.register for group in held_parameters(self.device))
        return ", ".join(f"{register.name} at {register.address:02X}h" for register in registers)

    def _held_record(self, register: Register, held_parameter: HeldParameter) -> Call:
        parameter, width = held_parameter.parameter, held_parameter.field.widest
        needed: dict[str, Literal] = {
            "parameter": self.context.parameters[parameter.name],
            "interface": Code(f"Interface.{register.interface.upper()}"),
            "address": Code(f"Address.{register.name.upper()}"),
            "default": register.default_bytes() or bytes(register.length),
            "order": byte_order(register),
            "low": held_parameter.field.low.constant,
            "width": width,
            "min": parameter.min or 0,
            "max": parameter.max if parameter.max is not None else held_parameter.highest_value,
        }
        if parameter.by_code:
            needed["codes"] = tuple((by_code.code, by_code.value) for by_code in parameter.by_code)
        if register.default is None:
            needed["by_order_code"] = True
        return record(
            "RegisterParameter", needed, **({} if parameter.by_code else of_number(meaning_of(held_parameter.field)))
        )
