"""Positions in C: the macros that read them, frames of several data channels, and conversions to turns and lengths."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import ChannelFrame, Layout, Measurement, Spi, channel_frame, cite, first_or_raise
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.values import PositionRange, position_ranges
from .codec import StructCodec
from .context import AlternativeCode, HeaderContext
from .expressions import CCast, CExpression, CFunction, CNumber, ExpressionTranslator, wide_number_function
from .names import DeclaredName, c_name
from .variants import CodeRow, LengthCode

#: C expression for the size of any array.
_SIZE_OF_ANY_ARRAY = "sizeof(rx)"


@dataclass(frozen=True, slots=True)
class RangeFunctions:
    """The functions for one range of positions: the modulus, and the distance between two positions.

    If frames have different ranges, ``frame_in_names`` is the name of a frame in the names of the functions. Otherwise
    it is empty. ``modulus`` is the function for the counts after which a length wraps around. It is None for an angle,
    and for a position that never wraps around.
    """

    prefix: str
    frame_in_names: str
    is_signed: bool
    never_wraps: bool
    modulus: CFunction | None
    turns: CExpression | None
    is_one_turn: bool
    layouts: tuple[Layout, ...]

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        if not self.never_wraps:
            yield f"{self.frame_in_names}modulus"
        yield f"{self.frame_in_names}position_difference"


@dataclass(frozen=True, slots=True)
class AnglePositions:
    """The functions for positions of a rotary encoder. ``citation`` cites the manual."""

    prefix: str
    citation: str
    is_signed: bool
    counts_per_turn: CFunction
    ranges: tuple[RangeFunctions, ...]

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        yield "counts_per_turn"
        for functions in self.ranges:
            yield from functions.names
        yield from ("turns", "degrees")

    def declared(self) -> Iterator[DeclaredName]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


@dataclass(frozen=True, slots=True)
class LengthPositions:
    """The functions for positions of a linear encoder. ``citation`` cites the manual.

    A count is ``step`` in ``unit``, or ``step`` per ``per_counts`` counts. A millimeter has
    ``units_per_millimetre`` units.
    """

    prefix: str
    citation: str
    is_signed: bool
    ranges: tuple[RangeFunctions, ...]
    step: CExpression
    step_varies: bool
    unit: str
    units_per_millimetre: int
    per_counts: CExpression | None

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        for functions in self.ranges:
            yield from functions.names
        yield from (self.unit, "millimetres")

    def declared(self) -> Iterator[DeclaredName]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


Positions = AnglePositions | LengthPositions


def positions(context: HeaderContext) -> Positions | None:
    """Return the functions that convert positions to turns or lengths, or None if the manual gives no unit."""
    measurement = context.device.measurement_of(context.interface.name)
    return _build_positions(context, measurement) if measurement is not None else None


def _build_positions(context: HeaderContext, measurement: Measurement) -> Positions | None:
    """Return the conversions to angles or to lengths, or None if the manual gives no unit."""
    if measurement.counts_per_turn is not None:
        return _angle_positions(context, measurement, measurement.counts_per_turn)
    if measurement.step_um is not None:
        return _length_positions(context, measurement, measurement.step_um, unit="micrometres", per_mm=1_000)
    if measurement.step_nm is not None:
        return _length_positions(context, measurement, measurement.step_nm, unit="nanometres", per_mm=1_000_000)
    return None


def _angle_positions(context: HeaderContext, measurement: Measurement, counts_per_turn: Expression) -> AnglePositions:
    """Return the functions that convert counts to turns and degrees."""
    ranges = position_ranges(context.device, context.interface)
    citation = f"[{cite(measurement.source)}]"
    per_turn = wide_number_function(
        context.translator,
        name=f"{context.prefix}_counts_per_turn",
        expression=counts_per_turn,
        about=f"Return the number of counts in one revolution {citation}.",
    )
    return AnglePositions(
        prefix=context.prefix,
        citation=citation,
        is_signed=any(position_range.signed_field is not None for position_range in ranges),
        counts_per_turn=per_turn,
        ranges=tuple(_range_functions(context, ranges)),
    )


def _length_positions(
    context: HeaderContext, measurement: Measurement, step: Expression, *, unit: str, per_mm: int
) -> LengthPositions:
    """Return the functions that convert counts to lengths, with a step in ``unit``."""
    ranges = position_ranges(context.device, context.interface)
    per_counts = measurement.per_counts
    return LengthPositions(
        prefix=context.prefix,
        citation=f"[{cite(measurement.source)}]",
        is_signed=any(position_range.signed_field is not None for position_range in ranges),
        ranges=tuple(_range_functions(context, ranges)),
        step=_cast_to_signed(context.translator, step),
        step_varies=not all(expression.is_constant for expression in measurement.steps),
        unit=unit,
        units_per_millimetre=per_mm,
        per_counts=_cast_to_signed(context.translator, per_counts) if per_counts is not None else None,
    )


def _range_functions(context: HeaderContext, ranges: Sequence[PositionRange]) -> Iterator[RangeFunctions]:
    """Yield the functions for the only range of positions. If there are several, each frame has its own functions.

    There are no functions for a range in which the distance between two positions is unknown.
    """
    for position_range in ranges:
        if not position_range.has_difference:
            continue
        if len(ranges) == 1:
            yield _functions_of_range(context, position_range, frame_in_names="", layouts=position_range.layouts)
            continue
        for layout in position_range.layouts:
            yield _functions_of_range(context, position_range, frame_in_names=f"{layout.name}_", layouts=(layout,))


def _functions_of_range(
    context: HeaderContext, position_range: PositionRange, *, frame_in_names: str, layouts: tuple[Layout, ...]
) -> RangeFunctions:
    """Return the functions for one range.

    ``frame_in_names`` is a part of their names, such as ``reply_`` in ``acme_x_ssi_reply_modulus``, or empty.
    """
    turns = position_range.measurement.turns
    return RangeFunctions(
        prefix=context.prefix,
        frame_in_names=frame_in_names,
        is_signed=position_range.signed_field is not None,
        never_wraps=position_range.never_wraps,
        modulus=_build_modulus(context, position_range, f"{context.prefix}_{frame_in_names}modulus"),
        turns=context.translator.to_c(turns) if turns is not None else None,
        is_one_turn=turns == Expression(1),
        layouts=layouts,
    )


def _build_modulus(context: HeaderContext, position_range: PositionRange, name: str) -> CFunction | None:
    """Return the function for the counts after which a length wraps around, or None if it does not wrap around."""
    measurement = position_range.measurement
    is_signed = position_range.signed_field is not None
    if measurement.modulus is None:
        return None
    wraps = "wraps around" if is_signed else "wraps around to 0"
    about = f"Return the number of counts after which the position {wraps} [{cite(measurement.source)}]."
    if measurement.highest is not None and is_signed:
        about += f" The highest position is {measurement.highest.render()}."
    elif measurement.highest is not None:
        about += f" An offset raises all positions, up to {measurement.highest.render()}."
    return wide_number_function(context.translator, name=name, expression=measurement.modulus, about=about)


def _cast_to_signed(translator: ExpressionTranslator, expression: Expression) -> CExpression:
    """Return an expression as a number with a sign, such as ``(int64_t)variant.step``."""
    if expression.is_constant:
        return CNumber(expression.constant, signed=True)
    return CCast("int64_t", translator.to_c(expression))


class ReadCode:
    """The values that the templates print for the macros that read a position.

    ``frame`` is the frame with the position, or None if no frame has a position and a verdict. ``reads_twice`` is True
    if no CRC protects the frame, so that two frames must agree.
    """

    def __init__(
        self, context: HeaderContext, frame: StructCodec | None, lengths: LengthCode, *, reads_twice: bool
    ) -> None:
        self.frame = frame
        self.reads_twice = reads_twice
        self._context = context
        self._frame_lengths = lengths
        self.macro = f"{context.PREFIX}_READ"

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names of the macros and of the function that reads twice. Without a frame, there are no macros."""
        if self.frame is not None:
            path = ("interfaces", self._context.interface.name)
            names = [self.macro, f"{self.macro}_BYTES"]
            if self.takes_word:
                names.append(f"{self.macro}_WORD")
            if self.reads_twice:
                names += [f"{self.macro}_TWICE", f"{self.frame.name}_read_twice"]
            yield from ((name, path) for name in names)

    @property
    def takes_word(self) -> bool:
        """True if a macro takes a word as a number, since SPI peripherals exchange words of 16 or 32 bits."""
        is_word = self.frame is not None and not self.frame.layout_plan.in_bytes and not self.frame.word_has_length
        return is_word and isinstance(self._context.interface, Spi)

    @property
    def questions(self) -> tuple[AlternativeCode, ...]:
        """The questions left open by the manual, whose answers the macros take after the order code."""
        return self.frame.alternatives if self.frame is not None else ()

    @property
    def expected_size(self) -> str:
        """C expression for the number of bytes in the array: a macro, or ``sizeof(rx)`` to accept any array.

        It is empty if there is no frame to read.
        """
        if self.frame is None:
            return ""
        if self._frame_lengths.macros and self.frame.struct.layout.name in self._frame_lengths.layout_names:
            return self.buffer_macro(self.frame)
        if self.frame.layout_plan.in_bytes:
            return self.frame.length_macro
        return f"{self._word_bytes}U" if self._word_bytes else _SIZE_OF_ANY_ARRAY

    @property
    def _is_spi_word(self) -> bool:
        """True if the frame with the position is a word over SPI."""
        is_spi = isinstance(self._context.interface, Spi)
        return is_spi and self.frame is not None and not self.frame.layout_plan.in_bytes

    @property
    def is_padded(self) -> bool:
        """True if the frame with the position is a word over SPI that does not fill its bytes with some order code."""
        if self.frame is None or not self._is_spi_word:
            return False
        sent_bits = self.frame.struct.layout.sent_bits
        interface_name = self._context.interface.name
        variants = [variant for variant in self._context.device.variants if variant.interface == interface_name]
        return any(sent_bits.value(variant.parameters) % 8 for variant in variants)

    @property
    def _word_bytes(self) -> int:
        """Number of bytes of a word over SPI. It is 0 if it depends on the order code, or without such a word."""
        if self.frame is None or not self._is_spi_word:
            return 0
        sent_bits = self.frame.struct.layout.sent_bits
        # Bits to bytes, rounded up.
        return (sent_bits.constant + 7) // 8 if sent_bits.is_constant else 0

    def buffer_macro(self, frame: StructCodec) -> str:
        """Return the name of the macro for the size of a buffer, as the preprocessor pastes it.

        In ``ACME_X_SSI_##code##_##width##_RX_BYTES``, ``code`` and ``width`` are arguments: the order code, and the
        user's answer to an open question.
        """
        # If there are several frames, the name includes the name of the frame.
        layout_names = [frame.struct.layout.name.upper()] if len(self._frame_lengths.layout_names) > 1 else []
        answers = [f"##{question.argument}##" for question in frame.length_alternatives]
        return "_".join((f"{self._context.PREFIX}_##code##", *layout_names, *answers, "RX_BYTES"))

    def buffer_of(self, row: CodeRow) -> str:
        """Return the size of the buffer for an order code and the first answers, as C, or an empty string.

        A word over SPI has no macro for its size.
        """
        if self._is_spi_word and self.frame is not None:
            sent_bits = self.frame.struct.layout.sent_bits.value(row.variant.parameters)
            # Bits to bytes, rounded up.
            return str((sent_bits + 7) // 8)
        buffer_size = self.expected_size
        if buffer_size == _SIZE_OF_ANY_ARRAY:
            return ""
        for question in self.questions:
            first_answer = question.spec_question.answers[0].name.upper()
            buffer_size = buffer_size.replace(f"##{question.argument}##", first_answer)
        return buffer_size.replace("##code##", row.name_in_macros)

    def arguments_of(self, order_code: str) -> str:
        """Return the first arguments of a macro for an order code and the first answers, such as ``X24, WIDE``."""
        answers = (question.spec_question.answers[0].name.upper() for question in self.questions)
        return ", ".join((order_code, *answers))


class ChannelCode:
    """The values that the template prints for a frame that consists of several data channels.

    ``compared`` contains the fields that must have the same value in their channels, such as two positions: the member
    of the struct, and the width of the field.
    """

    def __init__(self, context: HeaderContext, frame: ChannelFrame, codecs: Sequence[StructCodec]) -> None:
        self._context = context
        self._frame = frame
        self.type = f"{context.prefix}_channels"
        codec_by_layout = {codec.struct.layout.name: codec for codec in codecs}
        self.codecs = [codec_by_layout[layout.name] for layout in frame.layouts]
        self.compared: list[tuple[str, CExpression]] = []
        for channel_field in frame.compared:
            member = f"{c_name(channel_field.layout.name)}.{c_name(channel_field.name)}"
            self.compared.append((member, context.translator.to_c(channel_field.width)))

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names of the struct, its functions and its macros."""
        path = ("interfaces", self._context.interface.name, "channels")
        functions = ["bits", "decode", "verdict", "receive"]
        if self.compared:
            functions.append("agree")
        yield self.type, path
        yield from ((f"{self.type}_{function}", path) for function in functions)

    @property
    def about(self) -> list[str]:
        """The comment on the struct, which names the channels in the order sent."""
        channel_names = " and ".join(layout.name for layout in self._frame.layouts)
        return [f"The data channels of one frame, one directly after the other: {channel_names}."]

    @property
    def about_comparison(self) -> list[str]:
        """The comment on the function that compares the members."""
        members = " and ".join(member for member, _ in self.compared)
        tolerance = f" by more than {self._frame.tolerance}" if self._frame.tolerance else ""
        bits = self._frame.compared_bits.render()
        return [f"Return true unless the highest {bits} bits of {members} differ{tolerance}."]

    @property
    def compared_bits(self) -> CExpression:
        return self._context.translator.to_c(self._frame.compared_bits)

    @property
    def tolerance(self) -> int:
        """The largest difference at which the compared fields still agree."""
        return self._frame.tolerance

    @property
    def depends_on_variant(self) -> bool:
        """True if the compared bits depend on the order code."""
        widths = [self._frame.compared_bits, *(field.width for field in self._frame.compared)]
        return not all(width.is_constant for width in widths)

    @property
    def position_codec(self) -> StructCodec:
        """The decoder and encoder of the channel with the position."""
        interface = self._context.interface.name
        layouts = (layout for layout in self._frame.layouts if self._context.device.sends_position(interface, layout))
        layout = first_or_raise(layouts, "channel with the position")
        # The codecs are in the order of the layouts.
        return self.codecs[self._frame.layouts.index(layout)]

    @property
    def judging_codecs(self) -> list[StructCodec]:
        """The channels without the position whose flags decide whether the position is usable (its verdict)."""
        other_codecs = (codec for codec in self.codecs if codec is not self.position_codec)
        return [codec for codec in other_codecs if codec.reports is not None and codec.reports.verdict_function]


def channel_code(context: HeaderContext, codecs: Sequence[StructCodec]) -> ChannelCode | None:
    """Return the C code for the frame with all data channels of an interface, or None if frames have one channel."""
    frame = channel_frame(context.interface)
    return ChannelCode(context, frame, codecs) if frame is not None else None
