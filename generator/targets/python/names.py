"""Names in a device module, shared by all of its parts, and the imports of those that its code uses."""

from __future__ import annotations

import ast
import keyword
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from functools import cached_property

from ...model import Alternative, Crc, Device, Digits, Field, Layout, Register, RegisterMeaning
from ...model.record import dataclass
from ...plan.crcs import CoveredData, CrcFunction, crc_functions, kinds_of_covered_data
from ...plan.values import is_named, meaning_of
from ...plan.verdicts import ReportsAndVerdict, reportings
from ...say.text import as_sentence
from .literals import ExpressionTranslator, coded

#: Names that can be imported, by the module that has them: ``{"enum": ("Enum", "IntEnum")}``.
Sources = Mapping[str, Sequence[str]]
#: Groups of imports, separated by blank lines. Each import is a module and the names from it.
Imports = list[list[tuple[str, list[str]]]]


def imports_of(module_code: str, *groups: Sources) -> Imports:
    """Return the imports that the code of a module needs, in groups: ``[[("enum", ["Enum", "IntEnum"])], …]``.

    ``groups`` are the names that can be imported, such as names of the standard library and of the package. Groups
    without imports are left out.
    """
    used_names = {node.id for node in ast.walk(ast.parse(module_code)) if isinstance(node, ast.Name)}
    imports_by_group = (list(_used_imports(sources, used_names)) for sources in groups)
    return [imports for imports in imports_by_group if imports]


def _used_imports(sources: Sources, names_in_code: Set[str]) -> Iterator[tuple[str, list[str]]]:
    """Yield each module with its names that the code uses, without modules of which it uses none."""
    for module, names in sources.items():
        used_names = [name for name in names if name in names_in_code]
        if used_names:
            yield module, used_names


#: Names that a device module can import, by source module.
STANDARD: Mapping[str, tuple[str, ...]] = {
    "collections.abc": ("Callable", "Mapping"),
    "enum": ("Enum", "IntEnum"),
    "functools": ("lru_cache",),
    "operator": ("index",),
    "typing": (
        *(
            "TYPE_CHECKING",
            "Any",
            "ClassVar",
            "Final",
            "NamedTuple",
            "TypeAlias",
            "TypeVar",
            "Union",
            "cast",
            "overload",
        ),
    ),
}


def _runtime_modules(names: Mapping[str, str]) -> Mapping[str, tuple[str, ...]]:
    """Return the names to import from each module of the runtime. ``names`` contains them as one text per module."""
    return {f"codewheel_runtime.{module}": tuple(text.split()) for module, text in names.items()}


PACKAGE: Mapping[str, tuple[str, ...]] = _runtime_modules(
    {
        "codec": """BitField Data PositionRange Rows Word Words as_bytes as_member as_word check_kind check_limits
            check_signed check_width crc_by_xor crc_of_bits crc_of_bytes create_tuple exchange_bytes from_digits
            from_gray make_crc_tables require_answer signed text_number too_long_error wrong_answer_error zero_for""",
        "encoder": """Encoder ErrorHandler Exchanged Positioned SerialEncoder check_encoder load_fact look_up
            raise_frame_error return_frame_error wrong_encoder_error""",
        "measures": "FineLinear Linear Rotary Wrapping",
        "errors": "ConstantError CrcError FrameError LengthError RangeError",
        "frames.base": """BitsOf BytesOf FixedBits FixedBytes FixedLimitedRegister FixedRegister ForEncoder InBits
            InBytes LimitedRegisterOf RegisterOf Sent decode_frames encode_columns keep_bytes""",
        "frames.decoders": "cached_decoder raise_error",
        "frames.descriptions": "layout_of",
        "registers": """RegisterParameter bytes_by_address encode_register format_parameters is_consistent
            read_parameters""",
        "reports": "Family Interface Movement ReadOnly Report Verdict",
        "channels": "ChannelLayout Compared",
        "spi": "Pipeline",
        "steps": "Modify Poll Read Send Step Verify Wait write_bytes write_whole",
    }
)

#: Names that the facts of a device can import, by source module.
FACTS: Mapping[str, tuple[str, ...]] = _runtime_modules(
    {
        "facts": """AboveMax Access Alarm Alignment BissFacts ByteOrder CableLength Characteristic Clock Connector
        ConnectorKind Contact ControlField Crc DataChannels DataIdFacts Document Edition Erratum Exchange
        FieldFacts Input Led LedState LostFigure Manual MemoryAccess NamedValue Network Port PrintedTimeout
        Purpose Quantity Register RegisterMeaning Revision Rs485Facts Scale Severity SpiFacts SsiFacts Status Table
        Timeout TimeoutRule Timing""",
        "order_codes": "OrderCode Part PartValue SpelledValue Spelling",
        "reports": "Interface ReadOnly Report Reports Verdict",
    }
)

