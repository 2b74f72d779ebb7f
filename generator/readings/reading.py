"""A reading of a manual: a device with its file, and its facts under keys that contain no names."""

from __future__ import annotations

import dataclasses
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from functools import cached_property
from typing import Any, NamedTuple

from ..language.document import Document, Path
from ..model import INTERFACES, Device, Field, Layout, Register
from ..model.expressions import Expression
from ..model.record import dataclass
from ..order_codes.parameters import with_changed
from ..say.names_and_evidence import bits

#: Value shown for a fact that a reading lacks.
NOTHING = "nothing"


class FactClass(Enum):
    """Classes of facts, in the order of display."""

    POSITION = "position"
    CRC = "crc"
    ADDRESS = "address"
    BYTE_ORDER = "byte order"
    ACCESS = "access"
    DEFAULT = "default"
    LIMIT = "limit"
    CLOCK = "clock"
    TIME = "time"
    WAIT = "wait"
    VALUE = "value"
    BEHAVIOUR = "behaviour"
    VERDICT = "verdict"
    ALARM = "alarm"
    PROCEDURE = "procedure"
    ORDER_CODE = "order code"
    MEASUREMENT = "measurement"
    SETTING = "setting"
    SUPPLY = "supply"
    PIN = "pin"
    INPUT = "input"
    PRINTED = "printed name"
    HISTORY = "history"
    CHARACTERISTIC = "characteristic"
    TABLE = "table"
    LED = "LED"
    TEXT = "number in a text"
    SECTION = "cited section"
    CONTENTS = "contents"

    @property
    def is_needed(self) -> bool:
        """Whether a wrong fact of this class corrupts a position or a transfer, so that it must be read twice."""
        return self in _CLASSES_READ_TWICE


_CLASSES_READ_TWICE = frozenset(list(FactClass)[: list(FactClass).index(FactClass.VALUE)])  # from POSITION up to WAIT

#: Key that identifies a fact within its family, without names.
FactKey = tuple[str | int, ...]
#: State of an encoder whose registers have the factory defaults.
FACTORY_DEFAULTS = ""


class CodeAndState(NamedTuple):
    """An order code, and the state of its registers and alternatives, in words."""

    code: str
    state: str

    @property
    def by_default(self) -> CodeAndState:
        """The same order code with the factory defaults."""
        return CodeAndState(self.code, FACTORY_DEFAULTS)


#: A value as shown in messages: a single value, or a value for each case.
FactValue = str | Mapping[CodeAndState, str]


@dataclasses.dataclass(frozen=True, slots=True)
class ComparedFact:
    """A fact of a reading, which is compared with the fact of the other reading that has the same key.

    ``description`` is its name in messages, and ``path_in_file`` its path of keys. ``depends_on`` is the key of the
    fact that this fact depends on, such as the register of a default. A fact ``may_be_missing`` in the other reading if
    it is a printed name in a different language, for example. ``name`` is the reader's name for the item whose first
    fact this is, at ``name_path``. A fact that ``is_implied`` follows from another fact, but if one reader states it,
    the other must too.
    """

    fact_class: FactClass
    key: FactKey
    value: FactValue
    description: str
    path_in_file: Path
    depends_on: FactKey = ()
    may_be_missing: bool = False
    name: str = ""
    name_path: Path = ()
    is_implied: bool = False


#: Facts about the names that a reader gives to items of one kind.
FactNames = dict[FactKey, ComparedFact]
#: Items with separate names for each interface, which is the second element of their keys.
_BY_INTERFACE = frozenset(("connector", "frame", "procedure", "register", "time"))


@dataclasses.dataclass(frozen=True, slots=True)
class BitMeaning:
    """Meaning of a bit, such as ``bit 5 of a number``. ``fixed`` is its value if it is constant."""

    part: str
    weight: int | None
    fixed: int | None
    path_in_file: Path


