"""Names in a generated module: those that it needs itself, and what becomes of a spec's name that is one of them."""

from __future__ import annotations

import keyword
from collections.abc import Iterable, Mapping

from ...model import Digits, Field, Layout, Register, RegisterMeaning

#: What a device module imports where it needs it, by the module that has it.
STANDARD: Mapping[str, tuple[str, ...]] = {
    "collections.abc": ("Callable", "Mapping"),
    "enum": ("Enum", "IntEnum"),
    "math": ("tau",),
    "operator": ("index",),
    "types": ("MappingProxyType",),
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
PACKAGE: Mapping[str, tuple[str, ...]] = {
    module: tuple(names.split())
    for module, names in {
        "._codec": """BitField ConstantError CrcError Data FrameError Interface LengthError RangeError Rows Word
            Words as_bytes as_word by_class check_bits check_encoder check_kind check_limits check_power_of_two
            check_signed check_width choice crc_by_xor crc_of_bits crc_of_bytes crc_tables decided from_gray made signed
            text_number to_gray too_long unwrap whole_number wrong_encoder zero_for""",
        "._encoder": "Encoder fact",
        "._order_codes": "checked",
        "._registers": "Held agrees held_bytes held_parameters held_text whole",
        "._reports": "Family Movement Report Verdict",
        "._steps": "Modify Poll Read Send Step Verify Wait writes",
    }.items()
}

#: What the facts of a device import.
FACTS: Mapping[str, tuple[str, ...]] = {
    module: tuple(names.split())
    for module, names in {
        ".._codec": "Interface",
        ".._facts": """AboveMax Access Alarm Alignment BissFacts ByteOrder CableLength Characteristic Clock Connector
            ConnectorKind Contact ControlField Crc DataIdFacts Document Edition Erratum FieldFacts Input Led LedState
            LostFigure Manual MemoryAccess NamedValue Network Port PrintedTimeout Purpose Register RegisterMeaning
            Revision Rs485Facts Severity SsiFacts Status Table Timeout TimeoutRule Timing""",
        ".._order_codes": "OrderCode Part PartValue SpelledValue Spelling",
        ".._reports": "ReadOnly Report Reports Verdict",
    }.items()
}

#: What the package's modules are called that hold no device.
SHARED = tuple(
    """__main__ _arrow _codec _codes _encoder _facts _input _make _many _order_codes _registers _reports _run _shape
    _sinks _sources _steps _stream _table _text _why""".split()
)
#: The folders for what is loaded only when it is asked for, with a module for each device.
FOLDERS = ("facts", "_shapes")
#: The module for register access over BiSS, in packages with a family that speaks it.
BISS = "biss"

#: Everything that a device module can import.
IMPORTED = [name for module in (STANDARD, PACKAGE) for names in module.values() for name in names]
#: The functions that a device module imports.
FUNCTIONS = ("cast", "index", "round", "tau", *(name for names in PACKAGE.values() for name in names if name.islower()))
#: Names that every device module uses for itself, besides what it imports.
MODULE_NAMES = """ALARMS Address ArithmeticError BISS BissEncoder CHARACTERISTICS CONNECTORS CRCS DOCUMENTS
    ERRATA Ellipsis Exception FAMILY FRAMES Frame INPUTS LEDS LOST_FIGURES MANUAL NotImplemented
    ORDER_CODE REGISTERS REPORTS RS485 Reply Request Rs485Encoder SSI SsiEncoder TABLES TIMINGS TypeError
    VARIANTS ValueError Variant Warning annotations decode_reply decode_request identify isinstance len
    lookup type""".split()
#: Names that the class of the variants uses for itself.
VARIANT_NAMES = """bytes cls code counts_per_turn decode decode_many degrees encode_many family frame_bits from_degrees
    from_millimetres from_radians from_turns highest interface metres micrometres millimetres modulus parts
    radians self special special_code tail try_decode turns unlisted unwrap with_registers
    written_as_in""".split()
#: Names that the generated classes, and in them the methods, use for themselves.
CLASS_NAMES = """bit_fields check_width cls count decode decode_many encode encode_many frame_bits index
    is_as_documented limits reports self usable_position variant verdict""".split()
LOCAL_NAMES = [
    *"bits body cls computed data isinstance len number remainder self type values variant word".split(),
    *FUNCTIONS,
]
#: What the functions of procedures use; an argument of such a name gets a trailing underscore.
PROCEDURE_NAMES = (*FUNCTIONS, "before", "content", "dict", "enumerate", "isinstance", "variant")

#: Built-ins that the generated classes use in their bodies; a field of such a name would hide them there. Any method
#: that has the name ``super`` is bound to its class, which a NamedTuple does not allow.
_BUILT_IN = frozenset("bool bytes classmethod float int property staticmethod str super tuple".split())


def attribute(name: str, taken: Iterable[str] = ()) -> str:
    """The name of an attribute or argument; one that Python or the class needs itself gets a trailing underscore."""
    return f"{name}_" if keyword.iskeyword(name) or name in _BUILT_IN or name in taken else name


def camel(name: str) -> str:
    """``single_cycle_data`` as ``SingleCycleData``."""
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


def encoder_name(kind: str) -> str:
    """The class of the encoders with an interface."""
    return f"{kind.capitalize()}Encoder"


def interface_name(kind: str) -> str:
    """The module's own name for an interface; to ask the Enum for it takes longer than all checks."""
    return f"_{kind.upper()}"


def meaning_limits(meaning: RegisterMeaning) -> str:
    """The function that gives the limits of one meaning of a register."""
    return f"{meaning.name}_limits"


class ClassNames:
    """The names of attributes and locals in the class of a layout: none is one that the class has for itself."""

    def __init__(self, layout: Layout, register: Register | None, crcs: Iterable[str]) -> None:
        made = [f"from_{attribute(item.name, CLASS_NAMES)}" for item in layout.joins]
        limits = map(meaning_limits, register.meanings) if register is not None else ()
        self._own = {
            *CLASS_NAMES,
            *made,
            *limits,
            *(["unused"] if layout.unused or layout.gaps == "unspecified" else []),
        }
        self._locals = {*LOCAL_NAMES, *(name for crc in crcs for name in (crc, f"{crc}_of_bits"))}

    def attribute(self, name: str) -> str:
        return attribute(name, self._own)

    def listed(self, items: Iterable[Field | Digits], between: str = "") -> str:
        """Attributes as a docstring names them."""
        return between.join(f"``{self.attribute(item.name)}``" for item in items)

    def local(self, name: str) -> str:
        """The variable that holds the bits of a field."""
        return attribute(name, self._locals)


class Names:
    """The names of a module, each given once."""

    def __init__(self, taken: Iterable[str]) -> None:
        self._taken = set(taken)

    def take(self, wanted: str, suffix: str) -> str:
        """``wanted`` where it is free, else with ``suffix``, else with a number as well."""
        base = wanted if wanted not in self._taken and not keyword.iskeyword(wanted) else f"{wanted}{suffix}"
        name, number = base, 2
        while name in self._taken:
            name, number = f"{base}{number}", number + 1
        self._taken.add(name)
        return name
