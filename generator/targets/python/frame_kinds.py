"""The frames that an encoder sends over an interface, as its ``decode`` accepts them, and frames with data channels."""

from __future__ import annotations

from collections.abc import Sequence

from ...model import Interface, channel_frame, first_or_raise
from ...model.record import dataclass
from ...plan.description import describe
from .codec import LayoutClass
from .literals import ExpressionTranslator, PythonExpression
from .names import ClassNames, DeviceNames, OpenQuestion, decoder_maker


def _column_names(layout_class: LayoutClass) -> list[str]:
    """Return the names of the columns in a table of frames, for type checkers.

    They are the attributes of the frame, the numbers that several fields form (joins), quantities such as ``position
    (µm)``, and ``unused``, ``verdict`` and ``fault``.
    """
    description = describe(layout_class.layout_plan)
    fields_with_data = {decoded_field.field.name for decoded_field in layout_class.layout_plan.decoded_fields}
    columns = [column for column in description.columns if column.name in fields_with_data]
    attribute_name_of = layout_class.class_names.attribute_name
    column_names: list[str] = []
    for column in columns:
        if column.runs:
            # Some decimal digits consist of a name, a divisor and a modulus.
            column_names += [attribute_name_of(run_name) for run_name, _, _ in column.runs]
        else:
            column_names.append(attribute_name_of(column.name))
    column_names += [attribute_name_of(join.name) for join in description.joins]
    for column in columns:
        if column.scale is not None:
            column_names.append(f"{attribute_name_of(column.name)} ({column.scale.unit})")
    if description.unused:
        column_names.append("unused")
    if layout_class.reports is not None and layout_class.reports.default_verdict:
        column_names.append("verdict")
    return [*column_names, "fault"]


@dataclass(frozen=True)
class FrameKind:
    """The frames that an encoder sends over an interface.

    If there are several, ``dispatch_function`` is the function that decodes any of them, and ``union_type`` the type of
    its result. ``layout_class`` is the class of the frame with the position, and ``frame_classes`` are the classes of
    all frames.
    """

    interface: str
    layout_class: LayoutClass
    dispatch_function: str
    union_type: str
    questions: Sequence[OpenQuestion] = ()
    frame_classes: tuple[LayoutClass, ...] = ()

    @property
    def decoder(self) -> str:
        """The function that returns the decoder for an encoder."""
        return (
            decoder_maker(self.dispatch_function)
            if self.dispatch_function
            else f"{self.layout_class.name}._make_decoder"
        )

    @property
    def column_type(self) -> str:
        """Type of the names of the columns in a table of these frames."""
        return "Any" if self.dispatch_function else f"_{self.layout_class.name}Column"

    @property
    def column_names(self) -> str:
        """Names of the columns in a table of these frames, as literals."""
        return ", ".join(f'"{name}"' for name in _column_names(self.layout_class))

    @property
    def in_bytes(self) -> bool:
        """True if a frame consists of bytes rather than bits."""
        return self.layout_class.layout_plan.in_bytes

    @property
    def has_open_length(self) -> bool:
        """True if the length of the frame depends on a question that the manual leaves open."""
        answered_parameters = {name for question in self.questions for name, _ in question.members}
        return not answered_parameters.isdisjoint(self.layout_class.layout.bits.parameters)

    @property
    def described_answers(self) -> list[tuple[str, str]]:
        """The arguments for questions that the manual leaves open, with their descriptions."""
        return [(question.name, question.about) for question in self.questions]

    @property
    def arguments(self) -> list[tuple[str, str]]:
        """Arguments of ``decode``, with their descriptions."""
        if self.in_bytes:
            return [("frame", "Bytes of the frame, in the order of transmission."), *self.described_answers]
        description_of_frame = (
            "Frame as a number whose most significant bit was sent first, as a string of 0 and 1, or as the bytes of "
            "the number, most significant first."
        )
        description_of_bits = (
            "Number of bits received, if known. The number itself does not show whether bits are missing."
        )
        return [("frame", description_of_frame), ("bits", description_of_bits), *self.described_answers]

    @property
    def returned(self) -> str:
        """Description of the value that ``decode`` returns."""
        return "The frame. Check its ``verdict`` before you use the position." if self.has_verdict else "The frame."

    @property
    def has_verdict(self) -> bool:
        """True if any of the frames has a verdict."""
        return self.layout_class.reports is not None and bool(self.layout_class.reports.default_verdict)


@dataclass(frozen=True)
class ChannelCode:
    """A frame with several data channels.

    ``channel_classes`` are the classes of its channels, and ``position_index`` is the index of the channel with the
    position. ``compared`` are fields that must agree, such as two positions: the index of the channel, the attribute
    and the width of each. Their highest ``compared_bits`` bits must not differ by more than ``tolerance``.
    """

    channel_classes: tuple[str, ...]
    position_index: int
    compared: tuple[tuple[int, str, PythonExpression], ...]
    compared_bits: PythonExpression
    tolerance: int


def channel_code(
    device_names: DeviceNames, interface: Interface, translator: ExpressionTranslator
) -> ChannelCode | None:
    """Return the code for the frame with all data channels of an interface, or None if frames have one channel.

    ``translator`` says how parameters are written in widths, such as ``self.bits``.
    """
    frame = channel_frame(interface)
    if frame is None:
        return None
    # Each layout is one channel of the frame.
    index_by_layout = {layout.name: index for index, layout in enumerate(frame.layouts)}
    position_layouts = (
        layout for layout in frame.layouts if device_names.device.sends_position(interface.name, layout)
    )
    compared_fields = []
    for field in frame.compared:
        # A channel is a frame layout, so no names are reserved for a register or for CRC functions.
        class_names = ClassNames(field.layout, register=None, crcs=())
        channel_index = index_by_layout[field.layout.name]
        compared_fields.append(
            (channel_index, class_names.attribute_name(field.name), translator.to_python(field.width))
        )
    position_layout = first_or_raise(position_layouts, "channel with the position")
    return ChannelCode(
        channel_classes=tuple(device_names.class_name_by_frame[layout.name] for layout in frame.layouts),
        position_index=index_by_layout[position_layout.name],
        compared=tuple(compared_fields),
        compared_bits=translator.to_python(frame.compared_bits),
        tolerance=frame.tolerance,
    )
