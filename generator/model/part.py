"""Parts of the spec language: one class for each part, which describes each of its keys once.

The JSON Schema of the spec language, the table of members, and so the data and the pages follow from these classes.
The types of the keys are written with the words below. mypy reads them as plain types, and
``model/keys_and_members.py`` as types of the spec language and of the data.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, field, fields
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar, overload

from .record import dataclass

if TYPE_CHECKING:
    from typing_extensions import dataclass_transform
else:

    def dataclass_transform(**_: object) -> Callable[[Any], Any]:
        """Mark a decorator for type checkers only, because Python 3.10 lacks this function."""
        return lambda decorator: decorator


T = TypeVar("T")

#: A name in the spec, such as the name of a field.
Name = str
#: Running text, of several sentences if needed. It is an element in XML.
Prose = str
#: Prose of a few words. It is an attribute in XML.
Phrase = str
#: Names in manuals in other languages, by language code.
Names = Mapping[str, str]
#: A whole number from 0.
Count = int
#: A whole number that is written in hexadecimal.
Hex = int
#: A CRC parameter of up to 64 bits.
CrcNumber = int
#: A bit of a register, as ``register.field``.
RegisterBit = str
#: A release date, as year-month-day.
Date = str
#: Two letters for a language.
Language = str
#: A web address.
Url = str
#: Pages of a document.
Pages = str
#: A unit of a column.
Unit = str
#: Name of an interface.
InterfaceName = Literal["ssi", "biss", "rs485", "spi"]

#: The types below occur only in specs as they are written, before names and formulas are resolved.
#: Text with sources.
SourceText = str
#: A whole number, or a formula with parameters.
Formula = int | str
#: A bit number, or a range such as 7:6.
BitRange = int | str
#: A whole number, a formula with parameters, or a text.
NumberOrText = int | str
#: A name, or a list of names. It reads as a list.
NameOrNames = tuple[str, ...]
#: Names of joined fields, by the name of the number that they form.
Joins = Mapping[str, tuple[str, ...]]
#: An order code with the names of its parts in braces.
CodePattern = str
#: A write as the manual prints it.
PrintedWrite = str
#: A sentence instead of a name.
Headline = str
#: A path into the spec.
FactPath = str
#: The value of an order code's parameter.
ParameterValue = int
#: A number, possibly negative.
SignedNumber = int
#: An address, or a range of addresses.
AddressRange = int | str
#: A verdict on the position for one answer of the user.
VerdictOfAnswer = str
#: One clock in hertz, or several in ascending order. It reads as a list.
ClocksInUse = tuple[int, ...]
#: One part, or a list of them if they depend on the order code. It reads as a list.
OneOrMore = tuple[T, ...]
#: The cells of a row.
Cells = tuple[str, ...]
#: A value of an example.
Scalar = int | str | bool
#: Title or number of a section.
Heading = str
#: Text on a label.
Label = str
#: A code in a register, as a key.
CodeNumber = str
#: A date, or only a year.
DateOrYear = str
#: Version of the spec language.
LanguageVersion = int
#: A value of any type.
Anything = object
#: A path into the spec, and one or more of them.
Place = str
Places = tuple[str, ...]
#: Page on which an entry of a section begins.
PageOfEntry = int
#: Content of the bits outside all fields.
OtherBits = str
#: Bytes in hexadecimal, separated by spaces.
HexBytes = str

#: An empty map, as a default.
NOTHING: Mapping[Any, Any] = MappingProxyType({})
_KEY_METADATA = "key"


class SpecKey(NamedTuple):
    """Description of a key of the spec language or, without ``is_written``, of a member that only the data have.

    Attributes:
        about: Description of the key.
        writing: Further sentences for the author of a spec.
        reading: Further sentences for users of the data.
        data: Description for users of the data, if it is not ``about`` with ``reading``.
        data_type: Type in the data, if it does not follow from the type of the key.
        is_written: True if specs contain the key.
        pattern: Regular expression of a text.
        minimum: Lowest number.
        maximum: Highest number.
        shortest: Lowest number of characters of a text.
        longest: Highest number of characters of a text.
        most: Highest number of entries of a list or map.
        least: Lowest number of entries of a list or map.
        needed_by: Kinds of the part that must have the key.
        allowed_in: Kinds of the part that can have the key. If both are empty, each kind can.
        schema: JSON Schema of the value, if no type of the keys has it.
        member: Other properties of ``ModelMember``: the rule of ``diff``, the class of second reading and so on.
    """

    about: str
    writing: str = ""
    reading: str = ""
    data: str = ""
    data_type: str = ""
    is_written: bool = True
    pattern: str = ""
    minimum: int | None = None
    maximum: int | None = None
    shortest: int = 0
    longest: int = 0
    most: int = 2000
    least: int = 1
    needed_by: tuple[str, ...] = ()
    allowed_in: tuple[str, ...] = ()
    schema: Mapping[str, Any] = NOTHING
    member: Mapping[str, str] = NOTHING

    @property
    def owners(self) -> tuple[str, ...]:
        """Kinds of the part that can have the key, or none if it does not depend on the kind."""
        return (*self.needed_by, *self.allowed_in)


class About(NamedTuple):
    """Description of a part.

    Attributes:
        about: Description of the part.
        writing: Further sentences for the author of a spec.
        data: Description for users of the data, if it is not ``about``.
        identity: Members by which a part is recognized under another name, separated by spaces.
        is_sourced: True if the part has sources in the data: its own, or those of its parent.
        needs_a_key: True if no key is required, but one must be given.
    """

    about: str
    writing: str = ""
    data: str = ""
    identity: str = ""
    is_sourced: bool = True
    needs_a_key: bool = False


@overload
def key(about: str, *, default: T, **options: Any) -> T: ...
@overload
def key(about: str, **options: Any) -> Any: ...
def key(about: str, *, default: Any = MISSING, **options: Any) -> Any:
    """Describe a key of the spec language. Without a ``default``, specs must contain the key.

    ``options`` are attributes of ``SpecKey``, such as ``minimum``, and of ``ModelMember``, such as ``rule``.
    """
    options_of_key = {name: options.pop(name) for name in list(options) if name in SpecKey._fields}
    metadata = {_KEY_METADATA: SpecKey(about, member=options, **options_of_key)}
    if isinstance(default, Mapping):  # Python 3.11 rejects it as a default, because it has no hash.
        return field(default_factory=lambda: default, metadata=metadata)
    return field(default=default, metadata=metadata)


@overload
def fact(about: str, *, default: T, **options: Any) -> T: ...
@overload
def fact(about: str, **options: Any) -> Any: ...
def fact(about: str, *, default: Any = MISSING, **options: Any) -> Any:
    """Describe a member that only the data have, because it is derived from other members."""
    return key(about, default=default, is_written=False, **options)


#: Explains the patterns of order codes to the author of a spec.
PATTERNS = "'...' matches any text, 'x' matches any one character, and commas separate patterns."
#: Describes the steps in the characteristics that ``by_hand`` names.
STEPS = "Their values contain the steps, numbered 1., 2., 3."
BY_HAND = "Steps carried out by a person: names of characteristics."


def name_key(about: str, **options: Any) -> Any:
    """Describe the required key ``name``."""
    return key(about, data="Name.", **options)


def meaning_key(about: str, **options: Any) -> Any:
    """Describe the key ``meaning``. Specs must contain it, unless a default is given."""
    return key(about, data="Meaning or purpose.", rule="words", **options)


def printed_name_key(**options: Any) -> Any:
    """Describe the key ``printed_name``."""
    return key("Name in the manual.", rule="words", **options)


def names_key(**options: Any) -> Any:
    """Describe the key ``names``, whose type has the description for the author of a spec."""
    about = "Names in manuals in other languages, each under its language code."
    return key("", data=about, rule="words", **options)


def note_key(about: str = "Additional information for the reader.", **options: Any) -> Any:
    """Describe the key ``note``."""
    return key(about, data="Additional information for the reader.", rule="words", **options)


def only_key(
    about: str = "Order codes to which it applies, as in .../65K...:", writing: str = "", **options: Any
) -> Any:
    """Describe the key ``only``."""
    data = options.pop("data", "Order codes that the item applies to. Empty if it applies to all.")
    writing = f"{PATTERNS} {writing}".rstrip()
    return key(about, writing=writing, data=data, label="order codes", **options)


def source_key(**options: Any) -> Any:
    """Describe the key ``source``, whose type has the description. Specs must contain it, unless a default is given."""
    return key("", **options)


@dataclass_transform(
    frozen_default=True,
    kw_only_default=True,
    field_specifiers=(
        key,
        fact,
        name_key,
        meaning_key,
        printed_name_key,
        names_key,
        note_key,
        only_key,
        source_key,
    ),
)
def part(about: str, *, kw_only: bool = True, **options: Any) -> Callable[[type[T]], type[T]]:
    """Return the decorator for a class that describes a part of the language, with attributes of ``About``."""

    def decorate(part_class: type[T]) -> type[T]:
        described: Any = dataclass(frozen=True, slots=True, kw_only=kw_only)(part_class)
        described.__part__ = About(about, **options)
        return described  # type: ignore[no-any-return]

    return decorate


def is_part(part_class: object) -> bool:
    """Return True if a class describes a part of the language."""
    return isinstance(part_class, type) and isinstance(getattr(part_class, "__part__", None), About)


def description_of(part_class: Any) -> About:
    """Return the description of a part."""
    about: About = part_class.__part__
    return about


class DescribedKey(NamedTuple):
    """A key of a part: its name, its type as it is written in the class, its default, and its description."""

    name: str
    notation: str
    default: object
    key: SpecKey

    @property
    def is_required(self) -> bool:
        """True if specs must contain the key."""
        return self.default is MISSING


def keys_of(part_class: Any) -> tuple[DescribedKey, ...]:
    """Return the keys of a part, in the order of its class."""
    if hasattr(part_class, "described_keys"):
        described_keys: tuple[DescribedKey, ...] = part_class.described_keys
        return described_keys
    return tuple(described_key(member.name, str(member.type), member) for member in fields(part_class))


def described_key(name: str, notation: str, member: Field[Any]) -> DescribedKey:
    """Return a key by its description in a class."""
    default = member.default
    if member.default_factory is not MISSING:
        default = member.default_factory()
    return DescribedKey(name, notation, default, member.metadata[_KEY_METADATA])
