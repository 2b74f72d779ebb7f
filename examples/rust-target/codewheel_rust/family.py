"""A family for the templates: the plan of its parts, and the name of each in Rust."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from codewheel.model import Answer, Device, Field, Interface, Layout, Register, Value
from codewheel.plan.codec import LayoutPlan, characters, layout_plan_of
from codewheel.plan.crcs import CrcFunction, crc_functions, function_of
from codewheel.plan.frames import dispatches, held_parameters
from codewheel.plan.limits import NumberLimits, limits_of
from codewheel.plan.operations import AlwaysIs, ConstantNumber, FieldBits, FieldToEncode, ParityIs, ParityOf
from codewheel.plan.values import Latin1Text, meaning_of
from codewheel.plan.verdicts import VerdictRules, reportings
from codewheel.targets import TargetProblem

from .names import OF_CODE, OF_MODULE, OF_STRUCT, Names, Place, constant, pascal, snake
from .spelling import type_of

WORD = 64


@dataclass(frozen=True)
class Enum:
    """The named values of a choice, as a type."""

    name: str
    values: tuple[Value, ...]


@dataclass(frozen=True)
class Struct:
    """A frame or register as a type. ``enums`` has the type of each member that is a choice.

    ``code`` is the type of the order codes of its interface. ``position_member`` is the member with the position
    if there is a ``verdict_rules`` on it, or empty.
    """

    layout: Layout
    code: str
    codec: LayoutPlan
    crcs: Mapping[str, CrcFunction]
    enums: Mapping[str, Enum]
    register: Register | None = None
    limits: NumberLimits | None = None
    receiver: str = ""
    verdict_rules: VerdictRules | None = None
    position_member: str = ""

    @property
    def bits_to_decode(self) -> dict[str, FieldBits]:
        """Return the fields whose bits the decoder needs, by name. Constants in bytes are checked byte by byte."""
        bits_by_name = {part.field.name: part.bits for part in self.codec.decoded_fields if not characters(part.field)}
        for check in self.codec.checks:
            if not isinstance(check, AlwaysIs) or self.codec.by_word:
                bits_by_name[check.field.name] = check.bits
            if isinstance(check, ParityIs):
                covered_names = [covered.name for covered in check.covered_fields]
                bits_by_name |= dict(zip(covered_names, check.covered_bits, strict=True))
        return bits_by_name

    @property
    def encoded_terms(self) -> list[FieldToEncode]:
        """Return the fields encoded as numbers, without zeros, the CRC and copied texts. Parity bits are last."""
        nonzero_terms = [term for term in self.codec.encoded_fields if term.value != ConstantNumber(0)]
        terms = [term for term in nonzero_terms if not characters(term.field)]
        return sorted(terms, key=lambda term: isinstance(term.value, ParityOf))

    def type_of(self, field: Field) -> str:
        """Return the type of a member."""
        return self.enums[field.name].name if field.name in self.enums else type_of(field)

    @property
    def is_joined(self) -> bool:
        """True if the position is several fields together."""
        return self.position_member in {join.name for join in self.layout.joins}

    @property
    def position_type(self) -> str:
        """Return the type of the position."""
        return "u64" if self.is_joined else self.type_of(self.layout.field(self.position_member))

    @property
    def is_extracted(self) -> bool:
        """True if the frame is bits in a buffer, which a receiver extracts."""
        return self.receiver in ("biss", "ssi") or (self.receiver == "spi" and not self.codec.in_bytes)

    def allows_only(self, field: Field, values: Iterable[int]) -> bool:
        """Return whether the type of a member already excludes every other value."""
        return field.name in self.enums and {value.value for value in field.values} == set(values)

    def width_problems(self) -> Iterator[str]:
        """Yield the layouts that must fit into a word, but do not."""
        if self.codec.by_word and self.layout.widest > WORD:
            yield f"'{self.layout.name}' has {self.layout.widest} bits, and fields that move with the order code"
        for field in self.layout.fields:
            if isinstance(meaning_of(field), Latin1Text) and field.widest > WORD and not characters(field):
                yield f"'{field.name}' has {field.widest} bits, which do not fill bytes"


class Family:
    """Types, functions and constants of a family. ``problems`` lists those that it cannot have."""

    def __init__(self, device: Device) -> None:
        self.device, self._scopes, self._wide = device, list[Names](), list[TargetProblem]()
        self._top = self._scope(OF_MODULE)
        self.interfaces = {
            self._top.give(pascal(item.name), "interfaces", item.name): item for item in device.interfaces
        }
        self._inner = self._scope((*OF_MODULE, *self.interfaces))
        codes, methods = self._scope(OF_CODE), self._scope(OF_CODE)
        self._judgements = {name: reporting.verdict_rules for name, reporting in reportings(device).items()}
        self.codes = {variant.code: codes.give(constant(variant.code), "order_code") for variant in device.variants}
        self.held = tuple(held_parameters(device))
        for held_register in self.held:
            methods.give(f"with_{held_register.register.name}", "registers", held_register.register.name)
        self.answers: dict[str, Answer] = {}
        for alternative in device.alternatives:
            for answer in alternative.answers:
                self.answers[methods.give(snake(f"{alternative.name}_{answer.name}"), "alternatives")] = answer
        for name in (parameter.name for parameter in device.parameters if parameter.equals is not None):
            methods.give(snake(name), "parameters", name)
        functions = crc_functions(device)
        self.crcs = {function: self._top.give(crc_name(function), "crcs", function.crc.name) for function in functions}
        self.enums, self.register_enums = list[Enum](), list[Enum]()
        self.frames = [(interface, self._frame(interface, layout)) for interface, layout in device.layouts()]
        self.registers = [self._register(register) for register in device.registers]
        interfaces = device.interfaces
        self.dispatches = [(interface, frames) for interface in interfaces for frames in dispatches(interface.layouts)]
        for interface, frames in self.dispatches:
            self._top.give(pascal(f"{interface.name}_from_{frames.sender}"), "interfaces", interface.name)

    @property
    def problems(self) -> list[TargetProblem]:
        return [*(problem for scope in self._scopes for problem in scope.problems), *self._wide]

    def _scope(self, reserved_words: tuple[str, ...]) -> Names:
        self._scopes.append(Names(self.device, reserved_words))
        return self._scopes[-1]

    def _frame(self, interface: Interface, layout: Layout) -> Struct:
        """Return the types of a frame. Frames of an interface share the type of a choice with the same values."""
        fields = [field for sibling in interface.layouts for field in sibling.data_fields]
        owners = {}
        for field in layout.data_fields:
            is_shared = all(namesake.values == field.values for namesake in fields if namesake.name == field.name)
            owners[field.name] = interface.name if is_shared else layout.name
        place = ("interfaces", interface.name, "layouts", layout.name)
        struct = self._struct(self._top, self.enums, place, layout, owners, interface.name)
        rules = self._judgements.get(layout.name)
        measurement = self.device.measurement_of(interface.name)
        if rules is None or measurement is None or measurement.position_name not in layout.member_names:
            return struct
        return replace(struct, receiver=interface.name, verdict_rules=rules, position_member=measurement.position_name)

    def _register(self, register: Register) -> Struct:
        owners = {register_field.name: register.name for register_field in register.layout.fields}
        place = ("registers", register.name)
        struct = self._struct(self._inner, self.register_enums, place, register.layout, owners, register.interface)
        return replace(struct, register=register, limits=limits_of(self.device, register))

    def _struct(
        self, names: Names, enums: list[Enum], place: Place, layout: Layout, owners: dict[str, str], interface: str
    ) -> Struct:
        choices = [field for field in layout.data_fields if field.values]
        types = {field.name: Enum(pascal(f"{owners[field.name]}_{field.name}"), field.values) for field in choices}
        for enum in types.values():
            if enum not in enums:
                enums.append(enum)
                names.give(enum.name, *place)
        names.give(pascal(layout.name), *place)
        methods = self._scope(OF_STRUCT)
        runs = [run.name for field in layout.fields for run in field.runs]
        for name in [*(join.name for join in layout.joins), *runs]:
            methods.give(snake(name), *place)
        codec = layout_plan_of(self.device, layout)
        crcs = {crc.field.name: function_of(self.device, layout, crc.crc) for crc in codec.crcs}
        struct = Struct(layout, pascal(interface), codec, crcs, types)
        for problem in struct.width_problems():
            self._wide.append(TargetProblem(self.device, "rust-size", place, f"{problem}. Rust allows at most {WORD}"))
        parity = "a parity bit over Gray code" if codec.parity_covers_converted else ""
        parity = "a flag that order codes lack" if layout.has_optional_flags else parity
        orders = "two byte orders, and fields that move" if codec.by_word and layout.exchanged_bytes else ""
        digits = "digits that are sent separately" if codec.digit_codings else orders
        for rule, part in {"rust-parity": parity, "rust-digits": digits}.items():
            problem = f"'{layout.name}' has {part}, which this target does not compute"
            self._wide += [TargetProblem(self.device, rule, place, problem)] if part else []
        return struct


def crc_name(function: CrcFunction) -> str:
    """Return the name of the function for a CRC."""
    return f"crc_{function.crc.name}" + ("" if function.is_only_function else f"_{function.covered_data.value}")
