"""Joined numbers and numbers in Gray code: whether what a layout says of them can be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .fields import Context
from .model import Field, Layout
from .problems import Path


def check_joined(layout: Layout, path: Path, context: Context, sets: Sequence[Mapping[str, int]]) -> None:
    """What a layout says of joined numbers and of one in Gray code; a number is told of once."""
    faulty = _check_joins(layout, path, context, sets)
    if layout.gray_of and layout.gray_of not in faulty:
        _check_gray(layout, path, context, sets)


def _check_joins(layout: Layout, path: Path, context: Context, sets: Sequence[Mapping[str, int]]) -> set[str]:
    """A joined number takes in each field once; in a word, whose first bit is the most significant, in its order."""
    fields = {field.name: field for field in layout.fields}
    faulty: set[str] = set()
    for join in layout.joins:
        before, here = len(context.report), (*path, "join", join.name)
        for index, name in enumerate(join.fields):
            if name in join.fields[:index]:
                context.report.add("join-order", (*here, index), f"'{join.name}' takes in '{name}' twice")
        pairs = [pair for pair in zip(join.fields, join.fields[1:]) if pair[0] != pair[1] and {*pair} <= fields.keys()]
        for index, (above, below) in enumerate(pairs, 1):
            if layout.carried_as == "bits" and _is_above(fields[below], fields[above], sets):
                wrong = (
                    f"'{join.name}' has '{above}' above '{below}'; in '{layout.name}' '{below}' is sent first, and with"
                    " it the more significant bits"
                )
                context.report.add("join-order", (*here, index), wrong)
        if len(context.report) > before:
            faulty.add(join.name)
    return faulty


def _check_gray(layout: Layout, path: Path, context: Context, sets: Sequence[Mapping[str, int]]) -> None:
    """What is sent in Gray code is one number of several bits in one piece."""
    join = next((item for item in layout.joins if item.name == layout.gray_of), None)
    names = join.fields if join is not None else (layout.gray_of,)
    parts = [field for name in names for field in layout.fields if field.name == name]
    here = (*path, "gray", "of")
    other = next((field for field in parts if field.kind not in ("number", "choice")), None)
    if other is not None or (len(parts) == 1 and parts[0].widest == 1):
        what = (
            f"'{parts[0].name}' has one bit"
            if other is None or other.kind == "flag"
            else f"'{other.name}' is a {other.kind}"
        )
        context.report.add("gray-of", here, f"{what}; only a number of several bits can be in Gray code")
    for above, below in zip(parts, parts[1:]):
        if any(below.low.value(values) + below.width.value(values) != above.low.value(values) for values in sets):
            wrong = (
                f"'{above.name}' and '{below.name}' are not next to each other; a number in Gray code is in one piece,"
                " its most significant part first"
            )
            context.report.add("gray-of", here, wrong)
            return


def _is_above(field: Field, other: Field, sets: Sequence[Mapping[str, int]]) -> bool:
    """Whether a field lies above another, where both have bits."""
    both = [values for values in sets if field.width.value(values) and other.width.value(values)]
    return any(field.low.value(values) > other.low.value(values) for values in both)
