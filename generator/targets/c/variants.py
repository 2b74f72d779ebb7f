"""Order codes in C: variants with their parameters, including parameters in registers, and the lengths of frames."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence, Set
from copy import copy
from itertools import chain
from typing import NamedTuple

from ...language.problems import join_words
from ...model import Biss, Clock, Device, Interface, Layout, Parameter, Variant, assert_never, first_or_raise
from ...model.interfaces import channel_frame
from ...model.record import dataclass
from ...plan.frames import BISS_ACKNOWLEDGE_BITS, FrameSize, HeldParameter, HoldingRegister, received_sizes
from ...plan.values import UnsignedNumber, ZeroMeans, parameters_in_measurement, widest_value
from ...say.names_and_evidence import title_of
from ...say.order_code import timeouts_with_codes, words_for_initial_values
from ...say.text import hertz, nanoseconds
from .. import TargetError
from .about import about_order_codes, about_parameter
from .context import HeaderContext
from .expressions import (
    CCast,
    CExpression,
    CFunction,
    CName,
    CNumber,
    Conditional,
    COperation,
    join_operands,
    number_function,
    type_and_bits_in,
)
from .names import CMacro, DeclaredName, c_name, c_number, unsigned
from .order_codes import OpenCode, open_codes, unknown_parts
from .registers import RegisterFunctions

#: Names of arguments and locals in the function that reads the registers.
_NAMES_OF_LOCALS = frozenset(("failure", "result", "taken", "transport", "variant"))


class CLocal(NamedTuple):
    """A local variable in C, such as ``const uint8_t turns = bytes[0];``."""

    type: str
    name: str
    initial_value: CExpression


class HeldValue:
    """A parameter that is read from a register, and the local variables that it is computed in.

    ``local`` is the variable with its value, and ``member`` its member in the variant. ``is_coded`` is True if the
    register contains a code that stands for the value.
    """

    def __init__(self, context: HeaderContext, parameter_in_register: HeldParameter) -> None:
        parameter = parameter_in_register.parameter
        field = parameter_in_register.field
        if not field.bit_slices:
            problem = f"the place of '{parameter.read_from}' depends on the order code; the C target cannot read it"
            raise TargetError(problem)
        self.held_parameter = parameter_in_register
        self.local = c_name(parameter.name, ("bytes", "length", "variant"))
        self.member = c_name(parameter.name)
        self.member_type = context.member_type(parameter)
        self.is_coded = bool(parameter.by_code)
        #: Locals in the order of their declarations, the last one with the value or its code.
        self.locals = tuple(self._yield_locals())
        self.type = self.locals[-1].type
        self.code = self.locals[-1].name

    def for_code(self, code: int) -> str:
        """Return the value, as C, that a code in the register stands for."""
        value = self.held_parameter.parameter.held_value(code)
        assert value is not None
        return str(CNumber(value))

    def _yield_locals(self) -> Iterator[CLocal]:
        """Yield each local, such as ``CLocal("uint8_t", "turns", bytes[0])``.

        If the bits 0 stand for a number, such as 256, a local with the bits as read comes first. A code has a local
        that ends in ``_code``.
        """
        type_, bits = type_and_bits_in(self.held_parameter.bits.bit_slices)
        match self.held_parameter.meaning:
            case ZeroMeans(number):
                raw_local = CName(f"{self.local}_raw")
                yield CLocal(type_, raw_local.text, initial_value=bits)
                is_zero = COperation("==", (raw_local, CNumber(0)))
                value = Conditional(is_zero, value_if_true=CNumber(number), value_if_false=raw_local)
                type_of_value = unsigned(widest_value(self.held_parameter.field))
                yield CLocal(type_of_value, self.local, initial_value=CCast(type_of_value, value))
            case UnsignedNumber():
                name = f"{self.local}_code" if self.is_coded else self.local
                yield CLocal(type_, name, initial_value=bits)
            case meaning:
                assert_never(meaning)

    @property
    def is_outside(self) -> CExpression | None:
        """Condition that the register contains a value outside the limits, or None if there are no limits."""
        lowest, highest = self.held_parameter.lowest_valid, self.held_parameter.highest_valid
        comparisons: list[CExpression] = []
        value = CName(self.local)
        if lowest is not None:
            comparisons.append(COperation("<", (value, CNumber(lowest))))
        if highest is not None:
            comparisons.append(COperation(">", (value, CNumber(highest))))
        return join_operands("||", tuple(comparisons)) if comparisons else None


@dataclass(frozen=True, slots=True)
class CodeSwitch:
    """A ``switch`` over the code in a register field, which assigns the values that the code stands for.

    ``local`` is the variable with the code. A case is a code with its assignments, such as
    ``("2U", (("position_bits", "24U"),))``.
    """

    local: str
    cases: tuple[tuple[str, tuple[tuple[str, str], ...]], ...]


def _yield_switches(held_values: Sequence[HeldValue]) -> Iterator[CodeSwitch]:
    """Yield a switch for each field that holds a code of one or several parameters.

    The switch has a case for each code for which all of these parameters have a value.
    """
    values_by_field: dict[str, list[HeldValue]] = {}
    for value in held_values:
        if value.is_coded:
            # The register and the field that hold the parameter.
            path_of_field = value.held_parameter.parameter.read_from
            values_by_field.setdefault(path_of_field, []).append(value)
    for field_values in values_by_field.values():
        common_codes = set.intersection(*map(_codes_of_held_value, field_values))
        cases = tuple(_switch_case(code, field_values) for code in sorted(common_codes))
        yield CodeSwitch(field_values[0].code, cases)


def _codes_of_held_value(held_value: HeldValue) -> set[int]:
    """Return the codes that stand for a value of the parameter."""
    return {row.code for row in held_value.held_parameter.parameter.by_code}


def _switch_case(code: int, held_values: Sequence[HeldValue]) -> tuple[str, tuple[tuple[str, str], ...]]:
    """Return a code, and the assignments that it leads to, such as ``("2U", (("position_bits", "24U"),))``."""
    return str(CNumber(code)), tuple((value.local, value.for_code(code)) for value in held_values)


class VariantUpdater:
    """The function that updates a variant from the content of a register."""

    def __init__(self, context: HeaderContext, register_parameters: HoldingRegister, access: RegisterFunctions) -> None:
        register = register_parameters.register
        self.name = f"{context.prefix}_take_{register.name}"
        parameter_names = join_words(parameter.parameter.name for parameter in register_parameters.parameters)
        self.about = f"Update {parameter_names} in a variant from the content of the {title_of(register)} register."
        self.values = tuple(HeldValue(context, parameter) for parameter in register_parameters.parameters)
        self.switches = tuple(_yield_switches(self.values))
        #: Locals that the bits are read into.
        self.locals = tuple(self._yield_locals())
        self.bytes = c_name(register.name, _NAMES_OF_LOCALS)
        self.access = access

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the name of the function."""
        yield self.name, ()

    def _yield_locals(self) -> Iterator[CLocal]:
        """Yield the local variables for all values.

        If a code in the register stands for several values, they share the local with the code.
        """
        switch_locals = {switch.local for switch in self.switches}
        for value in self.values:
            for local in value.locals:
                has_code = value.is_coded and local.name == value.code
                is_further_code = has_code and local.name not in switch_locals
                if not is_further_code:
                    yield local


