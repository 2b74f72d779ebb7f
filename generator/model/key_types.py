"""Types of the keys of parts: how each word for a type is written in the JSON Schema of specs and in the data."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from .part import DescribedKey, Key

JsonSchema = dict[str, Any]


class WordOfType(NamedTuple):
    """A word for a type: its JSON Schema in the spec language, and its notation in the data (see ``Member``)."""

    schema: Mapping[str, Any]
    notation: str


_INTERFACES = ["ssi", "biss", "rs485", "spi"]
_WORDS: Mapping[str, WordOfType] = MappingProxyType(
    {
        "Name": WordOfType({"$ref": "#/$defs/name"}, "name"),
        "Prose": WordOfType({"$ref": "#/$defs/text"}, "text"),
        "Phrase": WordOfType({"$ref": "#/$defs/text"}, "string"),
        "Names": WordOfType({"$ref": "#/$defs/names"}, "names"),
        "Sources": WordOfType({"$ref": "#/$defs/source"}, ""),
        "Count": WordOfType({"$ref": "#/$defs/count"}, "integer"),
        "Expression": WordOfType({"$ref": "#/$defs/expression"}, "expression"),
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
        "Unit": WordOfType({"description": "Unit.", "type": "string", "maxLength": 20}, "text"),
        "InterfaceName": WordOfType({"enum": _INTERFACES}, "|".join(_INTERFACES)),
    }
)
_LIST = re.compile(r"tuple\[(?P<inner>.*), \.\.\.\]")
_MAP = re.compile(r"Mapping\[Name, (?P<inner>\w+)\]")
_CHOICE = re.compile(r"Literal(?P<words>\[.*\])")


class KeyType(NamedTuple):
    """Type of a key: a word for a type, the name of a class, or words to choose from, or a list or map of these."""

    word: str
    choices: tuple[str, ...] = ()
    is_list: bool = False
    is_map: bool = False
    is_optional: bool = False

    @property
    def part(self) -> str:
        """Name in the data of the part that the class describes. Empty for other types."""
        return "" if self.choices or self.word in _WORDS else snake_case(self.word)

    @property
    def schema(self) -> JsonSchema:
        """JSON Schema of a value in it, apart from parts."""
        return (
            {"enum": [choice for choice in self.choices if choice]} if self.choices else dict(_WORDS[self.word].schema)
        )

    @property
    def notation(self) -> str:
        """Notation of a value in it in the data."""
        return "|".join(self.choices) if self.choices else self.part or _WORDS[self.word].notation


def snake_case(class_name: str) -> str:
    """Return the name of a part by that of its class."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", class_name).lower()


def key_type(text: str) -> KeyType:
    """Return the type of a key as it is written in its class, such as ``tuple[Name, ...]`` or ``Count | None``."""
    required_text = text.removesuffix(" | None")
    listed, mapped = _LIST.fullmatch(required_text), _MAP.fullmatch(required_text)
    container = listed or mapped
    inner_text = container["inner"] if container else required_text
    choice = _CHOICE.fullmatch(inner_text)
    choices = tuple(ast.literal_eval(choice["words"])) if choice else ()
    return KeyType(
        word="" if choice else inner_text,
        choices=choices,
        is_list=listed is not None,
        is_map=mapped is not None,
        is_optional=required_text != text,
    )


def data_notation(described: DescribedKey) -> str:
    """Return the notation of a key in the data. Empty if the data do not have it."""
    if described.key.shape:
        return described.key.shape
    kind = key_type(described.notation)
    if kind.is_list:
        return f"[{kind.notation}]"
    if kind.is_map:
        return f"{{{kind.notation}}}"
    if kind.is_optional:
        return f"{kind.notation}?"
    if isinstance(described.default, bool):
        return f"{kind.notation}={str(described.default).lower()}"
    return kind.notation


def limits_in_schema(key: Key) -> JsonSchema:
    """Return the limits of a value as words of JSON Schema."""
    limits: JsonSchema = {}
    if key.pattern:
        limits["pattern"] = key.pattern
    if key.minimum is not None:
        limits["minimum"] = key.minimum
    if key.maximum is not None:
        limits["maximum"] = key.maximum
    return limits