@dataclasses.dataclass(frozen=True, slots=True)
class WordCase:
    """A frame or register in one case: its bits, lowest first, and the facts about its fields by low bit and width.

    ``names`` contains the names of the fields, and of the values of each field.
    """

    bits: tuple[BitMeaning, ...]
    fields: Mapping[tuple[int, int], Mapping[FactKey, ComparedFact]]
    names: Mapping[FactKey, FactNames]


@dataclasses.dataclass(frozen=True, slots=True)
class WordBits:
    """A frame or a register, bit by bit, in each case."""

    description: str
    path_in_file: Path
    cases: Mapping[CodeAndState, WordCase]

    @property
    def everywhere(self) -> WordCase | None:
        """The word if it is the same object in all cases, so that it can be compared without order codes, or None."""
        distinct_words = {id(word_case): word_case for word_case in self.cases.values()}
        if len(distinct_words) > 1:
            return None
        return next(iter(distinct_words.values()), None)


class PrintedNumbers(NamedTuple):
    """The numbers in a text, such as ``5V 10ms``, or the sections that a source cites, with their place."""

    text: str
    path_in_file: Path


@dataclasses.dataclass(slots=True)
class ComparedFacts:
    """All facts of a reading. ``derived`` counts the facts that follow from other facts.

    ``names`` contains the names of items of one kind, by interface if they belong to an interface. A second reading can
    list the numbers in a text by its path (``printed_numbers``), and the sections that everything under a path cites
    (``sections``). ``decided`` contains the paths and classes of facts that no manual prints.
    """

    facts: dict[FactKey, ComparedFact] = dataclasses.field(default_factory=dict)
    words: dict[FactKey, WordBits] = dataclasses.field(default_factory=dict)
    derived: Counter[FactClass] = dataclasses.field(default_factory=Counter)
    names: dict[FactKey, FactNames] = dataclasses.field(default_factory=dict)
    printed_numbers: Mapping[str, PrintedNumbers] = dataclasses.field(default_factory=dict)
    sections: Mapping[str, Sequence[str]] = dataclasses.field(default_factory=dict)
    decided: Sequence[str] = ()

    def add(self, facts: Iterator[ComparedFact]) -> None:
        """Add facts. A key that already exists gets the first free number: ``(*key, 2)``, ``(*key, 3)``."""
        for fact in facts:
            key = fact.key
            number = 1
            while key in self.facts:
                number += 1
                key = (*fact.key, number)
            self.facts[key] = fact
            if fact.name:
                self._add_name_of(key, fact)

    def _add_name_of(self, key: FactKey, fact: ComparedFact) -> None:
        """Add the name of the item that a fact is about, under its kind: ``("register", "ssi")`` or ``("alarm",)``."""
        kind = key[:2] if key[0] in _BY_INTERFACE else key[:1]
        description = f"name of {fact.description}"
        name_fact = ComparedFact(
            fact_class=fact.fact_class, key=key, value=fact.name, description=description, path_in_file=fact.name_path
        )
        self.add_name(kind, name_fact)

    def add_name(self, kind: FactKey, name: ComparedFact) -> None:
        """Add the name of an item."""
        self.names.setdefault(kind, {}).setdefault(name.key, name)


Parameters = Mapping[str, int]

#: Separator between alternative names in one language.
_BETWEEN_NAMES = " | "
_PUNCTUATION = re.compile(r"[\W_]+")
#: Prefix of the names of fields that the build adds for zero bits.
_PREFIX_OF_ZERO_BITS = "zero"
#: Smallest number shown in hexadecimal.
_LEAST_IN_HEX = 10_000


