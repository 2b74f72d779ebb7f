"""Types of the keys of parts, in the JSON Schema of specs and in the data, and the members of the data."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

from .part import DescribedKey, SpecKey, description_of, keys_of

JsonSchema = dict[str, Any]


class WordOfType(NamedTuple):
    """A word for a type: its JSON Schema in the spec language, and its notation in the data (see ``ModelMember``)."""

    schema: Mapping[str, Any]
    notation: str


_INTERFACES = ["ssi", "biss", "rs485", "spi"]
#: Largest number of a spec. JavaScript represents it exactly, and C can compute with it in 64 bits.
LARGEST = 2**53 - 1
_CLOCK = {"minimum": 1, "maximum": 1_000_000_000}
_NAME = "^[a-z][a-z0-9]*(_[a-z0-9]+)*$"
_WORD_BY_TYPE: Mapping[str, WordOfType] = MappingProxyType(
    {
        "Name": WordOfType({"$ref": "#/$defs/name"}, "name"),
        "Prose": WordOfType({"$ref": "#/$defs/text"}, "text"),
        "Phrase": WordOfType({"$ref": "#/$defs/text"}, "string"),
        "Names": WordOfType({"$ref": "#/$defs/names"}, "names"),
        "Sources": WordOfType({"$ref": "#/$defs/source"}, ""),
        "SourceText": WordOfType({"$ref": "#/$defs/source"}, ""),
        "Count": WordOfType({"$ref": "#/$defs/count"}, "integer"),
        "Expression": WordOfType({"$ref": "#/$defs/expression"}, "expression"),
        "Formula": WordOfType({"$ref": "#/$defs/expression"}, "expression"),
        "int": WordOfType({"type": "integer"}, "integer"),
        "Hex": WordOfType({"type": "integer"}, "hex"),
        "float": WordOfType({"type": "number"}, "number"),
        "bool": WordOfType({"type": "boolean"}, "boolean"),
        "str": WordOfType({"type": "string"}, "string"),
        "CrcNumber": WordOfType({"$ref": "#/$defs/crc_number"}, "hex"),
        "RegisterBit": WordOfType(
            {"type": "string", "pattern": r"^[a-z][a-z0-9_]*\.[a-z][a-z0-9_]*$", "maxLength": 100}, "name"
        ),
        "Date": WordOfType({"type": "string", "pattern": "^[0-9]{4}-[0-9]{2}-[0-9]{2}$"}, "string"),
        "Language": WordOfType({"type": "string", "pattern": "^[a-z]{2}$"}, "name"),
        "Url": WordOfType(
            {"type": "string", "pattern": r"""^https?://[^\s<>"|`^{}\[\]\\]+$""", "maxLength": 300}, "string"
        ),
        "Pages": WordOfType(
            {
                "type": "string",
                "pattern": r"^p\.[0-9]{1,4}(-[0-9]{1,4})?((, | and )[0-9]{1,4}(-[0-9]{1,4})?)*$",
                "maxLength": 300,
            },
            "string",
        ),
        "Unit": WordOfType({"description": "Unit.", "type": "string", "maxLength": 20}, "text"),
        "InterfaceName": WordOfType({"enum": _INTERFACES}, "|".join(_INTERFACES)),
        "OtherBits": WordOfType({"$ref": "#/$defs/other_bits"}, "name"),
        "HexBytes": WordOfType({"$ref": "#/$defs/hex_bytes"}, "string"),
        "BitRange": WordOfType({"type": ["integer", "string"]}, "string"),
        "NumberOrText": WordOfType({"type": ["string", "integer"], "maxLength": 64}, "string"),
        "Values": WordOfType({"$ref": "#/$defs/values"}, "[value]"),
        "Joins": WordOfType({"$ref": "#/$defs/join"}, "[join]"),
        "DateOrYear": WordOfType({"type": "string", "pattern": "^[0-9]{4}(-[0-9]{2}-[0-9]{2})?$"}, "string"),
        "LanguageVersion": WordOfType({"const": 1}, "integer"),
        "PageOfEntry": WordOfType(
            {"description": "Page on which the entry begins.", "type": "integer", "minimum": 1, "maximum": 9999},
            "integer",
        ),
        "Anything": WordOfType({}, "scalar"),
        "Place": WordOfType({"$ref": "#/$defs/place"}, "name"),
        "Places": WordOfType({"$ref": "#/$defs/places"}, "[name]"),
        "CodePattern": WordOfType({"type": "string", "minLength": 1, "maxLength": 100}, "string"),
        "PrintedWrite": WordOfType(
            {
                "type": "string",
                "pattern": "^0x[0-9A-Fa-f]{1,4}(-0x[0-9A-Fa-f]{1,4})?( bit [0-9]{1,3})?"
                "( = (0x[0-9A-Fa-f]{1,16}|[0-9]{1,3}))?$",
                "maxLength": 60,
            },
            "string",
        ),
        "Headline": WordOfType(
            {"type": "string", "minLength": 1, "maxLength": 70, "pattern": r"^\S+ .*[^.\s]$"}, "text"
        ),
        "FactPath": WordOfType({"type": "string", "pattern": r"^[a-z0-9_]+(\.[a-z0-9_]+)*$", "maxLength": 120}, "name"),
        "ParameterValue": WordOfType({"type": "integer", "minimum": 0, "maximum": LARGEST}, "integer"),
        "SignedNumber": WordOfType({"type": "integer", "minimum": -LARGEST, "maximum": LARGEST}, "integer"),
        "AddressRange": WordOfType(
            {"type": ["integer", "string"], "pattern": "^0x[0-9A-Fa-f]+-0x[0-9A-Fa-f]+$", "maxLength": 20}, "string"
        ),
        "VerdictOfAnswer": WordOfType(
            {"description": "Verdict on the position with that answer.", "enum": ["not_usable", "usable_with_warning"]},
            "string",
        ),
        "ClocksInUse": WordOfType(
            {
                "type": ["integer", "array"],
                **_CLOCK,
                "minItems": 1,
                "maxItems": 100,
                "items": {"description": "A clock in hertz.", "type": "integer", **_CLOCK},
            },
            "[integer]",
        ),
        "Cells": WordOfType(
            {
                "description": "One row.",
                "type": "array",
                "minItems": 1,
                "maxItems": 12,
                "items": {"description": "One cell.", "type": ["string", "integer"], "maxLength": 300},
            },
            "table_row",
        ),
        "Scalar": WordOfType({"type": ["integer", "string", "boolean"]}, "scalar"),
        "NameOrNames": WordOfType(
            {
                "type": ["string", "array"],
                "pattern": _NAME,
                "maxLength": 40,
                "minItems": 1,
                "maxItems": 32,
                "items": {"$ref": "#/$defs/name"},
            },
            "[name]",
        ),
    }
)
#: JSON Schemas of the keys of maps, by their word.
_MAP_KEYS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "Name": {"$ref": "#/$defs/name"},
        "Heading": {"minLength": 1, "maxLength": 200},
        "Label": {"pattern": "^[A-Za-z0-9]+(/[A-Za-z0-9]+)*$", "maxLength": 20},
        "CodeNumber": {"type": "string", "pattern": "^(0|[1-9][0-9]{0,9}|0x[0-9A-Fa-f]{1,8})$"},
    }
)
_CONTAINER_PATTERNS: Mapping[str, re.Pattern[str]] = MappingProxyType(
    {
        "list": re.compile(r"tuple\[(?P<inner>.*), \.\.\.\]"),
        "one_or_more": re.compile(r"OneOrMore\[(?P<inner>.*)\]"),
        "map": re.compile(r"Mapping\[(?P<key>\w+), (?P<inner>.*)\]"),
        "located": re.compile(r"LocatedPart\[(?P<inner>\w+)\]"),
    }
)
_LITERAL_TYPE = re.compile(r"Literal(?P<words>\[.*\])")


