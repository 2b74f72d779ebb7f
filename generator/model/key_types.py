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
        "Text": WordOfType({"$ref": "#/$defs/text"}, "text"),
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
        "RegisterBit": WordOfType(
            {"type": "string", "pattern": r"^[a-z][a-z0-9_]*\.[a-z][a-z0-9_]*$", "maxLength": 100}, "name"
        ),
        "Date": WordOfType({"type": "string", "pattern": "^[0-9]{4}-[0-9]{2}-[0-9]{2}$"}, "string"),
        "Language": WordOfType({"type": "string", "pattern": "^[a-z]{2}$"}, "name"),
        "Url": WordOfType(
            {"type": "string", "pattern": r"""^https?://[^\s<>"|`^{}\[\]\\]+$""", "maxLength": 300}, "string"
        ),
        "InterfaceName": WordOfType({"enum": _INTERFACES}, "|".join(_INTERFACES)),
    }
)
_LIST = re.compile(r"tuple\[(?P<inner>.*), \.\.\.\]")
_CHOICE = re.compile(r"Literal(?P<words>\[.*\])")


class KeyType(NamedTuple):
    """Type of a key: a word for a type, the name of a class, or words to choose from, and whether it is a list."""

    word: str
    choices: tuple[str, ...] = ()
    is_list: bool = False
    is_optional: bool = False

    @property
    def part(self) -> str:
        """Name in the data of the part that the class describes. Empty for other types."""
        return "" if self.choices or self.word in _WORDS else snake_case(self.word)

    @property
    def schema(self) -> JsonSchema:
        """JSON Schema of a value that is not a list, apart from parts."""
        return {"enum": list(self.choices)} if self.choices else dict(_WORDS[self.word].schema)

    @property
    def notation(self) -> str:
        """Notation of a value in the data that is not a list."""
        return "|".join(self.choices) if self.choices else self.part or _WORDS[self.word].notation


def snake_case(class_name: str) -> str:
    """Return the name of a part by that of its class."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", class_name).lower()


def key_type(text: str) -> KeyType:
    """Return the type of a key as it is written in its class, such as ``tuple[Name, ...]`` or ``Count | None``."""
    required_text = text.removesuffix(" | None")
    listed = _LIST.fullmatch(required_text)
    inner_text = listed["inner"] if listed else required_text
    choice = _CHOICE.fullmatch(inner_text)
    choices = tuple(ast.literal_eval(choice["words"])) if choice else ()
    return KeyType(
        word="" if choice else inner_text,
        choices=choices,
        is_list=listed is not None,
        is_optional=required_text != text,
    )


def data_notation(described: DescribedKey) -> str:
    """Return the notation of a key in the data. Empty if the data do not have it."""
    if described.key.shape:
        return described.key.shape
    kind = key_type(described.notation)
    if kind.is_list:
        return f"[{kind.notation}]"
    if kind.is_optional:
        return f"{kind.notation}?"
    if kind.choices and described.default == "":
        return f"|{kind.notation}"
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
