"""Data classes for the model, in a form that is created quickly.

Importing the model mostly means compiling the methods of a hundred data classes. Here all of them share ``__eq__``,
``__hash__`` and ``__repr__``, so that only ``__init__`` and the protection from changes are compiled.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import fields
from operator import attrgetter
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    import dataclasses

    def dataclass(**options: bool) -> Callable[[type], type]:
        """Return the decorator of ``dataclasses`` with the three shared methods."""

        def decorate(kind: type) -> type:
            made = dataclasses.dataclass(**options, eq=False, repr=False)(kind)
            for name, method in _SHARED.items():
                setattr(made, name, method)
            return made

        return decorate


__all__ = ["dataclass"]


@functools.cache
def _values_of(kind: type) -> Callable[[Any], Any]:
    """Return a function that returns the values of the fields of an object: one value, or a tuple of several."""
    names = [item.name for item in fields(kind)]
    return attrgetter(*names) if names else lambda _: ()


def _is_equal(self: Any, other: Any) -> Any:
    kind = self.__class__
    if other.__class__ is not kind:
        return NotImplemented
    values = _values_of(kind)
    return values(self) == values(other)


def _hash(self: Any) -> int:
    return hash(_values_of(self.__class__)(self))


def _shown(self: Any) -> str:
    members = ", ".join(f"{item.name}={getattr(self, item.name)!r}" for item in fields(self) if item.repr)
    return f"{self.__class__.__qualname__}({members})"


_SHARED: Mapping[str, Callable[..., Any]] = {"__eq__": _is_equal, "__hash__": _hash, "__repr__": _shown}
