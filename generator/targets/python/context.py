"""Names in a device module, shared by all of its parts."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from ...model import Alternative, Crc, Device, Field, Layout, Register
from ...model.record import dataclass
from ...plan.crcs import Carrier, CrcFunction, carriers, crc_functions
from ...plan.values import is_named, meaning_of
from ...plan.verdicts import Reporting, reportings
from ...say.text import sentence
from .expr import Scope
from .names import (
    BISS,
    CLASS_NAMES,
    FOLDERS,
    IMPORTED,
    LOCAL_NAMES,
    MODULE_NAMES,
    SHARED,
    VARIANT_NAMES,
    Names,
    attribute,
    camel,
)

_Values = tuple[str, tuple[tuple[str, int], ...]]


def byte_order(owner: Layout | Register) -> str:
    """Return the name that Python uses for the byte order."""
    return "little" if owner.byte_order == "low_byte_first" else "big"


def is_one_choice(register: Register) -> bool:
    """Return whether a register consists only of one choice among named values."""
    only = register.layout.fields[0]
    return bool(register.values) and is_named(meaning_of(only)) and only.width == register.layout.bits


def _values(field: Field) -> _Values:
    return field.name, tuple((value.name, value.value) for value in field.values)


def _runs(field: Field) -> list[str]:
    return [run.name for run in field.runs]


@dataclass(frozen=True)
class OpenQuestion:
    """Question that the manual leaves open, as an argument ``name`` whose values are members of the Enum ``kind``.

    ``members`` are the parameters that an answer sets, with their attribute names in the Enum.
    """

    alternative: Alternative
    kind: str
    name: str
    members: tuple[tuple[str, str], ...]

    @property
    def about(self) -> str:
        """Description of the argument for functions that decode several kinds of frames."""
        return f"{sentence(self.alternative.meaning)} Required only for frames that depend on it."


class Context:
    """Device with the names in its module, in the order in which they are assigned."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self.module = attribute(device.name, (*SHARED, *FOLDERS, BISS))
        self.parameters = {parameter.name: attribute(parameter.name, VARIANT_NAMES) for parameter in device.parameters}
        names = Names([*MODULE_NAMES, *IMPORTED])
        self.crcs = {crc.name: names.take(f"crc_{crc.name}", "_") for crc in device.crcs}
        self.frames = {layout.name: names.take(camel(layout.name), "Frame") for _, layout in device.layouts()}
        self.registers = {register.name: names.take(camel(register.name), "Register") for register in device.registers}
        procedures = [procedure.name for procedure in device.procedures]
        self.procedures = {name: names.take(attribute(name), "_steps") for name in procedures}
        self.questions = {question.name: self._open_question(question, names) for question in device.alternatives}
        required = [question for question in self.questions.values() if not question.alternative.default]
        answered = {name: f"{question.name}.{member}" for question in required for name, member in question.members}
        self.scope = Scope({**self.scope_of("variant").names, **answered})
        self._enums = {key: names.take(camel(field.name), "Value") for key, field in self.choices.items()}

    def scope_of(self, owner: str) -> Scope:
        """Return the parameters as attributes of ``owner``."""
        return Scope({name: f"{owner}.{member}" for name, member in self.parameters.items()})

    def _open_question(self, alternative: Alternative, names: Names) -> OpenQuestion:
        layouts = [layout for layout in self.coded_layouts() if alternative in self.device.alternatives_of(layout)]
        frame_names = {name for layout in layouts for field in layout.fields for name in (field.name, *_runs(field))}
        frame_names |= {join.name for layout in layouts for join in layout.joins}
        members = [(name, attribute(name, ("name", "value"))) for name in alternative.answers[0].sets]
        name = attribute(alternative.name, (*frame_names, *CLASS_NAMES, *LOCAL_NAMES, "frame"))
        return OpenQuestion(alternative, names.take(camel(alternative.name), "Alternative"), name, tuple(members))

    def questions_of(self, layout: Layout) -> list[OpenQuestion]:
        """Return the questions that must be answered to decode or encode a frame of this layout."""
        return [self.questions[alternative.name] for alternative in self.device.alternatives_of(layout)]

    @cached_property
    def choices(self) -> dict[_Values, Field]:
        """Fields with named values. Those with the same name and values share an IntEnum."""
        fields_by_values: dict[_Values, Field] = {}
        for layout in self.coded_layouts():
            for field in layout.fields:
                if is_named(meaning_of(field)):
                    fields_by_values.setdefault(_values(field), field)
        return fields_by_values

    def coded_layouts(self) -> Iterator[Layout]:
        """Yield the layouts that have a class: all but those of registers that are an IntEnum."""
        yield from (layout for _, layout in self.device.layouts())
        yield from (register.layout for register in self.device.registers if not is_one_choice(register))

    @cached_property
    def reportings(self) -> dict[str, Reporting]:
        """Reports and verdicts of frames, by the name of the frame."""
        return {reporting.codec.layout.name: reporting for reporting in reportings(self.device)}

    def enum(self, field: Field) -> str:
        return self._enums[_values(field)]

    @cached_property
    def crc_functions(self) -> dict[str, CrcFunction]:
        """Functions that compute CRCs, by name."""
        return {self.crc_name(function.crc, function.carrier): function for function in crc_functions(self.device)}

    def crc_name(self, crc: Crc, carrier: Carrier) -> str:
        return self.crcs[crc.name] + ("_of_bits" if carrier is Carrier.BITS and crc in self._crcs_of_both else "")

    @cached_property
    def _crcs_of_both(self) -> list[Crc]:
        """CRCs over frames of bits and over frames of bytes."""
        return [crc for crc in self.device.crcs if len(carriers(self.device, crc)) > 1]
