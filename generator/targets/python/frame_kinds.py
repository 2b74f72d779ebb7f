"""Frames that an encoder sends over an interface, as ``decode`` of its class takes them."""

from __future__ import annotations

from collections.abc import Sequence

from ...model.record import dataclass
from ...plan.description import describe
from .codec import Coder
from .names import OpenQuestion, decoder_maker


def _column_names(coder: Coder) -> list[str]:
    """Return the names of the columns of a table of frames, as type checkers know them.

    They are the attributes of fields, runs of digits and joins, quantities such as ``position (µm)``, and ``unused``,
    ``verdict`` and ``fault``.
    """
    description = describe(coder.plan)
    fields_with_data = {part.field.name for part in coder.plan.parts}
    columns = [column for column in description.columns if column.name in fields_with_data]
    attribute_of = coder.names.attribute
    names: list[str] = []
    for column in columns:
        if column.runs:
            # A run consists of a name, a divisor and a modulus.
            names += [attribute_of(run_name) for run_name, _, _ in column.runs]
        else:
            names.append(attribute_of(column.name))
    names += [attribute_of(join.name) for join in description.joins]
    for column in columns:
        if column.scale is not None:
            names.append(f"{attribute_of(column.name)} ({column.scale.unit})")
    if description.unused:
        names.append("unused")
    if coder.reports is not None and coder.reports.default_verdict:
        names.append("verdict")
    return [*names, "fault"]


@dataclass(frozen=True)
class FrameKind:
    """Frames that the encoder sends over an interface. If there are several kinds, ``dispatch`` decodes them."""

    interface: str
    coder: Coder
    dispatch: str
    union: str
    questions: Sequence[OpenQuestion] = ()
    members: tuple[Coder, ...] = ()

    @property
    def decoder(self) -> str:
        """Function that makes the decoder for an encoder."""
        return decoder_maker(self.dispatch) if self.dispatch else f"{self.coder.name}._make_decoder"

    @property
    def column_type(self) -> str:
        """Type of the names of the columns in a table of these frames."""
        return "Any" if self.dispatch else f"_{self.coder.name}Column"

    @property
    def column_names(self) -> str:
        """Names of the columns in a table of these frames, as literals."""
        return ", ".join(f'"{name}"' for name in _column_names(self.coder))

    @property
    def in_bytes(self) -> bool:
        return self.coder.plan.in_bytes

    @property
    def has_open_length(self) -> bool:
        """True if the length of the frame depends on a question that the manual leaves open."""
        answered = {name for question in self.questions for name, _ in question.members}
        return not answered.isdisjoint(self.coder.layout.bits.parameters)

    @property
    def listed(self) -> list[tuple[str, str]]:
        """Arguments for questions that the manual leaves open, with their descriptions."""
        return [(question.name, question.about) for question in self.questions]

    @property
    def arguments(self) -> list[tuple[str, str]]:
        """Arguments of ``decode``, with their descriptions."""
        if self.in_bytes:
            return [("frame", "Bytes of the frame, in the order of transmission."), *self.listed]
        frame = (
            "Frame as a number whose most significant bit was sent first, as a string of 0 and 1, or as the bytes of "
            "the number, most significant first."
        )
        bits = "Number of bits received, if known. The number itself does not show whether bits are missing."
        return [("frame", frame), ("bits", bits), *self.listed]

    @property
    def returned(self) -> str:
        """Description of the value that ``decode`` returns."""
        return "The frame. Check its ``verdict`` before you use the position." if self.has_verdict else "The frame."

    @property
    def has_verdict(self) -> bool:
        """True if any of the frames has a verdict."""
        return self.coder.reports is not None and bool(self.coder.reports.default_verdict)