@dataclass(frozen=True, slots=True)
class CodeRow:
    """An order code in C.

    ``macro`` is its initializer, such as ``ACME_X_24_A``, and ``name_in_macros`` the end of that name, such as
    ``24_A``. ``values`` are the members of the variant.
    """

    variant: Variant
    name_in_macros: str
    macro: str
    values: tuple[str, ...]


class VariantCode:
    """The order codes of a family over one interface, and the functions for derived parameters."""

    def __init__(self, context: HeaderContext) -> None:
        self.context = context
        self.device = context.device
        self.parameters = self.device.set_parameters
        measured = parameters_in_measurement(self.device)
        #: The derived parameters with a function. The functions for positions return the others.
        self._parameters_with_function = [
            parameter for parameter in self._in_order_of_use() if parameter.name not in measured
        ]
        self.derived: Sequence[CFunction] = [
            self._build_derived(parameter) for parameter in self._parameters_with_function
        ]
        self.rows = [self._build_row(variant) for variant in self.device.variants]
        #: A macro with one bit for each open part of the order code.
        self.unlisted_macros = list(self._unlisted_macros())
        self.label_patterns = open_codes(self.device)
        self.about = about_order_codes(self.device)

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names at file scope, each with its path in the spec, which is empty for names in every header."""
        yield self.context.prefix, ()
        for name in ("order_code", "order_codes", "find_order_code"):
            yield f"{self.context.prefix}_{name}", ()
        for parameter in self._parameters_with_function:
            yield f"{self.context.prefix}_{parameter.name}", ("parameters", parameter.name)
        yield from ((row.macro, ("order_code",)) for row in self.rows)
        yield from ((macro.name, ("order_code", "parts")) for macro in self.unlisted_macros)

    def about_parameter(self, parameter: Parameter) -> str:
        """Return the comment on a parameter."""
        return about_parameter(self.device, self.context.prefix, parameter)

    @property
    def has_rejecting_patterns(self) -> bool:
        """True if a pattern matches labels that are not an order code."""
        return any(pattern.order_code_index is None for pattern in self.label_patterns)

    def bits_of_open_parts(self, pattern: OpenCode) -> str:
        """Return the parts of an order code that a pattern leaves open, as bits in C, or ``0U`` if there are none.

        An example is ``ACME_X_UNLISTED_BITS | ACME_X_UNLISTED_CABLE``.
        """
        return " | ".join(map(self._unlisted_macro, pattern.unlisted)) or "0U"

    def _unlisted_macros(self) -> Iterator[CMacro]:
        """Yield a macro with a bit for each open part of the order code, except parts that no pattern describes."""
        unknown_names = unknown_parts(self.device)
        bit = 1
        for part in self.device.order_code.parts:
            if part.open and part.name not in unknown_names:
                yield CMacro(self._unlisted_macro(part.name), value=c_number(bit, hexadecimal=True), note=part.name)
                bit <<= 1

    def _unlisted_macro(self, part: str) -> str:
        """Return the macro of a part of the order code, such as ``ACME_X_UNLISTED_BITS``."""
        return f"{self.context.PREFIX}_UNLISTED_{part.upper()}"

    def _in_order_of_use(self) -> list[Parameter]:
        """Return the parameters with a formula (``equals``), each after those that its formula uses.

        Raises:
            LookupError: Parameters use each other in a cycle.
        """
        waiting = {parameter.name: parameter for parameter in self.device.parameters if parameter.equals is not None}
        ordered: list[Parameter] = []
        while waiting:
            ready = (parameter for parameter in waiting.values() if _needs_none_of(parameter, waiting.keys()))
            parameter = first_or_raise(ready, f"order in which to calculate {', '.join(waiting)}")
            ordered.append(waiting.pop(parameter.name))
        return ordered

    def _build_derived(self, parameter: Parameter) -> CFunction:
        """Return the function that computes a derived parameter."""
        assert parameter.equals is not None
        name = f"{self.context.prefix}_{parameter.name}"
        return number_function(
            self.context.translator,
            name=name,
            expression=parameter.equals,
            largest=parameter.largest,
            about=self.about_parameter(parameter),
        )

    def _build_row(self, variant: Variant) -> CodeRow:
        """Return an order code with its name in C, such as ``24_A`` for ``X-24/A`` of the family X.

        The name of the family is left out only if all order codes begin with it.
        """
        family = self.device.name.upper()
        order_code = variant.code.upper()
        begin_with_family = all(other.code.upper().startswith(family) for other in self.device.variants)
        if begin_with_family:
            # An order code that consists only of the name of the family keeps it.
            order_code = order_code.removeprefix(family) or order_code
        constant_name = re.sub("[^A-Z0-9]+", "_", order_code).strip("_")
        return CodeRow(
            variant=variant,
            name_in_macros=constant_name,
            macro=f"{self.context.PREFIX}_{constant_name}",
            values=tuple(_parameter_value(parameter, variant) for parameter in self.parameters),
        )


def _needs_none_of(parameter: Parameter, names: Set[str]) -> bool:
    """Return True if the expression of a derived parameter uses none of ``names``."""
    return parameter.equals is not None and names.isdisjoint(parameter.equals.parameters)


def _parameter_value(parameter: Parameter, variant: Variant) -> str:
    """Return a parameter of an order code, such as ``24U``. Codes are in hexadecimal, as in the manuals."""
    # A large number without a unit is a code, such as a profile ID.
    is_code = not parameter.unit and parameter.largest > 0xFF
    return c_number(variant.parameters.get(parameter.name, 0), hexadecimal=is_code, digits=4)


class LengthCode:
    """The macros for the lengths of the frames of one interface, by order code.

    There are none if a peripheral, such as a serial port, receives the frames.
    """

    def __init__(
        self, context: HeaderContext, interface: Interface, code_rows: Sequence[CodeRow], sample_row: CodeRow
    ) -> None:
        self.interface = interface
        self._context = context
        self._macro_prefix = f"{context.PREFIX}_"
        self._name_by_variant_id = {id(row.variant): row.name_in_macros for row in code_rows}
        #: The size of each received frame, for each order code.
        frame_sizes = list(received_sizes(context.device, interface))
        self.layout_names = tuple(dict.fromkeys(size.layout.name for size in frame_sizes))
        answers = chain.from_iterable(size.answers for size in frame_sizes)
        #: Names of the user's answers on which a length depends.
        self.answer_names = tuple(dict.fromkeys(answer.name for answer in answers))
        layouts_in_bytes = [size.layout for size in frame_sizes if size.layout.in_bytes]
        #: Macro for the number of bytes in a frame, empty if all frames are words.
        self.length_macro = context.length_macro(layouts_in_bytes[0]) if layouts_in_bytes else ""
        receiver_headers = {"receive_frame.h" if size.layout.in_bytes else "receive.h" for size in frame_sizes}
        #: Text with the names of the headers that receive words, bytes, or both.
        self.receiver_headers = " and ".join(sorted(receiver_headers))
        self.depends_on_registers = any(size.depends_on_registers for size in frame_sizes)
        #: Number of acknowledge bits that fit in a buffer, 0 if the interface has none.
        self.acknowledge_bits = BISS_ACKNOWLEDGE_BITS if isinstance(interface, Biss) else 0
        self.register_access_comment = "".join(_describe_register_access(context.device, interface, frame_sizes))
        #: Sizes for the order code in all samples.
        self._sample_sizes = [size for size in frame_sizes if size.variant is sample_row.variant]
        #: The macros of all frame sizes.
        self.macros = list(chain.from_iterable(map(self.macros_of, frame_sizes)))

    @property
    def receive_macro(self) -> str:
        """The macro that extracts a frame with the lengths of an order code. Empty unless there is only one frame."""
        return f"{self._macro_prefix}RECEIVE" if len(self.layout_names) == 1 else ""

    @property
    def about_code_argument(self) -> str:
        """Explain how the macro names an order code."""
        code = self.code_of(self._sample_sizes[0]) if self._sample_sizes else ""
        return f"For example, code can be {code}, as in {self._macro_prefix}{code}_BITS."

    def for_layout(self, layout: Layout) -> LengthCode:
        """Return a copy in which variables and arguments are for this frame, which is a word or bytes."""
        length_code = copy(self)
        length_code.length_macro = self._context.length_macro(layout) if layout.in_bytes else ""
        return length_code

    def variable_declaration(self, index: str = "") -> str:
        """Return the declaration of the variable that receives a frame, or of an array of frames with ``index``."""
        return f"uint8_t bytes{index}[{self.length_macro}]" if self.length_macro else f"uint64_t word{index}"

    def receiver_argument(self, index: str = "") -> str:
        """Return the last argument of a receiver that fills this variable."""
        return f"bytes{index}" if self.length_macro else f"&word{index}"

    def decoder_arguments(self, index: str = "") -> str:
        """Return the arguments of a decoder that takes this variable."""
        return f"bytes{index}, {self.length_macro}" if self.length_macro else f"word{index}"

    def code_of(self, size: FrameSize) -> str:
        """Return the part of a macro's name that stands for a frame of an order code, such as ``X24_POSITION_WIDE``.

        The name of the frame is included if there are several frames, and then the user's answers to open questions on
        which the length depends.
        """
        name_parts = [self._name_by_variant_id[id(size.variant)]]
        if len(self.layout_names) > 1:
            name_parts.append(size.layout.name)
        name_parts += [answer.name for answer in size.answers]
        return "_".join(name_parts).upper()

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names of its macros at file scope, each with the path of the interface in the spec."""
        path = ("interfaces", self.interface.name)
        for macro in self.macros:
            yield macro.name, path
        if self.receive_macro:
            yield self.receive_macro, path

    def macros_of(self, size: FrameSize) -> Iterator[CMacro]:
        """Yield the macros for the number of bits in a frame, and for the number of bytes in its buffer."""
        bits_comment = "number of bits in its frame"
        buffer_comment = "number of bytes in its buffer"
        frame_of_channels = channel_frame(self.interface)
        if frame_of_channels is not None:
            bits_of_channels = frame_of_channels.bits.value(size.variant.parameters)
            bits_comment = "number of bits in this data channel"
            buffer_comment = f"number of bytes in a buffer for all {bits_of_channels} bits of the frame"
        stem = f"{self._macro_prefix}{self.code_of(size)}"
        yield CMacro(f"{stem}_BITS", value=c_number(size.frame_bits), note=bits_comment)
        yield CMacro(f"{stem}_RX_BYTES", value=c_number(size.buffer_bytes), note=buffer_comment)


