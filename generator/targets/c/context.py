"""The context of every part of a header, and the constants that a part declares."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Crc, Device, Layout, Parameter, Register, RegisterMeaning, Timing
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.crcs import kinds_of_covered_data
from ...plan.frames import held_parameters
from ...say.order_code import describe_timing as say_timing
from .comments import HEADER_STYLE
from .enumerations import AlternativeCode, Enumerations
from .expressions import BY_VALUE, ParameterSpelling, StructPassing
from .names import c_number, unsigned
from .reports import Reports


class HeaderContext:
    """The values that all parts of the headers of one interface share, such as the prefix of the names.

    ``device`` must have only this interface. ``prefix`` begins every name, and is also the name of the type that holds
    an order code (the variant). The values never change.
    """

    def __init__(self, device: Device, passing: StructPassing = BY_VALUE) -> None:
        self.device = device
        self.passing = passing
        self.maker = device.manufacturer
        # The device was narrowed to one interface.
        (self.interface,) = device.interfaces
        self.stem = f"{device.name}_{self.interface.name}"
        self.prefix = f"{device.manufacturer.name}_{self.stem}"
        self.PREFIX = self.prefix.upper()
        #: The questions that the manual leaves open, which users must answer, since there is no default.
        open_questions = (alternative for alternative in device.alternatives if not alternative.default)
        self.alternatives = tuple(AlternativeCode(device, self.prefix, question) for question in open_questions)
        argument_by_parameter: dict[str, str] = {}
        for alternative in self.alternatives:
            # All answers of an alternative set the same parameters.
            argument_by_parameter |= dict.fromkeys(alternative.alternative.answers[0].sets, alternative.argument)
        self.scope = ParameterSpelling(
            prefix=self.prefix, largest=_largest_values(device), answers=argument_by_parameter, passing=passing
        )
        self.enumerations = Enumerations(device, self.prefix)
        self.choices = self.enumerations.choices
        self.reports = Reports(device, self.prefix, self.choices, self.scope)

    def crc_name(self, crc: Crc, carried_as: str) -> str:
        """Return the name of the function that computes a CRC over ``bits`` or over ``bytes`` (``carried_as``).

        If frames need the CRC over both, there are two functions, and the one over bits ends in ``_bits``.
        """
        is_second_function = carried_as == "bits" and len(kinds_of_covered_data(self.device, crc)) > 1
        ending = "_bits" if is_second_function else ""
        return f"{self.prefix}_crc_{crc.name}{ending}"

    def length_macro(self, layout: Layout) -> str:
        """Return the macro for the number of bytes in a frame."""
        return f"{self.PREFIX}_{layout.name}_LENGTH".upper()

    def limit(
        self,
        register: Register,
        meaning: RegisterMeaning | None,
        side: str,
        limit: Expression,
        variant: str = "variant",
    ) -> str:
        """Return the C expression of a limit of a register: a macro if the limit is the same for all order codes.

        Otherwise it is a call such as ``acme_x_reg_preset_max(variant)``. ``side`` is ``min`` or ``max``. A ``meaning``
        is one of several uses of the register, with its own limits, and None stands for the register itself.
        """
        stem = f"{self.prefix}_reg_{register.name}"
        name = f"{stem}_{side}" if meaning is None else f"{stem}_{meaning.name}_{side}"
        return name.upper() if limit.is_constant else f"{name}({variant})"

    def member_type(self, parameter: Parameter) -> str:
        """Return the type of a parameter in the variant."""
        return unsigned(self.scope.largest[parameter.name].bit_length())


def _largest_values(device: Device) -> dict[str, int]:
    """Return the highest value of each parameter that order codes set.

    If a register of the encoder can change the parameter, the highest value that the register can have counts, too.
    """
    largest = {parameter.name: parameter.largest for parameter in device.set_parameters}
    for holding_register in held_parameters(device):
        for held_parameter in holding_register.parameters:
            name = held_parameter.parameter.name
            if name in largest:
                largest[name] = max(largest[name], held_parameter.highest_value)
    return largest


@dataclass(frozen=True, slots=True)
class CMacro:
    """A macro with its value. ``note`` is the comment at the end of its line, empty if it needs none."""

    name: str
    value: str
    note: str = ""


def timing_macros(timing: Timing, stem: str) -> Iterator[CMacro]:
    """Yield a macro for each bound of a time that the manual gives, in microseconds: ``ACME_X_STARTUP_AT_MOST_US``.

    The comment on the first macro describes the time, and the comments on the others refer to it.
    """
    note = HEADER_STYLE.sentence(say_timing(timing))
    bounds = {"AT_LEAST": timing.at_least_us, "TYPICAL": timing.typical_us, "AT_MOST": timing.at_most_us}
    for bound, value in bounds.items():
        if value is not None:
            yield CMacro(f"{stem}_{timing.name}_{bound}_US".upper(), value=c_number(value), note=note)
            note = f"see {timing.name} above"


def scale_macros(layout: Layout, stem: str) -> Iterator[CMacro]:
    """Yield the macros that convert fields with a scale to their unit, such as a temperature to degrees.

    Their values have 64 bits, so that no product overflows.
    """
    for field in layout.fields:
        scale = field.scale
        name = f"{stem}_{field.name}".upper()
        if scale is not None:
            note = f"{field.name} in {scale.unit}: ({field.name} * NUMERATOR + OFFSET) / DENOMINATOR"
            yield CMacro(f"{name}_NUMERATOR", value=f"INT64_C({scale.numerator})", note=note)
            magnitude = f"INT64_C({abs(scale.offset)})"
            offset = f"(-{magnitude})" if scale.offset < 0 else magnitude
            yield CMacro(f"{name}_OFFSET", offset)
            yield CMacro(f"{name}_DENOMINATOR", f"INT64_C({scale.denominator})")
