"""Parts as they are written in a spec, with typed attributes, their places and the keys that were given.

Rules read specs through these classes, so that mypy finds a misspelt key. The data may have any shape: a value of a
wrong type reads as if it were missing, but its key still counts as given. Values are read when a rule asks for them.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, dataclass
from functools import cache, cached_property
from types import MappingProxyType
from typing import Any, Generic, TypeVar

from ..model.expressions import Expression, ExpressionError
from ..model.keys_and_members import KeyType, key_type
from ..model.part import NOTHING, About, DescribedKey, described_key, keys_of
from .document import Path

T = TypeVar("T")
Part = TypeVar("Part", covariant=True)
#: Returns the value at a path, or None for a wrong type.
Reader = Callable[[Any, Path], Any]


@dataclass(frozen=True, slots=True)
class LocatedPart(Generic[Part]):
    """A part that specs and the model share, with its place and its data. It has no sources."""

    part: Part
    path: Path
    data: Mapping[str, Any]

    @property
    def source(self) -> object:
        """The text with the sources."""
        return self.data.get("source")

    @property
    def is_given(self) -> bool:
        """True if the spec has the part with at least one key."""
        return bool(self.data)

    def has(self, name: str) -> bool:
        """Return True if a key was given, whatever its value."""
        return name in self.data

    def is_valid(self, name: str) -> bool:
        """Return True if a key was given with a value of its type, so that the part has the value as given."""
        return name in self.data and getattr(self.part, name) == self.data[name]


class WrittenPart:
    """A part of a spec. Each key is an attribute. A missing key has its default or, if it is required, is empty."""

    #: The keys with their types and descriptions.
    described_keys: tuple[DescribedKey, ...] = ()

    def __init__(self, data: Any, path: Path = ()) -> None:
        self.data: dict[str, Any] = data if isinstance(data, dict) else {}
        self.path = path

    def __init_subclass__(cls) -> None:
        """Collect the keys of a class of parts, and make each of them an attribute that reads its value."""
        described_keys = []
        for name, notation in inspect.get_annotations(cls).items():
            member = cls.__dict__.get(name)
            if isinstance(member, Field):
                # A key can be a reserved word of Python. The attribute "from_" is for the key "from".
                described = described_key(name.rstrip("_"), notation, member)
                described_keys.append(described)
                setattr(cls, name, _Attribute(name, described, cls.__module__))
        cls.described_keys = tuple(described_keys)

    @classmethod
    def keys_owned_by(cls, kind: str, *, alone: bool = False) -> tuple[str, ...]:
        """Return the keys that this kind of the part can have and some other kind cannot.

        With ``alone``, return only the keys that no other kind can have.
        """
        owned_keys = []
        for described in cls.described_keys:
            owners = described.key.owners
            if owners == (kind,) or (kind in owners and not alone):
                owned_keys.append(described.name)
        return tuple(owned_keys)

    @property
    def is_given(self) -> bool:
        """True if the spec has the part with at least one key. A missing required part is empty."""
        return bool(self.data)

    def has(self, *names: str) -> bool:
        """Return True if one of these keys was given, whatever its value."""
        return any(name in self.data for name in names)

    def is_valid(self, name: str) -> bool:
        """Return True if a key was given with a value of its type, so that the attribute has the value as given."""
        return name in self.data and getattr(self, name) == self.data[name]

    def names_in(self, name: str) -> list[str]:
        """Return the names in the map under a key, even of values with a wrong type. Empty if it is not a map."""
        entries = self.data.get(name)
        return list(entries) if isinstance(entries, dict) else []

    def path_of(self, name: str) -> Path:
        """Return the path of a key."""
        return (*self.path, name)


class _Attribute:
    """A key of a written part, which is read at its first use. The value then hides this attribute in the part."""

    def __init__(self, attribute_name: str, described: DescribedKey, module: str) -> None:
        self.attribute_name = attribute_name
        self.described = described
        self.module = module

    def __get__(self, part: WrittenPart | None, owner: type) -> Any:
        """Return the value of the key in a part, or this attribute itself if asked for by the class."""
        if part is None:
            return self
        value = self._read_value(part)
        part.__dict__[self.attribute_name] = value  # From now on, Python finds it there and does not call this.
        return value

    def _read_value(self, part: WrittenPart) -> Any:
        """Return the value of the key. If it is missing or has a wrong type, return its default or an empty value."""
        name = self.described.name
        value = None
        if name in part.data:
            value = self._reader(part.data[name], (*part.path, name))
        if value is not None:
            return value
        if self.described.default is not MISSING:
            return self.described.default
        return _empty_value(self._value_type, self.module, (*part.path, name))

    @cached_property
    def _value_type(self) -> KeyType:
        return key_type(self.described.notation)

    @cached_property
    def _reader(self) -> Reader:
        """The function that reads a value of the key. It is looked up late, since its class may be defined later."""
        return _find_reader(self._value_type, self.module)


def written(about: str, **options: Any) -> Callable[[type[T]], type[T]]:
    """Return the decorator of a part as it is written in specs. ``options`` are those of ``About``."""

    def decorate(part_class: type[T]) -> type[T]:
        described: Any = part_class
        described.__part__ = About(about, **options)
        return part_class

    return decorate


@cache
def _find_reader(value_type: KeyType, module_name: str) -> Reader:
    """Return a function that converts a value as it is written in a spec to a type. It returns None for other types.

    Classes of parts are looked up by name in ``module_name``, where they are imported.
    """
    if value_type.container == "list":
        return _list_reader(_find_reader(value_type.inner, module_name))
    if value_type.container == "one_or_more":
        return _one_or_more_parts(_find_reader(value_type.inner, module_name))
    if value_type.container == "map":
        return _map_reader(_find_reader(value_type.inner, module_name))
    if value_type.container == "located":
        return _located_reader(_class_of(value_type.inner, module_name))
    if value_type.choices:
        return lambda value, _: value if isinstance(value, str) and value in value_type.choices else None
    return _word_reader(value_type, module_name)


def _word_reader(value_type: KeyType, module_name: str) -> Reader:
    """Return the reader of a type that is one word: a part, the map of named values, or a type in ``_READERS_BY_TYPE``.

    Other words are texts with a certain form.
    """
    if value_type.part:
        return _part_reader(_class_of(value_type, module_name))
    if value_type.word == "Values":
        return _map_reader(_find_reader(key_type("WrittenValue"), module_name))
    return _READERS_BY_TYPE.get(value_type.word, _text)


def _part_reader(part_class: Any) -> Reader:
    """Return a function that reads a part of a spec from a map, or returns None for a value that is not a map.

    A part of the model is inside another part, so it has no path of its own.
    """

    def read_part(value: Any, path: Path) -> Any:
        if not isinstance(value, dict):
            return None
        is_written = issubclass(part_class, WrittenPart)
        return part_class(value, path) if is_written else located(part_class, value, path).part

    return read_part


def _reader_of_types(*types: type) -> Reader:
    """Return a function that returns a value of one of these types, and None for others. A boolean is not a number."""
    return lambda value, _: value if type(value) in types else None


def _parse_expression(written_value: Any, _: Path) -> Expression | None:
    """Return the expression in a whole number or text, or None if it is not valid."""
    try:
        return Expression.parse(written_value) if type(written_value) in (int, str) else None
    except ExpressionError:  # Reported by the rule on expressions.
        return None


def _list_reader(read_item: Reader) -> Reader:
    """Return a function that reads a list as a tuple, with ``read_item`` for each element.

    Elements of a wrong type are left out. The result is None for a value that is not a list.
    """

    def read_list(value: Any, path: Path) -> Any:
        if not isinstance(value, list):
            return None
        read_values = [read_item(list_item, (*path, index)) for index, list_item in enumerate(value)]
        return tuple(read_value for read_value in read_values if read_value is not None)

    return read_list


def _map_reader(read_inner: Reader) -> Reader:
    """Return a function that reads a map of names, with ``read_inner`` for each value.

    Values of a wrong type are left out. The result is None for a value that is not a map.
    """

    def read_map(value: Any, path: Path) -> Any:
        if not isinstance(value, dict):
            return None
        read_values = {name: read_inner(inner_value, (*path, name)) for name, inner_value in value.items()}
        return {name: read_value for name, read_value in read_values.items() if read_value is not None}

    return read_map


def _one_or_more_parts(read_part: Reader) -> Reader:
    """Return a function that reads a part, or a list of parts, as a tuple, with ``read_part`` for each part."""

    def read_parts(value: Any, path: Path) -> Any:
        if isinstance(value, list):
            return _list_reader(read_part)(value, path)
        part = read_part(value, path)
        return None if part is None else (part,)

    return read_parts


def _read_texts(value: Any, path: Path) -> Any:
    """Return a tuple of texts for a single text or a list of texts, or None for other values."""
    return (value,) if isinstance(value, str) else _list_reader(_text)(value, path)


def _read_numbers(value: Any, path: Path) -> Any:
    """Return a tuple of numbers for a single number or a list of numbers, or None for other values."""
    return (value,) if type(value) is int else _list_reader(_number)(value, path)


def _read_cells(row: Any, _: Path) -> Any:
    """Return the cells of a row of a table as texts, or None if the row is not a list."""
    return tuple(map(str, row)) if isinstance(row, list) else None


_text = _reader_of_types(str)
_number = _reader_of_types(int)
_number_or_text = _reader_of_types(int, str)
#: The words for types that are not text.
_READERS_BY_TYPE: Mapping[str, Reader] = MappingProxyType(
    {
        **dict.fromkeys(
            ("Count", "int", "Hex", "CrcNumber", "ParameterValue", "SignedNumber", "PageOfEntry", "LanguageVersion"),
            _number,
        ),
        **dict.fromkeys(("Formula", "BitRange", "NumberOrText", "AddressRange"), _number_or_text),
        "Scalar": _reader_of_types(int, str, bool),
        "bool": _reader_of_types(bool),
        "float": _reader_of_types(int, float),
        "Expression": _parse_expression,
        "Names": _map_reader(_text),
        "Joins": _map_reader(_list_reader(_text)),
        **dict.fromkeys(("NameOrNames", "Places"), _read_texts),
        "Anything": lambda value, _: value,
        "ClocksInUse": _read_numbers,
        "Cells": _read_cells,
    }
)


def _located_reader(model_class: Any) -> Reader:
    """Return a function that reads a part of the model with its path from a map, or returns None for other values."""

    def read_part(value: Any, path: Path) -> Any:
        return located(model_class, value, path) if isinstance(value, dict) else None

    return read_part


def located(model_class: type[T], part_data: Mapping[str, Any], path: Path) -> LocatedPart[T]:
    """Return a part of the model as it is written in a spec, with its path and data.

    A missing key has its default or, if it is required, is empty. Parts inside it have no place, and sources are left
    out.
    """
    values_by_key: dict[str, Any] = {}
    for described in keys_of(model_class):
        value_type = key_type(described.notation)
        if value_type.word == "Sources":
            values_by_key[described.name] = ()
            continue
        value = None
        if described.name in part_data:
            read = _find_reader(value_type, model_class.__module__)
            value = read(part_data[described.name], (*path, described.name))
            value = value.part if isinstance(value, LocatedPart) else value
        if value is None and described.default is MISSING:
            value = _empty_value(value_type, model_class.__module__, path)
        if value is not None:
            values_by_key[described.name] = value
    return LocatedPart(model_class(**values_by_key), path, part_data)


def _empty_value(value_type: KeyType, module_name: str, path: Path) -> Any:
    """Return the value that stands for a missing required key: an empty part, container or text, 0 or False."""
    if value_type.container == "located":
        return located(_class_of(value_type.inner, module_name), NOTHING, path)
    if value_type.container == "one_or_more":
        return (_empty_value(value_type.inner, module_name, path),)
    if value_type.container:
        return () if value_type.container == "list" else NOTHING
    if value_type.part:
        written_class = _class_of(value_type, module_name)
        return written_class(NOTHING, path)
    is_whole_number = _READERS_BY_TYPE.get(value_type.word) is _number
    return {"bool": False, "float": 0.0}.get(value_type.word, 0 if is_whole_number else "")


def _class_of(value_type: KeyType, module: str) -> Any:
    """Return the class with the name of a type in a module."""
    return vars(sys.modules[module])[value_type.word]
