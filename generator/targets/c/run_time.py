"""Parameters that registers hold at run time: the functions that update a variant from the bytes of a register."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...language.problems import listed
from ...model import assert_never
from ...model.record import dataclass
from ...plan.registers import HeldParameter, HoldingRegister
from ...plan.values import Raw, ZeroMeans, widest_value
from ...say.names_and_places import title
from .. import TargetError
from .access import Access
from .bits import of_bytes
from .context import Context
from .expr import Cast, Conditional, Expr, Name, Number, Operation, joined
from .names import Declared
from .reserved import c_name
from .types import unsigned

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