def _describe_register_access(device: Device, interface: Interface, sizes: Sequence[FrameSize]) -> Iterator[str]:
    """Yield the pieces of a text on when a BiSS master must set the control bit of a frame (CDM).

    The times apply to the shortest frame, at the highest and lowest clock, or else at the last clock in use. If the
    clock depends on the order code, they are in clock periods only. Nothing is yielded for other interfaces.
    """
    if not isinstance(interface, Biss) or not sizes:
        return
    shortest_bits = min(size.frame_bits for size in sizes)
    clock = interface.clock or Clock(source=())
    delay_text = f"{shortest_bits} clock periods after its CDS"
    if any(size.depends_on_registers for size in sizes):
        delay_text += f" with {words_for_initial_values(device)}"
    else:
        delay_text = f"at least {delay_text}"
    limits_hz = [limit_hz for limit_hz in (clock.max_hz, clock.min_hz) if limit_hz is not None]
    delays_at_clocks = []
    last_used_hz = clock.used_hz[-1:]
    for clock_hz in limits_hz or last_used_hz:
        delay_ns = shortest_bits * 1_000_000_000 // clock_hz
        delays_at_clocks.append(f"{nanoseconds(delay_ns)} at {hertz(clock_hz)}")
    if delays_at_clocks:
        delay_text += f": {' and '.join(delays_at_clocks)}"
    yield "For register access with codewheel/biss.h: the bit of cw_biss_master_next must be on MA before the last "
    yield f"clock of the same frame. It comes {delay_text}. The bit of "
    yield "cw_biss_master_next_late, for SPI and DMA, is needed before the next frame begins, since the SPI mode "
    yield "sends it. MA carries the inverse of the bit for the whole timeout"
    if interface.timeouts:
        yield f" ({timeouts_with_codes(interface.timeouts)})"
    yield "."
