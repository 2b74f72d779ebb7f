"""Checks for frames that carry several data channels: their order, the position in them, and the compared fields."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from ..language.document import Path
from ..language.problems import DocumentReport, join_words, quoted
from ..model import Biss, DataChannels, Device, Field, Layout, Number, member_named
from .gaps import values_text
from .valid_parts import valid_parts_so_far

_CHANNELS_RULE = "data-channels"


class _Problem(NamedTuple):
    """A problem with data channels: the path of its key below ``channels``, such as ``("order", 0)``, and a message."""

    path: Path
    message: str


def check_channels(device: Device, report: DocumentReport) -> None:
    """Report the first contradiction in the description of a BiSS frame that carries several data channels.

    Decoders split such a frame by the lengths of the channels, decode each channel by itself, and then compare the
    positions.
    """
    biss = device.find_interface(Biss)
    if biss is None or biss.channels is None or not valid_parts_so_far(report).has_frames:
        return
    place: Path = ("interfaces", biss.name, "channels")
    if (*place, "compared_bits") in report.faults():
        return  # The number of compared bits is not a valid expression, which is already reported.
    layouts = {layout.name: layout for layout in biss.layouts}
    names = (*biss.channels.order, *biss.channels.compared)
    undefined_names = [name for name in names if name not in layouts]
    if undefined_names:
        # A layout with a problem was not built, so it would wrongly count as undefined.
        if not report.faults():
            known_names = join_words(map(quoted, layouts))
            message = f"there is no layout {quoted(undefined_names[0])} over BiSS; it has: {known_names}"
            report.add("undefined-reference", (*place, "order"), message)
        return
    ordered_layouts = [layouts[name] for name in biss.channels.order]
    problems: tuple[_Problem, ...] = (
        *_order_problems(biss, ordered_layouts),
        *_question_problems(device, ordered_layouts),
        *_position_problems(device, ordered_layouts),
        *_comparison_problems(device, biss.channels, layouts),
    )
    if problems:
        first_problem = problems[0]
        report.add(_CHANNELS_RULE, (*place, *first_problem.path), first_problem.message)


def _order_problems(biss: Biss, layouts: Sequence[Layout]) -> Iterator[_Problem]:
    """Yield problems with the order of the data channels in a frame.

    A frame has at least two channels, and the first one must be the first layout of the interface. Each channel is
    listed once, has a number of its own, and is not carried as bytes.
    """
    if len(layouts) < 2:
        yield _Problem(
            ("order",), "a frame with several channels has at least two; list all of them, or remove 'channels'"
        )
    first_layout = biss.layouts[0]
    if layouts[0] is not first_layout:
        name = quoted(layouts[0].name)
        first_name = quoted(first_layout.name)
        message = f"{name} is the first channel of the frame, but the first layout is {first_name}"
        yield _Problem(("order", 0), f"{message}; correct one of them")
    names_by_number: dict[int | None, str] = {}
    for index, layout in enumerate(layouts):
        path: Path = ("order", index)
        name = quoted(layout.name)
        other_name = names_by_number.setdefault(layout.channel, layout.name)
        is_listed_before = layout in layouts[:index]
        if is_listed_before:
            yield _Problem(path, f"{name} is listed twice; list each channel once")
        elif layout.channel is None:
            yield _Problem(path, f"{name} has no 'channel'; give each channel of the frame its number")
        elif other_name != layout.name:
            yield _Problem(
                path, f"{quoted(other_name)} and {name} have the same 'channel' {layout.channel}; correct one of them"
            )
        elif layout.in_bytes:
            yield _Problem(path, f"{name} is carried as bytes, but a channel of a frame is one word of at most 64 bits")


def _question_problems(device: Device, layouts: Sequence[Layout]) -> Iterator[_Problem]:
    """Yield a problem for each channel whose bits depend on a question that the manual leaves open."""
    for index, layout in enumerate(layouts):
        for alternative in device.alternatives_of(layout):
            name = quoted(layout.name)
            message = f"{name} depends on the question {quoted(alternative.name)}, which decoders of a whole frame"
            yield _Problem(
                ("order", index), f"{message} do not ask; remove 'channels', and decode each channel separately"
            )


def _position_problems(device: Device, layouts: Sequence[Layout]) -> Iterator[_Problem]:
    """Yield a problem if none or several of the data channels contain the position."""
    names = [quoted(layout.name) for layout in layouts if device.sends_position(Biss.name, layout)]
    if not names:
        yield _Problem(("order",), "no channel of the frame contains the position; list the one that does")
    if len(names) > 1:
        message = f"{join_words(names)} contain the position; name its fields differently in all but one of them"
        yield _Problem(("order",), f"{message}, and list the fields in 'compared'")


def _comparison_problems(device: Device, channels: DataChannels, layouts: Mapping[str, Layout]) -> Iterator[_Problem]:
    """Yield problems with the comparison of fields from different data channels.

    The highest bits of an unsigned number in each channel are compared. There cannot be more of these bits than the
    number has.
    """
    has_fields = bool(channels.compared)
    has_bits = channels.compared_bits is not None
    if has_fields != has_bits:
        yield _Problem((), "'compared' and 'compared_bits' need each other; give both or none")
    if len(channels.compared) == 1:
        yield _Problem(("compared",), "one field cannot be compared; list the field of each channel")
    for layout_name, field_name in channels.compared.items():
        path: Path = ("compared", layout_name)
        field = layouts[layout_name].find_field(field_name)
        if layout_name not in channels.order:
            yield _Problem(path, f"{quoted(layout_name)} is not in 'order'; add it, or leave it out here")
        elif field is None:
            yield _Problem(path, f"{quoted(layout_name)} has no field {quoted(field_name)}")
        elif not _is_plain_number(field):
            yield _Problem(
                path, f"{quoted(field_name)} is not an unsigned number, so its highest bits cannot be compared"
            )
        else:
            yield from _width_problems(device, channels, layouts[layout_name], field_name)


def _is_plain_number(field: Field) -> bool:
    """Return whether the bits of a field are an unsigned number. The bits 0 must represent 0."""
    kind = field.kind
    return isinstance(kind, Number) and not kind.signed and not kind.zero_means


def _width_problems(device: Device, channels: DataChannels, layout: Layout, field_name: str) -> Iterator[_Problem]:
    """Yield a problem for the first order code for which the numbers of two channels cannot be compared.

    Either the field has fewer bits than are compared, or the tolerance is so large that any two numbers agree.
    """
    if channels.compared_bits is None:
        return
    width = member_named(layout.fields, field_name, "field").width
    for variant in device.variants_over(Biss.name):
        bits = channels.compared_bits.value(variant.parameters)
        condition = values_text(variant.parameters, width, channels.compared_bits)
        field_bits = width.value(variant.parameters)
        if not 1 <= bits <= field_bits:
            message = f"{bits} bits cannot be compared, because {quoted(field_name)} has {field_bits}{condition}"
            yield _Problem(("compared_bits",), message)
            return
        # Numbers wrap around, so two numbers differ by at most half of their range.
        all_numbers_agree = 2 * channels.tolerance >= (1 << bits) - 1
        if all_numbers_agree:
            message = f"with a tolerance of {channels.tolerance}, any two numbers of {bits} bits agree{condition}"
            yield _Problem(("tolerance",), message)
            return