class KeyType(NamedTuple):
    """Type of a key: a word for a type, the name of a class, words to choose from, or a container of an inner type.

    A container is a ``list``, ``one_or_more``, a ``map``, or ``located``: a part with its place.
    """

    word: str = ""
    choices: tuple[str, ...] = ()
    container: str = ""
    content: tuple[KeyType, ...] = ()
    key_word: str = ""
    is_optional: bool = False

    @property
    def inner(self) -> KeyType:
        """Type of the elements of a container."""
        return self.content[0]

    @property
    def part(self) -> str:
        """Name in the schema of the part that the class describes. Empty for other types."""
        if self.container == "located":
            return self.inner.part
        return "" if self.choices or self.container or self.word in _WORD_BY_TYPE else name_of_part(self.word)

    @property
    def class_name(self) -> str:
        """Class of a part."""
        return self.inner.word if self.container == "located" else self.word

    @property
    def key_schema(self) -> JsonSchema:
        """JSON Schema of the keys of a map."""
        return dict(_MAP_KEYS[self.key_word])

    @property
    def schema(self) -> JsonSchema:
        """JSON Schema of a value, apart from containers and parts."""
        if self.choices:
            return {"enum": [choice for choice in self.choices if choice]}
        return dict(_WORD_BY_TYPE[self.word].schema)

    @property
    def notation(self) -> str:
        """Notation of a value in the data."""
        if self.container:
            return f"{{{self.inner.notation}}}" if self.container == "map" else f"[{self.inner.notation}]"
        return "|".join(self.choices) if self.choices else self.part or _WORD_BY_TYPE[self.word].notation


