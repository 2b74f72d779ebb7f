"""A reading: a device with its file, and its facts under keys without names."""

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
from ..say.names_and_places import bits

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
        """True if an error in this class corrupts a position or a transfer, so that it must be read twice."""
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
    """A fact. ``description`` is its name in messages, ``place`` its place in the spec.

    ``depends_on`` is the key of the fact on which this fact depends, such as the register of a default. A fact that
    ``may_be_missing`` from the other reading is, for example, a printed name in another language. ``name`` is the
    reader's name of the item whose first fact this is, at ``name_place``. A fact that ``is_implied`` follows from
    another fact. If one reader still states it, the other must, too.
    """

    sort: FactClass
    key: FactKey
    value: FactValue
    description: str
    place: Path
    depends_on: FactKey = ()
    may_be_missing: bool = False
    name: str = ""
    name_place: Path = ()
    is_implied: bool = False


#: Facts about the names that a reader gives to items of one kind.
FactNames = dict[FactKey, ComparedFact]


@dataclasses.dataclass(frozen=True, slots=True)
class BitMeaning:
    """Meaning of a bit, such as ``bit 5 of a number``. ``fixed`` is its value if it is constant."""

    part: str
    weight: int | None
    fixed: int | None
    place: Path


@dataclasses.dataclass(frozen=True, slots=True)
class WordCase:
    """A word in one case: its bits, lowest first, and the properties of its fields by low bit and width.

    ``names`` contains the names of the fields, and of the values of each field.
    """

    bits: tuple[BitMeaning, ...]
    fields: Mapping[tuple[int, int], Mapping[FactKey, ComparedFact]]
    names: Mapping[FactKey, FactNames]


@dataclasses.dataclass(frozen=True, slots=True)
class WordBits:
    """A frame or a register, bit by bit, in each case."""

    description: str
    place: Path
    cases: Mapping[CodeAndState, WordCase]

    @property
    def everywhere(self) -> WordCase | None:
        """The word if all cases share one ``WordCase``, for comparison without order codes, or else None."""
        distinct_words = {id(word_case): word_case for word_case in self.cases.values()}
        if len(distinct_words) > 1:
            return None
        return next(iter(distinct_words.values()), None)


@dataclasses.dataclass(slots=True)
class ComparedFacts:
    """All facts of a reading. ``derived`` counts the facts that follow from other facts.

    ``names`` contains the names of items of one kind, by interface if they belong to an interface. A second reading can
    list the numbers of a text in ``printed_numbers`` by its path, and the sections of everything under a path in
    ``sections``. ``decided`` contains the paths and classes of facts that no manual prints.
    """

    facts: dict[FactKey, ComparedFact] = dataclasses.field(default_factory=dict)
    words: dict[FactKey, WordBits] = dataclasses.field(default_factory=dict)
    derived: Counter[FactClass] = dataclasses.field(default_factory=Counter)
    names: dict[FactKey, FactNames] = dataclasses.field(default_factory=dict)
    printed_numbers: Mapping[str, tuple[str, Path]] = dataclasses.field(default_factory=dict)
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
        """Add ``fact.name`` as the name of an item, under its kind: ``("register", "ssi")``, or ``("alarm",)``."""
        kind = key[:2] if key[0] in _BY_INTERFACE else key[:1]
        description = f"name of {fact.description}"
        name_fact = ComparedFact(
            sort=fact.sort, key=key, value=fact.name, description=description, place=fact.name_place
        )
        self.add_name(kind, name_fact)

    def add_name(self, kind: FactKey, name: ComparedFact) -> None:
        """Add the name of an item."""
        self.names.setdefault(kind, {}).setdefault(name.key, name)


#: Items with separate names for each interface, which is the second element of their keys.
_BY_INTERFACE = frozenset(("connector", "frame", "procedure", "register", "time"))

#: Share of equal names from which the second reading is assumed to use the names of the spec.
_SHARE_OF_EQUAL_NAMES = 0.9