@dataclass(frozen=True)
class SpecReading:
    """A device and its file."""

    device: Device
    document: Document

    def cases(self, interface: str) -> Mapping[CodeAndState, Parameters]:
        """Return the parameters in each case of an interface. The map is empty if no order code has the interface.

        A case is an order code with a state: the factory defaults, an end of the range of a parameter that a register
        holds, or a different answer to an open question.
        """
        return self._parameters_by_case.get(interface, {})

    @cached_property
    def _parameters_by_case(self) -> Mapping[str, Mapping[CodeAndState, Parameters]]:
        """The parameters of every order code in each case, by interface. The factory defaults are the first case."""
        interfaces = {variant.interface for variant in self.device.variants}
        states_by_interface = {interface: list(self._states_to_compare(interface)) for interface in interfaces}
        cases_by_interface: dict[str, dict[CodeAndState, Parameters]] = {interface: {} for interface in interfaces}
        for variant in self.device.variants:
            parameters_by_case = cases_by_interface[variant.interface]
            parameters_by_case[CodeAndState(variant.code, FACTORY_DEFAULTS)] = variant.parameters
            for state, changed_parameters in states_by_interface[variant.interface]:
                parameters = with_changed(self.device, variant, changed_parameters)
                parameters_by_case[CodeAndState(variant.code, state)] = parameters
        return cases_by_interface

    def _states_to_compare(self, interface: str) -> Iterator[tuple[str, Parameters]]:
        """Yield each state other than the factory defaults, in words, with the parameters that it changes."""
        for parameter in self.device.run_time_parameters:
            # A parameter without an interface is the same over all of them.
            if parameter.interface and parameter.interface != interface:
                continue
            name_of_bits = self.describe_bits(parameter.read_from)
            for bound in (parameter.min, parameter.max):
                if bound is not None:
                    yield f"{name_of_bits} = {bound}", {parameter.name: bound}
        for number, alternative in enumerate(self.device.alternatives, 1):
            # The factory defaults have the first answer of each alternative.
            for answer_number, answer in enumerate(alternative.answers[1:], 2):
                yield f"answer {answer_number} of alternative {number}", answer.sets

    def describe_bits(self, path: str) -> str:
        """Return the bits at a path ``register.field``: ``register 0x49 bits 7:4``, or the path if there is none."""
        register, field = self._field_at(path)
        if register is None or field is None:
            return path
        return f"{register_text(register)} {self.bits_of(register.interface, field)}"

    def state(self, path: str, name: str) -> str:
        """Return the condition that a field has a named value: ``register 0x49 bits 7:4 is 3``.

        ``path`` is the path of the field, ``register.field``, and ``name`` the name of the value.
        """
        _, field = self._field_at(path)
        number_text = name
        for named_value in field.values if field is not None else ():
            if named_value.name == name:
                number_text = in_hex(named_value.value)
        return f"{self.describe_bits(path)} is {number_text}"

    def _field_at(self, path: str) -> tuple[Register | None, Field | None]:
        """Return the register and the field of ``register.field``, each None if it does not exist."""
        register_name, _, field_name = path.partition(".")
        register = self.register(register_name)
        if register is None:
            return None, None
        field_by_name = {field.name: field for field in register.layout.fields}
        return register, field_by_name.get(field_name)

    def bits_of(self, interface: str, field: Field) -> str:
        """Return text such as ``bits 7:4`` for a field of a register or frame, for the first order code."""
        parameters = self._parameters_of_first_code(interface)
        low, width = field.low.value(parameters), field.width.value(parameters)
        return bits(low + width - 1, low)

    def _parameters_of_first_code(self, interface: str) -> Parameters:
        """Return the parameters of an interface's first order code in alphabetical order.

        The order in the spec does not count, because readers list order codes differently.
        """
        variants = [variant for variant in self.device.variants if variant.interface == interface]
        first_variant = min(variants, key=lambda variant: variant.code, default=None)
        return first_variant.parameters if first_variant is not None else {}

    def register(self, name: str) -> Register | None:
        for register in self.device.registers:
            if register.name == name:
                return register
        return None

    def field_path(self, owner: Path, field: Field) -> Path:
        """Return the place of a field in the spec.

        For bits that are added as zeros, this is ``other_bits``, and for any other field that the spec does not list,
        it is the place of the frame, register or group.
        """
        if field.group:
            owner = ("field_groups", field.group)
        own_path: Path = (*owner, "fields", field.padding_of or field.name)
        if field.name.startswith(_PREFIX_OF_ZERO_BITS) and not self.document.has(own_path):
            return (*owner, "other_bits")
        return self.first_existing(own_path, owner)

    def bits_in_frames(self, interface: str, layout: Layout, field: Field) -> Iterator[str]:
        """Yield the lowest bit of a field in each frame of a layout: ``bit 3 of the encoder's frame with 0x1A``.

        A layout has a frame for each value of its selector. The bit is that of the first order code.
        """
        low_bit = field.low.value(self._parameters_of_first_code(interface))
        bit_text = f"bit {low_bit} of the {layout.sender}'s frame"
        if not layout.selects:
            yield bit_text
        for selector_value in layout.selects:
            yield f"{bit_text} with {in_hex(selector_value)}"

    def printed_names(self, part: Any) -> Mapping[str, str]:
        """Return the names that the manual prints for an item, by language. Several are joined: ``turn | rev``."""
        translations: Mapping[str, str] = getattr(part, "names", {})
        names_by_language = {language: [comparable_text(name)] for language, name in translations.items()}
        printed_name = getattr(part, "printed_name", "")
        if printed_name:
            names_by_language.setdefault(self.device.manual.language, []).append(comparable_text(printed_name))
        return {language: _BETWEEN_NAMES.join(names) for language, names in names_by_language.items()}

    def first_existing(self, *possible_paths: Path) -> Path:
        """Return the first of these places that exists in the file, or the last place if none exists."""
        for path_in_file in possible_paths:
            if self.document.has(path_in_file):
                return path_in_file
        return possible_paths[-1]

    def key_of(self, register: Register) -> FactKey:
        """Return the key that identifies a register: its interface, bank and address.

        If several registers share the address, the key also says whether this one is read or written.
        """
        bank = -1 if register.bank is None else register.bank
        address_key = ("register", register.interface, bank, register.address)
        all_addresses = [(other.interface, other.bank, other.address) for other in self.device.registers]
        is_address_shared = all_addresses.count((register.interface, register.bank, register.address)) > 1
        if not is_address_shared:
            return address_key
        return (*address_key, "read" if register.readable else "write")