#: Names that the descriptions of frames can import, by source module.
SHAPES: Mapping[str, tuple[str, ...]] = {
    "codewheel_runtime.bulk.shape": tuple(
        """Check Column CrcOf DigitCoding Fold FrameLayout Join ReportCause Unused VerdictCause compare_bits
        compare_bytes""".split()
    ),
    "codewheel_runtime.codec": ("BitField",),
    "codewheel_runtime.errors": ("ErrorKind",),
    "codewheel_runtime.reports": ("Verdict",),
}

#: Modules of the package that do not belong to a device.
SHARED = ("__main__", "_codes")
#: Subpackages whose modules, one per device, are loaded on first use.
FOLDERS = ("facts", "_shapes")
#: Module for register access over BiSS, in packages with a BiSS family.
BISS = "biss"

#: All names that a device module or its descriptions can import.
IMPORTED = [name for module in (STANDARD, PACKAGE, SHAPES) for names in module.values() for name in names]
#: Functions that a device module can import.
FUNCTIONS = ("cast", "index", *(name for names in PACKAGE.values() for name in names if name.islower()))
#: Names that every device module uses in addition to its imports.
MODULE_NAMES = """ALARMS Address ArithmeticError BISS BissEncoder CHARACTERISTICS CONNECTORS CRCS DOCUMENTS
    ERRATA Ellipsis Exception FAMILY FRAMES Frame INPUTS LEDS LOST_FIGURES MANUAL NotImplemented
    ORDER_CODE REGISTERS REPORTS RS485 Reply Request Rs485Encoder SPI SSI SpiEncoder SsiEncoder TABLES TIMINGS TypeError
    VARIANTS ValueError Variant Warning annotations decode_reply decode_request identify isinstance len
    lookup type""".split()
#: Names that the class of the variants uses.
VARIANT_NAMES = """bytes clock cls code counts_per_turn decode decode_many degrees encode_many exchanges family
    frame_bits from_degrees from_millimetres from_radians from_turns highest interface lowest metres micrometres
    millimetres modulus nanometres parts per_counts pipeline radians range_of self special special_code step_nm
    step_um tail timeout try_decode turns unlisted unwrap with_answers with_registers written_as_in""".split()
#: Names that the generated classes and their methods use.
CLASS_NAMES = """bit_fields check_width cls count decode decode_many encode encode_many frame_bits index
    is_as_documented limits reports self to_dict usable_position variant verdict""".split()
LOCAL_NAMES = [
    *"bits cls computed_crc difference data decode decode_frame exception expected_parity frame frame_bits".split(),
    *"handle_error high_bits isinstance len length low_bits number padding received_crc self sent type unused".split(),
    *"valid_first_bytes values variant word".split(),
    *(f"b{place}" for place in range(16)),
    *(f"table_{place}" for place in range(16)),
    *FUNCTIONS,
]
#: Names that the functions of procedures use. An argument with such a name gets a trailing underscore.
PROCEDURE_NAMES = (*FUNCTIONS, "dict", "enumerate", "first_steps", "isinstance", "register_bytes", "variant")

#: Built-ins that the generated classes use in their bodies, where a field with the same name would hide them. A
#: NamedTuple does not allow ``super``.
_BUILT_IN = frozenset("bool bytes classmethod float int isinstance property staticmethod str super tuple".split())


def python_name(name: str, reserved_names: Iterable[str] = ()) -> str:
    """Return the name of an attribute or argument. The name has a trailing underscore if it is reserved."""
    return f"{name}_" if keyword.iskeyword(name) or name in _BUILT_IN or name in reserved_names else name


def in_camel_case(name: str) -> str:
    """Return ``single_cycle_data`` as ``SingleCycleData``."""
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


def encoder_name(interface: str) -> str:
    """Return the encoder class for an interface."""
    return f"{interface.capitalize()}Encoder"


def interface_name(interface: str) -> str:
    """Return the module constant for an interface, which avoids the slow access to the Enum."""
    return f"_{interface.upper()}"


def meaning_limits(meaning: RegisterMeaning) -> str:
    """Return the function for the limits of one meaning of a register."""
    return f"{meaning.name}_limits"


