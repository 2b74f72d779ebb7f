# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Descriptions of the frames of a class. They are in ``_shapes`` of a package, and are loaded on first use."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, cast, get_type_hints

from ..codec import require_answer
from ..encoder import Encoder, wrong_encoder_error

if TYPE_CHECKING:
    from ..bulk.shape import Shape


def shape_of(kind: type, *arguments: object) -> Shape:
    """Return the description of a class for an encoder and for answers to questions that the manual leaves open."""
    make, needed = find_description(kind)
    for wanted, value in zip(needed, arguments, strict=False):
        if not isinstance(value, wanted):
            if issubclass(wanted, Encoder):
                raise wrong_encoder_error(value, wanted.__base__ or Encoder, wanted.interface)
            require_answer(cast(Any, wanted), cast(Any, value))
    return make(*arguments)


def find_any_shape(kind: type, encoder: Encoder) -> Shape:
    """Return the description of a class for an encoder, with any answer to each open question."""
    make, needed = find_description(kind)
    arguments: list[object] = []
    for argument_type in needed:
        is_encoder = issubclass(argument_type, Encoder)
        arguments.append(encoder if is_encoder else next(iter(cast(Any, argument_type))))
    return make(*arguments)


def find_kinds(encoder: Encoder) -> tuple[type, ...]:
    """Return the classes of the frames that an encoder sends."""
    package, _, family = type(encoder).__module__.rpartition(".")
    module = import_module(f"{package}._shapes.{family}")
    makers = module.FRAMES.get((encoder.interface.value, "encoder"), {}).values()
    return tuple(kind for kind, make in module.SHAPES.items() if make in makers)


@cache
def find_description(kind: type) -> tuple[Callable[..., Shape], tuple[type, ...]]:
    """Return the function that creates the description of a class, and the types of its arguments."""
    shapes: Mapping[type, Callable[..., Shape]] = module_of(kind, "_shapes").SHAPES
    make = next(shapes[base] for base in kind.__mro__ if base in shapes)
    hints = get_type_hints(make)
    return make, tuple(hint for name, hint in hints.items() if name != "return")


def module_of(kind: type, folder: str) -> Any:
    """Return the module in ``folder`` that belongs to the family of a class."""
    fields = next(base for base in kind.__mro__ if "_fields" in vars(base))
    package, _, family = fields.__module__.rpartition(".")
    return import_module(f"{package}.{folder}.{family}")


def decoding_arguments(kind: type, /, **arguments: object) -> tuple[object, ...]:
    """Return the encoder, ``variant``, and the answers that a class of frames needs, in the order of its fields."""
    fields: tuple[str, ...] = cast(Any, kind)._fields
    needed_fields = fields[: len(find_description(kind)[1])]
    return tuple(arguments[name] for name in needed_fields)