def register_text(register: Register) -> str:
    """Return text such as ``register 0x49``, with its bank."""
    bank = f" of bank {register.bank}" if register.bank is not None else ""
    return f"register 0x{register.address:02X}{bank}"


def interface_label(interface: str) -> str:
    """Return the short name of an interface."""
    return INTERFACES[interface].short


def in_hex(value: int) -> str:
    """Return a number in the notation that specs use for bits: ``9``, ``0x0A``."""
    return f"0x{value:02X}" if value > 9 else str(value)


def count_text(value: int) -> str:
    """Return a number in the notation for counts: ``9999``, ``0x2710``."""
    return str(value) if value < _LEAST_IN_HEX else f"0x{value:X}"


def as_delivered(register: Register) -> int | None:
    """Return the factory default of a register: the stated one, or the documented values of all its fields.

    Return None if it is not stated, and the value of a field is not documented.
    """
    if register.default is not None:
        return register.default
    default = 0
    for field in register.layout.fields:
        documented_number = _documented_number(field)
        if documented_number is None or not field.carries_data or not field.low.is_constant:
            return None
        default |= documented_number << field.low.constant
    return default


def _documented_number(field: Field) -> int | None:
    """Return the documented value of a field as a number, or None if it has none or it depends on the order code."""
    documented_value = field.equals
    if isinstance(documented_value, str):
        return int.from_bytes(documented_value.encode("ascii"), "big")
    if isinstance(documented_value, Expression):
        return documented_value.constant if documented_value.is_constant else None
    return documented_value


def same_name(names: str, other_names: str) -> bool:
    """Return whether two readings have a printed name in common. Each text contains names joined by `` | ``."""
    common_names = set(names.split(_BETWEEN_NAMES)) & set(other_names.split(_BETWEEN_NAMES))
    return bool(common_names)


def comparable_text(text: str) -> str:
    """Return a text without capitals and punctuation, in which readers differ: ``start bit`` for "Start-Bit".

    A text that only consists of punctuation is returned as it is.
    """
    without_punctuation = _PUNCTUATION.sub(" ", text).strip()
    return without_punctuation.casefold() or text