class ClassNames:
    """The names of attributes and local variables in the class of a frame or register, without collisions.

    ``crcs`` are the names of the functions that compute CRCs.
    """

    def __init__(self, layout: Layout, register: Register | None, crcs: Iterable[str]) -> None:
        self._names_of_class = set(CLASS_NAMES)
        self._names_of_class.update(f"from_{python_name(join.name, CLASS_NAMES)}" for join in layout.joins)
        if register is not None:
            self._names_of_class.update(map(meaning_limits, register.meanings))
        if layout.unused or layout.gaps == "unspecified":
            self._names_of_class.add("unused")
        self._names_of_locals = set(LOCAL_NAMES)
        for crc_function in crcs:
            self._names_of_locals |= {crc_function, f"{crc_function}_of_bits"}

    def attribute_name(self, name: str) -> str:
        """Return the attribute for a field, for some of its decimal digits, or for a joined number."""
        return python_name(name, self._names_of_class)

    def list_attributes(self, members: Iterable[Field | Digits], between: str = "") -> str:
        """Return a list of attributes in the form for docstrings."""
        return between.join(f"``{self.attribute_name(member.name)}``" for member in members)

    def variable_name(self, name: str) -> str:
        """Return the variable for the bits of a field."""
        return python_name(name, self._names_of_locals)


class ModuleNames:
    """The names of classes and functions in a module. Each name is assigned only once."""

    def __init__(self, reserved_names: Iterable[str]) -> None:
        self._used_names = set(reserved_names)

    def assign(self, wanted_name: str, suffix: str) -> str:
        """Return ``wanted_name`` if the name is free. Otherwise, add ``suffix``, and a number if that is also used."""
        is_free = wanted_name not in self._used_names and not keyword.iskeyword(wanted_name)
        unnumbered_name = wanted_name if is_free else f"{wanted_name}{suffix}"
        name = unnumbered_name
        number = 2
        # The name with the suffix can also be in use.
        while name in self._used_names:
            name = f"{unnumbered_name}{number}"
            number += 1
        self._used_names.add(name)
        return name


#: Name of a field, and its named values with their numbers.
_NamedValues = tuple[str, tuple[tuple[str, int], ...]]


def decoder_maker(function: str) -> str:
    """Return the name of the function that returns the decoder for ``decode_request`` or ``decode_reply``."""
    return f"_make_{function.removeprefix('decode_')}_decoder"


def byte_order(owner: Layout | Register, field: Field | None = None) -> str:
    """Return the name that Python uses for the byte order, also if ``field`` has a byte order of its own."""
    if field is not None and field.byte_order:
        return "little" if field.byte_order == "low_byte_first" else "big"
    return "little" if owner.byte_order == "low_byte_first" else "big"


def names_of(field: Field, numbers: Sequence[int]) -> str:
    """Return these values of a field with their names, such as ``1 is READ, 2 is WRITE``.

    The text is empty unless all of the values have a name.
    """
    name_by_value = {value.value: value.name.upper() for value in field.values}
    if not name_by_value.keys() >= set(numbers):
        return ""
    return ", ".join(f"{coded(value)} is {name_by_value[value]}" for value in numbers)


def is_one_choice(register: Register) -> bool:
    """Return whether a register consists only of one choice among named values."""
    first_field = register.layout.fields[0]
    fills_register = first_field.width == register.layout.bits
    return bool(register.values) and is_named(meaning_of(first_field)) and fills_register


def _named_values(field: Field) -> _NamedValues:
    """Return the name of a field with its named values and their numbers."""
    return field.name, tuple((value.name, value.value) for value in field.values)


@dataclass(frozen=True)
class OpenQuestion:
    """A question that the manual leaves open, as an argument of the functions that decode a frame.

    ``name`` is the name of the argument, whose values are members of the Enum ``enum_name``. ``members`` are the
    parameters that an answer sets, each with its attribute in the Enum.
    """

    alternative: Alternative
    enum_name: str
    name: str
    members: tuple[tuple[str, str], ...]

    @property
    def about(self) -> str:
        """The description of the argument for functions that decode several kinds of frames."""
        return f"{as_sentence(self.alternative.meaning)} Required only for frames that depend on it."


