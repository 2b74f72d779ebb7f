"""Order codes in C: variants with their parameters, also those in registers, and the lengths of frames."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence, Set
from copy import copy

from ...language.problems import listed
from ...model import Biss, Device, Interface, Layout, Parameter, Variant, assert_never, first_of
from ...model.record import dataclass
from ...plan.frames import BISS_ACKNOWLEDGE, FrameSize, HeldParameter, HoldingRegister, received
from ...plan.values import Raw, ZeroMeans, parameters_in_measurement, widest_value
from ...say.names_and_places import title
from ...say.order_code import initial
from ...say.text import hertz, nanoseconds, timeout_words
from .. import TargetError
from .about import about_order_codes, about_parameter
from .bits import of_bytes
from .context import Context, Function, Macro, number_of
from .names import Cast, Conditional, Declared, Expr, Name, Number, Operation, c_name, joined, number, unsigned
from .order_codes import OpenCode, open_codes, unknown_parts
from .registers import Access

#: Names of arguments and locals in the function that reads the registers.
_TAKEN = frozenset(("failure", "result", "taken", "transport", "variant"))


class HeldValue:
    """A parameter held by a register, and its local."""

    def __init__(self, context: Context, parameter_in_register: HeldParameter) -> None:
        parameter, field = parameter_in_register.parameter, parameter_in_register.field
        if not field.pieces:
            problem = f"the place of '{parameter.read_from}' depends on the order code; the C target cannot read it"
            raise TargetError(problem)
        self.held_parameter = parameter_in_register
        self.local = c_name(parameter.name, ("bytes", "length", "variant"))
        self.member = c_name(parameter.name)
        self.member_type = context.member_type(parameter)
        self.is_coded = bool(parameter.by_code)
        #: Locals in the order of their declarations, the last one with the value: type, name and initial value.
        self.locals = tuple(self._locals())
        self.type = self.locals[-1][0]

    @property
    def code(self) -> str:
        """Local with the code of the value."""
        return self.locals[-1][1]

    def for_code(self, code: int) -> str:
        """Return the value of the parameter for one of its codes."""
        value = self.held_parameter.parameter.held_value(code)
        assert value is not None
        return str(Number(value))

    def _locals(self) -> Iterator[tuple[str, str, Expr]]:
        type_, bits = of_bytes(self.held_parameter.bits.pieces)
        match self.held_parameter.meaning:
            case ZeroMeans(number):
                raw = Name(f"{self.local}_raw")
                yield type_, raw.text, bits
                chosen = Conditional(Operation("==", (raw, Number(0))), Number(number), raw)
                type_ = unsigned(widest_value(self.held_parameter.field))
                yield type_, self.local, Cast(type_, chosen)
            case Raw():
                yield type_, f"{self.local}_code" if self.is_coded else self.local, bits
            case meaning:
                assert_never(meaning)

    @property
    def is_outside(self) -> Expr | None:
        """Condition that the parameter cannot have the value, or None if it can have any value."""
        name, low, high = Name(self.local), self.held_parameter.low, self.held_parameter.high
        sides = (("<", low), (">", high))
        comparisons = tuple(Operation(sign, (name, Number(limit))) for sign, limit in sides if limit is not None)
        return joined("||", comparisons) if comparisons else None


@dataclass(frozen=True, slots=True)
class CodeSwitch:
    """The values for each code in a register field: the local with the code, and the assignments for each code."""

    local: str
    cases: tuple[tuple[str, tuple[tuple[str, str], ...]], ...]


def _switches(values: Sequence[HeldValue]) -> Iterator[CodeSwitch]:
    """Yield a switch for each field that holds a code. A code is valid if all parameters have it."""
    fields: dict[str, list[HeldValue]] = {}
    for value in values:
        if value.is_coded:
            fields.setdefault(value.held_parameter.parameter.read_from, []).append(value)
    for field_values in fields.values():
        common_codes = set.intersection(*map(_codes_of, field_values))
        cases = tuple(_switch_case(code, field_values) for code in sorted(common_codes))
        yield CodeSwitch(field_values[0].code, cases)


def _codes_of(value: HeldValue) -> set[int]:
    return {row.code for row in value.held_parameter.parameter.by_code}


def _switch_case(code: int, values: Sequence[HeldValue]) -> tuple[str, tuple[tuple[str, str], ...]]:
    """Return a code, and the assignments that it stands for."""
    return str(Number(code)), tuple((value.local, value.for_code(code)) for value in values)


class Taker:
    """The function that updates a variant from the content of a register."""

    def __init__(self, context: Context, register_parameters: HoldingRegister, access: Access) -> None:
        register = register_parameters.register
        self.name = f"{context.prefix}_take_{register.name}"
        names = listed(parameter.parameter.name for parameter in register_parameters.parameters)
        self.about = f"Update {names} in a variant from the content of the {title(register)} register."
        self.values = tuple(HeldValue(context, parameter) for parameter in register_parameters.parameters)
        self.switches = tuple(_switches(self.values))
        code_locals = {value.code for value in self.values if value.is_coded}
        unneeded = code_locals - {switch.local for switch in self.switches}
        #: Locals that the bits are read into, without further locals for the same code.
        self.locals = tuple(local for value in self.values for local in value.locals if local[1] not in unneeded)
        self.bytes = c_name(register.name, _TAKEN)
        self.access = access

    def declared(self) -> Iterator[Declared]:
        yield self.name, ()


@dataclass(frozen=True, slots=True)
class CodeRow:
    """An order code, its name in C with and without the prefix, and its values."""

    variant: Variant
    code: str
    macro: str
    values: tuple[str, ...]


class VariantCode:
    def __init__(self, context: Context) -> None:
        self.context, self.device = context, context.device
        self.parameters = self.device.set_parameters
        #: Without those that the functions of positions return.
        measured = parameters_in_measurement(self.device)
        self._named = [parameter for parameter in self._in_order_of_use() if parameter.name not in measured]
        self.derived: Sequence[Function] = [self._derived(parameter) for parameter in self._named]
        self.rows = [self._row(variant) for variant in self.device.variants]
        unknown = set(unknown_parts(self.device))
        left_open = [part for part in self.device.order_code.parts if part.open and part.name not in unknown]
        masks = [number(1 << index, hexadecimal=True) for index, _ in enumerate(left_open)]
        names = [part.name for part in left_open]
        self.unlisted = [Macro(self._unlisted(name), mask, name) for name, mask in zip(names, masks, strict=True)]
        self.patterns = open_codes(self.device)
        self.about = about_order_codes(self.device)

    def declared(self) -> Iterator[Declared]:
        yield self.context.prefix, ()
        for name in ("order_code", "order_codes", "find_order_code"):
            yield f"{self.context.prefix}_{name}", ()
        for parameter in self._named:
            yield f"{self.context.prefix}_{parameter.name}", ("parameters", parameter.name)
        yield from ((row.macro, ("order_code",)) for row in self.rows)
        yield from ((macro.name, ("order_code", "parts")) for macro in self.unlisted)

    def about_parameter(self, parameter: Parameter) -> str:
        return about_parameter(self.device, self.context.prefix, parameter)

    @property
    def refuses(self) -> bool:
        """True if a pattern matches labels that are not an order code."""
        return any(pattern.code is None for pattern in self.patterns)

    def bits(self, pattern: OpenCode) -> str:
        """Return the parts that a pattern leaves open."""
        return " | ".join(map(self._unlisted, pattern.unlisted)) or "0U"

    def _unlisted(self, part: str) -> str:
        return f"{self.context.PREFIX}_UNLISTED_{part.upper()}"

    def _in_order_of_use(self) -> list[Parameter]:
        """Return the derived parameters, each after those that it needs."""
        waiting = {parameter.name: parameter for parameter in self.device.parameters if parameter.equals is not None}
        ordered: list[Parameter] = []
        while waiting:
            ready = (parameter for parameter in waiting.values() if _needs_none_of(parameter, waiting.keys()))
            parameter = first_of(ready, f"order in which to calculate {', '.join(waiting)}")
            ordered.append(waiting.pop(parameter.name))
        return ordered

    def _derived(self, parameter: Parameter) -> Function:
        assert parameter.equals is not None
        name = f"{self.context.prefix}_{parameter.name}"
        return number_of(self.context.scope, name, parameter.equals, parameter.largest, self.about_parameter(parameter))

    def _row(self, variant: Variant) -> CodeRow:
        family, stem = self.device.name.upper(), variant.code.upper()
        if all(variant.code.upper().startswith(family) for variant in self.device.variants):
            stem = stem.removeprefix(family) or stem
        code = re.sub("[^A-Z0-9]+", "_", stem).strip("_")
        return CodeRow(
            variant=variant,
            code=code,
            macro=f"{self.context.PREFIX}_{code}",
            values=tuple(_value(parameter, variant) for parameter in self.parameters),
        )


def _needs_none_of(parameter: Parameter, names: Set[str]) -> bool:
    """Return True if the expression of a derived parameter uses none of these."""
    return parameter.equals is not None and names.isdisjoint(parameter.equals.parameters)


def _value(parameter: Parameter, variant: Variant) -> str:
    """Return a parameter of an order code. A code (no unit, above one byte) is in hexadecimal, as in the manuals."""
    return number(
        variant.parameters.get(parameter.name, 0), hexadecimal=not parameter.unit and parameter.largest > 0xFF, digits=4
    )


class LengthCode:
    """The lengths of one interface, empty if a peripheral receives its frames by itself."""

    def __init__(self, context: Context, interface: Interface, rows: Sequence[CodeRow], sample_row: CodeRow) -> None:
        self.interface = interface
        received_frames = list(received(context.device, interface))
        #: Names of the frames whose lengths these are.
        self.layouts = tuple(dict.fromkeys(frame.layout.name for frame in received_frames))
        #: Names of the answers on which a length depends.
        self.answers = tuple(dict.fromkeys(answer.name for frame in received_frames for answer in frame.answers))
        #: Macro of the bytes in a frame that is carried as bytes, empty for words.
        self.length = next(
            (context.length_macro(frame.layout) for frame in received_frames if frame.layout.in_bytes), ""
        )
        #: Names of the headers that receive words, bytes, or both.
        names = {True: "receive_frame.h", False: "receive.h"}
        kinds = sorted({frame.layout.in_bytes for frame in received_frames})
        self.receivers = " and ".join(names[in_bytes] for in_bytes in kinds)
        self._context = context
        self.depends_on_registers = any(frame.depends_on_registers for frame in received_frames)
        #: Number of acknowledge bits that fit in a buffer, 0 if the interface has none.
        self.acknowledge = BISS_ACKNOWLEDGE if isinstance(interface, Biss) else 0
        self.register_access = "".join(_register_access(context.device, interface, received_frames))
        self._codes = {id(row.variant): row.code for row in rows}
        self._prefix = f"{context.PREFIX}_"
        self._shown = next((frame for frame in received_frames if frame.variant is sample_row.variant), None)
        self.macros = [macro for frame in received_frames for macro in self.macros_of(frame)]

    @property
    def receive(self) -> str:
        """The macro that receives with the lengths of an order code, empty if there are several frames."""
        return f"{self._prefix}RECEIVE" if len(self.layouts) == 1 else ""

    @property
    def named(self) -> str:
        """Explain how the macro names an order code."""
        code = self.code_of(self._shown) if self._shown is not None else ""
        return f"For example, code can be {code}, as in {self._prefix}{code}_BITS."

    def for_layout(self, layout: Layout) -> LengthCode:
        """Return the same for one frame. Of an interface, some frames may be words, and others bytes."""
        of_layout = copy(self)
        of_layout.length = self._context.length_macro(layout) if layout.in_bytes else ""
        return of_layout

    def holder(self, index: str = "") -> str:
        """Declare the variable that receives a frame, or an array of them."""
        return f"uint8_t bytes{index}[{self.length}]" if self.length else f"uint64_t word{index}"

    def receiver_argument(self, index: str = "") -> str:
        """Return the last argument of a receiver that fills this variable."""
        return f"bytes{index}" if self.length else f"&word{index}"

    def decoder_arguments(self, index: str = "") -> str:
        """Return the arguments of a decoder that takes this variable."""
        return f"bytes{index}, {self.length}" if self.length else f"word{index}"

    def code_of(self, frame: FrameSize) -> str:
        """Return the name of an order code in names of lengths, with the answers on which these depend."""
        names = [frame.layout.name] if len(self.layouts) > 1 else []
        return "_".join((self._codes[id(frame.variant)], *names, *(answer.name for answer in frame.answers))).upper()

    def declared(self) -> Iterator[Declared]:
        names = (*(macro.name for macro in self.macros), self.receive)
        yield from ((name, ("interfaces", self.interface.name)) for name in names if name)

    def macros_of(self, frame: FrameSize) -> Iterator[Macro]:
        """Yield the macros of the number of bits and of the bytes of a buffer."""
        stem = f"{self._prefix}{self.code_of(frame)}"
        yield Macro(f"{stem}_BITS", number(frame.bits), "number of bits in its frame")
        yield Macro(f"{stem}_RX_BYTES", number(frame.bytes), "number of bytes in its buffer")


def _register_access(device: Device, interface: Interface, frames: Sequence[FrameSize]) -> Iterator[str]:
    """Yield the deadlines for the control bit of a master, with the numbers of the family, if the interface is BiSS."""
    if not isinstance(interface, Biss) or not frames:
        return
    bits, clock = min(frame.bits for frame in frames), interface.clock
    after = f"{bits} clock periods after its CDS"
    depends_on_registers = any(frame.depends_on_registers for frame in frames)
    after = f"{after} with {initial(device)}" if depends_on_registers else f"at least {after}"
    limits = [hz for hz in (clock.max_hz, clock.min_hz) if hz is not None]
    clocks = limits or clock.used_hz[-1:]
    times = " and ".join(f"{nanoseconds(bits * 1_000_000_000 // hz)} at {hertz(hz)}" for hz in clocks)
    times_text = f": {times}" if times else ""
    yield "For register access with codewheel/biss.h: the bit of cw_biss_master_next must be on MA before the last "
    yield f"clock of the same frame. It comes {after}{times_text}. The bit of "
    yield "cw_biss_master_next_late, for SPI and DMA, is needed before the next frame begins, since the SPI mode "
    yield "sends it. MA carries the inverse of the bit for the whole time-out"
    if interface.timeout is not None:
        yield f" ({timeout_words(interface.timeout)})"
    yield "."
