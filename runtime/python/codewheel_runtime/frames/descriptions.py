# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Descriptions of a frame class. They are in the ``_shapes`` folder of a package, and are loaded on first use."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, cast, get_type_hints

from ..codec import require_answer
from ..encoder import Encoder, wrong_encoder_error

if TYPE_CHECKING:
    from ..bulk.shape import FrameLayout


def layout_of(frame_class: type, *arguments: object) -> FrameLayout:
    """Return the description of a frame class.

    Args:
        frame_class: A class of frames.
        arguments: The encoder, if encoders of the family have different frames, and then the answers to the questions
            that the manual leaves open for these frames. An answer is a member of the enumeration of its question.

    Raises:
        TypeError: An argument is missing or not an encoder, or an answer is not a member of the enumeration.
        FamilyError, InterfaceError: The encoder belongs to a different family, or has a different interface.
    """
    make_layout, argument_types = find_description(frame_class)
    # There can be fewer arguments. The call of ``make_layout`` then raises TypeError.
    # The first fields of a class are these arguments.
    for name, argument_type, argument in zip(field_names(frame_class), argument_types, arguments, strict=False):
        if isinstance(argument, argument_type):
            continue
        if issubclass(argument_type, Encoder):
            # The type is the class for one interface of a family. Its base is the class for the family.
            family_class = argument_type.__base__ or Encoder
            raise wrong_encoder_error(argument, family_class=family_class, interface=argument_type.interface)
        # Any other type is an enumeration of answers. This always raises TypeError, because it is not a member.
        answer_class: type[Enum] = cast(Any, argument_type)
        require_answer(name, answer_class, cast(Any, argument))
    return make_layout(*arguments)


def find_any_layout(frame_class: type, encoder: Encoder) -> FrameLayout:
    """Return the description of a frame class for an encoder, for any answers to open questions.

    The first possible answer to each question is used, so use only properties that do not depend on the answers, such
    as the length of the frame.
    """
    make_layout, argument_types = find_description(frame_class)
    arguments: list[object] = []
    for argument_type in argument_types:
        if issubclass(argument_type, Encoder):
            arguments.append(encoder)
        else:
            # Any other type is an enumeration of answers.
            answer_class: type[Enum] = cast(Any, argument_type)
            first_answer = next(iter(answer_class))
            arguments.append(first_answer)
    return make_layout(*arguments)


def find_kinds(encoder: Encoder) -> tuple[type, ...]:
    """Return the classes of the frames that an encoder sends over its interface."""
    package, _, family = type(encoder).__module__.rpartition(".")
    module = import_module(f"{package}._shapes.{family}")
    # FRAMES contains the functions that make descriptions by interface and sender, and there by the name of the frame.
    # SHAPES contains the same functions by class.
    functions_of_sent_frames = module.FRAMES.get((encoder.interface.value, "encoder"), {}).values()
    return tuple(
        frame_class for frame_class, make_layout in module.LAYOUTS.items() if make_layout in functions_of_sent_frames
    )


@cache
def find_description(frame_class: type) -> tuple[Callable[..., FrameLayout], tuple[type, ...]]:
    """Return the function that creates the description of a frame class, and the types of its arguments.

    The arguments are an encoder, unless all encoders have the same description, and the answers to open questions. A
    class derived from a frame class uses the description of its base class.
    """
    functions_by_class: Mapping[type, Callable[..., FrameLayout]] = module_of(frame_class, "_shapes").LAYOUTS
    make_layout = next(functions_by_class[base] for base in frame_class.__mro__ if base in functions_by_class)
    hints = get_type_hints(make_layout)
    return make_layout, tuple(hint for name, hint in hints.items() if name != "return")


def module_of(frame_class: type, folder: str) -> Any:
    """Return the module in a ``folder`` such as ``facts`` for the family of a frame class."""
    # The base class with the fields is in the module of the family. A class derived from it can be elsewhere.
    fields = next(base for base in frame_class.__mro__ if "_fields" in vars(base))
    package, _, family = fields.__module__.rpartition(".")
    return import_module(f"{package}.{folder}.{family}")


def field_names(frame_class: type) -> tuple[str, ...]:
    """Return the field names of a frame class, which is a NamedTuple."""
    named_tuple: Any = frame_class
    names: tuple[str, ...] = named_tuple._fields
    return names


def decoding_arguments(frame_class: type, /, **arguments: object) -> tuple[object, ...]:
    """Return the ``arguments`` that the description of a frame class needs, in the order of its first fields.

    They are ``variant``, which is the encoder, and the answers to open questions by name. Other arguments are ignored.
    Raises KeyError if a needed answer is missing.
    """
    _, argument_types = find_description(frame_class)
    # The first fields of a class are the arguments of the function for its description.
    needed_names = field_names(frame_class)[: len(argument_types)]
    return tuple(arguments[name] for name in needed_names)