class DeviceNames:
    """A device, and the names of all parts of its module, in the order in which they are assigned."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self.module_name = python_name(device.name, (*SHARED, *FOLDERS, BISS))
        #: Attributes of the variant, by parameter.
        self.attribute_by_parameter = {
            parameter.name: python_name(parameter.name, VARIANT_NAMES) for parameter in device.parameters
        }
        names = ModuleNames([*MODULE_NAMES, *IMPORTED])
        #: Names of functions and classes, by the name of the part of the spec.
        self.function_name_by_crc = {crc.name: names.assign(f"crc_{crc.name}", suffix="_") for crc in device.crcs}
        self.class_name_by_frame: dict[str, str] = {}
        for _, layout in device.layouts():
            self.class_name_by_frame[layout.name] = names.assign(in_camel_case(layout.name), suffix="Frame")
        self.class_name_by_register: dict[str, str] = {}
        for register in device.registers:
            self.class_name_by_register[register.name] = names.assign(in_camel_case(register.name), suffix="Register")
        self.function_name_by_procedure: dict[str, str] = {}
        for procedure in device.procedures:
            self.function_name_by_procedure[procedure.name] = names.assign(python_name(procedure.name), suffix="_steps")
        self.question_by_name = {
            question.name: self._open_question(question, names) for question in device.alternatives
        }
        code_of_parameter = dict(self.translator_for("variant").code_by_parameter)
        for question in self.question_by_name.values():
            if not question.alternative.default:
                code_of_parameter |= {name: f"{question.name}.{member}" for name, member in question.members}
        #: Expressions for parameters: attributes of the variant, or of an answer that the caller must supply.
        self.translator = ExpressionTranslator(code_of_parameter)
        self._enum_name_by_values = {
            values: names.assign(in_camel_case(field.name), suffix="Value")
            for values, field in self.field_by_named_values.items()
        }

    def translator_for(self, owner: str) -> ExpressionTranslator:
        """Return how parameters are written as attributes of ``owner``, such as ``self.position_bits``."""
        return ExpressionTranslator({name: f"{owner}.{member}" for name, member in self.attribute_by_parameter.items()})

    def _open_question(self, alternative: Alternative, names: ModuleNames) -> OpenQuestion:
        """Return a question as an argument whose name differs from all attributes of the frames that depend on it."""
        names_in_frames: set[str] = set()
        for layout in self.coded_layouts():
            if alternative in self.device.alternatives_of(layout):
                names_in_frames |= _names_in_layout(layout)
        # All answers set the same parameters.
        parameters = alternative.answers[0].sets
        return OpenQuestion(
            alternative=alternative,
            enum_name=names.assign(in_camel_case(alternative.name), suffix="Alternative"),
            name=python_name(alternative.name, (*names_in_frames, *CLASS_NAMES, *LOCAL_NAMES, "frame")),
            members=tuple((parameter, python_name(parameter, ("name", "value"))) for parameter in parameters),
        )

    def questions_of(self, layout: Layout) -> list[OpenQuestion]:
        """Return the questions that must be answered to decode or encode a frame of this layout."""
        return [self.question_by_name[alternative.name] for alternative in self.device.alternatives_of(layout)]

    @cached_property
    def field_by_named_values(self) -> dict[_NamedValues, Field]:
        """The first field with each name and set of named values. Fields with equal ones share an IntEnum."""
        fields_by_values: dict[_NamedValues, Field] = {}
        for layout in self.coded_layouts():
            for field in layout.fields:
                if is_named(meaning_of(field)):
                    fields_by_values.setdefault(_named_values(field), field)
        return fields_by_values

    def coded_layouts(self) -> Iterator[Layout]:
        """Yield the layouts that have a class: all layouts except registers that are an IntEnum."""
        yield from (layout for _, layout in self.device.layouts())
        yield from (register.layout for register in self.device.registers if not is_one_choice(register))

    @cached_property
    def reports_by_frame(self) -> dict[str, ReportsAndVerdict]:
        """Reports and verdicts of frames, by the name of the frame."""
        return reportings(self.device)

    def enum_name(self, field: Field) -> str:
        """Return the name of the IntEnum with the named values of a field."""
        return self._enum_name_by_values[_named_values(field)]

    @cached_property
    def crc_functions(self) -> dict[str, CrcFunction]:
        """Functions that compute CRCs, by name."""
        return {self.crc_name(function.crc, function.covered_data): function for function in crc_functions(self.device)}

    def crc_name(self, crc: Crc, covered_data: CoveredData) -> str:
        """Return the name of the function that computes a CRC, such as ``crc_check``.

        If the module has functions for bits and for bytes, the one for bits is ``crc_check_of_bits``.
        """
        has_function_for_bytes = crc in self._crcs_of_both
        suffix = "_of_bits" if covered_data is CoveredData.BITS and has_function_for_bytes else ""
        return self.function_name_by_crc[crc.name] + suffix

    @cached_property
    def _crcs_of_both(self) -> list[Crc]:
        """The CRCs that frames of bits and frames of bytes use."""
        return [crc for crc in self.device.crcs if len(kinds_of_covered_data(self.device, crc)) > 1]


def _names_in_layout(layout: Layout) -> set[str]:
    """Return the names of the fields, of their decimal digits, and of the numbers that several fields form (joins)."""
    names = {field.name for field in layout.fields} | {join.name for join in layout.joins}
    for field in layout.fields:
        names.update(run.name for run in field.runs)
    return names