def use_same_names(spec: ComparedFacts, second: ComparedFacts) -> bool:
    """Return whether at least 90 % of the common names are equal, so that any other name is a mistake."""
    compared_count, equal_count = 0, 0
    for spec_names, second_names in _name_maps_of_both(spec, second):
        for key in spec_names.keys() & second_names.keys():
            compared_count += 1
            if spec_names[key].value == second_names[key].value:
                equal_count += 1
    return equal_count >= _SHARE_OF_EQUAL_NAMES * compared_count


def _name_maps_of_both(spec: ComparedFacts, second: ComparedFacts) -> Iterator[tuple[FactNames, FactNames]]:
    """Yield the names of each kind in both readings, by key. For fields, the first common case of a word is enough."""
    yield from _names_by_kind(spec.names, second.names)
    for key in spec.words.keys() & second.words.keys():
        spec_cases, second_cases = spec.words[key].cases, second.words[key].cases
        common_cases = [case for case in spec_cases if case in second_cases]
        if common_cases:
            first_case = common_cases[0]
            yield from _names_by_kind(spec_cases[first_case].names, second_cases[first_case].names)


def _names_by_kind(
    spec: Mapping[FactKey, FactNames], second: Mapping[FactKey, FactNames]
) -> Iterator[tuple[FactNames, FactNames]]:
    for kind in spec.keys() & second.keys():
        yield spec[kind], second[kind]


def mistaken_pairs(
    spec_names: FactNames, second_names: FactNames, *, must_be_equal: bool
) -> Iterator[tuple[ComparedFact, ComparedFact]]:
    """Yield the names of an item in the spec and the second reading if they differ and one must be a mistake.

    This is the case if the second reader uses the name for another item, if the two differ in one letter, or if all
    names ``must_be_equal``.
    """
    all_second_names = {second_name.value for second_name in second_names.values()}
    for key, spec_name in spec_names.items():
        second_name = second_names.get(key)
        if second_name is None or second_name.value == spec_name.value:
            continue
        is_used_for_other_item = spec_name.value in all_second_names
        is_misspelling = _differ_in_one_letter(str(spec_name.value), str(second_name.value))
        if must_be_equal or is_used_for_other_item or is_misspelling:
            yield spec_name, second_name


def _differ_in_one_letter(name: str, other_name: str) -> bool:
    """Return whether two different names differ by one extra, missing or wrong letter, or two swapped letters."""
    shorter, longer = sorted((name, other_name), key=len)
    if len(shorter) < len(longer):
        return any(longer[:index] + longer[index + 1 :] == shorter for index in range(len(longer)))
    differing_indices = [index for index in range(len(name)) if name[index] != other_name[index]]
    start, end = differing_indices[0], differing_indices[-1] + 1
    is_one_wrong_letter = end - start == 1
    are_two_swapped = end - start == 2 and name[start:end] == other_name[start:end][::-1]
    return is_one_wrong_letter or are_two_swapped


Parameters = Mapping[str, int]

