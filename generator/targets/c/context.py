"""The context of every part of a header: device, prefix, enumerations, and the spelling of parameters."""

from __future__ import annotations

from ...model import Crc, Device, Layout, Parameter, Register, RegisterMeaning
from ...model.expressions import Expression
from ...plan.crcs import carriers
from ...plan.registers import held_parameters
from .enumerations import AlternativeCode, Enumerations
from .expr import Scope, unsigned
from .reports import Reports


class Context:
    """The values that all parts of the headers of an interface share. The class imports no part, and its values never
    change.

    The device has only this interface. ``prefix`` begins every name, and is the type of the order codes.
    """

    def __init__(self, device: Device) -> None:
        self.device = device
        self.maker = device.manufacturer
        (self.interface,) = device.interfaces
        self.stem = f"{device.name}_{self.interface.name}"
        self.prefix = f"{device.manufacturer.name}_{self.stem}"
        self.PREFIX = self.prefix.upper()
        open_questions = (alternative for alternative in device.alternatives if not alternative.default)
        self.alternatives = tuple(AlternativeCode(device, self.prefix, question) for question in open_questions)
        largest = {parameter.name: parameter.largest for parameter in device.set_parameters}
        for group in held_parameters(device):
            for held_parameter in group.parameters:
                name = held_parameter.parameter.name
                if name in largest:
                    largest[name] = max(largest[name], held_parameter.highest_value)
        answers = {name: code.argument for code in self.alternatives for name in code.item.answers[0].sets}
        self.scope = Scope(self.prefix, largest, answers)
        self.enumerations = Enumerations(device, self.prefix)
        self.choices = self.enumerations.choices
        self.reports = Reports(device, self.prefix, self.choices)

    def crc_name(self, crc: Crc, carried_as: str) -> str:
        """Return the name of the function of a CRC over bits or bytes. A CRC needed for both has two functions."""
        also = carried_as == "bits" and len(carriers(self.device, crc)) > 1
        return f"{self.prefix}_crc_{crc.name}" + ("_bits" if also else "")

    def length_macro(self, layout: Layout) -> str:
        return f"{self.PREFIX}_{layout.name}_LENGTH".upper()

    def limit(
        self,
        register: Register,
        meaning: RegisterMeaning | None,
        side: str,
        limit: Expression,
        variant: str = "variant",
    ) -> str:
        """Return a limit of a register, or of one of its meanings: a macro if it is the same for all order codes."""
        name = f"{self.prefix}_reg_{register.name}" + (f"_{meaning.name}" if meaning is not None else "") + f"_{side}"
        return name.upper() if limit.is_constant else f"{name}({variant})"

    def member_type(self, parameter: Parameter) -> str:
        """Return the type of a parameter in the variant."""
        return unsigned(self.scope.largest[parameter.name].bit_length())