def name_of_part(class_name: str) -> str:
    """Return the name of the part that a class describes, such as ``field`` for ``Field`` and ``WrittenField``."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", class_name.removeprefix("Written")).lower()


@cache
def key_type(text: str) -> KeyType:
    """Return the type of a key for the annotation in its class, such as ``tuple[Name, ...]`` or ``Count | None``."""
    if text.endswith(" | None"):
        return key_type(text.removesuffix(" | None"))._replace(is_optional=True)
    choice_match = _LITERAL_TYPE.fullmatch(text)
    if choice_match is not None:
        return KeyType(choices=tuple(ast.literal_eval(choice_match["words"])))
    for container, pattern in _CONTAINER_PATTERNS.items():
        container_match = pattern.fullmatch(text)
        if container_match is not None:
            key_word = container_match["key"] if container == "map" else ""
            return KeyType(container=container, content=(key_type(container_match["inner"]),), key_word=key_word)
    return KeyType(text)


def data_notation(described_key: DescribedKey) -> str:
    """Return the notation of a key in the data, such as ``count?``, or ``boolean=false`` with a default.

    It is empty for a key that does not occur in the data.
    """
    if described_key.key.data_type:
        return described_key.key.data_type
    type_of_key = key_type(described_key.notation)
    if type_of_key.is_optional:
        return f"{type_of_key.notation}?"
    if isinstance(described_key.default, bool):
        return f"{type_of_key.notation}={str(described_key.default).lower()}"
    return type_of_key.notation


def limits_in_schema(key: SpecKey) -> JsonSchema:
    """Return the limits of the value of a key as keywords of JSON Schema, such as ``{"minimum": 1}``."""
    limits: JsonSchema = {}
    if key.pattern:
        limits["pattern"] = key.pattern
    if key.minimum is not None:
        limits["minimum"] = key.minimum
    if key.maximum is not None:
        limits["maximum"] = key.maximum
    if key.shortest:
        limits["minLength"] = key.shortest
    if key.longest:
        limits["maxLength"] = key.longest
    return limits


#: Notations of numbers, by the ends of the names of members.
_NOTATION_BY_ENDING = ("mv", "us", "ms", "hz", "ns")
#: Rules of ``diff`` for limits, and the rules for the opposite change.
WIDER = {
    "clock-narrower": "clock-wider",
    "limit-narrower": "limit-wider",
    "supply-narrower": "supply-wider",
    "wait-longer": "wait-shorter",
}


@dataclass(frozen=True)
class ModelMember:
    """A member of a part of the model. Every output, ``diff`` and the second reading take its description from here.

    Attributes:
        name: Name in the data, in JSON and XML.
        data_type: Type in the data. Empty for a member that is not in the data.

            * ``string``, ``integer``, ``boolean``, ``hex`` (an integer in hexadecimal) or ``scalar`` (any of them)
            * the name of a part or of a basic type: ``register``, ``text``, ``name``, ``names``, ``expression``
            * ``one|other``: one of these words
            * ``[name]``: a list. ``{integer}``: a map. ``{kind:interface}``: a map of parts by their member ``kind``.
            * ``text?``: the same type, or null. ``boolean=false``: the same with a default. ``=1``: always this number.
        about: Description for users of the data.
        rule: Rule of ``diff`` for a change. Empty for a member that is compared elsewhere or derived from other
            members.
        label: Name in sentences, if it differs from ``name``.
        read: Class of facts of a second reading to which a stated value belongs. Empty for a member without such facts,
            or whose facts have several parts.
        noun: Name in messages about second readings, where ``label`` does not name a thing.
        form: Notation in sentences: ``hex``, ``bytes``, ``word``, ``level``, ``unit``, ``plain``, or a unit. By default
            it follows from the type or the name.
        refers_to: Kind of thing that the member names, so that ``diff`` takes a renaming into account.
        attribute_name: Name in the model, if it differs from ``name``.
    """

    name: str
    data_type: str = ""
    about: str = ""
    rule: str = ""
    label: str = ""
    read: str = ""
    noun: str = ""
    form: str = ""
    refers_to: str = ""
    attribute_name: str = ""

    @property
    def attribute(self) -> str:
        """Name in the model."""
        return self.attribute_name or self.name

    @property
    def words(self) -> str:
        """Name in sentences."""
        return self.label or self.attribute.replace("_", " ")

    @cached_property
    def notation(self) -> str:
        """Notation of numbers in sentences: ``form``, ``hex``, or the unit at the end of the name, such as ``us``."""
        if self.form:
            return self.form
        if self.data_type.startswith("hex"):
            return "hex"
        _, _, unit = self.attribute.rpartition("_")
        return unit if unit in _NOTATION_BY_ENDING else ""

    def is_stated(self, value: object) -> bool:
        """Return True if the manual states a value, and not just the default."""
        _, _, default = self.data_type.partition("=")  # ``false`` of ``boolean=false``.
        is_default = bool(default) and str(value).lower() == default
        return value not in (None, "", ()) and not is_default

    @property
    def is_limit(self) -> bool:
        """True if a change that allows more and a change that allows less are reported under different rules."""
        return self.rule in WIDER

    @property
    def is_upper(self) -> bool:
        """True for a limit that allows more if it is raised."""
        return self.name.startswith("max")


class ModelPart:
    """A part of the model with its members in the order of the data.

    ``class_names`` are the classes of the model if they differ from the name of the part. ``identity`` names the
    members by which a part is recognized if it has another name in another version. A part that ``is_sourced`` also has
    its sources in the data.
    """

    def __init__(
        self,
        name: str,
        about: str,
        *members: ModelMember,
        class_names: str | None = None,
        identity: str = "",
        is_sourced: bool = True,
    ) -> None:
        self.identity = tuple(identity.split())
        self.name = name
        self.about = about
        self.members = members
        self.is_sourced = is_sourced
        name_in_camel_case = "".join(word.capitalize() for word in name.split("_"))
        #: The names of its classes. By default, it has one class, with its own name.
        self.classes = (name_in_camel_case,) if class_names is None else tuple(class_names.split())
        #: The members by their names in the model. Of several with one name, the first counts.
        self.by_attribute = {member.attribute: member for member in reversed(members)}


NAME = ModelMember("name", "name", "Name.")
MEANING = ModelMember("meaning", "text", "Meaning or purpose.", "words")
NOTE = ModelMember("note", "text", "Additional information for the reader.", "words")
PRINTED_NAME = ModelMember("printed_name", "text", "Name in the manual.", "words")
NAMES = ModelMember("names", "names", "Names in manuals in other languages, each under its language code.", "words")


def described_part(part_class: Any, *additional: ModelMember, after: str = "", name: str = "") -> ModelPart:
    """Return the part that a class describes.

    ``additional`` members, which only the data have, follow the member ``after``. ``name`` is the name of the part, if
    it differs from the name of the class.
    """
    description = description_of(part_class)
    members = []
    for described_key in keys_of(part_class):
        if described_key.name == "source":
            continue
        members.append(_build_member(described_key))
        if described_key.name == after:
            members += additional
    return ModelPart(
        name or name_of_part(part_class.__name__),
        description.data or description.about,
        *members,
        class_names=part_class.__name__,
        identity=description.identity,
        is_sourced=description.is_sourced,
    )


def _build_member(described: DescribedKey) -> ModelMember:
    key = described.key
    about = key.data or f"{key.about} {key.reading}".rstrip()
    return ModelMember(described.name, data_notation(described), about, **key.member)