#: Between alternative names in one language.
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
        """Return the parameters in each case of an interface, or an empty map if no order code has it.

        The cases of an order code are the factory defaults, both ends of the range of each parameter in a register, and
        each other answer of an alternative.
        """
        return self._parameters_by_case.get(interface, {})

    @cached_property
    def _parameters_by_case(self) -> Mapping[str, Mapping[CodeAndState, Parameters]]:
        """The parameters of every order code by its interface and by case, first with the factory defaults."""
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
            for bound in (parameter.min, parameter.max):
                if bound is not None:
                    yield f"{self.bits_at(parameter.read_from)} = {bound}", {parameter.name: bound}
        for number, alternative in enumerate(self.device.alternatives, 1):
            # The factory defaults have the first answer of each alternative.
            for answer_number, answer in enumerate(alternative.answers[1:], 2):
                yield f"answer {answer_number} of alternative {number}", answer.sets

    def bits_at(self, path: str) -> str:
        """Return ``register 0x49 bits 7:4`` for ``register.field``, or the path if there is no such field."""
        register, field = self._field_at(path)
        if register is None or field is None:
            return path
        return f"{register_text(register)} {self.bits_of(register.interface, field)}"

    def state(self, path: str, name: str) -> str:
        """Return ``register 0x49 bits 7:4 is 3`` for ``register.field`` and the name of one of its values."""
        _, field = self._field_at(path)
        number_text = name
        for named_value in field.values if field is not None else ():
            if named_value.name == name:
                number_text = in_hex(named_value.value)
        return f"{self.bits_at(path)} is {number_text}"

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
        """Return the parameters of the first order code of an interface by name, as readers list codes differently."""
        variants = [variant for variant in self.device.variants if variant.interface == interface]
        first_variant = min(variants, key=lambda variant: variant.code, default=None)
        return first_variant.parameters if first_variant is not None else {}

    def register(self, name: str) -> Register | None:
        for register in self.device.registers:
            if register.name == name:
                return register
        return None

    def field_place(self, owner: Path, field: Field) -> Path:
        """Return the place of a field in the spec, or ``other_bits`` for added zero bits, or else its owner's place."""
        if field.group:
            owner = ("field_groups", field.group)
        own_place: Path = (*owner, "fields", field.padding_of or field.name)
        if field.name.startswith(_PREFIX_OF_ZERO_BITS) and not self.document.has(own_place):
            return (*owner, "other_bits")
        return self.first_existing(own_place, owner)

    def bits_in_frames(self, interface: str, layout: Layout, field: Field) -> Iterator[str]:
        """Yield ``bit 3 of the encoder's frame``, once for each selector of the layout, for the first code."""
        low_bit = field.low.value(self._parameters_of_first_code(interface))
        bit_text = f"bit {low_bit} of the {layout.sender}'s frame"
        if not layout.selects:
            yield bit_text
        for selector_value in layout.selects:
            yield f"{bit_text} with {in_hex(selector_value)}"

    def printed_names(self, part: Any) -> Mapping[str, str]:
        """Return the printed names of an item by language. Alternatives are joined: ``{"en": "turn | rev"}``."""
        translations: Mapping[str, str] = getattr(part, "names", {})
        names_by_language = {language: [comparable_text(name)] for language, name in translations.items()}
        printed_name = getattr(part, "printed_name", "")
        if printed_name:
            names_by_language.setdefault(self.device.manual.language, []).append(comparable_text(printed_name))
        return {language: _BETWEEN_NAMES.join(names) for language, names in names_by_language.items()}

    def first_existing(self, *places: Path) -> Path:
        """Return the first of these places that exists in the file, otherwise the last."""
        for place in places:
            if self.document.has(place):
                return place
        return places[-1]

    def key_of(self, register: Register) -> FactKey:
        """Return the key of a register: interface, bank, address, and readability if several share the address."""
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
    """Return the factory default as stated, or from the fixed values of all fields, or None if a value is not known."""
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
    """Return the constant value of a field as a number, or None if it has none or the order code decides it."""
    documented_value = field.equals
    if isinstance(documented_value, str):
        return int.from_bytes(documented_value.encode("ascii"), "big")
    if isinstance(documented_value, Expression):
        return documented_value.constant if documented_value.is_constant else None
    return documented_value


def same_name(names: str, other_names: str) -> bool:
    """Return whether two readers have a printed name in common. Alternatives are as from ``printed_names``."""
    common_names = set(names.split(_BETWEEN_NAMES)) & set(other_names.split(_BETWEEN_NAMES))
    return bool(common_names)


def comparable_text(text: str) -> str:
    """Return text without the differences between readers, capitals and punctuation: ``start bit`` for "Start-Bit"."""
    without_punctuation = _PUNCTUATION.sub(" ", text).strip()
    return without_punctuation.casefold() or text  # The text itself if it is only punctuation.
