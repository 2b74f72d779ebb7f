# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Kinds of frames that an encoder sends and receives."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from importlib import import_module
from inspect import signature
from typing import Any, NamedTuple, get_type_hints

from ..bulk.shape import FrameLayout
from ..encoder import Encoder
from ..errors import UsageError


class FrameKind(NamedTuple):
    """Kind of frame that an encoder sends or receives.

    ``sender`` is ``encoder`` or ``master``. ``answers`` are the questions that the manual leaves open for these frames,
    each with the enumeration of its answers. ``make`` is the function that returns the description of the frame.
    """

    name: str
    sender: str
    answers: Mapping[str, type[Enum]]
    make: Callable[..., FrameLayout]

    def layout(self, encoder: Encoder, answers: Mapping[str, object]) -> FrameLayout:
        """Return the description of these frames for an encoder and these answers to the open questions."""
        # Only some layouts depend on the encoder.
        variant = {"variant": encoder} if "variant" in signature(self.make).parameters else {}
        return self.make(**variant, **answers)


def list_frame_kinds(encoder: Encoder) -> tuple[FrameKind, ...]:
    """Return all kinds of frames of an encoder's interface. Kinds that the encoder sends come first."""
    # FRAMES of the family contains functions for layouts, by interface and sender and then by the name of the frame.
    package, _, family = type(encoder).__module__.rpartition(".")
    frames: Mapping[tuple[str, str], Mapping[str, Callable[..., FrameLayout]]]
    frames = import_module(f"{package}._shapes.{family}").FRAMES
    layouts: list[FrameKind] = []
    for sender in ("encoder", "master"):
        functions_by_name = frames.get((encoder.interface.value, sender), {})
        for name, make_layout in functions_by_name.items():
            layouts.append(FrameKind(name, sender, answers=_list_answers(make_layout), make=make_layout))
    return tuple(layouts)


def _list_answers(make_layout: Callable[..., FrameLayout]) -> dict[str, type[Enum]]:
    """Return the questions whose answers a function needs, each with the enumeration of its answers.

    The questions are the parameters of the function, except the encoder.
    """
    types_by_name = get_type_hints(make_layout)
    parameter_names = signature(make_layout).parameters
    return {name: types_by_name[name] for name in parameter_names if issubclass(types_by_name[name], Enum)}


def find_frame_kind(encoder: Encoder, name: str = "") -> FrameKind:
    """Return the kind of frame with this name or, without a name, the only kind that the encoder sends.

    Case and underscores are ignored, so the name can be the name in the manual or the name of the class.

    Raises:
        UsageError: There is no frame with this name, or a name is needed to choose a frame.
    """
    layouts = list_frame_kinds(encoder)
    if name:
        wanted_name = name.replace("_", "").lower()
        matching_layouts = [candidate for candidate in layouts if candidate.name.replace("_", "") == wanted_name]
        problem = f"{encoder.code} has no frame '{name[:40]}'"
    else:
        matching_layouts = [candidate for candidate in layouts if candidate.sender == "encoder"]
        problem = f"{encoder.code} sends several kinds of frames; choose a layout"
    if len(matching_layouts) != 1:
        layout_names = ", ".join(candidate.name for candidate in layouts) or "none is known"
        raise UsageError(f"{problem}: {layout_names}")
    return matching_layouts[0]


def find_frame_layout(encoder: Encoder, layout: str, answers: Mapping[str, Any]) -> FrameLayout:
    """Return the description of the frames of a kind.

    ``answers`` are members of an enumeration or their names, by question.

    Raises:
        UsageError: An answer is missing, wrong or not needed, or the layout does not exist.
    """
    frame_kind = find_frame_kind(encoder, layout)
    for name in answers:
        if name not in frame_kind.answers:
            needed = f"it accepts {', '.join(frame_kind.answers)}" if frame_kind.answers else "it needs no answers"
            raise UsageError(f"{frame_kind.name} does not accept the answer '{name[:40]}': {needed}")
    chosen_answers: dict[str, object] = {}
    for name, answer_class in frame_kind.answers.items():
        # An answer can be a member of the enumeration, or its name in upper or lower case.
        answer = answers.get(name)
        matching_members = [member for member in answer_class if answer in (member, member.name, member.name.lower())]
        if len(matching_members) != 1:
            choices = " or ".join(member.name.lower() for member in answer_class)
            raise UsageError(f"the manual leaves the {name} of {frame_kind.name} open: choose {choices}")
        chosen_answers[name] = matching_members[0]
    return frame_kind.layout(encoder, chosen_answers)
