"""Tests whether data from outside has the types that our annotations promise, without building anything."""

from __future__ import annotations

import functools
import sys
from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from types import MappingProxyType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints, is_typeddict

_Test = Callable[[Any], bool]


def fits(value: Any, kind: Any) -> bool:
    """Return whether a value has a type, such as ``dict[str, list[str]]``. Members of objects are not looked at."""
    return _test_of(kind)(value)


def members_fit(kind: Any, values: Sequence[Any]) -> bool:
    """Return whether these values of the members of a data class have the types of their annotations."""
    return all(test(value) for test, value in zip(_tests_of(kind), values, strict=True))


@functools.cache
def _tests_of(kind: Any) -> tuple[_Test, ...]:
    """Return a test for each member of a data class, in their order."""
    modules = tuple(dict.fromkeys(base.__module__ for base in kind.__mro__))
    return tuple(_test_of_annotation(str(field.type), modules) for field in fields(kind))


@functools.cache
def _test_of_annotation(annotation: str, modules: tuple[str, ...]) -> _Test:
    # typing.get_type_hints would resolve the same few annotations again for each of a hundred classes.
    return _test_of(eval(annotation, {}, ChainMap(*(vars(sys.modules[module]) for module in modules))))


@functools.cache
def _test_of(kind: Any) -> _Test:
    origin, inner = get_origin(kind), get_args(kind)
    if kind is Any:
        return lambda value: True
    if origin in (Union, UnionType):
        if not any(map(get_origin, inner)) and float not in inner:
            return lambda value: type(value) in inner
        tests = list(map(_test_of, inner))
        return lambda value: any(test(value) for test in tests)
    if origin is tuple and inner[-1] is not ...:
        tests = list(map(_test_of, inner))
        return lambda value: (
            type(value) is tuple
            and len(value) == len(tests)
            and all(test(member) for test, member in zip(tests, value, strict=True))
        )
    if origin in (tuple, list):
        test = _test_of(inner[0])
        return lambda value: type(value) is origin and all(map(test, value))
    if origin in (dict, Mapping):
        of_key, of_value = map(_test_of, inner)
        return lambda value: (
            type(value) in (dict, MappingProxyType) and all(map(of_key, value)) and all(map(of_value, value.values()))
        )
    if is_typeddict(kind):
        members = {name: _test_of(hint) for name, hint in get_type_hints(kind).items()}
        return lambda value: (
            type(value) is dict
            and value.keys() == members.keys()
            and all(test(value[name]) for name, test in members.items())
        )
    if kind is float:
        return lambda value: type(value) in (int, float)
    return lambda value: type(value) is kind
