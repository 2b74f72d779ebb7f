"""Data classes in a form that is created quickly, and lookups of their objects by name.

Importing the model mostly means compiling the methods of a hundred data classes. Here all of them share every method
except ``__init__``. That is compiled when the first object is created, because a command needs few of the classes.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import MISSING, FrozenInstanceError, fields
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Literal, NoReturn

if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    import dataclasses

    def dataclass(*, frozen: Literal[True], **options: bool) -> Callable[[type], type]:
        """Return the decorator of ``dataclasses`` with the shared methods."""

        def decorate(decorated_class: type) -> type:
            # Without a text, dataclasses would import the signature of each class to write one.
            decorated_class.__doc__ = decorated_class.__doc__ or decorated_class.__name__
            decorated = dataclasses.dataclass(**options, init=False, eq=False, repr=False)(decorated_class)
            decorated.__init__ = _late_init(decorated)
            for name, method in _SHARED_METHODS.items():
                setattr(decorated, name, method)
            return decorated

        return decorate


from collections.abc import Iterable
from typing import Protocol, TypeVar

__all__ = ["assert_never", "dataclass", "first_or_raise", "member_named"]


@functools.cache
def _values_of(part_class: type) -> Callable[[Any], Any]:
    """Return a function that returns the values that two equal objects share: one value, or a tuple of several."""
    names = [field.name for field in fields(part_class) if field.compare]
    return attrgetter(*names) if names else lambda _: ()


def _is_equal(self: Any, other: Any) -> Any:
    """Return True if the compared members of two objects are equal. NotImplemented if their classes differ."""
    part_class = self.__class__
    if other.__class__ is not part_class:
        return NotImplemented
    compared_values = _values_of(part_class)
    return compared_values(self) == compared_values(other)


def _hash_of(self: Any) -> int:
    return hash(_values_of(self.__class__)(self))


def _text_of(self: Any) -> str:
    """Return the text of an object as ``dataclasses`` writes it: ``Clock(max_hz=2000000)``."""
    members = ", ".join(f"{field.name}={getattr(self, field.name)!r}" for field in fields(self) if field.repr)
    return f"{self.__class__.__qualname__}({members})"


def _refuse_change(self: Any, name: str, *_: object) -> NoReturn:
    raise FrozenInstanceError(f"cannot change field {name!r}")


def _late_init(part_class: Any) -> Callable[..., None]:
    """Return an ``__init__`` that the first object replaces with a compiled ``__init__``."""

    def init(self: Any, *values: Any, **keyword_values: Any) -> None:
        part_class.__init__ = _init_of(part_class)
        part_class.__init__(self, *values, **keyword_values)

    return init


def _init_of(part_class: type) -> Any:
    """Return an ``__init__`` for a class, as ``dataclasses`` would generate it.

    Its source is built as text. The default of a field is in its namespace as ``_NAME``. If a function creates the
    default, ``_NAME`` is a marker, and the body calls the function ``_of_NAME`` if it receives this marker.
    """
    namespace: dict[str, Any] = {"_set": object.__setattr__}
    positional_parameters = ["self"]
    keyword_parameters = ["*"]
    statements = ["pass"]
    for field in fields(part_class):
        name = field.name
        value_text = field.name
        if field.default_factory is not MISSING:
            namespace[f"_of_{name}"] = field.default_factory
            namespace[f"_{name}"] = MISSING
            value_text = f"_of_{name}() if {name} is _{name} else {name}"
        elif field.default is not MISSING:
            namespace[f"_{name}"] = field.default
        parameter_text = f"{name}=_{name}" if f"_{name}" in namespace else name
        if field.kw_only:
            keyword_parameters.append(parameter_text)
        else:
            positional_parameters.append(parameter_text)
        statements.append(f"_set(self, {name!r}, {value_text})")
    # Python allows the asterisk only before a parameter.
    has_keyword_parameters = len(keyword_parameters) > 1
    parameters = [*positional_parameters, *(keyword_parameters if has_keyword_parameters else ())]
    exec(f"def __init__({', '.join(parameters)}): {'; '.join(statements)}", namespace)
    return namespace["__init__"]


_SHARED_METHODS: Mapping[str, Callable[..., Any]] = {
    "__eq__": _is_equal,
    "__hash__": _hash_of,
    "__repr__": _text_of,
    "__setattr__": _refuse_change,
    "__delattr__": _refuse_change,
}


class _Named(Protocol):
    @property
    def name(self) -> str: ...


_N = TypeVar("_N", bound=_Named)
_T = TypeVar("_T")


def member_named(members: Iterable[_N], name: str, kind: str) -> _N:
    """Return the first member with this name. If there is none, raise a ``LookupError`` that names its ``kind``."""
    for member in members:
        if member.name == name:
            return member
    raise LookupError(f"there is no {kind} called '{name}'")


def first_or_raise(values: Iterable[_T], kind: str) -> _T:
    """Return the first value, or raise a ``LookupError`` with the ``kind`` of value if there is none."""
    for value in values:
        return value
    raise LookupError(f"there is no {kind}")


def assert_never(value: NoReturn) -> NoReturn:
    """Make mypy reject a ``match`` that misses a member of the union."""
    raise AssertionError(f"no case for {value!r}")
