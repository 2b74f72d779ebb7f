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
    """Return the description of the frames of a class.

    Args:
        kind: A class of frames.
        arguments: The encoder, if encoders of the family have different frames, and then the answers to the questions
            that the manual leaves open for these frames. An answer is a member of the enumeration of its question.

    Raises:
        TypeError: An argument is missing or not an encoder, or an answer is not a member of the enumeration.
        FamilyError, InterfaceError: The encoder belongs to another family, or has another interface.
    """
    make, argument_types = find_description(kind)
    # There can be fewer arguments. The call of ``make`` then raises TypeError.
    for argument_type, argument in zip(argument_types, arguments, strict=False):
        if isinstance(argument, argument_type):
            continue
        if issubclass(argument_type, Encoder):
            # The base of the class for an interface is the class for the family.
            raise wrong_encoder_error(argument, argument_type.__base__ or Encoder, argument_type.interface)
        # Always raises TypeError here, because the argument is not an answer.
        require_answer(cast(Any, argument_type), cast(Any, argument))
    return make(*arguments)


def find_any_shape(kind: type, encoder: Encoder) -> Shape:
    """Return the description of a class for an encoder, with the first possible answer to each open question.

    Use it for properties that do not depend on the answers, such as the length of the frame.
    """
    make, needed = find_description(kind)
    arguments: list[object] = []
    for argument_type in needed:
        is_encoder = issubclass(argument_type, Encoder)
        # Other types are enumerations of answers, whose first member this takes.
        arguments.append(encoder if is_encoder else next(iter(cast(Any, argument_type))))
    return make(*arguments)


def find_kinds(encoder: Encoder) -> tuple[type, ...]:
    """Return the classes of the frames that an encoder sends over its interface."""
    # FRAMES contains the functions for shapes by interface and sender, and there by the name of the frame. SHAPES
    # contains the functions by class. Both contain the same functions, so these connect the two.
    package, _, family = type(encoder).__module__.rpartition(".")
    module = import_module(f"{package}._shapes.{family}")
    makers = module.FRAMES.get((encoder.interface.value, "encoder"), {}).values()
    return tuple(kind for kind, make in module.SHAPES.items() if make in makers)


@cache
def find_description(kind: type) -> tuple[Callable[..., Shape], tuple[type, ...]]:
    """Return the function that creates the description of a class, and the types of its arguments.

    The arguments are an encoder, unless all encoders have the same description, and the answers to open questions. A
    class derived from a class of frames uses the description of its base.
    """
    shapes: Mapping[type, Callable[..., Shape]] = module_of(kind, "_shapes").SHAPES
    make = next(shapes[base] for base in kind.__mro__ if base in shapes)
    hints = get_type_hints(make)
    return make, tuple(hint for name, hint in hints.items() if name != "return")


def module_of(kind: type, folder: str) -> Any:
    """Return the module in ``folder``, such as ``facts``, that belongs to the family of a class."""
    # The base class with the fields is in the module of the family. A class derived from it can be elsewhere.
    fields = next(base for base in kind.__mro__ if "_fields" in vars(base))
    package, _, family = fields.__module__.rpartition(".")
    return import_module(f"{package}.{folder}.{family}")


def decoding_arguments(kind: type, /, **arguments: object) -> tuple[object, ...]:
    """Return the ``arguments`` that a class of frames needs, in the order of its first fields.

    They are ``variant``, which is the encoder, and the answers to open questions. Other arguments are ignored. Raises
    KeyError if one that the class needs is missing.
    """
    fields: tuple[str, ...] = cast(Any, kind)._fields
    # The first fields of a class are the arguments of the function for its description.
    needed_fields = fields[: len(find_description(kind)[1])]
    return tuple(arguments[name] for name in needed_fields)
